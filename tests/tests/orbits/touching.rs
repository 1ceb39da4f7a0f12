//! Motions through impacts, contacts that stick, and walls that are touched.

use dalembert_tests::told::{near, number, reference, written};

use super::{holds, multiplied, told};

/// An oscillator beside a wall at 1 m.  Off a wall without loss it bounces with any energy beyond 0.5 J: with one freedom all multipliers are known,
/// also where it all but touches.  With loss it has no motion that repeats beyond 0.5 J.
#[test]
fn families_end_where_a_wall_is_touched() {
    let file = written(
        "name: Graze\nparameters: {m: 1 kg, k: 1 N/m, w: 1 m, e: 0.5}\ncoordinates: {x: m}\npoints: {P: \"[x, 0]\"}\n\
         bodies: {b: {mass: m, position: P}}\nsprings: {s: {stretch: x, stiffness: k}}\nconstraints: {wall: x - w}\n\
         phases: {free: [], at: [wall]}\n\
         events: {hit: {phase: free, when: x - w, direction: rising, then: {impact: e, along: wall}}}\n\
         scene: {start: {x: -1}, until: 40, tolerance: 1e-11}\n",
    );
    let arguments = ["--set", "e=1", "--start", "x=-1.2", "--vary", "energy=0.72..0.45"];
    let found = told(&[&[file.as_str()], &arguments[..]].concat()).unwrap();
    assert_eq!(found["thresholds"], serde_json::json!([]));
    assert!(found["ended"].as_str().unwrap().contains("touched"), "{}", found["ended"]);
    for member in found["members"].as_array().unwrap() {
        assert_eq!(member["multipliers"], serde_json::json!([]), "{member}");
        // From the wall at w = A cos φ to the wall again: T = 2 (π − φ), which grows like a root where the wall is all but touched.
        let energy = number(&member["value"]);
        if energy > 0.501 {
            let phi = (1.0 / (2.0 * energy).sqrt()).acos();
            near(number(&member["period"]), 2.0 * (std::f64::consts::PI - phi), 1e-11);
        }
    }
    let found = told(&[&file, "--from", "mode 1", "--vary", "energy=0.1..0.8"]).unwrap();
    let members = found["members"].as_array().unwrap();
    assert!(members.len() > 5 && members.iter().all(|member| number(&member["value"]) < 0.5 + 1e-6), "{found}");
    assert!(found["ended"].is_string());
}

/// A ball that bounces once each time its table goes down and up: determinant e², trace 1 + e² + …, here by the reference's multipliers.
#[test]
fn a_ball_bounces_on_a_table() {
    let known = &reference("ball_on_table")["cases"][0]["points"][0];
    let file = written(&format!(
        "name: BallOnTable\nparameters: {{m: 1 kg, g: 9.81 m/s^2, e: 0.5, H: 0.0136 m, A: {} m, w: 20*pi rad/s, ph: {} rad}}\n\
         coordinates: {{y: m}}\ninputs: {{table: A*cos(w*t + ph)}}\npoints: {{P: \"[0, y]\"}}\n\
         bodies: {{ball: {{mass: m, position: P}}}}\ngravity: [0, -g]\nconstraints: {{rest: y - table}}\n\
         phases: {{flight: [], carried: [rest]}}\n\
         events:\n  bounce: {{phase: flight, when: y - table, direction: falling, then: {{impact: e, along: rest}}}}\n\
         \x20 lift: {{phase: carried, when: reaction(rest), direction: falling, then: flight}}\n\
         scene: {{start: {{y: A*cos(ph + pi) + H, \"y'\": 0.05}}, until: 5, tolerance: 1e-12}}\n",
        known["A"].as_str().unwrap(),
        number(&known["impact_phase"]) + std::f64::consts::PI,
    ));
    let found = told(&[&file]).unwrap();
    near(number(&found["period"]["value"]), 0.1, 1e-14);
    multiplied(&found["multipliers"], &known["multipliers"], 1e-9);
    assert_eq!(found["events"], serde_json::json!(["bounce"]));
    // With a period that is stated the unstable motion is found from beside it: between two bounces, g T²/8 above where it bounces.
    let known = &reference("ball_on_table")["cases"][0]["points"][1];
    let phase = format!("ph={:?}", number(&known["impact_phase"]) + std::f64::consts::PI);
    let beside = ["--set", &phase, "--set", "H=0.0122625", "--start", "y'=1e-3", "--period", "0.1"];
    let found = told(&[&[file.as_str()], &beside[..]].concat()).unwrap();
    multiplied(&found["multipliers"], &known["multipliers"], 1e-9);
}

