//! Where stability changes along a branch.

use std::cell::Cell;
use std::ops::Range;

use super::continuation::{Continuation, End, Path};
use super::dependence::{Dependence, dependences};
use super::spectrum::{Measure, Spectrum};
use super::{Branch, State, Threshold, ThresholdKind, TurningPoint};
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
    /// How many folds lie before it.
    sheet: usize,
}

/// Samples a path until nothing can hide between two samples; adds its states and thresholds to the branch.
pub(super) fn thresholds(continuation: &Continuation, path: &Path, branch: &mut Branch) {
    let samples = sampled(continuation, path, branch);
    let grows =
        |index: usize| samples.get(index).and_then(Option::as_ref).map_or(0, |s| s.spectrum.growing(Measure::Coarse));
    ends(continuation, path, &grows, branch);
    let size = continuation.size();
    let softest = samples.iter().flatten().fold(0.0_f64, |most, sample| most.max(sample.spectrum.softness()));
    let search = Search { continuation, path, softest, left: Cell::new(40_000 / (1 + size * size / 20)) };
    let mut found: Vec<Sample> = Vec::new();
    for (index, pair) in samples.windows(2).enumerate() {
        let [Some(a), Some(b)] = pair else { continue };
        match path.turning_points.iter().find(|turn| turn.index == index + 1) {
            Some(turn) => search.round(turn, a, b, &mut found, &mut branch.thresholds),
            None => {
                let beside = |index: Option<usize>, sheet: usize| {
                    let sample = index.and_then(|index| samples.get(index)?.as_ref());
                    sample.filter(|sample| sample.sheet == sheet)
                };
                let outside = [beside(index.checked_sub(1), a.sheet), beside(Some(index + 2), b.sheet)];
                search.between(outside, [a, b], 0, &mut found, &mut branch.thresholds);
            }
        }
    }
    branch.points.extend(samples.into_iter().flatten().chain(found).map(|sample| {
        let folded = path.folded(sample.sheet, sample.state.value);
        sample.spectrum.point(sample.state, sample.sheet, folded)
    }));
}

/// Small motions about all states of a path; where there are none, that is missing from the branch.
fn sampled(continuation: &Continuation, path: &Path, branch: &mut Branch) -> Vec<Option<Sample>> {
    let mut fault: Option<(f64, LinearError)> = None;
    let mut samples: Vec<Option<Sample>> = Vec::new();
    continuation.note_zeros(path.points.iter().map(|state| (state.value, state.q.as_slice())));
    for (index, state) in path.points.iter().enumerate() {
        match continuation.spectrum(state) {
            Ok(spectrum) => samples.push(Some(Sample { state: state.clone(), spectrum, sheet: path.sheet(index) })),
            Err(error) => {
                fault = fault.or(Some((state.value, error)));
                samples.push(None);
            }
        }
    }
    branch.missing.extend(fault.map(|(value, error)| ((value, value), error)));
    let softest = samples.iter().flatten().fold(0.0_f64, |most, sample| most.max(sample.spectrum.softness()));
    let beside = |sample: Sample| Sample { spectrum: sample.spectrum.beside(softest), ..sample };
    samples.into_iter().map(|sample| sample.map(beside)).collect()
}

/// Folds, poles and where constraints depend on each other, with how many modes grow at the state of an index.
fn ends(continuation: &Continuation, path: &Path, grows: &dyn Fn(usize) -> usize, branch: &mut Branch) {
    let Path { points, turning_points, end, .. } = path;
    let dependences = dependences(continuation, points);
    let folds =
        |found: &Dependence, turn: &TurningPoint| found.between.start < turn.index && turn.index <= found.between.end;
    for turn in turning_points {
        let dependence = dependences.iter().find(|found| folds(found, turn));
        branch.thresholds.push(Threshold {
            constraint: dependence.and_then(|found| continuation.row(found.row)),
            ..Threshold::at(
                turn.at.value,
                if turn.mirrored { ThresholdKind::Bifurcation } else { ThresholdKind::Fold },
                [grows(turn.index - 1), grows(turn.index)],
            )
        });
    }
    for found in dependences.iter().filter(|found| !turning_points.iter().any(|turn| folds(found, turn))) {
        let Range { start, end } = found.between;
        let [low, high] = if points[start].value <= points[end].value { [start, end] } else { [end, start] };
        branch.thresholds.push(Threshold {
            folded: path.folded(path.sheet(start), found.at.value),
            constraint: continuation.row(found.row),
            ..Threshold::at(found.at.value, ThresholdKind::Dependence, [grows(low), grows(high)])
        });
    }
    if let End::Pole { value, coordinate } = *end {
        branch.thresholds.push(Threshold {
            folded: path.folded(turning_points.len(), value),
            coordinate: Some(coordinate),
            ..Threshold::at(value, ThresholdKind::Pole, [grows(points.len() - 1); 2])
        });
    }
}

impl Threshold {
    fn at(value: f64, kind: ThresholdKind, growing: [usize; 2]) -> Threshold {
        Threshold {
            value,
            kind,
            growing,
            omega: 0.0,
            crosses: false,
            folded: false,
            constraint: None,
            coordinate: None,
        }
    }
}

