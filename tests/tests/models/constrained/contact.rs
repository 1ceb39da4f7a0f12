//! Phases, events, impacts, friction.

use dalembert::mechanism::At;
use dalembert::{Cause, Error, Method, Run, Warning};
use dalembert_tests::case::Case;
use dalembert_tests::reference::Reference;

use crate::near;

/// When the events of this name happened.
fn times(run: &Run, name: &str) -> Vec<f64> {
    run.events.iter().filter(|event| event.name == name).map(|event| event.state.t).collect()
}

/// E1 of the catalogue: bounces at √(2H/g) (1 + 2 Σ eᵏ), and their end.
#[test]
fn e1_a_ball_bounces_at_the_times_of_the_closed_form_and_comes_to_rest() {
    for (e, end) in [(0.5_f64, 1.354570923), (0.9, 8.578949179), (0.99, 89.8532046)] {
        let run = Case::new("bouncing_ball").set("e", e).until(end + 1.0).run();
        let fall = (2.0_f64 / 9.81).sqrt();
        let bounces = times(&run, "bounce");
        assert!(bounces.len() >= 19, "{}", bounces.len());
        for (k, t) in bounces.iter().enumerate() {
            let flights = e * (1.0 - e.powi(k as i32)) / (1.0 - e);
            near(*t, fall * (1.0 + 2.0 * flights), 1e-12 * end);
        }
        let ended = run.warnings.iter().find_map(|warning| match warning {
            Warning::ImpactsAccumulate { event, t } if event == "bounce" => Some(*t),
            _ => None,
        });
        near(ended.expect("an end"), fall * (1.0 + e) / (1.0 - e), 1e-6 * end);
        near(ended.expect("an end"), end, 1e-6 * end);
    }
}

/// E2: after the last bounce the ball lies on the floor and slides on.
#[test]
fn e2_a_ball_that_came_to_rest_does_not_fall_through_the_floor() {
    let last = Case::new("bouncing_ball").run().last();
    assert_eq!((last["y"], last["y'"]), (0.0, 0.0));
    near(last["x"], 0.9, 1e-12);
    near(last["normal"], 9.81, 1e-12);
}

/// Flights that one step covers begin and end on the floor: that it is met there is judged by how high they were.
#[test]
fn e2_long_steps_come_to_rest_too() {
    for method in [Method::Gauss2, Method::Gauss6, Method::Verlet, Method::KahanLi8, Method::Radau5] {
        let mut case = Case::new("bouncing_ball");
        (case.settings.method, case.settings.tolerance) = (method, 1e-6);
        let last = case.run().last();
        near(last["y"], 0.0, 1e-11);
        near(last["x"], 0.9, 1e-10);
        assert_eq!(last["y'"], 0.0, "{method}");
    }
}

#[test]
fn a_ball_without_restitution_stays_where_it_falls() {
    let run = Case::new("bouncing_ball").scene("plastic").run();
    assert_eq!(times(&run, "bounce").len(), 1);
    near(run.last()["y"], 0.0, 1e-15);
    near(run.last()["y'"], 0.0, 0.0);
}

