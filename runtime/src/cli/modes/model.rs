//! Linear models with and without constraints, as drives find them.

use nalgebra::Complex;

use super::super::load::Loaded;
use crate::linear::{Constrained, Drive, LinearError, Linearised, Motion, Observed, Source, Steady, observe};

/// A linear model that can be driven.
#[derive(Clone, Copy)]
pub enum Model<'a> {
    /// In all coordinates of the file.
    Free(&'a Linearised),
    /// With constraints, which leave fewer independent.
    Held(&'a Constrained),
}

impl Model<'_> {
    /// In independent coordinates.
    pub fn linear(&self) -> &Linearised {
        match self {
            Model::Free(linear) => linear,
            Model::Held(constrained) => &constrained.linear,
        }
    }

    /// Places and rates at the beginning of a motion, of the independent coordinates.
    pub fn departures(&self, motion: &Motion) -> [Vec<f64>; 2] {
        let all = &self.linear().equilibrium.coordinates;
        let places = self.linear().coordinates.iter().filter_map(|name| all.iter().position(|other| other == name));
        let places: Vec<usize> = places.collect();
        [&motion.x, &motion.v].map(|all| places.iter().map(|i| all[(0, *i)]).collect())
    }

    /// A motion of the independent coordinates as one of all.
    pub fn in_all_coordinates(&self, motion: Motion) -> Motion {
        match self {
            Model::Free(_) => motion,
            Model::Held(constrained) => {
                let all = constrained.motions.transpose();
                Motion { x: motion.x * &all, v: motion.v * &all }
            }
        }
    }

    /// As [`observe`].
    pub fn observe(&self, loaded: &Loaded, names: &[&str]) -> Result<Observed, LinearError> {
        match self {
            Model::Free(linear) => observe(&*loaded.system, linear, names),
            Model::Held(constrained) => constrained.observe(&*loaded.system, names),
        }
    }

    /// The steady state, in all coordinates of the file.
    pub fn steady(&self, drive: &Drive, omega: f64) -> Result<Steady, LinearError> {
        match self {
            Model::Free(linear) => linear.steady(drive, omega),
            Model::Held(constrained) => constrained.steady(drive, omega),
        }
    }

    /// Refuses an input that constraints do not let move.
    pub fn can_move(&self, name: &str) -> Result<(), LinearError> {
        let Model::Held(constrained) = self else { return Ok(()) };
        let found = constrained.immovable.iter().find(|(input, _)| input == name);
        found.map_or(Ok(()), |(_, why)| Err(why.clone()))
    }

    /// Whether a drive does anything.  Constraints can carry what moves nothing.
    pub fn depends_on(&self, loaded: &Loaded, drive: &Drive) -> Result<bool, LinearError> {
        if let Model::Held(constrained) = self {
            let description = loaded.system.description();
            let pushes = |k: usize| {
                let place = description.inputs.iter().position(|input| *input == constrained.linear.inputs[k]);
                description.input_pattern.iter().any(|entry| Some(entry.1 as usize / 3) == place)
            };
            let acts = |(source, amplitude): &(Source, Complex<f64>)| match source {
                Source::Force(_) => *amplitude != Complex::ZERO,
                Source::Input(k) => {
                    *amplitude != Complex::ZERO && (pushes(*k) || constrained.carried.column(*k).amax() > 0.0)
                }
            };
            return Ok(drive.parts.iter().any(acts));
        }
        [0.7, 1.9].iter().try_fold(false, |acts, omega| {
            let force = self.linear().driving_force(drive, *omega)?;
            Ok(acts || force.iter().any(|f| f.norm() > 0.0))
        })
    }
}
