//! Forced response: steady states, resonance, steps, impulses and any input.

use nalgebra::{Complex, DMatrix, DVector};

use super::{Motion, Source};
use crate::linear::matrices::cholesky;
use crate::linear::modes::Spectrum;
use crate::linear::{LinearError, Linearised, Reduction, expm, short};
use crate::matrix::svd;

/// A force F(t) = cos(Ωt) `cosine` + sin(Ωt) `sine`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Harmonic {
    /// Ω, rad/s.
    pub omega: f64,
    /// Generalized forces that go with cos Ωt.
    pub cosine: Vec<f64>,
    /// Generalized forces that go with sin Ωt.
    pub sine: Vec<f64>,
}

/// A force reaches a mode with this part of itself at the least.
pub(super) const REACHED: f64 = 1e-12;

impl Linearised {
    /// The steady state X of M x'' + C x' + K x = Re(F e^(iΩt)), x = Re(X e^(iΩt)), by solving
    /// (K + iΩC − Ω²M) X = F.
    ///
    /// # Errors
    /// [`LinearError::Resonance`] where the matrix is singular to rounding; a wrong size.
    pub fn steady_state(&self, force: &[Complex<f64>], omega: f64) -> Result<Vec<Complex<f64>>, LinearError> {
        self.expect("the force", force.len(), self.len())?;
        if self.is_empty() {
            return Ok(Vec::new());
        }
        let (n, terms) = (self.len(), self.terms(omega));
        if terms.iter().any(|size| !size.is_finite()) {
            return Err(LinearError::NonFinite { what: format!("the dynamic stiffness at {} rad/s", short(omega)) });
        }
        // What is soft counts beside its own terms, not beside what is stiff; powers of two round nothing.
        let unit = |i: usize| {
            let size = if terms[(i, i)] > 0.0 { terms[(i, i)] } else { terms.row(i).amax() };
            if size > 0.0 { (-0.5 * size.log2()).round().exp2() } else { 1.0 }
        };
        let units: Vec<f64> = (0..n).map(unit).collect();
        let stiffness = self.dynamic_stiffness(omega);
        let lu = DMatrix::from_fn(n, n, |i, j| stiffness[(i, j)] * units[i] * units[j]).lu();
        let scale = DMatrix::from_fn(n, n, |i, j| terms[(i, j)] * units[i] * units[j]).amax();
        let floor = 16.0 * n as f64 * f64::EPSILON * scale;
        let resonance = LinearError::Resonance { omega };
        let pivots = lu.u().diagonal().map(|pivot| pivot.norm());
        let right = DVector::from_fn(n, |i, _| force[i] * units[i]);
        let solution = match pivots.iter().any(|pivot| *pivot <= floor) {
            false => lu.solve(&right).ok_or(resonance)?,
            true => self.beside_modes(&units, (&stiffness, &right), floor).ok_or(resonance)?,
        };
        Ok(solution.iter().zip(&units).map(|(x, unit)| x * *unit).collect())
    }

    /// Where Ω meets undamped modes that the force does not reach: what it reaches, without these modes in the measure of M; `None` where it
    /// reaches one.  Coordinates are in these units.
    fn beside_modes(
        &self,
        units: &[f64],
        (stiffness, force): (&DMatrix<Complex<f64>>, &DVector<Complex<f64>>),
        floor: f64,
    ) -> Option<DVector<Complex<f64>>> {
        let n = self.len();
        let scaled = DMatrix::from_fn(n, n, |i, j| stiffness[(i, j)] * units[i] * units[j]);
        let svd = svd(scaled, true, true)?;
        let (u, v) = (svd.u.as_ref()?, svd.v_t.as_ref()?);
        let floor = floor.max(f64::EPSILON * svd.singular_values.max());
        let mut found = DVector::zeros(n);
        for k in (0..n).filter(|k| svd.singular_values[*k] > floor) {
            let part = u.column(k).dotc(force) / svd.singular_values[k];
            found += v.row(k).adjoint() * part;
        }
        let mass = DMatrix::from_fn(n, n, |i, j| Complex::from(self.m()[(i, j)] * units[i] * units[j]));
        for k in (0..n).filter(|k| svd.singular_values[*k] <= floor) {
            if u.column(k).dotc(force).norm() > REACHED * force.norm() {
                return None;
            }
            let shape = v.row(k).adjoint();
            let own = shape.dotc(&(&mass * &found)) / shape.dotc(&(&mass * &shape));
            found -= shape * own;
        }
        Some(found)
    }

