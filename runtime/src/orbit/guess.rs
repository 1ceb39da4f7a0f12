//! Where to look for a motion that repeats.

use crate::error::{Error, NoOrbit};
use crate::linear::{Guess, Reduction, equilibrium_near, linearise, normal_modes};
use crate::mechanism::System;
use crate::run::Run;

/// States of a run that are compared.
const SAMPLES: usize = 4000;
/// A motion has left a state where it is farther from it than this part of the farthest.
const LEFT: f64 = 0.3;
/// And is back where it is nearer than this part.
const BACK: f64 = 0.1;

/// A state and after how long the motion comes near to it again.
pub(super) struct Return {
    /// s.
    pub t: f64,
    pub period: f64,
    /// How near, in parts of how far it goes.
    pub distance: f64,
}

/// Near returns of a run to its first state and to its last one, the nearest first.
pub(super) fn returns(run: &Run, scales: &[f64], free: &[usize]) -> Vec<Return> {
    let (first, last) = (run.first().t, run.last().t);
    let times: Vec<f64> = (0..=SAMPLES).map(|k| first + (last - first) * k as f64 / SAMPLES as f64).collect();
    let states: Vec<Vec<f64>> =
        times.iter().filter_map(|t| run.at(*t)).map(|state| [state.q, state.v].concat()).collect();
    let n = scales.len() / 2;
    let apart = |a: &[f64], b: &[f64]| -> f64 {
        let counted = (0..2 * n).filter(|i| !free.contains(i));
        counted.map(|i| ((a[i] - b[i]) / scales[i]).powi(2)).sum::<f64>().sqrt()
    };
    let mut found = Vec::new();
    for backwards in [false, true] {
        let order: Vec<usize> = if backwards { (0..states.len()).rev().collect() } else { (0..states.len()).collect() };
        let distances: Vec<f64> = order.iter().map(|k| apart(&states[*k], &states[order[0]])).collect();
        let farthest = distances.iter().fold(0.0_f64, |most, x| most.max(*x));
        let Some(left) = distances.iter().position(|x| *x > LEFT * farthest) else { continue };
        // The first minimum that is near, else the nearest.
        let inner = left.max(1)..distances.len().saturating_sub(1);
        let minima: Vec<usize> =
            inner.filter(|k| distances[*k] <= distances[k - 1] && distances[*k] <= distances[k + 1]).collect();
        let near = minima.iter().find(|k| distances[**k] < BACK * farthest);
        let best = near.or_else(|| minima.iter().min_by(|a, b| distances[**a].total_cmp(&distances[**b])));
        if let Some(&k) = best {
            let shift = vertex([distances[k - 1].powi(2), distances[k].powi(2), distances[k + 1].powi(2)]);
            let step = (last - first) / SAMPLES as f64;
            let period = (k as f64 + shift) * step;
            let t = if backwards { last - period } else { first };
            found.push(Return { t, period, distance: distances[k] / farthest });
        }
    }
    found.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    found
}

/// Where a parabola through three values at −1, 0, 1 has its vertex.
fn vertex([before, here, after]: [f64; 3]) -> f64 {
    let curvature = before - 2.0 * here + after;
    if curvature > 0.0 { (0.5 * (before - after) / curvature).clamp(-0.5, 0.5) } else { 0.0 }
}

/// A state at rest, displaced from the equilibrium along a mode so that the coordinate that moves most moves by this amplitude; the period of
/// small motions, and the energy of the equilibrium.
///
/// # Errors
/// No equilibrium, no such mode.
pub(super) fn mode(system: &dyn System, near: &[f64], (number, amplitude): (usize, f64)) -> Result<(Vec<f64>, f64, f64), Error> {
    let equilibrium = equilibrium_near(system, &Guess::at(near)).map_err(Error::from)?;
    let linear = linearise(system, &equilibrium).map_err(Error::from)?;
    let modes = normal_modes(&linear, Reduction::default()).map_err(Error::from)?;
    let mode = number.checked_sub(1).and_then(|k| modes.get(k)).filter(|mode| mode.omega > 0.0);
    let Some(mode) = mode else { return Err(NoOrbit::NoMode { mode: number, known: modes.len() }.into()) };
    let shape = mode.real_shape();
    let largest = shape.iter().fold(0.0_f64, |most, x| if x.abs() > most.abs() { *x } else { most });
    let q: Vec<f64> = equilibrium.q.iter().zip(&shape).map(|(q, x)| q + amplitude * x / largest).collect();
    let rest = vec![0.0; q.len()];
    let energy = system.energy(crate::mechanism::At::new(0.0, &equilibrium.q, &rest)).jacobi;
    Ok(([q, rest].concat(), std::f64::consts::TAU / mode.omega, energy))
}
