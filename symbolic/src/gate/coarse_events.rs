//! Events that change the phase or the speeds in a coarse run.
//!
//! Located roughly, on the cubic through a step; a stop is none, so that a scene's run goes on to its end.

use super::motion::{Motion, Rough};
use super::trajectory::Passed;
use crate::expr::{Id, Tape};
use crate::model::{EventAction, Model};

/// An event is past its zero where its function is more than this part of the largest that it was.
const PAST: f64 = 1e-6;
/// More of these at one instant are a cycle.
const AT_AN_INSTANT: usize = 4;
/// More impacts in succession, each flight shorter than the one before, end in contact.
const SUCCESSION: usize = 8;

/// The events of a model that turn its motion.
pub(super) struct Turns {
    events: Vec<Turn>,
    /// What is watched, then conditions, then coefficients of restitution.
    tape: Tape,
    /// Rows and phases of constraints: where a contact begins that impacts lead to.
    phases: Vec<Vec<usize>>,
}

struct Turn {
    /// Its place among all events of the file.
    place: usize,
    direction: i8,
    phases: Option<Vec<usize>>,
    when: usize,
    condition: Option<usize>,
    actions: Vec<Act>,
}

enum Act {
    Phase(usize),
    Impact { restitution: usize, rows: Vec<usize> },
}

/// A jump of the speeds along a run.
#[derive(Clone, Debug)]
pub(super) struct VelocityJump {
    pub t: f64,
    pub q: Vec<f64>,
    /// A phase in which all that push act.
    pub phase: usize,
    /// Rows of the constraints that push, and how much the rate of each changes.
    pub rows: Vec<(usize, f64)>,
}

/// What is known of the events along a run.
#[derive(Clone, Debug, Default)]
pub(super) struct Watched {
    /// Values of the functions at the last step's end.
    values: Vec<f64>,
    /// The largest that each was.
    largest: Vec<f64>,
    /// Impacts of each event in succession, when the last was, and how long the last flight took.
    impacts: Vec<(usize, f64, f64)>,
    /// Jumps of the speeds so far.
    pub blows: Vec<VelocityJump>,
    /// Events with impacts so far, by their places in the file, and where they happened.
    pub hits: Vec<(usize, Passed)>,
}

impl Turns {
    pub fn new(model: &Model) -> Turns {
        let mut roots: Vec<Id> = Vec::new();
        let mut root = |id: Id| {
            roots.push(id);
            roots.len() - 1
        };
        let mut events = Vec::new();
        for (place, event) in model.events.iter().enumerate() {
            let act = |action: &EventAction| match *action {
                EventAction::Stop | EventAction::Record | EventAction::Set(_) | EventAction::Contact(_) => None,
                EventAction::Phase(phase) => Some(Act::Phase(phase)),
                EventAction::Impact { restitution, along } => {
                    let rows = model.constraints[along].rows().collect();
                    Some(Act::Impact { restitution: root(restitution), rows })
                }
            };
            let actions: Vec<Act> = event.actions.iter().filter_map(act).collect();
            if !actions.is_empty() {
                let (when, condition) = (root(event.when), event.condition.map(&mut root));
                events.push(Turn {
                    place,
                    direction: event.direction,
                    phases: event.phases.clone(),
                    when,
                    condition,
                    actions,
                });
            }
        }
        let tape = Tape::new(&model.graph, &roots);
        Turns { events, tape, phases: model.phases.iter().map(|phase| model.rows_of(phase)).collect() }
    }

    /// Whether nothing turns.
    pub fn is_empty(&self) -> bool {
        self.events.is_empty()
    }

    /// Begins anew: nothing happened before this state.
    pub fn watch(&self, rough: &Rough, watched: &mut Watched) {
        let all = self.tape.evaluate(|s| rough.value(s));
        watched.values = self.events.iter().map(|event| all[event.when]).collect();
        watched.largest.resize(self.events.len(), 0.0);
        watched.impacts.resize(self.events.len(), (0, 0.0, 0.0));
        for (largest, value) in watched.largest.iter_mut().zip(&watched.values) {
            *largest = largest.max(value.abs());
        }
    }

