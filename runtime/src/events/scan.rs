//! What the watched functions do within a step.

use super::arguments::{Arguments, Course};
use super::certify::{Certifier, MOST_SAMPLES, Sample, ZeroKind};
use super::sample::{PART, SHORTEST, SHOWN, Sampler, ends_hold, ends_slip};
use crate::cause::{Cause, TooFast};
use crate::integrate::Segment;
use crate::mechanism::{Direction, System, Watched};

/// A function passes through zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// Which function.
    pub function: usize,
    /// Where in the step, 0 to 1.
    pub theta: f64,
    /// True when it goes from below to above.
    pub rising: bool,
    /// True when it jumps there, or has a pole: θ is just beyond.
    pub jumps: bool,
}

/// Something of an event's function that is no crossing, and worth a word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Oddity {
    /// Which function.
    pub function: usize,
    /// When, s.
    pub t: f64,
    /// What.
    pub kind: ZeroKind,
}

/// On which side of zero each function is: −1 or 1, or 0 while it has not left zero.
#[derive(Clone, Debug)]
pub(crate) struct Scanner {
    /// The sides at the start of the step.
    pub sides: Vec<f64>,
    /// The sides at its end, if nothing happens in between.
    pub end_sides: Vec<f64>,
    /// Functions that were at zero when the integration (re)started, and have not left it.
    pub fresh: Vec<bool>,
    /// Those that will not have at the end of the step.
    lingers: Vec<bool>,
    /// Those that were at zero for a whole step.
    rested: Vec<bool>,
    /// Which are those of events that change phases or speeds, and have a direction: they happen where they leave zero in it.
    acts: Vec<bool>,
    /// What is zero of them, as far as is known where they were last seen there.
    pub zero: Vec<f64>,
    /// To which side these leave it, where their rates tell; 0 where they do not.
    pub leaving: Vec<f64>,
    /// The largest size of each function in the steps that were taken, poles left aside.
    largest: Vec<f64>,
    /// The same in the step that was scanned last.
    size: Vec<f64>,
    /// Events of other phases, and ignored ones, are not looked at.
    asleep: Vec<bool>,
    ignored: Vec<bool>,
    certifier: Certifier,
    /// Samples to begin with.
    grid: Vec<Sample>,
    /// All functions at the start, the middle and the end of the step.
    start: Vec<Sample>,
    middle: Vec<Sample>,
    end: Vec<Sample>,
    /// Where the step ended whose end is in `end`, and how long it was, s.
    ends: f64,
    length: f64,
    /// In which part of the step scanned last something happens that its far end may hide or blur; `None` where nothing does.
    early: Option<f64>,
    /// How often in a row a step was made shorter for what begins there.
    shortened: u32,
    /// Which functions have arguments inside that must be looked at.
    inside: Vec<bool>,
    /// Which are those of events that end what a contact holds by a force.
    holds: Vec<bool>,
    /// Which leave zero to a side that was decided beforehand, for good: those of switches, and of events that end a slip.  A gap that opens may
    /// close again by its rounding.
    decided: Vec<bool>,
    /// Zeros of the last scan, in order of time, then of function.
    pub crossings: Vec<Crossing>,
    /// What else the last scan found.
    pub anomalies: Vec<Oddity>,
}

/// A value this small against the variation near the start of a step is zero where a switch was on its surface.
const ZERO: f64 = 1e-13;
/// What is bent away like a power of θ changes by its slope times θ over one of these.
const POWERS: std::ops::Range<f64> = 0.9..8.5;
/// So many roundings of the time a surface is known to, at the least.
const ROUNDINGS: f64 = 64.0;
/// A place this part of itself behind a jump is beyond it, rounding and all.
const BEYOND: f64 = 1024.0 * f64::EPSILON;
/// A step that does not show where a function leaves zero is made so much shorter, and so often at the most: rounding shows it no better.
const SHORTER: f64 = 0.1;
const SHORTENED: u32 = 6;
/// Nor does a step of so many roundings of the time.
const RESOLVED: f64 = 1e4;
/// A change that is larger than the others by this is beside a pole.
const POLE: f64 = 1e8;

