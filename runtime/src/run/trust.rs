//! The report on a run.

use std::fmt;

use super::{Run, RunPart, SteppedOver};
use crate::numbers::{counted, short};

/// How far a run can be trusted; made by [`Run::trust`], printed with `{}`.
#[derive(Clone, Copy, Debug)]
pub struct Trust<'a>(pub(crate) &'a Run);

impl fmt::Display for Trust<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let run = self.0;
        write!(f, "method         ")?;
        if run.parts.is_empty() {
            write!(f, "{}", run.method)?;
            if let Some(why) = run.why {
                write!(f, " ({why})")?;
            }
        } else {
            let part = |part: &RunPart| format!("{} ({})", part.coordinates.join(", "), part.method);
            let parts: Vec<String> = run.parts.iter().map(part).collect();
            write!(f, "parts run apart: {}", parts.join("; "))?;
        }
        match (run.tolerance, run.step) {
            (None, Some(step)) => writeln!(f, ", step {step} s")?,
            (Some(tolerance), Some(step)) => writeln!(f, ", step {step:.4e} s, found for tolerance {tolerance:e}")?,
            (Some(tolerance), None) => writeln!(f, ", tolerance {tolerance:e}")?,
            (None, None) => writeln!(f)?,
        }
        if let Some(found) = &run.balances {
            let (system, worst, t) = (&found.system, found.worst, found.t);
            writeln!(f, "derivation     balances `{system}`, condition number at most {worst:.1e} (at t = {t:.4} s)")?;
        }
        let work = run.work;
        writeln!(
            f,
            "work           {}, {} rejected, {}",
            counted(work.steps as usize, "step"),
            work.rejected,
            counted(work.evaluations as usize, "evaluation")
        )?;
        if let Some(over) = run.stepped_over() {
            write_contacts(f, &over)?;
        }
        for drift in &run.drift {
            write_drift(f, &drift.name, drift.value)?;
        }
        write_drift(f, "energy balance", run.energy_balance)?;
        if let (Some(digits), Some(worst)) = (&run.digits, worst(run)) {
            let kind = if digits.by_step { "step" } else { "tolerance" };
            writeln!(f, "digits         {worst}; by a second run at {kind} {:.0e}", digits.companion)?;
        }
        for warning in &run.warnings {
            writeln!(f, "warning        {warning}")?;
        }
        Ok(())
    }
}

/// The column of which fewest digits hold at the end, in words: of the state, or, where all of that is 0, of outputs.
fn worst(run: &Run) -> Option<String> {
    let last = run.last();
    let state: Vec<(String, f64)> = last.entries().collect();
    let outputs = last.outputs().filter_map(|(name, value)| Some((name.to_owned(), value?)));
    let fewest = |values: Vec<(String, f64)>| {
        // A value that is zero but for rounding has no digits to lose.
        let shown = values.into_iter().filter(|(name, value)| run.written(name, *value) != "0");
        shown.map(|(name, _)| (run.digits(&name), name)).min_by_key(|(digits, _)| *digits)
    };
    match fewest(state).or_else(|| fewest(outputs.collect())) {
        Some((digits, name)) => Some(format!("{} or more, fewest of {name}", digits?)),
        None => Some("all values are 0 but for rounding".to_owned()),
    }
}

fn write_drift(f: &mut fmt::Formatter<'_>, name: &str, value: Option<f64>) -> fmt::Result {
    match value {
        Some(value) => writeln!(f, "drift          {name} {value:.1e}"),
        None => writeln!(f, "drift          {name} does not apply here"),
    }
}

/// What contacts did that steps went over.
fn write_contacts(f: &mut fmt::Formatter<'_>, over: &SteppedOver) -> fmt::Result {
    write!(
        f,
        "contacts       stepped over, with an error of the first order in the step; at most {} closed at once",
        over.closed
    )?;
    if let Some(deepest) = &over.deepest {
        let (contact, depth, t) = (&deepest.contact, deepest.depth, short(deepest.t));
        write!(f, ", {depth:.1e} deep in each other at the most ({contact}, at t = {t} s)")?;
    }
    writeln!(f)?;
    let energy = if over.work > 0.0 { "gave" } else { "took" };
    writeln!(
        f,
        "               they {energy} {} J; laws met to {:.0e} in {} at the most",
        short(over.work.abs()),
        over.residual,
        counted(over.rounds as usize, "round")
    )
}
