//! Where everything is that an animation ever draws.

use super::Animation;
use super::solids::{self, Bound, Point, norm, plus};
use crate::mechanism::Shape;

/// One shape of an animation.
#[derive(Clone, Copy)]
pub(super) struct Drawn<'a> {
    pub shape: &'a Shape,
    /// Its place among all shapes.
    #[cfg(feature = "png")]
    pub place: usize,
    /// The place of its first number.
    pub first: usize,
    /// Components of its points.
    dimension: usize,
}

impl<'a> Drawn<'a> {
    /// All shapes, in the file's order.
    pub fn all(animation: &'a Animation) -> Vec<Drawn<'a>> {
        let (mut first, dimension) = (0, animation.dimension as usize);
        let mut drawn = Vec::new();
        for shape in &animation.shapes {
            #[cfg(feature = "png")]
            let place = drawn.len();
            drawn.push(Drawn {
                shape,
                #[cfg(feature = "png")]
                place,
                first,
                dimension,
            });
            first += shape.numbers(dimension);
        }
        drawn
    }

    /// Its numbers among those of all shapes; fewer where they are not there.
    pub fn own<'n>(&self, numbers: &'n [f64]) -> &'n [f64] {
        let end = self.first + self.shape.numbers(self.dimension);
        &numbers[self.first.min(numbers.len())..end.min(numbers.len())]
    }

    /// The points of a shape, and its radius if it is a circle; none of a shape in space.
    pub fn points(&self, numbers: &[f64]) -> (Vec<Point>, f64) {
        let dimension = self.dimension;
        let count = match self.shape {
            Shape::Line(count) | Shape::Curve(count) => *count as usize,
            Shape::Spring => 2,
            Shape::Circle | Shape::Trace(_) => 1,
            _ => 0,
        };
        let number = |k: usize| numbers.get(self.first + k).copied().unwrap_or(f64::NAN);
        let point = |i: usize| std::array::from_fn(|k| if k < dimension { number(i * dimension + k) } else { 0.0 });
        let radius = if *self.shape == Shape::Circle { number(dimension).abs() } else { 0.0 };
        ((0..count).map(point).collect(), radius)
    }

    /// Its first point.
    #[cfg(feature = "png")]
    pub fn origin(&self, numbers: &[f64]) -> Point {
        std::array::from_fn(|k| self.own(numbers).get(k).copied().unwrap_or(f64::NAN))
    }

    /// Where its parts are; nothing of what is not there.
    fn bounds(&self, numbers: &[f64]) -> Vec<Bound> {
        let (points, radius) = self.points(numbers);
        let radius = if radius.is_finite() { radius } else { 0.0 };
        let points = points.into_iter().map(|point| Bound::ball(point, radius));
        let there = |bound: &Bound| bound.centre.iter().chain(&bound.half).all(|x| x.is_finite());
        points.chain(solids::bounds(self.shape, self.own(numbers))).filter(there).collect()
    }
}

/// The ends of everything that is ever drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    pub low: Point,
    pub high: Point,
    /// The farthest from the middle.
    pub reach: f64,
}

impl Extent {
    /// Of all frames; of a metre about the origin where nothing is drawn.
    pub fn of(animation: &Animation) -> Extent {
        let shapes = Drawn::all(animation);
        let mut ends: Vec<Bound> = Vec::new();
        for (_, numbers) in &animation.frames {
            ends.extend(shapes.iter().flat_map(|drawn| drawn.bounds(numbers)));
            let arrows = (0..animation.arrow_count()).flat_map(|arrow| animation.arrow(arrow, numbers));
            let there = arrows.filter(|end| end.iter().all(|x| x.is_finite()));
            ends.extend(there.map(|end| Bound::ball(end, 0.0)));
        }
        if ends.is_empty() {
            ends.push(Bound::ball([0.0; 3], 1.0));
        }
        let low = std::array::from_fn(|k| ends.iter().map(|b| b.centre[k] - b.half[k]).fold(f64::INFINITY, f64::min));
        let high =
            std::array::from_fn(|k| ends.iter().map(|b| b.centre[k] + b.half[k]).fold(f64::NEG_INFINITY, f64::max));
        let mut extent = Extent { low, high, reach: 0.0 };
        let centre = extent.centre();
        let away = |bound: &Bound| norm(plus(bound.centre, -1.0, centre)) + bound.radius;
        extent.reach = ends.iter().map(away).fold(0.0, f64::max);
        if extent.reach <= 0.0 {
            extent.reach = 1.0;
        }
        extent
    }

    /// The middle of the picture.
    pub fn centre(&self) -> Point {
        std::array::from_fn(|k| (self.low[k] + self.high[k]) / 2.0)
    }

    /// The height of the ground under a motion in space.
    #[cfg(feature = "png")]
    pub fn floor(&self) -> f64 {
        if self.low[2] >= 0.0 && self.low[2] < 0.3 * self.reach { 0.0 } else { self.low[2] }
    }
}
