//! Units of values on the command line.

use super::{folder, program};

/// A cart on a spring and a disc on another, turned by an input; what a tick holds pushes the cart.
const HELD: &str = "name: Held\nparameters: {m: 1 kg, k: 4 N/m, U: 0 N*m, J: 1 kg*m^2, kt: 2 N*m}\n\
    coordinates: {x: m, phi: rad}\nmemory: {h: 0 N}\ninputs: {u: U}\n\
    bodies: {b: {mass: m, position: \"[x, 0]\", inertia: J, angle: phi}}\n\
    potential_energy: k*x^2/2 + kt*phi^2/2\nforces: {push: {on: b, force: \"[h, 0]\"}}\n\
    generalized_forces: {phi: u}\nevents: {tick: {every: 1 s, then: {set: {h: h}}}}\nscene: {start: {x: 0.1}, until: 1}\n";

/// The same without anything that acts from outside.
const FREE: &str = "name: Free\nparameters: {m: 1 kg, k: 4 N/m, J: 1 kg*m^2, kt: 2 N*m}\n\
    coordinates: {x: m, phi: rad}\nbodies: {b: {mass: m, position: \"[x, 0]\", inertia: J, angle: phi}}\n\
    potential_energy: k*x^2/2 + kt*phi^2/2\noutputs: {pull: k*x}\nscene: {start: {x: 0.1}, until: 1}\n";

/// What the program prints of one of these, or what it says is wrong.
fn told(text: &str, command: &str, arguments: &[&str]) -> Result<String, String> {
    let place = folder("units").join(format!("{command}-{}.yaml", arguments.concat().replace(['/', '*', ' '], "_")));
    std::fs::write(&place, text).expect("a file");
    program(&[&[command, place.to_str().expect("a path")], arguments].concat())
}

#[test]
fn units_of_options_are_those_of_what_is_set() {
    let refused = |text: &str, command: &str, arguments: &[&str], wanted: &str| {
        let error = told(text, command, arguments).unwrap_err();
        let expected = format!("`5 kg` is a mass (kg), but {wanted}");
        assert!(error.contains(&expected) && error.contains("a number alone"), "{arguments:?}: {error}");
    };
    refused(HELD, "simulate", &["--input", "u=5 kg"], "this input is in J");
    refused(HELD, "simulate", &["--start", "h=5 kg"], "this held value is in N");
    refused(HELD, "modes", &["--input", "u=5 kg"], "this input is in J");
    refused(HELD, "modes", &["--at", "h=5 kg"], "this held value is in N");
    refused(HELD, "modes", &["--omega=1", "--drive", "u=5 kg"], "this input is in J");
    refused(HELD, "modes", &["--omega=1", "--drive", "x=5 kg"], "a force on this coordinate is in N");
    refused(HELD, "modes", &["--omega=1", "--drive", "phi=5 kg"], "a force on this coordinate is in J");
    refused(HELD, "modes", &["--omega=1", "--drive", "push=5 kg"], "a force is in N");
    refused(HELD, "modes", &["--hold=phi=0.1", "--solve", "u=5 kg"], "this input is in J");
    refused(HELD, "modes", &["--hold=x=0.1", "--solve", "h=5 kg"], "this held value is in N");
    refused(FREE, "orbit", &["--from=mode 1", "--energy", "5 kg"], "an energy is in J");
    refused(FREE, "orbit", &["--from=mode 1", "--amplitude", "5 kg"], "this coordinate is a pure number");
    refused(FREE, "orbit", &["--from=mode 2", "--amplitude", "5 kg"], "this coordinate is in m");
    refused(FREE, "solve", &["--unknown=x=0.1", "--such-that", "pull=5 kg"], "this output is in N");
}

