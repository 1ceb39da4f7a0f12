//! What expressions are evaluated in.

use super::{Binary, Unary};
use crate::number::{DoubleDouble, normal};

/// A kind of number that knows every operation of the graph.
pub trait Scalar: Copy {
    /// A constant of the graph.
    fn constant(value: DoubleDouble) -> Self;

    /// A function of one argument; `sign(0)` is 0 and `step(0)` is 1.
    fn unary(function: Unary, x: Self) -> Self;

    /// An operation on two arguments.
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
            Binary::Min => x.min(y),
            Binary::Max => x.max(y),
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
