//! What may go together.

use std::ops::ControlFlow;

use dalembert_symbolic::diagnose::Step;
use dalembert_symbolic::file::edit::{keys, source};

use super::NeedsError;
use super::deviation::{Motion, between, largest};
use super::edit::{Edit, entry, shown, without_idle_parameters, word};
use super::full::{Full, columns, on_constraints, started};
use super::reduction::{Answer, ModelReduction, Proposal, Verdict, answer, near};
use crate::mechanism::System;
use crate::simulate::Settings;

/// What a scene does without, tried as a whole.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Choice {
    /// Which ingredients go; none where only the tolerance is looser.
    pub members: Vec<String>,
    /// What goes with what was held, since it does nothing any more.
    pub idle: Vec<String>,
    /// The tolerance at which the smaller model is run.
    pub tolerance: f64,
    /// The largest of the sum of the members' own changes; `None` without members.
    pub predicted: Option<f64>,
    /// The largest change that leaving them out makes by itself.
    pub change: f64,
    /// The largest deviation of the smaller model at that tolerance from the full one, integration included.
    pub verified: f64,
    /// Of what.
    pub of: String,
    /// What of it is phase error and what is waveform error, as in [`Deviation`](super::Deviation); `None` where it is too large to say.
    pub parts: Option<(f64, f64)>,
    /// The same from starts moved by a hundredth of the way to where the motion goes, and away from it; `None` where they could not be compared.
    pub moved: Option<f64>,
    /// What the scene takes now, as [`Needs::operations`](super::Needs::operations).
    pub operations: f64,
    /// By how many times less work the scene takes.
    pub saving: f64,
    /// Claims of the file that went, and why.
    pub gone: Vec<(String, String)>,
    /// Coordinates and outputs that are not wanted, and by how much more than the need they are off; infinite for what happens
    /// otherwise.
    pub not_promised: Vec<(String, f64)>,
    /// What becomes of each of `members`.
    pub proposals: Vec<Proposal>,
    pub(super) text: String,
}

impl Choice {
    /// Whether a reduction is one of its members.
    pub(super) fn includes(&self, reduction: &ModelReduction) -> bool {
        let mut members = self.members.iter().zip(&self.proposals);
        members.any(|(ingredient, proposal)| *ingredient == reduction.ingredient && *proposal == reduction.proposal)
    }
}

/// The looser tolerance that serves, as an ingredient that saves work of the full model by itself.
pub(super) fn looser(full: &Full) -> Option<ModelReduction> {
    let own = full.settings.tolerance;
    full.tolerances().find_map(|tolerance| {
        let run = full.motion_of(&*full.system, &full.settings, tolerance).ok()?;
        let deviation = full.deviation(&run).ok().filter(|deviation| deviation.largest <= full.need.within)?;
        Some(ModelReduction::of_tolerance((tolerance, own), deviation, full.operations / run.operations))
    })
}

/// What saves less stays: a file without it is less general for no gain.
const WORTH: f64 = 1.05;
/// Sums of changes may take this part of the need, and their sizes twice the need: none fits only by cancelling another.
const FILLED: f64 = 0.95;
const CANCELLED: f64 = 2.0;
/// A set that fails as a whole is tried again with one member less, so often.
const RETRIES: usize = 3;
/// Starts are moved by this part of the way to states that the motion goes through.
const MOVED: f64 = 0.01;
/// Sections of which every entry is asked whether it does nothing any more.
const TRIED: [&str; 2] = ["springs", "dampers"];
/// What does nothing changes no more than this.
const IDLE: f64 = 1e-11;

/// The set that saves most, verified; `None` where nothing does.
pub(super) fn choose(
    full: &Full,
    reductions: &[ModelReduction],
    all: bool,
    progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
) -> Result<Option<Choice>, NeedsError> {
    let mut members = greedy(full, reductions, all);
    for _ in 0..=RETRIES {
        if progress("what goes together").is_break() {
            return Err(NeedsError::Interrupted { so_far: None });
        }
        if members.is_empty() {
            break;
        }
        if let Some(choice) = verified(full, &members) {
            return Ok(Some(choice).filter(|choice| choice.saving > WORTH));
        }
        // Without the one whose own change is the largest.
        let worst = (0..members.len()).max_by(|a, b| change(members[*a]).total_cmp(&change(members[*b])));
        worst.map(|worst| members.remove(worst));
    }
    Ok(verified(full, &[]).filter(|choice| choice.saving > WORTH))
}

fn change(reduction: &ModelReduction) -> f64 {
    reduction.deviation.as_ref().map_or(0.0, |deviation| deviation.largest)
}

