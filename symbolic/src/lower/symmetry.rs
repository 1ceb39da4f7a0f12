//! Exchanges and reflections of coordinates under which the equations of motion stay as they are.

use std::collections::HashSet;

use super::{Entry, Program};
use crate::expr::{Measured, Tape};
use crate::gate::{State, mixed};
use crate::number::DoubleDouble;
use crate::random::Random;

/// A linear map q → S q that is its own inverse: coordinates stay, change their sign, or are exchanged in pairs, with a change of sign
/// or without.  F(t, S q, S q', S q'') = S F(t, q, q', q''): if q(t) is a motion, S q(t) is one, and a motion that begins with
/// q = S q and q' = S q' keeps both.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Symmetry {
    /// For each coordinate the one in whose place it comes, and whether with the opposite sign.
    pub images: Vec<(usize, bool)>,
}

/// The symmetries of a mechanism with certain parameters.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Symmetries {
    /// All that were found, those that move fewest coordinates first.
    pub found: Vec<Symmetry>,
    /// Whether all maps of this kind were tried.
    pub complete: bool,
}

/// States at which a map must hold.
const STATES: usize = 8;
/// No more maps are tried.
const MOST: usize = 20_000;
/// Products of symmetries that are known are not counted beyond these.
const PRODUCTS: usize = 4096;
/// Twenty digits.
const ROUNDINGS: f64 = 1e-20 / DoubleDouble::UNIT;

/// Searches for symmetries with these values of the free parameters; `None` where constraints, discontinuities, phases, states of first
/// order or held values act, of which nothing is asked.
///
/// A map is tried at random states, each equation judged by the magnitude of its own terms to 20 digits; what it does to M, ∂F/∂q,
/// ∂F/∂q' and F at the origin, where they are defined, says beforehand which cannot hold.
pub fn symmetries(program: &Program, parameters: &[f64]) -> Option<Symmetries> {
    let simple = program.constraints.is_empty()
        && program.switches.is_empty()
        && program.model.phases.len() <= 1
        && program.model.states.is_empty()
        && program.model.memory.is_empty();
    let n = program.model.coordinates.len();
    let states = &program.report.states;
    if !simple || states.is_empty() || n == 0 {
        return None;
    }
    let program = &*program.formed()?;
    let tape = Tape::new(&program.model.graph, &program.residual);
    let mut random = Random::new();
    let state = |_| {
        let mut state = mixed(states, &mut random);
        state.parameters = parameters.to_vec();
        let size =
            state.a.iter().fold(1.0_f64, |most, a| if a.magnitude.is_finite() { most.max(a.magnitude) } else { most });
        state.a = (0..n).map(|_| Measured::exact(random.between(-size, size).into())).collect();
        let forces = tape.evaluate(|s| state.measured(s));
        (state, forces)
    };
    let states = (0..STATES).map(state).collect();
    let unit = |i: usize| program.model.coordinates[i].unit.clone();
    let alike = (0..n).map(|i| (0..n).filter(|j| unit(i) == unit(*j)).collect()).collect();
    let mut search =
        Search { tape: &tape, states, alike, origin: Origin::of(program, parameters), tried: 0, found: Vec::new() };
    let complete = search.extend(&mut vec![None; n]);
    let mut found = search.found;
    found.sort_by_key(|symmetry| symmetry.images.iter().enumerate().filter(|(i, to)| **to != (*i, false)).count());
    Some(Symmetries { found, complete })
}

impl Symmetry {
    /// S x.
    pub fn of(&self, x: &[f64]) -> Vec<f64> {
        self.images.iter().map(|(i, opposite)| if *opposite { -x[*i] } else { x[*i] }).collect()
    }

    /// This one after another.
    fn after(&self, other: &Symmetry) -> Symmetry {
        let image = |&(i, opposite): &(usize, bool)| (other.images[i].0, opposite != other.images[i].1);
        Symmetry { images: self.images.iter().map(image).collect() }
    }
}

/// Those of a list that are no products of others before them.
pub fn generators(symmetries: &[Symmetry]) -> Vec<Symmetry> {
    let Some(first) = symmetries.first() else { return Vec::new() };
    let mut known = HashSet::from([first.after(first)]);
    let mut kept = Vec::new();
    for symmetry in symmetries {
        if known.contains(symmetry) {
            continue;
        }
        kept.push(symmetry.clone());
        let mut new: Vec<Symmetry> = known.iter().cloned().collect();
        while let Some(product) = new.pop() {
            for generator in &kept {
                let next = product.after(generator);
                if known.len() < PRODUCTS && known.insert(next.clone()) {
                    new.push(next);
                }
            }
        }
    }
    kept
}

/// Maps are built coordinate by coordinate.
struct Search<'a> {
    tape: &'a Tape,
    /// With F there.
    states: Vec<(State, Vec<Measured>)>,
    /// For each coordinate those of its unit.
    alike: Vec<Vec<usize>>,
    origin: Origin,
    tried: usize,
    found: Vec<Symmetry>,
}

