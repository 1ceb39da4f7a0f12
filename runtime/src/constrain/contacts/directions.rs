//! Directions of sliding in space.
//!
//! What begins to slide, and what still slides after an impact, does so against a friction that is itself against the sliding: of each such contact the
//! direction d is sought at which what d leads to, s' or s after the impact, is along d.  One is a zero of s' × d on the circle, which is looked for
//! in all of it; several are found one after the other, again and again.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use super::compatible::compatible;

/// The circle is looked through in so many parts.
const PARTS: usize = 48;
/// A zero is a root, and no jump, where the function falls to this part of the largest that it is made of there: between the rounding of forces that
/// cancel, some 1e-12, and a jump, which is of the size of all.
pub(super) const ROOT: f64 = 1e-9;
/// Steps towards a root.
const STEPS: usize = 100;
/// So often several directions are found anew: they come nearer by a constant factor each time.
const SWEEPS: usize = 300;
/// Directions that differ by no more are the same, rad: some hundred roundings.
pub(super) const SAME: f64 = 1e-13;
/// Keeps a ratio from being 0/0, as in generated code.
const NO_RATE: f64 = 1e-90;
/// A direction that is held is kept while the cosine of the angle to it is this.
const NEAR: f64 = 0.7;

/// What directions lead to, one after the other; `None` where they lead to nothing.
pub(super) type Outcome<'a> = dyn FnMut(&[[f64; 2]]) -> Option<Vec<[f64; 2]>> + 'a;

/// The direction in which a contact slides at these rates, as generated code has it: that of the line of s on the side of what is held, which it is
/// itself where |s| is rounding.
pub(crate) fn direction([s1, s2]: [f64; 2], [d1, d2, least]: [f64; 3]) -> [f64; 2] {
    let length = d1.hypot(d2);
    let (d1, d2) = (d1 / length, d2 / length);
    let (forwards, sideways) = (s1 * d1 + s2 * d2, s2 * d1 - s1 * d2);
    let ratio = sideways * forwards / (forwards * forwards + least * least + NO_RATE);
    let size = 1.0_f64.hypot(ratio);
    [(d1 - ratio * d2) / size, (d2 + ratio * d1) / size]
}

/// Whether rates are near enough to the direction that is held.
pub(super) fn is_near([s1, s2]: [f64; 2], [d1, d2]: [f64; 2]) -> bool {
    s1 * d1 + s2 * d2 >= NEAR * s1.hypot(s2) * d1.hypot(d2)
}

/// s/|s|.
pub(super) fn along([s1, s2]: [f64; 2]) -> [f64; 2] {
    let size = s1.hypot(s2);
    [s1 / size, s2 / size]
}

/// The directions that agree with what they lead to: all for one contact, for several the one to which the guesses lead, `rates` being the rates of
/// sliding that constraints leave, as columns.
pub(super) fn consistent(
    guesses: &[[f64; 2]],
    rates: Option<DMatrix<f64>>,
    outcome: &mut Outcome<'_>,
) -> Vec<Vec<[f64; 2]>> {
    match guesses {
        [] => vec![Vec::new()],
        [guess] => roots(*guess, &mut |d| Some(outcome(&[d])?[0])).into_iter().map(|d| vec![d]).collect(),
        several => {
            let at_once = rates.and_then(|rates| compatible(several, rates, outcome));
            at_once.or_else(|| sweep(several.to_vec(), outcome)).into_iter().collect()
        }
    }
}

fn sweep(mut directions: Vec<[f64; 2]>, outcome: &mut Outcome<'_>) -> Option<Vec<[f64; 2]>> {
    for _ in 0..SWEEPS {
        let mut turned = 0.0_f64;
        for k in 0..directions.len() {
            let [x, y] = directions[k];
            let mut tried = directions.clone();
            let found = roots(directions[k], &mut |d| {
                tried[k] = d;
                Some(outcome(&tried)?[k])
            });
            let nearest = found.into_iter().max_by(|[a, b], [c, d]| (a * x + b * y).total_cmp(&(c * x + d * y)))?;
            turned = turned.max((nearest[0] * y - nearest[1] * x).abs());
            directions[k] = nearest;
        }
        if turned <= SAME {
            return Some(directions);
        }
    }
    None
}

