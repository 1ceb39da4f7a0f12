//! The stages of a step, by simplified Newton's method.

use nalgebra::Complex;

use super::tableau::{STAGES, Tableau, sum};
use crate::integrate::linear::Pencil;
use crate::integrate::tolerance::{alike, larger};
use crate::integrate::{StepFailure, Tolerance};
use crate::matrix::{factor_lu, solve_lu};
use crate::mechanism::{AccelerationSlopes, At, System};

/// Accelerations at the nodes of a step, and what places and speeds have changed by until there; stage by stage.
#[derive(Clone, Debug)]
pub(super) struct Stages {
    pub accelerations: Vec<f64>,
    pub places: Vec<f64>,
    pub speeds: Vec<f64>,
    /// What the equations leave, then the correction.
    left: Vec<f64>,
    /// The accelerations that the iteration began with.
    guess: Vec<f64>,
}

/// Where a step goes from.
#[derive(Clone, Copy)]
pub(super) struct From<'a> {
    pub t: f64,
    pub h: f64,
    /// [q; q'].
    pub y: &'a [f64],
    /// What rounding took from it before.
    pub carry: &'a [f64],
}

/// Where Jacobians are from, in the order in which they are tried.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Jacobians {
    /// An earlier step.
    Known,
    /// A node in the middle of this one, as the last step's polynomial has it: on the way to either end they change by half as much.
    Middle,
    /// Its start, which is on the motion.
    Start,
}

/// Simplified Newton's method for the stages, with the Jacobians of an earlier state as long as they serve.
#[derive(Clone, Debug)]
pub(super) struct Newton {
    tableau: &'static Tableau,
    n: usize,
    pub slopes: AccelerationSlopes,
    pub real: Pencil<f64>,
    complex: Pencil<Complex<f64>>,
    room: Vec<Complex<f64>>,
    /// For each coordinate the first that has its unit, and the largest size of a place over the step there.
    alike: Vec<usize>,
    largest: Vec<f64>,
    /// The step that the pencils are factored for; 0: none.
    factored: f64,
    /// How many iterations there were when the Jacobians were new; 0: they are to be.
    usual: u32,
    /// How much of a correction the next one was at the most in the last step, if its Jacobians were new.
    contraction: f64,
    pub evaluations: u64,
    pub jacobians: u64,
    pub factorizations: u64,
}

/// Newton's corrections relative to the state below which they may be rounding.
const NOISE: f64 = 1e-7;
/// Newton's corrections relative to the state that no digit of it shows, nor of what rounding took from it.
const NOTHING: f64 = f64::EPSILON * f64::EPSILON;
const TINY: f64 = 1e-290;
/// What is smaller than what has its unit, by this, may be rounding of that.
const SMALL: f64 = 1e-8;
/// Without a tolerance: iterations at most.
const MOST: u32 = 60;
/// With a tolerance: iterations at most, and what the last correction may leave, in its units.
const MOST_LOOSE: u32 = 10;
const LEFT: f64 = 0.03;
/// Corrections that fall more slowly call for new Jacobians.
const SLOW: f64 = 0.005;
/// What a correction may leave where the iteration converges well.
const WELL: f64 = 0.2;

impl Stages {
    pub fn new(stages: usize, n: usize) -> Self {
        let zeros = || vec![0.0; stages * n];
        Stages { accelerations: zeros(), places: zeros(), speeds: zeros(), left: zeros(), guess: zeros() }
    }

    /// The state at a node.
    fn state(&self, i: usize, y: &[f64], at: &mut [f64]) {
        let n = y.len() / 2;
        for j in 0..n {
            at[j] = y[j] + self.places[i * n + j];
            at[n + j] = y[n + j] + self.speeds[i * n + j];
        }
    }

    /// By how much the last correction changed [q; q'] over a step of h at the most.
    pub fn corrected(&self, h: f64, errors: &mut [f64]) {
        let n = errors.len() / 2;
        for j in 0..n {
            let largest = self.left.iter().skip(j).step_by(n).fold(0.0_f64, |most, left| most.max(left.abs()));
            (errors[j], errors[n + j]) = (0.5 * h * h * largest, h * largest);
        }
    }

