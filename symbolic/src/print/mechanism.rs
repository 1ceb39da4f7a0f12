//! The implementations of `Equations` and `Mechanism`, function by function.

use std::fmt::Write;

use super::body::{Bodies, Use};
use super::description::description;
use super::expansion::expansion;
use super::function::{Function, Target, argument, stores};
use super::literal::float;
use super::parameters::field;
use super::rust::UNJUDGED;
use super::series::recurrences;
use super::words::comment;
use super::{contacts, memory, momentum, motions, parts, scenes};
use crate::expr::{Id, Table2d};
use crate::lower::{Accelerations, ConstrainedMotion, Entry, Program};
use crate::model::{Gimbal, Model, text};

/// Everything that the functions of one mechanism are printed with.
pub(super) struct Mechanism<'a> {
    pub program: &'a Program,
    /// For functions that have the block of constants.
    pub bodies: Bodies<'a>,
    /// For those that compute it, or do without.
    pub unhoisted: Bodies<'a>,
    /// What the block of constants holds after the parameters.
    pub constants: &'a [Id],
    /// The size of that block.
    pub block: usize,
    /// Whether there is a heap.
    pub allocates: bool,
}

impl Mechanism<'_> {
    /// `impl Equations for NAME { … }`.
    pub fn equations(&self, source: &str, name: &str) -> String {
        let program = self.program;
        let (n, rows) = (program.model.coordinates.len(), program.constraints.len());
        let mut out = format!(
            "{UNJUDGED}impl ::dalembert::mechanism::Equations<{n}, {rows}> for {name} {{
    type Constants<S: ::dalembert::mechanism::Real> = [S; {}];
    type Inputs<S: ::dalembert::mechanism::Real> = [S; {}];
    type Balances = [f64; {}];
    const MODES: usize = {};
    const PHASES: usize = {};
{}
    fn description() -> &'static ::dalembert::mechanism::Description {{
        use ::dalembert::mechanism;
        static DESCRIPTION: mechanism::Description = mechanism::Description {{
{}        }};
        &DESCRIPTION
    }}
