//! Events and discontinuities along one motion.
//!
//! Where it starts and ends: look in `start.rs`; after phases or speeds changed: `enter.rs`; discontinuities that switch: `switch.rs`;
//! what is written down: `record.rs`; what is set: `set.rs`.

mod enter;
mod record;
mod set;
mod start;
mod switch;

use super::Log;
use super::arguments::{Arguments, Course};
use super::features::FeatureDetector;
use super::modes::{self, Trial};
use super::sample::{self, Sampler};
use super::scan::{Crossing, Scanner};
use super::sides;
use super::stops::Stops;
use crate::cause::Cause;
use crate::constrain::{Moment, never_stopping};
use crate::integrate::{Endpoint, Segment};
use crate::mechanism::sliding::fractions;
use crate::mechanism::{Action, Direction, System, Trigger};

pub(crate) use switch::Switched;

/// Watches events and switches along a motion.
#[derive(Clone, Debug)]
pub(crate) struct EventLocator {
    sampler: Sampler,
    arguments: Arguments,
    monitors: FeatureDetector,
    scanner: Scanner,
    /// Times that are still to come at which a step must end.
    stops: Stops,
    time_only: Vec<bool>,
    /// Which switches are on their surface at a restart.
    surface: Vec<bool>,
    /// On which side others are from there on.
    beyond: Vec<Option<f64>>,
    /// One that might have left its surface to the other side as well, where modes were chosen last.
    undecided: Option<usize>,
    /// Events that do nothing.
    ignored: Vec<usize>,
    /// When each event was written down last, s; not a number before.
    logged: Vec<f64>,
    /// The length of the last step, s.
    step: f64,
    /// How many restarts in a row came at once, and when the last one was.
    restarts: u32,
    last_restart: f64,
    /// Which switches were on their surface at one of these.
    met: Vec<bool>,
    /// Which switches the constraints in force hold at their surface.
    held: Vec<bool>,
    /// Whether the last switches that crossed zero had left it by no more than rounding.
    within_rounding: bool,
    y: Vec<f64>,
}

/// An event that changes something.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fired {
    /// Which one.
    pub event: usize,
    /// What it does, in order.
    pub actions: Vec<Action>,
    /// Whether its condition is still to be looked at, and it to be written down: a tick, or what follows when something was set.
    pub pending: bool,
}

/// The first thing within a step that ends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Interruption {
    /// A stopping event or a switch crosses zero.
    At(Crossing),
    /// A switch leaves the surface on which it was, to this side, other than its mode says.
    Leaves {
        /// Which one.
        switch: usize,
        /// −1 or 1.
        side: f64,
    },
}

/// After so many restarts at once what is on its surface stays there, if it can; after twice as many it is chattering.
pub(crate) const RESTARTS: u32 = 100;
/// After so many it is asked whether rounding makes them.
const SEVERAL: u32 = 8;
/// What happens within this part of a step happens at once.
const AT_ONCE: f64 = 1e-9;
/// An event's function is at its zero where it is this part of the largest it had.
const ON: f64 = 1e-10;
/// The gap of a contact is open where it is more than this part of the largest that it had, or of the sum of its terms: what is less than [`ON`] open,
/// and closes, lands.
const OPEN: f64 = 1e-13;
/// A switch has left its surface when its argument is this part of the largest it had.
const REST: f64 = 1e-12;

