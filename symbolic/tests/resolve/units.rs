//! Units: inferred through every expression, and what does not fit is refused (LANGUAGE, section 10).

use std::fs;
use std::path::Path;

use dalembert_symbolic::file::render;
use dalembert_symbolic::model::{Sets, load};

use crate::model;

/// Messages with their codes.
fn told(text: &str) -> Vec<String> {
    let problems = load(text, &[]).err().unwrap_or_default();
    problems.iter().map(|problem| format!("{} {}", problem.code, problem.message)).collect()
}

/// Something of everything, in SI.
fn with(more: &str) -> String {
    format!(
        "name: Bench
sizes: {{n: 3}}
parameters: {{m: 2 kg, l: 50 cm, k: 100 N/m, c: 3 N*s/m, g: 9.81 m/s^2, w: 2 rad/s, mu: 0.3 1, free: 4, later: 2 s, \"a[i in 1..n]\": 1 m}}
coordinates: {{x: m, y: m, phi: rad, u: }}
inputs: {{base: l*cos(w*t)}}
points: {{P: \"[x, y]\", O: [0, 1]}}
bodies:
  bob: {{mass: m, position: P}}
  rod: {{mass: m, inertia: m*l^2/12, angle: phi, position: \"P + l*[cos(phi), sin(phi)]\"}}
  spare: {{mass: m, position: \"[u, 0]\"}}
{more}
"
    )
}

#[track_caller]
fn fits(more: &str) {
    let text = with(more);
    assert_eq!(told(&text), [""; 0], "{more}");
}

#[track_caller]
fn refused(more: &str, message: &str) {
    assert_eq!(told(&with(more)), [message], "{more}");
}

/// The help of the only problem there is, and the file after it was followed.
#[track_caller]
fn helped(more: &str, help: &str, followed: &str) {
    let problems = load(&with(more), &[]).err().unwrap_or_default();
    assert_eq!(problems.iter().map(|problem| &*problem.help).collect::<Vec<_>>(), [help], "{more}");
    fits(followed);
}

#[test]
fn helps_lead_out() {
    helped(
        "define: {d: t - 1}",
        "a number beside other terms is pure: name it in `parameters` with its unit, `1 s`, and write the name",
        "define: {d: t - later}",
    );
    helped(
        "define: {d: 2 + x}",
        "a number beside other terms is pure: name it in `parameters` with its unit, `2 m`, and write the name",
        "define: {d: l + x}",
    );
    helped("define: {d: x + phi}", "", "define: {d: x + l*phi}");
    let angle = "a number alone fits, or one in `rad` or `deg`";
    for followed in ["phi: 0", "phi: 30 deg", "phi: 0.5 rad"] {
        helped("scene: {start: {phi: 0 kg}}", angle, &format!("scene: {{start: {{{followed}}}}}"));
    }
    helped("scene: {start: {\"x'\": 2 s}}", "a number alone is in m/s", "scene: {start: {\"x'\": 2}}");
    helped("scene: {until: 2 m}", "a number alone is in s", "scene: {until: 2}");
}

#[test]
fn the_models_of_the_workspace_fit() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let mut seen = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "yaml") {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        if let Err(problems) = load(&text, &[]) {
            panic!("{}", render(&path.display().to_string(), &text, &problems));
        }
        seen += 1;
    }
    assert!(seen >= 40);
}

#[test]
fn sums() {
    fits("define: {d: \"x + l - a[2] + 0\", e: 1 + phi, f: \"sum(a[i]*x^i/l^i, i in 1..n)\"}");
    refused("define: {d: x + 1}", "E241 `x` is a length (m), but `1` is a pure number");
    refused("define: {d: x + l - phi}", "E241 `l` is a length (m), but `phi` is a pure number");
    refused("define: {d: \"sum(x^i, i in 1..n)\"}", "E241 `x^i` is a length (m), but `x^i` is an area (m^2)");
    refused("define: {d: \"max(x, x', l)\"}", "E241 `x` is a length (m), but `x'` is a velocity (m/s)");
    refused("define: {d: \"atan2(x, phi)\"}", "E241 `x` is a length (m), but `phi` is a pure number");
    refused("define: {d: \"[x, phi]\"}", "E241 `x` is a length (m), but `phi` is a pure number");
    refused("define: {d: [x, phi]}", "E241 `x` is a length (m), but `phi` is a pure number");
    refused("checks: {d: x = phi}", "E241 `x` is a length (m), but `phi` is a pure number");
}

#[test]
fn products_powers_and_functions() {
    fits("checks: {d: \"sqrt(x^2 + l^2) = norm(P) + x^1.5/l^0.5 + abs(x) + l*exp(x/l)*sign(x)\"}");
    fits("checks: {d: \"dot(P, velocity(P)) = cross(P, [x', y']) + x*rate(x) + diff(x^3, x)*w/3\"}");
    fits("checks: {d: \"velocity(rod, P) = angular_velocity(rod)*l*rod.x + acceleration(P)/w + unit(P)*x'\"}");
    fits("checks: {d: \"integral(s*(l - s), s in 0..l) = integral(l^2*s, s in 0..1)*l\"}");
    fits("checks: {d: base = x, e: base' = y', f: base'' = g}");
    refused("define: {d: \"integral(s + 1, s in 0..l)\"}", "E241 `s` is a length (m), but `1` is a pure number");
    refused("define: {d: sin(x)}", "E243 `sin` wants a pure number, and `x` is a length (m)");
    refused("define: {d: ln(m*g)}", "E243 `ln` wants a pure number, and `m*g` is a force (N)");
    refused("define: {d: sin(3*t)}", "E243 `sin` wants a pure number, and `3*t` is a time (s)");
    refused("define: {d: x^mu}", "E244 `x` is a length (m), and the exponent `mu` is not a number");
    refused("define: {d: 2^x}", "E245 the exponent `x` is a length (m)");
    refused("checks: {d: sqrt(x) = x}", "E241 `sqrt(x)` is in m^(1/2), but `x` is a length (m)");
}

#[test]
fn what_acts() {
    fits("gravity: [0, -9.81]");
    fits("springs: {s: {between: [O, bob], stiffness: k, rest: l}, b: {between: [O, bob], stiffness: 100}}");
    fits(
        "springs: {s: {stretch: phi, stiffness: k*l^2, on: rod}, b: {stretch: x, stiffness: k, on: bob, along: ground.x}}",
    );
    fits("springs: {s: {between: [O, bob], tension: k*length}, e: {between: [O, bob], energy: k*length^3/l}}");
    fits("dampers: {d: {between: [O, bob], damping: c}, e: {rate: phi', damping: c*l^2, on: rod}}");
    fits("forces: {f: {on: bob, force: \"[m*g, 0]\"}}\ntorques: {m_: {on: rod, torque: m*g*l}}");
    fits("generalized_forces: {x: -c*x', phi: -c*l^2*phi', u: 3*x}\ndissipation: c*x'^2/2");
    refused("gravity: [0, -k]", "E242 `[0, -k]` is a stiffness (N/m), but gravity is in m/s^2");
    refused(
        "springs: {s: {between: [O, bob], stiffness: m*g}}",
        "E242 `m*g` is a force (N), but a stiffness is in N/m",
    );
    refused(
        "springs: {s: {stretch: phi, stiffness: k, on: rod}}",
        "E242 `k` is a stiffness (N/m), but the stiffness here is in J (N*m)",
    );
    refused(
        "springs: {s: {stretch: x, stiffness: k, on: rod}}",
        "E242 `x` is a length (m), but a stretch is a pure number",
    );
    refused(
        "springs: {s: {between: [O, bob], energy: k*length}}",
        "E242 `k*length` is a force (N), but the energy of a spring is in J (N*m)",
    );
    refused(
        "dampers: {d: {between: [O, bob], damping: k}}",
        "E242 `k` is a stiffness (N/m), but the damping here is in N*s/m",
    );
    refused("forces: {f: {on: bob, force: \"[k, 0]\"}}", "E242 `[k, 0]` is a stiffness (N/m), but a force is in N");
    refused("torques: {m_: {on: rod, torque: m*g}}", "E242 `m*g` is a force (N), but a torque is in J (N*m)");
    refused(
        "generalized_forces: {phi: -c*phi'}",
        "E242 `-c*phi'` is a stiffness (N/m), but the generalized force here is in J (N*m)",
    );
    refused("potential_energy: k*x", "E242 `k*x` is a force (N), but the potential energy is in J (N*m)");
    refused(
        "dissipation: c*x^2/2",
        "E242 `c*x^2/2` is an angular momentum (kg*m^2/s), but the dissipation function is in W",
    );
    refused("frames: {slot: {angle: x}}", "E242 `x` is a length (m), but an angle is a pure number");
}

#[test]
fn an_input_that_is_a_bare_number_is_not_checked() {
    let file = |input: &str| {
        format!(
            "name: A\nparameters: {{m: 1 kg}}\ncoordinates: {{x: m}}\ninputs: {{F: {input}}}\nkinetic_energy: m*x'^2/2\ngeneralized_forces: {{x: F}}\n"
        )
    };
    assert_eq!(told(&file("5")), [""; 0]);
    let message = "E242 `F` is a mass (kg), but the generalized force here is in N";
    assert_eq!(told(&file("m*2")), [message]);
}

#[test]
fn values() {
    fits(
        "scene: {start: {x: 2*l, x': 3, phi: 30 deg, phi': w, u: 3 kg}, until: 4 s, every: 1/w, set: {m: 3, mu: 0.1}}",
    );
    fits(
        "sample: {x: [-l, l], x': [-1, 1]}\nequilibrium: {phi: pi/2}\ndraw: [{circle: {at: bob, radius: 0.1}}, {trace: \"P + [0, 1]\"}]",
    );
    refused("scene: {start: {x: 30 deg}}", "E242 `30 deg` is a pure number, but a start of it is in m");
    refused("scene: {start: {phi': l}}", "E242 `l` is a length (m), but a start of it is in 1/s");
    refused("scene: {set: {m: l}}", "E242 `l` is a length (m), but this parameter is in kg");
    refused("scene: {until: 4 m}", "E242 `4 m` is a length (m), but the end of a run is in s");
    refused("sample: {x: [0, m]}", "E242 `m` is a mass (kg), but a range of it is in m");
    refused("equilibrium: {phi: l}", "E242 `l` is a length (m), but an equilibrium of it is a pure number");
    refused("checks: {d: {holds: x = x, when: {m: 1 s}}}", "E242 `1 s` is a time (s), but this parameter is in kg");
    let file = |parameters: &str| {
        format!("name: A\nparameters: {{{parameters}}}\ncoordinates: {{x: m}}\nkinetic_energy: 0*x'\n")
    };
    assert_eq!(told(&file("l: 2 m, J: 3*l^2 kg*m^2")), ["E242 `3*l^2` is an area (m^2), but its unit is in kg*m^2"]);
    assert_eq!(told(&file("l: 2 m, b: 30 cm, r: b/l mm, s: r + l")), [""; 0]);
}

#[test]
fn a_ratio_with_a_unit_is_converted() {
    let mut found =
        model("name: A\nparameters: {l: 2 m, b: 30 cm, r: b/l mm}\ncoordinates: {x: m}\nkinetic_energy: 0*x'\n");
    assert_eq!(found.constant("r", Sets::Coordinate(0), &[2.0, 0.3]), Ok(0.15e-3));
}

#[test]
fn the_command_line() {
    let mut found = model(&with(""));
    let parameters: Vec<f64> = found.parameters.iter().map(|p| p.default).collect();
    let mut value = |text: &str, sets| found.constant(text, sets, &parameters).map_err(|p| p[0].message.clone());
    assert_eq!(value("3 cm", Sets::Coordinate(0)), Ok(0.03));
    assert_eq!(value("3", Sets::Coordinate(0)), Ok(3.0));
    assert_eq!(value("l + 1", Sets::Coordinate(0)), Ok(1.5));
    assert_eq!(
        value("180 deg", Sets::Speed(2)).unwrap_err(),
        "`180 deg` is a pure number, but this velocity is in 1/s"
    );
    assert_eq!(value("3 m", Sets::Time).unwrap_err(), "`3 m` is a length (m), but a time is in s");
    assert_eq!(value("1 kg", Sets::Coordinate(3)), Ok(1.0));
    // Where an angular frequency is wanted a hertz is a cycle a second, and nowhere else.
    let tau = std::f64::consts::TAU;
    let cases = [("2 Hz", 2.0 * tau), ("3 kHz", 3000.0 * tau), ("90 rpm", 1.5 * tau), ("2 rad/s", 2.0), ("2 1/s", 2.0)];
    for (text, omega) in cases {
        let found = value(text, Sets::Frequency).unwrap();
        assert!((found - omega).abs() <= 1e-15 * omega, "{text}: {found}");
    }
    assert!(value("2 Hz", Sets::Speed(2)).unwrap_err().contains("counts cycles"));
    assert_eq!(value("2 Hz", Sets::Any), Ok(2.0));
}

#[test]
fn energies_without_bodies_may_be_per_mass() {
    let file = |t: &str, v: &str| {
        format!(
            "name: A\nparameters: {{l: 1 m, g: 10 m/s^2, m: 1 kg}}\ncoordinates: {{q: rad}}\nkinetic_energy: {t}\npotential_energy: {v}\n"
        )
    };
    assert_eq!(told(&file("l^2*q'^2/2", "-g*l*cos(q)")), [""; 0]);
    assert_eq!(told(&file("q'^2/2", "-g/l*cos(q)")), [""; 0]);
    assert_eq!(
        told(&file("m*l^2*q'^2/2", "-g*l*cos(q)")),
        ["E242 `-g*l*cos(q)` is in m^2/s^2, but the potential energy is in J (N*m)"]
    );
    assert_eq!(
        told(&file("l*q'^2/2", "0")),
        ["E242 `l*q'^2/2` is an acceleration (m/s^2), but the kinetic energy is in J (N*m)"]
    );
}

#[test]
fn models_without_units_have_pure_time() {
    let text = "name: A
parameters: {m: 1, k: 4 1}
coordinates: {x: 1, y: rad, z: }
inputs: {u: sin(3*t)}
kinetic_energy: m*x'^2/2 + y'^2/2 + z'^2/2
potential_energy: k*x^2/2 + x + 1
scene: {start: {x: 1}, until: 5}
";
    assert_eq!(told(text), [""; 0]);
    let one = text.replace("y: rad", "y: m");
    assert_eq!(told(&one)[0], "E243 `sin` wants a pure number, and `3*t` is a time (s)");
}
