//! Many runs at once.

use std::ops::Range;

use super::file::{Drawn, draw};
use super::judge::{Verdict, judge};
use super::wider::draw_wider;
use crate::at_once::at_once;

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
    at_once(runs, threads, |run| {
        let drawn = drawn(run);
        let verdict = judge(&drawn);
        let judged = Judged { run, drawn, verdict };
        progress(&judged);
        judged
    })
}
