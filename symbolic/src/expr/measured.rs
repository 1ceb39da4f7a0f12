//! Values with running magnitudes: the scale of what rounding did to them.

use super::scalar::Scalar;
use super::{Binary, Unary};
use crate::number::DoubleDouble;

/// So many roundings, twenty digits of thirty-two, lead out of where a function is defined.
const BEYOND: f64 = 1e12;

/// A value, and a magnitude m ≥ |value| such that its rounding error is some units u of the working precision
/// ([`DoubleDouble::UNIT`]) times m, however much cancelled on the way:
///
/// m(x ± y) = m(x) + m(y), m(x y) = m(x) |y| + |x| m(y) − |x y| + u m(x) m(y), m(x/y) = m(x)/|y| + |x| m(y)/y²,
/// m(f(x)) = |f(x)| + |f'(x)| m(x).
///
/// So (a − b) c and a c − b c have one measure where c is exact, and a product of two narrow functions is known as well as they are; the
/// last part of m(x y) is what both errors make together, which counts where both are nothing.  Where f' is not
/// finite (the root at 0, the arcsine at ±1) the error that u m(x) makes takes the place of the tangent, and what lies beyond these by its
/// rounding lies at them.  `sign` and
/// `step` have the magnitude of their value; whether rounding decided them, [`Measured::vanishes`] tells of the argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The value.
    pub value: DoubleDouble,
    /// The magnitude.
    pub magnitude: f64,
}

impl Measured {
    /// A value that is exact as it stands.
    pub fn exact(value: DoubleDouble) -> Measured {
        Measured { value, magnitude: value.to_f64().abs() }
    }

    /// Whether the value is 0 within so many roundings: |value| ≤ `roundings` u m, or below what has all its digits.  Not true of what is not finite.
    pub fn vanishes(self, roundings: f64) -> bool {
        let size = self.value.to_f64().abs();
        let rounding = (roundings * DoubleDouble::UNIT * self.magnitude).max(f64::MIN_POSITIVE);
        size <= rounding && self.magnitude.is_finite()
    }

    /// Itself, or the edge of where a function is defined where it lies beyond by its rounding alone.
    fn within_reach_of(self, function: Unary) -> Measured {
        let one = if self.value < DoubleDouble::ZERO { -DoubleDouble::ONE } else { DoubleDouble::ONE };
        let edge = match function {
            Unary::Sqrt if self.value < DoubleDouble::ZERO => DoubleDouble::ZERO,
            Unary::Asin | Unary::Acos if self.value.abs() > DoubleDouble::ONE => one,
            _ => return self,
        };
        let beyond = Measured { value: self.value - edge, ..self };
        if beyond.vanishes(BEYOND) { Measured { value: edge, ..self } } else { self }
    }

    /// |value|/m, between 0 and 1; 0 for 0, and for what is too small to have all its digits.
    pub fn relative(self) -> f64 {
        let size = self.value.to_f64().abs();
        if size <= f64::MIN_POSITIVE { 0.0 } else { size / self.magnitude }
    }
}

impl Scalar for Measured {
    fn constant(value: DoubleDouble) -> Measured {
        Measured::exact(value)
    }

    fn unary(function: Unary, x: Measured) -> Measured {
        let x = x.within_reach_of(function);
        let (at, m, unit) = (x.value.to_f64(), x.magnitude, DoubleDouble::UNIT);
        let value = DoubleDouble::unary(function, x.value);
        let f = value.to_f64();
        // |f'(x)| m(x)
        let spread = match function {
            Unary::Neg | Unary::Abs => return Measured { value, magnitude: m },
            Unary::Sign | Unary::Step => 0.0,
            Unary::Sqrt => (0.5 * m / f).min((m / unit).sqrt()),
            Unary::Sin => at.cos().abs() * m,
            Unary::Cos => at.sin().abs() * m,
            Unary::Tan => (1.0 + f * f) * m,
            Unary::Asin | Unary::Acos => (m / ((1.0 - at) * (1.0 + at)).sqrt()).min((2.0 * m / unit).sqrt()),
            Unary::Atan => m / (1.0 + at * at),
            Unary::Sinh => at.cosh() * m,
            Unary::Cosh => at.sinh().abs() * m,
            Unary::Tanh => at.cosh().powi(-2) * m,
            Unary::Exp => f * m,
            Unary::Ln => m / at,
            Unary::Table(table) => table.derivative().map_or(0.0, |slope| slope.at(x.value).to_f64().abs()) * m,
        };
        Measured { value, magnitude: f.abs() + spread }
    }

