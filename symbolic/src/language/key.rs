//! Keys of mappings: names, families and members of families.

use super::cursor::{Parsed, Parser};
use super::token::{Kind, shorten};
use super::{Key, KeyIndex};
use crate::diagnose::{Problem, catalogue::syntax};
use crate::language::Span;

/// Reads a key: `theta`, `theta[i in 1..n]`, `x[2]'`, `tip[0]`.  Lists such as `of` name members in the same way.
///
/// # Errors
/// As for [`parse`](super::parse).
pub fn parse_key(text: &str) -> Result<Key, Vec<Problem>> {
    let mut parser = Parser::new(text)?;
    let key = key(&mut parser, text);
    parser.finish(key)
}

/// Longest name in bytes; generated code repeats it.
const LONGEST: usize = 200;

fn key(parser: &mut Parser<'_>, text: &str) -> Parsed<Key> {
    let name = parser.peek();
    if name.kind != Kind::Name {
        let span = Span::new(0, text.len());
        return parser.report(syntax::bad_key(span.place(), shorten(text)));
    }
    if name.text.len() > LONGEST {
        return parser.report(syntax::name_too_long(name.span.place(), shorten(name.text), LONGEST));
    }
    parser.next();
    let mut indices = Vec::new();
    if parser.is(Kind::OpenBracket) {
        let open = parser.next();
        loop {
            indices.push(index(parser)?);
            if !parser.takes(Kind::Comma) {
                break;
            }
        }
        parser.close(open, Kind::CloseBracket)?;
    }
    let primes = parser.primes(name)?;
    if !parser.is(Kind::End) {
        let span = Span::new(0, text.len());
        return parser.report(syntax::bad_key(span.place(), shorten(text)));
    }
    Ok(Key { name: name.text.to_owned(), span: name.span, indices, primes })
}

fn index(parser: &mut Parser<'_>) -> Parsed<KeyIndex> {
    if parser.at_range() {
        return Ok(KeyIndex::Range(parser.range()?.0));
    }
    Ok(KeyIndex::Fixed(parser.expression(1)?.ast))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_names_families_and_members() {
        let key = parse_key("s[i in 1..n, j in i+1..n]").unwrap();
        assert_eq!((key.name.as_str(), key.indices.len(), key.primes), ("s", 2, 0));
        assert!(matches!(&key.indices[1], KeyIndex::Range(range) if range.name == "j"));
        let key = parse_key("x[n+1]''").unwrap();
        assert!(matches!(&key.indices[0], KeyIndex::Fixed(_)) && key.primes == 2);
        assert_eq!(parse_key("on").unwrap().name, "on");
    }

    #[test]
    fn refuses_what_is_no_name() {
        for text in ["", "1", "two-moments", "a b", "x'[1]", "x[", "x[]", "x[i in 1]", "x'''"] {
            assert!(parse_key(text).is_err(), "{text}");
        }
    }
}
