//! Damped, gyroscopic and circulatory modes against the reference cases and the catalogue's group L.
#![expect(clippy::excessive_precision, reason = "reference numbers as they were given")]

use nalgebra::{Complex, DMatrix};

use crate::linear::equilibrium::tests::{chain, close, linear, undamped};
use crate::linear::*;

fn modes(m: DMatrix<f64>, c: DMatrix<f64>, k: DMatrix<f64>) -> ComplexModes {
    complex_modes(&linear(m, c, k)).unwrap()
}

fn fastest_growth(analysis: &ComplexModes) -> f64 {
    analysis.eigenvalues.iter().fold(f64::NEG_INFINITY, |most, x| most.max(x.re))
}

/// x'' + 2ζ x' + x = 0.
fn oscillator(zeta: f64) -> Linearised {
    linear(dmatrix![1.0], dmatrix![2.0 * zeta], dmatrix![1.0])
}

/// B18: dampers 0.2 parallel to all springs: `damped_parallel_c_0_2_eigenvalues_re_im`.
#[test]
fn b18_parallel_dampers() {
    let analysis = modes(DMatrix::identity(3, 3), chain(3, 0.2, true), chain(3, 1.0, true));
    let expected = [
        (-0.05857864376269049511983113, 0.7631218645287453386808003),
        (-0.2, 1.4),
        (-0.3414213562373095048801689, 1.815941909830314821805293),
    ];
    for (mode, (re, im)) in analysis.modes.iter().zip(expected) {
        assert_eq!(mode.kind, Kind::Damped);
        close(mode.eigenvalue.re, re, 1e-14);
        close(mode.eigenvalue.im, im, 1e-14);
        // Proportional damping leaves the shapes real.
        assert!(mode.shape.iter().all(|x| x.im.abs() < 1e-14));
        close(mode.zeta.unwrap(), 0.1 * mode.omega, 1e-13);
    }
    assert_eq!(analysis.modes.len(), 3);
}

/// B18: one damper 0.5 on mass 1: eigenvalues and complex shapes with x₁ = 1.
#[test]
fn b18_one_damper() {
    let mut c = DMatrix::zeros(3, 3);
    c[(0, 0)] = 0.5;
    let analysis = modes(DMatrix::identity(3, 3), c, chain(3, 1.0, true));
    let expected = [
        (-0.06306788131221175364097352, 0.7737776737010220006822875),
        (-0.1329489668251750198767196, 1.406301793304230935731833),
        (-0.05398315186261322648230686, 1.822951053635081430460634),
    ];
    let second = [
        (1.373711728678940077416928, 0.2892877998784802612374608),
        (-0.02648378948340189183821406, 0.3292181557237387947194269),
        (-1.347227939195538185578714, 0.7146582396845539355236553),
    ];
    for ((mode, (re, im)), (x, y)) in analysis.modes.iter().zip(expected).zip(second) {
        close(mode.eigenvalue.re, re, 1e-13);
        close(mode.eigenvalue.im, im, 1e-13);
        let ratio = mode.shape[1] / mode.shape[0];
        close(ratio.re, x, 1e-11);
        close(ratio.im, y, 1e-11);
    }
    assert!(!analysis.defective && !analysis.only_gyroscopic);
}

/// Catalogue L1: near critical damping cond(V) = √(2/d), ζ = 1 − d; at d = 0 the matrix is defective, and the
/// exponential is exact.
#[test]
fn l1_critical_damping() {
    for (d, defective) in [(1e-2, false), (1e-6, false), (1e-10, false), (1e-12, true)] {
        let analysis = complex_modes(&oscillator(1.0 - d)).unwrap();
        assert!((analysis.condition / (2.0_f64 / d).sqrt() - 1.0).abs() < 0.05, "{d}: {}", analysis.condition);
        assert_eq!((analysis.defective, analysis.modes[0].kind), (defective, Kind::Damped), "{d}");
    }
    let critical = oscillator(1.0);
    let analysis = complex_modes(&critical).unwrap();
    assert!(analysis.defective);
    let mode = &analysis.modes[0];
    assert_eq!((analysis.modes.len(), mode.kind, mode.zeta), (1, Kind::Critical, Some(1.0)));
    close(mode.omega, 1.0, 1e-15);
    let motion = critical.free_motion(&[1.0], &[0.0], &[5.0]).unwrap();
    assert!((motion.x[(0, 0)] - 6.0 * (-5.0_f64).exp()).abs() < 1e-15);
}

