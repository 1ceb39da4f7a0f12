//! Equilibria, linearisation and normal modes against closed forms and the reference cases.
#![expect(clippy::excessive_precision, reason = "reference numbers as they were given")]

use std::f64::consts::{PI, SQRT_2};
use std::sync::Arc;

use nalgebra::DMatrix;

use crate::linear::*;
use crate::mechanism::System;
use crate::testing::Toy;

/// A mechanism of unit masses with a potential's force and its derivative, row by row.
fn field(
    names: &[&'static str],
    force: impl Fn(&[f64], &mut [f64]) + Send + Sync + 'static,
    stiffness: impl Fn(&[f64], &mut [f64]) + Send + Sync + 'static,
) -> Toy {
    let zero = vec![0.0; names.len()];
    let mut toy = Toy::new(names, (&zero, &zero), 1.0, move |_, q, _, _, a| force(q, a));
    toy.jacobian = Arc::new(move |q, _, _, dq, dv| {
        stiffness(q, dq);
        dv.fill(0.0);
    });
    toy
}

fn pendulum(g: f64) -> Toy {
    field(&["theta"], move |q, a| a[0] = -g * q[0].sin(), move |q, k| k[0] = g * q[0].cos())
}

/// Unit masses in the plane with unit springs of their present length between some pairs.
fn springs(points: &'static [[f64; 2]], pairs: &'static [(usize, usize)]) -> Toy {
    let names: Vec<&'static str> =
        ["x1", "y1", "x2", "y2", "x3", "y3", "x4", "y4", "x5", "y5", "x6", "y6"][..2 * points.len()].to_vec();
    let rest = |i: usize, j: usize| (points[i][0] - points[j][0]).hypot(points[i][1] - points[j][1]);
    let n = 2 * points.len();
    let force = move |q: &[f64], a: &mut [f64]| {
        a.fill(0.0);
        for &(i, j) in pairs {
            let d = [q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]];
            let pull = 1.0 - rest(i, j) / d[0].hypot(d[1]);
            for c in 0..2 {
                a[2 * i + c] -= pull * d[c];
                a[2 * j + c] += pull * d[c];
            }
        }
    };
    let stiffness = move |q: &[f64], k: &mut [f64]| {
        k.fill(0.0);
        for &(i, j) in pairs {
            let d = [q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]];
            let length = d[0].hypot(d[1]);
            let pull = 1.0 - rest(i, j) / length;
            for r in 0..2 {
                for c in 0..2 {
                    let unit = if r == c { 1.0 } else { 0.0 };
                    let value = pull * unit + (1.0 - pull) * d[r] * d[c] / (length * length);
                    for (a, b, sign) in [(i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)] {
                        k[(2 * a + r) * n + 2 * b + c] += sign * value;
                    }
                }
            }
        }
    };
    field(&names, force, stiffness)
}

fn flat(points: &[[f64; 2]]) -> Vec<f64> {
    points.iter().flatten().copied().collect()
}

pub fn linear(m: DMatrix<f64>, c: DMatrix<f64>, k: DMatrix<f64>) -> Linearised {
    let system = LinearMechanism::new(m, c, k).unwrap();
    let rest = equilibrium_near(&system, &Guess::at(&vec![0.0; system.len()])).unwrap();
    linearise(&system, &rest).unwrap()
}

pub fn undamped(m: DMatrix<f64>, k: DMatrix<f64>) -> Linearised {
    let n = m.nrows();
    linear(m, DMatrix::zeros(n, n), k)
}

fn normal(m: DMatrix<f64>, k: DMatrix<f64>) -> Vec<Mode> {
    normal_modes(&undamped(m, k), Reduction::Cholesky).unwrap()
}

pub fn chain(n: usize, k: f64, ends: bool) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 if !ends && (i == 0 || i == n - 1) => k,
        0 => 2.0 * k,
        1 => -k,
        _ => 0.0,
    })
}

pub fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs().max(1.0), "{a} is not {b}: off by {:e}", a - b);
}

#[test]
fn a_pendulum_has_two_equilibria_found_from_several_starts() {
    let guesses: Vec<Guess> = [0.3, -0.4, 2.9, 3.3].iter().map(|q| Guess::at(&[*q])).collect();
    let found = equilibria(&pendulum(10.0), &guesses).unwrap();
    assert_eq!(found.len(), 2, "{found:?}");
    close(found[0].q[0], 0.0, 1e-15);
    close(found[1].q[0], PI, 1e-15);
    assert!(found.iter().all(|e| e.freedom.rank == 1 && !e.is_degenerate()));
    let up = linearise(&pendulum(10.0), &found[1]).unwrap();
    let modes = normal_modes(&up, Reduction::Cholesky).unwrap();
    assert_eq!(modes[0].kind, Kind::Unstable);
    close(modes[0].growth_time().unwrap(), 1.0 / 10.0_f64.sqrt(), 1e-14);
}

