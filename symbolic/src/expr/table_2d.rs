//! Tables of two arguments: functions that a model gives by values on a grid, with bicubic polynomials between them.

use std::collections::HashMap;
use std::sync::{LazyLock, Mutex, PoisonError};

use super::table::{Smooth, Table, chords, compared_by_key, monotone_slopes, pieces, spline_slopes};
use crate::number::DoubleDouble;

/// A table of two arguments, or a partial derivative of it.
///
/// Equal tables of equal names are one for the whole process, as with [`Table`].
#[derive(Clone, Copy)]
pub struct Table2d {
    data: &'static Data,
    order: [u8; 2],
}

/// Values on a grid: a row for each abscissa x, in it one for each y.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Abscissae of the rows and of the columns; both rise.
    pub knots: [Vec<f64>; 2],
    /// A row for each x.
    pub values: Vec<Vec<f64>>,
}

/// Σ c\[a\]\[b\] dᵃ eᵇ with the distances d and e from the knots before.
type Piece = [[f64; 4]; 4];

#[derive(Debug)]
struct Data {
    place: usize,
    /// Of the table and of its derivatives, by their orders.
    names: [[&'static str; 4]; 4],
    knots: [Vec<f64>; 2],
    /// A row for each piece along x, from that before the first knot to that beyond the last.
    pieces: Vec<Piece>,
    periods: [Option<f64>; 2],
    smooth: Smooth,
    along: [Table; 2],
}

type Key = (String, Vec<u64>, u8, [bool; 2]);

static TABLES: LazyLock<Mutex<HashMap<Key, &'static Data>>> = LazyLock::new(Mutex::default);

/// A slope is at most so many times that of the flatter chord beside it. With it the polynomial that a slope and its chord make
/// rises by no more than half of the chord at the inner points of Bézier's net, so that twists exist with which no piece leaves
/// the range of its four values.
const STEEPEST: f64 = 1.5;

impl Table2d {
    /// The table of this name with values on a grid of at least two by two; along an argument in which it is `periodic` it repeats itself,
    /// and beyond its ends it goes on straight along one in which it is not.
    ///
    /// Twice smooth it is the tensor product of natural (or periodic) cubic splines (de Boor, *Bicubic spline interpolation*, J. Math.
    /// Phys. 41 (1962) 212), and straight between points the bilinear function. Once smooth it is Hermite's bicubic with the slopes of
    /// Fritsch and Butland along both arguments, as far as `STEEPEST` lets them, and twists with which each piece lies between the
    /// smallest and the largest of its four values.
    pub fn new(name: &str, grid: &Grid, smooth: Smooth, periodic: [bool; 2]) -> Table2d {
        let numbers = grid.knots.iter().flatten().chain(grid.values.iter().flatten());
        let bits = std::iter::once(grid.values.len() as u64).chain(numbers.map(|x| x.to_bits())).collect();
        let key = (name.to_owned(), bits, smooth.order(), periodic);
        let mut tables = TABLES.lock().unwrap_or_else(PoisonError::into_inner);
        let place = tables.len();
        let data = *tables.entry(key).or_insert_with(|| {
            let slopes = match smooth {
                Smooth::Zero => None,
                Smooth::Once => Some(Slopes::within_values(grid, periodic)),
                Smooth::Twice => Some(Slopes::of_spline(grid, periodic)),
            };
            let named = |x: usize, y: usize| match x + y {
                0 => &*name.to_owned().leak(),
                _ => &*format!("{name}_{}{}", "x".repeat(x), "y".repeat(y)).leak(),
            };
            let length = |k: usize| grid.knots[k][grid.knots[k].len() - 1] - grid.knots[k][0];
            Box::leak(Box::new(Data {
                place,
                names: std::array::from_fn(|x| std::array::from_fn(|y| named(x, y))),
                knots: grid.knots.clone(),
                pieces: bicubic(grid, slopes.as_ref()),
                periods: [0, 1].map(|k| periodic[k].then(|| length(k))),
                smooth,
                along: [0, 1].map(|k| along(name, grid, k, periodic[k])),
            }))
        });
        Table2d { data, order: [0, 0] }
    }

    /// Its name, with a letter for each derivative: `map_xy`.
    pub fn name(self) -> &'static str {
        let [x, y] = self.order.map(usize::from);
        self.data.names[x][y]
    }

    /// The function itself.
    pub fn whole(self) -> Table2d {
        Table2d { order: [0, 0], ..self }
    }

    /// How often it is differentiated by each argument.
    pub fn order(self) -> [u8; 2] {
        self.order
    }

    /// The derivative by the first or the second argument; `None` where that vanishes everywhere.
    pub fn derivative(self, argument: usize) -> Option<Table2d> {
        let most = if self.data.smooth == Smooth::Zero { 1 } else { 3 };
        let mut order = self.order;
        order[argument] += 1;
        (order[argument] <= most).then_some(Table2d { order, ..self })
    }

    /// How smoothly its pieces meet.
    pub fn smooth(self) -> Smooth {
        self.data.smooth
    }

    /// Abscissae of the rows and of the columns.
    pub fn knots(self) -> &'static [Vec<f64>; 2] {
        &self.data.knots
    }

