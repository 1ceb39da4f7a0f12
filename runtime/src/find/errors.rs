//! How far off what was found may be.

use super::found::Value;
use super::multiple::MultipleRoot;
use super::search::{Condition, Equations, Seeker, Solution};
use super::trial::{Sought, Trial};
use crate::vary::Second;

/// How far unknowns, and what conditions come to, may be off.
pub(super) struct Errors {
    pub values: Vec<f64>,
    pub reached: Vec<f64>,
    /// And where the motion ends, s.
    pub end: f64,
}

impl Seeker {
    /// What a second run would have the unknowns be otherwise, and the last step; and how far its conditions are off.  Along the
    /// direction of a multiple root, what both leave of the equations tells how far away it may be.
    pub fn errors(
        &mut self,
        solution: &Solution,
        scales: &[f64],
        multiple: Option<&MultipleRoot>,
        equations: &dyn Fn(&Seeker, Trial, &[f64]) -> Equations,
    ) -> Errors {
        self.runs += 1;
        let Some(Second { run: other, told }) = self.source.second(&solution.values, &solution.equations.trial) else {
            let unknown = |count| vec![f64::NAN; count];
            return Errors { values: unknown(scales.len()), reached: unknown(self.conditions.len()), end: f64::NAN };
        };
        let ends = [solution.equations.trial.end(), other.end()].map(|end| end.map_or(&[][..], |end| &end.values));
        let off = |condition: &Condition| match ends.map(|values| values.get(condition.column)) {
            [Some(value), Some(other)] => told * (value - other).abs(),
            _ => f64::NAN,
        };
        let reached = self.conditions.iter().map(off).collect();
        let ends_alike = told * self.end_difference(&solution.equations.trial, &other);
        let other = equations(self, other, scales);
        let r = &solution.equations.r;
        let linear = multiple.map_or(&solution.linear, |root| &root.others);
        let mut moved = (told * (linear.step(&other.r) - linear.step(r)).abs()).add_scalar(linear.step(r).norm());
        if let Some(root) = multiple {
            let away = root.distance(r, &(told * (&other.r - r)), self.source.settings.tolerance);
            moved += away * root.direction.abs();
        }
        let values: Vec<f64> = moved.iter().zip(scales).map(|(moved, scale)| moved * scale).collect();
        let end = ends_alike + self.end_error(&solution.equations.trial, &values);
        Errors { values, reached, end }
    }

    /// How far another run ends from this one, s, where an event ends them.
    pub fn end_difference(&self, trial: &Trial, other: &Trial) -> f64 {
        let [run, other] = [trial, other].map(|trial| &trial.varied.run);
        if run.ended_by().is_some() { (run.last().t - other.last().t).abs() } else { 0.0 }
    }

    /// By how much errors of the unknowns move the end of a run, s.
    pub fn end_error(&self, trial: &Trial, errors: &[f64]) -> f64 {
        let mut of_unknowns = trial.varied.end_time.iter();
        let moved = self.source.sought.iter().zip(errors).map(|(sought, error)| match sought {
            Sought::Until if trial.varied.run.ended_by().is_some() => 0.0,
            Sought::Until => *error,
            Sought::Of(_) => of_unknowns.next().map_or(0.0, |slope| (slope * error).abs()),
        });
        moved.sum()
    }
}

/// Where a run ends.
pub(super) fn end_time(trial: &Trial, error: f64) -> Value {
    Value { name: "t".to_owned(), value: trial.varied.run.last().t, error }
}

/// Values with their names and errors.
pub(super) fn value_list(names: &[String], values: &[f64], errors: &[f64]) -> Vec<Value> {
    let list = names.iter().zip(values).zip(errors);
    list.map(|((name, value), error)| Value { name: name.clone(), value: *value, error: *error }).collect()
}
