//! What would mend a system of balances that disagrees.

use super::balances::equations;
use super::suspects::{Known, Suspect};
use super::system::{Assembled, Change, Row, evaluate};
use crate::derive::momentum::{Momentum, unknowns};
use crate::derive::rates;
use crate::diagnose::{listed, quoted};
use crate::expr::{Graph, Measured, Symbol, vectors};
use crate::model::{BalanceSystem, HIDDEN, Model, Part};

/// A system of more coefficients times parts than this is not searched.
const WORK: usize = 20_000_000;

/// What single terms are multiplied by, in words.
const FACTORS: [(f64, &str); 4] =
    [(-1.0, "with the opposite sign of"), (0.0, "without"), (2.0, "with twice"), (0.5, "with half of")];

/// A system, ready to be changed.
pub(super) struct Causes<'a> {
    model: &'a Model,
    system: &'a BalanceSystem,
    unknowns: &'a [Symbol],
    known: &'a Known<'a>,
    /// The rows of written-out equations term by term, of balances part by part, and of constraints, at every state.
    rows: Vec<Vec<Row>>,
    size: usize,
    searched: bool,
}

impl<'a> Causes<'a> {
    pub fn new(
        model: &'a Model,
        (system, linear): (&'a BalanceSystem, &'a Momentum),
        assembled: &[Assembled],
        known: &'a Known<'a>,
    ) -> Causes<'a> {
        let finer = in_terms(system.clone());
        let mut graph = model.graph.clone();
        let mut rows = evaluate(&mut graph, &finer, &linear.unknowns, known.states);
        let judged = equations(system, system.balances.len() - 1).end;
        rows.iter_mut().zip(assembled).for_each(|(rows, system)| rows.extend(system.lines_from(judged)));
        let (parts, size) = (rows.first().map_or(0, Vec::len), linear.unknowns.len());
        let size_of = assembled.first().map_or(0, |system| system.equations);
        let searched = parts * parts * size <= WORK;
        Causes { model, system, unknowns: &linear.unknowns, known, rows, size: size_of, searched }
    }

    fn changed(&self, state: usize, change: &Change) -> Assembled {
        Assembled::of(&self.rows[state], self.size, self.unknowns.len(), Some(change))
    }

    /// Whether equations of a system so assembled hold at all states, and it still determines the motion somewhere.
    fn restores(&self, assembled: &dyn Fn(usize) -> Assembled, block: &[usize], first: usize) -> bool {
        let holds = |k: &usize| self.known.off(&self.known.put(&assembled(*k), *k), block, *k).is_none();
        holds(&first)
            && self.known.at.iter().all(holds)
            && self.known.at.iter().any(|k| assembled(*k).solution().is_some())
    }

    /// The load whose opposite sign in all balances in which it stands restores agreement, whatever the reactions are.
    pub fn entry(&self) -> Option<(Vec<usize>, String)> {
        let balances = || self.system.balances.iter().enumerate().filter(|(_, balance)| !balance.is_written());
        let standing = |name: &str| {
            let of =
                balances().flat_map(|(b, balance)| balance.parts.iter().enumerate().map(move |(p, part)| (b, p, part)));
            of.filter(|(_, _, part)| part.name == name).map(|(b, p, _)| (b, p)).collect::<Vec<(usize, usize)>>()
        };
        let all: Vec<usize> = (0..self.size).collect();
        let nothing = self.known.with_nothing();
        self.model.loads.iter().filter(|_| self.searched).find_map(|load| {
            let places = standing(&load.name);
            let change = Change::Parts(places.clone(), -1.0);
            let holds = |k: usize| nothing.off(&self.changed(k, &change), &all, k).is_none();
            let mends = places.len() > 1
                && (0..self.rows.len()).all(holds)
                && (0..self.rows.len()).any(|k| self.changed(k, &change).solution().is_some());
            let balances: Vec<usize> = places.iter().map(|place| place.0).collect();
            let labels = balances.iter().map(|b| self.system.balances[*b].label.clone()).collect::<Vec<String>>();
            let name = &load.name;
            mends.then(|| (balances, format!("with the opposite sign of {name} in {} they agree", listed(&labels))))
        })
    }

    /// The one term whose sign or factor, or the inertia whose absence, explains what is suspect at all states.  Of several balances,
    /// one of which is wrong, those stay that this explains.
    pub fn of(&self, mut suspect: Suspect) -> (Suspect, Option<String>) {
        let several = suspect.balances.len() > 1 && !suspect.one_of;
        if several || !self.searched {
            return (suspect, None);
        }
        let found = self.one_change(&mut suspect).or_else(|| self.forgotten_inertia(&mut suspect));
        (suspect, found)
    }

    /// Where to look where nothing explains it.
    pub fn where_to_look(&self, suspect: &Suspect) -> String {
        let labels: Vec<String> = suspect.balances.iter().map(|b| self.system.balances[*b].label.clone()).collect();
        let tried = if self.searched { "no single term explains it; " } else { "" };
        let (where_to, what) = (listed(&labels), what_to_look_for(&labels));
        let constraints = self.constraints();
        format!("{tried}look in {where_to} {what}; or in the bodies, for masses, inertias and positions{constraints}")
    }

    /// The constraints that Lagrange's equations keep and the balances know by their reactions alone.
    fn constraints(&self) -> String {
        let active = self.system.phases.iter().flat_map(|phase| &self.model.phases[*phase].constraints);
        let mut names: Vec<&str> = active.map(|place| self.model.constraints[*place].name.as_str()).collect();
        names.retain(|name| !name.starts_with(HIDDEN));
        names.sort_unstable();
        names.dedup();
        match names.as_slice() {
            [] => String::new(),
            [name] => format!("; or in the constraint `{name}`: how its reaction acts follows from its expression"),
            names => {
                format!(
                    "; or in the constraints {}: how their reactions act follows from their expressions",
                    quoted(names)
                )
            }
        }
    }

    /// The changes of a balance that multiply by a factor, with their words: terms, products of them as they are written, and
    /// reactions.
    fn changes(&self, b: usize, factor: f64) -> Vec<(Change, String)> {
        let balance = &self.system.balances[b];
        let parts = if balance.terms.is_empty() { &balance.parts } else { &balance.terms };
        let part = |(p, part): (usize, &Part)| (Change::Parts(vec![(b, p)], factor), part.name.clone());
        let product = |(name, of): &(String, std::ops::Range<usize>)| {
            (Change::Parts(of.clone().map(|p| (b, p)).collect(), factor), name.clone())
        };
        let mut changes: Vec<(Change, String)> = parts.iter().enumerate().map(part).collect();
        changes.extend(balance.products.iter().map(product));
        if balance.is_written() && factor == -1.0 {
            let reaction = |(column, s): (usize, &Symbol)| {
                let name =
                    self.model.reactions.iter().find(|reaction| reaction.symbols().any(|x| x == *s))?.name.clone();
                Some((Change::Unknown(b, column), format!("`{name}`")))
            };
            changes.extend(self.unknowns.iter().enumerate().filter_map(reaction));
        }
        changes
    }

    fn one_change(&self, suspect: &mut Suspect) -> Option<String> {
        for (factor, words) in FACTORS {
            let mut found: Vec<(usize, String)> = Vec::new();
            for &b in &suspect.balances {
                let mends = |(change, _): &(Change, String)| {
                    self.restores(&|k| self.changed(k, change), &suspect.block, suspect.state)
                };
                if let Some((_, name)) = self.changes(b, factor).into_iter().find(mends) {
                    found.push((b, format!("{words} {name} in {}", self.system.balances[b].label)));
                }
            }
            if !found.is_empty() {
                suspect.balances = found.iter().map(|(b, _)| *b).collect();
                let words: Vec<String> = found.into_iter().map(|(_, words)| words).collect();
                return Some(format!("{} they agree", words.join(", or ")));
            }
        }
        None
    }

    /// The body whose I α, added to or taken from one balance of one component, restores agreement, in words.
    fn forgotten_inertia(&self, suspect: &mut Suspect) -> Option<String> {
        let mut graph: Graph = self.model.graph.clone();
        let size = vectors::moment_size(self.model.dimension);
        let turning = self.model.bodies.iter().filter_map(|body| Some((body, body.rotation.as_ref()?)));
        let parts: Vec<Part> = turning
            .map(|(body, rotation)| {
                let omega = rotation.angular_velocity(|angle| rates(&mut graph, &[angle])[0]);
                let spin = rotation.angular_momentum(&mut graph, &omega);
                Part { name: format!("I alpha of {}", body.name), value: rates(&mut graph, &spin) }
            })
            .collect();
        let mut inertias = BalanceSystem { balances: self.system.balances[..1].to_vec(), ..self.system.clone() };
        inertias.balances[0].parts.clone_from(&parts);
        let seen = evaluate(&mut graph, &inertias, &unknowns(self.model, self.system), self.known.states);
        for b in suspect.balances.clone() {
            let balance = &self.system.balances[b];
            let first = equations(self.system, b).start;
            for (p, part) in parts.iter().enumerate().filter(|_| balance.components == size) {
                for (negative, words) in [(false, "added to the left of"), (true, "taken from the left of")] {
                    let signed = |x: &Measured| Measured { value: if negative { -x.value } else { x.value }, ..*x };
                    let assembled = |k: usize| {
                        let inertia = seen[k][size * p..][..size].iter().enumerate();
                        let extra = inertia.map(|(c, row)| {
                            let coefficients = row.coefficients.iter().map(signed).collect();
                            Row::known(first + c, coefficients, signed(&row.rest))
                        });
                        let all: Vec<Row> = self.rows[k].iter().cloned().chain(extra).collect();
                        Assembled::of(&all, self.size, self.unknowns.len(), None)
                    };
                    if self.restores(&assembled, &suspect.block, suspect.state) {
                        suspect.balances = vec![b];
                        return Some(format!("with {} {words} {} they agree", part.name, balance.label));
                    }
                }
            }
        }
        None
    }
}

/// A system with written-out equations in their terms.
fn in_terms(mut system: BalanceSystem) -> BalanceSystem {
    for balance in system.balances.iter_mut().filter(|balance| !balance.terms.is_empty()) {
        balance.parts = std::mem::take(&mut balance.terms);
    }
    system
}

/// What may be wrong with balances of these labels.
fn what_to_look_for(labels: &[String]) -> &'static str {
    let mut kinds: Vec<&str> = labels.iter().filter_map(|label| label.rsplit(['(', ')']).nth(1)).collect();
    kinds.dedup();
    match kinds.as_slice() {
        ["equation"] => {
            "for a term that is missing, another body or point, and the acceleration of a moving point that is left out"
        }
        ["force"] => {
            "for a constraint's force on these bodies that is not in `reactions` or lacks its opposite (`from`), for a \
             body missing in `of`, and for where forces act"
        }
        ["moment"] => {
            "for a constraint's force that has a moment about this point and is not in `reactions` or lacks its \
             opposite (`from`), for a body missing in `of`, and for where forces act"
        }
        _ => "for forces that do work and are not declared, and for bodies missing in `of`",
    }
}
