//! Random runs, judged by runs with bounded steps, as the page `docs/random-runs.md`:
//! `cargo run --release -p dalembert-tests --example random_runs > docs/random-runs.md`
//!
//! With a number: only so many; with two: those from the first up to the second. With `one` and a number: that run's
//! file and verdict.

use dalembert_tests::random_runs::{Judged, Verdict, draw, judge, survey};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |text: &String| text.parse::<u64>().unwrap_or_else(|_| panic!("`{text}` is no number"));
    let runs = match arguments.as_slice() {
        [word, run] if word == "one" => {
            let drawn = draw(number(run));
            println!("{}{:#?}", drawn.text, judge(&drawn));
            return;
        }
        [] => 0..10_000,
        [many] => 0..number(many),
        [first, end, ..] => number(first)..number(end),
    };
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let judged = survey(runs, threads, |judged| {
        if !matches!(judged.verdict, Verdict::Right { .. }) {
            let Judged { run, drawn, verdict } = judged;
            eprintln!("{run}: {}, {:?}, {:?}: {verdict:?}", drawn.mechanism, drawn.features, drawn.event);
        }
    });
    println!("{}", judged.len());
}
