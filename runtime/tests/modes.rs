//! The command `modes` on the library's model files, against the reference cases (`B02` … `B21` of the reference
//! numbers) and closed forms.
#![cfg(feature = "cli")]
#![expect(clippy::excessive_precision, reason = "reference numbers as they were given")]

use serde_json::Value;

/// What the program writes for a model of the library, or its complaint.
fn run(model: &str, options: &[&str]) -> Result<Value, (u8, String)> {
    let path = format!("{}/../models/{model}.yaml", env!("CARGO_MANIFEST_DIR"));
    let mut arguments = vec!["dalembert", "modes", &path, "--json"];
    arguments.extend(options);
    let mut out = Vec::new();
    match dalembert::cli::run(&[], arguments, &mut out) {
        Ok(()) => Ok(serde_json::from_slice(&out).unwrap()),
        Err(problem) => Err((problem.status(), problem.to_string())),
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn matrix(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().unwrap().iter().map(numbers).collect()
}

fn omegas(value: &Value) -> Vec<f64> {
    value["modes"].as_array().unwrap().iter().map(|mode| mode["omega"].as_f64().unwrap()).collect()
}

fn kinds(value: &Value) -> Vec<&str> {
    value["modes"].as_array().unwrap().iter().map(|mode| mode["kind"].as_str().unwrap()).collect()
}

fn close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{found:?} is not {expected:?}");
    }
}

#[test]
fn b02_double_pendulum() {
    let found = run("double_pendulum", &[]).unwrap();
    close(&matrix(&found["M"]).concat(), &[4.0 / 3.0, 0.5, 0.5, 1.0 / 3.0]);
    close(&matrix(&found["K"]).concat(), &[15.0, 0.0, 0.0, 5.0]);
    close(&matrix(&found["C"]).concat(), &[0.0; 4]);
    close(&omegas(&found), &[2.705943757628078708018491, 7.257952078965087355040786]);
    assert_eq!(found["coordinates"], serde_json::json!(["theta1", "theta2"]));
    let keys: Vec<&String> = found.as_object().unwrap().keys().collect();
    assert_eq!(keys, ["format", "model", "equilibrium", "residual", "coordinates", "M", "C", "K", "modes"]);
}

#[test]
fn b03_triple_pendulum() {
    let found = run("triple_pendulum", &[]).unwrap();
    let m = [7.0 / 3.0, 1.5, 0.5, 1.5, 4.0 / 3.0, 0.5, 0.5, 0.5, 1.0 / 3.0];
    close(&matrix(&found["M"]).concat(), &m);
    let expected = [2.202107963826273540272502, 5.477225575051661134569698, 10.34764695178231458306389];
    close(&omegas(&found), &expected);
}

#[test]
fn b10_cart_pendulum_hanging_and_inverted() {
    let hanging = run("cart_pendulum", &[]).unwrap();
    assert_eq!(kinds(&hanging), ["rigid", "oscillating"]);
    assert!(hanging["modes"][0]["zeta"].is_null());
    close(&omegas(&hanging)[1..], &[3.872983346207416885179265]);
    let inverted = run("cart_pendulum", &["--at", "theta=3", "--at", "x=2"]).unwrap();
    assert_eq!(kinds(&inverted), ["unstable", "rigid"]);
    close(&numbers(&inverted["modes"][0]["eigenvalue"]), &[3.872983346207416885179265, 0.0]);
    assert!((inverted["equilibrium"]["theta"].as_f64().unwrap() - std::f64::consts::PI).abs() < 1e-14);
}

#[test]
fn b11_b12_rolling_cylinders() {
    close(&omegas(&run("rolling_cylinder", &[]).unwrap()), &[2.981423969999719595212232]);
    let pipe = run("cylinder_in_pipe", &[]).unwrap();
    assert_eq!(kinds(&pipe), ["rigid", "oscillating"]);
    close(&omegas(&pipe)[1..], &[3.496029493900505156638178]);
}

#[test]
fn b13b_slot_turntable_with_springs() {
    let found = run("slot_turntable_springs", &["--scene", "offset"]).unwrap();
    close(&matrix(&found["M"]).concat(), &[2.25, -0.5, -0.5, 1.0]);
    close(&omegas(&found), &[2.947198925247252496258704, 7.587095524311094357620457]);
}

