//! Putting steps together to a motion.
//!
//! A step is tried until its error is small enough; its dense output is made where anything reads it; what is watched may end it early; it is
//! written down and taken.
//!
//! 1. What is chosen before it begins: look in `options.rs`; the first step: `first.rs`; how the way to a stop is divided: `plan.rs`; a fixed step
//!    that suits a tolerance: `trial.rs`; steps of another run that are followed: `followed.rs`.
//! 2. Tries of a step until one is good: look in `attempt.rs`; what may end a step early: `interrupt.rs`; jumps of the acceleration that nobody declared: `jump.rs`; what is asked of a step between its
//!    ends: `between.rs`; rounding that looks like errors: `noise.rs`.
//! 3. Constraints at the ends of steps: `constraints.rs`; phases and impacts: `phase.rs`; contacts: `contact.rs`; what follows at
//!    one instant: `act.rs`.
//! 4. Events where a motion starts and ends: `start.rs`; what is changed by hand: `by_hand.rs`; ticks, and what events set: `set.rs`; mechanisms that stand still: `rest.rs`.

mod act;
mod attempt;
mod between;
mod by_hand;
mod constraints;
mod contact;
mod first;
mod followed;
mod interrupt;
mod jump;
mod noise;
mod options;
mod phase;
mod plan;
mod rest;
mod set;
mod start;
mod trial;

use std::ops::ControlFlow;

use act::EventCascade;
use attempt::finite;
use between::Defect;
use constraints::{SingularDwell, held_coordinates};
pub(crate) use followed::Followed;
use interrupt::Outcome;
use jump::JumpDetector;
use phase::Impacts;
use start::Starting;
use trial::FoundStep;

use crate::cause::Cause;
use crate::constrain::Projection;
use crate::events::{EventLocator, Ticks, switch_text};
use crate::integrate::{
    Clock, Control, Endpoint, OneStep, Segment, StepControl, StiffnessDetector, Tally, Tolerance, stepper,
};
use crate::mechanism::sliding::return_to_surfaces;
use crate::mechanism::{At, Method, System};
use crate::run::{Recorder, Work};
use crate::trust::{Warning, ends_that_meet};

/// How steps are chosen.
#[derive(Clone, Debug)]
pub(crate) enum StepPolicy {
    /// All alike, but for the last before a stop.
    Fixed(f64),
    /// Against a tolerance, none longer than `longest`.
    Adaptive {
        /// The tolerance.
        tolerance: Box<Tolerance>,
        /// s.
        longest: f64,
    },
}

/// Why the time loop stopped without an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StopReason {
    /// It is where it was to go.
    Arrived,
    /// An event ended it.
    Event,
    /// Stability limits the steps of an explicit method, for which another one is to be taken.
    Stiff,
}

/// A step to try, or one that was.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// Its length, s.
    pub h: f64,
    /// Where it ends, s.
    pub next: f64,
    /// True when it ends at a time that was asked for.
    pub lands: bool,
}