/// Newton's method is exact on a linear mechanism, but for rounding; it must not chase 0 down to 10⁻¹⁷².
#[test]
fn a_linear_mechanism_is_at_rest_after_a_step_or_two() {
    let system = LinearMechanism::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), chain(2, 1.0, true)).unwrap();
    for start in [[0.3, 0.0], [1e8, -3.0], [0.1, 0.7]] {
        let found = equilibrium_near(&system, &Guess::at(&start)).unwrap();
        assert!(found.iterations <= 4 && found.q.iter().all(|q| q.abs() < 1e-15), "{found:?}");
    }
}

#[test]
fn what_is_no_equilibrium_is_refused_with_its_residual() {
    let toy = pendulum(10.0);
    let refused = equilibrium_here(&toy, &Guess::at(&[PI / 4.0])).unwrap_err();
    let LinearError::NotAnEquilibrium { residual } = &refused else { panic!("{refused}") };
    assert_eq!((residual[0].coordinate.as_str(), residual[0].unit.as_str()), ("theta", ""));
    close(residual[0].force, 10.0 / SQRT_2, 1e-14);
    let mut forged = equilibrium_near(&toy, &Guess::at(&[0.1])).unwrap();
    forged.q[0] = PI / 4.0;
    assert_eq!(linearise(&toy, &forged).unwrap_err(), refused);
}

#[test]
fn a_force_that_nothing_balances_has_no_equilibrium() {
    let falling = field(&["y"], |_, a| a[0] = -10.0, |_, k| k[0] = 0.0);
    let error = equilibrium_near(&falling, &Guess::at(&[1.0])).unwrap_err();
    let LinearError::NoEquilibrium { residual, .. } = error else { panic!("{error}") };
    assert_eq!((residual.len(), residual[0].coordinate.as_str(), residual[0].force), (1, "y", 10.0));
}

/// Twelve digits, and no row of zeros before them.
#[test]
fn forces_that_are_left_are_readable() {
    let told = |force: f64| {
        let residual = vec![Residual { coordinate: "x".to_owned(), force, unit: "N".to_owned() }];
        LinearError::NotAnEquilibrium { residual }.to_string()
    };
    let cases = [
        (10.0 / SQRT_2, "x: 7.07106781187 N"),
        (-3.228011545670001e-11, "x: -3.22801154567e-11 N"),
        (2.5e12, "x: 2.5e12 N"),
        (-0.001, "x: -0.001 N"),
        (0.0, "x: 0 N"),
    ];
    for (force, text) in cases {
        assert!(told(force).ends_with(text), "{}", told(force));
    }
}

#[test]
fn speed_in_a_coordinate_that_matters_is_not_steady() {
    let guess = Guess { v: vec![1.0], ..Guess::at(&[0.0]) };
    let error = equilibrium_near(&pendulum(10.0), &guess).unwrap_err();
    assert_eq!(error, LinearError::NotSteady { coordinate: "theta".into() });
}

/// Catalogue C15: Newton's method at a triple root, F = x³.
#[test]
fn c15_a_triple_root_converges_by_two_thirds_and_is_named() {
    let toy = field(&["x"], |q, a| a[0] = -q[0].powi(3), |q, k| k[0] = 3.0 * q[0] * q[0]);
    let found = equilibrium_near(&toy, &Guess::at(&[1.0])).unwrap();
    close(found.slow.unwrap(), 2.0 / 3.0, 1e-3);
    assert!((50..70).contains(&found.iterations), "{}", found.iterations);
    assert!(found.is_degenerate());
}

/// Catalogue L13: x'' = −x³ has no linear stiffness at 0, and yet it oscillates.
#[test]
fn l13_zero_linear_stiffness_is_degenerate_not_rigid() {
    let toy = field(&["x"], |q, a| a[0] = -q[0].powi(3), |q, k| k[0] = 3.0 * q[0] * q[0]);
    let here = equilibrium_here(&toy, &Guess::at(&[0.0])).unwrap();
    assert_eq!((here.freedom.family, here.freedom.degenerate.len()), (0, 1));
    let free = field(&["x"], |_, a| a[0] = 0.0, |_, k| k[0] = 0.0);
    let drifting = equilibrium_here(&free, &Guess::at(&[0.0])).unwrap();
    assert_eq!((drifting.freedom.family, drifting.freedom.degenerate.len()), (1, 0));
}

