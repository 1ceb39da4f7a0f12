//! Small wrong files that were accepted, and advice that did not work where it was followed.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::{folder, program};

/// A mass that moves along a line.
const HEAD: &str = "name: A\nparameters: {m: 1 kg, far: 3 m, on: 0.3 s, T: 0.1 s, b: 2 m, s: 8}\ncoordinates: {x: m}\n\
    scene: {start: {x: 2.8, \"x'\": 1}, until: 1}\n";
const RAW: &str = "kinetic_energy: m*x'^2/2\n";

/// What the program prints of a file with these lines, or what it says is wrong.
fn told(lines: &str, command: &str, arguments: &[&str]) -> Result<String, String> {
    static FILES: AtomicUsize = AtomicUsize::new(0);
    let file = folder("advice").join(format!("{command}-{}.yaml", FILES.fetch_add(1, Ordering::Relaxed)));
    std::fs::write(&file, format!("{HEAD}{lines}")).expect("a file");
    program(&[&[command, file.to_str().expect("a path")], arguments].concat())
}

/// What is refused, and what is not when its advice is followed.
fn refused(code: &str, advice: &str, wrong: &str, right: &str) {
    let error = told(wrong, "check", &[]).expect_err(wrong);
    assert!(error.contains(&format!("error[{code}]")) && error.contains(advice) && error.contains(".yaml:"), "{error}");
    told(right, "check", &[]).unwrap_or_else(|error| panic!("{right}: {error}"));
}

#[test]
fn seeds_are_whole_numbers() {
    let noise = |seed: &str| {
        format!("{RAW}noise: {{gust: {{every: 10 ms, sigma: 2 N, seed: {seed}}}}}\ngeneralized_forces: {{x: gust}}\n")
    };
    refused("E281", "a whole number", &noise("7.5"), &noise("7"));
    refused("E281", "a whole number", &noise("s/3"), &noise("s/4"));
    for (seed, name) in [("7", "gust_seed"), ("s", "s")] {
        let set = |value: &str| told(&noise(seed), "simulate", &["--no-digits", "--set", &format!("{name}={value}")]);
        for value in ["7.5", "15/2", "1e17"] {
            let error = set(value).unwrap_err();
            assert!(error.contains("error[E281]") && error.contains("--set:1:1"), "{error}");
        }
        set("9").unwrap();
        let table = folder("advice").join("seeds.csv");
        let sweep = |range: &str| {
            let vary = format!("{name}={range}");
            told(&noise(seed), "sweep", &["--vary", &vary, "--csv", table.to_str().expect("a path")])
        };
        assert!(sweep("1..2:3").unwrap_err().contains("its seed is 1.5"));
        sweep("1..3:3").unwrap();
    }
}

#[test]
fn events_that_never_happen_are_refused() {
    let event = |when: &str| format!("{RAW}events: {{e: {{{when}, then: record}}}}\n");
    for right in ["when: x - far", "when: t - on", "every: on"] {
        refused("E463", "`when: t - t1`", &event("when: 0"), &event(right));
        assert!(told(&event(right), "simulate", &["--no-digits"]).unwrap().contains("event e at t = "), "{right}");
    }
    refused("E463", "passes 0", &event("when: far - b"), &event("when: x - b"));
}

#[test]
fn masses_do_not_jump_by_inputs() {
    let mass =
        |input: &str| format!("inputs: {{u: \"{input}\"}}\nbodies: {{body: {{mass: u, position: \"[x, 0]\"}}}}\n");
    let slow = "m*(1 + min(1, max(0, (t - on)/T)))";
    refused("E461", "with `min` and `max`", &mass("m*(1 + step(t - on))"), &mass(slow));
    let error = told(&mass(slow), "simulate", &["--no-digits", "--input", "u=1 + step(t - 0.3)"]).unwrap_err();
    assert!(error.contains("error[E461]") && error.contains("--input:1:1"), "{error}");
    told(&mass(slow), "simulate", &["--no-digits", "--input", "u=1 + min(1, max(0, t - 0.3))"]).unwrap();
    // A force may jump.
    let force = format!("{RAW}inputs: {{u: 0*m*far/T^2}}\ngeneralized_forces: {{x: u}}\n");
    told(&force, "simulate", &["--no-digits", "--input", "u=step(t - 0.3)"]).unwrap();
}

