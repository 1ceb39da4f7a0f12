//! Slopes of motions, and searches on them, against closed forms, references of 25 digits and more, and difference quotients.

use std::path::PathBuf;

use dalembert::prelude::*;
use dalembert_models::MODELS;
use dalembert_tests::told::{near, number, reference, told, written};
use serde_json::Value;

/// A thrown ball; `drag` is a force.
fn thrown(drag: &str, until: &str) -> String {
    written(&format!(
        "name: Throw\nparameters: {{m: 2 kg, b: 0.5 N*s/m, c: 0.01 kg/m, g: 10 m/s^2, v0: 10 m/s, angle: 45 deg}}\n\
         coordinates: {{x: m, y: m}}\nbodies: {{ball: {{mass: m, position: \"[x, y]\"}}}}\ngravity: [0, -g]\n\
         forces: {{drag: {{on: ball, force: {drag}}}}}\nevents: {{land: {{when: y, direction: falling, then: stop}}}}\n\
         scene: {{start: {{x: 0, y: 0, x': v0*cos(angle), y': v0*sin(angle)}}, until: {until}, tolerance: 1e-12}}\n"
    ))
}

/// Problem 2 e of the course: the best angle, from 45 degrees, at every speed.
#[test]
fn a_cannon_ball_flies_farthest_at_the_angle_of_the_reference() {
    let known = reference("cannon");
    for (law, drag) in [("linear", "-b*velocity(ball)"), ("quadratic", "-c*norm(velocity(ball))*velocity(ball)")] {
        let file = thrown(drag, "1000");
        for case in known[law].as_array().expect("cases") {
            let speed = format!("v0={}", case["v0"].as_str().expect("a speed"));
            let found =
                told(&["solve", &file, "--set", &speed, "--unknown", "angle=45 deg", "--maximise", "x"]).unwrap();
            near(number(&found["values"]["angle"]["value"]), number(&case["angle"]), 1e-10);
            let range = number(&case["range"]);
            near(number(&found["reached"]["x"]["value"]), range, 1e-12 * range);
            near(number(&found["t"]), number(&case["flight_time"]), 1e-9 * number(&case["flight_time"]));
            assert!(found["steps"].as_u64().unwrap() <= 8, "{found}");
        }
    }
    // Without drag at 45 degrees exactly, from another guess.
    let file = thrown("-b*velocity(ball)", "1000");
    let found = told(&["solve", &file, "--set", "b=0", "--unknown", "angle=40 deg", "--maximise", "x"]).unwrap();
    near(number(&found["values"]["angle"]["value"]), std::f64::consts::FRAC_PI_4, 1e-12);
    // It lands nearest where it hardly leaves: no such place is inside.
    let refused = told(&["solve", &file, "--set", "b=0", "--unknown", "angle=40 deg", "--minimise", "x"]).unwrap_err();
    assert!(refused.contains("angle"), "{refused}");
}

/// Problem 36: a drum on ice that hops; what happens where it `lands`.
fn drum(lands: &str) -> String {
    written(&format!(
        "name: HopOnIce\nparameters: {{m: 1 kg, R: 1 m, d: 0.5 m, I: 0.25 kg*m^2, g: 10 m/s^2}}\n\
         coordinates: {{x: m, y: m, phi: rad}}\npoints: {{centre: \"[x, y]\"}}\n\
         bodies:\n  drum: {{mass: m, inertia: I, angle: -phi, position: \"centre + d*[sin(phi), cos(phi)]\"}}\n\
         gravity: [0, -g]\nconstraints: {{contact: y - R}}\nphases: {{sliding: [contact], flight: []}}\n\
         events:\n  skip: {{phase: sliding, when: reaction(contact), direction: falling, then: flight}}\n{lands}\
         scene: {{start: {{x: 0, y: R, phi: pi, phi': 15.1154962377783829}}, until: 3, tolerance: 1e-12}}\n"
    ))
}

const LANDS: &str = "  land: {phase: flight, when: y - R, direction: falling, then: sliding}\n";
const LANDS_AND_STOPS: &str = "  land: {phase: flight, when: y - R, direction: falling, then: stop}\n";

