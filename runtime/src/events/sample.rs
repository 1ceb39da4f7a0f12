//! Event functions and arguments of switches at states and along steps.

use super::certify::Sample;
use crate::constrain::{Moment, approaches, closed_within, held_direction, unresolved_rates, where_shared};
use crate::integrate::Segment;
use crate::mechanism::dense::constraint_triples;
use crate::mechanism::sliding::fractions;
use crate::mechanism::{Action, At, ContactEvent, Rated, System};

/// Evaluates the watched functions: the events' first, then the switches' arguments.
#[derive(Clone, Debug)]
pub(crate) struct Sampler {
    n: usize,
    events: usize,
    switches: usize,
    /// What is known of events' rates; where it is nothing they are differences.
    rated: Vec<Rated>,
    y: Vec<f64>,
    dy: Vec<f64>,
    a: Vec<f64>,
    /// Pairs (value, condition) of the events, then (value, rate) of the switches.
    pairs: Vec<f64>,
    rates: Vec<f64>,
    /// How often the functions were evaluated.
    pub samples: u64,
}

/// What a function does near the start of a step is seen in a piece in which it changes by no more than so many times what its value and
/// its slope there say.
pub(super) const SHOWN: f64 = 16.0;
/// Pieces towards the start of a step are this part of each other, and no shorter than that part of the step: below it dense output,
/// which is rounded at ε of what the step changes, tells nothing.
pub(super) const PART: f64 = 1.0 / 16.0;
pub(super) const SHORTEST: f64 = f64::EPSILON;
/// An event's function that comes to its zero within this part of the time is at it: no other time is told apart.  Where that is 0 it is
/// that part of the first step, so that a place which is zero but for the rounding of its formula (`sin(pi)`) is at it.
const OF_TIME: f64 = 4.0 * f64::EPSILON;
const OF_STEP: f64 = 64.0 * f64::EPSILON;
/// How far ahead a function at its zero is asked for its side, in parts of the step.
const AHEAD: f64 = 1e-4;
/// How much further where that shows nothing but rounding.
const FURTHER: [f64; 3] = [1.0, 10.0, 100.0];
/// What a function does at the start of a motion is rounding up to so many times what rounding makes of its zero.
const EXPLAINED: f64 = 16.0;
/// A rate that changes a function by less than this part of its largest value in a step is none.
const STILL: f64 = 1e-15;
/// A change this small beside the values is rounding.
const LEAVES: f64 = 1e-3;
/// The step of a difference, in parts of the step, for functions whose rate is not known.
const DIFFERENCE: f64 = 1e-5;
/// By how much of itself a number of the state is moved to see what its rounding does.
const ROUNDINGS: f64 = 4.0 * f64::EPSILON;

impl Sampler {
    /// Makes room.
    pub fn new<S: System + ?Sized>(system: &S) -> Self {
        let n = system.len();
        let description = system.description();
        let (events, switches) = (description.events.len(), description.switches.len());
        Sampler {
            n,
            events,
            switches,
            rated: description.events.iter().map(|event| event.rated).collect(),
            y: vec![0.0; 2 * n],
            dy: vec![0.0; 2 * n],
            a: vec![0.0; n],
            pairs: vec![0.0; 2 * (events + switches)],
            rates: vec![0.0; events],
            samples: 0,
        }
    }

    /// How many functions are watched.
    pub fn len(&self) -> usize {
        self.events + self.switches
    }

    /// How many of them are events.
    pub fn events(&self) -> usize {
        self.events
    }

    /// To which side an event's function leaves its zero at a state, seen a little ahead; 0 if it stays.
    pub fn leaves<S: System + ?Sized>(
        &mut self,
        system: &S,
        event: usize,
        (t, y): (f64, &[f64]),
        (step, largest, hit): (f64, f64, bool),
    ) -> f64 {
        self.at_state(system, t, y);
        let before = self.value(event);
        // Which contacts stay closed is decided: one that does not leaves as its rate says.
        if let Some(contact) = closes(system, event) {
            // What does not approach was decided to open.
            let moment = Moment { t, y, scales: &[], fastest: &[], step };
            return if approaches(system, &moment, contact) { -1.0 } else { 1.0 };
        }
        // What slides was decided to go where its mode says.
        if let Some(side) = slides(system, event) {
            return side;
        }
        if hit && self.rated[event] == Rated::Whole && (self.rates[event] * step).abs() > STILL * largest {
            // What was struck leaves as its rate says, however low it hops.
            return self.rates[event].signum();
        }
        let rounding = self.rounding_at(system, event, (t, y));
        // So little ahead a foot that lifts off may have moved by less than its place is rounded: then further.
        for ahead in FURTHER.map(|times| times * AHEAD * step) {
            let moved = self.moved(system, (t, y), ahead);
            self.at_state(system, t + ahead, &moved);
            let change = self.value(event) - before;
            if change.abs() > rounding {
                let size = self.value(event).abs().max(before.abs());
                return if change.abs() > LEAVES * size { change.signum() } else { 0.0 };
            }
        }
        0.0
    }

