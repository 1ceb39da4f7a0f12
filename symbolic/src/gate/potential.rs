//! Whether a force has a potential (lecture 3 of TAM 4735; Goldstein, Classical Mechanics, 1980, section 1-2).
//!
//! A generalized force Q(q, t) that depends on no velocity has one, in any simply connected region, exactly where
//! ∂Qᵢ/∂qⱼ = ∂Qⱼ/∂qᵢ.  Both are tested at random states by exact derivatives along two random directions u and w:
//! u·(∂Q/∂q)w = w·(∂Q/∂q)u for all u and w says the same, in two passes whatever the number of coordinates.  Where Q
//! jumps, it must jump across the surface on which it does.

use super::claims::{Crossing, Sides, with_modes};
use super::effects::{Effect, Kind};
use super::motion::Motion;
use super::state::{State, describe};
use super::states::States;
use crate::derive::introduce;
use crate::expr::{Forward, Graph, Id, Measured, Symbol, Tape, jacobian};
use crate::model::Model;
use crate::number::DoubleDouble;
use crate::random::Random;

/// With more coordinates than this the largest component of a curl is not looked for.
const SEARCHED: usize = 40;

/// What kind of force an entry is.
#[derive(Clone, Debug, PartialEq)]
pub enum Nature {
    /// Its generalized force vanishes: it does no work on any motion.
    Idle,
    /// It has a potential.
    Potential,
    /// At any one time it has a potential, which changes with time.
    TimeDependent,
    /// It depends on velocity, so it has none; `idle` where it does no work all the same (a magnetic force).
    Velocity {
        /// True where its power vanishes in all states.
        idle: bool,
    },
    /// ∂Qᵢ/∂qⱼ differs from ∂Qⱼ/∂qᵢ.
    Curl {
        /// Names of the coordinates i and j between which the difference is largest, where they were found.
        between: Option<(String, String)>,
        /// The difference.
        value: f64,
        /// A state where it is found, in words.
        state: String,
    },
}

/// What was found about the entries of `forces`, `torques` and `generalized_forces`.
#[derive(Clone, Debug, PartialEq)]
pub struct Conservative {
    /// The key above the entry, `forces`; empty for all entries together.
    pub section: String,
    /// The entry's name.
    pub name: String,
    /// What it is.
    pub nature: Nature,
}

/// The nature of each force, and of all together where they have a potential that some of them lacks alone.
pub(super) fn natures(
    graph: &mut Graph,
    model: &Model,
    motion: &Motion,
    effects: &[Effect],
    states: &States,
) -> Vec<Conservative> {
    // What acts in some phases only, or depends on reactions, is no function of the state alone.
    let forces: Vec<&Effect> = effects.iter().filter(|e| e.kind == Kind::Force && bound(graph, e).is_none()).collect();
    let mut found: Vec<Conservative> = forces
        .iter()
        .map(|effect| {
            let section = match effect.place.path.first() {
                Some(crate::diagnose::Step::Key(key)) => key.clone(),
                _ => String::new(),
            };
            let nature = nature(graph, model, motion, &effect.force, states);
            Conservative { section, name: effect.name.clone(), nature }
        })
        .collect();
    if found.len() > 1 && found.iter().any(|f| matches!(f.nature, Nature::Curl { .. })) {
        let together = sum(graph, &forces);
        if matches!(nature(graph, model, motion, &together, states), Nature::Potential | Nature::Idle) {
            found.push(Conservative { section: String::new(), name: String::new(), nature: Nature::Potential });
        }
    }
    found
}

/// Why a force cannot have a potential whatever it is like in one phase: in words that follow its name.
pub(super) fn bound(graph: &Graph, effect: &Effect) -> Option<&'static str> {
    let symbols = graph.symbols(effect.force.iter().copied());
    let reacts = |s: &Symbol| matches!(s, Symbol::Multiplier(_) | Symbol::Acceleration(_));
    if symbols.iter().any(reacts) {
        return Some("depends on reactions and has no potential");
    }
    let phase = |s: &Symbol| matches!(s, Symbol::Phase(_));
    symbols.iter().any(phase).then_some("acts in some phases only, so that `energy` does not count its work")
}

/// The generalized force of several entries.
pub(super) fn sum(graph: &mut Graph, effects: &[&Effect]) -> Vec<Id> {
    let n = effects.first().map_or(0, |effect| effect.force.len());
    (0..n).map(|i| effects.iter().fold(Id::ZERO, |total, effect| graph.add(total, effect.force[i]))).collect()
}

