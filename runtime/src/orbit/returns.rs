//! How far methods miss the start of a motion that repeats, each time that it should be back.

use std::ops::ControlFlow;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::Orbit;
use crate::error::Error;
use crate::mechanism::System;
use crate::precision::reference::{AGREED, SMALL, TIMES, column, ranges};
use crate::precision::{Arithmetic, Candidate, Plan, Reference, WorkPrecision};
use crate::simulate::Settings;
use crate::vary::leg;

/// What differs by more than this part of its range after a period is shifted or turned each time.
const SHIFTED: f64 = 1e-6;

impl WorkPrecision {
    /// Charts of candidates that go through a motion which repeats, so many times: errors are measured from its start, to which it comes back
    /// after each period.  Candidates begin where the motion does, whatever their own start is.
    ///
    /// What is known of the start after k periods is what the k-th power of the whole period's map makes of its error, and k errors of the period
    /// at the rates there.
    ///
    /// ```
    /// # use dalembert::prelude::*;
    /// # use dalembert::precision::{Candidate, Plan, WorkPrecision};
    /// # dalembert::model!(yaml = r#"
    /// # name: Swing
    /// # coordinates: {theta: rad}
    /// # kinetic_energy: theta'^2/2
    /// # potential_energy: -9.81*cos(theta)
    /// # scene: {start: {theta: 2}, until: 3}
    /// # "#);
    /// let swing = Swing::default().system();
    /// let orbit = Swing::default().simulate().orbit().find()?;
    /// let candidates = Candidate::methods(&swing, &Settings::new(&swing.scene(0)));
    /// let found = WorkPrecision::of_returns(&orbit, 100, &candidates, &Plan::default(), &mut |_| std::ops::ControlFlow::Continue(()))?;
    /// println!("{}", found.sentence());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A motion that events change; one of which fewer than eight digits are known after so many periods ([`Error::NoReference`]); those of
    /// [`WorkPrecision::measure`].
    pub fn of_returns(
        orbit: &Orbit,
        periods: usize,
        candidates: &[Candidate],
        plan: &Plan,
        progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
    ) -> Result<WorkPrecision, Error> {
        let begun = |candidate: &Candidate| {
            let settings = begun(&candidate.settings, orbit, periods as f64);
            Candidate::new(candidate.name.clone(), &*candidate.system, settings)
        };
        let candidates: Vec<Candidate> = candidates.iter().map(begun).collect();
        let of = |first: &Candidate| Reference::of_returns(orbit, periods, first, &plan.columns);
        let mut found = WorkPrecision::against(&candidates, plan, of, progress)?;
        found.title += &format!(", {periods} times round");
        Ok(found)
    }
}

