//! From syntax to values: numbers, names, operators, sums and integrals.

use super::builder::ExprBuilder;
use super::dimension::Measure;
use super::facts::Depends;
use super::index::{self, Indices, Refusal};
use super::integral::{Over, integral};
use super::rules::Rules;
use super::scope::{Scope, Section};
use super::value::{self, Value};
use crate::diagnose::catalogue::{memory, names, states, syntax};
use crate::diagnose::{Place, Problem, nearest, rate_meant};
use crate::expr::{DoubleDouble, Id, Rational, Symbol};
use crate::file::Text;
use crate::language::{Ast, AstKind, Operator, Range, Span, function, is_reserved};

/// What a name means inside one expression only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Local {
    /// An index.
    Integer(i64),
    /// A bound variable with its unit: the dummy of an integral, a spring's `length`, a curve's parameter.
    Symbol(Symbol, Measure),
}

/// One expression on its way from syntax to a value.
pub struct Lower<'a> {
    pub(super) builder: &'a mut ExprBuilder,
    pub(super) scope: &'a Scope,
    pub(super) text: &'a Text,
    pub(super) rules: Rules,
    pub(super) locals: Vec<(String, Local)>,
}

/// Largest exponent that is unrolled.
const LARGEST_POWER: i64 = 64;

/// Nodes that a graph may have.
const NODE_LIMIT: u32 = 1_000_000;

impl<'a> Lower<'a> {
    /// With indices and bound variables.
    pub fn new(
        builder: &'a mut ExprBuilder,
        scope: &'a Scope,
        text: &'a Text,
        rules: Rules,
        locals: &[(String, Local)],
    ) -> Self {
        Lower { builder, scope, text, rules, locals: locals.to_vec() }
    }

    /// Both sides of `a = b`, or one value.
    pub fn equation(&mut self, ast: &Ast) -> (Value, Option<Value>) {
        let AstKind::Binary(Operator::Equal, left, right) = &ast.kind else { return (self.measured(ast), None) };
        let before = self.builder.problems.len();
        let sides = [self.expression(left), self.expression(right)];
        self.take_measure(ast, before, &sides);
        let [left, right] = sides;
        (left, Some(right))
    }

    /// The value, and in the builder its unit.
    pub fn measured(&mut self, ast: &Ast) -> Value {
        let before = self.builder.problems.len();
        let value = self.expression(ast);
        self.take_measure(ast, before, std::slice::from_ref(&value));
        value
    }

    /// The unit of what was found to have these values without problems.
    fn take_measure(&mut self, ast: &Ast, before: usize, values: &[Value]) {
        let sound = self.builder.problems.len() == before && self.builder.needs.is_empty();
        if !sound || values.contains(&Value::Poison) {
            self.builder.measured = Measure::Unknown;
            return;
        }
        self.builder.measured = self.measure(ast);
    }

    /// The value; the syntax tree is at most 1000 levels deep.
    pub fn expression(&mut self, ast: &Ast) -> Value {
        if !self.builder.spend(1, &self.text.place) {
            return Value::Poison;
        }
        match &ast.kind {
            AstKind::Number(text) => self.number(text, ast.span),
            AstKind::Name { name, indices, primes } => {
                let value = self.name(name, indices, *primes, ast.span);
                self.admit(value, ast.span)
            }
            AstKind::Negate(inner) => {
                let value = self.expression(inner);
                let negated = value.map(|x| self.builder.graph.neg(x));
                let ExprBuilder { graph, along, .. } = &mut *self.builder;
                along.mapped(graph, [value.components(), negated.components()], |graph, x| graph.neg(x));
                negated
            }
            AstKind::Binary(operator, left, right) => {
                let left = self.expression(left);
                let right_value = self.expression(right);
                let value = self.binary(*operator, left, right_value, ast, right);
                self.admit(value, ast.span)
            }
            AstKind::Vector(parts) => self.bracket(parts, ast.span),
            AstKind::Component(of, axis) => self.component(of, *axis, ast.span),
            AstKind::Call { function, name_span, arguments } => {
                let value = self.call(function, *name_span, arguments, ast.span);
                self.admit(value, ast.span)
            }
            AstKind::Sum(body, ranges) => self.sum(body, ranges),
            AstKind::Integral(body, range) => self.integral(body, range),
        }
    }

    /// Reports a problem; the value is lost.
    pub fn refuse(&mut self, problem: Problem) -> Value {
        self.builder.problems.push(problem);
        Value::Poison
    }

