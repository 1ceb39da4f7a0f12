//! What events do at one instant, and what follows from it there: phases, contacts, speeds and values, until nothing more happens.

use super::phase::Done;
use super::set::Assigned;
use super::{Integration, StopReason};
use crate::cause::Cause;
use crate::events::{EventLocator, Fired, RESTARTS};
use crate::mechanism::{Action, System, Trigger};
use crate::run::Recorder;

/// More firings than this at one instant are a cycle: more than it takes to see that swings that come ever faster about a surface end on it.
const AT_AN_INSTANT: u32 = 2 * RESTARTS;
/// Times are one instant that differ by less than this part of themselves and of the last step.
const INSTANT: f64 = 1e-12;

/// Firings at one instant.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EventCascade {
    t: f64,
    count: u32,
}

/// What the actions of events that fire together did.
#[derive(Default)]
struct Effects {
    /// What was done to the state, the phase and the speeds.
    done: Done,
    /// Whether an action stops the run.
    stops: bool,
    /// Whether the event is among them after which the run is to end.
    ends: bool,
    /// What was set.
    assigned: Assigned,
}

impl Integration {
    /// Does what events say, and what events that are past their zero after it say in turn.
    pub(super) fn act(
        &mut self,
        system: &mut dyn System,
        fired: Vec<Fired>,
        locator: &mut EventLocator,
        recorder: &mut Recorder,
    ) -> Result<StopReason, Box<Cause>> {
        let mut fired = fired;
        let (mut stop_reason, mut stopping) = (StopReason::Arrived, false);
        // What a tick does not do needs no new start.
        let mut idle = fired.iter().all(|fired| fired.pending);
        while !self.cycles(locator.last_step()) {
            let before = system.phase();
            let watched = match actions(&fired).any(sets) {
                true => locator.values(system, (self.clock.now(), self.stepper.start().y)),
                false => Vec::new(),
            };
            let enters = actions(&fired).any(|action| matches!(action, Action::Phase(_) | Action::Contact(_)));
            let Effects { done, stops, ends, assigned } =
                self.effects(system, (&fired, stopping), locator, recorder)?;
            stopping = stops;
            let Done { acts: mut changed, strikes: hit } = done;
            if ends {
                stop_reason = StopReason::Event;
            }
            if !changed && !assigned.any && !stopping {
                if !idle {
                    self.restart(system, recorder)?;
                }
                return Ok(stop_reason);
            }
            idle = false;
            if assigned.any {
                changed |= self.reassigned(system, &watched, locator, recorder)?;
            }
            if stopping {
                fired = self.consequences(system, &assigned, locator);
                if !fired.is_empty() {
                    continue;
                }
                self.project_start(system)?;
                self.restart(system, recorder)?;
                return Ok(StopReason::Event);
            }
            fired.clear();
            if changed {
                let entered = system.phase() != before || enters;
                fired = self.already_past(system, (entered, hit), locator, recorder)?;
            }
            fired.extend(self.consequences(system, &assigned, locator));
            if fired.is_empty() {
                self.restart(system, recorder)?;
                return Ok(stop_reason);
            }
        }
        Err(Box::new(endless(system, &fired)))
    }

    /// Does what events say that fire together, those that are pending where their conditions hold; where the run stops, by one of them or already, they
    /// only set values from there on.
    fn effects(
        &mut self,
        system: &mut dyn System,
        (fired, stopping): (&[Fired], bool),
        locator: &mut EventLocator,
        recorder: &mut Recorder,
    ) -> Result<Effects, Box<Cause>> {
        let mut effects = Effects { stops: stopping, ..Effects::default() };
        for Fired { event, actions, pending } in fired {
            if effects.stops && !actions.iter().any(sets) {
                continue;
            }
            let (now, y) = (self.clock.now(), self.stepper.start().y.to_vec());
            if *pending {
                if !locator.holds(system, *event, (now, &y)) {
                    continue;
                }
                if !actions.iter().all(sets) {
                    locator.record_one(system, *event, (now, &y), actions.contains(&Action::Stop), recorder);
                }
            }
            effects.ends |= Some(*event) == self.ends_after;
            self.waiting.retain(|waiting| waiting != event);
            for action in actions {
                match action {
                    Action::Stop => effects.stops = true,
                    Action::Set(set) => {
                        self.assign(system, (*event, *set as usize), locator.last_step(), &mut effects.assigned)?
                    }
                    _ if effects.stops => {}
                    action => {
                        let Done { acts, strikes } = self.does(system, (*event, *action), recorder)?;
                        effects.done.acts |= acts;
                        effects.done.strikes |= strikes;
                    }
                }
            }
        }
        Ok(effects)
    }

    /// Looks anew at what values that were set are in, where functions were `watched` before; true where contacts do something else from here on.
    fn reassigned(
        &mut self,
        system: &mut dyn System,
        watched: &[f64],
        locator: &mut EventLocator,
        recorder: &mut Recorder,
    ) -> Result<bool, Box<Cause>> {
        let (now, y) = (self.clock.now(), self.stepper.start().y.to_vec());
        locator.reassigned(system, (now, &y), watched, &mut |system| self.trial(system))?;
        // Places and rates do not depend on what is set.
        let kinematics = self.kinematics(system);
        self.settle_contacts(system, &kinematics, recorder)
    }

    /// Looks anew at everything after speeds were `hit`, or the phase changed, as it did where one was `entered`; what events are past their
    /// zero there.
    pub(super) fn already_past(
        &mut self,
        system: &mut dyn System,
        (entered, hit): (bool, bool),
        locator: &mut EventLocator,
        recorder: &mut Recorder,
    ) -> Result<Vec<Fired>, Box<Cause>> {
        self.project_start(system)?;
        let (now, y) = (self.clock.now(), self.stepper.start().y.to_vec());
        locator.enter(system, (now, &y), hit, &mut |system| self.trial(system))?;
        let fired = locator.already_past(system, (now, self.stepper.start().y), entered);
        for Fired { event, actions, .. } in &fired {
            let stops = actions.contains(&Action::Stop);
            locator.record_one(system, *event, (now, self.stepper.start().y), stops, recorder);
        }
        Ok(fired)
    }

    /// Counts a firing; true where there were too many at one instant, in this call or, with steps too short to count between them, in
    /// several.
    fn cycles(&mut self, step: f64) -> bool {
        let now = self.clock.now();
        if (now - self.cascade.t).abs() > INSTANT * now.abs().max(step) {
            self.cascade = EventCascade { t: now, count: 0 };
        }
        self.cascade.count += 1;
        self.cascade.count > AT_AN_INSTANT
    }
}

/// The actions of events that fire together.
fn actions(fired: &[Fired]) -> impl Iterator<Item = &Action> {
    fired.iter().flat_map(|fired| &fired.actions)
}

/// Whether an action sets values.
fn sets(action: &Action) -> bool {
    matches!(action, Action::Set(_))
}

/// Why events fire at one instant without end: an event that follows what is set, or a switch.
fn endless(system: &dyn System, fired: &[Fired]) -> Cause {
    let name = |event: usize| system.description().events[event].name.to_string();
    let follows = |fired: &&Fired| matches!(system.sampling().trigger(fired.event), Trigger::Set(_));
    match fired.iter().find(follows) {
        Some(fired) => Cause::EndlessSets { event: name(fired.event) },
        None => Cause::Chattering { switch: name(fired.first().map_or(0, |fired| fired.event)), is_rate: false },
    }
}
