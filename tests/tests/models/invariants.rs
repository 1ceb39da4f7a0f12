//! What every model of the library promises.

use dalembert::Warning;
use dalembert_tests::case::Case;

/// In every scene, at its tolerance, invariants and the energy balance drift by less than 1e-9 (or twenty times
/// the tolerance, for the scenes that ask for less), and nothing is warned of.
#[test]
fn no_scene_lets_an_invariant_or_the_energy_balance_drift() {
    let mut failures = Vec::new();
    for entry in dalembert_models::MODELS {
        let scenes = Case::new(entry.name).system.description().scenes.clone();
        for scene in scenes.iter() {
            // This one is about the error with which it ends.
            if (entry.name, scene.as_ref()) == ("pendulum_awkward", "horizontal") {
                continue;
            }
            let mut case = Case::new(entry.name).scene(scene);
            let bound = f64::max(1e-9, 20.0 * case.settings.tolerance);
            let run = case.run();
            // `energy: {value: energy, when: {c: 0}}` is watched where c is 0 only.
            let conditional = |name: &str| entry.source.contains(&format!("{name}: {{value:"));
            let watched = run.drift.iter().filter(|drift| drift.value.is_some() || !conditional(&drift.name));
            let drifts = watched.map(|drift| (drift.name.as_str(), drift.value));
            for (name, drift) in drifts.chain([("energy_balance", run.energy_balance)]) {
                if drift.is_none_or(|drift| drift > bound) {
                    failures.push(format!("{}, {scene}: `{name}` drifts by {drift:?}", entry.name));
                }
            }
            // That a ball comes to rest is said, and is what its scene is about; so is a top that stands all but upright, of angles that lock there.
            let expected = |warning: &&Warning| {
                matches!(warning, Warning::ImpactsAccumulate { .. })
                    || entry.name == "tippe_top" && matches!(warning, Warning::NearGimbalLock { .. })
            };
            let warnings = run.warnings.iter().filter(|warning| !expected(warning));
            failures.extend(warnings.map(|warning| format!("{}, {scene}: {warning}", entry.name)));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Models that something drives all the time.
const DRIVEN: [&str; 4] = ["engine_map", "lugre", "mast_in_gusts", "three_link_arm"];

#[test]
fn every_model_says_what_it_is_and_has_something_to_draw() {
    for entry in dalembert_models::MODELS {
        let case = Case::new(entry.name);
        let description = case.system.description();
        assert!(description.about.len() > 40, "{} says nothing of itself", entry.name);
        assert!(!description.draw.is_empty(), "{} draws nothing", entry.name);
        // What goes through phases may lose energy in some of them.
        let phases = description.phases.len() > 1;
        let driven = DRIVEN.contains(&entry.name);
        assert!(phases || driven || !description.invariants.is_empty(), "{} conserves nothing", entry.name);
    }
}

/// A ball without drag keeps its energy; one with drag does not claim to.
#[test]
fn a_conditional_invariant_is_watched_where_its_condition_holds() {
    let energy = |scene: &str| {
        let run = Case::new("cannon_ball").scene(scene).run();
        run.drift.into_iter().find(|drift| drift.name == "energy").expect("an invariant").value
    };
    assert!(energy("no_drag").is_some_and(|drift| drift < 1e-12));
    assert_eq!(energy("scene"), None);
}