    /// Reports why there is no integer; the value is lost.
    pub(super) fn told(&mut self, refusal: Refusal) -> Value {
        self.builder.told(refusal);
        Value::Poison
    }

    /// Some words of this expression, as a place.
    pub(super) fn place(&self, span: Span) -> Place {
        self.text.place.at(span)
    }

    /// The value, unless it depends on what this expression may not depend on.
    pub(super) fn admit(&mut self, value: Value, span: Span) -> Value {
        let depends = self.builder.depends(value.components());
        if !depends.meets(self.rules.refused) {
            return value;
        }
        let refused = self.rules.refused;
        let (place, words, what) = (self.place(span), self.text.words(span), self.rules.what);
        let acceleration = Depends::ACCELERATION.and(Depends::JERK);
        let fixed = refused.meets(Depends::COORDINATE);
        let motion = Depends::COORDINATE.and(Depends::VELOCITY).and(acceleration);
        let both = |kind: Depends| depends.meets(kind) && refused.meets(kind);
        let of_rate = what == super::rules::RATE_OF_STATE;
        let problem = if both(Depends::MEMORY) {
            memory::memory_misplaced(place, words, what)
        } else if of_rate && depends.meets(acceleration.and(Depends::MULTIPLIER).and(Depends::BEYOND_LINEAR)) {
            states::rate_of_solved(place, words)
        } else if both(Depends::STATE_RATE) {
            states::state_rate_misplaced(place, words, what)
        } else if both(Depends::STATE) {
            states::state_misplaced(place, words, what)
        } else if both(Depends::MULTIPLIER) {
            names::reaction_misplaced(place, words, what)
        } else if both(Depends::BEYOND_LINEAR) {
            names::nonlinear_reaction(place, words, what)
        } else if both(Depends::SWITCH) {
            names::switch_misplaced(place, words, what)
        } else if fixed && depends.meets(motion) {
            names::coordinate_misplaced(place, words, what)
        } else if depends.meets(acceleration) && refused.meets(acceleration) {
            names::acceleration_misplaced(place, words, what)
        } else if depends.meets(Depends::VELOCITY) && refused.meets(Depends::VELOCITY) {
            names::velocity_misplaced(place, words, what)
        } else {
            names::time_misplaced(place, what)
        };
        self.refuse(problem)
    }

    fn number(&mut self, text: &str, span: Span) -> Value {
        match Rational::from_decimal(text) {
            Some(exact) => Value::Scalar(self.builder.graph.rational(exact)),
            None => match DoubleDouble::from_decimal(text) {
                Some(x) => Value::Scalar(self.builder.graph.double_double(x)),
                None => {
                    let place = self.place(span);
                    self.refuse(syntax::bad_number(place, text))
                }
            },
        }
    }

    fn bracket(&mut self, parts: &[Ast], span: Span) -> Value {
        let mut components = Vec::new();
        let mut lost = false;
        for part in parts {
            match self.expression(part) {
                Value::Scalar(x) => components.push(x),
                Value::Nothing => components.push(Id::ZERO),
                Value::Poison | Value::Orientation(_) => lost = true,
                found @ Value::Vector(_) => {
                    let place = self.place(part.span);
                    self.refuse(names::not_a_scalar(place, found.describe()));
                    lost = true;
                }
            }
        }
        if parts.len() != self.scope.dimension {
            let place = self.place(span);
            return self.refuse(names::vector_size(place, self.scope.dimension, parts.len()));
        }
        if lost { Value::Poison } else { Value::Vector(components) }
    }

