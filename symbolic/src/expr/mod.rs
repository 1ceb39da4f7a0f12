//! The expression graph: hash-consed arena, differentiation, evaluation.

mod arithmetic;
mod chains;
mod coefficient;
mod differentiate;
mod evaluate;
mod expand;
mod graph;
mod measured;
mod overflow;
mod places;
mod products;
mod rewrite;
mod scalar;
mod schedule;
mod sums;
mod symbol;
mod table;
mod table_2d;
pub mod vectors;

pub use differentiate::{Forward, gradients, jacobian, partial, reverse};
pub use evaluate::Tape;
pub use expand::{Angles, expand, expand_around_sums};
pub use graph::{Binary, Graph, Id, NODE_LIMIT, Node, Unary};
pub use measured::Measured;
pub use overflow::{logarithms_without_overflow, without_overflow};
pub use products::{canonical_products, factors};
pub use rewrite::{copied, rewrite, substitute};
pub use scalar::Scalar;
pub use sums::{canonical_sums, terms};
pub use symbol::Symbol;
pub use table::{Smooth, Table};
pub use table_2d::{Grid, Table2d};

pub use crate::number::{DoubleDouble, Number, Rational};