/// A ball whose impacts on a shaken table die out each period: slopes go through no such series.  On a table that never falls as fast as the ball would
/// it is carried, y = A cos w t, from a place at which the speed of both is 0.
#[test]
fn a_ball_that_comes_to_rest_on_its_table_is_said_to_do_so() {
    let file = written(
        "name: Zeno\nparameters: {m: 1 kg, g: 9.81 m/s^2, e: 0.3, A: 2.6 mm, w: 20*pi rad/s}\ncoordinates: {y: m}\n\
         inputs: {table: A*cos(w*t)}\npoints: {P: \"[0, y]\"}\nbodies: {ball: {mass: m, position: P}}\ngravity: [0, -g]\n\
         constraints: {rest: y - table}\nphases: {flight: [], carried: [rest]}\n\
         events:\n  bounce: {phase: flight, when: y - table, direction: falling, then: {impact: e, along: rest}}\n\
         \x20 lift: {phase: carried, when: reaction(rest), direction: falling, then: flight}\n\
         scene: {start: {y: 5 mm, \"y'\": 0}, until: 3, tolerance: 1e-12}\n",
    );
    let refused = told(&[&file]).unwrap_err();
    assert!(refused.contains("impacts accumulate"), "{refused}");
    let found = told(&[&file, "--set", "A=1 mm"]).expect("a motion");
    near(number(&found["start"]["y"]["value"]), 1e-3, 1e-14);
    assert!(found["events"].as_array().unwrap().is_empty(), "{found}");
}

/// Where a held phase is entered a freedom is lost: the multiplier is 0 and nothing else.
#[test]
fn stick_slip_loses_a_dimension() {
    let found = told(&["stick_slip"]).unwrap();
    let known = &reference("stick_slip")["cases"][0];
    holds(&found["period"], number(&known["period"]), 1e-11);
    assert_eq!(found["superstable"], 1);
    assert_eq!(found["multipliers"].as_array().unwrap().len(), 1);
    assert_eq!(found["multipliers"][0]["re"], 0.0);
}

/// A block that sticks to its belt at the start, as a run finds: it slips about μₖ m g/k, for (2π − 2 atan(a ω/v))/ω, and is carried 2 a = 2 (μₛ − μₖ) m g/k.
#[test]
fn friction_that_sticks_at_the_start_begins_a_motion() {
    let file = written(
        "name: Belt\nparameters: {m: 1 kg, k: 100 N/m, v: 0.1 m/s, mus: 0.4 1, muk: 0.2 1, g: 9.81 m/s^2}\ncoordinates: {x: m}\n\
         bodies: {block: {mass: m, position: '[x, 0]'}}\n\
         springs: {s: {stretch: x, stiffness: k, on: block, along: ground.x}}\n\
         friction: {rub: {rate: x' - v, on: block, along: ground.x, limit: muk*m*g, static: mus*m*g}}\n\
         scene: {start: {x: 0.02, x': v}, until: 5}\n",
    );
    let (a, v, omega) = (0.2 * 9.81 / 100.0, 0.1, 10.0);
    let period = (std::f64::consts::TAU - 2.0 * f64::atan(a * omega / v)) / omega + 2.0 * a / v;
    holds(&told(&[&file, "--period", "0.8"]).unwrap()["period"], period, 1e-9);
}

/// A ball that rests on a shaken table goes up and down with it: its start is on the table but for the rounding of the table's place, also where a run
/// has gone on for many periods, and what nothing accelerates there does not differ a period later.
#[test]
fn a_ball_that_rests_on_a_shaken_table_repeats() {
    let file = written(
        "name: Table\nparameters: {m: 1 kg, e: 0.8 1, A: 1 mm, w: 60 rad/s, g: 9.81 m/s^2}\ncoordinates: {y: m}\n\
         inputs: {h: A*sin(w*t)}\nbodies: {ball: {mass: m, position: '[0, y]'}}\ngravity: [0, -g]\n\
         constraints: {floor: y - h}\nphases: {flight: [], rest: [floor]}\n\
         events: {hit: {phase: flight, when: y - h, direction: falling, then: {impact: e, along: floor}}}\n\
         scene: {start: {y: 2 mm, y': 0.4}, until: 5}\n",
    );
    let period = std::f64::consts::TAU / 60.0;
    for until in ["5", "1"] {
        holds(&told(&[&file, "--until", until]).unwrap()["period"], period, 1e-12);
    }
}
