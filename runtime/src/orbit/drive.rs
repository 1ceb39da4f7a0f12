//! The period of what depends on time.

use std::f64::consts::TAU;

use crate::error::{Error, NoOrbit};
use crate::mechanism::System;

/// Frequencies have a common period where their ratio is one of numbers up to this one.
const LARGEST: u32 = 200;
/// The ratio of frequencies is one of small numbers where it is so up to this part.
const EXACT: f64 = 1e-9;
/// By what part a parameter is moved to see how a frequency changes with it.
const MOVE: f64 = 1e-5;

/// How the period of what depends on time is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drive {
    /// Nothing depends on time.
    None,
    /// It is given, s.
    Given(f64),
    /// By the frequencies with which time enters the equations.
    Frequencies,
}

impl Drive {
    /// The period with the present parameters, s.
    ///
    /// # Errors
    /// Frequencies that are not known, or have no common period.
    pub fn period(self, system: &dyn System) -> Result<f64, Error> {
        match self {
            Drive::None => Ok(0.0),
            Drive::Given(period) => Ok(period),
            Drive::Frequencies => {
                let list = frequencies(system)?;
                let Some(first) = list.first() else { return Err(NoOrbit::NotPeriodic.into()) };
                let mut times = 1;
                for other in &list[1..] {
                    let within = |times: u32| {
                        let turns = f64::from(times) * other / first;
                        (turns - turns.round()).abs() <= EXACT * turns && turns.round() >= 1.0
                    };
                    let Some(count) = (1..=LARGEST).find(|count| within(*count)) else {
                        return Err(NoOrbit::Incommensurate { frequencies: [*first, *other] }.into());
                    };
                    times = super::laps::lcm(times as usize, count as usize) as u32;
                }
                Ok(f64::from(times) * TAU / first)
            }
        }
    }

    /// How the period changes with a parameter, s by its unit.
    ///
    /// # Errors
    /// As [`Drive::period`].
    pub fn slope(self, system: &dyn System, parameter: usize) -> Result<f64, Error> {
        if self != Drive::Frequencies {
            return Ok(0.0);
        }
        let period = self.period(system)?;
        let value = system.parameters().get(parameter).copied().unwrap_or(0.0);
        let step = MOVE * if value == 0.0 { 1.0 } else { value.abs() };
        let at = |value: f64| -> Result<f64, Error> {
            let mut moved = system.boxed_clone();
            moved.set_parameter(parameter, value);
            Ok(frequencies(&*moved)?[0])
        };
        let (low, high) = (at(value - step)?, at(value + step)?);
        Ok(-period * 2.0 * (high - low) / (high + low) / (2.0 * step))
    }
}

/// The frequencies with which time enters the equations, rad/s, without those that are 0.
fn frequencies(system: &dyn System) -> Result<Vec<f64>, Error> {
    let known = system.frequencies().ok_or(NoOrbit::NotPeriodic)?;
    let list: Vec<f64> = known.into_iter().map(f64::abs).filter(|frequency| *frequency > 0.0).collect();
    if list.is_empty() { Err(NoOrbit::NotPeriodic.into()) } else { Ok(list) }
}
