//! What is read as it is meant, or refused: files that used to be read as something else, each with its neighbour.

use dalembert_symbolic::model::{Sets, load, read_through};

use crate::{At, close, model};

/// The codes of what is wrong with a text.
fn codes(text: &str) -> Vec<&'static str> {
    load(text, &[]).map_or_else(|problems| problems.iter().map(|p| p.code).collect(), |_| Vec::new())
}

/// A particle on a line with something more.
fn particle(more: &str) -> String {
    format!(
        "name: P\nparameters: {{m: 2 kg, k: 3 N/m, c: 1 N*s/m, v: 1 m/s}}\ncoordinates: {{x: m}}\ninputs: {{u: 2*sin(3)*t}}\n\
         bodies: {{a: {{mass: m, position: \"[x, 0]\"}}}}\n{more}\n"
    )
}

/// `sq7.yaml`: `'x''` in single quotes was read as x'.
#[test]
fn primes_in_single_quotes() {
    assert_eq!(codes(&particle("outputs: {acc: 'x'' + 0'}")), ["E017"]);
    assert_eq!(codes(&particle("outputs: {acc: 'rate(x'') + 1'}")), ["E017"]);
    assert_eq!(codes(&particle("outputs:\n- 'x'''")), ["E017"]);
    assert_eq!(codes(&particle("scene: {start: {'x''': 1}}")), ["E017"]);
    let mut whole = model(&particle("define: {acc: \"x'' + 0\", speed: \"x'\", place: 'x + 0'}\nabout: 'it''s right'"));
    let at = At::new(&[("x''", 5.0), ("x'", 3.0), ("x", 1.0)]);
    close(&["acc", "speed", "place"].map(|name| at.of(&mut whole, name)[0]), &[5.0, 3.0, 1.0]);
    assert_eq!(whole.about, "it's right");
    assert_eq!(codes(&particle("outputs:\n  acc: x''\n  speed: x' + x'")), [""; 0]);
}

/// `diff(x, t)` was 0, so that a damper did nothing.
#[test]
fn partial_derivatives_by_time() {
    let force = |force: &str| codes(&particle(&format!("forces: {{f: {{on: a, force: \"[{force}, 0]\"}}}}")));
    for moving in [
        "-c*diff(x, t)",
        "-c*diff(x - v*t, t)",
        "-c*diff(velocity(a).x, t)*1",
        "-c*diff(u, t)*1",
        "-c*diff(sin(x/v)*t, t)",
    ] {
        assert!(force(moving).contains(&"E234"), "{moving}: {:?}", force(moving));
    }
    assert_eq!(force("-c*rate(x)"), [""; 0]);
    assert_eq!(force("c*diff(v*t, t)"), [""; 0]);
    assert_eq!(force("k*diff(x^2/2, x)"), [""; 0]);
    // ∂L/∂t of Jacobi's theorem, where it is tested; there too what has no explicit t is no such thing.
    let jacobi = |check: &str| codes(&particle(&format!("checks: {{jacobi: \"{check}\"}}")));
    assert_eq!(jacobi("diff(m*x'^2/2 + k*x*v*t, t) = k*x*v"), [""; 0]);
    assert_eq!(jacobi("diff(m*x'^2/2, t) = 0"), ["E234"]);
    assert_eq!(codes(&particle("outputs: {w: \"diff(x*t, t)\"}")), ["E234"]);
    assert_eq!(codes(&particle("define: {w: \"diff(x*t, t)\"}")), ["E234"]);
}