/// All directions that what they lead to is along; a guess as it stands where it is one of them but for rounding, so that what moves in a plane stays in it.
fn roots(guess: [f64; 2], outcome: &mut dyn FnMut([f64; 2]) -> Option<[f64; 2]>) -> Vec<[f64; 2]> {
    let at = |k: usize| TAU * (k as f64 + 0.5) / PARTS as f64;
    let mut largest = 0.0_f64;
    let mut cross = |angle: f64, largest: &mut f64| {
        let (y, x) = angle.sin_cos();
        let Some([a, b]) = outcome([x, y]) else { return [f64::NAN; 2] };
        *largest = largest.max(a.hypot(b));
        [x * b - y * a, x * a + y * b]
    };
    let values: Vec<f64> = (0..PARTS).map(|k| cross(at(k), &mut largest)[0]).collect();
    let mut found = Vec::new();
    for k in 0..PARTS {
        let (from, to) = (values[k], values[(k + 1) % PARTS]);
        if !(from != 0.0 && from * to <= 0.0) {
            continue;
        }
        let mut own = 0.0;
        let angle = between([at(k), at(k + 1)], [from, to], &mut |angle| cross(angle, &mut own)[0]);
        let [missed, forwards] = cross(angle, &mut own);
        // What is at its limit does not move at first.
        if missed.abs() <= ROOT * largest && forwards >= -ROOT * largest {
            let (y, x) = angle.sin_cos();
            let is_guess = (x - guess[0]).hypot(y - guess[1]) <= SAME;
            found.push(if is_guess { guess } else { [x, y] });
        }
    }
    found
}

/// A zero between two angles at which a function has opposite signs, by false positions that do not stay (Illinois), and by halves where these are slow.
fn between([mut a, mut b]: [f64; 2], [mut of_a, mut of_b]: [f64; 2], function: &mut dyn FnMut(f64) -> f64) -> f64 {
    for step in 0..STEPS {
        if of_b == 0.0 {
            return b;
        }
        let middle = if step % 4 == 3 { 0.5 * (a + b) } else { (a * of_b - b * of_a) / (of_b - of_a) };
        if !(middle > a.min(b) && middle < a.max(b)) {
            break;
        }
        let value = function(middle);
        if value * of_b <= 0.0 {
            (a, of_a) = (b, of_b);
        } else {
            of_a *= 0.5;
        }
        (b, of_b) = (middle, value);
    }
    if of_a.abs() < of_b.abs() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_isotropic_point_slides_where_it_is_pushed() {
        for angle in [0.0, 0.3, 2.0, -1.0, 3.1] {
            let (y, x) = f64::sin_cos(angle);
            // Pushed with 1, rubbed with 0.25, and at its limit.
            for rubbed in [0.25, 1.0] {
                let found =
                    consistent(&[[1.0, 0.0]], None, &mut |d| Some(vec![[x - rubbed * d[0][0], y - rubbed * d[0][1]]]));
                assert_eq!(found.len(), 1, "{angle} {rubbed}");
                assert!((found[0][0][0] - x).abs() < 1e-15 && (found[0][0][1] - y).abs() < 1e-15, "{found:?}");
            }
            // More friction than push: it does not slide.
            let found = consistent(&[[1.0, 0.0]], None, &mut |d| Some(vec![[x - 1.5 * d[0][0], y - 1.5 * d[0][1]]]));
            assert!(found.is_empty(), "{found:?}");
        }
    }

    #[test]
    fn several_directions_agree_with_each_other() {
        let outcome = |d: &[[f64; 2]]| {
            let [[a, b], [p, q]] = [d[0], d[1]];
            vec![
                [1.0 - 0.5 * a - 0.2 * p, 0.3 - 0.5 * b - 0.2 * q],
                [0.2 - 0.1 * a - 0.4 * p, -0.9 - 0.1 * b - 0.4 * q],
            ]
        };
        let found = consistent(&[[1.0, 0.0], [1.0, 0.0]], None, &mut |d| Some(outcome(d)));
        let [both] = found.as_slice() else { panic!("{found:?}") };
        for ([x, y], [a, b]) in both.iter().zip(outcome(both)) {
            assert!((x * b - y * a).abs() < 1e-12 && x * a + y * b > 0.0, "{both:?}");
        }
    }

    #[test]
    fn the_direction_goes_on_through_zero() {
        let held = [0.6, 0.8, 1e-12];
        for s in [[3.0, 4.0], [-3.0, -4.0], [0.0, 0.0], [1e-17, -1e-17]] {
            let [x, y] = direction(s, held);
            assert!((x - 0.6).abs() < 1e-9 && (y - 0.8).abs() < 1e-9, "{s:?}: {x} {y}");
        }
        let [x, y] = direction([1.0, 0.0], held);
        assert!((x - 1.0).abs() < 1e-12 && y.abs() < 1e-12);
    }
}
