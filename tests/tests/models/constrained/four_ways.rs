//! One file, several ways of enforcing its constraints, and what is done about drift.

use dalembert::mechanism::{Enforcement, Stabilisation};
use dalembert::{Error, Method, Run, Warning};
use dalembert_tests::case::Case;

use crate::near;

/// The pendulum of the catalogue: l = 1, g = 9.81, let go from an angle.
fn pendulum(angle: f64) -> Case {
    let case = Case::new("pendulum_cartesian").set("g", 9.81).start("x", angle.sin()).start("y", -angle.cos());
    case.start("x'", 0.0).start("y'", 0.0)
}

fn run(mut case: Case, enforcement: Enforcement, drift: Stabilisation) -> Run {
    (case.settings.enforcement, case.settings.stabilisation) = (enforcement, drift);
    case.run()
}

/// |c| and |c'| at the end of a run by RK4 without any correction.
fn drifted(step: f64, until: f64) -> (f64, f64) {
    let mut case = pendulum(std::f64::consts::FRAC_PI_2).until(until);
    (case.settings.step, case.settings.method) = (Some(step), Method::Rk4);
    let run = run(case, Enforcement::Multipliers, Stabilisation::None);
    let residuals = run.residuals.expect("constraints");
    (residuals.position, residuals.velocity)
}

/// D1 of the catalogue: without correction |c| grows like t² and |c'| like t, both like h⁴.
#[test]
fn d1_accelerations_alone_leave_the_constraint() {
    let slope = |a: f64, b: f64| (b / a).log2();
    let [(c10, v10), (c20, v20), (c40, v40)] = [10.0, 20.0, 40.0].map(|until| drifted(0.02, until));
    for (one, other) in [(c10, c20), (c20, c40)] {
        near(slope(one, other), 2.0, 0.15);
    }
    for (one, other) in [(v10, v20), (v20, v40)] {
        near(slope(one, other), 1.0, 0.15);
    }
    near(slope(drifted(0.01, 40.0).0, c40), 4.1, 0.2);
}

/// By projection it follows the angle's equation for 100 s, where without it the error is a hundred times larger.
#[test]
fn projection_keeps_a_pendulum_with_its_twin_in_an_angle() {
    let angle = 1.0;
    let twin = Case::new("simple_pendulum").set("g", 9.81).start("theta", angle).start("theta'", 0.0);
    let exact = twin.tolerance(1e-13).until(100.0).run().last()["theta"];
    let error = |drift| {
        let last = run(pendulum(angle).tolerance(1e-9).until(100.0), Enforcement::Multipliers, drift).last();
        (last["x"].atan2(-last["y"]) - exact).abs()
    };
    let (projected, free) = (error(Stabilisation::Project), error(Stabilisation::None));
    assert!(projected < 1e-5 && free > 20.0 * projected, "{projected:e} {free:e}");
}

/// D2 and D4: the gain must stay within the method's stability, 2/h for Euler's method and 2.785/h for RK4.
#[test]
fn d2_d4_too_large_a_gain_is_refused() {
    for (method, limit) in [(Method::Euler, 2.0), (Method::Rk4, 2.7852935634)] {
        for (part, accepted) in [(0.999, true), (1.001, false)] {
            let mut case = pendulum(1.0).until(0.1);
            (case.settings.step, case.settings.method) = (Some(0.01), method);
            case.settings.stabilisation = Stabilisation::Baumgarte { alpha: Some(part * limit / 0.01) };
            match case.try_run() {
                Ok(_) => assert!(accepted),
                Err(Error::BadSetting { setting, .. }) => assert!(!accepted && setting == "alpha"),
                Err(error) => panic!("{error}"),
            }
        }
    }
}

/// D4: the constraint is missed least at a gain far below that, about 0.06/h, which is the usual one.
#[test]
fn d4_a_gain_out_of_habit_costs_accuracy() {
    let missed = |alpha| {
        let mut case = pendulum(1.0).until(20.0);
        (case.settings.step, case.settings.method) = (Some(0.02), Method::Rk4);
        run(case, Enforcement::Multipliers, Stabilisation::Baumgarte { alpha }).residuals.expect("constraints").position
    };
    let usual = missed(None);
    assert!(usual < 0.5 * missed(Some(1.0)), "{usual:e}");
    assert!(usual < 0.3 * missed(Some(10.0)), "{usual:e}");
    assert!(usual < 0.03 * missed(Some(100.0)), "{usual:e}");
}

/// With error control the gain is found from the first steps.
#[test]
fn a_gain_that_is_found_holds_the_constraint() {
    let [found, none] = [Stabilisation::Baumgarte { alpha: None }, Stabilisation::None].map(|drift| {
        let run = run(pendulum(1.0).tolerance(1e-8).until(50.0), Enforcement::Multipliers, drift);
        (run.residuals.expect("constraints").position, run.work.evaluations as f64)
    });
    assert!(found.0 < 0.1 * none.0, "{found:?} {none:?}");
    assert!(found.1 < 1.1 * none.1, "{found:?} {none:?}");
}

