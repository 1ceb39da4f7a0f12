//! What a small change of state, time or parameters does to accelerations and multipliers.

use crate::mechanism::{Along, At, Function, KktSolver, Singular, System};

/// A state with its accelerations and multipliers, and the system that they solve, factored.
#[derive(Clone, Debug, Default)]
pub(super) struct Response {
    form: KktSolver,
    /// The accelerations at the state.
    pub a: Vec<f64>,
    /// The multipliers of all rows there.
    pub lambda: Vec<f64>,
    /// What the last direction does to the accelerations.
    pub da: Vec<f64>,
    /// And to the multipliers.
    pub dlambda: Vec<f64>,
    demands: Vec<f64>,
}

impl Response {
    /// Takes a state.
    ///
    /// # Errors
    /// Those of the accelerations there.
    pub fn stand(&mut self, system: &dyn System, at: At<'_>) -> Result<(), Singular> {
        let (n, rows) = (system.len(), system.description().rows.len());
        for (list, size) in [(&mut self.a, n), (&mut self.da, n)] {
            list.resize(size, 0.0);
        }
        for list in [&mut self.lambda, &mut self.dlambda, &mut self.demands] {
            list.resize(rows, 0.0);
        }
        system.accelerations_and_multipliers(at, &mut self.a, &mut self.lambda)?;
        self.form.factor(system, At::place(at.t, at.q))
    }

    /// Solves M δa − (Jᵀ + B) δλ = −δF, J δa = −δ(J a + γ), both with a and λ held, for a direction of (t, q, v, p) at the state that was
    /// taken.
    ///
    /// # Errors
    /// Friction that leaves no reaction.
    pub fn along(&mut self, system: &dyn System, at: At<'_>, along: &Along<'_>) -> Result<(), Singular> {
        let at = at.accelerated(&self.a).constrained(&self.lambda);
        system.slopes(Function::Residual, at, along, &mut self.da);
        self.da.iter_mut().for_each(|force| *force = -*force);
        if !self.demands.is_empty() {
            system.slopes(Function::RowAccelerations, at, along, &mut self.demands);
        }
        self.form.response(system, at, &mut self.da, &self.demands, &mut self.dlambda)
    }

    /// Moves a state by the least change in the metric of M after which all rows in force have changed by −`off`: δ with J δ = −off.
    pub fn least_move(&mut self, off: &[f64], moved: &mut [f64]) {
        let mut right: Vec<f64> = self.form.active().iter().map(|row| -off[*row]).collect();
        moved.fill(0.0);
        self.form.solve(moved, &mut right);
    }
}
