//! Forced response against the reference cases and the catalogue's group L.
#![expect(clippy::excessive_precision, reason = "reference numbers as they were given")]

use nalgebra::{Complex, DMatrix};

use crate::linear::equilibrium::tests::{chain, close, linear, undamped};
use crate::linear::*;

fn three_masses() -> Linearised {
    undamped(DMatrix::identity(3, 3), chain(3, 1.0, true))
}

fn on(mass: usize) -> Vec<Complex<f64>> {
    (0..3).map(|i| Complex::new(if i == mass { 1.0 } else { 0.0 }, 0.0)).collect()
}

fn cosine(omega: f64, mass: usize) -> Harmonic {
    Harmonic { omega, cosine: on(mass).iter().map(|x| x.re).collect(), sine: vec![0.0; 3] }
}

/// 1e-3 N/m, and a mass without a spring, beside 1e15 N/m: what is soft has its steady state, at any frequency but its own.
#[test]
fn what_is_soft_beside_what_is_stiff_is_no_resonance() {
    let springs = dmatrix![1e15, 1.0, 0.0; 1.0, 1e-3, 0.0; 0.0, 0.0, 0.0];
    let beside = undamped(dmatrix![2.0, 0.0, 0.0; 0.0, 3.0, 0.0; 0.0, 0.0, 1e-12], springs);
    for omega in [1e-4, 0.01, 0.018, 0.0183, 0.04, 1e3] {
        let found = beside.steady_state(&on(1), omega).unwrap();
        let exact = 1.0 / (1e-3 - 3.0 * omega * omega - 1.0 / (1e15 - 2.0 * omega * omega));
        assert!((found[1] - exact).norm() < 1e-12 * exact.abs(), "{omega}: {} {exact}", found[1]);
        let found = beside.steady_state(&on(2), omega).unwrap();
        close(found[2].re, -1e12 / (omega * omega), 1e-14);
    }
    let own = undamped(dmatrix![1.0, 0.0; 0.0, 1.0], dmatrix![1e15, 0.0; 0.0, 0.25]);
    let force = vec![Complex::new(0.0, 0.0), Complex::new(1.0, 0.0)];
    assert_eq!(own.steady_state(&force, 0.5), Err(LinearError::Resonance { omega: 0.5 }));
    assert!(own.steady_state(&force, 0.5 + 1e-9).is_ok());
}

/// B18, `forced_on_mass_1_from_rest` and `forced_on_middle_mass_from_rest`: exact, resonance included.
#[test]
fn b18_forced_from_rest() {
    let omega = 2.0_f64.sqrt();
    let first = [
        (1.0, [0.3504296737171266233854, 0.03395136263568773145346, 0.001201674398822443464066]),
        (5.0, [0.6634067612510943989357, -0.791929240664640905601, -0.5896948046972439527823]),
        (20.0, [-0.3279868177705933426858, 0.4537241863366040572655, -0.2577201913963176675678]),
    ];
    let middle = [
        (1.0, [0.03395136263568773145346, 0.3516313481159490668494, 0.03395136263568773145346]),
        (5.0, [-0.791929240664640905601, 0.07371195655385044615339, -0.791929240664640905601]),
        (20.0, [0.4537241863366040572655, -0.5857070091669110102536, 0.4537241863366040572655]),
    ];
    for (mass, cases) in [(0, first), (1, middle)] {
        let times = cases.map(|case| case.0);
        let zero = [0.0; 3];
        let motion = three_masses().harmonic_motion(&zero, &zero, &cosine(omega, mass), &times).unwrap();
        for (row, (_, expected)) in cases.iter().enumerate() {
            (0..3).for_each(|i| close(motion.x[(row, i)], expected[i], 1e-12));
        }
    }
}

