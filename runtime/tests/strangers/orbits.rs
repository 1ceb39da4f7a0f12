//! Motions that repeat.

use super::{folder, program};

/// What `orbit` prints of a model text.
fn orbit(name: &str, text: &str, arguments: &[&str]) -> Result<String, String> {
    let file = folder("orbits").join(format!("{name}.yaml"));
    std::fs::write(&file, text).expect("a file");
    program(&[&["orbit", file.to_str().expect("a path")], arguments].concat())
}

fn number(line: &str) -> f64 {
    line.split_whitespace().next().and_then(|x| x.parse().ok()).unwrap_or_else(|| panic!("{line}"))
}

fn period(printed: &str) -> f64 {
    printed.split_once("period = ").map(|(_, rest)| number(rest)).unwrap_or_else(|| panic!("{printed}"))
}

/// The multipliers of the map, as real and imaginary parts in their order.
fn multipliers(printed: &str) -> Vec<f64> {
    let line =
        printed.lines().find_map(|line| line.strip_prefix("multipliers ")).unwrap_or_else(|| panic!("{printed}"));
    let words = line.split_once('(').map_or(line, |(all, _)| all).replace("- ", "-").replace(',', " ");
    let mut found: Vec<f64> = words.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    found.sort_by(f64::total_cmp);
    found
}

