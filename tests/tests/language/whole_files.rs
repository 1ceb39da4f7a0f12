//! Section 12: every whole file of the page compiles and runs.

use dalembert::{Run, Warning};
use dalembert_tests::case::Case;

/// The whole files of the page, by name.
fn whole_files() -> Vec<(String, String)> {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/LANGUAGE.md")).expect("the page");
    let fenced = page.split("```yaml\n").skip(1).map(|rest| rest.split("```").next().unwrap_or(rest).to_owned());
    let named = |text: &str| text.lines().next().and_then(|line| line.strip_prefix("name: ")).map(str::to_owned);
    fenced.map(|text| (named(&text).unwrap_or_else(|| panic!("no name in\n{text}")), text)).collect()
}

/// What the program says of a file, or its complaint.
fn told(arguments: &[&str]) -> String {
    let mut out = Vec::new();
    let arguments = std::iter::once(&"dalembert").chain(arguments);
    match dalembert::cli::run(&[], arguments, &mut out) {
        Ok(()) => String::from_utf8(out).expect("text"),
        Err(problem) => panic!("status {}: {problem}", problem.status()),
    }
}

/// All scenes of a file, run.
fn scenes(text: &str) -> Vec<(String, Run)> {
    let names = Case::written(text).system.description().scenes.clone();
    names.iter().map(|name| (name.to_string(), Case::written(text).scene(name).run())).collect()
}

#[test]
fn every_whole_file_is_checked_and_simulated_by_the_program() {
    let files = whole_files();
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["DoublePendulum", "ChaplyginSleigh", "FigureEight", "StringRayleigh", "EccentricCylinder"]);
    let folder = std::env::temp_dir().join(format!("dalembert-language-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    for (name, text) in &files {
        let path = folder.join(format!("{name}.yaml"));
        std::fs::write(&path, text).expect("a file");
        let path = path.to_string_lossy();
        let checked = told(&["check", &path]);
        assert!(!checked.contains("warning") && checked.contains("tested at"), "{checked}");
        for (scene, _) in scenes(text) {
            assert!(told(&["simulate", &path, "--scene", &scene, "--json"]).starts_with('{'), "{name}, {scene}");
        }
    }
    std::fs::remove_dir_all(folder).expect("to be removed");
}

#[test]
fn every_scene_of_every_whole_file_runs_to_its_end_and_keeps_what_it_claims() {
    for (name, text) in whole_files() {
        for (scene, run) in scenes(&text) {
            // A sleigh at rest stays, and the page's scene of the drum stops when its normal force vanishes.
            let ended = run.ended_by().map(|event| event.name.as_str());
            let expected = (name == "EccentricCylinder" && scene == "scene").then_some("unloaded");
            assert_eq!(ended, expected, "{name}, {scene}");
            assert!(run.warnings.iter().all(|w| matches!(w, Warning::DigitsLost { .. })), "{:?}", run.warnings);
            assert!(run.energy_balance.is_none_or(|drift| drift < 1e-7), "{name}: {:?}", run.energy_balance);
            assert!(
                run.drift.iter().all(|drift| drift.value.is_none_or(|value| value < 1e-7)),
                "{name}: {:?}",
                run.drift
            );
            let residuals = run.residuals.map_or(0.0, |residuals| residuals.position.max(residuals.velocity));
            assert!(residuals < 1e-10, "{name}: {:?}", run.residuals);
        }
    }
}

/// The times that stand beside the scene `real`, the frequency in `about`.
#[test]
fn numbers_in_comments_of_whole_files_are_those_of_the_runs() {
    let files = whole_files();
    let text = |name: &str| &files.iter().find(|(known, _)| known == name).expect("a whole file").1;
    let drum = text("EccentricCylinder");
    let comment = drum.lines().find(|line| line.trim_start().starts_with("real:")).expect("a scene");
    let comment = comment.split_once('#').expect("a comment").1;
    let times: Vec<f64> = comment.split([' ', ',']).filter_map(|word| word.parse().ok()).collect();
    let run = Case::written(drum).scene("real").run();
    let found: Vec<f64> = run.events.iter().map(|event| event.state.t).collect();
    assert_eq!(times.len(), 5);
    assert_eq!(found.len(), 5);
    for (found, told) in found.iter().zip(times) {
        assert!((found - told).abs() < 5.1e-7, "{found} is not {told}");
    }
    // sqrt(10) c/L with c = L = 1.
    let mut string = Case::written(text("StringRayleigh")).start("b", 1.0).tolerance(1e-12);
    let state = string.state_at(1.0);
    assert!((state["b"] - 10.0_f64.sqrt().cos()).abs() < 1e-10, "{state:?}");
}
