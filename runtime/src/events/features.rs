//! Features of the equations of motion that a step may jump over.
//!
//! An elementary function is local only through its argument A, and arguments are tame.  After a step has passed the
//! other tests, each argument is followed along it; where it ran through the region in which its function happens,
//! and the ends of the step show nothing of that, the step is cut so that the error test sees the rest by itself.

use super::arguments::{Arguments, Course};
use super::root::{Around, locate};
use crate::integrate::Endpoint;
use crate::mechanism::{At, Role, System, Watched};

/// The arguments of the equations of motion.
#[derive(Clone, Debug)]
pub(crate) struct FeatureDetector {
    /// Those that depend on the state: place and role; of a power's also by which factor it may change.
    of_state: Vec<(usize, Role, f64)>,
    /// Those that depend on time alone, and are known before a step.
    of_time: Vec<usize>,
    /// Squared distances along which forces act, with the largest they had.
    distances: Vec<(usize, f64)>,
    /// Steps within which one of them could not be followed.
    unfollowed: u32,
    /// Whether a phase turns inside one of them, so that the ends of a step tell nothing.
    wild: bool,
    /// The part of the usual change of a natural variable after which a step is cut.
    part: f64,
    /// All arguments (A, A') at the start and the end of the step looked at last, and when that is, s.
    start: Vec<f64>,
    end: Vec<f64>,
    ends: f64,
}

/// A step along which the natural variables change by no more than this is not looked at closer.
const CALM: f64 = 1.5;
/// Nor is one along which no squared distance falls to this part of those at its ends.
const FAR: f64 = 0.2;
/// An argument leaves its chord by no more than this part of its change, and of what its slopes deviate from it: the cubic
/// does by 4/27 of the latter at most.
const MARGIN: f64 = 0.22;

/// exp A counts as zero below this A.
const VANISHES: f64 = -40.0;
/// tanh A is constant beyond ± this A.
const SATURATES: f64 = 20.0;
/// Where cuts are to be others than usual they come after this part of the usual change.
const FINER: f64 = 0.5;
/// A change of the natural variable by more than this is a feature.
const FEATURE: f64 = 2.5;
/// A step is cut where the natural variable has changed by this.
const KEPT: f64 = 2.0;
/// An exponential falls this many times more than its slope at the start says: it starts at the top.
const LEAP: f64 = 10.0;
/// Of what lies this far below the largest of an exponential nothing is seen.
const UNSEEN: f64 = 10.0;
/// Cuts to less than this part of a step are not made: an argument begins in its own singularity.
const LEAST: f64 = 1e-12;
/// Zero of the base of a power, in parts of the largest.
const NOTHING: f64 = 1e-16;

/// Distances are followed no more after so many steps in which one could not be.
const MOST_UNFOLLOWED: u32 = 10;

impl FeatureDetector {
    /// The arguments that a description lists for the motion.
    ///
    /// Runs that cut their steps at the same places of a feature share its error; to be compared with another one, a run
    /// cuts them at others: `decorrelate_steps`.
    pub fn new<S: System + ?Sized>(system: &S, decorrelate_steps: bool) -> Self {
        let part = if decorrelate_steps { FINER } else { 1.0 };
        let parameters = system.parameters();
        let in_force = || {
            let list = system.description().arguments.iter().enumerate();
            list.filter(|(_, argument)| argument.of == Watched::Motion && argument.is_in_force(&parameters))
        };
        let motion = in_force().filter(|(_, argument)| argument.role != Role::Distance);
        let (of_time, of_state): (Vec<_>, Vec<_>) = motion.partition(|(_, argument)| argument.time_only);
        let places = |list: Vec<(usize, _)>| list.into_iter().map(|(place, _)| place).collect::<Vec<usize>>();
        let arguments = &system.description().arguments;
        let wild = arguments.iter().any(|argument| match argument.of {
            Watched::Argument(outer) => argument.role == Role::Phase && !arguments[outer as usize].time_only,
            _ => false,
        });
        let distances = in_force().filter(|(_, argument)| argument.role == Role::Distance);
        FeatureDetector {
            of_state: of_state
                .into_iter()
                .map(|(place, argument)| (place, argument.role, ratio(argument.role, part)))
                .collect(),
            of_time: places(of_time),
            distances: distances.map(|(place, _)| (place, 0.0)).collect(),
            unfollowed: 0,
            wild,
            part,
            start: vec![0.0; 2 * arguments.len()],
            end: vec![0.0; 2 * arguments.len()],
            ends: f64::NAN,
        }
    }

