//! A reaction that several systems of balances name has one value in all of them.

use dalembert_symbolic::gate::judged;
use dalembert_symbolic::model::load;

/// What is said of a pendulum whose second system, written out, has this force of the rod.
fn told(rod: &str) -> Vec<(&'static str, String)> {
    let text = format!(
        "name: Pendulum
parameters: {{m: 1 kg, l: 1 m, g: 10 m/s^2}}
coordinates: {{theta: rad}}
bodies: {{bob: {{mass: m, position: \"l*[sin(theta), -cos(theta)]\"}}}}
gravity: [0, -g]
balances:
  components:
    equations: [force: {{of: [bob]}}]
    reactions: {{rod: {{on: bob, along: position(bob)}}}}
  by_hand:
    equations: [equation: \"m*acceleration(bob) = {rod}*position(bob)/l + m*[0, -g]\"]
    reactions: {{rod: {{on: bob, along: position(bob)}}}}
"
    );
    let problems = load(&text, &[]).and_then(judged).err().unwrap_or_default();
    problems.into_iter().map(|problem| (problem.code, problem.message)).collect()
}

#[test]
fn a_sign_or_factor_that_the_motion_does_not_see_is_refused() {
    assert_eq!(told("rod"), []);
    for wrong in ["(-rod)", "2*rod"] {
        let found = told(wrong);
        let [("E511", message)] = found.as_slice() else { panic!("{wrong}: {found:?}") };
        assert!(message.starts_with("`rod` is ") && message.contains("`components`"), "{message}");
    }
}