    /// The steady state as a sum over normal modes, X = Σ φᵢ φᵢᵀF/(ωᵢ² − Ω² + iΩ φᵢᵀCφᵢ).
    ///
    /// What C has off the diagonal in normal coordinates is ignored: see
    /// [`Linearised::diagonal_damping`] for the error; without damping, and with proportional damping, the sum is
    /// exact.
    ///
    /// # Errors
    /// [`LinearError::Resonance`] where an undamped mode that the force reaches has the frequency Ω; as
    /// [`normal_modes`](crate::linear::normal_modes).
    pub fn steady_state_by_modes(&self, force: &[Complex<f64>], omega: f64) -> Result<Vec<Complex<f64>>, LinearError> {
        self.expect("the force", force.len(), self.len())?;
        let spectrum = Spectrum::new(&self.mass, &self.conservative(), Reduction::Cholesky);
        let spectrum = spectrum.map_err(|fault| fault.named(self))?;
        let (c, n) = (self.c(), self.len());
        let most = force.iter().fold(0.0_f64, |most, f| most.max(f.norm()));
        let mut sum = vec![Complex::new(0.0, 0.0); n];
        for (k, square) in spectrum.squares.iter().enumerate() {
            let shape = spectrum.shapes.column(k);
            let modal: Complex<f64> = shape.iter().zip(force).map(|(x, f)| f * *x).sum();
            let damping = shape.dot(&(&c * shape));
            let stiffness = Complex::new(square - omega * omega, omega * damping);
            let size = square.abs().max(omega * omega);
            if stiffness.norm() <= 16.0 * n as f64 * f64::EPSILON * size {
                if modal.norm() > REACHED * most * shape.amax() {
                    return Err(LinearError::Resonance { omega });
                }
                continue;
            }
            for (x, part) in sum.iter_mut().zip(shape.iter()) {
                *x += modal / stiffness * *part;
            }
        }
        Ok(sum)
    }

    /// The complex amplitude of every coordinate for an input u = Re(e^(iΩt)), its derivatives acting too: the
    /// transmissibility, where the input is a motion of the base.
    ///
    /// # Errors
    /// As [`Linearised::steady_state`]; [`LinearError::WrongSize`] for an input that does not exist.
    pub fn response_to_input(&self, input: usize, omega: f64) -> Result<Vec<Complex<f64>>, LinearError> {
        let force = self.driving_force(&Source::Input(input).into(), omega)?;
        self.steady_state(&force, omega)
    }

    /// The motion from x₀ and v₀ under a harmonic force, exactly, resonance included.
    ///
    /// cos Ωt and sin Ωt join the state: z' = A z + b cos Ωt + c sin Ωt becomes a system without forces, solved by
    /// the matrix exponential.  Where Ω meets an undamped frequency the secular term t sin Ωt comes out of it.
    ///
    /// # Errors
    /// [`LinearError::SingularMass`] and wrong sizes.
    pub fn harmonic_motion(
        &self,
        x0: &[f64],
        v0: &[f64],
        force: &Harmonic,
        times: &[f64],
    ) -> Result<Motion, LinearError> {
        let clock = DMatrix::from_row_slice(2, 2, &[0.0, -force.omega, force.omega, 0.0]);
        self.augmented_motion(x0, v0, &[&force.cosine, &force.sine], &clock, &[1.0, 0.0], times)
    }

    /// The motion from x₀ and v₀ under a constant force that sets in at t = 0.
    ///
    /// # Errors
    /// [`LinearError::SingularMass`] and wrong sizes.
    pub fn step_motion(&self, x0: &[f64], v0: &[f64], force: &[f64], times: &[f64]) -> Result<Motion, LinearError> {
        self.augmented_motion(x0, v0, &[force], &DMatrix::zeros(1, 1), &[1.0], times)
    }

    /// The motion from rest after an impulse at t = 0 (N·s, or N·m·s): v₀ = M⁻¹ p.
    ///
    /// # Errors
    /// [`LinearError::SingularMass`] and wrong sizes.
    pub fn impulse_motion(&self, impulse: &[f64], times: &[f64]) -> Result<Motion, LinearError> {
        self.expect("the impulse", impulse.len(), self.len())?;
        let factor = cholesky(&self.m()).map_err(|index| self.singular(index))?;
        let mut speed = DVector::from_column_slice(impulse);
        factor.solve_lower_triangular_mut(&mut speed);
        factor.tr_solve_lower_triangular_mut(&mut speed);
        self.free_motion(&vec![0.0; self.len()], speed.as_slice(), times)
    }

