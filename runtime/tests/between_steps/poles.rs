// Events whose functions have poles, or begin undefined: poles are neither zeros nor touches, and hide nothing.

use dalembert::{Run, Warning};

use super::{coasting, file};

/// A particle that goes through the places 0 to 3.0371 in as many seconds, at 1 m/s, and events in its place.
fn passing(events: &[&str]) -> Run {
    let entries: Vec<String> =
        events.iter().enumerate().map(|(k, when)| format!("  e{k}: {{when: \"{when}\", then: record}}\n")).collect();
    coasting(&format!("events:\n{}scene: {{start: {{x': 1}}, until: 3.0371}}", entries.concat())).run()
}

/// When each event fires, and what is said of it.
fn told(run: &Run, event: &str) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let fired = run.events.iter().filter(|e| &*e.name == event).map(|e| e.state.t).collect();
    let mut others = (Vec::new(), Vec::new());
    for warning in &run.warnings {
        match warning {
            Warning::NoCrossing { event: e, t } | Warning::Undefined { event: e, t } if e == event => others.0.push(*t),
            Warning::Touch { event: e, t } if e == event => others.1.push(*t),
            _ => {}
        }
    }
    (fired, others.0, others.1)
}

/// Each with its zeros and its odd poles (those of even order change no sign; of none is anything said).
#[test]
fn poles_are_no_touches_and_leave_zeros_alone() {
    let half_pi = std::f64::consts::FRAC_PI_2;
    let cases: [(&str, &[f64], &[f64]); 14] = [
        ("1/(x - 0.93771)", &[], &[0.93771]),
        ("1/(x - 0.93771)^2", &[], &[]),
        ("1/(x - 0.93771)^3", &[], &[0.93771]),
        ("1e-9/(x - 0.93771)", &[], &[0.93771]),
        ("1e9/(x - 0.93771)", &[], &[0.93771]),
        ("tan(x)", &[], &[half_pi]),
        ("1/cos(x)", &[], &[half_pi]),
        ("exp(1/(0.93771 - x)) - 2", &[], &[0.936301]),
        ("1/(x - 0.93771) + 5", &[0.73771], &[0.93771]),
        ("1/(x - 0.93771)^2 - 4", &[0.43771, 1.43771], &[]),
        ("x/(x - 0.93771) - 3", &[1.406565], &[0.93771]),
        ("(x - 1.00001)/(x - 0.93771)", &[1.00001], &[0.93771]),
        ("sin(5*x - 1)/(x - 0.93771)", &[0.2, 0.828318531, 1.456637061, 2.084955592, 2.713274123], &[0.93771]),
        ("(x - 0.93771)^2/(x - 0.93771)", &[0.93771], &[]),
    ];
    for (when, zeros, poles) in cases {
        let (fired, odd, touches) = told(&passing(&[when]), "e0");
        assert!(touches.is_empty(), "{when} touches at {touches:?}");
        let near = |found: &[f64], wanted: &[f64], by: f64| {
            found.len() == wanted.len() && found.iter().zip(wanted).all(|(x, y)| (x - y).abs() < by)
        };
        assert!(near(&fired, zeros, 1e-9), "{when} fires at {fired:?}");
        assert!(near(&odd, poles, 1e-3), "{when} is odd at {odd:?}");
    }
}

/// The neighbours: true touches.
#[test]
fn touches_are_still_told() {
    for (when, at) in [("(x - 0.93771)^2", 0.93771), ("1 - cos(x - 1.2)", 1.2), ("(x - 0.93771)^2/(x - 5)", 0.93771)] {
        let (fired, odd, touches) = told(&passing(&[when]), "e0");
        assert!(fired.is_empty() && odd.is_empty(), "{when}: {fired:?} {odd:?}");
        assert!(touches.len() == 1 && (touches[0] - at).abs() < 1e-6, "{when} touches at {touches:?}");
    }
}

/// A zero beside the pole of a function inside: 1/tan at π/2.
#[test]
fn a_zero_through_a_pole_inside_is_a_crossing() {
    let (fired, odd, _) = told(&passing(&["1/tan(x + 0.1)"]), "e0");
    assert!(odd.is_empty() && fired.len() == 1, "{fired:?} {odd:?}");
    assert!((fired[0] - (std::f64::consts::FRAC_PI_2 - 0.1)).abs() < 1e-12, "{fired:?}");
}

/// What is undefined where the run begins hides neither its own later zeros and poles nor those of others.
#[test]
fn an_undefined_start_hides_nothing() {
    let run = passing(&["1/x - 1", "1/(x - 0.93771)", "1/tan(x)", "sqrt(x - 0.3)", "tan(x)", "1/x - 1/(x - 2)"]);
    let fired = |event: &str| told(&run, event).0;
    assert!(fired("e0").len() == 1 && (fired("e0")[0] - 1.0).abs() < 1e-12, "{:?}", fired("e0"));
    assert_eq!(fired("e2").len(), 1, "{:?}", fired("e2"));
    let odd = |event: &str| told(&run, event).1;
    for (event, at) in [("e1", 0.93771), ("e3", 0.3), ("e4", std::f64::consts::FRAC_PI_2), ("e5", 2.0)] {
        assert!(odd(event).iter().any(|t| (t - at).abs() < 1e-6), "{event} is odd at {:?}", odd(event));
    }
}

