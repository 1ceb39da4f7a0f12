//! States of first order against matrix exponentials and Taylor series in 40 digits, and what is refused.
#![cfg(all(feature = "cli", feature = "modal"))]

mod program;
mod state_space;

use dalembert::mechanism::{At, Dynamic, Interpreted, System};
use dalembert::{Method, Simulate};
use dalembert_symbolic::lower::compile;
use program::{File, json, near, reference, run};
use serde_json::Value;

dalembert::model!("../models/motor.yaml");
dalembert::model!("../tests/states/lugre.yaml");
dalembert::model!("../tests/states/thermostat.yaml");

const MODELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../models");

/// The file of a model, of the library or of these tests.
fn model(name: &str) -> String {
    let own = format!("{MODELS}/../tests/states/{name}.yaml");
    if std::path::Path::new(&own).exists() { own } else { format!("{MODELS}/{name}.yaml") }
}

fn read(name: &str) -> String {
    std::fs::read_to_string(model(name)).expect("a model")
}

#[test]
fn a_motor_follows_its_matrix_exponential_by_every_general_method() {
    let expected = reference("motor");
    let value = |name: &str| expected[name].as_f64().expect("a number");
    for (method, within) in
        [("auto", 1e-9), ("dop853", 1e-9), ("dopri5", 1e-7), ("radau5", 1e-7), ("rodas5p", 1e-7), ("exact", 1e-9)]
    {
        let found = json(&["simulate", &model("motor"), "--until", "0.5", "--method", method]);
        near(&found["q"]["phi"], value("phi"), within * 50.0);
        near(&found["v"]["phi"], value("phi'"), within * 170.0);
        near(&found["states"]["i"], value("i"), within * 12.0);
        let text = found.to_string();
        assert!(!text.contains('∫'), "{text}");
        // i is told with digits of its own, and nothing else beside phi and phi'.
        let digits: Vec<&String> = found["digits"].as_object().expect("digits").keys().collect();
        assert_eq!(digits, ["phi", "phi'", "i", "power", "heat"]);
    }
    for method in ["gauss4", "gauss6", "rk4", "midpoint", "gauss2", "euler"] {
        let found = json(&["simulate", &model("motor"), "--method", method, "--step", "1e-4", "--until", "0.01"]);
        assert!(found["states"]["i"].as_f64().expect("a number") > 1.0, "{method}");
    }
}

#[test]
fn methods_that_move_places_and_speeds_in_turn_are_refused_with_the_reason() {
    for method in ["verlet", "srkn4", "suzuki4", "kahanli8", "rkn8"] {
        let problem = run(&["simulate", &model("pid"), "--method", method]).expect_err("no such method");
        assert!(problem.contains("states of first order"), "{method}: {problem}");
    }
    // A state that no force reads and that reads no speed makes no difference.
    let quadrature = "name: Q\nparameters: {m: 1 kg, k: 4 N/m}\ncoordinates: {x: m}\n\
        states: {s: {unit: m*s, rate: x}}\nbodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
        springs: {s0: {stretch: x, stiffness: k, on: b, along: ground.x}}\nscene: {start: {x: 1}, until: 1}\n";
    let file = File::new("quadrature", quadrature);
    assert!(run(&["simulate", &file.0, "--method", "verlet", "--step", "0.1"]).is_err());
    let found = json(&["simulate", &file.0]);
    near(&found["states"]["s"], 2.0_f64.sin() / 2.0, 1e-9);
}

#[test]
fn the_motor_has_no_spurious_zero() {
    let expected = reference("motor");
    let found = json(&["modes", &model("motor")]);
    assert_eq!(found["variables"], serde_json::json!(["phi", "phi'", "i"]));
    assert_eq!(found["zeros"], 1);
    for (row, expected) in found["A"].as_array().expect("A").iter().zip(expected["A"].as_array().expect("A")) {
        for (x, y) in row.as_array().expect("a row").iter().zip(expected.as_array().expect("a row")) {
            near(x, y.as_f64().expect("a number"), 1e-12 * 1e3);
        }
    }
    for (row, value) in found["B"].as_array().expect("B").iter().zip([0.0, 0.0, 1000.0]) {
        near(&row[0], value, 1e-9);
    }
    let values = found["eigenvalues"].as_array().expect("eigenvalues");
    assert_eq!(values.len(), 3);
    for (value, expected) in values.iter().zip(expected["eigenvalues"].as_array().expect("eigenvalues")) {
        near(&value[0], expected.as_f64().expect("a number"), 1e-11);
        near(&value[1], 0.0, 0.0);
    }
    // The shape of the slow decay is in the null space of A − λ.
    let shape: Vec<f64> =
        found["shapes"][0].as_array().expect("a shape").iter().map(|x| x[0].as_f64().expect("a number")).collect();
    let slow = -2.606_533_362_835_29;
    assert!(
        (slow * shape[0] - shape[1]).abs() < 1e-12
            && (slow * shape[1] + 0.1 * shape[1] - 50.0 * shape[2]).abs() < 1e-10
    );
}

