//! Evaluating a program without compiling it: several times slower than the generated code, and tested against it.

use std::cell::RefCell;
use std::sync::Arc;

use crate::expr::{Id, Scalar, Symbol, Tape};
use crate::lower::{Accelerations, Entry, Part, Program};

thread_local! {
    /// What evaluations write their values to.
    static SCRATCH: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

/// A program with values for its parameters, inputs and modes; copies share the program.
#[derive(Clone, Debug)]
pub struct Interpreter {
    program: Arc<Program>,
    /// Free parameters.
    pub parameters: Vec<f64>,
    /// Modes of the switches.
    pub modes: Vec<f64>,
    /// 1 for the phase in force, 0 for all others.
    pub phases: Vec<f64>,
    /// Held values.
    pub memory: Vec<f64>,
    tapes: Arc<Tapes>,
}

/// The functions that can be evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "named after the methods of `System`")]
pub enum Function {
    Mass,
    Bias,
    Residual,
    Stiffness,
    Damping,
    Input,
    Time,
    TimeDependence,
    Magnitudes,
    Energy,
    Invariants,
    Outputs,
    Events,
    Assignments,
    Switches,
    Drawing,
    EventRates,
    Arguments,
    Constraints,
    ConstraintMatrix,
    ConstraintBias,
    Friction,
    ConstraintStiffness,
    ConstraintDamping,
    ConstraintRateJacobian,
    HeldRates,
    StartConditions,
    Inputs,
}

const FUNCTIONS: usize = Function::Inputs as usize + 1;

#[derive(Clone, Debug)]
struct Tapes {
    functions: Vec<Tape>,
    accelerations: Solved,
    /// Accelerations, multipliers and what tells whether they are good, where that was eliminated: the lists of [`ConstrainedMotion`](crate::lower::ConstrainedMotion) one after the other.
    eliminated: Option<Tape>,
    /// The accelerations and the energies of each part.
    parts: Vec<(Solved, Tape)>,
    /// A's non-zeros, then b, of each system of balances.
    balances: Vec<Tape>,
}

/// Accelerations of some coordinates, then a pivot of M and what it must not be negligible against, for each of these.
#[derive(Clone, Debug)]
struct Solved {
    tape: Tape,
    coordinates: Vec<usize>,
    pivots: Vec<usize>,
}

/// A state, in the order of the model's coordinates; slices may be empty where nothing reads them.
#[derive(Clone, Copy, Debug, Default)]
pub struct At<'a> {
    /// Time.
    pub t: f64,
    /// Inputs: u, u', u'' of each.
    pub u: &'a [f64],
    /// Coordinates.
    pub q: &'a [f64],
    /// Speeds.
    pub v: &'a [f64],
    /// Accelerations.
    pub a: &'a [f64],
    /// Multipliers of the constraints' rows.
    pub l: &'a [f64],
}

impl Interpreter {
    /// With the file's parameters.
    pub fn new(program: Program) -> Interpreter {
        let graph = &program.model.graph;
        let entries = |list: &[Entry]| list.iter().map(|e| e.2).collect::<Vec<Id>>();
        let mut functions = vec![Tape::new(graph, &[]); FUNCTIONS];
        let mut set = |function: Function, roots: &[Id]| functions[function as usize] = Tape::new(graph, roots);
        set(Function::Mass, &entries(&program.mass));
        set(Function::Bias, &program.bias);
        set(Function::Residual, &program.residual);
        set(Function::Stiffness, &entries(&program.stiffness));
        set(Function::Damping, &entries(&program.damping));
        set(Function::Input, &entries(&program.input));
        set(Function::Time, &entries(&program.time));
        set(Function::TimeDependence, &program.generic_time);
        set(Function::Magnitudes, &program.magnitudes);
        set(Function::Energy, &program.energy);
        set(Function::Invariants, &program.invariants);
        set(Function::Outputs, &program.outputs);
        set(Function::Events, &program.events);
        set(Function::Assignments, &program.assignments);
        set(Function::Switches, &program.switch_pairs);
        set(Function::Drawing, &program.drawing);
        let constraints = &program.constraints;
        set(Function::Constraints, &constraints.values);
        set(Function::ConstraintMatrix, &entries(&constraints.matrix));
        set(Function::ConstraintBias, &constraints.bias);
        set(Function::Friction, &entries(&constraints.friction));
        set(Function::ConstraintStiffness, &entries(&constraints.stiffness));
        set(Function::ConstraintDamping, &entries(&constraints.damping));
        set(Function::ConstraintRateJacobian, &entries(&constraints.rate_jacobian));
        set(Function::HeldRates, &constraints.held_rates);
        set(Function::StartConditions, &program.start_conditions());
        let rates: Vec<Id> = program.event_rates.iter().map(|rate| rate.value()).collect();
        set(Function::EventRates, &rates);
        let pairs: Vec<Id> = program.arguments.iter().flat_map(|a| [a.value, a.rate]).collect();
        set(Function::Arguments, &pairs);
        let signals: Vec<Id> = program.signals.iter().flatten().copied().collect();
        set(Function::Inputs, &signals);
        let all: Vec<usize> = (0..program.model.coordinates.len()).collect();
        let accelerations = Solved::of(&program, &all);
        let part = |part: &Part| (Solved::of(&program, &part.coordinates), Tape::new(graph, &part.energy));
        let parts = program.parts.iter().map(part).collect();
        let balances = program.momentum.iter().map(|s| Tape::new(graph, &[&entries(&s.matrix)[..], &s.right].concat()));
        let eliminated = constraints.eliminated.as_ref().map(|found| Tape::new(graph, &found.lists().concat()));
        let tapes = Tapes { functions, accelerations, eliminated, parts, balances: balances.collect() };
        let parameters = program.model.parameters.iter().map(|p| p.default).collect();
        let modes = vec![1.0; program.switches.len()];
        let phases = (0..program.model.phases.len()).map(|k| if k == 0 { 1.0 } else { 0.0 }).collect();
        let memory = vec![0.0; program.model.memory.len()];
        let starts: Vec<Id> = program.model.memory.iter().map(|held| held.start).collect();
        let (program, tapes) = (Arc::new(program), Arc::new(tapes));
        let mut interpreter = Interpreter { program, parameters, modes, phases, memory, tapes };
        interpreter.memory = starts.into_iter().map(|id| interpreter.constant(id)).collect();
        interpreter
    }

