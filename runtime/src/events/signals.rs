//! Jumps and sharp turns of inputs that are Rust closures: there is no expression that would tell where they are.

use crate::mechanism::Signal;

/// A time at which a closure jumps or turns sharply.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Break {
    /// The last time before it, s.
    pub before: f64,
    /// The first time after it, s.
    pub after: f64,
    /// (u, u', u'') just before it.
    pub value: [f64; 3],
}

/// Pieces to begin with, and samples at most.
const PIECES: u32 = 64;
const MOST_SAMPLES: u32 = 20_000;
/// A piece that is still inconsistent at this part of the span holds a break.
const SHORT: f64 = 1e-9;
/// Deviation from the cubic that is allowed, in parts of the observed variation.
const CONSISTENT: f64 = 0.05;

/// Three rates that are off by more than this part of how fast the values change between them are not those of the values.
const WRONG: f64 = 0.5;

/// Features narrower than this part of a run may be missed by the scan of a closure.
pub(crate) const WIDTH: f64 = 2e-4;

/// The breaks of a closure between two times, in order, as far as a scan of u and u' sees them.
///
/// Pieces are halved until value and slope at the middle are those of the cubic through the ends; what is still
/// inconsistent when it is a billionth of the span is a break, and is narrowed to adjacent numbers.
///
/// # Errors
/// Where values change steadily at another rate than u'.
pub(crate) fn breaks(signal: &Signal, (from, until): (f64, f64)) -> Result<Vec<Break>, WrongRate> {
    let span = until - from;
    let at = |t: f64| (t, signal(t));
    let mut found: Vec<Break> = Vec::new();
    let mut samples = 0;
    let mut stack = Vec::new();
    // Not quite equal pieces, so that a period does not keep step with them.
    let place = |k: u32| {
        let part = f64::from(k) / f64::from(PIECES);
        from + span * (part + 0.004 * (f64::from(k) * 2.399_963).sin() * f64::from(u8::from(k > 0 && k < PIECES)))
    };
    for k in (0..PIECES).rev() {
        stack.push((at(place(k)), at(place(k + 1))));
    }
    while let Some((a, b)) = stack.pop() {
        samples += 1;
        let middle = a.0 + 0.5 * (b.0 - a.0);
        if samples > MOST_SAMPLES || !(middle > a.0 && middle < b.0) {
            continue;
        }
        let m = at(middle);
        if consistent(&a, &m, &b) {
            continue;
        }
        if b.0 - a.0 < SHORT * span {
            if let Some(slope) = other_slope(&a, &m, &b) {
                return Err(WrongRate { t: m.0, rate: m.1[1], slope });
            }
            found.extend(narrowed(&at, a, b));
            continue;
        }
        stack.push((m, b));
        stack.push((a, m));
    }
    found.dedup_by(|later, earlier| later.before <= earlier.after + 4.0 * SHORT * span);
    Ok(found)
}

/// A closure whose u' is not the rate of its u.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WrongRate {
    /// Where, s.
    pub t: f64,
    /// u' there.
    pub rate: f64,
    /// How fast u changes there.
    pub slope: f64,
}

type Point = (f64, [f64; 3]);

fn consistent(a: &Point, m: &Point, b: &Point) -> bool {
    let length = b.0 - a.0;
    let (ga, gm, gb) = (a.1[0], m.1[0], b.1[0]);
    let (da, dm, db) = (a.1[1], m.1[1], b.1[1]);
    let r = (gb - ga).abs().max((gm - ga).abs()).max((gm - gb).abs());
    let noise = 4.0 * f64::EPSILON * ga.abs().max(gm.abs()).max(gb.abs());
    let value = 0.5 * (ga + gb) + 0.125 * length * (da - db);
    let slope = 1.5 * (gb - ga) / length - 0.25 * (da + db);
    let turn = 0.25 * length * (dm - slope).abs();
    // Values that are not numbers are for the run to find.
    !((gm - value).abs() > CONSISTENT * r + noise || turn > CONSISTENT * r + 4.0 * noise)
}

