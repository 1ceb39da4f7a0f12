//! What one run of many costs: in SIMD lanes, one by one, and by a plain loop over `ode_solvers`; one thread.
//!
//! `RUSTFLAGS="-C target-cpu=native" cargo run --release --bin ensembles` in this folder builds all sides for the
//! processor at hand; without `RUSTFLAGS` they are what everybody gets.  Medians of rounds in turns.

use dalembert::ensemble::{Ensemble, Lanes, f64x4, f64x8};
use dalembert::mechanism::Dynamic;
use dalembert::prelude::*;
use dalembert_benchmarks::{Hand, double_pendulum, figure_eight, kepler, median, rods, timed};
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, SVector};

dalembert::model!("../models/figure_eight.yaml", name = FigureEight);
dalembert::model!("../models/double_pendulum.yaml", name = DoublePendulum);
dalembert::model!("../models/chain.yaml", n = 10, name = Chain);
dalembert::model!(
    yaml = r#"
name: Kepler
parameters: {m: 1, mu: 1}
coordinates: {x: 1, y: 1}
kinetic_energy: m*(x'^2 + y'^2)/2
potential_energy: -m*mu/sqrt(x^2 + y^2)
scene: {start: {x: 1.6, "y'": 0.5}, until: 628, tolerance: 1e-10}
"#
);

const MEMBERS: usize = 256;
const ROUNDS: usize = 15;
const TOLERANCE: f64 = 1e-9;

fn main() {
    println!(
        "| scene, method | one by one, µs | f64x4 | f64x8 | f64x8/one by one | ode_solvers, µs | f64x8: runs/s | error | ode_solvers: error |"
    );
    println!("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    compare("double pendulum", DoublePendulum::default(), 3.0, Method::Dop853, double_pendulum);
    compare("Kepler", Kepler::default(), 62.8, Method::Dop853, kepler);
    compare("Kepler", Kepler::default(), 62.8, Method::Rkn8, kepler);
    compare("figure eight", FigureEight::default(), 10.0, Method::Dop853, figure_eight);
    compare("figure eight", FigureEight::default(), 10.0, Method::Rkn8, figure_eight);
    compare("chain of ten", Chain::default(), 5.0, Method::Dop853, rods::<10, 20>);
}

fn compare<M, const N: usize, const C: usize, const D: usize>(
    name: &str,
    model: M,
    until: f64,
    method: Method,
    f: fn(&SVector<f64, D>, &mut SVector<f64, D>),
) where
    M: Simulate<N, C>,
{
    let first = model.simulate().run().expect("a run").first();
    let moved = |k: usize| {
        let mut q = first.q.clone();
        q[0] += 1e-3 * k as f64 / MEMBERS as f64;
        q
    };
    let one = |k: usize| {
        let simulation = model.simulate().start(&moved(k), &first.v).until(until).tolerance(TOLERANCE);
        simulation.method(method)
    };
    let ensemble: Ensemble<Dynamic<M, N, C>> = (0..MEMBERS).map(one).collect::<Ensemble<_>>().threads(1);
    let plain = |k: usize| {
        one(k)
            .every(until)
            .with(|settings| (settings.dense, settings.watch) = (false, false))
            .run()
            .expect("a run")
            .last()
    };
    let loops = |k: usize| {
        let start = SVector::<f64, D>::from_iterator(moved(k).into_iter().chain(first.v.iter().copied()));
        let mut solver = Dop853::from_param(
            Hand(f),
            0.0,
            until,
            until,
            start,
            TOLERANCE,
            TOLERANCE,
            0.9,
            0.0,
            0.333,
            6.0,
            until,
            0.0,
            10_000_000,
            1000,
            OutputType::Sparse,
        );
        solver.integrate().expect("a run");
        solver.y_out().last().expect("an end").iter().copied().take(N).collect::<Vec<f64>>()
    };
    let mut times = [const { Vec::new() }; 4];
    for _ in 0..ROUNDS {
        times[0].push(timed(|| (0..MEMBERS).map(plain).collect::<Vec<_>>()).0);
        times[1].push(lanes::<M, f64x4, N, C>(&ensemble).0);
        times[2].push(lanes::<M, f64x8, N, C>(&ensemble).0);
        times[3].push(timed(|| (0..MEMBERS).map(loops).collect::<Vec<_>>()).0);
    }
    let [single, four, eight, theirs] = times.map(|times| 1e6 * median(times) / MEMBERS as f64);
    let last = MEMBERS - 1;
    let exact = one(last).tolerance(1e-14).run().expect("a run").last();
    let error = |q: &[f64]| q.iter().zip(&exact.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let own = error(&lanes::<M, f64x8, N, C>(&ensemble).1[last]);
    let other = error(&loops(last));
    println!(
        "| {name}, `{}` | {single:.1} | {four:.1} | {eight:.1} | {:.2} | {theirs:.1} | {:.0} | {own:.0e} | {other:.0e} |",
        method.name(),
        eight / single,
        1e6 / eight
    );
}

fn lanes<M, L, const N: usize, const C: usize>(ensemble: &Ensemble<Dynamic<M, N, C>>) -> (f64, Vec<Vec<f64>>)
where
    M: Simulate<N, C>,
    L: Lanes,
{
    timed(|| ensemble.ends::<L>().into_iter().map(|end| end.expect("an end").state.q).collect())
}