",
            self.block,
            3 * program.model.inputs.len(),
            momentum::block(program),
            program.switches.len(),
            program.phases(),
            memory::size(program),
            description(program, source)
        );
        out += &gimbals(&program.model);
        out += &tables_2d(program);
        if let Some(series) = &program.series {
            out += &recurrences(series);
            out += &Function {
                name: "series_constants",
                targets: vec![Target { name: "out", kind: "&mut [S]".to_owned(), used: !series.constants.is_empty() }],
                uses: stores("out", &series.constants),
                ..Function::default()
            }
            .text(&self.bodies, "    ");
            out += &expansion(series, n).unwrap_or_default();
        }
        out += &self.constants_function();
        out += &self.inputs();
        for function in self.functions(n) {
            out += &function.text(&self.bodies, "    ");
        }
        out += &self.accelerations(n).text(&self.bodies, "    ");
        if let Some(eliminated) = &program.constraints.eliminated {
            out += "\n    const ELIMINATES: bool = true;\n";
            out += &function_of(eliminated).text(&self.bodies, "    ");
        }
        out += &parts::parts(program, &self.bodies);
        out += &momentum::balances(program, &self.bodies, self.block);
        out += &memory::memory(program, &self.bodies);
        out += &contacts::contacts(program);
        out + "}\n"
    }

    /// `impl Mechanism for NAME { … }`, which allocates.
    pub fn runs(&self, name: &str) -> String {
        let program = self.program;
        let (n, rows) = (program.model.coordinates.len(), program.constraints.len());
        let mut out = format!("\n{UNJUDGED}impl ::dalembert::mechanism::Mechanism<{n}, {rows}> for {name} {{\n");
        out += self.parameters().trim_start_matches('\n');
        out += &memory::starts(program, &self.unhoisted);
        out += &scenes::scenes(program, &self.unhoisted);
        out += &motions::motions(program, &self.unhoisted);
        out + "}\n"
    }

    fn constants_function(&self) -> String {
        let model = &self.program.model;
        let count = model.parameters.len();
        let mut lines = String::new();
        for (k, parameter) in model.parameters.iter().enumerate() {
            let _ = writeln!(lines, "        c[{k}] = S::gather(|i| lane(i).{});", field(parameter));
        }
        let first_memory = self.block - model.memory.len();
        let first_phase = first_memory - self.program.phases();
        for k in first_phase - self.program.switches.len()..first_phase {
            let _ = writeln!(lines, "        c[{k}] = S::ratio(1.0, 1.0);");
        }
        // The first phase is in force.
        if first_phase < first_memory {
            let _ = writeln!(lines, "        c[{first_phase}] = S::ratio(1.0, 1.0);");
        }
        for (k, id) in self.constants.iter().enumerate() {
            lines += &comment(&format!("c[{}] = {}", count + k, text(model, *id)), "        ");
        }
        let hoisted = self.constants.iter().zip(count..);
        let memory = model.memory.iter().map(|held| &held.start).zip(first_memory..);
        let uses: Vec<Use> = hoisted.chain(memory).map(|(id, place)| Use::Store(format!("c[{place}]"), *id)).collect();
        let lines = lines + &self.unhoisted.body(&uses, "        ").lines;
        let lane = argument("lane", "impl ::core::ops::Fn(usize) -> Self", count > 0);
        let body = block_of("c", self.block, &lines);
        format!("\n    fn constants<S: ::dalembert::mechanism::Real>({lane}) -> Self::Constants<S> {{\n{body}    }}\n")
    }

    fn inputs(&self) -> String {
        let signals: Vec<Id> = self.program.signals.iter().flatten().copied().collect();
        let body = self.bodies.body(&stores("out", &signals), "        ");
        let (c, t) = (argument("c", "&Self::Constants<S>", body.reads.constants), argument("t", "S", body.reads.time));
        let body = block_of("out", signals.len(), &body.lines);
        format!("\n    fn inputs<S: ::dalembert::mechanism::Real>({c}, {t}) -> Self::Inputs<S> {{\n{body}    }}\n")
    }

    /// Functions of the state that write what they compute.
    fn functions(&self, n: usize) -> Vec<Function<'static>> {
        let program = self.program;
        let values = |list: &[Entry]| list.iter().map(|e| e.2).collect::<Vec<_>>();
        let slice = |name, used| Target { name, kind: "&mut [S]".to_owned(), used };
        let array = |used| Target { name: "out", kind: format!("&mut [S; {n}]"), used };
        let into_slice = |name, state, list: &[Id]| Function {
            name,
            state,
            targets: vec![slice("out", !list.is_empty())],
            uses: stores("out", list),
            ..Function::default()
        };
        let into_array = |name, state, list: &[Id]| Function {
            name,
            state,
            targets: vec![array(!list.is_empty())],
            uses: stores("out", list),
            ..Function::default()
        };
        let rates: Vec<Id> = program.event_rates.iter().map(|rate| rate.value()).collect();
        let arguments: Vec<Id> = program.arguments.iter().flat_map(|a| [a.value, a.rate]).collect();
        let (dq, dv) = (values(&program.stiffness), values(&program.damping));
        let constraints = &program.constraints;
        let (cq, cv) = (values(&constraints.stiffness), values(&constraints.damping));
        vec![
            into_slice("mass_matrix", 2, &values(&program.mass)),
            into_array("bias", 2, &program.bias),
            into_array("residual", 3, &program.residual),
            Function {
                name: "jacobians",
                state: 3,
                targets: vec![slice("dq", !dq.is_empty()), slice("dv", !dv.is_empty())],
                uses: [stores("dq", &dq), stores("dv", &dv)].into_iter().flatten().collect(),
                ..Function::default()
            },
            into_slice("input_jacobian", 3, &values(&program.input)),
            into_slice("time_jacobian", 3, &values(&program.time)),
            into_slice("time_dependence", 3, &program.generic_time),
            into_slice("magnitudes", 3, &program.magnitudes),
            into_slice("invariants", 2, &program.invariants),
            into_slice("outputs", 3, &program.outputs),
            into_slice("events", 3, &program.events),
            into_slice("event_rates", 3, &rates),
            into_slice("switches", 3, &program.switch_pairs),
            into_slice("arguments", 3, &arguments),
            into_slice("drawing", 2, &program.drawing),
            into_slice("constraints", 2, &constraints.values),
            into_slice("constraint_matrix", 1, &values(&constraints.matrix)),
            into_slice("constraint_bias", 2, &constraints.bias),
            into_slice("friction", 2, &values(&constraints.friction)),
            Function {
                name: "constraint_jacobians",
                state: 3,
                targets: vec![slice("dq", !cq.is_empty()), slice("dv", !cv.is_empty())],
                uses: [stores("dq", &cq), stores("dv", &cv)].into_iter().flatten().collect(),
                ..Function::default()
            },
            into_slice("constraint_rate_jacobian", 2, &values(&constraints.rate_jacobian)),
            into_slice("held_rates", 3, &constraints.held_rates),
            into_slice("start_conditions", 3, &program.start_conditions()),
            Function {
                name: "energy",
                state: 3,
                result: Some("[S; 5]".to_owned()),
                before: "let mut out = [S::ratio(0.0, 1.0); 5];".to_owned(),
                uses: stores("out", &program.energy),
                after: "out",
                ..Function::default()
            },
        ]
    }

    fn accelerations(&self, n: usize) -> Function<'static> {
        let program = self.program;
        let mut function = Function {
            name: "accelerations",
            state: 2,
            targets: vec![Target { name: "out", kind: format!("&mut [S; {n}]"), used: true }],
            result: Some("::core::result::Result<(), ::dalembert::mechanism::SingularMass>".to_owned()),
            ..Function::default()
        };
        match &program.accelerations {
            Accelerations::Unrolled { values, pivots } => {
                function.targets[0].used = !values.is_empty();
                function.uses = pivots.iter().map(|(k, pivot, d)| Use::Pivot(*k, *pivot, *d)).collect();
                function.uses.extend(stores("out", values));
                function.after = "::core::result::Result::Ok(())";
            }
            Accelerations::Loop => {
                let size = n * (n + 1) / 2;
                // Large ones would not fit on a thread's stack; beside n³ operations an allocation is nothing.
                let heap = if self.allocates && size > STACK_LIMIT { "::std::vec!" } else { "" };
                function.before = format!("let mut packed = {heap}[S::ratio(0.0, 1.0); {size}];");
                let place = |i: usize, j: usize| i * (i + 1) / 2 + j;
                let mass = program.mass.iter().map(|(i, j, m)| Use::Store(format!("packed[{}]", place(*i, *j)), *m));
                function.uses = mass.chain(stores("out", &program.bias)).collect();
                function.after = "::dalembert::mechanism::solve_packed(&mut packed, out)";
            }
        }
        function
    }

    /// Parameters by place.
    fn parameters(&self) -> String {
        let fields: Vec<String> = self.program.model.parameters.iter().map(field).collect();
        let values: Vec<String> = fields.iter().map(|field| format!("self.{field}")).collect();
        let arm = |(k, field)| format!("            {k} => ::core::option::Option::Some(&mut self.{field}),\n");
        let arms: String = fields.iter().enumerate().map(arm).collect();
        let body = if fields.is_empty() {
            "        ::core::option::Option::None\n".to_owned()
        } else {
            format!("        match index {{\n{arms}            _ => ::core::option::Option::None,\n        }}\n")
        };
        let index = argument("index", "usize", !fields.is_empty());
        format!(
            "\n    fn parameters(&self) -> ::std::vec::Vec<f64> {{\n        ::std::vec![{}]\n    }}\n\n    fn parameter_mut(&mut self, {index}) -> ::core::option::Option<&mut f64> {{\n{body}    }}\n",
            values.join(", ")
        )
    }
}

