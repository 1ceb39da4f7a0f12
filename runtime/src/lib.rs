//! Write a mechanism down once; it is derived and compiled, and every run says how far it can be trusted.
//!
//! A YAML model file states coordinates, bodies or energies, and forces.  The macro [`model!`] derives the
//! equations of motion when your crate compiles (twice, where the file gives bodies, and the two derivations
//! must agree), tests what the file says is conserved, and generates straight-line Rust for the mass matrix,
//! the forces and their Jacobians.  This crate integrates that code and judges the result.
//!
//! ```
#![doc = include_str!("../examples/double_pendulum.rs")]
//! ```
//!
//! # A control loop
//!
//! [`Simulation::by_hand`] moves a run on step by step: inputs are set by name and held, and a step costs the same however many there were.
//!
//! ```
#![doc = include_str!("../examples/control_loop.rs")]
//! ```
//!
//! The file can hold values between ticks itself, which costs no code and lets `modes --sampled` judge the loop; both ways agree:
//!
//! ```
#![doc = include_str!("../examples/sampled_loop.rs")]
//! ```
//!
//! # Features
//!
//! | feature | adds | on by default |
//! | --- | --- | --- |
//! | `macros` | the macro [`model!`], with the deriver at compile time | yes |
//! | `interpret` | systems from model files that nobody compiled, and what re-derives them: `needs`, references in double-double; takes the deriver into the program | no |
//! | `ensemble` | many runs at once, in SIMD lanes and in threads | no |
//! | `modal` | modes of damped and gyroscopic systems | no |
//! | `png` | figures as PNG and PDF, animations as PNG and GIF; a font is built in | no |
//! | `cli` | the command line as a function, `cli::main`; with `interpret` and `ensemble` | no |
//!
//! Without features there is neither macro nor deriver: `dalembert generate FILE.yaml -o src/x.rs` writes what the macro would expand
//! to, for a crate that checks it in. `dalembert generate … --check` fails where that is no longer the model's code.
//!
//! # Where to look
//! - [`model!`]: the macro and its forms; [`Simulate`]: what every generated type can do.
//! - [`Simulation`] and [`Run`]: settings of a run and its results; [`trust`]: drift and warnings.
//! - [`mechanism`]: the traits that generated code implements, for code of your own over any mechanism.
//! - [`show`]: charts, tables and animations.

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod cause;
#[cfg(feature = "cli")]
pub mod cli;
mod constrain;
mod driver;
#[cfg(feature = "ensemble")]
pub mod ensemble;
mod error;
mod events;
pub mod find;
mod integrate;
pub mod linear;
mod matrix;
pub mod mechanism;
#[cfg(feature = "interpret")]
pub mod needs;
mod numbers;
pub mod orbit;
pub mod precision;
pub mod prelude;
mod run;
pub mod show;
mod simulate;
mod stopwatch;
#[cfg(test)]
mod testing;
pub mod trust;
mod vary;

/// The linear algebra of matrices and complex numbers that this crate returns, in the version that it returns them in.
pub use nalgebra;

pub use cause::{Cause, GimbalLock, NoSeries, TooFast};
pub use constrain::Residuals;
#[cfg(feature = "macros")]
pub use dalembert_macros::model;
#[doc(hidden)]
pub use dalembert_mechanism::generated_for;
pub use error::{Error, Inseparable, NearReturn, NoOrbit, NoSlopes, Nonlinear, NotFound, Unsteppable};
pub use mechanism::{Enforcement, Method, ParseMethodError, Stabilisation};
pub use run::{
    ContactHistory, Digits, Failure, Impulse, Occurrence, Overlap, Run, RunPart, State, SteppedContact, SteppedOver,
    Symmetry, Trust, Work,
};
pub use simulate::{
    Settings, Simulate, Simulation, StateMut, Stepping, enter_initial_phase, initial_state, simulate, simulate_with,
};
pub use trust::{Loss, Warning};
pub use vary::{Slope, Slopes};
