//! Where several discontinuities meet: combinations of sides that no state before has.
//!
//! What acts within a strip of one coordinate and of another, or within a strip and for a while, is beyond several
//! arguments at once.  From a state whose sides are known one number at a time is changed: between any two places where
//! some argument changes its sign along such a line lies a cell, from which the search goes on, breadth first.  What several
//! numbers must change together for is looked for by scattered states.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::along_motion::signs;
use super::arguments::Argument;
use super::lines::{Line, Reach, grid, moved};
use super::motion::Motion;
use super::near_switch::Sides;
use super::search::bisect;
use super::state::{Origin, State};
use crate::expr::Symbol;
use crate::number::DoubleDouble;
use crate::random::Random;

/// So many combinations are kept at the most.
const CELLS: usize = 96;
/// Operations that the search may cost.
const WORK: usize = 1_000_000;
/// Operations, in their time, that it takes to make one state.
const STATE: usize = 20;
/// So many states are scattered, of which so many are kept.
const SCATTERED: usize = 500;
const KEPT: usize = 32;
/// From this part of what a number goes through to so many times that, evenly in powers of ten.
const SIZES: (f64, f64) = (-1.5, 1.5);

/// Keeps a state of every combination that lines through the bases, and through what they meet, lead to.
pub(super) fn cells(
    motion: &Motion,
    switches: &[&Argument],
    bases: &[State],
    reach: &Reach<'_>,
    seen: &mut BTreeSet<Vec<bool>>,
    found: &mut Sides,
) {
    if switches.len() < 2 {
        return;
    }
    let symbols: BTreeSet<Symbol> = switches.iter().flat_map(|argument| argument.symbols.iter().copied()).collect();
    let symbols: Vec<Symbol> = symbols.into_iter().collect();
    // Where an argument depends on one number alone, its zeros stay where they are while others change.
    let alone: BTreeSet<Symbol> = symbols.iter().copied().filter(|symbol| is_alone(switches, *symbol)).collect();
    let cost: usize = switches.iter().map(|argument| 2 * argument.operations(motion)).sum();
    let mut left = WORK / (cost + STATE);
    let mut kept = 0;
    for base in bases {
        let mut known: BTreeMap<Symbol, Vec<f64>> = BTreeMap::new();
        let mut queue = VecDeque::from([base.clone()]);
        // What another base has seen may be on the way here to what it has not.
        let mut passed = BTreeSet::new();
        while let Some(from) = queue.pop_front() {
            for symbol in &symbols {
                let Some(line) = reach.lines(&[*symbol]).into_iter().next() else { continue };
                if kept >= CELLS || left == 0 {
                    found.unreached.push(format!(
                        "some combinations of the sides of {} discontinuities were not looked for",
                        switches.len()
                    ));
                    return;
                }
                let places = match known.get(symbol) {
                    Some(places) => places.clone(),
                    None => places(motion, switches, &from, &line, &mut left),
                };
                for z in between(&places, 0.1 * line.scale()) {
                    let state = moved(motion, &from, &line, DoubleDouble::from(z));
                    let sides = signs(motion, switches, &state);
                    if !passed.insert(sides.clone()) {
                        continue;
                    }
                    if seen.insert(sides) {
                        kept += 1;
                        found.states.push(state.clone());
                    }
                    queue.push_back(state);
                }
                if alone.contains(symbol) {
                    known.insert(*symbol, places);
                }
            }
        }
    }
}

/// Keeps states of combinations that no line leads to, because several numbers must change together: wedges between slanted
/// discontinuities.  Numbers of all sizes and of both signs are put in the places of those on which the arguments depend.
pub(super) fn scattered(
    motion: &Motion,
    switches: &[&Argument],
    bases: &[State],
    reach: &Reach<'_>,
    seen: &mut BTreeSet<Vec<bool>>,
    found: &mut Sides,
) {
    // Constraints would bring them all back to where they are.
    let free = |base: &&State| motion.constraints.active(base.phase).is_empty();
    let bases: Vec<&State> = bases.iter().filter(free).collect();
    let several = |argument: &&&Argument| argument.symbols.len() > 1;
    if bases.is_empty() || switches.len() < 2 || switches.iter().filter(several).count() == 0 {
        return;
    }
    let symbols: BTreeSet<Symbol> = switches.iter().flat_map(|argument| argument.symbols.iter().copied()).collect();
    let symbols: Vec<Symbol> = symbols.into_iter().collect();
    let cost: usize = switches.iter().map(|argument| argument.operations(motion)).sum();
    let (mut random, mut kept) = (Random::new(), 0);
    for k in 0..SCATTERED.min(WORK / (cost + STATE)) {
        let mut state = bases[k % bases.len()].clone();
        for line in symbols.iter().flat_map(|symbol| reach.lines(&[*symbol])) {
            let size = 10_f64.powf(random.between(SIZES.0, SIZES.1));
            let number = DoubleDouble::from(line.scale() * size.copysign(random.between(-1.0, 1.0)));
            match line {
                Line::Time(until) => state.t = DoubleDouble::from(random.between(0.0, until)),
                Line::Coordinate(i, _) => state.q[i] = number,
                Line::Speed(i, _) => state.v[i] = number,
                Line::Between(_) | Line::Step(_) | Line::Path(_) => {}
            }
        }
        motion.signals(&mut state);
        state.origin = Origin::Side;
        if kept < KEPT && seen.insert(signs(motion, switches, &state)) {
            kept += 1;
            found.states.push(state);
        }
    }
}

/// Whether every argument that depends on a number depends on it alone.
fn is_alone(switches: &[&Argument], symbol: Symbol) -> bool {
    switches.iter().all(|argument| !argument.symbols.contains(&symbol) || argument.symbols.len() == 1)
}

/// Where some argument changes its sign along a line, in order.
fn places(motion: &Motion, switches: &[&Argument], base: &State, line: &Line<'_>, left: &mut usize) -> Vec<f64> {
    let at = |z: f64| moved(motion, base, line, DoubleDouble::from(z));
    let samples: Vec<(f64, Vec<bool>)> =
        grid(base, line).into_iter().map(|z| (z, signs(motion, switches, &at(z)))).collect();
    *left = left.saturating_sub(samples.len());
    let mut places = Vec::new();
    for pair in samples.windows(2) {
        for k in (0..switches.len()).filter(|k| pair[0].1[*k] != pair[1].1[*k]) {
            *left = left.saturating_sub(60);
            places.push(bisect(&|z| switches[k].at(motion, &at(z)), (pair[0].0, pair[1].0)));
        }
    }
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
}

/// A place in each cell between these, not farther beyond one than need be: the middle of a wide cell may be out of all
/// measure.
fn between(places: &[f64], far: f64) -> Vec<f64> {
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return Vec::new() };
    let inner = places.windows(2).map(|pair| pair[0] + (0.5 * (pair[1] - pair[0])).min(far));
    [first - far].into_iter().chain(inner).chain([last + far]).collect()
}
