//! What would mend a system of balances that disagrees.

use super::Gate;
use super::balances::residual;
use super::state::State;
use super::system::{Assembled, Row, evaluate};
use crate::derive::momentum::unknowns;
use crate::derive::rates;
use crate::expr::{Measured, vectors};
use crate::model::{BalanceSystem, Model, Part};

/// A system of more coefficients times parts than this is not searched.
const WORK: usize = 20_000_000;

/// The one term whose sign or factor, or the inertia whose absence, explains a disagreement at all states; else where to
/// look.  `finer` is the system in terms, with its rows and those of the system in parts.
pub(super) fn cause(
    model: &Model,
    finer: &BalanceSystem,
    system: &BalanceSystem,
    worst: usize,
    (in_terms, in_parts): (&[Vec<Row>], &[Vec<Row>]),
    states: &[State],
    gate: Gate,
) -> String {
    let search = Search { model, states, gate };
    let (parts, (_, size)) = (in_terms.first().map_or(0, Vec::len), extent(model, system));
    if parts * parts * size > WORK {
        return suspects(&system.balances[worst].label);
    }
    search
        .one_part(finer, worst, in_terms)
        .or_else(|| search.forgotten_inertia(system, in_parts))
        .unwrap_or_else(|| suspects(&system.balances[worst].label))
}

struct Search<'a> {
    model: &'a Model,
    states: &'a [State],
    gate: Gate,
}

impl Search<'_> {
    /// Whether a system so assembled holds at all states, and still determines the motion somewhere.
    fn restores(&self, assembled: &dyn Fn(usize) -> Assembled) -> bool {
        let mut all = 0..self.states.len();
        all.clone().all(|k| residual(&assembled(k), &self.states[k], self.gate).agrees)
            && all.any(|k| assembled(k).solution().is_some())
    }

    /// The one part whose flip, removal or another factor restores agreement, in words.
    fn one_part(&self, system: &BalanceSystem, worst: usize, rows: &[Vec<Row>]) -> Option<String> {
        let (equations, size) = extent(self.model, system);
        let factors =
            [(-1.0, "with the opposite sign of"), (0.0, "without"), (2.0, "with twice"), (0.5, "with half of")];
        // The balance that is off most comes first.
        let order = || std::iter::once(worst).chain((0..system.balances.len()).filter(move |b| *b != worst));
        for (factor, words) in factors {
            for b in order() {
                let balance = &system.balances[b];
                for (p, part) in balance.parts.iter().enumerate() {
                    if self.restores(&|k| Assembled::of(&rows[k], equations, size, Some((b, p, factor)))) {
                        return Some(format!("{words} {} in {} they agree", part.name, balance.label));
                    }
                }
            }
        }
        None
    }

    /// The body whose I α, added to or taken from one balance of one component, restores agreement, in words.
    fn forgotten_inertia(&self, system: &BalanceSystem, rows: &[Vec<Row>]) -> Option<String> {
        let mut graph = self.model.graph.clone();
        let size = vectors::moment_size(self.model.dimension);
        let turning = self.model.bodies.iter().filter_map(|body| Some((body, body.rotation.as_ref()?)));
        let parts: Vec<Part> = turning
            .map(|(body, rotation)| {
                let omega = rotation.angular_velocity(|angle| rates(&mut graph, &[angle])[0]);
                let spin = rotation.angular_momentum(&mut graph, &omega);
                Part { name: format!("I alpha of {}", body.name), value: rates(&mut graph, &spin) }
            })
            .collect();
        let mut inertias = BalanceSystem { balances: system.balances[..1].to_vec(), ..system.clone() };
        inertias.balances[0].parts.clone_from(&parts);
        let seen = evaluate(&mut graph, &inertias, &unknowns(self.model, system), self.states);
        let (equations, unknowns) = extent(self.model, system);
        let mut equation = 0;
        for balance in &system.balances {
            for (p, part) in parts.iter().enumerate().filter(|_| balance.components == size) {
                for (negative, words) in [(false, "added to the left of"), (true, "taken from the left of")] {
                    let signed = |x: &Measured| Measured { value: if negative { -x.value } else { x.value }, ..*x };
                    let assembled = |k: usize| {
                        let inertia = seen[k][size * p..][..size].iter().enumerate();
                        let extra = inertia.map(|(c, row)| {
                            let coefficients = row.coefficients.iter().map(signed).collect();
                            Row::known(equation + c, coefficients, signed(&row.rest))
                        });
                        let all: Vec<Row> = rows[k].iter().cloned().chain(extra).collect();
                        Assembled::of(&all, equations, unknowns, None)
                    };
                    if self.restores(&assembled) {
                        return Some(format!("with {} {words} {} they agree", part.name, balance.label));
                    }
                }
            }
            equation += balance.components;
        }
        None
    }
}

/// How many equations and unknowns a system has.
fn extent(model: &Model, system: &BalanceSystem) -> (usize, usize) {
    (system.balances.iter().map(|b| b.components).sum(), unknowns(model, system).len())
}

/// Where to look if no single term explains a disagreement.
fn suspects(label: &str) -> String {
    let suspects = match label.rsplit(['(', ')']).nth(1) {
        Some("equation") => {
            "for a term that is missing, another body or point, and the acceleration of a moving point that is left out"
        }
        Some("force") => {
            "for a constraint's force on these bodies that is not in `reactions` or lacks its opposite (`from`), for a \
             body missing in `of`, and for where forces act"
        }
        Some("moment") => {
            "for a constraint's force that has a moment about this point and is not in `reactions` or lacks its \
             opposite (`from`), for a body missing in `of`, and for where forces act"
        }
        _ => "for forces that do work and are not declared, and for bodies missing in `of`",
    };
    format!(
        "no single term explains it; look in {label} {suspects}; or in the bodies, for masses, inertias and positions"
    )
}