#[test]
fn remainders_and_powers_are_written_as_is_said() {
    let output = |value: &str| format!("{RAW}outputs: {{r: \"{value}\"}}\n");
    let remainder = "b/(2*pi)*atan2(sin(2*pi*x/b), cos(2*pi*x/b))";
    refused("E107", "b/(2*pi)*atan2(sin(2*pi*a/b), cos(2*pi*a/b))", &output("x%b"), &output(remainder));
    // At 3.8 m, by 2 m.
    let text = told(&output(remainder), "simulate", &[]).unwrap();
    assert!(text.contains("  r = -0.2000000000") || text.contains("  r = -0.1999999999"), "{text}");
    for right in ["x^64*x", "(x^32)^4", "1/(x^64*x)"] {
        refused("E230", "`x^64*x` or `(x^32)^4`", &output("x^65"), &output(right));
    }
}

#[test]
fn names_that_are_proposed_may_stand_there() {
    let event = |memory: &str| format!("{RAW}{memory}events: {{e: {{on_set: n, then: stop}}}}\n");
    refused("E201", "`memory: {n: 0}`", &event(""), &event("memory: {n: 0}\n"));
    let error = told(&format!("{RAW}outputs: {{r: sinn}}\n"), "check", &[]).unwrap_err();
    assert!(error.contains("did you mean `sin(…)`?"), "{error}");
    // No time and no coordinate where a parameter's value is wanted.
    for name in ["tt", "xx"] {
        let error = told(&format!("{RAW}define: {{q: {name}}}\n"), "check", &[]).unwrap_err();
        assert!(error.contains("did you mean"), "{error}");
        let error = told(&format!("{RAW}sample: {{x: [0, {name}]}}\n"), "check", &[]).unwrap_err();
        assert!(error.contains("unknown name") && !error.contains("did you mean"), "{error}");
    }
    // What commas tore apart is no key given twice.
    let torn = format!("{RAW}outputs: {{r: atan2(x, b), q: max(x, b, b)}}\n");
    refused(
        "E002",
        "in double quotes",
        &torn,
        &torn.replace("atan2(x, b)", "\"atan2(x, b)\"").replace("max(x, b, b)", "\"max(x, b, b)\""),
    );
}

/// A file with its own head.
fn of_file(name: &str, text: &str, arguments: &[&str]) -> Result<String, String> {
    let file = folder("advice").join(name);
    std::fs::write(&file, text).expect("a file");
    program(&[&arguments[..1], &[file.to_str().expect("a path")], &arguments[1..]].concat())
}

/// A ball on a plate that shakes it off: a contact by itself, which was advised to be one.
#[test]
fn methods_that_cannot_follow_a_contact_are_named() {
    let text = "name: Plate\nparameters: {m: 1 kg, g: 9.81 m/s^2, A: 0.01 m, W: 60 rad/s, e: 0.5 1}\ninputs: {h: A*sin(W*t)}\n\
        coordinates: {y: m}\nbodies: {b: {mass: m, position: \"[0, y]\"}}\ngravity: \"[0, -g]\"\n\
        contacts: {c: {gap: y - h, on: b, normal: \"[0, 1]\", restitution: e}}\nscene: {start: {y: 0.02}, until: 1.5, tolerance: 1e-12}\n";
    let error = of_file("plate.yaml", text, &["simulate", "--method", "euler", "--step", "0.01"]).unwrap_err();
    assert!(error.contains("chattering") && error.contains("it is the method that cannot follow it"), "{error}");
    of_file("plate.yaml", text, &["simulate", "--no-digits"]).unwrap();
}

/// A cord that is slack where its ends meet has no force there; the advice was to write another power.
#[test]
fn ends_that_meet_where_a_scene_starts_are_to_start_apart() {
    let text = "name: Bungee\nparameters: {m: 70 kg, k: 100 N/m, L: 20 m, g: 9.81 m/s^2}\ncoordinates: {y: m}\n\
        bodies: {j: {mass: m, position: \"[0, y]\"}}\ngravity: \"[0, -g]\"\n\
        springs: {cord: {between: [\"[0, 0]\", j], tension: \"k*max(0, length - L)\"}}\nscene: {start: {y: -1}, until: 2}\n";
    let error = of_file("bungee.yaml", text, &["simulate", "--start", "y=0"]).unwrap_err();
    assert!(error.contains("even where there is no force; start where it is not zero"), "{error}");
    of_file("bungee.yaml", text, &["simulate", "--start", "y=-0.01"]).unwrap();
}

