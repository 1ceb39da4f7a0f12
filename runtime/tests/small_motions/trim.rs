//! `modes --hold --solve`: rests with coordinates held, against closed forms; what is not determined or cannot be held.

use serde_json::Value;

use super::{close, run, scratch, try_run, words};

/// Two links in the plane with motors in both joints; a spring and a held couple act in the second.
const ARM: &str = "name: Arm\nparameters: {m: 2 kg, l: 0.5 m, g: 9.81 m/s^2, k: 3 N*m/rad, rest: 0 rad}\n\
    coordinates: {q1: rad, q2: rad}\ninputs: {T1: 0 N*m, T2: 0 N*m}\nmemory: {b: 0 N*m}\n\
    points: {elbow: \"l*[cos(q1), sin(q1)]\", hand: \"elbow + l*[cos(q1 + q2), sin(q1 + q2)]\"}\n\
    bodies: {upper: {mass: m, position: elbow}, fore: {mass: m, position: hand}}\ngravity: [0, -g]\n\
    generalized_forces: {q1: T1, q2: T2 + b - k*(q2 - rest)}\nequilibrium: {q1: -1.5}\n\
    outputs: {T: T1}\nscene: {until: 1}\n";

fn found(value: &Value, name: &str) -> f64 {
    value["trim"]["found"][name]["value"].as_f64().unwrap_or(f64::NAN)
}

/// Motors hold both joints: T1 = m g l (2 cos q1 + cos(q1 + q2)), T2 = m g l cos(q1 + q2) + k q2.
#[test]
fn motors_hold_an_arm() {
    let weight = 2.0 * 9.81 * 0.5;
    for (q1, q2) in [(5.0_f64, 0.0_f64), (-30.0, 40.0), (90.0, 0.0), (-90.0, 0.0), (170.0, -250.0)] {
        let hold = format!("q1={q1}deg,q2={q2} deg");
        let value = run(ARM, &["--hold", &hold, "--solve", "T1,T2"]);
        let (q1, q2) = (q1.to_radians(), q2.to_radians());
        let exact = [weight * (2.0 * q1.cos() + (q1 + q2).cos()), weight * (q1 + q2).cos() + 3.0 * q2];
        for (name, exact) in ["T1", "T2"].into_iter().zip(exact) {
            assert!((found(&value, name) - exact).abs() < 1e-13 * weight, "{hold}: {value}");
            assert!(value["trim"]["found"][name]["uncertainty"].as_f64().unwrap() < 1e-13 * weight);
        }
        assert!((value["equilibrium"]["q1"].as_f64().unwrap() - q1).abs() <= f64::EPSILON * q1.abs());
        // K there: −m g l sin of each angle, and the spring.
        close(value["K"][0][1].as_f64().unwrap(), -weight * (q1 + q2).sin(), 1e-12);
        close(value["K"][1][1].as_f64().unwrap(), 3.0 - weight * (q1 + q2).sin(), 1e-12);
    }
}

/// A parameter, a held value and a motor in turn; the units of torques are those of the file.
#[test]
fn parameters_and_held_values_are_found_too() {
    let weight = 2.0 * 9.81 * 0.5;
    let couple = weight * 35.0_f64.to_radians().cos() + 3.0 * 30.0_f64.to_radians();
    for (name, exact) in [
        ("b", couple),
        ("rest", couple / 3.0),
        ("T2", couple),
        ("k", -weight * 35.0_f64.to_radians().cos() / 30.0_f64.to_radians()),
    ] {
        let value = run(ARM, &["--hold", "q1=5deg,q2=30deg", "--solve", &format!("T1,{name}")]);
        close(found(&value, name), exact, 1e-14);
    }
    let text = words(ARM, &["--hold", "q1=5deg,q2=30deg", "--solve", "T1,b=2 N*m"]).unwrap();
    assert!(text.starts_with("dalembert-small-motions"), "{text}");
    assert!(
        text.contains(
            "trimmed with q1 = 0.0872664625997, q2 = 0.523598775598 held\n  T1 = 27.581221531 N*m, sought from 0\n"
        ),
        "{text}"
    );
    assert!(text.contains("  b = 9.60667788127 N*m, sought from 2\n"), "{text}");
}

