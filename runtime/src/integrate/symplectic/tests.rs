//! Orders, stability limits, and what becomes of invariants over long times.

use nalgebra::Complex;

use super::{KAHAN_LI_8, SRKN4, SUZUKI_4, Splitting, VERLET};
use crate::integrate::Stability;
use crate::integrate::test_problems::{fixed, invariants, kepler, proportionality, run};
use crate::mechanism::Method;
use crate::run::Run;
use crate::simulate::simulate;
use crate::testing::Toy;
use crate::{Error, Inseparable, Settings};

const ALL: [(Method, &Splitting); 4] =
    [(Method::Verlet, VERLET), (Method::Srkn4, SRKN4), (Method::Suzuki4, SUZUKI_4), (Method::KahanLi8, KAHAN_LI_8)];

/// The largest departures of energy and angular momentum from the start up to each of these times.
fn departures(run: &Run, times: &[f64]) -> Vec<[f64; 2]> {
    let rows: Vec<[f64; 2]> = run.rows.chunks_exact(4).map(invariants).collect();
    let worst = |until: f64, k: usize| {
        let until = run.times.iter().take_while(|t| **t <= until).count();
        rows[..until].iter().fold(0.0_f64, |most, row| most.max((row[k] - rows[0][k]).abs()))
    };
    times.iter().map(|t| [worst(*t, 0), worst(*t, 1)]).collect()
}

#[test]
fn coefficients_are_palindromes_of_sum_one() {
    for (method, scheme) in ALL {
        for list in [scheme.kicks, scheme.drifts] {
            assert!((list.iter().sum::<f64>() - 1.0).abs() < 1e-15, "{method}");
            assert!(list.iter().eq(list.iter().rev()), "{method}");
        }
    }
}

#[test]
fn errors_fall_with_the_order_of_the_method_and_of_its_dense_output() {
    let exact = {
        let mut toy = kepler(0.3, 5.0);
        let settings = Settings { tolerance: 1e-14, longest_step: Some(0.02), ..Settings::new(&toy.scene) };
        simulate(&mut toy, &settings).unwrap()
    };
    for ((method, scheme), coarse) in ALL.into_iter().zip([0.01, 0.04, 0.04, 0.2]) {
        let errors = [coarse, coarse / 2.0].map(|step| {
            let run = run(kepler(0.3, 5.0), |settings| {
                (settings.method, settings.step, settings.dense) = (method, Some(step), true);
            });
            let error = |t: f64| {
                let (found, exact) = (run.at(t).unwrap(), exact.at(t).unwrap());
                ["x", "y", "x'", "y'"].iter().map(|name| (found[*name] - exact[*name]).powi(2)).sum::<f64>().sqrt()
            };
            let worst = |times: &mut dyn Iterator<Item = f64>| times.map(error).fold(0.0, f64::max);
            let at_ends = worst(&mut (1..=12).map(|k| 0.4 * f64::from(k)));
            (at_ends, worst(&mut (1..240).map(|k| 0.02 * f64::from(k) - 0.007)))
        });
        let order = f64::from(scheme.order);
        let (observed, between) = ((errors[0].0 / errors[1].0).log2(), (errors[0].1 / errors[1].1).log2());
        assert!((observed - order).abs() < 0.2, "{method}: {observed}, errors {errors:?}");
        assert!((between - order).abs() < 0.5, "{method}: dense {between}, errors {errors:?}");
    }
}

#[test]
fn stability_limits_are_those_of_the_catalogue_a3() {
    for ((method, scheme), limit) in ALL.into_iter().zip([2.0, 3.163, 2.721, 3.096]) {
        let stability = Stability::Splitting(scheme);
        let stable = |y: f64| stability.amplification(Complex::new(0.0, y)) <= 1.0 + 1e-7;
        let first = (1..6000).map(|k| 1e-3 * f64::from(k)).find(|y| !stable(*y)).expect("a limit");
        assert!((first - limit).abs() < 2e-3, "{method}: {first}");
    }
}

#[test]
fn steps_inside_the_limit_stay_bounded_and_outside_grow_a4() {
    let amplitude = |h: f64, steps: f64| {
        let last = run(Toy::oscillator(1.0, h * steps), fixed(Method::Verlet, h)).last();
        last["x"].hypot(last["x'"])
    };
    assert!(amplitude(1.98, 1e4) < 11.0);
    assert!(amplitude(2.02, 100.0) > 1e6);
}

#[test]
fn verlet_grows_as_it_should_along_an_unstable_mode_a9() {
    // x'' = x from x = x' = 1: the discrete rate is (2/h) asinh(h/2).
    let mut toy = Toy::new(&["x"], (&[1.0], &[1.0]), 20.0, |_, q, _, _, a| a[0] = q[0]).separable();
    toy.scene.every = Some(1.0);
    let run = run(toy, fixed(Method::Verlet, 1.0));
    let x: Vec<f64> = run.rows.chunks_exact(2).map(|row| row[0]).collect();
    assert!(((x[20] / x[19]).ln() - 2.0 * 0.5_f64.asinh()).abs() < 1e-8);
}

#[test]
fn the_energy_of_verlet_stays_in_its_band_b1() {
    // The oscillator from rest: E between E₀(1 − y²/4) and E₀.
    for y in [0.1, 0.5] {
        let mut toy = Toy::oscillator(1.0, 2e4 * y);
        toy.scene.every = Some(y);
        let run = run(toy, fixed(Method::Verlet, y));
        let energy = |row: &[f64]| row[0] * row[0] + row[1] * row[1];
        let least = run.rows.chunks_exact(2).map(energy).fold(1.0, f64::min);
        let most = run.rows.chunks_exact(2).map(energy).fold(0.0, f64::max);
        assert!((1.0 - least - 0.25 * y * y).abs() < 1e-6 && (most - 1.0).abs() < 1e-10, "{y}: {least}, {most}");
    }
}

