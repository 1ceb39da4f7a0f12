//! Names in expressions: what they stand for, their primes, their unit vectors.

use super::index::{self, Indices};
use super::lower::{Local, Lower};
use super::scope::{Entry, Member, Section, expanded};
use super::value::Value;
use crate::diagnose::catalogue::{names, states};
use crate::expr::{DoubleDouble, Id, Symbol, Unary};
use crate::language::{Ast, AstKind, SCALAR, Span};

/// Something that turns, or stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solid {
    /// The ground.
    Ground,
    /// A body, by its place.
    Body(usize),
    /// A frame: the item that holds its angle, or how it is turned in space.
    Frame(usize),
}

impl Lower<'_> {
    /// The value of a name with indices and primes.
    pub(super) fn name(&mut self, name: &str, indices: &[Ast], primes: u8, span: Span) -> Value {
        if let Some(local) = self.local(name) {
            if !indices.is_empty() {
                let hides = self.scope.names.contains_key(name);
                let problem = if hides { names::index_hides_name } else { names::not_indexed };
                return self.refuse(problem(self.place(span), name));
            }
            let found = if matches!(local, Local::Integer(_)) { "an index" } else { "a bound variable" };
            return self.unprimed(name, primes, found, span, |lower| match local {
                Local::Integer(value) => Value::Scalar(lower.builder.graph.integer(value)),
                Local::Symbol(symbol, _) => Value::Scalar(lower.builder.graph.symbol(symbol)),
            });
        }
        if let Some(value) = self.built_in(name, primes, span) {
            if !indices.is_empty() {
                return self.refuse(names::not_indexed(self.place(span), name));
            }
            return value;
        }
        let Some((section, member)) = self.member(name, indices, span) else { return Value::Poison };
        match member {
            Member::Coordinate(place) => {
                let symbol = match primes {
                    0 => Symbol::Coordinate(place),
                    1 => Symbol::Speed(place),
                    _ => Symbol::Acceleration(place),
                };
                Value::Scalar(self.builder.graph.symbol(symbol))
            }
            Member::State(place) => {
                let symbol = match primes {
                    0 => Symbol::State(place),
                    1 => Symbol::StateRate(place),
                    _ => {
                        let words = self.text.words(span);
                        return self.refuse(states::second_rate(self.place(span), words));
                    }
                };
                Value::Scalar(self.builder.graph.symbol(symbol))
            }
            Member::Input(_, item) if self.rules.signals => {
                let mut value = self.item(item);
                for _ in 0..primes {
                    value = value.map(|x| self.builder.rate(x));
                }
                value
            }
            Member::Input(place, _) => Value::Scalar(self.builder.graph.symbol(Symbol::Input(place, primes))),
            Member::Refused => Value::Poison,
            Member::Rotation(_) => {
                let mut problem = names::wrong_thing(self.place(span), name, "a number or vector", "a rotation");
                problem.help =
                    format!("turn a frame by it, `B: {{rotate: {name}}}`, and use `B.x`, `angular_velocity(B)`");
                self.refuse(problem)
            }
            _ => self.unprimed(name, primes, section.noun(), span, |lower| lower.plain(name, section, member, span)),
        }
    }

    /// What an index or bound variable stands for.
    pub(super) fn local(&self, name: &str) -> Option<Local> {
        self.locals.iter().rev().find(|(local, _)| local == name).map(|(_, local)| *local)
    }

    /// `t`, `pi`, `ground`, energies.
    fn built_in(&mut self, name: &str, primes: u8, span: Span) -> Option<Value> {
        let energies = self.scope.energies;
        let value = match name {
            "t" => Value::Scalar(self.builder.graph.symbol(Symbol::Time)),
            "pi" => Value::Scalar(self.builder.graph.double_double(DoubleDouble::PI)),
            "ground" => Value::Vector(vec![Id::ZERO; self.scope.dimension]),
            "energy" | "kinetic_energy" | "potential_energy" if self.rules.energy => match energies {
                None => Value::Poison,
                Some(e) => Value::Scalar(match name {
                    "kinetic_energy" => e.kinetic,
                    "potential_energy" => e.potential,
                    _ => self.builder.graph.add(e.kinetic, e.potential),
                }),
            },
            // Models may have things of this name.
            "momentum" if self.scope.names.contains_key(name) => return None,
            "momentum" if self.rules.energy => match energies {
                None => Value::Poison,
                Some(_) => self.momentum_of(&(0..self.scope.massive.len()).collect::<Vec<_>>()),
            },
            "energy" | "kinetic_energy" | "potential_energy" | "momentum" | "length" | "all" => {
                let problem = names::wrong_place(self.place(span), name, self.rules.what);
                return Some(self.refuse(problem));
            }
            _ => return None,
        };
        Some(self.unprimed(name, primes, "built in", span, |_| value))
    }

    /// The value, unless there are primes.
    fn unprimed(
        &mut self,
        name: &str,
        primes: u8,
        found: &str,
        span: Span,
        value: impl FnOnce(&mut Self) -> Value,
    ) -> Value {
        if primes > 0 {
            return self.refuse(names::prime_of_other(self.place(span), name, found));
        }
        value(self)
    }

    /// What the file declares under a name and indices; reports what is wrong.
    pub fn member(&mut self, name: &str, indices: &[Ast], span: Span) -> Option<(Section, Member)> {
        let scope = self.scope;
        let Some(entry) = scope.names.get(name) else {
            self.unknown(name, span);
            return None;
        };
        self.member_of(entry, name, indices, span).map(|member| (entry.section, member))
    }

    /// The member of a name that indices choose; reports what is wrong.
    pub(super) fn member_of(&mut self, entry: &Entry, name: &str, indices: &[Ast], span: Span) -> Option<Member> {
        let all_refused = !entry.members.is_empty() && entry.members.values().all(|member| *member == Member::Refused);
        if entry.refused || all_refused {
            return Some(Member::Refused);
        }
        let scope = self.scope;
        let mut values = Vec::new();
        for index in indices {
            match index::integer(&Indices::within(scope, self.text), &self.locals, index) {
                Ok(value) => values.push(value),
                Err(refusal) => {
                    self.told(refusal);
                    return None;
                }
            }
        }
        if values.len() != entry.indices {
            let place = self.place(span);
            let problem = match entry.indices {
                0 => names::not_indexed(place, name),
                wanted => {
                    let plural = |n: usize| if n == 1 { "1 index".to_owned() } else { format!("{n} indices") };
                    let found = if values.is_empty() { "none".to_owned() } else { values.len().to_string() };
                    names::index_count(place, name, plural(wanted), found)
                }
            };
            self.refuse(problem);
            return None;
        }
        match entry.members.get(&values) {
            Some(member) => Some(*member),
            None => {
                let listed: Vec<String> = values.iter().map(i64::to_string).collect();
                let place = self.place(indices.first().map_or(span, |first| first.span));
                self.refuse(names::index_out_of_range(place, name, listed.join(","), entry.range(name)));
                None
            }
        }
    }

    /// The value of an item, or a note that it is needed.
    pub fn item(&mut self, item: usize) -> Value {
        match self.scope.value(item) {
            Some(value) => value.clone(),
            None => {
                self.builder.needs.push(item);
                Value::Poison
            }
        }
    }

    fn plain(&mut self, name: &str, section: Section, member: Member, span: Span) -> Value {
        match member {
            Member::Size(value) => Value::Scalar(self.builder.graph.integer(value)),
            Member::Parameter(place) => Value::Scalar(self.builder.graph.symbol(Symbol::Parameter(place))),
            Member::Memory(place) => Value::Scalar(self.builder.graph.symbol(Symbol::Memory(place))),
            Member::Noise(place) => Value::Scalar(self.scope.noise[place].0),
            Member::Item(item) => self.item(item),
            Member::Body(body) => self.item(self.scope.bodies[body].position),
            Member::Reaction(place) => {
                let reaction = &self.scope.reactions[place];
                let scalar = reaction.scalar;
                let values: Vec<Id> = reaction.symbols().map(|symbol| self.builder.graph.symbol(symbol)).collect();
                if scalar { Value::Scalar(values[0]) } else { Value::Vector(values) }
            }
            _ => {
                let problem = names::wrong_thing(self.place(span), name, "a number or vector", section.noun());
                self.refuse(problem)
            }
        }
    }

    /// `e.x`: a unit vector after a frame or a body with an orientation, else a component.
    pub(super) fn component(&mut self, of: &Ast, axis: u8, span: Span) -> Value {
        let letter = ["x", "y", "z"][usize::from(axis.min(2))];
        if axis != SCALAR && usize::from(axis) >= self.scope.dimension {
            return self.refuse(names::no_such_component(self.place(span), letter));
        }
        if let AstKind::Name { name, indices, .. } = &of.kind
            && self.oriented(of)
        {
            let Some(solid) = self.solid(name, indices, of.span) else { return Value::Poison };
            let value = self.unit_vector(solid, name, axis, of.span);
            return self.admit(value, span);
        }
        match self.expression(of) {
            Value::Vector(v) => {
                let is_quaternion = v.len() == 4;
                let place = match axis {
                    SCALAR => 0,
                    _ => usize::from(axis) + usize::from(is_quaternion),
                };
                v.get(place).map_or(Value::Poison, |x| Value::Scalar(*x))
            }
            Value::Nothing => Value::Scalar(Id::ZERO),
            Value::Poison | Value::Orientation(_) => Value::Poison,
            found @ Value::Scalar(_) => {
                let mut problem = names::not_a_vector(self.place(of.span), found.describe());
                problem.help = format!("`.{letter}` is a component of a vector");
                self.refuse(problem)
            }
        }
    }

    /// A name as a body, frame or the ground; reports what is wrong.
    pub fn solid(&mut self, name: &str, indices: &[Ast], span: Span) -> Option<Solid> {
        if name == "ground" && indices.is_empty() {
            return Some(Solid::Ground);
        }
        let (section, member) = self.member(name, indices, span)?;
        match member {
            Member::Body(body) => Some(Solid::Body(body)),
            Member::Frame(item) => Some(Solid::Frame(item)),
            Member::Refused => None,
            _ => {
                self.refuse(names::wrong_thing(self.place(span), name, "a body or frame", section.noun()));
                None
            }
        }
    }

    /// A unit vector of a body, a frame or the ground; reports a particle.
    pub fn unit_vector(&mut self, solid: Solid, name: &str, axis: u8, span: Span) -> Value {
        let item = match solid {
            Solid::Ground => {
                let component = |k| if k == usize::from(axis) { Id::ONE } else { Id::ZERO };
                return Value::Vector((0..self.scope.dimension).map(component).collect());
            }
            Solid::Frame(item) => item,
            Solid::Body(body) => match self.scope.bodies[body].orientation {
                Some(item) => item,
                None => {
                    let letter = ["x", "y", "z"][usize::from(axis)];
                    let named = self.text.words(span).to_owned();
                    let shown = if named.is_empty() { name } else { &named };
                    return self.refuse(names::particle_component(self.place(span), shown, letter));
                }
            },
        };
        let angle = match self.item(item) {
            Value::Scalar(angle) => angle,
            Value::Orientation(frame) => {
                self.builder.along.axis(&frame, usize::from(axis));
                return Value::Vector(frame.axes[usize::from(axis)].to_vec());
            }
            _ => return Value::Poison,
        };
        let graph = &mut self.builder.graph;
        let (cosine, sine) = (graph.unary(Unary::Cos, angle), graph.unary(Unary::Sin, angle));
        Value::Vector(if axis == 0 { vec![cosine, sine] } else { vec![graph.neg(sine), cosine] })
    }

    /// For messages: the expanded name of a body.
    pub(super) fn solid_name(&self, solid: Solid) -> String {
        match solid {
            Solid::Body(body) => self.scope.bodies[body].name.clone(),
            Solid::Ground | Solid::Frame(_) => expanded("ground", &[]),
        }
    }
}
