//! A whole program as Rust source.

use rustc_hash::FxHashMap as HashMap;
use std::fmt::Write;

use super::body::{Bodies, Use, float};
use super::description::description;
use super::documentation::{about, tested};
use super::momentum;
use super::names::{Locals, field_name};
use crate::expr::{Id, Node, Symbol, Unary};
use crate::lower::{Accelerations, Entry, Program};
use crate::model::{Parameter, text};

/// The items that `model!` expands to: the type, its parameters, and its `Mechanism`.
///
/// `source` is the model file's text, `name` the type's name.
pub fn rust(program: &Program, source: &str, name: &str) -> String {
    let blank = HashMap::default();
    let locals = Locals::of(&program.model);
    let constants = hoist(program);
    let modes = program.switches.len();
    let block = program.model.parameters.len() + constants.len();
    let places: HashMap<Id, usize> =
        constants.iter().enumerate().map(|(k, id)| (*id, program.model.parameters.len() + k)).collect();
    let bodies = Bodies { graph: &program.model.graph, locals: &locals, hoisted: &places, first_mode: block };
    let unhoisted = Bodies { graph: &program.model.graph, locals: &locals, hoisted: &blank, first_mode: block };
    let mut out = String::new();
    parameters(&mut out, program, name, &unhoisted);
    mechanism(&mut out, program, source, name, &bodies, &unhoisted, &constants, block + modes);
    out
}

