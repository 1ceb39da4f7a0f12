//! `orbit --map`: stability over two parameters, as text and JSON.

use std::io::Write;

use clap::ArgMatches;
use serde_json::{Value as Json, json};

use super::Problem;
use super::json::{number, object, write_outcome};
use super::load::Loaded;
use super::orbit::unless_broken_off;
use crate::numbers::short;
use crate::orbit::{Boundary, StabilityMap};
use crate::run::written;

/// Prints a map.
pub fn report(loaded: &Loaded, map: &StabilityMap, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    if options.get_flag("json") {
        return write_outcome(as_json(loaded, map), unless_broken_off(map.interrupted), out);
    }
    let [x, y] = &map.names;
    let [columns, rows] = [0, 1].map(|axis| map.values[axis].len());
    let places = || (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let count =
        |wanted: Option<bool>| places().filter(|(column, row)| map.is_unstable(*column, *row) == wanted).count();
    writeln!(
        out,
        "{}: {columns} values of `{x}` by {rows} of `{y}`: {} stable, {} unstable, {} without such a motion",
        loaded.name,
        count(Some(false)),
        count(Some(true)),
        count(None)
    )?;
    for boundary in &map.boundaries {
        writeln!(out, "{}", boundary.kind.word())?;
        for point in &boundary.points {
            let error = if point.error.is_nan() { f64::INFINITY } else { point.error };
            writeln!(out, "  {y} = {:>12}  {x} = {}", short(point.y), written(point.x, error))?;
        }
    }
    Ok(())
}

fn as_json(loaded: &Loaded, map: &StabilityMap) -> Json {
    let numbers = |values: &[f64]| Json::Array(values.iter().map(|value| number(*value)).collect());
    let boundary = |boundary: &Boundary| {
        let points = boundary
            .points
            .iter()
            .map(|point| json!({"x": number(point.x), "y": number(point.y), "error": number(point.error)}));
        json!({"kind": boundary.kind.word(), "points": points.collect::<Vec<_>>()})
    };
    let axis = |place: usize| json!({"name": map.names[place], "values": numbers(&map.values[place])});
    let rows = map.growth.chunks(map.values[0].len().max(1)).map(numbers);
    object([
        ("model", json!(loaded.name)),
        ("x", axis(0)),
        ("y", axis(1)),
        ("growth", Json::Array(rows.collect())),
        ("boundaries", Json::Array(map.boundaries.iter().map(boundary).collect())),
    ])
}