    fn binary(operation: Binary, x: Measured, y: Measured) -> Measured {
        let value = DoubleDouble::binary(operation, x.value, y.value);
        let (a, b) = (x.value.to_f64(), y.value.to_f64());
        let (m, n) = (x.magnitude, y.magnitude);
        let magnitude = match operation {
            Binary::Add | Binary::Sub => m + n,
            Binary::Mul => product((a.abs(), m), (b.abs(), n)),
            Binary::Div => (m + (a / b).abs() * n) / b.abs(),
            Binary::Pow => power(value.to_f64().abs(), (a, m), (b, n)),
            Binary::Atan2 => {
                let distance = a.hypot(b);
                let turn = (a / distance).abs() * (n / distance) + (b / distance).abs() * (m / distance);
                // No error is larger than a whole turn.
                value.to_f64().abs() + turn.min(std::f64::consts::TAU / DoubleDouble::UNIT)
            }
            // The magnitude of the one that was taken.
            Binary::Min | Binary::Max if value == x.value => m,
            Binary::Min | Binary::Max => n,
            Binary::Normal(_) => value.to_f64().abs(),
            Binary::Table(table) => {
                let slope = |k| table.derivative(k).map_or(0.0, |slope| slope.at(x.value, y.value).to_f64().abs());
                value.to_f64().abs() + slope(0) * m + slope(1) * n
            }
        };
        Measured { value, magnitude }
    }
}

/// |x y| + (m(x) − |x|) |y| + |x| (m(y) − |y|) + u m(x) m(y).
fn product((x, m): (f64, f64), (y, n): (f64, f64)) -> f64 {
    let times = |size: f64, excess: f64| if size == 0.0 { 0.0 } else { size * excess };
    x * y + times(y, m - x) + times(x, n - y) + DoubleDouble::UNIT * m * n
}

/// f + |y xʸ⁻¹| m(x) + |f ln x| m(y) for f = |xʸ|.
fn power(f: f64, (x, m): (f64, f64), (y, n): (f64, f64)) -> f64 {
    if x == 0.0 {
        // What u m(x) makes of 0ʸ.
        let unit = DoubleDouble::UNIT;
        return if m == 0.0 { f } else { f + (unit * m).powf(y) / unit };
    }
    f + f * ((y / x).abs() * m + x.abs().ln().abs() * n)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Graph, Id, Symbol, Tape};

    fn measured(build: impl Fn(&mut Graph, Id, Id) -> Id, x: f64, y: f64) -> Measured {
        let mut g = Graph::new();
        let (a, b) = (g.symbol(Symbol::Coordinate(0)), g.symbol(Symbol::Coordinate(1)));
        let root = build(&mut g, a, b);
        Tape::new(&g, &[root]).measured(|s| if s == Symbol::Coordinate(0) { x.into() } else { y.into() })[0]
    }

    #[test]
    fn what_underflows_vanishes() {
        let tiny = Measured { value: f64::from_bits(1).into(), magnitude: 1e-310 };
        assert!(tiny.vanishes(1.0) && tiny.relative() == 0.0);
        assert!(!Measured { value: 1e-300.into(), magnitude: 1e-290 }.vanishes(1.0));
    }

    #[test]
    fn an_identity_vanishes_by_its_own_magnitude_however_large_its_terms() {
        // (x + y)² − x² − 2 x y − y²
        let identity = |g: &mut Graph, x: Id, y: Id| {
            let two = g.integer(2);
            let sum = g.add(x, y);
            let (square, xx, xy, yy) = (g.mul(sum, sum), g.mul(x, x), g.mul(x, y), g.mul(y, y));
            let twice = g.mul(two, xy);
            let a = g.sub(square, xx);
            let b = g.sub(a, twice);
            g.sub(b, yy)
        };
        let faulty = |g: &mut Graph, x: Id, y: Id| {
            let off = g.float(1e-12);
            let (right, yy) = (identity(g, x, y), g.mul(y, y));
            let fault = g.mul(off, yy);
            g.add(right, fault)
        };
        for (x, y) in [(1.0, 1.0), (0.1, 0.3), (1e12, 1e-12), (1e-150, 7e-145), (1e140, 3.3)] {
            let found = measured(identity, x, y);
            assert!(found.vanishes(10.0), "{x} {y}: {found:?}");
            assert!(found.magnitude >= (x + y) * (x + y));
        }
        assert!(!measured(faulty, 0.1, 0.3).vanishes(1e10));
    }

    #[test]
    fn magnitudes_bound_errors_where_tangents_fail() {
        let root = |g: &mut Graph, x: Id, y: Id| {
            // √((x + y) − y − x) is 1e-16 for a rounding.
            let sum = g.add(x, y);
            let back = g.sub(sum, y);
            let three = g.integer(3);
            let times = g.mul(three, x);
            let thirds = g.div(times, three);
            let zero = g.sub(back, thirds);
            let size = g.unary(Unary::Abs, zero);
            g.unary(Unary::Sqrt, size)
        };
        let found = measured(root, 0.1, 0.7);
        assert!(found.value.to_f64() <= 10.0 * DoubleDouble::UNIT * found.magnitude, "{found:?}");
        for f in [Unary::Sqrt, Unary::Asin, Unary::Acos, Unary::Atan, Unary::Tanh, Unary::Cosh, Unary::Exp, Unary::Abs]
        {
            for x in [0.0, 0.5, 1.0] {
                let found = measured(|g, x, _| g.unary(f, x), x, 0.0);
                assert!(found.magnitude.is_finite() && found.magnitude >= found.value.to_f64().abs(), "{f:?} {x}");
            }
        }
        let origin = measured(|g, x, y| g.binary(Binary::Atan2, x, y), 0.0, 0.0);
        assert!(!origin.magnitude.is_nan());
    }
}
