//! `modelDescription.xml`: the variables of an FMU, their units and starts.

mod fmi2;
mod fmi3;

use std::collections::{BTreeSet, HashSet};
use std::ops::Range;

use dalembert_symbolic::expr::vectors::axes;
use dalembert_symbolic::language::parse_unit;
use dalembert_symbolic::lower::Program;
use dalembert_symbolic::model::Model;
use dalembert_symbolic::print::{CText, si_unit};

use super::fmu::{Fmi, used_rates};
use super::tables::is_of_ticks;

/// Where a simulation begins.
pub struct Start {
    /// What the importer must know to make an instance.
    pub token: String,
    /// Free parameters.
    pub parameters: Vec<f64>,
    /// Generalized coordinates, on the constraints.
    pub q: Vec<f64>,
    /// Their rates likewise.
    pub v: Vec<f64>,
    /// Held values.
    pub memory: Vec<f64>,
    /// Inputs as the file has them then: u, u', u'' of each.
    pub inputs: Vec<f64>,
    /// The phase.
    pub phase: usize,
    /// The end.
    pub until: f64,
    /// How long the scene goes on.
    pub span: f64,
    /// The relative tolerance of its own integration.
    pub tolerance: f64,
}

/// A variable.
struct Variable {
    reference: usize,
    name: String,
    unit: String,
    /// Causality, variability and the like.
    attributes: &'static str,
    /// The state of which it is the derivative, by its value reference.
    derivative_of: Option<usize>,
    start: Option<f64>,
    about: String,
}

/// Value references in the order of the shared C.
struct References {
    states: usize,
    derivatives: usize,
    parameters: usize,
    inputs: usize,
    memory: usize,
    outputs: usize,
    indicators: usize,
    phase: usize,
}

impl References {
    fn of(program: &Program) -> References {
        let model = &program.model;
        let states = model.mechanical() + model.coordinates.len();
        let derivatives = 1 + states;
        let parameters = derivatives + states;
        let inputs = parameters + model.parameters.len();
        let memory = inputs + 3 * model.inputs.len();
        let outputs = memory + model.memory.len();
        let indicators = outputs + program.outputs.len();
        let phase = indicators + model.events.len() + program.switches.len();
        References { states: 1, derivatives, parameters, inputs, memory, outputs, indicators, phase }
    }
}

/// What both versions of FMI describe, each in its own words.
struct Description<'a> {
    model: &'a Model,
    start: &'a Start,
    /// What names of files and functions begin with.
    prefix: &'a str,
    has_slopes: bool,
    /// Numbers, in the order of their value references, which have gaps.
    variables: Vec<Variable>,
    /// The phase, where there are several.
    phase: Option<Phase>,
    /// Value references of the states, the rates of these, outputs beside them, and event indicators.
    states: Range<usize>,
    derivatives: Range<usize>,
    outputs: Range<usize>,
    indicators: Range<usize>,
}

/// The only whole number.
struct Phase {
    reference: usize,
    name: String,
    /// Which phases there are.
    about: String,
}

/// The text of the file.
pub fn description(fmi: Fmi, program: &Program, code: &CText, start: &Start, sources: &[String]) -> String {
    let (model, references) = (&program.model, References::of(program));
    let variables = variables(program, &references, start);
    let phase = (program.phases() > 0).then(|| {
        let names: Vec<String> = model.phases.iter().enumerate().map(|(k, p)| format!("{k} {}", p.name)).collect();
        let taken = variables.iter().map(|variable| variable.name.clone()).collect();
        Phase { reference: references.phase, name: unique("phase", &taken), about: names.join(", ") }
    });
    let all = Description {
        model,
        start,
        prefix: &code.prefix,
        has_slopes: code.has_slopes,
        variables,
        phase,
        states: references.states..references.derivatives,
        derivatives: references.derivatives..references.parameters,
        outputs: references.outputs..references.indicators,
        indicators: references.indicators..references.phase,
    };
    match fmi {
        Fmi::Two => fmi2::text(&all, sources),
        Fmi::Three => fmi3::text(&all),
    }
}

