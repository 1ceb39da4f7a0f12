//! The command `modes --steady` with constraints: each mechanism beside itself in coordinates that need none, at any scale, and
//! branches of steady motions against closed forms.

use serde_json::Value;

use super::{close, run, scratch, words};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// (ω, decay rate) of all modes.
fn modes(found: &Value) -> Vec<(f64, f64)> {
    let list = found["modes"].as_array().unwrap_or_else(|| panic!("{found}"));
    list.iter().map(|mode| (number(&mode["omega"]), number(&mode["eigenvalue"][0]))).collect()
}

/// The same modes in both, as parts of the fastest.
fn twins(held: &Value, free: &Value) {
    let (a, b) = (modes(held), modes(free));
    assert_eq!(a.len(), b.len(), "{held}\n{free}");
    let size = b.iter().fold(0.0_f64, |most, x| most.max(x.0));
    for (a, b) in a.iter().zip(&b) {
        assert!((a.0 - b.0).abs() <= 1e-9 * size && (a.1 - b.1).abs() <= 1e-9 * size, "{a:?} is not {b:?}");
    }
}

/// `--set` of all.
fn set(values: &[(&str, f64)]) -> Vec<String> {
    values.iter().flat_map(|(name, value)| ["--set".to_owned(), format!("{name}={value:e}")]).collect()
}

