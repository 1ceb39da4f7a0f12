//! The model file: read, locate, resolve names, expand families, check.

mod command;
mod expression;
mod resolve;
mod resolved;
mod resolver;
mod section;
mod yaml;

pub use command::Sets;
pub use resolve::{load, resolve};
pub use resolved::{
    Balance, BalanceSystem, Body, Change, Check, Conserved, Coordinate, Derived, Event, EventAction, Family,
    GeneralizedForce, Input, Load, Model, Output, Parameter, Part, Push, Reaction, Rotation, Sample, Scene, Shape,
    SharedEnd, Vector, Work,
};
pub use yaml::locate::locate;
pub use yaml::node::Node;
pub use yaml::read::read;
