//! The forces that act at points along a run.

use super::{Continuous, Run};
use crate::mechanism::{At, System};

/// Forces at some times of a run.
pub(crate) struct Forces {
    /// For each time, where each force acts and then its components.
    pub frames: Vec<Vec<f64>>,
    /// The largest sum of the sizes of all terms of T and V, J.
    pub energy: f64,
    /// How many numbers each force has.
    width: usize,
}

impl Run {
    /// The forces that are the last outputs of a mechanism of the same equations, so many of them; `None` where its equations are not those
    /// of the run, or the run kept no dense output.
    pub(crate) fn forces(&self, system: &dyn System, times: &[f64], count: usize) -> Option<Forces> {
        let width = 2 * self.description.structure.dimension as usize;
        let mut along = Continuous::seen_by(self, system.boxed_clone())?;
        let (mut frames, mut energy) = (Vec::with_capacity(times.len()), 0.0_f64);
        for t in times {
            let step = along.step_at(*t, true);
            let row = along.row(step, *t);
            frames.push(row[row.len() - width * count..].to_vec());
            let (system, y) = along.state(step, *t);
            let scale = system.energy(At::packed(*t, y, system.len())).scale;
            energy = if scale.is_finite() { energy.max(scale) } else { energy };
        }
        Some(Forces { frames, energy, width })
    }
}

impl Forces {
    /// Makes 0 what is smaller.
    pub fn leave_out_below(&mut self, least: f64) {
        for force in self.frames.iter_mut().flat_map(|frame| frame.chunks_exact_mut(self.width)) {
            let components = &mut force[self.width / 2..];
            if components.iter().map(|x| x * x).sum::<f64>().sqrt() < least {
                components.fill(0.0);
            }
        }
    }

    /// Keeps the forces at these places; whether any of them is ever other than 0.
    pub fn keep(&mut self, places: &[usize]) -> bool {
        let width = self.width;
        let of = |frame: &Vec<f64>, place: usize| frame[width * place..width * (place + 1)].to_vec();
        for frame in &mut self.frames {
            *frame = places.iter().flat_map(|place| of(frame, *place)).collect();
        }
        let forces = self.frames.iter().flat_map(|frame| frame.chunks_exact(width));
        forces.into_iter().any(|force| force[width / 2..].iter().any(|x| x.is_finite() && *x != 0.0))
    }
}