/// A motion that is under way.
pub(crate) struct Integration {
    stepper: Box<dyn OneStep>,
    /// The method, while the mechanism is held at rest.
    asleep: Option<Box<dyn OneStep>>,
    policy: StepPolicy,
    control: StepControl,
    clock: Clock,
    /// The next step; 0 when it must be chosen anew.
    h: f64,
    work: Work,
    max_steps: u64,
    /// How many steps were taken before those that are limited.
    free_steps: u64,
    compensated: bool,
    /// Whether steps are chosen otherwise than usual.
    decorrelate_steps: bool,
    /// Steps of another run that limit those of this one.
    followed: Option<Followed>,
    /// The start that this one was moved from by rounding.
    beside: Option<Vec<f64>>,
    /// The least and the largest values of a run that goes on in this one.
    seen_before: Option<[Vec<f64>; 2]>,
    /// Events that do nothing, by their places.
    ignored_events: Vec<usize>,
    /// How many steps were taken since the last stop.
    since_stop: u32,
    /// The length of the last step that was taken, s; ∞ before the first.
    last_step: f64,
    /// Where each length of a step costs something, the one that divides the way to the next stop.
    even: f64,
    locator: Option<Box<EventLocator>>,
    /// The event after which the motion ends, all that happens at its instant done.
    ends_after: Option<usize>,
    /// Ticks that are still to come.
    ticks: Ticks,
    /// Where there are constraints.
    projection: Option<Box<Projection>>,
    /// Whether states are brought back to them.
    projects: bool,
    /// Whether Baumgarte's gain is still to be chosen.
    finds_gain: bool,
    /// Where the integration began, s.
    from: f64,
    /// How long steps have ended where the constraints depend on each other as they do nowhere else.
    dwell: SingularDwell,
    impacts: Impacts,
    /// The largest speeds, where something may slide in space.
    fastest: Vec<f64>,
    /// The combination of modes that was looked at last.
    looked_at: Option<usize>,
    /// The instant of the last impact, with the state before it: its speeds tell how well the instant is known.
    struck: Option<(f64, Vec<f64>)>,
    cascade: EventCascade,
    defect: Defect,
    /// Until when the motion goes on at most, s.
    until: f64,
    /// Until when time changes no discontinuity, s: the functions of time are not those of the file beyond it.
    smooth_until: f64,
    /// What is still to be done before the next step.
    start: Starting,
    stiffness: StiffnessDetector,
    /// The motion ends where stability limits its steps, if more than these are left.
    leaves_where_stiff: Option<f64>,
    /// Stability may limit steps until so many are taken.
    stays_until: u64,
    /// h|λ| at the end of the step that was tried.
    step_times_rate: f64,
    /// The fastest rate |λ| that the last whole step told of, 1/s; 0 where that is far from limiting it.
    limiting_rate: f64,
    /// How many steps in a row would have poor dense output.
    poor_steps: u32,
    /// When the next state is reported, s.
    reports_at: f64,
    /// Whether events happen with which the motion starts.
    begins: bool,
    /// Events that stop or set, past their zero where the motion started, or at it and moving past, and have not happened since.
    waiting: Vec<usize>,
    jumps: JumpDetector,
    /// Errors and length of the last attempt at the present step, if it was rejected.
    rejected: Vec<f64>,
    rejected_step: f64,
    /// How many good steps in a row let no later one be longer.
    held_steps: u32,
    /// How many steps were cut because a watched function oscillated within them, since this time, s.
    cuts: u32,
    cut_from: f64,
    /// How long a step may be in which watched functions can be followed, s.
    traced: f64,
    /// Whether the fixed step is no more than the longest: a shorter one is as exact, and breaks no structure.
    any_step: bool,
    /// How the fixed step was found, if it was.
    found: Option<FoundStep>,
    /// Where a step that was given passed over what happens within it, s.
    passed_over: Option<f64>,
}

impl Integration {
    /// An integration from t at the state y = [q; q'], not yet begun; `work` tells whether it integrates the power of what has
    /// no potential.
    pub fn new(method: Method, policy: StepPolicy, t: f64, y: &[f64], work: bool) -> Self {
        let mut stepper = stepper(method, y.len() / 2, work);
        stepper.state_mut().copy_from_slice(y);
        Integration {
            control: StepControl::new(stepper.control()),
            stiffness: StiffnessDetector::new(stepper.control().stiff),
            leaves_where_stiff: None,
            stays_until: 0,
            step_times_rate: 0.0,
            limiting_rate: 0.0,
            poor_steps: 0,
            reports_at: f64::INFINITY,
            begins: false,
            waiting: Vec::new(),
            jumps: JumpDetector::new(0.0),
            stepper,
            asleep: None,
            policy,
            clock: Clock::new(t),
            h: 0.0,
            work: Work::default(),
            max_steps: u64::MAX,
            free_steps: 0,
            compensated: true,
            decorrelate_steps: false,
            followed: None,
            beside: None,
            seen_before: None,
            ignored_events: Vec::new(),
            since_stop: 0,
            last_step: f64::INFINITY,
            even: 0.0,
            locator: None,
            ends_after: None,
            ticks: Ticks::default(),
            projection: None,
            projects: true,
            finds_gain: false,
            from: t,
            dwell: SingularDwell::default(),
            impacts: Impacts::default(),
            fastest: Vec::new(),
            looked_at: None,
            struck: None,
            cascade: EventCascade::default(),
            rejected: Vec::with_capacity(y.len()),
            rejected_step: 0.0,
            held_steps: 0,
            cuts: 0,
            cut_from: f64::NEG_INFINITY,
            traced: f64::INFINITY,
            any_step: false,
            found: None,
            passed_over: None,
            defect: Defect::new(y.len()),
            until: t,
            smooth_until: t,
            start: Starting::Done,
        }
    }

