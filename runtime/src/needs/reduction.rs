//! The file without an ingredient, and what is found of it.

use dalembert_symbolic::diagnose::Step;
use dalembert_symbolic::file::edit::source;

use super::NeedsError;
use super::candidate::Candidate;
use super::deviation::{Deviation, Motion, between, largest};
use super::edit::{Edit, edited, without_vain_claims};
use super::full::{Full, set};
use super::linear::EQUATIONS;
use super::prediction::{Law, Prediction};
use super::{below, prediction, rigid};
use crate::mechanism::System;

/// What becomes of an ingredient.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Proposal {
    /// It is not there.
    LeftOut,
    /// The coordinate keeps the place at which the forces on it vanish where the scene starts, the input its value there; or where
    /// it is on the average, whichever changes less.
    Held {
        /// The place with its unit, as the file would say.
        at: String,
    },
    /// The coordinate follows the others, where the forces on it vanish without motion; its inertia stays.
    Slaved {
        /// The place as a formula of the model language.
        to: String,
    },
    /// The family of coordinates moves in the slowest of its modes, about its place at rest.
    Modes {
        /// How many.
        kept: usize,
        /// Of how many.
        of: usize,
    },
    /// It is a constraint: a spring keeps its length; a coordinate its place, and outputs read it where the reaction moves it.
    Rigid {
        /// The length or place with its unit.
        at: String,
    },
    /// The run is as exact as this instead of what the file says.
    Looser {
        /// The tolerance that serves.
        tolerance: f64,
        /// The file's.
        own: f64,
    },
    /// It is linear about the place at which all rests: a law in what it is written in, all equations of motion in coordinates and speeds.
    Linear,
}

impl Proposal {
    /// The place or length that is kept, with its unit.
    pub(super) fn place(&self) -> Option<&str> {
        match self {
            Proposal::Held { at } | Proposal::Rigid { at } => Some(at),
            _ => None,
        }
    }
}

/// What is found of a proposal.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// The scene does not need it.
    Serves,
    /// What is wanted depends on it.
    Acts,
    /// Other events happen, or not in the same order.
    HappensOtherwise {
        /// What.
        what: String,
    },
    /// An event or discontinuity that does not happen is so close that leaving this out decides it.
    Near {
        /// Its name.
        guard: String,
        /// How far it stays from zero, in parts of the range that it goes through.
        margin: f64,
    },
    /// The file cannot be without it.
    Refused {
        /// Why.
        why: String,
    },
}

/// One ingredient, left out.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ModelReduction {
    /// `springs.tyre`, `bodies.hook.inertia`, `coordinates.rope`.
    pub ingredient: String,
    /// What becomes of it.
    pub proposal: Proposal,
    /// What that changes; `None` where nothing could be compared.
    pub deviation: Option<Deviation>,
    /// What that changes by a first approximation; `None` where there is none.
    pub predicted: Option<Prediction>,
    /// By how many times less work the scene takes.
    pub saving: f64,
    /// What is found.
    pub verdict: Verdict,
    /// Whether this is a coordinate in a subsystem on which nothing wanted depends, by the equations themselves.
    pub not_depended_on: bool,
    /// An event or discontinuity that does not happen, and goes with it or is moved by it: its name, and how far it stays from zero, in
    /// parts of the range that it goes through.
    pub margin: Option<(String, f64)>,
    /// Claims of the file that go with it, and why.
    pub gone: Vec<(String, String)>,
    pub(super) edits: Vec<Edit>,
    /// Signed, of each wanted quantity at each time, in parts of ranges.
    pub(super) differences: Vec<Vec<f64>>,
}

/// What stays this near to zero, in parts of its range, is not left to chance.
const NEAR: f64 = 0.05;
/// Changes that differ by less are the same.
const ALIKE: f64 = 1.01;
/// What moves a guard by this part of how far it is from zero is told of.
const MOVED: f64 = 0.1;
/// A guard may move by this part of how far it is from zero.
const MOVES: f64 = 0.5;
/// An edited file and its answer.
pub(super) struct Answer {
    pub text: String,
    pub gone: Vec<(String, String)>,
    pub system: Box<dyn System>,
    pub settings: crate::simulate::Settings,
}