impl Description<'_> {
    /// Attributes of the whole, but for the version and its token.
    fn head(&self) -> String {
        format!(
            "modelName=\"{}\" description=\"{}\" generationTool=\"dalembert {}\" variableNamingConvention=\"flat\"",
            escaped(&self.model.name),
            escaped(self.model.about.trim()),
            env!("CARGO_PKG_VERSION"),
        )
    }

    /// Units, categories of messages, and the experiment.
    fn common(&self) -> String {
        let units = self.variables.iter().map(|variable| variable.unit.as_str()).filter(|unit| !unit.is_empty());
        let units: String = units.collect::<BTreeSet<&str>>().into_iter().map(unit_definition).collect();
        format!(
            "  <UnitDefinitions>\n{units}  </UnitDefinitions>\n  <LogCategories>\n    <Category name=\"logStatusError\"/>\n  </LogCategories>\n  <DefaultExperiment startTime=\"0\" stopTime=\"{:?}\" tolerance=\"{:?}\"/>\n",
            self.start.until, self.start.tolerance
        )
    }
}

/// A name that none of these has.
fn unique(wanted: &str, taken: &HashSet<String>) -> String {
    let mut name = wanted.to_owned();
    while taken.contains(&name) {
        name.push('_');
    }
    name
}

/// An attribute; nothing where its value is empty.
fn attribute(name: &str, value: &str) -> String {
    if value.is_empty() { String::new() } else { format!(" {name}=\"{}\"", escaped(value)) }
}

impl Variable {
    /// Its start as a value, empty where it has none.
    fn starts_at(&self) -> String {
        self.start.map_or_else(String::new, |start| format!("{start:?}"))
    }
}

/// What is added to a unit by a derivative.
fn per_second(unit: &str) -> String {
    match unit {
        "" | "1" => "1/s".to_owned(),
        unit => format!("{unit}/s"),
    }
}

fn in_si(unit: &Option<String>) -> String {
    unit.as_deref().map(si_unit).filter(|unit| unit != "1").unwrap_or_default()
}

fn variables(program: &Program, at: &References, start: &Start) -> Vec<Variable> {
    let mut out = vec![Variable {
        reference: 0,
        name: "time".to_owned(),
        unit: "s".to_owned(),
        attributes: "causality=\"independent\" variability=\"continuous\"",
        derivative_of: None,
        start: None,
        about: String::new(),
    }];
    out.extend(states(program, at, start));
    let variable = |reference, name: &str, unit: &Option<String>, attributes, start, about: &str| Variable {
        reference,
        name: name.to_owned(),
        unit: in_si(unit),
        attributes,
        derivative_of: None,
        start,
        about: about.to_owned(),
    };
    let model = &program.model;
    let tunable = "causality=\"parameter\" variability=\"tunable\" initial=\"exact\"";
    let fixed = "causality=\"parameter\" variability=\"fixed\" initial=\"exact\"";
    let parameters = model.parameters.iter().zip(&start.parameters).enumerate();
    out.extend(parameters.map(|(k, (p, value))| {
        let kind = if is_of_ticks(program, k) { fixed } else { tunable };
        variable(at.parameters + k, &p.name, &p.unit, kind, Some(*value), "")
    }));
    let input = "causality=\"input\" variability=\"continuous\"";
    let orders = (0..model.inputs.len()).map(|k| (k, 0)).chain(used_rates(program));
    out.extend(orders.map(|(k, order)| {
        let (place, name) = (3 * k + order, format!("{}{}", model.inputs[k].name, "'".repeat(order)));
        variable(
            at.inputs + place,
            &name,
            &None,
            input,
            Some(start.inputs[place]),
            "the model file's function of time until it is set",
        )
    }));
    let held = "causality=\"local\" variability=\"discrete\" initial=\"exact\"";
    let memory = model.memory.iter().zip(&start.memory).zip(at.memory..);
    out.extend(memory.map(|((m, value), k)| variable(k, &m.name, &m.unit, held, Some(*value), "")));
    let output = "causality=\"output\" variability=\"continuous\" initial=\"calculated\"";
    let outputs = output_names(model).zip(at.outputs..);
    out.extend(outputs.map(|((name, unit), k)| variable(k, &name, unit, output, None, "")));
    let local = "causality=\"local\" variability=\"continuous\" initial=\"calculated\"";
    let events = model.events.iter().map(|event| format!("event {}", event.name));
    let switches = (1..=program.switches.len()).map(|k| format!("discontinuity {k}"));
    out.extend(
        events
            .chain(switches)
            .zip(at.indicators..)
            .map(|(name, k)| variable(k, &name, &None, local, None, "0 where it happens")),
    );
    name_apart(&mut out);
    out
}

