//! Writing down a run while it goes on.

use std::sync::Arc;

use super::junctions::Junctions;
use super::{Names, Occurrence, Run, Scenery, SpeedJump, State, Trajectory, Work};
use crate::cause::Cause;
use crate::constrain::{Projection, Residuals, where_shared};
use crate::events::{EventNote, Impulse, Log, Remarkable};
use crate::integrate::{Endpoint, Segment, Tally};
use crate::mechanism::{At, Method, System};
use crate::trust::{ConditionMonitor, GimbalGuard, InertiaGuard, Monitor, Warning, Watchman};

/// An edge that comes so early, in parts of the time of another one, is the start.
const AT_THE_START: f64 = 1e-9;

/// Collects what a [`Run`] holds: reported states, outputs, dense output, drift.
#[derive(Clone)]
pub(crate) struct Recorder {
    run: Run,
    /// Reported times are start + k·every, and these.
    start: f64,
    every: f64,
    next: u64,
    instants: Arc<[f64]>,
    instant: usize,
    /// When the next state is reported, s.
    next_time: f64,
    /// Where the last step ended, s.
    judged: f64,
    /// Steps since the energy was looked at, and how long the last of those at which it was took.
    unlooked: u32,
    looked_step: f64,
    /// A larger change of the energy balance in one step is worth a warning.
    usual_jump: f64,
    /// Those that there were: when, how large, and the scale of the energies then.
    jumps: Vec<(f64, f64, f64)>,
    keep_dense: bool,
    dense_is_free: bool,
    until: f64,
    monitor: Option<Monitor>,
    /// Whether the equations, or the state, are being changed.
    changes: bool,
    guard: Option<InertiaGuard>,
    gimbals: Option<GimbalGuard>,
    condition: Option<ConditionMonitor>,
    watchman: Option<Watchman>,
    /// The least and largest [q; q'] at ends of steps of one length, of a run that is watched: others know them anyhow.
    ranges: Option<[Vec<f64>; 2]>,
    n: usize,
    /// Brings reported states to the constraints.
    projection: Option<Projection>,
    /// Where they are wanted.
    junctions: Option<Box<Junctions>>,
    point: Vec<f64>,
    accelerations: Vec<f64>,
    /// Mean accelerations and multipliers of the last step, where steps go over contacts: at the start there are none.
    means: Option<[Vec<f64>; 2]>,
}

/// The energy is looked at every so many steps.
const LOOKS: u32 = 8;

/// So many jumps of the energy are remembered until it is known what is small beside the motion.
const MOST_JUMPS: usize = 64;
/// Energies are nothing beside others that are so many times larger.
const NOTHING: f64 = 1e-16;

/// What to write down.
pub(crate) struct Plan {
    /// Where the run ends unless an event ends it, s.
    pub until: f64,
    /// Spacing of reported states, s.
    pub every: f64,
    /// Other times, in order, at which states are reported too.
    pub instants: Arc<[f64]>,
    /// Whether to keep dense output.
    pub dense: bool,
    /// Whether to keep the times at which steps end.
    pub keeps_ends: bool,
    /// Whether to watch invariants and the energy balance.
    pub watch: bool,
    /// Whether the method's own dense output costs no evaluation.
    pub dense_is_free: bool,
    /// The method.
    pub method: Method,
    /// Why it was chosen.
    pub why: Option<&'static str>,
    /// The tolerance, if there is one.
    pub tolerance: Option<f64>,
    /// The fixed step, if there is one.
    pub step: Option<f64>,
    /// Whether states are brought back to the constraints.
    pub projects: bool,
    /// Whether to keep the instants at which the equations change.
    pub junctions: bool,
    /// Whether accelerations and reactions are means over steps.
    pub means: bool,
}

impl Plan {
    /// Nothing is watched, and only the ends are reported.
    pub fn quiet(until: f64, every: f64, method: Method) -> Plan {
        Plan {
            until,
            every,
            instants: Arc::from([]),
            dense: false,
            keeps_ends: false,
            watch: false,
            dense_is_free: false,
            method,
            why: None,
            tolerance: None,
            step: None,
            projects: false,
            junctions: false,
            means: false,
        }
    }
}