/// It lands without any relative velocity, by half of the hop.
#[test]
fn a_drum_on_ice_hops_softly() {
    let file = drum("");
    let arguments = ["solve", &file, "--unknown", "phi'=15, until=0.6", "--such-that", "phi=3*pi, y'=0"];
    let found = told(&arguments).unwrap();
    let case = &reference("hop_on_ice")["cases"][0];
    near(number(&found["values"]["phi'"]["value"]), number(&case["omega_bottom"]), 1e-10);
    let half = number(&case["contact_time"]) + number(&case["flight_time"]);
    near(number(&found["values"]["until"]["value"]), 0.5 * half, 1e-10);
    assert!(found["steps"].as_u64().unwrap() <= 7, "{found}");
}

/// How far a number is off, and how far it may be.
fn off(found: &Value, expected: f64) -> [f64; 2] {
    [(number(&found["value"]) - expected).abs(), number(&found["error"])]
}

/// By all of the hop: y and y' vanish where the end time is unknown, and y'' with them.  y' then tells the end time by its square, and y alone
/// by its cube.
#[test]
fn a_soft_landing_is_a_multiple_root() {
    let file = drum(LANDS);
    let case = &reference("hop_on_ice")["cases"][0];
    let landing = 0.5 * number(&case["contact_time"]) + number(&case["flight_time"]);
    for (guess, tolerance) in [("15.1, until=1.1", "1e-12"), ("16, until=1", "1e-12"), ("15.1, until=1.1", "1e-8")] {
        let unknown = format!("phi'={guess}");
        let search = ["solve", &file, "--ignore", "land", "--tolerance", tolerance, "--unknown", &unknown];
        let found = told(&[&search[..], &["--such-that", "y=1, y'=0"]].concat()).unwrap();
        assert_eq!((&found["multiplicity"], &found["multiple_in"]), (&2.into(), &serde_json::json!(["until"])));
        for (name, expected, most) in [("phi'", number(&case["omega_bottom"]), 1.0), ("until", landing, 1e4)] {
            let tolerance: f64 = tolerance.parse().unwrap();
            let [off, error] = off(&found["values"][name], expected);
            assert!(off <= error && error <= most * 300.0 * tolerance, "{name}: {off:e} {error:e} at {tolerance:e}");
        }
        assert_eq!(found["t_error"], found["values"]["until"]["error"]);
    }
    for tolerance in ["1e-12", "1e-8"] {
        let search = ["solve", &file, "--ignore", "land", "--tolerance", tolerance, "--unknown", "until=1.1"];
        let found = told(&[&search[..], &["--such-that", "y=1"]].concat()).unwrap();
        assert_eq!((&found["multiplicity"], &found["multiple_in"]), (&3.into(), &serde_json::json!(["until"])));
        let [off, error] = off(&found["values"]["until"], landing);
        let third = tolerance.parse::<f64>().unwrap().cbrt();
        assert!(off <= error && error <= third, "{off:e} {error:e}");
    }
    // In words, with no digit that does not hold.
    let mut out = Vec::new();
    let search = [
        "dalembert",
        "solve",
        &file,
        "--ignore",
        "land",
        "--unknown",
        "phi'=15.1, until=1.1",
        "--such-that",
        "y=1, y'=0",
    ];
    dalembert::cli::run(MODELS, search, &mut out).unwrap();
    let text = String::from_utf8(out).unwrap();
    assert!(text.contains("  until = 1.090533 s\n") && text.contains("  at t = 1.090533\n"), "{text}");
    assert!(text.contains("a double root in `until`: half of the digits hold; seek half of the motion"), "{text}");
}

/// At the event itself when it happens changes like a root.
#[test]
fn a_soft_landing_is_no_event_to_search_by() {
    let file = drum(LANDS_AND_STOPS);
    for guess in ["phi'=15.1154962377783829", "phi'=15"] {
        let refused = told(&["solve", &file, "--unknown", guess, "--such-that", "y'=0"]).unwrap_err();
        let why = "`land` is touched and not crossed at t = 1.09";
        assert!(refused.contains(why), "{guess}: {refused}");
        assert!(
            refused.contains("let `land` do nothing (--ignore land), and the run end at an unknown `until`"),
            "{refused}"
        );
        assert!(!refused.contains("error: error"), "{refused}");
    }
    let refused = told(&["simulate", &file, "--ignore", "lnad"]).unwrap_err();
    assert!(refused.contains("no event is called `lnad`; did you mean `land`?"), "{refused}");
    // What does nothing is not recorded.
    let ran = told(&["simulate", &file, "--ignore", "land", "--until", "1.2", "--no-digits"]).unwrap();
    let names: Vec<&str> =
        ran["events"].as_array().unwrap().iter().filter_map(|event| event["name"].as_str()).collect();
    assert_eq!(names, ["skip"]);
}

