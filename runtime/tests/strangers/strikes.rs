//! Impacts that were refused: `static` larger than `friction`, and floors that are faster at once where no length tells what a gap is beside.

use dalembert::{Cause, Method};

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

/// A slanted rod falls onto its lower end, which sticks while it is compressed, G P = u: e times that is given back, e P across, and along what holds the
/// end or the friction of it.
#[test]
fn what_is_given_back_is_rubbed_as_it_slides_then() {
    let rod = "name: Rod\nparameters: {m: 1 kg, l: 1 m, mu: 1, e: 0.5, a: 1 rad}\ncoordinates: {x: m, y: m, th: rad}\n\
               points: {foot: \"[x, y] - l*[cos(th), sin(th)]\"}\n\
               bodies: {rod: {mass: m, inertia: m*l^2/3, angle: th, position: \"[x, y]\"}}\n\
               contacts: {foot: {gap: foot.y, on: rod, at: foot, normal: \"[0, 1]\", friction: mu, restitution: e}}\n\
               impacts: poisson\noutputs: {slip: \"velocity(rod, foot).x\", up: \"velocity(rod, foot).y\"}\n\
               scene: {start: {x: l*cos(a), y: l*sin(a), th: a, y': -1}, until: 1e-9}\n";
    for (a, mu, e) in [(1.0, 1.0, 0.5), (1.0, 0.5, 0.8), (0.6, 2.0, 0.3), (2.2, 0.6, 0.5)] {
        let text = rod.replace("mu: 1", &format!("mu: {mu}")).replace("e: 0.5", &format!("e: {e}"));
        let run = case(&text.replace("a: 1 rad", &format!("a: {a} rad"))).run();
        let (s, c) = (f64::sin(a), f64::cos(a));
        // G of the foot's rates [across, along], with 3/(m l²) for the turning.
        let [across, beside, along] = [1.0 + 3.0 * c * c, -3.0 * s * c, 1.0 + 3.0 * s * s];
        let pressed = along / (across * along - beside * beside);
        assert!((beside / along).abs() <= mu, "it sticks while it is compressed");
        let last = run.last();
        assert!(last["slip"].abs() < 1e-8 && (last["up"] - e).abs() < 1e-8, "{a} {mu} {e}: {last}");
        let given: f64 = run.impulses[0].constraints.iter().find(|(name, _)| name == "foot").map_or(0.0, |(_, p)| *p);
        assert!((given - (1.0 + e) * pressed).abs() < 1e-12, "{a} {mu} {e}: {given}");
    }
}