    /// Σ |terms| of an event's function, and how far from 0 it is closed, where it is the gap of a contact.
    pub fn terms_of_gap<S: System + ?Sized>(
        &self,
        system: &S,
        event: usize,
        (t, y): (f64, &[f64]),
    ) -> Option<(f64, f64)> {
        let row = system.contacts().all[closes(system, event)?].normal? as usize;
        let at = At::packed(t, y, self.n);
        Some((constraint_triples(system, at)[row][2], closed_within(system, at, &[])[row]))
    }

    /// By how much an event's function would change in a step, seen a little ahead.
    pub fn variation<S: System + ?Sized>(&mut self, system: &S, event: usize, (t, y): (f64, &[f64]), step: f64) -> f64 {
        self.at_state(system, t, y);
        let before = self.value(event);
        let moved = self.moved(system, (t, y), AHEAD * step);
        self.at_state(system, t + AHEAD * step, &moved);
        (self.value(event) - before).abs() / AHEAD
    }

    /// The state a little later, by one step of Runge and Kutta's method of order 4: where speeds and accelerations have no part in
    /// how a zero is left, as where a foot lifts off, the third derivative has.
    fn moved<S: System + ?Sized>(&mut self, system: &S, (t, y): (f64, &[f64]), h: f64) -> Vec<f64> {
        let n = self.n;
        let mut slopes: [Vec<f64>; 4] = Default::default();
        for stage in 0..4 {
            let part = [0.0, 0.5, 0.5, 1.0][stage] * h;
            let at: Vec<f64> = match stage.checked_sub(1) {
                None => y.to_vec(),
                Some(before) => y.iter().zip(&slopes[before]).map(|(y, slope)| y + part * slope).collect(),
            };
            if system.accelerations(At::packed(t + part, &at, n), &mut self.a).is_err() {
                self.a.fill(f64::NAN);
            }
            slopes[stage] = at[n..].iter().chain(&self.a).copied().collect();
        }
        let [k1, k2, k3, k4] = &slopes;
        (0..2 * n).map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i])).collect()
    }

    /// The index of a switch if the function is one.
    pub fn switch(&self, function: usize) -> Option<usize> {
        function.checked_sub(self.events)
    }

    /// The function of a switch.
    pub fn function_of(&self, switch: usize) -> usize {
        self.events + switch
    }

    /// The value of a function after the last evaluation.
    pub fn value(&self, function: usize) -> f64 {
        self.pairs[2 * function]
    }

    /// The rate of a switch's argument, 1/s, after the last evaluation.
    pub fn rate(&self, switch: usize) -> f64 {
        self.pairs[2 * self.function_of(switch) + 1]
    }

    /// The rate of an event's function, 1/s, after the last evaluation; 0 where it is not known.
    pub fn rate_of(&self, event: usize) -> f64 {
        if self.rated[event] == Rated::Whole { self.rates[event] } else { 0.0 }
    }

    /// What is zero of an event's function where a motion starts with a step of `step`: what rounding makes of it, and what it changes
    /// by in no time.
    pub fn zero_at_start<S: System + ?Sized>(
        &mut self,
        system: &S,
        event: usize,
        (t, y): (f64, &[f64]),
        step: f64,
    ) -> f64 {
        self.at_state(system, t, y);
        let rate = match self.rated[event] {
            Rated::Whole => self.rates[event].abs(),
            _ => self.variation(system, event, (t, y), step) / step,
        };
        let change = rate * if t == 0.0 { OF_STEP * step } else { OF_TIME * t.abs() };
        self.at_state(system, t, y);
        let zero = self.rounding_at(system, event, (t, y));
        if change.is_finite() { zero.max(change) } else { zero }
    }

    /// To which side an event's function that is `zero` at the start leaves it at first: as its rate says where that explains what it does
    /// in the shortest time, of up to `span` seconds, in which it shows more than that; 0 where it stays.
    pub fn leaves_at_start<S: System + ?Sized>(
        &mut self,
        system: &S,
        (event, zero): (usize, f64),
        (t, y): (f64, &[f64]),
        span: f64,
    ) -> f64 {
        self.at_state(system, t, y);
        let (start, rate) = (self.value(event), self.rate_of(event));
        let (mut ahead, mut side) = (span, 0.0);
        while t + ahead > t && ahead > SHORTEST * span {
            let moved = self.moved(system, (t, y), ahead);
            self.at_state(system, t + ahead, &moved);
            let change = self.value(event) - start;
            if change.is_finite() {
                if change.abs() <= EXPLAINED * zero || change == 0.0 {
                    break;
                }
                side = change.signum();
                if change.abs() <= SHOWN * rate.abs() * ahead {
                    return rate.signum();
                }
            }
            ahead *= PART;
        }
        side
    }

    /// An event's condition after the last evaluation.
    pub fn condition(&self, event: usize) -> f64 {
        self.pairs[2 * event + 1]
    }

    /// Evaluates all functions at a state, with its own accelerations.
    pub fn at_state<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        if system.accelerations(At::packed(t, y, self.n), &mut self.a).is_err() {
            self.a.fill(f64::NAN);
        }
        self.evaluate(system, t, y);
    }

    /// Evaluates what depends on time alone; everything else is meaningless.
    pub fn at_time<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        self.samples += 1;
        let at = At::packed(t, y, self.n).accelerated(&self.a);
        system.switches(at, &mut self.pairs[2 * self.events..]);
    }

    /// Evaluates all functions on the dense output of a step, with the accelerations that its slope gives.
    pub fn along<S: System + ?Sized>(&mut self, system: &S, segment: &Segment<'_>, theta: f64) {
        let (mut y, mut dy) = (std::mem::take(&mut self.y), std::mem::take(&mut self.dy));
        segment.evaluate_with_slope(theta, &mut y, &mut dy);
        for (a, slope) in self.a.iter_mut().zip(&dy[self.n..]) {
            *a = slope / segment.h;
        }
        self.evaluate(system, segment.t + theta * segment.h, &y);
        (self.y, self.dy) = (y, dy);
    }

    /// A function's value and its slope by θ along a step.
    pub fn sample<S: System + ?Sized>(
        &mut self,
        system: &S,
        segment: &Segment<'_>,
        function: usize,
        theta: f64,
    ) -> (f64, f64) {
        let slides = self.switch(function).is_some_and(|switch| system.sliding().contains(&switch));
        let rated = if slides { Rated::Unknown } else { self.rated.get(function).copied().unwrap_or(Rated::Whole) };
        if rated == Rated::Held {
            self.along(system, segment, theta);
            if let Some(rate) = self.rate_of_solved(system, segment.t + theta * segment.h, function, segment.h) {
                return (self.value(function), segment.h * rate);
            }
        }
        if rated != Rated::Whole {
            // Near the start of a step it is no more than a part of the way.
            let part = if theta > 0.0 { DIFFERENCE.min(0.1 * theta) } else { DIFFERENCE };
            self.along(system, segment, theta + part);
            let after = self.value(function);
            self.along(system, segment, theta - part);
            let before = self.value(function);
            self.along(system, segment, theta);
            return (self.value(function), (after - before) / (2.0 * part));
        }
        self.along(system, segment, theta);
        (self.value(function), self.slope(function, segment.h))
    }

    /// By how much a function may change by the rounding of the state, within a step: the least of both ends, since one
    /// of them may be where it jumps.
    pub fn rounding<S: System + ?Sized>(&mut self, system: &S, segment: &Segment<'_>, function: usize) -> f64 {
        let ends = [0.0, 1.0].map(|theta| {
            self.along(system, segment, theta);
            self.y.clone()
        });
        // Between the ends a state is as exact as the larger of them.
        let sizes: Vec<f64> = ends[0].iter().zip(&ends[1]).map(|(a, b)| a.abs().max(b.abs())).collect();
        let mut least = f64::INFINITY;
        for (y, t) in ends.iter().zip([segment.t, segment.t + segment.h]) {
            least = least.min(self.rounding_about(system, function, (t, y), &sizes));
        }
        if least.is_finite() { least } else { 0.0 }
    }

    /// By how much a function may change by the rounding of a state, its accelerations being those evaluated last.
    pub fn rounding_at<S: System + ?Sized>(&mut self, system: &S, function: usize, (t, y): (f64, &[f64])) -> f64 {
        self.rounding_about(system, function, (t, y), y)
    }

    /// The same for a state that is as exact as numbers of these sizes.
    fn rounding_about<S: System + ?Sized>(
        &mut self,
        system: &S,
        function: usize,
        (t, y): (f64, &[f64]),
        sizes: &[f64],
    ) -> f64 {
        self.evaluate(system, t, y);
        let (mut near, value) = (y.to_vec(), self.value(function));
        let mut sum = 0.0;
        for i in 0..y.len() {
            for moved in [y[i] - ROUNDINGS * sizes[i], y[i] + ROUNDINGS * sizes[i]] {
                near[i] = moved;
                self.evaluate(system, t, &near);
                sum += (self.value(function) - value).abs();
            }
            near[i] = y[i];
        }
        for moved in [t * (1.0 - ROUNDINGS), t * (1.0 + ROUNDINGS)] {
            self.evaluate(system, moved, y);
            sum += (self.value(function) - value).abs();
        }
        // Bodies that touch far from where places are measured from have a gap that is the difference of these places.
        let event = Some(function).filter(|function| *function < system.description().events.len());
        let terms = event.and_then(|event| self.terms_of_gap(system, event, (t, y)));
        sum + terms.map_or(0.0, |(terms, _)| ROUNDINGS * terms)
    }

    /// The accelerations of the last state that was evaluated with its own.
    pub fn accelerations(&self) -> &[f64] {
        &self.a
    }

    /// By how much each acceleration may change by the rounding of a state.
    pub fn rounding_of_accelerations<S: System + ?Sized>(&mut self, system: &S, (t, y): (f64, &[f64])) -> Vec<f64> {
        self.at_state(system, t, y);
        let (mut near, usual) = (y.to_vec(), self.a.clone());
        let mut sums = vec![0.0; self.n];
        for i in 0..y.len() {
            for moved in [y[i] * (1.0 - ROUNDINGS), y[i] * (1.0 + ROUNDINGS)] {
                near[i] = moved;
                self.at_state(system, t, &near);
                for (sum, (a, usual)) in sums.iter_mut().zip(self.a.iter().zip(&usual)) {
                    *sum += (a - usual).abs();
                }
            }
            near[i] = y[i];
        }
        sums
    }

    /// Samples of all functions at a place of a step.
    pub fn samples<S: System + ?Sized>(
        &mut self,
        system: &S,
        segment: &Segment<'_>,
        theta: f64,
        samples: &mut Vec<Sample>,
    ) {
        samples.clear();
        if !system.sliding().is_empty() || self.rated.iter().any(|rated| *rated != Rated::Whole) {
            for function in 0..self.len() {
                let (value, slope) = self.sample(system, segment, function, theta);
                samples.push(Sample { x: theta, value, slope });
            }
            return;
        }
        self.along(system, segment, theta);
        for function in 0..self.len() {
            samples.push(Sample { x: theta, value: self.value(function), slope: self.slope(function, segment.h) });
        }
    }

    /// The rate of an event's function, 1/s, at the state that was evaluated last; what accelerations and multipliers
    /// have in it by a difference along their own rates, exact where it is linear in them.
    fn rate_of_solved<S: System + ?Sized>(&mut self, system: &S, t: f64, event: usize, step: f64) -> Option<f64> {
        let (n, rows) = (self.n, system.description().rows.len());
        let [mut a, mut jerk] = [vec![0.0; n], vec![0.0; n]];
        let [mut lambda, mut change] = [vec![0.0; rows], vec![0.0; rows]];
        let at = At::packed(t, &self.y, n);
        system.accelerations_and_multipliers(at, &mut a, &mut lambda).ok()?;
        if !system.motion_rates(at.accelerated(&a).constrained(&lambda), &mut jerk, &mut change) {
            return None;
        }
        let mut pairs = vec![0.0; 2 * self.events];
        let ahead = AHEAD * step;
        let mut moved = |part: f64| {
            let a: Vec<f64> = a.iter().zip(&jerk).map(|(a, rate)| a + part * rate).collect();
            let lambda: Vec<f64> = lambda.iter().zip(&change).map(|(x, rate)| x + part * rate).collect();
            system.events(at.accelerated(&a).constrained(&lambda), &mut pairs);
            pairs[2 * event]
        };
        let solved = (moved(ahead) - moved(-ahead)) / (2.0 * ahead);
        let mut held = vec![0.0; self.events];
        system.event_rates(at.accelerated(&a).constrained(&lambda), &mut held);
        let rate = held[event] + solved;
        rate.is_finite().then_some(rate)
    }

    fn slope(&self, function: usize, h: f64) -> f64 {
        let rate = match self.switch(function) {
            Some(_) => self.pairs[2 * function + 1],
            None => self.rates[function],
        };
        h * rate
    }

    fn evaluate<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        self.samples += 1;
        let at = At::packed(t, y, self.n).accelerated(&self.a);
        let (events, switches) = self.pairs.split_at_mut(2 * self.events);
        if self.events > 0 {
            // What is shared has the share that keeps it longest.
            match where_shared(system, at) {
                Some((_, lambda)) => system.events(at.constrained(&lambda), events),
                None => system.events(at, events),
            }
            system.event_rates(at, &mut self.rates);
        }
        if self.switches > 0 {
            system.switches(at, switches);
            if let Some(w) = (!system.sliding().is_empty()).then(|| fractions(system, t, y)) {
                // 1 − σ², the place between the sides; it leaves the surface where that is zero.
                for (k, switch) in system.sliding().iter().enumerate() {
                    let margin = w.as_ref().map_or(f64::NAN, |w| 4.0 * w[k] * (1.0 - w[k]));
                    switches[2 * switch..2 * switch + 2].copy_from_slice(&[margin, 0.0]);
                }
            }
        }
    }
}

