//! A [`Mechanism`] behind slices.

use super::balances::solve_rows;
use super::dual::{Dual, moving, replaced_input, rounded, seed, still};
use super::phased::{Phased, RowHistory, shared_by_systems, sprung};
use super::system::Replaced;
use super::{
    Along, At, Contacts, Description, Energy, Enforcement, Function, Gimbal, Mechanism, Motion, MotionNumbers, Noise,
    SERIES_TERMS, Sampling, Scene, Series, Signal, Singular, System, Values, sliding,
};
use crate::cause::NoSeries;

/// A mechanism of static size as a [`System`], with its block of constants at hand.
#[derive(Clone)]
pub struct Dynamic<M: Mechanism<N, C>, const N: usize, const C: usize> {
    mechanism: M,
    constants: M::Constants<f64>,
    signals: Vec<Option<Replaced>>,
    derivation: Option<usize>,
    /// Empty without constraints.
    phased: Phased,
    sliding: Vec<usize>,
}

impl<M: Mechanism<N, C> + 'static, const N: usize, const C: usize> Dynamic<M, N, C> {
    /// Computes the constants of these parameters once.
    pub fn new(mechanism: M) -> Self {
        let constants = M::constants(|_| mechanism.clone());
        let signals = vec![None; M::description().inputs.len()];
        Dynamic { mechanism, constants, signals, derivation: None, phased: Phased::default(), sliding: Vec::new() }
    }

    /// The parameters.
    pub fn mechanism(&self) -> &M {
        &self.mechanism
    }

    /// Whether the equations are those of the file's energies, with the file's inputs.
    #[cfg(feature = "ensemble")]
    pub(crate) fn is_plain(&self) -> bool {
        self.derivation.is_none() && self.signals.iter().all(Option::is_none)
    }

    fn input_block(&self, t: f64) -> M::Inputs<f64> {
        let mut block = M::inputs(&self.constants, t);
        for (signal, slot) in self.signals.iter().zip(block.as_mut().chunks_exact_mut(3)) {
            if let Some(signal) = signal {
                slot.copy_from_slice(&signal.at(t));
            }
        }
        block
    }

    /// Solves a system of balances on the stack and hands its unknowns on.
    fn by_balances(&self, system: usize, at: At<'_>, then: impl FnOnce(&[f64])) -> Result<(), Singular> {
        super::balances::belongs(M::description(), system, self.phased.phase)?;
        let size = M::description().balances[system].unknowns.len();
        let mut block = M::Balances::filled(0.0);
        let (matrix, rest) = block.as_mut().split_at_mut(size * size);
        let (unknowns, rest) = rest.split_at_mut(size);
        let u = self.input_block(at.t);
        M::balances(&self.constants, system, at.t, u.as_ref(), array(at.q), array(at.v), matrix, unknowns);
        solve_rows(matrix, unknowns, &mut rest[..size]).map_err(|fault| fault.of(system))?;
        then(unknowns);
        Ok(())
    }

    /// The accelerations from Lagrange's equations where no constraint acts.
    #[inline]
    fn free(&self, t: f64, q: &[f64; N], v: &[f64; N], a: &mut [f64; N]) -> Result<(), Singular> {
        Ok(M::accelerations(&self.constants, t, self.input_block(t).as_ref(), q, v, a)?)
    }

    /// The direction in which a parameter changes: 1 in its place, 0 elsewhere.
    fn unit(&self, parameter: usize) -> M {
        let mut unit = self.mechanism.clone();
        for index in 0..M::description().parameters.len() {
            if let Some(field) = unit.parameter_mut(index) {
                *field = f64::from(u8::from(index == parameter));
            }
        }
        unit
    }

    fn first_mode(&self) -> usize {
        self.first_phase() - M::MODES
    }

    fn first_phase(&self) -> usize {
        self.first_memory() - M::PHASES
    }

    fn first_memory(&self) -> usize {
        self.constants.as_ref().len() - M::MEMORY
    }

    /// The accelerations and multipliers of a state, where they are needed and not given; NaN where there are none.
    fn completed(&self, at: At<'_>, needed: bool) -> ([f64; N], [f64; C]) {
        let (mut a, mut lambda) = (array_or_zero(at.a), array_or_zero(at.lambda));
        if C > 0
            && needed
            && at.lambda.is_empty()
            && self.accelerations_and_multipliers(at, &mut a, &mut lambda).is_err()
        {
            (a, lambda) = ([f64::NAN; N], [f64::NAN; C]);
        }
        (a, lambda)
    }
}