/// `fn eliminated(…)`.
fn function_of(eliminated: &ConstrainedMotion) -> Function<'static> {
    let lists = ["a", "l", "pivots", "sizes", "mobilities", "alone"].into_iter().zip(eliminated.lists());
    let target =
        |(name, list): (&'static str, &[Id])| Target { name, kind: format!("&mut [S; {}]", list.len()), used: true };
    Function {
        name: "eliminated",
        state: 2,
        targets: lists.clone().map(target).collect(),
        uses: lists.flat_map(|(name, list)| stores(name, list)).collect(),
        ..Function::default()
    }
}

/// `fn gimbals() -> …`; that of the trait serves where there are none.
fn gimbals(model: &Model) -> String {
    let entry = |gimbal: &Gimbal| {
        let [first, middle, last] = gimbal.coordinates;
        format!(
            "            ::dalembert::mechanism::Gimbal {{ frame: ::dalembert::mechanism::Text::Borrowed({:?}), coordinates: [{first}, {middle}, {last}], amplitude: {}, factor: {}, phase: {} }},\n",
            gimbal.frame,
            float(gimbal.amplitude),
            float(gimbal.factor),
            float(gimbal.phase)
        )
    };
    let entries: String = model.gimbals().iter().map(entry).collect();
    match entries.as_str() {
        "" => String::new(),
        entries => format!(
            "\n    fn gimbals() -> &'static [::dalembert::mechanism::Gimbal] {{\n        static GIMBALS: &[::dalembert::mechanism::Gimbal] = &[\n{entries}        ];\n        GIMBALS\n    }}\n"
        ),
    }
}

