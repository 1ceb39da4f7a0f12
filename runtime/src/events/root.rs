//! One zero of a function between two points, and whether it is one.

/// What lies where a function's sign changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Nature {
    /// A zero of a continuous function.
    Root,
    /// The function grows without bound to both sides.
    Pole,
    /// The function jumps over zero.
    Jump,
    /// The function is not defined somewhere in between.
    Undefined,
}

/// What is known of a function about a bracket.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Around {
    /// Where it may be looked at, the bracket's inside or more: what lies in a bracket that is narrower than what tells a root
    /// from a jump is told by what surrounds it.
    pub domain: (f64, f64),
    /// What rounding may change of its values: less is zero, and no jump.
    pub rounding: f64,
    /// Places this close to each other are the same for it.
    pub resolution: f64,
}

impl Around {
    /// Nothing but the bracket itself.
    pub fn bracket(a: f64, b: f64) -> Around {
        Around { domain: (a.min(b), a.max(b)), rounding: 0.0, resolution: 0.0 }
    }
}

/// A function that is this many roundings of its largest value is zero.
const ZERO: f64 = 128.0;
/// Unit round-off.
const ROUND_OFF: f64 = 0.5 * f64::EPSILON;

/// The place between a and b, where f has values of opposite signs, at which its sign changes, to rounding; and
/// what is there.
///
/// The bracket is narrowed to adjacent numbers by bisection and inverse quadratic interpolation (Chandrupatla, Adv.
/// Eng. Software 28 (1997) 145).  What it holds is told by how |Δf| shrinks from brackets 2²⁰ and 2¹⁰ times as wide
/// to it: like a power of the width for a root, not at all for a jump; it grows for a pole.
pub(crate) fn locate(
    mut f: impl FnMut(f64) -> f64,
    from: (f64, f64),
    to: (f64, f64),
    Around { domain: (low, high), rounding, resolution }: Around,
) -> (f64, Nature) {
    let largest = from.1.abs().max(to.1.abs());
    let Some([a, b]) = narrow(&mut f, from, to, resolution) else {
        return (0.5 * (from.0 + to.0), Nature::Undefined);
    };
    let best = if a.1.abs() <= b.1.abs() { a } else { b };
    if best.1.abs() <= (ZERO * ROUND_OFF * largest).max(rounding) {
        return (best.0, Nature::Root);
    }
    let width = (b.0 - a.0).abs().max(resolution);
    let mut change = |factor: f64| {
        let [left, right] = [best.0 - 0.5 * factor * width, best.0 + 0.5 * factor * width];
        (f(right.clamp(low, high)) - f(left.clamp(low, high))).abs()
    };
    let narrowest = (b.1 - a.1).abs();
    let (wider, widest) = (change(1024.0), change(1024.0 * 1024.0));
    let nature = if !(wider.is_finite() && widest.is_finite()) {
        Nature::Undefined
    } else if narrowest >= 2.0 * wider {
        Nature::Pole
    } else if narrowest <= 0.5 * wider || wider <= 0.5 * widest && narrowest <= 1e-3 * largest {
        Nature::Root
    } else {
        Nature::Jump
    };
    (best.0, nature)
}

/// What is at a point with the value zero and values of opposite signs to its sides, `low` and `high`.
pub(crate) fn nature_of_zero(
    mut f: impl FnMut(f64) -> f64,
    x: f64,
    low: (f64, f64),
    high: (f64, f64),
    Around { domain, rounding, resolution }: Around,
) -> Nature {
    let largest = low.1.abs().max(high.1.abs());
    let width = (f64::EPSILON * x.abs().max(high.0 - low.0)).max(resolution);
    let mut change = |factor: f64| {
        let (left, right) = ((x - factor * width).max(domain.0), (x + factor * width).min(domain.1));
        (f(right) - f(left)).abs()
    };
    let (narrow, wide) = (change(1024.0), change(1024.0 * 1024.0));
    if !(narrow.is_finite() && wide.is_finite()) {
        Nature::Undefined
    } else if narrow <= (ZERO * ROUND_OFF * largest).max(rounding) || narrow <= 0.5 * wide {
        Nature::Root
    } else if narrow >= 2.0 * wide {
        Nature::Pole
    } else {
        Nature::Jump
    }
}

