//! Forms of the same expressions to choose from.

use super::count::work;
use super::gather::gather;
use super::rounding::rounds_alike;
use crate::expr::{Angles, Graph, Id, Symbol, canonical_products, expand};

/// The roots expanded over the state and factored again, with sines and cosines of as few or of all differences of angles;
/// forms that grow too large, or lose digits, are left out.
pub(super) fn expanded(graph: &mut Graph, roots: &[Id]) -> Vec<(&'static str, Vec<Id>)> {
    let mut forms: Vec<(&'static str, Vec<Id>)> = Vec::new();
    for (words, angles) in [("expanded", Angles::Shorter), ("expanded, angles joined", Angles::All)] {
        let Some(form) = expand(graph, roots, is_parameter, angles) else { break };
        let new = forms.iter().all(|(_, known)| *known != form);
        if new && (form == roots || rounds_alike(graph, roots, &form)) {
            forms.push((words, form));
        }
    }
    forms
}

/// The roots with the factors of their products gathered, where that costs no more with what is computed beside them.
pub(super) fn gathered(graph: &mut Graph, roots: Vec<Id>, beside: &[Id]) -> Vec<Id> {
    let form = canonical_products(graph, &roots, is_parameter);
    let form = gather(graph, &form);
    let roots = gather(graph, &roots);
    let cost = |form: &[Id]| work(graph, &[form, beside].concat());
    if cost(&form) <= cost(&roots) { form } else { roots }
}

fn is_parameter(symbol: Symbol) -> bool {
    matches!(symbol, Symbol::Parameter(_))
}
