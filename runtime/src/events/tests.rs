use std::f64::consts::PI;

use crate::cause::Cause;
use crate::error::Error;
use crate::mechanism::Method;
use crate::mechanism::{Action, Direction, Event, Switch, SwitchKind};
use crate::run::Run;
use crate::simulate::{Settings, simulate};
use crate::testing::Toy;

fn run(mut toy: Toy, change: impl FnOnce(&mut Settings)) -> Result<Run, Error> {
    let mut settings = Settings::new(&toy.scene);
    change(&mut settings);
    simulate(&mut toy, &settings)
}

fn event(name: &'static str, direction: Direction, actions: &'static [Action]) -> Event {
    Event {
        name: name.into(),
        direction,
        conditional: false,
        phases: None,
        actions: actions.into(),
        rated: crate::mechanism::Rated::Unknown,
    }
}

fn switch(text: &'static str, kind: SwitchKind, time_only: bool) -> Switch {
    Switch { text: text.into(), kind, time_only, of_input: false }
}

const METHODS: [Method; 2] = [Method::Dopri5, Method::Dop853];

#[test]
fn a_falling_ball_stops_on_the_ground() {
    for method in METHODS {
        let ball = Toy::new(&["y"], (&[1.0], &[0.0]), 10.0, |_, _, _, _, a| a[0] = -9.81)
            .event(event("land", Direction::Falling, &[Action::Stop]), |_, q, _, _, pairs| {
                pairs.copy_from_slice(&[q[0], 1.0])
            });
        let run = run(ball, |s| s.method = method).unwrap();
        let last = run.last();
        assert!((last.t - (2.0_f64 / 9.81).sqrt()).abs() < 2e-15, "{last:?}");
        assert!(last["y"].abs() < 2e-15, "{last:?}");
        assert_eq!(run.ended_by().unwrap().name, "land");
    }
}

#[test]
fn quarter_periods_of_a_pendulum_are_recorded_to_rounding_of_the_method() {
    // K(sin(1/2)) for a release at 1 rad with g = l.
    let quarter = 1.6749939160926133;
    for method in METHODS {
        let pendulum = Toy::pendulum(1.0, 1.0, 20.0).event(
            event("down", Direction::Both, &[Action::Record]),
            |_, q, _, _, pairs| {
                pairs.copy_from_slice(&[q[0], 1.0]);
            },
        );
        let run = run(pendulum, |s| (s.method, s.tolerance) = (method, 1e-12)).unwrap();
        assert_eq!(run.events.len(), 6);
        for (k, found) in run.events.iter().enumerate() {
            let error = found.state.t - (2 * k + 1) as f64 * quarter;
            assert!(error.abs() < 3e-11, "{method}: {error:e}");
        }
        assert_eq!(run.last().t, 20.0);
    }
}

#[test]
fn directions_and_conditions_select_crossings() {
    let rising = event("rising", Direction::Rising, &[Action::Record]);
    let falling = event("falling", Direction::Falling, &[Action::Record]);
    let late = event("late", Direction::Both, &[Action::Record]);
    // x = cos t: falls through zero at π/2, rises at 3π/2, falls at 5π/2.
    let toy = Toy::oscillator(1.0, 8.0);
    let toy = toy.event(rising, |_, _, _, _, _| ()).event(falling, |_, _, _, _, _| ());
    let toy = toy.event(late, |t, q, _, _, pairs| pairs.copy_from_slice(&[q[0], 1.0, q[0], 1.0, q[0], t - 3.0]));
    let run = run(toy, |_| ()).unwrap();
    let found: Vec<_> = run.events.iter().map(|e| (e.name.as_str(), (2.0 * e.state.t / PI).round() as i32)).collect();
    assert_eq!(found, [("falling", 1), ("rising", 3), ("late", 3), ("falling", 5), ("late", 5)]);
}

