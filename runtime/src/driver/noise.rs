//! Rounding, and what sets off from rest, told apart from errors that shorter steps would mend.

use nalgebra::{DMatrix, DVector};

use super::{Integration, Step, StepPolicy};
use crate::integrate::{OneStep, PERTURBATION, Tolerance};
use crate::matrix::solve_least;
use crate::mechanism::dense::{constraint_matrix, mass_matrix};
use crate::mechanism::{At, Enforcement, System, factor_packed, rows_in_force, substitute_back, substitute_forward};

/// So many good steps in a row that let no later one be longer are held by something: one or two are usual.
const HELD: u32 = 3;

/// How often in a row an error in units of the tolerance hardly fell although steps became much shorter.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StagnatingError {
    error: f64,
    h: f64,
    times: u32,
}

impl StagnatingError {
    /// It is small beside the change of the step: an explicit step beyond its stability has errors of the size of that.
    const SMALL: f64 = 0.5;
    /// Steps are shorter by this: a controller shortens what it rejects by a fifth at least.
    const SHORTER: f64 = 0.9;
    /// What shorter steps did not mend so often, they never will.
    const NEVER: u32 = 3;

    /// Takes note of a rejected step's error; true once no shorter step can have a smaller one.
    pub fn remains(&mut self, error: f64, h: f64, tolerance: f64) -> bool {
        let shorter = h / self.h;
        let falls = error < shorter.sqrt() * self.error;
        let stays = self.h > 0.0 && shorter < Self::SHORTER && error * tolerance < Self::SMALL && !falls;
        self.times = if stays { self.times + 1 } else { 0 };
        (self.error, self.h) = (error, h);
        self.times >= Self::NEVER
    }
}

impl Integration {
    /// As [`note_start_up_errors`], after a rejected step of this run.
    pub(super) fn look_for_start_up_error(&mut self, stagnating: &mut StagnatingError, (error, h): (f64, f64)) {
        let StepPolicy::Adaptive { tolerance, .. } = &mut self.policy else { return };
        note_start_up_errors(stagnating, tolerance, self.stepper.as_ref(), (error, h));
    }

    /// Looks whether what was rejected twice running, or once of what is at rest, is rounding; if so the tolerance takes note.
    pub(super) fn look_for_noise(&mut self, system: &dyn System, step: Step) {
        let StepPolicy::Adaptive { tolerance, .. } = &self.policy else { return };
        let n = system.len();
        let of = |errors: &[f64], i: usize| [errors[i].abs(), errors[n + i].abs()];
        let (before, after) = (&self.rejected, self.stepper.errors());
        let start = self.stepper.start();
        let (ends, rate) = ((start.y, self.stepper.end().y), start.rate);
        let lengths = (self.rejected_step, step.h);
        let suspected = |i: usize| tolerance.suspects(i, (of(before, i), of(after, i)), lengths, (ends, rate));
        // What nothing moves at first, while others begin to, may be moved by rounding alone: it need not be rejected twice.
        let begins = self.clock.now() == self.from && rate.iter().any(|rate| *rate != 0.0);
        let sets_off =
            |i: usize| begins && rate[n + i] == 0.0 && tolerance.is_moved(i, of(after, i), step.h, (ends, rate));
        let suspects: Vec<usize> = (0..n).filter(|i| sets_off(*i) || !before.is_empty() && suspected(*i)).collect();
        self.rejected.clear();
        self.rejected.extend_from_slice(self.stepper.errors());
        self.rejected_step = step.h;
        self.look_for_noise_of(system, step, suspects, 1.0);
        let StepPolicy::Adaptive { tolerance, .. } = &mut self.policy else { return };
        tolerance.spread_noise(&self.rejected, step.h);
    }

    /// As [`Integration::look_for_noise`], after a step that was good, but whose error lets no later one be longer.
    pub(super) fn look_for_noise_that_holds(&mut self, system: &dyn System, step: Step) {
        self.look_for_noise_of(system, step, Vec::new(), self.control.growing());
    }