/// A rod that flies without turning is caught at one end.
const CAUGHT: &str = "
name: Caught
parameters: {m: 2 kg, l: 0.8 m, v: 3 m/s}
coordinates: {x: m, y: m, theta: rad}
points: {tail: \"[x, y] - l/2*[cos(theta), sin(theta)]\"}
bodies: {rod: {mass: m, inertia: m*l^2/12, angle: theta, position: \"[x, y]\"}}
constraints: {hook: tail}
phases: {free: [], caught: [hook]}
events: {catch: {phase: free, when: tail.y, direction: rising, then: caught}}
outputs: {kinetic: kinetic_energy}
scene: {start: {x: l/2, y: -l, y': v}, until: 1, tolerance: 1e-12}
";

/// E8: ω = 3v/(2l), three quarters of the energy are kept, and what is lost is the energy of the lost speeds.
#[test]
fn e8_a_plastic_impact_loses_the_energy_of_the_speeds_that_it_takes() {
    let mut case = Case::written(CAUGHT);
    let run = case.run();
    let last = run.last();
    near(last["theta'"], 3.0 * 3.0 / (2.0 * 0.8), 1e-12);
    let before = run.first()["kinetic"];
    near(last["kinetic"], 0.75 * before, 1e-12);
    let [impulse] = run.impulses.as_slice() else { panic!("{:?}", run.impulses) };
    let [x, y, theta] = impulse.jump[..] else { panic!() };
    let lost = 2.0 * (x * x + y * y) / 2.0 + 2.0 * 0.8 * 0.8 / 12.0 * theta * theta / 2.0;
    near(before - last["kinetic"], lost, 1e-12);
    // The hook's impulse is what the rod's momentum lost.
    let force: Vec<f64> = impulse.constraints.iter().map(|(_, value)| *value).collect();
    near(force[1], 2.0 * y, 1e-12);
}

/// E9: an impact with restitution along a constraint, others kept, never raises the energy.
#[test]
fn e9_restitution_along_a_constraint_never_raises_the_energy() {
    for e in [0.0, 0.3, 1.0] {
        let text = CAUGHT
            .replace("then: caught", "then: {impact: e, along: hook_y}")
            .replace("v: 3 m/s", "v: 3 m/s, e: 0.5 1");
        let text = text.replace("hook: tail", "hook_y: tail.y").replace("caught: [hook]", "caught: [hook_y]");
        let run = Case::written(&text).set("e", e).until(0.3).run();
        let (before, after) = (run.first()["kinetic"], run.last()["kinetic"]);
        // A quarter of the energy is that of the tail's speed in the metric of M.
        near(after, before * (1.0 - 0.25 * (1.0 - e * e)), 1e-11);
    }
}

#[test]
fn eccentric_cylinder_follows_the_reference_until_its_normal_force_vanishes() {
    let reference = Reference::load("B16");
    let mut case = Case::new("eccentric_cylinder").tolerance(1e-13);
    for (t, values) in reference.states() {
        let state = case.state_at(t);
        let value = |name: &str| values.iter().find(|(n, _)| n == name).expect("a value").1;
        near(state["phi"], value("phi"), 1e-10);
        near(state["phi'"], value("phi_dot"), 1e-10);
        near(state["normal"], value("N"), 1e-10);
        near(state["friction_needed"], value("needed_mu"), 1e-10);
    }
    let run = Case::new("eccentric_cylinder").run();
    assert_eq!(run.ended_by().map(|event| event.name.as_str()), Some("unloaded"));
    near(run.last().t, reference.scalar("time_N_zero"), 1e-10);
    near(run.last()["phi"], reference.scalar("phi_at_N_zero"), 1e-9);
    near(run.first()["friction_needed"], reference.scalar("needed_mu_at_release"), 1e-12);
}

#[test]
fn eccentric_cylinder_slips_grips_skips_and_lands() {
    let run = |tolerance: f64| Case::new("eccentric_cylinder").scene("real").tolerance(tolerance).run();
    let expected = [
        ("slip_down", 0.726637),
        ("grip_down", 1.043435),
        ("slip_up", 1.258880),
        ("skip", 1.359505),
        ("land_down", 2.195552),
    ];
    let (loose, tight) = (run(1e-10), run(1e-12));
    assert_eq!((loose.events.len(), tight.events.len()), (5, 5));
    for (k, (name, t)) in expected.iter().enumerate() {
        assert_eq!(tight.events[k].name, *name);
        near(tight.events[k].state.t, *t, 1e-6);
        near(loose.events[k].state.t, tight.events[k].state.t, 1e-9);
    }
    near(tight.events[0].state.t, Reference::load("B16").scalar("slip_onset_time_mu_1_over_2"), 1e-10);
}

/// E13: μs = 0.4, μk = 0.3, N = 10, k = m = 1, V = 0.1.
#[test]
fn e13_a_block_on_a_belt_sticks_and_slips_periodically() {
    let run = Case::new("stick_slip").run();
    let slip = 2.0 * (std::f64::consts::PI - (1.0_f64 / 0.1).atan());
    near(slip, 3.340930, 1e-6);
    for (k, t) in times(&run, "loose_back").into_iter().enumerate() {
        near(t, 20.0 + k as f64 * (20.0 + slip), 1e-9);
    }
    let sticks: Vec<_> = run.events.iter().filter(|event| event.name == "stick_back").collect();
    assert_eq!(sticks.len(), 2);
    for (k, stick) in sticks.into_iter().enumerate() {
        near(stick.state.t, (k as f64 + 1.0) * (20.0 + slip), 1e-9);
        near(stick.state["x"], 2.0, 1e-9);
    }
}

/// E14: released 3.5 F/k from the middle it rests at −F/(2k) after two half swings; E11: at rest it is at rest.
#[test]
fn e14_coulombs_oscillator_rests_off_its_centre() {
    let run = Case::new("stick_slip").scene("resting_belt").run();
    let last = run.last();
    near(last["x"], -0.5 * 3.0, 1e-10);
    assert_eq!(last["x'"], 0.0);
    near(times(&run, "stick_back")[0], std::f64::consts::PI, 1e-9);
    near(times(&run, "stick_ahead")[0], 2.0 * std::f64::consts::PI, 1e-9);
    near(last["friction"], -1.5, 1e-10);
}

/// E10: a uniform rod pushed along a rough floor has no motion where 3 μ sin θ cos θ > 1 + 3 cos² θ; least μ = 4/3 at tan θ = 2.
#[test]
fn e10_painleve() {
    let rod = "
name: Chalk
parameters: {m: 1 kg, l: 1 m, mu: 0.5 1, g: 10 m/s^2}
coordinates: {x: m, y: m, theta: rad}
points: {tip: \"[x, y] - l/2*[cos(theta), sin(theta)]\"}
bodies: {chalk: {mass: m, inertia: m*l^2/12, angle: theta, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {floor: tip.y}
forces: {rub: {on: chalk, at: tip, force: \"[mu*reaction(floor), 0]\"}}
outputs: {normal: reaction(floor)}
scene: {start: {x: 0, theta: atan(2), x': -1, theta': 0}, until: 0.001, tolerance: 1e-10}
";
    assert!(Case::written(rod).set("mu", 1.33).run().first()["normal"] > 0.0);
    let Some(Error::Run(failure)) = Case::written(rod).set("mu", 1.34).try_run().err() else { panic!("a motion") };
    assert!(
        matches!(&failure.cause, Cause::PainleveInconsistent { constraint } if constraint == "floor"),
        "{}",
        failure.cause
    );
}

/// The same rod with contacts that open by themselves: where its tip is thrown off the floor (l/2 θ'² sin θ > g) it may leave or slide on, in the region
/// where friction opens what presses; where it is not, it can do neither.
#[test]
fn e10_a_rod_that_may_slide_or_leave_is_undecided_at_its_start() {
    let rod = "
name: Chalk
parameters: {m: 1 kg, l: 1 m, mu: 1 1, g: 10 m/s^2, w: 6 rad/s, v: 5 m/s, t0: atan(2)}
coordinates: {x: m, y: m, theta: rad}
points: {tip: \"[x, y] - l/2*[cos(theta), sin(theta)]\"}
bodies: {chalk: {mass: m, inertia: m*l^2/12, angle: theta, position: \"[x, y]\"}}
gravity: [0, -g]
contacts: {floor: {gap: tip.y, on: chalk, at: tip, normal: \"[0, 1]\", friction: mu}}
scene: {start: {theta: t0, theta': w, y: l/2*sin(t0), x: 0, y': l/2*cos(t0)*w, x': v}, until: 0.001, tolerance: 1e-10}
";
    let begun = |mu: f64, w: f64, v: f64| Case::written(rod).set("mu", mu).set("w", w).set("v", v).try_run();
    for (mu, w, v) in [(1.33, 6.0, -5.0), (1.34, 6.0, 5.0), (1.33, 2.0, -5.0), (1.34, 2.0, 5.0)] {
        assert!(begun(mu, w, v).is_ok(), "mu = {mu}, w = {w}, v = {v}");
    }
    for (w, solutions) in [(6.0, vec!["floor slips backwards", "floor open"]), (2.0, vec![])] {
        let Some(Error::Run(failure)) = begun(1.34, w, -5.0).err() else { panic!("a motion with w = {w}") };
        let Cause::UndecidedContacts { found } = &failure.cause else { panic!("{}", failure.cause) };
        assert_eq!(*found, solutions);
    }
}

/// E18: balls that touch are struck one after the other, in the order in which the impacts reach them: the last one leaves.
#[test]
fn e18_in_newtons_cradle_the_last_ball_leaves() {
    for order in ["1..3", "3..1"] {
        let hit = |i: u32| {
            format!(
                "  hit_{i}: {{when: \"x[{}] - x[{i}] - d\", direction: falling, then: {{impact: 1, along: \"gap[{i}]\"}}}}\n",
                i + 1
            )
        };
        let hits: Vec<String> =
            if order == "1..3" { (1..=3).map(hit).collect() } else { (1..=3).rev().map(hit).collect() };
        let cradle = format!(
            "name: Cradle
parameters: {{m: 1 kg, d: 0.125 m}}
coordinates: {{\"x[i in 1..4]\": m}}
bodies: {{\"ball[i in 1..4]\": {{mass: m, position: \"[x[i], 0]\"}}}}
constraints: {{\"gap[i in 1..3]\": \"x[i+1] - x[i] - d\"}}
phases: {{free: []}}
events:
{}scene: {{start: {{\"x[i in 1..4]\": [\"-1\", 0, d, 2*d], \"x[1]'\": 1}}, until: 2, tolerance: 1e-12}}
",
            hits.concat()
        );
        let run = Case::written(&cradle).run();
        let names: Vec<&str> = run.events.iter().map(|event| event.name.as_str()).collect();
        assert_eq!(names, ["hit_1", "hit_2", "hit_3"], "{order}");
        let last = run.last();
        for (name, speed) in [("x[1]'", 0.0), ("x[2]'", 0.0), ("x[3]'", 0.0), ("x[4]'", 1.0)] {
            near(last[name], speed, 1e-12);
        }
    }
}

/// The rates of accelerations and reactions, by differentiating what they solve, against differences along the motion;
/// friction included.
#[test]
fn reactions_change_at_the_rate_that_the_equations_say() {
    for (name, scene, phase) in [("eccentric_cylinder", "real", 2), ("eccentric_cylinder", "scene", 0)] {
        let case = Case::new(name).scene(scene);
        let mut system = case.system;
        system.set_phase(phase);
        let (n, rows) = (system.len(), system.description().rows.len());
        let system = &*system;
        let run = Case::new(name).scene(scene).until(0.3).run();
        let state = run.last();
        let motion = |t: f64, q: &[f64], v: &[f64]| {
            let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; rows]);
            system.accelerations_and_multipliers(At::new(t, q, v), &mut a, &mut lambda).expect("a motion");
            [a, lambda].concat()
        };
        let here = motion(state.t, &state.q, &state.v);
        let at = At::new(state.t, &state.q, &state.v).accelerated(&here[..n]).constrained(&here[n..]);
        let (mut jerk, mut change) = (vec![0.0; n], vec![0.0; rows]);
        assert!(system.motion_rates(at, &mut jerk, &mut change));
        let h = 1e-5;
        let beside = |h: f64| {
            let q: Vec<f64> = (0..n).map(|i| state.q[i] + h * (state.v[i] + h / 2.0 * here[i])).collect();
            let v: Vec<f64> = (0..n).map(|i| state.v[i] + h * (here[i] + h / 2.0 * jerk[i])).collect();
            motion(state.t + h, &q, &v)
        };
        let (after, before) = (beside(h), beside(-h));
        for (k, rate) in jerk.iter().chain(&change).enumerate() {
            let difference = (after[k] - before[k]) / (2.0 * h);
            near(*rate, difference, 1e-6 * (1.0 + difference.abs()));
        }
    }
}

#[test]
fn phases_that_follow_each_other_at_one_instant_end_the_run() {
    // With steps this long the slip that has begun ends within rounding, and begins again.
    for step in [0.9, 0.5, 0.4419417382415922, 0.20833333333333334] {
        let mut case = Case::new("eccentric_cylinder").scene("real");
        (case.settings.method, case.settings.step) = (Method::Rk4, Some(step));
        let error = case.try_run().unwrap_err();
        assert!(matches!(error.cause(), Some(Cause::Chattering { .. })), "{step}: {error}");
        assert!(error.partial().unwrap().events.len() > 10);
    }
}

/// A foot without mass, tied a metre below a bob: what the ground gives it, and the ties hand on, is (1 + e) m v.
#[test]
fn an_impact_of_a_massless_foot_has_the_impulse_of_the_body_above() {
    let text = "
name: Foot
parameters: {m: 2 kg, e: 0.5, g: 10 m/s^2, l: 1 m}
coordinates: {u: m, w: m, x: m, y: m}
bodies: {bob: {mass: m, position: \"[u, w]\"}, foot: {mass: 0, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {beside: x - u, below: w - y - l, ground: y}
phases: {flight: [beside, below]}
events: {strike: {when: y, direction: falling, then: {impact: e, along: ground}}}
scene: {start: {u: 0, w: 1.8, x: 0, y: 0.8}, until: 0.5, tolerance: 1e-10}
";
    let run = Case::written(text).run();
    let [impulse] = run.impulses.as_slice() else { panic!("{:?}", run.impulses) };
    let of = |name: &str| impulse.constraints.iter().find(|(row, _)| row == name).expect("a row").1;
    near(of("ground"), 2.0 * 1.5 * 4.0, 1e-9);
    near(of("below").abs(), 2.0 * 1.5 * 4.0, 1e-9);
    near(run.last()["w'"], 2.0 - 10.0 * 0.1, 1e-9);
}
