//! Critical speeds: where a frequency is a multiple of the speed of rotation that changes along a branch.

use super::continuation::Continuation;
use super::{Branch, BranchPoint, State, Varied, balance};
use crate::linear::LinearError;
use crate::linear::equilibrium::Guess;
use crate::linear::modes::matched;
use crate::mechanism::System;
use nalgebra::Complex;

/// Halvings of the distance of two states.
const HALVINGS: u32 = 60;

/// A speed at which an excitation by some multiple of it meets a frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriticalSpeed {
    /// The speed of rotation, SI.
    pub value: f64,
    /// The multiple.
    pub order: f64,
    /// The frequency, rad/s.
    pub omega: f64,
    /// The decay rate of the mode that is met, 1/s: 0 where nothing damps it, negative where it grows.
    pub decay: f64,
}

impl Branch {
    /// Where frequencies, the imaginary parts of eigenvalues, are these multiples of what changes, between neighbours of
    /// [`smooth`](Branch::smooth)'s states; by rising value.
    ///
    /// # Errors
    /// As [`smooth`](Branch::smooth).
    pub fn critical_speeds<S: System + ?Sized>(
        &self,
        system: &S,
        varied: &Varied,
        guess: &Guess,
        (points, orders): (&[BranchPoint], &[f64]),
    ) -> Result<Vec<CriticalSpeed>, LinearError> {
        let (Some(first), Some(last)) = (points.first(), points.last()) else { return Ok(Vec::new()) };
        let range = (first.value.min(last.value), first.value.max(last.value));
        if range.0 == range.1 {
            return Ok(Vec::new());
        }
        let continuation = Continuation::new(balance(system, varied, guess)?, range)?;
        continuation.note_zeros(points.iter().map(|point| (point.value, point.q.as_slice())));
        let mut found = Vec::new();
        for pair in points.windows(2).filter(|pair| self.joins(&pair[0], &pair[1])) {
            let next = matched(&pair[0].eigenvalues, &pair[1].eigenvalues);
            for (a, b) in pair[0].eigenvalues.iter().zip(next).filter(|(a, b)| a.im > 0.0 && b.im > 0.0) {
                let crossed = |order: &&f64| beyond(**order, pair[0].value, *a) != beyond(**order, pair[1].value, b);
                let all = orders.iter().filter(crossed);
                found.extend(all.filter_map(|order| located(&continuation, [&pair[0], &pair[1]], [*a, b], *order)));
            }
        }
        found.sort_by(|a: &CriticalSpeed, b| a.value.total_cmp(&b.value));
        Ok(found)
    }
}

/// Whether a frequency lies above the line of an order.
fn beyond(order: f64, value: f64, x: Complex<f64>) -> bool {
    x.im > order * value.abs()
}

/// The place between two states, by halvings on the way of one eigenvalue.
fn located(
    continuation: &Continuation,
    [a, b]: [&BranchPoint; 2],
    [mut from, mut to]: [Complex<f64>; 2],
    order: f64,
) -> Option<CriticalSpeed> {
    let state = |point: &BranchPoint| State { q: point.q.clone(), value: point.value };
    let (mut low, mut high) = (state(a), state(b));
    let above = beyond(order, low.value, from);
    for _ in 0..HALVINGS {
        let Some(middle) = continuation.between(&low, &high, 0.5) else { break };
        if middle.value == low.value || middle.value == high.value {
            break;
        }
        let expected = (from + to) * 0.5;
        let spectrum = continuation.spectrum(&middle).ok()?;
        let near = |x: &Complex<f64>| (x - expected).norm();
        let here = *spectrum.eigenvalues.iter().min_by(|x, y| near(x).total_cmp(&near(y)))?;
        if beyond(order, middle.value, here) == above {
            (low, from) = (middle, here)
        } else {
            (high, to) = (middle, here)
        }
    }
    // What is 0 on both sides, as rigid motions at rest, is no excitation.
    let omega = 0.5 * (from.im + to.im);
    (omega > 0.0).then_some(CriticalSpeed {
        value: 0.5 * (low.value + high.value),
        order,
        omega,
        decay: -0.5 * (from.re + to.re),
    })
}
