//! Routh's procedure: equations of motion without the coordinates that can be ignored, whose momenta are constants instead.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap as HashMap;

use super::count::operations;
use super::factor::{self, Accelerations};
use super::{Entry, Program, forms, gather};
use crate::diagnose::Place;
use crate::expr::{Graph, Id, Measured, Symbol, Tape, substitute};
use crate::gate::{State, mixed};
use crate::model::{Model, Parameter};
use crate::number::DoubleDouble;
use crate::random::Random;

/// M_r s'' + h_r = 0 with
///
/// M_r = M_ss − M_sc M_cc⁻¹ M_cs, h_r = h_s − M_sc M_cc⁻¹ h_c, c' = M_cc⁻¹ (μ − b − M_cs s'),
///
/// where c are the coordinates and directions on which nothing depends, s the coordinates that are left, and μ = M_cc c' + M_cs s' + b the
/// momenta, which are conserved (E. J. Routh, A Treatise on the Stability of a Given State of Motion, 1877).  Of a direction
/// q = s + u c, u_k ≠ 0, coordinate k goes, and the others are counted from it: s_i = q_i − (u_i/u_k) q_k.
///
/// Where M_cc vanishes, as on the axis of a spherical pendulum, c' and with it h_r are infinite unless μ is 0.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// The model with the momenta as parameters more; all expressions are in its graph.
    pub model: Model,
    /// The coordinates that are left.
    pub kept: Vec<usize>,
    /// Those that go.
    pub ignored: Vec<Ignored>,
    /// M_r's lower triangle, by places in `kept`.
    pub mass: Vec<Entry>,
    /// h_r.
    pub bias: Vec<Id>,
    /// Operations of s''.
    pub operations: usize,
    /// Operations of all c', for who wants them: c by quadrature.
    pub rate_operations: usize,
    /// The largest difference of its accelerations, and of c', from those of all equations, in parts of their terms.
    pub worst: f64,
    /// At how many random states.
    pub states: usize,
}

/// A coordinate that can be ignored.
#[derive(Clone, Debug)]
pub struct Ignored {
    /// Its place.
    pub coordinate: usize,
    /// Which coordinates are shifted, by how much: itself alone, or a direction.
    pub shift: Vec<(usize, i64)>,
    /// Its momentum, of the whole state.
    pub momentum: Id,
    /// The parameter that is the momentum.
    pub parameter: usize,
    /// c', of what is left.
    pub rate: Id,
}

impl Ignored {
    /// By how much it is itself shifted.
    pub fn own(&self) -> i64 {
        self.shift.iter().find(|(i, _)| *i == self.coordinate).map_or(1, |(_, times)| *times)
    }
}

/// Why equations are not reduced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotReduced {
    /// Constraints, discontinuities, phases, states of first order or held values act, of which nothing is asked.
    NotSmooth,
    /// Every coordinate matters.
    NothingIgnorable,
    /// No coordinate is left: all are given by their momenta.
    NothingLeft,
    /// They would take too many operations to write down.
    TooLarge,
    /// They differ from all equations by this part of their terms: rounding, where M_cc is nearly singular.
    Differs {
        /// The part.
        worst: f64,
    },
}

/// States at which accelerations are compared.
const STATES: usize = 20;
/// By no more than this part of their terms may they differ.
const AGREES: f64 = 1e-12;

/// Reduces the equations of motion by all that can be ignored.
///
/// # Errors
/// Why there is nothing to reduce.
pub fn routh(program: &Program) -> Result<Reduced, NotReduced> {
    let plain = program.constraints.is_empty()
        && program.switches.is_empty()
        && program.model.states.is_empty()
        && program.model.memory.is_empty();
    if !plain || program.model.phases.len() > 1 {
        return Err(NotReduced::NotSmooth);
    }
    let program = &*program.formed().ok_or(NotReduced::TooLarge)?;
    let mut model = program.model.clone();
    let mut ignored = ignored(program, &mut model);
    let n = model.coordinates.len();
    let kept: Vec<usize> = (0..n).filter(|i| ignored.iter().all(|c| c.coordinate != *i)).collect();
    if ignored.is_empty() {
        return Err(NotReduced::NothingIgnorable);
    }
    if kept.is_empty() {
        return Err(NotReduced::NothingLeft);
    }
    let (mass, bias) = reduce(program, &mut model.graph, &kept, &mut ignored).ok_or(NotReduced::TooLarge)?;
    let (mass, bias, accelerations) = cheapest(&mut model.graph, kept.len(), mass, bias).ok_or(NotReduced::TooLarge)?;
    let Accelerations::Unrolled { values, .. } = &accelerations else { return Err(NotReduced::TooLarge) };
    if model.graph.overflowed() {
        return Err(NotReduced::TooLarge);
    }
    let rates: Vec<Id> = ignored.iter().map(|c| c.rate).collect();
    let (worst, states) = compared(program, (&model, &kept, &ignored), (values, &rates)).ok_or(NotReduced::TooLarge)?;
    // A NaN is no agreement either.
    if !matches!(worst.partial_cmp(&AGREES), Some(std::cmp::Ordering::Less)) {
        return Err(NotReduced::Differs { worst });
    }
    Ok(Reduced {
        operations: accelerations.operations(&model.graph, kept.len(), &mass, &bias),
        rate_operations: operations(&model.graph, &rates),
        model,
        kept,
        ignored,
        mass,
        bias,
        worst,
        states,
    })
}

