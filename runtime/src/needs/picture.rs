//! Error against work: a point for every rung.

use super::{ModelReduction, Needs, Proposal};
use crate::precision::{Fidelity, Verified};
use crate::show::Chart;

impl Needs {
    /// What every rung is off by and takes at the tolerance at which rungs are compared, and the chosen one at its own, beside the
    /// full model at several.
    pub fn fidelity(&self) -> Fidelity {
        let rung = |rung: &ModelReduction| {
            // The full model's own points have it.
            if matches!(rung.proposal, Proposal::Looser { .. }) {
                return None;
            }
            let error = rung.deviation.as_ref()?.largest;
            let work = self.exact_operations / rung.saving / self.evaluation;
            Some(Verified { name: short(rung), tolerance: self.exact_tolerance, error, work })
        };
        let chosen = self.choice.as_ref().map(|choice| Verified {
            name: "what may go together".to_owned(),
            tolerance: choice.tolerance,
            error: choice.verified,
            work: choice.operations / self.evaluation,
        });
        Fidelity {
            title: format!("{}: what is left out", self.name),
            within: self.need.within,
            full: self.full.clone(),
            rungs: self.rungs.iter().filter_map(rung).collect(),
            chosen,
        }
    }

    /// [`Fidelity::chart`] of it.
    pub fn chart(&self) -> Chart {
        self.fidelity().chart()
    }
}

/// `l held`, `forces.air`.
fn short(rung: &ModelReduction) -> String {
    let name = rung.ingredient.strip_prefix("coordinates.").unwrap_or(&rung.ingredient);
    match &rung.proposal {
        Proposal::LeftOut => name.to_owned(),
        Proposal::Held { .. } => format!("{name} held"),
        Proposal::Slaved { .. } => format!("{name} following"),
        Proposal::Linear => format!("{name} linear"),
        Proposal::Rigid { .. } => format!("{name} rigid"),
        Proposal::Looser { .. } => name.to_owned(),
        Proposal::Modes { kept, .. } => format!("{} in {kept} modes", name.split('[').next().unwrap_or(name)),
    }
}
