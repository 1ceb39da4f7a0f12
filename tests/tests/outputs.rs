//! What a run is told to write, and where it starts from: nothing is lost, nothing overwritten.

use std::fs;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;

use dalembert::cli::Session;
use dalembert::prelude::*;
use dalembert_models::MODELS;

const MODEL: &str = "name: Slide
parameters: {m: 1 kg, mu: 0.25, g: 10 m/s^2}
coordinates: {x: m}
bodies: {block: {mass: m, position: \"[x, 0]\"}}
forces: {drag: {on: block, force: \"[-mu*m*g, 0]\"}}
scene: {start: {\"x'\": 3}, set: {mu: 0.5}, until: 0.2}
scenes: {ice: {start: {\"x'\": 3}, set: {mu: 0}, until: 0.2}, usual: {start: {\"x'\": 3}, until: 0.2}}
";

dalembert::model!(
    yaml = r#"
name: Slide
parameters: {m: 1 kg, mu: 0.25, g: 10 m/s^2}
coordinates: {x: m}
bodies: {block: {mass: m, position: "[x, 0]"}}
forces: {drag: {on: block, force: "[-mu*m*g, 0]"}}
scene: {start: {"x'": 3}, set: {mu: 0.5}, until: 0.2}
scenes: {ice: {start: {"x'": 3}, set: {mu: 0}, until: 0.2}, usual: {start: {"x'": 3}, until: 0.2}}
"#
);

/// A folder of its own for a test, with a model file in it.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("dalembert-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join("y.yaml"), MODEL).expect("a file");
    folder
}

/// What the program prints, or what it says is wrong.
fn told(arguments: &[&str]) -> Result<String, String> {
    let mut out = Vec::new();
    let arguments = std::iter::once(&"dalembert").chain(arguments);
    match dalembert::cli::run(MODELS, arguments, &mut out) {
        Ok(()) => Ok(String::from_utf8(out).expect("text")),
        Err(problem) => Err(problem.to_string()),
    }
}

#[cfg(unix)]
#[test]
fn no_output_overwrites_the_model_by_whatever_name() {
    let folder = folder("overwrites");
    let place = |name: &str| folder.join(name).to_string_lossy().into_owned();
    std::os::unix::fs::symlink(folder.join("y.yaml"), folder.join("link.yaml")).expect("a link");
    fs::hard_link(folder.join("y.yaml"), folder.join("hard.yaml")).expect("a link");
    for name in ["y.yaml", "./y.yaml", "link.yaml", "hard.yaml"] {
        for option in ["--csv", "--plot", "--animate"] {
            let refused = told(&["simulate", &place("y.yaml"), option, &place(name)]).expect_err("the model file");
            assert!(refused.contains("would overwrite the model file"), "{name}: {refused}");
        }
    }
    let twice = told(&["simulate", &place("y.yaml"), "--csv", &place("out"), "--plot", &place("./out")]);
    assert!(twice.expect_err("one file").contains("name the same file"));
    assert_eq!(fs::read_to_string(folder.join("y.yaml")).expect("the model"), MODEL);
    told(&["simulate", &place("y.yaml"), "--csv", &place("a"), "--plot", &place("b")]).expect("two files");
    assert!(fs::read_to_string(folder.join("a")).expect("a table").starts_with("t,x,x'"));
    fs::remove_dir_all(folder).expect("to be removed");
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_run() {
    let folder = folder("unwritable");
    let model = folder.join("y.yaml").to_string_lossy().into_owned();
    // A million seconds at this step would take long.
    let refused = told(&["simulate", &model, "--until", "1e6", "--step", "1e-4", "--plot", "/nowhere/at/all.svg"]);
    let refused = refused.expect_err("no such folder");
    assert!(refused.starts_with("error: --plot: cannot write `/nowhere/at/all.svg`"), "{refused}");
    fs::remove_dir_all(folder).expect("to be removed");
}

#[test]
fn scenes_mean_the_same_in_rust_and_on_the_command_line() {
    let folder = folder("scenes");
    let model = folder.join("y.yaml").to_string_lossy().into_owned();
    for (scene, mu) in [("scene", 0.5), ("ice", 0.0), ("usual", 0.5)] {
        let run = Slide::default().simulate().scene(scene).run().expect("a run");
        assert!((run.last()["x'"] - (3.0 - 2.0 * mu)).abs() < 1e-9, "{scene}: {}", run.last());
        let printed = told(&["simulate", &model, "--scene", scene, "--json"]).expect("a run");
        let printed: serde_json::Value = serde_json::from_str(&printed).expect("JSON");
        assert!((printed["v"]["x"].as_f64().expect("a number") - run.last()["x'"]).abs() < 1e-12, "{scene}");
    }
    // `usual` inherits what the first one sets; what was given by hand stays.
    let run = Slide { mu: 0.1, ..Slide::default() }.simulate().scene("ice").run().expect("a run");
    assert!((run.last()["x'"] - 2.8).abs() < 1e-9);
    fs::remove_dir_all(folder).expect("to be removed");
}

#[test]
fn a_negative_mass_is_refused_wherever_it_comes_from() {
    let folder = folder("negative");
    let model = folder.join("y.yaml");
    let refused = told(&["simulate", &model.to_string_lossy(), "--set", "m=-1"]).expect_err("a negative mass");
    assert!(refused.contains("a mass must be positive or 0, this is -1"), "{refused}");
    let error = Slide { m: -1.0, ..Slide::default() }.simulate().run().expect_err("a negative mass");
    assert!(matches!(error.cause(), Some(Cause::NegativeInertia { .. })), "{error}");
    assert!(Slide { m: 1e-9, ..Slide::default() }.simulate().run().is_ok());
    fs::remove_dir_all(folder).expect("to be removed");
}

#[test]
fn where_no_digit_holds_the_time_until_which_it_ran_is_told_all_the_same() {
    let file = folder("coarse").join("coarse.yaml");
    let model = "name: Stiff
parameters: {m: 1 kg, k: 1e6 N/m, d: 2e3 N*s/m}
coordinates: {x: m}
bodies: {block: {mass: m, position: \"[x, 0]\"}}
springs: {s: {stretch: x, stiffness: k, on: block, along: \"[1, 0]\"}}
dampers: {d: {rate: \"x'\", damping: d, on: block, along: \"[1, 0]\"}}
scene: {start: {x: 1}, until: 10}
";
    fs::write(&file, model).expect("a file");
    let text =
        told(&["simulate", file.to_str().expect("a path"), "--method", "rk4", "--step", "0.0015"]).expect("a run");
    assert!(text.starts_with("coarse at t = 10, by rk4"), "{text}");
}

/// The numbers of SVG text, of the axes' labels.
fn plot(folder: &std::path::Path, arguments: &[&str]) -> Result<String, String> {
    let file = folder.join("plot.svg").to_string_lossy().into_owned();
    told(&[arguments, &["--no-digits", "--plot", &file]].concat())?;
    Ok(fs::read_to_string(file).expect("a plot"))
}

#[test]
fn plots_show_what_is_asked_for() {
    let folder = folder("shows");
    let svg = plot(
        &folder,
        &["simulate", "double_pendulum", "--show", "theta1',theta2'", "--show", "tip.x:tip.y", "--show", "hinge_force"],
    );
    let svg = svg.expect("a plot").replace("&apos;", "'");
    for text in ["in rad/s", "theta2'", "tip.x (m)", "tip.y (m)", "in N", "hinge_force.y"] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(!svg.contains(">theta1 ("), "what was not asked for");
    for (show, told) in [
        ("tipp", "no coordinate, rate or output is called `tipp`; did you mean `tip.x`?"),
        ("theta1,tip.w", "no coordinate, rate or output is called `tip.w`"),
        ("tip:theta1", "`tip` is a vector"),
        ("", "no coordinate, rate or output is called ``"),
    ] {
        let refused = plot(&folder, &["simulate", "double_pendulum", "--show", show]).expect_err(show);
        assert!(refused.contains(told), "{refused}");
    }
    fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn sections_have_a_point_a_period() {
    let folder = folder("sections");
    let section = |period: &str, show: &str| {
        plot(
            &folder,
            &["simulate", "base_excitation", "--scene", "free", "--until", "10", "--show", show, "--section", period],
        )
    };
    let count =
        |svg: &str| svg.matches("<circle").count() + svg.matches("<rect").count() + svg.matches("<polygon").count();
    let (few, many) = (section("2.5", "x:x'").expect("a plot"), section("0.5", "x:x'").expect("a plot"));
    assert_eq!(count(&many) - count(&few), 16, "21 points less 5");
    assert!(section("0", "x:x'").expect_err("no period").contains("greater than 0"));
    assert!(section("1", "x").expect_err("no portrait").contains("X:Y"));
    fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn scenes_stand_side_by_side() {
    let folder = folder("beside");
    let svg = plot(&folder, &["simulate", "base_excitation", "--with", "dashpot_end, both_ends", "--show", "x"])
        .expect("a plot");
    for name in ["x, scene", "x, dashpot_end", "x, both_ends"] {
        assert!(svg.contains(name), "{name}");
    }
    let refused = plot(&folder, &["simulate", "base_excitation", "--with", "dash"]).expect_err("no such scene");
    assert!(refused.contains("no scene is called `dash`"), "{refused}");
    fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn a_run_goes_on_from_its_end() {
    let folder = folder("goes_on");
    let state = folder.join("state.txt").to_string_lossy().into_owned();
    let end = |arguments: &[&str]| -> Vec<f64> {
        let text = told(&[&["simulate"], arguments, &["--json", "--no-digits"]].concat()).expect("a run");
        let object: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        ["q", "v"]
            .iter()
            .flat_map(|part| object[part].as_object().unwrap().values())
            .map(|x| x.as_f64().unwrap())
            .collect()
    };
    for (model, half, whole) in [
        ("four_bar", "1", "2"),
        ("chaplygin_sleigh", "5", "10"),
        ("bouncing_ball", "1", "2"),
        ("base_excitation", "3", "6"),
    ] {
        end(&[model, "--until", half, "--save", &state]);
        let (on, at_once) = (end(&[model, "--state", &state, "--until", whole]), end(&[model, "--until", whole]));
        for (x, y) in on.iter().zip(&at_once) {
            assert!((x - y).abs() < 1e-8 * (1.0 + y.abs()), "{model}: {on:?} {at_once:?}");
        }
    }
    fs::write(&state, "x: 1 m\ny is 2\n").expect("a file");
    let refused = told(&["simulate", "bouncing_ball", "--state", &state]).expect_err("no value");
    assert!(refused.contains("state.txt:2: `y is 2` is no `name: value`"), "{refused}");
    fs::write(&state, "z: 1 m\n").expect("a file");
    let refused = told(&["simulate", "bouncing_ball", "--state", &state]).expect_err("no coordinate");
    assert!(refused.contains("no coordinate is called `z`"), "{refused}");
    fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn parameters_come_from_a_file() {
    let folder = folder("parameters");
    let file = folder.join("params.txt").to_string_lossy().into_owned();
    fs::write(&file, "# other\nl: 200 cm # longer\n\"g\": 20\n").expect("a file");
    let run = |arguments: &[&str]| told(&[&["simulate", "double_pendulum", "--no-digits"], arguments].concat());
    let line = |text: String| text.lines().nth(1).expect("a line").to_owned();
    let by_file = line(run(&["--params", &file]).expect("a run"));
    assert_eq!(by_file, line(run(&["--set", "l=2", "--set", "g=20"]).expect("a run")));
    let both = line(run(&["--params", &file, "--set", "g=10"]).expect("a run"));
    assert_eq!(both, line(run(&["--set", "l=2"]).expect("a run")));
    fs::write(&file, "length: 1\n").expect("a file");
    assert!(run(&["--params", &file]).expect_err("no parameter").contains("no parameter is called `length`"));
    assert!(run(&["--params", "/nowhere"]).expect_err("no file").contains("cannot read /nowhere"));
    fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn a_coordinate_that_is_set_as_a_parameter_is_led_to_its_own_option() {
    let refused = |arguments: &[&str]| told(arguments).expect_err("no parameter");
    let text = refused(&["simulate", "double_pendulum", "--set", "theta1'=2"]);
    assert!(text.contains("`theta1'` is a speed, and --set is for parameters; write --start \"theta1'=…\""), "{text}");
    let text = refused(&["modes", "double_pendulum", "--set", "theta1=2"]);
    assert!(text.contains("`theta1` is a coordinate, and --set is for parameters; write --at \"theta1=…\""), "{text}");
    told(&["simulate", "double_pendulum", "--no-digits", "--start", "theta1'=2"]).expect("a run");
    told(&["modes", "double_pendulum", "--at", "theta1=0.1"]).expect("modes");
}

#[test]
fn matrices_are_written_for_other_programs() {
    let folder = folder("matrices");
    let path = |name: &str| folder.join(name).to_string_lossy().into_owned();
    told(&["modes", "forced_chain", "--matrices", &path("chain.mtx")]).expect("modes");
    let text = fs::read_to_string(path("chain-K.mtx")).expect("K");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("%%MatrixMarket matrix coordinate real general"));
    assert!(lines.next().is_some_and(|line| line.starts_with("% K of M x'' + C x' + K x = 0")));
    assert_eq!(lines.next(), Some("3 3 7"));
    assert_eq!(lines.count(), 7);
    told(&["modes", "forced_chain", "--matrices", &path("chain.csv")]).expect("modes");
    let table = fs::read_to_string(path("chain-A.csv")).expect("A");
    let rows: Vec<Vec<f64>> =
        table.lines().map(|line| line.split(',').map(|x| x.parse().expect("a number")).collect()).collect();
    assert!(rows.len() == 6 && rows.iter().all(|row| row.len() == 6));
    assert_eq!(rows[0], [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn mistakes_come_with_their_places_as_data() {
    let folder = folder("mistakes");
    let file = folder.join("wrong.yaml").to_string_lossy().into_owned();
    fs::write(
        &file,
        "name: W\ncoordinates: {x: m}\nparameters: {m: 1 Kg}\nbodies: {b: {mas: m, position: \"[x, 0]\"}}\n",
    )
    .expect("a file");
    let mut out = Vec::new();
    let problem = dalembert::cli::run(MODELS, ["dalembert", "check", &file, "--json"], &mut out).expect_err("mistakes");
    assert_eq!(problem.status(), 1);
    let report: serde_json::Value = serde_json::from_slice(&out).expect("JSON");
    let found: Vec<(String, u64, u64, u64)> = report["problems"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|p| {
            (
                p["code"].as_str().unwrap().to_owned(),
                p["line"].as_u64().unwrap(),
                p["column"].as_u64().unwrap(),
                p["end_column"].as_u64().unwrap(),
            )
        })
        .collect();
    assert!(found.contains(&("E119".to_owned(), 3, 19, 21)), "{found:?}");
    assert!(found.contains(&("E301".to_owned(), 4, 14, 17)), "{found:?}");
    let good = told(&["check", "double_pendulum", "--json"]).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&good).expect("JSON");
    assert_eq!(report["agreements"][0]["between"][1], "virtual power");
    assert!(report["problems"].as_array().expect("a list").is_empty());
    fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn shells_complete_commands_options_and_models() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let mut script = Vec::new();
        dalembert::cli::run(MODELS, ["dalembert", "completions", shell], &mut script).expect("a script");
        let script = String::from_utf8(script).expect("text");
        for word in ["simulate", "no-digits", "import", "dalembert"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
        // Other shells complete no values.
        assert!(script.contains("double_pendulum") || !["bash", "zsh"].contains(&shell), "{shell}");
    }
    let unknown = dalembert::cli::run(MODELS, ["dalembert", "completions", "tcsh"], &mut Vec::new());
    assert!(
        unknown
            .expect_err("no such shell")
            .to_string()
            .contains("[possible values: bash, elvish, fish, powershell, zsh]")
    );
}

#[test]
fn what_is_given_twice_is_refused_and_where_a_value_is_wrong_is_said() {
    let folder = folder("given-twice");
    let model = folder.join("y.yaml").to_string_lossy().into_owned();
    let refused = told(&["simulate", &model, "--set", "mu=0.1", "--set", "mu=0.2"]).expect_err("twice");
    assert!(refused.contains("--set gives `mu` twice"), "{refused}");
    let values = folder.join("values.yaml").to_string_lossy().into_owned();
    fs::write(&values, "# of the block\nm: 2 kg\ng: 3 s\n").expect("a file");
    let refused = told(&["simulate", &model, "--params", &values]).expect_err("a time");
    assert!(refused.contains("values.yaml, line 3"), "{refused}");
}

#[test]
fn the_number_of_steps_is_limited_and_a_saved_state_tells_its_parameters() {
    let folder = folder("steps");
    let model = folder.join("y.yaml").to_string_lossy().into_owned();
    let stopped = told(&["simulate", &model, "--step", "1e-3", "--max-steps", "50"]).expect_err("too many");
    assert!(stopped.contains("more than 50 steps") && stopped.contains("--max-steps"), "{stopped}");
    let state = folder.join("state.yaml").to_string_lossy().into_owned();
    told(&["simulate", &model, "--scene", "usual", "--set", "m=3", "--save", &state]).expect("a run");
    let written = fs::read_to_string(&state).expect("a file");
    assert!(written.contains("# with m = 3, mu = 0.5\n"), "{written}");
    told(&["simulate", &model, "--state", &state]).expect("a run on");
}

#[test]
fn a_session_answers_with_the_bits_that_the_program_prints() {
    let folder = folder("session");
    let path = folder.join("y.yaml").to_string_lossy().into_owned();
    let session = Session::named(MODELS, &path, Vec::new()).expect("a model");
    let options = ["--set=m=3".to_owned()];
    let simulated = session.simulate(&options, &mut || ControlFlow::Continue(())).expect("a run");
    let without_seconds = |text: &str| {
        let mut data: serde_json::Value = serde_json::from_str(text).expect("JSON");
        data["seconds"].take();
        data
    };
    let printed = told(&["simulate", &path, "--json", "--set=m=3"]).expect("a run");
    assert_eq!(without_seconds(&simulated.json), without_seconds(&printed));
    assert_eq!(simulated.run.state_rows().len(), 2 * simulated.run.len());
    let answer = session.command("check", &["--json".to_owned()], &Arc::default());
    assert_eq!((answer.text, answer.problem.is_none()), (told(&["check", &path, "--json"]).expect("a report"), true));
    let steps = ["--method=rk4", "--step=0.01"].map(str::to_owned);
    let cut = session.simulate(&steps, &mut || ControlFlow::Break(())).expect("what was computed");
    let (why, time) = cut.failed.expect("an interruption");
    assert_eq!((why.contains("interrupted"), time, cut.run.last().t), (true, 0.01, 0.01), "{why}");
    fs::remove_dir_all(folder).expect("to be removed");
}

/// Every command prints one object with `--json`, its format first, and says in it why it failed.
#[test]
fn json_is_one_object_whatever_happens() {
    let folder = folder("json");
    let model = folder.join("y.yaml").to_str().expect("a path").to_owned();
    let table = folder.join("table.csv").to_str().expect("a path").to_owned();
    let answer = |arguments: &[&str]| {
        let mut out = Vec::new();
        let arguments = [&["dalembert"], arguments, &["--json"]].concat();
        let ended = dalembert::cli::run(MODELS, arguments, &mut out);
        let text = String::from_utf8(out).expect("text");
        assert!(text.starts_with("{\"format\":1,"), "{text}");
        let value: serde_json::Value = serde_json::from_str(&text).expect("one object");
        assert_eq!(value.get("error").is_some(), ended.is_err(), "{text}");
        value
    };
    assert!(answer(&["list"])["models"].as_array().expect("models").len() > 50);
    let run = answer(&["simulate", &model, "--every", "0.1"]);
    assert_eq!(run["trajectory"]["t"].as_array().expect("times").len(), 3);
    assert_eq!(run["trajectory"]["x"][2], run["q"]["x"]);
    let swept = answer(&["sweep", &model, "--vary", "mu=0.1,0.2", "--csv", &table]);
    assert_eq!(swept["columns"].as_array().expect("columns").len(), swept["rows"][1].as_array().expect("a row").len());
    assert_eq!(swept["rows"][1][1], 0.2);
    let map = folder.join("map.svg").to_str().expect("a path").to_owned();
    let limits = answer(&["stability", "rk4", "--plot", &map]);
    assert!((limits["limits"][0]["theory"].as_f64().expect("a limit") - 8.0_f64.sqrt()).abs() < 1e-3);
    assert_eq!(answer(&["simulate", "nothing"])["error"]["kind"], "usage");
    let stopped = answer(&["simulate", &model, "--max-steps", "1", "--step", "0.001", "--method", "rk4"]);
    assert_eq!(stopped["error"]["kind"], "run");
    assert!(stopped["t"].as_f64().expect("a time") < 0.2);
    fs::write(folder.join("bad.yaml"), "name: 3 4\n").expect("a file");
    let bad = folder.join("bad.yaml").to_str().expect("a path").to_owned();
    for command in ["check", "modes", "show"] {
        assert_eq!(answer(&[command, &bad])["error"]["kind"], "model");
    }
    fs::remove_dir_all(folder).expect("removed");
}

/// Orders and critical speeds are of a speed of rotation; a length has frequencies alone.
#[test]
fn only_a_speed_has_critical_speeds() {
    let folder = folder("campbell");
    let picture = folder.join("campbell.svg").to_string_lossy().into_owned();
    let text = told(&["modes", "simple_pendulum", "--vary", "l=1..2", "--campbell", &picture]).expect("modes");
    assert!(!text.contains("critical speeds"), "{text}");
    fs::remove_dir_all(folder).expect("removed");
}
