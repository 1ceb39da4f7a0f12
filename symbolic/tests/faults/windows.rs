// Where alone some faults act: a strip of a coordinate, a while, and where the motion passes by.

use dalembert_symbolic::expr::Symbol;

use super::engine::Change;
use super::judge::Judge;
use super::moments::Ranges;

/// Strips, whiles and spots within the first scene's motion.
pub fn windows(judge: &Judge) -> Vec<Change> {
    let Some(run) = judge.runs.first() else { return Vec::new() };
    let (Some(last), ranges) = (run.moments.last(), Ranges::of(run)) else { return Vec::new() };
    let n = last.q.len();
    let mut changes = Vec::new();
    let moving: Vec<(usize, f64, f64)> = (0..n)
        .filter_map(|i| {
            let values = run.moments.iter().map(|m| m.q[i].to_f64());
            let (low, high) = values.fold((f64::MAX, f64::MIN), |r, x| (r.0.min(x), r.1.max(x)));
            (high - low > 1e-3 * ranges.q[i]).then_some((i, low, high))
        })
        .take(2)
        .collect();
    for (i, low, high) in &moving {
        let strip = (Symbol::Coordinate(*i as u32), low + 0.60 * (high - low), low + 0.63 * (high - low));
        let words = format!("where coordinate {i} is between {:.3e} and {:.3e}", strip.1, strip.2);
        changes.push(Change::within(", beyond a place", words, vec![strip]));
    }
    if last.t > 0.0 {
        let pulse = (Symbol::Time, 0.41 * last.t, 0.42 * last.t);
        let words = format!("from {:.3e} s to {:.3e} s", pulse.1, pulse.2);
        changes.push(Change::within(", for a while", words, vec![pulse]));
    }
    // One spot: where the motion is after a third of its time, in two coordinates, or in one and time.
    let passed = &run.moments[run.moments.len() / 3];
    let mut spot: Vec<(Symbol, f64, f64)> = Vec::new();
    for (i, low, high) in &moving {
        let (aside, place) = (0.03 * (high - low), passed.q[*i].to_f64());
        spot.push((Symbol::Coordinate(*i as u32), place - aside, place + aside));
    }
    if spot.len() == 1 {
        spot.push((Symbol::Time, passed.t - 0.02 * last.t, passed.t + 0.02 * last.t));
    }
    // Where the motion is too fast to be followed to its end, nobody can say where it passes.
    if spot.len() == 2 && last.t >= 0.01 * run.until {
        let words = format!("where the motion is at {:.3e} s", passed.t);
        changes.push(Change::within(", where the motion passes", words, spot));
    }
    changes
}
