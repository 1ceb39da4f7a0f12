//! Motions on surfaces where forces or rates jump: runs that ended with `chattering`, and advice that did not fit.

use dalembert::{Cause, Error, Method};

use super::case;

/// A motion that winds about the origin: both surfaces are crossed again and again, in times that shrink to a third.
const WINDS: &str = r#"
name: Winds
states: {x: {rate: "-sign(x) + 2*sign(y) + d"}, y: {rate: "-2*sign(x) - sign(y)"}}
inputs: {d: 0*t}
scene: {start: {x: 1, y: 0.3}, until: 10, tolerance: 1e-11}
"#;

#[test]
fn what_winds_into_the_origin_stays_there() {
    // It crosses y = 0 at t = 0.1 with x = 1.1, and is at the origin after 1.1/3 (1 + 1/3 + 1/9 + …) = 0.55 more.
    let at = |text: &str, until: &str| {
        let mut case = case(text);
        case.settings.until = until.parse().expect("a number");
        let run = case.run();
        [run.last()["x"], run.last()["y"]]
    };
    let near = |found: [f64; 2], expected: [f64; 2], text: &str| {
        let far = found.iter().zip(expected).any(|(found, expected)| (found - expected).abs() > 1e-9);
        assert!(!far, "{text}: {found:?}, not {expected:?}");
    };
    near(at(WINDS, "0.05"), [1.05, 0.15], "before the first surface");
    near(at(WINDS, "0.2"), [0.8, -0.1], "beyond it");
    near(at(WINDS, "10"), [0.0, 0.0], "at rest");
    // What pushes harder from second to second, 1 a second, is held by sign(x) = d/5 and sign(y) = −2 d/5 until d = 2.5; then y slides off, at 5 − 2 d,
    // with sign(x) = d − 2, which is held until d = 3.
    let pushed = WINDS.replace("0*t", "1*t").replace("x: 1, y: 0.3", "x: 0.1, y: 0.03");
    near(at(&pushed, "2.4"), [0.0, 0.0], "held");
    near(at(&pushed, "2.95"), [0.0, -0.45 * 0.45], "sliding off");
}

#[test]
fn a_tank_that_runs_empty_stays_empty() {
    // h = (1 − k t/2)², and 0 from t = 2/k on.
    for rate in ["-k*sqrt(max(0, h))", "-k*sign(h)*sqrt(abs(h))"] {
        let text = format!(
            "name: Tank\nparameters: {{k: 0.5 m^0.5/s}}\nstates: {{h: {{unit: m, rate: \"{rate}\"}}}}\n\
             scene: {{start: {{h: 1}}, until: 10, tolerance: 1e-11}}\n"
        );
        for (until, h) in [(2.0, 0.25), (3.9, 0.000_625), (4.5, 0.0), (10.0, 0.0)] {
            let mut tank = case(&text);
            tank.settings.until = until;
            let found = tank.run().last()["h"];
            assert!((found - h).abs() < 1e-10, "{rate} {until}: {found}, not {h}");
        }
    }
}

#[test]
fn implicit_methods_go_on_from_a_root_at_0() {
    // Shut until T: the slope of the root is infinite, times 0.  Then √(1 − p/p_s) = 1 − k (t − T)/2.
    for method in [Method::Radau5, Method::Rodas5P] {
        let mut filling = case(
            "name: Filling\nparameters: {ps: 100 kPa, k: 1 1/s, T: 0.05 s}\ninputs: {valve: \"step(t - T)\"}\n\
             define: {dp: \"valve*(ps - p)\"}\n\
             states: {p: {unit: Pa, rate: \"k*ps*sign(dp)*sqrt(abs(dp)/ps)\"}}\nscene: {start: {p: 0}, until: 1}\n",
        );
        filling.settings.method = method;
        let (found, p) = (filling.run().last()["p"], 1e5 * (1.0 - 0.525_f64.powi(2)));
        assert!((found - p).abs() < 1e-7 * p, "{method}: {found}, not {p}");
    }
}

#[test]
fn states_that_wind_about_two_surfaces_come_to_rest() {
    // The twisting algorithm of states: crossings of x = 0 accumulate, and no side of its sign changes the rate of x.
    let twisting = "name: Twisting\nstates: {x: {rate: y}, y: {rate: -2*sign(x) - sign(y)}}\n\
                    scene: {start: {x: 1}, until: 20, tolerance: 1e-10}\n";
    let run = case(twisting).run();
    assert!(["x", "y"].iter().all(|name| run.last()[*name].abs() < 1e-12), "{:?}", run.last());
}

