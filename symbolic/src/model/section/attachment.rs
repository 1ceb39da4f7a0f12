//! Which body carries a point: the one in whose material it is at rest, at several random states.

use crate::expr::{Id, Symbol, Tape, vectors};
use crate::model::expression::builder::ExprBuilder;
use crate::model::expression::facts::Depends;
use crate::model::resolved::Model;
use crate::random::Random;

/// States at which the motions of points and bodies are compared.
const STATES: usize = 24;

/// A point at rest moves with the material to this share of the speeds involved.
const TOLERANCE: f64 = 1e-9;

/// Whether a point and the material of a body were seen to move alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Carriers {
    /// For each point, the bodies in which it is at rest, in the file's order.
    pub bodies: Vec<Vec<usize>>,
}

/// Pairs of points and bodies that are compared at most.
const PAIRS: usize = 300_000_000;

/// Finds the carriers of points (components in ground axes); none when there are too many of both.
pub fn carriers(builder: &mut ExprBuilder, model: &Model, points: &[Vec<Id>]) -> Option<Carriers> {
    if points.len().saturating_mul(model.bodies.len()) > PAIRS {
        return None;
    }
    let dimension = points.first().map_or(2, Vec::len);
    // Per body: position, velocity, angular velocity; per point: position, velocity.
    let mut roots = Vec::new();
    for body in &model.bodies {
        roots.extend(&body.position);
        roots.extend(builder.rates(&body.position));
        match &body.rotation {
            Some(rotation) => roots.extend(rotation.angular_velocity(|angle| builder.rate(angle))),
            None => roots.extend(vec![Id::ZERO; vectors::moment_size(dimension)]),
        }
    }
    for point in points {
        roots.extend(point);
        roots.extend(builder.rates(point));
    }
    let tape = Tape::new(&builder.graph, &roots);
    let mut scratch = Vec::new();
    let run = |state: &State| {
        let mut results = vec![0.0; roots.len()];
        tape.run(|symbol| state.value(symbol), &mut scratch, &mut results);
        results
    };
    let seen: Vec<Vec<f64>> = states(builder, model).iter().map(run).collect();
    let stride = 2 * dimension + vectors::moment_size(dimension);
    let offset = model.bodies.len() * stride;
    let carries = |k: usize, b: usize| {
        let particle = model.bodies[b].rotation.is_none();
        let mut rests = false;
        for results in &seen {
            let point = &results[offset + 2 * dimension * k..][..2 * dimension];
            let body = &results[stride * b..][..stride];
            match at_rest(dimension, point, body, particle) {
                None => {}
                Some(true) => rests = true,
                Some(false) => return false,
            }
        }
        rests
    };
    let bodies = |k: usize| (0..model.bodies.len()).filter(|b| carries(k, *b)).collect();
    Some(Carriers { bodies: (0..points.len()).map(bodies).collect() })
}

/// Whether the point moves with the material of the body: Ṗ = v + ω×(P − r), and for a particle P = r.
/// `None` where that is not finite.
fn at_rest(dimension: usize, point: &[f64], body: &[f64], particle: bool) -> Option<bool> {
    let (position, rate) = point.split_at(dimension);
    let (centre, rest) = body.split_at(dimension);
    let (velocity, omega) = rest.split_at(dimension);
    let mut arm = [0.0; 3];
    for (arm, (p, c)) in arm.iter_mut().zip(position.iter().zip(centre)) {
        *arm = p - c;
    }
    let [x, y, z] = arm;
    let turning = match *omega {
        [omega] => [-omega * y, omega * x, 0.0],
        [a, b, c] => [b * z - c * y, c * x - a * z, a * y - b * x],
        _ => [0.0; 3],
    };
    let size = |v: &[f64]| v.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let mut gap = [0.0; 3];
    for (k, gap) in gap.iter_mut().enumerate().take(dimension) {
        *gap = velocity[k] + turning[k] - rate[k];
    }
    if !arm.iter().chain(&gap).all(|x| x.is_finite()) {
        return None;
    }
    let scale = size(velocity) + size(&turning) + size(rate);
    let together = !particle || size(&arm) <= TOLERANCE * (size(position) + size(centre));
    Some(together && size(&gap) <= TOLERANCE * scale)
}