/// B13: steady turning with the mass at the middle of the slot grows at Ω √(1 + m d²/I).  To slide along the slot
/// at a constant speed is possible, but then the inertia changes, and small motions have no modes.
#[test]
fn b13_steady_turning_of_the_slot_is_unstable() {
    let found = run("slot_turntable_offset", &["--at", "theta'=1.5"]).unwrap();
    assert_eq!(kinds(&found)[0], "unstable");
    close(&numbers(&found["modes"][0]["eigenvalue"]), &[1.5 * 1.125_f64.sqrt(), 0.0]);
    let (status, text) = run("slot_turntable_offset", &["--at", "s'=1.5"]).unwrap_err();
    assert!(status == 1 && text.contains("not a steady motion: `s` has a speed"), "{text}");
}

#[test]
fn b18_three_masses() {
    let root = std::f64::consts::SQRT_2;
    let found = run("three_masses", &[]).unwrap();
    close(&omegas(&found), &[0.76536686473017954345692, root, 1.847759065022573512256366]);
    let shape = |mode: usize| -> Vec<f64> {
        found["modes"][mode]["shape"].as_array().unwrap().iter().map(|x| x[0].as_f64().unwrap()).collect()
    };
    close(&shape(0), &[0.5, root / 2.0, 0.5]);
    close(&shape(1), &[root / 2.0, 0.0, -root / 2.0]);
    close(&shape(2), &[0.5, -root / 2.0, 0.5]);
}

#[cfg(feature = "modal")]
#[test]
fn b18_damped_chain() {
    let eigenvalues = |scene: &str| -> Vec<f64> {
        let found = run("damped_chain", &["--scene", scene]).unwrap();
        assert_eq!(kinds(&found), ["damped"; 3]);
        found["modes"].as_array().unwrap().iter().flat_map(|mode| numbers(&mode["eigenvalue"])).collect()
    };
    let parallel = [
        -0.05857864376269049511983113,
        0.7631218645287453386808003,
        -0.2,
        1.4,
        -0.3414213562373095048801689,
        1.815941909830314821805293,
    ];
    close(&eigenvalues("parallel"), &parallel);
    let one = [
        -0.06306788131221175364097352,
        0.7737776737010220006822875,
        -0.1329489668251750198767196,
        1.406301793304230935731833,
        -0.05398315186261322648230686,
        1.822951053635081430460634,
    ];
    close(&eigenvalues("one_damper"), &one);
}

#[test]
fn b19_spring_structures_by_rank() {
    let cases: [(&str, &[&str], usize, &[f64]); 5] = [
        ("free_chain", &[], 1, &[1.0, 3.0]),
        ("triangle_springs", &[], 3, &[1.5, 1.5, 3.0]),
        ("square_springs", &[], 4, &[2.0, 2.0, 2.0, 2.0]),
        ("square_springs", &["--scene", "braced"], 3, &[2.0, 2.0, 2.0, 2.0, 4.0]),
        ("hexagon_springs", &[], 6, &[1.0, 1.5, 1.5, 2.5, 2.5, 3.0]),
    ];
    for (model, options, rigid, squares) in cases {
        let found = run(model, options).unwrap();
        assert_eq!(kinds(&found).iter().filter(|kind| **kind == "rigid").count(), rigid, "{model}");
        close(&omegas(&found)[rigid..].iter().map(|omega| omega * omega).collect::<Vec<_>>(), squares);
    }
}

#[test]
fn b20_chains_and_strings() {
    let ring = omegas(&run("periodic_chain", &[]).unwrap());
    let mut expected: Vec<f64> = (0..12).map(|j| 2.0 * (std::f64::consts::PI * f64::from(j) / 12.0).sin()).collect();
    expected.sort_by(f64::total_cmp);
    close(&ring, &expected);
    for (n, first) in [
        ("2", [3.0, 5.1961524227066318806]),
        ("10", [3.1309264420122730898, 6.1981162505114533497]),
        ("20", [3.1386639306298186802, 6.259775179399326771]),
    ] {
        close(&omegas(&run("string_masses", &["--size", &format!("n={n}")]).unwrap())[..2], &first);
    }
    close(&omegas(&run("string_rayleigh", &[]).unwrap()), &[3.162277660168379332]);
}