impl Scanner {
    /// For the functions of a system.
    pub fn new<S: System + ?Sized>(system: &S, sampler: &Sampler) -> Self {
        let functions = sampler.len();
        let inside = (0..functions).map(|function| {
            let of = watched(sampler, function);
            system.description().arguments.iter().any(|argument| argument.of == of)
        });
        let holds = (0..functions).map(|function| function < sampler.events() && ends_hold(system, function));
        let decided = (0..functions).map(|function| function >= sampler.events() || ends_slip(system, function));
        let acts = (0..functions).map(|function| {
            let event = system.description().events.get(function).filter(|_| function < sampler.events());
            event.is_some_and(|event| event.changes_motion() && event.direction != Direction::Both)
        });
        Scanner {
            sides: vec![0.0; functions],
            end_sides: vec![0.0; functions],
            fresh: vec![true; functions],
            lingers: vec![false; functions],
            rested: vec![false; functions],
            acts: acts.collect(),
            zero: vec![0.0; functions],
            leaving: vec![0.0; functions],
            largest: vec![0.0; functions],
            size: vec![0.0; functions],
            asleep: vec![false; functions],
            ignored: vec![false; functions],
            certifier: Certifier::default(),
            grid: Vec::new(),
            start: Vec::with_capacity(functions),
            middle: Vec::with_capacity(functions),
            end: Vec::with_capacity(functions),
            ends: f64::NAN,
            length: 1.0,
            early: None,
            shortened: 0,
            inside: inside.collect(),
            holds: holds.collect(),
            decided: decided.collect(),
            crossings: Vec::with_capacity(2 * functions),
            anomalies: Vec::new(),
        }
    }

    /// Finds what happens within a step.
    ///
    /// # Errors
    /// [`Cause::OscillatesTooFast`] names a function that would need too many samples.
    pub fn scan<S: System + ?Sized>(
        &mut self,
        sampler: &mut Sampler,
        arguments: &mut Arguments,
        system: &S,
        segment: &Segment<'_>,
    ) -> Result<(), Box<Cause>> {
        if self.ends == segment.t && !self.end.is_empty() {
            // The end of the last step, seen over the length of this one.
            std::mem::swap(&mut self.start, &mut self.end);
            let factor = segment.h / self.length;
            for sample in &mut self.start {
                *sample = Sample { x: 0.0, value: sample.value, slope: sample.slope * factor };
            }
        } else {
            sampler.samples(system, segment, 0.0, &mut self.start);
        }
        sampler.samples(system, segment, 0.5, &mut self.middle);
        sampler.samples(system, segment, 1.0, &mut self.end);
        self.length = segment.h;
        self.ends = f64::NAN;
        self.crossings.clear();
        self.anomalies.clear();
        self.early = None;
        for function in 0..self.sides.len() {
            if !self.asleep[function] {
                self.function(function, sampler, arguments, system, segment)?;
            }
        }
        self.crossings.sort_by(|a, b| a.theta.total_cmp(&b.theta).then(a.function.cmp(&b.function)));
        self.shortened = if self.early.is_some() { self.shortened + 1 } else { 0 };
        Ok(())
    }

    /// Looks at the function of a switch from here on, or does not while the constraints in force hold it at its surface.
    pub fn look_at(&mut self, function: usize, looks: bool) {
        self.asleep[function] = !looks;
    }

    /// Takes note of which events count in the phase in force: not those that `never` happen there.
    pub fn activate<S: System + ?Sized>(&mut self, system: &S, never: &[usize]) {
        let phase = system.phase() as u32;
        let events = system.description().events.iter().zip(&self.ignored);
        for (asleep, (event, ignored)) in self.asleep.iter_mut().zip(events) {
            *asleep = *ignored || event.phases.as_ref().is_some_and(|phases| !phases.contains(&phase));
        }
        never.iter().for_each(|event| self.asleep[*event] = true);
    }

    /// Never looks at an event.
    pub fn ignore(&mut self, event: usize) {
        self.ignored[event] = true;
    }

    /// Whether a function is never looked at.
    pub fn is_ignored(&self, function: usize) -> bool {
        self.ignored[function]
    }

    /// Whether a function is looked at.
    pub fn awake(&self, function: usize) -> bool {
        !self.asleep[function]
    }

    /// The largest size of a function that was met, in the step that was scanned last too.
    pub fn largest(&self, function: usize) -> f64 {
        self.largest[function].max(self.size[function])
    }

    /// Whether a function stayed within a `part` of the largest that it had, in the step that was scanned last: at its ends, where it may begin and end
    /// at zero, and in its middle.
    pub fn has_not_left(&self, function: usize, part: f64) -> bool {
        self.size[function].max(self.largest_here(function).abs()) <= part * self.largest(function)
    }

    /// The sides at the end of the step become those at the start of the next.
    pub fn advance(&mut self, t: f64) {
        self.largest.iter_mut().zip(&self.size).for_each(|(largest, size)| *largest = largest.max(*size));
        self.sides.copy_from_slice(&self.end_sides);
        self.fresh.copy_from_slice(&self.lingers);
        self.rested.copy_from_slice(&self.lingers);
        // What has not left zero yet leaves it to the side that is known.
        let leaving = self.leaving.iter_mut().zip(&self.lingers);
        leaving.filter(|(_, lingers)| !**lingers).for_each(|(leaving, _)| *leaving = 0.0);
        self.ends = t;
    }

