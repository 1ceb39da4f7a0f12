//! Expressions from the command line: in the names of a resolved model.

use std::f64::consts::TAU;
use std::rc::Rc;

use super::expression::builder::ExprBuilder;
use super::expression::dimension::{Dimension, Measure};
use super::expression::lower::Local;
use super::expression::radians;
use super::expression::rules::Rules;
use super::expression::scope::Member;
use super::expression::value::Value;
use super::resolved::Model;
use super::section::changing_mass::has_steps;
use super::section::noise::{bad_seed, is_seed};
use super::section::springs::LENGTH;
use crate::diagnose::catalogue::{mechanics, names};
use crate::diagnose::{Place, Problem};
use crate::expr::{Binary, Graph, Id, Node, Symbol, Tape, Unary, substitute};
use crate::file;
use crate::file::Text;
use crate::language::parse;

/// What a value from the command line sets, which has a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sets {
    /// Something of any unit.
    Any,
    /// A time.
    Time,
    /// An angular frequency; in Hz, kHz and so on a number of cycles a second.
    Frequency,
    /// A pure number.
    Number,
    /// A free parameter, by its place.
    Parameter(usize),
    /// A coordinate, by its place.
    Coordinate(usize),
    /// The velocity of a coordinate, by its place.
    Speed(usize),
    /// An input, by its place.
    Input(usize),
    /// A held value, by its place.
    Memory(usize),
    /// An output or a component of it, by its place.
    Output(usize),
    /// An energy.
    Energy,
    /// A force at a point.
    Force,
    /// A couple.
    Couple,
    /// A generalized force on a coordinate, by the coordinate's place.
    ForceOn(usize),
}

/// What a scene is run for.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// Coordinates, rates (with a prime) and outputs; none: all coordinates and outputs.
    pub outputs: Vec<String>,
    /// How exactly, in parts of the range that each goes through.
    pub within: f64,
    /// What is wanted to an amount of its own, SI.
    pub absolute: Vec<(String, f64)>,
}

impl Model {
    /// The components of an expression that may stand in `outputs`.
    ///
    /// # Errors
    /// What is wrong with it; places are spans of `text`.
    pub fn expression(&mut self, text: &str) -> Result<Vec<Id>, Vec<Problem>> {
        self.components(text, &[])
    }

    fn components(&mut self, text: &str, locals: &[(String, Local)]) -> Result<Vec<Id>, Vec<Problem>> {
        let text = read(text)?;
        let mut builder = self.builder();
        let value = builder.value(&self.scope, &text, Rules::anything("an expression").numbers_fit(), locals);
        self.take_back(builder)?;
        let value = self.without_state_rates(value);
        match value {
            Value::Scalar(x) => Ok(vec![x]),
            Value::Vector(v) => Ok(v),
            Value::Nothing | Value::Poison | Value::Orientation(_) => Ok(vec![Id::ZERO]),
        }
    }

    /// What the rates of states are in their place; the symbols of states themselves are the speeds of their coordinates here.
    fn without_state_rates(&mut self, value: Value) -> Value {
        if self.states.is_empty() {
            return value;
        }
        let first = self.mechanical();
        let place = |j: usize| (first + j) as u32;
        let mut known = rustc_hash::FxHashMap::default();
        for (j, state) in self.states.iter().enumerate() {
            known.insert(Symbol::State(j as u32), self.graph.symbol(Symbol::Speed(place(j))));
            known.insert(Symbol::StateRate(j as u32), state.rate);
        }
        value.map(|x| substitute(&mut self.graph, &[x], &known)[0])
    }

    /// The components of a law of a force or an energy, in which a spring's `length` may stand.
    ///
    /// # Errors
    /// What is wrong with it; places are spans of `text`.
    pub fn law(&mut self, text: &str) -> Result<Vec<Id>, Vec<Problem>> {
        let length = Local::Symbol(LENGTH, self.scope.units.of(Dimension::LENGTH));
        self.components(text, &[("length".to_owned(), length)])
    }

    /// The unit in SI of an expression that may stand in `outputs`; `None` where it is a pure number, not known, or wrong.
    pub fn unit_of(&mut self, text: &str) -> Option<String> {
        let text = read(text).ok()?;
        let mut builder = self.builder();
        builder.value(&self.scope, &text, Rules::anything("an expression").numbers_fit(), &[]);
        let dimension = builder.measured.dimension();
        self.take_back(builder).ok()?;
        let known = dimension.filter(|dimension| *dimension != Dimension::ONE);
        known.map(|dimension| radians::unit(dimension, Some(&text.ast), &self.scope.units.radians))
    }

