//! Symmetric motions, and how far they stay so.

use super::Run;
use crate::mechanism::Description;
use crate::trust::Warning;

/// An exchange or reflection q → S q under which the equations of motion stay as they are: a motion that begins with q = S q and
/// q' = S q' keeps both, but for rounding, which an unstable motion lets grow.
#[derive(Clone, Debug, PartialEq)]
pub struct Symmetry {
    /// What to call it.
    pub name: String,
    /// For each coordinate the one in whose place it comes, and whether with the opposite sign.
    pub images: Vec<(usize, bool)>,
}

/// A start is symmetric within this part of the largest value of the same unit.
const START: f64 = 1e-12;
/// A motion that departs by more than this part has left.
const LEFT: f64 = 1e-6;

impl Symmetry {
    /// Whether a start has it.
    pub fn is_of(&self, mechanism: &Description, q: &[f64], v: &[f64]) -> bool {
        [q, v].into_iter().all(|list| self.departure(mechanism, list, list) <= START)
    }

    /// The largest |x − S x| of coordinates or of rates, in parts of the largest of these scales whose unit is the same.
    fn departure(&self, mechanism: &Description, x: &[f64], scales: &[f64]) -> f64 {
        let unit = |i: usize| mechanism.coordinates.get(i).map(|coordinate| &coordinate.unit);
        let of = |(i, (to, opposite)): (usize, &(usize, bool))| {
            let apart = (x[i] - if *opposite { -x[*to] } else { x[*to] }).abs();
            let alike = scales.iter().enumerate().filter(|(k, _)| unit(*k) == unit(i));
            let scale = alike.fold(0.0_f64, |most, (_, scale)| most.max(scale.abs()));
            if apart == 0.0 { 0.0 } else { apart / scale }
        };
        self.images.iter().enumerate().map(of).fold(0.0, f64::max)
    }
}

impl Run {
    /// How far the reported states depart from a symmetry at most: the largest |x − S x| of a coordinate or rate, in parts of the
    /// largest value that those of the same unit have along the run.  A motion that leaves it is warned of, once for each symmetry.
    pub fn watch_symmetry(&mut self, symmetry: &Symmetry) -> f64 {
        let n = self.description.coordinates.len();
        let mut scales = vec![0.0_f64; 2 * n];
        for row in self.rows.chunks_exact((2 * n).max(1)) {
            scales.iter_mut().zip(row).for_each(|(scale, x)| *scale = scale.max(x.abs()));
        }
        let (of_places, of_rates) = scales.split_at(n);
        let departures = self.rows.chunks_exact((2 * n).max(1)).map(|row| {
            let (q, v) = row.split_at(n);
            let places = symmetry.departure(&self.description, q, of_places);
            places.max(symmetry.departure(&self.description, v, of_rates))
        });
        let departures: Vec<f64> = departures.collect();
        let most = departures.iter().fold(0.0_f64, |most, departure| most.max(*departure));
        let left = self.times.iter().zip(&departures).find(|(_, departure)| **departure > LEFT);
        if let Some((t, _)) = left {
            self.warnings.push(Warning::LeavesSymmetry { t: *t, symmetry: symmetry.name.clone(), by: most });
        }
        most
    }
}
