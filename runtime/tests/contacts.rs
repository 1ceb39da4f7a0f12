//! Friction that sticks and contacts that open by themselves: against closed forms, other coordinates, and phases written by hand.
#![cfg(all(feature = "cli", feature = "modal"))]

mod program;

use dalembert::mechanism::{ContactMode, Dynamic, System};
use dalembert::{Cause, Error, Simulate, Stepping};
use program::{File, json, near, reference, run};
use serde_json::Value;

dalembert::model!("../models/two_blocks.yaml");
dalembert::model!("../models/rocking_block.yaml");
dalembert::model!("../models/balls.yaml");

dalembert::model!(
    yaml = r#"
name: Pushed
parameters: {m: 1 kg, g: 9.81 m/s^2, mu: 0.3}
coordinates: {x: m, y: m}
inputs: {along: 0 N, up: 0 N}
bodies: {box: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
forces: {push: {on: box, force: "[along, up]"}}
contacts: {floor: {gap: y, on: box, normal: "[0, 1]", friction: mu}}
scene: {start: {x: 0}, until: 4}
"#
);

dalembert::model!(
    yaml = r#"
name: Thrown
parameters: {m: 2 kg, R: 0.1 m, g: 10 m/s^2, mu: 0.3, e: 0.5}
coordinates: {x: m, y: m, z: m, att: rotation}
frames: {B: {rotate: att}}
bodies: {ball: {mass: m, inertia: ["2*m*R^2/5", "2*m*R^2/5", "2*m*R^2/5"], frame: B, position: "[x, y, z]"}}
gravity: [0, 0, -g]
contacts: {floor: {gap: z - R, on: ball, at: "[x, y, z - R]", normal: "[0, 0, 1]", friction: mu, restitution: e}}
scene: {start: {x: 0, y: 0, z: R, x': 3, y': 1.2, z': 1, att': {ground: [20, -30, 15]}}, until: 4, tolerance: 1e-12}
"#
);

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn model(name: &str) -> String {
    format!("{ROOT}/models/{name}.yaml")
}

fn belt() -> String {
    format!("{ROOT}/tests/states/belt.yaml")
}

fn times(found: &Value) -> Vec<f64> {
    let events = found["events"].as_array().expect("events");
    events.iter().map(|event| event["t"].as_f64().expect("a time")).collect()
}

fn names(found: &Value) -> Vec<&str> {
    let events = found["events"].as_array().expect("events");
    events.iter().map(|event| event["name"].as_str().expect("a name")).collect()
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

#[track_caller]
fn alike(found: &[f64], expected: &[f64], within: f64) {
    assert!(found.len() >= expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= within, "{found} is not {expected}");
    }
}

#[test]
fn a_block_on_a_belt_sticks_and_slips() {
    let expected = reference("belt");
    for (method, within) in [("auto", 1e-12), ("dopri5", 1e-9), ("radau5", 1e-9), ("taylor", 1e-12)] {
        let found = json(&["simulate", &belt(), "--method", method]);
        alike(&times(&found), &numbers(&expected["times"]), within);
        near(&found["q"]["x"], expected["x(2)"].as_f64().expect("a number"), within);
        assert_eq!(names(&found)[..2], ["rub slips", "rub stops"], "{method}");
        assert_eq!(found["warnings"], serde_json::json!([]), "{method}");
    }
}

#[test]
fn its_limit_cycle_is_found_and_is_reached_at_once() {
    let found = json(&["orbit", &belt()]);
    near(&found["period"]["value"], 0.671_238_898_038_469, 1e-11);
    // What sticks forgets where it came from.
    let multipliers = found["multipliers"].as_array().expect("multipliers");
    assert!(!multipliers.is_empty() && multipliers.iter().all(|m| m["re"] == 0.0 && m["im"] == 0.0), "{multipliers:?}");
}

#[test]
fn slopes_go_through_sticking_and_slipping() {
    let at = |k: &str| {
        let found = json(&["simulate", &belt(), "--set", &format!("k={k}")]);
        found["q"]["x"].as_f64().expect("a number")
    };
    let text = run(&["simulate", &belt(), "--slopes", "k"]).expect("slopes");
    let line = text.lines().find(|line| line.contains("d x/d k")).expect("a slope");
    let slope: f64 = line.split('=').nth(1).and_then(|x| x.trim().parse().ok()).expect("a number");
    let difference = (at("100.001") - at("99.999")) / 0.002;
    assert!((slope - difference).abs() < 1e-8, "{slope} {difference}");
}

#[test]
fn two_frictions_turn_round_by_themselves() {
    let expected = reference("two_blocks");
    // Both blocks stick at first, where the forces leave nothing but rounding.
    for method in ["auto", "taylor"] {
        let found = json(&["simulate", &model("two_blocks"), "--method", method]);
        alike(&times(&found), &numbers(&expected["times"]), 1e-11);
        assert_eq!(times(&found).len(), 17, "{method}");
        for name in ["x", "y"] {
            near(&found["q"][name], expected[name].as_f64().expect("a number"), 1e-11);
            near(&found["v"][name], expected[format!("{name}'")].as_f64().expect("a number"), 1e-11);
        }
    }
    // The compiled code does the same.
    let compiled = TwoBlocks::default().simulate().run().expect("a run");
    assert!((compiled.last()["x"] - expected["x"].as_f64().expect("a number")).abs() < 1e-11);
}

#[test]
fn a_run_that_is_cut_in_two_is_the_run_in_one_piece() {
    let whole = json(&["simulate", &model("two_blocks")]);
    let state = File::new("cut", "");
    for until in ["0.5", "0.7", "1.2"] {
        run(&["simulate", &model("two_blocks"), "--until", until, "--save", &state.0]).expect("a run");
        let rest = json(&["simulate", &model("two_blocks"), "--state", &state.0, "--until", "3"]);
        near(&rest["q"]["x"], whole["q"]["x"].as_f64().expect("a number"), 1e-11);
        assert_eq!(times(&rest).len(), times(&whole).iter().filter(|t| **t > until.parse().expect("a time")).count());
    }
}

#[test]
fn phases_by_hand_give_the_same() {
    // The library's block on a belt has its phases in the file.
    let by_hand = json(&["simulate", &model("stick_slip")]);
    let file = File::new(
        "stick-slip",
        r#"
name: Same
parameters: {m: 1 kg, k: 1 N/m, g: 10 m/s^2, mu_s: 0.4 1, mu_k: 0.3 1, belt: 0.1 m/s}
coordinates: {x: m, y: m}
bodies: {block: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
springs: {spring: {stretch: x, stiffness: k, along: ground.x, on: block}}
constraints: {floor: y}
friction: {grip: {rate: x' - belt, on: block, along: "[1, 0]", limit: mu_k*reaction(floor), static: mu_s*reaction(floor)}}
scene: {start: {x: 2 m, y: 0, x': belt}, until: 60, tolerance: 1e-12}
"#,
    );
    let found = json(&["simulate", &file.0]);
    let own = |found: &Value| times(found).into_iter().take(6).collect::<Vec<f64>>();
    alike(&own(&found), &own(&by_hand), 1e-10);
    near(&found["q"]["x"], by_hand["q"]["x"].as_f64().expect("a number"), 1e-9);
}

#[test]
fn a_block_rocks_from_corner_to_corner() {
    let expected = reference("rocking_block");
    let found = json(&["simulate", &model("rocking_block")]);
    alike(&times(&found), &numbers(&expected["times"]), 1e-10);
    assert!(names(&found).iter().all(|name| name.ends_with("lands")), "{:?}", names(&found));
    // With restitution its corners hop, and it comes to rest all the same.
    let hops = json(&["simulate", &model("rocking_block"), "--set", "e=0.3", "--no-digits"]);
    near(&hops["q"]["y"], 0.5, 1e-3);
    let compiled = RockingBlock::default().simulate().run().expect("a run");
    assert!((compiled.events[0].state.t - numbers(&expected["times"])[0]).abs() < 1e-10);
}

#[test]
fn slopes_go_through_plastic_impacts_and_no_others() {
    let at = |h: &str| {
        let found = json(&["simulate", &model("rocking_block"), "--until", "1", "--set", &format!("h={h}")]);
        found["q"]["th"].as_f64().expect("a number")
    };
    let text = run(&["simulate", &model("rocking_block"), "--until", "1", "--slopes", "h"]).expect("slopes");
    let line = text.lines().find(|line| line.contains("d th/d h")).expect("a slope");
    let slope: f64 = line.split('=').nth(1).and_then(|x| x.trim().parse().ok()).expect("a number");
    assert!((slope - (at("0.50001") - at("0.49999")) / 2e-5).abs() < 1e-7, "{slope}");
    let hops = run(&["simulate", &model("rocking_block"), "--until", "0.37", "--set", "e=0.3", "--slopes", "h"]);
    assert!(hops.as_ref().is_err_and(|text| text.contains("rebound")), "{hops:?}");
}

#[test]
fn balls_strike_by_the_law_of_the_file() {
    let text = std::fs::read_to_string(model("balls")).expect("the model");
    let speed = (2.0_f64 * 9.81).sqrt();
    let after = |law: &str, e: &str| {
        let file = File::new("balls", &text.replace("impacts: sequential", law));
        let found = json(&["simulate", &file.0, "--until", "0.4516", "--set", &format!("e={e}"), "--no-digits"]);
        let first = &found["impulses"][0]["v"];
        ["a", "b", "c"].map(|name| first[name].as_f64().expect("a jump") / speed - 1.0)
    };
    let expected = reference("balls");
    alike(&after("impacts: sequential", "1"), &numbers(&expected["sequential"]), 1e-12);
    alike(&after("impacts: together", "1"), &numbers(&expected["newton_together"]), 1e-12);
    // What is compressed together flies off together.
    alike(&after("impacts: poisson", "1"), &[1.0, 1.0, 1.0], 1e-12);
    alike(&after("impacts: sequential", "0.5"), &[1.0 / 32.0, 7.0 / 128.0, 115.0 / 128.0], 1e-12);
    // Without a law both outcomes are told, and neither is taken.
    let file = File::new("no-law", &text.replace("impacts: sequential", ""));
    let refused = run(&["simulate", &file.0]).expect_err("no law");
    for part in ["`floor`, `one`, `two` strike at once", "15.5031", "4.42945", "impacts: sequential"] {
        assert!(refused.contains(part), "{refused}");
    }
}

#[test]
fn a_ball_hops_to_rest() {
    let ball = File::new(
        "ball",
        "name: Ball\nparameters: {m: 1 kg, g: 9.81 m/s^2, e: 0.5}\ncoordinates: {y: m}\n\
         bodies: {ball: {mass: m, position: \"[0, y]\"}}\ngravity: [0, -g]\n\
         contacts: {floor: {gap: y, on: ball, normal: \"[0, 1]\", restitution: e}}\n\
         scene: {start: {y: 1}, until: 3}\n",
    );
    let found = json(&["simulate", &ball.0]);
    near(&found["q"]["y"], 0.0, 1e-12);
    let warning = found["warnings"][0].as_str().expect("a warning");
    assert!(warning.contains("accumulate at t = 1.35457 s"), "{warning}");
    let deep = run(&["simulate", &ball.0, "--start", "y=-0.5"]).expect_err("it is in the floor");
    assert!(deep.contains("pass through each other"), "{deep}");
}

#[test]
fn a_disc_that_slides_begins_to_roll() {
    let disc = File::new(
        "disc",
        "name: Bowling\nparameters: {m: 1 kg, R: 0.1 m, g: 9.81 m/s^2, mu: 0.2, v: 3 m/s}\n\
         coordinates: {x: m, y: m, th: rad}\n\
         bodies: {disc: {mass: m, inertia: m*R^2/2, angle: th, position: \"[x, y]\"}}\n\
         points: {touch: \"disc - [0, R]\"}\ngravity: [0, -g]\n\
         contacts: {lane: {gap: touch.y, on: disc, at: touch, normal: \"[0, 1]\", friction: mu}}\n\
         balances: {equations: [{force: {of: [disc]}}, {moment: {about: disc, of: [disc]}}]}\n\
         outputs: {pressed: reaction(lane), rubbed: reaction(lane.friction)}\n\
         scene: {start: {y: R, x': v}, until: 2, tolerance: 1e-11}\n",
    );
    let found = json(&["simulate", &disc.0]);
    // v falls by mu g until v = R omega: two thirds of v, at v/(3 mu g).
    alike(&times(&found), &[3.0 / (3.0 * 0.2 * 9.81)], 1e-12);
    near(&found["v"]["x"], 2.0, 1e-12);
    near(&found["v"]["th"], -20.0, 1e-10);
    near(&found["outputs"]["pressed"], 9.81, 1e-11);
    near(&found["outputs"]["rubbed"], 0.0, 1e-11);
}

/// A block on two corners, and one at a point with the same friction, pulled by the same force; their states at the end agree.
fn on_corners_as_at_a_point(name: &str, pull: &str, more: &str) {
    let parameters = "parameters: {m: 1 kg, b: 0.1 m, h: 0.1 m, g: 9.81 m/s^2, mu: 0.3, F: 6 N, w: 4 rad/s}";
    let sitting = File::new(
        &format!("sitting_{name}"),
        &format!(
            "name: Sitting\n{parameters}\ncoordinates: {{x: m, y: m, th: rad}}\n\
             bodies: {{box: {{mass: m, inertia: m*(b^2 + h^2)/3, angle: th, position: \"[x, y]\"}}}}\n\
             points: {{p: box - b*box.x - h*box.y, q: box + b*box.x - h*box.y}}\ngravity: [0, -g]\n\
             forces: {{pull: {{on: box, force: \"[{pull}, 0]\"}}}}\n{more}\
             contacts:\n  p: {{gap: p.y, on: box, at: p, normal: \"[0, 1]\", friction: mu}}\n  \
             q: {{gap: q.y, on: box, at: q, normal: \"[0, 1]\", friction: mu}}\n\
             scene: {{start: {{y: h}}, until: 4, tolerance: 1e-10}}\n"
        ),
    );
    let sliding = File::new(
        &format!("sliding_{name}"),
        &format!(
            "name: Sliding\n{parameters}\ncoordinates: {{x: m}}\nbodies: {{box: {{mass: m, position: \"[x, 0]\"}}}}\n\
             forces: {{pull: {{on: box, force: \"[{pull}, 0]\"}}}}\n{more}\
             friction: {{floor: {{rate: x', on: box, along: \"[1, 0]\", limit: mu*m*g}}}}\n\
             scene: {{start: {{x: 0}}, until: 4, tolerance: 1e-10}}\n"
        ),
    );
    let [sitting, sliding] = [sitting, sliding].map(|file| json(&["simulate", &file.0]));
    near(&sitting["q"]["x"], sliding["q"]["x"].as_f64().expect("a number"), 1e-9);
    near(&sitting["v"]["x"], sliding["v"]["x"].as_f64().expect("a number"), 1e-9);
    near(&sitting["q"]["th"], 0.0, 1e-12);
    assert_eq!(sitting["warnings"], serde_json::json!([]));
}

#[test]
fn a_block_on_two_corners_slips_when_both_are_at_their_limit() {
    on_corners_as_at_a_point("smooth", "F*sin(w*t)", "");
    on_corners_as_at_a_point("constant", "F", "");
    // How two corners share a force that jumps past one's limit is not determined; how the block moves is.
    let held = "memory: {u: 0 N}\nevents: {go: {every: 0.02 s, then: {set: {u: F*sin(w*t)}}}}\n";
    on_corners_as_at_a_point("held", "u", held);
}

#[test]
fn what_jams_is_an_error() {
    let rod = File::new(
        "rod",
        "name: Jammed\nparameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2, mu: 2, a: 60 deg, w: 0.5 rad/s}\n\
         coordinates: {x: m, y: m, th: rad}\n\
         bodies: {rod: {mass: m, inertia: m*l^2/12, angle: th, position: \"[x, y]\"}}\n\
         points: {p: rod - l/2*rod.x}\ngravity: [0, -g]\n\
         contacts: {p: {gap: p.y, on: rod, at: p, normal: \"[0, 1]\", friction: mu}}\n\
         scene: {start: {th: a, y: l/2*sin(a), x': -3, th': w, y': l/2*cos(a)*w}, until: 1}\n",
    );
    let jams = run(&["simulate", &rod.0]).expect_err("Painlevé's paradox");
    assert!(jams.contains("no combination of sticking, slipping and opening"), "{jams}");
    run(&["simulate", &rod.0, "--set", "mu=0.5"]).expect("a rod that is less rough slides");
}

/// The end of a run of a box of 1 kg that begins at rest at 0, with what the events were called.
fn of_a_box(name: &str, rest: &str) -> (Value, Vec<String>) {
    let head = "parameters: {m: 1 kg, g: 9.81 m/s^2, mu: 0.3, s: 1 s, F: 6 N, V: 2 m/s}\n";
    let file = File::new(name, &format!("name: Box\n{head}{rest}\n"));
    let found = json(&["simulate", &file.0]);
    let names = names(&found).into_iter().map(str::to_owned).collect();
    (found, names)
}

#[test]
fn contacts_follow_forces_that_jump() {
    let slides = "coordinates: {x: m}\nbodies: {box: {mass: m, position: \"[x, 0]\"}}\nscene: {start: {x: 0}, until: 2}\n\
                  friction: {floor: {rate: x', on: box, along: \"[1, 0]\", limit: mu*m*g}}\n";
    let held = "memory: {u: 0 N}\nevents: {go: {every: 1 s, from: 1 s, then: {set: {u: 6 N}}}}\n";
    let pulled = |force: &str| format!("forces: {{pull: {{on: box, force: \"{force}\"}}}}\n");
    for (name, more) in [("by-time", pulled("[F*step(t - s), 0]")), ("by-event", format!("{held}{}", pulled("[u, 0]")))]
    {
        let (found, events) = of_a_box(name, &format!("{slides}{more}"));
        near(&found["q"]["x"], 0.5 * (6.0 - 0.3 * 9.81), 1e-12);
        assert_eq!(events, ["floor slips"], "{name}");
    }
    // A limit that falls, too.
    let brake = "coordinates: {x: m}\nbodies: {box: {mass: m, position: \"[x, 0]\"}}\nmemory: {u: 5 N}\n\
                 forces: {pull: {on: box, force: \"[F/2, 0]\"}}\nfriction: {brake: {rate: x', limit: u}}\n\
                 events: {go: {every: 1 s, from: 1 s, then: {set: {u: 1 N}}}}\nscene: {start: {x: 0}, until: 2}";
    let (found, events) = of_a_box("brake", brake);
    near(&found["q"]["x"], 1.0, 1e-12);
    assert_eq!(events, ["brake slips"]);
    // Nothing presses it until it is pulled up.
    let weightless = "coordinates: {y: m}\nbodies: {box: {mass: m, position: \"[0, y]\"}}\nscene: {start: {y: 0}, until: 2}\n\
                      contacts: {floor: {gap: y, on: box, normal: \"[0, 1]\"}}\n";
    for (name, more) in
        [("up-by-time", pulled("[0, F*step(t - s)]")), ("up-by-event", format!("{held}{}", pulled("[0, u]")))]
    {
        let (found, events) = of_a_box(name, &format!("{weightless}{more}"));
        near(&found["q"]["y"], 3.0, 1e-12);
        assert_eq!(events, ["floor lifts"], "{name}");
    }
}

#[test]
fn contacts_follow_speeds_that_jump() {
    // A bounded force makes no speed jump: the belt is 2 m/s faster at once, the box after 2/(mu g).
    let belt = "coordinates: {x: m}\ninputs: {w: \"V*max(0, t - s)\"}\nbodies: {box: {mass: m, position: \"[x, 0]\"}}\n\
                friction: {belt: {rate: x' - w', limit: mu*m*g}}\nscene: {start: {x: 0}, until: 2}";
    let (found, events) = of_a_box("belt", belt);
    near(&found["q"]["x"], 2.0 - 2.0 / (0.3 * 9.81), 1e-12);
    assert_eq!(events, ["belt slips", "belt stops"]);
    // A floor that rises at once strikes, with restitution; one that falls leaves the box behind.
    let floor = |sign: &str| {
        format!(
            "coordinates: {{y: m}}\ninputs: {{p: \"{sign}V*max(0, t - s)\"}}\ngravity: [0, -g]\n\
             bodies: {{box: {{mass: m, position: \"[0, y]\"}}}}\nscene: {{start: {{y: 0}}, until: 1.2}}\n\
             contacts: {{floor: {{gap: y - p, on: box, normal: \"[0, 1]\", restitution: 0.5}}}}"
        )
    };
    let (found, events) = of_a_box("rises", &floor(""));
    near(&found["q"]["y"], 3.0 * 0.2 - 0.5 * 9.81 * 0.04, 1e-12);
    assert_eq!(events, ["floor lands"]);
    let (found, events) = of_a_box("falls", &floor("-"));
    near(&found["q"]["y"], -0.5 * 9.81 * 0.04, 1e-12);
    assert_eq!(events, ["floor lifts"]);
    // So it is where a motion begins with such a speed.
    let (found, events) = of_a_box("begins", &floor("0*").replace("start: {y: 0}", "start: {y: 0, y': -2}"));
    near(&found["impulses"][0]["v"]["y"], 3.0, 1e-12);
    near(&found["events"][0]["t"], 0.0, 0.0);
    assert_eq!(events[0], "floor lands");
}

#[test]
fn contacts_follow_changes_by_hand() {
    let mut pushed = Pushed::default().simulate().every(0.5).by_hand().expect("a start");
    let mut names = Vec::new();
    let mut go = |pushed: &mut Stepping<_>| {
        pushed.step().expect("a step");
        names.extend(pushed.events().iter().map(|event| event.name.clone()));
    };
    go(&mut pushed);
    // 6 N are more than friction holds: for half a second.
    pushed.set_input("along", 6.0).expect("an input");
    go(&mut pushed);
    let a = 6.0 - 0.3 * 9.81;
    assert!((pushed.state()["x'"] - 0.5 * a).abs() < 1e-12);
    // It slides on, and comes to rest.
    pushed.set_input("along", 0.0).expect("an input");
    go(&mut pushed);
    go(&mut pushed);
    assert_eq!(pushed.state()["x'"], 0.0);
    // A push by hand: friction stops it, and is no impulse.
    pushed.state_mut().v[0] = 1.0;
    go(&mut pushed);
    let way = 0.125 * a + 0.125 * a * a / (0.3 * 9.81) + 0.5 / (0.3 * 9.81);
    assert!((pushed.state()["x"] - way).abs() < 1e-12, "{} {way}", pushed.state()["x"]);
    // More than its weight lifts it.
    pushed.set_input("up", 11.81).expect("an input");
    go(&mut pushed);
    assert!((pushed.state()["y"] - 0.25).abs() < 1e-12);
    pushed.set_input("up", 0.0).expect("an input");
    pushed.state_mut().q[1] = -0.5;
    let Err(Error::Run(failure)) = pushed.step() else { panic!("a box in the floor") };
    assert!(matches!(failure.cause, Cause::Penetrates { .. }), "{}", failure.cause);
    assert_eq!(names, ["floor slips", "floor stops", "floor slips", "floor stops", "floor lifts"]);
}

#[test]
fn what_struck_and_leaves_lands_once() {
    // The corner's rate is zero after the impact, to rounding, and the box turns it up.
    let turning = File::new(
        "turning",
        "name: Box\nparameters: {m: 1 kg, b: 0.05 m, h: 0.3 m, g: 9.81 m/s^2}\ncoordinates: {x: m, y: m, th: rad}\n\
         bodies: {box: {mass: m, inertia: m*(b^2 + h^2)/3, angle: th, position: \"[x, y]\"}}\n\
         points: {p: box - b*box.x - h*box.y, q: box + b*box.x - h*box.y}\ngravity: [0, -g]\nimpacts: poisson\n\
         contacts:\n  p: {gap: p.y, on: box, at: p, normal: \"[0, 1]\", friction: 0.1}\n  \
         q: {gap: q.y, on: box, at: q, normal: \"[0, 1]\", friction: 0.1}\n\
         scene: {start: {th: 0.09, y: 0.886, x': -0.852, th': 1.373}, until: 0.45}\n",
    );
    let found = json(&["simulate", &turning.0]);
    assert_eq!(names(&found), ["p lands"]);
    let [before, jump] = [&found["impulses"][0]["constraints"], &found["impulses"][0]["v"]];
    near(&jump["y"], before["p"].as_f64().expect("an impulse"), 1e-12);
    // A disc that falls on another one, which lies on the floor: the series of impacts between them ends.
    let discs = File::new(
        "discs",
        "name: Discs\nparameters: {m: 1 kg, M: 2.29 kg, R: 0.1 m, g: 9.81 m/s^2}\n\
         coordinates: {x: m, y: m, th: rad, X: m, Y: m}\nbodies:\n  \
         low: {mass: m, inertia: m*R^2/2, angle: th, position: \"[x, y]\"}\n  top: {mass: M, position: \"[X, Y]\"}\n\
         points: {p: \"low - [0, R]\"}\ngravity: [0, -g]\nimpacts: sequential\n\
         contacts:\n  p: {gap: p.y, on: low, at: p, normal: \"[0, 1]\", friction: 0.1}\n  \
         c: {gap: norm(top - low) - 2*R, on: top, from: low, normal: top - low}\n\
         scene: {start: {y: R, X: -0.0513, Y: 1}, until: 0.45}\n",
    );
    let found = json(&["simulate", &discs.0]);
    assert_eq!(names(&found), ["c lands"]);
    near(&found["v"]["y"], 0.0, 1e-12);
}

#[test]
fn contacts_are_known_by_name() {
    let system = Dynamic::new(Balls::default());
    let contacts = system.contacts();
    assert_eq!(contacts.all.iter().map(|contact| &*contact.name).collect::<Vec<_>>(), ["floor", "one", "two"]);
    assert_eq!(contacts.modes(5), [ContactMode::Closed, ContactMode::Open, ContactMode::Closed]);
    assert_eq!(system.description().phases[5].name, "floor closed, one open, two closed");
    let balls = Balls { e: 2.0, ..Balls::default() };
    let Err(Error::Run(failure)) = balls.simulate().run() else { panic!("a restitution of 2") };
    assert!(matches!(failure.cause, Cause::BadRestitution { .. }), "{}", failure.cause);
}

#[test]
fn a_wrong_place_or_direction_does_not_compile() {
    let across = "does not open along its normal";
    for (name, right, wrong, why) in [
        ("rocking_block", "at: left,  normal", "at: top_left,  normal", across),
        ("rocking_block", "at: left,  normal: \"[0, 1]\"", "at: left,  normal: \"[0.3, 1]\"", across),
        ("two_blocks", "on: high, from: low, along", "on: low, from: high, along", "balances"),
        ("two_blocks", "on: high, from: low, along", "on: high, along", "balances"),
    ] {
        let text = std::fs::read_to_string(model(name)).expect("the model");
        assert!(text.contains(right), "{right}");
        let file = File::new("wrong", &text.replace(right, wrong));
        let refused = run(&["check", &file.0]).expect_err("a wrong contact");
        assert!(refused.contains(why), "{refused}");
    }
}

/// Pulled by F t a block sticks until F t = L; one that is dropped loses 1 − e² of its energy at each impact.
#[test]
fn reports_tell_what_contacts_did() {
    let block = File::new(
        "pulled",
        "name: Pulled\nparameters: {m: 1 kg, F: 2 N/s, L: 4 N}\ncoordinates: {x: m}\n\
         bodies: {b: {mass: m, position: \"[x, 0]\"}}\nforces: {pull: {on: b, force: \"[F*t, 0]\"}}\n\
         friction: {rub: {rate: x', on: b, along: \"[1, 0]\", limit: L}}\nscene: {start: {x: 0}, until: 3}\n",
    );
    let rub = &json(&["simulate", &block.0])["contacts"]["rub"];
    near(&rub["sticks"], 2.0, 1e-9);
    near(&rub["slips forwards"], 1.0, 1e-9);
    near(&rub["held"], 1.0, 1e-9);
    assert_eq!(rub.as_object().expect("modes").len(), 3);
    let earlier = &json(&["simulate", &block.0, "--until", "1.5"])["contacts"]["rub"];
    assert_eq!(earlier["sticks"], 1.5);
    near(&earlier["held"], 0.75, 1e-12);
    let text = run(&["simulate", &block.0]).expect("a report");
    assert!(
        text.contains("  rub slips forwards for 1 s, sticks for 2 s and holds up to 1.00 of its limit\n"),
        "{text}"
    );

    let ball = File::new(
        "dropped",
        "name: Dropped\nparameters: {m: 2 kg, g: 9.81 m/s^2, e: 0.5}\ncoordinates: {y: m}\n\
         bodies: {ball: {mass: m, position: \"[0, y]\"}}\ngravity: [0, -g]\n\
         contacts: {floor: {gap: y, on: ball, normal: \"[0, 1]\", restitution: e}}\nscene: {start: {y: 1}, until: 0.8}\n",
    );
    let found = json(&["simulate", &ball.0]);
    near(&found["impulses"][0]["energy"], -0.75 * 2.0 * 9.81, 1e-7);
    assert_eq!(found["contacts"]["floor"]["open"], 0.8);
    assert_eq!(found["contacts"]["floor"]["held"], Value::Null);
}

/// It hops, slides and rolls: what a sphere is rubbed with changes neither its moment about the floor nor the direction of its sliding.
#[test]
fn generated_code_slides_in_space() {
    let run = Thrown::default().simulate().run().expect("a run");
    let last = run.last();
    // v + w x (0, 0, -R) = (6, 3.2) m/s, 2/7 of which are left to v where it rolls.
    assert!(
        (last["x'"] - (3.0 - 12.0 / 7.0)).abs() < 1e-9 && (last["y'"] - (1.2 - 6.4 / 7.0)).abs() < 1e-9,
        "{last:?}"
    );
    let names: Vec<&str> = run.events.iter().map(|event| event.name.as_str()).collect();
    assert_eq!(names.last(), Some(&"floor stops"), "{names:?}");
    let history = &run.contacts()[0];
    let modes: Vec<ContactMode> = history.modes.iter().map(|(mode, _)| *mode).collect();
    assert_eq!(modes, [ContactMode::Open, ContactMode::Slides, ContactMode::Sticks]);
}

/// ∫₀⁵ |cos 2t| dt = 3 + sin(10 − 3π)/2: a guide without clearance presses on one side or the other, and the side changes where the push vanishes.
#[test]
fn a_guide_without_clearance_presses_on_one_side_after_the_other() {
    let guide = |contact: &str| {
        format!(
            "name: Guide\nparameters: {{m: 1 kg, F: 4 N, w: 2 rad/s, mu: 0.2, P: 3 N}}\ncoordinates: {{x: m, y: m}}\n\
             bodies: {{block: {{mass: m, position: \"[x, y]\"}}}}\n\
             forces: {{push: {{on: block, force: \"[P, F*cos(w*t)]\"}}}}\n\
             contacts:\n  low: {{gap: y, on: block, normal: \"[0, 1]\"{contact}}}\n  \
             high: {{gap: -y, on: block, normal: \"[0, -1]\"{contact}}}\n\
             scene: {{start: {{x: 0, y: 0}}, until: 5, tolerance: 1e-10}}\n"
        )
    };
    let rubbed = 0.2 * 4.0 * (3.0 + 0.5 * (10.0 - 3.0 * std::f64::consts::PI).sin());
    for (contact, lost) in [("", 0.0), (", friction: mu", rubbed), (", restitution: 0", 0.0)] {
        let file = File::new("guide", &guide(contact));
        let found = json(&["simulate", &file.0]);
        assert_eq!(names(&found), ["high lifts", "low lifts", "high lifts"], "{contact}");
        near(&found["v"]["x"], 15.0 - lost, 1e-8);
        assert_eq!(found["q"]["y"], 0.0);
    }
}
