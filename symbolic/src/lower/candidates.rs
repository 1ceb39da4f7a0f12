//! The choice among equivalent forms that round alike, by the time that their operations take.

use super::count::work;
use super::forms::{expanded, gathered};
use super::gather::gather;
use super::{Entry, gather_entries};
use crate::derive::Equations;
use crate::expr::{Graph, Id, Symbol};

/// The cheapest M, h and F.
pub(super) struct Chosen {
    pub mass: Vec<Entry>,
    pub bias: Vec<Id>,
    pub residual: Vec<Id>,
    pub words: String,
}

/// M, h and F may come from different derivations and in different forms: as derived, or expanded and
/// factored again.  M and h are chosen together, since they are evaluated together.
pub(super) fn choose(graph: &mut Graph, equations: &[Equations]) -> Chosen {
    let mut masses: Vec<(String, Vec<Entry>)> = Vec::new();
    let mut biases: Vec<(String, Vec<Id>)> = Vec::new();
    let mut residuals: Vec<(String, Vec<Id>)> = Vec::new();
    for derivation in equations {
        let name = derivation.name;
        let values: Vec<Id> = derivation.mass.iter().map(|e| e.2).collect();
        // Expanded forms of different derivations are the same up to order, so one is enough.
        if masses.is_empty() {
            for (words, form) in expanded(graph, &values) {
                let entries = derivation.mass.iter().zip(form).map(|(e, x)| (e.0, e.1, x));
                masses.push((format!("{name}, {words}"), entries.filter(|e| e.2 != Id::ZERO).collect()));
            }
            for (words, form) in expanded(graph, &derivation.bias) {
                biases.push((format!("{name}, {words}"), form));
            }
            for (words, form) in expanded(graph, &derivation.residual) {
                residuals.push((format!("{name}, {words}"), form));
            }
        }
        masses.push((name.to_owned(), derivation.mass.clone()));
        biases.push((name.to_owned(), derivation.bias.clone()));
        residuals.push((name.to_owned(), derivation.residual.clone()));
    }
    for entries in masses.iter_mut().map(|(_, entries)| entries) {
        gather_entries(graph, entries);
    }
    for values in biases.iter_mut().map(|(_, values)| values) {
        *values = gather(graph, values);
    }
    let mut best: Option<(usize, usize, usize)> = None;
    for (i, (_, mass)) in masses.iter().enumerate() {
        for (j, (_, bias)) in biases.iter().enumerate() {
            let roots: Vec<Id> = mass.iter().map(|e| e.2).chain(bias.iter().copied()).collect();
            let cost = work(graph, &roots);
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, i, j));
            }
        }
    }
    let (_, i, j) = best.unwrap_or_default();
    let (mass_words, mut mass) = masses.swap_remove(i);
    let (bias_words, bias) = biases.swap_remove(j);
    let values = gathered(graph, mass.iter().map(|e| e.2).chain(bias).collect(), &[]);
    let bias = values[mass.len()..].to_vec();
    for (entry, value) in mass.iter_mut().zip(values) {
        entry.2 = value;
    }
    residuals.push(("M q'' + h".to_owned(), product_form(graph, &mass, &bias)));
    let (residual_words, residual) = cheapest_residual(graph, residuals);
    Chosen { mass, bias, residual, words: format!("M: {mass_words}; h: {bias_words}; F: {residual_words}") }
}

/// F alone, where M and h are not formed.
pub(super) fn without_masses(graph: &mut Graph, equations: &[Equations]) -> Chosen {
    let residuals = equations.iter().map(|derivation| (derivation.name.to_owned(), derivation.residual.clone()));
    let (words, residual) = cheapest_residual(graph, residuals.collect());
    Chosen { mass: Vec::new(), bias: Vec::new(), residual, words: format!("F: {words}") }
}

fn cheapest_residual(graph: &mut Graph, mut residuals: Vec<(String, Vec<Id>)>) -> (String, Vec<Id>) {
    for values in residuals.iter_mut().map(|(_, values)| values) {
        *values = gathered(graph, std::mem::take(values), &[]);
    }
    let k = (0..residuals.len()).min_by_key(|&k| work(graph, &residuals[k].1)).unwrap_or(0);
    residuals.swap_remove(k)
}

/// M q'' + h from M and h.
fn product_form(graph: &mut Graph, mass: &[Entry], bias: &[Id]) -> Vec<Id> {
    let mut residual = bias.to_vec();
    for &(i, j, m) in mass {
        for (row, column) in if i == j { vec![(i, j)] } else { vec![(i, j), (j, i)] } {
            let a = graph.symbol(Symbol::Acceleration(column as u32));
            let term = graph.mul(m, a);
            residual[row] = graph.add(residual[row], term);
        }
    }
    residual
}
