//! What holding a fast coordinate changes, along the motion of the model that holds it.
//!
//! Held at z₁(s, t), or following the other coordinates s there, z is kept by a reaction R(t) = F_z along the smaller model's motion.
//! Let go it gives way by ζ = −R/(∂F_z/∂z), as a spring under a load that changes slowly; what that motion, z₁ + ζ, makes of the others is
//! the prediction, and the stiff model is never run.
//!
//! What the start leaves over, z(0) − z₁ − ζ, vibrates by A in the fast mode Φ, s following z without forces on it, with
//! ω² = ΦᵀKΦ/ΦᵀMΦ.  Quantities that read it show A; on the others its effect is of second order and grows with time, some
//! ½ (A/L)² ω_s T with the length L on which √M of the others varies.  The law holds where z is some times faster than all else, and that is a
//! small part of the change; at ω near 2 ω_s, and for a bounce, it does not.

use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::channel::Channel;
use super::deviation::Motion;
use super::explicit::Explicit;
use super::full::Full;
use super::prediction::{Law, MOST_COORDINATES, MOST_STEPS, Prediction, undisturbed, wanted};
use crate::mechanism::dense::{force_slopes, mass_matrix};
use crate::mechanism::{At, Method, Singular, SingularMass, System};
use crate::run::Names;
use crate::simulate::{Settings, simulate};

/// A vibration is looked at in so many phases.
const PHASES: u32 = 8;
/// Speeds are compared at so many times.
const COMPARED: usize = 20;
/// Newton's method on one force that is nearly linear.
const ROUNDS: u32 = 4;

/// The change that a coordinate makes which is held at a place, or follows the others where the forces on it vanish (`None`); `None` where
/// it is not the stiffest, or there are constraints, or either motion meets a discontinuity or an event that is not only recorded.
pub(super) fn predicted(
    full: &Full,
    (reduced, settings, motion): (&dyn System, &Settings, &Motion),
    (held, place): (&str, Option<f64>),
) -> Option<Prediction> {
    let names = Names::of(full.system.description()).coordinates;
    let own = Names::of(reduced.description()).coordinates;
    let z = names.iter().position(|name| name == held)?;
    let others = own.iter().map(|name| names.iter().position(|known| known == name)).collect::<Option<Vec<usize>>>()?;
    if others.len() + 1 != names.len() || names.len() > MOST_COORDINATES || motion.steps > MOST_STEPS {
        return None;
    }
    let (system, reduced) = (undisturbed(&*full.system, &full.motion)?, &*undisturbed(reduced, motion)?);
    let mut slow = reduced.boxed_clone();
    let every = (settings.until - settings.from) / (motion.times.len() - 1) as f64;
    let exact = Settings {
        every: Some(every),
        tolerance: full.tolerance,
        method: Method::Dop853,
        dense: false,
        watch: false,
        digits: false,
        ..settings.clone()
    };
    let run = simulate(&mut *slow, &exact).ok()?;
    let alike = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-3 * every;
    if run.times().len() != motion.times.len() || !run.times().iter().zip(&motion.times).all(alike) {
        return None;
    }
    let split = Split { system, z, others };
    let mut states = Vec::with_capacity(run.times().len());
    for state in run.states() {
        let mut a = vec![0.0; own.len()];
        reduced.accelerations(At::new(state.t, &state.q, &state.v), &mut a).ok()?;
        states.push(Slow { t: state.t, s: state.q, v: state.v, a });
    }
    let response = Response::new(split, &states, (settings.from, every), place, (&full.settings.q, &full.settings.v))?;
    response.prediction(full, reduced, (&exact, motion))
}

/// Coordinates as one that is fast and the others.
struct Split {
    system: Box<dyn System>,
    z: usize,
    /// Places of the others.
    others: Vec<usize>,
}

/// The smaller model at a time.
struct Slow {
    t: f64,
    s: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
}

impl Split {
    fn joined(&self, s: &[f64], z: f64) -> Vec<f64> {
        let mut all = vec![z; s.len() + 1];
        self.others.iter().zip(s).for_each(|(place, s)| all[*place] = *s);
        all
    }

    fn residual(&self, t: f64, [q, v, a]: [&[f64]; 3]) -> Vec<f64> {
        let mut f = vec![0.0; q.len()];
        self.system.residual(At::new(t, q, v).accelerated(a), &mut f);
        f
    }

