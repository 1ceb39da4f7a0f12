//! What drives mechanisms with constraints, and what answers: coordinates, outputs and reactions, against closed forms and
//! twins without constraints.

use dalembert::linear::{Guess, LinearError, Source, linearise_constrained};
use dalembert::mechanism::{Dynamic, Equations};
use serde_json::Value;

use super::{C, answer, i, library, run};

/// Every amplitude beside its closed form, to a part of itself and of the largest.
fn equals(found: &Value, name: &str, tolerance: f64, exact: impl Fn(f64) -> C) {
    let list = answer(found, name);
    assert!(list.len() > 100, "{} samples of {name}", list.len());
    for (omega, x) in list {
        let expected = exact(omega);
        assert!(expected.norm() > 0.0, "{name} at {omega}: nothing to compare with");
        assert!((x - expected).norm() <= tolerance * expected.norm(), "{name} at {omega}: {x}, {expected}");
    }
}

/// A pendulum whose rod is a constraint, of a scale, on a pivot that is moved.
fn pendulum(mass: f64, length: f64, damping: f64) -> String {
    format!(
        "name: P\nparameters: {{m: {mass:e} kg, l: {length:e} m, g: 10 m/s^2, c: {damping:e} N*s/m, F: 0 N}}\n\
         coordinates: {{x: m, y: m}}\ninputs: {{base: 0 m, push: 0 N}}\npoints: {{hinge: \"[base, 0]\"}}\n\
         bodies: {{bob: {{mass: m, position: \"[x, y]\"}}}}\ngravity: [0, -g]\n\
         constraints: {{rod: (x - base)^2 + y^2 - l^2}}\n\
         forces: {{air: {{on: bob, force: -c*velocity(bob)}}, push: {{on: bob, force: \"[push, 0]\"}}, wind: {{on: bob, force: \"[F, 0]\"}}}}\n\
         outputs: {{theta: \"atan2(x - base, -y)\", sideways: \"-2*(x - base)*reaction(rod)\", tension: -2*l*reaction(rod), \
         a: acceleration(bob)}}\nscene: {{start: {{x: 0}}, guess: {{y: -l}}, until: 1}}\n"
    )
}

/// The pendulum in its angle: m l θ'' + c l θ' + m g θ = F − m u'' − c u', x = u + l θ, and its rod carries m g θ sideways.
#[test]
fn a_pendulum_with_a_rod_answers_as_one_in_its_angle() {
    for (m, l) in [(2.0_f64, 0.5_f64), (2e-12, 0.5), (2e12, 0.5), (2.0, 1e-12), (2.0, 1e12), (1e-12, 1e12)] {
        for part in [0.0, 0.3] {
            let rate = (10.0 / l).sqrt();
            let c = part * m * rate;
            let text = pendulum(m, l, c);
            let theta = |w: f64, u: f64, f: f64| {
                (C::from(f) + (C::from(m * w * w) - i(c * w)) * u) / (i(c * l * w) + m * 10.0 - m * l * w * w)
            };
            // Beside the undamped mode its own rounding is all that counts.
            let (low, high) = (0.3 * rate, 0.9 * rate);
            let range = format!("{low:e}..{high:e}");
            let ask = |drive: &str| {
                run(&text, &["--drive", drive, "--response", "x,theta,sideways,a.x", "--range", &range]).unwrap()
            };
            let found = ask("base");
            equals(&found, "theta", 1e-13, |w| theta(w, 1.0, 0.0));
            equals(&found, "x", 1e-13, |w| theta(w, 1.0, 0.0) * l + 1.0);
            equals(&found, "sideways", 1e-13, |w| theta(w, 1.0, 0.0) * m * 10.0);
            equals(&found, "a.x", 1e-13, |w| (theta(w, 1.0, 0.0) * l + 1.0) * -(w * w));
            for force in ["push", "wind", "x"] {
                let found = ask(force);
                equals(&found, "theta", 1e-13, |w| theta(w, 0.0, 1.0));
                equals(&found, "sideways", 1e-13, |w| theta(w, 0.0, 1.0) * m * 10.0);
            }
            // Along the rod nothing moves, and the rod carries all.
            let found = run(&text, &["--drive", "y", "--response", "tension,x", "--range", &range]).unwrap();
            equals(&found, "tension", 1e-13, |_| C::from(-1.0));
            assert!(answer(&found, "x").iter().all(|(_, x)| x.norm() == 0.0));
        }
    }
}

