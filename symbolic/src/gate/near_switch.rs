//! States where the argument of a function is zero, next to it, or of order one.
//!
//! `step`, `sign`, `abs`, `min` and `max` change at the zero of an argument; `exp`, `tanh`, `atan` and their like, roots
//! and powers say something only where theirs is of order one, which may be a narrow band that no random state meets.
//! Arguments are followed along lines (time, one coordinate, one speed, the way between two states, a whole motion) and
//! solved for; where several meet is found in `along_motion`, `combinations`, `narrow_pairs` and
//! `narrow_products`, and between the points of tables in `between_knots`; what rests there is moved in `speeds`.

use std::collections::BTreeSet;

use super::along_motion::{passages, signs};
use super::arguments::{ARGUMENTS, Argument, arguments, tables};
use super::between_knots::points;
use super::combinations::{cells, scattered};
use super::lines::{Line, Reach, grid, moved};
use super::motion::Motion;
use super::narrow_pairs::pairs;
use super::narrow_products::products;
use super::search::{bisect, extrema, least, local_targets, polished};
use super::speeds::move_all;
use super::state::State;
use crate::model::Model;
use crate::number::DoubleDouble;

/// So many lines are followed for each.
const LINES: usize = 8;
/// So many states are kept for each.
const KEPT: usize = 8;
/// Where the argument of a function that is local through it is no larger, the function says something.
pub(super) const ORDER_ONE: f64 = 2.0;

/// What was found.
pub(super) struct Sides {
    /// States, without their motion.
    pub states: Vec<State>,
    /// States at which the argument of a switch vanishes.
    pub surfaces: Vec<State>,
    /// What was not reached, in words.
    pub unreached: Vec<String>,
}

/// Looks for such states where the motion itself meets a discontinuity, and along lines through `bases` and between
/// them; `paths` are the steps of each scene's motion.
pub(super) fn sides(
    model: &Model,
    motion: &Motion,
    (bases, paths): (&[State], &[&[State]]),
    reach: &Reach<'_>,
) -> Sides {
    let (arguments, more) = arguments(model);
    let switches: Vec<&Argument> = arguments.iter().filter(|a| a.switches).collect();
    let mut found = Sides { states: Vec::new(), surfaces: Vec::new(), unreached: Vec::new() };
    let mut combinations = BTreeSet::new();
    paths.iter().for_each(|path| passages(motion, &switches, path, &mut combinations, &mut found));
    cells(motion, &switches, bases, reach, &mut combinations, &mut found);
    scattered(motion, &switches, bases, reach, &mut combinations, &mut found);
    for argument in &arguments {
        let before = found.states.len();
        let search = Search { motion, argument, switches: &switches };
        for path in paths.iter().filter(|path| !argument.switches && path.len() > 1) {
            search.follow(&path[0], &Line::Path(path), &mut found);
        }
        if let Some(base) = bases.first().filter(|base| search.is_held(base, reach)) {
            found.states.push(base.clone());
            continue;
        }
        let mut followed = 0;
        let on_the_way = found.states.len();
        for (k, base) in bases.iter().enumerate() {
            let mut lines: Vec<Line<'_>> = reach.lines(&argument.symbols).into_iter().take(3).collect();
            let next = bases.get(k + 1).filter(|next| next.parameters == base.parameters);
            lines.extend(next.map(Line::Between));
            for line in lines {
                if followed >= LINES || found.states.len() >= on_the_way + KEPT {
                    break;
                }
                followed += 1;
                search.follow(base, &line, &mut found);
            }
        }
        let order_one = |state: &State| argument.at(motion, state).abs() <= ORDER_ONE;
        let met = (0..switches.len()).any(|k| std::ptr::eq(switches[k], argument) && both_sides(&combinations, k));
        // Spots that no line through a state meets, because several numbers must be right at once.
        let silent = match argument.switches {
            true => found.states.len() == before && !met,
            false => !found.states[before..].iter().any(order_one),
        };
        if let Some(base) = bases.last().filter(|_| silent) {
            let least = search.descended(base, reach);
            let lines = reach.lines(&argument.symbols);
            lines.iter().take(3).for_each(|line| search.follow(&least, line, &mut found));
            if !argument.switches {
                found.states.push(least);
            }
        }
        if found.states.len() == before && !met {
            let words = &argument.words;
            found.unreached.push(format!("no state was found at which `{words}` is zero or of order one"));
        }
    }
    let tables = tables(model);
    points(motion, &tables, (bases, paths), reach, &mut found);
    pairs(motion, (&arguments, &tables), reach, &mut found);
    products(model, motion, bases, reach, &mut found);
    move_all(motion, &arguments, reach, &mut found);
    if more > 0 {
        found.unreached.push(format!("{more} more arguments of functions were not looked at"));
    }
    found
}

/// Whether a motion was on both sides of a discontinuity.
fn both_sides(combinations: &BTreeSet<Vec<bool>>, k: usize) -> bool {
    [true, false].iter().all(|side| combinations.iter().any(|c| c.get(k) == Some(side)))
}