    /// Looks whether the errors of these coordinates are rounding; and, where reactions act, whose rounding moves what they hold, or where no step has
    /// become longer for a while, as of chains that move by high powers of the time, those of all that rounding alone may move, if one of them has an
    /// error of more than `most` units that no known noise explains.
    fn look_for_noise_of(&mut self, system: &dyn System, step: Step, mut suspects: Vec<usize>, most: f64) {
        let StepPolicy::Adaptive { tolerance, .. } = &self.policy else { return };
        let n = system.len();
        let (start, end) = (self.stepper.start(), self.stepper.end());
        let of = |errors: &[f64], i: usize| [errors[i].abs(), errors[n + i].abs()];
        let counts = |i: usize| {
            let units = tolerance.units(i, step.h, (start.y, end.y), start.rate);
            let errors = of(self.stepper.errors(), i);
            errors.iter().zip(units).any(|(error, unit)| *error > most * unit) && !tolerance.explains(i, step.h, errors)
        };
        let may_be_noise = |i: &usize| tolerance.may_be_noise(*i, step.h);
        let looks = reacts(system) || self.held_steps >= HELD;
        if looks && (0..n).filter(may_be_noise).any(counts) {
            suspects.extend((0..n).filter(may_be_noise));
        }
        if suspects.is_empty() {
            return;
        }
        let mut noise = self.noise_of_step(system, step);
        let known = self.damp_noise(&mut noise, step.h);
        let StepPolicy::Adaptive { tolerance, .. } = &mut self.policy else { return };
        for i in suspects {
            tolerance.noise(i, noise[i], (step.h, known), of(self.stepper.errors(), i));
        }
    }

    /// The noise of each acceleration at the start of the step that was tried, and of those that move nothing there the larger at its end, too: reactions
    /// that begin in it make rounding of their own.  The end of a step that misses where something moves tells nothing.
    fn noise_of_step(&mut self, system: &dyn System, step: Step) -> Vec<f64> {
        let mut noise = self.noise(system);
        let StepPolicy::Adaptive { tolerance, .. } = &self.policy else { return noise };
        if !reacts(system) {
            return noise;
        }
        let (n, start, at_end) = (system.len(), self.stepper.start(), self.stepper.end().y.to_vec());
        let still = |i: &usize| !tolerance.moves(*i, step.h, [start.y[n + i], start.rate[n + i]], noise[*i]);
        let still: Vec<usize> = (0..n).filter(still).collect();
        let is_missed = |i: usize| {
            let speed = (at_end[i] - start.y[i]) / step.h;
            tolerance.moves(i, step.h, [speed, 0.0], noise[i]) && is_off(tolerance, self.stepper.as_ref(), (i, step.h))
        };
        let mut rate = vec![0.0; 2 * n];
        if !(0..n).any(is_missed) && self.stepper.evaluate(system, step.next, &at_end, &mut rate).is_ok() {
            let later = self.noise_at(system, step.next, &at_end, &rate);
            still.into_iter().for_each(|i| noise[i] = noise[i].max(later[i]));
        }
        noise
    }

    /// Where equations are stiff, noise of accelerations moves the state by less than in a step without forces: overwrites it with what would move a step
    /// of h as far without.  Returns the longest step for which that is known, s.
    pub(super) fn damp_noise(&self, noise: &mut [f64], h: f64) -> f64 {
        let n = noise.len();
        let mut change: Vec<f64> = (0..2 * n).map(|k| if k < n { 0.0 } else { h * noise[k - n] }).collect();
        if self.stepper.damp(&mut change).is_none() {
            return f64::INFINITY;
        }
        for (i, noise) in noise.iter_mut().enumerate() {
            *noise = (change[i] / (h * h)).abs().max((change[n + i] / h).abs()).min(*noise);
        }
        h
    }

    /// As [`Integration::noise_at`], at the present state.
    pub(super) fn noise(&mut self, system: &dyn System) -> Vec<f64> {
        let start = self.stepper.start();
        let (y, rate) = (start.y.to_vec(), start.rate.to_vec());
        self.noise_at(system, self.clock.now(), &y, &rate)
    }

