//! Shapes in space as lines and polygons.

use std::f64::consts::TAU;

use super::solids::{Point, across, cross, dot, norm, plus, point, radius, scaled};
use crate::mechanism::Shape;

/// Corners of what stands for a circle: at a radius of 500 px it is round to 0.3 px.
const CORNERS: usize = 96;

/// A line or the edge of a face; closed ones end exactly where they begin.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outline {
    pub points: Vec<Point>,
    /// Whether the inside is filled.
    pub face: bool,
}

/// Points of c + u cos φ + v sin φ from one angle on, so many steps of a whole turn.
fn arc(centre: Point, [u, v]: [Point; 2], from: f64, steps: usize) -> Vec<Point> {
    let at = |i: usize| {
        let (sine, cosine) = (from + TAU * (i % CORNERS) as f64 / CORNERS as f64).sin_cos();
        plus(plus(centre, cosine, u), sine, v)
    };
    (0..=steps).map(at).collect()
}

/// The circle about a centre whose axis is as long as its radius.
fn rim(centre: Point, axis: Point) -> Vec<Point> {
    let radius = norm(axis);
    arc(centre, across(axis).map(|vector| scaled(radius, vector)), 0.0, CORNERS)
}

/// What is seen of a shape in space from far away in a direction: lines and front faces, none of which covers another.  None where
/// its numbers say nothing, and of shapes that are not of space alone.
pub(super) fn outlines(shape: &Shape, numbers: &[f64], towards: Point) -> Vec<Outline> {
    let face = |points| Outline { points, face: true };
    let line = |points| Outline { points, face: false };
    let (point, radius) = (|k| point(numbers, k), |k| radius(numbers, k));
    let found = match shape {
        Shape::Ring => vec![line(rim(point(0), point(1)))],
        Shape::Disc => vec![face(rim(point(0), point(1)))],
        Shape::Cylinder => cylinder([point(0), point(1)], radius(6), towards).map(face).into(),
        Shape::Sphere => vec![face(rim(point(0), scaled(radius(3) / norm(towards), towards)))],
        Shape::Box => faces(point(0), [point(1), point(2), point(3)], towards).into_iter().map(face).collect(),
        Shape::Ellipsoid => {
            let [edge, sections @ ..] = ellipsoid(point(0), [point(1), point(2), point(3)], towards);
            std::iter::once(face(edge)).chain(sections.map(line)).collect()
        }
        Shape::Plane => vec![face(square(point(0), point(1)))],
        Shape::Axes => [1, 2, 3].map(|k| line(vec![point(0), plus(point(0), 1.0, point(k))])).into(),
        _ => Vec::new(),
    };
    let there = |outline: &Outline| outline.points.iter().flatten().all(|x| x.is_finite());
    found.into_iter().filter(there).collect()
}

/// The side of a cylinder that is seen, between the near halves of both rims, and the end that is seen.
fn cylinder([from, to]: [Point; 2], radius: f64, towards: Point) -> [Vec<Point>; 2] {
    let along = plus(to, -1.0, from);
    let (far, near) = if dot(along, towards) > 0.0 { (from, to) } else { (to, from) };
    let axis = plus(near, -1.0, far);
    // Of the rims the half about the part of the view that is across the axis; seen along the axis, any half.
    let [u, v] = across(axis);
    let middle = dot(towards, v).atan2(dot(towards, u));
    let half = |centre: Point| arc(centre, [scaled(radius, u), scaled(radius, v)], middle - TAU / 4.0, CORNERS / 2);
    let mut side = half(far);
    side.extend(half(near).into_iter().rev());
    side.extend(side.first().copied());
    [side, rim(near, scaled(radius / norm(axis), axis))]
}

/// The faces of a box that are turned to the viewer.
fn faces(centre: Point, half: [Point; 3], towards: Point) -> Vec<Vec<Point>> {
    let handed = if dot(cross(half[0], half[1]), half[2]) < 0.0 { -1.0 } else { 1.0 };
    let mut seen = Vec::new();
    for k in 0..3 {
        let (a, b) = (half[(k + 1) % 3], half[(k + 2) % 3]);
        let facing = handed * dot(cross(a, b), towards);
        if facing == 0.0 {
            continue;
        }
        let middle = plus(centre, facing.signum(), half[k]);
        let corner = |(s, t): (f64, f64)| plus(plus(middle, s, a), t, b);
        seen.push([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (1.0, 1.0)].map(corner).to_vec());
    }
    seen
}

