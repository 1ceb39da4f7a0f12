//! Running a mechanism: settings, one call for any [`System`], and the typed way in.

use std::time::Instant;

use crate::error::{Error, Failure};
use crate::integrate::{March, Method, Pace, Rates, Tolerance};
use crate::mechanism::{Scene, System};
use crate::run::{Plan, Recorder, Run};
use crate::trust::Warning;

/// How to run.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Generalized coordinates at the start, SI.
    pub q: Vec<f64>,
    /// Their rates at the start, SI.
    pub v: Vec<f64>,
    /// Where the run begins, s; 0 unless said otherwise.
    pub from: f64,
    /// Where it ends, s.
    pub until: f64,
    /// Relative tolerance, and absolute in units of each coordinate's scale (the larger of its start and 1).
    /// Lower: more steps, smaller errors, down to about 10⁻¹⁴.
    pub tolerance: f64,
    /// Spacing of reported states, s; `None`: 500 points.
    pub every: Option<f64>,
    /// The method of integration.
    pub method: Method,
    /// A fixed step, s; `None`: chosen by the method.
    pub step: Option<f64>,
    /// The longest step the method may choose, s; `None`: the whole run.
    pub longest_step: Option<f64>,
    /// The run fails beyond this many steps; 10⁷ unless said otherwise.
    pub max_steps: u64,
    /// Whether to keep dense output for [`Run::at`] (on unless said otherwise); it costs memory and, with
    /// `dop853`, three evaluations per step.
    pub dense: bool,
    /// Whether to watch invariants and the energy balance (on unless said otherwise).
    pub watch: bool,
}

impl Settings {
    /// The settings of a scene, everything else as usual.
    pub fn new(scene: &Scene) -> Self {
        Settings {
            q: scene.q.clone(),
            v: scene.v.clone(),
            from: 0.0,
            until: scene.until,
            tolerance: scene.tolerance,
            every: scene.every,
            method: Method::Auto,
            step: None,
            longest_step: None,
            max_steps: 10_000_000,
            dense: true,
            watch: true,
        }
    }

    /// The tolerances below this one are beyond rounding: about 100 unit round-offs.
    pub const TIGHTEST: f64 = 1e-14;

    fn check(&self, n: usize) -> Result<(), Error> {
        for (setting, list) in [("start", &self.q), ("start of the rates", &self.v)] {
            if list.len() != n {
                return Err(Error::WrongLength { setting, given: list.len(), expected: n });
            }
            if let Some(value) = list.iter().find(|value| !value.is_finite()) {
                return Err(Error::BadSetting { setting, value: *value, expected: "finite numbers" });
            }
        }
        let positive = |setting, value: Option<f64>| match value {
            Some(value) if !(value > 0.0 && value.is_finite()) => {
                Err(Error::BadSetting { setting, value, expected: "a positive number" })
            }
            _ => Ok(()),
        };
        if !self.from.is_finite() {
            return Err(Error::BadSetting { setting: "from", value: self.from, expected: "a finite time" });
        }
        if !(self.until >= self.from && self.until.is_finite()) {
            return Err(Error::BadSetting { setting: "until", value: self.until, expected: "a time after the start" });
        }
        positive("tolerance", Some(self.tolerance))?;
        positive("every", self.every)?;
        positive("step", self.step)?;
        positive("longest_step", self.longest_step)?;
        if self.step.is_none() && !self.method.is_adaptive() {
            let expected = "a positive `step`, since this method does not choose its own";
            return Err(Error::BadSetting { setting: "step", value: f64::NAN, expected });
        }
        Ok(())
    }
}

/// Runs a mechanism.
///
/// # Errors
/// A setting without meaning, or [`Error::Run`] with the time, the state and what was computed until then.
pub fn simulate<S: System + ?Sized>(system: &mut S, settings: &Settings) -> Result<Run, Error> {
    let clock = Instant::now();
    settings.check(system.len())?;
    let method = settings.method.resolve(settings.step, settings.tolerance);
    let mut warnings = Vec::new();
    let rates = Rates::new(system.len(), settings.watch && !system.description().structure.conservative);
    let mut y = vec![0.0; rates.width];
    y[..rates.n].copy_from_slice(&settings.q);
    y[rates.n..2 * rates.n].copy_from_slice(&settings.v);
    let span = settings.until - settings.from;
    let pace = match settings.step {
        Some(step) => Pace::Fixed(step),
        None => {
            let used = settings.tolerance.max(Settings::TIGHTEST);
            if used > settings.tolerance {
                warnings.push(Warning::ToleranceTooTight { asked: settings.tolerance, used });
            }
            let tolerance = Tolerance::new(used, &y, rates.controlled());
            Pace::Adaptive { tolerance, longest: settings.longest_step.unwrap_or(span) }
        }
    };
    let tolerance = match &pace {
        Pace::Fixed(_) => None,
        Pace::Adaptive { tolerance, .. } => Some(tolerance.relative),
    };
    let mut march = March::new(method, pace, rates, settings.from, y, settings.max_steps);
    let plan = Plan {
        until: settings.until,
        every: settings.every.unwrap_or(if span > 0.0 { span / 500.0 } else { 1.0 }),
        dense: settings.dense,
        watch: settings.watch,
        pieces: march.pieces(),
        method,
        tolerance,
        step: settings.step,
    };
    let mut recorder = Recorder::new(&plan, system, settings.from, march.state());
    for warning in warnings {
        recorder.warn(warning);
    }
    let outcome = match march.begin(system, settings.until) {
        Ok(()) => march.advance(system, settings.until, &mut recorder),
        Err(cause) => Err(cause),
    };
    let state = recorder.state(march.time(), march.state(), Vec::new());
    let run = recorder.finish(system, march.time(), march.state(), march.work(), clock.elapsed().as_secs_f64());
    match outcome {
        Ok(_) => Ok(run),
        Err(cause) => Err(Error::Run(Box::new(Failure { cause, state, run }))),
    }
}

#[cfg(test)]
mod tests;