/// A ball that falls through the floor that it does not see.
#[test]
fn an_ignored_event_does_nothing() {
    let ball = || dalembert_models::bouncing_ball::BouncingBall::default().simulate();
    let run = ball().ignore("bounce").until(1.0).run().unwrap();
    assert!(run.events.is_empty());
    near(run.last()["y"], 1.0 - 0.5 * 9.81, 1e-12);
    let found = ball().find().ignore("bounce").unknown("until", 0.6).such_that("y", -1.0).solve().unwrap();
    near(found.get("until").unwrap(), (4.0_f64 / 9.81).sqrt(), 1e-12);
    let refused = ball().ignore("bonce").run().unwrap_err().to_string();
    assert!(refused.contains("no event is called `bonce`"), "{refused}");
    let refused = ball().find().ignore("bonce").unknown("until", 0.6).such_that("y", -1.0).solve().unwrap_err();
    assert!(refused.to_string().contains("no event is called `bonce`"), "{refused}");
}

#[test]
fn a_record_of_a_vibration_gives_its_stiffness_and_damping() {
    let file = written(
        "name: RingDown\nparameters: {m: 1 kg, c: 0.2 N*s/m, k: 39 N/m}\ncoordinates: {x: m}\n\
         bodies: {block: {mass: m, position: \"[x, 0]\"}}\nsprings: {spring: {stretch: x, stiffness: k}}\n\
         dampers: {damper: {rate: x', damping: c}}\nscene: {start: {x: 0.1}, until: 25, tolerance: 1e-11}\n",
    );
    let record = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("reference/orbits/ring_down.csv");
    let record = record.to_str().unwrap();
    let found = told(&["solve", &file, "--unknown", "k=39 N/m, c=0.2, x=0.1, x'=0", "--fit", record]).unwrap();
    let known = &reference("fit")["ring_down"];
    for (name, key) in [("k", "k"), ("c", "c"), ("x", "x0"), ("x'", "v0")] {
        let expected = number(&known["values"][key]);
        near(number(&found["values"][name]["value"]), expected, 1e-9 * expected.abs().max(1.0));
        let error = number(&known["standard_errors"][key]);
        near(number(&found["fit"]["standard_errors"][name]), error, 1e-6 * error);
        let within = number(&known["half_width_95"][key]);
        near(number(&found["fit"]["within_95_percent"][name]), within, 1e-6 * within);
    }
    near(number(&found["fit"]["sigma"]), number(&known["sigma"]), 1e-9);
    let refused = told(&["solve", &file, "--unknown", "k=39 N/m, c=0.2, m=1", "--fit", record]).unwrap_err();
    assert_eq!(refused.matches("by 0.5774").count(), 3, "{refused}");
}