/// Expressions of parameters only that some function needs, in order of creation.
fn hoist(program: &Program) -> Vec<Id> {
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

/// The struct, its default, and a method per derived parameter.
fn parameters(out: &mut String, program: &Program, name: &str, bodies: &Bodies<'_>) {
    let model = &program.model;
    let fields = fields(&model.parameters);
    let _ = writeln!(out, "/// {}", about(&model.about, name));
    let _ = writeln!(out, "///");
    let _ = writeln!(out, "{}", tested(program));
    let snake = |s: &str| s.chars().all(|c| !c.is_uppercase());
    let mixed = fields.iter().map(|f| f.name.as_str()).chain(model.derived.iter().map(|d| d.name.as_str()));
    let allow = if mixed.clone().all(snake) { "" } else { "#[allow(non_snake_case)]\n" };
    let _ = writeln!(out, "{allow}#[derive(Clone, Debug, PartialEq)]\npub struct {name} {{");
    for field in &fields {
        let unit = field.unit.as_deref().unwrap_or("no unit");
        let _ = writeln!(out, "    /// `{}`, {unit}.\n    pub {}: {},", field.label, field.name, field.kind);
    }
    let _ = writeln!(out, "}}\n\nimpl Default for {name} {{\n    fn default() -> Self {{\n        {name} {{");
    for field in &fields {
        let _ = writeln!(out, "            {}: {},", field.name, field.default);
    }
    let _ = writeln!(out, "        }}\n    }}\n}}\n");
    let scalar: Vec<_> = model.derived.iter().filter(|d| !d.name.contains('[')).collect();
    if scalar.is_empty() {
        return;
    }
    let _ = writeln!(out, "{allow}impl {name} {{");
    for derived in scalar {
        let body = bodies.body(&[Use::Store("let value".to_owned(), derived.value)], "        ");
        let unit = derived.unit.as_deref().unwrap_or("unit from what it is computed from");
        let _ = writeln!(
            out,
            "    /// `{} = {}`, {unit}.\n    #[must_use]\n    pub fn {}(&self) -> f64 {{\n        type S = f64;\n        let c = ::dalembert::mechanism::Mechanism::parameters(self);\n        use ::dalembert::mechanism::Real as _;\n        let _ = (&c, S::ratio(0.0, 1.0));\n{body}        value\n    }}",
            derived.name,
            text(model, derived.value),
            field_name(&derived.name),
        );
    }
    let _ = writeln!(out, "}}\n");
}

struct Field {
    name: String,
    label: String,
    kind: String,
    default: String,
    unit: Option<String>,
}

/// Fields of the struct: scalars, and arrays of families.
fn fields(parameters: &[Parameter]) -> Vec<Field> {
    let mut fields: Vec<Field> = Vec::new();
    for parameter in parameters {
        let Some(family) = &parameter.family else {
            fields.push(Field {
                name: field_name(&parameter.name),
                label: parameter.name.clone(),
                kind: "f64".to_owned(),
                default: float(parameter.default),
                unit: parameter.unit.clone(),
            });
            continue;
        };
        let name = field_name(&family.name);
        if fields.iter().any(|f| f.name == name) {
            continue;
        }
        let value = |indices: &[i64]| {
            let member = parameters
                .iter()
                .find(|p| p.family.as_ref().is_some_and(|f| f.name == family.name && f.indices.as_slice() == indices));
            float(member.map_or(0.0, |p| p.default))
        };
        let size = |k: usize| family.ranges[k].1 - family.ranges[k].0 + 1;
        let span = |k: usize| family.ranges[k].0..=family.ranges[k].1;
        let (kind, default) = if family.ranges.len() == 1 {
            let values: Vec<String> = span(0).map(|i| value(&[i])).collect();
            (format!("[f64; {}]", size(0)), format!("[{}]", values.join(", ")))
        } else {
            let rows: Vec<String> = span(0)
                .map(|i| format!("[{}]", span(1).map(|j| value(&[i, j])).collect::<Vec<_>>().join(", ")))
                .collect();
            (format!("[[f64; {}]; {}]", size(1), size(0)), format!("[{}]", rows.join(", ")))
        };
        fields.push(Field { name, label: family.name.clone(), kind, default, unit: parameter.unit.clone() });
    }
    fields
}

/// How generated code reaches a parameter's value.
fn access(parameter: &Parameter) -> String {
    match &parameter.family {
        None => format!("self.{}", field_name(&parameter.name)),
        Some(family) => {
            let places: String =
                family.indices.iter().zip(&family.ranges).map(|(i, (low, _))| format!("[{}]", i - low)).collect();
            format!("self.{}{places}", field_name(&family.name))
        }
    }
}

#[expect(clippy::too_many_arguments, reason = "the pieces of one impl block")]
fn mechanism(
    out: &mut String,
    program: &Program,
    source: &str,
    name: &str,
    bodies: &Bodies<'_>,
    unhoisted: &Bodies<'_>,
    constants: &[Id],
    block: usize,
) {
    let model = &program.model;
    let n = model.coordinates.len();
    let modes = program.switches.len();
    let inputs = 3 * model.inputs.len();
    let _ = write!(
        out,
        "impl ::dalembert::mechanism::Mechanism<{n}, 0> for {name} {{
    type Constants<S: ::dalembert::mechanism::Real> = [S; {block}];
    type Inputs<S: ::dalembert::mechanism::Real> = [S; {inputs}];
    type Balances = [f64; {}];
    const MODES: usize = {modes};

    fn description() -> &'static ::dalembert::mechanism::Description {{
        use ::dalembert::mechanism::{{Action, Argument, Balance, BalanceSystem, Coordinate, Counts, Description, Direction, Event, InputJump, List, Parameter, Quantity, Role, Shape, Structure, Switch, SwitchKind, Text, Watched}};
        #[allow(unused_imports)]
        use {{Action as _, Argument as _, Balance as _, BalanceSystem as _, Direction as _, Event as _, InputJump as _, Parameter as _, Quantity as _, Role as _, Shape as _, Switch as _, SwitchKind as _, Watched as _}};
        static DESCRIPTION: Description = Description {{
{}        }};
        &DESCRIPTION
    }}
",
        momentum::block(program),
        description(program, source)
    );
    constants_function(out, program, unhoisted, constants, block);

    let stores = |ids: &[Id]| -> Vec<Use> {
        ids.iter().enumerate().map(|(k, id)| Use::Store(format!("out[{k}]"), *id)).collect()
    };
    let entries = |list: &[Entry]| list.iter().map(|e| e.2).collect::<Vec<_>>();
    let signals: Vec<Id> = program.signals.iter().flatten().copied().collect();
    let body = bodies.body(&stores(&signals), "        ");
    let _ = write!(
        out,
        "
    fn inputs<S: ::dalembert::mechanism::Real>(c: &Self::Constants<S>, t: S) -> Self::Inputs<S> {{
        let _ = (c, t);
        let mut out = [S::ratio(0.0, 1.0); {inputs}];
        let _ = &mut out;
{body}        out
    }}
"
    );
    let mut function = |function: &str, state: State, last: &str, uses: Vec<Use>| {
        let body = bodies.body(&uses, "        ");
        let (arguments, ignored) = match state {
            State::Position => (format!("q: &[S; {n}]"), "q"),
            State::Velocity => (format!("q: &[S; {n}], v: &[S; {n}]"), "q, v"),
            State::Acceleration => (format!("q: &[S; {n}], v: &[S; {n}], a: &[S; {n}]"), "q, v, a"),
        };
        let names: Vec<&str> = last.split(", ").filter_map(|a| a.split(':').next()).collect();
        let used = names.join(", &");
        let _ = write!(
            out,
            "
    fn {function}<S: ::dalembert::mechanism::Real>(c: &Self::Constants<S>, t: S, u: &[S], {arguments}, {last}) {{
        let _ = (c, t, u, {ignored}, &{used});
{body}    }}
"
        );
    };
    let array = format!("out: &mut [S; {n}]");
    let slice = "out: &mut [S]";
    function("mass_matrix", State::Position, slice, stores(&entries(&program.mass)));
    function("bias", State::Velocity, &array, stores(&program.bias));
    function("residual", State::Acceleration, &array, stores(&program.residual));
    let into = |target: &str, list: &[Entry]| -> Vec<Use> {
        list.iter().enumerate().map(|(k, e)| Use::Store(format!("{target}[{k}]"), e.2)).collect()
    };
    let mut both = into("dq", &program.stiffness);
    both.extend(into("dv", &program.damping));
    function("jacobians", State::Acceleration, "dq: &mut [S], dv: &mut [S]", both);
    function("input_jacobian", State::Acceleration, slice, stores(&entries(&program.input)));
    function("invariants", State::Velocity, slice, stores(&program.invariants));
    function("outputs", State::Acceleration, slice, stores(&program.outputs));
    function("events", State::Acceleration, slice, stores(&program.events));
    let rates: Vec<Id> = program.event_rates.iter().map(|rate| rate.unwrap_or(Id::ZERO)).collect();
    function("event_rates", State::Acceleration, slice, stores(&rates));
    function("switches", State::Acceleration, slice, stores(&program.switch_pairs));
    let pairs: Vec<Id> = program.arguments.iter().flat_map(|a| [a.value, a.rate]).collect();
    function("arguments", State::Acceleration, slice, stores(&pairs));
    function("drawing", State::Velocity, slice, stores(&program.drawing));
    let body = bodies.body(&stores(&program.energy), "        ");
    let _ = write!(
        out,
        "
    fn energy<S: ::dalembert::mechanism::Real>(c: &Self::Constants<S>, t: S, u: &[S], q: &[S; {n}], v: &[S; {n}]) -> [S; 5] {{
        let _ = (c, t, u, q, v);
        let mut out = [S::ratio(0.0, 1.0); 5];
{body}        out
    }}
"
    );
    accelerations(out, program, bodies, n);
    momentum::balances(out, program, bodies, block);
    scenes(out, program, unhoisted, n);
    let _ = writeln!(out, "}}");
}

