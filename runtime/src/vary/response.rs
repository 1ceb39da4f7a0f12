//! What a small change of state, time or parameters does to accelerations and multipliers.

use crate::mechanism::{
    Along, At, Function, KktSolver, Singular, System, factor_packed, substitute_back, substitute_forward,
};

/// A state with its accelerations and multipliers, and the system that they solve, factored.
#[derive(Clone, Debug, Default)]
pub(crate) struct Response {
    form: KktSolver,
    /// M's packed lower triangle, factored, where no row is in force: all that there is to solve then.
    mass: Vec<f64>,
    unconstrained: bool,
    values: Vec<f64>,
    /// The accelerations at the state.
    pub a: Vec<f64>,
    /// The multipliers of all rows there.
    pub lambda: Vec<f64>,
    /// What the last direction does to the accelerations.
    pub da: Vec<f64>,
    /// And to the multipliers.
    pub dlambda: Vec<f64>,
    demands: Vec<f64>,
    /// ∂F/∂q and ∂F/∂q' at the state, a and λ held, as values of their patterns.
    forces: [Vec<f64>; 2],
    /// ∂(J a + γ)/∂q and ∂(J a + γ)/∂q' likewise.
    rows: [Vec<f64>; 2],
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
        self.unconstrained = system.active_rows().is_empty() && self.factor_mass(system, at);
        if self.unconstrained { Ok(()) } else { self.form.factor(system, at) }
    }

    /// Whether M alone is regular.
    fn factor_mass(&mut self, system: &dyn System, at: At<'_>) -> bool {
        let (n, pattern) = (system.len(), &system.description().mass_pattern);
        self.values.resize(pattern.len(), 0.0);
        self.mass.resize(n * (n + 1) / 2, 0.0);
        system.mass_matrix(at, &mut self.values);
        self.mass.fill(0.0);
        for ((row, column), value) in pattern.iter().zip(&self.values) {
            let (row, column) = ((*row).max(*column) as usize, (*row).min(*column) as usize);
            self.mass[row * (row + 1) / 2 + column] = *value;
        }
        factor_packed(&mut self.mass, n).is_ok()
    }

    /// δa and δλ of the forces −δF, which are in `da`, and of what the rows demand.
    fn solve(&mut self, system: &dyn System, at: At<'_>) -> Result<(), Singular> {
        let at = at.accelerated(&self.a).constrained(&self.lambda);
        if self.unconstrained {
            substitute_forward(&self.mass, &mut self.da);
            substitute_back(&self.mass, &mut self.da);
            self.dlambda.fill(0.0);
            return Ok(());
        }
        self.form.response(system, at, &mut self.da, &self.demands, &mut self.dlambda)
    }

    /// Solves M δa − (Jᵀ + B) δλ = −δF, J δa = −δ(J a + γ), both with a and λ held, for a direction of (t, q, v, p) at the state that was
    /// taken.
    ///
    /// # Errors
    /// Friction that leaves no reaction.
    pub fn along(&mut self, system: &dyn System, at: At<'_>, along: &Along<'_>) -> Result<(), Singular> {
        let full = at.accelerated(&self.a).constrained(&self.lambda);
        system.slopes(Function::Residual, full, along, &mut self.da);
        self.da.iter_mut().for_each(|force| *force = -*force);
        if !self.demands.is_empty() {
            system.slopes(Function::RowAccelerations, full, along, &mut self.demands);
        }
        self.solve(system, at)
    }

    /// The generated Jacobians at the state that was taken, for [`Response::column`].
    pub fn take_jacobians(&mut self, system: &dyn System, at: At<'_>) {
        let description = system.description();
        let at = at.accelerated(&self.a).constrained(&self.lambda);
        let [by_place, by_speed] = &mut self.forces;
        by_place.resize(description.stiffness_pattern.len(), 0.0);
        by_speed.resize(description.damping_pattern.len(), 0.0);
        system.jacobians(at, by_place, by_speed);
        if !self.demands.is_empty() {
            let [by_place, by_speed] = &mut self.rows;
            by_place.resize(description.constraint_stiffness_pattern.len(), 0.0);
            by_speed.resize(description.constraint_damping_pattern.len(), 0.0);
            system.constraint_jacobians(at, by_place, by_speed);
        }
    }

    /// As [`Response::along`], for δq and δq' by the Jacobians that were taken, one for all columns, and for a parameter by numbers with a
    /// slope: no Jacobian is generated of that.
    ///
    /// # Errors
    /// Friction that leaves no reaction.
    pub fn column(&mut self, system: &dyn System, at: At<'_>, along: &Along<'_>) -> Result<(), Singular> {
        let full = at.accelerated(&self.a).constrained(&self.lambda);
        self.da.fill(0.0);
        self.demands.fill(0.0);
        if along.parameter.is_some() {
            let of_parameter = Along { parameter: along.parameter, ..Along::default() };
            system.slopes(Function::Residual, full, &of_parameter, &mut self.da);
            if !self.demands.is_empty() {
                system.slopes(Function::RowAccelerations, full, &of_parameter, &mut self.demands);
            }
        }
        let known = system.description();
        let patterns = [&known.stiffness_pattern, &known.damping_pattern];
        for ((pattern, values), x) in patterns.into_iter().zip(&self.forces).zip([along.q, along.v]) {
            add_product(pattern, values, x, &mut self.da);
        }
        let patterns = [&known.constraint_stiffness_pattern, &known.constraint_damping_pattern];
        for ((pattern, values), x) in patterns.into_iter().zip(&self.rows).zip([along.q, along.v]) {
            add_product(pattern, values, x, &mut self.demands);
        }
        self.da.iter_mut().for_each(|force| *force = -*force);
        self.solve(system, at)
    }

    /// As [`Response::along`], for a small force in the place of a direction.
    ///
    /// # Errors
    /// Friction that leaves no reaction.
    pub fn of_force(&mut self, system: &dyn System, at: At<'_>, force: &[f64]) -> Result<(), Singular> {
        self.da.copy_from_slice(force);
        self.demands.fill(0.0);
        self.solve(system, at)
    }

    /// Moves a state by the least change in the metric of M after which all rows in force have changed by −`off`: δ with J δ = −off.
    pub fn least_move(&mut self, off: &[f64], moved: &mut [f64]) {
        let mut right: Vec<f64> = self.form.active().iter().map(|row| -off[*row]).collect();
        moved.fill(0.0);
        self.form.solve(moved, &mut right);
    }
}

/// out += A x; what does not change adds nothing, however steep the function is.
fn add_product(pattern: &[(u32, u32)], values: &[f64], x: &[f64], out: &mut [f64]) {
    for ((row, column), value) in pattern.iter().zip(values) {
        let x = x[*column as usize];
        if x != 0.0 {
            out[*row as usize] += value * x;
        }
    }
}
