//! What is unknown, what is wanted, and the way to it.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::asked::goals_stay;
use super::errors::{Errors, end_time, value_list};
use super::extreme;
use super::fit::{self, Record};
use super::found::{Found, Value};
use super::multiple::MultipleRoot;
use super::newton::Linearised;
use super::trial::{Sought, Source, Trial};
use crate::error::{Error, NoSlopes, NotFound};
use crate::mechanism::{Extreme, HIDDEN, MotionNumbers, System};
use crate::simulate::{Described, Settings, Simulation};
use crate::vary::{Unknown, named, unknown};

/// A search that is being described.
///
/// Unknowns are parameters, coordinates and rates at the start (`theta'`), and the time `until` at which the run ends.  What is wanted of
/// coordinates, rates and outputs at the end of the run: values ([`Search::such_that`]), the largest or the smallest value, or that they
/// follow a record.
#[must_use = "nothing happens before `solve`"]
pub struct Search {
    described: Result<Described, Error>,
    pub(super) unknowns: Vec<(String, f64)>,
    pub(super) conditions: Vec<(String, f64)>,
    pub(super) extreme: Option<(String, Extreme)>,
    pub(super) record: Option<Record>,
    /// The motion of the file that began it, with its numbers.
    pub(super) motion: Option<(usize, MotionNumbers)>,
}

impl<S: System + 'static> Simulation<S> {
    /// Begins a search for values for which this run does what is wanted.
    ///
    /// ```
    #[doc = include_str!("../../examples/best_angle.rs")]
    /// ```
    pub fn find(self) -> Search {
        let described = self.described();
        Search::of(described.map(|(system, settings, origin)| (Box::new(system) as Box<dyn System>, settings, origin)))
    }
}

/// The name of the end of a run among unknowns.
pub(super) const UNTIL: &str = "until";
/// Newton steps at most: a triple root takes fifty for nine digits.
pub(super) const STEPS: usize = 60;
/// A step is shortened by halves at most so often.
pub(super) const HALVES: usize = 14;
/// Steps of this size, in parts of the unknowns, are rounding of runs at the tightest tolerance.
pub(super) const LEAST: f64 = 1e-14;
/// Conditions that are missed by this part of what is wanted of them, or of what the motion makes of them, are not met: the
/// steps end where rounding does, some six decades below.
pub(super) const MISSED: f64 = 1e-7;
/// Steps that become shorter by this factor or less each time do not converge like those to a simple root; so many in a row tell.  They end
/// where what is left is no more than the tolerance of the runs.
const SLOW: f64 = 0.3;
const IN_A_ROW: usize = 4;

impl Search {
    /// Of a run that was described.
    pub(crate) fn of(described: Result<Described, Error>) -> Search {
        Search { described, unknowns: Vec::new(), conditions: Vec::new(), extreme: None, record: None, motion: None }
    }

    /// Something unknown, with a guess, SI; another guess takes the place of the first.
    pub fn unknown(mut self, name: &str, guess: f64) -> Self {
        put(&mut self.unknowns, name, guess);
        self
    }

    /// A value, SI, that a coordinate, a rate or an output is to have at the end of the run; another value takes the place of the first.
    pub fn such_that(mut self, name: &str, value: f64) -> Self {
        put(&mut self.conditions, name, value);
        self.record = None;
        self
    }

    /// A coordinate, a rate or an output that is to be as large as it can be near by at the end of the run.
    pub fn maximise(mut self, name: &str) -> Self {
        self.extreme = Some((name.to_owned(), Extreme::Largest));
        self.record = None;
        self
    }

    /// As small.
    pub fn minimise(mut self, name: &str) -> Self {
        self.extreme = Some((name.to_owned(), Extreme::Smallest));
        self.record = None;
        self
    }

    /// A record that the motion is to follow as well as it can, by least squares; conditions and extremes said before it are no more.
    pub fn fit(mut self, record: Record) -> Self {
        self.record = Some(record);
        (self.conditions, self.extreme) = (Vec::new(), None);
        self
    }

    /// Lets an event do nothing: it is not located, and not recorded.
    pub fn ignore(mut self, event: &str) -> Self {
        if let Ok((system, settings, _)) = &mut self.described
            && let Err(error) = settings.ignore(system.description(), event)
        {
            self.described = Err(error);
        }
        self
    }

