//! Moments of inertia in space: three principal ones or a tensor, and whether any body has them.

use crate::diagnose::Place;
use crate::diagnose::catalogue::mechanics;
use rustc_hash::FxHashMap as HashMap;

use super::declare::DeclaredBody;
use crate::expr::{Id, Rational, Symbol, Tape, substitute, vectors};
use crate::file::Quantity;
use crate::model::expression::dimension::Dimension;
use crate::model::expression::families::Locals;
use crate::model::expression::rules::Rules;
use crate::model::expression::value::Value;
use crate::model::resolver::Resolver;
use crate::model::rotation::{Orientation, Tensor};
use crate::random::Random;

/// The moments of a body as written: three, or nine by rows.
pub struct Moments {
    /// Of which body.
    pub name: String,
    /// Where they stand.
    pub place: Place,
    /// Their values about the centre of mass: one in the plane.
    pub values: Vec<Id>,
    /// Those about another point, as written, and what the distance to that adds, where they are given so.
    pub about: Option<[Vec<Id>; 2]>,
}

/// At these values of all coordinates, or at the first at which it is finite, a point's components along a body's axes are taken.
const PLACES: [Rational; 3] = [Rational::ZERO, Rational::HALF, Rational::ONE];
/// How many drawn states a point has to be at rest at.
const DRAWN: usize = 8;
/// By this part of its distance a point that is at rest in a body is off by rounding.
const AT_REST: f64 = 1e-9;

/// Data with few digits may miss the inequality of moments by this part of the largest, with a warning.
const FEW_DIGITS: f64 = 1e-2;
/// By this part of the largest moment a sum may be off by rounding.
const ROUNDING: f64 = 1e-9;
/// Elements of a tensor beside its diagonal, and the same mirrored, as places in its nine by rows.
const PRODUCTS: [(usize, usize, &str, &str); 3] = [(1, 3, "Ixy", "Iyx"), (2, 6, "Ixz", "Izx"), (5, 7, "Iyz", "Izy")];

