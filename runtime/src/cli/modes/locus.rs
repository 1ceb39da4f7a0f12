//! `--vary` and `--locus`: eigenvalues as a parameter changes.

use std::io::Write;

use clap::ArgMatches;
use dalembert_symbolic::model::Sets;
use nalgebra::Complex;
use serde_json::{Value, json};

use super::super::Problem;
use super::super::json::{number, object};
use super::super::load::{Loaded, pairs};
use super::super::set_up::{Reader, parameter_index};
use super::{failed, write_file};
use crate::linear::{
    Equilibrium, Guess, Kind, LinearError, Linearised, equilibrium_near, linearise, matched, root_locus, short,
    short_beside,
};
use crate::mechanism::System;

/// So many values of the parameter.
const VALUES: u32 = 120;
/// How often gaps are halved.
const PASSES: u32 = 7;

/// Eigenvalues as a parameter goes from one value to another.
pub struct Locus {
    parameter: String,
    unit: String,
    /// (value, eigenvalues there, whether any motion grows); without those that have no equilibrium.
    steps: Vec<(f64, Vec<Complex<f64>>, bool)>,
    /// Values between which stability changes, and whether it is lost there.
    limits: Vec<(f64, bool)>,
    /// Why values are missing, and the first of them.
    missing: Option<(f64, LinearError)>,
}

impl Locus {
    /// Follows the equilibrium while the parameter changes, and draws; `None` if that is not asked for.
    pub fn new(
        loaded: &Loaded,
        options: &ArgMatches,
        reader: &mut Reader,
        start: &Equilibrium,
    ) -> Result<Option<Locus>, Problem> {
        let mut given = pairs(options, "vary")?.into_iter();
        let Some((parameter, text)) = given.next() else {
            return match options.contains_id("locus") {
                true => Err(Problem::Usage("error: --locus wants --vary PARAMETER=A..B beside it".to_owned())),
                false => Ok(None),
            };
        };
        if given.next().is_some() {
            return Err(Problem::Usage("error: --vary takes one parameter".to_owned()));
        }
        let index = parameter_index(loaded, &parameter)?;
        let (from, to) = super::range(loaded, reader, "vary", Sets::Parameter(index), &text)?;
        let unit = loaded.system.description().parameters[index].unit.to_string();
        let mut locus = Locus { parameter, unit, steps: Vec::new(), limits: Vec::new(), missing: None };
        let mut system = loaded.system.boxed_clone();
        let mut guess = start.guess();
        // Towards the first value by small steps: the equilibrium there is the one that belongs to ours.
        let present = system.parameters()[index];
        for step in 1..20 {
            let value = present + (from - present) * f64::from(step) / 20.0;
            if let Ok((at, ..)) = analyse(&mut *system, index, value, &guess) {
                guess = at;
            }
        }
        for step in 0..=VALUES {
            let value = from + (to - from) * f64::from(step) / f64::from(VALUES);
            match analyse(&mut *system, index, value, &guess) {
                Ok((at, eigenvalues, grows)) => {
                    if let Some((before, _, grew)) = locus.steps.last()
                        && *grew != grows
                    {
                        let limit = bisect(&mut *system, index, (*before, value), *grew, &guess);
                        locus.limits.push((limit, grows));
                    }
                    guess = at;
                    locus.steps.push((value, eigenvalues, grows));
                }
                Err(error) => locus.missing = locus.missing.or(Some((value, error))),
            }
        }
        locus.refine(&mut *system, index, &guess);
        match (&locus.missing, locus.steps.is_empty()) {
            (Some((_, error)), true) => return Err(failed(error.clone())),
            _ => locus.draw(options)?,
        }
        Ok(Some(locus))
    }

    /// Puts more values where eigenvalues move far from one to the next, as where two of them meet.
    fn refine(&mut self, system: &mut dyn System, index: usize, guess: &Guess) {
        let all = self.steps.iter().flat_map(|step| &step.1);
        let scale = all.fold(0.0_f64, |most, x| most.max(x.norm()));
        let far = |a: &[Complex<f64>], b: &[Complex<f64>]| {
            a.iter().zip(matched(a, b)).any(|(x, y)| (x - y).norm() > 0.01 * scale)
        };
        for _ in 0..PASSES {
            let gaps = self.steps.windows(2).filter(|pair| far(&pair[0].1, &pair[1].1));
            let middles: Vec<f64> = gaps.map(|pair| 0.5 * (pair[0].0 + pair[1].0)).collect();
            for value in middles {
                if let Ok((_, eigenvalues, grows)) = analyse(system, index, value, guess) {
                    self.steps.push((value, eigenvalues, grows));
                }
            }
            let falls = self.steps.first().zip(self.steps.get(1)).is_some_and(|(a, b)| a.0 > b.0);
            self.steps.sort_by(|a, b| if falls { b.0.total_cmp(&a.0) } else { a.0.total_cmp(&b.0) });
        }
    }