    /// The program.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// How many values the accelerations are computed from and with: constants, symbols and operations.
    pub fn operations(&self) -> usize {
        self.tapes.accelerations.tape.operations()
    }

    /// Evaluates one function into a slice of its length.
    pub fn evaluate(&self, function: Function, at: At<'_>, values: &mut [f64]) {
        self.run(&self.tapes.functions[function as usize], at, values);
    }

    /// Evaluates one function in another kind of number, every symbol having the value that it is given; parameters,
    /// modes and phases are in [`Interpreter::value`].
    pub fn evaluate_in<S: Scalar>(&self, function: Function, value: impl Fn(Symbol) -> S, values: &mut [S]) {
        self.tapes.functions[function as usize].run(value, &mut Vec::new(), values);
    }

    /// The accelerations; `Err` names the coordinate whose pivot vanishes.
    ///
    /// # Errors
    /// The place of a coordinate without a pivot.
    pub fn accelerations(&self, at: At<'_>, a: &mut [f64]) -> Result<(), usize> {
        if matches!(self.program.accelerations, Accelerations::Loop) {
            return self.solve(at, a);
        }
        self.solved(&self.tapes.accelerations, at, a)
    }

    /// The lists of [`ConstrainedMotion`](crate::lower::ConstrainedMotion), each into one of these; false where there are none.
    pub fn eliminated<'a>(&self, at: At<'_>, lists: impl IntoIterator<Item = &'a mut [f64]>) -> bool {
        let Some(tape) = &self.tapes.eliminated else { return false };
        SCRATCH.with_borrow_mut(|scratch| {
            tape.fill(|symbol| self.value(symbol, at), scratch);
            let values = lists.into_iter().flatten().enumerate();
            values.for_each(|(k, value)| *value = tape.result(scratch, k));
        });
        true
    }

    /// The accelerations of the coordinates of one of [`Program::parts`].
    ///
    /// # Errors
    /// The place of a coordinate without a pivot.
    pub fn part_accelerations(&self, part: usize, at: At<'_>, a: &mut [f64]) -> Result<(), usize> {
        self.tapes.parts.get(part).map_or(Ok(()), |(accelerations, _)| self.solved(accelerations, at, a))
    }

    /// The energies of one of [`Program::parts`].
    pub fn part_energy(&self, part: usize, at: At<'_>) -> [f64; 5] {
        let mut energy = [0.0; 5];
        if let Some((_, tape)) = self.tapes.parts.get(part) {
            self.run(tape, at, &mut energy);
        }
        energy
    }

    fn solved(&self, solved: &Solved, at: At<'_>, a: &mut [f64]) -> Result<(), usize> {
        let Solved { tape, coordinates, pivots } = solved;
        SCRATCH.with_borrow_mut(|scratch| {
            tape.fill(|symbol| self.value(symbol, at), scratch);
            for (k, coordinate) in pivots.iter().enumerate() {
                let [pivot, size] = [0, 1].map(|part| tape.result(scratch, coordinates.len() + 2 * k + part));
                if pivot.is_nan() || pivot.abs() <= 4.0 * f64::EPSILON * size.abs() {
                    return Err(*coordinate);
                }
            }
            coordinates.iter().enumerate().for_each(|(k, i)| a[*i] = tape.result(scratch, k));
            Ok(())
        })
    }

    /// The accelerations in another kind of number, and what tests them: pairs of a pivot and what it must not be negligible
    /// against; nothing where they are not written out.
    pub fn accelerations_in<S: Scalar>(&self, value: impl Fn(Symbol) -> S) -> (Vec<S>, Vec<[S; 2]>) {
        let Solved { tape, coordinates, .. } = &self.tapes.accelerations;
        let mut values = tape.evaluate(value);
        let tests = values.split_off(coordinates.len()).chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        (values, tests)
    }

    /// Calls `put` with each coordinate, its pivot and what that must not be negligible against, in the order of elimination.
    pub fn pivots(&self, at: At<'_>, mut put: impl FnMut(usize, f64, f64)) {
        let (_, tests) = self.accelerations_in(|symbol| self.value(symbol, at));
        let coordinates = &self.tapes.accelerations.pivots;
        coordinates.iter().zip(tests).for_each(|(coordinate, [pivot, size])| put(*coordinate, pivot, size));
    }

    /// A (row by row) and b of a system of balances.
    pub fn balances(&self, system: usize, at: At<'_>, matrix: &mut [f64], right: &mut [f64]) {
        let Some((form, tape)) = self.program.momentum.get(system).zip(self.tapes.balances.get(system)) else { return };
        let mut values = vec![0.0; tape.len()];
        self.run(tape, at, &mut values);
        matrix.fill(0.0);
        let (entries, rest) = values.split_at(form.matrix.len());
        for ((i, j, _), value) in form.matrix.iter().zip(entries) {
            matrix[i * form.right.len() + j] = *value;
        }
        right.copy_from_slice(rest);
    }

    /// Evaluates an expression of parameters.
    pub fn constant(&self, id: Id) -> f64 {
        let mut value = [0.0];
        self.run(&Tape::new(&self.program.model.graph, &[id]), At::default(), &mut value);
        value[0]
    }

    fn solve(&self, at: At<'_>, a: &mut [f64]) -> Result<(), usize> {
        let n = a.len();
        let mut values = vec![0.0; self.program.mass.len()];
        self.evaluate(Function::Mass, at, &mut values);
        let mut m = vec![0.0; n * n];
        for ((i, j, _), value) in self.program.mass.iter().zip(values) {
            m[i * n + j] = value;
            m[j * n + i] = value;
        }
        let mut f = vec![0.0; n];
        self.evaluate(Function::Bias, at, &mut f);
        f.iter_mut().for_each(|h| *h = -*h);
        a.copy_from_slice(&solve(m, f)?);
        Ok(())
    }

    fn run(&self, tape: &Tape, at: At<'_>, values: &mut [f64]) {
        SCRATCH.with_borrow_mut(|scratch| tape.run(|symbol| self.value(symbol, at), scratch, values));
    }

    /// What a symbol stands for at a state.
    pub fn value(&self, symbol: Symbol, at: At<'_>) -> f64 {
        let get = |list: &[f64], i: u32| list.get(i as usize).copied().unwrap_or(0.0);
        match symbol {
            Symbol::Time => at.t,
            Symbol::Coordinate(i) => get(at.q, i),
            Symbol::Speed(i) => get(at.v, i),
            Symbol::Acceleration(i) => get(at.a, i),
            Symbol::Input(k, order) => get(at.u, 3 * k + u32::from(order)),
            Symbol::Parameter(i) => get(&self.parameters, i),
            Symbol::Memory(j) => get(&self.memory, j),
            Symbol::Mode(k) => get(&self.modes, k),
            Symbol::Multiplier(k) => get(at.l, k),
            Symbol::Phase(k) => get(&self.phases, k),
            Symbol::Reaction(_) | Symbol::Dummy(_) | Symbol::State(_) | Symbol::StateRate(_) => f64::NAN,
        }
    }
}

