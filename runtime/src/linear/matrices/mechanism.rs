//! M x'' + C x' + K x = Σ bᵢ uᵢ(t) as a mechanism of its own.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::cholesky;
use crate::linear::LinearError;
use crate::matrix::is_symmetric;
use crate::mechanism::{At, Coordinate, Description, Energy, Scene, Signal, Singular, Structure, System};

/// A mechanism given by its matrices; what works on mechanisms works on it.
///
/// M must be symmetric and positive definite; C and K may be anything.
#[derive(Clone, Debug)]
pub struct LinearMechanism {
    m: DMatrix<f64>,
    c: DMatrix<f64>,
    k: DMatrix<f64>,
    factor: DMatrix<f64>,
    inputs: Vec<Input>,
    description: Description,
}

#[derive(Clone)]
struct Input {
    column: DVector<f64>,
    signal: Signal,
}

impl std::fmt::Debug for Input {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?} u(t)", self.column.as_slice())
    }
}

impl LinearMechanism {
    /// From M, C and K; the coordinates are `x[1]`, `x[2]`, …
    ///
    /// # Errors
    /// Matrices of different sizes, M not symmetric or not positive definite, numbers that are not finite.
    pub fn new(m: DMatrix<f64>, c: DMatrix<f64>, k: DMatrix<f64>) -> Result<Self, LinearError> {
        let n = m.nrows();
        for (matrix, what) in [(&m, "M"), (&c, "C"), (&k, "K")] {
            let wrong = [matrix.nrows(), matrix.ncols()].into_iter().find(|size| *size != n);
            if let Some(given) = wrong {
                return Err(LinearError::WrongSize { what, given, expected: n });
            }
            if matrix.iter().any(|x| !x.is_finite()) {
                return Err(LinearError::NonFinite { what: what.to_owned() });
            }
        }
        if !is_symmetric(&m) {
            return Err(LinearError::NotSymmetric { what: "M" });
        }
        let name = |i: usize| format!("x[{}]", i + 1);
        let factor = cholesky(&m).map_err(|i| LinearError::SingularMass { coordinate: name(i) })?;
        let places = |keep: &dyn Fn(usize, usize) -> bool| -> Vec<(u32, u32)> {
            let all = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            all.filter(|(i, j)| keep(*i, *j)).map(|(i, j)| (i as u32, j as u32)).collect()
        };
        let description = Description {
            name: "LinearMechanism".into(),
            coordinates: (0..n).map(|i| Coordinate { name: name(i).into(), unit: "".into() }).collect(),
            mass_pattern: places(&|i, j| j <= i && m[(i, j)] != 0.0).into(),
            damping_pattern: places(&|i, j| c[(i, j)] != 0.0).into(),
            stiffness_pattern: places(&|i, j| k[(i, j)] != 0.0).into(),
            scenes: vec!["scene".into()].into(),
            structure: Structure {
                dimension: 2,
                constant_mass: true,
                separable: c.iter().all(|x| *x == 0.0),
                linear: true,
                conservative: c.iter().all(|x| *x == 0.0) && is_symmetric(&k),
                ..Structure::default()
            },
            ..Description::default()
        };
        Ok(LinearMechanism { m, c, k, factor, inputs: Vec::new(), description })
    }

    /// With one more force, `column` times u(t); `signal` gives (u, u', u'').
    ///
    /// # Errors
    /// A column of another size.
    pub fn with_input(mut self, name: &str, column: &[f64], signal: Signal) -> Result<Self, LinearError> {
        let (given, expected) = (column.len(), self.m.nrows());
        if given != expected {
            return Err(LinearError::WrongSize { what: "the column of an input", given, expected });
        }
        let index = self.inputs.len() as u32;
        self.description.inputs.to_mut().push(name.to_owned().into());
        let rows = (0..expected).filter(|i| column[*i] != 0.0);
        self.description.input_pattern.to_mut().extend(rows.map(|i| (i as u32, 3 * index)));
        self.description.structure.conservative = false;
        self.description.structure.time_dependent = true;
        self.inputs.push(Input { column: DVector::from_column_slice(column), signal });
        Ok(self)
    }

    fn forces(&self, t: f64) -> DVector<f64> {
        let zero = DVector::zeros(self.m.nrows());
        self.inputs.iter().fold(zero, |sum, input| sum + &input.column * (input.signal)(t)[0])
    }

