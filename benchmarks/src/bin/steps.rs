//! What a step costs: `dop853` and `taylor` of this crate on generated equations, and `rkn8` where it suits, against `DOP853` of `ode_solvers` on
//! equations written by hand.
//!
//! `cargo run --release --bin steps` in this folder.  All variants run in turns, and medians of the rounds are given, since the
//! machine may be shared; counts are steadier still: `valgrind --tool=callgrind target/release/steps
//! SCENE plain`, or `watched`, counts instructions of one run, by `dop853` or the method named after it.
//!
//! - *plain* keeps no dense output, watches nothing and reports the end; *watched* is what `simulate` does, but for the
//!   companion that counts digits, and for the rows of a report.
//! - *at equal error*: evaluations over a series of tolerances, read at the errors of the other's runs, times what an
//!   evaluation costs with the step around it.  Errors are those of the state at the end against this crate at 10⁻¹⁴.
//! - *watched/plain* is per evaluation, so that those of the dense output and of its defect, which are counted, do not
//!   enter.

use dalembert::prelude::*;
use dalembert_benchmarks::{Hand, double_pendulum, figure_eight, kepler, median, rods, stiff_spring, timed};
use nalgebra::{DMatrix, DVector};
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, SVector};

dalembert::model!("../models/figure_eight.yaml", name = FigureEight, methods = "taylor");
dalembert::model!("../models/double_pendulum.yaml", name = DoublePendulum, methods = "taylor");
dalembert::model!("../models/chain.yaml", n = 10, name = Chain, methods = "taylor");
dalembert::model!(
    yaml = r#"
name: Kepler
parameters: {m: 1, mu: 1}
coordinates: {x: 1, y: 1}
kinetic_energy: m*(x'^2 + y'^2)/2
potential_energy: -m*mu/sqrt(x^2 + y^2)
scene: {start: {x: 1.6, "y'": 0.5}, until: 628, tolerance: 1e-10}
"#,
    methods = "taylor"
);
dalembert::model!(
    yaml = r#"
name: StiffSpring
parameters: {m: 1, k: 1e5, l: 1, g: 10}
coordinates: {x: 1, y: 1}
kinetic_energy: m*(x'^2 + y'^2)/2
potential_energy: k*(sqrt(x^2 + y^2) - l)^2/2 + m*g*y
scene: {start: {x: 1.0, y: 0.0}, until: 2.5, tolerance: 1e-10}
"#,
    methods = "taylor"
);

/// What an evaluation costs is measured at this tolerance.
const TOLERANCE: f64 = 1e-10;
const ROUNDS: usize = 61;
/// Set-up is timed so many times.
const STARTS: u32 = 1000;

fn main() {
    let only = std::env::args().nth(1);
    let once = std::env::args().nth(2);
    let once = once.as_deref();
    let by = std::env::args().nth(3).map(|name| name.parse::<Method>().expect("a method"));
    for method in [Method::Dop853, Method::Rkn8, Method::Taylor]
        .into_iter()
        .filter(|method| once.is_none() || *method == by.unwrap_or(Method::Dop853))
    {
        table(method, only.as_deref(), once);
    }
}

