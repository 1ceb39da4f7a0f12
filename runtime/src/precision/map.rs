//! Where a method is stable: growth per step of an oscillator, measured on the running code.

use nalgebra::{Complex, Matrix2};

use crate::cause::NoSeries;
use crate::error::Error;
use crate::integrate::{Stability, Trial, stability, stepper};
use crate::mechanism::{
    At, Description, Energy, Method, Place, Recurrence, Scene, Series, Singular, Structure, System,
};
use crate::show::{self, Axis, Chart};

/// Growth per step of x'' + 2ζω x' + ω² x = 0 over (hω, ζ).
///
/// A step maps (x, x'/ω) by a matrix, whose columns are what the method makes of (1, 0) and (0, 1) and whose spectral radius
/// is the growth.  Theory says max |R(hλ)| for the two rates λ, R the method's stability function (Hairer and Wanner, Solving
/// Ordinary Differential Equations II, section IV.2).
///
/// ```
/// # use dalembert::{Method, precision::StabilityMap};
/// let map = StabilityMap::measure(Method::Rk4, 4.0)?;
/// let undamped = &map.limits[0];
/// assert!((undamped.measured.unwrap() - 2.0 * 2f64.sqrt()).abs() < 0.01);
/// # Ok::<(), dalembert::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StabilityMap {
    /// The method.
    pub method: Method,
    /// (hω, ζ, growth per step); NaN where the step cannot be computed.
    pub cells: Vec<(f64, f64, f64)>,
    /// How long steps may be at each ζ.
    pub limits: Vec<Limit>,
}

/// The longest steps up to which nothing grows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Limit {
    /// ζ.
    pub damping: f64,
    /// hω on the running code; `None` where it is stable as far as the map goes.
    pub measured: Option<f64>,
    /// hω by the stability function.
    pub theory: Option<f64>,
}

/// The map has so many columns and rows, and ζ up to this.
const COLUMNS: usize = 64;
const ROWS: usize = 24;
const MOST_DAMPING: f64 = 1.5;
/// More growth than this per step is none of rounding, nor of an order's last term on the imaginary axis.
const GROWS: f64 = 1.0 + 1e-3;
/// Limits are looked for at so many steps between 0 and the longest, and then halved.
const LOOKS: usize = 400;
/// Bands of growth with their names.
const BANDS: [(f64, &str); 5] =
    [(0.5, "below 0.5"), (0.9, "to 0.9"), (GROWS, "to 1"), (1.1, "grows to 1.1"), (f64::INFINITY, "grows faster")];

impl StabilityMap {
    /// Measures a method for steps up to hω = `longest`.  Methods for separable systems have a map for ζ = 0 only.
    ///
    /// # Errors
    /// [`Error::NoReference`] for `auto`, which is no method of its own, and for `moreau`, which is for contacts.
    pub fn measure(method: Method, longest: f64) -> Result<StabilityMap, Error> {
        if method == Method::Auto {
            return Err(Error::NoReference { why: "`auto` has no steps of its own".to_owned() });
        }
        if method == Method::Moreau {
            return Err(Error::NoReference {
                why: "`moreau` is for contacts, which the oscillator has not".to_owned(),
            });
        }
        let rows = if method.wants_separable() { 1 } else { ROWS };
        let damping = |row: usize| MOST_DAMPING * row as f64 / (ROWS - 1) as f64;
        let column = |k: usize| longest * (k + 1) as f64 / COLUMNS as f64;
        let cells = (0..rows).flat_map(|row| {
            (0..COLUMNS).map(move |k| (column(k), damping(row), growth(method, column(k), damping(row))))
        });
        let theory = stability(method);
        let limits = (0..rows).map(|row| {
            let zeta = damping(row);
            Limit {
                damping: zeta,
                measured: first_growth(longest, |z| growth(method, z, zeta)),
                theory: first_growth(longest, |z| expected(&theory, z, zeta)),
            }
        });
        Ok(StabilityMap { method, cells: cells.collect(), limits: limits.collect() })
    }

