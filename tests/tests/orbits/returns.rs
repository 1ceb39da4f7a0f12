//! Charts of motions that repeat: how far methods miss the start each time that they should be back.

use dalembert::precision::{Arithmetic, Candidate, Plan, WorkPrecision};
use dalembert::prelude::*;
use dalembert_models::MODELS;

dalembert::model!("orbits/cubic.yaml", name = Swing);

/// The largest error of a run by a method, measured by returns of the motion that `orbit` finds.
fn measured(methods: &[Method], periods: usize) -> WorkPrecision {
    let orbit = Swing::default().simulate().orbit().find().expect("a motion");
    let system = Swing::default().system();
    let settings = Settings::new(&system.scene(0));
    let of = |method: &Method| {
        let mut settings = settings.clone();
        settings.method = *method;
        Candidate::new(method.name(), &system, settings)
    };
    let candidates: Vec<Candidate> = methods.iter().map(of).collect();
    let plan = Plan { repetitions: 1, ..Plan::default() };
    let found =
        WorkPrecision::of_returns(&orbit, periods, &candidates, &plan, &mut |_| std::ops::ControlFlow::Continue(()));
    found.expect("charts")
}

/// Tight runs are back to within what is known of the start; errors of a symplectic method grow with the number of rounds, since its energy does not
/// drift (Hairer, Lubich and Wanner, Geometric Numerical Integration, 2006, section X.3).
#[test]
fn errors_of_a_symplectic_method_grow_with_the_rounds() {
    let found = measured(&[Method::Verlet], 40);
    assert!(matches!(found.reference.arithmetic, Arithmetic::Returns { periods: 40, .. }));
    assert_eq!(found.reference.times().len(), 41);
    assert!(found.reference.digits() >= 10, "{}", found.reference.digits());
    // Of the finest run: the growth from ten rounds to forty.
    let finest = found.curves[0].measured().last().expect("a point");
    let power = (finest.growth[40] / finest.growth[10]).log2() / 2.0;
    assert!((power - 1.0).abs() < 0.1, "{power}");
    let exact = measured(&[Method::Dop853], 40);
    let best = exact.curves[0].measured().map(|point| point.error).fold(f64::INFINITY, f64::min);
    assert!(best < 1e-11, "{best}");
}

/// What events change, and what grows until nothing is known, is refused with the reason.
#[test]
fn motions_whose_returns_are_not_known_are_refused() {
    let told = |arguments: &[&str]| {
        let table = std::env::temp_dir().join(format!("dalembert-returns-{}.csv", std::process::id()));
        let plot = table.with_extension("svg");
        let files = ["-o", table.to_str().expect("a path"), "--plot", plot.to_str().expect("a path")];
        let all = [&["dalembert", "chart"], arguments, &files].concat();
        dalembert::cli::run(MODELS, all, &mut Vec::new()).expect_err("a refusal").to_string()
    };
    let stops = told(&["stick_slip", "--returns", "10"]);
    assert!(stops.contains("`loose_back` changes the motion"), "{stops}");
    // Of the second family, at 8.3 J above rest: changes grow by a half each time.
    let start = ["--start", "theta1=-0.772602663926311", "--start", "theta2=1.3778914476255206"];
    let unstable = told(&[&["double_pendulum", "--returns", "100"], &start[..]].concat());
    assert!(unstable.contains("of 100 periods fewer than eight digits"), "{unstable}");
}
