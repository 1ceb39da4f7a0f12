//! The generated type: a field for each free parameter, its default, and a method for each derived one.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::body::Bodies;
use super::documentation::{about, tested};
use super::function::of_constants;
use super::literal::float;
use super::rust::UNJUDGED;
use super::units::si_unit;
use super::words::documentation;
use crate::lower::Program;
use crate::model::{Parameter, field_name, is_snake_case, method_name, text};

/// The struct and its default.
pub(super) fn parameters(program: &Program, name: &str) -> String {
    let fields = fields(&program.model.parameters);
    let mut out = documentation(&format!("{}\n\n{}", about(&program.model.about, name), tested(program)), "");
    out += attributes(fields.iter().map(|f| f.name.as_str()));
    let _ = writeln!(out, "#[derive(Clone, Debug, PartialEq)]\npub struct {name} {{");
    for field in &fields {
        let unit = field.unit.as_deref().map_or_else(|| "no unit".to_owned(), si_unit);
        out += &documentation(&format!("`{}`, {unit}.", field.label).replace('\n', " "), "    ");
        let _ = writeln!(out, "    pub {}: {},", field.name, field.kind);
    }
    let _ = writeln!(
        out,
        "}}\n\n{UNJUDGED}impl ::core::default::Default for {name} {{\n    fn default() -> Self {{\n        Self {{"
    );
    for field in &fields {
        let _ = writeln!(out, "            {}: {},", field.name, field.default);
    }
    let _ = writeln!(out, "        }}\n    }}\n}}\n");
    out
}

/// What rustc is asked to allow where names of the file are not in Rust's style.
fn attributes<'a>(mut names: impl Iterator<Item = &'a str>) -> &'static str {
    if names.all(is_snake_case) { "" } else { "#[allow(non_snake_case)]\n" }
}

/// A method for each derived parameter.
pub(super) fn derived(program: &Program, name: &str, bodies: &Bodies<'_>) -> String {
    let model = &program.model;
    let scalar: Vec<_> = model.derived.iter().filter(|d| !d.name.contains('[')).collect();
    if scalar.is_empty() {
        return String::new();
    }
    let (n, rows) = (model.coordinates.len(), program.constraints.len());
    let names: Vec<String> = scalar.iter().map(|d| method_name(&d.name)).collect();
    let mut out = format!("\n{UNJUDGED}{}impl {name} {{\n", attributes(names.iter().map(String::as_str)));
    for (derived, name) in scalar.iter().zip(&names) {
        let unit = derived.unit.as_deref();
        let unit = unit.map_or_else(|| "unit from what it is computed from".to_owned(), si_unit);
        let words = format!("`{} = {}`, {unit}.", derived.name, text(model, derived.value));
        let function = of_constants(bodies, "value", &[derived.value], "        ");
        let parameters = format!("<Self as ::dalembert::mechanism::Mechanism<{n}, {rows}>>::parameters(self)");
        let _ = write!(
            out,
            "{}    #[must_use]\n    pub fn {name}(&self) -> f64 {{\n{function}        let [x] = value(&{parameters});\n        x\n    }}\n",
            documentation(&words.replace('\n', " "), "    "),
        );
    }
    out + "}\n"
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
    let mut families: BTreeMap<&str, BTreeMap<&[i64], f64>> = BTreeMap::new();
    for parameter in parameters {
        if let Some(family) = &parameter.family {
            families.entry(&family.name).or_default().insert(&family.indices, parameter.default);
        }
    }
    let mut fields: Vec<Field> = Vec::new();
    for parameter in parameters {
        let (label, (kind, default)) = match &parameter.family {
            None => (&parameter.name, ("f64".to_owned(), float(parameter.default))),
            Some(family) => match families.remove(family.name.as_str()) {
                Some(members) => (&family.name, array(&members, &family.ranges, &mut Vec::new())),
                // Its field is there already.
                None => continue,
            },
        };
        fields.push(Field {
            name: field_name(label),
            label: label.clone(),
            kind,
            default,
            unit: parameter.unit.clone(),
        });
    }
    fields
}

/// The type and the value of a nested array over the ranges; 0 where a family has no member.
fn array(members: &BTreeMap<&[i64], f64>, ranges: &[(i64, i64)], indices: &mut Vec<i64>) -> (String, String) {
    let Some(&(low, high)) = ranges.get(indices.len()) else {
        return ("f64".to_owned(), float(members.get(indices.as_slice()).copied().unwrap_or(0.0)));
    };
    let mut inner = String::new();
    let mut values = Vec::new();
    for index in low..=high {
        indices.push(index);
        let (kind, value) = array(members, ranges, indices);
        indices.pop();
        inner = kind;
        values.push(value);
    }
    (format!("[{inner}; {}]", values.len()), format!("[{}]", values.join(", ")))
}

/// The field of a parameter, with its place in an array: `m`, `k[2][0]`.
pub(super) fn field(parameter: &Parameter) -> String {
    match &parameter.family {
        None => field_name(&parameter.name),
        Some(family) => {
            let places: String =
                family.indices.iter().zip(&family.ranges).map(|(i, (low, _))| format!("[{}]", i - low)).collect();
            field_name(&family.name) + &places
        }
    }
}
