//! The lowest height that affine bounds leave: a linear programme, min over w of max (slope·w + value).

use nalgebra::{DMatrix, DVector};

use crate::matrix::solve_least;

/// A least-squares solution that misses a sum of parts of 1 by less meets its equations: between rounding and the 1 by which others miss.
const SOLVED: f64 = 1e-9;
/// Exchanges of active bounds at the most: where they do not come to an end, as by rounding, the best place so far is taken.
const EXCHANGES: usize = 300;

/// slope·w + value ≤ s.
#[derive(Clone)]
pub(super) struct Bound {
    pub slope: DVector<f64>,
    pub value: f64,
}

impl Bound {
    pub fn at(&self, w: &DVector<f64>) -> f64 {
        self.slope.dot(w) + self.value
    }
}

/// How low bounds let s be.
#[derive(Debug, PartialEq)]
pub(super) enum Lowest {
    /// So low.
    At(f64),
    /// As low as one likes, along this way.
    Falls(DVector<f64>),
}

/// The lowest s that all bounds let be, from w on, by exchanges of those that are active (Best and Ritter, Linear Programming, 1985).
pub(super) fn lowest(bounds: &[Bound], w: &mut DVector<f64>) -> Option<Lowest> {
    let height =
        |w: &DVector<f64>| bounds.iter().map(|bound| bound.at(w)).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    let (first, mut s) = height(w)?;
    let mut active = vec![first];
    for _ in 0..EXCHANGES {
        let slopes = DMatrix::from_fn(active.len(), w.len(), |i, j| bounds[active[i]].slope[j]);
        // The way on which all active bounds fall alike.
        let down = DMatrix::from_element(active.len(), 1, -1.0);
        let way: DVector<f64> = solve_least(&slopes, &down)?.column(0).into_owned();
        let missed = slopes.clone() * &way + DVector::from_element(active.len(), 1.0);
        if missed.amax() <= SOLVED {
            let step = |k: usize| {
                let closes = bounds[k].slope.dot(&way) + 1.0;
                (closes > SOLVED).then(|| ((s - bounds[k].at(w)) / closes).max(0.0))
            };
            let others = (0..bounds.len()).filter(|k| !active.contains(k));
            let next = others.filter_map(|k| Some((k, step(k)?))).min_by(|a, b| a.1.total_cmp(&b.1));
            let Some(next) = next else { return Some(Lowest::Falls(way)) };
            *w += next.1 * way;
            s -= next.1;
            active.push(next.0);
            continue;
        }
        // Their shares of 1 that let s no lower.
        let mut equations = slopes.transpose().resize_vertically(w.len() + 1, 1.0);
        equations.row_mut(w.len()).fill(1.0);
        let right = DMatrix::from_fn(w.len() + 1, 1, |i, _| if i == w.len() { 1.0 } else { 0.0 });
        let weights = solve_least(&equations, &right)?;
        let (place, least) = weights.iter().copied().enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
        if least >= -SOLVED {
            break;
        }
        active.remove(place);
    }
    height(w).map(|(_, s)| Lowest::At(s))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bound(slope: &[f64], value: f64) -> Bound {
        Bound { slope: DVector::from_column_slice(slope), value }
    }

    #[test]
    fn bounds_meet_at_the_lowest_place() {
        // s ≥ x + 1, s ≥ −2 x, s ≥ −3: at x = −1/3.
        let bounds = [bound(&[1.0], 1.0), bound(&[-2.0], 0.0), bound(&[0.0], -3.0)];
        let mut w = DVector::from_element(1, 7.0);
        let Some(Lowest::At(height)) = lowest(&bounds, &mut w) else { panic!("no height") };
        assert!((height - 2.0 / 3.0).abs() < 1e-14 && (w[0] + 1.0 / 3.0).abs() < 1e-14, "{height} {w}");
        // Nothing else holds it: one that depends on nothing does.
        let mut w = DVector::zeros(2);
        assert_eq!(lowest(&[bound(&[1.0, -1.0], 0.0), bound(&[0.0, 0.0], -1.0)], &mut w), Some(Lowest::At(-1.0)));
        assert!(matches!(lowest(&[bound(&[1.0, -1.0], 0.0)], &mut w), Some(Lowest::Falls(way)) if way[0] < way[1]));
    }
}
