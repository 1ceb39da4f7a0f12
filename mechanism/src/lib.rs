//! What code that `dalembert generate` wrote implements and calls: traits, scalars and descriptions, without the standard library.
//!
//! The crate `dalembert` integrates such code, and exports all of this as `dalembert::mechanism`.  Alone this crate is for what integrates by
//! itself or not at all: a controller that computes with a mechanism's mass matrix and forces, in `f32` too.
//!
//! ```toml
//! [dependencies]
//! dalembert = { package = "dalembert-mechanism", version = "0.1", default-features = false, features = ["libm"] }
//! ```
//!
//! Under that name generated code finds it: `dalembert generate cart.yaml --no-std -o src/cart.rs`.  Nothing is allocated.
//!
//! # Features
//!
//! | feature | adds | on by default |
//! | --- | --- | --- |
//! | `std` | functions of the standard library; with `alloc` | yes |
//! | `alloc` | [`Mechanism`]: parameters by place, scenes and motions, which a run needs | with `std` |
//! | `libm` | functions where there is no standard library: without `std` it is needed | no |
#![no_std]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

#[cfg(not(any(feature = "std", feature = "libm")))]
compile_error!(
    "without the feature `std` the feature `libm` of dalembert-mechanism is needed: sines must come from somewhere"
);

mod contacts;
mod description;
mod equations;
mod list;
#[cfg(feature = "alloc")]
mod motion;
mod noise;
mod real;
#[cfg(feature = "alloc")]
mod runs;
mod sampling;
mod series;
mod solve;
mod table;
mod table_2d;

#[doc(hidden)]
pub use contacts::NO_CONTACTS;
pub use contacts::{Contact, ContactEvent, ContactMode, Contacts, ImpactLaw, MOST_COMBINATIONS};
#[doc(hidden)]
pub use description::HIDDEN;
#[cfg(feature = "alloc")]
#[doc(hidden)]
pub use description::rate_name;
pub use description::{
    Action, Argument, Balance, BalanceSystem, Coordinate, Counts, Description, Direction, Event, Gimbal, InputJump,
    Integral, Parameter, Part, Phase, Quantity, Rated, Role, Row, Shape, Structure, Switch, SwitchKind, Tried, Watched,
};
pub use equations::{Energy, Equations, Values};
#[cfg(not(feature = "alloc"))]
pub use list::Literal;
pub use list::{List, Text};
#[cfg(feature = "alloc")]
pub use motion::{Closes, ClosesBy, Extreme, Goal, Motion, MotionNumbers};
pub use noise::Noise;
#[doc(hidden)]
pub use noise::normal;
pub use real::Real;
#[cfg(feature = "alloc")]
pub use runs::{Mechanism, Scene, Spin};
#[doc(hidden)]
pub use sampling::NO_SAMPLING;
pub use sampling::{Clock, Sampling, Target, Trigger};
#[doc(hidden)]
pub use series::{Place, Recurrence, SERIES_TERMS, Series};
pub use solve::SingularMass;
#[doc(hidden)]
pub use solve::{factor_packed, solve_packed, solve_packed_slice, substitute_back, substitute_forward};
#[doc(hidden)]
pub use table::Table;
#[doc(hidden)]
pub use table_2d::Table2d;

/// Where generated code looks for all of this.
#[doc(hidden)]
pub mod mechanism {
    pub use super::*;
}

/// Accepts code that was generated for this version of the library, which calls it; it is bumped with `FORMAT` of the printer whenever
/// what generated code implements or calls changes.
#[doc(hidden)]
#[macro_export]
macro_rules! generated_for {
    (7) => {};
    ($format:literal) => {
        ::core::compile_error!(::core::concat!(
            "this code was generated for format ",
            $format,
            " of dalembert, and this version of the library reads format 7: write it again by this version's `dalembert generate`"
        ));
    };
}