fn table(method: Method, only: Option<&str>, once: Option<&str>) {
    let wanted = |name: &str| only.is_none_or(|only| only == name);
    if once.is_none() {
        println!("\n{method}:\n");
        println!(
            "| scene | evaluations | ns each | ode_solvers: evaluations | ns each | evaluations at equal error | time at equal \
             error | watched/plain | set-up, µs |"
        );
        println!("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    }
    if wanted("figure_eight") {
        compare("figure eight", FigureEight::default().simulate().until(100.0), figure_eight, method, once);
    }
    if wanted("kepler") {
        compare("Kepler", Kepler::default().simulate().until(628.0), kepler, method, once);
    }
    if wanted("stiff_spring") {
        compare("stiff spring", StiffSpring::default().simulate(), stiff_spring, method, once);
    }
    if method == Method::Rkn8 {
        return;
    }
    if wanted("double_pendulum") {
        compare("double pendulum", DoublePendulum::default().simulate().until(10.0), double_pendulum, method, once);
    }
    if wanted("chain") {
        compare("chain of ten", Chain::default().simulate().until(5.0), rods::<10, 20>, method, once);
    }
}

fn compare<S: System + Clone, const D: usize>(
    name: &str,
    simulation: Simulation<S>,
    f: fn(&SVector<f64, D>, &mut SVector<f64, D>),
    method: Method,
    once: Option<&str>,
) {
    let simulation = simulation.method(method).every(1e9);
    let plain = simulation.clone().with(|settings| (settings.dense, settings.watch) = (false, false));
    let tried = |tolerance: f64| plain.clone().tolerance(tolerance).run();
    let ours = |tolerance: f64| tried(tolerance).expect("a run");
    if let Some(kind) = once {
        let run = if kind == "plain" { ours(TOLERANCE) } else { simulation.tolerance(TOLERANCE).run().expect("a run") };
        println!("{name}: {} evaluations", run.work.evaluations);
        return;
    }
    let exact = ours(1e-14);
    let (first, last) = (exact.first(), exact.last());
    let start = SVector::<f64, D>::from_iterator(first.q.iter().chain(&first.v).copied());
    let theirs = |tolerance: f64| {
        let mut solver = Dop853::from_param(
            Hand(f),
            0.0,
            last.t,
            last.t,
            start,
            tolerance,
            tolerance,
            0.9,
            0.0,
            0.333,
            6.0,
            last.t,
            0.0,
            10_000_000,
            1000,
            OutputType::Sparse,
        );
        let stats = solver.integrate().expect("a run");
        let end: Vec<f64> = solver.y_out().last().expect("an end").iter().copied().collect();
        (stats.num_eval as u64, end)
    };
    let error = |q: &[f64]| q.iter().zip(&last.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);

    // What an evaluation costs with the step around it, ns.
    let (mut costs, mut watched, mut against) = (vec![], vec![], vec![]);
    for _ in 0..ROUNDS {
        let (seconds, run) = timed(|| ours(TOLERANCE));
        let own = 1e9 * seconds / run.work.evaluations as f64;
        let (seconds, (evaluations, _)) = timed(|| theirs(TOLERANCE));
        against.push(1e9 * seconds / evaluations as f64);
        let (seconds, run) = timed(|| simulation.clone().tolerance(TOLERANCE).run().expect("a run"));
        watched.push(1e9 * seconds / run.work.evaluations as f64 / own);
        costs.push(own);
    }
    let (cost, watched, against) = (median(costs), median(watched), median(against));

    // Evaluations at the errors of the other's runs.
    let tolerances = (4..=24).map(|i| 10_f64.powf(-0.5 * f64::from(i)));
    let curve: Vec<(f64, f64)> = tolerances
        .clone()
        .filter_map(|tolerance| {
            // At the loosest of them three bodies may meet.
            let run = tried(tolerance).ok()?;
            Some((error(&run.last().q).ln(), (run.work.evaluations as f64).ln()))
        })
        .collect();
    let line = fit(&curve);
    let more = tolerances.filter(|tolerance| (1e-10..=1e-5).contains(tolerance)).map(|tolerance| {
        let (evaluations, end) = theirs(tolerance);
        line(error(&end).ln()).exp() / evaluations as f64
    });
    let more = median(more.collect());

    let shortest = plain.clone().tolerance(1e-2).until(1e-9);
    let starts = (0..STARTS).map(|_| timed(|| shortest.clone().run().expect("a run")));
    let start =
        median(starts.map(|(seconds, run)| 1e6 * seconds - 1e-3 * cost * run.work.evaluations as f64).collect());
    let (own, (evaluations, _)) = (ours(TOLERANCE).work.evaluations, theirs(TOLERANCE));
    println!(
        "| {name} | {own} | {cost:.1} | {evaluations} | {against:.1} | {more:.2} | {:.2} | {watched:.2} | {start:.1} |",
        more * cost / against,
    );
}

/// The parabola of least squares through these points: work over error, both as logarithms.
fn fit(points: &[(f64, f64)]) -> impl Fn(f64) -> f64 {
    let points: Vec<_> = points.iter().filter(|(x, _)| x.is_finite()).collect();
    let row = |x: f64| [1.0, x, x * x];
    let matrix = DMatrix::from_fn(points.len(), 3, |i, j| row(points[i].0)[j]);
    let values = DVector::from_iterator(points.len(), points.iter().map(|point| point.1));
    let found = matrix.svd(true, true).solve(&values, 1e-12).expect("a parabola");
    move |x| row(x).iter().zip(found.iter()).map(|(power, factor)| power * factor).sum()
}
