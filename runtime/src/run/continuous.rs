//! A run at any of its times, with its outputs.

use super::extremes::{Range, extremes};
use super::{Run, evaluate_outputs};
use crate::constrain::Projection;
use crate::mechanism::{At, System};

/// The state of a run and some of its columns at any time, from dense output, with the equations in force then.
pub(crate) struct Continuous<'a> {
    run: &'a Run,
    system: Box<dyn System>,
    projection: Option<Projection>,
    /// Times between which the motion is smooth: each step of the run.
    steps: Vec<[f64; 2]>,
    /// The columns that are wanted, among coordinates, rates and outputs.
    columns: Vec<usize>,
    /// The step whose equations are in force, and how many changes of phases and modes led there.
    step: Option<usize>,
    phases: usize,
    modes: usize,
    memory: usize,
    /// [q; q'; outputs].
    row: Vec<f64>,
    accelerations: Vec<f64>,
}

impl<'a> Continuous<'a> {
    /// `None` where the run kept no dense output, was changed by hand, or has no such column.
    pub fn new(run: &'a Run, names: &[String]) -> Option<Self> {
        let all = run.column_names();
        let columns =
            names.iter().map(|name| all.iter().position(|known| known == name)).collect::<Option<Vec<_>>>()?;
        let system = run.scenery.system()?.boxed_clone();
        let projection = Projection::new(&*system).filter(|_| run.scenery.projects);
        let steps = run.trajectory.steps();
        let (row, accelerations) = (vec![0.0; all.len()], vec![0.0; system.len()]);
        let (step, phases, modes, memory) = (None, 0, 0, 0);
        let found =
            Continuous { run, system, projection, steps, columns, step, phases, modes, memory, row, accelerations };
        (!found.steps.is_empty()).then_some(found)
    }

    /// By another mechanism, of the same equations and with other outputs, with the parameters, inputs and enforcement of the run.
    ///
    /// `None` as [`Continuous::new`], and where an input was replaced by one with discontinuities, so that the equations are not the same.
    #[cfg(feature = "cli")]
    pub fn seen_by(run: &'a Run, mut system: Box<dyn System>) -> Option<Self> {
        let known = Continuous::new(run, &[])?;
        if known.system.modes().len() != system.modes().len() {
            return None;
        }
        for (place, value) in known.system.parameters().into_iter().enumerate() {
            system.set_parameter(place, value);
        }
        for place in 0..system.description().inputs.len() {
            if let Some(signal) = known.system.signal(place) {
                system.set_input(place, signal.clone());
            }
        }
        system.set_derivation(known.system.derivation());
        system.enforce(known.system.enforcement(), known.system.baumgarte_gain());
        let row = vec![0.0; 2 * system.len() + system.description().output_len()];
        Some(Continuous { system, row, ..known })
    }

    /// The steps, s.
    pub fn steps(&self) -> &[[f64; 2]] {
        &self.steps
    }

    /// The step in which a time lies; at the end of two, the one that `after` says.
    pub fn step_at(&self, t: f64, after: bool) -> usize {
        let before = |step: &[f64; 2]| if after { step[1] <= t } else { step[1] < t };
        self.steps.partition_point(before).min(self.steps.len() - 1)
    }

    /// The mechanism with the equations in force in a step, and the state [q; q'] at a time of it.
    pub fn state(&mut self, step: usize, t: f64) -> (&dyn System, &[f64]) {
        self.enter(step);
        let size = 2 * self.system.len();
        let y = &mut self.row[..size];
        self.run.trajectory.evaluate_on(t, t <= self.steps[step][0], y);
        if let Some(projection) = &mut self.projection {
            // Where no projection is possible the state stays as it is.
            let _ = projection.project(&*self.system, t, y);
        }
        (&*self.system, &self.row[..size])
    }

    /// All columns at a time of a step.
    pub fn row(&mut self, step: usize, t: f64) -> &[f64] {
        let size = self.state(step, t).1.len();
        if let Some(tally) = &self.run.tally {
            let [from, to] = self.steps[step];
            let rate = |t: f64, after: bool| {
                let mut y = vec![0.0; size];
                self.run.trajectory.evaluate_on(t, after, &mut y);
                y.split_off(size / 2)
            };
            let a: Vec<f64> =
                rate(to, false).iter().zip(rate(from, true)).map(|(w, v)| (w - v) / (to - from)).collect();
            let unknown = vec![f64::NAN; self.system.description().rows.len()];
            let lambda = tally.forces.get(step).unwrap_or(&unknown);
            let (y, outputs) = self.row.split_at_mut(size);
            self.system.outputs(At::packed(t, y, size / 2).accelerated(&a).constrained(lambda), outputs);
            return &self.row;
        }
        let (y, outputs) = self.row.split_at_mut(size);
        evaluate_outputs(&*self.system, t, y, &mut self.accelerations, outputs);
        &self.row
    }

