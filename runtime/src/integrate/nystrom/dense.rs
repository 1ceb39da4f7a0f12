//! Dense output of a Runge–Kutta–Nyström method.

use super::rkn8::RKN8;
use super::step::Nystrom;
use super::tableau::END;
use crate::integrate::hermite::write_by_bends;
use crate::integrate::{Block, OneStep};

impl<Y: Block> Nystrom<Y> {
    /// The polynomial of degree 8 through both ends whose second derivative at three points between them is the
    /// acceleration there: its error is O(h⁹) in q and O(h⁸) in q'.
    pub(super) fn write_dense(&mut self, h: f64) {
        let mut pieces = std::mem::take(&mut self.pieces);
        let bends = [0, 1, 2].map(|k| (RKN8.dense_rows[k].0, &self.stages[END + 1 + k].all()[self.n..]));
        let change = |i: usize| self.increment.all()[i] - self.carry.all()[i];
        write_by_bends(h, [self.start(), self.end()], change, bends, &mut pieces);
        self.pieces = pieces;
    }
}
