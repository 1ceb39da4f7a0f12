use std::ops::ControlFlow;

use super::*;
use crate::mechanism::Method;
use crate::testing::Toy;

/// Runs the toy's scene with changed settings.
fn run(mut toy: Toy, change: impl FnOnce(&mut Settings)) -> Result<Run, Error> {
    let mut settings = Settings::new(&toy.scene);
    change(&mut settings);
    simulate(&mut toy, &settings)
}

#[test]
fn an_oscillator_returns_after_ten_periods() {
    let until = 20.0 * std::f64::consts::PI;
    for (method, bound) in [(Method::Dopri5, 2e-6), (Method::Dop853, 2e-7)] {
        let run = run(Toy::oscillator(1.0, until), |s| s.method = method).unwrap();
        let last = run.last();
        assert_eq!(last.t, until);
        assert!((last["x"] - 1.0).abs() < bound && last["x'"].abs() < bound, "{method}: {last:?}");
        assert_eq!(run.len(), 501);
        for t in [0.0, 1.0, 2.5, 33.3, until] {
            let error = (run.at(t).unwrap()["x"] - t.cos()).abs();
            assert!(error < bound, "{method}: {error:e} at {t}");
        }
        assert!(run.at(-0.1).is_none() && run.at(until + 0.1).is_none());
        println!("{}", run.trust());
    }
}

#[test]
fn reported_states_lie_on_the_motion() {
    let run = run(Toy::oscillator(1.0, 10.0), |s| {
        s.every = Some(0.3);
        s.tolerance = 1e-11;
    })
    .unwrap();
    assert_eq!(run.len(), 35);
    for (t, x) in run.times().iter().zip(run.column("x").unwrap()) {
        assert!((x - t.cos()).abs() < 1e-9);
    }
    assert_eq!(run.last().t, 10.0);
}

#[test]
fn settings_without_meaning_are_refused() {
    let bad = |change: &dyn Fn(&mut Settings)| run(Toy::oscillator(1.0, 1.0), change).unwrap_err().to_string();
    assert_eq!(bad(&|s| s.step = Some(-0.1)), "`step` is -0.1; expected a positive number");
    assert_eq!(bad(&|s| s.until = -1.0), "`until` is -1; expected a time after the start");
    assert_eq!(bad(&|s| s.tolerance = 0.0), "`tolerance` is 0; expected a positive number");
    assert_eq!(bad(&|s| s.every = Some(f64::NAN)), "`every` is NaN; expected a positive number");
    assert_eq!(bad(&|s| s.q = vec![f64::INFINITY]), "`start` is inf; expected finite numbers");
    assert_eq!(bad(&|s| s.v = vec![]), "`start of the rates` has 0 numbers; the mechanism has 1 coordinate");
    assert_eq!(bad(&|s| s.method = Method::Euler), "`euler` needs a fixed step: give `step`");
    let unknown = Simulation::new(Toy::oscillator(1.0, 1.0)).scene("rear").run().unwrap_err();
    assert_eq!(unknown.to_string(), "no scene is called `rear`; there are `scene`");
    let unknown = Simulation::new(Toy::oscillator(1.0, 1.0)).starting("y'", 1.0).run().unwrap_err();
    assert_eq!(unknown.to_string(), "no coordinate is called `y'`; there are `x`");
}

#[test]
fn a_run_of_no_length_is_its_start() {
    let run = run(Toy::oscillator(1.0, 0.0), |_| ()).unwrap();
    assert_eq!((run.len(), run.last()["x"]), (1, 1.0));
}

#[test]
fn a_tolerance_below_rounding_is_clamped_and_said_r9() {
    let clamped = run(Toy::oscillator(1.0, 1.0), |s| s.tolerance = 1e-15).unwrap();
    assert_eq!(clamped.tolerance, Some(1e-14));
    assert_eq!(clamped.warnings, [Warning::ToleranceTooTight { asked: 1e-15, used: 1e-14 }]);
    assert!((clamped.last()["x"] - 1.0_f64.cos()).abs() < 1e-14);
    let error = run(Toy::oscillator(1.0, 1.0), |s| s.tolerance = 1e-17).unwrap_err();
    assert_eq!(error.cause(), Some(&Cause::ToleranceTooTight { asked: 1e-17, attainable: 1e-14 }));
    assert_eq!(error.partial().unwrap().len(), 1);
}