/// B18: a force on the middle mass at √(2k/m) leaves that mass at rest; on the first one it meets a mode.
#[test]
fn b18_steady_states() {
    let omega = 2.0_f64.sqrt();
    for x in [three_masses().steady_state(&on(1), omega), three_masses().steady_state_by_modes(&on(1), omega)] {
        // The direct matrix is singular at √2 (the mode (1, 0, −1)), which this force does not reach.
        match x {
            Ok(x) => x.iter().zip([-0.5, 0.0, -0.5]).for_each(|(x, y)| close(x.re, y, 1e-14)),
            Err(error) => assert_eq!(error, LinearError::Resonance { omega }),
        }
    }
    let by_modes = three_masses().steady_state_by_modes(&on(1), omega).unwrap();
    close(by_modes[0].re, -0.5, 1e-14);
    let resonance = three_masses().steady_state_by_modes(&on(0), omega).unwrap_err();
    assert_eq!(resonance, LinearError::Resonance { omega });
    assert_eq!(three_masses().steady_state(&on(0), omega).unwrap_err(), resonance);

    let mut c = DMatrix::zeros(3, 3);
    c[(0, 0)] = 0.5;
    let damped = linear(DMatrix::identity(3, 3), c, chain(3, 1.0, true));
    let x = damped.steady_state(&on(0), omega).unwrap();
    for (x, im) in x.iter().zip([-omega, 0.0, omega]) {
        assert!((x - Complex::new(0.0, im)).norm() < 1e-13, "{x}");
    }
}

#[test]
fn direct_and_modal_steady_states_agree_with_proportional_damping() {
    let k = chain(3, 1.0, true);
    let damped = linear(DMatrix::identity(3, 3), &k * 0.1, k);
    for omega in [0.0, 0.5, 1.4, 2.0_f64.sqrt(), 3.0] {
        let direct = damped.steady_state(&on(0), omega).unwrap();
        let modal = damped.steady_state_by_modes(&on(0), omega).unwrap();
        direct.iter().zip(&modal).for_each(|(a, b)| assert!((a - b).norm() < 1e-13, "{a} {b}"));
    }
}

/// Problem 37's main question: exactly solved, the middle mass does move, because the modes (1, ±√2, 1) answer too;
/// what the mode (1, 0, −1) alone gives leaves the middle at rest, and the right mass moves in that mode.
#[test]
fn problem_37_the_middle_mass_moves_in_the_other_modes() {
    let (k, omega) = (chain(3, 1.0, true), 2.0_f64.sqrt());
    let damped = linear(DMatrix::identity(3, 3), &k * 0.1, k);
    let x = damped.steady_state(&on(0), omega).unwrap();
    let whole: Vec<f64> = x.iter().map(|x| x.norm()).collect();
    // Nearly −F/(4k) from each of the other two modes; the resonant one is damped by 0.2: 0.5/(0.2 √2) = 1.77.
    assert!((whole[1] - 0.477).abs() < 1e-3 && (whole[0] - 1.77).abs() < 0.1, "{whole:?}");
    // (1, 0, −1)/2 is the part of the force (1, 0, 0) on that mode: it pulls the right mass with −1/2.
    let part: Vec<Complex<f64>> = [0.5, 0.0, -0.5].map(|f| Complex::new(f, 0.0)).to_vec();
    let alone = damped.steady_state(&part, omega).unwrap();
    assert!(alone[1].norm() < 1e-14 && (alone[0] + alone[2]).norm() < 1e-13);
}

/// Problem 37 without damping: the mode (1, 0, −1) grows by F/(4mΩ) a second at both ends, and what stays bounded moves
/// the middle mass by F/(2k) alone, which is just what pulls the last mass at its own frequency √(2k/m).
#[test]
fn problem_37_without_damping_grows_in_one_mode() {
    let omega = 2.0_f64.sqrt();
    let steady = three_masses().steady(&Source::Force(0).into(), omega).unwrap();
    let growth = steady.growth.unwrap();
    for (g, expected) in growth.iter().zip([-0.25 / omega, 0.0, 0.25 / omega]) {
        assert!((g - Complex::new(0.0, expected)).norm() < 1e-14, "{g}");
    }
    assert!((steady.total[1] + 0.5).norm() < 1e-14, "{}", steady.total[1]);
    // A growing amplitude of the last mass, m x3'' + 2 k x3 = k x2: k x2/(2 m Ω) a second.
    assert!((growth[2].norm() - steady.total[1].norm() / (2.0 * omega)).abs() < 1e-14);
    // By integration from rest: x3 = t sin(Ωt)/(4Ω) and what stays bounded.
    let motion = three_masses().harmonic_motion(&[0.0; 3], &[0.0; 3], &cosine(omega, 0), &[400.0, 800.0]).unwrap();
    for (row, t) in [(0, 400.0), (1, 800.0)] {
        assert!((motion.x[(row, 2)] + t / (4.0 * omega) * (omega * t).sin()).abs() < 1.0);
    }
    let middle = three_masses().steady(&Source::Force(1).into(), omega).unwrap();
    assert!(middle.growth.is_none() && (middle.total[0] + 0.5).norm() < 1e-13);
}

