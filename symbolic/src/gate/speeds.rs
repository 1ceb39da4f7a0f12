//! States near features in which something rests, with speeds of their own: what resists motion is silent at rest.

use super::arguments::Argument;
use super::lines::Reach;
use super::motion::Motion;
use super::near_switch::{ORDER_ONE, Sides};
use super::state::{Origin, State};
use crate::expr::Symbol;
use crate::number::DoubleDouble;
use crate::random::Random;

/// The least size of a drawn speed, in parts of the largest scale of the coordinate's speed.
const LEAST: f64 = 0.2;
/// So often speeds are drawn until the file vouches for the state (`sample`).
const DRAWS: usize = 8;

/// Gives each state that was found at rest, or on a scene's motion, speeds of its own.  They take the state's place
/// where no argument depends on them and it keeps its features; otherwise they are a further state.
pub(super) fn move_all(motion: &Motion, arguments: &[Argument], reach: &Reach<'_>, found: &mut Sides) {
    let mut random = Random::new();
    let mut further = Vec::new();
    for state in &mut found.states {
        let rests = state.v.contains(&DoubleDouble::ZERO);
        if !rests && state.origin != Origin::Motion {
            continue;
        }
        let drawn = (0..DRAWS).map(|_| moving(motion, arguments, reach, state, &mut random));
        let Some(moving) = drawn.into_iter().find(|moving| (reach.inside)(moving)) else { continue };
        if rests && features(motion, arguments, &moving) == features(motion, arguments, state) {
            *state = moving;
        } else {
            further.push(moving);
        }
    }
    found.states.extend(further);
}

/// The state with other speeds, as far as constraints allow them: those that rest, and those on which no argument depends.
fn moving(motion: &Motion, arguments: &[Argument], reach: &Reach<'_>, state: &State, random: &mut Random) -> State {
    let mut moving = state.clone();
    for i in 0..moving.v.len() {
        let asked = |argument: &Argument| argument.symbols.contains(&Symbol::Speed(i as u32));
        if moving.v[i] == DoubleDouble::ZERO || !arguments.iter().any(asked) {
            let size = random.between(LEAST, 1.0).copysign(random.between(-1.0, 1.0));
            moving.v[i] = DoubleDouble::from((reach.of)(i, true) * size);
        }
    }
    motion.close(&mut moving);
    moving.origin = Origin::Side;
    moving
}

/// On which side of each discontinuity a state lies, and which local functions say something there.
fn features(motion: &Motion, arguments: &[Argument], state: &State) -> Vec<bool> {
    let feature = |argument: &Argument| {
        let at = argument.at(motion, state);
        if argument.switches { at > 0.0 } else { at.abs() <= ORDER_ONE }
    };
    arguments.iter().map(feature).collect()
}
