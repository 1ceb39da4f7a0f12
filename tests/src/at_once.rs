//! Many runs at once.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

/// What comes of each of these runs, in their order, on so many threads.
pub fn at_once<T: Send>(runs: Range<u64>, threads: usize, one: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let next = AtomicU64::new(runs.start);
    let work = || {
        let mine = std::iter::from_fn(|| Some(next.fetch_add(1, Ordering::Relaxed)).filter(|run| *run < runs.end));
        mine.map(|run| (run, one(run))).collect::<Vec<_>>()
    };
    let mut all: Vec<(u64, T)> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("a run that panics")).collect()
    });
    all.sort_by_key(|(run, _)| *run);
    all.into_iter().map(|(_, outcome)| outcome).collect()
}
