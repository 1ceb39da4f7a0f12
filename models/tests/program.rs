//! The program as a process: exit codes, standard input and output.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const MODEL: &str = "name: Bob\nparameters: {m: 1 kg, g: 10 m/s^2}\ncoordinates: {x: m}\n\
                     bodies: {bob: {mass: m, position: \"[0, x]\"}}\ngravity: [0, -g]\nscene: {until: 1}\n";
const WRONG: &str = "name: Bob\ncoordinates: {x: m}\nbodies: {bob: {mas: 1}}\n";

/// A folder of its own for a test, with a good and a bad model file in it.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("program-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join("good.yaml"), MODEL).expect("a file");
    fs::write(folder.join("bad.yaml"), WRONG).expect("a file");
    folder
}

/// What the program does in this folder, with this on standard input.
fn fed(folder: &Path, input: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_dalembert"));
    command.args(arguments).current_dir(folder);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program");
    child.stdin.take().expect("its input").write_all(input.as_bytes()).expect("to be read");
    child.wait_with_output().expect("its end")
}

fn done(folder: &Path, arguments: &[&str]) -> Output {
    fed(folder, "", arguments)
}

/// Standard output, standard error and the exit code.
fn told(output: &Output) -> (String, String, Option<i32>) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr), output.status.code())
}

/// The names of the files in a folder.
fn files(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).expect("a folder").map(|file| file.expect("a file").file_name());
    let mut names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn exit_codes_are_those_of_the_help() {
    let folder = folder("codes");
    let code = |arguments: &[&str]| done(&folder, arguments).status.code();
    assert_eq!(code(&["check", "good.yaml"]), Some(0));
    assert_eq!(code(&["check", "bad.yaml"]), Some(1));
    assert_eq!(code(&["simulate", "bad.yaml"]), Some(1));
    assert_eq!(code(&["simulate", "good.yaml", "--step", "1e-3", "--max-steps", "3"]), Some(1));
    assert_eq!(code(&["simulate", "good.yaml", "--csv", "nowhere/a.csv"]), Some(1));
    assert_eq!(code(&["simulate", "none.yaml"]), Some(2));
    assert_eq!(code(&["simulate", "good.yaml", "--until", "soon"]), Some(2));
    assert_eq!(code(&["simulate"]), Some(2));
    // What is not there is a wrong name, whatever it is the name of.
    for wrong in ["--state=none.txt", "--params=none.txt", "--start=z=1", "--set=z=1", "--size=z=1", "--scene=z", "--z"]
    {
        assert_eq!(code(&["simulate", "good.yaml", wrong]), Some(2), "{wrong}");
    }
    assert_eq!(code(&["sweep", "good.yaml", "--points", "none.csv"]), Some(2));
    assert_eq!(code(&["solve", "good.yaml", "--unknown", "x=1"]), Some(2));
    assert_eq!(code(&["simulate", "good.yaml", "--csv", "good.yaml"]), Some(2));
    // A file in another encoding is there, and is no text, whatever it is read for.
    fs::write(folder.join("latin.yaml"), b"name: B\xe9b\n").expect("a file");
    assert_eq!(code(&["check", "latin.yaml"]), Some(1));
    assert_eq!(code(&["import", "latin.yaml"]), Some(1));
    assert_eq!(code(&["sweep", "good.yaml", "--points", "latin.yaml"]), Some(1));
    let (help, _, status) = told(&done(&folder, &["--help"]));
    assert_eq!(status, Some(0));
    for line in
        ["0  done", "1  a model file is wrong, a run failed or was interrupted", "2  wrong usage", "130, 143  ended by"]
    {
        assert!(help.contains(line), "{line}: {help}");
    }
}

/// The one object that a command that fails prints with `--json`.
fn failure(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let (out, _, _) = told(&done(folder, &[arguments, &["--json"]].concat()));
    let answer: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{arguments:?}: {out}"));
    let why = answer["error"]["message"].as_str().unwrap_or_else(|| panic!("{arguments:?}: {out}"));
    assert!(!why.is_empty() && !why.starts_with("error: "), "{arguments:?}: {why}");
    answer
}

