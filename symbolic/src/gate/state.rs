//! A state at which derivations are compared and claims tested.

use std::fmt::Write;

use crate::expr::{Measured, Symbol};
use crate::model::{Model, rate_name};
use crate::number::DoubleDouble;

/// Parameters, a time and a state of motion.
///
/// Free parameters are drawn as `f64`; all else, and what follows from them, has the digits of a double-double.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Free parameters.
    pub parameters: Vec<f64>,
    /// What these leave out of values that conditions compute; empty where there are none.
    pub rests: Vec<f64>,
    /// Time.
    pub t: DoubleDouble,
    /// Coordinates.
    pub q: Vec<DoubleDouble>,
    /// Speeds.
    pub v: Vec<DoubleDouble>,
    /// What coordinates that constraints have brought to their places are known beside; their own sizes where it is empty.
    pub near: Vec<f64>,
    /// The same of speeds.
    pub beside: Vec<f64>,
    /// Accelerations, with the scale of their rounding errors.
    pub a: Vec<Measured>,
    /// The phase.
    pub phase: usize,
    /// Multipliers of the constraints' rows, with the scale of their rounding errors; 0 for rows that do not act.
    pub lambda: Vec<Measured>,
    /// Inputs: u, u', u'', u''' each, at this time.
    pub inputs: Vec<[DoubleDouble; 4]>,
    /// Held values.
    pub memory: Vec<f64>,
    /// Modes of the switches at this state.
    pub modes: Vec<f64>,
    /// Where it comes from.
    pub origin: Origin,
    /// Whether the parameters are those of the first scene, not drawn ones.
    pub own: bool,
    /// Whether it lies outside of the ranges in `sample`, where a scene's motion went nevertheless.
    pub outside: bool,
}

/// Where a state comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Drawn near the start of a scene.
    Near,
    /// Drawn at large.
    Large,
    /// One group of coordinates moves, the others rest.
    Group,
    /// From the motion of a scene.
    Motion,
    /// Where the argument of some function is of order one, zero, or next to it.
    Side,
}

impl State {
    /// At rest at the origin and at time 0.
    pub fn at_rest(parameters: Vec<f64>, n: usize) -> State {
        State {
            parameters,
            rests: Vec::new(),
            t: DoubleDouble::ZERO,
            q: vec![DoubleDouble::ZERO; n],
            v: vec![DoubleDouble::ZERO; n],
            near: Vec::new(),
            beside: Vec::new(),
            a: Vec::new(),
            phase: 0,
            lambda: Vec::new(),
            inputs: Vec::new(),
            memory: Vec::new(),
            modes: Vec::new(),
            origin: Origin::Near,
            own: false,
            outside: false,
        }
    }

    /// Whether something may be singular or undefined here: it was made to lie so, or it lies outside of the file's `sample`.
    pub(super) fn is_special(&self) -> bool {
        self.outside || matches!(self.origin, Origin::Side | Origin::Group)
    }

    /// A symbol's value.
    pub fn value(&self, symbol: Symbol) -> DoubleDouble {
        let at = |list: &[DoubleDouble], i: u32| list.get(i as usize).copied().unwrap_or(DoubleDouble::ZERO);
        let float = |list: &[f64], i: u32| DoubleDouble::from(list.get(i as usize).copied().unwrap_or(0.0));
        match symbol {
            Symbol::Time => self.t,
            Symbol::Coordinate(i) => at(&self.q, i),
            Symbol::Speed(i) => at(&self.v, i),
            Symbol::Acceleration(i) => self.a.get(i as usize).map_or(DoubleDouble::ZERO, |a| a.value),
            Symbol::Input(k, order) => {
                let input = self.inputs.get(k as usize).and_then(|u| u.get(usize::from(order)));
                input.copied().unwrap_or(DoubleDouble::ZERO)
            }
            Symbol::Parameter(i) => float(&self.parameters, i) + self.rests.get(i as usize).copied().unwrap_or(0.0),
            Symbol::Memory(j) => float(&self.memory, j),
            Symbol::Mode(k) => float(&self.modes, k),
            Symbol::Multiplier(k) => self.lambda.get(k as usize).map_or(DoubleDouble::ZERO, |l| l.value),
            Symbol::Phase(k) => DoubleDouble::from(if k as usize == self.phase { 1.0 } else { 0.0 }),
            Symbol::Reaction(_) | Symbol::Dummy(_) | Symbol::State(_) | Symbol::StateRate(_) => DoubleDouble::ZERO,
        }
    }

    /// A symbol's value with the scale of its rounding error; only accelerations, multipliers, and coordinates and speeds that constraints have
    /// brought to their places have more than their own size.
    pub fn measured(&self, symbol: Symbol) -> Measured {
        let known = |beside: &[f64], i: u32| {
            let exact = Measured::exact(self.value(symbol));
            let beside = beside.get(i as usize).copied().unwrap_or(0.0);
            Measured { magnitude: exact.magnitude.max(beside), ..exact }
        };
        match symbol {
            Symbol::Coordinate(i) => known(&self.near, i),
            Symbol::Speed(i) => known(&self.beside, i),
            Symbol::Acceleration(i) => self.a.get(i as usize).copied().unwrap_or(Measured::exact(DoubleDouble::ZERO)),
            Symbol::Multiplier(k) => {
                self.lambda.get(k as usize).copied().unwrap_or(Measured::exact(DoubleDouble::ZERO))
            }
            _ => Measured::exact(self.value(symbol)),
        }
    }
}

/// Most coordinates and parameters that messages show.
const SHOWN: usize = 12;

/// A state in words, for messages: time, coordinates and speeds, parameters.
pub(super) fn describe(model: &Model, state: &State) -> String {
    let mut words = format!("t = {}", short(state.t.to_f64()));
    for (k, c) in model.coordinates.iter().enumerate().take(SHOWN) {
        let (q, v) = (state.q[k].to_f64(), state.v[k].to_f64());
        // Writing to a String cannot fail.
        if !c.is_hidden() {
            let _ = write!(words, ", {} = {}", c.name, short(q));
        }
        let _ = write!(words, ", {} = {}", rate_name(&c.name, 1), short(v));
    }
    if model.coordinates.len() > SHOWN {
        words.push_str(", …");
    }
    for (held, x) in model.memory.iter().zip(&state.memory).take(SHOWN) {
        let _ = write!(words, ", {} = {}", held.name, short(*x));
    }
    for (p, x) in model.parameters.iter().zip(&state.parameters).take(SHOWN) {
        let _ = write!(words, ", {} = {}", p.name, short(*x));
    }
    if model.parameters.len() > SHOWN {
        words.push_str(", …");
    }
    words
}

/// A number with enough digits to see where a state is.
fn short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x.abs()) { format!("{x:.4}") } else { format!("{x:.4e}") }
}
