//! Section 6: constraints and their reactions along a run.

use dalembert_tests::case::Case;

use crate::near;

/// A disc in the plane under gravity, on which some force acts, with more lines.
fn disc(more: &str) -> Case {
    Case::written(&format!(
        "name: Disc
parameters: {{m: 2 kg, R: 0.5 m, g: 10 m/s^2, F: 3 N, v: 1.5 m/s, c: 4 m/s^2, w: 2 1/s, A: 0.3 m, mu: 0.25 1, s: 1 s}}
coordinates: {{x: m, y: m, phi: rad}}
bodies: {{disc: {{mass: m, inertia: m*R^2/2, angle: -phi, position: \"[x, y]\"}}}}
gravity: [0, -g]
{more}"
    ))
}

#[test]
fn a_constraint_without_velocities_may_contain_t_and_is_differentiated_twice() {
    let state = disc("constraints: {drive: x = A*sin(w*t)}\noutputs: {force: reaction(drive)}").state_at(1.0);
    near(state["x"], 0.3 * 2.0_f64.sin(), 1e-12);
    near(state["x'"], 0.3 * 2.0 * 2.0_f64.cos(), 1e-12);
    near(state["force"], -2.0 * 0.3 * 4.0 * 2.0_f64.sin(), 1e-10);
}

#[test]
fn a_constraint_with_velocities_is_differentiated_once() {
    let state = disc("constraints: {haul: x' = v + c*t}\noutputs: {force: reaction(haul)}").state_at(1.0);
    near(state["x"], 1.5 + 2.0, 1e-12);
    near(state["force"], 2.0 * 4.0, 1e-12);
}

#[test]
fn an_input_may_stand_in_a_constraint_and_its_rate_beside_velocities() {
    let inputs = "inputs: {base: A*sin(w*t)}\nconstraints: {place: x - base, speed: y' - base'}\n";
    let state = disc(&format!("{inputs}outputs: {{f: reaction(place), n: reaction(speed)}}")).state_at(1.0);
    let acceleration = -0.3 * 4.0 * 2.0_f64.sin();
    near(state["x"], 0.3 * 2.0_f64.sin(), 1e-12);
    near(state["y'"], 0.3 * 2.0 * 2.0_f64.cos(), 1e-12);
    near(state["f"], 2.0 * acceleration, 1e-10);
    near(state["n"], 2.0 * (acceleration + 10.0), 1e-10);
}

#[test]
fn without_phases_all_constraints_act_always() {
    let state = disc("constraints: {floor: y - R, roll: x' - R*phi'}\nforces: {f: {on: disc, force: \"[F, 0]\"}}")
        .state_at(1.0);
    // Three halves of the mass resist.
    near(state["x"], 0.5 * 3.0 / 3.0, 1e-12);
    near(state["phi'"], 2.0, 1e-12);
    near(state["y"], 0.5, 1e-15);
}

#[test]
fn a_reaction_pushes_towards_growing_c() {
    for (constraint, expected) in [("y - R", 20.0), ("R - y", -20.0), ("2*y = 2*R", 10.0), ("y/4 - R/4", 80.0)] {
        let run = disc(&format!("constraints: {{floor: {constraint}}}\noutputs: {{n: reaction(floor)}}")).run();
        near(run.last()["n"], expected, 1e-12);
    }
}

#[test]
fn the_tension_of_a_rod_is_minus_twice_its_length_times_its_reaction() {
    let rod = "constraints: {rod: x^2 + y^2 - R^2}\noutputs: {tension: -2*R*reaction(rod)}\n";
    let state = disc(&format!("{rod}scene: {{start: {{x: 0, y: -R, x': v}}, until: 1}}")).run().first();
    near(state["tension"], 2.0 * (10.0 + 1.5 * 1.5 / 0.5), 1e-12);
}

#[test]
fn the_reaction_of_a_velocity_constraint_is_power_per_unit_of_it() {
    for (constraint, expected) in [("x' - v", -3.0), ("v - x'", 3.0), ("2*x' - 2*v", -1.5)] {
        let more = format!(
            "constraints: {{belt: {constraint}}}\nforces: {{f: {{on: disc, force: \"[F, 0]\"}}}}\noutputs: {{f: reaction(belt)}}"
        );
        near(disc(&more).run().last()["f"], expected, 1e-12);
    }
}

/// A vector constraint gives one row per component, and a reaction that is the force on the body of its first point.
#[test]
fn the_reaction_of_a_pin_is_the_force_on_the_body_of_its_first_point() {
    let state = Case::written(
        "name: Two
parameters: {m: 2 kg, M: 3 kg, F: 10 N}
coordinates: {x: m, y: m, u: m, v: m}
bodies: {one: {mass: m, position: \"[x, y]\"}, other: {mass: M, position: \"[u, v]\"}}
forces: {pull: {on: other, force: \"[F, 2*F]\"}}
constraints: {pin: position(one) - position(other)}
outputs: {on_one: reaction(pin), up: reaction(pin).y}",
    )
    .state_at(1.0);
    near(state["x"], 1.0, 1e-12);
    near(state["v"], 2.0, 1e-12);
    near(state["on_one.x"], 4.0, 1e-12);
    near(state["on_one.y"], 8.0, 1e-12);
    near(state["up"], 8.0, 1e-12);
}

#[test]
fn a_reaction_is_0_while_its_constraint_is_not_active() {
    let run = disc(
        "constraints: {floor: y - R, wall: x}
phases: {both: [floor, wall], one: [floor], none: []}
events: {loose: {when: t - s, phase: both, then: one}, off: {when: t - 2*s, phase: one, then: none}}
forces: {f: {on: disc, force: \"[-F, 0]\"}}
outputs: {n: reaction(floor), w: reaction(wall), sum: F/3 + reaction(wall)}
scene: {until: 3, every: 0.5}",
    )
    .run();
    let at = |t: f64| run.states().find(|state| state.t == t).expect("a report");
    for (t, n, w) in [(0.5, 20.0, 3.0), (1.5, 20.0, 0.0), (2.5, 0.0, 0.0)] {
        near(at(t)["n"], n, 1e-12);
        near(at(t)["w"], w, 1e-12);
        near(at(t)["sum"], 1.0 + w, 1e-12);
    }
}

/// The normal force that the friction needs is changed by what the friction does: N + k N = m g.
#[test]
fn friction_in_a_reaction_is_solved_together_with_the_accelerations() {
    let state = disc(
        "constraints: {floor: y - R}
define: {normal: reaction(floor)}
forces: {rub: {on: disc, at: \"[x, y - R]\", force: \"normal*[-mu, 1/4]\"}}
outputs: {n: normal, a: x'', alpha: phi''}
scene: {start: {x: 0, x': 3}, until: 1}",
    )
    .state_at(1.0);
    let normal = 20.0 / 1.25;
    near(state["n"], normal, 1e-12);
    near(state["a"], -0.25 * normal / 2.0, 1e-12);
    // The friction turns the disc: m R²/2 φ'' = μ N R.
    near(state["alpha"], 0.25 * normal * 0.5 / 0.25, 1e-12);
    near(state["x"], 3.0 - 0.25 * normal / 4.0, 1e-12);
}

#[test]
fn a_reaction_may_be_multiplied_by_anything_of_coordinates_velocities_and_time() {
    let more = "constraints: {floor: y - R}
forces: {rub: {on: disc, force: \"[-mu*reaction(floor)*(1 + (x'/v)^2)*cos(w*t)*exp(-abs(x)/R)*sign(x'), 0]\"}}
torques: {hold: {on: disc, torque: -R*mu*reaction(floor)*sin(phi)}}
outputs: {a: x'', alpha: phi''}
scene: {start: {x: 0.1, phi: 0.7, x': -3}, until: 1}";
    let state = disc(more).run().first();
    near(state["a"], 0.25 * 20.0 * 5.0 * (-0.2_f64).exp() / 2.0, 1e-12);
    // A torque is counterclockwise, φ is not.
    near(state["alpha"], 0.5 * 0.25 * 20.0 * 0.7_f64.sin() / 0.25, 1e-12);
}

/// A particle that starts at the top of a dome with speed v leaves it where cos θ = 2/3 + v²/(3 g R).
#[test]
fn an_event_on_a_reaction_is_where_a_body_leaves_the_ground() {
    let mut case = Case::written(
        "name: Dome
parameters: {m: 2 kg, R: 0.5 m, g: 10 m/s^2, v: 1 m/s}
coordinates: {x: m, y: m}
bodies: {bead: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {dome: norm(position(bead)) - R}
phases: {slides: [dome], flies: []}
events: {leaves: {when: reaction(dome), direction: falling, then: flies}}
outputs: {n: reaction(dome), height: norm(position(bead)) - R}
scene: {start: {x: 0, y: R, x': v}, until: 0.5, tolerance: 1e-12}",
    );
    let run = case.run();
    let [leaves] = run.events.as_slice() else { panic!("{:?}", run.events) };
    near(leaves.state["y"], 0.5 * (2.0 / 3.0 + 1.0 / 15.0), 1e-11);
    near(run.first()["n"], 2.0 * (10.0 - 2.0), 1e-12);
    assert_eq!(run.last()["n"], 0.0);
    assert!(run.last()["height"] > 0.1, "it flies: {}", run.last());
    assert_eq!(run.phases.len(), 2);
}
