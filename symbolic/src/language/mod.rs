//! Text to syntax trees: lexer, Pratt parser, built-in functions, units, spans.

mod ast;

pub use ast::{Ast, AstKind, Key, KeyIndex, Operator, Range, Valued};

/// A range of bytes in an expression's text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}
