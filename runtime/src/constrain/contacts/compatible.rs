//! Directions in which several contacts of space begin to slide that their bodies can have together.
//!
//! Where next to no force is left over for it, feet whose directions differ a little hold each other as well, but for the squares of what they differ by:
//! forces alone tell directions to the root of rounding only.  So the rates of sliding s are sought among those that the constraints leave, s = B w, by
//! Newton's method: what s_k/|s_k| lead to has no part across them.

use nalgebra::{DMatrix, DVector};

use super::IN_SPAN;
use super::directions::{Outcome, ROOT, SAME, along};
use crate::matrix::svd;

/// Steps of Newton's method: with a good guess there are three or four.
const STEPS: usize = 12;
/// By how much a direction is turned to see what that changes, rad: the root of rounding.
const TURN: f64 = 1e-8;
/// No direction turns by more in a step, rad.
const FAR: f64 = 0.5;
/// Directions outside the span by less than this part may be those of rates in it.
const NEARLY: f64 = 0.1;
/// What slides more slowly than this part of the fastest has no direction in common with it.
const SLOW: f64 = 1e-6;

/// The directions near the guesses that agree with what they lead to, all being those of rates in the span of the columns of `rates`; `None` where there
/// are none near.
pub(super) fn compatible(
    guesses: &[[f64; 2]],
    rates: DMatrix<f64>,
    outcome: &mut Outcome<'_>,
) -> Option<Vec<[f64; 2]>> {
    let count = guesses.len();
    let span = span(rates)?;
    let guessed = sizes(guesses, &span)?;
    let mut unknowns = span.tr_mul(&DVector::from_fn(2 * count, |i, _| guessed[i / 2] * guesses[i / 2][i % 2]));
    let mut last = f64::INFINITY;
    for _ in 0..STEPS {
        let rates = &span * &unknowns;
        let sizes: Vec<f64> = (0..count).map(|k| rates[2 * k].hypot(rates[2 * k + 1])).collect();
        let fastest = sizes.iter().fold(0.0_f64, |most, size| most.max(*size));
        if !sizes.iter().all(|size| *size > SLOW * fastest) {
            return None;
        }
        let directions: Vec<[f64; 2]> = (0..count).map(|k| along([rates[2 * k], rates[2 * k + 1]])).collect();
        let led_to = LedTo::by(&directions, outcome)?;
        let turns = DMatrix::from_fn(count, unknowns.len(), |k, i| {
            parts(directions[k], [span[(2 * k, i)], span[(2 * k + 1, i)]])[1] / sizes[k]
        });
        // The unknowns are all alike, and sizes that change nothing stay.
        let by_rates = svd(&led_to.changes * &turns, true, true)?;
        let nothing = IN_SPAN * by_rates.singular_values.max();
        let step = -by_rates.solve(&led_to.across, nothing).ok()?;
        let angle = (&turns * &step).amax();
        let zero = ROOT * led_to.largest;
        if angle <= SAME || angle >= last && led_to.across.amax() <= zero {
            let agrees = led_to.across.amax() <= zero && led_to.forwards.iter().all(|forwards| *forwards >= -zero);
            return agrees.then_some(directions);
        }
        last = angle;
        unknowns += step * (FAR / angle).min(1.0);
        let size = unknowns.amax();
        unknowns /= size;
    }
    None
}

/// What directions lead to.
struct LedTo {
    /// Along each of them, and across.
    forwards: Vec<f64>,
    across: DVector<f64>,
    /// How what is across changes with the angle of each, and the largest change of all.
    changes: DMatrix<f64>,
    largest: f64,
}

impl LedTo {
    fn by(directions: &[[f64; 2]], outcome: &mut Outcome<'_>) -> Option<LedTo> {
        let count = directions.len();
        let found = outcome(directions)?;
        let forwards: Vec<f64> = (0..count).map(|k| parts(directions[k], found[k])[0]).collect();
        let across = DVector::from_fn(count, |k, _| parts(directions[k], found[k])[1]);
        let (mut changes, mut largest) = (DMatrix::zeros(count, count), 0.0_f64);
        for j in 0..count {
            let mut turned = directions.to_vec();
            let [x, y] = turned[j];
            turned[j] = along([x - TURN * y, y + TURN * x]);
            let then = outcome(&turned)?;
            for k in 0..count {
                let change = [0, 1].map(|i| (then[k][i] - found[k][i]) / TURN);
                largest = largest.max(change[0].hypot(change[1]));
                changes[(k, j)] = parts(directions[k], change)[1];
            }
            changes[(j, j)] -= forwards[j];
        }
        Some(LedTo { forwards, across, changes, largest })
    }
}