/// A slice of generalized coordinates as an array.
///
/// # Panics
/// If the slice has another length than the mechanism has coordinates, which is a programming error.
fn array<const N: usize>(slice: &[f64]) -> &[f64; N] {
    slice.try_into().expect(WIDTH)
}

fn array_mut<const N: usize>(slice: &mut [f64]) -> &mut [f64; N] {
    slice.try_into().expect(WIDTH)
}

/// What slices are.
const WIDTH: &str = "as many numbers as generalized coordinates";

/// Accelerations or multipliers as an array; an empty slice stands for numbers that nobody reads.
fn array_or_zero<const N: usize>(slice: &[f64]) -> [f64; N] {
    if slice.is_empty() { [0.0; N] } else { *array(slice) }
}

/// A state and all constants as [`Dual`] numbers, none of which changes yet.
struct DualState<M: Mechanism<N, C>, const N: usize, const C: usize> {
    constants: M::Constants<Dual>,
    inputs: M::Inputs<Dual>,
    /// q, q', q''.
    motion: [[Dual; N]; 3],
    multipliers: [Dual; C],
    time: Dual,
}

impl<M: Mechanism<N, C> + 'static, const N: usize, const C: usize> DualState<M, N, C> {
    fn new(system: &Dynamic<M, N, C>, at: At<'_>) -> Self {
        let zero = Dual::constant(0.0);
        let (mut constants, mut inputs) = (M::Constants::<Dual>::filled(zero), M::Inputs::<Dual>::filled(zero));
        rounded(system.constants.as_ref(), constants.as_mut());
        still(system.input_block(at.t).as_ref(), inputs.as_mut());
        let (mut motion, mut multipliers) = ([[zero; N]; 3], [zero; C]);
        for (from, to) in [at.q, at.v, at.a].into_iter().zip(motion.iter_mut()) {
            still(from, to);
        }
        still(at.lambda, &mut multipliers);
        DualState { constants, inputs, motion, multipliers, time: Dual::constant(at.t) }
    }

    /// With the slopes that a direction gives to it.
    fn along(system: &Dynamic<M, N, C>, at: At<'_>, along: &Along<'_>) -> Self {
        let (zero, time) = (Dual::constant(0.0), Dual::moving(at.t, along.t));
        let mut constants = M::Constants::<Dual>::filled(zero);
        match along.parameter {
            None => still(system.constants.as_ref(), constants.as_mut()),
            Some(parameter) => {
                constants =
                    M::constants(|lane| if lane == 0 { system.mechanism.clone() } else { system.unit(parameter) });
                let first = system.first_mode();
                still(&system.constants.as_ref()[first..], &mut constants.as_mut()[first..]);
            }
        }
        if let Some(held) = along.memory {
            let held = &mut constants.as_mut()[system.first_memory() + held];
            *held = Dual::moving(held.value, 1.0);
        }
        let mut inputs = M::inputs(&constants, time);
        for (signal, slot) in system.signals.iter().zip(inputs.as_mut().chunks_exact_mut(3)) {
            if let Some(signal) = signal {
                slot.copy_from_slice(&replaced_input(signal.at(at.t), along.t));
            }
        }
        let (mut motion, mut multipliers) = ([[zero; N]; 3], [zero; C]);
        for ((from, slopes), to) in
            [(at.q, along.q), (at.v, along.v), (at.a, along.a)].into_iter().zip(motion.iter_mut())
        {
            moving(from, slopes, to);
        }
        moving(at.lambda, along.lambda, &mut multipliers);
        DualState { constants, inputs, motion, multipliers, time }
    }

    /// A function of it.
    fn evaluate(&self, function: Function, values: &mut [Dual]) {
        let DualState { constants: c, inputs, motion: [q, v, a], multipliers: l, time: t } = self;
        let u = inputs.as_ref();
        match function {
            Function::Residual => M::residual(c, *t, u, q, v, a, l, values.try_into().expect(WIDTH)),
            Function::RowAccelerations => {
                let pattern = &M::description().constraint_pattern;
                let mut jacobian = vec![Dual::constant(0.0); pattern.len()];
                M::constraint_bias(c, *t, u, q, v, values);
                M::constraint_matrix(c, *t, u, q, &mut jacobian);
                for ((row, column), slope) in pattern.iter().zip(jacobian) {
                    values[*row as usize] = values[*row as usize] + slope * a[*column as usize];
                }
            }
            Function::Constraints => M::constraints(c, *t, u, q, v, values),
            Function::Events => M::events(c, *t, u, q, v, a, l, values),
            Function::Assignments => M::assignments(c, *t, u, q, v, a, l, values),
            Function::Switches => M::switches(c, *t, u, q, v, a, l, values),
            Function::Outputs => M::outputs(c, *t, u, q, v, a, l, values),
            Function::Energies => values.copy_from_slice(&M::energy(c, *t, u, q, v, a, l)),
            Function::Invariants => M::invariants(c, *t, u, q, v, values),
            Function::StartConditions => M::start_conditions(c, *t, u, q, v, a, l, values),
            Function::Restitutions | Function::Scene(_) => (),
        }
    }

    /// What outputs depend on, in the order of the columns of [`System::output_slopes`].
    fn lists(&mut self) -> [&mut [Dual]; 6] {
        let [q, v, a] = &mut self.motion;
        [q, v, a, &mut self.multipliers, self.inputs.as_mut(), std::slice::from_mut(&mut self.time)]
    }

    fn outputs(&self, values: &mut [Dual]) {
        let [q, v, a] = &self.motion;
        M::outputs(&self.constants, self.time, self.inputs.as_ref(), q, v, a, &self.multipliers, values);
    }
}

