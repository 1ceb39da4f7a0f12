//! What a run returns.

mod contacts;
mod continuous;
mod deviation;
mod digits;
mod extremes;
mod failure;
#[cfg(feature = "cli")]
mod forces;
mod frames;
mod hermite;
mod instants;
pub(crate) mod integrals;
mod junctions;
mod parts;
mod record;
mod resample;
mod state;
mod stepped_over;
mod symmetry;
mod tables;
mod trajectory;
mod trust;

use std::fmt;
use std::sync::Arc;

use crate::constrain::Residuals;

pub use contacts::ContactHistory;
pub(crate) use continuous::Continuous;
pub(crate) use deviation::apart_by;
pub use digits::Digits;
#[cfg(feature = "interpret")]
pub(crate) use digits::written;
pub use failure::Failure;
#[cfg(feature = "cli")]
pub(crate) use forces::Forces;
pub(crate) use frames::Scenery;
pub(crate) use instants::uneven;
pub(crate) use junctions::{Junction, Side, SpeedJump};
pub use parts::RunPart;
pub(crate) use parts::{PartRun, Together, instant, put_together};
#[cfg(feature = "ensemble")]
pub(crate) use record::usual_drift;
pub(crate) use record::{Plan, Recorder, evaluate_outputs};
pub(crate) use state::Names;
pub use state::State;
#[cfg(feature = "interpret")]
pub(crate) use state::plain;
pub use stepped_over::{Overlap, SteppedContact, SteppedOver};
pub use symmetry::Symmetry;
pub(crate) use trajectory::Trajectory;
pub use trust::Trust;

pub use crate::events::Impulse;
use crate::integrate::Tally;
use crate::mechanism::{Description, HIDDEN, Method, Sampling, Trigger};
use crate::trust::{Conditioning, Drift, Warning};

/// A motion that was computed, and what tells how far it can be trusted.
#[derive(Clone)]
#[non_exhaustive]
pub struct Run {
    /// The method that was used; never [`Method::Auto`].  Where [`Run::parts`] were run apart, that of the one with most evaluations.
    pub method: Method,
    /// Why `auto` chose it; `None` where the user did.
    pub why: Option<&'static str>,
    /// The relative tolerance; `None` at a fixed step that was given.
    pub tolerance: Option<f64>,
    /// The fixed step, s, if there was one; of symplectic methods also where it was found from the tolerance.
    pub step: Option<f64>,
    /// The system of momentum balances that the accelerations came from; `None`: Lagrange's equations.
    pub balances: Option<Conditioning>,
    /// Events that were recorded or that ended the run, in order.
    pub events: Vec<Occurrence>,
    /// The phases that the motion went through, by their places, with the time at which each began, s.
    pub phases: Vec<(f64, usize)>,
    /// How far the reported states and the ends of steps were from the constraints; `None` without constraints.
    pub residuals: Option<Residuals>,
    /// Jumps of the speeds where inputs turn sharply or jump, in order.
    pub impulses: Vec<Impulse>,
    /// Work done.
    pub work: Work,
    /// Drift of each conserved quantity that the model file names.
    pub drift: Vec<Drift>,
    /// Drift of the energy balance: energy less the work of what has no potential.  `None` when the run
    /// did not watch it, or where it is not finite.
    pub energy_balance: Option<f64>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// Decoupled subsystems of the mechanism, where each was run by itself with its own method and steps; else none.
    pub parts: Vec<RunPart>,
    /// How many digits of its numbers hold; `None` if the run was not told to estimate them, or could not.
    pub digits: Option<Digits>,
    /// What is held at the end, in the order of [`Sampling::memory`](crate::mechanism::Sampling::memory).
    pub(crate) memory: Vec<f64>,
    /// The same once all that happens at the start is done.
    pub(crate) memory_at_start: Vec<f64>,
    /// The numbers of the next ticks of all clocks.
    pub(crate) ticks: Vec<u64>,
    /// The length of the next step, s, and the least and largest values of [q; q'] so far; `None` at a fixed step.
    pub(crate) resumed: Option<(f64, [Vec<f64>; 2])>,
    pub(crate) sampling: Arc<Sampling>,
    /// Time it took, s; 0 in a browser, where no clock is.
    pub seconds: f64,
    /// The largest eigenvalue of the system linearised at the start, 1/s; 0 where it is not known.
    pub(crate) fastest: f64,
    pub(crate) ended_by: Option<usize>,
    /// What contacts did, where steps went over them.
    pub(crate) tally: Option<Box<Tally>>,
    pub(crate) times: Vec<f64>,
    /// Whether states were reported closer than planned, since the run ended early.
    pub(crate) is_filled: bool,
    pub(crate) rows: Vec<f64>,
    /// How far each component of [q; q'] has gone, between reported times too; empty at a fixed step.
    pub(crate) swept: Vec<f64>,
    /// Instants at which the equations change, if the run was told to keep them.
    pub(crate) junctions: Vec<Junction>,
    /// When steps ended, after the start, s; empty if the run was not told to keep that.
    pub(crate) step_ends: Vec<f64>,
    pub(crate) outputs: Vec<f64>,
    pub(crate) scenery: Scenery,
    /// Empty if the run was told to keep no dense output.
    pub(crate) trajectory: Trajectory,
    pub(crate) names: Arc<Names>,
    pub(crate) description: Arc<Description>,
}