fn with<'a>(list: &'a [String], more: &[&'a str]) -> Vec<&'a str> {
    list.iter().map(String::as_str).chain(more.iter().copied()).collect()
}

/// Watt's governor: arms, and rods from the balls to a sleeve with a damper.
const GOVERNOR: &str = "name: Governor\nparameters: {m: 1 kg, l: 0.4 m, g: 9.81 m/s^2, W: 8 rad/s, c: 0.3 N*s/m}\n\
    define: {M: m/2, J: m*l^2/3}\ncoordinates: {phi: rad, r: m, z: m, s: m}\nbodies:\n\
    \x20 one: {mass: m, position: \"[r*cos(phi), r*sin(phi), z]\"}\n\
    \x20 two: {mass: m, position: \"[-r*cos(phi), -r*sin(phi), z]\"}\n\
    \x20 sleeve: {mass: M, position: \"[0, 0, s]\"}\nkinetic_energy: J*phi'^2/2\ndissipation: c*s'^2/2\ngravity: [0, 0, -g]\n\
    constraints: {upper: r^2 + z^2 - l^2, lower: r^2 + (z - s)^2 - l^2}\n\
    scene: {start: {phi': W, r: 0.7*l, r': 0.1*l*W}, guess: {z: -0.7*l, s: -1.4*l}, until: 1}\n";
const GOVERNOR_BY_ANGLE: &str = "name: Governor\nparameters: {m: 1 kg, l: 0.4 m, g: 9.81 m/s^2, W: 8 rad/s, c: 0.3 N*s/m}\n\
    define: {M: m/2, J: m*l^2/3}\ncoordinates: {phi: rad, theta: rad}\nbodies:\n\
    \x20 one: {mass: m, position: \"l*[sin(theta)*cos(phi), sin(theta)*sin(phi), -cos(theta)]\"}\n\
    \x20 two: {mass: m, position: \"-l*[sin(theta)*cos(phi), sin(theta)*sin(phi), cos(theta)]\"}\n\
    \x20 sleeve: {mass: M, position: \"[0, 0, -2*l*cos(theta)]\"}\nkinetic_energy: J*phi'^2/2\n\
    dissipation: c*(2*l*sin(theta)*theta')^2/2\ngravity: [0, 0, -g]\n\
    scene: {start: {phi': W, theta: 0.8}, until: 1}\n";

/// Speeds of what cannot go on are left out; arms rise to cos θ = (m + M) g/(m l W²) with the sleeve on them.
#[test]
fn a_governor_has_the_modes_of_its_twin_in_angles() {
    for length in [1e-6, 0.4, 1e6] {
        for mass in [1e-6, 1.0, 1e6] {
            let turning = 8.0 * (0.4_f64 / length).sqrt();
            for damping in [0.0, 0.3 * mass * turning] {
                let set = set(&[("l", length), ("m", mass), ("W", turning), ("c", damping)]);
                let options = with(&set, &["--steady"]);
                let (held, free) = (run(GOVERNOR, &options), run(GOVERNOR_BY_ANGLE, &options));
                twins(&held, &free);
                let cosine = 1.5 * 9.81 / (length * turning * turning);
                close(number(&held["equilibrium"]["z"]), -length * cosine, 1e-10);
                close(number(&held["speeds"]["phi"]), turning, 1e-15);
                assert_eq!(number(&held["speeds"]["r"]), 0.0);
                // 2 λ s of the lower rods carries the sleeve.
                close(number(&held["reactions"]["lower"]), -0.5 * mass * 9.81 / (2.0 * length * cosine), 1e-9);
            }
        }
    }
}

const HOOP: &str = "name: Hoop\nparameters: {m: 0.3 kg, R: 0.5 m, g: 9.81 m/s^2, W: 6 rad/s}\ndefine: {I: m*R^2}\n\
    coordinates: {phi: rad, r: m, z: m}\ninputs: {lift: 0 N}\nbodies: {bead: {mass: m, position: \"[r*cos(phi), r*sin(phi), z]\"}}\n\
    kinetic_energy: I*phi'^2/2\ngravity: [0, 0, -g]\nforces: {push: {on: bead, force: \"[0, 0, lift]\"}}\n\
    constraints: {hoop: r^2 + z^2 - R^2}\noutputs: {height: z}\n\
    scene: {start: {phi': W, r: 0.8*R}, guess: {z: -R/2}, until: 1}\n";
const HOOP_BY_ANGLE: &str = "name: Hoop\nparameters: {m: 0.3 kg, R: 0.5 m, g: 9.81 m/s^2, W: 6 rad/s}\ndefine: {I: m*R^2}\n\
    coordinates: {phi: rad, theta: rad}\ninputs: {lift: 0 N}\n\
    bodies: {bead: {mass: m, position: \"R*[sin(theta)*cos(phi), sin(theta)*sin(phi), -cos(theta)]\"}}\n\
    kinetic_energy: I*phi'^2/2\ngravity: [0, 0, -g]\nforces: {push: {on: bead, force: \"[0, 0, lift]\"}}\n\
    outputs: {height: -R*cos(theta)}\nscene: {start: {phi': W, theta: 0.8}, until: 1}\n";

/// What shakes a steady motion, and what answers, is the same too.
#[test]
fn a_bead_on_a_hoop_that_turns_freely_answers_as_its_twin() {
    for options in [&["--steady"][..], &["--steady", "--at", "phi'=7"]] {
        twins(&run(HOOP, options), &run(HOOP_BY_ANGLE, options));
    }
    let driven = ["--steady", "--drive", "lift", "--omega", "3", "--response", "height", "--range", "1..5"];
    let (held, free) = (run(HOOP, &driven), run(HOOP_BY_ANGLE, &driven));
    let pair = |x: &Value| [0, 1].map(|part| number(&x[part]));
    let same = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) <= 1e-9 * b[0].hypot(b[1]);
    let [a, b] = [&held, &free].map(|found| pair(&found["steady"]["amplitude"]["phi"]));
    assert!(b[0].hypot(b[1]) > 0.0 && same(a, b), "{a:?} {b:?}");
    let [a, b] = [&held, &free].map(|found| found["response"]["amplitude"]["height"].as_array().unwrap().clone());
    assert!(a.len() == b.len() && a.len() > 10);
    a.iter().zip(&b).for_each(|(a, b)| assert!(same(pair(a), pair(b)), "{a} {b}"));
    let limited = run(HOOP, &["--steady", "--set", "W=1e-3", "--at", "r=0", "--at", "z=-0.5"]);
    close(modes(&limited)[1].0, (9.81_f64 / 0.5 - 1e-6).sqrt(), 1e-9);
}

