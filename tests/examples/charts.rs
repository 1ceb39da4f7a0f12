//! Speed against accuracy over all models and scenes, as the page `docs/charts.md` and the pictures in `docs/charts`:
//! `cargo run --release -p dalembert-tests --example charts > docs/charts.md`; with names, of those models only.

use std::ops::ControlFlow;

use dalembert::Method;
use dalembert::precision::{Candidate, Curve, Measured, Plan, Profile, WorkPrecision};
use dalembert_tests::case::Case;

/// The errors at which methods are compared.
const TARGETS: [f64; 3] = [1e-3, 1e-6, 1e-9];

/// These are there to learn from.
const TEACHING: [Method; 2] = [Method::Euler, Method::Midpoint];

fn main() {
    let only: Vec<String> = std::env::args().skip(1).collect();
    let wanted = |name: &str| only.is_empty() || only.iter().any(|known| known == name);
    // Work is counted; nobody looks at times.
    let plan = Plan { repetitions: 1, ..Plan::default() };
    let mut scenes = Vec::new();
    let mut profile = Profile::new(1e-6);
    for entry in dalembert_models::MODELS.iter().filter(|entry| wanted(entry.name)) {
        for scene in Case::new(entry.name).system.description().scenes.iter() {
            let case = Case::new(entry.name).scene(scene);
            let mut candidates = Candidate::methods(&*case.system, &case.settings);
            candidates.retain(|candidate| !TEACHING.contains(&candidate.settings.method));
            let name = format!("{}, {scene}", entry.name);
            match WorkPrecision::measure(&candidates, &plan, &mut |_| ControlFlow::Continue(())) {
                Ok(found) => {
                    eprintln!("{name}: {}", found.sentence());
                    profile.add(&found);
                    scenes.push((name, found));
                }
                Err(error) => eprintln!("{name}: {error}"),
            }
        }
    }
    print_choices(&scenes);
    println!("\nGeometric means of the work beside the least, to 1e-6, a failure counting 100:\n");
    for (name, mean) in profile.means() {
        println!("- {name}: {mean:.2}");
    }
}

/// What `auto` chose in each scene, and what that costs beside the best.
fn print_choices(scenes: &[(String, WorkPrecision)]) {
    println!("| scene | 1e-3: auto | best | cost | 1e-6: auto | best | cost | 1e-9: auto | best | cost |");
    println!("| --- | --- | --- | ---: | --- | --- | ---: | --- | --- | ---: |");
    let mut ratios: [Vec<f64>; 3] = Default::default();
    for (name, found) in scenes {
        let mut line = format!("| {name} ");
        for (target, ratios) in TARGETS.iter().zip(&mut ratios) {
            let cost = |point: &Measured| point.cost;
            let auto = found.curve("auto").and_then(|curve| Some((chosen(curve, *target)?, curve.at(*target, cost)?)));
            line += &match (auto, found.best(*target, cost)) {
                (Some((method, cost)), Some((best, least))) => {
                    ratios.push(cost / least);
                    format!("| {method} | {best} | {:.2} ", cost / least)
                }
                (None, Some((best, _))) => format!("| - | {best} | - "),
                _ => "| | | ".to_owned(),
            };
        }
        println!("{line}|");
    }
    println!();
    for (target, mut ratios) in TARGETS.into_iter().zip(ratios) {
        ratios.sort_by(f64::total_cmp);
        let at = |part: f64| ratios.get((part * ratios.len() as f64) as usize).copied().unwrap_or(f64::NAN);
        println!(
            "- {target:.0e}: {} scenes, median {:.2}, nine of ten {:.2}, worst {:.2}",
            ratios.len(),
            at(0.5),
            at(0.9),
            at(1.0 - 1e-9)
        );
    }
}

/// What `auto` stands for where it first reaches an error.
fn chosen(curve: &Curve, error: f64) -> Option<Method> {
    curve.measured().find(|point| point.error <= error).map(|point| point.method)
}
