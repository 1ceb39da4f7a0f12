//! How fast dissipation damps a mode that is nearly undamped, judged by the mode's own terms.

use nalgebra::Complex;

use crate::linear::{Linearised, SparseMatrix};

/// Parts of a shape below this part of its largest (both by the square root of mass) are rounding.
const PART: f64 = 1e-11;
/// What dissipation leaves of its own terms, below which it is none.
const DISSIPATED: f64 = 1e-10;

/// The dissipative part of C, where nothing but it damps: K without circulatory part.
pub struct Dissipation {
    matrix: SparseMatrix,
    gyroscopic: SparseMatrix,
    mass: SparseMatrix,
    roots: Vec<f64>,
    circulatory: bool,
}

impl Dissipation {
    pub fn of(linear: &Linearised) -> Dissipation {
        let (matrix, gyroscopic) = linear.damping.split();
        let mut roots = vec![0.0; linear.len()];
        for (row, column, value) in &linear.mass.entries {
            if row == column {
                roots[*row as usize] = value.abs().sqrt();
            }
        }
        let circulatory = !linear.circulatory().is_zero();
        Dissipation { matrix, gyroscopic, mass: linear.mass.clone(), roots, circulatory }
    }

    /// True where nothing dissipates.
    pub fn is_none(&self) -> bool {
        self.matrix.is_zero()
    }

    /// Re λ where it is known better than as a part of λ: 0 of modes that no damper acts on, and of |Re λ| below what
    /// rounding leaves −ω xᴴDx/(2ω xᴴMx + g), from the imaginary part of xᴴ(λ²M + λC + K)x = 0 with g = −i xᴴGx.
    pub fn rate(&self, shape: &[Complex<f64>], value: Complex<f64>, floor: f64) -> Option<f64> {
        let rounding = value.re.abs() <= floor;
        if self.circulatory || self.is_none() {
            return (self.is_none() && rounding).then_some(0.0);
        }
        let clean = self.without_rounding(shape);
        if !self.dissipates(&clean) {
            return Some(0.0);
        }
        if !rounding {
            return None;
        }
        let form = |matrix: &SparseMatrix| -> Complex<f64> {
            matrix.entries.iter().map(|(i, j, x)| clean[*i as usize].conj() * clean[*j as usize] * *x).sum()
        };
        let (dissipated, inertia) = (form(&self.matrix).re, 2.0 * value.im * form(&self.mass).re);
        let below = inertia + form(&self.gyroscopic).im;
        (below.abs() > 1e-3 * inertia).then(|| -value.im * dissipated / below)
    }

    fn without_rounding(&self, shape: &[Complex<f64>]) -> Vec<Complex<f64>> {
        let sizes: Vec<f64> = shape.iter().zip(&self.roots).map(|(x, root)| x.norm() * root).collect();
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        let zero = Complex::new(0.0, 0.0);
        shape.iter().zip(&sizes).map(|(x, size)| if *size <= PART * largest { zero } else { *x }).collect()
    }

    /// True where D x is not 0 to rounding in some row.
    fn dissipates(&self, shape: &[Complex<f64>]) -> bool {
        let mut rows = vec![(Complex::new(0.0, 0.0), 0.0); shape.len()];
        for (row, column, value) in &self.matrix.entries {
            let part = shape[*column as usize] * *value;
            let (sum, terms) = &mut rows[*row as usize];
            *sum += part;
            *terms += part.norm();
        }
        rows.iter().any(|(sum, terms)| sum.norm() > DISSIPATED * terms)
    }
}
