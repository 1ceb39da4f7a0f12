//! Held values against closed forms, Taylor series and each other: what sets them, when, and what is refused.
#![cfg(all(feature = "cli", feature = "modal"))]

mod program;

use dalembert::mechanism::{At, Dynamic, Interpreted, System};
use dalembert::{Error, Simulate};
use dalembert_symbolic::lower::compile;
use program::{File, json, near, reference, run};
use serde_json::Value;

dalembert::model!("../models/sampled_robot.yaml");
dalembert::model!("../models/thermostat.yaml");
dalembert::model!("../models/counter.yaml");
dalembert::model!("../tests/states/two_rates.yaml");

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn model(name: &str) -> String {
    format!("{ROOT}/models/{name}.yaml")
}

fn two_rates() -> String {
    format!("{ROOT}/tests/states/two_rates.yaml")
}

/// A body of 1 kg on a line, with more sections.
fn body(name: &str, more: &str) -> File {
    let text = format!(
        "name: Body\nparameters: {{m: 1 kg, k: 4 N/m, T: 0.1 s, one: 1 m, N: 1 N}}\ncoordinates: {{x: m}}\n\
         bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\n{more}"
    );
    File::new(name, &text)
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

#[test]
fn a_robot_holds_its_torque_between_ticks() {
    let expected = reference("sampled_robot");
    let value = |name: &str| expected[name].as_f64().expect("a number");
    for (method, within) in [("auto", 1e-11), ("dopri5", 1e-9), ("radau5", 1e-9), ("rodas5p", 1e-9)] {
        let found = json(&["simulate", &model("sampled_robot"), "--method", method]);
        near(&found["q"]["theta"], value("theta"), within);
        near(&found["v"]["theta"], value("theta'"), 10.0 * within);
        // A run that ends at a tick has done it.
        assert_eq!((&found["memory"]["ticks"], &found["ticks"]["tick"]), (&401.0.into(), &401.into()), "{method}");
        near(&found["outputs"]["lag"], 0.0, 1e-12);
        assert_eq!(found["events"], serde_json::json!([]));
        if method == "auto" {
            // A step a tick, but for the first ones.
            assert!(found["work"]["steps"].as_u64().is_some_and(|steps| (400..410).contains(&steps)), "{found}");
        }
    }
    // The compiled code does the same.
    let compiled = SampledRobot::default().simulate().run().expect("a run");
    assert!((compiled.last()["theta"] - value("theta")).abs() < 1e-11);
    assert_eq!(compiled.memory("ticks"), Some(401.0));
    assert_eq!(compiled.ticks().collect::<Vec<_>>(), [("tick", 401)]);
    assert_eq!(compiled.memory("none"), None);
    // Whoever is not sampled at the end of a step of its own is sampled within it.
    let text = std::fs::read_to_string(model("sampled_robot")).expect("a model");
    let coarse = File::new("coarse", &text.replace("every: 5 ms", "every: 5 ms, from: 2 s"));
    assert_eq!(json(&["simulate", &coarse.0])["memory"]["ticks"], 1.0);
    let late = json(&["simulate", &coarse.0, "--until", "1.9"]);
    assert_eq!((&late["memory"]["ticks"], &late["ticks"]["tick"]), (&0.0.into(), &0.into()));
}

#[test]
fn a_thermostat_remembers_whether_its_heater_is_on() {
    let expected = numbers(&reference("thermostat")["times"]);
    let run = Thermostat::default().simulate().run().expect("a run");
    let times: Vec<f64> = run.events.iter().map(|event| event.state.t).collect();
    assert_eq!(times.len(), 7);
    for (found, expected) in times.iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
    // The reported state at an event is the one after it, and every column is piecewise constant.
    let on = run.column("on").expect("a column");
    for (t, on) in run.times().iter().zip(on) {
        let switched = expected.iter().filter(|time| **time <= *t).count();
        if *t < 90.0 && expected.iter().all(|time| (time - t).abs() > 1e-6) {
            assert_eq!(on, f64::from(u8::from(switched % 2 == 0)), "{t}");
        }
    }
    assert_eq!(run.extremes("on"), Some((0.0, 1.0)));
    // What the events change is conserved between them.
    let check = self::run(&["check", &model("thermostat")]).expect("a check");
    assert!(check.contains("steady is conserved between events"), "{check}");
    assert!(check.contains("changed by `hot`, `cold`") && check.contains("1 held value"), "{check}");
    assert!(run.drift.iter().all(|drift| drift.value.is_some_and(|drift| drift < 1e-9)), "{:?}", run.drift);
}

#[test]
fn passes_are_counted_and_the_tenth_ends_the_run() {
    let expected = reference("counter");
    let run = Counter::default().simulate().run().expect("a run");
    let times: Vec<f64> = run.events.iter().filter(|event| event.name == "pass").map(|event| event.state.t).collect();
    for (found, expected) in times.iter().zip(numbers(&expected["times"])) {
        assert!((found - expected).abs() < 1e-10, "{found} {expected}");
    }
    assert_eq!((times.len(), run.memory("count")), (10, Some(10.0)));
    assert_eq!(run.ended_by().map(|event| event.name.as_str()), Some("enough"));
    // v²/2 = g l (1 - cos 1).
    let fastest = (2.0_f64 * 9.81 * (1.0 - 1.0_f64.cos())).sqrt();
    assert!((run.memory("best").expect("a speed") - fastest).abs() < 1e-10);
    let report = self::run(&["simulate", &model("counter"), "--no-digits"]).expect("a report");
    assert!(report.contains("memory         pass sets count, best"), "{report}");
}

/// x'' = −k x(tick) with period T: x, v ↦ (1 − k T²/2) x + T v, v − k T x.
#[test]
fn a_sampled_spring_follows_its_matrix() {
    let law = "memory: {u: 0 N, n: 0}\nforces: {f: {on: b, force: \"[u, 0]\"}}\n\
        events: {tick: {every: 0.1 s, then: {set: {u: -k*x, n: n + 1}}}}\nscene: {start: {x: 1}, until: 20}\n";
    let (mut x, mut v) = (1.0, 0.0);
    let (k, t) = (4.0, 0.1);
    for _ in 0..200 {
        (x, v) = ((1.0 - 0.5 * k * t * t) * x + t * v, v - k * t * x);
    }
    let parameter = law.replace("every: 0.1 s", "every: T");
    let potential = law.replace("forces: {f: {on: b, force: \"[u, 0]\"}}", "potential_energy: -u*x");
    let input = law.replace("memory:", "inputs: {drive: u}\nmemory:").replace("\"[u, 0]\"", "\"[drive, 0]\"");
    for (name, law) in [("plain", law), ("parameter", &parameter), ("potential", &potential), ("input", &input)] {
        let file = body(&format!("spring-{name}"), law);
        for method in ["auto", "exact", "dop853", "verlet", "gauss4"] {
            let mut arguments = vec!["simulate", &file.0, "--method", method];
            if method == "gauss4" {
                arguments.extend(["--step", "0.03"]);
            }
            let found = json(&arguments);
            near(&found["q"]["x"], x, 1e-9 * x.abs());
            near(&found["v"]["x"], v, 1e-9 * v.abs());
            assert_eq!(found["memory"]["n"], 201.0, "{name} by {method}");
            assert_eq!(found["t"], 20.0);
        }
    }
    // The loop's own eigenvalues: determinant 1 + k T²/2, trace 2 − k T²/2; no period makes it stable.
    let file = body("spring-modes", law);
    let found = json(&["modes", &file.0, "--sampled"]);
    let z: Vec<Vec<f64>> = found["z"].as_array().expect("z").iter().map(numbers).collect();
    assert!((z[0][0] + z[1][0] - (2.0 - 0.5 * k * t * t)).abs() < 1e-14, "{z:?}");
    assert!((z[0][0] * z[1][0] - z[0][1] * z[1][1] - (1.0 + 0.5 * k * t * t)).abs() < 1e-14);
    assert_eq!((&found["stable"], &found["critical_periods"]), (&false.into(), &Value::Null));
    assert_eq!(found["unread"], serde_json::json!(["n"]));
}

#[test]
fn many_ticks_end_where_they_are_to_and_keep_nothing() {
    let text = "name: Idle\nparameters: {m: 1 kg}\ncoordinates: {x: m}\nmemory: {n: 0}\n\
        bodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
        events: {tick: {every: 5 ms, then: {set: {n: n + 1}}}}\nscene: {start: {x': 1}, until: 500}\n";
    let mut system = Interpreted::new(compile(text, &[]).expect("a model"), text);
    let mut settings = dalembert::Settings::of_scene(&system, 0);
    (settings.dense, settings.every) = (false, Some(250.0));
    let run = dalembert::simulate(&mut system, &settings).expect("a run");
    assert_eq!((run.last().t, run.memory("n"), run.last()["x"]), (500.0, Some(100_001.0), 500.0));
    assert_eq!((run.len(), run.events.len(), run.work.steps), (3, 0, 100_000));
}

#[test]
fn two_clocks_meet_exactly() {
    let run = TwoRates::default().simulate().run().expect("a run");
    let held = |name: &str| run.memory(name).expect("a held value");
    assert_eq!((held("fast"), held("slow"), held("both")), (201.0, 61.0, 21.0));
    // 200 + 60 ticks after the start, of which 20 coincide: one step to each instant, and none between two that nearly meet.
    assert_eq!(run.work.steps, 240);
    // The map over the common period is what a run makes of each departure.
    let found = json(&["modes", &two_rates(), "--sampled"]);
    near(&found["period"], 0.05, 1e-16);
    assert_eq!(found["instants"], 12);
    near(&found["equilibrium"]["x"], 1.0, 1e-14);
    near(&found["memory"]["r"], 1.0, 1e-14);
    assert_eq!(found["variables"], serde_json::json!(["x", "x'", "u", "r"]));
    let map: Vec<Vec<f64>> = found["map"].as_array().expect("a map").iter().map(numbers).collect();
    for (column, name) in ["x", "x'", "u", "r"].into_iter().enumerate() {
        let at = |departs: &str, rest: f64| if departs == name { rest + 1.0 } else { rest };
        let run = TwoRates::default()
            .simulate()
            .starting("x", at("x", 1.0))
            .starting("x'", at("x'", 0.0))
            .starting("u", at("u", 0.0))
            .starting("r", at("r", 1.0))
            .until(0.05 - 1e-13)
            .run()
            .expect("a run");
        let last = run.last();
        let found = [last["x"] - 1.0, last["x'"], run.memory("u").expect("u"), run.memory("r").expect("r") - 1.0];
        for (row, found) in found.into_iter().enumerate() {
            assert!((map[row][column] - found).abs() < 1e-10, "{name}: row {row}, {} {found}", map[row][column]);
        }
    }
    // Periods without a common one within reach are refused.
    let text = std::fs::read_to_string(two_rates()).expect("a model").replace("1/60 s", "0.0166666 s");
    let file = File::new("incommensurable", &text);
    let problem = self::run(&["modes", &file.0, "--sampled"]).expect_err("too many ticks");
    assert!(problem.contains("more than 10000 ticks"), "{problem}");
}

#[test]
fn a_sampled_loop_is_unstable_from_a_period_on() {
    let expected = reference("sampled_robot");
    let found = json(&["modes", &model("sampled_robot"), "--sampled"]);
    near(&found["equilibrium"]["theta"], expected["rest"].as_f64().expect("a number"), 1e-15);
    near(&found["residual"], 0.0, 1e-15);
    let pairs = |list: &Value| {
        let mut pairs: Vec<Vec<f64>> = list.as_array().expect("a list").iter().map(numbers).collect();
        pairs.sort_by(|a, b| a[1].total_cmp(&b[1]));
        pairs
    };
    for (name, within) in [("z", 1e-14), ("s", 1e-11)] {
        for (found, expected) in pairs(&found[name]).iter().zip(pairs(&expected[name])) {
            assert!((found[0] - expected[0]).hypot(found[1] - expected[1]) < within, "{found:?} {expected:?}");
        }
    }
    let critical = expected["critical_period"].as_f64().expect("a number");
    near(&found["critical_periods"][0], critical, 1e-14);
    assert_eq!((&found["forgotten"], &found["stable"]), (&1.into(), &true.into()));
    // Runs say so, too: beside the rest a departure grows or dies out.
    let text = std::fs::read_to_string(model("sampled_robot")).expect("a model");
    for (factor, grows) in [(0.99, false), (1.01, true)] {
        let period = format!("every: {} s", factor * critical);
        let file = File::new(&format!("critical-{grows}"), &text.replace("every: 5 ms", &period));
        let start = format!("theta={}", expected["rest"].as_f64().expect("a number") + 1e-6);
        let at = |until: &str| {
            let found = json(&["simulate", &file.0, "--start", &start, "--until", until, "--no-digits"]);
            let (q, v) = (found["q"]["theta"].as_f64().expect("q"), found["v"]["theta"].as_f64().expect("v"));
            (q - expected["rest"].as_f64().expect("a number")).hypot(v / 11.4)
        };
        assert_eq!(at("40") > at("10"), grows, "{factor}");
    }
    let warned = json(&["modes", &model("sampled_robot")]);
    let told = warned["warnings"].to_string();
    assert!(told.contains("`u`, `ticks` are held: this is the open loop; `modes --sampled` closes it"), "{told}");
    let problem = run(&["modes", &model("sampled_robot"), "--sampled", "--bode", "x.svg"]).expect_err("no such thing");
    assert!(problem.contains("--sampled"), "{problem}");
    let problem = run(&["modes", &model("counter"), "--sampled"]).expect_err("no clock");
    assert!(problem.contains("no event happens `every` so often"), "{problem}");
}

/// A vibration of 31.4 rad/s, seen every 0.1 s, has turned by half a turn.
#[test]
fn what_is_seen_too_seldom_is_warned_of() {
    let law = "memory: {u: 0 N}\nsprings: {s: {stretch: x, stiffness: 961 N/m, on: b, along: ground.x}}\n\
        forces: {f: {on: b, force: \"[u, 0]\"}}\nevents: {tick: {every: 0.1 s, then: {set: {u: -k*x/100}}}}\n";
    let file = body("aliased", law);
    let text = run(&["modes", &file.0, "--sampled"]).expect("a loop");
    assert!(text.contains("vibrates faster than 5 Hz looks slower"), "{text}");
    let found = json(&["modes", &file.0, "--sampled"]);
    assert_eq!(found["aliased"].as_array().map(Vec::len), Some(2), "{found}");
}

#[test]
fn a_run_cut_in_two_is_the_run_in_one_piece() {
    let saved = |name: &str| std::env::temp_dir().join(format!("dalembert-memory-{name}-{}.txt", std::process::id()));
    let cut = |file: &str, at: &str, until: &str| {
        let [whole, first, second] = ["whole", "first", "second"].map(|name| saved(&format!("{name}-{at}")));
        let path = |path: &std::path::Path| path.to_str().expect("a path").to_owned();
        run(&["simulate", file, "--until", until, "--save", &path(&whole), "--no-digits"]).expect("a run");
        run(&["simulate", file, "--until", at, "--save", &path(&first), "--no-digits"]).expect("a run");
        let arguments = ["simulate", file, "--state", &path(&first), "--until", until, "--no-digits"];
        run(&[&arguments[..], &["--save", &path(&second)]].concat()).expect("a run");
        let texts = [&whole, &second].map(|path| std::fs::read_to_string(path).expect("a state"));
        let first_text = std::fs::read_to_string(&first).expect("a state");
        [&whole, &first, &second].into_iter().for_each(|path| std::fs::remove_file(path).expect("a file"));
        // The length that a step could have where a stop limits it is no number of the motion.
        let numbers = texts.map(|text| text.lines().filter(|line| !line.starts_with("step:")).collect::<String>());
        (numbers, first_text)
    };
    for at in ["1", "0.735", "0.05"] {
        let ([whole, pieces], first) = cut(&model("sampled_robot"), at, "2");
        assert_eq!(whole, pieces, "{at}");
        assert!(first.contains("\"next(tick)\": ") && first.contains("\"u\": "), "{first}");
    }
    let ([whole, pieces], _) = cut(&two_rates(), "0.35", "1");
    assert_eq!(whole, pieces);
    // What is no number of a tick, and no clock.
    let file = File::new("ticks", "\"next(tick)\": 2.5\n");
    let problem = run(&["simulate", &model("sampled_robot"), "--state", &file.0]).expect_err("no number");
    assert!(problem.contains("whole number"), "{problem}");
    let file = File::new("clocks", "\"next(tack)\": 2\n");
    let problem = run(&["simulate", &model("sampled_robot"), "--state", &file.0]).expect_err("no clock");
    assert!(problem.contains("no event that ticks is called `tack`"), "{problem}");
}

#[test]
fn a_set_is_of_the_values_before_and_sets_follow_each_other() {
    let law = |name: &str, then: &str, third: &str| {
        let events = format!(
            "memory: {{a: 1, e: 2, c: 0, d: 0}}\nevents:\n  first: {{every: 1 s, from: 1 s, then: {then}}}\n  \
             second: {{every: 0.5 s, from: 0.5 s, then: {{set: {{c: a}}}}}}\n  \
             third: {{on_set: {third}, then: {{set: {{d: d + c}}}}}}\nscene: {{until: 1}}\n"
        );
        body(&format!("order-{name}"), &events)
    };
    let held = |name: &str, then: &str| {
        let found = json(&["simulate", &law(name, then, "c").0]);
        ["a", "e", "c", "d"].map(|name| found["memory"][name].as_f64().expect("a number"))
    };
    // At 0.5 s c = a = 1 and d = 1; at 1 s first, then second, then third.
    assert_eq!(held("exchange", "{set: {a: e, e: a}}"), [2.0, 1.0, 2.0, 3.0]);
    assert_eq!(held("list", "[{set: {a: e}}, {set: {e: a}}]"), [2.0, 2.0, 2.0, 3.0]);
    assert_eq!(held("record", "[{set: {a: 7}}, record]"), [7.0, 2.0, 7.0, 8.0]);
    // What stops leaves the rest of its instant to be set.
    assert_eq!(held("stop", "[{set: {a: 7}}, stop]"), [7.0, 2.0, 7.0, 8.0]);
    assert_eq!(held("stop-first", "[stop, {set: {a: 7}}]"), [7.0, 2.0, 7.0, 8.0]);
    let found = json(&["simulate", &law("events", "[{set: {a: 7}}, record]", "c").0]);
    assert_eq!(found["events"].as_array().map(Vec::len), Some(1));
    // What follows itself never ends.
    let problem = run(&["simulate", &law("cycle", "{set: {a: 7}}", "[c, d]").0]).expect_err("a cycle");
    assert!(problem.contains("third"), "{problem}");
}

#[test]
fn states_are_set_and_what_jumps_crosses_nothing() {
    // A leaky bucket is filled each second; that its function jumps over zero then is no event of `full`.
    let text = "name: Bucket\nparameters: {tau: 1 s, level: 1.5 1}\nstates: {z: {unit: 1, rate: -z/tau}}\nmemory: {n: 0}\n\
        events:\n  fill: {every: 1 s, then: {set: {z: z + 1}}}\n  \
        low: {when: z - level/2, direction: falling, then: {set: {n: n + 1}}}\n  \
        full: {when: z - level/2, direction: rising, then: stop}\nscene: {start: {z: 0}, until: 3, tolerance: 1e-12}\n";
    let file = File::new("bucket", text);
    let found = json(&["simulate", &file.0]);
    let decay = (-1.0_f64).exp();
    let expected = (((decay + 1.0) * decay + 1.0) * decay) + 1.0;
    near(&found["states"]["z"], expected, 1e-10);
    assert_eq!((&found["t"], &found["memory"]["n"]), (&3.0.into(), &3.0.into()));
    // An event at its zero where the run ends belongs to it, with what it sets.
    let text = "name: End\nparameters: {m: 1 kg}\ncoordinates: {x: m}\nmemory: {n: 0}\nbodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
        events: {zero: {when: x, then: {set: {n: n + 1}}}}\nscene: {start: {x: -1, x': 1}, until: 1}\n";
    let file = File::new("end", text);
    assert_eq!(json(&["simulate", &file.0])["memory"]["n"], 1.0);
    assert_eq!(json(&["simulate", &file.0, "--until", "0.999"])["memory"]["n"], 0.0);
    // A tick exactly at a zero takes nothing from the event there, and none of its crossings is lost.
    let text = text.replace("events: {", "events: {tick: {every: 0.25 s, then: {set: {n: n + 10}}}, ");
    let file = File::new("both", &text);
    assert_eq!(json(&["simulate", &file.0, "--until", "2"])["memory"]["n"], 91.0);
}

#[test]
fn what_sets_and_starts_at_its_zero_moving_past_is_named() {
    let tank = |direction: &str| {
        let text = format!(
            "name: Tank\nparameters: {{r: 1 kg/s}}\nstates: {{fuel: {{unit: kg, rate: -r*open}}}}\nmemory: {{open: 1}}\n\
             events: {{empty: {{when: fuel{direction}, then: {{set: {{open: 0}}}}}}}}\nscene: {{start: {{fuel: 2 kg}}, until: 5}}\n"
        );
        File::new("tank", &text)
    };
    let warnings = |direction: &str, fuel: &str| {
        json(&["simulate", &tank(direction).0, "--start", &format!("fuel={fuel}")])["warnings"].to_string()
    };
    assert!(warnings(", direction: falling", "0").contains("already at or past its zero"));
    // Coming to rest at zero is no turn that may be missed, and passing in any direction may be meant.
    for (direction, fuel) in [(", direction: falling", "2"), (", direction: rising", "0"), ("", "2"), ("", "0")] {
        let told = warnings(direction, fuel);
        assert!(!told.contains("already at") && !told.contains("turns back"), "{direction} from {fuel}: {told}");
    }
}

#[test]
fn discontinuities_of_held_values_need_no_crossing() {
    // A force of sign(u) |x|, u = -1 from 1 s on; and min(u, x), which switches where x passes u as it is held then.
    let law = "memory: {u: 1}\nforces:\n  f: {on: b, force: \"[sign(u)*N, 0]\"}\n\
        events: {turn: {every: 1 s, from: 1 s, then: {set: {u: -u}}}}\nscene: {until: 2}\n";
    let file = body("sign", law);
    let found = json(&["simulate", &file.0]);
    near(&found["q"]["x"], 1.0, 1e-12);
    near(&found["v"]["x"], 0.0, 1e-12);
    let law = "memory: {place: 1 m}\nforces:\n  f: {on: b, force: \"[k*min(place, x) + N, 0]\"}\n\
        events: {tick: {every: 0.5 s, from: 0.5 s, then: {set: {place: place/2}}}}\nscene: {until: 2, tolerance: 1e-11}\n";
    let file = body("min", law);
    let dop853 = json(&["simulate", &file.0, "--method", "dop853"]);
    let radau5 = json(&["simulate", &file.0, "--method", "radau5"]);
    near(&radau5["q"]["x"], dop853["q"]["x"].as_f64().expect("x"), 1e-8);
    // 1: x'' = 4 x + 1 until x = place, then constant 4 place + 1, which halves: by hand.
    let (mut x, mut v, mut place, steps) = (0.0_f64, 0.0_f64, 1.0_f64, 2_000_000);
    let h = 2.0 / f64::from(steps);
    for k in 0..steps {
        if k > 0 && k % (steps / 4) == 0 {
            place *= 0.5;
        }
        let a = |x: f64| 4.0 * place.min(x) + 1.0;
        let middle = (x + 0.5 * h * v, v + 0.5 * h * a(x));
        (x, v) = (x + h * middle.1, v + h * a(middle.0));
    }
    near(&dop853["q"]["x"], x, 1e-5);
}

#[test]
fn starts_by_hand_and_columns() {
    let found = json(&["simulate", &model("sampled_robot"), "--start", "ticks=10", "--until", "0.1", "--no-digits"]);
    assert_eq!(found["memory"]["ticks"], 31.0);
    let csv = run(&["simulate", &model("sampled_robot"), "--csv", "-", "--every", "0.5"]).expect("a table");
    assert_eq!(csv.lines().next(), Some("t,theta,theta',lag,u,ticks"));
    let last: Vec<f64> = csv.lines().last().expect("a row").split(',').filter_map(|x| x.parse().ok()).collect();
    assert_eq!((last[0], last[5]), (2.0, 401.0));
    let scenes = "memory: {n: 3, u: 2*N}\nevents: {tick: {every: 1 s, then: {set: {n: n + 1}}}}\nscene: {until: 0.5}\n\
        scenes: {more: {start: {n: 30}}}\n";
    let file = body("scenes", scenes);
    assert_eq!(json(&["simulate", &file.0])["memory"], serde_json::json!({"n": 4.0, "u": 2.0}));
    assert_eq!(json(&["simulate", &file.0, "--scene", "more"])["memory"]["n"], 31.0);
    assert_eq!(json(&["simulate", &file.0, "--set", "N=5"])["memory"]["u"], 10.0);
    let swept = run(&["sweep", &file.0, "--vary", "N=1,2", "--csv", "-"]).expect("a table");
    let mut rows = swept.lines().map(|line| line.split(',').collect::<Vec<&str>>());
    let place = rows.next().and_then(|names| names.iter().position(|name| *name == "u")).expect("a column of u");
    let held: Vec<Option<f64>> = rows.map(|row| row[place].parse().ok()).collect();
    assert_eq!(held, [Some(2.0), Some(4.0)], "{swept}");
}

#[test]
fn held_values_are_read_and_set_step_by_step() {
    let mut hand = SampledRobot::default().simulate().tolerance(1e-11).by_hand().expect("a run");
    // The tick at the start has been: its torque turns the arm to 1 rad.
    let first = SampledRobot::default().simulate().until(0.0).run().expect("a start");
    assert_eq!((hand.memory("u"), hand.memory("none")), (first.memory("u"), None));
    assert_eq!(hand.memory("u"), Some(60.0));
    // The ticks of the file go on by themselves, whatever the steps are.
    hand.advance(0.0123).expect("a step");
    assert_eq!(hand.memory("ticks"), Some(3.0));
    let (state, held) = (hand.state(), hand.memory("u").expect("u"));
    assert_eq!(state["u"], held);
    hand.set_memory("u", 5.0).expect("a held value");
    hand.advance(0.0027).expect("a step");
    assert_eq!(hand.memory("ticks"), Some(4.0));
    // Until the tick it was held at 5 N m: a motor alone would turn by u h²/2.
    let turned = hand.state()["theta'"] - state["theta'"];
    let expected = (5.0 - 9.81 * state["theta"].sin() - 0.05 * state["theta'"]) / 0.5 * 0.0027;
    assert!((turned - expected).abs() < 1e-2 * expected.abs(), "{turned} {expected}");
    assert!(matches!(hand.set_memory("none", 1.0), Err(Error::UnknownName { .. })));
    assert!(matches!(hand.set_memory("u", f64::NAN), Err(Error::BadSetting { .. })));
    // In steps of a period, or of less, it is the run in one piece.
    let whole = SampledRobot::default().simulate().until(0.5).run().expect("a run");
    for (step, count) in [(0.005, 100), (0.002, 250)] {
        let mut hand = SampledRobot::default().simulate().by_hand().expect("a run");
        (0..count).for_each(|_| assert!(hand.advance(step).is_ok()));
        let (state, last) = (hand.state(), whole.last());
        assert!((state["theta"] - last["theta"]).abs() < 1e-11, "{step}");
        assert_eq!(hand.memory("ticks"), whole.memory("ticks"), "{step}");
    }
}

#[test]
fn generated_code_and_the_interpreter_agree() {
    let texts = ["sampled_robot", "counter"].map(|name| std::fs::read_to_string(model(name)).expect("a model"));
    let both: [(Box<dyn System>, &str); 2] = [
        (Box::new(Dynamic::new(SampledRobot::default())), &texts[0]),
        (Box::new(Dynamic::new(Counter::default())), &texts[1]),
    ];
    for (mut compiled, text) in both {
        let mut interpreted = Interpreted::new(compile(text, &[]).expect("a model"), text);
        assert_eq!(compiled.sampling(), interpreted.sampling());
        assert_eq!(compiled.memory(), interpreted.memory());
        assert_eq!(compiled.scene_memory(0), interpreted.scene_memory(0));
        assert_eq!(compiled.clocks(), interpreted.clocks());
        compiled.set_memory(&[0.7, -3.0]);
        interpreted.set_memory(&[0.7, -3.0]);
        let parameter = compiled.parameters()[0];
        compiled.set_parameter(0, 1.5 * parameter);
        interpreted.set_parameter(0, 1.5 * parameter);
        let at = At::new(0.3, &[0.4], &[-1.1]);
        let [mut one, mut two] = [[0.0; 2]; 2];
        compiled.assignments(at, &mut one);
        interpreted.assignments(at, &mut two);
        assert_eq!(one, two);
        let [mut one, mut two] = [[0.0; 1]; 2];
        compiled.accelerations(at, &mut one).expect("accelerations");
        interpreted.accelerations(at, &mut two).expect("accelerations");
        assert!((one[0] - two[0]).abs() < 1e-14 * one[0].abs());
    }
}

#[test]
fn what_does_not_take_held_values_says_so() {
    let robot = model("sampled_robot");
    for (arguments, words) in [
        (vec!["orbit", &robot], "holds values that events set"),
        (vec!["needs", &robot], "holds values that events set"),
        (vec!["simulate", &robot, "--slopes", "Kp"], "values that are held"),
    ] {
        let problem = run(&arguments).expect_err("not known");
        assert!(problem.contains(words), "{arguments:?}: {problem}");
    }
    let infinite = body(
        "infinite",
        "memory: {u: 1}\nevents: {tick: {every: 1 s, then: {set: {u: 1/x*one}}}}\nscene: {until: 2}\n",
    );
    let problem = run(&["simulate", &infinite.0]).expect_err("no number");
    assert!(problem.contains("`u`, set by `tick`,"), "{problem}");
    let clock = body("clock", "memory: {u: 1}\nevents: {tick: {every: T, then: {set: {u: 2}}}}\nscene: {until: 2}\n");
    // Ticks so near to each other would never end.
    for period in ["0", "-1", "1e-30", "1e-15"] {
        let problem = run(&["simulate", &clock.0, "--set", &format!("T={period}")]).expect_err("no period");
        assert!(problem.contains("positive period"), "{problem}");
    }
    let run = Counter::default().simulate().starting("none", 1.0).run();
    assert!(matches!(run, Err(Error::UnknownName { .. })));
}

#[test]
fn a_period_must_be_one() {
    for (every, code) in
        [("0 s", "E411"), ("-1 s", "E411"), ("1 m", "E242"), ("x", "E2"), ("u", "E270"), ("1/0 s", "E")]
    {
        let file = body(
            "period",
            &format!("memory: {{u: 1}}\nevents: {{tick: {{every: {every}, then: {{set: {{u: 2}}}}}}}}\n"),
        );
        let problem = run(&["check", &file.0]).expect_err("no period");
        assert!(problem.contains(code), "{every}: {problem}");
    }
}
