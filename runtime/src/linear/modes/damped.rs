//! Modes of damped, gyroscopic and circulatory systems: M x'' + C x' + K x = 0 with any C and K.

use nalgebra::{Complex, DMatrix, DVector};

use super::classical::decoupled;
use super::dissipation::Dissipation;
use super::graded::by_circles;
use super::{Kind, Mode, secular};
use crate::linear::matrices::{Eigen, Scaled, Singular, cholesky, condition, null_space};
use crate::linear::{LinearError, Linearised};
use crate::matrix::{equilibrated, is_symmetric, rank};

/// Eigenvectors beyond this condition number are no basis to compute with.
const WORST_CONDITION: f64 = 1e6;
/// Two eigenvalues nearer than this, relatively, with parallel shapes are one double eigenvalue: rounding splits
/// a defective pair by √ε (catalogue L2).
const SPLIT: f64 = 1e-7;

/// The modes of the first-order form z' = A z, z = (x, x').
#[derive(Clone, Debug, PartialEq)]
pub struct ComplexModes {
    /// Growing motions first, the fastest leading; then rigid ones; then by rising ω.  Each conjugate pair is one
    /// mode, each real eigenvalue one, but for double ones with a single shape (`critical`).
    pub modes: Vec<Mode>,
    /// All 2n eigenvalues, 1/s, as they were computed, zeros by rank exact.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Condition number of the matrix of eigenvectors (of unit length, with x in units that make M and the largest
    /// frequency 1); infinite where rigid motions A + B t leave too few of them.
    pub condition: f64,
    /// True where the eigenvectors are no basis: motions are then to be computed by the matrix exponential, as
    /// [`Linearised::free_motion`] always does.
    pub defective: bool,
    /// Secular (defective) groups: modes, by index, that share one eigenvalue and one shape.  Their motions are
    /// (A + B t) e^(λt), which grows without bound where λ is imaginary.
    pub secular: Vec<Vec<usize>>,
    /// True where K alone would be unstable and only gyroscopic forces hold it: any damping destroys that.
    pub only_gyroscopic: bool,
}

/// Complex modes, by eigenvectors of the first-order form in coordinates that make M the identity.
///
/// Zero eigenvalues are counted by ranks, not by size: as many as K has null vectors N, and once more for each
/// combination of them on which damping does no work (Nᵀ C N): A + B t.
///
/// # Errors
/// [`LinearError::SingularMass`], [`LinearError::NoConvergence`].
pub fn complex_modes(linear: &Linearised) -> Result<ComplexModes, LinearError> {
    let n = linear.len();
    let mass = linear.m();
    let factor = cholesky(&mass).map_err(|index| linear.singular(index))?;
    let units = Units { k: in_units(&factor, &linear.k()), c: in_units(&factor, &linear.c()), factor };
    let rate = units.rate();
    let first_order = units.matrix(rate);
    let solved = match decoupled(linear)? {
        Some(by_mode) => units.first_order(&by_mode, rate),
        None => match by_circles(&first_order)? {
            Some(solved) => solved,
            None => Eigen::of(&first_order).ok_or(LinearError::NoConvergence { what: "the eigenvalue iteration" })?,
        },
    };
    let eigenvalues = solved.values;
    let norm = eigenvalues.iter().fold(0.0_f64, |most, x| most.max(x.norm()));

    let rigid = Rigid::new(linear, &mass, &first_order)?;
    let mut order: Vec<usize> = (0..2 * n).collect();
    order.sort_by(|a, b| eigenvalues[*a].norm().total_cmp(&eigenvalues[*b].norm()));
    let (zero, rest) = order.split_at(rigid.multiplicity.min(2 * n));
    let shape = |k: usize| -> Vec<Complex<f64>> { units.back((0..n).map(|i| solved.vectors[(i, k)])) };
    let condition = |columns: &[usize]| condition(&solved.vectors.select_columns(columns));
    // Bauer and Fike's bound: rounding moves eigenvalues by no more than this.
    let floor = 16.0 * n as f64 * f64::EPSILON * norm * condition(rest).min(WORST_CONDITION);
    let dissipation = Dissipation::of(linear);

    let mode = |shape, what| Mode::new(shape, &linear.mass, &linear.coordinates, what);
    let mut modes: Vec<Mode> = Vec::new();
    let mut real: Vec<usize> = Vec::new();
    let mut exact = eigenvalues.clone();
    zero.iter().for_each(|k| exact[*k] = Complex::new(0.0, 0.0));
    for &k in rest {
        let value = eigenvalues[k];
        if value.im == 0.0 {
            real.push(k);
        } else if value.im > 0.0 {
            let shape = shape(k);
            let what = match dissipation.rate(&shape, value, floor) {
                Some(rate) => of_pair(Complex::new(rate, value.im), 0.0),
                None => of_pair(value, floor),
            };
            modes.push(mode(shape, what));
        }
    }
    let conserves = linear.dissipative().is_zero() && linear.circulatory().is_zero();
    real_modes((&real, &eigenvalues), conserves, &shape, &mut |shape, what| modes.push(mode(shape, what)));
    for vector in rigid.shapes.column_iter() {
        let shape = vector.iter().map(|x| Complex::new(*x, 0.0)).collect();
        modes.push(mode(shape, (0.0, None, Complex::new(0.0, 0.0), Kind::Rigid)));
    }
    put_in_order(&mut modes);
    let secular = secular::merge(&mut modes, dissipation.is_none());
    mark_repeated(&mut modes);

    let condition = if rigid.multiplicity > rigid.shapes.ncols() { f64::INFINITY } else { condition(&order) };
    let only_gyroscopic = dissipation.is_none() && is_held_by_gyroscopic_forces(linear, &modes);
    Ok(ComplexModes {
        modes,
        eigenvalues: exact,
        condition,
        defective: condition.is_nan() || condition >= WORST_CONDITION || !secular.is_empty(),
        secular,
        only_gyroscopic,
    })
}

