//! `chart`: what it prints and writes.

use std::fs;
use std::path::PathBuf;

use dalembert_models::MODELS;

/// What `chart` says; what it writes where nothing says where goes with a test's other files.
fn told(arguments: &[&str]) -> Result<String, String> {
    let mut out = Vec::new();
    let (svg, csv) = (file("unnamed.svg"), file("unnamed.csv"));
    let paths = [["--plot", text(&svg)], ["--csv", text(&csv)]];
    let missing = paths.iter().filter(|[option, _]| !arguments.contains(option)).flatten();
    let arguments = ["dalembert", "chart"].iter().chain(arguments).chain(missing);
    match dalembert::cli::run(MODELS, arguments, &mut out) {
        Ok(()) => Ok(String::from_utf8(out).expect("text")),
        Err(problem) => Err(problem.to_string()),
    }
}

/// Where a test's files go.
fn file(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("dalembert-charts-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    folder.join(name)
}

fn text(path: &std::path::Path) -> &str {
    path.to_str().expect("text")
}

#[test]
fn a_chart_has_a_curve_for_every_method_that_suits() {
    let (svg, csv) = (file("pendulum.svg"), file("pendulum.csv"));
    let printed = told(&["double_pendulum", "--until", "1", "--plot", text(&svg), "--csv", text(&csv)]).unwrap();
    for expected in [
        "measured from extrapolation in double-double, of which two runs agree to",
        "not separable, since its mass matrix changes",
        "An error of 1e-6 costs",
    ] {
        assert!(printed.contains(expected), "{expected}: {printed}");
    }
    let points = fs::read_to_string(csv).unwrap();
    for method in ["auto", "euler", "rk4", "dopri5", "dop853", "gauss6", "radau5", "rodas5p"] {
        assert!(points.contains(&format!("DoublePendulum,{method},")), "{method}");
    }
    assert!(!points.contains("verlet"));
    let digits = |row: &str| -> u32 { row.rsplit_once(",double-double,").unwrap().1.parse().unwrap() };
    assert!(points.lines().skip(1).all(|row| digits(row) >= 22), "{points}");
    let picture = fs::read_to_string(svg).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("DoublePendulum, measured from double-double ("));
}

#[test]
fn a_reference_in_double_precision_says_why_it_is_no_better() {
    let (svg, csv) = (file("double.svg"), file("double.csv"));
    let paths = ["--methods", "rk4", "--plot", text(&svg), "--csv", text(&csv)];
    for (arguments, why) in [
        (vec!["slider_crank", "--until", "1"], "there are constraints"),
        (vec!["cannon_ball"], "there are events"),
        (vec!["shaken_pendulum", "--until", "1", "--input", "base=0.1*sin(t)"], "an input is not the file's"),
    ] {
        let arguments: Vec<&str> = arguments.into_iter().chain(paths).collect();
        let printed = told(&arguments).unwrap();
        assert!(printed.contains("measured from dop853, with which dopri5 agrees to"), "{printed}");
        assert!(printed.contains(&format!("(no more by double-double: {why})")), "{why}: {printed}");
        assert!(fs::read_to_string(&csv).unwrap().lines().nth(1).unwrap().contains(",dop853,1"));
    }
}

#[test]
fn constraints_are_treated_in_four_ways_and_compared_with_the_minimal_file() {
    let (svg, csv) = (file("four.svg"), file("four.csv"));
    let printed = told(&[
        "pendulum_cartesian",
        "--scene",
        "high",
        "--compare",
        "bob.x,bob.y",
        "--until",
        "2",
        "--methods",
        "dop853",
        "--twin",
        "simple_pendulum",
        "--plot",
        text(&svg),
        "--csv",
        text(&csv),
    ])
    .unwrap();
    let points = fs::read_to_string(csv).unwrap();
    for way in ["multipliers", "not projected", "Baumgarte", "null space", "springs 1e6", "simple_pendulum (minimal)"] {
        assert!(points.contains(&format!(",{way},")) && printed.contains(way), "{way}: {printed}");
    }
    // What is not modelled costs nothing: the minimal coordinates need the least work.
    let cost = |way: &str| -> f64 {
        let line = printed.lines().find(|line| line.starts_with(way)).unwrap_or_else(|| panic!("{way}: {printed}"));
        line[way.len()..].split_whitespace().nth(1).unwrap().parse().unwrap()
    };
    assert!(cost("simple_pendulum (minimal)") < 1.1 * cost("multipliers"), "{printed}");
}