#[test]
fn overdamped_eigenvalues_come_in_pairs_with_one_frequency_and_ratio() {
    let analysis = modes(DMatrix::identity(2, 2), chain(2, 4.0, true), chain(2, 1.0, true));
    assert_eq!(analysis.modes.len(), 4);
    for mode in &analysis.modes {
        // C = 4 K: ζ = 2ω.
        assert_eq!(mode.kind, Kind::Overdamped);
        close(mode.zeta.unwrap(), 2.0 * mode.omega, 1e-12);
    }
    close(analysis.modes[0].omega, 1.0, 1e-13);
    close(analysis.modes[3].omega, 3.0_f64.sqrt(), 1e-13);
}

/// A saddle turned by gyroscopic forces: nothing damps, so that its two real eigenvalues are of one size, and one dies out.
#[test]
fn the_half_of_a_saddle_that_dies_out_is_not_overdamped() {
    let analysis = modes(DMatrix::identity(2, 2), dmatrix![0.0, -2.0; 2.0, 0.0], dmatrix![-11.0, 0.0; 0.0, 4.0]);
    let kinds: Vec<Kind> = analysis.modes.iter().map(|mode| mode.kind).collect();
    assert_eq!(kinds, [Kind::Unstable, Kind::Oscillating, Kind::Decaying]);
    close(analysis.modes[2].eigenvalue.re, -analysis.modes[0].eigenvalue.re, 1e-12);
    let told = analysis.modes[2].to_string();
    assert!(told.starts_with("decaying, falls to 1/e in") && !told.contains("zeta"), "{told}");
}

/// Catalogue L2: a rigid motion A + B t has one shape and two zero eigenvalues; damping to the ground takes one away.
#[test]
fn l2_rigid_motion_is_defective_and_exact_by_the_exponential() {
    let free = linear(DMatrix::identity(2, 2), chain(2, 0.1, false), chain(2, 1.0, false));
    let analysis = complex_modes(&free).unwrap();
    assert_eq!(analysis.modes.iter().map(|m| m.kind).collect::<Vec<_>>(), [Kind::Rigid, Kind::Damped]);
    assert_eq!(analysis.eigenvalues.iter().filter(|x| x.norm() == 0.0).count(), 2);
    assert!(analysis.defective);
    let motion = free.free_motion(&[0.0, 0.0], &[1.0, 1.0], &[7.0]).unwrap();
    close(motion.x[(0, 0)], 7.0, 1e-14);
    let braked = modes(dmatrix![2.0], dmatrix![3.0], dmatrix![0.0]);
    assert_eq!(braked.modes.iter().map(|m| m.kind).collect::<Vec<_>>(), [Kind::Rigid, Kind::Overdamped]);
    close(braked.modes[1].eigenvalue.re, -1.5, 1e-15);
    assert!(!braked.defective);
}

fn gyroscopic(w: f64, k: f64, c: f64) -> Linearised {
    linear(DMatrix::identity(2, 2), dmatrix![c, -2.0 * w; 2.0 * w, c], DMatrix::identity(2, 2) * k)
}

/// Catalogue L6: ω = √(1 + W²) ± W.
#[test]
fn l6_gyroscopic_frequencies() {
    for w in [0.1, 1.0_f64] {
        let analysis = complex_modes(&gyroscopic(w, 1.0, 0.0)).unwrap();
        let root = (1.0 + w * w).sqrt();
        close(analysis.modes[0].omega, root - w, 1e-14);
        close(analysis.modes[1].omega, root + w, 1e-14);
        assert!(fastest_growth(&analysis) < 1e-14);
        assert!(analysis.modes.iter().all(|m| m.kind == Kind::Oscillating) && !analysis.only_gyroscopic);
    }
}

/// Catalogue L7: K = −I is held by gyroscopic forces above W = 1, and damping destroys that.
#[test]
fn l7_gyroscopic_stabilisation() {
    let below = complex_modes(&gyroscopic(0.99, -1.0, 0.0)).unwrap();
    close(fastest_growth(&below), 0.1411, 1e-3);
    assert!(!below.only_gyroscopic && below.modes[0].kind == Kind::Unstable);
    let above = complex_modes(&gyroscopic(1.01, -1.0, 0.0)).unwrap();
    assert!(above.only_gyroscopic && above.modes.iter().all(|m| m.kind == Kind::Oscillating), "{above:?}");
    let damped = complex_modes(&gyroscopic(1.01, -1.0, 0.01)).unwrap();
    assert!((fastest_growth(&damped) - 2.96e-2).abs() < 5e-5, "{}", fastest_growth(&damped));
}

