//! Equations to programs: the cheapest candidate, its Jacobians, the accelerations, and what a run observes.

mod arguments;
mod candidates;
mod constraints;
mod count;
mod elimination;
mod factor;
mod forms;
mod frequencies;
mod gather;
mod magnitude;
mod momentum;
mod parts;
mod rounding;
mod routh;
mod series;
mod slopes;
mod structure;
mod symmetry;
mod time;
mod zero_factors;

use std::borrow::Cow;
use std::path::Path;

use candidates::Chosen;

use crate::derive::{Derivation, Equations, Switch, held_rates, rates};
use crate::diagnose::Problem;
use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary, jacobian, logarithms_without_overflow, reverse, substitute};
use crate::gate::{Judged, Report};
use crate::model::{Condition, Contact, Files, Model, Scene, Shape, is_observed, is_of_units};

pub use arguments::{Argument, Role, Watched};
pub use constraints::{ConstrainedMotion, Constraints};
pub use count::{Counts, operations};
pub use elimination::{Cost, Elimination};
pub use factor::Accelerations;
pub use momentum::MomentumSystem;
pub use parts::Part;
pub use routh::{Ignored, NotReduced, Reduced, routh};
pub use series::{Place, Recurrence, Series};
pub use slopes::{Slopes, direction_size};
pub use structure::Structure;
pub use symmetry::{Symmetries, Symmetry, generators, symmetries};

/// An entry of a sparse matrix: row, column, value.
pub type Entry = (usize, usize, Id);

/// Everything that code is generated from, or interpreted.
#[derive(Clone, Debug)]
pub struct Program {
    /// The model; all expressions are in its graph.
    pub model: Model,
    /// What was tested when deriving.
    pub report: Report,
    /// How power series follow each other, where that was asked for ([`Program::with_series`]).
    pub series: Option<Series>,
    /// Discontinuities of the equations of motion and of inputs.
    pub switches: Vec<Switch>,
    /// Inputs as functions of time, (u, u', u'') of each, with modes.
    pub signals: Vec<[Id; 3]>,
    /// What a jump of each input does.
    pub jumps: Vec<InputJump>,
    /// Whether M, h, the Jacobians of F, and A and b of balances that name no reactions are not formed, since M is large and
    /// accelerations come without it; [`Program::with_matrices`] forms them.
    pub unformed: bool,
    /// M's lower triangle.
    pub mass: Vec<Entry>,
    /// h; without the forces of multipliers.
    pub bias: Vec<Id>,
    /// Constraints and the forces of their multipliers.
    pub constraints: Constraints,
    /// q'' = −M⁻¹h.
    pub accelerations: Accelerations,
    /// How they are found without M, or why not, where velocities are shared.
    pub elimination: Option<Elimination>,
    /// F = M q'' + h − (Jᵀ + B) λ.
    pub residual: Vec<Id>,
    /// ∂F/∂q.
    pub stiffness: Vec<Entry>,
    /// ∂F/∂q'.
    pub damping: Vec<Entry>,
    /// ∂F/∂(u, u', u''): columns 3·input + order.
    pub input: Vec<Entry>,
    /// ∂F/∂t of the equations that depend on time by themselves; the column is 0.
    pub time: Vec<Entry>,
    /// The same with generic numbers for functions of time that can be as small as none.
    pub generic_time: Vec<Id>,
    /// Switches whose argument depends on time.
    pub timed_switches: Vec<usize>,
    /// Angular frequencies of the dependence on time, of parameters, without signs; `None` where it does not repeat itself.
    pub frequencies: Option<Vec<Id>>,
    /// Σ |terms| of every component of F.
    pub magnitudes: Vec<Id>,
    /// T, V, Jacobi function, its power, Σ |terms|.
    pub energy: [Id; 5],
    /// Pairs (value, Σ |terms|).
    pub invariants: Vec<Id>,
    /// Outputs, component by component.
    pub outputs: Vec<Id>,
    /// Pairs (value, condition).
    pub events: Vec<Id>,
    /// Values of all that events set, set by set.
    pub assignments: Vec<Id>,
    /// Total time derivatives of the events' functions.
    pub event_rates: Vec<Rate>,
    /// Arguments inside events, switches and the equations of motion.
    pub arguments: Vec<Argument>,
    /// Pairs (argument, rate).
    pub switch_pairs: Vec<Id>,
    /// Points and radii to draw.
    pub drawing: Vec<Id>,
    /// Systems of momentum balances, a second way to the accelerations.
    pub momentum: Vec<MomentumSystem>,
    /// What was recognised.
    pub structure: Structure,
    /// Parts of the mechanism that can be computed by themselves.
    pub parts: Vec<Part>,
    /// Operations of the generated functions.
    pub counts: Counts,
    /// Which candidates were chosen, in words.
    pub choice: String,
}

