//! Expressions as a file writes them: parsed, with their places.

use std::rc::Rc;

use crate::language::{Ast, Unit};
use crate::place::{Place, Span};

/// One expression of the file.
#[derive(Clone, Debug)]
pub struct Text {
    /// As written.
    pub source: Rc<str>,
    /// Parsed.
    pub ast: Rc<Ast>,
    /// The unit after it, where one value is wanted.
    pub unit: Option<Unit>,
    /// Where it stands.
    pub place: Rc<Place>,
}

/// An expression, or a YAML list of two or three that stands for a vector.
#[derive(Clone, Debug)]
pub enum Written {
    /// One expression.
    One(Text),
    /// Components.
    List(Vec<Text>, Rc<Place>),
}

impl Written {
    /// Where it stands.
    pub fn place(&self) -> &Rc<Place> {
        match self {
            Written::One(text) => &text.place,
            Written::List(_, place) => place,
        }
    }
}

impl Text {
    /// The words at a span.
    pub fn words(&self, span: Span) -> &str {
        words(&self.source, span)
    }
}

/// The words of a text at a span.
pub fn words(source: &str, span: Span) -> &str {
    source.get(span.range()).unwrap_or(source)
}
