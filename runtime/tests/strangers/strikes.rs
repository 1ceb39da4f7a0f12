//! Impacts that were refused: `static` larger than `friction`, and floors that are faster at once where no length tells what a gap is beside.

use super::case;

/// A ball thrown along a rough floor, or dropped onto it.
const THROWN: &str = r#"
name: Thrown
parameters: {m: 1 kg, g: 10 m/s^2, v: 3 m/s, mu: 0.2, mus: 0.3}
coordinates: {x: m, y: m}
bodies: {b: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
contacts: {floor: {gap: y, on: b, normal: "[0, 1]", friction: mu, static: mus}}
scene: {start: {x: 0, y: 0, x': v, y': -5}, until: 0.01, tolerance: 1e-11}
"#;

#[test]
fn what_slides_when_it_strikes_is_rubbed_by_the_friction_of_sliding() {
    // P = 5: 0.2 P = 1 of the 3 m/s is taken, whatever `static` is; of less than 1 m/s all, of 1.2 m/s, which 0.3 P would take, 0.2 is left.
    for (v, left) in [(3.0, 2.0), (1.2, 0.2), (-1.2, -0.2), (0.9, 0.0), (0.0, 0.0)] {
        for mus in ["0.2", "0.3", "5"] {
            let run =
                case(&THROWN.replace("v: 3", &format!("v: {v}")).replace("mus: 0.3", &format!("mus: {mus}"))).run();
            let struck = v + run.impulses[0].jump[0];
            assert!((struck - left).abs() < 1e-12, "v = {v}, static {mus}: {struck}");
        }
    }
}

#[test]
fn what_does_not_slide_when_it_strikes_sticks_within_the_friction_of_sticking() {
    // A uniform rod falls onto its lower end at the angle a = 45°: the impulse that holds the end is 3 sin a cos a/(1 + 3 sin² a) of the normal one.
    let rod = "name: Rod\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, a: 45 deg, mu: 0.2, mus: 0.7, v: 2 m/s}\n\
               coordinates: {x: m, y: m, th: rad}\n\
               points: {tip: \"[x, y] - l/2*[cos(th), sin(th)]\"}\n\
               bodies: {rod: {mass: m, inertia: m*l^2/12, angle: th, position: \"[x, y]\"}}\ngravity: [0, -g]\n\
               contacts: {floor: {gap: tip.y, on: rod, at: tip, normal: \"[0, 1]\", friction: mu, static: mus}}\n\
               scene: {start: {x: l/2*cos(a), y: l/2*sin(a), th: a, y': -v}, until: 0.001, tolerance: 1e-11}\n";
    let needed = 3.0 * 0.5 / (1.0 + 3.0 * 0.5);
    let ratio = |mus: f64| {
        let run = case(&rod.replace("mus: 0.7", &format!("mus: {mus}"))).run();
        let of =
            |name: &str| run.impulses[0].constraints.iter().find(|(known, _)| known == name).map_or(0.0, |(_, p)| *p);
        (of("floor.friction") / of("floor")).abs()
    };
    assert!((ratio(0.7) - needed).abs() < 1e-9, "{} {needed}", ratio(0.7));
    for slides in [0.2, 0.5] {
        assert!((ratio(slides) - 0.2).abs() < 1e-9, "{slides}: {}", ratio(slides));
    }
}

/// A crate on a lift that stands, rises at 1 m/s from t = 1 s on, and stops at t = 2 s.
const LIFT: &str = r#"
name: Lift
parameters: {m: 1 kg, g: 10 m/s^2, h0: 0 m, T: 1 s, s1: 1 s, d: 1 mm}
coordinates: {y: m}
tables: {h: {points: [[0, 0], [1, 0], [2, 1], [4, 1]], units: [s, m], smooth: 0}}
inputs: {f: h0 + h(t/T*s1)}
bodies: {crate: {mass: m, position: "[0, y]"}}
gravity: [0, -g]
contacts: {floor: {gap: y - f, on: crate, normal: "[0, 1]"}}
scene: {start: {y: h0}, until: 3*T, tolerance: 1e-10}
"#;

#[test]
fn a_lift_that_rises_at_once_from_zero_was_passed_through() {
    // Struck by m v at t = T; at 2 T it flies on, for 2 v/g, and strikes with v.
    for (h0, time) in [("0", 1.0), ("0.5", 1.0), ("0", 0.7), ("0", 1.3)] {
        let run = case(&LIFT.replace("h0: 0", &format!("h0: {h0}")).replace("T: 1", &format!("T: {time}"))).run();
        let v: f64 = 1.0 / time;
        let found: Vec<f64> = run.impulses.iter().map(|impulse| impulse.constraints[0].1).collect();
        let [first, second] = found.as_slice() else { panic!("{h0} {time}: {found:?}") };
        assert!((first - v).abs() < 1e-9 && (second - v).abs() < 1e-9, "{h0} {time}: {found:?}");
        let times: Vec<f64> = run.events.iter().map(|event| event.state.t).collect();
        let [struck, lifted, landed] = times.as_slice() else { panic!("{h0} {time}: {times:?}") };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(near(*struck, time) && near(*lifted, 2.0 * time) && near(*landed, 2.0 * time + 0.2 * v), "{times:?}");
        let h0: f64 = h0.parse().expect("a number");
        assert!((run.last()["y"] - h0 - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_floor_that_is_higher_at_once_is_still_refused() {
    // No force lifts the crate by 1 mm in no time.
    let jumps = LIFT.replace("h0 + h(t/T*s1)", "h0 + d*step(t - T)");
    assert!(case(&jumps).try_run().is_err());
}