/// Growing modes first, the fastest leading; then rigid ones; then by rising ω.
fn put_in_order(modes: &mut [Mode]) {
    let rank = |m: &Mode| match m.kind {
        Kind::Unstable => (0, -m.eigenvalue.re),
        Kind::Rigid => (1, 0.0),
        _ => (2, m.omega),
    };
    modes.sort_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
}

/// Whether K alone would be unstable, and gyroscopic forces hold what nothing damps.
fn is_held_by_gyroscopic_forces(linear: &Linearised, modes: &[Mode]) -> bool {
    let n = linear.len();
    let held = linear.circulatory().is_zero()
        && !linear.gyroscopic().is_zero()
        && modes.iter().all(|m| m.kind != Kind::Unstable);
    // By Sylvester's law the signs are those of the matrix of one size.
    let least = || equilibrated(&linear.k()).0.symmetric_eigenvalues().min();
    held && n > 0 && least() < -Scaled::threshold(n, 1.0)
}

/// ω, ζ, λ and kind of a conjugate pair; `floor` is what rounding leaves of an eigenvalue that is 0.
fn of_pair(value: Complex<f64>, floor: f64) -> (f64, Option<f64>, Complex<f64>, Kind) {
    let omega = value.norm();
    let zeta = -value.re / omega;
    if value.re == 0.0 {
        (omega, Some(0.0), value, Kind::Oscillating)
    } else if value.re > floor {
        (omega, Some(zeta), value, Kind::Unstable)
    } else if value.im <= SPLIT * omega {
        (omega, Some(1.0), Complex::new(value.re, 0.0), Kind::Critical)
    } else if value.re > 0.0 {
        (omega, Some(0.0), value, Kind::Oscillating)
    } else {
        (omega, Some(zeta), value, Kind::Damped)
    }
}

/// What [`real_modes`] hands over.
type Found<'a> = &'a mut dyn FnMut(Vec<Complex<f64>>, (f64, Option<f64>, Complex<f64>, Kind));

