//! Where the equations of a run happen, as it is known to whoever wrote them.

use dalembert::mechanism::{At, System};

use super::shapes::Spot;

/// What a feature depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// Time.
    Time,
    /// A coordinate.
    Coordinate(usize),
    /// A rate.
    Rate(usize),
}

/// A place at which something happens.
#[derive(Clone, Copy, Debug)]
pub struct Local {
    /// In terms of what.
    pub of: Of,
    /// Where.
    pub spot: Spot,
}

/// A step goes this part of the way to the next place.
const PART: f64 = 0.3;

/// The longest step, s, from a state that stays short against the distances to all places, and against the passage
/// through those at hand.
pub fn longest_step(system: &dyn System, locals: &[Local], (t, q, v): (f64, &[f64], &[f64])) -> f64 {
    let mut a = vec![0.0; q.len()];
    if system.accelerations(At::new(t, q, v), &mut a).is_err() {
        return f64::INFINITY;
    }
    let bound = |local: &Local| {
        let (value, rate, bend) = match local.of {
            Of::Time => (t, 1.0, 0.0),
            Of::Coordinate(i) => (q[i], v[i], a[i]),
            Of::Rate(i) => (v[i], a[i], 0.0),
        };
        let way = PART * local.spot.distance(value);
        (way / rate.abs()).min((way / bend.abs()).sqrt())
    };
    locals.iter().map(bound).fold(f64::INFINITY, f64::min)
}
