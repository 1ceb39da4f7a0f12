//! The expression graph: hash-consed arena, exact rationals, differentiation, evaluation.

mod graph;
mod rational;
mod symbol;

pub use graph::{Binary, Graph, Id, Node, Number, Unary};
pub use rational::Rational;
pub use symbol::Symbol;
