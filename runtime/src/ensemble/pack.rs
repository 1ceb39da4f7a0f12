//! As many runs as there are lanes, each at its own time and with its own step.

use std::sync::Arc;

use super::{Ending, Lanes};
use crate::events::{calm_ratio, keeps_clear};
use crate::integrate::{Clock, DOP853, Dop853, LEAST, ROUNDING, Stage, StepControl, Term, first_step, stages, widest};
use crate::mechanism::{Erased, Mechanism, Role, SingularMass};
use crate::run::{Names, State, Work, evaluate_outputs, usual_drift};
use crate::trust::Monitor;

/// A run that waits for a lane.
pub(super) struct Task<'a, M> {
    /// The mechanism with its parameters.
    pub mechanism: &'a M,
    /// From when to when, s.
    pub span: (f64, f64),
    /// (q, q') at the start.
    pub start: (&'a [f64], &'a [f64]),
    pub tolerance: f64,
    pub max_steps: u64,
}

/// Runs all tasks; `None` stands where something must be looked at, so that a run of its own is needed.
///
/// A lane that is done takes the next task.  What a run gives does not depend on those beside it, unless the mass matrix of
/// one becomes singular: then all that run beside it need runs of their own.
pub(super) fn run<M, S, const N: usize, const C: usize>(
    tasks: &[Task<'_, M>],
    names: &Arc<Names>,
) -> Vec<Option<Ending>>
where
    M: Mechanism<N, C> + 'static,
    S: Lanes,
{
    let mut endings: Vec<Option<Ending>> = tasks.iter().map(|_| None).collect();
    let Some(first) = tasks.first() else { return endings };
    let mut waiting = tasks.iter().enumerate();
    let mut pack = Pack::<M, S, N, C>::new(first);
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
                pack.load(index, Lane { doing: Doing::Runs(place), ..Lane::new(task) }, task.start);
                loaded = true;
            }
        }
        let Some(busy) = pack.lanes.iter().position(Lane::runs) else { return endings };
        let prepared = if loaded { pack.prepare(busy) } else { Ok(()) };
        if prepared.and_then(|()| pack.step()).is_err() {
            // One mass matrix is singular: who has it will be found where each goes by itself.
            pack.lanes.iter_mut().for_each(|lane| lane.doing = Doing::Waits);
        }
    }
}

/// [q, q'] of all lanes.
type Block<S, const N: usize> = [[S; N]; 2];

/// The lanes at work.
struct Pack<'a, M: Mechanism<N, C>, S: Lanes, const N: usize, const C: usize> {
    lanes: Vec<Lane<'a, M>>,
    constants: M::Constants<S>,
    /// ε.
    relative: S,
    /// The largest range of a coordinate that counts.
    widest: Vec<f64>,
    y: Block<S, N>,
    /// What rounding took from y in the last step.
    carry: Block<S, N>,
    /// The least and the largest that each component was.
    low: Block<S, N>,
    high: Block<S, N>,
    /// Rates over a step: the first at its start, the last at its end.
    stages: [Block<S, N>; END + 1],
    end: Block<S, N>,
    /// What the step adds, with what was left over from the one before.
    increment: Block<S, N>,
    /// Pairs (argument, rate) of local functions at the start and at the end of a step.
    pairs: [Vec<S>; 2],
    /// What they are arguments of, and by which factor that of a power may change.
    arguments: Vec<(Role, f64)>,
}

/// The stage that is the rate at the end of a step.
const END: usize = DOP853.end_stage();
/// So many rejections in a row are no matter of the step any more.
const STUBBORN: u32 = 12;

