//! Equilibria and steady motions as a parameter or a speed changes: one branch is followed, round its folds too, and every
//! threshold on it is found.
//!
//! 1. What changes: look in `varied.rs`; the equations of its states: look in `balance.rs`, and with constraints in `../constrained/balance.rs`.
//! 2. Pseudo-arclength continuation: look in `continuation.rs`.
//! 3. Eigenvalues along it, and between which two states of it stability changes: look in `threshold.rs`.
//! 4. Where constraints lose their rank: look in `dependence.rs`.
//! 5. Sheets between folds, and which of them comes first at a value: look in `sheets.rs`.
//! 6. What of the range is left where the branch ends: below.
//! 7. Critical speeds of what turns: look in `critical.rs`.
//! 8. States between, for paths that are drawn: look in `smooth.rs`.

mod balance;
mod continuation;
mod critical;
mod dependence;
mod sheets;
mod smooth;
mod spectrum;
mod threshold;
mod varied;

#[cfg(all(test, feature = "modal"))]
mod tests;

use nalgebra::Complex;

use super::equilibrium::Guess;
use super::{LinearError, constrained, has_dependent_coordinates};
use crate::mechanism::System;
use balance::Free;
use continuation::{Continuation, End, Path};
use sheets::Cover;
use threshold::thresholds;

pub(super) use balance::{Balance, Slopes};
pub use critical::CriticalSpeed;
pub(super) use spectrum::Spectrum;
pub use varied::Varied;

/// A state of the branch.
#[derive(Clone, Debug, PartialEq)]
pub struct BranchPoint {
    /// The value of the parameter or speed, SI.
    pub value: f64,
    /// Generalized coordinates, SI.
    pub q: Vec<f64>,
    /// All eigenvalues λ of small motions e^(λt), 1/s.
    pub eigenvalues: Vec<Complex<f64>>,
    /// How many modes grow.
    pub growing: usize,
    /// How many folds lie between it and where the branch was entered.
    pub folds: usize,
    /// True behind a fold: the branch has another state at this value, with fewer folds before it.
    pub folded: bool,
}

/// What happens at a threshold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThresholdKind {
    /// An oscillation begins to grow, or ends growing.
    Flutter,
    /// A departure without oscillation does: the stiffness vanishes in a direction.
    Divergence,
    /// The branch turns back; beyond this value it has no equilibrium near by.
    Fold,
    /// The branch turns back where it meets another, its mirror image.
    Bifurcation,
    /// The branch goes to infinity: coordinates grow beyond all bounds as the parameter comes near this value.
    Pole,
    /// Constraints that are independent near by depend on each other: branches of other shapes of the mechanism may pass.
    Dependence,
}

impl ThresholdKind {
    /// Of a motion of this frequency that begins or ceases to grow.
    fn of(omega: f64) -> ThresholdKind {
        if omega > 0.0 { ThresholdKind::Flutter } else { ThresholdKind::Divergence }
    }

    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            ThresholdKind::Flutter => "flutter",
            ThresholdKind::Divergence => "divergence",
            ThresholdKind::Fold => "fold",
            ThresholdKind::Bifurcation => "bifurcation",
            ThresholdKind::Pole => "pole",
            ThresholdKind::Dependence => "dependence",
        }
    }
}

/// A value at which something changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Threshold {
    /// The value of the parameter or speed, SI.
    pub value: f64,
    /// Where a motion begins or ceases to grow: how far on rounding hides it, in the units of `value`; else 0.
    pub hidden: f64,
    /// What happens.
    pub kind: ThresholdKind,
    /// How many modes grow below the value and above it; at a fold, before it and behind it.
    pub growing: [usize; 2],
    /// The frequency of what begins or ends to grow, rad/s; 0 but for flutter.
    pub omega: f64,
    /// True where eigenvalues cross the imaginary axis; false where a growing pair splits into two real ones, too.
    pub crosses: bool,
    /// True behind a fold.
    pub folded: bool,
    /// A row of the constraints that depends on others here; at a fold, that beyond it they cannot be met.
    pub constraint: Option<String>,
    /// The index of the coordinate that grows beyond all bounds, at a pole.
    pub coordinate: Option<usize>,
}

