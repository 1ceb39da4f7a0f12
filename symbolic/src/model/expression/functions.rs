//! Calls of the built-in functions.

use super::facts::Depends;
use super::index::{self, Indices};
use super::lower::{Local, Lower};
use super::names::Solid;
use super::scope::{Member, Section, TableKind};
use super::value::Value;
use crate::diagnose::catalogue::{mechanics, names, states};
use crate::diagnose::did_you_mean;
use crate::expr::{Binary, Id, Scalar, Symbol, Unary, vectors};
use crate::language::{Ast, AstKind, FUNCTIONS, Span, at_another_time, function, lag, written_here};
use crate::number::DoubleDouble;

impl Lower<'_> {
    /// The value of `name(arguments)`.
    pub(super) fn call(&mut self, name: &str, name_span: Span, arguments: &[Ast], span: Span) -> Value {
        let Some(known) = function(name) else {
            if let Some(table) = self.table(name) {
                return self.of_table(name, table, arguments, span);
            }
            let tables = self.scope.names.iter().filter(|(_, entry)| entry.section == Section::Table);
            let tables = tables.map(|(name, _)| name.as_str());
            let help = did_you_mean(name, FUNCTIONS.iter().map(|f| f.name).chain(tables));
            let help = match (name, written_here(name)) {
                ("delay" | "delayed" | "lag", _) => lag("x"),
                (_, Some(here)) => format!("it is written `{here}`"),
                _ if help.is_empty() && self.scope.names.contains_key(name) => at_another_time(name),
                _ => help,
            };
            return self.refuse(names::unknown_function(self.place(name_span), name, help));
        };
        if !known.takes(arguments.len()) {
            let place = self.place(span);
            return self.refuse(names::argument_count(place, name, known.arity(), arguments.len()));
        }
        match (name, arguments) {
            ("mod", _) => self.modulo(arguments, span),
            ("diff", [of, by]) => self.diff(of, by),
            ("reaction", [constraint]) => self.reaction(constraint, span),
            ("moment", [joint]) => self.moment(joint, span),
            ("position", [point]) => self.vector_argument(name, point).map_or(Value::Poison, Value::Vector),
            ("velocity", [point]) => self.motion(name, point, 1, span),
            ("acceleration", [point]) => self.motion(name, point, 2, span),
            ("velocity" | "acceleration", [body, point]) => self.material(name, body, point, span),
            ("angular_velocity", [body]) => self.angular_velocity(body),
            ("angles", [frame, sequence]) => self.angles(frame, sequence),
            ("quaternion", [frame]) => self.quaternion(frame),
            ("components", [vector, frame]) => self.components(vector, frame),
            ("momentum", [of]) => self.momentum(of),
            ("angular_momentum", [of]) => self.angular_momentum(of, None),
            ("angular_momentum", [of, about]) => self.angular_momentum(of, Some(about)),
            ("rate", [of]) => {
                let value = self.expression(of);
                self.rate(value, span)
            }
            ("dot" | "norm" | "unit", _) => self.metric(name, arguments),
            ("cross", [a, b]) => self.cross(a, b),
            _ => self.scalar_function(name, arguments, span),
        }
    }

    /// The place of the table of this name, if there is one.
    pub(super) fn table(&self, name: &str) -> Option<Option<usize>> {
        let entry = self.scope.names.get(name).filter(|entry| entry.section == Section::Table)?;
        Some(match entry.members.values().next() {
            Some(Member::Table(place)) if !entry.refused => Some(*place),
            _ => None,
        })
    }

    /// A table at its arguments; nothing is said of one that was refused.
    fn of_table(&mut self, name: &str, table: Option<usize>, arguments: &[Ast], span: Span) -> Value {
        let Some(place) = table else { return Value::Poison };
        let table = self.scope.tables[place].table;
        let wanted = if matches!(table, TableKind::One(_)) { "1 argument" } else { "2 arguments" };
        match (table, arguments) {
            (TableKind::One(table), [argument]) => match self.argument_of_table(name, argument) {
                Some(x) => Value::Scalar(self.builder.graph.unary(Unary::Table(table), x)),
                None => Value::Poison,
            },
            (TableKind::Two(table), [first, second]) => {
                match (self.argument_of_table(name, first), self.argument_of_table(name, second)) {
                    (Some(x), Some(y)) => Value::Scalar(self.builder.graph.binary(Binary::Table(table), x, y)),
                    _ => Value::Poison,
                }
            }
            _ => {
                let place = self.place(span);
                self.refuse(names::argument_count(place, name, wanted.to_owned(), arguments.len()))
            }
        }
    }

    /// A number at which a table is wanted.
    fn argument_of_table(&mut self, name: &str, argument: &Ast) -> Option<Id> {
        match self.expression(argument) {
            Value::Scalar(x) => Some(x),
            Value::Nothing => Some(Id::ZERO),
            Value::Poison | Value::Orientation(_) => None,
            found @ Value::Vector(_) => {
                self.refuse(names::argument_kind(self.place(argument.span), name, "a number", found.describe()));
                None
            }
        }
    }

    /// A function of numbers.
    fn scalar_function(&mut self, name: &str, arguments: &[Ast], span: Span) -> Value {
        let mut values = Vec::new();
        let mut lost = false;
        for argument in arguments {
            match self.expression(argument) {
                Value::Scalar(x) => values.push(x),
                Value::Nothing => values.push(Id::ZERO),
                Value::Poison | Value::Orientation(_) => lost = true,
                found @ Value::Vector(_) => {
                    let mut problem =
                        names::argument_kind(self.place(argument.span), name, "a number", found.describe());
                    if name == "abs" {
                        problem.help = "the length of a vector is `norm(…)`".to_owned();
                    }
                    self.refuse(problem);
                    lost = true;
                }
            }
        }
        let (false, Some(&first)) = (lost, values.first()) else { return Value::Poison };
        let graph = &mut self.builder.graph;
        let unary = match name {
            "sin" => Unary::Sin,
            "cos" => Unary::Cos,
            "tan" => Unary::Tan,
            "asin" => Unary::Asin,
            "acos" => Unary::Acos,
            "atan" => Unary::Atan,
            "sinh" => Unary::Sinh,
            "cosh" => Unary::Cosh,
            "tanh" => Unary::Tanh,
            "exp" => Unary::Exp,
            "ln" => Unary::Ln,
            "sqrt" => Unary::Sqrt,
            "abs" => Unary::Abs,
            "sign" => Unary::Sign,
            "step" => Unary::Step,
            _ => {
                let operation = match name {
                    "atan2" => Binary::Atan2,
                    "min" => Binary::Min,
                    _ => Binary::Max,
                };
                let rest = values.iter().skip(1);
                return Value::Scalar(rest.fold(first, |a, b| graph.binary(operation, a, *b)));
            }
        };
        let result = graph.unary(unary, first);
        let value = graph.number(first).map(|x| DoubleDouble::unary(unary, x.to_double_double()));
        if value.is_some_and(|value| !value.is_finite()) {
            let words = self.text.words(span);
            return self.refuse(names::undefined_value(self.place(span), words));
        }
        Value::Scalar(result)
    }

    fn modulo(&mut self, arguments: &[Ast], span: Span) -> Value {
        let whole = Ast {
            kind: AstKind::Call { function: "mod".to_owned(), name_span: span, arguments: arguments.to_vec() },
            span,
        };
        match index::integer(&Indices::within(self.scope, self.text), &self.locals, &whole) {
            Ok(value) => Value::Scalar(self.builder.graph.integer(value)),
            Err(refusal) => self.told(refusal),
        }
    }

    /// A vector; `None` when it is none (reported) or poisoned.
    pub(super) fn vector_argument(&mut self, function: &str, argument: &Ast) -> Option<Vec<Id>> {
        match self.expression(argument) {
            Value::Vector(v) if v.len() != self.scope.dimension && !matches!(function, "dot" | "norm" | "unit") => {
                let place = self.place(argument.span);
                self.refuse(names::vector_size(place, self.scope.dimension, v.len()));
                None
            }
            Value::Vector(v) => Some(v),
            Value::Nothing => Some(vec![Id::ZERO; self.scope.dimension]),
            Value::Poison | Value::Orientation(_) => None,
            found @ Value::Scalar(_) => {
                let wanted = match function {
                    "position" | "velocity" | "acceleration" => "a point or body",
                    _ => "a vector",
                };
                let mut problem = names::argument_kind(self.place(argument.span), function, wanted, found.describe());
                if wanted == "a point or body" {
                    problem.help = "the time derivative of anything else is `rate(e)`".to_owned();
                }
                self.refuse(problem);
                None
            }
        }
    }

    fn metric(&mut self, name: &str, arguments: &[Ast]) -> Value {
        let vectors: Vec<Option<Vec<Id>>> = arguments.iter().map(|a| self.vector_argument(name, a)).collect();
        let graph = &mut self.builder.graph;
        match (name, vectors.as_slice()) {
            ("dot", [Some(a), Some(b)]) if a.len() != b.len() => {
                let place = self.place(arguments[1].span);
                self.refuse(names::vector_size(place, a.len(), b.len()))
            }
            ("dot", [Some(a), Some(b)]) => Value::Scalar(vectors::dot(graph, a, b)),
            ("norm", [Some(a)]) => Value::Scalar(vectors::norm(graph, a)),
            ("unit", [Some(a)]) => Value::Vector(vectors::unit(graph, a)),
            _ => Value::Poison,
        }
    }

    /// `cross` of two vectors, or in the plane of an angular velocity and a vector.
    fn cross(&mut self, a: &Ast, b: &Ast) -> Value {
        let (left, right) = (self.expression(a), self.expression(b));
        let place = self.place(b.span);
        let plane = self.scope.dimension == 2;
        let graph = &mut self.builder.graph;
        match (&left, &right) {
            (Value::Poison, _) | (_, Value::Poison) => Value::Poison,
            (Value::Nothing, _) | (_, Value::Nothing) => Value::Nothing,
            (Value::Vector(a), Value::Vector(b)) if plane => Value::Scalar(vectors::cross_plane(graph, a, b)),
            (Value::Vector(a), Value::Vector(b)) if a.len() != 3 || b.len() != 3 => {
                self.refuse(names::vector_size(place, 3, a.len().max(b.len())))
            }
            (Value::Vector(a), Value::Vector(b)) => Value::Vector(vectors::cross_space(graph, a, b)),
            (Value::Scalar(w), Value::Vector(r)) if plane => Value::Vector(vectors::turn(graph, *w, r)),
            (Value::Vector(r), Value::Scalar(w)) if plane => {
                let minus = graph.neg(*w);
                Value::Vector(vectors::turn(graph, minus, r))
            }
            (Value::Vector(_), found) => {
                self.refuse(names::argument_kind(self.place(b.span), "cross", "two vectors", found.describe()))
            }
            (found, _) => {
                self.refuse(names::argument_kind(self.place(a.span), "cross", "two vectors", found.describe()))
            }
        }
    }

    /// d/dt of a value.
    fn rate(&mut self, value: Value, span: Span) -> Value {
        let depends = self.builder.depends(value.components());
        if depends.meets(Depends::MULTIPLIER) {
            let words = self.text.words(span);
            return self.refuse(names::reaction_misplaced(self.place(span), words, "a time derivative"));
        }
        if depends.meets(Depends::ACCELERATION.and(Depends::JERK)) {
            let words = self.text.words(span);
            return self.refuse(names::acceleration_misplaced(self.place(span), words, "a time derivative"));
        }
        if depends.meets(Depends::STATE_RATE) {
            let words = self.text.words(span);
            return self.refuse(states::second_rate(self.place(span), words));
        }
        value.map(|x| self.builder.rate(x))
    }

    /// The velocity or acceleration of a point.
    fn motion(&mut self, name: &str, point: &Ast, order: usize, span: Span) -> Value {
        let Some(position) = self.vector_argument(name, point) else { return Value::Poison };
        (0..order).fold(Value::Vector(position), |value, _| self.rate(value, span))
    }

    /// The body, frame or ground that an argument names.
    pub(super) fn solid_argument(&mut self, function: &str, argument: &Ast, wanted: &str) -> Option<Solid> {
        match &argument.kind {
            AstKind::Name { name, indices, primes: 0 } => self.solid(name, indices, argument.span),
            _ => {
                let problem = names::argument_kind(self.place(argument.span), function, wanted, "an expression");
                self.refuse(problem);
                None
            }
        }
    }

    /// `velocity(B, P)` = v + ω×(P − r), `acceleration(B, P)` = a + α×(P − r) − ω²(P − r), with B's centre r.
    fn material(&mut self, name: &str, body: &Ast, point: &Ast, span: Span) -> Value {
        let solid = self.solid_argument(name, body, "a body and a point");
        let point = self.vector_argument(name, point);
        let (Some(solid), Some(point)) = (solid, point) else { return Value::Poison };
        let body_place = match solid {
            Solid::Ground => return Value::Vector(vec![Id::ZERO; point.len()]),
            Solid::Body(place) => place,
            Solid::Frame(_) => {
                let words = self.text.words(body.span);
                return self.refuse(names::wrong_thing(self.place(body.span), words, "a body", "a frame"));
            }
        };
        let centre = self.item(self.scope.bodies[body_place].position);
        let Some(omega) = self.spin_of(solid, body, format!("`{name}(B, P)`")) else { return Value::Poison };
        let Value::Vector(centre) = centre else { return Value::Poison };
        let builder = &mut *self.builder;
        let arm = vectors::difference(&mut builder.graph, &centre, &point);
        let velocity = builder.rates(&centre);
        if name == "velocity" {
            let turning = vectors::swept(&mut builder.graph, &omega, &arm);
            return Value::Vector(vectors::add(&mut builder.graph, &velocity, &turning));
        }
        if builder.depends(&omega).meets(Depends::ACCELERATION)
            || builder.depends(&velocity).meets(Depends::ACCELERATION)
        {
            let words = self.text.words(span);
            return self.refuse(names::acceleration_misplaced(self.place(span), words, "a time derivative"));
        }
        let (alpha, acceleration) = (builder.rates(&omega), builder.rates(&velocity));
        let graph = &mut builder.graph;
        let turning = vectors::swept(graph, &alpha, &arm);
        let sum = vectors::add(graph, &acceleration, &turning);
        let inward = match omega.as_slice() {
            [omega] => {
                let square = graph.mul(*omega, *omega);
                let minus = graph.neg(square);
                vectors::scaled(graph, minus, &arm)
            }
            _ => {
                let speed = vectors::cross_space(graph, &omega, &arm);
                vectors::cross_space(graph, &omega, &speed)
            }
        };
        Value::Vector(vectors::add(graph, &sum, &inward))
    }

    fn angular_velocity(&mut self, body: &Ast) -> Value {
        let Some(solid) = self.solid_argument("angular_velocity", body, "a body or frame") else {
            return Value::Poison;
        };
        match self.spin_of(solid, body, "its angular velocity".to_owned()) {
            Some(omega) => match omega.as_slice() {
                [omega] => Value::Scalar(*omega),
                _ => Value::Vector(omega),
            },
            None => Value::Poison,
        }
    }

    /// The angular velocity of a body, frame or the ground in ground axes; one component in the plane.
    fn spin_of(&mut self, solid: Solid, named: &Ast, context: String) -> Option<Vec<Id>> {
        let item = match solid {
            Solid::Ground => return Some(vec![Id::ZERO; vectors::moment_size(self.scope.dimension)]),
            Solid::Frame(item) => item,
            Solid::Body(place) => match self.scope.bodies[place].orientation {
                Some(item) => item,
                None => {
                    let shown = self.solid_name(solid);
                    self.refuse(mechanics::needs_orientation(self.place(named.span), shown, context));
                    return None;
                }
            },
        };
        match self.item(item) {
            Value::Orientation(frame) => Some(frame.velocity.to_vec()),
            Value::Scalar(angle) => match self.rate(Value::Scalar(angle), named.span) {
                Value::Scalar(omega) => Some(vec![omega]),
                _ => None,
            },
            _ => None,
        }
    }

    /// ∂e/∂x with all other symbols held.
    fn diff(&mut self, of: &Ast, by: &Ast) -> Value {
        // What the derivative may depend on is checked afterwards.
        let refused = std::mem::replace(&mut self.rules.refused, Depends::JERK);
        let value = self.expression(of);
        let symbol = self.symbol(by);
        self.rules.refused = refused;
        if symbol == Some(Symbol::Time) && !self.is_meant_by_time(&value) {
            let words = self.text.words(of.span);
            return self.refuse(names::moving_by_time(self.place(of.span), words));
        }
        match symbol {
            Some(symbol) => value.map(|x| self.builder.partial(x, symbol, &self.text.place)),
            None => Value::Poison,
        }
    }

    /// Whether ∂e/∂t is meant of a value: of what moves it holds the motion, so that it is 0 where e has no explicit t
    /// (a velocity was meant), and may stand only where an identity is tested (Jacobi's −∂L/∂t).
    fn is_meant_by_time(&mut self, value: &Value) -> bool {
        let depends = self.builder.depends(value.components());
        let moves = Depends::COORDINATE
            .and(Depends::VELOCITY)
            .and(Depends::ACCELERATION)
            .and(Depends::INPUT)
            .and(Depends::STATE);
        !depends.meets(moves) || self.rules.tested && depends.meets(Depends::TIME)
    }

    /// The symbol that a name stands for; reports when it stands for none.
    fn symbol(&mut self, by: &Ast) -> Option<Symbol> {
        let AstKind::Name { name, indices, primes } = &by.kind else {
            self.refuse(names::not_a_symbol(self.place(by.span), "an expression"));
            return None;
        };
        if name == "t" && *primes == 0 && indices.is_empty() {
            return Some(Symbol::Time);
        }
        let local = self.locals.iter().rev().find(|(local, _)| local == name).map(|(_, local)| *local);
        let found = match local {
            Some(Local::Symbol(symbol, _)) if *primes == 0 && indices.is_empty() => return Some(symbol),
            Some(_) => "an index",
            None => match self.member(name, indices, by.span)? {
                (_, Member::Coordinate(place)) => {
                    return Some(match primes {
                        0 => Symbol::Coordinate(place),
                        1 => Symbol::Speed(place),
                        _ => Symbol::Acceleration(place),
                    });
                }
                (_, Member::State(place)) if *primes == 0 => return Some(Symbol::State(place)),
                (_, Member::Memory(place)) if *primes == 0 => return Some(Symbol::Memory(place)),
                (_, Member::Input(place, _)) => return Some(Symbol::Input(place, *primes)),
                (_, Member::Parameter(place)) if *primes == 0 => return Some(Symbol::Parameter(place)),
                (_, Member::Refused) => return None,
                (super::scope::Section::Parameter, _) => "a derived parameter",
                (section, _) => section.noun(),
            },
        };
        self.refuse(names::not_a_symbol(self.place(by.span), found));
        None
    }
}
