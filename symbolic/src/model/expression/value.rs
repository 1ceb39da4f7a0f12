//! What an expression stands for: a number or a vector; what a frame in space stands for.

use crate::expr::{Graph, Id};
use crate::model::rotation::Orientation;

/// The value of a resolved expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Scalar(Id),
    /// Components in ground axes.
    Vector(Vec<Id>),
    /// How a frame in space is turned; it stands in no expression.
    Orientation(Box<Orientation>),
    /// A sum over an empty range: 0, or the zero vector, whichever is wanted.
    Nothing,
    /// Already reported, or not known yet; whatever depends on it is silent.
    Poison,
}

impl Value {
    /// For messages: `a number`, `a vector of two components`.
    pub fn describe(&self) -> &'static str {
        match self {
            Value::Vector(v) if v.len() == 2 => "a vector of two components",
            Value::Vector(v) if v.len() == 4 => "a quaternion",
            Value::Vector(_) => "a vector of three components",
            Value::Orientation(_) => "a frame",
            Value::Scalar(_) | Value::Nothing | Value::Poison => "a number",
        }
    }

    /// Its components; none for `Nothing` and `Poison`.
    pub fn components(&self) -> &[Id] {
        match self {
            Value::Scalar(x) => std::slice::from_ref(x),
            Value::Vector(v) => v,
            Value::Orientation(_) | Value::Nothing | Value::Poison => &[],
        }
    }

    /// The same function of every component.
    pub fn map(&self, mut f: impl FnMut(Id) -> Id) -> Value {
        match self {
            Value::Scalar(x) => Value::Scalar(f(*x)),
            Value::Vector(v) => Value::Vector(v.iter().map(|x| f(*x)).collect()),
            Value::Orientation(_) | Value::Nothing | Value::Poison => self.clone(),
        }
    }
}

/// a + b, or a − b; `None` when they do not fit.
pub fn add(graph: &mut Graph, a: &Value, b: &Value, subtract: bool) -> Option<Value> {
    let mut join = |x, y| if subtract { graph.sub(x, y) } else { graph.add(x, y) };
    Some(match (a, b) {
        (Value::Poison, _) | (_, Value::Poison) => Value::Poison,
        (_, Value::Nothing) => a.clone(),
        (Value::Nothing, _) => b.map(|x| join(Id::ZERO, x)),
        (Value::Scalar(x), Value::Scalar(y)) => Value::Scalar(join(*x, *y)),
        (Value::Vector(x), Value::Vector(y)) if x.len() == y.len() => {
            Value::Vector(x.iter().zip(y).map(|(x, y)| join(*x, *y)).collect())
        }
        _ => return None,
    })
}

/// a b, one of them a number; `None` for two vectors.
pub fn multiply(graph: &mut Graph, a: &Value, b: &Value) -> Option<Value> {
    Some(match (a, b) {
        (Value::Poison, _) | (_, Value::Poison) => Value::Poison,
        (Value::Nothing, _) | (_, Value::Nothing) => Value::Nothing,
        (Value::Scalar(x), y) | (y, Value::Scalar(x)) => y.map(|y| graph.mul(*x, y)),
        _ => return None,
    })
}
