//! Random parameters and states, in the file's own measure (LANGUAGE, section 8).

use std::collections::HashMap;

use super::motion::Motion;
use super::state::{Origin, State};
use super::trajectory::Trajectory;
use crate::expr::{Graph, Id, Symbol, Tape};
use crate::language::{BASES, parse_unit};
use crate::model::{Model, Rotation};
use crate::number::DoubleDouble;
use crate::random::Random;

/// What the numbers of a scene are.
struct Start {
    /// Free parameters that it sets, and their values.
    set: Vec<(usize, Id)>,
    /// Coordinates, speeds, end.
    tape: Tape,
    /// Held values.
    memory: Tape,
}

/// Lengths (angles, …) that matter, coordinate by coordinate.
struct Scales {
    /// Of positions.
    q: Vec<Vec<f64>>,
    /// Of speeds.
    v: Vec<Vec<f64>>,
}

/// Draws states, the same ones every time.
pub struct Draws<'a> {
    model: &'a Model,
    motion: &'a Motion,
    random: Random,
    drawn: usize,
    starts: Vec<Start>,
    scales: Scales,
    sample: Vec<(usize, bool, Tape)>,
    /// Masses and moments of inertia.
    inertias: Tape,
}

/// The moments of inertia of a body that are not negative.
fn principal(rotation: Option<&Rotation>) -> Vec<Id> {
    rotation.map_or_else(Vec::new, |rotation| rotation.inertias().iter().take(3).copied().collect())
}

impl<'a> Draws<'a> {
    /// Draws for a model; coarse runs of its scenes tell what its numbers are like.
    pub(super) fn new(model: &'a Model, motion: &'a Motion, trajectories: &[Trajectory]) -> Self {
        let graph = &model.graph;
        let starts = model.scenes.iter().map(|scene| {
            let roots: Vec<Id> = scene.q.iter().chain(&scene.v).copied().chain([scene.until]).collect();
            Start { set: scene.set.clone(), tape: Tape::new(graph, &roots), memory: Tape::new(graph, &scene.memory) }
        });
        let inertias: Vec<Id> =
            model.bodies.iter().flat_map(|b| std::iter::once(b.mass).chain(principal(b.rotation.as_ref()))).collect();
        let starts: Vec<Start> = starts.collect();
        Draws {
            model,
            motion,
            random: Random::new(),
            drawn: 0,
            scales: Scales::of(model, trajectories),
            starts,
            sample: model.sample.iter().map(|s| (s.coordinate, s.speed, Tape::new(graph, &[s.low, s.high]))).collect(),
            inertias: Tape::new(graph, &inertias),
        }
    }

    /// The next state, without its motion, with these parameters or drawn ones, of which `when` sets some.  Near and at large by turns.
    pub(super) fn next(&mut self, own: Option<&[f64]>, when: &[(usize, Id)]) -> State {
        self.drawn += 1;
        let large = self.drawn.is_multiple_of(2);
        let (mut state, start) = self.near(self.drawn / 2, (own, when), if large { 3.0 } else { 0.4 }, large);
        state.t = DoubleDouble::from(self.random.between(0.0, start.2));
        state.origin = if large { Origin::Large } else { Origin::Near };
        state
    }

    /// A state near a scene's start in which only some coordinates move.
    pub(super) fn group(&mut self, moving: &[usize], when: &[(usize, Id)]) -> State {
        self.drawn += 1;
        let (mut state, start) = self.near(self.drawn, (None, when), 0.4, false);
        for i in (0..state.v.len()).filter(|i| !moving.contains(i)) {
            state.v[i] = DoubleDouble::ZERO;
        }
        state.t = DoubleDouble::from(self.random.between(0.0, start.2));
        state.origin = Origin::Group;
        state
    }

    /// The first scene's start, at rest, with these parameters.
    pub(super) fn first(&mut self, own: &[f64]) -> State {
        self.place(0, (Some(own), &[]), 0.0, false).0
    }

    /// A position not far from another one.
    pub(super) fn nearby(&mut self, state: &State) -> State {
        let mut near = state.clone();
        for (i, q) in near.q.iter_mut().enumerate() {
            *q += DoubleDouble::from(self.scale(true, i) * self.random.between(-0.2, 0.2));
        }
        near.t += DoubleDouble::from(self.random.between(0.0, 0.1));
        near
    }