/// Which of q, v, a a function reads.
enum State {
    Position,
    Velocity,
    Acceleration,
}

fn constants_function(out: &mut String, program: &Program, bodies: &Bodies<'_>, constants: &[Id], block: usize) {
    let model = &program.model;
    let count = model.parameters.len();
    let mut lines = String::new();
    for (k, parameter) in model.parameters.iter().enumerate() {
        let value = access(parameter).replacen("self.", "lane(i).", 1);
        let _ = writeln!(lines, "        c[{k}] = S::gather(|i| {value});");
    }
    let first = block - program.switches.len();
    for k in first..block {
        let _ = writeln!(lines, "        c[{k}] = S::ratio(1.0, 1.0);");
    }
    for (k, id) in constants.iter().enumerate() {
        let _ = writeln!(lines, "        // c[{}] = {}", count + k, text(model, *id));
    }
    let uses: Vec<Use> =
        constants.iter().enumerate().map(|(k, id)| Use::Store(format!("c[{}]", count + k), *id)).collect();
    let body = bodies.body(&uses, "        ");
    let _ = write!(
        out,
        "
    fn constants<S: ::dalembert::mechanism::Real>(lane: impl Fn(usize) -> Self) -> Self::Constants<S> {{
        let _ = &lane;
        let mut c = [S::ratio(0.0, 1.0); {block}];
{lines}{body}        c
    }}
"
    );
}