/// How much there is of it, and how well it went: its numbers would fill many screens.
impl fmt::Debug for Run {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = f.debug_struct("Run");
        text.field("method", &self.method).field("tolerance", &self.tolerance).field("step", &self.step);
        text.field("until", &self.times.last()).field("states", &self.times.len()).field("events", &self.events.len());
        text.field("work", &self.work).field("warnings", &self.warnings).finish_non_exhaustive()
    }
}

/// An event that happened.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Occurrence {
    /// Its label in the model file.
    pub name: String,
    /// Its index among `description().events`.
    pub event: usize,
    /// The state in which it happened.
    pub state: State,
}

/// What a run cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Work {
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Evaluations of the accelerations for integrating.
    pub evaluations: u64,
    /// Evaluations of the Jacobians for integrating.
    pub jacobians: u64,
    /// Factorizations of iteration matrices.
    pub factorizations: u64,
    /// Steps that passed the error test and were tried again, shorter, because something was seen between their ends.
    pub retries: u64,
    /// Samples of events, discontinuities and arguments of local functions along steps; none evaluates accelerations.
    pub samples: u64,
}

impl Work {
    /// The work of two runs.
    pub(crate) fn plus(&self, other: &Work) -> Work {
        Work {
            steps: self.steps + other.steps,
            rejected: self.rejected + other.rejected,
            evaluations: self.evaluations + other.evaluations,
            jacobians: self.jacobians + other.jacobians,
            factorizations: self.factorizations + other.factorizations,
            retries: self.retries + other.retries,
            samples: self.samples + other.samples,
        }
    }
}

impl Run {
    /// The reported times, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// How many states are reported; at least one.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// False: a run has at least its start.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// The reported state of this index, with its outputs.
    ///
    /// # Panics
    /// If the index is not below [`Run::len`].
    pub fn state(&self, index: usize) -> State {
        let n = self.names.coordinates.len();
        let m = self.names.outputs.len();
        let row = &self.rows[2 * n * index..][..2 * n];
        State {
            t: self.times[index],
            q: row[..n].to_vec(),
            v: row[n..].to_vec(),
            outputs: self.outputs[m * index..][..m].to_vec(),
            names: self.names.clone(),
        }
    }

    /// All reported states row by row, [q; q'] each, in the order of [`Run::column_names`].
    pub fn state_rows(&self) -> &[f64] {
        &self.rows
    }

    /// The outputs at all reported times, row by row, component by component; NaN where absent.
    pub fn output_rows(&self) -> &[f64] {
        &self.outputs
    }

