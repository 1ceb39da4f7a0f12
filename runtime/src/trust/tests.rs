use crate::cause::Cause;
use crate::error::Error;
use crate::mechanism::Method;
use crate::mechanism::Quantity;
use crate::run::Run;
use crate::simulate::{Settings, simulate};
use crate::testing::Toy;
use crate::trust::Warning;

fn run(mut toy: Toy, change: impl FnOnce(&mut Settings)) -> Result<Run, Error> {
    let mut settings = Settings::new(&toy.scene);
    change(&mut settings);
    simulate(&mut toy, &settings)
}

const G: f64 = 9.81;

/// A pendulum by its horizontal position s: T = s'²/(2(1 − s²)), V = −g√(1 − s²).
fn sideways(s: f64, speed: f64, until: f64) -> Toy {
    Toy::new(&["s"], (&[s], &[speed]), until, |_, q, v, _, a| {
        let c = 1.0 - q[0] * q[0];
        a[0] = -q[0] * v[0] * v[0] / c - G * q[0] * c.sqrt();
    })
    .mass(|_, q| vec![1.0 / (1.0 - q[0] * q[0])])
    .energy(|_, q, v| {
        let c = 1.0 - q[0] * q[0];
        [0.5 * v[0] * v[0] / c, -G * c.sqrt(), 0.0]
    })
}

/// The same by its height y = −cos θ, released at 1 rad.
fn upright() -> Toy {
    Toy::new(&["y"], (&[-1.0_f64.cos()], &[0.0]), 2.0, |_, q, v, _, a| {
        let c = 1.0 - q[0] * q[0];
        a[0] = -q[0] * v[0] * v[0] / c - G * c;
    })
    .mass(|_, q| vec![1.0 / (1.0 - q[0] * q[0])])
    .energy(|_, q, v| [0.5 * v[0] * v[0] / (1.0 - q[0] * q[0]), G * q[0], 0.0])
}

/// Every method, with settings that are usual for it.
const USUAL: [(Method, Option<f64>, f64); 6] = [
    (Method::Dop853, None, 1e-4),
    (Method::Dop853, None, 1e-8),
    (Method::Dop853, None, 1e-12),
    (Method::Dopri5, None, 1e-8),
    (Method::Rk4, Some(0.01), 1.0),
    (Method::Midpoint, Some(0.001), 1.0),
];

#[test]
fn a_pendulum_by_its_horizontal_position_ends_at_the_horizontal_c1() {
    let thrown_to_120_degrees = (2.0 * G * 1.5).sqrt();
    for (method, step, tolerance) in USUAL {
        let toy = sideways(0.0, thrown_to_120_degrees, 2.0);
        let error = run(toy, |s| (s.method, s.step, s.tolerance) = (method, step, tolerance)).unwrap_err();
        let Some(Cause::CoordinateSingularity { coordinate, t }) = error.cause() else { panic!("{method}: {error}") };
        assert_eq!(coordinate, "s");
        assert!((t - 0.344_261).abs() < 1e-3, "{method} at {tolerance}: {t}");
        let run = error.partial().unwrap();
        assert!(run.last().t > 0.3 && run.last().t < *t && run.last()["s"] > 0.9);
    }
}

#[test]
fn a_pendulum_by_its_height_ends_at_the_bottom_c2() {
    for (method, step, tolerance) in USUAL {
        let error = run(upright(), |s| (s.method, s.step, s.tolerance) = (method, step, tolerance)).unwrap_err();
        let Some(Cause::CoordinateSingularity { t, .. }) = error.cause() else { panic!("{method}: {error}") };
        assert!((t - 0.534_784).abs() < f64::max(1e-3, 100.0 * tolerance), "{method} at {tolerance}: {t}");
    }
}

#[test]
fn a_pendulum_by_its_horizontal_position_swings_legally_below_the_horizontal_c1() {
    let by_angle = run(Toy::pendulum(G, 1.0, 50.0), |s| s.tolerance = 1e-12).unwrap();
    for degrees in [57.295_779_513_082_32, 85.0] {
        let swing = run(sideways(f64::to_radians(degrees).sin(), 0.0, 50.0), |s| s.tolerance = 1e-11).unwrap();
        assert!(swing.warnings.is_empty(), "{:?}", swing.warnings);
        if degrees < 60.0 {
            let error = swing.last()["s"] - by_angle.last()["theta"].sin();
            assert!(error.abs() < 1e-7, "{error:e}");
        }
    }
    let coarse = run(sideways(1.0_f64.sin(), 0.0, 20.0), |s| (s.method, s.step) = (Method::Rk4, Some(0.02))).unwrap();
    assert!(coarse.warnings.is_empty(), "{:?}", coarse.warnings);
}

