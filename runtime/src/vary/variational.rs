//! The equations of motion together with their variational equations.

use std::sync::{Mutex, PoisonError};

use super::response::Response;
use crate::mechanism::{Along, At, Coordinate, Description, Energy, List, Scene, Singular, Structure, System};

/// A mechanism with columns δq, which change its motion to first order: q'' = a(t, q, q', p), and for each column
/// δq'' = ∂a/∂q δq + ∂a/∂q' δq' + ∂a/∂p δp.  One factorisation and one pair of Jacobians do for all columns at a state.
///
/// Coordinates are q, then one column after the other.  It has no events, switches and constraints of its own: the equations are those of
/// one smooth piece of the motion, constraints included.
///
/// Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I (1993), section I.14, theorems 14.1 and 14.3.
pub(super) struct Variational {
    base: Box<dyn System>,
    description: Description,
    /// The parameter that changes in each column; `None`: only the start does.
    columns: Vec<Option<usize>>,
    room: Mutex<Response>,
}

impl Variational {
    pub fn new(base: &dyn System, columns: &[Option<usize>]) -> Variational {
        let known = base.description();
        let copies = columns.len() + 1;
        let coordinates: Vec<Coordinate> = (0..copies).flat_map(|_| known.coordinates.iter().cloned()).collect();
        let description = Description {
            name: known.name.clone(),
            coordinates: List::Owned(coordinates),
            structure: Structure { conservative: true, ..Structure::default() },
            ..Description::default()
        };
        Variational { base: base.boxed_clone(), description, columns: columns.to_vec(), room: Mutex::default() }
    }

    /// The mechanism, to have modes and phases set.
    pub fn base_mut(&mut self) -> &mut dyn System {
        &mut *self.base
    }

    /// Brings a state [q, δq …, q', δq' …] back to the constraints in force, c = 0 and c' = 0 with their slopes.
    ///
    /// # Errors
    /// Those of the accelerations there.
    pub fn project(&self, t: f64, y: &mut [f64]) -> Result<(), Singular> {
        super::constraints::project(&*self.base, &self.columns, &mut Response::default(), t, y)
    }

    /// Whether constraints are in force.
    pub fn is_constrained(&self) -> bool {
        !self.base.active_rows().is_empty()
    }
}

impl System for Variational {
    fn description(&self) -> &Description {
        &self.description
    }

    fn accelerations(&self, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        let n = self.base.len();
        let mut room = self.room.lock().unwrap_or_else(PoisonError::into_inner);
        let here = At::new(at.t, &at.q[..n], &at.v[..n]);
        room.stand(&*self.base, here)?;
        room.take_jacobians(&*self.base, here);
        a[..n].copy_from_slice(&room.a);
        for (k, parameter) in self.columns.iter().enumerate() {
            let column = n * (k + 1)..n * (k + 2);
            let along =
                Along { q: &at.q[column.clone()], v: &at.v[column.clone()], parameter: *parameter, ..Along::default() };
            room.column(&*self.base, here, &along)?;
            a[column].copy_from_slice(&room.da);
        }
        Ok(())
    }

    fn mass_matrix(&self, _: At<'_>, _: &mut [f64]) {}

    fn bias(&self, at: At<'_>, h: &mut [f64]) {
        if self.accelerations(at, h).is_err() {
            h.fill(f64::NAN);
        }
        h.iter_mut().for_each(|h| *h = -*h);
    }

    fn residual(&self, at: At<'_>, f: &mut [f64]) {
        self.bias(at, f);
        f.iter_mut().zip(at.a).for_each(|(f, a)| *f += a);
    }

    fn jacobians(&self, _: At<'_>, _: &mut [f64], _: &mut [f64]) {}

    fn energy(&self, _: At<'_>) -> Energy {
        Energy::default()
    }

    fn scene(&self, _: usize) -> Scene {
        Scene::default()
    }

    fn boxed_clone(&self) -> Box<dyn System> {
        Box::new(Variational {
            base: self.base.boxed_clone(),
            description: self.description.clone(),
            columns: self.columns.clone(),
            room: Mutex::default(),
        })
    }
}
