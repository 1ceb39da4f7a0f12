//! The phase in force, and room to solve for its motion.

use std::sync::{Mutex, PoisonError};

use super::dense::constraint_triples;
use super::kkt::LOPSIDED;
use super::{At, Energy, Enforcement, KktSolver, Singular, System, rows_in_force};

/// What the motion so far tells of the constraints' rows; lists are empty where it tells nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RowHistory {
    /// The largest √(J_k M⁻¹ J_kᵀ) that each row has had, to tell negligible rows by; with M + Jᵀ R J in the place of M where that told the rows apart.
    pub norms: Vec<f64>,
    /// The largest size that each entry of J has had, all coordinates of a row one after the other: a row of which one entry is as large as it
    /// ever was does not vanish, however heavy that coordinate is.
    pub entries: Vec<f64>,
    /// Whether the rows in force were clearly independent at some state: near a singular position later on some of them are left out.
    pub independent: bool,
    /// The multipliers of all rows where the rows were last as independent as they usually are: rows that cease to count
    /// near a singular position keep them meanwhile.
    pub multipliers: Vec<f64>,
    /// Rows that are chosen last near a singular position, so that the same ones are left out throughout.
    pub last: Vec<usize>,
}

/// What a constrained mechanism keeps beside its parameters.
#[derive(Debug, Default)]
pub(super) struct Phased {
    /// The phase in force.
    pub phase: usize,
    /// What is known of the constraints from the motion so far.
    pub history: RowHistory,
    /// How constraints are enforced.
    pub enforcement: Enforcement,
    /// Baumgarte's α, 1/s; 0: none.
    pub alpha: f64,
    /// By how many times their rounding forces are wrong; 0: as they are.
    pub disturbance: f64,
    /// Nobody waits for it: whoever evaluates in parallel has a mechanism of its own.
    form: Mutex<KktSolver>,
}

/// A row that its multiplier moves by less than this part of the most, as a length, loses digits or is soon left out, and so does a coordinate of
/// which no more inertia is left: these are for M and J with pivots.
const CLEAR: f64 = 1.0 / LOPSIDED;

/// What a mechanism does alike whether it is compiled or interpreted, of its fields `phased`, `signals`, `sliding` and `derivation`.
macro_rules! shared_by_systems {
    () => {
        fn accelerations_and_multipliers(&self, at: At<'_>, a: &mut [f64], lambda: &mut [f64]) -> Result<(), Singular> {
            if !self.sliding.is_empty() {
                return sliding::accelerations_and_multipliers(self, at, a, lambda);
            }
            lambda.fill(0.0);
            if !self.active_rows().is_empty() {
                self.phased.reactions(self, at, a, lambda)?;
            }
            // A system of balances gives its own accelerations, and leaves multipliers to the constraints.
            if self.derivation.is_some() || self.active_rows().is_empty() { self.accelerations(at, a) } else { Ok(()) }
        }

        fn motion_rates(&self, at: At<'_>, a: &mut [f64], lambda: &mut [f64]) -> bool {
            self.derivation.is_none() && self.phased.rates(self, at, a, lambda)
        }

        fn phase(&self) -> usize {
            self.phased.phase
        }

        fn row_history(&self) -> Option<&RowHistory> {
            Some(&self.phased.history)
        }

        fn row_history_mut(&mut self) -> Option<&mut RowHistory> {
            Some(&mut self.phased.history)
        }

        fn enforcement(&self) -> Enforcement {
            self.phased.enforcement
        }

        fn baumgarte_gain(&self) -> f64 {
            self.phased.alpha
        }

        fn enforce(&mut self, by: Enforcement, alpha: f64) {
            (self.phased.enforcement, self.phased.alpha) = (by, alpha);
        }

        fn disturb_forces(&mut self, times: f64) {
            self.phased.disturbance = times;
        }

        fn disturbance(&self) -> f64 {
            self.phased.disturbance
        }

        fn signal(&self, index: usize) -> Option<&Signal> {
            self.signals.get(index)?.as_ref()?.signal()
        }

        fn sliding(&self) -> &[usize] {
            &self.sliding
        }

        fn can_slide(&self) -> bool {
            true
        }

        fn set_input(&mut self, index: usize, signal: Signal) {
            if let Some(slot) = self.signals.get_mut(index) {
                *slot = Some(Replaced::Signal(signal));
            }
        }

        fn hold_input(&mut self, index: usize, value: f64) {
            if let Some(slot) = self.signals.get_mut(index) {
                *slot = Some(Replaced::Held(value));
            }
        }

        fn derivation(&self) -> Option<usize> {
            self.derivation
        }

        fn boxed_clone(&self) -> Box<dyn System> {
            Box::new(self.clone())
        }
    };
}
pub(super) use shared_by_systems;

impl Clone for Phased {
    fn clone(&self) -> Self {
        Phased {
            phase: self.phase,
            history: self.history.clone(),
            enforcement: self.enforcement,
            alpha: self.alpha,
            disturbance: self.disturbance,
            form: Mutex::default(),
        }
    }
}