/// B20 and catalogue F3: Ritz's method with the powers of x (L - x), always from above.
#[test]
fn b20_ritz_with_one_to_four_shapes() {
    let first = |n: usize| omegas(&run("string_ritz", &["--size", &format!("n={n}")]).unwrap())[0];
    close(&[first(1), first(2)], &[3.162277660168379332, 3.1416157660218119746]);
    assert!((first(2) - (56.0 - 4.0 * 133.0_f64.sqrt()).sqrt()).abs() < 1e-14);
    let error = |n: usize| first(n) / std::f64::consts::PI - 1.0;
    for (n, expected) in [(1, 6.584e-3), (2, 7.357e-6), (3, 1.717e-9)] {
        assert!((error(n) / expected - 1.0).abs() < 1e-3, "{n}: {:e}", error(n));
    }
    assert!((1e-13..2e-13).contains(&error(4)), "{:e}", error(4));
}

/// Catalogue F3: n beads on a thread are below the string's harmonics, by (pπ/(n + 1))²/24 and less.
#[test]
fn a_string_of_many_beads_tends_to_the_harmonics() {
    for n in [10, 50] {
        let found = omegas(&run("string_masses", &["--size", &format!("n={n}")]).unwrap());
        for (p, omega) in (1..=3).zip(found) {
            let part = f64::from(p) * std::f64::consts::PI;
            let law = (part / f64::from(n + 1)).powi(2) / 24.0;
            let below = 1.0 - omega / part;
            assert!(below < law && below > law * (1.0 - law), "{n} {p}: {below:e} {law:e}");
        }
    }
}

#[test]
fn a_pendulum_aside_is_refused_with_its_residual() {
    let (status, text) = run("simple_pendulum", &["--at", "theta=pi/4", "--here"]).unwrap_err();
    assert_eq!(status, 1);
    assert!(text.contains("no equilibrium") && text.contains("theta: 7.07106781187 N m"), "{text}");
    let found = run("simple_pendulum", &["--at", "theta=pi/4"]).unwrap();
    close(&omegas(&found), &[10.0_f64.sqrt()]);
    let up = run("simple_pendulum", &["--at", "theta=pi", "--here"]).unwrap();
    assert_eq!(kinds(&up), ["unstable"]);
    assert!(matches!(run("simple_pendulum", &["--at", "phi=1"]), Err((2, _))));
}

/// As [`run`], for the text of a model file.
fn run_text(name: &str, text: &str, options: &[&str]) -> Result<Value, (u8, String)> {
    let path = std::env::temp_dir().join(format!("dalembert-{name}-{}.yaml", std::process::id()));
    std::fs::write(&path, text).unwrap();
    let mut arguments = vec!["dalembert", "modes", path.to_str().unwrap(), "--json"];
    arguments.extend(options);
    let mut out = Vec::new();
    let result = dalembert::cli::run(&[], arguments, &mut out);
    std::fs::remove_file(&path).unwrap();
    match result {
        Ok(()) => Ok(serde_json::from_slice(&out).unwrap()),
        Err(problem) => Err((problem.status(), problem.to_string())),
    }
}

/// A block on a spring k = 4 N/m and on a surface that pushes it by `force`.
fn block(force: &str) -> String {
    format!(
        "name: Block\nparameters: {{m: 1 kg, k: 4 N/m, F: 1 N, a: 1 m, T: 1 s, b: 1 N*s^2/m^2}}\ncoordinates: {{x: m}}\n\
         bodies: {{block: {{mass: m, position: \"[x, 0]\"}}}}\n\
         springs: {{s: {{stretch: x, stiffness: k, along: ground.x, on: block}}}}\n\
         forces: {{surface: {{on: block, force: \"{force}\"}}}}\nscene: {{start: {{x: 1}}, until: 1}}\n"
    )
}

