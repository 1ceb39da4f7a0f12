//! Small motions of mechanisms with holonomic constraints, in coordinates that the constraints leave independent.
//!
//! At rest F(q, 0, 0, λ) = 0 and c(q) = 0.  With Z a basis of the motions that the constraints allow, J Z = 0,
//! M_z = Zᵀ M Z, C_z = Zᵀ (∂F/∂q') Z and K_z = Zᵀ (∂F/∂q) Z at these λ, so that Σ λ_k ∇²c_k, the geometric stiffness of the
//! constraints, is in it.

use nalgebra::{Complex, DMatrix, DVector};

use super::{on_its_sides, sizes_alike};
use crate::constrain::{Projection, Start, consistent};
use crate::linear::{Equilibrium, Freedom, Guess, LinearError, Linearised, Mode, Residual, SparseMatrix};
use crate::mechanism::{At, Solutions, System};

/// M, C and K of a constrained mechanism in independent coordinates, and how all others follow.
#[derive(Clone, Debug, PartialEq)]
pub struct Constrained {
    /// The model in independent coordinates.
    pub linear: Linearised,
    /// Names of all coordinates.
    pub coordinates: Vec<String>,
    /// Z: how all coordinates follow the independent ones.
    pub motions: DMatrix<f64>,
    /// The multipliers at rest, of the rows that are active.
    pub multipliers: Vec<f64>,
}

/// Forces left at rest count as zero below this part of their own terms.
const BALANCED: f64 = 1e-9;
/// So many roundings of the place are nothing.
const ROUNDINGS: f64 = 16.0;
/// Newton's method gives up after so many iterations.
const ITERATIONS: usize = 200;
/// Nothing rests further away.
const FAR: f64 = 1e30;
/// A fall ends after so many steps, or when the square of the acceleration is this part of the first.
const FALLS: usize = 400;
const STILL: f64 = 1e-8;
/// Rows of J below this part of the largest depend on others.
const DEPENDENT: f64 = 1e-9;

/// Linearises a mechanism with holonomic constraints at an equilibrium near a guess, or at the guess itself where `here` is
/// set.
///
/// # Errors
/// [`LinearError::NoEquilibrium`], [`LinearError::NotAnEquilibrium`]; [`LinearError::VelocityConstraint`]: a constraint
/// that contains speeds leaves no M, C and K in independent coordinates; [`LinearError::FrictionOfReactions`]: nor do forces
/// made of reactions; numbers that are not finite.
pub fn linearise_constrained<S: System + ?Sized>(
    system: &S,
    guess: &Guess,
    here: bool,
) -> Result<Constrained, LinearError> {
    let rows: Vec<usize> = system.active_rows().iter().map(|row| *row as usize).collect();
    let description = system.description();
    if !description.friction_pattern.is_empty() {
        return Err(LinearError::FrictionOfReactions);
    }
    if let Some(row) = rows.iter().map(|row| &description.rows[*row]).find(|row| !row.holonomic) {
        return Err(LinearError::VelocityConstraint { constraint: row.name.to_string() });
    }
    on_its_sides(system, guess, |system, guess| {
        let rest = Rest { system, n: system.len(), rows: rows.clone() };
        let q = if here { guess.q.clone() } else { rest.search(&guess.q)? };
        rest.linearised(&q).map(|found| (found, Guess::at(&q)))
    })
}

impl Constrained {
    /// Shapes of modes in all coordinates of the file.
    pub fn in_all_coordinates(&self, modes: &[Mode]) -> Vec<Mode> {
        let whole = |mode: &Mode| {
            let shape = (0..self.motions.nrows())
                .map(|i| (0..mode.shape.len()).map(|k| mode.shape[k] * self.motions[(i, k)]).sum::<Complex<f64>>());
            Mode { shape: shape.collect(), ..mode.clone() }
        };
        modes.iter().map(whole).collect()
    }
}

struct Rest<'a, S: System + ?Sized> {
    system: &'a S,
    n: usize,
    rows: Vec<usize>,
}