    /// True where there is nothing to look at.
    pub fn is_empty(&self) -> bool {
        self.of_state.is_empty() && self.of_time.is_empty() && self.distances.is_empty()
    }

    /// Whether a step between these states, with their rates, keeps clear of every feature of the state as far as its
    /// ends tell: by bounds of the cubic through the values and slopes of each argument, which is tame as long as no phase
    /// turns inside it.
    pub fn has_no_feature<S: System + ?Sized>(
        &mut self,
        system: &S,
        (t, next): (f64, f64),
        (start, end): (Endpoint<'_>, Endpoint<'_>),
    ) -> bool {
        if self.of_state.is_empty() && self.distances.is_empty() {
            return true;
        }
        let n = start.y.len() / 2;
        let pairs = |t: f64, state: Endpoint<'_>, pairs: &mut [f64]| {
            system.arguments(At::packed(t, state.y, n).accelerated(&state.rate[n..]), pairs);
        };
        if self.ends == t {
            std::mem::swap(&mut self.start, &mut self.end);
        } else {
            pairs(t, start, &mut self.start);
        }
        pairs(next, end, &mut self.end);
        self.ends = next;
        if self.wild {
            return false;
        }
        let h = next - t;
        let ends = |index: usize| {
            let pair = |pairs: &[f64]| (pairs[2 * index], pairs[2 * index + 1]);
            (pair(&self.start), pair(&self.end))
        };
        let still =
            |(index, role, ratio): &(usize, Role, f64)| excludes_feature(*role, *ratio, self.part, h, ends(*index));
        let far = |(index, _): &(usize, f64)| excludes_feature(Role::Distance, 0.0, self.part, h, ends(*index));
        let has_no_feature = self.of_state.iter().all(still) && self.distances.iter().all(far);
        for (index, largest) in &mut self.distances {
            *largest = largest.max(self.start[2 * *index]).max(self.end[2 * *index]);
        }
        has_no_feature
    }

    /// Forgets the end of the last step: the state or the equations have changed.
    pub fn forget(&mut self) {
        self.ends = f64::NAN;
    }

    /// Where in a step from t of h seconds, 0 to 1, a feature of time alone is met; `None`: nowhere.
    pub fn ahead<S: System + ?Sized>(&self, arguments: &mut Arguments, system: &S, t: f64, h: f64) -> Option<f64> {
        first((self.of_time.iter().copied(), self.part), arguments, system, &Course::Time { t, h })
    }

    /// The first squared distance that vanishes within a step, to `part` of the largest distance there was, where the
    /// equations notice: its place in the description's list, and where in the step.
    pub fn meets<S: System + ?Sized>(
        &mut self,
        arguments: &mut Arguments,
        system: &S,
        course: &Course<'_>,
        part: f64,
    ) -> Option<(usize, f64)> {
        // What cannot be followed again and again is no motion any more, but the noise of one that grew without bound.
        if self.unfollowed > MOST_UNFOLLOWED {
            return None;
        }
        for (index, largest) in &mut self.distances {
            if !arguments.follow(system, course, *index) {
                self.unfollowed += 1;
                continue;
            }
            let finite = arguments.path.iter().filter(|(_, square)| square.is_finite());
            *largest = finite.clone().fold(*largest, |most, (_, square)| most.max(*square));
            let least = finite.min_by(|a, b| a.1.total_cmp(&b.1));
            let Some(&(x, square)) = least.filter(|(_, square)| *square <= part * part * *largest) else { continue };
            if arguments.breaks(system, course, *index, (x, square.max(1e-18 * *largest))) {
                return Some((*index, x));
            }
        }
        None
    }

    /// The squared distance that vanishes at a state, or would within `ahead` seconds.
    pub fn met<S: System + ?Sized>(
        &self,
        arguments: &mut Arguments,
        system: &S,
        (t, y): (f64, &[f64]),
        ahead: f64,
    ) -> Option<usize> {
        let met = |(index, largest): &(usize, f64)| {
            let (square, rate) = arguments.at_state(system, (t, y), *index);
            let soon = rate < 0.0 && -2.0 * square / rate <= ahead;
            (square <= 1e-8 * largest && soon || square <= 1e-28 * largest).then_some(*index)
        };
        self.distances.iter().find_map(met)
    }

    /// Where in a step that was tried it has to be cut; `None`: nowhere.
    pub fn cut<S: System + ?Sized>(&self, arguments: &mut Arguments, system: &S, course: &Course<'_>) -> Option<f64> {
        first((self.of_state.iter().map(|(place, ..)| *place), self.part), arguments, system, course)
    }
}