#[test]
fn energy_stays_bounded_where_rk4_drifts_b2_b14() {
    let h = std::f64::consts::TAU / 400.0;
    let ends = [10.0, 100.0, 1000.0].map(|orbits| orbits * std::f64::consts::TAU);
    let along = |method: Method| {
        let mut toy = kepler(0.5, 1000.0 * std::f64::consts::TAU + h);
        toy.scene.every = Some(h);
        departures(&run(toy, fixed(method, h)), &ends)
    };
    let rk4 = along(Method::Rk4);
    for pair in rk4.windows(2) {
        let slope = (pair[1][0] / pair[0][0]).log10();
        assert!((slope - 1.0).abs() < 0.08, "{rk4:?}");
    }
    for (method, _) in ALL {
        let found = along(method);
        let slope = (found[2][0] / found[0][0]).log10() / 2.0;
        assert!(slope.abs() < 0.05 || found[2][0] < 1e-12, "{method}: {found:?}");
        assert!(found[2][1] < 1e-12, "{method}: angular momentum {found:?}");
    }
}

#[test]
fn the_motion_runs_back_to_its_start_b13() {
    let there_and_back = |method: Method| {
        let there = run(Toy::pendulum(1.0, 2.0, 100.0), fixed(method, 0.1)).last();
        let mut toy = Toy::pendulum(1.0, 2.0, 100.0);
        (toy.scene.q[0], toy.scene.v[0]) = (there["theta"], -there["theta'"]);
        let back = run(toy, fixed(method, 0.1)).last();
        (back["theta"] - 2.0).hypot(back["theta'"])
    };
    for (method, _) in ALL {
        assert!(there_and_back(method) < 1e-12, "{method}: {}", there_and_back(method));
    }
    assert!(there_and_back(Method::Rk4) > 1e-6);
}

#[test]
fn resonances_of_the_step_destroy_small_motions_b5() {
    // x'' = −x − x²: at hω = √3 three steps make a cycle.
    let bounded = |h: f64, start: f64| {
        let toy = Toy::new(&["x"], (&[start], &[0.0]), 3e4 * h, |_, q, _, _, a| a[0] = -q[0] - q[0] * q[0]).separable();
        let mut toy = toy;
        let settings = Settings {
            method: Method::Verlet,
            step: Some(h),
            dense: false,
            watch: false,
            every: Some(1e3),
            ..Settings::new(&toy.scene)
        };
        simulate(&mut toy, &settings).is_ok_and(|run| run.rows.iter().all(|x| x.abs() < 10.0))
    };
    assert!(bounded(1.0, 0.4) && !bounded(3.0_f64.sqrt(), 1e-3));
}

#[test]
fn what_is_not_separable_is_refused_with_the_reason_b16() {
    let reason = |mut toy: Toy, method: Method| {
        let settings = Settings { method, step: Some(0.1), ..Settings::new(&toy.scene) };
        match simulate(&mut toy, &settings) {
            Err(Error::NotSeparable { reason, .. }) => Some(reason),
            _ => None,
        }
    };
    for (method, _) in ALL {
        let varying = Toy::oscillator(1.0, 1.0).mass(|_, _| vec![1.0]);
        assert_eq!(reason(varying, method), Some(Inseparable::MassMatrix));
        let unknown = Toy::new(&["x"], (&[1.0], &[0.0]), 1.0, |_, q, v, _, a| a[0] = -q[0] - v[0]);
        assert_eq!(reason(unknown, method), Some(Inseparable::Speeds));
        assert_eq!(reason(Toy::oscillator(1.0, 1.0), method), None);
    }
}

#[test]
fn the_work_of_an_input_has_the_order_of_the_method() {
    // x'' = −x + sin 2t: the balance T + V − ∫ x' sin 2t dt is constant.
    for ((method, scheme), coarse) in ALL.into_iter().zip([0.02, 0.1, 0.1, 0.4]) {
        let drifts = [coarse, coarse / 2.0].map(|step| {
            let mut toy = Toy::new(&["x"], (&[1.0], &[0.3]), 8.0, |t, q, _, _, a| a[0] = -q[0] + (2.0 * t).sin())
                .energy(|t, q, v| [0.5 * v[0] * v[0], 0.5 * q[0] * q[0], v[0] * (2.0 * t).sin()])
                .separable();
            toy.description.structure.conservative = false;
            run(toy, |settings| {
                (settings.method, settings.step, settings.watch) = (method, Some(step), true);
            })
            .energy_balance
            .unwrap()
            .abs()
        });
        let observed = (drifts[0] / drifts[1]).log2();
        assert!((observed - f64::from(scheme.order)).abs() < 0.4, "{method}: {observed}, {drifts:?}");
    }
}

#[test]
fn steps_that_are_found_make_errors_proportional_to_the_tolerance() {
    for (method, powers) in [
        (Method::Verlet, 2..=6),
        (Method::Srkn4, 3..=9),
        (Method::Suzuki4, 3..=9),
        (Method::KahanLi8, 4..=11),
        (Method::Gauss2, 2..=6),
        (Method::Gauss4, 3..=9),
        (Method::Gauss6, 3..=11),
    ] {
        let (slope, points) = proportionality(&kepler(0.3, 30.0), method, powers);
        assert!((0.7..1.3).contains(&slope), "{method}: {slope}, {points:?}");
        assert!(points.iter().all(|[tolerance, error]| *error < 100.0 * tolerance), "{method}: {points:?}");
    }
}
