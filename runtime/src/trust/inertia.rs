//! Coordinates that fail where the mechanism does not.

use nalgebra::DMatrix;

use crate::cause::Cause;
use crate::mechanism::dense::mass_matrix;
use crate::mechanism::{At, Description, System};

/// Watches the diagonal of M for growth without bound.
///
/// Where a coordinate cannot describe the motion any further (a pendulum's horizontal position at the
/// horizontal), its inertia grows like 1/(t* − t)², and w = √(Mᵢᵢ(0)/Mᵢᵢ) falls to zero along a straight line.
/// A step may pass such a point with every sign of success, and 100 % of the energy in error (catalogue C1).
#[derive(Clone, Debug)]
pub(crate) struct InertiaGuard {
    /// M's diagonal; 0 where it is structurally zero.
    masses: Vec<f64>,
    start: Vec<f64>,
    began: f64,
    earlier: Vec<Sample>,
    latest: Vec<Sample>,
    /// The slope of w before these two, 1/s; not a number where there is none.
    slope: Vec<f64>,
    /// The last state.
    y: Vec<f64>,
    room: Vec<f64>,
}

/// w at a time.
#[derive(Clone, Copy, Debug, Default)]
struct Sample {
    t: f64,
    w: f64,
}

/// A coordinate's inertia grows without bound, or has become negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unbounded {
    /// True where it shrank to nothing instead of growing.
    pub shrank: bool,
    /// Which coordinate.
    pub coordinate: usize,
    /// When, s.
    pub t: f64,
}

impl Unbounded {
    /// The end of a run that came there.
    pub fn cause(self, mechanism: &Description) -> Cause {
        let coordinate = mechanism.coordinate_name(self.coordinate);
        match self.shrank {
            true => Cause::NegativeInertia { coordinate },
            false => Cause::CoordinateSingularity { coordinate, t: self.t },
        }
    }
}

/// A pivot is negative by more than this part of its diagonal, and by more than so many roundings made on the way there: a few for each of
/// the products that are subtracted.
const NOTHING: f64 = 1e-12;
const ROUNDINGS: f64 = 64.0;
/// More coordinates than this are judged by M's diagonal alone: its factors would cost more than a short run.
const LARGEST: usize = 60;

/// Refuses an M with a negative pivot: kinetic energy is never negative.
pub(crate) fn positive_inertia(system: &dyn System, t: f64, y: &[f64]) -> Result<(), Box<Cause>> {
    let description = system.description();
    let n = system.len();
    let below = |m: f64, size: f64| m < -NOTHING * size;
    let negative = |coordinate: usize| Cause::NegativeInertia { coordinate: description.coordinate_name(coordinate) };
    let mut values = Vec::new();
    if n > LARGEST {
        let mut diagonal = vec![0.0; n];
        system.inertias(At::packed(t, y, n), &mut values, &mut diagonal);
        let found = diagonal.iter().position(|m| below(*m, m.abs()));
        return found.map_or(Ok(()), |coordinate| Err(negative(coordinate).into()));
    }
    values.resize(description.mass_pattern.len(), 0.0);
    system.mass_matrix(At::packed(t, y, n), &mut values);
    let mut m = vec![0.0; n * n];
    for ((i, j), value) in description.mass_pattern.iter().zip(&values) {
        m[*i as usize * n + *j as usize] = *value;
    }
    // LDLᵀ row by row, as far as the pivots are positive.  One that is the part r of its diagonal leaves ε/r of later ones unknown.
    let mut least = 1.0_f64;
    for i in 0..n {
        let size = m[i * n + i].abs();
        for j in 0..i {
            let before: f64 = (0..j).map(|k| m[i * n + k] * m[j * n + k] * m[k * n + k]).sum();
            m[i * n + j] = (m[i * n + j] - before) / m[j * n + j];
        }
        let before: f64 = (0..i).map(|k| m[i * n + k].powi(2) * m[k * n + k]).sum();
        m[i * n + i] -= before;
        if below(m[i * n + i], size * (ROUNDINGS * f64::EPSILON / (NOTHING * least)).max(1.0)) {
            return Err(negative(i).into());
        }
        least = least.min(m[i * n + i] / size);
        if m[i * n + i].is_nan() || m[i * n + i] <= 0.0 {
            // Singular or not finite: the accelerations say so.
            return Ok(());
        }
    }
    Ok(())
}

/// The condition of M, each coordinate in its own measure: the largest eigenvalue over the least; 0 where M is diagonal, where it has too
/// many coordinates to be looked at, and where it is not finite.
pub(crate) fn inertia_condition(system: &dyn System, at: At<'_>) -> f64 {
    let n = system.len();
    if n > LARGEST || system.description().structure.diagonal_mass {
        return 0.0;
    }
    let m = mass_matrix(system, at);
    let size = m.diagonal().map(f64::sqrt);
    let scaled = DMatrix::from_fn(n, n, |i, j| m[(i, j)] / (size[i] * size[j]));
    if scaled.iter().any(|m| !m.is_finite()) {
        return 0.0;
    }
    let eigenvalues = scaled.symmetric_eigenvalues();
    eigenvalues.max() / eigenvalues.min().max(f64::EPSILON)
}

/// M grown by the inverse square of this is beyond bounds.
const SMALLEST: f64 = 1e-4;
/// w below this is a suspect once something else has gone wrong.
const SUSPECT: f64 = 0.3;
/// An inertia that grows without bound is so many times larger somewhere on the way there, which is looked at in these parts.
const GROWN: f64 = 25.0;
const PARTS: [f64; 7] = [0.5, 0.7, 0.85, 0.95, 1.0, 1.05, 1.2];
/// Unless it falls less steeply than before by this: an inertia that grows, but never without bound.
const FLATTENS: f64 = 0.7;

