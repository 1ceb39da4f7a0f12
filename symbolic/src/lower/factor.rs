//! The accelerations −M⁻¹h by LDLᵀ, unrolled where that is small.

use std::collections::BTreeMap;

use super::Entry;
use super::count::{operations, varying, work};
use super::forms::gathered;
use crate::expr::{Graph, Id, terms};

/// How the accelerations are computed.
#[derive(Clone, Debug)]
pub enum Accelerations {
    /// As expressions: factors, forward and back substitution written out, zeros left out.
    Unrolled {
        /// q''.
        values: Vec<Id>,
        /// Coordinate, pivot, and the entry of M's diagonal that it must not be negligible against.
        pivots: Vec<(usize, Id, Id)>,
    },
    /// By a loop over the packed lower triangle.
    Loop,
}

/// Above this many operations of factoring and substituting a loop costs no more time and less code,
const UNROLL_LIMIT: usize = 1500;
/// or so many of substituting alone,
const UNROLL_ONCE: usize = 20_000;
/// if these are more than so many for each coordinate: a diagonal, or a narrow band, is never made a full triangle.
const UNROLL_EACH: usize = 16;

/// Chooses and builds; `others` are other forms of h.
pub(super) fn accelerations(
    graph: &mut Graph,
    n: usize,
    mass: &[Entry],
    bias: &[Id],
    others: &[Vec<Id>],
) -> Accelerations {
    let varies = varying(graph);
    // A constant M is factored once per run.
    let once = mass.iter().all(|e| !varies[e.2.index()]);
    let limit = if once { UNROLL_ONCE } else { UNROLL_LIMIT };
    let Some(order) = elimination_order(n, mass, once, limit.max(UNROLL_EACH * n)) else {
        return Accelerations::Loop;
    };
    let mut rows: Vec<BTreeMap<usize, Id>> = vec![BTreeMap::new(); n];
    for &(i, j, m) in mass {
        rows[i].insert(j, m);
        rows[j].insert(i, m);
    }
    let mut rhs: Vec<Id> = bias.iter().map(|h| graph.neg(*h)).collect();
    let mut pivots = Vec::new();
    let mut eliminated = Vec::new();
    for &k in &order {
        let row = std::mem::take(&mut rows[k]);
        let pivot = row.get(&k).copied().unwrap_or(Id::ZERO);
        let diagonal = mass.iter().find(|e| (e.0, e.1) == (k, k)).map_or(Id::ZERO, |e| e.2);
        pivots.push((k, pivot, diagonal));
        let reciprocal = graph.div(Id::ONE, pivot);
        let others: Vec<(usize, Id)> = row.into_iter().filter(|(j, _)| *j != k).collect();
        let factors: Vec<(usize, Id)> = others.iter().map(|&(j, m)| (j, graph.mul(m, reciprocal))).collect();
        for &(i, factor) in &factors {
            for &(j, other) in others.iter().filter(|(j, _)| *j <= i) {
                let update = graph.mul(factor, other);
                let old = rows[i].get(&j).copied().unwrap_or(Id::ZERO);
                let new = graph.sub(old, update);
                rows[i].insert(j, new);
                rows[j].insert(i, new);
            }
            rows[i].remove(&k);
            let update = graph.mul(factor, rhs[k]);
            rhs[i] = graph.sub(rhs[i], update);
        }
        eliminated.push((k, reciprocal, factors));
    }
    let mut values = vec![Id::ZERO; n];
    for (k, reciprocal, factors) in eliminated.into_iter().rev() {
        let mut value = graph.mul(rhs[k], reciprocal);
        for (j, factor) in factors {
            let term = graph.mul(factor, values[j]);
            value = graph.sub(value, term);
        }
        values[k] = value;
    }
    let masses = constant_masses(graph, n, mass);
    let values = cheapest(graph, values, &tested(&pivots), (&masses, others.iter().map(Vec::as_slice).chain([bias])));
    Accelerations::Unrolled { values, pivots }
}

/// These accelerations, or those with constant masses divided into one of the forms of h, whichever take least time beside what
/// tests the pivots.
fn cheapest<'a>(
    graph: &mut Graph,
    mut values: Vec<Id>,
    tested: &[Id],
    (masses, forms): (&[Option<Id>], impl Iterator<Item = &'a [Id]>),
) -> Vec<Id> {
    for form in forms {
        let divided = divided(graph, &values, masses, form);
        let divided = gathered(graph, divided, tested);
        let takes = |values: &[Id]| work(graph, &[values, tested].concat());
        if takes(&divided) < takes(&values) {
            values = divided;
        }
    }
    values
}

