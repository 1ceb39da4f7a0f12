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

    /// As a range of indices.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }
}
