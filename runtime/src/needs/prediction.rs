//! What leaving out an ingredient changes, to first order along the full motion.
//!
//! With accelerations a(q, v, t) of the full model and ã of the one without, D = ã − a is what the ingredient does, and
//!
//! δ'' = ∂a/∂q δ + ∂a/∂v δ' + D,  z'' = ∂a/∂q z + ∂a/∂v z' + [ã(q + δ, v + δ') − a − ∂a/∂q δ − ∂a/∂v δ']
//!
//! are the first and the second approximation of the change (Newton and Kantorovich).  The prediction is the largest change of what is
//! wanted that δ makes; the law holds where z makes one that differs by less than half of that.  It says why a run changes as it does, and whether
//! twice as much would change it twice as much; what is left out is decided by runs.

use nalgebra::DVector;

use super::deviation::Motion;
use super::explicit::Explicit;
use super::full::Full;
use crate::events::switch_mode;
use crate::mechanism::dense::{force_slopes, mass_matrix};
use crate::mechanism::{Action, At, Coordinate, Event, Method, Singular, SingularMass, System};
use crate::run::{Names, evaluate_outputs};
use crate::simulate::{Settings, simulate};

/// A first approximation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Prediction {
    /// The largest change of what is wanted, in the measure of [`Deviation`](super::Deviation).
    pub change: f64,
    /// By which law.
    pub law: Law,
}

/// Why a change is as large as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Law {
    /// It is proportional to what is left out, along the full motion.
    Proportional {
        /// What the second approximation adds, in parts of the first.
        second: f64,
    },
    /// It is proportional to what is not linear about the place of rest, along the full motion.
    Linear {
        /// With which power of the amplitude the relative change grows: 2 where what is left out is of third order, 1 of second.
        power: f64,
        /// What the second approximation adds, in parts of the first.
        second: f64,
    },
    /// It is what the next step of the ladder, with more modes, changes beside this one.
    Richer {
        /// How many modes that has.
        kept: usize,
    },
    /// A stiff coordinate gives way as the force that would hold it over its stiffness, along the motion of the smaller model.
    Stiff {
        /// How many times faster it is than all else.
        gap: f64,
        /// What its own vibration, left over from the start, changes besides until the end, roughly.
        vibration: f64,
    },
}

impl Prediction {
    /// Whether its law holds.
    pub fn holds(&self) -> bool {
        match self.law {
            Law::Proportional { second } | Law::Linear { second, .. } => second < SMALL,
            Law::Richer { .. } => self.change < FEW,
            Law::Stiff { gap, vibration } => gap >= STIFF && vibration < VIBRATES * self.change && self.change <= WHOLE,
        }
    }
}

/// The law holds where the second approximation adds less than this part of the first.
const SMALL: f64 = 0.5;
/// And where the next step of the ladder is no other motion.
const FEW: f64 = 0.1;
/// And for a coordinate that is so many times faster than all else: what changes at that rate makes it give way by 1/gap² more.
const STIFF: f64 = 2.5;
/// And that changes no more than half of what is wanted.
pub(super) const WHOLE: f64 = 0.5;
/// And whose own vibration adds less than this part.
const VIBRATES: f64 = 0.25;
/// Its steps are equal, half as long on the average as those of the full motion: what begins as rounding is no error to them.
const SHORTER: f64 = 0.5;
/// They serve where they give the full motion to this part of ranges.
const SERVES: f64 = 1e-3;
/// Larger models are not worth it.
pub(super) const MOST_COORDINATES: usize = 12;
/// Motions of more steps are left alone.
pub(super) const MOST_STEPS: u64 = 100_000;

