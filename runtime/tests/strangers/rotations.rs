//! Bodies with a `rotation` that constraints keep from turning, or all but do: what moves there is rounding, and is judged by what moves it.

use dalembert::simulate;

use super::{case, folder, program, text_of};

fn close(found: f64, expected: f64, part: f64) {
    assert!((found - expected).abs() <= part * expected.abs(), "{found} for {expected}");
}

/// A block is pushed over a floor: x = F t²/(2 m).  Its reactions' moments about the origin grow as it goes, and so does their rounding.
#[test]
fn a_block_on_a_floor_takes_few_steps_whichever_side_is_named_first() {
    let text = text_of("block_on_floor");
    let other = text.replace(
        "plane: [b, ground], at: [S, O], axis: [B.z, ground.z]",
        "plane: [ground, b], at: [O, S], axis: [ground.z, B.z]",
    );
    assert_ne!(text, other);
    for text in [text, other] {
        let run = case(&text).run();
        close(run.last()["x"], 3.0, 1e-12);
        assert!(run.work.steps < 100, "{} steps", run.work.steps);
    }
}

/// A body slides down a rail from the origin, s = g cos α t²/2, by a cylinder and by a slider, from rest and with a push.
#[test]
fn a_body_on_a_tilted_rail_takes_few_steps() {
    let text = text_of("body_on_rail");
    let slider = text.replace("cylinder", "slider");
    let pushed = slider.replace("start: {q: [[y, al]]}", "start: {q: [[y, al]], z': 1}");
    for (text, speed) in [(text, 0.0), (slider, 0.0), (pushed, 1.0)] {
        let run = case(&text).run();
        let z = 2.0 * speed - 0.5 * 9.81 * (0.7_f64.cos() * 2.0).powi(2);
        close(run.last()["z"], z, 1e-10);
        close(run.last()["x"], z * 0.7_f64.tan(), 1e-10);
        assert!(run.work.steps < 100, "{} steps", run.work.steps);
    }
}

/// A body that a weld holds to the ground has no angular acceleration that anything could change.
#[test]
fn what_cannot_turn_is_no_reason_to_refuse_a_file() {
    for name in ["clamped_body", "parallelogram_in_space"] {
        case(&text_of(name));
    }
}

/// A slider-crank of bodies in space: the angle of its crank after 2 s is that of the mechanism with one freedom.
#[test]
fn a_slider_crank_by_rotations_moves_as_in_its_plane() {
    let text = text_of("slider_crank_by_rotations");
    let longer = text.replace("L: 0.5 m", "L: 0.8 m");
    assert_ne!(text, longer);
    case(&longer);
    let run = case(&text).run();
    close(run.last()["a"], 0.987_968_62, 1e-7);
    // At its dead centre some minors of its constraints vanish, and nothing depends on anything more than elsewhere.
    assert!(!run.warnings.iter().any(|warning| matches!(warning, dalembert::Warning::SingularPassed { .. })));
}

