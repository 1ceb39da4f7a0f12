//! `modes`: an equilibrium, M, C and K there, and the modes.

use std::io::Write;

use clap::ArgMatches;
use nalgebra::DMatrix;
use serde_json::{Value, json};

use super::json::{number, object};
use super::load::Loaded;
use super::set_up::choose;
use super::{Entry, Problem};
use crate::linear::{
    Guess, Kind, LinearError, Linearised, Mode, animate_mode, draw_modes, equilibrium_here, equilibrium_near, linearise,
};

/// Matrices with more coordinates are not printed for people.
const MOST_PRINTED: usize = 12;

/// Searches from `--at` or the file's guess (or takes it as it is), linearises, and prints the modes.
pub fn run(models: &[Entry], options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let mut loaded = Loaded::find(models, options)?;
    let (_, mut reader) = choose(&mut loaded, options)?;
    let mut guess = Guess::at(&loaded.system.equilibrium_guess());
    reader.states(&loaded, options, "at", &mut guess.q, &mut guess.v)?;
    for warning in &loaded.warnings {
        eprintln!("warning: {warning}");
    }
    let failed = |error: LinearError| Problem::Run(error.to_string());
    let system = &*loaded.system;
    let found =
        if options.get_flag("here") { equilibrium_here(system, &guess) } else { equilibrium_near(system, &guess) };
    let linear = linearise(system, &found.map_err(failed)?).map_err(failed)?;
    let modes = linear.modes().map_err(failed)?;
    for note in notes(&linear, &modes) {
        eprintln!("warning: {note}");
    }
    pictures(&loaded, options, &linear, &modes)?;
    if options.get_flag("json") {
        super::json::write(&as_json(&loaded.name, &linear, &modes), out)?;
        return Ok(());
    }
    table(&loaded.name, &linear, &modes, out)
}

/// Writes `--plot` and `--animate`.
fn pictures(loaded: &Loaded, options: &ArgMatches, linear: &Linearised, modes: &[Mode]) -> Result<(), Problem> {
    let system = &*loaded.system;
    let file = |name: &str| options.get_one::<String>(name);
    let write = |path: &String, text: String| {
        std::fs::write(path, text).map_err(|problem| Problem::File(format!("cannot write `{path}`: {problem}")))
    };
    if let Some(path) = file("plot") {
        write(path, draw_modes(system, linear, modes).to_svg())?;
    }
    let number = match file("mode") {
        None => modes.iter().position(|mode| mode.kind != Kind::Rigid).unwrap_or(0),
        Some(text) => match text.trim().parse::<usize>() {
            Ok(number) if (1..=modes.len()).contains(&number) => number - 1,
            _ => {
                return Err(Problem::Usage(format!("error: --mode is `{text}`; there are modes 1 to {}", modes.len())));
            }
        },
    };
    if let (Some(path), Some(mode)) = (file("animate"), modes.get(number)) {
        write(path, animate_mode(system, linear, mode).to_html())?;
    }
    Ok(())
}

/// What the numbers alone do not tell.
fn notes(linear: &Linearised, modes: &[Mode]) -> Vec<String> {
    let mut notes = Vec::new();
    if linear.equilibrium.is_degenerate() {
        let directions = linear.equilibrium.freedom.degenerate.len().max(1);
        notes.push(format!(
            "the equilibrium is degenerate: in {directions} direction(s) the stiffness vanishes though nothing moves \
             freely there; the linear model does not tell what happens"
        ));
    }
    if modes.iter().any(|mode| mode.repeated && mode.kind != Kind::Rigid) {
        notes.push("some frequencies are equal: only the space that their shapes span has a meaning".to_owned());
    }
    if !linear.circulatory().is_zero() {
        notes.push("K is not symmetric: some force has no potential, and damping may destabilise".to_owned());
    }
    #[cfg(feature = "modal")]
    if !linear.damping.is_zero()
        && let Ok(analysis) = crate::linear::complex_modes(linear)
    {
        if analysis.only_gyroscopic {
            notes.push("K alone is unstable and only gyroscopic forces hold it: any damping destroys that".to_owned());
        }
        if analysis.defective {
            notes
                .push("the modes are too few to superpose: some motions are (A + B t) times an exponential".to_owned());
        }
    }
    notes
}

fn as_json(name: &str, linear: &Linearised, modes: &[Mode]) -> Value {
    let at = &linear.equilibrium;
    let matrix = |matrix: DMatrix<f64>| -> Value {
        let row = |i: usize| matrix.row(i).iter().map(|x| number(*x)).collect::<Vec<Value>>();
        (0..matrix.nrows()).map(row).collect::<Vec<_>>().into()
    };
    let pair = |re: f64, im: f64| Value::Array(vec![number(re), number(im)]);
    let mode = |mode: &Mode| {
        object([
            ("omega", number(mode.omega)),
            ("zeta", mode.zeta.map_or(Value::Null, number)),
            ("eigenvalue", pair(mode.eigenvalue.re, mode.eigenvalue.im)),
            ("kind", json!(mode.kind.word())),
            ("shape", mode.shape.iter().map(|x| pair(x.re, x.im)).collect::<Vec<_>>().into()),
        ])
    };
    object([
        ("model", json!(name)),
        ("equilibrium", object(at.coordinates.iter().zip(&at.q).map(|(name, q)| (name.clone(), number(*q))))),
        ("residual", number(at.largest_residual())),
        ("coordinates", json!(linear.coordinates)),
        ("M", matrix(linear.m())),
        ("C", matrix(linear.c())),
        ("K", matrix(linear.k())),
        ("modes", modes.iter().map(mode).collect::<Vec<_>>().into()),
    ])
}

fn table(name: &str, linear: &Linearised, modes: &[Mode], out: &mut dyn Write) -> Result<(), Problem> {
    let at = &linear.equilibrium;
    writeln!(out, "{name}: equilibrium at {at}")?;
    writeln!(out, "  residual {:.1e}, {} iterations", at.largest_residual(), at.iterations)?;
    if at.freedom.family > 0 {
        writeln!(out, "  one of a family with {} free direction(s)", at.freedom.family)?;
    }
    if linear.len() <= MOST_PRINTED {
        for (symbol, matrix) in [("M", linear.m()), ("C", linear.c()), ("K", linear.k())] {
            if symbol == "C" && linear.damping.is_zero() {
                writeln!(out, "C = 0")?;
                continue;
            }
            writeln!(out, "{symbol} =")?;
            for row in matrix.row_iter() {
                let row: Vec<String> = row.iter().map(|x| format!("{x:>12.6}")).collect();
                writeln!(out, "  {}", row.join(" "))?;
            }
        }
    }
    writeln!(out, "modes, each scaled to unit modal mass:")?;
    for (index, mode) in modes.iter().enumerate() {
        writeln!(out, "  {}: {mode}", index + 1)?;
        if linear.len() <= MOST_PRINTED {
            writeln!(out, "     {}", shape(linear, mode).join(", "))?;
        }
    }
    Ok(())
}

/// `theta1 0.5`, or `theta1 0.5+0.1i` for complex shapes.
fn shape(linear: &Linearised, mode: &Mode) -> Vec<String> {
    let real = mode.shape.iter().all(|x| x.im == 0.0);
    let element = |(name, x): (&String, &nalgebra::Complex<f64>)| {
        if real { format!("{name} {:.6}", x.re) } else { format!("{name} {:.6}{:+.6}i", x.re, x.im) }
    };
    linear.coordinates.iter().zip(&mode.shape).map(element).collect()
}
