//! A run that the caller moves on, for control loops.

use std::ops::ControlFlow;

use super::{Settings, Start, check_clocks, fail, finish, start};
use crate::cause::Cause;
use crate::constrain::Kinematics;
use crate::driver::{Integration, StopReason};
use crate::error::Error;
use crate::mechanism::{At, Signal, System};
use crate::run::{Occurrence, Recorder, Run, State, Work};
use crate::stopwatch::Stopwatch;

/// A run under way.  Between steps the state, the parameters and the inputs may be changed.
///
/// Events at the start and ticks there have happened when it begins: they read the inputs that the file or
/// [`Simulation::input`](crate::Simulation::input) gives.  The first step reports them.
///
/// A step costs the same however many there were, and keeps nothing: [`Stepping::finish`] returns the first state, the last two, the events of
/// the last step, and drift, work and warnings of the whole motion.  [`Stepping::recorded`] keeps one state a step, dense output and pictures.
/// After a change the drift of invariants and of the energy balance still counts from the start: what the caller does to the state is
/// seen there.  `max_steps` limits each step by itself.
///
/// An input of which places or speeds are made acts on the motion by impulses where it jumps or turns, once the motion has begun: momenta go on,
/// M Δq' = −F_u'' Δu' − F_u' Δu, as where a function of the file turns.  What would need an infinite force is refused: a body or a constraint that is
/// moved at once.  Clocks follow parameters: ticks are at the multiples of the new period from then on.
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
    /// What was before the state or the system was changed; `None` where nothing was.
    changed: Option<Unchanged>,
    /// An event that stopped the run where it starts, not yet told.
    stopped_at_start: Option<Occurrence>,
    clock: Stopwatch,
}

/// A run before it was changed by hand.
struct Unchanged {
    /// How the sides of contacts were placed and moved.
    contacts: Vec<Kinematics>,
    /// (u, u', u'') of each input.
    inputs: Vec<f64>,
    /// The kinetic energy, J.
    kinetic: f64,
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
        let Start { mut integration, mut recorder, outcome } = start(&mut system, &settings, f64::INFINITY)?;
        let stopped_at_start = match outcome.and_then(|()| integration.act_at_start(&mut system, &mut recorder)) {
            Ok(StopReason::Arrived | StopReason::Stiff) => None,
            Ok(StopReason::Event) => recorder.last_event(),
            Err(cause) => return Err(fail(*cause, &system, &integration, recorder, clock)),
        };
        let spacing = settings.every.or(settings.step).unwrap_or_else(|| settings.spacing());
        let (recorded, seen, horizon, changed) = (false, 0, settings.until, None);
        Ok(Stepping {
            system,
            integration,
            recorder,
            spacing,
            recorded,
            dense,
            seen,
            horizon,
            changed,
            stopped_at_start,
            clock,
        })
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
        if let Some(event) = self.stopped_at_start.take() {
            return Ok(Some(event));
        }
        let until = self.integration.time() + dt;
        if self.changed.is_some() {
            check_clocks(&self.system, until)?;
        }
        match self.go(until) {
            Ok(StopReason::Arrived | StopReason::Stiff) => Ok(None),
            Ok(StopReason::Event) => Ok(self.recorder.last_event()),
            Err(cause) => Err(self.failed(*cause)),
        }
    }

    fn failed(&self, cause: Cause) -> Error {
        fail(cause, &self.system, &self.integration, self.recorder.clone(), self.clock)
    }

    fn go(&mut self, until: f64) -> Result<StopReason, Box<Cause>> {
        if self.has_moved() {
            if !self.recorded {
                self.recorder.forget(self.integration.time());
            }
            self.seen = self.recorder.events().len();
        }
        self.integration.limit_anew();
        self.take_up_inputs()?;
        if self.changed.is_some() {
            self.recorder.changed(&self.system, self.integration.time(), self.integration.state());
        }
        if self.changed.is_some() || until > self.horizon {
            // Far enough not to begin anew with each step.
            self.horizon = self.horizon.max(until + 100.0 * self.spacing);
            match &self.changed {
                Some(before) => {
                    self.integration.changed_by_hand(&mut self.system, &before.contacts, &mut self.recorder)?;
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
    /// [`Error::UnknownName`]; [`Error::BadSetting`] for what is no number; [`Error::Run`] where it would move a body or a constraint at once: give it
    /// a function by [`Stepping::set_input_signal`].
    pub fn set_input(&mut self, name: &str, value: f64) -> Result<(), Error> {
        let index = self.input(name)?;
        if !value.is_finite() {
            return Err(Error::BadSetting { setting: "input", value, expected: "a number" });
        }
        self.system_mut().hold_input(index, value);
        self.take_up_inputs().map_err(|cause| self.failed(*cause))
    }

    /// Gives an input another function of time, (u, u', u'') in SI, from now on; the integration begins anew.
    ///
    /// # Errors
    /// As [`Stepping::set_input`].
    pub fn set_input_signal(&mut self, name: &str, signal: Signal) -> Result<(), Error> {
        let index = self.input(name)?;
        self.system_mut().set_input(index, signal);
        self.take_up_inputs().map_err(|cause| self.failed(*cause))
    }

    fn input(&self, name: &str) -> Result<usize, Error> {
        let inputs = &self.system.description().inputs;
        inputs.iter().position(|input| input == name).ok_or_else(|| Error::unknown("input", name, inputs.iter()))
    }

    /// Whether the motion has begun; what is changed before is the start.
    fn has_moved(&self) -> bool {
        self.integration.work().steps > 0
    }

    /// Lets what changed of inputs act on the speeds.
    fn take_up_inputs(&mut self) -> Result<(), Box<Cause>> {
        let (moved, t) = (self.has_moved(), self.integration.time());
        let Some(before) = &mut self.changed else { return Ok(()) };
        let mut now = vec![0.0; before.inputs.len()];
        self.system.inputs(t, &mut now);
        if now == before.inputs {
            return Ok(());
        }
        if moved {
            let inputs = (before.inputs.as_slice(), now.as_slice());
            self.integration.inputs_changed(&mut self.system, inputs, before.kinetic, &mut self.recorder)?;
        }
        before.inputs = now;
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
        self.changed.get_or_insert_with(|| {
            let (t, y) = (self.integration.time(), self.integration.state().y);
            let mut inputs = vec![0.0; 3 * self.system.description().inputs.len()];
            self.system.inputs(t, &mut inputs);
            let kinetic = self.system.energy(At::packed(t, y, self.system.len())).kinetic;
            Unchanged { contacts: self.integration.kinematics(&self.system), inputs, kinetic }
        });
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