/// The null space gives what multipliers give, reactions included.
#[test]
fn the_null_space_gives_the_same_motion_and_reactions() {
    for name in ["four_bar", "slider_crank", "chaplygin_sleigh", "rigid_triangle", "astronaut"] {
        let ways = [Enforcement::Multipliers, Enforcement::NullSpace];
        let [one, other] = ways.map(|way| run(Case::new(name).until(1.0), way, Stabilisation::Project).last());
        for (key, value) in one.entries() {
            near(other[key.as_str()], value, 1e-8 * (1.0 + value.abs()));
        }
        for (key, value) in one.outputs() {
            let value = value.expect("an output");
            near(other[key], value, 1e-7 * (1.0 + value.abs()));
        }
    }
    let mut rubbing = Case::new("stick_slip");
    rubbing.settings.enforcement = Enforcement::NullSpace;
    assert!(matches!(rubbing.try_run(), Err(Error::NeedsMultipliers)));
}

/// D12: a spring of stiffness k in the place of a rod is stretched by its load, 18.83/k where it swings through.
/// (c = x² + y² − l² changes by twice the stretch, and pulls by twice its gradient: 4 k to one of length.)
#[test]
fn d12_springs_miss_the_constraint_by_what_they_carry() {
    for (k, tolerance) in [(1e4, 1e-8), (1e6, 1e-9)] {
        let springs = Enforcement::Springs { stiffness: k / 4.0, damping: 2.0 * k.sqrt() / 4.0 };
        let run = run(pendulum(1.0).tolerance(tolerance).until(5.0), springs, Stabilisation::Project);
        let stretched = run.states().map(|state| state["x"].hypot(state["y"]) - 1.0).fold(0.0, f64::max);
        near(stretched, 18.83 / k, 0.02 * 18.83 / k);
        // What the springs hold is counted.
        assert!(run.energy_balance.is_some_and(|drift| drift < 1e-7), "{:?}", run.energy_balance);
    }
    for (stiffness, damping) in [(0.0, 0.0), (-1.0, 0.0), (1e4, -1.0), (f64::NAN, 0.0)] {
        let mut case = pendulum(1.0);
        case.settings.enforcement = Enforcement::Springs { stiffness, damping };
        assert!(matches!(case.try_run(), Err(Error::BadSetting { .. })), "{stiffness} {damping}");
    }
}

/// The stiffer the springs, the nearer the four-bar to the one with multipliers, like 1/k.
#[test]
fn springs_come_near_the_constraint_as_they_become_stiff() {
    let exact =
        run(Case::new("four_bar").until(1.0), Enforcement::Multipliers, Stabilisation::Project).last()["crank_angle"];
    let [soft, stiff] = [1e5, 1e6].map(|stiffness| {
        let springs = Enforcement::Springs { stiffness, damping: 2.0 * stiffness.sqrt() };
        let last = run(Case::new("four_bar").tolerance(1e-9).until(1.0), springs, Stabilisation::Project).last();
        (last["crank_angle"] - exact).abs()
    });
    near(soft / stiff, 10.0, 2.0);
}

/// A fixed step too coarse for the springs: the run says so with the step up to which it would hold, 2 √2/ω of RK4 with
/// ω² = 4 k/m, and loses the rod; within that it says nothing.
#[test]
fn a_fixed_step_too_coarse_for_springs_is_said_to_be() {
    let stiffness = 2.5e5;
    let bound = 8.0_f64.sqrt() / (4.0 * stiffness / 1.0_f64).sqrt();
    let told = |part: f64| {
        let mut case = pendulum(1.0).until(2.0);
        (case.settings.step, case.settings.method) = (Some(part * bound), Method::Rk4);
        (case.settings.enforcement, case.settings.stabilisation) =
            (Enforcement::Springs { stiffness, damping: 0.0 }, Stabilisation::Project);
        let tried = case.try_run();
        let (failed, run) = match tried {
            Ok(run) => (false, run),
            Err(Error::Run(failure)) => (true, failure.run),
            Err(error) => panic!("{error}"),
        };
        let limit = run.warnings.iter().find_map(|warning| match warning {
            Warning::StepExceedsStability { limit, .. } => Some(*limit),
            _ => None,
        });
        (failed, limit)
    };
    assert_eq!(told(0.9), (false, None));
    for part in [1.1, 3.0, 30.0] {
        let (failed, limit) = told(part);
        near(limit.expect("a warning") / bound, 1.0, 0.01);
        assert!(failed || part < 2.0, "{part}");
    }
}