    /// Changes of places and speeds that go with the accelerations.
    fn follow<const S: usize>(&mut self, tableau: &Tableau, From { h, y, carry, .. }: From<'_>) {
        let n = y.len() / 2;
        let ((speeds, _), (places, _)) = (tableau.speeds.as_chunks::<S>(), tableau.places.as_chunks::<S>());
        for j in 0..n {
            let k: [f64; S] = std::array::from_fn(|i| self.accelerations[i * n + j]);
            let (v, left) = (y[n + j], [carry[j], carry[n + j]]);
            for i in 0..S {
                let drift = sum(&tableau.nodes[i..=i], |_| v);
                self.speeds[i * n + j] = left[1] + h * sum(&speeds[i], |l| k[l]);
                self.places[i * n + j] = left[0] + h * (drift + h * sum(&places[i], |l| k[l]));
            }
        }
    }
}

impl Newton {
    pub fn new(tableau: &'static Tableau, n: usize) -> Self {
        Newton {
            tableau,
            n,
            slopes: AccelerationSlopes::new(n),
            real: Pencil::new(n),
            complex: Pencil::new(n),
            room: vec![Complex::new(0.0, 0.0); n],
            alike: Vec::new(),
            largest: vec![0.0; n],
            factored: 0.0,
            usual: 0,
            contraction: 0.0,
            evaluations: 0,
            jacobians: 0,
            factorizations: 0,
        }
    }

    /// The step that it solved last, s.
    pub fn step(&self) -> f64 {
        self.factored
    }

    /// The longest step in which the iteration may be expected to converge well, s: what a correction leaves is taken to grow in
    /// proportion.
    ///
    /// Source: Gustafsson and Söderlind, SIAM J. Sci. Comput. 18 (1997) 23.
    pub fn longest(&self) -> f64 {
        if self.contraction > 0.0 { self.factored * WELL / self.contraction } else { f64::INFINITY }
    }

    /// The Jacobians say nothing any more.
    pub fn forget(&mut self) {
        self.usual = 0;
    }

    /// Solves for the stages from the accelerations that they have; `at` is room for a state.
    pub fn solve(
        &mut self,
        system: &dyn System,
        from: From<'_>,
        stages: &mut Stages,
        tolerance: Option<&Tolerance>,
        at: &mut [f64],
    ) -> Result<(), StepFailure> {
        match self.tableau.stages() {
            1 => self.solve_by::<1>(system, from, stages, tolerance, at),
            2 => self.solve_by::<2>(system, from, stages, tolerance, at),
            _ => self.solve_by::<STAGES>(system, from, stages, tolerance, at),
        }
    }

    /// The same, the number of stages being known to the compiler.
    fn solve_by<const S: usize>(
        &mut self,
        system: &dyn System,
        from: From<'_>,
        stages: &mut Stages,
        tolerance: Option<&Tolerance>,
        at: &mut [f64],
    ) -> Result<(), StepFailure> {
        stages.guess.copy_from_slice(&stages.accelerations);
        let known = [(self.usual > 0).then_some(Jacobians::Known), Some(Jacobians::Middle), Some(Jacobians::Start)];
        let mut outcome = Err(StepFailure::Stalled { h: from.h });
        for jacobians in known.into_iter().flatten() {
            stages.accelerations.copy_from_slice(&stages.guess);
            stages.follow::<S>(self.tableau, from);
            outcome = self.prepare(system, from, jacobians, stages, at);
            if outcome.is_ok() {
                outcome = self.iterate::<S>(system, from, stages, tolerance, at);
                if !matches!(outcome, Err(StepFailure::Stalled { .. })) {
                    return outcome;
                }
            }
        }
        match tolerance {
            Some(tolerance) => self.iterate_with_all::<S>(system, from, stages, tolerance, at),
            None => outcome,
        }
    }

