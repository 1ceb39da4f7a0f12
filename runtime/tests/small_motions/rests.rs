//! Small motions about rest that are easily misjudged.

use serde_json::Value;

use super::{close, limits, run, try_run, words};

fn library(model: &str) -> String {
    std::fs::read_to_string(format!("{}/../models/{model}.yaml", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn omegas(found: &Value) -> Vec<f64> {
    found["modes"].as_array().unwrap().iter().map(|mode| mode["omega"].as_f64().unwrap()).collect()
}

fn kinds(found: &Value) -> Vec<&str> {
    found["modes"].as_array().unwrap().iter().map(|mode| mode["kind"].as_str().unwrap()).collect()
}

fn names(found: &Value) -> Vec<&str> {
    found["modes"].as_array().unwrap().iter().filter_map(|mode| mode["name"].as_str()).collect()
}

fn contains(text: &str, parts: &[&str]) {
    parts.iter().for_each(|part| assert!(text.contains(part), "{part:?} is not in\n{text}"));
}

const SOFT_BESIDE_STIFF: &str = "name: Eq\nparameters: {k1: 1e12 N/m, k2: 1e-3 N/m, F: 0.05 N, m: 1 kg}\n\
    coordinates: {x: m, y: m}\nkinetic_energy: m*(x'^2 + y'^2)/2\npotential_energy: k1*x^2/2 + k2*y^2/2\n\
    generalized_forces: {y: F}\n";

/// A force of 0.05 N on a spring of 1e-3 N/m beside one of 1e12 N/m; without the soft spring it is not balanced, and
/// without the force too the direction is free.
#[test]
fn a_small_force_beside_a_stiff_spring_is_not_forgiven() {
    let found = run(SOFT_BESIDE_STIFF, &[]);
    close(found["equilibrium"]["y"].as_f64().unwrap(), 50.0, 1e-14);
    assert_eq!(kinds(&found), ["oscillating"; 2]);
    close(omegas(&found)[0], 1e-3_f64.sqrt(), 1e-14);
    let refused = try_run(SOFT_BESIDE_STIFF, &["--set", "k2=0"]).unwrap_err();
    contains(&refused, &["no equilibrium found", "y: -0.05 N"]);
    let free = run(SOFT_BESIDE_STIFF, &["--set", "k2=0", "--set", "F=0"]);
    assert_eq!(kinds(&free), ["rigid", "oscillating"]);
    let here = try_run(SOFT_BESIDE_STIFF, &["--at", "y=49", "--here"]).unwrap_err();
    contains(&here, &["no equilibrium: the residual force is", "y: -0.001 N"]);
}

fn pull_in(factor: f64) -> String {
    // Pull-in at 4 k d³/27.
    format!(
        "name: PullIn\nparameters: {{m: 1e-15 kg, k: 1 N/m, d: 1e-9 m, a: {:e} J*m}}\ncoordinates: {{x: m}}\n\
         bodies: {{tip: {{mass: m, position: \"[x, 0]\"}}}}\n\
         springs: {{s: {{stretch: x, stiffness: k, along: \"[1, 0]\", on: tip}}}}\npotential_energy: -a/(d - x)\n\
         sample: {{x: [-0.5*d, 0.5*d]}}\nequilibrium: {{x: 0}}\nscene: {{start: {{x: 0}}, until: 1e-6}}\n",
        factor * 4e-27 / 27.0
    )
}

/// Beyond pull-in nothing balances at a nanometre gap, a hair below it something does.
#[test]
fn an_equilibrium_that_does_not_exist_is_refused() {
    for factor in [1.1, 1.001, 1.000_001] {
        let refused = try_run(&pull_in(factor), &[]).unwrap_err();
        contains(&refused, &["no equilibrium"]);
    }
    for factor in [0.9, 0.999, 0.999_999] {
        let found = run(&pull_in(factor), &[]);
        let x = found["equilibrium"]["x"].as_f64().unwrap() / 1e-9;
        close(x * (1.0 - x) * (1.0 - x), factor * 4.0 / 27.0, 1e-12);
        assert!(x < 1.0 / 3.0);
    }
    // Followed from below, the branch folds back at pull-in.
    let found = run(&pull_in(0.5), &["--vary", "a=2e-29..2e-28"]);
    let limits = limits(&found);
    assert!(limits.len() == 1 && limits[0].1 == "fold", "{limits:?}");
    close(limits[0].0, 4e-27 / 27.0, 1e-8);
}

/// Numbers in SI have units in SI, whatever prefixes the file has.
#[test]
fn units_belong_to_their_numbers() {
    let mm = "name: Mm\nparameters: {m: 2 kg, k: 300 N/mm, phi0: 30 deg}\ncoordinates: {x: m}\n\
              bodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
              springs: {s: {between: [ground_, b], stiffness: k, rest: 0}}\npoints: {ground_: [0, 0]}\n";
    let shaken = words(mm, &["--drive", "x", "--omega", "100"]).unwrap();
    // 1 N on 3e5 - 2e4 N/m.
    contains(&shaken, &["3.57143e-6 m", "15.9155 Hz"]);
    assert!(!shaken.contains(" mm"), "{shaken}");
    let varied = words(mm, &["--vary", "k=100 N/mm..400 N/mm"]).unwrap();
    contains(&varied, &["k = 100000 N/m", "k = 400000 N/m"]);
    let grams = "name: U\nparameters: {m: 200 g, k: 200 N/m}\ncoordinates: {x: m}\nkinetic_energy: m*x'^2/2\n\
                 potential_energy: k*x^2/2\n";
    contains(&words(grams, &["--vary", "m=100 g..1 kg"]).unwrap(), &["m = 0.1 kg", "m = 1 kg"]);
    // Units without prefixes stay as they are written.
    let plain = words(&grams.replace("mm", "m"), &["--drive", "x", "--omega", "1"]).unwrap();
    contains(&plain, &["amplitude", " m "]);
}

const HOOP: &str = "name: Hoop\nparameters: {m: 1 kg, R: 1 m, g: 9.81 m/s^2, W: 1 rad/s}\ncoordinates: {theta: rad}\n\
    points: {p: \"R*[sin(theta)*cos(W*t), sin(theta)*sin(W*t), -cos(theta)]\"}\n\
    bodies: {bead: {mass: m, position: p}}\ngravity: [0, 0, -g]\nscene: {start: {theta: 0.1}, until: 10}\n";

/// The branch aside ends where it meets the bottom, and that is said; the bottom itself is followed through.
#[test]
fn a_branch_that_ends_is_left_aloud() {
    let critical = 9.81_f64.sqrt();
    let found = run(HOOP, &["--set", "W=6", "--at", "theta=1", "--vary", "W=1..6"]);
    let (value, kind) = limits(&found)[0];
    assert_eq!(kind, "bifurcation");
    close(value, critical, 1e-8);
    let changes = found["locus"]["changes"].as_array().unwrap();
    assert_eq!(changes.len(), 1);
    for step in found["locus"]["steps"].as_array().unwrap() {
        let [w, theta] = [&step["value"], &step["equilibrium"]["theta"]].map(|x| x.as_f64().unwrap());
        let expected = if w > critical { (9.81 / (w * w)).acos() } else { 0.0 };
        assert!((theta.abs() - expected).abs() < 1e-6, "{w} {theta} {expected}");
    }
    let bottom = run(HOOP, &["--vary", "W=1..6"]);
    assert!(bottom["locus"]["changes"].as_array().unwrap().is_empty());
    let (value, kind) = limits(&bottom)[0];
    assert!(kind == "divergence" && limits(&bottom).len() == 1);
    close(value, critical, 1e-8);
}

/// Time that cancels is no obstacle; a pulse far away, a stiffness that swings where it pushes nothing, and a step are.
#[test]
fn what_depends_on_time_is_not_taken_for_constant() {
    assert!(try_run(HOOP, &[]).is_ok());
    let block = |force: &str| {
        format!(
            "name: Block\nparameters: {{m: 1 kg, k: 4 N/m, F: 1 N, T: 1 s, kappa: 1 N/m}}\ncoordinates: {{x: m}}\n\
             kinetic_energy: m*x'^2/2\npotential_energy: k*x^2/2\ngeneralized_forces: {{x: \"{force}\"}}\n"
        )
    };
    let timed = ["F*exp(-((t - 700*T)/T)^2)", "-kappa*x*cos(t/T)", "F*step(t - 100*T)", "F*tanh((t - 1e4*T)/T)"];
    for force in timed {
        contains(&try_run(&block(force), &[]).unwrap_err(), &["depends on time"]);
    }
    // Parameters may take time out of the equations.
    assert!(try_run(&block("F*exp(-((t - 700*T)/T)^2)"), &["--set", "F=0"]).is_ok());
    assert!(try_run(&block("F"), &[]).is_ok());
}

/// Two frequencies pass each other with a force that couples them: a window of flutter 0.004 wide in a range of 1.5.
#[test]
fn narrow_windows_of_flutter_are_found() {
    let text = "name: Flut\nparameters: {s: 1, e: 1e-3}\ncoordinates: {x: 1, y: 1}\nkinetic_energy: (x'^2+y'^2)/2\n\
                potential_energy: (x^2+s*y^2)/2\ngeneralized_forces: {x: -e*y, y: e*x}\nequilibrium: {x: 0, y: 0}\n";
    let found = run(text, &["--vary", "s=0.5..2.01"]);
    let limits = limits(&found);
    assert!(limits.len() == 2 && limits.iter().all(|limit| limit.1 == "flutter"), "{limits:?}");
    close(limits[0].0, 0.998, 1e-8);
    close(limits[1].0, 1.002, 1e-8);
    let apart = run(text, &["--set", "e=0", "--vary", "s=0.5..2.01"]);
    assert!(apart["locus"]["limits"].as_array().unwrap().is_empty());
}

/// Two equal frequencies with one shape: x grows like t, which is said; with two shapes it does not.
#[test]
fn secular_pairs_are_named_and_counted() {
    let text = |force: &str| {
        format!(
            "name: D\nparameters: {{m: 1}}\ncoordinates: {{x: 1, y: 1}}\nkinetic_energy: m*(x'^2+y'^2)/2\n\
             potential_energy: (x^2+y^2)/2\ngeneralized_forces: {{x: {force}}}\n"
        )
    };
    let found = run(&text("y"), &[]);
    assert_eq!(found["modes"].as_array().unwrap().iter().filter(|mode| mode["secular"] == true).count(), 2);
    assert_eq!(kinds(&found), ["oscillating"; 2]);
    omegas(&found).iter().for_each(|omega| close(*omega, 1.0, 1e-14));
    contains(&words(&text("y"), &[]).unwrap(), &["secular: with a factor A + B t"]);
    let plain = run(&text("0*y"), &[]);
    assert!(plain["modes"].as_array().unwrap().iter().all(|mode| mode["secular"].is_null()));
}

/// What no damper feels is undamped; what one feels a little is damped a little.
#[test]
fn an_undamped_mode_is_undamped() {
    let text = |extra: &str| {
        format!(
            "name: Z\nparameters: {{m: 1, k: 4, c: 0.1, e: 1e-20}}\ncoordinates: {{x: 1, y: 1, z: 1}}\n\
             kinetic_energy: m*(x'^2 + y'^2 + z'^2)/2\n\
             potential_energy: k*(3*x^2 + 2.3*y^2 + 2.1*z^2 - 2*y*z)/2\ndissipation: c*x'^2/2{extra}\n"
        )
    };
    let found = run(&text(""), &[]);
    assert_eq!(kinds(&found), ["oscillating", "damped", "oscillating"]);
    let felt = run(&text(" + e*(y'^2 + z'^2)/2"), &[]);
    assert_eq!(kinds(&felt), ["damped"; 3]);
    let mode = &felt["modes"][0];
    // ζ = e/(2 m ω), far below what rounding leaves of λ.
    close(mode["zeta"].as_f64().unwrap(), 1e-20 / (2.0 * mode["omega"].as_f64().unwrap()), 1e-9);
}

/// Rigid motions and mechanisms each have their own basis and name.
#[test]
fn rigid_motions_are_told_from_mechanisms() {
    let found = run(&library("hexagon_springs"), &[]);
    let expected = [
        "translation along x",
        "translation along y",
        "rotation about the centre of mass",
        "mechanism 1",
        "mechanism 2",
        "mechanism 3",
    ];
    assert_eq!(names(&found), expected);
    let shape = |k: usize| -> Vec<f64> {
        found["modes"][k]["shape"].as_array().unwrap().iter().map(|x| x[0].as_f64().unwrap()).collect()
    };
    // Masses of 1 kg: shapes are orthonormal; all x alike in a translation along x.
    for a in 0..6 {
        for b in 0..=a {
            let product: f64 = shape(a).iter().zip(shape(b)).map(|(x, y)| x * y).sum();
            assert!((product - f64::from(u8::from(a == b))).abs() < 1e-12, "{a} {b}: {product}");
        }
    }
    let along = shape(0);
    assert!(along[..6].iter().all(|x| (x - 1.0 / 6.0_f64.sqrt()).abs() < 1e-12));
    assert!(along[6..].iter().all(|y| y.abs() < 1e-12));
    assert_eq!(names(&run(&library("free_chain"), &[])), ["translation along x"]);
    assert_eq!(names(&run(&library("cart_pendulum"), &[])), ["translation along x"]);
    let square = run(&library("square_springs"), &[]);
    assert_eq!(names(&square)[3..], ["mechanism 1"]);
}

/// The governor, two bodies on a circle, and a bead on a hoop that turns freely: steady motions with the scene's rates.
#[test]
fn steady_motions_are_found_and_have_modes() {
    let governor = "name: Governor\nparameters: {m: 1 kg, l: 1 m, J: 0.5 kg*m^2, g: 9.81 m/s^2, W: 5 rad/s}\n\
        coordinates: {theta: rad, phi: rad}\n\
        kinetic_energy: m*l^2*(theta'^2 + sin(theta)^2*phi'^2)/2 + J*phi'^2/2\n\
        potential_energy: -m*g*l*cos(theta)\nscene: {start: {theta: 1, phi': W}, until: 1}\n";
    let found = run(governor, &["--steady"]);
    let (w, cosine) = (5.0_f64, 9.81_f64 / 25.0);
    close(found["equilibrium"]["theta"].as_f64().unwrap(), cosine.acos(), 1e-12);
    assert_eq!(kinds(&found), ["rigid", "oscillating"]);
    // ω² = W² sin²θ + (2 W sinθ cosθ)²/(J/(m l²) + sin²θ): by hand, from the reduced equation.
    let sine2 = 1.0 - cosine * cosine;
    close(omegas(&found)[1].powi(2), w * w * sine2 + 4.0 * w * w * sine2 * cosine * cosine / (0.5 + sine2), 1e-12);
    // Two bodies: r'' = r φ'² − G M/r²; radial oscillations at the orbit's own rate.
    let orbit = "name: Orbit\nparameters: {mu: 2 kg, K: 8 N*m^2, W: 2 rad/s}\ncoordinates: {r: m, phi: rad}\n\
        kinetic_energy: mu*(r'^2 + r^2*phi'^2)/2\npotential_energy: -K/r\nsample: {r: [0.5, 2]}\n\
        scene: {start: {r: 1.1, phi': W}, until: 1}\n";
    let found = run(orbit, &["--steady"]);
    close(found["equilibrium"]["r"].as_f64().unwrap(), 1.0, 1e-12);
    close(omegas(&found)[1], 2.0, 1e-12);
    // The bottom of a hoop that turns at W, with the speed given by hand: stable for g > W² l.
    let bottom = |g: &str| run(governor, &["--at", "phi'=5", "--at", "theta=0", "--set", g]);
    assert_eq!(kinds(&bottom("g=26")), ["rigid", "oscillating"]);
    assert_eq!(kinds(&bottom("g=24"))[0], "unstable");
    let varied = run(governor, &["--at", "phi'=5", "--at", "theta=0", "--vary", "g=20..30"]);
    let limits = limits(&varied);
    assert!(limits.len() == 1, "{limits:?}");
    close(limits[0].0, 25.0, 1e-8);
    let refused = words(SOFT_BESIDE_STIFF, &["--steady"]).unwrap_err();
    contains(&refused, &["has no coordinate on whose value nothing depends"]);
}

/// Shapes stand in a grid under titles that fit; springs have coils, and what lies along x is drawn one above the other.
#[test]
fn shapes_are_drawn_so_that_they_are_seen() {
    let path = std::env::temp_dir().join(format!("dalembert-shapes-{}.svg", std::process::id()));
    let file = path.to_string_lossy().into_owned();
    let picture = |model: &str| {
        words(&library(model), &["--plot", &file]).unwrap();
        std::fs::read_to_string(&path).unwrap()
    };
    let chain = picture("forced_chain");
    let document = roxmltree::Document::parse(&chain).unwrap();
    let number = |node: &roxmltree::Node<'_, '_>, name: &str| node.attribute(name).unwrap().parse::<f64>().unwrap();
    let width =
        document.root_element().attribute("viewBox").unwrap().split(' ').nth(2).unwrap().parse::<f64>().unwrap();
    for title in document
        .descendants()
        .filter(|node| node.has_tag_name("text"))
        .filter(|node| node.text().is_some_and(|text| text.trim().starts_with("mode ")))
    {
        let half = 0.5 * 0.6 * number(&title, "font-size") * title.text().unwrap().trim().len() as f64;
        let middle = number(&title, "x");
        assert!(middle - half > 0.0 && middle + half < width, "{title:?}");
    }
    // Three modes in two columns; coils make lines of many corners.
    let longest = document
        .descendants()
        .filter(|node| node.has_tag_name("polyline"))
        .map(|node| node.attribute("points").unwrap().split_whitespace().count())
        .max();
    assert!(longest.unwrap() >= 16, "{longest:?}");
    let square = picture("square_springs");
    assert_eq!(square.matches("mode ").count(), 8);
    std::fs::remove_file(path).unwrap();
}

/// Two masses alike on three springs, one damper on their sum: what shakes both alike does not meet the undamped mode in which they
/// move against each other, at its own frequency.
#[test]
fn a_drive_that_does_not_reach_an_undamped_mode_has_a_steady_state() {
    let text = |damping: &str| {
        format!(
            "name: Twins\nparameters: {{m: 1 kg, k: 4 N/m, c: {damping} N*s/m, F: 0 N}}\ncoordinates: {{x: m, y: m}}\n\
             bodies: {{a: {{mass: m, position: \"[x, 0]\"}}, b: {{mass: m, position: \"[y, 0]\"}}}}\n\
             springs: {{s: {{stretch: x, stiffness: k}}, s2: {{stretch: y, stiffness: k}}, s3: {{stretch: y - x, stiffness: k}}}}\n\
             dampers: {{d: {{rate: x' + y', damping: c}}}}\n\
             forces: {{f: {{on: a, force: \"[F, 0]\"}}, f2: {{on: b, force: \"[F, 0]\"}}}}\noutputs: {{sum: x + y, apart: x - y}}\n"
        )
    };
    let omega = 12.0_f64.sqrt().to_string();
    for damping in ["1", "0"] {
        let shaken = |drives: &[&str]| {
            let drives: Vec<&str> = drives.iter().flat_map(|drive| ["--drive", *drive]).collect();
            let options = ["--omega", omega.as_str(), "--response", "sum,apart,x'"];
            run(&text(damping), &[&drives, &options[..]].concat())
        };
        let found = shaken(&["f", "f2"]);
        let size = |value: &Value| value[0].as_f64().unwrap().hypot(value[1].as_f64().unwrap());
        // (k − m Ω² + 2 i c Ω) x = F with k = 4 and Ω² = 12.
        let c: f64 = damping.parse().unwrap();
        let one = 1.0 / (-8.0_f64).hypot(2.0 * c * 12.0_f64.sqrt());
        close(size(&found["steady"]["amplitude"]["x"]), one, 1e-12);
        close(size(&found["steady"]["answers"]["sum"]), 2.0 * one, 1e-12);
        assert!(size(&found["steady"]["answers"]["apart"]) < 1e-12);
    }
    // One of them alone reaches it: what both do together stays bounded.
    let options = ["--drive", "f", "--omega", &omega, "--response", "sum,apart"];
    let found = run(&text("0"), &options);
    close(found["steady"]["answers"]["sum"][0].as_f64().unwrap(), -1.0 / 8.0, 1e-12);
    assert!(found["steady"]["answers"]["apart"].is_null(), "{found}");
}

/// |x| has no small motion about 0, however it is written.
#[test]
fn a_root_at_its_kink_is_refused_as_an_answer() {
    for (output, refused) in
        [("sqrt(x^2)", true), ("norm([x, 0*L])", true), ("(x^2/L^2)^0.5", true), ("sqrt(x^2 + L^2)", false)]
    {
        let text = format!(
            "name: Kink\nparameters: {{m: 1 kg, k: 4 N/m, L: 1 m}}\ncoordinates: {{x: m}}\nkinetic_energy: m*x'^2/2\n\
             potential_energy: k*x^2/2\noutputs: {{size: \"{output}\"}}\n"
        );
        let found = try_run(&text, &["--drive", "x", "--omega", "1", "--response", "size"]);
        assert_eq!(found.is_err_and(|problem| problem.contains("no derivative")), refused, "{output}");
    }
}

/// Where its stiffness all but vanishes, a step of Newton's method would turn a pendulum 10¹⁶ times, where any force is rounding of its angle; a torque
/// for which there is no rest finds none.
#[test]
fn no_rest_is_so_many_turns_away_that_rounding_makes_it_one() {
    let pendulum = "name: P\nparameters: {m: 1 kg, l: 0.5 m, g: 9.81 m/s^2, M: 0 N*m}\ncoordinates: {theta: rad}\n\
        bodies: {bob: {mass: m, position: \"l*[sin(theta), -cos(theta)]\"}}\ngravity: [0, -g]\n\
        generalized_forces: {theta: M}\nscene: {start: {theta: 90 deg}, until: 1}\n";
    for at in ["theta=pi/2", "theta=3*pi/2"] {
        let found = run(pendulum, &["--at", at]);
        let theta = found["equilibrium"]["theta"].as_f64().unwrap();
        assert!(theta.abs() < 10.0 && theta.sin().abs() < 1e-12, "{theta}");
    }
    let refused = try_run(pendulum, &["--set", "M=5"]).unwrap_err();
    contains(&refused, &["no equilibrium found"]);
    let yoke = "name: Yoke\nparameters: {J: 0.05 kg*m^2, m: 2 kg, r: 0.1 m, M: 1.5 N*m, k: 300 N/m}\ncoordinates: {phi: rad, x: m}\n\
        bodies: {crank: {mass: 0, inertia: J, angle: phi, position: \"[0, 0]\"}, yoke: {mass: m, position: \"[x, 0]\"}}\n\
        torques: {drive: {on: crank, torque: M}}\nsprings: {s: {stretch: x, stiffness: k, along: ground.x, on: yoke}}\n\
        constraints: {slide: x - r*cos(phi)}\nscene: {start: {phi: 0}, until: 1}\n";
    let refused = try_run(yoke, &["--set", "M=1.6"]).unwrap_err();
    contains(&refused, &["no equilibrium found"]);
    let found = run(yoke, &["--set", "M=1.4"]);
    let phi = found["equilibrium"]["phi"].as_f64().unwrap();
    close((2.0 * phi).sin(), -1.4 / 1.5, 1e-12);
}

/// What an input does as time goes by is nothing to small motions, which hold it, with a constraint beside it either.
#[test]
fn kinks_of_an_input_in_time_are_none_of_small_motions() {
    let text = |constraint: &str| {
        format!(
            "name: Shaken\nparameters: {{m: 100 kg, k: 40 kN/m, A: 2 mm, w: 30 rad/s}}\ncoordinates: {{x: m, s: m}}\n\
             inputs: {{floor: \"A*max(0, sin(w*t))\"}}\nbodies: {{machine: {{mass: m, position: \"[s, x]\"}}}}\n\
             springs: {{mount: {{stretch: x - floor, stiffness: k, along: ground.y, on: machine}}}}\n\
             constraints: {{{constraint}}}\nscene: {{start: {{x: 0}}, until: 1}}\n"
        )
    };
    close(omegas(&run(&text("guide: s"), &[]))[0], 20.0, 1e-12);
    // A force that is kinked where it rests is one.
    let kinked = text("guide: s").replace("constraints", "generalized_forces: {x: -k*abs(x)}\nconstraints");
    let refused = try_run(&kinked, &[]).unwrap_err();
    contains(&refused, &["`x`"]);
}

/// What pulls at x beside a unit mass.
fn pulled(law: &str, more: &str) -> String {
    format!(
        "name: Pulled\nparameters: {{m: 1 kg, k: 3 N/m, F: 1 N}}\ncoordinates: {{x: m, y: m}}\n{more}kinetic_energy: m*(x'^2 + y'^2)/2\n\
         generalized_forces: {{x: \"-({law})\", y: -k*y}}\n"
    )
}

/// A table with two slopes at the rest, along a place, a rate, a sum of places, or in a potential that has no second derivative there, has no linear
/// model, as `abs(x)` has none; one that goes straight on has.
#[test]
fn a_rest_at_a_corner_of_a_table_is_refused() {
    let table =
        |points: &str, smooth: u8| format!("tables: {{f: {{points: [{points}], units: [m, N], smooth: {smooth}}}}}\n");
    let bent = "[-1, -1], [0, 0], [1, 2]";
    for law in ["f(x)", "f(x + y)", "k*x + f(2*x)", "1e9*k*x + f(x)"] {
        let refused = try_run(&pulled(law, &table(bent, 0)), &[]).unwrap_err();
        contains(&refused, &["at a point of a table", "along `x`"]);
    }
    let rates = table(bent, 0).replace("[m, N]", "[m/s, N]");
    contains(&try_run(&pulled("f(x') + k*x", &rates), &[]).unwrap_err(), &["at a point of a table", "along `x'`"]);
    let stiffness = |law: &str, more: &str| run(&pulled(law, more), &[])["K"][0][0].as_f64().unwrap();
    assert_eq!(stiffness("f(x)", &table("[-1, -0.3], [0, 0], [1, 0.3], [2, 5]", 0)), 0.3);
    close(stiffness("f(x) - 0.3*F", &table("[0.7, 0.21], [1, 0.3], [1.1, 0.33], [2, 5]", 0)), 0.3, 1e-12);
    // One slope at each point by a curve; and a corner beside the rest is none.
    assert!(stiffness("f(x)", &table(bent, 1)) > 0.0);
    assert_eq!(stiffness("f(x) - F", &table(bent, 0)), 2.0);
    let energy = "tables: {V: {points: [[-1, 1], [0, 0], [1, 2]], units: [m, J], smooth: 1}}\npotential_energy: V(x)\n";
    contains(&try_run(&pulled("0*F", energy), &[]).unwrap_err(), &["at a point of a table"]);
    let held = pulled("f(x)", &table(bent, 0)).replace("generalized", "constraints: {rod: x - y}\ngeneralized");
    contains(&try_run(&held, &[]).unwrap_err(), &["at a point of a table"]);
    let beside = pulled("f(x)", &table(bent, 0)).replace("F: 1 N}", "F: 1 N, w: 2 1/s}");
    let beside = beside + "states: {p: {unit: m, rate: w*(x - p)}}\n";
    contains(&try_run(&beside, &[]).unwrap_err(), &["at a point of a table", "along `x`"]);
}

/// Products of switches that are smooth have the slope that they have on all sides, and those that are not are refused, whichever switch it is of.
#[test]
fn switches_that_turn_together_are_taken_together() {
    let pulled = |law: &str| {
        pulled(law, "")
            .replace(": m,", ": ,")
            .replace("y: m}", "y: }")
            .replace("m: 1 kg, k: 3 N/m, F: 1 N", "m: 1, k: 3")
    };
    for law in ["k*abs(x)*sign(x)", "k*sign(x)*sin(abs(x))", "k*max(0, x) + k*min(0, x)", "k*x + abs(x)*x"] {
        assert_eq!(run(&pulled(law), &[])["K"][0][0], 3.0, "{law}");
        let held = pulled(law).replace("generalized", "constraints: {rod: x - y}\ngeneralized");
        assert_eq!(run(&held, &[])["K"][0][0], 6.0, "{law}");
    }
    for law in ["abs(abs(x))", "abs(x)", "max(x, 2*x)", "abs(x) + abs(y)", "min(abs(x), abs(y)) + x"] {
        contains(&try_run(&pulled(law), &[]).unwrap_err(), &["changes sign and with it the stiffness"]);
    }
}

/// A stiffness that changes with time beside a rest that does not: that it has no equilibrium is not the reason.
#[test]
fn a_rest_beside_which_time_acts_is_called_that() {
    let ages = "define: {age: \"t/T\"}\n";
    let with_time = |text: String| text.replace("F: 1 N}", "F: 1 N, T: 10 s}");
    for law in ["k*x*(1 + age)", "(k*x - F)*(1 + age)"] {
        let found = try_run(&with_time(pulled(law, ages)), &[]).unwrap_err();
        contains(&found, &["there is a rest, but beside it the equation of `x` depends on time", "--at-time"]);
        let held = pulled(law, ages).replace("generalized", "constraints: {rod: x - y}\ngeneralized");
        let found = try_run(&with_time(held), &[]).unwrap_err();
        assert!(found.contains("depends on time"), "{found}");
    }
    let moves = try_run(&with_time(pulled("k*x - F*age", ages)), &[]).unwrap_err();
    contains(&moves, &["depends on time, so it has no equilibrium"]);
}