/// The bead leaves the bottom at W² = g/R, whatever turns it there and however the branch is come to.
#[test]
fn thresholds_of_steady_motions_are_known_numbers() {
    let limits = |text: &str, options: &[&str]| -> Vec<(f64, String)> {
        let found = run(text, options);
        assert!(found["locus"]["changes"].as_array().unwrap().len() <= 1, "{found}");
        let list = found["locus"]["limits"].as_array().unwrap().iter();
        list.map(|limit| (number(&limit["value"]), limit["kind"].as_str().unwrap().to_owned())).collect()
    };
    for radius in [1e-6, 0.5, 1e6] {
        let critical = (9.81_f64 / radius).sqrt();
        let range = format!("{:e}..{:e}", 0.4 * critical, 1.9 * critical);
        for (text, bottom) in [
            (HOOP, ["r=0".to_owned(), format!("z={:e}", -radius)]),
            (HOOP_BY_ANGLE, ["theta=0", "phi=0"].map(str::to_owned)),
        ] {
            for varied in ["W", "phi'"] {
                let vary = format!("{varied}={range}");
                let below = set(&[("R", radius), ("W", 0.7 * critical)]);
                let from = ["--steady", "--at", &bottom[0], "--at", &bottom[1], "--vary", &vary];
                let found = limits(text, &with(&below, &from));
                assert!(found.len() == 1 && found[0].1 == "divergence", "{found:?}");
                close(found[0].0, critical, 1e-8);
                // From where it has risen the branch ends there.
                let above = set(&[("R", radius), ("W", 1.5 * critical)]);
                let found = limits(text, &with(&above, &["--steady", "--vary", &vary]));
                assert!(
                    found.iter().any(|(value, kind)| kind == "bifurcation" && (value / critical - 1.0).abs() < 1e-8),
                    "{found:?}"
                );
            }
        }
    }
    // Speeds that are given stay, and such as are written with the parameter follow it.
    let by_gravity = limits(HOOP, &["--steady", "--at", "r=0", "--at", "z=-0.5", "--vary", "g=10..30"]);
    assert!(by_gravity.len() == 1, "{by_gravity:?}");
    close(by_gravity[0].0, 18.0, 1e-8);
    let written = limits(HOOP, &["--at", "r=0", "--at", "z=-0.5", "--at", "phi'=2*W", "--vary", "W=1..4"]);
    assert!(written.len() == 1, "{written:?}");
    close(written[0].0, 0.5 * (9.81_f64 / 0.5).sqrt(), 1e-8);
}

/// With the sleeve's weight, and two rods in the loop, at W² = (m + M) g/(m l).
#[test]
fn the_arms_of_a_governor_rise_at_their_speed() {
    let onset = (1.5 * 9.81_f64 / 0.4).sqrt();
    let found = run(GOVERNOR, &["--steady", "--set", "W=9", "--set", "c=0", "--vary", "W=5..12"]);
    let steps = found["locus"]["steps"].as_array().unwrap();
    for step in steps {
        let turning = number(&step["value"]);
        close(number(&step["equilibrium"]["z"]), -(1.5 * 9.81 / (turning * turning)).min(0.4), 1e-9);
    }
    let limits = found["locus"]["limits"].as_array().unwrap();
    assert!(limits.len() == 1 && limits[0]["kind"] == "bifurcation", "{limits:?}");
    close(number(&limits[0]["value"]), onset, 1e-8);
    let along = |turning: &str| {
        let set = format!("W={turning}");
        modes(&run(GOVERNOR, &["--steady", "--set", &set, "--set", "c=0"]))[1].0
    };
    let largest = |step: &Value| {
        let list = step["eigenvalues"].as_array().unwrap();
        list.iter().fold(0.0_f64, |most, x| most.max(number(&x[1])))
    };
    for (step, turning) in [(&steps[0], "5"), (&steps[steps.len() - 1], "12")] {
        close(largest(step), along(turning), 1e-9);
    }
}

/// Two bodies on a rod in polar coordinates about a point that it slides through, with springs.
#[test]
fn two_bodies_on_a_rod_turn_as_their_twin() {
    let text = |coordinates: &str, second: &str, more: &str, start: &str| {
        format!(
            "name: Rod\nparameters: {{a: 1 kg, b: 2.5 kg, l: 1 m, k: 90 N/m}}\ncoordinates: {{{coordinates}}}\nbodies:\n\
             \x20 one: {{mass: a, position: \"r*[cos(phi), sin(phi)]\"}}\n\
             \x20 two: {{mass: b, position: \"-({second})*[cos(phi), sin(phi)]\"}}\npotential_energy: k*(r - l/2)^2/2\n{more}\
             scene: {{start: {{phi': 3, r: l/2}}, {start}until: 1}}\n"
        )
    };
    let held = text("phi: rad, r: m, s: m", "s", "constraints: {rod: r + s - l}\n", "guess: {s: l/2}, ");
    let free = text("phi: rad, r: m", "l - r", "", "");
    let (held, free) = (run(&held, &["--steady"]), run(&free, &["--steady"]));
    twins(&held, &free);
    close(number(&held["equilibrium"]["r"]), number(&free["equilibrium"]["r"]), 1e-12);
}

