//! A state with its names.

use std::fmt;
use std::ops::Index;
use std::sync::Arc;

use crate::mechanism::{Description, HIDDEN, Quantity, rate_name};

/// The names under which a run's numbers are found.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Names {
    pub coordinates: Vec<String>,
    pub outputs: Vec<String>,
}

impl Names {
    pub fn of(description: &Description) -> Self {
        let coordinates = description.coordinates.iter().map(|c| c.name.to_string()).collect();
        let outputs = description.outputs.iter().flat_map(components).collect();
        Names { coordinates, outputs }
    }

    /// Coordinates, their rates, outputs component by component; those of states are hidden, and the rates of these are the states.
    pub fn columns(&self) -> Vec<String> {
        let rates = self.coordinates.iter().map(|name| rate_name(name));
        self.coordinates.iter().cloned().chain(rates).chain(self.outputs.iter().cloned()).collect()
    }

    /// How many columns there are.
    pub fn len(&self) -> usize {
        2 * self.coordinates.len() + self.outputs.len()
    }

    /// The place of a column.
    pub fn place(&self, column: &str) -> Option<usize> {
        let (coordinates, n) = (&self.coordinates, self.coordinates.len());
        let position = |names: &[String], name: &str| names.iter().position(|known| known == name);
        let rate = || column.strip_suffix('\'').and_then(|coordinate| position(coordinates, coordinate));
        position(coordinates, column)
            .or_else(|| Some(n + rate().or_else(|| state_position(coordinates, column))?))
            .or_else(|| Some(2 * n + position(&self.outputs, column)?))
    }
}

/// The place of a state of first order among the coordinates.
pub(crate) fn state_position(coordinates: &[String], state: &str) -> Option<usize> {
    coordinates.iter().position(|name| name.strip_prefix(HIDDEN) == Some(state))
}

/// `tip.x`, `tip.y` of a vector, `speed` of a scalar.
fn components(output: &Quantity) -> Vec<String> {
    match output.axes() {
        [] => vec![output.name.to_string()],
        axes => axes.iter().map(|axis| [&output.name, ".", axis].concat()).collect(),
    }
}

/// The state of a mechanism at one time.
///
/// `state["theta"]` is a coordinate, `state["theta'"]` its rate, `state["i"]` a state of first order, `state["tip.x"]` a component of an
/// output.  `q` and `v` end with what belongs to the states: hidden coordinates, and the states as their speeds.
#[derive(Clone, PartialEq)]
pub struct State {
    /// Time, s.
    pub t: f64,
    /// Generalized coordinates, SI.
    pub q: Vec<f64>,
    /// Their rates, SI.
    pub v: Vec<f64>,
    /// Outputs, NaN where absent; empty between the reported times.
    pub(crate) outputs: Vec<f64>,
    pub(crate) names: Arc<Names>,
}

impl State {
    /// A coordinate, a rate or an output by name; `None` if there is none of this name or if it is not finite.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.find(name).copied().filter(|value| value.is_finite())
    }

    fn find(&self, name: &str) -> Option<&f64> {
        let position = |names: &[String], name: &str| names.iter().position(|n| n == name);
        if let Some(coordinate) = name.strip_suffix('\'') {
            return self.v.get(position(&self.names.coordinates, coordinate)?);
        }
        match position(&self.names.coordinates, name) {
            Some(index) => self.q.get(index),
            None if name == "t" => Some(&self.t),
            None if state_position(&self.names.coordinates, name).is_some() => {
                self.v.get(state_position(&self.names.coordinates, name)?)
            }
            None => self.outputs.get(position(&self.names.outputs, name)?),
        }
    }

    /// (name, value) of all coordinates, then of their rates, then of states of first order.
    pub fn entries(&self) -> impl Iterator<Item = (String, f64)> + '_ {
        let names = &self.names.coordinates;
        let positions = names.iter().cloned().zip(self.q.iter().copied());
        let positions = positions.filter(|(name, _)| !name.starts_with(HIDDEN));
        positions.chain(names.iter().map(|name| rate_name(name)).zip(self.v.iter().copied()))
    }

    /// (name, value) of all outputs, component by component; `None` where one is not finite.
    pub fn outputs(&self) -> impl Iterator<Item = (&str, Option<f64>)> + '_ {
        let values = self.outputs.iter().map(|value| Some(*value).filter(|value| value.is_finite()));
        self.names.outputs.iter().map(String::as_str).zip(values)
    }
}

impl Index<&str> for State {
    type Output = f64;

    /// A coordinate, a rate or an output by name, NaN where an output is absent.
    ///
    /// # Panics
    /// If nothing has this name; [`State::get`] does not.
    fn index(&self, name: &str) -> &f64 {
        self.find(name).unwrap_or_else(|| panic!("no coordinate, rate or output is called `{name}`"))
    }
}

impl fmt::Debug for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "State {{ t: {:?}", self.t)?;
        for (name, value) in self.entries() {
            write!(f, ", {name}: {value:?}")?;
        }
        for (name, value) in self.outputs() {
            match value {
                Some(value) => write!(f, ", {name}: {value:?}")?,
                None => write!(f, ", {name}: absent")?,
            }
        }
        write!(f, " }}")
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, value)) in self.entries().enumerate() {
            write!(f, "{}{name} = {}", if index == 0 { "" } else { ", " }, plain(value))?;
        }
        Ok(())
    }
}

/// All digits of a value; with an exponent where it is very small or large.
pub(crate) fn plain(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}
