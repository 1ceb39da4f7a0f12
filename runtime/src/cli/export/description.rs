//! `modelDescription.xml`: the variables of an FMU, their units and starts.

use std::collections::{BTreeSet, HashSet};
use std::fmt::Write;

use dalembert_symbolic::language::parse_unit;
use dalembert_symbolic::lower::Program;
use dalembert_symbolic::print::{CText, si_unit};

use super::fmu::used_rates;

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
    /// The relative tolerance of its own integration.
    pub tolerance: f64,
}

/// A variable.
struct Variable {
    reference: usize,
    name: String,
    unit: String,
    /// Attributes other than those, and than the start.
    attributes: String,
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

/// The text of the file.
pub fn description(program: &Program, code: &CText, start: &Start) -> String {
    let (model, references) = (&program.model, References::of(program));
    let variables = variables(program, &references, start);
    let units: BTreeSet<&str> = variables.iter().map(|v| v.unit.as_str()).filter(|unit| !unit.is_empty()).collect();
    let mut out = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"3.0\" modelName=\"{}\" description=\"{}\" generationTool=\"dalembert {}\" instantiationToken=\"{}\" variableNamingConvention=\"flat\">\n",
        escaped(&model.name),
        escaped(model.about.trim()),
        env!("CARGO_PKG_VERSION"),
        start.token
    );
    for (kind, more) in [
        ("ModelExchange", " needsCompletedIntegratorStep=\"true\""),
        ("CoSimulation", " canHandleVariableCommunicationStepSize=\"true\""),
    ] {
        let _ = writeln!(
            out,
            "  <{kind} modelIdentifier=\"{}\" canGetAndSetFMUState=\"true\" providesDirectionalDerivatives=\"{}\"{more}/>",
            code.prefix, code.has_slopes
        );
    }
    out += "  <UnitDefinitions>\n";
    units.iter().for_each(|unit| out += &unit_definition(unit));
    let _ = write!(
        out,
        "  </UnitDefinitions>\n  <LogCategories>\n    <Category name=\"logStatusError\"/>\n  </LogCategories>\n  <DefaultExperiment startTime=\"0\" stopTime=\"{:?}\" tolerance=\"{:?}\"/>\n  <ModelVariables>\n",
        start.until, start.tolerance
    );
    variables.iter().for_each(|variable| out += &variable.text());
    if program.phases() > 0 {
        let names: Vec<String> = model.phases.iter().enumerate().map(|(k, p)| format!("{k} {}", p.name)).collect();
        let _ = writeln!(
            out,
            "    <Int32 name=\"{}\" valueReference=\"{}\" causality=\"local\" variability=\"discrete\" initial=\"exact\" start=\"{}\" description=\"{}\"/>",
            unique("phase", &variables.iter().map(|v| v.name.clone()).collect()),
            references.phase,
            start.phase,
            escaped(&names.join(", "))
        );
    }
    out += "  </ModelVariables>\n  <ModelStructure>\n";
    out += &structure(program, &references);
    out + "  </ModelStructure>\n</fmiModelDescription>\n"
}

/// A name that none of these has.
fn unique(wanted: &str, taken: &HashSet<String>) -> String {
    let mut name = wanted.to_owned();
    while taken.contains(&name) {
        name.push('_');
    }
    name
}

impl Variable {
    fn text(&self) -> String {
        let start = self.start.map_or_else(String::new, |start| format!(" start=\"{start:?}\""));
        let unit = if self.unit.is_empty() { String::new() } else { format!(" unit=\"{}\"", escaped(&self.unit)) };
        let about =
            if self.about.is_empty() { String::new() } else { format!(" description=\"{}\"", escaped(&self.about)) };
        format!(
            "    <Float64 name=\"{}\" valueReference=\"{}\" {}{unit}{start}{about}/>\n",
            escaped(&self.name),
            self.reference,
            self.attributes
        )
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
        attributes: "causality=\"independent\" variability=\"continuous\"".to_owned(),
        start: None,
        about: String::new(),
    }];
    out.extend(states(program, at, start));
    let variable = |reference, name: &str, unit: &Option<String>, attributes: &str, start, about: &str| Variable {
        reference,
        name: name.to_owned(),
        unit: in_si(unit),
        attributes: attributes.to_owned(),
        start,
        about: about.to_owned(),
    };
    let model = &program.model;
    let tunable = "causality=\"parameter\" variability=\"tunable\" initial=\"exact\"";
    let parameters = model.parameters.iter().zip(&start.parameters).zip(at.parameters..);
    out.extend(parameters.map(|((p, value), k)| variable(k, &p.name, &p.unit, tunable, Some(*value), "")));
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
    let outputs = model.outputs.iter().flat_map(|o| {
        let axis = |k: usize| {
            if o.value.len() == 1 {
                String::new()
            } else {
                format!(".{}", ["x", "y", "z"].get(k).map_or((k + 1).to_string(), |axis| (*axis).to_owned()))
            }
        };
        (0..o.value.len()).map(move |k| (format!("{}{}", o.name, axis(k)), &o.unit))
    });
    out.extend(outputs.zip(at.outputs..).map(|((name, unit), k)| variable(k, &name, unit, output, None, "")));
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
        attributes: "causality=\"output\" variability=\"continuous\" initial=\"exact\"".to_owned(),
        start: Some(*value),
        about: String::new(),
    });
    let derivatives = all.iter().enumerate().map(|(k, (name, unit))| Variable {
        reference: at.derivatives + k,
        name: format!("der({name})"),
        unit: per_second(unit),
        attributes: format!(
            "causality=\"local\" variability=\"continuous\" initial=\"calculated\" derivative=\"{}\"",
            at.states + k
        ),
        start: None,
        about: String::new(),
    });
    states.chain(derivatives).collect()
}

fn structure(program: &Program, at: &References) -> String {
    let element = |kind: &str, range: std::ops::Range<usize>| {
        range.map(|k| format!("    <{kind} valueReference=\"{k}\"/>\n")).collect::<String>()
    };
    [
        element("Output", at.states..at.derivatives),
        element("Output", at.outputs..at.indicators),
        element("ContinuousStateDerivative", at.derivatives..at.parameters),
        element("InitialUnknown", at.outputs..at.indicators),
        element("InitialUnknown", at.derivatives..at.parameters),
        element("EventIndicator", at.indicators..at.indicators + program.model.events.len() + program.switches.len()),
    ]
    .concat()
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
