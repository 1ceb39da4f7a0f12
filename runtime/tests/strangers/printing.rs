//! Equations for people, symbolic linearisation.

use dalembert::linear::{Guess, equilibrium_here, linearise};
use dalembert::mechanism::System;
use dalembert_symbolic::lower::compile;
use dalembert_symbolic::model::Sets;
use dalembert_symbolic::print::{Linearisation, NotLinear};

use super::{case, folder, program};

/// What `show` prints of a model of the library.
fn shown(name: &str, arguments: &[&str]) -> Result<String, String> {
    let path = format!("{}/../models/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
    program(&[&["show", &path], arguments].concat())
}

/// A spring whose rest length is not the distance, a damper, an input, a pendulum on it.
const DRIVEN: &str = "name: Driven\nparameters: {m: 2 kg, mu: 0.5 kg, k: 30 N/m, c: 0.7 N*s/m, l: 0.4 m, b: 0 N*s*m, g: 9.81 m/s^2}\n\
    coordinates: {x: m, theta: rad}\ninputs: {u: 0 N, w: 0 m}\n\
    bodies:\n  cart: {mass: m, position: \"[0, -x]\"}\n  bob: {mass: mu, position: \"[l*sin(theta), -x - l*cos(theta)]\"}\n\
    gravity: [0, -g]\npotential_energy: k*(x - w)^2/2\n\
    generalized_forces: {x: u - c*x'*(1 + (x/l)^2), theta: u*l*sin(theta) - b*theta'}\n\
    equilibrium: {x: (m + mu)*g/k, theta: pi}\nscene: {until: 1}\n";

#[test]
fn matrices_of_small_motions_are_those_of_a_textbook() {
    let bead = shown("bead_parabola", &["--linear"]).unwrap();
    assert!(bead.ends_with("M = [[m]]\nK = [[2*c*m*g]]\nomega^2 = K/M = 2*c*g\n"), "{bead}");
    let cylinder = shown("rolling_cylinder", &["--linear"]).unwrap();
    assert!(cylinder.ends_with("omega^2 = K/M = 2/3*g/(R - r)\n"), "{cylinder}");
    let pendulum = shown("double_pendulum_points", &["--linear"]).unwrap();
    let expected = "M = [[2*m*l^2, m*l^2],\n     [m*l^2,   m*l^2]]\nK = [[2*m*l*g, 0],\n     [0,       m*l*g]]\n";
    assert!(pendulum.ends_with(expected), "{pendulum}");
    let cart = shown("cart_pendulum", &["--linear"]).unwrap();
    // A parameter is called M there, and a coordinate x.
    let expected = "M_ = [[m + M, m*l],\n      [m*l,   m*l^2]]\nK = [[0, 0],\n     [0, m*l*g]]\n";
    assert!(cart.ends_with(expected), "{cart}");
    let upright = shown("cart_pendulum", &["--linear", "--at", "theta=pi"]).unwrap();
    assert!(upright.contains("[0, -m*l*g]]"), "{upright}");
    let latex = shown("cart_pendulum", &["--linear", "--latex"]).unwrap();
    assert!(latex.contains(r"\mathbf{K} &= \begin{pmatrix} 0 & 0 \\ 0 & m \, l \, g \end{pmatrix}"), "{latex}");
}

/// The formulas, read again as expressions with other values of the parameters, are what `modes` computes.
#[test]
fn matrices_of_formulas_are_those_that_modes_computes() {
    let derived = compile(DRIVEN, &[]).unwrap();
    let mut model = derived.model.clone();
    let place = model.equilibrium.clone().expect("a guess");
    let text = Linearisation::about(&derived, &mut model, &place).unwrap().text(&model);
    let mut system = case(DRIVEN).system;
    let parameters = [1.3, 0.9, 21.0, 0.3, 0.25, 0.11, 3.7];
    parameters.iter().enumerate().for_each(|(k, value)| system.set_parameter(k, *value));
    let q = vec![(1.3 + 0.9) * 3.7 / 21.0, std::f64::consts::PI];
    let guess = Guess { q, v: vec![0.0; 2], inputs: vec![0.0; 2] };
    let numbers = linearise(&system, &equilibrium_here(&system, &guess).unwrap()).unwrap();
    assert!(text.contains("u_ = [u, w]"), "{text}");
    let inputs = numbers.input.to_dense();
    for (name, matrix) in [("M", numbers.m()), ("C", numbers.c()), ("K", numbers.k())] {
        for (i, row) in rows(&text, name).iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                let value = model.constant(entry, Sets::Any, &parameters).unwrap();
                assert!((value - matrix[(i, j)]).abs() <= 1e-12 * matrix.amax(), "{name}[{i}, {j}] = {entry}");
            }
        }
    }
    for (i, row) in rows(&text, "B").iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            let value = model.constant(entry, Sets::Any, &parameters).unwrap();
            assert!((value - inputs[(i, 3 * j)]).abs() <= 1e-12 * inputs.amax(), "B[{i}, {j}] = {entry}");
        }
    }
    // A damping that is 0 by default is a parameter all the same.
    assert_eq!(rows(&text, "C")[1][1], "b");
}