/// Where a contact slides whose rate of sliding is an event's function.
pub(super) fn slides<S: System + ?Sized>(system: &S, event: usize) -> Option<f64> {
    let [Action::Contact(contact)] = system.description().events[event].actions[..] else { return None };
    let contact = contact as usize;
    let stops = system.contacts().all[contact].happened(event) == Some(ContactEvent::Stops);
    stops.then(|| system.contacts().modes(system.phase())[contact].sliding()).filter(|side| *side != 0.0)
}

/// The rate of sliding below which contacts have not begun to slide, where that rate is an event's function: the instant at which they begin is known no
/// better; 0 for other events.
pub(super) fn least_rates<S: System + ?Sized>(system: &S, (t, y): (f64, &[f64]), step: f64) -> Vec<f64> {
    let events = &system.description().events;
    if !(0..events.len()).any(|event| slides(system, event).is_some()) {
        return vec![0.0; events.len()];
    }
    let unresolved = unresolved_rates(system, &Moment { t, y, scales: &[], fastest: &[], step });
    let of = |event: usize| match events[event].actions[..] {
        [Action::Contact(contact)] if slides(system, event).is_some() => {
            unresolved[contact as usize].max(held_direction(system, contact as usize)[2])
        }
        _ => 0.0,
    };
    (0..events.len()).map(of).collect()
}