/// Directions in the space of coordinates, as symbols: component i of direction k of n coordinates.
fn component(k: usize, n: usize, i: usize) -> Symbol {
    Symbol::Dummy((k * n + i) as u32)
}

/// The kind of the generalized force Q.
fn nature(graph: &mut Graph, model: &Model, motion: &Motion, force: &[Id], states: &States) -> Nature {
    let tests = ForceTests::of(graph, force);
    let ForceTraits { acts, velocity, time, works, turning } = traits(graph, model, motion, &tests, &states.all);
    match turning {
        _ if !acts => Nature::Idle,
        _ if velocity => Nature::Velocity { idle: !works },
        Some(state) => largest_curl(graph, model, tests.curl, state),
        None => match sheared(graph, force, &states.surfaces) {
            Some(state) => Nature::Curl { between: None, value: f64::INFINITY, state: describe(model, state) },
            None if time => Nature::TimeDependent,
            None => Nature::Potential,
        },
    }
}

/// What tells the kind of a generalized force Q, along random directions u and w in the space of coordinates.
struct ForceTests {
    /// How many components Q has.
    n: usize,
    /// u·Q.
    along: Id,
    /// Its derivative along w in the space of speeds.
    by_velocity: Id,
    /// Its derivative by time and inputs, each of which moves at a rate of its own.
    by_time: Id,
    /// u·(∂Q/∂q)w − w·(∂Q/∂q)u.
    curl: Id,
    /// q'·Q.
    power: Id,
}

impl ForceTests {
    fn of(graph: &mut Graph, force: &[Id]) -> ForceTests {
        let n = force.len();
        let along = |graph: &mut Graph, k: usize| {
            let mut total = Id::ZERO;
            for (i, q) in force.iter().enumerate().filter(|(_, q)| **q != Id::ZERO) {
                let u = graph.symbol(component(k, n, i));
                let term = graph.mul(u, *q);
                total = graph.add(total, term);
            }
            total
        };
        let (first, second) = (along(graph, 0), along(graph, 1));
        let derivative = |graph: &mut Graph, root: Id, rate: &dyn Fn(Symbol) -> Option<Symbol>| {
            Forward::new(|g: &mut Graph, s| rate(s).map_or(Id::ZERO, |r| g.symbol(r))).of(graph, root)
        };
        let by_velocity = derivative(graph, first, &|s| match s {
            Symbol::Speed(j) => Some(component(1, n, j as usize)),
            _ => None,
        });
        let by_time = derivative(graph, first, &|s| match s {
            Symbol::Time => Some(component(2, n, 0)),
            Symbol::Input(k, order) => Some(component(2, n, 1 + 4 * k as usize + usize::from(order))),
            _ => None,
        });
        let by_position = [(first, 1), (second, 0)].map(|(root, k)| {
            derivative(graph, root, &|s| match s {
                Symbol::Coordinate(j) => Some(component(k, n, j as usize)),
                _ => None,
            })
        });
        let curl = graph.sub(by_position[0], by_position[1]);
        let mut power = Id::ZERO;
        for (i, q) in force.iter().enumerate() {
            let v = graph.symbol(Symbol::Speed(i as u32));
            let term = graph.mul(v, *q);
            power = graph.add(power, term);
        }
        ForceTests { n, along: first, by_velocity, by_time, curl, power }
    }
}

/// What a generalized force does in some of the states.
#[derive(Default)]
struct ForceTraits<'a> {
    /// It does not vanish.
    acts: bool,
    /// It depends on velocity.
    velocity: bool,
    /// It depends on time.
    time: bool,
    /// It does work.
    works: bool,
    /// The first state in which it has a curl.
    turning: Option<&'a State>,
}