#[test]
fn an_event_that_is_zero_at_the_start_waits_until_it_has_left_zero() {
    for method in METHODS {
        // Thrown up from the ground; y is zero at the start, to rounding.
        for y in [0.0, 1.2e-16, -1.2e-16] {
            let ball = Toy::new(&["y"], (&[y], &[9.81]), 10.0, |_, _, _, _, a| a[0] = -9.81)
                .event(event("land", Direction::Both, &[Action::Stop]), |_, q, _, _, pairs| {
                    pairs.copy_from_slice(&[q[0], 1.0])
                });
            let run = run(ball, |s| s.method = method).unwrap();
            assert!((run.last().t - 2.0).abs() < 1e-14, "{:?}", run.last());
        }
    }
}

#[test]
fn pairs_of_zeros_within_a_step_are_found_e3() {
    for (method, tolerance) in [(Method::Dopri5, 1e-6), (Method::Dop853, 1e-6), (Method::Dop853, 1e-3)] {
        for d in [1e-1, 1e-2, 1e-3, 1e-4, 1e-6] {
            let toy = Toy::new(&["y"], (&[0.0], &[1.0]), 20.0 * PI, |_, q, _, _, a| a[0] = -q[0])
                .event(event("level", Direction::Both, &[Action::Record]), move |t, _, _, _, pairs| {
                    pairs.copy_from_slice(&[t.sin() - (1.0 - d), 1.0])
                });
            let run = run(toy, |s| (s.method, s.tolerance) = (method, tolerance)).unwrap();
            assert_eq!(run.events.len(), 20, "{method} at {tolerance}: d = {d}");
        }
    }
}

#[test]
fn simultaneous_events_fire_in_file_order() {
    let first = event("first", Direction::Both, &[Action::Record]);
    let second = event("second", Direction::Both, &[Action::Stop]);
    let third = event("third", Direction::Both, &[Action::Record]);
    let toy = Toy::oscillator(1.0, 8.0).event(first, |_, _, _, _, _| ()).event(second, |_, _, _, _, _| ());
    let toy = toy.event(third, |_, q, _, _, pairs| {
        pairs.copy_from_slice(&[2.0 * q[0], 1.0, q[0], 1.0, -q[0].powi(3), 1.0]);
    });
    let run = run(toy, |_| ()).unwrap();
    let names: Vec<_> = run.events.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(names, ["first", "second", "third"]);
    assert_eq!(run.ended_by().unwrap().name, "second");
}

#[test]
fn recording_does_not_disturb_the_run() {
    let plain = run(Toy::oscillator(1.0, 8.0), |_| ()).unwrap();
    let toy = Toy::oscillator(1.0, 8.0)
        .event(event("zero", Direction::Both, &[Action::Record]), |_, q, _, _, p| p.copy_from_slice(&[q[0], 1.0]));
    let watched = run(toy, |_| ()).unwrap();
    assert_eq!(plain.last(), watched.last());
    assert_eq!((plain.work.steps, plain.work.evaluations), (watched.work.steps, watched.work.evaluations));
}

/// x'' = step(t − 50) − step(t − 53) − x, at rest.
fn pulse() -> Toy {
    Toy::new(&["x"], (&[0.0], &[0.0]), 100.0, |_, q, _, modes, a| a[0] = modes[0] - modes[1] - q[0])
        .switch(switch("t - 50", SwitchKind::Step, true), |_, _, _, _, _| ())
        .switch(switch("t - 53", SwitchKind::Step, true), |t, _, _, _, p| {
            p.copy_from_slice(&[t - 50.0, 1.0, t - 53.0, 1.0]);
        })
}

#[test]
fn a_pulse_on_a_resting_oscillator_is_not_jumped_over_e6() {
    let fixed = |s: &mut Settings| (s.method, s.step) = (Method::Rk4, Some(0.07));
    let settings: [&dyn Fn(&mut Settings); 3] =
        [&|s| s.method = Method::Dopri5, &|s| s.method = Method::Dop853, &fixed];
    for (set, bound) in settings.into_iter().zip([1e-7, 1e-8, 2e-4]) {
        let run = run(pulse(), set).unwrap();
        assert_eq!(run.at(50.0).unwrap()["x"], 0.0);
        let last = run.last();
        let amplitude = last["x"].hypot(last["x'"]);
        assert!((amplitude - 2.0 * 1.5_f64.sin()).abs() < bound, "{}: {amplitude}", run.method);
    }
}

