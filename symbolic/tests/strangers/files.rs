//! Units, signs, tables, help of errors.

use std::path::{Path, PathBuf};

use super::{accepted, refused};
use dalembert_symbolic::lower::compile;
use dalembert_symbolic::model::{Sets, load, load_in, read_through_in};

const SPRING: &str = "name: T\nparameters: {m: 1 kg, k: 10 N/m}\nbodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
    springs: {s: {between: [ground, b], stiffness: k}}\n";

#[test]
fn a_coordinate_in_millimetres_does_not_start_at_metres() {
    for unit in ["mm", "km", "ft", "g", "deg", "min", "mrad"] {
        refused(&format!("{SPRING}coordinates: {{x: {unit}}}\nscene: {{start: {{x: 5}}}}"), "E314");
    }
    accepted(&format!("{SPRING}coordinates: {{x: m}}\nscene: {{start: {{x: 5 mm}}}}"));
    let model = load(&format!("{SPRING}coordinates: {{x: m}}\nscene: {{start: {{x: 5 mm}}}}"), &[]).unwrap();
    assert_eq!(model.graph.number(model.scenes[0].q[0]).unwrap().to_f64(), 0.005);
}

fn derived(value: &str) -> String {
    format!(
        "name: T\nparameters: {{m: 1 kg, l: 2 m, al: 30 deg, f: 5 Hz, I: {value}}}\ncoordinates: {{x: m}}\n\
         bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}"
    )
}

#[test]
fn a_unit_after_a_computed_value_does_not_drop_its_prefix() {
    for value in ["m*l^2/12 g*m^2", "2*al deg", "asin(0.5) deg", "l/2 mm", "2*pi*f rpm", "al/2 mrad"] {
        refused(&derived(value), "E246");
    }
    for value in
        ["m*l^2/12 kg*m^2", "2*al rad", "asin(0.5) rad", "180/pi*asin(0.5) deg", "360/7 deg", "5 mm", "2*pi*f rad/s"]
    {
        accepted(&derived(value));
    }
}

fn shaken(unit: &str, angle: &str) -> Vec<&'static str> {
    let text = format!(
        "name: T\nparameters: {{m: 1 kg, w: 5 {unit}, F0: 1 N}}\ncoordinates: {{x: m}}\ninputs: {{u: w*t}}\n\
         bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\nforces: {{f: {{on: b, force: \"[F0*cos({angle}), 0]\"}}}}"
    );
    load(&text, &[]).unwrap().warnings.iter().map(|warning| warning.code).collect()
}

#[test]
fn five_hertz_in_an_angle_are_not_silently_five_radians_a_second() {
    for (unit, angle) in [("Hz", "w*t"), ("kHz", "w*t + 0.3"), ("Hz", "3*w*t"), ("Hz", "u"), ("Hz", "-w*t")] {
        assert_eq!(shaken(unit, angle), ["W248"], "{unit} {angle}");
    }
    for (unit, angle) in [("Hz", "2*pi*w*t"), ("Hz", "6.28*w*t"), ("rad/s", "w*t"), ("rpm", "w*t"), ("1/s", "w*t")] {
        assert!(shaken(unit, angle).is_empty(), "{unit} {angle}");
    }
}

#[test]
fn hertz_are_not_taken_for_an_angular_velocity() {
    let disc = |start: &str, set: &str| {
        format!(
            "name: T\nparameters: {{w: 5 rad/s, f: 5 Hz}}\ncoordinates: {{th: rad}}\n\
             bodies: {{b: {{mass: 1, position: [0, 0], inertia: 1, angle: th}}}}\n\
             scene: {{start: {{th': {start}}}, set: {{{set}}}}}"
        )
    };
    refused(&disc("5 Hz", "w: 3"), "E247");
    refused(&disc("5", "w: 3 Hz"), "E247");
    refused(&disc("5", "f: 3 rad/s"), "E247");
    refused(&disc("5", "f: 30 rpm"), "E247");
    accepted(&disc("300 rpm", "w: 30 rpm"));
    accepted(&disc("2*pi*5 rad/s", "f: 3 kHz"));
}

#[test]
fn a_negative_mass_is_refused_though_another_hides_it() {
    let two = |m: &str, mass: &str, set: &str| {
        format!(
            "name: T\nparameters: {{m: {m}, M: 5 kg}}\ncoordinates: {{x: m}}\n\
             bodies: {{b: {{mass: {mass}, position: \"[x, 0]\"}}, c: {{mass: M, position: \"[x, 1]\"}}}}\n\
             scene: {{set: {{{set}}}}}"
        )
    };
    refused(&two("-1 kg", "m", ""), "a mass must be positive or 0, this is -1");
    refused(&two("1 kg", "m - M", ""), "this is -4");
    refused(&two("1 kg", "m", "m: -2 kg"), "this is -2");
    refused(&two("-1e-12 kg", "m", ""), "a mass must be positive");
    accepted(&two("1 kg", "m", ""));
    accepted(&two("0 kg", "m", ""));
    accepted(&two("-1 kg", "-m", ""));
    accepted(&two("-1 kg", "m^2/M", ""));
    let problems = load(&two("-1 kg", "m", ""), &[]).unwrap_err();
    assert!(format!("{:?}", problems[0].place).contains("parameters"), "{problems:?}");
    let mut model = load(&two("1 kg", "m", ""), &[]).unwrap();
    assert_eq!(model.constant("-1", Sets::Parameter(0), &[1.0, 5.0]).unwrap_err()[0].code, "E411");
    assert_eq!(model.constant("3", Sets::Parameter(0), &[1.0, 5.0]), Ok(3.0));
}