#[test]
fn units_of_options_are_converted() {
    let alike = |text: &str, command: &str, option: &str, [with, without]: [&str; 2]| {
        let others: &[&str] = match command {
            "modes" => &["--omega=1", "--json"],
            "orbit" => &["--from=mode 1", "--json"],
            _ => &["--json", "--no-digits"],
        };
        let found = [with, without].map(|value| told(text, command, &[others, &[option, value]].concat()).unwrap());
        // Models go by their file's name.
        let [with, without] =
            found.map(|text| text.lines().filter(|line| !line.contains("\"model\"")).collect::<String>());
        assert_eq!(with, without, "{option}");
    };
    alike(HELD, "simulate", "--input", ["u=5 N*mm", "u=5e-3"]);
    alike(HELD, "simulate", "--input", ["u=U*cos(3*t)", "u=0*cos(3*t)"]);
    alike(HELD, "simulate", "--start", ["h=5 kN", "h=5e3"]);
    alike(HELD, "modes", "--drive", ["u=5 N*mm", "u=5e-3"]);
    alike(HELD, "modes", "--drive", ["push=5 kN", "push=5e3"]);
    alike(FREE, "orbit", "--energy", ["2 mJ", "2e-3"]);
    alike(FREE, "orbit", "--amplitude", ["9 deg", "pi/20"]);
    // What has no unit is of any.
    let unknown = HELD.replace("u: U", "u: 0");
    alike(&unknown, "simulate", "--input", ["u=5 mN", "u=5e-3"]);
}

/// A free body and an angle, started so.
fn turning(start: &str) -> String {
    format!(
        "name: Turning\nparameters: {{m: 2 kg, w: 2 rad/s}}\ncoordinates: {{q: rotation, al: rad}}\n\
         frames: {{A: {{rotate: q}}, F: {{from: A, rotate: [x, al]}}}}\n\
         bodies:\n  b: {{mass: m, inertia: [0.3, 0.5, 0.6], frame: A, position: [0, 0, 0]}}\n  \
         c: {{mass: m, inertia: [0.3, 0.5, 0.6], frame: F, position: [0, 0, 0]}}\nscene: {{{start}, until: 0}}\n"
    )
}

/// Lists that start a rotation have units as everything has.
#[test]
fn units_of_a_start_of_a_rotation_are_checked() {
    for (start, code) in [
        ("start: {q': [1 Hz, 2 rpm, 3]}", "E247"),
        ("start: {q': [1, 2, 3 deg]}", "E242"),
        ("start: {q': [3 m, 2, 1]}", "E242"),
        ("start: {q': {ground: [1 Hz, 0, 0]}}", "E247"),
        ("start: {q: [[z, 1], [x, 2]], q': {angles: [3 Hz, 2]}}", "E247"),
        ("start: {q: [[z, 1], [x, 2]], q': {angles: [3, 2 deg]}}", "E242"),
        ("start: {q: {vector: [0, 0, 3 kg]}}", "E242"),
        ("start: {q: {quaternion: [0, 0, 3 kg, 1]}}", "E242"),
        ("start: {q: [z, 3 kg]}", "E242"),
    ] {
        let error = told(&turning(start), "simulate", &[]).unwrap_err();
        assert!(error.contains(code), "{start}: {error}");
    }
    let alike = "start: {q: {vector: [0, 0, 30 deg]}, q': [12 deg/s, 2 rpm, w]}";
    told(&turning(alike), "simulate", &[]).unwrap_or_else(|error| panic!("{error}"));
}

/// Angles that look like degrees are warned of wherever an angle is set.
#[test]
fn angles_of_a_start_that_look_like_degrees_are_warned_of() {
    for start in [
        "start: {al: 90}",
        "start: {q: [z, 90]}",
        "start: {q: [[z, 0.3], [x, 45]]}",
        "start: {q: {vector: [0, 0, 90]}}",
        "equilibrium: {q: [z, 90]}",
        "equilibrium: {al: 90}",
    ] {
        let (scene, equilibrium) = if start.starts_with("start") { (start, "") } else { ("start: {al: 0}", start) };
        let program = dalembert_symbolic::lower::compile(&format!("{}{equilibrium}\n", turning(scene)), &[]);
        let program = program.unwrap_or_else(|problems| panic!("{start}: {problems:?}"));
        let warned = program.model.warnings.iter().filter(|warning| warning.code == "W250").count();
        assert_eq!(warned, 1, "{start}");
    }
}
