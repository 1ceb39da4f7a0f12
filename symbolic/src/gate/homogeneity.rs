//! Whether anything depends on the length of a quaternion that stands for a rotation.

use super::motion::Motion;
use super::state::{State, describe};
use crate::diagnose::Problem;
use crate::diagnose::catalogue::verdicts;
use crate::expr::Measured;
use crate::model::{Model, RotationCoordinate};
use crate::number::DoubleDouble;

/// What a quaternion and its rate are multiplied by: no power of 2, which would leave every rounding as it is.
const FACTOR: f64 = 1.7;
/// The part of its terms by which an acceleration may change: a million roundings of double-double.
const UNCHANGED: f64 = 1e-25;

/// The largest change of an acceleration, as a part of its terms, by another length of each rotation's quaternion; the length of one that
/// matters is an error.  Nothing is asked where friction leaves many accelerations: which of them is found depends on everything.
pub(super) fn lengths(model: &Model, motion: &Motion, states: &[State]) -> Result<Vec<(String, f64)>, Box<Problem>> {
    let mut found = Vec::new();
    for rotation in &model.rotations {
        let mut worst = 0.0;
        for state in states.iter().filter(|state| !motion.constraints.leaves_open(state)) {
            let Some(changes) = changes(model, motion, rotation, state) else { continue };
            let Some((coordinate, change)) = changes.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
            if change > UNCHANGED {
                let what = match (0..4).map(|k| rotation.first + k).find(|k| *k == coordinate) {
                    Some(_) => format!("the angular acceleration of `{}`", rotation.name),
                    None => format!("`{}`", crate::model::rate_name(&model.coordinates[coordinate].name, 2)),
                };
                let (name, state) = (&rotation.name, describe(model, state));
                return Err(verdicts::length_matters(rotation.place.clone(), name, what, state).into());
            }
            worst = f64::max(worst, change);
        }
        found.push((rotation.name.clone(), worst));
    }
    Ok(found)
}

/// How much each acceleration changes, as a part of its terms; of the rotation itself its angular acceleration, under its first coordinate.
/// Nothing where another length has no motion.
fn changes(model: &Model, motion: &Motion, rotation: &RotationCoordinate, state: &State) -> Option<Vec<(usize, f64)>> {
    let own = rotation.first..rotation.first + 4;
    let mut scaled = state.clone();
    let factor = DoubleDouble::from(FACTOR);
    for k in own.clone() {
        scaled.q[k] = scaled.q[k] * factor;
        scaled.v[k] = scaled.v[k] * factor;
    }
    // Contacts are where they were: to look for a place again, to the rounding of f64, would lead to another one.
    if !motion.place(&mut scaled) {
        return None;
    }
    motion.accelerate(&mut scaled).ok()?;
    let part = |difference: DoubleDouble, terms: f64| {
        let change = difference.to_f64().abs();
        if change == 0.0 { 0.0 } else { change / terms }
    };
    let others = (0..motion.n).filter(|k| !own.contains(k));
    let norm = |x: &[DoubleDouble]| x.iter().fold(DoubleDouble::ZERO, |sum, x| sum + *x * *x).to_f64().sqrt();
    let turn = 2.0 * norm(&state.v[own.clone()]) / norm(&state.q[own.clone()]);
    // Where nothing pushes, accelerations are roundings beside what the turn would make of the speeds.
    let carried = |k: usize| turn * state.v[k].to_f64().abs();
    let terms = |k: usize| scaled.a[k].magnitude.max(state.a[k].magnitude).max(carried(k));
    // What is held is held to rounding, beside what has the same unit.
    let unit = |k: usize| &model.coordinates[k].unit;
    let alike = |k: usize| (0..motion.n).filter(|j| unit(*j) == unit(k)).map(terms).fold(0.0, f64::max);
    let mut changes: Vec<(usize, f64)> =
        others.map(|k| (k, part(scaled.a[k].value - state.a[k].value, alike(k)))).collect();
    let [(here, size), (there, other)] = [state, &scaled].map(|state| angular_acceleration(state, rotation.first));
    // So is a body that constraints keep from turning, beside what turns.
    let sizes = model.rotations.iter().map(|other| angular_acceleration(state, other.first).1);
    let size = sizes.fold(size.max(other), f64::max);
    let changed = |(a, b): (&DoubleDouble, &DoubleDouble)| (rotation.first, part(*a - *b, size));
    changes.extend(here.iter().zip(&there).map(changed));
    Some(changes)
}

/// The vector part of 2 q̄ ∘ q''/|q|², with the magnitude of the terms of its largest component: of what turns about an axis the others are
/// roundings of roundings.  As it would be in units of 1/|2 q'/q|, no term is taken for smaller than 4 |q'|²/|q|²: what constraints keep from
/// turning has no other.
fn angular_acceleration(state: &State, first: usize) -> ([DoubleDouble; 3], f64) {
    let q: [DoubleDouble; 4] = std::array::from_fn(|k| state.q[first + k]);
    let a: [Measured; 4] = std::array::from_fn(|k| state.a[first + k]);
    let square = q.iter().fold(DoubleDouble::ZERO, |sum, x| sum + *x * *x);
    let two = DoubleDouble::from(2.0) / square;
    // w a - x b + (z c - y d) and its neighbours in cyclic order.
    let rate = state.v[first..first + 4].iter().fold(DoubleDouble::ZERO, |sum, x| sum + *x * *x);
    let mut most = 2.0 * (two * rate).to_f64();
    let components = std::array::from_fn(|i| {
        let (i, j, k) = (i + 1, (i + 1) % 3 + 1, (i + 2) % 3 + 1);
        let terms = [(q[0], a[i]), (-q[i], a[0]), (q[k], a[j]), (-q[j], a[k])];
        let sum = terms.iter().fold(DoubleDouble::ZERO, |sum, (x, y)| sum + *x * y.value);
        let size: f64 = terms.iter().map(|(x, y)| x.to_f64().abs() * y.magnitude).sum();
        most = f64::max(most, two.to_f64() * size);
        two * sum
    });
    (components, most)
}