#[test]
fn kirchhoffs_law_is_a_second_derivation_of_the_rate() {
    let told = run(&["check", &model("motor")]).expect("a motor");
    assert!(told.contains("1 coordinate, 1 state of first order") && !told.contains('∫'), "{told}");
    assert!(!told.contains("stated once"), "{told}");
    let wrong = read("motor").replace("rate: (u - R*i - K*phi')/L", "rate: (u - R*i + K*phi')/L");
    let file = File::new("wrong", &wrong);
    let problem = run(&["check", &file.0]).expect_err("a wrong sign");
    assert!(problem.contains("E506") && problem.contains("gives i' ="), "{problem}");
    let once = read("motor").replace("    - equation: L*i' + R*i + K*phi' = u\n", "");
    let file = File::new("once", &once);
    let told = run(&["check", &file.0]).expect("a motor");
    assert!(told.contains("the rate of i is stated once"), "{told}");
    // By the balances alone.
    let found = json(&["simulate", &model("motor"), "--until", "0.5", "--by", "balances"]);
    near(&found["states"]["i"], 3.612_304_766_620_35, 1e-8);
}

#[test]
fn a_pid_law_settles_and_its_rest_is_found_from_anywhere() {
    let expected = reference("pid");
    let value = |name: &str| expected[name].as_f64().expect("a number");
    let found = json(&["simulate", &model("pid")]);
    for found in [found, json(&["simulate", &model("pid"), "--method", "exact"])] {
        near(&found["q"]["x"], value("x"), 1e-9);
        near(&found["v"]["x"], value("x'"), 1e-9);
        near(&found["states"]["e"], value("e"), 1e-9);
        near(&found["states"]["f"], value("f"), 1e-9);
    }
    for [x, e, f] in [["x=0", "e=0", "f=0"], ["x=-30", "e=1e3", "f=7"], ["x=0", "e=-1e6", "f=0"]] {
        let found = json(&["modes", &model("pid"), "--input", "ref=1", "--at", x, "--at", e, "--at", f]);
        near(&found["equilibrium"]["x"], 1.0, 1e-12);
        near(&found["equilibrium"]["e"], 0.15, 1e-12);
        near(&found["equilibrium"]["f"], 1.0, 1e-12);
        assert_eq!((found["zeros"].as_u64(), found["variables"].as_array().map(Vec::len)), (Some(0), Some(4)));
        let values = found["eigenvalues"].as_array().expect("eigenvalues");
        for (value, expected) in values.iter().zip(expected["eigenvalues"].as_array().expect("eigenvalues")) {
            near(&value[0], expected[0].as_f64().expect("a number"), 1e-10);
            near(&value[1], expected[1].as_f64().expect("a number"), 1e-10);
        }
    }
}

#[test]
fn bristles_stick_and_slip() {
    let expected = reference("lugre");
    let found = json(&["simulate", &model("lugre")]);
    near(&found["q"]["x"], expected["x"].as_f64().expect("a number"), 2e-8);
    near(&found["outputs"]["friction"], expected["F"].as_f64().expect("a number"), 2e-8);
    near(&found["states"]["z"], expected["z"].as_f64().expect("a number"), 1e-12);
    let text = read("lugre").replace("outputs:", "events:\n  turn: {when: x', then: record}\noutputs:");
    let file = File::new("lugre", &text);
    let found = json(&["simulate", &file.0, "--until", "10.3"]);
    let turns: Vec<&Value> = found["events"].as_array().expect("events").iter().map(|event| &event["t"]).collect();
    let expected = expected["turns"].as_array().expect("turns");
    let first = turns.iter().position(|t| (t.as_f64().expect("a time") - 10.266).abs() < 1e-3).expect("the first turn");
    for (found, expected) in turns[first..].iter().zip(expected).take(2) {
        near(found, expected.as_f64().expect("a number"), 1e-7);
    }
}

