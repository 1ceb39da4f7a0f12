//! Contacts that come to rest together, and hops that are too low to be seen.

use dalembert::{Cause, Method};

use super::{case, printed, text_of};

/// It rests on the plate until the plate falls faster, A W² sin W t = g, in every period anew: gaps close and open within their rounding.
#[test]
fn a_ball_on_a_shaken_plate_leaves_it_in_every_period() {
    let run = case(&text_of("ball_on_shaken_plate")).run();
    let (frequency, share) = (30.0, 9.81_f64 / (0.02 * 30.0 * 30.0));
    let lifts = run.events.iter().filter(|event| event.name == "c lifts");
    let lifts: Vec<f64> = lifts.map(|event| event.state.t).collect();
    assert_eq!(lifts.len(), 13);
    for (k, found) in lifts.into_iter().enumerate() {
        let expected = (share.asin() + std::f64::consts::TAU * (k + 1) as f64) / frequency;
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

/// Both corners strike at the same instants, and have no more hops from the same one on: the motion of a ball.
#[test]
fn a_brick_that_falls_flat_comes_to_rest() {
    let told = printed("simulate", "brick_falls_flat", &[]);
    assert!(told.contains("y = 0.1000000000 m") && told.contains("th = 0 rad\n"), "{told}");
    assert!(!told.contains("no digit"), "{told}");
    let run = case(&text_of("brick_falls_flat")).run();
    let first = (2.0 * 0.5 / 9.81_f64).sqrt();
    // It rests after the first fall and hops that last 2 e + 2 e² + … times as long.
    let rests = run.events.last().expect("events").state.t;
    assert!((rests - 3.0 * first).abs() < 1e-6, "{rests}");
}

/// Its corners strike one after the other, some hundred times; what closes one moves the others by rounding.
#[test]
fn a_cube_comes_to_rest_on_four_corners() {
    let mut cube = case(&text_of("cube_on_four_corners"));
    cube.settings.digits = false;
    for tolerance in [1e-9, 1e-10] {
        cube.settings.tolerance = tolerance;
        let run = cube.run();
        let end = |name: &str| run.last()[name];
        for (name, expected) in [("x", 1.0), ("z", 0.1), ("q.x", 0.0), ("q.y", 0.0), ("z'", 0.0)] {
            assert!((end(name) - expected).abs() < 1e-9, "{name} = {} at {tolerance:e}", end(name));
        }
    }
}

/// What an input moves by itself has energy of its own, which no step follows: the balance is held without it.
#[test]
fn the_energy_of_a_driven_table_is_no_part_of_the_balance() {
    let told = printed("simulate", "block_on_shaken_table", &["--json"]);
    let json: serde_json::Value = serde_json::from_str(&told).expect("JSON");
    let drift = json["drift"]["energy_balance"].as_f64().expect("a drift");
    assert!(drift < 1e-11, "{drift}");
}

/// A particle on which a force acts, with more parameters and more lines of the file.
fn pushed(parameters: &str, force: &str, more: &str) -> String {
    let given = "m: 1 kg, a: 2 N, b: 1.5 N, g: 10 m/s^2, k: 20 N/m, z: 0 m";
    let head = format!("name: Pushed\nparameters: {{{given}{parameters}}}\ncoordinates: {{x: m, y: m}}\n");
    let body = "bodies: {p: {mass: m, position: \"[x, y]\"}}\n";
    format!("{head}{body}forces: {{f: {{on: p, force: \"{force}\"}}}}\n{more}")
}

/// What slips, sticks or lifts where a motion begins is decided with the discontinuities on the sides on which the state is.
#[test]
fn contacts_begin_with_discontinuities_on_their_sides() {
    let rub = "friction: {rub: {rate: x', on: p, along: \"[1, 0]\", limit: b}}\n";
    let floor = "gravity: [0, -g]\ncontacts: {floor: {gap: y, on: p, normal: \"[0, 1]\", friction: 0.15}}\n";
    let scene = |x: f64, until: f64| format!("scene: {{start: {{x: {x}, y: 0}}, until: {until}, tolerance: 1e-10}}\n");
    let launched = pushed("", "[k*max(z, -x), 0]", &format!("{rub}{}", scene(-0.1, 2.0)));
    let launched_on_floor = pushed("", "[k*max(z, -x), 0]", &format!("{floor}{}", scene(-0.1, 2.0)));
    let pulled = pushed("", "[-a*sign(x), 0]", &format!("{rub}{}", scene(1.0, 1.0)));
    let lifted = pushed("", "[0, 2*m*g*sign(x)]", &format!("{floor}{}", scene(1.0, 3.0)));
    let lifted_by_larger = pushed(", c: 1 m", "[0, 2*m*g*max(x, z)/c]", &format!("{floor}{}", scene(1.0, 3.0)));
    let cases = [
        (launched, "x", -0.05, 1),
        (launched_on_floor, "x", -0.05, 1),
        (pulled, "x", 0.75, 0),
        (lifted, "y", 45.0, 0),
        (lifted_by_larger, "y", 45.0, 0),
    ];
    for (text, name, expected, events) in cases {
        let run = case(&text).run();
        assert!((run.last()[name] - expected).abs() < 1e-9, "{name} = {}\n{text}", run.last()[name]);
        assert_eq!(run.events.len(), events, "{text}");
        // It rests where the spring is half as long, after half a period.
        let stops = std::f64::consts::PI / 20.0_f64.sqrt();
        assert!(run.events.iter().all(|event| (event.state.t - stops).abs() < 1e-9), "{:?}", run.events);
    }
}

/// Where an argument is 0, the side is the one to which the motion goes that the decision brings.
#[test]
fn a_block_begins_to_slip_where_a_drum_turns() {
    let told = printed("simulate", "block_dragged_by_drum", &["--no-digits"]);
    assert!(told.contains("x = 0.748241003"), "{told}");
    assert!(!told.contains("sticks"), "{told}");
}

/// A carriage that a controller moves from rest at once does not stop there.
#[test]
fn what_slips_at_once_does_not_stop_where_it_begins() {
    let held = "[max(-u, min(u, K*(r - x) - D*x')), 0]";
    let rub = "friction: {rub: {rate: x', on: p, along: \"[1, 0]\", limit: 2 N}}\n";
    let scene = "scene: {start: {x: 0, y: 0}, until: 3, tolerance: 1e-11}\n";
    let run = case(&pushed(", u: 5 N, K: 50 N/m, D: 8 N*s/m, r: 1 m", held, &format!("{rub}{scene}"))).run();
    let stops: Vec<f64> = run.events.iter().map(|event| event.state.t).collect();
    assert!(matches!(stops[..], [t] if (t - 1.031315006577).abs() < 1e-9), "{stops:?}");
    assert!((run.last()["x"] - 1.021655979757).abs() < 1e-9, "{}", run.last()["x"]);
}

/// A rope's tension is 0 at the start but for a rounding to either side, and falls.
#[test]
fn a_rope_that_is_slack_by_a_rounding_does_not_push() {
    for del in ["-1e-9", "-1e-10", "-1e-11", "-1e-12", "-1e-13", "0", "1e-13", "1e-10"] {
        let run = case(&text_of("rope_all_but_slack").replace("del: 0", &format!("del: {del}"))).run();
        assert!((run.last()["r"] - 0.8376555965).abs() < 1e-9, "{del}: r = {}", run.last()["r"]);
    }
}

/// A force is at the limit of friction at the start but for a rounding to either side, and grows, stays or falls.
#[test]
fn friction_at_its_limit_by_a_rounding_holds_only_what_falls() {
    let rub = "friction: {rub: {rate: x', on: p, along: \"[1, 0]\", limit: b}}\n";
    let scene = "scene: {start: {x: 0, y: 0}, until: 3, tolerance: 1e-12}\n";
    for del in ["-1e-11", "-1e-14", "0", "1e-16", "1e-14", "1e-13", "1e-12", "1e-11", "1e-10", "1e-9"] {
        // Slips from 0 on: k t³/6; the force is −b, and slips, after the end of the run.
        for (rate, expected) in [("1 N/s", 4.5), ("0 N/s", 0.0), ("-0.9 N/s", 0.0)] {
            if rate != "1 N/s" && del == "1e-9" {
                continue;
            }
            let parameters = format!(", del: {del}, r: {rate}");
            let text = pushed(&parameters, "[b*(1 + del) + r*t, 0]", &format!("{rub}{scene}"));
            let run = case(&text).run();
            assert!((run.last()["x"] - expected).abs() < 1e-7, "{del}, {rate}: x = {}", run.last()["x"]);
        }
    }
    // 0.1 + 0.2 is more than 0.3.
    let more = format!("{rub}{scene}").replace("limit: b", "limit: l");
    let text = pushed(", one: 0.1 N, two: 0.2 N, l: 0.3 N, r: 1 N/s", "[one + two + r*t, 0]", &more);
    let mut grows = case(&text);
    for tolerance in [1e-10, 1e-11, 1e-12] {
        grows.settings.tolerance = tolerance;
        let run = grows.run();
        assert!((run.last()["x"] - 4.5).abs() < 1e-9, "x = {}", run.last()["x"]);
        assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    }
}

/// A run that ends at the printed instant of an event, and goes on from its saved state, is the run in one piece.
#[test]
fn a_run_goes_on_from_a_state_saved_at_an_event() {
    let folder = super::folder("saved-at-event");
    let state = folder.join("state.yaml");
    let state = state.to_str().expect("a path");
    let cases = [
        ("block_on_block", "2.49221378486", "3", "x", 0.0695150219),
        ("rope_that_goes_slack", "0.478684490851", "1.5", "x", -0.2011044858),
        ("clutch_and_brake", "0.26184372289604674", "6", "a", 2.8791798558),
    ];
    for (name, at, until, column, expected) in cases {
        printed("simulate", name, &["--until", at, "--save", state, "-q"]);
        let told = printed("simulate", name, &["--state", state, "--until", until, "--json", "--no-digits"]);
        let json: serde_json::Value = serde_json::from_str(&told).expect("JSON");
        let found = json["q"][column].as_f64().unwrap_or(f64::NAN);
        assert!((found - expected).abs() < 1e-8, "{name}: {column} = {found}\n{told}");
    }
    // The floor is struck by what comes to rest in this instant, so that its speed no longer tells how well the gap is known.
    let balls = format!("{}/../models/balls.yaml", env!("CARGO_MANIFEST_DIR"));
    super::program(&["simulate", &balls, "--until", "0.45152364098573083", "--save", state, "-q"]).expect("a run");
    let told = super::program(&["simulate", &balls, "--state", state, "--until", "0.6", "--json", "--no-digits"])
        .expect("a run");
    let json: serde_json::Value = serde_json::from_str(&told).expect("JSON");
    let c = json["q"]["c"].as_f64().unwrap_or(f64::NAN);
    assert!((c - 2.19370667879).abs() < 1e-9, "{c}");
    std::fs::remove_dir_all(folder).expect("removed");
}

/// A block that sticks is moved by hand to where the spring pulls harder than friction holds: to 0.2 m, whence it swings to 0.1 m.
#[test]
fn a_block_moved_by_hand_slips_if_the_spring_says_so() {
    let rub = "friction: {rub: {rate: x', on: p, along: \"[1, 0]\", limit: 3 N}}\n";
    let text = pushed("", "[-k*abs(x), 0]", &format!("{rub}scene: {{start: {{x: 0.1, y: 0}}, until: 2}}\n"));
    let case = case(&text);
    let mut block = dalembert::Stepping::new(case.system, case.settings).expect("a start");
    block.advance(0.1).expect("a run");
    assert_eq!(block.state()["x"], 0.1);
    block.state_mut().q[0] = 0.2;
    block.advance(1.0).expect("a run");
    let x = block.state()["x"];
    assert!((x - 0.1).abs() < 1e-8, "{x}");
}

/// A force towards x = 0 of 2 N, against friction of 1.5 N: swings from 1 m are 1/7 as high each, and end together at 3.67 s, where x stays 0.
#[test]
fn swings_that_end_at_a_discontinuity_end_there() {
    let rub = "friction: {rub: {rate: x', on: p, along: \"[1, 0]\", limit: b}}\n";
    let scene = "scene: {start: {x: 1, y: 0}, until: 10, tolerance: 1e-10}\n";
    let mut case = case(&pushed("", "[-a*sign(x), 0]", &format!("{rub}{scene}")));
    let run = case.run();
    assert!(run.last()["x"].abs() < 1e-12 && run.last()["x'"].abs() < 1e-9, "{:?}", run.last());
    // From 1 m at 0.5 m/s² in 2 s, with 1 m/s; from v: v/3.5 out, v²/7 high, and 2 v/√7 back, with v/√7.
    let (first, ratio) = (2.0, 1.0 / 7.0_f64.sqrt());
    let end = first + (1.0 / 3.5 + 2.0 * ratio) / (1.0 - ratio);
    let t = run.events.last().expect("stops").state.t;
    assert!((t - end).abs() < 1e-5, "{t} {end}");
}

/// The end of a step that is tried for years is far below the floor on which a ball lands, and is none of its motion: hops beside it looked too low
/// to be seen.
#[test]
fn a_ball_bounces_however_long_a_run_may_last() {
    let text = |until: &str, height: &str, end: &str| {
        format!(
            "name: Ball\nparameters: {{m: 1 kg, g: 9.81 m/s^2, end: {end} s}}\ncoordinates: {{y: m}}\n\
             bodies: {{b: {{mass: m, position: '[0, y]'}}}}\ngravity: [0, -g]\n\
             contacts: {{f: {{gap: y, on: b, normal: '[0, 1]', restitution: 0.8}}}}\n\
             events: {{end: {{when: t - end, then: stop}}}}\nscene: {{start: {{y: {height}}}, until: {until}}}\n"
        )
    };
    let fall = |height: f64| (2.0 * height / 9.81).sqrt();
    for (until, height) in [("1e9", 1.0), ("1e7", 1.0), ("1e13", 1.0), ("5", 1e-16), ("1e9", 1e-6)] {
        // After the first hop, which lasts 1.6 falls, and half of the second one, 1.28.
        let end = (1.0 + 1.6 + 0.64) * fall(height);
        let run = case(&text(until, &height.to_string(), &end.to_string())).run();
        let found = run.last()["y"];
        assert!((found / (0.8_f64.powi(4) * height) - 1.0).abs() < 1e-9, "until {until} from {height}: {found}");
    }
}

/// A block on another one, which is pulled by t newtons; their friction holds up to 1 N and up to q newtons, and then rubs with a half and a quarter
/// of 1 N.
fn pulled_pair(q: &str) -> String {
    format!(
        "name: Pair\nparameters: {{m: 1 kg, L: 1 N, T: 1 s}}\ncoordinates: {{x: m, y: m}}\n\
         bodies: {{a: {{mass: m, position: '[x, 0]'}}, b: {{mass: m, position: '[y, 1]'}}}}\ninputs: {{F: L*t/T}}\n\
         forces: {{pull: {{on: a, force: '[F, 0]'}}}}\n\
         friction:\n  f1: {{rate: x', on: a, along: '[1, 0]', limit: L/2, static: L}}\n  \
         f2: {{rate: x' - y', on: a, from: b, along: '[1, 0]', limit: L/4, static: {q}*L}}\nscene: {{start: {{}}, until: 4}}\n"
    )
}

/// Where the lower block breaks loose the upper one is held by just the force with which it would rub, 0.25 N: it sticks, though it might slide and move
/// alike for an instant.
#[test]
fn what_needs_just_the_force_of_sliding_sticks() {
    let together = |t: f64| {
        // 2 x'' = t - 0.5 from t = 1 on.
        let s = t - 1.0;
        (0.5 * s * s / 2.0) / 2.0 + s * s * s / 12.0
    };
    let run = case(&pulled_pair("2")).run();
    for name in ["x", "y"] {
        assert!((run.last()[name] - together(4.0)).abs() < 1e-9, "{} {}", run.last()[name], together(4.0));
    }
    assert_eq!(run.events.len(), 1);
}

/// Of three blocks on each other with the same friction two reach their limits at the same instant, and either of them may begin to slide.
#[test]
fn which_of_two_limits_gives_way_is_undecided() {
    let text = "name: Stack\nparameters: {m: 1 kg, g: 9.81 m/s^2, mu: 0.3, mus: 0.4, r: 10 N/s}\ncoordinates: {x: m, y: m, z: m}\n\
        bodies: {a: {mass: m, position: '[x, 0]'}, b: {mass: m, position: '[y, 1]'}, c: {mass: m, position: '[z, 2]'}}\n\
        forces: {pull: {on: a, force: '[r*t, 0]'}}\nfriction:\n\
        \x20 f1: {rate: x', on: a, along: '[1, 0]', limit: 3*mu*m*g, static: 3*mus*m*g}\n\
        \x20 f2: {rate: y' - x', on: b, from: a, along: '[1, 0]', limit: 2*mu*m*g, static: 2*mus*m*g}\n\
        \x20 f3: {rate: z' - y', on: c, from: b, along: '[1, 0]', limit: mu*m*g, static: mus*m*g}\n\
        scene: {start: {}, until: 4}\n";
    let failure = case(text).try_run().expect_err("two motions");
    match failure.cause() {
        Some(Cause::UndecidedContacts { found }) => assert_eq!(found.len(), 2, "{found:?}"),
        _ => panic!("{failure}"),
    }
    // A little rougher above, the lower one gives way.
    let run = case(&text.replace("static: mus*m*g", "static: 1.000001*mus*m*g")).run();
    assert!((run.last()["z"] - run.last()["y"]).abs() < 1e-12);
}

/// Newton's cradle: what one end loses the other takes over, and the balls between rest in contact.  Their gaps are differences of places some
/// centimetres away, whose rounding had a hundred thousand zeros in a step.
#[test]
fn balls_of_newtons_cradle_hang_at_rest_between_two_swings() {
    for n in [3, 5] {
        let text = format!(
            "name: Cradle\nsizes: {{n: {n}}}\nparameters: {{m: 0.1 kg, l: 0.2 m, R: 10 mm, g: 9.81 m/s^2}}\n\
             coordinates: {{'a[i in 1..n]': rad}}\npoints: {{'p[i in 1..n]': '[2*i*R + l*sin(a[i]), -l*cos(a[i])]'}}\n\
             bodies: {{'b[i in 1..n]': {{mass: m, position: 'p[i]'}}}}\ngravity: [0, -g]\n\
             contacts: {{'hit[i in 1..n-1]': {{gap: 'p[i+1].x - p[i].x - 2*R', on: 'b[i+1]', from: 'b[i]', normal: [1, 0], restitution: 1}}}}\n\
             impacts: sequential\nscene: {{start: {{'a[1]': -20 deg}}, until: 0.45201}}\n"
        );
        let run = case(&text).run();
        // After half a swing of each of them, the last one is as high as the first one was.
        let last = run.last();
        assert!((last.q[n - 1] - 20.0_f64.to_radians()).abs() < 1e-4, "{last}");
        assert!(last.q[..n - 1].iter().all(|a| a.abs() < 1e-9) && run.work.steps < 100, "{last}");
    }
}

/// Two masses lie on their stops, one lifts, and pulls the other: what the first step of all, beyond every stability, made of the reactions at its end
/// was no noise that errors may have.
#[test]
fn what_lifts_later_is_seen_by_the_tolerance() {
    let masses = "name: Two\nparameters: {m: 1 kg, k: 40 N/m, q: 1 N/s, P: 2 N}\ncoordinates: {a: m, b: m}\n\
                  bodies: {A: {mass: m, position: '[a, 0]'}, B: {mass: m, position: '[b, 1]'}}\n\
                  springs: {s: {stretch: b - a, stiffness: k}, g: {stretch: b, stiffness: k}}\n\
                  forces: {f: {on: A, force: '[q*t - P, 0]'}, h: {on: B, force: '[-P, 0]'}}\n\
                  contacts: {c: {gap: a, on: A, normal: '[1, 0]'}, d: {gap: b, on: B, normal: '[1, 0]'}}\n\
                  scene: {start: {a: 0}, until: 40}\n";
    // From t = 2 on a'' + 40 a = t - 2, and 40 a = 2 N lifts the other one.
    let lifts = |after: f64| after - f64::sin(f64::sqrt(40.0) * after) / f64::sqrt(40.0) - 2.0;
    let (mut low, mut high) = (2.0, 2.3);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if lifts(middle) < 0.0 { low = middle } else { high = middle }
    }
    for (method, tolerance) in [(Method::Dop853, 1e-6), (Method::Dop853, 1e-10), (Method::Taylor, 1e-9)] {
        let mut case = case(masses);
        (case.settings.method, case.settings.tolerance) = (method, tolerance);
        let run = case.run();
        let times: Vec<f64> = run.events.iter().map(|event| event.state.t).collect();
        assert!(
            times.len() == 2 && (times[1] - 2.0 - low).abs() < 100.0 * tolerance,
            "{method:?} {tolerance}: {times:?}"
        );
    }
}
