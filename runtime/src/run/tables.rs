//! Whether a run stayed within the points of its tables.

use super::Run;
use crate::mechanism::{At, Role, System, Table, Watched};
use crate::trust::Warning;

/// How many points beyond each end a table has that counts those of another.
const BEYOND: usize = 2;
/// What passes an end by no more than this part of a count has rounding.
const ROUNDING: f64 = 1e-9;

impl Run {
    /// Warns of each table in the equations of motion whose argument goes beyond its points: there it goes on by a rule.
    pub(crate) fn warn_of_tables(&mut self, system: &dyn System) {
        let description = system.description();
        let n = system.len();
        let mut pairs = vec![0.0; 2 * description.arguments.len()];
        let mut left: Vec<Option<f64>> = vec![None; description.arguments.len()];
        let counters: Vec<Option<&Table>> = description
            .arguments
            .iter()
            .map(|argument| {
                let counts = argument.role == Role::Points && argument.of == Watched::Motion;
                let table = description.tables.iter().find(|table| counts && table.name == argument.load);
                table.filter(|table| table.period.is_none() && table.knots.len() > 2 * BEYOND)
            })
            .collect();
        if counters.iter().all(Option::is_none) {
            return;
        }
        let mut before: Vec<f64> = Vec::new();
        for (row, y) in self.rows.chunks_exact(2 * n).enumerate() {
            system.arguments(At::packed(self.times[row], y, n), &mut pairs);
            for (k, counter) in counters.iter().enumerate() {
                let (Some(counter), None) = (counter, left[k]) else { continue };
                let end = (counter.knots.len() - 1 - 2 * BEYOND) as f64;
                let now = pairs[2 * k];
                if now < -ROUNDING || now > end + ROUNDING {
                    let from = before.get(k).copied().map(|then| (then, self.times[row - 1]));
                    left[k] = Some(passed(counter, from, (now, self.times[row]), if now < 0.0 { 0.0 } else { end }));
                }
            }
            before = (0..counters.len()).map(|k| pairs[2 * k]).collect();
        }
        for (argument, t) in description.arguments.iter().zip(left) {
            let Some(t) = t else { continue };
            let table = argument.load.split(" (").next().unwrap_or_default().to_owned();
            let warning = Warning::LeavesTable { table, t };
            if !self.warnings.iter().any(|known| known.same_kind(&warning)) {
                self.warnings.push(warning);
            }
        }
    }
}

/// When a count comes to the end of a table between two times, its argument changing evenly; the second where it began beyond.
fn passed(counter: &Table, from: Option<(f64, f64)>, (now, t): (f64, f64), end: f64) -> f64 {
    let Some((then, earlier)) = from else { return t };
    let [from, to, at] = [then, now, end].map(|count| argument(counter, count));
    let part = (at - from) / (to - from);
    if (0.0..=1.0).contains(&part) { earlier + part * (t - earlier) } else { t }
}

/// Where a table that rises by 1 from point to point, and by half of that before and behind them, comes to a count.
fn argument(counter: &Table, count: f64) -> f64 {
    let knots = &counter.knots[BEYOND - 1..counter.knots.len() - BEYOND + 1];
    let counts = |k: usize| match k {
        0 => -0.5,
        k if k + 1 == knots.len() => (knots.len() - 3) as f64 + 0.5,
        k => (k - 1) as f64,
    };
    let next = (1..knots.len() - 1).find(|k| counts(*k) >= count).unwrap_or(knots.len() - 1);
    let (low, high) = (counts(next - 1), counts(next));
    knots[next - 1] + (count - low) / (high - low) * (knots[next] - knots[next - 1])
}
