//! The terms of a written-out equation, so that a wrong one can be named.

use std::ops::Range;
use std::rc::Rc;

use super::families::Locals;
use super::rules::Rules;
use super::value::Value;
use crate::expr::vectors;
use crate::file::Text;
use crate::language::{Ast, AstKind, Operator};
use crate::model::resolved::Part;
use crate::model::resolver::Resolver;

/// An equation with more terms than this is left in its two sides.
const MOST: usize = 30;

/// A term: whether it counts negative, what it is, and in words.
type Term = (bool, Ast, String);

impl Resolver<'_> {
    /// What is added up in an equation whose sides have `size` components, left less right, and the products that are several of
    /// these terms; nothing where there is but one term or too many.
    pub fn terms(&mut self, text: &Text, size: usize, locals: &Locals) -> (Vec<Part>, Vec<(String, Range<usize>)>) {
        let mut summands = Vec::new();
        sum(&text.ast, &text.source, false, &mut summands);
        let apart = |(minus, ast, _): &Term| {
            let mut terms = Vec::new();
            split(ast, &text.source, *minus, &mut terms);
            terms
        };
        let terms: Vec<Vec<Term>> = summands.iter().map(apart).collect();
        if !(2..=MOST).contains(&terms.iter().map(Vec::len).sum::<usize>()) {
            return Default::default();
        }
        let before = self.builder.problems.len();
        let (mut parts, mut products) = (Vec::new(), Vec::new());
        for (terms, (_, _, whole)) in terms.into_iter().zip(summands) {
            let first = parts.len();
            for (minus, ast, words) in terms {
                let term =
                    Text { source: text.source.clone(), ast: Rc::new(ast), unit: None, place: text.place.clone() };
                let found = self.builder.equation(&self.scope, &term, Rules::anything("a check").tested(), locals).0;
                let value = match found {
                    Value::Scalar(x) if size == 1 => vec![x],
                    Value::Vector(v) if v.len() == size => v,
                    // A zero that stands for a vector.
                    Value::Scalar(crate::expr::Id::ZERO) | Value::Nothing => continue,
                    _ => {
                        self.builder.problems.truncate(before);
                        return Default::default();
                    }
                };
                let value = if minus { vectors::negative(&mut self.builder.graph, &value) } else { value };
                parts.push(Part { name: format!("`{words}`"), value });
            }
            if parts.len() > first + 1 {
                products.push((format!("`{whole}`"), first..parts.len()));
            }
        }
        if self.builder.problems.len() > before {
            self.builder.problems.truncate(before);
            return Default::default();
        }
        (parts, products)
    }
}

/// The summands of both sides of an equation.
fn sum(ast: &Ast, source: &str, minus: bool, found: &mut Vec<Term>) {
    match &ast.kind {
        AstKind::Binary(operator @ (Operator::Add | Operator::Subtract | Operator::Equal), left, right) => {
            sum(left, source, minus, found);
            sum(right, source, minus != (*operator != Operator::Add), found);
        }
        AstKind::Negate(inner) => sum(inner, source, !minus, found),
        _ => found.push((minus, ast.clone(), source[ast.span.range()].to_owned())),
    }
}

/// Takes sums apart, also under what is linear: factors, divisors, `cross`, `dot` and `rate`.
fn split(ast: &Ast, source: &str, minus: bool, found: &mut Vec<Term>) {
    let words = |ast: &Ast| source[ast.span.range()].to_owned();
    match &ast.kind {
        AstKind::Binary(operator @ (Operator::Add | Operator::Subtract | Operator::Equal), left, right) => {
            split(left, source, minus, found);
            split(right, source, minus != (*operator != Operator::Add), found);
        }
        AstKind::Negate(inner) => split(inner, source, !minus, found),
        AstKind::Binary(operator @ (Operator::Multiply | Operator::Divide), left, right) => {
            let multiply = *operator == Operator::Multiply;
            let sign = if multiply { "*" } else { "/" };
            let (first, second) = (split_into_terms(left, source), split_into_terms(right, source));
            let second = if multiply { second } else { vec![(false, (**right).clone(), words(right))] };
            if first.len() * second.len() == 1 {
                return found.push((minus, ast.clone(), words(ast)));
            }
            for (a_minus, a, a_words) in &first {
                for (b_minus, b, b_words) in &second {
                    let kind = AstKind::Binary(*operator, Box::new(a.clone()), Box::new(b.clone()));
                    let term = Ast { kind, span: ast.span };
                    found.push((minus != (a_minus != b_minus), term, format!("{a_words}{sign}{b_words}")));
                }
            }
        }
        AstKind::Call { function, name_span, arguments } if matches!(function.as_str(), "cross" | "dot" | "rate") => {
            let split: Vec<Vec<Term>> = arguments.iter().map(|argument| split_into_terms(argument, source)).collect();
            let choices = match split.as_slice() {
                [a] => a.iter().map(|a| vec![a]).collect(),
                [a, b] => a.iter().flat_map(|a| b.iter().map(move |b| vec![a, b])).collect(),
                _ => Vec::new(),
            };
            if choices.len() <= 1 {
                return found.push((minus, ast.clone(), words(ast)));
            }
            for choice in choices {
                let arguments = choice.iter().map(|c| c.1.clone()).collect();
                let kind = AstKind::Call { function: function.clone(), name_span: *name_span, arguments };
                let listed: Vec<&str> = choice.iter().map(|c| c.2.as_str()).collect();
                let negative = choice.iter().filter(|c| c.0).count() % 2 == 1;
                let term = Ast { kind, span: ast.span };
                found.push((minus != negative, term, format!("{function}({})", listed.join(", "))));
            }
        }
        _ => found.push((minus, ast.clone(), words(ast))),
    }
}

/// The terms of a factor or argument; itself where it is none or too many.
fn split_into_terms(ast: &Ast, source: &str) -> Vec<Term> {
    let mut terms = Vec::new();
    split(ast, source, false, &mut terms);
    if terms.len() > MOST { vec![(false, ast.clone(), source[ast.span.range()].to_owned())] } else { terms }
}