/// A folder of the target directory with one file of a table in it.
fn folder(name: &str, table: &[u8]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("road.csv"), table).unwrap();
    folder
}

fn read_table(folder: &Path, file: &str) -> String {
    let text = format!("{SPRING}coordinates: {{x: m}}\ntables: {{road: {{file: {file}, units: [m, m]}}}}");
    load_in(Some(folder), &text, &[]).err().map_or_else(String::new, |problems| problems[0].message.clone())
}

#[test]
fn decimal_commas_are_refused_with_the_reason() {
    for table in ["0,0\t0,0\n1,5\t2,5\n3,0\t4,5\n", "0,5;1\n1,5;2\n", "s;z\n0;0,5\n1;1,5\n"] {
        let told = read_table(&folder("commas", table.as_bytes()), "road.csv");
        assert!(told.contains("has a comma where a number has a point"), "{table}: {told}");
    }
    for table in ["0,0\n1,5\n", "0.0\t0.0\n1.5\t2.5\n", "0 1\n1\t-2.5\n", "s; z\n0; 1\n2; 1\n"] {
        assert_eq!(read_table(&folder("points", table.as_bytes()), "road.csv"), "", "{table}");
    }
    let mixed = read_table(&folder("mixed", b"0;1\n1,2\n"), "road.csv");
    assert!(mixed.contains("`1,2` in line 2 has a comma"), "{mixed}");
}

#[test]
fn a_byte_order_mark_is_no_part_of_a_table() {
    assert_eq!(read_table(&folder("mark", "\u{feff}0,1\n1,2\n".as_bytes()), "road.csv"), "");
    assert_eq!(read_table(&folder("mark2", "\u{feff}s,z\n0,1\n1,2\n".as_bytes()), "road.csv"), "");
}

#[test]
fn a_table_that_never_ends_is_not_read() {
    let told = read_table(Path::new("/"), "dev/zero");
    assert!(told.contains("no ordinary file"), "{told}");
    let long = folder("long", &b"0 1\n".repeat(3_000_000));
    let told = read_table(&long, "road.csv");
    assert!(told.contains("longer than 10 MB"), "{told}");
    let text = format!("{SPRING}coordinates: {{x: m}}\ntables: {{road: {{file: none.csv}}}}");
    assert_eq!(read_through_in(Some(&long), &text, &[]).1[0].code, "E319");
}

#[test]
fn a_rocket_s_thrust_may_be_a_force_or_what_it_loses() {
    let rocket = "name: T\nparameters: {m0: 10 kg, c: 1 kg/s, u: 100 m/s, g: 10 m/s^2}\ncoordinates: {y: m}\n";
    let body = format!("{rocket}bodies: {{b: {{mass: m0 - c*t, position: \"[0, y]\"}}}}");
    let weight =
        format!("{body}\ngravity: [0, -g]\nbalances: {{equations: [{{equation: \"(m0 - c*t)*(y'' + g) = c*u\"}}]}}\n");
    accepted(&format!("{weight}forces: {{thrust: {{on: b, force: \"[0, c*u]\"}}}}"));
    accepted(&weight.replace("[0, y]\"", "[0, y]\", loses: {velocity: \"[0, y' - u]\"}"));
    accepted(&format!(
        "{rocket}kinetic_energy: y'^2/2\ngeneralized_forces: {{y: (c*u)/(m0 - c*t) - g}}\nscene: {{until: 5}}"
    ));
}

/// The codes of the warnings of a file that is accepted.
fn warned(text: &str) -> Vec<&'static str> {
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
    program.model.warnings.iter().map(|warning| warning.code).collect()
}

/// A pendulum with this start, a parameter with this value, and that set by the scene.
fn swing(start: &str, angle: &str, set: &str) -> String {
    format!(
        "name: Swing\nparameters: {{m: 1 kg, l: 1 m, g: 9.81 m/s^2, alpha: {angle}}}\ncoordinates: {{theta: rad, x: m}}\n\
        bodies: {{bob: {{mass: m, position: \"[x + l*sin(theta + alpha), -l*cos(theta)]\"}}, cart: {{mass: m, position: \"[x, 0]\"}}}}\n\
        gravity: [0, -g]\nscene: {{start: {{{start}}}, set: {{{set}}}, until: 1}}\n"
    )
}

