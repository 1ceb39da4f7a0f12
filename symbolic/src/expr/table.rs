//! Tables: functions that a model gives by points, with polynomials of third degree between them.

use std::collections::HashMap;
use std::sync::{LazyLock, Mutex};

use crate::number::DoubleDouble;

/// A table, or a derivative of it, as a function of one argument.
///
/// Equal tables of equal names are one for the whole process, so that a copy is a reference: what expressions contain is
/// compared and hashed by it.
#[derive(Clone, Copy)]
pub struct Table {
    data: &'static Data,
    order: u8,
}

/// How smoothly the pieces of a table meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smooth {
    /// The values are.
    Zero,
    /// The slope is continuous, and the curve rises where the points do.
    Once,
    /// The second derivative is continuous too.
    Twice,
}

impl Smooth {
    /// The highest derivative that is continuous.
    pub fn order(self) -> u8 {
        match self {
            Smooth::Zero => 0,
            Smooth::Once => 1,
            Smooth::Twice => 2,
        }
    }
}

#[derive(Debug)]
struct Data {
    place: usize,
    /// Its name, and with one prime to three.
    names: [&'static str; 4],
    knots: Vec<f64>,
    /// c₀ + c₁ d + c₂ d² + c₃ d³ with the distance d from the knot before; first and last the straight lines beyond the ends, the first
    /// with the distance from the first knot.
    pieces: Vec<[f64; 4]>,
    period: Option<f64>,
    /// By how much it rises from period to period.
    rise: f64,
    smooth: Smooth,
}

/// No name of a file ends so.
const COUNTER: &str = " (passed points)";

type Key = (String, Vec<u64>, u8, bool);

static TABLES: LazyLock<Mutex<HashMap<Key, &'static Data>>> = LazyLock::new(Mutex::default);

impl Table {
    /// The table of this name through points, which are at least two with rising abscissae; it repeats itself where it is
    /// `periodic`, risen by what its last value is more than its first, and goes on straight beyond its ends where it is not.
    ///
    /// Twice smooth it is the natural (or periodic) cubic spline; once smooth the slopes are those of Fritsch and Carlson, *Monotone
    /// piecewise cubic interpolation*, SIAM J. Numer. Anal. 17 (1980) 238, in the form of Fritsch and Butland (1984).
    pub fn new(name: &str, points: &[[f64; 2]], smooth: Smooth, periodic: bool) -> Table {
        let bits = points.iter().flatten().map(|x| x.to_bits()).collect();
        let key = (name.to_owned(), bits, smooth.order(), periodic);
        let mut tables = TABLES.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let place = tables.len();
        let data = *tables.entry(key).or_insert_with(|| {
            let slopes = match smooth {
                Smooth::Zero => Vec::new(),
                Smooth::Once => monotone_slopes(points, periodic),
                Smooth::Twice => spline_slopes(points, periodic),
            };
            let primed = |primes: usize| &*format!("{name}{}", "'".repeat(primes)).leak();
            Box::leak(Box::new(Data {
                place,
                names: std::array::from_fn(primed),
                knots: points.iter().map(|point| point[0]).collect(),
                pieces: pieces(points, &slopes),
                period: periodic.then(|| points[points.len() - 1][0] - points[0][0]),
                rise: points[points.len() - 1][1] - points[0][1],
                smooth,
            }))
        });
        Table { data, order: 0 }
    }

    /// Its name, with a prime for each derivative.
    pub fn name(self) -> &'static str {
        self.data.names[usize::from(self.order)]
    }

    /// The function itself.
    pub fn whole(self) -> Table {
        Table { order: 0, ..self }
    }

    /// How often it is differentiated.
    pub fn order(self) -> u8 {
        self.order
    }

    /// The derivative; `None` where that vanishes everywhere.
    pub fn derivative(self) -> Option<Table> {
        let most = if self.data.smooth == Smooth::Zero { 1 } else { 3 };
        (self.order < most).then(|| Table { order: self.order + 1, ..self })
    }

    /// How smoothly its pieces meet.
    pub fn smooth(self) -> Smooth {
        self.data.smooth
    }