    /// Parameters, and coordinates and speeds about a scene's start (or about 0): the state, and the start as numbers.
    fn near(&mut self, scene: usize, set: Set<'_>, spread: f64, large: bool) -> (State, (Vec<f64>, Vec<f64>, f64)) {
        let (mut state, start) = self.place(scene, set, spread, large);
        let natural = self.natural_speeds(&mut state);
        for (i, natural) in natural.into_iter().enumerate() {
            let middle = if large { 0.0 } else { start.1[i] };
            let mut scales = self.scales.v[i].clone();
            scales.extend(natural);
            let scale = pick(&mut self.random, &scales);
            state.v[i] = DoubleDouble::from(middle + scale * self.random.between(-spread, spread));
        }
        for (coordinate, speed, range) in &self.sample {
            if *speed {
                let ends = range.evaluate(|s| state.value(s).to_f64());
                state.v[*coordinate] = DoubleDouble::from(self.random.between(ends[0], ends[1]));
            }
        }
        (state, start)
    }

    /// Parameters and coordinates about a scene's start (or about 0), at rest, and the start as numbers.
    fn place(&mut self, scene: usize, set: Set<'_>, spread: f64, large: bool) -> (State, (Vec<f64>, Vec<f64>, f64)) {
        let n = self.model.coordinates.len();
        let (parameters, rests) = self.parameters(scene, set);
        let start = self.start(scene, &parameters);
        let mut state = State { rests, ..State::at_rest(parameters, n) };
        state.memory = self.memory(scene, &state, spread, large);
        for i in 0..n {
            let middle = if large { 0.0 } else { start.0[i] };
            let scale = self.scale(true, i);
            // An angle at large goes beyond ±π.
            let spread = if large && self.is_angle(i) { spread.max(7.0) } else { spread };
            state.q[i] = DoubleDouble::from(middle + scale * self.random.between(-spread, spread));
        }
        for (coordinate, speed, range) in &self.sample {
            if !speed {
                let ends = range.evaluate(|s| state.value(s).to_f64());
                state.q[*coordinate] = DoubleDouble::from(self.random.between(ends[0], ends[1]));
            }
        }
        (state, start)
    }

    /// Held values about those at a scene's start (or about 0): events may set them to anything.
    fn memory(&mut self, scene: usize, state: &State, spread: f64, large: bool) -> Vec<f64> {
        let start = &self.starts[scene % self.starts.len()].memory;
        let starts: Vec<f64> = start.evaluate(|s| state.value(s).to_f64());
        let mut drawn = Vec::with_capacity(starts.len());
        for (j, start) in starts.into_iter().enumerate() {
            let start = if start.is_finite() { start } else { 0.0 };
            let unit = dimension(self.model.memory[j].unit.as_deref());
            let alike = self.model.parameters.iter().zip(&state.parameters);
            let alike = alike.filter(|(p, _)| unit.is_some() && dimension(p.unit.as_deref()) == unit);
            let mut scales: Vec<f64> = alike.map(|(_, x)| x.abs()).chain([start.abs()]).collect();
            distinct(&mut scales);
            let scale = if scales.is_empty() { 1.0 } else { pick(&mut self.random, &scales) };
            let middle = if large { 0.0 } else { start };
            drawn.push(middle + scale * self.random.between(-spread, spread));
        }
        drawn
    }

    /// Whether a state is where the file says that the model is defined (`sample`).
    pub(super) fn inside(&self, state: &State) -> bool {
        self.sample.iter().all(|(i, speed, range)| {
            let ends = range.evaluate(|s| state.value(s).to_f64());
            let x = if *speed { state.v[*i] } else { state.q[*i] }.to_f64();
            (ends[0].min(ends[1])..=ends[0].max(ends[1])).contains(&x)
        })
    }

    /// Brings a state to the constraints with what was drawn in the ranges of `sample` left as it is, where that can be.
    pub(super) fn hold(&self, state: &mut State) {
        if self.sample.is_empty() || self.motion.constraints.is_empty() {
            return;
        }
        let named = |rate: bool| -> Vec<bool> {
            (0..state.q.len()).map(|i| self.sample.iter().any(|(of, speed, _)| *of == i && *speed == rate)).collect()
        };
        let (places, rates) = (named(false), named(true));
        let mut closed = state.clone();
        self.motion.signals(&mut closed);
        if self.motion.constraints.close_holding(&mut closed, (&places, &rates)) {
            *state = closed;
        }
    }

