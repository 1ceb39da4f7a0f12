//! What a run says of itself: digits, drift, and what is left out.

use dalembert::{Loss, Method, Run, Warning};

use super::{Case, coasting, file, sprung};

fn lost(case: &mut Case) -> Option<(f64, Loss)> {
    case.settings.digits = true;
    case.run().warnings.iter().find_map(|warning| match warning {
        Warning::DigitsLost { t, why, .. } => Some((*t, *why)),
        _ => None,
    })
}

/// A double pendulum with m = l = 1 and g = 9.81, at rest at these angles.
fn double_pendulum(angle: &str, until: &str) -> Case {
    file(&format!(
        "name: D
parameters: {{m: 1 kg, l: 1 m, g: 9.81 m/s^2}}
coordinates: {{a: rad, b: rad}}
gravity: [0, -g]
points: {{elbow: \"l*[sin(a), -cos(a)]\"}}
bodies: {{upper: {{mass: m, position: elbow}}, lower: {{mass: m, position: \"elbow + l*[sin(b), -cos(b)]\"}}}}
scene: {{start: {{a: {angle} rad, b: {angle} rad}}, until: {until}, tolerance: 1e-12}}"
    ))
}

/// Catalogue N1: from (2, 2) rad differences grow by e in 1/1.3 s, and 1e-12 becomes 0.1 within 19.5 s; from 0.5 rad
/// the motion is regular.
#[test]
fn chaos_is_named_with_the_time_until_which_digits_hold() {
    let Some((t, Loss::Instability { growth })) = lost(&mut double_pendulum("2", "40")) else {
        panic!("chaos was not named");
    };
    assert!((12.0..30.0).contains(&t) && growth > 1e8, "{t} {growth:e}");
    assert_eq!(lost(&mut double_pendulum("0.5", "40")), None);
}

/// Where the motion settles steps grow until stability limits them, and are poor between their ends: who judges the digits
/// keeps shorter ones.
#[test]
fn what_has_settled_keeps_the_digits_of_its_tolerance() {
    for (start, tolerance) in [("-0.1", 1e-6), ("-1e-3", 1e-6), ("0", 1e-6), ("0", 1e-8), ("-3", 1e-10)] {
        let mut case = file(&format!(
            "name: Drag
parameters: {{m: 1 kg, c: 0.5 kg/m, g: 9.81 m/s^2}}
coordinates: {{y: m}}
kinetic_energy: m*y'^2/2
potential_energy: m*g*y
generalized_forces: {{y: \"-c*y'*abs(y')\"}}
scene: {{start: {{y: 0, y': {start}}}, until: 10, tolerance: {tolerance:e}}}"
        ));
        (case.settings.digits, case.settings.method) = (true, Method::Dop853);
        let run = case.run();
        case.settings.tolerance = 1e-13;
        let exact = case.run().last();
        for name in ["y", "y'"] {
            let (promised, error) =
                (*run.errors(name).unwrap().last().unwrap(), (run.last()[name] - exact[name]).abs());
            assert!(error <= 3.0 * promised, "{start}, {tolerance:e}: {name} off by {error:e}, not {promised:e}");
            assert!(promised < 400.0 * tolerance * exact[name].abs(), "{start}, {tolerance:e}: {name} {promised:e}");
        }
    }
}

#[test]
fn a_start_that_only_rounding_moves_is_named() {
    let pendulum = |theta: &str| {
        file(&format!(
            "name: U
parameters: {{m: 1 kg, l: 1 m, g: 9.81 m/s^2}}
coordinates: {{theta: rad}}
gravity: [0, -g]
bodies: {{bob: {{mass: m, position: \"l*[sin(theta), -cos(theta)]\"}}}}
scene: {{start: {{theta: \"{theta}\"}}, until: 20, tolerance: 1e-10}}"
        ))
    };
    assert!(matches!(lost(&mut pendulum("pi")), Some((_, Loss::UnstableStart))));
    assert_eq!(lost(&mut pendulum("3")), None);
}

#[test]
fn a_fixed_step_that_is_too_coarse_is_named() {
    let mut coarse = sprung("scene: {start: {x: 1}, until: 200}");
    coarse.settings.step = Some(1.2);
    assert!(matches!(lost(&mut coarse), Some((_, Loss::CoarseStep { .. }))));
    let mut fine = sprung("scene: {start: {x: 1}, until: 200}");
    fine.settings.step = Some(0.05);
    assert_eq!(lost(&mut fine), None);
}

/// A nanometre beside a metre: every component by its own scale.
#[test]
fn a_small_motion_beside_a_large_one_is_followed() {
    let two = |u: &str, unit: f64| {
        let mut case = file(&format!(
            "name: Two
parameters: {{m: 1, k: 1, mu: 1e-6, kappa: 1e-4}}
coordinates: {{x: 1, u: 1}}
bodies: {{big: {{mass: m, position: \"[x, 0]\"}}, tip: {{mass: mu, position: \"[0, u]\"}}}}
springs:
  s: {{stretch: x, stiffness: k, along: \"[1, 0]\", on: big}}
  t: {{stretch: u, stiffness: kappa, along: \"[0, 1]\", on: tip}}
conserved: {{energy: energy, tip: \"mu*u'^2/2 + kappa*u^2/2\"}}
scene: {{start: {{x: 1, u: {u}}}, until: 100, tolerance: 1e-10}}"
        ));
        let run = case.run();
        // κ/μ = 100 1/s².
        let (found, expected) = (run.last()["u"] / unit, 1000.0_f64.cos());
        assert!(
            (found - expected).abs() < 1e-6 && run.warnings.is_empty(),
            "{u}: {found} {expected} {:?}",
            run.warnings
        );
    };
    two("1e-9", 1e-9);
    two("1", 1.0);
}

/// Runs whose digits come from steps that only stops and their growth limit promise no more than holds.
#[test]
fn steps_that_the_tolerance_does_not_limit_promise_no_more_than_holds() {
    for tolerance in [1e-4, 1e-6, 1e-8, 1e-10] {
        let run = |tolerance: f64| {
            let text = "forces: {f: {on: b, force: \"[-0.3*F*abs(x - 0.4), 0]\"}}
scene: {start: {x: 0, x': 1}, until: 0.9}";
            let mut case = coasting(text).tolerance(tolerance);
            case.settings.digits = true;
            case.run()
        };
        let (found, exact) = (run(tolerance), run(1e-14));
        let error = (found.last()["x"] - exact.last()["x"]).abs();
        let promised = found.errors("x").unwrap()[found.len() - 1];
        assert!(error <= 3.2 * promised, "{tolerance:e}: {error:e} {promised:e}");
    }
}

/// Stops that cut a fixed step cut that of the second run to the same length, and so does the end.
#[test]
fn fixed_steps_that_stops_cut_promise_no_more_than_holds() {
    let pushed = "forces: {f: {on: b, force: \"[F*(step(t - 1) - step(t - 2) + step(t - 3)), 0]\"}}
scene: {start: {x: 1}, until: 4}";
    let exact = sprung(pushed).tolerance(1e-13).run().last()["x"];
    for (method, steps) in [
        (Method::Gauss4, [1.0, 20.0, 0.05]),
        (Method::Gauss2, [1.0, 3.0, 0.05]),
        (Method::Rk4, [1.0, 1.5, 0.05]),
        (Method::Euler, [1.0, 7.0, 0.01]),
        (Method::Radau5, [1.0, 4.0, 0.05]),
    ] {
        for step in steps {
            let mut case = sprung(pushed);
            (case.settings.digits, case.settings.method, case.settings.step) = (true, method, Some(step));
            let found = case.run();
            let (error, promised) = ((found.last()["x"] - exact).abs(), found.errors("x").unwrap()[found.len() - 1]);
            assert!(error <= promised, "{method} {step}: {error:e} {promised:e}");
            assert!(step > 0.1 || method == Method::Euler || promised < 0.02, "{method} {step}: {promised:e}");
        }
    }
}

/// The error at the end of x, of which a run at this tolerance promises so much, and the evaluations of both.
fn promise(case: impl Fn() -> Case, tolerance: f64) -> (f64, f64, [u64; 2]) {
    let run = |tolerance: f64| {
        let mut case = case().tolerance(tolerance);
        case.settings.digits = true;
        case.run()
    };
    let (found, exact) = (run(tolerance), run(1e-13));
    let error = (found.last()["x"] - exact.last()["x"]).abs();
    let companions = found.digits.as_ref().map_or(0, |digits| digits.evaluations);
    (error, found.errors("x").unwrap()[found.len() - 1], [found.work.evaluations, companions])
}

/// Runs that are cut at the features of a force share no steps with those that judge them; an ordinary one is judged by a
/// single run, which is cheaper.
#[test]
fn steps_that_features_limit_promise_no_more_than_holds() {
    let forced =
        |force: &str, scene: &str| format!("forces: {{f: {{on: b, force: \"[{force}, 0]\"}}}}\nscene: {{{scene}}}");
    let of_time = forced("0.0087*F*2/pi*atan((t - 37.8)/5e-4)", "start: {x: 0, x': 1.4}, until: 49");
    let zone = forced("-40*F/(1 + ((x + 0.2)/1.6e-6)^2)", "start: {x: 0.5}, until: 21");
    let softened = forced("-6*F*atan((x - 0.4)/0.04)", "start: {x: 2.6}, until: 21.5");
    let pulse = forced("500*F*(1 - tanh((x - 0.4)/6e-6)^2)", "start: {x: 2.8}, until: 21");
    for tolerance in [1e-4, 3e-5, 1e-6, 1e-8] {
        for text in [&of_time, &zone, &softened, &pulse] {
            let case = || if *text == of_time { coasting(text) } else { sprung(text) };
            let (error, promised, _) = promise(case, tolerance);
            assert!(error <= 3.2 * promised, "{text}, {tolerance:e}: {error:e} {promised:e}");
        }
    }
    let smooth = forced("-0.3*F*x^3", "start: {x: 1}, until: 21");
    let (error, promised, [run, companions]) = promise(|| sprung(&smooth), 1e-10);
    assert!(error <= promised && promised < 300.0 * error, "{error:e} {promised:e}");
    assert!(companions < run, "{companions} {run}");
}

/// Inputs that switch the energy of a constant force, and a bump in the road, raise no alarm in correct runs.
#[test]
fn correct_runs_raise_no_alarm_of_energy() {
    let square = sprung(
        "inputs: {u: \"F*sign(t)\"}\nforces: {f: {on: b, force: \"[u, 0]\"}}\nscene: {start: {x: 0}, until: 10}",
    )
    .run();
    assert!((square.last()["x"] - (1.0 - 10.0_f64.cos())).abs() < 1e-6, "{}", square.last()["x"]);
    assert_eq!(square.warnings, []);
    let bump = file(
        "name: Bump
parameters: {ms: 320 kg, mu: 45 kg, ks: 22 kN/m, kt: 190 kN/m, cs: 1.5 kN*s/m, h: 10 cm, t1: 5 s, t2: 5.2 s}
coordinates: {zs: m, zu: m}
inputs: {road: h*exp(-((t - t1)/(t2 - t1))^2)}
bodies: {body: {mass: ms, position: [0, zs]}, wheel: {mass: mu, position: [0, zu]}}
springs:
  strut: {stretch: zs - zu, stiffness: ks, on: body, from: wheel, along: [0, 1]}
  tyre: {stretch: zu - road, stiffness: kt, on: wheel, along: [0, 1]}
dampers: {shock: {rate: zs' - zu', damping: cs, on: body, from: wheel, along: [0, 1]}}
scene: {until: 6}",
    )
    .run();
    assert_eq!(bump.warnings, []);
}

/// Twenty thousand events with a thousand outputs each: so many as 160 MB hold are kept, and the rest is said to be left
/// out.
#[test]
fn events_stay_bounded_and_what_is_left_out_is_said() {
    let ticks = |rate: &str, outputs: usize| {
        let list: Vec<String> = (0..outputs).map(|i| format!("o{i}: x + {i}")).collect();
        coasting(&format!(
            "outputs: {{o: x{}{}}}
events: {{tick: {{when: \"sin({rate}*x)\", then: record}}}}
scene: {{start: {{x: 0.1, x': 1}}, until: 1000, every: 100, tolerance: 1e-6}}",
            if list.is_empty() { "" } else { ", " },
            list.join(", ")
        ))
        .run()
    };
    let left_out = |run: &dalembert::Run| {
        run.warnings.iter().find_map(|warning| match warning {
            Warning::EventsEnd { t, kept } => Some((*t, *kept)),
            _ => None,
        })
    };
    let few = ticks("70", 0);
    assert_eq!((few.events.len(), left_out(&few)), (22_281, None));
    let many = ticks("70", 1000);
    let (t, kept) = left_out(&many).expect("a word on what is left out");
    assert_eq!(many.events.len(), kept);
    assert!(
        (18_000..20_000).contains(&kept) && (t - kept as f64 * std::f64::consts::PI / 70.0).abs() < 1.0,
        "{kept} {t}"
    );
    // The motion itself goes on.
    assert!((many.last()["x"] - 1000.1).abs() < 1e-3);
}

/// x = cos t: it is zero at π/2, where x'/x has a pole.
fn swinging(until: &str, then: &str) -> Run {
    swinging_past("x", until, then)
}

/// The same with an event where a function vanishes.
fn swinging_past(when: &str, until: &str, then: &str) -> Run {
    let mut case = file(&format!(
        "name: S
coordinates: {{x: 1}}
kinetic_energy: x'^2/2
potential_energy: x^2/2
outputs: {{ratio: x'/x, speed: 2*x'}}
events: {{zero: {{when: {when}, then: {then}}}}}
scene: {{start: {{x: 1}}, until: {until}, tolerance: 1e-6}}"
    ));
    (case.settings.digits, case.settings.method) = (true, Method::Dop853);
    case.run()
}

#[test]
fn a_quotient_by_what_vanishes_where_the_run_ends_has_no_digits() {
    let stopped = swinging("5", "stop");
    assert_eq!(stopped.digits("ratio"), Some(0), "{:?}", stopped.last());
    assert!(stopped.digits("speed").unwrap() >= 5);
    let before = swinging("1.4", "stop");
    assert!(before.digits("ratio").unwrap() >= 4, "{:?}", before.errors("ratio").unwrap().last());
}

#[test]
fn a_crossing_nearer_to_the_end_than_the_error_is_told() {
    let told = |until: f64, then: &str| {
        let run = swinging(&until.to_string(), then);
        run.warnings.iter().any(|warning| matches!(warning, Warning::EventNearEnd { .. }))
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    // The run is off by 4e-10 there.
    for near in [-1e-10, 1e-10] {
        assert!(told(quarter + near, "record"), "{near}");
    }
    for far in [-1e-3, 1e-3, 0.5] {
        assert!(!told(quarter + far, "record"), "{far}");
    }
    // It ends the run.
    assert!(!told(5.0, "stop"));
}

#[test]
fn an_event_that_turns_back_nearer_to_zero_than_the_error_is_told() {
    let grazes = |when: &str| {
        let run = swinging_past(when, "5", "record");
        let at = run.warnings.iter().find_map(|warning| match warning {
            Warning::EventGrazes { t, .. } => Some(*t),
            _ => None,
        });
        (at, run.events.len())
    };
    // x turns back at −1: two crossings, or none, that a millionth decides.
    for (when, events) in [("x + 1 - 1e-9", 2), ("x + 1 + 1e-9", 0)] {
        let (at, found) = grazes(when);
        assert!((at.unwrap() - std::f64::consts::PI).abs() < 1e-3, "{when}");
        // Whatever was found, it is not promised.
        assert!(found == events || found == 2 - events, "{when}: {found}");
    }
    for (when, events) in [("x + 1 - 1e-2", 2), ("x + 1 + 1e-2", 0), ("sin(20*x)", 21)] {
        assert_eq!(grazes(when), (None, events), "{when}");
    }
}

/// Between two crossings of one direction there is one of the other.
#[test]
fn crossings_of_one_direction_do_not_graze() {
    for direction in ["rising", "falling", "both"] {
        let mut case = file(&format!(
            "name: S
coordinates: {{x: 1}}
kinetic_energy: x'^2/2
potential_energy: x^2/2
events: {{zero: {{when: x, direction: {direction}, then: record}}}}
scene: {{start: {{x: 1}}, until: 40, tolerance: 1e-6}}"
        ));
        (case.settings.digits, case.settings.method) = (true, Method::Dop853);
        let run = case.run();
        assert!(run.events.len() >= 6 && run.warnings.is_empty(), "{direction}: {:?}", run.warnings);
    }
}

/// A block hangs at rest, held by a stiff spring, until it is pushed: rounding moves it to and fro through v = 0, where the drag
/// v |v| has a corner, and nothing pushes back from both sides.
#[test]
fn what_stands_still_under_drag_does_not_chatter() {
    let mut hung = file(
        "name: Hung
parameters: {m: 300, e: 0.05, k: 2e4, p: 8e4, c: 1200, C: 1e-3, g: 9.81}
coordinates: {x: 1, z: 1}
bodies: {b: {mass: m, position: \"[0, x]\"}, s: {mass: e, position: \"[0, x + z]\"}}
gravity: [0, -g]
springs:
  one: {stretch: x, stiffness: k, along: \"[0, 1]\", on: b}
  pin: {stretch: z, stiffness: p, along: \"[0, 1]\", on: s, from: b}
dampers: {one: {rate: \"x'\", damping: c, along: \"[0, 1]\", on: b}}
forces: {air: {on: b, force: \"[0, -C*x'*abs(x')]\"}, push: {on: b, force: \"[0, 1e3*exp(-((t - 5)/0.1)^2)]\"}}
scene: {start: {x: -(m + e)*g/k, z: -e*g/p}, until: 10, tolerance: 1e-9}",
    );
    for tolerance in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12] {
        hung.settings.tolerance = tolerance;
        let run = hung.run();
        // As tighter tolerances have it.
        let highest = run.column("x").unwrap().into_iter().fold(f64::NEG_INFINITY, f64::max);
        assert!(tolerance > 1e-4 || (highest + 0.10327).abs() < 1e-4, "{tolerance}: {highest}");
    }
}

/// A height of 5e-15 m is what is left of 1 − 1: two runs agree to all digits, and know one.  Written without a difference it
/// has those of the angle.
#[test]
fn digits_that_cancel_are_not_promised() {
    for angle in [1e-2, 1e-4, 1e-6] {
        let mut case = file(&format!(
            "name: Small
parameters: {{m: 1 kg, l: 1 m, g: 10 m/s^2}}
coordinates: {{a: rad}}
bodies: {{bob: {{mass: m, position: \"l*[sin(a), -cos(a)]\"}}}}
gravity: [0, -g]
outputs: {{height: l*(1 - cos(a)), without: 2*l*sin(a/2)^2}}
scene: {{start: {{a: {angle:e}}}, until: 3, tolerance: 1e-11}}"
        ));
        case.settings.digits = true;
        let run = case.run();
        let promised = |name: &str| *run.errors(name).unwrap().last().unwrap();
        let (height, exact) = (run.last()["height"], run.last()["without"]);
        assert!((height - exact).abs() <= promised("height"), "{angle:e}: {height:e} {exact:e}");
        assert!(
            promised("height") < 1e-15 + 1e-8 * exact && promised("without") < 1e-8 * exact,
            "{angle:e}: {exact:e}"
        );
    }
}

/// Of M = [m + e, m; m, m] the sum m + e keeps three digits of e beside m: both runs share what it has lost, and vibrate alike at the
/// wrong frequency.
#[test]
fn an_inertia_that_is_a_small_difference_costs_digits() {
    for e in [3e-6_f64, 3e-8, 3e-10] {
        let mut case = file(&format!(
            "name: Light
parameters: {{m: 1, e: {e:e}, k: 1}}
coordinates: {{x: 1, y: 1}}
kinetic_energy: m*(x' + y')^2/2 + e*y'^2/2
potential_energy: k*x^2/2
scene: {{start: {{x: 0.5, y: 1}}, until: 0.01, tolerance: 1e-10}}"
        ));
        case.settings.digits = true;
        let run = case.run();
        // x'' = −k (1/m + 1/e) x.
        let exact = 0.5 * (0.01 * (1.0 + 1.0 / e).sqrt()).cos();
        let (error, promised) = ((run.last()["x"] - exact).abs(), *run.errors("x").unwrap().last().unwrap());
        assert!(error <= promised && promised < 0.1, "{e:e}: off by {error:e}, not {promised:e}");
    }
}

/// Friction that is regularised vanishes with the speed, however thin its layer is: it is no force that loses its direction.
#[test]
fn a_thin_layer_of_friction_is_run_through() {
    for (layer, tolerances) in [("1e-3", &[1e-6, 1e-7, 1e-9, 1e-10][..]), ("1e-4", &[1e-6, 1e-9])] {
        for tolerance in tolerances {
            let mut case = file(&format!(
                "name: Layer
parameters: {{m: 1 kg, mu: 0.3, g: 10 m/s^2, v0: {layer} m/s}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
forces: {{f: {{on: b, force: \"-mu*m*g*velocity(b)/sqrt(dot(velocity(b), velocity(b)) + v0^2)\"}}}}
scene: {{start: {{x: 0, y: 0, x': 3, y': 1}}, until: 2, tolerance: {tolerance:e}}}"
            ));
            let run = case.run();
            assert!((run.last()["x"] - 1.58114).abs() < 1e-4, "{layer}, {tolerance:e}: {}", run.last());
        }
    }
}

/// An inertia that shrinks and grows, but never without bound where the motion goes, at a tolerance that lets steps be long.
#[test]
fn long_steps_are_no_coordinate_singularity() {
    let mut case = file(
        "name: Grows
parameters: {m: 1 kg, l: 1 m}
coordinates: {u: rad, v: rad}
bodies: {b: {mass: m, position: \"l*exp(u)*[cos(v), sin(v)]\"}}
scene: {start: {u: 0, v: 0, u': -3, v': 0.01}, until: 5}",
    );
    for tolerance in [1e-1, 1e-2, 1e-4] {
        case.settings.tolerance = tolerance;
        case.run();
    }
}