/// The edge of an ellipsoid as it is seen, and the near halves of its three principal sections.
fn ellipsoid(centre: Point, half: [Point; 3], towards: Point) -> [Vec<Point>; 4] {
    // A point is c + Σ u_k a_k with |u| = 1; it is on the edge where u·w = 0, and near where that is positive.
    let w: Point = half.map(|axis| dot(axis, towards) / dot(axis, axis));
    let image = |u: Point| (0..3).fold([0.0; 3], |sum, k| plus(sum, u[k], half[k]));
    let section = |k: usize| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        arc(centre, [half[i], half[j]], w[j].atan2(w[i]) - TAU / 4.0, CORNERS / 2)
    };
    [arc(centre, across(w).map(image), 0.0, CORNERS), section(0), section(1), section(2)]
}

/// A square about a centre whose normal is as long as its edges.
fn square(centre: Point, normal: Point) -> Vec<Point> {
    let half = norm(normal) / 2.0;
    let [u, v] = across(normal).map(|vector| scaled(half, vector));
    let corner = |(s, t): (f64, f64)| plus(plus(centre, s, u), t, v);
    [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (1.0, 1.0)].map(corner).to_vec()
}

/// The middle of a shape in space.
pub(super) fn middle(shape: &Shape, numbers: &[f64]) -> Point {
    let first = point(numbers, 0);
    if *shape == Shape::Cylinder { scaled(0.5, plus(first, 1.0, point(numbers, 1))) } else { first }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::show::solids::{Bound, bounds};

    /// Directions all round, along the axes and next to them among them.
    fn directions() -> Vec<Point> {
        const VALUES: [f64; 7] = [-1.0, -0.3, -1e-9, 0.0, 1e-9, 0.3, 1.0];
        let all = (0..343).map(|i| [VALUES[i % 7], VALUES[i / 7 % 7], VALUES[i / 49]]);
        all.filter(|v| norm(*v) > 0.1).collect()
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn two_vectors_across_any_direction_make_a_right_handed_system() {
        for direction in directions() {
            let [u, v] = across(direction);
            let axis = scaled(1.0 / norm(direction), direction);
            assert!(close(norm(u), 1.0) && close(norm(v), 1.0) && close(dot(u, v), 0.0), "{direction:?}");
            assert!(close(dot(u, axis), 0.0) && close(dot(cross(u, v), axis), 1.0), "{direction:?}");
        }
        assert_eq!(across([0.0, 0.0, 2.0]), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    }

    #[test]
    fn a_rim_is_round_and_closed_about_any_axis() {
        for axis in directions() {
            let numbers = [[1.0, 2.0, 3.0], scaled(0.5 / norm(axis), axis)].concat();
            let [Outline { points, face: false }] = &outlines(&Shape::Ring, &numbers, [0.0, 0.0, 1.0])[..] else {
                panic!()
            };
            assert_eq!((points.len(), points[0]), (CORNERS + 1, points[CORNERS]));
            for point in points {
                let arm = plus(*point, -1.0, [1.0, 2.0, 3.0]);
                assert!(close(norm(arm), 0.5) && close(dot(arm, axis), 0.0));
            }
            // The polygon leaves the circle by less than 0.3 px where its radius is 500 px.
            let edge = scaled(0.5, plus(points[0], 1.0, points[1]));
            assert!(0.5 - norm(plus(edge, -1.0, [1.0, 2.0, 3.0])) < 0.5 * 0.3 / 500.0);
        }
    }

    /// The area of a closed polygon as it is seen.
    fn seen(points: &[Point], towards: Point) -> f64 {
        let area = points.windows(2).fold([0.0; 3], |sum, pair| plus(sum, 0.5, cross(pair[0], pair[1])));
        dot(area, towards).abs() / norm(towards)
    }

    #[test]
    fn faces_cover_what_is_seen_of_a_solid() {
        let about = |actual: f64, wanted: f64| assert!((actual / wanted - 1.0).abs() < 2e-3, "{actual} {wanted}");
        for towards in directions() {
            let view = scaled(1.0 / norm(towards), towards);
            let area = |shape: &Shape, numbers: &[f64]| -> f64 {
                let faces = outlines(shape, numbers, towards);
                faces.iter().filter(|outline| outline.face).map(|outline| seen(&outline.points, towards)).sum()
            };
            about(area(&Shape::Sphere, &[1.0, 1.0, 1.0, 2.0]), TAU * 2.0);
            let edges = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
            let numbers = [[0.0; 3], edges[0], edges[1], edges[2]].concat();
            // A box of 2 × 4 × 6, an ellipsoid with half its edges as half axes.
            about(area(&Shape::Box, &numbers), dot([24.0, 12.0, 8.0], view.map(f64::abs)));
            about(area(&Shape::Ellipsoid, &numbers), TAU / 2.0 * norm([6.0 * view[0], 3.0 * view[1], 2.0 * view[2]]));
            // A cylinder along y, of length 3 and radius 0.5.
            let across = view[0].hypot(view[2]);
            let cylinder = [0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.5];
            about(area(&Shape::Cylinder, &cylinder), 3.0 * across + TAU / 8.0 * view[1].abs());
        }
    }

    #[test]
    fn sections_of_an_ellipsoid_are_on_its_near_half() {
        let towards = [0.3, -0.5, 0.8];
        let numbers = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]].concat();
        let found = outlines(&Shape::Ellipsoid, &numbers, towards);
        assert_eq!(found.len(), 4);
        for [x, y, z] in found.iter().filter(|outline| !outline.face).flat_map(|outline| &outline.points) {
            assert!(close(x * x + y * y / 4.0 + z * z / 9.0, 1.0));
            assert!(dot([*x, y / 4.0, z / 9.0], towards) > -1e-12);
        }
    }

    #[test]
    fn outlines_are_within_bounds_and_touch_them() {
        let axes = [[0.1, 0.2, -0.2], [0.4, -0.1, 0.1], [0.0, -0.5, -0.5]];
        let box_like = [[1.0, 2.0, 3.0], axes[0], axes[1], axes[2]].concat();
        let solids: [(Shape, &[f64]); 8] = [
            (Shape::Ring, &[1.0, 2.0, 3.0, 0.1, 0.2, -0.2]),
            (Shape::Disc, &[1.0, 2.0, 3.0, 0.0, 0.0, 2.0]),
            (Shape::Cylinder, &[1.0, 2.0, 3.0, 2.0, 1.0, 5.0, 0.5]),
            (Shape::Sphere, &[1.0, 2.0, 3.0, 0.5]),
            (Shape::Box, &box_like),
            (Shape::Ellipsoid, &box_like),
            (Shape::Plane, &[1.0, 2.0, 3.0, 1.0, -1.0, 1.0]),
            (Shape::Axes, &box_like),
        ];
        for (shape, numbers) in solids {
            assert_eq!(numbers.len(), shape.numbers(3));
            for k in 0..3 {
                let ends = bounds(&shape, numbers).into_iter().map(|bound| bound.centre[k] + bound.half[k]);
                let end = ends.fold(f64::NEG_INFINITY, f64::max);
                // What is seen across an axis reaches as far along it as the shape does.
                let reached = (0..3).filter(|other| *other != k).flat_map(|other| {
                    let towards: Point = std::array::from_fn(|i| if i == other { 1.0 } else { 0.0 });
                    outlines(&shape, numbers, towards)
                });
                let reached = reached.flat_map(|outline| outline.points).map(|point| point[k]);
                let reached = reached.fold(f64::NEG_INFINITY, f64::max);
                assert!(reached <= end + 1e-12 && reached > end - 2e-3, "{shape:?} {k}: {reached} of {end}");
            }
            let within = |point: &Point| {
                let away = |bound: &Bound| norm(plus(*point, -1.0, bound.centre)) <= bound.radius + 1e-12;
                bounds(&shape, numbers).iter().any(away)
            };
            let found = outlines(&shape, numbers, [0.3, -0.5, 0.8]);
            assert!(found.iter().flat_map(|outline| &outline.points).all(within), "{shape:?}");
        }
    }

    #[test]
    fn what_has_no_extent_or_no_place_is_not_drawn() {
        for shape in [Shape::Ring, Shape::Cylinder, Shape::Box, Shape::Ellipsoid, Shape::Plane, Shape::Sphere] {
            assert!(outlines(&shape, &[f64::NAN; 12], [0.0, 0.0, 1.0]).is_empty());
            assert!(outlines(&shape, &[], [0.0, 0.0, 1.0]).is_empty());
        }
        assert!(outlines(&Shape::Disc, &[0.0; 6], [0.0, 0.0, 1.0]).is_empty());
        assert!(outlines(&Shape::Line(2), &[0.0; 6], [0.0, 0.0, 1.0]).is_empty());
    }
}
