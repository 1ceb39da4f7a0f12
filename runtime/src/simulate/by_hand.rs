//! A run that the caller moves on, for control loops.

use std::ops::ControlFlow;
use std::time::Instant;

use super::{Settings, Start, fail, finish, start};
use crate::cause::Cause;
use crate::error::Error;
use crate::march::{Halt, March};
use crate::mechanism::System;
use crate::run::{Occurrence, Recorder, Run, State};

/// A run under way.  Between steps the state, the parameters and the inputs may be changed.
///
/// Every step reports one state of the run.  After a change the drift of invariants and of the energy balance
/// still counts from the start: what the caller does to the state is seen there.
pub struct Stepping<S: System> {
    system: S,
    march: March,
    recorder: Recorder,
    spacing: f64,
    /// Until when the march has been begun.
    horizon: f64,
    /// True when the state or the system was changed.
    changed: bool,
    clock: Instant,
}

/// The state of a run under way, to be changed.
#[derive(Debug)]
pub struct StateMut<'a> {
    /// Generalized coordinates, SI.
    pub q: &'a mut [f64],
    /// Their rates, SI.
    pub v: &'a mut [f64],
}

impl<S: System> Stepping<S> {
    /// Begins a run.  A step is `every`, or the fixed step, or a 500th of the run.
    ///
    /// # Errors
    /// A setting without meaning, or [`Error::Run`] where no motion can begin.
    pub fn new(mut system: S, settings: Settings) -> Result<Self, Error> {
        let clock = Instant::now();
        let Start { march, recorder, outcome } = start(&mut system, &settings, f64::INFINITY)?;
        if let Err(cause) = outcome {
            return Err(fail(*cause, &system, &march, recorder, clock));
        }
        let spacing = settings.every.or(settings.step).unwrap_or_else(|| settings.spacing());
        Ok(Stepping { system, march, recorder, spacing, horizon: settings.until, changed: false, clock })
    }

    /// Goes on by one step, or to an event that stops, which is returned.
    ///
    /// # Errors
    /// [`Error::Run`], after which the run stays where it was.
    pub fn step(&mut self) -> Result<Option<Occurrence>, Error> {
        self.advance(self.spacing)
    }

    /// Goes on by `dt` seconds, or to an event that stops, which is returned.
    ///
    /// # Errors
    /// [`Error::BadSetting`] unless `dt` is positive; [`Error::Run`], after which the run stays where it was.
    pub fn advance(&mut self, dt: f64) -> Result<Option<Occurrence>, Error> {
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(Error::BadSetting { setting: "dt", value: dt, expected: "a positive time" });
        }
        let until = self.march.time() + dt;
        match self.go(until) {
            Ok(Halt::Arrived) => Ok(None),
            Ok(Halt::Event) => Ok(self.recorder.last_event()),
            Err(cause) => Err(fail(*cause, &self.system, &self.march, self.recorder.clone(), self.clock)),
        }
    }

    fn go(&mut self, until: f64) -> Result<Halt, Box<Cause>> {
        if self.changed {
            self.recorder.changed(&self.system, self.march.time(), self.march.state());
        }
        if self.changed || until > self.horizon {
            // Far enough not to begin anew with each step.
            self.horizon = self.horizon.max(until + 100.0 * self.spacing);
            self.march.begin(&mut self.system, self.horizon)?;
            self.recorder.begin_piece(&self.system, self.march.time(), self.march.state());
            self.changed = false;
        }
        let halt =
            self.march.advance(&mut self.system, until, &mut self.recorder, &mut |_| ControlFlow::Continue(()))?;
        self.recorder.report(&self.system, self.march.time(), self.march.state().y);
        Ok(halt)
    }

    /// The time, s.
    pub fn time(&self) -> f64 {
        self.march.time()
    }

    /// The present state with its outputs.
    pub fn state(&mut self) -> State {
        self.recorder.state_with_outputs(&self.system, self.march.time(), self.march.state().y)
    }

    /// The present state, to be changed; the integration begins anew from there.
    pub fn state_mut(&mut self) -> StateMut<'_> {
        self.changed = true;
        let n = self.system.len();
        let (q, rest) = self.march.state_mut().split_at_mut(n);
        StateMut { q, v: &mut rest[..n] }
    }

    /// The mechanism.
    pub fn system(&self) -> &S {
        &self.system
    }

    /// The mechanism, to have its parameters or inputs changed; the integration begins anew.
    pub fn system_mut(&mut self) -> &mut S {
        self.changed = true;
        self.recorder.draw(&self.system);
        &mut self.system
    }

    /// What was computed until now.
    pub fn finish(self) -> Run {
        finish(&self.system, &self.march, self.recorder, self.clock)
    }
}