#[test]
fn discontinuities_of_time_that_are_no_straight_lines_are_stop_times() {
    // x'' = sign(sin 10t): x' is a sawtooth between 0 and π/10.
    let toy = Toy::new(&["x"], (&[0.0], &[0.0]), 20.0, |_, _, _, modes, a| a[0] = modes[0]).switch(
        switch("sin(10*t)", SwitchKind::Sign, true),
        |t, _, _, _, p| {
            p.copy_from_slice(&[(10.0 * t).sin(), 10.0 * (10.0 * t).cos()]);
        },
    );
    let run = run(toy, |_| ()).unwrap();
    // 20 = 63 · π/10 + 0.2080…: down since then, from π/10.
    let expected = 64.0 * PI / 10.0 - 20.0;
    assert!((run.last()["x'"] - expected).abs() < 1e-12, "{}", run.last()["x'"] - expected);
}

#[test]
fn a_kink_of_the_force_is_restarted_at() {
    // x'' = −sign(x) from x = 1: quarter period √2, x(4k√2) = 1.
    for method in METHODS {
        let toy = Toy::new(&["x"], (&[1.0], &[0.0]), 40.0 * 2.0_f64.sqrt(), |_, _, _, modes, a| a[0] = -modes[0])
            .switch(switch("x", SwitchKind::Sign, false), |_, q, v, _, p| p.copy_from_slice(&[q[0], v[0]]))
            .energy(|_, q, v| [0.5 * v[0] * v[0], q[0].abs(), 0.0]);
        let run = run(toy, |s| s.method = method).unwrap();
        let last = run.last();
        assert!((last["x"] - 1.0).abs() < 1e-12 && last["x'"].abs() < 1e-11, "{method}: {last:?}");
        assert!(run.energy_balance.unwrap() < 1e-12, "{:?}", run.energy_balance);
    }
}

/// x'' = −x − F sign(x'), from x at rest (catalogue E14).
fn dry_friction(x: f64) -> Toy {
    Toy::new(&["x"], (&[x], &[0.0]), 20.0, |_, q, _, modes, a| a[0] = -q[0] - modes[0])
        .switch(switch("x'", SwitchKind::Sign, false), |_, _, v, a, p| p.copy_from_slice(&[v[0], a[0]]))
}

/// Of a system that cannot slide, as these here.
#[test]
fn friction_that_sticks_is_chattering_where_it_sticks_e14() {
    for method in METHODS {
        let error = run(dry_friction(3.5), |s| s.method = method).unwrap_err();
        assert_eq!(error.cause(), Some(&Cause::Chattering { switch: "x'".to_owned(), is_rate: true }));
        let Error::Run(failure) = error else { panic!("no run") };
        assert!((failure.state.t - 2.0 * PI).abs() < 1e-8, "{method}: {}", failure.state.t);
        assert!((failure.state["x"] + 0.5).abs() < 1e-8, "{method}: {}", failure.state);
        assert!(failure.run.len() > 100);
    }
    let stuck = run(dry_friction(0.5), |_| ()).unwrap_err();
    assert_eq!(stuck.cause(), Some(&Cause::Chattering { switch: "x'".to_owned(), is_rate: true }));
}

#[test]
fn a_block_that_slides_to_rest_is_chattering_even_where_nothing_pushes() {
    let toy = Toy::new(&["x"], (&[0.0], &[1.0]), 2.0, |_, _, _, modes, a| a[0] = -3.0 * modes[0])
        .switch(switch("x'", SwitchKind::Sign, false), |_, _, v, a, p| p.copy_from_slice(&[v[0], a[0]]));
    let error = run(toy, |_| ()).unwrap_err();
    assert_eq!(error.cause(), Some(&Cause::Chattering { switch: "x'".to_owned(), is_rate: true }));
    assert!((error.partial().unwrap().last().t - 1.0 / 3.0).abs() < 1e-12);
}

