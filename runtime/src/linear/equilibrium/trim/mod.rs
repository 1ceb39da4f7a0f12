//! Trim: a rest with some coordinates held where they are said to be, and inputs, parameters or held values found that make it one.
//!
//! With some of the coordinates q held, and s the values that are sought, the unknowns are the coordinates x that are free, states of
//! first order z, multipliers λ and s, all in one search by Newton's method with least steps:
//!
//! F(q, z, λ; s) = 0, c(q; s) = 0.
//!
//! Its slopes are exact, those by s too.  The search begins with the values that the system has; of several solutions it finds the one
//! that least steps from there lead to.  Where it ends, the singular values of the slopes, rows and columns brought to one size, tell
//! what is not determined: directions in which nothing changes to first order.
//!
//! Source: Stevens, Lewis and Johnson, Aircraft Control and Simulation, 2016, 3.6 (steady-state trim), by equations in place of a cost.

mod judge;
mod search;

use search::Search;

use super::Guess;
use super::least_steps::Rest;
use crate::linear::LinearError;
use crate::mechanism::System;

/// Something whose value is sought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// An input, by its index; the search begins with the value at which the guess holds it.
    Input(usize),
    /// A free parameter, by its index; the search begins with its present value.
    Parameter(usize),
    /// A held value (`memory`), by its index; the search begins with its present value.
    Memory(usize),
}

impl Unknown {
    /// Gives a system a value of it.
    pub(crate) fn give<S: System + ?Sized>(self, system: &mut S, value: f64) {
        match self {
            Unknown::Input(index) => system.hold_input(index, value),
            Unknown::Parameter(index) => system.set_parameter(index, value),
            Unknown::Memory(index) => {
                let mut memory = system.memory().to_vec();
                memory[index] = value;
                system.set_memory(&memory);
            }
        }
    }
}

/// A value that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct TrimmedValue {
    /// What has it.
    pub unknown: Unknown,
    /// Its name.
    pub name: String,
    /// Where the search began, SI.
    pub from: f64,
    /// SI.
    pub value: f64,
    /// What rounding of forces and constraints makes of it, SI.
    pub uncertainty: f64,
}

/// A rest with coordinates held, and what makes it one.
#[derive(Clone, Debug, PartialEq)]
pub struct Trimmed {
    /// The state, and the values at which inputs are held: those that were found, too.
    pub guess: Guess,
    /// What was found, in the order in which it was asked for.
    pub found: Vec<TrimmedValue>,
    /// Steps of Newton's method.
    pub iterations: usize,
    /// What is left of each equation, of its terms: the largest.
    pub residual: f64,
}

impl Trimmed {
    /// Gives a system the parameters and held values that were found; inputs are those of the guess.
    pub fn apply<S: System + ?Sized>(&self, system: &mut S) {
        self.found.iter().for_each(|found| found.unknown.give(system, found.value));
    }
}

/// Finds values of inputs, free parameters and held values (`unknowns`) with which a mechanism rests with some coordinates (`held`, by
/// index; those of states of first order hold the state) where the guess has them; all others follow.  With constraints too.  Speeds of
/// the guess stay as they are.
///
/// ```
/// use dalembert::linear::{Guess, Unknown, equilibrium_here, linearise, trim};
/// use dalembert::mechanism::Dynamic;
/// # mod example {
/// dalembert::model!(yaml = r#"
/// name: Arm
/// parameters: {m: 2 kg, l: 0.5 m, g: 10 m/s^2}
/// coordinates: {theta: rad}
/// inputs: {T: 0 N*m}
/// kinetic_energy: m*(l*theta')^2/2
/// potential_energy: m*g*l*sin(theta)
/// generalized_forces: {theta: T}
/// "#);
/// # }
/// # use example::Arm;
/// let arm = Dynamic::new(Arm::default());
/// let trimmed = trim(&arm, &Guess::at(&[0.3]), &[0], &[Unknown::Input(0)])?;
/// // The motor carries the weight, m g l cos θ, and the weight's stiffness is −m g l sin θ.
/// assert!((trimmed.found[0].value - 10.0 * 0.3_f64.cos()).abs() < 1e-14);
/// let linear = linearise(&arm, &equilibrium_here(&arm, &trimmed.guess)?)?;
/// assert!((linear.k()[(0, 0)] + 10.0 * 0.3_f64.sin()).abs() < 1e-14);
/// # Ok::<(), dalembert::linear::LinearError>(())
/// ```
///
/// # Errors
/// [`LinearError::CannotHold`] where no values were found with which it rests so; [`LinearError::Undetermined`] with the unknowns that
/// cannot be told apart, or change nothing; [`LinearError::DependsOnTime`]; [`LinearError::NoEquilibrium`]; indices that do not exist;
/// numbers that are not finite.
pub fn trim<S: System + ?Sized>(
    system: &S,
    guess: &Guess,
    held: &[usize],
    unknowns: &[Unknown],
) -> Result<Trimmed, LinearError> {
    trim_steady(system, guess, (held, unknowns), (0, &[]))
}

/// As [`trim`]; speeds of these coordinates (`speeds`, by index) are those of the start of a scene, by its place, with the parameters
/// that are found.
///
/// # Errors
/// As [`trim`].
pub fn trim_steady<S: System + ?Sized>(
    system: &S,
    guess: &Guess,
    (held, unknowns): (&[usize], &[Unknown]),
    (scene, speeds): (usize, &[usize]),
) -> Result<Trimmed, LinearError> {
    let mut search = Search::new(system, guess, (held, unknowns), (scene, speeds))?;
    search.base.check_time(&search.q)?;
    search.multipliers_from_forces();
    if let Some(i) = search.left().iter().position(|x| !x.is_finite()) {
        return Err(LinearError::NonFinite { what: search.equation(i) });
    }
    search.slopes_are_known()?;
    let from = search.values.clone();
    let iterations = search.newton().map_err(|iterations| search.nowhere(iterations))?;
    search.diagnosed(iterations)?;
    let uncertainties = search.known_uncertainties(&from)?;
    Ok(search.trimmed((&from, &uncertainties), iterations))
}
