//! The model file: read, locate, resolve names, expand families, check.

mod antiderivative;
mod balances;
mod bench;
mod bodies;
mod carriers;
mod command;
mod complaint;
mod declare;
mod dimension;
mod draw;
mod ends;
mod facts;
mod families;
mod forces;
mod functions;
mod index;
mod lists;
mod loads;
mod locate;
mod lower;
mod measure;
mod names;
mod node;
mod outline;
mod parameters;
mod quadrature;
mod reactions;
mod read;
mod reader;
mod resolve;
mod resolved;
mod resolver;
mod scenes;
mod scope;
mod settle;
mod shared;
mod springs;
mod substitute;
mod taken_apart;
mod terms;
mod value;
mod watched;

#[cfg(test)]
mod reading_tests;

pub use command::Sets;
pub use locate::locate;
pub use node::Node;
pub use read::read;
pub use resolve::{load, resolve};
pub use resolved::{
    Balance, BalanceSystem, Body, Change, Check, Conserved, Coordinate, Derived, Event, EventAction, Family,
    GeneralizedForce, Input, Load, Model, Output, Parameter, Part, Push, Reaction, Rotation, Sample, Scene, Shape,
    SharedEnd, Vector, Work,
};