/// Where one branch ends and another had to be taken.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The parameter's value.
    pub value: f64,
    /// Where the branch ended.
    pub from: Vec<f64>,
    /// Where the other one was found.
    pub to: Vec<f64>,
}

/// An equilibrium, or a steady motion, as a parameter or speed goes through a range.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Branch {
    /// States, in the direction of the range; those behind folds, where the branch has been before, at the end.
    pub points: Vec<BranchPoint>,
    /// Thresholds, by rising value.
    pub thresholds: Vec<Threshold>,
    /// Where it had to change branch.
    pub changes: Vec<Change>,
    /// Parts of the range without equilibrium, and why.
    pub missing: Vec<((f64, f64), LinearError)>,
    /// True where the branch is closed: it returns to its start.
    pub closed: bool,
}

impl Branch {
    /// Whether two neighbours among the states that come first at their value belong to one piece of the branch.
    pub fn joins(&self, a: &BranchPoint, b: &BranchPoint) -> bool {
        let (low, high) = (a.value.min(b.value), a.value.max(b.value));
        a.folds == b.folds && !self.changes.iter().any(|change| (low..=high).contains(&change.value))
    }
}

/// Follows the equilibrium, or the steady motion, that a guess leads to at the system's present parameters, while one
/// parameter or speed goes through a range.
///
/// From the present value (or the end of the range that is nearest to it) the branch is followed to both ends.  Between
/// two states no eigenvalue moves by more than a part of its distance from others and from the border of stability,
/// or states are put between them, so that narrow windows of instability are found; thresholds are right to some 1e-12
/// of the range.
///
/// With constraints the branch consists of states that meet them, in all coordinates of the file; eigenvalues are those of
/// independent ones, and where rows lose their rank is a threshold with the name of one of them.  Where constraints leave no
/// independent coordinates, or a motion turns as a whole, they are those of `linearise_tangent`;
/// zeros that they have at every state are neither stable nor unstable.
///
/// # Errors
/// As [`equilibrium_near`](super::equilibrium_near) and [`linearise`](super::linearise), with constraints as
/// [`linearise_constrained`](super::linearise_constrained), where no part of the range has an equilibrium with a linear model.
pub fn follow<S: System + ?Sized>(
    system: &S,
    varied: &Varied,
    (from, to): (f64, f64),
    guess: &Guess,
) -> Result<Branch, LinearError> {
    let range = (from.min(to), from.max(to));
    let present = varied.present(system, guess)?;
    let continuation = Continuation::new(balance(system, varied, guess)?, range)?;
    let found = continuation.search(present, &guess.q)?;
    let mut branch = Branch::default();
    let first = present.clamp(range.0, range.1);
    let (start, left) = continuation.towards(present, first, found)?;
    branch.changes.extend(left.map(|left| Change { value: left.value, from: left.q, to: start.clone() }));
    let start = State { q: start, value: first };
    let mut paths = Vec::new();
    for (direction, bound) in [(-1.0, range.0), (1.0, range.1)] {
        if start.value == bound {
            continue;
        }
        let path = continuation.walk(&start, direction);
        branch.closed = matches!(path.end, End::Closed);
        if branch.closed {
            paths = Vec::from(path.halved());
            break;
        }
        paths.push(path);
    }
    let mut cover = Cover::none();
    sheets::order(&mut paths, &mut cover);
    for direction in [-1.0, 1.0] {
        beyond(&continuation, direction, &mut paths, &mut cover, &mut branch);
    }
    paths.iter().for_each(|path| thresholds(&continuation, path, &mut branch));
    arranged(&mut branch, from <= to);
    match (branch.missing.first(), branch.points.is_empty()) {
        (Some((_, error)), true) => Err(error.clone()),
        _ => Ok(branch),
    }
}

