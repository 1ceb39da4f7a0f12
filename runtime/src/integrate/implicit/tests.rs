//! Coefficients, orders, stability, invariants over long times, and stiff motions.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::tableau::Tableau;
use super::{GAUSS_2, GAUSS_4, GAUSS_6, RADAU_5};
use crate::integrate::Stability;
use crate::integrate::test_problems::{
    fixed, invariants, kepler, orders, polar_pendulum, proportionality, run, spring_pendulum,
};
use crate::mechanism::Method;
use crate::testing::Toy;

const ALL: [(Method, &Tableau); 4] =
    [(Method::Gauss2, GAUSS_2), (Method::Gauss4, GAUSS_4), (Method::Gauss6, GAUSS_6), (Method::Radau5, RADAU_5)];

#[test]
fn coefficients_are_those_of_collocation() {
    for (method, tableau) in ALL {
        let s = tableau.stages();
        let c: Vec<f64> = tableau.nodes.iter().map(|c| c.value()).collect();
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{method}: {a}, {b}");
        for power in 0..tableau.order as usize {
            let moment = |weights: &dyn Fn(usize) -> f64| (0..s).map(|j| weights(j) * c[j].powi(power as i32)).sum();
            let (p, next) = (power as f64, power as i32 + 1);
            near(moment(&|j| tableau.speed_weights[j].value()), 1.0 / (p + 1.0));
            if power + 1 < tableau.order as usize {
                near(moment(&|j| tableau.place_weights[j].value()), 1.0 / ((p + 1.0) * (p + 2.0)));
            }
            for i in (0..s).filter(|_| power < s) {
                near(moment(&|j| tableau.speeds[i * s + j].value()), c[i].powi(next) / (p + 1.0));
            }
        }
        for i in 0..s {
            for j in 0..s {
                let square: f64 =
                    (0..s).map(|k| tableau.speeds[i * s + k].value() * tableau.speeds[k * s + j].value()).sum();
                near(square, tableau.places[i * s + j].value());
                let real = tableau.real.map_or(0.0, |(mu, right, dual)| mu * right[i] * dual[j]);
                let complex = tableau.complex.map_or(0.0, |(mu, right, dual)| 2.0 * (mu * right[i] * dual[j]).re);
                assert!((real + complex - tableau.speeds[i * s + j].value()).abs() < 1e-14, "{method}");
            }
        }
        let all =
            [tableau.nodes, tableau.speeds, tableau.places, tableau.speed_weights, tableau.place_weights].concat();
        assert!(all.iter().all(|c| (c.0 * 1_048_576.0).fract() == 0.0 && c.1.abs() < 1e-6), "{method}");
    }
}

#[test]
fn gauss_is_symplectic_b14() {
    // bᵢaᵢⱼ + bⱼaⱼᵢ = bᵢbⱼ (Sanz-Serna 1988).
    for (_, tableau) in &ALL[..3] {
        let s = tableau.stages();
        let (b, a) =
            (|i: usize| tableau.speed_weights[i].value(), |i: usize, j: usize| tableau.speeds[i * s + j].value());
        for i in 0..s {
            for j in 0..s {
                assert!((b(i) * a(i, j) + b(j) * a(j, i) - b(i) * b(j)).abs() < 1e-16);
            }
        }
    }
}

#[test]
fn errors_fall_with_the_order_of_the_method_and_of_its_dense_output() {
    for ((method, tableau), (coarse, dense)) in ALL.into_iter().zip([(0.02, 2.0), (0.1, 4.0), (0.2, 6.0), (0.1, 4.0)]) {
        let ([ends, between], errors) = orders(&polar_pendulum(4.0, 4.0), method, coarse);
        let order = f64::from(tableau.order);
        assert!((ends - order).abs() < 0.2, "{method}: {ends}, errors {errors:?}");
        assert!(between > dense - 0.4, "{method}: dense {between}, errors {errors:?}");
    }
}

#[test]
fn errors_of_radau_are_proportional_to_the_tolerance() {
    let (slope, points) = proportionality(&polar_pendulum(4.0, 10.0), Method::Radau5, 3..=11);
    assert!((0.7..1.3).contains(&slope), "{slope}, {points:?}");
}