impl Recorder {
    /// Starts a run at the state y.
    pub fn new(plan: &Plan, system: &dyn System, t: f64, start: Endpoint<'_>) -> Self {
        let y = start.y;
        let description = system.description();
        let n = system.len();
        let run = Run {
            method: plan.method,
            why: plan.why,
            tolerance: plan.tolerance,
            step: plan.step,
            balances: None,
            events: Vec::new(),
            phases: vec![(t, system.phase())],
            residuals: None,
            impulses: Vec::new(),
            work: Work::default(),
            drift: Vec::new(),
            energy_balance: None,
            warnings: Vec::new(),
            digits: None,
            parts: Vec::new(),
            memory: Vec::new(),
            memory_at_start: Vec::new(),
            ticks: Vec::new(),
            resumed: None,
            sampling: Arc::new(system.sampling().clone()),
            seconds: 0.0,
            fastest: 0.0,
            ended_by: None,
            tally: None,
            times: Vec::new(),
            is_filled: false,
            rows: Vec::new(),
            swept: Vec::new(),
            junctions: Vec::new(),
            step_ends: if plan.keeps_ends { vec![t] } else { Vec::new() },
            outputs: Vec::new(),
            scenery: Scenery::new(plan.projects),
            trajectory: Trajectory::new(n),
            names: Arc::new(Names::of(description)),
            description: Arc::new(description.clone()),
        };
        let mut recorder = Recorder {
            run,
            start: t,
            every: plan.every,
            next: 1,
            instants: Arc::clone(&plan.instants),
            instant: 0,
            next_time: f64::INFINITY,
            judged: t,
            unlooked: 0,
            looked_step: f64::INFINITY,
            usual_jump: plan.tolerance.map_or(1e-2, |tolerance| (1e3 * tolerance).clamp(1e-8, 1e-2)),
            jumps: Vec::new(),
            keep_dense: plan.dense,
            dense_is_free: plan.dense_is_free,
            until: plan.until,
            monitor: plan.watch.then(|| Monitor::new(system, t, y, start.work)),
            changes: false,
            guard: InertiaGuard::new(system, t, y),
            gimbals: GimbalGuard::new(system, t, y, plan.tolerance),
            condition: ConditionMonitor::new(system, t, y),
            watchman: plan
                .step
                .filter(|_| plan.watch)
                .and_then(|step| Watchman::new(system, plan.method, step, t, plan.until - t)),
            ranges: plan.step.filter(|_| plan.watch).map(|_| [y.to_vec(), y.to_vec()]),
            n,
            projection: Projection::new(system).map(|projection| projection.only_looking(!plan.projects)),
            junctions: plan.junctions.then(Box::default),
            point: vec![0.0; 2 * n],
            accelerations: vec![0.0; n],
            means: plan.means.then(|| [vec![f64::NAN; n], vec![f64::NAN; description.rows.len()]]),
        };
        recorder.write_row(system, t, y);
        recorder.begin_piece(system, t, start);
        recorder.find_next_time();
        recorder
    }

    /// When the next state is reported, s.
    pub fn next_report(&self) -> f64 {
        self.next_time
    }

    /// True when the step that ends at t must bring its dense output.
    pub fn wants_dense(&self, t: f64) -> bool {
        self.next_time < t || self.keeps_own(t)
    }

    /// True when the method's own dense output of a step that ends at t is to be kept.
    fn keeps_own(&self, t: f64) -> bool {
        self.keep_dense && (self.dense_is_free || self.run.trajectory.wants_own(t))
    }

    /// Writes down an accepted step; `segment` is there if [`Recorder::wants_dense`].
    ///
    /// # Errors
    /// A coordinate singularity, which no method notices by itself.
    pub fn accept(
        &mut self,
        system: &dyn System,
        segment: Option<&Segment<'_>>,
        t: f64,
        end: Endpoint<'_>,
    ) -> Result<(), Box<Cause>> {
        self.judge(system, t, end)?;
        if let Some([low, high]) = &mut self.ranges {
            low.iter_mut().zip(end.y).for_each(|(low, y)| *low = low.min(*y));
            high.iter_mut().zip(end.y).for_each(|(high, y)| *high = high.max(*y));
        }
        if !self.run.step_ends.is_empty() {
            self.run.step_ends.push(t);
        }
        if self.keep_dense {
            let own = segment.filter(|_| self.keeps_own(t));
            self.run.trajectory.push(t, end.y, end.rate, own);
            if self.run.trajectory.is_full() {
                self.keep_dense = false;
                self.warn(Warning::DenseOutputEnds { t });
            }
        }
        if let Some(segment) = segment {
            while self.next_time < t {
                let at = self.next_time;
                let mut point = std::mem::take(&mut self.point);
                segment.evaluate((at - segment.t) / segment.h, &mut point);
                if let Some(projection) = &mut self.projection {
                    // Where no projection is possible the step's end will say so.
                    let _ = projection.project(system, at, &mut point);
                }
                self.write_row(system, at, &point);
                self.point = point;
                self.row_written();
            }
        }
        if self.next_time == t {
            self.write_row(system, t, end.y);
            self.row_written();
        }
        Ok(())
    }

