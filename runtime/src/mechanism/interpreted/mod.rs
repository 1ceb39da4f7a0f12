//! A model file that nobody compiled, as a [`System`].

mod columns;
mod describe;
mod extended;
mod series;
mod slopes;

use std::sync::{Arc, OnceLock};

use dalembert_symbolic::expr::Symbol;
use dalembert_symbolic::interpret::{self, Function, Interpreter};
use dalembert_symbolic::lower::Program;

use describe::{contacts, describe, gimbal, motion, noise, sampling};
pub(crate) use extended::ExtendedAt;
use series::OwnSeries;

use super::balances::{belongs, put_reactions};
use super::phased::{Phased, RowHistory, indicate, shared_by_systems, sprung};
use super::system::{Replaced, put_diagonal};
use super::{
    Along, At, Balances, Contacts, Description, Energy, Enforcement, Gimbal, Motion, MotionNumbers, Noise, Sampling,
    Scene, Series, Signal, Singular, SingularMass, Spin, System, sliding,
};
use crate::cause::NoSeries;

/// An interpreted mechanism; copies share what does not change.
#[derive(Clone)]
pub struct Interpreted {
    interpreter: Interpreter,
    description: Arc<Description>,
    gimbals: Arc<[Gimbal]>,
    motions: Arc<[Motion]>,
    sampling: Arc<Sampling>,
    noise: Arc<[Noise]>,
    contacts: Arc<Contacts>,
    signals: Vec<Option<Replaced>>,
    derivation: Option<usize>,
    phased: Phased,
    sliding: Vec<usize>,
    series: Arc<OnceLock<Option<OwnSeries>>>,
}

impl Interpreted {
    /// From a program and the text of its model file.
    pub fn new(program: Program, source: &str) -> Self {
        let description = Arc::new(describe(&program, source));
        let gimbals = program.model.gimbals().iter().map(gimbal).collect();
        let motions = program.model.motions.iter().map(motion).collect();
        let sampling = Arc::new(sampling(&program));
        let noise = program.model.noise.iter().map(noise).collect();
        let contacts = Arc::new(contacts(&program));
        let signals = vec![None; program.model.inputs.len()];
        Interpreted {
            interpreter: Interpreter::new(program),
            description,
            gimbals,
            motions,
            sampling,
            noise,
            contacts,
            signals,
            derivation: None,
            phased: Phased::default(),
            sliding: Vec::new(),
            series: Arc::default(),
        }
    }

    fn own_series(&self) -> Option<&OwnSeries> {
        self.series.get_or_init(|| OwnSeries::of(self.interpreter.program())).as_ref()
    }

    fn evaluate(&self, function: Function, at: At<'_>, values: &mut [f64]) {
        let u = self.input_values(at.t);
        self.interpreter.evaluate(function, with_inputs(at, &u), values);
    }

    /// As `evaluate`, with the accelerations and multipliers of the state where they are needed and not given; NaN where
    /// there are none.
    fn complete(&self, function: Function, at: At<'_>, needed: bool, values: &mut [f64]) {
        let rows = self.description.rows.len();
        if rows == 0 || !needed || !at.lambda.is_empty() {
            return self.evaluate(function, at, values);
        }
        let (mut a, mut lambda) = (vec![0.0; at.q.len()], vec![0.0; rows]);
        if self.accelerations_and_multipliers(at, &mut a, &mut lambda).is_err() {
            a.fill(f64::NAN);
            lambda.fill(f64::NAN);
        }
        self.evaluate(function, at.accelerated(&a).constrained(&lambda), values);
    }

    /// The unknowns of the system of balances in force; `None` without one.
    fn unknowns(&self, at: At<'_>) -> Option<Result<Vec<f64>, Singular>> {
        let system = self.derivation?;
        if let Err(fault) = belongs(&self.description, system, self.phased.phase) {
            return Some(Err(fault));
        }
        let mut balances = Balances::new(self, system)?;
        balances.evaluate(self, at);
        let mut unknowns = vec![0.0; balances.size()];
        Some(balances.solve(&mut unknowns).map(|()| unknowns))
    }