impl Search<'_> {
    /// Tries all ways to go on; false where there were too many.
    fn extend(&mut self, images: &mut Vec<Option<(usize, bool)>>) -> bool {
        let Some(i) = images.iter().position(Option::is_none) else {
            self.tried += 1;
            let symmetry = Symmetry { images: images.iter().flatten().copied().collect() };
            if symmetry.images.iter().enumerate().any(|(i, to)| *to != (i, false)) && self.holds(&symmetry) {
                self.found.push(symmetry);
            }
            return self.tried < MOST;
        };
        for j in self.alike[i].clone().into_iter().filter(|j| *j >= i) {
            for opposite in [false, true] {
                if images[j].is_some() {
                    continue;
                }
                (images[i], images[j]) = (Some((j, opposite)), Some((i, opposite)));
                let goes_on = !self.origin.allows(images, [i, j]) || self.extend(images);
                (images[i], images[j]) = (None, None);
                if !goes_on {
                    return false;
                }
            }
        }
        true
    }

    /// Whether F(S q, S q', S q'') = S F(q, q', q'') at all states.
    fn holds(&self, symmetry: &Symmetry) -> bool {
        self.states.iter().all(|(state, forces)| {
            let turned = |list: &[DoubleDouble]| -> Vec<DoubleDouble> {
                symmetry.images.iter().map(|(i, opposite)| if *opposite { -list[*i] } else { list[*i] }).collect()
            };
            let mut image = state.clone();
            (image.q, image.v) = (turned(&state.q), turned(&state.v));
            let a: Vec<DoubleDouble> = state.a.iter().map(|a| a.value).collect();
            image.a = turned(&a).into_iter().map(Measured::exact).collect();
            let found = self.tape.evaluate(|s| image.measured(s));
            let expected = symmetry.images.iter().map(|(i, opposite)| (forces[*i], *opposite));
            found.iter().zip(expected).all(|(found, (force, opposite))| same(*found, force, opposite))
        })
    }
}

/// Whether two numbers are the same, or opposite.
fn same(a: Measured, b: Measured, opposite: bool) -> bool {
    let value = if opposite { a.value + b.value } else { a.value - b.value };
    Measured { value, magnitude: a.magnitude + b.magnitude }.vanishes(ROUNDINGS)
}

/// M, ∂F/∂q and ∂F/∂q' at the origin, which every map leaves where it is; those that are defined there.
struct Origin {
    matrices: Vec<Vec<Measured>>,
    forces: Vec<Measured>,
    n: usize,
}

impl Origin {
    fn of(program: &Program, parameters: &[f64]) -> Origin {
        let graph = &program.model.graph;
        let n = program.model.coordinates.len();
        let mut origin = State::at_rest(parameters.to_vec(), n);
        origin.inputs = program.report.states.first().map_or_else(Vec::new, |state| state.inputs.clone());
        origin.t = program.report.states.first().map_or(DoubleDouble::ZERO, |state| state.t);
        let zero = Measured::exact(DoubleDouble::ZERO);
        let defined = |list: &[Measured]| list.iter().all(|x| x.magnitude.is_finite() && x.value.is_finite());
        let matrix = |entries: &[Entry], symmetric: bool| {
            let roots: Vec<_> = entries.iter().map(|entry| entry.2).collect();
            let values = Tape::new(graph, &roots).evaluate(|s| origin.measured(s));
            let mut matrix = vec![zero; n * n];
            for ((i, j, _), value) in entries.iter().zip(values) {
                matrix[i * n + j] = value;
                if symmetric {
                    matrix[j * n + i] = value;
                }
            }
            defined(&matrix).then_some(matrix)
        };
        let matrices =
            [matrix(&program.mass, true), matrix(&program.stiffness, false), matrix(&program.damping, false)];
        let forces = Tape::new(graph, &program.residual).evaluate(|s| origin.measured(s));
        let forces = if defined(&forces) { forces } else { vec![zero; n] };
        Origin { matrices: matrices.into_iter().flatten().collect(), forces, n }
    }

    /// Whether a map that is known in part may hold, the images of these coordinates being new.
    fn allows(&self, images: &[Option<(usize, bool)>], new: [usize; 2]) -> bool {
        let known = || images.iter().enumerate().filter_map(|(i, image)| Some((i, (*image)?)));
        let fits = |(i, (to, opposite)): (usize, (usize, bool))| {
            let pairs = |(k, (other, start_conditions)): (usize, (usize, bool))| {
                self.matrices.iter().all(|matrix| {
                    let [before, after] = [(i, k), (to, other)].map(|(row, column)| matrix[row * self.n + column]);
                    let [left, right] = [(k, i), (other, to)].map(|(row, column)| matrix[row * self.n + column]);
                    same(before, after, opposite != start_conditions) && same(left, right, opposite != start_conditions)
                })
            };
            same(self.forces[to], self.forces[i], opposite) && known().all(pairs)
        };
        known().filter(|(i, _)| new.contains(i)).all(fits)
    }
}