fn wheel(rolls: &str) -> String {
    format!(
        "name: Wheel\nparameters: {{m: 2 kg, R: 0.5 m, k: 30 N/m, W: 1 m/s}}\ndefine: {{I: m*R^2/2}}\n\
         coordinates: {{x: m, phi: rad, u: m}}\nbodies:\n  wheel: {{mass: m, inertia: I, angle: -phi, position: \"[x, R]\"}}\n\
         \x20 load: {{mass: m, position: \"[x + u, R]\"}}\nsprings: {{s: {{stretch: u, stiffness: k}}}}\n\
         constraints: {{rolls: {rolls}}}\nscene: {{start: {{x': W}}, until: 1}}\n"
    )
}

/// A wheel rolls on with the speed that goes with x', whichever radius it has, by places and by speeds.
#[test]
fn a_wheel_rolls_steadily_with_the_speed_that_its_radius_wants() {
    for rolls in ["x' - R*phi'", "x - R*phi"] {
        for radius in [1e-6, 0.5, 1e6] {
            let radius_is = format!("R={radius:e}");
            let found = run(&wheel(rolls), &["--steady", "--set", &radius_is]);
            close(number(&found["speeds"]["phi"]), 1.0 / radius, 1e-12);
            // k (1/m + 1/(m + I/R²)).
            close(modes(&found)[1].0.powi(2), 30.0 * (1.0 / 2.0 + 1.0 / 3.0), 1e-9);
        }
        let found = run(&wheel(rolls), &["--steady", "--vary", "R=0.1..2"]);
        let locus = &found["locus"];
        assert!(
            locus["limits"].as_array().unwrap().is_empty() && locus["steps"].as_array().unwrap().len() > 2,
            "{locus}"
        );
        let both = run(&wheel(rolls), &["--steady", "--at", "phi'=2"]);
        close(number(&both["speeds"]["x"]), 1.0, 1e-12);
    }
    let refused = words(&wheel("x' - R*phi'"), &["--steady", "--at", "phi'=3"]).unwrap_err();
    assert!(
        refused.contains("the constraint `rolls` does not allow the speeds") && refused.contains("`x'`"),
        "{refused}"
    );
}

/// A pendulum on a cart in places alone: neither x goes on by itself, both do together.
#[test]
fn what_goes_on_together_only_is_found() {
    let held = "name: Cart\nparameters: {m: 1 kg, M: 3 kg, l: 0.7 m, g: 9.81 m/s^2}\ncoordinates: {x: m, a: m, b: m}\nbodies:\n\
        \x20 cart: {mass: M, position: \"[x, 0]\"}\n  bob: {mass: m, position: \"[a, b]\"}\ngravity: [0, -g]\n\
        constraints: {rod: (a - x)^2 + b^2 - l^2}\nscene: {start: {x': 2, x: 0, a: 0}, guess: {b: -l}, until: 1}\n";
    let found = run(held, &["--steady"]);
    close(number(&found["speeds"]["a"]), 2.0, 1e-12);
    close(modes(&found)[1].0.powi(2), 9.81 / 0.7 * (1.0 + 1.0 / 3.0), 1e-9);
    let refused = words(held, &["--steady", "--at", "a'=1"]).unwrap_err();
    assert!(refused.contains("goes on only together with other coordinates"), "{refused}");
    let refused = words(held, &["--steady", "--at", "b'=1"]).unwrap_err();
    assert!(refused.contains("not a steady motion: `b` has a speed"), "{refused}");
}