/// Modes of real eigenvalues.  Negative ones are paired by the likeness of their shapes: the two of a mode of
/// proportional damping have the same one, ω = √(λ₁λ₂) and ζ = −(λ₁ + λ₂)/(2ω); a single one has ω = |λ|, ζ = 1.  Where energy is conserved
/// each belongs to the positive one of its size instead.
fn real_modes(
    (real, eigenvalues): (&[usize], &[Complex<f64>]),
    conserves: bool,
    shape: &dyn Fn(usize) -> Vec<Complex<f64>>,
    found: Found<'_>,
) {
    for &k in real.iter().filter(|k| eigenvalues[**k].re > 0.0) {
        let value = eigenvalues[k];
        found(shape(k), (value.re, Some(-1.0), value, Kind::Unstable));
    }
    let mut left: Vec<usize> = real.iter().copied().filter(|k| eigenvalues[*k].re < 0.0).collect();
    if conserves {
        left.iter().for_each(|k| found(shape(*k), (-eigenvalues[*k].re, Some(1.0), eigenvalues[*k], Kind::Decaying)));
        return;
    }
    while let Some(k) = left.first().copied() {
        left.remove(0);
        let (one, value) = (shape(k), eigenvalues[k]);
        let alike = |j: &usize| likeness(&one, &shape(*j));
        let partner = left.iter().copied().max_by(|a, b| alike(a).total_cmp(&alike(b)));
        let Some(j) = partner else {
            found(one, (-value.re, Some(1.0), value, Kind::Overdamped));
            break;
        };
        left.retain(|other| *other != j);
        let other = eigenvalues[j];
        let omega = (value.re * other.re).sqrt();
        if (value.re - other.re).abs() <= SPLIT * omega && alike(&j) > 1.0 - 1e-6 {
            let mean = 0.5 * (value + other);
            found(one, (omega, Some(1.0), mean, Kind::Critical));
        } else {
            let zeta = Some(-0.5 * (value.re + other.re) / omega);
            found(one, (omega, zeta, value, Kind::Overdamped));
            found(shape(j), (omega, zeta, other, Kind::Overdamped));
        }
    }
}

/// |aᴴb|²/(|a|²|b|²): 1 for parallel shapes.
pub fn likeness(a: &[Complex<f64>], b: &[Complex<f64>]) -> f64 {
    let dot = |a: &[Complex<f64>], b: &[Complex<f64>]| a.iter().zip(b).map(|(a, b)| a.conj() * b).sum::<Complex<f64>>();
    dot(a, b).norm_sqr() / (dot(a, a).re * dot(b, b).re)
}

fn mark_repeated(modes: &mut [Mode]) {
    for k in 0..modes.len() {
        let size = |j: usize| modes[j].eigenvalue.norm();
        let near = |j: usize| 1e6 * f64::EPSILON * size(j).max(size(k));
        let close = |j: usize| (modes[j].eigenvalue - modes[k].eigenvalue).norm() <= near(j);
        modes[k].repeated = (0..modes.len()).any(|j| j != k && close(j));
    }
}

/// y = Lᵀ x, in which M = L Lᵀ is the identity.
struct Units {
    factor: DMatrix<f64>,
    k: DMatrix<f64>,
    c: DMatrix<f64>,
}

impl Units {
    /// A frequency that makes the blocks of the first-order form of similar size, rad/s.
    fn rate(&self) -> f64 {
        let (k, c) = (self.k.norm().sqrt(), self.c.norm());
        if k > 0.0 {
            k
        } else if c > 0.0 {
            c
        } else {
            1.0
        }
    }

    /// The matrix A of the first-order form in (y, y'/rate).
    fn matrix(&self, rate: f64) -> DMatrix<f64> {
        let n = self.k.nrows();
        DMatrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, true) => 0.0,
            (true, false) => f64::from(u8::from(i + n == j)) * rate,
            (false, true) => -self.k[(i - n, j)] / rate,
            (false, false) => -self.c[(i - n, j - n)],
        })
    }

    /// Eigenvalues and eigenvectors of the first-order form from those mode by mode.
    fn first_order(&self, by_mode: &[(Complex<f64>, DVector<f64>)], rate: f64) -> Eigen {
        let n = self.k.nrows();
        let column = |(value, shape): &(Complex<f64>, DVector<f64>)| {
            let y = self.factor.tr_mul(shape).map(Complex::from);
            DVector::from_fn(2 * n, |i, _| if i < n { y[i] } else { y[i - n] * *value / rate }).normalize()
        };
        let columns: Vec<DVector<Complex<f64>>> = by_mode.iter().map(column).collect();
        let vectors = if n == 0 { DMatrix::zeros(0, 0) } else { DMatrix::from_columns(&columns) };
        Eigen { values: by_mode.iter().map(|pair| pair.0).collect(), vectors }
    }

    fn back(&self, y: impl Iterator<Item = Complex<f64>>) -> Vec<Complex<f64>> {
        let (mut re, mut im): (Vec<f64>, Vec<f64>) = y.map(|y| (y.re, y.im)).unzip();
        for part in [&mut re, &mut im] {
            let mut x = DVector::from_vec(std::mem::take(part));
            self.factor.tr_solve_lower_triangular_mut(&mut x);
            *part = x.as_slice().to_vec();
        }
        re.into_iter().zip(im).map(|(re, im)| Complex::new(re, im)).collect()
    }
}

