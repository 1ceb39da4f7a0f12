//! Tokens to trees: a Pratt parser.

use super::cursor::{Parsed, Parser, Reported};
use super::function::{function, is_reserved};
use super::token::{Kind, Token, shorten};
use super::{Ast, AstKind, FRICTION, Operator, Range, SCALAR, Span};
use crate::diagnose::{Problem, catalogue::syntax};

/// Deepest nesting of parentheses, calls, powers and signs; how many terms a sum has does not count.
pub const DEEPEST: u32 = 200;

/// Deepest tree, which bounds the stack of all that walks it.
const DEEPEST_TREE: u32 = 1000;

/// A sum or product of more operands than this becomes a balanced tree instead of a chain.
const LONGEST_CHAIN: usize = 16;

/// Reads an expression.
///
/// # Errors
/// Everything found wrong, with spans into `text` and an empty path; see [`Problem::moved_to`].
pub fn parse(text: &str) -> Result<Ast, Vec<Problem>> {
    let mut parser = Parser::new(text)?;
    let ast = parser.whole(LOOSEST);
    parser.finish(ast)
}

/// Reads an expression or an equation `a = b`, the outermost [`Operator::Equal`].
///
/// # Errors
/// As for [`parse`].
pub fn parse_equation(text: &str) -> Result<Ast, Vec<Problem>> {
    let mut parser = Parser::new(text)?;
    let ast = parser.whole(EQUATION);
    parser.finish(ast)
}

/// Reads `a..b`, as in `draw`'s `{curve: …, s: -2..2}`.
///
/// # Errors
/// As for [`parse`].
pub fn parse_bounds(text: &str) -> Result<(Ast, Ast), Vec<Problem>> {
    let mut parser = Parser::new(text)?;
    let bounds = parser.bounds().and_then(|(from, to)| parser.end().map(|()| (from.ast, to.ast)));
    parser.finish(bounds)
}

/// A tree and its depth.
pub(super) struct Tree {
    pub ast: Ast,
    depth: u32,
}

/// An operator and what follows it.
struct Link {
    operator: Operator,
    sign: Span,
    operand: Tree,
}

/// How tightly an operator binds: those below `least` are left to the caller.
const EQUATION: u8 = 0;
const LOOSEST: u8 = 1;
const NEGATE: u8 = 4;
const POWER: u8 = 5;

fn binding(kind: Kind) -> Option<(u8, Operator)> {
    Some(match kind {
        Kind::Equal => (EQUATION, Operator::Equal),
        Kind::Plus => (2, Operator::Add),
        Kind::Minus => (2, Operator::Subtract),
        Kind::Star => (3, Operator::Multiply),
        Kind::Slash => (3, Operator::Divide),
        Kind::Caret => (POWER, Operator::Power),
        _ => return None,
    })
}

impl<'a> Parser<'a> {
    /// An expression up to the end of the text.
    fn whole(&mut self, least: u8) -> Parsed<Ast> {
        if self.is(Kind::End) {
            return self.report(syntax::empty_expression(self.peek().span.place()));
        }
        let tree = self.expression(least)?;
        self.end()?;
        Ok(tree.ast)
    }

    /// Pratt's loop: an operand, then operators that bind at least as tightly as `least`.
    pub fn expression(&mut self, least: u8) -> Parsed<Tree> {
        self.nesting += 1;
        if self.nesting > DEEPEST {
            let place = self.peek().span.place();
            return self.report(syntax::expression_too_deep(place, DEEPEST));
        }
        let first = self.operand()?;
        let tree = self.chain(first, least)?;
        self.nesting -= 1;
        Ok(tree)
    }

    /// The operators after an operand; a frame of its own, so that parentheses inside each other need less stack.
    fn chain(&mut self, mut first: Tree, least: u8) -> Parsed<Tree> {
        let mut chain = Vec::new();
        let mut tightness = 0;
        while let Some((next, operator)) = binding(self.peek().kind).filter(|(next, _)| *next >= least) {
            if next != tightness {
                // A product, say, that is the first term of a sum.
                first = self.joined(first, std::mem::take(&mut chain))?;
                tightness = next;
            }
            let sign = self.next().span;
            let operand = self.expression(if operator == Operator::Power { POWER } else { next + 1 })?;
            chain.push(Link { operator, sign, operand });
            if operator == Operator::Equal {
                break;
            }
        }
        self.joined(first, chain)
    }

    /// `first + a - b …`, from left to right; a long sum or product as a balanced tree of its parts.
    fn joined(&mut self, first: Tree, mut chain: Vec<Link>) -> Parsed<Tree> {
        if chain.len() < LONGEST_CHAIN {
            return chain.into_iter().try_fold(first, |left, link| self.pair(left, link));
        }
        let mut right = chain.split_off(chain.len() / 2).into_iter();
        let left = self.joined(first, chain)?;
        let Some(Link { operator, sign, operand }) = right.next() else { return Ok(left) };
        // a - (b - c) is a - b + c.
        let inverse = matches!(operator, Operator::Subtract | Operator::Divide);
        let rest = right.map(|link| Link { operator: link.operator.turned(inverse), ..link }).collect();
        let operand = self.joined(operand, rest)?;
        self.pair(left, Link { operator, sign, operand })
    }

