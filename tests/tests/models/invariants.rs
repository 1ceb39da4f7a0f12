//! What every model of the library promises.

use dalembert_tests::case::Case;

/// In every scene, at its tolerance, invariants and the energy balance drift by less than 1e-9 (or ten times the
/// tolerance, for the scenes that ask for less), and nothing is warned of.
#[test]
fn no_scene_lets_an_invariant_or_the_energy_balance_drift() {
    let mut failures = Vec::new();
    for entry in dalembert_models::MODELS {
        // `energy: {value: energy, when: {c: 0}}` is conserved under its condition only.
        let conditional = |invariant: &str| entry.source.contains(&format!("{invariant}: {{value:"));
        let scenes = Case::new(entry.name).system.description().scenes.clone();
        for scene in scenes.iter() {
            // This one is about the error with which it ends.
            if (entry.name, scene.as_ref()) == ("pendulum_awkward", "horizontal") {
                continue;
            }
            let mut case = Case::new(entry.name).scene(scene);
            let bound = f64::max(1e-9, 10.0 * case.settings.tolerance);
            let run = case.run();
            let watched = run.drift.iter().filter(|drift| !conditional(&drift.name));
            let drifts = watched.map(|drift| (drift.name.as_str(), drift.value));
            for (name, drift) in drifts.chain([("energy_balance", run.energy_balance)]) {
                if drift.is_none_or(|drift| drift > bound) {
                    failures.push(format!("{}, {scene}: `{name}` drifts by {drift:?}", entry.name));
                }
            }
            failures.extend(run.warnings.iter().map(|warning| format!("{}, {scene}: {warning}", entry.name)));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn every_model_says_what_it_is_and_has_something_to_draw() {
    for entry in dalembert_models::MODELS {
        let case = Case::new(entry.name);
        let description = case.system.description();
        assert!(description.about.len() > 40, "{} says nothing of itself", entry.name);
        assert!(!description.draw.is_empty(), "{} draws nothing", entry.name);
        assert!(!description.invariants.is_empty(), "{} conserves nothing", entry.name);
    }
}