impl Resolver<'_> {
    /// The values of moments of inertia as written; the products in a tensor may be negative.
    pub fn moments(&mut self, written: &[Quantity], locals: &Locals) -> Vec<Id> {
        let rules = Rules::inertial("a moment of inertia").si(Dimension::INERTIA);
        let mut values = Vec::new();
        for (k, moment) in written.iter().enumerate() {
            let product = written.len() == 9 && k % 4 != 0;
            values.push(match product {
                true => {
                    self.quantity(moment, Rules { what: "a product of inertia", ..rules }, locals).unwrap_or(Id::ZERO)
                }
                false => self.mass_or_inertia(Some(moment), rules, locals),
            });
        }
        values
    }

    /// The components along a body's axes of the way from its centre of mass to the point that its inertia is about: expressions of
    /// parameters.  In the plane those of the ground do as well, at an angle of 0.
    pub fn arm(
        &mut self,
        body: &DeclaredBody,
        name: &str,
        position: &[Id],
        frame: Option<&Orientation>,
    ) -> Option<[Id; 3]> {
        let (item, place) = (body.about?, body.text.about.clone()?);
        let Some(Value::Vector(point)) = self.scope.value(item).cloned() else { return None };
        let graph = &mut self.builder.graph;
        let mut way: Vec<Id> = point.iter().zip(position).map(|(p, c)| graph.sub(*p, *c)).collect();
        way.resize(3, Id::ZERO);
        let measured = match frame {
            Some(frame) => frame.along_axes(graph, &way).to_vec(),
            // Only its length counts.
            None => vec![vectors::dot(graph, &way, &way)],
        };
        let own = if frame.is_some() { measured.clone() } else { way };
        let fixed = self.at_a_place(&[own, measured.clone()].concat());
        let fixed = fixed.filter(|fixed| self.is_at_rest(&measured, &fixed[3..]));
        if fixed.is_none() {
            self.builder.problems.push(mechanics::not_at_rest(place, name));
        }
        fixed?.first_chunk().copied()
    }

    /// Expressions of the coordinates with numbers in their place.
    fn at_a_place(&mut self, roots: &[Id]) -> Option<Vec<Id>> {
        let coordinates = self.model.coordinates.len() as u32;
        for place in PLACES {
            let graph = &mut self.builder.graph;
            let number = graph.rational(place);
            let mut values: HashMap<Symbol, Id> = (0..coordinates).map(|k| (Symbol::Coordinate(k), number)).collect();
            // A rotation is unturned.
            for rotation in &self.model.rotations {
                values.extend((0..4).map(|k| (Symbol::Coordinate(rotation.first as u32 + k), Id::ZERO)));
                values.insert(Symbol::Coordinate(rotation.first as u32), Id::ONE);
            }
            values.insert(Symbol::Time, Id::ZERO);
            let found = substitute(graph, roots, &values);
            let numbers = crate::model::command::evaluate_all(graph, &found, &self.builder.defaults);
            if numbers.iter().all(|x| x.is_finite()) {
                return Some(found);
            }
        }
        None
    }

    /// Whether expressions have these values of parameters wherever the coordinates are.
    fn is_at_rest(&self, own: &[Id], fixed: &[Id]) -> bool {
        let mut random = Random::new();
        let tape = Tape::new(&self.builder.graph, &[own, fixed].concat());
        (0..DRAWN).all(|_| {
            let mut drawn: Vec<f64> = (0..self.model.coordinates.len()).map(|_| random.between(-2.0, 2.0)).collect();
            let time = random.between(0.1, 3.0);
            drawn.push(time);
            let factor = random.between(0.5, 1.5);
            let numbers = tape.evaluate(|symbol| match symbol {
                Symbol::Parameter(k) => factor * self.builder.defaults[k as usize],
                Symbol::Coordinate(k) => drawn[k as usize],
                Symbol::Time => time,
                // What else moves a point has no one value.
                _ => f64::NAN,
            });
            let (there, here) = numbers.split_at(own.len());
            let size = here.iter().map(|x| x.abs()).fold(0.0, f64::max);
            there.iter().zip(here).all(|(a, b)| (a - b).abs() <= AT_REST * size.max(f64::MIN_POSITIVE))
        })
    }

    /// What a mass at this arm adds to moments of inertia: m (d² 1 − d dᵀ).
    pub fn steiner(&mut self, mass: Id, arm: &[Id; 3]) -> Tensor {
        let graph = &mut self.builder.graph;
        let mut product = |i: usize, j: usize| {
            let product = graph.mul(arm[i], arm[j]);
            graph.mul(mass, product)
        };
        let [xx, yy, zz] = [0, 1, 2].map(|k| product(k, k));
        let [xy, xz, yz] = [(0, 1), (0, 2), (1, 2)].map(|(i, j)| product(i, j));
        let diagonal = [(yy, zz), (xx, zz), (xx, yy)].map(|(a, b)| self.builder.graph.add(a, b));
        let beside = [xy, xz, yz].map(|product| self.builder.graph.neg(product));
        let ([a, b, c], [d, e, f]) = (diagonal, beside);
        [a, b, c, d, e, f]
    }

    /// A tensor less another.
    pub fn differences(&mut self, all: &Tensor, less: &Tensor) -> Tensor {
        std::array::from_fn(|k| self.builder.graph.sub(all[k], less[k]))
    }

    /// Refuses moments that no body has by the parameters of a scene.
    pub fn possible_inertias(&mut self, bodies: &[Moments]) {
        let of_body = |body: &Moments| [body.values.clone(), body.about.clone().unwrap_or_default().concat()].concat();
        let values: Vec<Id> = bodies.iter().flat_map(of_body).collect();
        let mut told = vec![false; bodies.len()];
        for scene in &self.model.scenes {
            let parameters = self.scene_parameters(scene);
            let numbers = crate::model::command::evaluate_all(&self.builder.graph, &values, &parameters);
            let mut rest = numbers.as_slice();
            for (body, told) in bodies.iter().zip(&mut told) {
                let (own, others) = rest.split_at(body.values.len());
                let (shift, others) =
                    others.split_at(body.about.as_ref().map_or(0, |[all, less]| all.len() + less.len()));
                rest = others;
                if *told || !matches!(own.len(), 1 | 3 | 9) || !own.iter().all(|x| x.is_finite()) {
                    continue;
                }
                let problem = unsymmetric(body, own).or_else(|| impossible(body, own, shift));
                if let Some(problem) = problem {
                    *told = true;
                    match problem.code.starts_with('W') {
                        true => self.model.warnings.push(problem),
                        false => self.builder.problems.push(problem),
                    }
                }
            }
        }
    }
}

/// Moments as written as the elements of a tensor.
pub fn tensor(values: &[Id]) -> Tensor {
    match *values {
        [x, y, z] => [x, y, z, Id::ZERO, Id::ZERO, Id::ZERO],
        [xx, xy, xz, _, yy, yz, _, _, zz] => [xx, yy, zz, xy, xz, yz],
        _ => [Id::ZERO; 6],
    }
}

/// The nine elements of a tensor by rows.
pub fn nine([xx, yy, zz, xy, xz, yz]: &Tensor) -> Vec<Id> {
    vec![*xx, *xy, *xz, *xy, *yy, *yz, *xz, *yz, *zz]
}

/// The moments of a tensor of nine elements, or the one of the plane, in words.
fn diagonal(values: &[f64]) -> String {
    let moments: Vec<String> = values.iter().step_by(4).map(|moment| rounded(*moment).to_string()).collect();
    if let [one] = moments.as_slice() { one.clone() } else { format!("[{}]", moments.join(", ")) }
}

fn unsymmetric(body: &Moments, values: &[f64]) -> Option<crate::diagnose::Problem> {
    if values.len() != 9 {
        return None;
    }
    let scale = values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let unlike = PRODUCTS.iter().find(|(a, b, ..)| (values[*a] - values[*b]).abs() > ROUNDING * scale)?;
    let (a, b, element, other) = unlike;
    let shown = |name: &str, value: f64| format!("{name} = {value}");
    let (element, other) = (shown(element, values[*a]), shown(other, values[*b]));
    Some(mechanics::unsymmetric_inertia(body.place.clone(), &body.name, element, other))
}

