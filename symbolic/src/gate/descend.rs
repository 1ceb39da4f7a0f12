//! Spots that no line through a state meets, because several numbers must be right at once.
//!
//! `max(0, d - abs(x - a) - abs(theta - b))` says something only where x is near a *and* theta near b: its argument is
//! brought towards zero by one number after the other.

use super::motion::Motion;
use super::sides::{Argument, Line, Sides, follow, lines, moved, samples};
use super::state::State;

/// From so many states the search begins.
const STARTS: usize = 3;
/// So often it goes through all numbers.
const ROUNDS: usize = 3;

/// Looks for states where an argument vanishes or is of order one, by descending along one line after the other.
pub(super) fn descend(
    motion: &Motion,
    (argument, switches): (&Argument, &[&Argument]),
    bases: &[State],
    (until, reach): (f64, &dyn Fn(usize, bool) -> f64),
    found: &mut Sides,
) {
    let before = found.states.len();
    for start in bases.iter().take(STARTS) {
        let mut base = start.clone();
        for _ in 0..ROUNDS {
            let ways = lines(argument, std::slice::from_ref(&base), 0, until, reach);
            let ways: Vec<Line<'_>> = ways.into_iter().filter(|line| !matches!(line, Line::Between(_))).collect();
            let mut here = base.clone();
            for line in &ways {
                follow(motion, (argument, switches), &here, line, found);
                if found.states.len() > before {
                    return;
                }
                let at = |z: f64| argument.at(&moved(motion, &here, line, z.into()));
                let least = samples(&here, line, &at).into_iter().min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
                if let Some((z, _)) = least {
                    here = moved(motion, &here, line, z.into());
                }
            }
            base = here;
        }
    }
}
