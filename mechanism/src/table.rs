//! Functions that a model gives by points.

use super::real::floor;
use super::{List, Real, Text};

/// A function by pieces: c₀ + c₁ d + c₂ d² + c₃ d³, d being the distance from the knot before.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Its name.
    pub name: Text,
    /// Where the pieces meet, rising, SI.
    pub knots: List<f64>,
    /// Coefficients of the pieces, one more than knots: before the first (from the first knot), between them, beyond the last.
    pub pieces: List<[f64; 4]>,
    /// After how much of its argument it repeats itself; `None` where it does not.
    pub period: Option<f64>,
    /// By how much it rises from period to period.
    pub rise: f64,
}

impl Table {
    /// The coefficients of the piece in which an argument lies, what it counts from, and by how much its
    /// periods have risen.
    #[inline]
    fn find(&self, x: f64) -> ([f64; 4], f64, f64) {
        let (turned, risen) = match self.period {
            None => (0.0, 0.0),
            Some(period) => {
                let turns = floor((x - self.knots[0]) / period);
                (turns * period, turns * self.rise)
            }
        };
        let piece = self.knots.partition_point(|knot| *knot <= x - turned);
        (self.pieces[piece], self.knots[piece.saturating_sub(1)] + turned, risen)
    }

    /// Its value at x, or that of one of its derivatives, each lane in its own piece.
    #[inline]
    pub fn evaluate<S: Real>(&self, x: S, order: usize) -> S {
        let first = self.find(x.lane(0));
        let found = |lane| if lane == 0 { first } else { self.find(x.lane(lane)) };
        let origin = S::gather(|lane| found(lane).1);
        let d = x - origin;
        let mut sum = S::ratio(0.0, 1.0);
        for power in (order..4).rev() {
            let falling = (power - order + 1..=power).fold(1.0, |product, k| product * k as f64);
            sum = sum * d + S::gather(|lane| falling * found(lane).0[power]);
        }
        if order == 0 { sum + S::gather(|lane| found(lane).2) } else { sum }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use alloc::vec::Vec;

    #[test]
    fn pieces_and_their_derivatives_are_polynomials() {
        let knots = vec![0.0, 2.0];
        let pieces = vec![[1.0, -1.0, 0.0, 0.0], [1.0, -1.0, 0.5, 2.0], [17.0, 25.0, 0.0, 0.0]];
        let table = Table { name: "t".into(), knots: knots.into(), pieces: pieces.into(), period: None, rise: 0.0 };
        assert_eq!((0..4).map(|k| table.evaluate(1.0, k)).collect::<Vec<f64>>(), [2.5, 6.0, 13.0, 12.0]);
        assert_eq!((table.evaluate(-1.0, 0), table.evaluate(3.0, 0), table.evaluate(3.0, 1)), (2.0, 42.0, 25.0));
        assert!(table.evaluate(f64::NAN, 0).is_nan());
        let saw = Table { period: Some(2.0), ..table };
        assert_eq!((saw.evaluate(7.0, 0), saw.evaluate(-1.0, 0), saw.evaluate(2.0, 0)), (2.5, 2.5, 1.0));
    }
}
