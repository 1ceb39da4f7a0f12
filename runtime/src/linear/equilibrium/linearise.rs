//! M, C and K at an equilibrium, from generated exact derivatives.

use nalgebra::{Complex, DMatrix};

use super::point::LinearisationPoint;
use super::{Equilibrium, Guess, Jump, equilibrium_here};
use crate::linear::matrices::first_order;
use crate::linear::{LinearError, Residual, SparseMatrix};
use crate::mechanism::dense::{force_slopes, mass_matrix};
use crate::mechanism::{At, Singular, SingularMass, System};
use crate::trust::lock_here;

/// M x'' + C x' + K x = B (u, u', u''), for small departures x from an equilibrium.
///
/// M = ∂F/∂q'', C = ∂F/∂q', K = ∂F/∂q and B = −∂F/∂(u, u', u'') of the equations of motion F = 0: exact
/// derivatives, never differences.  Departures so large that squares of them matter are ignored: a pendulum
/// swinging by θ₀ is slower by the part θ₀²/16 (catalogue L14).
#[derive(Clone, Debug, PartialEq)]
pub struct Linearised {
    /// Names of the coordinates, n of them.
    pub coordinates: Vec<String>,
    /// Their units, SI; empty where the model file has none.
    pub units: Vec<String>,
    /// Names of the inputs.
    pub inputs: Vec<String>,
    /// Where.
    pub equilibrium: Equilibrium,
    /// M, n × n.
    pub mass: SparseMatrix,
    /// C, n × n.
    pub damping: SparseMatrix,
    /// K, n × n.
    pub stiffness: SparseMatrix,
    /// B, n × 3m: a column for each of u, u' and u'' of every input.
    pub input: SparseMatrix,
    /// What generalized forces on the model's coordinates do to these: the identity, but where constraints leave fewer.
    pub forces: SparseMatrix,
}

/// Linearises a mechanism at an equilibrium.
///
/// # Errors
/// [`LinearError::NotAnEquilibrium`] with the residual force of every coordinate;
/// [`LinearError::Discontinuous`] where dry friction holds the state, [`LinearError::NotSmooth`] where a contact just
/// touches; a mass matrix that is not finite.
///
/// # Example
/// ```
/// use dalembert::linear::{Guess, LinearMechanism, equilibrium_near, linearise, normal_modes, Reduction};
/// use nalgebra::DMatrix;
/// let springs = DMatrix::from_row_slice(2, 2, &[2.0, -1.0, -1.0, 2.0]);
/// let two = LinearMechanism::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), springs)?;
/// let rest = equilibrium_near(&two, &Guess::at(&[0.3, 0.0]))?;
/// let modes = normal_modes(&linearise(&two, &rest)?, Reduction::Cholesky)?;
/// assert!((modes[1].omega - 3.0_f64.sqrt()).abs() < 1e-15);
/// # Ok::<(), dalembert::linear::LinearError>(())
/// ```
pub fn linearise<S: System + ?Sized>(system: &S, equilibrium: &Equilibrium) -> Result<Linearised, LinearError> {
    let state = equilibrium.guess();
    // A degenerate equilibrium is known less well than its forces vanish, and a found one is as good as it gets.
    let here = equilibrium_here(system, &state)?;
    linearised_with(system, &LinearisationPoint::new(system, &state), &state, &here.friction)
        .map(|linear| Linearised { equilibrium: equilibrium.clone(), ..linear })
}

/// As [`linearise`], for a state that is known to be an equilibrium of the system of a linearisation point, whose zero stiffness nobody asks for.
pub(in crate::linear) fn linearised_at(
    system: &dyn System,
    base: &LinearisationPoint,
    state: &Guess,
) -> Result<Linearised, LinearError> {
    linearised_with(system, base, state, &base.jumps(&state.q))
}