    /// S: how all move with s, where z follows by these slopes.
    fn moves(&self, slopes: &[f64]) -> DMatrix<f64> {
        let mut moves = DMatrix::zeros(slopes.len() + 1, slopes.len());
        for (column, (place, slope)) in self.others.iter().zip(slopes).enumerate() {
            moves[(*place, column)] = 1.0;
            moves[(self.z, column)] = *slope;
        }
        moves
    }

    /// Where the force on z vanishes while all rests, by Newton's method.
    fn resting(&self, t: f64, s: &[f64], from: f64) -> Option<f64> {
        let still = vec![0.0; s.len() + 1];
        (0..ROUNDS).try_fold(from, |z, _| {
            let q = self.joined(s, z);
            let all = [q.as_slice(), &still, &still];
            Some(z - self.residual(t, all)[self.z] / self.stiffness(t, all)?)
        })
    }

    /// ∂z/∂s by which z follows where the force on it stays: −(∂F_z/∂s)/(∂F_z/∂z).
    fn following(&self, at: At<'_>) -> Vec<f64> {
        let [slopes, _] = force_slopes(&*self.system, at);
        self.others.iter().map(|place| -slopes[(self.z, *place)] / slopes[(self.z, self.z)]).collect()
    }

    /// How fast all else is: the square root of the largest eigenvalue of (SᵀMS)⁻¹ SᵀKS.
    fn fastest(&self, at: At<'_>, moves: &DMatrix<f64>) -> Option<f64> {
        let [stiffness, _] = force_slopes(&*self.system, at);
        let mass = (moves.tr_mul(&mass_matrix(&*self.system, at)) * moves).cholesky()?;
        largest_eigenvalue(mass.solve(&(moves.tr_mul(&stiffness) * moves))).map(f64::sqrt)
    }

    /// By which part a vibration of z changes the square root of SᵀMS: a quarter of the largest eigenvalue of M⁻¹ (M₊ − M₋).
    fn shaken(&self, t: f64, q: &[f64], moves: &DMatrix<f64>, amplitude: f64) -> Option<f64> {
        let still = vec![0.0; q.len()];
        let [before, after] = [-amplitude, amplitude].map(|w| {
            let mut q = q.to_vec();
            q[self.z] += w;
            moves.tr_mul(&mass_matrix(&*self.system, At::new(t, &q, &still))) * moves
        });
        let mean = (0.5 * (&after + &before)).cholesky()?;
        largest_eigenvalue(mean.solve(&(after - before))).map(|largest| 0.25 * largest)
    }

    /// ∂F_z/∂z, where it is positive.
    fn stiffness(&self, t: f64, [q, v, a]: [&[f64]; 3]) -> Option<f64> {
        let [slopes, _] = force_slopes(&*self.system, At::new(t, q, v).accelerated(a));
        Some(slopes[(self.z, self.z)]).filter(|slope| *slope > 0.0 && slope.is_finite())
    }
}

/// z with what it gives way along the smaller model's motion, and what vibrates.
struct Response {
    split: Split,
    /// z₁ + ζ along the motion.
    place: Channel,
    /// By which slopes it follows s where that is elsewhere, and s.
    slopes: Vec<Channel>,
    slow: Vec<Channel>,
    /// Where s starts when what vibrates is taken from it.
    start: [Vec<f64>; 2],
    /// A, with Φ and ω at each of the motion's times.
    amplitude: f64,
    modes: Vec<Mode>,
    /// How many times faster z is than all else.
    gap: f64,
    /// ½ (A/L)² ω_s T.
    vibration: f64,
}

