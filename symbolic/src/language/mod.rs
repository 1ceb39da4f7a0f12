//! Text to syntax trees: lexer, Pratt parser, built-in functions, units, spans.

mod ast;
mod cursor;
mod function;
mod key;
mod parse;
mod token;
mod unit;
mod value;

#[cfg(test)]
mod tests;

use crate::diagnose::Place;

pub use ast::{Ast, AstKind, Key, KeyIndex, Operator, Range, Valued};
pub use function::{FUNCTIONS, Function, RESERVED, function, is_reserved};
pub use key::parse_key;
pub use parse::{DEEPEST, parse, parse_bounds, parse_equation};
pub use unit::{Unit, parse_unit};
pub use value::parse_value_with_unit;

/// A range of bytes in an expression's text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// Bytes `start..end`; beyond 4 GB both saturate.
    pub fn new(start: usize, end: usize) -> Span {
        let bound = |byte| u32::try_from(byte).unwrap_or(u32::MAX);
        Span { start: bound(start), end: bound(end) }
    }

    /// From the start of this to the end of `other`.
    pub fn to(self, other: Span) -> Span {
        Span { start: self.start, end: other.end }
    }

    /// These bytes of a text whose own place is not known yet; see [`Problem::moved_to`](crate::diagnose::Problem::moved_to).
    pub fn place(self) -> Place {
        Place { span: Some(self), ..Place::default() }
    }

    /// As a range of indices.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }
}
