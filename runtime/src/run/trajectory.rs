//! Dense output of a whole run.

use crate::integrate::Segment;

/// More numbers of dense output than this (400 MB) are not kept.
const MOST_NUMBERS: usize = 50_000_000;

/// Dense output of a whole run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trajectory {
    width: usize,
    pieces_per_step: usize,
    starts: Vec<f64>,
    lengths: Vec<f64>,
    pieces: Vec<f64>,
}

impl Trajectory {
    /// An empty one.
    pub fn new(width: usize, pieces_per_step: usize) -> Self {
        Trajectory { width, pieces_per_step, ..Trajectory::default() }
    }

    /// True when it has grown beyond what is kept.
    pub fn is_full(&self) -> bool {
        self.pieces.len() > MOST_NUMBERS
    }

    /// Appends a step.  Only the first `width` numbers of each piece are kept.
    pub fn push(&mut self, segment: &Segment<'_>) {
        self.starts.push(segment.t);
        self.lengths.push(segment.h);
        for piece in segment.pieces.chunks_exact(segment.width) {
            self.pieces.extend_from_slice(&piece[..self.width]);
        }
    }

    /// The step that contains time t; `None` outside of the run (by more than rounding).
    pub fn find(&self, t: f64) -> Option<Segment<'_>> {
        let last = self.starts.len().checked_sub(1)?;
        let slack = 4.0 * f64::EPSILON * t.abs();
        if !(t >= self.starts[0] - slack && t <= self.starts[last] + self.lengths[last] + slack) {
            return None;
        }
        let index = self.starts.partition_point(|start| *start <= t).saturating_sub(1);
        let size = self.width * self.pieces_per_step;
        Some(Segment {
            t: self.starts[index],
            h: self.lengths[index],
            width: self.width,
            pieces: &self.pieces[index * size..][..size],
        })
    }
}
