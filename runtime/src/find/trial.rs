//! A run at some values of what is unknown, with its slopes.

use crate::constrain::KeptSpin;
use crate::error::{Error, NotFound};
use crate::mechanism::System;
use crate::run::Names;
use crate::simulate::{Origin, Settings};
use crate::vary::{Point, Second, Unknown, Varied, second, varied};

/// What is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sought {
    /// A number of the start, or a parameter.
    Of(Unknown),
    /// Where the run ends.
    Until,
}

/// Where runs come from.
pub(super) struct Source {
    pub system: Box<dyn System>,
    pub settings: Settings,
    pub origin: Origin,
    pub sought: Vec<Sought>,
    /// Times at which slopes are wanted; `None`: the end.
    pub times: Option<Vec<f64>>,
    /// The steps of the first run; 0 before it.
    pub steps: u64,
}

/// A trial that takes so many times the steps of the first, and so many more, chatters, or goes somewhere else.
const MORE_STEPS: u64 = 10;
const STEPS_ANYHOW: u64 = 1000;

/// A run that was tried.
pub(super) struct Trial {
    pub varied: Varied,
}

impl Source {
    /// Runs at these values, with slopes.
    pub fn try_at(&mut self, values: &[f64]) -> Result<Trial, Error> {
        let settings = self.settings.clone();
        self.try_with(values, settings)
    }

    /// A second run at the values of a first one.
    pub fn second(&mut self, values: &[f64], first: &Trial) -> Option<Second<Trial>> {
        let settings = self.settings.clone();
        let again = |other: &Settings| self.try_with(values, other.clone());
        second(&first.varied, &settings, again, |trial| &trial.varied)
    }

    fn try_with(&mut self, values: &[f64], mut settings: Settings) -> Result<Trial, Error> {
        let n = self.system.len();
        for (sought, value) in self.sought.iter().zip(values) {
            if let Sought::Of(Unknown::Parameter(k)) = sought {
                self.system.set_parameter(*k, *value);
            }
        }
        if let Some(scene) = self.origin.scene {
            let scene = self.system.scene(scene);
            for (i, _) in self.origin.given.iter().enumerate().filter(|(_, given)| !**given) {
                let (list, from) = if i < n { (&mut settings.q, &scene.q) } else { (&mut settings.v, &scene.v) };
                list[i % n] = from[i % n];
            }
            settings.spins = KeptSpin::of_scene(&scene);
            settings.spins.retain(|spin| !self.origin.given[n..][spin.places()].contains(&true));
            settings.spins.iter().for_each(|spin| spin.put(&settings.q, &mut settings.v));
        }
        for (sought, value) in self.sought.iter().zip(values) {
            match sought {
                Sought::Of(Unknown::Start(k)) => settings.start_at(*k, *value),
                Sought::Until => settings.until = *value,
                Sought::Of(Unknown::Parameter(_)) => (),
            }
        }
        let unknowns: Vec<Unknown> = self
            .sought
            .iter()
            .filter_map(|sought| if let Sought::Of(unknown) = sought { Some(*unknown) } else { None })
            .collect();
        let most = if self.steps > 0 { MORE_STEPS * self.steps + STEPS_ANYHOW } else { u64::MAX };
        settings.max_steps = settings.max_steps.min(most);
        let varied = varied(&mut *self.system, &settings, &self.origin, &unknowns, self.times.as_deref());
        let varied = varied.map_err(|error| match error.takes_more_steps_than(most) {
            true => NotFound::LeadsAway { steps: most }.into(),
            false => error,
        })?;
        if self.steps == 0 {
            self.steps = varied.run.work.steps;
        }
        Ok(Trial { varied })
    }

    /// Whether each of what is sought is an angle.
    pub fn angles(&self) -> Vec<bool> {
        let description = self.system.description();
        let unit = |sought: &Sought| match sought {
            Sought::Of(Unknown::Parameter(k)) => description.parameters.get(*k).map(|known| &known.unit),
            Sought::Of(Unknown::Start(k)) => description.coordinates.get(*k).map(|known| &known.unit),
            Sought::Until => None,
        };
        self.sought.iter().map(|sought| unit(sought).is_some_and(|unit| *unit == "rad")).collect()
    }

    /// Names of [q; q'] and of the outputs.
    pub fn names(&self) -> Vec<String> {
        Names::of(self.system.description()).columns()
    }
}

impl Trial {
    /// What there is at the end.
    pub fn end(&self) -> Option<&Point> {
        self.varied.points.last()
    }

    /// A number at the end; none where there is no end.
    pub fn at_end(&self, column: usize) -> f64 {
        self.end().map_or(f64::NAN, |end| end.values[column])
    }

    /// The slopes of a number at a point by all that is sought.
    pub fn slopes(&self, sought: &[Sought], point: &Point, column: usize) -> Vec<f64> {
        let mut of_unknowns = point.slopes.iter();
        let slope = |sought: &Sought| match sought {
            // Where an event ends the run its time decides nothing.
            Sought::Until if self.varied.run.ended_by().is_some() => 0.0,
            Sought::Until => point.rates[column],
            Sought::Of(_) => of_unknowns.next().map_or(0.0, |slopes| slopes[column]),
        };
        sought.iter().map(slope).collect()
    }

    /// How large a number gets along the run, between reported times not counted.
    pub fn size(&self, column: usize) -> f64 {
        let width = 2 * self.varied.run.state(0).q.len();
        let run = &self.varied.run;
        let of = |k: usize| match column.checked_sub(width) {
            None => run.rows[width * k + column],
            Some(output) => run.outputs[run.outputs.len() / run.len() * k + output],
        };
        (0..run.len()).map(|k| of(k).abs()).filter(|x| x.is_finite()).fold(0.0, f64::max)
    }
}
