//! A step allocates nothing.

use allocation_counter::measure;
use dalembert::mechanism;
use dalembert::mechanism::{Action, Direction, Event, Switch, SwitchKind};
use dalembert::{Method, Settings, Simulate, simulate};

#[path = "../src/testing.rs"]
#[expect(dead_code, reason = "shared with the unit tests")]
mod testing;

use testing::Toy;

dalembert::model!(
    yaml = r#"
name: Pendulum
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {theta: rad}
bodies: {bob: {mass: m, position: "l*[sin(theta), -cos(theta)]"}}
gravity: [0, -g]
balances:
  equations:
    - force: {of: [bob]}
  reactions:
    rod: {on: bob, along: position(bob)}
scene: {start: {theta: 1}, until: 10, tolerance: 1e-9}
"#
);

dalembert::model!(
    yaml = r#"
name: Rod
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {x: m, y: m}
bodies: {bob: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
constraints: {rod: x^2 + y^2 - l^2}
scene: {start: {x: 0.6, y: -0.8}, until: 10, tolerance: 1e-9}
"#
);

/// By momentum balances, their condition number watched, a step allocates nothing either.
#[test]
fn longer_runs_by_balances_allocate_no_more() {
    let run = |until: f64| {
        let simulation = Pendulum::default().simulate().derivation("balances").until(until).every(until);
        let mut steps = 0;
        let counted = measure(|| {
            let run = simulation.with(|settings| settings.dense = false).run().unwrap();
            assert!(run.balances.is_some());
            steps = run.work.steps;
        });
        (counted.count_total, steps)
    };
    let ((short, few), (long, many)) = (run(20.0), run(200.0));
    assert!(many > 8 * few, "{few} and {many} steps");
    assert_eq!(short, long, "allocations of {few} and of {many} steps");
}

/// Allocations and steps of a run.
fn count(toy: &Toy, until: f64, change: impl Fn(&mut Settings)) -> (u64, u64) {
    let mut toy = toy.clone();
    let mut settings = Settings::new(&toy.scene);
    (settings.until, settings.every) = (until, Some(until));
    change(&mut settings);
    let mut steps = 0;
    let counted = measure(|| steps = simulate(&mut toy, &settings).unwrap().work.steps);
    (counted.count_total, steps)
}

/// A damped oscillator with an event that never happens and a switch that is never reached.
fn watched() -> Toy {
    let event = Event {
        name: "far".into(),
        direction: Direction::Both,
        conditional: false,
        phases: None,
        actions: (&[Action::Record]).into(),
        rated: dalembert::mechanism::Rated::Unknown,
    };
    let switch = Switch { text: "x - 5".into(), kind: SwitchKind::Step, time_only: false, of_input: false };
    let mut toy = Toy::new(&["x"], (&[1.0], &[0.0]), 1.0, |_, q, v, _, a| a[0] = -q[0] - 1e-3 * v[0])
        .energy(|_, q, v| [0.5 * v[0] * v[0], 0.5 * q[0] * q[0], -1e-3 * v[0] * v[0]])
        .event(event, |_, q, _, _, pairs| pairs.copy_from_slice(&[q[0] - 3.0, 1.0]))
        .switch(switch, |_, q, v, _, pairs| pairs.copy_from_slice(&[q[0] - 5.0, v[0]]));
    toy.description.structure.conservative = false;
    toy.jacobian = std::sync::Arc::new(|_, _, _, dq, dv| (dq[0], dv[0]) = (1.0, 1e-3));
    toy
}

#[test]
fn longer_runs_allocate_no_more() {
    for toy in [Toy::oscillator(1.0, 1.0), watched()] {
        for (method, step) in [
            (Method::Euler, Some(1e-3)),
            (Method::Midpoint, Some(1e-2)),
            (Method::Rk4, Some(1e-2)),
            (Method::Dopri5, None),
            (Method::Dop853, None),
            (Method::Gauss2, Some(1e-2)),
            (Method::Gauss4, Some(1e-2)),
            (Method::Gauss6, Some(1e-2)),
            (Method::Radau5, None),
        ] {
            let set = |settings: &mut Settings| {
                (settings.method, settings.step, settings.dense) = (method, step, false);
            };
            let (short, few) = count(&toy, 20.0, set);
            let (long, many) = count(&toy, 200.0, set);
            assert!(many > 8 * few, "{method}: {few} and {many} steps");
            assert_eq!(short, long, "{method}: allocations of {few} and of {many} steps");
        }
    }
}

#[test]
fn longer_runs_of_separable_mechanisms_allocate_no_more() {
    for (method, step) in [
        (Method::Verlet, Some(1e-2)),
        (Method::Srkn4, Some(1e-2)),
        (Method::Suzuki4, Some(1e-2)),
        (Method::KahanLi8, Some(1e-2)),
        (Method::Rkn8, None),
    ] {
        let set = |settings: &mut Settings| {
            (settings.method, settings.step, settings.dense) = (method, step, false);
        };
        let toy = Toy::oscillator(1.0, 1.0);
        let ((short, few), (long, many)) = (count(&toy, 20.0, set), count(&toy, 200.0, set));
        assert!(many > 8 * few, "{method}: {few} and {many} steps");
        assert_eq!(short, long, "{method}: allocations of {few} and of {many} steps");
    }
}

#[test]
fn longer_runs_of_linear_systems_allocate_no_more() {
    let mut toy = Toy::oscillator(1.0, 1.0);
    toy.description.structure.linear = true;
    let set = |settings: &mut Settings| {
        (settings.method, settings.step, settings.dense) = (Method::Exact, Some(0.1), false);
    };
    let ((short, few), (long, many)) = (count(&toy, 20.0, set), count(&toy, 200.0, set));
    assert!(many > 8 * few, "{few} and {many} steps");
    // The exponential is computed anew for the last step, which is cut by rounding.
    assert!(long <= short + 60, "allocations: {short} of {few} steps, {long} of {many}");
}

#[test]
fn longer_runs_of_driven_linear_systems_allocate_no_more() {
    let mut toy = Toy::new(&["x"], (&[0.0], &[0.0]), 1.0, |t, q, _, _, a| a[0] = t.sin() - q[0]);
    toy.jacobian = std::sync::Arc::new(|_, _, _, dq, dv| (dq[0], dv[0]) = (1.0, 0.0));
    (toy.description.structure.linear, toy.description.structure.time_dependent) = (true, true);
    let set = |settings: &mut Settings| (settings.method, settings.dense) = (Method::Exact, false);
    let ((short, few), (long, many)) = (count(&toy, 200.0, set), count(&toy, 2000.0, set));
    // A resonance swells, and so does what an error is measured by.
    assert!(many > 7 * few, "{few} and {many} steps");
    // Matrices are made for each new length, of which the way to one's steps has a few.
    assert!(long <= short + 400, "allocations: {short} of {few} steps, {long} of {many}");
}

/// With constraints the Jacobians of the whole system are solved for in room that is there, and so are the multipliers of
/// RATTLE.  `rodas5p` evaluates Jacobians in every step: not with a [`Toy`], whose own mass matrix is a list that it makes anew.
#[test]
fn longer_runs_with_constraints_allocate_no_more() {
    for (method, step) in [
        (Method::Verlet, Some(1e-2)),
        (Method::Suzuki4, Some(1e-2)),
        (Method::KahanLi8, Some(1e-1)),
        (Method::Gauss6, Some(1e-2)),
        (Method::Radau5, None),
        (Method::Rodas5P, None),
    ] {
        let run = |until: f64| {
            let mut steps = 0;
            let simulation = Rod::default().simulate().until(until).every(until).method(method);
            let simulation = simulation.with(|s| (s.dense, s.step) = (false, step));
            let counted = measure(|| steps = simulation.run().unwrap().work.steps);
            (counted.count_total, steps)
        };
        let ((short, few), (long, many)) = (run(5.0), run(20.0));
        assert!(many > 2 * few, "{method}: {few} and {many} steps");
        match method {
            // What reactions hold moves by their rounding, which is measured again where it was never so large: now and then.
            Method::Rodas5P => assert!(long - short < many - few, "{short} in {few} steps, {long} in {many}"),
            _ => assert_eq!(short, long, "{method}: allocations of {few} and of {many} steps"),
        }
    }
}

#[test]
fn dense_output_grows_by_doubling() {
    let (short, few) = count(&Toy::oscillator(1.0, 1.0), 20.0, |_| ());
    let (long, many) = count(&Toy::oscillator(1.0, 1.0), 2000.0, |_| ());
    assert!(many > 50 * few && long < short + 30, "{short} for {few} steps, {long} for {many}");
}