/// The entries of a matrix that is printed.
fn rows(text: &str, name: &str) -> Vec<Vec<String>> {
    let (_, rest) = text.split_once(&format!("{name} = [[")).unwrap_or_else(|| panic!("no {name} in {text}"));
    let (inside, _) = rest.split_once("]]").expect("an end");
    inside
        .split("],")
        .map(|row| row.trim().trim_start_matches('[').split(", ").map(|x| x.trim().to_owned()).collect())
        .collect()
}

#[test]
fn what_is_no_equilibrium_is_refused_with_its_force() {
    let error = shown("cart_pendulum", &["--linear", "--at", "theta=pi/2"]).unwrap_err();
    assert!(error.contains("the force on theta: -m*l*g\n"), "{error}");
    // The masses are in one place, where their attraction has no value.
    let error = shown("two_body", &["--linear"]).unwrap_err();
    assert!(error.contains("not defined at this place"), "{error}");
    let error = shown("four_bar", &["--linear"]).unwrap_err();
    assert!(error.contains("constraints") && error.contains("`modes`"), "{error}");
    let error = shown("cart_pendulum", &["--linear", "--at", "theta=x/l"]).unwrap_err();
    assert!(error.contains("an expression of parameters"), "{error}");
}

#[test]
fn kinks_have_matrices_beside_them_only() {
    let text = |force: &str| {
        format!(
            "name: K\nparameters: {{m: 1 kg, k: 2 N/m, a: 1 m}}\ncoordinates: {{x: m}}\nkinetic_energy: m*x'^2/2\n\
            generalized_forces: {{x: \"{force}\"}}\nscene: {{until: 1}}\n"
        )
    };
    let found = |force: &str| {
        let derived = compile(&text(force), &[]).unwrap();
        let mut model = derived.model.clone();
        let place = model.unsaid_place();
        Linearisation::about(&derived, &mut model, &place).map(|linear| linear.text(&model))
    };
    assert_eq!(found("-k*max(x, 0)"), Err(NotLinear::Kink));
    assert_eq!(found("-k*x*sin(t*sqrt(k/m))"), Err(NotLinear::Time));
    let beside = found("-k*x - k*max(x - a, 0)*2").unwrap();
    assert!(beside.contains("K = [[k"), "{beside}");
}

#[test]
fn dots_stand_over_letters_not_over_indices() {
    let latex = shown("double_pendulum", &["--latex"]).unwrap();
    assert!(latex.contains(r"\dot{\theta}_{2}") && !latex.contains(r"\dot{\theta_"), "{latex}");
}

#[test]
fn equations_of_motion_stand_one_a_coordinate() {
    let text = shown("simple_pendulum", &[]).unwrap();
    let (_, rest) = text.split_once("equations of motion\n").unwrap_or_else(|| panic!("{text}"));
    let line = rest.lines().next().unwrap();
    assert!(line.contains("theta''") && line.contains("sin(theta)") && line.ends_with(" = 0"), "{text}");
    let text = shown("double_pendulum", &[]).unwrap();
    assert_eq!(text.lines().filter(|line| line.ends_with(" = 0")).count(), 2, "{text}");
    let latex = shown("double_pendulum", &["--latex"]).unwrap();
    assert!(latex.contains(r"\ddot{\theta}_{1}"), "{latex}");
    // Equations of a page's length are given by their parts.
    assert!(!shown("chain", &[]).unwrap().contains("equations of motion"));
}