    /// Abscissae of the points.
    pub fn knots(self) -> &'static [f64] {
        &self.data.knots
    }

    /// Coefficients of the pieces, in powers of the distance from the knot before; of the first, which is straight, from the first knot.
    pub fn pieces(self) -> &'static [[f64; 4]] {
        &self.data.pieces
    }

    /// After how much of its argument it repeats itself.
    pub fn period(self) -> Option<f64> {
        self.data.period
    }

    /// A table that rises by 1 from point to point, period after period, and by half a step more beyond the ends: what passes
    /// points is told by it, and sin(π c) changes its sign at each.
    pub fn counter(self) -> Table {
        let Data { knots, period, names, .. } = self.data;
        let (first, last) = (knots[0], knots[knots.len() - 1]);
        let (reach, highest) = (last - first, knots.len() as f64 - 1.0);
        let counted = knots.iter().enumerate().map(|(k, x)| [*x, k as f64]);
        let name = format!("{}{COUNTER}", names[0]);
        if period.is_some() {
            return Table::new(&name, &counted.collect::<Vec<_>>(), Smooth::Zero, true);
        }
        let before = [[first - 2.0 * reach, -0.5], [first - reach, -0.5]];
        let after = [[last + reach, highest + 0.5], [last + 2.0 * reach, highest + 0.5]];
        let points: Vec<[f64; 2]> = before.into_iter().chain(counted).chain(after).collect();
        Table::new(&name, &points, Smooth::Zero, false)
    }

    /// Whether it is a [`Table::counter`].
    pub fn is_counter(self) -> bool {
        self.data.names[0].ends_with(COUNTER)
    }

    /// By how much it rises from period to period.
    pub fn rise(self) -> f64 {
        self.data.rise
    }

    /// Where an argument lies: the coefficients, the distance that they are of, and how many periods before.
    fn find(self, x: DoubleDouble) -> (&'static [f64; 4], DoubleDouble, f64) {
        let Data { knots, pieces, period, .. } = self.data;
        let (mut x, mut turns) = (x, 0.0);
        if let Some(period) = period {
            turns = ((x.to_f64() - knots[0]) / period).floor();
            x = x - DoubleDouble::product(turns, *period);
        }
        let piece = knots.partition_point(|knot| *knot <= x.to_f64());
        (&pieces[piece], x - DoubleDouble::from(knots[piece.saturating_sub(1)]), turns)
    }

    /// Its value, in double-double: the coefficients count as exact.
    pub fn at(self, x: DoubleDouble) -> DoubleDouble {
        if !x.is_finite() {
            return DoubleDouble::from(f64::NAN);
        }
        let (piece, d, turns) = self.find(x);
        let order = usize::from(self.order);
        let falling = |power: usize| (power - order + 1..=power).map(|k| k as f64).product::<f64>();
        let term = |power: usize| DoubleDouble::product(falling(power), piece[power]);
        let value = (order..4).rev().fold(DoubleDouble::ZERO, |sum, power| sum * d + term(power));
        if order == 0 { value + DoubleDouble::product(turns, self.data.rise) } else { value }
    }
}

/// Tables of one place and order are one; they are compared by these, and called by their names.
macro_rules! compared_by_key {
    ($type:ty) => {
        impl PartialEq for $type {
            fn eq(&self, other: &$type) -> bool {
                self.key() == other.key()
            }
        }

        impl Eq for $type {}

        impl std::hash::Hash for $type {
            fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
                self.key().hash(state);
            }
        }

        impl PartialOrd for $type {
            fn partial_cmp(&self, other: &$type) -> Option<std::cmp::Ordering> {
                Some(self.cmp(other))
            }
        }

        impl Ord for $type {
            fn cmp(&self, other: &$type) -> std::cmp::Ordering {
                self.key().cmp(&other.key())
            }
        }

        impl std::fmt::Debug for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}
pub(super) use compared_by_key;

compared_by_key!(Table);

impl Table {
    fn key(self) -> (usize, u8) {
        (self.data.place, self.order)
    }
}

/// Slopes of the chords.
pub(super) fn chords(points: &[[f64; 2]]) -> Vec<f64> {
    points.windows(2).map(|pair| (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0])).collect()
}

/// The pieces between points with these slopes; straight without.
pub(super) fn pieces(points: &[[f64; 2]], slopes: &[f64]) -> Vec<[f64; 4]> {
    let chords = chords(points);
    let of = |k: usize| slopes.get(k).copied().unwrap_or_else(|| chords[k.min(chords.len() - 1)]);
    let last = points.len() - 1;
    let inner = points.windows(2).zip(&chords).enumerate().map(|(k, (pair, chord))| {
        if slopes.is_empty() {
            return [pair[0][1], *chord, 0.0, 0.0];
        }
        let (h, from, to) = (pair[1][0] - pair[0][0], slopes[k], slopes[k + 1]);
        [pair[0][1], from, (3.0 * chord - 2.0 * from - to) / h, (from + to - 2.0 * chord) / (h * h)]
    });
    let (start, end) = ([points[0][1], of(0), 0.0, 0.0], [points[last][1], of(last), 0.0, 0.0]);
    std::iter::once(start).chain(inner).chain([end]).collect()
}

