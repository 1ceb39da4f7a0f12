//! Constraints along a motion: consistent starts, and states kept on them.
//!
//! 1. A start that meets the constraints: look in `start.rs`; what else it is to meet: `start_conditions.rs`; angular velocities
//!    at the attitude that is found: `spin.rs`; other ways to put the mechanism together: `branch.rs`.
//! 2. After every step positions and speeds go back to the constraints, in the metric of M: look in `projection.rs`.
//! 3. Jumps of the speeds where constraints are entered or struck: look in `impact.rs`.
//!
//! 4. What friction and contacts do by themselves: look in `contacts`; discontinuities at whose surface constraints hold the motion: in `held.rs`.
//!
//! The elimination of accelerations and multipliers is `mechanism/kkt/mod.rs`.

mod branch;
mod contacts;
mod held;
mod impact;
mod projection;
mod spin;
mod start;
mod start_conditions;

pub(crate) use branch::{Elsewhere, other_branch};
pub(crate) use contacts::{
    Change, Kinematics, Moment, STILL, Strike, Turned, approaches, begins_stiffly, closed_within, direction,
    follow_directions, held_direction, is_released, kinematics, lasting_rows, never_stopping, possible_limits,
    resting_open, settle, slides_in_space, strike, turned, unresolved_rates, where_shared, with_shares,
};
pub(crate) use held::held_switches;
pub(crate) use impact::{VelocityJump, possible_restitution, possible_restitutions, velocity_jump};
pub(crate) use projection::Projection;
pub use projection::Residuals;
pub(crate) use spin::KeptSpin;
pub(crate) use start::{Start, consistent};