/// Outputs component by component, with their units.
fn output_names(model: &Model) -> impl Iterator<Item = (String, &Option<String>)> {
    model.outputs.iter().flat_map(|o| {
        let axis = |k: usize| {
            if o.value.len() == 1 { String::new() } else { format!(".{}", axes(o.value.len())[k]) }
        };
        (0..o.value.len()).map(move |k| (format!("{}{}", o.name, axis(k)), &o.unit))
    })
}

/// Gives every variable a name of its own.
fn name_apart(variables: &mut [Variable]) {
    let mut taken = HashSet::new();
    for variable in variables {
        variable.name = unique(&variable.name, &taken);
        taken.insert(variable.name.clone());
    }
}

/// Coordinates with their rates, states of first order, and the derivatives of all.
fn states(program: &Program, at: &References, start: &Start) -> Vec<Variable> {
    let model = &program.model;
    let (mechanical, n) = (model.mechanical(), model.coordinates.len());
    let places = model.coordinates[..mechanical].iter().map(|c| (c.name.clone(), in_si(&c.unit)));
    let rates = model.coordinates[..mechanical].iter().map(|c| (format!("{}'", c.name), per_second(&in_si(&c.unit))));
    let own = model.states.iter().map(|state| (state.name.clone(), in_si(&state.unit)));
    let all: Vec<(String, String)> = places.chain(rates).chain(own).collect();
    let values = start.q[..mechanical].iter().chain(&start.v[..n]);
    let states = all.iter().zip(values).enumerate().map(|(k, ((name, unit), value))| Variable {
        reference: at.states + k,
        name: name.clone(),
        unit: unit.clone(),
        attributes: "causality=\"output\" variability=\"continuous\" initial=\"exact\"",
        derivative_of: None,
        start: Some(*value),
        about: String::new(),
    });
    let derivatives = all.iter().enumerate().map(|(k, (name, unit))| Variable {
        reference: at.derivatives + k,
        name: format!("der({name})"),
        unit: per_second(unit),
        attributes: "causality=\"local\" variability=\"continuous\" initial=\"calculated\"",
        derivative_of: Some(at.states + k),
        start: None,
        about: String::new(),
    });
    states.chain(derivatives).collect()
}

/// A unit by its exponents, where these are whole.
fn unit_definition(unit: &str) -> String {
    let name = escaped(unit);
    let Ok(known) = parse_unit(unit) else { return format!("    <Unit name=\"{name}\"/>\n") };
    if known.dimension.iter().any(|halves| halves % 2 != 0) {
        return format!("    <Unit name=\"{name}\"/>\n");
    }
    let exponents = ["kg", "m", "s", "A", "K"].into_iter().zip(known.dimension).filter(|(_, halves)| *halves != 0);
    let mut bases: String = exponents.map(|(base, halves)| format!(" {base}=\"{}\"", halves / 2)).collect();
    if unit == "rad" || unit.starts_with("rad/") {
        bases += " rad=\"1\"";
    }
    format!("    <Unit name=\"{name}\">\n      <BaseUnit{bases}/>\n    </Unit>\n")
}

/// Text in an attribute.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}
