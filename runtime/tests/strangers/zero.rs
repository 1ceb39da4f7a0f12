//! What is zero but for rounding, beside what is not: in space, at rest, at the end of a search.

use serde_json::Value;

use super::{case, folder, printed, program, stranger, text_of};

/// About an axis of the ground quaternion and rates have components that are roundings of roundings.
#[test]
fn what_is_across_a_hinge_takes_no_steps() {
    let run = case(&text_of("hinge_across")).run();
    assert!(run.work.steps < 200, "{} steps", run.work.steps);
    // J θ'' = m g h cos θ, J = 1.2 I + m h²: from rest (J/2) ω² = m g h sin θ, with the height of the centre h sin θ.
    let (w, z) = (run.last()["w.y"], run.last()["z"]);
    assert!((0.5 * 0.032 * w * w + 2.0 * 9.81 * z).abs() < 1e-9, "{w} {z}");
    assert!(run.last()["y"].abs() < 1e-20, "{}", run.last()["y"]);
}

#[test]
fn a_wheel_turns_on_an_axle_along_an_axis_of_the_ground() {
    let run = case(&text_of("wheel_on_axle")).run();
    assert!((run.last()["w.z"] - 5.0).abs() < 1e-10);
}

#[test]
fn a_universal_joint_along_an_axis_of_the_ground_is_kept() {
    let run = case(&text_of("cross_of_joint")).run();
    // As it is in minimal coordinates, which project the equations instead of adding multipliers.
    assert!((run.last()["x"] + 0.082_055_935_734_34).abs() < 1e-12, "{}", run.last()["x"]);
}

/// A block that has come to rest has a speed of some 10⁻⁶³, which a run that goes on meets.
#[test]
fn a_block_that_has_stopped_stays_where_it_is() {
    let saved = folder("stopped").join("s.txt");
    let saved = saved.to_str().expect("a path");
    for speed in ["2", "2.5", "3", "3.7", "4"] {
        let start = format!("x'={speed}");
        printed("simulate", "block_stops", &["--start", &start, "--until", "2", "--save", saved]);
        let told = printed("simulate", "block_stops", &["--state", saved, "--until", "3", "--json"]);
        let json: Value = serde_json::from_str(&told).expect("JSON");
        let expected = speed.parse::<f64>().expect("a number").powi(2) / 6.0;
        let x = json["q"]["x"].as_f64().expect("a number");
        assert!((x - expected).abs() < 1e-9, "{speed}: {x} {expected}");
        assert_eq!(json["warnings"], serde_json::json!([]), "{speed}");
    }
}

#[test]
fn a_rest_that_a_contact_cannot_hold_is_told() {
    let warned = |name: &str, more: &[&str]| {
        let json: Value = serde_json::from_str(&printed("modes", name, &[more, &["--json"]].concat())).expect("JSON");
        json["warnings"].to_string()
    };
    assert!(warned("through_floor", &[]).contains("`floor` (open): its sides pass through each other by 0.931 m"));
    assert!(warned("held_by_floor", &["--phase", "floor closed"]).contains("pull at each other with 5.19 N"));
    assert!(!warned("through_floor", &["--phase", "floor closed", "--at", "y=0"]).contains("floor"));
}

#[test]
fn a_hold_that_no_force_meets_is_refused() {
    let path = stranger("level_by_pull");
    let trim = |angle: &str| {
        let hold = format!("th={angle}");
        program(&["modes", path.to_str().expect("a path"), "--hold", &hold, "--solve", "F", "--json"])
    };
    let refused = trim("90deg").unwrap_err();
    assert!(refused.contains("with which it rests with `th` held") && refused.contains("th: 10 N m"), "{refused}");
    // 10 N tan θ.
    let found: Value = serde_json::from_str(&trim("80deg").expect("a trim")).expect("JSON");
    let force = found["trim"].to_string();
    assert!(force.contains("56.71281819617"), "{force}");
    assert!(trim("0").is_ok());
}

#[test]
fn a_motion_that_a_plain_run_does_not_close_is_no_orbit() {
    let path = stranger("resonance");
    let orbit = |frequency: &str| program(&["orbit", path.to_str().expect("a path"), "--set", frequency, "--json"]);
    assert!(orbit("W=2").unwrap_err().contains("the motion misses by"));
    // x = A/(m (ω² − W²)) sin W t.
    let found: Value = serde_json::from_str(&orbit("W=3").expect("an orbit")).expect("JSON");
    let rate = found["start"]["x'"]["value"].as_f64().expect("a number");
    assert!((rate - 3.0 / (4.0 - 9.0)).abs() < 1e-10, "{rate}");
}