/// The change that a model without an ingredient makes to first order; `None` where it has other coordinates or
/// constraints, or either motion meets a discontinuity or an event that is not only recorded.  One that is linear is so about a place of rest.
pub(super) fn predicted(
    full: &Full,
    (without, settings, motion): (&dyn System, &Settings, &Motion),
    about: Option<&[f64]>,
) -> Option<Prediction> {
    let n = full.system.len();
    let names = |system: &dyn System| Names::of(system.description()).coordinates;
    if n > MOST_COORDINATES || full.motion.steps > MOST_STEPS || names(&*full.system) != names(without) {
        return None;
    }
    let (whole, without) = (&*undisturbed(&*full.system, &full.motion)?, &*undisturbed(without, motion)?);
    let mut variation = variation(whole, without);
    let both = |own: &[f64], other: &[f64]| -> Vec<f64> {
        let apart: Vec<f64> = own.iter().zip(other).map(|(own, other)| other - own).collect();
        [own, &apart, &apart].concat()
    };
    let along = Settings {
        q: both(&full.settings.q, &settings.q),
        v: both(&full.settings.v, &settings.v),
        held_q: Vec::new(),
        held_v: Vec::new(),
        spins: Vec::new(),
        every: Some((settings.until - settings.from) / full.times as f64),
        step: Some(SHORTER * (settings.until - settings.from) / full.motion.steps as f64),
        method: Method::Dop853,
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
    let (own, other) = (columns(whole)?, columns(without)?);
    let (mut first, mut second) = (0.0_f64, 0.0_f64);
    let mut defects = [0.0_f64; 2];
    for (row, state) in run.states().enumerate() {
        let part = |k: usize| [&state.q[k * n..][..n], &state.v[k * n..][..n]].concat();
        let [y, delta, z] = [0, 1, 2].map(part);
        let [moved, twice] = [delta, z].map(|by| y.iter().zip(by).map(|(y, by)| y + by).collect::<Vec<f64>>());
        for (defect, part) in defects.iter_mut().zip([1.0, 0.5]).filter(|_| about.is_some()) {
            let from = about.into_iter().flatten().copied().chain(std::iter::repeat(0.0));
            let nearer: Vec<f64> = y.iter().zip(from).map(|(y, from)| from + part * (y - from)).collect();
            *defect = defect.max(apart(whole, without, state.t, &nearer)?);
        }
        let before = wanted(whole, state.t, &y, &own);
        let [once, twice] = [moved, twice].map(|y| wanted(without, state.t, &y, &other));
        for (k, scale) in full.scales.iter().enumerate() {
            let reached =
                full.motion.values[k].get(row).is_some_and(|known| (known - before[k]).abs() <= SERVES * scale);
            if !reached {
                return None;
            }
            first = first.max((once[k] - before[k]).abs() / scale);
            second = second.max((twice[k] - once[k]).abs() / scale);
        }
    }
    let finite = first.is_finite() && second.is_finite();
    let second = if first > 0.0 { second / first } else { 0.0 };
    // A law of degree k + 1 beyond its linear part is a relative change like the k-th power of the amplitude.
    let law = match about {
        Some(_) => Law::Linear { power: (defects[0] / defects[1]).log2() - 1.0, second },
        None => Law::Proportional { second },
    };
    let known = !matches!(law, Law::Linear { power, .. } if !power.is_finite());
    (finite && known).then_some(Prediction { change: first, law })
}

/// The size of what two models' accelerations differ by, √(DᵀMD).
fn apart(full: &dyn System, without: &dyn System, t: f64, y: &[f64]) -> Option<f64> {
    let (own, other) = (accelerations(full, t, y).ok()?, accelerations(without, t, y).ok()?);
    let defect = DVector::from_iterator(own.len(), own.iter().zip(&other).map(|(own, other)| other - own));
    let mass = mass_matrix(full, At::packed(t, y, full.len()));
    Some((mass * &defect).dot(&defect).max(0.0).sqrt())
}

/// A system with its discontinuities on the sides on which a motion stays, where nothing takes time apart: `None` where there are
/// constraints, where the motion meets a discontinuity, and where an event happens that is not only recorded.
pub(super) fn undisturbed(system: &dyn System, motion: &Motion) -> Option<Box<dyn System>> {
    let description = system.description();
    let happens = |name: &str| motion.events.iter().any(|(known, _)| known == name);
    let acts = |event: &Event| event.actions.iter().any(|action| *action != Action::Record);
    let cut = description.events.iter().any(|event| acts(event) && happens(&event.name));
    if cut || !description.rows.is_empty() || description.phases.len() > 1 {
        return None;
    }
    let mut system = system.boxed_clone();
    let side = |values: &Vec<f64>| {
        let side = values.first()?.signum();
        values.iter().all(|value| value * side > 0.0).then_some(side)
    };
    let switches = motion.guards.iter().skip(description.events.len());
    let sides = switches.map(|(_, values)| side(values)).collect::<Option<Vec<f64>>>()?;
    let modes: Vec<f64> = sides.iter().enumerate().map(|(k, side)| switch_mode(&*system, k, *side)).collect();
    system.set_modes(&modes);
    Some(system)
}

/// What is wanted at a state.
pub(super) fn wanted(system: &dyn System, t: f64, y: &[f64], columns: &[usize]) -> Vec<f64> {
    let mut outputs = vec![f64::NAN; system.description().output_len()];
    evaluate_outputs(system, t, y, &mut vec![0.0; system.len()], &mut outputs);
    let all = [y, &outputs].concat();
    columns.iter().map(|column| all[*column]).collect()
}

/// The full motion with the two approximations of its change: coordinates (q, δ, z).
fn variation(full: &dyn System, without: &dyn System) -> Explicit {
    let coordinates = &full.description().coordinates;
    let tripled = ["", " first", " second"].into_iter().flat_map(|suffix| {
        let named =
            move |c: &Coordinate| Coordinate { name: format!("{}{suffix}", c.name).into(), unit: c.unit.clone() };
        coordinates.iter().map(named)
    });
    let (n, full, without) = (full.len(), full.boxed_clone(), without.boxed_clone());
    let law = move |at: At<'_>, a: &mut [f64]| {
        let part = |k: usize| [&at.q[k * n..][..n], &at.v[k * n..][..n]].concat();
        let [y, delta, z] = [0, 1, 2].map(part);
        let moved: Vec<f64> = y.iter().zip(&delta).map(|(y, delta)| y + delta).collect();
        let own = accelerations(&*full, at.t, &y)?;
        let [here, there] = [&y, &moved].map(|y| accelerations(&*without, at.t, y));
        let (here, there) = (here?, there?);
        let here_at = At::packed(at.t, &y, n).accelerated(&own);
        let [first, second] = along(&*full, here_at, [&delta, &z]).ok_or(SingularMass { coordinate: 0 })?;
        for i in 0..n {
            a[i] = own[i];
            a[n + i] = first[i] + (here[i] - own[i]);
            a[2 * n + i] = second[i] + (there[i] - own[i] - first[i]);
        }
        Ok(())
    };
    Explicit::new(tripled.collect(), law)
}

/// ∂a/∂q d + ∂a/∂v d' for directions d at a state with its accelerations: −M⁻¹ (∂F/∂q d + ∂F/∂v d').
fn along(system: &dyn System, at: At<'_>, directions: [&[f64]; 2]) -> Option<[Vec<f64>; 2]> {
    let n = system.len();
    let [dq, dv] = force_slopes(system, at);
    let factor = mass_matrix(system, at).cholesky()?;
    Some(directions.map(|d| {
        let (place, speed) = (DVector::from_column_slice(&d[..n]), DVector::from_column_slice(&d[n..]));
        (-factor.solve(&(&dq * place + &dv * speed))).iter().copied().collect()
    }))
}

fn accelerations(system: &dyn System, t: f64, y: &[f64]) -> Result<Vec<f64>, Singular> {
    let mut a = vec![0.0; system.len()];
    system.accelerations(At::packed(t, y, system.len()), &mut a)?;
    Ok(a)
}
