//! A system that is nothing but a function for its accelerations.

use std::sync::Arc;

use crate::mechanism::{At, Coordinate, Description, Energy, Scene, Singular, Structure, System};

type Law = dyn Fn(At<'_>, &mut [f64]) -> Result<(), Singular> + Send + Sync;

/// q'' = a(t, q, q').
#[derive(Clone)]
pub(super) struct Explicit {
    law: Arc<Law>,
    description: Description,
}

impl Explicit {
    pub fn new(
        coordinates: Vec<Coordinate>,
        law: impl Fn(At<'_>, &mut [f64]) -> Result<(), Singular> + Send + Sync + 'static,
    ) -> Explicit {
        let description = Description {
            name: "Explicit".into(),
            coordinates: coordinates.into(),
            scenes: vec!["scene".into()].into(),
            structure: Structure { dimension: 2, time_dependent: true, ..Structure::default() },
            ..Description::default()
        };
        Explicit { law: Arc::new(law), description }
    }
}

impl System for Explicit {
    fn description(&self) -> &Description {
        &self.description
    }

    fn accelerations(&self, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        (self.law)(at, a)
    }

    fn mass_matrix(&self, _: At<'_>, _: &mut [f64]) {}

    fn bias(&self, at: At<'_>, h: &mut [f64]) {
        match self.accelerations(at, h) {
            Ok(()) => h.iter_mut().for_each(|h| *h = -*h),
            Err(_) => h.fill(f64::NAN),
        }
    }

    fn residual(&self, at: At<'_>, f: &mut [f64]) {
        self.bias(at, f);
        f.iter_mut().zip(at.a).for_each(|(f, a)| *f += a);
    }

    fn jacobians(&self, _: At<'_>, _: &mut [f64], _: &mut [f64]) {}

    fn energy(&self, _: At<'_>) -> Energy {
        Energy::from_array([0.0; 5])
    }

    fn scene(&self, _: usize) -> Scene {
        Scene::default()
    }

    fn boxed_clone(&self) -> Box<dyn System> {
        Box::new(self.clone())
    }
}
