//! What interpreting costs: nanoseconds for the accelerations and for each of their operations, for model files and their sizes.
//!
//! `cargo run --release --example interpreted -p dalembert-symbolic models/chain.yaml n=10`

use std::hint::black_box;
use std::time::Instant;

use dalembert_symbolic::interpret::{At, Interpreter};
use dalembert_symbolic::lower::compile;

/// Evaluations in one time, and times of which the middle one counts.
const EVALUATIONS: u32 = 20_000;
const TIMES: usize = 9;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let sizes: Vec<(String, i64)> = words
        .iter()
        .filter_map(|word| word.split_once('='))
        .filter_map(|(name, size)| Some((name.to_owned(), size.parse().ok()?)))
        .collect();
    println!("{:40} {:>10} {:>8} {:>8}", "file", "operations", "ns", "ns each");
    for file in words.iter().filter(|word| !word.contains('=')) {
        let text = std::fs::read_to_string(file).unwrap_or_default();
        match compile(&text, &sizes) {
            Ok(program) => report(file, Interpreter::new(program)),
            Err(problems) => println!("{file}: {} mistakes", problems.len()),
        }
    }
}

fn report(file: &str, interpreter: Interpreter) {
    let n = interpreter.program().model.coordinates.len();
    let (q, v): (Vec<f64>, Vec<f64>) = (0..n).map(|i| (0.3 + 0.01 * i as f64, 0.1 - 0.02 * i as f64)).unzip();
    let u = vec![0.0; 3 * interpreter.program().model.inputs.len()];
    let mut a = vec![0.0; n];
    let mut spans: Vec<f64> = Vec::new();
    for _ in 0..TIMES {
        let began = Instant::now();
        for _ in 0..EVALUATIONS {
            let at = At { t: 0.0, u: &u, q: black_box(&q), v: black_box(&v), ..At::default() };
            let _ = black_box(interpreter.accelerations(at, black_box(&mut a)));
        }
        spans.push(began.elapsed().as_secs_f64() * 1e9 / f64::from(EVALUATIONS));
    }
    spans.sort_by(f64::total_cmp);
    let (span, operations) = (spans[TIMES / 2], interpreter.operations());
    println!("{file:40} {operations:10} {span:8.0} {:8.2}", span / operations as f64);
}
