//! Many runs at once: in threads, and side by side in SIMD lanes.
//!
//! An [`Ensemble`] is a list of simulations of one mechanism that differ in parameters, starts, tolerances, ends.
//! - [`Ensemble::run`] gives all their [`Run`]s, [`Ensemble::map`] what a function makes of each, so that memory stays
//!   bounded; any system, any setting, in threads.
//! - [`Ensemble::ends`] gives only how each ended, and takes as many runs at a time as a SIMD register holds numbers
//!   ([`Lanes`], a type parameter), in every thread.  Each lane has its own time and its own step, and takes the next run
//!   when its own is done.
//!
//! Results are in the order of the list, and the same to the last bit whatever the number of threads.
//!
//! What goes into lanes is integrated by `rkn8` where the mass matrix is constant and forces contain no speeds, elsewhere by `dop853`,
//! with the same error norm and control as any run, and nothing is hidden.
//! A run that must be looked at more closely is run again by itself, with its warnings and errors: one that starts where the
//! equations have no meaning, whose mass matrix is singular, whose steps are rejected again and again, in which a function
//! that is local (`exp`, `tanh`, a power) changes much within a step or points come close to each other, whose energy or
//! another claimed quantity is off at its end, that takes too many steps.  What lanes do not take is run by itself from the
//! start: mechanisms with constraints, phases, events, switches, or inputs that jump or are local in time; mechanisms that
//! are driven and whose M changes; simulations with another method, a fixed or longest step, signals, another derivation, or
//! that ask for digits.
//!
//! ```
//! use dalembert::ensemble::{Ensemble, f64x8};
//! use dalembert::prelude::*;
//!
//! dalembert::model!(yaml = "
//! name: Pendulum
//! parameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2}
//! coordinates: {theta: rad}
//! points: {hinge: [0, 0]}
//! bodies: {bob: {mass: m, position: '[l*sin(theta), -l*cos(theta)]'}}
//! gravity: [0, -g]
//! scene: {start: {theta: 1}, until: 10, tolerance: 1e-9}
//! ");
//!
//! let longer = |k: i32| Pendulum { l: 1.0 + 0.01 * f64::from(k), ..Pendulum::default() };
//! let ends = (0..100).map(|k| longer(k).simulate()).collect::<Ensemble<_>>().ends::<f64x8>();
//! let run = longer(42).simulate().run().unwrap();
//! let end = ends[42].as_ref().unwrap();
//! assert!((end.state["theta"] - run.last()["theta"]).abs() < 1e-8);
//! ```

mod attempt;
mod lanes;
mod pack;
mod sine;

use std::sync::Arc;

use rayon::prelude::*;

use attempt::Rkn8;
pub use lanes::{Lanes, f64x4, f64x8};
use pack::Task;

use crate::error::Error;
use crate::integrate::Dop853;
use crate::mechanism::{At, Dynamic, Mechanism, Method, System, Watched};
use crate::run::{Names, Run, State, Work};
use crate::simulate::{Settings, Simulation};
use crate::trust::{Warning, positive_inertia};

/// Simulations of one mechanism that are run together.
#[derive(Clone, Debug)]
#[must_use = "nothing happens before `run`, `map` or `ends`"]
pub struct Ensemble<S: System> {
    members: Vec<Simulation<S>>,
    threads: Option<usize>,
}

impl<S: System> FromIterator<Simulation<S>> for Ensemble<S> {
    fn from_iter<I: IntoIterator<Item = Simulation<S>>>(members: I) -> Self {
        Ensemble { members: members.into_iter().collect(), threads: None }
    }
}

/// How one run of an ensemble ended.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Ending {
    /// The last state, with its outputs.
    pub state: State,
    /// What it cost.
    pub work: Work,
    /// What is to be known of it; nothing, where it ran in a lane.
    pub warnings: Vec<Warning>,
}

/// Lanes are filled from so many runs at a time: a thread takes as many, however many threads there are.
const CHUNK: usize = 64;

impl<S: System> Ensemble<S> {
    /// With so many threads; as many as the machine has processors unless said otherwise.
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self
    }

    /// How many runs there are.
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// Runs all.
    ///
    /// # Errors
    /// Each run has its own, as [`Simulation::run`].
    pub fn run(self) -> Vec<Result<Run, Error>>
    where
        S: Clone,
    {
        self.map(|_, run| run)
    }

    /// Runs all and hands each to `each`, with its place in the list, in the thread where it ran; what that gives is
    /// returned in the order of the list.
    pub fn map<T: Send>(self, each: impl Fn(usize, Result<Run, Error>) -> T + Sync) -> Vec<T>
    where
        S: Clone,
    {
        let Ensemble { members, threads } = self;
        spread(members.len(), threads, |index| each(index, members[index].clone().run()))
    }
}

