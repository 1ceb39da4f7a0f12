//! States of a run that ended early, reported over the run as it was.

use super::{Continuous, Run};

/// A run reports so many states at the least where nobody said how many: half as many as one that goes to its end.
const LEAST: f64 = 250.0;

impl Run {
    /// Halves the spacing of reported states until there are enough of them; those that there were stay.
    pub(crate) fn fill(&mut self, mut spacing: f64) {
        let (Some(from), Some(to)) = (self.times.first().copied(), self.times.last().copied()) else { return };
        let span = to - from;
        // Below this the times of reports are not told apart.
        let shortest = f64::EPSILON * from.abs().max(to.abs());
        if !(span > LEAST * shortest && spacing.is_finite()) || span >= LEAST * spacing {
            return;
        }
        while span < LEAST * spacing {
            spacing *= 0.5;
        }
        let times: Vec<f64> = (0_u32..).map(|k| from + spacing * f64::from(k)).take_while(|t| *t < to).collect();
        self.resample(&times);
        self.is_filled = true;
    }

    /// Reports states at these times as far as the run goes, and the last one.
    pub(crate) fn resample(&mut self, times: &[f64]) {
        let (columns, n) = (self.names.len(), self.names.coordinates.len());
        let mut rows: Vec<(f64, Vec<f64>)> = Vec::with_capacity(times.len() + 1);
        {
            let Some(mut continuous) = Continuous::new(self, &[]) else { return };
            let Some(last) = self.times.len().checked_sub(1) else { return };
            for t in times.iter().copied().filter(|t| *t < self.times[last]) {
                let known = self.times.binary_search_by(|time| time.total_cmp(&t)).ok();
                let row = known.map(|row| self.row(row));
                rows.push((t, row.unwrap_or_else(|| continuous.row(continuous.step_at(t, true), t).to_vec())));
            }
            rows.push((self.times[last], self.row(last)));
        }
        debug_assert!(rows.iter().all(|(_, row)| row.len() == columns), "a row has all columns");
        self.times = rows.iter().map(|(t, _)| *t).collect();
        self.rows = rows.iter().flat_map(|(_, row)| row[..2 * n].iter().copied()).collect();
        self.outputs = rows.iter().flat_map(|(_, row)| row[2 * n..].iter().copied()).collect();
    }

    /// All columns of a reported state.
    fn row(&self, index: usize) -> Vec<f64> {
        let state = self.state(index);
        [state.q, state.v, state.outputs].concat()
    }
}
