//! Units of expressions: inferred from names, checked in every sum and function (LANGUAGE, section 10).

use super::dimension::{Dimension, Measure};
use super::index::{self, Indices};
use super::lower::{Local, Lower};
use super::quantities::is_bare;
use super::scope::{Member, Section};
use super::value::Value;
use crate::diagnose::catalogue::units;
use crate::language::{Ast, AstKind, Operator, Range};

impl Lower<'_> {
    /// The unit of an expression that was found to have a value; reports what does not fit.
    pub(super) fn measure(&mut self, ast: &Ast) -> Measure {
        if !self.builder.spend(1, &self.text.place) {
            return Measure::Unknown;
        }
        match &ast.kind {
            AstKind::Number(text) if text.parse() == Ok(0.0) => Measure::Zero,
            AstKind::Number(_) => Measure::ONE,
            AstKind::Name { name, indices, primes } => self.measure_of_name(name, indices, *primes, ast),
            AstKind::Negate(inner) => self.measure(inner),
            AstKind::Binary(operator, left, right) => self.measure_of_pair(*operator, left, right),
            AstKind::Vector(parts) => self.measure_of_vector(parts),
            AstKind::Component(of, _) if self.oriented(of) => Measure::ONE,
            AstKind::Component(of, _) => self.measure(of),
            AstKind::Call { function, arguments, .. } => self.measure_of_call(function, arguments),
            AstKind::Sum(body, ranges) => self.measure_of_sum(body, ranges),
            AstKind::Integral(body, range) => self.measure_of_integral(body, range),
        }
    }

    /// The unit of a rate of some order.
    fn rate_of(&self, measure: Measure, order: u8) -> Measure {
        (0..order).fold(measure, |rate, _| self.scope.units.rate(rate))
    }

    fn measure_of_name(&mut self, name: &str, indices: &[Ast], primes: u8, ast: &Ast) -> Measure {
        match self.local(name) {
            Some(Local::Integer(_)) => return Measure::ONE,
            Some(Local::Symbol(_, measure)) => return measure,
            None => {}
        }
        match name {
            // In a signal of the command line no name can carry the rate in `cos(3*t)`.
            "t" if self.rules.signals && self.rules.numbers_fit => return Measure::Unknown,
            "t" => return Measure::ONE.over(self.scope.units.rate(Measure::ONE)),
            "pi" => return Measure::ONE,
            "ground" => return Measure::Zero,
            "energy" | "kinetic_energy" | "potential_energy" => return self.scope.units.energy,
            "momentum" if !self.scope.names.contains_key(name) => return self.measure_of_momentum(false),
            _ => {}
        }
        let Some((_, member)) = self.member(name, indices, ast.span) else { return Measure::Unknown };
        let units = &self.scope.units;
        let item = |item: usize| units.items.get(item).copied().unwrap_or_default();
        let measure = match member {
            Member::Size(_) => Measure::ONE,
            Member::Parameter(place) => units.parameters.get(place as usize).copied().unwrap_or_default(),
            Member::Coordinate(place) => units.coordinates.get(place as usize).copied().unwrap_or_default(),
            Member::State(place) => units.states.get(place as usize).copied().unwrap_or_default(),
            Member::Memory(place) => units.memory.get(place as usize).copied().unwrap_or_default(),
            Member::Noise(place) => units.memory.get(self.scope.noise[place].1).copied().unwrap_or_default(),
            Member::Input(_, place) | Member::Item(place) | Member::Frame(place) => item(place),
            Member::Body(place) => item(self.scope.bodies[place].position),
            Member::Reaction(_) if units.pure => Measure::ONE,
            Member::Reaction(place) if self.scope.reactions[place].couple => Measure::Of(Dimension::ENERGY),
            Member::Reaction(_) => Measure::Of(Dimension::FORCE),
            Member::Rotation(_)
            | Member::Constraint(_)
            | Member::Joint(_)
            | Member::Phase(_)
            | Member::Table(_)
            | Member::Refused => Measure::Unknown,
        };
        self.rate_of(measure, primes)
    }

    fn measure_of_pair(&mut self, operator: Operator, left: &Ast, right: &Ast) -> Measure {
        let (a, b) = (self.measure(left), self.measure(right));
        match operator {
            Operator::Add | Operator::Subtract | Operator::Equal => self.alike(left, a, right, b),
            Operator::Multiply => a.times(b),
            Operator::Divide => a.over(b),
            Operator::Power => self.measure_of_power(left, a, right, b),
        }
    }

    /// The unit of both; reports when they differ.
    fn alike(&mut self, left: &Ast, a: Measure, right: &Ast, b: Measure) -> Measure {
        if let Some(measure) = a.alike(b) {
            return measure;
        }
        let bare = [left, right].map(|side| is_bare(side, &self.locals));
        match bare {
            [true, false] if self.rules.numbers_fit => return b,
            [false, true] if self.rules.numbers_fit => return a,
            _ => {}
        }
        let (Measure::Of(a), Measure::Of(b)) = (a, b) else { return Measure::Unknown };
        // Of a sum of several terms, which are alike, the last is shown.
        let left = match &left.kind {
            AstKind::Binary(Operator::Add | Operator::Subtract, _, last) => last,
            _ => left,
        };
        let words = [left, right].map(|side| self.text.words(side.span).to_owned());
        let [left, other] = words;
        // A number in a sum is pure.
        let help = match bare {
            [true, false] => with_unit(&left, b),
            [false, true] => with_unit(&other, a),
            _ => String::new(),
        };
        let problem = units::unlike_terms(self.place(right.span), left, a.described(), other, b.described(), help);
        self.refuse(problem);
        Measure::Unknown
    }

    fn measure_of_like(&mut self, parts: &[&Ast]) -> Measure {
        let Some((first, others)) = parts.split_first() else { return Measure::Zero };
        let mut all = self.measure(first);
        for part in others {
            let measure = self.measure(part);
            all = self.alike(first, all, part, measure);
        }
        all
    }

    /// Components are alike; a bare number among them is in their unit.
    fn measure_of_vector(&mut self, parts: &[Ast]) -> Measure {
        let quantities: Vec<&Ast> = parts.iter().filter(|part| !is_bare(part, &self.locals)).collect();
        match quantities.is_empty() {
            true => self.measure_of_like(&parts.iter().collect::<Vec<_>>()),
            false => self.measure_of_like(&quantities),
        }
    }

    fn measure_of_power(&mut self, base: &Ast, of: Measure, exponent: &Ast, by: Measure) -> Measure {
        if let Measure::Of(unit) = by
            && unit != Dimension::ONE
        {
            let words = self.text.words(exponent.span).to_owned();
            let problem = units::exponent_with_unit(self.place(exponent.span), words, unit.described());
            self.refuse(problem);
            return Measure::Unknown;
        }
        let value = self.expression(exponent);
        let number = match value {
            Value::Scalar(id) => self.builder.graph.number(id),
            _ => None,
        };
        match (of, number) {
            (_, Some(number)) => of.power(number),
            (Measure::Of(Dimension::ONE), None) => Measure::ONE,
            (Measure::Of(unit), None) => {
                let [base, words] = [base, exponent].map(|part| self.text.words(part.span).to_owned());
                let problem = units::impure_power(self.place(exponent.span), base, unit.described(), words);
                self.refuse(problem);
                Measure::Unknown
            }
            _ => Measure::Unknown,
        }
    }

    fn measure_of_call(&mut self, name: &str, arguments: &[Ast]) -> Measure {
        match (name, arguments) {
            ("mod" | "unit" | "sign" | "step", _) => {
                for argument in arguments {
                    self.measure(argument);
                }
                Measure::ONE
            }
            ("reaction", [constraint]) => self.measure_of_reaction(constraint),
            ("moment", [_]) => self.measure_of_work(),
            ("angular_velocity", _) => self.rate_of(Measure::ONE, 1),
            ("angles" | "quaternion", _) => Measure::ONE,
            ("components", [vector, _]) => self.measure(vector),
            ("momentum", _) => self.measure_of_momentum(false),
            ("angular_momentum", _) => self.measure_of_momentum(true),
            ("diff", [of, by]) => {
                let of = self.measure(of);
                of.over(self.measure(by))
            }
            ("velocity" | "acceleration", [.., point]) => {
                let position = self.measure(point);
                self.rate_of(position, if name == "velocity" { 1 } else { 2 })
            }
            ("rate", [of]) => {
                let of = self.measure(of);
                self.rate_of(of, 1)
            }
            ("sqrt", [of]) => {
                let half = crate::expr::Rational::new(1, 2).unwrap_or(crate::expr::Rational::ONE);
                self.measure(of).power(crate::expr::Number::Exact(half))
            }
            ("position" | "norm" | "abs" | "min" | "max", _) => {
                self.measure_of_like(&arguments.iter().collect::<Vec<_>>())
            }
            ("atan2", _) => {
                self.measure_of_like(&arguments.iter().collect::<Vec<_>>());
                Measure::ONE
            }
            ("dot" | "cross", [a, b]) => {
                let a = self.measure(a);
                a.times(self.measure(b))
            }
            _ if self.table(name).is_some() => self.measure_of_table(name, arguments),
            _ => {
                for argument in arguments {
                    self.want_pure(name, argument);
                }
                Measure::ONE
            }
        }
    }

    /// What a table gives; its arguments are in the units of its first columns.
    fn measure_of_table(&mut self, name: &str, arguments: &[Ast]) -> Measure {
        let found: Vec<Measure> = arguments.iter().map(|argument| self.measure(argument)).collect();
        let Some(Some(place)) = self.table(name) else { return Measure::Unknown };
        let (of, gives) = (self.scope.tables[place].of.clone(), self.scope.tables[place].gives);
        for (k, ((argument, found), unit)) in arguments.iter().zip(found).zip(&of).enumerate() {
            if let (None, Measure::Of(found), Measure::Of(wanted)) = (found.alike(*unit), found, *unit) {
                let words = self.text.words(argument.span).to_owned();
                let which = if of.len() == 1 { "the" } else { ["the first", "the second"][k] };
                let (place, what) = (self.place(argument.span), format!("{which} argument of `{name}`"));
                self.refuse(units::wrong_unit(place, words, found.described(), what, wanted.wanted(), ""));
            }
        }
        gives
    }

    fn want_pure(&mut self, function: &str, argument: &Ast) {
        if let Measure::Of(unit) = self.measure(argument)
            && unit != Dimension::ONE
        {
            let words = self.text.words(argument.span).to_owned();
            let help = match unit {
                Dimension::TIME => "a rate makes it pure: declare one, `w: 3 rad/s`, and write `w*t`",
                _ => "divide it by a reference value of the same unit",
            };
            let problem = units::not_pure(self.place(argument.span), function, words, unit.described(), help);
            self.refuse(problem);
        }
    }

    /// All terms of a sum are alike; a mistake in them is told once.
    fn measure_of_sum(&mut self, body: &Ast, ranges: &[Range]) -> Measure {
        let known = self.locals.len();
        self.locals.extend(ranges.iter().map(|range| (range.name.clone(), Local::Integer(0))));
        let mut outer = self.locals[..known].to_vec();
        let indices = Indices::within(self.scope, self.text);
        let members = index::members(&indices, self.builder, &mut outer, ranges).unwrap_or_default();
        let mut all = Measure::Zero;
        let before = self.builder.problems.len();
        for member in members {
            for (local, value) in self.locals[known..].iter_mut().zip(member) {
                local.1 = Local::Integer(value);
            }
            let term = self.measure(body);
            all = self.alike(body, all, body, term);
            if self.builder.problems.len() > before || all == Measure::Unknown {
                break;
            }
        }
        self.locals.truncate(known);
        all
    }

    /// Of the integrand times the dummy, whose unit is that of the limits.
    fn measure_of_integral(&mut self, body: &Ast, range: &Range) -> Measure {
        let (from, to) = (self.measure(&range.from), self.measure(&range.to));
        let dummy = match self.alike(&range.from, from, &range.to, to) {
            Measure::Zero => Measure::Unknown,
            measure => measure,
        };
        let symbol = crate::expr::Symbol::Dummy(self.locals.len() as u32);
        self.locals.push((range.name.clone(), Local::Symbol(symbol, dummy)));
        let integrand = self.measure(body);
        self.locals.pop();
        integrand.times(dummy)
    }

    /// Whether `.x` after this is a unit vector: it names the ground, a frame or a body.
    pub(super) fn oriented(&self, of: &Ast) -> bool {
        let AstKind::Name { name, primes: 0, .. } = &of.kind else { return false };
        let turns = |section| matches!(section, Section::Frame | Section::Body);
        !self.text.words(of.span).starts_with('(')
            && self.local(name).is_none()
            && (name == "ground" || self.scope.names.get(name).is_some_and(|entry| turns(entry.section)))
    }
}

/// How a number gets a unit that stands in a sum.
fn with_unit(number: &str, unit: Dimension) -> String {
    match unit {
        Dimension::ONE => String::new(),
        unit => format!(
            "a number beside other terms is pure: name it in `parameters` with its unit, `{number} {unit}`, and write the name"
        ),
    }
}