    /// Whether M, h and the Jacobians of F are not written down; their patterns are full then, and they come from slopes of F.
    pub(crate) fn is_unformed(&self) -> bool {
        self.interpreter.program().unformed
    }

    fn columns(&self, at: At<'_>, symbols: fn(u32) -> Symbol, put: impl FnMut(usize, &mut dyn Iterator<Item = f64>)) {
        let u = self.input_values(at.t);
        columns::columns(&self.interpreter, with_inputs(at, &u), symbols, put);
    }

    fn input_values(&self, t: f64) -> Vec<f64> {
        let mut u = vec![0.0; 3 * self.signals.len()];
        self.interpreter.evaluate(Function::Inputs, interpret::At { t, ..interpret::At::default() }, &mut u);
        for (signal, slot) in self.signals.iter().zip(u.chunks_exact_mut(3)) {
            if let Some(signal) = signal {
                slot.copy_from_slice(&signal.at(t));
            }
        }
        u
    }
}

impl System for Interpreted {
    shared_by_systems!();

    fn description(&self) -> &Description {
        &self.description
    }

    fn sampling(&self) -> &Sampling {
        &self.sampling
    }

    fn held_noise(&self) -> &[Noise] {
        &self.noise
    }

    fn contacts(&self) -> &Contacts {
        &self.contacts
    }

    fn memory(&self) -> &[f64] {
        &self.interpreter.memory
    }

    fn set_memory(&mut self, values: &[f64]) {
        self.interpreter.memory.copy_from_slice(values);
    }

    fn assignments(&self, at: At<'_>, values: &mut [f64]) {
        if !self.sliding.is_empty() {
            return sliding::resolved(self, at).assignments(at, values);
        }
        self.complete(Function::Assignments, at, self.sampling.sets_use_accelerations, values);
    }

    fn scene_memory(&self, scene: usize) -> Vec<f64> {
        let starts = self.interpreter.program().memory_of_scene(scene);
        starts.into_iter().map(|id| self.interpreter.constant(id)).collect()
    }

