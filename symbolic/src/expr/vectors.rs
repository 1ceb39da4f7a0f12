//! Vectors as lists of components: two in the plane, three in space.  What turns, a planar angular velocity or moment, has one component
//! in the plane.

use super::{Graph, Id, Unary};

/// What the components of a value of so many are called after a point: `w` before the others of a quaternion; nothing of a scalar.
pub fn axes(components: usize) -> &'static [&'static str] {
    match components {
        0 | 1 => &[],
        2 => &["x", "y"],
        3 => &["x", "y", "z"],
        _ => &["w", "x", "y", "z"],
    }
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

/// a + b.
pub fn add(graph: &mut Graph, a: &[Id], b: &[Id]) -> Vec<Id> {
    a.iter().zip(b).map(|(x, y)| graph.add(*x, *y)).collect()
}

/// s a.
pub fn scaled(graph: &mut Graph, s: Id, a: &[Id]) -> Vec<Id> {
    a.iter().map(|x| graph.mul(s, *x)).collect()
}

/// ω × r; ω has one component in the plane.
pub fn swept(graph: &mut Graph, omega: &[Id], r: &[Id]) -> Vec<Id> {
    match omega {
        [omega] => turn(graph, *omega, r),
        _ => cross_space(graph, omega, r),
    }
}

/// arm × force: one component in the plane.
pub fn moment(graph: &mut Graph, arm: &[Id], force: &[Id]) -> Vec<Id> {
    match arm.len() {
        2 => vec![cross_plane(graph, arm, force)],
        _ => cross_space(graph, arm, force),
    }
}

/// How many components a moment has where vectors have so many.
pub fn moment_size(dimension: usize) -> usize {
    if dimension == 2 { 1 } else { 3 }
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

/// Two unit vectors across a unit vector n of space and each other: smooth in n wherever it is not opposite to the axis `pole`, which is
/// counted from 0 and to whose positive or negative side n is nearest where this is chosen.
pub fn across(graph: &mut Graph, n: &[Id], (pole, positive): (usize, bool)) -> [Vec<Id>; 2] {
    let [first, second] = [(pole + 1) % 3, (pole + 2) % 3];
    let along = if positive { n[pole] } else { graph.neg(n[pole]) };
    let reach = graph.add(Id::ONE, along);
    [first, second].map(|axis| {
        let mut tangent = vec![Id::ZERO; 3];
        for other in [first, second] {
            let product = graph.mul(n[axis], n[other]);
            let part = graph.div(product, reach);
            let whole = if axis == other { Id::ONE } else { Id::ZERO };
            tangent[other] = graph.sub(whole, part);
        }
        tangent[pole] = if positive { graph.neg(n[axis]) } else { n[axis] };
        tangent
    })
}

/// |a|.
pub fn norm(graph: &mut Graph, a: &[Id]) -> Id {
    let square = dot(graph, a, a);
    graph.unary(Unary::Sqrt, square)
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
    let length = graph.unary(Unary::Sqrt, guarded);
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
    fn tangents_are_across_their_normal() {
        let mut g = Graph::new();
        let n: Vec<Id> = (0..3).map(|i| g.symbol(Symbol::Coordinate(i))).collect();
        let found: Vec<Id> =
            [(0, true), (1, false), (2, true)].iter().flat_map(|pole| across(&mut g, &n, *pole).concat()).collect();
        let normal = [2.0 / 7.0, 3.0 / 7.0, -6.0 / 7.0];
        let value = |s: Symbol| if let Symbol::Coordinate(i) = s { normal[i as usize] } else { f64::NAN };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        for pair in Tape::new(&g, &found).evaluate(value).chunks(6) {
            let (one, other) = pair.split_at(3);
            let products =
                [(one, one, 1.0), (other, other, 1.0), (one, other, 0.0), (one, &normal, 0.0), (other, &normal, 0.0)];
            assert!(products.iter().all(|(a, b, product)| (dot(a, b) - product).abs() < 1e-15), "{pair:?}");
        }
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