fn accelerations(out: &mut String, program: &Program, bodies: &Bodies<'_>, n: usize) {
    let body = match &program.accelerations {
        Accelerations::Unrolled { values, pivots } => {
            let mut uses: Vec<Use> = pivots.iter().map(|(k, pivot, d)| Use::Pivot(*k, *pivot, *d)).collect();
            uses.extend(values.iter().enumerate().map(|(k, id)| Use::Store(format!("out[{k}]"), *id)));
            format!("{}        Ok(())\n", bodies.body(&uses, "        "))
        }
        Accelerations::Loop => {
            let packed = n * (n + 1) / 2;
            let mut uses: Vec<Use> =
                program.mass.iter().map(|(i, j, m)| Use::Store(format!("m[{}]", i * (i + 1) / 2 + j), *m)).collect();
            uses.extend(program.bias.iter().enumerate().map(|(k, id)| Use::Store(format!("out[{k}]"), *id)));
            format!(
                "        let mut m = [S::ratio(0.0, 1.0); {packed}];\n{}        ::dalembert::mechanism::solve_packed(&mut m, out)\n",
                bodies.body(&uses, "        ")
            )
        }
    };
    let _ = write!(
        out,
        "
    fn accelerations<S: ::dalembert::mechanism::Real>(c: &Self::Constants<S>, t: S, u: &[S], q: &[S; {n}], v: &[S; {n}], out: &mut [S; {n}]) -> Result<(), ::dalembert::mechanism::SingularMass> {{
        let _ = (c, t, u, q, v, &out);
{body}    }}
"
    );
}

