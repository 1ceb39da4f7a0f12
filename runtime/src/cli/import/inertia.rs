//! Turns with numbers: frames as matrices, tensors of inertia along other axes, what a joint moves.

/// The axes of a frame as columns, by rows.
pub type Matrix = [[f64; 3]; 3];

/// An angle this close to a quarter turn is meant to be one: half a unit of the tenth decimal, as for angles that are written.
pub const CLOSE: f64 = 5e-11;

pub const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Sine and cosine; of quarter turns exactly.
fn sin_cos(angle: f64) -> (f64, f64) {
    let quarters = (angle / std::f64::consts::FRAC_PI_2).round();
    if (angle - quarters * std::f64::consts::FRAC_PI_2).abs() > CLOSE {
        return angle.sin_cos();
    }
    match quarters.rem_euclid(4.0) {
        0.0 => (0.0, 1.0),
        1.0 => (1.0, 0.0),
        2.0 => (0.0, -1.0),
        _ => (-1.0, 0.0),
    }
}

/// R = Rz(yaw) Ry(pitch) Rx(roll), of angles about the fixed axes x, y, z in this order.
pub fn turned([roll, pitch, yaw]: [f64; 3]) -> Matrix {
    let ((sr, cr), (sp, cp), (sy, cy)) = (sin_cos(roll), sin_cos(pitch), sin_cos(yaw));
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}

pub fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

pub fn apply(a: &Matrix, v: [f64; 3]) -> [f64; 3] {
    a.map(|row| dot(row, v))
}

fn transposed(a: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The rows of a tensor given by xx, yy, zz, xy, xz, yz.
pub fn rows([xx, yy, zz, xy, xz, yz]: &[f64; 6]) -> Matrix {
    [[*xx, *xy, *xz], [*xy, *yy, *yz], [*xz, *yz, *zz]]
}

/// The tensor R I Rᵀ, with the elements below its rounding left out.
pub fn along(turn: &Matrix, tensor: &[f64; 6]) -> [f64; 6] {
    if *turn == IDENTITY {
        return *tensor;
    }
    let full = times(&times(turn, &rows(tensor)), &transposed(turn));
    let largest = tensor.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let kept = |x: f64| if x.abs() < 4.0 * f64::EPSILON * largest { 0.0 } else { x };
    [full[0][0], full[1][1], full[2][2], full[0][1], full[0][2], full[1][2]].map(kept)
}

/// What bodies of a place and turn have together about a point: mass, and the tensor of inertia.
#[derive(Clone, Copy, Debug, Default)]
pub struct Composite {
    pub mass: f64,
    pub tensor: Matrix,
}

impl Composite {
    /// Adds a body: its mass, its centre from the point, and its tensor about its centre, in the same axes.
    pub fn add(&mut self, mass: f64, from: [f64; 3], tensor: &[f64; 6]) {
        self.mass += mass;
        let (own, square) = (rows(tensor), dot(from, from));
        for i in 0..3 {
            for j in 0..3 {
                let diagonal = if i == j { square } else { 0.0 };
                self.tensor[i][j] += own[i][j] + mass * (diagonal - from[i] * from[j]);
            }
        }
    }

    /// The moment of inertia about an axis through the point, of a direction of length 1.
    pub fn about(&self, axis: [f64; 3]) -> f64 {
        dot(axis, apply(&self.tensor, axis))
    }
}