/// One argument, among those at which something changes.
struct Search<'a> {
    motion: &'a Motion,
    argument: &'a Argument,
    switches: &'a [&'a Argument],
}

impl Search<'_> {
    /// Whether constraints keep the argument constant, so that there is nothing to look for.
    fn is_held(&self, base: &State, reach: &Reach<'_>) -> bool {
        let lines = reach.lines(&self.argument.symbols);
        let along = |line: &Line<'_>| {
            let at = |z: f64| self.argument.at(self.motion, &moved(self.motion, base, line, DoubleDouble::from(z)));
            let places = grid(base, line).into_iter().step_by(4);
            is_constant(&places.map(|z| (z, at(z))).filter(|s| s.1.is_finite()).collect::<Vec<_>>())
        };
        !self.motion.constraints.active(base.phase).is_empty() && !lines.is_empty() && lines.iter().all(along)
    }

    /// Follows one argument along one line.
    fn follow(&self, base: &State, line: &Line<'_>, found: &mut Sides) {
        let Search { motion, argument, switches } = *self;
        let at = |z: f64| argument.at(motion, &moved(motion, base, line, DoubleDouble::from(z)));
        let samples = sampled(base, line, &at);
        let mut places: Vec<f64> = Vec::new();
        let targets: Vec<f64> = match argument.switches {
            true => vec![0.0],
            false => local_targets(&samples),
        };
        for target in &targets {
            let crossings = samples.windows(2).filter(|w| (w[0].1 - target) * (w[1].1 - target) < 0.0);
            let exact = samples.iter().filter(|s| s.1 == *target).map(|s| (s.0, s.0));
            let brackets: Vec<(f64, f64)> = crossings.map(|w| (w[0].0, w[1].0)).chain(exact).collect();
            // The first, the last and one between.
            let chosen: BTreeSet<usize> = [0, brackets.len() / 2, brackets.len().wrapping_sub(1)].into();
            for k in chosen.into_iter().filter(|k| *k < brackets.len()) {
                places.push(bisect(&|z| at(z) - target, brackets[k]));
            }
        }
        places.sort_by(f64::total_cmp);
        places.dedup();
        for (k, &z) in places.iter().enumerate() {
            if found.states.len() >= 4 * ARGUMENTS {
                return;
            }
            if !argument.switches {
                found.states.push(moved(motion, base, line, DoubleDouble::from(z)));
                continue;
            }
            let room = |other: Option<&f64>| other.map_or(f64::INFINITY, |other| (other - z).abs());
            let near = room(places.get(k + 1)).min(if k > 0 { room(places.get(k - 1)) } else { f64::INFINITY });
            let scale = line.scale();
            for side in [-1.0, 1.0] {
                let beside = |aside: f64| moved(motion, base, line, DoubleDouble::from(z + side * aside));
                // A strip ends where another argument changes: not beyond it.
                let first = signs(motion, switches, &beside(1e-9 * scale));
                let mut aside = (1e-3 * scale).min(0.25 * near);
                while aside > 4e-9 * scale && signs(motion, switches, &beside(aside)) != first {
                    aside *= 0.25;
                }
                found.states.push(beside(aside));
            }
            found.surfaces.push(moved(motion, base, line, polished(motion, argument, base, line, z)));
        }
    }

    /// Where the argument is least in size, sought along one line after the other.
    fn descended(&self, base: &State, reach: &Reach<'_>) -> State {
        let mut state = base.clone();
        for line in reach.lines(&self.argument.symbols).iter().take(6) {
            let at = |z: f64| self.argument.at(self.motion, &moved(self.motion, &state, line, DoubleDouble::from(z)));
            let samples: Vec<(f64, f64)> = grid(&state, line).into_iter().map(|z| (z, at(z))).collect();
            if is_constant(&samples) {
                continue;
            }
            if let Some((z, _)) = least(&samples, &at) {
                state = moved(self.motion, &state, line, DoubleDouble::from(z));
            }
        }
        state
    }
}

/// Finite values along a line, in order, extrema among them; of a whole motion, of which there are many steps, the least.
pub(super) fn sampled(base: &State, line: &Line<'_>, at: &dyn Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let mut samples: Vec<(f64, f64)> = grid(base, line).into_iter().map(|z| (z, at(z))).collect();
    samples.retain(|s| s.1.is_finite());
    if is_constant(&samples) {
        return samples;
    }
    let more = match line {
        Line::Path(_) => least(&samples, at).into_iter().collect(),
        _ => extrema(&samples, at),
    };
    for (z, value) in more {
        let place = samples.partition_point(|s| s.0 < z);
        samples.insert(place, (z, value));
    }
    samples
}

/// Whether an argument does not change along a line, but for rounding: constraints keep many a length constant.
fn is_constant(samples: &[(f64, f64)]) -> bool {
    let values = || samples.iter().map(|s| s.1);
    let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    high - low <= 1e-12 * low.abs().max(high.abs())
}
