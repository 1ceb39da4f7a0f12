//! Where syntax becomes expressions: the graph, what is known of its nodes, and the problems found.

use std::collections::HashMap;
use std::rc::Rc;

use super::dimension::{Dimension, Measure};
use super::facts::{Depends, Facts};
use super::lower::{Local, Lower};
use super::parameters::is_bare;
use super::reader::Quantity;
use super::scope::Scope;
use super::value::Value;
use crate::diagnose::catalogue::{names, units};
use crate::diagnose::{Place, Problem};
use crate::expr::{Forward, Graph, Id, Symbol};
use crate::language::{Ast, Span, Unit};

/// One expression of the file.
#[derive(Clone, Debug)]
pub struct Text {
    /// As written.
    pub source: Rc<str>,
    /// Parsed.
    pub ast: Rc<Ast>,
    /// Where it stands.
    pub place: Rc<Place>,
}

/// An expression, or a YAML list of two or three that stands for a vector.
#[derive(Clone, Debug)]
pub enum Written {
    /// One expression.
    One(Text),
    /// Components.
    List(Vec<Text>, Rc<Place>),
}

/// The unit that an expression is to have.
#[derive(Clone, Copy, Debug)]
pub enum Wanted {
    /// Any.
    Any,
    /// That of a kind of quantity, in a model with units.
    Si(Dimension),
    /// That of something else.
    Like(Measure),
}

/// What an expression may depend on.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// What is being written, with its article, for messages.
    pub what: &'static str,
    /// What it must not depend on.
    pub refused: Depends,
    /// True where `energy` and its parts may stand.
    pub energy: bool,
    /// True where an input's name stands for its expression instead of a symbol.
    pub signals: bool,
    /// The unit that is wanted.
    pub unit: Wanted,
    /// True where a bare number in a sum is in the unit of the other terms.
    pub numbers_fit: bool,
}

const ACCELERATION: Depends = Depends::ACCELERATION.and(Depends::JERK);
const VELOCITY: Depends = ACCELERATION.and(Depends::VELOCITY);
const MOTION: Depends = VELOCITY.and(Depends::COORDINATE);

impl Rules {
    /// Of parameters and sizes only.
    pub const fn constant(what: &'static str) -> Rules {
        Rules { refused: MOTION.and(Depends::TIME).and(Depends::INPUT), ..Rules::any(what) }
    }

    /// Of parameters, time and other inputs.
    pub const fn signal(what: &'static str) -> Rules {
        Rules { refused: MOTION, signals: true, ..Rules::any(what) }
    }

    /// Of parameters, time and inputs.
    pub const fn of_time(what: &'static str) -> Rules {
        Rules { refused: MOTION, ..Rules::any(what) }
    }

    /// Of coordinates, time and inputs.
    pub const fn position(what: &'static str) -> Rules {
        Rules { refused: VELOCITY, ..Rules::any(what) }
    }

    /// Of coordinates, velocities, time and inputs.
    pub const fn velocity(what: &'static str) -> Rules {
        Rules { refused: ACCELERATION, ..Rules::any(what) }
    }

    /// Of everything but accelerations, and energies.
    pub const fn invariant(what: &'static str) -> Rules {
        Rules { energy: true, ..Rules::velocity(what) }
    }

    /// Of everything.
    pub const fn anything(what: &'static str) -> Rules {
        Rules { energy: true, ..Rules::any(what) }
    }

    /// Of everything but energies: what definitions may hold.
    pub const fn any(what: &'static str) -> Rules {
        Rules { what, refused: Depends::JERK, energy: false, signals: false, unit: Wanted::Any, numbers_fit: false }
    }
}

impl Rules {
    /// A quantity of this kind.
    pub const fn si(self, dimension: Dimension) -> Rules {
        Rules { unit: Wanted::Si(dimension), ..self }
    }

    /// With sums in which a bare number is in the unit of the other terms.
    pub const fn numbers_fit(self) -> Rules {
        Rules { numbers_fit: true, ..self }
    }