/// Dry friction holds a set of equilibria, |x| ≤ F/k: it is said, and nothing is linearised.
#[test]
fn dry_friction_has_no_linear_model() {
    let friction = block("[-F*sign(x'), 0]");
    for (options, point) in [(&[][..], "at x = 0 "), (&["--at", "x=0.2", "--here"], "at x = 0.2 ")] {
        let (status, text) = run_text("friction", &friction, options).unwrap_err();
        assert_eq!(status, 1);
        contains(&text, &[point, "held by dry friction", "sign of `x'`", "up to x: 1 N", "no linear model"]);
    }
    let (_, text) = run_text("beyond", &friction, &["--at", "x=0.3", "--here"]).unwrap_err();
    contains(&text, &["no equilibrium: the residual force is x: 1.2 N"]);
    // Along the direction of the velocity there is no switch, and the jump is found all the same.
    let (_, text) = run_text("unit", &block("-F*unit(velocity(block))"), &[]).unwrap_err();
    contains(&text, &["held by dry friction", "up to x: 1 N"]);
    // A block that only friction holds on a slope rests anywhere.
    let slope = "name: Slope\nparameters: {m: 1 kg, mu: 0.8 1, g: 10 m/s^2, a: 30 deg}\ncoordinates: {s: m}\n\
                 bodies: {block: {mass: m, position: \"[s*cos(a), s*sin(a)]\"}}\ngravity: [0, -g]\n\
                 forces: {friction: {on: block, force: \"-mu*m*g*cos(a)*sign(s')*[cos(a), sin(a)]\"}}\n";
    let (_, text) = run_text("slope", slope, &["--at", "s=2"]).unwrap_err();
    contains(&text, &["at s = 2 the system is held by dry friction", "up to s: 6.92820323"]);
    let (_, text) = run_text("slide", slope, &["--set", "mu=0.5"]).unwrap_err();
    contains(&text, &["no equilibrium found", "s: 5 N"]);
}

/// Switches are on the side where the equilibrium lies; quadratic drag vanishes at rest; a contact that just touches
/// has two stiffnesses.
#[test]
fn other_discontinuities_are_linearised_on_their_side_or_refused() {
    // 4 x + 4 (x − 1) = 8 has x = 1.5 on the second spring, and K = 8.
    let contact = block("[-k*max(0, x - a) + 8*F, 0]");
    let found = run_text("contact", &contact, &[]).unwrap();
    close(&[found["equilibrium"]["x"].as_f64().unwrap()], &[1.5]);
    close(&omegas(&found), &[8.0_f64.sqrt()]);
    let found = run_text("apart", &contact.replace("8*F", "F"), &[]).unwrap();
    close(&[found["equilibrium"]["x"].as_f64().unwrap(), omegas(&found)[0]], &[0.25, 2.0]);
    let found = run_text("drag", &block("[-b*x'*abs(x'), 0]"), &[]).unwrap();
    assert_eq!((kinds(&found), matrix(&found["C"])), (vec!["oscillating"], vec![vec![0.0]]));
    let (status, text) = run_text("touching", &block("[-k*max(0, x), 0]"), &[]).unwrap_err();
    assert!(status == 1 && text.contains("changes sign and with it the stiffness"), "{text}");
    let (_, text) = run_text("later", &block("[F*step(t - T), 0]"), &[]).unwrap_err();
    assert!(text.contains("depends on time"), "{text}");
}

/// Inputs are 0 (not what they are at t = 0, here 0.2 m), unless they are held at a value.
#[cfg(feature = "modal")]
#[test]
fn inputs_are_zero_or_held() {
    let at = |options: &[&str]| run("vibration_isolation", options).unwrap()["equilibrium"]["x"].as_f64().unwrap();
    close(&[at(&[]), at(&["--input", "y=0.1"])], &[0.0, 0.1]);
}

