//! What the generated type's documentation says: the file's words, operation counts, what was tested.

use std::fmt::Write;

use super::words::paragraph;
use crate::gate::shared_data;
use crate::lower::Program;
use crate::model::Condition;

/// The file's own words, or the name.
pub fn about(words: &str, name: &str) -> String {
    if words.trim().is_empty() { format!("`{name}`.") } else { paragraph(words) }
}

/// Operation counts and what was tested, as documentation.
pub fn tested(program: &Program) -> String {
    let c = program.counts;
    let mut text = format!(
        "Operations: M {}, h {}, M and h {}, accelerations {}, F {}, F with its Jacobians {}.\n{}.",
        c.mass, c.bias, c.mass_and_bias, c.accelerations, c.residual, c.jacobians, program.choice
    );
    if let Some(elimination) = program.elimination.as_ref().filter(|found| found.order.is_some()) {
        let _ = write!(text, "\n\n{}.", elimination.words());
    }
    let report = &program.report;
    for agreement in &report.agreements {
        let ((first, second), states, worst) = (&agreement.between, agreement.states, agreement.worst);
        let _ = write!(text, "\n\n{first} and `{second}` agree at {states} states, worst {worst:.0e}.");
    }
    if !report.agreements.is_empty() {
        let shared = shared_data(&program.model).join(", ");
        let _ =
            write!(text, "\n\nAll derivations share {shared}: that one of these is wrong their agreement cannot show.");
    }
    let model = &program.model;
    let conserved = model.conserved.iter().map(|claim| (claim.name.as_str(), claim.when.as_slice()));
    let checks = model.checks.iter().map(|claim| (claim.name.as_str(), claim.when.as_slice()));
    let named = |claims: Vec<(&str, &[Condition])>| {
        claims
            .into_iter()
            .map(|(name, when)| format!("`{name}`{}", model.condition(when)))
            .collect::<Vec<_>>()
            .join(", ")
    };
    for (title, claims) in [("Conserved", named(conserved.collect())), ("Checks that hold", named(checks.collect()))] {
        if !claims.is_empty() {
            let _ = write!(text, "\n\n{title}: {claims}.");
        }
    }
    text
}