/// What a jump of an input's value does to the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputJump {
    /// Forces jump, the motion goes on: F contains neither u' nor u''.
    Force,
    /// The speeds jump: F contains u', times what does not depend on speeds.
    Speed,
    /// It would need an infinite force, or what it does depends on how it jumps.
    Refused,
}

/// The total time derivative of an event's function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rate {
    /// All of it.
    Whole(Id),
    /// Its part with accelerations and multipliers held.
    Held(Id),
    /// Not known: second derivatives of inputs, or accelerations where there are no constraints.
    Unknown,
}

impl Rate {
    /// What is generated for it.
    pub fn value(self) -> Id {
        match self {
            Rate::Whole(id) | Rate::Held(id) => id,
            Rate::Unknown => Id::ZERO,
        }
    }
}

/// The functions of time that stand for the inputs, and their rates, that expressions read.
pub fn read_signals(graph: &Graph, signals: &[[Id; 3]], roots: impl Iterator<Item = Id>) -> Vec<Id> {
    let signal = |symbol: Symbol| match symbol {
        Symbol::Input(k, order) => signals.get(k as usize)?.get(usize::from(order)).copied(),
        _ => None,
    };
    graph.symbols(roots).into_iter().filter_map(signal).collect()
}

/// Reads, resolves, derives and lowers.
///
/// # Errors
/// Everything that is wrong with the model file.
pub fn compile(text: &str, sizes: &[(String, i64)]) -> Result<Program, Vec<Problem>> {
    compile_in(None, text, sizes)
}

/// As [`compile`], for a file in a folder, where the files of its tables are.
///
/// # Errors
/// Everything that is wrong with the model file, and with them.
pub fn compile_in(folder: Option<&Path>, text: &str, sizes: &[(String, i64)]) -> Result<Program, Vec<Problem>> {
    compile_from(&Files::of_folder(folder), text, sizes)
}

/// As [`compile`], with the files that it names.
///
/// # Errors
/// Everything that is wrong with the model file, and with them.
pub fn compile_from(files: &Files, text: &str, sizes: &[(String, i64)]) -> Result<Program, Vec<Problem>> {
    compile_for_runs_from(files, text, sizes).and_then(Program::with_matrices)
}

/// As [`compile_in`], but what is [`Program::unformed`] stays so.
///
/// # Errors
/// Everything that is wrong with the model file, and with the files of its tables.
pub fn compile_for_runs_in(
    folder: Option<&Path>,
    text: &str,
    sizes: &[(String, i64)],
) -> Result<Program, Vec<Problem>> {
    compile_for_runs_from(&Files::of_folder(folder), text, sizes)
}

/// As [`compile_from`], but what is [`Program::unformed`] stays so.
///
/// # Errors
/// Everything that is wrong with the model file, and with the files that it names.
pub fn compile_for_runs_from(files: &Files, text: &str, sizes: &[(String, i64)]) -> Result<Program, Vec<Problem>> {
    match crate::model::read_through_from(files, text, sizes) {
        (Some(model), problems) if problems.is_empty() => {
            let in_parts = || crate::model::load_in_parts(files, text, sizes);
            lower(crate::gate::judged_and_explained(model, in_parts)?)
        }
        (Some(model), mut problems) => {
            // Mistakes beside the equations hide nothing that the gate finds in these; what it finds in equations that are not as meant,
            // or in a claim that is not, follows from them.
            if problems.iter().all(is_observed) {
                let mut verdicts = crate::gate::judged(model).err().unwrap_or_default();
                let entry = |problem: &Problem| problem.place.path.get(..2).map(<[_]>::to_vec);
                let mistaken: Vec<_> =
                    problems.iter().filter(|problem| !is_of_units(problem)).filter_map(entry).collect();
                verdicts.retain(|verdict| entry(verdict).is_none_or(|entry| !mistaken.contains(&entry)));
                problems.extend(verdicts);
            }
            crate::file::sort(text, &mut problems);
            Err(problems)
        }
        (None, problems) => Err(problems),
    }
}