#[test]
fn people_get_a_table() {
    let path = format!("{}/../models/double_pendulum_points.yaml", env!("CARGO_MANIFEST_DIR"));
    let mut out = Vec::new();
    dalembert::cli::run(&[], ["dalembert", "modes", &path], &mut out).unwrap();
    let text = String::from_utf8(out).unwrap();
    for part in
        ["equilibrium at theta1 = 0 rad, theta2 = 0 rad", "K =", "1: oscillating, omega = 2.420", "participation: "]
    {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
}

/// The table for a file's text.
fn table(name: &str, text: &str, options: &[&str]) -> String {
    let path = std::env::temp_dir().join(format!("dalembert-table-{}-{name}.yaml", std::process::id()));
    std::fs::write(&path, text).unwrap();
    let mut arguments = vec!["dalembert", "modes", path.to_str().unwrap()];
    arguments.extend(options);
    let mut out = Vec::new();
    let found = dalembert::cli::run(&[], arguments, &mut out);
    std::fs::remove_file(&path).unwrap();
    found.map_err(|problem| panic!("{problem}")).unwrap();
    String::from_utf8(out).unwrap()
}

/// A stiffness of 1e-3 N/m stands beside one of 1e12, an angle beside a place of 7e12 m, and a place of 1e-9 m beside an angle
/// in the shape; what is rounding in its own row is 0.
#[test]
fn what_is_small_beside_other_units_is_printed() {
    let of = |k: &str, y0: &str, e: &str| {
        format!(
            "name: A\nparameters: {{k1: 1e12 N/m, k2: {k}, y0: {y0}, c: 3 N*m, e: {e}, I: 1e-20 kg*m^2, m: 2 kg, a0: 0.3 rad}}\n\
             coordinates: {{x: m, y: m, a: rad}}\nkinetic_energy: (m*(x'^2 + y'^2) + I*a'^2)/2\n\
             potential_energy: (k1*x^2 + k2*(y - y0)^2 + c*(a - a0)^2)/2 + e*(y - y0)*(a - a0)\n"
        )
    };
    let text = table("units", &of("1e-3 N/m", "7e12 m", "0 N"), &[]);
    contains(&text, &["x = 0 m, y = 7e12 m, a = 0.3 rad", "  1e12      0  0\n     0  0.001  0\n     0      0  3\n"]);
    // y goes with a by e/(m ω²) = 10/6e20, which is more than rounding of its own part of the energy; by less it is 0.
    let text = table("shape", &of("1e3 N/m", "0 m", "10 N"), &[]);
    contains(&text, &["x 0, y 1.66667e-10, a 1e10"]);
    let text = table("rounding", &of("1e3 N/m", "0 m", "1e-3 N"), &[]);
    contains(&text, &["x 0, y 0, a 1e10"]);
}

/// A hertz is a cycle a second where a frequency is wanted: m x'' + k x with k/m = 1 at 1 Hz, 1/(k − m 4π²).
#[test]
fn hertz_are_cycles() {
    let size = |omega: &str| {
        let found = run("vibration_isolation", &["--drive", "x", "--omega", omega]).unwrap();
        let pair = numbers(&found["steady"]["amplitude"]["x"]);
        (found["steady"]["omega"].as_f64().unwrap(), pair[0].hypot(pair[1]))
    };
    let tau = std::f64::consts::TAU;
    assert_eq!((size("1 Hz"), size("60 rpm").0, size("2 rad/s").0), (size("2*pi"), tau, 2.0));
    let found = run("vibration_isolation", &["--drive", "x", "--range", "1 Hz..2 Hz"]).unwrap();
    let omegas = numbers(&found["response"]["omega"]);
    close(&[omegas[0], *omegas.last().unwrap()], &[tau, 2.0 * tau]);
}

/// Two bodies on a rod that float: translations and a rotation, named as without constraints, and what the rod carries has
/// its unit; at other scales too.
#[test]
fn free_motions_with_constraints_are_named() {
    for (m, l) in [(2.0, 0.5), (2e-12, 5e-13), (2e12, 5e12)] {
        let text = format!(
            "name: A\nparameters: {{m: {m:e} kg, l: {l:e} m, k: 3 N/m}}\ncoordinates: {{x1: m, y1: m, x2: m, y2: m, z: m}}\n\
             bodies: {{a: {{mass: m, position: \"[x1, y1]\"}}, b: {{mass: m, position: \"[x2, y2]\"}}}}\n\
             kinetic_energy: m*z'^2/2\npotential_energy: k*z^2/2\nconstraints: {{rod: (x1 - x2)^2 + (y1 - y2)^2 - l^2}}\n\
             scene: {{start: {{x1: 0, y1: 0, x2: l}}, until: 1}}\n"
        );
        let found = table("floating", &text, &[]);
        contains(
            &found,
            &[
                "1: rigid, no stiffness: translation along x",
                "2: rigid, no stiffness: translation along y",
                "3: rigid, no stiffness: rotation about the centre of mass",
                "4: oscillating",
                "bodies: a 50 %, b 50 %",
                "in x1, y1, y2, z, which the constraints leave independent",
                "reaction(rod) at rest = 0 N/m",
            ],
        );
        let driven = table("driven", &text, &["--drive", "z", "--range", "1e-3..2e-3", "--response", "z,x1"]);
        contains(&driven, &["  z: ", "  x1: 0 at all frequencies\n"]);
    }
}

/// What the program writes for people.
fn text(model: &str, options: &[&str]) -> String {
    let path = format!("{}/../models/{model}.yaml", env!("CARGO_MANIFEST_DIR"));
    let mut arguments = vec!["dalembert", "modes", &path];
    arguments.extend(options);
    let mut out = Vec::new();
    dalembert::cli::run(&[], arguments, &mut out).unwrap();
    String::from_utf8(out).unwrap()
}

fn contains(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part:?} is not in\n{text}");
    }
}

