//! Generated code against the interpreter of the same program.

use dalembert::cli::Entry;
use dalembert::mechanism::{Interpreted, System};
use dalembert_models::MODELS;
use dalembert_symbolic::lower::compile;
use dalembert_tests::both::{Drawn, assert_same};

/// What depends on time does so with the frequencies that its file writes; a replaced input is not known.
#[test]
fn frequencies_are_those_of_the_file() {
    let system = |name: &str| {
        let entry = MODELS.iter().find(|entry| entry.name == name).expect("a model");
        (entry.compiled.expect("its code"))()
    };
    let parameter = |system: &dyn System, name: &str| {
        let place = system.description().parameters.iter().position(|known| known.name == name);
        system.parameters()[place.expect("a parameter")]
    };
    for (name, frequency) in [
        ("shaken_pendulum", "Omega"),
        ("base_excitation", "omega0"),
        ("vibration_isolation", "w"),
        ("forced_chain", "w"),
    ] {
        let system = system(name);
        assert_eq!(system.frequencies(), Some(vec![parameter(&*system, frequency)]), "{name}");
    }
    let mut chain = system("forced_chain");
    chain.set_input(0, std::sync::Arc::new(|_| [1.0, 0.0, 0.0]));
    assert_eq!(chain.frequencies(), None);
    assert_eq!(system("double_pendulum").frequencies(), Some(Vec::new()));
}

/// In every scene of every model, and with other parameters, both compute the same to rounding.
#[test]
fn compiled_and_interpreted_models_agree() {
    for entry in MODELS {
        let program = compile(entry.source, &[]).unwrap_or_else(|_| panic!("{} does not compile", entry.name));
        let mut interpreted = Interpreted::new(program, entry.source);
        let mut compiled = (entry.compiled.expect("its code"))();
        assert_eq!(compiled.motions(), interpreted.motions(), "{}", entry.name);
        // Motions have scenes of their own.
        for scene in 0..compiled.description().scenes.len() + compiled.motions().len() {
            assert_eq!(compiled.scene_parameters(scene), interpreted.scene_parameters(scene), "{}", entry.name);
            for (index, value) in compiled.scene_parameters(scene) {
                compiled.set_parameter(index, value);
                interpreted.set_parameter(index, value);
            }
            for index in 0..compiled.parameters().len() {
                let value = 1.07 * compiled.parameters()[index];
                compiled.set_parameter(index, value);
                interpreted.set_parameter(index, value);
            }
            assert_eq!(compiled.frequencies(), interpreted.frequencies(), "{}", entry.name);
            for motion in 0..compiled.motions().len() {
                assert_eq!(compiled.motion_numbers(motion), interpreted.motion_numbers(motion), "{}", entry.name);
            }
            let start = compiled.scene(scene);
            assert_eq!(start, interpreted.scene(scene), "{}", entry.name);
            let vary = |list: &[f64], phase: f64| -> Vec<f64> {
                list.iter().enumerate().map(|(i, x)| 0.9 * x + 0.05 * (i as f64 + phase).sin()).collect()
            };
            let (q, v) = (vary(&start.q, 0.3), vary(&start.v, 1.7));
            let state = Drawn { t: 0.37, a: vary(&q, 2.9), q, v };
            let (one, other) = (compiled.description(), interpreted.description());
            assert_eq!(one.balances, other.balances, "{}", entry.name);
            assert_eq!((&one.arguments, &one.input_jumps), (&other.arguments, &other.input_jumps), "{}", entry.name);
            let name = format!("{}, scene {scene}", entry.name);
            assert_same(&name, &*compiled, &interpreted, &state, 1e-12);
        }
    }
}

/// A program without the models' code derives their files, as they are, and tells the same.
#[test]
fn a_program_without_code_tells_the_same() {
    let interpreted: Vec<Entry> = MODELS.iter().map(|entry| Entry { compiled: None, ..*entry }).collect();
    let told = |models: &[Entry], arguments: &[&str]| {
        let mut out = Vec::new();
        dalembert::cli::run(models, ["dalembert"].iter().chain(arguments), &mut out).map_err(|e| e.to_string())?;
        String::from_utf8(out).map_err(|e| e.to_string())
    };
    for arguments in [
        &["list"][..],
        &["simulate", "bouncing_ball"],
        &["modes", "four_bar"],
        &["show", "motor"],
        &["check", "heavy_top"],
    ] {
        let text = told(MODELS, arguments);
        assert!(text.is_ok() && text == told(&interpreted, arguments), "{arguments:?}: {text:?}");
    }
    assert_eq!(told(&interpreted, &["show", "motr"]), told(MODELS, &["show", "motr"]));
}