    /// Takes note of mean accelerations and multipliers over the step that is accepted next.
    pub fn means(&mut self, means: Option<[&[f64]; 2]>) {
        if let (Some(known), Some(means)) = (&mut self.means, means) {
            known.iter_mut().zip(means).for_each(|(known, means)| known.copy_from_slice(means));
        }
    }

    /// Takes note of the state before other equations come into force.
    pub fn leave(&mut self, system: &dyn System, t: f64, start: Endpoint<'_>) {
        self.changes = true;
        if let Some(monitor) = &mut self.monitor {
            monitor.leave(system, t, start.y);
        }
        if let Some(junctions) = &mut self.junctions {
            let now = self.run.events.iter().rev().take_while(|event| event.state.t == t);
            junctions.leave(system, (t, start.y), now.map(|event| event.event));
        }
    }

    /// Takes note of a jump of the speeds to constraints.
    pub fn jump(&mut self, jump: impl FnOnce() -> SpeedJump) {
        if let Some(junctions) = &mut self.junctions {
            junctions.jump(jump());
        }
    }

    /// Takes note of new equations in force: dense output does not reach across, and what they do to the energy is no
    /// error of the integration.  A state that was reported at this instant is the one after it.
    pub fn restart(&mut self, system: &dyn System, t: f64, start: Endpoint<'_>) {
        self.changes = false;
        if let Some(monitor) = &mut self.monitor {
            monitor.restart(system, t, start.y);
        }
        if let Some(junctions) = &mut self.junctions {
            junctions.restart(system, t, start.y);
        }
        if self.run.times.last() == Some(&t) {
            self.take_back_row();
            self.write_row(system, t, start.y);
        }
        self.begin_piece(system, t, start);
    }

    /// Dense output does not reach across this state.
    pub fn begin_piece(&mut self, system: &dyn System, t: f64, start: Endpoint<'_>) {
        if let Some(projection) = &mut self.projection {
            projection.hold(system, t, start.y);
        }
        if t == self.start {
            self.run.memory_at_start = system.memory().to_vec();
        }
        if self.keep_dense {
            self.run.trajectory.begin(t, start.y, start.rate);
            self.run.scenery.modes(t, system.modes());
            self.run.scenery.memory(t, system.memory());
        }
    }

    /// Judges the end of a step by what should be conserved, and by M.
    fn judge(&mut self, system: &dyn System, t: f64, end: Endpoint<'_>) -> Result<(), Box<Cause>> {
        let h = t - self.judged;
        self.judged = t;
        if let Some(condition) = &mut self.condition {
            condition.observe(system, t, end.y);
        }
        if let Some(lock) = self.gimbals.as_mut().and_then(|guard| guard.observe(system, t, end.y)) {
            return Err(lock.into());
        }
        let unbounded = self.guard.as_mut().and_then(|guard| guard.observe(system, t, end.y));
        if let Some(unbounded) = unbounded {
            return Err(unbounded.cause(system.description()).into());
        }
        if let Some(warning) = self.watchman.as_mut().and_then(|watchman| watchman.check(system, t, end.y)) {
            self.watchman = None;
            self.warn(warning);
        }
        // A step that has shrunk to half may have met what the energy shows; where an inertia may grow without bound,
        // the energy is its second witness.
        self.unlooked += 1;
        if self.unlooked < LOOKS && h >= 0.5 * self.looked_step && self.guard.is_none() {
            return Ok(());
        }
        let steps = std::mem::take(&mut self.unlooked);
        self.looked_step = h;
        let Some(monitor) = &mut self.monitor else { return Ok(()) };
        let (jump, scale) = monitor.observe(system, t, end.y, end.work);
        if jump > f64::from(steps) * self.usual_jump {
            if let Some(unbounded) = self.guard.as_ref().and_then(|guard| guard.suspect(system, 2.0 * h)) {
                return Err(unbounded.cause(system.description()).into());
            }
            if self.jumps.len() < MOST_JUMPS {
                self.jumps.push((t, jump, scale));
            }
        }
        Ok(())
    }