/// By x and y nothing is cyclic; a sleigh, which has no independent coordinates, goes straight on.
#[test]
fn what_cannot_be_steady_is_refused_and_what_has_no_matrices_has_eigenvalues() {
    let rod = "name: Rod\nparameters: {m: 1 kg, l: 1 m}\ncoordinates: {x: m, y: m}\nbodies: {bob: {mass: m, position: \"[x, y]\"}}\n\
        constraints: {rod: x^2 + y^2 - l^2}\nscene: {start: {x: 1, y: 0, y': 2}, until: 1}\n";
    let refused = words(rod, &["--steady"]).unwrap_err();
    assert!(refused.contains("depend on the value of every coordinate") && refused.contains("r*cos(phi)"), "{refused}");
    let refused = words(rod, &["--at", "y'=2"]).unwrap_err();
    assert!(refused.contains("not a steady motion: `y` has a speed"), "{refused}");
    let sled = "name: Sled\nparameters: {m: 1 kg, I: 0.25 kg*m^2, d: 0.5 m}\ncoordinates: {x: m, y: m, a: rad}\n\
        points: {skate: \"[x, y]\"}\nbodies: {sled: {mass: m, inertia: I, angle: a, position: skate + d*sled.x}}\n\
        constraints: {edge: \"dot(velocity(skate), sled.y)\"}\nscene: {start: {x': 2, a: 0, a': 0.3}, until: 1}\n";
    let found = run(sled, &["--steady"]);
    assert_eq!(number(&found["speeds"]["a"]), 0.0);
    let rates: Vec<f64> = found["eigenvalues"].as_array().unwrap().iter().map(|x| number(&x[0])).collect();
    // −m d v/(I + m d²), lecture 16.
    assert!(rates.iter().any(|rate| (rate + 2.0).abs() < 1e-12), "{rates:?}");
    let refused = words(sled, &["--motion", "never.svg"]).unwrap_err();
    assert!(refused.contains("`edge` contains speeds") && refused.contains("simulate"), "{refused}");
}

/// A constraint that turns the hoop leaves departures in the bead alone: ω² = W² − (g/(R W))², along a branch too.
#[test]
fn what_a_constraint_turns_has_the_eigenvalues_of_a_hoop_that_is_turned() {
    let turned = HOOP_BY_ANGLE.replace("coordinates: {phi: rad, ", "coordinates: {").replace("(phi)", "(W*t)");
    let turned = turned
        .replace("kinetic_energy: I*phi'^2/2\n", "")
        .replace("phi': W, ", "")
        .replace("start: {theta: 0.8}", "start: {theta: 1.1}");
    let turned = turned.replace("scene:", "equilibrium: {theta: 1.1}\nscene:");
    let omega = modes(&run(&turned, &[]))[0].0;
    for lock in ["lock: phi - W*t", "lock: phi' - W"] {
        let held = HOOP.replace("constraints: {", &format!("constraints: {{{lock}, "));
        let found = run(&held, &["--steady"]);
        let list = found["eigenvalues"].as_array().unwrap();
        assert_eq!(list.len(), 2, "{found}");
        close(number(&list[1][1]).abs(), omega, 1e-9);
        let along = run(&held, &["--steady", "--vary", "g=5..10"]);
        for step in along["locus"]["steps"].as_array().unwrap() {
            let (g, of) = (number(&step["value"]), &step["eigenvalues"][1]);
            close(number(&of[1]).abs(), (36.0 - (g / 3.0).powi(2)).sqrt(), 1e-12);
            assert!(number(&of[0]).abs() < 1e-13, "{step}");
        }
    }
}

