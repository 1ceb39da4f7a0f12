//! Contacts that close, open, stick and slip by themselves.

use super::Integration;
use super::phase::Done;
use crate::cause::Cause;
use crate::constrain::{
    Change, Kinematics, Moment, Strike, Turned, VelocityJump, begins_stiffly, closed_within, follow_directions,
    is_released, kinematics, possible_limits, settle, strike, turned, velocity_jump,
};
use crate::events::Log;
use crate::mechanism::{At, ContactEvent, System};
use crate::run::Recorder;
use crate::trust::{Warning, deciding};

/// Beside the largest gap that there was hops are lost that are lower by the square of this: so low that times at which geometric series of hops
/// end are known before.
const LOWER: f64 = 0.25;

/// The next step where a gap that closed opens again at once, beside the last one.
const SHORTER: f64 = 0.1;

impl Integration {
    /// Decides what all contacts do where an event of one of them happened.
    pub(super) fn change_contact(
        &mut self,
        system: &mut dyn System,
        (event, contact): (usize, usize),
        recorder: &mut Recorder,
    ) -> Result<Done, Box<Cause>> {
        let nothing = Done { acts: false, strikes: false };
        let Some(what) = system.contacts().all[contact].happened(event) else { return Ok(nothing) };
        // Another event of this instant may have changed it already.
        if !what.is_of(system.contacts().modes(system.phase())[contact]) {
            return Ok(nothing);
        }
        if what == ContactEvent::Slips {
            let scales = self.scales(system);
            let (now, y) = (self.clock.now(), self.stepper.start().y);
            if is_released(
                system,
                &Moment { t: now, y, scales: &scales, fastest: &self.fastest, step: self.instant() },
                contact,
            )? {
                return Ok(nothing);
            }
        }
        if what == ContactEvent::Stops && system.contacts().all[contact].direction.is_some() {
            if !self.stops_in_space(system, contact)? {
                return Ok(Done { acts: true, strikes: false });
            }
            recorder.event(system, event, self.clock.now(), self.stepper.start().y, false);
        }
        let began = self.clock.now();
        let struck = match what {
            ContactEvent::Lands => self.lands(system, (event, contact), recorder)?,
            _ => None,
        };
        let scales = self.scales(system);
        let (now, y) = (self.clock.now(), self.stepper.start().y.to_vec());
        let (before, memory) = (system.phase(), system.memory().to_vec());
        let change = match &struck {
            Some(strike) => Change::Struck(strike),
            None => Change::Event { contact, what },
        };
        let moment = Moment { t: now, y: &y, scales: &scales, fastest: &self.fastest, step: self.instant() };
        let phase = settle(system, &moment, change)?;
        system.set_phase(before);
        if phase == before && system.memory() != memory {
            // What slid in space slides on in another direction.
            return Ok(Done { acts: true, strikes: false });
        }
        if phase == before && struck.as_ref().is_none_or(Strike::is_empty) {
            // A gap that closed and opens again at once is looked at anew, in a shorter step, in which a low hop shows.
            let opens = what == ContactEvent::Lands;
            self.h *= if opens { SHORTER } else { 1.0 };
            return Ok(Done { acts: opens, strikes: false });
        }
        let entered = self.enter(system, phase, &[], recorder)?;
        self.carry(system, self.clock.now() - began);
        Ok(Done { acts: true, strikes: entered || struck.is_some() })
    }

    /// Whether what slides in space stops where its rate along the direction that is held is zero; where it has only turned, its present direction is held
    /// from here on. What is left of a rate that the friction of sliding takes away at once is gone.
    fn stops_in_space(&mut self, system: &mut dyn System, contact: usize) -> Result<bool, Box<Cause>> {
        let scales = self.scales(system);
        let (now, y) = (self.clock.now(), self.stepper.start().y.to_vec());
        let moment = Moment { t: now, y: &y, scales: &scales, fastest: &self.fastest, step: self.instant() };
        let rows = match turned(system, &moment, contact) {
            Turned::On => return Ok(false),
            Turned::Stops => return Ok(true),
            Turned::Dies(rows) => rows,
        };
        let taken =
            velocity_jump(system, (now, &y), &rows, |_| 0.0).map_err(|fault| fault.cause(system.description()))?;
        let n = system.len();
        self.stepper.state_mut()[n..].iter_mut().zip(&taken.jump).for_each(|(v, jump)| *v += jump);
        Ok(true)
    }

    /// Holds the directions of what slides in space and has turned away from those that were held.
    pub(super) fn follow_directions(
        &mut self,
        system: &mut dyn System,
        recorder: &mut Recorder,
    ) -> Result<(), Box<Cause>> {
        if self.steps_over() || !system.contacts().all.iter().any(|contact| contact.direction.is_some()) {
            return Ok(());
        }
        self.note_speeds(system);
        let (now, y) = (self.clock.now(), self.stepper.start().y.to_vec());
        let before = system.memory().to_vec();
        if !follow_directions(
            system,
            &Moment { t: now, y: &y, scales: &[], fastest: &self.fastest, step: self.instant() },
        ) {
            return Ok(());
        }
        let followed = system.memory().to_vec();
        system.set_memory(&before);
        recorder.leave(system, now, self.stepper.start());
        system.set_memory(&followed);
        if let Some(mut locator) = self.locator.take() {
            locator.enter(system, (now, &y), false, &mut |system| self.trial(system))?;
            self.locator = Some(locator);
        }
        self.restart(system, recorder)
    }