#[test]
fn states_that_nothing_holds_are_not_told_of_friction() {
    // At rest where both sides push back, and no side changes the rate of x at once.
    let pushed = "name: Pushed\nstates: {x: {rate: y}, y: {rate: -2*sign(x) + 0.5}}\n\
                  scene: {start: {x: 0}, until: 20, tolerance: 1e-10}\n";
    let Err(Error::Run(failure)) = case(pushed).try_run() else { panic!("a motion") };
    assert!(matches!(&failure.cause, Cause::ChatteringStates { switch } if switch == "x"), "{}", failure.cause);
}

/// A particle on a line that a force pulls to its middle, whatever the distance.
fn pulled(force: &str, start: &str, until: f64) -> String {
    format!(
        "name: Pulled\nparameters: {{m: 1 kg, F: 1 N, r: 0.5 N/s}}\ncoordinates: {{x: m}}\n\
         bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\nforces: {{f: {{on: b, force: \"[{force}, 0]\"}}}}\n\
         outputs: {{side: sign(x)}}\nscene: {{start: {{{start}}}, until: {until}, tolerance: 1e-11}}\n"
    )
}

#[test]
fn a_preloaded_spring_holds_its_middle_until_more_than_the_preload_pulls() {
    // Held until r t = F, at 2 s; from there on r (t − 2)³/6.
    let run = case(&pulled("-F*sign(x) + r*t", "x: 0", 1.5)).run();
    assert_eq!((run.last()["x"], run.last()["x'"]), (0.0, 0.0));
    assert!((run.last()["side"] - 0.75).abs() < 1e-12, "{}", run.last()["side"]);
    let run = case(&pulled("-F*sign(x) + r*t", "x: 0", 4.0)).run();
    let x = 0.5 * 8.0 / 6.0;
    assert!((run.last()["x"] - x).abs() < 1e-9, "{}, not {x}", run.last()["x"]);
    // What pushes away does not hold.
    let run = case(&pulled("F*sign(x) + r*t", "x: 0", 1.0)).run();
    assert!((run.last()["x"] - (0.5 + 0.5 / 6.0)).abs() < 1e-9, "{}", run.last()["x"]);
}

#[test]
fn what_swings_ever_faster_about_a_surface_comes_to_rest_on_it() {
    // The twisting algorithm: from each turning point a third of the way remains at the next one, so that crossings accumulate.
    for force in ["-2*F*sign(x) - F*sign(x')", "-2*F*sign(x) - F*sign(x') + 0.2*F"] {
        let run = case(&pulled(force, "x: 1", 20.0)).run();
        assert!(run.last()["x"].abs() < 1e-12 && run.last()["x'"].abs() < 1e-9, "{force}: {:?}", run.last());
    }
    // With friction beside it: round numbers, and some that ended with `chattering`.
    for (pull, limit, start) in [(2.0, 1.0, 1.0), (1.178, 0.716, 1.488), (1.662, 1.009, 0.723)] {
        let text = pulled(&format!("-{pull}*F*sign(x)"), &format!("x: {start}"), 60.0);
        let rubs = text.replace("outputs", &format!("friction: {{rub: {{rate: x', limit: {limit} N}}}}\noutputs"));
        let run = case(&rubs).run();
        assert!(run.last()["x"].abs() < 1e-12 && run.last()["x'"].abs() < 1e-9, "{pull}: {:?}", run.last());
    }
}

#[test]
fn a_curved_surface_of_places_is_followed() {
    // Held on the circle of radius 1 by a force of 1 of the 2 that pull from both sides: the angle is t.
    let circle = "name: Circle\nparameters: {m: 1 kg, F: 2 N, R: 1 m}\ncoordinates: {x: m, y: m}\n\
                  bodies: {b: {mass: m, position: \"[x, y]\"}}\n\
                  forces: {f: {on: b, force: \"-F*sign(x^2 + y^2 - R^2)*[x, y]/R\"}}\noutputs: {side: sign(x^2 + y^2 - R^2)}\n\
                  scene: {start: {x: 1, y': 1}, until: 10, tolerance: 1e-11}\n";
    let run = case(circle).run();
    let [x, y] = ["x", "y"].map(|name| run.last()[name]);
    assert!((x - 10_f64.cos()).abs() < 1e-8 && (y - 10_f64.sin()).abs() < 1e-8, "({x}, {y})");
    assert!((run.last()["side"] - 0.5).abs() < 1e-8, "{}", run.last()["side"]);
}