/// A pole that was passed does not make all else count as zero where a phase begins: what is past its zero there fires.
#[test]
fn a_size_after_a_pole_is_no_zero() {
    let text = "constraints: {wall: x - 9}
phases: {before: [], after: [], at_last: [], held: [wall]}
events:
  passes: {phase: before, when: x - 1.5, direction: rising, then: after}
  overdue: {phase: [before, after], when: 1e-3/(x - 0.93771), direction: rising, then: at_last}
scene: {start: {x': 1}, until: 3}";
    let run = coasting(text).run();
    let fired: Vec<(&str, f64)> = run.events.iter().map(|e| (&*e.name, e.state.t)).collect();
    assert_eq!(fired.iter().map(|e| e.0).collect::<Vec<_>>(), ["passes", "overdue"], "{fired:?}");
    assert!(fired.iter().all(|e| (e.1 - 1.5).abs() < 1e-12), "{fired:?}");
}

/// Many poles in one run, in steps as long as the motion allows: every zero between them is found and no pole is one, and
/// what is said of the poles names their event.
#[test]
fn all_zeros_among_many_poles_are_found() {
    use std::f64::consts::PI;
    let within = |from: f64, apart: f64| -> Vec<f64> {
        (0..).map(|k| from + f64::from(k) * apart).take_while(|x| *x < 3.0371).collect()
    };
    let both = |one: Vec<f64>, other: Vec<f64>| {
        let mut all = [one, other].concat();
        all.sort_by(f64::total_cmp);
        all
    };
    let ninth = |angle: f64| both(within(angle / 9.0, 2.0 * PI / 9.0), within((PI - angle) / 9.0, 2.0 * PI / 9.0));
    let cases = [
        // It begins at a zero, which is none of the run's.
        ("tan(7*x)", within(PI / 7.0, PI / 7.0), PI / 14.0),
        ("tan(7*x) - 1", within(PI / 28.0, PI / 7.0), PI / 14.0),
        ("tan(7*x) + 1e3", within((PI - 1e3_f64.atan()) / 7.0, PI / 7.0), PI / 14.0),
        ("1/sin(9*x)", Vec::new(), PI / 9.0),
        ("1/sin(9*x) - 2", ninth(PI / 6.0), PI / 9.0),
        (
            "1/sin(9*x + 0.4) - 2",
            both(within((PI / 6.0 - 0.4) / 9.0, 2.0 * PI / 9.0), within((5.0 * PI / 6.0 - 0.4) / 9.0, 2.0 * PI / 9.0)),
            (PI - 0.4) / 9.0,
        ),
    ];
    let together: Vec<&str> = cases.iter().map(|case| case.0).collect();
    let all = passing(&together);
    for (k, (when, zeros, pole)) in cases.iter().enumerate() {
        for (run, event) in [(&passing(&[when]), "e0".to_owned()), (&all, format!("e{k}"))] {
            let (fired, odd, touches) = told(run, &event);
            assert!(touches.is_empty(), "{when} touches at {touches:?}");
            let right = fired.len() == zeros.len() && fired.iter().zip(zeros).all(|(t, zero)| (t - zero).abs() < 1e-10);
            assert!(right, "{when} fires at {fired:?}, not {zeros:?}");
            assert!(odd.iter().any(|t| (t - pole).abs() < 1e-6), "{when} is odd at {odd:?}, not {pole}");
            let named = format!("`{event}`");
            let words = run.warnings.iter().map(ToString::to_string).filter(|words| words.contains("pole"));
            assert!(words.clone().any(|words| words.starts_with(&named)), "{:?}", words.collect::<Vec<_>>());
        }
    }
}

/// A switch has another side behind a jump of its argument over zero, though that is nowhere zero.
#[test]
fn arguments_of_switches_may_jump_over_zero() {
    let thrown = |law: &str| {
        file(&format!(
            "name: P\nparameters: {{m: 1, F: 1}}\ncoordinates: {{x: 1}}\n\
             bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\nforces: {{f: {{on: b, force: \"[F*({law}), 0]\"}}}}\n\
             scene: {{start: {{x': 3}}, until: 1, tolerance: 1e-8}}"
        ))
        .run()
        .last()["x'"]
    };
    let root = 7.0_f64.sqrt();
    let half_pi = std::f64::consts::FRAC_PI_2;
    // Speeds where the tangent has its pole and its zero: it is pushed ahead, back, and ahead again.
    let fast = (9.0 + 2.0 * (half_pi - 0.7)).sqrt();
    let slow = (fast * fast - 2.0 * half_pi).sqrt();
    for (law, expected) in [
        ("sign(x - 1)", 2.0 * root - 2.0),
        ("sign(1/(x - 1))", 2.0 * root - 2.0),
        ("sign(1e-9/(x - 1)^3)", 2.0 * root - 2.0),
        ("sign(1e9/(x - 1)^5)", 2.0 * root - 2.0),
        ("sign(1/(x - 1)^2)", 4.0),
        ("sign(atan2(x - 1, -1))", 2.0 * root - 2.0),
        ("step(1/(x - 1))", 11.0 / 3.0),
        ("sign(tan(x + 0.7))", 4.0 - 2.0 * (fast - slow)),
        ("sign(1/(t - 0.5))", 3.0),
        ("sign(tan(3*t + 0.7))", 4.0 - 2.0 * half_pi / 3.0),
    ] {
        assert!((thrown(law) - expected).abs() < 1e-7, "{law}: {} and not {expected}", thrown(law));
    }
}