/// Cyclic coordinates, and of each ignorable direction the first coordinate that no other direction shifts.
fn ignored(program: &Program, model: &mut Model) -> Vec<Ignored> {
    let structure = &program.structure;
    let alone = structure.cyclic.iter().map(|(i, momentum)| (*i, vec![(*i, 1)], *momentum));
    let others = |k: usize| structure.directions.iter().enumerate().filter(move |(other, _)| *other != k);
    let together = structure.directions.iter().enumerate().filter_map(|(k, direction)| {
        let shifts = |i: usize| others(k).any(|(_, other)| other.shift.iter().any(|(j, _)| *j == i));
        let own = direction.shift.iter().find(|(i, _)| !shifts(*i))?;
        Some((own.0, direction.shift.clone(), direction.momentum))
    });
    let found: Vec<_> = alone.chain(together).collect();
    let with_parameter = |(coordinate, shift, momentum): (usize, Vec<(usize, i64)>, Id)| {
        let name = format!("mu_{}", model.coordinates[coordinate].name);
        model.parameters.push(Parameter { name, family: None, unit: None, default: 0.0, place: Place::default() });
        let parameter = model.parameters.len() - 1;
        Ignored { coordinate, shift, momentum, parameter, rate: Id::ZERO }
    };
    found.into_iter().map(with_parameter).collect()
}

/// M_r and h_r, and c' of each coordinate that goes.
fn reduce(
    program: &Program,
    graph: &mut Graph,
    kept: &[usize],
    ignored: &mut [Ignored],
) -> Option<(Vec<Entry>, Vec<Id>)> {
    let left = kept.len();
    let Transformed { mass, bias, n } = Transformed::of(program, graph, kept, ignored);
    let count = ignored.len();
    let coupled: Vec<Entry> = (0..count)
        .flat_map(|a| (0..=a).map(move |b| (a, b)))
        .map(|(a, b)| (a, b, mass[(left + a) * n + left + b]))
        .filter(|entry| entry.2 != Id::ZERO)
        .collect();
    // M_cc⁻¹ x.
    let solved = |graph: &mut Graph, x: &[Id]| {
        let opposite: Vec<Id> = x.iter().map(|x| graph.neg(*x)).collect();
        match factor::accelerations(graph, count, &coupled, &opposite, &[]) {
            Accelerations::Unrolled { values, .. } => Some(values),
            Accelerations::Loop => None,
        }
    };
    let mut rest = Vec::with_capacity(count);
    for (k, c) in ignored.iter().enumerate() {
        let resting = (0..program.model.coordinates.len() as u32).map(|i| (Symbol::Speed(i), Id::ZERO));
        let at_rest = substitute(graph, &[c.momentum], &resting.chain(places_gone(ignored)).collect())[0];
        let constant = graph.symbol(Symbol::Parameter(c.parameter as u32));
        let mut own = graph.sub(constant, at_rest);
        for (s, i) in kept.iter().enumerate() {
            let speed = graph.symbol(Symbol::Speed(*i as u32));
            let term = graph.mul(mass[(left + k) * n + s], speed);
            own = graph.sub(own, term);
        }
        rest.push(own);
    }
    let rates = solved(graph, &rest)?;
    ignored.iter_mut().zip(&rates).for_each(|(c, rate)| c.rate = *rate);
    let speeds = speeds(graph, program.model.coordinates.len(), kept, ignored);
    let bias = substitute(graph, &bias, &speeds);

    let across: Vec<Vec<Id>> = (0..left)
        .map(|s| solved(graph, &(0..count).map(|k| mass[(left + k) * n + s]).collect::<Vec<_>>()))
        .collect::<Option<_>>()?;
    let of_bias = solved(graph, &bias[left..])?;
    let less = |graph: &mut Graph, from: Id, row: usize, by: &[Id]| {
        (0..count).fold(from, |sum, k| {
            let term = graph.mul(mass[row * n + left + k], by[k]);
            graph.sub(sum, term)
        })
    };
    let mut reduced = Vec::new();
    for a in 0..left {
        for b in 0..=a {
            reduced.push((a, b, less(graph, mass[a * n + b], a, &across[b])));
        }
    }
    let bias = (0..left).map(|a| less(graph, bias[a], a, &of_bias)).collect();
    Some((reduced, bias))
}

