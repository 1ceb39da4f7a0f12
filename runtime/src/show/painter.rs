//! What is in front of what in a picture in space: parts of shapes from the farthest to the nearest.

use super::extent::Drawn;
use super::outlines::{middle, outlines};
use super::solids::{Point, dot, plus};
use crate::mechanism::Shape;

/// What is nearer than a filled shape by less than this, of the picture's reach, is behind it: the end of a line at the middle of a
/// ball does not flicker with rounding.
const NEARER: f64 = 1e-6;

/// What is drawn at once.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Part {
    /// All of a shape.
    Whole,
    /// Some of a line: which one of its shape's.
    Line(usize, Vec<Point>),
    /// A point of a line.
    Joint(Point),
    /// The tip of an axis: which one.
    Tip(usize, Point),
}

/// Whether a shape hides what is behind it.
fn is_filled(shape: &Shape) -> bool {
    matches!(shape, Shape::Disc | Shape::Cylinder | Shape::Sphere | Shape::Box | Shape::Ellipsoid)
}

/// At one depth: what lies below what.
fn layer(shape: &Shape) -> u8 {
    match shape {
        Shape::Plane => 0,
        Shape::Curve(_) => 1,
        Shape::Trace(_) => 2,
        Shape::Spring => 3,
        Shape::Line(_) => 4,
        Shape::Circle => 5,
        Shape::Ring => 6,
        Shape::Axes | Shape::UnitAxes => 7,
        Shape::Disc | Shape::Cylinder | Shape::Sphere | Shape::Box | Shape::Ellipsoid => 8,
    }
}

/// The order in which shapes are seen from far away in a direction.
struct Order {
    towards: Point,
    /// The depths of the middles of filled shapes, from the farthest on.
    filled: Vec<f64>,
    near: f64,
}

impl Order {
    /// How many filled shapes are behind a depth.
    fn behind(&self, depth: f64) -> usize {
        self.filled.partition_point(|filled| *filled < depth - self.near)
    }

    fn depth(&self, points: &[Point]) -> f64 {
        points.iter().map(|point| dot(*point, self.towards)).sum::<f64>() / points.len() as f64
    }

    /// A line cut where it passes the depth of a filled shape, each piece with the number of those that it is before; what is not
    /// there leaves a gap.
    fn pieces(&self, line: &[Point]) -> Vec<(usize, Vec<Point>)> {
        let mut pieces = Vec::new();
        let mut piece: Vec<Point> = Vec::new();
        let mut finish = |piece: &mut Vec<Point>| {
            if piece.len() > 1 {
                pieces.push((self.behind(self.depth(piece)), std::mem::take(piece)));
            }
            piece.clear();
        };
        for point in line {
            if !point.iter().all(|x| x.is_finite()) {
                finish(&mut piece);
                continue;
            }
            if let Some(last) = piece.last().copied() {
                for cut in self.cuts(last, *point) {
                    piece.push(cut);
                    finish(&mut piece);
                    piece.push(cut);
                }
            }
            piece.push(*point);
        }
        finish(&mut piece);
        pieces
    }

    /// Where the way from one point to another passes the depths of filled shapes, in its order.
    fn cuts(&self, from: Point, to: Point) -> Vec<Point> {
        let [start, end] = [from, to].map(|point| dot(point, self.towards));
        let (low, high) = (start.min(end) + self.near, start.max(end) - self.near);
        let passed = self.filled.iter().filter(|depth| **depth > low && **depth < high);
        let way = plus(to, -1.0, from);
        let mut cuts: Vec<Point> = passed.map(|depth| plus(from, (depth - start) / (end - start), way)).collect();
        if end < start {
            cuts.reverse();
        }
        cuts
    }
}