/// The free motion from a start beside a rest: what is left out is of second order, in y of the rod and by the amplitude.
#[test]
fn free_motions_with_constraints_are_compared_with_the_full_equations() {
    let pendulum = |angle: f64, more: &str| {
        format!(
            "name: Rod\nparameters: {{m: 1 kg, l: 1 m, g: 10 m/s^2, c: 0.4 N*s/m}}\ncoordinates: {{x: m, y: m}}\n\
             bodies: {{bob: {{mass: m, position: \"[x, y]\"}}}}\ngravity: [0, -g]\n{more}constraints: {{rod: x^2 + y^2 - l^2}}\n\
             equilibrium: {{x: 0, y: -l}}\nscene: {{start: {{x: {angle:e}}}, guess: {{y: -l}}, until: 3, tolerance: 1e-12}}\n"
        )
    };
    let path = scratch("motion.svg");
    let file = path.to_str().unwrap().to_owned();
    let motion = |text: &str| run(text, &["--motion", &file])["motion"].clone();
    let apart = |text: &str| {
        let found = motion(text);
        let list = found["differences"].as_object().unwrap_or_else(|| panic!("{found}")).clone();
        number(&list["the full equations, integrated"])
    };
    let (small, large) = (apart(&pendulum(1e-4, "")), apart(&pendulum(1e-3, "")));
    // y departs by x²/2, which a line does not.
    close(small, 0.5e-4, 1e-3);
    close(large, 0.5e-3, 1e-2);
    assert!(std::fs::read_to_string(&path).unwrap().contains("exp(A t)"));
    let damped = motion(&pendulum(1e-4, "dissipation: c*(x'^2 + y'^2)/2\n"));
    assert_eq!(damped["differences"].as_object().unwrap().len(), 2, "{damped}");
    // About a steady motion, from its own start.
    let risen = HOOP.replace("r: 0.8*R}, guess: {z: -R/2}", "r: 0.41}, guess: {z: -0.28}");
    let found = run(&risen, &["--steady", "--motion", &file]);
    assert!(number(&found["motion"]["differences"]["the full equations, integrated"]) < 0.2, "{found}");
    let refused = words(&pendulum(0.0, ""), &["--motion", &file]).unwrap_err();
    assert!(refused.contains("starts at rest in the equilibrium"), "{refused}");
    // An integral that the start has otherwise keeps it from this rest.
    let rolling = wheel("x' - R*phi'")
        .replace("start: {x': W}", "start: {x: 0.3, u: 0.01}")
        .replace("scene:", "equilibrium: {phi: 1}\nscene:");
    let refused = words(&rolling, &["--motion", &file]).unwrap_err();
    assert!(refused.contains("another value of the integral of `rolls`"), "{refused}");
    std::fs::remove_file(path).unwrap();
}

/// A disc on a shaft with damping outside, ce, and in what turns, ci: it whirls from w (1 + ce/ci) on, w² = k/m.  Forces act along the angle,
/// but nothing depends on its value.
#[test]
fn what_a_motor_drives_goes_on_too() {
    let rotor = "name: Rotor\nparameters: {m: 3 kg, k: 9000 N/m, ci: 8 N*s/m, ce: 5 N*s/m, W: 20 rad/s, J: 0.1 kg*m^2}\n\
        coordinates: {x: m, y: m, spin: rad}\nbodies: {disc: {mass: m, inertia: J, angle: spin, position: \"[x, y]\"}}\n\
        potential_energy: k/2*(x^2 + y^2)\n\
        dissipation: ce/2*(x'^2 + y'^2) + ci/2*((x' + spin'*y)^2 + (y' - spin'*x)^2)\nscene: {start: {spin': W}, until: 1}\n";
    let found = run(rotor, &["--steady", "--vary", "W=10..150"]);
    let limits = super::limits(&found);
    assert!(limits.len() == 1 && limits[0].1 == "flutter", "{limits:?}");
    close(limits[0].0, 3000_f64.sqrt() * (1.0 + 5.0 / 8.0), 1e-10);
    // A bead on a spring along a spoke: k (r − l) = m r W², with a motor that stands, and with one that holds against a brake.
    let spoke = "name: Spoke\nparameters: {J: 1 kg*m^2, m: 1 kg, k: 100 N/m, l: 1 m, c: 0.1 N*m*s/rad, hold: 0.3 N*m}\ncoordinates: {phi: rad, r: m}\n\
        inputs: {u: 0 N*m}\nbodies: {disk: {mass: 0, inertia: J, angle: phi, position: [0, 0]}, bead: {mass: m, position: r*[cos(phi), sin(phi)]}}\n\
        potential_energy: k*(r - l)^2/2\ntorques: {motor: {on: disk, torque: LAW}}\nscene: {start: {phi': 3, r: 1.1}, until: 1}\n";
    let spoke = spoke.replace("position: r*[cos(phi), sin(phi)]", "position: \"r*[cos(phi), sin(phi)]\"");
    for law in ["u", "hold - c*phi'"] {
        let found = run(&spoke.replace("LAW", law), &["--steady"]);
        close(number(&found["equilibrium"]["r"]), 100.0 / 91.0, 1e-12);
    }
    // A motor that it does not stand still against, and an angle that matters.
    assert!(words(&spoke.replace("LAW", "hold"), &["--steady"]).unwrap_err().contains("no equilibrium"));
    let held = words(&spoke.replace("LAW", "-hold*phi"), &["--steady"]).unwrap_err();
    assert!(held.contains("no coordinate on whose value nothing depends"), "{held}");
}