/// Whether an event is told of by what decides it: what slides in space may stop, or have turned.
pub(super) fn is_told_later<S: System + ?Sized>(system: &S, event: usize) -> bool {
    let [Action::Contact(contact)] = system.description().events[event].actions[..] else { return false };
    let known = &system.contacts().all[contact as usize];
    known.direction.is_some() && known.happened(event) == Some(ContactEvent::Stops)
}

/// Whether an event is the end of a slip, in the direction that was decided when that began.
pub(super) fn ends_slip<S: System + ?Sized>(system: &S, event: usize) -> bool {
    let [Action::Contact(contact)] = system.description().events[event].actions[..] else { return false };
    system.contacts().all[contact as usize].happened(event) == Some(ContactEvent::Stops)
}

/// Whether an event ends what a contact holds by a force.
pub(super) fn ends_hold<S: System + ?Sized>(system: &S, event: usize) -> bool {
    let [Action::Contact(contact)] = system.description().events[event].actions[..] else { return false };
    let what = system.contacts().all[contact as usize].happened(event);
    matches!(what, Some(ContactEvent::Lifts | ContactEvent::Slips))
}

/// The contact whose gap is an event's function.
fn closes<S: System + ?Sized>(system: &S, event: usize) -> Option<usize> {
    let [Action::Contact(contact)] = system.description().events[event].actions[..] else { return None };
    let contact = contact as usize;
    (system.contacts().all[contact].happened(event) == Some(ContactEvent::Lands)).then_some(contact)
}
