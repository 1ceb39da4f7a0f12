//! States that may be rests of mechanisms with states of first order or with held values, and small departures from them.
//!
//! Sought are coordinates q, states z and, where constraints hold, multipliers λ with F(q, v, z, λ) = 0 and c(q) = 0.  A state is kept as the
//! speed of a hidden coordinate, on which nothing depends.  Small departures are those of the coordinates y that constraints and the lengths of
//! rotations leave independent (all q = Z y), with M_y = Zᵀ M Z and so on:
//!
//! x' = A x + B u,  x = (δy, δy', δz),  A = [0 1 0; −M_y⁻¹ K_y  −M_y⁻¹ C_y  −M_y⁻¹ Zᵀ ∂F/∂z; …].

use std::ops::AddAssign;

use nalgebra::{DMatrix, DVector};

use super::Guess;
use super::point::LinearisationPoint;
use crate::linear::constrained::{Held, Inputs};
use crate::linear::forced::slopes_of;
use crate::linear::{LinearError, Observed, SparseMatrix};
use crate::mechanism::{Description, System};

/// A state that may be a rest, or a steady motion of a mechanism whose coordinates are independent.
pub(super) struct Candidate {
    /// The mechanism, with the speeds, states and multipliers of the candidate.
    pub base: LinearisationPoint,
    /// How many coordinates are not hidden.
    pub n: usize,
    pub q: Vec<f64>,
    held: Option<Held>,
}

/// What small departures from a rest obey: x' = A x + B f, x the independent coordinates, their rates, states.
pub(super) struct Departures {
    /// A.
    pub matrix: DMatrix<f64>,
    /// B, a column for each of the forces.
    pub drive: DMatrix<f64>,
    /// The coordinates that are independent, the hidden ones last.
    pub independent: Vec<usize>,
    /// Z: how all coordinates follow these.
    pub motions: DMatrix<f64>,
    /// By how much rounding may have moved the elements of A, where something is eliminated; else each is known to its own digits.
    pub doubt: Option<DMatrix<f64>>,
}

impl Departures {
    /// How many independent coordinates are not hidden: the first of x.
    pub fn places(&self) -> usize {
        self.matrix.nrows() - self.independent.len()
    }
}

impl Candidate {
    /// The guess itself; with constraints the place nearest to it that meets them.
    ///
    /// # Errors
    /// Those of [`linearise_constrained`](crate::linear::linearise_constrained) for constraints that have no rest in independent coordinates.
    pub fn new<S: System + ?Sized>(system: &S, guess: &Guess) -> Result<Candidate, LinearError> {
        let (n, mut q) = (system.description().mechanical(), guess.q.clone());
        q.iter_mut().skip(n).for_each(|hidden| *hidden = 0.0);
        let mut base = LinearisationPoint::new(system, guess);
        let held = Held::at(&mut base, &mut q)?;
        Ok(Candidate { base, n, q, held })
    }

    /// Refuses equations that change with time though inputs are held, speeds that cannot last, and numbers that are not finite.
    pub fn check(&self) -> Result<(), LinearError> {
        match &self.held {
            None => self.base.check(&self.q),
            Some(held) => held.check(&self.base, &self.q),
        }
    }

    /// Refuses constraints in whose independent coordinates nothing is known of small departures at this place, which must be a rest.
    pub fn check_rest(&self) -> Result<(), LinearError> {
        self.held.as_ref().map_or(Ok(()), |held| held.check_rest(&self.base, &self.q))
    }

    /// Coordinates, states, multipliers of the rows in force.
    pub fn unknowns(&self) -> Vec<f64> {
        let multipliers = self.held.iter().flat_map(|held| held.multipliers(&self.base));
        self.q[..self.n].iter().chain(&self.base.v[self.n..]).copied().chain(multipliers).collect()
    }

