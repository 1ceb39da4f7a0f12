//! The watch over one motion.

use super::sample::Sampler;
use super::scan::{Crossing, Scanner};
use super::stops::{Stop, stop_times};
use super::{Log, modes};
use crate::cause::Cause;
use crate::integrate::Segment;
use crate::mechanism::{Action, Direction, SwitchKind, System};

/// Watches events and switches along a motion.
#[derive(Clone, Debug)]
pub(crate) struct Watch {
    sampler: Sampler,
    scanner: Scanner,
    /// Stop times that are still to come, the next one last.
    stops: Vec<Stop>,
    time_only: Vec<bool>,
    /// Which switches are on their surface at a restart.
    surface: Vec<bool>,
    /// A time that is too short to tell apart, s.
    instant: f64,
    /// How many restarts in a row came within an instant, and when the last one was.
    restarts: u32,
    last_restart: f64,
    y: Vec<f64>,
}

/// The first thing within a step that ends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Interruption {
    /// A stopping event or a switch crosses zero.
    At(Crossing),
    /// A switch that rested on its surface leaves it, to this side.
    LeavesRest {
        /// Which one.
        switch: usize,
        /// −1 or 1.
        side: f64,
    },
}

/// More restarts than this within an instant are chattering.
const RESTARTS: u32 = 100;
/// A switch that rests has left its surface when its argument is this large, in SI units.
const REST: f64 = 1e-12;

impl Watch {
    /// A watch over the motion from `from` to `until`; `None` if there is nothing to watch.
    pub fn new<S: System + ?Sized>(system: &S, (from, until): (f64, f64), y: &[f64]) -> Option<Self> {
        let description = system.description();
        if description.events.is_empty() && description.switches.is_empty() {
            return None;
        }
        let mut sampler = Sampler::new(system, from, y);
        let mut stops = stop_times(system, &mut sampler, (from, until), y);
        stops.reverse();
        Some(Watch {
            scanner: Scanner::new(sampler.len(), 1e-12 * (until - from)),
            sampler,
            stops,
            time_only: description.switches.iter().map(|switch| switch.time_only).collect(),
            surface: vec![false; description.switches.len()],
            instant: 1e-12 * (until - from),
            restarts: 0,
            last_restart: f64::NEG_INFINITY,
            y: vec![0.0; 2 * system.len()],
        })
    }

    /// Chooses the modes and notes on which side of zero all functions are, at the start of a motion.
    pub fn begin<S: System + ?Sized>(&mut self, system: &mut S, t: f64, y: &[f64]) -> Result<(), Cause> {
        self.surface.fill(false);
        let kinds = system.description().switches.iter().map(|switch| switch.kind);
        let neutral: Vec<f64> = kinds.map(|kind| if kind == SwitchKind::Sign { 0.0 } else { 1.0 }).collect();
        system.set_modes(&neutral);
        self.choose(system, (t, y), None)?;
        self.sampler.at_state(system, t, y);
        for function in 0..self.sampler.len() {
            if self.sampler.switch(function).is_none() {
                let value = self.sampler.value(function);
                self.scanner.sides[function] = if value == 0.0 { 0.0 } else { value.signum() };
            }
        }
        self.scanner.fresh.fill(true);
        Ok(())
    }

    /// The next time at which a step must end, at most `until`.
    pub fn next_stop(&self, until: f64) -> f64 {
        self.stops.last().map_or(until, |stop| stop.t.min(until))
    }

    /// Looks for the first thing within a step that ends it.
    pub fn scan<S: System + ?Sized>(&mut self, system: &S, segment: &Segment<'_>) -> Option<Interruption> {
        self.scanner.scan(&mut self.sampler, system, segment);
        for switch in 0..self.surface.len() {
            let function = self.sampler.function_of(switch);
            let rests = modes::side(system, switch) == 0.0;
            let argument = self.scanner.largest(function).filter(|value| value.abs() > REST);
            if let Some(value) = argument.filter(|_| rests) {
                return Some(Interruption::LeavesRest { switch, side: value.signum() });
            }
        }
        let crossings = std::mem::take(&mut self.scanner.crossings);
        let first = crossings.iter().find(|crossing| match self.sampler.switch(crossing.function) {
            Some(switch) => !(self.time_only[switch] && crossing.theta >= 1.0 - 1e-9),
            None => {
                let event = &system.description().events[crossing.function];
                let stops = event.actions.contains(&Action::Stop) && counts(event.direction, crossing.rising);
                stops && {
                    self.sampler.at(system, segment, crossing.theta);
                    self.sampler.second(crossing.function) > 0.0
                }
            }
        });
        let first = first.copied();
        self.scanner.crossings = crossings;
        first.map(Interruption::At)
    }

    /// A function's value at a state, and its slope there along the step that ends in it.
    pub fn value_and_slope<S: System + ?Sized>(
        &mut self,
        system: &S,
        function: usize,
        segment: &Segment<'_>,
        end: &[f64],
    ) -> (f64, f64) {
        const BACK: f64 = 1e-3;
        self.sampler.at(system, segment, 1.0 - BACK);
        let before = self.sampler.value(function);
        self.sampler.at_state(system, segment.t + segment.h, end);
        let value = self.sampler.value(function);
        (value, (value - before) / (BACK * segment.h))
    }

