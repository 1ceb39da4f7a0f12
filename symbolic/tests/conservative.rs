//! Which forces have potentials, which are counted twice, and who is blamed for what is not conserved.

use dalembert_symbolic::diagnose::Problem;
use dalembert_symbolic::gate::{Conservative, Nature, judged};
use dalembert_symbolic::model::load;

/// A bob in the plane with these further lines, without units.
fn bob(lines: &str) -> String {
    format!(
        "name: Bob
parameters: {{m: 1, k: 3, b: 2, c: 0.3, F: 2, w: 3, g: 10}}
coordinates: {{x: , y: }}
bodies: {{bob: {{mass: m, position: \"[x, y]\"}}}}
{lines}
"
    )
}

fn natures(text: &str) -> Vec<Conservative> {
    judged(load(text, &[]).unwrap()).unwrap().report.forces
}

fn problems(text: &str) -> Vec<Problem> {
    judged(load(text, &[]).unwrap()).unwrap_err()
}

/// The nature of one force on the bob.
fn nature(force: &str) -> Nature {
    natures(&bob(&format!("forces: {{f: {{on: bob, force: \"{force}\"}}}}")))[0].nature.clone()
}

/// Lecture 3's examples, and fields for which the test must look twice.
#[test]
fn fields_of_lecture_3() {
    let potential =
        ["[0, -m*g]", "-k*[x, y]", "-k*[x, y]/norm([x, y])^3", "k*[y, x]", "[sin(x), exp(y)]", "b*[x*y^2, x^2*y]"];
    for force in potential {
        assert_eq!(nature(force), Nature::Potential, "{force}");
    }
    for force in ["-c*[x', y']", "-c*norm([x', y'])*[x', y']", "[c*y', 0]"] {
        assert_eq!(nature(force), Nature::Velocity { idle: false }, "{force}");
    }
    assert_eq!(nature("c*[y', -x']"), Nature::Velocity { idle: true });
    assert_eq!(nature("[F*sin(w*t), 0]"), Nature::TimeDependent);
    for (force, curl) in [("b*[-y, x]", -2.0), ("[0, b*x]", -1.0)] {
        let Nature::Curl { between, value, .. } = nature(force) else { panic!("{force}") };
        assert_eq!(between, Some(("x".to_owned(), "y".to_owned())), "{force}");
        // The parameter is drawn between 0.8 and 1.25 of its default 2.
        assert!((0.8..=1.25).contains(&(value / (2.0 * curl))), "{force}: {value}");
    }
    // A swirl with an exponent of -2 has no curl away from the origin, and no potential around it: not seen here.
    assert_eq!(nature("b*[-y, x]/(x^2 + y^2)"), Nature::Potential);
}

#[test]
fn a_force_normal_to_every_motion_does_no_work() {
    let rail = "name: Rail
parameters: {m: 1 kg, N: 5 N}
coordinates: {x: m}
bodies: {cart: {mass: m, position: \"[x, 0]\"}}
forces: {normal: {on: cart, force: \"[0, N]\"}}";
    assert_eq!(natures(rail)[0].nature, Nature::Idle);
}

#[test]
fn a_pair_written_as_two_forces_has_a_potential_together() {
    let pair = "name: Pair
parameters: {m: 1 kg, k: 3 N/m}
coordinates: {x: m, y: m}
bodies: {first: {mass: m, position: \"[x, 0]\"}, second: {mass: m, position: \"[y, 0]\"}}
forces:
  on_first: {on: first, force: \"[k*(y - x), 0]\"}
  on_second: {on: second, force: \"[k*(x - y), 0]\"}
";
    let found = natures(pair);
    assert!(matches!(found[0].nature, Nature::Curl { .. }) && matches!(found[1].nature, Nature::Curl { .. }));
    assert_eq!((found[2].name.as_str(), &found[2].nature), ("", &Nature::Potential));
    // Their potential written out again is seen only by both together.
    let twice = problems(&format!("{pair}potential_energy: k*(x - y)^2/2"));
    assert_eq!(twice[0].code, "E418");
    assert!(twice[0].message.starts_with("`on_first`, `on_second` together"), "{}", twice[0].message);
}

#[test]
fn a_torque_about_a_hinge_that_turns_with_its_angle() {
    let bar = "name: Bar
parameters: {m: 1 kg, l: 1 m, k: 2 N*m}
coordinates: {theta: rad}
bodies: {bar: {mass: m, inertia: m*l^2/12, angle: theta, position: \"l/2*[cos(theta), sin(theta)]\"}}
torques: {motor: {on: bar, torque: -k*theta}}
";
    let found = natures(bar);
    assert_eq!((found[0].section.as_str(), &found[0].nature), ("torques", &Nature::Potential));
    assert_eq!(problems(&format!("{bar}potential_energy: k*theta^2/2"))[0].code, "E418");
    assert!(judged(load(&format!("{bar}potential_energy: k*theta^2"), &[]).unwrap()).is_ok());
}

#[test]
fn summands_counted_twice_are_found_and_neighbours_are_not() {
    let message = |lines: &str| problems(&bob(lines))[0].message.clone();
    let pull = "forces: {pull: {on: bob, force: \"-k*[x, y]\"}}";
    let both = message(&format!("{pull}\npotential_energy: k*x^2/2 + k*y^2/2 + m*g*y"));
    assert!(both.contains("`1/2*k*x^2` and `1/2*k*y^2`"), "{both}");
    let entry = message("generalized_forces: {x: -k*x - c*x'}\npotential_energy: k*(x^2 + y^2)/2");
    assert!(entry.contains("of the generalized force on `x` is in `potential_energy` too"), "{entry}");
    let damping = message("generalized_forces: {x: -c*x'}\ndissipation: c*(x'^2 + y'^2)/2");
    assert!(damping.contains("is in `dissipation` too"), "{damping}");
    // Another factor, the opposite sign, one component of two: other forces.
    for lines in [
        format!("{pull}\npotential_energy: k*(x^2 + y^2)"),
        format!("{pull}\npotential_energy: -k*(x^2 + y^2)/2"),
        format!("{pull}\npotential_energy: k*x^2/2"),
        "generalized_forces: {x: -c*x'}\ndissipation: c*x'^2".to_owned(),
    ] {
        assert!(judged(load(&bob(&lines), &[]).unwrap()).is_ok(), "{lines}");
    }
}

#[test]
fn what_changes_an_invariant_is_named() {
    let lines = "gravity: [0, -g]
forces: {push: {on: bob, force: \"[F, 0]\"}, drag: {on: bob, force: \"-c*velocity(bob)\"}}
";
    let first = |conserved: &str| problems(&bob(&format!("{lines}conserved: {conserved}")))[0].clone();
    for claim in ["{e: energy}", "{e: 2*energy + m^2*x^0}", "{e: {value: energy, when: {w: 0}}}"] {
        let found = first(claim);
        assert_eq!(found.code, "E509", "{claim}");
        assert!(found.message.contains("`push`") && found.message.contains("`drag`"), "{}", found.message);
        assert!(!found.message.contains("gravity"), "{}", found.message);
        assert!(found.help.contains("`push` has a potential: put it in `potential_energy`"), "{}", found.help);
        assert!(found.help.contains("`drag` depends on velocity"), "{}", found.help);
        assert!(found.help.ends_with("`when: {c: 0}`"), "{}", found.help);
    }
    let momentum = first("{p: m*y'}");
    assert!(momentum.message.contains("gravity on `bob` changes it") && !momentum.message.contains("push"));
    // No force makes the height change.
    assert_eq!(first("{height: y}").code, "E501");
}

/// The power named is the force's: F v at the state named.
#[test]
fn the_power_is_force_times_velocity() {
    let text = "name: A
parameters: {m: 1, F: 2}
coordinates: {x: }
bodies: {cart: {mass: m, position: \"[x, 0]\"}}
forces: {push: {on: cart, force: \"[F*x, 0]\"}, pull: {on: cart, force: \"[3*x^2, 0]\"}}
conserved: {energy: energy}";
    let problem = &problems(text)[0];
    let number = |text: &str, after: &str| -> f64 {
        let rest = &text[text.find(after).unwrap() + after.len()..];
        rest.trim_start().split([' ', ',', ':']).next().unwrap().parse().unwrap()
    };
    let (x, v) = (number(&problem.help, "x ="), number(&problem.help, "x' ="));
    let pulled = if problem.message.starts_with("`energy` is not conserved: `pull`") {
        number(&problem.message, "`pull` does work at the rate")
    } else {
        number(&problem.message, "`pull` at")
    };
    assert!((pulled - 3.0 * x * x * v).abs() < 1e-3 * pulled.abs(), "{} {}", problem.message, problem.help);
}

#[test]
fn a_moving_base_is_named() {
    let text = "name: Shaken
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, Y: 0.1 m, w: 2 1/s}
coordinates: {theta: rad}
inputs: {base: Y*cos(w*t)}
bodies: {bob: {mass: m, position: \"[base + l*sin(theta), -l*cos(theta)]\"}}
gravity: [0, -g]
conserved: {energy: energy}";
    assert!(problems(text)[0].message.contains("what moves with `base` does work at the rate"));
}

/// A force that jumps where y changes its sign: no derivative tells, but its work depends on where that is crossed.
#[test]
fn a_force_that_jumps_along_its_discontinuity_has_no_potential() {
    for (force, other) in [("[sign(y), 0]", "[0, sign(y)]"), ("[step(y - x), 0]", "[step(y - x), -step(y - x)]")] {
        assert!(matches!(nature(force), Nature::Curl { .. }), "{force}: {:?}", nature(force));
        assert_eq!(nature(other), Nature::Potential, "{other}");
    }
    assert_eq!(nature("[abs(x), max(0, y)]"), Nature::Potential);
}
