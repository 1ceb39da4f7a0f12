//! As many runs as there are lanes, each at its own time and with its own step.

use std::sync::Arc;

use super::attempt::{Attempt, Block, Scheme};
use super::{Ending, Lanes};
use crate::events::{calm_ratio, excludes_feature};
use crate::integrate::{Clock, LEAST, StepControl, first_step};
use crate::mechanism::dense::{ROUNDING, widest};
use crate::mechanism::{Dynamic, Mechanism, Method, Role, SingularMass};
use crate::run::{Names, State, Work, evaluate_outputs, usual_drift};
use crate::trust::Monitor;

/// A run that waits for a lane.
pub(super) struct Task<'a, M> {
    /// The mechanism with its parameters.
    pub mechanism: &'a M,
    /// `rkn8` or `dop853`.
    pub method: Method,
    /// From when to when, s.
    pub span: (f64, f64),
    /// (q, q') at the start.
    pub start: (&'a [f64], &'a [f64]),
    pub tolerance: f64,
    pub max_steps: u64,
}

/// Runs all tasks by a method; `None` stands where something must be looked at, so that a run of its own is needed.
///
/// A lane that is done takes the next task.  What a run gives does not depend on those beside it, unless the mass matrix of
/// one becomes singular: then all that run beside it need runs of their own.
pub(super) fn run<M, S, X, const N: usize, const C: usize>(
    tasks: &[Task<'_, M>],
    names: &Arc<Names>,
) -> Vec<Option<Ending>>
where
    M: Mechanism<N, C> + 'static,
    S: Lanes,
    X: Scheme,
{
    let mut endings: Vec<Option<Ending>> = tasks.iter().map(|_| None).collect();
    let Some(first) = tasks.first() else { return endings };
    let mut waiting = tasks.iter().enumerate();
    let mut pack = Pack::<M, S, N, C>::new::<X>(first);
    loop {
        let mut loaded = false;
        for index in 0..S::LANES {
            match pack.lanes[index].doing {
                Doing::Runs(_) => continue,
                Doing::Ended(place) => endings[place] = pack.ending(index, names),
                Doing::Waits => (),
            }
            pack.lanes[index].doing = Doing::Waits;
            if let Some((place, task)) = waiting.next() {
                pack.load(index, Lane { doing: Doing::Runs(place), ..Lane::new::<X>(task) }, task.start);
                loaded = true;
            }
        }
        let Some(busy) = pack.lanes.iter().position(Lane::runs) else { return endings };
        let prepared = if loaded { pack.prepare::<X>(busy) } else { Ok(()) };
        if prepared.and_then(|()| pack.step::<X>()).is_err() {
            // One mass matrix is singular: who has it will be found where each goes by itself.
            pack.lanes.iter_mut().for_each(|lane| lane.doing = Doing::Waits);
        }
    }
}

/// The lanes at work.
struct Pack<'a, M: Mechanism<N, C>, S: Lanes, const N: usize, const C: usize> {
    lanes: Vec<Lane<'a, M>>,
    constants: M::Constants<S>,
    /// ε.
    relative: S,
    /// The largest range of a coordinate that counts.
    widest: Vec<f64>,
    /// The least unit of its errors: without end for the hidden coordinate of a state of first order.
    least: Vec<f64>,
    step: Attempt<S, N>,
    /// The least and the largest that each component was.
    low: Block<S, N>,
    high: Block<S, N>,
    /// Pairs (argument, rate) of local functions at the start and at the end of a step.
    pairs: [Vec<S>; 2],
    /// What they are arguments of, and by which factor that of a power may change.
    arguments: Vec<(Role, f64)>,
}

/// So many rejections in a row are no matter of the step any more.
const STUBBORN: u32 = 12;

