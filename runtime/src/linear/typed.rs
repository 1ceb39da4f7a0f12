//! Small motions of every mechanism that `model!` makes.

use super::{Equilibrium, Guess, LinearError, Linearised, equilibrium_here, equilibrium_near, linearise};
use crate::mechanism::{Dynamic, Mechanism};

/// Equilibria and linearisation of a mechanism with N coordinates.
pub trait Linearise<const N: usize, const C: usize>: Mechanism<N, C> + 'static {
    /// The equilibrium that Newton's method finds from here, at rest.
    ///
    /// # Errors
    /// As [`equilibrium_near`].
    fn equilibrium_near(&self, q: &[f64; N]) -> Result<Equilibrium, LinearError> {
        equilibrium_near(&Dynamic::new(self.clone()), &Guess::at(q))
    }

    /// This point, if it is an equilibrium.
    ///
    /// # Errors
    /// [`LinearError::NotAnEquilibrium`] with the residual force of every coordinate.
    fn equilibrium_here(&self, q: &[f64; N]) -> Result<Equilibrium, LinearError> {
        equilibrium_here(&Dynamic::new(self.clone()), &Guess::at(q))
    }

    /// M, C, K and B at an equilibrium.
    ///
    /// # Errors
    /// As [`linearise`].
    fn linearise(&self, equilibrium: &Equilibrium) -> Result<Linearised, LinearError> {
        linearise(&Dynamic::new(self.clone()), equilibrium)
    }
}

impl<M: Mechanism<N, C> + 'static, const N: usize, const C: usize> Linearise<N, C> for M {}