#[test]
fn a_branch_of_a_solid_is_a_state_or_a_massless_joint() {
    let expected = reference("maxwell");
    let massless = "name: Maxwell\nparameters: {m: 1 kg, k0: 4 N/m, k1: 10 N/m, c: 3 N*s/m}\ncoordinates: {x: m, z: m}\n\
        bodies: {b: {mass: m, position: \"[x, 0]\"}, Z: {mass: 0, position: \"[z, 0]\"}}\n\
        springs: {s0: {stretch: x, stiffness: k0, on: b, along: ground.x}, s1: {stretch: x - z, stiffness: k1, on: b, from: Z, along: ground.x}}\n\
        dampers: {d: {rate: z', damping: c, on: Z, along: ground.x}}\n\
        scene: {start: {x: 1, z: 0}, until: 3, tolerance: 1e-12}\n";
    let file = File::new("massless", massless);
    for (path, joint) in [(model("maxwell"), "outputs"), (file.0.clone(), "q")] {
        let found = json(&["simulate", &path]);
        near(&found["q"]["x"], expected["x"].as_f64().expect("a number"), 1e-10);
        near(&found["v"]["x"], expected["x'"].as_f64().expect("a number"), 1e-10);
        let z = if joint == "q" { &found["q"]["z"] } else { &found["outputs"]["joint"] };
        near(z, expected["z"].as_f64().expect("a number"), 1e-10);
    }
    let found = json(&["modes", &model("maxwell"), "--at", "x=2", "--at", "f=-3"]);
    near(&found["equilibrium"]["x"], 0.0, 1e-12);
    near(&found["equilibrium"]["f"], 0.0, 1e-12);
    let mut values: Vec<(f64, f64)> = found["eigenvalues"].as_array().expect("eigenvalues").iter().map(pair).collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let known: Vec<(f64, f64)> = expected["eigenvalues"].as_array().expect("eigenvalues").iter().map(pair).collect();
    for (found, known) in values.iter().zip(known) {
        assert!((found.0 - known.0).hypot(found.1 - known.1) < 1e-11, "{found:?} {known:?}");
    }
}

fn pair(value: &Value) -> (f64, f64) {
    (value[0].as_f64().expect("a number"), value[1].as_f64().expect("a number"))
}

#[test]
fn a_room_without_any_coordinate_is_heated_and_cools() {
    let expected = reference("thermostat");
    let times: Vec<f64> = expected["times"].as_array().expect("times").iter().filter_map(Value::as_f64).collect();
    for (scene, lasts) in [("scene", times[0]), ("cooling", times[1] - times[0]), ("heating", times[2] - times[1])] {
        let found = json(&["simulate", &model("thermostat"), "--scene", scene]);
        near(&found["t"], lasts, 1e-9);
        assert_eq!(found["q"], serde_json::json!({}));
    }
    let found = json(&["modes", &model("thermostat"), "--at", "T=300 K"]);
    near(&found["equilibrium"]["T"], 323.0, 1e-9);
    near(&found["eigenvalues"][0][0], -0.01, 1e-15);
    let csv = run(&["simulate", &model("thermostat"), "--csv", "-"]).expect("a table");
    assert_eq!(csv.lines().next(), Some("t,T,heating"));
}

/// Everything that generated code and the interpreter compute at a state.
fn everything(system: &dyn System, q: &[f64], v: &[f64], a: &[f64]) -> Vec<f64> {
    let description = system.description();
    let (n, at) = (q.len(), At::new(0.3, q, v).accelerated(a));
    let mut all = vec![0.0; n];
    system.accelerations(At::new(0.3, q, v), &mut all).expect("accelerations");
    let mut more = |size: usize, compute: &dyn Fn(&mut [f64])| {
        let mut values = vec![0.0; size];
        compute(&mut values);
        all.extend(values);
    };
    more(n, &|x| system.bias(at, x));
    more(n, &|x| system.residual(at, x));
    more(description.mass_pattern.len(), &|x| system.mass_matrix(at, x));
    more(description.stiffness_pattern.len(), &|x| {
        system.jacobians(at, x, &mut vec![0.0; description.damping_pattern.len()])
    });
    more(description.damping_pattern.len(), &|x| {
        system.jacobians(at, &mut vec![0.0; description.stiffness_pattern.len()], x)
    });
    more(description.output_len(), &|x| system.outputs(at, x));
    more(2 * description.events.len(), &|x| system.events(at, x));
    more(description.events.len(), &|x| system.event_rates(at, x));
    more(2 * description.switches.len(), &|x| system.switches(at, x));
    more(2 * description.invariant_len(), &|x| system.invariants(at, x));
    all
}

