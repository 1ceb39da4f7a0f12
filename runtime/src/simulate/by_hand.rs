//! A run that the caller moves on, for control loops.

use std::ops::ControlFlow;

use super::{Settings, Start, fail, finish, start};
use crate::cause::Cause;
use crate::constrain::Kinematics;
use crate::driver::{Integration, StopReason};
use crate::error::Error;
use crate::mechanism::System;
use crate::run::{Occurrence, Recorder, Run, State, Work};
use crate::stopwatch::Stopwatch;

/// A run under way.  Between steps the state, the parameters and the inputs may be changed.
///
/// A step costs the same however many there were, and keeps nothing: [`Stepping::finish`] returns the first state, the last two, the events of
/// the last step, and drift, work and warnings of the whole motion.  [`Stepping::recorded`] keeps one state a step, dense output and pictures.
/// After a change the drift of invariants and of the energy balance still counts from the start: what the caller does to the state is
/// seen there.  `max_steps` limits each step by itself.
///
/// ```
#[doc = include_str!("../../examples/control_loop.rs")]
/// ```
pub struct Stepping<S: System> {
    system: S,
    integration: Integration,
    recorder: Recorder,
    spacing: f64,
    /// Whether all states are kept, and how many events were when the last step began.
    recorded: bool,
    dense: bool,
    seen: usize,
    /// Until when the integration has been begun.
    horizon: f64,
    /// How the sides of contacts were placed and moved before the state or the system was changed; `None` where nothing was.
    changed: Option<Vec<Kinematics>>,
    clock: Stopwatch,
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
        let clock = Stopwatch::start();
        let dense = settings.dense;
        let settings = Settings { dense: false, ..settings };
        let Start { integration, recorder, outcome } = start(&mut system, &settings, f64::INFINITY)?;
        if let Err(cause) = outcome {
            return Err(fail(*cause, &system, &integration, recorder, clock));
        }
        let spacing = settings.every.or(settings.step).unwrap_or_else(|| settings.spacing());
        let (recorded, seen, horizon, changed) = (false, 0, settings.until, None);
        Ok(Stepping { system, integration, recorder, spacing, recorded, dense, seen, horizon, changed, clock })
    }

    /// Keeps a state of every step from here on, with its events, and dense output and pictures unless the settings say otherwise:
    /// memory then grows with every step.
    #[must_use]
    pub fn recorded(mut self) -> Self {
        self.recorded = true;
        if self.dense {
            self.recorder.keep_dense(&self.system, self.integration.time(), self.integration.state());
        }
        self
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
        let until = self.integration.time() + dt;
        match self.go(until) {
            Ok(StopReason::Arrived) => Ok(None),
            Ok(StopReason::Event) => Ok(self.recorder.last_event()),
            Err(cause) => Err(fail(*cause, &self.system, &self.integration, self.recorder.clone(), self.clock)),
        }
    }

    fn go(&mut self, until: f64) -> Result<StopReason, Box<Cause>> {
        if !self.recorded {
            self.recorder.forget();
        }
        self.seen = self.recorder.events().len();
        self.integration.limit_anew();
        if self.changed.is_some() {
            self.recorder.changed(&self.system, self.integration.time(), self.integration.state());
        }
        if self.changed.is_some() || until > self.horizon {
            // Far enough not to begin anew with each step.
            self.horizon = self.horizon.max(until + 100.0 * self.spacing);
            match &self.changed {
                Some(before) => {
                    self.integration.changed_by_hand(&mut self.system, before, &mut self.recorder)?;
                    self.integration.go_on(&mut self.system, self.horizon)?;
                }
                None => self.integration.prolong(&mut self.system, self.horizon)?,
            }
            self.recorder.begin_piece(&self.system, self.integration.time(), self.integration.state());
            self.changed = None;
        }
        let halt = self
            .integration
            .advance(&mut self.system, until, &mut self.recorder, &mut |_| ControlFlow::Continue(()))?;
        self.recorder.report(&self.system, self.integration.time(), self.integration.state().y);
        Ok(halt)
    }

    /// The time, s.
    pub fn time(&self) -> f64 {
        self.integration.time()
    }

    /// The present state with its outputs.
    pub fn state(&mut self) -> State {
        self.recorder.state_with_outputs(&self.system, self.integration.time(), self.integration.state().y)
    }

    /// Events of the last step, those included that stop nothing.
    pub fn events(&self) -> &[Occurrence] {
        &self.recorder.events()[self.seen..]
    }

    /// Holds an input at a value, SI, from now on, in place of its function of time; the integration begins anew.
    ///
    /// # Errors
    /// [`Error::UnknownName`]; [`Error::BadSetting`] for what is no number.
    pub fn set_input(&mut self, name: &str, value: f64) -> Result<(), Error> {
        let inputs = &self.system.description().inputs;
        let Some(index) = inputs.iter().position(|input| input == name) else {
            return Err(Error::unknown("input", name, inputs.iter()));
        };
        if !value.is_finite() {
            return Err(Error::BadSetting { setting: "input", value, expected: "a number" });
        }
        self.system_mut().hold_input(index, value);
        Ok(())
    }

    /// A held value, SI, by its name in the file; `None` if nothing of this name is held.
    pub fn memory(&self, name: &str) -> Option<f64> {
        self.system.memory().get(self.system.sampling().place_of(name)?).copied()
    }

    /// Holds another value, SI, from now on; the integration begins anew.
    ///
    /// # Errors
    /// [`Error::UnknownName`]; [`Error::BadSetting`] for what is no number.
    pub fn set_memory(&mut self, name: &str, value: f64) -> Result<(), Error> {
        let sampling = self.system.sampling();
        let Some(place) = sampling.place_of(name) else {
            return Err(Error::unknown("held value", name, sampling.memory.iter().map(|held| &held.name)));
        };
        if !value.is_finite() {
            return Err(Error::BadSetting { setting: "memory", value, expected: "a number" });
        }
        let mut memory = self.system.memory().to_vec();
        memory[place] = value;
        self.system_mut().set_memory(&memory);
        Ok(())
    }

    /// The present state, to be changed; the integration begins anew from there.
    pub fn state_mut(&mut self) -> StateMut<'_> {
        self.note_change();
        let n = self.system.len();
        let (q, rest) = self.integration.state_mut().split_at_mut(n);
        StateMut { q, v: &mut rest[..n] }
    }

    fn note_change(&mut self) {
        self.changed.get_or_insert_with(|| self.integration.kinematics(&self.system));
    }

    /// Work done until now.
    pub fn work(&self) -> Work {
        self.integration.work()
    }

    /// The mechanism.
    pub fn system(&self) -> &S {
        &self.system
    }

    /// The mechanism, to have its parameters or inputs changed; the integration begins anew.
    pub fn system_mut(&mut self) -> &mut S {
        self.note_change();
        self.recorder.draw(&self.system);
        &mut self.system
    }

    /// What was computed until now.
    pub fn finish(self) -> Run {
        finish(&self.system, &self.integration, self.recorder, self.clock)
    }
}