/// The equations of motion along the columns by which all coordinates move with s and c.
struct Transformed {
    /// M, row by row.
    mass: Vec<Id>,
    /// h.
    bias: Vec<Id>,
    /// How many columns there are.
    n: usize,
}

impl Transformed {
    fn of(program: &Program, graph: &mut Graph, kept: &[usize], ignored: &[Ignored]) -> Transformed {
        let columns: Vec<Vec<(usize, i64)>> =
            kept.iter().map(|i| vec![(*i, 1)]).chain(ignored.iter().map(|c| c.shift.clone())).collect();
        let n = columns.len();
        let mut full = BTreeMap::new();
        for (i, j, value) in &program.mass {
            full.insert((*i, *j), *value);
            full.insert((*j, *i), *value);
        }
        let mut mass = vec![Id::ZERO; n * n];
        for (a, first) in columns.iter().enumerate() {
            for (b, second) in columns.iter().enumerate() {
                let pairs = first.iter().flat_map(|(i, x)| second.iter().map(move |(j, y)| ((*i, *j), x * y)));
                mass[a * n + b] = combined(graph, pairs.filter_map(|(at, times)| Some((*full.get(&at)?, times))));
            }
        }
        let bias: Vec<Id> =
            columns.iter().map(|column| combined(graph, column.iter().map(|(i, x)| (program.bias[*i], *x)))).collect();
        let gone = places_gone(ignored).collect();
        Transformed { mass: substitute(graph, &mass, &gone), bias: substitute(graph, &bias, &gone), n }
    }
}

/// 0 for the place of each coordinate that goes: on none of them anything depends.
fn places_gone(ignored: &[Ignored]) -> impl Iterator<Item = (Symbol, Id)> {
    ignored.iter().map(|c| (Symbol::Coordinate(c.coordinate as u32), Id::ZERO))
}

/// The speeds of all `n` coordinates by those that are kept and by c'.
fn speeds(graph: &mut Graph, n: usize, kept: &[usize], ignored: &[Ignored]) -> HashMap<Symbol, Id> {
    let mut speeds: HashMap<Symbol, Id> = HashMap::default();
    for i in 0..n {
        let own = if kept.contains(&i) { graph.symbol(Symbol::Speed(i as u32)) } else { Id::ZERO };
        let shifted =
            ignored.iter().flat_map(|c| c.shift.iter().filter(|(j, _)| *j == i).map(|(_, times)| (c.rate, *times)));
        let shifted = combined(graph, shifted);
        speeds.insert(Symbol::Speed(i as u32), graph.add(own, shifted));
    }
    speeds
}

/// Σ xᵢ, each so many times.
fn combined(graph: &mut Graph, terms: impl Iterator<Item = (Id, i64)>) -> Id {
    terms.fold(Id::ZERO, |sum, (x, times)| {
        let times = graph.integer(times);
        let term = graph.mul(times, x);
        graph.add(sum, term)
    })
}