    /// In the unit of something else.
    pub const fn like(self, measure: Measure) -> Rules {
        Rules { unit: Wanted::Like(measure), ..self }
    }
}

type Rate = fn(&mut Graph, Symbol) -> Id;
type Partial = Box<dyn Fn(&mut Graph, Symbol) -> Id>;

/// How many syntax nodes a model may expand to.
const WORK_LIMIT: u64 = 5_000_000;

/// The place where expressions are made.
pub struct Bench {
    /// All expressions.
    pub graph: Graph,
    /// What they depend on.
    pub facts: Facts,
    /// What is wrong.
    pub problems: Vec<Problem>,
    /// Items whose values were wanted and not known.
    pub needs: Vec<usize>,
    /// The unit of the value that was evaluated last.
    pub measured: Measure,
    work: u64,
    exhausted: bool,
    /// Texts that raised problems, by the place of their trees, which are kept so that the places stay theirs.
    failed: HashMap<usize, Rc<Ast>>,
    rates: Forward<Rate>,
    partials: HashMap<Symbol, Forward<Partial>>,
}

impl Bench {
    /// Around a graph.
    pub fn new(graph: Graph) -> Bench {
        Bench {
            graph,
            facts: Facts::default(),
            problems: Vec::new(),
            needs: Vec::new(),
            measured: Measure::Unknown,
            work: 0,
            exhausted: false,
            failed: HashMap::new(),
            rates: Forward::new(rate_of_symbol),
            partials: HashMap::new(),
        }
    }

    /// Counts work; false (and one problem) once there is too much of it.
    pub fn spend(&mut self, amount: u64, place: &Place) -> bool {
        self.work = self.work.saturating_add(amount);
        let spent = self.work > WORK_LIMIT || self.graph.overflowed();
        if spent && !self.exhausted {
            self.exhausted = true;
            self.problems.push(names::too_many_nodes(place.clone(), 1_000_000));
        }
        !spent
    }

    /// True once the limits of section 11 were met.
    pub fn exhausted(&self) -> bool {
        self.exhausted
    }

    /// What an expression depends on.
    pub fn depends(&mut self, ids: &[Id]) -> Depends {
        self.facts.of_all(&self.graph, ids)
    }

    /// The total time derivative; the expression must contain no accelerations.
    pub fn rate(&mut self, x: Id) -> Id {
        self.rates.of(&mut self.graph, x)
    }

    /// The total time derivatives of components.
    pub fn rates(&mut self, x: &[Id]) -> Vec<Id> {
        x.iter().map(|x| self.rate(*x)).collect()
    }

    /// ∂x/∂symbol; 0 (and a problem at `place`) once there is too much to do.
    pub fn partial(&mut self, x: Id, symbol: Symbol, place: &Place) -> Id {
        let by = move |_: &mut Graph, s: Symbol| if s == symbol { Id::ONE } else { Id::ZERO };
        let forward = self.partials.entry(symbol).or_insert_with(|| Forward::new(Box::new(by) as Partial));
        let before = forward.known();
        let slope = forward.of(&mut self.graph, x);
        let visited = forward.known() - before;
        if self.spend(visited as u64, place) { slope } else { Id::ZERO }
    }

    /// The value of an expression.
    pub fn value(&mut self, scope: &Scope, text: &Text, rules: Rules, locals: &[(String, Local)]) -> Value {
        self.once(text, |bench| Lower::new(bench, scope, text, rules, locals).measured(&text.ast))
            .unwrap_or(Value::Poison)
    }

    /// Both sides of an equation; of an expression without `=`, the value and nothing.
    pub fn equation(
        &mut self,
        scope: &Scope,
        text: &Text,
        rules: Rules,
        locals: &[(String, Local)],
    ) -> (Value, Option<Value>) {
        self.once(text, |bench| Lower::new(bench, scope, text, rules, locals).equation(&text.ast))
            .unwrap_or((Value::Poison, None))
    }