/// The parts of a steady state by modes add up to it, whatever the damping; a constant force is a static load.
#[test]
fn a_steady_state_is_the_sum_of_its_parts() {
    let mut c = DMatrix::zeros(3, 3);
    c[(0, 0)] = 0.5;
    let damped = linear(DMatrix::identity(3, 3), c, chain(3, 1.0, true));
    for omega in [0.0, 1.1, 2.0_f64.sqrt()] {
        let drive = Drive {
            parts: vec![(Source::Force(0), Complex::new(2.0, 0.0)), (Source::Force(2), Complex::new(-1.0, 0.0))],
        };
        let steady = damped.steady(&drive, omega).unwrap();
        for i in 0..3 {
            let sum: Complex<f64> = steady.modes.iter().map(|mode| mode[i]).sum();
            assert!((sum - steady.total[i]).norm() < 1e-13);
        }
        if omega == 0.0 {
            close(steady.total[0].re, 2.0 * 0.75 - 0.25, 1e-14);
        }
    }
    assert!(damped.steady(&Source::Force(3).into(), 1.0).is_err());
    let free = undamped(DMatrix::identity(2, 2), chain(2, 1.0, false));
    assert_eq!(free.steady(&Source::Force(0).into(), 0.0).unwrap_err(), LinearError::Resonance { omega: 0.0 });
}

/// K = [1 1; 0 4] has the right eigenvectors (1, 0) and (1, 3), and the left ones (3, -1) and (0, 1): with F = (1, 1) and equal damping the parts are
/// (1, 0) 2/3 and (1, 3) 1/3, each over its own dynamic stiffness.
#[cfg(feature = "modal")]
#[test]
fn parts_without_a_potential_follow_the_modes() {
    let k = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 0.0, 4.0]);
    let driven = linear(DMatrix::identity(2, 2), DMatrix::identity(2, 2) * 0.1, k);
    let omega = 1.5;
    let drive = Drive { parts: vec![(Source::Force(0), Complex::ONE), (Source::Force(1), Complex::ONE)] };
    let found = driven.steady(&drive, omega).unwrap();
    let stiffness = |square: f64| Complex::new(square - omega * omega, 0.1 * omega);
    let parts = [[2.0 / 3.0, 0.0].map(|x| x / stiffness(1.0)), [1.0 / 3.0, 1.0].map(|x| x / stiffness(4.0))];
    for (mode, part) in found.modes.iter().zip(parts) {
        assert!(mode.iter().zip(part).all(|(x, expected)| (x - expected).norm() < 1e-12), "{mode:?}, and not {part:?}");
    }
}