impl<'a, M: Mechanism<N, C> + 'static, S: Lanes, const N: usize, const C: usize> Pack<'a, M, S, N, C> {
    /// Lanes that wait at the start of a task.
    fn new(task: &'a Task<'a, M>) -> Self {
        let description = M::description();
        let zeros = [[S::from_f64(0.0); N]; 2];
        let pairs = || vec![S::from_f64(0.0); 2 * description.arguments.len()];
        let arguments = description.arguments.iter().map(|argument| (argument.role, calm_ratio(argument.role, 1.0)));
        let mut pack = Pack {
            lanes: (0..S::LANES).map(|_| Lane::new(task)).collect(),
            constants: M::constants(|_| task.mechanism.clone()),
            relative: S::from_f64(task.tolerance),
            widest: widest(description),
            y: zeros,
            carry: zeros,
            low: zeros,
            high: zeros,
            stages: [zeros; END + 1],
            end: zeros,
            increment: zeros,
            pairs: [pairs(), pairs()],
            arguments: arguments.collect(),
        };
        (0..S::LANES).for_each(|index| pack.load(index, Lane::new(task), task.start));
        pack
    }

    /// Gives a lane another task, and a state.
    fn load(&mut self, index: usize, lane: Lane<'a, M>, (q, v): (&[f64], &[f64])) {
        self.lanes[index] = lane;
        for (half, values) in [q, v].into_iter().enumerate() {
            for (i, value) in values.iter().enumerate() {
                let replaced = |old: S, value| S::gather(|lane| if lane == index { value } else { old.lane(lane) });
                let [y, low, high] = [&mut self.y, &mut self.low, &mut self.high].map(|block| &mut block[half][i]);
                (*y, *low, *high) = (replaced(*y, *value), replaced(*low, *value), replaced(*high, *value));
                self.carry[half][i] = replaced(self.carry[half][i], 0.0);
            }
        }
    }

    /// Computes what new tasks need before a step.  Lanes that wait stand where a busy one is.
    fn prepare(&mut self, busy: usize) -> Result<(), SingularMass> {
        let (task, clock) = (self.lanes[busy].task, self.lanes[busy].clock);
        let [q, v] = self.y.map(|half| half.map(|value| value.lane(busy)));
        for index in (0..S::LANES).filter(|index| *index != busy) {
            if self.lanes[index].doing == Doing::Waits {
                self.load(index, Lane { clock, ..Lane::new(task) }, (&q, &v));
            }
        }
        self.constants = M::constants(|index| self.lanes[index].task.mechanism.clone());
        self.relative = S::gather(|index| self.lanes[index].task.tolerance);
        let t = S::gather(|index| self.lanes[index].clock.now());
        rate::<M, S, N, C>(&self.constants, t, &self.y, &mut self.stages[0])?;
        self.measure(t, 0);
        Ok(())
    }

    /// Tries a step of every lane, and takes it where it is good.
    fn step(&mut self) -> Result<(), SingularMass> {
        self.lanes.iter_mut().for_each(Lane::plan);
        let h = S::gather(|index| self.lanes[index].trial.h);
        let next = S::gather(|index| self.lanes[index].trial.next);
        let t = S::gather(|index| self.lanes[index].clock.now());
        self.attempt(t, h, next)?;
        self.measure(next, 1);
        let error = self.error(h);
        for index in 0..S::LANES {
            let clear = !self.lanes[index].runs() || self.keeps_clear(index, self.lanes[index].trial.h);
            self.lanes[index].judge(error.lane(index), clear);
        }
        let takes = S::gather(|index| if self.lanes[index].takes { 1.0 } else { -1.0 });
        for half in 0..2 {
            for i in 0..N {
                let (y, end, carry) = (self.y[half][i], self.end[half][i], self.carry[half][i]);
                let left = self.increment[half][i] - (end - y);
                let y = takes.select_nonnegative(end, y);
                self.y[half][i] = y;
                self.carry[half][i] = takes.select_nonnegative(left, carry);
                self.low[half][i] = self.low[half][i].min(y);
                self.high[half][i] = self.high[half][i].max(y);
                self.stages[0][half][i] = takes.select_nonnegative(self.stages[END][half][i], self.stages[0][half][i]);
            }
        }
        let [start, end] = &mut self.pairs;
        for (start, end) in start.iter_mut().zip(end) {
            *start = takes.select_nonnegative(*end, *start);
        }
        Ok(())
    }

    /// The stages of a step of h seconds, its end and the rate there.
    fn attempt(&mut self, t: S, h: S, next: S) -> Result<(), SingularMass> {
        stages!(self.stage(t, h) for 1 2 3 4 5 6 7 8 9 10 11 below END, from 1);
        for half in 0..2 {
            for i in 0..N {
                let increment = h * self.sum(DOP853.weights, half, i) + self.carry[half][i];
                self.increment[half][i] = increment;
                self.end[half][i] = self.y[half][i] + increment;
            }
        }
        rate::<M, S, N, C>(&self.constants, next, &self.end, &mut self.stages[END])
    }

    /// kᵢ = f(t + cᵢh, y + h Σ aᵢⱼkⱼ).
    #[inline(always)]
    fn stage<const I: usize>(&mut self, t: S, h: S) -> Result<(), SingularMass> {
        let mut argument = self.y;
        for (half, argument) in argument.iter_mut().enumerate() {
            for (i, argument) in argument.iter_mut().enumerate() {
                *argument = *argument + h * self.sum(Stage::<Dop853, I>::ROW, half, i);
            }
        }
        let t = t + S::from_f64(Stage::<Dop853, I>::NODE) * h;
        rate::<M, S, N, C>(&self.constants, t, &argument, &mut self.stages[I])
    }

    /// Σ aⱼkⱼ of one component.
    #[inline(always)]
    fn sum(&self, terms: &[Term], half: usize, i: usize) -> S {
        let product = |term: &Term| S::from_f64(term.value) * self.stages[term.stage][half][i];
        terms.iter().fold(S::from_f64(0.0), |sum, term| sum + product(term))
    }

    /// The error in units of the tolerance, as [`Tolerance`](crate::integrate::Tolerance) has them; NaN where the rate at the
    /// end is not finite.
    fn error(&self, h: S) -> S {
        let number = S::from_f64;
        let (higher, lower) = const { DOP853.estimate.terms() };
        let (mut five, mut three, mut nothing) = (number(0.0), number(0.0), number(0.0));
        for half in 0..2 {
            for i in 0..N {
                let (low, high, y) = (self.low[half][i], self.high[half][i], self.y[half][i]);
                let range = if half == 0 { (high - low).min(number(self.widest[i])) } else { high - low };
                let rounding = number(ROUNDING) * low.abs().max(high.abs());
                let change = (self.end[half][i] - y).abs().max((h * self.stages[0][half][i]).abs());
                let unit = (self.relative * range.max(change)).max(rounding).max(number(LEAST));
                let steps = h / unit;
                let (higher, lower) = (steps * self.sum(higher, half, i), steps * self.sum(lower, half, i));
                five = five + higher * higher;
                three = three + lower * lower;
                nothing = nothing + number(0.0) * self.stages[END][half][i];
            }
        }
        let mean = number(1.0 / (2 * N).max(1) as f64);
        let both = (five + number(0.01) * three).max(number(f64::MIN_POSITIVE));
        five * (mean / both).sqrt() + nothing
    }

    /// The arguments at the start (0) or at the end (1) of a step.
    fn measure(&mut self, t: S, at: usize) {
        if self.arguments.is_empty() {
            return;
        }
        let ([q, v], [_, a]) = if at == 0 { (&self.y, &self.stages[0]) } else { (&self.end, &self.stages[END]) };
        let u = M::inputs(&self.constants, t);
        let none = [S::from_f64(0.0); C];
        M::arguments(&self.constants, t, u.as_ref(), q, v, a, &none, &mut self.pairs[at]);
    }

    /// Whether all arguments of a lane keep clear of their features in a step of h seconds, as far as its ends tell.
    fn keeps_clear(&self, lane: usize, h: f64) -> bool {
        let ends = |index: usize| {
            let pair = |pairs: &[S]| (pairs[2 * index].lane(lane), pairs[2 * index + 1].lane(lane));
            (pair(&self.pairs[0]), pair(&self.pairs[1]))
        };
        let mut arguments = self.arguments.iter().enumerate();
        arguments.all(|(index, (role, ratio))| keeps_clear(*role, *ratio, 1.0, h, ends(index)))
    }

    /// How the run of a lane ended; `None` where its energy, or what is claimed to be conserved, is off.
    fn ending(&self, index: usize, names: &Arc<Names>) -> Option<Ending> {
        let Lane { task, work, clock, .. } = &self.lanes[index];
        let description = M::description();
        let system = Erased::<M, N, C>::new(task.mechanism.clone());
        let [q, v] = self.y.map(|half| half.map(|value| value.lane(index)));
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
    fn new(task: &'a Task<'a, M>) -> Self {
        let (from, until) = task.span;
        Lane {
            doing: Doing::Waits,
            task,
            clock: Clock::new(from),
            control: StepControl::new(DOP853.control),
            h: first_step(&DOP853.control, task.tolerance, until - from),
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

    /// Takes or rejects the step that was tried.
    fn judge(&mut self, error: f64, clear: bool) {
        let Doing::Runs(place) = self.doing else {
            self.takes = false;
            return;
        };
        let Trial { h, lands, .. } = self.trial;
        self.work.evaluations += END as u64;
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
