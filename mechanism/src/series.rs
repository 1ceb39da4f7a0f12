//! How Taylor coefficients of M, h, J and γ follow from those of a motion.

use super::List;

/// How many coefficients a series has of each quantity, orders 0 to 20.  The work of a step grows with the square of the order, its length tends to the
/// radius of convergence: unrolled prototypes of four scenes cost the same within a tenth with three orders more or fewer than the best, which was 14 to 24
/// at tolerances from 10⁻⁹ to 10⁻¹⁶.
pub const SERIES_TERMS: usize = 21;

/// How the coefficients of M, h, J and γ follow from those of the motion: rows of coefficients, each made of others.
///
/// Source: R. E. Moore, Interval Analysis (1966), chapter 11; A. Jorba, M. Zou, Experimental Mathematics 14 (2005) 99, proposition 2.1.
#[derive(Clone, Debug, Default)]
pub struct Series {
    /// How many numbers rows are made with, which depend on parameters, modes and the phase only.
    pub constants: usize,
    /// One for each row: coefficients of order k need those of rows before at orders up to k, and of rows behind at lower ones.
    pub rows: List<Recurrence>,
    /// The lower triangle of M: (row, column, value).
    pub mass: List<(usize, usize, Place)>,
    /// h.
    pub bias: List<Place>,
    /// J: (row, coordinate, value).
    pub matrix: List<(usize, usize, Place)>,
    /// γ.
    pub constraint_bias: List<Place>,
}

/// Where coefficients are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A constant, which has a coefficient of order 0 only.
    Constant(usize),
    /// A row.
    Row(usize),
}

/// How a row's coefficients follow from those of others: numbers are those of rows, and last those of constants where there is one.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "what it computes stands beside each")]
pub enum Recurrence {
    /// t.
    Time,
    /// A coordinate.
    Coordinate(usize),
    /// Its rate.
    Speed(usize),
    /// c.
    Constant(usize),
    /// a + b.
    Sum(usize, usize),
    /// a − b.
    Difference(usize, usize),
    /// −a.
    Negative(usize),
    /// a + c.
    Shifted(usize, usize),
    /// a − c.
    Reduced(usize, usize),
    /// c a.
    Scaled(usize, usize),
    /// a/c.
    Parted(usize, usize),
    /// a b.
    Product(usize, usize),
    /// a².
    Square(usize),
    /// a/b.
    Quotient(usize, usize),
    /// √a.
    Root(usize),
    /// a to the power c.
    Power(usize, usize),
    /// f(a) with f' = ±g.
    Grown { function: fn(f64) -> f64, of: usize, by: usize, falls: bool },
    /// f(a) with f' = ±1/g.
    Divided { function: fn(f64) -> f64, of: usize, by: usize, falls: bool },
    /// atan2(y, x), with x² + y² in a row.
    Angle { y: usize, x: usize, square: usize },
}
