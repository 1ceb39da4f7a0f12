//! What shakes a mechanism, and where the answer comes from: the frequency response, by modes and by forces.

use std::f64::consts::FRAC_PI_2;

#[cfg(feature = "modal")]
use nalgebra::DMatrix;
use nalgebra::{Complex, DVector};

use super::Observed;
use super::harmonic::REACHED;
#[cfg(feature = "modal")]
use crate::linear::complex_modes;
use crate::linear::modes::Spectrum;
use crate::linear::{LinearError, Linearised, Reduction};

/// Inputs and forces that swing with one frequency Ω as one forced vibration: each goes as Re(a e^(iΩt)) with its own complex
/// amplitude a = A e^(iφ), that is as A cos(Ωt + φ); what has a negative phase φ comes later.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drive {
    /// What acts, and its complex amplitude, SI.
    pub parts: Vec<(Source, Complex<f64>)>,
}

impl Drive {
    /// This drive with something more that goes as `amplitude` cos(Ωt + `phase`); the phase is in radians.
    ///
    /// # Example
    /// The force of an unbalance that turns counterclockwise, cos Ωt along x and sin Ωt along y, on a mass of 1 kg on equal springs
    /// of 4 N/m: it moves on a circle of radius F/(k − mΩ²), y a quarter of a turn after x.
    /// ```
    /// use std::f64::consts::FRAC_PI_2;
    /// use dalembert::linear::{Drive, Guess, LinearMechanism, Source, equilibrium_near, linearise};
    /// use nalgebra::DMatrix;
    /// let one = DMatrix::identity(2, 2);
    /// let system = LinearMechanism::new(one.clone(), one.clone() * 0.0, one * 4.0)?;
    /// let linear = linearise(&system, &equilibrium_near(&system, &Guess::at(&[0.0, 0.0]))?)?;
    /// let unbalance = Drive::from(Source::Force(0)).with(Source::Force(1), 1.0, -FRAC_PI_2);
    /// let found = linear.steady(&unbalance, 1.0)?.total;
    /// assert!((found[0].re - 1.0 / 3.0).abs() < 1e-15 && (found[1].im + 1.0 / 3.0).abs() < 1e-15);
    /// # Ok::<(), dalembert::linear::LinearError>(())
    /// ```
    pub fn with(mut self, source: Source, amplitude: f64, phase: f64) -> Drive {
        self.parts.push((source, turned(amplitude, phase)));
        self
    }
}

/// A e^(iφ); exact at quarters of a turn, whose cosine or sine rounding would not leave at 0.
pub(crate) fn turned(amplitude: f64, phase: f64) -> Complex<f64> {
    let quarters = phase / FRAC_PI_2;
    // Radians of degrees are within a few roundings of a whole number of quarters.
    if (quarters - quarters.round()).abs() <= 4.0 * f64::EPSILON * quarters.abs() {
        return match quarters.round().rem_euclid(4.0) as u8 {
            0 => Complex::new(amplitude, 0.0),
            1 => Complex::new(0.0, amplitude),
            2 => Complex::new(-amplitude, 0.0),
            _ => Complex::new(0.0, -amplitude),
        };
    }
    Complex::from_polar(1.0, phase) * amplitude
}

/// Something that can swing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// An input of the model, by index; its derivatives act too.
    Input(usize),
    /// A generalized force on a coordinate of the model, by index.
    Force(usize),
}

impl From<Source> for Drive {
    fn from(source: Source) -> Drive {
        Drive { parts: vec![(source, Complex::ONE)] }
    }
}

