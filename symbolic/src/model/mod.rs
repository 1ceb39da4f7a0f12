//! The model file: read, locate, resolve names, expand families, check.

mod complaint;
mod locate;
mod node;
mod outline;
mod read;
mod resolved;
mod taken_apart;

#[cfg(test)]
mod reading_tests;

pub use locate::locate;
pub use node::Node;
pub use read::read;
pub use resolved::{
    Body, Check, Conserved, Coordinate, Derived, Event, EventAction, Family, Input, Load, Model, Output, Parameter,
    Push, Rotation, Sample, Scene, Shape, Vector, Work,
};

/// Placeholder until the resolver lands.
pub fn load(_text: &str, _sizes: &[(String, i64)]) -> Result<Model, Vec<crate::diagnose::Problem>> {
    Err(Vec::new())
}

impl Model {
    /// Placeholder until the resolver lands.
    pub fn constant(&mut self, _text: &str, _parameters: &[f64]) -> Result<f64, Vec<crate::diagnose::Problem>> {
        Err(Vec::new())
    }
    /// Placeholder until the resolver lands.
    pub fn signal(&mut self, _text: &str) -> Result<[crate::expr::Id; 3], Vec<crate::diagnose::Problem>> {
        Err(Vec::new())
    }
}