#[test]
fn stability_functions_are_those_of_the_catalogue_a4() {
    let size = |method: usize, z: Complex<f64>| Stability::Rational(ALL[method].1.stability).amplification(z);
    for gauss in 0..3 {
        for y in [0.1, 1.0, 10.0, 1e3] {
            assert!((size(gauss, Complex::new(0.0, y)) - 1.0).abs() < 1e-12);
        }
    }
    let radau = |y: f64| size(3, Complex::new(0.0, y));
    assert!((radau(1.0) - 0.999_869).abs() < 1e-6 && (radau(10.0) - 0.321_4).abs() < 1e-4);
    assert!((radau(0.1) - (1.0 - 1.4e-10)).abs() < 1e-11);
    assert!(size(3, Complex::new(-1e9, 0.0)) < 1e-8);
    // False stability: what grows by itself decays.
    assert!(size(3, Complex::new(11.83, 0.0)) > 1.0 && size(3, Complex::new(11.85, 0.0)) < 1.0);
}

#[test]
fn steps_multiply_a_vibration_by_the_stability_function_a6() {
    for (method, tableau) in ALL {
        for y in [0.5, 100.0] {
            let last = run(Toy::oscillator(1.0, 1000.0 * y), fixed(method, y)).last();
            let expected = Stability::Rational(tableau.stability).amplification(Complex::new(0.0, y)).powi(1000);
            let found = last["x"].hypot(last["x'"]);
            assert!((found - expected).abs() < 1e-9, "{method}, {y}: {found}, {expected}");
        }
    }
}

#[test]
fn the_energy_of_gauss_stays_bounded_without_separable_equations_b2() {
    let h = 0.1;
    for (method, bound) in [(Method::Gauss2, 3e-3), (Method::Gauss4, 1e-6), (Method::Gauss6, 1e-9)] {
        let worst = |until: f64| {
            let mut toy = polar_pendulum(4.0, until);
            toy.scene.every = Some(h);
            let run = run(toy.clone(), fixed(method, h));
            let energy = |row: &[f64]| (toy.energy)(0.0, &row[..2], &row[2..]);
            let all: Vec<f64> =
                run.rows.chunks_exact(4).map(|row| energy(row).kinetic + energy(row).potential).collect();
            all.iter().fold(0.0_f64, |most, e| most.max((e - all[0]).abs()))
        };
        let (short, long) = (worst(100.0), worst(2000.0));
        assert!(long < 1.5 * short && long < bound, "{method}: {short}, {long}");
    }
}

#[test]
fn rounding_makes_the_energy_of_kepler_walk_at_random_r6() {
    // e = 0.6, 1000 periods: Brouwer's law.
    let h = TAU / 150.0;
    let mut toy = kepler(0.6, 1000.0 * TAU);
    toy.scene.every = Some(TAU);
    let run = run(toy, fixed(Method::Gauss6, h));
    let errors: Vec<f64> = run.rows.chunks_exact(4).map(|row| invariants(row)[0] + 0.5).collect();
    let momenta: Vec<f64> = run.rows.chunks_exact(4).map(|row| invariants(row)[1] - 0.8).collect();
    let rms = |list: &[f64]| (list.iter().map(|e| e * e).sum::<f64>() / list.len() as f64).sqrt();
    // A walk of 150 000 steps of half a rounding each would come to 2e-14; compensated sums make the steps smaller.
    let (early, late) = (rms(&errors[1..101]), rms(&errors[900..]));
    assert!(late < 1e-14 && late < 10.0 * early.max(5e-16), "{early:e}, {late:e}");
    assert!(rms(&momenta[900..]) < 1e-14, "{:e}", rms(&momenta[900..]));
}

/// A pendulum on a spring that carries its weight at the start, so that it hardly vibrates.
fn loaded(k: f64, until: f64) -> Toy {
    let mut toy = spring_pendulum(k, 1.0, 0.0, until);
    toy.scene.q.iter_mut().for_each(|q| *q *= 1.0 + 9.81 * 1.0_f64.cos() / k);
    toy
}

#[test]
fn radau_steps_over_what_a_stiff_spring_does_not_do_a5() {
    let steps = |k: f64, method: Method| {
        let run = run(loaded(k, 2.0), |settings| (settings.method, settings.tolerance) = (method, 1e-6));
        let exact = run_exact(&loaded(k, 2.0));
        let error = (run.last()["x"] - exact[0]).hypot(run.last()["y"] - exact[1]);
        assert!(error < 1e-4, "{method}, k = {k:e}: {error:e}");
        run.work
    };
    let (soft, stiff) = (steps(1e4, Method::Radau5), steps(1e6, Method::Radau5));
    let (soft_explicit, stiff_explicit) = (steps(1e4, Method::Dopri5), steps(1e6, Method::Dopri5));
    assert!(stiff.steps < 3 * soft.steps, "{soft:?}, {stiff:?}");
    assert!(stiff_explicit.steps > 5 * soft_explicit.steps, "{soft_explicit:?}, {stiff_explicit:?}");
    assert!(6 * stiff.steps < stiff_explicit.steps, "{stiff:?}, {stiff_explicit:?}");
}

