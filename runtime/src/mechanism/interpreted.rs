//! A model file that nobody compiled, as a [`System`].

use dalembert_symbolic::derive::SwitchKind as SymbolicSwitchKind;
use dalembert_symbolic::interpret::{self, Function, Interpreter};
use dalembert_symbolic::lower::{self, Entry, MomentumSystem, Program, Rate};
use dalembert_symbolic::model::{EventAction, Shape as SymbolicShape};
use dalembert_symbolic::print;

use super::balances::{belongs, put_reactions};
use super::phased::{Phased, RowHistory, indicate, sprung};
use super::{
    Action, Argument, At, Balance, BalanceSystem, Balances, Coordinate, Counts, Description, Direction, Energy,
    Enforcement, Event, InputJump, List, Parameter, Phase, Quantity, Rated, Role, Row, Scene, Shape, Signal, Singular,
    SingularMass, Structure, Switch, SwitchKind, System, Table, Text, Watched,
};

/// An interpreted mechanism.
#[derive(Clone)]
pub struct Interpreted {
    interpreter: Interpreter,
    description: Description,
    signals: Vec<Option<Signal>>,
    derivation: Option<usize>,
    phased: Phased,
}

impl Interpreted {
    /// From a program and the text of its model file.
    pub fn new(program: Program, source: &str) -> Self {
        let description = describe(&program, source);
        let signals = vec![None; program.model.inputs.len()];
        Interpreted {
            interpreter: Interpreter::new(program),
            description,
            signals,
            derivation: None,
            phased: Phased::default(),
        }
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
        if self.motion(at, &mut a, &mut lambda).is_err() {
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

    fn input_values(&self, t: f64) -> Vec<f64> {
        let mut u = vec![0.0; 3 * self.signals.len()];
        self.interpreter.evaluate(Function::Inputs, interpret::At { t, ..interpret::At::default() }, &mut u);
        for (signal, slot) in self.signals.iter().zip(u.chunks_exact_mut(3)) {
            if let Some(signal) = signal {
                slot.copy_from_slice(&signal(t));
            }
        }
        u
    }
}

impl System for Interpreted {
    fn description(&self) -> &Description {
        &self.description
    }

    fn accelerations(&self, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        if let Some(unknowns) = self.unknowns(at) {
            a.copy_from_slice(&unknowns?[..a.len()]);
            return Ok(());
        }
        if !self.active_rows().is_empty() {
            let mut lambda = vec![0.0; self.description.rows.len()];
            return self.phased.motion(self, at, a, &mut lambda);
        }
        let u = self.input_values(at.t);
        self.interpreter.accelerations(with_inputs(at, &u), a).map_err(|coordinate| SingularMass { coordinate }.into())
    }

    fn motion(&self, at: At<'_>, a: &mut [f64], lambda: &mut [f64]) -> Result<(), Singular> {
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

    fn constraint_tilt(&self, at: At<'_>, values: &mut [f64]) {
        self.evaluate(Function::ConstraintTilt, at, values);
    }

    fn held_rates(&self, at: At<'_>, values: &mut [f64]) {
        self.evaluate(Function::HeldRates, at, values);
    }

    fn phase(&self) -> usize {
        self.phased.phase
    }

    fn set_phase(&mut self, phase: usize) {
        if phase < self.description.phases.len() {
            self.phased.phase = phase;
            indicate(&mut self.interpreter.phases, phase);
        }
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

    fn also(&self, at: At<'_>) -> Vec<(f64, f64)> {
        let wanted = self.interpreter.program().also_values();
        let mut values = vec![0.0; wanted.len()];
        self.complete(Function::Also, at, true, &mut values);
        values.into_iter().zip(wanted).map(|(value, id)| (value, self.interpreter.constant(id))).collect()
    }

    fn restitutions(&self) -> Vec<f64> {
        let program = self.interpreter.program();
        program.restitutions().into_iter().map(|id| self.interpreter.constant(id)).collect()
    }

    fn mass_matrix(&self, at: At<'_>, values: &mut [f64]) {
        self.evaluate(Function::Mass, at, values);
    }

    fn bias(&self, at: At<'_>, h: &mut [f64]) {
        self.evaluate(Function::Bias, at, h);
    }

    fn residual(&self, at: At<'_>, f: &mut [f64]) {
        self.evaluate(Function::Residual, at, f);
    }

    fn jacobians(&self, at: At<'_>, dq: &mut [f64], dv: &mut [f64]) {
        self.evaluate(Function::Stiffness, at, dq);
        self.evaluate(Function::Damping, at, dv);
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

    fn energy(&self, at: At<'_>) -> Energy {
        let mut values = [0.0; 5];
        self.complete(Function::Energy, at, !self.description.structure.conservative, &mut values);
        sprung(self, at, Energy::from_array(values))
    }

    fn invariants(&self, at: At<'_>, pairs: &mut [f64]) {
        self.evaluate(Function::Invariants, at, pairs);
    }

    fn outputs(&self, at: At<'_>, values: &mut [f64]) {
        self.complete(Function::Outputs, at, self.description.outputs_use_accelerations, values);
        let Some(system) = self.derivation else { return };
        let pairs = &self.description.balances[system].outputs;
        if let Some(Ok(unknowns)) = self.unknowns(at).filter(|_| !pairs.is_empty()) {
            put_reactions(pairs, &unknowns, values);
        }
    }

    fn events(&self, at: At<'_>, pairs: &mut [f64]) {
        self.complete(Function::Events, at, self.description.events_use_accelerations, pairs);
    }

    fn event_rates(&self, at: At<'_>, rates: &mut [f64]) {
        self.evaluate(Function::EventRates, at, rates);
    }

    fn arguments(&self, at: At<'_>, pairs: &mut [f64]) {
        self.evaluate(Function::Arguments, at, pairs);
    }

    fn signal(&self, index: usize) -> Option<&Signal> {
        self.signals.get(index)?.as_ref()
    }

    fn switches(&self, at: At<'_>, pairs: &mut [f64]) {
        self.evaluate(Function::Switches, at, pairs);
    }

    fn modes(&self) -> &[f64] {
        &self.interpreter.modes
    }

    fn set_modes(&mut self, modes: &[f64]) {
        self.interpreter.modes.copy_from_slice(modes);
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

    fn set_input(&mut self, index: usize, signal: Signal) {
        if let Some(slot) = self.signals.get_mut(index) {
            *slot = Some(signal);
        }
    }

    fn scene_parameters(&self, scene: usize) -> Vec<(usize, f64)> {
        let scenes = &self.interpreter.program().model.scenes;
        scenes
            .get(scene)
            .map_or_else(Vec::new, |s| s.set.iter().map(|(i, id)| (*i, self.interpreter.constant(*id))).collect())
    }

    fn scene(&self, scene: usize) -> Scene {
        let scenes = &self.interpreter.program().model.scenes;
        let searched = !self.description.rows.is_empty() || scenes.iter().any(|scene| !scene.also.is_empty());
        let first: usize = scenes.iter().take(scene).map(|scene| scene.also.len()).sum();
        let scene = &scenes[if scene < scenes.len() { scene } else { 0 }];
        let value = |id| self.interpreter.constant(id);
        Scene {
            q: scene.q.iter().map(|id| value(*id)).collect(),
            v: scene.v.iter().map(|id| value(*id)).collect(),
            until: value(scene.until),
            tolerance: value(scene.tolerance),
            every: scene.every.map(value),
            held_q: if searched { scene.held_q.clone() } else { Vec::new() },
            held_v: if searched { scene.held_v.clone() } else { Vec::new() },
            guessed: scene.guessed,
            phase: scene.phase,
            also: first..first + scene.also.len(),
        }
    }

    fn equilibrium_guess(&self) -> Vec<f64> {
        let guess = &self.interpreter.program().model.equilibrium;
        guess.iter().map(|id| self.interpreter.constant(*id)).collect()
    }

    fn balances(&self, system: usize, at: At<'_>, matrix: &mut [f64], right: &mut [f64]) {
        let u = self.input_values(at.t);
        self.interpreter.balances(system, with_inputs(at, &u), matrix, right);
    }

    fn derivation(&self) -> Option<usize> {
        self.derivation
    }

    fn set_derivation(&mut self, system: Option<usize>) {
        if system.is_none_or(|system| system < self.description.balances.len()) {
            self.derivation = system;
        }
    }

    fn boxed_clone(&self) -> Box<dyn System> {
        Box::new(self.clone())
    }
}

fn with_inputs<'a>(at: At<'a>, u: &'a [f64]) -> interpret::At<'a> {
    interpret::At { t: at.t, u, q: at.q, v: at.v, a: at.a, l: at.lambda }
}

/// The description that generated code would have.
fn describe(program: &Program, source: &str) -> Description {
    let model = &program.model;
    let text = |s: &str| Text::Owned(s.to_owned());
    let unit = |u: &Option<String>| Text::Owned(u.as_deref().map(print::si_unit).unwrap_or_default());
    let pattern = |entries: &[Entry]| entries.iter().map(|e| (e.0 as u32, e.1 as u32)).collect::<List<(u32, u32)>>();
    let quantity =
        |name: &str, n: usize, of: &Option<String>| Quantity { name: text(name), components: n as u32, unit: unit(of) };
    let s = &program.structure;
    let c = program.counts;
    let mut impacts = 0;
    Description {
        name: text(&model.name),
        about: text(&model.about),
        source_hash: print::fnv1a(source),
        coordinates: model
            .coordinates
            .iter()
            .map(|c| Coordinate { name: text(&c.name), unit: unit(&c.unit) })
            .collect(),
        parameters: model
            .parameters
            .iter()
            .map(|p| Parameter { name: text(&p.name), unit: unit(&p.unit), default: p.default })
            .collect(),
        tables: program.tables().into_iter().map(table).collect(),
        derived: model.derived.iter().map(|d| text(&d.name)).collect(),
        inputs: model.inputs.iter().map(|u| text(&u.name)).collect(),
        mass_pattern: pattern(&program.mass),
        stiffness_pattern: pattern(&program.stiffness),
        damping_pattern: pattern(&program.damping),
        input_pattern: pattern(&program.input),
        time_pattern: program.time.iter().map(|e| e.0 as u32).collect(),
        timed_switches: program.timed_switches.iter().map(|k| *k as u32).collect(),
        rows: model
            .constraints
            .iter()
            .enumerate()
            .flat_map(|(k, c)| {
                let constraints = &program.constraints;
                let row = move |(name, row): (String, usize)| Row {
                    name: Text::Owned(name),
                    unit: unit(&c.unit),
                    holonomic: c.holonomic,
                    integral: constraints.integral[row],
                    with: constraints.with[row].iter().map(|(row, factor)| (*row as u32, *factor)).collect(),
                    constraint: k as u32,
                };
                c.row_names().into_iter().zip(c.first..).map(row)
            })
            .collect(),
        phases: model
            .phases
            .iter()
            .enumerate()
            .map(|(k, phase)| Phase {
                name: text(&phase.name),
                rows: program.model.rows_of(phase).into_iter().map(|row| row as u32).collect(),
                rank: program.rank_of(k) as u32,
            })
            .collect(),
        constraint_pattern: pattern(&program.constraints.matrix),
        friction_pattern: pattern(&program.constraints.friction),
        constraint_stiffness_pattern: pattern(&program.constraints.stiffness),
        constraint_damping_pattern: pattern(&program.constraints.damping),
        constraint_tilt_pattern: pattern(&program.constraints.tilt),
        outputs: model.outputs.iter().map(|o| quantity(&o.name, o.value.len(), &o.unit)).collect(),
        outputs_use_accelerations: program.outputs_use_accelerations(),
        events_use_accelerations: program.events_use_accelerations(),
        invariants: model.conserved.iter().map(|i| quantity(&i.name, i.value.len(), &None)).collect(),
        events: model
            .events
            .iter()
            .zip(&program.event_rates)
            .map(|(e, rate)| Event {
                name: text(&e.name),
                direction: match e.direction {
                    1 => Direction::Rising,
                    -1 => Direction::Falling,
                    _ => Direction::Both,
                },
                conditional: e.condition.is_some(),
                phases: e.phases.as_ref().map(|phases| phases.iter().map(|k| *k as u32).collect()),
                actions: e
                    .actions
                    .iter()
                    .map(|a| match a {
                        EventAction::Stop => Action::Stop,
                        EventAction::Record => Action::Record,
                        EventAction::Phase(phase) => Action::Phase(*phase as u32),
                        EventAction::Impact { along, .. } => {
                            impacts += 1;
                            Action::Impact { along: *along as u32, restitution: impacts - 1 }
                        }
                    })
                    .collect(),
                rated: match rate {
                    Rate::Whole(_) => Rated::Whole,
                    Rate::Held(_) => Rated::Held,
                    Rate::Unknown => Rated::Unknown,
                },
            })
            .collect(),
        switches: program
            .switches
            .iter()
            .map(|s| Switch {
                text: Text::Owned(print::switch_text(program, s)),
                kind: if s.kind == SymbolicSwitchKind::Sign { SwitchKind::Sign } else { SwitchKind::Step },
                time_only: s.time_only,
                of_input: s.of_input,
            })
            .collect(),
        arguments: program.arguments.iter().map(argument).collect(),
        input_jumps: program.jumps.iter().map(input_jump).collect(),
        scenes: model.scenes.iter().map(|s| text(&s.name)).collect(),
        draw: model
            .draw
            .iter()
            .map(|shape| match shape {
                SymbolicShape::Line(points) => Shape::Line(points.len() as u32),
                SymbolicShape::Circle { .. } => Shape::Circle,
                SymbolicShape::Spring(..) => Shape::Spring,
                SymbolicShape::Curve(points) => Shape::Curve(points.len() as u32),
                SymbolicShape::Trace(name, _) => Shape::Trace(text(name)),
            })
            .collect(),
        balances: program.momentum.iter().map(balances).collect(),
        structure: Structure {
            dimension: model.dimension as u32,
            constant_mass: s.constant_mass,
            constant_inertias: s.constant_inertias,
            diagonal_mass: s.diagonal_mass,
            mass_blocks: s.mass_blocks.iter().map(|b| *b as u32).collect(),
            separable: s.separable,
            linear: s.linear,
            conservative: s.conservative,
            time_dependent: s.time_dependent,
            cyclic: s.cyclic.iter().map(|c| c.0 as u32).collect(),
        },
        counts: Counts {
            mass: c.mass as u32,
            bias: c.bias as u32,
            mass_and_bias: c.mass_and_bias as u32,
            accelerations: c.accelerations as u32,
            residual: c.residual as u32,
            jacobians: c.jacobians as u32,
        },
    }
}

fn table(table: dalembert_symbolic::expr::Table) -> Table {
    Table {
        name: Text::Borrowed(table.name()),
        knots: List::Borrowed(table.knots()),
        pieces: List::Borrowed(table.pieces()),
        period: table.period(),
        rise: table.rise(),
    }
}

fn argument(argument: &lower::Argument) -> Argument {
    Argument {
        of: match argument.of {
            lower::Watched::Event(k) => Watched::Event(k as u32),
            lower::Watched::Switch(k) => Watched::Switch(k as u32),
            lower::Watched::Motion => Watched::Motion,
            lower::Watched::Argument(k) => Watched::Argument(k as u32),
        },
        role: match argument.role {
            lower::Role::Phase => Role::Phase,
            lower::Role::Landmark => Role::Landmark,
            lower::Role::Exponential => Role::Exponential,
            lower::Role::Bounded => Role::Bounded,
            lower::Role::Arctangent => Role::Arctangent,
            lower::Role::Points => Role::Points,
            lower::Role::Distance => Role::Distance,
            lower::Role::Power(p) => Role::Power(p),
        },
        time_only: argument.time_only,
        load: Text::Owned(argument.load.clone()),
    }
}

fn input_jump(jump: &lower::InputJump) -> InputJump {
    match jump {
        lower::InputJump::Force => InputJump::Force,
        lower::InputJump::Speed => InputJump::Speed,
        lower::InputJump::Refused => InputJump::Refused,
    }
}

fn balances(system: &MomentumSystem) -> BalanceSystem {
    let text = |s: &String| Text::Owned(s.clone());
    let balance = |(name, void): &(String, bool)| Balance { name: text(name), void_at_rest: *void };
    BalanceSystem {
        name: text(&system.name),
        phases: system.phases.iter().map(|phase| *phase as u32).collect(),
        unknowns: system.unknowns.iter().map(text).collect(),
        equations: system.equations.iter().map(balance).collect(),
        nonzeros: system.matrix.len() as u32,
        operations: system.operations as u32,
        outputs: system.outputs.iter().map(|(output, unknown)| (*output as u32, *unknown as u32)).collect(),
    }
}
