//! Small motions as x' = A x + B u, y = C x + D u: what programs for control read.

use std::ops::AddAssign;

use nalgebra::{Complex, DMatrix, DVector};

use super::{Drive, Observed, Source};
use crate::linear::matrices::{balanced, cholesky, solve_cholesky};
use crate::linear::{LinearError, Linearised};
use crate::matrix::svd;
use crate::mechanism::rate_name;

/// x' = A x + B u, y − y₀ = C x + D u: departures x from a rest or a steady motion, inputs u, answers y; names and SI units of each.
///
/// With s states, m inputs and p answers.
#[derive(Clone, Debug, PartialEq)]
pub struct InputOutput {
    /// Names and units of x: coordinates, then their rates, then states of first order.
    pub states: Vec<[String; 2]>,
    /// Names and units of u; where rates of an input act, they are inputs after it.
    pub inputs: Vec<[String; 2]>,
    /// Names and units of y.
    pub outputs: Vec<[String; 2]>,
    /// s × s.
    pub a: DMatrix<f64>,
    /// s × m.
    pub b: DMatrix<f64>,
    /// p × s.
    pub c: DMatrix<f64>,
    /// p × m.
    pub d: DMatrix<f64>,
}

/// An eigenvalue whose motions inputs do not reach, or outputs do not show.
#[derive(Clone, Debug, PartialEq)]
pub struct Unreached {
    /// 1/s; of a conjugate pair that with the positive imaginary part.
    pub eigenvalue: Complex<f64>,
    /// In how many directions.
    pub directions: usize,
    /// The state that one of them moves most, or, for inputs, whose equation it contains most.
    pub state: String,
}

/// A direction is not reached where a singular value of [λ − A, B] is below this part of the largest: some way above the rounding of
/// eigenvalues, whose square root it is.
const UNREACHED: f64 = 1e-8;
/// Eigenvalues closer than this part of the largest are one.
const SAME: f64 = 1e-7;

/// The dimension of what A makes of the columns of B, by orthogonal directions one power after another: powers of A themselves would lose the small
/// ones in rounding.
fn reached(a: &DMatrix<f64>, b: &DMatrix<f64>) -> usize {
    let (s, (a, scales)) = (a.nrows(), balanced(a));
    let size = a.amax();
    let mut last = DMatrix::from_fn(s, b.ncols(), |i, k| b[(i, k)] / scales[i]);
    // Units of inputs are anything.
    for mut column in last.column_iter_mut() {
        let norm = column.norm();
        column.scale_mut(if norm > 0.0 { 1.0 / norm } else { 0.0 });
    }
    let mut basis = DMatrix::<f64>::zeros(s, 0);
    while !last.is_empty() {
        // Twice: what is left of a direction that is nearly known is rounded beside what was taken off.
        for _ in 0..2 {
            last -= &basis * basis.tr_mul(&last);
        }
        let Some(parts) = svd(last, true, false) else { return basis.ncols() };
        let Some(left) = &parts.u else { return basis.ncols() };
        let new: Vec<usize> = (0..left.ncols()).filter(|k| parts.singular_values[*k] > UNREACHED).collect();
        if new.is_empty() {
            return basis.ncols();
        }
        let new = left.select_columns(&new);
        basis = DMatrix::from_fn(s, basis.ncols() + new.ncols(), |i, k| match k.checked_sub(basis.ncols()) {
            Some(k) => new[(i, k)],
            None => basis[(i, k)],
        });
        last = &a * new * if size > 0.0 { 1.0 / size } else { 0.0 };
    }
    basis.ncols()
}

/// An input, with its name and unit.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedDrive {
    /// What acts, of size 1; what it consists of in phase.
    pub drive: Drive,
    /// `u`, `a force on x`.
    pub name: String,
    /// SI; empty for a pure number and where it is not known.
    pub unit: String,
}

