//! A walk along a family of motions that repeat.

use nalgebra::{Complex, DMatrix, DVector};

use super::begun::Begun;
use super::family::{Family, Member, OrbitChange, Threshold};
use super::guess::sizes;
use super::laps::{Condition, Laps, Point, Solution, lcm};
use super::multipliers::Polar;
use super::stability::{Spectrum, beside, map, spectrum};
use super::structure;
use crate::error::{Error, NoOrbit};
use crate::run::Names;
use crate::vary::LOOSER;

/// The way to the next member, in parts of how far motions go, of all their pieces together.
const FIRST: f64 = 0.02;
const SHORTEST: f64 = 1e-7;
const LONGEST: f64 = 0.3;
/// Steps grow where Newton's method takes so many steps or fewer, and shrink where it takes so many or more.
const EASY: usize = 3;
const HARD: usize = 6;
/// The tangents of two members agree to this cosine, lest a fold be cut short.
const ALONG: f64 = 0.9;
/// A range is divided into so many members at least.
const MEMBERS: f64 = 20.0;
/// Members at most.
const MOST: usize = 600;
/// Trials to find where something happens: the Illinois method takes some ten.
const TRIALS: usize = 60;
/// Scales that differ from how far motions go by more than this factor are chosen anew.
const OTHER: f64 = 2.0;
/// A null direction of the linearised equations is one of structure where it solves them to this part.
const SOLVES: f64 = 1e-5;

/// What varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Varied {
    Parameter(usize),
    Energy,
}

/// A member, and which way the family goes there.
pub(super) struct Node {
    pub solution: Solution,
    spectrum: Spectrum,
    value: f64,
    /// dvalue/ds.
    slope: f64,
    tangent: DVector<f64>,
    scales: Vec<f64>,
}

/// A walk along a family.
pub(super) struct Walk {
    pub begun: Begun,
    pub varied: Varied,
    /// Directions in which nothing changes, along the family included.
    pub nullity: Option<usize>,
}