/// Problem 34: integration and the matrix exponential agree; damping taken as diagonal and as αM + βK errs as told.
#[cfg(feature = "modal")]
#[test]
fn problem_34_three_methods_are_compared() {
    let svg = std::env::temp_dir().join(format!("dalembert-motion-{}.svg", std::process::id()));
    let path = svg.to_str().unwrap();
    for (scene, diagonal, proportional) in
        [("scene", 0.027, 0.027), ("second_mode", 0.14, 0.26), ("third_mode", 0.11, 0.11)]
    {
        let found = run("damped_chain", &["--scene", scene, "--motion", path]).unwrap();
        let of = |name: &str| found["motion"]["differences"][name].as_f64().unwrap();
        assert!(of("the full equations, integrated") < 1e-10);
        assert!((of("damping treated as diagonal") / diagonal - 1.0).abs() < 0.05, "{found}");
        assert!((of("C = alpha M + beta K") / proportional - 1.0).abs() < 0.05, "{found}");
        // ζ = α/(2ω) + βω/2 holds at the slowest and at the fastest mode.
        let [alpha, beta] = ["alpha", "beta"].map(|name| found["damping"][name].as_f64().unwrap());
        for mode in [0, 2] {
            let [omega, zeta] = ["omega", "zeta"].map(|name| found["modes"][mode][name].as_f64().unwrap());
            assert!((alpha / (2.0 * omega) + beta * omega / 2.0 - zeta).abs() < 1e-15);
        }
    }
    contains(&std::fs::read_to_string(&svg).unwrap(), &["exp(A t)", "x[1] (m)", "C = alpha M + beta K"]);
    contains(&text("damped_chain", &[]), &["damping treated mode by mode", "by about 3.5 %: use the complex modes"]);
    contains(&text("forced_chain", &[]), &["the undamped modes stay modes"]);
    let (status, words) = run("forced_chain", &["--motion", path]).unwrap_err();
    assert!(status == 2 && words.contains("starts at rest in the equilibrium"), "{words}");
    // Problem 24: the nonlinear pendulum of points in its slow mode departs from the linear motion by a hundredth.
    let found = run("double_pendulum_points", &["--motion", path]).unwrap();
    let departure = found["motion"]["differences"]["the full equations, integrated"].as_f64().unwrap();
    assert!((0.005..0.02).contains(&departure), "{departure}");
    std::fs::remove_file(svg).unwrap();
}

/// Each mode is labelled with the bodies that carry its energy: cart and bob, 2 kg and 1 kg.
#[test]
fn bodies_carry_modes() {
    let written = text("cart_pendulum", &[]);
    contains(&written, &["1: rigid, no stiffness", "bodies: cart 67 %, bob 33 %", "bodies: bob 67 %, cart 33 %"]);
}

/// Problem 37's main question, answered by the program: in the mode (1, 0, -1) the middle mass rests, and it moves in
/// the other two; that is the only force on the last mass, which alone would be in resonance.
#[cfg(feature = "modal")]
#[test]
fn problem_37_main_question() {
    let written = text("forced_chain", &["--omega", "w"]);
    contains(
        &written,
        &[
            "x[2]  0.477072 m",
            "x[3]: driven by x[2] 0.4818; stiffness 0.2828 (at rest 2): alone it would be near resonance here",
            "x[2] rests in mode 2, the largest, and yet moves by 0.477072 m, in mode(s) 1, 3: it alone drives x[3]",
        ],
    );
    let undamped = text("forced_chain", &["--scene", "resonance", "--omega", "w"]);
    let growth = "every second the amplitude grows: x[1] by 0.176777 m, x[3] by 0.176777 m";
    contains(&undamped, &[growth, "x[2]      0.5 m", "x[2] rests in mode 2"]);
    let found = run("forced_chain", &["--omega", "w"]).unwrap();
    let parts = found["steady"]["modes"].as_array().unwrap();
    assert!(parts[1]["amplitude"]["x[2]"][0].as_f64().unwrap().abs() < 1e-14);
}

