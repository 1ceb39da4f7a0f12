//! Error against work: a point for every reduction.

use super::{ModelReduction, Needs, Proposal};
use crate::precision::{Fidelity, Verified};
use crate::show::Chart;

impl Needs {
    /// What every reduction is off by and takes at the tolerance at which reductions are compared, and the chosen one at its own, beside the
    /// full model at several.
    pub fn fidelity(&self) -> Fidelity {
        let told = |error: f64| self.need.told(error);
        let reduction = |reduction: &ModelReduction| {
            // The full model's own points have it.
            if matches!(reduction.proposal, Proposal::Looser { .. }) {
                return None;
            }
            let error = told(reduction.deviation.as_ref()?.largest);
            let work = self.exact_operations / reduction.saving / self.evaluation;
            Some(Verified { name: short(reduction), tolerance: self.exact_tolerance, error, work })
        };
        let chosen = self.choice.as_ref().map(|choice| Verified {
            name: "what may go together".to_owned(),
            tolerance: choice.tolerance,
            error: told(choice.verified),
            work: choice.operations / self.evaluation,
        });
        Fidelity {
            title: format!("{}: what is left out", self.name),
            measure: self.need.measure(),
            within: told(self.need.within),
            full: self.full.iter().map(|run| Verified { error: told(run.error), ..run.clone() }).collect(),
            reductions: self.reductions.iter().filter_map(reduction).collect(),
            chosen,
        }
    }

    /// [`Fidelity::chart`] of it.
    pub fn chart(&self) -> Chart {
        self.fidelity().chart()
    }
}

/// `l held`, `forces.air`.
fn short(reduction: &ModelReduction) -> String {
    let name = reduction.ingredient.strip_prefix("coordinates.").unwrap_or(&reduction.ingredient);
    match &reduction.proposal {
        Proposal::LeftOut => name.to_owned(),
        Proposal::Held { .. } => format!("{name} held"),
        Proposal::Slaved { .. } => format!("{name} following"),
        Proposal::Linear => format!("{name} linear"),
        Proposal::Rigid { .. } => format!("{name} rigid"),
        Proposal::Looser { .. } => name.to_owned(),
        Proposal::Modes { kept, .. } => format!("{} in {kept} modes", name.split('[').next().unwrap_or(name)),
    }
}
