//! Three angles that come to where they cannot turn a body in every direction.

use std::f64::consts::FRAC_PI_2;

use dalembert::linear::{Guess, LinearError, linearise, linearise_constrained};
use dalembert::mechanism::Method;
use dalembert::{Cause, Error, GimbalLock, Warning};

use super::{Case, case, program, stranger, text_of};

/// When the top of `tests/reference/space/top_through_pole.json` is upright first, s: a quarter of the period of cos(theta) in its closed
/// form, by the run at tolerance 1e-13.
const UPRIGHT: f64 = 0.690_090_886_480_8;

/// The lock in which a run ends, and when.
#[track_caller]
fn lock(case: &mut Case) -> (GimbalLock, f64) {
    match case.try_run() {
        Err(Error::Run(failure)) => match failure.cause {
            Cause::GimbalLock { lock, t } => (lock, t),
            cause => panic!("{cause}"),
        },
        Err(error) => panic!("{error}"),
        Ok(run) => panic!("ran to {}", run.last()),
    }
}

fn named(frame: &str, angles: [&str; 3]) -> GimbalLock {
    GimbalLock { frame: frame.to_owned(), angles: angles.map(str::to_owned) }
}

#[test]
fn a_top_through_the_pole_is_refused_at_every_tolerance() {
    for decade in 3..=13 {
        let mut case = case(&text_of("top_through_pole"));
        case.settings.tolerance = 10_f64.powi(-decade);
        case.settings.digits = true;
        let (found, t) = lock(&mut case);
        assert_eq!(found, named("B", ["psi", "theta", "phi"]), "1e-{decade}");
        assert!((t - UPRIGHT).abs() < if decade < 6 { 1e-4 } else { 1e-6 }, "1e-{decade}: {t}");
    }
}

#[test]
fn a_fixed_step_across_the_pole_is_refused() {
    for (method, step) in [(Method::Rk4, 2e-3), (Method::Gauss4, 5e-3), (Method::Dop853, 1e-2)] {
        let mut case = case(&text_of("top_through_pole"));
        (case.settings.method, case.settings.step) = (method, Some(step));
        let (_, t) = lock(&mut case);
        assert!((t - UPRIGHT).abs() < 2.0 * step, "{method}: {t}");
    }
}

#[test]
fn both_ways_out_lead_past_it() {
    let refused = text_of("top_through_pole");
    let others = refused.replace("[[z, psi], [x, theta], [z, phi]]", "[[x, psi], [y, theta], [z, phi]]").replace(
        "{theta: 0.8, psi': turning, phi': spin - turning*cos(0.8)}",
        "{psi: 0.8, theta': turning*sin(0.8), phi': spin}",
    );
    let rotation = refused
        .replace("{psi: rad, theta: rad, phi: rad}", "{attitude: rotation}")
        .replace("[[z, psi], [x, theta], [z, phi]]", "attitude")
        .replace(
            "{theta: 0.8, psi': turning, phi': spin - turning*cos(0.8)}",
            "{attitude: [x, 0.8], attitude': [0, turning*sin(0.8), spin]}",
        );
    for text in [others, rotation] {
        let mut case = case(&text);
        let last = case.run().last();
        // The place at t = 5 s by top_through_pole.json.
        let expected = [0.131_736_600_798_851_8, -0.024_784_870_155_137_556, 0.481_696_147_193_806_1];
        for (axis, expected) in ["x", "y", "z"].into_iter().zip(expected) {
            let found = last.get(&format!("place.{axis}")).expect("an output");
            assert!((found - expected).abs() < 1e-9, "{axis}: {found}");
        }
    }
}

/// A free body, turned by a sequence; its middle angle starts at a value and turns.
fn body(sequence: &str, start: &str) -> String {
    format!(
        "name: Body
parameters: {{d: 0.1 m}}
coordinates: {{a: rad, b: rad, c: rad}}
frames: {{B: {{rotate: {sequence}}}}}
bodies: {{body: {{mass: 1 kg, inertia: [1, 2, 2.5], frame: B, position: [0, 0, 0]}}}}
scene: {{start: {{{start}}}, until: 3, tolerance: 1e-9}}
"
    )
}