/// Two shafts at a right angle lock: the row is sin a cos c, and what the start names is kept.
#[test]
fn angles_of_a_searched_start_move_by_half_a_turn_at_most() {
    let file = |start: &str| {
        format!(
            "name: Locked\ncoordinates: {{a: rad, c: rad}}\nparameters: {{I: 1 kg*m^2}}\nkinetic_energy: I*(a'^2 + c'^2)/2
constraints: {{k: sin(a)*cos(c)}}\nscene: {{start: {{a: 0.3, a': 1}}, {start}, until: 1}}\n"
        )
    };
    for guess in ["guess: {c: 1e-17}", "guess: {c: 1}", "guess: {c: -1}"] {
        let run = case(&file(guess)).run();
        close(run.last()["a"], 1.3, 1e-12);
        close(run.last()["c"].abs(), std::f64::consts::FRAC_PI_2, 1e-12);
    }
    let mut symmetric = case(&file("guess: {c: 0}"));
    let error = simulate(&mut symmetric.system, &symmetric.settings).expect_err("no change of first order").to_string();
    assert!(error.contains("try another `guess`"), "{error}");
}

/// A tyre that rolls upright and straight ahead does so at any heading: (A + m R²) θ'' + [(C + m R²) C W²/A − m g a] θ = 0.
#[test]
fn a_straight_rolling_tyre_keeps_its_heading() {
    for heading in ["psi: 0", "psi: 0.5"] {
        let text = text_of("upright_tyre").replace("psi: 0, th: 0", &format!("{heading}, th: 0"));
        let file = super::folder("tyre").join("tyre.yaml");
        std::fs::write(&file, text).expect("written");
        let told = program(&["modes", file.to_str().expect("a path"), "--steady"]).expect("modes");
        assert!(told.contains("± 1.56296i"), "{told}");
        assert!(told.contains(&format!("{} rad,", heading.replace(':', " ="))), "{told}");
    }
}

/// The first step of a run of three years leads anywhere: what rounding makes of reactions there is no noise of the motion.
#[test]
fn a_first_step_that_leads_anywhere_is_rejected() {
    let path = format!("{}/../models/pendulum_cartesian.yaml", env!("CARGO_MANIFEST_DIR"));
    for until in ["1e8", "3e8", "1e10", "3e12"] {
        let why = program(&["simulate", &path, "--until", until, "--max-steps", "300"]).expect_err("no steps are left");
        assert!(why.contains("more than 300 steps"), "{until}: {why}");
    }
}

/// A four-bar is closed by a hinge, two of whose rows are 0 however it stands, and where its plane is tilted 0 but for rounding: they counted like any
/// others.
#[test]
fn a_four_bar_moves_in_whatever_plane_it_is() {
    let tilted = text_of("fourbar_in_a_tilted_plane");
    for plane in ["[x, 0]", "[x, 0.4]", "[[z, 0.4], [y, 0.7]]", "[[x, 0.4], [y, 0.3]]"] {
        let run = case(&tilted.replace("[x, 0.4]", plane)).run();
        close(run.last()["a"], 1.310_860_02, 1e-8);
    }
}

/// About a vertical axis it may stand anywhere: the row of that angle is nothing but rounding.
#[test]
fn a_body_on_a_pivot_rests_below_it_by_three_angles_as_by_two() {
    use dalembert::linear::{Guess, equilibrium_near};
    let text = "name: Bob\nparameters: {m: 1 kg, g: 9.81 m/s^2, l: 1 m}\ncoordinates: {s: rad, a: rad, b: rad}\n\
        frames: {B: {rotate: [[z, s], [x, a], [y, b]]}}\n\
        bodies: {bob: {mass: m, inertia: [0.3, 0.4, 0.5], frame: B, position: l*(0.03*B.x - 0.05*B.y - 0.3*B.z)}}\ngravity: [0, 0, -g]\n";
    for guess in [[0.0, 0.3, 0.2], [0.7, 0.0, 0.0], [-2.0, 0.4, -0.3]] {
        let rest = equilibrium_near(&case(text).system, &Guess::at(&guess)).expect("a rest");
        // The centre of mass is below the pivot.
        close(rest.q[1], 0.164_343_789_662_880_27, 1e-12);
        close(rest.q[2], 0.099_668_652_491_162_04, 1e-12);
    }
    // A free body turns steadily about an axis of its inertia.
    let free = "name: Hull\ncoordinates: {s: rad, a: rad, b: rad}\nframes: {B: {rotate: [[z, s], [x, a], [y, b]]}}\nbodies:\n  \
        hull: {mass: 0, inertia: [[3, 0.1, -0.2], [0.1, 4, 0.3], [-0.2, 0.3, 5]], frame: B, position: [0, 0, 0]}\n";
    let steady = equilibrium_near(&case(free).system, &Guess { v: vec![0.5, 0.0, 0.0], ..Guess::at(&[0.0; 3]) })
        .expect("a steady motion");
    close(steady.q[1], 0.259_215, 1e-5);
    close(steady.q[2], 0.082_522_5, 1e-5);
}

/// In a frame that turns with time, by angles or by a rotation, a potential of the body's attitude to the frame alone changes with time by rounding.
#[test]
fn an_attitude_in_a_frame_that_turns_does_not_depend_on_time() {
    let text = "name: Satellite\nparameters: {I: 5 kg*m^2, n: 0.2 rad/s, k: 3 N*m}\ncoordinates: {att: rotation}\n\
        frames: {O: {rotate: [z, n*t]}, B: {from: O, rotate: att}}\n\
        bodies: {sat: {mass: 0, inertia: [I, 2*I, 2.2*I], frame: B, position: [0, 0, 0]}}\n\
        potential_energy: k*(dot(B.x, O.x)^2 + 2*dot(B.y, O.x)^2)\nscene: {start: {att: [[z, 0.1]]}}\n";
    let path = super::folder("satellite").join("satellite.yaml");
    std::fs::write(&path, text).expect("a file");
    let told = program(&["modes", path.to_str().expect("a path")]).expect("modes");
    assert!(told.contains("equilibrium at"), "{told}");
}

/// A frame about z by 0.3 and about the turned x by 0.5, and a body that is turned by any quaternion.
#[test]
fn outputs_tell_quaternions_with_their_four_names() {
    let run = case(
        "name: Two\nparameters: {m: 1 kg}\ncoordinates: {q: rotation}
frames: {A: {rotate: [[z, 0.3], [x, 0.5]]}, B: {rotate: q}}
bodies: {b: {mass: m, inertia: [2, 3, 4], frame: B, position: [0, 0, 0]}}
outputs: {fixed: quaternion(A), turned: quaternion(B)}
scene: {start: {q: {quaternion: [-3, 0, 4, 0]}}, until: 1}\n",
    )
    .run();
    let (z, x) = ((0.15_f64.sin(), 0.15_f64.cos()), (0.25_f64.sin(), 0.25_f64.cos()));
    let expected = [("fixed", [z.1 * x.1, z.1 * x.0, z.0 * x.0, z.0 * x.1]), ("turned", [-0.6, 0.0, 0.8, 0.0])];
    for (name, numbers) in expected {
        for (axis, expected) in ["w", "x", "y", "z"].into_iter().zip(numbers) {
            let found = run.last()[&*format!("{name}.{axis}")];
            assert!((found - expected).abs() < 1e-15, "{name}.{axis}: {found}");
        }
    }
}

/// What is 0 of a body that is turned about z only is told as 0, and a claim that fails names the component: the first of a quaternion is w.
#[test]
fn components_of_quaternions_are_zero_and_have_names() {
    let model = folder("rotations").join("turned.yaml");
    let file = |more: &str| {
        let text = format!(
            "name: Turned\nparameters: {{m: 2 kg, k: 30 N/m, J: 0.1 kg*m^2}}\ncoordinates: {{x: m, y: m, z: m, att: rotation}}\n\
             frames: {{B: {{rotate: att}}}}\nbodies: {{b: {{mass: m, inertia: [J, 2*J, 3*J], frame: B, position: '[x, y, z]'}}}}\n\
             springs: {{s: {{between: [ground, b], stiffness: k}}}}\n{more}\n\
             scene: {{start: {{x: 1, att: [[z, 0.3 rad]]}}, until: 2}}\n"
        );
        std::fs::write(&model, text).expect("a file");
        model.to_str().expect("a path").to_owned()
    };
    let told = program(&["simulate", &file("outputs: {q: quaternion(B)}")]).unwrap();
    assert!(told.contains("  q.x = 0\n") && told.contains("  q.y = 0\n"), "{told}");
    // The cosine and the sine of half the angle.
    assert!(told.contains("  q.w = 0.98877107794") && told.contains("  q.z = 0.149438132474"), "{told}");
    let refused = program(&["check", &file("conserved: {q: quaternion(B)}")]).unwrap_err();
    assert!(refused.contains("its rate is w component"), "{refused}");
}

/// A body on an arm of one metre whose attitude follows from a guess, with this angular velocity at the start.
fn spin_on_arm(start: &str, rest: &str) -> String {
    format!(
        "name: SpinOnArm\nparameters: {{m: 2 kg, l: 1 m, W: 3 rad/s, n: 0 1}}\ncoordinates: {{x: m, y: m, z: m, q: rotation}}\n\
         frames: {{F: {{rotate: q}}}}\n\
         bodies: {{c: {{mass: m, inertia: [0.1, 0.2, 0.25], frame: F, position: '[x, y, z]'}}}}\n\
         constraints: {{p: position(c) - l*F.x}}\n\
         outputs: {{own: 'components(angular_velocity(c), c)', w: angular_velocity(c)}}\n\
         scene: {{start: {{{start}}}, guess: {{x: 0.2, y: 1, q: {{vector: [0, n, 1.5]}}}}, {rest}}}\n"
    )
}

/// The angular velocity of a start is that at the attitude that is found, and goes on so: without forces ω about a principal axis stays.
#[test]
fn a_start_keeps_its_angular_velocity_where_the_attitude_is_found() {
    let components = |run: &dalembert::Run, name: &str| ["x", "y", "z"].map(|k| run.last()[&format!("{name}.{k}")]);
    let all = |found: [f64; 3], expected: [f64; 3]| {
        let near = found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12);
        assert!(near, "{found:?}, not {expected:?}");
    };
    let own = case(&spin_on_arm("x: 0, q': [1, 2, 3]", "until: 0")).run();
    all(components(&own, "own"), [1.0, 2.0, 3.0]);
    let fixed = case(&spin_on_arm("x: 0, q': {ground: [1, 2, 3]}", "until: 0")).run();
    all(components(&fixed, "w"), [1.0, 2.0, 3.0]);
    let going = case(&spin_on_arm("q': [0, 0, W]", "until: 3, tolerance: 1e-10")).run();
    assert!((going.last()["own.z"] - 3.0).abs() < 1e-8, "{}", going.last()["own.z"]);
    // Nor does its quaternion grow.
    let length: f64 = ["w", "x", "y", "z"].map(|k| going.last()[&format!("q.{k}")].powi(2)).iter().sum();
    close(length, 1.0, 1e-9);
}

/// A quaternion of another length, or of another direction, which the command line gives has the angular velocity of the file.
#[test]
fn a_start_that_is_given_another_attitude_keeps_its_angular_velocity() {
    let free = |rate: &str| {
        format!(
            "name: Free\ncoordinates: {{q: rotation}}\nframes: {{A: {{rotate: q}}}}\n\
             bodies: {{b: {{mass: 1, inertia: [0.3, 0.5, 0.6], frame: A, position: [0, 0, 0]}}}}\n\
             outputs: {{own: 'components(angular_velocity(b), b)', w: angular_velocity(b)}}\n\
             scene: {{start: {{q': {rate}}}, until: 0}}\n"
        )
    };
    for (rate, name) in [("[1, 2, 3]", "own"), ("{ground: [1, 2, 3]}", "w")] {
        for start in [["2", "0", "0"], ["0", "1", "0"], ["0.5", "0", "-3"]] {
            let path = folder("given_attitude").join("model.yaml");
            std::fs::write(&path, free(rate)).expect("a file");
            let [w, x, z] = start;
            let starts = [format!("q.w={w}"), format!("q.x={x}"), format!("q.z={z}")];
            let mut arguments = vec!["simulate", path.to_str().expect("a path"), "--json"];
            starts.iter().for_each(|start| arguments.extend(["--start", start.as_str()]));
            let said = program(&arguments).unwrap();
            let json: serde_json::Value = serde_json::from_str(&said).expect("JSON");
            for (k, expected) in [1.0, 2.0, 3.0].into_iter().enumerate() {
                let found = json["outputs"][name][k].as_f64().expect("a number");
                assert!((found - expected).abs() < 1e-14, "{rate} {start:?} {name}.{k}: {found}");
            }
        }
    }
}

/// Slopes of such a start are those of runs beside it.
#[test]
fn an_angular_velocity_at_an_attitude_that_is_found_has_the_slopes_of_its_runs() {
    for start in ["x: 0.1, q': [W, 2, W]", "x: 0.1, q': {ground: [1, W, 3]}"] {
        let text = spin_on_arm(start, "until: 0");
        let slopes = super::simulation(&text).slopes(&["W", "n", "l"]).unwrap();
        for (unknown, from) in [("W", "W: 3 rad/s"), ("n", "n: 0 1"), ("l", "l: 1 m")] {
            let unit = from.rsplit(' ').next().unwrap_or_default();
            let value: f64 = from.split(' ').nth(1).and_then(|text| text.parse().ok()).expect("a number");
            let at = |value: f64| case(&text.replace(from, &format!("{unknown}: {value:?} {unit}"))).run();
            let (more, less) = (at(value + 1e-5), at(value - 1e-5));
            for name in ["q.w'", "q.x'", "q.y'", "q.z'", "x'", "y'", "own.x", "w.y"] {
                let found = slopes.get(name, unknown).unwrap().value;
                let expected = (more.last()[name] - less.last()[name]) / 2e-5;
                assert!((found - expected).abs() < 1e-7, "{start}: {name} by {unknown}: {found}, {expected}");
            }
        }
    }
}
