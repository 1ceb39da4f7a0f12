//! States between those of a branch, so that paths of eigenvalues are smooth where they are drawn.

use nalgebra::Complex;

use super::continuation::Continuation;
use super::{Branch, BranchPoint, State, Varied, balance};
use crate::linear::LinearError;
use crate::linear::equilibrium::Guess;
use crate::linear::modes::matched;
use crate::mechanism::System;

/// Pixels of a picture, across and up.
const PICTURE: [f64; 2] = [600.0, 350.0];
/// A path that turns by less between the halves of a piece is straight.
const STRAIGHT: f64 = 0.025;
/// An eigenvalue that moves by more of its distance from the next one may be taken for that.
const AMBIGUOUS: f64 = 0.5;
/// Halvings of the distance of two states.
const DEEPEST: u32 = 40;

impl Branch {
    /// The states of the branch that come first at their value, without those behind folds, and as many more between them as smooth paths of
    /// eigenvalues take: from one state to the next paths turn by no more than some 3°, or eigenvalues move by less than a
    /// pixel of a picture that shows all of them, and none is taken for another, through collisions too.
    ///
    /// `system`, `parameter` and `guess` are those of [`follow`](super::follow).  Where another branch had to be taken, or
    /// the branch goes on behind folds, nothing is put between.
    ///
    /// # Errors
    /// [`LinearError::WrongSize`] for a parameter that does not exist; numbers that are not finite.
    ///
    /// # Example
    /// The eigenvalues of x'' + c x' + x = 0 go along the unit circle, meet at −1 and part along the axis:
    /// ```
    /// use dalembert::linear::{Guess, Varied, follow};
    /// use dalembert::mechanism::Dynamic;
    /// # mod example {
    /// dalembert::model!(yaml = r#"
    /// name: Damped
    /// parameters: {c: 0}
    /// coordinates: {x: }
    /// kinetic_energy: x'^2/2
    /// potential_energy: x^2/2
    /// dissipation: c*x'^2/2
    /// "#);
    /// # }
    /// # use example::Damped;
    /// # fn main() -> Result<(), dalembert::linear::LinearError> {
    /// # #[cfg(feature = "modal")] {
    /// let (system, guess) = (Dynamic::new(Damped::default()), Guess::at(&[0.0]));
    /// let c = Varied::Parameter(0);
    /// let branch = follow(&system, &c, (0.0, 3.0), &guess)?;
    /// let points = branch.smooth(&system, &c, &guess)?;
    /// let nearest = |point: &dalembert::linear::BranchPoint| (point.eigenvalues[0] + 1.0).norm();
    /// assert!(points.iter().map(nearest).fold(1.0, f64::min) < 0.005);
    /// # }
    /// # Ok(())
    /// # }
    /// ```
    pub fn smooth<S: System + ?Sized>(
        &self,
        system: &S,
        varied: &Varied,
        guess: &Guess,
    ) -> Result<Vec<BranchPoint>, LinearError> {
        let known: Vec<&BranchPoint> = self.points.iter().filter(|point| !point.folded).collect();
        let (Some(first), Some(last)) = (known.first(), known.last()) else { return Ok(Vec::new()) };
        if first.value == last.value {
            return Ok(known.into_iter().cloned().collect());
        }
        let range = (first.value.min(last.value), first.value.max(last.value));
        let continuation = Continuation::new(balance(system, varied, guess)?, range)?;
        continuation.note_zeros(known.iter().map(|point| (point.value, point.q.as_slice())));
        let size = continuation.size();
        let mut between = Between { continuation, pixel: pixel(&known), left: 100_000 / (1 + size * size / 20) };
        let mut points = vec![(*first).clone()];
        for pair in known.windows(2) {
            if self.joins(pair[0], pair[1]) {
                between.put(pair[0], pair[1], 0, &mut points);
            }
            points.push(pair[1].clone());
        }
        Ok(points)
    }
}

/// The size of a pixel, in both directions, of a picture that shows all eigenvalues.
fn pixel(points: &[&BranchPoint]) -> [f64; 2] {
    let all = || points.iter().flat_map(|point| &point.eigenvalues);
    let ends = |of: fn(&Complex<f64>) -> f64| {
        all().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let size = |(low, high): (f64, f64), pixels: f64| {
        let size = (high - low) / pixels;
        if size > 0.0 && size.is_finite() { size } else { 1.0 }
    };
    [size(ends(|x| x.re), PICTURE[0]), size(ends(|x| x.im), PICTURE[1])]
}

struct Between {
    continuation: Continuation,
    pixel: [f64; 2],
    /// States that may still be computed.
    left: usize,
}

impl Between {
    /// Adds what is needed between two states.
    fn put(&mut self, a: &BranchPoint, b: &BranchPoint, depth: u32, points: &mut Vec<BranchPoint>) {
        if depth >= DEEPEST || self.left == 0 || self.is_short(a, b) {
            return;
        }
        let Some(middle) = self.middle(a, b) else { return };
        if self.is_straight(a, &middle, b) {
            return;
        }
        self.put(a, &middle, depth + 1, points);
        points.push(middle.clone());
        self.put(&middle, b, depth + 1, points);
    }

    fn middle(&mut self, a: &BranchPoint, b: &BranchPoint) -> Option<BranchPoint> {
        self.left -= 1;
        let state = |point: &BranchPoint| State { q: point.q.clone(), value: point.value };
        let middle = self.continuation.between(&state(a), &state(b), 0.5)?;
        if middle.value == a.value || middle.value == b.value {
            return None;
        }
        let spectrum = self.continuation.spectrum(&middle).ok()?;
        Some(spectrum.point(middle, a.folds, false))
    }

    /// Whether no eigenvalue moves by more than a pixel.
    fn is_short(&self, a: &BranchPoint, b: &BranchPoint) -> bool {
        a.eigenvalues.len() == b.eigenvalues.len()
            && a.eigenvalues.iter().zip(matched(&a.eigenvalues, &b.eigenvalues)).all(|(a, b)| self.far(*a, b) < 1.0)
    }

    /// Whether all paths are straight from one state by way of another to a third, and each eigenvalue plainly goes on as
    /// one of the next.
    fn is_straight(&self, a: &BranchPoint, middle: &BranchPoint, b: &BranchPoint) -> bool {
        let [from, by, to] = [&a.eigenvalues, &middle.eigenvalues, &b.eigenvalues];
        if from.len() != by.len() || by.len() != to.len() {
            return false;
        }
        let by = matched(from, by);
        let to = matched(&by, to);
        (0..from.len()).all(|k| {
            let moved = self.far(from[k], to[k]);
            let others = (0..from.len()).filter(|j| *j != k).map(|j| self.far(from[k], from[j]));
            // Double ones go together.
            let gap = others.filter(|gap| *gap > 0.01).fold(f64::INFINITY, f64::min);
            let (there, on) = (self.pixels(by[k] - from[k]), self.pixels(to[k] - by[k]));
            moved < 1.0 || moved <= AMBIGUOUS * gap && (on * there.conj()).arg().abs() <= STRAIGHT
        })
    }

    /// A difference in pixels.
    fn pixels(&self, x: Complex<f64>) -> Complex<f64> {
        Complex::new(x.re / self.pixel[0], x.im / self.pixel[1])
    }

    fn far(&self, a: Complex<f64>, b: Complex<f64>) -> f64 {
        self.pixels(b - a).norm()
    }
}
