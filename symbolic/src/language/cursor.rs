//! A position among tokens, what was wrong before it, and how that is told.

use super::function::{at_another_time, function};
use super::token::{Kind, Token, shorten, tokens};
use crate::diagnose::{Problem, catalogue::syntax};

/// Already reported.
pub(super) struct Reported;

pub(super) type Parsed<T> = Result<T, Reported>;

/// Most problems told about one expression.
const MOST: usize = 10;

/// A position among tokens, and what was wrong before it.
pub(super) struct Parser<'a> {
    text: &'a str,
    tokens: Vec<Token<'a>>,
    pub at: usize,
    /// Calls inside each other, which bound the stack.
    pub nesting: u32,
    problems: Vec<Problem>,
    /// A unit may follow the value: names, numbers and parentheses after it end it.
    pub before_unit: bool,
}

impl<'a> Parser<'a> {
    pub fn new(text: &'a str) -> Result<Parser<'a>, Vec<Problem>> {
        let tokens = tokens(text)?;
        Ok(Parser { text, tokens, at: 0, nesting: 0, problems: Vec::new(), before_unit: false })
    }

    /// The result, or what was wrong.
    pub fn finish<T>(self, result: Parsed<T>) -> Result<T, Vec<Problem>> {
        match result {
            Ok(value) if self.problems.is_empty() => Ok(value),
            _ => Err(self.problems),
        }
    }

    pub fn peek(&self) -> Token<'a> {
        self.tokens[self.at]
    }

    pub fn after(&self) -> Token<'a> {
        self.tokens[(self.at + 1).min(self.tokens.len() - 1)]
    }

    pub fn before(&self) -> Token<'a> {
        self.tokens[self.at.saturating_sub(1)]
    }

    pub fn next(&mut self) -> Token<'a> {
        let token = self.peek();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        token
    }

    pub fn is(&self, kind: Kind) -> bool {
        self.peek().kind == kind
    }

    /// Takes the next token if it is of this kind.
    pub fn takes(&mut self, kind: Kind) -> bool {
        let found = self.is(kind);
        if found {
            self.next();
        }
        found
    }

    pub fn report<T>(&mut self, problem: Problem) -> Parsed<T> {
        if !self.is_full() {
            self.problems.push(problem);
        }
        Err(Reported)
    }

    /// So much is wrong already that no more is told.
    pub fn is_full(&self) -> bool {
        self.problems.len() >= MOST
    }

    /// The next token is none of what could stand here.
    pub fn unexpected<T>(&mut self, expected: &str) -> Parsed<T> {
        let token = self.peek();
        let place = token.span.place();
        let problem = match token.kind {
            Kind::End => syntax::unexpected_end(place, expected),
            Kind::Close | Kind::CloseBracket if self.open_before() == 0 => syntax::not_opened(place, token.text),
            _ => syntax::unexpected(place, token.shown(), expected),
        };
        self.report(problem)
    }

    /// How many brackets are open before the next token.
    fn open_before(&self) -> usize {
        self.tokens[..self.at].iter().fold(0, |open: usize, token| match token.kind {
            Kind::Open | Kind::OpenBracket => open + 1,
            Kind::Close | Kind::CloseBracket => open.saturating_sub(1),
            _ => open,
        })
    }

    /// Nothing may follow.
    pub fn end(&mut self) -> Parsed<()> {
        match self.peek().kind {
            Kind::End => Ok(()),
            _ => self.cannot_follow("an operator or the end"),
        }
    }

    /// What follows a complete value is no operator: says the likeliest reason.
    fn cannot_follow<T>(&mut self, expected: &str) -> Parsed<T> {
        let (left, right) = (self.before(), self.peek());
        let place = right.span.place();
        let problem = match right.kind {
            Kind::Equal => syntax::equation_misplaced(place, equation_help(self.at, &self.tokens)),
            Kind::Prime => syntax::prime_misplaced(place),
            Kind::Comma if left.kind == Kind::Number && self.after().kind == Kind::Number => {
                let whole = left.span.to(self.after().span);
                let number = format!("{}.{}", left.text, self.after().text);
                syntax::decimal_comma(whole.place(), shorten(&number))
            }
            Kind::Open if left.kind == Kind::Prime => syntax::missing_operator(
                place,
                shorten(left.text),
                shorten(right.text),
                at_another_time(&self.rate_before()),
            ),
            Kind::Number | Kind::Name | Kind::Open | Kind::OpenBracket => {
                let help = product(left, right, self.is_in_list());
                syntax::missing_operator(place, shorten(left.text), shorten(right.text), help)
            }
            _ => return self.unexpected(expected),
        };
        self.report(problem)
    }

    /// Whether commas may stand before the next token: in `[…]`, and between arguments.
    fn is_in_list(&self) -> bool {
        let mut closed = 0;
        let open = self.tokens[..self.at].iter().rposition(|token| match token.kind {
            Kind::Close | Kind::CloseBracket => {
                closed += 1;
                false
            }
            Kind::Open | Kind::OpenBracket => {
                closed -= 1;
                closed < 0
            }
            _ => false,
        });
        open.is_some_and(|open| {
            let called = open.checked_sub(1).and_then(|before| function(self.tokens[before].text));
            self.tokens[open].kind == Kind::OpenBracket || called.is_some_and(|function| function.most > 1)
        })
    }

    /// `x'` of a name with primes that ends before the next token.
    fn rate_before(&self) -> String {
        let before = &self.tokens[..self.at];
        let primes = before.iter().rev().take_while(|token| token.kind == Kind::Prime).count();
        before[before.len().saturating_sub(primes + 1)..].iter().map(|token| token.text).collect()
    }

    pub fn close(&mut self, open: Token<'a>, closing: Kind) -> Parsed<()> {
        if self.takes(closing) { Ok(()) } else { self.not_closed(open, closing) }
    }

    pub fn not_closed<T>(&mut self, open: Token<'a>, closing: Kind) -> Parsed<T> {
        let found = self.peek();
        if !matches!(found.kind, Kind::End | Kind::Comma | Kind::Close | Kind::CloseBracket) {
            return self.cannot_follow("an operator, a comma or a closing bracket");
        }
        let column = self.text[..open.span.start as usize].chars().count() + 1;
        let sign = if closing == Kind::Close { ")" } else { "]" };
        let place = found.span.place();
        self.report(syntax::not_closed(place, open.text, column, sign, found.shown()))
    }
}