    /// Whether an event is awake that ends what a contact holds by a force: its function was decided not to be negative, but for rounding.
    pub fn holds(&self, event: usize) -> bool {
        self.holds[event] && !self.asleep[event]
    }

    /// Puts an event on the side on which a force holds, if it is at its zero, and its rate does not tell to which side it leaves: where it
    /// falls below, later, it happens.
    pub fn hold(&mut self, event: usize) {
        if self.holds(event) && self.sides[event] == 0.0 && self.leaving[event] == 0.0 {
            self.leaving[event] = 1.0;
        }
    }

    /// Looks at a function as at one that is where it is at the start of a motion.
    pub fn refresh(&mut self, function: usize) {
        self.fresh[function] = true;
        self.rested[function] = false;
    }

    /// Forgets what was seen at the end of the last step: modes or state have changed.
    pub fn restart(&mut self) {
        self.ends = f64::NAN;
        self.size.fill(0.0);
    }

    /// In which part of the step scanned last something happens that its far end may hide or blur; `None` where nothing does.
    pub fn early(&self) -> Option<f64> {
        self.early
    }

    /// The value of a function that is largest in size among the samples of the last scan.
    pub fn largest_here(&self, function: usize) -> f64 {
        let values = [&self.start, &self.middle, &self.end].map(|samples| samples[function].value);
        values.into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0)
    }

    /// Whether a function that is looked at is no number at the start, in the middle or at the end of the step scanned last.
    pub fn is_undefined(&self, function: usize) -> bool {
        let samples = [&self.start, &self.middle, &self.end];
        self.awake(function) && samples.iter().any(|samples| samples[function].value.is_nan())
    }

    /// Finds what one function does.
    fn function<S: System + ?Sized>(
        &mut self,
        function: usize,
        sampler: &mut Sampler,
        arguments: &mut Arguments,
        system: &S,
        segment: &Segment<'_>,
    ) -> Result<(), Box<Cause>> {
        let (start, middle, end) = (self.start[function], self.middle[function], self.end[function]);
        let mut grid = std::mem::take(&mut self.grid);
        self.first_samples(function, sampler, arguments, (system, segment), &mut grid)?;
        let instant = ROUNDINGS * f64::EPSILON * segment.t.abs() / segment.h;
        let zero = if self.fresh[function] { self.zero[function] } else { 0.0 };
        let is_switch = sampler.switch(function).is_some();
        // What a discontinuity of the forces does to the far end of a step, the error of the step shows.
        let (near, divided) = match is_switch {
            true => (variation([start, middle, end]), 0),
            false => towards_start((&mut grid, middle), sampler, (system, segment, function), (zero, instant)),
        };
        // Where an event is zero was found out at the start.
        let known = if is_switch { (ZERO + instant) * near } else { self.zero[function] };
        let floor = self.zero_at_start((function, is_switch), known, &mut grid[0]);
        let mut certifier = std::mem::take(&mut self.certifier);
        let certified = is_certified(&mut certifier, sampler, (system, segment, function), (&grid, middle));
        let marks = self.crossings.len() + self.anomalies.len();
        self.collect((function, is_switch), &certifier, segment, floor);
        if self.crossings.len() + self.anomalies.len() > marks {
            let first = certifier.marks.iter().map(|mark| mark.x).find(|x| floor == 0.0 || *x > 0.0);
            let piece = grid[1..=divided].iter().map(|point| point.x).find(|x| first.is_some_and(|first| first <= *x));
            self.early = [self.early, piece].into_iter().flatten().reduce(f64::min);
        }
        self.certifier = certifier;
        self.grid = grid;
        match certified {
            true => Ok(()),
            false => {
                let limit = TooFast::Samples(MOST_SAMPLES);
                Err(Cause::OscillatesTooFast { function: watched_name(system, sampler, function), limit }.into())
            }
        }
    }

    /// Samples a function where its search begins: at the ends of the step, or where its arguments inside say.
    fn first_samples<S: System + ?Sized>(
        &self,
        function: usize,
        sampler: &mut Sampler,
        arguments: &mut Arguments,
        (system, segment): (&S, &Segment<'_>),
        grid: &mut Vec<Sample>,
    ) -> Result<(), Box<Cause>> {
        let (start, middle, end) = (self.start[function], self.middle[function], self.end[function]);
        let name = || watched_name(system, sampler, function);
        grid.clear();
        if self.inside[function] {
            let course = Course::Step(*segment);
            let places = arguments.places(system, &course, watched(sampler, function));
            for theta in places.ok_or_else(|| Cause::OscillatesTooFast { function: name(), limit: TooFast::Inside })? {
                let known = [start, middle, end].into_iter().find(|sample| sample.x == theta);
                grid.push(known.unwrap_or_else(|| {
                    let (value, slope) = sampler.sample(system, segment, function, theta);
                    Sample { x: theta, value, slope }
                }));
            }
        } else {
            grid.extend([start, end]);
        }
        Ok(())
    }

    /// Takes the first sample of a step as zero where it is zero to rounding, by what is `known` of zero there; up to which size the
    /// function is zero until it has left it.
    fn zero_at_start(&mut self, (function, is_switch): (usize, bool), known: f64, first: &mut Sample) -> f64 {
        let start = self.start[function];
        let mut floor = 0.0;
        if self.fresh[function] && start.value.abs() <= known {
            floor = known;
            self.zero[function] = known;
            first.value = 0.0;
            if !is_switch {
                // An event that is zero where a motion begins has no side until it has left zero; a hop that is too low to
                // be seen is over before the step has well begun.
                self.sides[function] = self.leaving[function];
            }
        }
        // What leaves its surface to a side begins there, on whichever side rounding has put it: a short step does not show that
        // it is rounding, but the longer one before did.
        let side = self.sides[function];
        let leaves = is_switch && start.slope * side > 0.0 && start.value * side < 0.0;
        if self.fresh[function] && leaves && start.value.abs() <= self.zero[function] {
            floor = floor.max(start.value.abs());
            first.value = 0.0;
        }
        floor
    }

    /// Takes over what the certifier marked, from where the function first is beyond `floor`: before, it is zero to
    /// rounding, and has not left the side where it was put.
    fn collect(
        &mut self,
        (function, switches): (usize, bool),
        certifier: &Certifier,
        segment: &Segment<'_>,
        floor: f64,
    ) {
        let mut side = self.sides[function];
        let first = certifier.points().iter().find(|point| point.value.abs() > floor && point.value.is_finite());
        let begins = first.map_or(1.0, |point| point.x);
        self.lingers[function] = first.is_none() && self.fresh[function];
        if let Some(first) = first {
            let sign = first.value.signum();
            if side == 0.0 {
                if self.rested[function] && self.acts[function] {
                    self.crossings.push(Crossing { function, theta: 0.0, rising: sign > 0.0, jumps: false });
                }
                side = sign;
            } else if sign != side {
                // It lies beyond zero from the start, since what changed it there was no step; or it left zero to the
                // other side and came back before anybody looked.
                let theta = certifier.points().first().map_or(0.0, |start| hop(start, first, side));
                let resolved = SHORTER * segment.h > RESOLVED * f64::EPSILON * segment.t.abs();
                if self.fresh[function] && self.decided[function] && self.shortened < SHORTENED && resolved {
                    // What has just been decided to leave zero to its side does not leave it to the other one: the step is too long for its dense output
                    // to show where it goes.
                    self.early = Some(self.early.map_or(SHORTER, |early| early.min(SHORTER)));
                }
                self.crossings.push(Crossing { function, theta, rising: sign > 0.0, jumps: false });
                side = sign;
            }
        }
        self.size[function] = certifier.size;
        for mark in certifier.marks.iter().filter(|mark| floor == 0.0 || mark.x > begins) {
            match mark.kind {
                ZeroKind::Crosses { rising } => {
                    self.crossings.push(Crossing { function, theta: mark.x, rising, jumps: false });
                    side = if rising { 1.0 } else { -1.0 };
                }
                // An event is what passes through zero; a switch has another side, and a force that holds is beyond its limit, however it got
                // there.
                ZeroKind::Jumps | ZeroKind::Pole | ZeroKind::Undefined if switches || self.holds[function] => {
                    let theta = (mark.x + BEYOND * mark.x.max(segment.t.abs() / segment.h)).min(1.0);
                    let after = certifier.points().iter().find(|point| point.x >= theta && point.value.is_finite());
                    let there = after.map_or(side, |point| point.value.signum());
                    if there != side {
                        self.crossings.push(Crossing { function, theta, rising: there > 0.0, jumps: true });
                    }
                    side = there;
                }
                kind => {
                    let t = segment.t + mark.x * segment.h;
                    self.anomalies.push(Oddity { function, t, kind });
                }
            }
        }
        // Jumps, poles and gaps change the side without a crossing.
        let last = certifier.points().iter().rev().find(|point| point.value.is_nan() || point.value.abs() > floor);
        if let Some(last) = last.filter(|last| last.value.is_finite()) {
            side = last.value.signum();
        } else if last.is_some() {
            side = 0.0;
        }
        self.end_sides[function] = side;
    }
}