    /// The map, coloured by growth, with the measured limit and the theory's over it.
    pub fn chart(&self) -> Chart {
        let mut chart = Chart::new(
            format!("{}: growth per step of x'' + 2ζω x' + ω² x = 0", self.method),
            Axis::new("hω", ""),
            Axis::new("ζ", ""),
        );
        let mut least = f64::NEG_INFINITY;
        for (most, name) in BANDS {
            let inside = self.cells.iter().filter(|(.., growth)| *growth > least && *growth <= most);
            chart = chart.with(show::Series::marks(name, inside.map(|(z, zeta, _)| Some((*z, *zeta)))));
            least = most;
        }
        let line =
            |of: fn(&Limit) -> Option<f64>| self.limits.iter().map(move |limit| Some((of(limit)?, limit.damping)));
        chart = chart.with(show::Series::line("measured limit", line(|limit| limit.measured)));
        let theory = show::Series::line("theory", line(|limit| limit.theory));
        chart.with(show::Series { style: show::Style::Dashed, ..theory })
    }
}

/// The spectral radius of a step; NaN where there is none.
fn growth(method: Method, z: f64, zeta: f64) -> f64 {
    let oscillator =
        Oscillator { description: Oscillator::describe(), damping: 2.0 * zeta, series: Oscillator::series() };
    let column = |start: [f64; 2]| -> Option<[f64; 2]> {
        let mut stepper = stepper(method, 1, false);
        stepper.state_mut().copy_from_slice(&start);
        stepper.begin(&oscillator, 0.0).ok()?;
        stepper.attempt(&oscillator, Trial { t: 0.0, h: z, tolerance: None }).ok()?;
        <[f64; 2]>::try_from(stepper.end().y).ok()
    };
    let (Some([a, c]), Some([b, d])) = (column([1.0, 0.0]), column([0.0, 1.0])) else { return f64::NAN };
    if ![a, b, c, d].iter().all(|x| x.is_finite()) {
        return f64::NAN;
    }
    Matrix2::new(a, b, c, d).complex_eigenvalues().iter().fold(0.0, |most: f64, value| most.max(value.norm()))
}

/// max |R(hλ)| for λ = −ζ ± √(ζ² − 1).
fn expected(theory: &Stability, z: f64, zeta: f64) -> f64 {
    let root = Complex::from(zeta * zeta - 1.0).sqrt();
    let of = |rate: Complex<f64>| theory.amplification(rate * z);
    of(root - zeta).max(of(-root - zeta))
}

/// The first z at which something grows.
fn first_growth(longest: f64, growth: impl Fn(f64) -> f64) -> Option<f64> {
    let grows = |z: f64| growth(z) > GROWS;
    let step = longest / LOOKS as f64;
    let first = (1..=LOOKS).find(|k| grows(step * *k as f64))?;
    let (mut stable, mut unstable) = (step * (first - 1) as f64, step * first as f64);
    for _ in 0..40 {
        let middle = 0.5 * (stable + unstable);
        if grows(middle) { unstable = middle } else { stable = middle }
    }
    Some(stable)
}

/// x'' + d x' + x = 0.
#[derive(Clone, Debug)]
struct Oscillator {
    description: Description,
    damping: f64,
    series: Series,
}

impl Oscillator {
    fn describe() -> Description {
        let pattern = || vec![(0, 0)].into();
        Description {
            coordinates: vec![crate::mechanism::Coordinate { name: "x".into(), unit: "".into() }].into(),
            mass_pattern: pattern(),
            stiffness_pattern: pattern(),
            damping_pattern: pattern(),
            structure: Structure {
                constant_mass: true,
                diagonal_mass: true,
                separable: true,
                linear: true,
                ..Structure::default()
            },
            ..Description::default()
        }
    }
}