#[test]
fn too_many_steps_are_an_error_with_what_was_computed() {
    let error = run(Toy::oscillator(1.0, 100.0), |s| (s.method, s.step, s.max_steps) = (Method::Rk4, Some(0.1), 100));
    let error = error.unwrap_err();
    assert_eq!(error.cause(), Some(&Cause::TooManySteps { limit: 100 }));
    let partial = error.partial().unwrap();
    assert!((partial.last().t - 10.0).abs() < 1e-12);
    assert!((partial.last()["x"] - 10.0_f64.cos()).abs() < 1e-4);
}

#[test]
fn time_does_not_drift_at_a_fixed_step_r8() {
    let toy = Toy::new(&["x"], (&[0.0], &[0.0]), 1e5, |_, _, _, _, a| a[0] = 0.0);
    let run =
        run(toy, |s| (s.method, s.step, s.dense, s.every) = (Method::Euler, Some(0.1), false, Some(0.1))).unwrap();
    assert_eq!((run.work.steps, run.len()), (1_000_000, 1_000_001));
    let worst = run.times().iter().enumerate().map(|(n, t)| (t - n as f64 / 10.0).abs()).fold(0.0, f64::max);
    assert!(worst <= 1e-10, "{worst:e}");
}

#[test]
fn a_step_below_the_resolution_of_time_is_an_error_r3() {
    let error = run(Toy::oscillator(1.0, 0.0), |s| {
        (s.method, s.step, s.from, s.until) = (Method::Rk4, Some(1e-3), 1e15, 1e15 + 10.0);
    });
    assert_eq!(error.unwrap_err().cause(), Some(&Cause::StepBelowResolution { h: 1e-3 }));
}

#[test]
fn updates_at_a_fixed_step_are_compensated_r4() {
    // x'' = x' = x from 1: RK4's truncation is below 10⁻¹⁶ at 2¹⁴ steps; without compensation rounding would
    // leave some 10⁻¹⁴ to 10⁻¹³ at 2²⁰.
    let toy = Toy::new(&["x"], (&[1.0], &[1.0]), 1.0, |_, _, v, _, a| a[0] = v[0]);
    let h = (-20.0_f64).exp2();
    let run = run(toy, |s| (s.method, s.step, s.dense, s.watch) = (Method::Rk4, Some(h), false, false)).unwrap();
    let error = run.last()["x'"] - std::f64::consts::E;
    assert!(error.abs() < 1e-15, "{error:e}");
}

#[test]
fn rounding_alone_walks_at_random_r1() {
    // Euler on x' = x over [0, 1]: rounding is the distance to (1 + 1/n)ⁿ, some 1.3·ε·√n.
    let n = 1_u32 << 16;
    let square = |n: u32| {
        let toy = Toy::new(&["x"], (&[1.0], &[1.0]), 1.0, |_, _, v, _, a| a[0] = v[0]);
        let run = run(toy, |s| {
            (s.method, s.step, s.compensated) = (Method::Euler, Some(1.0 / f64::from(n)), false);
            (s.dense, s.watch) = (false, false);
        })
        .unwrap();
        assert_eq!(run.work.steps, u64::from(n));
        let exact = (f64::from(n) * (1.0 / f64::from(n)).ln_1p()).exp();
        (run.last()["x'"] - exact).powi(2)
    };
    let mean = ((n - 4..=n + 4).map(square).sum::<f64>() / 9.0).sqrt();
    let expected = 1.3 * 0.5 * f64::EPSILON * f64::from(n).sqrt();
    assert!(mean < 2.5 * expected && mean > expected / 2.5, "{mean:e}, expected {expected:e}");
}

