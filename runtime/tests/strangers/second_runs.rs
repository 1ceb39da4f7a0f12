//! Second runs that began otherwise than the first went on: digits that were lost, and advice that did not fit.

use dalembert::{Cause, Enforcement, Loss, Method, Run, Warning};

use super::{case, folder, program};

/// The run with its digits.
fn judged(text: &str) -> Run {
    let mut case = case(text);
    case.settings.digits = true;
    case.run()
}

/// A dose that a tick adds to what decays.
const DOSE: &str = r#"
name: Dose
states: {z: {unit: 1, rate: -r*z}}
parameters: {r: 1 1/s}
memory: {n: 0}
events: {dose: {every: 1 s, then: {set: {z: z + 1, n: n + 1}}}}
scene: {start: {z: 0}, until: 0.5, tolerance: 1e-11}
"#;

#[test]
fn a_tick_at_the_start_happened_twice_in_a_second_run() {
    // One dose at t = 0: e^−t; with the ticks of 1 s and 2 s as well at t = 2.5.
    for (until, doses, z) in
        [("0.5", 1.0, (-0.5_f64).exp()), ("2.5", 3.0, [-2.5_f64, -1.5, -0.5].map(f64::exp).iter().sum())]
    {
        let run = judged(&DOSE.replace("until: 0.5", &format!("until: {until}")));
        assert!((run.last()["z"] - z).abs() < 1e-10 && run.memory("n") == Some(doses), "{}", run.last()["z"]);
        assert!(run.digits("z").is_some_and(|digits| digits >= 9), "until {until}: {:?}", run.digits("z"));
        assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    }
    // A first tick after the start was right before.
    let later = judged(&DOSE.replace("every: 1 s", "every: 1 s, from: 0.1 s"));
    assert!(
        (later.last()["z"] - (-0.4_f64).exp()).abs() < 1e-10 && later.digits("z").is_some_and(|digits| digits >= 9)
    );
}

