//! Where motions of a family change.

use nalgebra::Complex;

use super::closing::By;
use super::family::{OrbitChange, Threshold};
use super::laps::{Laps, lcm};
use super::multipliers::Polar;
use super::walk::{Node, Walk};
use crate::error::Error;
use crate::events::{Around, locate};
use crate::vary::TOLD;

/// Pairs whose logarithms are less than this are on the unit circle.
const CIRCLE: f64 = 1e-7;
/// Places along a family that are no farther apart than this part of the step are one: motions are known to some twelve digits.
pub(super) const SAME: f64 = 1e-13;
/// Where another family crosses, steps along it are left out within this part of the way between two members: they are as good as free there.
const CROSSING: f64 = 1e-3;
/// A motion closes, whose pieces miss each other by no more than so many times the tolerance.
const CLOSES: f64 = 1e3;

impl OrbitChange {
    /// A function of members whose sign changes there.
    fn measure(self, node: &Node) -> f64 {
        if self == OrbitChange::Fold { node.slope } else { self.of_multipliers(&node.spectrum.multipliers) }
    }

    /// The same for what multipliers tell alone: all but folds.
    pub(super) fn of_multipliers(self, multipliers: &[Polar]) -> f64 {
        match self {
            OrbitChange::Fold | OrbitChange::Branch => product(multipliers, 1.0),
            OrbitChange::Doubling | OrbitChange::SymmetryBreaking => product(multipliers, -1.0),
            OrbitChange::Pair => pair(multipliers).unwrap_or(0.0),
        }
    }

    /// Whether it happens between two members at which its function has these values, or at one of them; of pairs 0 means that there is none.
    pub(super) fn is_between(self, a: f64, b: f64) -> bool {
        match self {
            OrbitChange::Pair => a * b < 0.0 && a.abs().max(b.abs()) > CIRCLE,
            _ => (a < 0.0 && b >= 0.0) || (a >= 0.0 && b < 0.0),
        }
    }
}

impl Laps {
    /// What happens where a multiplier of the map passes −1.  Laps that end after a part of the period are of one motion, as the two halves of a
    /// swing: where an even number of maps takes every state to itself the two that differ from there on fill the same period.  Laps
    /// that events end, as steps of a gait, are counted one by one.
    pub fn at_minus_one(&self) -> OrbitChange {
        let maps = lcm(self.closing.order(), self.laps) / self.laps;
        match self.closing.by {
            By::Part(_) if maps.is_multiple_of(2) => OrbitChange::SymmetryBreaking,
            _ => OrbitChange::Doubling,
        }
    }
}

impl Walk {
    /// What happens between two members that are `h` apart, in order.  Where a family turns back a multiplier is 1 as well.
    pub fn between(&mut self, from: &Node, to: &Node, h: f64) -> Result<Vec<(Node, OrbitChange)>, Error> {
        let at_minus_one = self.begun.laps.at_minus_one();
        let all = [OrbitChange::Fold, OrbitChange::Branch, at_minus_one, OrbitChange::Pair];
        let unsure = from.spectrum.least_product().max(to.spectrum.least_product());
        let happens = |kind: &OrbitChange| {
            let [a, b] = [from, to].map(|node| kind.measure(node));
            kind.is_between(a, b) && (*kind == OrbitChange::Fold || a.abs().max(b.abs()) > unsure)
        };
        let mut kinds: Vec<OrbitChange> = all.into_iter().filter(happens).collect();
        if kinds.contains(&OrbitChange::Fold) {
            kinds.retain(|kind| *kind != OrbitChange::Branch);
        }
        let mut found = Vec::with_capacity(kinds.len());
        for kind in kinds {
            let s = self.place(from, [(0.0, kind.measure(from)), (h, kind.measure(to))], &|node| kind.measure(node));
            let node = match kind {
                OrbitChange::Branch => self.crossing(from, (s, CROSSING * h))?,
                _ => self.step(from, s)?,
            };
            found.push((node, kind));
        }
        found.sort_by(|(a, _), (b, _)| (a.value - from.value).abs().total_cmp(&(b.value - from.value).abs()));
        Ok(found)
    }

    /// The member at which a function changes its sign, between one and another `h` away.
    ///
    /// # Errors
    /// Those of members.
    pub fn locate(&mut self, from: &Node, (h, to): (f64, &Node), f: &dyn Fn(&Node) -> f64) -> Result<Node, Error> {
        let s = self.place(from, [(0.0, f(from)), (h, f(to))], f);
        self.step(from, s)
    }