    fn binary(&mut self, operator: Operator, left: Value, right: Value, whole: &Ast, divisor: &Ast) -> Value {
        let graph = &mut self.builder.graph;
        let joined = match operator {
            Operator::Add => value::add(graph, &left, &right, false),
            Operator::Subtract => value::add(graph, &left, &right, true),
            Operator::Multiply => value::multiply(graph, &left, &right),
            Operator::Divide => match &right {
                Value::Poison | Value::Orientation(_) => Some(Value::Poison),
                Value::Scalar(Id::ZERO) | Value::Nothing => {
                    let words = self.text.words(whole.span);
                    return self.refuse(names::undefined_value(self.place(divisor.span), words));
                }
                Value::Scalar(y) => Some(left.map(|x| graph.div(x, *y))),
                Value::Vector(_) => None,
            },
            Operator::Power => return self.power(left, right, whole),
            Operator::Equal => {
                let help = "an equation may stand in `checks`; here write an expression";
                return self.refuse(syntax::equation_misplaced(self.place(whole.span), help));
            }
        };
        if let Some(value) = joined {
            self.note_along(operator, [&left, &right, &value]);
            return value;
        }
        let place = self.place(whole.span);
        let problem = match (operator, &left, &right) {
            (Operator::Add | Operator::Subtract, Value::Vector(a), Value::Vector(b)) => {
                names::vector_size(self.place(divisor.span), a.len(), b.len())
            }
            _ => {
                let sign = match operator {
                    Operator::Add => "+",
                    Operator::Subtract => "-",
                    Operator::Multiply => "*",
                    _ => "/",
                };
                let mut problem = names::mixed_kinds(place, sign, left.describe(), right.describe());
                if operator == Operator::Multiply {
                    problem.help = "use `dot(…, …)` or `cross(…, …)`".to_owned();
                }
                problem
            }
        };
        self.refuse(problem)
    }

    /// Remembers along which frames a vector is written.
    fn note_along(&mut self, operator: Operator, [left, right, value]: [&Value; 3]) {
        let ExprBuilder { graph, along, .. } = &mut *self.builder;
        match (operator, left, right, value) {
            (Operator::Add | Operator::Subtract, Value::Vector(a), Value::Vector(b), Value::Vector(sum)) => {
                along.sum(graph, [a, b, sum], operator == Operator::Subtract);
            }
            (Operator::Multiply, Value::Scalar(s), Value::Vector(from), Value::Vector(to))
            | (Operator::Multiply, Value::Vector(from), Value::Scalar(s), Value::Vector(to)) => {
                along.mapped(graph, [from, to], |graph, x| graph.mul(*s, x));
            }
            (Operator::Divide, Value::Vector(from), Value::Scalar(s), Value::Vector(to)) => {
                along.mapped(graph, [from, to], |graph, x| graph.div(x, *s));
            }
            _ => {}
        }
    }

    fn power(&mut self, base: Value, exponent: Value, whole: &Ast) -> Value {
        let (x, y) = match (&base, &exponent) {
            (Value::Poison, _) | (_, Value::Poison) => return Value::Poison,
            (Value::Vector(_), _) | (_, Value::Vector(_)) => {
                let place = self.place(whole.span);
                let mut problem = names::mixed_kinds(place, "^", base.describe(), exponent.describe());
                problem.help = "the square of a vector is `dot(a, a)`".to_owned();
                return self.refuse(problem);
            }
            (x, y) => {
                let first = |v: &Value| v.components().first().copied().unwrap_or(Id::ZERO);
                (first(x), first(y))
            }
        };
        let graph = &mut self.builder.graph;
        let exponent = graph.number(y).map(crate::expr::Number::to_f64);
        if let Some(n) = exponent
            && n.fract() == 0.0
            && n.abs() > LARGEST_POWER as f64
            && graph.number(x).is_none()
        {
            return self.refuse(names::power_too_large(self.place(whole.span), n, LARGEST_POWER));
        }
        let undefined = match graph.number(x).map(crate::expr::Number::to_f64) {
            Some(0.0) => exponent.is_some_and(|n| n < 0.0),
            Some(base) if base < 0.0 => exponent.is_some_and(|n| n.fract() != 0.0),
            _ => false,
        };
        if undefined {
            let words = self.text.words(whole.span);
            return self.refuse(names::undefined_value(self.place(whole.span), words));
        }
        Value::Scalar(self.builder.graph.pow(x, y))
    }

    /// Checks the name of an index or dummy; false when it hides a name.
    fn fresh(&mut self, name: &str, span: Span) -> bool {
        let hides = self.scope.names.contains_key(name)
            || is_reserved(name)
            || self.locals.iter().any(|(local, _)| local == name);
        if hides {
            let place = self.place(span);
            self.refuse(names::index_hides_name(place, name));
        }
        !hides
    }

    fn sum(&mut self, body: &Ast, ranges: &[Range]) -> Value {
        let known = self.locals.len();
        let mut fresh = true;
        for range in ranges {
            // Two ranges of one sum must not share a name either.
            fresh &= self.fresh(&range.name, range.name_span);
            self.locals.push((range.name.clone(), Local::Integer(0)));
        }
        let total = if fresh { self.terms(body, ranges, known) } else { Value::Poison };
        self.locals.truncate(known);
        total
    }