/// Two rods strike so that the end sticks (Kane and Levinson): Newton's law would gain energy, Poisson's takes some.
#[test]
fn poissons_law_gains_no_energy_at_kanes_pendulum() {
    let kane = "name: Kane\nparameters: {m: 1 kg, l: 1 m, mu: 0.7 1, e: 0.5 1}\ncoordinates: {a: rad, b: rad}\n\
                points: {E: \"l*[sin(a), -cos(a)]\", P: \"E + l*[sin(b), -cos(b)]\"}\n\
                bodies:\n  up: {mass: m, inertia: m*l^2/12, angle: a, position: E/2}\n  \
                lo: {mass: m, inertia: m*l^2/12, angle: b, position: (E + P)/2}\n\
                contacts: {p: {gap: P.y + h, on: lo, at: P, normal: \"[0, 1]\", friction: mu, restitution: e}}\n\
                define: {h: l*(cos(0.35) + cos(0.52))}\ngravity: [0, -9.81]\nimpacts: poisson\noutputs: {T: kinetic_energy}\n\
                scene: {start: {a: 0.35, b: 0.52, a': 2, b': -2}, until: 1e-9}\n";
    let run = case(kane).run();
    // By the two stages in a program of its own.
    assert!((run.impulses[0].energy + 1.022665801702753).abs() < 1e-9, "{:?}", run.impulses[0]);
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

/// Balls on the floor that strike it together without restitution below come to rest at once, at places that are exactly 0.
const STACK: &str = r#"
name: Stack
parameters: {m0: 5 kg, m1: 8 kg, m2: 3 kg, e0: 0.75 1, e1: 0.0 1, e2: 0.5 1}
gravity: [0, -9.81]
coordinates: {a: m, b: m, c: m}
bodies: {ba: {mass: m0, position: "[0, a]"}, bb: {mass: m1, position: "[0, b]"}, bc: {mass: m2, position: "[0, c]"}}
contacts:
  c0: {gap: a, on: ba, normal: "[0, 1]", restitution: e0}
  c1: {gap: b - a, on: bb, from: ba, normal: "[0, 1]", restitution: e1}
  c2: {gap: c - b, on: bc, from: bb, normal: "[0, 1]", restitution: e2}
impacts: sequential
scene: {start: {a: 0, a': -3, b: 0, b': -3, c: 0, c': -3}, until: 0.1}
"#;

#[test]
fn an_impact_that_leaves_all_at_rest_leaves_nothing_but_rest() {
    for method in [Method::Auto, Method::Dop853, Method::Radau5] {
        let mut case = case(STACK);
        case.settings.method = method;
        let run = case.run();
        for name in ["a", "b", "c", "a'", "b'", "c'"] {
            assert!(run.last()[name].abs() < 1e-30, "{method:?}: {name} = {}", run.last()[name]);
        }
        // The impulses of what was an impact, and none of its rounding: 16 kg at 3 m/s.
        assert_eq!(run.impulses.len(), 1, "{method:?}");
        let floor = run.impulses[0].constraints.iter().find(|(name, _)| name == "c0").expect("the floor").1;
        assert!((floor - 48.0).abs() < 1e-12, "{floor}");
    }
}

/// x = -cos t turns where the wall is, or all but there: what is located behind the turn moves back already, and no wall pulls.
#[test]
fn a_wall_that_is_only_touched_does_not_pull() {
    let text = "
name: Graze
parameters: {k: 1 N/m, d: 0 m, e: 0.5, w: 1 m}
coordinates: {x: m}
bodies: {b: {mass: 1 kg, position: '[x, 0]'}}
springs: {s: {stretch: x, stiffness: k, along: ground.x, on: b}}
constraints: {wall: x - w - d}
phases: {free: [], stuck: [wall]}
events: {hit: {phase: free, when: x - w - d, direction: rising, then: {impact: e, along: wall}}}
scene: {start: {x: -1}, until: 20, tolerance: 1e-11}
";
    for d in ["0", "1e-15", "-1e-15", "1e-12", "-1e-12", "1e-9"] {
        for method in [Method::Auto, Method::Radau5, Method::Dopri5, Method::Taylor] {
            let mut case = case(&text.replace("d: 0 m", &format!("d: {d} m")));
            case.settings.method = method;
            let run = case.run();
            assert!((run.last()["x"] + 20.0_f64.cos()).abs() < 1e-4, "{d} {method:?}: {}", run.last()["x"]);
            assert!(run.impulses.iter().all(|impulse| impulse.jump[0] <= 0.0), "{d} {method:?}: {:?}", run.impulses);
        }
    }
}

/// A rod that is caught at one end turns with 3 v/(4 a), and a wheel that slips rolls on with 2 v/3, however short their lengths are.
#[test]
fn speeds_jump_alike_at_all_lengths() {
    let rod = "
name: Rod
parameters: {m: 1 kg, a: 1 m, v: 1 m/s}
coordinates: {x: m, y: m, th: rad}
points: {p: '[x + a*cos(th), y + a*sin(th)]'}
bodies: {r: {mass: m, inertia: m*a^2/3, angle: th, position: '[x, y]'}}
constraints: {pin: 'p - [a, 0]'}
phases: {free: [], pinned: [pin]}
events: {hit: {phase: free, when: p.y, direction: falling, then: pinned}}
scene: {start: {x: 0, y: a, y': -v}, until: 2, tolerance: 1e-10}
";
    let wheel = "
name: Wheel
parameters: {m: 1 kg, R: 1 m, g: 10 m/s^2, mu: 0.2, v: 3 m/s}
coordinates: {x: m, th: rad}
bodies: {d: {mass: m, inertia: m*R^2/2, angle: th, position: '[x, R]'}}
constraints: {roll: x' + R*th'}
phases: {slip: [], roll: [roll]}
points: {p: '[x, 0]'}
forces: {f: {on: d, at: p, force: '[-mu*m*g, 0]', phase: slip}}
events: {grip: {phase: slip, when: x' + R*th', direction: falling, then: roll}}
scene: {start: {x': v}, until: 2, tolerance: 1e-10}
";
    for length in ["1", "1e-9", "1e-12", "1e-15", "1e12"] {
        let scaled = rod.replace("1 m,", &format!("{length} m,")).replace("1 m/s", &format!("{length} m/s"));
        let turned = case(&scaled).run().last()["th'"];
        assert!((turned - 0.75).abs() < 1e-9, "{length}: {turned}");
        let size: f64 = length.parse().expect("a number");
        let scaled = wheel.replace("R: 1 m", &format!("R: {length} m"));
        let scaled =
            scaled.replace("g: 10", &format!("g: {}", 10.0 * size)).replace("v: 3", &format!("v: {}", 3.0 * size));
        let rolls = case(&scaled).run().last()["x'"];
        assert!((rolls / size - 2.0).abs() < 1e-9, "{length}: {rolls}");
    }
}

/// A ball that an event strikes along its floor.
fn struck(events: &str) -> String {
    format!(
        "name: T\nparameters: {{m: 1 kg, g: 10 m/s^2, d: 1 mm}}\ncoordinates: {{x: m, y: m}}\nmemory: {{n: 0}}\n\
         bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}\ngravity: [0, -g]\nconstraints: {{floor: y}}\nphases: {{free: []}}\n\
         events: {{{events}}}\nscene: {{start: {{x: 0, y: 10, x': 1.5, y': 3}}, until: 2.5}}\n"
    )
}

/// Ticks, what they set and a height above the floor struck in the air.
#[test]
fn what_is_not_touched_is_not_struck() {
    let set = "t: {every: 0.5 s, then: {set: {n: n + 1}}}, hit: {on_set: n, then: {impact: 1, along: floor}}";
    for (events, event, height) in [
        ("hit: {every: 0.5 s, then: [{set: {n: n + 1}}, {impact: 1, along: floor}]}", "hit", 10.0),
        (set, "hit", 10.0),
        ("hit: {when: y - d, direction: falling, then: {impact: 1, along: floor}}", "hit", 1e-3),
    ] {
        let error = case(&struck(events)).try_run().expect_err("an impact in the air");
        match error.cause() {
            Some(Cause::ImpactMisses { event: told, constraint, residual }) => {
                assert_eq!((told.as_str(), constraint.as_str()), (event, "floor"));
                assert!((residual - height).abs() < 1e-9, "{events}: {residual}");
            }
            _ => panic!("{events}: {error}"),
        }
    }
    let run = case(&struck("hit: {when: y, direction: falling, then: {impact: 1, along: floor}}")).run();
    assert_eq!(run.impulses.len(), 1);
}