    /// Newton's method with the Jacobians of each stage, for all stages at once: where they differ by orders of magnitude, as where sliding begins, none
    /// of them serves the others.
    fn iterate_with_all<const S: usize>(
        &mut self,
        system: &dyn System,
        from: From<'_>,
        stages: &mut Stages,
        tolerance: &Tolerance,
        at: &mut [f64],
    ) -> Result<(), StepFailure> {
        let (n, h) = (self.n, from.h);
        let size = S * n;
        let (mut matrix, mut pivots) = (vec![0.0; size * size], vec![0; size]);
        let mut before = f64::INFINITY;
        stages.accelerations.copy_from_slice(&stages.guess);
        stages.follow::<S>(self.tableau, from);
        self.usual = 0;
        self.contraction = 0.0;
        for _ in 0..MOST_LOOSE {
            self.left::<S>(system, from, stages, at)?;
            for i in 0..S {
                stages.state(i, from.y, at);
                self.slopes.evaluate_finite(system, At::packed(from.t + self.tableau.nodes[i].value() * h, at, n))?;
                self.jacobians += 1;
                let (places, speeds) = (self.slopes.by_place(), self.slopes.by_speed());
                for (j, l, k) in (0..S).flat_map(|j| (0..n).flat_map(move |l| (0..n).map(move |k| (j, l, k)))) {
                    let [by_place, by_speed] = [self.tableau.places, self.tableau.speeds].map(|a| a[i * S + j].value());
                    let unit = f64::from(u8::from(i == j && l == k));
                    matrix[(i * n + l) * size + j * n + k] =
                        unit - h * (by_speed * speeds[l * n + k] + h * by_place * places[l * n + k]);
                }
            }
            self.factorizations += 1;
            if !factor_lu(&mut matrix, &mut pivots) {
                break;
            }
            solve_lu(&matrix, &pivots, &mut stages.left[..size]);
            stages.accelerations.iter_mut().zip(&stages.left).for_each(|(k, correction)| *k += correction);
            stages.follow::<S>(self.tableau, from);
            let correction = self.in_units::<S>(from, stages, tolerance);
            let falls = correction / before;
            // What it leaves is of the order of its square.
            if correction <= 1e-3 * LEFT || before.is_finite() && falls < 1.0 && correction * falls <= LEFT {
                return self.prepare(system, from, Jacobians::Middle, stages, at);
            }
            if !correction.is_finite() {
                break;
            }
            before = correction;
        }
        Err(StepFailure::Stalled { h })
    }

    /// Takes Jacobians that are to be new, and the pencils of this step.
    fn prepare(
        &mut self,
        system: &dyn System,
        from: From<'_>,
        jacobians: Jacobians,
        stages: &Stages,
        at: &mut [f64],
    ) -> Result<(), StepFailure> {
        if self.alike.is_empty() {
            self.alike = alike(system.description());
        }
        if jacobians != Jacobians::Known {
            let middle = self.tableau.stages() / 2;
            let mut t = from.t;
            at.copy_from_slice(from.y);
            if jacobians == Jacobians::Middle {
                t += self.tableau.nodes[middle].value() * from.h;
                stages.state(middle, from.y, at);
            }
            self.usual = 0;
            self.slopes.evaluate_finite(system, At::packed(t, at, self.n))?;
            self.jacobians += 1;
            self.factored = 0.0;
        }
        if self.factored != from.h {
            let real = self.tableau.real.is_none_or(|(mu, ..)| self.real.factor(&self.slopes, from.h * mu));
            let complex = self.tableau.complex.is_none_or(|(mu, ..)| self.complex.factor(&self.slopes, mu * from.h));
            self.factorizations += 1;
            self.factored = 0.0;
            if !(real && complex) {
                return Err(StepFailure::Stalled { h: from.h });
            }
            self.factored = from.h;
        }
        Ok(())
    }

    fn iterate<const S: usize>(
        &mut self,
        system: &dyn System,
        from: From<'_>,
        stages: &mut Stages,
        tolerance: Option<&Tolerance>,
        at: &mut [f64],
    ) -> Result<(), StepFailure> {
        let mut before = f64::INFINITY;
        let fresh = self.usual == 0;
        self.contraction = 0.0;
        let most = if tolerance.is_some() { MOST_LOOSE } else { MOST };
        for iteration in 1..=most {
            self.left::<S>(system, from, stages, at)?;
            self.correct::<S>(stages);
            let mut same = true;
            for (k, correction) in stages.accelerations.iter_mut().zip(&stages.left) {
                let next = *k + correction;
                same &= next == *k;
                *k = next;
            }
            // What begins at rest has no size before its first correction.
            stages.follow::<S>(self.tableau, from);
            let size = match tolerance {
                Some(tolerance) => self.in_units::<S>(from, stages, tolerance),
                None => self.relative(from, stages),
            };
            let slow = size / before;
            // Old ones will be new in the next step.
            if fresh {
                self.contraction = self.contraction.max(slow);
            }
            let done = same
                || match tolerance {
                    Some(_) if iteration == 1 => size <= 1e-3 * LEFT,
                    Some(_) => slow < 1.0 && size * slow / (1.0 - slow) <= LEFT,
                    // Corrections that no longer fall are rounding; where accelerations vanish they fall for ever.
                    None => (size >= before && before < NOISE) || size < NOTHING,
                };
            if done {
                if self.usual == 0 {
                    self.usual = iteration;
                }
                let serves = match tolerance {
                    Some(_) => iteration == 1 || slow < SLOW,
                    None => iteration <= self.usual + 1,
                };
                if !serves {
                    self.usual = 0;
                }
                return Ok(());
            }
            let hopeless = match tolerance {
                Some(_) => slow >= 1.0,
                // The first corrections of a rough guess may grow.
                None => slow > 2.0 && iteration > 4,
            };
            if hopeless || !size.is_finite() {
                break;
            }
            before = size;
        }
        self.usual = 0;
        Err(StepFailure::Stalled { h: from.h })
    }

