//! Instants at which runs are compared.

use super::{Continuous, Run};

/// Within a step a run is looked at at Lobatto's nodes of order 4, where nothing begins or ends and no report is; in so many steps at most.
const STEPS: usize = 4000;
const WITHIN: [f64; 2] = [0.276_393_202_250_021, 0.723_606_797_749_979];

impl Run {
    /// At least so many instants of the run, one in each of as many equal intervals at a place that no vibration keeps step with, and
    /// others within its steps, which are short where much happens.
    pub(crate) fn instants(&self, count: usize) -> Vec<f64> {
        let Some((from, to)) = self.times.first().zip(self.times.last()) else { return Vec::new() };
        let mut instants = uneven(*from, *to, count);
        let steps = self.trajectory.steps();
        let some = steps.iter().step_by(steps.len().div_ceil(STEPS).max(1));
        instants.extend(some.flat_map(|[a, b]| WITHIN.map(|part| a + part * (b - a))));
        instants.sort_unstable_by(f64::total_cmp);
        instants
    }

    /// Columns at ordered times, as far as the run goes; `None` where it kept no dense output.
    pub(crate) fn values_at(&self, names: &[String], times: &[f64]) -> Option<Vec<Vec<f64>>> {
        let mut continuous = Continuous::new(self, names)?;
        let last = self.times.last().copied()?;
        let mut columns = vec![Vec::with_capacity(times.len()); names.len()];
        let mut row = vec![0.0; names.len()];
        for t in times.iter().copied().take_while(|t| *t <= last) {
            continuous.values(continuous.step_at(t, true), t, &mut row);
            columns.iter_mut().zip(&row).for_each(|(column, value)| column.push(*value));
        }
        Some(columns)
    }
}

/// An instant in each of so many equal intervals, at a place with which no vibration keeps step.
pub(crate) fn uneven(from: f64, to: f64, count: usize) -> Vec<f64> {
    // Of all numbers the golden ratio is the farthest from every fraction.
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let place = |k: usize| (k as f64 + ((k + 1) as f64 * GOLDEN).fract()) / count as f64;
    (0..count).map(|k| from + place(k) * (to - from)).collect()
}