/// A joint that is free comes to rest: T1 alone holds the first, and the second hangs where its spring lets it.
#[test]
fn what_is_not_held_follows() {
    let value = run(ARM, &["--hold", "q1=20 deg", "--solve", "T1", "--set", "k=0", "--at", "q2=-1.5"]);
    let (q1, q2) = (20.0_f64.to_radians(), value["equilibrium"]["q2"].as_f64().unwrap());
    close(q1 + q2, -std::f64::consts::FRAC_PI_2, 1e-14);
    close(found(&value, "T1"), 2.0 * 9.81 * q1.cos(), 1e-14);
    let text = words(ARM, &["--hold", "q1=20 deg", "--solve", "T1", "--at", "q2=-1.5"]).unwrap();
    assert!(text.contains("steps of Newton's method: of several solutions the one that these lead to"), "{text}");
}

/// A pendulum whose rod is a constraint: by a force, by its length, by an input that carries the pivot along.
#[test]
fn constraints_are_met() {
    let text = "name: P\nparameters: {m: 2 kg, l: 0.5 m, g: 10 m/s^2, F: 0 N}\ncoordinates: {x: m, y: m}\n\
        inputs: {base: 0 m, push: 0 N}\nbodies: {bob: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\n\
        constraints: {rod: (x - base)^2 + y^2 - l^2}\nforces: {push: {on: bob, force: \"[push + F, 0]\"}}\n\
        equilibrium: {y: -0.4}\nscene: {start: {x: 0}, guess: {y: -l}, until: 1}\n";
    for name in ["push", "F"] {
        let value = run(text, &["--hold", "x=0.3", "--solve", name]);
        close(found(&value, name), 15.0, 1e-14);
        close(value["equilibrium"]["y"].as_f64().unwrap(), -0.4, 1e-14);
        // A pendulum in a field of 12.5 m/s².. along its rod: ω² = 25 rad²/s².
        close(value["modes"][0]["omega"].as_f64().unwrap(), 5.0, 1e-13);
    }
    let value = run(text, &["--hold", "x=0.3", "--solve", "base"]);
    close(found(&value, "base"), 0.3, 1e-14);
    let value = run(text, &["--hold", "x=0.3,y=-0.6", "--solve", "l,push"]);
    close(found(&value, "l"), 0.45_f64.sqrt(), 1e-14);
    close(found(&value, "push"), 10.0, 1e-14);
    let refused = try_run(text, &["--hold", "x=0.3,y=-0.6", "--solve", "push"]).unwrap_err();
    assert!(
        refused.contains("no value of `push` was found") && refused.contains("there is left rod: 0.2"),
        "{refused}"
    );
}

/// A motor with inductance: the voltage that carries a load, with the current as a state that follows, or is held.
#[test]
fn states_of_first_order_follow_or_are_held() {
    let text = "name: Motor\nparameters: {J: 1e-3 kg*m^2, L: 1 mH, R: 2 ohm, K: 0.05 N*m/A, load: 0.3 N*m}\n\
        coordinates: {phi: rad}\nstates: {i: {unit: A, rate: (u - R*i - K*phi')/L}}\ninputs: {u: 0 V}\n\
        kinetic_energy: J*phi'^2/2\ngeneralized_forces: {phi: K*i - load}\nscene: {until: 1}\n";
    let value = run(text, &["--hold", "phi=1", "--solve", "u"]);
    close(found(&value, "u"), 12.0, 1e-14);
    close(value["equilibrium"]["i"].as_f64().unwrap(), 6.0, 1e-14);
    let value = run(text, &["--hold", "phi,i=2 A", "--solve", "u,load"]);
    close(found(&value, "u"), 4.0, 1e-14);
    close(found(&value, "load"), 0.1, 1e-14);
}