/// `stiffness: 5 N/m` was refused though `mass: 2 kg` was not.
#[test]
fn units_wherever_one_value_is_wanted() {
    let mut whole = model(
        "name: Units\nparameters: {l: 1 m}\ncoordinates: {x: m, theta: rad}\ninputs: {u: 30 cm}\n\
         frames: {tilted: {angle: 30 deg}}\ndefine: {w: 20 cm, d: [1 km, 2 m]}\npoints: {p: [10 cm, l]}\n\
         bodies:\n  a: {mass: 200 g, position: \"[x, 0]\"}\n  b: {mass: 1 kg, inertia: 3 g*m^2, angle: theta, position: [0, 50 cm]}\n\
         gravity: [0, -981 cm/s^2]\n\
         springs:\n  s: {between: [ground, a], stiffness: 5 N/mm, rest: 10 cm}\n  t: {stretch: theta, stiffness: 2 N*m, on: b}\n\
         dampers: {d: {between: [ground, a], damping: 100 g/s}}\n\
         torques: {q: {on: b, torque: 1 kN*mm}}\ngeneralized_forces: {x: 3 mN}\ndraw: [{circle: {at: a, radius: 5 cm}}]\n",
    );
    let at = At::new(&[("x", 0.3)]);
    close(&at.of(&mut whole, "potential_energy"), &[5000.0 * 0.04 / 2.0 + 9.81 * 0.5]);
    close(&[at.of(&mut whole, "w")[0], at.of(&mut whole, "tilted.x.x")[0]], &[0.2, 3_f64.sqrt() / 2.0]);
    close(&at.of(&mut whole, "d + p"), &[1000.1, 3.0]);
    close(&at.values(&whole, &[whole.generalized_forces[0].force, whole.inputs[0].signal[0]]), &[0.003, 0.3]);
    // A wrong unit is told, and a forgotten operator is no unit.
    assert_eq!(codes(&particle("springs: {s: {between: [ground, a], stiffness: 5 N}}")), ["E242"]);
    assert_eq!(codes(&particle("springs: {s: {between: [ground, a], stiffness: 5 q}}")), ["E106"]);
    assert_eq!(codes(&particle("springs: {s: {between: [ground, a], stiffness: k k}}")), ["E106"]);
    assert_eq!(codes(&particle("potential_energy: k x")), ["E106"]);
}

/// `--input "y=0.1*cos(3*t)"` was refused: no number of the command line can carry a unit.
#[test]
fn inputs_on_the_command_line() {
    let mut whole = model(&particle(""));
    let at = At::new(&[("t", 0.4)]);
    let [u, rate, second] = whole.signal("0.1*cos(3*t)", 0).unwrap();
    let wanted = [0.1 * 1.2_f64.cos(), -0.3 * 1.2_f64.sin(), -0.9 * 1.2_f64.cos()];
    close(&at.values(&whole, &[u, rate, second]), &wanted);
    let id = whole.signal("5 ms", 0).unwrap()[0];
    close(&at.values(&whole, &[id]), &[0.005]);
    assert_eq!(whole.signal("5 cm", 0).unwrap_err()[0].code, "E242");
    assert_eq!(whole.signal("x*t", 0).unwrap_err()[0].code, "E215");
    assert_eq!(whole.signal("sin(m)", 0).unwrap_err()[0].code, "E243");
    close(&[whole.constant("30 deg", Sets::Any, &[]).unwrap()], &[std::f64::consts::PI / 6.0]);
}

/// A flat sum of 200 terms was nested deeper than 200 levels.
#[test]
fn long_sums_are_not_deep() {
    let mut whole = model(&particle(""));
    let at = At::new(&[("x", 0.5), ("x'", 2.0)]);
    let terms = |n: usize, sign: &str| vec!["x"; n].join(sign);
    close(&at.of(&mut whole, &terms(200, " + ")), &[100.0]);
    close(&at.of(&mut whole, &terms(5000, "+")), &[2500.0]);
    close(&at.of(&mut whole, &terms(301, " - ")), &[0.5 - 150.0]);
    close(&at.of(&mut whole, &format!("1{}", "*x/x'*4".repeat(500))), &[1.0]);
    close(&at.of(&mut whole, &format!("1{}", "/x".repeat(20))), &[2_f64.powi(20)]);
    let alternating: String = (1..400).map(|k| format!("{}{k}*x", if k % 3 == 0 { "-" } else { "+" })).collect();
    let value: f64 = (1..400).map(|k| if k % 3 == 0 { -0.5 * f64::from(k) } else { 0.5 * f64::from(k) }).sum();
    close(&at.of(&mut whole, &format!("0 {alternating}")), &[value]);
    // Sums of sums count by their parentheses; those are limited as before.
    let nested = (0..40).fold("x".to_owned(), |inner, _| format!("({inner}{})", " + x".repeat(20)));
    close(&at.of(&mut whole, &nested), &[0.5 * 801.0]);
    let deep = |levels: usize| format!("{}x{}", "(".repeat(levels), ")".repeat(levels));
    assert!(whole.expression(&deep(190)).is_ok());
    assert_eq!(whole.expression(&deep(210)).unwrap_err()[0].code, "E110");
    assert_eq!(whole.expression(&format!("{}x", "-".repeat(3000))).unwrap_err()[0].code, "E110");
    assert_eq!(whole.expression(&vec!["x"; 3000].join("^")).unwrap_err()[0].code, "E110");
    assert_eq!(whole.expression(&format!("a{}", ".x".repeat(3000))).unwrap_err()[0].code, "E110");
    let tall = (0..190).fold("x".to_owned(), |inner, _| format!("x{}*({inner})", "*x+x".repeat(14)));
    assert!(whole.expression(&tall).is_err_and(|p| p[0].code == "E110"));
}