    /// Keeps dense output and pictures from here on, where the run is at its start.
    pub fn keep_dense(&mut self, system: &dyn System, t: f64, start: Endpoint<'_>) {
        self.keep_dense = true;
        self.begin_piece(system, t, start);
    }

    /// Drops all but the first state, the last one, the phase, impulses of the present instant and what was found of the whole motion.
    pub fn forget(&mut self, now: f64) {
        let run = &mut self.run;
        let last = run.times.len().saturating_sub(1);
        if last > 1 {
            let outputs = run.names.outputs.len();
            run.times.drain(1..last);
            run.rows.drain(2 * self.n..2 * self.n * last);
            run.outputs.drain(outputs..outputs * last);
        }
        run.events.clear();
        run.impulses.retain(|impulse| impulse.t >= now);
        run.phases.drain(..run.phases.len().saturating_sub(1));
        run.ended_by = None;
    }

    /// Events since the last [`Recorder::forget`].
    pub fn events(&self) -> &[Occurrence] {
        &self.run.events
    }

    /// Draws what the mechanism, as it is, went through until now, before it is changed by hand.
    pub fn draw(&mut self, system: &dyn System) {
        let run = &mut self.run;
        run.scenery.draw(system, &run.trajectory, self.until);
    }

    /// Takes note of a state or a mechanism that was changed by hand: what that does to the energy is no error
    /// of the integration.
    pub fn changed(&mut self, system: &dyn System, t: f64, start: Endpoint<'_>) {
        if let Some(guard) = &mut self.guard {
            guard.restart(system, t, start.y);
        }
        if let Some(gimbals) = &mut self.gimbals {
            gimbals.restart(system, t, start.y);
        }
        if let Some(monitor) = &mut self.monitor {
            monitor.observe(system, t, start.y, start.work);
        }
        self.unlooked = 0;
    }

    /// Looks whether a coordinate singularity is the reason for what went wrong.
    pub fn explain(&self, system: &dyn System, cause: Cause) -> Cause {
        let explicable = matches!(
            cause,
            Cause::StepTooSmall { .. }
                | Cause::NonFinite { .. }
                | Cause::SingularMass { .. }
                | Cause::TooManySteps { .. }
                | Cause::NeedsMoreSteps { .. }
        );
        let suspect = self.guard.as_ref().and_then(|guard| guard.suspect(system, guard.last_step() * 2.0));
        match suspect {
            Some(unbounded) if explicable => unbounded.cause(system.description()),
            _ => cause,
        }
    }

    /// Notes a jump of the speeds.
    pub fn impulse(&mut self, impulse: Impulse) {
        self.run.impulses.push(impulse);
    }

    /// Notes that the motion goes on in another phase.
    pub fn phase(&mut self, phase: usize, t: f64) {
        self.run.phases.push((t, phase));
    }

    /// Notes that contacts rebound or slip in an impact.
    pub fn rebounds(&mut self) {
        if let Some(junctions) = &mut self.junctions {
            junctions.rebounds();
        }
    }

    /// Notes that impacts have become so small that rounding alone ends them.
    pub fn sinks(&mut self) {
        if let Some(junctions) = &mut self.junctions {
            junctions.accumulates();
        }
    }

    /// Notes that the impacts of an event accumulate, and when.
    pub fn accumulated(&mut self, system: &dyn System, event: usize, t: f64) {
        let event = system.description().events[event].name.to_string();
        self.warn(Warning::ImpactsAccumulate { event, t });
        if let Some(junctions) = &mut self.junctions {
            junctions.accumulates();
        }
    }

    /// The last event.
    pub fn last_event(&self) -> Option<Occurrence> {
        self.run.events.last().cloned()
    }

