//! Everything before Rust exists: reads a model file, checks it, derives its equations and prints them.

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod derive;
pub mod diagnose;
pub mod expr;
pub mod file;
pub mod gate;
pub mod interpret;
pub mod language;
pub mod lower;
pub mod model;
pub mod number;
mod place;
pub mod print;
mod random;
