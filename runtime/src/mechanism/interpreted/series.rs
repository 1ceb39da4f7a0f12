//! Power series of an interpreted mechanism.

use dalembert_symbolic::expr::{Tape, Unary};
use dalembert_symbolic::interpret::{At, Interpreter};
use dalembert_symbolic::lower;

use crate::mechanism::{Place, Recurrence, Series};

/// The recurrences, and what computes the numbers that they are made with.
#[derive(Clone, Debug)]
pub(super) struct OwnSeries {
    pub series: Series,
    constants: Tape,
}

impl OwnSeries {
    /// `None` where a function has no series, and where M is too large to be formed.
    pub fn of(program: &lower::Program) -> Option<OwnSeries> {
        let program = &*program.formed()?;
        let found = lower::Series::of(program)?;
        let constants = Tape::new(&program.model.graph, &found.constants);
        let place = |place: lower::Place| match place {
            lower::Place::Constant(constant) => Place::Constant(constant),
            lower::Place::Row(row) => Place::Row(row),
        };
        let entries =
            |list: &[(usize, usize, lower::Place)]| list.iter().map(|(i, j, x)| (*i, *j, place(*x))).collect();
        let series = Series {
            constants: found.constants.len(),
            rows: found.rows.iter().map(|row| recurrence(*row)).collect(),
            mass: entries(&found.mass),
            bias: found.bias.iter().map(|x| place(*x)).collect(),
            matrix: entries(&found.matrix),
            constraint_bias: found.constraint_bias.iter().map(|x| place(*x)).collect(),
        };
        Some(OwnSeries { series, constants })
    }

    /// The numbers that rows are made with, inputs having these values.
    pub fn constants(&self, interpreter: &Interpreter, u: &[f64], values: &mut [f64]) {
        let at = At { u, ..At::default() };
        self.constants.run(|symbol| interpreter.value(symbol, at), &mut Vec::new(), values);
    }
}

fn recurrence(row: lower::Recurrence) -> Recurrence {
    use lower::Recurrence as Of;
    match row {
        Of::Time => Recurrence::Time,
        Of::Coordinate(i) => Recurrence::Coordinate(i),
        Of::Speed(i) => Recurrence::Speed(i),
        Of::Constant(c) => Recurrence::Constant(c),
        Of::Sum(a, b) => Recurrence::Sum(a, b),
        Of::Difference(a, b) => Recurrence::Difference(a, b),
        Of::Negative(a) => Recurrence::Negative(a),
        Of::Shifted(a, c) => Recurrence::Shifted(a, c),
        Of::Reduced(a, c) => Recurrence::Reduced(a, c),
        Of::Scaled(a, c) => Recurrence::Scaled(a, c),
        Of::Parted(a, c) => Recurrence::Parted(a, c),
        Of::Product(a, b) => Recurrence::Product(a, b),
        Of::Square(a) => Recurrence::Square(a),
        Of::Quotient(a, b) => Recurrence::Quotient(a, b),
        Of::Root(a) => Recurrence::Root(a),
        Of::Power(a, c) => Recurrence::Power(a, c),
        Of::Grown { function, of, by, falls } => Recurrence::Grown { function: at(function), of, by, falls },
        Of::Divided { function, of, by, falls } => Recurrence::Divided { function: at(function), of, by, falls },
        Of::Angle { y, x, square } => Recurrence::Angle { y, x, square },
    }
}

fn at(function: Unary) -> fn(f64) -> f64 {
    match function {
        Unary::Sin => f64::sin,
        Unary::Cos => f64::cos,
        Unary::Tan => f64::tan,
        Unary::Asin => f64::asin,
        Unary::Acos => f64::acos,
        Unary::Atan => f64::atan,
        Unary::Sinh => f64::sinh,
        Unary::Cosh => f64::cosh,
        Unary::Tanh => f64::tanh,
        Unary::Exp => f64::exp,
        Unary::Ln => f64::ln,
        // Nothing else grows by a function of itself.
        _ => |_| f64::NAN,
    }
}