    fn draw(&self, options: &ArgMatches) -> Result<(), Problem> {
        let Some(path) = options.get_one::<String>("locus") else { return Ok(()) };
        let steps: Vec<_> = self.steps.iter().map(|(value, eigenvalues, _)| (*value, eigenvalues.clone())).collect();
        write_file(path, root_locus(&self.parameter, &self.unit, &steps).to_svg())
    }

    /// What the numbers alone do not tell.
    pub fn notes(&self) -> Vec<String> {
        let missing = self.missing.iter();
        missing.map(|(value, error)| format!("nothing at {}: {error}", self.value(*value))).collect()
    }

    /// The key `locus`.
    pub fn as_json(&self) -> (&'static str, Value) {
        let step = |(value, eigenvalues, _): &(f64, Vec<Complex<f64>>, bool)| {
            let list: Vec<Value> = eigenvalues.iter().map(|x| json!([number(x.re), number(x.im)])).collect();
            object([("value", number(*value)), ("eigenvalues", list.into())])
        };
        let limit = |(value, lost): &(f64, bool)| object([("value", number(*value)), ("stable_above", json!(!lost))]);
        let locus = object([
            ("parameter", json!(self.parameter)),
            ("limits", self.limits.iter().map(limit).collect::<Vec<_>>().into()),
            ("steps", self.steps.iter().map(step).collect::<Vec<_>>().into()),
        ]);
        ("locus", locus)
    }

    /// For people.
    pub fn table(&self, out: &mut dyn Write) -> Result<(), Problem> {
        let ends = self.steps.first().into_iter().chain(self.steps.last());
        writeln!(out, "eigenvalues as {} changes:", self.parameter)?;
        for (value, eigenvalues, grows) in ends {
            let scale = eigenvalues.iter().fold(0.0_f64, |most, x| most.max(x.norm()));
            let mut upper: Vec<&Complex<f64>> = eigenvalues.iter().filter(|x| x.im >= -1e-12 * scale).collect();
            upper.sort_by(|a, b| a.im.total_cmp(&b.im).then(a.re.total_cmp(&b.re)));
            let list: Vec<String> = upper.iter().take(super::MOST_PRINTED).map(|x| complex(x, scale)).collect();
            let grows = if *grows { "unstable" } else { "nothing grows" };
            writeln!(out, "  {}: {grows}; {}", self.value(*value), list.join(", "))?;
        }
        for (value, lost) in &self.limits {
            let what = if *lost { "a motion begins to grow" } else { "growth ends" };
            let unit = if self.unit == "1" { "" } else { &self.unit };
            let value = format!("{} {unit}", short_beside(*value, self.span()));
            writeln!(out, "  {} = {}: {what}", self.parameter, value.trim_end())?;
        }
        Ok(())
    }

    fn span(&self) -> f64 {
        self.steps.first().zip(self.steps.last()).map_or(0.0, |(a, b)| b.0 - a.0)
    }

    fn value(&self, value: f64) -> String {
        let unit = if self.unit == "1" { "" } else { &self.unit };
        format!("{} = {} {unit}", self.parameter, short(value)).trim_end().to_owned()
    }
}

/// `-0.1`, `-0.1 +- 2i`.
fn complex(x: &Complex<f64>, scale: f64) -> String {
    let re = short_beside(x.re, scale);
    if x.im.abs() <= 1e-12 * scale { re } else { format!("{re} +- {}i", short(x.im)) }
}

type Analysed = (Guess, Vec<Complex<f64>>, bool);

fn analyse(system: &mut dyn System, index: usize, value: f64, guess: &Guess) -> Result<Analysed, LinearError> {
    system.set_parameter(index, value);
    let at = equilibrium_near(system, guess)?;
    let linear: Linearised = linearise(system, &at)?;
    let grows = linear.modes()?.iter().any(|mode| mode.kind == Kind::Unstable);
    Ok((at.guess(), linear.eigenvalues()?, grows))
}

/// Where stability changes between two values, to a part in 10¹⁰ of their distance.
fn bisect(system: &mut dyn System, index: usize, (mut low, mut high): (f64, f64), grew: bool, guess: &Guess) -> f64 {
    for _ in 0..34 {
        let middle = 0.5 * (low + high);
        match analyse(system, index, middle, guess) {
            Ok((_, _, grows)) if grows == grew => low = middle,
            Ok(_) => high = middle,
            Err(_) => break,
        }
    }
    0.5 * (low + high)
}