impl<M: Mechanism<N, C> + 'static, const N: usize, const C: usize> Ensemble<Dynamic<M, N, C>> {
    /// Runs all, as many at a time as L has lanes, and says how each ended.
    ///
    /// # Errors
    /// Each run has its own, as [`Simulation::run`].
    pub fn ends<L: Lanes>(&self) -> Vec<Result<Ending, Error>> {
        let names = Arc::new(Names::of(M::description()));
        let chunks: Vec<_> = self.members.chunks(CHUNK).collect();
        let ends = spread(chunks.len(), self.threads, |index| ends::<M, L, N, C>(chunks[index], &names));
        ends.into_iter().flatten().collect()
    }
}

/// How these runs end: those that lanes take in lanes, the others one by one.
fn ends<M, L, const N: usize, const C: usize>(
    members: &[Simulation<Dynamic<M, N, C>>],
    names: &Arc<Names>,
) -> Vec<Result<Ending, Error>>
where
    M: Mechanism<N, C> + 'static,
    L: Lanes,
{
    let mut endings: Vec<Option<Ending>> = members.iter().map(|_| None).collect();
    let tasks = members.iter().enumerate().filter_map(|(place, member)| Some((place, task(member)?)));
    let (nystrom, others): (Vec<_>, Vec<_>) = tasks.partition(|(_, task)| task.method == Method::Rkn8);
    for (tasks, run) in [
        (nystrom, pack::run::<M, L, Rkn8, N, C> as fn(&[Task<'_, M>], &Arc<Names>) -> Vec<Option<Ending>>),
        (others, pack::run::<M, L, Dop853, N, C>),
    ] {
        let (places, tasks): (Vec<usize>, Vec<Task<'_, M>>) = tasks.into_iter().unzip();
        places.into_iter().zip(run(&tasks, names)).for_each(|(place, ending)| endings[place] = ending);
    }
    let endings = members.iter().zip(endings);
    endings.map(|(member, ending)| ending.map_or_else(|| alone(member), Ok)).collect()
}

/// A run by itself.
fn alone<S: System + Clone>(member: &Simulation<S>) -> Result<Ending, Error> {
    let whole = |settings: &mut Settings| {
        settings.every = Some(settings.until - settings.from).filter(|span| *span > 0.0);
        settings.dense = false;
    };
    let run = member.clone().with(whole).run()?;
    Ok(Ending { state: run.last(), work: run.work, warnings: run.warnings })
}

/// What a lane needs to know of a simulation; `None` where it is none for lanes.
fn task<M, const N: usize, const C: usize>(member: &Simulation<Dynamic<M, N, C>>) -> Option<Task<'_, M>>
where
    M: Mechanism<N, C> + 'static,
{
    let (system, settings) = member.parts()?;
    let d = M::description();
    // Without a balance of energy nothing would tell of a coordinate that fails; angles that lock keep the energy.
    let told = (d.structure.conservative || d.structure.constant_inertias) && M::gimbals().is_empty();
    let tame = d.arguments.iter().all(|argument| argument.of == Watched::Motion && !argument.time_only);
    let steady =
        d.events.is_empty() && d.switches.is_empty() && d.timed_switches.is_empty() && d.input_jumps.is_empty();
    let usual = settings.step.is_none()
        && settings.longest_step.is_none()
        && !settings.digits
        && settings.start_conditions.is_empty();
    let method = match settings.method {
        Method::Auto | Method::Rkn8 if d.structure.separable => Method::Rkn8,
        Method::Auto | Method::Dop853 => Method::Dop853,
        _ => return None,
    };
    let fits =
        C == 0 && M::MODES == 0 && M::PHASES == 0 && M::MEMORY == 0 && system.is_plain() && told && tame && steady;
    let start = [settings.q.as_slice(), settings.v.as_slice()].concat();
    let sound = || {
        let at = At::packed(settings.from, &start, N);
        system.accelerations(at, &mut [0.0; N]).is_ok()
            && positive_inertia(system, at.t, &start).is_ok()
            && settings.attainable().is_ok()
    };
    if !(fits && usual && settings.check(d).is_ok() && sound()) {
        return None;
    }
    Some(Task {
        mechanism: system.mechanism(),
        method,
        span: (settings.from, settings.until),
        start: (&settings.q, &settings.v),
        tolerance: settings.tolerance.max(Settings::TIGHTEST),
        max_steps: settings.max_steps,
    })
}

/// `work` of each of 0..count in so many threads, in that order.
pub(crate) fn spread<T: Send>(count: usize, threads: Option<usize>, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    if threads == Some(1) {
        return (0..count).map(work).collect();
    }
    let all = || (0..count).into_par_iter().map(&work).collect();
    match rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build() {
        Ok(pool) => pool.install(all),
        Err(_) => (0..count).map(&work).collect(),
    }
}
