//! Normal modes: M x'' + K x = 0 with symmetric M and K.

use nalgebra::{Complex, DMatrix, DVector};

use super::{Kind, Mode};
use crate::linear::matrices::{Scaled, cholesky, null_space, symmetric_eigen};
use crate::linear::{LinearError, Linearised, SparseMatrix};

/// Matrices of more rows have their rank by the eigenvalues that are computed anyway.
const LARGE: usize = 60;

/// How the generalized eigenproblem K φ = ω² M φ becomes a symmetric one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reduction {
    /// L⁻¹ K L⁻ᵀ with M = L Lᵀ: the cheaper one.
    #[default]
    Cholesky,
    /// M^(-1/2) K M^(-1/2).
    SquareRoot,
}

/// The normal modes of the conservative part: M and (K + Kᵀ)/2, whatever damping there is.
///
/// They come in rising order of ω²: growing directions (ω² < 0, e^(±γt)), then rigid modes, then
/// oscillations.  Shapes fulfil φᵢᵀ M φⱼ = δᵢⱼ, those of equal and nearly equal frequencies included.
/// Rigid modes are counted by the rank of K, its rows and columns brought to one size (singular values above
/// 16 n ε), never by a bound on ω (catalogue L3): a stiffness of 1e-3 N/m counts beside 1e12 N/m.
///
/// # Errors
/// [`LinearError::SingularMass`], and [`LinearError::NoConvergence`] of the eigenvalue iteration.
pub fn normal_modes(linear: &Linearised, reduction: Reduction) -> Result<Vec<Mode>, LinearError> {
    let (mass, stiffness) = (&linear.mass, &linear.conservative());
    let spectrum = Spectrum::new(mass, stiffness, reduction).map_err(|e| e.named(linear))?;
    Ok(spectrum.modes(mass, &linear.coordinates))
}

/// ω² in rising order, with mass-normalised shapes as columns.
pub struct Spectrum {
    pub squares: Vec<f64>,
    pub shapes: DMatrix<f64>,
}

/// What failed, before names are known.
pub enum Fault {
    SingularMass(usize),
    NoConvergence,
}

impl Fault {
    pub fn named(self, linear: &Linearised) -> LinearError {
        match self {
            Fault::SingularMass(index) => linear.singular(index),
            Fault::NoConvergence => LinearError::NoConvergence { what: "the eigenvalue iteration" },
        }
    }

    pub fn numbered(self) -> LinearError {
        match self {
            Fault::SingularMass(index) => LinearError::SingularMass { coordinate: index.to_string() },
            Fault::NoConvergence => LinearError::NoConvergence { what: "the eigenvalue iteration" },
        }
    }
}

