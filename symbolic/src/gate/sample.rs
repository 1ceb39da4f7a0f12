//! Random parameters and states at which derivations are compared (LANGUAGE, section 8).

use crate::expr::{Scalar, Symbol, Tape};
use crate::model::Model;
use crate::random::Random;

use crate::derive::{Switch, SwitchKind};

/// Parameters, a time and a state.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Free parameters.
    pub parameters: Vec<f64>,
    /// Time.
    pub t: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Speeds.
    pub v: Vec<f64>,
    /// Accelerations.
    pub a: Vec<f64>,
    /// Inputs: u, u', u'', u''' each, at this time.
    pub inputs: Vec<[f64; 4]>,
    /// Modes of the switches at this state.
    pub modes: Vec<f64>,
}

impl State {
    /// A symbol's value.
    pub fn value(&self, symbol: Symbol) -> f64 {
        let at = |list: &[f64], i: u32| list.get(i as usize).copied().unwrap_or(0.0);
        match symbol {
            Symbol::Time => self.t,
            Symbol::Coordinate(i) => at(&self.q, i),
            Symbol::Speed(i) => at(&self.v, i),
            Symbol::Acceleration(i) => at(&self.a, i),
            Symbol::Input(k, order) => {
                self.inputs.get(k as usize).and_then(|u| u.get(usize::from(order))).copied().unwrap_or(0.0)
            }
            Symbol::Parameter(i) => at(&self.parameters, i),
            Symbol::Mode(k) => at(&self.modes, k),
            Symbol::Reaction(_) | Symbol::Dummy(_) => 0.0,
        }
    }
}

/// Draws states, the same ones every time.
pub struct Draws<'a> {
    model: &'a Model,
    random: Random,
    drawn: usize,
    inputs: Vec<Tape>,
    switches: Vec<(SwitchKind, Tape)>,
    scene: Tape,
    sample: Vec<(usize, bool, Tape)>,
}

impl<'a> Draws<'a> {
    /// Draws for a model (its graph must have been built).
    pub fn new(model: &'a Model, switches: &[Switch]) -> Self {
        let graph = &model.graph;
        let first = &model.scenes[0];
        let roots: Vec<_> = [first.until].into_iter().chain(first.q.iter().chain(&first.v).copied()).collect();
        Draws {
            model,
            random: Random::new(),
            drawn: 0,
            inputs: model.inputs.iter().map(|u| Tape::new(graph, &u.signal)).collect(),
            switches: switches.iter().map(|s| (s.kind, Tape::new(graph, &[s.argument]))).collect(),
            scene: Tape::new(graph, &roots),
            sample: model.sample.iter().map(|s| (s.coordinate, s.speed, Tape::new(graph, &[s.low, s.high]))).collect(),
        }
    }

    /// The next state; `when` fixes some parameters.
    pub fn next(&mut self, when: &[(usize, f64)]) -> State {
        let n = self.model.coordinates.len();
        let mut parameters: Vec<f64> = self
            .model
            .parameters
            .iter()
            .map(|p| {
                if p.default == 0.0 {
                    self.random.between(0.3, 1.0)
                } else {
                    p.default * self.random.between(0.8, 1.25)
                }
            })
            .collect();
        for &(i, value) in when {
            if let Some(p) = parameters.get_mut(i) {
                *p = value;
            }
        }
        let mut state = State {
            parameters,
            t: 0.0,
            q: vec![0.0; n],
            v: vec![0.0; n],
            a: Vec::new(),
            inputs: Vec::new(),
            modes: Vec::new(),
        };
        let scene = self.scene.evaluate(|s| state.value(s));
        // Every other state is near the scene's start, the rest are at large.
        self.drawn += 1;
        let at_large = self.drawn.is_multiple_of(2);
        let spread = if at_large { 3.0 } else { 0.4 };
        let until = if scene[0].is_finite() && scene[0] > 0.0 { scene[0] } else { 10.0 };
        state.t = self.random.between(0.0, until);
        for i in 0..n {
            let (near_q, near_v) = if at_large { (0.0, 0.0) } else { (scene[1 + i], scene[1 + n + i]) };
            state.q[i] = near_q + self.random.between(-spread, spread);
            state.v[i] = near_v + self.random.between(-spread, spread);
        }
        for (coordinate, speed, range) in &self.sample {
            let ends = range.evaluate(|s| state.value(s));
            let x = self.random.between(ends[0], ends[1]);
            if *speed { state.v[*coordinate] = x } else { state.q[*coordinate] = x }
        }
        state.a = (0..n).map(|_| self.random.between(-3.0, 3.0)).collect();
        state.inputs = self
            .inputs
            .iter()
            .map(|tape| {
                let u = tape.evaluate(|s| state.value(s));
                [u[0], u[1], u[2], 0.0]
            })
            .collect();
        for (kind, tape) in &self.switches {
            let argument = tape.evaluate(|s| state.value(s))[0];
            let function = if *kind == SwitchKind::Sign { crate::expr::Unary::Sign } else { crate::expr::Unary::Step };
            state.modes.push(f64::unary(function, argument));
        }
        state
    }
}
