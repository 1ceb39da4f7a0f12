//! Dense output of a symplectic method.

use super::step::Symplectic;
use crate::integrate::hermite::{write_by_ends, write_by_middle};
use crate::integrate::{Block, OneStep, StepFailure};
use crate::mechanism::System;

impl<Y: Block> Symplectic<Y> {
    /// The polynomial through both ends; where its order is below the method's, also through a state in the middle, which
    /// a step of half the length gives.  The motion does not go through it.
    pub(super) fn write_dense(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), StepFailure> {
        if self.scheme.needs_middle {
            self.pass_half(system, t, h)?;
        }
        let mut pieces = std::mem::take(&mut self.pieces);
        let ends = [self.start(), self.end()];
        if self.scheme.needs_middle {
            write_by_middle(h, ends, (self.half.end.all(), self.half.rate.all()), &mut pieces);
        } else {
            write_by_ends(h, ends, &mut pieces);
        }
        self.pieces = pieces;
        Ok(())
    }
}