#[test]
fn compiled_and_interpreted_code_say_the_same() {
    let compiled: [(&str, Box<dyn System>); 3] = [
        ("motor", Box::new(Dynamic::new(Motor::default()))),
        ("lugre", Box::new(Dynamic::new(Lugre::default()))),
        ("thermostat", Box::new(Dynamic::new(Thermostat::default()))),
    ];
    for (name, compiled) in compiled {
        let text = read(name);
        let program = compile(&text, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
        let interpreted = Interpreted::new(program, &text);
        assert_eq!(compiled.description().coordinates, interpreted.description().coordinates);
        let n = compiled.len();
        let numbers = |k: f64| (0..n).map(|i| (1.7 * i as f64 + k).sin()).collect::<Vec<f64>>();
        let (q, v, a) = (numbers(0.3), numbers(1.1), numbers(2.3));
        let (x, y) = (everything(&*compiled, &q, &v, &a), everything(&interpreted, &q, &v, &a));
        assert_eq!(x.len(), y.len(), "{name}");
        for (x, y) in x.iter().zip(&y) {
            assert!((x - y).abs() <= 1e-13 * x.abs().max(1.0), "{name}: {x} {y}");
        }
    }
}

#[test]
fn a_run_goes_on_from_its_saved_state() {
    let path = std::env::temp_dir().join(format!("dalembert-states-saved-{}.yaml", std::process::id()));
    let saved = path.to_str().expect("a path");
    run(&["simulate", &model("pid"), "--until", "2", "--save", saved]).expect("a run");
    let text = std::fs::read_to_string(saved).expect("a state");
    assert!(
        text.contains("\"e\": ") && text.contains("\"x'\": ") && !text.contains('∫') && !text.contains("e'"),
        "{text}"
    );
    let found = json(&["simulate", &model("pid"), "--state", saved, "--until", "5"]);
    std::fs::remove_file(saved).expect("the file");
    near(&found["states"]["e"], 0.154_892_701_463_501, 1e-9);
    near(&found["q"]["x"], 1.002_519_027_032_12, 1e-9);
}

/// Where its bristles slip first, what is fastest vibrates; later it decays, and stability would hold an explicit method to some 36,000 steps.
#[test]
fn what_vibrates_at_first_and_decays_later_is_stiff() {
    let path = std::env::temp_dir().join(format!("dalembert-states-stiff-{}.yaml", std::process::id()));
    let saved = path.to_str().expect("a path");
    run(&["simulate", &model("lugre"), "--until", "7.75", "--save", saved]).expect("a run");
    let found = json(&["simulate", &model("lugre"), "--state", saved, "--until", "25", "--no-digits"]);
    std::fs::remove_file(saved).expect("the file");
    let whole = json(&["simulate", &model("lugre"), "--no-digits"]);
    assert_eq!(found["method"], "rodas5p");
    near(&found["q"]["x"], whole["q"]["x"].as_f64().expect("a number"), 1e-8);
}

#[test]
fn slopes_know_states_by_name() {
    // e of a leaky integral: z = z0 e^(−t/τ) + τ (1 − e^(−t/τ)), so that ∂z/∂z0 = e^(−t/τ).
    let text = "name: Leak\nparameters: {tau: 2 s}\nstates: {z: {unit: s, rate: 1 - z/tau}}\n\
        scene: {start: {z: 5 s}, until: 3, tolerance: 1e-11}\n";
    let file = File::new("leak", text);
    let found = run(&["simulate", &file.0, "--slopes", "z,tau"]).expect("slopes");
    assert!(found.contains("z") && !found.contains('∫'), "{found}");
    let e = (-1.5_f64).exp();
    assert!(found.contains(&format!("{e:.6}")), "{e} in {found}");
    // And are found: which start is needed to come to 3?
    let found = json(&["solve", &file.0, "--unknown", "z=4", "--such-that", "z=3"]);
    let expected = (3.0 - 2.0 * (1.0 - e)) / e;
    assert!(found.to_string().contains(&format!("{expected:.6}")), "{expected} in {found}");
}

#[test]
fn what_does_not_take_states_says_so() {
    let table = std::env::temp_dir().join(format!("dalembert-states-none-{}.csv", std::process::id()));
    let csv = table.to_str().expect("a path");
    for arguments in [
        vec!["orbit", "pid", "--period", "1"],
        vec!["needs", "pid"],
        vec!["modes", "pid", "--drive", "ref", "--omega", "3"],
        vec!["sweep", "pid", "--vary", "k=1..2:2", "--modes", "2", "--csv", csv],
        vec!["show", "pid", "--python"],
        vec!["show", "pid", "--linear"],
    ] {
        let path = model(arguments[1]);
        let mut all = arguments.clone();
        all[1] = &path;
        let problem = run(&all).expect_err("a refusal");
        assert!(problem.contains("states of first order"), "{arguments:?}: {problem}");
        assert!(!problem.contains('∫'), "{problem}");
    }
    let _ = std::fs::remove_file(csv);
    let problem = run(&["simulate", &model("motor"), "--start", "i'=0"]).expect_err("a refusal");
    assert!(problem.contains("`i'` is the rate of a state"), "{problem}");
    let problem = run(&["simulate", &model("motor"), "--set", "i=0"]).expect_err("a refusal");
    assert!(problem.contains("--start \"i=…\""), "{problem}");
}

#[test]
fn a_sweep_varies_a_state_at_the_start() {
    let path = std::env::temp_dir().join(format!("dalembert-states-sweep-{}.csv", std::process::id()));
    let csv = path.to_str().expect("a path");
    run(&["sweep", &model("motor"), "--vary", "i=0..4:3", "--until", "1e-3", "--csv", csv]).expect("a sweep");
    let text = std::fs::read_to_string(csv).expect("a table");
    std::fs::remove_file(csv).expect("the file");
    assert!(text.lines().count() == 4 && !text.contains('∫'), "{text}");
}

#[test]
fn scales_change_no_answer() {
    let expected = -(-3.0_f64).exp_m1();
    for unit in [1e-12, 1.0, 1e12] {
        let text = format!(
            "name: Scale\nparameters: {{tau: 1 s, level: {unit:e} A}}\nstates: {{i: {{unit: A, rate: (level - i)/tau}}}}\n\
             outputs: {{part: i/level}}\nscene: {{until: 3, tolerance: 1e-10}}\n"
        );
        let file = File::new(&format!("scale{unit:e}"), &text);
        let found = json(&["simulate", &file.0]);
        near(&found["outputs"]["part"], expected, 1e-9);
        let digits = found["digits"]["i"].as_u64().expect("digits");
        assert!((8..=15).contains(&digits), "{digits}");
    }
}

#[test]
fn families_keywords_and_jumping_rates() {
    // A ladder of RC elements by a family; `type` and `self` are words of Rust; a saturated integrator jumps.
    let text = "name: Ladder\nsizes: {n: 4}\nparameters: {R: 1 ohm, C: 1 F, U: 1 V}\n\
        states:\n  \"v[0]\": {unit: V, rate: \"(U - v[0])/(R*C)\"}\n  \"v[i in 1..n]\": {unit: V, rate: \"(v[i-1] - v[i])/(R*C)\"}\n  \
        type: {unit: V*s, rate: \"max(0, v[0] - U/2)\"}\n  self: {unit: s, rate: \"sign(v[1] - U/2)\"}\n\
        outputs: {last: \"v[4]\"}\nscene: {until: 3, tolerance: 1e-11}\n";
    let file = File::new("ladder", text);
    let found = json(&["simulate", &file.0]);
    // Of k + 1 equal lags: 1 − e^(−t) Σ t^j/j!.
    let sum: f64 = (0..=4).map(|j| 3.0_f64.powi(j) / f64::from((1..=j).product::<i32>())).sum();
    near(&found["states"]["v[4]"], 1.0 - (-3.0_f64).exp() * sum, 1e-9);
    // ∫ max(0, 1/2 − e^(−t)) dt from ln 2 to 3.
    near(&found["states"]["type"], 0.5 * (3.0 - 2.0_f64.ln()) - (0.5 - (-3.0_f64).exp()), 1e-9);
    // v[1] = 1 − e^(−t)(1 + t) = 1/2 at 1.678346990016661.
    near(&found["states"]["self"], 3.0 - 2.0 * 1.678_346_990_016_661, 1e-8);
}

#[test]
fn states_act_in_phases_and_end_them() {
    // A weight on a winch whose current builds up: it is held until the pull exceeds the weight.
    let text = "name: Winch\nparameters: {m: 1 kg, g: 10 m/s^2, K: 5 N/A, L: 1 H, R: 1 ohm, U: 4 V}\ncoordinates: {y: m}\n\
        states: {i: {unit: A, rate: (U - R*i - K*y')/L}}\nbodies: {w: {mass: m, position: \"[0, y]\"}}\ngravity: [0, -g]\n\
        forces: {pull: {on: w, force: \"[0, K*i]\"}}\nconstraints: {rest: y}\nphases: {resting: [rest], lifted: []}\n\
        events: {lift: {phase: resting, when: reaction(rest), direction: falling, then: lifted}}\n\
        scene: {start: {y: 0}, until: 2, tolerance: 1e-10}\n";
    let file = File::new("winch", text);
    let found = json(&["simulate", &file.0]);
    // i = 4 (1 − e^(−t)) = 2 at ln 2.
    near(&found["events"][0]["t"], 2.0_f64.ln(), 1e-9);
    // Then K² y'' + … : i' = 4 − i − 5 v, v' = 5 i − 10 from i = 2, v = 0: steady v = 0.4, i = 2.
    let steady = json(&["simulate", &file.0, "--until", "40"]);
    near(&steady["v"]["y"], 0.4, 1e-7);
    near(&steady["states"]["i"], 2.0, 1e-7);
}

#[test]
fn what_is_struck_has_the_mass_of_its_state() {
    // A body of 1 kg and what it carries, 3 e^(−0.3 t) kg, runs into one of 1 kg after 0.5 s.
    let text = |mass: &str, then: &str| {
        format!(
            "name: Struck\nparameters: {{m: 1 kg, s0: 3 kg, w: 0.3 1/s}}\ncoordinates: {{x: m, y: m}}\n\
             states: {{s: {{unit: kg, rate: -w*s}}}}\n\
             bodies: {{a: {{mass: {mass}, position: \"[x, 0]\"}}, b: {{mass: m, position: \"[y, 0]\"}}}}\n\
             constraints: {{touch: x - y}}\nphases: {{apart: [], together: [touch]}}\n\
             events: {{hit: {{phase: apart, when: x - y, then: {then}}}}}\n\
             scene: {{start: {{x: 0, y: 1, \"x'\": 2, s: s0}}, until: 0.9}}\n"
        )
    };
    let carried = 3.0 * (-0.15_f64).exp();
    let bounces = "{impact: 1, along: touch}";
    for (mass, then, shared) in [("m + s", "together", 1.0), ("m + s", bounces, 2.0), ("m", "together", 1.0)] {
        let file = File::new("struck", &text(mass, then));
        let found = json(&["simulate", &file.0, "--slopes", "s0"]);
        let inertia = if mass == "m" { 1.0 } else { 1.0 + carried };
        near(&found["v"]["y"], shared * 2.0 * inertia / (inertia + 1.0), 1e-9);
        // d/ds0 of that: 2/(M + 1)² dM/ds0.
        let slope = if mass == "m" { 0.0 } else { shared * 2.0 / (inertia + 1.0).powi(2) * carried / 3.0 };
        near(&found["slopes"]["s0"]["y'"]["value"], slope, 1e-9);
    }
}

#[test]
fn a_state_that_nothing_reads_and_names_that_clash() {
    let clash = "name: Clash\ncoordinates: {i: m}\nstates: {i: {unit: m, rate: i'}}\nkinetic_energy: i'^2/2\n";
    let file = File::new("clash", clash);
    let problem = run(&["check", &file.0]).expect_err("two of one name");
    assert!(problem.contains("E202"), "{problem}");
    let parameter = "name: Clash\nparameters: {i: 1}\nstates: {i: {unit: \"1\", rate: -i}}\n";
    let file = File::new("clash2", parameter);
    assert!(run(&["check", &file.0]).expect_err("two of one name").contains("E202"));
}

#[test]
fn typed_simulations_start_and_read_states() {
    let run = Motor::default().simulate().starting("i", 2.0).until(0.1).run().expect("a run");
    assert!((run.first()["i"] - 2.0).abs() < 1e-15);
    let last = run.last();
    let names: Vec<String> = last.entries().map(|(name, _)| name).collect();
    assert_eq!(names, ["phi", "phi'", "i"]);
    assert_eq!(run.column("i").expect("a column").len(), run.len());
    let stiff = Motor::default().simulate().method(Method::Radau5).until(0.5).run().expect("a run");
    assert!((stiff.last()["i"] - 3.612_304_766_620_35).abs() < 1e-7);
}