    /// Coefficients of the pieces in powers of the distances from the knots before, row by row; as of [`Table::pieces`] first and last
    /// are those beyond the ends.
    pub fn pieces(self) -> &'static [Piece] {
        &self.data.pieces
    }

    /// After how much of each argument it repeats itself.
    pub fn periods(self) -> [Option<f64>; 2] {
        self.data.periods
    }

    /// The largest size that it has at each knot of one argument: a table of this argument alone, with the same points.
    pub fn along(self, argument: usize) -> Table {
        self.data.along[argument]
    }

    /// Along one argument: the place of the piece, and the distance from its knot.
    fn find(self, argument: usize, x: DoubleDouble) -> (usize, DoubleDouble) {
        let (knots, mut x) = (&self.data.knots[argument], x);
        if let Some(period) = self.data.periods[argument] {
            let turns = ((x.to_f64() - knots[0]) / period).floor();
            x = x - DoubleDouble::product(turns, period);
        }
        let piece = knots.partition_point(|knot| *knot <= x.to_f64());
        (piece, x - DoubleDouble::from(knots[piece.saturating_sub(1)]))
    }

    /// Its value, in double-double: the coefficients count as exact.
    pub fn at(self, x: DoubleDouble, y: DoubleDouble) -> DoubleDouble {
        if !x.is_finite() || !y.is_finite() {
            return DoubleDouble::from(f64::NAN);
        }
        let ((row, d), (column, e)) = (self.find(0, x), self.find(1, y));
        let piece = &self.data.pieces[row * (self.data.knots[1].len() + 1) + column];
        let [of_x, of_y] = self.order.map(usize::from);
        let falling = |power: usize, order: usize| (power - order + 1..=power).map(|k| k as f64).product::<f64>();
        let along_y = |a: usize| {
            let term = |b: usize| DoubleDouble::product(falling(a, of_x) * falling(b, of_y), piece[a][b]);
            (of_y..4).rev().fold(DoubleDouble::ZERO, |sum, b| sum * e + term(b))
        };
        (of_x..4).rev().fold(DoubleDouble::ZERO, |sum, a| sum * d + along_y(a))
    }

    fn key(self) -> (usize, [u8; 2]) {
        (self.data.place, self.order)
    }
}

compared_by_key!(Table2d);

impl Grid {
    /// The same with rows and columns exchanged.
    fn turned(&self) -> Grid {
        let [x, y] = &self.knots;
        Grid { knots: [y.clone(), x.clone()], values: transposed(&self.values) }
    }

    /// Slopes along y, by a rule for the points of one line.
    fn slopes_along_y(&self, rule: impl Fn(&[[f64; 2]]) -> Vec<f64>) -> Vec<Vec<f64>> {
        self.values.iter().map(|row| rule(&points(&self.knots[1], row))).collect()
    }
}

/// ∂f/∂x, ∂f/∂y and ∂²f/∂x∂y at the points of a grid, in its order.
struct Slopes {
    by_x: Vec<Vec<f64>>,
    by_y: Vec<Vec<f64>>,
    twist: Vec<Vec<f64>>,
}

impl Slopes {
    /// Of the bicubic spline: the twists are the slopes along y of those along x, or the other way round.
    fn of_spline(grid: &Grid, periodic: [bool; 2]) -> Slopes {
        let by_x = transposed(&grid.turned().slopes_along_y(|points| spline_slopes(points, periodic[0])));
        let by_y = grid.slopes_along_y(|points| spline_slopes(points, periodic[1]));
        let of_slopes = Grid { knots: grid.knots.clone(), values: by_x };
        let twist = of_slopes.slopes_along_y(|points| spline_slopes(points, periodic[1]));
        Slopes { by_x: of_slopes.values, by_y, twist }
    }

    /// Slopes and twists with which no piece leaves the range of the four values around it.
    fn within_values(grid: &Grid, periodic: [bool; 2]) -> Slopes {
        let by_x = transposed(&grid.turned().slopes_along_y(|points| bounded_slopes(points, periodic[0])));
        let by_y = grid.slopes_along_y(|points| bounded_slopes(points, periodic[1]));
        let of = |values: &Vec<Vec<f64>>| Grid { knots: grid.knots.clone(), values: values.clone() };
        let first = of(&by_x).slopes_along_y(|points| monotone_slopes(points, periodic[1]));
        let second = of(&by_y).turned().slopes_along_y(|points| monotone_slopes(points, periodic[0]));
        let second = transposed(&second);
        let mut slopes = Slopes { by_x, by_y, twist: first };
        for (i, row) in second.iter().enumerate() {
            for (j, twist) in row.iter().enumerate() {
                let wanted = 0.5 * (slopes.twist[i][j] + twist);
                let [low, high] = slopes.twists(grid, periodic, [i, j]);
                slopes.twist[i][j] = wanted.clamp(low, high);
            }
        }
        slopes
    }