/// One frequency at a time too, with what grows at resonance: x by F/(2 m ω) a second.
#[test]
fn a_pendulum_with_a_rod_has_steady_states_and_a_resonance() {
    let number = |value: &Value| value[0].as_f64().unwrap().hypot(value[1].as_f64().unwrap());
    let text = pendulum(2.0, 0.4, 0.0);
    let found = run(&text, &["--drive", "base", "--omega", "3"]).unwrap();
    let exact = 1.0 + 0.4 * 9.0 / (10.0 - 0.4 * 9.0);
    assert!((number(&found["steady"]["amplitude"]["x"]) - exact).abs() < 1e-13, "{found}");
    assert!(found["steady"]["growth"].is_null());
    let found = run(&text, &["--drive", "push=3", "--omega", "5"]).unwrap();
    assert!((number(&found["steady"]["growth"]["x"]) - 3.0 / (2.0 * 2.0 * 5.0)).abs() < 1e-13, "{found}");
    assert_eq!(number(&found["steady"]["growth"]["y"]), 0.0);
}

/// An answer that nothing makes is 0 at all frequencies, whatever rounding leaves of it: the tension's slope by what swings sideways, where the
/// search from a slant begins; a block on two feet presses the floor the same however it is pushed along it.
#[test]
fn what_rounding_leaves_is_no_answer() {
    let moved = "name: Long\nparameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2}\ncoordinates: {x: m, y: m}\ninputs: {s: 0.1 m}\n\
        bodies: {b: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\nconstraints: {rod: \"norm([x, y]) - l - s\"}\n\
        outputs: {T: -reaction(rod)}\nscene: {start: {x: 0.3}, guess: {y: -1}, until: 1}\n";
    let found = run(moved, &["--drive", "s", "--response", "x,T"]).unwrap();
    assert!(answer(&found, "x").iter().all(|(_, x)| x.norm() == 0.0), "{found}");
    equals(&found, "T", 1e-12, |w| C::from(w * w));
    let block = "name: Feet\nparameters: {m: 2 kg, g: 9.81 m/s^2, k: 50 N/m, h: 0.2 m}\ncoordinates: {x: m, y: m, th: rad}\n\
        inputs: {u: 0 N}\nbodies: {b: {mass: m, inertia: m*h^2/6, angle: th, position: \"[x, y]\"}}\ngravity: [3 m/s^2, -g]\n\
        points: {p1: \"position(b) + h/2*(-b.x - b.y)\", p2: \"position(b) + h/2*(b.x - b.y)\"}\n\
        springs: {s: {stretch: x, stiffness: k, along: \"[1, 0]\", on: b}}\nforces: {f: {on: b, force: \"[u, 0]\"}}\n\
        contacts:\n  c1: {gap: p1.y, on: b, at: p1, normal: \"[0, 1]\"}\n  c2: {gap: p2.y, on: b, at: p2, normal: \"[0, 1]\"}\n\
        impacts: together\noutputs: {n1: reaction(c1), n2: reaction(c2)}\nscene: {start: {y: 0.1, x: 0.1}, until: 1}\n";
    let found = run(block, &["--at", "x=0.12", "--drive", "u", "--response", "x,n1,n2"]).unwrap();
    equals(&found, "x", 1e-10, |w| C::from(1.0 / (50.0 - 2.0 * w * w)));
    assert!(["n1", "n2"].iter().all(|n| answer(&found, n).iter().all(|(_, x)| x.norm() == 0.0)), "{found}");
}