    /// Counts steps anew for [`Integration::limit`].
    pub fn limit_anew(&mut self) {
        self.free_steps = self.work.steps;
    }

    /// Ends where stability limits more steps than these that are left, or only warns.
    pub fn leave_where_stiff(&mut self, more_than: Option<f64>) {
        self.leaves_where_stiff = more_than;
    }

    /// Goes on where stability limits steps, until as many again are taken.
    pub fn stay_where_stiff(&mut self) {
        self.stays_until = 2 * self.work.steps;
    }

    /// The numbers of the next ticks of all clocks.
    pub fn next_ticks(&self) -> Vec<u64> {
        self.ticks.next()
    }

    /// Goes on with the step and the ranges that another run ended with, against a tolerance.
    pub fn resume(&mut self, step: f64, seen: &[Vec<f64>; 2]) {
        let StepPolicy::Adaptive { tolerance, .. } = &mut self.policy else { return };
        let now = self.stepper.start().y;
        for values in seen {
            let known = |(seen, now): (&f64, &f64)| if seen.is_finite() { *seen } else { *now };
            tolerance.observe(&values.iter().zip(now).map(known).collect::<Vec<f64>>());
        }
        if step > 0.0 {
            self.h = step;
        }
    }

    /// The length of the next step, s, and the least and the largest values so far; `None` at a fixed step.
    pub fn resumed(&self) -> Option<(f64, [Vec<f64>; 2])> {
        match &self.policy {
            StepPolicy::Fixed(_) => None,
            StepPolicy::Adaptive { tolerance, .. } => Some((self.h, tolerance.seen())),
        }
    }

    /// The present time, s.
    pub fn time(&self) -> f64 {
        self.clock.now()
    }

