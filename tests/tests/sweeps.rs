//! `sweep`: many runs on the command line.

use std::fs;
use std::path::PathBuf;

use dalembert::prelude::*;
use dalembert_models::MODELS;

dalembert::model!("../models/double_pendulum.yaml", name = DoublePendulum);

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("dalembert-sweep-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// What the program prints, or what it says is wrong.
fn told(arguments: &[&str]) -> Result<String, String> {
    let mut out = Vec::new();
    match dalembert::cli::run(MODELS, ["dalembert"].iter().chain(arguments), &mut out) {
        Ok(()) => Ok(String::from_utf8(out).expect("text")),
        Err(problem) => Err(problem.to_string()),
    }
}

/// A sweep's table.
fn swept(path: &PathBuf, arguments: &[&str]) -> String {
    let path_text = path.to_str().expect("a path");
    told(&[&["sweep"], arguments, &["--csv", path_text]].concat()).expect("a sweep");
    fs::read_to_string(path).expect("a table")
}

const GRID: [&str; 9] =
    ["double_pendulum", "--vary", "l=0.5..1:3", "--vary", "theta1'=0,1 rad/s", "--until", "1", "--tolerance", "1e-9"];

#[test]
fn a_grid_holds_what_single_runs_give() {
    let table = swept(&folder("grid").join("all.csv"), &GRID);
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let names = reader.headers().expect("names").clone();
    let place =
        |name: &str| names.iter().position(|known| known == name).unwrap_or_else(|| panic!("{name} in {names:?}"));
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("a row")).collect();
    assert_eq!(rows.len(), 6);
    for (index, row) in rows.iter().enumerate() {
        let value = |name: &str| row[place(name)].parse::<f64>().expect("a number");
        assert_eq!(value("run"), index as f64);
        let (l, speed) = ([0.5, 0.75, 1.0][index / 2], [0.0, 1.0][index % 2]);
        assert_eq!((value("l"), value("theta1' at the start")), (l, speed));
        assert!((value("theta1'") - speed).abs() > 0.1, "the end is no start");
        let model = DoublePendulum { l, ..DoublePendulum::default() };
        // Reports so close to each other that what lies between two of them is no more than 1e-7 m.
        let run = model.simulate().starting("theta1'", speed).until(1.0).tolerance(1e-9).every(1e-4);
        let run = run.run().expect("a run");
        let column = run.column("tip.y").expect("an output");
        let extremes =
            [column.iter().copied().fold(f64::INFINITY, f64::min), column.iter().copied().fold(-1e9, f64::max)];
        assert!((value("theta2") - run.last()["theta2"]).abs() < 1e-8);
        assert!((value("min tip.y") - extremes[0]).abs() < 2e-7 && (value("max tip.y") - extremes[1]).abs() < 2e-7);
        assert_eq!((value("t"), value("warnings"), &row[place("error")]), (1.0, 0.0, ""));
    }
}

/// Bare numbers take the unit that stands at the last.
#[test]
fn a_unit_that_stands_once_is_that_of_all() {
    let path = folder("units").join("all.csv");
    for values in ["20..40 deg:3", "20, 30, 40 deg", "20 deg, 30 deg, 2*pi/9"] {
        let vary = format!("theta1={values}");
        let table = swept(&path, &["double_pendulum", "--vary", &vary, "--until", "0.01"]);
        let rows = csv::Reader::from_reader(table.as_bytes()).into_records().map(|row| row.expect("a row")[1].parse());
        let found: Vec<f64> = rows.map(|value| value.expect("a number")).collect();
        let expected = [20.0_f64, 30.0, 40.0].map(f64::to_radians);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{values}: {found:?}");
    }
    let table = swept(&path, &["double_pendulum", "--vary", "l=5..15:2", "--until", "0.01"]);
    let lengths = table.lines().skip(1).map(|line| line.split(',').nth(1).and_then(|cell| cell.parse().ok()));
    assert_eq!(lengths.collect::<Vec<Option<f64>>>(), [Some(5.0), Some(15.0)]);
}