#[test]
fn a_coordinate_without_inertia_is_named() {
    for start in [0.5, 0.0] {
        let toy = Toy::new(&["x", "y"], (&[0.0, start], &[0.0, -1.0]), 1.0, |_, _, _, _, a| a.fill(0.0))
            .mass(|_, q| vec![1.0, q[1].max(0.0)]);
        let error = run(toy, |s| (s.method, s.step) = (Method::Rk4, Some(0.1))).unwrap_err();
        match error.cause() {
            // From afar: y's inertia shrinks to nothing.
            Some(Cause::SingularMass { coordinate }) => assert_eq!(coordinate, "y"),
            other => panic!("{other:?}"),
        }
        assert!(error.to_string().contains("nothing gives `y` an inertia"), "{error}");
    }
}

#[test]
fn errors_are_proportional_to_the_tolerance() {
    let exact = run(Toy::pendulum(1.0, 2.0, 20.0), |s| s.tolerance = 1e-14).unwrap();
    for method in [Method::Dopri5, Method::Dop853] {
        let points: Vec<(f64, f64)> = (3..=11)
            .map(|k| {
                let tolerance = 10.0_f64.powi(-k);
                let run =
                    run(Toy::pendulum(1.0, 2.0, 20.0), |s| (s.method, s.tolerance) = (method, tolerance)).unwrap();
                let errors = (1..=200)
                    .map(|k| 0.1 * f64::from(k))
                    .map(|t| (run.at(t).unwrap()["theta"] - exact.at(t).unwrap()["theta"]).abs());
                (tolerance.log10(), errors.fold(0.0, f64::max).log10())
            })
            .collect();
        let n = points.len() as f64;
        let (mx, my) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
        let slope = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>()
            / points.iter().map(|p| (p.0 - mx).powi(2)).sum::<f64>();
        assert!((0.7..1.3).contains(&slope), "{method}: {slope}, {points:?}");
        let rms = (points.iter().map(|p| (p.1 - my - slope * (p.0 - mx)).powi(2)).sum::<f64>() / n).sqrt();
        assert!(rms < if method == Method::Dop853 { 0.7 } else { 0.4 }, "{method}: {rms}, {points:?}");
    }
}

#[test]
fn work_is_counted() {
    let fixed = run(Toy::oscillator(1.0, 1.0), |s| (s.method, s.step) = (Method::Rk4, Some(0.01))).unwrap();
    assert_eq!((fixed.work.steps, fixed.work.evaluations), (100, 401));
    let dopri5 = run(Toy::oscillator(1.0, 20.0), |s| (s.method, s.tolerance) = (Method::Dopri5, 1e-9)).unwrap();
    let steps = dopri5.work.steps + dopri5.work.rejected;
    // One more where the equations are looked at inside a step.
    assert!((1 + 6 * steps..=2 + 7 * steps).contains(&dopri5.work.evaluations), "{:?}", dopri5.work);
    let plain = |method: Method| {
        let set = |s: &mut Settings| (s.method, s.dense, s.every) = (method, false, Some(20.0));
        run(Toy::oscillator(1.0, 20.0), set).unwrap().work
    };
    let dop853 = plain(Method::Dop853);
    // One for the length of the first step.
    assert_eq!(dop853.evaluations, 2 + 12 * dop853.steps + 11 * dop853.rejected);
    let rkn8 = plain(Method::Rkn8);
    assert_eq!(rkn8.evaluations, 2 + 8 * (rkn8.steps + rkn8.rejected));
}

#[test]
fn a_pole_ends_the_run_there_e15() {
    // v' = v² from 1: pole at t = 1.
    for (method, tolerance) in [(Method::Dopri5, 1e-8), (Method::Dop853, 1e-8), (Method::Dop853, 1e-12)] {
        let toy = Toy::new(&["x"], (&[0.0], &[1.0]), 2.0, |_, _, v, _, a| a[0] = v[0] * v[0]);
        let error = run(toy, |s| (s.method, s.tolerance) = (method, tolerance)).unwrap_err();
        let Error::Run(failure) = &error else { panic!("{error}") };
        assert!(matches!(failure.cause, Cause::StepTooSmall { .. }), "{error}");
        assert!((failure.state.t - 1.0).abs() < 1e-6, "{method}: {}", failure.state.t);
    }
}

