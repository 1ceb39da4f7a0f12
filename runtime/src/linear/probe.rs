//! A mechanism whose inputs and clock stand still: F(q) = F(q, q', q'' = 0) and its derivatives.

use nalgebra::DMatrix;

use super::{LinearError, SparseMatrix};
use crate::mechanism::System;

/// Steady forces of a mechanism.
pub(super) struct Probe {
    system: Box<dyn System>,
    pub n: usize,
    pub v: Vec<f64>,
    zero: Vec<f64>,
}

impl Probe {
    /// Holds inputs at their values at t = 0; their rates count as 0.
    pub fn new<S: System + ?Sized>(system: &S, v: &[f64]) -> Self {
        let n = system.len();
        let mut held = system.boxed_clone();
        let mut inputs = vec![0.0; 3 * system.description().inputs.len()];
        system.inputs(0.0, &mut inputs);
        for (index, input) in inputs.chunks_exact(3).enumerate() {
            let value = input[0];
            held.set_input(index, std::sync::Arc::new(move |_| [value, 0.0, 0.0]));
        }
        Probe { system: held, n, v: v.to_vec(), zero: vec![0.0; n] }
    }

    pub fn names(&self) -> Vec<String> {
        self.system.description().coordinates.iter().map(|c| c.name.to_string()).collect()
    }

    pub fn named(&self, values: &[f64]) -> Vec<(String, f64)> {
        self.names().into_iter().zip(values.iter().copied()).collect()
    }

    fn name(&self, index: usize) -> String {
        self.names().swap_remove(index)
    }

    /// F(q, q', 0).
    pub fn force(&self, q: &[f64]) -> Vec<f64> {
        self.force_at(0.0, q)
    }

    fn force_at(&self, t: f64, q: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; self.n];
        self.system.residual(t, q, &self.v, &self.zero, &mut force);
        force
    }

    /// M, ∂F/∂q' and ∂F/∂q.
    pub fn matrices(&self, q: &[f64]) -> [SparseMatrix; 3] {
        let description = self.system.description();
        let mut mass = vec![0.0; description.mass_pattern.len()];
        let mut stiffness = vec![0.0; description.stiffness_pattern.len()];
        let mut damping = vec![0.0; description.damping_pattern.len()];
        self.system.mass_matrix(0.0, q, &mut mass);
        self.system.jacobians(0.0, q, &self.v, &self.zero, &mut stiffness, &mut damping);
        [
            SparseMatrix::symmetric(self.n, &description.mass_pattern, &mass),
            SparseMatrix::new(self.n, self.n, &description.damping_pattern, &damping),
            SparseMatrix::new(self.n, self.n, &description.stiffness_pattern, &stiffness),
        ]
    }

    /// ∂F/∂q, dense.
    pub fn stiffness(&self, q: &[f64]) -> DMatrix<f64> {
        self.matrices(q)[2].to_dense()
    }

    /// −∂F/∂(u, u', u''), n × 3m.
    pub fn input(&self, q: &[f64]) -> SparseMatrix {
        let description = self.system.description();
        let mut values = vec![0.0; description.input_pattern.len()];
        self.system.input_jacobian(0.0, q, &self.v, &self.zero, &mut values);
        for value in &mut values {
            *value = -*value;
        }
        SparseMatrix::new(self.n, 3 * description.inputs.len(), &description.input_pattern, &values)
    }

    /// Refuses equations that change with time though all inputs are held, and speeds that cannot last.
    pub fn check(&self, q: &[f64]) -> Result<(), LinearError> {
        let size = |what, given| LinearError::WrongSize { what, given, expected: self.n };
        if q.len() != self.n {
            return Err(size("the point", q.len()));
        }
        if self.v.len() != self.n {
            return Err(size("the list of speeds", self.v.len()));
        }
        if let Some(i) = (0..self.n).find(|i| !(q[*i].is_finite() && self.v[*i].is_finite())) {
            return Err(LinearError::NonFinite { what: format!("`{}`", self.name(i)) });
        }
        let now = self.force(q);
        if let Some(i) = now.iter().position(|f| !f.is_finite()) {
            return Err(LinearError::NonFinite { what: format!("the force of `{}`", self.name(i)) });
        }
        if self.system.description().structure.time_dependent {
            for t in [0.37, 1.9, 53.0] {
                let later = self.force_at(t, q);
                let scale = now.iter().chain(&later).fold(0.0_f64, |s, f| s.max(f.abs()));
                if let Some(i) = (0..self.n).find(|i| (later[*i] - now[*i]).abs() > 1e-9 * scale) {
                    return Err(LinearError::DependsOnTime { coordinate: self.name(i) });
                }
            }
        }
        if self.v.iter().any(|v| *v != 0.0) {
            let stiffness = &self.matrices(q)[2];
            let scale = stiffness.entries.iter().fold(0.0_f64, |s, e| s.max(e.2.abs()));
            for (_, column, value) in &stiffness.entries {
                if self.v[*column as usize] != 0.0 && value.abs() > 1e-12 * scale {
                    return Err(LinearError::NotSteady { coordinate: self.name(*column as usize) });
                }
            }
        }
        Ok(())
    }
}