#[test]
fn parts_are_put_together_to_the_same_bytes_whatever_the_number_of_threads() {
    let folder = folder("parts");
    let whole = swept(&folder.join("whole.csv"), &GRID);
    assert_eq!(whole, swept(&folder.join("one.csv"), &[&GRID[..], &["--threads", "1"]].concat()));
    let part = |k: u32| folder.join(format!("part{k}.csv")).to_str().expect("a path").to_owned();
    for k in 1..=3 {
        swept(&part(k).into(), &[&GRID[..], &["--shard", &format!("{k}/3"), "--threads", "2"]].concat());
    }
    let parts = [part(3), part(1), part(2)];
    let merge = |parts: &[String]| {
        let all: Vec<&str> =
            ["double_pendulum", "--merge"].into_iter().chain(parts.iter().map(String::as_str)).collect();
        let path = folder.join("merged.csv");
        let told = told(&[&["sweep"], &all[..], &["--csv", path.to_str().expect("a path")]].concat());
        told.map(|_| fs::read_to_string(path).expect("a table"))
    };
    assert_eq!(merge(&parts), Ok(whole));
    let missing = merge(&parts[..2]).expect_err("a part is missing");
    assert!(missing.contains("run 1 is missing"), "{missing}");
    let twice = merge(&[part(1), part(1), part(2), part(3)]).expect_err("a part stands twice");
    assert!(twice.contains("run 0 stands there twice"), "{twice}");
}

/// Parts of different sweeps would make a table of nothing.
#[test]
fn parts_of_different_sweeps_are_refused_with_what_differs() {
    let folder = folder("different");
    let path = |name: &str| folder.join(name).to_str().expect("a path").to_owned();
    let model = path("bob.yaml");
    let text = "name: Bob\nparameters: {m: 1 kg, l: 1 m}\ncoordinates: {x: m}\nbodies: {bob: {mass: m, position: \"[x, l]\"}}\n\
                scene: {start: {x: 1, x': 1}, until: 1}\n";
    fs::write(&model, text).expect("a file");
    let sweep = |name: &str, shard: &str, more: &[&str]| {
        let vary: &[&str] = if more.contains(&"--vary") { &[] } else { &["--vary", "m=1,2,3"] };
        let path = path(name);
        told(&[&["sweep", &model, "--shard", shard, "--csv", &path], vary, more].concat()).expect("a sweep");
        path
    };
    let merge = |parts: [&str; 2]| told(&["sweep", &model, "--merge", parts[0], parts[1], "--csv", &path("all.csv")]);
    let first = sweep("first.csv", "1/2", &[]);
    let others: [(&[&str], &str); 6] = [
        (&["--set", "l=2"], "parameter l: 1.0 and 2.0"),
        (&["--tolerance", "1e-3"], "--tolerance: not given and 1e-3"),
        (&["--start", "x=2"], "--start x: not given and 2"),
        (&["--until", "2"], "--until: not given and 2"),
        (&["--vary", "m=1,2,4"], "values of m: 3 from 1.0 to 3.0 ("),
        (&["--vary", "l=1,2,3"], "varies: m and l"),
    ];
    for (more, difference) in others {
        let refused = merge([&first, &sweep("other.csv", "2/2", more)]).expect_err("another sweep");
        assert!(refused.contains("are not of one sweep") && refused.contains(difference), "{more:?}: {refused}");
    }
    let second = sweep("second.csv", "2/2", &[]);
    merge([&first, &second]).expect("a table");
    // What is continued must be the same to the part.
    let again = ["sweep", &model, "--vary", "m=1,2,3", "--csv", &second, "--resume", "--shard"];
    let refused = told(&[&again[..], &["1/2"]].concat()).expect_err("another part");
    assert!(refused.contains("shard: 2/2 and 1/2"), "{refused}");
    let before = fs::read_to_string(&second).expect("a table");
    told(&[&again[..], &["2/2"]].concat()).expect("nothing is left to do");
    assert_eq!(fs::read_to_string(&second).expect("a table"), before);
    // The model's text, and a table of which nothing is known.
    fs::write(&model, text.replace("until: 1", "until: 3")).expect("a file");
    let refused = merge([&first, &second]).expect_err("another model");
    assert!(refused.contains("bob.yaml, or its file has changed"), "{refused}");
    fs::remove_file(format!("{second}.json")).expect("what says what it is a table of");
    let refused = merge([&first, &second]).expect_err("a table without it");
    assert!(refused.contains("second.csv.json") && refused.contains("belongs beside it"), "{refused}");
}