/// Values of all symbols.
pub struct State {
    time: f64,
    coordinates: Vec<[f64; 3]>,
    first_state: u32,
    inputs: Vec<[f64; 4]>,
    parameters: Vec<f64>,
}

impl State {
    /// Moves coordinates by so much.
    pub fn shift(&mut self, by: impl Iterator<Item = f64>) {
        self.coordinates.iter_mut().zip(by).for_each(|(coordinate, by)| coordinate[0] += by);
    }

    /// Of a symbol.
    pub fn value(&self, symbol: Symbol) -> f64 {
        let coordinate = |i: u32, order: usize| self.coordinates.get(i as usize).map_or(f64::NAN, |c| c[order]);
        match symbol {
            Symbol::Time => self.time,
            Symbol::Coordinate(i) => coordinate(i, 0),
            Symbol::Speed(i) => coordinate(i, 1),
            Symbol::Acceleration(i) => coordinate(i, 2),
            Symbol::State(j) => coordinate(self.first_state + j, 1),
            Symbol::StateRate(j) => coordinate(self.first_state + j, 2),
            Symbol::Input(k, order) => {
                self.inputs.get(k as usize).and_then(|u| u.get(usize::from(order))).copied().unwrap_or(f64::NAN)
            }
            Symbol::Parameter(k) => self.parameters.get(k as usize).copied().unwrap_or(f64::NAN),
            // No place of a body contains one.
            Symbol::Memory(_) => 0.0,
            Symbol::Mode(_) | Symbol::Reaction(_) | Symbol::Multiplier(_) | Symbol::Phase(_) | Symbol::Dummy(_) => {
                f64::NAN
            }
        }
    }
}

/// Coordinates are drawn by so many measures in turn, from SI units on, each smaller than the one before by so many powers of
/// ten: a mechanism of micrometres has states at which `sqrt(l^2 - x^2)` exists.
const MEASURES: usize = 4;
const DECADES: i32 = -3;

/// Random states, alternately near the scene's start and at large; in the ranges of `sample` where there are any.
pub fn states(builder: &ExprBuilder, model: &Model) -> Vec<State> {
    let start = model.scenes.first().map(|scene| scene.q.as_slice()).unwrap_or_default();
    let ranges: Vec<Id> = model.sample.iter().flat_map(|sample| [sample.low, sample.high]).collect();
    let roots: Vec<Id> = start.iter().chain(&ranges).copied().collect();
    let tape = Tape::new(&builder.graph, &roots);
    let mut random = Random::new();
    let mut states = Vec::new();
    for k in 0..STATES {
        let mut state = State {
            time: random.between(0.0, 10.0),
            coordinates: Vec::new(),
            first_state: model.mechanical() as u32,
            inputs: model.inputs.iter().map(|_| [(); 4].map(|()| random.between(-1.0, 1.0))).collect(),
            parameters: Vec::new(),
        };
        for parameter in &model.parameters {
            let value = match parameter.default {
                0.0 => random.between(0.3, 1.0),
                default => default * random.between(0.8, 1.25),
            };
            state.parameters.push(value);
        }
        let known = tape.evaluate(|symbol| state.value(symbol));
        for place in 0..model.coordinates.len() {
            let first = known.get(place).copied().filter(|x| x.is_finite()).unwrap_or(0.0);
            let unit = 10_f64.powi(DECADES * (k / 2 % MEASURES) as i32);
            let reach = 0.1 * first.abs().max(unit);
            let q = if k % 2 == 0 { first + random.between(-reach, reach) } else { unit * random.between(-2.0, 2.0) };
            state.coordinates.push([q, random.between(-2.0, 2.0), random.between(-2.0, 2.0)]);
        }
        for (sample, ends) in model.sample.iter().zip(known[start.len()..].chunks(2)) {
            if let [low, high] = ends
                && low.is_finite()
                && high.is_finite()
            {
                state.coordinates[sample.coordinate][usize::from(sample.speed)] = random.between(*low, *high);
            }
        }
        states.push(state);
    }
    states
}

/// True when a point depends on time, inputs and parameters only, and so belongs to the ground.
pub fn belongs_to_ground(builder: &mut ExprBuilder, point: &[Id]) -> bool {
    !builder.depends(point).meets(Depends::COORDINATE)
}
