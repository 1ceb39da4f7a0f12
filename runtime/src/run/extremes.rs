//! Extremes over time of functions that are smooth within given pieces.

/// Where a piece is looked at: unequal distances, so that no vibration hides between them.
const NODES: [f64; 7] = [0.0, 0.14, 0.29, 0.47, 0.68, 0.87, 1.0];
/// The nodes of the polynomial that must predict the values at the others.
const FITTED: [usize; 5] = [0, 1, 3, 5, 6];
const TESTED: [usize; 2] = [2, 4];
/// A panel is halved where the polynomial misses a value by more than this part of the range seen so far.
const ROUGH: f64 = 1e-3;
/// Beside this part of its size a value is not missed: that is rounding.
const ROUNDING: f64 = 1e-12;
/// A run has at least so many panels, some thousand instants: as many as a picture of it.
const LEAST_PANELS: usize = 150;
/// A panel is divided into so many at most, six halvings about one place.
const MOST_PARTS: usize = 12;
/// All are divided into so many times as many on the average.
const MEAN_PARTS: usize = 3;
/// A parabola through three values tells the height of a peak above them to this factor.
const MARGIN: f64 = 2.0;
/// Brent's search ends at this part of its bracket: a peak's height is then exact to rounding.
const NARROW: f64 = 1e-9;
const MOST_EVALUATIONS: usize = 60;
/// The part of a bracket that a golden section keeps is 1 less this, (3 − √5)/2.
const GOLDEN: f64 = 0.381_966_011_250_105_1;

/// The least and the largest value; (∞, −∞) where there is none.
pub(crate) type Range = (f64, f64);

/// The least and largest of each of `width` values that `f` writes for a piece and a time in it; NaN is no value.
///
/// The ends of pieces belong to them, so that both sides of a jump between two count.  Peaks inside are found by search, panels on which
/// a polynomial does not predict the values are divided.  The cost is proportional to the number of pieces.
pub(crate) fn extremes(pieces: &[[f64; 2]], width: usize, f: &mut dyn FnMut(usize, f64, &mut [f64])) -> Vec<Range> {
    let panels = LEAST_PANELS.div_ceil(pieces.len().max(1));
    let spare = MEAN_PARTS * panels * pieces.len();
    let mut search = Search { f, row: vec![0.0; width], found: vec![(f64::INFINITY, f64::NEG_INFINITY); width], spare };
    for (piece, [a, b]) in pieces.iter().enumerate() {
        let edge = |k: usize| if k == panels { *b } else { a + (b - a) * k as f64 / panels as f64 };
        for k in 0..panels {
            let mut parts = MOST_PARTS;
            search.panel(piece, [edge(k), edge(k + 1)], &mut parts);
        }
    }
    search.found
}

struct Search<'a> {
    f: &'a mut dyn FnMut(usize, f64, &mut [f64]),
    row: Vec<f64>,
    found: Vec<Range>,
    /// How many more panels may be divided.
    spare: usize,
}

impl Search<'_> {
    /// Evaluates all, and takes note.
    fn look(&mut self, piece: usize, t: f64) -> &[f64] {
        (self.f)(piece, t, &mut self.row);
        for ((low, high), value) in self.found.iter_mut().zip(&self.row) {
            (*low, *high) = (low.min(*value), high.max(*value));
        }
        &self.row
    }

    fn panel(&mut self, piece: usize, [a, b]: [f64; 2], parts: &mut usize) {
        let times = NODES.map(|x| if x == 1.0 { b } else { a + x * (b - a) });
        let rows = times.map(|t| self.look(piece, t).to_vec());
        let divisible = *parts > 1 && self.spare > 0 && times.windows(2).all(|pair| pair[0] < pair[1]);
        if divisible && (0..self.found.len()).any(|column| self.is_rough(&rows, column)) {
            (*parts, self.spare) = (*parts - 1, self.spare - 1);
            self.panel(piece, [a, times[3]], parts);
            return self.panel(piece, [times[3], b], parts);
        }
        for column in 0..self.found.len() {
            for sign in [1.0, -1.0] {
                let values = rows.each_ref().map(|row| sign * row[column]);
                self.peaks((piece, column, sign), &times, &values);
            }
        }
    }

    /// Whether the polynomial through some of the values misses the others.
    fn is_rough(&self, rows: &[Vec<f64>; 7], column: usize) -> bool {
        let value = |node: usize| rows[node][column];
        let finite = (0..NODES.len()).filter(|node| value(*node).is_finite()).count();
        if finite < NODES.len() {
            return finite > 0;
        }
        let (low, high) = self.found[column];
        let slack = ROUGH * (high - low) + ROUNDING * low.abs().max(high.abs());
        TESTED.iter().any(|node| (predicted(*node, &value) - value(*node)).abs() > slack)
    }

    /// Climbs where a peak may rise above all that was seen.
    fn peaks(&mut self, (piece, column, sign): (usize, usize, f64), times: &[f64; 7], values: &[f64; 7]) {
        for k in 0..NODES.len() {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(NODES.len() - 1));
            if !(values[k] >= values[before] && values[k] >= values[after]) {
                continue;
            }
            let middle = k.clamp(1, NODES.len() - 2);
            let top = vertex(&times[middle - 1..=middle + 1], &values[middle - 1..=middle + 1]);
            let best = if sign > 0.0 { self.found[column].1 } else { -self.found[column].0 };
            if values[k] + MARGIN * (top - values[k]) > best {
                let mut climb = |t: f64| sign * self.look(piece, t)[column];
                climb_between([times[before], times[after]], &mut climb);
            }
        }
    }
}