    /// What a text gives; nothing once it has raised a problem, for members of a family share their text.
    fn once<T>(&mut self, text: &Text, lower: impl FnOnce(&mut Bench) -> T) -> Option<T> {
        let place = Rc::as_ptr(&text.ast) as usize;
        self.measured = Measure::Unknown;
        if self.failed.contains_key(&place) {
            return None;
        }
        let before = self.problems.len();
        let value = lower(self);
        // Problems found while values are missing are found again.
        if self.problems.len() > before && self.needs.is_empty() {
            self.failed.insert(place, Rc::clone(&text.ast));
        }
        Some(value)
    }

    /// The value of an expression or a list.
    pub fn written(&mut self, scope: &Scope, written: &Written, rules: Rules, locals: &[(String, Local)]) -> Value {
        match written {
            Written::One(text) => self.value(scope, text, rules, locals),
            Written::List(texts, place) => {
                let mut all = Measure::Zero;
                let mut components: Vec<Option<Id>> = Vec::new();
                for text in texts {
                    components.push(self.scalar(scope, text, rules.like(Measure::Unknown), locals));
                    if !is_bare(&text.ast, locals) {
                        all = self.like(all, texts, text);
                    }
                }
                let bare = texts.iter().all(|text| is_bare(&text.ast, locals));
                self.measured = if bare { Measure::ONE } else { all };
                if scope.dimension != components.len() {
                    let found = components.len();
                    self.problems.push(names::vector_size(Place::clone(place), scope.dimension, found));
                    return Value::Poison;
                }
                components.into_iter().collect::<Option<Vec<Id>>>().map_or(Value::Poison, Value::Vector)
            }
        }
    }

    /// A number; `None` if it is none (reported) or poisoned.
    pub fn scalar(&mut self, scope: &Scope, text: &Text, rules: Rules, locals: &[(String, Local)]) -> Option<Id> {
        let value = self.value(scope, text, rules, locals);
        let scalar = self.want_scalar(value, text)?;
        let place = text.place.at(text.ast.span);
        let words = text.words(text.ast.span);
        self.want(scope.units.wanted(rules.unit), rules.what, is_bare(&text.ast, locals), words, &place);
        Some(scalar)
    }

    /// A vector; `None` if it is none (reported) or poisoned.
    pub fn vector(
        &mut self,
        scope: &Scope,
        written: &Written,
        rules: Rules,
        locals: &[(String, Local)],
    ) -> Option<Vec<Id>> {
        let place = Place::clone(written.place());
        match self.written(scope, written, rules, locals) {
            Value::Vector(v) => {
                let (words, bare) = match written {
                    Written::One(text) => (text.source.to_string(), is_bare(&text.ast, locals)),
                    Written::List(texts, _) => {
                        let words: Vec<&str> = texts.iter().map(|text| &*text.source).collect();
                        (format!("[{}]", words.join(", ")), texts.iter().all(|text| is_bare(&text.ast, locals)))
                    }
                };
                self.want(scope.units.wanted(rules.unit), rules.what, bare, &words, &place);
                Some(v)
            }
            Value::Nothing => Some(vec![Id::ZERO; scope.dimension]),
            Value::Poison => None,
            value @ Value::Scalar(_) => {
                self.problems.push(names::not_a_vector(place, value.describe()));
                None
            }
        }
    }

    /// A value in SI.  Its unit converts it where it is a pure number: what is computed from quantities with units
    /// is in SI already, and must be of that unit.
    pub fn quantity(
        &mut self,
        scope: &Scope,
        quantity: &Quantity,
        rules: Rules,
        locals: &[(String, Local)],
    ) -> Option<Id> {
        let value = self.scalar(scope, &quantity.text, rules.like(Measure::Unknown), locals)?;
        let value = match &quantity.unit {
            Some((_, unit)) => self.converted(value, unit, &quantity.text),
            None => value,
        };
        let bare = quantity.unit.is_none() && is_bare(&quantity.text.ast, locals);
        let place = quantity.text.place.at(quantity.text.ast.span);
        self.want(scope.units.wanted(rules.unit), rules.what, bare, &quantity.text.source, &place);
        Some(value)
    }

