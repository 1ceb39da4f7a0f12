//! Where stability changes along a branch.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::ops::Range;

use super::continuation::{Continuation, End, Path};
use super::dependence::{Dependence, dependences};
use super::spectrum::{Measure, Spectrum};
use super::{Branch, State, Threshold, ThresholdKind, TurningPoint};
use crate::linear::LinearError;

/// Halvings of the distance of two states of the walk.
const DEEPEST: u32 = 40;
/// How near to a change of stability it is looked whether rounding still hides it, in parts of the interval that it was bisected in.
const CLOSEST: f64 = f64::EPSILON;
/// Beyond so many halvings a single change of stability is bisected.
const SHALLOW: u32 = 10;

/// How near states come to one without small motions, in parts of a step of the walk: as near as steps of the walk itself may.
const NEAREST: f64 = 1e-9;

/// A state and what moves there.
#[derive(Clone)]
struct Sample {
    state: State,
    spectrum: Spectrum,
    /// How many folds lie before it.
    sheet: usize,
}

/// The samples of a path: one of each state; of a state without small motions the nearest ones that have some, before and behind it.
struct Samples {
    regular: Vec<Option<Sample>>,
    beside: BTreeMap<usize, [Option<Sample>; 2]>,
}

impl Samples {
    /// That of a state, as seen from the states before it (0) or behind it (1).
    fn at(&self, index: usize, side: usize) -> Option<&Sample> {
        self.regular.get(index)?.as_ref().or_else(|| self.beside.get(&index)?[side].as_ref())
    }

    fn all(&self) -> impl Iterator<Item = &Sample> {
        self.regular.iter().flatten().chain(self.beside.values().flatten().flatten())
    }
}

/// Samples a path until nothing can hide between two samples; adds its states and thresholds to the branch.
pub(super) fn thresholds(continuation: &Continuation, path: &Path, branch: &mut Branch) {
    let samples = sampled(continuation, path, branch);
    let grows = |index: usize| {
        let sample = samples.at(index, 0).or_else(|| samples.at(index, 1));
        sample.map_or(0, |sample| sample.spectrum.growing(Measure::Coarse))
    };
    ends(continuation, path, &grows, branch);
    let size = continuation.size();
    let softest = samples.all().fold(0.0_f64, |most, sample| most.max(sample.spectrum.softness()));
    let search = Search { continuation, path, softest, left: Cell::new(40_000 / (1 + size * size / 20)) };
    let mut found: Vec<Sample> = Vec::new();
    for index in 1..path.points.len() {
        let [Some(a), Some(b)] = [samples.at(index - 1, 1), samples.at(index, 0)] else { continue };
        match path.turning_points.iter().find(|turn| turn.index == index) {
            Some(turn) => search.round(turn, a, b, &mut found, &mut branch.thresholds),
            None => {
                let outside = [
                    index
                        .checked_sub(2)
                        .and_then(|before| samples.at(before, 1))
                        .filter(|sample| sample.sheet == a.sheet),
                    samples.at(index + 1, 0).filter(|sample| sample.sheet == b.sheet),
                ];
                search.between(outside, [a, b], 0, &mut found, &mut branch.thresholds);
            }
        }
    }
    branch.points.extend(samples.all().cloned().chain(found).map(|sample| {
        let folded = path.folded(sample.sheet, sample.state.value);
        sample.spectrum.point(sample.state, sample.sheet, folded)
    }));
}

/// Small motions about all states of a path; what is between those that have none and the nearest that have some is missing from the branch.
fn sampled(continuation: &Continuation, path: &Path, branch: &mut Branch) -> Samples {
    let points = &path.points;
    continuation.note_zeros(points.iter().map(|state| (state.value, state.q.as_slice())));
    let (mut regular, mut faults) = (Vec::with_capacity(points.len()), BTreeMap::new());
    for (index, state) in points.iter().enumerate() {
        let sheet = path.sheet(index);
        match continuation.spectrum(state) {
            Ok(spectrum) => regular.push(Some(Sample { state: state.clone(), spectrum, sheet })),
            Err(error) => {
                faults.insert(index, error);
                regular.push(None);
            }
        }
    }
    let is_regular = |index: usize| regular.get(index).is_some_and(Option::is_some);
    let near = |index: usize, other: Option<usize>| {
        let other = other.filter(|other| is_regular(*other))?;
        let (state, spectrum) = nearest(continuation, &points[index], &points[other])?;
        Some(Sample { state, spectrum, sheet: path.sheet(other) })
    };
    let sides = |index: usize| [near(index, index.checked_sub(1)), near(index, Some(index + 1))];
    let beside: BTreeMap<usize, [Option<Sample>; 2]> = faults.keys().map(|index| (*index, sides(*index))).collect();
    branch.missing.extend(missing(points, &beside, faults));
    let softest = regular.iter().flatten().fold(0.0_f64, |most, sample| most.max(sample.spectrum.softness()));
    let softened = |sample: Sample| Sample { spectrum: sample.spectrum.beside(softest), ..sample };
    Samples {
        regular: regular.into_iter().map(|sample| sample.map(softened)).collect(),
        beside: beside.into_iter().map(|(index, both)| (index, both.map(|sample| sample.map(softened)))).collect(),
    }
}

