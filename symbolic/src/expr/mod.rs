//! The expression graph: hash-consed arena, exact rationals, differentiation, evaluation.

mod arithmetic;
mod canonical;
mod differentiate;
mod evaluate;
mod expand;
mod graph;
mod rational;
mod rewrite;
mod symbol;

pub use canonical::canonical;
pub use differentiate::{Forward, gradients, jacobian, partial, reverse};
pub use evaluate::{Tape, apply_binary, apply_unary};
pub use expand::expand;
pub use graph::{Binary, Graph, Id, Node, Number, Unary};
pub use rational::Rational;
pub use rewrite::{rewrite, substitute};
pub use symbol::Symbol;
