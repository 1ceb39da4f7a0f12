//! Where stability changes along a branch.

use std::cell::Cell;
use std::ops::Range;

use super::dependence::{Dependence, dependences};
use super::spectrum::Spectrum;
use super::walk::Walker;
use super::{Branch, State, Threshold, ThresholdKind, Turn};
use crate::linear::LinearError;

/// Halvings of the distance of two states of the walk.
const DEEPEST: u32 = 40;
/// Beyond so many halvings a single change of stability is bisected.
const SHALLOW: u32 = 10;

/// A state and what moves there.
#[derive(Clone)]
struct Sample {
    state: State,
    spectrum: Spectrum,
    folded: bool,
}

/// Samples a path until nothing can hide between two samples; adds its states and thresholds to the branch.
pub(super) fn thresholds(walker: &Walker, points: &[State], turns: &[Turn], branch: &mut Branch) {
    let mut fault: Option<(f64, LinearError)> = None;
    let mut samples: Vec<Option<Sample>> = Vec::new();
    for (index, state) in points.iter().enumerate() {
        let folded = turns.first().is_some_and(|turn| index >= turn.index);
        match sample(walker, state.clone(), folded) {
            Ok(found) => samples.push(Some(found)),
            Err(error) => {
                fault = fault.or(Some((state.value, error)));
                samples.push(None);
            }
        }
    }
    let grows =
        |sample: Option<&Option<Sample>>| sample.and_then(Option::as_ref).map_or(0, |sample| sample.spectrum.growing());
    let dependences = dependences(walker, points);
    let folds = |found: &Dependence, turn: &Turn| found.between.start < turn.index && turn.index <= found.between.end;
    for turn in turns {
        let dependence = dependences.iter().find(|found| folds(found, turn));
        branch.thresholds.push(Threshold {
            value: turn.at.value,
            kind: if turn.mirrored { ThresholdKind::Bifurcation } else { ThresholdKind::Fold },
            growing: [grows(samples.get(turn.index - 1)), grows(samples.get(turn.index))],
            omega: 0.0,
            folded: false,
            constraint: dependence.and_then(|found| walker.row(found.row)),
        });
    }
    for found in dependences.iter().filter(|found| !turns.iter().any(|turn| folds(found, turn))) {
        let Range { start, end } = found.between;
        let [low, high] = if points[start].value <= points[end].value { [start, end] } else { [end, start] };
        branch.thresholds.push(Threshold {
            value: found.at.value,
            kind: ThresholdKind::Dependence,
            growing: [grows(samples.get(low)), grows(samples.get(high))],
            omega: 0.0,
            folded: turns.first().is_some_and(|turn| start >= turn.index),
            constraint: walker.row(found.row),
        });
    }
    let size = walker.size();
    let search = Search { walker, left: Cell::new(40_000 / (1 + size * size / 20)) };
    let mut found: Vec<Sample> = Vec::new();
    for (index, pair) in samples.windows(2).enumerate() {
        let [Some(a), Some(b)] = pair else { continue };
        if turns.iter().any(|turn| turn.index == index + 1) {
            // The fold itself has been named: up to it, and on from it.
            for turn in turns.iter().filter(|turn| turn.index == index + 1) {
                for (end, first) in [(a, true), (b, false)] {
                    let near = walker.between(&end.state, &turn.at, 0.98);
                    let Some(Ok(near)) = near.map(|state| sample(walker, state, end.folded)) else { continue };
                    let (low, high) = if first { (end, &near) } else { (&near, end) };
                    search.between(low, high, 0, &mut found, &mut branch.thresholds);
                }
            }
            continue;
        }
        search.between(a, b, 0, &mut found, &mut branch.thresholds);
    }
    let all = samples.into_iter().flatten().chain(found);
    branch.points.extend(all.map(|sample| sample.spectrum.point(sample.state, sample.folded)));
    if let Some((value, error)) = fault {
        branch.missing = branch.missing.take().or(Some(((value, value), error)));
    }
}

fn sample(walker: &Walker, state: State, folded: bool) -> Result<Sample, LinearError> {
    let spectrum = walker.spectrum(&state)?;
    Ok(Sample { state, spectrum, folded })
}

struct Search<'a> {
    walker: &'a Walker,
    /// Evaluations that are left.
    left: Cell<usize>,
}

impl Search<'_> {
    fn middle(&self, a: &Sample, b: &Sample) -> Option<Sample> {
        self.left.set(self.left.get().checked_sub(1)?);
        let state = self.walker.between(&a.state, &b.state, 0.5)?;
        sample(self.walker, state, a.folded).ok()
    }

    fn between(&self, a: &Sample, b: &Sample, depth: u32, kept: &mut Vec<Sample>, found: &mut Vec<Threshold>) {
        let differ = a.spectrum.growing() != b.spectrum.growing();
        if !differ && (depth >= DEEPEST || a.spectrum.is_near(&b.spectrum)) {
            return;
        }
        if differ && depth >= SHALLOW {
            return self.bisect(a, b, kept, found);
        }
        let Some(middle) = self.middle(a, b) else {
            if differ {
                found.push(threshold(a, b, [a.spectrum.growing(), b.spectrum.growing()]));
            }
            return;
        };
        self.between(a, &middle, depth + 1, kept, found);
        self.between(&middle, b, depth + 1, kept, found);
        if depth < SHALLOW {
            kept.push(middle);
        }
    }

    /// One change of stability; what else happens between shows in what is left on both sides.
    fn bisect(&self, a: &Sample, b: &Sample, kept: &mut Vec<Sample>, found: &mut Vec<Threshold>) {
        let (mut low, mut high) = (a.clone(), b.clone());
        // Double eigenvalues with one shape are split by rounding all the way: then only the coarse measure will do.
        let fine = [a, b].iter().all(|end| end.spectrum.finely_growing() == end.spectrum.growing());
        let growing = |sample: &Sample| if fine { sample.spectrum.finely_growing() } else { sample.spectrum.growing() };
        let grew = growing(a);
        for _ in 0..60 {
            let Some(middle) = self.middle(&low, &high) else { break };
            let narrow = middle.state.value == low.state.value || middle.state.value == high.state.value;
            if growing(&middle) == grew {
                low = middle
            } else {
                high = middle
            }
            if narrow {
                break;
            }
        }
        found.push(threshold(&low, &high, [grew, growing(&high)]));
        if growing(&high) != growing(b) {
            self.between(&high, b, SHALLOW, kept, found);
        }
    }
}

/// Between two states in which so many modes grow.
fn threshold(a: &Sample, b: &Sample, growing: [usize; 2]) -> Threshold {
    let more = if growing[0] > growing[1] { a } else { b };
    let omega = more.spectrum.border().unwrap_or(0.0);
    Threshold {
        value: 0.5 * (a.state.value + b.state.value),
        kind: if omega > 0.0 { ThresholdKind::Flutter } else { ThresholdKind::Divergence },
        growing: if a.state.value <= b.state.value { growing } else { [growing[1], growing[0]] },
        omega,
        folded: a.folded,
        constraint: None,
    }
}
