//! Where syntax becomes expressions: the graph, what is known of its nodes, and the problems found.

use std::collections::HashMap;
use std::rc::Rc;

use super::dimension::Measure;
use super::facts::{Depends, Facts};
use super::lower::{Local, Lower};
use super::quantities::stands_alone;
use super::rules::Rules;
use super::scope::Scope;
use super::value::Value;
use crate::diagnose::catalogue::{names, units};
use crate::diagnose::{Place, Problem};
use crate::expr::{Forward, Graph, Id, Symbol};
use crate::file::{Text, Written};
use crate::language::Ast;
use crate::model::resolved::Tried;
use crate::model::ways::WrittenAlong;

type Rate = fn(&mut Graph, Symbol) -> Id;
type Partial = Box<dyn Fn(&mut Graph, Symbol) -> Id>;

/// How many syntax nodes a model may expand to.
const WORK_LIMIT: u64 = 5_000_000;

/// The place where expressions are made.
pub struct ExprBuilder {
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
    /// The defaults of the free parameters.
    pub defaults: Vec<f64>,
    /// What each scene gives parameters and coordinates.
    pub settings: Vec<Vec<(Symbol, f64)>>,
    /// Integrals by rules of quadrature, and where these were tried.
    pub integrals: Vec<Tried>,
    /// Squares of the lengths of axes, which no scene may make 0.
    pub lengths: Vec<(Id, Place)>,
    /// Along the axes of which frames vectors are written.
    pub along: WrittenAlong,
    work: u64,
    exhausted: bool,
    /// Texts that raised problems, by the place of their trees, which are kept so that the places stay theirs.
    failed: HashMap<usize, Rc<Ast>>,
    /// Texts with problems of units only, likewise.
    mismeasured: HashMap<usize, Rc<Ast>>,
    rates: Forward<Rate>,
    partials: HashMap<Symbol, Forward<Partial>>,
}

impl ExprBuilder {
    /// Around a graph.
    pub fn new(graph: Graph) -> ExprBuilder {
        ExprBuilder {
            graph,
            facts: Facts::default(),
            problems: Vec::new(),
            needs: Vec::new(),
            measured: Measure::Unknown,
            defaults: Vec::new(),
            settings: Vec::new(),
            integrals: Vec::new(),
            lengths: Vec::new(),
            along: WrittenAlong::default(),
            work: 0,
            exhausted: false,
            failed: HashMap::new(),
            mismeasured: HashMap::new(),
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
        let value = self
            .once(text, |builder| Lower::new(builder, scope, text, rules, locals).measured(&text.ast))
            .unwrap_or(Value::Poison);
        match &text.unit {
            Some(unit) => {
                let measured = self.measured;
                value.map(|x| {
                    self.measured = measured;
                    self.converted(x, unit, text)
                })
            }
            None => value,
        }
    }

    /// Both sides of an equation; of an expression without `=`, the value and nothing.
    pub fn equation(
        &mut self,
        scope: &Scope,
        text: &Text,
        rules: Rules,
        locals: &[(String, Local)],
    ) -> (Value, Option<Value>) {
        self.once(text, |builder| Lower::new(builder, scope, text, rules, locals).equation(&text.ast))
            .unwrap_or((Value::Poison, None))
    }

    /// What a text gives; nothing once it has raised a problem, for members of a family share their text.
    fn once<T>(&mut self, text: &Text, lower: impl FnOnce(&mut ExprBuilder) -> T) -> Option<T> {
        let place = Rc::as_ptr(&text.ast) as usize;
        self.measured = Measure::Unknown;
        if self.failed.contains_key(&place) {
            return None;
        }
        let before = self.problems.len();
        let value = lower(self);
        if self.mismeasured.contains_key(&place) && self.sound_since(before) {
            // Told already, of another member.
            self.problems.truncate(before);
        }
        // Problems found while values are missing are found again.
        if self.problems.len() > before && self.needs.is_empty() {
            let told = if self.sound_since(before) { &mut self.mismeasured } else { &mut self.failed };
            told.insert(place, Rc::clone(&text.ast));
        }
        Some(value)
    }

    /// Whether all problems since there were so many are of units only, which leave a value its meaning.
    pub fn sound_since(&self, before: usize) -> bool {
        self.problems.get(before..).unwrap_or_default().iter().all(is_of_units)
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
                    if !stands_alone(text, locals) {
                        all = self.like(all, texts, text);
                    }
                }
                let bare = texts.iter().all(|text| stands_alone(text, locals));
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
        self.expect_unit(scope.units.expected(rules.unit), rules.what, stands_alone(text, locals), words, &place);
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
            Value::Vector(v) if v.len() != scope.dimension => {
                self.problems.push(names::vector_size(place, scope.dimension, v.len()));
                None
            }
            Value::Vector(v) => {
                let (words, bare) = match written {
                    Written::One(text) => (text.source.to_string(), stands_alone(text, locals)),
                    Written::List(texts, _) => {
                        let words: Vec<&str> = texts.iter().map(|text| &*text.source).collect();
                        (format!("[{}]", words.join(", ")), texts.iter().all(|text| stands_alone(text, locals)))
                    }
                };
                self.expect_unit(scope.units.expected(rules.unit), rules.what, bare, &words, &place);
                Some(v)
            }
            Value::Nothing => Some(vec![Id::ZERO; scope.dimension]),
            Value::Poison | Value::Orientation(_) => None,
            value @ Value::Scalar(_) => {
                let mut problem = names::not_a_vector(place, value.describe());
                if let Written::One(text) = written {
                    problem.help = with_components(scope.dimension, &text.source);
                    if let axis @ ("x" | "y" | "z") = text.source.trim() {
                        problem.help += &format!("; the direction of the axis is `ground.{axis}`");
                    }
                }
                self.problems.push(problem);
                None
            }
        }
    }

    fn want_scalar(&mut self, value: Value, text: &Text) -> Option<Id> {
        match value {
            Value::Scalar(x) => Some(x),
            Value::Nothing => Some(Id::ZERO),
            Value::Poison | Value::Orientation(_) => None,
            Value::Vector(_) => {
                let place = text.place.at(text.ast.span);
                self.problems.push(names::not_a_scalar(place, value.describe()));
                None
            }
        }
    }
}

/// Whether a problem is of the units of an expression, which has its value all the same.
pub fn is_of_units(problem: &Problem) -> bool {
    units::ENTRIES.iter().any(|entry| entry.code == problem.code)
}

/// d/dt of a symbol: time runs at 1, coordinates and inputs at their rates, parameters and dummies stand still.
fn rate_of_symbol(graph: &mut Graph, symbol: Symbol) -> Id {
    match (symbol, symbol.rate()) {
        (Symbol::Time, _) => Id::ONE,
        (_, Some(rate)) => graph.symbol(rate),
        _ => Id::ZERO,
    }
}

/// How a number that stands where a vector is wanted is written along the last axis, as gravity mostly is, or along the first.
fn with_components(dimension: usize, number: &str) -> String {
    let along = |axis: usize| {
        let parts: Vec<&str> = (0..dimension).map(|i| if i == axis { number } else { "0" }).collect();
        format!("`[{}]`", parts.join(", "))
    };
    format!(
        "write its components in ground axes: {} along {}, or {} along x",
        along(dimension - 1),
        if dimension == 2 { "y" } else { "z" },
        along(0)
    )
}