/// "did you mean `2*x`?", or in a list "did you mean `2, x` or `2*x`?"
fn product(left: Token<'_>, right: Token<'_>, is_in_list: bool) -> String {
    if left.kind == Kind::Number && right.kind == Kind::Name && super::parse_unit(right.text).is_ok() {
        let radians = in_radians(left.text).filter(|_| right.text == "deg");
        let radians = radians.map_or_else(String::new, |radians| format!("write `{radians}`, or "));
        return format!(
            "a unit follows only a value that stands alone: {radians}name the quantity in `parameters`; a product needs `*`"
        );
    }
    let right_text = match right.kind {
        Kind::Open => "(…)".to_owned(),
        Kind::OpenBracket => "[…]".to_owned(),
        _ => shorten(right.text),
    };
    let left_text = match left.kind {
        Kind::Number | Kind::Name => shorten(left.text),
        _ => format!("…{}", left.text),
    };
    let comma = if is_in_list { format!("`{left_text}, {right_text}` or ") } else { String::new() };
    format!("did you mean {comma}`{left_text}*{right_text}`?")
}

/// A number of degrees in radians: `pi/6` of 30, `25*pi/180` of 25.
fn in_radians(degrees: &str) -> Option<String> {
    let part = 180.0 / degrees.parse::<f64>().ok()?;
    Some(match part {
        1.0 => "pi".to_owned(),
        part if part > 1.0 && part.fract() == 0.0 => format!("pi/{part}"),
        _ => format!("{degrees}*pi/180"),
    })
}

fn equation_help(at: usize, tokens: &[Token<'_>]) -> &'static str {
    if tokens[..at].iter().any(|token| token.kind == Kind::Equal) {
        "write two equations"
    } else {
        "an expression is wanted here; for an equation `a = b` write `a - b`"
    }
}