/// Turns derived equations into a program.
///
/// # Errors
/// The model is too large.
pub fn lower(judged: Judged) -> Result<Program, Vec<Problem>> {
    // Long because each quantity of a program is made once, from those before it: the order of the lines is that of the graph's nodes.
    let Judged { derivation, cyclic, directions, report } = judged;
    let Derivation {
        mut model,
        equations,
        rows,
        momentum,
        named_reactions,
        energies,
        signals,
        switches,
        dynamics,
        eliminated,
        ..
    } = derivation;
    let n = model.coordinates.len();
    let graph = &mut model.graph;

    // With constraints M, J and what multipliers do are solved for together; states of first order are no velocities.
    let free = rows.is_empty() && dynamics.n == n;
    let unformed = eliminated.is_some();
    let found = match &eliminated {
        Some(eliminated) => elimination::Found::without_masses(eliminated),
        None => free.then(|| elimination::Found::of(graph, &dynamics, &equations[0].mass)).flatten(),
    };
    let mut chosen = match unformed {
        true => candidates::without_masses(graph, &equations),
        false => candidates::choose(graph, &equations),
    };
    let constrained = match rows.is_empty() {
        true => None,
        false => elimination::constrained(&mut model, &report, (&dynamics, &rows), (&chosen.mass, &chosen.bias)),
    };
    let graph = &mut model.graph;
    let mut constraints = constraints::lowered(graph, rows, &mut chosen);
    chosen.bias = gather::gather(graph, &chosen.bias);
    chosen.residual = gather::gather(graph, &chosen.residual);
    let mut accelerations = match unformed {
        true => Accelerations::Loop,
        // With constraints the forces of their multipliers are no part of h any more.
        false => by_factors(graph, n, &chosen, if constraints.is_empty() { &equations } else { &[] }),
    };
    let (stiffness, damping) = match unformed {
        true => (Vec::new(), Vec::new()),
        false => gathered_jacobians(graph, n, &chosen.residual),
    };
    let input = by_inputs(graph, &chosen.residual);
    let of_time = time::of_time(graph, &chosen.residual, &switches);
    let mut magnitudes = magnitude::Magnitudes::default();
    let magnitudes = chosen.residual.iter().map(|f| magnitudes.of(graph, *f)).collect();
    let invariants = invariant_pairs(&mut model);
    let arguments: Vec<Id> = switches.iter().map(|s| s.argument).collect();
    let graph = &mut model.graph;
    let switch_rates = rates(graph, &arguments);
    let switch_pairs = arguments.iter().zip(&switch_rates).flat_map(|(a, r)| [*a, *r]).collect();
    let events = model.events.iter().flat_map(|e| [e.when, e.condition.unwrap_or(Id::ONE)]).collect();
    let functions: Vec<Id> = model.events.iter().map(|e| e.when).collect();
    let solved: Vec<Id> = chosen.residual.iter().chain(&constraints.bias).copied().collect();
    let event_rates = event_rates(graph, &functions, &solved, !constraints.is_empty());
    if !event_rates.iter().any(|rate| matches!(rate, Rate::Held(_))) {
        constraints.held_rates.clear();
    }
    let motion: Vec<Id> = chosen.residual.iter().copied().chain(signals.iter().map(|u| u[0])).collect();
    let loads: Vec<(String, Vec<Id>)> =
        model.loads.iter().map(|load| (load.name.clone(), load.expressions())).collect();
    let of_sliding = model.contacts.iter().flat_map(Contact::held).map(|place| place as u32).collect();
    let arguments =
        arguments::arguments(graph, &signals, (&functions, &solved), &arguments, &motion, &loads, of_sliding);
    let jumps = (0..model.inputs.len()).map(|k| input_jump(graph, &chosen.residual, k as u32)).collect();
    let power = graph.add(energies.power, constraints.power);
    let outputs: Vec<Id> = model.outputs.iter().flat_map(|o| o.value.iter().copied()).collect();
    let outputs = logarithms_without_overflow(graph, &outputs);
    let energy = [energies.kinetic, energies.potential, energies.jacobi, power, energies.scale];
    let energy = logarithms_without_overflow(graph, &energy);
    let assignments = model.sets.iter().flat_map(|set| set.values.iter().map(|(_, value)| *value)).collect();
    let drawing = model.draw.iter().flat_map(drawn).collect();

    let by_masses = (chosen.mass.as_slice(), chosen.bias.as_slice());
    let elimination = match (found, constrained) {
        (_, Some((solution, words))) => {
            constraints.eliminated = Some(solution.into());
            Some(words)
        }
        (Some(found), None) if unformed => {
            let (own, taken) = found.take(graph);
            accelerations = own;
            Some(taken)
        }
        (found, None) => found.map(|found| found.choose(graph, by_masses, &mut accelerations)),
    };
    let reads = parts::reads(graph, &chosen.residual, &constraints, &switches, &model.events);
    let parts = parts::parts(n, reads.as_deref());
    let structure = structure::recognise(
        graph,
        n,
        (&chosen, &constraints),
        (&stiffness, &damping),
        (power, energies.jacobi),
        &switches,
        &cyclic,
    );
    let structure = Structure { directions, parts, ..structure.with_states(model.states.len(), n) };
    let structure = match &eliminated {
        Some(eliminated) => structure.without_masses(graph, &eliminated.least.1, &accelerations),
        None => structure,
    };
    let motion = (&chosen, &accelerations);
    let counts = Counts::of(graph, n, motion, (&stiffness, &damping), &signals, unformed);
    let momentum = momentum::systems(&mut model, momentum, &named_reactions);
    let mut program = Program {
        report,
        series: None,
        switches,
        signals,
        jumps,
        unformed,
        mass: chosen.mass,
        bias: chosen.bias,
        constraints,
        accelerations,
        elimination,
        residual: chosen.residual,
        stiffness,
        damping,
        input,
        time: of_time.entries,
        generic_time: of_time.generic,
        timed_switches: of_time.switches,
        frequencies: None,
        magnitudes,
        energy: [0, 1, 2, 3, 4].map(|k| energy[k]),
        invariants,
        outputs,
        events,
        assignments,
        event_rates,
        arguments,
        switch_pairs,
        drawing,
        momentum,
        structure,
        parts: Vec::new(),
        counts,
        choice: chosen.words,
        model,
    };
    program.parts = parts::computed_apart(&mut program);
    program.frequencies = frequencies::frequencies(&mut program);
    if program.model.graph.overflowed() {
        return Err(vec![crate::derive::too_large()]);
    }
    Ok(program)
}