/// Parameters by place, scenes, and the guess for an equilibrium.
fn scenes(out: &mut String, program: &Program, bodies: &Bodies<'_>, n: usize) {
    let model = &program.model;
    let values: Vec<String> = model.parameters.iter().map(access).collect();
    let _ = write!(out, "\n    fn parameters(&self) -> Vec<f64> {{\n        vec![{}]\n    }}\n", values.join(", "));
    let arms: String =
        values.iter().enumerate().map(|(k, v)| format!("            {k} => Some(&mut {v}),\n")).collect();
    let _ = write!(
        out,
        "\n    fn parameter_mut(&mut self, index: usize) -> Option<&mut f64> {{\n        match index {{\n{arms}            _ => None,\n        }}\n    }}\n"
    );
    let head = "        type S = f64;\n        let c = self.parameters();\n        let _ = (&c, S::ratio(0.0, 1.0));\n";
    let (mut sets, mut starts) = (String::new(), String::new());
    for (k, scene) in model.scenes.iter().enumerate() {
        if !scene.set.is_empty() {
            let uses: Vec<Use> =
                scene.set.iter().enumerate().map(|(s, (_, id))| Use::Store(format!("let x_{s}"), *id)).collect();
            let pairs: Vec<String> = scene.set.iter().enumerate().map(|(s, (i, _))| format!("({i}, x_{s})")).collect();
            let _ = write!(
                sets,
                "            {k} => {{\n{}                vec![{}]\n            }}\n",
                bodies.body(&uses, "                "),
                pairs.join(", ")
            );
        }
        let mut uses =
            vec![Use::Store("x.until".to_owned(), scene.until), Use::Store("x.tolerance".to_owned(), scene.tolerance)];
        let rest = |name: &str, list: &[Id]| -> Vec<Use> {
            let nonzero = list.iter().enumerate().filter(|(_, id)| **id != Id::ZERO);
            nonzero.map(|(i, id)| Use::Store(format!("x.{name}[{i}]"), *id)).collect()
        };
        uses.extend(rest("q", &scene.q));
        uses.extend(rest("v", &scene.v));
        let mut body = bodies.body(&uses, "                ");
        if let Some(every) = scene.every {
            body += &bodies.body(&[Use::Store("let every".to_owned(), every)], "                ");
            body += "                x.every = Some(every);\n";
        }
        let arm = if k == 0 { "_".to_owned() } else { k.to_string() };
        let text = format!("            {arm} => {{\n{body}            }}\n");
        // The default scene's arm matches everything else, so it comes last.
        starts = if k == 0 { text } else { text + &starts };
    }
    let _ = write!(
        out,
        "\n    fn scene_parameters(&self, scene: usize) -> Vec<(usize, f64)> {{\n        use ::dalembert::mechanism::Real as _;\n{head}        match scene {{\n{sets}            _ => Vec::new(),\n        }}\n    }}\n"
    );
    let _ = write!(
        out,
        "\n    fn scene(&self, scene: usize) -> ::dalembert::mechanism::Scene {{\n        use ::dalembert::mechanism::Real as _;\n{head}        let mut x = ::dalembert::mechanism::Scene {{ q: vec![0.0; {n}], v: vec![0.0; {n}], until: 0.0, tolerance: 0.0, every: None }};\n        match scene {{\n{starts}        }}\n        x\n    }}\n"
    );
    let guess: Vec<Use> = model
        .equilibrium
        .iter()
        .enumerate()
        .filter(|(_, id)| **id != Id::ZERO)
        .map(|(k, id)| Use::Store(format!("out[{k}]"), *id))
        .collect();
    let _ = write!(
        out,
        "\n    fn equilibrium_guess(&self) -> [f64; {n}] {{\n        use ::dalembert::mechanism::Real as _;\n{head}        let mut out = [0.0; {n}];\n        let _ = &mut out;\n{}        out\n    }}\n",
        bodies.body(&guess, "        ")
    );
}

impl Program {
    /// Every expression that some generated function computes from a state.
    fn roots(&self) -> Vec<Id> {
        let entries = [&self.mass, &self.stiffness, &self.damping, &self.input];
        let mut roots: Vec<Id> = entries.into_iter().flatten().map(|e| e.2).collect();
        let lists = [
            &self.bias,
            &self.residual,
            &self.invariants,
            &self.outputs,
            &self.events,
            &self.switch_pairs,
            &self.drawing,
        ];
        roots.extend(lists.into_iter().flatten());
        roots.extend(self.energy);
        roots.extend(self.signals.iter().flatten());
        roots.extend(self.event_rates.iter().flatten());
        roots.extend(self.arguments.iter().flat_map(|a| [a.value, a.rate]));
        for system in &self.momentum {
            roots.extend(system.matrix.iter().map(|e| e.2).chain(system.right.iter().copied()));
        }
        if let Accelerations::Unrolled { values, pivots } = &self.accelerations {
            roots.extend(values);
            roots.extend(pivots.iter().flat_map(|p| [p.1, p.2]));
        }
        roots
    }

    /// True when some output contains an acceleration.
    pub fn outputs_use_accelerations(&self) -> bool {
        let symbols = self.model.graph.symbols(self.outputs.iter().copied());
        symbols.into_iter().any(|s| matches!(s, Symbol::Acceleration(_)))
    }
}
