//! Equations of motion and single laws made linear about a place, as expressions of the model language.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap as HashMap;

use super::formula::{Formula, Formulas, Notation, Text};
use crate::derive::without_modes;
use crate::diagnose::Place;
use crate::expr::{Angles, Binary, Graph, Id, Node, Rational, Symbol, Unary, expand, partial, rewrite, substitute};
use crate::lower::Program;
use crate::model::{LENGTH, Model, Parameter};

/// What is longer says nothing to a person.
const LONGEST: usize = 400;

/// The place about which something is made linear, at rest: the names of the parameters that say it, none where it is 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct About {
    /// Of each coordinate.
    pub coordinates: Vec<Option<String>>,
    /// Of a spring's length.
    pub length: Option<String>,
    /// The modes of discontinuities about there (−1 or 1 for `sign` and `abs`), `None` where there may be several; those beyond the
    /// list are not known.
    pub modes: Vec<Option<i64>>,
    /// Of coordinates that keep their sign, as distances do, that sign: the root of the square is known.
    pub signs: Vec<Option<i64>>,
}

/// Of which degree in the state a law is that makes linear equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Degree {
    /// A force, a stretch or a rate: linear.
    Linear,
    /// An energy, or a dissipation function: quadratic.
    Quadratic,
}

/// The energies and forces of M q'' + D q' + K (q − q₀) = f(t), with M, D and K those of a model at rest at q₀.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinearEnergies {
    /// ½ q'ᵀ M q', and q'ᵀ b u' where accelerations of inputs u are in f.
    pub kinetic: String,
    /// ½ (q − q₀)ᵀ K (q − q₀), where K ≠ 0 is symmetric.
    pub potential: Option<String>,
    /// ½ q'ᵀ D q', where D ≠ 0 is symmetric.
    pub dissipation: Option<String>,
    /// All else, by the names of coordinates.
    pub forces: Vec<(String, String)>,
}

/// The energies and forces of a model's equations made linear about an equilibrium, which it has while its inputs are 0.
///
/// `None` where there are constraints, phases, or discontinuities of the state, where matrices change with time, or where a
/// formula would be too long to read.
pub fn linear_energies(program: &Program, about: &About) -> Option<LinearEnergies> {
    let model = &mut program.model.clone();
    let mode = |k: usize| about.modes.get(k).copied().flatten();
    let moves = |k: usize| model.graph.symbols([program.switches[k].argument]).into_iter().any(is_motion);
    let unknown = (0..program.switches.len()).any(|k| mode(k).is_none() && moves(k));
    if unknown || !model.constraints.is_empty() || model.phases.len() > 1 {
        return None;
    }
    let place = Rest::new(model, about);
    let residual = place.in_mode(&mut model.graph, &program.residual);
    let residual = without_modes(&mut model.graph, &residual, &program.switches);
    let matrix = |model: &mut Model, entries: &[(usize, usize, Id)]| -> Option<BTreeMap<(usize, usize), Id>> {
        let values: Vec<Id> = entries.iter().map(|entry| entry.2).collect();
        let values = place.in_mode(&mut model.graph, &values);
        let values = place.still(&mut model.graph, &values);
        let constant = model.graph.symbols(values.iter().copied()).into_iter().all(is_parameter);
        let values = expand(&mut model.graph, &values, is_parameter, Angles::Shorter).unwrap_or(values);
        let entries = entries.iter().zip(values).map(|((i, j, _), value)| ((*i, *j), value));
        constant.then(|| entries.filter(|(_, value)| *value != Id::ZERO).collect())
    };
    let mass = matrix(model, &program.mass)?;
    let [stiffness, damping] = [matrix(model, &program.stiffness)?, matrix(model, &program.damping)?];

    let n = model.coordinates.len();
    let [q, v]: [Vec<Id>; 2] = [0, 1].map(|order| (0..n).map(|i| place.moved(&mut model.graph, i, order)).collect());
    let mut kinetic = quadratic(&mut model.graph, &mass, &v);
    let mut forces = vec![Vec::new(); n];
    let resting = place.at(&mut model.graph, &residual);
    for (i, force) in resting.into_iter().enumerate() {
        let (inertial, rest) = driven(&mut model.graph, force, model.inputs.len())?;
        for (input, slope) in inertial {
            let rate = model.graph.symbol(Symbol::Input(input, 1));
            let product = model.graph.mul(slope, rate);
            let term = model.graph.mul(product, v[i]);
            kinetic.push(term);
        }
        forces[i].push(model.graph.neg(rest));
    }
    let mut energy = |matrix: &BTreeMap<(usize, usize), Id>, moved: &[Id]| {
        if is_symmetric(&mut model.graph, matrix) {
            let lower = matrix.iter().filter(|((i, j), _)| i >= j).map(|(at, value)| (*at, *value)).collect();
            return quadratic(&mut model.graph, &lower, moved);
        }
        for ((i, j), value) in matrix {
            let term = model.graph.mul(*value, moved[*j]);
            forces[*i].push(model.graph.neg(term));
        }
        Vec::new()
    };
    let [potential, dissipation] = [energy(&stiffness, &q), energy(&damping, &v)];
    let some = |terms: &[Id]| if terms.is_empty() { Some(None) } else { written(model, terms).map(Some) };
    forces.iter_mut().for_each(|terms| terms.retain(|term| *term != Id::ZERO));
    let forces = forces.iter().zip(&model.coordinates).filter(|(terms, _)| !terms.is_empty());
    Some(LinearEnergies {
        kinetic: written(model, &kinetic)?,
        potential: some(&potential)?,
        dissipation: some(&dissipation)?,
        forces: forces.map(|(terms, c)| Some((c.name.clone(), written(model, terms)?))).collect::<Option<_>>()?,
    })
}

