//! Small motions of mechanisms with constraints.
//!
//! 1. At rest, and in steady motions, with holonomic constraints, or such as have known integrals, M, C and K in independent
//!    coordinates: look in `rest.rs`; what can go on steadily, and how fast: in `steady.rs`.
//! 2. With other constraints that contain speeds, and with friction made of reactions, a system of first order on the states
//!    that the constraints leave: look in `tangent.rs`.  There motions that turn as a whole are steady, too: look in `turns.rs`.
//!
//! What drives the first, and what answers, reactions too: look in `driven.rs`.
//!
//! With states of first order or held values besides: `held.rs`, for the search in `equilibrium/candidate.rs`.
//!
//! While a parameter changes: `balance.rs` of the first, `departing.rs` of the second.  The matrices of all at a state, and
//! whether it stays: `state.rs`.

mod balance;
#[cfg(feature = "modal")]
mod departing;
mod driven;
#[cfg(feature = "modal")]
mod held;
#[cfg(feature = "modal")]
mod relative;
mod rest;
#[cfg(feature = "modal")]
mod slow;
mod state;
mod steady;
#[cfg(feature = "modal")]
mod tangent;
#[cfg(feature = "modal")]
mod turns;

use super::equilibrium::LinearisationPoint;
use super::{Guess, LinearError};
use crate::constrain::slides_in_space;
use crate::mechanism::System;

pub(super) use balance::balance;
#[cfg(feature = "modal")]
pub(super) use held::{Held, Inputs};
#[cfg(all(feature = "modal", feature = "cli"))]
pub(crate) use relative::turns_as_a_whole;
pub use rest::{Constrained, linearise_constrained, linearise_driven};
#[cfg(feature = "cli")]
pub(crate) use steady::lone_steady_coordinates;
pub use steady::steady_coordinates;
#[cfg(feature = "modal")]
pub use steady::turning_coordinates;
#[cfg(feature = "modal")]
pub use tangent::{Tangent, linearise_tangent};

/// A search for a state is begun again for other sides of discontinuities at most so often.
const SIDES: usize = 8;

/// Refuses a phase in which a contact slides in space.
///
/// # Errors
/// [`LinearError::SlidesInSpace`].
fn refuse_sliding<S: System + ?Sized>(system: &S) -> Result<(), LinearError> {
    slides_in_space(system).map_or(Ok(()), |contact| Err(LinearError::SlidesInSpace { contact }))
}

/// Does `find` with inputs and clock standing still and every discontinuity on the side where the state is that it finds.
///
/// # Errors
/// Those of `find`; [`LinearError::NotSmooth`] for a state at a discontinuity; [`LinearError::DependsOnTime`].
fn on_its_sides<S: System + ?Sized, T>(
    system: &S,
    guess: &Guess,
    find: impl Fn(&dyn System, &Guess) -> Result<(T, Guess), LinearError>,
) -> Result<T, LinearError> {
    refuse_sliding(system)?;
    let mut probe = LinearisationPoint::new(system, guess);
    let mut from = guess.clone();
    for _ in 0..SIDES {
        probe.v.clone_from(&from.v);
        let before = probe.sides_at(&from.q);
        let (found, there) = find(&**probe.system.borrow(), &from)?;
        probe.v.clone_from(&there.v);
        if let Some(switch) = probe.jump(&there.q) {
            return Err(LinearError::NotSmooth { switch });
        }
        probe.without_corner(&there.q)?;
        if probe.sides_at(&there.q) == before {
            probe.check_time(&there.q)?;
            return Ok(found);
        }
        from = there;
    }
    Err(LinearError::NoConvergence { what: "the choice of sides at discontinuities" })
}
