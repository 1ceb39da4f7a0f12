//! Vectors, and where shapes in space are.

use crate::mechanism::Shape;

/// A point or vector in space.
pub(super) type Point = [f64; 3];

/// a·b.
pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
pub(super) fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// a + s b.
pub(super) fn plus(a: Point, s: f64, b: Point) -> Point {
    std::array::from_fn(|k| a[k] + s * b[k])
}

/// |a|.
pub(super) fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// s a.
pub(super) fn scaled(s: f64, a: Point) -> Point {
    a.map(|x| s * x)
}

/// Two unit vectors that make a right-handed system with a direction.  They begin with the ground's axis that is farthest from it,
/// so that there is no direction near which they are lost; about z they are x and y.
pub(super) fn across(direction: Point) -> [Point; 2] {
    let axis = scaled(1.0 / norm(direction), direction);
    let farthest = (1..3).fold(0, |best, k| if axis[k].abs() < axis[best].abs() { k } else { best });
    let ground: Point = std::array::from_fn(|k| if k == farthest { 1.0 } else { 0.0 });
    let first = plus(ground, -axis[farthest], axis);
    let first = scaled(1.0 / norm(first), first);
    [first, cross(axis, first)]
}

/// The k-th three of these numbers.
pub(super) fn point(numbers: &[f64], k: usize) -> Point {
    std::array::from_fn(|i| numbers.get(3 * k + i).copied().unwrap_or(f64::NAN))
}

/// A radius, by its place among the numbers.
pub(super) fn radius(numbers: &[f64], place: usize) -> f64 {
    numbers.get(place).map_or(f64::NAN, |radius| radius.abs())
}

/// Where a shape in space is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bound {
    pub centre: Point,
    /// How far it reaches from its centre along each axis.
    pub half: Point,
    /// How far it reaches from its centre at most.
    pub radius: f64,
}

impl Bound {
    /// Of a ball.
    pub fn ball(centre: Point, radius: f64) -> Bound {
        Bound { centre, half: [radius; 3], radius }
    }

    /// Of what reaches along each axis as far as all of these together.
    fn sum(centre: Point, parts: &[Point]) -> Bound {
        let half = std::array::from_fn(|k| parts.iter().map(|part| part[k].abs()).sum());
        Bound { centre, half, radius: norm(half) }
    }

    /// Of a circle whose axis is as long as its radius.
    fn disc(centre: Point, axis: Point) -> Bound {
        let radius = norm(axis);
        Bound { centre, half: axis.map(|x| (radius * radius - x * x).max(0.0).sqrt()), radius }
    }
}

/// Where the parts of a shape in space are; [`Shape::UnitAxes`] are only where they begin.
pub(super) fn bounds(shape: &Shape, numbers: &[f64]) -> Vec<Bound> {
    let radius = |k| radius(numbers, k);
    let [centre, parts @ ..]: [Point; 4] = std::array::from_fn(|k| point(numbers, k));
    match shape {
        Shape::Ring | Shape::Disc => vec![Bound::disc(centre, parts[0])],
        Shape::Cylinder => {
            let along = plus(parts[0], -1.0, centre);
            let axis = scaled(radius(6) / norm(along), along);
            vec![Bound::disc(centre, axis), Bound::disc(parts[0], axis)]
        }
        Shape::Sphere => vec![Bound::ball(centre, radius(3))],
        Shape::Box => vec![Bound::sum(centre, &parts)],
        Shape::Ellipsoid => {
            let half = std::array::from_fn(|k| norm(parts.map(|part| part[k])));
            vec![Bound { centre, half, radius: norm(half) }]
        }
        Shape::Plane => {
            let size = norm(parts[0]) / 2.0;
            vec![Bound::sum(centre, &across(parts[0]).map(|vector| scaled(size, vector)))]
        }
        Shape::Axes => {
            let tips = parts.map(|part| Bound::ball(plus(centre, 1.0, part), 0.0));
            std::iter::once(Bound::ball(centre, 0.0)).chain(tips).collect()
        }
        Shape::UnitAxes => vec![Bound::ball(centre, 0.0)],
        _ => Vec::new(),
    }
}