/// The four-bar beside its twin in one angle, hanging and upright, and the force in its pin by what the rocker and the
/// coupler do.
#[test]
fn a_four_bar_answers_as_its_twin_in_one_angle() {
    for (guess, twin) in [
        (["crank_angle=-1.87", "coupler_angle=0.94", "rocker_angle=2.28"], "crank_angle=-1.87"),
        (["crank_angle=1.42", "coupler_angle=0.52", "rocker_angle=1.7"], "crank_angle=1.42"),
    ] {
        let ask = |model: &str, at: &[&str]| {
            let mut options = vec!["--drive", "crank_angle", "--response", "crank_angle,C", "--range", "0.3..3"];
            at.iter().for_each(|at| options.extend(["--at", at]));
            run(&library(model), &options).unwrap()
        };
        let (found, twin) = (ask("four_bar", &guess), ask("four_bar_minimal", &[twin]));
        for name in ["crank_angle", "C.x", "C.y"] {
            let other = answer(&twin, name);
            let at =
                |omega: f64| other.iter().find(|(known, _)| (known / omega - 1.0).abs() < 1e-13).map(|known| known.1);
            let both: Vec<(C, C)> = answer(&found, name).into_iter().filter_map(|(w, x)| Some((x, at(w)?))).collect();
            assert!(both.len() > 300, "{name}: {} common frequencies", both.len());
            for (x, exact) in both {
                assert!((x - exact).norm() < 1e-10 * exact.norm(), "{name}: {x}, {exact}");
            }
        }
    }
}

/// A piston is pushed by its pin alone: the reaction at the connecting rod is −m s'', whatever drives.
#[test]
fn the_pin_of_a_slider_crank_carries_what_moves_the_piston() {
    let at = ["--at", "crank_angle=-1.5", "--at", "rod_angle=0.3", "--at", "piston_x=3"];
    let options = ["--drive", "crank_angle", "--response", "pin,piston_x", "--range", "0.3..30"];
    let found = run(&library("slider_crank"), &[&at[..], &options].concat()).unwrap();
    let pistons = answer(&found, "piston_x");
    let piston = |omega: f64| pistons.iter().find(|known| known.0 == omega).unwrap().1;
    equals(&found, "pin.x", 1e-11, |w| piston(w) * (2.0 * w * w));
}

/// A crank that a motor turns by an input leaves nothing free: the piston goes by s'(φ), and the motor's couple is
/// V''(φ) − Ω² (m s'² + m_b r²).
#[test]
fn what_a_motor_prescribes_needs_no_freedom() {
    let text = "name: A\nparameters: {r: 0.2 m, l: 0.5 m, m: 2 kg, mb: 1 kg, k: 100 N/m, s0: 0.5 m}\n\
        coordinates: {phi: rad, psi: rad, s: m}\ninputs: {u: 0 rad}\n\
        points: {B: \"r*[cos(phi), sin(phi)]\", P: \"B + l*[cos(psi), sin(psi)]\"}\n\
        bodies: {p: {mass: m, position: \"[s, 0]\"}, b: {mass: mb, position: B}}\n\
        constraints: {pin: P - position(p), motor: phi - pi/3 - u}\n\
        springs: {k: {stretch: s - s0, stiffness: k, on: p, along: \"[1, 0]\"}}\n\
        outputs: {couple: reaction(motor)}\nscene: {start: {phi: pi/3}, guess: {psi: -0.3, s: 0.6}, until: 1}\n";
    let found = run(text, &["--response", "s,couple,psi", "--range", "1..100"]).unwrap();
    let (sin, cos) = std::f64::consts::FRAC_PI_3.sin_cos();
    let (r, l, m, mb, k, s0) = (0.2_f64, 0.5_f64, 2.0, 1.0, 100.0, 0.5);
    let root = (l * l - r * r * sin * sin).sqrt();
    let slope = -r * sin - r * r * sin * cos / root;
    let second = -r * cos - r * r * (cos * cos - sin * sin) / root - (r * r * sin * cos).powi(2) / root.powi(3);
    equals(&found, "s", 1e-13, |_| C::from(slope));
    equals(&found, "psi", 1e-13, |_| C::from(-r * cos / root));
    let stiffness = k * (slope * slope + (r * cos + root - s0) * second);
    let mass = m * slope * slope + mb * r * r;
    let passed = (stiffness / mass).sqrt();
    assert!(passed.is_finite());
    for (w, x) in answer(&found, "couple") {
        let exact = stiffness - mass * w * w;
        assert!((x - exact).norm() < 1e-12 * (stiffness.abs() + mass * w * w), "{w}: {x}, {exact}");
    }
}