/// Parts of the range without small motions, from the nearest states with some, each with its first error.
fn missing(
    points: &[State],
    beside: &BTreeMap<usize, [Option<Sample>; 2]>,
    faults: BTreeMap<usize, LinearError>,
) -> Vec<((f64, f64), LinearError)> {
    let mut parts: Vec<((f64, f64), LinearError)> = Vec::new();
    let mut last = None;
    for (index, error) in faults {
        let ends = beside[&index].iter().flatten().map(|sample| sample.state.value);
        let (low, high) =
            ends.fold((points[index].value, points[index].value), |(low, high), x| (low.min(x), high.max(x)));
        match parts.last_mut().filter(|_| last.is_some_and(|last| last + 1 == index)) {
            Some((part, _)) => *part = (part.0.min(low), part.1.max(high)),
            None => parts.push(((low, high), error)),
        }
        last = Some(index);
    }
    parts
}

/// The state with small motions that is nearest to one without, on the way from another one that has some, by bisection.
fn nearest(continuation: &Continuation, singular: &State, from: &State) -> Option<(State, Spectrum)> {
    let mut found = None;
    let (mut without, mut with) = (0.0, 1.0);
    while with - without > NEAREST {
        let middle = 0.5 * (without + with);
        let state = continuation.between(singular, from, middle);
        match state.and_then(|state| Some((continuation.spectrum(&state).ok()?, state))) {
            Some((spectrum, state)) => (found, with) = (Some((state, spectrum)), middle),
            None => without = middle,
        }
    }
    found
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
            hidden: 0.0,
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
        let [growing, away] = if counted(&low) > counted(&high) { [&low, a] } else { [&high, b] };
        let width = (high.state.value - low.state.value).abs();
        let hidden = width.max(self.hidden(growing, away, measure));
        found.extend(self.thresholds(&low, &high, measure).map(|threshold| Threshold { hidden, ..threshold }));
        if counted(&high) != counted(b) {
            self.between([None, None], [&high, b], SHALLOW, kept, found);
        }
    }

    /// How far from a change of stability, on the side where more grows, rounding may still be what grows.
    fn hidden(&self, growing: &Sample, away: &Sample, measure: Measure) -> f64 {
        let (count, whole) = (growing.spectrum.counted(measure), (away.state.value - growing.state.value).abs());
        if growing.spectrum.is_exact(measure) || count == growing.spectrum.grown_clearly(measure) {
            return 0.0;
        }
        let clear = |part: &f64| {
            self.left.set(self.left.get().checked_sub(1)?);
            let state = self.continuation.between(&growing.state, &away.state, *part)?;
            let sample = self.sample(state, growing.sheet)?;
            (sample.spectrum.grown_clearly(measure) >= count).then_some(*part)
        };
        let parts = std::iter::successors(Some(CLOSEST), |part| Some(4.0 * part)).take_while(|part| *part < 1.0);
        whole * parts.into_iter().find_map(|part| clear(&part)).unwrap_or(1.0)
    }

    /// The same of each motion that begins or ceases to grow: several that do at one value have frequencies of their own.
    fn thresholds(&self, a: &Sample, b: &Sample, measure: Measure) -> impl Iterator<Item = Threshold> {
        let whole = self.threshold(a, b, measure);
        let more = if a.spectrum.counted(measure) > b.spectrum.counted(measure) { a } else { b };
        let [below, above] = whole.growing;
        let mut borders = match whole.crosses {
            true => more.spectrum.borders(measure, below.abs_diff(above)),
            false => vec![(whole.omega, below.abs_diff(above))],
        };
        if borders.is_empty() {
            borders.push((whole.omega, below.abs_diff(above)));
        }
        if above < below {
            borders.reverse();
        }
        let mut reached = below;
        let last = borders.len().saturating_sub(1);
        borders.into_iter().enumerate().map(move |(index, (omega, count))| {
            let before = reached;
            reached = match (index == last, above > below) {
                (true, _) => above,
                (false, true) => before + count,
                (false, false) => before - count,
            };
            Threshold { omega, kind: ThresholdKind::of(omega), growing: [before, reached], ..whole.clone() }
        })
    }

    /// Between two states of which stability differs, by this measure.
    fn threshold(&self, a: &Sample, b: &Sample, measure: Measure) -> Threshold {
        let more = if a.spectrum.counted(measure) > b.spectrum.counted(measure) { a } else { b };
        let omega = more.spectrum.border(measure).unwrap_or(0.0);
        let value = 0.5 * (a.state.value + b.state.value);
        let [low, high] = if a.state.value <= b.state.value { [a, b] } else { [b, a] };
        let growing = [low, high].map(|end| end.spectrum.growing(measure));
        let crosses = low.spectrum.unstable(measure) != high.spectrum.unstable(measure);
        Threshold {
            omega,
            crosses,
            folded: self.path.folded(a.sheet, value),
            ..Threshold::at(value, ThresholdKind::of(omega), growing)
        }
    }
}