/// `fn tables_2d() -> …`; that of the trait serves where there are none.
fn tables_2d(program: &Program) -> String {
    let borrowed = |entries: Vec<String>| format!("::dalembert::mechanism::List::Borrowed(&[{}])", entries.join(", "));
    let floats = |numbers: &[f64]| numbers.iter().map(|x| float(*x)).collect::<Vec<_>>();
    let period = |period: Option<f64>| match period {
        None => "::core::option::Option::None".to_owned(),
        Some(period) => format!("::core::option::Option::Some({})", float(period)),
    };
    let entry = |table: Table2d| {
        let rows = |piece: &[[f64; 4]; 4]| piece.map(|row| format!("[{}]", floats(&row).join(", "))).join(", ");
        format!(
            "            ::dalembert::mechanism::Table2d {{ name: ::dalembert::mechanism::Text::Borrowed({:?}), knots: [{}], pieces: {}, periods: [{}] }},\n",
            table.name(),
            table.knots().each_ref().map(|knots| borrowed(floats(knots))).join(", "),
            borrowed(table.pieces().iter().map(|piece| format!("[{}]", rows(piece))).collect()),
            table.periods().map(period).join(", ")
        )
    };
    let entries: String = program.tables_2d().into_iter().map(entry).collect();
    match entries.as_str() {
        "" => String::new(),
        entries => format!(
            "\n    fn tables_2d() -> &'static [::dalembert::mechanism::Table2d] {{\n        static TABLES: &[::dalembert::mechanism::Table2d] = &[\n{entries}        ];\n        TABLES\n    }}\n"
        ),
    }
}

/// Most numbers that a function keeps on the stack.
const STACK_LIMIT: usize = 8192;

/// A block of so many zeros under a name, the statements that fill it, and the block as the result.
fn block_of(name: &str, size: usize, lines: &str) -> String {
    match size {
        0 => "        []\n".to_owned(),
        _ => format!("        let mut {name} = [S::ratio(0.0, 1.0); {size}];\n{lines}        {name}\n"),
    }
}
