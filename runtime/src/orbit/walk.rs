//! A walk along a family of motions that repeat.

use nalgebra::{DMatrix, DVector};

use super::begun::Begun;
use super::family::{Family, Member, OrbitChange};
use super::guess::sizes;
use super::laps::{Away, Laps, Point, Solution, lcm};
use super::stability::{Spectrum, map, spectrum};
use super::structure;
use crate::error::{Error, NoOrbit};
use crate::matrix::svd;
use crate::run::Names;

/// The first step, in parts of how far motions go: curves of most families are straight so far, and others shorten it.
const FIRST: f64 = 0.02;
/// A step that is shorter than this does not get on: motions are known to some twelve digits.
const SHORTEST: f64 = 1e-7;
/// A family that leaves another one begins at this distance from it, in parts of how far motions go: nearer to it the two are hardly told apart,
const NEAREST: f64 = 1e-3;
/// or so many times farther, as often as it is not found there, up to a first step away.
const FARTHER: f64 = 4.0;
/// No member differs from the one before by more than this part of how far it goes, lest pictures of a family have corners.
const LONGEST: f64 = 0.3;
/// Steps grow where Newton's method takes so many steps or fewer, and shrink where it takes so many or more.
const EASY: usize = 3;
const HARD: usize = 6;
/// The tangents of two members agree to this cosine, lest a fold be cut short.
const ALONG: f64 = 0.9;
/// A range is divided into so many members at least, so that two thresholds seldom hide between two of them.
const MEMBERS: f64 = 20.0;
/// Members at most.
const MOST: usize = 600;
/// Scales are no smaller than this part of the largest that members have had: a family whose motions shrink to rest and grow again, as the answer to
/// a force that passes 0, is followed through it.
const LEAST: f64 = 1e-2;
/// A null direction of the linearised equations is one of structure where it solves them to this part.
const SOLVES: f64 = 1e-5;

/// Pieces of a member that miss each other by more than this part of how far motions go leave a direction out that is not free there: rounding and
/// tolerances leave less, though at walls that are all but touched more than ten tolerances.
const MEETS: f64 = 1e-8;

/// What varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Varied {
    Parameter(usize),
    Energy,
}

/// A member, and which way the family goes there.
pub(super) struct Node {
    pub solution: Solution,
    pub spectrum: Spectrum,
    pub value: f64,
    /// dvalue/ds.
    pub slope: f64,
    pub tangent: DVector<f64>,
    pub scales: Vec<f64>,
}

/// A walk along a family.
pub(super) struct Walk {
    pub begun: Begun,
    pub varied: Varied,
    /// Directions in which nothing changes, along the family included.
    pub nullity: Option<usize>,
    /// Directions that are left out beside: where another family crosses one more changes nothing.
    pub aside: usize,
    /// The largest scales that members have had; none before the first.
    pub largest: Vec<f64>,
}

impl Walk {
    /// The member near a guess, and which way the family goes there: as `before` does, or towards larger values.
    pub fn node(&mut self, guess: Point, before: Option<&DVector<f64>>) -> Result<Node, Error> {
        let solution = self.solved(guess)?;
        let laps = &mut self.begun.laps;
        let spectrum = spectrum(laps, &solution.trial);
        let free = solution.linear.free().len();
        let mut tangent = self.tangent(&solution, &spectrum, (free, before));
        if let Some(before) = before.filter(|before| tangent.dot(before) < ALONG * before.norm() * tangent.norm()) {
            // Where another family crosses, more than one direction leads on: the one that goes on as before does.
            let other = self.tangent(&solution, &spectrum, (free + 1, Some(before)));
            if (&solution.trial.j * &other).norm() <= SOLVES * other.norm() {
                tangent = other;
            }
        }
        if tangent.norm() == 0.0 {
            let name = match self.varied {
                Varied::Parameter(k) => self.begun.laps.system.description().parameters[k].name.to_string(),
                Varied::Energy => structure::ENERGY.to_owned(),
            };
            return Err(NoOrbit::NoFamily { name }.into());
        }
        tangent.normalize_mut();
        let (value, mut slope) = self.value(&solution, &tangent);
        if before.is_none() && slope < 0.0 {
            tangent = -tangent;
            slope = -slope;
        }
        let scales = self.begun.laps.scales.clone();
        Ok(Node { solution, spectrum, value, slope, tangent, scales })
    }

