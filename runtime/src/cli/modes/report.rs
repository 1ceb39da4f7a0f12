//! What `modes` prints, for people and as JSON.

use std::io::Write;

use nalgebra::DMatrix;
use serde_json::{Value, json};

use super::super::Problem;
use super::super::json::{number, object};
use super::MOST_PRINTED;
use crate::linear::{Equilibrium, Kind, Linearised, Mode, short_beside, short_within};

/// With more coordinates that are all 0 it is enough to say so.
const MANY: usize = 4;
/// Places this near to 0 are there.
const ROUNDING: f64 = 1e-14;
/// So many bodies are named.
const MOST_NAMED: usize = 4;

/// One object; `more` stands at its end.
pub fn as_json(name: &str, linear: &Linearised, modes: &[Mode], more: Vec<(&'static str, Value)>) -> Value {
    let at = &linear.equilibrium;
    let matrix = |matrix: DMatrix<f64>| -> Value {
        let row = |i: usize| matrix.row(i).iter().map(|x| number(*x)).collect::<Vec<Value>>();
        (0..matrix.nrows()).map(row).collect::<Vec<_>>().into()
    };
    let pair = |re: f64, im: f64| Value::Array(vec![number(re), number(im)]);
    let mode = |mode: &Mode| {
        let name = mode.name.iter().map(|name| ("name", json!(name)));
        let secular = mode.secular.then(|| ("secular", json!(true)));
        let entries = [
            ("omega", number(mode.omega)),
            ("hz", number(mode.omega / std::f64::consts::TAU)),
            ("zeta", mode.zeta.map_or(Value::Null, number)),
            ("eigenvalue", pair(mode.eigenvalue.re, mode.eigenvalue.im)),
            ("kind", json!(mode.kind.word())),
            ("shape", mode.shape.iter().map(|x| pair(x.re, x.im)).collect::<Vec<_>>().into()),
        ];
        // More digits than people see.
        let uncertain = (mode.uncertainty > 1e-6).then(|| ("uncertainty", number(mode.uncertainty)));
        object(entries.into_iter().chain(name).chain(secular).chain(uncertain))
    };
    let moves = at.v.iter().any(|v| *v != 0.0);
    let named = |v: &[f64]| object(at.coordinates.iter().cloned().zip(v.iter().map(|v| number(*v))));
    let speeds = moves.then(|| ("speeds", named(&at.v)));
    let entries = [
        ("model", json!(name)),
        ("equilibrium", named(&at.q)),
        ("residual", number(at.largest_residual())),
        ("coordinates", json!(linear.coordinates)),
        ("M", matrix(linear.m())),
        ("C", matrix(linear.c())),
        ("K", matrix(linear.k())),
        ("modes", modes.iter().map(mode).collect::<Vec<_>>().into()),
    ];
    object(entries.into_iter().chain(speeds).chain(more))
}

/// Equilibrium, matrices and modes for people.
///
/// `masses` are those of all the file's coordinates, by which shapes are measured; `bodies` holds, for each mode, the names of bodies and their parts of its kinetic energy.
pub fn table(
    name: &str,
    (linear, masses): (&Linearised, &[f64]),
    modes: &[Mode],
    bodies: &[Vec<(String, f64)>],
    out: &mut dyn Write,
) -> Result<(), Problem> {
    let at = &linear.equilibrium;
    let steady = if at.v.iter().any(|v| *v != 0.0) { "steady motion" } else { "equilibrium" };
    match linear.len() > MANY && at.q.iter().chain(&at.v).all(|x| x.abs() <= ROUNDING) {
        true => writeln!(out, "{name}: {steady} with all coordinates 0")?,
        false => writeln!(out, "{name}: {steady} at {at}")?,
    }
    let iterations = match at.iterations {
        0 => "the start is one".to_owned(),
        1 => "1 iteration".to_owned(),
        n => format!("{n} iterations"),
    };
    writeln!(out, "  {}, {iterations}", residual(at))?;
    match at.freedom.family {
        0 => {}
        1 => writeln!(out, "  equilibrium not isolated: one zero-frequency (rigid-body) direction")?,
        n => writeln!(out, "  equilibrium not isolated: {n} zero-frequency (rigid-body) directions")?,
    }
    if linear.is_empty() {
        writeln!(out, "  the constraints leave no coordinate independent: nothing moves by itself")?;
        return Ok(());
    }
    if linear.len() <= MOST_PRINTED {
        if linear.len() < at.coordinates.len() {
            writeln!(out, "  in {}, which the constraints leave independent:", linear.coordinates.join(", "))?;
        }
        matrices(linear, out)?;
    }
    writeln!(out, "modes, each scaled to unit modal mass:")?;
    for (index, mode) in modes.iter().enumerate() {
        writeln!(out, "  {}: {mode}", index + 1)?;
        let list = bodies.get(index).map_or(&[][..], Vec::as_slice).iter().take(MOST_NAMED);
        let list: Vec<String> = list.map(|(name, part)| format!("{name} {:.0} %", 100.0 * part)).collect();
        if !list.is_empty() {
            writeln!(out, "     bodies: {}", list.join(", "))?;
        }
        if linear.len() <= MOST_PRINTED {
            writeln!(out, "     {}", shape(linear, masses, mode).join(", "))?;
        }
    }
    let rigid = modes.iter().filter(|mode| mode.kind == Kind::Rigid && mode.name.is_none()).count();
    if rigid > 1 {
        writeln!(out, "  (of the {rigid} rigid modes any combination is one)")?;
    }
    Ok(())
}

/// `residual 2.3e-16`, `residual 0`.
pub fn residual(at: &Equilibrium) -> String {
    match at.largest_residual() {
        0.0 => "residual 0".to_owned(),
        left => format!("residual {left:.1e}"),
    }
}

/// M, C and K; C in its two parts, and what K has without a potential.
fn matrices(linear: &Linearised, out: &mut dyn Write) -> Result<(), Problem> {
    let mut parts = vec![("M", linear.m())];
    let (gyroscopic, circulatory) = (linear.gyroscopic(), linear.circulatory());
    match (linear.damping.is_zero(), gyroscopic.is_zero()) {
        (true, _) => {}
        (false, true) => parts.push(("C", linear.c())),
        (false, false) => {
            if !linear.dissipative().is_zero() {
                parts.push(("C, what dissipates", linear.dissipative().to_dense()));
            }
            parts.push(("C, gyroscopic (does no work)", gyroscopic.to_dense()));
        }
    }
    parts.push(("K", linear.k()));
    if !circulatory.is_zero() {
        parts.push(("K, what has no potential", circulatory.to_dense()));
    }
    for (symbol, matrix) in parts {
        writeln!(out, "{symbol} =")?;
        // What is rounding is so beside its own row and column: coordinates may have any units.
        let scale = |i: usize, j: usize| (matrix.row(i).amax() * matrix.column(j).amax()).sqrt();
        let cell = |(i, j): (usize, usize)| short_beside(matrix[(i, j)], scale(i, j));
        let row = |i: usize| (0..matrix.ncols()).map(|j| cell((i, j))).collect::<Vec<String>>();
        let rows: Vec<Vec<String>> = (0..matrix.nrows()).map(row).collect();
        columns(&rows, out)?;
        if symbol == "M" && linear.damping.is_zero() {
            writeln!(out, "C = 0")?;
        }
    }
    Ok(())
}

/// Rows of cells, right-aligned under each other.
pub fn columns(rows: &[Vec<String>], out: &mut dyn Write) -> Result<(), Problem> {
    let most = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |k: usize| rows.iter().filter_map(|row| row.get(k)).map(|cell| cell.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..most).map(width).collect();
    for row in rows {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}"));
        writeln!(out, "  {}", cells.collect::<Vec<_>>().join("  "))?;
    }
    Ok(())
}