impl Linearised {
    /// x' = A x + B u and y = C x + D u of these inputs and answers; x are the coordinates and their rates.
    ///
    /// M x'' + C x' + K x = f gives x'' = M⁻¹(f − K x − C x'), which stands in A and B, and in C and D of answers that contain accelerations.
    ///
    /// # Errors
    /// [`LinearError::SingularMass`]; as [`Linearised::driving_force`]; [`LinearError::ReactionToForce`]; [`LinearError::OutOfPhase`].
    ///
    /// # Example
    /// ```
    /// use dalembert::linear::{Guess, NamedDrive, Source, equilibrium_near, linearise, observe};
    /// use dalembert::mechanism::Dynamic;
    /// # mod example {
    /// dalembert::model!(yaml = r#"
    /// name: Mounted
    /// parameters: {m: 2 kg, c: 3 N*s/m, k: 50 N/m}
    /// coordinates: {x: m}
    /// kinetic_energy: m*x'^2/2
    /// potential_energy: k*x^2/2
    /// dissipation: c*x'^2/2
    /// outputs: {acceleration: "x''"}
    /// "#);
    /// # }
    /// # use example::Mounted;
    /// let system = Dynamic::new(Mounted::default());
    /// let linear = linearise(&system, &equilibrium_near(&system, &Guess::at(&[0.0]))?)?;
    /// let push = NamedDrive { drive: Source::Force(0).into(), name: "push".into(), unit: "N".into() };
    /// let found = linear.input_output(&[push], &observe(&system, &linear, &["acceleration"])?)?;
    /// // The acceleration is the second row of A and B: −k/m, −c/m and 1/m.
    /// for (value, exact) in [(found.a[(1, 0)], -25.0), (found.a[(1, 1)], -1.5), (found.b[(1, 0)], 0.5), (found.d[(0, 0)], 0.5)] {
    ///     assert!((value - exact).abs() < 1e-13);
    /// }
    /// # Ok::<(), dalembert::linear::LinearError>(())
    /// ```
    pub fn input_output(&self, drives: &[NamedDrive], observed: &Observed) -> Result<InputOutput, LinearError> {
        let (n, p) = (self.len(), observed.names.len());
        let factor = cholesky(&self.m()).map_err(|i| self.singular(i))?;
        for NamedDrive { drive, .. } in drives {
            self.check_drive(drive)?;
        }
        let Pushed { inputs, forces, direct } =
            Pushed::by(drives, [&self.input.to_dense(), &self.forces.to_dense()], observed)?;
        let moved = solve_cholesky(&factor, &together(n, &forces));
        let a = self.state_matrix()?;
        let mut b = DMatrix::zeros(2 * n, inputs.len());
        b.rows_mut(n, n).copy_from(&moved);
        let mut c = &observed.acceleration * a.rows(n, n);
        c.columns_mut(0, n).add_assign(&observed.place);
        c.columns_mut(n, n).add_assign(&observed.rate);
        let d = together(p, &direct) + &observed.acceleration * moved;
        let units = self.coordinates.iter().zip(&self.units);
        let states = (0..2).flat_map(|order| units.clone().map(move |(name, unit)| rated(name, unit, order))).collect();
        Ok(InputOutput { states, inputs, outputs: observed.named(), a, b, c, d })
    }

    /// The generalized forces of a drive of size 1, of its rate or of its acceleration.
    #[cfg(feature = "cli")]
    pub(crate) fn pushed_by(&self, drive: &Drive, order: usize) -> DVector<f64> {
        pushed(drive, order, (&self.input.to_dense(), &self.forces.to_dense()))
    }
}

/// What drives do, and their rates where these act.
pub(in crate::linear) struct Pushed {
    /// Names and units.
    pub inputs: Vec<[String; 2]>,
    /// The forces of each.
    pub forces: Vec<DVector<f64>>,
    /// What each adds to the answers by itself.
    pub direct: Vec<DVector<f64>>,
}

impl Pushed {
    /// By the forces of (u, u', u'') of inputs and those of generalized forces.
    ///
    /// # Errors
    /// [`LinearError::OutOfPhase`], [`LinearError::ReactionToForce`].
    pub fn by(
        drives: &[NamedDrive],
        [by_input, by_force]: [&DMatrix<f64>; 2],
        observed: &Observed,
    ) -> Result<Pushed, LinearError> {
        let mut found = Pushed { inputs: Vec::new(), forces: Vec::new(), direct: Vec::new() };
        for NamedDrive { drive, name, unit } in drives {
            if drive.parts.iter().any(|(_, amplitude)| amplitude.im != 0.0) {
                return Err(LinearError::OutOfPhase { drive: name.clone() });
            }
            observed.admits(drive)?;
            for order in 0..3 {
                let force = pushed(drive, order, (by_input, by_force));
                let answer = pushed(drive, order, (&observed.input, &observed.force));
                if order == 0 || force.iter().chain(&answer).any(|x| *x != 0.0) {
                    found.forces.push(force);
                    found.direct.push(answer);
                    found.inputs.push(rated(name, unit, order));
                }
            }
        }
        Ok(found)
    }
}

