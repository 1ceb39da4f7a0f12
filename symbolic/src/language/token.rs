//! Text to tokens.

use super::Span;
use crate::diagnose::{Problem, catalogue::syntax};

/// One token with its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Token<'a> {
    pub kind: Kind,
    /// As written.
    pub text: &'a str,
    pub span: Span,
}

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Number,
    Name,
    Prime,
    Plus,
    Minus,
    Star,
    Slash,
    Caret,
    Open,
    Close,
    OpenBracket,
    CloseBracket,
    Comma,
    Dot,
    Dots,
    Equal,
    End,
}

impl Token<'_> {
    /// As shown in messages: in backticks, cut short.
    pub fn shown(&self) -> String {
        if self.kind == Kind::End { "the end".to_owned() } else { format!("`{}`", shorten(self.text)) }
    }
}

/// At most 40 characters of a text, for messages.
pub(crate) fn shorten(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((byte, _)) => format!("{}…", &text[..byte]),
        None => text.to_owned(),
    }
}

/// Longest expression in bytes.
const LONGEST: usize = 1 << 16;

/// All tokens, the last of kind [`Kind::End`]; or every character that means nothing.
pub(super) fn tokens(text: &str) -> Result<Vec<Token<'_>>, Vec<Problem>> {
    if text.len() > LONGEST {
        return Err(vec![syntax::expression_too_long(Span::new(0, 1).place(), LONGEST)]);
    }
    let mut found = Vec::new();
    let mut problems = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        if c.is_whitespace() {
            at += c.len_utf8();
            continue;
        }
        let (length, kind) = one(&text[at..], c);
        let span = Span::new(at, at + length);
        let token = &text[at..at + length];
        at += length;
        match kind {
            Ok(Kind::Number) if !is_number(token) => problems.push(syntax::bad_number(span.place(), shorten(token))),
            Ok(kind) => found.push(Token { kind, text: token, span }),
            Err(help) if help.is_empty() || !c.is_ascii() => {
                problems.push(syntax::unknown_character(span.place(), token, help));
            }
            Err(help) => problems.push(syntax::foreign_operator(span.place(), token, help)),
        }
    }
    found.push(Token { kind: Kind::End, text: "", span: Span::new(text.len(), text.len()) });
    if problems.is_empty() { Ok(found) } else { Err(problems) }
}

/// Length and kind of the token at the start of `rest`; or what to write instead.
fn one(rest: &str, first: char) -> (usize, Result<Kind, &'static str>) {
    if let Some((text, help)) = FOREIGN.iter().find(|(text, _)| rest.starts_with(text)) {
        return (text.len(), Err(help));
    }
    let digit_follows = || rest[1..].starts_with(|c: char| c.is_ascii_digit());
    let kind = match first {
        '0'..='9' => return (number_length(rest), Ok(Kind::Number)),
        '.' if digit_follows() => return (number_length(rest), Ok(Kind::Number)),
        '.' if rest.starts_with("..") => return (2, Ok(Kind::Dots)),
        '.' => Kind::Dot,
        '\'' => Kind::Prime,
        '+' => Kind::Plus,
        '-' => Kind::Minus,
        '*' => Kind::Star,
        '/' => Kind::Slash,
        '^' => Kind::Caret,
        '(' => Kind::Open,
        ')' => Kind::Close,
        '[' => Kind::OpenBracket,
        ']' => Kind::CloseBracket,
        ',' => Kind::Comma,
        '=' => Kind::Equal,
        c if starts_name(c) => {
            let length = rest.find(|c: char| !continues_name(c)).unwrap_or(rest.len());
            return (length, Ok(Kind::Name));
        }
        c => return (c.len_utf8(), Err("")),
    };
    (1, Ok(kind))
}

/// What to write in the place of a comparison.
const COMPARED: &str =
    "write the difference: `when: a - b` tells where a and b are equal, `if: a - b` and `step(a - b)` where a > b";

