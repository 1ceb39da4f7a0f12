//! What is changed between two steps: inputs that move bodies, periods of clocks, what has happened at the start; inputs that are Rust functions.

use std::sync::Arc;

use dalembert::mechanism::{Interpreted, System};
use dalembert::{Cause, Error, Stepping};

use super::simulation;

fn by_hand(text: &str) -> Stepping<Interpreted> {
    simulation(text).by_hand().unwrap_or_else(|error| panic!("{error}"))
}

/// A mass in a box that the input moves, held by a spring to the box.
const BOX: &str = "
name: Box
parameters: {m: 2 kg, k: 50 N/m, A: 0.2 m, w: 3 rad/s}
coordinates: {x: m}
inputs: {base: A*sin(w*t)}
bodies: {b: {mass: m, position: '[x + base, 0]'}}
springs: {s: {stretch: x, stiffness: k, along: ground.x, on: b}}
outputs: {v: velocity(b)}
scene: {start: {x: 0.1}, until: 1, tolerance: 1e-11}
";

#[test]
fn a_moved_body_keeps_its_momentum_where_its_input_is_held() {
    // In space y'' + 25 y = 25 base.
    let y = |t: f64| 0.1 * (5.0 * t).cos() - 0.0675 * (5.0 * t).sin() + 0.3125 * (3.0 * t).sin();
    let rate = |t: f64| -0.5 * (5.0 * t).sin() - 0.3375 * (5.0 * t).cos() + 0.9375 * (3.0 * t).cos();
    let held = 0.2 * 1.5_f64.sin();
    let right = (y(0.5) - held) * 2.5_f64.cos() + rate(0.5) / 5.0 * 2.5_f64.sin();
    for by_name in [true, false] {
        let mut run = by_hand(BOX);
        run.advance(0.5).expect("a step");
        let before = run.state()["v.x"];
        if by_name {
            run.set_input("base", held).expect("a value that it has");
            assert!((run.state()["v.x"] - before).abs() < 1e-12, "{} {before}", run.state());
        } else {
            run.system_mut().hold_input(0, held);
        }
        run.advance(0.5).expect("a step");
        assert!((run.state()["x"] - right).abs() < 1e-9, "{} {right}", run.state());
        let run = run.finish();
        assert_eq!(run.impulses.len(), 1);
        assert!((run.impulses[0].jump[0] - 0.6 * 1.5_f64.cos()).abs() < 1e-12);
    }
}

#[test]
fn what_would_move_at_once_is_refused_until_it_goes_on() {
    let jumps = |run: &mut Stepping<Interpreted>| match run.set_input("base", 0.0) {
        Err(Error::Run(failure)) => failure.cause,
        other => panic!("{other:?}"),
    };
    let mut run = by_hand(BOX);
    run.advance(0.5).expect("a step");
    assert!(matches!(jumps(&mut run), Cause::InfiniteForce { .. }));
    assert!(run.advance(0.1).is_err());
    // A function that goes on as the file's did is no change.
    let signal = |t: f64| [0.2 * (3.0 * t).sin(), 0.6 * (3.0 * t).cos(), -1.8 * (3.0 * t).sin()];
    run.set_input_signal("base", Arc::new(signal)).expect("the file's function");
    run.advance(0.5).expect("a step");
    let mut whole = by_hand(BOX);
    whole.advance(1.0).expect("a step");
    assert!((run.state()["x"] - whole.state()["x"]).abs() < 1e-9);
    // Before the motion begins nothing is moved: it starts there.
    let mut run = by_hand(BOX);
    run.set_input("base", 0.3).expect("a start");
    run.advance(0.5).expect("a step");
    assert!((run.state()["x"] - 0.1 * 2.5_f64.cos()).abs() < 1e-9 && run.finish().impulses.is_empty());
    // The same of what a constraint moves.
    let mut run = by_hand(
        "name: Led\nparameters: {m: 1 kg}\ncoordinates: {x: m, y: m}\ninputs: {base: 0.1 m}\n\
         bodies: {b: {mass: m, position: '[x, y]'}}\nconstraints: {led: x - base}\nscene: {until: 1}\n",
    );
    run.advance(0.5).expect("a step");
    assert!(matches!(jumps(&mut run), Cause::ConstraintLost { .. }));
}

