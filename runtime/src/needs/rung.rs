//! Every ingredient of the file, and the file without it.

use dalembert_symbolic::diagnose::Step;
use dalembert_symbolic::file::edit::keys;
use dalembert_symbolic::lower::compile_in;

use super::Unanswered;
use super::deviation::{Deviation, Motion, between};
use super::edit::{Edit, edited, entry, shown, unit_of, without_vain_claims, word};
use super::full::{Full, MOST_COORDINATES, set};
use super::modal::ladders;
use super::prediction::{Prediction, predicted};
use crate::mechanism::{At, System};
use crate::run::plain;

/// What becomes of an ingredient.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Proposal {
    /// It is not there.
    LeftOut,
    /// The coordinate keeps the place at which the forces on it vanish where the scene starts, or where it is on the average,
    /// whichever changes less.
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
}

/// What is found of a proposal.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// The scene does not need it.
    Serves,
    /// What is wanted feels it.
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
pub struct Rung {
    /// `springs.tyre`, `coordinates.rope`.
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
    /// Whether this is a coordinate in a part of the mechanism that nothing wanted feels, by the equations themselves.
    pub unfelt: bool,
    /// Claims of the file that go with it, and why.
    pub gone: Vec<(String, String)>,
    pub(super) edits: Vec<Edit>,
    /// Signed, of each wanted quantity at each time, in parts of ranges.
    pub(super) differences: Vec<Vec<f64>>,
}

/// Sections whose entries may go one by one, and those that may as a whole.
const ENTRIES: [&str; 6] = ["springs", "dampers", "forces", "torques", "generalized_forces", "bodies"];
const WHOLE: [&str; 2] = ["gravity", "dissipation"];
/// What stays this near to zero, in parts of its range, is not left to chance.
const NEAR: f64 = 0.05;
/// Changes that differ by less are the same.
const ALIKE: f64 = 1.01;
/// A guard may move by this part of how far it is from zero.
const MOVES: f64 = 0.5;
/// A place this small beside the range of its coordinate is 0.
const ROUNDING: f64 = 1e-9;

pub(super) struct Candidate {
    pub ingredient: String,
    proposal: Proposal,
    edits: Vec<Edit>,
}

/// All that is tried, in the file's order.
pub(super) fn proposals(full: &Full) -> Vec<Candidate> {
    let text = &full.source;
    let mut found = Vec::new();
    let mut leave = |path: Vec<Step>| {
        let edits = vec![Edit::Remove(path.clone())];
        found.push(Candidate { ingredient: shown(&path), proposal: Proposal::LeftOut, edits });
    };
    for section in ENTRIES {
        for name in keys(text, &[Step::Key(section.to_owned())]) {
            leave(entry(section, &name));
        }
    }
    for section in WHOLE.iter().filter(|section| keys(text, &[]).iter().any(|key| key == *section)) {
        leave(vec![Step::Key((*section).to_owned())]);
    }
    let coordinates = &full.system.description().coordinates;
    if coordinates.len() > 1 && coordinates.len() <= MOST_COORDINATES {
        let own = keys(text, &[Step::Key("coordinates".to_owned())]);
        for (index, coordinate) in
            coordinates.iter().enumerate().filter(|(_, c)| own.iter().any(|name| c.name == *name))
        {
            let name = coordinate.name.to_string();
            let ingredient = format!("coordinates.{name}");
            let slaved = full.places[index].as_ref().filter(|place| is_plain(place)).map(|place| {
                let moves = coordinates.iter().any(|other| word(place, &other.name).is_some()) || timed(full, place);
                let proposal = match moves {
                    true => Proposal::Slaved { to: place.clone() },
                    false => Proposal::Held { at: place.clone() },
                };
                let edits = vec![Edit::Slave { coordinate: name.clone(), place: place.clone(), moves }];
                Candidate { ingredient: ingredient.clone(), proposal, edits }
            });
            let places = [resting(full, index).unwrap_or(full.settings.q[index]), full.motion.means[index]];
            for value in places.map(|value| rounded(value, full.motion.ranges[index])) {
                // All units of coordinates are those of SI.
                let at = format!("{} {}", plain(value), unit_of(text, &name)).trim_end().to_owned();
                let edits = vec![Edit::Hold { coordinate: name.clone(), value: at.clone() }];
                found.push(Candidate { ingredient: ingredient.clone(), proposal: Proposal::Held { at }, edits });
            }
            found.extend(slaved);
        }
    }
    found.extend(ladders(full).into_iter().map(|modes| {
        let (kept, of) = modes.count();
        let ingredient = format!("coordinates.{}", modes.key);
        Candidate { ingredient, proposal: Proposal::Modes { kept, of }, edits: vec![Edit::ByModes(modes)] }
    }));
    found
}

/// Whether a formula has no number in it that only a machine writes.
fn is_plain(formula: &str) -> bool {
    const DIGITS: usize = 5;
    formula.split(|c: char| !c.is_ascii_digit()).all(|digits| digits.len() <= DIGITS)
}

/// Whether a place moves with time or an input.
fn timed(full: &Full, place: &str) -> bool {
    let mut inputs = full.system.description().inputs.iter();
    word(place, "t").is_some() || inputs.any(|input| word(place, input).is_some())
}

/// A place to nine digits; 0 where it is that beside the range of its coordinate.
fn rounded(value: f64, range: f64) -> f64 {
    if value.abs() <= ROUNDING * range { 0.0 } else { format!("{value:.8e}").parse().unwrap_or(value) }
}

