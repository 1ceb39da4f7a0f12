//! An interpreted mechanism in double-double: 32 digits.

use dalembert_symbolic::expr::{DoubleDouble, Symbol};
use dalembert_symbolic::interpret::{self, Function};

use super::Interpreted;
use crate::mechanism::SingularMass;

/// A state in double-double; a slice may be empty where nothing reads it.
#[derive(Clone, Copy)]
pub(crate) struct ExtendedAt<'a> {
    pub t: DoubleDouble,
    pub q: &'a [DoubleDouble],
    pub v: &'a [DoubleDouble],
    pub a: &'a [DoubleDouble],
}

/// A pivot of M that is no more than this of its diagonal entry is none.
const NEGLIGIBLE: f64 = 1e-26;

impl Interpreted {
    /// a = −M⁻¹ h of a mechanism without constraints.
    ///
    /// # Errors
    /// The coordinate whose pivot vanishes.
    pub(crate) fn extended_accelerations(
        &self,
        at: ExtendedAt<'_>,
        a: &mut [DoubleDouble],
    ) -> Result<(), SingularMass> {
        if self.is_unformed() {
            return self.eliminated(at, a);
        }
        let pattern = &self.description.mass_pattern;
        let mut entries = vec![DoubleDouble::ZERO; pattern.len()];
        self.extended(Function::Mass, at, &mut entries);
        let n = a.len();
        let mut lower = vec![DoubleDouble::ZERO; n * n];
        for ((row, column), entry) in pattern.iter().zip(entries) {
            lower[*row as usize * n + *column as usize] = entry;
        }
        self.extended(Function::Bias, at, a);
        a.iter_mut().for_each(|h| *h = -*h);
        solve(&mut lower, a)
    }

    /// The same as they are written out.
    fn eliminated(&self, at: ExtendedAt<'_>, a: &mut [DoubleDouble]) -> Result<(), SingularMass> {
        let u = self.extended_inputs(at);
        let (found, tests) = self.interpreter.accelerations_in(|symbol| self.known(symbol, at, &u));
        let fails = |[pivot, size]: &[DoubleDouble; 2]| {
            let pivot = pivot.to_f64().abs();
            pivot.is_nan() || pivot <= NEGLIGIBLE * size.to_f64().abs()
        };
        a.copy_from_slice(&found);
        match tests.iter().position(fails) {
            Some(coordinate) => Err(SingularMass { coordinate }),
            None => Ok(()),
        }
    }

    /// Fills the outputs, in the order of [`System::outputs`](crate::mechanism::System::outputs).
    pub(crate) fn extended_outputs(&self, at: ExtendedAt<'_>, values: &mut [DoubleDouble]) {
        self.extended(Function::Outputs, at, values);
    }

    /// q'·∂T/∂q' − T + V, J.
    pub(crate) fn extended_jacobi(&self, at: ExtendedAt<'_>) -> DoubleDouble {
        let mut energies = [DoubleDouble::ZERO; 5];
        self.extended(Function::Energy, at, &mut energies);
        energies[2]
    }

    fn extended(&self, function: Function, at: ExtendedAt<'_>, values: &mut [DoubleDouble]) {
        let u = self.extended_inputs(at);
        self.interpreter.evaluate_in(function, |symbol| self.known(symbol, at, &u), values);
    }

    fn extended_inputs(&self, at: ExtendedAt<'_>) -> Vec<DoubleDouble> {
        let mut u = vec![DoubleDouble::ZERO; 3 * self.signals.len()];
        if !u.is_empty() {
            self.interpreter.evaluate_in(Function::Inputs, |symbol| self.known(symbol, at, &[]), &mut u);
        }
        u
    }

    fn known(&self, symbol: Symbol, at: ExtendedAt<'_>, u: &[DoubleDouble]) -> DoubleDouble {
        let get = |list: &[DoubleDouble], i: u32| list.get(i as usize).copied().unwrap_or_default();
        match symbol {
            Symbol::Time => at.t,
            Symbol::Coordinate(i) => get(at.q, i),
            Symbol::Speed(i) => get(at.v, i),
            Symbol::Acceleration(i) => get(at.a, i),
            Symbol::Input(k, order) => get(u, 3 * k + u32::from(order)),
            _ => self.interpreter.value(symbol, interpret::At::default()).into(),
        }
    }
}

/// x of M x = f in the place of f, by LDLᵀ of the lower triangle, which it becomes.
fn solve(m: &mut [DoubleDouble], f: &mut [DoubleDouble]) -> Result<(), SingularMass> {
    let n = f.len();
    for k in 0..n {
        let diagonal = m[k * n + k];
        for j in 0..k {
            let factor = m[k * n + j];
            // L_kj D_j, of which the row's later entries were not yet rid.
            for i in j + 1..k {
                m[k * n + i] = m[k * n + i] - factor * m[i * n + j];
            }
            m[k * n + j] = factor / m[j * n + j];
            m[k * n + k] = m[k * n + k] - factor * m[k * n + j];
        }
        let pivot = m[k * n + k].to_f64().abs();
        if pivot.is_nan() || pivot <= NEGLIGIBLE * diagonal.to_f64().abs() {
            return Err(SingularMass { coordinate: k });
        }
        for j in 0..k {
            f[k] = f[k] - m[k * n + j] * f[j];
        }
    }
    for k in (0..n).rev() {
        f[k] = f[k] / m[k * n + k];
    }
    for k in (0..n).rev() {
        for j in 0..k {
            f[j] = f[j] - m[k * n + j] * f[k];
        }
    }
    Ok(())
}
