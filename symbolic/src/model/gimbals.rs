//! Where three angles cannot turn a frame in every direction: gimbal lock.

/// A matrix of numbers, row by row.
type Matrix = [[f64; 3]; 3];

/// No turn.
const UNTURNED: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The sine of the angle between two axes that are one, or between an axis and a plane that contains it, but for rounding.
const PARALLEL: f64 = 1e-12;

/// What the angle of a turn is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Angle {
    /// A number.
    Fixed(f64),
    /// factor · q + offset of one coordinate.
    Linear {
        /// The coordinate's place.
        coordinate: usize,
        /// The factor.
        factor: f64,
        /// What is added, rad.
        offset: f64,
    },
    /// Something else.
    Other,
}

/// A turn by a coordinate.
#[derive(Clone, Debug, PartialEq)]
struct CoordinateTurn {
    /// The frame that it turns.
    frame: String,
    /// How fixed turns stand between the turn before and this one: its components after to those before.
    before: Matrix,
    /// Its axis, of length 1.
    axis: [f64; 3],
    /// Coordinate, factor and offset.
    angle: (usize, f64, f64),
}

/// The turns of a frame by coordinates since the ground, a rotation or a turn that is none of these, in numbers at the parameters' defaults.
#[derive(Clone, Debug, PartialEq)]
pub struct Turns {
    by_coordinates: Vec<CoordinateTurn>,
    /// The fixed turns since the last of them.
    fixed: Matrix,
}

impl Turns {
    /// None.
    pub fn none() -> Turns {
        Turns { by_coordinates: Vec::new(), fixed: UNTURNED }
    }

    /// One more, of this frame.
    pub fn push(&mut self, frame: &str, axis: [f64; 3], angle: Angle) {
        match angle {
            Angle::Fixed(angle) => self.fixed = product(&self.fixed, &turn(axis, angle)),
            Angle::Linear { coordinate, factor, offset } => {
                let before = std::mem::replace(&mut self.fixed, UNTURNED);
                let angle = (coordinate, factor, offset);
                self.by_coordinates.push(CoordinateTurn { frame: frame.to_owned(), before, axis, angle });
            }
            Angle::Other => *self = Turns::none(),
        }
    }

    /// Each three turns that follow each other, as far as they can lock.
    pub fn gimbals(&self) -> Vec<Gimbal> {
        self.by_coordinates.windows(3).filter_map(Gimbal::of).collect()
    }
}

/// Three turns that follow each other.  The product of their axes e₁·(e₂ × e₃) is `amplitude` · sin(`factor` q₂ + `phase`); where it is 0
/// the outer two have one axis, seen along the middle one, and some rates of the three angles do not turn the frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Gimbal {
    /// The frame that the last one turns.
    pub frame: String,
    /// Their coordinates, in order.
    pub coordinates: [usize; 3],
    /// The largest product, 1 for axes at right angles.
    pub amplitude: f64,
    /// What the middle coordinate is multiplied by.
    pub factor: f64,
    /// What is added, rad.
    pub phase: f64,
}

impl Gimbal {
    /// With the first axis in the axes that the middle one turns in, c, and the last one, b, in those that it has turned:
    /// c·(a × R b) = c·(a × b) cos + c·(a × (a × b)) sin, by Rodrigues' formula.
    fn of(turns: &[CoordinateTurn]) -> Option<Gimbal> {
        let [first, middle, last] = turns else { return None };
        let coordinates = [first, middle, last].map(|turn| turn.angle.0);
        let [i, j, k] = coordinates;
        if i == j || j == k || i == k {
            return None;
        }
        let c = back(&middle.before, first.axis);
        let b = forth(&last.before, last.axis);
        let across = cross(middle.axis, b);
        let (cosine, sine) = (dot(c, across), dot(c, cross(middle.axis, across)));
        let amplitude = cosine.hypot(sine);
        if !amplitude.is_finite() || amplitude < PARALLEL {
            return None;
        }
        let (_, factor, offset) = middle.angle;
        // x cos + y sin = amplitude · sin(angle + atan2(x, y)).
        let phase = offset + snapped(cosine).atan2(snapped(sine));
        Some(Gimbal { frame: last.frame.clone(), coordinates, amplitude, factor, phase })
    }
}