    /// The least and the largest twist at a point with which the inner point of Bézier's net beside it, f ± h/3 f_x ± k/3 f_y ± h k/9 f_xy,
    /// lies in the range of the four values in each piece around. 0 is always among them ([`STEEPEST`]).
    fn twists(&self, grid: &Grid, periodic: [bool; 2], [i, j]: [usize; 2]) -> [f64; 2] {
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for (row, h) in neighbours(&grid.knots[0], i, periodic[0]) {
            for (column, k) in neighbours(&grid.knots[1], j, periodic[1]) {
                let around = [grid.values[i][j], grid.values[row][j], grid.values[i][column], grid.values[row][column]];
                let least = around.into_iter().fold(f64::INFINITY, f64::min);
                let largest = around.into_iter().fold(f64::NEG_INFINITY, f64::max);
                let flat = around[0] + (h * self.by_x[i][j] + k * self.by_y[i][j]) / 3.0;
                let ends = [least, largest].map(|end| 9.0 * (end - flat) / (h * k));
                low = low.max(ends[0].min(ends[1]));
                high = high.min(ends[0].max(ends[1]));
            }
        }
        [low.min(0.0), high.max(0.0)]
    }
}

/// The knots beside one, with how far they are, less than 0 to the left.
fn neighbours(knots: &[f64], k: usize, periodic: bool) -> Vec<(usize, f64)> {
    let last = knots.len() - 1;
    let before = match k {
        0 => periodic.then(|| (last - 1, knots[last - 1] - knots[last])),
        _ => Some((k - 1, knots[k - 1] - knots[k])),
    };
    let after = match k == last {
        true => periodic.then(|| (1, knots[1] - knots[0])),
        false => Some((k + 1, knots[k + 1] - knots[k])),
    };
    before.into_iter().chain(after).collect()
}

/// The slopes of a table that is once smooth, none steeper than [`STEEPEST`] times the flatter chord beside it.
fn bounded_slopes(points: &[[f64; 2]], periodic: bool) -> Vec<f64> {
    let (chords, last) = (chords(points), points.len() - 2);
    let bound = |(k, slope): (usize, f64)| {
        let before = if k == 0 && periodic { last } else { k.saturating_sub(1) };
        let after = if k > last && periodic { 0 } else { k.min(last) };
        let most = STEEPEST * chords[before].abs().min(chords[after].abs());
        slope.clamp(-most, most)
    };
    monotone_slopes(points, periodic).into_iter().enumerate().map(bound).collect()
}

/// The pieces of all cells and of those beyond the ends: along x first, for values and slopes along y, then along y for each power.
fn bicubic(grid: &Grid, slopes: Option<&Slopes>) -> Vec<Piece> {
    let [x, y] = &grid.knots;
    let column = |rows: &[Vec<f64>], j: usize| rows.iter().map(|row| row[j]).collect::<Vec<f64>>();
    let along_x = |values: &[Vec<f64>], slopes: Option<&Vec<Vec<f64>>>, j: usize| {
        let slopes = slopes.map(|rows| column(rows, j)).unwrap_or_default();
        pieces(&points(x, &column(values, j)), &slopes)
    };
    let lines = 0..y.len();
    let values: Vec<_> = lines.clone().map(|j| along_x(&grid.values, slopes.map(|s| &s.by_x), j)).collect();
    let by_y: Vec<_> = lines.filter_map(|j| slopes.map(|s| along_x(&s.by_y, Some(&s.twist), j))).collect();
    let mut cells = vec![[[0.0; 4]; 4]; (x.len() + 1) * (y.len() + 1)];
    for row in 0..=x.len() {
        for power in 0..4 {
            let of = |lines: &[Vec<[f64; 4]>]| lines.iter().map(|line| line[row][power]).collect::<Vec<f64>>();
            let along_y = pieces(&points(y, &of(&values)), &of(&by_y));
            for (column, coefficients) in along_y.into_iter().enumerate() {
                cells[row * (y.len() + 1) + column][power] = coefficients;
            }
        }
    }
    cells
}

/// The largest size at each knot of one argument.
fn along(name: &str, grid: &Grid, argument: usize, periodic: bool) -> Table {
    let lines = if argument == 0 { grid.values.clone() } else { transposed(&grid.values) };
    let sizes = lines.iter().map(|line| line.iter().fold(0.0, |size: f64, value| size.max(value.abs())));
    let points: Vec<[f64; 2]> = grid.knots[argument].iter().zip(sizes).map(|(x, size)| [*x, size]).collect();
    let letter = ["x", "y"][argument];
    Table::new(&format!("{name} along {letter}"), &points, Smooth::Zero, periodic)
}

fn points(knots: &[f64], values: &[f64]) -> Vec<[f64; 2]> {
    knots.iter().zip(values).map(|(x, value)| [*x, *value]).collect()
}

fn transposed(rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let columns = rows.first().map_or(0, Vec::len);
    (0..columns).map(|j| rows.iter().map(|row| row[j]).collect()).collect()
}

#[cfg(test)]
mod tests;