impl<'a, M: Mechanism<N, C> + 'static, S: Lanes, const N: usize, const C: usize> Pack<'a, M, S, N, C> {
    /// Lanes that wait at the start of a task.
    fn new<X: Scheme>(task: &'a Task<'a, M>) -> Self {
        let description = M::description();
        let step = Attempt::new();
        let pairs = || vec![S::from_f64(0.0); 2 * description.arguments.len()];
        let arguments = description.arguments.iter().map(|argument| (argument.role, calm_ratio(argument.role, 1.0)));
        let mut pack = Pack {
            lanes: (0..S::LANES).map(|_| Lane::new::<X>(task)).collect(),
            constants: M::constants(|_| task.mechanism.clone()),
            relative: S::from_f64(task.tolerance),
            widest: widest(description),
            least: description
                .coordinates
                .iter()
                .map(|coordinate| if coordinate.state().is_some() { f64::INFINITY } else { LEAST })
                .collect(),
            low: step.y,
            high: step.y,
            step,
            pairs: [pairs(), pairs()],
            arguments: arguments.collect(),
        };
        (0..S::LANES).for_each(|index| pack.load(index, Lane::new::<X>(task), task.start));
        pack
    }

    /// Gives a lane another task, and a state.
    fn load(&mut self, index: usize, lane: Lane<'a, M>, (q, v): (&[f64], &[f64])) {
        self.lanes[index] = lane;
        for (half, values) in [q, v].into_iter().enumerate() {
            for (i, value) in values.iter().enumerate() {
                let replaced = |old: S, value| S::gather(|lane| if lane == index { value } else { old.lane(lane) });
                let [y, low, high] = [&mut self.step.y, &mut self.low, &mut self.high].map(|block| &mut block[half][i]);
                (*y, *low, *high) = (replaced(*y, *value), replaced(*low, *value), replaced(*high, *value));
                self.step.carry[half][i] = replaced(self.step.carry[half][i], 0.0);
            }
        }
    }

    /// Computes what new tasks need before a step.  Lanes that wait stand where a busy one is.
    fn prepare<X: Scheme>(&mut self, busy: usize) -> Result<(), SingularMass> {
        let (task, clock) = (self.lanes[busy].task, self.lanes[busy].clock);
        let [q, v] = self.step.y.map(|half| half.map(|value| value.lane(busy)));
        for index in (0..S::LANES).filter(|index| *index != busy) {
            if self.lanes[index].doing == Doing::Waits {
                self.load(index, Lane { clock, ..Lane::new::<X>(task) }, (&q, &v));
            }
        }
        self.constants = M::constants(|index| self.lanes[index].task.mechanism.clone());
        self.relative = S::gather(|index| self.lanes[index].task.tolerance);
        let t = S::gather(|index| self.lanes[index].clock.now());
        rate::<M, S, N, C>(&self.constants, t, &self.step.y, &mut self.step.stages[0])?;
        self.measure(t, 0, 0);
        Ok(())
    }

    /// Tries a step of every lane, and takes it where it is good.
    fn step<X: Scheme>(&mut self) -> Result<(), SingularMass> {
        self.lanes.iter_mut().for_each(Lane::plan);
        let h = S::gather(|index| self.lanes[index].trial.h);
        let next = S::gather(|index| self.lanes[index].trial.next);
        let t = S::gather(|index| self.lanes[index].clock.now());
        let constants = &self.constants;
        X::attempt(&mut self.step, (t, h, next), |t, y, of| rate::<M, S, N, C>(constants, t, y, of))?;
        self.measure(next, 1, X::END);
        let error = self.error::<X>(h);
        for index in 0..S::LANES {
            let clear = !self.lanes[index].runs() || self.excludes_feature(index, self.lanes[index].trial.h);
            self.lanes[index].judge(error.lane(index), clear, X::END as u64);
        }
        let takes = S::gather(|index| if self.lanes[index].takes { 1.0 } else { -1.0 });
        self.step.take::<X>(takes);
        for (half, y) in self.step.y.iter().enumerate() {
            for (i, y) in y.iter().enumerate() {
                self.low[half][i] = self.low[half][i].min(*y);
                self.high[half][i] = self.high[half][i].max(*y);
            }
        }
        let [start, end] = &mut self.pairs;
        for (start, end) in start.iter_mut().zip(end) {
            *start = takes.select_nonnegative(*end, *start);
        }
        Ok(())
    }

    /// The error in units of the tolerance, as [`Tolerance`](crate::integrate::Tolerance) has them; NaN where the rate at the
    /// end is not finite.
    fn error<X: Scheme>(&self, h: S) -> S {
        let (number, step) = (S::from_f64, &self.step);
        let error = X::error(step, h, |half, i| {
            let (low, high, y) = (self.low[half][i], self.high[half][i], step.y[half][i]);
            let range = if half == 0 { (high - low).min(number(self.widest[i])) } else { high - low };
            let rounding = number(ROUNDING) * low.abs().max(high.abs());
            let change = (step.end[half][i] - y).abs().max((h * step.stages[0][half][i]).abs());
            let least = if half == 0 { self.least[i] } else { LEAST };
            (self.relative * range.max(change)).max(rounding).max(number(least))
        });
        let rates = step.stages[X::END].iter().flatten();
        rates.fold(error, |error, rate| error + number(0.0) * *rate)
    }

    /// The arguments at the start (0) or at the end (1) of a step, where the rate is that of a stage.
    fn measure(&mut self, t: S, at: usize, stage: usize) {
        if self.arguments.is_empty() {
            return;
        }
        let [q, v] = if at == 0 { &self.step.y } else { &self.step.end };
        let [_, a] = &self.step.stages[stage];
        let u = M::inputs(&self.constants, t);
        let none = [S::from_f64(0.0); C];
        M::arguments(&self.constants, t, u.as_ref(), q, v, a, &none, &mut self.pairs[at]);
    }

    /// Whether all arguments of a lane keep clear of their features in a step of h seconds, as far as its ends tell.
    fn excludes_feature(&self, lane: usize, h: f64) -> bool {
        let ends = |index: usize| {
            let pair = |pairs: &[S]| (pairs[2 * index].lane(lane), pairs[2 * index + 1].lane(lane));
            (pair(&self.pairs[0]), pair(&self.pairs[1]))
        };
        let mut arguments = self.arguments.iter().enumerate();
        arguments.all(|(index, (role, ratio))| excludes_feature(*role, *ratio, 1.0, h, ends(index)))
    }

    /// How the run of a lane ended; `None` where its energy, or what is claimed to be conserved, is off.
    fn ending(&self, index: usize, names: &Arc<Names>) -> Option<Ending> {
        let Lane { task, work, clock, .. } = &self.lanes[index];
        let description = M::description();
        let system = Dynamic::<M, N, C>::new(task.mechanism.clone());
        let [q, v] = self.step.y.map(|half| half.map(|value| value.lane(index)));
        let (start, end) = ([task.start.0, task.start.1].concat(), [q, v].concat());
        let mut monitor = Monitor::new(&system, task.span.0, &start, 0.0);
        monitor.observe(&system, clock.now(), &end, 0.0);
        // What forces without a potential did is not counted here.
        let balance = description.structure.conservative.then(|| monitor.energy_balance()).flatten();
        let drifts = monitor.drifts(description).into_iter().filter_map(|drift| drift.value).chain(balance);
        if drifts.fold(0.0, f64::max) > usual_drift(Some(task.tolerance), work.steps) {
            return None;
        }
        let mut outputs = vec![f64::NAN; names.outputs.len()];
        evaluate_outputs(&system, clock.now(), &end, &mut [0.0; N], &mut outputs);
        let state = State { t: clock.now(), q: q.to_vec(), v: v.to_vec(), outputs, names: Arc::clone(names) };
        Some(Ending { state, work: *work, warnings: Vec::new() })
    }
}

