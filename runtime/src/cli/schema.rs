//! `schema`: what a model file may contain, as a JSON schema, for editors that complete and underline.
//!
//! Keys and shapes only; whether names exist, units fit and derivations agree is what `check` says.

use std::io::Write;

use clap::ArgMatches;
use serde_json::{Map, Value, json};

use super::{Problem, outputs};

/// A key with what it holds: the name of a definition, or `NAME*` for a mapping of names to them.
type Key = (&'static str, &'static str, &'static str);

const MODEL: &[Key] = &[
    ("name", "word", "The Rust type to generate, CartPendulum"),
    ("about", "word", "One paragraph"),
    ("sizes", "expression*", "Integers, overridden where the macro is called or by --size"),
    ("tables", "table*", "Functions of one or two arguments by points"),
    ("parameters", "value*", "A value, then a unit: `1.5 kg`; computed from others it is derived"),
    ("coordinates", "unit*", "Generalized coordinates with their units"),
    ("memory", "value*", "Values that are held until an event sets them"),
    ("noise", "noise*", "Normally distributed numbers, held from tick to tick"),
    ("states", "state*", "States of first order: the rate, or {unit, rate}, or {unit, equation}"),
    ("inputs", "expression*", "Functions of time, used like coordinates"),
    ("define", "value*", "Named scalars or vectors"),
    ("frames", "frame*", "Frames by their angle, in space by turns"),
    ("points", "value*", "Named positions"),
    ("bodies", "body*", "Particles and rigid bodies"),
    ("gravity", "value", "The acceleration of gravity, [0, -9.81 m/s^2]"),
    ("springs", "spring*", "Springs between points, or along a stretch"),
    ("dampers", "damper*", "Dampers between points, or of a rate"),
    ("forces", "force*", "Forces on bodies"),
    ("torques", "torque*", "Torques on bodies"),
    ("kinetic_energy", "expression", "Beside what bodies have"),
    ("potential_energy", "expression", "Beside what gravity and springs have"),
    ("dissipation", "expression", "Rayleigh's function D; Q = -dD/dq'"),
    ("generalized_forces", "value*", "Forces on coordinates"),
    ("constraints", "constraint*", "Equations that hold: `y = R`"),
    ("joints", "joint*", "Rows of constraints by the name of the joint that they make"),
    ("friction", "friction*", "What sticks and slips by itself"),
    ("contacts", "contact*", "What opens, closes and strikes by itself"),
    ("impacts", "word", "sequential, together or poisson: what contacts that strike at once do"),
    ("phases", "value*", "Which constraints hold when; the first is in force at the start"),
    ("events", "event*", "What is recorded, stops or changes the phase"),
    ("balances", "balances", "A second derivation: momentum balances, compared with Lagrange's equations"),
    ("conserved", "claim*", "What does not change; tested when the file compiles, watched by runs"),
    ("checks", "check*", "Identities that are tested when the file compiles"),
    ("sample", "value*", "Ranges of states at which is tested"),
    ("outputs", "value*", "What runs compute"),
    ("draw", "shapes", "What is animated"),
    ("motions", "motion*", "What is asked of motions: that they close, end somewhere, or follow a record"),
    ("scene", "scene", "Where a run starts, and how it goes"),
    ("scenes", "scene*", "Others by name; what they leave out is the first one's"),
    ("equilibrium", "value*", "Where the search for an equilibrium starts"),
];

const OBJECTS: &[(&str, &[Key])] = &[
    (
        "table",
        &[
            ("points", "points", "[[x, y], …], x rising; of two arguments {x: […], y: […], values: [[…], …]}"),
            ("file", "word", "Two or three columns of text beside the model file"),
            ("columns", "list", "Their names, [s, height] or [speed, throttle, torque]"),
            ("units", "list", "[m, mm], or three of two arguments"),
            ("smooth", "expression", "2: a cubic spline; 1: no steeper than the points; 0: straight"),
            ("periodic", "flag", "Whether it repeats itself; of two arguments x, y or true for both"),
        ],
    ),
    (
        "noise",
        &[
            ("every", "expression", "The time from tick to tick"),
            ("from", "expression", "The first tick [0]"),
            ("sigma", "expression", "The standard deviation, 2 N"),
            ("density", "expression", "Instead: the two-sided spectral density of white noise, 0.01 N^2*s"),
            ("seed", "expression", "A whole number, or a parameter [0]"),
            ("smooth", "expression", "0: held from tick to tick; 1: straight between them"),
        ],
    ),
    (
        "state",
        &[
            ("unit", "unit", "Of SI: A, K, m"),
            ("rate", "expression", "Its rate, without accelerations"),
            ("equation", "expression", "What its rate meets instead: `L*i' + R*i = u`"),
        ],
    ),
    (
        "frame",
        &[
            ("angle", "expression", "From the ground's x, or that of `from`, counterclockwise"),
            ("from", "expression", "Another frame"),
            (
                "rotate",
                "turns",
                "In space: [axis, angle], a list of such, {quaternion: [w, x, y, z]}, or a coordinate of kind `rotation`",
            ),
        ],
    ),
    (
        "body",
        &[
            ("mass", "expression", "2 kg"),
            ("position", "value", "Of the centre of mass"),
            ("inertia", "value", "About the centre of mass; in space three moments, or a tensor"),
            ("about", "value", "A point fixed in the body that `inertia` is about instead"),
            ("angle", "expression", "Counterclockwise"),
            ("frame", "expression", "The frame that turns with it"),
            ("loses", "exchange", "With which velocity mass leaves that `mass` says"),
            ("gains", "exchange", "The same of mass that comes"),
        ],
    ),
    (
        "exchange",
        &[
            ("velocity", "value", "Against the ground; absent: that of the body"),
            ("at", "value", "A point of the body"),
        ],
    ),
    (
        "spring",
        &[
            ("between", "list", "Two points"),
            ("stiffness", "expression", "k of k (length - rest)^2/2"),
            ("rest", "expression", "Its length without force"),
            ("energy", "expression", "As a function of `length`"),
            ("tension", "expression", "As a function of `length`"),
            ("stretch", "expression", "Of what it stretches, in the place of points"),
            ("on", "value", "The body it pulls"),
            ("from", "value", "The body it pulls from"),
            ("along", "value", "A direction"),
            ("at", "value", "A point"),
            ("axis", "value", "In space: the direction of its couple"),
            ("phase", "value", "When it acts"),
        ],
    ),
    (
        "damper",
        &[
            ("between", "list", "Two points"),
            ("rate", "expression", "In the place of points"),
            ("damping", "expression", "c of c times the rate"),
            ("on", "value", "The body it acts on"),
            ("from", "value", "The body it acts from"),
            ("along", "value", "A direction"),
            ("at", "value", "A point"),
            ("axis", "value", "In space: the direction of its couple"),
            ("phase", "value", "When it acts"),
        ],
    ),
    (
        "friction",
        &[
            ("rate", "expression", "The sliding rate, affine in the speeds"),
            ("on", "value", "The body it acts on"),
            ("from", "value", "The body it acts from"),
            ("at", "value", "A point"),
            ("along", "value", "A direction"),
            ("axis", "value", "In space: the direction of its couple"),
            ("limit", "expression", "The force of sliding"),
            ("static", "expression", "The largest force that sticks"),
        ],
    ),
    (
        "contact",
        &[
            ("gap", "expression", "Not negative"),
            ("on", "value", "The body that is pushed along `normal`"),
            ("from", "value", "The body that is pushed back"),
            ("at", "value", "The point where they touch"),
            ("normal", "value", "A direction"),
            ("friction", "expression", "The coefficient of sliding"),
            ("static", "expression", "The coefficient of sticking"),
            ("restitution", "expression", "In 0..1"),
        ],
    ),
    (
        "force",
        &[
            ("on", "value", "A body"),
            ("at", "value", "A point; the centre of mass if absent"),
            ("force", "value", "A vector"),
            ("from", "value", "The body that it acts back on"),
            ("reaction", "value", "The body or frame that it acts back on"),
            ("phase", "value", "When it acts"),
        ],
    ),
    (
        "torque",
        &[
            ("on", "value", "A body"),
            ("torque", "value", "Counterclockwise; in space a vector"),
            ("from", "value", "The body that it acts back on"),
            ("phase", "value", "When it acts"),
        ],
    ),
    (
        "joint",
        &[
            ("hinge", "list", "The two sides, bodies, frames or ground: points together, axes parallel"),
            ("ball", "list", "The two sides: points together"),
            ("universal", "list", "The two sides: points together, axes perpendicular"),
            ("cylinder", "list", "The two sides: axes on one line"),
            ("slider", "list", "The two sides: axes on one line, no turn about it"),
            ("screw", "list", "The two sides: axes on one line, `pitch` along it for a turn of 1 rad"),
            ("plane", "list", "The two sides: axes parallel, points in a plane across them"),
            ("weld", "list", "The two sides: nothing moves"),
            ("free", "list", "The two sides: everything does"),
            ("at", "value", "Its point on each side, [P, Q], or one that both have by the coordinates"),
            ("axis", "list", "Its axis on each side, [A.z, B.z]"),
            ("pitch", "expression", "Of a screw: the way for a turn of 1 rad"),
        ],
    ),
    (
        "event",
        &[
            ("when", "expression", "What vanishes"),
            ("every", "expression", "The period of a clock, at whose ticks it happens instead"),
            ("from", "expression", "The first tick [default: 0 s]"),
            ("on_set", "value", "The held value, or a list of them, that it follows instead when set"),
            ("direction", "word", "rising, falling or both"),
            ("if", "expression", "Counts only where this is not negative"),
            ("then", "value", "stop, record, a phase, {impact: e, along: constraint}, {set: {u: e}}, or a list"),
            ("phase", "value", "When it counts"),
        ],
    ),
    (
        "scene",
        &[
            ("start", "value*", "Coordinates and speeds"),
            ("until", "expression", "When a run ends"),
            ("tolerance", "expression", "Relative to what each coordinate goes through"),
            ("every", "expression", "Spacing of reported states"),
            ("phase", "expression", "In which it starts"),
            ("set", "value*", "Other values of parameters"),
            ("guess", "value*", "Where what must meet constraints is searched"),
            ("also", "value", "What the start meets beside them"),
            ("needs", "need", "What is wanted of it, and how exactly"),
        ],
    ),
    (
        "motion",
        &[
            ("scene", "word", "The scene whose keys it inherits, if not the first"),
            ("start", "value*", "Coordinates and speeds"),
            ("set", "value*", "Other values of parameters"),
            ("phase", "expression", "In which it starts"),
            ("tolerance", "expression", "Relative to what each coordinate goes through"),
            ("until", "expression", "When a run ends"),
            ("closes", "closing", "How it repeats itself"),
            ("energy", "expression", "Of a motion that closes"),
            ("unknown", "value*", "Parameters, coordinates, speeds and `until`, with guesses"),
            ("such_that", "value*", "What coordinates, rates and outputs are at the end"),
            ("maximise", "word", "What is as large as it can be at the end"),
            ("minimise", "word", "What is as small"),
            ("fit", "fit", "A record that it follows"),
        ],
    ),
    (
        "closing",
        &[
            ("period", "expression", "A guess; that of the inputs where something depends on time"),
            ("part", "expression", "1/k of the period, after which it closes"),
            ("at", "word", "The event after which it closes"),
            ("count", "expression", "Which of its occurrences"),
            ("exchange", "value*", "Coordinates and phases that come in the place of others"),
            ("mirror", "value", "Coordinates with opposite signs, or all"),
            ("shift", "value", "Coordinates that may differ by any amount"),
            ("turn", "value*", "Angles that are so many turns more"),
            ("from", "value", "{exchange, mirror}: what the start is with time reversed; {} is rest"),
            ("to", "value", "The same of the end"),
        ],
    ),
    ("fit", &[("file", "word", "A table of text beside the model file"), ("columns", "value*", "{t: t, x: x}")]),
    (
        "need",
        &[
            ("outputs", "value", "Coordinates, rates, outputs"),
            ("within", "expression", "In parts of their ranges"),
            ("absolute", "value*", "Amounts by which some may be off instead"),
        ],
    ),
];

/// Prints the schema.
pub fn run(options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    outputs::put(options, &["json"], "", text().as_bytes(), out)
}

/// The schema as text.
pub fn text() -> String {
    serde_json::to_string_pretty(&schema()).unwrap_or_default() + "\n"
}

/// What a model file may contain.
pub fn schema() -> Value {
    let text = || json!({"type": ["string", "number"]});
    let anything = json!({"type": ["string", "number", "array", "object", "null"]});
    let mut definitions = Map::new();
    for (name, keys) in OBJECTS {
        definitions.insert((*name).to_owned(), object(keys));
    }
    // A state may be its rate alone.
    if let Some(Value::Object(state)) = definitions.get_mut("state") {
        state.insert("type".to_owned(), json!(["object", "string", "number"]));
    }
    for (name, shape) in [
        ("word", text()),
        ("flag", json!({"type": ["boolean", "string"]})),
        ("expression", text()),
        ("value", anything.clone()),
        ("unit", json!({"type": ["string", "number", "null"]})),
        ("list", json!({"type": ["array", "string"]})),
        ("points", json!({"type": ["array", "object"]})),
        ("turns", json!({"type": ["array", "string", "object"]})),
        ("constraint", anything.clone()),
        ("balances", json!({"type": "object"})),
        ("claim", anything.clone()),
        ("check", anything),
        ("shapes", json!({"type": "array", "items": {"type": "object"}})),
    ] {
        definitions.insert(name.to_owned(), shape);
    }
    let mut schema = Map::new();
    schema.insert("$schema".to_owned(), json!("https://json-schema.org/draft/2020-12/schema"));
    schema.insert("title".to_owned(), json!("A mechanism for dalembert"));
    let Value::Object(model) = object(MODEL) else { return Value::Null };
    schema.extend(model);
    schema.insert("required".to_owned(), json!(["name"]));
    schema.insert("anyOf".to_owned(), json!([{"required": ["coordinates"]}, {"required": ["states"]}]));
    schema.insert("$defs".to_owned(), Value::Object(definitions));
    Value::Object(schema)
}

fn object(keys: &[Key]) -> Value {
    let one = |(key, holds, about): &Key| {
        let refer = |name: &str| format!("#/$defs/{name}");
        let shape = match holds.strip_suffix('*') {
            Some(each) => {
                json!({"type": ["object", "null"], "additionalProperties": {"$ref": refer(each)}, "description": about})
            }
            None => json!({"$ref": refer(holds), "description": about}),
        };
        ((*key).to_owned(), shape)
    };
    let properties: Map<String, Value> = keys.iter().map(one).collect();
    json!({"type": "object", "additionalProperties": false, "properties": properties})
}

#[cfg(test)]
mod tests {
    use dalembert_symbolic::file::{Node, read};
    use dalembert_symbolic::model::load;

    use super::*;

    /// The keys that the reader names where one is unknown.
    fn known(text: &str) -> Vec<String> {
        let problems = load(text, &[]).expect_err("an unknown key");
        let help = &problems.iter().find(|problem| problem.code == "E301").expect("an unknown key").help;
        let keys = help.strip_prefix("it is one of ").unwrap_or_else(|| panic!("{text}: {help}"));
        keys.split(", ").map(|key| key.trim_matches('`').to_owned()).collect()
    }

    #[test]
    fn keys_are_those_that_the_reader_knows() {
        let names = |keys: &[Key]| keys.iter().map(|key| key.0.to_owned()).collect::<Vec<_>>();
        assert_eq!(known("qqqqqqqq: 1\nname: A\ncoordinates: {x: }\n"), names(MODEL));
        for (object, keys) in OBJECTS {
            let section = match *object {
                "body" => "bodies: {a: {qqqqqqqq: 1}}".to_owned(),
                "scene" => "scene: {qqqqqqqq: 1}".to_owned(),
                "exchange" => "bodies: {a: {mass: 1, position: [0, x], loses: {qqqqqqqq: 1}}}".to_owned(),
                "noise" => "noise: {a: {qqqqqqqq: 1}}".to_owned(),
                "closing" => "motions: {a: {closes: {qqqqqqqq: 1}}}".to_owned(),
                "fit" => "motions: {a: {fit: {qqqqqqqq: 1}}}".to_owned(),
                "need" => "scene: {needs: {qqqqqqqq: 1}}".to_owned(),
                "friction" => "friction: {a: {qqqqqqqq: 1}}".to_owned(),
                other => format!("{other}s: {{a: {{qqqqqqqq: 1}}}}"),
            };
            let mut found = known(&format!("name: A\ncoordinates: {{x: }}\nkinetic_energy: x'^2/2\n{section}\n"));
            let mut said = names(keys);
            found.sort();
            said.sort();
            assert_eq!(found, said, "{object}");
        }
    }

    /// Whether a file fits a schema, as far as this one says anything.
    fn misfit(node: &Node, schema: &Value, whole: &Value) -> Option<String> {
        let schema = match schema["$ref"].as_str() {
            Some(name) => &whole["$defs"][name.strip_prefix("#/$defs/")?],
            None => schema,
        };
        let kind = match node {
            Node::Map(_) => vec!["object"],
            Node::List(_) => vec!["array"],
            Node::Null => vec!["null"],
            Node::Scalar(text) if text == "true" || text == "false" => vec!["boolean"],
            Node::Scalar(text) if text.parse::<f64>().is_ok() => vec!["number"],
            Node::Scalar(_) => vec!["string"],
        };
        let types: Vec<&str> = match &schema["type"] {
            Value::Array(types) => types.iter().filter_map(Value::as_str).collect(),
            Value::String(one) => vec![one],
            _ => return None,
        };
        if !kind.iter().any(|kind| types.contains(kind)) {
            return Some(format!("{node:?} is {kind:?}, not {types:?}"));
        }
        let Node::Map(entries) = node else { return None };
        entries.iter().find_map(|(key, inner)| match (&schema["properties"][key], &schema["additionalProperties"]) {
            (Value::Null, Value::Bool(false)) => Some(format!("no key {key}")),
            (Value::Null, Value::Null) => None,
            (Value::Null, each) => misfit(inner, each, whole),
            (own, _) => misfit(inner, own, whole),
        })
    }

    #[test]
    fn every_model_of_the_library_fits() {
        let schema = schema();
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models");
        let mut seen = 0;
        for file in std::fs::read_dir(folder).expect("the library").map(|file| file.expect("a file").path()) {
            if file.extension().is_some_and(|extension| extension == "yaml") {
                let text = std::fs::read_to_string(&file).expect("text");
                let misfit = misfit(&read(&text).expect("YAML"), &schema, &schema);
                assert_eq!(misfit, None, "{}", file.display());
                seen += 1;
            }
        }
        assert!(seen > 50);
        let wrong = read("name: A\ncoordinates: {x: }\nbodies: {a: {mas: 1}}\n").expect("YAML");
        assert_eq!(super::tests::misfit(&wrong, &schema, &schema), Some("no key mas".to_owned()));
    }
}