/// Evaluates what tells the kind of a force in all states.
fn traits<'a>(
    graph: &Graph,
    model: &Model,
    motion: &Motion,
    tests: &ForceTests,
    states: &'a [State],
) -> ForceTraits<'a> {
    let n = tests.n;
    let tape = Tape::new(graph, &[tests.along, tests.by_velocity, tests.by_time, tests.curl, tests.power]);
    let mut found = ForceTraits::default();
    let mut random = Random::new();
    for (k, state) in states.iter().enumerate() {
        let directions: Vec<f64> = (0..2 * n + 1 + 4 * model.inputs.len()).map(|_| random.between(-1.0, 1.0)).collect();
        let at = |state: &State| {
            tape.evaluate(|s| match s {
                Symbol::Dummy(k) => {
                    Measured::exact(DoubleDouble::from(directions.get(k as usize).copied().unwrap_or(0.0)))
                }
                _ => state.measured(s),
            })
        };
        let here = at(state);
        let differs = |x: &Measured| x.value.is_finite() && !x.vanishes(super::ROUNDINGS);
        found.acts |= differs(&here[0]);
        found.velocity |= differs(&here[1]);
        found.time |= differs(&here[2]);
        found.works |= differs(&here[4]);
        if differs(&here[3]) && found.turning.is_none() {
            found.turning = Some(state);
        }
        let at_another_time = |s: &mut State, t: DoubleDouble| {
            s.t = t;
            motion.signals(s);
        };
        // What switches with speed or time has no derivative that tells: the values at another speed and time do.
        let other = &states[(k + 1) % states.len()];
        let changed = |with: &dyn Fn(&mut State)| {
            let mut moved = state.clone();
            with(&mut moved);
            let there = at(&moved)[0];
            let gap = (there.value - here[0].value).abs().to_f64();
            gap.is_finite() && gap > 1e-20 * (there.magnitude + here[0].magnitude)
        };
        found.velocity = found.velocity
            || changed(&|s| s.v.clone_from(&other.v))
            || changed(&|s| s.v.iter_mut().for_each(|v| *v = -*v));
        found.time = found.time || changed(&|s| at_another_time(s, other.t));
    }
    found
}

/// A state at which a force jumps in another direction than across its discontinuity: work depends on where that is
/// crossed, and no derivative tells.
fn sheared<'a>(graph: &mut Graph, force: &[Id], surfaces: &'a [State]) -> Option<&'a State> {
    let (roots, switches) = introduce(graph, force, 0);
    let arguments: Vec<Id> = switches.iter().map(|switch| switch.argument).collect();
    let column = |s: Symbol| if let Symbol::Coordinate(i) = s { Some(i as usize) } else { None };
    let slopes = jacobian(graph, &arguments, column);
    let slopes: Vec<(Vec<usize>, Tape)> = slopes
        .into_iter()
        .map(|line| {
            (line.iter().map(|e| e.0).collect(), Tape::new(graph, &line.iter().map(|e| e.1).collect::<Vec<Id>>()))
        })
        .collect();
    let sides = Sides::new(graph, &roots, &switches);
    surfaces.iter().find(|state| {
        let Some(Crossing { before, after, met, modes }) = sides.at(state) else { return false };
        // Where several meet nothing is said.
        let [k] = met[..] else { return false };
        let (places, tape) = &slopes[k];
        let across = tape.evaluate(|s| with_modes(state, &modes, s));
        let largest =
            places.iter().zip(&across).max_by(|a, b| a.1.value.abs().to_f64().total_cmp(&b.1.value.abs().to_f64()));
        let Some((pivot, steepest)) = largest.filter(|(_, x)| !x.vanishes(super::ROUNDINGS)) else { return false };
        let slope = |i: usize| places.iter().position(|p| *p == i).map(|k| across[k]);
        let jump = |i: usize| (after[i].value - before[i].value, after[i].magnitude + before[i].magnitude);
        (0..force.len()).any(|i| {
            let (own, other) = (jump(i), jump(*pivot));
            let (turned, size) = match slope(i) {
                Some(x) => (other.0 * x.value, other.1 * x.magnitude),
                None => (DoubleDouble::ZERO, 0.0),
            };
            let difference = (own.0 * steepest.value - turned).abs().to_f64();
            difference.is_finite() && difference > 1e-20 * (own.1 * steepest.magnitude + size)
        })
    })
}

/// The two coordinates between which a force's curl is largest at a state.
fn largest_curl(graph: &Graph, model: &Model, curl: Id, state: &State) -> Nature {
    let n = model.coordinates.len();
    let tape = Tape::new(graph, &[curl]);
    let between = |i: usize, j: usize| {
        let chosen = [component(0, n, i), component(1, n, j)];
        let value = |s: Symbol| match s {
            Symbol::Dummy(_) => DoubleDouble::from(f64::from(u8::from(chosen.contains(&s)))),
            _ => state.value(s),
        };
        tape.evaluate(value)[0].to_f64()
    };
    let searched = n.min(SEARCHED);
    let pairs = (0..searched).flat_map(|i| (i + 1..searched).map(move |j| (i, j)));
    let largest = pairs.map(|(i, j)| (i, j, between(i, j))).max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()));
    let name = |i: usize| model.coordinates[i].name.clone();
    let (between, value) = match largest {
        Some((i, j, value)) if value != 0.0 => (Some((name(i), name(j))), value),
        _ => (None, f64::NAN),
    };
    Nature::Curl { between, value, state: describe(model, state) }
}