impl Solved {
    /// Nothing where accelerations are not written out.
    fn of(program: &Program, coordinates: &[usize]) -> Solved {
        let (roots, pivots) = match &program.accelerations {
            Accelerations::Unrolled { values, pivots } => {
                let pivots = pivots.iter().filter(|pivot| coordinates.contains(&pivot.0));
                let tested = pivots.clone().flat_map(|pivot| [pivot.1, pivot.2]);
                let roots: Vec<Id> = coordinates.iter().map(|i| values[*i]).chain(tested).collect();
                (roots, pivots.map(|pivot| pivot.0).collect())
            }
            Accelerations::Loop => (Vec::new(), Vec::new()),
        };
        Solved { tape: Tape::new(&program.model.graph, &roots), coordinates: coordinates.to_vec(), pivots }
    }
}

/// Gaussian elimination on the diagonal of a symmetric matrix; the place of a pivot that vanishes to rounding.
fn solve(mut m: Vec<f64>, mut f: Vec<f64>) -> Result<Vec<f64>, usize> {
    let n = f.len();
    let diagonal: Vec<f64> = (0..n).map(|i| m[i * n + i].abs()).collect();
    for k in 0..n {
        let pivot = m[k * n + k];
        if pivot.abs() <= 1e-13 * diagonal[k] || !pivot.is_finite() {
            return Err(k);
        }
        for i in k + 1..n {
            let factor = m[i * n + k] / pivot;
            if factor != 0.0 {
                for j in k..n {
                    m[i * n + j] -= factor * m[k * n + j];
                }
                f[i] -= factor * f[k];
            }
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| m[k * n + j] * f[j]).sum();
        f[k] = (f[k] - known) / m[k * n + k];
    }
    Ok(f)
}