impl Response {
    fn new(
        split: Split,
        states: &[Slow],
        grid: (f64, f64),
        held: Option<f64>,
        (q, v): (&[f64], &[f64]),
    ) -> Option<Response> {
        let m = split.others.len();
        let mut from = q[split.z];
        let mut rest = Vec::with_capacity(states.len());
        for state in states {
            from = held.or_else(|| split.resting(state.t, &state.s, from))?;
            rest.push(from);
        }
        let own = Channel::of_values(grid, &rest)?;
        // How it gives way, and how fast it and all else are.
        let (mut ways, mut slopes, mut modes) = (Vec::new(), Vec::new(), Vec::new());
        let (mut fastest, compared) = (0.0_f64, (states.len() / COMPARED).max(1));
        for (k, (state, [z, dz, ddz])) in states.iter().zip(own.nodes()).enumerate() {
            let (rates, accelerations) = (split.joined(&state.v, *dz), split.joined(&state.a, *ddz));
            let mut way = 0.0;
            for _ in 0..ROUNDS {
                let q = split.joined(&state.s, z + way);
                let all = [q.as_slice(), &rates, &accelerations];
                way -= split.residual(state.t, all)[split.z] / split.stiffness(state.t, all)?;
            }
            ways.push(way);
            let q = split.joined(&state.s, z + way);
            let at = At::new(state.t, &q, &rates).accelerated(&accelerations);
            slopes.push(split.following(at));
            let moves = split.moves(&slopes[k]);
            modes.push(Mode::at(&split, at, &moves)?);
            if k % compared == 0 {
                fastest = fastest.max(split.fastest(at, &moves)?);
            }
        }
        let given = Channel::of_values(grid, &ways)?;
        let place: Vec<f64> = own.nodes().iter().zip(&ways).map(|(own, way)| own[0] + way).collect();
        let place = Channel::of_values(grid, &place)?;
        if !given.is_resolved() || !place.is_resolved() {
            return None;
        }
        let least = modes.iter().fold(f64::INFINITY, |least, mode| mode.omega.min(least));
        let rates = split.others.iter().zip(&states[0].v).map(|(place, slow)| v[*place] - slow);
        let following: f64 = slopes[0].iter().zip(rates).map(|(slope, rate)| slope * rate).sum();
        let [z, dz, _] = place.at(grid.0);
        let away = [q[split.z] - z, v[split.z] - dz - following];
        let first = &modes[0];
        let start = [(q, away[0]), (v, away[1])]
            .map(|(all, away)| split.others.iter().map(|place| all[*place] - away * first.shape[*place]).collect());
        let amplitude = away[0].hypot(away[1] / first.omega);
        let mut shaken = 0.0_f64;
        for (k, state) in states.iter().enumerate().step_by(compared) {
            let q = split.joined(&state.s, place.nodes()[k][0]);
            shaken = shaken.max(split.shaken(state.t, &q, &split.moves(&slopes[k]), amplitude)?);
        }
        let lasts = (grid.1 * (states.len() - 1) as f64).min(first.mass / first.damping);
        Some(Response {
            place,
            slopes: (0..m)
                .map(|j| Channel::of_values(grid, &slopes.iter().map(|slopes| slopes[j]).collect::<Vec<f64>>()))
                .collect::<Option<_>>()?,
            slow: (0..m)
                .map(|j| states.iter().map(|state| [state.s[j], state.v[j], state.a[j]]).collect())
                .map(|nodes| Channel::of_nodes(grid, nodes))
                .collect(),
            start,
            amplitude,
            gap: least / fastest.max(rate_of(&given)),
            vibration: 0.5 * shaken * shaken * fastest * lasts,
            modes,
            split,
        })
    }

    /// (q, q', q'') for s without accelerations of its own, and how all move with it.
    fn state(&self, at: At<'_>) -> ([Vec<f64>; 3], DMatrix<f64>) {
        let slopes: Vec<[f64; 3]> = self.slopes.iter().map(|channel| channel.at(at.t)).collect();
        let [mut z, mut dz, mut ddz] = self.place.at(at.t);
        for (((c, slow), s), v) in slopes.iter().zip(&self.slow).zip(at.q).zip(at.v) {
            let slow = slow.at(at.t);
            let (off, rate) = (s - slow[0], v - slow[1]);
            z += c[0] * off;
            dz += c[1] * off + c[0] * rate;
            ddz += c[2] * off + 2.0 * c[1] * rate - c[0] * slow[2];
        }
        let still = vec![0.0; at.q.len()];
        let joined = [(at.q, z), (at.v, dz), (&still, ddz)].map(|(s, z)| self.split.joined(s, z));
        (joined, self.split.moves(&slopes.iter().map(|slope| slope[0]).collect::<Vec<f64>>()))
    }

    /// s'' where z moves so: Sᵀ F = 0.
    fn accelerations(&self, at: At<'_>) -> Option<DVector<f64>> {
        let ([q, v, a], moves) = self.state(at);
        let force = moves.tr_mul(&DVector::from_vec(self.split.residual(at.t, [&q, &v, &a])));
        let mass = moves.tr_mul(&mass_matrix(&*self.split.system, At::new(at.t, &q, &v))) * &moves;
        mass.cholesky().map(|factor| -factor.solve(&force))
    }

