//! Sweeps that end before their time, as processes.
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
