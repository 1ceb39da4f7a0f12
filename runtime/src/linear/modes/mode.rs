//! One mode of small motions.

use std::f64::consts::TAU;
use std::fmt;

use nalgebra::{Complex, DMatrix, DVector};

use crate::linear::{Linearised, SparseMatrix, short_within};

/// What a mode does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Goes on for ever: cos ωt.
    Oscillating,
    /// Dies out while oscillating, 0 < ζ < 1.
    Damped,
    /// Dies out without oscillating, two equal eigenvalues: (A + B t) e^(−ωt).
    Critical,
    /// Dies out without oscillating, a real eigenvalue.
    Overdamped,
    /// Dies out without oscillating where nothing damps: the other half of one that grows.
    Decaying,
    /// A motion without potential energy: A + B t.
    Rigid,
    /// Grows.
    Unstable,
}

impl Kind {
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Kind::Oscillating => "oscillating",
            Kind::Damped => "damped",
            Kind::Critical => "critical",
            Kind::Overdamped => "overdamped",
            Kind::Decaying => "decaying",
            Kind::Rigid => "rigid",
            Kind::Unstable => "unstable",
        }
    }
}

/// A mode: x(t) = Re(shape · e^(λt)).
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// ω, rad/s: |λ|; √(λ₁λ₂) of two real eigenvalues that belong together; 0 of a rigid mode.
    pub omega: f64,
    /// ζ, −Re λ/ω; above 1 for two real eigenvalues that belong together, negative for growing motions; `None` of a
    /// rigid mode.
    pub zeta: Option<f64>,
    /// λ, 1/s, the one with Im λ ≥ 0 of a conjugate pair.
    pub eigenvalue: Complex<f64>,
    /// What it does.
    pub kind: Kind,
    /// φ with φᴴ M φ = 1, real in the coordinate that has the largest part of the kinetic energy, and positive in its first one that is not negligible.
    pub shape: Vec<Complex<f64>>,
    /// (coordinate, part of the kinetic energy), largest first, of those that carry at least a hundredth.
    pub carriers: Vec<(String, f64)>,
    /// How much of the eigenvalue, as a part of it, rounding of the elements of M, C and K can change.
    pub uncertainty: f64,
    /// True where another frequency is equal, or so near (10⁶ ε ‖K‖) that only the space spanned by the shapes
    /// has a meaning, not each of them.
    pub repeated: bool,
    /// True where another mode has this eigenvalue and this shape: motions are (A + B t) e^(λt).
    pub secular: bool,
    /// What a motion without stiffness is, `translation along x` or `mechanism 1`, where it is known.
    pub name: Option<String>,
}

impl Mode {
    /// Normalises the shape and finds what carries the energy.
    pub(in crate::linear) fn new(
        shape: Vec<Complex<f64>>,
        mass: &SparseMatrix,
        names: &[String],
        what: (f64, Option<f64>, Complex<f64>, Kind),
    ) -> Mode {
        let mut momentum = vec![Complex::new(0.0, 0.0); shape.len()];
        for (row, column, value) in &mass.entries {
            momentum[*row as usize] += shape[*column as usize] * *value;
        }
        Mode::with_momentum(shape, &momentum, names, what)
    }

    /// The same with M φ.
    pub(super) fn with_momentum(
        mut shape: Vec<Complex<f64>>,
        momentum: &[Complex<f64>],
        names: &[String],
        (omega, zeta, eigenvalue, kind): (f64, Option<f64>, Complex<f64>, Kind),
    ) -> Mode {
        let parts: Vec<f64> = shape.iter().zip(momentum).map(|(x, p)| (x.conj() * p).re).collect();
        let energy: f64 = parts.iter().sum();
        let factor = in_phase(&shape, &parts) / energy.sqrt();
        for x in &mut shape {
            *x *= factor;
        }
        // Where M couples coordinates, what each has of the energy may be negative: its size counts.
        let sizes: f64 = parts.iter().map(|part| part.abs()).sum();
        let carry = names.iter().zip(parts.iter().map(|part| part.abs() / sizes)).filter(|(_, part)| *part >= 0.01);
        let mut carriers: Vec<(String, f64)> = carry.map(|(name, part)| (name.clone(), part)).collect();
        carriers.sort_by(|a, b| b.1.total_cmp(&a.1));
        Mode {
            omega,
            zeta,
            eigenvalue,
            kind,
            shape,
            carriers,
            uncertainty: 0.0,
            repeated: false,
            secular: false,
            name: None,
        }
    }

    /// Notes how much of each eigenvalue rounding of M, C and K can change: εφᴴ(|λ|²|M| + |λ||C| + |K|)φ beside twice |λ|²φᴴMφ.
    pub(in crate::linear) fn note_uncertainties(modes: &mut [Mode], linear: &Linearised) {
        let sizes = DMatrix::from_fn(linear.len(), modes.len(), |i, k| modes[k].shape[i].norm());
        let forms = [&linear.mass, &linear.damping, &linear.stiffness].map(|matrix| {
            let products = if matrix.is_zero() { &sizes * 0.0 } else { matrix.to_dense().abs() * &sizes };
            DVector::from_fn(modes.len(), |k, _| products.column(k).dot(&sizes.column(k)))
        });
        let [inertia, damping, stiffness] = forms;
        for (k, mode) in modes.iter_mut().enumerate() {
            let rate = mode.eigenvalue.norm();
            if rate > 0.0 {
                let parts = inertia[k] + damping[k] / rate + stiffness[k] / rate / rate;
                mode.uncertainty = 0.5 * f64::EPSILON * parts;
            }
        }
    }