/// A ball between walls that touches where it starts and is not held there.
const BETWEEN: &str = r#"
name: Between
parameters: {m: 1 kg, g: 10 m/s^2, e: 1 1, a: 2 m, b: 1 m}
coordinates: {x: m, y: m}
bodies: {ball: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
contacts:
  left: {gap: x, on: ball, normal: "[1, 0]", restitution: e}
  right: {gap: a - x, on: ball, normal: "[-1, 0]", restitution: e}
  down: {gap: y, on: ball, normal: "[0, 1]", restitution: e}
  up: {gap: b - y, on: ball, normal: "[0, -1]", restitution: e}
impacts: sequential
scene: {start: {x: 0, y: 1}, until: 0.4, tolerance: 1e-11}
"#;

#[test]
fn a_second_run_began_inside_a_wall() {
    // It falls from the ceiling along a wall; is thrown from the corner; and, as before, from where nothing touches.
    let fall = |t: f64, y: f64, v: f64| y + v * t - 5.0 * t * t;
    for (start, g, [x, y]) in [
        ("{x: 0, y: 1}", "10", [0.0, fall(0.4, 1.0, 0.0)]),
        ("{x: 0, y: 1, x': 2}", "10", [0.8, fall(0.4, 1.0, 0.0)]),
        ("{x: 0, y: 0, x': -2, y': -1}", "0", [0.8, 0.4]),
        ("{x: 0, y: 0, x': 2, y': 3}", "10", [0.8, fall(0.4, 0.0, 3.0)]),
        ("{x: 2, y: 1, x': 2, y': 2}", "0", [1.2, 0.2]),
        ("{x: 0.5, y: 0.9, x': 2}", "10", [1.3, fall(0.4, 0.9, 0.0)]),
    ] {
        let text = BETWEEN.replace("{x: 0, y: 1}", start).replace("g: 10", &format!("g: {g}"));
        let run = judged(&text);
        let last = run.last();
        assert!((last["x"] - x).abs() < 1e-10 && (last["y"] - y).abs() < 1e-10, "{start}: {} {}", last["x"], last["y"]);
        let digits = ["x", "y"].map(|name| run.digits(name).filter(|_| last[name] != 0.0));
        assert!(digits.iter().flatten().all(|digits| *digits >= 9), "{start}: {digits:?}");
        assert!(run.warnings.is_empty(), "{start}: {:?}", run.warnings);
    }
}

/// A pendulum that starts upright but for a rounding: no second run may agree.
#[test]
fn a_start_that_is_unstable_is_still_told() {
    let run = judged(
        "name: Upright\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}\ncoordinates: {theta: rad}\n\
         bodies: {bob: {mass: m, position: \"l*[sin(theta), -cos(theta)]\"}}\ngravity: [0, -g]\n\
         scene: {start: {theta: pi, theta': 0}, until: 20, tolerance: 1e-11}\n",
    );
    assert!(run.warnings.iter().any(|warning| matches!(warning, Warning::DigitsLost { .. })), "{:?}", run.warnings);
}

#[test]
fn an_impact_at_a_reported_time_took_all_digits() {
    // Thrown up at 3 m/s, with e = 1/2 back at 0.6 s and 0.9 s, which are reported times; 0.1 s after the second landing v = 0.75 − 1.
    let ball = "name: Ball\nparameters: {m: 1 kg, g: 10 m/s^2, e: 0.5 1}\ncoordinates: {y: m}\n\
                bodies: {b: {mass: m, position: \"[0, y]\"}}\ngravity: [0, -g]\n\
                contacts: {floor: {gap: y, on: b, normal: \"[0, 1]\", restitution: e}}\n\
                scene: {start: {y: 0, y': 3}, until: 1, tolerance: 1e-11}\n";
    for every in ["0.1", "0.002", "0.037"] {
        let run = judged(&ball.replace("until: 1", &format!("until: 1, every: {every}")));
        let last = run.last();
        assert!((last["y"] - 0.025).abs() < 1e-12 && (last["y'"] + 0.25).abs() < 1e-12, "{every}");
        let digits = ["y", "y'"].map(|name| run.digits(name).expect("digits"));
        assert!(digits.iter().all(|digits| *digits >= 8), "every {every}: {digits:?}");
        assert!(run.warnings.is_empty(), "every {every}: {:?}", run.warnings);
    }
    // A run that ends at a landing has either speed, as before.
    let until = judged(&ball.replace("until: 1", "until: 0.9"));
    assert!(until.errors("y'").and_then(|errors| errors.last().copied()).is_some_and(|error| error > 1.0));
}

#[test]
fn a_second_run_that_fails_was_said_to_want_a_smaller_tolerance() {
    // A block at the edge of what its force is defined for: a rounding farther there is none.
    let edge = "name: Edge\nparameters: {m: 1 kg, k: 1 N/m^0.5, d: 1 m, g: 10 m/s^2}\ncoordinates: {x: m, y: m}\n\
                bodies: {b: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\n\
                forces: {f: {on: b, force: \"[-k*sqrt(d - x), 0]\"}}\n\
                scene: {start: {x: d, y: 0, y': 1}, until: 2, tolerance: 1e-10}\n";
    let lost = |run: &Run| {
        let why = run.warnings.iter().find_map(|warning| match warning {
            Warning::DigitsLost { why, .. } => Some(*why),
            _ => None,
        });
        why.expect("lost digits")
    };
    let why = lost(&judged(edge));
    assert!(matches!(why, Loss::Fails { t: 0.0, cause: "not finite" }), "{why}");
    // Within it there are digits.
    let run = judged(&edge.replace("x: d", "x: 0.5*d"));
    assert!(run.digits("y").is_some_and(|digits| digits >= 9), "{:?}", run.digits("y"));
}

/// A fall that starts at the zero of an event, from rest or already moving: it has not left it before.
#[test]
fn a_second_run_left_the_zero_of_an_event_at_the_start() {
    const FALL: &str = r#"
name: Fall
parameters: {m: 1 kg, g: 10 m/s^2, h: 5 m}
coordinates: {y: m}
bodies: {b: {mass: m, position: "[0, y]"}}
gravity: [0, -g]
memory: {n: 0}
events: {below: {when: y - h, direction: falling, then: {set: {n: n + 1}}}}
scene: {start: {y: 5}, until: 1}
"#;
    for (start, n) in [("y: 5", 0.0), ("y: 5, y': -1", 0.0), ("y: 5, y': 1", 1.0), ("y: 5.5", 1.0)] {
        let run = judged(&FALL.replace("y: 5}", &format!("{start}}}")));
        let differ = |warning: &Warning| matches!(warning, Warning::EventsDiffer { .. });
        assert!(run.memory("n") == Some(n) && !run.warnings.iter().any(differ), "{start}: {:?}", run.warnings);
    }
}

/// A planet in SI units, whose steps are many seconds long: the second run ended in steps that became shorter and shorter.
#[test]
fn slow_motions_have_digits() {
    const PLANET: &str = r#"
name: Planet
parameters: {GM: 1.327e20 m^3/s^2, M1: 6e24 kg, F: 5e9 N}
coordinates: {r: m, ph: rad}
bodies: {p: {mass: M1, position: "r*[cos(ph), sin(ph)]"}}
potential_energy: -GM*M1/r
forces: {th: {on: p, force: "F*[-sin(ph), cos(ph)]"}}
scene: {start: {r: 1.47e11, ph': 2.06e-7}, until: 8e8, tolerance: 1e-12}
"#;
    for until in ["6e8", "8e8", "1.5e9"] {
        for tolerance in ["1e-10", "1e-11", "1e-12"] {
            let run = judged(&PLANET.replace("8e8, tolerance: 1e-12", &format!("{until}, tolerance: {tolerance}")));
            assert!(
                run.warnings.is_empty() && run.digits("r") >= Some(4),
                "{until} {tolerance}: {:?}",
                run.digits("r")
            );
        }
    }
}

/// An event that ends the run just behind a reported time ends the second run just before it, or the other way round: all digits hold.
#[test]
fn an_end_at_a_reported_time_keeps_its_digits() {
    for tenth in 1..35 {
        let text = format!(
            "name: Free\nparameters: {{m: 1 kg, xq: 3.5 m}}\ncoordinates: {{x: m}}\nbodies: {{b1: {{mass: m, position: '[x, 0]'}}}}\n\
             events: {{quit: {{when: x - xq, direction: rising, then: stop}}}}\nscene: {{start: {{x: {}, x': 1}}, until: 10}}\n",
            f64::from(tenth) / 10.0
        );
        let run = judged(&text);
        assert!(run.digits("x") >= Some(9), "from {tenth}/10: {:?}", run.digits("x"));
    }
}

/// Rounding of forces that cancel each other is the same in both runs: no more digits are promised than it leaves.
#[test]
fn forces_that_cancel_leave_the_digits_that_they_have() {
    let judged = |law: &str, start: &str| {
        judged(&format!(
            "name: Cancel\nparameters: {{g: 9.81, c: 1e-9, e: 1e-9}}\ncoordinates: {{x: }}\nkinetic_energy: x'^2/2\n{law}\n\
             scene: {{start: {{x: {start}}}, until: 5}}\n"
        ))
    };
    let error = |run: &Run| run.errors("x").map_or(f64::NAN, |errors| errors[errors.len() - 1]);
    // e t^2/2, since cos differs from 1 by less than 1e-25.
    let small = judged("generalized_forces: {x: g*cos(c*x) - g + e}", "0");
    let x = 1e-9 * 12.5;
    assert!((small.last()["x"] - x).abs() <= error(&small) && error(&small) < 1e-4 * x, "{}", error(&small));
    // V = 1/2 - x^2/24: 1e-4 cosh(5/sqrt(12)), of which rounding leaves nothing.
    let hill = judged("potential_energy: (1 - cos(x))/x^2", "1e-4");
    assert!(error(&hill) > 1e-5, "{}", error(&hill));
    let still = judged("potential_energy: (1 - cos(x))/x^2", "1e-5");
    assert!(error(&still) > 1e-6, "{}", error(&still));
    // What hangs still has all its digits.
    let hangs = judged("potential_energy: g*x + 3*x^2/2", "-9.81/3");
    assert!(hangs.digits("x").is_some_and(|digits| digits >= 14), "{:?}", hangs.digits("x"));
}

/// Reports every two seconds meet a vibration of that period where its speed is 0: it goes between them all the same.
#[test]
fn what_vanishes_at_all_reports_is_not_lost() {
    let text = "
name: Spring
parameters: {m: 1 kg, k: pi^2 N/m}
coordinates: {x: m}
bodies: {b: {mass: m, position: '[x, 0]'}}
springs: {s: {stretch: x, stiffness: k, along: ground.x, on: b}}
scene: {start: {x: 1}, until: 1000}
";
    let mut case = case(text);
    case.settings.digits = true;
    let run = case.run();
    assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    assert_eq!(run.digits_until(), Some(1000.0));
    assert!((run.last()["x"] - 1.0).abs() < 1e-6 && run.digits("x").expect("digits") >= 5);
}

/// `auto` takes exact propagation here, and another method at the looser tolerance, whose errors say nothing of these.
#[test]
fn a_linear_run_is_compared_with_its_like() {
    let run = judged(
        "name: Bump\ntables: {road: {points: [[0, 0], [1, 0], [1.25, 0.035], [1.5, 0.05], [1.75, 0.035], [2, 0], [3, 0]], units: [m, m], smooth: 1}}\n\
         parameters: {ms: 300 kg, mu: 40 kg, ks: 20 kN/m, cs: 1500 N*s/m, kt: 180 kN/m, ct: 100 N*s/m, V: 36 km/h, g: 9.81 m/s^2}\n\
         coordinates: {zs: m, zu: m}\ninputs: {h: road(V*t)}\n\
         bodies: {body: {mass: ms, position: '[0, zs]'}, wheel: {mass: mu, position: '[0, zu]'}}\n\
         springs: {s: {stretch: zs - zu, stiffness: ks}, t: {stretch: zu - h, stiffness: kt}}\n\
         dampers: {d: {rate: \"zs' - zu'\", damping: cs}, tt: {rate: \"zu' - h'\", damping: ct}}\nscene: {until: 1.5}\n",
    );
    assert_eq!(run.method, Method::Exact);
    let digits = ["zs", "zu", "zs'", "zu'"].map(|name| run.digits(name).unwrap_or(0));
    assert!(digits.iter().all(|digits| *digits >= 4), "{digits:?}");
}

/// A force that goes through thousands, and of which nothing is known where it is 3.6, is not told to be 0.
#[test]
fn what_is_small_beside_its_peaks_and_unknown_is_not_0() {
    let text = "name: FourBar\nparameters: {s: 1 m, rho: 1 kg/m, k: 10 1/s^2, w: 0.3 1/s}\n\
        coordinates: {p: rad, x1: m, y1: m, x2: m, y2: m}\n\
        points: {D: 's*[4, 0]', B: 's*[cos(p), sin(p)]', C: '[x1, y1]', C2: '[x2, y2]'}\n\
        bodies: {AB: {mass: rho*s, inertia: rho*s^3/12, angle: p, position: B/2}, mc: {mass: 2*rho*s, position: C}, md: {mass: 3*rho*s, position: C2}}\n\
        gravity: ['0', '-k*s']\n\
        constraints: {bc: 'dot(C - B, C - B) - 16*s^2', cd: 'dot(C2 - D, C2 - D) - 9*s^2', cc: 'dot(C2 - C, C2 - C) - s^2'}\n\
        outputs: {f: reaction(bc)/rho}\n\
        scene: {start: {p: 1.5, p': 2, x1': s*w, x1: 3.9*s}, guess: {y1: 2.8*s, x2: 4.2*s, y2: 2.9*s}, until: 4, tolerance: 1e-9}\n";
    let path = folder("peaks").join("four_bar.yaml");
    std::fs::write(&path, text).expect("written");
    let told = program(&["simulate", path.to_str().expect("a path")]).expect("a run");
    assert!(told.contains("  f = ? m/s^2\n"), "{told}");
}

/// M has a condition of 2e14: accelerations keep five digits and fewer, whichever way they are computed.  Reference: the same equations solved with
/// 60 digits.
#[test]
fn an_ill_conditioned_inertia_under_a_constraint_leaves_few_digits() {
    let run = judged(
        "name: Scattered\ncoordinates: {q0: 1, q1: 1, q2: 1, q3: 1, q4: 1, q5: 1, q6: 1, q7: 1}\n\
         kinetic_energy: \"1.41426e-08/2*q0'^2 + 0.729184/2*q1'^2 + 8.29811/2*q2'^2 + 0.00754486/2*q3'^2 \
         + 3.00631e-08/2*(-5.29854*q1' - 0.134415*q2' + q4')^2 + 1.88457e-07/2*(-0.135388*q1' - 0.162577*q3' - 0.984539*q4' + q5')^2 \
         + 2389.41/2*(-0.341908*q1' - 0.134947*q3' - 5.42323*q4' - 0.086414*q5' + q6')^2 \
         + 1.13801e-06/2*(0.44081*q0' - 0.0467602*q1' - 1.68362*q3' + 4.01931*q5' + q7')^2\"\n\
         generalized_forces: {q0: 2.58094, q1: 6.29918, q2: 3.91264, q3: 7.38288, q4: -2.87186, q5: 1.06083, q6: -3.88957, q7: 3.08574}\n\
         constraints: {c: 2.82454*q0 + 0.0131775*q3 - 1.92613*q4 - 0.0263282*q5 + 15.3228*q6 - 6.13598*q7 - 0.459718*t^2/2}\n\
         outputs: {a0: \"q0''\", a1: \"q1''\", a2: \"q2''\", a3: \"q3''\", a4: \"q4''\", a5: \"q5''\", a6: \"q6''\", a7: \"q7''\", c: reaction(c)}\n\
         scene: {start: {q0: 0}, until: 0}\n",
    );
    let expected = [
        215438388.80522,
        7.1280631953677,
        0.46805169467203,
        1169.533281008554,
        -7101184.08028756,
        -23462374.28003615,
        -40538671.88813337,
        267915.770834,
        0.33026429250282,
    ];
    let end = run.last();
    for (name, expected) in ["a0", "a1", "a2", "a3", "a4", "a5", "a6", "a7", "c"].into_iter().zip(expected) {
        let missed = (end[name] / expected - 1.0).abs();
        let digits = run.digits(name).expect("digits");
        assert!(missed < 10.0_f64.powi(1 - digits as i32), "{name}: {} with {digits} digits, {expected}", end[name]);
    }
    assert!(run.digits("a2").is_some_and(|digits| digits >= 5), "{:?}", run.digits("a2"));
}

/// A filter of 0.02 s limits the steps of an explicit method: between their ends states are as good as at them.  Reference: the exact propagation of the
/// same linear system.
#[test]
fn states_between_steps_that_stability_limits_are_as_good_as_at_their_ends() {
    let text = "name: Filtered\nparameters: {m: 1 kg, k: 43 N/m, tau: 0.02 s, Kd: 8 N*s/m}\ncoordinates: {x: m}\n\
        states: {f: {unit: m, rate: (x - f)/tau}}\nkinetic_energy: m*x'^2/2\npotential_energy: k*x^2/2\n\
        generalized_forces: {x: -Kd*f'}\nscene: {start: {x: 1, f: 1}, until: 5, tolerance: 1e-11}\n";
    let by = |method: Method| {
        let mut case = case(text);
        (case.settings.method, case.settings.every) = (method, Some(0.05));
        case.run()
    };
    let (exact, found) = (by(Method::Exact), by(Method::Dop853));
    let states = exact.states().zip(found.states());
    let off = states.map(|(exact, found)| (exact["x"] - found["x"]).abs()).fold(0.0, f64::max);
    assert!(off < 1e-9, "{off:e}");
    assert!(found.work.steps < 200, "{} steps", found.work.steps);
}

/// A bead on a figure of eight, x = sin u, y = sin u cos u, passes the node, where its constraint has no gradient.
const EIGHT: &str = r#"
name: Eight
parameters: {m: 1 kg, g: 9.81 m/s^2, a: 1 m}
coordinates: {x: m, y: m}
bodies: {bead: {mass: m, position: "[x, y]"}}
gravity: "[0, -g]"
constraints: {c: "x^4 - a^2*(x^2 - y^2)"}
scene: {start: {x: 0.9, y: "0.9*sqrt(0.19)", x': -3}, until: 1.5, tolerance: 1e-11}
"#;

#[test]
fn what_a_singular_position_takes_from_the_energy_is_missing_on_all_the_way_after_it() {
    // u'' of the angle in 30 digits, by Taylor series.
    let known =
        [("x", -0.999551409441948), ("y", 0.0299361872940607), ("x'", 0.175685880572294), ("y'", 5.85552314347691)];
    for tolerance in [1e-7, 1e-9, 1e-11, 1e-13] {
        let run = judged(&EIGHT.replace("1e-11", &format!("{tolerance:e}")));
        for (name, value) in known {
            let (error, bound) = ((run.last()[name] - value).abs(), *run.errors(name).expect("bounds").last().unwrap());
            assert!(error <= bound, "{tolerance:e}: {name} is off by {error:e}, more than {bound:e}");
            assert!(bound < 1e-3, "{tolerance:e}: {name} known to {bound:e} only");
        }
    }
}

#[test]
fn coordinates_that_pivots_choose_turned_off_at_crossing_lines() {
    let crossing = "name: Crossing\nparameters: {m: 1 kg}\ncoordinates: {x: m, y: m}\nbodies: {b: {mass: m, position: '[x, y]'}}\n\
        constraints: {c: (0.8*x + 0.6*y)*(0.8*y - 0.6*x)}\n\
        scene: {start: {x: -0.8, y: -0.6, x': 0.8, y': 0.6}, until: 3, tolerance: 1e-10}\n";
    let run = judged(crossing);
    assert!((run.last()["x"] - 1.6).abs() < 1e-6 && (run.last()["y"] - 1.2).abs() < 1e-6, "{:?}", run.last());
    let mut case = case(crossing);
    case.settings.enforcement = Enforcement::NullSpace;
    let error = case.try_run().expect_err("no motion");
    assert!(matches!(error.cause(), Some(Cause::SingularConfiguration { .. })), "{error}");
}

/// What a motion becomes that grows from 1e-5 is no measure of the roundings of its start, and it does not begin at rest.
#[test]
fn what_grows_has_the_digits_of_its_start() {
    let file = "name: Grow\nparameters: {m: 1 kg, k: 1 N/m}\ncoordinates: {x: m}\nkinetic_energy: m*x'^2/2\npotential_energy: -k*x^2/2\n\
        scene: {start: {x: 1e-5}, until: 60, tolerance: 1e-11}\n";
    let run = judged(file);
    let (x, known) = (run.last()["x"], 1e-5 * 60.0_f64.cosh());
    assert!((x / known - 1.0).abs() < 1e-9, "{x} {known}");
    assert!(
        run.digits("x").is_some_and(|digits| digits >= 7) && run.warnings.is_empty(),
        "{:?} {:?}",
        run.digits("x"),
        run.warnings
    );
}

/// Both runs find the instant at which forces cancel by the same roundings, which are no digits of it.
#[test]
fn an_instant_that_two_runs_share_is_known_to_its_roundings() {
    let file = "name: Pulled\nparameters: {m: 3 kg, mu: 0.2 1, g: 9.81 m/s^2, r: 4 N/s, h: 0.5 s}\ncoordinates: {x: m, y: m}\n\
        bodies: {b: {mass: m, position: '[x, y]'}}\ngravity: '[0, -g]'\nforces: {pull: {on: b, force: '[r*t, 0]'}}\n\
        contacts: {floor: {gap: y, on: b, normal: '[0, 1]', friction: mu}}\nevents: {half: {when: t - h, then: record}}\n\
        scene: {start: {}, until: 2, tolerance: 1e-11}\n";
    let path = folder("instants").join("pulled.yaml");
    std::fs::write(&path, file).expect("a file");
    let printed = program(&["simulate", path.to_str().expect("a path")]).expect("a run");
    assert!(printed.contains("slips at t = 1.4715000000000\n"), "{printed}");
    assert!(printed.contains("half at t = 0.5\n"), "{printed}");
}

/// A second run cannot be ten times as coarse as one that is as coarse as can be.
#[test]
fn a_tolerance_that_no_second_run_exceeds_promises_nothing() {
    let file = "name: Swing\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\npotential_energy: x^2/2\n\
        events: {up: {when: x, direction: rising, then: record}}\nscene: {start: {x: 1}, until: 10}\n";
    let path = folder("coarse").join("swing.yaml");
    std::fs::write(&path, file).expect("a file");
    for tolerance in ["0.2", "1"] {
        let printed = program(&["simulate", path.to_str().expect("a path"), "--tolerance", tolerance]).expect("a run");
        assert!(printed.contains("x = ?") && !printed.contains("up at t = 4"), "{printed}");
    }
}

/// What sticks and slips forgets how it began: at a loose tolerance two runs differ by the steps that a moved start takes, not by its growth.
#[test]
fn what_sticks_and_slips_is_not_chaotic() {
    let file = "name: Rub\nparameters: {m: 1 kg, M: 1e-4 kg, k: 20 N/m, v: 0.3 m/s, g: 9.81 m/s^2, mu: 0.3 1, mus: 0.5 1, K: 1e4 N/m, c: 50 N*s/m}\n\
        coordinates: {x: m, z: m}\nbodies: {b: {mass: m, position: '[x, 0]'}, e: {mass: M, position: '[x + z, 0]'}}\n\
        springs: {s: {stretch: x, stiffness: k, on: b, along: '[1, 0]'}, s2: {stretch: z, stiffness: K, on: e, from: b, along: '[1, 0]'}}\n\
        dampers: {d2: {rate: z', damping: c, on: e, from: b, along: '[1, 0]'}}\n\
        friction: {rub: {rate: x' - v, on: b, along: '[1, 0]', limit: mu*m*g, static: mus*m*g}}\n\
        scene: {start: {x: 0, x': 0.3}, until: 20, tolerance: 1e-3}\n";
    let run = judged(file);
    let is_chaotic = |warning: &Warning| matches!(warning, Warning::DigitsLost { why: Loss::Instability { .. }, .. });
    assert!(!run.warnings.iter().any(is_chaotic), "{:?}", run.warnings);
}

/// A block on a rail that two rows hold: what they hold turns by rounding alone, which says nothing of how fast the block swings.  x = 5 cos(t/√2).
#[test]
fn what_is_held_takes_no_digits_from_what_moves() {
    let file = "name: Rail\nparameters: {m: 2 kg, k: 1 N/m, l1: 0.5 m, l2: 0.2 m, g: 9.81 m/s^2}\ncoordinates: {x: m, y: m, th: rad}\n\
        bodies: {b: {mass: m, inertia: 0.3, angle: th, position: '[x, y]'}}\ngravity: [0, -g]\n\
        constraints: {p1: y - l1*sin(th), p2: y + l2*sin(th)}\nsprings: {s: {stretch: x, stiffness: k, on: b, along: ground.x}}\n\
        scene: {start: {x: 5}, until: 1, tolerance: 1e-10}\n";
    let path = folder("rail").join("rail.yaml");
    std::fs::write(&path, file).expect("a file");
    let printed = program(&["simulate", path.to_str().expect("a path")]).expect("a run");
    assert!(printed.contains("x = 3.80122298") && printed.contains("x' = -2.29681342"), "{printed}");
}

/// A run that goes on from a saved state knows no more of it than the run that led there.
#[test]
fn what_follows_a_saved_state_has_its_errors() {
    let folder = folder("saved_errors");
    let (path, saved) = (folder.join("swing.yaml"), folder.join("saved.yaml"));
    let [path, saved] = [&path, &saved].map(|path| path.to_str().expect("a path"));
    let file = "name: Swing\nparameters: {g: 9.81 m/s^2, l: 1 m}\ncoordinates: {th: rad}\nkinetic_energy: l^2*th'^2/2\n\
        potential_energy: -g*l*cos(th)\nscene: {start: {th: 2.5}, until: 4}\n";
    std::fs::write(path, file).expect("a file");
    let angle = |arguments: &[&str]| {
        let told = program(&[&["simulate", path], arguments].concat()).expect("a run");
        let line = told.lines().find(|line| line.starts_with("  th = ")).expect("the angle").to_owned();
        line.split(' ').nth(4).expect("a number").to_owned()
    };
    angle(&["--until", "2", "--tolerance", "1e-4", "--save", saved]);
    let told = angle(&["--state", saved, "--until", "4", "--tolerance", "1e-12"]);
    let whole: f64 = angle(&["--tolerance", "1e-12"]).parse().expect("a number");
    let decimals = told.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let unit = 0.1_f64.powi(i32::try_from(decimals).expect("few"));
    assert!((told.parse::<f64>().expect("a number") - whole).abs() <= unit, "{told} for {whole}");
    assert!((1..8).contains(&decimals), "{told}");
}

/// What nothing moves stays at the top, and a disturbance would not; at the bottom, and where a run is shorter than disturbances need to grow, nothing is to
/// be told.
#[test]
fn a_rest_at_zero_that_is_unstable_is_told() {
    let rod = |up: &str, more: &str, until: &str| {
        format!(
            "name: T\nparameters: {{m: 1 kg, l: 1 m, g: 10 m/s^2}}\ncoordinates: {{th: rad}}\n\
             bodies: {{b: {{mass: m, inertia: m*l^2/12, angle: th, position: '{up}*l/2*[-sin(th), cos(th)]'}}}}\n\
             gravity: [0, -g]\n{more}scene: {{start: {{th: 0}}, until: {until}}}\n"
        )
    };
    let time = |text: &str| {
        judged(text).warnings.into_iter().find_map(|warning| match warning {
            Warning::StaysUnstably { time } => Some(time),
            _ => None,
        })
    };
    // m l²/3 θ'' = m g l/2 θ.
    let expected = (1.0_f64 / 15.0).sqrt();
    let told = time(&rod("1", "", "1")).expect("a warning");
    assert!((told - expected).abs() < 1e-12, "{told}");
    assert_eq!(time(&rod("1", "", "0.2")), None);
    assert_eq!(time(&rod("-1", "", "1e9")), None);
    // Free to drift, which is no growth; and held by friction.
    assert_eq!(
        time(
            "name: T\ncoordinates: {x: 1, y: 1}\nkinetic_energy: (x'^2 + y'^2)/2\npotential_energy: x^2/2\nscene: {until: 1e12}\n"
        ),
        None
    );
    let rub = "friction: {rub: {rate: \"th'\", limit: 1 N*m}}\n";
    assert_eq!(time(&rod("1", rub, "1")), None);
}