/// What people write in other languages, and what to write here; longer ones first.
const FOREIGN: &[(&str, &str)] = &[
    ("**", "write `^` for a power"),
    ("==", "write `=` in equations"),
    ("&&", "conditions are written with `step`, `if:` or `when:`"),
    ("||", "conditions are written with `step`, `if:` or `when:`"),
    ("!=", "conditions are written with `step`, `if:` or `when:`"),
    ("<=", COMPARED),
    (">=", COMPARED),
    ("<", COMPARED),
    (">", COMPARED),
    (
        "%",
        "of indices write `mod(a, b)`; of quantities what is left of `a` by `b`, in -b/2..b/2, is `b/(2*pi)*atan2(sin(2*pi*a/b), cos(2*pi*a/b))`",
    ),
    ("·", "write `*`, or `dot(a, b)`"),
    ("⋅", "write `*`, or `dot(a, b)`"),
    ("×", "write `*`, or `cross(a, b)`"),
    ("÷", "write `/`"),
    ("−", "write `-`"),
    ("–", "write `-`"),
    ("²", "write `^2`"),
    ("³", "write `^3`"),
    ("√", "write `sqrt(…)`"),
    ("°", "write ` deg`, as a unit after the value"),
    ("’", "write `'`"),
    ("′", "write `'`"),
    ("″", "write `''`"),
    ("…", "write `..`"),
];

fn starts_name(c: char) -> bool {
    c == '_' || unicode_ident::is_xid_start(c)
}

fn continues_name(c: char) -> bool {
    c != '·' && unicode_ident::is_xid_continue(c)
}

/// Digits, points (but not `..`) and an exponent.
fn number_length(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let byte = |at: usize| bytes.get(at).copied().unwrap_or(0);
    let mut at = 0;
    while byte(at).is_ascii_digit()
        || (byte(at) == b'.' && byte(at + 1) != b'.')
        || (byte(at) == b'_' && byte(at + 1).is_ascii_digit())
    {
        at += 1;
    }
    if matches!(byte(at), b'e' | b'E') {
        let sign = usize::from(matches!(byte(at + 1), b'+' | b'-'));
        let digits = bytes[at + 1 + sign..].iter().take_while(|b| b.is_ascii_digit()).count();
        if digits > 0 {
            at += 1 + sign + digits;
        }
    }
    at
}

/// At most one point, no `_`, and neither beyond 64-bit floating point nor below what it has beside 0.
fn is_number(text: &str) -> bool {
    let mut digits = text.bytes().take_while(|byte| !matches!(byte, b'e' | b'E'));
    let is_zero = digits.all(|byte| matches!(byte, b'0' | b'.'));
    text.parse::<f64>().is_ok_and(|number| number.is_finite() && (number != 0.0 || is_zero))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<&str> {
        tokens(text).unwrap().iter().map(|token| token.text).collect()
    }

    #[test]
    fn numbers_end_before_ranges_and_names() {
        assert_eq!(texts("1..n"), ["1", "..", "n", ""]);
        assert_eq!(texts("2.5e-3*x"), ["2.5e-3", "*", "x", ""]);
        assert_eq!(texts("2e"), ["2", "e", ""]);
        assert_eq!(texts("2x.y"), ["2", "x", ".", "y", ""]);
        assert_eq!(texts(".5+1."), [".5", "+", "1.", ""]);
    }

    #[test]
    fn names_are_of_any_script() {
        assert_eq!(texts("θ_1''+длина"), ["θ_1", "'", "'", "+", "длина", ""]);
    }

    #[test]
    fn every_strange_character_is_reported() {
        let problems = tokens("a ** b $ c² \u{0} 1.2.3 1_000 1e999 1e-400 0e-400").unwrap_err();
        let codes: Vec<_> = problems.iter().map(|problem| problem.code).collect();
        assert_eq!(codes, ["E107", "E101", "E101", "E101", "E109", "E109", "E109", "E109"]);
        assert_eq!(problems[2].help, "write `^2`");
    }
}
