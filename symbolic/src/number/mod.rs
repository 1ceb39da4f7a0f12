//! Numbers: exact rationals, and double-doubles of about 32 digits where a value is irrational or beyond 128 bits.

mod decimal;
mod double_double;
mod exact;
mod exponential;
mod inverse;
mod normal;
mod rational;
mod reduction;
mod trigonometric;

pub use double_double::DoubleDouble;
pub use exact::Number;
pub use normal::{NORMAL_RATIOS, normal};
pub use rational::Rational;

#[cfg(test)]
mod reference;