/// The file with edits, less what it claims in vain.
///
/// # Errors
/// Why there is none.
pub(super) fn answer(full: &Full, edits: &[Edit]) -> Result<Answer, String> {
    let text =
        edited(&full.source, edits).ok_or_else(|| "it is written in a way that cannot be taken out".to_owned())?;
    let is_wanted = |output: &str| {
        let of = |name: &String| name == output || name.strip_prefix(output).is_some_and(|rest| rest.starts_with('.'));
        full.need.outputs.iter().any(of)
    };
    let compile = |text: &str| full.compiled(text);
    let (text, program, mut gone) = without_vain_claims((text, full.scene.as_deref()), is_wanted, compile)?;
    let linear = edits.iter().any(|edit| matches!(edit, Edit::Linear(_)));
    if linear && source(&full.source, &[Step::Key("balances".to_owned())]).is_some() {
        gone.push(("balances".to_owned(), "no forces and masses are left for them, only energies".to_owned()));
    }
    let (system, settings) =
        set(program, &text, full.scene.as_deref(), &full.settings.interruption).map_err(|e| said(&e))?;
    Ok(Answer { text, gone, system, settings })
}

fn said(error: &NeedsError) -> String {
    error.to_string()
}

impl ModelReduction {
    /// A looser tolerance, instead of the scene's own, and what it saves.
    pub(super) fn of_tolerance((tolerance, own): (f64, f64), deviation: Deviation, saving: f64) -> ModelReduction {
        ModelReduction {
            ingredient: "tolerance".to_owned(),
            proposal: Proposal::Looser { tolerance, own },
            deviation: Some(deviation),
            predicted: None,
            saving,
            verdict: Verdict::Serves,
            not_depended_on: false,
            margin: None,
            gone: Vec::new(),
            edits: Vec::new(),
            differences: Vec::new(),
        }
    }

    /// Whether the file can have only one of two: what stands in a part of the other, and proposals for the same.
    pub(super) fn excludes(&self, other: &ModelReduction) -> bool {
        let stands_in = |one: &str, other: &str| one.strip_prefix(other).is_some_and(|rest| rest.starts_with('.'));
        let (one, other) = (&self.ingredient, &other.ingredient);
        let everything = [one, other].into_iter().any(|ingredient| ingredient == EQUATIONS);
        everything || one == other || stands_in(one, other) || stands_in(other, one)
    }
}

/// Runs a candidate.
pub(super) fn tried(full: &Full, candidate: Candidate) -> ModelReduction {
    let Candidate { ingredient, proposal, edits } = candidate;
    let mut reduction = ModelReduction {
        not_depended_on: full.is_unfelt(&ingredient),
        ingredient,
        proposal,
        deviation: None,
        predicted: None,
        saving: 0.0,
        verdict: Verdict::Acts,
        margin: None,
        gone: Vec::new(),
        edits,
        differences: Vec::new(),
    };
    if let Err(verdict) = measure(full, &mut reduction) {
        reduction.verdict = verdict;
    }
    reduction
}

/// Which of two proposals for one ingredient changes less; of those that change as much the later, which is a formula.
pub(super) fn better(one: ModelReduction, other: ModelReduction) -> ModelReduction {
    let change =
        |reduction: &ModelReduction| reduction.deviation.as_ref().map_or(f64::INFINITY, |deviation| deviation.largest);
    if change(&other) <= ALIKE * change(&one) { other } else { one }
}

/// Predicts what a few modes change by the next steps of their ladders.
pub(super) fn predict_by_ladders(reductions: &mut [ModelReduction]) {
    let of = |reduction: &ModelReduction| match reduction.proposal {
        Proposal::Modes { kept, .. } if !reduction.differences.is_empty() => Some(kept),
        _ => None,
    };
    for place in 0..reductions.len() {
        let Some(own) = of(&reductions[place]) else { continue };
        let richer = reductions.iter().filter(|reduction| reduction.ingredient == reductions[place].ingredient);
        let richer = richer.filter_map(|reduction| Some((of(reduction)?, reduction))).filter(|(kept, _)| *kept > own);
        let Some((kept, next)) = richer.min_by_key(|(kept, _)| *kept) else { continue };
        let columns = reductions[place].differences.iter().zip(&next.differences);
        let change = columns
            .map(|(own, next)| largest(&own.iter().zip(next).map(|(own, next)| own - next).collect::<Vec<f64>>()));
        let change = change.fold(0.0, f64::max);
        reductions[place].predicted = Some(Prediction { change, law: Law::Richer { kept } });
    }
}

/// Whether a ladder of modes is climbed high enough before this candidate: one step above the first that serves, by which that is predicted.
pub(super) fn is_climbed(reductions: &[ModelReduction], candidate: &Candidate) -> bool {
    let by_modes = |proposal: &Proposal| matches!(proposal, Proposal::Modes { .. });
    let serves = |reduction: &ModelReduction| {
        reduction.ingredient == candidate.ingredient
            && by_modes(&reduction.proposal)
            && reduction.verdict == Verdict::Serves
    };
    by_modes(&candidate.proposal) && reductions.iter().filter(|reduction| serves(reduction)).count() > 1
}

