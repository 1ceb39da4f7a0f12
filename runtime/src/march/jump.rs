//! Jumps of the acceleration that the model does not declare.

use crate::integrate::larger;

/// Notices jumps of the acceleration, and steps so short that the run would never end.
///
/// Discontinuities that a model declares are switched at, so that steps never see them.  What is left is a
/// force along a direction that is lost, as `unit(velocity(puck))` where the puck comes to rest: the step
/// collapses there, and the acceleration jumps across it.
#[derive(Clone, Debug)]
pub(crate) struct JumpDetector {
    /// The length of steps before they collapsed, s.
    calm: f64,
    /// Change of the acceleration per time over the last step.
    pace: f64,
    /// Steps shorter than this, s, count as a stall.
    shortest: f64,
    short: u32,
}

/// What is wrong with a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Upset {
    /// The acceleration of this coordinate jumps.
    Jump(usize),
    /// The steps stay too short.
    Stall,
}

/// So many times shorter than before is a collapse.
const COLLAPSE: f64 = 1e-3;
/// So many times faster than over the step before, the acceleration does not change but by a jump.
const SUDDEN: f64 = 1e3;
/// So many short steps in a row are a stall.
const STALL: u32 = 20_000;

impl JumpDetector {
    /// For a motion of `span` seconds.
    pub fn new(span: f64) -> Self {
        JumpDetector { calm: 0.0, pace: f64::NAN, shortest: 1e-9 * span, short: 0 }
    }

    /// Looks at a step of h with these accelerations at its ends.
    pub fn observe(&mut self, h: f64, before: &[f64], after: &[f64]) -> Option<Upset> {
        let (mut change, mut size) = (0.0_f64, 0.0_f64);
        for (before, after) in before.iter().zip(after) {
            change = larger(change, (after - before).abs());
            size = larger(size, larger(before.abs(), after.abs()));
        }
        let pace = change / h;
        let jumps = h < COLLAPSE * self.calm && change > 0.5 * size && pace > SUDDEN * self.pace;
        self.calm = h.max(0.8 * self.calm);
        self.pace = pace;
        self.short = if h < self.shortest { self.short + 1 } else { 0 };
        if jumps {
            let moved = before.iter().zip(after).position(|(before, after)| (after - before).abs() == change);
            return moved.map(Upset::Jump);
        }
        (self.short > STALL).then_some(Upset::Stall)
    }

    /// Forgets what was before a restart.
    pub fn restart(&mut self) {
        self.calm = 0.0;
        self.pace = f64::NAN;
    }
}