/// Each with the names of those that it is about.
#[test]
fn what_is_not_determined_is_named() {
    for (hold, solve, told) in [
        ("q1=5deg,q2=30deg", "T1,T2,b", "`T2` and `b` cannot be told apart"),
        (
            "q1=5deg",
            "T1,T2",
            "`T1` and `T2` are not determined: it rests all the same where `q2` moves along with them; hold `q2` too",
        ),
        ("q1=-90deg,q2=0", "m", "`m` changes nothing where it rests"),
        ("q1=5deg,q2=30deg", "T1", "no value of `T1` was found with which it rests with `q1` and `q2` held"),
        ("q1=5deg,q2=30deg", "T1", "let `q1` or `q2` free"),
        ("q3=1", "T1", "q3"),
        ("q1'=1", "T1", "--hold is for places"),
        ("q1=1,q1=2", "T1", "gives `q1` twice"),
        ("q1=1", "T1,T1", "gives `T1` twice"),
        ("q1=1", "T3", "no input, parameter or held value is called `T3`; did you mean `T1`?"),
    ] {
        let refused = try_run(ARM, &["--hold", hold, "--solve", solve]).unwrap_err();
        assert!(refused.contains(told), "{hold} {solve}: {refused}");
    }
    assert!(try_run(ARM, &["--solve", "T1"]).unwrap_err().contains("--hold"));
    // Two holds that agree by themselves are met by one motor.
    let value = run(ARM, &["--hold", "q1=90 deg,q2=0", "--solve", "T1", "--set", "g=0"]);
    assert_eq!(found(&value, "T1"), 0.0);
}

/// x' = A x + B u there, written to a file.
#[test]
fn the_state_space_model_is_that_of_the_trimmed_rest() {
    let path = scratch("model.json");
    let file = path.to_str().unwrap();
    let text = words(
        ARM,
        &["--hold", "q1=5deg,q2=30deg", "--solve", "T1,T2", "--state-space", file, "--in", "T1", "--out", "q1,T"],
    )
    .unwrap();
    let written: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    std::fs::remove_file(&path).unwrap();
    let value = run(ARM, &["--hold", "q1=5deg,q2=30deg", "--solve", "T1,T2"]);
    let number = |value: &Value, i: usize, j: usize| value[i][j].as_f64().unwrap();
    // M times the lower rows of A are −K.
    for j in 0..2 {
        let moved: f64 = (0..2).map(|k| number(&value["M"], 0, k) * number(&written["A"], 2 + k, j)).sum();
        close(moved, -number(&value["K"], 0, j), 1e-12);
    }
    // The report on the file stands after the table.
    assert!(text.find("x' = A x + B u").unwrap() > text.find("modes, each scaled").unwrap(), "{text}");
}

/// Watt's governor with a sleeve on its balls: cos θ = (m + M) g/(m l W²), at the speed W that the scene's start says with it.
#[test]
fn speeds_of_the_start_follow_what_is_sought() {
    let governor = "name: Governor\nparameters: {m: 0.5 kg, M: 2 kg, l: 0.3 m, g: 9.81 m/s^2, W: 9 rad/s, J: 0.02 kg*m^2}\n\
        coordinates: {phi: rad, al: rad}\nkinetic_energy: (J/2 + m*(l*sin(al))^2)*phi'^2 + m*(l*al')^2 + M*(2*l*sin(al)*al')^2/2\n\
        potential_energy: -2*(m + M)*g*l*cos(al)\nscene: {start: {phi': W, al: 0.7}, until: 1}\n";
    let turning = (2.5 * 9.81 / (0.5 * 0.3 * 1.0_f64.cos())).sqrt();
    for from in ["W", "W=3", "W=40"] {
        let value = run(governor, &["--steady", "--hold", "al=1", "--solve", from]);
        close(found(&value, "W"), turning, 1e-12);
        assert!(value["trim"]["found"]["W"]["uncertainty"].as_f64().unwrap() < 1e-12 * turning);
    }
    // What follows the speed too: a mass at a given one, and a speed that is given by hand and stays.
    let value = run(governor, &["--steady", "--hold", "al=1", "--solve", "M"]);
    close(found(&value, "M"), 0.5 * 0.3 * 81.0 * 1.0_f64.cos() / 9.81 - 0.5, 1e-12);
    assert!(words(governor, &["--steady", "--at", "phi'=9", "--hold", "al=1", "--solve", "W"]).is_err());
}

