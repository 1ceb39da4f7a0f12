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

pub use ast::{Ast, AstKind, FRICTION, Key, KeyIndex, Operator, Range, SCALAR, Valued};
pub use function::{FUNCTIONS, Function, RESERVED, at_another_time, function, is_reserved, lag, written_here};
pub use key::parse_key;
pub use parse::{DEEPEST, parse, parse_bounds, parse_equation};
pub(crate) use token::shorten;
pub use unit::{BASES, Unit, parse_unit};
pub use value::parse_value_with_unit;

pub use crate::place::Span;