/// Slopes with which a curve rises where its points do: weighted harmonic means of those of the chords beside.
pub(super) fn monotone_slopes(points: &[[f64; 2]], periodic: bool) -> Vec<f64> {
    let chords = chords(points);
    let widths: Vec<f64> = points.windows(2).map(|pair| pair[1][0] - pair[0][0]).collect();
    let between = |before: usize, after: usize| {
        let (a, b) = (chords[before], chords[after]);
        if a * b <= 0.0 {
            return 0.0;
        }
        let (u, w) = (2.0 * widths[after] + widths[before], widths[after] + 2.0 * widths[before]);
        (u + w) / (u / a + w / b)
    };
    let last = chords.len() - 1;
    let (start, end) = match periodic {
        true => (between(last, 0), between(last, 0)),
        false => (chords[0], chords[last]),
    };
    std::iter::once(start).chain((1..=last).map(|k| between(k - 1, k))).chain([end]).collect()
}

/// Slopes of the cubic spline: natural at the ends, or periodic.
pub(super) fn spline_slopes(points: &[[f64; 2]], periodic: bool) -> Vec<f64> {
    let (chords, count) = (chords(points), points.len());
    let width = |k: usize| points[k + 1][0] - points[k][0];
    if !periodic {
        let (mut below, mut on, mut above, mut right) =
            (vec![0.0; count], vec![0.0; count], vec![0.0; count], vec![0.0; count]);
        (on[0], above[0], right[0]) = (2.0, 1.0, 3.0 * chords[0]);
        (below[count - 1], on[count - 1], right[count - 1]) = (1.0, 2.0, 3.0 * chords[count - 2]);
        for k in 1..count - 1 {
            let (before, after) = (1.0 / width(k - 1), 1.0 / width(k));
            (below[k], on[k], above[k]) = (before, 2.0 * (before + after), after);
            right[k] = 3.0 * (before * chords[k - 1] + after * chords[k]);
        }
        return tridiagonal(&below, &on, &above, right);
    }
    // The first and the last slope are one: a corner of the matrix, taken off as in Sherman and Morrison (1950).
    let n = count - 1;
    if n == 1 {
        return vec![0.0; 2];
    }
    let (mut below, mut on, mut above, mut right) = (vec![0.0; n], vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    for k in 0..n {
        let before = (k + n - 1) % n;
        let (a, b) = (1.0 / width(before), 1.0 / width(k));
        (below[k], on[k], above[k]) = (a, 2.0 * (a + b), b);
        right[k] = 3.0 * (a * chords[before] + b * chords[k]);
    }
    // Of two points both neighbours are one: its entries meet.
    if n == 2 {
        let sum = below[0] + above[0];
        let determinant = on[0] * on[1] - sum * sum;
        let slopes =
            [(right[0] * on[1] - sum * right[1]) / determinant, (on[0] * right[1] - sum * right[0]) / determinant];
        return vec![slopes[0], slopes[1], slopes[0]];
    }
    let (first, last) = (below[0], above[n - 1]);
    let pivot = -on[0];
    on[0] -= pivot;
    on[n - 1] -= first * last / pivot;
    let mut corner = vec![0.0; n];
    (corner[0], corner[n - 1]) = (pivot, last);
    let (mut slopes, beside) = (tridiagonal(&below, &on, &above, right), tridiagonal(&below, &on, &above, corner));
    let weight = |x: &[f64]| x[0] + first / pivot * x[n - 1];
    let factor = weight(&slopes) / (1.0 + weight(&beside));
    slopes.iter_mut().zip(&beside).for_each(|(slope, beside)| *slope -= factor * beside);
    slopes.push(slopes[0]);
    slopes
}

/// Solves a tridiagonal system whose diagonal dominates.
fn tridiagonal(below: &[f64], on: &[f64], above: &[f64], mut right: Vec<f64>) -> Vec<f64> {
    let mut pivots = on.to_vec();
    for k in 1..right.len() {
        let factor = below[k] / pivots[k - 1];
        pivots[k] -= factor * above[k - 1];
        right[k] -= factor * right[k - 1];
    }
    for k in (0..right.len()).rev() {
        let after = if k + 1 < right.len() { above[k] * right[k + 1] } else { 0.0 };
        right[k] = (right[k] - after) / pivots[k];
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(table: Table, x: f64) -> f64 {
        table.at(x.into()).to_f64()
    }

    fn nth(table: Table, order: usize) -> Table {
        (0..order).fold(table, |table, _| table.derivative().expect("a derivative"))
    }

    #[test]
    fn a_table_goes_through_its_points_and_is_as_smooth_as_it_says() {
        let points: Vec<[f64; 2]> =
            [0.0, 0.3, 1.0, 1.1, 2.5, 3.0].iter().map(|x: &f64| [*x, (2.0 * x).sin() + 1e-3 * x]).collect();
        for (smooth, order) in [(Smooth::Zero, 0), (Smooth::Once, 1), (Smooth::Twice, 2)] {
            let table = Table::new("t", &points, smooth, false);
            assert_eq!(table, Table::new("t", &points, smooth, false));
            for [x, y] in &points {
                assert!((value(table, *x) - y).abs() < 1e-15);
                for k in 0..=order {
                    let (before, after) = (value(nth(table, k), x - 1e-13), value(nth(table, k), x + 1e-13));
                    assert!((before - after).abs() < 1e-10, "{smooth:?} {k} at {x}: {before} {after}");
                }
            }
            // Straight beyond the ends.
            let slope = value(nth(table, 1), 7.0);
            assert!((value(table, 9.0) - value(table, 5.0) - 4.0 * slope).abs() < 1e-14);
            if order > 0 {
                assert!((slope - value(nth(table, 1), 3.0)).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn derivatives_are_exact() {
        let points = [[0.0, 1.0], [1.0, -2.0], [1.5, 4.0], [4.0, 0.0]];
        let table = Table::new("d", &points, Smooth::Twice, false);
        for x in [-1.0, 0.4, 1.2, 3.3, 5.0] {
            for order in 0..3 {
                let (of, d) = (nth(table, order), 1e-5);
                let slope = (value(of, x + d) - value(of, x - d)) / (2.0 * d);
                assert!((slope - value(nth(table, order + 1), x)).abs() < 1e-8, "{order} at {x}");
            }
        }
        assert_eq!(nth(table, 3).derivative(), None);
        assert_eq!((nth(table, 2).name(), table.whole().order()), ("d''", 0));
    }

    #[test]
    fn a_natural_spline_is_the_known_one() {
        // Through 0, 1, 0 at 0, 1, 2: y'' = -3 in the middle, slope 3/2 at the start.
        let table = Table::new("n", &[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]], Smooth::Twice, false);
        assert!((value(nth(table, 1), 0.0) - 1.5).abs() < 1e-15 && (value(nth(table, 2), 1.0) + 3.0).abs() < 1e-14);
        assert!((value(table, 0.5) - 0.6875).abs() < 1e-15);
    }

    #[test]
    fn a_periodic_table_closes() {
        let sine = |count: usize| -> Vec<[f64; 2]> {
            (0..=count).map(|k| std::f64::consts::TAU * k as f64 / count as f64).map(|x| [x, x.sin()]).collect()
        };
        for count in [2, 3, 4, 40] {
            let mut points = sine(count);
            points[count][1] = points[0][1];
            for smooth in [Smooth::Once, Smooth::Twice] {
                let table = Table::new("p", &points, smooth, true);
                for order in 0..=usize::from(smooth.order()) {
                    let of = nth(table, order);
                    assert!((value(of, -1e-12) - value(of, 1e-12)).abs() < 1e-10, "{count} {smooth:?} {order}");
                    assert!((value(of, 0.7) - value(of, 0.7 + 10.0 * std::f64::consts::TAU)).abs() < 1e-12);
                }
            }
        }
        // A spline through forty points of a sine is a sine to h⁴/384.
        let fine = Table::new("p", &sine(40), Smooth::Twice, true);
        assert!((0..100).map(|k| 0.0628 * f64::from(k)).all(|x| (value(fine, x) - x.sin()).abs() < 2e-6));
    }

    #[test]
    fn monotone_points_give_a_monotone_curve() {
        let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.1], [2.1, 5.0], [4.0, 5.0]];
        let slope = nth(Table::new("m", &points, Smooth::Once, false), 1);
        assert!((0..400).all(|k| value(slope, 0.01 * f64::from(k)) >= -1e-14));
    }
}
