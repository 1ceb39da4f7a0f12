//! Speed at equal accuracy, against other programs.
//!
//! `cargo run --release --features peers --bin peers FOLDER` in this folder writes two files: `times.csv`, what an error
//! costs by each method, and `ends.csv`, where each scene starts and ends.  `peers.py` reads them, adds what runs in Python
//! and prints the tables.
//!
//! Every program runs at 25 tolerances, in turns, and medians of the rounds are taken, in time of the processor, since the
//! machine may be shared.  Errors are the largest of a coordinate at the end, against this crate at 10⁻¹⁴.

use std::fs::{File, create_dir_all};
use std::io::Write;
use std::path::Path;

use cpu_time::ProcessTime;
use dalembert::prelude::*;
use dalembert_benchmarks::peers::{Curve, Jacobian, Problem, Program, Rates, explicit, implicit};
use dalembert_benchmarks::{double_pendulum, figure_eight, kepler, median, rods, stiff_jacobian, stiff_pendulum};

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
name: StiffPendulum
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, k: 1e6 N/m}
coordinates: {x: m, y: m}
points: {hinge: [0, 0]}
bodies: {bob: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
springs: {rod: {between: [hinge, bob], stiffness: k, rest: l}}
scene: {start: {x: l, y: 0}, until: 2, tolerance: 1e-8}
"#
);
dalembert::model!(
    yaml = r#"
name: DampedPendulum
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, k: 1e6 N/m, d: 2e3 N*s/m}
coordinates: {x: m, y: m}
points: {hinge: [0, 0]}
bodies: {bob: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
springs: {rod: {between: [hinge, bob], stiffness: k, rest: l}}
dampers: {loss: {between: [hinge, bob], damping: d}}
scene: {start: {x: l, y: 0}, until: 2, tolerance: 1e-8}
"#
);

/// Rounds go on for so long, but there are at least five and at most 41 of them.
const SECONDS: f64 = 20.0;
/// Runs that take longer are left out.
const LONGEST: f64 = 1.0;
const ERRORS: [f64; 2] = [1e-6, 1e-9];

fn main() -> std::io::Result<()> {
    let folder = std::env::args().nth(1).expect("a folder to write to");
    create_dir_all(&folder)?;
    let mut bench = Bench::new(Path::new(&folder))?;
    bench.explicit("Kepler", Kepler::default().simulate().until(314.0), kepler)?;
    bench.explicit("double pendulum", DoublePendulum::default().simulate().until(5.0), double_pendulum)?;
    bench.explicit("chain of ten", Chain::default().simulate().until(5.0), rods::<10, 20>)?;
    bench.explicit("figure eight", FigureEight::default().simulate().until(100.0), figure_eight)?;
    let (undamped, damped) = (StiffPendulum::default().simulate(), DampedPendulum::default().simulate());
    bench.implicit("stiff pendulum", undamped, stiff_pendulum::<0>, stiff_jacobian::<0>)?;
    bench.implicit("stiff pendulum, damped", damped, stiff_pendulum::<2000>, stiff_jacobian::<2000>)
}

struct Bench {
    times: File,
    ends: File,
}

impl Bench {
    fn new(folder: &Path) -> std::io::Result<Self> {
        let mut times = File::create(folder.join("times.csv"))?;
        writeln!(times, "scene,program,method,error,seconds")?;
        Ok(Bench { times, ends: File::create(folder.join("ends.csv"))? })
    }