/// A body that hovers on a thrust along its own axis, k W² = m g, with a drag of its rotor, T = c W²: nothing that is sought changes the lift,
/// of which a rounding is left; the turn about the axis is free, and its quaternion's length stays 1.
#[test]
fn what_is_met_to_rounding_is_left_alone() {
    let hover = "name: Hover\nparameters: {m: 1.28 kg, J: 0.02 kg*m^2, k: 4.4e-5 kg*m, g: 9.81 m/s^2, W: 534.2113984012492 1/s, c: 2e-7 kg*m^2}\n\
        coordinates: {x: m, y: m, z: m, att: rotation}\ninputs: {T: 0 N*m}\nframes: {H: {rotate: att}}\npoints: {C: \"[x, y, z]\"}\n\
        bodies: {hull: {mass: m, inertia: [J, J, J], frame: H, position: C}}\ngravity: [0, 0, -g]\n\
        forces: {f: {on: hull, force: k*W^2*H.z}}\ntorques: {t: {on: hull, torque: (T - c*W^2)*H.z}}\nscene: {start: {}, until: 1}\n";
    let turning = (1.28 * 9.81 / 4.4e-5_f64).sqrt();
    for sought in ["T", "T,W=500"] {
        let value = run(hover, &["--hold", "z", "--solve", sought]);
        close(found(&value, "T"), 2e-7 * turning * turning, 1e-11);
        let length = ["w", "x", "y", "z"].map(|part| value["equilibrium"][format!("att.{part}")].as_f64().unwrap());
        close(length.iter().map(|x| x * x).sum::<f64>(), 1.0, 1e-12);
    }
    // A thrust that does not carry it does not become one.
    let refused = words(hover, &["--hold", "z", "--solve", "T", "--set", "W=500"]).unwrap_err();
    assert!(refused.contains("z: 1.5568 N"), "{refused}");
}

/// A motor at a constant rate carries b W/K, wherever the scene's start has its current, and needs R i + K W.
#[test]
fn states_follow_or_are_held_in_steady_motions() {
    let file = |start: &str| {
        format!(
            "name: Motor\nparameters: {{J: 1e-3 kg*m^2, L: 1 mH, R: 1 ohm, K: 0.05 N*m/A, U: 12 V, W: 100 rad/s, b: 1e-4 N*m*s}}\n\
             coordinates: {{phi: rad}}\nstates: {{i: {{unit: A, rate: (u - R*i - K*phi')/L}}}}\ninputs: {{u: U}}\n\
             kinetic_energy: J*phi'^2/2\ngeneralized_forces: {{phi: K*i - b*phi'}}\nscene: {{start: {{i: {start}, phi': W}}, until: 0.5}}\n"
        )
    };
    for start in ["0", "0.2", "-3"] {
        let value = run(&file(start), &["--steady", "--hold", "i=0.4", "--solve", "u,W"]);
        close(found(&value, "W"), 200.0, 1e-12);
        close(found(&value, "u"), 10.4, 1e-12);
        let value = run(&file(start), &["--steady", "--hold", "phi=0", "--solve", "u"]);
        close(found(&value, "u"), 5.2, 1e-12);
        close(value["equilibrium"]["i"].as_f64().unwrap(), 0.2, 1e-12);
    }
}