#[test]
fn every_sequence_locks_where_its_own_axes_say() {
    let there = [
        ("[[z, a], [y, b], [x, c]]", FRAC_PI_2),
        ("[[x, a], [y, b], [x, c]]", 0.0),
        ("[[z, a], [x, 0.4], [x, b], [z, c]]", -0.4),
        ("[[z, a], [x, -b], [z, c]]", 0.0),
        ("[[z, a], [x, 2*b + 0.1], [z, c]]", -0.05),
        ("[[z, a], [[0.6, 0.8, 0], b], [z, c]]", 0.0),
    ];
    // With equal moments a body turns on about any axis.
    let body = |sequence: &str, start: &str| body(sequence, start).replace("[1, 2, 2.5]", "[2, 2, 2]");
    for (sequence, place) in there {
        let away = case(&body(sequence, &format!("b: {place} + 0.7, a': 0.3"))).try_run();
        assert!(away.is_ok(), "{sequence}: {away:?}");
        // Turning about the middle axis alone, straight through.
        let (found, t) = lock(&mut case(&body(sequence, &format!("b: {place} + 0.7, b': -1"))));
        assert_eq!(found, named("B", ["a", "b", "c"]), "{sequence}");
        assert!((t - 0.7).abs() < 1e-6, "{sequence}: {t}");
        let (_, t) = lock(&mut case(&body(sequence, &format!("b: {place}, c': 1"))));
        assert_eq!(t, 0.0, "{sequence}");
    }
}

