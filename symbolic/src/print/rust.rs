//! A whole program as Rust source.

use rustc_hash::FxHashMap as HashMap;

use super::body::Bodies;
use super::constants::name_constants;
use super::dialect;
use super::mechanism::Mechanism;
use super::parameters::{derived, parameters};
use super::scope::{Names, Scope};
use super::source_file::format_check;
use crate::expr::{Binary, Id, Node, Number, Rational, Symbol, Table, Table2d, Unary};
use crate::lower::{Accelerations, Program};
use crate::model::{Clock, Contact, EventAction, Goal};

/// For what generated code is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Runs: `Equations` and `Mechanism`.
    Runs,
    /// Code of one's own, without the standard library: `Equations` alone, which allocate nothing.
    NoStd,
}

/// The items that `model!` expands to: the type, its parameters, its `Equations` and its `Mechanism`.
///
/// `source` is the model file's text, `name` the type's name.  Every path is absolute, and every name inside
/// functions comes from one scope (`scope.rs`), so that nothing in the file or around the expansion changes a meaning.
pub fn rust(program: &Program, source: &str, name: &str) -> String {
    items(program, source, name, Purpose::Runs)
}

/// As [`rust`], for a purpose.
pub(super) fn items(program: &Program, source: &str, name: &str, purpose: Purpose) -> String {
    let mut names = Names::of(&program.model, Scope::root());
    let constants = hoist(program);
    name_constants(&mut names, program, &constants);
    let free = program.model.parameters.len();
    let first_mode = free + constants.len();
    let first_phase = first_mode + program.switches.len();
    let first_memory = first_phase + program.phases();
    let nowhere = HashMap::default();
    let places = constants.iter().enumerate().map(|(k, id)| (*id, free + k)).collect();
    let (tables, tables_2d) = (program.tables(), program.tables_2d());
    let owner = format!(
        "<{name} as ::dalembert::mechanism::Equations<{}, {}>>",
        program.model.coordinates.len(),
        program.constraints.len()
    );
    let dialect = dialect::Rust { owner: &owner };
    let bodies = |hoisted| Bodies {
        graph: &program.model.graph,
        names: &names,
        hoisted,
        first_mode,
        first_phase,
        first_memory,
        tables: &tables,
        tables_2d: &tables_2d,
        dialect: &dialect,
    };
    let mechanism = Mechanism {
        program,
        bodies: bodies(&places),
        unhoisted: bodies(&nowhere),
        constants: &constants,
        block: first_memory + program.model.memory.len(),
        allocates: purpose == Purpose::Runs,
    };
    let mut out = parameters(program, name) + &mechanism.equations(source, name);
    if purpose == Purpose::Runs {
        out += &mechanism.runs(name);
        out += &derived(program, name, &mechanism.unhoisted);
    }
    out + &format_check()
}

/// What stands before every `impl` of generated code: its numbers and its style are the file's, not its author's.
pub(super) const UNJUDGED: &str = "#[allow(clippy::all, clippy::pedantic, clippy::nursery)]\n";

/// Expressions of parameters only that some function needs, in order of creation.
pub(super) fn hoist(program: &Program) -> Vec<Id> {
    let graph = &program.model.graph;
    let varying = graph.contains(|s| !matches!(s, Symbol::Parameter(_)));
    let roots = program.roots();
    let needed = graph.reachable(roots.iter().copied());
    let mut hoisted = vec![false; graph.len()];
    let operation = |id: Id| match graph.node(id) {
        Node::Number(_) | Node::Symbol(_) => false,
        // A change of sign is free.
        Node::Unary(Unary::Neg, x) => !matches!(graph.node(x), Node::Number(_) | Node::Symbol(_)),
        _ => true,
    };
    for i in (0..graph.len()).filter(|&i| needed[i] && varying[i]) {
        for child in graph.children(graph.id_at(i)) {
            hoisted[child.index()] |= !varying[child.index()] && operation(child);
        }
    }
    for root in roots {
        hoisted[root.index()] |= !varying[root.index()] && operation(root);
    }
    (0..graph.len()).filter(|&i| hoisted[i]).map(|i| graph.id_at(i)).collect()
}

