//! Nanoseconds per evaluation of accelerations: the generated Rust beside what `export --c` writes, built by the C compiler at hand.
//!
//! `cargo bench -p dalembert-models --features compiled --bench exported`.  Both are optimised as a whole (`lto`, `-flto`) and run in turns, in
//! processes of their own, each call depends on the last, and medians are compared, since the machine may be shared.

use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use dalembert::mechanism::Mechanism;

dalembert::model!("double_pendulum.yaml", name = DoublePendulum);
dalembert::model!("heavy_top.yaml", name = HeavyTop);
dalembert::model!("chain.yaml", n = 5, name = Chain5);
dalembert::model!("chain.yaml", n = 10, name = Chain10);

/// Rounds of which the median is taken, and evaluations in each.
const ROUNDS: usize = 31;
const CALLS: usize = 20_000;

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    println!("| model | Rust, ns | C, ns | C/Rust |\n| --- | ---: | ---: | ---: |");
    compare::<DoublePendulum, 2>("double_pendulum", None)?;
    compare::<HeavyTop, 3>("heavy_top", None)?;
    compare::<Chain5, 5>("chain", Some("n=5"))?;
    compare::<Chain10, 10>("chain", Some("n=10"))
}

fn compare<M: Mechanism<N, 0> + Default, const N: usize>(name: &str, size: Option<&str>) -> Outcome<()> {
    let folder = std::env::temp_dir().join(format!("dalembert-exported-{}", std::process::id()));
    let program = build(name, size, N, &folder)?;
    let (mut rust, mut c) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        rust.push(nanoseconds::<M, N>());
        c.push(String::from_utf8(Command::new(&program).output()?.stdout)?.trim().parse::<f64>()?);
    }
    fs::remove_dir_all(folder)?;
    let (rust, c) = (median(rust), median(c));
    println!("| {name} {} | {rust:.1} | {c:.1} | {:.2} |", size.unwrap_or_default(), c / rust);
    Ok(())
}

/// A program that prints what an evaluation takes.
fn build(name: &str, size: Option<&str>, coordinates: usize, folder: &Path) -> Outcome<std::path::PathBuf> {
    let model = format!("{}/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
    let to = folder.to_str().ok_or("a temporary folder without a name")?;
    let size = size.map(|size| format!("--size={size}"));
    let arguments = ["dalembert", "export", &model, "--c", to].into_iter().chain(size.as_deref());
    dalembert::cli::run(&[], arguments.collect::<Vec<_>>(), &mut Vec::new()).map_err(|problem| problem.to_string())?;
    let (main, program) = (folder.join("main.c"), folder.join("main"));
    fs::write(
        &main,
        TIMED
            .replace("NAME", name)
            .replace("COORDINATES", &coordinates.to_string())
            .replace("CALLS", &CALLS.to_string()),
    )?;
    let sources = [main, folder.join(format!("{name}.c")), folder.join("dalembert_core.c")];
    let built = Command::new("cc").args(["-O3", "-flto", "-o"]).arg(&program).args(sources).arg("-lm").status()?;
    if built.success() { Ok(program) } else { Err(format!("cc: {built}").into()) }
}

/// What `nanoseconds` does, in C.
const TIMED: &str = r#"
#include "NAME.h"
#include <stdio.h>
#include <time.h>
static double now(void) {
    struct timespec t;
    timespec_get(&t, TIME_UTC);
    return 1e9*(double)t.tv_sec + (double)t.tv_nsec;
}
static double c[65536];
int main(void) {
    static double u[64], l[64], q[COORDINATES], v[COORDINATES], a[COORDINATES];
    NAME_parameters p;
    NAME_defaults(&p);
    NAME_constants(&p, c);
    double start = 0.0;
    /* The first round finds the functions of libm, and pages that are not there yet. */
    for (int round = 0; round < 2; round++) {
        for (int i = 0; i < COORDINATES; i++) { q[i] = 0.4; v[i] = 0.2; }
        start = now();
        for (int k = 0; k < CALLS; k++) {
            NAME_accelerations(c, 0.0, u, q, v, a, l);
            for (int i = 0; i < COORDINATES; i++) q[i] += 1e-9*a[i];
        }
    }
    printf("%.17g\n", (now() - start)/CALLS);
    return 0;
}
"#;

fn nanoseconds<M: Mechanism<N, 0> + Default, const N: usize>() -> f64 {
    let constants = M::constants::<f64>(|_| M::default());
    let (mut q, v, mut a) = ([0.4; N], [0.2; N], [0.0; N]);
    let start = Instant::now();
    for _ in 0..CALLS {
        // C, in a file of its own, reads the speeds at each call, too.
        let v = black_box(&v);
        M::accelerations::<f64>(&constants, 0.0, &[], &q, v, &mut a).expect("the mass matrix is regular");
        q.iter_mut().zip(&a).for_each(|(q, a)| *q += 1e-9 * a);
    }
    let elapsed = start.elapsed().as_secs_f64();
    black_box(q);
    1e9 * elapsed / CALLS as f64
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
