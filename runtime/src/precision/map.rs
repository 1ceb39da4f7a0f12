//! Where a method is stable: growth per step of an oscillator, measured on the running code.

use nalgebra::Complex;

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
/// assert!((undamped.measured.unwrap() - 2.0 * 2f64.sqrt()).abs() < 1e-6);
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

/// The steps up to which nothing grows.  Longer ones may be stable again.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Limit {
    /// ζ.
    pub damping: f64,
    /// hω on the running code; 0 where steps of any length grow, `None` where none does as far as the map goes.
    pub measured: Option<f64>,
    /// hω by the stability function.
    pub theory: Option<f64>,
    /// hω beyond the measured limit between which nothing grows either; the second is the end of the map at most.
    pub again: Option<(f64, f64)>,
}

/// The map has so many columns and rows, and ζ up to this: one of the rows is ζ = 1, where limits have a kink.
const COLUMNS: usize = 64;
const ROWS: usize = 25;
const MOST_DAMPING: f64 = 1.5;
/// What grows or shrinks by no more than this per step, or by hω times as much in longer ones, does so by rounding, which leaves some
/// 1e-15 behind.
const ROUNDING: f64 = 1e-14;
/// Limits are looked for at so many equal steps up to this hω, below which those of all explicit methods lie, then in steps that grow with
/// hω, and between two steps by halving.
const NEAR: f64 = 7.0;
const LOOKS: usize = 400;
/// Of methods for separable systems at so many: these have windows of growth as narrow as 0.001, `rkn8` at hω = π.
const SEPARABLE_LOOKS: usize = 40_000;
/// Growth that sets in with a power of hω is not yet doubled in a step longer by this part, other growth is many times as large.
const LITTLE: f64 = 1e-4;
/// Bands of growth with their names.
const BANDS: [(f64, &str); 5] = [
    (0.5, "below 0.5"),
    (0.9, "to 0.9"),
    (1.0 + ROUNDING, "to 1"),
    (1.1, "grows to 1.1"),
    (f64::INFINITY, "grows faster"),
];

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
        let looks = if method.wants_separable() { SEPARABLE_LOOKS } else { LOOKS };
        let limits = (0..rows).map(|row| {
            let zeta = damping(row);
            let measured = Looks { count: looks, longest, growth: |z| growth(method, z, zeta) };
            let expected = Looks { count: looks, longest, growth: |z| expected(&theory, z, zeta) };
            let limit = measured.limit();
            let again = limit.and_then(|limit| measured.again(limit));
            Limit { damping: zeta, measured: limit, theory: expected.limit(), again }
        });
        Ok(StabilityMap { method, cells: cells.collect(), limits: limits.collect() })
    }

    /// The map, coloured by growth, with the measured limit and the theory's over it; of a method that is measured at ζ = 0 only, growth
    /// over hω.
    pub fn chart(&self) -> Chart {
        if self.limits.len() == 1 {
            return self.undamped_chart();
        }
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

    /// Growth at ζ = 0 over hω, measured and by theory, with the limit as a line.
    fn undamped_chart(&self) -> Chart {
        let theory = stability(self.method);
        let title = format!("{}: growth per step of x'' + ω² x = 0", self.method);
        let measured = self.cells.iter().map(|(z, _, growth)| Some((*z, *growth)));
        let expected = self.cells.iter().map(|(z, zeta, _)| Some((*z, expected(&theory, *z, *zeta))));
        let expected = show::Series::line("theory", expected);
        let limits = self.limits.iter().filter_map(|limit| limit.measured);
        let mut chart = Chart::new(title, Axis::new("hω", ""), Axis::new("growth per step", "").log())
            .with(show::Series::marks("measured", measured))
            .with(show::Series { style: show::Style::Dashed, ..expected });
        chart.instants = limits.map(|x| show::Instant { x, name: "limit".to_owned() }).collect();
        chart
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
    spectral_radius([[a, b], [c, d]])
}

/// The largest of the sizes of both eigenvalues, exact also where they meet: from (a − d)²/4 + b c, of which nothing cancels there.
fn spectral_radius([[a, b], [c, d]]: [[f64; 2]; 2]) -> f64 {
    let (half, apart) = (0.5 * (a + d), 0.5 * (a - d));
    match apart * apart + b * c {
        turning if turning < 0.0 => half.hypot((-turning).sqrt()),
        growing => half.abs() + growing.sqrt(),
    }
}

/// max |R(hλ)| for λ = −ζ ± √(ζ² − 1).
fn expected(theory: &Stability, z: f64, zeta: f64) -> f64 {
    let root = Complex::from(zeta * zeta - 1.0).sqrt();
    let of = |rate: Complex<f64>| theory.amplification(rate * z);
    of(root - zeta).max(of(-root - zeta))
}

/// Growth over z, looked at up to the longest.
struct Looks<F> {
    count: usize,
    longest: f64,
    growth: F,
}

impl<F: Fn(f64) -> f64> Looks<F> {
    fn grows(&self, z: f64) -> bool {
        (self.growth)(z) > 1.0 + rounding(z)
    }

    /// The places that are looked at beyond one.
    fn beyond(&self, z: f64) -> impl Iterator<Item = f64> {
        let (count, longest) = (self.count as f64, self.longest);
        let places = std::iter::successors(Some(NEAR / count), move |place| Some(place + place.max(NEAR) / count));
        places.take_while(move |place| *place < longest).chain([longest]).filter(move |place| *place > z)
    }

    /// Where, beyond a place, what grows begins to do so, or, with `false`, ceases.
    fn change(&self, from: f64, grows: bool) -> Option<f64> {
        let mut before = from;
        for after in self.beyond(from) {
            if self.grows(after) == grows {
                return Some(halved((before, after), |z| self.grows(z) == grows));
            }
            before = after;
        }
        None
    }

    /// The z up to which nothing grows; 0 where growth sets in at once, and only rounding hides it below.
    fn limit(&self) -> Option<f64> {
        let limit = self.change(0.0, true)?;
        let slowly = || (self.growth)(limit * (1.0 + LITTLE)) < 1.0 + 2.0 * rounding(limit);
        let shrinks = || self.beyond(0.0).take_while(|z| *z < limit).any(|z| (self.growth)(z) < 1.0 - rounding(z));
        Some(if slowly() && !shrinks() { 0.0 } else { limit })
    }

    /// The next z beyond a limit between which nothing grows.
    fn again(&self, limit: f64) -> Option<(f64, f64)> {
        let grown = self.beyond(limit).find(|z| self.grows(*z))?;
        let from = self.change(grown, false)?;
        Some((from, self.change(from, true).unwrap_or(self.longest)))
    }
}

/// How much a step of this length may grow by rounding.
fn rounding(z: f64) -> f64 {
    ROUNDING * z.max(1.0)
}

/// Where between two places something begins that holds at the second: to all digits.
fn halved((mut before, mut after): (f64, f64), holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (before + after);
        if holds(middle) { after = middle } else { before = middle }
    }
    after
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
                        assert!((measured - theory).abs() <= 1e-6 * theory, "{method} {limit:?}");
                    }
                    (measured, theory) => assert_eq!(measured, theory, "{method} {limit:?}"),
                }
            }
        }
    }

    #[test]
    fn limits_are_those_of_the_catalogue() {
        let undamped = |method| StabilityMap::measure(method, 7.0).unwrap().limits[0];
        for (method, known) in [
            (Method::Euler, 0.0),
            (Method::Midpoint, 0.0),
            (Method::Rk4, 8f64.sqrt()),
            (Method::Dopri5, 0.99719),
            (Method::Dop853, 5.96036),
            (Method::Taylor, 3.2903),
            (Method::Verlet, 2.0),
            (Method::Srkn4, 3.1635),
            (Method::Suzuki4, 2.72097),
            (Method::KahanLi8, 3.0964),
        ] {
            let found = undamped(method).measured.unwrap();
            assert!((found - known).abs() <= 5e-5 * known, "{method}: {found}");
        }
        for method in [Method::Gauss4, Method::Radau5, Method::Rodas5P, Method::Exact] {
            assert_eq!(undamped(method).measured, None, "{method}");
        }
    }

    #[test]
    fn windows_of_growth_are_found() {
        let found = |method| StabilityMap::measure(method, 7.0).unwrap().limits[0];
        for (method, window, next) in
            [(Method::Rkn8, (3.1403, std::f64::consts::PI), 3.2927), (Method::Srkn4, (3.1635, 3.1685), 5.0269)]
        {
            let Limit { measured: Some(limit), again: Some((from, to)), .. } = found(method) else {
                panic!("{method}")
            };
            let off = (limit - window.0).abs() + (from - window.1).abs() + (to - next).abs();
            assert!(off < 2e-4, "{method}: {limit} {from} {to}");
        }
        assert_eq!(found(Method::Rk4).again, None);
    }

    #[test]
    fn limits_with_damping_are_exact() {
        // |1 + z| = 1 at hω = 2ζ below ζ = 1, and at the fast root, ζ + √(ζ² − 1) by hω, being 2 above.
        for limit in StabilityMap::measure(Method::Euler, 7.0).unwrap().limits {
            let zeta = limit.damping;
            let known = if zeta < 1.0 { 2.0 * zeta } else { 2.0 / (zeta + (zeta * zeta - 1.0).sqrt()) };
            assert!((limit.theory.unwrap() - known).abs() < 1e-6, "{limit:?}");
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
        // Measured at ζ = 0 only: growth over hω, and where it begins.
        let undamped = StabilityMap::measure(Method::Verlet, 4.0).unwrap().chart();
        assert_eq!((undamped.series.len(), undamped.series[0].points.len()), (2, COLUMNS));
        assert!((undamped.instants[0].x - 2.0).abs() < 1e-6);
    }
}