#[test]
fn json_says_why_whatever_fails() {
    let folder = folder("failures");
    for wrong in [
        &["simulate"][..],
        &["simulate", "good.yaml", "--nonsense"],
        &["simulate", "good.yaml", "--max-steps", "many"],
        &["simulate", "good.yaml", "--step", "1e-3", "--max-steps", "3"],
        &["sweep", "good.yaml", "--vary", "m=1,2", "--step", "1e-3", "--max-steps", "3"],
        &["modes", "bad.yaml"],
    ] {
        failure(&folder, wrong);
    }
}

#[test]
fn several_files_are_one_object_too() {
    let folder = folder("files");
    let answer = failure(&folder, &["check", "good.yaml", "bad.yaml", "none.yaml"]);
    let files = answer["files"].as_array().expect("a list");
    assert_eq!((files.len(), &files[0]["name"], &files[0]["coordinates"]), (3, &"good".into(), &1.into()));
    assert_eq!(files[1]["problems"][0]["code"], "E301");
    let kinds: Vec<&serde_json::Value> = files.iter().map(|file| &file["error"]["kind"]).collect();
    assert_eq!(kinds, [&serde_json::Value::Null, &"model".into(), &"usage".into()]);
}

#[test]
fn what_is_no_model_file_is_told_what_it_is() {
    let folder = folder("no-model");
    fs::create_dir(folder.join("models")).expect("a folder");
    let wide: Vec<u8> = std::iter::once(0xfeff).chain(MODEL.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    fs::write(folder.join("wide.yaml"), wide).expect("a file");
    fs::write(folder.join("empty.txt"), "# nothing\n").expect("a file");
    for (arguments, said) in [
        (&["check", "good"][..], "did you mean the file `good.yaml`?"),
        (&["check", "models"], "`models` is a folder"),
        (&["check", "wide.yaml"], "iconv -f UTF-16 -t UTF-8 wide.yaml"),
        (&["check", "good.yaml", "--size", "n=3"], "no size is called `n`"),
        (&["needs", "good.yaml", "--needs", "X'"], "did you mean `x'`?"),
        (&["chart", "good.yaml", "--compare", "X'"], "did you mean `x'`?"),
        (&["simulate", "good.yaml", "--state", "empty.txt"], "empty.txt states no value"),
        (&["simulate", "good.yaml", "--method", "rk4"], "give --step"),
        (&["simulate", "good.yaml", "--method", "rk4", "--step=-1"], "--step is -1"),
    ] {
        let (out, error, _) = told(&done(&folder, arguments));
        assert!(out.is_empty() && error.contains(said), "{arguments:?}: {out}{error}");
    }
}

/// A speed in m/s beside an angle has no coordinate of its unit to be small beside.
#[test]
fn what_is_0_all_the_time_is_printed_as_0() {
    let folder = folder("rest");
    let door = "name: Door\nparameters: {m: 30 kg, w: 0.9 m, k: 20 N*m/rad, c: 8 N*m*s/rad}\ncoordinates: {phi: rad}\n\
                bodies: {leaf: {mass: m, inertia: m*w^2/12, angle: phi, position: \"[w/2*cos(phi), w/2*sin(phi)]\"}}\n\
                springs: {closer: {stretch: phi, stiffness: k, on: leaf}}\ndampers: {pot: {rate: phi', damping: c, on: leaf}}\n\
                outputs: {speed: w*phi'}\nscene: {start: {phi: 0}, until: 3}\n";
    fs::write(folder.join("door.yaml"), door).expect("a file");
    let (out, _, _) = told(&done(&folder, &["simulate", "door.yaml"]));
    assert!(out.contains("speed = 0 m/s"), "{out}");
    // What moves is told with the digits that hold.
    let (out, _, _) = told(&done(&folder, &["simulate", "door.yaml", "--start", "phi=1"]));
    assert!(out.contains("speed = -") || out.contains("speed = 0."), "{out}");
}

#[test]
fn a_run_warns_where_it_leaves_a_table() {
    let folder = folder("tables");
    let model = |more: &str, until: &str| {
        format!(
            "name: Ride\nparameters: {{m: 1 kg, k: 100 N/m, v: 2 m/s}}\ncoordinates: {{y: m}}\n\
             tables: {{bump: {{points: [[0, 0], [0.5, 0.1], [1, 0.02], [3, 0]], units: [m, m]{more}}}}}\n\
             inputs: {{road: bump(v*t)}}\nbodies: {{bob: {{mass: m, position: \"[0, y]\"}}}}\n\
             springs: {{s: {{stretch: y - road, stiffness: k, along: ground.y, on: bob}}}}\nscene: {{until: {until}}}\n"
        )
    };
    for (more, until, warned) in [("", "2", true), ("", "1.5", false), (", periodic: true", "2", false)] {
        fs::write(folder.join("ride.yaml"), model(more, until)).expect("a file");
        let (out, _, status) = told(&done(&folder, &["simulate", "ride.yaml"]));
        let warning = "warning        the motion leaves the table `bump` at t = 1.5 s:";
        assert_eq!((out.matches(warning).count(), status), (usize::from(warned), Some(0)), "{out}");
        assert_eq!(out.contains("leaves the table"), warned, "{out}");
    }
}

/// The names of all commands.
fn commands(folder: &Path) -> Vec<String> {
    let (help, _, _) = told(&done(folder, &["--help"]));
    let listed = help.split("Commands:").nth(1).and_then(|rest| rest.split("\n\n").next()).expect("commands");
    let names = listed.lines().filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    names.map(str::to_owned).collect()
}

/// Each as a shell reads it, in the order in which they stand.
#[test]
#[cfg(unix)]
fn examples_of_the_help_do_as_they_stand() {
    let folder = folder("examples");
    let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/urdf/arm6.urdf");
    fs::copy(robot, folder.join("robot.urdf")).expect("a robot");
    for command in commands(&folder) {
        let (help, _, _) = told(&done(&folder, &[&command, "--help"]));
        assert!(help.contains("-q, --quiet"), "{command}");
        let examples = help.split("Examples:\n").nth(1).unwrap_or_default().lines();
        let examples: Vec<&str> = examples.filter_map(|line| line.trim().strip_prefix("dalembert ")).collect();
        assert_eq!(examples.len(), 3, "{command}: {help}");
        for example in examples {
            let mut shell = Command::new("sh");
            shell.args(["-c", &format!("\"$0\" {example}"), env!("CARGO_BIN_EXE_dalembert")]).current_dir(&folder);
            let (out, error, status) = told(&shell.output().expect("a shell"));
            assert_eq!(status, Some(0), "{example}: {out}{error}");
        }
    }
}

/// One that is wrong in the middle hides no other.
#[test]
fn all_files_are_checked_and_all_that_is_wrong_is_told() {
    let folder = folder("several");
    fs::write(folder.join("worse.yaml"), WRONG.replace("mas:", "weight:")).expect("a file");
    let all = ["check", "good.yaml", "bad.yaml", "worse.yaml", "none.yaml", "good.yaml"];
    let (out, error, status) = told(&done(&folder, &all));
    assert_eq!(status, Some(1));
    assert_eq!(out.matches("good: 1 coordinate").count(), 2, "{out}");
    for part in ["bad.yaml:3:16", "worse.yaml:3:16", "called `none.yaml`", "3 of 5 files are wrong"] {
        assert!(error.contains(part), "{part}: {error}");
    }
}

/// With `-q` only what is doubtful is told, beside the output.
#[test]
fn a_quiet_check_tells_warnings_alone() {
    let folder = folder("doubtful");
    let doubtful = "name: Bob\nparameters: {m: 1 kg, l: 1 m}\ncoordinates: {x: rad}\n\
                    bodies: {bob: {mass: m, position: \"[0, l*sin(x)]\"}}\nscene: {start: {x: 90}, until: 1}\n";
    fs::write(folder.join("doubtful.yaml"), doubtful).expect("a file");
    let (told_aloud, _, _) = told(&done(&folder, &["check", "doubtful.yaml"]));
    let (out, error, status) = told(&done(&folder, &["check", "-q", "doubtful.yaml"]));
    assert!(told_aloud.contains("warning[W250]") && told_aloud.contains("1 coordinate"), "{told_aloud}");
    assert!(out.is_empty() && error.contains("warning[W250]") && status == Some(0), "{out}{error}");
    let (out, error, status) = told(&done(&folder, &["check", "-q", "good.yaml"]));
    assert!(out.is_empty() && error.is_empty() && status == Some(0), "{out}{error}");
}

#[test]
fn standard_input_and_output_are_called_by_a_hyphen() {
    let folder = folder("streams");
    let (table, report, status) = told(&fed(&folder, MODEL, &["simulate", "-", "--csv", "-"]));
    assert!(table.starts_with("t,x,x'\n") && report.contains("stdin at t = 1") && status == Some(0), "{report}");
    let sweep = ["sweep", "good.yaml", "--vary", "m=1,2", "-o", "-"];
    let (table, report, _) = told(&done(&folder, &sweep));
    assert!(table.starts_with("run,m,t,x,") && report.contains("run  m"), "{table}{report}");
    let chart = ["chart", "good.yaml", "--methods", "rk4,dop853", "--plot", "c.svg", "--csv", "-"];
    let (table, report, status) = told(&done(&folder, &chart));
    assert!(table.lines().all(|line| line.contains(',')) && table.lines().count() > 2, "{table}");
    assert!(report.contains("written: c.svg") && status == Some(0), "{report}");
    let (code, _, status) = told(&done(&folder, &["show", "good.yaml", "--rust", "-o", "-"]));
    assert!(code.contains("pub struct Bob") && status == Some(0), "{code}");
    let (_, refused, status) = told(&done(&folder, &["simulate", "good.yaml", "--plot", "-"]));
    assert!(refused.contains("--plot: only tables go to standard output"), "{refused}");
    assert_eq!(status, Some(2));
    for (option, path) in [("bode", "-"), ("plot", "-"), ("matrices", "-")] {
        let (_, refused, status) = told(&done(&folder, &["modes", "good.yaml", &format!("--{option}"), path]));
        assert!(refused.contains(&format!("--{option}: only tables go")) && status == Some(2), "{refused}");
    }
    assert_eq!(files(&folder), ["bad.yaml", "c.svg", "good.yaml"]);
}

#[test]
fn values_are_read_from_standard_input() {
    let folder = folder("values");
    let (printed, ..) = told(&fed(&folder, "g: 2 m/s^2\n", &["simulate", "good.yaml", "--params", "-"]));
    assert!(printed.contains("x = -1.0000"), "{printed}");
    let (printed, ..) = told(&fed(&folder, "x: 7 m\n", &["simulate", "good.yaml", "--state", "-"]));
    assert!(printed.contains("x = 2.0000"), "{printed}");
    let sweep = ["sweep", "good.yaml", "--points", "-", "-o", "-"];
    let (table, ..) = told(&fed(&folder, "g\n2\n4\n", &sweep));
    assert_eq!(table.lines().count(), 3, "{table}");
}

/// What looks like degrees is said wherever the file runs, and is no error.
#[test]
fn warnings_about_a_file_are_told_by_all_that_run_it() {
    let folder = folder("warnings");
    let pendulum = "name: Bob\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}\ncoordinates: {phi: rad}\n\
                    bodies: {bob: {mass: m, position: 'l*[sin(phi), -cos(phi)]'}}\ngravity: [0, -g]\n\
                    scene: {start: {phi: 30}, until: 1, needs: {within: 1e-3}}\n";
    fs::write(folder.join("degrees.yaml"), pendulum).expect("a file");
    for arguments in [
        &["simulate", "degrees.yaml"][..],
        &["simulate", "degrees.yaml", "--slopes", "l"],
        &["sweep", "degrees.yaml", "--vary", "m=1,2", "-o", "-"],
        &["modes", "degrees.yaml"],
        &["needs", "degrees.yaml"],
        &["export", "degrees.yaml", "--c", "code"],
        &["generate", "degrees.yaml", "-o", "code.rs"],
    ] {
        let (_, report, status) = told(&done(&folder, arguments));
        assert!(report.contains("looks like degrees") && report.contains("W250"), "{arguments:?}: {report}");
        assert_eq!(status, Some(0), "{arguments:?}");
    }
    let (object, ..) = told(&done(&folder, &["simulate", "degrees.yaml", "--json"]));
    assert!(object.contains("W250 at degrees.yaml:6:"), "{object}");
}

#[test]
fn what_is_printed_may_go_to_a_file() {
    let folder = folder("files");
    for (arguments, file) in [
        (&["show", "good.yaml"][..], "shown.txt"),
        (&["show", "good.yaml", "--rust"], "shown.rs"),
        (&["schema"], "schema.json"),
    ] {
        let (printed, ..) = told(&done(&folder, arguments));
        let (nothing, ..) = told(&done(&folder, &[arguments, &["-o", file]].concat()));
        assert_eq!((nothing.as_str(), fs::read_to_string(folder.join(file)).expect("a file")), ("", printed));
    }
    let (_, refused, _) = told(&done(&folder, &["show", "good.yaml", "-o", "good.yaml"]));
    assert!(refused.contains("would overwrite the model file"), "{refused}");
    assert_eq!(fs::read_to_string(folder.join("good.yaml")).expect("the model"), MODEL);
}

#[test]
fn quiet_is_quiet_until_something_is_wrong() {
    let folder = folder("quiet");
    for arguments in [
        &["check", "good.yaml", "-q"][..],
        &["simulate", "good.yaml", "--quiet", "--csv", "a.csv"],
        &["sweep", "good.yaml", "--vary", "m=1,2", "-q"],
        &["modes", "good.yaml", "--at", "x=0", "--set", "g=0", "-q"],
        &["new", "fresh", "-q"],
    ] {
        assert_eq!(told(&done(&folder, arguments)), (String::new(), String::new(), Some(0)), "{arguments:?}");
    }
    let (table, report, _) = told(&done(&folder, &["simulate", "good.yaml", "-q", "--csv", "-"]));
    assert_eq!((table, report), (fs::read_to_string(folder.join("a.csv")).expect("a table"), String::new()));
    let (json, ..) = told(&done(&folder, &["simulate", "good.yaml", "-q", "--json"]));
    assert!(json.starts_with("{\"format\":1,\"model\""), "{json}");
    let (out, error, status) = told(&done(&folder, &["check", "-q", "bad.yaml"]));
    assert!(out.is_empty() && error.contains("bad.yaml:3:16") && status == Some(1), "{error}");
}

#[test]
fn endings_that_are_not_known_are_refused_before_anything_is_written() {
    let folder = folder("endings");
    let before = files(&folder);
    for (arguments, known) in [
        (&["simulate", "good.yaml", "--csv", "a.xlsx"][..], "`.csv`"),
        (&["simulate", "good.yaml", "--save", "a.csv"], "`.yaml`, `.yml`, `.txt`"),
        (&["simulate", "good.yaml", "--plot", "a.jpg"], "`.svg`, `.png`, `.pdf`"),
        (&["sweep", "good.yaml", "--vary", "m=1,2", "--csv", "a.txt"], "`.csv`"),
        (&["modes", "good.yaml", "--set", "g=0", "--matrices", "a.mat"], "`.mtx`, `.csv`"),
        (&["needs", "good.yaml", "--write", "a.rs"], "`.yaml`, `.yml`"),
        (&["show", "good.yaml", "--latex", "-o", "a.rs"], "`.tex`"),
        (&["chart", "good.yaml", "--csv", "a.svg"], "`.csv`"),
        (&["schema", "-o", "a.yaml"], "`.json`"),
    ] {
        let (_, refused, status) = told(&done(&folder, arguments));
        assert!(refused.contains(&format!("end the name in one of {known}")), "{arguments:?}: {refused}");
        assert_eq!((status, files(&folder)), (Some(2), before.clone()), "{arguments:?}");
    }
}

#[test]
fn a_new_file_knows_its_schema() {
    let folder = folder("new");
    let (out, _, status) = told(&done(&folder, &["new", "swing"]));
    assert!(out.contains("wrote swing.yaml") && out.contains("dalembert.schema.json") && status == Some(0), "{out}");
    let text = fs::read_to_string(folder.join("swing.yaml")).expect("a model");
    assert_eq!(text.lines().next(), Some("# yaml-language-server: $schema=dalembert.schema.json"));
    let (schema, ..) = told(&done(&folder, &["schema"]));
    assert_eq!(fs::read_to_string(folder.join("dalembert.schema.json")).expect("a schema"), schema);
    assert_eq!(done(&folder, &["check", "swing.yaml"]).status.code(), Some(0));
    // A schema that is there stays as it is.
    fs::write(folder.join("dalembert.schema.json"), "{}").expect("a file");
    let (out, ..) = told(&done(&folder, &["new", "ring"]));
    assert!(out.contains("wrote ring.yaml") && !out.contains("schema"), "{out}");
    assert_eq!(fs::read_to_string(folder.join("dalembert.schema.json")).expect("a schema"), "{}");
}

#[test]
fn a_new_crate_has_a_name_that_cargo_takes_and_a_folder_of_its_own() {
    let folder = folder("new_crate");
    let before = files(&folder);
    for name in ["a b", "3d", "fn", "dalembert", "größe", ".."] {
        let (_, refused, status) = told(&done(&folder, &["new", name, "--crate"]));
        assert!(refused.contains(&format!("no crate can be called `{}`", name.trim_matches('.'))), "{refused}");
        assert_eq!((status, files(&folder)), (Some(2), before.clone()), "{name}");
    }
    let (out, _, status) = told(&done(&folder, &["new", "fast_swing", "--crate"]));
    assert!(out.contains("try: cargo run --release --manifest-path fast_swing/Cargo.toml\n"), "{out}");
    assert_eq!(status, Some(0), "{out}");
    let text = |file: &str| fs::read_to_string(folder.join("fast_swing").join(file)).expect("a file");
    assert!(text("src/main.rs").contains("dalembert::model!(\"models/fast_swing.yaml\");"));
    assert!(
        text("src/main.rs").contains("FastSwing::default()") && text("models/fast_swing.yaml").contains("FastSwing")
    );
    let (_, refused, status) = told(&done(&folder, &["new", "fast_swing", "--crate"]));
    assert!(refused.contains("fast_swing exists already") && status == Some(2), "{refused}");
}

#[test]
fn generated_code_is_written_and_checked() {
    let folder = folder("generate");
    let generate = ["generate", "good.yaml", "--name", "Weight", "-o", "bob.rs"];
    let (out, _, status) = told(&done(&folder, &generate));
    assert!(out.contains("wrote bob.rs") && status == Some(0), "{out}");
    let code = fs::read_to_string(folder.join("bob.rs")).expect("code");
    let renew =
        code.lines().nth(1).and_then(|line| line.strip_prefix("// To renew it: dalembert ")).expect("a command");
    assert_eq!(renew.split(' ').collect::<Vec<_>>(), generate);
    assert!(code.contains("pub struct Weight") && code.contains("::dalembert::generated_for!("), "{code}");
    let check = |arguments: &[&str]| told(&done(&folder, &[arguments, &["--check"]].concat()));
    assert_eq!(check(&generate), ("bob.rs is the code of good.yaml\n".to_owned(), String::new(), Some(0)));
    // Another way to the same files is no difference; another model is one.
    let model = folder.join("good.yaml");
    let model = model.to_str().expect("a path");
    assert_eq!(check(&["generate", model, "--name", "Weight", "-o", "./bob.rs", "-q"]).2, Some(0));
    fs::write(folder.join("good.yaml"), MODEL.replace("10 m/s^2", "9 m/s^2")).expect("a file");
    let (_, refused, status) = check(&generate);
    assert!(refused.contains("the first line that differs is 1:") && status == Some(1), "{refused}");
    assert_eq!(fs::read_to_string(folder.join("bob.rs")).expect("code"), code);
    fs::write(folder.join("good.yaml"), MODEL).expect("a file");
    fs::write(folder.join("bob.rs"), code.replacen("pub m: f64,", "pub m: f32,", 1)).expect("a file");
    let (_, refused, _) = check(&generate);
    assert!(refused.contains("there        pub m: f32,") && refused.contains("expected     pub m: f64,"), "{refused}");

    let (_, refused, status) = check(&["generate", "good.yaml", "-o", "none.rs"]);
    assert!(refused.contains("cannot read none.rs") && status == Some(1), "{refused}");
    let (_, refused, status) = check(&["generate", "good.yaml", "-o", "-"]);
    assert!(refused.contains("--check compares with a file") && status == Some(2), "{refused}");
    let (_, refused, status) = told(&done(&folder, &["generate", "good.yaml", "--name", "fn"]));
    assert!(refused.contains("--name wants the name of a Rust type") && status == Some(2), "{refused}");
    let (series, ..) = told(&done(&folder, &["generate", "good.yaml", "--methods", "taylor"]));
    assert!(series.contains("fn series()") && !code.contains("fn series()"), "{series}");
}

/// What cannot be tested beside its file says why.
#[test]
fn a_smaller_file_without_a_test_says_why() {
    let folder = folder("untested");
    let model = "name: Two\nparameters: {m: 1 kg, k: 1 N/m, f: 1e-9 N*s/m}\ncoordinates: {x: m}\n\
                 bodies: {bob: {mass: m, position: \"[x, 0]\"}}\ngeneralized_forces: {x: \"-k*x + f*x'\"}\n\
                 scene: {start: {x: 1}, until: 3}\n";
    fs::write(folder.join("two.yaml"), model).expect("a file");
    let write = ["--needs", "x", "--write", "small.yaml"];
    let (said, problem, _) = told(&fed(&folder, model, &[&["needs", "-"], &write[..]].concat()));
    assert!(
        said.contains("no test is written beside small.yaml: the model came from standard input"),
        "{said}{problem}"
    );
    let (said, problem, _) = told(&done(&folder, &[&["needs", "two.yaml", "--start", "x=2"], &write[..]].concat()));
    assert!(said.contains("--set, --start and --until change the model"), "{said}{problem}");
    assert!(!files(&folder).contains(&"small_test.rs".to_owned()));
    for (option, value, why) in
        [("--until", "0", "--until is 0"), ("--within", "2", "--within wants a part of the range")]
    {
        let (_, problem, status) = told(&done(&folder, &["needs", "two.yaml", "--needs", "x", option, value]));
        assert!(status == Some(2) && problem.contains(why), "{problem}");
    }
}

/// What looks like degrees is said wherever the file runs, and is no error.
/// One input is no model and values too.
#[test]
fn standard_input_is_read_for_one_thing() {
    let folder = folder("twice");
    for (command, option) in [("simulate", "--params"), ("sweep", "--points"), ("needs", "--params")] {
        let (_, problem, status) = told(&fed(&folder, MODEL, &[command, "-", option, "-"]));
        assert!(status == Some(2) && problem.contains("standard input is the model already"), "{command}: {problem}");
    }
}

/// A motion of a pendulum that starts elsewhere is no twin.
#[test]
fn a_twin_that_starts_elsewhere_is_warned_of() {
    let folder = folder("twin");
    let twin = |start: &str| {
        format!(
            "name: Bob\nparameters: {{k: 1 1/s^2}}\ncoordinates: {{x: m}}\nkinetic_energy: x'^2/2\n\
             potential_energy: k*x^2/2\noutputs: {{far: x}}\nscene: {{start: {{x: {start}}}, until: 1}}\n"
        )
    };
    for (name, start) in [("one", "1"), ("same", "1"), ("other", "2")] {
        fs::write(folder.join(format!("{name}.yaml")), twin(start)).expect("a file");
    }
    let chart = |twin: &str| {
        let methods = ["chart", "one.yaml", "--methods", "dop853", "--twin", twin, "--plot", "a.svg", "--csv", "a.csv"];
        told(&done(&folder, &methods)).1
    };
    assert!(chart("other.yaml").contains("starts elsewhere: far is 2 there and 1 here"), "{}", chart("other.yaml"));
    assert!(!chart("same.yaml").contains("elsewhere"), "{}", chart("same.yaml"));
}