/// The same searches, as motions of the file; options of the command line add to them and take their place.
#[test]
fn motions_of_the_file_are_found_as_those_of_the_command_line() {
    let folder = std::env::temp_dir().join(format!("dalembert-motions-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let references = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("reference/orbits");
    std::fs::copy(references.join("ring_down.csv"), folder.join("ring_down.csv")).expect("a record");
    let file = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).expect("a file");
        path.to_str().expect("a path").to_owned()
    };
    let hop = file(
        "hop.yaml",
        "name: HopOnIce\nparameters: {m: 1 kg, R: 1 m, d: 0.5 m, I: 0.25 kg*m^2, g: 10 m/s^2}\n\
         coordinates: {x: m, y: m, phi: rad}\npoints: {centre: \"[x, y]\"}\n\
         bodies:\n  drum: {mass: m, inertia: I, angle: -phi, position: \"centre + d*[sin(phi), cos(phi)]\"}\n\
         gravity: [0, -g]\nconstraints: {contact: y - R}\nphases: {sliding: [contact], flight: []}\n\
         events:\n  skip: {phase: sliding, when: reaction(contact), direction: falling, then: flight}\n\
         motions:\n  hop: {start: {x: 0, y: R, phi: pi}, unknown: {phi': 15, until: 0.6}, such_that: {phi: 3*pi, y': 0}}\n  \
         rolls: {closes: {at: skip, turn: {phi: 1}, shift: [x]}}\n\
         scene: {start: {phi: 1}, until: 3, tolerance: 1e-12}\n",
    );
    let found = told(&["solve", &hop, "--motion", "hop"]).unwrap();
    let case = &reference("hop_on_ice")["cases"][0];
    near(number(&found["values"]["phi'"]["value"]), number(&case["omega_bottom"]), 1e-10);
    let half = number(&case["contact_time"]) + number(&case["flight_time"]);
    near(number(&found["values"]["until"]["value"]), 0.5 * half, 1e-10);
    let refused = told(&["solve", &hop, "--motion", "rolls"]).unwrap_err();
    assert!(refused.contains("`rolls` closes") && refused.contains("`orbit`"), "{refused}");
    let refused = told(&["solve", &hop, "--motion", "hops"]).unwrap_err();
    assert!(refused.contains("no motion is called `hops`; did you mean `hop`?"), "{refused}");

    let throw = "name: Throw\nparameters: {m: 2 kg, b: 0.5 N*s/m, g: 10 m/s^2, v0: 10 m/s, angle: 45 deg, far: 3 m}\n\
         coordinates: {x: m, y: m}\nbodies: {ball: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\n\
         forces: {drag: {on: ball, force: -b*velocity(ball)}}\nevents: {land: {when: y, direction: falling, then: stop}}\n\
         motions: {best: {unknown: {angle: 40 deg}, maximise: x}, hit: {unknown: {angle: 20 deg}, such_that: {x: 2*far}}}\n\
         scene: {start: {x: 0, y: 0, x': v0*cos(angle), y': v0*sin(angle)}, until: 1000, tolerance: 1e-12}\n";
    let throw = file("throw.yaml", throw);
    for case in reference("cannon")["linear"].as_array().expect("cases") {
        let speed = format!("v0={}", case["v0"].as_str().expect("a speed"));
        let found = told(&["solve", &throw, "--motion", "best", "--set", &speed]).unwrap();
        near(number(&found["values"]["angle"]["value"]), number(&case["angle"]), 1e-10);
    }
    let found = told(&["solve", &throw, "--motion", "hit"]).unwrap();
    near(number(&found["reached"]["x"]["value"]), 6.0, 1e-9);
    // Another value, and another unknown beside it; but not one that the value contains.
    let found = told(&["solve", &throw, "--motion", "hit", "--such-that", "x=5", "--unknown", "v0=9"]).unwrap();
    near(number(&found["reached"]["x"]["value"]), 5.0, 1e-9);
    assert_eq!(found["values"].as_object().expect("values").len(), 2);
    let refused = told(&["solve", &throw, "--motion", "hit", "--unknown", "far=3"]).unwrap_err();
    assert!(refused.contains("the value of `x` contains `far`"), "{refused}");

    let ring = file(
        "ring.yaml",
        "name: RingDown\nparameters: {m: 1 kg, c: 0.2 N*s/m, k: 39 N/m}\ncoordinates: {x: m}\n\
         bodies: {block: {mass: m, position: \"[x, 0]\"}}\nsprings: {spring: {stretch: x, stiffness: k}}\n\
         dampers: {damper: {rate: x', damping: c}}\nscene: {until: 25, tolerance: 1e-11}\n\
         motions:\n  ring: {unknown: {k: 39 N/m, c: 0.2 N*s/m, x: 0.1, x': 0}, fit: {file: ring_down.csv, columns: {t: t, x: x}}}\n",
    );
    let found = told(&["solve", &ring, "--motion", "ring"]).unwrap();
    let known = &reference("fit")["ring_down"];
    for (name, key) in [("k", "k"), ("c", "c"), ("x", "x0"), ("x'", "v0")] {
        let expected = number(&known["values"][key]);
        near(number(&found["values"][name]["value"]), expected, 1e-9 * expected.abs().max(1.0));
        let error = number(&known["standard_errors"][key]);
        near(number(&found["fit"]["standard_errors"][name]), error, 1e-6 * error);
    }
    std::fs::remove_dir_all(&folder).expect("the folder");
}