    /// How far along the tangent of a member a function changes its sign.
    fn place(&mut self, from: &Node, [a, b]: [(f64, f64); 2], f: &dyn Fn(&Node) -> f64) -> f64 {
        let resolution = SAME * (b.0 - a.0).abs();
        let at = |s: f64| self.step(from, s).map_or(f64::NAN, |node| f(&node));
        locate(at, a, b, Around { resolution, ..Around::bracket(a.0, b.0) }).0
    }

    /// The member at which another family crosses, near a place that is known roughly: there the steps of Newton's method along the other
    /// family are noise, and are left out; where that is not so the member is what it is with them.
    fn crossing(&mut self, from: &Node, (s, near): (f64, f64)) -> Result<Node, Error> {
        let measure = |node: &Node| OrbitChange::Branch.measure(node);
        self.aside = 1;
        let ends = [s - near, s + near].map(|s| Some((s, measure(&self.step(from, s).ok()?))));
        let exact = match ends {
            [Some(a), Some(b)] if a.1 * b.1 < 0.0 => {
                let s = self.place(from, [a, b], &measure);
                self.step(from, s).ok()
            }
            _ => None,
        };
        self.aside = 0;
        let closes = CLOSES * self.begun.laps.settings.tolerance;
        match exact.filter(|node| node.solution.trial.r.norm() <= closes) {
            Some(node) => Ok(node),
            None => self.step(from, s),
        }
    }

    /// A threshold with its error: what a more accurate flow makes of the value, and of where along the family it is.
    pub fn threshold(&mut self, from: &Node, found: &Node, kind: OrbitChange) -> Threshold {
        self.aside = usize::from(kind == OrbitChange::Branch);
        let finer = self.finer(found);
        self.aside = 0;
        let along = (kind.measure(found) - kind.measure(from)) / (found.value - from.value);
        let there = finer.as_ref().map_or(f64::NAN, |finer| kind.measure(finer));
        // What the function is where it should be 0 is noise of motions; where a direction is left out, no less than that of changes.
        let here = kind.measure(found);
        let least = if kind == OrbitChange::Branch { found.spectrum.noise() } else { 0.0 };
        let unsure = (there - here).abs() + here.abs().max(least);
        let moved = if kind == OrbitChange::Fold { 0.0 } else { unsure / along.abs() };
        let error = Walk::off((from, found, finer), moved);
        Threshold { kind, value: found.value, error, member: self.member(found, false) }
    }

    /// A member as a more accurate flow has it.
    ///
    /// # Errors
    /// Those of members.
    pub fn finer(&mut self, found: &Node) -> Result<Node, Error> {
        self.begun.laps.scales.clone_from(&found.scales);
        let before = self.begun.laps.refine(&found.solution.trial);
        let finer = self.node(found.solution.point.clone(), Some(&found.tangent));
        self.begun.laps.settings = before;
        finer
    }

    /// How far off the value of a member is that was located from another one, with what a more accurate flow makes of it, and by how much the
    /// function by which it was located may move it.
    pub fn off((from, found, finer): (&Node, &Node, Result<Node, Error>), moved: f64) -> f64 {
        finer.map_or(f64::NAN, |finer| {
            // By what does not close, as along a direction that is left out, the motion is beside the family.
            let beside = found.slope.abs() * found.solution.trial.r.norm();
            let located = (SAME * (found.value - from.value).abs()).max(4.0 * f64::EPSILON * found.value.abs());
            (TOLD * ((finer.value - found.value).abs() + moved + beside)).max(located)
        })
    }
}

/// Re Π (μ − x)/max(1, |μ|) over all multipliers.
fn product(multipliers: &[Polar], x: f64) -> f64 {
    let factor = |polar: &Polar| {
        let size = polar.log.max(0.0).exp();
        (Complex::from_polar(polar.log.exp(), polar.angle) - x) / size
    };
    multipliers.iter().map(factor).fold(Complex::new(1.0, 0.0), |all, factor| all * factor).re
}

/// ln |μ| of the largest pair that is not real.
fn pair(multipliers: &[Polar]) -> Option<f64> {
    multipliers.iter().filter(|polar| polar.angle.sin().abs() > CIRCLE).map(|polar| polar.log).max_by(f64::total_cmp)
}
