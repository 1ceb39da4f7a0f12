// Faults in the text of one expression.

use dalembert_symbolic::language::{Ast, AstKind, Operator, Span, parse_equation};

/// What was done to an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slip {
    /// `+` for `-` or the reverse.
    Sign,
    /// `cos` for `sin` or the reverse.
    SineCosine,
    /// A term left out.
    Term,
    /// Another factor or exponent.
    Number,
}

/// Every text that differs from this one by one slip; empty where it is no expression.
pub fn slips(text: &str) -> Vec<(Slip, String)> {
    let mut found = Vec::new();
    if let Ok(ast) = parse_equation(text) {
        walk(&ast, text, &mut found);
    }
    found
}

fn walk(ast: &Ast, text: &str, found: &mut Vec<(Slip, String)>) {
    let mut put = |slip, from: usize, to: usize, new: &str| {
        found.push((slip, format!("{}{new}{}", &text[..from], &text[to..])));
    };
    match &ast.kind {
        AstKind::Number(_) => {
            let Span { start, end } = ast.span;
            let (start, end) = (start as usize, end as usize);
            if let Ok(n) = text[start..end].parse::<i64>() {
                put(Slip::Number, start, end, &format!("{}", n + 1));
            }
        }
        AstKind::Name { .. } => {}
        AstKind::Negate(inner) => {
            let start = ast.span.start as usize;
            if text[start..].starts_with('-') {
                put(Slip::Sign, start, start + 1, " ");
            }
            walk(inner, text, found);
        }
        AstKind::Binary(operator, left, right) => {
            let (l, r) = (left.span.range(), right.span.range());
            if let Operator::Add | Operator::Subtract = operator
                && let Some(at) = text[l.end..r.start].find(['+', '-'])
            {
                let at = l.end + at;
                let other = if *operator == Operator::Add { "-" } else { "+" };
                put(Slip::Sign, at, at + 1, other);
                put(Slip::Term, r.start, r.end, &format!("(0*({}))", &text[r.clone()]));
                put(Slip::Term, l.start, l.end, &format!("(0*({}))", &text[l.clone()]));
            }
            if *operator == Operator::Equal {
                put(Slip::Sign, r.start, r.end, &format!("-({})", &text[r.clone()]));
                if text[r.clone()].trim() != "0" {
                    put(Slip::Term, r.start, r.end, &format!("0*({})", &text[r.clone()]));
                }
            }
            walk(left, text, found);
            walk(right, text, found);
        }
        AstKind::Vector(items) => items.iter().for_each(|item| walk(item, text, found)),
        AstKind::Component(inner, _) | AstKind::Sum(inner, _) | AstKind::Integral(inner, _) => {
            walk(inner, text, found);
        }
        AstKind::Call { function, name_span, arguments } => {
            let other = match function.as_str() {
                "sin" => Some("cos"),
                "cos" => Some("sin"),
                _ => None,
            };
            if let Some(other) = other {
                let span = name_span.range();
                put(Slip::SineCosine, span.start, span.end, other);
            }
            arguments.iter().for_each(|argument| walk(argument, text, found));
        }
    }
}