/// A part without its last run leaves no gap between the others.
#[test]
fn a_last_run_that_is_missing_is_missed() {
    let folder = folder("last");
    let path = |name: &str| folder.join(name).to_str().expect("a path").to_owned();
    let (first, second) = (path("first.csv"), path("second.csv"));
    for (part, shard) in [(&first, "1/2"), (&second, "2/2")] {
        swept(&part.into(), &[&GRID[..], &["--shard", shard]].concat());
    }
    let text = fs::read_to_string(&second).expect("a table");
    let cut = text.trim_end().rfind('\n').expect("rows") + 1;
    fs::write(&second, &text[..cut]).expect("a file");
    let merge = ["sweep", "double_pendulum", "--merge", &first, &second, "--csv", "/dev/null"];
    let missing = told(&merge).expect_err("a run is missing");
    assert!(missing.contains("run 5 is missing") && missing.contains("--resume"), "{missing}");
}

#[test]
fn a_table_may_go_to_standard_output() {
    let folder = folder("output");
    let expected = swept(&folder.join("all.csv"), &GRID);
    assert_eq!(told(&[&["sweep"], &GRID[..], &["--csv", "-"]].concat()).expect("a sweep"), expected);
    let refused = told(&[&["sweep"], &GRID[..], &["--csv", "-", "--resume"]].concat()).expect_err("no file");
    assert!(refused.contains("--resume continues the table of a file"), "{refused}");
}