impl Walk {
    /// The member near a guess, and which way the family goes there: as `before` does, or towards larger values.
    pub fn node(&mut self, guess: Point, before: Option<&DVector<f64>>) -> Result<Node, Error> {
        let laps = &mut self.begun.laps;
        let solution = laps.solve(guess, self.nullity)?;
        let spectrum = spectrum(laps, &solution.trial);
        let free = solution.linear.free().len();
        let mut tangent = self.tangent(&solution, &spectrum, (free, before));
        if let Some(before) = before.filter(|before| tangent.dot(before) < ALONG * before.norm() * tangent.norm()) {
            // Where another family crosses, more than one direction leads on: the one that goes on as before does.
            tangent = self.tangent(&solution, &spectrum, (free + 1, Some(before)));
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
                let side = solution.trial.pieces[0].start.clone();
                crate::vary::put(&mut *laps.system, &side);
                let energy = structure::energy(&*laps.system, &side) - rest;
                let gradients = structure::gradients(&*laps.system, &side);
                let slopes = gradients.iter().find(|known| known.name == structure::ENERGY);
                let slope = slopes.map_or(0.0, |known| {
                    let each = known.direction.iter().zip(&laps.scales).zip(tangent.iter());
                    each.map(|((slope, scale), x)| slope * scale * x).sum()
                });
                (energy, slope)
            }
        }
    }

    /// The member so far along the tangent of another one.
    fn step(&mut self, from: &Node, s: f64) -> Result<Node, Error> {
        self.begun.laps.scales.clone_from(&from.scales);
        let guess = self.begun.laps.moved(&from.solution.point, &from.tangent, s);
        self.node(guess, Some(&from.tangent))
    }

    /// A member with scales of its own motion.
    fn rescaled(&mut self, node: Node) -> Node {
        let laps = &mut self.begun.laps;
        let runs = node.solution.trial.pieces.iter().map(|piece| sizes(&piece.run));
        let mut scales = vec![0.0_f64; laps.scales.len()];
        runs.for_each(|sizes| scales.iter_mut().zip(sizes).for_each(|(scale, size)| *scale = scale.max(size)));
        let alike = |(new, old): (&f64, &f64)| (OTHER.recip()..OTHER).contains(&(new / old));
        if scales.iter().zip(&node.scales).all(alike) {
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

    /// Walks from a member through a range.
    pub fn along(
        &mut self,
        start: Node,
        (name, values, (first, last)): (&str, &[f64], (f64, f64)),
    ) -> Result<(Family, Vec<(Node, OrbitChange)>), Error> {
        let (low, high) = (first.min(last), first.max(last));
        let energy = self.varied == Varied::Energy;
        let inside = |value: f64| value <= high && (energy || value >= low);
        let mut node = start;
        // Towards the other end of the range.
        if node.slope * (last - first) < 0.0 || energy && node.slope < 0.0 {
            node.tangent = -node.tangent;
            node.slope = -node.slope;
        }
        let names = Names::of(self.begun.laps.system.description()).columns();
        let mut family = Family {
            name: name.to_owned(),
            names: names[..2 * self.begun.laps.n()].to_vec(),
            members: vec![self.member(&node, values.contains(&node.value))],
            thresholds: Vec::new(),
            part: lcm(self.begun.laps.closing.order(), self.begun.laps.laps) / self.begun.laps.laps,
            map: self.begun.laps.closing.words(self.begun.laps.system.description()),
            ended: None,
        };
        let mut changes = Vec::new();
        let mut h = FIRST * (node.solution.point.starts.len() as f64).sqrt();
        while family.members.len() < MOST {
            let longest = (high - low) / MEMBERS;
            if node.slope.abs() * h > longest {
                h = longest / node.slope.abs();
            }
            h = h.min(LONGEST * (node.solution.point.starts.len() as f64).sqrt());
            let next = match self.step(&node, h) {
                Ok(next) if next.tangent.dot(&node.tangent) >= ALONG => next,
                outcome => {
                    h *= 0.5;
                    if h < SHORTEST {
                        let why =
                            outcome.err().map_or_else(|| "the family turns sharply".to_owned(), |e| e.to_string());
                        family.ended = Some(why);
                        break;
                    }
                    continue;
                }
            };
            if self.begun.at_rest(&next.solution).is_err() {
                family.ended = Some("the motions shrink to an equilibrium".to_owned());
                break;
            }
            for (found, kind) in self.between(&node, &next, h)? {
                if inside(found.value) {
                    family.thresholds.push(self.threshold(&node, &found, kind));
                    changes.push((found, kind));
                }
            }
            let mut asked: Vec<f64> =
                values.iter().copied().filter(|value| (node.value - value) * (next.value - value) < 0.0).collect();
            asked.sort_by(|a, b| (a - node.value).abs().total_cmp(&(b - node.value).abs()));
            for value in asked {
                let found = self.locate(&node, h, &|node: &Node| node.value - value)?;
                family.members.push(self.member(&found, true));
            }
            let steps = next.solution.steps;
            let ends = !inside(next.value);
            if !ends {
                family.members.push(self.member(&next, values.contains(&next.value)));
            }
            node = self.rescaled(next);
            if ends {
                break;
            }
            h *= if steps <= EASY {
                1.6
            } else if steps >= HARD {
                0.6
            } else {
                1.0
            };
        }
        if family.members.len() >= MOST {
            family.ended = Some(format!("after {MOST} motions"));
        }
        Ok((family, changes))
    }

    /// What happens between two members that lie `h` apart.
    fn between(&mut self, from: &Node, to: &Node, h: f64) -> Result<Vec<(Node, OrbitChange)>, Error> {
        let mut found = Vec::new();
        let changes = |f: &dyn Fn(&Node) -> f64| f(from) * f(to) < 0.0;
        let (turns, ones, minus) = (
            changes(&|node| node.slope),
            changes(&|node| product(&node.spectrum.multipliers, 1.0)),
            changes(&|node| product(&node.spectrum.multipliers, -1.0)),
        );
        if turns {
            found.push((self.locate(from, h, &|node: &Node| node.slope)?, OrbitChange::Fold));
        } else if ones {
            found.push((
                self.locate(from, h, &|node: &Node| product(&node.spectrum.multipliers, 1.0))?,
                OrbitChange::Branch,
            ));
        }
        if minus {
            found.push((
                self.locate(from, h, &|node: &Node| product(&node.spectrum.multipliers, -1.0))?,
                OrbitChange::Doubling,
            ));
        }
        let grows = |node: &Node| pair(&node.spectrum.multipliers);
        if let (Some(a), Some(b)) = (grows(from), grows(to))
            && a * b < 0.0
            && a.abs().max(b.abs()) > CIRCLE
        {
            found.push((self.locate(from, h, &|node: &Node| grows(node).unwrap_or(a))?, OrbitChange::Pair));
        }
        found.sort_by(|(a, _), (b, _)| (a.value - from.value).abs().total_cmp(&(b.value - from.value).abs()));
        Ok(found)
    }

    /// Where a function of the members changes its sign, within `h` of one.
    ///
    /// Source: the Illinois method, Dowell and Jarratt, BIT 11 (1971) 168.
    fn locate(&mut self, from: &Node, h: f64, f: &dyn Fn(&Node) -> f64) -> Result<Node, Error> {
        let (mut a, mut fa) = (0.0, f(from));
        let end = self.step(from, h)?;
        let (mut b, mut fb) = (h, f(&end));
        let mut best = end;
        for _ in 0..TRIALS {
            let s = if fb == fa { 0.5 * (a + b) } else { b - fb * (b - a) / (fb - fa) };
            let node = self.step(from, s)?;
            let value = f(&node);
            best = node;
            if value == 0.0 || (s - b).abs() <= 4.0 * f64::EPSILON * h || (b - a).abs() <= 4.0 * f64::EPSILON * h {
                break;
            }
            if value * fb < 0.0 {
                (a, fa) = (b, fb);
            } else {
                fa *= 0.5;
            }
            let moved = (s - b).abs();
            (b, fb) = (s, value);
            if moved <= CLOSE * h {
                break;
            }
        }
        Ok(best)
    }

    fn member(&self, node: &Node, asked: bool) -> Member {
        let width = node.scales.len();
        let rows = || node.solution.trial.pieces.iter().flat_map(|piece| piece.run.rows.chunks_exact(width));
        let amplitude = |i: usize| {
            let [low, high] = rows()
                .map(|row| row[i])
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
            0.5 * (high - low)
        };
        Member {
            value: node.value,
            period: self.begun.laps.duration(&node.solution.trial),
            start: node.solution.trial.pieces[0].start.y.clone(),
            amplitudes: (0..width).map(amplitude).collect(),
            multipliers: beside(&node.spectrum.multipliers, None),
            asked,
        }
    }

    /// A threshold with its error: what a flow at another tolerance makes of the value, and of where along the family it is.
    fn threshold(&mut self, from: &Node, found: &Node, kind: OrbitChange) -> Threshold {
        let laps = &mut self.begun.laps;
        laps.scales.clone_from(&found.scales);
        let tolerance = laps.settings.tolerance;
        laps.settings.tolerance = LOOSER * tolerance;
        let rough = self.node(found.solution.point.clone(), Some(&found.tangent));
        self.begun.laps.settings.tolerance = tolerance;
        let measure = |node: &Node| match kind {
            OrbitChange::Fold => node.slope,
            OrbitChange::Branch => product(&node.spectrum.multipliers, 1.0),
            OrbitChange::Doubling => product(&node.spectrum.multipliers, -1.0),
            OrbitChange::Pair => pair(&node.spectrum.multipliers).unwrap_or(0.0),
        };
        let along = (measure(found) - measure(from)) / (found.value - from.value);
        let error = rough.map_or(f64::NAN, |rough| {
            let by_value = (rough.value - found.value).abs();
            let by_place =
                if kind == OrbitChange::Fold { 0.0 } else { ((measure(&rough) - measure(found)) / along).abs() };
            by_value + by_place
        });
        Threshold { kind, value: found.value, error, member: self.member(found, false) }
    }

    /// The first member of the family that leaves at a threshold.
    pub fn switch(&mut self, node: &Node, kind: OrbitChange) -> Result<Node, Error> {
        let laps = &mut self.begun.laps;
        laps.scales.clone_from(&node.scales);
        let sign = if kind == OrbitChange::Doubling { -1.0 } else { 1.0 };
        let count = node.solution.trial.pieces.len();
        let maps: Vec<DMatrix<f64>> = (0..count).map(|k| map(laps, &node.solution.trial, k)).collect();
        let basis = &node.spectrum.basis;
        let whole = maps.iter().fold(DMatrix::identity(basis.nrows(), basis.nrows()), |all, map| map * all);
        let inside = basis.transpose() * whole * basis - DMatrix::identity(basis.ncols(), basis.ncols()) * sign;
        let svd = inside.svd(false, true);
        let Some(vt) = svd.v_t.filter(|vt| vt.nrows() > 0) else {
            return Err(NoOrbit::NoFamily { name: kind.word().to_owned() }.into());
        };
        let least = svd.singular_values.imin();
        let mut direction = basis * vt.row(least).transpose();
        let mut parts = Vec::with_capacity(count);
        for map in &maps {
            parts.push(direction.clone());
            direction = map * direction;
        }
        let mut point = node.solution.point.clone();
        if kind == OrbitChange::Doubling {
            laps.laps *= 2;
            point.starts.extend(node.solution.point.starts.clone());
            parts.extend(parts.clone().into_iter().map(|part| -part));
        }
        let size = laps.unknowns();
        let all = parts.iter().flat_map(|part| part.iter().copied());
        let tail = std::iter::repeat(0.0);
        let along = DVector::from_iterator(size, all.chain(tail).take(size)).normalize();
        let step = FIRST * (point.starts.len() as f64).sqrt();
        let guess = laps.moved(&point, &along, step);
        // So far away the family that is left is no solution, and the parameter, or the energy, is what it must be.
        laps.condition = Some(Condition::Away { from: point, along: along.clone(), by: step });
        let found = laps.solve(guess, self.nullity.map(|count| count.saturating_sub(1)));
        laps.condition = None;
        self.node(found?.point, Some(&along))
    }
}

/// Pairs whose logarithms are less than this are on the unit circle.
const CIRCLE: f64 = 1e-7;
/// A place along a family is found where two trials are no farther apart than this part of the step.
const CLOSE: f64 = 1e-13;

/// Re Π (μ − x) over all multipliers.
fn product(multipliers: &[Polar], x: f64) -> f64 {
    let each = multipliers.iter().map(|polar| Complex::from_polar(polar.log.exp(), polar.angle) - x);
    each.fold(Complex::new(1.0, 0.0), |all, factor| all * factor).re
}

/// ln |μ| of the largest pair that is not real.
fn pair(multipliers: &[Polar]) -> Option<f64> {
    multipliers.iter().filter(|polar| polar.angle.sin().abs() > CIRCLE).map(|polar| polar.log).max_by(f64::total_cmp)
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