    /// The number that an expression of parameters, sizes and definitions without coordinates stands for, in SI,
    /// with these values of the free parameters.  A unit may follow: `30 deg`; it must be that of what is set.
    ///
    /// # Errors
    /// What is wrong with it; places are spans of `text`.
    pub fn constant(&mut self, text: &str, sets: Sets, parameters: &[f64]) -> Result<f64, Vec<Problem>> {
        let quantity = file::quantity(text, &Place::default())?;
        let (what, unit) = self.measure_of(sets);
        let words = match sets {
            Sets::Parameter(place) => self.parameters.get(place).and_then(|parameter| parameter.unit.as_deref()),
            Sets::Speed(place) if place >= self.mechanical() => {
                self.states.get(place - self.mechanical()).and_then(|state| state.unit.as_deref())
            }
            Sets::Coordinate(place) | Sets::Speed(place) => {
                self.coordinates.get(place).and_then(|coordinate| coordinate.unit.as_deref())
            }
            _ => None,
        };
        let rules = Rules::constant(what).numbers_fit().like(unit).counting(words);
        let mut builder = self.builder();
        let value = builder.setting(&self.scope, &quantity, rules, &[]);
        self.take_back(builder)?;
        let undefined = || vec![names::undefined_value(Place::default(), text)];
        let value = value.and_then(|id| evaluate(&self.graph, id, parameters)).ok_or_else(undefined)?;
        if let Sets::Parameter(place) = sets {
            self.possible_mass(place, value)?;
            self.whole_seed(place, value)?;
        }
        let in_hertz = |unit: &str| unit.ends_with("Hz") && unit.chars().all(char::is_alphabetic);
        let cycles = sets == Sets::Frequency && quantity.unit.is_some_and(|(unit, _)| in_hertz(unit.trim()));
        Ok(if cycles { TAU * value } else { value })
    }

    /// Whether an expression contains an input.
    fn has_input(&self, value: Id, input: usize) -> bool {
        let is = |symbol: Symbol| matches!(symbol, Symbol::Input(place, _) if place as usize == input);
        self.graph.symbols([value]).into_iter().any(is)
    }

    /// What is set, in words, and the unit that it has.
    fn measure_of(&self, sets: Sets) -> (&'static str, Measure) {
        let units = &self.scope.units;
        let known = |units: &[Measure], place: usize| units.get(place).copied().unwrap_or_default();
        match sets {
            Sets::Any => ("this option", Measure::Unknown),
            Sets::Frequency => ("an angular frequency", units.of(Dimension::RATE)),
            Sets::Time => ("a time", units.of(Dimension::TIME)),
            Sets::Number => ("this option", Measure::ONE),
            Sets::Parameter(place) => ("this parameter", known(&units.parameters, place)),
            Sets::Coordinate(place) => ("this coordinate", known(&units.coordinates, place)),
            Sets::Speed(place) if place >= self.mechanical() => {
                ("this state", known(&units.states, place - self.mechanical()))
            }
            Sets::Speed(place) => ("this velocity", units.rate(known(&units.coordinates, place))),
            Sets::Input(place) => ("this input", self.measure_of_input(place)),
            Sets::Memory(place) => ("this held value", known(&units.memory, place)),
            Sets::Output(place) => {
                ("this output", self.outputs.get(place).map_or(Measure::Unknown, |output| output.measure))
            }
            Sets::Energy => ("an energy", units.of(Dimension::ENERGY)),
            Sets::Force => ("a force", units.of(Dimension::FORCE)),
            Sets::Couple => ("a couple", units.of(Dimension::ENERGY)),
            Sets::ForceOn(place) => {
                let coordinate = known(&units.coordinates, place);
                ("a force on this coordinate", units.of(Dimension::ENERGY).over(coordinate))
            }
        }
    }

    /// The unit of an input; unknown where it is a bare number.
    fn measure_of_input(&self, place: usize) -> Measure {
        let mut members = self.scope.names.values().flat_map(|entry| entry.members.values());
        let item = members.find_map(|member| match member {
            Member::Input(input, item) if *input as usize == place => Some(*item),
            _ => None,
        });
        item.and_then(|item| self.scope.units.items.get(item)).copied().unwrap_or_default()
    }

    /// A parameter that is a seed of noise is a whole number.
    ///
    /// # Errors
    /// That this one is none.
    pub fn whole_seed(&self, parameter: usize, value: f64) -> Result<(), Vec<Problem>> {
        let of = self.noise.iter().find(|noise| noise.seed == Some(parameter as u32));
        match of {
            Some(noise) if !is_seed(value) => Err(vec![bad_seed(Place::default(), &noise.name, &value.to_string())]),
            _ => Ok(()),
        }
    }

    /// Whether a value of a parameter is one that it may have where it is the mass or a moment of inertia of a body.
    ///
    /// # Errors
    /// That it is negative.
    pub fn possible_mass(&self, parameter: usize, value: f64) -> Result<(), Vec<Problem>> {
        match self.mass_of(parameter).filter(|_| value < 0.0) {
            Some(what) => Err(vec![mechanics::value_out_of_range(Place::default(), what, "positive or 0", value)]),
            None => Ok(()),
        }
    }

