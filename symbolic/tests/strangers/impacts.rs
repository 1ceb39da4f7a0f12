//! What impacts change of what is conserved, and impacts of what is not touched.

use dalembert_symbolic::gate::judged;
use dalembert_symbolic::model::load;

use super::{accepted, refused};

/// The claims of a file, each with the events whose impacts change it.
fn changed(text: &str) -> Vec<(String, String)> {
    let report = load(text, &[]).and_then(judged).unwrap_or_else(|problems| panic!("{problems:?}")).report;
    let names = report.conserved.iter().map(|claim| claim.0.clone());
    names.zip(report.changed_by.iter().map(|events| events.join(" "))).collect()
}

/// A ball between walls, with what is said of it.
fn ball(restitution: &str, claims: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, L: 1 m, e: {restitution} 1}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
constraints: {{wall: x - L, floor: y, disc: x^2 + y^2 - 25*L^2}}
phases: {{free: []}}
events:
  hit: {{when: x - L, direction: rising, then: {{impact: e, along: wall}}}}
  rim: {{when: x^2 + y^2 - 25*L^2, then: {{impact: e, along: disc}}}}
conserved: {{{claims}}}
scene: {{start: {{x': 1, y': 0.3}}, until: 3}}
"
    )
}

#[test]
fn impacts_that_change_what_is_conserved_are_named() {
    for (restitution, claims, events) in [
        ("1", "p: \"m*x'\"", "hit rim"),
        ("1", "p: \"m*y'\"", "rim"),
        ("1", "spin: \"m*(x*y' - y*x')\"", "hit"),
        ("1", "E: energy", ""),
        ("0.5", "E: energy", "hit rim"),
        ("1", "angle: \"x'/y'\"", "hit rim"),
        ("1", "square: \"x'^2\"", "rim"),
    ] {
        let found = changed(&ball(restitution, claims));
        assert_eq!(found[0].1, events, "{claims} with e = {restitution}");
    }
}

/// Two carts on a rail, which collide or couple.
fn carts(claims: &str, then: &str, phases: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, M: 2 kg}}
coordinates: {{x: m, z: m}}
bodies: {{a: {{mass: m, position: \"[x, 0]\"}}, b: {{mass: M, position: \"[z, 0]\"}}}}
constraints: {{touch: z - x}}
phases: {{free: []{phases}}}
events: {{meet: {{when: z - x, direction: falling, phase: free, then: {then}}}}}
conserved: {{{claims}}}
scene: {{start: {{z: 1, x': 2}}, until: 3}}
"
    )
}

#[test]
fn collisions_keep_the_momentum_of_both_and_change_that_of_each() {
    let claims = "both: \"m*x' + M*z'\", E: {value: energy, phase: free}, own: {value: \"m*x'\", phase: free}";
    let names = |then: &str, phases: &str| {
        changed(&carts(claims, then, phases)).into_iter().filter(|claim| !claim.1.is_empty()).map(|claim| claim.0)
    };
    assert_eq!(names("{impact: 1, along: touch}", "").collect::<Vec<_>>(), ["own"]);
    assert_eq!(names("{impact: 0.4, along: touch}", "").collect::<Vec<_>>(), ["E", "own"]);
    // A phase that is entered is a plastic impact.
    assert_eq!(names("coupled", ", coupled: [touch]").collect::<Vec<_>>(), ["E", "own"]);
}

#[test]
fn a_ball_that_bounces_loses_energy_and_keeps_its_horizontal_momentum() {
    let found = changed(include_str!("../../../models/bouncing_ball.yaml"));
    assert_eq!(found, [("energy".to_owned(), "bounce".to_owned()), ("momentum".to_owned(), String::new())]);
}

/// A ball that falls, and an event at which a floor acts.
fn falls(when: &str, constraint: &str, start: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, l: 2 m, R: 0.1 m, g: 10 m/s^2}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
gravity: [0, -g]
constraints: {{floor: {constraint}}}
phases: {{free: []}}
events: {{hit: {{when: \"{when}\", then: {{impact: 1, along: floor}}}}}}
scene: {{start: {{{start}}}, until: 1.9}}
"
    )
}

#[test]
fn an_impact_of_a_floor_that_is_not_touched_is_refused() {
    let throw = "x: 0, y: 10, x': 1.5, y': 3";
    for (when, constraint, start) in [
        ("x - l", "y", throw),
        ("x - 1", "x", throw),
        ("y - l", "y - R", throw),
        ("t - 1", "y", throw),
        ("y'", "y", throw),
        // The scene's motion does not meet it.
        ("x - 100*l", "y", throw),
        ("y - R", "y", "y: 10, y': 100"),
    ] {
        refused(&falls(when, constraint, start), "the impact of `hit` acts along `floor`, which is");
    }
    for (when, constraint) in [("y", "y"), ("y - R", "y - R"), ("2*(R - y)", "y - R"), ("y^3 - R^3", "R - y")] {
        accepted(&falls(when, constraint, throw));
    }
}

#[test]
fn the_strangers_files_are_told_of() {
    let momentum = ball("1", "p: \"m*x'\"").replace("  rim: ", "  rim: # ").replace("# {when", "{when");
    assert_eq!(changed(&momentum)[0].0, "p");
    let constrained = "name: T
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {x: m, y: m}
bodies: {b: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {rod: x^2 + y^2 - l^2, wall: x}
phases: {swing: [rod]}
events: {hit: {when: WHEN, then: {impact: 1, along: wall}}}
scene: {start: {x: 0.6, y: -0.8}, until: 3}
";
    refused(&constrained.replace("WHEN", "x - l/2"), "the impact of `hit` acts along `wall`, which is");
    accepted(&constrained.replace("WHEN", "x"));
}

/// A puck crosses the way between its walls many times in what would be one step.
#[test]
fn walls_are_met_where_they_are_after_steps_of_any_length() {
    let text = |left: &str| {
        format!(
            "name: Walls\nparameters: {{m: 1 kg, w: 1 m, v: 3.7 m/s}}\ncoordinates: {{x: m}}\nmemory: {{n: 0}}\n\
             bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\nconstraints: {{right: x - w, left: x + w}}\nphases: {{fly: []}}\nevents:\n  \
             hr: {{when: x - w, direction: rising, then: [{{impact: 1, along: right}}, {{set: {{n: n + 1}}}}]}}\n  \
             hl: {{when: {left}, direction: falling, then: [{{impact: 1, along: left}}, {{set: {{n: n + 1}}}}]}}\n\
             scene: {{start: {{x: 0.123, x': v}}, until: 2e4}}\n"
        )
    };
    accepted(&text("x + w"));
    refused(&text("x + 0.99*w"), "E519");
}