impl Program {
    /// Whether anything of each coordinate is in what is wanted (expressions and coordinates), or in the motion of what is: what the
    /// equations of motion contain, and those of what they contain.  Reactions by momentum balances, and motions whose events
    /// change the phase, depend on all.
    pub fn depends_on(&self, wanted: &[Id], coordinates: &[usize]) -> Vec<bool> {
        let Program { model: Model { graph, events, .. }, residual, constraints, switches, .. } = self;
        let by_balances = |symbol: Symbol| matches!(symbol, Symbol::Reaction(_));
        let balanced = graph.symbols(wanted.iter().copied()).into_iter().any(by_balances);
        match parts::reads(graph, residual, constraints, switches, events).filter(|_| !balanced) {
            None => vec![true; self.model.coordinates.len()],
            Some(reads) => {
                let own = parts::active(graph, wanted, (&parts::rows(graph, constraints), switches));
                parts::closure(&reads, own.into_iter().chain(coordinates.iter().copied()))
            }
        }
    }

    /// With all that was not formed.
    ///
    /// # Errors
    /// It is too large.
    pub fn with_matrices(mut self) -> Result<Program, Vec<Problem>> {
        if !self.unformed {
            return Ok(self);
        }
        let n = self.model.coordinates.len();
        let graph = &mut self.model.graph;
        let column = |s: Symbol| if let Symbol::Acceleration(j) = s { Some(j as usize) } else { None };
        self.mass = crate::derive::mass_entries(graph, &self.residual, column);
        let rest = (0..n).map(|i| (Symbol::Acceleration(i as u32), Id::ZERO)).collect();
        self.bias = substitute(graph, &self.residual, &rest);
        gather_entries(graph, &mut self.mass);
        self.bias = gather::gather(graph, &self.bias);
        (self.stiffness, self.damping) = gathered_jacobians(graph, n, &self.residual);
        let masses: Vec<Id> = self.mass.iter().map(|e| e.2).collect();
        self.counts.mass = operations(graph, &masses);
        self.counts.bias = operations(graph, &self.bias);
        self.counts.mass_and_bias = operations(graph, &[masses, self.bias.clone()].concat());
        self.counts.jacobians = jacobian_operations(graph, &self.residual, &self.stiffness, &self.damping);
        if let Some(elimination) = &mut self.elimination {
            let by_masses = (n, self.mass.as_slice(), self.bias.as_slice());
            elimination.by_masses = Some(elimination::cost_by_masses(graph, by_masses, &Accelerations::Loop));
        }
        momentum::form(&mut self);
        self.unformed = false;
        if self.model.graph.overflowed() {
            return Err(vec![crate::derive::too_large()]);
        }
        Ok(self)
    }