/// The variable in which a function of an argument changes evenly; of powers, arguments count as no smaller than `least`.
fn natural(role: Role, a: f64, least: f64) -> f64 {
    match role {
        Role::Exponential => a.max(VANISHES),
        Role::Bounded => a.clamp(-SATURATES, SATURATES),
        Role::Arctangent => a.asinh(),
        Role::Points => a,
        Role::Power(p) => -p.abs() * a.abs().clamp(least, f64::MAX).ln(),
        Role::Phase | Role::Landmark | Role::Distance => 0.0,
    }
}

/// Whether an argument, with these values and rates at the ends of a step of h seconds, keeps clear of its feature: it is no
/// farther from its chord than the cubic with these slopes can be, and some more.
#[inline]
pub(crate) fn excludes_feature(
    role: Role,
    ratio: f64,
    part: f64,
    h: f64,
    ((a, from), (b, to)): ((f64, f64), (f64, f64)),
) -> bool {
    let bend = (h * from - (b - a)).abs() + (h * to - (b - a)).abs();
    let (least, most, margin) = (a.min(b), a.max(b), MARGIN * (bend + (b - a).abs()));
    match role {
        Role::Distance => least - margin > FAR * least,
        // p ln|A| changes by no more than that, and A keeps its sign.
        Role::Power(_) => {
            let (low, high) = if least > 0.0 { (least, most) } else { (-most, -least) };
            high + margin <= ratio * (low - margin)
        }
        Role::Exponential => most + margin <= (most + part * CALM).max(VANISHES),
        _ => natural(role, most + margin, 0.0) - natural(role, least - margin, 0.0) <= part * CALM,
    }
}

/// Whether the function is large where its natural variable is, and nothing elsewhere.
fn rises(role: Role) -> bool {
    matches!(role, Role::Exponential) || matches!(role, Role::Power(p) if p > 0.0)
}

/// The factor by which the base of a power may change so that its natural variable stays calm.
pub(crate) fn ratio(role: Role, part: f64) -> f64 {
    match role {
        Role::Power(p) => (part * CALM / p.abs()).exp(),
        _ => 0.0,
    }
}

fn first<S: System + ?Sized>(
    (list, part): (impl Iterator<Item = usize>, f64),
    arguments: &mut Arguments,
    system: &S,
    course: &Course<'_>,
) -> Option<f64> {
    let cuts = list.filter_map(|index| feature(arguments, system, course, (index, part)));
    cuts.min_by(f64::total_cmp)
}