/// A motion of a compiled model, by the program and in Rust.
#[test]
fn a_motion_of_the_library_is_found_in_rust_too() {
    use dalembert::prelude::*;
    let found = told(&["solve", "cannon_ball", "--motion", "aimed"]).unwrap();
    near(number(&found["reached"]["x"]["value"]), 60.0, 1e-9);
    let ball = dalembert_models::cannon_ball::CannonBall::default();
    let again = ball.simulate().motion("aimed").solve().expect("a steepness");
    near(again.values[0].value, number(&found["values"]["y'"]["value"]), 1e-9);
    let error = ball.simulate().motion("aimd").solve().expect_err("no such motion");
    assert!(error.to_string().contains("aimd"), "{error}");
    let pendulum = dalembert_models::double_pendulum::DoublePendulum::default();
    assert!(pendulum.simulate().motion("swing").solve().expect_err("it closes").to_string().contains("orbit"));
}

/// A ball that is dropped: y = H − g t²/2 until t₁ = √(2 H/g), v = e g t₁ after it.
#[test]
fn slopes_cross_an_impact_as_the_closed_form_does() {
    let found = told(&["simulate", "bouncing_ball", "--until", "0.6", "--slopes", "e,g,H,x'"]).unwrap();
    let (e, g, height, t) = (0.5_f64, 9.81_f64, 1.0_f64, 0.6_f64);
    let first = (2.0 * height / g).sqrt();
    let slope = |name: &str, by: &str| number(&found["slopes"][by][name]["value"]);
    near(slope("y", "e"), g * first * (t - first), 1e-11);
    near(slope("y'", "e"), g * first, 1e-11);
    // y = e g t₁ (t − t₁) − g (t − t₁)²/2, with dt₁/dg = −t₁/2g and dt₁/dH = t₁/2H.
    let by_first = e * g * (t - 2.0 * first) + g * (t - first);
    let by_g = e * first * (t - first) - 0.5 * (t - first).powi(2);
    near(slope("y", "g"), by_g - by_first * first / (2.0 * g), 1e-11);
    near(slope("y", "H"), by_first * first / (2.0 * height), 1e-11);
    near(slope("x", "x'"), t, 1e-12);
    assert!(found["slopes"]["e"]["y"]["error"].as_f64().unwrap() < 1e-9);
}

/// d/dp by six runs, p ± h, ± 2 h, ± 3 h: its error of sixth order is below that of the runs.
fn quotient(arguments: &[&str], option: &str, (name, at): (&str, f64), read: &dyn Fn(&Value) -> f64) -> f64 {
    let h = 5e-4 * at.abs().max(0.1);
    let value = |k: f64| {
        let set = format!("{name}={:?}", at + k * h);
        let all = [&["simulate"], arguments, &["--no-digits", option, &set]].concat();
        read(&told(&all).unwrap_or_else(|problem| panic!("{set}: {problem}")))
    };
    let odd = |k: f64| value(k) - value(-k);
    (45.0 * odd(1.0) - 9.0 * odd(2.0) + odd(3.0)) / (60.0 * h)
}