#[test]
fn a_number_that_is_none_is_named() {
    let toy = Toy::new(&["x", "y"], (&[0.0, 1.0], &[0.0, -2.0]), 2.0, |_, q, _, _, a| {
        a.copy_from_slice(&[0.0, q[1].sqrt()]);
    });
    for step in [None, Some(0.01)] {
        let error = run(toy.clone(), |s| s.step = step).unwrap_err();
        let Error::Run(failure) = &error else { panic!("{error}") };
        let Cause::NonFinite { what } = &failure.cause else { panic!("{error}") };
        assert!(what.starts_with("`y"), "{what}");
        assert!(failure.state["y"] >= 0.0 && failure.state["y"] < 0.02, "{}", failure.state);
    }
    let broken = Toy::new(&["x"], (&[0.0], &[0.0]), 1.0, |_, q, _, _, a| a[0] = 1.0 / q[0]);
    let error = run(broken, |_| ()).unwrap_err();
    assert_eq!(error.cause(), Some(&Cause::NonFinite { what: "`x''`".to_owned() }));
}

#[test]
fn outputs_are_found_by_name_and_absent_where_not_finite() {
    let toy = Toy::oscillator(1.0, 2.0).outputs(&["double", "force", "broken"], |t, q, _, a, values| {
        values.copy_from_slice(&[2.0 * q[0], a[0], if t > 1.0 { f64::NAN } else { 1.0 }]);
    });
    let mut toy = toy;
    toy.description.outputs_use_accelerations = true;
    let run = run(toy, |s| s.every = Some(0.5)).unwrap();
    let last = run.last();
    assert_eq!(last["double"], 2.0 * last["x"]);
    assert_eq!(last["force"], -last["x"]);
    assert_eq!((last.get("broken"), run.state(1).get("broken")), (None, Some(1.0)));
    assert!(last["broken"].is_nan());
    assert_eq!(run.column("double").unwrap().len(), 5);
    assert_eq!(run.column("nothing"), None);
    assert_eq!(run.column_names(), ["x", "x'", "double", "force", "broken"]);
    assert!(format!("{last:?}").contains("broken: absent"));
}

#[test]
fn a_simulation_is_described_word_by_word() {
    let run = Simulation::new(Toy::oscillator(2.0, 1.0))
        .starting("x", 0.0)
        .starting("x'", 2.0)
        .until(3.0)
        .tolerance(1e-11)
        .every(0.25)
        .method(Method::Dopri5)
        .run()
        .unwrap();
    assert_eq!((run.len(), run.method), (13, Method::Dopri5));
    assert!((run.last()["x"] - 6.0_f64.sin()).abs() < 1e-9);
}

#[test]
fn stepping_by_hand_is_the_same_motion() {
    let mut sim = Simulation::new(Toy::oscillator(1.0, 1.0)).every(0.1).tolerance(1e-11).by_hand().unwrap().recorded();
    for _ in 0..30 {
        assert_eq!(sim.step().unwrap(), None);
    }
    assert!((sim.time() - 3.0).abs() < 1e-14);
    assert!((sim.state()["x"] - sim.time().cos()).abs() < 1e-9);
    // A kick that brings it to rest.
    let rest = sim.state_mut();
    (rest.q[0], rest.v[0]) = (0.0, 0.0);
    sim.step().unwrap();
    assert_eq!(sim.state()["x"], 0.0);
    let run = sim.finish();
    assert_eq!(run.len(), 32);
    // The kick shows in the drift, but is no error of the integration.
    assert!(run.energy_balance.unwrap() > 0.9 && !run.warnings.iter().any(|w| matches!(w, Warning::EnergyJump { .. })));
}

fn event(name: &'static str, action: crate::mechanism::Action) -> crate::mechanism::Event {
    crate::mechanism::Event {
        name: name.into(),
        direction: crate::mechanism::Direction::Both,
        conditional: false,
        phases: None,
        actions: vec![action].into(),
        rated: crate::mechanism::Rated::Unknown,
    }
}