    /// The motion near a guess, with as many free directions as its family has.  Some that are free where the family begins, as near rest two modes of one
    /// frequency are, need not be so farther on: motions that leave them out do not close there.
    fn solved(&mut self, guess: Point) -> Result<Solution, Error> {
        let laps = &mut self.begun.laps;
        let Some(most) = self.nullity else { return laps.solve(guess, None) };
        let solution = laps.solve(guess.clone(), Some(most + self.aside))?;
        let meets = |solution: &Solution| solution.trial.r.norm() <= MEETS;
        if meets(&solution) || self.aside > 0 {
            return Ok(solution);
        }
        for fewer in (1..most).rev() {
            match laps.solve(guess.clone(), Some(fewer)) {
                Ok(solution) if meets(&solution) => {
                    self.nullity = Some(fewer);
                    return Ok(solution);
                }
                Err(error) if error.is_interruption() => return Err(error),
                _ => {}
            }
        }
        Err(NoOrbit::TurnsSharply.into())
    }

    /// The direction along a family: of those in which nothing changes, so many, what structure does not explain; as `before` goes.
    fn tangent(
        &self,
        solution: &Solution,
        spectrum: &Spectrum,
        (free, before): (usize, Option<&DVector<f64>>),
    ) -> DVector<f64> {
        let size = self.begun.laps.unknowns();
        let null = structure::basis(&solution.linear.clone().with_free(free).free(), size);
        let known = structural(&self.begun.laps, solution, spectrum);
        let known = structure::basis(&known.iter().map(|g| &null * (null.transpose() * g)).collect::<Vec<_>>(), size);
        let rest: Vec<DVector<f64>> =
            null.column_iter().map(|column| column - &known * (known.transpose() * column)).collect();
        let rest = structure::basis_within(&rest, size, SOLVES);
        match before {
            Some(before) => &rest * (rest.transpose() * before),
            None => rest.column_iter().next().map_or_else(|| DVector::zeros(size), |column| column.into_owned()),
        }
    }

    /// What varies at a member, and how fast along a direction.
    fn value(&mut self, solution: &Solution, tangent: &DVector<f64>) -> (f64, f64) {
        let rest = self.begun.rest_energy;
        let laps = &mut self.begun.laps;
        match self.varied {
            Varied::Parameter(_) => {
                let scale = laps.parameter_scale(&solution.point);
                (solution.point.parameter, tangent[laps.unknowns() - 1] * scale)
            }
            Varied::Energy => {
                let side = &solution.trial.pieces[0].start;
                crate::vary::put(&mut *laps.system, side);
                let (energy, slopes) = structure::energy(&*laps.system, side);
                let slopes = slopes.iter().zip(&laps.scales).zip(tangent.iter());
                (energy - rest, slopes.map(|((slope, scale), x)| slope * scale * x).sum())
            }
        }
    }

    /// The member so far along the tangent of another one.
    pub fn step(&mut self, from: &Node, s: f64) -> Result<Node, Error> {
        self.begun.laps.scales.clone_from(&from.scales);
        let guess = self.begun.laps.moved(&from.solution.point, &from.tangent, s);
        self.node(guess, Some(&from.tangent))
    }