impl Reference {
    /// The start of a motion that repeats, after each of so many periods, or of as many of them as errors are looked at.
    fn of_returns(orbit: &Orbit, periods: usize, first: &Candidate, columns: &[String]) -> Result<Reference, Error> {
        if let Some(event) = orbit.events.first() {
            let why = format!("`{event}` changes the motion that repeats; its returns are charted where no event does");
            return Err(Error::NoReference { why });
        }
        let run = &orbit.run;
        let known = spread(&mut *first.system.boxed_clone(), &first.settings, orbit, periods)?;
        if let Some(lost) = known.iter().position(|uncertainty| uncertainty.is_nan() || *uncertainty > AGREED) {
            let why = format!(
                "changes of the motion grow: after {} of {periods} periods fewer than eight digits of it are known; go round less often",
                lost + 1
            );
            return Err(Error::NoReference { why });
        }
        let shown: Vec<String> = run.shown_names().into_iter().take(run.first().q.len()).collect();
        let columns = if columns.is_empty() { shown } else { columns.to_vec() };
        let of_run = columns.iter().map(|name| column(run, name)).collect::<Result<Vec<_>, Error>>()?;
        let ranges_of_run = ranges(run, &columns, &of_run, SMALL);
        // As many of the returns as there are other times at which errors are looked at.
        let stride = periods.div_ceil(TIMES as usize).max(1);
        let counts: Vec<usize> = (0..=periods).filter(|k| k % stride == 0 || *k == periods).collect();
        let returned = |(values, range): (&Vec<f64>, &f64)| {
            let (start, end) = (values[0], values[values.len() - 1]);
            let more = if (end - start).abs() > SHIFTED * range { end - start } else { 0.0 };
            counts.iter().map(|k| start + *k as f64 * more).collect::<Vec<f64>>()
        };
        let values: Vec<Vec<f64>> = of_run.iter().zip(&ranges_of_run).map(returned).collect();
        let from = first.settings.from;
        let times: Vec<f64> = counts.iter().map(|k| from + *k as f64 * orbit.period.value).collect();
        let components: Vec<String> = run.column_names().into_iter().take(2 * run.first().q.len()).collect();
        let states = components.iter().map(|name| column(run, name)).collect::<Result<Vec<_>, Error>>()?;
        let inner: Arc<[f64]> = times[1..times.len() - 1].into();
        Ok(Reference {
            methods: [run.method; 2],
            agreement: known.iter().copied().fold(0.0, f64::max),
            is_cut: false,
            arithmetic: Arithmetic::Returns { period: orbit.period.value, periods },
            rests: values.iter().map(|values| vec![0.0; values.len()]).collect(),
            ranges: ranges_of_run,
            start: orbit.start.iter().map(|value| value.value).collect(),
            sizes: ranges(run, &components, &states, 1.0),
            reports: (Some(times[times.len() - 1] - from), inner),
            columns,
            times,
            values,
            end: None,
            evaluations: run.work.evaluations * periods as u64,
            steps: run.work.steps * periods as u64,
        })
    }
}

/// The settings of a run from the start of a motion that repeats, for so many periods.
fn begun(settings: &Settings, orbit: &Orbit, periods: f64) -> Settings {
    let (q, v) = orbit.start.split_at(orbit.start.len() / 2);
    let values = |half: &[crate::find::Value]| half.iter().map(|value| value.value).collect();
    Settings {
        q: values(q),
        v: values(v),
        held_q: Vec::new(),
        held_v: Vec::new(),
        spins: Vec::new(),
        start_conditions: 0..0,
        phase: orbit.run.phases.first().map_or(settings.phase, |(_, phase)| *phase),
        until: settings.from + periods * orbit.period.value,
        ..settings.clone()
    }
}

/// What is not known of the state after each of so many periods, the most of it in parts of the ranges of coordinates and rates.
fn spread(system: &mut dyn System, settings: &Settings, orbit: &Orbit, periods: usize) -> Result<Vec<f64>, Error> {
    let once = Settings { tolerance: Settings::TIGHTEST, step: None, ..begun(settings, orbit, 1.0) };
    let period = leg(system, &Settings { method: orbit.run.method, ..once }, &[])?;
    let width = orbit.start.len();
    let map = DMatrix::from_fn(width, width, |row, column| period.columns[column][row]);
    let errors = orbit.start.iter().map(|value| value.error.max(0.5 * f64::EPSILON * value.value.abs()));
    let errors = DVector::from_iterator(width, errors);
    let names: Vec<String> = orbit.run.column_names().into_iter().take(width).collect();
    let states = names.iter().map(|name| column(&orbit.run, name)).collect::<Result<Vec<_>, Error>>()?;
    let sizes = ranges(&orbit.run, &names, &states, 1.0);
    let mut power = DMatrix::identity(width, width);
    let after = |k: usize| {
        power = &map * &power;
        let late = (k + 1) as f64 * orbit.period.error;
        let made = power.abs() * &errors;
        let of = |i: usize| (made[i] + late * period.end_rate[i].abs()) / sizes[i];
        (0..width).map(of).fold(0.0, |most: f64, one| if one.is_nan() { one } else { most.max(one) })
    };
    Ok((0..periods).map(after).collect())
}
