//! Everything before Rust exists: reads a model file, checks it, derives its equations and prints them.

pub mod diagnose;
pub mod expr;
pub mod language;
pub mod model;
