//! What a run draws, at closer times than those it reports.

use crate::integrate::Segment;
use crate::mechanism::{At, System};

/// Frames of a whole run, fewer where one frame has many numbers.
const MOST_FRAMES: f64 = 2000.0;
const MOST_NUMBERS: f64 = 250_000.0;

/// Points of `description().draw` along a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Frames {
    /// Numbers per frame; nothing is written down where it is 0.
    size: usize,
    start: f64,
    spacing: f64,
    /// Frames lie at start + k·spacing.
    next: u32,
    pub times: Vec<f64>,
    numbers: Vec<f64>,
}

impl Frames {
    /// Frames from `start` to `until`; none if `wanted` is false.
    pub fn new<S: System + ?Sized>(system: &S, wanted: bool, start: f64, until: f64) -> Frames {
        let size = if wanted { system.description().drawing_len() } else { 0 };
        let count = (MOST_NUMBERS / size.max(1) as f64).clamp(100.0, MOST_FRAMES);
        Frames { size, start, spacing: (until - start) / count, ..Frames::default() }
    }

    /// Writes down the frames that lie in an accepted step which ends at t.
    pub fn accept<S: System + ?Sized>(&mut self, system: &S, segment: &Segment<'_>, t: f64, point: &mut [f64]) {
        while self.size > 0 && self.spacing > 0.0 && self.next_time() < t {
            let at = self.next_time();
            segment.evaluate((at - segment.t) / segment.h, point);
            self.write(system, at, point);
            self.next += 1;
        }
    }

    /// Writes down one frame, unless one is there for this time.
    pub fn write<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        if self.size == 0 || self.times.last().is_some_and(|last| *last >= t) {
            return;
        }
        let first = self.numbers.len();
        self.times.push(t);
        self.numbers.resize(first + self.size, f64::NAN);
        system.drawing(At::packed(t, y, system.len()), &mut self.numbers[first..]);
    }

    /// (time, numbers) of each frame.
    pub fn iter(&self) -> impl Iterator<Item = (f64, &[f64])> + Clone {
        self.times.iter().copied().zip(self.numbers.chunks_exact(self.size.max(1)))
    }

    fn next_time(&self) -> f64 {
        self.spacing.mul_add(f64::from(self.next), self.start)
    }
}
