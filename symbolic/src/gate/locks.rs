//! Scenes whose motion comes to a place where three angles lock.

use std::f64::consts::PI;

use super::motion::Motion;
use super::state::State;
use super::states::on_the_way;
use super::trajectory::{Passed, Trajectory};
use crate::model::{Gimbal, Model};
use crate::number::DoubleDouble;

/// The sine of the angle from a lock that errors of a motion, followed to a tolerance of 1e-4, do not tell from 0.
const UNTOLD: f64 = 1e-3;

/// The first gimbal lock of a motion that makes M singular, in words.
pub(super) fn lock(model: &Model, motion: &Motion, (run, scene): (&Trajectory, &str)) -> Option<String> {
    let gimbals = model.gimbals();
    let sine = |gimbal: &Gimbal, step: &Passed| (gimbal.factor * step.q[gimbal.coordinates[1]] + gimbal.phase).sin();
    for (k, step) in run.states.iter().enumerate() {
        let before = &run.states[k.saturating_sub(1)];
        for gimbal in &gimbals {
            let [earlier, now] = [before, step].map(|step| sine(gimbal, step));
            let met = now.abs() < UNTOLD || earlier * now < 0.0;
            if !(met && locks(motion, gimbal, on_the_way(run, step))) {
                continue;
            }
            let [first, middle, last] = gimbal.coordinates.map(|k| &model.coordinates[k].name);
            return Some(format!(
                "the motion of `{scene}` comes to gimbal lock about t = {t:.2}: `{first}` and `{last}` turn `{frame}` about one axis at that \
                 `{middle}`; a rotation never locks (`coordinates: {{attitude: rotation}}`)",
                t = step.t,
                frame = gimbal.frame
            ));
        }
    }
    None
}

/// Whether M is singular among the three angles where the sine is 0, nearest to a state.
fn locks(motion: &Motion, gimbal: &Gimbal, mut state: State) -> bool {
    let middle = gimbal.coordinates[1];
    let argument = gimbal.factor * state.q[middle].to_f64() + gimbal.phase;
    state.q[middle] = DoubleDouble::from(((argument / PI).round() * PI - gimbal.phase) / gimbal.factor);
    motion.prepare(&mut state);
    motion.is_singular_among(&state, gimbal.coordinates)
}
