//! Bodies with a `rotation` that constraints keep from turning, or all but do: what moves there is rounding, and is judged by what moves it.

use dalembert::simulate;

use super::{case, program, text_of};

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