/// The parts of shapes in space at one moment, from the farthest to the nearest, each with its shape.
///
/// A filled shape is as far away as its middle.  Lines are cut where they pass one; planes, curves and traces are behind everything.
pub(super) fn ordered<'a>(shapes: &[Drawn<'a>], numbers: &[f64], towards: Point, reach: f64) -> Vec<(Drawn<'a>, Part)> {
    let depth = |drawn: &Drawn<'_>| dot(middle(drawn.shape, drawn.own(numbers)), towards);
    let mut filled: Vec<f64> = shapes.iter().filter(|drawn| is_filled(drawn.shape)).map(depth).collect();
    filled.retain(|depth| depth.is_finite());
    filled.sort_by(f64::total_cmp);
    let order = Order { towards, filled, near: NEARER * reach };
    // Sorted by the filled shapes behind, whether it is one itself, its layer, and its place in the file.
    let mut parts = Vec::new();
    for drawn in shapes {
        let mut add = |behind: usize, part: Part| {
            let key = (behind, is_filled(drawn.shape), layer(drawn.shape), drawn.place);
            parts.push((key, (*drawn, part)));
        };
        match drawn.shape {
            Shape::Line(_) => {
                let (points, _) = drawn.points(numbers);
                order.pieces(&points).into_iter().for_each(|(behind, piece)| add(behind, Part::Line(0, piece)));
                points.iter().for_each(|point| add(order.behind(order.depth(&[*point])), Part::Joint(*point)));
            }
            Shape::Ring | Shape::Axes => {
                let lines = outlines(drawn.shape, drawn.own(numbers), towards).into_iter().enumerate();
                for (which, line) in lines {
                    let pieces = order.pieces(&line.points).into_iter();
                    pieces.for_each(|(behind, piece)| add(behind, Part::Line(which, piece)));
                    if let (Shape::Axes, Some(tip)) = (drawn.shape, line.points.last()) {
                        add(order.behind(order.depth(&[*tip])), Part::Tip(which, *tip));
                    }
                }
            }
            Shape::Plane | Shape::Curve(_) | Shape::Trace(_) => add(0, Part::Whole),
            Shape::Spring | Shape::Circle => add(order.behind(order.depth(&drawn.points(numbers).0)), Part::Whole),
            _ => add(order.behind(depth(drawn) + order.near), Part::Whole),
        }
    }
    parts.sort_by_key(|(key, _)| *key);
    parts.into_iter().map(|(_, part)| part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::show::Animation;

    const TOWARDS: Point = [0.0, 0.0, 1.0];

    /// What is drawn, in order, seen from above.
    fn seen(shapes: &[Shape], numbers: &[f64]) -> Vec<(usize, Part)> {
        let animation = Animation::new("Any", 3, shapes.to_vec());
        let parts = ordered(&Drawn::all(&animation), numbers, TOWARDS, 1.0);
        parts.into_iter().map(|(drawn, part)| (drawn.place, part)).collect()
    }

    #[test]
    fn nearer_solids_cover_farther_ones() {
        let ball = |z: f64| [0.0, 0.0, z, 0.1];
        let numbers = [ball(0.5), ball(-0.5), ball(f64::NAN), ball(0.0)].concat();
        let places: Vec<usize> = seen(&vec![Shape::Sphere; 4], &numbers).iter().map(|(place, _)| *place).collect();
        assert_eq!(places.iter().filter(|place| **place != 2).collect::<Vec<_>>(), [&1, &3, &0]);
    }

    #[test]
    fn a_line_through_a_disc_is_cut_by_it() {
        let numbers = [0.0, 0.0, -1.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.2];
        let (low, cut, high) = ([0.0, 0.0, -1.0], [0.0; 3], [0.0, 0.0, 3.0]);
        for numbers in [numbers, [&numbers[3..6], &numbers[..3], &numbers[6..]].concat().try_into().unwrap()] {
            let found = seen(&[Shape::Line(2), Shape::Disc], &numbers);
            let upwards = numbers[2] < 0.0;
            let line =
                |from: Point, to: Point| (0, Part::Line(0, if upwards { vec![from, to] } else { vec![to, from] }));
            let behind = [line(low, cut), (0, Part::Joint(low))];
            let before = [line(cut, high), (0, Part::Joint(high))];
            assert_eq!(found, [&behind[..], &[(1, Part::Whole)], &before].concat());
        }
    }

    #[test]
    fn without_filled_shapes_lines_stay_whole_and_kinds_keep_their_order() {
        let shapes = [Shape::Circle, Shape::Line(3), Shape::Trace("p".into()), Shape::Spring];
        let (up, down) = ([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
        let numbers = [&down[..], &[0.1], &up, &down, &up, &up, &down, &up].concat();
        let found = seen(&shapes, &numbers);
        let joints = [up, down, up].map(|point| (1, Part::Joint(point)));
        let line = (1, Part::Line(0, vec![up, down, up]));
        let expected = [&[(2, Part::Whole), (3, Part::Whole), line][..], &joints, &[(0, Part::Whole)]].concat();
        assert_eq!(found, expected);
    }

    #[test]
    fn the_end_of_a_line_at_the_middle_of_a_ball_is_in_it() {
        for rounding in [-1e-15, 0.0, 1e-15] {
            let numbers = [0.0, 0.0, rounding, 1.0, 0.0, rounding, 0.0, 0.0, 0.0, 0.1];
            let found = seen(&[Shape::Line(2), Shape::Sphere], &numbers);
            assert_eq!(found.last(), Some(&(1, Part::Whole)));
        }
    }

    #[test]
    fn planes_are_behind_everything_and_gaps_stay_gaps() {
        let gap = [f64::NAN; 3];
        let numbers =
            [&[0.0, 0.0, 9.0, 0.0, 0.0, 1.0][..], &[0.0; 3], &gap, &[1.0, 0.0, 0.0], &[2.0, 0.0, 0.0]].concat();
        let found = seen(&[Shape::Plane, Shape::Line(4)], &numbers);
        assert_eq!(found[0], (0, Part::Whole));
        assert_eq!(found[1], (1, Part::Line(0, vec![[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])));
    }
}