/// Two surfaces that are met at one instant, each known to rounding.
#[test]
fn surfaces_that_are_met_together_are_both_crossed() {
    let meets = |[along, against]: [f64; 2], start: &str, until: f64| {
        let text = format!(
            "name: Meets\nparameters: {{m: 1 kg, k: 1 N/m, F: {along} N, G: {against} N, w: 1 rad/s}}\ncoordinates: {{x: m}}\n\
             bodies: {{p: {{mass: m, position: \"[x, 0]\"}}}}\n\
             generalized_forces: {{x: \"-k*x + F*sign(x) + G*sign(sin(w*t))\"}}\n\
             scene: {{start: {{{start}}}, until: {until}, tolerance: 1e-10}}\n"
        );
        case(&text).run().last()["x"]
    };
    // The two forces cancel, since x = sin t.
    for force in [0.5, -0.5] {
        let x = meets([force, -force], "x': 1", 100.0);
        assert!((x - 100_f64.sin()).abs() < 1e-7, "{x}");
    }
    // x = 0 at t = π with the speed 1, x = −1 at 2π; the end by pieces of circles in the plane of x and x'.
    let x = meets([-0.5, 0.5], "x: 1", 20.0);
    assert!((x - 2.170_450_791_141_314_5).abs() < 1e-8, "{x}");
}

/// What slides in its surface leaves it where an impact, a value that is set or an input takes it off at once: nothing brings it back but its forces.
#[test]
fn what_is_taken_off_its_surface_at_once_leaves_it() {
    // A relay about r, which jumps to 2 at 1 s: x goes after it at speed 1; by a tick, an event, and a jump of the input.
    let relay = |more: &str, at: &str| {
        format!("name: Relay\n{more}\nstates: {{x: -sign(x - {at})}}\nscene: {{start: {{x: 0.5}}, until: 2}}\n")
    };
    for text in [
        relay("memory: {r: 0}\nevents: {tk: {every: 3 s, from: 1 s, then: {set: {r: 2}}}}", "r"),
        relay("parameters: {T: 1 s}\nmemory: {r: 0}\nevents: {tk: {when: t/T - 1, then: {set: {r: 2}}}}", "r"),
        relay("parameters: {T: 1 s}\ninputs: {r: 2*step(t/T - 1)}", "r"),
        relay("events: {tk: {every: 3 s, from: 1 s, then: {set: {x: x + 2}}}}", "0"),
    ] {
        let run = case(&text).run();
        assert!((run.last()["x"] - 1.0).abs() < 1e-9, "{text}: {}", run.last()["x"]);
    }
    // A ball strikes a block that rests in dry friction: it takes over the speed of 1, and loses 2 F t.
    let struck = "name: Struck\nparameters: {m: 1 kg, F: 2 N}\ncoordinates: {a: m, b: m}\nbodies:\n  \
                  A: {mass: m, position: \"[a, 0]\"}\n  B: {mass: m, position: \"[b, 0]\"}\n\
                  contacts: {c: {gap: b - a, on: B, from: A, normal: \"[1,0]\", restitution: 1}}\n\
                  forces: {f: {on: B, force: \"[-F*sign(b'), 0]\"}}\n\
                  scene: {start: {a: -1, a': 1, b: 0}, until: 1.3, tolerance: 1e-10}\n";
    let run = case(struck).run();
    assert!((run.last()["b'"] - 0.4).abs() < 1e-9 && (run.last()["b"] - 0.21).abs() < 1e-9, "{:?}", run.last());
}

