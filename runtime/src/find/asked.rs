//! Searches that a model file asks for in `motions`.

use super::fit::Record;
use super::search::Search;
use super::trial::Sought;
use crate::error::NotFound;
use crate::mechanism::{Goal, Motion, MotionNumbers, System, Text};
use crate::simulate::Simulation;
use crate::vary::Unknown;

impl<S: System + 'static> Simulation<S> {
    /// Begins the search that a motion of the model file asks for, from its own start; what is said of the search besides is added, or takes
    /// the place of what the motion says.
    ///
    /// An unknown name, and a motion that closes, are errors of [`Search::solve`]; so is what this run was described with and has no meaning.
    pub fn motion(self, name: &str) -> Search {
        let begun = self.of_motion(name).and_then(|(simulation, motion)| {
            let (system, settings, origin) = simulation.described()?;
            let (asked, numbers) = (system.motions()[motion].clone(), system.motion_numbers(motion));
            let described = Ok((Box::new(system) as Box<dyn System>, settings, origin));
            Ok(Search::of(described).asking(motion, &asked, numbers)?)
        });
        begun.unwrap_or_else(|error| Search::of(Err(error)))
    }
}

impl Search {
    /// With what a motion of the file asks for: its unknowns, and what is wanted of them.
    pub(crate) fn asking(mut self, place: usize, motion: &Motion, numbers: MotionNumbers) -> Result<Self, NotFound> {
        let named = |names: &[Text], values: &[f64]| -> Vec<(String, f64)> {
            names.iter().map(ToString::to_string).zip(values.iter().copied()).collect()
        };
        self.unknowns = named(&motion.unknowns, &numbers.guesses);
        match &motion.goal {
            Goal::Closes(_) => return Err(NotFound::Closes { motion: motion.name.to_string() }),
            Goal::Meets { conditions, extreme } => {
                self.conditions = named(conditions, &numbers.conditions);
                self.extreme = extreme.as_ref().map(|(name, extreme)| (name.to_string(), *extreme));
            }
            Goal::Fits(columns) => self.record = Some(Record::of(columns)),
        }
        self.motion = Some((place, numbers));
        Ok(self)
    }
}

/// Another value of a parameter: any tells whether something changes with it.
pub(crate) fn another(value: f64) -> f64 {
    if value == 0.0 { 1.0 } else { 1.25 * value }
}

/// A value that a motion of the file gives a condition must not change with a parameter that is unknown.
pub(super) fn goals_stay(
    system: &dyn System,
    motion: Option<&(usize, MotionNumbers)>,
    conditions: &[(String, f64)],
    sought: &[Sought],
) -> Result<(), NotFound> {
    let Some((place, numbers)) = motion else { return Ok(()) };
    let parameters = sought.iter().filter_map(|sought| match sought {
        Sought::Of(Unknown::Parameter(k)) => Some(*k),
        _ => None,
    });
    for parameter in parameters {
        let mut moved = system.boxed_clone();
        let value = system.parameters()[parameter];
        moved.set_parameter(parameter, another(value));
        let others = moved.motion_numbers(*place).conditions;
        let changed = numbers.conditions.iter().zip(&others).position(|(own, other)| own != other);
        let kept = changed.and_then(|k| Some((conditions.get(k)?, numbers.conditions[k])));
        if let Some(((name, value), own)) = kept
            && *value == own
        {
            let parameter = system.description().parameters[parameter].name.to_string();
            return Err(NotFound::MovingGoal { name: name.clone(), parameter });
        }
    }
    Ok(())
}
