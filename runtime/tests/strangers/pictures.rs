//! Charts, axes, pictures, the command line.

use super::{folder, program};

/// The path of a model of the library.
fn model(name: &str) -> String {
    format!("{}/../models/{name}.yaml", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn quantities_of_several_units_have_an_axis_each() {
    let path = folder("axes").join("axes.svg");
    let file = path.to_str().unwrap();
    let arguments = ["simulate", &model("cart_pendulum"), "--no-digits", "--until", "1", "--plot", file];
    program(&[&arguments[..], &["--show", "x,theta,theta',x'"]].concat()).unwrap();
    let svg = std::fs::read_to_string(&path).unwrap();
    for label in ["x (m)", "theta (rad)", "theta' (rad/s)", "x' (m/s)"] {
        assert!(svg.contains(label) || svg.contains(&label.replace('\'', "&apos;")), "{label}");
    }
}

#[test]
fn a_table_goes_to_standard_output_alone() {
    let arguments =
        ["simulate", &model("simple_pendulum"), "--no-digits", "--until", "1", "--every", "0.5", "--csv", "-"];
    let table = program(&arguments).unwrap();
    assert!(table.starts_with("t,theta,theta'"), "{table}");
    assert_eq!(table.lines().count(), 4, "{table}");
    assert!(!std::path::Path::new("-").exists());
}

#[test]
fn several_files_are_checked_and_all_are_looked_at() {
    let (good, other) = (model("simple_pendulum"), model("bead_parabola"));
    let text = program(&["check", &good, &other]).unwrap();
    assert!(text.contains("simple_pendulum: 1 coordinate") && text.contains("bead_parabola: 1 coordinate"), "{text}");
    let error = program(&["check", "nowhere.yaml", &good]).unwrap_err();
    assert!(error.contains("nowhere.yaml"), "{error}");
}

#[test]
fn several_drives_may_stand_in_one_option() {
    let of = |drives: &[&str]| program(&[&["modes", &model("forced_chain"), "--omega", "3"], drives].concat()).unwrap();
    assert_eq!(of(&["--drive", "push1,push2=2"]), of(&["--drive", "push1", "--drive", "push2=2"]));
}

/// The picture that a command draws.
fn drawn(name: &str, arguments: &[&str]) -> String {
    let path = folder(name).join("drawn.svg");
    program(&[arguments, &["--plot", path.to_str().unwrap()]].concat()).unwrap();
    std::fs::read_to_string(&path).unwrap()
}

#[test]
fn events_are_marked_where_they_happen() {
    let few = drawn("few_events", &["simulate", &model("stick_slip"), "--no-digits"]);
    assert_eq!(few.matches("\nloose_back\n").count(), 2, "{few}");
    assert_eq!(few.matches("\nstick_back\n").count(), 2);
    // Of many there are ticks alone.
    let many = drawn("many_events", &["simulate", &model("bouncing_ball"), "--no-digits"]);
    assert!(!many.contains("\nland\n") && !many.contains("\nbounce\n"), "{many}");
    // Lines alike stand in one group, which says their colour once.
    let marks = |svg: &str| {
        let of_group =
            |rest: &str| match rest.starts_with('>') || rest.lines().next().is_some_and(|line| !line.ends_with("/>")) {
                true => rest.split("</g>").next().unwrap_or_default().matches("<polyline").count().max(1),
                false => 1,
            };
        svg.split("#6E6E6E").skip(1).map(of_group).sum::<usize>()
    };
    assert!(marks(&many) > 20 && marks(&few) >= 4, "{} {}", marks(&many), marks(&few));
    // Without events nothing is marked; nor where several runs share a chart.
    assert_eq!(marks(&drawn("no_events", &["simulate", &model("simple_pendulum"), "--no-digits"])), 0);
}

#[test]
fn names_beside_a_chart_are_not_repeated_along_its_axis() {
    let several = drawn("legend", &["simulate", &model("stick_slip"), "--no-digits"]);
    assert!(several.contains("\nin m\n") && !several.contains("x, y"), "{several}");
    // One curve, or one family of them, has its name at the axis.
    assert!(drawn("single", &["simulate", &model("simple_pendulum"), "--no-digits"]).contains("\ntheta (rad)\n"));
    let family = drawn("family", &["simulate", &model("free_chain"), "--no-digits", "--until", "1"]);
    assert!(family.contains("\nx[1]\n") && family.contains("\nx (m)\n"), "{family}");
}

#[test]
fn sweeps_are_drawn_over_logarithms() {
    let csv = folder("sweep").join("table.csv");
    let table = ["--csv", csv.to_str().unwrap()];
    let of = |vary: &str, more: &[&str]| {
        let pendulum = model("simple_pendulum");
        let arguments = ["sweep", &pendulum, "--vary", vary, "--until", "1", "--show", "max theta"];
        drawn("sweep", &[&arguments[..], &table, more].concat())
    };
    let [plain, by_values] = [of("theta=0.001..1:4", &[]), of("theta=0.001..1:4:log", &[])];
    assert!(!plain.contains("\n10⁻²\n") && by_values.matches("\n10⁻²\n").count() == 1, "{plain} {by_values}");
    let both = of("theta=0.001..1:4", &["--log", "x,y"]);
    assert!(both.matches("\n10⁻²\n").count() == 2, "{both}");
    let svg = folder("sweep").join("drawn.svg");
    let arguments = ["sweep", &model("simple_pendulum"), "--vary", "theta=0..1:4", "--plot", svg.to_str().unwrap()];
    let error = program(&[&arguments[..], &table, &["--log", "z"]].concat()).unwrap_err();
    assert!(error.contains("--log wants x, y or x,y, not `z`"), "{error}");
}

#[cfg(feature = "png")]
#[test]
fn a_plot_may_be_a_pdf() {
    let path = folder("pdf").join("plot.pdf");
    program(&["simulate", &model("simple_pendulum"), "--no-digits", "--plot", path.to_str().unwrap()]).unwrap();
    assert!(std::fs::read(&path).unwrap().starts_with(b"%PDF-"));
    let error = program(&["simulate", &model("simple_pendulum"), "--plot", "plot.eps"]).unwrap_err();
    assert!(error.contains("`.svg`, `.png`, `.pdf`"), "{error}");
}

/// A pendulum that says how it moves, and not what to draw.
const UNDRAWN: &str = "name: Undrawn\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}\ncoordinates: {theta: rad}\n\
    bodies: {bob: {mass: m, position: \"l*[sin(theta), -cos(theta)]\"}}\ngravity: [0, -g]\n\
    scene: {start: {theta: 1}, until: 1}\n";

#[test]
fn an_animation_of_nothing_is_refused_with_what_to_write() {
    let folder = folder("undrawn");
    let [file, page] = ["undrawn.yaml", "page.html"].map(|name| folder.join(name));
    let [file, page] = [&file, &page].map(|path| path.to_str().unwrap());
    std::fs::write(file, UNDRAWN).unwrap();
    for command in ["simulate", "modes"] {
        let error = program(&[command, file, "--animate", page]).unwrap_err();
        assert!(error.contains("has no `draw`; write into the file, for its bodies, `draw: "), "{error}");
        assert!(!std::path::Path::new(page).exists());
        // What it says to write draws the bob.
        let advice = error.split('`').find(|part| part.starts_with("draw: ")).unwrap();
        std::fs::write(file, format!("{UNDRAWN}{advice}\n")).unwrap();
        program(&[command, file, "--animate", page]).unwrap();
        assert!(std::fs::read_to_string(page).unwrap().contains("circle"));
        std::fs::remove_file(page).unwrap();
        std::fs::write(file, UNDRAWN).unwrap();
    }
    // Curves alone are something to see.
    program(&["simulate", file, "--no-digits", "--show", "theta", "--animate", page]).unwrap();
    assert!(std::path::Path::new(page).exists());
}

/// The heights of the corners of each curve of a picture, as numbers of its text.
fn curves(svg: &str) -> Vec<Vec<f64>> {
    let parts = svg.split("points=\"").skip(1).filter_map(|part| part.split('"').next());
    parts.map(|points| points.split(' ').filter_map(|point| point.split(',').nth(1)?.parse().ok()).collect()).collect()
}

#[test]
fn pulses_between_reports_are_drawn() {
    let text =
        "name: Pulse\nparameters: {m: 1 kg, k: 1e6 N/m, g: 9.81 m/s^2, F: 100 N, a: 1.0007 s, b: 1.0012 s, s: 1 s}\n\
        coordinates: {y: m, x: m}\nbodies: {ball: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\n\
        forces: {floor: {on: ball, force: \"[F*step(t - a)*step(b - t), k*max(0, -y)]\"}}\n\
        outputs: {push: \"k*max(0, -y)\", kick: \"F*step(t - a)*step(b - t)\", slow: \"F*sin(2*t/s)\"}\n\
        scene: {start: {y: 1}, until: 3}\n"
            .replace("/(1 s)", "/s")
            .replace("b: 1.0012 s}", "b: 1.0012 s, s: 1 s}");
    let folder = folder("pulses");
    let (file, picture) = (folder.join("pulse.yaml"), folder.join("pulse.svg"));
    std::fs::write(&file, text).expect("a file");
    let [file, picture] = [&file, &picture].map(|path| path.to_str().expect("a path"));
    let shown = ["--show", "push", "--show", "kick", "--show", "slow"];
    program(&[&["simulate", file, "--no-digits", "--plot", picture], &shown[..]].concat()).unwrap();
    let svg = std::fs::read_to_string(picture).expect("a picture");
    let curves: Vec<Vec<f64>> = curves(&svg).into_iter().filter(|curve| curve.len() > 2).collect();
    assert_eq!(curves.len(), 3);
    let ways = |curve: &[f64]| {
        let range = curve.iter().fold(0.0_f64, |most, y| most.max((y - curve[0]).abs()));
        let high = |y: &f64| (y - curve[0]).abs() > 0.9 * range;
        curve.windows(2).filter(|pair| !high(&pair[0]) && high(&pair[1])).count()
    };
    // Three bounces of some ms, a kick of 0.5 ms; what is smooth has no more points than before.
    assert_eq!([ways(&curves[0]), ways(&curves[1])], [3, 1]);
    assert!(curves[2].len() <= 501, "{}", curves[2].len());
}

#[test]
fn runs_of_a_sweep_that_failed_are_counted_in_its_picture() {
    let text = "name: Sw\nparameters: {F: 1 N, m: 1 kg, k: 1}\ncoordinates: {x: m}\nkinetic_energy: m*x'^2/2\n\
        generalized_forces: {x: \"-F*k/sqrt(2.5 - k)\"}\nscene: {start: {x: 0.1}, until: 1}\n";
    let folder = folder("failed");
    let path = |name: &str| folder.join(name).to_str().expect("a path").to_owned();
    std::fs::write(path("sw.yaml"), text).expect("a file");
    let swept = |range: &str| {
        let (picture, table) = (path("sw.svg"), path("sw.csv"));
        let outcome = program(&["sweep", &path("sw.yaml"), "--vary", range, "--plot", &picture, "--csv", &table]);
        (outcome, std::fs::read_to_string(&picture).expect("a picture"))
    };
    let (outcome, svg) = swept("k=1..4:7");
    assert!(outcome.unwrap_err().contains("4 of 7 runs failed") && svg.contains("(4 of 7 runs failed)"));
    // Where they failed is no end of them: three points are left.
    let marks = |svg: &str| svg.matches("<circle").count();
    let (outcome, all) = swept("k=1..2:3");
    assert!(outcome.is_ok() && !all.contains("failed"));
    assert_eq!(marks(&svg), marks(&all));
}

/// A still is no film, of which is told how long it plays.
#[test]
fn an_svg_of_an_animation_is_a_still() {
    let path = folder("still").join("arm.svg");
    let arguments = ["simulate", &model("three_link_arm"), "--no-digits", "--until", "0.1", "--animate"];
    let told = program(&[&arguments[..], &[path.to_str().unwrap()]].concat()).unwrap();
    assert!(!told.contains("arm.svg"), "{told}");
    assert!(std::fs::read_to_string(&path).unwrap().starts_with("<svg"));
}