    /// Looks at each combination of modes once: warns where the motion depends on how contacts or constraints share a force that the equations leave
    /// open; true where something begins to slide so slowly that its direction is stiff.
    pub(super) fn look_at_combination(&mut self, system: &dyn System, recorder: &mut Recorder) -> bool {
        if system.description().friction_pattern.is_empty() {
            return false;
        }
        let contacts = system.contacts();
        let phase = match self.stepper.tally() {
            None => system.phase(),
            // Of many nothing is known but what each does alone.
            Some(_) if contacts.are_single() => return false,
            Some(tally) => {
                let modes = contacts.all.iter().zip(&tally.contacts).map(|(contact, done)| contact.modes()[done.mode]);
                contacts.phase(&modes.collect::<Vec<_>>())
            }
        };
        if self.looked_at.replace(phase) == Some(phase) {
            return false;
        }
        let other = (phase != system.phase()).then(|| {
            let mut own = system.boxed_clone();
            own.set_phase(phase);
            own
        });
        let system = other.as_deref().unwrap_or(system);
        let scales = self.scales(system);
        let (t, y) = (self.clock.now(), self.stepper.start().y);
        let moment = Moment { t, y, scales: &scales, fastest: &self.fastest, step: self.instant() };
        let constraints = deciding(system, &moment);
        if !constraints.is_empty() {
            recorder.warn(Warning::MotionNotUnique { constraints, as_springs: !self.steps_over() });
        }
        self.leaves_where_stiff.is_some() && begins_stiffly(system, &moment)
    }

    /// Whether steps go over contacts, of which no event is looked for.
    fn steps_over(&self) -> bool {
        self.stepper.tally().is_some()
    }

    /// The step beside which the present instant is known: the one that led here, which may end far before the longest that is possible.
    fn instant(&self) -> f64 {
        self.h.min(self.last_step)
    }

    /// How the sides of all contacts are placed and move at the present state.
    ///
    /// None where steps go over contacts: what becomes of them nobody decides then.
    pub fn kinematics(&self, system: &dyn System) -> Vec<Kinematics> {
        if self.steps_over() {
            return Vec::new();
        }
        kinematics(system, At::packed(self.clock.now(), self.stepper.start().y, system.len()))
    }

    /// Decides what all contacts do where forces jumped without an event of theirs, and maybe gaps and rates, which were these; true where
    /// any does something else from here on.
    pub(super) fn settle_contacts(
        &mut self,
        system: &mut dyn System,
        before: &[Kinematics],
        recorder: &mut Recorder,
    ) -> Result<bool, Box<Cause>> {
        if before.is_empty() { Ok(false) } else { self.settle_after(system, Change::Jump(before), recorder) }
    }

    /// Decides what all contacts do after a change that is no event of theirs; true where any does something else from here on.
    pub(super) fn settle_after(
        &mut self,
        system: &mut dyn System,
        change: Change<'_>,
        recorder: &mut Recorder,
    ) -> Result<bool, Box<Cause>> {
        let scales = self.scales(system);
        let (now, y) = (self.clock.now(), self.stepper.start().y.to_vec());
        let phase = system.phase();
        let moment = Moment { t: now, y: &y, scales: &scales, fastest: &self.fastest, step: self.instant() };
        let next = settle(system, &moment, change)?;
        system.set_phase(phase);
        if next == phase {
            return Ok(false);
        }
        let (contacts, now_placed) = (system.contacts(), self.kinematics(system));
        let modes = contacts.modes(phase).into_iter().zip(contacts.modes(next));
        for ((contact, (from, to)), placed) in contacts.all.iter().zip(modes).zip(now_placed) {
            // What approaches lands next, and does not lift.
            let happens = ContactEvent::between(from, to).filter(|_| placed.gap_rate >= 0.0);
            if let Some(event) = happens.and_then(|happens| contact.event(happens)) {
                recorder.event(system, event, now, &y, false);
            }
        }
        self.enter(system, next, &[], recorder)?;
        Ok(true)
    }