/// A bracket of adjacent numbers (or a zero, twice) around a change of sign; `None` where f is not a number.
fn narrow(f: &mut impl FnMut(f64) -> f64, a: (f64, f64), b: (f64, f64), least: f64) -> Option<[(f64, f64); 2]> {
    // Near the start of a step its own numbers are finer than the state there: they are adjacent for what is looked at.
    let finest = (0.5 * f64::EPSILON * (b.0 - a.0).abs()).max(least);
    let (mut a, mut b) = (a, b);
    let mut fraction = 0.5;
    for round in 0..300 {
        let x = a.0 + fraction * (b.0 - a.0);
        let here = (x, f(x));
        if here.1.is_nan() {
            return None;
        }
        // c is the point that falls out of the bracket.
        let mut c = a;
        if (here.1 > 0.0) != (a.1 > 0.0) {
            (c, b) = (b, a);
        }
        a = here;
        let best = if a.1.abs() < b.1.abs() { a } else { b };
        if best.1 == 0.0 {
            return Some([best, best]);
        }
        let width = (b.0 - a.0).abs();
        let resolution = (2.0 * f64::EPSILON * best.0.abs()).max(finest) + f64::MIN_POSITIVE;
        if width <= resolution {
            break;
        }
        let xi = (a.0 - b.0) / (c.0 - b.0);
        let phi = (a.1 - b.1) / (c.1 - b.1);
        // Every third point halves the bracket whatever the function does.
        let trusted = round % 3 != 2 && phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        let interpolated = || {
            a.1 / (b.1 - a.1) * (c.1 / (b.1 - c.1))
                + (c.0 - a.0) / (b.0 - a.0) * (a.1 / (c.1 - a.1)) * (b.1 / (c.1 - b.1))
        };
        let least = 0.5 * resolution / width;
        fraction = if trusted { interpolated() } else { 0.5 };
        fraction = if fraction.is_finite() { fraction.clamp(least, 1.0 - least) } else { 0.5 };
    }
    Some([a, b])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::events::draws::Draws;

    fn expanded(x: f64) -> f64 {
        // (x − 1)³ at x + 1, so that the terms cancel: rounding noise over a width of 10⁻⁵.
        let y = x + 1.0;
        y * y * y - 3.0 * y * y + 3.0 * y - 1.0
    }

    /// Functions of the distance from the place in question, with what is there.
    type Case = (&'static str, fn(f64) -> f64, Nature);
    const FUNCTIONS: [Case; 21] = [
        ("x", |x| x, Nature::Root),
        ("x^3", |x| x * x * x, Nature::Root),
        ("x^9", |x| x.powi(9), Nature::Root),
        ("cube root", f64::cbrt, Nature::Root),
        ("ninth root", |x| x.abs().powf(1.0 / 9.0) * x.signum(), Nature::Root),
        ("signed square root", |x| x.abs().sqrt() * x.signum(), Nature::Root),
        ("expanded cube", expanded, Nature::Root),
        ("1e12 x", |x| 1e12 * x, Nature::Root),
        ("1e-12 x", |x| 1e-12 * x, Nature::Root),
        ("tanh(1e6 x)", |x| (1e6 * x).tanh(), Nature::Root),
        ("tanh(1e10 x)", |x| (1e10 * x).tanh(), Nature::Root),
        ("tanh(1e13 x)", |x| (1e13 * x).tanh(), Nature::Root),
        ("atan(1e8 x) + x", |x| (1e8 * x).atan() + x, Nature::Root),
        ("sign", |x| if x < 0.0 { -1.0 } else { 1.0 }, Nature::Jump),
        ("sign + x", |x| if x < 0.0 { x - 1.0 } else { x + 1.0 }, Nature::Jump),
        ("1e-6 sign + x", |x| if x < 0.0 { x - 1e-6 } else { x + 1e-6 }, Nature::Jump),
        ("1/x", |x| 1.0 / x, Nature::Pole),
        ("1/x^3", |x| 1.0 / (x * x * x), Nature::Pole),
        ("tan", |x| (x + std::f64::consts::FRAC_PI_2).tan(), Nature::Pole),
        ("square root of what is negative", |x| if x < 0.0 { -1.0 } else { (x - 1e-3).sqrt() }, Nature::Undefined),
        ("logarithm with a sign", |x| x.abs().ln() * -x.signum(), Nature::Pole),
    ];

    #[test]
    fn three_hundred_brackets_of_each_of_twenty_one_kinds_are_told_apart() {
        let mut draws = Draws::new(9);
        for (name, f, nature) in FUNCTIONS {
            for _ in 0..300 {
                let (left, right) = (draws.between(0.05, 0.5), draws.between(0.05, 0.5));
                let place = draws.between(0.6, 1.4);
                let g = |x: f64| f(x - place);
                let (a, b) = (place - left, place + right);
                let (x, found) = locate(g, (a, g(a)), (b, g(b)), Around::bracket(a, b));
                // ln|x| sign x is refused either way.
                let refused = |nature| nature == Nature::Pole || nature == Nature::Jump;
                let right = found == nature || name == "logarithm with a sign" && refused(found);
                assert!(right, "{name} at {place}: {found:?}");
                let exact = !matches!(name, "x^3" | "x^9" | "expanded cube") && nature != Nature::Undefined;
                assert!(!exact || (x - place).abs() < 1e-15, "{name}: {:e}", x - place);
            }
        }
    }

    #[test]
    fn a_root_beside_the_start_is_no_jump() {
        // Its noise is that of the state, many times that of so small a place.
        let tick = |x: f64| (360.0 * (0.87 + 0.04 * x)).sin();
        let root = ((360.0 * 0.87 / std::f64::consts::PI).ceil() * std::f64::consts::PI / 360.0 - 0.87) / 0.04;
        for before in [1e-3, 1e-5, 1e-8] {
            let g = |x: f64| tick(root - before + x);
            assert_eq!(
                locate(g, (0.0, g(0.0)), (0.05, g(0.05)), Around::bracket(0.0, 0.05)).1,
                Nature::Root,
                "{before}"
            );
        }
    }

    #[test]
    fn roots_are_found_to_rounding() {
        let mut count = 0;
        let square = |x: f64| {
            count += 1;
            x * x - 2.0
        };
        let (found, nature) = locate(square, (0.0, -2.0), (2.0, 2.0), Around::bracket(0.0, 2.0));
        assert_eq!(nature, Nature::Root);
        assert!((found - 2.0_f64.sqrt()).abs() <= 4e-16 && count < 20, "{found} after {count}");
        let ninth = |x: f64| (x - 0.3).powi(9);
        let (steep, _) = locate(ninth, (0.0, ninth(0.0)), (1.0, ninth(1.0)), Around::bracket(0.0, 1.0));
        assert!((steep - 0.3).abs() < 1e-3, "{steep}");
    }

    #[test]
    fn what_a_narrow_bracket_does_not_tell_its_surroundings_do() {
        let place = 0.2624747022216596;
        let line = |x: f64| place - x;
        let step = |x: f64| if x < place { 1.0 } else { -1.0 };
        for half in [4e-16, 1e-14, 1e-12] {
            let (a, b) = (place - half, place + half);
            let around = Around { domain: (0.0, 1.0), rounding: 0.0, resolution: 0.0 };
            assert_eq!(nature_of_zero(line, place, (a, line(a)), (b, line(b)), around), Nature::Root, "{half}");
            assert_eq!(nature_of_zero(step, place, (a, 1.0), (b, -1.0), around), Nature::Jump, "{half}");
        }
    }

    #[test]
    fn a_bracket_is_narrowed_from_the_right_as_from_the_left() {
        let line = |x: f64| x - 0.25;
        let around = Around::bracket(0.0, 1.0);
        assert_eq!(
            locate(line, (1.0, 0.75), (0.0, -0.25), around).0,
            locate(line, (0.0, -0.25), (1.0, 0.75), around).0
        );
    }
}