    /// The wanted columns at a time of a step.
    pub fn values(&mut self, step: usize, t: f64, values: &mut [f64]) {
        let size = 2 * self.system.len();
        if self.columns.iter().any(|column| *column >= size) {
            self.row(step, t);
        } else {
            self.state(step, t);
        }
        values.iter_mut().zip(&self.columns).for_each(|(value, column)| *value = self.row[*column]);
    }

    /// Puts the equations in force that a step was made with.
    fn enter(&mut self, step: usize) {
        if self.step == Some(step) {
            return;
        }
        if self.step.is_none_or(|known| known > step) {
            (self.phases, self.modes, self.memory) = (0, 0, 0);
        }
        let start = self.steps[step][0];
        let (phases, modes) = (&self.run.phases[self.phases..], &self.run.scenery.modes[self.modes..]);
        let held = &self.run.scenery.memory[self.memory..];
        let assigned = held.iter().take_while(|(from, _)| *from <= start).count();
        if let Some((_, memory)) = held[..assigned].last() {
            self.system.set_memory(memory);
        }
        self.memory += assigned;
        let entered = phases.iter().take_while(|(from, _)| *from <= start).count();
        let switched = modes.iter().take_while(|(from, _)| *from <= start).count();
        if let Some((_, phase)) = phases[..entered].last() {
            self.system.set_phase(*phase);
        }
        if let Some((_, modes)) = modes[..switched].last() {
            self.system.set_modes(modes);
        }
        (self.phases, self.modes) = (self.phases + entered, self.modes + switched);
        let fresh = entered > 0 || self.step.is_none();
        self.step = Some(step);
        if let Some(projection) = self.projection.as_mut().filter(|_| fresh) {
            let y = &mut self.row[..2 * self.accelerations.len()];
            self.run.trajectory.evaluate_on(start, true, y);
            projection.hold(&*self.system, start, y);
        }
    }
}

impl Run {
    /// The least and the largest value that a coordinate, rate or output (SI) takes over the run.
    ///
    /// They come from dense output, with all that lies between reported states and both sides of every event; of a run that kept none,
    /// from the reported states.  `None` where nothing has this name, or it is a number nowhere.
    ///
    /// # Example
    /// ```
    /// use dalembert::prelude::*;
    /// # dalembert::model!(yaml = r#"
    /// # name: Spring
    /// # parameters: {m: 1 kg, k: 4 N/m}
    /// # coordinates: {x: m}
    /// # bodies: {b: {mass: m, position: "[x, 0]"}}
    /// # springs: {s: {stretch: x, stiffness: k, along: "[1, 0]", on: b}}
    /// # scene: {start: {x: 1}, until: 3}
    /// # "#);
    /// let run = Spring::default().simulate().every(3.0).run()?;
    /// let (low, high) = run.extremes("x'").unwrap();
    /// assert!((low + 2.0).abs() < 1e-6 && (high - 2.0).abs() < 1e-6);
    /// # Ok::<(), dalembert::Error>(())
    /// ```
    pub fn extremes(&self, name: &str) -> Option<(f64, f64)> {
        self.extremes_of(&[name.to_owned()]).pop().flatten()
    }

    /// [`Run::extremes`] of several columns at once.
    pub(crate) fn extremes_of(&self, names: &[String]) -> Vec<Option<Range>> {
        let dense = Continuous::new(self, names).map(|mut own| {
            let steps = own.steps().to_vec();
            extremes(&steps, names.len(), &mut |step, t, values| {
                own.values(step, t, values);
                values.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = f64::NAN);
            })
        });
        let dense = dense.unwrap_or_else(|| vec![(f64::INFINITY, f64::NEG_INFINITY); names.len()]);
        let with_rows = |(name, range): (&String, Range)| {
            let rows = self.column(name)?.into_iter().filter(|value| value.is_finite());
            let (low, high) = rows.fold(range, |(low, high), value| (low.min(value), high.max(value)));
            (low <= high).then_some((low, high))
        };
        names.iter().zip(dense).map(with_rows).collect()
    }
}