    /// Refuses a motion in which the sides of a contact pass through each other, its event not seen, or in which a limit of friction is none.
    pub(super) fn look_at_contacts(&mut self, system: &mut dyn System) -> Result<(), Box<Cause>> {
        if system.contacts().all.is_empty() || self.steps_over() {
            return Ok(());
        }
        let Some(projection) = &mut self.projection else { return Ok(()) };
        let (now, y) = (self.clock.now(), self.stepper.start().y);
        projection.observe(system, now, y);
        for contact in system.contacts().all.iter() {
            let Some(row) = contact.normal.map(|row| row as usize) else { continue };
            if let Some(gap) = projection.misses(row).filter(|gap| *gap < 0.0)
                && -gap > closed_within(system, At::packed(now, y, system.len()), projection.scales())[row]
            {
                return Err(Cause::Penetrates { contact: contact.name.to_string(), gap }.into());
            }
        }
        possible_limits(system, now, y)
    }

    /// A contact's coefficient of restitution.
    fn restitution(&self, system: &dyn System, contact: usize) -> f64 {
        let place = system.contacts().all[contact].restitution;
        place.and_then(|place| system.restitutions().get(place as usize).copied()).unwrap_or(0.0)
    }

    /// Of each contact the rate with which it does not leave: its hop would be lost in the rounding of its gap, or beside the largest gap that there
    /// was; or all its hops would end within twice the seconds that are `left` of another's.
    ///
    /// Then it rests at once, which loses nothing along the contact: the friction of resting for as long as the hops last is that of their impulses,
    /// m u + m |c''| T = m u (1 + e)/(1 - e) for an approach u and T = 2 e u/(|c''| (1 - e)).
    fn slow(&self, system: &mut dyn System, scales: &[f64], left: f64) -> Vec<f64> {
        let (phase, contacts) = (system.phase(), system.contacts().all.clone());
        let modes = system.contacts().modes(phase);
        let mut slow = Vec::with_capacity(contacts.len());
        for (k, contact) in contacts.iter().enumerate() {
            // What brings back one that is closed shows where it is open.
            let mut open = modes.clone();
            open[k] = contact.modes()[0];
            let without = system.contacts().phase(&open);
            system.set_phase(without);
            let (here, ever) = (self.low_hops(system, &[]), self.low_hops(system, scales));
            let e = self.restitution(system, k);
            let falls = |row: u32| {
                let hops = here.get(row as usize).zip(ever.get(row as usize)).filter(|(here, _)| here.back < 0.0);
                hops.map_or(0.0, |(here, ever)| {
                    // Hops that begin with the rate w last 2 w/(|c''| (1 - e)) together.
                    let ends_too = -here.back * left * (1.0 - e);
                    here.rate.max(LOWER * ever.rate).max(ends_too)
                })
            };
            slow.push(contact.normal.map_or(0.0, falls));
        }
        system.set_phase(phase);
        slow
    }

    /// Notes how fast all moves, where something may slide in space: beside that a sliding rate is rounding.
    fn note_speeds(&mut self, system: &dyn System) {
        if system.contacts().all.iter().any(|contact| contact.direction.is_some()) {
            let speeds = &self.stepper.start().y[system.len()..];
            self.fastest.resize(speeds.len(), 0.0);
            self.fastest.iter_mut().zip(speeds).for_each(|(most, v)| *most = most.max(v.abs()));
        }
    }

    /// The largest Σ |terms| that the constraints' rows have had, here included.
    fn scales(&mut self, system: &dyn System) -> Vec<f64> {
        self.note_speeds(system);
        let Some(projection) = &mut self.projection else { return Vec::new() };
        projection.observe(system, self.clock.now(), self.stepper.start().y);
        projection.scales().to_vec()
    }

    /// The impact of a contact that closes, and of what it strikes with; `None` where nothing approaches.
    fn lands(
        &mut self,
        system: &mut dyn System,
        (event, contact): (usize, usize),
        recorder: &mut Recorder,
    ) -> Result<Option<Strike>, Box<Cause>> {
        let now = self.clock.now();
        let e = self.restitution(system, contact);
        // What loses no speed goes on for ever.
        let end = if e > 0.0 && e < 1.0 { self.impacts.note(event, now) } else { None };
        let (y, scales) = (self.stepper.start().y.to_vec(), self.scales(system));
        let mut slow = self.slow(system, &scales, end.map_or(0.0, |end| end - now));
        if end.is_some() {
            slow[contact] = f64::INFINITY;
        }
        let moment = Moment { t: now, y: &y, scales: &scales, fastest: &self.fastest, step: self.instant() };
        let Some(strike) = strike(system, &moment, &slow)? else { return Ok(None) };
        if let Some(end) = end {
            // The last hops lead along the contact, on which it rests.
            let left = end - now;
            let (q, v) = self.stepper.state_mut().split_at_mut(system.len());
            q.iter_mut().zip(v.iter().zip(&strike.jump)).for_each(|(q, (v, jump))| *q += left * (v + jump));
            self.clock.set(end);
            self.impacts.forget(event);
            if left > 0.0 {
                recorder.accumulated(system, event, end);
            }
        }
        if !strike.is_plastic() {
            recorder.rebounds();
        }
        let jump = VelocityJump { jump: strike.jump.clone(), rows: strike.rows.clone() };
        self.take(system, jump, recorder);
        Ok(Some(strike))
    }
}