#[test]
fn inertia_that_grows_without_end_but_not_in_finite_time_is_legal() {
    // A free particle in polar coordinates, passing the origin at a distance of 10⁻³: r² grows by 10¹⁰.
    let toy = Toy::new(&["r", "phi"], (&[1e-3, 0.0], &[0.0, 1e3]), 100.0, |_, q, v, _, a| {
        a[0] = q[0] * v[1] * v[1];
        a[1] = -2.0 * v[0] * v[1] / q[0];
    })
    .mass(|_, q| vec![1.0, q[0] * q[0]])
    .energy(|_, q, v| [0.5 * (v[0] * v[0] + (q[0] * v[1]).powi(2)), 0.0, 0.0]);
    let run = run(toy, |s| s.tolerance = 1e-12).unwrap();
    assert!((run.last()["r"] - 100.0).abs() < 1e-6, "{:?}", run.last());
}

/// The warnings of a run at a fixed step.
fn warnings(toy: Toy, method: Method, step: f64) -> Vec<Warning> {
    run(toy, |s| (s.method, s.step) = (method, Some(step))).unwrap().warnings
}

#[test]
fn a_method_that_amplifies_vibrations_is_named_a1_a2() {
    for (method, growth) in [(Method::Euler, 144.77), (Method::Midpoint, 1.012_578_29)] {
        let found = warnings(Toy::oscillator(1.0, 100.0), method, 0.1);
        let Some(Warning::StepExceedsStability { growth: predicted, limit, imaginary, .. }) = found.first() else {
            panic!("{method}: {found:?}")
        };
        assert!((predicted / growth - 1.0).abs() < 1e-4, "{method}: {predicted}");
        assert!(*limit < 1e-3 && *imaginary == 1.0);
    }
}

#[test]
fn stability_is_checked_along_the_motion() {
    // A pendulum from near the top, where it is unstable itself; below it vibrates, and Euler amplifies that.
    let mut toy = Toy::pendulum(G, 2.5, 10.0);
    toy.jacobian = std::sync::Arc::new(|q, _, _, dq, _| dq[0] = G * q[0].cos());
    let exceeds = |warnings: &[Warning]| warnings.iter().any(|w| matches!(w, Warning::StepExceedsStability { .. }));
    assert!(exceeds(&warnings(toy.clone(), Method::Euler, 0.01)));
    assert!(!exceeds(&warnings(toy, Method::Rk4, 0.01)));
}

/// Of λ and −λ, which a step of a splitting multiplies together, one grows: that is the motion.
#[test]
fn what_grows_by_itself_is_not_the_fault_of_a_splitting() {
    let mut toy = Toy::pendulum(G, 3.0, 3.0).separable();
    toy.jacobian = std::sync::Arc::new(|q, _, _, dq, _| dq[0] = G * q[0].cos());
    for method in [Method::Verlet, Method::Srkn4, Method::KahanLi8, Method::Rkn8] {
        let found = warnings(toy.clone(), method, 0.01);
        assert!(!found.iter().any(|w| matches!(w, Warning::StepExceedsStability { .. })), "{method}: {found:?}");
    }
    let found = warnings(Toy::oscillator(1.0, 100.0).separable(), Method::Verlet, 2.05);
    assert!(found.iter().any(|w| matches!(w, Warning::StepExceedsStability { .. })), "{found:?}");
}

#[test]
fn the_amplitude_grows_as_predicted_a1_a2() {
    for (method, growth) in [(Method::Euler, 1.01_f64.powf(500.0)), (Method::Midpoint, 1.012_578_29)] {
        let run = run(Toy::oscillator(1.0, 100.0), |s| (s.method, s.step) = (method, Some(0.1))).unwrap();
        assert_eq!(run.work.steps, 1000);
        let amplitude = run.last()["x"].hypot(run.last()["x'"]);
        assert!((amplitude / growth - 1.0).abs() < 1e-8, "{method}: {amplitude}");
    }
}

#[test]
fn rk4_loses_the_energy_it_is_known_to_lose_a3() {
    for (step, steps, ratio) in [(0.1, 100_000, 0.998_614), (0.5, 10_000, 0.122_15)] {
        let toy = Toy::oscillator(1.0, step * f64::from(steps));
        let run = run(toy, |s| (s.method, s.step, s.dense) = (Method::Rk4, Some(step), false)).unwrap();
        assert_eq!(run.work.steps, steps as u64);
        let energy = run.last()["x"].powi(2) + run.last()["x'"].powi(2);
        assert!((energy - ratio).abs() < 5e-6, "{energy}");
        assert!(!run.warnings.iter().any(|w| matches!(w, Warning::StepExceedsStability { .. })));
        assert_eq!(ratio < 0.9, run.warnings.iter().any(|w| matches!(w, Warning::EnergyBudgetExceeded { .. })));
    }
}