    /// The largest scale of a coordinate, or of its speed.
    pub(super) fn reach(&self, i: usize, speed: bool) -> f64 {
        let scales = if speed { &self.scales.v[i] } else { &self.scales.q[i] };
        scales.last().copied().unwrap_or(1.0)
    }

    /// A scale of a coordinate.
    fn scale(&mut self, position: bool, i: usize) -> f64 {
        let scales = if position { &self.scales.q[i] } else { &self.scales.v[i] };
        pick(&mut self.random, scales)
    }

    fn is_angle(&self, i: usize) -> bool {
        dimension(self.model.coordinates[i].unit.as_deref()) == Some([0; BASES])
    }

    /// √(s |a|), what a fall from rest over the distance s gives each coordinate, with the largest a of its family: from where a chain is let go
    /// its far end hardly begins to turn.
    fn natural_speeds(&mut self, state: &mut State) -> Vec<Option<f64>> {
        let known = self.motion.complete(state).is_ok();
        let coordinates = &self.model.coordinates;
        let mut largest: HashMap<&str, f64> = HashMap::new();
        for (coordinate, a) in coordinates.iter().zip(&state.a) {
            let largest = largest.entry(coordinate.family()).or_default();
            *largest = largest.max(a.value.to_f64().abs());
        }
        let speeds = coordinates.iter().enumerate().map(|(i, coordinate)| {
            let s = pick(&mut self.random, &self.scales.q[i]);
            let speed = (s * largest.get(coordinate.family()).copied().unwrap_or(0.0)).sqrt();
            (known && speed > 0.0 && speed.is_finite()).then_some(speed)
        });
        speeds.collect()
    }

    /// Each parameter times 0.8 … 1.25; one that is 0 by default with either sign and as 0.  Masses stay positive.
    fn parameters(&mut self, scene: usize, (own, when): Set<'_>) -> (Vec<f64>, Vec<f64>) {
        let mut given: Vec<f64> = self.model.parameters.iter().map(|p| p.default).collect();
        // Every third state has the values that a scene sets.
        if self.drawn.is_multiple_of(3) {
            given = with_set(&self.model.graph, &self.starts[scene % self.starts.len()].set, given);
        }
        let zero_sign = [1.0, -1.0, 0.0][self.drawn % 3];
        let (mut parameters, mut rests) = (Vec::new(), Vec::new());
        for attempt in 0..20 {
            let drawn: Vec<f64> = given.iter().map(|&x| self.drawn_parameter(x, zero_sign)).collect();
            (parameters, rests) = with_conditions(&self.model.graph, when, own.map_or(drawn, <[f64]>::to_vec));
            let value = |s: Symbol| match s {
                Symbol::Parameter(i) => parameters.get(i as usize).copied().unwrap_or(0.0),
                _ => 0.0,
            };
            let known = parameters.iter().all(|x| x.is_finite());
            if known && self.inertias.evaluate(value).iter().all(|m| *m >= 0.0) {
                return (parameters, rests);
            }
            if attempt > 0 {
                given.iter_mut().filter(|x| **x == 0.0).for_each(|x| *x = 0.5);
            }
        }
        (parameters, rests)
    }

    fn drawn_parameter(&mut self, default: f64, zero_sign: f64) -> f64 {
        if default == 0.0 {
            zero_sign * self.random.between(0.3, 1.0)
        } else {
            default * self.random.between(0.8, 1.25)
        }
    }

    /// Coordinates, speeds and end of a scene with these parameters.
    fn start(&self, scene: usize, parameters: &[f64]) -> (Vec<f64>, Vec<f64>, f64) {
        let n = self.model.coordinates.len();
        let start = &self.starts[scene % self.starts.len()];
        let value = |s: Symbol| match s {
            Symbol::Parameter(i) => parameters.get(i as usize).copied().unwrap_or(0.0),
            _ => 0.0,
        };
        let numbers: Vec<f64> = start.tape.evaluate(value);
        let finite = |x: &f64| if x.is_finite() { *x } else { 0.0 };
        let until = if numbers[2 * n].is_finite() && numbers[2 * n] > 0.0 { numbers[2 * n] } else { 10.0 };
        (numbers[..n].iter().map(finite).collect(), numbers[n..2 * n].iter().map(finite).collect(), until)
    }
}

