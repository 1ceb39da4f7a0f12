//! The file as YAML: read to a tree, with places for errors.

pub mod complaint;
pub mod locate;
pub mod node;
pub mod outline;
pub mod read;
pub mod reader;
pub mod taken_apart;

#[cfg(test)]
mod reading_tests;