/// A block on dry friction that a spring pulls at a speed v; what else it has is still to be said.
const PULLED: &str = r#"
name: Pulled
parameters: {m: 10 kg, k: 200 N/m, F: 9 N, F2: 12 N, C: 50 J/K, c: 3 N*s^2/m^2, v: 0.3 m/s}
coordinates: {x: m}
states: {T: {unit: K, rate: "F*abs(x')/C"}}
bodies: {b: {mass: m, position: "[x, 0]"}}
forces: {pull: {on: b, force: "[k*(v*t - x) - DRAG, 0]"}}
friction: {rub: {rate: x', on: b, along: "[1, 0]", LIMIT}}
scene: {start: {x: 0}, until: 4, tolerance: 1e-11}
"#;

/// From rest the spring's stretch u is F/k + A cos wt + (v/w) sin wt with A = (F2 - F)/k and w = sqrt(k/m); the block stops where tan(wt/2) = -A w/v
/// and sticks for 2 A/v. It is warmed by F over its whole way, whichever that is.
#[test]
fn what_sticks_is_warmed_by_its_way_and_by_nothing_else() {
    let text = PULLED.replace("DRAG", "0*c*x'*abs(x')").replace("LIMIT", "limit: F, static: F2");
    let (w, a, v) = (20.0_f64.sqrt(), 3.0 / 200.0, 0.3);
    let slips = 2.0 * (std::f64::consts::PI - (a * w / v).atan()) / w;
    let left = 4.0 - (12.0 / 200.0 / v + 2.0 * (slips + 2.0 * a / v));
    let x = 4.0 * v - (9.0 / 200.0 + a * (w * left).cos() + v / w * (w * left).sin());
    for (side, text) in [(1.0, text.clone()), (-1.0, text.replace("v: 0.3", "v: -0.3"))] {
        let last = case(&text).run().last();
        assert!((last["x"] - side * x).abs() < 1e-9, "{}, and not {}", last["x"], side * x);
        assert!((last["T"] - 9.0 * x / 50.0).abs() < 1e-9, "{}", last["T"]);
    }
}

/// `sqrt(x'^2)` is `abs(x')` without a surface to look for.
#[test]
fn drags_and_limits_by_the_size_of_a_rate_that_is_held_are_as_without_a_surface() {
    for (drag, limit) in
        [("c*x'*abs(x')", "limit: F, static: F2"), ("0*c*x'*abs(x')", "limit: \"F*(1 + exp(-abs(x')/v))\"")]
    {
        let text = PULLED.replace("DRAG", drag).replace("LIMIT", limit);
        for v in ["0.1", "0.17", "0.3", "0.4"] {
            let text = text.replace("v: 0.3", &format!("v: {v}"));
            let [switched, smooth] = [text.clone(), text.replace("abs(x')", "sqrt(x'^2)")].map(|text| {
                let mut case = case(&text);
                case.settings.digits = false;
                case.run().last()["x"]
            });
            assert!((switched - smooth).abs() < 1e-8, "{drag}, {limit}, v = {v}: {switched}, and not {smooth}");
        }
    }
}

/// A tank that a pump fills up to a level, and drains from t = T on, as long as something is in it.
fn tank(law: &str, change: f64, until: f64) -> f64 {
    let text = format!(
        "name: Tank\nparameters: {{a: 1 m/s, H: 3 m, T: {change} s}}\ninputs: {{u: 1 - 2*step(t - T)}}\n\
         states: {{h: {{unit: m, rate: 'a*sign({law})'}}}}\nscene: {{start: {{h: 1}}, until: {until}}}\n"
    );
    case(&text).run().last()["h"]
}

/// An input jumps inside the argument of a discontinuity: before the level is reached, in the moment in which it is, and after it.
#[test]
fn an_input_that_jumps_inside_a_sign_turns_it() {
    for law in ["max(u, 0)*(H - h) - max(-u, 0)*h", "step(u)*(H - h) - step(-u)*h"] {
        for change in [1.5, 2.0, 2.5] {
            let top = f64::min(1.0 + change, 3.0);
            for (after, level) in [(0.0, top), (1.0, top - 1.0), (top, 0.0), (top + 1.0, 0.0)] {
                let found = tank(law, change, change + after);
                assert!((found - level).abs() < 1e-9, "{law} {change} {after}: {found}, not {level}");
            }
        }
    }
}

/// A tank runs empty by its own level, and is filled again: what is set ends what rounding held at the surface.
#[test]
fn an_empty_tank_that_is_filled_drains_again() {
    let tank = |fill: &str, start: f64| {
        case(&format!(
            "name: Tank\nparameters: {{A: 2 m^2, c: 0.3 m^(5/2)/s, d: 1.5 m, T: 20 s}}\n\
             states: {{h: {{unit: m, rate: '-c*sqrt(max(h, 0))/A'}}}}\n\
             events: {{fill: {{{fill}, then: {{set: {{h: h + d}}}}}}}}\nscene: {{start: {{h: {start}}}, until: 25}}\n"
        ))
        .run()
        .last()["h"]
    };
    // √h falls by c/(2 A) = 0.075 a second.
    let expected = (f64::sqrt(1.5) - 0.375).powi(2);
    for fill in ["every: 20 s, from: 20 s", "when: t - T, direction: rising"] {
        for start in [2.0, 0.0] {
            let found = tank(fill, start);
            assert!((found - expected).abs() < 1e-8, "{fill} {start}: {found}, not {expected}");
        }
    }
}

/// A track of millimetres is one as well as a track of metres: what a table is beyond its last point is no sign that its curvature vanishes.
#[test]
fn tracks_are_followed_at_any_scale() {
    let place = |(unit, size): (&str, f64)| {
        let file = format!(
            "name: Track\ntables: {{road: {{points: [[-2, 1], [-1, 0], [0, 0.5], [1, -0.3], [2, 0.4]], units: [{unit}, {unit}]}}}}\n\
             parameters: {{m: 1 kg, g: 9.81 m/s^2}}\ncoordinates: {{x: m, y: m}}\nbodies: {{b: {{mass: m, position: '[x, y]'}}}}\n\
             gravity: [0, -g]\nconstraints: {{track: y - road(x)}}\nscene: {{start: {{x: 0.5 {unit}}}, until: 0.3, tolerance: 1e-10}}\n"
        );
        let mut case = case(&file);
        // As much time as the way takes.
        case.settings.until *= f64::sqrt(size);
        case.run().last()["x"] / size
    };
    let far = place(("m", 1.0));
    for scale in [("mm", 1e-3), ("um", 1e-6)] {
        let near = place(scale);
        assert!((near - far).abs() < 1e-8, "{}: {near} instead of {far}", scale.0);
    }
}
