//! The model file: read, locate, resolve names, expand families, check.

mod node;
mod resolved;

pub use node::Node;
pub use resolved::{
    Body, Check, Conserved, Coordinate, Derived, Event, EventAction, Family, Input, Load, Model, Output, Parameter,
    Push, Rotation, Sample, Scene, Shape, Vector, Work,
};