#[test]
fn steps_beyond_the_stability_limit_are_warned_of_a4() {
    for (method, limit) in [(Method::Rk4, 2.828_43), (Method::Dopri5, 0.997_19), (Method::Dop853, 5.960_36)] {
        let below = warnings(Toy::oscillator(1.0, 1e4 * 0.99 * limit), method, 0.99 * limit);
        assert!(!below.iter().any(|w| matches!(w, Warning::StepExceedsStability { .. })), "{method}: {below:?}");
        let above = warnings(Toy::oscillator(1.0, 100.0 * 1.2 * limit), method, 1.2 * limit);
        let found = above.iter().find_map(|w| match w {
            Warning::StepExceedsStability { limit, .. } => Some(*limit),
            _ => None,
        });
        assert!((found.unwrap() - limit).abs() < 1e-4, "{method}: {found:?}");
    }
}

#[test]
fn physical_growth_is_no_instability() {
    // An inverted pendulum, linearised: x'' = x.
    let mut toy = Toy::new(&["x"], (&[1e-3], &[0.0]), 10.0, |_, q, _, _, a| a[0] = q[0]);
    toy.jacobian = std::sync::Arc::new(|_, _, _, dq, _| dq[0] = -1.0);
    for method in [Method::Euler, Method::Midpoint, Method::Rk4] {
        assert_eq!(warnings(toy.clone(), method, 0.01), []);
    }
}

#[test]
fn an_explicit_method_says_when_it_meets_stiffness_a5() {
    // A critically damped follower of cos t.
    let follower = |omega: f64| {
        Toy::new(&["x"], (&[1.0], &[0.0]), 10.0, move |t, q, v, _, a| {
            a[0] = -omega * omega * (q[0] - t.cos()) - 2.0 * omega * (v[0] + t.sin());
        })
    };
    for method in [Method::Dopri5, Method::Dop853] {
        let work = [1e1, 1e3, 1e4].map(|omega| {
            let run = run(follower(omega), |s| (s.method, s.tolerance) = (method, 1e-4)).unwrap();
            let stiff = run.warnings.iter().any(|w| matches!(w, Warning::Stiff { .. }));
            assert_eq!(stiff, omega > 500.0, "{method} at {omega}: {:?}", run.warnings);
            run.work.evaluations
        });
        assert!(work[1] > 5 * work[0] && work[2] > 5 * work[1], "{method}: {work:?}");
    }
}

#[test]
fn work_of_what_has_no_potential_is_balanced() {
    // A damped oscillator loses what the damper takes.
    let mut toy = Toy::new(&["x"], (&[1.0], &[0.0]), 20.0, |_, q, v, _, a| a[0] = -q[0] - 0.2 * v[0])
        .energy(|_, q, v| [0.5 * v[0] * v[0], 0.5 * q[0] * q[0], -0.2 * v[0] * v[0]]);
    toy.description.structure.conservative = false;
    let run = run(toy, |s| s.tolerance = 1e-11).unwrap();
    assert!(run.energy_balance.unwrap() < 1e-10, "{:?}", run.energy_balance);
    assert!(run.last()["x"].abs() < 0.2);
}

#[test]
fn an_energy_that_does_not_fit_the_motion_is_warned_of_a7() {
    let toy = Toy::oscillator(1.0, 20.0).energy(|_, q, v| [0.5 * v[0] * v[0], 0.6 * q[0] * q[0], 0.0]);
    let run = run(toy, |_| ()).unwrap();
    assert!(run.warnings.iter().any(|w| matches!(w, Warning::EnergyBudgetExceeded { .. })));
    assert!(run.trust().to_string().contains("energy budget exceeded"));
}

#[test]
fn drift_is_relative_to_the_largest_terms() {
    // Momentum of two unit masses that fly apart: 0 = 1 − 1, and its terms.
    let mut toy =
        Toy::new(&["x", "y"], (&[0.0, 0.0], &[1.0, -1.0]), 1.0, |_, _, _, _, a| a.copy_from_slice(&[1e-3, 0.0]));
    toy.description.invariants = vec![
        Quantity { name: "momentum".into(), components: 1, ..Quantity::default() },
        Quantity { name: "both".into(), components: 2, ..Quantity::default() },
        Quantity { name: "nothing".into(), components: 1, ..Quantity::default() },
    ]
    .into();
    toy.invariants = std::sync::Arc::new(|_, _, v, _, pairs| {
        pairs.copy_from_slice(&[v[0] + v[1], v[0].abs() + v[1].abs(), v[1], v[1].abs(), v[0], v[0].abs(), 0.0, 0.0]);
    });
    let run = run(toy, |_| ()).unwrap();
    let drift: Vec<f64> = run.drift.iter().map(|drift| drift.value.unwrap()).collect();
    assert!((drift[0] - 1e-3 / 2.001).abs() < 1e-15 && (drift[1] - 1e-3 / 1.001).abs() < 1e-15, "{drift:?}");
    assert_eq!(drift[2], 0.0);
}
