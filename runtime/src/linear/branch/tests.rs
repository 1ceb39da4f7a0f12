//! Thresholds against closed forms and, in random scans, against discriminants of characteristic polynomials.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::*;
use crate::mechanism::{At, Coordinate, Description, Energy, Parameter, Scene, Signal, Singular, Structure, System};

type Matrices = Arc<dyn Fn(f64) -> [DMatrix<f64>; 3] + Send + Sync>;

/// M x'' + C x' + K x = 0 with matrices that depend on one parameter.
#[derive(Clone)]
struct Tuned {
    matrices: Matrices,
    value: f64,
    description: Description,
}

impl Tuned {
    fn new(n: usize, value: f64, matrices: impl Fn(f64) -> [DMatrix<f64>; 3] + Send + Sync + 'static) -> Tuned {
        let all: Vec<(u32, u32)> = (0..n as u32).flat_map(|i| (0..n as u32).map(move |j| (i, j))).collect();
        let description = Description {
            coordinates: (0..n).map(|i| Coordinate { name: format!("x[{}]", i + 1).into(), unit: "".into() }).collect(),
            parameters: vec![Parameter { name: "p".into(), ..Parameter::default() }].into(),
            mass_pattern: all.iter().copied().filter(|(i, j)| i >= j).collect(),
            stiffness_pattern: all.clone().into(),
            damping_pattern: all.into(),
            structure: Structure { dimension: 2, constant_mass: true, linear: true, ..Structure::default() },
            ..Description::default()
        };
        Tuned { matrices: Arc::new(matrices), value, description }
    }
}

impl System for Tuned {
    fn description(&self) -> &Description {
        &self.description
    }

    fn accelerations(&self, _: At<'_>, _: &mut [f64]) -> Result<(), Singular> {
        Ok(())
    }

    fn mass_matrix(&self, _: At<'_>, values: &mut [f64]) {
        let [m, ..] = (self.matrices)(self.value);
        let places = self.description.mass_pattern.iter();
        values.iter_mut().zip(places).for_each(|(x, (i, j))| *x = m[(*i as usize, *j as usize)]);
    }

    fn bias(&self, _: At<'_>, _: &mut [f64]) {}

    fn residual(&self, at: At<'_>, f: &mut [f64]) {
        let [_, c, k] = (self.matrices)(self.value);
        for i in 0..f.len() {
            f[i] = (0..f.len()).map(|j| c[(i, j)] * at.v[j] + k[(i, j)] * at.q[j]).sum();
        }
    }

    fn jacobians(&self, _: At<'_>, dq: &mut [f64], dv: &mut [f64]) {
        let [_, c, k] = (self.matrices)(self.value);
        dq.copy_from_slice(k.transpose().as_slice());
        dv.copy_from_slice(c.transpose().as_slice());
    }

    fn energy(&self, _: At<'_>) -> Energy {
        Energy::default()
    }

    fn parameters(&self) -> Vec<f64> {
        vec![self.value]
    }

    fn set_parameter(&mut self, _: usize, value: f64) {
        self.value = value;
    }

    fn set_input(&mut self, _: usize, _: Signal) {}

    fn scene(&self, _: usize) -> Scene {
        let zero = vec![0.0; self.len()];
        Scene { q: zero.clone(), v: zero, until: 1.0, tolerance: 1e-9, every: None, ..Scene::default() }
    }

    fn boxed_clone(&self) -> Box<dyn System> {
        Box::new(self.clone())
    }
}

/// Values and kinds of all thresholds in a range.
fn found(system: &Tuned, range: (f64, f64)) -> Vec<(f64, ThresholdKind, [usize; 2])> {
    let branch = follow(system, &Varied::Parameter(0), range, &Guess::at(&vec![0.0; system.len()])).unwrap();
    assert!(branch.changes.is_empty() && branch.missing.is_empty(), "{branch:?}");
    branch.thresholds.iter().map(|t| (t.value, t.kind, t.growing)).collect()
}

fn expect(system: &Tuned, range: (f64, f64), expected: &[(f64, ThresholdKind)]) {
    let found = found(system, range);
    assert_eq!(found.len(), expected.len(), "{found:?} is not {expected:?}");
    for (a, b) in found.iter().zip(expected) {
        assert!((a.0 - b.0).abs() < 1e-8 * b.0.abs().max(1.0) && a.1 == b.1, "{found:?} is not {expected:?}");
    }
}

use ThresholdKind::{Divergence, Flutter};

/// Bars of unit length with unit torsional springs, masses at their ends and a follower force along the last one.
fn column(masses: &[f64], p: f64) -> [DMatrix<f64>; 2] {
    let n = masses.len();
    let mass = DMatrix::from_fn(n, n, |i, j| masses[i.max(j)..].iter().sum());
    let mut stiffness = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 if i == n - 1 => 1.0,
        0 => 2.0,
        1 => -1.0,
        _ => 0.0,
    });
    for i in 0..n {
        stiffness[(i, i)] -= p;
        stiffness[(i, n - 1)] += p;
    }
    [mass, stiffness]
}