/// One law of a file, its components as they stand there, of this degree in coordinates, speeds and `length` about a place at
/// rest: `k*x` of `k*x*(1 + x^2/L^2)`.
///
/// `None` where it is that already or nothing of it is, where it is not smooth, where its coefficients change with time, and
/// where it would be too long to read.
pub fn linear_law(program: &Program, text: &str, degree: Degree, about: &About) -> Option<Vec<String>> {
    let model = &mut program.model.clone();
    let laws = model.law(text).ok()?;
    if !is_smooth(&model.graph, &laws) {
        return None;
    }
    let place = Rest::new(model, about);
    let (mut changes, mut stays) = (false, false);
    let mut made = |law: Id| -> Option<Vec<Id>> {
        let graph = &mut model.graph;
        let mut sum = match degree {
            Degree::Linear => place.at(graph, &[law]),
            Degree::Quadratic => Vec::new(),
        };
        for x in graph.symbols([law]).into_iter().filter(|x| is_motion(*x)) {
            let slope = partial(graph, law, x);
            let moved = place.away(graph, x);
            let constant = match degree {
                Degree::Linear => place.still(graph, &[slope]),
                Degree::Quadratic => place.at(graph, &[slope]),
            };
            sum.push(graph.mul(constant[0], moved));
            let seconds: Vec<Symbol> = graph.symbols([slope]).into_iter().filter(|y| is_motion(*y)).collect();
            if degree == Degree::Linear {
                coefficient(graph, constant[0])?;
                changes |= !seconds.is_empty();
                stays |= constant[0] != Id::ZERO;
            }
            for y in seconds.into_iter().filter(|_| degree == Degree::Quadratic) {
                let second = partial(graph, slope, y);
                changes |= graph.symbols([second]).into_iter().any(is_motion);
                let constant = place.still(graph, &[second])[0];
                coefficient(graph, constant)?;
                stays |= constant != Id::ZERO;
                let other = place.away(graph, y);
                let product = graph.mul(moved, other);
                let product = graph.mul(constant, product);
                let half = half(graph);
                sum.push(graph.mul(half, product));
            }
        }
        sum.retain(|term| *term != Id::ZERO);
        Some(sum)
    };
    let made: Vec<Vec<Id>> = laws.into_iter().map(&mut made).collect::<Option<_>>()?;
    if !changes || !stays {
        return None;
    }
    made.iter().map(|law| written(model, law)).collect()
}

/// A place at rest, in place of the state, and the modes there.
struct Rest {
    values: HashMap<Symbol, Id>,
    /// Modes, and coordinates where they are the roots of their squares.
    modes: HashMap<Symbol, Id>,
    roots: HashMap<Symbol, Id>,
}

