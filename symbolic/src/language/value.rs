//! Values with units: `m*l^2/12 kg*m^2`, `2 1/m`, `30 deg`.

use super::cursor::{Parsed, Parser};
use super::token::Kind;
use super::{Span, Valued};
use crate::diagnose::{Problem, catalogue::syntax};

/// Reads a value and the unit after it, which starts at the first name, number or parenthesis that follows a
/// complete value without an operator.  The unit is split off, not read; see [`parse_unit`](super::parse_unit).
///
/// # Errors
/// As for [`parse`](super::parse).
pub fn parse_value_with_unit(text: &str) -> Result<Valued, Vec<Problem>> {
    let mut parser = Parser::new(text)?;
    parser.before_unit = true;
    let valued = valued(&mut parser, text);
    parser.finish(valued)
}

fn valued(parser: &mut Parser<'_>, text: &str) -> Parsed<Valued> {
    if parser.is(Kind::End) {
        return parser.report(syntax::empty_expression(parser.peek().span.place()));
    }
    let value = parser.expression(1)?.ast;
    let unit = match parser.peek().kind {
        Kind::Name | Kind::Number | Kind::Open => {
            let span = Span::new(parser.peek().span.start as usize, text.trim_end().len());
            Some((text[span.range()].to_owned(), span))
        }
        _ => {
            parser.end()?;
            None
        }
    };
    Ok(Valued { value, unit })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(text: &str) -> (String, Option<String>) {
        let valued = parse_value_with_unit(text).unwrap();
        (text[valued.value.span.range()].to_owned(), valued.unit.map(|(unit, _)| unit))
    }

    #[test]
    fn the_unit_follows_a_complete_value() {
        for (text, value, unit) in [
            ("m*l^2/12 kg*m^2", "m*l^2/12", "kg*m^2"),
            ("2 1/m", "2", "1/m"),
            ("pi/4 rad", "pi/4", "rad"),
            ("30 deg ", "30", "deg"),
            ("asin(0.6) rad", "asin(0.6)", "rad"),
            ("(a + b) m", "(a + b)", "m"),
            ("l (m/s)", "l", "(m/s)"),
            ("-2 kg", "-2", "kg"),
            ("x[1] m", "x[1]", "m"),
            ("2*sin (a) m", "2*sin (a)", "m"),
            ("[0, 1] m", "[0, 1]", "m"),
            ("2m", "2", "m"),
            ("x' m/s", "x'", "m/s"),
        ] {
            assert_eq!(split(text), (value.to_owned(), Some(unit.to_owned())), "{text}");
        }
        assert_eq!(split("m*l^2/12"), ("m*l^2/12".to_owned(), None));
    }

    #[test]
    fn inside_brackets_there_is_no_unit() {
        assert_eq!(parse_value_with_unit("(2 m)").unwrap_err()[0].code, "E106");
        assert_eq!(parse_value_with_unit("[1 m, 2 m]").unwrap_err().len(), 2);
        assert_eq!(parse_value_with_unit("1,5 kg").unwrap_err()[0].code, "E108");
    }
}
