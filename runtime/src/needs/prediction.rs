//! What leaving out an ingredient changes, to first order along the full motion.
//!
//! With accelerations a(q, v, t) of the full model and ã of the one without, D = ã − a is what the ingredient does, and
//!
//! δ'' = ∂a/∂q δ + ∂a/∂v δ' + D,  w'' = ∂a/∂q w + ∂a/∂v w' + [ã(q + δ, v + δ') − a − ∂a/∂q δ − ∂a/∂v δ' − D]
//!
//! are the first and the second approximation of the change (Newton and Kantorovich).  The prediction is the largest change of what is
//! wanted that δ makes; the law holds where w makes less than half of that.  It says why a run changes as it does, and whether
//! twice as much would change it twice as much; what is left out is decided by runs.

use std::sync::Arc;

use super::full::Full;
use crate::mechanism::{At, Coordinate, Description, Energy, Method, Scene, Singular, Structure, System};
use crate::run::{Names, evaluate_outputs};
use crate::simulate::{Settings, simulate};

/// A first approximation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Prediction {
    /// The largest change of what is wanted, in parts of ranges.
    pub change: f64,
    /// What the second approximation adds, in parts of the first.
    pub second: f64,
}

impl Prediction {
    /// Whether the change is proportional to what is left out.
    pub fn holds(&self) -> bool {
        self.second < SMALL
    }
}

/// The law holds where the second approximation adds less than this part of the first.
const SMALL: f64 = 0.5;
/// Derivatives along a direction are differences over this part of ranges to either side.
const STEP: f64 = 1e-4;
/// A first approximation needs no more digits.
const TOLERANCE: f64 = 1e-6;
/// Larger models are not worth it.
const MOST_COORDINATES: usize = 12;
/// It gives up after so many steps.
const MOST_STEPS: u64 = 100_000;

/// The change that a model without an ingredient makes to first order; `None` where it has other coordinates, constraints, events,
/// discontinuities or anything that takes time apart.
pub(super) fn predicted(full: &Full, without: &dyn System, settings: &Settings) -> Option<Prediction> {
    let n = full.system.len();
    let smooth = |system: &dyn System| {
        let description = system.description();
        description.events.is_empty() && description.switches.is_empty() && description.rows.is_empty()
    };
    let names = |system: &dyn System| Names::of(system.description()).coordinates;
    if n > MOST_COORDINATES || !smooth(&*full.system) || !smooth(without) || names(&*full.system) != names(without) {
        return None;
    }
    let mut variation = Variation::new(full, without);
    let both = |own: &[f64], other: &[f64]| -> Vec<f64> {
        let apart = own.iter().zip(other).map(|(own, other)| other - own);
        own.iter().copied().chain(apart).chain(vec![0.0; n]).collect()
    };
    let along = Settings {
        q: both(&full.settings.q, &settings.q),
        v: both(&full.settings.v, &settings.v),
        held_q: Vec::new(),
        held_v: Vec::new(),
        every: Some((settings.until - settings.from) / 1000.0),
        tolerance: TOLERANCE,
        method: Method::Dop853,
        max_steps: MOST_STEPS,
        dense: false,
        watch: false,
        digits: false,
        ..full.settings.clone()
    };
    let run = simulate(&mut variation, &along).ok()?;
    let columns = |system: &dyn System| -> Option<Vec<usize>> {
        let all = Names::of(system.description()).columns();
        full.need.outputs.iter().map(|name| all.iter().position(|known| known == name)).collect()
    };
    let (own, other) = (columns(&*full.system)?, columns(without)?);
    let (mut first, mut second) = (0.0_f64, 0.0_f64);
    for state in run.states() {
        let part = |k: usize| [&state.q[k * n..][..n], &state.v[k * n..][..n]].concat();
        let [y, delta, w] = [0, 1, 2].map(part);
        let moved: Vec<f64> = y.iter().zip(&delta).map(|(y, delta)| y + delta).collect();
        let twice: Vec<f64> = moved.iter().zip(&w).map(|(y, w)| y + w).collect();
        let before = wanted(&*full.system, state.t, &y, &own);
        let [once, twice] = [moved, twice].map(|y| wanted(without, state.t, &y, &other));
        for (k, scale) in full.scales.iter().enumerate() {
            first = first.max((once[k] - before[k]).abs() / scale);
            second = second.max((twice[k] - once[k]).abs() / scale);
        }
    }
    let finite = first.is_finite() && second.is_finite();
    finite.then(|| Prediction { change: first, second: if first > 0.0 { second / first } else { 0.0 } })
}