fn impossible(body: &Moments, values: &[f64], shift: &[f64]) -> Option<crate::diagnose::Problem> {
    let Impossible { moments, why, few_digits, help } = impossible_moments(values)?;
    let place = body.place.clone();
    if few_digits {
        return Some(mechanics::doubtful_inertia(place, &body.name, moments, why));
    }
    let (all, less) = shift.split_at(shift.len() / 2);
    let help = match &body.about {
        None => help,
        Some(_) => format!(
            "about the centre of mass they are {} less m*d^2 = {}; give larger moments, or a nearer point `about`",
            diagonal(all),
            diagonal(less)
        ),
    };
    Some(mechanics::impossible_inertia(place, &body.name, moments, why, help))
}

/// Why no body has certain moments of inertia.
#[derive(Clone, Debug, PartialEq)]
pub struct Impossible {
    /// The principal moments, the least first.
    pub moments: String,
    /// What is wrong with them.
    pub why: String,
    /// Whether they are off by so little that data of few digits explain it.
    pub few_digits: bool,
    /// What may have been meant.
    pub help: String,
}

/// Whether any body has these moments of inertia, one in the plane, three principal ones or the nine elements of a symmetric tensor, in
/// kg m²: none is negative, and two principal ones are never less than the third together.
pub fn impossible_moments(values: &[f64]) -> Option<Impossible> {
    let principal = principal_moments(values);
    let (excess, why) = violation(&principal)?;
    let moments = match values {
        [one] => rounded(*one).to_string(),
        _ => principal.map(|moment| rounded(moment).to_string()).join(", "),
    };
    let mirrored: Vec<f64> = values.iter().enumerate().map(|(k, x)| if k % 4 == 0 { *x } else { -x }).collect();
    let help = if principal[..2] == [0.0, 0.0] && principal[2] > 0.0 {
        "a body that spins about one axis alone has moments about the others, too: half of this one at the least"
    } else if values.len() == 9 && violation(&principal_moments(&mirrored)).is_none() {
        "with the signs of its products changed a body has it: Ixy = -∫ x y dm, with the minus"
    } else {
        "moments are about the centre of mass; about another point at the distance d they are m*d^2 larger"
    };
    let help = help.to_owned();
    Some(Impossible { moments, why, few_digits: excess <= FEW_DIGITS, help })
}

/// By which part of the largest moment what no body has is off, and what that is; ordered moments.
fn violation([a, b, c]: &[f64; 3]) -> Option<(f64, String)> {
    let scale = a.abs().max(c.abs());
    if scale == 0.0 {
        return None;
    }
    if *a < -ROUNDING * scale {
        return Some((f64::INFINITY, format!("{} is negative", rounded(*a))));
    }
    let excess = (c - a - b) / scale;
    let words = || format!("{} + {} is less than {}", rounded(*a), rounded(*b), rounded(*c));
    (excess > ROUNDING).then(|| (excess, words()))
}

/// To six digits.
fn rounded(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

/// The principal moments of a body whose moments are given by three, or by the nine elements of a tensor, the least first: eigenvalues by
/// Jacobi's rotations (Golub, Van Loan, Matrix Computations, section 8.5).
pub fn principal_moments(values: &[f64]) -> [f64; 3] {
    let mut a = match *values {
        [x] => [[x, 0.0, 0.0], [0.0, x, 0.0], [0.0, 0.0, x]],
        [x, y, z] => [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]],
        _ => std::array::from_fn(|i| std::array::from_fn(|j| values[3 * i.min(j) + i.max(j)])),
    };
    // Convergence is quadratic: some five sweeps reach rounding.
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let element: f64 = a[p][q];
            if element == 0.0 {
                continue;
            }
            let tau = (a[q][q] - a[p][p]) / (2.0 * element);
            let t = tau.signum() / (tau.abs() + tau.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            for row in &mut a {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            let (first, second) = (a[p], a[q]);
            a[p] = std::array::from_fn(|k| c * first[k] - s * second[k]);
            a[q] = std::array::from_fn(|k| s * first[k] + c * second[k]);
        }
    }
    let mut moments = [a[0][0], a[1][1], a[2][2]];
    moments.sort_by(f64::total_cmp);
    moments
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_moments_are_eigenvalues() {
        // Rows of a rotation about (1, 1, 1)/√3 by 120° permute the axes; a general one by hand: eigenvalues 1, 2, 4.
        let found = principal_moments(&[2.0, 1.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 5.0]);
        assert!([1.0, 3.0, 5.0].iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
        assert_eq!(principal_moments(&[3.0, 1.0, 2.0]), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn plates_and_rods_are_possible() {
        assert_eq!(violation(&[1.0, 2.0, 3.0]), None);
        assert_eq!(violation(&[0.0, 1.0, 1.0]), None);
        assert!(violation(&[0.2, 0.3, 0.6]).is_some_and(|(excess, _)| excess > FEW_DIGITS));
        assert!(violation(&[0.2, 0.3, 0.5001]).is_some_and(|(excess, _)| excess < FEW_DIGITS));
    }
}