/// The second run may have other events: each is compared with the nearest of its kind.
#[test]
fn an_event_more_or_less_takes_nothing_from_the_others() {
    let record = crate::mechanism::Action::Record;
    let mut met = Vec::new();
    for k in 0..20 {
        // Where the motion turns back, at -1, one of both runs may cross twice.
        let beyond = 1.0 - 1e-9 + 1e-10 * f64::from(k);
        let toy = Toy::oscillator(1.0, 10.0).event(event("turn", record), |_, _, _, _, _| ());
        let toy = toy.event(event("zero", record), move |_, q, v, _, pairs| {
            pairs.copy_from_slice(&[q[0] + beyond, v[0], q[0], v[0]]);
        });
        let run = run(toy, |s| (s.tolerance, s.digits) = (1e-8, true)).unwrap();
        let digits = run.digits.as_ref().expect("digits");
        met.push(run.warnings.iter().any(|warning| matches!(warning, Warning::EventsDiffer { .. })));
        for (event, error) in run.events.iter().zip(&digits.events).filter(|(event, _)| event.name == "zero") {
            assert!(*error < 1e-6, "{beyond}: {} is off by {error:e}", event.state.t);
        }
    }
    assert!(met.iter().any(|met| *met), "both runs always met the same events");
}

#[test]
fn a_thermostat_by_hand_sees_its_events() {
    let toy = Toy::oscillator(1.0, 100.0)
        .event(event("zero", crate::mechanism::Action::Stop), |_, q, _, _, pairs| pairs.copy_from_slice(&[q[0], 1.0]));
    let mut sim = Simulation::new(toy).every(1.0).by_hand().unwrap();
    assert_eq!(sim.step().unwrap(), None);
    let event = sim.step().unwrap().unwrap();
    assert!((event.state.t - std::f64::consts::FRAC_PI_2).abs() < 1e-8);
    // It goes on from there, to the next zero.
    assert_eq!(sim.advance(3.0).unwrap(), None);
    let event = sim.advance(3.0).unwrap().unwrap();
    assert!((event.state.t - 1.5 * std::f64::consts::PI).abs() < 1e-8);
}

#[test]
fn more_states_than_memory_holds_are_refused() {
    let error = run(Toy::oscillator(1.0, 1.0), |s| s.every = Some(1e-12)).unwrap_err();
    assert!(matches!(error, Error::BadSetting { setting: "every", .. }), "{error}");
}

#[test]
fn progress_is_told_after_every_step() {
    let mut toy = Toy::oscillator(1.0, 1.0);
    let settings = Settings::new(&toy.scene);
    let mut times = Vec::new();
    let run = simulate_with(&mut toy, &settings, &mut |t| {
        times.push(t);
        ControlFlow::Continue(())
    })
    .unwrap();
    assert_eq!(times.len() as u64, run.work.steps);
    assert_eq!(times.last(), Some(&1.0));
}

#[test]
fn a_run_that_is_interrupted_keeps_what_it_computed() {
    let mut toy = Toy::oscillator(1.0, 100.0);
    let settings = Settings::new(&toy.scene);
    let stop = |t: f64| if t > 30.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let error = simulate_with(&mut toy, &settings, &mut |t| stop(t)).unwrap_err();
    assert_eq!(error.cause(), Some(&Cause::Interrupted));
    let last = error.partial().unwrap().last();
    assert!(last.t > 30.0 && last.t < 40.0 && (last["x"] - last.t.cos()).abs() < 1e-6, "{last:?}");
}

#[test]
fn a_negative_inertia_is_refused_and_a_small_one_is_not() {
    let moved = |mass: fn(f64) -> f64| {
        let toy = Toy::new(&["x"], (&[0.0], &[0.0]), 1.0, move |t, _, _, _, a| a[0] = 1.0 / mass(t));
        run(toy.mass(move |t, _| vec![mass(t)]), |_| ())
    };
    for mass in [|_: f64| -1.0, |t: f64| 1e-3 - t] {
        let error = moved(mass).unwrap_err();
        assert!(matches!(error.cause(), Some(Cause::NegativeInertia { .. })), "{error}");
    }
    assert!(moved(|_| 1e-12).is_ok() && moved(|t| 1.0 - 0.5 * t).is_ok());
}