    /// A member with scales of its own motion.
    fn rescaled(&mut self, node: Node) -> Node {
        let laps = &mut self.begun.laps;
        if self.largest.is_empty() {
            self.largest.clone_from(&node.scales);
        }
        let mut scales = vec![0.0_f64; laps.scales.len()];
        for sizes in node.solution.trial.pieces.iter().map(|piece| sizes(&piece.run)) {
            scales.iter_mut().zip(sizes).for_each(|(scale, size)| *scale = scale.max(size));
        }
        let Some(mut scales) = laps.unless_alike(scales) else { return node };
        for (scale, largest) in scales.iter_mut().zip(&mut self.largest) {
            *largest = largest.max(*scale);
            *scale = scale.max(LEAST * *largest);
        }
        if scales == node.scales {
            return node;
        }
        let width = scales.len();
        let mut tangent = node.tangent.clone();
        for k in 0..node.solution.point.starts.len() {
            (0..width).for_each(|i| tangent[k * width + i] *= node.scales[i] / scales[i]);
        }
        laps.scales = scales;
        match self.node(node.solution.point.clone(), Some(&tangent)) {
            Ok(again) => again,
            Err(_) => {
                self.begun.laps.scales.clone_from(&node.scales);
                node
            }
        }
    }

    /// Walks from a member towards the last of some values; before that, where it is between the first and the last, towards the first.  Where it is
    /// beside a range of values the family is that within the range, in their order; one value is that up to which a member is followed.
    ///
    /// # Errors
    /// The member is not found again.
    pub fn both_ways(
        &mut self,
        start: Node,
        name: &str,
        values: &[f64],
    ) -> Result<(Family, Vec<(Node, OrbitChange)>), Error> {
        let here = start.value;
        let [first, last] = [values.first(), values.last()].map(|value| value.copied().unwrap_or(here));
        let (point, scales) = (start.solution.point.clone(), start.scales.clone());
        let before = |value: &f64| (value - here) * (first - here) > 0.0;
        if (first - here) * (last - here) >= 0.0 {
            let far = if (first - here).abs() > (last - here).abs() { first } else { last };
            let found = self.along(Walk::towards(start, far), name, values);
            return Ok(if first == last || first == here { found } else { within(found, values, far == first) });
        }
        let [back, on]: [Vec<f64>; 2] =
            [true, false].map(|way| values.iter().copied().filter(|x| before(x) == way).collect());
        let (earlier, changes) = self.along(Walk::towards(start, first), name, &back);
        if earlier.interrupted {
            return Ok((earlier, changes));
        }
        self.begun.laps.scales = scales;
        let again = self.node(point, None)?;
        let (mut family, later) = self.along(Walk::towards(again, last), name, &on);
        family.members = earlier.members.into_iter().skip(1).rev().chain(family.members).collect();
        family.thresholds = earlier.thresholds.into_iter().rev().chain(family.thresholds).collect();
        family.peaks = earlier.peaks.into_iter().rev().chain(family.peaks).collect();
        family.ended = family.ended.or(earlier.ended);
        Ok((family, changes.into_iter().rev().chain(later).collect()))
    }

