//! Whether a run stayed where the rules that stand for its integrals were tried.

use super::Run;
use crate::mechanism::{System, Tried};
use crate::trust::Warning;

/// What leaves a range by no more than this part of its bounds has rounding.
const ROUNDING: f64 = 1e-12;

impl Run {
    /// Warns of each integral that contains what goes beyond the values for which it was tried.
    pub(crate) fn warn_of_integrals(&mut self, system: &dyn System) {
        for warning in untried_integrals(system, |of| self.values(system, of)) {
            if !self.warnings.iter().any(|known| known.same_kind(&warning)) {
                self.warnings.push(warning);
            }
        }
    }

    /// Whether one was warned of.
    pub(crate) fn has_untried_integrals(&self) -> bool {
        self.warnings.iter().any(|warning| matches!(warning, Warning::IntegralUntried { .. }))
    }

    /// The values that something has along the run.
    fn values(&self, system: &dyn System, of: Tried) -> Vec<f64> {
        let n = system.len();
        let column = |k: usize| self.rows.chunks_exact(2 * n).filter_map(|row| row.get(k).copied()).collect();
        match of {
            Tried::Parameter(k) => system.parameters().get(k as usize).copied().into_iter().collect(),
            Tried::Coordinate(k) => column(k as usize),
            Tried::Speed(k) => column(n + k as usize),
            Tried::Time => self.times.clone(),
        }
    }
}

/// A warning of each integral that contains what has values beyond those for which it was tried.
pub(crate) fn untried_integrals(system: &dyn System, values: impl Fn(Tried) -> Vec<f64>) -> Vec<Warning> {
    let description = system.description();
    let found = description.integrals.iter().filter_map(|integral| {
        let beyond = integral.ranges.iter().find_map(|(of, range)| {
            let farthest = values(*of).into_iter().max_by(|a, b| beyond(*a, *range).total_cmp(&beyond(*b, *range)))?;
            let off = beyond(farthest, *range) > ROUNDING * range[0].abs().max(range[1].abs());
            off.then_some((*of, farthest, *range))
        });
        let (of, value, range) = beyond?;
        let of = match of {
            Tried::Parameter(k) => description.parameters.get(k as usize)?.name.to_string(),
            Tried::Coordinate(k) => description.coordinates.get(k as usize)?.name.to_string(),
            Tried::Speed(k) => format!("{}'", description.coordinates.get(k as usize)?.name),
            Tried::Time => "t".to_owned(),
        };
        Some(Warning::IntegralUntried { integral: integral.text.to_string(), of, value, range })
    });
    found.collect()
}

/// By how much a value is outside of a range.
fn beyond(x: f64, [low, high]: [f64; 2]) -> f64 {
    (low - x).max(x - high)
}