impl Phased {
    /// The rates of accelerations and multipliers; false where they are not known.
    pub fn rates<S: System + ?Sized>(&self, system: &S, at: At<'_>, a: &mut [f64], lambda: &mut [f64]) -> bool {
        // What they need is generated where an event asks for it.
        let generated = system.description().events.iter().any(|event| event.rated == super::Rated::Held);
        let usual = self.enforcement == Enforcement::Multipliers && self.alpha == 0.0;
        if !generated || !usual || system.active_rows().is_empty() {
            return false;
        }
        self.form.lock().unwrap_or_else(PoisonError::into_inner).rates(system, at, a, lambda).unwrap_or(false)
    }

    /// Whether the constraints alone determine the accelerations in a phase to which these balances belong: then they come from the
    /// constraints, free of the rounding of forces.
    pub fn is_determined<S: System + ?Sized>(&self, system: &S, balances: usize) -> bool {
        let description = system.description();
        let belongs = description.balances.get(balances).is_some_and(|of| of.phases.contains(&(self.phase as u32)));
        let phase = description.phases.get(self.phase);
        belongs && phase.is_some_and(|phase| phase.rank as usize >= system.len())
    }

    /// Adds to h or F by how much forces are wrong at a state.
    pub fn disturb<S: System + ?Sized>(&self, system: &S, at: At<'_>, forces: &mut [f64]) {
        if self.disturbance == 0.0 {
            return;
        }
        let mut errors = vec![0.0; forces.len()];
        system.force_errors(at, &mut errors);
        let times = [self.disturbance, -self.disturbance].into_iter().cycle();
        forces.iter_mut().zip(errors).zip(times).for_each(|((force, error), times)| *force += times * error);
    }

    /// Whether accelerations and multipliers by elimination are as good as those by M and J: where coordinates keep a [`CLEAR`] part of their inertia, and
    /// rows of what their multipliers move them by, alone and at most so far.
    pub fn is_clear(&self, (pivots, sizes): (&[f64], &[f64]), (mobilities, alone): (&[f64], &[f64])) -> bool {
        let keeps = |(left, all): (&f64, &f64)| *left > CLEAR.powi(2) * all.abs();
        let moves = |(mobility, norm): (&f64, &f64)| *mobility > (CLEAR * norm).powi(2);
        self.history.norms.len() == mobilities.len()
            && pivots.iter().zip(sizes).chain(mobilities.iter().zip(alone)).all(keeps)
            && mobilities.iter().zip(&self.history.norms).all(moves)
    }

    /// Accelerations and multipliers by elimination, where these are all that is asked for; false where they are not known, or not good.
    fn eliminated<S: System + ?Sized>(&self, system: &S, at: At<'_>, a: &mut [f64], lambda: &mut [f64]) -> bool {
        let plain = self.enforcement == Enforcement::Multipliers && self.alpha == 0.0 && self.disturbance == 0.0;
        plain && rows_in_force(system).count() == lambda.len() && system.eliminated(at, a, lambda)
    }

    /// Accelerations and multipliers; where rows depend on each other the least multipliers.
    pub fn reactions<S: System + ?Sized>(
        &self,
        system: &S,
        at: At<'_>,
        a: &mut [f64],
        lambda: &mut [f64],
    ) -> Result<(), Singular> {
        if self.eliminated(system, at, a, lambda) {
            return Ok(());
        }
        self.accelerations_and_multipliers(system, at, a, lambda)?;
        let mut form = self.form.lock().unwrap_or_else(PoisonError::into_inner);
        match self.enforcement {
            Enforcement::Multipliers => form.spread(system, lambda),
            Enforcement::NullSpace if form.factor(system, at).is_ok() => form.spread(system, lambda),
            Enforcement::NullSpace | Enforcement::Springs { .. } => {}
        }
        Ok(())
    }

    /// Accelerations and multipliers, any where rows depend on each other.
    pub fn accelerations_and_multipliers<S: System + ?Sized>(
        &self,
        system: &S,
        at: At<'_>,
        a: &mut [f64],
        lambda: &mut [f64],
    ) -> Result<(), Singular> {
        if self.eliminated(system, at, a, lambda) {
            return Ok(());
        }
        let mut form = self.form.lock().unwrap_or_else(PoisonError::into_inner);
        match self.enforcement {
            Enforcement::Multipliers => form.accelerations_and_multipliers(system, at, self.alpha, a, lambda),
            Enforcement::NullSpace => form.by_null_space(system, at, self.alpha, a, lambda),
            Enforcement::Springs { stiffness, damping } => form.by_springs(system, at, (stiffness, damping), a, lambda),
        }
    }
}

/// The energy with what the springs of [`Enforcement::Springs`] hold and their dampers take.
pub(super) fn sprung<S: System + ?Sized>(system: &S, at: At<'_>, mut energy: Energy) -> Energy {
    let Enforcement::Springs { stiffness, damping } = system.enforcement() else { return energy };
    let triples = constraint_triples(system, at);
    for row in rows_in_force(system) {
        let [c, rate, _] = triples[row];
        let held = if system.description().rows[row].holonomic { 0.5 * stiffness * c * c } else { 0.0 };
        energy.potential += held;
        energy.jacobi += held;
        energy.scale += held;
        energy.power -= damping * rate * rate;
    }
    energy
}

/// 1 for this phase, 0 for all others.
pub(super) fn indicate(indicators: &mut [f64], phase: usize) {
    for (k, indicator) in indicators.iter_mut().enumerate() {
        *indicator = if k == phase { 1.0 } else { 0.0 };
    }
}