/// 0.4999999999 and 1.000000000001 kg are rounded when they are read, which shows where the forces that they make nearly cancel.
#[test]
fn rounded_parameters_of_forces_that_cancel_leave_few_digits() {
    let digits = |name: &str, settings: &[&str], value: &str| -> f64 {
        let told = printed("simulate", name, &[settings, &["--json"]].concat());
        let json: Value = serde_json::from_str(&told).expect("JSON");
        json["digits"][value].as_f64().expect("digits")
    };
    // x' = -g cos(al) (tan(al) - mu) t holds to 6 digits at most: 2⁻⁵⁴ of 0.5 is 3e-7 of 1e-10.
    let nearly = digits("slope_nearly_holds", &["--set", "mu=0.4999999999"], "x'");
    assert!((1.0..=6.0).contains(&nearly), "{nearly}");
    assert!(digits("slope_nearly_holds", &["--set", "mu=0.3"], "x'") >= 9.0);
    let nearly = digits("masses_nearly_alike", &[], "x");
    assert!((2.0..=4.0).contains(&nearly), "{nearly}");
    assert!(digits("masses_nearly_alike", &["--set", "m2=1.1"], "x") >= 9.0);
}

#[test]
fn a_block_rests_by_friction_where_all_its_numbers_are_zero() {
    for place in ["x=0", "x=0.5"] {
        let told = printed("modes", "block_rests_at_zero", &["--at", place]);
        assert!(told.contains("equilibrium at x = ") && told.contains("reaction(floor) at rest = 20 N"), "{told}");
    }
}

/// Every motion of an oscillator closes without damping, and none with however little.
#[test]
fn a_motion_that_is_all_but_undamped_is_no_orbit() {
    let path = stranger("damping_all_but_none");
    let orbit = |damping: &str| program(&["orbit", path.to_str().expect("a path"), "--set", damping, "--json"]);
    for damping in ["c=1e-6", "c=1e-9"] {
        assert!(orbit(damping).unwrap_err().contains("the motion misses by x"), "{damping}");
    }
    assert!(orbit("c=0").is_ok());
}

/// The instant of a push is no number that rounding moves: what begins as the run ends would begin after it.
#[test]
fn a_push_that_begins_as_the_run_ends_leaves_all_digits() {
    for end in ["0.3", "0.6", "0.7", "0.9"] {
        let instant = format!("t1={end}");
        let told = printed("simulate", "push_as_the_run_ends", &["--set", &instant, "--until", end, "--json"]);
        let json: Value = serde_json::from_str(&told).expect("JSON");
        assert!(json["digits"]["x"].as_f64().expect("digits") >= 9.0, "{end}: {}", json["digits"]);
    }
}

/// A bar on two strings keeps its energy. From a start of which only x and y are said, some drawn states have speeds of 10⁻¹⁷ that are what bringing
/// the others to the constraints leaves, and nothing but these stood in its rate.
#[test]
fn speeds_that_constraints_leave_were_an_energy_that_changes() {
    let bar = |length: &str, claim: &str| {
        format!(
            "name: Bifilar\nparameters: {{m: 2 kg, a: 0.3 m, b: 0.2 m, L: {length} m, Iz: 0.05 kg*m^2, It: 0.03 kg*m^2, Ia: 0.055 kg*m^2, g: 9.81 m/s^2}}\n\
             coordinates: {{x: m, y: m, z: m, att: rotation}}\nframes: {{B: {{rotate: att}}}}\n\
             points: {{C: \"[x, y, z]\", P1: C + b*B.x, P2: C - b*B.x, Q1: \"[a, 0, 0]\", Q2: \"[-a, 0, 0]\"}}\n\
             bodies: {{bar: {{mass: m, inertia: [It, Ia, Iz], frame: B, position: C}}}}\ngravity: [0, 0, -g]\n\
             constraints: {{s1: norm(P1 - Q1) - L, s2: norm(P2 - Q2) - L}}\nconserved: {{claim: {claim}}}\n\
             scene: {{start: {{x: 0, y: 0}}, guess: {{z: -{length}}}, until: 5}}\n"
        )
    };
    let check = |length: &str, claim: &str| {
        let file = folder("bifilar").join(format!("l{length}.yaml"));
        std::fs::write(&file, bar(length, claim)).expect("a file");
        program(&["check", file.to_str().expect("a path")])
    };
    for length in ["0.77", "0.9", "1", "1.1", "1.3"] {
        assert!(check(length, "energy").is_ok(), "{length}");
    }
    for wrong in ["energy + m*g*z/1e9", "m*x'", "energy + m*x'*y'/1e6"] {
        assert!(check("1", wrong).is_err(), "{wrong}");
    }
}