impl Program {
    /// All tables that expressions contain, each once.
    pub fn tables(&self) -> Vec<Table> {
        let graph = &self.model.graph;
        let mut tables: Vec<Table> = Vec::new();
        for node in (0..graph.len()).map(|place| graph.node(graph.id_at(place))) {
            if let Node::Unary(Unary::Table(table), _) = node
                && !tables.contains(&table.whole())
            {
                tables.push(table.whole());
            }
        }
        tables
    }

    /// All tables of two arguments that expressions contain, each once.
    pub fn tables_2d(&self) -> Vec<Table2d> {
        let graph = &self.model.graph;
        let mut tables: Vec<Table2d> = Vec::new();
        for node in (0..graph.len()).map(|place| graph.node(graph.id_at(place))) {
            if let Node::Binary(Binary::Table(table), ..) = node
                && !tables.contains(&table.whole())
            {
                tables.push(table.whole());
            }
        }
        tables
    }

    /// Every expression that some generated function computes from a state.
    fn roots(&self) -> Vec<Id> {
        let constraints = &self.constraints;
        let entries = [&self.mass, &self.stiffness, &self.damping, &self.input, &self.time];
        let of_rows = [
            &constraints.matrix,
            &constraints.friction,
            &constraints.stiffness,
            &constraints.damping,
            &constraints.rate_jacobian,
        ];
        let entries = entries.into_iter().chain(of_rows);
        let mut roots: Vec<Id> = entries.flatten().map(|e| e.2).collect();
        let lists = [
            &self.bias,
            &self.residual,
            &self.generic_time,
            &self.magnitudes,
            &self.invariants,
            &self.outputs,
            &self.events,
            &self.assignments,
            &self.switch_pairs,
            &self.drawing,
            &constraints.values,
            &constraints.bias,
            &constraints.held_rates,
        ];
        roots.extend(lists.into_iter().flatten());
        roots.extend(self.energy);
        roots.extend(self.start_conditions());
        roots.extend(self.parts.iter().flat_map(|part| part.energy));
        roots.extend(self.signals.iter().flatten());
        roots.extend(self.event_rates.iter().map(|rate| rate.value()));
        roots.extend(self.arguments.iter().flat_map(|a| [a.value, a.rate]));
        for system in &self.momentum {
            roots.extend(system.matrix.iter().map(|e| e.2).chain(system.right.iter().copied()));
        }
        if let Accelerations::Unrolled { values, pivots } = &self.accelerations {
            roots.extend(values);
            roots.extend(pivots.iter().flat_map(|p| [p.1, p.2]));
        }
        roots.extend(constraints.eliminated.iter().flat_map(|found| found.lists().concat()));
        roots
    }

    /// What scenes say that their starts meet beside constraints: quantities of the state, scene by scene.
    pub fn start_conditions(&self) -> Vec<Id> {
        self.model.all_scenes().flat_map(|scene| scene.start_conditions.iter().map(|pair| pair.0)).collect()
    }

    /// The values of these, of parameters.
    pub fn start_condition_values(&self) -> Vec<Id> {
        self.model.all_scenes().flat_map(|scene| scene.start_conditions.iter().map(|pair| pair.1)).collect()
    }

    /// Pairs (place of one of these quantities, rate that it contains).
    pub fn start_condition_speeds(&self) -> Vec<(u32, u32)> {
        let rates = |(k, id): (usize, &Id)| -> Vec<(u32, u32)> {
            let symbols = self.model.graph.symbols([*id]).into_iter();
            symbols.filter_map(|s| if let Symbol::Speed(i) = s { Some((k as u32, i)) } else { None }).collect()
        };
        self.start_conditions().iter().enumerate().flat_map(rates).collect()
    }