#[test]
fn a_run_that_fails_stands_in_its_row() {
    let folder = folder("fails");
    let path = folder.join("table.csv");
    let file = folder.join("ball.yaml");
    let text = "name: Ball
parameters: {m: 1 kg, k: 1 1/(m*s^2)}
coordinates: {x: m}
bodies: {ball: {mass: m, position: \"[x, 0]\"}}
generalized_forces: {x: \"k*m*x^2\"}
scene: {start: {x: 1}, until: 3}
";
    fs::write(&file, text).expect("a file");
    let (file, table) = (file.to_str().expect("a path"), path.to_str().expect("a path"));
    let sweep = ["sweep", file, "--vary", "k=0.1..10:4:log", "--csv", table];
    let failed = told(&sweep).expect_err("some leave for infinity");
    assert!(failed.contains("of 4 runs failed; the first, run"), "{failed}");
    let rows = fs::read_to_string(path).expect("a table").lines().count();
    assert_eq!(rows, 5);
}

#[test]
fn runs_may_be_listed_in_a_file() {
    let folder = folder("list");
    let list = folder.join("list.csv");
    fs::write(&list, "m, theta\n1, 0.1\n2, 0.2\n").expect("a file");
    let list = list.to_str().expect("a path");
    let table = swept(&folder.join("all.csv"), &["simple_pendulum", "--points", list, "--until", "1"]);
    assert!(table.lines().count() == 3, "{table}");
}

#[test]
fn nothing_is_written_over_what_a_table_is_made_from() {
    let folder = folder("over");
    let part = folder.join("part.csv");
    let table = swept(&part, &[&GRID[..], &["--shard", "1/2"]].concat());
    let text = part.to_str().expect("a path");
    let refused = told(&["sweep", "double_pendulum", "--merge", text, "--csv", text]).expect_err("a refusal");
    assert!(refused.contains("would overwrite") && refused.contains("--csv"), "{refused}");
    assert_eq!(fs::read_to_string(&part).expect("a table"), table);

    let list = folder.join("list.csv");
    fs::write(&list, "theta\n0.1\n").expect("a file");
    let text = list.to_str().expect("a path");
    let refused = told(&["sweep", "simple_pendulum", "--points", text, "--csv", text]).expect_err("a refusal");
    assert!(refused.contains("would overwrite"), "{refused}");
    assert_eq!(fs::read_to_string(&list).expect("a table"), "theta\n0.1\n");
}

#[test]
fn a_sweep_that_is_refused_leaves_no_file() {
    let path = folder("trace").join("table.csv");
    let text = path.to_str().expect("a path");
    told(&["sweep", "double_pendulum", "--vary", "len=1,2", "--csv", text]).expect_err("a refusal");
    assert!(!path.exists());
}

#[test]
fn what_has_no_meaning_is_refused_with_a_way_out() {
    let refused =
        |arguments: &[&str]| told(&[&["sweep", "double_pendulum"], arguments].concat()).expect_err("a refusal");
    let cases: [(&[&str], &str); 9] = [
        (&[], "a sweep wants --vary"),
        (&["--vary", "l=1..2"], "--vary wants NAME=A..B:COUNT"),
        (&["--vary", "l=1..2:0"], "--vary wants"),
        (&["--vary", "l=-1..2:3:log"], "no logarithm"),
        (&["--vary", "len=1,2"], "no parameter or coordinate is called `len`"),
        (&["--vary", "l=1,2", "--vary", "l=3,4"], "--vary gives `l` twice"),
        (&["--vary", "l=1..2:10000", "--vary", "m=1..2:10000"], "more than 10000000 runs"),
        (&["--vary", "l=1,2", "--shard", "3/2"], "--shard wants I/N"),
        (&["--vary", "l=1,2", "--show", "tip"], "no result is called `tip`"),
    ];
    for (arguments, part) in cases {
        let problem = refused(&[arguments, &["--csv", folder("bad").join("x.csv").to_str().expect("a path")]].concat());
        assert!(problem.contains(part), "{arguments:?}: {problem}");
    }
}

#[test]
fn frequencies_stand_in_the_table() {
    // Two rods of a length l each: both frequencies go as √(g/l).
    let path = folder("modes").join("all.csv");
    let table = swept(&path, &["double_pendulum", "--vary", "l=0.5,2", "--until", "0.1", "--modes", "3"]);
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let names = reader.headers().expect("names").clone();
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("a row")).collect();
    let value = |row: usize, name: &str| {
        let place = names.iter().position(|known| known == name).unwrap_or_else(|| panic!("{name} in {names:?}"));
        rows[row][place].parse::<f64>().ok()
    };
    for (row, l) in [(0, 0.5), (1, 2.0)] {
        let model = DoublePendulum { l, ..DoublePendulum::default() };
        let rest = model.equilibrium_near(&[0.0, 0.0]).expect("at rest");
        let modes = model.linearise(&rest).expect("M, C and K").modes().expect("two modes");
        for (k, mode) in modes.iter().enumerate() {
            let found = value(row, &format!("frequency {}", k + 1)).expect("a frequency");
            assert!((found * std::f64::consts::TAU - mode.omega).abs() < 1e-12 * mode.omega);
            assert_eq!(value(row, &format!("damping {}", k + 1)), mode.zeta);
        }
        assert_eq!((value(row, "frequency 3"), value(row, "damping 3")), (None, None));
    }
    // A table that is read again keeps its modes.
    let again = told(&["sweep", "double_pendulum", "--merge", path.to_str().expect("a path"), "--csv", "/dev/null"]);
    assert!(again.expect("a table").contains("frequency 1"));
    let refused = told(&["sweep", "double_pendulum", "--vary", "l=1,2", "--modes", "many", "--csv", "/dev/null"]);
    assert!(refused.expect_err("no number").contains("--modes wants a number from 1 to 100"));
}

/// Values of these columns in all rows of a table.
fn columns(table: &str, names: &[&str]) -> Vec<Vec<Option<f64>>> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let known = reader.headers().expect("names").clone();
    let place =
        |name: &&str| known.iter().position(|own| own == *name).unwrap_or_else(|| panic!("{name} in {known:?}"));
    let places: Vec<usize> = names.iter().map(place).collect();
    let row = |row: csv::StringRecord| places.iter().map(|place| row[*place].parse().ok()).collect();
    reader.records().map(|found| row(found.expect("a row"))).collect()
}

#[test]
fn what_does_not_oscillate_has_no_frequency_and_comes_last() {
    let folder = folder("real");
    let path = folder.join("all.csv");
    let bob = ["simple_pendulum", "--vary", "g=-5,5", "--until", "0.1", "--modes", "1"];
    let found = columns(&swept(&path, &bob), &["frequency 1", "damping 1"]);
    // Upside down it leaves by the rate √(g/l), as e^(2.236 t).
    assert_eq!((found[0][0], found[0][1]), (None, Some(-1.0)));
    assert!(found[1][0].is_some_and(|hertz| (hertz - 0.355881).abs() < 1e-6), "{found:?}");
    // Two masses on springs: x with a damper that turns its pair real, y without one.
    let file = folder.join("pairs.yaml");
    let text = "name: Pairs
parameters: {m: 1 kg, k: 4 N/m, c: 0.1 N*s/m}
coordinates: {x: m, y: m}
bodies:
  first: {mass: m, position: \"[x, 0]\"}
  second: {mass: m, position: \"[y, 0]\"}
potential_energy: k*(x^2 + y^2)/2
generalized_forces: {x: -c*x'}
scene: {start: {x: 1}, until: 0.1}
";
    fs::write(&file, text).expect("a file");
    let sweep = [file.to_str().expect("a path"), "--vary", "c=0.2,10", "--vary", "k=1..9:9", "--modes", "2"];
    let names = ["frequency 1", "damping 1", "frequency 2", "damping 2"];
    for (run, row) in columns(&swept(&path, &sweep), &names).iter().enumerate() {
        // Frequencies √(k/m) are equal but for rounding: the undamped one comes first.
        assert!(row[1].is_some_and(|zeta| zeta.abs() < 1e-12) && row[3] > Some(0.01), "{row:?}");
        assert_eq!(row[2].is_some(), run < 9, "{row:?}");
    }
}

/// A picture has as many curves as can be told apart, from the first to the last, and says so.
#[test]
fn of_many_curves_evenly_spread_ones_are_drawn() {
    let folder = folder("many");
    let (table, picture) = (folder.join("all.csv"), folder.join("all.svg"));
    let plot = picture.to_str().expect("a path");
    let vary = ["simple_pendulum", "--vary", "l=1,2", "--vary", "theta=0.1..3:30", "--until", "0.1"];
    swept(&table, &[&vary[..], &["--show", "theta", "--plot", plot]].concat());
    let text = fs::read_to_string(&picture).expect("a picture");
    assert!(text.contains("(12 of 30 curves)"), "{text}");
    assert!(["start = 0.1", "start = 3"].iter().all(|name| text.contains(name)), "{text}");
    swept(&table, &["simple_pendulum", "--vary", "l=1,2", "--until", "0.1", "--show", "theta", "--plot", plot]);
    assert!(!fs::read_to_string(&picture).expect("a picture").contains("curves)"));
}

#[test]
fn units_stand_in_tables_and_legends() {
    let folder = folder("named");
    let (table, picture) = (folder.join("all.csv"), folder.join("all.svg"));
    let (csv, plot) = (table.to_str().expect("a path"), picture.to_str().expect("a path"));
    let sweep = ["sweep", "simple_pendulum", "--vary", "l=1,2", "--vary", "theta=0.1,0.2", "--until", "0.1"];
    let shown = ["--show", "theta,max tension", "--csv", csv, "--plot", plot];
    let text = told(&[&sweep[..], &shown].concat()).expect("a sweep");
    let header = text.lines().next().expect("names");
    for name in ["l (m)", "theta at the start (rad)", "theta (rad)", "max tension (N)"] {
        assert!(header.contains(name), "{header}");
    }
    assert!(fs::read_to_string(&picture).expect("a picture").contains("theta at the start = 0.1 rad"));
    let data: serde_json::Value =
        serde_json::from_str(&told(&[&sweep[..], &["--csv", csv, "--json"]].concat()).expect("a sweep"))
            .expect("an object");
    let place = data["columns"].as_array().expect("names").iter().position(|name| name == "l").expect("what varies");
    assert_eq!(data["units"][place], "m");
}

/// A ball that has landed is at 0 but for rounding, whatever its speed was.
#[test]
fn a_picture_is_not_scaled_to_rounding() {
    let folder = folder("rounding");
    let picture = folder.join("all.svg");
    let plot = picture.to_str().expect("a path");
    let sweep = ["cannon_ball", "--vary", "y'=20..60:3", "--show", "y", "--plot", plot];
    swept(&folder.join("all.csv"), &sweep);
    let text = fs::read_to_string(&picture).expect("a picture");
    assert!(text.contains("y (m)") && !text.contains("·10"), "{text}");
}

#[test]
fn seeds_are_varied_once() {
    let path = folder("seeds").join("all.csv");
    let sweep = ["sweep", "mast_in_gusts", "--vary", "gust_seed=1,2", "--seeds", "1..3", "--csv"];
    let refused = told(&[&sweep[..], &[path.to_str().expect("a path")]].concat()).expect_err("a refusal");
    assert!(refused.contains("`gust_seed` is varied by --vary and by --seeds"), "{refused}");
    assert!(!path.exists());
}

#[test]
fn a_row_with_other_values_is_not_taken_for_done() {
    let path = folder("changed").join("all.csv");
    let sweep = ["simple_pendulum", "--vary", "theta=0.1,0.25", "--until", "0.1", "--resume"];
    let table = swept(&path, &sweep);
    fs::write(&path, table.replacen("2.5000000000000000e-1", "9.5000000000000000e-1", 1)).expect("a table");
    let again = [&["sweep"], &sweep[..], &["--csv", path.to_str().expect("a path")]].concat();
    let refused = told(&again).expect_err("other values");
    assert!(refused.contains("run 1 has other values than in this sweep"), "{refused}");
}

#[test]
fn settings_without_meaning_leave_a_table_as_it_is() {
    let path = folder("settings").join("all.csv");
    let sweep = ["simple_pendulum", "--vary", "theta=0.1,0.2"];
    let table = swept(&path, &[&sweep[..], &["--until", "0.1"]].concat());
    for (option, value) in [("--every", "0"), ("--every", "-1"), ("--until", "-1")] {
        let value = format!("{option}={value}");
        let more = [&value, "--csv", path.to_str().expect("a path")];
        let refused = told(&[&["sweep"], &sweep[..], &more].concat()).expect_err("a refusal");
        assert!(refused.contains(&format!("{option} is ")) && refused.contains("expected"), "{refused}");
        assert_eq!(fs::read_to_string(&path).expect("a table"), table);
    }
}

/// After a minute a double pendulum's angles are anyone's; its printed numbers are those that hold.
#[test]
fn rows_are_printed_with_the_digits_that_hold() {
    let path = folder("digits").join("all.csv");
    let path = path.to_str().expect("a path");
    let sweep = ["sweep", "double_pendulum", "--vary", "theta1=1.5,1.6", "--show", "theta1", "--csv", path];
    let line =
        |text: &str| text.lines().nth(1).and_then(|line| line.split_whitespace().nth(2)).expect("a cell").to_owned();
    let lost = told(&[&sweep[..], &["--until", "60"]].concat()).expect("a sweep");
    assert_eq!(line(&lost), "?", "{lost}");
    let known = told(&[&sweep[..], &["--until", "1"]].concat()).expect("a sweep");
    assert_eq!(line(&known).trim_start_matches('-').len(), "0.123456".len(), "{known}");
    let all = told(&[&sweep[..], &["--until", "60", "--no-digits"]].concat()).expect("a sweep");
    assert!(line(&all) != "?" && all.contains("how many digits hold was not asked"), "{all}");
}
