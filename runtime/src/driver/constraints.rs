//! How constraints stand at the ends of steps.

use super::{Integration, StepPolicy};
use crate::cause::Cause;
use crate::constrain::Residuals;
use crate::mechanism::dense::constraint_matrix;
use crate::mechanism::{At, Enforcement, RowHistory, Solutions, System, rows_in_force};
use crate::run::Recorder;
use crate::trust::Warning;

/// Baumgarte's gain is this over the mean of so many steps (measured: larger ones cost more steps than they save errors).
const GAIN: f64 = 0.03;
const GAIN_AFTER: u64 = 20;
/// More steps than this in a row at a singular position that comes no nearer and goes no farther: the motion stays there.
const DWELLS: u32 = 100;
/// What is nearer or farther by this part of the distance.
const MOVES: f64 = 0.1;
/// A coordinate that goes less far than this part of an independent one goes nowhere: what dependent rows leave of it is rounding.
const HELD: f64 = 1e-12;

/// How long the motion has been at a singular position: steps, and the least and largest distance from it in these.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SingularDwell {
    steps: u32,
    nearest: f64,
    farthest: f64,
}

impl SingularDwell {
    /// One more step; true where the motion stays.
    fn stays(&mut self, sigma: f64) -> bool {
        if self.steps == 0 {
            (self.nearest, self.farthest) = (sigma, sigma);
        }
        self.steps += 1;
        (self.nearest, self.farthest) = (self.nearest.min(sigma), self.farthest.max(sigma));
        if self.steps <= DWELLS {
            return false;
        }
        let stays = self.farthest - self.nearest <= MOVES * self.farthest;
        *self = SingularDwell { steps: 1, nearest: sigma, farthest: sigma };
        stays
    }

    /// Whether the last step ended there.
    pub fn is_there(&self) -> bool {
        self.steps > 0
    }
}

/// The coordinates that constraints leave nowhere to go; `None` where there are none.
pub(super) fn held_coordinates(system: &dyn System, at: At<'_>) -> Option<Vec<bool>> {
    let rows: Vec<usize> = rows_in_force(system).collect();
    if rows.is_empty() || system.enforcement() != Enforcement::Multipliers {
        return None;
    }
    // Measured by the root of the energy of its rate: an angle is neither long nor short beside a length.
    let (mut matrix, mut inertias) = (constraint_matrix(system, at, &rows), vec![0.0; system.len()]);
    system.inertias(at, &mut Vec::new(), &mut inertias);
    let known = matrix.column_iter_mut().zip(inertias).filter(|(_, inertia)| *inertia > 0.0);
    known.for_each(|(mut column, inertia)| column /= inertia.sqrt());
    let left = Solutions::of(&matrix, &[]).basis;
    let held: Vec<bool> = left.row_iter().map(|row| row.amax() <= HELD).collect();
    held.contains(&true).then_some(held)
}

/// How many of the rows in force are independent, but at singular positions.
fn usual_rank(system: &dyn System) -> usize {
    system.description().phases.get(system.phase()).map_or(0, |phase| phase.rank as usize)
}

impl Integration {
    /// Brings the present state to the constraints, and measures how independent they are there.
    pub(super) fn project_start(&mut self, system: &mut dyn System) -> Result<(), Box<Cause>> {
        let Some(projection) = &mut self.projection else { return Ok(()) };
        // What is rounding beside the terms of a motion so far is not, beside those of one instant.
        for values in self.seen_before.take().into_iter().flatten() {
            let known = values.iter().zip(self.stepper.start().y);
            let y: Vec<f64> = known.map(|(seen, now)| if seen.is_finite() { *seen } else { *now }).collect();
            projection.observe(system, self.clock.now(), &y);
        }
        let projected = projection.project(system, self.clock.now(), self.stepper.state_mut());
        projected.map_err(|fault| fault.cause(system.description()))?;
        projection.observe(system, self.clock.now(), self.stepper.start().y);
        projection.hold(system, self.clock.now(), self.stepper.start().y);
        let independent = projection.has_independent(usual_rank(system));
        if let Some(history) = system.row_history_mut() {
            let (norms, entries) = (projection.norms().to_vec(), projection.entries().to_vec());
            *history = RowHistory { norms, entries, independent, ..RowHistory::default() };
        }
        Ok(())
    }

