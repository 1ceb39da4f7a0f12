//! The model: names resolved, families expanded, every expression in the graph, units checked.

pub(crate) mod command;
mod contact;
mod event;
mod every;
mod expression;
mod files;
mod gimbals;
mod identifier;
mod motion;
mod resolve;
mod resolved;
mod resolver;
mod rotation;
mod section;
mod text;
mod ways;

pub use command::Sets;
pub use contact::{Contact, ContactMode, ImpactLaw, MOST_COMBINATIONS, are_single, modes_of_phases};
pub use event::{Clock, Event, EventAction, HeldValue, Noise, Set, Target, Trigger};
pub(crate) use expression::builder::is_of_units;
pub use files::Files;
pub use gimbals::Gimbal;
pub use identifier::{KEYWORDS, METHODS, field_name, is_snake_case, local_name, method_name, type_name};
pub(crate) use identifier::{greek, spell};
pub use motion::{Closes, Goal, Image, Motion};
pub(crate) use resolve::is_observed;
pub(crate) use resolve::load_in_parts;
pub use resolve::{
    load, load_from, load_in, load_with_forces, read_through, read_through_from, read_through_in, resolve,
};
pub use resolved::{
    Balance, BalanceSystem, Body, Change, Check, Condition, Conserved, Constraint, Coordinate, Derived, Family,
    GeneralizedForce, HIDDEN, Input, Load, Model, Need, Output, Parameter, Part, Phase, PointForces, Push, Reaction,
    RotationCoordinate, Sample, Scene, Shape, SharedEnd, Solid, Spin, StateOfFirstOrder, Tried, Vector, Work,
};
pub use rotation::{Orientation, Quaternion, Rotation, Stage, product};
pub use section::inertia::{Impossible, impossible_moments, principal_moments};
pub use section::scenes::looks_like_degrees;
pub(crate) use section::springs::LENGTH;
pub use section::tables::cells_of;
pub(crate) use text::text_in;
pub use text::{number_text, rate_name, symbol_text, text};
pub use ways::{Way, Ways};
