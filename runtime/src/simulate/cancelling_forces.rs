//! Forces that cancel each other, of which rounding leaves few digits.

use crate::mechanism::{At, Method, System};
use crate::run::Run;

/// Accelerations are as good as exact that rounding changes by less than this part of the largest: tolerances and their bounds are larger.
const EXACT: f64 = 1e-12;
/// At so many states of a run accelerations are looked at.
const STATES: usize = 17;
/// Of more coordinates than this M is not solved for in a run that is only compared.
const MOST_COORDINATES: usize = 60;

/// Whether rounding of forces may change the accelerations of a run by more than its digits would tell: two runs of the same forces share it.
/// What friction holds would slip if forces changed, and a linear system is solved by its matrices.
pub(super) fn cancel(system: &mut dyn System, run: &Run) -> bool {
    let n = system.len();
    let judged = n <= MOST_COORDINATES && system.contacts().all.is_empty() && run.method != Method::Exact;
    if !judged || system.derivation().is_some() || run.is_empty() {
        return false;
    }
    let (mut largest, mut changed) = (vec![0.0_f64; n], vec![0.0_f64; n]);
    let (mut exact, mut moved) = (vec![0.0; n], vec![0.0; n]);
    let rows = (0..STATES).map(|k| k * (run.len() - 1) / (STATES - 1));
    for row in rows {
        let at = At::packed(run.times[row], &run.rows[2 * n * row..][..2 * n], n);
        let known = system.accelerations(at, &mut exact).is_ok();
        system.disturb_forces(1.0);
        let known = known && system.accelerations(at, &mut moved).is_ok();
        system.disturb_forces(0.0);
        if !known {
            continue;
        }
        for i in 0..n {
            largest[i] = largest[i].max(exact[i].abs());
            changed[i] = changed[i].max((moved[i] - exact[i]).abs());
        }
    }
    changed.into_iter().zip(largest).any(|(changed, largest)| changed > EXACT * largest)
}
