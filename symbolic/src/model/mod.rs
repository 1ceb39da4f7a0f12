//! The model: names resolved, families expanded, every expression in the graph, units checked.

mod command;
mod expression;
mod resolve;
mod resolved;
mod resolver;
mod section;
mod text;

pub use command::Sets;
pub use resolve::{load, resolve};
pub use resolved::{
    Balance, BalanceSystem, Body, Change, Check, Conserved, Coordinate, Derived, Event, EventAction, Family,
    GeneralizedForce, Input, Load, Model, Output, Parameter, Part, Push, Reaction, Rotation, Sample, Scene, Shape,
    SharedEnd, Vector, Work,
};
pub use text::text;
pub(crate) use text::text_in;