    /// Searches.
    ///
    /// # Errors
    /// Names that are unknown; [`Error::NotFound`] with what stands in the way; what ends the first run early; [`Error::NoSlopes`].
    pub fn solve(self) -> Result<Found, Error> {
        let (system, settings, origin) = self.described?;
        let mut sought = Vec::with_capacity(self.unknowns.len());
        for (name, _) in &self.unknowns {
            sought.push(if name == UNTIL { Sought::Until } else { Sought::Of(unknown(&*system, name)?) });
        }
        goals_stay(&*system, self.motion.as_ref(), &self.conditions, &sought)?;
        let times = self.record.as_ref().map(|record| record.times.clone());
        let settings = Settings { every: None, digits: false, ..settings };
        let source = Source { system, settings, origin, sought, times, steps: 0 };
        let names = self.unknowns.iter().map(|(name, _)| name.clone()).collect();
        let guess: Vec<f64> = self.unknowns.iter().map(|(_, guess)| *guess).collect();
        let columns = source.names();
        let place = |name: &str| {
            let found = columns.iter().position(|known| known == name);
            let known = columns.iter().filter(|name| !name.starts_with(HIDDEN));
            found.ok_or_else(|| Error::unknown("coordinate, rate or output", name, known))
        };
        let mut conditions = Vec::with_capacity(self.conditions.len());
        for (name, value) in &self.conditions {
            conditions.push(Condition { name: name.clone(), column: place(name)?, value: *value });
        }
        let extreme = match &self.extreme {
            Some((name, extreme)) => Some((place(name)?, name.clone(), *extreme)),
            None => None,
        };
        let of = source.sought.iter().zip(&self.unknowns);
        let unknowns: Vec<(String, Unknown)> = of
            .filter_map(
                |(sought, (name, _))| if let Sought::Of(of) = sought { Some((name.clone(), *of)) } else { None },
            )
            .collect();
        let record = match self.record {
            Some(record) => {
                let places = record.columns.iter().map(|(name, _)| place(name)).collect::<Result<Vec<_>, Error>>()?;
                Some((record, places))
            }
            None => None,
        };
        let mut seeker = Seeker { source, names, conditions, runs: 0, fault: None, other_event: None };
        let find = |seeker: &mut Seeker, guess: &[f64]| match (&extreme, &record) {
            (_, Some((record, places))) => fit::fit(seeker, guess, record, places),
            (Some(extreme), None) => extreme::find(seeker, guess, extreme),
            (None, None) => seeker.meet(guess),
        };
        let found = find(&mut seeker, &guess).map_err(|error| named(error, &unknowns))?;
        Ok(turned_back(&mut seeker, &guess, found, &find))
    }
}

/// A search from a guess.
type Finds<'a> = dyn Fn(&mut Seeker, &[f64]) -> Result<Found, Error> + 'a;

/// What was found, with as many whole turns taken from each unknown angle as bring it nearest to its guess, if that is found too.
fn turned_back(seeker: &mut Seeker, guess: &[f64], found: Found, find: &Finds<'_>) -> Found {
    let angles = seeker.source.angles();
    let nearest = |(value, (guess, is_angle)): (&Value, (&f64, bool))| {
        let turns = ((value.value - guess) / TAU).round();
        if is_angle { value.value - turns * TAU } else { value.value }
    };
    let wanted: Vec<f64> = found.values.iter().zip(guess.iter().zip(angles)).map(nearest).collect();
    let is_at = |found: &Found, wanted: &[f64], apart: f64| {
        found
            .values
            .iter()
            .zip(wanted)
            .all(|(value, wanted)| (value.value - wanted).abs() <= apart * wanted.abs().max(1.0))
    };
    if is_at(&found, &wanted, 0.0) {
        return found;
    }
    let same = seeker.source.settings.tolerance.sqrt();
    match find(seeker, &wanted) {
        Ok(again) if is_at(&again, &wanted, same) => Found { steps: found.steps + again.steps, ..again },
        _ => found,
    }
}

/// Gives a name a value, in the place of the one that it has.
fn put(list: &mut Vec<(String, f64)>, name: &str, value: f64) {
    match list.iter_mut().find(|(known, _)| known == name) {
        Some((_, known)) => *known = value,
        None => list.push((name.to_owned(), value)),
    }
}

/// A value that something is to have at the end.
pub(super) struct Condition {
    pub name: String,
    pub column: usize,
    pub value: f64,
}

/// A search under way.
pub(super) struct Seeker {
    pub source: Source,
    pub names: Vec<String>,
    pub conditions: Vec<Condition>,
    pub runs: usize,
    /// Why the last trial that failed has no slopes.
    pub fault: Option<Box<NoSlopes>>,
    /// An event by which trials differ from what they start from.
    pub other_event: Option<String>,
}