/// The table of the steady state has the outputs that are asked for, as sums of the coordinates' own amplitudes.
#[cfg(feature = "modal")]
#[test]
fn outputs_stand_in_the_steady_state() {
    let options = ["--omega", "w", "--response", "x[1],mode_2,x[3]'"];
    let found = run("forced_chain", &options).unwrap();
    let pair = |value: &Value| numbers(value)[..2].try_into().unwrap();
    let [one, three]: [[f64; 2]; 2] = ["x[1]", "x[3]"].map(|name| pair(&found["steady"]["amplitude"][name]));
    let [half, rate]: [[f64; 2]; 2] = ["mode_2", "x[3]'"].map(|name| pair(&found["steady"]["answers"][name]));
    let omega = found["steady"]["omega"].as_f64().unwrap();
    close(&half, &[0.5 * (one[0] - three[0]), 0.5 * (one[1] - three[1])]);
    close(&rate, &[-omega * three[1], omega * three[0]]);
    assert!(found["steady"]["answers"]["x[1]"].is_null());
    contains(&text("forced_chain", &options), &["  mode_2: ", "  x[3]': ", " m/s, "]);
    let undamped = text("forced_chain", &["--scene", "resonance", "--omega", "w", "--response", "mode_2"]);
    contains(&undamped, &["  mode_2: without bound"]);
}

/// B21 from the command line: transmissibilities, and the four excitations of problem 21 a as drives.
#[cfg(feature = "modal")]
#[test]
fn b21_transmissibility_and_the_four_excitations() {
    let amplitude = |model: &str, options: &[&str]| -> [f64; 2] {
        let found = run(model, options).unwrap();
        let pair = numbers(&found["steady"]["amplitude"]["x"]);
        [pair[0].hypot(pair[1]), pair[1].atan2(pair[0])]
    };
    let path = format!("{}/../tests/reference/B21-vibration-isolation.json", env!("CARGO_MANIFEST_DIR"));
    let reference: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let table = reference["scalars"]["table"].as_array().unwrap();
    assert!(table.len() > 10);
    for row in table {
        let [zeta, r, size, phase] = ["zeta", "r", "T", "phase_rad"].map(|key| row[key].as_str().unwrap());
        let c = format!("c=2*{zeta}");
        let [found, angle] = amplitude("vibration_isolation", &["--set", &c, "--drive", "y", "--omega", r]);
        let [size, phase] = [size, phase].map(|text| text.parse::<f64>().unwrap());
        assert!((found - size).abs() < 1e-12 * size, "{zeta} {r}: {found}");
        // Half a turn forwards or backwards is the same.
        assert!((angle.abs() - phase.abs()).abs() < 1e-12, "{zeta} {r}: {angle}");
    }
    // m = c = k = 1 at twice the natural frequency: |1, 2i, 1, 1 + 2i| over |-3 + 2i|.
    let below = 13.0_f64.sqrt();
    let cases: [(&[&str], f64); 4] = [(&["force"], 1.0), (&["D"], 2.0), (&["C"], 1.0), (&["C", "D"], 5.0_f64.sqrt())];
    for (names, above) in cases {
        let mut options = vec!["--omega", "2"];
        names.iter().for_each(|name| options.extend(["--drive", name]));
        let [found, _] = amplitude("base_excitation", &options);
        assert!((found - above / below).abs() < 1e-14, "{names:?}: {found}");
    }
}