impl EventLocator {
    /// A locator for the motion from `from` to `until`, that cuts steps at others than the usual places, and lets stop times come a
    /// rounding early, if `decorrelate_steps`; `None`
    /// if there is nothing to watch.
    ///
    /// # Errors
    /// A discontinuity of time that comes too often.
    pub fn new<S: System + ?Sized>(
        system: &mut S,
        (from, until): (f64, f64),
        y: &[f64],
        decorrelate_steps: bool,
    ) -> Result<Option<Self>, Box<Cause>> {
        let monitors = FeatureDetector::new(system, decorrelate_steps);
        let description = system.description();
        let closures = (0..description.inputs.len()).any(|input| system.signal(input).is_some());
        if description.events.is_empty() && description.switches.is_empty() && monitors.is_empty() && !closures {
            return Ok(None);
        }
        let time_only: Vec<bool> = description.switches.iter().map(|switch| switch.time_only).collect();
        let events = description.events.len();
        let mut sampler = Sampler::new(system);
        let mut arguments = Arguments::new(system);
        let stops = Stops::new(system, (&mut sampler, &mut arguments), (from, until), y, decorrelate_steps)?;
        let mut scanner = Scanner::new(system, &sampler);
        // Those that happen at ticks, or when something was set, have no function.
        let has_function = |event: &usize| *system.sampling().trigger(*event) == Trigger::Zero;
        (0..events).filter(|event| !has_function(event)).for_each(|event| scanner.ignore(event));
        Ok(Some(EventLocator {
            scanner,
            sampler,
            arguments,
            monitors,
            stops,
            surface: vec![false; time_only.len()],
            met: vec![false; time_only.len()],
            held: vec![false; time_only.len()],
            beyond: vec![None; time_only.len()],
            undecided: None,
            time_only,
            ignored: Vec::new(),
            logged: vec![f64::NAN; events],
            step: 0.0,
            restarts: 0,
            last_restart: f64::NEG_INFINITY,
            within_rounding: false,
            y: vec![0.0; 2 * system.len()],
        }))
    }

    /// Never looks at these events.
    pub fn ignore(&mut self, events: &[usize]) {
        events.iter().for_each(|event| self.scanner.ignore(*event));
        self.ignored = events.to_vec();
    }

    /// When a motion begins that starts at t: just after what closures do there.
    pub fn beginning(&mut self, t: f64) -> f64 {
        self.stops.pass(t)
    }

    /// Chooses the modes at the start of a motion.
    pub fn begin<S: System + ?Sized>(
        &mut self,
        system: &mut S,
        (t, y): (f64, &[f64]),
        trial: Trial<'_, S>,
    ) -> Result<(), Box<Cause>> {
        self.forget_surfaces();
        let sides = sides::of_time(system, &mut self.sampler, t, y);
        self.beyond = sides.into_iter().map(|side| side.filter(|side| *side != 0.0)).collect();
        self.choose(system, (t, y), None, trial)?;
        self.forget_surfaces();
        self.scanner
            .activate(system, &never_stopping(system, &Moment { t, y, scales: &[], fastest: &[], step: self.step }));
        self.scanner.fresh.fill(true);
        self.scanner.restart();
        self.monitors.forget();
        Ok(())
    }

    /// Samples of watched functions and of arguments so far.
    pub fn samples(&self) -> u64 {
        self.sampler.samples + self.arguments.samples
    }

    /// True where every step needs dense output, whatever the recorder says: where anything but time, whose stops are known, may
    /// cross zero in it, or leave zero.
    pub fn wants_dense<S: System + ?Sized>(&self, system: &S) -> bool {
        let timed = |switch: usize| self.time_only[switch] && modes::side(system, switch) != 0.0;
        let watched = |function: &usize| !self.scanner.is_ignored(*function);
        (0..self.sampler.len()).filter(watched).any(|function| !self.sampler.switch(function).is_some_and(timed))
    }

    /// Whether the ends of a step show that nothing hides between them in the equations of motion.
    pub fn has_no_feature<S: System + ?Sized>(
        &mut self,
        system: &S,
        times: (f64, f64),
        ends: (Endpoint<'_>, Endpoint<'_>),
    ) -> bool {
        self.monitors.has_no_feature(system, times, ends)
    }

    /// The next time at which a step must end, at most `until`.
    pub fn next_stop(&self, until: f64) -> f64 {
        self.stops.next().min(until)
    }

    /// Whether a time at which a step must end has come.
    pub fn is_due(&self, t: f64) -> bool {
        self.stops.is_due(t)
    }

    /// The times at which steps must end, as far as they are known yet.
    pub fn stop_times(&self) -> Vec<f64> {
        self.stops.list.iter().rev().map(|stop| stop.t).collect()
    }

