//! What small changes of forces and rows do to accelerations.

use super::KktSolver;
use crate::mechanism::slopes::springs;
use crate::mechanism::{At, Singular, System};
use crate::mechanism::{factor_packed, substitute_back, substitute_forward};

impl KktSolver {
    /// Takes M and J at a place and factors what gives the accelerations there.
    ///
    /// # Errors
    /// As [`KktSolver::factor`].
    pub fn factor_for_slopes(&mut self, system: &dyn System, at: At<'_>) -> Result<(), Singular> {
        if springs(system).is_none() {
            return self.factor(system, at);
        }
        self.take(system, at);
        Ok(factor_packed(&mut self.mass, self.n)?)
    }

    /// Slopes of what the rows in force demand, ∂(J a + γ)/∂q and ∂(J a + γ)/∂q' with what Baumgarte's gain adds; of the
    /// multipliers of springs, −λ = k c + d c'.  Dense, column by column.
    pub fn row_slopes(&mut self, system: &dyn System, at: At<'_>, values: &mut Vec<f64>, out: &mut [Vec<f64>; 2]) {
        let description = system.description();
        let m = self.active.len();
        let scatter = |out: &mut Vec<f64>, pattern: &[(u32, u32)], values: &[f64], factor: &dyn Fn(usize) -> f64| {
            for ((row, column), value) in pattern.iter().zip(values) {
                if let Some(k) = self.active.iter().position(|active| *active == *row as usize) {
                    out[*column as usize * m + k] += factor(*row as usize) * value;
                }
            }
        };
        for out in out.iter_mut() {
            out.clear();
            out.resize(m * self.n, 0.0);
        }
        let [by_place, by_speed] = out;
        let holonomic = |row: usize| description.rows[row].holonomic;
        let alpha = system.baumgarte_gain();
        let (stiffness, damping) = springs(system).unwrap_or((alpha * alpha, 2.0 * alpha));
        // c has the slopes J; c' has ∂c'/∂q and J.
        let of_place = |row: usize| if holonomic(row) { stiffness } else { 0.0 };
        let of_rate = |row: usize| match springs(system) {
            None if !holonomic(row) => alpha,
            _ => damping,
        };
        if springs(system).is_none() {
            let patterns = [&description.constraint_stiffness_pattern, &description.constraint_damping_pattern];
            values.resize(patterns[0].len() + patterns[1].len(), 0.0);
            let (dq, dv) = values.split_at_mut(patterns[0].len());
            system.constraint_jacobians(at, dq, dv);
            scatter(by_place, patterns[0], dq, &|_| 1.0);
            scatter(by_speed, patterns[1], dv, &|_| 1.0);
            if alpha == 0.0 {
                return;
            }
        }
        let pattern = &description.constraint_pattern;
        values.resize(pattern.len(), 0.0);
        system.constraint_matrix(at, values);
        scatter(by_place, pattern, values, &of_place);
        scatter(by_speed, pattern, values, &of_rate);
        let pattern = &description.constraint_rate_pattern;
        values.resize(pattern.len(), 0.0);
        system.constraint_rate_jacobian(at, values);
        scatter(by_place, pattern, values, &of_rate);
    }

    /// Adds `factor` times what the rows in force demand, J a + γ with Baumgarte's part, or k c + d c' of springs, to `out`.
    pub fn add_rows(&mut self, system: &dyn System, at: At<'_>, factor: f64, values: &mut Vec<f64>, out: &mut [f64]) {
        let description = system.description();
        let count = description.rows.len();
        let pattern = &description.constraint_pattern;
        values.resize(4 * count + pattern.len(), 0.0);
        let (gamma, rest) = values.split_at_mut(count);
        let (triples, jacobian) = rest.split_at_mut(3 * count);
        system.constraints(at, triples);
        let demands = springs(system).is_none();
        if demands {
            system.constraint_bias(at, gamma);
            system.constraint_matrix(at, jacobian);
            for ((row, column), value) in pattern.iter().zip(jacobian) {
                gamma[*row as usize] += *value * at.a[*column as usize];
            }
        }
        let alpha = system.baumgarte_gain();
        let (stiffness, damping) = springs(system).unwrap_or((alpha * alpha, 2.0 * alpha));
        for (out, &row) in out.iter_mut().zip(&self.active) {
            let [c, rate, _] = [triples[3 * row], triples[3 * row + 1], triples[3 * row + 2]];
            let holonomic = description.rows[row].holonomic;
            let wanted = if demands { gamma[row] } else { 0.0 };
            let back = match (holonomic, demands) {
                (true, _) => stiffness * c + damping * rate,
                (false, true) => alpha * rate,
                (false, false) => damping * rate,
            };
            *out += factor * (wanted + back);
        }
    }

    /// Overwrites a small force with what it does to the accelerations, with what small changes of the rows' demands, of all rows of the
    /// mechanism, do to them, and tells what both do to the multipliers: M δa − (Jᵀ + B) δλ = δF, J δa = −δ(J a + γ).
    ///
    /// # Errors
    /// Friction that leaves no reaction, or more than one.
    pub fn response(
        &mut self,
        system: &dyn System,
        at: At<'_>,
        force: &mut [f64],
        demands: &[f64],
        lambda: &mut [f64],
    ) -> Result<(), Singular> {
        self.gamma.iter_mut().zip(&self.active).for_each(|(gamma, row)| *gamma = demands[*row]);
        let solved = self.solve_held(system, at, &[], force);
        lambda.fill(0.0);
        for (k, row) in self.active.iter().enumerate() {
            lambda[*row] = self.found[k] + self.strength[k] * self.gamma[k];
        }
        solved
    }

    /// Overwrites a small force with what it does to the accelerations, with small changes −`right` of what the rows
    /// demand; rows that are left out keep their multipliers.
    pub fn respond(&mut self, system: &dyn System, at: At<'_>, force: &mut [f64], right: &[f64]) {
        let n = self.n;
        if springs(system).is_some() {
            // The multipliers change by `right`.
            for (k, lambda) in right.iter().enumerate() {
                super::add(force, *lambda, &self.rows[k * n..][..n]);
            }
            let pattern = &system.description().friction_pattern;
            self.values.resize(pattern.len(), 0.0);
            system.friction(at, &mut self.values);
            for ((coordinate, row), value) in pattern.iter().zip(&self.values) {
                if let Some(k) = self.active.iter().position(|active| *active == *row as usize) {
                    force[*coordinate as usize] += value * right[k];
                }
            }
        }
        if springs(system).is_some() || self.active.is_empty() {
            substitute_forward(&self.mass, force);
            substitute_back(&self.mass, force);
            return;
        }
        self.gamma.iter_mut().zip(right).for_each(|(gamma, right)| *gamma = -right);
        // Friction that leaves no reaction was told when the state was evaluated.
        let _ = self.solve_held(system, at, &[], force);
    }
}
