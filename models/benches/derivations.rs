//! Nanoseconds per evaluation of the accelerations: Lagrange's equations against each system of momentum balances.
//!
//! `cargo bench -p dalembert-models --bench derivations`.  All derivations of a model are timed in turns in one run,
//! each call depends on the last, and the medians of 31 rounds are compared, since the machine may be shared.

use std::hint::black_box;
use std::time::Instant;

use dalembert::mechanism::{At, Dynamic, Mechanism, System};

dalembert::model!("chain.yaml", n = 5, name = Chain5);
dalembert::model!("chain.yaml", n = 20, name = Chain20);

fn main() {
    println!("| model | derivation | equations | ns | ratio |\n| --- | --- | ---: | ---: | ---: |");
    for name in ["simple_pendulum", "bead_parabola", "double_pendulum", "triple_pendulum", "figure_eight", "chain"] {
        let entry = dalembert_models::MODELS.iter().find(|entry| entry.name == name);
        compare(name, (entry.expect("a model of the library").compiled.expect("its code"))());
    }
    compare("chain, n = 5", erased::<Chain5, 5>());
    compare("chain, n = 20", erased::<Chain20, 20>());
}

fn erased<M: Mechanism<N, 0> + Default + 'static, const N: usize>() -> Box<dyn System> {
    Box::new(Dynamic::new(M::default()))
}

fn compare(name: &str, mut system: Box<dyn System>) {
    let names: Vec<String> = system.description().balances.iter().map(|s| s.name.to_string()).collect();
    let mut times = vec![Vec::new(); names.len() + 1];
    for _ in 0..31 {
        for (k, times) in times.iter_mut().enumerate() {
            system.set_derivation(k.checked_sub(1));
            times.push(nanoseconds(&*system));
        }
    }
    let medians: Vec<f64> = times.into_iter().map(median).collect();
    println!("| {name} | Lagrange | {} | {:.1} | 1 |", system.len(), medians[0]);
    for ((derivation, time), balances) in names.iter().zip(&medians[1..]).zip(system.description().balances.iter()) {
        println!("| | {derivation} | {} | {time:.1} | {:.2} |", balances.unknowns.len(), time / medians[0]);
    }
}

/// Per call, over some tenths of a millisecond; the state moves with the result.
fn nanoseconds(system: &dyn System) -> f64 {
    let n = system.len();
    let calls = 20_000 / (n * n) + 10;
    let scene = system.scene(0);
    let mut q = scene.q;
    // Nothing is at rest, where power says nothing.
    let v: Vec<f64> = scene.v.iter().enumerate().map(|(i, v)| v + 0.1 * (1.0 + i as f64)).collect();
    let mut a = vec![0.0; n];
    let start = Instant::now();
    for _ in 0..calls {
        system.accelerations(At::new(0.0, &q, &v), &mut a).expect("accelerations");
        q[n - 1] += 1e-9 * a[0];
    }
    let elapsed = start.elapsed().as_secs_f64();
    black_box(a);
    1e9 * elapsed / calls as f64
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
