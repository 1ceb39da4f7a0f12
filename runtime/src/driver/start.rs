//! Events where a motion starts or ends.

use super::{Integration, StopReason};
use crate::cause::Cause;
use crate::events::Fired;
use crate::mechanism::{Action, System};
use crate::run::Recorder;
use crate::trust::Warning;

/// What is to be done before the next step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Starting {
    /// Nothing.
    Done,
    /// Events have to be put on their sides.
    Prolonged,
    /// The same, and those that are past their zero fire.
    Anew,
}

impl Integration {
    /// As [`Integration::begin`] after a change by hand, with the length of step that suited the motion before: the error test judges it.
    pub fn go_on(&mut self, system: &mut dyn System, until: f64) -> Result<(), Box<Cause>> {
        let h = self.h;
        self.begin(system, until)?;
        self.h = h;
        Ok(())
    }

    /// As [`Integration::go_on`] where nothing was changed: what was past a zero has fired.
    pub fn prolong(&mut self, system: &mut dyn System, until: f64) -> Result<(), Box<Cause>> {
        self.go_on(system, until)?;
        self.start = Starting::Prolonged;
        Ok(())
    }

    /// Does what happens at the instant at which the motion starts: events first, then ticks.
    pub fn act_at_start(&mut self, system: &mut dyn System, recorder: &mut Recorder) -> Result<StopReason, Box<Cause>> {
        let mut stop_reason = self.start_events(system, recorder)?;
        while stop_reason == StopReason::Arrived && self.ticks.is_due(self.clock.now()) {
            stop_reason = self.tick(system, recorder)?;
        }
        Ok(stop_reason)
    }

    /// Records events at whose zero the motion ends, and sets what they set.
    pub fn end_events(&mut self, system: &mut dyn System, recorder: &mut Recorder) -> Result<StopReason, Box<Cause>> {
        let Some(mut locator) = self.locator.take() else { return Ok(StopReason::Arrived) };
        let (now, y) = (self.clock.now(), self.stepper.start().y.to_vec());
        let (mut stop_reason, mut fired) = (Ok(StopReason::Arrived), Vec::new());
        for event in locator.at_end(system, (now, &y), self.h) {
            let actions = system.description().events[event].actions.to_vec();
            let stops = actions.contains(&Action::Stop);
            locator.record_one(system, event, (now, &y), stops, recorder);
            self.waiting.retain(|waiting| *waiting != event);
            if stops {
                stop_reason = Ok(StopReason::Event);
            }
            if actions.iter().any(|action| matches!(action, Action::Set(_))) {
                fired.push(Fired { event, actions, pending: false });
            }
        }
        if !fired.is_empty() {
            recorder.leave(system, now, self.stepper.start());
            stop_reason = self.act(system, fired, &mut locator, recorder);
        }
        self.locator = Some(locator);
        stop_reason
    }

    /// Does what events say that are past their zero, or at it and move past, where a motion starts.
    pub(super) fn start_events(
        &mut self,
        system: &mut dyn System,
        recorder: &mut Recorder,
    ) -> Result<StopReason, Box<Cause>> {
        let start = std::mem::replace(&mut self.start, Starting::Done);
        if start == Starting::Done {
            return Ok(StopReason::Arrived);
        }
        let Some(mut locator) = self.locator.take() else { return Ok(StopReason::Arrived) };
        let (now, y) = (self.clock.now(), self.stepper.start().y.to_vec());
        let span = self.until - now;
        let is_first = self.h == 0.0 && self.work.steps == 0;
        if self.h == 0.0 {
            // Ticks end it sooner, wherever the motion ends.
            self.h = self.first(system, span.min(self.ticks.after(now) - now));
        }
        let beside = self.beside.as_deref().filter(|_| start == Starting::Anew);
        locator.start(system, (now, &y), beside, (self.h.min(span), span));
        let (mut fired, mut past) = locator.at_start(system, (now, &y));
        if start == Starting::Prolonged {
            // What a contact does at the end of a piece waits for the next one.
            fired.retain(|fired| matches!(fired.actions[..], [Action::Contact(_)]));
            past.clear();
        } else if let Some(switch) = locator.undecided(system) {
            recorder.warn(Warning::BothSidesLeave { switch });
        }
        // What another run, or this one before a change by hand, has passed is past.
        if start == Starting::Anew && is_first {
            self.waiting = locator.waiting_at_start(system, (now, &y));
            self.waiting.retain(|event| !past.contains(event));
        }
        for event in past {
            recorder.warn(Warning::PastAtStart { event: system.description().events[event].name.to_string() });
        }
        let mut stop_reason = Ok(StopReason::Arrived);
        if !fired.is_empty() {
            recorder.leave(system, now, self.stepper.start());
            for Fired { event, actions, .. } in &fired {
                locator.record_one(system, *event, (now, &y), actions.contains(&Action::Stop), recorder);
            }
            self.begins = true;
            stop_reason = self.act(system, fired, &mut locator, recorder);
            self.begins = false;
        }
        self.locator = Some(locator);
        stop_reason
    }
}