    /// The longest step from t, at most h seconds, that meets no feature of time alone.
    pub fn ahead<S: System + ?Sized>(&mut self, system: &S, t: f64, h: f64) -> f64 {
        self.monitors.ahead(&mut self.arguments, system, t, h).map_or(h, |theta| theta * h)
    }

    /// Where a step that was tried has to be cut, 0 to 1, because it jumps over a feature of the equations.
    pub fn cut<S: System + ?Sized>(&mut self, system: &S, segment: &Segment<'_>) -> Option<f64> {
        self.monitors.cut(&mut self.arguments, system, &Course::Step(*segment))
    }

    /// The spring, damper or force whose ends meet within a step, to `part` of the largest distance there was.
    ///
    /// # Errors
    /// [`Cause::EndsMeet`].
    pub fn meets<S: System + ?Sized>(
        &mut self,
        system: &S,
        segment: &Segment<'_>,
        part: f64,
    ) -> Result<(), Box<Cause>> {
        match self.monitors.meets(&mut self.arguments, system, &Course::Step(*segment), part) {
            Some((index, theta)) => Err(ends_meet(system, index, segment.t + theta * segment.h).into()),
            None => Ok(()),
        }
    }

    /// Why an integration could not go on from a state: ends that meet within `ahead` seconds explain most of it.
    pub fn explain<S: System + ?Sized>(
        &mut self,
        system: &S,
        cause: Cause,
        (t, y): (f64, &[f64]),
        ahead: f64,
    ) -> Cause {
        let explicable = matches!(
            cause,
            Cause::StepTooSmall { .. }
                | Cause::NonFinite { .. }
                | Cause::SingularMass { .. }
                | Cause::DirectionLost { .. }
        );
        if !explicable {
            return cause;
        }
        let met = self.monitors.met(&mut self.arguments, system, (t, y), ahead);
        met.map_or(cause, |index| ends_meet(system, index, t))
    }

    /// Looks for the first thing within a step that ends it.
    ///
    /// # Errors
    /// A function that oscillates too fast; an argument that is no number before anything ends the step.
    pub fn scan<S: System + ?Sized>(
        &mut self,
        system: &S,
        segment: &Segment<'_>,
    ) -> Result<Option<Interruption>, Box<Cause>> {
        self.scanner.scan(&mut self.sampler, &mut self.arguments, system, segment)?;
        for switch in 0..self.surface.len() {
            let function = self.sampler.function_of(switch);
            let value = self.scanner.largest_here(function);
            let rests = modes::side(system, switch) == 0.0 && self.scanner.awake(function);
            if rests && value.abs() > REST * self.scanner.largest(function) && value != 0.0 {
                segment.evaluate(1.0, &mut self.y);
                let end = (segment.t + segment.h, self.y.as_slice());
                if !modes::may_rest(system, &mut self.sampler, end, (switch, value.signum())) {
                    return Ok(Some(Interruption::Leaves { switch, side: value.signum() }));
                }
                self.scanner.crossings.retain(|crossing| crossing.function != function);
            }
        }
        let crossings = std::mem::take(&mut self.scanner.crossings);
        let first = crossings.iter().find(|crossing| match self.sampler.switch(crossing.function) {
            Some(switch) => !self.time_only[switch],
            None => {
                let event = &system.description().events[crossing.function];
                let ends = event.actions.iter().any(|action| *action != Action::Record);
                ends && counts(event.direction, crossing.rising) && {
                    self.sampler.along(system, segment, crossing.theta);
                    self.sampler.condition(crossing.function) > 0.0
                }
            }
        });
        let first = first.copied();
        self.scanner.crossings = crossings;
        let undefined = |switch: &usize| self.scanner.is_undefined(self.sampler.function_of(*switch));
        if let (None, Some(switch)) = (first, (0..self.surface.len()).find(undefined)) {
            let function = self.sampler.function_of(switch);
            let t = segment.t + segment.h * first_undefined(&mut self.sampler, system, segment, function);
            return Err(modes::no_number(system, switch, t).into());
        }
        Ok(first.map(|crossing| match self.sampler.switch(crossing.function) {
            Some(switch) if crossing.theta == 0.0 => {
                segment.evaluate(0.0, &mut self.y);
                let slides = system.sliding().iter().position(|other| *other == switch);
                let above = match slides.zip(fractions(system, segment.t, &self.y)) {
                    Some((place, w)) => w[place] > 0.5,
                    None => crossing.rising,
                };
                Interruption::Leaves { switch, side: if above { 1.0 } else { -1.0 } }
            }
            _ => Interruption::At(crossing),
        }))
    }