    /// What rounding makes of each acceleration at a state y with this rate: that of the coordinates and of the time, by moving them, and that of the
    /// terms of the equations, M⁻¹ u m with their running magnitudes m, and what that of reactions leaves of the constraints; 0 where none can be told.
    fn noise_at(&mut self, system: &dyn System, now: f64, state: &[f64], rate: &[f64]) -> Vec<f64> {
        let n = system.len();
        let StepPolicy::Adaptive { tolerance, .. } = &self.policy else { return vec![0.0; n] };
        let perturbation: Vec<f64> = (0..n).map(|i| tolerance.perturbation(i)).collect();
        let (from, mut y) = (&rate[n..], state.to_vec());
        let at = At::packed(now, state, n).accelerated(from);
        let mut noise = by_terms(system, at, self.smooth_until).unwrap_or_else(|| vec![0.0; n]);
        let raise = |noise: &mut [f64], more: Option<Vec<f64>>| {
            noise.iter_mut().zip(more.unwrap_or_default()).for_each(|(noise, more)| *noise = noise.max(more));
        };
        raise(&mut noise, by_reactions(system, at));
        let mut rate = vec![0.0; 2 * n];
        for (side, tick) in [(1.0, 0.0), (-1.0, 0.0), (0.0, PERTURBATION), (0.0, -PERTURBATION)] {
            // Differences of neighbours show most where these move apart.
            for i in 0..n {
                let sign = if i % 2 == 0 { side } else { -side };
                y[i] = state[i] + sign * perturbation[i];
            }
            if self.stepper.evaluate(system, now + tick * now, &y, &mut rate).is_err() {
                continue;
            }
            for i in 0..n {
                noise[i] = noise[i].max((rate[n + i] - from[i]).abs());
            }
            raise(&mut noise, by_reactions(system, At::packed(now + tick * now, &y, n)));
        }
        noise
    }
}

/// Looks whether the error of a rejected step is the same part of what it changes by in any step: that of what sets off from rest by a high
/// power of time.  If so the tolerance takes note.
///
/// What has a speed or an acceleration at the step's start is no such thing: as long as its own error is too large, so is the step.
pub(super) fn note_start_up_errors(
    stagnating: &mut StagnatingError,
    tolerance: &mut Tolerance,
    stepper: &dyn OneStep,
    (error, h): (f64, f64),
) {
    let (start, errors) = (stepper.start(), stepper.errors());
    let n = errors.len() / 2;
    let is_missed = |i: usize| {
        tolerance.moves(i, h, [start.y[n + i], start.rate[n + i]], 0.0) && is_off(tolerance, stepper, (i, h))
    };
    if stagnating.remains(error, h, tolerance.relative) && !(0..n).any(is_missed) {
        tolerance.note_start_up_errors(errors);
    }
}

/// Whether an error of coordinate i, over the step of h that was tried, is larger than the tolerance.
fn is_off(tolerance: &Tolerance, stepper: &dyn OneStep, (i, h): (usize, f64)) -> bool {
    let (start, end, errors) = (stepper.start(), stepper.end(), stepper.errors());
    let units = tolerance.units(i, h, (start.y, end.y), start.rate);
    [i, errors.len() / 2 + i].iter().zip(units).any(|(k, unit)| errors[*k].abs() > unit)
}

/// |M⁻¹ u m| for magnitudes of equal and of alternating signs, the larger of both; `None` where M has no inverse.
///
/// What an input is made of is not known: it counts as made of terms as large as it is at any time from here to `until`, before which
/// time changes no discontinuity.
pub(super) fn by_terms(system: &dyn System, at: At<'_>, until: f64) -> Option<Vec<f64>> {
    let n = system.len();
    let pattern = &system.description().mass_pattern;
    let (mut values, mut sums) = (vec![0.0; pattern.len()], vec![0.0; n]);
    system.mass_matrix(at, &mut values);
    system.magnitudes(at, &mut sums);
    let inputs = &system.description().input_pattern;
    let (largest, mut by_input) = (largest_inputs(system, at.t, until), vec![0.0; inputs.len()]);
    system.input_jacobian(at, &mut by_input);
    for ((row, input), slope) in inputs.iter().zip(&by_input) {
        sums[*row as usize] += slope.abs() * largest[*input as usize];
    }
    let mut factors = vec![0.0; n * (n + 1) / 2];
    for ((row, column), value) in pattern.iter().zip(&values) {
        let (row, column) = (*row as usize, *column as usize);
        factors[row * (row + 1) / 2 + column] = *value;
    }
    factor_packed(&mut factors, n).ok()?;
    let mut noise = vec![0.0_f64; n];
    for other in [1.0, -1.0] {
        let mut right: Vec<f64> =
            sums.iter().enumerate().map(|(i, m)| if i % 2 == 0 { *m } else { other * m }).collect();
        substitute_forward(&factors, &mut right);
        substitute_back(&factors, &mut right);
        for (noise, a) in noise.iter_mut().zip(&right) {
            *noise = noise.max(f64::EPSILON * a.abs());
        }
    }
    noise.iter().all(|noise| noise.is_finite()).then_some(noise)
}