    /// The present state.
    pub fn state(&self) -> Endpoint<'_> {
        self.stepper.start()
    }

    /// The present state [q; q'], to be changed before the integration begins anew.
    pub fn state_mut(&mut self) -> &mut [f64] {
        self.stepper.state_mut()
    }

    /// True where dense output costs no evaluation.
    pub fn dense_is_free(&self) -> bool {
        self.stepper.dense_is_free()
    }

    /// What contacts did, where steps go over them.
    pub fn tally(&self) -> Option<&Tally> {
        self.stepper.tally()
    }

    /// Work done so far.
    pub fn work(&self) -> Work {
        let counters = self.stepper.counters();
        Work {
            evaluations: counters.evaluations,
            jacobians: counters.jacobians,
            factorizations: counters.factorizations,
            samples: self.work.samples + self.locator.as_ref().map_or(0, |locator| locator.samples()),
            ..self.work
        }
    }

    /// Begins at the present state a motion that goes on to `until` at most: watches it, chooses the modes.
    pub fn begin(&mut self, system: &mut dyn System, until: f64) -> Result<(), Box<Cause>> {
        self.awake();
        let now = self.clock.now();
        finite(system, self.stepper.start().y, 0)?;
        let usual = self.stepper.control();
        let control = if self.decorrelate_steps { Control { grow: usual.grow.sqrt(), ..usual } } else { usual };
        (self.h, self.control) = (0.0, StepControl::new(control));
        self.jumps = JumpDetector::new(until - now);
        if let StepPolicy::Adaptive { tolerance, .. } = &mut self.policy {
            tolerance.observe(self.stepper.start().y);
        }
        self.until = until;
        if self.projection.is_none() {
            let looks = !self.projects;
            self.projection = Projection::new(system).map(|projection| Box::new(projection.only_looking(looks)));
        }
        if let Some(projection) = &mut self.projection {
            projection.release();
        }
        self.project_start(system)?;
        self.work.samples += self.locator.as_ref().map_or(0, |locator| locator.samples());
        self.locator = None;
        let y = self.stepper.start().y.to_vec();
        if let Some(mut locator) = EventLocator::new(system, (now, until), &y, self.decorrelate_steps)? {
            locator.ignore(&self.ignored_events);
            let begins = locator.beginning(now);
            if begins > now {
                self.clock.set(begins);
            }
            let outcome = locator.begin(system, (self.clock.now(), &y), &mut |system| self.trial(system));
            self.locator = Some(Box::new(locator));
            outcome?;
        }
        self.start = Starting::Anew;
        self.begin_anew(system)
    }

    /// Goes on to `until`, or to an event that stops; tells `progress` the time after every step.
    pub fn advance(
        &mut self,
        system: &mut dyn System,
        until: f64,
        recorder: &mut Recorder,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<StopReason, Box<Cause>> {
        let moves = self.clock.now() < until;
        if moves && self.start_events(system, recorder)? == StopReason::Event {
            return Ok(StopReason::Event);
        }
        while self.clock.now() < until {
            let stop_reason = self.one(system, until, recorder);
            let goes_on = progress(self.clock.now());
            match stop_reason? {
                StopReason::Arrived => {}
                ended => return Ok(ended),
            }
            if goes_on.is_break() {
                return Err(Cause::Interrupted.into());
            }
        }
        if self.ticks.is_due(self.clock.now()) && self.tick(system, recorder)? == StopReason::Event {
            return Ok(StopReason::Event);
        }
        if moves && self.clock.now() >= self.until {
            self.end_events(system, recorder)
        } else {
            Ok(StopReason::Arrived)
        }
    }

    /// Takes one step, or what an event or a discontinuity leaves of it; where a tick has come, does what that says.
    pub fn one(
        &mut self,
        system: &mut dyn System,
        until: f64,
        recorder: &mut Recorder,
    ) -> Result<StopReason, Box<Cause>> {
        if self.ticks.is_due(self.clock.now()) {
            return self.tick(system, recorder);
        }
        let stop = self.locator.as_ref().map_or(until, |locator| locator.next_stop(until));
        let stop = self.ticks.stop(stop);
        self.smooth_until = stop;
        self.reports_at = recorder.next_report();
        let mut most = self.traced;
        loop {
            let mut locator = self.locator.take();
            let tried = self.sound(system, (stop, most), &mut locator, recorder);
            let tried = tried.map_err(|cause| Box::new(self.explained(system, *cause, &mut locator)));
            self.locator = locator;
            let (step, dense) = tried?;
            let outcome = match self.locator.take() {
                None => self.keep(system, step, dense, recorder).map(|()| Outcome::Kept(StopReason::Arrived)),
                Some(mut locator) => {
                    let outcome = self.watched(system, (step, dense), &mut locator, recorder);
                    self.locator = Some(locator);
                    outcome
                }
            };
            match outcome {
                // What oscillates in a long step may not in a short one.
                Err(cause) if matches!(*cause, Cause::OscillatesTooFast { .. }) && self.may_cut() => {
                    if self.clock.now() - self.cut_from > ON * (self.until - self.clock.now()) {
                        (self.cuts, self.cut_from) = (0, self.clock.now());
                    }
                    self.cuts += 1;
                    self.work.retries += 1;
                    self.traced = CUT * step.h;
                    most = self.traced;
                }
                Ok(Outcome::MissedFeature(shorter)) => {
                    self.work.rejected += 1;
                    most = shorter;
                }
                outcome => {
                    let is_stiff = self.look_for_stiffness(step, recorder);
                    let Outcome::Kept(stop_reason) = outcome? else { continue };
                    let begins_stiffly = self.look_at_combination(system, recorder);
                    let left = (self.until - step.next) / step.h;
                    let is_limited = is_stiff && self.leaves_where_stiff.is_some_and(|most| left > most);
                    let leaves = (is_limited || begins_stiffly) && self.work.steps >= self.stays_until;
                    self.traced *= LONGER;
                    self.look_at_constraints(system, recorder)?;
                    self.look_at_contacts(system)?;
                    self.follow_directions(system, recorder)?;
                    self.choose_gain(system);
                    return Ok(if leaves { StopReason::Stiff } else { stop_reason });
                }
            }
        }
    }

    fn may_cut(&self) -> bool {
        self.cuts < MOST_CUTS && (self.any_step || matches!(self.policy, StepPolicy::Adaptive { .. }))
    }

    /// Writes down and takes a step that nothing can interrupt.
    fn keep(
        &mut self,
        system: &dyn System,
        step: Step,
        dense: bool,
        recorder: &mut Recorder,
    ) -> Result<(), Box<Cause>> {
        let segment = dense.then(|| self.segment(step));
        recorder.means(self.stepper.means());
        recorder.accept(system, segment.as_ref(), step.next, self.stepper.end())?;
        self.commit(step);
        Ok(())
    }

    /// Begins anew after the equations changed on the way.
    ///
    /// At a time that was known beforehand the length of the last step says what it said before: it is kept.
    fn restart(&mut self, system: &dyn System, recorder: &mut Recorder) -> Result<(), Box<Cause>> {
        self.begin_anew(system)?;
        recorder.restart(system, self.clock.now(), self.stepper.start());
        Ok(())
    }

    fn begin_anew(&mut self, system: &dyn System) -> Result<(), Box<Cause>> {
        self.awake();
        if let Some(switch) = system.sliding().first() {
            if !self.stepper.slides() {
                return Err(Cause::Sliding { switch: switch_text(system, *switch) }.into());
            }
            return_to_surfaces(system, self.clock.now(), self.stepper.state_mut());
        }
        // The length of the step stays: what happened says little about the next one, and the error test judges it.  One that led to the rounding of
        // the present instant is chosen anew.
        if self.h < self.shortest() {
            self.h = 0.0;
        }
        self.control.restart();
        self.jumps.restart();
        self.since_stop = 0;
        let now = self.clock.now();
        if let StepPolicy::Adaptive { tolerance, .. } = &mut self.policy {
            let y = self.stepper.start().y;
            tolerance.observe(y);
            tolerance.hold(held_coordinates(system, At::packed(now, y, system.len())), self.until - now);
        }
        self.stepper.begin(system, now).map_err(|failure| failure.cause(system.description()))?;
        finite(system, self.stepper.start().rate, 1).map_err(|cause| {
            let met = ends_that_meet(system, At::packed(now, self.stepper.start().y, system.len()));
            met.map_or(cause, |load| Cause::EndsMeet { load, t: now }.into())
        })?;
        self.find_step_again(system);
        self.sleep(system);
        Ok(())
    }

    /// Computes dense output of the step that was tried.
    fn dense(&mut self, system: &dyn System, step: Step) -> Result<(), Box<Cause>> {
        let computed = self.stepper.dense(system, self.clock.now(), step.h);
        computed.map_err(|failure| failure.cause(system.description()).into())
    }

    fn segment(&self, step: Step) -> Segment<'_> {
        self.stepper.segment(self.clock.now(), step.h)
    }

    /// Warns where the step is limited by stability; whether it is.
    fn look_for_stiffness(&mut self, step: Step, recorder: &mut Recorder) -> bool {
        let step_times_rate = self.step_times_rate;
        let is_stiff = matches!(self.policy, StepPolicy::Adaptive { .. }) && self.stiffness.observe(step_times_rate);
        if is_stiff {
            recorder.warn(Warning::Stiff { t: step.next, step_times_rate });
        }
        is_stiff
    }

    /// What is to be said of the motion as a whole.
    pub fn warnings(&self, system: &dyn System) -> Vec<Warning> {
        let missed =
            |event: &usize| Warning::NeverPassed { event: system.description().events[*event].name.to_string() };
        let missed = self.waiting.iter().filter(|_| self.work.steps > 0).map(missed);
        let StepPolicy::Adaptive { tolerance, .. } = &self.policy else {
            return self.passed_over.map(|t| Warning::PassedOver { t }).into_iter().chain(missed).collect();
        };
        let limited = |(i, to)| Warning::RoundingLimits { coordinate: system.description().coordinate_name(i), to };
        tolerance.limited().map(limited).chain(missed).collect()
    }

    /// How far [q; q'] have gone, the ends of all steps counted; nothing at a fixed step.
    pub fn swept(&self) -> Vec<f64> {
        match &self.policy {
            StepPolicy::Fixed(_) => Vec::new(),
            StepPolicy::Adaptive { tolerance, .. } => tolerance.swept(),
        }
    }
}

/// So many times a step is cut because a watched function oscillates within it, before the run has gone on by a part of what is left of it.
const MOST_CUTS: u32 = 100;
const ON: f64 = 0.01;
/// To this part; each one after it may be longer by this factor, until one is cut again.
const CUT: f64 = 0.01;
const LONGER: f64 = 2.0;
