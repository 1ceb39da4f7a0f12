//! Whether small motions use integrals by rules of quadrature where these were tried.

use super::locus::Locus;
use crate::linear::Equilibrium;
use crate::mechanism::{System, Tried};
use crate::run::integrals::untried_integrals;

/// What is wrong with integrals at a state, and along the states that follow from it while something is varied.
pub fn notes(system: &dyn System, at: &Equilibrium, locus: Option<&Locus>) -> Vec<String> {
    let description = system.description();
    let values = |of: Tried| -> Vec<f64> {
        let along = |name: &str| locus.into_iter().flat_map(|locus| locus.values_of(name)).collect::<Vec<f64>>();
        let with = |here: Option<f64>, name: &str| here.into_iter().chain(along(name)).collect();
        match of {
            Tried::Parameter(k) => {
                let here = system.parameters().get(k as usize).copied();
                description.parameters.get(k as usize).map_or_else(Vec::new, |known| with(here, &known.name))
            }
            Tried::Coordinate(k) => {
                let here = at.q.get(k as usize).copied();
                at.coordinates.get(k as usize).map_or_else(Vec::new, |name| with(here, name))
            }
            Tried::Speed(k) => {
                let here = at.v.get(k as usize).copied();
                at.coordinates.get(k as usize).map_or_else(Vec::new, |name| with(here, &format!("{name}'")))
            }
            Tried::Time => Vec::new(),
        }
    };
    untried_integrals(system, values).iter().map(ToString::to_string).collect()
}