impl Rest {
    fn new(model: &mut Model, about: &About) -> Rest {
        let mut values = HashMap::default();
        let mut named = |symbol: Symbol, name: Option<&String>| {
            let value = name.map_or(Id::ZERO, |name| {
                let (name, unit, place) = (name.clone(), None, Place::default());
                model.parameters.push(Parameter { name, family: None, unit, default: 0.0, place });
                model.graph.symbol(Symbol::Parameter((model.parameters.len() - 1) as u32))
            });
            values.insert(symbol, value);
        };
        named(LENGTH, about.length.as_ref());
        for i in 0..model.coordinates.len() as u32 {
            named(Symbol::Coordinate(i), about.coordinates.get(i as usize).and_then(Option::as_ref));
        }
        for i in 0..model.coordinates.len() as u32 {
            values.extend([Symbol::Speed(i), Symbol::Acceleration(i)].map(|symbol| (symbol, Id::ZERO)));
        }
        let known = about.modes.iter().enumerate().filter_map(|(k, mode)| Some((Symbol::Mode(k as u32), (*mode)?)));
        let modes: HashMap<Symbol, Id> = known.map(|(symbol, mode)| (symbol, model.graph.integer(mode))).collect();
        values.extend(modes.iter().map(|(symbol, mode)| (*symbol, *mode)));
        let signed = about.signs.iter().enumerate().filter_map(|(i, sign)| Some((i as u32, (*sign)?)));
        let root = |(i, sign): (u32, i64)| {
            let coordinate = Symbol::Coordinate(i);
            let own = model.graph.symbol(coordinate);
            (coordinate, if sign > 0 { own } else { model.graph.neg(own) })
        };
        let roots = signed.map(root).collect();
        Rest { values, modes, roots }
    }

    /// Expressions in its modes and with its signs, anywhere.
    fn in_mode(&self, graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
        let roots = substitute(graph, roots, &self.modes);
        rewrite(graph, &roots, |graph, node| {
            let Node::Unary(Unary::Sqrt, square) = node else { return None };
            let Node::Binary(Binary::Mul, x, y) = graph.node(square) else { return None };
            let Node::Symbol(symbol) = graph.node(x) else { return None };
            self.roots.get(&symbol).filter(|_| x == y).copied()
        })
    }

    /// Expressions there, whatever inputs do.
    fn at(&self, graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
        substitute(graph, roots, &self.values)
    }

    /// Expressions there while all inputs are 0.
    fn still(&self, graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
        let roots = self.at(graph, roots);
        let inputs = graph.symbols(roots.iter().copied()).into_iter().filter(|s| matches!(s, Symbol::Input(..)));
        substitute(graph, &roots, &inputs.map(|input| (input, Id::ZERO)).collect())
    }

    /// What a symbol of the state is beyond its place.
    fn away(&self, graph: &mut Graph, symbol: Symbol) -> Id {
        let own = graph.symbol(symbol);
        graph.sub(own, self.values.get(&symbol).copied().unwrap_or(Id::ZERO))
    }

    /// q − q₀ (order 0) or q'.
    fn moved(&self, graph: &mut Graph, coordinate: usize, order: usize) -> Id {
        let i = coordinate as u32;
        self.away(graph, if order == 0 { Symbol::Coordinate(i) } else { Symbol::Speed(i) })
    }
}

/// The coefficients of accelerations of inputs in a force at rest, and what inputs make of it besides; `None` where that is not the
/// inertia of something constant, or where t itself is in it.
fn driven(graph: &mut Graph, force: Id, inputs: usize) -> Option<(Vec<(u32, Id)>, Id)> {
    let mut inertial = Vec::new();
    let mut sharp = HashMap::default();
    for input in 0..inputs as u32 {
        let second = Symbol::Input(input, 2);
        let slope = partial(graph, force, second);
        coefficient(graph, slope)?;
        if slope != Id::ZERO {
            inertial.push((input, slope));
        }
        sharp.insert(second, Id::ZERO);
    }
    let force = substitute(graph, &[force], &sharp)[0];
    let still = graph.symbols([force]).into_iter().filter(|s| matches!(s, Symbol::Input(..)));
    let still: HashMap<Symbol, Id> = still.map(|input| (input, Id::ZERO)).collect();
    let constant = substitute(graph, &[force], &still)[0];
    // An equilibrium: all that is constant cancels.
    coefficient(graph, constant)?;
    if still.is_empty() {
        return Some((inertial, Id::ZERO));
    }
    let rest = graph.sub(force, constant);
    Some((inertial, expand(graph, &[rest], is_parameter, Angles::Shorter)?[0]))
}

