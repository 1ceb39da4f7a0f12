//! What work is counted in.

use crate::integrate::operations_of_exact;
use crate::mechanism::{Method, OfPart, System};
use crate::run::{Run, Work};

/// What Jacobians and factorizations cost in evaluations of the accelerations, by counting operations.
///
/// Generated functions know how many operations they have; elimination of n coordinates and m rows of constraints takes
/// (n³ + m³)/3 + 2 n m (n + m), a solution 2 (n + m)², a factorization of the matrix of an implicit method 2 n³/3 and of a complex
/// one four times as many, RATTLE's 2 m³/3 + 2 n m (n + m), with two solutions that go with it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct WorkUnits {
    /// Operations of one evaluation of the accelerations.
    pub operations: f64,
    /// ∂a/∂q and ∂a/∂q', in evaluations.
    pub jacobian: f64,
    /// The matrices of a step of an implicit method, of a part of RATTLE, or of an exact one, in evaluations.
    pub factorization: f64,
    /// What a step takes beside evaluations, where it is most of the work: the product of an exact one.
    pub step: f64,
}

impl WorkUnits {
    /// The costs of a method on a mechanism.
    pub fn of(system: &dyn System, method: Method) -> WorkUnits {
        let (description, n) = (system.description(), system.len() as f64);
        let counts = &description.counts;
        let m = description.phases.get(system.phase()).map_or(0, |phase| phase.rows.len()) as f64;
        let elimination = (n.powi(3) + m.powi(3)) / 3.0 + 2.0 * n * m * (n + m);
        let solution = 2.0 * (n + m).powi(2);
        let eliminated = if m > 0.0 { f64::from(counts.mass_and_bias) + elimination + solution } else { 0.0 };
        let operations = f64::from(counts.accelerations).max(eliminated).max(1.0);
        let jacobian = operations + f64::from(counts.jacobians) + elimination + 2.0 * n * solution;
        let complex = match method {
            Method::Radau5 => 5.0,
            Method::Gauss4 => 4.0,
            Method::Gauss6 => 5.0,
            _ => 1.0,
        };
        let elimination = complex * 2.0 * n.powi(3) / 3.0;
        let (factorization, step) = match method {
            Method::Exact => operations_of_exact(system.len(), description.structure.time_dependent),
            method if method.is_of_verlet_steps() => {
                (2.0 * m.powi(3) / 3.0 + 2.0 * n * m * (n + m) + 2.0 * solution, 0.0)
            }
            _ => (elimination, 0.0),
        };
        let [jacobian, factorization, step] = [jacobian, factorization, step].map(|cost| cost / operations);
        WorkUnits { operations, jacobian, factorization, step }
    }

    /// What a run cost in evaluations of the accelerations of the whole: where its parts were run apart, the sum of theirs.
    pub(crate) fn of_run(system: &dyn System, run: &Run) -> f64 {
        let whole = WorkUnits::of(system, run.method);
        let place = run.first().q;
        let operations = run.parts.iter().enumerate().filter_map(|(index, part)| {
            let units = WorkUnits::of(&OfPart::new(system, index, &place)?, part.method);
            Some(units.operations * units.total(&part.work))
        });
        if run.parts.is_empty() { whole.total(&run.work) } else { operations.sum::<f64>() / whole.operations }
    }

    /// n_f + c_J n_J + c_LU n_LU + c_h n_h.
    pub fn total(&self, work: &Work) -> f64 {
        let Work { evaluations, jacobians, factorizations, steps, .. } = *work;
        evaluations as f64
            + self.jacobian * jacobians as f64
            + self.factorization * factorizations as f64
            + self.step * steps as f64
    }
}
