//! Where a motion passes discontinuities: every combination of sides that it takes.
//!
//! What acts in one place for a while only is beyond several arguments at once.  No line that changes one number finds
//! such a spot; the motion passes through it.

use std::collections::BTreeSet;

use super::arguments::Argument;
use super::lines::{Line, moved};
use super::motion::Motion;
use super::near_switch::Sides;
use super::search::{bisect, polished};
use super::state::State;

/// So many combinations are kept.
const COMBINATIONS: usize = 48;

/// So many states of a motion are looked at, if need be between its steps, and so many in one step at most.
const LOOKS: usize = 400;
const IN_A_STEP: usize = 8;

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
    if switches.is_empty() {
        return;
    }
    let path = &finer(motion, path);
    let Some(start) = path.first() else { return };
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

/// A motion with more states: a narrow region is entered and left again within a coarse step.
fn finer(motion: &Motion, path: &[State]) -> Vec<State> {
    let parts = (LOOKS / path.len().max(1)).clamp(1, IN_A_STEP);
    let mut states: Vec<State> = path.iter().take(1).cloned().collect();
    for pair in path.windows(2) {
        let places = (1..parts).map(|k| k as f64 / parts as f64);
        states.extend(places.map(|z| moved(motion, &pair[0], &Line::Step(&pair[1]), z.into())));
        states.push(pair[1].clone());
    }
    states
}

#[cfg(test)]
mod tests {
    use super::super::arguments::arguments;
    use super::*;
    use crate::derive::{Derivation, derive};
    use crate::model::load;

    /// A strip that one step enters and leaves again, so that both of its ends are outside.
    #[test]
    fn a_strip_within_a_step_is_passed() {
        let text = "
name: Strip
parameters: {m: 1 kg, F: 1 N}
coordinates: {x: }
bodies: {bead: {mass: m, position: \"[x, 0]\"}}
forces: {strip: {on: bead, force: \"[F*step(0.01 - (x - 0.5)^2), 0]\"}}
scene: {start: {x: 0, x': 1}, until: 1}
";
        let mut derivation = derive(load(text, &[]).expect("a good file")).expect("derives");
        let Derivation { model, equations, rows, switches, .. } = &mut derivation;
        let motion = Motion::new(model, (&equations[0], None), rows, switches);
        let (all, _) = arguments(model);
        let switches: Vec<&Argument> = all.iter().filter(|a| a.switches).collect();
        assert_eq!(switches.len(), 1);
        let path = [0.0, 1.0].map(|x| {
            let mut state = State::at_rest(vec![1.0, 1.0], 1);
            (state.t, state.q[0], state.v[0]) = (x.into(), x.into(), 1.0.into());
            motion.prepare(&mut state);
            state
        });
        let mut found = Sides { states: Vec::new(), surfaces: Vec::new(), unreached: Vec::new() };
        passages(&motion, &switches, &path, &mut BTreeSet::new(), &mut found);
        let inside = |state: &State| (state.q[0].to_f64() - 0.5).abs() < 0.1;
        assert!(found.states.iter().any(inside), "{} states, none in the strip", found.states.len());
        assert!(found.surfaces.iter().any(|state| ((state.q[0].to_f64() - 0.5).abs() - 0.1).abs() < 1e-12));
    }
}
