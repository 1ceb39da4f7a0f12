//! Contacts in space that rub: they slide in any direction, stop, begin to slide and strike.

use dalembert::{Cause, Method};

use super::{Case, case, folder, program};

/// A puck on a floor that may be tilted about y.
const PUCK: &str = r#"
name: Puck
parameters: {m: 2 kg, g: 10 m/s^2, mu: 0.3, v: 3 m/s, a: 0.4 rad, b: 0 rad}
coordinates: {x: m, y: m, z: m}
bodies: {puck: {mass: m, position: "[x, y, z]"}}
gravity: [0, 0, -g]
contacts: {floor: {gap: "x*sin(b) + z*cos(b)", on: puck, normal: "[sin(b), 0, cos(b)]", friction: mu}}
outputs: {T: reaction(floor.friction), N: reaction(floor)}
scene: {start: {x: 0, y: 0, z: 0, x': v*cos(a)*cos(b), y': v*sin(a), z': -v*cos(a)*sin(b)}, until: 2, tolerance: 1e-12}
"#;

/// A ball on a floor, with a start that is still to be said.
const BALL: &str = r#"
name: Ball
parameters: {m: 2 kg, R: 0.1 m, g: 10 m/s^2, mu: 0.3, e: 0.6}
coordinates: {x: m, y: m, z: m, att: rotation}
frames: {B: {rotate: att}}
bodies: {ball: {mass: m, inertia: ["2*m*R^2/5", "2*m*R^2/5", "2*m*R^2/5"], frame: B, position: "[x, y, z]"}}
gravity: [0, 0, -g]
contacts: {floor: {gap: z - R, on: ball, at: "[x, y, z - R]", normal: "[0, 0, 1]", friction: mu, restitution: e}}
outputs: {w: angular_velocity(ball), T: kinetic_energy}
"#;

fn quiet(text: &str) -> Case {
    let mut case = case(text);
    case.settings.digits = false;
    case
}

fn near(found: f64, expected: f64, within: f64, what: &str) {
    assert!((found - expected).abs() < within, "{what}: {found}, and not {expected}");
}

#[test]
fn a_puck_stops_where_it_would_in_the_plane() {
    let plane = "name: Plane\nparameters: {m: 2 kg, g: 10 m/s^2, mu: 0.3, v: 3 m/s}\ncoordinates: {x: m, y: m}\n\
                 bodies: {puck: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\n\
                 contacts: {floor: {gap: y, on: puck, normal: \"[0, 1]\", friction: mu}}\n\
                 scene: {start: {x: 0, y: 0, x': v}, until: 2, tolerance: 1e-12}\n";
    let way = quiet(plane).run().last()["x"];
    near(way, 1.5, 1e-11, "the plane");
    for angle in [0.0, 0.4, 2.0, -2.5] {
        let run = quiet(&PUCK.replace("a: 0.4", &format!("a: {angle}"))).run();
        near(run.last()["x"], way * f64::cos(angle), 1e-9, "x");
        near(run.last()["y"], way * f64::sin(angle), 1e-9, "y");
        let events: Vec<(&str, f64)> = run.events.iter().map(|event| (event.name.as_str(), event.state.t)).collect();
        let [("floor stops", t)] = events.as_slice() else { panic!("{angle}: {events:?}") };
        near(*t, 1.0, 1e-11, "the stop");
    }
}

/// Sliding on an incline of b with the speeds u down and w across, by many small steps of Runge and Kutta's method: places and speeds.
fn slid(mu: f64, b: f64, start: [f64; 2], time: f64) -> [f64; 4] {
    let rate = |y: [f64; 4]| {
        let speed = y[2].hypot(y[3]);
        [y[2], y[3], 10.0 * b.sin() - mu * 10.0 * b.cos() * y[2] / speed, -mu * 10.0 * b.cos() * y[3] / speed]
    };
    let (mut y, n) = ([0.0, 0.0, start[0], start[1]], 20_000);
    let h = time / f64::from(n);
    let moved = |y: [f64; 4], k: [f64; 4], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
    for _ in 0..n {
        let k1 = rate(y);
        let k2 = rate(moved(y, k1, h / 2.0));
        let k3 = rate(moved(y, k2, h / 2.0));
        let k4 = rate(moved(y, k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    }
    y
}

#[test]
fn a_puck_on_an_incline_turns_down_and_stops_where_it_is_rough_enough() {
    let b = 0.5_f64;
    for (mu, a, until) in [(0.7, 2.0, 0.6), (0.5, 2.6, 2.0), (0.5, 2.0, 2.0)] {
        let text = PUCK.replace("b: 0 rad", "b: 0.5 rad").replace("mu: 0.3", &format!("mu: {mu}"));
        let text = text.replace("a: 0.4", &format!("a: {a}"));
        let last = quiet(&text.replace("until: 2", &format!("until: {until}"))).run().last();
        let [x, y, u, w] = slid(mu, b, [3.0 * f64::cos(a), 3.0 * f64::sin(a)], until);
        let names = [("x", x * b.cos()), ("y", y), ("x'", u * b.cos()), ("y'", w), ("z", -x * b.sin())];
        names.into_iter().for_each(|(name, expected)| near(last[name], expected, 1e-9, name));
        let last = quiet(&text.replace("until: 2", "until: 9")).run().last();
        // Up the incline it holds m g sin b where tan b is less than mu.
        let stuck = mu > b.tan();
        assert_eq!(last["x'"] == 0.0, stuck);
        let held = (last["T.x"].powi(2) + last["T.z"].powi(2)).sqrt();
        near(held, if stuck { 20.0 * b.sin() } else { 0.0 }, 1e-9, "what holds");
    }
}

#[test]
fn what_slides_straight_up_an_incline_turns_round() {
    let text = PUCK.replace("b: 0 rad", "b: 0.5 rad").replace("a: 0.4", "a: pi");
    let run = quiet(&text).run();
    let (up, down) = (10.0 * (0.5_f64.sin() + 0.3 * 0.5_f64.cos()), 10.0 * (0.5_f64.sin() - 0.3 * 0.5_f64.cos()));
    let left = 2.0 - 3.0 / up;
    let way = -9.0 / (2.0 * up) + down * left * left / 2.0;
    near(run.last()["x"], way * 0.5_f64.cos(), 1e-10, "x");
    near(run.last()["y"], 0.0, 1e-12, "y");
}

#[test]
fn a_gap_need_be_no_distance() {
    let tilted = PUCK.replace("b: 0 rad", "b: 0.5 rad").replace("mu: 0.3", "mu: 0.4");
    let slope = tilted.replace("x*sin(b) + z*cos(b)", "z + x*tan(b)");
    let [one, other] = [tilted, slope].map(|text| quiet(&text).run().last());
    for name in ["x", "y", "z", "x'", "N"] {
        near(one[name], other[name], 1e-9, name);
    }
    let wrong = PUCK.replace("normal: \"[sin(b), 0, cos(b)]\"", "normal: \"[sin(b), 0.1, cos(b)]\"");
    let problems = dalembert_symbolic::lower::compile(&wrong, &[]).expect_err("another normal");
    assert_eq!(problems[0].code, "E462");
}

#[test]
fn a_thrown_ball_slides_along_a_parabola_and_rolls() {
    let start = "scene: {start: {x: 0, y: 0, z: R, x': 3, y': 1.2, att': {ground: [20, -30, 15]}}, until: 4, tolerance: 1e-12}\n";
    let run = quiet(&format!("{BALL}{start}")).run();
    let (v, w) = ([3.0, 1.2], [20.0, -30.0]);
    // s = v + w x (0, 0, -R); 2/7 of it are left to v.
    let s = [v[0] - 0.1 * w[1], v[1] + 0.1 * w[0]];
    let speed = f64::hypot(s[0], s[1]);
    let t = 2.0 * speed / (7.0 * 3.0);
    let stops: Vec<f64> = run.events.iter().map(|event| event.state.t).collect();
    assert_eq!(stops.len(), 1, "{:?}", run.events);
    near(stops[0], t, 1e-10, "rolls");
    for (k, (place, rate)) in [("x", "x'"), ("y", "y'")].into_iter().enumerate() {
        let rolls = v[k] - 2.0 / 7.0 * s[k];
        near(run.last()[rate], rolls, 1e-9, rate);
        near(run.last()[place], v[k] * t - 1.5 * t * t * s[k] / speed + rolls * (4.0 - t), 1e-9, place);
        // Rolling: v = w x (0, 0, R).
        let turns = if k == 0 { 0.1 * run.last()["w.y"] } else { -0.1 * run.last()["w.x"] };
        near(turns, rolls, 1e-9, "turns");
    }
    near(run.last()["w.z"], 15.0, 1e-9, "w.z");
}

/// A block that is pulled more and more, in a direction that turns.
const PULLED: &str = r#"
name: Pulled
parameters: {m: 2 kg, g: 10 m/s^2, mu: 0.3, mus: 0.4, k: 4 N/s, w: 0.7 rad/s}
coordinates: {x: m, y: m, z: m}
bodies: {puck: {mass: m, position: "[x, y, z]"}}
gravity: [0, 0, -g]
forces: {pull: {on: puck, force: "[k*t*cos(w*t), k*t*sin(w*t), 0]"}}
contacts: {floor: {gap: z, on: puck, normal: "[0, 0, 1]", friction: mu, static: mus}}
scene: {start: {x: 0, y: 0, z: 0}, until: 2.001, tolerance: 1e-11}
"#;

#[test]
fn a_block_begins_to_slide_where_it_is_pulled() {
    let run = quiet(PULLED).run();
    near(run.events[0].state.t, 2.0, 1e-12, "slips");
    let (along, beside) = (f64::cos(1.4), f64::sin(1.4));
    let [x, y] = ["x'", "y'"].map(|name| run.last()[name]);
    // In 1 ms with (8 - 6) N, and more; the pull turns by 0.7 mrad meanwhile.
    near(x * along + y * beside, 1e-3, 2e-6, "along");
    near(y * along - x * beside, 0.0, 2e-6, "beside");
    assert!(run.contacts()[0].held.is_some_and(|held| (held - 1.0).abs() < 1e-9));
    // At its limit it does not move at first; explicit steps and implicit ones find one motion.
    let text = PULLED.replace("mus: 0.4", "mus: 0.3").replace("until: 2.001", "until: 2").replace("1e-11", "1e-7");
    let [one, other] = [Method::Dop853, Method::Radau5].map(|method| {
        let mut case = quiet(&text);
        case.settings.method = method;
        case.run().last()
    });
    ["x", "y", "x'", "y'"].into_iter().for_each(|name| near(one[name], other[name], 1e-6, name));
}

#[test]
fn a_ball_that_bounces_is_rubbed_within_the_cone() {
    let start = "scene: {start: {x: 0, y: 0, z: 0.6, x': 1.2, y': -0.7, att': {ground: [20, -30, 15]}}, until: 1.25, tolerance: 1e-11}\n";
    let run = quiet(&format!("{BALL}{start}").replace("mu: 0.3", "mu: 0.15")).run();
    let of =
        |k: usize, name: &str| run.impulses[k].constraints.iter().find(|(known, _)| known == name).map_or(0.0, |p| p.1);
    let mut sliding = 0;
    for k in 0..run.impulses.len() {
        let [n, a, b] = ["floor", "floor.friction.1", "floor.friction.2"].map(|name| of(k, name));
        assert!(f64::hypot(a, b) <= 0.15 * n * (1.0 + 1e-9) + 1e-12, "{k}: {n} {a} {b}");
        assert!(run.impulses[k].energy < 0.0, "{k}");
        sliding += usize::from((f64::hypot(a, b) - 0.15 * n).abs() < 1e-9 * n);
    }
    // s = (4.2, 1.3) m/s; each N s takes 7/(2 m) of it, until it sticks in the third impact.
    assert_eq!(sliding, 2);
    let struck = 0.15 * 2.0 * 1.6 * 10.0_f64.sqrt();
    let s = f64::hypot(4.2, 1.3);
    near(of(0, "floor.friction.1"), -struck * 4.2 / s, 1e-9, "against the sliding");
    near(of(0, "floor.friction.2"), -struck * 1.3 / s, 1e-9, "against the sliding");
}

#[test]
fn impacts_in_space_are_those_of_the_plane() {
    // A rod falls onto its lower end: what holds the end is not across what presses it.
    let space = r#"
name: Rod
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, a: 45 deg, mu: 0.2, mus: 0.7, v: 2 m/s, u: 0 m/s}
coordinates: {x: m, y: m, z: m, th: rad, ps: rad}
frames: {B: {rotate: [[z, ps], [y, "-th"]]}}
points: {tip: "[x, y, z] - l/2*B.x"}
bodies: {rod: {mass: m, inertia: [0, "m*l^2/12", "m*l^2/12"], frame: B, position: "[x, y, z]"}}
gravity: [0, 0, -g]
contacts: {floor: {gap: tip.z, on: rod, at: tip, normal: "[0, 0, 1]", friction: mu, static: mus}}
scene: {start: {x: 0, y: 0, z: l/2*sin(a), th: a, ps: 0.3, z': -v, x': u*cos(0.3), y': u*sin(0.3)}, until: 0.2, tolerance: 1e-11}
"#;
    let plane = r#"
name: Rod
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, a: 45 deg, mu: 0.2, mus: 0.7, v: 2 m/s, u: 0 m/s}
coordinates: {x: m, y: m, th: rad}
points: {tip: "[x, y] - l/2*[cos(th), sin(th)]"}
bodies: {rod: {mass: m, inertia: m*l^2/12, angle: th, position: "[x, y]"}}
gravity: [0, -g]
contacts: {floor: {gap: tip.y, on: rod, at: tip, normal: "[0, 1]", friction: mu, static: mus}}
scene: {start: {x: 0, y: l/2*sin(a), th: a, y': -v, x': u}, until: 0.2, tolerance: 1e-11}
"#;
    for (mus, u) in [(0.7, 0.0), (0.2, 0.0), (0.7, 1.0), (0.7, -3.0), (0.3, 0.2)] {
        let set = |text: &str| text.replace("mus: 0.7", &format!("mus: {mus}")).replace("u: 0 m", &format!("u: {u} m"));
        let (one, other) = (quiet(&set(space)).run(), quiet(&set(plane)).run());
        let (one, other) = (one.last(), other.last());
        for (name, expected) in [("x", other["x"] * 0.3_f64.cos()), ("y", other["x"] * 0.3_f64.sin())] {
            near(one[name], expected, 1e-9, name);
        }
        for (name, plain) in [("z", "y"), ("th", "th"), ("th'", "th'"), ("z'", "y'")] {
            near(one[name], other[plain], 1e-8, name);
        }
        near(one["ps"], 0.3, 1e-9, "ps");
    }
}

/// A body on three feet that slides and turns: one foot stops before the others.
const TRIPOD: &str = r#"
name: Tripod
parameters: {m: 2 kg, r: 0.2 m, hc: 0.05 m, g: 10 m/s^2, mu: 0.3, v: 1 m/s, w: 8 rad/s}
coordinates: {x: m, y: m, z: m, al: rad, be: rad, ga: rad}
frames: {B: {rotate: [[z, ga], [y, be], [x, al]]}}
points:
  c: "[x, y, z]"
  p1: c + r*B.x - hc*B.z
  p2: c + r*(-B.x/2 + sqrt(3)/2*B.y) - hc*B.z
  p3: c + r*(-B.x/2 - sqrt(3)/2*B.y) - hc*B.z
bodies: {top: {mass: m, inertia: ["m*r^2/4", "m*r^2/4", "m*r^2/2"], frame: B, position: c}}
gravity: [0, 0, -g]
contacts:
  one: {gap: p1.z, on: top, at: p1, normal: "[0, 0, 1]", friction: mu}
  two: {gap: p2.z, on: top, at: p2, normal: "[0, 0, 1]", friction: mu}
  six: {gap: p3.z, on: top, at: p3, normal: "[0, 0, 1]", friction: mu}
scene: {start: {x: 0, y: 0, z: hc, x': v, ga': w}, until: 1, tolerance: 1e-9}
"#;

#[test]
fn feet_stop_one_before_the_others_and_these_together() {
    let mut case = quiet(TRIPOD);
    let mut ends = Vec::new();
    for tolerance in [1e-6, 1e-8, 1e-10, 1e-12] {
        case.settings.tolerance = tolerance;
        let run = case.run();
        let stops: Vec<f64> = run.events.iter().map(|event| event.state.t).collect();
        assert_eq!(stops.len(), 2, "{tolerance:e}: {:?}", run.events);
        let still = ["x'", "y'", "ga'"].map(|name| run.last()[name].abs());
        assert!(still.iter().all(|rate| *rate < 1e-12), "{still:?}");
        ends.push([run.last()["x"], run.last()["y"], run.last()["ga"], stops[0], stops[1]]);
    }
    for (end, within) in ends.iter().zip([1e-5, 1e-7, 1e-9]) {
        (0..5).for_each(|k| near(end[k], ends[3][k], within, "the end"));
    }
}

#[test]
fn a_coin_on_its_edge_slides_until_it_rolls() {
    let text = r#"
name: Coin
parameters: {m: 1 kg, r: 0.1 m, g: 9.81 m/s^2, mu: 0.3, th0: 0.3 rad, w: 12 rad/s}
coordinates: {x: m, y: m, z: m, psi: rad, th: rad, phi: rad}
frames:
  A: {rotate: [z, psi]}
  L: {from: A, rotate: [x, th]}
  B: {from: L, rotate: [y, phi]}
points: {c: "[x, y, z]", p: c - r*L.z}
bodies: {coin: {mass: m, inertia: ["m*r^2/4", "m*r^2/2", "m*r^2/4"], frame: B, position: c}}
gravity: [0, 0, -g]
contacts: {floor: {gap: p.z, on: coin, at: p, normal: "[0, 0, 1]", friction: mu}}
outputs: {E: energy, s: "norm(velocity(coin, p))"}
scene: {start: {x: 0, y: 0, z: r*cos(th0), th: th0, phi': w, psi': 1, x': 0.2, z': 0}, until: 1.5, tolerance: 1e-9}
"#;
    let mut case = quiet(text);
    let rough = case.run();
    case.settings.tolerance = 1e-12;
    let fine = case.run();
    for name in ["x", "y", "th", "psi"] {
        near(rough.last()[name], fine.last()[name], 1e-6, name);
    }
    let [stops, again] = [&rough, &fine].map(|run| run.events[0].state.t);
    near(stops, again, 1e-9, "rolls");
    near(fine.last()["s"], 0.0, 1e-11, "s");
    // What rolls loses nothing.
    case.settings.until = again + 1e-3;
    near(case.run().last()["E"], fine.last()["E"], 1e-10, "the energy");
}

#[test]
fn what_is_rubbed_rubs_back() {
    let text = r#"
name: Turntable
parameters: {m: 2 kg, M: 30 kg, r: 1 m, g: 10 m/s^2, mu: 0.3, W: 2 rad/s, x0: 0.5 m}
coordinates: {x: m, y: m, z: m, ga: rad}
frames: {T: {rotate: [z, ga]}}
bodies:
  plate: {mass: M, inertia: ["M*r^2/4", "M*r^2/4", "M*r^2/2"], frame: T, position: "[0, 0, 0]"}
  block: {mass: m, position: "[x, y, z]"}
gravity: [0, 0, -g]
contacts: {rub: {gap: z, on: block, from: plate, normal: "[0, 0, 1]", friction: mu}}
conserved: {L: "angular_momentum([0, 0, 0]).z"}
outputs: {s: "norm([x' + ga'*y, y' - ga'*x, 0])", R2: x^2 + y^2}
scene: {start: {x: x0, y: 0, z: 0, ga': W}, until: 5, tolerance: 1e-11}
"#;
    let run = quiet(text).run();
    assert!(run.drift[0].value.is_some_and(|drift| drift < 1e-11));
    near(run.last()["s"], 0.0, 1e-10, "s");
    near(run.last()["ga'"], 30.0 / (15.0 + 2.0 * run.last()["R2"]), 1e-9, "turns with it");
}

#[test]
fn a_puck_in_a_bowl_comes_to_rest_on_its_side() {
    let text = r#"
name: Bowl
parameters: {m: 2 kg, R: 1 m, g: 10 m/s^2, mu: 0.1, v: 2 m/s}
coordinates: {x: m, y: m, z: m}
bodies: {puck: {mass: m, position: "[x, y, z]"}}
gravity: [0, 0, -g]
contacts: {bowl: {gap: "R - norm([x, y, z])", on: puck, normal: "-[x, y, z]", friction: mu}}
outputs: {T: reaction(bowl.friction), N: reaction(bowl)}
checks: {loses: {holds: "rate(energy) = -mu*reaction(bowl)*norm([x', y', z'])", phase: bowl slides}}
balances:
  equations: [{force: {of: [puck]}}]
scene: {start: {x: 0.8, y: 0, z: -0.6, y': v}, until: 6, tolerance: 1e-11}
"#;
    let last = quiet(text).run().last();
    // What holds it is its weight, less the force across.
    let [x, y, z, n] = ["x", "y", "z", "N"].map(|name| last[name]);
    near(n, -20.0 * z, 1e-9, "N");
    near(last["T.x"], n * x, 1e-9, "T.x");
    near(last["T.y"], n * y, 1e-9, "T.y");
    near(last["T.z"], 20.0 + n * z, 1e-9, "T.z");
}

#[test]
fn what_slides_in_space_goes_on_from_a_saved_state() {
    let mut whole = quiet(&PUCK.replace("b: 0 rad", "b: 0.5 rad").replace("mu: 0.3", "mu: 0.6"));
    whole.settings.until = 1.0;
    let end = whole.run().last();
    whole.settings.until = 0.25;
    let half = whole.run().last();
    let mut rest = quiet(&PUCK.replace("b: 0 rad", "b: 0.5 rad").replace("mu: 0.3", "mu: 0.6"));
    for (k, (place, rate)) in [("x", "x'"), ("y", "y'"), ("z", "z'")].into_iter().enumerate() {
        (rest.settings.q[k], rest.settings.v[k]) = (half[place], half[rate]);
    }
    (rest.settings.from, rest.settings.until) = (0.25, 1.0);
    let again = rest.run().last();
    ["x", "y", "x'"].into_iter().for_each(|name| near(again[name], end[name], 1e-10, name));
}

#[test]
fn what_cannot_follow_a_direction_says_so() {
    let folder = folder("rubbing");
    let path = folder.join("puck.yaml");
    std::fs::write(&path, PUCK).expect("a file");
    let path = path.to_str().expect("a path");
    let refused = |arguments: &[&str]| program(arguments).expect_err("refused");
    let told = refused(&["simulate", path, "--slopes", "mu"]);
    assert!(told.contains("contacts slide in space"), "{told}");
    let told = refused(&["orbit", path]);
    assert!(told.contains("slide in space"), "{told}");
    let told = refused(&["simulate", path, "--method", "verlet", "--step", "0.01"]);
    assert!(told.contains("forces are made of reactions"), "{told}");
    let told = refused(&["modes", path]);
    assert!(told.contains("`floor` slides in space"), "{told}");
    program(&["modes", path, "--phase", "floor sticks"]).expect("it rests");
    let told = refused(&["export", path, "--fmu", folder.join("puck.fmu").to_str().expect("a path")]);
    assert!(told.contains("`floor`: what contacts"), "{told}");
    std::fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn a_ball_that_spins_after_it_struck_flies_on() {
    // It rolls from the first impact on, with 5/7 of its speed; what does not turn about z stays 0 beside what turns fast.
    let thrown = format!(
        "{}scene: {{start: {{z: 0.5 m, x': 3 m/s, y': 0.3 m/s}}, until: 3}}\n",
        BALL.replace("e: 0.6", "e: 0.5").trim_start()
    );
    let mut ball = quiet(&thrown);
    let run = ball.run();
    let lands = f64::sqrt(0.08);
    near(run.last()["x"], 3.0 * lands + 15.0 / 7.0 * (3.0 - lands), 1e-8, "x");
    near(run.last()["y'"], 1.5 / 7.0, 1e-9, "y'");
    assert!(run.work.evaluations < 5000, "{:?}", run.work);
}

/// A sled on two feet, pushed ever more.
const SLED: &str = "
name: Sled
parameters: {m: 8 kg, a: 0.5 m, mu: 0.3, mus: 0.35, r: 40 N/s, g: 9.81 m/s^2, I: 1 kg*m^2}
coordinates: {x: m, y: m, th: rad}
bodies: {bar: {mass: m, inertia: I, angle: th, position: '[x, y]'}}
points: {A: '[x, y] + a*[cos(th), sin(th)]', B: '[x, y] - a*[cos(th), sin(th)]'}
gravity: [0, -g]
inputs: {f: r*t}
forces: {push: {on: bar, force: '[f, 0]'}}
contacts:
  c1: {gap: A.y, on: bar, at: A, normal: ground.y, friction: mu, static: mus}
  c2: {gap: B.y, on: bar, at: B, normal: ground.y, friction: mu, static: mus}
outputs: {F1: reaction(c1.friction), F2: reaction(c2.friction)}
scene: {until: 1, tolerance: 1e-11}
";

/// x at 1 s of what is pushed by r t once that is more than the limit, and rubs with less; m = 8 kg.
fn pushed(limit: f64, rubs: f64) -> f64 {
    let (r, m) = (40.0, 8.0);
    let late = 1.0 - limit / r;
    ((limit - rubs) * late.powi(2) / 2.0 + r * late.powi(3) / 6.0) / m
}

#[test]
fn two_feet_stick_until_both_are_at_their_limits() {
    let weight = 8.0 * 9.81;
    let last = |text: &str| case(text).run().last();
    let right = pushed(0.35 * weight, 0.3 * weight);
    assert!((last(SLED)["x"] - right).abs() < 1e-9, "{} {right}", last(SLED)["x"]);
    let alike = SLED.replace(", static: mus", "");
    assert!((last(&alike)["x"] - pushed(0.3 * weight, 0.3 * weight)).abs() < 1e-9);
    // The foot that bears more takes more: the centre is not in the middle.
    let uneven = SLED.replace("A: '[x, y] + a*", "A: '[x, y] + 3*a*");
    assert!((last(&uneven)["x"] - right).abs() < 1e-9, "{} {right}", last(&uneven)["x"]);
    // Less than both can hold moves nothing, though more than one foot holds beside one that slides; they share it.
    let held = last(&SLED.replace("r*t", "26 N"));
    assert!(held["x"] == 0.0 && (held["F1"] + 13.0).abs() < 1e-12 && (held["F2"] + 13.0).abs() < 1e-12, "{held}");
    let run = case(&SLED.replace("r*t", "27.5 N")).run();
    assert!((run.last()["x"] - (27.5 - 0.3 * weight) / 16.0).abs() < 1e-9, "{}", run.last());
    // Events of reactions are of the share that is told.
    let watched =
        format!("{SLED}events: {{half: {{when: reaction(c1.friction) + F, direction: falling, then: record}}}}\n")
            .replace("m: 8 kg", "m: 8 kg, F: 5 N");
    let run = case(&watched).run();
    let half = run.events.iter().find(|event| event.name == "half").expect("an event");
    assert!((half.state.t - 0.25).abs() < 1e-9, "{half:?}");
    // Two carriages that a rod couples, each with its own friction.
    let coupled = "name: Coupled\nparameters: {m: 4 kg, L: 5 N, r: 40 N/s, l: 1 m}\ncoordinates: {x: m, w: m}\ninputs: {f: r*t}\n\
        bodies: {b: {mass: m, position: '[x, 0]'}, c: {mass: m, position: '[w, 1]'}}\nconstraints: {rod: w - x - l}\n\
        forces: {push: {on: b, force: '[f, 0]'}}\n\
        friction:\n  r1: {rate: x', on: b, along: ground.x, limit: L, static: 1.2*L}\n  \
        r2: {rate: w', on: c, along: ground.x, limit: 2*L, static: 2.4*L}\n\
        scene: {start: {w: 1}, until: 1, tolerance: 1e-11}\n";
    assert!((last(coupled)["x"] - pushed(18.0, 15.0)).abs() < 1e-9, "{}", last(coupled));
}

/// A cabinet on two feet that a rope draws by jerks: u = v t − x swings about μ m g/k while it slides, and x' = 0 again where u' = v.
#[test]
fn two_feet_stick_again_together() {
    let text = "name: Cabinet\nparameters: {m: 40 kg, k: 900 N/m, mu: 0.25, mus: 0.32, b: 0.4 m, h: 0.5 m, I: 4 kg*m^2, v: 0.2 m/s, g: 9.81 m/s^2}\n\
        coordinates: {x: m, y: m, th: rad}\ninputs: {hand: v*t}\n\
        points:\n  left: '[x, y] + b*[-cos(th), -sin(th)] - h*[-sin(th), cos(th)]'\n  \
        right: '[x, y] + b*[cos(th), sin(th)] - h*[-sin(th), cos(th)]'\n  grip: '[x, y] - h/2*[-sin(th), cos(th)]'\n\
        bodies: {box: {mass: m, inertia: I, angle: th, position: '[x, y]'}}\ngravity: [0, -g]\n\
        springs: {rope: {stretch: hand - x, stiffness: k, on: box, at: grip, along: '[-1, 0]'}}\n\
        contacts:\n  l: {gap: left.y, on: box, at: left, normal: '[0, 1]', friction: mu, static: mus}\n  \
        r: {gap: right.y, on: box, at: right, normal: '[0, 1]', friction: mu, static: mus}\n\
        scene: {start: {y: h}, until: 6, tolerance: 1e-11}\n";
    let (k, v, weight) = (900.0, 0.2, 40.0 * 9.81_f64);
    let (slides, w) = (0.25 * weight / k, (900.0_f64 / 40.0).sqrt());
    let (swing, turn) = (0.07 * weight / k, v / w);
    let slip = 2.0 * (std::f64::consts::PI - swing.atan2(turn)) / w;
    let left = slides + swing * (w * slip).cos() + turn * (w * slip).sin();
    let (first, stuck) = (0.32 * weight / (k * v), (slides + swing - left) / v);
    let right: Vec<f64> = (0..4).map(|i| first + f64::from(i) * (slip + stuck)).flat_map(|t| [t, t + slip]).collect();
    let run = case(text).run();
    let found: Vec<f64> = run.events.iter().map(|event| event.state.t).collect();
    assert_eq!(found.len(), 16, "{:?}", run.events.iter().map(|event| event.name.as_str()).collect::<Vec<_>>());
    for (pair, right) in found.chunks(2).zip(right) {
        assert!((pair[0] - right).abs() < 1e-8 && (pair[1] - right).abs() < 1e-8, "{pair:?} {right}");
    }
}

#[test]
fn feet_in_space_stick_until_all_are_at_their_limits() {
    let feet = |rub: &str, direction: &str| {
        format!(
            "name: Bar\nparameters: {{m: 8 kg, a: 0.5 m, r: 40 N/s, g: 9.81 m/s^2, I: 1 kg*m^2, th: {direction} rad}}\n\
             coordinates: {{x: m, y: m, z: m, psi: rad, be: rad}}\nframes: {{B: {{rotate: [[z, psi], [y, be]]}}}}\n\
             bodies: {{bar: {{mass: m, inertia: [0, I, I], frame: B, position: '[x, y, z]'}}}}\n\
             points: {{L1: '[x, y, z] + a*B.x', L2: '[x, y, z] - a*B.x'}}\ngravity: [0, 0, -g]\ninputs: {{f: r*t}}\n\
             forces: {{push: {{on: bar, force: 'f*[cos(th), sin(th), 0]'}}}}\nimpacts: together\n\
             contacts:\n  c1: {{gap: L1.z, on: bar, at: L1, normal: ground.z, {rub}}}\n  \
             c2: {{gap: L2.z, on: bar, at: L2, normal: ground.z, {rub}}}\nscene: {{until: 1}}\n"
        )
    };
    let weight = 8.0 * 9.81;
    for (rub, rubs) in [("friction: 0.3, static: 0.35", 0.3), ("friction: 0.35", 0.35)] {
        for direction in [0.0, 0.3, 0.5, 0.7, 1.2, 1.4_f64] {
            let run = case(&feet(rub, &direction.to_string())).run();
            let last = run.last();
            let right = pushed(0.35 * weight, rubs * weight);
            assert!((last["x"] - right * direction.cos()).abs() < 1e-8, "{rub} {direction}: {last} {right}");
            assert!((last["y"] - right * direction.sin()).abs() < 1e-8 && last["psi"].abs() < 1e-6, "{last}");
            // What begins with no force left over is stiff.
            assert_eq!(run.method == Method::Radau5, !rub.contains("static"), "{}", run.method);
        }
    }
}

#[test]
fn rates_that_depend_on_each_other_have_combinations_that_no_motion_passes() {
    // A pair of gears with dry bearings: one slips forwards where the other one slips backwards.
    let run = case(
        "name: Gears\nparameters: {J1: 0.1 kg*m^2, J2: 0.4 kg*m^2, N: 3, M1: 0.2 N*m, M2: 0.5 N*m}\n\
         coordinates: {a: rad, b: rad}\n\
         bodies: {w1: {mass: 0, inertia: J1, angle: a, position: '[0, 0]'}, w2: {mass: 0, inertia: J2, angle: b, position: '[1, 0]'}}\n\
         constraints: {gear: a + N*b}\n\
         friction:\n  f1: {rate: a', on: w1, limit: M1}\n  f2: {rate: b', on: w2, limit: M2}\n\
         scene: {start: {a': 10}, until: 2, tolerance: 1e-11}\n",
    )
    .run();
    // (J1 + J2/N²) a'' = −M1 − M2/N.
    let slows = (0.2 + 0.5 / 3.0) / (0.1 + 0.4 / 9.0);
    assert!((run.last()["a'"] - (10.0 - 2.0 * slows)).abs() < 1e-9, "{}", run.last());
}

#[test]
fn a_piston_passes_its_dead_centres_though_it_rubs() {
    // The rate of the piston depends on those of the loop there, for an instant.
    let loops = "name: Crank\nparameters: {r: 0.1 m, l: 0.3 m, J: 0.02 kg*m^2, mp: 1 kg, Mc: 0.1 N*m, Fp: 2 N}\n\
        coordinates: {a: rad, b: rad, x: m}\npoints: {O: '[0, 0]'}\n\
        bodies: {crank: {mass: 0, inertia: J, angle: a, position: O}, piston: {mass: mp, position: '[x, 0]'}}\n\
        constraints: {cx: r*cos(a) + l*cos(b) - x, cy: r*sin(a) + l*sin(b)}\n\
        friction:\n  f1: {rate: a', on: crank, limit: Mc}\n  f2: {rate: x', on: piston, along: ground.x, limit: Fp}\n\
        scene: {start: {a: 0.3, a': 12}, guess: {x: 0.4}, until: 1, tolerance: 1e-10}\n";
    let place = "r*cos(a) + sqrt(l^2 - (r*sin(a))^2)";
    let minimal = loops
        .replace("{a: rad, b: rad, x: m}", "{a: rad}")
        .replace("constraints: {cx: r*cos(a) + l*cos(b) - x, cy: r*sin(a) + l*sin(b)}\n", "")
        .replace("'[x, 0]'", &format!("'[{place}, 0]'"))
        .replace("rate: x'", "rate: velocity(piston).x")
        .replace(" guess: {x: 0.4},", "");
    for change in [("Mc: 0.1", "Mc: 0.1"), ("f1: {rate: a', on: crank, limit: Mc}\n  ", "")] {
        let [found, twin] = [loops, &minimal].map(|text| case(&text.replace(change.0, change.1)).run());
        for name in ["a", "a'"] {
            let (found, twin) = (found.last()[name], twin.last()[name]);
            assert!((found - twin).abs() < 1e-7, "{name}: {found} {twin}");
        }
        assert_eq!(found.events.len(), 2, "{:?}", found.events);
    }
}

#[test]
fn friction_that_would_drive_is_refused_where_it_strikes() {
    let ball = "name: Ball\nparameters: {m: 1 kg, g: 9.81 m/s^2}\ncoordinates: {x: m, y: m}\nbodies: {b: {mass: m, position: '[x, y]'}}\n\
        gravity: [0, -g]\ncontacts: {floor: {gap: y, on: b, normal: '[0, 1]', friction: -0.3, restitution: 0.5}}\n\
        scene: {start: {y: 1, x': 2}, until: 0.8}\n";
    let error = case(ball).try_run().unwrap_err();
    assert!(matches!(error.cause(), Some(Cause::NegativeLimit { .. })), "{error}");
    assert!(case(&ball.replace("-0.3", "0.3")).try_run().is_ok());
}

/// A stool on three legs that slides and turns: the legs come to rest one after the other, with rates of which the direction is rounding (`static below
/// limit` of a file without `static`, and `step too small`, before).
#[test]
fn a_stool_comes_to_rest_from_any_speed() {
    for speed in [0.2, 1.2, 1.4, 2.0] {
        let stool = format!(
            "name: Stool\nparameters: {{m: 3 kg, g: 9.81 m/s^2, mu: 0.3 1, h: 0.25 m, b: 0.4 m, J: 0.2 kg*m^2}}\n\
             coordinates: {{x: m, y: m, z: m, att: rotation}}\nframes: {{B: {{rotate: att}}}}\n\
             points:\n  c: '[x, y, z]'\n  f1: c + b*B.x - h*B.z\n  f2: c - b/2*B.x + b*sqrt(3)/2*B.y - h*B.z\n  \
             f3: c - b/2*B.x - b*sqrt(3)/2*B.y - h*B.z\n\
             bodies: {{stool: {{mass: m, inertia: [J, J, 1.3*J], frame: B, position: c}}}}\ngravity: [0, 0, -g]\ncontacts:\n  \
             l1: {{gap: f1.z, on: stool, at: f1, normal: '[0, 0, 1]', friction: mu}}\n  \
             l2: {{gap: f2.z, on: stool, at: f2, normal: '[0, 0, 1]', friction: mu}}\n  \
             l3: {{gap: f3.z, on: stool, at: f3, normal: '[0, 0, 1]', friction: mu}}\n\
             scene: {{start: {{z: h, x': {speed}, y': 0.3, att': [0, 0, 4]}}, until: 2, tolerance: 1e-9}}\n"
        );
        let last = case(&stool).run().last();
        assert!(last["x'"].abs() + last["y'"].abs() < 1e-9, "{speed}: {last}");
    }
}

/// A block on a belt, whose friction falls as it slides faster: what begins to slip there moves by the square of the time, and the faster the faster it
/// does. A step that was too long to show it let it slip to the other side, and stop at once, again and again.
const FALLING: &str = r#"
name: Falling
parameters: {m: 1 kg, k: 20 N/m, N: 10 N, mud: 0.2 1, mus: 0.4 1, vs: 0.05 m/s, vb: 0.1 m/s}
coordinates: {x: m}
bodies: {b: {mass: m, position: "[x, 0]"}}
springs: {s: {stretch: x, stiffness: k, on: b, along: "[1, 0]"}}
friction: {rub: {rate: x' - vb, on: b, along: "[1, 0]", limit: "N*(mud + (mus - mud)*exp(-abs(x' - vb)/vs))", static: N*mus}}
scene: {start: {x: 0, x': 0.1}, until: 10}
"#;

#[test]
fn friction_that_falls_lets_slip_once() {
    let methods = [(Method::Dopri5, 1e-3), (Method::Rodas5P, 1e-9), (Method::Radau5, 1e-3), (Method::Dop853, 1e-9)];
    for (method, tolerance) in methods {
        let mut case = case(FALLING);
        (case.settings.method, case.settings.tolerance) = (method, tolerance);
        let run = case.run();
        let slips: Vec<f64> =
            run.events.iter().filter(|event| event.name == "rub slips").map(|event| event.state.t).collect();
        // k vb t = N mus first; then from SciPy's DOP853 at 1e-12.
        let known = [2.0, 4.9505344, 7.9010688];
        assert_eq!(slips.len(), known.len(), "{method}: {slips:?}");
        let off = slips.iter().zip(known).map(|(found, known)| (found - known).abs()).fold(0.0, f64::max);
        assert!(off < (10.0 * tolerance).max(1e-7), "{method}: {slips:?}");
    }
}