impl Oscillator {
    /// h = x + d x', made with d, and M = 1.
    fn series() -> Series {
        let (place, damped) = (Recurrence::Coordinate(0), Recurrence::Scaled(1, 0));
        Series {
            constants: 2,
            rows: vec![place, Recurrence::Speed(0), damped, Recurrence::Sum(0, 2)].into(),
            mass: vec![(0, 0, Place::Constant(1))].into(),
            bias: vec![Place::Row(3)].into(),
            ..Series::default()
        }
    }
}

impl System for Oscillator {
    fn description(&self) -> &Description {
        &self.description
    }

    fn accelerations(&self, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        a[0] = -at.q[0] - self.damping * at.v[0];
        Ok(())
    }

    fn mass_matrix(&self, _: At<'_>, values: &mut [f64]) {
        values[0] = 1.0;
    }

    fn bias(&self, at: At<'_>, h: &mut [f64]) {
        h[0] = at.q[0] + self.damping * at.v[0];
    }

    fn residual(&self, at: At<'_>, f: &mut [f64]) {
        f[0] = at.a[0] + at.q[0] + self.damping * at.v[0];
    }

    fn jacobians(&self, _: At<'_>, dq: &mut [f64], dv: &mut [f64]) {
        (dq[0], dv[0]) = (1.0, self.damping);
    }

    fn energy(&self, at: At<'_>) -> Energy {
        Energy { kinetic: 0.5 * at.v[0] * at.v[0], potential: 0.5 * at.q[0] * at.q[0], ..Energy::default() }
    }

    fn scene(&self, _: usize) -> Scene {
        Scene { q: vec![1.0], v: vec![0.0], ..Scene::default() }
    }

    fn series(&self) -> Result<&Series, NoSeries> {
        Ok(&self.series)
    }

    fn series_constants(&self, values: &mut [f64]) {
        values.copy_from_slice(&[self.damping, 1.0]);
    }

    fn boxed_clone(&self) -> Box<dyn System> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_running_code_is_as_stable_as_theory_says() {
        for method in Method::ALL.into_iter().filter(|method| !matches!(method, Method::Auto | Method::Moreau)) {
            let map = StabilityMap::measure(method, 7.0).unwrap();
            for limit in &map.limits {
                match (limit.measured, limit.theory) {
                    (Some(measured), Some(theory)) => {
                        assert!((measured - theory).abs() <= 0.01 * theory.max(0.02), "{method} {limit:?}");
                    }
                    (measured, theory) => assert_eq!(measured, theory, "{method} {limit:?}"),
                }
            }
        }
    }

    #[test]
    fn limits_are_those_of_the_literature() {
        let undamped = |method| StabilityMap::measure(method, 7.0).unwrap().limits[0].measured;
        for (method, known) in [
            (Method::Rk4, 2.83),
            (Method::Verlet, 2.0),
            (Method::Srkn4, 3.16),
            (Method::Suzuki4, 2.72),
            (Method::KahanLi8, 3.09),
        ] {
            let found = undamped(method).unwrap();
            assert!((found - known).abs() < 0.01 * known, "{method}: {found}");
        }
        for method in [Method::Gauss4, Method::Radau5, Method::Rodas5P, Method::Exact] {
            assert_eq!(undamped(method), None, "{method}");
        }
    }

    #[test]
    fn the_chart_has_the_bands_and_both_limits() {
        let chart = StabilityMap::measure(Method::Rk4, 4.0).unwrap().chart();
        assert_eq!(chart.series.len(), BANDS.len() + 2);
        let cells: usize = chart.series[..BANDS.len()].iter().map(|series| series.points.len()).sum();
        assert_eq!(cells, COLUMNS * ROWS);
        assert!(
            StabilityMap::measure(Method::Auto, 4.0).is_err() && StabilityMap::measure(Method::Moreau, 4.0).is_err()
        );
    }
}