/// How fast the values in a short piece change, if they do so steadily and all rates are others.
fn other_slope(a: &Point, m: &Point, b: &Point) -> Option<f64> {
    let [ga, gm, gb] = [a, m, b].map(|point| point.1[0]);
    let slope = (gb - ga) / (b.0 - a.0);
    let noise = 4.0 * f64::EPSILON * ga.abs().max(gb.abs());
    let steady = (gm - 0.5 * (ga + gb)).abs() + noise <= CONSISTENT * (gb - ga).abs();
    let other = [a, m, b].iter().all(|point| (point.1[1] - slope).abs() > WRONG * slope.abs());
    (steady && other).then_some(slope)
}

/// The break in a short piece, between adjacent numbers; `None` where nothing changes but by rounding.
fn narrowed(at: &impl Fn(f64) -> Point, mut a: Point, mut b: Point) -> Option<Break> {
    let jump = (b.1[0] - a.1[0]).abs();
    let size = a.1[0].abs().max(b.1[0].abs());
    let by_value = jump > 1e-6 * size && jump > 4.0 * (b.0 - a.0) * a.1[1].abs().max(b.1[1].abs());
    let order = usize::from(!by_value);
    let largest = a.1[order].abs().max(b.1[order].abs());
    if (b.1[order] - a.1[order]).abs() <= 1e-6 * largest {
        return None;
    }
    for _ in 0..80 {
        let middle = a.0 + 0.5 * (b.0 - a.0);
        if !(middle > a.0 && middle < b.0) {
            break;
        }
        let m = at(middle);
        if (m.1[order] - a.1[order]).abs() >= (b.1[order] - m.1[order]).abs() {
            b = m;
        } else {
            a = m;
        }
    }
    Some(Break { before: a.0, after: b.0, value: a.1 })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    fn of(f: impl Fn(f64) -> [f64; 3] + Send + Sync + 'static) -> Vec<Break> {
        let signal: Signal = Arc::new(f);
        breaks(&signal, (0.0, 100.0)).expect("rates of the values")
    }

    #[test]
    fn a_rate_that_is_not_that_of_the_values_is_told() {
        let signal: Signal = Arc::new(|t: f64| [0.1 * (3.0 * t).sin(), 0.0, 0.0]);
        let wrong = breaks(&signal, (0.0, 100.0)).expect_err("a wrong rate");
        assert!(wrong.rate == 0.0 && (wrong.slope - 0.3 * (3.0 * wrong.t).cos()).abs() < 1e-6, "{wrong:?}");
        // Values that are held have no rate; a fast change that has one may be a break.
        assert!(of(|t| [(3.0 * t).floor(), 0.0, 0.0]).len() > 290);
        let fast = |t: f64| {
            let x = ((t - 47.0) / 1e-10).tanh();
            [x, (1.0 - x * x) / 1e-10, 0.0]
        };
        assert_eq!(of(fast).len(), 1);
    }

    #[test]
    fn jumps_and_kinks_are_placed_to_rounding() {
        for place in [0.3, 47.11, 99.0] {
            let jump = of(move |t| [f64::from(u8::from(t >= place)), 0.0, 0.0]);
            assert_eq!(jump.len(), 1, "{jump:?}");
            assert!((jump[0].after - place).abs() < 1e-12 && jump[0].value[0] == 0.0, "{jump:?}");
            let kink = of(move |t| [(t - place).abs(), (t - place).signum(), 0.0]);
            assert_eq!(kink.len(), 1, "{kink:?}");
            assert!((kink[0].after - place).abs() < 1e-9, "{kink:?}");
        }
        let square = of(|t| [(3.0 * t).sin().signum(), 0.0, 0.0]);
        assert_eq!(square.len(), 95);
    }

    #[test]
    fn smooth_closures_have_no_breaks() {
        assert!(of(|_| [1.0, 0.0, 0.0]).is_empty());
        assert!(of(|t| [(3.0 * t).sin(), 3.0 * (3.0 * t).cos(), -9.0 * (3.0 * t).sin()]).is_empty());
        assert!(
            of(|t| [(-(t - 50.0) * (t - 50.0)).exp(), -2.0 * (t - 50.0) * (-(t - 50.0) * (t - 50.0)).exp(), 0.0])
                .is_empty()
        );
    }
}