    /// The same with all that was not formed; `None` where that is too large.
    pub fn formed(&self) -> Option<Cow<'_, Program>> {
        match self.unformed {
            true => self.clone().with_matrices().ok().map(Cow::Owned),
            false => Some(Cow::Borrowed(self)),
        }
    }

    /// With the recurrences of its power series, where it has some; in code as statements too, if they are to be `written`.
    pub fn with_series(mut self, written: bool) -> Program {
        self.series = Series::of(&self).map(|series| Series { written, ..series });
        self
    }

    /// A program without coordinates, in the place of one that could not be derived.
    pub fn empty(name: &str) -> Program {
        let scene = Scene { name: "scene".to_owned(), ..Scene::default() };
        Program {
            model: Model { name: name.to_owned(), dimension: 2, scenes: vec![scene], ..Model::default() },
            report: Report::default(),
            series: None,
            switches: Vec::new(),
            signals: Vec::new(),
            jumps: Vec::new(),
            unformed: false,
            mass: Vec::new(),
            bias: Vec::new(),
            constraints: Constraints::default(),
            accelerations: Accelerations::Unrolled { values: Vec::new(), pivots: Vec::new() },
            elimination: None,
            residual: Vec::new(),
            stiffness: Vec::new(),
            damping: Vec::new(),
            input: Vec::new(),
            time: Vec::new(),
            generic_time: Vec::new(),
            timed_switches: Vec::new(),
            frequencies: Some(Vec::new()),
            magnitudes: Vec::new(),
            energy: [Id::ZERO; 5],
            invariants: Vec::new(),
            outputs: Vec::new(),
            events: Vec::new(),
            assignments: Vec::new(),
            event_rates: Vec::new(),
            arguments: Vec::new(),
            switch_pairs: Vec::new(),
            drawing: Vec::new(),
            momentum: Vec::new(),
            structure: Structure::default(),
            parts: Vec::new(),
            counts: Counts::default(),
            choice: String::new(),
        }
    }
}

/// q'' = −M⁻¹h by factors of M, from the h that is chosen and from those of these derivations.
fn by_factors(graph: &mut Graph, n: usize, chosen: &Chosen, equations: &[Equations]) -> Accelerations {
    let derived: Vec<Vec<Id>> = equations.iter().map(|derivation| derivation.bias.clone()).collect();
    factor::accelerations(graph, n, &chosen.mass, &chosen.bias, &derived)
}

/// ∂F/∂(u, u', u'').
fn by_inputs(graph: &mut Graph, residual: &[Id]) -> Vec<Entry> {
    entries(jacobian(graph, residual, |s| match s {
        Symbol::Input(k, order @ 0..=2) => Some(3 * k as usize + usize::from(order)),
        _ => None,
    }))
}

/// The rates of events' functions; those of accelerations and multipliers follow from F and γ, where neither reads the second
/// derivative of an input.
fn event_rates(graph: &mut Graph, functions: &[Id], solved: &[Id], constrained: bool) -> Vec<Rate> {
    let differentiable = constrained && !graph.symbols(solved.iter().copied()).iter().any(sharp);
    functions.iter().map(|g| rate_of(graph, *g, differentiable)).collect()
}

/// The total time derivative; with what the constraints determine held where the equations of motion can be differentiated.
fn rate_of(graph: &mut Graph, value: Id, differentiable: bool) -> Rate {
    let symbols = graph.symbols([value]);
    let solved = |s: &Symbol| matches!(s, Symbol::Acceleration(_) | Symbol::Multiplier(_));
    if symbols.iter().any(|s| sharp(s) || matches!(s, Symbol::Reaction(_))) {
        Rate::Unknown
    } else if !symbols.iter().any(solved) {
        Rate::Whole(rates(graph, &[value])[0])
    } else if differentiable {
        Rate::Held(held_rates(graph, &[value])[0])
    } else {
        Rate::Unknown
    }
}