/// A cart of 1 kg with a bob of 1 kg on 1 m below.
const CART: &str = "
name: Cart
parameters: {M: 1 kg, m: 1 kg, l: 1 m, g: 9.81 m/s^2}
coordinates: {x: m, th: rad}
points: {C: \"[x, 0]\", P: \"C + l*[sin(th), -cos(th)]\"}
bodies: {cart: {mass: M, position: C}, bob: {mass: m, position: P}}
gravity: [0, -g]
scene: {start: {th: 1}, until: 3}
";

/// Its period without momentum, T = 4 ∫ sqrt((1 − cos²θ/2)/(2(E − g(1 − cos θ)))) dθ with θ = θ₀ sin s.
fn cart_period(energy: f64) -> f64 {
    let top = (1.0 - energy / 9.81).acos();
    let n = 400;
    let all = (0..n).map(|k| {
        let s = (f64::from(k) + 0.5) * std::f64::consts::TAU / f64::from(n);
        let th = top * s.sin();
        let left = energy - 9.81 * (1.0 - th.cos());
        ((1.0 - 0.5 * th.cos().powi(2)) / (2.0 * left)).sqrt() * (top * s.cos()).abs()
    });
    all.sum::<f64>() * std::f64::consts::TAU / f64::from(n)
}

#[test]
fn a_momentum_that_nobody_claimed_was_told_as_doublings() {
    let found = orbit("family", CART, &["--from", "mode 2", "--vary", "energy=..5"]).expect("a family");
    assert!(!found.contains("doubling") && !found.contains("branch"), "{found}");
    let found = orbit("cart", CART, &["--from", "mode 2", "--energy", "5"]).expect("an orbit");
    assert!(found.contains("multipliers    none") && found.contains("momentum of x"), "{found}");
    // A claim has its own name.
    let claimed = CART.replace("gravity:", "conserved: {p: momentum.x}\ngravity:");
    let found = orbit("claimed", &claimed, &["--from", "mode 2", "--energy", "5"]).expect("an orbit");
    assert!(found.contains("multipliers    none") && !found.contains("momentum of x"), "{found}");
    // What holds the cart leaves it no momentum, but a pair of multipliers.
    let held = CART.replace("gravity:", "potential_energy: k*x^2/2\ngravity:");
    let held = held.replace("parameters: {", "parameters: {k: 40 N/m, ");
    let found = orbit("held", &held, &["--from", "mode 2", "--energy", "1"]).expect("an orbit");
    assert_eq!(multipliers(&found).len(), 4, "{found}");
}

#[test]
fn a_true_shift_made_the_search_fail() {
    for energy in ["0.5", "1", "2", "3", "5"] {
        let expected = cart_period(energy.parse().expect("a number"));
        for more in [&["--shift", "x"][..], &[]] {
            let found = orbit("shift", CART, &[&["--from", "mode 2", "--energy", energy], more].concat());
            let found = period(&found.unwrap_or_else(|error| panic!("{energy} {more:?}: {error}")));
            assert!((found / expected - 1.0).abs() < 1e-11, "{energy} {more:?}: {found} {expected}");
        }
    }
    assert!((cart_period(5.0) - 1.812_382_846_48).abs() < 1e-11);
}

/// A pendulum as a point on a circle: 4 sqrt(l/g) K(sin(θ₀/2)), the same as by its angle.
#[test]
fn a_mode_of_a_mechanism_with_constraints_was_refused() {
    let by_place = "name: P\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}\ncoordinates: {x: m, y: m}\n\
        bodies: {bob: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\nconstraints: {rod: x^2 + y^2 - l^2}\n\
        equilibrium: {y: -1}\nscene: {start: {x: l, y: 0}, until: 1}\n";
    let by_angle = "name: P\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}\ncoordinates: {a: rad}\n\
        bodies: {bob: {mass: m, position: \"l*[sin(a), -cos(a)]\"}}\ngravity: [0, -g]\nscene: {start: {}, until: 1}\n";
    for energy in ["0.05", "5"] {
        let arguments = ["--from", "mode 1", "--energy", energy];
        let [place, angle] = [("place", by_place), ("angle", by_angle)].map(|(name, text)| {
            period(&orbit(name, text, &arguments).unwrap_or_else(|error| panic!("{name}: {error}")))
        });
        assert!((place / angle - 1.0).abs() < 1e-12, "{place} {angle}");
    }
    assert!(orbit("place", by_place, &["--from", "mode 2"]).unwrap_err().contains("no mode 2"));
}

/// A ball hinge by a rotation and by three angles: periods and multipliers are the same, and none is left of the quaternion's length,
/// nor by a mirror that only motions in the plane have.
#[test]
fn a_mode_of_a_rotation_was_refused() {
    let of = |coordinates: &str, frame: &str| {
        format!(
            "name: Hinge\nparameters: {{m: 2 kg, b: 0.2 m, I: 0.05 kg*m^2, g: 9.81 m/s^2, k: 1 N*m}}\n\
             coordinates: {coordinates}\nframes: {{B: {{rotate: {frame}}}}}\npoints: {{O: [0, 0, 0]}}\n\
             bodies: {{bar: {{mass: m, inertia: [I, I, I/2], frame: B, position: -b*B.z}}}}\ngravity: [0, 0, -g]\n\
             potential_energy: -k*dot(B.x, ground.x)\nscene: {{start: {{}}, until: 5}}\n"
        )
    };
    let quaternion = of("{att: rotation}", "att");
    let angles = of("{u: rad, v: rad, w: rad}", "[[x, u], [y, v], [z, w]]");
    let arguments = ["--from", "mode 1", "--energy", "0.5"];
    let [a, b] = [("quaternion", quaternion), ("angles", angles)]
        .map(|(name, text)| orbit(name, &text, &arguments).unwrap_or_else(|error| panic!("{name}: {error}")));
    assert!((period(&a) / period(&b) - 1.0).abs() < 1e-12, "{a}{b}");
    let [of_a, of_b] = [multipliers(&a), multipliers(&b)];
    assert!(of_a.len() == 8 && of_b.len() == 8, "{a}{b}");
    assert!(of_a.iter().zip(&of_b).all(|(a, b)| (a - b).abs() < 1e-8), "{a}{b}");
    assert!(a.contains("no small change grows") && b.contains("no small change grows"), "{a}{b}");
}

/// A ball on a table that swings as a sin(w t): once a period, v = g T/2 against u = v (1 − e)/(1 + e) of the table.
const BALL: &str = "
name: Ball
parameters: {m: 1 kg, g: 10 m/s^2, a: 0.1 m, w: 10 1/s, e: 0.8 1}
coordinates: {x: m}
bodies: {b: {mass: m, position: \"[0, x]\"}}
gravity: [0, -g]
constraints: {table: x - a*sin(w*t)}
phases: {fly: []}
events: {hit: {when: x - a*sin(w*t), direction: falling, then: {impact: e, along: table}}}
scene: {start: {x: 0.4, x': -1.93}, until: 0.5}
";

#[test]
fn what_time_does_in_events_alone_was_taken_for_nothing() {
    let found = orbit("ball", BALL, &[]).expect("an orbit");
    let t = std::f64::consts::TAU / 10.0;
    let v = 5.0 * t;
    let hit = (v * 0.2 / 1.8_f64).acos() / 10.0;
    // From the start to the impact it falls; the impact is at w t = acos(u/(a w)).
    let x = 0.1 * (10.0 * hit).sin() + v * hit - 5.0 * hit * hit;
    let at_start = found.lines().find_map(|line| line.trim().strip_prefix("x = ")).map_or(f64::NAN, number);
    assert!((period(&found) - t).abs() < 1e-14 && (at_start - x).abs() < 1e-13, "{found}{x}");
    // Areas shrink by e² at the impact: |μ|² of a pair.
    let squares: f64 = multipliers(&found).iter().map(|x| x * x).sum();
    assert!((squares - 2.0 * 0.64).abs() < 1e-9, "{found}");
    assert!(orbit("ball", BALL, &["--period", "0.7"]).unwrap_err().contains("does not repeat itself after 0.7 s"));
    let at = orbit("ball", BALL, &["--at", "hit"]).unwrap_err();
    assert!(at.contains("`hit`, which is to close the motion, happens 0.12"), "{at}");
    // A table at rest is no forcing: any motion that closes when it strikes does.
    let rest = BALL.replace("a: 0.1 m", "a: 0.1 m, v: 1 m/s").replace("a*sin(w*t)", "a");
    let rest = rest.replace("e: 0.8 1", "e: 1 1").replace("x: 0.4, x': -1.93", "x: 0.1, x': v");
    assert!((period(&orbit("rest", &rest, &["--at", "hit"]).expect("an orbit")) - 0.2).abs() < 1e-13);
}

#[test]
fn what_happens_once_was_told_to_repeat_itself() {
    let once = |when: &str| {
        format!(
            "name: Once\nparameters: {{m: 1 kg, k: 100 N/m, c: 1 N*s/m, F: 10 N, t1: 5 s, w: 13 1/s}}\ncoordinates: {{x: m}}\n\
             bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\nphases: {{a: [], b: []}}\nsprings: {{s: {{stretch: x, stiffness: k}}}}\n\
             dampers: {{d: {{rate: x', damping: c}}}}\nforces: {{f: {{on: b, force: \"[F, 0]\", phase: b}}}}\n\
             events: {{go: {{when: {when}, direction: rising, phase: a, then: b}}, back: {{when: sin(w*t) + 0.5, direction: falling, phase: b, then: a}}}}\n\
             scene: {{start: {{x: 0.1}}, until: 2}}\n"
        )
    };
    for period in ["1", "3.77"] {
        let why = orbit("once", &once("t - t1"), &["--period", period]).unwrap_err();
        assert!(why.contains("does not repeat itself after"), "{why}");
    }
    assert!(orbit("once", &once("sin(w*t) - 0.5"), &["--period", "0.3"]).unwrap_err().contains("after 0.3 s"));
    let found = orbit("again", &once("sin(w*t) - 0.5"), &[]).expect("an orbit");
    assert!((period(&found) - std::f64::consts::TAU / 13.0).abs() < 1e-14, "{found}");
    // What only ends a run far away forces nothing.
    let ends = once("sin(w*t) - 0.5").replace("back:", "end: {when: t - t1, then: stop}, back:");
    let found = orbit("ends", &ends, &["--period", "2*pi/w"]).expect("an orbit");
    assert!((period(&found) - std::f64::consts::TAU / 13.0).abs() < 1e-14, "{found}");
}

/// A light body, p x'' + p x' + x = cos 3t: the shorter its own period, the more steps changes of its motion take.
#[test]
fn a_limit_of_its_own_was_told_as_one_that_can_be_raised() {
    let text = "name: Light\nparameters: {k: 1, p: 1}\ncoordinates: {x: 1}\nkinetic_energy: p*x'^2/2\npotential_energy: k*x^2/2\n\
        generalized_forces: {x: -p*x' + cos(3*t)}\nscene: {start: {x: 0}, until: 10}\n";
    let found = orbit("light", text, &["--vary", "p=0.05..0.00001", "--segments", "1"]).expect("a family");
    assert!(!found.contains("ended") && found.contains("1e-5"), "{found}");
    // A limit of the user's is one that can be raised.
    let why = orbit("light", text, &["--set", "p=0.00001", "--max-steps", "50"]).unwrap_err();
    assert!(why.contains("raise `max_steps`"), "{why}");
}

/// A bar on two strings that are tied to its axis: turning about it costs nothing.  Where it swings across, its quaternion changes by rounding
/// alone; where it swings along, the turn is all but free, too.
#[test]
fn modes_beside_a_turn_that_costs_nothing_were_not_found() {
    let text = "name: Bifilar\nparameters: {m: 2 kg, a: 0.3 m, b: 0.2 m, L: 1 m, Iz: 0.05 kg*m^2, It: 0.03 kg*m^2, Ia: 0.055 kg*m^2, g: 9.81 m/s^2}\n\
        coordinates: {x: m, y: m, z: m, att: rotation}\nframes: {B: {rotate: att}}\n\
        points: {C: \"[x, y, z]\", P1: C + b*B.x, P2: C - b*B.x, Q1: \"[a, 0, 0]\", Q2: \"[-a, 0, 0]\"}\n\
        bodies: {bar: {mass: m, inertia: [It, Ia, Iz], frame: B, position: C}}\ngravity: [0, 0, -g]\n\
        constraints: {s1: norm(P1 - Q1) - L, s2: norm(P2 - Q2) - L}\nscene: {start: {x: 0, y: 0}, guess: {z: -1}, until: 5}\n";
    let across = orbit("across", text, &["--from", "mode 2", "--segments", "2"]).expect("an orbit");
    // A simple pendulum of the length of the strings' plane: m g/l y^2/2.
    assert!(across.contains("energy = 9.85941e-6 J") && across.contains("no small change grows"), "{across}");
    let along = orbit("along", text, &["--from", "mode 3", "--segments", "2"]).expect("an orbit");
    assert!((period(&along) / 1.992_93 - 1.0).abs() < 3e-6 && along.contains("no small change grows"), "{along}");
}

/// Steps of a family's walk end beside the end of its range, by rounding on one side of it or on the other.
#[test]
fn the_end_of_a_range_was_a_member_twice() {
    let mathieu = "
name: Mathieu
parameters: {d: 1 1/s^2, e: 0.2 1/s^2, w: 2 rad/s, c: 0.02 1/s}
coordinates: {x: 1}
kinetic_energy: x'^2/2
potential_energy: (d + e*cos(w*t))*x^2/2
generalized_forces: {x: -c*x'}
scene: {start: {x: 0}, until: 10}
";
    for range in ["w=1.7..2.3", "w=2.3..1.7", "w=1.7,2,2.3"] {
        let printed = orbit("mathieu", mathieu, &["--vary", range]).expect("a family");
        let values: Vec<&str> = printed
            .lines()
            .filter(|line| line.contains("stable  "))
            .filter_map(|line| line.split_whitespace().next())
            .collect();
        assert!(values.len() > 10 && values.contains(&"2.3"), "{printed}");
        assert!(values.windows(2).all(|pair| pair[0] != pair[1]), "{printed}");
    }
}

/// x'' = s x + cos t, whose guess from rest grows by 3·10¹³ in a period: x = -1/(s + 1) at the start.
#[test]
fn beside_a_guess_that_runs_away_anything_closed() {
    let unstable = "name: U\nparameters: {s: 100 1/s^2, F: 1 1/s^2, w: 1 rad/s}\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\n\
        potential_energy: -s*x^2/2\ngeneralized_forces: {x: u}\ninputs: {u: F*cos(w*t)}\nscene: {start: {x: 0}, until: 3, tolerance: 1e-12}\n";
    for (s, x) in [("100", -1.0 / 101.0), ("49", -1.0 / 50.0), ("36", -1.0 / 37.0)] {
        let found = orbit("unstable", unstable, &["--set", &format!("s={s}")]).expect("an orbit");
        let start = found.split_once("  x = ").map(|(_, rest)| number(rest)).expect("a start");
        assert!((start / x - 1.0).abs() < 1e-12, "{found}");
    }
}

/// Rows of a family: what varies, the period.
fn rows(printed: &str) -> Vec<[f64; 2]> {
    let row = |line: &str| {
        let mut numbers = line.split_whitespace().map_while(|word| word.parse().ok());
        Some([numbers.next()?, numbers.next()?])
    };
    printed.lines().skip(2).filter_map(row).collect()
}

const DUFFING: &str = "name: D\nparameters: {m: 1 kg, k: 1 N/m, k3: 1 N/m^3}\ncoordinates: {x: m}\nkinetic_energy: m*x'^2/2\n\
    potential_energy: k*x^2/2 + k3*x^4/4\nscene: {start: {x: 1}, until: 10, tolerance: 1e-12}\n";

/// Of motions that keep their energy there is one of each: where a parameter varies they have that of the first, and do not wander.
#[test]
fn families_by_a_parameter_wandered_through_energies() {
    let found = orbit("duffing", DUFFING, &["--vary", "k3=0..5"]).expect("a family");
    let rows = rows(&found);
    let [k3, last] = *rows.last().expect("rows");
    assert!(k3 == 5.0 && rows.len() < 100 && !found.contains("fold") && !found.contains("ended"), "{found}");
    // With 0.5 J: x²/2 + 5 x⁴/4 = 1/2 at the ends.
    let x = ((1.0 + 10.0_f64.sqrt().powi(2)).sqrt() - 1.0).sqrt() / 5.0_f64.sqrt();
    let alone = orbit("duffing", DUFFING, &["--set", "k3=5", "--start", &format!("x={x}")]).expect("an orbit");
    assert!((last / period(&alone) - 1.0).abs() < 1e-5, "{last} {alone}");
}

/// The answer to a force F cos w t is as large as F: where this passes 0 so does the family.
#[test]
fn families_ended_where_a_parameter_is_zero() {
    let forced = "name: F\nparameters: {m: 1 kg, k: 1 N/m, c: 0.1 N*s/m, F: 1 N, w: 1.7 rad/s}\ncoordinates: {x: m}\nkinetic_energy: m*x'^2/2\n\
        potential_energy: k*x^2/2\ngeneralized_forces: {x: u - c*x'}\ninputs: {u: F*cos(w*t)}\nscene: {start: {x: 0}, until: 10}\n";
    let found = orbit("forced", forced, &["--vary", "F=-1..1"]).expect("a family");
    let rows = rows(&found);
    assert!(rows.last().is_some_and(|row| row[0] == 1.0) && rows.len() < 100 && !found.contains("ended"), "{found}");
}

/// A pendulum's energies are negative: `..B` ends at B, and A..B begins at A, however large the energy of the motion is that is found first.
#[test]
fn families_by_energy_begin_and_end_where_is_asked() {
    let pendulum = "name: P\nparameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2}\ncoordinates: {th: rad}\n\
        bodies: {b: {mass: m, position: 'l*[sin(th), -cos(th)]'}}\ngravity: [0, -g]\nscene: {start: {th: 1}, until: 10, tolerance: 1e-12}\n";
    let ends = |range: &str| {
        let found = rows(&orbit("pendulum", pendulum, &["--vary", range]).expect("a family"));
        assert!(found.windows(2).all(|pair| pair[1][0] > pair[0][0]), "{found:?}");
        [found.first(), found.last()].map(|row| row.expect("rows")[0])
    };
    assert!((ends("energy=..-2")[0] + 9.81 * 1.0_f64.cos()).abs() < 1e-4);
    assert_eq!(ends("energy=..-2")[1], -2.0);
    assert_eq!(ends("energy=-9..-2"), [-9.0, -2.0]);
}

/// The amplitude of a mode with an energy is that of the mechanism, of whatever size it is.
#[test]
fn modes_of_an_energy_are_found_in_micrometres_too() {
    let small = DUFFING.replace("m: 1 kg, k: 1 N/m, k3: 1 N/m^3", "m: 1e-15 kg, k: 2e-3 N/m, k3: 3e9 N/m^3");
    let small = small.replace("x: 1}, until: 10", "x: 1e-6}, until: 1e-5");
    let found = orbit("micro", &small, &["--from", "mode 1", "--energy", "1e-14"]).expect("an orbit");
    assert!((period(&found) / 2.139_240_607_656e-6 - 1.0).abs() < 1e-11, "{found}");
    let found = orbit("stiff", DUFFING, &["--from", "mode 1", "--energy", "100"]).expect("an orbit");
    assert!((period(&found) / 1.638_890_722_145 - 1.0).abs() < 1e-11, "{found}");
}

/// A particle and a car whose headings turn evenly go round in circles, of any radius: a momentum is conserved along their edges where they start, and
/// nowhere else.  Two constraints on speeds leave hardly a direction in which the circle changes, and close to rounding.
#[test]
fn circles_of_what_rolls_were_no_orbits() {
    let model = |constraints: &str, start: &str| {
        format!(
            "name: C\nparameters: {{m: 1 kg, I: 2 kg*m^2, R: 3 m}}\ncoordinates: {{x: m, y: m, th: rad}}\n\
             bodies: {{b: {{mass: m, inertia: I, angle: th, position: '[x, y]'}}}}\nconstraints: {{{constraints}}}\n\
             scene: {{start: {{{start}}}, until: 30, tolerance: 1e-12}}\n"
        )
    };
    let edge = "edge: 'dot(velocity(b), b.y)'";
    let turn = format!("{edge}, turn: \"dot(velocity(b), b.x) - R*th'\"");
    for text in [model(edge, "x': 1, th': 0.5"), model(&turn, "th': 0.5")] {
        let found = orbit("circle", &text, &["--turn", "th=1", "--period", "12.566370614359172"]).expect("an orbit");
        assert!((period(&found) / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-12, "{found}");
        assert!(found.contains("no small change grows"), "{found}");
    }
}

/// A force F cos w t with F = 0, or with w = 0 beside another one that is 0, drives nothing: there is rest alone.
#[test]
fn rest_without_a_force_was_a_motion_of_a_twelfth_of_its_period() {
    let forced = "name: F\nparameters: {m: 1 kg, k: 4 N/m, c: 0.1 N*s/m, F: 1 N, b: 0 N, w: 1.7 rad/s, v: 1.7 rad/s}\ncoordinates: {x: m}\n\
        kinetic_energy: m*x'^2/2\npotential_energy: k*x^2/2\ngeneralized_forces: {x: u - c*x'}\ninputs: {u: F*cos(w*t) + b*sin(v*t)}\n\
        scene: {start: {x: 0}, until: 10}\n";
    for set in ["F=0", "w=0"] {
        let why = orbit("resting", forced, &["--set", set]).expect_err("rest");
        assert!(why.contains("equilibrium"), "{why}");
    }
    orbit("driven", forced, &[]).expect("an orbit");
}
