//! Digits that are promised hold.

use dalembert_tests::case::Case;
use dalembert_tests::digits::promises;

#[test]
fn no_promise_is_broken_and_few_are_too_modest() {
    let found = promises(&[None, Some(1e-6), Some(1e-9)]);
    let mut modesty: Vec<f64> = found.iter().flat_map(|promise| promise.modesty()).collect();
    modesty.sort_by(f64::total_cmp);
    assert!(modesty.len() > 500, "{}", modesty.len());
    let broken: Vec<String> = found
        .iter()
        .filter(|promise| promise.broken() > 0.5)
        // Its run ends where the normal force vanishes, at the pole of the friction that it needs.
        .filter(|promise| promise.name != "eccentric_cylinder, scene")
        .map(|promise| {
            let worst = promise.columns.iter().max_by(|a, b| (a.2 / a.1).total_cmp(&(b.2 / b.1)));
            format!("{} at {:e}: {:.1} digits {worst:?}", promise.name, promise.tolerance, promise.broken())
        })
        .collect();
    let median = modesty[modesty.len() / 2];
    assert!(broken.is_empty(), "{broken:#?}");
    assert!(median < 1.7, "{median}");
}

/// The second run follows the steps of the first: its error is a known part larger also where errors grow exponentially, and it costs
/// less than a run at ten times the tolerance, which was 65 times less accurate here.
#[test]
fn four_digits_of_a_chaotic_double_pendulum_are_promised() {
    let case = |tolerance: f64| {
        let mut case = Case::new("double_pendulum").tolerance(tolerance);
        case.settings.until = 10.0;
        case
    };
    let mut judged = case(1e-10);
    judged.settings.digits = true;
    let (run, truth) = (judged.run(), case(1e-14).run());
    let promised = *run.errors("theta1").unwrap().last().unwrap();
    let error = (run.last()["theta1"] - truth.last()["theta1"]).abs();
    assert!(error < promised && promised < 30.0 * error, "{promised:e} {error:e}");
    assert_eq!(run.digits("theta1"), Some(4));
    // The third run included, which few digits ask for.
    let looser = case(1e-9).run().work.evaluations;
    assert!(run.digits.unwrap().evaluations < 2 * looser, "{looser}");
}

/// A start that rounding takes off its constraints is no start of chaos.
#[test]
fn no_scene_loses_all_digits_where_it_starts() {
    for entry in dalembert_models::MODELS {
        let scenes = Case::new(entry.name).system.description().scenes.clone();
        for scene in scenes.iter() {
            let mut case = Case::new(entry.name).scene(scene);
            case.settings.digits = true;
            let Ok(run) = case.try_run() else { continue };
            assert!(run.digits_until() > Some(case.settings.from), "{}, {scene}", entry.name);
        }
    }
}