#[test]
fn angles_that_look_like_degrees_are_warned_of() {
    for start in ["theta: 90", "theta: -45", "theta: 360", "theta: 30.0"] {
        assert_eq!(warned(&swing(start, "0 rad", "")), ["W250"], "{start}");
    }
    assert_eq!(warned(&swing("", "0 rad", "alpha: 30")), ["W250"]);
    // Angles with a unit, small ones, those of turns, speeds, lengths and what is computed.
    let fine = ["theta: 90 rad", "theta: 90 deg", "theta: 3", "theta: 7.5", "theta: 100.5", "theta: 628", "theta: 12"];
    for start in fine.into_iter().chain(["theta': 90", "x: 90", "theta: 20*pi", "theta: 0"]) {
        assert_eq!(warned(&swing(start, "0 rad", "")), [""; 0], "{start}");
    }
}

#[test]
fn a_number_without_a_unit_switches_a_test_off_and_is_no_mistake() {
    for known in ["0.1", "0.1 1", "0.1 rad", "asin(0.1)", "acos(0.5)"] {
        assert_eq!(warned(&swing("", known, "")), [""; 0], "{known}");
    }
    // What depends on it is not checked, which `check` says; a pure number is.
    let sum = |n: &str| {
        format!(
            "name: Sum\nparameters: {{m: 1 kg, k: 1 N/m, n: {n}}}\ncoordinates: {{x: m}}\n\
            bodies: {{bob: {{mass: m, position: \"[x, 0]\"}}}}\npotential_energy: k*(x + n)^2/2\n"
        )
    };
    assert_eq!(warned(&sum("3.5")), [""; 0]);
    refused(&sum("3.5 1"), "E241");
}

/// A delay is answered with a state that is near it, and what is proposed is a file that is accepted.
#[test]
fn a_delay_is_answered_with_a_state() {
    let file = |force: &str, states: &str| {
        format!(
            "name: T\nparameters: {{m: 1 kg, k: 1 N/m, tau: 0.1 s}}\ncoordinates: {{x: m}}\n{states}\
             bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\nforces: {{f: {{on: b, force: \"[-k*({force}), 0]\"}}}}\n"
        )
    };
    for force in ["delay(x, tau)", "x(t - tau)"] {
        let problems = load(&file(force, ""), &[]).expect_err("an error");
        let help = &problems[0].help;
        assert!(help.contains("lag: {unit: …, rate: 2*(x - lag)/tau}") && help.contains("`2*lag - x`"), "{help}");
    }
    accepted(&file("2*lag - x", "states: {lag: {unit: m, rate: 2*(x - lag)/tau}}\n"));
}

/// A table that is straight between its points in all places from which it may enter the equations of motion: what the help of E320 says is
/// enough, and less is not.
#[test]
fn the_help_of_rough_tables_suffices() {
    let file = |smooth: u8, rest: &str| {
        format!(
            "name: T\ntables: {{ramp: {{points: [[0, 0], [1, 0.5], [1.5, 0.2], [3, 0.2]], smooth: {smooth}}}}}\n\
             coordinates: {{x: , y: }}\ninputs: {{u: ramp(t)}}\n{rest}"
        )
    };
    let plain = "kinetic_energy: x'^2/2 + y'^2/2";
    for (rest, enough) in [
        ("bodies: {b: {mass: 1, position: \"[x, y + ramp(x)]\"}}".to_owned(), 2),
        (format!("{plain}\ndissipation: (x' - u')^2/2"), 1),
        (format!("{plain}\npotential_energy: ramp(x)"), 1),
        (format!("{plain}\npotential_energy: (x - u)^2/2\ndissipation: (x' - u')^2/2"), 1),
        (format!("{plain}\nconstraints: {{c: y - ramp(x)}}"), 2),
        (format!("{plain}\nconstraints: {{c: y' - u}}"), 1),
    ] {
        let problems = compile(&file(0, &rest), &[]).expect_err(&rest);
        assert_eq!(problems[0].code, "E320", "{rest}: {problems:?}");
        assert_eq!(problems[0].help, format!("it is smooth enough with `smooth: {enough}`"), "{rest}");
        accepted(&file(enough, &rest));
        refused(&file(enough - 1, &rest), "E320");
    }
    // What acts by its place alone, or moves evenly but for the impulses of its turns.
    accepted(&file(0, &format!("{plain}\npotential_energy: (x - u)^2/2")));
    accepted(&file(0, "bodies: {b: {mass: 1, position: \"[u + x, y]\"}}"));
    accepted(&file(0, &format!("{plain}\nconstraints: {{c: y - u}}")));
}

#[test]
fn an_index_that_hides_a_family_is_named() {
    let file = |index: &str| {
        format!(
            "name: T\nparameters: {{k: 3 N/m}}\ncoordinates: {{\"x[i in 1..2]\": m}}\n\
             bodies: {{\"b[i in 1..2]\": {{mass: 1 kg, position: \"[x[i], 0]\"}}}}\n\
             springs: {{\"s[{index} in 1..2]\": {{stretch: \"x[{index}]\", stiffness: k}}}}"
        )
    };
    refused(&file("x"), "E204 the index `x` hides");
    accepted(&file("i"));
}
