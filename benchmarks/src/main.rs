//! What a step costs: `dop853` of this crate on generated equations against `ode_solvers` on equations written by hand.
//!
//! `cargo run --release` in this folder.  All variants run in turns, and the least of the rounds is given, since the
//! machine may be shared; CPU time is steadier still: `valgrind --tool=callgrind target/release/dalembert-benchmarks
//! SCENE plain` counts instructions of one scene.
//!
//! "plain" keeps no dense output, watches nothing and reports the end; "default" is what `simulate` does.  Errors are
//! those of the state at the end against this crate at 10⁻¹⁴.

use std::time::Instant;

use dalembert::prelude::*;
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, SVector, System as Equations};

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
dalembert::model!(
    yaml = r#"
name: StiffSpring
parameters: {m: 1, k: 1e5, l: 1, g: 10}
coordinates: {x: 1, y: 1}
kinetic_energy: m*(x'^2 + y'^2)/2
potential_energy: k*(sqrt(x^2 + y^2) - l)^2/2 + m*g*y
scene: {start: {x: 1.0, y: 0.0}, until: 2.5, tolerance: 1e-10}
"#
);

const TOLERANCE: f64 = 1e-10;
const ROUNDS: usize = 15;

fn main() {
    let only = std::env::args().nth(1);
    let plain = std::env::args().nth(2).is_some();
    let wanted = |name: &str| only.as_deref().is_none_or(|only| only == name);
    if !plain {
        println!("| scene | evaluations | ns each | ode_solvers: evaluations | ns each | plain/ode_solvers | default/plain | error | ode_solvers: error |");
        println!("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    }
    if wanted("figure_eight") {
        compare("figure eight", FigureEight::default().simulate().until(10.0), figure_eight, plain);
    }
    if wanted("kepler") {
        compare("Kepler", Kepler::default().simulate().until(628.0), kepler, plain);
    }
    if wanted("stiff_spring") {
        compare("stiff spring", StiffSpring::default().simulate(), stiff_spring, plain);
    }
    if wanted("double_pendulum") {
        compare("double pendulum", DoublePendulum::default().simulate().until(10.0), double_pendulum, plain);
    }
    if wanted("chain") {
        compare("chain of ten", Chain::default().simulate().until(5.0), rods::<10, 20>, plain);
    }
}

fn compare<S: System + Clone, const D: usize>(
    name: &str,
    simulation: Simulation<S>,
    f: fn(&SVector<f64, D>, &mut SVector<f64, D>),
    plain_only: bool,
) {
    let run = |plain: bool, tolerance: f64| {
        let simulation = simulation.clone().tolerance(tolerance).method(Method::Dop853);
        let simulation = match plain {
            true => simulation.every(1e9).with(|s| (s.dense, s.watch) = (false, false)),
            false => simulation,
        };
        let clock = Instant::now();
        let run = simulation.run().expect("a run");
        (clock.elapsed().as_secs_f64(), run)
    };
    if plain_only {
        println!("{name}: {} evaluations", run(true, TOLERANCE).1.work.evaluations);
        return;
    }
    let first = run(true, TOLERANCE).1.first();
    let start = SVector::<f64, D>::from_iterator(first.q.iter().chain(&first.v).copied());
    let until = run(true, 1e-3).1.last().t;
    let theirs = || {
        let clock = Instant::now();
        let mut solver = Dop853::from_param(
            Hand(f), 0.0, until, until, start, TOLERANCE, TOLERANCE, 0.9, 0.0, 0.333, 6.0, until, 0.0, 10_000_000, 1000,
            OutputType::Sparse,
        );
        let stats = solver.integrate().expect("a run");
        let end: Vec<f64> = solver.y_out().last().expect("an end").iter().copied().collect();
        (clock.elapsed().as_secs_f64(), stats.num_eval, end)
    };
    let mut least = [f64::INFINITY; 3];
    for _ in 0..ROUNDS {
        least[0] = least[0].min(run(true, TOLERANCE).0);
        least[1] = least[1].min(theirs().0);
        least[2] = least[2].min(run(false, TOLERANCE).0);
    }
    let (ours, (_, evaluations, end)) = (run(true, TOLERANCE).1, theirs());
    let exact = run(true, 1e-14).1.last();
    let error = |q: &[f64]| q.iter().zip(&exact.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!(
        "| {name} | {} | {:.1} | {evaluations} | {:.1} | {:.2} | {:.2} | {:.1e} | {:.1e} |",
        ours.work.evaluations,
        1e9 * least[0] / ours.work.evaluations as f64,
        1e9 * least[1] / f64::from(evaluations),
        least[0] / least[1],
        least[2] / least[0],
        error(&ours.last().q),
        error(&end),
    );
}

/// Equations of motion that a person wrote.
struct Hand<const D: usize>(fn(&SVector<f64, D>, &mut SVector<f64, D>));

impl<const D: usize> Equations<f64, SVector<f64, D>> for Hand<D> {
    fn system(&self, _: f64, y: &SVector<f64, D>, rate: &mut SVector<f64, D>) {
        (self.0)(y, rate);
    }
}

fn figure_eight(y: &SVector<f64, 12>, rate: &mut SVector<f64, 12>) {
    let mut a = [0.0; 6];
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let (dx, dy) = (y[j] - y[i], y[3 + j] - y[3 + i]);
        let square = dx * dx + dy * dy;
        let factor = 1.0 / (square * square.sqrt());
        a[i] += factor * dx;
        a[j] -= factor * dx;
        a[3 + i] += factor * dy;
        a[3 + j] -= factor * dy;
    }
    for i in 0..6 {
        (rate[i], rate[6 + i]) = (y[6 + i], a[i]);
    }
}

fn kepler(y: &SVector<f64, 4>, rate: &mut SVector<f64, 4>) {
    let square = y[0] * y[0] + y[1] * y[1];
    let factor = -1.0 / (square * square.sqrt());
    (rate[0], rate[1], rate[2], rate[3]) = (y[2], y[3], factor * y[0], factor * y[1]);
}

fn stiff_spring(y: &SVector<f64, 4>, rate: &mut SVector<f64, 4>) {
    let factor = 1e5 * (1.0 / (y[0] * y[0] + y[1] * y[1]).sqrt() - 1.0);
    (rate[0], rate[1], rate[2], rate[3]) = (y[2], y[3], factor * y[0], factor * y[1] - 10.0);
}

fn double_pendulum(y: &SVector<f64, 4>, rate: &mut SVector<f64, 4>) {
    let (sine, cosine) = (y[0] - y[1]).sin_cos();
    let (m11, m12, m22) = (4.0 / 3.0, 0.5 * cosine, 1.0 / 3.0);
    let f1 = -0.5 * sine * y[3] * y[3] - 15.0 * y[0].sin();
    let f2 = 0.5 * sine * y[2] * y[2] - 5.0 * y[1].sin();
    let factor = 1.0 / (m11 * m22 - m12 * m12);
    (rate[0], rate[1]) = (y[2], y[3]);
    (rate[2], rate[3]) = (factor * (m22 * f1 - m12 * f2), factor * (m11 * f2 - m12 * f1));
}

/// A chain of uniform rods in absolute angles: M in product form, LDLᵀ.
fn rods<const N: usize, const D: usize>(y: &SVector<f64, D>, rate: &mut SVector<f64, D>) {
    let (mut s, mut c, mut a) = ([0.0; N], [0.0; N], [0.0; N]);
    for i in 0..N {
        (s[i], c[i]) = y[i].sin_cos();
    }
    let mut mass = [[0.0; N]; N];
    for i in 0..N {
        let beyond = (N - 1 - i) as f64;
        mass[i][i] = 1.0 / 3.0 + beyond;
        a[i] = -10.0 * (0.5 + beyond) * s[i];
    }
    for i in 0..N {
        let k = 0.5 + (N - 1 - i) as f64;
        for j in 0..i {
            mass[i][j] = k * (c[i] * c[j] + s[i] * s[j]);
            let turning = k * (s[i] * c[j] - c[i] * s[j]);
            a[i] -= turning * y[N + j] * y[N + j];
            a[j] += turning * y[N + i] * y[N + i];
        }
    }
    for i in 0..N {
        for j in 0..i {
            for k in 0..j {
                mass[i][j] -= mass[i][k] * mass[j][k];
            }
        }
        for j in 0..i {
            let factor = mass[i][j] * mass[j][j];
            mass[i][i] -= factor * mass[i][j];
            mass[i][j] = factor;
            a[i] -= factor * a[j];
        }
        mass[i][i] = 1.0 / mass[i][i];
    }
    for i in (0..N).rev() {
        a[i] *= mass[i][i];
        for j in i + 1..N {
            a[i] -= mass[j][i] * a[j];
        }
    }
    for i in 0..N {
        (rate[i], rate[N + i]) = (y[N + i], a[i]);
    }
}