/// A system of equations at some values of the unknowns, in their scales and its own.
pub(super) struct Equations {
    pub trial: Trial,
    pub r: DVector<f64>,
    pub j: DMatrix<f64>,
    /// The units of r, which may be those of the trial.
    pub units: DVector<f64>,
}

/// Where Newton's steps ended.
pub(super) struct Solution {
    pub values: Vec<f64>,
    pub equations: Equations,
    pub linear: Linearised,
    pub steps: usize,
}

impl Seeker {
    /// Natural sizes of the unknowns: they themselves, and 1 of what is 0.
    pub fn scales(&self, values: &[f64], guess: &[f64]) -> Vec<f64> {
        let size =
            |(value, guess): (&f64, &f64)| Some(value.abs().max(guess.abs())).filter(|x| *x > 0.0).unwrap_or(1.0);
        values.iter().zip(guess).map(size).collect()
    }

    /// Runs at these values.
    pub fn try_at(&mut self, values: &[f64]) -> Result<Trial, Error> {
        self.runs += 1;
        let tried = self.source.try_at(values);
        match tried {
            Err(error) if error.is_interruption() => Err(NotFound::Interrupted { values: self.named(values) }.into()),
            Err(Error::NoSlopes(why)) => {
                self.fault = Some(why.clone());
                Err(Error::NoSlopes(why))
            }
            tried => tried,
        }
    }

    /// c = value − wanted of all conditions, in units of what is wanted or of what the motion makes of them, with the slopes.
    pub fn conditions_of(&self, trial: Trial, scales: &[f64]) -> Equations {
        let count = self.conditions.len();
        let (mut r, mut j) = (DVector::zeros(count), DMatrix::zeros(count, scales.len()));
        let mut units = DVector::from_element(count, 1.0);
        if let Some(end) = trial.end() {
            for (i, condition) in self.conditions.iter().enumerate() {
                let size = condition.size(&trial);
                units[i] = size;
                r[i] = (end.values[condition.column] - condition.value) / size;
                let slopes = trial.slopes(&self.source.sought, end, condition.column);
                for (k, slope) in slopes.iter().enumerate() {
                    j[(i, k)] = slope * scales[k] / size;
                }
            }
        }
        Equations { trial, r, j, units }
    }

    /// Meets the conditions.
    fn meet(&mut self, guess: &[f64]) -> Result<Found, Error> {
        if self.conditions.is_empty() || guess.is_empty() {
            return Err(NotFound::NothingWanted.into());
        }
        let scales = self.scales(guess, guess);
        let equations = |seeker: &Seeker, trial: Trial, scales: &[f64]| seeker.conditions_of(trial, scales);
        let solution = self.newton(guess, &scales, &equations)?;
        let residuals = self.residuals(&solution.equations.trial);
        if solution.equations.r.iter().any(|r| r.abs() > MISSED) {
            if solution.linear.rank() == self.conditions.len() {
                return Err(self.stuck(&solution.equations.trial, &solution.values).into());
            }
            return Err(NotFound::Contradictory { residuals, values: self.named(&solution.values) }.into());
        }
        let multiple = MultipleRoot::at(self, &solution, &scales, &equations);
        let errors = self.errors(&solution, &scales, multiple.as_ref(), &equations);
        let found = self.found(solution, errors);
        Ok(match multiple {
            Some(root) => Found { multiplicity: root.order, multiple_in: root.unknowns(&self.names), ..found },
            None => found,
        })
    }

    /// Shortest Gauss-Newton steps, shortened until the next one would be shorter.
    pub fn newton(
        &mut self,
        guess: &[f64],
        scales: &[f64],
        equations: &dyn Fn(&Seeker, Trial, &[f64]) -> Equations,
    ) -> Result<Solution, Error> {
        let mut values = guess.to_vec();
        let first = self.try_at(&values)?;
        let mut now = equations(self, first, scales);
        let tolerance = self.source.settings.tolerance;
        let (mut before, mut slow, mut rank) = (f64::INFINITY, 0, 0);
        for steps in 0..STEPS {
            let linear = Linearised::new(&now.j).at_least(rank);
            rank = linear.rank();
            let step = linear.step(&now.r);
            let size = step.norm();
            if !size.is_finite() {
                return Err(self.stuck(&now.trial, &values).into());
            }
            let stagnates = size < tolerance.sqrt() && size > 0.5 * before && slow < IN_A_ROW;
            slow = if size > SLOW * before && size < before { slow + 1 } else { 0 };
            let rounding = now.r.amax() <= tolerance;
            if size <= LEAST || stagnates || slow >= IN_A_ROW && rounding {
                return Ok(Solution { values, equations: now, linear, steps });
            }
            let taken = self.shortened(&values, scales, (&linear, &step, &now), equations)?;
            let Some((next, tried)) = taken else {
                // Where a whole step changes nothing any more, rounding is all that is left of it.
                if size <= tolerance.sqrt() || rounding {
                    return Ok(Solution { values, equations: now, linear, steps });
                }
                return Err(self.stuck(&now.trial, &values).into());
            };
            (values, now, before) = (next, tried, size);
        }
        Err(self.stuck(&now.trial, &values).into())
    }

