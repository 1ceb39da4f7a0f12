//! The period of what depends on time.

use std::f64::consts::TAU;

use super::closing::{By, Closing};
use super::guess::states_of;
use super::laps::lcm;
use crate::error::{Error, NoOrbit};
use crate::mechanism::System;
use crate::run::Run;

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
    /// So many times that of the frequencies with which time enters the equations, or a part of it.
    Frequencies(f64),
}

impl Drive {
    /// With a period that is given, or with none.
    ///
    /// # Errors
    /// No period where frequencies are not known or have none in common.
    pub fn of(system: &dyn System, given: Option<f64>) -> Result<Drive, Error> {
        match (given, common(system)) {
            (Some(given), Ok(period)) => Ok(Drive::Frequencies(given / period)),
            (Some(given), Err(_)) => Ok(Drive::Given(given)),
            (None, period) => period.map(|_| Drive::Frequencies(1.0)),
        }
    }

    /// The period with the present parameters, s.
    ///
    /// # Errors
    /// Frequencies that are not known, or have no common period.
    pub fn period(self, system: &dyn System) -> Result<f64, Error> {
        match self {
            Drive::None => Ok(0.0),
            Drive::Given(period) => Ok(period),
            Drive::Frequencies(times) => Ok(times * common(system)?),
        }
    }

    /// How the period changes with a parameter, s by its unit.
    ///
    /// # Errors
    /// As [`Drive::period`].
    pub fn slope(self, system: &dyn System, parameter: usize) -> Result<f64, Error> {
        let Drive::Frequencies(_) = self else { return Ok(0.0) };
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

/// Refuses a time after which what depends on time, in forces, constraints and events, is not what it was near a run.
///
/// # Errors
/// [`NoOrbit::NotThePeriod`]; where an event ends laps, [`NoOrbit::NotAPeriodLater`].
pub(super) fn repeats(system: &dyn System, by: By, run: &Run, later: f64) -> Result<(), Error> {
    let (plain, states) = (Closing::period(system.description()), states_of(run));
    if plain.differs(system, &states, later).is_none() && plain.event_differs(system, &states, later).is_none() {
        return Ok(());
    }
    let By::After { event, .. } = by else { return Err(NoOrbit::NotThePeriod { period: later }.into()) };
    Err(NoOrbit::NotAPeriodLater { event: system.description().events[event].name.to_string(), later }.into())
}

/// The shortest time after which all frequencies have gone through whole turns, s.
fn common(system: &dyn System) -> Result<f64, Error> {
    let list = frequencies(system)?;
    let mut times = 1;
    for other in &list[1..] {
        let within = |count: &u32| {
            let turns = f64::from(*count) * other / list[0];
            (turns - turns.round()).abs() <= EXACT * turns && turns.round() >= 1.0
        };
        let Some(count) = (1..=LARGEST).find(within) else {
            return Err(NoOrbit::Incommensurate { frequencies: [list[0], *other] }.into());
        };
        times = lcm(times, count as usize);
    }
    Ok(times as f64 * TAU / list[0])
}

/// The frequencies with which time enters the equations, rad/s, without those that are 0.
fn frequencies(system: &dyn System) -> Result<Vec<f64>, Error> {
    let known = system.frequencies().ok_or(NoOrbit::NotPeriodic)?;
    let list: Vec<f64> = known.into_iter().map(f64::abs).filter(|frequency| *frequency > 0.0).collect();
    if list.is_empty() { Err(NoOrbit::NotPeriodic.into()) } else { Ok(list) }
}