    fn pair(&mut self, left: Tree, Link { operator, sign, operand: right }: Link) -> Parsed<Tree> {
        let depth = left.depth.max(right.depth);
        let span = left.ast.span.to(right.ast.span);
        self.tree(AstKind::Binary(operator, Box::new(left.ast), Box::new(right.ast)), span, depth, sign)
    }

    /// One level more, unless that is too deep.
    fn tree(&mut self, kind: AstKind, span: Span, below: u32, at: Span) -> Parsed<Tree> {
        if below >= DEEPEST_TREE {
            return self.report(syntax::expression_too_deep(at.place(), DEEPEST));
        }
        Ok(Tree { ast: Ast { kind, span }, depth: below + 1 })
    }

    /// A value with its sign, and `.x` after it.
    fn operand(&mut self) -> Parsed<Tree> {
        let first = self.peek();
        let mut value = match first.kind {
            Kind::Minus => {
                self.next();
                let inner = self.expression(NEGATE)?;
                let span = first.span.to(inner.ast.span);
                return self.tree(AstKind::Negate(Box::new(inner.ast)), span, inner.depth, first.span);
            }
            Kind::Plus => {
                self.next();
                return self.expression(NEGATE);
            }
            Kind::Number => {
                self.next();
                self.tree(AstKind::Number(first.text.to_owned()), first.span, 0, first.span)?
            }
            Kind::Name => self.name()?,
            Kind::Open => {
                self.next();
                let unit = std::mem::replace(&mut self.before_unit, false);
                let inner = self.expression(LOOSEST);
                self.before_unit = unit;
                let inner = inner?;
                self.close(first, Kind::Close)?;
                Tree { ast: Ast { span: first.span.to(self.before().span), ..inner.ast }, ..inner }
            }
            Kind::OpenBracket => self.vector()?,
            _ => return self.unexpected("a value"),
        };
        while self.is(Kind::Dot) {
            value = self.component(value)?;
        }
        Ok(value)
    }

    fn component(&mut self, of: Tree) -> Parsed<Tree> {
        let dot = self.next();
        let name = self.peek();
        let which = match name.text {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            "friction" => FRICTION,
            "w" if matches!(&of.ast.kind, AstKind::Call { function, .. } if function == "quaternion") => SCALAR,
            text if name.kind == Kind::Name => {
                let problem = syntax::unknown_component(name.span.place(), shorten(text));
                return self.report(problem);
            }
            _ => return self.unexpected("`x`, `y` or `z` after the point"),
        };
        self.next();
        let span = of.ast.span.to(name.span);
        self.tree(AstKind::Component(Box::new(of.ast), which), span, of.depth, dot.span)
    }

    fn vector(&mut self) -> Parsed<Tree> {
        let open = self.next();
        let (items, depth) = self.list(open, Kind::CloseBracket)?;
        let span = open.span.to(self.before().span);
        if !(2..=3).contains(&items.len()) {
            return self.report(syntax::vector_components(span.place(), items.len()));
        }
        self.tree(AstKind::Vector(items), span, depth, open.span)
    }

    /// A name with indices and primes, or a call.
    fn name(&mut self) -> Parsed<Tree> {
        let name = self.next();
        let known = function(name.text).is_some();
        let touches = self.peek().span.start == name.span.end;
        if self.is(Kind::Open) && (known || touches || !self.before_unit) {
            return self.call(name);
        }
        if known && is_reserved(name.text) {
            let help = format!("write `{}(…)`", name.text);
            let next = self.peek();
            if matches!(next.kind, Kind::Name | Kind::Number) {
                let help = format!("did you mean `{}({})`?", name.text, shorten(next.text));
                let problem = syntax::missing_operator(next.span.place(), name.text, shorten(next.text), help);
                return self.report(problem);
            }
            let mut problem = syntax::unexpected(next.span.place(), next.shown(), "`(` after a function's name");
            problem.help = help;
            return self.report(problem);
        }
        if name.text == "in" {
            let problem = syntax::unexpected(name.span.place(), "`in`", "a value");
            return self.report(problem);
        }
        let (indices, depth) = if self.is(Kind::OpenBracket) {
            let open = self.next();
            self.list(open, Kind::CloseBracket)?
        } else {
            (Vec::new(), 0)
        };
        let primes = self.primes(name)?;
        if primes > 0 && self.is(Kind::OpenBracket) {
            let mut problem = syntax::unexpected(self.peek().span.place(), "`[`", "an operator");
            problem.help = format!("the index comes before the prime: `{}[…]'`", shorten(name.text));
            return self.report(problem);
        }
        let span = name.span.to(self.before().span);
        let kind = AstKind::Name { name: name.text.to_owned(), indices, primes };
        self.tree(kind, span, depth, name.span)
    }

    pub fn primes(&mut self, name: Token<'_>) -> Parsed<u8> {
        let first = self.peek().span;
        let mut primes = 0;
        while self.takes(Kind::Prime) {
            primes += 1;
        }
        match u8::try_from(primes) {
            Ok(primes @ 0..=2) => Ok(primes),
            _ => {
                let span = first.to(self.before().span);
                self.report(syntax::too_many_primes(span.place(), shorten(name.text)))
            }
        }
    }