/// L⁻¹ A L⁻ᵀ.
fn in_units(factor: &DMatrix<f64>, matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let mut half = matrix.clone();
    factor.solve_lower_triangular_mut(&mut half);
    let mut whole = half.transpose();
    factor.solve_lower_triangular_mut(&mut whole);
    whole.transpose()
}

/// The zero eigenvalues of the first-order form.
struct Rigid {
    /// Null vectors of K as columns, orthonormal in M.
    shapes: DMatrix<f64>,
    /// How often 0 is an eigenvalue.
    multiplicity: usize,
}

impl Rigid {
    fn new(linear: &Linearised, mass: &DMatrix<f64>, first_order: &DMatrix<f64>) -> Result<Rigid, LinearError> {
        let scaled = Scaled::new(&linear.mass);
        let stiffness = scaled.stiffness(&linear.k());
        let failed = || LinearError::NoConvergence { what: "the singular value decomposition of K" };
        let right = null_space(&stiffness).ok_or_else(failed)?;
        let free = right.ncols();
        if free == 0 {
            return Ok(Rigid { shapes: right, multiplicity: 0 });
        }
        let left = null_space(&stiffness.transpose()).ok_or_else(failed)?;
        let damping = scaled.stiffness(&linear.c());
        let coupled = left.transpose() * &damping * &right;
        // Singular values of Nᵀ C N against the terms that it is made of.
        let terms = left.abs().transpose() * damping.abs() * right.abs();
        let threshold = Scaled::threshold(linear.len(), terms.amax());
        let working = rank(coupled, threshold).ok_or_else(failed)?;
        let columns: Vec<DVector<f64>> =
            right.column_iter().map(|c| DVector::from_vec(scaled.step(&c.into_owned()))).collect();
        let shapes = orthonormal(columns, mass);
        // Potentials and dampers leave A + B t at most; other forces can drive one zero by another, A + B t + C t² and so on.
        let plain = is_symmetric(&linear.k()) && is_symmetric(&linear.c());
        let more = if plain { 0 } else { zeros(first_order).ok_or_else(failed)? };
        Ok(Rigid { shapes, multiplicity: more.max(free + free - working) })
    }
}

/// How often 0 is an eigenvalue, by ranks: null vectors, then those of what the matrix does beyond them, and so on.
fn zeros(matrix: &DMatrix<f64>) -> Option<usize> {
    let mut left = matrix.clone();
    loop {
        let null = null_space(&left)?;
        if null.ncols() == 0 {
            return Some(matrix.nrows() - left.nrows());
        }
        if null.ncols() == left.nrows() {
            return Some(matrix.nrows());
        }
        let beyond = Singular::of(&(&null * null.transpose()))?.directions(|value| value < 0.5);
        left = beyond.transpose() * left * beyond;
    }
}

/// Gram and Schmidt's process, twice, in the metric M.
fn orthonormal(mut columns: Vec<DVector<f64>>, mass: &DMatrix<f64>) -> DMatrix<f64> {
    for k in 0..columns.len() {
        for _ in 0..2 {
            for j in 0..k {
                let part = columns[j].dot(&(mass * &columns[k]));
                let along = &columns[j] * part;
                columns[k] -= along;
            }
        }
        let length = columns[k].dot(&(mass * &columns[k])).sqrt();
        columns[k] /= length;
    }
    DMatrix::from_columns(&columns)
}