impl InertiaGuard {
    /// Notes M at the start; `None` where its diagonal is constant.
    pub fn new<S: System + ?Sized>(system: &S, t: f64, y: &[f64]) -> Option<Self> {
        let structure = &system.description().structure;
        if structure.constant_mass || structure.constant_inertias || system.is_empty() {
            return None;
        }
        let n = system.len();
        let mut guard = InertiaGuard {
            masses: vec![0.0; n],
            start: Vec::new(),
            began: t,
            earlier: vec![Sample { t, w: 1.0 }; n],
            latest: vec![Sample { t, w: 1.0 }; n],
            slope: vec![f64::NAN; n],
            y: y.to_vec(),
            room: Vec::new(),
        };
        guard.look(system, t, y);
        guard.start.clone_from(&guard.masses);
        Some(guard)
    }

    /// Looks at M after a step; tells if it has grown beyond bounds.
    pub fn observe<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) -> Option<Unbounded> {
        self.look(system, t, y);
        self.y.copy_from_slice(y);
        for i in 0..self.start.len() {
            let mass = self.masses[i];
            if !(self.start[i] > 0.0 && self.start[i].is_finite()) {
                continue;
            }
            let w = (self.start[i] / mass).sqrt();
            if !(mass > 0.0 && w > 0.0) {
                // Beyond the point: where the line through the last two samples meets zero.
                let (_, reached) = self.line(i);
                let shrank = mass < 0.0 && self.latest[i].w > 1.0;
                return Some(Unbounded { shrank, coordinate: i, t: reached.clamp(self.latest[i].t, t) });
            }
            self.slope[i] = self.slope(i);
            (self.earlier[i], self.latest[i]) = (self.latest[i], Sample { t, w });
            let (left, reached) = self.line(i);
            // What is small from the first step on began with next to no inertia, as a direction that constraints hold.
            let falls = self.slope[i].is_finite() && !self.flattens(i);
            if w < SMALLEST && left < 1e-3 * (t - self.began) && falls {
                return Some(Unbounded { shrank: false, coordinate: i, t: reached });
            }
        }
        None
    }

    /// Begins anew after the state was changed: there is no line through what was before.
    pub fn restart<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        self.look(system, t, y);
        for i in 0..self.start.len() {
            let mass = self.masses[i];
            let w = if mass == 0.0 && self.start[i] == 0.0 { 1.0 } else { (self.start[i] / mass).sqrt() };
            self.latest[i] = Sample { t, w };
        }
        self.earlier.copy_from_slice(&self.latest);
        self.slope.fill(f64::NAN);
        self.y.copy_from_slice(y);
    }

    /// A coordinate whose inertia seems to grow without bound within `ahead` seconds, and does where the motion would be by then.
    pub fn suspect(&self, system: &dyn System, ahead: f64) -> Option<Unbounded> {
        (0..self.start.len())
            .filter(|i| self.latest[*i].w < SUSPECT && !self.flattens(*i))
            .map(|i| (self.line(i), i))
            .filter(|((left, _), i)| *left <= ahead && self.grows_ahead(system, *i, *left))
            .min_by(|a, b| a.0.0.total_cmp(&b.0.0))
            .map(|((_, t), coordinate)| Unbounded { shrank: false, coordinate, t })
    }

    /// Whether the inertia of a coordinate is many times what it is now, or none, somewhere on the straight way of so many seconds.
    fn grows_ahead(&self, system: &dyn System, i: usize, left: f64) -> bool {
        let (q, v) = self.y.split_at(self.y.len() / 2);
        let (mut room, mut masses) = (Vec::new(), self.masses.clone());
        let mut mass = |part: f64| {
            let there: Vec<f64> = q.iter().zip(v).map(|(q, v)| q + part * left * v).collect();
            system.inertias(At::new(self.latest[i].t + part * left, &there, v), &mut room, &mut masses);
            masses[i]
        };
        let now = mass(0.0);
        // Beyond the point the coordinate means nothing.
        let grown = |mass: f64| !(0.0..GROWN * now).contains(&mass);
        PARTS.into_iter().any(|part| grown(mass(part)))
    }

    /// The length of the last step, s.
    pub fn last_step(&self) -> f64 {
        self.latest.first().zip(self.earlier.first()).map_or(0.0, |(b, a)| b.t - a.t)
    }

    fn look<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        system.inertias(At::packed(t, y, system.len()), &mut self.room, &mut self.masses);
    }

    /// Whether w falls less steeply than it did, as far as two slopes of it are known.
    fn flattens(&self, i: usize) -> bool {
        self.slope(i).abs() < FLATTENS * self.slope[i].abs()
    }

    /// The slope of w between its last two samples, 1/s.
    fn slope(&self, i: usize) -> f64 {
        let (a, b) = (self.earlier[i], self.latest[i]);
        (b.w - a.w) / (b.t - a.t)
    }

    /// How long until the line through the last two samples of w meets zero, and when that is.
    fn line(&self, i: usize) -> (f64, f64) {
        let (a, b) = (self.earlier[i], self.latest[i]);
        let left = if b.w < a.w { b.w * (b.t - a.t) / (a.w - b.w) } else { f64::INFINITY };
        (left, b.t + left)
    }
}