    /// A held value at the end, by its name in the file.
    pub fn memory(&self, name: &str) -> Option<f64> {
        self.memory.get(self.sampling.place_of(name)?).copied()
    }

    /// How many ticks each event has had that happens `every` so often, by its name; those before the run where it goes on from another one.
    pub fn ticks(&self) -> impl Iterator<Item = (&str, u64)> {
        let clock = |(event, trigger): (usize, &Trigger)| match trigger {
            Trigger::Tick(clock) => {
                Some((self.description.events.get(event)?.name.as_ref(), *self.ticks.get(*clock as usize)?))
            }
            _ => None,
        };
        self.sampling.triggers.iter().enumerate().filter_map(clock)
    }

    /// By which methods: one, or those of the parts that were run apart.
    pub fn by(&self) -> String {
        let mut names: Vec<&str> = self.parts.iter().map(|part| part.method.name()).collect();
        names.sort_unstable();
        names.dedup();
        if names.is_empty() { self.method.to_string() } else { names.join(" and ") }
    }

    /// All reported states.
    pub fn states(&self) -> impl Iterator<Item = State> + '_ {
        (0..self.len()).map(|index| self.state(index))
    }

    /// The first state.
    pub fn first(&self) -> State {
        self.state(0)
    }

    /// The last state.
    pub fn last(&self) -> State {
        self.state(self.len() - 1)
    }

    /// The state at any time of the run by dense output, without outputs.
    ///
    /// `None` outside of the run, and if the run was told to keep no dense output.
    pub fn at(&self, t: f64) -> Option<State> {
        let n = self.names.coordinates.len();
        let mut y = vec![0.0; 2 * n];
        if !self.trajectory.evaluate(t, &mut y) {
            return None;
        }
        let v = y.split_off(n);
        Some(State { t, q: y, v, outputs: Vec::new(), names: self.names.clone() })
    }

    /// One coordinate, rate (`theta'`) or output at all reported times, NaN where absent.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        if name == "t" {
            return Some(self.times.clone());
        }
        Some(self.reported(self.names.place(name)?).copied().collect())
    }

    /// What was reported of the column at this place.
    fn reported(&self, place: usize) -> impl DoubleEndedIterator<Item = &f64> {
        let states = 2 * self.names.coordinates.len();
        let (values, size, index) = match place.checked_sub(states) {
            None => (&self.rows, states, place),
            Some(output) => (&self.outputs, self.names.outputs.len(), output),
        };
        values.iter().skip(index).step_by(size)
    }

    /// Names of the columns: coordinates, their rates, outputs component by component; in the places of hidden coordinates of states of first
    /// order names that begin with `∫`, in those of their rates the states.
    pub fn column_names(&self) -> Vec<String> {
        self.names.columns()
    }

    /// The names of the columns without hidden ones.
    pub fn shown_names(&self) -> Vec<String> {
        self.column_names().into_iter().filter(|name| !name.starts_with(HIDDEN)).collect()
    }

    /// What the model draws at up to some thousands of times, evaluated now.
    pub(crate) fn frames(&self) -> Vec<(f64, Vec<f64>)> {
        self.scenery.frames(&self.trajectory)
    }

    /// Warns of what the file says is conserved, where it drifts by more than usual.
    fn warn_of_drift(&mut self, limit: f64) {
        for drift in &self.drift {
            if let Some(value) = drift.value.filter(|value| *value > limit) {
                let invariant = drift.name.clone();
                self.warnings.push(Warning::InvariantDrifts { invariant, drift: value, limit });
            }
        }
    }

    /// The event that ended the run, if one did.
    pub fn ended_by(&self) -> Option<&Occurrence> {
        self.ended_by.and_then(|index| self.events.get(index))
    }

    /// How far the run can be trusted, as a report to print.
    pub fn trust(&self) -> Trust<'_> {
        Trust(self)
    }
}