/// Catalogue L8: a sleeping top is stable for (I₃ω₃)² > 4 mgl I₁.
#[test]
fn l8_sleeping_top() {
    let growth = |factor: f64| {
        let spin = factor * (4.0 * 9.81_f64).sqrt();
        let top = linear(DMatrix::identity(2, 2), dmatrix![0.0, spin; -spin, 0.0], DMatrix::identity(2, 2) * -9.81);
        fastest_growth(&complex_modes(&top).unwrap())
    };
    assert!((growth(0.99) - 0.4418).abs() < 1e-4 && growth(1.01) < 1e-12);
}

/// Ziegler's column with masses 2 and 1, unit springs and lengths, follower force P.
fn ziegler(p: f64, c: f64) -> ComplexModes {
    let damping = dmatrix![2.0, -1.0; -1.0, 1.0] * c;
    modes(dmatrix![3.0, 1.0; 1.0, 1.0], damping, dmatrix![2.0 - p, p - 1.0; -1.0, 1.0])
}

/// Catalogue L9: the critical load is 7/2 − √2 without damping, 41/28 with vanishing damping.
#[test]
fn l9_follower_force() {
    let flutters = |p: f64, c: f64| ziegler(p, c).modes[0].kind == Kind::Unstable;
    let critical = 3.5 - 2.0_f64.sqrt();
    assert!(!flutters(critical - 1e-5, 0.0) && flutters(critical + 1e-5, 0.0));
    let damped = 41.0 / 28.0;
    assert!(!flutters(damped - 1e-5, 1e-4) && flutters(damped + 1e-5, 1e-4));
}

/// Catalogue L10: two masses, a damper on the second; errors of diagonal damping in free motion up to t = 100.
#[test]
fn l10_diagonal_damping_states_its_error() {
    for (coupling, c, ratio, most) in
        [(1.0, 0.01, 0.002, 0.0078), (0.1, 0.01, 0.034, 0.0670), (0.1, 0.05, 0.172, 0.2767), (0.1, 0.2, 0.689, 0.6568)]
    {
        let k = dmatrix![2.0, -coupling; -coupling, 2.0];
        let full = linear(DMatrix::identity(2, 2), dmatrix![0.0, 0.0; 0.0, c], k.clone());
        let diagonal = full.diagonal_damping().unwrap();
        assert!((diagonal.error - ratio).abs() < 1e-3, "{}", diagonal.error);
        assert!((diagonal.commutator - if coupling == 1.0 { 0.63 } else { 0.07 }).abs() < 5e-3);
        let approximate = linear(DMatrix::identity(2, 2), diagonal.matrix.clone(), k);
        let times: Vec<f64> = (0..=2000).map(|i| 0.05 * f64::from(i)).collect();
        let [a, b] = [&full, &approximate].map(|l| l.free_motion(&[1.0, 0.0], &[0.0, 0.0], &times).unwrap());
        let worst = (&a.x - &b.x).amax();
        assert!((worst / most - 1.0).abs() < 0.01, "{worst}");
    }
}

#[test]
fn proportional_damping_decouples() {
    let (k, (alpha, beta)) =
        (chain(3, 1.0, true), proportional_damping((0.7653668647301796, 0.02), (1.8477590650225735, 0.05)).unwrap());
    let system = linear(DMatrix::identity(3, 3), DMatrix::identity(3, 3) * alpha + &k * beta, k);
    let diagonal = system.diagonal_damping().unwrap();
    assert!(diagonal.error < 1e-13 && diagonal.commutator < 1e-14);
    close(diagonal.zeta[0].unwrap(), 0.02, 1e-13);
    close(diagonal.zeta[2].unwrap(), 0.05, 1e-13);
    assert!(proportional_damping((1.0, 0.1), (1.0, 0.1)).is_err());
}

/// Complex modes of an undamped system are its normal modes.
#[test]
fn without_damping_both_ways_agree() {
    let l = undamped(dmatrix![2.25, -0.5; -0.5, 1.0], dmatrix![20.0, 0.0; 0.0, 50.0]);
    let (one, other) = (complex_modes(&l).unwrap().modes, l.modes().unwrap());
    for (a, b) in one.iter().zip(&other) {
        close(a.omega, b.omega, 1e-13);
        assert_eq!(a.kind, b.kind);
        a.shape.iter().zip(&b.shape).for_each(|(x, y)| assert!((x - y).norm() < 1e-13));
    }
}