/// Forces and matrices at rest, without multipliers' forces in `force`.
struct Here {
    force: DVector<f64>,
    jacobian: DMatrix<f64>,
    values: DVector<f64>,
}

impl<S: System + ?Sized> Rest<'_, S> {
    fn here(&self, q: &[f64]) -> Here {
        let (n, zero) = (self.n, vec![0.0; self.n]);
        let at = At::new(0.0, q, &zero).accelerated(&zero);
        let mut force = DVector::zeros(n);
        self.system.residual(at, force.as_mut_slice());
        let pattern = &self.system.description().constraint_pattern;
        let mut values = vec![0.0; pattern.len()];
        self.system.constraint_matrix(at, &mut values);
        let mut jacobian = DMatrix::zeros(self.rows.len(), n);
        for ((row, column), value) in pattern.iter().zip(values) {
            if let Some(k) = self.rows.iter().position(|r| *r == *row as usize) {
                jacobian[(k, *column as usize)] = value;
            }
        }
        let mut triples = vec![0.0; 3 * self.system.description().rows.len()];
        self.system.constraints(at, &mut triples);
        let values = DVector::from_iterator(self.rows.len(), self.rows.iter().map(|row| triples[3 * row]));
        Here { force, jacobian, values }
    }

    /// λ that leaves the least of the forces.
    fn multipliers(&self, here: &Here) -> DVector<f64> {
        let transposed = here.jacobian.transpose();
        let threshold = DEPENDENT * transposed.norm();
        transposed.svd(true, true).solve(&here.force, threshold).unwrap_or_else(|_| DVector::zeros(self.rows.len()))
    }

    fn all_multipliers(&self, lambda: &DVector<f64>) -> Vec<f64> {
        let mut all = vec![0.0; self.system.description().rows.len()];
        self.rows.iter().zip(lambda.iter()).for_each(|(row, x)| all[*row] = *x);
        all
    }

    /// ∂F/∂q and ∂F/∂q' with these multipliers.
    fn slopes(&self, q: &[f64], lambda: &DVector<f64>) -> [DMatrix<f64>; 2] {
        let (n, zero, lambda) = (self.n, vec![0.0; self.n], self.all_multipliers(lambda));
        let at = At::new(0.0, q, &zero).accelerated(&zero).constrained(&lambda);
        let description = self.system.description();
        let patterns = [&description.stiffness_pattern, &description.damping_pattern];
        let [mut dq, mut dv] = patterns.map(|pattern| vec![0.0; pattern.len()]);
        self.system.jacobians(at, &mut dq, &mut dv);
        let mut slopes = [DMatrix::zeros(n, n), DMatrix::zeros(n, n)];
        for ((matrix, pattern), values) in slopes.iter_mut().zip(patterns).zip([dq, dv]) {
            for ((i, j), value) in pattern.iter().zip(values) {
                matrix[(*i as usize, *j as usize)] = value;
            }
        }
        slopes
    }

    fn magnitudes(&self, q: &[f64], lambda: &DVector<f64>) -> Vec<f64> {
        let (zero, lambda) = (vec![0.0; self.n], self.all_multipliers(lambda));
        let mut sums = vec![0.0; self.n];
        self.system.magnitudes(At::new(0.0, q, &zero).accelerated(&zero).constrained(&lambda), &mut sums);
        sums
    }

    /// From the place nearest to the guess that meets the constraints; where that leads nowhere, from where the motion
    /// would go from there.
    fn search(&self, guess: &[f64]) -> Result<Vec<f64>, LinearError> {
        let start = [guess, &vec![0.0; self.n]].concat();
        let held = vec![false; 2 * self.n];
        let closed = consistent(self.system, &Start { t: 0.0, y: &start, held: &held, also: 0..0 });
        let q = closed.map(|y| y[..self.n].to_vec()).map_err(|_| self.nowhere(guess, 0))?;
        self.newton(&q).or_else(|nowhere| self.newton(&self.fallen(q).ok_or(nowhere)?))
    }

    /// Follows the accelerations from rest, without speeds, until little is left of them: down the potential in the metric
    /// of M.
    fn fallen(&self, q: Vec<f64>) -> Option<Vec<f64>> {
        let n = self.n;
        let mut projection = Projection::new(self.system)?;
        let acceleration = |q: &[f64]| {
            let (zero, mut lambda) = (vec![0.0; n], vec![0.0; self.system.description().rows.len()]);
            let mut a = DVector::zeros(n);
            let solved = self.system.motion(At::new(0.0, q, &zero), a.as_mut_slice(), &mut lambda);
            solved.is_ok().then_some(a).filter(|a| a.iter().all(|x| x.is_finite()))
        };
        let mut y = [q, vec![0.0; n]].concat();
        let mut a = acceleration(&y[..n])?;
        let first = (a.transpose() * self.mass(&y[..n]) * &a)[0];
        let size = a.iter().zip(&y).fold(0.0_f64, |most, (a, q)| most.max(a.abs() / (1.0 + q.abs())));
        let mut h = 0.1 / size.max(f64::MIN_POSITIVE);
        for _ in 0..FALLS {
            let mut tried = y.clone();
            tried.iter_mut().zip(a.iter()).for_each(|(q, a)| *q += h * a);
            projection.project(self.system, 0.0, &mut tried).ok()?;
            let (mass, there) = (self.mass(&tried[..n]), acceleration(&tried[..n])?);
            // Past the lowest point it would be drawn back.
            if (a.transpose() * &mass * &there)[0] < 0.0 {
                h *= 0.5;
                continue;
            }
            (y, a, h) = (tried, there, 1.5 * h);
            if (a.transpose() * mass * &a)[0] <= STILL * first {
                break;
            }
        }
        y.truncate(n);
        Some(y)
    }

    /// Newton's method on F − Jᵀλ = 0, c = 0, halved until both decrease.
    fn newton(&self, from: &[f64]) -> Result<Vec<f64>, LinearError> {
        let (n, m) = (self.n, self.rows.len());
        let mut q = from.to_vec();
        let mut lambda = self.multipliers(&self.here(&q));
        for iteration in 0..ITERATIONS {
            let here = self.here(&q);
            let left = &here.force - here.jacobian.transpose() * &lambda;
            let [stiffness, _] = self.slopes(&q, &lambda);
            let mut k = DMatrix::zeros(n + m, n + m);
            k.view_mut((0, 0), (n, n)).copy_from(&stiffness);
            k.view_mut((0, n), (n, m)).copy_from(&(-here.jacobian.transpose()));
            k.view_mut((n, 0), (m, n)).copy_from(&here.jacobian);
            let right = DVector::from_iterator(n + m, left.iter().chain(here.values.iter()).map(|x| -x));
            let lost = q.iter().any(|q| q.abs() > FAR);
            if lost || k.iter().chain(right.iter()).any(|x| !x.is_finite()) {
                return Err(self.nowhere(&q, iteration));
            }
            let threshold = 1e-13 * k.norm();
            let Ok(step) = k.svd(true, true).solve(&right, threshold) else { return Err(self.nowhere(&q, iteration)) };
            let size = right.norm();
            let mut part = 1.0;
            let mut next = (q.clone(), lambda.clone());
            let mut after = f64::INFINITY;
            while part > 1e-6 {
                next.0 = q.iter().zip(step.iter()).map(|(q, s)| q + part * s).collect();
                next.1 = &lambda + part * step.rows(n, m);
                let there = self.here(&next.0);
                let left = &there.force - there.jacobian.transpose() * &next.1;
                after = (left.norm_squared() + there.values.norm_squared()).sqrt();
                if after < size {
                    break;
                }
                part *= 0.5;
            }
            if after.is_nan() || after >= size {
                // As good as rounding lets it be, or nowhere.
                return if self.is_balanced(&q, &lambda) { Ok(q) } else { Err(self.nowhere(&q, iteration)) };
            }
            (q, lambda) = next;
        }
        if self.is_balanced(&q, &lambda) { Ok(q) } else { Err(self.nowhere(&q, ITERATIONS)) }
    }

    fn is_balanced(&self, q: &[f64], lambda: &DVector<f64>) -> bool {
        let here = self.here(q);
        let left = &here.force - here.jacobian.transpose() * lambda;
        let closed = here.values.iter().all(|c| c.abs() <= BALANCED);
        // Rounding of the place and of multipliers counts too: the terms of a weight's moment vanish with it.
        let [stiffness, _] = self.slopes(q, lambda);
        let (carried, sizes) = (lambda.amax(), sizes_alike(self.system.description(), q));
        let place = |i: usize| {
            let by_place = stiffness.row(i).iter().zip(&sizes).map(|(k, size)| k.abs() * size).sum::<f64>();
            (by_place + carried * here.jacobian.column(i).lp_norm(1)) * f64::EPSILON
        };
        let mut rows = left.iter().zip(self.magnitudes(q, lambda)).enumerate();
        closed && rows.all(|(i, (f, sum))| f.abs() <= (BALANCED * sum).max(ROUNDINGS * place(i)))
    }

    fn linearised(&self, q: &[f64]) -> Result<Constrained, LinearError> {
        let here = self.here(q);
        let lambda = self.multipliers(&here);
        let left = &here.force - here.jacobian.transpose() * &lambda;
        if !self.is_balanced(q, &lambda) {
            return Err(LinearError::NotAnEquilibrium { residual: self.residual(left.as_slice()) });
        }
        let [stiffness, damping] = self.slopes(q, &lambda);
        let Solutions { basis: z, independent: chosen, .. } = Solutions::of(&here.jacobian, &[]);
        let mass = self.mass(q);
        let description = self.system.description();
        let names: Vec<String> = description.coordinates.iter().map(|c| c.name.to_string()).collect();
        let reduced = |matrix: &DMatrix<f64>| SparseMatrix::from_dense(&(z.transpose() * matrix * &z));
        let linear = Linearised {
            coordinates: chosen.iter().map(|i| names[*i].clone()).collect(),
            units: chosen.iter().map(|i| description.coordinates[*i].unit.to_string()).collect(),
            inputs: Vec::new(),
            equilibrium: Equilibrium {
                coordinates: names.clone(),
                q: q.to_vec(),
                v: vec![0.0; self.n],
                inputs: Vec::new(),
                friction: Vec::new(),
                residual: left.iter().copied().collect(),
                iterations: 0,
                slow: None,
                freedom: Freedom::default(),
            },
            mass: reduced(&mass),
            damping: reduced(&damping),
            stiffness: reduced(&stiffness),
            input: SparseMatrix::new(z.ncols(), 0, &[], &[]),
        };
        Ok(Constrained { linear, coordinates: names, motions: z, multipliers: lambda.iter().copied().collect() })
    }

    fn mass(&self, q: &[f64]) -> DMatrix<f64> {
        let pattern = &self.system.description().mass_pattern;
        let mut values = vec![0.0; pattern.len()];
        self.system.mass_matrix(At::place(0.0, q), &mut values);
        SparseMatrix::symmetric(self.n, pattern, &values).to_dense()
    }

    fn residual(&self, left: &[f64]) -> Vec<Residual> {
        let coordinates = self.system.description().coordinates.iter().zip(left);
        coordinates
            .map(|(c, force)| Residual { coordinate: c.name.to_string(), force: *force, unit: String::new() })
            .collect()
    }

    fn nowhere(&self, q: &[f64], iterations: usize) -> LinearError {
        let here = self.here(q);
        let lambda = self.multipliers(&here);
        let left = &here.force - here.jacobian.transpose() * lambda;
        let names = self.system.description().coordinates.iter().map(|c| c.name.to_string());
        LinearError::NoEquilibrium {
            iterations,
            point: names.zip(q.iter().copied()).collect(),
            residual: self.residual(left.as_slice()),
        }
    }
}