    /// The sum over all values of the ranges, whose names are local from `known` on.
    fn terms(&mut self, body: &Ast, ranges: &[Range], known: usize) -> Value {
        let mut outer = self.locals[..known].to_vec();
        let indices = Indices::within(self.scope, self.text);
        let members = match index::members(&indices, self.builder, &mut outer, ranges) {
            Ok(members) => members,
            Err(Refusal::Problem(problem)) if problem.code == "E223" => {
                return self.refuse(names::too_many_nodes(problem.place, NODE_LIMIT));
            }
            Err(refusal) => return self.told(refusal),
        };
        let mut total = Value::Nothing;
        let known_problems = self.builder.problems.len();
        for member in members {
            for (local, value) in self.locals[known..].iter_mut().zip(member) {
                local.1 = Local::Integer(value);
            }
            let term = self.expression(body);
            total = match value::add(&mut self.builder.graph, &total, &term, false) {
                Some(value) => {
                    self.note_along(Operator::Add, [&total, &term, &value]);
                    value
                }
                None => return Value::Poison,
            };
            // A mistake in the terms is told once.
            if self.builder.exhausted() || self.builder.problems.len() > known_problems {
                return Value::Poison;
            }
        }
        total
    }

    /// ∫ e dx.
    fn integral(&mut self, body: &Ast, range: &Range) -> Value {
        let ends = [self.expression(&range.from), self.expression(&range.to)];
        if !self.fresh(&range.name, range.name_span) {
            return Value::Poison;
        }
        let known = self.locals.len();
        let symbol = Symbol::Dummy(known as u32);
        self.locals.push((range.name.clone(), Local::Symbol(symbol, Measure::Unknown)));
        let integrand = self.expression(body);
        self.locals.truncate(known);
        let mut limits = [Id::ZERO; 2];
        for ((end, limit), ast) in ends.iter().zip(&mut limits).zip([&range.from, &range.to]) {
            match end {
                Value::Scalar(x) => *limit = *x,
                Value::Nothing => {}
                Value::Poison | Value::Orientation(_) => return Value::Poison,
                Value::Vector(_) => {
                    let place = self.place(ast.span);
                    return self.refuse(names::not_a_scalar(place, end.describe()));
                }
            }
        }
        let (text, builder) = (self.text, &mut *self.builder);
        let over = Over { symbol, limits };
        integrand.map(|e| integral(builder, e, over, text.words(body.span), &text.place.at(body.span)))
    }

    /// Whether a name is of a kind that is not refused where the expression stands.
    fn may_stand_here(&self, name: &str) -> bool {
        let kind = match self.scope.names.get(name).map(|entry| entry.section) {
            None if name == "t" => Depends::TIME,
            Some(Section::Coordinate) => Depends::COORDINATE,
            Some(Section::State) => Depends::STATE,
            Some(Section::Memory | Section::Noise) => Depends::MEMORY,
            Some(Section::Input) => Depends::INPUT,
            _ => return true,
        };
        !self.rules.refused.meets(kind)
    }

    /// A name that means nothing here.
    pub(super) fn unknown(&mut self, name: &str, span: Span) -> Value {
        let locals = self.locals.iter().map(|(local, _)| local.as_str());
        let energies = ["energy", "kinetic_energy", "potential_energy"].into_iter().filter(|_| self.rules.energy);
        let known = self.scope.candidates().chain(locals).chain(energies).filter(|known| self.may_stand_here(known));
        let near = nearest(name, known);
        if near.and_then(|near| self.scope.names.get(near)).is_some_and(|entry| entry.refused) {
            // It is meant, and told of already.
            return Value::Poison;
        }
        let known = match near {
            Some(near) if function(near).is_some() => format!("did you mean `{near}(…)`?"),
            Some(near) => format!("did you mean `{near}`?"),
            None if matches!(name, "x" | "y" | "z") => format!("an axis of the ground is `ground.{name}`"),
            None => String::new(),
        };
        // A rate that may not stand here is not proposed, and nothing that is written like its name either.
        let help = match rate_meant(name, self.scope.moving()) {
            Some(_) if self.rules.refused.meets(Depends::VELOCITY) => String::new(),
            Some(rate) => rate,
            None => known,
        };
        let problem = names::unknown_name(self.place(span), name, help);
        self.refuse(problem)
    }
}