    /// The units of the coordinates that are not hidden.
    pub fn units(&self) -> Vec<String> {
        let mut units = self.base.units();
        units.truncate(self.n);
        units
    }

    /// The rows in force.
    pub fn rows(&self) -> &[usize] {
        self.held.as_ref().map_or(&[], |held| &held.rows)
    }

    /// How many unknowns there are.
    pub fn len(&self) -> usize {
        self.base.n + self.rows().len()
    }

    /// The present values, inputs being held at these.
    pub fn guess(&self, inputs: &[f64]) -> Guess {
        Guess { q: self.q.clone(), v: self.base.v.clone(), inputs: inputs.to_vec() }
    }

    /// Goes to other values of the unknowns.
    pub fn set(&mut self, unknowns: &[f64]) {
        let all = self.base.n;
        self.q[..self.n].copy_from_slice(&unknowns[..self.n]);
        self.base.v[self.n..].copy_from_slice(&unknowns[self.n..all]);
        if let Some(held) = &self.held {
            held.set_multipliers(&mut self.base, &unknowns[all..]);
            held.keep_lengths(&self.base, &mut self.q);
        }
    }

    /// F, then c.
    pub fn left(&self) -> Vec<f64> {
        let mut left = self.base.force(&self.q);
        left.extend(self.held.iter().flat_map(|held| held.missed(&self.base, &self.q)));
        left
    }

    /// The sizes of their terms.
    pub fn measures(&self) -> Vec<f64> {
        match &self.held {
            None => self.base.measure(&self.q),
            Some(held) => held.measures(&self.base, &self.q),
        }
    }

    /// The slopes of [`Candidate::left`] by [`Candidate::unknowns`].
    pub fn slopes(&self) -> DMatrix<f64> {
        let (n, all) = (self.n, self.base.n);
        let [_, damping, stiffness] = self.base.matrices(&self.q);
        let mut slopes = stiffness.to_dense();
        slopes.columns_mut(n, all - n).copy_from(&damping.to_dense().columns(n, all - n));
        match &self.held {
            None => slopes,
            Some(held) => held.bordered(&self.base, &self.q, slopes),
        }
    }

    /// What small departures obey, and forces on all coordinates beside them.
    ///
    /// # Errors
    /// Numbers that are not finite; a mass matrix that has no inverse; [`LinearError::DependentHere`].
    pub fn departures(&self, forces: &[DVector<f64>]) -> Result<Departures, LinearError> {
        let Some(held) = &self.held else {
            let all = self.base.n;
            let (matrix, drive) = first_order(self.base.cleaned(&self.q), self.n, forces)?;
            return Ok(Departures {
                matrix,
                drive,
                independent: (0..all).collect(),
                motions: DMatrix::identity(all, all),
                doubt: None,
            });
        };
        let whole = held.whole(&self.base, &self.q)?;
        let to_independent = whole.motions.transpose();
        let forces: Vec<DVector<f64>> = forces.iter().map(|force| &to_independent * force).collect();
        let places = whole.independent.iter().filter(|i| **i < self.n).count();
        let matrices = whole.matrices();
        let mass = matrices[0].to_dense();
        let (matrix, drive) = first_order(matrices, places, &forces)?;
        let doubt = Some(doubt(&mass, &whole.doubts(), &matrix));
        Ok(Departures { matrix, drive, independent: whole.independent, motions: whole.motions, doubt })
    }

    /// What inputs do.
    ///
    /// # Errors
    /// [`LinearError::DependentHere`].
    pub fn inputs(&self) -> Result<Inputs, LinearError> {
        match &self.held {
            None => {
                let forces = self.base.input(&self.q).to_dense();
                Ok(Inputs { moving: (0..forces.ncols() / 3).collect(), forces, immovable: Vec::new() })
            }
            Some(held) => held.inputs(&self.base, &self.q),
        }
    }