/// Parameters in the place of drawn ones, and values that some get of the others.
type Set<'a> = (Option<&'a [f64]>, &'a [(usize, Id)]);

/// Parameters of which the conditions of a claim set some, and what `f64` leaves out of these; one whose value does not exist there is no number.
pub(super) fn with_conditions(graph: &Graph, when: &[(usize, Id)], mut parameters: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    if when.is_empty() {
        return (parameters, Vec::new());
    }
    let values: Vec<Id> = when.iter().map(|condition| condition.1).collect();
    let value = |symbol: Symbol| match symbol {
        Symbol::Parameter(place) => DoubleDouble::from(parameters[place as usize]),
        _ => DoubleDouble::ZERO,
    };
    let values: Vec<DoubleDouble> = Tape::new(graph, &values).evaluate(value);
    let mut rests = vec![0.0; parameters.len()];
    for ((place, _), value) in when.iter().zip(values) {
        (parameters[*place], rests[*place]) = (value.to_f64(), value.rest());
    }
    (parameters, rests)
}

/// Parameters after a scene's `set`.
pub(super) fn with_set(graph: &Graph, set: &[(usize, Id)], mut parameters: Vec<f64>) -> Vec<f64> {
    let values: Vec<Id> = set.iter().map(|s| s.1).collect();
    let value = |s: Symbol| match s {
        Symbol::Parameter(i) => parameters.get(i as usize).copied().unwrap_or(0.0),
        _ => 0.0,
    };
    let values: Vec<f64> = Tape::new(graph, &values).evaluate(value);
    for ((i, _), x) in set.iter().zip(values) {
        if x.is_finite() {
            parameters[*i] = x;
        }
    }
    parameters
}

fn pick(random: &mut Random, scales: &[f64]) -> f64 {
    let k = random.between(0.0, scales.len() as f64) as usize;
    scales.get(k).copied().unwrap_or(1.0)
}

/// Exponents of kg, m, s, A, K of a unit as written, in halves.
fn dimension(unit: Option<&str>) -> Option<[i8; BASES]> {
    Some(parse_unit(unit?).ok()?.dimension)
}

impl Scales {
    /// From the scenes' starts, their coarse runs, and parameters of the same unit.
    fn of(model: &Model, trajectories: &[Trajectory]) -> Scales {
        let n = model.coordinates.len();
        let parameters: Vec<(Option<[i8; BASES]>, f64)> =
            model.parameters.iter().map(|p| (dimension(p.unit.as_deref()), p.default.abs())).collect();
        let mut scales = Scales { q: Vec::with_capacity(n), v: Vec::with_capacity(n) };
        for (i, coordinate) in model.coordinates.iter().enumerate() {
            let unit = dimension(coordinate.unit.as_deref());
            let rate = unit.map(|[kg, m, s, ampere, kelvin]| [kg, m, s.wrapping_sub(2), ampere, kelvin]);
            let alike = |unit: Option<[i8; BASES]>| {
                let same = parameters.iter().filter(move |p| unit.is_some() && unit != Some([0; BASES]) && p.0 == unit);
                same.map(|p| p.1)
            };
            let seen = |speed: bool| {
                trajectories.iter().flat_map(move |run| {
                    let values = run.states.iter().map(move |s| if speed { s.v[i] } else { s.q[i] });
                    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |r, x| (r.0.min(x), r.1.max(x)));
                    [high - low, low.abs().max(high.abs())]
                })
            };
            let mut q: Vec<f64> = seen(false).chain(alike(unit)).collect();
            let mut v: Vec<f64> = seen(true).chain(alike(rate)).collect();
            if unit == Some([0; BASES]) {
                q.push(1.0);
            }
            distinct(&mut q);
            distinct(&mut v);
            if q.is_empty() {
                q.push(1.0);
            }
            if v.is_empty() {
                v.push(1.0);
            }
            scales.q.push(q);
            scales.v.push(v);
        }
        scales
    }
}

/// Positive numbers that differ by more than a factor of three, at most six, the smallest and the largest among them.
fn distinct(scales: &mut Vec<f64>) {
    scales.retain(|x| *x > 0.0 && x.is_finite());
    scales.sort_by(f64::total_cmp);
    scales.dedup_by(|b, a| *b < 3.0 * *a);
    while scales.len() > 6 {
        let middle = scales.len() / 2;
        scales.remove(middle);
    }
}
