//! M and the Jacobians of F column by column, where they are not formed: F of numbers with slopes in several directions at once.

use dalembert_symbolic::expr::{Binary, DoubleDouble, Scalar, Symbol, Unary};
use dalembert_symbolic::interpret::{At, Function, Interpreter};

use crate::mechanism::dual::Dual;

/// So many columns are computed at once: two registers of AVX-512, four of AVX2.
const LANES: usize = 8;

/// A value with its slopes in as many directions.
#[derive(Clone, Copy)]
struct Slopes {
    value: f64,
    along: [f64; LANES],
}

/// The columns of ∂F/∂s for s one of these n symbols each, in order, n numbers each.
pub(super) fn columns(
    interpreter: &Interpreter,
    at: At<'_>,
    symbols: fn(u32) -> Symbol,
    mut put: impl FnMut(usize, &mut dyn Iterator<Item = f64>),
) {
    let n = interpreter.program().model.coordinates.len();
    let mut rows = vec![Slopes::constant(DoubleDouble::ZERO); n];
    for first in (0..n).step_by(LANES) {
        let moved: [Symbol; LANES] = std::array::from_fn(|lane| symbols((first + lane) as u32));
        let value = |symbol: Symbol| Slopes {
            value: interpreter.value(symbol, at),
            along: moved.map(|moved| f64::from(u8::from(moved == symbol))),
        };
        interpreter.evaluate_in(Function::Residual, value, &mut rows);
        for lane in 0..LANES.min(n - first) {
            put(first + lane, &mut rows.iter().map(|row| row.along[lane]));
        }
    }
}

impl Slopes {
    /// What changes by these slopes of its own; nothing where its argument does not change, however steep it is.
    fn of<const N: usize>(value: f64, parts: [(Slopes, f64); N]) -> Slopes {
        let part = |dx: f64, slope: f64| if dx == 0.0 { 0.0 } else { dx * slope };
        let along = |lane| parts.iter().fold(0.0, |sum, (x, slope)| sum + part(x.along[lane], *slope));
        Slopes { value, along: std::array::from_fn(along) }
    }

    fn map(self, other: Slopes, value: f64, of: impl Fn(f64, f64) -> f64) -> Slopes {
        Slopes { value, along: std::array::from_fn(|lane| of(self.along[lane], other.along[lane])) }
    }
}

impl Scalar for Slopes {
    fn constant(value: DoubleDouble) -> Slopes {
        Slopes { value: value.to_f64(), along: [0.0; LANES] }
    }

    fn unary(function: Unary, x: Slopes) -> Slopes {
        let of = Dual::unary(function, Dual::moving(x.value, 1.0));
        Slopes::of(of.value, [(x, of.slope)])
    }

    fn binary(operation: Binary, x: Slopes, y: Slopes) -> Slopes {
        let (a, b) = (x.value, y.value);
        match operation {
            Binary::Add => x.map(y, a + b, |dx, dy| dx + dy),
            Binary::Sub => x.map(y, a - b, |dx, dy| dx - dy),
            Binary::Mul => Slopes::of(a * b, [(x, b), (y, a)]),
            _ => {
                let [first, second] = [(1.0, 0.0), (0.0, 1.0)]
                    .map(|(dx, dy)| Dual::binary(operation, Dual::moving(a, dx), Dual::moving(b, dy)));
                Slopes::of(first.value, [(x, first.slope), (y, second.slope)])
            }
        }
    }
}