    /// The motion from x₀ and v₀ under any force, given at equally spaced times 0, h, 2h …, linear in between.
    ///
    /// Exact for such a force, whatever h; the result has a row for each of these times.  Replacing a smooth force by
    /// straight pieces costs h² times its curvature.
    ///
    /// # Errors
    /// [`LinearError::SingularMass`] and wrong sizes.
    pub fn forced_motion(&self, x0: &[f64], v0: &[f64], forces: &[Vec<f64>], h: f64) -> Result<Motion, LinearError> {
        let n = self.len();
        let mut state = self.start(x0, v0)?;
        let one = DMatrix::identity(n, n);
        let unit: Vec<Vec<f64>> = one.column_iter().map(|c| c.iter().copied().collect()).collect();
        let columns: Vec<&[f64]> = unit.iter().map(Vec::as_slice).collect();
        let input = self.accelerated_by(&columns)?;
        // z' = A z + B (f₀ + (f₁ − f₀) t/h): f₀ and the slope join the state.
        let mut a = DMatrix::zeros(4 * n, 4 * n);
        a.view_mut((0, 0), (2 * n, 2 * n)).copy_from(&self.state_matrix()?);
        a.view_mut((0, 2 * n), (2 * n, n)).copy_from(&input);
        a.view_mut((2 * n, 3 * n), (n, n)).copy_from(&(one / h));
        let step = expm(&(a * h));
        let mut motion = Motion { x: DMatrix::zeros(forces.len(), n), v: DMatrix::zeros(forces.len(), n) };
        for (row, force) in forces.iter().enumerate() {
            self.expect("the force", force.len(), n)?;
            motion.set(row, &state);
            let Some(next) = forces.get(row + 1) else { break };
            self.expect("the force", next.len(), n)?;
            let rise = next.iter().zip(force).map(|(b, a)| b - a);
            let whole = state.iter().copied().chain(force.iter().copied()).chain(rise);
            let after = &step * DVector::from_iterator(4 * n, whole);
            state = after.rows(0, 2 * n).into_owned();
        }
        Ok(motion)
    }

    /// z' = A z + B w with w' = `clock` w, by the exponential of the whole.
    fn augmented_motion(
        &self,
        x0: &[f64],
        v0: &[f64],
        columns: &[&[f64]],
        clock: &DMatrix<f64>,
        w0: &[f64],
        times: &[f64],
    ) -> Result<Motion, LinearError> {
        let (n, m) = (self.len(), w0.len());
        let start = self.start(x0, v0)?;
        let mut a = DMatrix::zeros(2 * n + m, 2 * n + m);
        a.view_mut((0, 0), (2 * n, 2 * n)).copy_from(&self.state_matrix()?);
        a.view_mut((0, 2 * n), (2 * n, m)).copy_from(&self.accelerated_by(columns)?);
        a.view_mut((2 * n, 2 * n), (m, m)).copy_from(clock);
        let whole = DVector::from_iterator(2 * n + m, start.iter().chain(w0).copied());
        let mut motion = Motion { x: DMatrix::zeros(times.len(), n), v: DMatrix::zeros(times.len(), n) };
        for (row, t) in times.iter().enumerate() {
            motion.set(row, &(expm(&(&a * *t)) * &whole));
        }
        Ok(motion)
    }

    /// (0, M⁻¹ f) for each force, as columns.
    fn accelerated_by(&self, columns: &[&[f64]]) -> Result<DMatrix<f64>, LinearError> {
        let n = self.len();
        let factor = cholesky(&self.m()).map_err(|index| self.singular(index))?;
        let mut input = DMatrix::zeros(2 * n, columns.len());
        for (k, force) in columns.iter().enumerate() {
            self.expect("the force", force.len(), n)?;
            let mut column = DVector::from_column_slice(force);
            factor.solve_lower_triangular_mut(&mut column);
            factor.tr_solve_lower_triangular_mut(&mut column);
            input.view_mut((n, k), (n, 1)).copy_from(&column);
        }
        Ok(input)
    }

    fn expect(&self, what: &'static str, given: usize, expected: usize) -> Result<(), LinearError> {
        if given == expected { Ok(()) } else { Err(LinearError::WrongSize { what, given, expected }) }
    }

    /// |K| + Ω |C| + Ω² |M|, element by element.
    fn terms(&self, omega: f64) -> DMatrix<f64> {
        let mut terms = DMatrix::zeros(self.len(), self.len());
        let parts = [(&self.stiffness, 1.0), (&self.damping, omega.abs()), (&self.mass, omega * omega)];
        for (matrix, factor) in parts {
            for (row, column, value) in &matrix.entries {
                terms[(*row as usize, *column as usize)] += factor * value.abs();
            }
        }
        terms
    }
}

/// x(t) of x'' + ω² x = cos Ωt from rest, for all ω and Ω ≥ 0, not both 0.
///
/// x = t · sin((ω + Ω)t/2)/(ω + Ω) · sin(δ)/δ with δ = (ω − Ω)t/2: no cancellation near resonance, and at Ω = ω the
/// secular (t/2ω) sin ωt (catalogue L11).
///
/// ```
/// let x = dalembert::linear::beat(1.0, 1.0, 10.0);
/// assert!((x - 5.0 * 10.0_f64.sin()).abs() < 1e-14);
/// ```
pub fn beat(omega: f64, forcing: f64, t: f64) -> f64 {
    let delta = 0.5 * (omega - forcing) * t;
    let sinc = if delta == 0.0 { 1.0 } else { delta.sin() / delta };
    t * (0.5 * (omega + forcing) * t).sin() / (omega + forcing) * sinc
}