/// Those that serve, the ones that save most first, as long as the sum of their changes fits.
fn greedy<'a>(full: &Full, reductions: &'a [ModelReduction], all: bool) -> Vec<&'a ModelReduction> {
    let mut candidates: Vec<&ModelReduction> = reductions
        .iter()
        .filter(|reduction| reduction.verdict == Verdict::Serves && (all || reduction.saving >= WORTH))
        .collect();
    candidates.sort_by(|a, b| b.saving.total_cmp(&a.saving).then(change(a).total_cmp(&change(b))));
    let mut chosen: Vec<&ModelReduction> = Vec::new();
    for reduction in candidates {
        // Of one ladder only one step.
        if chosen.iter().any(|other| other.excludes(reduction)) {
            continue;
        }
        // What acts on a coordinate that is held goes with it, if it is idle then.
        if held(&chosen).iter().any(|coordinate| speaks_of(full, reduction, coordinate)) {
            continue;
        }
        let with: Vec<&ModelReduction> = chosen.iter().copied().chain([reduction]).collect();
        let sizes: f64 = with.iter().map(|reduction| change(reduction)).sum();
        if predicted(&with) <= FILLED * full.need.within && sizes <= CANCELLED * full.need.within {
            chosen = with;
        }
    }
    chosen
}

/// The largest sum of signed changes.
fn predicted(members: &[&ModelReduction]) -> f64 {
    let Some(first) = members.first() else { return 0.0 };
    let columns = first.differences.iter().enumerate().map(|(column, own)| {
        let sum = |row: usize| -> f64 {
            let at = |reduction: &&ModelReduction| {
                reduction.differences.get(column).and_then(|d| d.get(row)).copied().unwrap_or(0.0)
            };
            members.iter().map(at).sum()
        };
        largest(&(0..own.len()).map(sum).collect::<Vec<f64>>())
    });
    columns.fold(0.0, f64::max)
}

/// The file without these, at the loosest tolerance that serves; `None` where none does.
fn verified(full: &Full, members: &[&ModelReduction]) -> Option<Choice> {
    let mut edits: Vec<Edit> = members.iter().flat_map(|reduction| reduction.edits.clone()).collect();
    let mut found = answer(full, &edits).ok()?;
    let reference = motion(full, &found, full.tolerance)?;
    if near(&full.motion, &reference).is_some() {
        return None;
    }
    let (change, _) = between(&full.motion, &reference, full.measure()).ok()?;
    let idle = idle(full, members, &mut edits, (&mut found, &reference));
    let within = full.need.within;
    let own = full.settings.tolerance;
    let (tolerance, run, deviation) = full.tolerances().chain([own]).find_map(|tolerance| {
        let run = motion(full, &found, tolerance)?;
        let deviation = full.deviation(&run).ok()?;
        (deviation.largest <= within).then_some((tolerance, run, deviation))
    })?;
    Some(Choice {
        members: members.iter().map(|reduction| reduction.ingredient.clone()).collect(),
        proposals: members.iter().map(|reduction| reduction.proposal.clone()).collect(),
        idle,
        tolerance,
        predicted: (!members.is_empty()).then(|| predicted(members)),
        change: change.largest,
        verified: deviation.largest,
        parts: deviation.parts(),
        of: deviation.of,
        moved: from_moved_starts(full, &edits, (&found, tolerance, &run)),
        operations: run.operations,
        saving: full.operations / run.operations,
        not_promised: not_promised(full, &found),
        gone: found.gone,
        text: without_idle_parameters(found.text, &full.source),
    })
}

fn motion(full: &Full, answer: &Answer, tolerance: f64) -> Option<Motion> {
    full.motion_of(&*answer.system, &answer.settings, tolerance).ok()
}

/// The coordinates that are held.
fn held<'a>(members: &[&'a ModelReduction]) -> Vec<&'a str> {
    let is_held = |reduction: &&&ModelReduction| matches!(reduction.proposal, Proposal::Held { .. });
    members.iter().filter(is_held).filter_map(|reduction| reduction.ingredient.strip_prefix("coordinates.")).collect()
}

/// Whether an entry that is left out says the name of a coordinate, in the full file.
fn speaks_of(full: &Full, reduction: &ModelReduction, coordinate: &str) -> bool {
    reduction.edits.iter().any(|edit| match edit {
        Edit::Remove(path) => word(&source_of(full, path), coordinate).is_some(),
        Edit::Replace { .. } | Edit::Hold { .. } | Edit::Slave { .. } => false,
        Edit::ByModes(_) | Edit::Rigid(_) | Edit::Parameter { .. } | Edit::Linear(_) => false,
    })
}