    /// Walks from a member on, until it has left the range of some values, its own included.
    pub fn along(&mut self, start: Node, name: &str, values: &[f64]) -> (Family, Vec<(Node, OrbitChange)>) {
        let (low, high) = ends(&[values, &[start.value]].concat());
        let laps = &self.begun.laps;
        let names = Names::of(laps.system.description()).columns();
        let mut family = Family {
            name: name.to_owned(),
            names: names[..2 * laps.n()].to_vec(),
            members: vec![self.member(&start, values.contains(&start.value))],
            thresholds: Vec::new(),
            peaks: Vec::new(),
            part: lcm(laps.closing.order(), laps.laps) / laps.laps,
            map: laps.map_in_words(),
            ended: None,
            interrupted: false,
        };
        let mut changes = Vec::new();
        let mut node = start;
        let size = |node: &Node| (node.solution.point.starts.len() as f64).sqrt();
        let mut h = FIRST * size(&node);
        while high > low && (low..=high).contains(&node.value) {
            if family.members.len() >= MOST {
                family.ended = Some(format!("after {MOST} motions"));
                break;
            }
            h = h.min(LONGEST * size(&node)).min((high - low) / MEMBERS / node.slope.abs());
            let passed = match self.next(&mut node, &mut h) {
                Ok(next) => {
                    let found = self.pass(&node, &next, h, (values, [low, high], &mut family));
                    found.map(|found| changes.extend(found)).map(|()| next)
                }
                Err(why) => Err(why),
            };
            let next = match passed {
                Ok(next) => next,
                Err(why) => {
                    family.interrupted = why.is_interruption();
                    family.ended = Some(if family.interrupted { "interrupted".to_owned() } else { why.to_string() });
                    break;
                }
            };
            h *= paced(&next);
            if (low..=high).contains(&next.value) {
                let member = self.member(&next, values.contains(&next.value));
                let known = family.members.last().is_some_and(|last| last.asked && alike(last, &member, high - low));
                family.members.extend((!known).then_some(member));
            }
            node = self.rescaled(next);
        }
        (family, changes)
    }

    /// The member of a value, by steps from another one towards it.
    ///
    /// # Errors
    /// Those of members; a value that the family does not come to.
    pub fn to(&mut self, start: Node, value: f64) -> Result<Node, Error> {
        let mut node = Walk::towards(start, value);
        let size = |node: &Node| (node.solution.point.starts.len() as f64).sqrt();
        let mut h = FIRST * size(&node);
        for _ in 0..MOST {
            h = h.min(LONGEST * size(&node));
            let next = self.next(&mut node, &mut h)?;
            if (node.value - value) * (next.value - value) <= 0.0 {
                return self.locate(&node, (h, &next), &|node: &Node| node.value - value);
            }
            h *= paced(&next);
            node = self.rescaled(next);
        }
        Err(NoOrbit::TurnsSharply.into())
    }

    /// The next member, by a step that is shortened until it leads on; both in pieces short enough for the multipliers of either.
    fn next(&mut self, node: &mut Node, h: &mut f64) -> Result<Node, Error> {
        loop {
            let tried = self.step(node, *h).and_then(|next| self.begun.at_rest(&next.solution).map(|()| next));
            match tried {
                Ok(next) if next.tangent.dot(&node.tangent) >= ALONG => match self.halved(node, &next.spectrum)? {
                    None => return Ok(next),
                    Some(cut) => {
                        // A step is as long as its parts along all pieces together.
                        *h *= (cut.tangent.len() as f64 / node.tangent.len() as f64).sqrt();
                        *node = cut;
                    }
                },
                Err(error) if *h < SHORTEST || error.is_interruption() => return Err(error),
                Ok(_) if *h < SHORTEST => return Err(NoOrbit::TurnsSharply.into()),
                _ => *h *= 0.5,
            }
        }
    }

    /// A member in shorter pieces, where those are too long for these multipliers.
    fn halved(&mut self, node: &Node, found: &Spectrum) -> Result<Option<Node>, Error> {
        if !self.begun.is_coarse(found) {
            return Ok(None);
        }
        let laps = &mut self.begun.laps;
        laps.scales.clone_from(&node.scales);
        let Some(point) = laps.halved(&node.solution) else { return Ok(None) };
        // Both halves of a piece move about as the whole one does.
        let width = laps.scales.len();
        let pieces = node.solution.point.starts.len();
        let of_starts = (0..pieces).flat_map(|k| [k, k]).flat_map(|k| node.tangent.iter().skip(k * width).take(width));
        let others = node.tangent.iter().skip(pieces * width);
        let along: Vec<f64> = of_starts.chain(others).copied().collect();
        self.node(point, Some(&DVector::from_vec(along))).map(Some)
    }