    /// The first event whose zero lies between the last step's end and this state.
    pub fn crossed(&self, rough: &Rough, watched: &Watched) -> Option<usize> {
        let all = self.tape.evaluate(|s| rough.value(s));
        (0..self.events.len()).find(|&k| {
            let (event, before) = (&self.events[k], watched.values.get(k).copied().unwrap_or(0.0));
            let now = all[event.when];
            let falls = before > 0.0 && now <= 0.0 && event.direction <= 0;
            let rises = before < 0.0 && now >= 0.0 && event.direction >= 0;
            (falls || rises) && event.counts(rough.at.phase, &all)
        })
    }

    /// Does what an event says, then what events say that are past their zero after it; false where this ends nowhere.
    /// Accelerations are those of the state that it leaves.
    pub fn act(&self, motion: &Motion, rough: &mut Rough, first: usize, watched: &mut Watched) -> bool {
        let mut next = Some(first);
        for _ in 0..AT_AN_INSTANT {
            let Some(k) = next else { return true };
            let phase = rough.at.phase;
            if !self.perform(motion, rough, k, watched) || !motion.roughly(rough) {
                return false;
            }
            self.watch(rough, watched);
            next = (rough.at.phase != phase).then(|| self.past(rough, watched)).flatten();
        }
        false
    }

    fn perform(&self, motion: &Motion, rough: &mut Rough, k: usize, watched: &mut Watched) -> bool {
        let all = self.tape.evaluate(|s| rough.value(s));
        if self.events[k].actions.iter().any(|action| matches!(action, Act::Impact { .. })) {
            let at = &rough.at;
            let here = Passed { t: at.t, q: at.q.clone(), v: at.v.clone(), phase: at.phase };
            watched.hits.push((self.events[k].place, here));
        }
        for action in &self.events[k].actions {
            let (kick, seen) = match action {
                Act::Phase(phase) => {
                    rough.at.phase = *phase;
                    (motion.kick(rough, &[], |_| 0.0), Some(*phase))
                }
                Act::Impact { rows, .. } if self.accumulates(k, rough.at.t, watched) => {
                    let Some(phase) = self.in_contact(motion, rough.at.phase, rows) else { return false };
                    rough.at.phase = phase;
                    (motion.kick(rough, &[], |_| 0.0), Some(phase))
                }
                Act::Impact { restitution, rows } => {
                    let rebound = |row: usize| if rows.contains(&row) { -all[*restitution] } else { 1.0 };
                    (motion.kick(rough, rows, rebound), self.in_contact(motion, rough.at.phase, rows))
                }
            };
            let Some(kick) = kick else { return false };
            if let Some(phase) = seen.filter(|_| kick.rows.iter().any(|(_, change)| *change != 0.0)) {
                let (t, q) = (rough.at.t, rough.at.q.clone());
                watched.blows.push(VelocityJump { t, q, phase, rows: kick.rows });
            }
            rough.at.v.iter_mut().zip(kick.speeds).for_each(|(v, change)| *v += change);
        }
        true
    }

    /// The first phase that has the constraints of another one and these.
    fn in_contact(&self, motion: &Motion, phase: usize, rows: &[usize]) -> Option<usize> {
        let active = motion.constraints.active(phase);
        self.phases.iter().position(|of| active.iter().chain(rows).all(|row| of.contains(row)))
    }

    /// Whether impacts of an event, this one among them, follow each other faster and faster.
    fn accumulates(&self, k: usize, t: f64, watched: &mut Watched) -> bool {
        let Some((count, last, flight)) = watched.impacts.get_mut(k) else { return false };
        let took = t - std::mem::replace(last, t);
        let before = std::mem::replace(flight, took);
        *count = if *count == 0 || took < before { *count + 1 } else { 1 };
        *count > SUCCESSION
    }

    /// An event that is past its zero in its direction where its phase begins.
    fn past(&self, rough: &Rough, watched: &Watched) -> Option<usize> {
        let all = self.tape.evaluate(|s| rough.value(s));
        (0..self.events.len()).find(|&k| {
            let event = &self.events[k];
            let beyond = f64::from(event.direction) * all[event.when] > PAST * watched.largest[k];
            beyond && event.phases.is_some() && event.counts(rough.at.phase, &all)
        })
    }
}

impl Turn {
    fn counts(&self, phase: usize, all: &[f64]) -> bool {
        let here = self.phases.as_ref().is_none_or(|phases| phases.contains(&phase));
        here && self.condition.is_none_or(|condition| all[condition] > 0.0)
    }
}