/// Takes out springs and dampers, and forces and bodies that say the name of a coordinate that is held, if they do nothing any more.
fn idle(
    full: &Full,
    members: &[&ModelReduction],
    edits: &mut Vec<Edit>,
    (found, run): (&mut Answer, &Motion),
) -> Vec<String> {
    let held = held(members);
    let mut gone = Vec::new();
    if held.is_empty() {
        return gone;
    }
    for section in ["springs", "dampers", "forces", "torques", "generalized_forces", "bodies"] {
        for name in keys(&found.text, &[Step::Key(section.to_owned())]) {
            let path = entry(section, &name);
            let written = source(&found.text, &path).unwrap_or_default().to_owned();
            // What said its rate says 0 now.
            let speaks = |held: &&str| word(&written, held).is_some() || word(&source_of(full, &path), held).is_some();
            if !TRIED.contains(&section) && !held.iter().any(speaks) {
                continue;
            }
            let more: Vec<Edit> = edits.iter().cloned().chain([Edit::Remove(path.clone())]).collect();
            let Ok(less) = answer(full, &more) else { continue };
            let Some(without) = motion(full, &less, full.tolerance) else { continue };
            let same = between(run, &without, full.measure());
            if same.is_ok_and(|(deviation, _)| deviation.largest <= IDLE) {
                *edits = more;
                *found = less;
                gone.push(shown(&path));
            }
        }
    }
    gone
}

/// What the smaller model still gives, unasked, and does not give within the need.
fn not_promised(full: &Full, found: &Answer) -> Vec<(String, f64)> {
    let own = columns(&*found.system, &[]).unwrap_or_default();
    let others: Vec<String> = columns(&*full.system, &[]).unwrap_or_default();
    let others: Vec<String> =
        others.into_iter().filter(|name| own.contains(name) && !full.need.outputs.contains(name)).collect();
    let of = |system: &dyn System, settings: &Settings| {
        Motion::of((system, settings), (full.tolerance, full.times), (&others, &full.instants)).ok()
    };
    let (Some(whole), Some(small)) = (of(&*full.system, &full.settings), of(&*found.system, &found.settings)) else {
        return Vec::new();
    };
    let off = |(place, name): (usize, &String)| {
        let one = |motion: &Motion| Motion {
            values: vec![motion.values[place].clone()],
            looks: vec![motion.looks[place].clone()],
            ..motion.clone()
        };
        let scale = whole.scales(&whole)[place].unwrap_or(f64::MIN_POSITIVE);
        let compared = between(&one(&whole), &one(&small), (std::slice::from_ref(name), &[scale]));
        let size = compared.map_or(f64::INFINITY, |(deviation, _)| deviation.largest);
        (size > full.need.within).then(|| (name.clone(), size))
    };
    others.iter().enumerate().filter_map(off).collect()
}

/// What stood at a path of the full file.
fn source_of(full: &Full, path: &[Step]) -> String {
    source(&full.source, path).unwrap_or_default().to_owned()
}

/// A start moved by a part of the way to a state.
fn towards(settings: &Settings, state: &[f64], part: f64) -> Settings {
    let mut settings = settings.clone();
    let (places, rates) = state.split_at(settings.q.len());
    for (start, there) in [(&mut settings.q, places), (&mut settings.v, rates)] {
        start.iter_mut().zip(there).for_each(|(start, there)| *start += part * (there - *start));
    }
    settings
}

/// By how much a coordinate of the smaller model changes with those of the full one.
fn change_of(edits: &[Edit], name: &str, all: &[String], changes: &[f64]) -> Option<f64> {
    if let Some(place) = all.iter().position(|known| known == name) {
        return Some(changes[place]);
    }
    edits.iter().find_map(|edit| match edit {
        Edit::ByModes(modes) => modes.change(name, changes),
        _ => None,
    })
}

/// The largest deviation from two other starts, each moved alike for both models.
fn from_moved_starts(full: &Full, edits: &[Edit], (found, tolerance, run): (&Answer, f64, &Motion)) -> Option<f64> {
    let names = |system: &dyn System| -> Vec<String> {
        system.description().coordinates.iter().map(|c| c.name.to_string()).collect()
    };
    let (all, own) = (names(&*full.system), names(&*found.system));
    let from = started(&*full.system, &full.settings, &full.motion.first);
    let smaller = started(&*found.system, &found.settings, &run.first);
    let rigid = edits.iter().any(|edit| matches!(edit, Edit::Rigid(_)));
    let mut worst = 0.0_f64;
    for (part, visited) in [MOVED, -MOVED].into_iter().zip(&full.motion.visited) {
        let mut there = on_constraints(&*full.system, towards(&from, visited, part));
        let mut here = smaller.clone();
        for (start, there, before) in [(&mut here.q, &there.q, &from.q), (&mut here.v, &there.v, &from.v)] {
            let changes: Vec<f64> = there.iter().zip(before).map(|(there, before)| there - before).collect();
            for (name, start) in own.iter().zip(start) {
                *start += change_of(edits, name, &all, &changes)?;
            }
        }
        here = on_constraints(&*found.system, here);
        // What is stiff is not stretched by being moved.
        if rigid && own == all {
            (there.q, there.v) = (here.q.clone(), here.v.clone());
        }
        let whole = full.motion_of(&*full.system, &there, full.tolerance).ok()?;
        let small = full.motion_of(&*found.system, &here, tolerance).ok()?;
        let (deviation, _) = between(&whole, &small, full.measure()).ok()?;
        worst = worst.max(deviation.largest);
    }
    Some(worst)
}