    /// The time in which the motion falls to 1/e of itself, −1/Re λ, s; `None` where it does not fall.
    pub fn decay_time(&self) -> Option<f64> {
        (self.eigenvalue.re < 0.0).then(|| -1.0 / self.eigenvalue.re)
    }

    /// The time in which the motion grows by e, 1/Re λ, s; `None` where it does not grow.
    pub fn growth_time(&self) -> Option<f64> {
        (self.kind == Kind::Unstable).then(|| 1.0 / self.eigenvalue.re)
    }

    /// The frequency at which it is seen to oscillate, Im λ, rad/s; the damped one where there is damping.
    pub fn damped_omega(&self) -> f64 {
        self.eigenvalue.im
    }

    /// The real parts of the shape.
    pub fn real_shape(&self) -> Vec<f64> {
        self.shape.iter().map(|x| x.re).collect()
    }
}

/// Coordinates whose sizes differ by less than this part are equally large: the first of them counts.
const EQUALLY_LARGE: f64 = 1e-6;
/// Components below this part of the largest decide no sign.
const NEGLIGIBLE: f64 = 1e-6;

/// The factor of size 1 that makes a shape real where it is largest, by the parts of the kinetic energy, and positive in its
/// first coordinate that is not negligible.
fn in_phase(shape: &[Complex<f64>], parts: &[f64]) -> Complex<f64> {
    let most = parts.iter().fold(0.0_f64, |most, part| most.max(*part));
    let leading = shape.iter().zip(parts).find(|(x, part)| **part >= (1.0 - EQUALLY_LARGE) * most && x.norm() > 0.0);
    let turn = leading.map_or(Complex::new(1.0, 0.0), |(x, _)| x.conj() / x.norm());
    let largest = shape.iter().fold(0.0_f64, |most, x| most.max(x.norm()));
    let first = shape.iter().map(|x| x * turn).find(|x| x.norm() > NEGLIGIBLE * largest);
    if first.is_some_and(|x| x.re < 0.0) { -turn } else { turn }
}

impl fmt::Display for Mode {
    /// `damped, omega = 1.2 rad/s, zeta = 0.1, damped frequency 1.194 rad/s (0.19 Hz), time constant 8.3 s; participation: x 90 %, y 10 %`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let whole = |x: f64| short_within(x, self.uncertainty);
        // Of a small part of the eigenvalue less is known.
        let part = |x: f64, of: f64| short_within(x, self.uncertainty * self.eigenvalue.norm() / of.abs());
        let (omega, seen) = (whole(self.omega), part(self.eigenvalue.im, self.eigenvalue.im));
        let growth = part(1.0 / self.eigenvalue.re, self.eigenvalue.re);
        match self.kind {
            Kind::Rigid => match &self.name {
                Some(name) => write!(f, "rigid, no stiffness: {name}")?,
                None => write!(f, "rigid, no stiffness")?,
            },
            Kind::Unstable if self.eigenvalue.im == 0.0 => write!(f, "unstable, grows by e in {growth} s")?,
            Kind::Unstable => write!(
                f,
                "unstable, omega = {seen} rad/s, {} Hz, grows by e in {growth} s",
                part(self.eigenvalue.im / TAU, self.eigenvalue.im)
            )?,
            Kind::Oscillating => write!(
                f,
                "oscillating, omega = {omega} rad/s, {} Hz, period {} s",
                whole(self.omega / TAU),
                whole(TAU / self.omega)
            )?,
            Kind::Decaying => {
                let time = part(-1.0 / self.eigenvalue.re, self.eigenvalue.re);
                write!(f, "decaying, falls to 1/e in {time} s though nothing damps: the other half of one that grows")?;
            }
            kind => {
                write!(f, "{}, omega = {omega} rad/s", kind.word())?;
                if let Some(zeta) = self.zeta {
                    write!(f, ", zeta = {}", part(zeta, self.eigenvalue.re))?;
                }
                if kind == Kind::Damped {
                    write!(
                        f,
                        ", damped frequency {seen} rad/s ({} Hz)",
                        part(self.eigenvalue.im / TAU, self.eigenvalue.im)
                    )?;
                }
                if let Some(time) = self.decay_time() {
                    write!(f, ", time constant {} s", part(time, self.eigenvalue.re))?;
                }
            }
        }
        if self.secular {
            write!(f, ", secular: with a factor A + B t")?;
        }
        for (index, (name, part)) in self.carriers.iter().take(4).enumerate() {
            write!(f, "{}{name} {:.0} %", if index == 0 { "; participation: " } else { ", " }, 100.0 * part)?;
        }
        Ok(())
    }
}
