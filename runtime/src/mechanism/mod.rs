//! What generated code implements, and what is built on it: scalars, mechanisms, systems, descriptions.

mod at;
mod balances;
mod contacts;
pub(crate) mod dense;
mod description;
mod dual;
mod dynamic;
mod enforcement;
mod generated;
#[cfg(feature = "interpret")]
mod interpreted;
mod kkt;
mod method;
mod motion;
mod noise;
mod phased;
mod rates;
mod real;
mod sampling;
mod series;
mod singular;
pub(crate) mod sliding;
mod slopes;
mod solve;
mod subsystem;
mod system;
mod table;
mod table_2d;

pub use at::At;
pub use balances::Balances;
pub use contacts::{Contact, ContactEvent, ContactMode, Contacts, ImpactLaw};
pub use description::{
    Action, Argument, Balance, BalanceSystem, Coordinate, Counts, Description, Direction, Event, Gimbal, InputJump,
    Integral, List, Parameter, Part, Phase, Quantity, Rated, Role, Row, Shape, Structure, Switch, SwitchKind, Text,
    Tried, Watched,
};
pub(crate) use description::{HIDDEN, rate_name};
pub use dynamic::Dynamic;
pub use enforcement::{Enforcement, Stabilisation};
pub use generated::{Mechanism, Values};
#[cfg(feature = "interpret")]
pub(crate) use interpreted::ExtendedAt;
#[cfg(feature = "interpret")]
pub use interpreted::Interpreted;
pub(crate) use kkt::{KktSolver, Solutions};
pub use method::{Method, ParseMethodError};
pub use motion::{Closes, ClosesBy, Extreme, Goal, Motion, MotionNumbers};
pub use noise::Noise;
#[cfg(feature = "modal")]
pub(crate) use noise::is_of_noise;
pub use phased::RowHistory;
pub use rates::{choose_sides, rate_jacobian};
pub use real::Real;
pub use sampling::{Clock, Sampling, Target, Trigger};
pub(crate) use series::{Jets, MotionJets, dot};
#[doc(hidden)]
pub use series::{Place, Recurrence, Series};
pub use singular::{Singular, SingularMass};
pub(crate) use slopes::AccelerationSlopes;
#[doc(hidden)]
pub use solve::solve_packed;
pub(crate) use solve::{factor_packed, solve_packed_slice, substitute_back, substitute_forward};
pub(crate) use subsystem::OfPart;
pub use system::{Along, Function, Signal, System};
#[doc(hidden)]
pub use table::Table;
#[doc(hidden)]
pub use table_2d::Table2d;

/// Energies of a state.
///
/// The balance is J − ∫P dt with J = q'·∂T/∂q' − T + V and P = q'·Q − ∂T/∂t + ∂V/∂t: for kinetic energies
/// quadratic in the speeds J is the energy itself and P the power of everything that has no potential
/// (Whittaker, Analytical Dynamics, §41).  Along an exact motion the balance is constant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// T, J.
    pub kinetic: f64,
    /// V, J.
    pub potential: f64,
    /// q'·∂T/∂q' − T + V, J.
    pub jacobi: f64,
    /// q'·Q − ∂T/∂t + ∂V/∂t, W.
    pub power: f64,
    /// Sum of the absolute values of the terms of T and V, J.
    pub scale: f64,
}

/// Where and how long to run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Generalized coordinates at the start, SI; of those that are not held, the guess.
    pub q: Vec<f64>,
    /// Their rates at the start, SI.
    pub v: Vec<f64>,
    /// Which coordinates keep their values where constraints are met; none named: all.
    pub held_q: Vec<bool>,
    /// Which rates do.
    pub held_v: Vec<bool>,
    /// Whether somebody gave a guess.
    pub guessed: bool,
    /// The phase in which it starts.
    pub phase: usize,
    /// Which of the equations of `System::start_conditions` the start meets beside constraints.
    pub start_conditions: std::ops::Range<usize>,
    /// Where the run ends, s.
    pub until: f64,
    /// Tolerance, relative to the range that each coordinate goes through.
    pub tolerance: f64,
    /// Spacing of reported states, s; `None`: 500 points.
    pub every: Option<f64>,
}