    /// Reports a state, unless it was.
    pub fn report(&mut self, system: &dyn System, t: f64, y: &[f64]) {
        if self.run.times.last().is_none_or(|last| *last < t) {
            self.write_row(system, t, y);
        }
    }

    /// A state with this run's names and its outputs.
    pub fn state_with_outputs<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) -> State {
        let mut outputs = vec![f64::NAN; self.run.names.outputs.len()];
        self.write_outputs(system, t, y, &mut outputs);
        self.state(t, y, outputs)
    }

    /// Notes a warning, once.
    pub fn warn(&mut self, warning: Warning) {
        if !self.run.warnings.iter().any(|known| known.same_kind(&warning)) {
            self.run.warnings.push(warning);
        }
    }

    /// Takes note of how far [q; q'] have gone, where steps are not of one length.
    pub fn swept(&mut self, swept: Vec<f64>) {
        let own = |[low, high]: [Vec<f64>; 2]| low.iter().zip(&high).map(|(low, high)| high - low).collect();
        self.run.swept = self.ranges.take().map_or(swept, own);
    }

    /// Takes note of the step that was found and taken, s.
    pub fn took(&mut self, step: Option<f64>) {
        self.run.step = step.or(self.run.step);
    }

    /// A state with this run's names.
    pub fn state(&self, t: f64, y: &[f64], outputs: Vec<f64>) -> State {
        let n = self.n;
        State { t, q: y[..n].to_vec(), v: y[n..2 * n].to_vec(), outputs, names: self.run.names.clone() }
    }

    /// Notes how far the ends of steps were from the constraints.
    pub fn constrained(&mut self, ends: Option<Residuals>) {
        let rows = self.projection.as_ref().map(Projection::worst);
        self.run.residuals = ends.zip(rows).map(|(ends, rows)| Residuals {
            position: ends.position.max(rows.position),
            velocity: ends.velocity.max(rows.velocity),
        });
    }

    /// Takes note of what contacts did that steps went over.
    pub fn stepped_over(&mut self, tally: Option<&Tally>) {
        if let Some(Tally { unsettled: steps @ 1.., first: t, residual, .. }) = tally {
            self.warn(Warning::UnsettledImpulses { t: *t, steps: *steps, residual: *residual });
        }
        self.run.tally = tally.cloned().map(Box::new);
    }

    /// Notes the numbers of the next ticks, and what a run that goes on is to know.
    pub fn ticked(&mut self, next: Vec<u64>, resumed: Option<(f64, [Vec<f64>; 2])>) {
        (self.run.ticks, self.run.resumed) = (next, resumed);
    }

    /// Ends the run at this state.
    pub fn finish(mut self, system: &dyn System, t: f64, end: Endpoint<'_>, work: Work, seconds: f64) -> Run {
        self.report(system, t, end.y);
        self.run.scenery.keep(system, self.run.trajectory.end());
        if let Some(mut monitor) = self.monitor.take() {
            // A run may fail amid what an event does, which is no error of the integration either.
            if self.changes {
                monitor.restart(system, t, end.y);
            }
            let (_, scale) = monitor.observe(system, t, end.y, end.work);
            // What is nothing beside the energies of the motion is rounding before it has begun.
            let jump = self.jumps.iter().find(|(_, _, then)| *then > NOTHING * scale).copied();
            if let Some((t, jump, _)) = jump {
                self.warn(Warning::EnergyJump { t, jump });
            }
            self.run.drift = monitor.drifts(system.description());
            self.run.energy_balance = monitor.energy_balance();
            let limit = usual_drift(self.run.tolerance, work.steps);
            if let Some(drift) = self.run.energy_balance.filter(|drift| *drift > limit) {
                self.run.warnings.push(Warning::EnergyBudgetExceeded { drift, limit });
            }
            self.run.warn_of_drift(limit);
        }
        if let Some(gimbals) = self.gimbals.take() {
            gimbals.warnings(system).for_each(|warning| self.warn(warning));
        }
        self.run.balances = self.condition.map(ConditionMonitor::found);
        self.run.junctions = self.junctions.map(|junctions| junctions.list).unwrap_or_default();
        self.run.memory = system.memory().to_vec();
        self.run.work = work;
        self.run.seconds = seconds;
        self.run
    }

    fn row_written(&mut self) {
        self.next += u64::from(self.next_time == self.regular());
        self.instant += usize::from(self.instants.get(self.instant) == Some(&self.next_time));
        self.find_next_time();
    }

    fn find_next_time(&mut self) {
        self.next_time = self.regular().min(self.instants.get(self.instant).copied().unwrap_or(f64::INFINITY));
    }

    /// The next of the times at equal distances.
    fn regular(&self) -> f64 {
        self.start + self.every * self.next as f64
    }

    fn take_back_row(&mut self) {
        self.run.times.pop();
        self.run.rows.truncate(self.run.rows.len() - 2 * self.n);
        self.run.outputs.truncate(self.run.outputs.len() - self.run.names.outputs.len());
    }

    fn write_row<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        self.run.times.push(t);
        self.run.rows.extend_from_slice(y);
        let first = self.run.outputs.len();
        let count = self.run.names.outputs.len();
        let mut outputs = std::mem::take(&mut self.run.outputs);
        outputs.resize(first + count, f64::NAN);
        self.write_outputs(system, t, y, &mut outputs[first..]);
        self.run.outputs = outputs;
    }

    fn write_outputs<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64], outputs: &mut [f64]) {
        match &self.means {
            Some([a, lambda]) => system.outputs(At::packed(t, y, self.n).accelerated(a).constrained(lambda), outputs),
            None => evaluate_outputs(system, t, y, &mut self.accelerations, outputs),
        }
    }
}