    fn call(&mut self, name: Token<'a>) -> Parsed<Tree> {
        let unit = std::mem::replace(&mut self.before_unit, false);
        let result = match name.text {
            "sum" | "integral" => self.over_ranges(name),
            _ => self.plain_call(name),
        };
        self.before_unit = unit;
        result
    }

    fn plain_call(&mut self, name: Token<'a>) -> Parsed<Tree> {
        let open = self.next();
        let (arguments, depth) = if self.takes(Kind::Close) { (Vec::new(), 0) } else { self.list(open, Kind::Close)? };
        let span = name.span.to(self.before().span);
        let kind = AstKind::Call { function: name.text.to_owned(), name_span: name.span, arguments };
        self.tree(kind, span, depth, name.span)
    }

    /// `sum(e, i in a..b, …)` and `integral(e, x in a..b)`.
    fn over_ranges(&mut self, name: Token<'a>) -> Parsed<Tree> {
        let open = self.next();
        let body = self.expression(LOOSEST)?;
        let mut ranges = Vec::new();
        let mut depth = body.depth;
        while self.takes(Kind::Comma) {
            let (range, below) = self.range()?;
            depth = depth.max(below);
            ranges.push(range);
            if name.text == "integral" {
                break;
            }
        }
        if ranges.is_empty() {
            let problem = syntax::bad_range(self.peek().span.place(), self.peek().shown());
            return self.report(problem);
        }
        self.close(open, Kind::Close)?;
        let span = name.span.to(self.before().span);
        let body = Box::new(body.ast);
        let kind = match (name.text, ranges.pop()) {
            ("integral", Some(range)) => AstKind::Integral(body, Box::new(range)),
            (_, last) => AstKind::Sum(body, ranges.into_iter().chain(last).collect()),
        };
        self.tree(kind, span, depth, name.span)
    }

    /// `i in a..b` with its depth.
    pub fn range(&mut self) -> Parsed<(Range, u32)> {
        let name = self.peek();
        let is_name = name.kind == Kind::Name && name.text != "in";
        if !is_name || self.after().text != "in" {
            let wrong = if is_name { self.after() } else { name };
            return self.report(syntax::bad_range(wrong.span.place(), wrong.shown()));
        }
        self.next();
        self.next();
        let (from, to) = self.bounds()?;
        let depth = from.depth.max(to.depth);
        Ok((Range { name: name.text.to_owned(), name_span: name.span, from: from.ast, to: to.ast }, depth))
    }

    /// `a..b`
    fn bounds(&mut self) -> Parsed<(Tree, Tree)> {
        let from = self.expression(LOOSEST)?;
        if !self.takes(Kind::Dots) {
            return self.unexpected("`..` and the last value of the range");
        }
        Ok((from, self.expression(LOOSEST)?))
    }

    /// Whether a range `i in …` starts here.
    pub fn at_range(&self) -> bool {
        self.is(Kind::Name) && self.after().text == "in"
    }

    /// Expressions up to the closing bracket, with the largest depth.  One that is wrong does not hide the next.
    fn list(&mut self, open: Token<'a>, closing: Kind) -> Parsed<(Vec<Ast>, u32)> {
        let unit = std::mem::replace(&mut self.before_unit, false);
        let result = self.items(open, closing);
        self.before_unit = unit;
        result
    }

    fn items(&mut self, open: Token<'a>, closing: Kind) -> Parsed<(Vec<Ast>, u32)> {
        let nesting = self.nesting;
        let mut items = Vec::new();
        let mut depth = 0;
        let mut failed = false;
        loop {
            let start = self.at;
            match self.item(open, closing) {
                Ok(tree) => {
                    depth = depth.max(tree.depth);
                    items.push(tree.ast);
                }
                Err(Reported) => {
                    failed = true;
                    self.nesting = nesting;
                    self.at = start;
                    self.skip_item();
                }
            }
            if self.is_full() || !self.takes(Kind::Comma) {
                break;
            }
        }
        if failed {
            self.takes(closing);
            return Err(Reported);
        }
        self.close(open, closing)?;
        Ok((items, depth))
    }

    fn item(&mut self, open: Token<'a>, closing: Kind) -> Parsed<Tree> {
        let tree = self.expression(LOOSEST)?;
        if !self.is(Kind::Comma) && !self.is(closing) {
            self.not_closed::<()>(open, closing)?;
        }
        Ok(tree)
    }

    /// Goes on to the comma or closing bracket that ends this item.
    fn skip_item(&mut self) {
        let mut open = 0_usize;
        loop {
            match self.peek().kind {
                Kind::End => return,
                Kind::Comma if open == 0 => return,
                Kind::Close | Kind::CloseBracket if open == 0 => return,
                Kind::Close | Kind::CloseBracket => open -= 1,
                Kind::Open | Kind::OpenBracket => open += 1,
                _ => {}
            }
            self.next();
        }
    }
}