    fn explicit<S: System + Clone + 'static, F: Rates<D>, const D: usize>(
        &mut self,
        name: &str,
        simulation: Simulation<S>,
        f: F,
    ) -> std::io::Result<()> {
        let (problem, end) = reference(&simulation, f);
        let mut programs = own(&simulation, &[Method::Dop853, Method::Auto]);
        programs.extend(explicit(problem));
        self.record(name, &problem, &end, &programs)
    }

    fn implicit<S: System + Clone + 'static, F: Rates<D>, const D: usize>(
        &mut self,
        name: &str,
        simulation: Simulation<S>,
        f: F,
        jacobian: Jacobian<D>,
    ) -> std::io::Result<()> {
        let (problem, end) = reference(&simulation, f);
        let mut programs = own(&simulation, &[Method::Radau5, Method::Rodas5P, Method::Dop853, Method::Auto]);
        programs.extend(implicit(problem, jacobian));
        programs.extend(explicit(problem));
        self.record(name, &problem, &end, &programs)
    }

    fn record<F, const D: usize>(
        &mut self,
        name: &str,
        problem: &Problem<F, D>,
        end: &[f64],
        programs: &[Program],
    ) -> std::io::Result<()> {
        let numbers = problem.start.iter().chain(end).map(f64::to_string).collect::<Vec<_>>().join(",");
        writeln!(self.ends, "{name:?},{},{numbers}", problem.until)?;
        for (program, curve) in programs.iter().zip(curves(programs, end)) {
            for error in ERRORS {
                if let Some(seconds) = curve.time(error) {
                    println!("{name}, {} {}: {:.1} µs at {error:e}", program.name, program.method, 1e6 * seconds);
                    writeln!(self.times, "{name:?},{},{:?},{error:e},{seconds:e}", program.name, program.method)?;
                }
            }
        }
        Ok(())
    }
}

/// The problem as others get it, and the coordinates at its end.
fn reference<S: System + Clone, F, const D: usize>(simulation: &Simulation<S>, f: F) -> (Problem<F, D>, Vec<f64>) {
    let run = plain(simulation).method(Method::Dop853).tolerance(1e-14).run().expect("a run");
    let (first, last) = (run.first(), run.last());
    let start: Vec<f64> = first.q.iter().chain(&first.v).copied().collect();
    (Problem { f, start: start.try_into().expect("as many numbers"), until: last.t }, last.q.clone())
}

/// Without dense output and watching, as other programs are without them.
fn plain<S: System + Clone>(simulation: &Simulation<S>) -> Simulation<S> {
    simulation.clone().every(1e9).with(|settings| (settings.dense, settings.watch) = (false, false))
}

fn own<S: System + Clone + 'static>(simulation: &Simulation<S>, methods: &[Method]) -> Vec<Program> {
    let program = |&method: &Method| {
        let simulation = plain(simulation).method(method);
        Program::new("dalembert", method.name(), move |tolerance| {
            let last = simulation.clone().tolerance(tolerance).run().ok()?.last();
            Some(last.q.clone())
        })
    };
    methods.iter().map(program).collect()
}

/// What errors cost, program by program.
fn curves(programs: &[Program], end: &[f64]) -> Vec<Curve> {
    let mut runs: Vec<Vec<Tried>> = programs.iter().map(|program| tried(program, end)).collect();
    let round: f64 = runs.iter().flatten().map(|run| run.times[0]).sum();
    for _ in 0..(SECONDS / round).clamp(4.0, 40.0) as usize {
        for (program, runs) in programs.iter().zip(&mut runs) {
            runs.iter_mut().for_each(|run| run.times.push(timed(|| (program.run)(run.tolerance)).0));
        }
    }
    let curve = |runs: Vec<Tried>| Curve::new(runs.into_iter().map(|run| (run.error, median(run.times))).collect());
    runs.into_iter().map(curve).collect()
}

/// A tolerance, what came of it and what it took.
struct Tried {
    tolerance: f64,
    error: f64,
    times: Vec<f64>,
}

/// A program at every tolerance at which it comes to the end, in time.
fn tried(program: &Program, end: &[f64]) -> Vec<Tried> {
    let mut runs = vec![];
    for tolerance in (4..=28).map(|i| 10_f64.powf(-0.5 * f64::from(i))) {
        let (seconds, found) = timed(|| (program.run)(tolerance));
        if let Some(found) = found {
            let error = found.iter().zip(end).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            runs.push(Tried { tolerance, error, times: vec![seconds] });
        }
        if seconds > LONGEST {
            break;
        }
    }
    runs
}

/// How many seconds of the processor this takes, of all threads, and what it gives.
fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let clock = ProcessTime::now();
    let result = work();
    (clock.elapsed().as_secs_f64(), result)
}
