//! Animations in space as they are drawn: what is up in the file is z, and all axes have a length.

use std::borrow::Cow;

use super::Animation;
use super::extent::{Drawn, Extent};
use super::solids::Point;
use crate::mechanism::Shape;

/// The length of axes that have none in the file, of the distance of the farthest of the rest from the middle of the picture.
const AXES: f64 = 0.25;

/// Which of the ground's axes is most nearly up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Up {
    axis: usize,
    sign: f64,
}

impl Up {
    /// By a direction; z where it says nothing.
    fn of(direction: Point) -> Up {
        let axis = (0..2).fold(2, |best, k| if direction[k].abs() > direction[best].abs() { k } else { best });
        Up { axis, sign: if direction[axis] < 0.0 { -1.0 } else { 1.0 } }
    }

    /// A vector of the file where what is up is z: right-handed, turned by whole quarters.
    fn upright(self, vector: Point) -> Point {
        let Up { axis, sign } = self;
        [vector[(axis + 1) % 3], sign * vector[(axis + 2) % 3], sign * vector[axis]]
    }
}

impl Animation {
    /// The animation in which z is up and all axes have a length.
    pub(crate) fn upright(&self) -> Cow<'_, Animation> {
        let up = Up::of(self.up);
        let sized = !self.shapes.contains(&Shape::UnitAxes);
        if self.dimension != 3 || (up == Up::of([0.0; 3]) && sized) {
            return Cow::Borrowed(self);
        }
        let length = if sized { 1.0 } else { AXES * Extent::of(self).reach };
        let shapes = Drawn::all(self);
        let mut upright = self.clone();
        for (_, numbers) in &mut upright.frames {
            for drawn in &shapes {
                turn(drawn, numbers, up, length);
            }
            let arrows = self.first_of_arrows().min(numbers.len());
            for end in numbers[arrows..].as_chunks_mut::<3>().0 {
                *end = up.upright(*end);
            }
        }
        for shape in upright.shapes.iter_mut().filter(|shape| **shape == Shape::UnitAxes) {
            *shape = Shape::Axes;
        }
        Cow::Owned(upright)
    }

    /// The file's axes x, y and z where what is up is z.
    pub(super) fn ground_axes(&self) -> [Point; 3] {
        let up = Up::of(self.up);
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| up.upright(axis))
    }
}

/// Turns the points and vectors of a shape, and gives unit axes this length.
fn turn(drawn: &Drawn<'_>, numbers: &mut [f64], up: Up, length: f64) {
    let end = (drawn.first + drawn.shape.numbers(3)).min(numbers.len());
    let own = &mut numbers[drawn.first.min(end)..end];
    // A radius is the last number, after the points.
    for (index, vector) in own.as_chunks_mut::<3>().0.iter_mut().enumerate() {
        let factor = if *drawn.shape == Shape::UnitAxes && index > 0 { length } else { 1.0 };
        *vector = up.upright(*vector).map(|x| factor * x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn upright(up: Point, shapes: Vec<Shape>, numbers: Vec<f64>) -> Animation {
        let animation = Animation { up, ..Animation::new("Any", 3, shapes) }.with_frames([(0.0, numbers)]);
        animation.upright().into_owned()
    }

    #[test]
    fn what_is_up_in_the_file_is_z() {
        for up in
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-9.8, 0.1, 0.2], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]
        {
            let nearest = up.map(|x: f64| if x.abs() > 0.5 { x.signum() } else { 0.0 });
            let found = upright(up, vec![Shape::Sphere], [&nearest[..], &[2.0]].concat());
            assert_eq!(found.frames[0].1, [0.0, 0.0, 1.0, 2.0]);
            let [x, y, z] = found.ground_axes();
            let volume = (0..3).map(|k| x[k] * (y[(k + 1) % 3] * z[(k + 2) % 3] - y[(k + 2) % 3] * z[(k + 1) % 3]));
            assert_eq!(volume.sum::<f64>(), 1.0);
        }
        let animation = Animation::new("Any", 3, vec![Shape::Sphere]).with_frames([(0.0, vec![1.0, 2.0, 3.0, 4.0])]);
        assert!(matches!(animation.upright(), Cow::Borrowed(_)));
    }

    #[test]
    fn axes_without_a_length_get_a_quarter_of_the_reach_of_the_rest() {
        let unit = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let ball = [0.0, 0.0, 0.0, 2.0];
        let numbers = [&ball[..], &[0.0, 0.0, 1.0], &unit].concat();
        let found = upright([0.0; 3], vec![Shape::Sphere, Shape::UnitAxes], numbers);
        assert_eq!(found.shapes, [Shape::Sphere, Shape::Axes]);
        assert_eq!(found.frames[0].1[7..], [0.5, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.5]);
        assert_eq!(found.frames[0].1[4..7], [0.0, 0.0, 1.0]);
    }
}