/// The outputs of a state with the equations in force; `accelerations` is room.
pub(crate) fn evaluate_outputs<S: System + ?Sized>(
    system: &S,
    t: f64,
    y: &[f64],
    accelerations: &mut [f64],
    outputs: &mut [f64],
) {
    if outputs.is_empty() {
        return;
    }
    let at = At::packed(t, y, system.len());
    if !system.description().outputs_use_accelerations {
        return system.outputs(at, outputs);
    }
    if let Some((a, lambda)) = where_shared(system, at) {
        return system.outputs(at.accelerated(&a).constrained(&lambda), outputs);
    }
    if system.accelerations(at, accelerations).is_err() {
        accelerations.fill(f64::NAN);
    }
    system.outputs(at.accelerated(accelerations), outputs);
}

/// What is conserved may drift by so much: some tolerances a step, measured over ordinary motions (at most 0.2 a step), and
/// by what rounding adds up to; 1 % at a fixed step, of which nobody said what it is to achieve.
pub(crate) fn usual_drift(tolerance: Option<f64>, steps: u64) -> f64 {
    let steps = steps as f64;
    tolerance.map_or(1e-2, |tolerance| (tolerance * (2.0 * steps).max(1e3)).max(1e-13 * steps.sqrt()).min(1e-2))
}

/// Events that hold more numbers than this (160 MB) are not kept.
const MOST_EVENT_NUMBERS: usize = 20_000_000;
/// What an event takes beside its state, in numbers.
const EVENT_OVERHEAD: usize = 24;

impl Log for Recorder {
    fn event<S: System + ?Sized>(&mut self, system: &S, event: usize, t: f64, y: &[f64], ends: bool) {
        let numbers = 2 * self.n + self.run.names.outputs.len() + EVENT_OVERHEAD;
        if !ends && self.run.events.len() * numbers > MOST_EVENT_NUMBERS {
            return self.warn(Warning::EventsEnd { t, kept: self.run.events.len() });
        }
        let name = system.description().events[event].name.to_string();
        let state = self.state_with_outputs(system, t, y);
        self.run.events.push(Occurrence { name, event, state });
        if ends {
            self.run.ended_by = Some(self.run.events.len() - 1);
        }
    }

    fn note(&mut self, EventNote { event, t, what }: EventNote) {
        // Where the run begins a function may be undefined at that one point: later edges say more.
        let start = self.start;
        let begins = |known: &Warning| matches!(known, Warning::Undefined { event: other, t: at } if *other == event && at - start <= AT_THE_START * (t - start));
        if what == Remarkable::Edge {
            self.run.warnings.retain(|known| !begins(known));
        }
        self.warn(match what {
            Remarkable::Touch => Warning::Touch { event, t },
            Remarkable::Jump => Warning::NoCrossing { event, t },
            Remarkable::Edge => Warning::Undefined { event, t },
        });
    }
}
