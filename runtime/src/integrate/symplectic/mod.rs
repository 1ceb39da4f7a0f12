//! Symplectic methods for separable systems, with a fixed step: kicks of the speeds and drifts of the places in turn.
//!
//! Along constraints Störmer and Verlet's method is RATTLE (`rattle.rs`), and its compositions are those of RATTLE.
//!
//! Along a motion of a conservative mechanism the error of the energy stays bounded, however long the motion is: each
//! method solves a mechanism with a slightly different energy, up to errors that are exponentially small in 1/h
//! (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2006, IX.8).  That holds for a step that never changes:
//! reports and recorded events read dense output, and only what ends a motion, or changes its equations, cuts a step.

mod blanes_moan;
mod dense;
mod kahan_li;
mod rattle;
mod step;
mod suzuki;
mod tableau;
#[cfg(test)]
mod tests;
mod verlet;

pub(crate) use blanes_moan::SRKN4;
pub(crate) use kahan_li::KAHAN_LI_8;
pub(crate) use step::Symplectic;
pub(crate) use suzuki::SUZUKI_4;
pub(crate) use tableau::Splitting;
pub(crate) use verlet::VERLET;