/// The parts of a vector along a direction and across.
fn parts([x, y]: [f64; 2], [a, b]: [f64; 2]) -> [f64; 2] {
    [x * a + y * b, x * b - y * a]
}

/// How fast what slides in these directions has to be beside the others, so that all are nearly in the span; all alike where they are not.
fn sizes(directions: &[[f64; 2]], span: &DMatrix<f64>) -> Option<DVector<f64>> {
    let count = directions.len();
    let along_each = DMatrix::from_fn(2 * count, count, |i, k| if i / 2 == k { directions[k][i % 2] } else { 0.0 });
    let outside = &along_each - span * span.tr_mul(&along_each);
    let found = svd(outside, false, true)?;
    let near: Vec<usize> = (0..count).filter(|k| found.singular_values[*k] <= NEARLY).collect();
    let near = found.v_t?.select_rows(&near);
    let alike = DVector::from_element(count, 1.0);
    let sizes = near.tr_mul(&(&near * &alike));
    Some(if sizes.iter().all(|size| *size > 0.0) { sizes } else { alike })
}

/// An orthonormal basis of the columns.
fn span(columns: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let found = svd(columns, true, false)?;
    let largest = found.singular_values.max();
    let counts = |k: &usize| found.singular_values[*k] > IN_SPAN * largest;
    let counting: Vec<usize> = (0..found.singular_values.len()).filter(counts).collect();
    Some(found.u?.select_columns(&counting))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACES: [[f64; 2]; 3] = [[0.5, 0.1], [-0.3, 0.4], [0.0, -0.6]];
    const LIMITS: [f64; 3] = [1.0, 2.0, 0.5];

    /// Rates of three feet of a plate by its motion.
    fn rates() -> DMatrix<f64> {
        DMatrix::from_fn(6, 3, |i, j| match j {
            2 => [-PLACES[i / 2][1], PLACES[i / 2][0]][i % 2],
            j => f64::from(u8::from(i % 2 == j)),
        })
    }

    /// What a plate of mass 1 does that is pushed and rubbed.
    fn outcome(push: [f64; 3]) -> impl FnMut(&[[f64; 2]]) -> Option<Vec<[f64; 2]>> {
        move |directions| {
            let forces = DVector::from_fn(6, |i, _| -LIMITS[i / 2] * directions[i / 2][i % 2]);
            let mut a = rates().tr_mul(&forces) + DVector::from_column_slice(&push);
            a[2] /= 0.2;
            let second = rates() * a;
            Some((0..3).map(|k| [second[2 * k], second[2 * k + 1]]).collect())
        }
    }

    #[test]
    fn a_plate_at_its_limit_begins_to_slide_as_it_can() {
        // At the limit, a hair below and above it, and far above: along (0.6, 0.8), and turning about a point.
        for (motion, part) in [[0.6, 0.8, 0.0], [0.2, 0.1, 0.7]]
            .iter()
            .flat_map(|motion| [0.0, -1e-13, 1e-12, 1e-6, 0.1].map(|part| (DVector::from_column_slice(motion), part)))
        {
            let slides = rates() * &motion;
            let right: Vec<[f64; 2]> = (0..3).map(|k| along([slides[2 * k], slides[2 * k + 1]])).collect();
            let held = DVector::from_fn(6, |i, _| LIMITS[i / 2] * right[i / 2][i % 2]);
            let mass = DVector::from_column_slice(&[1.0, 1.0, 0.2]);
            let push = rates().tr_mul(&held) + part * motion.component_mul(&mass);
            let off = |k: usize| 1e-3 * [1.0, -3.0, 2.0][k];
            let guess: Vec<[f64; 2]> =
                right.iter().enumerate().map(|(k, [x, y])| along([x - off(k) * y, y + off(k) * x])).collect();
            let found = compatible(&guess, rates(), &mut outcome([push[0], push[1], push[2]])).expect("directions");
            for ([x, y], [a, b]) in found.iter().zip(&right) {
                assert!((x - a).hypot(y - b) < 1e-12, "{part}: {found:?} {right:?}");
            }
        }
    }

    #[test]
    fn a_plate_that_is_held_has_no_directions() {
        let held = DVector::from_fn(6, |i, _| LIMITS[i / 2] * [0.6, 0.8][i % 2]);
        for part in [0.2, 0.9] {
            let push = part * rates().tr_mul(&held);
            assert_eq!(
                compatible(&[[0.6, 0.8]; 3], rates(), &mut outcome([push[0], push[1], push[2]])),
                None,
                "{part}"
            );
        }
    }
}
