//! Where several discontinuities meet: combinations of sides that no state before has.
//!
//! What acts within a strip of one coordinate and of another, or within a strip and for a while, is beyond several
//! arguments at once.  From a state whose sides are known one number at a time is changed: between any two places where
//! some argument changes its sign along such a line lies a cell, from which the search goes on, breadth first.

use std::collections::{BTreeSet, VecDeque};

use super::arguments::Argument;
use super::lines::{Line, Reach, grid, moved};
use super::motion::Motion;
use super::passage::signs;
use super::search::bisect;
use super::sides::Sides;
use super::state::State;
use crate::expr::Symbol;
use crate::number::DoubleDouble;

/// So many combinations are kept at the most.
const CELLS: usize = 64;
/// Operations that the search may cost.
const WORK: usize = 400_000;
/// Operations, in their time, that it takes to make one state.
const STATE: usize = 20;

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
    let cost: usize = switches.iter().map(|argument| 2 * argument.tape.operations()).sum();
    let mut left = WORK / (cost + STATE);
    let mut queue: VecDeque<State> = bases.iter().cloned().collect();
    let mut kept = 0;
    while let Some(base) = queue.pop_front() {
        for line in reach.lines(&symbols) {
            if kept >= CELLS || left == 0 {
                found.unreached.push("some combinations of the sides of discontinuities".to_owned());
                return;
            }
            for state in across(motion, switches, &base, &line, &mut left) {
                if seen.insert(signs(switches, &state)) {
                    kept += 1;
                    found.states.push(state.clone());
                    queue.push_back(state);
                }
            }
        }
    }
}

/// A state of each cell through which a line leads.
fn across(motion: &Motion, switches: &[&Argument], base: &State, line: &Line<'_>, left: &mut usize) -> Vec<State> {
    let at = |z: f64| moved(motion, base, line, DoubleDouble::from(z));
    let samples: Vec<(f64, Vec<bool>)> = grid(base, line).into_iter().map(|z| (z, signs(switches, &at(z)))).collect();
    *left = left.saturating_sub(samples.len());
    let mut places = Vec::new();
    for pair in samples.windows(2) {
        for k in (0..switches.len()).filter(|k| pair[0].1[*k] != pair[1].1[*k]) {
            *left = left.saturating_sub(60);
            places.push(bisect(&|z| switches[k].at(&at(z)), (pair[0].0, pair[1].0)));
        }
    }
    places.sort_by(f64::total_cmp);
    places.dedup();
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return Vec::new() };
    // Not farther beyond a place than need be: the middle of a wide cell may be out of all measure.
    let far = 0.1 * line.scale();
    let before = first - far;
    let between = places.windows(2).map(|pair| pair[0] + (0.5 * (pair[1] - pair[0])).min(far));
    [before].into_iter().chain(between).chain([last + far]).map(at).collect()
}
