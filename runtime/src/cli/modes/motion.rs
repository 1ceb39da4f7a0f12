//! `--motion`: small motions from a scene's start, computed in several ways and compared (problems 24, 25 and 34).

use std::io::Write;

use clap::ArgMatches;
use serde_json::{Value, json};

use super::super::Problem;
use super::super::json::{number, object};
use super::super::load::Loaded;
use super::super::outputs;
use super::damping::Damping;
use super::failed;
use super::model::Model;
use crate::linear::{Linearised, Motion, SparseMatrix, short};
use crate::mechanism::dense::constraint_triples;
use crate::mechanism::{At, rows_in_force};
use crate::show::{Axis, Chart, Figure, Series, Style};
use crate::{Settings, simulate};

/// Points of a motion.
const POINTS: u32 = 400;
/// The exponential of more coordinates takes too long.
const MOST_COORDINATES: usize = 40;
/// Integrals that differ by less than this part of their terms are the same.
const INTEGRAL: f64 = 1e-9;
/// Coordinates that are drawn.
const MOST_DRAWN: usize = 6;

/// A free motion, in several ways.
pub struct Compared {
    until: f64,
    /// Name, and the largest difference from the matrix exponential, as a part of the largest departure.
    differences: Vec<(&'static str, f64)>,
}

impl Compared {
    /// Computes and draws the motion from a scene's start; `None` if it is not asked for.
    pub fn new(
        loaded: &Loaded,
        options: &ArgMatches,
        scene: usize,
        model: Model<'_>,
        damping: Option<&Damping>,
    ) -> Result<Option<Compared>, Problem> {
        let Some(path) = options.get_one::<String>("motion") else { return Ok(None) };
        let linear = model.linear();
        if linear.len() > MOST_COORDINATES {
            let text = format!("--motion is for up to {MOST_COORDINATES} coordinates; here are {}", linear.len());
            return Err(Problem::usage(text));
        }
        let start = loaded.system.scene(scene);
        if let Some(phase) = options.get_one::<String>("phase")
            && loaded.system.description().phases.get(start.phase).is_some_and(|own| own.name != *phase)
        {
            let words = format!("--motion: the scene does not start in the phase `{phase}`; leave out --phase");
            return Err(Problem::usage(words));
        }
        let times: Vec<f64> = (0..=POINTS).map(|i| start.until * f64::from(i) / f64::from(POINTS)).collect();
        let integrated = integrated(loaded, scene, linear, &times)?;
        same_integrals(loaded, linear, &integrated)?;
        let [x0, v0] = model.departures(&integrated);
        if x0.iter().chain(&v0).all(|x| *x == 0.0) {
            return Err(Problem::usage("--motion: the scene starts at rest in the equilibrium"));
        }
        let free = |linear: &Linearised| {
            linear.free_motion(&x0, &v0, &times).map(|motion| model.in_all_coordinates(motion)).map_err(failed)
        };
        let exact = free(linear)?;
        let mut ways: Vec<(&'static str, Motion)> = vec![("the full equations, integrated", integrated)];
        if let Some(damping) = damping {
            let with = |c: nalgebra::DMatrix<f64>| {
                free(&Linearised { damping: SparseMatrix::from_dense(&c), ..linear.clone() })
            };
            ways.push(("damping treated as diagonal", with(damping.diagonal.matrix.clone())?));
            if let Some((alpha, beta)) = damping.fitted {
                ways.push(("C = alpha M + beta K", with(linear.m() * alpha + linear.k() * beta)?));
            }
        }
        outputs::draw(path, figure(linear, &times, &exact, &ways))?;
        let scale = exact.x.amax().max(f64::MIN_POSITIVE);
        let difference = |motion: &Motion| (&motion.x - &exact.x).amax() / scale;
        let differences = ways.iter().map(|(name, motion)| (*name, difference(motion))).collect();
        Ok(Some(Compared { until: start.until, differences }))
    }

    /// The key `motion`.
    pub fn as_json(&self) -> (&'static str, Value) {
        let list = self.differences.iter().map(|(name, difference)| (*name, number(*difference)));
        ("motion", object([("until", number(self.until)), ("differences", object(list)), ("from", json!("exp(A t)"))]))
    }

    /// For people.
    pub fn table(&self, out: &mut dyn Write) -> Result<(), Problem> {
        writeln!(
            out,
            "free motion from the scene's start, up to t = {} s: differs from exp(A t) by",
            short(self.until)
        )?;
        for (name, difference) in &self.differences {
            writeln!(out, "  {:.1e} of the largest departure: {name}", difference)?;
        }
        Ok(())
    }
}

/// Refuses a start at which integrals of constraints have other values than at the equilibrium: it cannot get there.
fn same_integrals(loaded: &Loaded, linear: &Linearised, motion: &Motion) -> Result<(), Problem> {
    let (at, description) = (&linear.equilibrium, loaded.system.description());
    let start: Vec<f64> = at.q.iter().zip(motion.x.row(0).iter()).map(|(q, x)| q + x).collect();
    let zero = vec![0.0; start.len()];
    let [there, here] = [&start, &at.q].map(|q| constraint_triples(&*loaded.system, At::new(0.0, q, &zero)));
    let rows = rows_in_force(&*loaded.system).filter(|row| description.rows[*row].integral);
    let terms = |row: usize| there[row][2].max(here[row][2]);
    match rows.into_iter().find(|row| (there[*row][0] - here[*row][0]).abs() > INTEGRAL * terms(*row)) {
        None => Ok(()),
        Some(row) => Err(Problem::usage(format!(
            "--motion: the scene starts with another value of the integral of `{}` than the equilibrium has, which the motion \
             keeps; let --at, or `equilibrium` in the file, begin where the scene starts",
            description.rows[row].name
        ))),
    }
}

/// The model's own equations from the scene's start, inputs held; as departures.
fn integrated(loaded: &Loaded, scene: usize, linear: &Linearised, times: &[f64]) -> Result<Motion, Problem> {
    let (mut system, at) = (loaded.system.boxed_clone(), &linear.equilibrium);
    for index in 0..system.description().inputs.len() {
        let value = at.inputs.get(index).copied().unwrap_or(0.0);
        system.set_input(index, std::sync::Arc::new(move |_| [value, 0.0, 0.0]));
    }
    let run = simulate(&mut *system, &Settings::new(&loaded.system.scene(scene)));
    let run = run.map_err(|error| Problem::Run(error.to_string()))?;
    let n = at.q.len();
    let zero = || nalgebra::DMatrix::zeros(times.len(), n);
    let mut motion = Motion { x: zero(), v: zero() };
    for (row, t) in times.iter().enumerate() {
        // An event may have ended the run before.
        let Some(state) = run.at(*t) else {
            motion.x.row_mut(row).fill(f64::NAN);
            continue;
        };
        for i in 0..n {
            // A steady motion goes on by itself.
            motion.x[(row, i)] = state.q[i] - at.q[i] - at.v[i] * t;
            motion.v[(row, i)] = state.v[i] - at.v[i];
        }
    }
    Ok(motion)
}

fn figure(linear: &Linearised, times: &[f64], exact: &Motion, ways: &[(&'static str, Motion)]) -> Figure {
    let at = &linear.equilibrium;
    let chart = |i: usize| {
        let unit = at.units.get(i).map_or("", String::as_str);
        let line = |name: &str, motion: &Motion| {
            Series::line(name, times.iter().enumerate().map(|(row, t)| Some((*t, motion.x[(row, i)]))))
        };
        let axis = Axis::new(at.coordinates[i].clone(), if unit == "1" { "" } else { unit });
        let chart = Chart::new("", Axis::new("time", "s"), axis).with(line("exp(A t)", exact));
        ways.iter()
            .fold(chart, |chart, (name, motion)| chart.with(Series { style: Style::Dashed, ..line(name, motion) }))
    };
    Figure::from((0..at.q.len().min(MOST_DRAWN)).map(chart).collect::<Vec<_>>())
}
