//! What an expression stands for: a number or a vector.

use crate::expr::{Graph, Id};

/// The value of a resolved expression.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Scalar(Id),
    /// Components in ground axes.
    Vector(Vec<Id>),
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
            Value::Vector(_) => "a vector of three components",
            Value::Scalar(_) | Value::Nothing | Value::Poison => "a number",
        }
    }

    /// Its components; none for `Nothing` and `Poison`.
    pub fn components(&self) -> &[Id] {
        match self {
            Value::Scalar(x) => std::slice::from_ref(x),
            Value::Vector(v) => v,
            Value::Nothing | Value::Poison => &[],
        }
    }

    /// The same function of every component.
    pub fn map(&self, mut f: impl FnMut(Id) -> Id) -> Value {
        match self {
            Value::Scalar(x) => Value::Scalar(f(*x)),
            Value::Vector(v) => Value::Vector(v.iter().map(|x| f(*x)).collect()),
            Value::Nothing => Value::Nothing,
            Value::Poison => Value::Poison,
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

/// a·b of vectors of equal size.
pub fn dot(graph: &mut Graph, a: &[Id], b: &[Id]) -> Id {
    let mut sum = Id::ZERO;
    for (x, y) in a.iter().zip(b) {
        let product = graph.mul(*x, *y);
        sum = graph.add(sum, product);
    }
    sum
}

/// a + s b.
pub fn add_scaled(graph: &mut Graph, a: &[Id], s: Id, b: &[Id]) -> Vec<Id> {
    let term = |(x, y): (&Id, &Id)| {
        let product = graph.mul(s, *y);
        graph.add(*x, product)
    };
    a.iter().zip(b).map(term).collect()
}

/// b − a.
pub fn difference(graph: &mut Graph, a: &[Id], b: &[Id]) -> Vec<Id> {
    a.iter().zip(b).map(|(x, y)| graph.sub(*y, *x)).collect()
}

/// −a.
pub fn negative(graph: &mut Graph, a: &[Id]) -> Vec<Id> {
    a.iter().map(|x| graph.neg(*x)).collect()
}

/// The planar ω k × r = ω [−y, x].
pub fn turn(graph: &mut Graph, omega: Id, r: &[Id]) -> Vec<Id> {
    let x = graph.mul(omega, r[1]);
    vec![graph.neg(x), graph.mul(omega, r[0])]
}

/// The planar a × b.
pub fn cross_plane(graph: &mut Graph, a: &[Id], b: &[Id]) -> Id {
    let first = graph.mul(a[0], b[1]);
    let second = graph.mul(a[1], b[0]);
    graph.sub(first, second)
}

/// The spatial a × b.
pub fn cross_space(graph: &mut Graph, a: &[Id], b: &[Id]) -> Vec<Id> {
    let mut component = |i: usize, j: usize| cross_plane(graph, &[a[i], a[j]], &[b[i], b[j]]);
    vec![component(1, 2), component(2, 0), component(0, 1)]
}

/// |a|.
pub fn norm(graph: &mut Graph, a: &[Id]) -> Id {
    let square = dot(graph, a, a);
    graph.unary(crate::expr::Unary::Sqrt, square)
}

/// a/|a|, and zero for the zero vector.
///
/// A smallest square is added under the root: it vanishes in rounding wherever |a| > 1e-142, and at a = 0 it
/// makes 0/0 a 0 without a discontinuity that a run would have to locate.
pub fn unit(graph: &mut Graph, a: &[Id]) -> Vec<Id> {
    let square = dot(graph, a, a);
    let guard = graph.float(1e-300);
    let guarded =
        if graph.number(square).is_some_and(|s| s.to_f64() > 0.0) { square } else { graph.add(square, guard) };
    let length = graph.unary(crate::expr::Unary::Sqrt, guarded);
    a.iter().map(|x| graph.div(*x, length)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Symbol, Tape};

    #[test]
    fn the_unit_vector_of_zero_is_zero() {
        let mut g = Graph::new();
        let v = [g.symbol(Symbol::Coordinate(0)), g.symbol(Symbol::Coordinate(1))];
        let u = unit(&mut g, &v);
        let tape = Tape::new(&g, &u);
        assert_eq!(tape.evaluate(|_| 0.0), [0.0, 0.0]);
        assert_eq!(tape.evaluate(|s| if s == Symbol::Coordinate(0) { 3.0 } else { 4.0 }), [0.6, 0.8]);
    }

    #[test]
    fn spatial_cross_products_are_right_handed() {
        let mut g = Graph::new();
        let x = [Id::ONE, Id::ZERO, Id::ZERO];
        let y = [Id::ZERO, Id::ONE, Id::ZERO];
        assert_eq!(cross_space(&mut g, &x, &y), [Id::ZERO, Id::ZERO, Id::ONE]);
        assert_eq!(turn(&mut g, Id::ONE, &[Id::ONE, Id::ZERO]), [Id::ZERO, Id::ONE]);
    }
}
