//! Steady motions, bifurcations, and how far the linear model reaches.

use std::sync::Arc;

use nalgebra::DVector;

use crate::linear::equilibrium::tests::close;
use crate::linear::*;
use crate::mechanism::{At, System};
use crate::testing::Toy;
use crate::{Settings, simulate};

/// A unit mass on a spring k, r₀ in a tube that turns freely: r'' = rφ'² − k(r − r₀), (r²φ')' = 0.
fn turning_tube(k: f64, r0: f64) -> Toy {
    let mut toy = Toy::new(&["r", "phi"], (&[r0, 0.0], &[0.0, 0.0]), 1.0, move |_, q, v, _, a| {
        a[0] = q[0] * v[1] * v[1] - k * (q[0] - r0);
        a[1] = -2.0 * v[0] * v[1] / q[0];
    })
    .mass(|_, q| vec![1.0, q[0] * q[0]]);
    toy.jacobian = Arc::new(move |q, v, a, dq, dv| {
        dq.copy_from_slice(&[k - v[1] * v[1], 0.0, 2.0 * q[0] * a[1] + 2.0 * v[0] * v[1], 0.0]);
        dv.copy_from_slice(&[0.0, -2.0 * q[0] * v[1], 2.0 * q[0] * v[1], 2.0 * q[0] * v[0]]);
    });
    toy
}

/// Steady turning: r = k r₀/(k − Ω²), and small motions about it have ω² = k + 3Ω².
#[test]
fn steady_turning_is_an_equilibrium_of_the_other_coordinates() {
    let (k, r0, spin) = (4.0, 1.0, 1.0);
    let tube = turning_tube(k, r0);
    let found = equilibrium_near(&tube, &Guess { v: vec![0.0, spin], ..Guess::at(&[1.0, 0.5]) }).unwrap();
    close(found.q[0], k * r0 / (k - spin * spin), 1e-14);
    assert_eq!((found.q[1], found.v[1], found.freedom.family), (0.5, spin, 1));
    let small = linearise(&tube, &found).unwrap();
    let r = found.q[0];
    assert_eq!(small.gyroscopic().to_dense(), dmatrix![0.0, -2.0 * r * spin; 2.0 * r * spin, 0.0]);
    assert!(small.dissipative().is_zero());
    close(small.k()[(0, 0)], k - spin * spin, 1e-15);
    // A displaced r goes on as Δ cos ωt about the radius that its own momentum wants; z = e^(At) z₀ with A(t).
    let a = state_matrix(&tube, 0.0, &found.q, &found.v).unwrap();
    close((&a - small.state_matrix().unwrap()).amax(), 0.0, 1e-14);
    #[cfg(feature = "modal")]
    {
        let modes = complex_modes(&small).unwrap().modes;
        assert_eq!(modes.iter().map(|m| m.kind).collect::<Vec<_>>(), [Kind::Rigid, Kind::Oscillating]);
        close(modes[1].omega, (k + 3.0 * spin * spin).sqrt(), 1e-13);
    }
    let refused = equilibrium_near(&tube, &Guess { v: vec![0.1, spin], ..Guess::at(&[1.0, 0.0]) });
    assert_eq!(refused.unwrap_err(), LinearError::NotSteady { coordinate: "r".into() });
}

/// θ'' = Ω² sin θ cos θ − sin θ: a bead on a hoop that turns at Ω, critical at Ω = 1.
fn hoop(spin: f64) -> Toy {
    let mut toy = Toy::new(&["theta"], (&[0.0], &[0.0]), 1.0, move |_, q, _, _, a| {
        a[0] = spin * spin * q[0].sin() * q[0].cos() - q[0].sin();
    });
    toy.jacobian = Arc::new(move |q, _, _, dq, dv| {
        dq[0] = q[0].cos() - spin * spin * (2.0 * q[0]).cos();
        dv[0] = 0.0;
    });
    toy
}

/// Catalogue L15: above Ω_c the bottom is unstable and ω = Ω sin θ*; at 1.001 Ω_c ω is 0.0632 (of √(g/R)).
#[test]
fn l15_pitchfork_of_the_bead_on_a_hoop() {
    for (spin, expected) in [(1.001, 0.0632), (1.5, 1.3437)] {
        let bottom = equilibrium_here(&hoop(spin), &Guess::at(&[0.0])).unwrap();
        assert_eq!(linearise(&hoop(spin), &bottom).unwrap().modes().unwrap()[0].kind, Kind::Unstable);
        let aside = equilibrium_near(&hoop(spin), &Guess::at(&[1.0 / spin])).unwrap();
        let star = (1.0 / (spin * spin)).acos();
        close(aside.q[0].abs(), star, 1e-10);
        let mode = &linearise(&hoop(spin), &aside).unwrap().modes().unwrap()[0];
        close(mode.omega, spin * star.sin(), 1e-8);
        assert!((mode.omega - expected).abs() < 1e-4, "{}", mode.omega);
    }
}

/// Catalogue C15, on the hoop at Ω_c itself: a triple root.
#[test]
fn c15_the_hoop_at_its_critical_speed_is_degenerate() {
    let found = equilibrium_near(&hoop(1.0), &Guess::at(&[0.5])).unwrap();
    close(found.slow.unwrap(), 2.0 / 3.0, 1e-3);
    assert!(found.is_degenerate() && found.q[0].abs() < 1e-8);
}