/// Whether two reductions are the same coordinate or input held, each elsewhere.
pub(super) fn are_alternatives(one: &ModelReduction, other: &ModelReduction) -> bool {
    let is_held = |reduction: &ModelReduction| matches!(reduction.proposal, Proposal::Held { .. });
    one.ingredient == other.ingredient && is_held(one) && is_held(other)
}

/// The coordinate that is held, and where, if that is a number; that follows the others, `None`.
fn held(reduction: &ModelReduction) -> Option<(&str, Option<f64>)> {
    let coordinate = reduction.ingredient.strip_prefix("coordinates.")?;
    match &reduction.proposal {
        Proposal::Held { at } => Some((coordinate, at.split(' ').next()?.parse().ok())),
        Proposal::Slaved { .. } => Some((coordinate, None)),
        Proposal::LeftOut | Proposal::Modes { .. } | Proposal::Rigid { .. } => None,
        Proposal::Linear | Proposal::Looser { .. } => None,
    }
}

fn measure(full: &Full, reduction: &mut ModelReduction) -> Result<(), Verdict> {
    let refused = |why: String| Verdict::Refused { why };
    let answer = answer(full, &reduction.edits).map_err(refused)?;
    reduction.gone.clone_from(&answer.gone);
    let motion = full.motion_of(&*answer.system, &answer.settings, full.tolerance).map_err(refused)?;
    reduction.saving = full.motion.operations / motion.operations;
    reduction.predicted = match (held(reduction), reduction.edits.as_slice()) {
        (_, [Edit::Rigid(rigid)]) => rigid::predicted(full, rigid, &answer),
        (Some(held), _) => {
            below::predicted(full, (&*answer.system, &answer.settings, &motion.coarse(full.times)), held)
        }
        (None, _) => {
            let about = full.rest.as_deref().filter(|_| reduction.proposal == Proposal::Linear);
            prediction::predicted(full, (&*answer.system, &answer.settings, &motion), about)
        }
    };
    let compared = between(&full.motion, &motion, full.measure());
    let (deviation, differences) = compared.map_err(|what| Verdict::HappensOtherwise { what })?;
    let serves = deviation.largest <= full.need.within;
    reduction.margin = margin(&full.motion, &motion);
    (reduction.deviation, reduction.differences) = (Some(deviation), differences);
    if !serves {
        return Ok(());
    }
    if let Some((guard, margin)) = near(&full.motion, &motion) {
        return Err(Verdict::Near { guard, margin });
    }
    reduction.verdict = Verdict::Serves;
    Ok(())
}

/// The first event or discontinuity that never happens and that a change decides: gone, and too near for that; or moved by
/// more than half of how far it stays away.
pub(super) fn near(full: &Motion, other: &Motion) -> Option<(String, f64)> {
    let decided = missed(full, other).find(|guard| match guard.moves {
        None => guard.parts < NEAR,
        Some(part) => part > MOVES,
    });
    decided.map(|guard| (guard.name.clone(), guard.parts))
}

/// The event or discontinuity nearest to happening of those that go with what is left out, or are moved by it.
fn margin(full: &Motion, other: &Motion) -> Option<(String, f64)> {
    let concerned = missed(full, other).filter(|guard| guard.moves.is_none_or(|part| part > MOVED));
    let nearest = concerned.min_by(|one, another| one.parts.total_cmp(&another.parts));
    nearest.map(|guard| (guard.name.clone(), guard.parts))
}

/// An event or discontinuity that does not happen.
struct Missed<'a> {
    name: &'a String,
    /// How far it stays from zero, in parts of its range.
    parts: f64,
    /// By which part of that a change moves it; `None` where it goes.
    moves: Option<f64>,
}

fn missed<'a>(full: &'a Motion, other: &'a Motion) -> impl Iterator<Item = Missed<'a>> {
    full.guards.iter().filter_map(|(name, values)| {
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        // One that happens, or crosses zero, is compared by its events or by what it does.
        let happens = full.events.iter().any(|(event, _)| event == name);
        if happens || low <= 0.0 && high >= 0.0 || !low.is_finite() || !high.is_finite() {
            return None;
        }
        let margin = low.abs().min(high.abs());
        let parts = margin / (high - low).max(f64::MIN_POSITIVE);
        let moves = other.guards.iter().find(|(known, _)| known == name).map(|(_, others)| {
            let least = others.iter().fold(f64::INFINITY, |least, v| least.min(v.abs()));
            (least - margin).abs() / margin
        });
        Some(Missed { name, parts, moves })
    })
}