/// `theta1 0.5`, or `theta1 0.5+0.1i` for complex shapes.  What has next to no part in the energy is rounding.
fn shape(linear: &Linearised, masses: &[f64], mode: &Mode) -> Vec<String> {
    let energy = mode.shape.iter().zip(masses).fold(0.0_f64, |most, (x, mass)| most.max(x.norm() * mass.sqrt()));
    let largest = mode.shape.iter().fold(0.0_f64, |most, x| most.max(x.norm()));
    let scale = |mass: f64| if mass > 0.0 && energy > 0.0 { energy / mass.sqrt() } else { largest };
    let element = |((name, x), mass): ((&String, &nalgebra::Complex<f64>), &f64)| {
        let scale = scale(*mass);
        let size = x.norm();
        let digits = |part: f64| match part.abs() <= 1e-12 * scale {
            true => "0".to_owned(),
            false => short_within(part, mode.uncertainty * size / part.abs()),
        };
        let re = digits(x.re);
        if x.im.abs() <= 1e-12 * scale {
            return format!("{name} {re}");
        }
        let sign = if x.im < 0.0 { '-' } else { '+' };
        format!("{name} {re}{sign}{}i", digits(x.im.abs()))
    };
    linear.equilibrium.coordinates.iter().zip(&mode.shape).zip(masses).map(element).collect()
}
