//! Where a motion passes discontinuities: every combination of sides that it takes.
//!
//! What acts in one place for a while only is beyond several arguments at once.  No line that changes one number finds
//! such a spot; the motion passes through it.

use std::collections::BTreeSet;

use super::arguments::Argument;
use super::lines::{Line, moved};
use super::motion::Motion;
use super::search::{bisect, polished};
use super::sides::Sides;
use super::state::State;

/// So many combinations are kept.
const COMBINATIONS: usize = 48;

/// On which side of each discontinuity a state lies, then which parameters are 0: what they multiply is silent there.
pub(super) fn signs(motion: &Motion, switches: &[&Argument], state: &State) -> Vec<bool> {
    let sides = switches.iter().map(|argument| argument.at(motion, state) > 0.0);
    sides.chain(state.parameters.iter().map(|p| *p == 0.0)).collect()
}

/// Follows a motion step by step, and keeps a state for each combination of sides that no state before it has, with the
/// place where that combination begins.
pub(super) fn passages(
    motion: &Motion,
    switches: &[&Argument],
    path: &[State],
    seen: &mut BTreeSet<Vec<bool>>,
    found: &mut Sides,
) {
    let Some(start) = path.first().filter(|_| !switches.is_empty()) else { return };
    // Starts and ends of steps may lie on a discontinuity: states are taken between.
    let mut before = signs(motion, switches, start);
    for pair in path.windows(2) {
        let after = signs(motion, switches, &pair[1]);
        let line = Line::Step(&pair[1]);
        if after == before {
            if !seen.contains(&after) {
                let state = moved(motion, &pair[0], &line, 0.5.into());
                seen.insert(signs(motion, switches, &state));
                found.states.push(state);
            }
            continue;
        }
        let mut places = Vec::new();
        for k in (0..switches.len()).filter(|k| after[*k] != before[*k]) {
            let value = |z: f64| switches[k].at(motion, &moved(motion, &pair[0], &line, z.into()));
            places.push((bisect(&value, (0.0, 1.0)), k));
        }
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (i, &(z, k)) in places.iter().enumerate() {
            let next = places.get(i + 1).map_or(1.0, |place| place.0);
            let state = moved(motion, &pair[0], &line, (0.5 * (z + next)).into());
            if seen.len() < COMBINATIONS && seen.insert(signs(motion, switches, &state)) {
                found.states.push(state);
                let surface = polished(motion, switches[k], &pair[0], &line, z);
                found.surfaces.push(moved(motion, &pair[0], &line, surface));
            }
        }
        before = after;
    }
}