/// A steady state x = Re(X e^(iΩt)), and where it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Steady {
    /// Ω, rad/s.
    pub omega: f64,
    /// The generalized forces F.
    pub force: Vec<Complex<f64>>,
    /// X; what grows without bound is left out of it.
    pub total: Vec<Complex<f64>>,
    /// Normal modes: what each contributes to X, φ φᵀM X, in rising order of ω²; they add up to X exactly, whatever
    /// the damping, with what is `carried`.  Where C or K is not symmetric, complex modes, as they are printed: the parts of (X, iΩX) along the
    /// eigenvectors of the first-order form, both of a pair together.
    pub modes: Vec<Vec<Complex<f64>>>,
    /// What inputs carry along through constraints that move with them.
    pub carried: Option<Vec<Complex<f64>>>,
    /// ω of these modes, rad/s (0 where ω² is not positive).
    pub omegas: Vec<f64>,
    /// x grows as Re(G t e^(iΩt)): G, where Ω meets undamped modes that the force reaches.
    pub growth: Option<Vec<Complex<f64>>>,
}

/// What each mode contributes to a steady state, and ω of each, rad/s.
#[cfg(feature = "modal")]
type PartsByMode = (Vec<Vec<Complex<f64>>>, Vec<f64>);

impl Steady {
    /// Complex amplitudes of some answers; `None` of those that grow.
    ///
    /// # Errors
    /// [`LinearError::ReactionToForce`] for reactions to generalized forces.
    pub fn answers(&self, drive: &Drive, observed: &Observed) -> Result<Vec<Option<Complex<f64>>>, LinearError> {
        observed.admits(drive)?;
        let found = observed.without_rounding((&self.total, self.growth.as_deref()), drive, self.omega);
        let Some(growth) = &self.growth else { return Ok(found.into_iter().map(Some).collect()) };
        let grows = observed.of(growth, &Drive::default(), self.omega);
        let most = growth.iter().fold(0.0_f64, |most, x| most.max(x.norm()));
        let bounded =
            |(row, grows): (usize, &Complex<f64>)| grows.norm() <= REACHED * most * observed.reach(row, self.omega);
        Ok(found.iter().enumerate().zip(&grows).map(|((row, x), g)| bounded((row, g)).then_some(*x)).collect())
    }
}

impl Linearised {
    /// The input or coordinate of this name; an input first.
    pub fn source(&self, name: &str) -> Option<Source> {
        let at = |names: &[String]| names.iter().position(|known| known == name);
        at(&self.inputs).map(Source::Input).or_else(|| at(&self.equilibrium.coordinates).map(Source::Force))
    }

    /// The complex generalized forces of a drive at a frequency Ω, rad/s: Σ a (B₀ + iΩ B₁ − Ω² B₂).
    ///
    /// # Errors
    /// [`LinearError::WrongSize`] for an input or a coordinate that does not exist.
    pub fn driving_force(&self, drive: &Drive, omega: f64) -> Result<Vec<Complex<f64>>, LinearError> {
        self.check_drive(drive)?;
        let mut force = vec![Complex::new(0.0, 0.0); self.len()];
        for (source, amplitude) in &drive.parts {
            match source {
                Source::Force(coordinate) => {
                    for (row, _, value) in self.forces.entries.iter().filter(|e| e.1 as usize == *coordinate) {
                        force[*row as usize] += *amplitude * *value;
                    }
                }
                Source::Input(input) => {
                    for (row, column, value) in &self.input.entries {
                        if *column as usize / 3 == *input {
                            let turn = Complex::new(0.0, omega).powu(*column % 3);
                            force[*row as usize] += turn * (*amplitude * *value);
                        }
                    }
                }
            }
        }
        Ok(force)
    }

    /// Refuses inputs and coordinates that do not exist.
    pub(super) fn check_drive(&self, drive: &Drive) -> Result<(), LinearError> {
        for (source, _) in &drive.parts {
            let (what, given, expected) = match source {
                Source::Input(input) => ("the input's index", *input, self.inputs.len()),
                Source::Force(coordinate) => ("the coordinate's index", *coordinate, self.forces.columns),
            };
            if given >= expected {
                return Err(LinearError::WrongSize { what, given, expected });
            }
        }
        Ok(())
    }

