//! The file as YAML: read to a tree of nodes with places, and problems shown where they stand in it.

pub mod edit;
mod locate;
mod node;
mod quotes;
mod read;
mod reader;
mod render;
mod spans;
mod unquoted;
mod written;
mod yaml_error;

pub use locate::locate;
pub use node::Node;
pub use read::read;
pub(crate) use reader::{Quantity, Spot, describe, quantity, unit_at};
pub use render::{Extent, extents, render, sort};
pub(crate) use written::{Text, Written, words};

#[cfg(test)]
mod reading_tests;