#[test]
fn pairs_behind_a_comma_are_to_be_given_by_themselves() {
    for (command, option) in [("modes", "at"), ("simulate", "start"), ("simulate", "set")] {
        let error = told(RAW, command, &[&format!("--{option}"), "x=16,x'=-1"]).unwrap_err();
        let advice = format!("--{option} takes one NAME=VALUE each time: write --{option} again for `x'=-1`");
        assert!(error.contains(&advice), "{error}");
    }
    let error = told(RAW, "simulate", &["--start", "x=max(1, y = 2)"]).unwrap_err();
    assert!(!error.contains("again"), "{error}");
}

/// Impulses decide at an impact, not forces: a wheel that rolls against a rough step.
#[test]
fn contacts_are_undecided_by_impulses_too() {
    let text = "name: Step\nparameters: {m: 20 kg, R: 0.4 m, h: 0.1 m, g: 9.81 m/s^2, v0: 3 m/s, mu: 5 1}\n\
        coordinates: {x: m, y: m, ph: rad}\npoints: {C: \"[x, y]\", K: \"[0, h]\"}\n\
        bodies: {w: {mass: m, inertia: m*R^2/2, angle: ph, position: C}}\ngravity: \"[0, -g]\"\ncontacts:\n\
        \x20 floor: {gap: y - R, on: w, at: \"[x, y - R]\", normal: \"[0, 1]\", friction: mu}\n\
        \x20 edge: {gap: norm(C - K) - R, on: w, at: K, normal: unit(C - K), friction: mu}\n\
        impacts: together\nscene: {start: {x: -1, y: R, x': v0, ph': -v0/R}, until: 0.7}\n";
    let error = of_file("step.yaml", text, &["simulate"]).unwrap_err();
    assert!(error.contains("agree with the forces here, or at an impact with the impulses (floor"), "{error}");
}

/// What is free of a motion that closes was named and not explained: of a pendulum's swings there are larger and smaller ones.
#[test]
fn what_is_free_of_a_motion_is_explained() {
    let text = "name: Swing\nparameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2}\ncoordinates: {th: rad}\n\
        bodies: {b: {mass: m, position: \"l*[sin(th), -cos(th)]\"}}\ngravity: \"[0, -g]\"\nscene: {start: {th: 1}, until: 10}\n\
        motions: {half: {closes: {part: 1/2, mirror: [th]}}}\n";
    let found = of_file("swing.yaml", text, &["orbit"]).unwrap();
    assert!(found.contains("  time: the same motion may begin at any of its states\n"), "{found}");
    assert!(
        found.contains("  scale: larger and smaller motions close too; `energy` in `motions` asks for one"),
        "{found}"
    );
}

/// Another body keeps the mass matrix positive, so that nothing else shows it.
#[test]
fn a_number_that_makes_a_mass_negative_is_refused() {
    let two = "parameters: {m: 1 kg, M: 5 kg, far: 3 m}\nbodies: {a: {mass: m, position: \"[x, 0]\"}, b: {mass: M, position: \"[x, 1]\"}}\n";
    let file = folder("negative").join("two.yaml");
    let head = "name: A\ncoordinates: {x: m}\nscene: {start: {x': 1}, until: 1}\n";
    std::fs::write(&file, format!("{head}{two}")).expect("a file");
    let file = file.to_str().expect("a path");
    for command in [&["simulate", file, "--set"][..], &["modes", file, "--set"]] {
        let refused = program(&[command, &["m=-1"]].concat()).expect_err("a negative mass");
        assert!(refused.contains("a mass must be positive or 0, this is -1"), "{refused}");
    }
    for set in ["m=0", "m=2", "far=-1"] {
        program(&["simulate", file, "--set", set]).unwrap_or_else(|refused| panic!("{set}: {refused}"));
    }
}
