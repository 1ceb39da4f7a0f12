//! What `chart --steps` prints and writes.

use std::io::Write;

use serde_json::{Value, json};

use super::super::json::{self, number, object};
use super::super::{Problem, outputs};
use super::{left_out, put_table};
use crate::precision::{Convergence, StepCurve};

/// Prints a table and where the curves end, and writes the chart and all points.
pub fn report(
    found: &Convergence,
    [plot, csv]: &[String; 2],
    (as_data, outcome): (bool, Result<(), Problem>),
    (output, out): (Option<&mut dyn Write>, &mut dyn Write),
) -> Result<(), Problem> {
    outputs::draw(plot, found.chart())?;
    put_table(csv, &found.to_csv(), output)?;
    if as_data {
        return json::write_outcome(as_json(found), outcome, out);
    }
    let reference = &found.reference;
    let times = reference.times();
    writeln!(out, "{} until t = {}, with steps halved again and again", found.title, times[times.len() - 1])?;
    writeln!(out, "errors of {}, the largest of ten instants, in parts of their ranges", reference.columns.join(", "))?;
    writeln!(out, "{}\n\n{}", reference.sentence(), found.table())?;
    left_out(&found.refused, out)?;
    writeln!(out, "{}\n", found.sentence())?;
    [plot, csv].into_iter().filter(|path| *path != "-").try_for_each(|path| writeln!(out, "written: {path}"))?;
    outcome
}

fn as_json(found: &Convergence) -> Value {
    let curve = |curve: &StepCurve| {
        let points = curve.points.iter().map(|point| {
            let (error, failure) =
                point.error.map_or_else(|why| (Value::Null, json!(why)), |e| (number(e), Value::Null));
            object([
                ("step", number(point.step)),
                ("steps", json!(point.steps)),
                ("error", error),
                ("failure", failure),
            ])
        });
        object([
            ("method", json!(curve.name)),
            ("order", json!(curve.order)),
            ("observed_order", curve.observed_order().map_or(Value::Null, number)),
            ("points", points.collect()),
        ])
    };
    let refused = found.refused.iter().map(|(name, why)| object([("method", json!(name)), ("why", json!(why))]));
    object([
        ("model", json!(found.title)),
        ("compared", json!(found.reference.columns)),
        ("reference", json!(found.reference.by())),
        ("reference_digits", json!(found.reference.digits())),
        ("curves", found.curves.iter().map(curve).collect()),
        ("refused", refused.collect()),
    ])
}