/// Catalogue L14: the period beyond the linear model, T/T₀ = 1/agm(1, cos θ₀/2): a quarter of it leads to the bottom.
#[test]
fn l14_large_swings_are_slower() {
    for (degrees, ratio) in
        [(10.0, 1.0019072), (30.0, 1.0174088), (60.0, 1.0731820), (90.0, 1.1803406), (150.0, 1.7622037)]
    {
        let angle: f64 = f64::to_radians(degrees);
        let quarter = ratio * std::f64::consts::FRAC_PI_2;
        let mut toy = Toy::pendulum(1.0, angle, quarter);
        let settings = Settings { tolerance: 1e-12, watch: false, ..Settings::new(&toy.scene) };
        let end = simulate(&mut toy, &settings).unwrap().last();
        assert!((end.q[0] / end.v[0]).abs() < 1e-7 * quarter, "{degrees}: {}", end.q[0] / end.v[0]);
        let second_order = 1.0 + angle * angle / 16.0;
        assert!(degrees > 30.0 || (ratio - second_order).abs() < 11.0 / 3072.0 * angle.powi(4) * 1.1);
    }
}

/// A(t) along a large swing: δz' = A(t) δz is how neighbouring swings depart from it.
#[test]
fn departures_along_a_motion_follow_the_matrix_of_the_state() {
    let until = 5.0;
    let end = |shift: f64| {
        let mut toy = Toy::pendulum(1.0, 2.0 + shift, until);
        let settings = Settings { tolerance: 1e-13, watch: false, ..Settings::new(&toy.scene) };
        let run = simulate(&mut toy, &settings).unwrap();
        (run.last().q[0], run.last().v[0], run)
    };
    let (small, (_, _, run)) = (1e-5, end(0.0));
    let (high, low) = (end(small), end(-small));
    let expected = DVector::from_vec(vec![(high.0 - low.0) / (2.0 * small), (high.1 - low.1) / (2.0 * small)]);
    let toy = pendulum_with_derivatives();
    let matrix = |t: f64| {
        let state = run.at(t).unwrap();
        state_matrix(&toy, t, &state.q, &state.v).unwrap()
    };
    let (mut z, h) = (DVector::from_vec(vec![1.0, 0.0]), 0.005);
    for step in 0..1000 {
        let t = h * f64::from(step);
        let (first, middle, last) = (matrix(t), matrix(t + h / 2.0), matrix(t + h));
        let a = &first * &z;
        let b = &middle * (&z + &a * (h / 2.0));
        let c = &middle * (&z + &b * (h / 2.0));
        let d = &last * (&z + &c * h);
        z += (a + (b + c) * 2.0 + d) * (h / 6.0);
    }
    assert!((&z - &expected).amax() < 1e-7 * expected.amax(), "{z}{expected}");
    assert!(expected.amax() > 2.0, "a large swing's period depends on its amplitude");
}

/// θ'' = −sin θ.
fn pendulum_with_derivatives() -> Toy {
    let mut toy = Toy::new(&["theta"], (&[0.0], &[0.0]), 1.0, |_, q, _, _, a| a[0] = -q[0].sin());
    toy.jacobian = Arc::new(|q, _, _, dq, dv| {
        dq[0] = q[0].cos();
        dv[0] = 0.0;
    });
    toy
}

/// Lecture 25: M and K are the energies to second order.  For a linear mechanism they are so exactly.
#[test]
fn the_energies_to_second_order_give_the_same_matrices() {
    let m = dmatrix![2.25, -0.5; -0.5, 1.0];
    let k = dmatrix![20.0, 3.0; 3.0, 50.0];
    let system = LinearMechanism::new(m, dmatrix![0.0, 0.0; 0.0, 0.0], k).unwrap();
    let linear = linearise(&system, &equilibrium_near(&system, &Guess::at(&[0.0, 0.0])).unwrap()).unwrap();
    for x in [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.3, -0.7]] {
        let vector = DVector::from_column_slice(&x);
        let energy = system.energy(At::new(0.0, &x, &x));
        close(energy.kinetic, 0.5 * vector.dot(&(linear.m() * &vector)), 1e-15);
        close(energy.potential, 0.5 * vector.dot(&(linear.k() * &vector)), 1e-15);
    }
}

/// Problem 21 b: undamped, damped and measured frequency of x'' + c x' + k x = 0.
#[test]
fn problem_21_measured_frequency_and_decrement() {
    let mut oscillator = LinearMechanism::new(dmatrix![2.0], dmatrix![0.3], dmatrix![5.0]).unwrap();
    let rest = equilibrium_near(&oscillator, &Guess::at(&[0.0])).unwrap();
    let scene = crate::mechanism::Scene { q: vec![1.0], until: 30.0, tolerance: 1e-12, ..oscillator.scene(0) };
    let run = simulate(&mut oscillator, &Settings::new(&scene)).unwrap();
    let measured = measure(&run, "x[1]", 0.0).unwrap();
    let (omega, zeta) = (2.5_f64.sqrt(), 0.075 / 2.5_f64.sqrt());
    close(measured.omega(), omega, 1e-8);
    close(measured.zeta(), zeta, 1e-8);
    close(measured.damped_omega(), omega * (1.0 - zeta * zeta).sqrt(), 1e-8);
    assert!(measured.maxima > 5 && measure(&run, "y", 0.0).is_none());
    let linear = linearise(&oscillator, &rest).unwrap();
    #[cfg(feature = "modal")]
    close(linear.modes().unwrap()[0].damped_omega(), measured.damped_omega(), 1e-8);
    #[cfg(not(feature = "modal"))]
    assert_eq!(linear.modes().unwrap_err(), LinearError::NeedsFeature { feature: "modal" });
}
