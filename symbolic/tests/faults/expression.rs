// Faults in the text of one expression.

use dalembert_symbolic::language::{Ast, AstKind, Operator, parse_equation};

/// What was done to an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slip {
    /// `+` for `-` or the reverse.
    Sign,
    /// `cos` for `sin` or the reverse.
    SineCosine,
    /// A term left out.
    Term,
    /// Another number or exponent.
    Number,
    /// A coefficient doubled, a factor or divisor left out.
    Factor,
    /// Another body or point.
    Point,
    /// A cross product left out, or its factors in the other order.
    Cross,
    /// `velocity` for `acceleration` or the reverse.
    Velocity,
    /// A prime left out.
    Prime,
    /// `rate` left out.
    Rate,
    /// A term times 1.000001.
    Slight,
}

impl Slip {
    /// What is wrong, as a kind of fault.
    pub fn words(self) -> &'static str {
        match self {
            Slip::Sign => "a sign",
            Slip::SineCosine => "sine and cosine",
            Slip::Term => "a term",
            Slip::Number => "a number",
            Slip::Factor => "a factor",
            Slip::Point => "another body or point",
            Slip::Cross => "a cross product",
            Slip::Velocity => "velocity and acceleration",
            Slip::Prime => "a prime",
            Slip::Rate => "a rate",
            Slip::Slight => "off by 1e-6",
        }
    }

    /// Whether identities are tried with it too.
    pub fn plain(self) -> bool {
        matches!(self, Slip::Sign | Slip::SineCosine | Slip::Term | Slip::Number | Slip::Slight)
    }
}

/// Every text that differs from this one by one slip; empty where it is no expression.  `points` are names of points
/// and bodies to take for one another.
pub fn slips(text: &str, points: &[String]) -> Vec<(Slip, String)> {
    let mut walk = Walk { text, points, found: Vec::new() };
    if let Ok(ast) = parse_equation(text) {
        walk.visit(&ast);
    }
    walk.found
}

struct Walk<'a> {
    text: &'a str,
    points: &'a [String],
    found: Vec<(Slip, String)>,
}

impl Walk<'_> {
    fn put(&mut self, slip: Slip, span: std::ops::Range<usize>, new: &str) {
        self.found.push((slip, format!("{}{new}{}", &self.text[..span.start], &self.text[span.end..])));
    }

    fn visit(&mut self, ast: &Ast) {
        let text = self.text;
        let span = ast.span.range();
        match &ast.kind {
            AstKind::Number(_) => {
                if let Ok(n) = text[span.clone()].parse::<i64>() {
                    self.put(Slip::Number, span, &format!("{}", n + 1));
                }
            }
            AstKind::Name { name, primes, .. } => self.name(&text[span.clone()], name, *primes, span),
            AstKind::Negate(inner) => {
                if text[span.clone()].starts_with('-') {
                    self.put(Slip::Sign, span.start..span.start + 1, " ");
                }
                self.visit(inner);
            }
            AstKind::Binary(operator, left, right) => self.binary(*operator, left, right),
            AstKind::Vector(items) => items.iter().for_each(|item| self.visit(item)),
            AstKind::Component(inner, _) | AstKind::Sum(inner, _) | AstKind::Integral(inner, _) => self.visit(inner),
            AstKind::Call { function, name_span, arguments } => {
                self.call(function, name_span.range(), span, arguments);
                arguments.iter().for_each(|argument| self.visit(argument));
            }
        }
    }

    fn name(&mut self, word: &str, name: &str, primes: u8, span: std::ops::Range<usize>) {
        let family = |point: &String| point.split('[').next() == Some(name);
        if self.points.iter().any(family) {
            for other in self.points.iter().filter(|point| *point != word) {
                self.put(Slip::Point, span.clone(), other);
            }
        } else {
            self.put(Slip::Factor, span.clone(), &format!("(2*{word})"));
        }
        if primes > 0 {
            self.put(Slip::Prime, span.end - 1..span.end, "");
        }
    }

    fn binary(&mut self, operator: Operator, left: &Ast, right: &Ast) {
        let text = self.text;
        let (l, r) = (left.span.range(), right.span.range());
        match operator {
            Operator::Add | Operator::Subtract => {
                if let Some(at) = text[l.end..r.start].find(['+', '-']) {
                    let at = l.end + at;
                    let other = if operator == Operator::Add { "-" } else { "+" };
                    self.put(Slip::Sign, at..at + 1, other);
                    self.put(Slip::Term, r.clone(), &format!("(0*({}))", &text[r.clone()]));
                    self.put(Slip::Term, l.clone(), &format!("(0*({}))", &text[l.clone()]));
                    self.put(Slip::Slight, r.clone(), &format!("(1.000001*({}))", &text[r.clone()]));
                }
            }
            Operator::Equal => {
                self.put(Slip::Sign, r.clone(), &format!("-({})", &text[r.clone()]));
                if text[r.clone()].trim() != "0" {
                    self.put(Slip::Term, r.clone(), &format!("0*({})", &text[r.clone()]));
                    self.put(Slip::Slight, r.clone(), &format!("1.000001*({})", &text[r.clone()]));
                }
            }
            Operator::Multiply => {
                self.put(Slip::Factor, l.start..r.end, &text[l.clone()]);
                self.put(Slip::Factor, l.start..r.end, &text[r.clone()]);
            }
            Operator::Divide => self.put(Slip::Factor, l.start..r.end, &text[l.clone()]),
            Operator::Power => {}
        }
        self.visit(left);
        self.visit(right);
    }

    fn call(&mut self, function: &str, name: std::ops::Range<usize>, whole: std::ops::Range<usize>, of: &[Ast]) {
        let text = self.text;
        let words: Vec<&str> = of.iter().map(|argument| &text[argument.span.range()]).collect();
        match (function, words.as_slice()) {
            ("sin", _) => self.put(Slip::SineCosine, name, "cos"),
            ("cos", _) => self.put(Slip::SineCosine, name, "sin"),
            ("velocity", _) => self.put(Slip::Velocity, name, "acceleration"),
            ("acceleration", _) => self.put(Slip::Velocity, name, "velocity"),
            ("rate", [inner]) => self.put(Slip::Rate, whole, &format!("({inner})")),
            ("cross", [a, b]) => {
                self.put(Slip::Cross, whole.clone(), &format!("cross({b}, {a})"));
                self.put(Slip::Cross, whole, &format!("(0*cross({a}, {b}))"));
            }
            _ => {}
        }
    }
}