#[test]
fn every_claimed_invariant_warns_and_one_that_stays_does_not() {
    let toy = |leak: f64| {
        let mut toy = Toy::new(&["x", "y"], (&[1.0, 1e-9], &[0.0, 0.0]), 20.0, move |_, q, v, _, a| {
            a.copy_from_slice(&[-q[0], -q[1] - leak * v[1]]);
        });
        toy.description.invariants =
            vec![crate::mechanism::Quantity { name: "tip".into(), components: 1, ..Default::default() }].into();
        toy.invariants = std::sync::Arc::new(|_, q, v, _, pairs| {
            let energy = q[1] * q[1] + v[1] * v[1];
            pairs.copy_from_slice(&[energy, energy]);
        });
        toy
    };
    let warned = |leak: f64| run(toy(leak), |_| ()).unwrap().warnings;
    assert!(matches!(warned(0.01).as_slice(), [Warning::InvariantDrifts { invariant, .. }] if invariant == "tip"));
    assert_eq!(warned(0.0), []);
}

#[test]
fn a_nanometre_beside_a_metre_is_followed() {
    let toy = Toy::new(&["x", "u"], (&[1.0, 1e-9], &[0.0, 0.0]), 60.0, |_, q, _, _, a| {
        a.copy_from_slice(&[-q[0], -9.0 * q[1]]);
    });
    for (tolerance, bound) in [(1e-6, 1e-2), (1e-10, 1e-6)] {
        let last = run(toy.clone(), |s| s.tolerance = tolerance).unwrap().last();
        assert!((last["u"] / 1e-9 - 180.0_f64.cos()).abs() < bound, "{tolerance}: {last:?}");
    }
}

#[test]
fn other_units_of_length_change_no_step() {
    let steps = |unit: f64| {
        let toy = Toy::new(&["x"], (&[2.0 * unit], &[0.0]), 20.0, move |_, q, _, _, a| {
            a[0] = -q[0] - (q[0] / unit).powi(3) * unit;
        });
        let work = run(toy, |_| ()).unwrap().work;
        (work.steps, work.rejected)
    };
    assert_eq!(steps(1.0), steps(2.0_f64.powi(-30)));
    assert_eq!(steps(1.0), steps(2.0_f64.powi(30)));
}

#[test]
fn rounding_of_other_coordinates_ends_no_run() {
    // z hears of x by the rounding of x alone.
    let toy = Toy::new(&["x", "z"], (&[1.0, 0.0], &[0.0, 0.0]), 20.0, |_, q, _, _, a| {
        a.copy_from_slice(&[-q[0], (q[0] + 0.1) - 0.1 - q[0] - q[1]]);
    });
    let run = run(toy, |s| s.tolerance = 1e-10).unwrap();
    assert!(run.work.evaluations < 5000, "{:?}", run.work);
    let limited = |w: &Warning| matches!(w, Warning::RoundingLimits { coordinate, .. } if coordinate == "z");
    assert!(run.warnings.iter().all(limited), "{:?}", run.warnings);
    assert!((run.last()["x"] - 20.0_f64.cos()).abs() < 1e-7);
}

#[test]
fn modes_are_chosen_before_anything_is_reported() {
    // The output is the mode of a step that is 0 at the start; a second run begins as the first did.
    let mut toy = Toy::new(&["x"], (&[-1.0], &[1.0]), 2.0, |_, _, _, _, a| a[0] = 0.0).switch(
        crate::mechanism::Switch {
            text: "x".into(),
            kind: crate::mechanism::SwitchKind::Step,
            time_only: false,
            of_input: false,
        },
        |_, q, v, _, p| p.copy_from_slice(&[q[0], v[0]]),
    );
    let settings = Settings::new(&toy.scene);
    for _ in 0..2 {
        simulate(&mut toy, &settings).unwrap();
        assert_eq!(toy.modes, [1.0]);
    }
    let mut sim = Simulation::new(toy).by_hand().unwrap();
    assert_eq!(sim.system().modes, [0.0]);
    sim.advance(1.5).unwrap();
    assert_eq!(sim.system().modes, [1.0]);
}