/// The terms of ½ Σ mᵢⱼ xᵢ xⱼ of a symmetric matrix's lower triangle.
fn quadratic(graph: &mut Graph, lower: &BTreeMap<(usize, usize), Id>, x: &[Id]) -> Vec<Id> {
    let mut term = |((i, j), value): (&(usize, usize), &Id)| {
        let product = graph.mul(x[*i], x[*j]);
        let term = graph.mul(*value, product);
        let half = half(graph);
        if i == j { graph.mul(half, term) } else { term }
    };
    lower.iter().map(&mut term).collect()
}

fn is_symmetric(graph: &mut Graph, matrix: &BTreeMap<(usize, usize), Id>) -> bool {
    let mut apart = Vec::new();
    for ((i, j), value) in matrix {
        let other = matrix.get(&(*j, *i)).copied().unwrap_or(Id::ZERO);
        apart.push(graph.sub(*value, other));
    }
    expand(graph, &apart, is_parameter, Angles::All).is_some_and(|apart| apart.iter().all(|x| *x == Id::ZERO))
}

fn half(graph: &mut Graph) -> Id {
    let half = Rational::new(1, 2).unwrap_or(Rational::ONE);
    graph.rational(half)
}

/// Some, where an expression is of parameters only.
fn coefficient(graph: &Graph, id: Id) -> Option<()> {
    graph.symbols([id]).into_iter().all(is_parameter).then_some(())
}

fn is_parameter(symbol: Symbol) -> bool {
    matches!(symbol, Symbol::Parameter(_))
}

/// Whether a symbol is of the state, or the length of a spring, which depends on it.
fn is_motion(symbol: Symbol) -> bool {
    matches!(symbol, Symbol::Coordinate(_) | Symbol::Speed(_) | Symbol::Acceleration(_)) || symbol == LENGTH
}

/// Whether the state is in nothing that has a kink or a jump, nor in a table.
fn is_smooth(graph: &Graph, roots: &[Id]) -> bool {
    let moves = graph.contains(is_motion);
    graph
        .needed(roots.iter().copied())
        .into_iter()
        .filter(|id| moves[id.index()])
        .all(|id| !graph.node(id).is_piecewise())
}