/// Where a step has to end for the sake of one argument.
fn feature<S: System + ?Sized>(
    arguments: &mut Arguments,
    system: &S,
    course: &Course<'_>,
    (index, part): (usize, f64),
) -> Option<f64> {
    let role = system.description().arguments[index].role;
    // What cannot be certified is met by halves.
    if !arguments.follow(system, course, index) {
        return Some(0.5);
    }
    let mut path = std::mem::take(&mut arguments.path);
    let place = along(arguments, system, course, (index, role, part), &mut path);
    arguments.path = path;
    place
}

fn along<S: System + ?Sized>(
    arguments: &mut Arguments,
    system: &S,
    course: &Course<'_>,
    (index, role, part): (usize, Role, f64),
    path: &mut Vec<(f64, f64)>,
) -> Option<f64> {
    let (feature, kept) = (part * FEATURE, part * KEPT);
    path.retain(|(_, value)| !value.is_nan());
    let largest = path.iter().fold(0.0_f64, |most, (_, a)| most.max(a.abs())).min(f64::MAX);
    let least = (NOTHING * largest).max(f64::MIN_POSITIVE);
    let natural = |a: f64| natural(role, a, least);
    let (start, end) = (natural(path.first()?.1), natural(path.last()?.1));
    let (top, most) = path.iter().map(|(x, a)| (*x, natural(*a))).max_by(|a, b| a.1.total_cmp(&b.1))?;
    // Natural variables far below the largest of a power show nothing.
    let natural = |a: f64| match role {
        Role::Power(_) => natural(a).max(most + VANISHES),
        _ => natural(a),
    };
    // Through zero a root is no feature but an edge of where it is defined.
    let edge = matches!(role, Role::Power(_)) && path.windows(2).any(|pair| pair[0].1 * pair[1].1 <= 0.0);
    if rises(role) && edge {
        return None;
    }
    // Where it begins at the top its factors may vanish, and nothing is seen of what it falls off, however often it rises again.
    let valley =
        path.iter().take_while(|(_, a)| natural(*a) <= start).min_by(|a, b| natural(a.1).total_cmp(&natural(b.1)))?;
    let from_the_top = rises(role) && start > natural(valley.1) + feature && {
        let (a, slope) = arguments.sample(system, course, index, path[0].0);
        let (fall, slope) = match role {
            Role::Power(p) => (start - natural(valley.1), p * slope / a),
            _ => (a - valley.1, slope),
        };
        fall > LEAP * valley.0 * slope.abs()
    };
    let mut at = |x: f64| natural(arguments.sample(system, course, index, x).0);
    if rises(role) && !from_the_top {
        if most <= start.max(end) + feature {
            return None;
        }
        let level = (start + kept).max(most - UNSEEN / part);
        let before = path.windows(2).find(|pair| pair[1].0 <= top && natural(pair[1].1) >= level)?;
        let (a, b) = (before[0], before[1]);
        let (low, high) = (natural(a.1) - level, natural(b.1) - level);
        let x = if low >= 0.0 || high <= 0.0 {
            b.0
        } else {
            locate(|x| at(x) - level, (a.0, low), (b.0, high), Around::bracket(a.0, b.0)).0
        };
        return Some(x.min(0.9)).filter(|x| *x > LEAST);
    }
    let start = natural(path.first()?.1);
    let away = |a: f64| (natural(a) - start).abs();
    if path.iter().all(|(_, a)| away(*a) <= feature) {
        return None;
    }
    let pair = path.windows(2).find(|pair| away(pair[1].1) >= kept)?;
    let (a, b) = (pair[0], pair[1]);
    let (low, high) = (away(a.1) - kept, away(b.1) - kept);
    let x = if low >= 0.0 || high <= 0.0 {
        b.0
    } else {
        locate(|x| (at(x) - start).abs() - kept, (a.0, low), (b.0, high), Around::bracket(a.0, b.0)).0
    };
    Some(x.min(0.9)).filter(|x| *x > LEAST)
}