/// B10: cart and pendulum, ω² = (g/l)(M + m)/M = 15 hanging, −15 inverted; one rigid mode.
#[test]
fn b10_cart_and_pendulum() {
    let mass = |sign: f64| dmatrix![3.0, sign; sign, 1.0];
    for reduction in [Reduction::Cholesky, Reduction::SquareRoot] {
        let hanging = normal_modes(&undamped(mass(1.0), dmatrix![0.0, 0.0; 0.0, 10.0]), reduction).unwrap();
        assert_eq!(hanging[0].kind, Kind::Rigid);
        close(hanging[1].omega, 3.872983346207416885179265, 1e-14);
        let inverted = normal_modes(&undamped(mass(-1.0), dmatrix![0.0, 0.0; 0.0, -10.0]), reduction).unwrap();
        assert_eq!((inverted[0].kind, inverted[1].kind), (Kind::Unstable, Kind::Rigid));
        close(inverted[0].eigenvalue.re, 3.872983346207416885179265, 1e-14);
    }
}

/// B13b: mass in a slot on a turntable with springs.
#[test]
fn b13b_slot_and_turntable() {
    let modes = normal(dmatrix![2.25, -0.5; -0.5, 1.0], dmatrix![20.0, 0.0; 0.0, 50.0]);
    close(modes[0].omega, 2.947198925247252496258704, 1e-14);
    close(modes[1].omega, 7.587095524311094357620457, 1e-14);
}

/// B18: three masses and four springs: frequencies, shapes with their signs, energies.
#[test]
fn b18_three_masses() {
    let modes = normal(DMatrix::identity(3, 3), chain(3, 1.0, true));
    for (mode, omega) in modes.iter().zip([0.76536686473017954345692, SQRT_2, 1.847759065022573512256366]) {
        close(mode.omega, omega, 1e-14);
    }
    let half = 0.5;
    let expected = [[half, half * SQRT_2, half], [half * SQRT_2, 0.0, -half * SQRT_2], [half, -half * SQRT_2, half]];
    for (mode, shape) in modes.iter().zip(expected) {
        mode.real_shape().iter().zip(shape).for_each(|(a, b)| close(*a, b, 1e-14));
    }
    assert_eq!(modes[0].carriers[0].0, "x[2]");
    close(modes[0].carriers[0].1, 0.5, 1e-14);
}

/// B19: free structures of springs: rigid motions and mechanisms by rank, all others with their frequencies.
#[test]
fn b19_spring_structures_have_their_rigid_modes_by_rank() {
    const S: f64 = 0.866_025_403_784_438_6;
    static TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.5, S]];
    static SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    static HEXAGON: [[f64; 2]; 6] = [[1.0, 0.0], [0.5, S], [-0.5, S], [-1.0, 0.0], [-0.5, -S], [0.5, -S]];
    type Case = (&'static [[f64; 2]], &'static [(usize, usize)], usize, &'static [f64]);
    let cases: [Case; 4] = [
        (&TRIANGLE, &[(0, 1), (1, 2), (2, 0)], 3, &[1.5, 1.5, 3.0]),
        (&SQUARE, &[(0, 1), (1, 2), (2, 3), (3, 0)], 4, &[2.0, 2.0, 2.0, 2.0]),
        (&SQUARE, &[(0, 1), (1, 2), (2, 3), (3, 0), (0, 2), (1, 3)], 3, &[2.0, 2.0, 2.0, 2.0, 4.0]),
        (&HEXAGON, &[(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0)], 6, &[1.0, 1.5, 1.5, 2.5, 2.5, 3.0]),
    ];
    for (points, pairs, free, squares) in cases {
        let toy = springs(points, pairs);
        let rest = equilibrium_here(&toy, &Guess::at(&flat(points))).unwrap();
        assert_eq!((rest.freedom.family, rest.freedom.degenerate.len()), (free, 0), "{pairs:?}");
        let modes = normal_modes(&linearise(&toy, &rest).unwrap(), Reduction::Cholesky).unwrap();
        assert_eq!(modes.iter().filter(|m| m.kind == Kind::Rigid).count(), free);
        for (mode, square) in modes[free..].iter().zip(squares) {
            close(mode.omega.powi(2), *square, 1e-13);
        }
        for (i, a) in modes.iter().enumerate() {
            for b in &modes[..i] {
                let product: f64 = a.real_shape().iter().zip(b.real_shape()).map(|(x, y)| x * y).sum();
                close(product, 0.0, 1e-13);
            }
        }
    }
}

