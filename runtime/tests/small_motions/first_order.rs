//! States of first order and sampled loops on mechanisms with constraints or rotations, beside twins in independent coordinates.

use serde_json::Value;

use super::{close, run, try_run, words};

const MOTOR: &str = "
inputs: {u: 1 V}
states: {i: {unit: A, rate: (u - R*i - k*th')/L}}
parameters: {m: 1 kg, l: 1 m, I: 0.01 kg*m^2, g: 9.81 m/s^2, R: 2 ohm, L: 0.1 H, k: 0.5 N*m/A}
bodies: {b: {mass: m, position: P, inertia: I, angle: th}}
gravity: [0, -g]
torques: {motor: {on: b, torque: k*i}}
";
const SAMPLED: &str = "
memory: {u: 0 N*m, carried: 0 N}
parameters: {m: 1 kg, l: 1 m, I: 0.01 kg*m^2, g: 9.81 m/s^2, kp: 20 N*m, kd: 4 N*m*s, T: 20 ms, wanted: 0.4}
bodies: {b: {mass: m, position: P, inertia: I, angle: th}}
gravity: [0, -g]
torques: {motor: {on: b, torque: u}}
";
const CONSTRAINED: &str = "
coordinates: {x: m, y: m, th: rad}
points: {P: '[x, y]'}
constraints: {across: x - l*sin(th), along: y + l*cos(th)}
";
const INDEPENDENT: &str = "
coordinates: {th: rad}
points: {P: '[l*sin(th), -l*cos(th)]'}
define: {pull: m*(g + l*sin(th)*th'' + l*cos(th)*th'^2)}
";

/// Rows of numbers: a matrix, or complex numbers.
fn matrix(found: &Value, key: &str) -> Vec<Vec<f64>> {
    serde_json::from_value(found[key].clone()).expect("a matrix")
}

/// The same lists but for rounding.
fn alike(one: &[Vec<f64>], other: &[Vec<f64>]) {
    assert_eq!(one.len(), other.len());
    let size = other.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (a, b) in one.iter().flatten().zip(other.iter().flatten()) {
        assert!((a - b).abs() <= 1e-12 * size, "{a} is not {b}");
    }
}

/// A and B of a pendulum that a motor turns, its rod by constraints and by its angle; away from its lowest point, which gravity alone would choose.
#[test]
fn a_motor_on_a_constrained_pendulum_is_that_on_a_pendulum() {
    let model = |rest: &str| format!("name: Motor\n{MOTOR}{rest}scene: {{start: {{th: 0.3}}}}\n");
    let constrained = model(&format!("{CONSTRAINED}outputs: {{pull: reaction(along)}}\n"));
    let independent = model(&format!("{INDEPENDENT}outputs: {{pull: pull}}\n"));
    let options = ["--input", "u=20"];
    let (one, other) = (run(&constrained, &options), run(&independent, &options));
    for key in ["A", "B"] {
        alike(&matrix(&one, key), &matrix(&other, key));
    }
    assert_eq!(one["variables"], other["variables"]);
    let rest = |found: &Value, name: &str| found["equilibrium"][name].as_f64().expect("a number");
    // m g l sin th = k u/R.
    let th = (0.5 * 20.0 / 2.0 / 9.81_f64).asin();
    close(rest(&one, "th"), th, 1e-14);
    close(rest(&one, "x"), th.sin(), 1e-14);
    close(rest(&one, "i"), 10.0, 1e-14);
    close(one["reactions"]["along"].as_f64().expect("a reaction"), 9.81, 1e-14);
    // How all coordinates follow the angle: (cos th, sin th, 1).
    alike(&matrix(&one, "motions")[..2], &[vec![th.cos(), 0.0], vec![th.sin(), 0.0]]);
    // What the rod carries, as it departs.
    let states = |text: &str| {
        let written = super::scratch("space.json");
        let path = written.to_str().expect("a path");
        words(text, &["--input", "u=20", "--state-space", path, "--in", "u", "--out", "pull"]).expect("modes");
        let found: Value = serde_json::from_str(&std::fs::read_to_string(&written).expect("written")).expect("JSON");
        std::fs::remove_file(&written).expect("removed");
        found
    };
    let (one, other) = (states(&constrained), states(&independent));
    for key in ["A", "B", "C", "D"] {
        alike(&matrix(&one, key), &matrix(&other, key));
    }
}

/// A motor with a PI law on the crank of a four-bar, which has three coordinates and two constraints or its crank's angle alone.
#[test]
fn a_motor_on_a_four_bar_is_that_on_its_crank() {
    let law = "states: {i: {unit: A, rate: (kp*(1 - crank_angle) + ki*z - K*crank_angle' - R*i)/L}, z: {unit: s, rate: 1 - crank_angle}}\n";
    let own = |name: &str| {
        std::fs::read_to_string(format!("{}/../models/{name}.yaml", env!("CARGO_MANIFEST_DIR"))).expect("a model")
    };
    let with = |text: String, force: &str| {
        let text = text.replace("g: 10 m/s^2}", "g: 10 m/s^2, K: 5 N*m/A, R: 2 ohm, L: 0.1 H, kp: 60 V, ki: 30 V/s}");
        let text = text.lines().filter(|line| !line.starts_with("conserved")).collect::<Vec<_>>().join("\n");
        format!("{text}\n{law}{force}")
    };
    let whole = own("four_bar");
    // Its balances do not know the motor.
    let (head, tail) =
        (whole.split_once("balances:").expect("balances").0, whole.split_once("conserved:").expect("claims").1);
    let tail = tail.split_once("outputs:").and_then(|(_, tail)| tail.split_once("draw:")).expect("a drawing").1;
    let whole = with(format!("{head}draw:{tail}"), "torques: {motor: {on: AB, torque: K*i}}\n");
    let crank = with(own("four_bar_minimal"), "generalized_forces: {crank_angle: K*i}\n");
    let options = ["--at", "crank_angle=1"];
    let (one, other) = (run(&whole, &options), run(&crank, &options));
    close(one["equilibrium"]["crank_angle"].as_f64().expect("an angle"), 1.0, 1e-13);
    let (one, other) = (matrix(&one, "eigenvalues"), matrix(&other, "eigenvalues"));
    assert_eq!((one.len(), other.len()), (4, 4));
    alike(&one, &other);
}

/// A law that is sampled, and reads what a constraint carries, which changes with the accelerations.
#[test]
fn a_sampled_law_on_a_constrained_pendulum_is_that_on_a_pendulum() {
    let tick = |pull: &str| {
        format!(
            "events: {{tick: {{every: T, then: {{set: {{u: -kp*(th - wanted) - kd*th' + 0.1*carried*l, carried: '{pull}'}}}}}}}}\nscene: {{start: {{th: 0.3}}}}\n"
        )
    };
    let one = run(&format!("name: Sampled\n{SAMPLED}{CONSTRAINED}{}", tick("reaction(along)")), &["--sampled"]);
    let other = run(&format!("name: Sampled\n{SAMPLED}{INDEPENDENT}{}", tick("pull")), &["--sampled"]);
    alike(&matrix(&one, "map"), &matrix(&other, "map"));
    alike(&matrix(&one, "z"), &matrix(&other, "z"));
    close(
        one["critical_periods"][0].as_f64().expect("a period"),
        other["critical_periods"][0].as_f64().expect("a period"),
        1e-12,
    );
    close(one["memory"]["carried"].as_f64().expect("a force"), 9.81, 1e-14);
}

/// A satellite that a sampled law, or one with integrals of first order, holds at an attitude: to first order J φ'' is the moment, φ the vector of
/// the small turn, of which a quaternion has the half.
#[test]
fn laws_of_attitude_by_a_rotation_are_those_of_its_small_turn() {
    let parameters = "parameters: {k: 2 N*m, c: 3 N*m*s, ki: 0.3 N*m/s, Ts: 0.2 s}\n";
    let body = "coordinates: {q: rotation}\nframes: {B: {rotate: q}}\n\
        define: {sx: (B.y.z - B.z.y)/2, sy: (B.z.x - B.x.z)/2, sz: (B.x.y - B.y.x)/2}\n\
        bodies: {b: {mass: 1 kg, inertia: [[3, 0.2, 0], [0.2, 4, 0.1], [0, 0.1, 5]], frame: B, position: '[0, 0, 0]'}}\n\
        scene: {start: {q: [[x, 0.5], [y, -0.3]]}}\n";
    let turn = "coordinates: {a: rad, b: rad, c_: rad}\n\
        kinetic_energy: (3*a'^2 + 4*b'^2 + 5*c_'^2 + 0.4*a'*b' + 0.2*b'*c_')*1/2\nscene: {start: {a: 0.1}}\n";
    let sampled = |moments: [&str; 3]| {
        let [x, y, z] = moments;
        format!(
            "memory: {{ux: 0, uy: 0, uz: 0}}\nevents: {{law: {{every: Ts, then: {{set: {{ux: \"{x}\", uy: \"{y}\", uz: \"{z}\"}}}}}}}}\n"
        )
    };
    let of_body = ["x", "y", "z"].map(|axis| format!("-k*s{axis} - c*dot(angular_velocity(b), B.{axis})"));
    let of_turn = ["a", "b", "c_"].map(|angle| format!("-k*{angle} - c*{angle}'"));
    let [x, y, z] = of_body;
    let one = format!(
        "name: Held\n{parameters}{body}torques: {{t: {{on: b, torque: ux*B.x + uy*B.y + uz*B.z}}}}\n{}",
        sampled([&x, &y, &z])
    );
    let [x, y, z] = of_turn;
    let other = format!(
        "name: Held\n{parameters}{turn}generalized_forces: {{a: ux, b: uy, c_: uz}}\n{}",
        sampled([&x, &y, &z])
    );
    let strip =
        |text: &str| text.replace(" N*m*s", "").replace(" N*m/s", "").replace(" N*m", "").replace(": rad", ": 1");
    let (one, other) = (run(&strip(&one), &["--sampled"]), run(&strip(&other), &["--sampled"]));
    alike(&matrix(&one, "z"), &matrix(&other, "z"));
    let names: Vec<String> = serde_json::from_value(one["variables"].clone()).expect("names");
    assert_eq!(names[..3], ["q.x", "q.y", "q.z"]);

    let states = |rates: [&str; 3]| {
        let [x, y, z] = rates;
        format!("states: {{ex: {{unit: s, rate: {x}}}, ey: {{unit: s, rate: {y}}}, ez: {{unit: s, rate: {z}}}}}\n")
    };
    let one = format!(
        "name: Held\n{parameters}{body}{}torques: {{t: {{on: b, torque: -(k*sx + ki*ex)*B.x - (k*sy + ki*ey)*B.y - (k*sz + ki*ez)*B.z - c*angular_velocity(b)}}}}\n",
        states(["sx", "sy", "sz"])
    );
    let other = format!(
        "name: Held\n{parameters}{turn}{}generalized_forces: {{a: -k*a - c*a' - ki*ex, b: -k*b - c*b' - ki*ey, c_: -k*c_ - c*c_' - ki*ez}}\n",
        states(["a", "b", "c_"])
    );
    let (one, other) = (run(&strip(&one), &[]), run(&strip(&other), &[]));
    alike(&matrix(&one, "eigenvalues"), &matrix(&other, "eigenvalues"));
}

/// What has no rest in independent coordinates is refused with its reason.
#[test]
fn what_has_no_rest_with_states_is_refused() {
    let rolling = format!(
        "name: Motor\n{MOTOR}coordinates: {{x: m, y: m, th: rad}}\npoints: {{P: '[x, y]'}}\nconstraints: {{skate: x'*sin(th) - y'*cos(th)}}\n"
    );
    let why = try_run(&rolling, &[]).expect_err("a skate");
    assert!(why.contains("`skate` contains speeds"), "{why}");
    let open = format!("name: Motor\n{MOTOR}{CONSTRAINED}forces: {{wind: {{on: b, force: '[0, 3*sin(t)]'}}}}\n");
    let why = try_run(&open, &[]).expect_err("time");
    assert!(why.contains("time"), "{why}");
}

/// Slow motions behind a rod beside a filter of 1 ps: a filter of 10⁵ s that follows it, and masses of 1 + 1 kg on a spring,
/// 2 λ² + 0.01 λ + 0.001 = 0.
#[test]
fn slow_motions_with_constraints_keep_their_digits_beside_fast_states() {
    let rod = "name: Slow\nparameters: {m: 1 kg, k: 1e-3 N/m, c: 1e-2 N*s/m, l: 1 m, tf: 1e-12 s, ts: 1e5 s}\ncoordinates: {x: m, y: m}\n\
        states: {p: {unit: m, rate: (x - p)/tf}, w: {unit: m, rate: (p - w)/ts}}\nkinetic_energy: m*(x'^2 + y'^2)/2\n\
        potential_energy: k*x^2/2\ngeneralized_forces: {x: -c*x'}\nconstraints: {rod: y - x - l}\nscene: {start: {x: 0, y: 1}, until: 1}\n";
    let found = run(rod, &[]);
    assert_eq!((found["zeros"].as_u64(), &found["stability"]), (Some(0), &"departures die out".into()));
    assert!(found["blurred"].is_null(), "{found}");
    let values = matrix(&found, "eigenvalues");
    let expected =
        [[-1e-5, 0.0], [-0.0025, -0.022_220_486_043_288_97], [-0.0025, 0.022_220_486_043_288_97], [-1e12, 0.0]];
    for (value, expected) in values.iter().zip(expected) {
        assert!(
            (value[0] - expected[0]).hypot(value[1] - expected[1]) <= 1e-13 * expected[0].hypot(expected[1]),
            "{value:?}"
        );
    }
    // A lever of 1 to 3 and a circuit of 10¹² 1/s that brakes it hardly: eigenvalues of 3 × 3 by mpmath's `eig` in 40 digits.
    let lever = "name: Lever\nparameters: {m: 1 kg, k: 1e-3 N/m, c: 1e-2 N*s/m, a: 0.1 m, b: 0.3 m, R: 1e3 ohm, L: 1e-9 H, K: 1e-4 V*s/m}\n\
        coordinates: {x: m, y: m}\nstates: {i: {unit: A, rate: (-R*i - K*y')/L}}\nkinetic_energy: m*(x'^2 + y'^2)/2\n\
        potential_energy: k*x^2/2\ngeneralized_forces: {x: -c*x', y: K*i}\nconstraints: {lever: b*y - a*x}\nscene: {start: {x: 0}, until: 1}\n";
    let found = run(lever, &[]);
    assert_eq!(found["stability"], "departures die out");
    let values = matrix(&found, "eigenvalues");
    assert!((values[1][0] + 0.004_500_000_000_5).abs() < 1e-15, "{values:?}");
    assert!((values[1][1] - 0.029_660_579_899_851_92).abs() < 1e-14, "{values:?}");
}
