//! `noise`: values that ticks set to normally distributed numbers (LANGUAGE, section 3).
//!
//! Each is made of what `memory` and `events` could say, but for the numbers themselves: held values, a clock, and an event that sets them.

use crate::diagnose::catalogue::{mechanics, names, noise, sections};
use crate::diagnose::{Place, Problem};
use crate::expr::{Binary, Id, Node, Number, Rational, Symbol, Unary};
use crate::file::{Quantity, Spot};
use crate::model::event::{Clock, Event, EventAction, HeldValue, Noise, Set, Target, Trigger};
use crate::model::expression::dimension::{Dimension, Measure};
use crate::model::expression::families::{Expanded, Family, Locals};
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{Member, Section};
use crate::model::resolved::Parameter;
use crate::model::resolver::Resolver;

const KEYS: [&str; 6] = ["every", "from", "sigma", "density", "seed", "smooth"];
const SIZE: Rules = Rules::constant("how large noise is");
const SEED: Rules = Rules::constant("a seed");
/// Floats hold whole numbers exactly up to here.
const LARGEST_SEED: f64 = 9_007_199_254_740_992.0;

/// Noise as declared: one member of an entry.
pub struct DeclaredNoise<'a> {
    name: String,
    spot: Spot<'a>,
    locals: Locals,
    size: Quantity,
    /// Its value, when all names are known.
    size_value: Option<Id>,
    is_density: bool,
    seed: Seed,
    /// Places of what it holds.
    held: Vec<usize>,
    value: Id,
}

/// Where a seed comes from.
#[derive(Clone)]
enum Seed {
    /// A parameter of its own.
    Own(u32),
    /// An expression of parameters.
    Given(Quantity),
}