const TWICE: &str = "name: A\nparameters: {m: 2 kg, l: 0.4 m, g: 10 m/s^2}\ncoordinates: {x: m, y: m}\n\
    inputs: {base: 0 m, other: 0 m}\nbodies: {bob: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\n\
    constraints: {rod: (x - base)^2 + y^2 - l^2, again: 3*((x - base)^2 + y^2 - l^2)}\n\
    outputs: {one: reaction(rod), both: -2*l*(reaction(rod) + 3*reaction(again))}\n\
    scene: {start: {x: 0}, guess: {y: -l}, until: 1}\n";

/// Two rods in one place: the pendulum moves as with one; what both carry is known, what one carries is not; and moved apart
/// they hold the pendulum, which their slopes here do not tell.
#[test]
fn redundant_rods_share_a_load_in_any_way() {
    let found = run(TWICE, &["--drive", "base", "--response", "x", "--range", "1..4"]).unwrap();
    equals(&found, "x", 1e-13, |w| C::from(1.0 + 0.4 * w * w / (10.0 - 0.4 * w * w)));
    let found = run(TWICE, &["--drive", "y", "--response", "both", "--range", "1..4"]).unwrap();
    equals(&found, "both", 1e-13, |_| C::from(-1.0));
    let refused = run(TWICE, &["--drive", "y", "--response", "one", "--range", "1..4"]).unwrap_err();
    assert!(refused.contains("`one` contains a reaction that is not unique"), "{refused}");
    let apart = TWICE.replace("3*((x - base)", "3*((x - other)");
    let refused = run(&apart, &["--drive", "base", "--response", "x", "--range", "1..4"]).unwrap_err();
    assert!(refused.contains("depend on each other here, but not near by"), "{refused}");
    // Forces drive it all the same, and it has its mode.
    let found = run(&apart, &["--drive", "x", "--response", "x", "--range", "1..4"]).unwrap();
    equals(&found, "x", 1e-13, |w| C::from(1.0 / (50.0 - 2.0 * w * w)));
    // Off the vertical the two rods' slopes contradict each other at once.
    let sideways = "name: A\nparameters: {k: 3 1}\ncoordinates: {x: 1, y: 1}\ninputs: {u: 0, v: 0}\n\
        kinetic_energy: (x'^2 + y'^2)/2\npotential_energy: k*(x^2 + y^2)/2\n\
        constraints: {one: x - u, two: 2*x - 2*v}\nscene: {start: {x: 0}, until: 1}\n";
    let refused = run(sideways, &["--drive", "u", "--range", "1..2"]).unwrap_err();
    assert!(refused.contains("`u` cannot move"), "{refused}");
    let together = run(&sideways.replace("2*v", "2*u"), &["--drive", "u", "--range", "1..1.5"]).unwrap();
    equals(&together, "x", 1e-15, |_| C::from(1.0));
}