    /// The first of a step's halves that goes through the same events, or else the first, after which a step by the same linearisation would be shorter.
    ///
    /// Source: the natural monotonicity test, Deuflhard, Newton Methods for Nonlinear Problems (2004), section 3.1.
    fn shortened(
        &mut self,
        values: &[f64],
        scales: &[f64],
        (linear, step, now): (&Linearised, &DVector<f64>, &Equations),
        equations: &dyn Fn(&Seeker, Trial, &[f64]) -> Equations,
    ) -> Result<Option<(Vec<f64>, Equations)>, Error> {
        let (mut part, mut otherwise) = (1.0, None);
        (self.fault, self.other_event) = (None, None);
        for _ in 0..HALVES {
            let next: Vec<f64> =
                values.iter().zip(scales).zip(step.iter()).map(|((x, scale), step)| x + part * scale * step).collect();
            if let Some(trial) = self.unless_broken_off(&next, values)? {
                let same = trial.varied.agrees(&now.trial.varied);
                self.other_event = now.trial.varied.differs_by(&trial.varied).or(self.other_event.take());
                let tried = equations(self, trial, scales);
                let missed = tried.r.component_mul(&tried.units).component_div(&now.units);
                let again = linear.step(&missed).norm();
                if again <= (1.0 - 0.5 * part) * step.norm() {
                    if same {
                        return Ok(Some((next, tried)));
                    }
                    otherwise.get_or_insert((next, tried));
                }
            }
            part *= 0.5;
        }
        Ok(otherwise)
    }

    /// A trial on the way from some values, where it leads anywhere.
    ///
    /// # Errors
    /// [`NotFound::Interrupted`].
    pub fn unless_broken_off(&mut self, tried: &[f64], from: &[f64]) -> Result<Option<Trial>, Error> {
        match self.try_at(tried) {
            Err(error) if error.is_interruption() => Err(NotFound::Interrupted { values: self.named(from) }.into()),
            tried => Ok(tried.ok()),
        }
    }

    /// What the conditions are missed by.
    pub fn residuals(&self, trial: &Trial) -> Vec<(String, f64)> {
        let end = trial.end();
        let missed = |condition: &Condition| end.map_or(f64::NAN, |end| end.values[condition.column] - condition.value);
        self.conditions.iter().map(|condition| (condition.name.clone(), missed(condition))).collect()
    }

    pub fn named(&self, values: &[f64]) -> Vec<(String, f64)> {
        self.names.iter().cloned().zip(values.iter().copied()).collect()
    }

    pub fn stuck(&self, trial: &Trial, values: &[f64]) -> NotFound {
        NotFound::Stuck {
            residuals: self.residuals(trial),
            values: self.named(values),
            why: self.fault.clone(),
            event: self.other_event.clone(),
        }
    }

    /// What is told of a solution.
    pub fn found(&self, solution: Solution, errors: Errors) -> Found {
        let Solution { values, equations, linear, steps } = solution;
        let named = |direction: DVector<f64>| self.names.iter().cloned().zip(direction.iter().copied()).collect();
        let end = equations.trial.end();
        let reached = self.conditions.iter().zip(&errors.reached).map(|(condition, error)| Value {
            name: condition.name.clone(),
            value: end.map_or(f64::NAN, |end| end.values[condition.column]),
            error: *error,
        });
        Found {
            values: value_list(&self.names, &values, &errors.values),
            reached: reached.collect(),
            free: linear.free().into_iter().map(named).collect(),
            end_time: end_time(&equations.trial, errors.end),
            run: equations.trial.varied.run,
            steps,
            runs: self.runs,
            multiplicity: 1,
            multiple_in: Vec::new(),
            fit: None,
        }
    }
}

impl Condition {
    /// What it is measured by.
    fn size(&self, trial: &Trial) -> f64 {
        Some(self.value.abs().max(trial.size(self.column))).filter(|size| *size > 0.0).unwrap_or(1.0)
    }
}