    /// As [`Bench::quantity`], where a pure number is in the unit of what it sets.
    pub fn setting(
        &mut self,
        scope: &Scope,
        quantity: &Quantity,
        rules: Rules,
        locals: &[(String, Local)],
    ) -> Option<Id> {
        let value = self.quantity(scope, quantity, rules.like(Measure::Unknown), locals)?;
        if quantity.unit.is_some() || self.measured != Measure::ONE {
            let place = quantity.text.place.at(quantity.text.ast.span);
            self.want(scope.units.wanted(rules.unit), rules.what, false, &quantity.text.source, &place);
        }
        Some(value)
    }

    /// A value with a unit after it, in SI.
    pub fn converted(&mut self, value: Id, unit: &Unit, text: &Text) -> Id {
        let dimension = Dimension::of(unit);
        let pure = match self.measured {
            Measure::Of(found) => found == Dimension::ONE,
            Measure::Zero => true,
            Measure::Unknown => !self.depends(&[value]).meets(Depends::UNIT),
        };
        if !pure {
            let place = text.place.at(text.ast.span);
            self.want(Measure::Of(dimension), "its unit", false, text.words(text.ast.span), &place);
        }
        self.measured = Measure::Of(dimension);
        if !pure {
            return value;
        }
        let factor = self.graph.float(unit.factor());
        self.graph.mul(factor, value)
    }

    /// Reports a value that was evaluated last and is not in the unit that is wanted.  A bare number is in that unit.
    pub fn want(&mut self, wanted: Measure, what: &str, bare: bool, words: &str, place: &Place) {
        if bare && matches!(wanted, Measure::Of(_)) {
            self.measured = wanted;
        }
        if let (None, Measure::Of(found), Measure::Of(wanted)) = (self.measured.alike(wanted), self.measured, wanted) {
            let help = match found {
                Dimension::ONE => "numbers in sums and products are pure, and so are angles; parameters carry units",
                _ => "",
            };
            let problem = units::wrong_unit(place.clone(), words, found.described(), what, wanted.wanted(), help);
            self.problems.push(problem);
            self.measured = Measure::Unknown;
        }
    }

    /// The unit of a component that was evaluated last and those before it; reports when they differ.
    fn like(&mut self, all: Measure, texts: &[Text], text: &Text) -> Measure {
        if let Some(measure) = all.alike(self.measured) {
            return measure;
        }
        let unit = |measure: Measure| measure.dimension().unwrap_or_default().described();
        let first = texts.first().map_or("", |text| &text.source);
        let place = text.place.at(text.ast.span);
        let problem = units::unlike_terms(place, first, unit(all), &text.source, unit(self.measured));
        self.problems.push(problem);
        Measure::Unknown
    }

    fn want_scalar(&mut self, value: Value, text: &Text) -> Option<Id> {
        match value {
            Value::Scalar(x) => Some(x),
            Value::Nothing => Some(Id::ZERO),
            Value::Poison => None,
            Value::Vector(_) => {
                let place = text.place.at(text.ast.span);
                self.problems.push(names::not_a_scalar(place, value.describe()));
                None
            }
        }
    }
}

impl Written {
    /// Where it stands.
    pub fn place(&self) -> &Rc<Place> {
        match self {
            Written::One(text) => &text.place,
            Written::List(_, place) => place,
        }
    }
}

impl Text {
    /// The words at a span.
    pub fn words(&self, span: Span) -> &str {
        words(&self.source, span)
    }
}

/// The words of a text at a span.
pub fn words(source: &str, span: Span) -> &str {
    source.get(span.range()).unwrap_or(source)
}

/// d/dt of a symbol: time runs at 1, coordinates and inputs at their rates, parameters and dummies stand still.
fn rate_of_symbol(graph: &mut Graph, symbol: Symbol) -> Id {
    match (symbol, symbol.rate()) {
        (Symbol::Time, _) => Id::ONE,
        (_, Some(rate)) => graph.symbol(rate),
        _ => Id::ZERO,
    }
}