/// A block that has come to rest on a floor, 2.5e-28 m above it, and slips now and then: cut at a tick, its run goes on as it would have.
#[test]
fn a_saved_rest_was_moved_by_its_rounding() {
    let text = "
name: Saved
parameters: {m: 1 kg, k: 30 N/m, g: 9.81 m/s^2, kp: 3 N*s/m}
coordinates: {x: m, y: m}
memory: {u: 0 N, top: 0 m}
noise: {gust: {every: 10 ms, sigma: 2 N, seed: 3}}
bodies: {b: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
springs: {s: {stretch: x, stiffness: k, on: b, along: \"[1, 0]\"}}
forces: {f: {on: b, force: \"[u + gust, 0]\"}}
contacts: {floor: {gap: y, on: b, normal: \"[0, 1]\", friction: 0.2, restitution: 0.5}}
events:
  tick: {every: 1/30 s, then: {set: {u: -kp*x'}}}
  apex: {when: y', direction: falling, then: {set: {top: y}}}
scene: {start: {x: 0.1, y: 0.4}, until: 3}
";
    let folder = super::folder("saved-rest");
    let [model, whole, first, second] = ["model.yaml", "whole.txt", "first.txt", "second.txt"]
        .map(|name| folder.join(name).to_str().expect("a path").to_owned());
    std::fs::write(&model, text).expect("written");
    let run = |arguments: &[&str]| {
        let usual = ["simulate", &model, "--method", "dop853", "--no-digits", "-q"];
        super::program(&[&usual[..], arguments].concat()).expect("a run")
    };
    run(&["--until", "2", "--save", &whole]);
    run(&["--until", "1", "--save", &first]);
    run(&["--state", &first, "--until", "2", "--save", &second]);
    let [whole, second] = [whole, second].map(|path| {
        let text = std::fs::read_to_string(path).expect("a state");
        text.lines().filter(|line| line.starts_with('"')).map(str::to_owned).collect::<Vec<_>>()
    });
    let rests = |line: &String| line == "\"y\": 0" || line.starts_with("\"y\": 0.000000000000000000000000000");
    assert!(whole.iter().any(rests), "{whole:?}");
    assert_eq!(whole, second);
    std::fs::remove_dir_all(folder).expect("removed");
}

/// At t = 0 neither the value nor the rate of t² tells on which side it is from then on.
#[test]
fn functions_of_time_leave_zero_with_any_power() {
    // The force to t = 1 s, by integrals of its own.
    let places = [
        ("abs(t^2)", 1.0 / 12.0),
        ("abs(t^3)", 1.0 / 20.0),
        ("sign(t^2)", 0.5),
        ("abs(1 - cos(t))", 0.5 - (1.0 - 1.0_f64.cos())),
        ("abs(sin(t)^2)", 0.25 - 0.25 * 1.0_f64.sin().powi(2)),
        ("max(0, t^2)", 1.0 / 12.0),
    ];
    for (force, x) in places {
        let text = |force: &str, inputs: &str| {
            format!(
                "name: Pushed\ncoordinates: {{x: 1}}\n{inputs}kinetic_energy: x'^2/2\ngeneralized_forces: {{x: \"{force}\"}}\nscene: {{until: 1}}\n"
            )
        };
        for file in [text(force, ""), text("u", &format!("inputs: {{u: \"{force}\"}}\n"))] {
            let found = case(&file).run().last()["x"];
            assert!((found - x).abs() < 1e-9, "{file}: {found} {x}");
        }
    }
}

/// The centre of a body that turns about a level axle is at its height, where its energy is what rounding makes of it.
#[test]
fn what_rests_at_height_zero_keeps_its_energy() {
    let file = "name: Level\nparameters: {m: 1 kg, I: 0.3 kg*m^2, l: 1 m, g: 9.81 m/s^2}\ncoordinates: {x: m, y: m, z: m, q: rotation}\n\
        frames: {F: {rotate: q}}\nbodies: {b: {mass: m, inertia: [I, I, I], frame: F, position: '[x, y, z]'}}\n\
        joints: {j: {hinge: [ground, b], at: ['[0, 0, 0]', 'b - l*b.x'], axis: [ground.x, b.x]}}\ngravity: [0, -g, 0]\n\
        conserved: {E: energy}\nscene: {guess: {x: 1}, until: 0.5}\n";
    let mut case = case(file);
    case.settings.digits = true;
    let run = case.run();
    assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    assert!(run.last()["y"].abs() < 1e-20, "{}", run.last()["y"]);
}

/// A product touches zero in the middle of a stretch in which it keeps its sign, and what is 0 from an instant on has no sign there.
#[test]
fn signs_of_functions_of_time_are_those_between_their_zeros() {
    let speed = |force: &str| {
        let text = format!(
            "name: Pushed\ncoordinates: {{x: 1}}\nkinetic_energy: x'^2/2\ngeneralized_forces: {{x: \"{force}\"}}\nscene: {{until: 5}}\n"
        );
        case(&text).run().last()["x'"]
    };
    for (a, b) in [(16.0, 17.0), (15.0, 17.0), (20.0, 21.0)] {
        // Between neighbouring zeros k π/a and k π/b the sign is that in the middle.
        let zeros =
            |w: f64| (0..=(5.0 * w / std::f64::consts::PI) as usize).map(move |k| k as f64 * std::f64::consts::PI / w);
        let mut times: Vec<f64> = zeros(a).chain(zeros(b)).chain([5.0]).collect();
        times.sort_by(f64::total_cmp);
        let part = |pair: &[f64]| {
            let middle = 0.5 * (pair[0] + pair[1]);
            (pair[1] - pair[0]) * ((a * middle).sin() * (b * middle).sin()).signum()
        };
        let expected: f64 = times.windows(2).map(part).sum();
        let found = speed(&format!("sign(sin({a}*t)*sin({b}*t))"));
        assert!((found - expected).abs() < 1e-9, "{a} {b}: {found} {expected}");
    }
    for (force, expected) in [
        ("sign(step(2 - t))", 2.0),
        ("sign(max(0, 3 - t))", 3.0),
        ("sign(min(0, t - 3))", -3.0),
        ("sign(step(t - 1) - step(t - 2))", 1.0),
        ("sign((t - 1) - abs(t - 1))", -1.0),
        ("sign(max(0, t - 1))", 4.0),
        ("sign(sign(t - 1) + sign(t - 2))", 2.0),
    ] {
        let found = speed(force);
        assert!((found - expected).abs() < 1e-9, "{force}: {found} {expected}");
    }
}

/// Neither side is that of what is no number, whether it is none at the start or becomes none on the way.
#[test]
fn what_is_no_number_has_no_sign() {
    for (force, x, names) in [
        ("sign(sqrt(t - 2))", 0.0, "`sqrt(t - 2)` at t = 0 s"),
        ("sign(sqrt(2 - t))", 0.0, "`sqrt(2 - t)` at t = 2"),
        ("sign(sqrt(x - 2))", 0.0, "`sqrt(x - 2)` at t = 0 s"),
        ("-sign(sqrt(x - 2))", 3.0, "`sqrt(x - 2)` at t = 1.4142135"),
        ("-step(ln(x/2))", 2.5, "at t = 3.00000"),
    ] {
        let text = format!(
            "name: Pushed\ncoordinates: {{x: 1}}\nkinetic_energy: x'^2/2\ngeneralized_forces: {{x: \"{force}\"}}\nscene: {{start: {{x: {x}}}, until: 5}}\n"
        );
        let Err(error) = case(&text).try_run() else { panic!("{force}: no error") };
        let said = error.to_string();
        assert!(said.contains(names) && said.contains("is not finite"), "{force}: {said}");
    }
}

/// A force beside another one that is 10²² times as large is what it is: its own terms say what rounding makes of it.
#[test]
fn an_output_is_no_rounding_of_another() {
    for (stiff, start) in [("1e22", "1"), ("1e12", "1e3")] {
        let file = format!(
            "name: Two\nparameters: {{m: 1 kg, k: 1 N/m, stiff: {stiff} N/m}}\ncoordinates: {{x: m, y: m}}\n\
             kinetic_energy: m*(x'^2 + y'^2)/2\npotential_energy: k*(x^2 + y^2)/2\n\
             outputs: {{small: k*x, large: stiff*y}}\nscene: {{start: {{x: 0.7, y: {start}}}, until: 1, tolerance: 1e-9}}\n"
        );
        let path = folder("beside").join("two.yaml");
        std::fs::write(&path, file).expect("a file");
        let printed = program(&["simulate", path.to_str().expect("a path")]).expect("a run");
        // 0.7 cos 1.
        assert!(printed.contains("small = 0.378211614"), "{printed}");
    }
}