/// Frequencies to look at reach beyond all modes and come close to each, however narrow its peak.
#[cfg(feature = "modal")]
#[test]
fn telling_frequencies_do_not_miss_a_peak() {
    let k = chain(3, 1.0, true);
    let damped = linear(DMatrix::identity(3, 3), &k * 1e-6, k);
    let omegas = damped.telling_frequencies(None).unwrap();
    assert!(omegas[0] < 0.2 && omegas[omegas.len() - 1] > 9.0 && omegas.len() < 800);
    let answers = damped.frequency_response(&Source::Force(0).into(), &omegas).unwrap();
    let peak = answers.iter().flatten().map(|x| x[1].norm()).fold(0.0, f64::max);
    // φ₁ φ₂/(c ω) with c = 10⁻⁶ ω², ω² = 2 − √2.
    let expected = 0.5 * 0.5_f64.sqrt() * 1e6 / (2.0 - 2.0_f64.sqrt()).powf(1.5);
    assert!((peak / expected - 1.0).abs() < 1e-2, "{peak} {expected}");
    let narrow = damped.telling_frequencies(Some((2.0, 3.0))).unwrap();
    assert_eq!((narrow[0], narrow[narrow.len() - 1]), (2.0, 3.0));
}

#[test]
fn frequency_responses_and_root_loci_are_drawn() {
    let oscillator = undamped(DMatrix::identity(1, 1), DMatrix::identity(1, 1));
    let figure = bode(&oscillator, &Source::Force(0).into(), "a force", &[0.5, 0.9, 1.0, 1.1, 2.0]).unwrap();
    let points = |chart: usize| figure.charts[chart].series[0].points.clone();
    assert_eq!(points(0)[2], None, "an undamped resonance is a gap");
    close(points(0)[4].unwrap().1, 1.0 / 3.0, 1e-15);
    let phases: Vec<Option<f64>> = points(1).into_iter().map(|point| point.map(|p| p.1)).collect();
    assert_eq!(phases, [Some(0.0), Some(0.0), None, Some(-180.0), Some(-180.0)]);
    let pair = |re: f64, im: f64| vec![Complex::new(re, im), Complex::new(re, -im)];
    let steps =
        [(0.0, pair(0.0, 1.0)), (1.0, pair(-0.5, 0.8)), (1.5, vec![pair(-0.75, -0.6)[0], pair(-0.75, -0.6)[1]])];
    let chart = root_locus("c", "N*s/m", &steps);
    assert_eq!((chart.series[1].name.as_str(), chart.series[2].name.as_str()), ("c = 0 N*s/m", "c = 1.5 N*s/m"));
    // Each branch goes on where it is nearest, though the order of the last list is another.
    let upper = &chart.series[0].points[..4];
    assert_eq!(upper, [None, Some((0.0, 1.0)), Some((-0.5, 0.8)), Some((-0.75, 0.6))]);
}

/// B21: transmissibility of a base-excited oscillator, (k u + c u') on the right-hand side.
#[test]
fn b21_transmissibility() {
    let table = [
        (0.0, 0.5, 1.3333333333333333333, 0.0),
        (0.0, 5.0, 0.041666666666666666667, -std::f64::consts::PI),
        (0.1, 0.5, 1.3282289485393665619, -0.032882879805511993891),
        (0.1, 1.1, 3.3666086873965697135, -2.1163925624057927369),
        (0.25, 0.9, 2.2449533605282743052, -0.74842690666258137255),
        (0.25, 3.0, 0.22148725420119530133, -1.9734509803467694056),
        (0.5, 2.0, 0.62017367294604228095, -1.4464413322481351842),
        (1.0, 0.9, 1.1376386896118232393, -0.40193238117045352234),
        (1.0, 5.0, 0.38653367773541885655, -1.2756738595862971299),
        (0.25, 0.9481452871613907866, 2.2831533148189420932, f64::NAN),
    ];
    for (zeta, r, size, phase) in table {
        let mut base = linear(DMatrix::identity(1, 1), DMatrix::identity(1, 1) * (2.0 * zeta), DMatrix::identity(1, 1));
        base.inputs = vec!["u".to_owned()];
        base.input = SparseMatrix::new(1, 3, &[(0, 0), (0, 1)], &[1.0, 2.0 * zeta]);
        let x = base.response_to_input(0, r).unwrap()[0];
        close(x.norm(), size, 1e-13);
        if phase.is_finite() {
            close(x.arg().abs(), phase.abs(), 1e-13);
        }
        assert!(base.response_to_input(1, r).is_err());
    }
}