/// What is computed to test the pivots.
fn tested(pivots: &[(usize, Id, Id)]) -> Vec<Id> {
    pivots.iter().flat_map(|(_, pivot, diagonal)| [*pivot, *diagonal]).collect()
}

/// What each coordinate has of M, where that is one constant on the diagonal.
fn constant_masses(graph: &Graph, n: usize, mass: &[Entry]) -> Vec<Option<Id>> {
    let varies = varying(graph);
    let mut masses = vec![None; n];
    for &(i, _, m) in mass.iter().filter(|e| e.0 == e.1 && !varies[e.2.index()]) {
        masses[i] = Some(m);
    }
    for &(i, j, _) in mass.iter().filter(|e| e.0 != e.1) {
        (masses[i], masses[j]) = (None, None);
    }
    masses
}

/// These accelerations, with every term of h divided by a constant mass by itself, so that its constant factors, computed once
/// per run, take the mass in.
fn divided(graph: &mut Graph, values: &[Id], masses: &[Option<Id>], bias: &[Id]) -> Vec<Id> {
    let accelerations = values.iter().zip(masses).zip(bias);
    let accelerations = accelerations.map(|((value, mass), h)| {
        let Some(mass) = *mass else { return *value };
        terms(graph, *h).into_iter().fold(Id::ZERO, |sum, (term, number)| {
            let factor = graph.constant(number);
            let force = graph.mul(factor, term);
            let part = graph.div(force, mass);
            graph.sub(sum, part)
        })
    });
    accelerations.collect()
}

impl Accelerations {
    /// Operations, those of M and h included.
    pub fn operations(&self, graph: &Graph, n: usize, mass: &[Entry], bias: &[Id]) -> usize {
        match self {
            Accelerations::Unrolled { values, pivots } => operations(graph, &[values.clone(), tested(pivots)].concat()),
            Accelerations::Loop => {
                let roots: Vec<Id> = mass.iter().map(|e| e.2).chain(bias.iter().copied()).collect();
                operations(graph, &roots) + dense_operations(n)
            }
        }
    }
}

/// Operations of factoring a full M and substituting.
pub(super) fn dense_operations(n: usize) -> usize {
    n * n * n / 3 + 2 * n * n
}

/// Operations of factoring a full M and J M⁻¹ Jᵀ of m rows, and substituting.
pub(super) fn dense_operations_with_rows(n: usize, m: usize) -> usize {
    dense_operations(n) + m * n * n + m * m * n + dense_operations(m) + 4 * m * n
}

/// Operations of eliminating a coordinate that is coupled with so many: its reciprocal, factors and updates.
fn operations_of_column(degree: usize) -> usize {
    1 + degree + degree * (degree + 1)
}

/// Minimum degree: next the coordinate that is coupled to the fewest others, the first of equals; `None` where factoring
/// and substituting in this order, or substituting alone where M is factored `once`, takes more operations than the limit.
fn elimination_order(n: usize, mass: &[Entry], once: bool, limit: usize) -> Option<Vec<usize>> {
    let mut coupled = couplings(n, mass);
    let mut left: Vec<usize> = (0..n).collect();
    let mut order = Vec::with_capacity(n);
    let mut operations = 0;
    while let Some(place) = (0..left.len()).min_by_key(|&p| (coupled[left[p]].len(), left[p])) {
        let k = left.remove(place);
        let degree = coupled[k].len();
        operations += if once { 0 } else { operations_of_column(degree) };
        operations += 4 * degree + 1;
        if operations > limit {
            return None;
        }
        eliminate(&mut coupled, k);
        order.push(k);
    }
    Some(order)
}

fn couplings(n: usize, mass: &[Entry]) -> Vec<std::collections::BTreeSet<usize>> {
    let mut coupled = vec![std::collections::BTreeSet::new(); n];
    for &(i, j, _) in mass.iter().filter(|e| e.0 != e.1) {
        coupled[i].insert(j);
        coupled[j].insert(i);
    }
    coupled
}

/// Removes a coordinate, and couples its neighbours with each other.
fn eliminate(coupled: &mut [std::collections::BTreeSet<usize>], k: usize) {
    let neighbours = std::mem::take(&mut coupled[k]);
    for &i in &neighbours {
        coupled[i].remove(&k);
        coupled[i].extend(neighbours.iter().copied().filter(|&j| j != i));
    }
}