/// A model, where its run ends, what varies (by which option, at about which value), and what is compared.
type Case = (&'static str, &'static str, &'static [(&'static str, &'static str, f64)], &'static [&'static str]);

#[test]
fn slopes_are_those_of_difference_quotients() {
    // Nonlinear, by a parameter and a start; loops with open starts; phases with friction; rows with speeds; in space; a turning support.
    let cases: [Case; 10] = [
        ("double_pendulum", "2", &[("--set", "l", 1.0), ("--start", "theta1", 1.0)], &["theta1", "theta2"]),
        ("pendulum_cartesian", "1", &[("--set", "l", 1.0)], &["x", "y"]),
        ("four_bar", "0.3", &[("--set", "crank", 0.3)], &["rocker_angle", "coupler_angle"]),
        ("stick_slip", "14", &[("--set", "mu_k", 0.3), ("--set", "belt", 0.1), ("--set", "k", 1.0)], &["x"]),
        ("chaplygin_sleigh", "2", &[("--set", "d", 0.5)], &["theta", "x"]),
        ("rolling_disc", "0.5", &[("--set", "R", 0.5)], &["theta", "x"]),
        ("rssr", "0.3", &[("--set", "g", 9.81)], &["alpha", "beta"]),
        ("slider_crank", "0.2", &[("--set", "m_rod", 3.0), ("--set", "rod", 3.0)], &["crank_angle", "piston_x"]),
        ("bennett", "0.2", &[("--set", "m2", 2.0)], &["th1"]),
        ("base_excitation", "1", &[("--set", "k", 100.0), ("--set", "m", 1.0)], &["x"]),
    ];
    let mut compared = 0;
    for (model, until, unknowns, outputs) in cases {
        let entry = MODELS.iter().find(|entry| entry.name == model).expect("a model");
        let known: Vec<String> = (entry.compiled.expect("its code"))()
            .description()
            .parameters
            .iter()
            .map(|parameter| parameter.name.to_string())
            .collect();
        for (option, name, _) in unknowns {
            let system = (entry.compiled.expect("its code"))();
            let place = known.iter().position(|parameter| parameter == name);
            let scene = system.scene(0);
            let coordinates = &system.description().coordinates;
            let start = |name: &str| match name.strip_suffix('\'') {
                Some(rate) => coordinates.iter().position(|c| c.name == rate).map(|i| scene.v[i]),
                None => coordinates.iter().position(|c| c.name == name).map(|i| scene.q[i]),
            };
            // The model's own value.
            let at = place.map(|place| system.parameters()[place]).or_else(|| start(name)).expect("a value");
            let arguments = [model, "--until", until, "--tolerance", "1e-13"];
            let found = told(&[&["simulate"], &arguments[..], &["--no-digits", "--slopes", name]].concat());
            let found = found.unwrap_or_else(|problem| panic!("{model} {name}: {problem}"));
            for output in outputs {
                let read = |told: &Value| number(&told["q"][*output]);
                let (slope, size) = (number(&found["slopes"][*name][*output]["value"]), read(&found).abs().max(0.1));
                let expected = quotient(&arguments, option, (name, at), &read);
                near(slope, expected, 1e-8 * (expected.abs() + size / at.abs().max(0.1)));
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 24);
}

/// A bead that is thrown along a wire slides alike whatever its mass: what the constraint holds of a change is rounding, and missed by rounding.
#[test]
fn a_bead_on_a_wire_does_not_depend_on_its_mass() {
    let file = written(
        "name: Bead\nparameters: {m: 2 kg, a: 0.5 1/m, g: 10 m/s^2}\ncoordinates: {x: m, y: m}\n\
         bodies: {b: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\nconstraints: {curve: y - a*x^2}\n\
         scene: {start: {x: 1, x': 1}, until: 2, tolerance: 1e-12}\n",
    );
    let found = told(&["simulate", &file, "--slopes", "m"]).expect("slopes");
    for name in ["x", "y", "x'", "y'"] {
        near(number(&found["slopes"]["m"][name]["value"]), 0.0, 1e-13);
    }
}

/// A value that is said of a condition stays while the unknowns are found, as E446 says of files.
#[test]
fn values_of_conditions_contain_nothing_unknown() {
    let file = written(
        "name: Line\nparameters: {a: 2, b: 3}\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\n\
         scene: {start: {x: 0, x': a}, until: 1, tolerance: 1e-12}\n",
    );
    let refused = told(&["solve", &file, "--unknown", "a=2", "--such-that", "x=2*a"]).unwrap_err();
    assert!(refused.contains("the value of `x` contains `a`, which is unknown"), "{refused}");
    // x(1) = a, and b is known.
    let found = told(&["solve", &file, "--unknown", "a=2", "--such-that", "x=2*b"]).expect("a solution");
    near(number(&found["values"]["a"]["value"]), 6.0, 1e-11);
}

/// The farthest throw that lands with 10 m/s: without drag it is thrown with 10 m/s, at 45 degrees, and flies v²/g = 10 m.
#[test]
fn an_extreme_under_conditions_needs_freedom() {
    let file = written(
        "name: Both\nparameters: {m: 1 kg, g: 10 m/s^2}\ncoordinates: {x: m, y: m}\nbodies: {ball: {mass: m, position: \"[x, y]\"}}\n\
         gravity: [0, -g]\nevents: {land: {when: y, direction: falling, then: stop}}\noutputs: {speed: \"sqrt(x'^2 + y'^2)\"}\n\
         scene: {start: {x: 0, y: 0, x': 6, y': 6}, until: 100, tolerance: 1e-12}\n",
    );
    let asked = ["--such-that", "speed=10", "--maximise", "x"];
    let solve = |unknown: &str| told(&[&["solve", &file, "--unknown", unknown], &asked[..]].concat());
    let found = solve("x'=6,y'=6").expect("a throw");
    near(number(&found["values"]["x'"]["value"]), 50.0_f64.sqrt(), 1e-10);
    near(number(&found["reached"]["x"]["value"]), 10.0, 1e-11);
    near(number(&found["reached"]["speed"]["value"]), 10.0, 1e-11);
    let refused = solve("x'=6").unwrap_err();
    assert!(refused.contains("leave nothing free") && refused.contains("x' = 8"), "{refused}");
}

#[test]
fn motions_without_slopes_say_why() {
    let refused = |arguments: &[&str]| told(&[&["simulate"], arguments].concat()).unwrap_err();
    // A ball that comes to rest bounces infinitely often before.
    let text = refused(&["bouncing_ball", "--slopes", "e"]);
    assert!(text.contains("impacts accumulate"), "{text}");
    // What rolls cannot change one speed alone.
    let text = refused(&["rolling_disc", "--until", "0.1", "--slopes", "x'"]);
    assert!(text.contains("`x'`") && text.contains("constraint"), "{text}");
    let text = refused(&["simple_pendulum", "--slopes", "lenght"]);
    assert!(text.contains("no coordinate, rate or parameter is called `lenght`"), "{text}");
    // x = (t - 1)^3 passes 0 without any speed: when it does so changes like a root.
    let touching = written(
        "name: Touch\nparameters: {m: 1 kg, f: 6 N/s, t1: 1 s}\ncoordinates: {x: m}\nbodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
         forces: {push: {on: b, force: \"[f*(t - t1), 0]\"}}\nevents: {pass: {when: x, direction: rising, then: stop}}\n\
         scene: {start: {x: -1, x': 3}, until: 5, tolerance: 1e-10}\n",
    );
    let text = refused(&[&touching, "--slopes", "x"]);
    assert!(text.contains("`pass` is touched and not crossed at t = "), "{text}");
}

#[test]
fn searches_that_fail_say_how_far_they_came() {
    let refused = |arguments: &[&str]| told(&[&["solve"], arguments].concat()).unwrap_err();
    // A pendulum that cannot rise above its start.
    let too_high = ["simple_pendulum", "--until", "2", "--unknown", "theta'=0.1", "--such-that", "bob.y=3"];
    let text = refused(&too_high);
    assert!(text.contains("bob.y"), "{text}");
    let text = refused(&["simple_pendulum", "--unknown", "theta=1"]);
    assert!(text.contains("a search needs"), "{text}");
    let text = refused(&["simple_pendulum", "--unknown", "theta", "--such-that", "theta=1"]);
    assert!(text.contains("--unknown wants NAME=VALUE"), "{text}");
    // Two conditions on one unknown that do not go together.
    let both = ["simple_pendulum", "--until", "1", "--unknown", "theta'=0.1", "--such-that", "theta=0.5,theta'=9"];
    let text = refused(&both);
    assert!(text.contains("theta"), "{text}");
}

/// With more unknowns than conditions the solution nearest to the guess is taken, and what is free is told.
#[test]
fn what_is_free_is_told() {
    let arguments =
        ["solve", "simple_pendulum", "--until", "1", "--unknown", "theta=0.5,theta'=0.1", "--such-that", "theta=0.2"];
    let found = told(&arguments).unwrap();
    assert_eq!(found["free"].as_array().unwrap().len(), 1, "{found}");
    let reached = &found["reached"]["theta"];
    near(number(&reached["value"]), 0.2, 1e-10);
    // What the run itself misses the motion by is told of a condition too.
    let error = number(&reached["error"]);
    assert!(error > 0.0 && error < 1e-9, "{reached}");
}