/// [q'; q''] of all lanes.
#[inline(always)]
fn rate<M, S, const N: usize, const C: usize>(
    constants: &M::Constants<S>,
    t: S,
    [q, v]: &Block<S, N>,
    rate: &mut Block<S, N>,
) -> Result<(), SingularMass>
where
    M: Mechanism<N, C>,
    S: Lanes,
{
    rate[0] = *v;
    M::accelerations(constants, t, M::inputs(constants, t).as_ref(), q, v, &mut rate[1])
}

/// One run of many.
struct Lane<'a, M> {
    doing: Doing,
    task: &'a Task<'a, M>,
    clock: Clock,
    control: StepControl,
    /// The step that the control proposes.
    h: f64,
    trial: Trial,
    /// Whether the step that was tried is good.
    takes: bool,
    /// Rejections in a row.
    rejected: u32,
    work: Work,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Doing {
    /// Runs the task of this number.
    Runs(usize),
    /// Has run it.
    Ended(usize),
    /// Nothing: it keeps a state, and takes steps of no length.
    Waits,
}

/// A step to try.
#[derive(Clone, Copy)]
struct Trial {
    h: f64,
    next: f64,
    lands: bool,
}

impl<'a, M> Lane<'a, M> {
    /// One that waits, with all that its task needs.
    fn new<X: Scheme>(task: &'a Task<'a, M>) -> Self {
        let (from, until) = task.span;
        Lane {
            doing: Doing::Waits,
            task,
            clock: Clock::new(from),
            control: StepControl::new(X::CONTROL),
            h: first_step(&X::CONTROL, task.tolerance, until - from),
            trial: Trial { h: 0.0, next: from, lands: false },
            takes: false,
            rejected: 0,
            // At the start.
            work: Work { evaluations: 1, ..Work::default() },
        }
    }

    fn runs(&self) -> bool {
        matches!(self.doing, Doing::Runs(_))
    }

    /// Takes or rejects the step that was tried, which took so many evaluations.
    fn judge(&mut self, error: f64, clear: bool, evaluations: u64) {
        let Doing::Runs(place) = self.doing else {
            self.takes = false;
            return;
        };
        let Trial { h, lands, .. } = self.trial;
        self.work.evaluations += evaluations;
        self.takes = error <= 1.0 && clear;
        if self.takes {
            self.rejected = 0;
            self.work.steps += 1;
            let proposal = self.control.accepted(h, error);
            if lands {
                self.clock.set(self.task.span.1);
                self.doing = Doing::Ended(place);
            } else {
                self.clock.step(h);
                self.h = proposal;
            }
        } else {
            self.rejected += 1;
            self.work.rejected += 1;
            self.h = self.control.rejected(h, error);
            let vanishes = self.h < 16.0 * f64::EPSILON * self.clock.now().abs() || self.h < f64::MIN_POSITIVE;
            if error <= 1.0 || vanishes || self.rejected > STUBBORN {
                self.doing = Doing::Waits;
            }
        }
        if self.work.steps >= self.task.max_steps && self.runs() {
            self.doing = Doing::Waits;
        }
    }

    /// The next step to try.
    fn plan(&mut self) {
        let now = self.clock.now();
        let left = self.task.span.1 - now;
        let h = if left < 2.0 * self.h { 0.5 * left } else { self.h };
        self.trial = match self.doing {
            Doing::Runs(_) if left <= 1.01 * self.h => Trial { h: left, next: self.task.span.1, lands: true },
            Doing::Runs(_) => Trial { h, next: self.clock.after(h), lands: false },
            _ => Trial { h: 0.0, next: now, lands: false },
        };
    }
}
