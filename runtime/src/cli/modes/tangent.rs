//! `modes` about steady motions with constraints, and where constraints contain speeds: eigenvalues on the states that
//! the constraints leave.

use std::f64::consts::TAU;
use std::io::Write;

use nalgebra::Complex;
use serde_json::{Value, json};

use super::super::Problem;
use super::super::json::{number, object};
use super::constrained::Reaction;
use crate::linear::{Stability, Tangent, short, short_beside};

/// A real part below this part of its eigenvalue.
const ROUNDING: f64 = 1e-13;

/// What becomes of departures, for people.
pub fn table(name: &str, found: &Tangent, reactions: &[Reaction], out: &mut dyn Write) -> Result<(), Problem> {
    let at = &found.equilibrium;
    let steady = if at.v.iter().any(|v| *v != 0.0) { "steady motion" } else { "equilibrium" };
    writeln!(out, "{name}: {steady} at {at}")?;
    writeln!(out, "  {}", super::report::residual(at))?;
    if !found.turning.is_empty() {
        writeln!(out, "  {} turn as a whole: departures are seen from axes that turn along", found.turning.join(", "))?;
    }
    let (free, analysis) = (found.matrix.nrows(), &found.analysis);
    writeln!(out, "departures that the constraints allow: {free}")?;
    match (analysis.zeros, analysis.neutral.len()) {
        (0, _) => {}
        (zeros, neutral) => writeln!(
            out,
            "  {zeros} eigenvalue{} 0: departures in {neutral} direction{} stay as they are",
            if zeros == 1 { " is" } else { "s are" },
            if neutral == 1 { "" } else { "s" },
        )?,
    }
    blurred(found.blurred, out)?;
    for (number, value, shape) in listed(found) {
        writeln!(out, "  {number}: {}", told(value))?;
        writeln!(out, "     {}", departures(found, &shape).join(", "))?;
    }
    writeln!(out, "stability: {}", verdict(analysis.stability))?;
    for (row, value) in reactions.iter().zip(&found.multipliers) {
        writeln!(out, "{}", row.told("there", *value))?;
    }
    Ok(())
}

/// Below what eigenvalues are not told from 0.
pub(super) fn blurred(size: Option<f64>, out: &mut dyn Write) -> Result<(), Problem> {
    if let Some(size) = size {
        writeln!(
            out,
            "  below {size:.1e} 1/s eigenvalues are not told from 0: what constraints eliminate is known no better"
        )?;
    }
    Ok(())
}

/// Eigenvalues that are not 0 with their shapes, one of each conjugate pair.
fn listed(found: &Tangent) -> Vec<(usize, Complex<f64>, Vec<Complex<f64>>)> {
    let values = found.analysis.eigenvalues.iter().skip(found.analysis.zeros).copied().zip(found.shapes());
    let one_of_each = values.filter(|(value, _)| value.im >= 0.0).enumerate();
    one_of_each.map(|(k, (value, shape))| (k + 1, value, shape)).collect()
}

/// `time constant 1 s`, `omega = 2 rad/s, …`.
pub(super) fn told(value: Complex<f64>) -> String {
    // What rounding leaves of a real part is none.
    let value = Complex::new(if value.re.abs() <= ROUNDING * value.norm() { 0.0 } else { value.re }, value.im);
    let lambda = match value.im == 0.0 {
        true => format!("eigenvalue {} 1/s", short(value.re)),
        false => format!("eigenvalues {} ± {}i 1/s, {} Hz", short(value.re), short(value.im), short(value.im / TAU)),
    };
    match value.re {
        re if re < 0.0 => format!("{lambda}, time constant {} s", short(-1.0 / re)),
        re if re > 0.0 => format!("{lambda}, unstable, grows by e in {} s", short(1.0 / re)),
        _ => lambda,
    }
}

pub(super) fn verdict(stability: Stability) -> &'static str {
    match stability {
        Stability::Asymptotic => "departures die out",
        Stability::Neutral => "no departure grows; some stay",
        Stability::Drifting => "no departure grows by itself, but some go on at a constant rate, as another speed does",
        Stability::Unstable => "unstable",
    }
}

/// `x 1, theta 0.5-0.1i`, rates where no coordinate departs.
fn departures(found: &Tangent, shape: &[Complex<f64>]) -> Vec<String> {
    let names = &found.equilibrium.coordinates;
    let n = names.len();
    let rates = shape[..n].iter().all(|x| x.norm() == 0.0);
    let (part, prime) = if rates { (&shape[n..], "'") } else { (&shape[..n], "") };
    let scale = part.iter().fold(0.0_f64, |most, x| most.max(x.norm()));
    let element = |(name, x): (&String, &Complex<f64>)| {
        let re = short_beside(x.re, scale);
        if x.im.abs() <= 1e-12 * scale {
            return format!("{name}{prime} {re}");
        }
        let sign = if x.im < 0.0 { '-' } else { '+' };
        format!("{name}{prime} {re}{sign}{}i", short_beside(x.im.abs(), scale))
    };
    names.iter().zip(part).map(element).collect()
}

/// One object; `more` stands at its end.
pub fn as_json(
    name: &str,
    found: &Tangent,
    reactions: &[Reaction],
    more: impl Iterator<Item = (&'static str, Value)>,
) -> Value {
    let at = &found.equilibrium;
    let named = |numbers: &[f64]| {
        let pairs = at.coordinates.iter().cloned().zip(numbers.iter().copied());
        object(pairs.map(|(name, value)| (name, number(value))))
    };
    let pair = |x: &Complex<f64>| Value::Array(vec![number(x.re), number(x.im)]);
    let shapes: Vec<Vec<Value>> = found.shapes().iter().map(|shape| shape.iter().map(pair).collect()).collect();
    let rows = found.matrix.row_iter().map(|row| row.iter().map(|x| number(*x)).collect::<Vec<_>>());
    let reactions = reactions.iter().zip(&found.multipliers).map(|(row, value)| (row.row.clone(), number(*value)));
    let entries = [
        ("model", json!(name)),
        ("equilibrium", named(&at.q)),
        ("speeds", named(&at.v)),
        ("residual", number(at.largest_residual())),
        ("turning", json!(found.turning)),
        ("departures", json!(found.matrix.nrows())),
        ("F", rows.collect::<Vec<_>>().into()),
        ("zeros", json!(found.analysis.zeros)),
        ("eigenvalues", found.analysis.eigenvalues.iter().map(pair).collect::<Vec<_>>().into()),
        ("shapes", shapes.into()),
        ("blurred", found.blurred.map_or(Value::Null, number)),
        ("stability", json!(verdict(found.analysis.stability))),
        ("reactions", object(reactions)),
    ];
    object(entries.into_iter().chain(more))
}