    /// The complex amplitude of every coordinate at each frequency, rad/s; `None` where an undamped mode makes it
    /// infinite.
    ///
    /// # Errors
    /// As [`Linearised::driving_force`].
    pub fn frequency_response(
        &self,
        drive: &Drive,
        omegas: &[f64],
    ) -> Result<Vec<Option<Vec<Complex<f64>>>>, LinearError> {
        let answer = |omega: &f64| match self.steady_state(&self.driving_force(drive, *omega)?, *omega) {
            Err(LinearError::Resonance { .. }) => Ok(None),
            other => other.map(Some),
        };
        omegas.iter().map(answer).collect()
    }

    /// The steady state at a frequency Ω, taken apart by normal modes.
    ///
    /// Where Ω meets an undamped mode that the force reaches there is none: that mode grows as
    /// η = f t e^(iΩt)/(2iΩ), and the others are as steady as ever (problem 37 without damping).
    ///
    /// # Errors
    /// As [`normal_modes`](crate::linear::normal_modes); [`LinearError::Resonance`] for a constant force on a mode without stiffness,
    /// and where damping or forces without a potential couple a singular matrix.
    pub fn steady(&self, drive: &Drive, omega: f64) -> Result<Steady, LinearError> {
        let n = self.len();
        let force = self.driving_force(drive, omega)?;
        let spectrum = Spectrum::new(&self.mass, &self.conservative(), Reduction::Cholesky);
        let Spectrum { squares, shapes, .. } = spectrum.map_err(|fault| fault.named(self))?;
        let omegas = squares.iter().map(|square| square.max(0.0).sqrt()).collect();
        let spread =
            |k: usize, eta: Complex<f64>| -> Vec<Complex<f64>> { shapes.column(k).iter().map(|x| eta * *x).collect() };
        match self.steady_state(&force, omega) {
            Ok(total) => {
                #[cfg(feature = "modal")]
                if let Some((modes, omegas)) = self.unsymmetric_parts(&total, omega)? {
                    return Ok(Steady { omega, force, modes, carried: None, total, omegas, growth: None });
                }
                let weights = shapes.transpose() * self.m();
                let modes =
                    (0..n).map(|k| spread(k, weights.row(k).iter().zip(&total).map(|(weight, x)| x * *weight).sum()));
                Ok(Steady { omega, force, modes: modes.collect(), carried: None, total, omegas, growth: None })
            }
            // Only then do the modes not know of each other.
            Err(LinearError::Resonance { .. })
                if omega > 0.0 && self.damping.is_zero() && self.circulatory().is_zero() =>
            {
                let most = force.iter().fold(0.0_f64, |most, f| most.max(f.norm()));
                let mut growth = DVector::zeros(n);
                let modes: Vec<Vec<Complex<f64>>> = (0..n)
                    .map(|k| {
                        let modal: Complex<f64> = shapes.column(k).iter().zip(&force).map(|(x, f)| f * *x).sum();
                        let gap = squares[k] - omega * omega;
                        if gap.abs() > 16.0 * n as f64 * f64::EPSILON * squares[k].abs().max(omega * omega) {
                            return spread(k, modal / gap);
                        }
                        if modal.norm() > REACHED * most * shapes.column(k).amax() {
                            growth += DVector::from_vec(spread(k, modal / Complex::new(0.0, 2.0 * omega)));
                        }
                        spread(k, Complex::new(0.0, 0.0))
                    })
                    .collect();
                let total = (0..n).map(|i| modes.iter().map(|mode| mode[i]).sum()).collect();
                let growth = (growth.iter().any(|g: &Complex<f64>| g.norm() > 0.0)).then(|| growth.as_slice().to_vec());
                Ok(Steady { omega, force, total, modes, carried: None, omegas, growth })
            }
            Err(other) => Err(other),
        }
    }