    /// How long, s, a step is to be instead of the one scanned last, so that what happens near its start is not hidden or blurred by its
    /// far end; `None` where nothing does.
    pub fn early(&self, segment: &Segment<'_>) -> Option<f64> {
        self.scanner.early().map(|part| part * segment.h).filter(|shorter| segment.t + shorter > segment.t)
    }

    /// Just behind the first jump of a function over zero within a step, 0 to 1; `None` where there is none.
    ///
    /// # Errors
    /// A function that oscillates too fast.
    pub fn beyond<S: System + ?Sized>(
        &mut self,
        system: &S,
        function: usize,
        segment: &Segment<'_>,
    ) -> Result<Option<f64>, Box<Cause>> {
        self.scanner.restart();
        self.scanner.scan(&mut self.sampler, &mut self.arguments, system, segment)?;
        let mut jumps =
            self.scanner.crossings.iter().filter(|crossing| crossing.function == function && crossing.jumps);
        Ok(jumps.next().map(|crossing| crossing.theta))
    }

    /// A function's value at a state, and its rate there along the step that ends in it.
    pub fn value_and_rate<S: System + ?Sized>(
        &mut self,
        system: &S,
        function: usize,
        segment: &Segment<'_>,
        end: &[f64],
    ) -> (f64, f64) {
        let (_, slope) = self.sampler.sample(system, segment, function, 1.0);
        self.sampler.at_state(system, segment.t + segment.h, end);
        (self.sampler.value(function), slope / segment.h)
    }

    /// A function's value at a state.
    pub fn value_at<S: System + ?Sized>(&mut self, system: &S, function: usize, (t, y): (f64, &[f64])) -> f64 {
        self.sampler.at_state(system, t, y);
        self.sampler.value(function)
    }

    /// Whether a function is zero where something stops that slides in space.
    pub fn may_stop_in_space<S: System + ?Sized>(&self, system: &S, function: usize) -> bool {
        self.sampler.switch(function).is_none() && sample::is_told_later(system, function)
    }

    /// Notes that a step without dense output was taken, of h seconds.
    pub fn step(&mut self, h: f64) {
        self.step = h;
    }

    /// The length of the last step, s.
    pub fn last_step(&self) -> f64 {
        self.step
    }

    /// Notes what is recorded within a step that nothing ended.
    pub fn pass<S: System + ?Sized>(&mut self, system: &S, segment: &Segment<'_>, recorder: &mut impl Log) {
        self.record(system, segment, recorder, &[]);
        self.note(system, recorder, &[]);
        self.scanner.advance(segment.t + segment.h);
        self.step = segment.h;
    }

    /// Functions that cross zero together with another one, it included, in file order.
    pub fn simultaneous(&self, crossing: Crossing, segment: &Segment<'_>) -> Vec<Crossing> {
        let resolution = (1e-11 * crossing.theta).max(8.0 * f64::EPSILON * segment.t.abs() / segment.h);
        let near = |other: &&Crossing| {
            let timed = self.sampler.switch(other.function).is_some_and(|switch| self.time_only[switch]);
            (other.theta - crossing.theta).abs() <= resolution && !timed
        };
        let mut together: Vec<Crossing> = self.scanner.crossings.iter().filter(near).copied().collect();
        together.sort_by_key(|crossing| crossing.function);
        together.dedup_by_key(|crossing| crossing.function);
        together
    }