    fn unbalanced(&self, at: At<'_>) -> DVector<f64> {
        &self.c * DVector::from_column_slice(at.v) + &self.k * DVector::from_column_slice(at.q) - self.forces(at.t)
    }
}

impl System for LinearMechanism {
    fn description(&self) -> &Description {
        &self.description
    }

    fn accelerations(&self, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        let mut force = -self.unbalanced(at);
        self.factor.solve_lower_triangular_mut(&mut force);
        self.factor.tr_solve_lower_triangular_mut(&mut force);
        a.copy_from_slice(force.as_slice());
        Ok(())
    }

    fn mass_matrix(&self, _: At<'_>, values: &mut [f64]) {
        pick(&self.m, &self.description.mass_pattern, values);
    }

    fn bias(&self, at: At<'_>, h: &mut [f64]) {
        h.copy_from_slice(self.unbalanced(at).as_slice());
    }

    fn residual(&self, at: At<'_>, f: &mut [f64]) {
        let force = self.unbalanced(at) + &self.m * DVector::from_column_slice(at.a);
        f.copy_from_slice(force.as_slice());
    }

    fn jacobians(&self, _: At<'_>, dq: &mut [f64], dv: &mut [f64]) {
        pick(&self.k, &self.description.stiffness_pattern, dq);
        pick(&self.c, &self.description.damping_pattern, dv);
    }

    fn input_jacobian(&self, _: At<'_>, du: &mut [f64]) {
        for ((row, column), value) in self.description.input_pattern.iter().zip(du) {
            *value = -self.inputs[*column as usize / 3].column[*row as usize];
        }
    }

    fn magnitudes(&self, at: At<'_>, sums: &mut [f64]) {
        let size = |x: &[f64]| DVector::from_fn(self.m.nrows(), |i, _| x.get(i).map_or(0.0, |x| x.abs()));
        let inputs = self.inputs.iter().fold(DVector::zeros(self.m.nrows()), |sum, input| {
            sum + input.column.abs() * (input.signal)(at.t)[0].abs()
        });
        let sum = self.m.abs() * size(at.a) + self.c.abs() * size(at.v) + self.k.abs() * size(at.q) + inputs;
        sums.copy_from_slice(sum.as_slice());
    }

    fn energy(&self, at: At<'_>) -> Energy {
        let (q, v) = (DVector::from_column_slice(at.q), DVector::from_column_slice(at.v));
        let even = (&self.k + self.k.transpose()) * 0.5;
        let kinetic = 0.5 * v.dot(&(&self.m * &v));
        let potential = 0.5 * q.dot(&(&even * &q));
        let power = v.dot(&(self.forces(at.t) - &self.c * &v - (&self.k - &even) * &q));
        let (speeds, places) = (v.abs(), q.abs());
        let scale = 0.5 * (speeds.dot(&(self.m.abs() * &speeds)) + places.dot(&(even.abs() * &places)));
        Energy { kinetic, potential, jacobi: kinetic + potential, power, scale }
    }

    fn inputs(&self, t: f64, values: &mut [f64]) {
        for (input, slot) in self.inputs.iter().zip(values.chunks_exact_mut(3)) {
            slot.copy_from_slice(&(input.signal)(t));
        }
    }

    fn set_input(&mut self, index: usize, signal: Signal) {
        if let Some(input) = self.inputs.get_mut(index) {
            input.signal = signal;
        }
    }

    fn scene(&self, _: usize) -> Scene {
        let zero = vec![0.0; self.m.nrows()];
        Scene { q: zero.clone(), v: zero, until: 10.0, tolerance: 1e-10, every: None, ..Scene::default() }
    }

    fn boxed_clone(&self) -> Box<dyn System> {
        Box::new(self.clone())
    }
}

fn pick(matrix: &DMatrix<f64>, pattern: &[(u32, u32)], values: &mut [f64]) {
    for ((row, column), value) in pattern.iter().zip(values) {
        *value = matrix[(*row as usize, *column as usize)];
    }
}

impl LinearMechanism {
    /// With a force on some coordinates that is any function of time.
    ///
    /// # Errors
    /// As [`LinearMechanism::with_input`].
    pub fn forced(
        self,
        column: &[f64],
        force: impl Fn(f64) -> f64 + Send + Sync + 'static,
    ) -> Result<Self, LinearError> {
        let name = format!("u[{}]", self.inputs.len() + 1);
        self.with_input(&name, column, Arc::new(move |t| [force(t), 0.0, 0.0]))
    }
}