    /// What of a body a free parameter is as it stands.
    fn mass_of(&self, place: usize) -> Option<&'static str> {
        let is = |id: Id| matches!(self.graph.node(id), Node::Symbol(Symbol::Parameter(k)) if k as usize == place);
        let of_body = |body: &super::resolved::Body| match (is(body.mass), &body.rotation) {
            (true, _) => Some("a mass"),
            (false, Some(rotation)) if rotation.inertias().iter().any(|moment| is(*moment)) => {
                Some("a moment of inertia")
            }
            _ => None,
        };
        self.bodies.iter().find_map(of_body)
    }

    /// The value of a function of time and its first and second derivative, to take the place of this input, whose unit it has.
    ///
    /// # Errors
    /// What is wrong with it; places are spans of `text`.
    pub fn signal(&mut self, text: &str, input: usize) -> Result<[Id; 3], Vec<Problem>> {
        let quantity = file::quantity(text, &Place::default())?;
        let (what, unit) = self.measure_of(Sets::Input(input));
        let mut builder = self.builder();
        let rules = Rules::signal(what).numbers_fit().like(unit);
        let value = builder.setting(&self.scope, &quantity, rules, &[]).unwrap_or(Id::ZERO);
        let rate = builder.rate(value);
        let second = builder.rate(rate);
        self.take_back(builder)?;
        if has_steps(&self.graph, value)
            && let Some(body) = self.bodies.iter().find(|body| self.has_input(body.mass, input))
        {
            return Err(vec![mechanics::mass_jumps(Place::default(), &body.name)]);
        }
        Ok([value, rate, second])
    }

    /// What a scene is run for by its `needs`; `None` where it has none, or there is no such scene.
    pub fn need(&self, scene: &str) -> Option<Wanted> {
        let scene = self.scenes.iter().find(|known| known.name == scene)?;
        let need = scene.need.as_ref()?;
        let mut parameters: Vec<f64> = self.parameters.iter().map(|parameter| parameter.default).collect();
        let set: Vec<Id> = scene.set.iter().map(|(_, value)| *value).collect();
        for ((place, _), value) in scene.set.iter().zip(evaluate_all(&self.graph, &set, &parameters.clone())) {
            parameters[*place] = value;
        }
        let outputs = need.outputs.iter().map(|(name, _)| name.clone()).collect();
        let amount = |id: Id| evaluate(&self.graph, id, &parameters);
        let absolute = need.absolute.iter().map(|own| Some((own.name.clone(), amount(own.value)?)));
        Some(Wanted { outputs, within: amount(need.within)?, absolute: absolute.collect::<Option<_>>()? })
    }

    /// True where expressions contain discontinuities, or functions that are local through their argument: `exp`,
    /// `tanh`, powers, quotients.
    pub fn is_local(&self, roots: &[Id]) -> bool {
        let needed = self.graph.reachable(roots.iter().copied());
        (0..needed.len()).filter(|&i| needed[i]).any(|i| match self.graph.node(self.graph.id_at(i)) {
            Node::Unary(f, _) => !matches!(f, Unary::Neg | Unary::Sin | Unary::Cos),
            Node::Binary(f, ..) => !matches!(f, Binary::Add | Binary::Sub | Binary::Mul),
            Node::Number(_) | Node::Symbol(_) => false,
        })
    }

    fn builder(&mut self) -> ExprBuilder {
        let mut builder = ExprBuilder::new(std::mem::take(&mut self.graph));
        builder.defaults = self.parameters.iter().map(|p| p.default).collect();
        builder.facts.dimensional =
            self.parameters.iter().map(|p| !matches!(p.unit.as_deref(), None | Some("1"))).collect();
        builder
    }

    fn take_back(&mut self, builder: ExprBuilder) -> Result<(), Vec<Problem>> {
        self.graph = builder.graph;
        if builder.problems.is_empty() { Ok(()) } else { Err(builder.problems) }
    }
}

/// The value of an expression of parameters, if it is finite.
pub fn evaluate(graph: &Graph, id: Id, parameters: &[f64]) -> Option<f64> {
    if let Some(number) = graph.number(id) {
        return Some(number.to_f64()).filter(|x| x.is_finite());
    }
    evaluate_all(graph, &[id], parameters).first().copied().filter(|x| x.is_finite())
}

/// The values of expressions of parameters.
pub fn evaluate_all(graph: &Graph, ids: &[Id], parameters: &[f64]) -> Vec<f64> {
    Tape::new(graph, ids).evaluate(|symbol| match symbol {
        Symbol::Parameter(place) => parameters.get(place as usize).copied().unwrap_or(f64::NAN),
        _ => f64::NAN,
    })
}

fn read(words: &str) -> Result<Text, Vec<Problem>> {
    let ast = parse(words)?;
    Ok(Text { source: words.into(), ast: Rc::new(ast), unit: None, place: Rc::default() })
}
