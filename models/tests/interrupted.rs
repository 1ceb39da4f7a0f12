//! Commands that end before their time, as processes.
#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Enough runs that it can be ended on the way.
const SWEEP: [&str; 7] = ["sweep", "double_pendulum", "--vary", "l=0.5..1:120", "--until", "1", "--threads=1"];

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("interrupted-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn program(arguments: &[&str], table: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_dalembert"));
    command.args(SWEEP).args(arguments).arg("--csv").arg(table).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// The whole table, by a sweep that nothing ends.
fn whole(folder: &Path) -> String {
    let table = folder.join("whole.csv");
    assert!(program(&[], &table).status().expect("the program").success());
    fs::read_to_string(table).expect("a table")
}

/// A sweep that has some rows and not all.
fn begun(table: &Path) -> Child {
    let child = program(&[], table).spawn().expect("the program");
    let late = Instant::now() + Duration::from_secs(60);
    while fs::read_to_string(table).map_or(0, |text| text.lines().count()) < 5 {
        assert!(Instant::now() < late, "no rows");
        std::thread::sleep(Duration::from_millis(1));
    }
    child
}

/// Continues it, and compares with the whole.
fn continued(table: &Path, whole: &str) {
    let output = program(&["--resume"], table).output().expect("the program");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(fs::read_to_string(table).expect("a table"), whole);
}

#[test]
fn a_sweep_asked_to_end_leaves_its_rows_in_order_and_is_continued() {
    let folder = folder("term");
    let (whole, table) = (whole(&folder), folder.join("table.csv"));
    let child = begun(&table);
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().expect("kill").success());
    let output = child.wait_with_output().expect("its end");
    let told = String::from_utf8_lossy(&output.stderr);
    let part = fs::read_to_string(&table).expect("a table");
    let rows = part.lines().count() - 1;
    assert!((4..120).contains(&rows), "{rows}");
    assert!(part.lines().all(|line| whole.contains(&format!("{line}\n"))));
    let runs: Vec<usize> =
        part.lines().skip(1).map(|line| line.split(',').next().unwrap().parse().expect("a run")).collect();
    assert!(runs.is_sorted(), "{runs:?}");
    assert_eq!(output.status.code(), Some(1));
    assert!(told.contains(&format!("interrupted: {rows} of 120 runs")) && told.contains("--resume"), "{told}");
    continued(&table, &whole);
}

#[test]
fn a_sweep_that_was_killed_is_continued_after_its_last_whole_row() {
    let folder = folder("kill");
    let (whole, table) = (whole(&folder), folder.join("table.csv"));
    let mut child = begun(&table);
    child.kill().expect("it runs");
    child.wait().expect("its end");
    // A row that was not written to its end, as a full disk or a power cut leaves it.
    let mut part = fs::read_to_string(&table).expect("a table");
    assert!(part.lines().count() < 120);
    part.truncate(part.len() - 30);
    fs::write(&table, part).expect("a table");
    continued(&table, &whole);
}

/// A command that a shell has begun in the background, where Ctrl-C is ignored unless the program heeds it, as soon as it does.
#[cfg(target_os = "linux")]
fn in_background(arguments: &[&str]) -> Child {
    let mut command = Command::new("sh");
    command.args(["-c", "trap '' INT; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_dalembert")]).args(arguments);
    let child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program");
    let [status, executable] = ["status", "exe"].map(|file| format!("/proc/{}/{file}", child.id()));
    let program = fs::canonicalize(env!("CARGO_BIN_EXE_dalembert")).expect("the program");
    // The second bit of what is caught is that of SIGINT.
    let heeds = |text: String| {
        let caught = text.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 2 != 0)
    };
    let late = Instant::now() + Duration::from_secs(60);
    // The shell heeds it, too, before it is told not to.
    while !(fs::read_link(&executable).is_ok_and(|path| path == program)
        && fs::read_to_string(&status).is_ok_and(heeds))
    {
        assert!(Instant::now() < late, "{arguments:?} does not heed it");
        std::thread::sleep(Duration::from_millis(1));
    }
    // What a signal does is set just after it is caught.
    std::thread::sleep(Duration::from_millis(50));
    child
}

/// What has nothing to keep ends as it is told to, and says so in JSON.
#[test]
#[cfg(target_os = "linux")]
fn a_signal_ends_at_once_what_has_nothing_to_keep() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        for command in ["check", "show", "modes", "needs", "simulate"] {
            // Its model never comes.
            let mut child = in_background(&[command, "-", "--json"]);
            let _input = child.stdin.take();
            assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill").success());
            let output = child.wait_with_output().expect("its end");
            let (out, told) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
            assert_eq!((output.status.code(), &*told), (Some(code), "error: interrupted\n"), "{command}");
            assert_eq!(out, "{\"format\":1,\"error\":{\"kind\":\"run\",\"message\":\"interrupted\"}}\n", "{command}");
        }
    }
}

/// Each would take minutes, or hours.
#[test]
#[cfg(target_os = "linux")]
fn searches_and_charts_went_on_after_ctrl_c() {
    let folder = folder("searches");
    let [plot, csv] = ["chart.svg", "chart.csv"].map(|name| folder.join(name).to_string_lossy().into_owned());
    let long = ["--until", "1e5", "--max-steps", "1000000000000"];
    let of = |list: &[&'static str]| -> Vec<String> { list.iter().chain(&long).map(|x| (*x).to_owned()).collect() };
    let mut chart = of(&["chart", "double_pendulum"]);
    chart.truncate(4);
    chart.extend(["--plot".to_owned(), plot, "--csv".to_owned(), csv]);
    let mut needs = of(&["needs", "double_pendulum"]);
    needs.truncate(4);
    let map = "Omega=50..500:100,A=0.01..0.1:100";
    for words in [
        of(&["solve", "double_pendulum", "--unknown", "theta1=1", "--such-that", "theta2=0"]),
        of(&["orbit", "double_pendulum", "--period", "1e5"]),
        ["orbit", "double_pendulum", "--from", "mode 1", "--vary", "energy=..40"].map(str::to_owned).to_vec(),
        ["orbit", "shaken_pendulum", "--map", map].map(str::to_owned).to_vec(),
        chart,
        needs,
    ] {
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let child = in_background(&words);
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill").success());
        let output = child.wait_with_output().expect("its end");
        let told = String::from_utf8_lossy(&output.stderr);
        // Before there is something to keep it ends at once.
        assert!(
            matches!(output.status.code(), Some(1 | 130)) && told.contains("interrupted"),
            "{words:?}: {}: {told}",
            output.status
        );
    }
}
