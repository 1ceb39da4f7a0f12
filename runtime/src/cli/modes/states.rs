//! `modes` of mechanisms with states of first order: A with its eigenvalues and shapes.

use std::f64::consts::TAU;
use std::io::Write;

use clap::ArgMatches;
use clap::parser::ValueSource;
use nalgebra::{Complex, DMatrix};
use serde_json::{Value, json};

use super::super::json::{number, object};
use super::super::load::Loaded;
use super::super::set_up::Reader;
use super::super::{Problem, json};
use super::constrained::reactions;
use super::contacts::ContactsAtRest;
use super::tangent::{blurred, told, verdict};
use super::trim::Trim;
use super::{MOST_PRINTED, Place, failed, rows, state_space};
use crate::linear::{StateSpace, linearise_states, short, short_beside};

/// What has modes of M, C and K only.
pub(super) const OF_MODES: [&str; 14] = [
    "plot", "animate", "mode", "matrices", "motion", "drive", "omega", "bode", "response", "range", "vary", "locus",
    "campbell", "orders",
];

/// Linearises at rest, and prints A with its eigenvalues.
pub fn run(
    loaded: &Loaded,
    options: &ArgMatches,
    reader: &mut Reader,
    Place { guess, here, trim }: &Place,
    out: &mut dyn Write,
) -> Result<(), Problem> {
    let given = |option: &&&str| options.value_source(option) == Some(ValueSource::CommandLine);
    if let Some(option) = OF_MODES.iter().find(given) {
        return Err(Problem::usage(format!(
            "--{option} is for models without states of first order: it works on M, C and K. \
             `modes` prints A and B here, and --json has all of their digits; `simulate` computes the motion itself"
        )));
    }
    let system = &*loaded.system;
    let found = linearise_states(system, guess, *here).map_err(failed)?;
    let contacts = ContactsAtRest::of(system, found.rest());
    for warning in &contacts.warnings {
        eprintln!("warning: {warning}");
    }
    let mut written = Vec::new();
    let space = || state_space::of_states(loaded, options, reader, &found);
    state_space::write(&loaded.name, options, space, &mut written)?;
    if state_space::goes_to_output(options)? {
        return Ok(out.write_all(&written)?);
    }
    if options.get_flag("json") {
        return Ok(json::write(&as_json(&loaded.name, &found, trim.as_ref(), &contacts), out)?);
    }
    trim.iter().try_for_each(|trim| trim.table(&loaded.name, out))?;
    table(&loaded.name, &found, out)?;
    for (row, (_, value)) in reactions(loaded, reader)?.iter().zip(&found.reactions) {
        writeln!(out, "{}", row.told("at rest", *value))?;
    }
    contacts.table(out)?;
    Ok(out.write_all(&written)?)
}

fn table(name: &str, found: &StateSpace, out: &mut dyn Write) -> Result<(), Problem> {
    let steady = if found.speeds.is_empty() { "equilibrium" } else { "steady motion" };
    let values = found.place.iter().chain(&found.speeds).map(|(name, value)| format!("{name} = {}", short(*value)));
    writeln!(out, "{name}: {steady} at {}", values.collect::<Vec<_>>().join(", "))?;
    writeln!(out, "  {:.1e} of its terms left of an equation at most", found.residual)?;
    writeln!(out, "small departures x' = A x + B u, x = [{}]", found.variables.join(", "))?;
    if found.variables.len() <= MOST_PRINTED {
        rows("A", &found.matrix, out)?;
        if !found.inputs.is_empty() {
            rows("B", &found.input, out)?;
            writeln!(out, "    u = [{}]", found.inputs.join(", "))?;
        }
    }
    let analysis = &found.analysis;
    if analysis.zeros > 0 {
        let (s, are) = if analysis.zeros == 1 { ("", "is") } else { ("s", "are") };
        writeln!(
            out,
            "  {} eigenvalue{s} {are} 0: departures in {} direction(s) stay as they are",
            analysis.zeros,
            analysis.neutral.len()
        )?;
    }
    blurred(found.blurred, out)?;
    let values = analysis.eigenvalues.iter().skip(analysis.zeros).zip(found.shapes());
    for (k, (value, shape)) in values.filter(|(value, _)| value.im >= 0.0).enumerate() {
        writeln!(out, "  {}: {}", k + 1, told(*value))?;
        writeln!(out, "     {}", parts(found, &shape).join(", "))?;
    }
    writeln!(out, "stability: {}", verdict(analysis.stability))?;
    Ok(())
}

/// `phi 1, i 0.5-0.1i`.
fn parts(found: &StateSpace, shape: &[Complex<f64>]) -> Vec<String> {
    let part = |(name, x): (&String, &Complex<f64>)| {
        let re = short_beside(x.re, 1.0);
        if x.im.abs() <= 1e-12 {
            return format!("{name} {re}");
        }
        let sign = if x.im < 0.0 { '-' } else { '+' };
        format!("{name} {re}{sign}{}i", short_beside(x.im.abs(), 1.0))
    };
    found.variables.iter().zip(shape).map(part).collect()
}

fn as_json(name: &str, found: &StateSpace, trim: Option<&Trim>, contacts: &ContactsAtRest) -> Value {
    let named = |list: &[(String, f64)]| object(list.iter().map(|(name, value)| (name.clone(), number(*value))));
    let pair = |x: &Complex<f64>| Value::Array(vec![number(x.re), number(x.im)]);
    let matrix = |m: &DMatrix<f64>| -> Value {
        m.row_iter().map(|row| row.iter().map(|x| number(*x)).collect::<Vec<_>>()).collect::<Vec<_>>().into()
    };
    let shapes: Vec<Vec<Value>> = found.shapes().iter().map(|shape| shape.iter().map(pair).collect()).collect();
    let entries = [
        ("model", json!(name)),
        ("equilibrium", named(&found.place)),
        ("speeds", named(&found.speeds)),
        ("reactions", named(&found.reactions)),
        ("residual", number(found.residual)),
        ("variables", json!(found.variables)),
        ("coordinates", json!(found.coordinates)),
        ("motions", matrix(&found.motions.rows(0, found.coordinates.len()).into_owned())),
        ("inputs", json!(found.inputs)),
        ("A", matrix(&found.matrix)),
        ("B", matrix(&found.input)),
        ("zeros", json!(found.analysis.zeros)),
        ("eigenvalues", found.analysis.eigenvalues.iter().map(pair).collect::<Vec<_>>().into()),
        ("frequencies_hz", found.analysis.eigenvalues.iter().map(|x| number(x.im / TAU)).collect::<Vec<_>>().into()),
        ("shapes", shapes.into()),
        ("blurred", found.blurred.map_or(Value::Null, number)),
        ("stability", json!(verdict(found.analysis.stability))),
    ];
    let warned = (!contacts.warnings.is_empty()).then(|| ("warnings", json!(contacts.warnings)));
    object(entries.into_iter().chain(trim.map(Trim::as_json)).chain(contacts.as_json()).chain(warned))
}
