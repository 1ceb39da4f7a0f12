//! Where a motion starts and ends: at kinks and jumps of inputs, at rest, locked; each file that once ran wrong beside a
//! neighbour that must be left alone.
#![cfg(feature = "interpret")]

use dalembert::mechanism::{Enforcement, Interpreted, System};
use dalembert::{Error, Run, Settings, simulate};
use dalembert_symbolic::lower::compile;

/// Runs a model file that nobody compiled, with its digits.
fn tried(text: &str, change: impl FnOnce(&mut Settings)) -> Result<Run, Error> {
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
    let mut system = Interpreted::new(program, text);
    let mut settings = Settings::new(&system.scene(0));
    settings.digits = true;
    change(&mut settings);
    simulate(&mut system, &settings)
}

fn run_until(text: &str, until: f64) -> Run {
    tried(text, |settings| settings.until = until).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// A bead on a straight wire at 45° that an input moves, let go of at x = 0.
fn wire(lines: &str) -> String {
    format!(
        "name: Wire
parameters: {{m: 1 kg, v: 1 m/s, T: 1 s}}
coordinates: {{x: m, y: m}}
{lines}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
constraints: {{wire: y - x - base}}
scene: {{start: {{x: 0}}, until: 3}}"
    )
}

#[test]
fn inputs_with_kinks_move_a_start_as_they_are_before_the_kink() {
    let table =
        "tables: {p: {points: [[0, 0], [1, 0], [2, 1], [3, 3]], units: [s, m], smooth: 0}}\ninputs: {base: p(t)}";
    for (lines, from, to) in [
        ("inputs: {base: v*abs(t - T)}", 1.0, [-0.5, 1.5]),
        ("inputs: {base: \"v*max(0, t - T)\"}", 0.0, [-1.0, 1.0]),
        ("inputs: {base: \"v*max(0, T - abs(t - 2*T))\"}", 0.0, [0.0, 0.0]),
        (table, 0.0, [-1.5, 1.5]),
        // Smooth until the end of the run.
        ("inputs: {base: v*abs(t + T)}", 1.0, [-1.5, 2.5]),
    ] {
        let run = run_until(&wire(lines), 3.0);
        let first = run.column("y").unwrap()[0];
        assert!((first - from).abs() < 1e-12, "{lines}: {first}");
        let last = run.last();
        assert!((last["x"] - to[0]).abs() + (last["y"] - to[1]).abs() < 1e-8, "{lines}: {last:?}");
        assert!(run.digits("y").unwrap() >= 8 || to[1] == 0.0, "{lines}");
        assert!(run.warnings.is_empty(), "{lines}: {:?}", run.warnings);
    }
}

/// Tables that are straight between their points turn sharply, as `abs` does.
#[test]
fn the_points_of_a_straight_table_kick_what_it_moves() {
    let carried = |smooth: u32| {
        format!(
            "name: Carried
parameters: {{m: 1 kg}}
tables: {{p: {{points: [[0, 0], [1, 0], [2, 1], [3, 3]], units: [s, m], smooth: {smooth}}}}}
coordinates: {{x: m}}
inputs: {{base: p(t)}}
bodies: {{b: {{mass: m, position: \"[x + base, 0]\"}}}}
scene: {{start: {{x: 0}}, until: 2.5}}"
        )
    };
    let run = run_until(&carried(0), 2.5);
    let jumps: Vec<f64> = run.impulses.iter().map(|impulse| (impulse.jump[0] * 1e9).round() / 1e9).collect();
    assert_eq!(jumps, [-1.0, -1.0]);
    assert!((run.last()["x"] + 2.0).abs() < 1e-9, "{:?}", run.last());
    // A smooth one does not.
    assert!(run_until(&carried(2), 2.5).impulses.is_empty());
}

/// A body on a spring and a damper that are driven by a step at t = 1.
const STEP: &str = "name: Step
parameters: {m: 1 kg, k: 4 N/m, c: 0.5 N*s/m, Y: 1 m, T: 1 s}
coordinates: {x: m}
inputs: {u: Y*step(t - T)}
bodies: {b: {mass: m, position: \"[x, 0]\"}}
springs: {s: {stretch: x - u, stiffness: k, on: b, along: \"[1, 0]\"}}
dampers: {d: {rate: x' - u', damping: c, on: b, along: \"[1, 0]\"}}
scene: {start: {x: 0}, until: 3}";

#[test]
fn a_run_that_ends_at_a_kick_has_had_it_and_one_that_begins_there_has_not() {
    let (whole, first) = (run_until(STEP, 3.0), run_until(STEP, 1.0));
    assert_eq!((first.impulses.len(), first.last()["x'"]), (1, 0.5));
    assert_eq!(first.digits("x'"), Some(9));
    let (q, v) = (vec![first.last()["x"]], vec![first.last()["x'"]]);
    let second = tried(STEP, |settings| (settings.from, settings.q, settings.v) = (1.0, q, v)).unwrap();
    assert!(second.impulses.is_empty());
    assert!((second.last()["x"] - whole.last()["x"]).abs() < 1e-8, "{} {}", second.last()["x"], whole.last()["x"]);
    // Just before it nothing has happened.
    let before = run_until(STEP, 0.999);
    assert_eq!((before.impulses.len(), before.last()["x'"]), (0, 0.0));
}

#[test]
fn an_event_that_ends_a_run_at_a_kick_leaves_it_to_that_run() {
    let text = STEP.replace("scene:", "events: {end: {when: t - T, then: stop}}\nscene:");
    let run = run_until(&text, 3.0);
    assert_eq!((run.last().t, run.impulses.len(), run.last()["x'"]), (1.0, 1, 0.5));
    let free = text.replace("when: t - T", "when: t - T/2");
    assert!(run_until(&free, 3.0).impulses.is_empty());
}

/// Two pendulums of which a constraint makes one: the moved start of the second run is symmetric, and not moved at all.
fn pendulums(constraint: &str, start: &str) -> String {
    format!(
        "name: Pair
parameters: {{m: 1 kg, l: 1 m, g: 9.81 m/s^2, b: 2 m}}
coordinates: {{a: rad, c: rad}}
points: {{A: \"l*[sin(a), -cos(a)]\", C: \"[b, 0] + l*[sin(c), -cos(c)]\"}}
bodies: {{ba: {{mass: m, position: A}}, bc: {{mass: m, position: C}}}}
gravity: [0, -g]
constraints: {{link: \"{constraint}\"}}
scene: {{start: {{{start}}}, until: 10}}"
    )
}

#[test]
fn what_is_locked_has_its_digits() {
    for constraint in ["a - c", "dot(A - C, A - C) - b^2"] {
        let run = run_until(&pendulums(constraint, "a: 0.1, c: 0.1"), 10.0);
        assert!((run.last()["a"] - 0.099344536).abs() < 2e-8, "{:?}", run.last());
        assert!(run.digits("a").unwrap() >= 6, "{constraint}: {:?} {:?}", run.digits("a"), run.warnings);
    }
    // Upside down it is unstable: rounding decides, and is said to.
    let run = run_until(&pendulums("a - c", "a: pi, c: pi"), 30.0);
    assert_eq!(run.digits("a"), Some(0));
}

#[test]
fn what_rests_is_not_called_unstable() {
    let text = "name: Rest
parameters: {m: 1 kg, a: 2 1, R: 1 m}
coordinates: {x: m, y: m, th: rad}
bodies: {b: {mass: m, inertia: m*R^2, angle: th, position: \"[x, y]\"}}
gravity: [9.81, 9.81]
constraints: {c1: \"x' - R*th'\", c2: \"y' - a*R*th' + (1 - a)*x*th'\", c3: \"x' - y'*a\"}
scene: {start: {x: 1, y: 2}, until: 1}";
    let run = run_until(text, 1.0);
    assert!(run.warnings.is_empty() && run.digits_until() == Some(1.0), "{:?}", run.warnings);
}

#[test]
fn springs_without_dampers_do_not_stand_for_constraints_with_speeds() {
    let skate = |constraint: &str| {
        format!(
            "name: Skate
parameters: {{m: 1 kg, I: 1 kg*m^2, g: 9.81 m/s^2}}
coordinates: {{x: m, y: m, th: rad}}
bodies: {{b: {{mass: m, inertia: I, angle: th, position: \"[x, y]\"}}}}
gravity: [g, 0]
constraints: {{edge: \"{constraint}\"}}
scene: {{start: {{th': 1, x': 0}}, until: 0.1}}"
        )
    };
    let sprung = |constraint: &str, damping: f64| {
        let springs = Enforcement::Springs { stiffness: 1e3, damping };
        tried(&skate(constraint), |settings| settings.enforcement = springs)
    };
    let refused = sprung("x'*sin(th) - y'*cos(th)", 0.0);
    assert!(matches!(&refused, Err(Error::NeedsDamping { constraint }) if constraint == "edge"), "{refused:?}");
    assert!(sprung("x'*sin(th) - y'*cos(th)", 10.0).is_ok());
    assert!(sprung("x - y", 0.0).is_ok());
}

/// Two blocks that two rows hold at 0, beside one that falls.
#[test]
fn rows_that_a_scene_makes_independent_hold_what_rests_at_zero() {
    let text = |a: f64| {
        format!(
            "name: Held
parameters: {{m: 1 kg, a: {a} 1, g: 9.81 m/s^2}}
coordinates: {{x: m, y: m, z: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}, c: {{mass: m, position: \"[z, 0]\"}}}}
gravity: [g, g]
constraints: {{c1: x - y, c2: x - a*y}}
scene: {{start: {{z: 0}}, until: 1}}"
        )
    };
    for (a, x) in [(2.0, 0.0), (1.0, 4.905)] {
        let run = run_until(&text(a), 1.0);
        assert!((run.last()["z"] - 4.905).abs() + (run.last()["x"] - x).abs() < 1e-9, "{a}: {:?}", run.last());
    }
}

/// Scenes that are none are the first, with its own equations of the start.
#[test]
fn a_scene_that_is_none_is_the_first() {
    let text = "name: Turn\nparameters: {m: 1 kg}\ncoordinates: {x: m, y: m}\nbodies: {b: {mass: m, position: \"[x, y]\"}}\n\
        conserved: {spin: \"m*(x*y' - y*x')\"}\nscene: {start: {x: 1, y: 0}, also: {spin: 1}, until: 1}\n";
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
    let system = Interpreted::new(program, text);
    assert_eq!(system.scene(0).start_conditions, 0..1);
    assert_eq!(system.scene(99).start_conditions, 0..1);
}

/// At its dead centre all terms of a row of a slider-crank vanish: there is nothing beside which what is left of it could be small.
#[test]
fn a_start_at_a_dead_centre_is_met() {
    let text = "name: Crank\nparameters: {r: 0.1 m, l: 0.3 m, m: 1 kg}\ncoordinates: {p: rad, q: rad, x: m}\n\
        points: {A: 'r*[cos(p), sin(p)]', B: 'A + l*[cos(q), -sin(q)]'}\nbodies: {a: {mass: m, position: A}, s: {mass: m, position: '[x, 0]'}}\n\
        constraints: {close: 'B - [x, 0]'}\nscene: {start: {p: 0, \"p'\": 3}, guess: {q: 0.3, x: 0.4}, until: 0.1}\n";
    let run = tried(text, |_| {}).expect("a run");
    let (p, q) = (run.last()["p"], run.last()["q"]);
    assert!((0.1 * p.sin() - 0.3 * q.sin()).abs() < 1e-12 && p > 0.29, "{p} {q}");
}

/// A four-bar as large as a solar system, whose angles are as large as those of a small one.
#[test]
fn lengths_of_any_size_stand_beside_angles() {
    let at = |size: &str| {
        let text = format!(
            "name: Scaled\nparameters: {{S: {size} m, a: 0.1*S, b: 0.3*S, c: 0.25*S, d: 0.3*S, m: 1 kg, g0: 9.81 1/s^2, g: g0*S}}\n\
             coordinates: {{p: rad, q: rad, r: rad, x: m}}\n\
             points: {{A: 'a*[cos(p), sin(p)]', B: 'A + b*[cos(q), sin(q)]', C: '[d, 0]'}}\n\
             bodies:\n  one: {{mass: m, inertia: m*a^2/12, angle: p, position: A/2}}\n  two: {{mass: m, inertia: m*b^2/12, angle: q, position: (A + B)/2}}\n  \
             three: {{mass: m, inertia: m*c^2/12, angle: r, position: 'C + c/2*[cos(r), sin(r)]'}}\n  ram: {{mass: m, position: '[x, S]'}}\n\
             gravity: [0, -g]\nconstraints: {{loop: 'B - C - c*[cos(r), sin(r)]', ram: x - B.x}}\n\
             scene: {{start: {{p: 1, \"p'\": 2}}, guess: {{q: 0.8, r: 1.5, x: 0.3*S}}, until: 0.2}}\n"
        );
        let run = tried(&text, |_| {}).expect("a run");
        ["p", "q", "r"].map(|name| run.last()[name])
    };
    let known = at("1");
    for size in ["1e12", "1e-12"] {
        let found = at(size);
        for (found, known) in found.iter().zip(known) {
            assert!((found - known).abs() < 1e-8, "{size} {found} {known}");
        }
    }
}