struct Search<'a> {
    continuation: &'a Continuation,
    path: &'a Path,
    /// What the κ nearest to 0 is where it is farthest.
    softest: f64,
    /// Evaluations that are left.
    left: Cell<usize>,
}

impl Search<'_> {
    fn sample(&self, state: State, sheet: usize) -> Option<Sample> {
        let spectrum = self.continuation.spectrum(&state).ok()?.beside(self.softest);
        Some(Sample { state, spectrum, sheet })
    }

    fn middle(&self, a: &Sample, b: &Sample) -> Option<Sample> {
        self.left.set(self.left.get().checked_sub(1)?);
        self.sample(self.continuation.between(&a.state, &b.state, 0.5)?, a.sheet)
    }

    /// Up to a fold, which has been named itself, and on from it.
    fn round(&self, turn: &TurningPoint, a: &Sample, b: &Sample, kept: &mut Vec<Sample>, found: &mut Vec<Threshold>) {
        for (end, first) in [(a, true), (b, false)] {
            let near = self.continuation.between(&end.state, &turn.at, 0.98);
            let Some(near) = near.and_then(|state| self.sample(state, end.sheet)) else { continue };
            let pair = if first { [end, &near] } else { [&near, end] };
            self.between([None, None], pair, 0, kept, found);
        }
    }

    /// Between two states, with one before and one behind them where they are known.
    fn between(
        &self,
        outside: [Option<&Sample>; 2],
        [a, b]: [&Sample; 2],
        depth: u32,
        kept: &mut Vec<Sample>,
        found: &mut Vec<Threshold>,
    ) {
        let differ = a.spectrum.counted(Measure::Coarse) != b.spectrum.counted(Measure::Coarse);
        if !differ && (depth >= DEEPEST || (a.spectrum.is_near(&b.spectrum) && !self.may_touch(outside, [a, b]))) {
            return;
        }
        if differ && depth >= SHALLOW {
            return self.bisect(a, b, kept, found);
        }
        let Some(middle) = self.middle(a, b) else {
            if differ {
                found.push(self.threshold(a, b, Measure::Coarse));
            }
            return;
        };
        self.between([outside[0], Some(b)], [a, &middle], depth + 1, kept, found);
        self.between([Some(a), outside[1]], [&middle, b], depth + 1, kept, found);
        if depth < SHALLOW {
            kept.push(middle);
        }
    }

    /// Whether stability may change and change back between two states, by those beside them.
    fn may_touch(&self, [before, behind]: [Option<&Sample>; 2], [a, b]: [&Sample; 2]) -> bool {
        let three = |[a, m, b]: [&Sample; 3], piece: fn(f64) -> (f64, f64)| {
            let [there, on] =
                [self.continuation.distance(&a.state, &m.state), self.continuation.distance(&m.state, &b.state)];
            let part = there / (there + on);
            part > 0.0 && part < 1.0 && Spectrum::may_touch([a, m, b].map(|s| &s.spectrum), part, piece(part))
        };
        before.is_some_and(|before| three([before, a, b], |part| (part, 1.0)))
            || behind.is_some_and(|behind| three([a, b, behind], |part| (0.0, part)))
    }

    /// One change of stability; what else happens between shows in what is left on both sides.
    fn bisect(&self, a: &Sample, b: &Sample, kept: &mut Vec<Sample>, found: &mut Vec<Threshold>) {
        let (mut low, mut high) = (a.clone(), b.clone());
        // Double eigenvalues with one shape are split by rounding all the way: then only the coarse measure will do.
        let measure = if a.spectrum.locates() && b.spectrum.locates() { Measure::Fine } else { Measure::Coarse };
        let counted = |sample: &Sample| sample.spectrum.counted(measure);
        let before = counted(a);
        for _ in 0..60 {
            let Some(middle) = self.middle(&low, &high) else { break };
            let narrow = middle.state.value == low.state.value || middle.state.value == high.state.value;
            if counted(&middle) == before {
                low = middle
            } else {
                high = middle
            }
            if narrow {
                break;
            }
        }
        found.push(self.threshold(&low, &high, measure));
        if counted(&high) != counted(b) {
            self.between([None, None], [&high, b], SHALLOW, kept, found);
        }
    }

    /// Between two states of which stability differs, by this measure.
    fn threshold(&self, a: &Sample, b: &Sample, measure: Measure) -> Threshold {
        let more = if a.spectrum.counted(measure) > b.spectrum.counted(measure) { a } else { b };
        let omega = more.spectrum.border(measure).unwrap_or(0.0);
        let kind = if omega > 0.0 { ThresholdKind::Flutter } else { ThresholdKind::Divergence };
        let value = 0.5 * (a.state.value + b.state.value);
        let [low, high] = if a.state.value <= b.state.value { [a, b] } else { [b, a] };
        let growing = [low, high].map(|end| end.spectrum.growing(measure));
        let crosses = low.spectrum.unstable(measure) != high.spectrum.unstable(measure);
        Threshold { omega, crosses, folded: self.path.folded(a.sheet, value), ..Threshold::at(value, kind, growing) }
    }
}
