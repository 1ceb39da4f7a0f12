//! Warnings, question marks and causes that did not fit: the numbers behind them were right.

use std::fs;

use dalembert::{Cause, Error, Warning};

use super::{case, folder, program};

/// What `simulate` prints of a model file's text.
fn simulated(name: &str, text: &str) -> String {
    let path = folder(name).join("model.yaml");
    fs::write(&path, text).expect("a file");
    program(&["simulate", path.to_str().expect("a path")]).unwrap_or_else(|error| panic!("{error}"))
}

/// A tank that is shut off when it is empty, where its level stays.
const EMPTIED: &str = r#"
name: Emptied
parameters: {q: 2 kg/s}
states: {a: {unit: kg, rate: -q*on}}
memory: {on: 1}
events: {empty: {when: a, direction: falling, then: {set: {on: 0, a: 0}}}}
scene: {start: {a: 70 kg}, until: 60, tolerance: 1e-11}
"#;

#[test]
fn the_time_of_an_event_that_leaves_its_function_at_zero_was_unknown() {
    // 70 kg at 2 kg/s.
    assert!(simulated("emptied", EMPTIED).contains("event empty at t = 35.0"));
    // What is flat about its zero is known no better, as before: (t − 1)³.
    let flat = "name: Flat\nstates: {a: {unit: 1, rate: 1 + 0*a}}\nevents: {zero: {when: a^3 - 3*a^2 + 3*a - 1, then: record}}\n\
                scene: {start: {a: 0}, until: 2, tolerance: 1e-11}\n";
    let printed = simulated("flat", flat);
    let digits = printed.lines().find_map(|line| line.trim().strip_prefix("event zero at t = ")).expect("an event");
    assert!(digits.len() < 9, "{digits}");
}

#[test]
fn what_set_what_ended_a_run_was_said_to_lie_near_its_end() {
    let relay = "name: Relay\nparameters: {m: 1 kg, F: 3 N, h: 0.1 m}\ncoordinates: {x: m}\nmemory: {s: 1, n: 0}\n\
                 bodies: {p: {mass: m, position: \"[x, 0]\"}}\nforces: {f: {on: p, force: \"[s*F, 0]\"}}\n\
                 events:\n  up: {when: x - h, direction: rising, then: {set: {s: -1, n: n + 1}}}\n  \
                 fin: {on_set: n, if: n - 0.5, then: stop}\n\
                 scene: {start: {x: 0}, until: 10, tolerance: 1e-12}\n";
    let mut stops = case(relay);
    stops.settings.digits = true;
    let run = stops.run();
    // h = F t²/2m.
    assert!((run.last().t - (0.2_f64 / 3.0).sqrt()).abs() < 1e-12);
    assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    // An end that a time is, and not what happens there, may be just before or just after it.
    let mut near = case(&relay.replace("then: stop", "then: {set: {s: -1}}"));
    near.settings.digits = true;
    near.settings.until = run.last().t * (1.0 + 1e-15);
    let near = near.run();
    assert!(near.warnings.iter().any(|warning| matches!(warning, Warning::EventNearEnd { .. })), "{:?}", near.warnings);
}

/// A point that strikes, and what counts the impacts.
const COUNTED: &str = r#"
name: Counted
parameters: {m: 1 kg, e: 0.5, d: 0.5 m}
coordinates: {x: m}
memory: {h: 0, k: 0}
bodies: {p: {mass: m, position: "[x, 0]"}}
constraints: {wall: x - d}
phases: {fly: [], rest: [wall]}
events:
  hit: {when: x - d, direction: rising, phase: fly, then: [{impact: e, along: wall}, {set: {h: h + 1}}]}
  follow: {on_set: h, then: {set: {k: k + 10}}}