/// Whether constraints are held exactly, by reactions alone.
fn reacts(system: &dyn System) -> bool {
    let exactly = system.enforcement() == Enforcement::Multipliers && system.baumgarte_gain() == 0.0;
    exactly && !system.active_rows().is_empty()
}

/// What the rounding of reactions leaves of accelerations: the least change that would bring them to the constraints, as far as M⁻¹ u |J|ᵀ |λ|
/// explains it, or M⁻¹ u |B| |λ| of the friction that is made of them; `None` without constraints that are to be held exactly.
fn by_reactions(system: &dyn System, at: At<'_>) -> Option<Vec<f64>> {
    let rows: Vec<usize> = rows_in_force(system).collect();
    if !reacts(system) {
        return None;
    }
    let mut gamma = vec![0.0; system.description().rows.len()];
    let (mut a, mut lambda) = (vec![0.0; system.len()], gamma.clone());
    system.accelerations_and_multipliers(at, &mut a, &mut lambda).ok()?;
    system.constraint_bias(at, &mut gamma);
    let matrix = constraint_matrix(system, at, &rows);
    let missed = &matrix * DVector::from_vec(a) + DVector::from_fn(rows.len(), |k, _| gamma[rows[k]]);
    let mass = mass_matrix(system, at);
    let response = solve_least(&mass, &matrix.transpose())?;
    let multipliers =
        solve_least(&(&matrix * &response), &DMatrix::from_column_slice(rows.len(), 1, missed.as_slice()))?;
    let change = response * multipliers;
    let sizes = DVector::from_fn(rows.len(), |k, _| f64::EPSILON * lambda[rows[k]].abs());
    let moved_by =
        |forces: DVector<f64>| solve_least(&mass, &DMatrix::from_column_slice(forces.len(), 1, forces.as_slice()));
    let rounding = moved_by(matrix.abs().transpose() * &sizes)?;
    // No constraint takes what rounding makes of friction.
    let friction = moved_by(friction_of(system, at, &rows).abs() * sizes)?;
    let least = change.iter().zip(&rounding).map(|(change, rounding)| change.abs().min(rounding.abs()));
    let noise = least.zip(&friction).map(|(least, friction)| least.max(friction.abs()));
    Some(noise.map(|noise| if noise.is_finite() { noise } else { 0.0 }).collect())
}

/// B of these rows, n × m.
fn friction_of(system: &dyn System, at: At<'_>, rows: &[usize]) -> DMatrix<f64> {
    let pattern = &system.description().friction_pattern;
    let mut values = vec![0.0; pattern.len()];
    system.friction(at, &mut values);
    let mut matrix = DMatrix::zeros(system.len(), rows.len());
    for ((coordinate, row), value) in pattern.iter().zip(values) {
        if let Some(k) = rows.iter().position(|active| *active == *row as usize) {
            matrix[(*coordinate as usize, k)] += value;
        }
    }
    matrix
}

/// The largest sizes of (u, u', u'') of each input that samples find between t and `until`: evenly spaced ones, and
/// others ever closer to t.
fn largest_inputs(system: &dyn System, t: f64, until: f64) -> Vec<f64> {
    const EVEN: u32 = 256;
    const HALVINGS: u32 = 48;
    let mut largest = vec![0.0_f64; 3 * system.description().inputs.len()];
    if largest.is_empty() {
        return largest;
    }
    let mut values = largest.clone();
    let even = (0..=EVEN).map(|k| f64::from(k) / f64::from(EVEN));
    for part in even.chain((1..=HALVINGS).map(|k| 0.5_f64.powi(k as i32))) {
        system.inputs(t + part * (until - t), &mut values);
        for (largest, value) in largest.iter_mut().zip(&values) {
            *largest = largest.max(value.abs());
        }
    }
    largest
}