    /// Takes down what happens between two members that are `h` apart, within a range, and those of the values between them.
    fn pass(
        &mut self,
        from: &Node,
        to: &Node,
        h: f64,
        (values, [low, high], family): (&[f64], [f64; 2], &mut Family),
    ) -> Result<Vec<(Node, OrbitChange)>, Error> {
        let mut changes = self.between(from, to, h)?;
        changes.retain(|(found, _)| (low..=high).contains(&found.value));
        let mut between = Vec::new();
        for (found, kind) in &changes {
            let threshold = self.threshold(from, found, *kind);
            between.push(threshold.member.clone());
            family.thresholds.push(threshold);
        }
        let peaks = self.peaks(from, to, h)?.into_iter();
        family.peaks.extend(peaks.filter(|peak| (low..=high).contains(&peak.value)));
        for value in values.iter().copied().filter(|value| (from.value - value) * (to.value - value) < 0.0) {
            let found = self.locate(from, (h, to), &|node: &Node| node.value - value)?;
            between.push(self.member(&found, true));
        }
        let way = |member: &Member| (member.value - from.value).abs();
        between.sort_by(|a, b| way(a).total_cmp(&way(b)));
        // A value that is asked for takes the place of a member that ended beside it by chance.
        let near =
            |last: &Member| !last.asked && between.iter().any(|next| next.asked && alike(last, next, high - low));
        if family.members.last().is_some_and(near) {
            family.members.pop();
        }
        family.members.extend(between);
        Ok(changes)
    }

    pub fn member(&self, node: &Node, asked: bool) -> Member {
        let (width, closing) = (node.scales.len(), &self.begun.laps.closing);
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; width];
        for row in node.solution.trial.pieces.iter().flat_map(|piece| piece.run.rows.chunks_exact(width)) {
            // The rest of the period is made of images of the lap.
            let mut y = row.to_vec();
            for _ in 0..closing.order() {
                for (range, x) in ranges.iter_mut().zip(&y) {
                    *range = [range[0].min(*x), range[1].max(*x)];
                }
                y = closing.turned(&y);
            }
        }
        Member {
            value: node.value,
            period: self.begun.laps.duration(&node.solution.trial),
            start: self.begun.start_of(&node.solution),
            amplitudes: ranges.into_iter().map(|[low, high]| 0.5 * (high - low)).collect(),
            multipliers: node.spectrum.with_errors(None),
            asked,
        }
    }

    /// A member that is to lead towards a value.
    pub fn towards(mut node: Node, goal: f64) -> Node {
        if node.slope * (goal - node.value) < 0.0 {
            node.tangent = -node.tangent;
            node.slope = -node.slope;
        }
        node
    }

    /// The first member of the family that leaves at a threshold, as near to it as the two are told apart.
    pub fn switch(&mut self, node: &Node, kind: OrbitChange) -> Result<Node, Error> {
        let laps = &mut self.begun.laps;
        laps.scales.clone_from(&node.scales);
        laps.legs = node.solution.point.starts.len() / laps.laps;
        let two_laps = matches!(kind, OrbitChange::Doubling | OrbitChange::SymmetryBreaking);
        let sign = if two_laps { -1.0 } else { 1.0 };
        let count = node.solution.trial.pieces.len();
        let maps: Vec<DMatrix<f64>> = (0..count).map(|k| map(laps, &node.solution.trial, k)).collect();
        let basis = &node.spectrum.basis;
        let whole = maps.iter().fold(DMatrix::identity(basis.nrows(), basis.nrows()), |all, map| map * all);
        let inside = basis.transpose() * whole * basis - DMatrix::identity(basis.ncols(), basis.ncols()) * sign;
        let parts = svd(inside, false, true).and_then(|svd| Some((svd.singular_values, svd.v_t?)));
        let Some((stretches, vt)) = parts.filter(|(_, vt)| vt.nrows() > 0) else {
            return Err(NoOrbit::NoFamily { name: kind.word().to_owned() }.into());
        };
        let least = stretches.imin();
        let mut direction = basis * vt.row(least).transpose();
        let mut parts = Vec::with_capacity(count);
        for map in &maps {
            parts.push(direction.clone());
            direction = map * direction;
        }
        let mut point = node.solution.point.clone();
        if two_laps {
            laps.laps *= 2;
            point.starts.extend(node.solution.point.starts.clone());
            parts.extend(parts.clone().into_iter().map(|part| -part));
        }
        let size = laps.unknowns();
        let all = parts.iter().flat_map(|part| part.iter().copied());
        let tail = std::iter::repeat(0.0);
        let along = DVector::from_iterator(size, all.chain(tail).take(size)).normalize();
        let size = (point.starts.len() as f64).sqrt();
        let mut step = NEAREST * size;
        loop {
            let laps = &mut self.begun.laps;
            let guess = laps.moved(&point, &along, step);
            // So far away the family that is left is no solution, and the parameter, or the energy, is what it must be.
            laps.away = Some(Away { from: point.clone(), along: along.clone(), by: step });
            let found = laps.solve(guess, self.nullity.map(|count| count.saturating_sub(1)));
            laps.away = None;
            match found.and_then(|found| self.node(found.point, Some(&along))) {
                Err(error) if step < FIRST * size && !error.is_interruption() => step *= FARTHER,
                first => return first,
            }
        }
    }
}

