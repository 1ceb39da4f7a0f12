//! Discontinuities at whose surface the constraints in force hold the motion, as `abs(x')` where friction holds x' = 0.

use nalgebra::DMatrix;

use super::contacts::{Rates, is_held};
use crate::mechanism::dense::{constraint_matrix, constraint_triples};
use crate::mechanism::{At, System, rows_in_force};

/// Which switches the constraints in force keep at zero, since their arguments are sums of rates that these constraints hold: what such an argument is,
/// for as long as they act, is rounding.
pub(crate) fn held_switches<S: System + ?Sized>(system: &S, (t, y): (f64, &[f64])) -> Vec<bool> {
    let count = system.description().switches.len();
    let active: Vec<usize> = rows_in_force(system).collect();
    if count == 0 || active.is_empty() {
        return vec![false; count];
    }
    let at = At::packed(t, y, system.len());
    let arguments = Arguments::new(system, at);
    let rows = Rows::new(system, at, &active);
    (0..count).map(|switch| rows.hold(at.v, &arguments, switch)).collect()
}

/// What the arguments of switches are, and what changes them.
struct Arguments {
    values: Vec<f64>,
    /// Their rates without accelerations.
    bias: Vec<f64>,
    /// What each acceleration makes of their rates: ∂e/∂q'.
    slopes: Vec<Vec<f64>>,
}

impl Arguments {
    fn new<S: System + ?Sized>(system: &S, at: At<'_>) -> Arguments {
        let (n, count) = (system.len(), system.description().switches.len());
        let pairs = |a: &[f64]| {
            let mut pairs = vec![0.0; 2 * count];
            system.switches(at.accelerated(a), &mut pairs);
            pairs
        };
        let rest = pairs(&vec![0.0; n]);
        let unit = |i: usize| (0..n).map(|j| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
        let moved: Vec<Vec<f64>> = (0..n).map(|i| pairs(&unit(i))).collect();
        let slope = |k: usize| moved.iter().map(|pairs| pairs[2 * k + 1] - rest[2 * k + 1]).collect();
        Arguments {
            values: rest.iter().step_by(2).copied().collect(),
            bias: rest.iter().skip(1).step_by(2).copied().collect(),
            slopes: (0..count).map(slope).collect(),
        }
    }
}

/// The rows in force at a state.
struct Rows {
    rates: Vec<f64>,
    /// J.
    matrix: DMatrix<f64>,
    /// γ of c'' = J a + γ.
    bias: Vec<f64>,
}

impl Rows {
    fn new<S: System + ?Sized>(system: &S, at: At<'_>, active: &[usize]) -> Rows {
        let triples = constraint_triples(system, at);
        let mut bias = vec![0.0; triples.len()];
        system.constraint_bias(at, &mut bias);
        Rows {
            rates: active.iter().map(|row| triples[*row][1]).collect(),
            matrix: constraint_matrix(system, at, active),
            bias: active.iter().map(|row| bias[*row]).collect(),
        }
    }

    /// Whether they hold the rate that the argument of a switch is.
    fn hold(&self, v: &[f64], arguments: &Arguments, switch: usize) -> bool {
        let (own, slopes) = (self.rates.len(), &arguments.slopes[switch]);
        // What depends on no speed, or on one that no row contains, needs no equations to be solved.
        let is_free = |i: usize| slopes[i] != 0.0 && self.matrix.column(i).iter().all(|entry| *entry == 0.0);
        if slopes.iter().all(|slope| *slope == 0.0) || (0..v.len()).any(is_free) {
            return false;
        }
        let matrix =
            DMatrix::from_fn(own + 1, v.len(), |row, i| if row < own { self.matrix[(row, i)] } else { slopes[i] });
        let rates = [self.rates.as_slice(), &[arguments.values[switch]]].concat();
        let moving = |row: usize| v.iter().enumerate().map(move |(i, v)| (row, i, v));
        let driven = |row: usize| rates[row] - moving(row).map(|(row, i, v)| matrix[(row, i)] * v).sum::<f64>();
        let terms =
            |row: usize| moving(row).map(|(row, i, v)| (matrix[(row, i)] * v).abs()).sum::<f64>() + driven(row).abs();
        let bias = [self.bias.as_slice(), &[arguments.bias[switch]]].concat();
        let active: Vec<usize> = (0..own).collect();
        let known = Rates { driven: &driven, terms: &terms, bias: &bias };
        is_held(&matrix, (&self.matrix.transpose(), &active), own, &known).unwrap_or(false)
    }
}