    /// Notes what is recorded within a step that ends at these crossings, before they fire.
    ///
    /// # Errors
    /// A function that oscillates too fast.
    pub fn record_before<S: System + ?Sized>(
        &mut self,
        system: &S,
        segment: &Segment<'_>,
        recorder: &mut impl Log,
        together: &[Crossing],
    ) -> Result<(), Box<Cause>> {
        self.scanner.restart();
        self.monitors.forget();
        self.scanner.scan(&mut self.sampler, &mut self.arguments, system, segment)?;
        self.record(system, segment, recorder, together);
        self.note(system, recorder, together);
        self.scanner.advance(segment.t + segment.h);
        self.step = self.step.max(segment.h);
        Ok(())
    }

    /// Fires the events that cross zero together at this state, and notes which switches do; returns those that do more
    /// than being recorded, in file order.
    pub fn fire<S: System + ?Sized>(
        &mut self,
        system: &S,
        together: &[Crossing],
        (t, y): (f64, &[f64]),
        recorder: &mut impl Log,
    ) -> Vec<Fired> {
        self.forget_surfaces();
        let mut switches =
            together.iter().map(|crossing| crossing.function).filter(|f| self.sampler.switch(*f).is_some()).peekable();
        if switches.peek().is_some() {
            self.within_rounding = switches.all(|function| self.scanner.has_not_left(function, REST));
        }
        self.scanner.restart();
        self.monitors.forget();
        let mut fired = Vec::new();
        for crossing in together {
            self.scanner.sides[crossing.function] = if crossing.rising { 1.0 } else { -1.0 };
            self.scanner.refresh(crossing.function);
            if let Some(switch) = self.sampler.switch(crossing.function) {
                if crossing.jumps {
                    self.beyond[switch] = Some(self.scanner.sides[crossing.function]);
                } else {
                    self.surface[switch] = true;
                }
                continue;
            }
            self.sampler.at_state(system, t, y);
            self.scanner.zero[crossing.function] = self.surface_of(system, crossing.function, (t, y));
            let event = &system.description().events[crossing.function];
            if counts(event.direction, crossing.rising) && self.sampler.condition(crossing.function) > 0.0 {
                self.logged[crossing.function] = t;
                if !sample::is_told_later(system, crossing.function) {
                    recorder.event(system, crossing.function, t, y, event.actions.contains(&Action::Stop));
                }
                if event.actions.iter().any(|action| *action != Action::Record) {
                    let (event, actions) = (crossing.function, event.actions.to_vec());
                    fired.push(Fired { event, actions, pending: false });
                }
            }
        }
        fired
    }

    /// Records an event that happens where a phase begins.
    pub fn record_one<S: System + ?Sized>(
        &mut self,
        system: &S,
        event: usize,
        (t, y): (f64, &[f64]),
        ends: bool,
        recorder: &mut impl Log,
    ) {
        self.logged[event] = t;
        if !sample::is_told_later(system, event) {
            recorder.event(system, event, t, y, ends);
        }
    }
}

fn ends_meet<S: System + ?Sized>(system: &S, index: usize, t: f64) -> Cause {
    Cause::EndsMeet { load: system.description().arguments[index].load.to_string(), t }
}

fn counts(direction: Direction, rising: bool) -> bool {
    match direction {
        Direction::Both => true,
        Direction::Rising => rising,
        Direction::Falling => !rising,
    }
}

/// Where a function that is no number somewhere in a step ceases to be one, 0 to 1.
fn first_undefined<S: System + ?Sized>(
    sampler: &mut Sampler,
    system: &S,
    segment: &Segment<'_>,
    function: usize,
) -> f64 {
    let mut is_undefined = |theta: f64| sampler.sample(system, segment, function, theta).0.is_nan();
    if is_undefined(0.0) {
        return 0.0;
    }
    let (mut known, mut undefined) = (0.0, if is_undefined(0.5) { 0.5 } else { 1.0 });
    while undefined - known > f64::EPSILON {
        let middle = 0.5 * (known + undefined);
        if is_undefined(middle) { undefined = middle } else { known = middle }
    }
    undefined
}