/// x'' = −3 unit(x'): a puck that comes to rest at t = √5/6.
fn puck(unit: impl Fn(f64, f64) -> [f64; 2] + Send + Sync + 'static) -> Toy {
    Toy::new(&["x", "y"], (&[0.0, 0.0], &[1.0, 0.5]), 2.0, move |_, _, v, _, a| {
        a.copy_from_slice(&unit(v[0], v[1]).map(|u| -3.0 * u));
    })
}

#[test]
fn a_force_that_loses_its_direction_ends_the_run_there() {
    let unit = |x: f64, y: f64| if x == 0.0 && y == 0.0 { [0.0; 2] } else { [x / x.hypot(y), y / x.hypot(y)] };
    let tolerances = [1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 1e-12];
    for (method, tolerance) in [Method::Dop853, Method::Dopri5].into_iter().flat_map(|m| tolerances.map(|t| (m, t))) {
        let error = run(puck(unit), |s| (s.method, s.tolerance) = (method, tolerance)).unwrap_err();
        assert!(matches!(error.cause(), Some(Cause::DirectionLost { .. })), "{method} at {tolerance}: {error}");
        let t = error.partial().unwrap().last().t;
        assert!((t - 1.25_f64.sqrt() / 3.0).abs() < f64::max(1e-4, 1e3 * tolerance), "{method} at {tolerance}: {t}");
    }
}

#[test]
fn regularised_friction_is_no_lost_direction_e12() {
    let soft = |x: f64, y: f64| [x, y].map(|v| v / x.hypot(y).max(1e-300) * (x.hypot(y) / 1e-3).tanh());
    for (method, tolerance) in [(Method::Dop853, 1e-9), (Method::Dopri5, 1e-6)] {
        let run = run(puck(soft), |s| (s.method, s.tolerance) = (method, tolerance)).unwrap();
        assert!(run.last()["x'"].abs() < 1e-5);
    }
}

#[test]
fn inputs_that_jump_in_time_are_no_lost_direction() {
    let toy = Toy::new(&["x"], (&[0.0], &[0.0]), 2.0, |t, q, _, _, a| a[0] = if t < 1.1 { -1.0 } else { 2.0 } - q[0]);
    for method in [Method::Dop853, Method::Dopri5] {
        assert!(run(toy.clone(), |s| s.method = method).is_ok());
    }
}

#[test]
fn a_close_encounter_is_no_lost_direction() {
    // Kepler with eccentricity 0.9999, through two pericentres.
    let toy = Toy::new(&["x", "y"], (&[1.9999, 0.0], &[0.0, (1e-4_f64 / 1.9999).sqrt()]), 12.0, |_, q, _, _, a| {
        let cube = q[0].hypot(q[1]).powi(3);
        a.copy_from_slice(&[-q[0] / cube, -q[1] / cube]);
    });
    for (method, tolerance) in [(Method::Dop853, 1e-12), (Method::Dop853, 1e-6), (Method::Dopri5, 1e-9)] {
        let run = run(toy.clone(), |s| (s.method, s.tolerance) = (method, tolerance));
        assert!(run.is_ok(), "{method} at {tolerance}: {:?}", run.err());
    }
}

/// What does not move at all bounds no step, however long.
#[test]
fn a_coordinate_at_rest_rejects_no_step() {
    let toy = Toy::new(&["x", "y"], (&[0.0, 0.0], &[1.0, 0.0]), 1e6, |_, _, _, _, a| a.fill(0.0)).separable();
    for method in [Method::Dopri5, Method::Dop853, Method::Rkn8, Method::Radau5, Method::Rodas5P] {
        let mut settings = Settings::new(&toy.scene);
        settings.method = method;
        let run = simulate(&mut toy.clone(), &settings).unwrap_or_else(|error| panic!("{method}: {error}"));
        assert_eq!(run.work.rejected, 0, "{method}");
    }
}