/// A wheel on a spring that rolls on a belt, (m + I/R²) x'' + k x = I/R² b'', and its grip (k − m Ω²) x; by places or rates.
#[test]
fn a_wheel_on_a_belt_is_driven_by_the_belt() {
    let text = "name: A\nparameters: {m: 2 kg, R: 0.5 m, I: 0.25 kg*m^2, k: 12 N/m}\ncoordinates: {x: m, phi: rad}\n\
        inputs: {belt: 0 m}\nbodies: {wheel: {mass: m, inertia: I, angle: -phi, position: \"[x, R]\"}}\n\
        springs: {spring: {stretch: x, stiffness: k}}\nconstraints: {rolls: x' - R*phi' - belt'}\n\
        outputs: {grip: reaction(rolls)}\nscene: {start: {x: 0}, until: 1}\n";
    let x = |w: f64| C::from(-w * w / (12.0 - 3.0 * w * w));
    for text in [text.to_owned(), text.replace("x' - R*phi' - belt'", "x - R*phi - belt")] {
        let found = run(&text, &["--drive", "belt", "--response", "x,phi,grip", "--range", "0.1..1.9"]).unwrap();
        // It moves by little beside the belt, of which its place is the difference.
        equals(&found, "x", 1e-12, x);
        equals(&found, "phi", 1e-13, |w| (x(w) - 1.0) / 0.5);
        equals(&found, "grip", 1e-12, |w| x(w) * (12.0 - 2.0 * w * w));
        let found = run(&text, &["--drive", "phi", "--response", "x,grip", "--range", "0.1..1.9"]).unwrap();
        equals(&found, "x", 1e-13, |w| C::from(2.0 / (12.0 - 3.0 * w * w)));
    }
    // A speed for an input has no place to move about.
    let speed = text.replace("belt: 0 m", "belt: 0 m/s").replace("belt'", "belt");
    let refused = run(&speed, &["--drive", "belt", "--range", "0.1..1"]).unwrap_err();
    assert!(refused.contains("let the input be the place of what moves, and write its rate `belt'`"), "{refused}");
    let found = run(&speed, &["--drive", "x", "--response", "x", "--range", "0.1..1.9"]).unwrap();
    equals(&found, "x", 1e-13, |w| C::from(1.0 / (12.0 - 3.0 * w * w)));
}

/// Two directions that a gyroscope couples, one of them of a wheel that rolls: a couple on the wheel is 1/R of force.
#[test]
fn a_gyroscope_beside_a_rolling_wheel_keeps_its_coupling() {
    let text = "name: A\nparameters: {m: 2 kg, R: 0.5 m, I: 0.25 kg*m^2, k: 12 N/m, G: 3 kg/s}\n\
        coordinates: {x: m, y: m, phi: rad}\nkinetic_energy: (m*(x'^2 + y'^2) + I*phi'^2 + G*(x*y' - y*x'))/2\n\
        potential_energy: k*(x^2 + y^2)/2\nconstraints: {rolls: x' - R*phi'}\noutputs: {grip: reaction(rolls)}\n\
        scene: {start: {x: 0}, until: 1}\n";
    let found = run(text, &["--drive", "phi", "--response", "x,y,grip", "--range", "0.1..1"]).unwrap();
    let (a, b) = (|w: f64| C::from(12.0 - 3.0 * w * w), |w: f64| C::from(12.0 - 2.0 * w * w));
    let det = |w: f64| a(w) * b(w) - C::from(9.0 * w * w);
    equals(&found, "x", 1e-13, |w| b(w) * 2.0 / det(w));
    equals(&found, "y", 1e-13, |w| i(-3.0 * w) * 2.0 / det(w));
    // R λ = f + Ω² I φ, with φ = x/R.
    equals(&found, "grip", 1e-12, |w| -(C::from(1.0) + b(w) * 2.0 / det(w) * (0.5 * w * w)) / 0.5 * -1.0);
}