/// What a drive's value, rate or acceleration does, by a matrix with three columns an input and one with a column a coordinate.
fn pushed(drive: &Drive, order: usize, (input, force): (&DMatrix<f64>, &DMatrix<f64>)) -> DVector<f64> {
    let mut sum = DVector::zeros(input.nrows());
    for (source, amplitude) in &drive.parts {
        match source {
            Source::Input(k) => sum += input.column(3 * k + order) * amplitude.re,
            Source::Force(k) if order == 0 => sum += force.column(*k) * amplitude.re,
            Source::Force(_) => (),
        }
    }
    sum
}

/// Columns as a matrix of so many rows.
pub(in crate::linear) fn together(rows: usize, columns: &[DVector<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns.len(), |i, k| columns[k][i])
}

/// The name and unit of something, or of its first or second rate.
pub(in crate::linear) fn rated(name: &str, unit: &str, order: usize) -> [String; 2] {
    let per = ["", "/s", "/s^2"][order];
    let name = (0..order).fold(name.to_owned(), |name, _| rate_name(&name));
    let unit = match unit {
        "" if order == 0 => String::new(),
        "" => format!("1{per}"),
        _ => format!("{unit}{per}"),
    };
    [name, unit]
}

impl InputOutput {
    /// The motions that the inputs do not reach, however they act (Popov, Belevitch and Hautus: λ with rank [λ − A, B] < s).
    ///
    /// # Errors
    /// [`LinearError::NoConvergence`] of the eigenvalues.
    pub fn uncontrollable(&self) -> Result<Vec<Unreached>, LinearError> {
        self.unreached(&self.a.transpose(), &self.b.transpose())
    }

    /// The motions that the outputs do not show, ever: λ with rank [λ − A; C] < s.
    ///
    /// # Errors
    /// [`LinearError::NoConvergence`] of the eigenvalues.
    pub fn unobservable(&self) -> Result<Vec<Unreached>, LinearError> {
        self.unreached(&self.a, &self.c)
    }

    /// The rank of [B, A B, A² B …]: in how many directions inputs reach the state (Kalman).
    pub fn controllability_rank(&self) -> usize {
        reached(&self.a, &self.b)
    }

    /// The rank of [C; C A; C A² …]: in how many directions outputs show the state.
    pub fn observability_rank(&self) -> usize {
        reached(&self.a.transpose(), &self.c.transpose())
    }

    /// λ at which [λ − A; C] has no full rank.
    fn unreached(&self, a: &DMatrix<f64>, c: &DMatrix<f64>) -> Result<Vec<Unreached>, LinearError> {
        let s = a.nrows();
        let (a, scales) = balanced(a);
        let mut c = c * DMatrix::from_diagonal(&DVector::from_vec(scales));
        let size = a.amax();
        for mut row in c.row_iter_mut() {
            // Units of outputs are anything: each counts as much as A.
            let most = row.amax();
            row.scale_mut(if most > 0.0 { size / most } else { 0.0 });
        }
        let failed = LinearError::NoConvergence { what: "eigenvalues" };
        let eigenvalues = match size > 0.0 {
            true => a.clone().try_schur(f64::EPSILON, 100 * s.max(10)).ok_or(failed.clone())?.complex_eigenvalues(),
            false => DVector::zeros(s),
        };
        let mut found: Vec<Unreached> = Vec::new();
        for eigenvalue in eigenvalues.iter().filter(|value| value.im >= 0.0) {
            if found.iter().any(|known| (known.eigenvalue - eigenvalue).norm() <= SAME * size) {
                continue;
            }
            let both = DMatrix::from_fn(s + c.nrows(), s, |i, j| match i.checked_sub(s) {
                Some(row) => Complex::from(c[(row, j)]),
                None => Complex::from(-a[(i, j)]) + if i == j { *eigenvalue } else { Complex::ZERO },
            });
            let parts = svd(both, false, true).ok_or(failed.clone())?;
            let values = &parts.singular_values;
            let lost: Vec<usize> = (0..s).filter(|k| values[*k] <= UNREACHED * values.max()).collect();
            let (Some(last), Some(right)) = (lost.last(), &parts.v_t) else { continue };
            let direction = right.row(*last);
            let most = (0..s).max_by(|i, k| direction[*i].norm().total_cmp(&direction[*k].norm())).unwrap_or(0);
            found.push(Unreached {
                eigenvalue: *eigenvalue,
                directions: lost.len(),
                state: self.states[most][0].clone(),
            });
        }
        Ok(found)
    }
}
