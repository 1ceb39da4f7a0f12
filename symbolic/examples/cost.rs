//! What deriving and judging cost: milliseconds for every model file of a folder (`models` if none is given).
//!
//! `cargo run --release --example cost -p dalembert-symbolic [FOLDER]`

use std::time::Instant;

use dalembert_symbolic::derive::derive;
use dalembert_symbolic::file::render;
use dalembert_symbolic::gate::judge;
use dalembert_symbolic::lower::lower;
use dalembert_symbolic::model::load;

fn main() {
    let folder =
        std::env::args().nth(1).unwrap_or_else(|| concat!(env!("CARGO_MANIFEST_DIR"), "/../models").to_owned());
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{folder}: {error}"));
    let mut files: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "yaml"));
    files.sort();
    let mut sums = [0.0; 4];
    println!("{:28} {:>8} {:>8} {:>8} {:>8} {:>7}", "model", "load", "derive", "judge", "lower", "states");
    for file in files {
        let name = file.file_stem().map_or(String::new(), |name| name.to_string_lossy().into_owned());
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let mut marks = vec![Instant::now()];
        let mut states = 0;
        let outcome = load(&text, &[])
            .inspect(|_| marks.push(Instant::now()))
            .and_then(derive)
            .inspect(|_| marks.push(Instant::now()))
            .and_then(judge)
            .inspect(|judged| {
                states = judged.report.states.len();
                marks.push(Instant::now());
            })
            .and_then(lower);
        marks.push(Instant::now());
        let spans: Vec<f64> = marks.windows(2).map(|w| (w[1] - w[0]).as_secs_f64() * 1e3).collect();
        for (sum, span) in sums.iter_mut().zip(&spans) {
            *sum += span;
        }
        let words: Vec<String> = spans.iter().map(|span| format!("{span:8.2}")).collect();
        println!("{name:28} {} {states:7}", words.join(" "));
        if let Err(problems) = outcome {
            println!("{}", render(&name, &text, &problems));
        }
    }
    println!("{:28} {}", "sum", sums.map(|sum| format!("{sum:8.2}")).join(" "));
}