/// A rigid body without inertia was taken for one, silently.
#[test]
fn a_body_that_turns_without_inertia_is_mentioned() {
    let warned = |body: &str| {
        let text = format!(
            "name: B\nparameters: {{m: 1 kg, l: 1 m}}\ncoordinates: {{theta: rad}}\nbodies: {{b: {body}, a: {{mass: m, position: \"[l*cos(theta), 0]\"}}}}"
        );
        model(&text).warnings.iter().map(|w| w.code).collect::<Vec<_>>()
    };
    assert_eq!(warned("{mass: m, angle: theta, position: [0, 0]}"), ["W420"]);
    assert_eq!(warned("{mass: m, angle: theta, inertia: 0, position: [0, 0]}"), [""; 0]);
    assert_eq!(warned("{mass: 0, angle: theta, position: [0, 0]}"), [""; 0]);
}

/// A wrong unit hid everything that only deriving finds.
#[test]
fn a_model_with_wrong_units_can_be_judged() {
    use dalembert_symbolic::gate::judged;
    let balance = |sign: &str, force: &str| {
        particle(&format!(
            "forces: {{f: {{on: a, force: \"[{force}, 0]\"}}}}\nbalances:\n  newton:\n    equations:\n      - equation: m*x'' = {sign}{force}"
        ))
    };
    // -k*x' is no force, and the balance has its sign wrong.
    let (model, problems) = read_through(&balance("-", "-k*x'"), &[]);
    assert!(problems.iter().all(|p| p.code.starts_with("E24")) && !problems.is_empty(), "{problems:?}");
    assert_eq!(judged(model.unwrap()).unwrap_err()[0].code, "E506");
    let (model, problems) = read_through(&balance("", "-k*x'"), &[]);
    assert!(!problems.is_empty());
    assert!(judged(model.unwrap()).is_ok());
    assert!(load(&balance("", "-k*x'"), &[]).is_err());
    // Members of a family whose unit is wrong have their values, and are told once.
    let (model, problems) = read_through(
        "name: F\nparameters: {m: 1 kg}\ncoordinates: {\"x[i in 1..3]\": m}\nbodies: {\"a[i in 1..3]\": {mass: m, position: \"[x[i], 0]\"}}\n\
         generalized_forces: {\"x[i in 1..3]\": \"m*x[i]\"}",
        &[],
    );
    assert_eq!((model.unwrap().generalized_forces.len(), problems.len()), (3, 1));
    // What a run observes enters no equation; what does leaves nothing to judge.
    let (model, problems) =
        read_through(&particle("outputs: {o: nothing}\nevents: {e: {when: x + , then: record}}"), &[]);
    assert!(model.is_some() && problems.len() == 2, "{problems:?}");
    for wrong in
        ["potential_energy: nothing", "bodis: {}", "forces: {f: {on: nobody, force: [1, 0]}}", "scene: {start: {q: 1}}"]
    {
        let (model, problems) = read_through(&particle(wrong), &[]);
        assert!(model.is_none() && problems.len() == 1, "{wrong}: {problems:?}");
    }
    assert!(read_through("a: [", &[]).0.is_none());
    let (model, problems) = read_through(&particle(""), &[]);
    assert!(model.is_some() && problems.is_empty());
}

/// A number and a unit inside an expression proposed a product that does not parse.
#[test]
fn hints_lead_on() {
    let help = |text: &str| load(text, &[]).unwrap_err()[0].help.clone();
    assert!(!help(&particle("forces: {f: {on: a, force: \"[5 N, 0]\"}}")).contains("5*N"));
    assert!(help(&particle("forces: {f: {on: a, force: \"[5 x, 0]\"}}")).contains("`5*x`"));
}