    /// Notes how the constraints stand at the end of a step.
    pub(super) fn look_at_constraints(
        &mut self,
        system: &mut dyn System,
        recorder: &mut Recorder,
    ) -> Result<(), Box<Cause>> {
        let deficient = self.deficient(system);
        let Some(projection) = &mut self.projection else { return Ok(()) };
        let usual = usual_rank(system);
        let (now, y) = (self.clock.now(), self.stepper.start().y);
        if system.active_rows().is_empty() {
            projection.observe(system, now, y);
            return Ok(());
        }
        projection.keep();
        if let Some(history) = system.row_history_mut() {
            history.norms.clear();
            history.norms.extend_from_slice(projection.norms());
            history.entries.clear();
            history.entries.extend_from_slice(projection.entries());
            history.last = projection.nearly_dependent_rows(usual);
            history.independent |= projection.has_independent(usual);
        }
        if deficient.is_none() && projection.is_nearly_singular() {
            let (mut a, mut lambda) = (vec![0.0; system.len()], vec![0.0; system.description().rows.len()]);
            let solved = system.accelerations_and_multipliers(At::packed(now, y, system.len()), &mut a, &mut lambda);
            if let Some(history) = system.row_history_mut().filter(|_| solved.is_ok()) {
                history.multipliers = lambda;
            }
        }
        if let StepPolicy::Adaptive { tolerance, .. } = &mut self.policy {
            // Elsewhere it is no more than that of the state itself.
            let near = projection.is_nearly_singular();
            tolerance.note_constraint_round_off(near.then(|| projection.constraint_round_off(system, now, y)));
        }
        // Coordinates that pivots choose continue no speeds where the rows depend on each other.
        let goes_through = system.enforcement() != Enforcement::NullSpace;
        if let Some(sigma) = deficient {
            if !goes_through || self.dwell.stays(sigma) {
                return Err(Cause::SingularConfiguration { sigma }.into());
            }
            recorder.warn(Warning::SingularPassed { t: now });
            return Ok(());
        }
        self.dwell = SingularDwell::default();
        let place = At::place(now, &y[..system.len()]);
        if projection.passed(system, place, usual) {
            if !goes_through {
                let (_, sigma) = projection.rank();
                return Err(Cause::SingularConfiguration { sigma }.into());
            }
            recorder.warn(Warning::SingularPassed { t: now });
        }
        match projection.lost(system, At::packed(now, y, system.len()), 0.0) {
            Some((row, residual)) => {
                let constraint = system.description().rows[row].name.to_string();
                Err(Cause::ConstraintLost { constraint, residual }.into())
            }
            None => Ok(()),
        }
    }

    /// Chooses Baumgarte's gain by the mean of the first steps: what decays faster becomes what limits them.
    pub(super) fn choose_gain(&mut self, system: &mut dyn System) {
        if self.finds_gain && self.work.steps >= GAIN_AFTER {
            let mean = (self.clock.now() - self.from) / self.work.steps as f64;
            system.enforce(system.enforcement(), GAIN / mean);
            self.finds_gain = false;
        }
    }

    /// Where the rows of the constraints that were projected onto last are less independent than elsewhere: how far they
    /// are from depending on each other.
    pub(super) fn deficient(&self, system: &dyn System) -> Option<f64> {
        let (rank, sigma) = self.projection.as_ref()?.rank();
        let usual = system.description().phases.get(system.phase())?.rank as usize;
        (!system.active_rows().is_empty() && rank < usual).then_some(sigma)
    }

    /// How far the motion was from its constraints, at the ends of its steps.
    pub fn residuals(&self) -> Option<Residuals> {
        self.projection.as_ref().map(|projection| projection.worst())
    }
}