/// Ziegler's column with masses r and 1: flutter at (5 + r)/2 − √r, and two growing motions from (5 + r)/2 + √r.
#[test]
fn ziegler_without_damping() {
    for r in [0.5, 1.0, 2.0, 4.0_f64] {
        let system = Tuned::new(2, 0.0, move |p| {
            let [m, k] = column(&[r, 1.0], p);
            [m, DMatrix::zeros(2, 2), k]
        });
        let (middle, half) = (0.5 * (5.0 + r), r.sqrt());
        expect(
            &system,
            (0.0, 6.1),
            &[(middle - half, Flutter), (middle + half, Divergence)][..1 + usize::from(middle + half < 6.1)],
        );
    }
}

/// With damping c at both hinges, masses 2 and 1: 41/28 + c²/2, less than without (Ziegler 1952).
#[test]
fn ziegler_with_damping() {
    for c in [1e-3, 0.1, 1.0] {
        let system = Tuned::new(2, 0.0, move |p| {
            let [m, k] = column(&[2.0, 1.0], p);
            [m, dmatrix![2.0, -1.0; -1.0, 1.0] * c, k]
        });
        expect(&system, (0.0, 2.0), &[(41.0 / 28.0 + 0.5 * c * c, Flutter)]);
    }
}

/// Chains of three and four equal bars with a follower force: roots of the discriminants, solved to 20 digits.
#[test]
fn columns_of_more_bars() {
    for (n, first) in [(3, 1.186_287_270_945_447_4), (4, 0.775_634_287_240_454_4)] {
        let system = Tuned::new(n, 0.0, move |p| {
            let [m, k] = column(&vec![1.0; n], p);
            [m, DMatrix::zeros(n, n), k]
        });
        expect(&system, (0.0, first + 0.1), &[(first, Flutter)]);
    }
}

/// A dead load on two bars buckles them at (3 ∓ √5)/2.
#[test]
fn two_bars_buckle() {
    let system = Tuned::new(2, 0.0, |p| {
        [dmatrix![2.0, 1.0; 1.0, 1.0], DMatrix::zeros(2, 2), dmatrix![2.0 - p, -1.0; -1.0, 1.0 - p]]
    });
    let root = 5.0_f64.sqrt();
    expect(&system, (0.0, 3.0), &[(0.5 * (3.0 - root), Divergence), (0.5 * (3.0 + root), Divergence)]);
}

/// An unstable plane oscillator held by gyroscopic forces (catalogue L7), and the sleeping top (L8).
#[test]
fn gyroscopic_stabilisation() {
    let turning = Tuned::new(2, 0.0, |w| {
        [DMatrix::identity(2, 2), dmatrix![0.0, -2.0 * w; 2.0 * w, 0.0], -DMatrix::identity(2, 2)]
    });
    expect(&turning, (0.2, 3.0), &[(1.0, Flutter)]);
    let top = Tuned::new(2, 5.0, |spin| {
        [DMatrix::identity(2, 2), dmatrix![0.0, spin; -spin, 0.0], DMatrix::identity(2, 2) * -9.81]
    });
    expect(&top, (1.0, 10.0), &[(2.0 * 9.81_f64.sqrt(), Flutter)]);
}

/// A shaft with damping in the bearings (e) and in itself (i) whirls from √k (1 + e/i) on.
/// A shaft with two stiffnesses in rotating axes is unstable between the roots of both: det K < 0 there, by however little.
#[test]
fn a_narrow_window_of_an_asymmetric_shaft_is_found_to_rounding() {
    for part in [1e-2, 1e-4, 1e-6] {
        let (k1, k2) = (100.0, 100.0 * (1.0 + part));
        let shaft = Tuned::new(2, 1.0, move |w| {
            let stiffness = DMatrix::from_row_slice(2, 2, &[k1 - w * w, 0.0, 0.0, k2 - w * w]);
            [DMatrix::identity(2, 2), DMatrix::from_row_slice(2, 2, &[0.0, -2.0 * w, 2.0 * w, 0.0]), stiffness]
        });
        for range in [(9.99, 10.0 + f64::max(0.01, 10.0 * part)), (0.0, 400.0)] {
            let found = found(&shaft, range);
            assert_eq!(found.len(), 2, "{part}: {found:?}");
            for ((value, kind, growing), (law, expected)) in found.iter().zip([(k1, [0, 1]), (k2, [1, 0])]) {
                assert!((value / law.sqrt() - 1.0).abs() < 1e-14, "{part}: {found:?}");
                assert_eq!((*kind, *growing), (Divergence, expected), "{part}");
            }
        }
    }
}

