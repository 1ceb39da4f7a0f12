//! Where constraints lose their rank along a branch: rows that are independent near by depend on each other there.

use std::ops::Range;

use nalgebra::DMatrix;

use super::State;
use super::continuation::Continuation;
use crate::matrix::svd;

/// Rows whose least singular value is below this part of the largest may depend on each other near by.
const DOUBTFUL: f64 = 0.25;
/// They do where a search for the least comes below this part; a state is not known better.
const DEPENDENT: f64 = 1e-5;
/// Rows that are never independent are below this part.
const ALWAYS: f64 = 1e-9;
/// Steps of the search, each of which leaves 0.618 of the distance.
const STEPS: u32 = 60;

/// A state where rows depend on each other, and one of them.
pub(super) struct Dependence {
    pub at: State,
    /// The row that has most of the combination that vanishes.
    pub row: usize,
    /// The places in the path of the states between which it lies.
    pub between: Range<usize>,
}

/// Those along a path.
pub(super) fn dependences(continuation: &Continuation, points: &[State]) -> Vec<Dependence> {
    let Some(rows) = Rows::along(continuation, points) else { return Vec::new() };
    let margins: Vec<f64> = points.iter().map(|state| rows.margin(state).0).collect();
    let mut found = Vec::new();
    for index in 0..points.len() {
        let (low, high) = (index.saturating_sub(1), (index + 1).min(points.len() - 1));
        let least = (low == index || margins[index] < margins[low]) && margins[index] <= margins[high];
        if margins[index] > DOUBTFUL || !least {
            continue;
        }
        let at = rows.nearest(&points[low], &points[high]).unwrap_or_else(|| points[index].clone());
        let (left, row) = rows.margin(&at);
        if left <= DEPENDENT {
            found.push(Dependence { at, row, between: low..high });
        }
    }
    found
}

/// The rows of constraints along a path, rows and columns in units that stay the same.
struct Rows<'a> {
    continuation: &'a Continuation,
    sizes: Vec<f64>,
    units: Vec<f64>,
    /// How many are independent where most are.
    rank: usize,
}

impl<'a> Rows<'a> {
    /// `None` without constraints.
    fn along(continuation: &'a Continuation, points: &[State]) -> Option<Self> {
        let first = continuation.jacobian(points.first()?)?;
        let farthest = |i: usize| points.iter().fold(0.0_f64, |most, state| most.max(state.q[i].abs()));
        let units = continuation.units(&(0..points[0].q.len()).map(farthest).collect::<Vec<f64>>());
        let mut rows = Rows { continuation, sizes: vec![1.0; first.nrows()], units, rank: 0 };
        let all: Vec<DMatrix<f64>> = points.iter().filter_map(|state| rows.scaled(state)).collect();
        let largest = |k: usize| all.iter().fold(0.0_f64, |most, jacobian| most.max(jacobian.row(k).norm()));
        rows.sizes = (0..first.nrows()).map(largest).map(|size| if size > 0.0 { size } else { 1.0 }).collect();
        let independent = |state: &State| rows.values(state).0.iter().filter(|value| **value > ALWAYS).count();
        rows.rank = points.iter().map(independent).max()?;
        (rows.rank > 0).then_some(rows)
    }

    fn scaled(&self, state: &State) -> Option<DMatrix<f64>> {
        let jacobian = self.continuation.jacobian(state)?;
        let (sizes, units) = (&self.sizes, &self.units);
        Some(DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |k, i| jacobian[(k, i)] * units[i] / sizes[k]))
    }

    /// Singular values as parts of the largest, falling, and the row that has most of what belongs to the least.
    fn values(&self, state: &State) -> (Vec<f64>, usize) {
        let Some(svd) = self.scaled(state).and_then(|scaled| svd(scaled, true, false)) else {
            return (Vec::new(), 0);
        };
        let values = svd.singular_values;
        let row = svd.u.map_or(0, |u| u.column(values.imin()).iamax());
        let mut parts: Vec<f64> = values.iter().map(|value| value / values.max()).collect();
        parts.sort_by(|a, b| b.total_cmp(a));
        (parts, row)
    }

    /// The least singular value that is not always 0, as a part of the largest, and its row.
    fn margin(&self, state: &State) -> (f64, usize) {
        let (values, row) = self.values(state);
        (values.get(self.rank - 1).copied().unwrap_or(0.0), row)
    }

    /// The state between two where rows are nearest to depending on each other, by golden sections.
    fn nearest(&self, a: &State, b: &State) -> Option<State> {
        const GOLDEN: f64 = 0.618_033_988_749_894_8;
        let at = |part: f64| self.continuation.between(a, b, part).map(|state| (self.margin(&state).0, state));
        let (mut low, mut high) = (0.0, 1.0);
        let mut best: Option<(f64, State)> = None;
        for _ in 0..STEPS {
            let width = high - low;
            // At the place itself there may be no direction left in which to look.
            let (Some(left), Some(right)) = (at(high - GOLDEN * width), at(low + GOLDEN * width)) else { break };
            let nearer = if left.0 < right.0 {
                high -= (1.0 - GOLDEN) * width;
                left
            } else {
                low += (1.0 - GOLDEN) * width;
                right
            };
            best = best.filter(|best| best.0 <= nearer.0).or(Some(nearer));
        }
        best.map(|(_, state)| state)
    }
}