/// M_r and h_r as they are, or multiplied out, whichever give s'' in fewest operations.
fn cheapest(
    graph: &mut Graph,
    n: usize,
    mass: Vec<Entry>,
    bias: Vec<Id>,
) -> Option<(Vec<Entry>, Vec<Id>, Accelerations)> {
    let roots: Vec<Id> = mass.iter().map(|entry| entry.2).chain(bias).collect();
    let mut candidates = forms::expanded(graph, &roots);
    candidates.insert(0, ("as derived", roots));
    let made = candidates.into_iter().map(|(_, roots)| {
        let values = gather::gather(graph, &roots);
        let entries = mass.iter().zip(&values).map(|((i, j, _), value)| (*i, *j, *value));
        let entries: Vec<Entry> = entries.filter(|entry| entry.2 != Id::ZERO).collect();
        let bias = values[mass.len()..].to_vec();
        let accelerations = factor::accelerations(graph, n, &entries, &bias, &[]);
        let count = accelerations.operations(graph, n, &entries, &bias);
        (count, (entries, bias, accelerations))
    });
    made.min_by_key(|(count, _)| *count).map(|(_, made)| made)
}

/// How far s'' and c' are from what all equations give, in parts of their terms, at random states where these are defined; `None` where none
/// is found or the full equations are not written out.
fn compared(
    program: &Program,
    (model, kept, ignored): (&Model, &[usize], &[Ignored]),
    (accelerations, rates): (&[Id], &[Id]),
) -> Option<(f64, usize)> {
    let Accelerations::Unrolled { values, .. } = &program.accelerations else { return None };
    let full = Tape::new(&program.model.graph, values);
    let momenta = Tape::new(&model.graph, &ignored.iter().map(|c| c.momentum).collect::<Vec<_>>());
    let reduced = Tape::new(&model.graph, &[accelerations, rates].concat());
    let free = program.model.parameters.len();
    // What is left of a quantity of all coordinates, and what goes.
    let split = |x: &[DoubleDouble]| -> Vec<DoubleDouble> {
        let mut left = x.to_vec();
        for c in ignored {
            let each = x[c.coordinate] / DoubleDouble::from(c.own() as f64);
            c.shift.iter().for_each(|(i, times)| left[*i] = left[*i] - each * *times as f64);
        }
        left
    };
    let (mut random, mut worst, mut count) = (Random::new(), 0.0_f64, 0);
    for _ in 0..8 * STATES {
        if count == STATES || program.report.states.is_empty() {
            break;
        }
        let state = mixed(&program.report.states, &mut random);
        let measured: Vec<Measured> = full.evaluate(|symbol| state.measured(symbol));
        let constants: Vec<DoubleDouble> = momenta.evaluate(|symbol| state.value(symbol));
        let left = State { q: split(&state.q), v: split(&state.v), ..state.clone() };
        let known = |symbol: Symbol| match symbol {
            Symbol::Parameter(k) if k as usize >= free => Measured::exact(constants[k as usize - free]),
            symbol => left.measured(symbol),
        };
        let found: Vec<Measured> = reduced.evaluate(known);
        let finite = |list: &[Measured]| list.iter().all(|x| x.value.is_finite() && x.magnitude.is_finite());
        if !finite(&measured) || !finite(&found) {
            continue;
        }
        let own = split(&measured.iter().map(|a| a.value).collect::<Vec<_>>());
        let speed = |c: &Ignored| state.v[c.coordinate] / DoubleDouble::from(c.own() as f64);
        let expected = kept.iter().map(|i| own[*i]).chain(ignored.iter().map(speed));
        let largest = measured.iter().fold(0.0_f64, |most, a| most.max(a.magnitude));
        for (place, (found, expected)) in found.iter().zip(expected).enumerate() {
            let size = if place < kept.len() { found.magnitude.max(largest) } else { found.magnitude };
            let off = (found.value - expected).to_f64().abs();
            worst = if off.is_nan() { off } else { worst.max(if off > 0.0 { off / size } else { 0.0 }) };
        }
        count += 1;
    }
    (count > 0).then_some((worst, count))
}

#[cfg(test)]
mod tests {
    use super::{NotReduced, Reduced, routh};
    use crate::expr::{Symbol, Tape};
    use crate::lower::compile;

    fn reduced(text: &str) -> Result<Reduced, NotReduced> {
        routh(&compile(text, &[]).unwrap_or_else(|problems| panic!("{problems:?}")))
    }

