//! States at which two functions say something at once: a product of narrow ones (`exp`, `tanh`, tables) is silent wherever
//! only one of them speaks.

use super::arguments::{Argument, Points};
use super::between_knots::loudest;
use super::lines::{Line, Reach, moved};
use super::motion::Motion;
use super::near_switch::{ORDER_ONE, Sides, sampled};
use super::search::local_targets;
use super::state::State;
use crate::number::DoubleDouble;

/// So many states are added at the most, and so many for each two functions.
const PAIRS: usize = 64;
const OF_TWO: usize = 2;
/// Operations that the search may cost, with so many looks along each line, and what it takes to make a state.
const WORK: usize = 2_000_000;
const LOOKS: usize = 200;
const STATE: usize = 20;

/// Looks from states where one function says something for such where another does too, along numbers on which the first does
/// not depend.
pub(super) fn pairs(
    motion: &Motion,
    (arguments, tables): (&[Argument], &[Points]),
    reach: &Reach<'_>,
    found: &mut Sides,
) {
    let spoken = |argument: &Argument, state: &State, targets: &[(f64, f64)]| {
        let at = argument.at(motion, state);
        targets.iter().any(|(value, near)| (at - value).abs() <= *near)
    };
    let local = arguments.iter().filter(|argument| argument.fades);
    let local = local.map(|argument| (argument, vec![(0.0, ORDER_ONE)]));
    let of_tables = tables.iter().map(|Points { table, argument }| (argument, loudest(*table)));
    let speakers: Vec<(&Argument, Vec<(f64, f64)>)> = local.chain(of_tables).collect();
    let (mut kept, mut left) = (0, WORK);
    for (k, (first, of_first)) in speakers.iter().enumerate() {
        let Some(base) = found.states.iter().find(|state| spoken(first, state, of_first)).cloned() else { continue };
        for (second, of_second) in speakers.iter().enumerate().filter(|(other, _)| *other != k).map(|(_, other)| other)
        {
            if spoken(second, &base, of_second) {
                continue;
            }
            let free: Vec<_> = second.symbols.iter().filter(|s| !first.symbols.contains(s)).copied().collect();
            let mut of_two = 0;
            for line in reach.lines(&free) {
                if kept >= PAIRS || left == 0 {
                    found.unreached.push(format!("some of {} functions were not looked at two by two", speakers.len()));
                    return;
                }
                left = left.saturating_sub(LOOKS * (second.operations(motion) + STATE));
                let at = |z: f64| second.at(motion, &moved(motion, &base, &line, DoubleDouble::from(z)));
                for z in places(&base, &line, &at, of_second) {
                    let state = moved(motion, &base, &line, DoubleDouble::from(z));
                    if of_two < OF_TWO && spoken(first, &state, of_first) && spoken(second, &state, of_second) {
                        (of_two, kept) = (of_two + 1, kept + 1);
                        found.states.push(state);
                    }
                }
            }
        }
    }
}

/// Where along a line a function comes to what is wanted of it.
fn places(base: &State, line: &Line<'_>, at: &dyn Fn(f64) -> f64, wanted: &[(f64, f64)]) -> Vec<f64> {
    let samples = sampled(base, line, at);
    let targets = match wanted {
        [(0.0, _)] => local_targets(&samples),
        _ => wanted.iter().map(|target| target.0).collect(),
    };
    let passed = |target: f64| {
        let pair = samples.windows(2).find(|w| (w[0].1 - target) * (w[1].1 - target) < 0.0)?;
        Some(super::search::bisect(&|z| at(z) - target, (pair[0].0, pair[1].0)))
    };
    targets.into_iter().filter_map(passed).collect()
}