    /// What each complex mode contributes to a steady state X, and their ω, where C or K is not symmetric, so that shapes are not orthogonal in M: the
    /// parts along right eigenvectors, told apart by left ones; `None` where all is symmetric, or where eigenvectors are no basis.
    #[cfg(feature = "modal")]
    fn unsymmetric_parts(&self, total: &[Complex<f64>], omega: f64) -> Result<Option<PartsByMode>, LinearError> {
        if self.circulatory().is_zero() && self.gyroscopic().is_zero() {
            return Ok(None);
        }
        let (n, found) = (self.len(), complex_modes(self)?);
        let mut vectors: Vec<(usize, Complex<f64>, Vec<Complex<f64>>)> = Vec::with_capacity(2 * n);
        for (k, mode) in found.modes.iter().enumerate() {
            vectors.push((k, mode.eigenvalue, mode.shape.clone()));
            if mode.eigenvalue.im != 0.0 {
                vectors.push((k, mode.eigenvalue.conj(), mode.shape.iter().map(Complex::conj).collect()));
            }
        }
        if found.defective || vectors.len() != 2 * n {
            return Ok(None);
        }
        // Speeds in units of the fastest mode.
        let rate = vectors.iter().fold(omega.abs(), |most, (_, value, _)| most.max(value.norm()));
        let state = |shape: &[Complex<f64>], value: Complex<f64>, i: usize| {
            if i < n { shape[i] } else { shape[i - n] * value / rate }
        };
        let basis = DMatrix::from_fn(2 * n, 2 * n, |i, k| state(&vectors[k].2, vectors[k].1, i));
        let whole = DVector::from_fn(2 * n, |i, _| state(total, Complex::new(0.0, omega), i));
        let Some(parts) = basis.lu().solve(&whole) else { return Ok(None) };
        let mut modes = vec![vec![Complex::ZERO; n]; found.modes.len()];
        for ((k, _, shape), part) in vectors.iter().zip(&parts) {
            modes[*k].iter_mut().zip(shape).for_each(|(sum, x)| *sum += x * part);
        }
        Ok(Some((modes, found.modes.iter().map(|mode| mode.omega).collect())))
    }

    /// Frequencies, rad/s, at which a frequency response shows all that happens: evenly over the logarithm from a
    /// fifth of the lowest frequency of the modes to five times the highest (or over the range given), and closely
    /// about each mode.
    ///
    /// # Errors
    /// As [`Linearised::modes`].
    pub fn telling_frequencies(&self, range: Option<(f64, f64)>) -> Result<Vec<f64>, LinearError> {
        const EVENLY: i32 = 400;
        let modes = self.modes()?;
        let moving = modes.iter().filter(|mode| mode.omega > 0.0);
        let (least, most) =
            moving.clone().fold((f64::INFINITY, 0.0_f64), |(low, high), m| (low.min(m.omega), high.max(m.omega)));
        let (low, high) = range.unwrap_or(if most > 0.0 { (least / 5.0, most * 5.0) } else { (0.1, 10.0) });
        let between = |i: i32| (low.ln() + f64::from(i) / f64::from(EVENLY) * (high.ln() - low.ln())).exp();
        let mut list: Vec<f64> = (1..EVENLY).map(between).filter(|omega| (low..=high).contains(omega)).collect();
        list.extend([low, high]);
        for mode in moving.filter(|mode| mode.damped_omega() > 0.0) {
            let centre = mode.damped_omega();
            // Half the width of the peak, or what the eye can tell.
            let width = mode.eigenvalue.re.abs().max(1e-4 * centre);
            let near = (-30..=30).map(|i| centre + width * (f64::from(i) / 7.0).sinh());
            list.extend(near.filter(|omega| (low..=high).contains(omega)));
        }
        list.sort_by(f64::total_cmp);
        list.dedup();
        Ok(list)
    }

    /// All 2n eigenvalues λ of motions e^(λt), 1/s.
    ///
    /// # Errors
    /// As [`Linearised::modes`].
    pub fn eigenvalues(&self) -> Result<Vec<Complex<f64>>, LinearError> {
        #[cfg(feature = "modal")]
        return Ok(crate::linear::complex_modes(self)?.eigenvalues);
        #[cfg(not(feature = "modal"))]
        return Ok(self.modes()?.iter().flat_map(|mode| [mode.eigenvalue, -mode.eigenvalue]).collect());
    }
}