    /// The period, the energy, guesses of unknowns and values of conditions of a motion, of parameters; 0 for what is not given.
    pub fn motion_numbers(&self, motion: usize) -> Vec<Id> {
        let Some(motion) = self.model.motions.get(motion) else { return Vec::new() };
        let (period, energy) = match &motion.goal {
            Goal::Closes(closes) => (closes.period, closes.energy),
            _ => (None, None),
        };
        let conditions = match &motion.goal {
            Goal::Meets { conditions, .. } => conditions.as_slice(),
            _ => &[],
        };
        let given = [period, energy].map(|number| number.unwrap_or(Id::ZERO));
        given.into_iter().chain(motion.unknowns.iter().chain(conditions).map(|(_, id)| *id)).collect()
    }

    /// How many of a phase's rows are independent in general.
    pub fn rank_of(&self, phase: usize) -> usize {
        let rows = || self.model.phases.get(phase).map_or(0, |phase| self.model.rows_of(phase).len());
        self.report.ranks.get(phase).copied().unwrap_or_else(rows)
    }

    /// The coefficients of restitution of all impacts, in the order of the events, then of all contacts that have one.
    pub fn restitutions(&self) -> Vec<Id> {
        let actions = self.model.events.iter().flat_map(|event| &event.actions);
        let of_events = actions
            .filter_map(|a| if let EventAction::Impact { restitution, .. } = a { Some(*restitution) } else { None });
        of_events.chain(self.model.contacts.iter().filter_map(|contact| contact.restitution)).collect()
    }

    /// The place of each contact's coefficient of restitution among [`Program::restitutions`].
    pub fn restitutions_of_contacts(&self) -> Vec<Option<usize>> {
        let mut next =
            self.restitutions().len() - self.model.contacts.iter().filter(|c| c.restitution.is_some()).count();
        let place = |contact: &Contact| {
            contact.restitution.map(|_| {
                next += 1;
                next - 1
            })
        };
        self.model.contacts.iter().map(place).collect()
    }

    /// What held values are where a scene starts, of parameters.
    pub fn memory_of_scene(&self, scene: usize) -> Vec<Id> {
        let scene = self.model.all_scenes().nth(scene).or_else(|| self.model.all_scenes().next());
        scene.map_or_else(Vec::new, |scene| scene.memory.clone())
    }

    /// Pairs (first tick, period) of all clocks, of parameters.
    pub fn clock_numbers(&self) -> Vec<Id> {
        self.model.clocks.iter().flat_map(|clock| [clock.from, clock.every]).collect()
    }

    /// The first tick and the period of a clock as fractions, where both are plain numbers.
    pub fn exact_clock(&self, clock: &Clock) -> Option<[Rational; 2]> {
        let exact = |id: Id| match self.model.graph.number(id) {
            Some(Number::Exact(rational)) => Some(rational),
            _ => None,
        };
        Some([exact(clock.from)?, exact(clock.every)?])
    }

    /// True when something that events set contains an acceleration or a multiplier.
    pub fn assignments_use_accelerations(&self) -> bool {
        let symbols = self.model.graph.symbols(self.assignments.iter().copied());
        symbols.into_iter().any(|s| matches!(s, Symbol::Acceleration(_) | Symbol::Multiplier(_)))
    }

    /// How many indicators of phases generated code holds: none where the file has no phases.
    pub fn phases(&self) -> usize {
        self.model.phases.iter().filter(|phase| !phase.name.is_empty()).count()
    }

    /// True when some output contains an acceleration or a multiplier.
    pub fn outputs_use_accelerations(&self) -> bool {
        let symbols = self.model.graph.symbols(self.outputs.iter().copied());
        symbols.into_iter().any(|s| matches!(s, Symbol::Acceleration(_) | Symbol::Multiplier(_)))
    }

    /// Outputs, by place, that contain named reactions.
    pub fn outputs_of_reactions(&self) -> impl Iterator<Item = usize> {
        self.model.outputs.iter().enumerate().filter(|(_, output)| output.of_reactions).map(|(place, _)| place)
    }

    /// True when some event contains an acceleration or a multiplier.
    pub fn events_use_accelerations(&self) -> bool {
        let symbols = self.model.graph.symbols(self.events.iter().copied());
        symbols.into_iter().any(|s| matches!(s, Symbol::Acceleration(_) | Symbol::Multiplier(_)))
    }
}