    const SPHERICAL: &str = "name: Spherical
parameters: {m: 2 kg, L: 3 m, g: 9.81 m/s^2, c: 0 N*m*s}
coordinates: {theta: rad, phi: rad}
bodies: {bob: {mass: m, position: \"L*[sin(theta)*cos(phi), sin(theta)*sin(phi), -cos(theta)]\"}}
gravity: [0, 0, -g]
scene: {start: {theta: 1, phi': 2}, until: 1}
";

    #[test]
    fn a_spherical_pendulum_has_its_effective_potential() {
        let found = reduced(SPHERICAL).unwrap();
        assert_eq!((found.kept.as_slice(), found.ignored[0].coordinate), (&[0][..], 1));
        assert!(found.worst < 1e-25 && found.states == 20, "{} {}", found.worst, found.states);
        // The study's: 10 operations.
        assert!(found.operations <= 12, "{}", found.operations);
        let (m, l, g, mu, theta) = (2.0_f64, 3.0_f64, 9.81_f64, 5.0_f64, 0.7_f64);
        let value = |symbol: Symbol| match symbol {
            Symbol::Parameter(k) => [m, l, g, 0.0, mu][k as usize],
            Symbol::Coordinate(0) => theta,
            Symbol::Speed(0) => 0.3,
            other => panic!("{other:?}"),
        };
        let roots = [found.mass[0].2, found.bias[0], found.ignored[0].rate];
        let [mass, bias, rate]: [f64; 3] =
            Tape::new(&found.model.graph, &roots).evaluate(value).try_into().expect("three");
        let (sin, cos) = theta.sin_cos();
        // Only the ratio of M_r and h_r is the motion's.
        let expected = (m * g * l * sin - mu * mu * cos / (m * l * l * sin.powi(3))) / (m * l * l);
        assert!((bias / mass / expected - 1.0).abs() < 1e-14, "{bias} {mass}");
        assert!((rate / (mu / (m * l * l * sin * sin)) - 1.0).abs() < 1e-14, "{rate}");
    }

    #[test]
    fn a_direction_goes_with_its_first_coordinate() {
        let links = "name: Links
parameters: {m: 1 kg, L: 1 m}
coordinates: {a: rad, b: rad, c: rad}
points: {P: \"L*[cos(a), sin(a)]\", Q: \"P + L*[cos(b), sin(b)]\", R: \"Q + L*[cos(c), sin(c)]\"}
bodies: {p: {mass: m, position: P}, q: {mass: m, position: Q}, r: {mass: 2*m, position: R}}
scene: {start: {a: 0.3, b: 1, a': 1}, until: 1}
";
        let found = reduced(links).unwrap();
        assert_eq!((found.kept.as_slice(), found.ignored.len(), found.ignored[0].coordinate), (&[1, 2][..], 1, 0));
        assert_eq!(found.ignored[0].shift, [(0, 1), (1, 1), (2, 1)]);
        assert!(found.worst < 1e-20, "{}", found.worst);
        // In other ratios, beside a coordinate that is cyclic by itself, with a mass between 1e-12 and 1e12 of the other.
        for ratio in ["1e-12", "1", "1e12"] {
            let gears = format!(
                "name: Gears\nparameters: {{I: 1 kg*m^2, e: {ratio}, k: 5 N*m}}
coordinates: {{c: rad, a: rad, b: rad}}
kinetic_energy: I*(a'^2 + e*b'^2*(2 + cos(3*a - 2*b)) + 0.5*e*a'*b')/2 + I*(c' + a')^2/2
potential_energy: k*(3*a - 2*b)^2/2
"
            );
            let found = reduced(&gears).unwrap();
            let shifts: Vec<_> = found.ignored.iter().map(|c| c.shift.clone()).collect();
            assert_eq!((found.kept.as_slice(), shifts), (&[2][..], vec![vec![(0, 1)], vec![(1, 2), (2, 3)]]));
            assert!(found.worst < 1e-12 && found.states == 20, "{ratio}: {}", found.worst);
        }
    }

    #[test]
    fn what_cannot_be_reduced_says_why() {
        // However small a drag, the momentum is not conserved.
        let drag = SPHERICAL.replace("gravity:", "generalized_forces: {phi: -c*phi'}\ngravity:");
        assert_eq!(reduced(&drag).unwrap_err(), NotReduced::NothingIgnorable);
        let free = "name: F\nparameters: {m: 1 kg}\ncoordinates: {x: m}\nkinetic_energy: m*x'^2/2\n";
        assert_eq!(reduced(free).unwrap_err(), NotReduced::NothingLeft);
        let dry = SPHERICAL.replace("gravity:", "generalized_forces: {theta: -0.1*m*g*L*sign(theta')}\ngravity:");
        assert_eq!(reduced(&dry).unwrap_err(), NotReduced::NotSmooth);
    }
}