scene: {start: {x: 0, x': 1}, until: 2, tolerance: 1e-11}
"#;

#[test]
fn sets_that_follow_each_other_without_end_were_called_dry_friction() {
    let Err(Error::Run(failure)) = case(&COUNTED.replace("k: k + 10", "h: h + 10")).try_run() else { panic!("an end") };
    assert_eq!(failure.cause, Cause::EndlessSets { event: "follow".to_owned() });
    // What the impact took is no error of the integration.
    assert!(failure.run.energy_balance.is_some_and(|drift| drift < 1e-12), "{:?}", failure.run.energy_balance);
    assert!(failure.run.warnings.is_empty(), "{:?}", failure.run.warnings);
    let run = case(COUNTED).run();
    assert!((run.last()["x"] + 0.25).abs() < 1e-12 && run.memory("k") == Some(10.0));
}

/// A block on a plane that turns, at the limit of its friction.
const TURNING: &str = r#"
name: Turning
parameters: {m: 1 kg, g: 9.81 m/s^2, al: 0.1 rad, w: 0.1 rad/s}
coordinates: {s: m, n: m}
inputs: {tilt: al + w*t}
frames: {B: {angle: tilt}}
bodies: {p: {mass: m, position: "s*B.x + n*B.y"}}
gravity: [0, -g]
constraints: {plane: n}
friction: {rub: {rate: s', on: p, along: B.x, limit: "tan(al)*reaction(plane)"}}
scene: {start: {s: 1e-6, s': 0}, until: 1, tolerance: 1e-12}
"#;

#[test]
fn an_event_that_was_listed_was_said_to_be_not_counted() {
    for al in ["0.1", "0.2", "0.5"] {
        let run = case(&TURNING.replace("al: 0.1", &format!("al: {al}"))).run();
        assert_eq!(run.events.len(), 1, "{al}");
        assert!(run.events[0].name == "rub slips" && run.warnings.is_empty(), "{al}: {:?}", run.warnings);
    }
    // A function that jumps over zero is still no event.
    let jumps = "name: Jumps\ncoordinates: {x: m}\nparameters: {m: 1 kg, d: 1 m}\nbodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
                 events: {over: {when: step(x - d) - 0.5, then: record}}\nscene: {start: {x: 0, x': 1}, until: 2, tolerance: 1e-10}\n";
    let run = case(jumps).run();
    assert!(run.events.is_empty() && run.warnings.iter().any(|warning| matches!(warning, Warning::NoCrossing { .. })));
}

/// A block on rough ground that springs bring to rest, in units of its own.
const SCALED: &str = r#"
name: Scaled
parameters: {S: 1, Q: 1, m: 1 kg, g0: 10 m/s^2, v0: 3 m/s, mu: 0.2, k0: 4 N/m, g: g0*S/Q^2, v: v0*S/Q, k: k0/Q^2}
coordinates: {x: m, y: m}
bodies: {b: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
forces: {spring: {on: b, force: "[-k*x, 0]"}}
contacts: {floor: {gap: y, on: b, normal: "[0, 1]", friction: mu, restitution: 0.5 1}}
scene: {start: {x: 0, y: S*1 m, x': v}, until: 5*Q, tolerance: 1e-11}
"#;

#[test]
fn what_rests_in_large_units_of_time_had_steps_that_were_too_small() {
    let digits = |q: &str| {
        let mut case = case(&SCALED.replace("S: 1, Q: 1", &format!("S: {q}, Q: {q}")));
        case.settings.digits = true;
        let run = case.run();
        let scale: f64 = q.parse().expect("a number");
        assert!((run.last()["x"] / scale + 0.186_474_581_1).abs() < 1e-9, "{q}: {}", run.last()["x"]);
        run.digits("x").expect("digits")
    };
    for q in ["1", "1e-6", "1e6", "1e9", "1e10"] {
        assert!(digits(q) >= 9, "{q}: {}", digits(q));
    }
}

/// Steps that suit an oscillator of some seconds are 10¹³ to the end of a run of ages: they are too many, and none has vanished beside the time.
#[test]
fn steps_that_are_too_many_are_not_too_small() {
    let text = "name: Hard\nparameters: {m: 1e-12 kg, b: 1e12 N/m^3}\ncoordinates: {x: m}\nbodies: {b1: {mass: m, position: '[x, 0]'}}\n\
        generalized_forces: {x: -b*x^3}\nscene: {start: {x: 1e-12}, until: 1e13, tolerance: 1e-10}\n";
    let error = case(text).try_run().expect_err("too many steps");
    assert!(matches!(error.cause(), Some(dalembert::Cause::NeedsMoreSteps { .. })), "{error}");
}

/// The instant of a stop is rounded to 4.5e-13 s after an hour, and the speed then to what the acceleration of 2 m/s² makes in it.
#[test]
fn a_stop_of_friction_is_no_impulse_late_in_a_run() {
    let text = "name: Stick\nparameters: {m: 1 kg, k: 4 N/m, mu: 0.2, mus: 0.4, g: 10 m/s^2, vb: 0.1 m/s}\ncoordinates: {x: m}\n\
        bodies: {b: {mass: m, position: \"[x, 0]\"}}\nsprings: {s: {stretch: x, stiffness: k, along: ground.x, on: b}}\n\
        friction: {rub: {rate: x' - vb, on: b, along: ground.x, limit: mu*m*g, static: mus*m*g}}\nscene: {start: {x: 0}, until: 5000}\n";
    let mut stick = case(text);
    // An hour and a half is gone before the run begins.
    (stick.settings.from, stick.settings.until) = (5000.0, 5200.0);
    let run = stick.run();
    assert!(run.events.len() > 20 && run.impulses.is_empty(), "{} {:?}", run.events.len(), run.impulses);
}

#[test]
fn a_contact_of_what_has_no_mass_is_not_what_is_undecided() {
    let text = |m: &str| {
        format!(
            "name: Slope\nparameters: {{m: {m} kg, k: 4 N/m, mu: 0.3, g: 10 m/s^2}}\ncoordinates: {{x: m, y: m}}\n\
             bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}\ngravity: [2, -g]\n\
             contacts: {{floor: {{gap: y, on: b, normal: [0, 1], friction: mu}}}}\n\
             springs: {{s: {{stretch: x, stiffness: k, along: ground.x, on: b}}}}\nscene: {{start: {{x: 0, y: 0}}, until: 1}}\n"
        )
    };
    let Err(error) = case(&text("0")).try_run() else { panic!("it runs") };
    assert!(error.to_string().contains("singular mass matrix: nothing gives `x` an inertia"), "{error}");
    assert!(case(&text("1")).run().warnings.is_empty());
}

/// Where a limit jumps, or vanishes, rounding decides what it is: `static` that nobody gave was "below limit", and `abs` negative.
#[test]
fn limits_of_friction_may_jump_and_vanish() {
    let block = |limit: &str, spring: &str, start: &str| {
        format!(
            "name: Block\ncoordinates: {{x: }}\nbodies: {{b: {{mass: 1, position: \"[x, 0]\"}}}}\n\
             generalized_forces: {{x: {spring}}}\n\
             friction: {{rub: {{rate: x', on: b, along: \"[1, 0]\", limit: \"{limit}\"}}}}\nscene: {{start: {start}, until: 3}}\n"
        )
    };
    // Of an energy of 9/2 the first metre takes 2, and every further one 3.
    let jumps = case(&block("2 + step(x - 1)", "0", "{x: 0, x': 3}")).run();
    assert!((jumps.last()["x"] - 1.0 - 2.5 / 3.0).abs() < 1e-9, "{}", jumps.last()["x"]);
    // As another program integrates it from turn to turn.
    let vanishes = case(&block("2*abs(x)", "-10*x", "{x: 1}")).run();
    assert!((vanishes.last()["x"] + 0.542_051_1).abs() < 1e-6, "{}", vanishes.last()["x"]);
    let Err(error) = case(&block("-2*abs(x)", "-10*x", "{x: 1}")).try_run() else { panic!("it drives") };
    assert!(error.to_string().contains("negative limit"), "{error}");
}

/// A row of which one entry is as large as ever does not vanish, however heavy that coordinate is, and however small the others have become.
#[test]
fn rows_of_heavy_coordinates_are_no_singular_positions() {
    // x slides down y = x^2/2, past the place where the light coordinate is of no use: y from 1/2 to 0 as M pulls.
    let text = |mass: &str, until: &str| {
        format!(
            "name: Wire\nparameters: {{M: {mass}, g: 9.81}}\ncoordinates: {{x: , y: }}\nkinetic_energy: x'^2/2 + M*y'^2/2\n\
             potential_energy: M*g*y\nconstraints: {{w: y - x^2/2}}\nscene: {{start: {{x: 1, y: 0.5}}, until: {until}, tolerance: 1e-9}}\n"
        )
    };
    for mass in ["1", "1e6", "1e8", "1e12"] {
        let run = case(&text(mass, "0.5")).run();
        assert!(run.warnings.is_empty(), "{mass}: {:?}", run.warnings);
        let (last, m) = (run.last(), mass.parse::<f64>().expect("a number"));
        let energy = 0.5 * (last["x'"].powi(2) / m + last["y'"].powi(2)) + 9.81 * last["y"];
        assert!((energy - 0.5 * 9.81).abs() < 1e-6 && (last["y"] - 0.5 * last["x"].powi(2)).abs() < 1e-9, "{mass}");
    }
}

/// A claim that holds in one assembly only: ranges of `sample` keep states in it, also after these are brought to the constraints.
#[test]
fn states_on_constraints_lie_in_the_ranges_of_sample() {
    let rhombus = |sample: &str| {
        let text = format!(
            "name: Rhombus\nparameters: {{m: 1 kg, s: 0.5 m, d: 0.3 m, g: 9.81 m/s^2}}\ncoordinates: {{ax: m, ay: m, px: m, py: m}}\n\
             points: {{C: '[d, 0]', A: '[ax, ay]', P: '[px, py]'}}\n\
             bodies: {{a: {{mass: m, position: A}}, p: {{mass: m, position: P}}}}\ngravity: [0, -g]\n\
             constraints: {{ca: 'dot(A-C, A-C) - s^2', pa: 'dot(A-P, A-P) - s^2', rail: py}}\n\
             checks: {{half: 'ax - d = (px - d)/2'}}\n{sample}\n\
             scene: {{start: {{px: 0.9}}, guess: {{ax: 0.6, ay: -0.4}}, until: 0.05}}\n"
        );
        dalembert_symbolic::lower::compile(&text, &[]).map(|_| ())
    };
    rhombus("sample: {px: [0.5, 3]}").unwrap_or_else(|problems| panic!("{problems:?}"));
    let folded = rhombus("").unwrap_err();
    assert!(folded.iter().any(|problem| problem.code == "E502"), "{folded:?}");
}

/// Ranges in which the constraints leave no state are refused.
#[test]
fn ranges_of_sample_without_a_state_are_refused() {
    let text = "name: Out\nparameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2}\ncoordinates: {x: m, y: m}\n\
                bodies: {b: {mass: m, position: '[x, y]'}}\ngravity: [0, -g]\nconstraints: {rod: x^2 + y^2 - l^2}\n\
                sample: {y: [-3, -2]}\nscene: {start: {x: 0.3, x': 0}, guess: {y: -1}, until: 1}\n";
    let refused = dalembert_symbolic::lower::compile(text, &[]).map(|_| ()).unwrap_err();
    assert!(refused.iter().any(|problem| problem.code == "E504" && problem.help.contains("outside")), "{refused:?}");
}