#[test]
fn a_block_at_rest_waits_for_a_push() {
    // Pushed by 5 against friction of 3 from t = 1 on.
    let toy = |push: f64| {
        Toy::new(&["x"], (&[0.0], &[0.0]), 2.0, move |_, _, _, m, a| a[0] = push * m[1] - 3.0 * m[0])
            .switch(switch("x'", SwitchKind::Sign, false), |_, _, _, _, _| ())
            .switch(switch("t - 1", SwitchKind::Step, true), |t, _, v, a, p| {
                p.copy_from_slice(&[v[0], a[0], t - 1.0, 1.0]);
            })
    };
    assert!((run(toy(5.0), |_| ()).unwrap().last()["x"] - 1.0).abs() < 1e-12);
    assert!((run(toy(-5.0), |_| ()).unwrap().last()["x"] + 1.0).abs() < 1e-12);
    let held = run(toy(2.0), |_| ()).unwrap_err();
    assert_eq!(held.cause(), Some(&Cause::Chattering { switch: "x'".to_owned(), is_rate: true }));
    assert_eq!(held.partial().unwrap().last().t, 1.0);
}

#[test]
fn a_sign_at_rest_where_nothing_moves_is_zero() {
    let run = run(dry_friction(0.0), |_| ()).unwrap();
    assert_eq!(run.last()["x"], 0.0);
}

#[test]
fn a_resting_sign_that_is_pushed_off_its_surface_is_chattering() {
    // The force t grows from zero; friction would hold until t = 1.
    let toy = Toy::new(&["x"], (&[0.0], &[0.0]), 2.0, |t, _, _, modes, a| a[0] = t - modes[0])
        .switch(switch("x'", SwitchKind::Sign, false), |_, _, v, a, p| p.copy_from_slice(&[v[0], a[0]]));
    let error = run(toy, |_| ()).unwrap_err();
    assert_eq!(error.cause(), Some(&Cause::Chattering { switch: "x'".to_owned(), is_rate: true }));
}

#[test]
fn on_the_surface_the_motion_chooses_its_side() {
    // x'' = 1 − 3·step(x): from x = 0, x' = 0 both accelerations, 1 below and −2 above, lead back: chattering;
    // with 2 above it leaves upwards, and with x' = ±1 it goes where it moves.
    let toy = |v: f64, above: f64, below: f64| {
        Toy::new(&["x"], (&[0.0], &[v]), 0.1, move |_, _, _, modes, a| a[0] = below + (above - below) * modes[0])
            .switch(switch("x", SwitchKind::Step, false), |_, q, v, _, p| p.copy_from_slice(&[q[0], v[0]]))
    };
    assert!(matches!(run(toy(0.0, -2.0, 1.0), |_| ()).unwrap_err().cause(), Some(Cause::Chattering { .. })));
    let up = run(toy(0.0, 2.0, 1.0), |_| ()).unwrap();
    assert!((up.last()["x"] - 0.01).abs() < 1e-15);
    let down = run(toy(0.0, -2.0, -1.0), |_| ()).unwrap();
    assert!((down.last()["x"] + 0.005).abs() < 1e-15);
    let thrown = run(toy(-1.0, 2.0, 1.0), |_| ()).unwrap();
    assert!((thrown.last()["x"] + 0.095).abs() < 1e-15);
}

#[test]
fn events_and_discontinuities_share_a_step() {
    // x'' = −sign(x) from 1 with x(t) = 1 − t²/2: recorded before and after the kink at √2, stopped at −1/2.
    let toy = Toy::new(&["x"], (&[1.0], &[0.0]), 10.0, |_, _, _, modes, a| a[0] = -modes[0])
        .switch(switch("x", SwitchKind::Sign, false), |_, q, v, _, p| p.copy_from_slice(&[q[0], v[0]]))
        .event(event("half", Direction::Falling, &[Action::Record]), |_, _, _, _, _| ())
        .event(event("kink", Direction::Falling, &[Action::Record]), |_, _, _, _, _| ())
        .event(event("below", Direction::Falling, &[Action::Record]), |_, _, _, _, _| ())
        .event(event("end", Direction::Falling, &[Action::Stop]), |_, q, _, _, p| {
            p.copy_from_slice(&[q[0] - 0.5, 1.0, q[0], 1.0, q[0] + 0.1, 1.0, q[0] + 0.5, 1.0]);
        });
    for method in METHODS {
        let run = run(toy.clone(), |s| s.method = method).unwrap();
        let root = 2.0_f64.sqrt();
        let after = |depth: f64| root + root - (2.0 - 2.0 * depth).sqrt();
        let expected = [("half", 1.0), ("kink", root), ("below", after(0.1)), ("end", after(0.5))];
        assert_eq!(run.events.len(), 4, "{:?}", run.events);
        for (found, (name, t)) in run.events.iter().zip(expected) {
            assert_eq!(found.name, name);
            assert!((found.state.t - t).abs() < 1e-12, "{method}, {name}: {:e}", found.state.t - t);
        }
        assert_eq!(run.last(), run.ended_by().unwrap().state);
    }
}