/// Whether all zeros of a function in a step are found, at the first look or by dividing the step.
fn is_certified<S: System + ?Sized>(
    certifier: &mut Certifier,
    sampler: &mut Sampler,
    (system, segment, function): (&S, &Segment<'_>, usize),
    (grid, middle): (&[Sample], Sample),
) -> bool {
    let mut sample = |theta: f64| {
        if theta == 0.5 {
            return (middle.value, middle.slope);
        }
        sampler.sample(system, segment, function, theta)
    };
    if certifier.settles(&mut sample, grid) {
        return true;
    }
    certifier.rounding = sampler.rounding(system, segment, function);
    certifier.resolution = f64::EPSILON * segment.t.abs() / segment.h;
    let mut sample = |theta: f64| sampler.sample(system, segment, function, theta);
    certifier.certify(&mut sample, grid).is_ok()
}

/// Divides the first piece of a grid towards the start of the step, until what a function does there is not hidden by its far
/// end: until its value and slope there make a good part of the change in the piece.  Returns the variation in the first piece, and how
/// many points were added: none where value and slope are `zero`, for then the function shows nothing there but what rounding and dense
/// output make of it.
fn towards_start<S: System + ?Sized>(
    (grid, middle): (&mut Vec<Sample>, Sample),
    sampler: &mut Sampler,
    (system, segment, function): (&S, &Segment<'_>, usize),
    (zero, instant): (f64, f64),
) -> (f64, usize) {
    let (start, before) = (grid[0], grid.len());
    let whole = variation([start, middle, grid[before - 1]]);
    let value = if start.value.abs() > zero { start.value.abs() } else { 0.0 };
    let slope = if start.slope.abs() > ROUNDINGS * f64::EPSILON * whole { start.slope.abs() } else { 0.0 };
    let explains = |x: f64, near: f64| near <= SHOWN * (value + slope * x) || near.is_nan();
    if value == 0.0 && slope == 0.0 {
        return (whole, 0);
    }
    let (mut x, mut near) = (grid[1].x, whole);
    while !explains(x, near) && x * PART > instant.max(SHORTEST) {
        x *= PART;
        let (value, slope) = sampler.sample(system, segment, function, x);
        near = (value - start.value).abs().max(slope.abs() * x);
        grid.insert(1, Sample { x, value, slope });
    }
    // What is not bent away from the start like a power of θ there is the rounding of dense output.
    while grid.len() > before {
        let Sample { x, value, slope } = grid[1];
        if explains(x, near) || POWERS.contains(&(x * slope / (value - start.value))) {
            break;
        }
        grid.remove(1);
        let Sample { x, value, slope } = grid[1];
        near = (value - start.value).abs().max(slope.abs() * x);
    }
    (near, grid.len() - before)
}

/// By how much a function changes in a step, poles left aside; 0 where it begins undefined.
fn variation([start, middle, end]: [Sample; 3]) -> f64 {
    // What oscillates may be back where it was: the slope counts as well.
    let mut changes = [middle.value - start.value, end.value - start.value, start.slope].map(f64::abs);
    changes.iter_mut().filter(|change| !change.is_finite()).for_each(|change| *change = 0.0);
    changes.sort_unstable_by(f64::total_cmp);
    let [_, second, largest] = changes;
    if second > 0.0 && largest > POLE * second { second } else { largest }
}

/// Where a function that leaves zero to a side at `start` is back at zero before `after`, by a parabola; 0 where its slope
/// does not point to that side.
fn hop(start: &Sample, after: &Sample, side: f64) -> f64 {
    let width = after.x - start.x;
    let curvature = (after.value - start.slope * width) / (width * width);
    let back = -start.slope / curvature;
    if start.slope * side > 0.0 && back > 0.0 && back < width { start.x + back } else { start.x }
}

/// A function as descriptions name it.
fn watched(sampler: &Sampler, function: usize) -> Watched {
    match sampler.switch(function) {
        Some(switch) => Watched::Switch(switch as u32),
        None => Watched::Event(function as u32),
    }
}

/// A function in the file's words.
pub(crate) fn watched_name<S: System + ?Sized>(system: &S, sampler: &Sampler, function: usize) -> String {
    match sampler.switch(function) {
        Some(switch) => super::modes::text(system, switch),
        None => system.description().events.get(function).map_or_else(String::new, |event| event.name.to_string()),
    }
}