/// How much longer the step after a member is than the one that led to it.
fn paced(found: &Node) -> f64 {
    match found.solution.steps {
        steps if steps <= EASY => 1.6,
        steps if steps >= HARD => 0.6,
        _ => 1.0,
    }
}

/// What of a family is within the range of some values, the other way round where it was walked from the last to the first.
fn within(
    (mut family, changes): (Family, Vec<(Node, OrbitChange)>),
    values: &[f64],
    backwards: bool,
) -> (Family, Vec<(Node, OrbitChange)>) {
    let (low, high) = ends(values);
    let within = |value: f64| (low..=high).contains(&value);
    family.members.retain(|member| member.asked || within(member.value));
    family.thresholds.retain(|threshold| within(threshold.value));
    let mut changes: Vec<_> = changes.into_iter().filter(|(node, _)| within(node.value)).collect();
    if backwards {
        family.members.reverse();
        family.thresholds.reverse();
        changes.reverse();
    }
    (family, changes)
}

/// The least and the largest of some values.
fn ends(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
}

/// Whether two members, one after the other in a family, are the same to what motions are known.
fn alike(one: &Member, other: &Member, range: f64) -> bool {
    let mut amplitudes = one.amplitudes.iter().zip(&other.amplitudes);
    (one.value - other.value).abs() <= SHORTEST * range
        && amplitudes.all(|(one, other)| (one - other).abs() <= SHORTEST * one.max(*other))
}

/// Directions of all unknowns in which structure lets motions move: each known direction along all pieces, with the sign that the maps give it.
fn structural(laps: &Laps, solution: &Solution, spectrum: &Spectrum) -> Vec<DVector<f64>> {
    let count = solution.trial.pieces.len();
    let width = 2 * laps.n();
    let maps: Vec<DMatrix<f64>> = (0..count).map(|k| map(laps, &solution.trial, k)).collect();
    let mut list = Vec::new();
    for place in 0..spectrum.generators[0].len() {
        let mut all = DVector::zeros(laps.unknowns());
        let mut sign = 1.0;
        for (k, map) in maps.iter().enumerate() {
            let here = &spectrum.generators[k][place].direction;
            all.rows_mut(k * width, width).copy_from(&(here * sign));
            let next = &spectrum.generators[(k + 1) % count][place].direction;
            if (map * here).dot(next) < 0.0 {
                sign = -sign;
            }
        }
        if all.norm() > 0.0 && (&solution.trial.j * &all).norm() <= SOLVES * all.norm() {
            list.push(all);
        }
    }
    list
}