impl<'a> Resolver<'a> {
    /// Names, units and seeds of noise; how large it is and when it ticks follows when all names are known.
    pub fn noise(&mut self) -> Vec<DeclaredNoise<'a>> {
        let mut declared = Vec::new();
        for (key, spot) in self.section("noise") {
            let Some(family) = self.expand_declared(key, &spot, Section::Noise) else { continue };
            self.declare_empty(Section::Noise, &family);
            match self.entry_of_noise(&family, &spot) {
                Some((size, is_density, smooth, seed)) => {
                    for member in &family.members {
                        let Some((held, value)) = self.hold_noise(member, &spot, (&size, is_density), smooth) else {
                            continue;
                        };
                        let (name, locals, spot) = (member.name(), member.locals.clone(), spot.clone());
                        let (size, seed) = (size.clone(), seed.clone());
                        let size_value = None;
                        declared.push(DeclaredNoise {
                            name,
                            spot,
                            locals,
                            size,
                            size_value,
                            is_density,
                            seed,
                            held,
                            value,
                        });
                    }
                }
                None => self.refuse_name(&family.key.name, Section::Noise),
            }
        }
        declared
    }

    /// What an entry says: how large it is, whether that is a density, whether it is straight between ticks, and its seed.
    fn entry_of_noise(&mut self, family: &Family, spot: &Spot<'a>) -> Option<(Quantity, bool, bool, Seed)> {
        if !spot.only(&KEYS, "noise", &mut self.builder.problems) {
            return None;
        }
        let every = spot.need("every", "noise", &mut self.builder.problems);
        let size = match (spot.get("sigma"), spot.get("density")) {
            (Some(_), Some(density)) => {
                let place = density.place.of_key();
                self.builder.problems.push(sections::conflicting_keys(place, "sigma", "density", "noise"));
                None
            }
            (None, None) => {
                if !spot.misspelt(&self.builder.problems) {
                    let place = spot.place.of_key();
                    self.builder.problems.push(sections::needs_one_of(place, "`sigma`, `density`", "noise"));
                }
                None
            }
            (sigma, density) => sigma.or(density).and_then(|size| size.quantity(&mut self.builder.problems)),
        };
        let smooth = self.smooth_noise(spot)?;
        let seed = self.seed(family, spot)?;
        every.and(size).map(|size| (size, spot.get("density").is_some(), smooth, seed))
    }

    /// Whether it is straight between ticks.
    fn smooth_noise(&mut self, spot: &Spot<'_>) -> Option<bool> {
        let Some(smooth) = spot.get("smooth") else { return Some(false) };
        match smooth.words(&mut self.builder.problems)? {
            "0" => Some(false),
            "1" => Some(true),
            other => {
                let help = "0: held from tick to tick; 1: straight between them";
                self.builder.problems.push(sections::unknown_choice(smooth.place, other, "0 or 1", help));
                None
            }
        }
    }

    /// A whole number becomes the default of a parameter of its own, NAME_seed; what names parameters is computed of these.
    fn seed(&mut self, family: &Family, spot: &Spot<'_>) -> Option<Seed> {
        let given = spot.get("seed");
        let words = match &given {
            Some(seed) => seed.words(&mut self.builder.problems)?,
            None => "0",
        };
        let Ok(number) = words.trim().parse::<f64>() else {
            return given?.quantity(&mut self.builder.problems).map(Seed::Given);
        };
        if !is_seed(number) {
            let place = given.map_or_else(|| spot.place.clone(), |seed| seed.place);
            self.builder.problems.push(bad_seed(place, &family.key.name, words));
            return None;
        }
        let (place, name) = (self.model.parameters.len() as u32, format!("{}_seed", family.key.name));
        let own = Expanded { base: name.clone(), indices: Vec::new(), locals: Locals::default() };
        if !self.declare(Section::Parameter, &own, Member::Parameter(place), &spot.place) {
            return None;
        }
        let (unit, at) = (Some("1".to_owned()), spot.place.of_key());
        self.model.parameters.push(Parameter { name, family: None, unit, default: number, place: at });
        self.scope.units.parameters.push(Measure::ONE);
        self.builder.facts.dimensional.push(false);
        self.builder.defaults.push(number);
        Some(Seed::Own(place))
    }

    /// Declares a member with what it holds.
    fn hold_noise(
        &mut self,
        member: &Expanded,
        spot: &Spot<'_>,
        (size, is_density): (&Quantity, bool),
        smooth: bool,
    ) -> Option<(Vec<usize>, Id)> {
        let measure = size.unit.as_ref().map_or(Measure::Unknown, |(_, unit)| self.note_unit(Some(unit)));
        let unit = size.unit.as_ref().filter(|_| !is_density).map(|(words, _)| words.clone());
        let (first, name) = (self.model.memory.len(), member.name());
        if !self.declare(Section::Noise, member, Member::Noise(self.scope.noise.len()), &spot.place) {
            return None;
        }
        let mut hold = |name: String, unit: Option<String>, measure: Measure| {
            self.model.memory.push(HeldValue { name, unit, start: Id::ZERO, place: spot.place.of_key() });
            self.scope.units.memory.push(measure);
        };
        hold(name.clone(), unit, if is_density { root_of_density(measure) } else { measure });
        if smooth {
            hold(format!("{name}.slope"), None, Measure::Unknown);
            hold(format!("{name}.since"), Some("s".to_owned()), Measure::Of(Dimension::TIME));
        }
        let held: Vec<usize> = (first..self.model.memory.len()).collect();
        let graph = &mut self.builder.graph;
        let symbols: Vec<Id> = held.iter().map(|j| graph.symbol(Symbol::Memory(*j as u32))).collect();
        let value = match symbols.as_slice() {
            [now, slope, since] => {
                let t = graph.symbol(Symbol::Time);
                let passed = graph.sub(t, *since);
                let risen = graph.mul(*slope, passed);
                graph.add(*now, risen)
            }
            _ => symbols[0],
        };
        self.scope.noise.push((value, first));
        Some((held, value))
    }

    /// How large noise is, and its unit, which may be that of a parameter.
    pub fn sizes_of_noise(&mut self, declared: &mut [DeclaredNoise<'a>]) {
        for DeclaredNoise { locals, size, size_value, is_density, held, .. } in declared {
            *size_value = self.setting(size, SIZE, locals);
            if size.unit.is_none() && size_value.is_some() {
                let measure = self.builder.measured;
                self.scope.units.memory[held[0]] = if *is_density { root_of_density(measure) } else { measure };
            }
        }
    }

    /// Clocks of noise, and what their ticks set.
    pub fn finish_noise(&mut self, declared: &[DeclaredNoise<'a>]) {
        for noise in declared {
            self.finish_one(noise);
        }
    }

    fn finish_one(&mut self, declared: &DeclaredNoise<'a>) -> Option<()> {
        let DeclaredNoise { name, spot, locals, held, .. } = declared;
        let size = declared.size_value?;
        self.not_negative_everywhere(&spot.get("sigma").or_else(|| spot.get("density"))?, size)?;
        let clock = self.clock(&spot.get("every")?, spot.get("from").as_ref(), locals)?;
        let (seed, own) = match &declared.seed {
            Seed::Own(place) => {
                let seed = self.builder.graph.symbol(Symbol::Parameter(*place));
                self.whole_everywhere(name, spot.get("seed").as_ref().unwrap_or(spot), seed)?;
                (seed, Some(*place))
            }
            Seed::Given(quantity) => {
                let seed = self.setting(quantity, SEED.like(Measure::ONE), locals)?;
                self.whole_everywhere(name, &spot.get("seed")?, seed)?;
                match self.builder.graph.node(seed) {
                    Node::Symbol(Symbol::Parameter(place)) => (seed, Some(place)),
                    _ => (seed, None),
                }
            }
        };
        let Clock { from, every } = self.model.clocks[clock];
        let graph = &mut self.builder.graph;
        let sigma = if declared.is_density {
            let square = graph.div(size, every);
            graph.unary(Unary::Sqrt, square)
        } else {
            size
        };
        let t = graph.symbol(Symbol::Time);
        let passed = graph.sub(t, from);
        let tick = graph.div(passed, every);
        let mut number = |place: Id| {
            let normal = graph.binary(Binary::Normal(stream(name)), seed, place);
            graph.mul(sigma, normal)
        };
        let now = number(tick);
        let mut values = vec![(Target::Memory(held[0]), now)];
        if let [_, slope, since] = held.as_slice() {
            let graph = &mut self.builder.graph;
            let next = graph.add(tick, Id::ONE);
            let normal = graph.binary(Binary::Normal(stream(name)), seed, next);
            let then = graph.mul(sigma, normal);
            let rise = graph.sub(then, now);
            values.extend([(Target::Memory(*slope), graph.div(rise, every)), (Target::Memory(*since), t)]);
        }
        self.model.sets.push(Set { values });
        self.model.noise.push(Noise {
            name: name.clone(),
            seed: own,
            event: self.model.events.len(),
            held: held.clone(),
            value: declared.value,
        });
        self.model.events.push(Event {
            name: name.clone(),
            trigger: Trigger::Tick(clock),
            when: Id::ONE,
            condition: None,
            direction: 0,
            phases: None,
            actions: vec![EventAction::Set(self.model.sets.len() - 1)],
            place: spot.place.clone(),
        });
        Some(())
    }

    /// Reports a seed that is no whole number in some scene.
    fn whole_everywhere(&mut self, name: &str, spot: &Spot<'_>, seed: Id) -> Option<()> {
        for scene in 0..self.model.scenes.len() {
            let parameters = self.scene_parameters(&self.model.scenes[scene]);
            let number = crate::model::command::evaluate(&self.builder.graph, seed, &parameters);
            if let Some(number) = number.filter(|number| !is_seed(*number)) {
                self.builder.problems.push(bad_seed(spot.place.clone(), name, &number.to_string()));
                return None;
            }
        }
        Some(())
    }

    /// Reports a size that is negative in some scene.
    fn not_negative_everywhere(&mut self, spot: &Spot<'_>, value: Id) -> Option<()> {
        for scene in 0..self.model.scenes.len() {
            let parameters = self.scene_parameters(&self.model.scenes[scene]);
            let problem = match crate::model::command::evaluate(&self.builder.graph, value, &parameters) {
                Some(number) if number >= 0.0 => continue,
                Some(number) => mechanics::value_out_of_range(spot.place.clone(), SIZE.what, "positive or 0", number),
                None => names::undefined_value(spot.place.clone(), spot.words(&mut Vec::new()).unwrap_or_default()),
            };
            self.builder.problems.push(problem);
            return None;
        }
        Some(())
    }
}

/// Whether a number is a seed.
pub(in crate::model) fn is_seed(number: f64) -> bool {
    number.fract() == 0.0 && number.abs() < LARGEST_SEED
}

/// What noise has that is no seed.
pub(in crate::model) fn bad_seed(place: Place, name: &str, words: &str) -> Problem {
    let help = "a seed is a whole number of up to 15 digits, or a parameter that is one";
    noise::bad_noise(place, name, format!("its seed is {words}"), help)
}

/// What tells the streams of names apart: FNV-1a, 64 bits.
fn stream(name: &str) -> u64 {
    let hash = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    name.bytes().fold(0xcbf2_9ce4_8422_2325, hash)
}

/// The unit of √(S/T).
fn root_of_density(density: Measure) -> Measure {
    match Rational::new(1, 2) {
        Some(half) => density.over(Measure::Of(Dimension::TIME)).power(Number::Exact(half)),
        None => Measure::Unknown,
    }
}