#[test]
fn a_shaft_whirls_by_its_own_damping() {
    for (e, i, k) in [(0.1, 0.2, 4.0), (0.3, 0.05, 1.0), (1e-3, 2e-3, 9.0_f64)] {
        let shaft = Tuned::new(2, 0.1, move |w| {
            let stiffness = dmatrix![k, i * w; -i * w, k];
            [DMatrix::identity(2, 2), DMatrix::identity(2, 2) * (e + i), stiffness]
        });
        expect(&shaft, (0.0, 12.0), &[(k.sqrt() * (1.0 + e / i), Flutter)]);
    }
}

/// The benchmark bicycle (catalogue L18) weaves below 4.292382536 m/s and capsizes above 6.024262015 m/s.
#[test]
fn the_bicycle_is_stable_between_two_speeds() {
    let bicycle = Tuned::new(2, 5.0, |speed| {
        let m = dmatrix![80.81722, 2.31941332208709; 2.31941332208709, 0.29784188199686];
        let k0 = dmatrix![-80.95, -2.59951685249872; -2.59951685249872, -0.80329488458618];
        let k2 = dmatrix![0.0, 76.59734589573222; 0.0, 2.65431523794604];
        let c1 = dmatrix![0.0, 33.86641391492494; -0.85035641456978, 1.68540397397560];
        [m, c1 * speed, k0 * 9.81 + k2 * (speed * speed)]
    });
    expect(&bicycle, (3.0, 8.0), &[(4.292382536, Flutter), (6.024262015, Divergence)]);
}

/// Windows of flutter where two frequencies pass each other, down to a width of 4e-6 of a range of 1.5; uncoupled
/// frequencies pass each other without one.
#[test]
fn narrow_windows_are_found_and_crossings_are_none() {
    let crossing =
        |e: f64| Tuned::new(2, 1.3, move |s| [DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![1.0, e; -e, s]]);
    for e in [1e-2, 1e-3, 1e-4, 1e-6] {
        expect(&crossing(e), (0.5, 2.01), &[(1.0 - 2.0 * e, Flutter), (1.0 + 2.0 * e, Flutter)]);
    }
    expect(&crossing(0.0), (0.5, 2.01), &[]);
    let veering = Tuned::new(2, 1.3, |s| [DMatrix::identity(2, 2), DMatrix::zeros(2, 2), dmatrix![1.0, 1e-3; 1e-3, s]]);
    expect(&veering, (0.5, 2.01), &[]);
}

/// x³ − b x² + c x − d of a 3 × 3 matrix: its discriminant, and d.
fn discriminant(k: &DMatrix<f64>) -> [f64; 2] {
    let minor = |i: usize, j: usize| k[(i, i)] * k[(j, j)] - k[(i, j)] * k[(j, i)];
    let (b, c, d) = (k.trace(), minor(0, 1) + minor(0, 2) + minor(1, 2), k.determinant());
    [18.0 * b * c * d - 4.0 * b.powi(3) * d + b * b * c * c - 4.0 * c.powi(3) - 27.0 * d * d, d]
}