impl Spectrum {
    pub fn new(mass: &SparseMatrix, stiffness: &SparseMatrix, reduction: Reduction) -> Result<Spectrum, Fault> {
        let n = mass.rows;
        if n == 0 {
            return Ok(Spectrum { squares: Vec::new(), shapes: DMatrix::zeros(0, 0) });
        }
        let scaled = Scaled::new(mass);
        let in_units = scaled.stiffness(&stiffness.to_dense());
        let (problem, back): (DMatrix<f64>, Back) = match (mass.diagonal(), reduction) {
            (Some(diagonal), _) => {
                if let Some(index) = diagonal.iter().position(|m| !(*m > 0.0 && m.is_finite())) {
                    return Err(Fault::SingularMass(index));
                }
                (in_units.clone(), Back::Diagonal(DVector::from_vec(diagonal).map(|m| 1.0 / m.sqrt())))
            }
            (None, Reduction::Cholesky) => {
                let l = cholesky(&mass.to_dense()).map_err(Fault::SingularMass)?;
                let mut half = stiffness.to_dense();
                l.solve_lower_triangular_mut(&mut half);
                let mut whole = half.transpose();
                l.solve_lower_triangular_mut(&mut whole);
                (symmetric(whole), Back::Cholesky(l))
            }
            (None, Reduction::SquareRoot) => {
                let dense = mass.to_dense();
                cholesky(&dense).map_err(Fault::SingularMass)?;
                let (masses, vectors) = eigen(dense)?;
                let root = DMatrix::from_diagonal(&masses.map(|m| 1.0 / m.sqrt()));
                let inverse_root = &vectors * root * vectors.transpose();
                (symmetric(&inverse_root * stiffness.to_dense() * &inverse_root), Back::Whole(inverse_root))
            }
        };
        let (eigenvalues, vectors) = eigen(problem)?;
        let nullity = match &back {
            Back::Diagonal(_) if n > LARGE => nullity(eigenvalues.as_slice()),
            _ => null_space(&in_units).ok_or(Fault::NoConvergence)?.ncols(),
        };
        let shapes = back.shapes(vectors);
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|a, b| eigenvalues[*a].abs().total_cmp(&eigenvalues[*b].abs()));
        let mut squares: Vec<f64> = eigenvalues.iter().copied().collect();
        for index in &order[..nullity] {
            squares[*index] = 0.0;
        }
        order.sort_by(|a, b| squares[*a].total_cmp(&squares[*b]));
        Ok(Spectrum {
            squares: order.iter().map(|i| squares[*i]).collect(),
            shapes: DMatrix::from_fn(n, n, |row, column| shapes[(row, order[column])]),
        })
    }

    fn modes(&self, mass: &SparseMatrix, names: &[String]) -> Vec<Mode> {
        let n = self.squares.len();
        let momenta = mass.to_dense() * &self.shapes;
        let complex = |x: &f64| Complex::new(*x, 0.0);
        (0..n)
            .map(|k| {
                let square = self.squares[k];
                let omega = square.abs().sqrt();
                let what = if square > 0.0 {
                    (omega, Some(0.0), Complex::new(0.0, omega), Kind::Oscillating)
                } else if square < 0.0 {
                    (omega, Some(-1.0), Complex::new(omega, 0.0), Kind::Unstable)
                } else {
                    (0.0, None, Complex::new(0.0, 0.0), Kind::Rigid)
                };
                let shape = self.shapes.column(k).iter().map(complex).collect();
                let momentum: Vec<Complex<f64>> = momenta.column(k).iter().map(complex).collect();
                let mut mode = Mode::with_momentum(shape, &momentum, names, what);
                // Nearer ones have shapes without a meaning of their own.
                let near = |other: f64| 1e6 * f64::EPSILON * square.abs().max(other.abs());
                let close = |j: usize| (self.squares[j] - square).abs() <= near(self.squares[j]);
                mode.repeated = (k > 0 && close(k - 1)) || (k + 1 < n && close(k + 1));
                mode
            })
            .collect()
    }
}

/// From eigenvectors of the symmetric problem to shapes.
enum Back {
    Diagonal(DVector<f64>),
    Cholesky(DMatrix<f64>),
    Whole(DMatrix<f64>),
}

impl Back {
    fn shapes(&self, mut vectors: DMatrix<f64>) -> DMatrix<f64> {
        match self {
            Back::Diagonal(roots) => {
                for (mut row, root) in vectors.row_iter_mut().zip(roots.iter()) {
                    row *= *root;
                }
                vectors
            }
            Back::Cholesky(l) => {
                l.tr_solve_lower_triangular_mut(&mut vectors);
                vectors
            }
            Back::Whole(inverse_root) => inverse_root * vectors,
        }
    }
}

fn nullity(eigenvalues: &[f64]) -> usize {
    let norm = eigenvalues.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let threshold = Scaled::threshold(eigenvalues.len(), norm);
    eigenvalues.iter().filter(|x| x.abs() <= threshold).count()
}

fn eigen(matrix: DMatrix<f64>) -> Result<(DVector<f64>, DMatrix<f64>), Fault> {
    symmetric_eigen(matrix).ok_or(Fault::NoConvergence)
}

fn symmetric(matrix: DMatrix<f64>) -> DMatrix<f64> {
    (&matrix + matrix.transpose()) * 0.5
}