    /// a(t, Q, V) − k of all stages.
    fn left<const S: usize>(
        &mut self,
        system: &dyn System,
        from: From<'_>,
        stages: &mut Stages,
        at: &mut [f64],
    ) -> Result<(), StepFailure> {
        let n = self.n;
        for i in 0..S {
            stages.state(i, from.y, at);
            let left = &mut stages.left[i * n..][..n];
            let t = from.t + self.tableau.nodes[i].value() * from.h;
            self.evaluations += 1;
            system.accelerations(At::packed(t, at, n), left)?;
            left.iter_mut().zip(&stages.accelerations[i * n..]).for_each(|(left, k)| *left -= k);
        }
        Ok(())
    }

    /// What is left becomes Newton's correction: left eigenvectors take it apart, right ones put the corrections together.
    fn correct<const S: usize>(&mut self, stages: &mut Stages) {
        let (n, left) = (self.n, &mut stages.left[..S * self.n]);
        let of = |left: &[f64], j: usize| -> [f64; S] { std::array::from_fn(|i| left[i * n + j]) };
        if let Some((_, _, dual)) = &self.tableau.complex {
            for (j, room) in self.room.iter_mut().enumerate() {
                *room = of(left, j).iter().zip(dual).map(|(left, dual)| dual * left).sum();
            }
            self.complex.solve(&mut self.room);
        }
        match &self.tableau.real {
            Some((_, right, dual)) => {
                for j in 0..n {
                    left[j] = of(left, j).iter().zip(dual).map(|(left, dual)| dual * left).sum();
                }
                self.real.solve(&mut left[..n]);
                for j in 0..n {
                    let part = left[j];
                    (0..S).for_each(|i| left[i * n + j] = right[i] * part);
                }
            }
            None => left.fill(0.0),
        }
        if let Some((_, right, _)) = &self.tableau.complex {
            for (j, room) in self.room.iter().enumerate() {
                (0..S).for_each(|i| left[i * n + j] += 2.0 * (right[i] * room).re);
            }
        }
    }

    /// The largest correction of a place, beside the sizes of places, speeds and accelerations over the step: its own, or a small part
    /// of those of what has its unit.
    fn relative(&mut self, From { h, y, .. }: From<'_>, stages: &Stages) -> f64 {
        let n = self.n;
        let size = |j: usize, k: f64| y[j].abs() + (h * y[n + j]).abs() + h * h * k.abs();
        self.largest.fill(0.0);
        for (i, k) in stages.accelerations.iter().enumerate() {
            let largest = &mut self.largest[self.alike[i % n]];
            *largest = largest.max(size(i % n, *k));
        }
        let mut most = 0.0_f64;
        for (i, (correction, k)) in stages.left.iter().zip(&stages.accelerations).enumerate() {
            let j = i % n;
            let change = h * h * correction.abs();
            // Numbers that have hardly any digits cannot agree to many.
            let beside = size(j, *k).max(SMALL * self.largest[self.alike[j]]);
            most = most.max(if change <= TINY { 0.0 } else { change / beside });
        }
        most
    }

    /// The root mean square of what a correction does to the state, in units of the tolerance.
    fn in_units<const S: usize>(&self, From { h, .. }: From<'_>, stages: &Stages, tolerance: &Tolerance) -> f64 {
        let n = self.n;
        let last = (S - 1) * n;
        let mut sum = 0.0;
        for j in 0..n {
            let correction = (0..S).fold(0.0, |most, i| larger(most, stages.left[i * n + j].abs()));
            let change = |k: usize| if k < n { stages.places[last + k] } else { stages.speeds[last + k - n] };
            let changes = tolerance.coupled_changes(j, |k| change(k).abs());
            let [place, speed] = tolerance.units_by_change(j, h, changes);
            sum += (0.5 * h * h * correction / place).powi(2) + (h * correction / speed).powi(2);
        }
        (sum / (2 * n).max(1) as f64).sqrt()
    }
}