/// Inputs whose rate is not there.
fn sharp(s: &Symbol) -> bool {
    matches!(s, Symbol::Input(_, 2..))
}

/// What a jump of an input does to the residual F(…, u, u', u'').
fn input_jump(graph: &mut Graph, residual: &[Id], input: u32) -> InputJump {
    let symbols = graph.symbols(residual.iter().copied());
    let contains = |order: u8| symbols.contains(&Symbol::Input(input, order));
    if contains(2) {
        return InputJump::Refused;
    }
    if !contains(1) {
        return InputJump::Force;
    }
    let slopes = jacobian(graph, residual, |s| (s == Symbol::Input(input, 1)).then_some(0));
    let symbols = graph.symbols(slopes.into_iter().flatten().map(|(_, slope)| slope));
    // What the slope sees during the jump must not change with it.
    let changes = |s: &Symbol| matches!(s, Symbol::Speed(_) | Symbol::Input(_, 1)) || *s == Symbol::Input(input, 0);
    if symbols.iter().any(changes) { InputJump::Refused } else { InputJump::Speed }
}

/// ∂F/∂q and ∂F/∂q' in their best form.
fn gathered_jacobians(graph: &mut Graph, n: usize, residual: &[Id]) -> (Vec<Entry>, Vec<Entry>) {
    let (mut stiffness, mut damping) = residual_jacobians(graph, n, residual);
    let slopes = stiffness.iter().chain(&damping).map(|e| e.2).collect();
    let slopes = forms::gathered(graph, slopes, residual);
    for (entry, value) in stiffness.iter_mut().chain(&mut damping).zip(slopes) {
        entry.2 = value;
    }
    (stiffness, damping)
}

/// Operations of F with its Jacobians.
fn jacobian_operations(graph: &Graph, residual: &[Id], stiffness: &[Entry], damping: &[Entry]) -> usize {
    let slopes = stiffness.iter().chain(damping).map(|entry| entry.2);
    operations(graph, &slopes.chain(residual.iter().copied()).collect::<Vec<_>>())
}

/// ∂F/∂q and ∂F/∂q', forward or row by row in reverse, whichever is cheaper.
fn residual_jacobians(graph: &mut Graph, n: usize, residual: &[Id]) -> (Vec<Entry>, Vec<Entry>) {
    let column = |s: Symbol| match s {
        Symbol::Coordinate(j) => Some(j as usize),
        Symbol::Speed(j) => Some(n + j as usize),
        _ => None,
    };
    let forward = entries(jacobian(graph, residual, column));
    if n > REVERSE_LIMIT {
        return split(forward, n);
    }
    let mut backward = Vec::new();
    for (i, row) in residual.iter().enumerate() {
        let gradient = reverse(graph, &[(*row, Id::ONE)], |s| column(s).is_some());
        let mut line: Vec<Entry> = gradient.iter().filter_map(|(s, d)| Some((i, column(*s)?, *d))).collect();
        line.retain(|e| e.2 != Id::ZERO);
        line.sort_by_key(|e| e.1);
        backward.extend(line);
    }
    let cost = |graph: &Graph, entries: &[Entry]| {
        operations(graph, &entries.iter().map(|e| e.2).chain(residual.iter().copied()).collect::<Vec<_>>())
    };
    split(if cost(graph, &backward) < cost(graph, &forward) { backward } else { forward }, n)
}

/// With more coordinates than this the residual comes from bodies, where forward mode is always cheaper.
const REVERSE_LIMIT: usize = 16;

/// Columns of q and columns of q'.
fn split(entries: Vec<Entry>, n: usize) -> (Vec<Entry>, Vec<Entry>) {
    let (dq, dv): (Vec<Entry>, Vec<Entry>) = entries.into_iter().partition(|e| e.1 < n);
    (dq, dv.into_iter().map(|(i, j, d)| (i, j - n, d)).collect())
}

fn gather_entries(graph: &mut Graph, entries: &mut [Entry]) {
    let values: Vec<Id> = entries.iter().map(|e| e.2).collect();
    for (entry, value) in entries.iter_mut().zip(gather::gather(graph, &values)) {
        entry.2 = value;
    }
}