#[test]
fn what_makes_no_sense_is_refused_before_anything_runs() {
    for (arguments, expected) in [
        (vec!["simple_pendulum", "--methods", "rk5"], "unknown method `rk5`"),
        (vec!["simple_pendulum", "--compare", "psi"], "no coordinate, rate or output is called `psi`"),
        (vec!["simple_pendulum", "--twin", "bouncing_ball"], "have no output of one name"),
        (vec!["nobody"], "no model and no file is called `nobody`"),
    ] {
        let paths = [text(&file("no.svg")).to_owned(), text(&file("no.csv")).to_owned()];
        let arguments: Vec<&str> = arguments.into_iter().chain(["--plot", &paths[0], "--csv", &paths[1]]).collect();
        let problem = told(&arguments).unwrap_err();
        assert!(problem.contains(expected), "{expected}: {problem}");
    }
}

/// Reported at half periods, where y is 0 but for rounding, an orbit is measured by how far it goes between them.
/// Without a run there is nothing to chart.
#[test]
fn too_few_steps_and_no_returns_are_refused() {
    let (svg, csv) = (file("none.svg"), file("none.csv"));
    for (option, value, why) in [
        ("--max-steps", "5", "--max-steps 5 leaves no method a run"),
        ("--returns", "0", "--returns wants a number of periods, 1 or more, not `0`"),
    ] {
        let kind = if option == "--returns" { [].as_slice() } else { &["--steps"] };
        let arguments =
            ["simple_pendulum", "--methods", "rk4", option, value, "--plot", text(&svg), "--csv", text(&csv)];
        let refused = told(&[&arguments[..], kind].concat()).expect_err("a refusal");
        assert!(refused.contains(why), "{refused}");
    }
}