/// What is wanted at a state.
fn wanted(system: &dyn System, t: f64, y: &[f64], columns: &[usize]) -> Vec<f64> {
    let mut outputs = vec![f64::NAN; system.description().output_len()];
    evaluate_outputs(system, t, y, &mut vec![0.0; system.len()], &mut outputs);
    let all = [y, &outputs].concat();
    columns.iter().map(|column| all[*column]).collect()
}

/// The full motion with its two approximations: coordinates (q, δ, w).
#[derive(Clone)]
struct Variation {
    full: Arc<dyn System>,
    without: Arc<dyn System>,
    /// Of each coordinate and rate.
    ranges: Vec<f64>,
    description: Description,
}

impl Variation {
    fn new(full: &Full, without: &dyn System) -> Self {
        let coordinates = &full.system.description().coordinates;
        let tripled = ["", " first", " second"].into_iter().flat_map(|suffix| {
            let named =
                move |c: &Coordinate| Coordinate { name: format!("{}{suffix}", c.name).into(), unit: c.unit.clone() };
            coordinates.iter().map(named)
        });
        Variation {
            full: full.system.boxed_clone().into(),
            without: without.boxed_clone().into(),
            ranges: full.motion.ranges.clone(),
            description: Description {
                name: "Variation".into(),
                coordinates: tripled.collect(),
                scenes: vec!["scene".into()].into(),
                structure: Structure { dimension: 2, time_dependent: true, ..Structure::default() },
                ..Description::default()
            },
        }
    }

    /// ∂a/∂q d + ∂a/∂v d' at a state.
    fn along(&self, t: f64, y: &[f64], d: &[f64]) -> Result<Vec<f64>, Singular> {
        let n = self.full.len();
        // Ranges of what stands still are its size, or that of the direction.
        let share = d.iter().zip(&self.ranges).map(|(d, range)| d.abs() / range.max(f64::MIN_POSITIVE));
        let longest = share.filter(|share| share.is_finite()).fold(0.0_f64, f64::max);
        if longest == 0.0 {
            return Ok(vec![0.0; n]);
        }
        let s = STEP / longest;
        let at = |side: f64| -> Result<Vec<f64>, Singular> {
            let moved: Vec<f64> = y.iter().zip(d).map(|(y, d)| y + side * s * d).collect();
            accelerations(&*self.full, t, &moved)
        };
        let (ahead, behind) = (at(1.0)?, at(-1.0)?);
        Ok(ahead.iter().zip(&behind).map(|(a, b)| (a - b) / (2.0 * s)).collect())
    }
}

fn accelerations(system: &dyn System, t: f64, y: &[f64]) -> Result<Vec<f64>, Singular> {
    let mut a = vec![0.0; system.len()];
    system.accelerations(At::packed(t, y, system.len()), &mut a)?;
    Ok(a)
}

impl System for Variation {
    fn description(&self) -> &Description {
        &self.description
    }

    fn accelerations(&self, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        let n = self.full.len();
        let part = |k: usize| [&at.q[k * n..][..n], &at.v[k * n..][..n]].concat();
        let [y, delta, w] = [0, 1, 2].map(part);
        let moved: Vec<f64> = y.iter().zip(&delta).map(|(y, delta)| y + delta).collect();
        let own = accelerations(&*self.full, at.t, &y)?;
        let [here, there] = [&y, &moved].map(|y| accelerations(&*self.without, at.t, y));
        let (here, there) = (here?, there?);
        let [first, second] = [self.along(at.t, &y, &delta)?, self.along(at.t, &y, &w)?];
        for i in 0..n {
            let defect = here[i] - own[i];
            a[i] = own[i];
            a[n + i] = first[i] + defect;
            a[2 * n + i] = second[i] + (there[i] - own[i] - first[i] - defect);
        }
        Ok(())
    }

    fn mass_matrix(&self, _: At<'_>, _: &mut [f64]) {}

    fn bias(&self, at: At<'_>, h: &mut [f64]) {
        match self.accelerations(at, h) {
            Ok(()) => h.iter_mut().for_each(|h| *h = -*h),
            Err(_) => h.fill(f64::NAN),
        }
    }

    fn residual(&self, at: At<'_>, f: &mut [f64]) {
        self.bias(at, f);
        f.iter_mut().zip(at.a).for_each(|(f, a)| *f += a);
    }

    fn jacobians(&self, _: At<'_>, _: &mut [f64], _: &mut [f64]) {}

    fn energy(&self, _: At<'_>) -> Energy {
        Energy::from_array([0.0; 5])
    }

    fn scene(&self, _: usize) -> Scene {
        Scene::default()
    }

    fn boxed_clone(&self) -> Box<dyn System> {
        Box::new(self.clone())
    }
}