    fn prediction(
        self,
        full: &Full,
        reduced: &dyn System,
        (settings, motion): (&Settings, &Motion),
    ) -> Option<Prediction> {
        let response = Arc::new(self);
        let law = {
            let response = response.clone();
            move |at: At<'_>, a: &mut [f64]| -> Result<(), Singular> {
                let found = response.accelerations(at).ok_or(SingularMass { coordinate: 0 })?;
                a.copy_from_slice(found.as_slice());
                Ok(())
            }
        };
        let [q, v] = response.start.clone();
        let (held_q, held_v, spins) = (Vec::new(), Vec::new(), Vec::new());
        let settings = Settings { q, v, held_q, held_v, spins, tolerance: 0.1 * full.tolerance, ..settings.clone() };
        let mut system = Explicit::new(reduced.description().coordinates.to_vec(), law);
        let run = simulate(&mut system, &settings).ok()?;
        let all = Names::of(full.system.description()).columns();
        let place = |name: &String| all.iter().position(|known| known == name);
        let columns = full.need.outputs.iter().map(place).collect::<Option<Vec<usize>>>()?;
        let mut change = 0.0_f64;
        for ((row, state), mode) in run.states().enumerate().zip(&response.modes) {
            let ([q, v, _], _) = response.state(At::new(state.t, &state.q, &state.v));
            for phase in (0..PHASES).map(|k| TAU * f64::from(k) / f64::from(PHASES)) {
                let [w, dw] = [phase.cos(), -mode.omega * phase.sin()].map(|part| response.amplitude * part);
                let moved = [(&q, w), (&v, dw)].map(|(all, w)| {
                    all.iter().zip(&mode.shape).map(|(all, part)| all + w * part).collect::<Vec<f64>>()
                });
                let found = wanted(&*response.split.system, state.t, &moved.concat(), &columns);
                for ((found, known), scale) in found.iter().zip(&motion.values).zip(&full.scales) {
                    let off = (found - known.get(row)?).abs() / scale;
                    if !off.is_finite() {
                        return None;
                    }
                    change = change.max(off);
                }
            }
        }
        let law = Law::Stiff { gap: response.gap, vibration: response.vibration };
        let is_fast = response.gap >= 1.0 && response.vibration.is_finite();
        is_fast.then_some(Prediction { change, law })
    }
}

/// z alone, the others following it without forces on them.
struct Mode {
    /// Φ, 1 for z.
    shape: Vec<f64>,
    /// ΦᵀMΦ, ΦᵀDΦ and ω.
    mass: f64,
    damping: f64,
    omega: f64,
}

impl Mode {
    fn at(split: &Split, at: At<'_>, moves: &DMatrix<f64>) -> Option<Mode> {
        let mass = mass_matrix(&*split.system, at);
        let [stiffness, damping] = force_slopes(&*split.system, at);
        let own = (moves.tr_mul(&mass) * moves).cholesky()?;
        let mut shape = DVector::zeros(mass.nrows());
        shape[split.z] = 1.0;
        shape -= moves * own.solve(&moves.tr_mul(&(&mass * &shape)));
        let along = |matrix: &DMatrix<f64>| (matrix * &shape).dot(&shape);
        let [mass, damping, stiffness] = [&mass, &damping, &stiffness].map(along);
        let omega = (stiffness / mass).sqrt();
        let shape = shape.iter().copied().collect();
        (omega > 0.0 && omega.is_finite()).then_some(Mode { shape, mass, damping: damping.max(0.0), omega })
    }
}

/// The size of the largest eigenvalue; `None` where an entry is no number, of which there is none.
fn largest_eigenvalue(matrix: DMatrix<f64>) -> Option<f64> {
    let finite = matrix.iter().all(|entry| entry.is_finite());
    finite.then(|| matrix.complex_eigenvalues().iter().fold(0.0, |most, value| value.norm().max(most)))
}

/// How fast a quantity goes back and forth: √(max |f''| / half its range).
pub(super) fn rate_of(channel: &Channel) -> f64 {
    let nodes = channel.nodes();
    let (low, high) =
        nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), node| (l.min(node[0]), h.max(node[0])));
    let most = nodes.iter().fold(0.0_f64, |most, node| most.max(node[2].abs()));
    let half = 0.5 * (high - low);
    if half > 1e-9 * low.abs().max(high.abs()) { (most / half).sqrt() } else { 0.0 }
}