fn linearised_with<S: System + ?Sized>(
    system: &S,
    base: &LinearisationPoint,
    state: &Guess,
    friction: &[Jump],
) -> Result<Linearised, LinearError> {
    if let Some(Jump { switch, force }) = friction.first().cloned() {
        let jump = base.forces(&force).into_iter().filter(|jump| jump.force != 0.0);
        let jump = jump.map(|jump| Residual { force: jump.force.abs(), ..jump }).collect();
        return Err(LinearError::Discontinuous { point: base.named(&state.q), switch, jump });
    }
    base.without_corner(&state.q)?;
    let at = At::place(0.0, &state.q);
    if let Some(lock) = lock_here(system, at) {
        return Err(LinearError::GimbalLock(lock));
    }
    let [mass, damping, stiffness] = base.cleaned(&state.q);
    for (matrix, what) in [(&mass, "M"), (&damping, "C"), (&stiffness, "K")] {
        if let Some((row, column, _)) = matrix.entries.iter().find(|e| !e.2.is_finite()) {
            let name = |i: &u32| base.names().swap_remove(*i as usize);
            return Err(LinearError::NonFinite { what: format!("{what}[{}, {}]", name(row), name(column)) });
        }
    }
    Ok(Linearised {
        coordinates: base.names(),
        units: base.units(),
        inputs: system.description().inputs.iter().map(ToString::to_string).collect(),
        equilibrium: Equilibrium::at(base, state),
        input: base.input(&state.q),
        forces: SparseMatrix::identity(base.n),
        mass,
        damping,
        stiffness,
    })
}

impl Linearised {
    /// How many coordinates.
    pub fn len(&self) -> usize {
        self.coordinates.len()
    }

    /// True without coordinates.
    pub fn is_empty(&self) -> bool {
        self.coordinates.is_empty()
    }

    /// M, dense.
    pub fn m(&self) -> DMatrix<f64> {
        self.mass.to_dense()
    }

    /// C, dense.
    pub fn c(&self) -> DMatrix<f64> {
        self.damping.to_dense()
    }

    /// K, dense.
    pub fn k(&self) -> DMatrix<f64> {
        self.stiffness.to_dense()
    }

    /// The damping matrix proper, (C + Cᵀ)/2, which dissipates.
    pub fn dissipative(&self) -> SparseMatrix {
        self.damping.split().0
    }

    /// The gyroscopic matrix (C − Cᵀ)/2, which does no work.
    pub fn gyroscopic(&self) -> SparseMatrix {
        self.damping.split().1
    }

    /// (K + Kᵀ)/2, which has a potential.
    pub fn conservative(&self) -> SparseMatrix {
        self.stiffness.split().0
    }

    /// (K − Kᵀ)/2: follower forces and the like, which have no potential.
    pub fn circulatory(&self) -> SparseMatrix {
        self.stiffness.split().1
    }

    /// A of z' = A z for z = (x, x'), 2n × 2n.
    ///
    /// # Errors
    /// [`LinearError::SingularMass`].
    pub fn state_matrix(&self) -> Result<DMatrix<f64>, LinearError> {
        first_order(&self.m(), &self.c(), &self.k()).map_err(|i| self.singular(i))
    }

    pub(in crate::linear) fn singular(&self, index: usize) -> LinearError {
        let name = self.coordinates.get(index).cloned();
        LinearError::SingularMass { coordinate: name.unwrap_or_else(|| format!("coordinate {index}")) }
    }

    /// The dynamic stiffness K + iΩC − Ω²M at a frequency Ω, rad/s.
    pub fn dynamic_stiffness(&self, omega: f64) -> DMatrix<Complex<f64>> {
        let mut z = DMatrix::zeros(self.len(), self.len());
        let parts = [
            (&self.stiffness, Complex::new(1.0, 0.0)),
            (&self.damping, Complex::new(0.0, omega)),
            (&self.mass, Complex::new(-omega * omega, 0.0)),
        ];
        for (matrix, factor) in parts {
            for (row, column, value) in &matrix.entries {
                z[(*row as usize, *column as usize)] += factor * *value;
            }
        }
        z
    }
}

/// A(t) of δz' = A δz along a motion, z = (q, q'): −M⁻¹∂F/∂q and −M⁻¹∂F/∂q' at the state's accelerations.
///
/// # Errors
/// [`Singular`] where the accelerations do not exist.
pub fn state_matrix<S: System + ?Sized>(system: &S, t: f64, q: &[f64], v: &[f64]) -> Result<DMatrix<f64>, Singular> {
    let mut a = vec![0.0; system.len()];
    system.accelerations(At::new(t, q, v), &mut a)?;
    let mass = mass_matrix(system, At::new(t, q, v));
    let [stiffness, damping] = force_slopes(system, At::new(t, q, v).accelerated(&a));
    first_order(&mass, &damping, &stiffness).map_err(|coordinate| SingularMass { coordinate }.into())
}
