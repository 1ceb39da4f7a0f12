//! What expressions are evaluated in.

use super::{Binary, Unary};
use crate::number::{DoubleDouble, normal};

/// A kind of number that knows every operation of the graph.
pub trait Scalar: Copy {
    /// A constant of the graph.
    fn constant(value: DoubleDouble) -> Self;

    /// A function of one argument; `sign(0)` is 0 and `step(0)` is 1, and what is NaN stays NaN.
    fn unary(function: Unary, x: Self) -> Self;

    /// An operation on two arguments; the smaller or larger of NaN and a number is NaN.
    fn binary(operation: Binary, x: Self, y: Self) -> Self;
}

impl Scalar for f64 {
    #[inline]
    fn constant(value: DoubleDouble) -> f64 {
        value.to_f64()
    }

    #[inline]
    fn unary(function: Unary, x: f64) -> f64 {
        match function {
            Unary::Neg => -x,
            Unary::Sqrt => x.sqrt(),
            Unary::Sin => x.sin(),
            Unary::Cos => x.cos(),
            Unary::Tan => x.tan(),
            Unary::Asin => x.asin(),
            Unary::Acos => x.acos(),
            Unary::Atan => x.atan(),
            Unary::Sinh => x.sinh(),
            Unary::Cosh => x.cosh(),
            Unary::Tanh => x.tanh(),
            Unary::Exp => x.exp(),
            Unary::Ln => x.ln(),
            Unary::Abs => x.abs(),
            Unary::Sign if x == 0.0 => 0.0,
            Unary::Sign => x.signum(),
            Unary::Step if x.is_nan() => x,
            Unary::Step => f64::from(u8::from(x >= 0.0)),
            Unary::Table(table) => table.at(x.into()).to_f64(),
        }
    }

    #[inline]
    fn binary(operation: Binary, x: f64, y: f64) -> f64 {
        match operation {
            Binary::Add => x + y,
            Binary::Sub => x - y,
            Binary::Mul => x * y,
            Binary::Div => x / y,
            Binary::Pow => x.powf(y),
            Binary::Atan2 => x.atan2(y),
            Binary::Min if y.is_nan() || y < x => y,
            Binary::Max if y.is_nan() || y > x => y,
            Binary::Min | Binary::Max => x,
            Binary::Table(table) => table.at(x.into(), y.into()).to_f64(),
            Binary::Normal(key) => normal(key, x, y),
        }
    }
}

impl Scalar for DoubleDouble {
    fn constant(value: DoubleDouble) -> DoubleDouble {
        value
    }

    fn unary(function: Unary, x: DoubleDouble) -> DoubleDouble {
        match function {
            Unary::Neg => -x,
            Unary::Sqrt => x.sqrt(),
            Unary::Sin => x.sin(),
            Unary::Cos => x.cos(),
            Unary::Tan => x.tan(),
            Unary::Asin => x.asin(),
            Unary::Acos => x.acos(),
            Unary::Atan => x.atan(),
            Unary::Sinh => x.sinh(),
            Unary::Cosh => x.cosh(),
            Unary::Tanh => x.tanh(),
            Unary::Exp => x.exp(),
            Unary::Ln => x.ln(),
            Unary::Abs => x.abs(),
            Unary::Sign => x.sign(),
            Unary::Step => x.step(),
            Unary::Table(table) => table.at(x),
        }
    }

    fn binary(operation: Binary, x: DoubleDouble, y: DoubleDouble) -> DoubleDouble {
        match operation {
            Binary::Add => x + y,
            Binary::Sub => x - y,
            Binary::Mul => x * y,
            Binary::Div => x / y,
            Binary::Pow => x.pow(y),
            Binary::Atan2 => x.atan2(y),
            Binary::Min => x.min(y),
            Binary::Max => x.max(y),
            Binary::Table(table) => table.at(x, y),
            Binary::Normal(key) => normal(key, x.to_f64(), y.to_f64()).into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nan_stays_nan<S: Scalar>(to_f64: impl Fn(S) -> f64) {
        let of = |x: f64| S::constant(x.into());
        for function in [Unary::Step, Unary::Sign, Unary::Abs] {
            assert!(to_f64(S::unary(function, of(f64::NAN))).is_nan(), "{function:?}");
        }
        let infinity = f64::INFINITY;
        for x in [-infinity, -0.0, 0.0, 1.0, infinity] {
            for operation in [Binary::Min, Binary::Max] {
                let both = |x, y| to_f64(S::binary(operation, of(x), of(y)));
                assert!(both(x, f64::NAN).is_nan() && both(f64::NAN, x).is_nan(), "{operation:?} of {x}");
                assert_eq!(both(x, x), x);
                assert_eq!(both(x, 0.5), if operation == Binary::Min { x.min(0.5) } else { x.max(0.5) });
            }
        }
    }

    #[test]
    fn floats_and_double_doubles_keep_nan() {
        nan_stays_nan(|x: f64| x);
        nan_stays_nan(DoubleDouble::to_f64);
        nan_stays_nan(|x: crate::expr::Measured| x.value.to_f64());
    }
}
