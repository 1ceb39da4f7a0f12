//! The report on a run.

use std::fmt;

use super::Run;

/// How far a run can be trusted; made by [`Run::trust`], printed with `{}`.
#[derive(Clone, Copy, Debug)]
pub struct Trust<'a>(pub(crate) &'a Run);

impl fmt::Display for Trust<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let run = self.0;
        write!(f, "method         {}", run.method)?;
        match (run.tolerance, run.step) {
            (_, Some(step)) => writeln!(f, ", step {step} s")?,
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
            "work           {} steps, {} rejected, {} evaluations",
            work.steps, work.rejected, work.evaluations
        )?;
        for drift in &run.drift {
            write_drift(f, &drift.name, drift.value)?;
        }
        write_drift(f, "energy balance", run.energy_balance)?;
        for warning in &run.warnings {
            writeln!(f, "warning        {warning}")?;
        }
        Ok(())
    }
}

fn write_drift(f: &mut fmt::Formatter<'_>, name: &str, value: Option<f64>) -> fmt::Result {
    match value {
        Some(value) => writeln!(f, "drift          {name} {value:.1e}"),
        None => writeln!(f, "drift          {name} does not apply here"),
    }
}