/// States in their order, and how many modes grow on both sides of a pole, which lie on different paths.
fn arranged(branch: &mut Branch, rising: bool) {
    branch.points.sort_by(|a, b| {
        let by_value = a.value.total_cmp(&b.value);
        a.folded.cmp(&b.folded).then(if rising { by_value } else { by_value.reverse() })
    });
    branch.points.dedup_by(|a, b| a.value == b.value && a.folded == b.folded && a.folds == b.folds);
    branch.thresholds.sort_by(|a, b| a.value.total_cmp(&b.value));
    let first = |points: &mut dyn Iterator<Item = &BranchPoint>, sign: f64| {
        points.min_by(|a, b| (sign * a.value).total_cmp(&(sign * b.value))).map(|point| point.growing)
    };
    for pole in branch.thresholds.iter_mut().filter(|threshold| threshold.kind == ThresholdKind::Pole) {
        let at = pole.value;
        let own = || branch.points.iter().filter(|point| !point.folded);
        let below = first(&mut own().filter(|point| point.value < at), -1.0);
        let above = first(&mut own().filter(|point| point.value > at), 1.0);
        pole.growing = [below.unwrap_or(pole.growing[0]), above.unwrap_or(pole.growing[1])];
    }
}

/// The equations of a mechanism's states, with its constraints.
fn balance<S: System + ?Sized>(system: &S, varied: &Varied, guess: &Guess) -> Result<Box<dyn Balance>, LinearError> {
    let present = varied.present(system, guess)?;
    match !has_dependent_coordinates(system) {
        true => Ok(Box::new(Free::new(system, varied, present, guess))),
        false => constrained::balance(system, varied, present, guess),
    }
}

/// Where a branch does not reach an end of the range, on by other branches as far as there are any.
fn beyond(continuation: &Continuation, direction: f64, paths: &mut Vec<Path>, cover: &mut Cover, branch: &mut Branch) {
    let (low, high) = continuation.range;
    // A branch that ends is left for another one; more than a few are a sign of something else.
    for _ in 0..8 {
        if cover.contains(if direction > 0.0 { high } else { low }) {
            return;
        }
        let ends = paths.iter().flat_map(Path::ends);
        let Some(last) = ends.max_by(|a, b| (direction * a.value).total_cmp(&(direction * b.value))) else { return };
        let last = last.clone();
        let next = match continuation.another(&last, direction) {
            Ok(next) => Ok((continuation.walk(&next, direction), next)),
            Err(error) => from_outside(continuation, &last, direction, paths).ok_or(error),
        };
        match next {
            Ok((path, next)) => {
                let mut path = [path];
                branch.changes.push(Change { value: last.value, from: last.q, to: next.q });
                sheets::order(&mut path, cover);
                paths.extend(path);
            }
            Err(error) => {
                let rest = if direction > 0.0 { (last.value, high) } else { (low, last.value) };
                branch.missing.push((rest, error));
                return;
            }
        }
    }
}

/// A path beyond the end of others that is a part of theirs, which has left the range on its other side and comes back there, and its first state
/// beyond that end.
fn from_outside(continuation: &Continuation, end: &State, direction: f64, paths: &[Path]) -> Option<(Path, State)> {
    let (low, high) = continuation.range;
    let other_side = if direction > 0.0 { low } else { high };
    let left = paths.iter().filter(|path| path.points.last().is_some_and(|last| last.value == other_side));
    left.filter_map(|path| continuation.back_from_outside(path)).find_map(|back| {
        let path = continuation.walk(&back, direction);
        let beyond = path.points.iter().find(|state| direction * state.value > direction * end.value)?.clone();
        Some((path, beyond))
    })
}

/// A state (q, p) of the branch.
#[derive(Clone, Debug)]
struct State {
    q: Vec<f64>,
    value: f64,
}

/// A fold.
struct TurningPoint {
    at: State,
    /// The place of the state behind it in the path.
    index: usize,
    mirrored: bool,
}