/// Catalogue L4: φ₁ of a singular A: a double integrator under a unit force for 2 s is at (2, 2).
#[test]
fn l4_step_with_singular_stiffness() {
    let free = undamped(DMatrix::identity(1, 1), DMatrix::zeros(1, 1));
    let motion = free.step_motion(&[0.0], &[0.0], &[1.0], &[2.0]).unwrap();
    assert_eq!((motion.x[(0, 0)], motion.v[(0, 0)]), (2.0, 2.0));
}

/// Catalogue L11: exact resonance: (t/2) sin t = −2.720106 at t = 10, and no cancellation beside it.
#[test]
fn l11_resonance() {
    let oscillator = undamped(DMatrix::identity(1, 1), DMatrix::identity(1, 1));
    let exact = 5.0 * 10.0_f64.sin();
    close(exact, -2.720106, 1e-6);
    close(beat(1.0, 1.0, 10.0), exact, 1e-15);
    for detuning in [0.0, 1e-14, 1e-10, 1e-8, 1e-6, 1e-2] {
        let force = Harmonic { omega: 1.0 + detuning, cosine: vec![1.0], sine: vec![0.0] };
        let motion = oscillator.harmonic_motion(&[0.0], &[0.0], &force, &[10.0]).unwrap();
        close(motion.x[(0, 0)], beat(1.0, 1.0 + detuning, 10.0), 2e-14);
    }
    let w = 1.01;
    close(beat(1.0, w, 10.0), ((w * 10.0).cos() - 10.0_f64.cos()) / (1.0 - w * w), 1e-13);
    close(beat(0.0, 2.0, 3.0), (1.0 - 6.0_f64.cos()) / 4.0, 1e-15);
}

#[test]
fn steps_impulses_and_sampled_forces_agree_with_closed_forms() {
    let oscillator = linear(DMatrix::identity(1, 1) * 2.0, DMatrix::zeros(1, 1), DMatrix::identity(1, 1) * 18.0);
    let step = oscillator.step_motion(&[0.0], &[0.0], &[9.0], &[0.7]).unwrap();
    close(step.x[(0, 0)], 0.5 * (1.0 - 2.1_f64.cos()), 1e-14);
    let impulse = oscillator.impulse_motion(&[4.0], &[0.7]).unwrap();
    close(impulse.x[(0, 0)], 2.0 * 2.1_f64.sin() / 3.0, 1e-14);
    // A ramp is linear: exact at any spacing.  x = (f/k)(t − sin(ωt)/ω).
    let ramp: Vec<Vec<f64>> = (0..5).map(|i| vec![18.0 * 0.5 * f64::from(i)]).collect();
    let sampled = oscillator.forced_motion(&[0.0], &[0.0], &ramp, 0.5).unwrap();
    close(sampled.x[(4, 0)], 2.0 - 6.0_f64.sin() / 3.0, 1e-13);
}

/// Of two bodies on a rail a force on the first reaches two of four directions, though the eigenvalue 0 has one shape that it does not reach; the
/// speed of the first shows one, its place two.
#[test]
fn ranks_count_all_that_is_reached() {
    let named = |names: &[&str]| names.iter().map(|name| [(*name).to_owned(), String::new()]).collect::<Vec<_>>();
    let mut a = DMatrix::zeros(4, 4);
    (a[(0, 2)], a[(1, 3)]) = (1.0, 1.0);
    let row = |place: usize| DMatrix::from_fn(1, 4, |_, i| f64::from(u8::from(i == place)));
    let space = |seen: usize| InputOutput {
        states: named(&["x", "z", "x'", "z'"]),
        inputs: named(&["f"]),
        outputs: named(&["y"]),
        a: a.clone(),
        b: row(2).transpose() * 1e-3,
        c: row(seen),
        d: DMatrix::zeros(1, 1),
    };
    assert_eq!(space(0).controllability_rank(), 2);
    assert_eq!([0, 2].map(|seen| space(seen).observability_rank()), [2, 1]);
    let none = InputOutput { b: DMatrix::zeros(4, 0), inputs: Vec::new(), ..space(0) };
    assert_eq!(none.controllability_rank(), 0);
}