/// Where the force on a coordinate vanishes, the others standing where the scene starts, by secants.
fn resting(full: &Full, index: usize) -> Option<f64> {
    const ROUNDS: u32 = 60;
    const SMALL: f64 = 1e-9;
    let (system, n) = (&*full.system, full.system.len());
    let (start, zero) = (full.settings.q[index], vec![0.0; n]);
    let force = |z: f64| {
        let (mut q, mut f) = (full.settings.q.clone(), vec![0.0; n]);
        q[index] = z;
        system.residual(At::new(full.settings.from, &q, &zero).accelerated(&zero), &mut f);
        f[index]
    };
    let reach = full.motion.ranges[index].max(1e-6 * start.abs()).max(1e-9);
    let (mut a, mut b) = (start, start + 0.1 * reach);
    let (mut low, mut high) = (force(a), force(b));
    let size = low.abs().max(high.abs());
    for _ in 0..ROUNDS {
        let next = b - high * (b - a) / (high - low);
        if high.abs() <= SMALL * size || !next.is_finite() {
            break;
        }
        (a, low) = (b, high);
        (b, high) = (next, force(next));
    }
    // A place far from where it goes is none of this motion.
    let found = high.abs() <= 1e-3 * SMALL.sqrt() * size && (b - start).abs() <= 10.0 * reach;
    found.then_some(b)
}

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
    let compile = |text: &str| compile_in(full.folder.as_deref(), text, &full.sizes);
    let (text, program, gone) = without_vain_claims(text, is_wanted, compile)?;
    let (system, settings) = set(program, &text, full.scene.as_deref()).map_err(|e| said(&e))?;
    Ok(Answer { text, gone, system, settings })
}

fn said(unanswered: &Unanswered) -> String {
    unanswered.to_string()
}

/// Runs a candidate.
pub(super) fn tried(full: &Full, candidate: Candidate) -> Rung {
    let Candidate { ingredient, proposal, edits } = candidate;
    let mut rung = Rung {
        unfelt: full.is_unfelt(&ingredient),
        ingredient,
        proposal,
        deviation: None,
        predicted: None,
        saving: 0.0,
        verdict: Verdict::Acts,
        gone: Vec::new(),
        edits,
        differences: Vec::new(),
    };
    if let Err(verdict) = measure(full, &mut rung) {
        rung.verdict = verdict;
    }
    rung
}

/// Which of two proposals for one ingredient changes less; of those that change as much the later, which is a formula.
pub(super) fn better(one: Rung, other: Rung) -> Rung {
    let change = |rung: &Rung| rung.deviation.as_ref().map_or(f64::INFINITY, |deviation| deviation.largest);
    if change(&other) <= ALIKE * change(&one) { other } else { one }
}

/// Whether a ladder of modes is climbed high enough before this candidate.
pub(super) fn is_climbed(rungs: &[Rung], candidate: &Candidate) -> bool {
    let by_modes = |proposal: &Proposal| matches!(proposal, Proposal::Modes { .. });
    let serves = |rung: &Rung| {
        rung.ingredient == candidate.ingredient && by_modes(&rung.proposal) && rung.verdict == Verdict::Serves
    };
    by_modes(&candidate.proposal) && rungs.iter().any(serves)
}

/// Whether two rungs are the same coordinate held, each elsewhere.
pub(super) fn are_alternatives(one: &Rung, other: &Rung) -> bool {
    let is_held = |rung: &Rung| matches!(rung.proposal, Proposal::Held { .. });
    one.ingredient == other.ingredient && is_held(one) && is_held(other)
}

fn measure(full: &Full, rung: &mut Rung) -> Result<(), Verdict> {
    let refused = |why: String| Verdict::Refused { why };
    let answer = answer(full, &rung.edits).map_err(refused)?;
    rung.gone.clone_from(&answer.gone);
    let motion = Motion::of(&*answer.system, &answer.settings, full.tolerance, &full.need.outputs).map_err(refused)?;
    rung.saving = full.motion.operations / motion.operations;
    if rung.proposal == Proposal::LeftOut {
        rung.predicted = predicted(full, &*answer.system, &answer.settings);
    }
    let compared = between(&full.motion, &motion, full.measure());
    let (deviation, differences) = compared.map_err(|what| Verdict::HappensOtherwise { what })?;
    let serves = deviation.largest <= full.need.within;
    (rung.deviation, rung.differences) = (Some(deviation), differences);
    if !serves {
        return Ok(());
    }
    if let Some((guard, margin)) = near(&full.motion, &motion) {
        return Err(Verdict::Near { guard, margin });
    }
    rung.verdict = Verdict::Serves;
    Ok(())
}

/// The first event or discontinuity that never happens and that a change decides: gone, and too near for that; or moved by
/// more than half of how far it stays away.
pub(super) fn near(full: &Motion, other: &Motion) -> Option<(String, f64)> {
    full.guards.iter().find_map(|(name, values)| {
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        // One that crosses zero is compared by its events or by what it does.
        if low <= 0.0 && high >= 0.0 || !low.is_finite() || !high.is_finite() {
            return None;
        }
        let margin = low.abs().min(high.abs());
        let parts = margin / (high - low).max(f64::MIN_POSITIVE);
        let too_near = match other.guards.iter().find(|(known, _)| known == name) {
            None => parts < NEAR,
            Some((_, others)) => {
                let least = others.iter().fold(f64::INFINITY, |least, v| least.min(v.abs()));
                (least - margin).abs() > MOVES * margin
            }
        };
        too_near.then(|| (name.clone(), parts))
    })
}