    /// Notes what is recorded within a step that nothing ended.
    pub fn pass<S: System + ?Sized>(&mut self, system: &S, segment: &Segment<'_>, recorder: &mut impl Log) {
        self.record(system, segment, recorder, &[]);
        self.scanner.advance(segment.h);
    }

    /// Functions that cross zero together with another one, it included, in file order.
    pub fn simultaneous(&self, crossing: Crossing, segment: &Segment<'_>) -> Vec<Crossing> {
        let resolution = 1e-11_f64.max(8.0 * f64::EPSILON * segment.t.abs() / segment.h);
        let near = |other: &&Crossing| (other.theta - crossing.theta).abs() <= resolution;
        let mut together: Vec<Crossing> = self.scanner.crossings.iter().filter(near).copied().collect();
        together.sort_by_key(|crossing| crossing.function);
        together
    }

    /// Notes what is recorded within a step that ends at these crossings, before they fire.
    pub fn record_before<S: System + ?Sized>(
        &mut self,
        system: &S,
        segment: &Segment<'_>,
        recorder: &mut impl Log,
        together: &[Crossing],
    ) {
        self.scanner.scan(&mut self.sampler, system, segment);
        self.record(system, segment, recorder, together);
        self.scanner.advance(segment.h);
    }

    /// Fires the events that cross zero together at this state, and notes which switches do.  Returns true if
    /// an event ends the run.
    pub fn fire<S: System + ?Sized>(
        &mut self,
        system: &S,
        together: &[Crossing],
        (t, y): (f64, &[f64]),
        recorder: &mut impl Log,
    ) -> bool {
        self.surface.fill(false);
        let mut stops = false;
        for crossing in together {
            self.scanner.sides[crossing.function] = if crossing.rising { 1.0 } else { -1.0 };
            self.scanner.fresh[crossing.function] = true;
            if let Some(switch) = self.sampler.switch(crossing.function) {
                self.surface[switch] = true;
                continue;
            }
            self.sampler.at_state(system, t, y);
            let event = &system.description().events[crossing.function];
            if counts(event.direction, crossing.rising) && self.sampler.second(crossing.function) > 0.0 {
                let ends = event.actions.contains(&Action::Stop);
                recorder.event(system, crossing.function, t, y, ends);
                stops |= ends;
            }
        }
        stops
    }

    /// A switch leaves the surface on which it rested.
    pub fn leave_rest<S: System + ?Sized>(
        &mut self,
        system: &mut S,
        (switch, side): (usize, f64),
        (t, y): (f64, &[f64]),
    ) -> Result<(), Cause> {
        self.surface.fill(false);
        self.surface[switch] = true;
        self.choose(system, (t, y), Some((switch, side)))?;
        self.surface.fill(false);
        Ok(())
    }

    /// Switches at a state in which [`Watch::fire`] found switches to cross zero, or at a stop time, or both;
    /// returns true if it was one of these.
    pub fn switch<S: System + ?Sized>(&mut self, system: &mut S, t: f64, y: &[f64]) -> Result<bool, Cause> {
        if let Some(stop) = self.stops.pop_if(|stop| stop.t <= t) {
            for switch in stop.switches {
                self.surface[switch] = true;
            }
        }
        let any = self.surface.contains(&true);
        if any {
            self.choose(system, (t, y), None)?;
            self.surface.fill(false);
        }
        Ok(any)
    }

    /// Chooses the modes and sets the switches' sides to match.
    fn choose<S: System + ?Sized>(
        &mut self,
        system: &mut S,
        (t, y): (f64, &[f64]),
        leaves: Option<(usize, f64)>,
    ) -> Result<(), Cause> {
        self.restarts = if t - self.last_restart <= self.instant { self.restarts + 1 } else { 0 };
        self.last_restart = t;
        let on = modes::choose(system, &mut self.sampler, (t, y), &self.surface, leaves, self.instant)?;
        for (switch, on) in on.into_iter().enumerate() {
            let function = self.sampler.function_of(switch);
            self.scanner.sides[function] = modes::side(system, switch);
            self.scanner.fresh[function] |= on;
            if on && self.restarts > RESTARTS {
                return Err(Cause::Chattering { switch: modes::text(system, switch) });
            }
        }
        Ok(())
    }

    /// Hands the events that only record, but for those in `but`, to the recorder.
    fn record<S: System + ?Sized>(
        &mut self,
        system: &S,
        segment: &Segment<'_>,
        recorder: &mut impl Log,
        but: &[Crossing],
    ) {
        for crossing in &self.scanner.crossings {
            let Some(event) = system.description().events.get(crossing.function) else { continue };
            let taken = but.iter().any(|other| other.function == crossing.function && crossing.theta > 0.5);
            if taken || !counts(event.direction, crossing.rising) {
                continue;
            }
            self.sampler.at(system, segment, crossing.theta);
            if self.sampler.second(crossing.function) > 0.0 {
                let t = segment.t + crossing.theta * segment.h;
                segment.evaluate(crossing.theta, &mut self.y);
                recorder.event(system, crossing.function, t, &self.y, false);
            }
        }
    }
}

fn counts(direction: Direction, rising: bool) -> bool {
    match direction {
        Direction::Both => true,
        Direction::Rising => rising,
        Direction::Falling => !rising,
    }
}
