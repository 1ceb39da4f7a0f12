//! Whether the equations change with time though all inputs are held.

use super::point::LinearisationPoint;
use crate::linear::LinearError;
use crate::mechanism::At;

/// Times at which ∂F/∂t is looked at, s; pulses that are elsewhere show in `time_dependence`.
const TIMES: [f64; 5] = [0.0, 0.37, 1.9, 53.0, 1234.5];
/// Departures from the state, as parts of its size: what vanishes at a symmetric point only depends on time too.
const DEPARTURES: [f64; 4] = [0.0, 0.013, -0.31, 0.9];

impl LinearisationPoint {
    /// Refuses equations that depend on time, at this state or near it, by the exact ∂F/∂t; and switches that time
    /// alone throws.
    ///
    /// # Errors
    /// [`LinearError::DependsOnTime`]; [`LinearError::VariesWithTime`] where forces at the state itself stay as they are.
    pub(in crate::linear) fn check_time(&self, q: &[f64]) -> Result<(), LinearError> {
        let (rows, switches) = {
            let system = self.system.borrow();
            let description = system.description();
            (description.time_pattern.to_vec(), description.timed_switches.to_vec())
        };
        let refused = |row: usize| Err(LinearError::DependsOnTime { coordinate: self.name(row) });
        let varies = |row: usize| Err(LinearError::VariesWithTime { coordinate: self.name(row) });
        if !rows.is_empty() {
            for departure in DEPARTURES {
                if let Some(row) = self.changing_row(&rows, &self.beside(q, departure)) {
                    return if departure == 0.0 { refused(row) } else { varies(row) };
                }
            }
        }
        for switch in switches {
            let [low, high] = self.sides(q, switch as usize);
            if let Some(row) = (0..self.n).find(|i| low.force[*i] != high.force[*i]) {
                return refused(row);
            }
            if low.derivatives != high.derivatives {
                return varies(0);
            }
        }
        Ok(())
    }

    /// A state beside another, each coordinate at another distance.
    fn beside(&self, q: &[f64], departure: f64) -> Vec<f64> {
        let extent = q.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
        let extent = if extent > 0.0 { extent } else { 1.0 };
        q.iter().enumerate().map(|(i, q)| q + departure * extent * (1.0 + (i as f64 * 1.7).sin() * 0.5)).collect()
    }

    fn changing_row(&self, rows: &[u32], q: &[f64]) -> Option<usize> {
        let mut sums = vec![0.0; self.n];
        let mut rates = vec![0.0; rows.len()];
        let found = TIMES.into_iter().find_map(|t| {
            // Sides of what changes with time are those of then.
            self.settle(t, q, &self.v);
            let system = self.system.borrow();
            [false, true].into_iter().find_map(|generic| {
                let at = At::new(t, q, &self.v).accelerated(&self.zero);
                match generic {
                    false => system.time_jacobian(at, &mut rates),
                    true => system.time_dependence(at, &mut rates),
                }
                system.magnitudes(at, &mut sums);
                // A rate of one part in 10¹² a second is rounding of what cancels.
                let changes = |(row, rate): (&u32, &f64)| rate.is_finite() && rate.abs() > 1e-12 * sums[*row as usize];
                rows.iter().zip(&rates).find(|pair| changes(*pair)).map(|(row, _)| *row as usize)
            })
        });
        self.settle(0.0, q, &self.v);
        found
    }
}
