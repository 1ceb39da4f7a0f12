//! A program as C99: a header and a source for each mechanism, and a core that all share.  Nothing of it allocates or has a state.

mod acceleration;
mod declarations;
mod dialect;
mod function;
mod normal;
mod starts;
mod tables_2d;

use rustc_hash::FxHashMap as HashMap;

use self::dialect::C;
pub use self::dialect::float as c_float;
use self::function::Function;
use super::body::{Bodies, Use};
use super::constants::name_constants;
use super::function::stores;
use super::rust::hoist;
use super::scope::{Names, Scope};
use crate::expr::Id;
use crate::lower::{Entry, Program, Slopes};
use crate::model::KEYWORDS;

/// The declarations of the core.
pub const CORE_HEADER: &str = include_str!("dalembert_core.h");
/// The core: tables, M = L D Lᵀ, and accelerations with multipliers.
pub const CORE_SOURCE: &str = include_str!("dalembert_core.c");

/// The core as a file of its own beside its header.
pub fn core_file() -> String {
    format!("#include \"dalembert_core.h\"\n\n{CORE_SOURCE}")
}

/// A mechanism in C99; neither text includes the other, nor the core.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CText {
    /// What all names begin with, `double_pendulum`.
    pub prefix: String,
    /// Sizes, parameters and declarations, documented.
    pub header: String,
    /// The functions.
    pub source: String,
    /// Whether it has slopes along directions, which the largest models do not have.
    pub has_slopes: bool,
}

impl CText {
    /// All of it with the core in one text that compiles by itself.
    pub fn whole(&self) -> String {
        [CORE_HEADER, &self.header, CORE_SOURCE, &self.source].join("\n")
    }

    /// The source as a file of its own beside its header and the core.
    pub fn file(&self) -> String {
        format!("#include \"dalembert_core.h\"\n#include \"{}.h\"\n\n{}", self.prefix, self.source)
    }
}

/// The functions of a mechanism in C99, with names that begin with `name`.
pub fn c(program: &Program, name: &str) -> CText {
    let prefix = dialect::identifier(name);
    let mut with_slopes = program.clone();
    let slopes = Slopes::of(&mut with_slopes);
    let program = if slopes.is_some() { &with_slopes } else { program };
    let (tables, tables_2d) = (program.tables(), program.tables_2d());
    let own = (0..tables.len()).map(|place| format!("{prefix}_table_{place}"));
    let own = own.chain(tables_2d::names(&prefix, tables_2d.len())).chain(normal::names(&prefix));
    let taken = KEYWORDS.iter().chain(super::OWN).map(|name| (*name).to_owned()).chain(dialect::taken());
    let mut names = Names::of(&program.model, Scope::with(taken.chain(own)));
    let constants = hoist(program);
    name_constants(&mut names, program, &constants);
    let free = program.model.parameters.len();
    let first_mode = free + constants.len();
    let first_phase = first_mode + program.switches.len();
    let first_memory = first_phase + program.phases();
    let places = constants.iter().enumerate().map(|(k, id)| (*id, free + k)).collect();
    let (nowhere, dialect) = (HashMap::default(), C { prefix: &prefix });
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
    let printing = Printing {
        program,
        slopes,
        prefix: &prefix,
        bodies: bodies(&places),
        unhoisted: bodies(&nowhere),
        constants: &constants,
        block: first_memory + program.model.memory.len(),
    };
    let mut header = printing.head();
    let mut source = printing.sources_of_declarations();
    let accelerations = printing.accelerations();
    let functions = printing.functions();
    for function in &functions {
        header += &function.declaration(&prefix);
        source += &function.definition(&prefix, &printing.bodies);
    }
    header += &printing.declarations_of_starts();
    source += &printing.starts();
    header += &printing.declarations_of_accelerations();
    source += &accelerations;
    header += "\n#endif\n";
    CText { source, header, has_slopes: printing.slopes.is_some(), prefix }
}

/// Everything that the functions of one mechanism are printed with.
struct Printing<'a> {
    program: &'a Program,
    /// Slopes along directions; `None` where the model is too large for them.
    slopes: Option<Slopes>,
    prefix: &'a str,
    /// For functions that have the block of constants.
    bodies: Bodies<'a>,
    /// For those that compute it.
    unhoisted: Bodies<'a>,
    /// What the block of constants holds after the parameters.
    constants: &'a [Id],
    /// The size of that block.
    block: usize,
}

/// How a matrix is filled.
#[derive(Clone, Copy, PartialEq)]
enum Shape {
    Full,
    Symmetric,
}

/// Stores of a sparse matrix into a dense one, row by row.
fn dense(entries: &[Entry], columns: usize, shape: Shape) -> Vec<Use> {
    let target = |(i, j, _): &Entry| {
        let own = format!("out[{}]", i * columns + j);
        if shape == Shape::Symmetric && i != j { format!("{own} = out[{}]", j * columns + i) } else { own }
    };
    entries.iter().map(|entry| Use::Store(target(entry), entry.2)).collect()
}