    /// Answers by independent coordinates, their rates and accelerations (those of hidden ones among them), and by (u, u', u'') of the inputs that
    /// move.
    ///
    /// # Errors
    /// As [`observe`](crate::linear::observe).
    pub fn observe(&self, description: &Description, names: &[&str]) -> Result<Observed, LinearError> {
        match &self.held {
            None => {
                let rows = vec![0.0; description.rows.len()];
                slopes_of(description, &self.base, &self.q, &rows, names).map(|(seen, _)| seen)
            }
            Some(held) => held.observe(description, &self.base, &self.q, names),
        }
    }

    /// As [`Held::answering`]; a matrix without rows where nothing is held.
    pub fn answering(&self, by_multipliers: &DMatrix<f64>) -> Result<DMatrix<f64>, Option<usize>> {
        match &self.held {
            None => Ok(DMatrix::zeros(0, self.base.n)),
            Some(held) => held.answering(&self.base, &self.q, by_multipliers),
        }
    }

    /// The reactions of the rows in force.
    pub fn reactions(&self) -> Vec<(String, f64)> {
        self.held.as_ref().map_or_else(Vec::new, |held| held.reactions(&self.base, &self.q))
    }
}

/// A of x' = A x about a rest with these M, C and K, of which the first so many coordinates are not hidden, and a column of B for each of some
/// forces.
fn first_order(
    [mass, damping, stiffness]: [SparseMatrix; 3],
    n: usize,
    forces: &[DVector<f64>],
) -> Result<(DMatrix<f64>, DMatrix<f64>), LinearError> {
    let all = mass.rows;
    let mut right = DMatrix::zeros(all, 2 * all + forces.len());
    right.columns_mut(0, all).copy_from(&-stiffness.to_dense());
    right.columns_mut(all, all).copy_from(&-damping.to_dense());
    forces.iter().enumerate().for_each(|(k, column)| right.column_mut(2 * all + k).copy_from(column));
    if right.iter().any(|x| !x.is_finite()) {
        return Err(LinearError::NonFinite { what: "the linear model".to_owned() });
    }
    // What constraints hold altogether moves by nothing.
    let solved = if all == 0 { Some(right) } else { mass.to_dense().lu().solve(&right) };
    let solved = solved.filter(|x| x.iter().all(|x| x.is_finite()));
    let solved = solved.ok_or(LinearError::NoConvergence { what: "the accelerations' derivatives" })?;
    // Of [q; v] all but what is hidden of q.
    let kept: Vec<usize> = (0..n).chain(all..2 * all).collect();
    let mut matrix = DMatrix::zeros(kept.len(), kept.len());
    matrix.view_mut((0, n), (n, n)).fill_with_identity();
    for (column, k) in kept.iter().enumerate() {
        matrix.view_mut((n, column), (all, 1)).copy_from(&solved.column(*k));
    }
    let mut drive = DMatrix::zeros(kept.len(), forces.len());
    drive.view_mut((n, 0), (all, forces.len())).copy_from(&solved.columns(2 * all, forces.len()));
    Ok((matrix, drive))
}

/// By how much A may be off, by M, what M, C and K may be off by, and A itself, X = −M⁻¹ [K C] in it: |M⁻¹| (δ[K C] + δM |X|).
fn doubt(
    mass: &DMatrix<f64>,
    [of_mass, of_damping, of_stiffness]: &[DMatrix<f64>; 3],
    a: &DMatrix<f64>,
) -> DMatrix<f64> {
    let (size, all) = (a.nrows(), mass.nrows());
    let n = size - all;
    let mut doubt = DMatrix::zeros(size, size);
    let Some(inverse) = mass.clone().try_inverse() else { return doubt };
    let mut own = of_mass * a.rows(n, all).abs();
    own.columns_mut(0, n).add_assign(&of_stiffness.columns(0, n));
    own.columns_mut(n, all).add_assign(of_damping);
    doubt.rows_mut(n, all).copy_from(&(inverse.abs() * own));
    doubt
}