#[cfg(feature = "modal")]
#[test]
fn responses_and_loci_are_drawn_and_told() {
    let folder = std::env::temp_dir().join(format!("dalembert-responses-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (bode, locus) = (file("bode.svg"), file("locus.svg"));
    let found = run("damped_chain", &["--drive", "x[1]", "--bode", &bode, "--range", "0.5..3"]).unwrap();
    assert_eq!(found["response"]["drive"], "a force on x[1]");
    let (omegas, answers) = (numbers(&found["response"]["omega"]), found["response"]["amplitude"]["x[3]"].clone());
    assert_eq!((omegas[0], *omegas.last().unwrap(), omegas.len()), (0.5, 3.0, answers.as_array().unwrap().len()));
    let drawn = std::fs::read_to_string(&bode).unwrap();
    contains(&drawn, &["<svg", "amplitude (m/N)", "phase (degrees)", "frequency (rad/s)", "x[3]"]);

    // x'' + c x' + x = 0 is critical at c = 2; a negative c makes it grow.
    let found = run("vibration_isolation", &["--vary", "c=-1..3", "--locus", &locus]).unwrap();
    let limits = found["locus"]["limits"].as_array().unwrap();
    assert!(limits.len() == 1 && limits[0]["value"].as_f64().unwrap().abs() < 1e-9, "{limits:?}");
    assert_eq!(limits[0]["stable_above"], true);
    for step in found["locus"]["steps"].as_array().unwrap() {
        let c = step["value"].as_f64().unwrap();
        for pair in step["eigenvalues"].as_array().unwrap() {
            let (re, im) = (pair[0].as_f64().unwrap(), pair[1].as_f64().unwrap());
            let left = [re * re - im * im + c * re + 1.0, 2.0 * re * im + c * im];
            assert!(left[0].hypot(left[1]) < 1e-12 * (1.0 + re * re), "{c} {re} {im}");
        }
    }
    contains(&std::fs::read_to_string(&locus).unwrap(), &["real part (1/s)", "c = -1 N*s/m", "c = 3 N*s/m"]);
    let told = text("vibration_isolation", &["--vary", "c=-1..3"]);
    contains(&told, &["c = 0 N*s/m: growth ends", "c = 3 N*s/m: nothing grows; -2.61803, -0.381966"]);
    std::fs::remove_dir_all(folder).unwrap();
}

#[cfg(feature = "modal")]
#[test]
fn bad_drives_and_ranges_are_refused() {
    let cases: [(&str, &[&str], &str); 9] = [
        ("three_masses", &["--omega", "1"], "has no inputs; name a coordinate that a force acts on: --drive x[1]"),
        ("forced_chain", &["--drive", "push3", "--omega", "1"], "did you mean `push1`?"),
        ("forced_chain", &["--drive", "push1"], "--drive wants --omega, --bode or --range"),
        ("forced_chain", &["--omega", "-1"], "a frequency is 0 or more"),
        ("forced_chain", &["--drive", "push1", "--range", "0..3"], "frequencies go from more than 0 upwards"),
        ("forced_chain", &["--drive", "push1", "--range", "3"], "--range wants a range A..B"),
        ("forced_chain", &["--vary", "mm=1..2"], "did you mean `m`?"),
        ("forced_chain", &["--vary", "m=1..1"], "has no width"),
        ("forced_chain", &["--locus", "x.svg"], "--locus wants --vary"),
    ];
    for (model, options, part) in cases {
        let (status, text) = run(model, options).unwrap_err();
        assert!(status == 2 && text.contains(part), "{options:?}: {status} {text}");
    }
    let (status, text) = run("forced_chain", &["--omega", "1e308"]).unwrap_err();
    assert!(status == 1 && text.contains("the dynamic stiffness at 1e308 rad/s is not finite"), "{text}");
    // A floor that moves up and down does not push a pendulum that hangs straight.
    let (status, text) = run("shaken_pendulum", &["--omega", "1"]).unwrap_err();
    assert!(status == 1 && text.contains("does not act on small motions here"), "{text}");
    let (status, text) = run("free_chain", &["--drive", "x[1]", "--omega", "0"]).unwrap_err();
    assert!(status == 1 && text.contains("no steady state"), "{text}");
}

#[test]
fn modes_are_drawn_and_animated() {
    let folder = std::env::temp_dir().join(format!("dalembert-modes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (svg, html) = (file("modes.svg"), file("mode.html"));
    run("three_masses", &["--plot", &svg, "--animate", &html, "--mode", "2"]).unwrap();
    let drawn = std::fs::read_to_string(&svg).unwrap();
    assert!(drawn.starts_with("<svg") && drawn.matches("mode ").count() == 3 && drawn.contains("at rest"));
    assert!(std::fs::read_to_string(&html).unwrap().contains("omega = 1.414"));
    let (status, text) = run("three_masses", &["--mode", "4"]).unwrap_err();
    assert!(status == 2 && text.contains("modes 1 to 3"), "{text}");
    std::fs::remove_dir_all(folder).unwrap();
}
