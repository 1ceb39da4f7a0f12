//! The expression graph: hash-consed arena, exact rationals, differentiation, evaluation.

mod differentiate;
mod evaluate;
mod graph;
mod rational;
mod symbol;

pub use differentiate::{Forward, partial, reverse};
pub use evaluate::{Tape, apply_binary, apply_unary};
pub use graph::{Binary, Graph, Id, Node, Number, Unary};
pub use rational::Rational;
pub use symbol::Symbol;
