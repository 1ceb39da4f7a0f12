//! Ways through the states: one number changes, or all as in a motion.

use super::motion::Motion;
use super::state::{Origin, State};
use crate::expr::Symbol;
use crate::number::DoubleDouble;

/// So many steps of a motion are looked at.
const STEPS: usize = 100;

/// A way through the states.
pub(super) enum Line<'a> {
    /// Time alone changes.
    Time(f64),
    /// One coordinate changes.
    Coordinate(usize, f64),
    /// One speed changes.
    Speed(usize, f64),
    /// Straight to another state.
    Between(&'a State),
    /// To the next state of a motion, on the cubic that has the speeds of both.
    Step(&'a State),
    /// Along all steps of a motion, by their number.
    Path(&'a [State]),
}

impl Line<'_> {
    /// How far it goes, to tell near from far on it.
    pub fn scale(&self) -> f64 {
        match self {
            Line::Time(scale) | Line::Coordinate(_, scale) | Line::Speed(_, scale) => *scale,
            Line::Between(_) | Line::Step(_) | Line::Path(_) => 1.0,
        }
    }
}

/// How far lines go.
pub(super) struct Reach<'a> {
    /// The longest scene's end.
    pub until: f64,
    /// Of a coordinate, or of its speed.
    pub of: &'a dyn Fn(usize, bool) -> f64,
    /// Whether the file vouches for a state (`sample`).
    pub inside: &'a dyn Fn(&State) -> bool,
}

impl Reach<'_> {
    /// Ways along which what depends on these symbols may change, one number at a time.
    pub fn lines<'l>(&self, symbols: &[Symbol]) -> Vec<Line<'l>> {
        let mut lines = Vec::new();
        for symbol in symbols {
            match *symbol {
                Symbol::Time | Symbol::Input(..) if !lines.iter().any(|line| matches!(line, Line::Time(_))) => {
                    lines.push(Line::Time(self.until));
                }
                Symbol::Coordinate(i) => lines.push(Line::Coordinate(i as usize, (self.of)(i as usize, false))),
                Symbol::Speed(i) => lines.push(Line::Speed(i as usize, (self.of)(i as usize, true))),
                _ => {}
            }
        }
        lines
    }
}

/// Where the line through a state that is on the constraints of its phase is at z, brought to these where it can be.
pub(super) fn moved(motion: &Motion, base: &State, line: &Line<'_>, z: DoubleDouble) -> State {
    let mut state = base.clone();
    match line {
        Line::Time(_) => state.t = z,
        Line::Coordinate(i, _) => state.q[*i] = z,
        Line::Speed(i, _) => state.v[*i] = z,
        Line::Step(next) => on_the_cubic(&mut state, base, next, z),
        Line::Path(steps) => {
            let k = (z.to_f64() as usize).min(steps.len().saturating_sub(2));
            if let Some([from, to]) = steps.get(k..k + 2) {
                on_the_cubic(&mut state, from, to, z - DoubleDouble::from(k as f64));
            }
        }
        Line::Between(other) => {
            let between = |a: DoubleDouble, b: DoubleDouble| a + z * (b - a);
            state.t = between(base.t, other.t);
            for i in 0..state.q.len() {
                state.q[i] = between(base.q[i], other.q[i]);
                state.v[i] = between(base.v[i], other.v[i]);
            }
        }
    }
    // One number of a quaternion may be nearly all of its length, and two of them stand for the same rotation with opposite signs.
    if matches!(line, Line::Coordinate(..) | Line::Between(_)) {
        motion.keep_lengths(&mut state, base);
    }
    motion.signals(&mut state);
    match line {
        Line::Coordinate(i, _) | Line::Speed(i, _) => motion.close_after(&mut state, *i),
        _ => motion.close(&mut state),
    };
    state.origin = if matches!(line, Line::Step(_) | Line::Path(_)) { Origin::Motion } else { Origin::Side };
    state
}

/// The cubic in time through two states with their speeds (Hermite's), at the fraction z of the way.
fn on_the_cubic(state: &mut State, from: &State, to: &State, z: DoubleDouble) {
    let (one, two) = (DoubleDouble::ONE, DoubleDouble::from(2.0));
    let h = to.t - from.t;
    let rest = one - z;
    state.t = from.t + z * h;
    for i in 0..state.q.len() {
        let (there, way) = (to.q[i], to.q[i] - from.q[i]);
        let bow = rest * (h * from.v[i] - way) - z * (h * to.v[i] - way);
        state.q[i] = rest * from.q[i] + z * there + z * rest * bow;
        let bend = h * (from.v[i] + to.v[i]) - two * way;
        state.v[i] = (way + (one - two * z) * bow - z * rest * bend) / h;
    }
}

/// Places at which an argument is sampled along a line, in order.
pub(super) fn grid(base: &State, line: &Line<'_>) -> Vec<f64> {
    let even = |low: f64, high: f64, n: usize| (0..=n).map(move |k| low + (high - low) * k as f64 / n as f64);
    let around = |middle: f64, scale: f64| {
        let mut places: Vec<f64> = even(-8.0 * scale, 8.0 * scale, 48).collect();
        places.extend([0.0, middle]);
        for k in -12..=3 {
            let far = scale * 10_f64.powi(k);
            places.extend([far, -far, middle + far, middle - far]);
        }
        places
    };
    let mut places = match line {
        Line::Time(until) => even(0.0, *until, 96).collect(),
        Line::Coordinate(i, scale) => around(base.q[*i].to_f64(), *scale),
        Line::Speed(i, scale) => around(base.v[*i].to_f64(), *scale),
        Line::Between(_) | Line::Step(_) => even(0.0, 1.0, 8).collect(),
        Line::Path(steps) => {
            let last = steps.len().saturating_sub(1);
            let apart = last.div_ceil(STEPS).max(1);
            (0..last).step_by(apart).chain([last]).map(|k| k as f64).collect()
        }
    };
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
}
