//! Many runs at once.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

use super::file::{Drawn, draw};
use super::judge::{Verdict, judge};
use super::wider::draw_wider;

/// A run that was drawn and judged.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Its number, from which it is drawn.
    pub run: u64,
    /// What was drawn.
    pub drawn: Drawn,
    /// What came of it.
    pub verdict: Verdict,
}

/// From this one on runs are drawn wider.
const WIDER: u64 = 10_000;

/// The run of a number.
pub fn drawn(run: u64) -> Drawn {
    if run < WIDER { draw(run) } else { draw_wider(run) }
}

/// Draws and judges these runs, on so many threads; `progress` sees each as it is done.  In their order.
pub fn survey(runs: Range<u64>, threads: usize, progress: impl Fn(&Judged) + Sync) -> Vec<Judged> {
    let next = AtomicU64::new(runs.start);
    let work = || {
        let mut done = Vec::new();
        loop {
            let run = next.fetch_add(1, Ordering::Relaxed);
            if run >= runs.end {
                return done;
            }
            let drawn = drawn(run);
            let verdict = judge(&drawn);
            done.push(Judged { run, drawn, verdict });
            done.last().into_iter().for_each(&progress);
        }
    };
    let mut all: Vec<Judged> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("a run that panics")).collect()
    });
    all.sort_by_key(|judged| judged.run);
    all
}