#[test]
fn an_output_that_is_nowhere_in_flight_had_no_digits_at_rest() {
    let mut ball = case(
        "name: Plastic
parameters: {m: 1 kg, g: 9.81 m/s^2, e: 0 1}
coordinates: {y: m}
bodies: {ball: {mass: m, position: \"[0, y]\"}}
gravity: [0, -g]
constraints: {floor: y}
phases: {flight: [], resting: [floor]}
events: {land: {phase: flight, when: y, direction: falling, then: {impact: e, along: floor}}}
outputs: {normal: reaction(floor), ratio: 1/reaction(floor)}
scene: {start: {y: 1}, until: 1, tolerance: 1e-10}",
    );
    ball.settings.digits = true;
    let run = ball.run();
    for name in ["normal", "ratio"] {
        assert!(run.digits(name).is_some_and(|digits| digits >= 9), "{name}: {:?}", run.digits(name));
    }
}

/// Several columns are weighed by their ranges, in parts of which the standard deviation is; that of one has its unit.
#[test]
fn a_standard_deviation_stood_without_its_scale() {
    let folder = folder("fit");
    let model = folder.join("swing.yaml");
    let text = "name: Swing\nparameters: {k: 4 N/m, m: 1 kg}\ncoordinates: {x: m}\nkinetic_energy: m*x'^2/2\n\
        potential_energy: k*x^2/2\nscene: {start: {x: 1 m}, until: 3}\n";
    std::fs::write(&model, text).expect("a file");
    // cos 2t and its rate, each off by a thousandth of its range, 2 m and 4 m/s, up and down in turn.
    let table = |columns: &str, rate: bool| {
        let row = |k: u32| {
            let (t, off) = (0.05 * f64::from(k), if k.is_multiple_of(2) { 1e-3 } else { -1e-3 });
            let mut row = format!("{t},{}", (2.0 * t).cos() + 2.0 * off);
            if rate {
                row += &format!(",{}", -2.0 * (2.0 * t).sin() + 4.0 * off);
            }
            row + "\n"
        };
        let path = folder.join(if rate { "two.csv" } else { "one.csv" });
        std::fs::write(&path, format!("{columns}\n{}", (1..60).map(row).collect::<String>())).expect("a file");
        path
    };
    let told = |path: std::path::PathBuf| {
        let [model, path] = [&model, &path].map(|path| path.to_str().expect("a path"));
        program(&["solve", model, "--fit", path, "--unknown", "k=3.9"]).expect("a fit")
    };
    let line = |told: &str| {
        let line = told.lines().find_map(|line| line.strip_prefix("residuals      standard deviation "));
        line.unwrap_or_else(|| panic!("{told}")).to_owned()
    };
    let (one, two) = (line(&told(table("t,x", false))), line(&told(table("t,x,x'", true))));
    assert!(one.starts_with("0.0020") && one.contains(" m, 58 degrees"), "{one}");
    assert!(two.starts_with("0.00100") && two.contains(" of each column's range, 117 degrees"), "{two}");
}

/// Bare numbers of masses, inertias and gravity are in SI; in the formulas of equations that are made linear they stood as pure numbers.
#[test]
fn bare_inertias_kept_equations_from_being_made_linear() {
    let file = folder("needs").join("pendulum.yaml");
    let pendulum = "name: Pendulum\nparameters: {l: 1 m, e: 0.1 m}\ncoordinates: {th: rad}\npoints: {P: \"l*[sin(th), 0, -cos(th)]\"}\n\
        frames: {B: {rotate: [y, -th]}}\nbodies: {bob: {mass: 1, inertia: [0.01, 0.01, 0.002], frame: B, position: P - e*B.z}}\n\
        gravity: [0, 0, -9.81]\noutputs: {X: P.x}\nscene: {start: {th: 0.01}, until: 2, tolerance: 1e-9, needs: {outputs: [X], within: 1e-2}}\n";
    let pure = "name: Pure\nparameters: {k: 4}\ncoordinates: {x: 1}\nbodies: {p: {mass: 2, position: \"[x, 0]\"}}\n\
        potential_energy: k*(1 - cos(x))\nscene: {start: {x: 0.01}, until: 2, tolerance: 1e-9, needs: {outputs: [x], within: 1e-2}}\n";
    // With units in lists they stood so, too; in a model of pure numbers there is nothing to add.
    let written = pendulum
        .replace("mass: 1,", "mass: 1 kg,")
        .replace("[0.01, 0.01, 0.002]", "[0.01 kg*m^2, 0.01 kg*m^2, 0.002 kg*m^2]");
    let all = "it does with equations linear";
    for (text, wanted) in [(pendulum, all), (&written, all), (pure, "it does with potential_energy linear")] {
        std::fs::write(&file, text).expect("a file");
        let told = program(&["needs", file.to_str().expect("a path")]).unwrap_or_else(|error| panic!("{error}"));
        assert!(told.contains(wanted), "{text}{told}");
    }
}

/// What the program prints of a model's text.
fn of_text(name: &str, text: &str, command: &str, arguments: &[&str]) -> Result<String, String> {
    let place = folder(name).join("model.yaml");
    std::fs::write(&place, text).expect("a file");
    program(&[&[command, place.to_str().expect("a path")], arguments].concat())
}

#[test]
fn largest_answers_have_the_digits_that_are_printed() {
    let oscillator = "name: O\nparameters: {m: 1 kg, k: 1 N/m, z: 0.1}\ncoordinates: {x: m}\nkinetic_energy: m*x'^2/2\n\
        potential_energy: k*x^2/2\ngeneralized_forces: {x: -2*z*x'}\nscene: {until: 1}\n";
    let largest = |zeta: f64| {
        let set = format!("z={zeta}");
        let text = of_text("peaks", oscillator, "modes", &["--drive=x", "--range=0.05..5", "--set", &set]).unwrap();
        let line =
            text.lines().find(|line| line.starts_with("  x: ") && line.contains("rad/s")).expect("a line").to_owned();
        let mut numbers = line.split(' ').filter_map(|word| word.parse::<f64>().ok());
        [numbers.next().expect("a size"), numbers.next().expect("a frequency")]
    };
    for zeta in [1.23e-9, 3.3e-6, 0.00123, 0.0456, 0.3, 0.7] {
        let [size, omega] = largest(zeta);
        // Of 6 digits each.
        let exact = [0.5 / (zeta * (1.0 - zeta * zeta).sqrt()), (1.0 - 2.0 * zeta * zeta).sqrt()];
        for (found, exact) in [(size, exact[0]), (omega, exact[1])] {
            assert!((found / exact - 1.0).abs() <= 5e-6, "{zeta}: {found}, {exact}");
        }
    }
    // Without a peak it is largest where the range begins.
    let [size, omega] = largest(1.0);
    assert_eq!((omega, size), (0.05, (1e6 / (1.0 + 0.05 * 0.05_f64)).round() / 1e6));
    // What is as large everywhere has no place.
    let text = oscillator.replace("scene:", "outputs: {f: \"x'' + 2*z*x' + k*x\"}\nscene:");
    let text = of_text("peaks", &text, "modes", &["--drive=x", "--response=f"]).unwrap();
    assert!(text.contains("  f: 1 1/N at all frequencies"), "{text}");
}

#[test]
fn reduced_equations_are_printed_in_full() {
    let path = format!("{}/../models/satellite.yaml", env!("CARGO_MANIFEST_DIR"));
    let text = program(&["check", &path, "--routh"]).unwrap();
    assert!(text.contains("    where\n      s1 = ") && !text.contains('…'), "{text}");
    // Short ones stay in one line each.
    let path = format!("{}/../models/two_body.yaml", env!("CARGO_MANIFEST_DIR"));
    let text = program(&["check", &path, "--routh"]).unwrap();
    assert!(text.contains("goes with its momentum") && !text.contains("    where\n"), "{text}");
}

#[test]
fn a_command_that_is_misspelt_is_proposed_after_help_too() {
    for line in [&["simulat", "x"][..], &["help", "simulat"]] {
        let error = program(line).unwrap_err();
        assert!(error.contains("a similar subcommand exists: 'simulate'"), "{error}");
    }
    assert!(!program(&["help", "xyzzy"]).unwrap_err().contains("similar"));
}

/// Terms of two turns that undo each other cancel: an empty sum was printed, which no program can run.
#[test]
fn sums_whose_terms_cancel_are_zero() {
    let text = "name: Turns\nparameters: {m: 1 kg, c: 0.2 m, d: 0.3 m, e: 0.4 m}\ncoordinates: {p: rad, q: rad}\n\
        frames: {A: {rotate: [x, p]}, B: {from: A, rotate: [[y, 1], [x, 0.5], [x, q]]}}\n\
        bodies: {b: {mass: m, inertia: [1, 1, 1], frame: B, position: c*B.x + d*B.y + e*B.z}}\n";
    let path = folder("turns").join("turns.yaml");
    std::fs::write(&path, text).expect("a file");
    for form in ["--python", "--latex", "--c"] {
        let told = program(&["show", path.to_str().expect("a path"), form]).expect("equations");
        assert!(!told.contains("*()") && !told.contains("\\left(\\right)"), "{told}");
    }
}

#[test]
fn names_with_two_indices_stand_in_lists() {
    let folder = folder("two-indices");
    let (path, table) = (folder.join("grid.yaml"), folder.join("grid.csv"));
    let text = "name: Grid\nparameters: {m: 1 kg, \"k[i in 1..2, j in 1..2]\": 3 N/m}\ncoordinates: {\"x[i in 1..2, j in 1..2]\": m}\n\
                bodies: {\"b[i in 1..2, j in 1..2]\": {mass: m, position: \"[x[i,j], 0]\"}}\n\
                springs: {\"s[i in 1..2, j in 1..2]\": {stretch: \"x[i,j]\", stiffness: \"k[i,j]\"}}\n\
                scene: {start: {\"x[1,1]\": 1}, until: 1}\n";
    std::fs::write(&path, text).expect("a file");
    let [path, table] = [&path, &table].map(|path| path.to_str().expect("a path"));
    let found = program(&["simulate", path, "--slopes", "x[1,1], k[1,2]", "--json"]).expect("slopes");
    let json: serde_json::Value = serde_json::from_str(&found).expect("JSON");
    assert!(
        json["slopes"].to_string().contains("x[1,1]") && json["slopes"].to_string().contains("k[1,2]"),
        "{}",
        json["slopes"]
    );
    for arguments in [
        &["sweep", path, "--vary", "m=1..2:2", "--show", "x[1,1],x[1,2]", "-o", table] as &[&str],
        &["needs", path, "--needs", "x[1,1],x[1,2]=1 mm"],
        &["solve", path, "--unknown", "x[1,1]=0.3", "--such-that", "x[1,1]=0.1"],
    ] {
        program(arguments).unwrap_or_else(|error| panic!("{arguments:?}: {error}"));
    }
}

/// The block of a crank in space, which a slider keeps from turning and from leaving its rail: slopes that are 0 but for rounding are told as 0, the
/// others with their digits.
#[test]
fn slopes_of_what_nothing_moves_are_zero() {
    let simulation = super::simulation(&super::text_of("space_crank")).until(1.0);
    let slopes = simulation.slopes(&["th'", "L", "T0", "th"]).unwrap();
    for unknown in ["th'", "L", "T0", "th"] {
        for name in [
            "sy", "sz", "sl.w", "sl.x", "sl.y", "sl.z", "sy'", "sz'", "sl.w'", "sl.x'", "sl.y'", "sl.z'", "muq.y",
            "mgs.y",
        ] {
            let slope = slopes.get(name, unknown).unwrap();
            assert!(slope.value.abs() <= slope.error, "{name} by {unknown}: {} by {}", slope.value, slope.error);
        }
    }
    let th = slopes.get("th", "T0").unwrap();
    assert!((th.value - 3.601_061_885).abs() < 1e-8 && th.error < 1e-9, "{th:?}");
}