#[test]
fn a_stretched_triangle_relaxes_to_one_of_its_family() {
    static TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.866_025_403_784_438_6]];
    let toy = springs(&TRIANGLE, &[(0, 1), (1, 2), (2, 0)]);
    let found = equilibrium_near(&toy, &Guess::at(&[0.0, -0.1, 1.2, 0.0, 0.4, 0.9])).unwrap();
    assert_eq!((found.freedom.rank, found.freedom.family), (3, 3));
    let side = (found.q[0] - found.q[2]).hypot(found.q[1] - found.q[3]);
    close(side, 1.0, 1e-14);
}

/// B20: the ring of n equal masses, ω = 2 |sin(πj/n)|, in pairs.
#[test]
fn b20_periodic_chain() {
    let n = 12;
    let ring = DMatrix::from_fn(n, n, |i, j| match (i + n - j) % n {
        0 => 2.0,
        1 | 11 => -1.0,
        _ => 0.0,
    });
    let modes = normal(DMatrix::identity(n, n), ring);
    let mut expected: Vec<f64> = (0..n).map(|j| 2.0 * (PI * j as f64 / n as f64).sin()).collect();
    expected.sort_by(f64::total_cmp);
    assert_eq!(modes[0].kind, Kind::Rigid);
    modes.iter().zip(&expected).for_each(|(mode, omega)| close(mode.omega, *omega, 1e-14));
    assert!(modes[1].repeated && modes[2].repeated && !modes[11].repeated);
}

/// B20: the string by n masses, ω = 2(n + 1) sin(jπ/(2(n + 1))) in units of c/L.
#[test]
fn b20_string_of_masses() {
    for (n, first) in [(1, 2.8284271247461900976), (3, 3.0614674589207181738), (50, 3.1410959727293760952)] {
        let step = 1.0 / (n as f64 + 1.0);
        let modes = normal(DMatrix::identity(n, n) * step, chain(n, 1.0 / step, true));
        close(modes[0].omega, first, 1e-12);
    }
}

/// A long chain between walls, ω = 2 sin(jπ/(2(n + 1))), to 10⁻¹⁰ of the closed form; M and K stay sparse.
#[test]
fn a_long_chain_has_the_frequencies_of_its_closed_form() {
    let n = 150;
    let linear = undamped(DMatrix::identity(n, n), chain(n, 1.0, true));
    assert_eq!((linear.mass.entries.len(), linear.stiffness.entries.len()), (n, 3 * n - 2));
    for (j, mode) in normal_modes(&linear, Reduction::Cholesky).unwrap().iter().enumerate() {
        let exact = 2.0 * ((j as f64 + 1.0) * PI / (2.0 * (n as f64 + 1.0))).sin();
        assert!((mode.omega / exact - 1.0).abs() < 1e-10, "{j}: {} is not {exact}", mode.omega);
    }
}

/// Matrices live on the heap: 320 kB of each, on a stack of 256 kB.
#[test]
fn nothing_of_the_size_of_a_matrix_is_on_the_stack() {
    let work = || {
        let n = 200;
        let linear = undamped(DMatrix::identity(n, n), chain(n, 1.0, true));
        normal_modes(&linear, Reduction::Cholesky).unwrap().len()
    };
    let thread = std::thread::Builder::new().stack_size(256 * 1024).spawn(work).unwrap();
    assert_eq!(thread.join().unwrap(), 200);
}

/// Catalogue L3: exactly one rigid mode of a free chain, by rank, whatever its stiffness.
#[test]
fn l3_a_free_chain_has_one_rigid_mode() {
    for (n, k) in [(2, 1.0), (10, 1.0), (10, 1e6), (100, 1.0), (100, 1e6)] {
        let modes = normal(DMatrix::identity(n, n), chain(n, k, false));
        assert_eq!(modes.iter().filter(|m| m.kind == Kind::Rigid).count(), 1);
        let expected = 4.0 * k * (PI / (2.0 * n as f64)).sin().powi(2);
        close(modes[1].omega.powi(2) / expected, 1.0, 1e-9);
        assert_eq!((modes[0].omega, modes[0].zeta), (0.0, None));
    }
}