impl Printing<'_> {
    /// Functions of a state, in the order of the header.
    fn functions(&self) -> Vec<Function> {
        let Program { model, constraints, .. } = self.program;
        let (n, inputs, rows) = (model.coordinates.len(), model.inputs.len(), constraints.len());
        let matrix = |name, order, about: &str, entries: &[Entry], (lines, columns): (usize, usize), shape| Function {
            name,
            order,
            along: false,
            about: about.to_owned(),
            size: lines * columns,
            uses: dense(entries, columns, shape),
        };
        let list = |name, order, about: &str, values: &[Id]| Function {
            name,
            order,
            along: false,
            about: about.to_owned(),
            size: values.len(),
            uses: stores("out", values),
        };
        let Program { stiffness, damping, input, time, .. } = self.program;
        let rates: Vec<Id> = self.program.event_rates.iter().map(|rate| rate.value()).collect();
        let mut functions = vec![
            matrix("mass_matrix", 2, MASS, &self.program.mass, (n, n), Shape::Symmetric),
            list("bias", 2, BIAS, &self.program.bias),
            list("residual", 3, RESIDUAL, &self.program.residual),
            list("energy", 3, ENERGY, &self.program.energy),
            list("outputs", 3, &self.about_outputs(), &self.program.outputs),
            list("invariants", 2, &self.about_invariants(), &self.program.invariants),
            list("events", 3, &self.about_events(), &self.program.events),
            list("event_rates", 3, EVENT_RATES, &rates),
            list("assignments", 3, &self.about_assignments(), &self.program.assignments),
            list("switches", 3, SWITCHES, &self.program.switch_pairs),
            matrix("stiffness", 3, STIFFNESS, stiffness, (n, n), Shape::Full),
            matrix("damping", 3, DAMPING, damping, (n, n), Shape::Full),
            matrix("input_jacobian", 3, INPUT, input, (n, 3 * inputs), Shape::Full),
            matrix("time_jacobian", 3, TIME, time, (n, 1), Shape::Full),
        ];
        if rows > 0 {
            let (by, square) = (Shape::Full, (rows, n));
            functions.extend([
                list("constraints", 2, CONSTRAINTS, &constraints.values),
                matrix("constraint_matrix", 1, MATRIX, &constraints.matrix, square, by),
                list("constraint_bias", 2, GAMMA, &constraints.bias),
                matrix("friction", 2, FRICTION, &constraints.friction, (n, rows), by),
                matrix("constraint_stiffness", 3, ROW_STIFFNESS, &constraints.stiffness, square, by),
                matrix("constraint_damping", 3, ROW_DAMPING, &constraints.damping, square, by),
                matrix("constraint_rate_jacobian", 2, ROW_RATES, &constraints.rate_jacobian, square, by),
            ]);
        }
        if let Some(Slopes { equations, outputs, inputs }) = &self.slopes {
            let along = |function: Function| Function { along: true, ..function };
            functions.extend([
                along(list("equation_slopes", 3, EQUATION_SLOPES, equations)),
                along(list("output_slopes", 3, OUTPUT_SLOPES, outputs)),
                along(list("input_slopes", 0, &INPUT_SLOPES.replace("NAME", self.prefix), inputs)),
            ]);
        }
        functions
    }
}

const MASS: &str = "M(t, q): n by n, row by row, symmetric; of v only states of first order in masses are read.";
const BIAS: &str = "h(t, q, q'): n numbers; M q'' + h = 0 where no constraint acts.";
const RESIDUAL: &str = "F = M q'' + h - (J^T + B) lambda: n numbers.";
const ENERGY: &str = "T, V, the Jacobi function, the power of what has no potential, and the sum of the absolute terms of T and V: 5 numbers; J, J, J, W, J.";
const EVENT_RATES: &str =
    "The total time derivative of each event's function, with q'' and lambda held; 0 where it is not known.";
const SWITCHES: &str = "Pairs (argument, its rate) of each discontinuity: its mode is that of the argument's sign.";
const STIFFNESS: &str = "dF/dq: n by n, row by row.";
const DAMPING: &str = "dF/dq': n by n, row by row.";
const INPUT: &str = "dF/d(u, u', u''): n rows with three columns for each input.";
const TIME: &str = "dF/dt, inputs held: n numbers.";
const CONSTRAINTS: &str = "Triples (c, c', sum of the absolute terms of c) of all rows; c of a row with speeds is its integral where one is known.";
const MATRIX: &str = "J = dc'/dq' of all rows: rows by n, row by row.";
const GAMMA: &str = "gamma of all rows: J q'' + gamma = 0 in the rows of the phase.";
const FRICTION: &str = "B(t, q, q'), forces that multipliers cause beside J^T lambda: n by rows, row by row.";
const ROW_STIFFNESS: &str = "d(J q'' + gamma)/dq: rows by n, row by row.";
const ROW_DAMPING: &str = "d(J q'' + gamma)/dq': rows by n, row by row.";
const ROW_RATES: &str = "dc'/dq: rows by n, row by row.";
const EQUATION_SLOPES: &str = "Changes of F, then of J q'' + gamma of all rows, along a direction: of t, q, v, a, l, (u, u', u'') of each input, parameters, held values.  Modes and the phase stay.";
const OUTPUT_SLOPES: &str = "Changes of the outputs along such a direction.";
const INPUT_SLOPES: &str = "Changes of what NAME_inputs gives along such a direction.";