#[test]
fn switches_that_meet_are_switched_together() {
    // Two kinks at one place, and a third at the same time.
    let toy = Toy::new(&["x"], (&[1.0], &[-1.0]), 3.0, |_, _, _, m, a| a[0] = (1.0 - m[0]) + (1.0 - m[1]) - m[2])
        .switch(switch("x", SwitchKind::Step, false), |_, _, _, _, _| ())
        .switch(switch("2*x", SwitchKind::Step, false), |_, _, _, _, _| ())
        .switch(switch("t - 1", SwitchKind::Step, true), |t, q, v, _, p| {
            p.copy_from_slice(&[q[0], v[0], 2.0 * q[0], 2.0 * v[0], t - 1.0, 1.0]);
        });
    let run = run(toy, |_| ()).unwrap();
    // Until t = 1 no force; then x'' = 2 − 1 from x = 0, x' = −1, which is at 0 again at t = 3.
    assert!((run.at(2.0).unwrap()["x"] + 0.5).abs() < 1e-12, "{:?}", run.at(2.0));
    assert!(run.last()["x"].abs() < 1e-12, "{:?}", run.last());
}

#[test]
fn discontinuities_of_time_at_the_ends_of_the_run_are_in_force_there() {
    let toy = Toy::new(&["x"], (&[0.0], &[0.0]), 1.0, |_, _, _, m, a| a[0] = m[0] - m[1])
        .switch(switch("t", SwitchKind::Step, true), |_, _, _, _, _| ())
        .switch(switch("t - 1", SwitchKind::Step, true), |t, _, _, _, p| p.copy_from_slice(&[t, 1.0, t - 1.0, 1.0]));
    let run = run(toy, |_| ()).unwrap();
    assert!((run.last()["x"] - 0.5).abs() < 1e-14);
}

#[test]
fn an_event_on_the_acceleration_sees_it_jump() {
    // x'' jumps from −1 to 2 where x falls below 0, at t = √2.
    let toy = Toy::new(&["x"], (&[1.0], &[0.0]), 2.0, |_, _, _, m, a| a[0] = 2.0 - 3.0 * m[0])
        .switch(switch("x", SwitchKind::Step, false), |_, q, v, _, p| p.copy_from_slice(&[q[0], v[0]]))
        .event(event("push", Direction::Rising, &[Action::Record]), |_, _, _, a, p| p.copy_from_slice(&[a[0], 1.0]));
    let run = run(toy, |_| ()).unwrap();
    assert_eq!(run.events.len(), 1);
    assert!((run.events[0].state.t - 2.0_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn a_bouncing_ball_by_hand_stays_above_the_floor_e2() {
    let ball = Toy::new(&["y"], (&[1.0], &[0.0]), 10.0, |_, _, _, _, a| a[0] = -9.81)
        .event(event("bounce", Direction::Falling, &[Action::Stop]), |_, q, _, _, p| p.copy_from_slice(&[q[0], 1.0]));
    let mut sim = crate::Simulation::new(ball).by_hand().unwrap();
    let mut bounces = 0;
    // The Zeno time of a ball that keeps half its speed is √(2/9.81)·3 = 1.35457…
    while sim.time() < 1.354 {
        if sim.advance(1.354 - sim.time()).unwrap().is_some() {
            bounces += 1;
            let state = sim.state_mut();
            (state.q[0], state.v[0]) = (0.0, -0.5 * state.v[0]);
        }
    }
    // After n bounces 0.9030/2ⁿ⁻¹ seconds are left until then.
    assert_eq!(bounces, 11);
    assert!(sim.state()["y"] >= 0.0 && sim.state()["y"] < 1e-3, "{:?}", sim.state());
}
