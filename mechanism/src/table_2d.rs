//! Functions of two arguments that a model gives by values on a grid.

use super::real::floor;
use super::{List, Real, Text};

/// A function by pieces: Σ c\[a\]\[b\] dᵃ eᵇ, d and e being the distances of both arguments from the knots before.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table2d {
    /// Its name.
    pub name: Text,
    /// Where the pieces meet along each argument, rising, SI.
    pub knots: [List<f64>; 2],
    /// Coefficients of the pieces, a row for each piece along the first argument; along both there is one more than knots, as in
    /// [`Table`](super::Table).
    pub pieces: List<[[f64; 4]; 4]>,
    /// After how much of each argument it repeats itself; `None` where it does not.
    pub periods: [Option<f64>; 2],
}

impl Table2d {
    /// Along one argument: the place of the piece, and the knot that it counts from.
    #[inline]
    fn find(&self, argument: usize, x: f64) -> (usize, f64) {
        let knots = &self.knots[argument];
        let turned = self.periods[argument].map_or(0.0, |period| floor((x - knots[0]) / period) * period);
        let piece = knots.partition_point(|knot| *knot <= x - turned);
        (piece, knots[piece.saturating_sub(1)] + turned)
    }

    /// Its value at (x, y), or that of a derivative by both, each lane in its own piece.
    #[inline]
    pub fn evaluate<S: Real>(&self, x: S, y: S, [of_x, of_y]: [usize; 2]) -> S {
        let columns = self.knots[1].len() + 1;
        let piece = |lane| self.find(0, x.lane(lane)).0 * columns + self.find(1, y.lane(lane)).0;
        let place = S::gather(|lane| piece(lane) as f64);
        let d = x - S::gather(|lane| self.find(0, x.lane(lane)).1);
        let e = y - S::gather(|lane| self.find(1, y.lane(lane)).1);
        let falling = |power: usize, order| (power - order + 1..=power).fold(1.0, |product, k| product * k as f64);
        let mut sum = S::ratio(0.0, 1.0);
        for a in (of_x..4).rev() {
            let mut line = S::ratio(0.0, 1.0);
            for b in (of_y..4).rev() {
                let factor = falling(a, of_x) * falling(b, of_y);
                line = line * e + S::gather(|lane| factor * self.pieces[place.lane(lane) as usize][a][b]);
            }
            sum = sum * d + line;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    /// Between (0, 0) and (2, 3): 1 + 2 d + 3 d² e + e³; straight lines beyond.
    fn table() -> Table2d {
        let mut pieces = vec![[[0.0; 4]; 4]; 9];
        (pieces[4][0][0], pieces[4][1][0], pieces[4][2][1], pieces[4][0][3]) = (1.0, 2.0, 3.0, 1.0);
        (pieces[0][0][0], pieces[0][1][0], pieces[8][0][0], pieces[8][1][1]) = (1.0, 2.0, 68.0, 5.0);
        let knots = [vec![0.0, 2.0].into(), vec![0.0, 3.0].into()];
        Table2d { name: "t".into(), knots, pieces: pieces.into(), periods: [None, None] }
    }

    #[test]
    fn pieces_and_their_derivatives_are_polynomials() {
        let table = table();
        let at = |x: f64, y: f64, order| table.evaluate(x, y, order);
        assert_eq!(at(1.0, 2.0, [0, 0]), 17.0);
        assert_eq!((at(1.0, 2.0, [1, 0]), at(1.0, 2.0, [0, 1]), at(1.0, 2.0, [1, 1])), (14.0, 15.0, 6.0));
        assert_eq!((at(1.0, 2.0, [2, 0]), at(1.0, 2.0, [0, 3]), at(1.0, 2.0, [3, 3])), (12.0, 6.0, 0.0));
        assert_eq!((at(-1.0, -5.0, [0, 0]), at(3.0, 5.0, [0, 0])), (-1.0, 78.0));
        assert!(at(f64::NAN, 1.0, [0, 0]).is_nan() && at(1.0, f64::NAN, [0, 0]).is_nan());
        let saw = Table2d { periods: [Some(2.0), None], ..table };
        assert_eq!((saw.evaluate(7.0, 2.0, [0, 0]), saw.evaluate(-1.0, 2.0, [0, 0])), (17.0, 17.0));
    }
}
