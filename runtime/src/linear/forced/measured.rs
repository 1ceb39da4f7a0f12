//! Frequency and damping read off a motion (TAM 4735, problem 21 b).

use std::f64::consts::TAU;

use crate::Run;

/// What the maxima of a free damped oscillation tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Time between maxima, s.
    pub period: f64,
    /// Logarithmic decrement δ: ln of the ratio of successive maxima, counted from rest.
    pub log_decrement: f64,
    /// How many maxima.
    pub maxima: usize,
}

impl Measured {
    /// The frequency seen, ω_d = 2π/T, rad/s.
    pub fn damped_omega(&self) -> f64 {
        TAU / self.period
    }

    /// The damping ratio ζ = δ/√(4π² + δ²).
    pub fn zeta(&self) -> f64 {
        self.log_decrement / TAU.hypot(self.log_decrement)
    }

    /// The frequency without damping, ω = ω_d/√(1 − ζ²), rad/s.
    pub fn omega(&self) -> f64 {
        self.damped_omega() / (1.0 - self.zeta().powi(2)).sqrt()
    }
}

/// Finds the maxima of a coordinate along a run, above its value at rest.
///
/// T and δ are means over all of them, exact for one damped mode; several modes at once, large amplitudes and dry
/// friction are not told apart from it.  `None` for fewer than two maxima, and for a run without dense output.
///
/// ```
/// use dalembert::linear::{LinearMechanism, measure};
/// use dalembert::{Settings, simulate};
/// use dalembert::mechanism::{Scene, System};
/// use nalgebra::DMatrix;
/// let one = |x| DMatrix::from_element(1, 1, x);
/// let mut oscillator = LinearMechanism::new(one(1.0), one(0.2), one(1.0))?;
/// let scene = Scene { q: vec![1.0], until: 40.0, ..oscillator.scene(0) };
/// let run = simulate(&mut oscillator, &Settings::new(&scene))?;
/// let measured = measure(&run, "x[1]", 0.0).unwrap();
/// assert!((measured.zeta() - 0.1).abs() < 1e-7 && (measured.omega() - 1.0).abs() < 1e-7);
/// # Ok::<(), dalembert::Error>(())
/// ```
pub fn measure(run: &Run, coordinate: &str, rest: f64) -> Option<Measured> {
    let speed_name = format!("{coordinate}'");
    let speed = |t: f64| run.at(t).and_then(|state| state.get(&speed_name));
    let mut found: Vec<(f64, f64)> = Vec::new();
    for pair in run.times().windows(2) {
        let (mut before, mut after) = (pair[0], pair[1]);
        if !(speed(before)? > 0.0 && speed(after)? <= 0.0) {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (before + after);
            if speed(middle)? > 0.0 { before = middle } else { after = middle }
        }
        found.push((after, run.at(after)?.get(coordinate)? - rest));
    }
    let ((first, high), (last, low)) = (*found.first()?, *found.last()?);
    let intervals = (found.len() - 1) as f64;
    let ratio = high / low;
    (intervals > 0.0 && ratio > 0.0).then(|| Measured {
        period: (last - first) / intervals,
        log_decrement: ratio.ln() / intervals,
        maxima: found.len(),
    })
}
