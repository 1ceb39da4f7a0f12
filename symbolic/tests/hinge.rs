//! Forces and springs at a hinge: the body must be named exactly where it matters.

use dalembert_symbolic::diagnose::Problem;
use dalembert_symbolic::gate::judged;
use dalembert_symbolic::model::load;

const TWO_MOMENTS: &str = "  two_moments:
    equations:
      - moment: {about: hinge, of: all}
      - moment: {about: elbow, of: [fore]}
";
const WITH_HINGES: &str = "  with_hinges:
    equations:
      - force: {of: [upper]}
      - moment: {about: upper, of: [upper]}
      - force: {of: [fore]}
      - moment: {about: fore, of: [fore]}
    reactions:
      hinge_force: {on: upper, at: hinge}
      elbow_force: {on: fore, at: elbow, from: upper}
";
/// Reactions at the hinge to the ground only: none that a force at the elbow could change.
const OUTER_HINGE: &str = "  outer:
    equations:
      - force: {of: all}
      - moment: {about: hinge, of: all}
      - moment: {about: elbow, of: [fore]}
    reactions:
      hinge_force: {on: upper, at: hinge}
";

/// Two bars with what acts at the elbow, and these systems.
fn derived(acting: &str, systems: &[&str]) -> Result<(), Vec<Problem>> {
    let balances = if systems.is_empty() { String::new() } else { format!("balances:\n{}", systems.concat()) };
    let text = format!(
        "name: TwoBars
parameters: {{m: 1 kg, l: 1 m, g: 10 m/s^2, F: 2 N, k: 3 N/m, c: 1 N*s/m}}
coordinates: {{a: rad, b: rad}}
points: {{hinge: [0, 0], elbow: \"l*[sin(a), -cos(a)]\", wall: [2, 0]}}
bodies:
  upper: {{mass: m, inertia: m*l^2/12, angle: a, position: elbow/2}}
  fore: {{mass: m, inertia: m*l^2/12, angle: b, position: \"elbow + l/2*[sin(b), -cos(b)]\"}}
gravity: [0, -g]
{acting}
{balances}"
    );
    judged(load(&text, &[])?).map(|_| ())
}

const ACTING: [&str; 4] = [
    "forces: {push: {on: elbow, force: \"[F, 0]\"}}",
    "springs: {string: {between: [wall, elbow], stiffness: k}}",
    "springs: {string: {between: [elbow, wall], stiffness: k, rest: l}}",
    "dampers: {dash: {between: [wall, elbow], damping: c}}",
];

#[test]
fn where_no_reaction_differs_the_body_need_not_be_named() {
    for acting in ACTING {
        for systems in [&[][..], &[TWO_MOMENTS], &[OUTER_HINGE], &[TWO_MOMENTS, OUTER_HINGE]] {
            assert_eq!(derived(acting, systems), Ok(()), "{acting} {systems:?}");
        }
    }
}

#[test]
fn where_a_reaction_differs_the_bodies_are_listed() {
    for acting in ACTING {
        let problems = derived(acting, &[TWO_MOMENTS, WITH_HINGES]).unwrap_err();
        assert_eq!(problems.len(), 1, "{problems:?}");
        let problem = &problems[0];
        assert_eq!(problem.code, "E403");
        assert!(problem.message.contains("`upper` and `fore`"), "{}", problem.message);
        assert!(problem.help.contains("`elbow_force.") && problem.help.contains("{on: upper, at: elbow}"));
    }
}

#[test]
fn a_body_that_is_named_takes_it() {
    for body in ["upper", "fore"] {
        for acting in [
            format!("forces: {{push: {{on: {body}, at: elbow, force: \"[F, 0]\"}}}}"),
            format!("springs: {{string: {{between: [wall, {{on: {body}, at: elbow}}], stiffness: k}}}}"),
        ] {
            assert_eq!(derived(&acting, &[TWO_MOMENTS, WITH_HINGES]), Ok(()), "{acting}");
        }
    }
}

/// A moment about the far end of the lower bar, of that bar alone, needs to know whether the force is on it.
#[test]
fn where_an_acceleration_would_differ_the_body_must_be_named() {
    let far = "  far:
    equations:
      - moment: {about: hinge, of: all}
      - moment: {about: fore, of: [fore]}
      - force: {of: [fore]}
    reactions: {elbow_force: {on: fore, at: elbow}}
";
    let problems = derived(ACTING[0], &[far]).unwrap_err();
    assert_eq!(problems[0].code, "E403");
}

/// Both ends of a spring at hinges: each is judged alone.
#[test]
fn a_spring_between_two_hinges_has_two_ends_to_name() {
    let text = "name: Three
parameters: {m: 1 kg, l: 1 m, k: 3 N/m, M: 2 kg}
coordinates: {x: m, a: rad, b: rad}
points: {pin: \"[x, 0]\", elbow: \"pin + l*[sin(a), -cos(a)]\"}
bodies:
  cart: {mass: M, inertia: M*l^2, angle: 0*x, position: pin}
  upper: {mass: m, inertia: m*l^2/12, angle: a, position: (pin + elbow)/2}
  fore: {mass: m, inertia: m*l^2/12, angle: b, position: \"elbow + l/2*[sin(b), -cos(b)]\"}
springs: {string: {between: [pin, elbow], stiffness: k, rest: l/2}}
balances:
  equations:
    - force: {of: [cart]}
    - force: {of: [upper]}
    - moment: {about: upper, of: [upper]}
    - force: {of: [fore]}
    - moment: {about: fore, of: [fore]}
  reactions:
    rail: {on: cart, along: ground.y}
    pin_force: {on: upper, at: pin, from: cart}
    elbow_force: {on: fore, at: elbow, from: upper}
";
    let problems = load(text, &[]).and_then(judged).map(|_| ()).unwrap_err();
    assert_eq!(problems.iter().map(|p| p.code).collect::<Vec<_>>(), ["E403", "E403"]);
    assert!(problems[0].message.contains("`cart` and `upper`") && problems[1].message.contains("`upper` and `fore`"));
}