/// Problem 32: random positive M, C, K: every mode fulfils λ²Mφ + λCφ + Kφ = 0 and decays.
#[test]
fn problem_32_random_matrices() {
    let mut seed = 7_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    for n in 1..8 {
        let mut positive = || {
            let b = DMatrix::from_fn(n, n, |_, _| random());
            &b * b.transpose() + DMatrix::identity(n, n) * 0.1
        };
        let (m, c, k) = (positive(), positive() * 0.3, positive());
        let analysis = modes(m.clone(), c.clone(), k.clone());
        for mode in &analysis.modes {
            let value = mode.eigenvalue;
            let pencil = m.map(Complex::from) * (value * value) + c.map(Complex::from) * value + k.map(Complex::from);
            let left = &pencil * nalgebra::DVector::from_vec(mode.shape.clone());
            let scale = value.norm_sqr() * m.norm() + value.norm() * c.norm() + k.norm();
            assert!(left.norm() < 1e-12 * scale, "{n}: {mode} leaves {}", left.norm());
            assert!(value.re < 0.0);
        }
    }
}

/// Catalogue L18: the benchmark bicycle (Meijaard, Papadopoulos, Ruina and Schwab 2007) at a speed, lean and steer.
fn bicycle(speed: f64) -> ComplexModes {
    let m = dmatrix![80.81722, 2.31941332208709; 2.31941332208709, 0.29784188199686];
    let k0 = dmatrix![-80.95, -2.59951685249872; -2.59951685249872, -0.80329488458618];
    let k2 = dmatrix![0.0, 76.59734589573222; 0.0, 2.65431523794604];
    let c1 = dmatrix![0.0, 33.86641391492494; -0.85035641456978, 1.68540397397560];
    modes(m, c1 * speed, k0 * 9.81 + k2 * (speed * speed))
}

/// The bicycle is stable between its weave and capsize speeds, 4.292382536 and 6.024262015 m/s.
#[test]
fn l18_bicycle_weaves_and_capsizes() {
    let unstable = |speed: f64| bicycle(speed).modes.iter().filter(|m| m.kind == Kind::Unstable).count();
    let near = 1e-8;
    assert_eq!([unstable(4.292382536 - near), unstable(4.292382536 + near)], [1, 0]);
    assert_eq!([unstable(6.024262015 - near), unstable(6.024262015 + near)], [0, 1]);
}

/// Oscillators and integrators that drive each other one way have the eigenvalues of each, which rounding of all together would split by ε^(1/3).
#[test]
fn what_acts_one_way_keeps_the_eigenvalues_of_each() {
    let row = |own: f64, driven: f64| {
        DMatrix::from_fn(3, 3, |i, j| match i as isize - j as isize {
            0 => own,
            1 => driven,
            _ => 0.0,
        })
    };
    let one = DMatrix::identity(3, 3);
    let integrators = modes(one.clone(), DMatrix::zeros(3, 3), row(0.0, -1.0));
    assert!(integrators.eigenvalues.iter().all(|x| *x == Complex::from(0.0)), "{:?}", integrators.eigenvalues);
    assert!(integrators.modes.iter().all(|mode| mode.kind == Kind::Rigid) && integrators.defective);
    let oscillators = modes(one.clone(), DMatrix::zeros(3, 3), row(1.0, -1.0));
    assert_eq!(oscillators.secular, [vec![0, 1, 2]]);
    assert!(oscillators.modes.iter().all(|mode| (mode.eigenvalue - Complex::i()).norm() < 1e-14));
    let critical = modes(one.clone(), 2.0 * &one, row(1.0, -1.0));
    let is_critical = |mode: &Mode| mode.kind == Kind::Critical && (mode.omega - 1.0).abs() < 1e-12;
    assert!(critical.defective && critical.modes.iter().all(is_critical));
    // A spring that acts back makes a circle of two of them; the third is by itself.
    let mut back = row(1.0, -0.5);
    back[(0, 1)] = -0.5;
    let found = modes(one, DMatrix::zeros(3, 3), back);
    for (mode, omega) in found.modes.iter().zip([0.5_f64.sqrt(), 1.0, 1.5_f64.sqrt()]) {
        close(mode.omega, omega, 1e-14);
    }
}