/// Thirty random systems K₀ + p K₁ without symmetry: flutter begins and ends where the discriminant changes sign,
/// divergence where the determinant does, and nowhere else.
#[test]
fn random_scans_miss_nothing() {
    let mut seed = 20_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut total = 0;
    for case in 0..30 {
        let k0 = DMatrix::from_fn(3, 3, |i, j| if i == j { 2.0 + 2.0 * random() } else { random() });
        let k1 = DMatrix::from_fn(3, 3, |_, _| 2.0 * random());
        let stiffness = {
            let (k0, k1) = (k0.clone(), k1.clone());
            move |p: f64| &k0 + &k1 * p
        };
        let expected = {
            let measure = |p: f64, which: usize| discriminant(&stiffness(p))[which];
            let mut list: Vec<(f64, ThresholdKind)> = Vec::new();
            for (which, kind) in [(0, Flutter), (1, Divergence)] {
                for step in 0..100_000 {
                    let (mut low, mut high) = (f64::from(step) * 2e-5, f64::from(step + 1) * 2e-5);
                    let sign = measure(low, which) > 0.0;
                    if sign == (measure(high, which) > 0.0) {
                        continue;
                    }
                    for _ in 0..60 {
                        let middle = 0.5 * (low + high);
                        if (measure(middle, which) > 0.0) == sign { low = middle } else { high = middle }
                    }
                    list.push((low, kind));
                }
            }
            list.sort_by(|a, b| a.0.total_cmp(&b.0));
            list
        };
        let system = Tuned::new(3, 0.0, move |p| [DMatrix::identity(3, 3), DMatrix::zeros(3, 3), stiffness(p)]);
        let found = found(&system, (0.0, 2.0));
        assert_eq!(found.len(), expected.len(), "case {case}: {found:?} is not {expected:?}");
        for (a, b) in found.iter().zip(&expected) {
            assert!((a.0 - b.0).abs() < 1e-8, "case {case}: {found:?} is not {expected:?}");
        }
        total += found.len();
    }
    assert!(total > 30, "{total}");
}

/// The largest bend of a path, in degrees, between pieces of at least a pixel.
fn roughness(points: &[BranchPoint]) -> f64 {
    let all = || points.iter().flat_map(|point| &point.eigenvalues);
    let span = |of: fn(&Complex<f64>) -> f64| {
        all().map(of).fold(f64::NEG_INFINITY, f64::max) - all().map(of).fold(f64::INFINITY, f64::min)
    };
    let pixel = [span(|x| x.re) / 600.0, span(|x| x.im) / 350.0];
    let pixels = |x: Complex<f64>| Complex::new(x.re / pixel[0], x.im / pixel[1]);
    let mut paths: Vec<Vec<Complex<f64>>> = vec![points[0].eigenvalues.clone()];
    for point in &points[1..] {
        let next = crate::linear::modes::matched(&paths[paths.len() - 1], &point.eigenvalues);
        paths.push(next);
    }
    let mut worst = 0.0_f64;
    for three in paths.windows(3) {
        for ((a, b), c) in three[0].iter().zip(&three[1]).zip(&three[2]) {
            let (there, on) = (pixels(b - a), pixels(c - b));
            if there.norm() > 1.0 && on.norm() > 1.0 {
                worst = worst.max((on * there.conj()).arg().abs().to_degrees());
            }
        }
    }
    worst
}

/// Paths are smooth where eigenvalues meet and part: on the real axis (c = 2), off it (flutter of x'' + c x' + [1 p; −p 2] x),
/// where a pair meets at 0 (divergence), and where one passes quickly.
#[test]
fn paths_of_eigenvalues_are_drawn_smoothly() {
    let one = |x| dmatrix![x];
    let flutter = |p: f64| [DMatrix::identity(2, 2), DMatrix::identity(2, 2) * 0.05, dmatrix![1.0, p; -p, 2.0]];
    let quick = |p: f64| {
        let c = 1.0 + (20.0 * p).tanh();
        [DMatrix::identity(2, 2), dmatrix![c, 0.3; 0.3, 0.1], dmatrix![4.0, 0.0; 0.0, 1.0]]
    };
    let cases = [
        Tuned::new(1, 0.0, move |p| [one(1.0), one(p), one(1.0)]),
        Tuned::new(2, 0.0, flutter),
        Tuned::new(1, 0.0, move |p| [one(1.0), one(0.1), one(1.0 - p)]),
        Tuned::new(2, 0.0, quick),
    ];
    let mut rough = 0.0_f64;
    for (case, tuned) in cases.iter().enumerate() {
        let guess = Guess::at(&vec![0.0; tuned.len()]);
        let branch = follow(tuned, &Varied::Parameter(0), (-0.9, 2.7), &guess).unwrap();
        let points = branch.smooth(tuned, &Varied::Parameter(0), &guess).unwrap();
        let found = roughness(&points);
        assert!(found < 3.5, "{case}: bends by {found} degrees");
        assert!(points.len() < 1000, "{case}: {} points", points.len());
        assert!(points.windows(2).all(|pair| pair[0].value < pair[1].value), "{case}: out of order");
        rough = rough.max(roughness(&branch.points));
    }
    // What is looked at for thresholds alone is not smooth.
    assert!(rough > 5.0, "{rough}");
}