/// From rest a skate without an integral moves along its edge and turns: θ = −1/((I + m d²) Ω²).
#[test]
fn a_sledge_is_driven_from_rest_though_its_edge_has_no_integral() {
    let sledge = library("chaplygin_sleigh");
    let found = run(&sledge, &["--drive", "theta", "--response", "theta", "--range", "1..2"]).unwrap();
    equals(&found, "theta", 1e-14, |w| C::from(-1.0 / (0.5 * w * w)));
    let found = run(&sledge, &["--drive", "x", "--response", "x", "--range", "1..2"]).unwrap();
    equals(&found, "x", 1e-14, |w| C::from(-1.0 / (w * w)));
    // Going on it is no rest; and friction made of reactions is no force by itself.
    let going = run(&sledge, &["--at", "x'=1", "--drive", "theta", "--range", "1..2"]).unwrap_err();
    assert!(going.contains("motions about rest"), "{going}");
    let slips = run(&library("stick_slip"), &["--phase", "slips_back", "--drive", "x", "--range", "1..2"]).unwrap_err();
    assert!(slips.contains("forces are made of reactions, as friction is"), "{slips}");
}

/// What depends on time by itself has no rest, in a force or in a constraint, though it vanishes at t = 0 with its rate; where
/// parameters take it out it has.
#[test]
fn what_changes_with_time_has_no_rest_with_constraints_either() {
    let text = |a: &str, f: &str| {
        format!(
            "name: A\nparameters: {{m: 2 kg, k: 8 N/m, w: 3 1/s, a: {a} m, F: {f} N}}\ncoordinates: {{x: m, y: m}}\n\
             bodies: {{p: {{mass: m, position: \"[x, y]\"}}}}\nsprings: {{s: {{stretch: x, stiffness: k}}}}\n\
             forces: {{f: {{on: p, force: \"[F*sin(w*t)^2, 0]\"}}}}\nconstraints: {{floor: y - a*sin(w*t)^3}}\n\
             scene: {{start: {{x: 0}}, until: 1}}\n"
        )
    };
    let moving = run(&text("0.1", "0"), &[]).unwrap_err();
    assert!(moving.contains("the equation of `floor` depends on time"), "{moving}");
    let pushed = run(&text("0", "0.1"), &[]).unwrap_err();
    assert!(pushed.contains("the equation of `x` depends on time"), "{pushed}");
    let found = run(&text("0", "0"), &["--drive", "x", "--response", "x", "--range", "0.1..1.9"]).unwrap();
    equals(&found, "x", 1e-13, |w| C::from(1.0 / (8.0 - 2.0 * w * w)));
}

mod compiled {
    dalembert::model!(
        yaml = r#"
name: Shaken
parameters: {m: 2 kg, l: 0.4 m, g: 10 m/s^2}
coordinates: {x: m, y: m}
inputs: {base: 0 m}
bodies: {bob: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
constraints: {rod: (x - base)^2 + y^2 - l^2}
outputs: {sideways: "-2*(x - base)*reaction(rod)"}
scene: {start: {x: 0}, guess: {y: -l}, until: 1}
"#
    );
}

/// Compiled constraints have the same slopes by inputs, and the library says what a crate is told.
#[test]
fn compiled_constraints_move_with_inputs() {
    let system = Dynamic::new(compiled::Shaken::default());
    let found = linearise_constrained(&system, &Guess::at(&[0.0, -0.4]), false).unwrap();
    assert_eq!((found.linear.inputs[0].as_str(), found.carried[(0, 0)], found.carried[(1, 0)]), ("base", 0.0, 0.0));
    assert_eq!(found.linear.input.to_dense().as_slice(), [50.0, 0.0, 0.0]);
    let seen = found.observe(&system, &["sideways", "x'"]).unwrap();
    let drive = Source::Input(0).into();
    let answers = found.linear.answers(&drive, &seen, &[3.0]).unwrap();
    let answers = answers[0].as_ref().unwrap();
    let theta = 9.0 / (10.0 - 0.4 * 9.0);
    assert!((answers[0] - 20.0 * theta).norm() < 1e-13 && (answers[1] - i(3.0) * (1.0 + 0.4 * theta)).norm() < 1e-13);
    let refused = found.observe(&system, &["sidewise"]);
    assert!(matches!(refused, Err(LinearError::UnknownAnswer { .. })), "{refused:?}");
    assert_eq!(compiled::Shaken::description().rows.len(), 1);
}