#[test]
fn what_is_reported_where_it_vanishes_is_measured_by_where_it_goes() {
    let orbit = file("orbit.yaml");
    let text_of = "name: Orbit
coordinates: {x: 1, y: 1}
kinetic_energy: (x'^2 + y'^2)/2
potential_energy: -1/sqrt(x^2 + y^2)
scene: {start: {x: 0.4, y': 2}, until: 20*pi, every: pi, tolerance: 1e-10}
";
    fs::write(&orbit, text_of).unwrap();
    let (svg, csv) = (file("orbit.svg"), file("orbit.csv"));
    let paths = ["--methods", "dop853", "--plot", text(&svg), "--csv", text(&csv)];
    let printed = told(&[&[text(&orbit)], &paths[..]].concat()).unwrap();
    assert!(printed.contains("errors of x, y") && printed.contains("two runs agree to"), "{printed}");
}

#[test]
fn errors_fall_with_the_step_at_each_method_s_order_down_to_rounding() {
    let (svg, csv) = (file("steps.svg"), file("steps.csv"));
    let paths = ["simple_pendulum", "--steps", "--until", "2", "--plot", text(&svg), "--csv", text(&csv)];
    let printed = told(&[&paths[..], &["--max-steps", "50000"]].concat()).unwrap();
    let row = |method: &str| -> Vec<String> {
        let line = printed.lines().find(|line| line.split_whitespace().next() == Some(method));
        line.unwrap_or_else(|| panic!("{method}: {printed}")).split_whitespace().map(str::to_owned).collect()
    };
    let methods = [
        ("euler", 1.0),
        ("midpoint", 2.0),
        ("rk4", 4.0),
        ("verlet", 2.0),
        ("srkn4", 4.0),
        ("suzuki4", 4.0),
        ("kahanli8", 8.0),
        ("gauss2", 2.0),
        ("gauss4", 4.0),
        ("gauss6", 6.0),
    ];
    for (method, order) in methods {
        let [_, theory, observed, least, ..] = row(method).try_into().map(|cells: [String; 6]| cells).unwrap();
        let [theory, observed, least] = [theory, observed, least].map(|cell| cell.parse::<f64>().unwrap());
        assert_eq!(theory, order);
        assert!((observed - order).abs() < 0.05 * order, "{method}: {observed}");
        // Half a unit of the last place of the range, where the order is high enough to get there.
        assert_eq!(least < 1.2e-16, order > 3.0, "{method}: {least}");
    }
    assert!(
        printed
            .contains("Shorter steps make no difference any more for rk4, srkn4, suzuki4, kahanli8, gauss4, gauss6.")
    );
    assert!(!printed.contains("dop853  "), "methods with error control are not asked: {printed}");
    let table = fs::read_to_string(&csv).unwrap();
    assert!(
        table.starts_with("scene,method,order,step_s,steps,error,failure\nSimplePendulum,euler,1,2e-1,10,"),
        "{table}"
    );
    assert!(fs::read_to_string(&svg).unwrap().contains("rk4, order 4.0"));
    // A method with error control where it is named; all as data.
    let one = told(&[&paths[..], &["--methods", "dopri5", "--max-steps", "5000", "--json"]].concat()).unwrap();
    assert!(
        one.starts_with(
            "{\"format\":1,\"model\":\"SimplePendulum\",\"compared\":[\"theta\"],\"reference\":\"double-double\""
        ),
        "{one}"
    );
    assert!(one.contains("\"method\":\"dopri5\",\"order\":5,\"observed_order\":5."), "{one}");
    // Without --steps there is neither.
    let error = told(&["simple_pendulum", "--json"]).unwrap_err();
    assert!(error.contains("--steps"), "{error}");
}

/// The robot's ticks cut steps to 5 ms at the longest: longer ones are all the same run, and from there on errors fall at the fourth order.
#[test]
fn steps_that_ticks_cut_are_one_run() {
    let csv = file("ticks.csv");
    let arguments = ["sampled_robot", "--steps", "--methods", "rk4", "--max-steps", "4000", "--csv", text(&csv)];
    let printed = told(&arguments).unwrap();
    assert!(printed.contains("Errors still fall with the most steps that were taken for rk4"), "{printed}");
    let table = fs::read_to_string(&csv).unwrap();
    let row = |line: &str| -> [f64; 3] {
        let cells: Vec<&str> = line.split(',').collect();
        [3, 4, 5].map(|cell| cells[cell].parse().expect("a number"))
    };
    let rows: Vec<[f64; 3]> = table.lines().skip(1).map(row).collect();
    assert!((rows[0][0] / 5e-3 - 1.0).abs() < 1e-9 && rows[0][1] == 400.0, "{table}");
    assert!(rows.len() > 3 && rows.windows(2).all(|pair| pair[0][1] < pair[1][1]), "{table}");
    for pair in rows.windows(2).skip(1) {
        let order = (pair[0][2] / pair[1][2]).ln() / (pair[0][0] / pair[1][0]).ln();
        assert!((order - 4.0).abs() < 0.6, "{order}: {table}");
    }
    // The chart of work has as many evaluations only once.
    told(&["sampled_robot", "--methods", "rk4", "--until", "0.2", "--csv", text(&csv)]).unwrap();
    let table = fs::read_to_string(&csv).unwrap();
    let evaluations: Vec<&str> = table.lines().skip(1).filter_map(|line| line.split(',').nth(8)).collect();
    assert!(evaluations.len() > 2 && evaluations.windows(2).all(|pair| pair[0] != pair[1]), "{table}");
}

/// A load on a steel rope that starts at rest: what the rope does between the ends of one method's steps two others agree on.
#[test]
fn a_scene_that_starts_near_rest_is_charted_to_its_end() {
    let crane = concat!(env!("CARGO_MANIFEST_DIR"), "/needs/crane.yaml");
    let printed = told(&[crane, "--methods", "dop853", "--compare", "l"]).unwrap();
    assert!(printed.starts_with("Crane until t = 12\n") && !printed.contains("the scene goes on"), "{printed}");
}