/// One law of control, whose period is a parameter.
const CLOCK: &str = "
name: Clock
parameters: {m: 1 kg, T: 0.1 s}
coordinates: {x: m}
inputs: {u: 1}
memory: {n: 0, seen: 0}
bodies: {b: {mass: m, position: '[x, 0]'}}
events: {tick: {every: T, then: {set: {n: n + 1, seen: u}}}}
outputs: {count: n}
scene: {start: {x': 1}, until: 1}
";

#[test]
fn ticks_follow_a_period_that_is_changed() {
    let counted = |first: f64, period: f64, more: f64| {
        let mut run = by_hand(CLOCK);
        run.advance(first).expect("a step");
        run.system_mut().set_parameter(1, period);
        run.advance(more).expect("a step");
        run.memory("n").expect("a number")
    };
    // At 0, 0.1, 0.2; then 0.25, 0.5, 0.75, 1, 1.25.
    assert_eq!(counted(0.25, 0.25, 1.0), 8.0);
    // The tick at 0.2 has been; then 0.25, 0.3.
    assert_eq!(counted(0.2, 0.05, 0.1), 5.0);
    let mut run = by_hand(CLOCK);
    run.advance(0.05).expect("a step");
    run.system_mut().set_parameter(1, 0.0);
    assert!(matches!(run.advance(0.1), Err(Error::BadSetting { setting: "every", .. })));
}

#[test]
fn ticks_at_the_start_have_happened_when_it_is_looked_at() {
    let mut run = by_hand(CLOCK);
    assert_eq!((run.memory("n"), run.state()["count"]), (Some(1.0), 1.0));
    // What is set then stays until the next one.
    run.set_memory("seen", -3.0).expect("a held value");
    run.advance(0.05).expect("a step");
    assert_eq!((run.memory("n"), run.memory("seen")), (Some(1.0), Some(-3.0)));
    let run = simulation(CLOCK).until(0.0).run().expect("no time");
    assert_eq!(run.last()["count"], 1.0);
    // An event that stops the run where it starts is told by the first step.
    let stop = CLOCK.replace("{set: {n: n + 1, seen: u}}", "stop");
    let mut run = by_hand(&stop);
    assert!(run.advance(0.05).expect("a step").is_some() && run.time() == 0.0);
}

const FORCED: &str = "
name: Forced
parameters: {m: 1 kg, k: 4 N/m}
coordinates: {x: m}
inputs: {f: 0 N}
bodies: {b: {mass: m, position: '[x, 0]'}}
springs: {s: {stretch: x, stiffness: k}}
forces: {f: {on: b, force: '[f, 0]'}}
scene: {until: 1, tolerance: 1e-11}
";

#[test]
fn a_function_may_step_where_the_motion_begins() {
    let right = 0.25 * (1.0 - 2.0_f64.cos());
    for late in [0.0, 1e-9] {
        let run = simulation(FORCED)
            .input("f", Arc::new(move |t: f64| [f64::from(u8::from(t > late)), 0.0, 0.0]))
            .run()
            .unwrap_or_else(|error| panic!("{late}: {error}"));
        assert!((run.last()["x"] - right).abs() < 1e-8, "{late}: {}", run.last());
    }
    // By hand too, and where it steps as the run begins anew.
    let mut run = by_hand(FORCED);
    run.advance(0.5).expect("a step");
    run.set_input_signal("f", Arc::new(|t: f64| [f64::from(u8::from(t > 0.5)), 0.0, 0.0])).expect("a function");
    run.advance(0.5).expect("a step");
    assert!((run.state()["x"] - 0.25 * (1.0 - 1.0_f64.cos())).abs() < 1e-8, "{}", run.state());
}

#[test]
fn a_function_without_its_rate_is_told_so() {
    let with = |rate: f64| {
        simulation(FORCED)
            .input("f", Arc::new(move |t: f64| [0.1 * (3.0 * t).sin(), rate * (3.0 * t).cos(), 0.0]))
            .run()
            .map(|run| run.last()["x"])
    };
    let right = 0.03 * 2.0_f64.sin() - 0.02 * 3.0_f64.sin();
    assert!((with(0.3).expect("a run") - right).abs() < 1e-9);
    let error = with(0.0).expect_err("no rate");
    assert!(
        matches!(error.cause(), Some(Cause::WrongRate { input, rate, .. }) if input == "f" && *rate == 0.0),
        "{error}"
    );
}