#[test]
fn what_falls_at_its_terminal_speed_is_solved_though_accelerations_vanish() {
    for (c, drag) in [(0.5, 1), (0.5, 2), (40.0, 1)] {
        let mut toy = Toy::new(&["y"], (&[1.0], &[0.0]), 100.0, move |_, _, v, _, a| {
            a[0] = -9.81 - c * v[0] * v[0].abs().powi(drag - 1);
        });
        toy.jacobian = std::sync::Arc::new(move |_, v, _, dq, dv| {
            (dq[0], dv[0]) = (0.0, c * f64::from(drag) * v[0].abs().powi(drag - 1));
        });
        let terminal = -(9.81 / c).powf(1.0 / f64::from(drag));
        for method in [Method::Gauss2, Method::Gauss4, Method::Gauss6] {
            let last = run(toy.clone(), fixed(method, 0.01)).last();
            assert!((last["y'"] / terminal - 1.0).abs() < 1e-14, "{method}, {c}, {drag}: {last:?}");
        }
    }
}

fn run_exact(toy: &Toy) -> [f64; 2] {
    let last = run(toy.clone(), |settings| settings.tolerance = 1e-12).last();
    [last["x"], last["y"]]
}

#[test]
fn a_wrong_jacobian_is_told_not_believed_b18() {
    // With the sign of the stiffness wrong the iteration diverges: a step too long for it is refused.
    let mut toy = Toy::oscillator(1.0, 10.0);
    toy.jacobian = std::sync::Arc::new(|_, _, _, dq, dv| (dq[0], dv[0]) = (-4.0, 0.0));
    let settings = crate::Settings { method: Method::Gauss2, step: Some(1.0), ..crate::Settings::new(&toy.scene) };
    let error = crate::simulate::simulate(&mut toy, &settings).unwrap_err();
    assert!(matches!(error.cause(), Some(crate::Cause::IterationStalled { .. })), "{error}");
}

/// v' = λ(v − cos t) − sin t, v = cos t whatever λ.
fn prothero_robinson(lambda: f64) -> Toy {
    let mut toy = Toy::new(&["x"], (&[0.0], &[1.0]), 1.0, move |t, _, v, _, a| {
        a[0] = lambda * (v[0] - t.cos()) - t.sin();
    });
    toy.jacobian = std::sync::Arc::new(move |_, _, _, dq, dv| (dq[0], dv[0]) = (0.0, -lambda));
    toy.description.structure.time_dependent = true;
    toy
}

#[test]
fn stiff_decay_lowers_the_order_b10() {
    for (method, mild, stiff) in
        [(Method::Gauss2, 2.0, 2.0), (Method::Gauss4, 4.0, 2.0), (Method::Gauss6, 6.0, 4.0), (Method::Radau5, 5.0, 3.0)]
    {
        let order = |lambda: f64, step: f64| {
            let errors = [step, step / 2.0].map(|step| {
                let last = run(prothero_robinson(lambda), fixed(method, step)).last();
                (last["x'"] - 1.0_f64.cos()).abs()
            });
            ((errors[0] / errors[1]).log2(), errors)
        };
        let (found, errors) = order(-1.0, 0.25);
        assert!((found - mild).abs() < 0.3, "{method}: {found}, {errors:?}");
        let (found, errors) = order(-1e6, 0.05);
        assert!((found - stiff).abs() < 0.3, "{method}: stiff {found}, {errors:?}");
    }
}

#[test]
fn radau_damps_a_vibration_little_at_a_tolerance_a7() {
    let last = run(Toy::oscillator(1.0, 1000.0), |settings| {
        (settings.method, settings.tolerance) = (Method::Radau5, 1e-6);
    })
    .last();
    let lost = 1.0 - last["x"].powi(2) - last["x'"].powi(2);
    assert!(lost > 0.0 && lost < 2e-4, "{lost:e}");
}