#[test]
fn a_constraint_elsewhere_changes_nothing() {
    let text = "name: Held
parameters: {d: 0.5 m}
coordinates: {x: m, y: m, z: m, a: rad, b: rad, c: rad}
frames: {A: {rotate: [[z, a], [x, b]]}, B: {from: A, rotate: [z, c]}}
bodies: {body: {mass: 1 kg, inertia: [1, 2, 2.5], frame: B, position: \"[x, y, z]\"}}
constraints: {foot: \"[x, y, z] - d*B.z\"}
scene: {start: {a: 0, b: 0.7, c: 0, a': 0, b': -1, c': 0}, until: 3, tolerance: 1e-9}
";
    let (found, t) = lock(&mut case(text));
    assert_eq!(found, named("B", ["a", "b", "c"]));
    // The run fails there or a little before, within the thousandth of a radian in which that is the lock's doing.
    assert!(t <= 0.7 + 1e-9 && t > 0.7 - 1e-3, "{t}");
}

/// Rings with inertia of their own have accelerations where the rotor's axes are parallel, and a run passes there.
#[test]
fn rings_with_inertia_pass() {
    let text = body("[[z, a], [x, b], [z, c]]", "b: 0.7, b': -1, c': 2")
        .replace("frames: {B", "frames: {outer: {rotate: [z, a]}, B")
        .replace(
            "bodies: {",
            "bodies: {ring: {mass: 0, inertia: [0.1, 0.1, 0.1], frame: outer, position: [0, 0, 0]}, ",
        );
    case(&text).run();
}

/// Past the lock at 1/200 rad, which the tolerance tells from it.
#[test]
fn a_near_miss_is_no_lock() {
    let text = body("[[z, a], [x, b], [z, c]]", "a: 0, b: 0.7, b': -1, a': 0.005").replace("[1, 2, 2.5]", "[2, 2, 2]");
    let mut near = case(&text);
    near.settings.digits = true;
    let run = near.run();
    assert!(run.digits("b").is_some_and(|digits| digits >= 4), "{:?}", run.digits("b"));
}

#[test]
fn small_motions_are_refused_in_the_lock() {
    let refused = |error: Option<LinearError>| match error {
        Some(LinearError::GimbalLock(lock)) => assert_eq!(lock, named("B", ["a", "b", "c"])),
        other => panic!("{other:?}"),
    };
    let text = body("[[z, a], [x, b], [z, c]]", "b: 0").replace("position: [0, 0, 0]", "position: d*B.z");
    let free = case(&text);
    let rest = dalembert::linear::equilibrium_near(&free.system, &Guess::at(&[0.0; 3])).expect("a rest");
    refused(linearise(&free.system, &rest).err());
    let held = case(&text.replace("scene", "constraints: {still: a - c}\nscene"));
    // The row keeps the combination of a and c that moves nothing, and what is left has inertia.
    assert!(linearise_constrained(&held.system, &Guess::at(&[0.0; 3]), true).is_ok());
    let held = case(
        &text
            .replace("{a: rad,", "{x: m, a: rad,")
            .replace("position: d*B.z", "position: \"d*B.z + [x, 0, 0]\"")
            .replace("scene", "constraints: {still: x}\nscene"),
    );
    refused(linearise_constrained(&held.system, &Guess::at(&[0.0; 4]), true).err());
}

#[test]
fn check_says_that_a_scene_comes_there() {
    let path = stranger("top_through_pole");
    let said = program(&["check", path.to_str().expect("a path")]).expect("a good model");
    assert!(said.contains("comes to gimbal lock about t = 0.69: `psi` and `phi` turn `B` about one axis"), "{said}");
}

/// A body that is turned about one line by the first and by the third of three angles is turned by both together as far as it is.
#[test]
fn angles_at_their_lock_turn_the_body() {
    let outputs = "outputs: {zxz: \"angles(b, zxz)\", zyz: \"angles(b, zyz)\", zyx: \"angles(b, zyx)\"}\n";
    let of = |start: &str| {
        let body = "name: Turned\nparameters: {m: 1 kg, I: 1 kg*m^2}\ncoordinates: {turn: rotation}\nframes: {F: {rotate: turn}}\nbodies: {b: {mass: m, inertia: [I, I, I], frame: F, position: [0, 0, 0]}}\n";
        let run = case(&format!("{body}{outputs}scene: {{start: {{turn: {start}}}, until: 0.1}}\n")).run();
        let angle = |name: &str| run.column(name).expect("an output")[0];
        ["zxz", "zyz", "zyx"].map(|name| ["x", "y", "z"].map(|axis| angle(&format!("{name}.{axis}"))))
    };
    let same = |found: f64, wanted: f64| (0.5 * (found - wanted)).sin().abs() < 1e-14;
    for turned in [2.0, 0.5, -3.0, 0.0] {
        let [zxz, zyz, zyx] = of(&format!("[[z, {turned}]]"));
        for [a, b, c] in [zxz, zyz] {
            assert!(same(a + c, turned) && b.abs() < 1e-15, "{turned}: {a}, {b}, {c}");
        }
        assert!(same(zyx[0], turned) && zyx[1] == 0.0 && zyx[2].abs() < 1e-15, "{turned}: {zyx:?}");
    }
    let [_, _, [a, b, c]] = of("[[z, 0.4], [y, pi/2], [x, 0.3]]");
    assert!(same(c - a, -0.1) && (b - FRAC_PI_2).abs() < 1e-7, "{a}, {b}, {c}");
}

/// A body that tumbles past the place where its angles lock, 3e-5 of its spin about the line of that place; by a rotation it passes
/// nothing, so that the error of the angles' run is what the two differ by.
#[test]
fn a_motion_beside_a_lock_is_warned_of_and_promises_no_digits_that_do_not_hold() {
    let angles = "name: Beside\nparameters: {m: 1 kg}\ncoordinates: {a: rad, b: rad, c: rad}
frames: {B: {rotate: [[z, a], [x, b], [z, c]]}}
bodies: {o: {mass: m, inertia: [0.2, 0.3, 0.4], frame: B, position: [0, 0, 0]}}
outputs: {bx: B.x}
scene: {start: {b: 0.5, b': -1, a': 3e-05, c': -3e-05}, until: 2, tolerance: 1e-9}\n";
    let rotation = angles
        .replace("{a: rad, b: rad, c: rad}", "{q: rotation}")
        .replace("[[z, a], [x, b], [z, c]]", "q")
        .replace(
            "{b: 0.5, b': -1, a': 3e-05, c': -3e-05}",
            "{q: [[z, 0], [x, 0.5], [z, 0]], q': {angles: [3e-5, -1, -3e-5]}}",
        )
        .replace("1e-9", "1e-13");
    let mut beside = case(angles);
    beside.settings.digits = true;
    let (run, exact) = (beside.run(), case(&rotation).run());
    for axis in ["bx.x", "bx.y", "bx.z"] {
        let (found, truth) = (run.last()[axis], exact.last()[axis]);
        let bound = *run.errors(axis).expect("digits").last().expect("an end");
        assert!((found - truth).abs() <= bound && bound < 1e-3, "{axis}: {found} for {truth}, bound {bound:e}");
    }
    let near = run.warnings.iter().find_map(|warning| match warning {
        Warning::NearGimbalLock { lock, t, angle, part } => Some((lock.clone(), *t, *angle, *part)),
        _ => None,
    });
    let (lock, t, angle, part) = near.expect("a warning");
    assert_eq!(lock, named("B", ["a", "b", "c"]));
    // b falls from 0.5 at the rate 1; what turns about the line of nodes keeps it from 0.
    assert!((t - 0.5).abs() < 1e-3 && angle > 0.0 && angle < 1e-4 && part > 0.3 && part <= 1.0, "{t} {angle} {part}");
    assert!(!exact.warnings.iter().any(|warning| matches!(warning, Warning::NearGimbalLock { .. })));
    // With moderate steps a lock nearby does no harm: a body that turns slowly 0.015 rad beside it.
    let quiet = case(&angles.replace("b: 0.5, b': -1, a': 3e-05, c': -3e-05", "b: 0.015, a': 1, c': 1")).run();
    assert!(
        !quiet.warnings.iter().any(|warning| matches!(warning, Warning::NearGimbalLock { .. })),
        "{:?}",
        quiet.warnings
    );
}