/// A sum of terms without names for their parts, if it is short.
fn written(model: &Model, terms: &[Id]) -> Option<String> {
    let mut sum = Vec::new();
    for term in terms {
        // One by one: what stands in several terms needs no name.
        let Formulas { parts, roots } = Formulas::new(&model.graph, &[*term]);
        let (negative, formula) = roots.into_iter().next().filter(|_| parts.is_empty())?;
        match &*formula {
            Formula::Sum(own) => sum.extend(own.iter().map(|(other, own)| (negative != *other, own.clone()))),
            _ => sum.push((negative, formula)),
        }
    }
    let text = Text { model };
    let text = match sum.as_slice() {
        [] => "0".to_owned(),
        [(negative, alone)] => text.signed(*negative, alone),
        _ => text.signed(false, &Formula::Sum(sum)),
    };
    (text.len() <= LONGEST).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::{About, Degree, linear_energies, linear_law};
    use crate::lower::{Program, compile};

    fn program(lines: &str) -> Program {
        let text = format!(
            "name: P\nparameters: {{m: 1 kg, k: 2 N/m, c: 1 N*s/m, L: 1 m, g: 9.81 m/s^2, A: 0.1 m, T: 1 s}}\n\
             coordinates: {{x: m, theta: rad}}\n{lines}"
        );
        compile(&text, &[]).unwrap_or_else(|problems| panic!("{problems:?}"))
    }

    const CART: &str = "inputs: {floor: A*sin(t/T)}
points: {P: \"[x + floor, 0] + L*[sin(theta), -cos(theta)]\"}
bodies: {cart: {mass: m, position: \"[x + floor, 0]\"}, bob: {mass: m, position: P}}
gravity: [0, -g]
springs: {wall: {stretch: x, stiffness: k}}
dampers: {wheels: {rate: \"x'\", damping: c}}
";

    #[test]
    fn small_angles_have_the_textbooks_energies() {
        let found = linear_energies(&program(CART), &About::default()).unwrap();
        assert_eq!(found.kinetic, "m*x'^2 + m*L*x'*theta' + 1/2*m*L^2*theta'^2 + 2*m*floor'*x' + m*L*floor'*theta'");
        assert_eq!(found.potential.as_deref(), Some("1/2*k*x^2 + 1/2*m*L*g*theta^2"));
        assert_eq!(found.dissipation.as_deref(), Some("1/2*c*x'^2"));
        assert_eq!(found.forces, []);
        // About the upper equilibrium, and with a stop, of which nothing is linear.
        let about = About { coordinates: vec![None, Some("top".to_owned())], length: None, ..About::default() };
        let upper = linear_energies(&program(CART), &about).unwrap();
        assert!(upper.potential.unwrap().contains("(theta - top)^2"));
        let stop = format!("{CART}forces: {{stop: {{on: cart, force: \"[-k*max(0, x - L), 0]\"}}}}\n");
        assert_eq!(linear_energies(&program(&stop), &About::default()), None);
    }

    #[test]
    fn a_distance_that_keeps_its_sign_is_one() {
        // √(x² sin² θ + x² cos² θ) is |x|.
        let polar = program(
            "points: {O: [0, 0]}\nbodies: {bob: {mass: m, position: \"x*[sin(theta), -cos(theta)]\"}}\ngravity: [0, -g]\n\
             springs: {s: {between: [O, bob], stiffness: k, rest: L}}\n",
        );
        let coordinates = vec![Some("r".to_owned()), None];
        let found = linear_energies(&polar, &About { coordinates, signs: vec![Some(1)], ..About::default() }).unwrap();
        assert_eq!(found.kinetic, "1/2*m*x'^2 + 1/2*m*r^2*theta'^2");
        assert_eq!(found.potential.as_deref(), Some("1/2*k*(x - r)^2 + 1/2*m*g*r*theta^2"));
        assert_eq!(found.forces, []);
        // So is what the file calls |x|.
        let sided = program("kinetic_energy: m*(x'^2 + L^2*theta'^2)/2\npotential_energy: k*(abs(x) - L)^2/2\n");
        let about = About { coordinates: vec![Some("r".to_owned()), None], modes: vec![Some(-1)], ..About::default() };
        assert_eq!(linear_energies(&sided, &About { modes: Vec::new(), ..about.clone() }), None);
        assert_eq!(linear_energies(&sided, &about).unwrap().potential.as_deref(), Some("1/2*k*(x - r)^2"));
    }

    #[test]
    fn forces_without_an_energy_stay_forces() {
        let lines = "kinetic_energy: m*(x'^2 + L^2*theta'^2)/2\npotential_energy: k*x^2/2\n\
                     generalized_forces: {x: \"-k*L*sin(theta) + c*L*theta'\", theta: \"k*L*x - c*L*x'\"}\n";
        let found = linear_energies(&program(lines), &About::default()).unwrap();
        assert_eq!((found.potential, found.dissipation), (None, None));
        let forces: Vec<&str> = found.forces.iter().map(|(_, force)| force.as_str()).collect();
        assert_eq!(forces, ["-k*x - k*L*theta + c*L*theta'", "k*L*x - c*L*x'"]);
    }

    #[test]
    fn laws_keep_what_is_linear_in_them() {
        let program = program(CART);
        let law = |text: &str, degree: Degree| linear_law(&program, text, degree, &About::default());
        let some = |parts: &[&str]| Some(parts.iter().map(|part| (*part).to_owned()).collect::<Vec<_>>());
        assert_eq!(law("-k*x*(1 + (x/L)^2)", Degree::Linear), some(&["-k*x"]));
        assert_eq!(law("[k*floor - k*x - c*x'*(1 + x/L), 0]", Degree::Linear), some(&["k*floor - k*x - c*x'", "0"]));
        assert_eq!(law("k*L^2*(1 - cos(theta))", Degree::Quadratic), some(&["1/2*k*L^2*theta^2"]));
        // Linear already; nothing of it; not smooth; changing with time.
        for none in ["-k*x", "-k*x^2/L", "-k*x*(1 + abs(x)/L)", "-k*x*(1 + x/L)*sin(t/T)"] {
            assert_eq!(law(none, Degree::Linear), None, "{none}");
        }
        assert_eq!(law("k*x^2/2", Degree::Quadratic), None);
        let about = About { coordinates: Vec::new(), length: Some("l_0".to_owned()), ..About::default() };
        let spring = linear_law(&program, "k*(length - L)^3/L^2", Degree::Linear, &about).unwrap();
        assert_eq!(spring, ["k*(l_0 - L)^3/L^2 + 3*k*(l_0 - L)^2*(length - l_0)/L^2"]);
    }
}