/// Catalogue L5: shapes of nearly equal frequencies stay orthogonal and are marked.
#[test]
fn l5_near_repeated_frequencies_keep_orthogonal_shapes() {
    for (kappa, repeated) in [(1e-2, false), (1e-6, false), (1e-10, true), (1e-12, true)] {
        let modes = normal(DMatrix::identity(2, 2), dmatrix![1.0 + kappa, -kappa; -kappa, 1.0 + kappa]);
        let [a, b] = [modes[0].real_shape(), modes[1].real_shape()];
        close(a[0] * b[0] + a[1] * b[1], 0.0, 1e-12);
        assert_eq!(modes.iter().all(|m| m.repeated), repeated, "{kappa}");
    }
    // Beat period 2π/Δω of κ = 10⁻⁶: 6.283e6 s.
    let modes = normal(DMatrix::identity(2, 2), dmatrix![1.0 + 1e-6, -1e-6; -1e-6, 1.0 + 1e-6]);
    close(2.0 * PI / (modes[1].omega - modes[0].omega), 6.283e6, 1e-3);
}

/// Catalogue L12: indefinite K gives cosh and sinh, not NaN.
#[test]
fn l12_indefinite_stiffness_grows_by_cosh() {
    let (m, k) = (DMatrix::identity(1, 1), dmatrix![-4.0]);
    let motion = solvemode(&m, &k, &[1.0], &[0.5], &[1.5]).unwrap();
    close(motion.x[(0, 0)], 3.0_f64.cosh() + 0.25 * 3.0_f64.sinh(), 1e-14);
    close(motion.v[(0, 0)], 2.0 * 3.0_f64.sinh() + 0.5 * 3.0_f64.cosh(), 1e-14);
}

/// Problem 28: the three ways agree on the cart and pendulum, which drifts and oscillates.
#[test]
fn problem_28_three_ways_agree() {
    for (m, k) in [
        (dmatrix![3.0, 1.0; 1.0, 1.0], dmatrix![0.0, 0.0; 0.0, 10.0]),
        (dmatrix![3.0, -1.0; -1.0, 1.0], dmatrix![0.0, 0.0; 0.0, -10.0]),
    ] {
        let (x0, v0, times) = ([0.1, 0.2], [0.3, -0.1], [0.0, 0.4, 1.0, 2.0]);
        let by_modes = solvemode(&m, &k, &x0, &v0, &times).unwrap();
        let by_norm = solvenorm(&m, &k, &x0, &v0, &times).unwrap();
        let by_integration = solvenum(&m, &k, &x0, &v0, &times).unwrap();
        let scale = by_modes.x.amax();
        assert!((&by_modes.x - &by_norm.x).amax() < 1e-13 * scale);
        assert!((&by_modes.x - &by_integration.x).amax() < 1e-10 * scale);
        assert!((&by_modes.v - &by_integration.v).amax() < 1e-10 * scale);
    }
}

#[test]
fn bad_matrices_are_refused() {
    let one = DMatrix::identity(2, 2);
    let zero = DMatrix::zeros(2, 2);
    let make = |m: DMatrix<f64>| LinearMechanism::new(m, zero.clone(), one.clone()).unwrap_err();
    assert_eq!(make(dmatrix![1.0, 2.0; 2.0, 4.0]), LinearError::SingularMass { coordinate: "x[2]".into() });
    assert_eq!(make(dmatrix![1.0, 0.0; 1.0, 1.0]), LinearError::NotSymmetric { what: "M" });
    assert_eq!(make(DMatrix::identity(3, 3)), LinearError::WrongSize { what: "C", given: 2, expected: 3 });
    let error = solvemode(&one, &dmatrix![1.0, 0.5; 0.0, 1.0], &[0.0; 2], &[0.0; 2], &[1.0]).unwrap_err();
    assert_eq!(error, LinearError::NotSymmetric { what: "K" });
}

#[test]
fn damping_and_stiffness_are_split() {
    let l = linear(dmatrix![1.0, 0.0; 0.0, 1.0], dmatrix![1.0, 3.0; -1.0, 2.0], dmatrix![5.0, 1.0; 0.0, 4.0]);
    assert_eq!(l.dissipative().to_dense(), dmatrix![1.0, 1.0; 1.0, 2.0]);
    assert_eq!(l.gyroscopic().to_dense(), dmatrix![0.0, 2.0; -2.0, 0.0]);
    assert_eq!(l.conservative().to_dense(), dmatrix![5.0, 0.5; 0.5, 4.0]);
    assert_eq!(l.circulatory().to_dense(), dmatrix![0.0, 0.5; -0.5, 0.0]);
}