/// 0 for what is 0 but for rounding.
fn snapped(x: f64) -> f64 {
    if x.abs() < PARALLEL { 0.0 } else { x }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn forth(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| dot(row, v))
}

fn back(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| dot([m[0][k], m[1][k], m[2][k]], v))
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| std::array::from_fn(|k| dot(row, [b[0][k], b[1][k], b[2][k]])))
}

/// A turn about an axis of length 1.
fn turn(axis: [f64; 3], angle: f64) -> Matrix {
    let (sine, cosine) = angle.sin_cos();
    let columns: [[f64; 3]; 3] = std::array::from_fn(|k| {
        let e = UNTURNED[k];
        let (across, along) = (cross(axis, e), dot(axis, e) * (1.0 - cosine));
        std::array::from_fn(|i| cosine * e[i] + sine * across[i] + along * axis[i])
    });
    std::array::from_fn(|i| std::array::from_fn(|k| columns[k][i]))
}

#[cfg(test)]
mod tests {
    use super::{Angle, Turns};
    use std::f64::consts::FRAC_PI_2;

    const AXES: [[f64; 3]; 3] = super::UNTURNED;

    fn by(coordinate: usize) -> Angle {
        Angle::Linear { coordinate, factor: 1.0, offset: 0.0 }
    }

    /// e₁·(e₂ × e₃) of a sequence, from the gimbal.
    fn product(sequence: [usize; 3], q: f64) -> f64 {
        let mut turns = Turns::none();
        for (coordinate, axis) in sequence.into_iter().enumerate() {
            turns.push("B", AXES[axis], by(coordinate));
        }
        let gimbals = turns.gimbals();
        let [gimbal] = gimbals.as_slice() else { panic!("{gimbals:?}") };
        assert_eq!((gimbal.frame.as_str(), gimbal.coordinates), ("B", [0, 1, 2]));
        gimbal.amplitude * (gimbal.factor * q + gimbal.phase).sin()
    }

    #[test]
    fn proper_sequences_lock_at_sine_0_and_the_others_at_cosine_0() {
        for q in [0.0, 0.3, 1.2, FRAC_PI_2, 2.8_f64] {
            // Known of Euler's and of Cardan's angles: the determinant of the rates' matrix is -sin q₂ (z-x-z) or ± cos q₂.
            assert!((product([2, 0, 2], q).abs() - q.sin().abs()).abs() < 1e-15);
            assert!((product([0, 1, 2], q) - q.cos()).abs() < 1e-15);
            assert!((product([2, 1, 0], q) + q.cos()).abs() < 1e-15);
        }
    }

    #[test]
    fn fixed_turns_between_move_the_lock() {
        let mut turns = Turns::none();
        turns.push("A", AXES[2], by(0));
        turns.push("A", AXES[0], Angle::Fixed(0.4));
        turns.push("A", AXES[0], by(1));
        turns.push("B", AXES[2], by(2));
        let gimbal = &turns.gimbals()[0];
        let at = |q: f64| gimbal.amplitude * (gimbal.factor * q + gimbal.phase).sin();
        assert!(at(-0.4).abs() < 1e-15 && at(0.0).abs() > 0.3);
    }

    #[test]
    fn a_turn_by_something_else_begins_anew() {
        let mut turns = Turns::none();
        turns.push("A", AXES[2], by(0));
        turns.push("A", AXES[0], Angle::Other);
        turns.push("A", AXES[0], by(1));
        turns.push("B", AXES[2], by(2));
        assert!(turns.gimbals().is_empty());
        turns.push("C", AXES[0], by(3));
        assert_eq!(turns.gimbals().len(), 1);
        turns.push("D", AXES[0], by(4));
        assert_eq!(turns.gimbals().len(), 1, "two turns about one axis are one");
    }
}