/// The value at a node of the polynomial through the fitted ones, by Lagrange's formula.
fn predicted(node: usize, value: &dyn Fn(usize) -> f64) -> f64 {
    let x = NODES[node];
    let weight = |k: usize| {
        let others = FITTED.iter().filter(|other| **other != k);
        others.map(|other| (x - NODES[*other]) / (NODES[k] - NODES[*other])).product::<f64>()
    };
    FITTED.iter().map(|k| weight(*k) * value(*k)).sum()
}

/// The top of the parabola through three points that lies between them; −∞ where it opens upwards or its top lies elsewhere.
fn vertex(t: &[f64], y: &[f64]) -> f64 {
    let (left, right) = ((y[1] - y[0]) / (t[1] - t[0]), (y[2] - y[1]) / (t[2] - t[1]));
    let bend = (right - left) / (t[2] - t[0]);
    let slope = left + bend * (t[1] - t[0]);
    let away = -0.5 * slope / bend;
    let inside = bend < 0.0 && (t[0]..=t[2]).contains(&(t[1] + away));
    if inside { y[1] + 0.5 * slope * away } else { f64::NEG_INFINITY }
}

/// Brent's search for the largest value in an interval (Algorithms for Minimization without Derivatives, 1973, ch. 5).
fn climb_between([mut a, mut b]: [f64; 2], f: &mut dyn FnMut(f64) -> f64) {
    let narrow = NARROW * (b - a);
    let mut x = a + GOLDEN * (b - a);
    let mut y = f(x);
    let ((mut w, mut yw), (mut v, mut yv)) = ((x, y), (x, y));
    let (mut step, mut before) = (0.0_f64, 0.0_f64);
    for _ in 0..MOST_EVALUATIONS {
        let middle = 0.5 * (a + b);
        if (x - middle).abs() + 0.5 * (b - a) <= 2.0 * narrow {
            break;
        }
        let (r, q) = ((x - w) * (y - yv), (x - v) * (y - yw));
        let (p, q) = ((x - v) * q - (x - w) * r, 2.0 * (q - r));
        let parabola = -p / q;
        let last = std::mem::replace(&mut before, step);
        let serves = parabola.is_finite() && parabola.abs() < 0.5 * last.abs() && x + parabola > a && x + parabola < b;
        step = if serves {
            parabola
        } else {
            before = if x < middle { b - x } else { a - x };
            GOLDEN * before
        };
        let u = if step.abs() >= narrow { x + step } else { x + narrow.copysign(step) };
        let yu = f(u);
        if yu >= y {
            if u >= x {
                a = x
            } else {
                b = x
            }
            ((v, yv), (w, yw), (x, y)) = ((w, yw), (x, y), (u, yu));
        } else {
            if u < x {
                a = u
            } else {
                b = u
            }
            if yu >= yw || w == x {
                ((v, yv), (w, yw)) = ((w, yw), (u, yu));
            } else if yu >= yv || v == x || v == w {
                (v, yv) = (u, yu);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::extremes;

    fn of(pieces: &[[f64; 2]], f: impl Fn(usize, f64) -> f64) -> (f64, f64) {
        extremes(pieces, 1, &mut |piece, t, out| out[0] = f(piece, t))[0]
    }

    #[test]
    fn peaks_between_the_instants_looked_at_are_exact() {
        for (a, b) in [(0.0, 10.0), (-1e-9, 2e-9), (1e6, 1e6 + 3.0), (0.0, 5e12)] {
            let width: f64 = b - a;
            let (low, high) = of(&[[a, b]], |_, t| 3.0 * (17.3 * (t - a) / width).sin());
            assert!((high - 3.0).abs() < 1e-13 && (low + 3.0).abs() < 1e-13, "{a} {b}: {low} {high}");
        }
    }

    #[test]
    fn both_sides_of_a_jump_count_and_kinks_are_found() {
        let (low, high) = of(&[[0.0, 1.0], [1.0, 3.0]], |piece, t| if piece == 0 { t } else { -t });
        assert_eq!((low, high), (-3.0, 1.0));
        let (low, _) = of(&[[0.0, 1.0]], |_, t| (t - 0.123_456_789).abs());
        assert!(low < 1e-9, "{low}");
    }

    #[test]
    fn a_vibration_far_faster_than_the_pieces_is_seen() {
        let pieces: Vec<[f64; 2]> = (0..500).map(|k| [f64::from(k), f64::from(k + 1)]).collect();
        let (low, high) = of(&pieces, |_, t| (std::f64::consts::TAU * 12.0 * t).sin());
        assert!(high > 1.0 - 1e-12 && low < -1.0 + 1e-12, "{low} {high}");
    }

    #[test]
    fn noise_costs_a_bounded_number_of_evaluations_a_piece() {
        let pieces: Vec<[f64; 2]> = (0..10_000).map(|k| [f64::from(k), f64::from(k + 1)]).collect();
        let mut count = 0_u32;
        // Nothing but noise.
        extremes(&pieces, 1, &mut |_, t, out| {
            count += 1;
            out[0] = (1e9 * t * t).sin();
        });
        assert!(count < 300 * 10_000, "{count}");
    }

    #[test]
    fn what_is_nowhere_has_no_extremes() {
        assert_eq!(of(&[[0.0, 1.0]], |_, _| f64::NAN), (f64::INFINITY, f64::NEG_INFINITY));
        let (low, high) = of(&[[0.0, 1.0]], |_, t| if t < 0.3 { f64::NAN } else { t });
        assert!(low < 0.301 && high == 1.0, "{low} {high}");
    }
}
