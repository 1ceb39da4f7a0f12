//! The model file: read, locate, resolve names, expand families, check.

mod node;

pub use node::Node;