fn entries(rows: Vec<Vec<(usize, Id)>>) -> Vec<Entry> {
    rows.into_iter().enumerate().flat_map(|(i, row)| row.into_iter().map(move |(j, d)| (i, j, d))).collect()
}

fn invariant_pairs(model: &mut Model) -> Vec<Id> {
    let mut pairs = Vec::new();
    for invariant in &model.conserved {
        let mut watched = watched(&mut model.graph, &invariant.when);
        if let Some(phases) = &invariant.phases {
            let claimed = phases.iter().fold(Id::ZERO, |sum, phase| {
                let phase = model.graph.symbol(Symbol::Phase(*phase as u32));
                model.graph.add(sum, phase)
            });
            watched = model.graph.mul(watched, claimed);
        }
        for (value, terms) in invariant.value.iter().zip(&invariant.terms) {
            let mut scale = Id::ZERO;
            for term in terms {
                let size = magnitude(&mut model.graph, *term);
                scale = model.graph.add(scale, size);
            }
            let value = model.graph.div(*value, watched);
            pairs.extend([value, scale]);
        }
    }
    pairs
}

/// The sum of the absolute values of a term's own terms: of a sum those of its parts, of a multiple of a sum
/// the multiple's.
fn magnitude(graph: &mut Graph, root: Id) -> Id {
    let is_sum = |graph: &Graph, id: Id| matches!(graph.node(id), Node::Binary(Binary::Add | Binary::Sub, ..));
    let mut total = Id::ZERO;
    // Parents have larger places than children, so taking the largest first visits each node once.
    let mut weights = std::collections::BTreeMap::from([(root, Id::ONE)]);
    while let Some((id, weight)) = weights.pop_last() {
        let parts = match graph.node(id) {
            Node::Unary(Unary::Neg, x) => vec![(x, weight)],
            Node::Binary(Binary::Add | Binary::Sub, x, y) => vec![(x, weight), (y, weight)],
            Node::Binary(Binary::Mul, x, y) if is_sum(graph, x) != is_sum(graph, y) => {
                let (sum, factor) = if is_sum(graph, x) { (x, y) } else { (y, x) };
                let size = graph.unary(Unary::Abs, factor);
                vec![(sum, graph.mul(weight, size))]
            }
            _ => {
                let size = graph.unary(Unary::Abs, id);
                let term = graph.mul(weight, size);
                total = graph.add(total, term);
                continue;
            }
        };
        for (part, weight) in parts {
            let known = weights.get(&part).copied().unwrap_or(Id::ZERO);
            let sum = graph.add(known, weight);
            weights.insert(part, sum);
        }
    }
    total
}

/// 1 where the parameters have these values and 0 elsewhere, so that a quotient by it is not finite there.
fn watched(graph: &mut Graph, when: &[Condition]) -> Id {
    let mut distance = Id::ZERO;
    for condition in when {
        let parameter = graph.symbol(Symbol::Parameter(condition.parameter as u32));
        let difference = graph.sub(parameter, condition.value);
        let size = graph.unary(Unary::Abs, difference);
        let beyond = beyond_rounding(graph, size, condition.value);
        distance = graph.add(distance, beyond);
    }
    let negative = graph.neg(distance);
    graph.unary(Unary::Step, negative)
}

/// A value that is computed is known to so many roundings of its own.
const ROUNDINGS: f64 = 8.0;

/// What is left of a distance from a value beyond the rounding with which that is computed; of a number none is.
fn beyond_rounding(graph: &mut Graph, distance: Id, value: Id) -> Id {
    if graph.number(value).is_some() {
        return distance;
    }
    let (part, size) = (graph.float(ROUNDINGS * f64::EPSILON), graph.unary(Unary::Abs, value));
    let rounding = graph.mul(part, size);
    let left = graph.sub(distance, rounding);
    graph.binary(Binary::Max, left, Id::ZERO)
}

fn drawn(shape: &Shape) -> Vec<Id> {
    match shape {
        Shape::Line(points) | Shape::Curve(points) => points.concat(),
        Shape::Circle { at, radius } => at.iter().copied().chain([*radius]).collect(),
        Shape::Spring(p, q) => [p.as_slice(), q].concat(),
        Shape::Trace(_, point) => point.clone(),
        Shape::Solid(_, numbers) => numbers.clone(),
    }
}
