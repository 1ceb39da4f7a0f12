//! What can go wrong with small motions.

use std::fmt;

/// Why there is no equilibrium, no linearisation or no mode.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LinearError {
    /// The point is no equilibrium: forces are left.
    NotAnEquilibrium {
        /// (coordinate, residual generalized force F(q, q', 0), SI) of every coordinate.
        residual: Vec<(String, f64)>,
    },
    /// Newton's method found no equilibrium.
    NoEquilibrium {
        /// Iterations made.
        iterations: usize,
        /// (coordinate, value) where it stood at the end.
        point: Vec<(String, f64)>,
        /// (coordinate, residual generalized force there).
        residual: Vec<(String, f64)>,
    },
    /// A speed was asked for in a coordinate whose value matters: the state cannot persist.
    NotSteady {
        /// The coordinate.
        coordinate: String,
    },
    /// The equations change with time, beyond the inputs.
    DependsOnTime {
        /// A coordinate whose equation changes.
        coordinate: String,
    },
    /// M is not positive definite.
    SingularMass {
        /// The coordinate whose pivot is not positive.
        coordinate: String,
    },
    /// A list or matrix has the wrong size.
    WrongSize {
        /// Which one.
        what: &'static str,
        /// Its size.
        given: usize,
        /// What it must be.
        expected: usize,
    },
    /// A number is infinite or not a number.
    NonFinite {
        /// Of what.
        what: String,
    },
    /// A matrix that must be symmetric is not.
    NotSymmetric {
        /// Which one: `M`.
        what: &'static str,
    },
    /// An iteration of linear algebra did not end.
    NoConvergence {
        /// Which one.
        what: &'static str,
    },
    /// The frequency response is infinite here.
    Resonance {
        /// The forcing frequency Ω, rad/s.
        omega: f64,
    },
    /// The crate was built without what this needs.
    NeedsFeature {
        /// The feature of the crate.
        feature: &'static str,
    },
}

impl fmt::Display for LinearError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LinearError::NotAnEquilibrium { residual } => {
                write!(f, "no equilibrium: the residual force is {}", Pairs(residual))
            }
            LinearError::NoEquilibrium { iterations, point, residual } => write!(
                f,
                "no equilibrium found in {iterations} iterations: at {} the residual force is {}",
                Pairs(point),
                Pairs(residual)
            ),
            LinearError::NotSteady { coordinate } => write!(
                f,
                "not a steady motion: `{coordinate}` has a speed, but the equations depend on its value; only cyclic \
                 coordinates can turn or travel steadily"
            ),
            LinearError::DependsOnTime { coordinate } => write!(
                f,
                "the equation of `{coordinate}` depends on time, so it has no equilibrium; make what varies an input"
            ),
            LinearError::SingularMass { coordinate } => {
                write!(f, "the mass matrix is not positive definite: nothing gives `{coordinate}` an inertia here")
            }
            LinearError::WrongSize { what, given, expected } => {
                write!(f, "{what} has size {given}; expected {expected}")
            }
            LinearError::NonFinite { what } => write!(f, "{what} is not finite"),
            LinearError::NotSymmetric { what } => write!(f, "{what} is not symmetric"),
            LinearError::NoConvergence { what } => write!(f, "{what} does not converge"),
            LinearError::Resonance { omega } => {
                write!(f, "no steady state: the force at {omega} rad/s meets an undamped mode, which grows with time")
            }
            LinearError::NeedsFeature { feature } => {
                write!(f, "damped and gyroscopic modes need the feature `{feature}` of the crate `dalembert`")
            }
        }
    }
}

impl std::error::Error for LinearError {}

struct Pairs<'a>(&'a [(String, f64)]);

impl fmt::Display for Pairs<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, value)) in self.0.iter().enumerate() {
            write!(f, "{}{name}: {value}", if index == 0 { "" } else { ", " })?;
        }
        Ok(())
    }
}
