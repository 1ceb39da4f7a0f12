//! Forms of the same expressions to choose from.

use super::count::work;
use super::gather::gather;
use super::rounding::rounds_alike;
use crate::expr::{
    Angles, Binary, Graph, Id, NODE_LIMIT, Node, Symbol, canonical_products, expand, expand_around_sums,
};
use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};

/// A form has so many nodes for each of the derived one's at most, as a rule.
const SPREAD: usize = 2;

/// The roots expanded over the state and factored again, with sines and cosines of as few or of all differences of angles,
/// and with sums of places multiplied out or not; forms that grow too large, or lose digits, are left out.
pub(super) fn expanded(graph: &mut Graph, roots: &[Id]) -> Vec<(&'static str, Vec<Id>)> {
    let mut forms: Vec<(&'static str, Vec<Id>)> = Vec::new();
    if is_large(graph, roots) {
        return forms;
    }
    for words in ["expanded", "expanded, angles joined", "expanded around sums"] {
        let form = match words {
            "expanded" => expand(graph, roots, is_parameter, Angles::Shorter),
            "expanded, angles joined" => expand(graph, roots, is_parameter, Angles::All),
            _ => expand_around_sums(graph, roots, is_parameter),
        };
        let Some(form) = form else { continue };
        let new = forms.iter().all(|(_, known)| *known != form);
        if new && (form == roots || rounds_alike(graph, roots, &form)) {
            forms.push((words, form));
        }
    }
    forms
}

/// The roots with the factors of their products gathered, where that costs no more with what is computed beside them.
pub(super) fn gathered(graph: &mut Graph, roots: Vec<Id>, beside: &[Id]) -> Vec<Id> {
    if is_large(graph, &roots) {
        return roots;
    }
    let form = canonical_products(graph, &roots, is_parameter);
    let form = gather(graph, &form);
    let roots = gather(graph, &roots);
    let cost = |form: &[Id]| work(graph, &[form, beside].concat());
    if cost(&form) <= cost(&roots) { form } else { roots }
}

/// Whether other forms of the roots might take the room that a graph has: all that they need, and the factors of their
/// products, written out where several products share some.
fn is_large(graph: &Graph, roots: &[Id]) -> bool {
    let needed = graph.needed(roots.iter().copied());
    let is_product = |id: Id| matches!(graph.node(id), Node::Binary(Binary::Mul | Binary::Div, ..));
    let mut factors: HashMap<Id, usize> = HashMap::default();
    let (mut within, mut written): (HashSet<Id>, usize) = (HashSet::default(), 0);
    for &id in &needed {
        let count = match is_product(id) {
            true => graph.children(id).map(|child| factors[&child]).fold(0, usize::saturating_add),
            false => 1,
        };
        factors.insert(id, count);
        // Whatever is no factor of another product is written out.
        if !is_product(id) {
            within.extend(graph.children(id).filter(|child| is_product(*child)));
        }
    }
    for id in within.into_iter().chain(roots.iter().copied().filter(|root| is_product(*root))) {
        written = written.saturating_add(factors[&id]);
    }
    (graph.len() + SPREAD * needed.len()).saturating_add(written) > NODE_LIMIT
}

fn is_parameter(symbol: Symbol) -> bool {
    matches!(symbol, Symbol::Parameter(_))
}
