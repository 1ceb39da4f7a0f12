//! What the program says for people: faults that writing the book found, each beside a neighbour that must be left alone.
#![cfg(all(feature = "cli", feature = "modal"))]

use std::sync::atomic::{AtomicUsize, Ordering};

/// What a command writes about the text of a model file, or its complaint.
fn says(command: &str, text: &str, options: &[&str]) -> Result<String, String> {
    static FILES: AtomicUsize = AtomicUsize::new(0);
    let of = (std::process::id(), FILES.fetch_add(1, Ordering::Relaxed));
    let path = std::env::temp_dir().join(format!("dalembert-reports-{}-{}.yaml", of.0, of.1));
    std::fs::write(&path, text).unwrap();
    let mut arguments = vec!["dalembert", command, path.to_str().unwrap()];
    arguments.extend(options);
    let mut out = Vec::new();
    let result = dalembert::cli::run(&[], arguments, &mut out);
    std::fs::remove_file(&path).unwrap();
    let written = String::from_utf8(out).unwrap();
    result.map(|()| written.clone()).map_err(|problem| format!("{written}{problem}"))
}

fn library(model: &str) -> String {
    std::fs::read_to_string(format!("{}/../models/{model}.yaml", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn contains(text: &str, parts: &[&str]) {
    parts.iter().for_each(|part| assert!(text.contains(part), "{part:?} is not in\n{text}"));
}

const SPRING: &str = "name: S\nparameters: {m: 1 kg, k: 5 N/m, l: 1 m}\ncoordinates: {x: m, y: m}\npoints: {O: [0, 0]}\n\
    bodies: {b: {mass: m, position: \"[x, y]\"}}\nsprings: {bungee: {between: [O, b], stiffness: k, rest: l}}\n\
    scene: {start: {x: 1.5}, until: 1}\n";

/// 1.5e8 steps are known to be more than 10⁷ before the first; an event that stops may come before.
#[test]
fn too_many_steps_are_told_before_the_first() {
    let text = library("simple_pendulum");
    let refused =
        says("simulate", &text, &["--method", "verlet", "--tolerance", "1e-12", "--until", "100"]).unwrap_err();
    contains(&refused, &["the tolerance wants steps of", "more than 10000000", "t = 0 s"]);
    assert!(says("simulate", &text, &["--method", "verlet", "--tolerance", "1e-4", "--until", "10"]).is_ok());
    let stopped = text + "\nevents: {low: {when: theta - 2.4, then: stop}}\n";
    let found = says(
        "simulate",
        &stopped,
        &["--method", "verlet", "--tolerance", "1e-6", "--max-steps", "50000", "--until", "1000"],
    );
    contains(&found.unwrap(), &["event low at t ="]);
}

/// Rates have primes, and products of units a sign.
#[test]
fn what_was_meant_is_what_is_proposed() {
    for (from, to, meant) in [
        ("start: {x: 1.5}", "start: {vx: 1}", "did you mean `x'`?"),
        ("start: {x: 1.5}", "start: {x_dot: 1}", "did you mean `x'`?"),
        ("k: 5 N/m", "k: 5 Nmm", "did you mean `N*mm`?"),
        ("springs:", "forces: {drag: {on: b, force: \"[-k*l*xdot, 0]\"}}\nsprings:", "did you mean `x'`?"),
        ("rest: l", "rest: ll", "did you mean `l`?"),
        ("springs:", "gravity: -g\nsprings:", "write its components in ground axes: `[0, -g]` along y"),
    ] {
        let text = SPRING.replace(from, to).replace("l: 1 m", "l: 1 m, g: 9.81 m/s^2");
        contains(&says("check", &text, &[]).unwrap_err(), &[meant]);
    }
    for option in ["vx=1", "xdot=1", "dx_dt=1"] {
        contains(&says("simulate", SPRING, &["--start", option]).unwrap_err(), &["did you mean `x'`?"]);
    }
    contains(&says("simulate", SPRING, &["--start", "z=1"]).unwrap_err(), &["it is one of `x`"]);
}

/// A torque is in N*m, an energy in J; and a model without units has neither seconds nor joules.
#[test]
fn torques_are_no_energies() {
    let text = "name: T\nparameters: {I: 2 kg*m^2, k: 3 N*m/rad, K: 0.1 N*m/A, a: 2 A}\ncoordinates: {q: rad}\ninputs: {u: 1 N*m}\n\
        kinetic_energy: I*q'^2/2\npotential_energy: k*q^2/2\ndefine: {motor: K*a}\ngeneralized_forces: {q: u + motor}\n\
        outputs: {spring: -k*q, stored: k*q^2/2, motor: motor, work: motor*q, whole: energy, input: u}\n\
        scene: {start: {q: 0.3}, until: 1}\n";
    let said = says("simulate", text, &[]).unwrap();
    for (name, unit) in
        [("spring", "N*m"), ("motor", "N*m"), ("input", "N*m"), ("stored", "J"), ("work", "J"), ("whole", "J")]
    {
        let line = said.lines().find(|line| line.starts_with(&format!("  {name} = "))).unwrap();
        assert!(line.ends_with(&format!(" {unit}")), "{line}");
    }
    let plain = "name: O\nparameters: {k: 4}\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\npotential_energy: k*x^2/2 + x^4\n\
        scene: {start: {x: 1}, until: 10}\n";
    let said = says("orbit", plain, &["--period", "2.4"]).unwrap();
    let period = said.lines().find(|line| line.starts_with("  period")).unwrap();
    assert!(!period.ends_with(" s") && !said.contains(" J\n"), "{said}");
}

/// A force by an input and the same by a definition are one motion, and one method.
#[test]
fn an_input_and_its_definition_have_one_method() {
    let text = "name: C\nparameters: {m: 1 kg, k: 30 N/m, w: 3 rad/s, F: 0.1 N}\ncoordinates: {x: m}\ninputs: {u: F*cos(w*t)}\n\
        kinetic_energy: m*x'^2/2\npotential_energy: k*x^2/2\ngeneralized_forces: {x: u}\nscene: {start: {x: 0.3}, until: 10}\n";
    let by = |text: &str| {
        let said = says("simulate", text, &[]).unwrap();
        said.lines()
            .filter(|line| line.starts_with("method") || line.starts_with("work"))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    for until in ["until: 3", "until: 10", "until: 100"] {
        let text = text.replace("until: 10", until);
        assert_eq!(by(&text), by(&text.replace("inputs:", "define:")), "{until}");
    }
}

/// What never began is not reported on; what went on for a while is.
#[test]
fn a_start_that_fails_is_told_by_its_error_alone() {
    let pendulum = library("pendulum_cartesian");
    let refused = says("simulate", &pendulum, &["--start", "x=5", "--start", "y=5"]).unwrap_err();
    assert!(refused.starts_with("error: inconsistent start"), "{refused}");
    let refused = says("simulate", &library("simple_pendulum"), &["--tolerance", "1e-20"]).unwrap_err();
    assert!(refused.starts_with("error: tolerance too tight: 1e-20 is far below rounding"), "{refused}");
    assert!(!refused.contains("was used"));
    let said = says("simulate", &library("simple_pendulum"), &["--tolerance", "1e-15"]).unwrap();
    contains(&said, &["1e-15 is below rounding; 1e-14 was used"]);
    let long = says("simulate", SPRING, &["--max-steps", "3", "--until", "100"]).unwrap_err();
    contains(&long, &["work           3 steps", "error: more than 3 steps"]);
}

/// A spring whose ends meet where a run begins, or small motions are looked at, is named.
#[test]
fn a_spring_of_length_zero_is_named() {
    let text = SPRING.replace("x: 1.5", "x: 0");
    contains(&says("simulate", &text, &[]).unwrap_err(), &["in `bungee` becomes zero at t = 0 s"]);
    contains(&says("modes", &text, &[]).unwrap_err(), &["in `bungee` is zero"]);
    assert!(
        says("simulate", &text, &["--set", "l=0", "--set", "k=0"]).is_err() || says("simulate", SPRING, &[]).is_ok()
    );
}

/// Of a coupled mass matrix parts of the energy may be negative; their sizes are told, all together 100 %.
#[test]
fn participation_is_a_share() {
    let said = says("modes", &library("string_ritz"), &["--size", "n=3"]).unwrap();
    let lines: Vec<&str> =
        said.lines().filter_map(|line| line.split_once("participation: ")).map(|(_, list)| list).collect();
    assert_eq!(lines.len(), 3);
    for list in lines {
        let parts = list.split(", ").map(|part| part.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap());
        let sum: f64 = parts.sum();
        assert!((98.0..=101.0).contains(&sum), "{list}");
    }
}

/// All coordinates end at 0, outputs do not; and a run of no length loses no digits.
#[test]
fn digits_are_told_where_coordinates_end_at_zero() {
    let said = says("simulate", &library("astronaut"), &["--scene", "one_joint"]).unwrap();
    contains(&said, &["\ndigits         "]);
    let said = says("simulate", &library("braking_car"), &["--until", "0"]).unwrap();
    assert!(!said.contains('?'), "{said}");
    // A file may say so, too.
    contains(&says("simulate", &SPRING.replace("until: 1", "until: 0"), &[]).unwrap(), &["at t = 0"]);
    contains(&says("check", &SPRING.replace("until: 1", "until: -1"), &[]).unwrap_err(), &["E411", "no less than 0"]);
}

/// 22 bounces and 23 impulses are counted, and are all there in JSON; three events are listed.
#[test]
fn many_events_are_counted() {
    let ball = library("bouncing_ball");
    let said = says("simulate", &ball, &[]).unwrap();
    contains(&said, &["  event bounce 22 times, at t = 0.4515", "more impulses from t = "]);
    assert!(said.lines().count() < 25, "{said}");
    let all: serde_json::Value = serde_json::from_str(&says("simulate", &ball, &["--json"]).unwrap()).unwrap();
    assert_eq!(all["events"].as_array().unwrap().len(), 22);
    let said = says("simulate", &ball, &["--until", "1.2"]).unwrap();
    assert_eq!(said.matches("  event bounce at t = ").count(), 3, "{said}");
}

/// Two paths in one chart.
#[test]
fn portraits_are_split_at_commas() {
    let path = std::env::temp_dir().join(format!("dalembert-reports-{}.svg", std::process::id()));
    let file = path.to_str().unwrap();
    let three = library("figure_eight");
    says("simulate", &three, &["--show", "x[1]:y[1],x[2]:y[2]", "--plot", file]).unwrap();
    let picture = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    contains(&picture, &["y[1] over x[1]", "y[2] over x[2]"]);
    let refused = says("simulate", &three, &["--show", "x[1]:y[1],x[2]", "--plot", file]).unwrap_err();
    contains(&refused, &["stands beside portraits"]);
}

/// Dashed curves and straight pieces take little room.
#[test]
fn pictures_of_modes_are_small() {
    let path = std::env::temp_dir().join(format!("dalembert-reports-modes-{}.svg", std::process::id()));
    for (option, most) in [("--plot", 40_000), ("--motion", 100_000)] {
        says("modes", &library("damped_chain"), &[option, path.to_str().unwrap()]).unwrap();
        let size = std::fs::metadata(&path).unwrap().len();
        assert!(size < most, "{option}: {size}");
    }
    std::fs::remove_file(&path).unwrap();
}

/// A parameter that only what went reads goes with it; one that the author left unused stays.
#[test]
fn the_smaller_file_has_no_idle_parameters() {
    let text = "name: N\nparameters: {m: 1 kg, k: 50 N/m, tiny: 1e-9 N, deep: 2 m, spare: 3 m}\ncoordinates: {x: m}\n\
        bodies: {b: {mass: m, position: \"[x, 0]\"}}\npoints: {O: [0, 0]}\n\
        springs: {s: {stretch: x, stiffness: k, on: b, along: \"[1, 0]\"}}\n\
        forces: {d: {on: b, force: \"[-tiny*(x/deep)^3*exp(x/deep), 0]\"}}\n\
        scene:\n  start: {x: 0.3}\n  until: 2\n  needs: {outputs: [x], within: 1e-3}\n";
    let path = std::env::temp_dir().join(format!("dalembert-reports-{}-smaller.yaml", std::process::id()));
    says("needs", text, &["--write", path.to_str().unwrap()]).unwrap();
    let smaller = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    let test = path.to_str().unwrap().replace(".yaml", "_test.rs");
    std::fs::remove_file(test).unwrap();
    let parameters = smaller.lines().find(|line| line.starts_with("parameters")).unwrap();
    assert_eq!(parameters, "parameters: {m: 1 kg, k: 50 N/m, spare: 3 m}", "{smaller}");
}