/// Calls a generated function of a state: all that it takes before what it fills, with these accelerations.
macro_rules! at_state {
    ($self:ident.$function:ident, $at:ident, $a:expr, $($filled:expr),+) => {{
        let (u, lambda) = ($self.input_block($at.t), array_or_zero($at.lambda));
        M::$function(&$self.constants, $at.t, u.as_ref(), array($at.q), array($at.v), $a, &lambda, $($filled),+)
    }};
}

impl<M: Mechanism<N, C> + 'static, const N: usize, const C: usize> System for Dynamic<M, N, C> {
    shared_by_systems!();

    fn description(&self) -> &Description {
        M::description()
    }

    fn motions(&self) -> &[Motion] {
        M::motions()
    }

    fn motion_numbers(&self, motion: usize) -> MotionNumbers {
        let numbers = M::motion_numbers(&self.mechanism.parameters(), motion);
        M::motions().get(motion).map_or_else(MotionNumbers::default, |motion| MotionNumbers::new(motion, &numbers))
    }

    fn sampling(&self) -> &Sampling {
        M::sampling()
    }

    fn held_noise(&self) -> &[Noise] {
        M::held_noise()
    }

    fn contacts(&self) -> &Contacts {
        M::contacts()
    }

    fn memory(&self) -> &[f64] {
        &self.constants.as_ref()[self.first_memory()..]
    }

    fn set_memory(&mut self, values: &[f64]) {
        let first = self.first_memory();
        self.constants.as_mut()[first..].copy_from_slice(values);
    }

    fn assignments(&self, at: At<'_>, values: &mut [f64]) {
        if !self.sliding.is_empty() {
            return sliding::resolved(self, at).assignments(at, values);
        }
        let u = self.input_block(at.t);
        let (a, lambda) = self.completed(at, M::sampling().sets_use_accelerations);
        M::assignments(&self.constants, at.t, u.as_ref(), array(at.q), array(at.v), &a, &lambda, values);
    }

    fn scene_memory(&self, scene: usize) -> Vec<f64> {
        M::scene_memory(&self.mechanism.parameters(), scene)
    }

    fn clocks(&self) -> Vec<[f64; 2]> {
        M::clock_numbers(&self.mechanism.parameters()).chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
    }

    fn gimbals(&self) -> &[Gimbal] {
        M::gimbals()
    }

    fn accelerations(&self, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        if !self.sliding.is_empty() {
            return sliding::accelerations_and_multipliers(self, at, a, &mut [0.0; C]);
        }
        if let Some(system) = self.derivation.filter(|balances| !self.phased.is_determined(self, *balances)) {
            return self.by_balances(system, at, |unknowns| a.copy_from_slice(&unknowns[..N]));
        }
        if C > 0 && !self.active_rows().is_empty() || self.phased.disturbance != 0.0 {
            return self.phased.accelerations_and_multipliers(self, at, a, &mut [0.0; C]);
        }
        self.free(at.t, array(at.q), array(at.v), array_mut(a))
    }

    fn rate(&self, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), Singular> {
        assert!(y.len() == 2 * N && rate.len() == 2 * N, "{WIDTH}");
        let ((q, v), (speeds, a)) = (y.split_at(N), rate.split_at_mut(N));
        speeds.copy_from_slice(v);
        if C > 0 || self.derivation.is_some() || !self.sliding.is_empty() || self.phased.disturbance != 0.0 {
            return self.accelerations(At::new(t, q, v), a);
        }
        self.free(t, array(q), array(v), array_mut(a))
    }

    fn eliminated(&self, at: At<'_>, a: &mut [f64], lambda: &mut [f64]) -> bool {
        if !M::ELIMINATES {
            return false;
        }
        let (u, lambda) = (self.input_block(at.t), lambda.try_into().expect(WIDTH));
        let ((mut pivots, mut sizes), (mut mobilities, mut alone)) = (([0.0; N], [0.0; N]), ([0.0; C], [0.0; C]));
        let (q, v, a) = (array(at.q), array(at.v), array_mut(a));
        let (c, u) = (&self.constants, u.as_ref());
        M::eliminated(c, at.t, u, q, v, a, lambda, &mut pivots, &mut sizes, &mut mobilities, &mut alone);
        self.phased.is_clear((&pivots, &sizes), (&mobilities, &alone))
    }

    fn part_accelerations(&self, part: usize, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        if self.phased.disturbance != 0.0 {
            return self.accelerations(at, a);
        }
        let u = self.input_block(at.t);
        let (q, v) = (array(at.q), array(at.v));
        Ok(M::part_accelerations(&self.constants, part, at.t, u.as_ref(), q, v, array_mut(a))?)
    }

    fn part_energy(&self, part: usize, at: At<'_>) -> Energy {
        let u = self.input_block(at.t);
        Energy::from_array(M::part_energy(&self.constants, part, at.t, u.as_ref(), array(at.q), array(at.v)))
    }

    fn constraints(&self, at: At<'_>, triples: &mut [f64]) {
        let u = self.input_block(at.t);
        M::constraints(&self.constants, at.t, u.as_ref(), array(at.q), array(at.v), triples);
    }

    fn constraint_matrix(&self, at: At<'_>, values: &mut [f64]) {
        M::constraint_matrix(&self.constants, at.t, self.input_block(at.t).as_ref(), array(at.q), values);
    }

    fn constraint_bias(&self, at: At<'_>, gamma: &mut [f64]) {
        let u = self.input_block(at.t);
        M::constraint_bias(&self.constants, at.t, u.as_ref(), array(at.q), array(at.v), gamma);
    }

    fn friction(&self, at: At<'_>, values: &mut [f64]) {
        M::friction(&self.constants, at.t, self.input_block(at.t).as_ref(), array(at.q), array(at.v), values);
    }

    fn constraint_jacobians(&self, at: At<'_>, dq: &mut [f64], dv: &mut [f64]) {
        at_state!(self.constraint_jacobians, at, array(at.a), dq, dv);
    }

    fn constraint_rate_jacobian(&self, at: At<'_>, values: &mut [f64]) {
        let u = self.input_block(at.t);
        M::constraint_rate_jacobian(&self.constants, at.t, u.as_ref(), array(at.q), array(at.v), values);
    }

    fn constraint_rates_by_inputs(&self, at: At<'_>, columns: &mut [f64]) -> bool {
        let zero = Dual::constant(0.0);
        let mut c = M::Constants::<Dual>::filled(zero);
        still(self.constants.as_ref(), c.as_mut());
        let (mut u, mut q, mut v) = (M::Inputs::<Dual>::filled(zero), [zero; N], [zero; N]);
        still(self.input_block(at.t).as_ref(), u.as_mut());
        still(at.q, &mut q);
        still(at.v, &mut v);
        let mut triples = vec![zero; 3 * C];
        for (k, column) in columns.chunks_exact_mut(C.max(1)).enumerate() {
            let place = 3 * (k / 2) + k % 2;
            u.as_mut()[place] = Dual::moving(u.as_ref()[place].value, 1.0);
            M::constraints(&c, Dual::constant(at.t), u.as_ref(), &q, &v, &mut triples);
            u.as_mut()[place] = Dual::constant(u.as_ref()[place].value);
            column.iter_mut().zip(triples.chunks_exact(3)).for_each(|(slope, triple)| *slope = triple[1].slope);
        }
        true
    }

    fn held_rates(&self, at: At<'_>, values: &mut [f64]) {
        at_state!(self.held_rates, at, array(at.a), values);
    }

    fn set_phase(&mut self, phase: usize) {
        if phase < M::description().phases.len() {
            self.phased.phase = phase;
            let first = self.first_phase();
            let end = self.first_memory();
            super::phased::indicate(&mut self.constants.as_mut()[first..end], phase);
        }
    }

    fn start_conditions(&self, at: At<'_>) -> Vec<(f64, f64)> {
        let wanted = self.mechanism.start_condition_values();
        let mut values = vec![0.0; wanted.len()];
        let u = self.input_block(at.t);
        let (a, lambda) = self.completed(at, !values.is_empty());
        M::start_conditions(&self.constants, at.t, u.as_ref(), array(at.q), array(at.v), &a, &lambda, &mut values);
        values.into_iter().zip(wanted).collect()
    }

    fn start_condition_speeds(&self) -> Vec<(u32, u32)> {
        M::start_condition_speeds().to_vec()
    }

    fn restitutions(&self) -> Vec<f64> {
        M::restitutions(&self.mechanism.parameters())
    }

    fn series(&self) -> Result<&Series, NoSeries> {
        if self.signals.iter().any(Option::is_some) {
            return Err(NoSeries::Inputs);
        }
        M::series().ok_or(NoSeries::Functions)
    }

    fn series_constants(&self, values: &mut [f64]) {
        // Inputs that stand in constants are the same at all times.
        M::series_constants(&self.constants, 0.0, self.input_block(0.0).as_ref(), values);
    }

    fn expansion(&self, t: f64, unit: f64, state: &mut [[f64; SERIES_TERMS]]) -> bool {
        M::expansion(&self.constants, self.input_block(0.0).as_ref(), t, unit, state)
    }

    fn frequencies(&self) -> Option<Vec<f64>> {
        let replaced = self.signals.iter().any(Option::is_some);
        if replaced { None } else { M::frequencies(&self.mechanism.parameters()) }
    }

    fn mass_matrix(&self, at: At<'_>, values: &mut [f64]) {
        // Without rates there are no states of first order, which masses may contain.
        let v = if at.v.is_empty() { &[f64::NAN; N] } else { array(at.v) };
        M::mass_matrix(&self.constants, at.t, self.input_block(at.t).as_ref(), array(at.q), v, values);
    }

    fn bias(&self, at: At<'_>, h: &mut [f64]) {
        M::bias(&self.constants, at.t, self.input_block(at.t).as_ref(), array(at.q), array(at.v), array_mut(h));
        self.phased.disturb(self, at, h);
    }

    fn residual(&self, at: At<'_>, f: &mut [f64]) {
        if !self.sliding.is_empty() {
            return sliding::resolved(self, at).residual(at, f);
        }
        at_state!(self.residual, at, array(at.a), array_mut(f));
        self.phased.disturb(self, at, f);
    }

    fn jacobians(&self, at: At<'_>, dq: &mut [f64], dv: &mut [f64]) {
        at_state!(self.jacobians, at, array(at.a), dq, dv);
    }

    fn input_jacobian(&self, at: At<'_>, du: &mut [f64]) {
        at_state!(self.input_jacobian, at, array(at.a), du);
    }

    fn time_jacobian(&self, at: At<'_>, dt: &mut [f64]) {
        at_state!(self.time_jacobian, at, array(at.a), dt);
    }

    fn time_dependence(&self, at: At<'_>, dt: &mut [f64]) {
        at_state!(self.time_dependence, at, array(at.a), dt);
    }

    fn magnitudes(&self, at: At<'_>, sums: &mut [f64]) {
        at_state!(self.magnitudes, at, array(at.a), sums);
    }

    fn force_errors(&self, at: At<'_>, errors: &mut [f64]) {
        let mut values = [Dual::constant(0.0); N];
        let still = At::new(at.t, at.q, at.v);
        DualState::<M, N, C>::new(self, still).evaluate(Function::Residual, &mut values);
        errors.iter_mut().zip(values).for_each(|(error, value)| *error = value.error());
    }

    fn energy(&self, at: At<'_>) -> Energy {
        if !self.sliding.is_empty() {
            return sliding::resolved(self, at).energy(at);
        }
        let (a, lambda) = self.completed(at, !M::description().structure.conservative);
        let u = self.input_block(at.t);
        let energy = M::energy(&self.constants, at.t, u.as_ref(), array(at.q), array(at.v), &a, &lambda);
        sprung(self, at, Energy::from_array(energy))
    }

    fn invariants(&self, at: At<'_>, pairs: &mut [f64]) {
        M::invariants(&self.constants, at.t, self.input_block(at.t).as_ref(), array(at.q), array(at.v), pairs);
    }

    fn outputs(&self, at: At<'_>, values: &mut [f64]) {
        if !self.sliding.is_empty() {
            return sliding::outputs(self, at, values);
        }
        let u = self.input_block(at.t);
        let (a, lambda) = self.completed(at, M::description().outputs_use_accelerations);
        M::outputs(&self.constants, at.t, u.as_ref(), array(at.q), array(at.v), &a, &lambda, values);
        let Some(system) = self.derivation else { return };
        let pairs = &M::description().balances[system].outputs;
        if !pairs.is_empty() {
            let put = |unknowns: &[f64]| super::balances::put_reactions(pairs, unknowns, values);
            // Where the system is singular its accelerations are missing already.
            let _ = self.by_balances(system, at, put);
        }
    }

    fn output_slopes(&self, at: At<'_>, columns: &mut [f64]) -> bool {
        let mut state = DualState::<M, N, C>::new(self, at);
        let mut values = vec![Dual::constant(0.0); M::description().output_len()];
        for (k, column) in columns.chunks_exact_mut(values.len().max(1)).enumerate() {
            seed(&mut state.lists(), k, 1.0);
            state.outputs(&mut values);
            seed(&mut state.lists(), k, 0.0);
            column.iter_mut().zip(&values).for_each(|(slope, value)| *slope = value.slope);
        }
        true
    }

    fn slopes(&self, function: Function, at: At<'_>, along: &Along<'_>, values: &mut [f64]) -> bool {
        let mut room = vec![Dual::constant(0.0); values.len()];
        match function {
            Function::Restitutions | Function::Scene(_) => {
                let list = self.mechanism.parameters().into_iter().enumerate();
                let slope = |index| f64::from(u8::from(along.parameter == Some(index)));
                let parameters: Vec<Dual> = list.map(|(index, value)| Dual::moving(value, slope(index))).collect();
                match function {
                    Function::Scene(scene) => M::scene_numbers(&parameters, scene, &mut room),
                    _ => room = M::restitutions(&parameters),
                }
            }
            _ => DualState::<M, N, C>::along(self, at, along).evaluate(function, &mut room),
        }
        values.iter_mut().zip(room).for_each(|(slope, value)| *slope = value.slope);
        true
    }

    fn output_errors(&self, at: At<'_>, errors: &mut [f64]) {
        let mut values = vec![Dual::constant(0.0); errors.len()];
        DualState::<M, N, C>::new(self, at).outputs(&mut values);
        errors.iter_mut().zip(values).for_each(|(error, value)| *error = value.error());
    }

    fn events(&self, at: At<'_>, pairs: &mut [f64]) {
        if !self.sliding.is_empty() {
            return sliding::resolved(self, at).events(at, pairs);
        }
        let u = self.input_block(at.t);
        let (a, lambda) = self.completed(at, M::description().events_use_accelerations);
        M::events(&self.constants, at.t, u.as_ref(), array(at.q), array(at.v), &a, &lambda, pairs);
    }

    fn event_rates(&self, at: At<'_>, rates: &mut [f64]) {
        at_state!(self.event_rates, at, &array_or_zero(at.a), rates);
    }

    fn arguments(&self, at: At<'_>, pairs: &mut [f64]) {
        at_state!(self.arguments, at, &array_or_zero(at.a), pairs);
    }

    fn switches(&self, at: At<'_>, pairs: &mut [f64]) {
        at_state!(self.switches, at, &array_or_zero(at.a), pairs);
    }

    fn modes(&self) -> &[f64] {
        &self.constants.as_ref()[self.first_mode()..self.first_phase()]
    }

    fn set_modes(&mut self, modes: &[f64]) {
        let (first, end) = (self.first_mode(), self.first_phase());
        self.constants.as_mut()[first..end].copy_from_slice(modes);
        self.sliding = sliding::places(modes);
    }

    fn drawing(&self, at: At<'_>, values: &mut [f64]) {
        M::drawing(&self.constants, at.t, self.input_block(at.t).as_ref(), array(at.q), array(at.v), values);
    }

    fn parameters(&self) -> Vec<f64> {
        self.mechanism.parameters()
    }

    fn set_parameter(&mut self, index: usize, value: f64) {
        if let Some(field) = self.mechanism.parameter_mut(index) {
            *field = value;
            let kept = self.constants.as_ref()[self.first_mode()..].to_vec();
            self.constants = M::constants(|_| self.mechanism.clone());
            let first = self.first_mode();
            self.constants.as_mut()[first..].copy_from_slice(&kept);
        }
    }

    fn inputs(&self, t: f64, values: &mut [f64]) {
        values.copy_from_slice(self.input_block(t).as_ref());
    }

    fn scene_parameters(&self, scene: usize) -> Vec<(usize, f64)> {
        self.mechanism.scene_parameters(scene)
    }

    fn scene(&self, scene: usize) -> Scene {
        self.mechanism.scene(scene)
    }

    fn equilibrium_guess(&self) -> Option<Vec<f64>> {
        self.mechanism.equilibrium_guess().map(Vec::from)
    }

    fn balances(&self, system: usize, at: At<'_>, matrix: &mut [f64], right: &mut [f64]) {
        let u = self.input_block(at.t);
        M::balances(&self.constants, system, at.t, u.as_ref(), array(at.q), array(at.v), matrix, right);
    }

    fn set_derivation(&mut self, system: Option<usize>) {
        if system.is_none_or(|system| system < M::description().balances.len()) {
            self.derivation = system;
        }
    }
}