    fn clocks(&self) -> Vec<[f64; 2]> {
        let numbers = self.interpreter.program().clock_numbers();
        numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]].map(|id| self.interpreter.constant(id))).collect()
    }

    fn gimbals(&self) -> &[Gimbal] {
        &self.gimbals
    }

    fn motions(&self) -> &[Motion] {
        &self.motions
    }

    fn motion_numbers(&self, motion: usize) -> MotionNumbers {
        let numbers = self.interpreter.program().motion_numbers(motion);
        let numbers: Vec<f64> = numbers.into_iter().map(|id| self.interpreter.constant(id)).collect();
        self.motions.get(motion).map_or_else(MotionNumbers::default, |motion| MotionNumbers::new(motion, &numbers))
    }

    fn accelerations(&self, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        if !self.sliding.is_empty() {
            return sliding::accelerations_and_multipliers(self, at, a, &mut vec![0.0; self.description.rows.len()]);
        }
        let determined = self.derivation.is_some_and(|balances| self.phased.is_determined(self, balances));
        if let Some(unknowns) = if determined { None } else { self.unknowns(at) } {
            a.copy_from_slice(&unknowns?[..a.len()]);
            return Ok(());
        }
        if !self.active_rows().is_empty() || self.phased.disturbance != 0.0 {
            let mut lambda = vec![0.0; self.description.rows.len()];
            return self.phased.accelerations_and_multipliers(self, at, a, &mut lambda);
        }
        let u = self.input_values(at.t);
        self.interpreter.accelerations(with_inputs(at, &u), a).map_err(|coordinate| SingularMass { coordinate }.into())
    }

    fn eliminated(&self, at: At<'_>, a: &mut [f64], lambda: &mut [f64]) -> bool {
        let (n, m, u) = (a.len(), lambda.len(), self.input_values(at.t));
        let mut tests = vec![0.0; 2 * (n + m)];
        let lists = [a, lambda, &mut tests];
        if !self.interpreter.eliminated(with_inputs(at, &u), lists) {
            return false;
        }
        let (pivots, mobilities) = tests.split_at(2 * n);
        self.phased.is_clear(pivots.split_at(n), mobilities.split_at(m))
    }

    fn part_accelerations(&self, part: usize, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        if self.phased.disturbance != 0.0 {
            return self.accelerations(at, a);
        }
        let u = self.input_values(at.t);
        let computed = self.interpreter.part_accelerations(part, with_inputs(at, &u), a);
        computed.map_err(|coordinate| SingularMass { coordinate }.into())
    }

    fn part_energy(&self, part: usize, at: At<'_>) -> Energy {
        let u = self.input_values(at.t);
        Energy::from_array(self.interpreter.part_energy(part, with_inputs(at, &u)))
    }

    fn constraints(&self, at: At<'_>, triples: &mut [f64]) {
        self.evaluate(Function::Constraints, at, triples);
    }

    fn constraint_matrix(&self, at: At<'_>, values: &mut [f64]) {
        self.evaluate(Function::ConstraintMatrix, at, values);
    }

    fn constraint_bias(&self, at: At<'_>, gamma: &mut [f64]) {
        self.evaluate(Function::ConstraintBias, at, gamma);
    }

    fn friction(&self, at: At<'_>, values: &mut [f64]) {
        self.evaluate(Function::Friction, at, values);
    }

    fn constraint_jacobians(&self, at: At<'_>, dq: &mut [f64], dv: &mut [f64]) {
        self.evaluate(Function::ConstraintStiffness, at, dq);
        self.evaluate(Function::ConstraintDamping, at, dv);
    }

    fn constraint_rate_jacobian(&self, at: At<'_>, values: &mut [f64]) {
        self.evaluate(Function::ConstraintRateJacobian, at, values);
    }

    fn constraint_rates_by_inputs(&self, at: At<'_>, columns: &mut [f64]) -> bool {
        let u = self.input_values(at.t);
        slopes::constraint_rates_by_inputs(&self.interpreter, with_inputs(at, &u), columns);
        true
    }

    fn held_rates(&self, at: At<'_>, values: &mut [f64]) {
        self.evaluate(Function::HeldRates, at, values);
    }

    fn set_phase(&mut self, phase: usize) {
        if phase < self.description.phases.len() {
            self.phased.phase = phase;
            indicate(&mut self.interpreter.phases, phase);
        }
    }

    fn start_conditions(&self, at: At<'_>) -> Vec<(f64, f64)> {
        let wanted = self.interpreter.program().start_condition_values();
        let mut values = vec![0.0; wanted.len()];
        self.complete(Function::StartConditions, at, true, &mut values);
        values.into_iter().zip(wanted).map(|(value, id)| (value, self.interpreter.constant(id))).collect()
    }

    fn start_condition_speeds(&self) -> Vec<(u32, u32)> {
        self.interpreter.program().start_condition_speeds()
    }

    fn restitutions(&self) -> Vec<f64> {
        let program = self.interpreter.program();
        program.restitutions().into_iter().map(|id| self.interpreter.constant(id)).collect()
    }

    fn frequencies(&self) -> Option<Vec<f64>> {
        let found = self.interpreter.program().frequencies.as_ref()?;
        let replaced = self.signals.iter().any(Option::is_some);
        (!replaced).then(|| found.iter().map(|id| self.interpreter.constant(*id)).collect())
    }

    fn mass_matrix(&self, at: At<'_>, values: &mut [f64]) {
        if !self.is_unformed() {
            return self.evaluate(Function::Mass, at, values);
        }
        // The lower triangle, row by row.
        self.columns(at, Symbol::Acceleration, |column, rows| {
            rows.enumerate().skip(column).for_each(|(row, m)| values[row * (row + 1) / 2 + column] = m);
        });
    }

    fn inertias(&self, at: At<'_>, room: &mut Vec<f64>, diagonal: &mut [f64]) {
        if !self.is_unformed() {
            let pattern = &self.description.mass_pattern;
            room.resize(pattern.len(), 0.0);
            self.mass_matrix(at, room);
            return put_diagonal(pattern, room, diagonal);
        }
        let u = self.input_values(at.t);
        self.interpreter.pivots(with_inputs(at, &u), |coordinate, _, size| diagonal[coordinate] = size);
    }

    fn bias(&self, at: At<'_>, h: &mut [f64]) {
        if self.is_unformed() {
            self.evaluate(Function::Residual, at.accelerated(&vec![0.0; h.len()]), h);
        } else {
            self.evaluate(Function::Bias, at, h);
        }
        self.phased.disturb(self, at, h);
    }

    fn residual(&self, at: At<'_>, f: &mut [f64]) {
        if !self.sliding.is_empty() {
            return sliding::resolved(self, at).residual(at, f);
        }
        self.evaluate(Function::Residual, at, f);
        self.phased.disturb(self, at, f);
    }

    fn jacobians(&self, at: At<'_>, dq: &mut [f64], dv: &mut [f64]) {
        if !self.is_unformed() {
            self.evaluate(Function::Stiffness, at, dq);
            return self.evaluate(Function::Damping, at, dv);
        }
        let n = self.description.coordinates.len();
        for (symbols, slopes) in [(Symbol::Coordinate as fn(u32) -> Symbol, dq), (Symbol::Speed, dv)] {
            self.columns(at, symbols, |column, rows| {
                rows.enumerate().for_each(|(row, slope)| slopes[row * n + column] = slope);
            });
        }
    }

    fn input_jacobian(&self, at: At<'_>, du: &mut [f64]) {
        self.evaluate(Function::Input, at, du);
    }

    fn time_jacobian(&self, at: At<'_>, dt: &mut [f64]) {
        self.evaluate(Function::Time, at, dt);
    }

    fn time_dependence(&self, at: At<'_>, dt: &mut [f64]) {
        self.evaluate(Function::TimeDependence, at, dt);
    }

    fn magnitudes(&self, at: At<'_>, sums: &mut [f64]) {
        self.evaluate(Function::Magnitudes, at, sums);
    }

    fn force_errors(&self, at: At<'_>, errors: &mut [f64]) {
        let (u, still) = (self.input_values(at.t), vec![0.0; errors.len()]);
        let at = At::new(at.t, at.q, at.v).accelerated(&still);
        slopes::errors(&self.interpreter, Function::Residual, with_inputs(at, &u), errors);
    }

    fn energy(&self, at: At<'_>) -> Energy {
        if !self.sliding.is_empty() {
            return sliding::resolved(self, at).energy(at);
        }
        let mut values = [0.0; 5];
        self.complete(Function::Energy, at, !self.description.structure.conservative, &mut values);
        sprung(self, at, Energy::from_array(values))
    }

    fn invariants(&self, at: At<'_>, pairs: &mut [f64]) {
        self.evaluate(Function::Invariants, at, pairs);
    }

    fn outputs(&self, at: At<'_>, values: &mut [f64]) {
        if !self.sliding.is_empty() {
            return sliding::outputs(self, at, values);
        }
        self.complete(Function::Outputs, at, self.description.outputs_use_accelerations, values);
        let Some(system) = self.derivation else { return };
        let pairs = &self.description.balances[system].outputs;
        if let Some(Ok(unknowns)) = self.unknowns(at).filter(|_| !pairs.is_empty()) {
            put_reactions(pairs, &unknowns, values);
        }
    }

    fn output_slopes(&self, at: At<'_>, columns: &mut [f64]) -> bool {
        let u = self.input_values(at.t);
        slopes::output_slopes(&self.interpreter, with_inputs(at, &u), self.description.output_len(), columns);
        true
    }

    fn slopes(&self, function: super::Function, at: At<'_>, along: &Along<'_>, values: &mut [f64]) -> bool {
        slopes::slopes(&self.interpreter, &self.signals, (at, along), function, values);
        true
    }

    fn output_errors(&self, at: At<'_>, errors: &mut [f64]) {
        let u = self.input_values(at.t);
        slopes::errors(&self.interpreter, Function::Outputs, with_inputs(at, &u), errors);
    }

    fn events(&self, at: At<'_>, pairs: &mut [f64]) {
        if !self.sliding.is_empty() {
            return sliding::resolved(self, at).events(at, pairs);
        }
        self.complete(Function::Events, at, self.description.events_use_accelerations, pairs);
    }

    fn event_rates(&self, at: At<'_>, rates: &mut [f64]) {
        self.evaluate(Function::EventRates, at, rates);
    }

    fn arguments(&self, at: At<'_>, pairs: &mut [f64]) {
        self.evaluate(Function::Arguments, at, pairs);
    }

    fn switches(&self, at: At<'_>, pairs: &mut [f64]) {
        self.evaluate(Function::Switches, at, pairs);
    }

    fn modes(&self) -> &[f64] {
        &self.interpreter.modes
    }

    fn set_modes(&mut self, modes: &[f64]) {
        self.interpreter.modes.copy_from_slice(modes);
        self.sliding = sliding::places(modes);
    }

    fn series(&self) -> Result<&Series, NoSeries> {
        if self.signals.iter().any(Option::is_some) {
            return Err(NoSeries::Inputs);
        }
        self.own_series().map(|own| &own.series).ok_or(NoSeries::Functions)
    }

    fn series_constants(&self, values: &mut [f64]) {
        if let Some(own) = self.own_series() {
            // Those that stand in constants are the same at all times.
            own.constants(&self.interpreter, &self.input_values(0.0), values);
        }
    }

    fn drawing(&self, at: At<'_>, values: &mut [f64]) {
        self.evaluate(Function::Drawing, at, values);
    }

    fn parameters(&self) -> Vec<f64> {
        self.interpreter.parameters.clone()
    }

    fn set_parameter(&mut self, index: usize, value: f64) {
        if let Some(parameter) = self.interpreter.parameters.get_mut(index) {
            *parameter = value;
        }
    }

    fn inputs(&self, t: f64, values: &mut [f64]) {
        values.copy_from_slice(&self.input_values(t));
    }

    fn scene_parameters(&self, scene: usize) -> Vec<(usize, f64)> {
        let mut scenes = self.interpreter.program().model.all_scenes();
        scenes
            .nth(scene)
            .map_or_else(Vec::new, |s| s.set.iter().map(|(i, id)| (*i, self.interpreter.constant(*id))).collect())
    }

    fn scene(&self, scene: usize) -> Scene {
        let scenes: Vec<_> = self.interpreter.program().model.all_scenes().collect();
        let searched =
            !self.description.rows.is_empty() || scenes.iter().any(|scene| !scene.start_conditions.is_empty());
        let index = if scene < scenes.len() { scene } else { 0 };
        let first: usize = scenes[..index].iter().map(|scene| scene.start_conditions.len()).sum();
        let scene = scenes[index];
        let value = |id| self.interpreter.constant(id);
        Scene {
            q: scene.q.iter().map(|id| value(*id)).collect(),
            v: scene.v.iter().map(|id| value(*id)).collect(),
            until: value(scene.until),
            tolerance: value(scene.tolerance),
            every: scene.every.map(value),
            held_q: if searched { scene.held_q.clone() } else { Vec::new() },
            held_v: if searched { scene.held_v.clone() } else { Vec::new() },
            spins: scene.spins.iter().map(|spin| Spin { first: spin.first, own: spin.own }).collect(),
            guessed: scene.guessed,
            phase: scene.phase,
            start_conditions: first..first + scene.start_conditions.len(),
        }
    }

    fn equilibrium_guess(&self) -> Option<Vec<f64>> {
        let guess = self.interpreter.program().model.equilibrium.as_ref()?;
        Some(guess.iter().map(|id| self.interpreter.constant(*id)).collect())
    }

    fn balances(&self, system: usize, at: At<'_>, matrix: &mut [f64], right: &mut [f64]) {
        let u = self.input_values(at.t);
        self.interpreter.balances(system, with_inputs(at, &u), matrix, right);
    }

    fn set_derivation(&mut self, system: Option<usize>) {
        if system.is_none_or(|system| system < self.description.balances.len()) {
            self.derivation = system;
        }
    }
}

fn with_inputs<'a>(at: At<'a>, u: &'a [f64]) -> interpret::At<'a> {
    interpret::At { t: at.t, u, q: at.q, v: at.v, a: at.a, l: at.lambda }
}
