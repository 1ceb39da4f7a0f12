//! Forces that a file also counts in `potential_energy` or `dissipation`, or that do what gravity or a spring does.
//!
//! Where Q + ∂V/∂q vanishes at all states for some summands of V (Q + ∂D/∂q' for `dissipation`), force and summands
//! are one thing written twice.  Which summands is found by least squares over all states: Q + Σ c ∂V/∂q with every c
//! either 0 or 1.

use super::effects::{Effect, Kind, downhill};
use super::potential::sum;
use super::state::State;
use crate::derive::lagrange::speed_gradient;
use crate::derive::rates;
use crate::diagnose::Problem;
use crate::diagnose::catalogue::mechanics;
use crate::expr::{Binary, Graph, Id, Node, Tape, Unary, vectors};
use crate::model::text_in;
use crate::model::{Body, Model};

/// Q and a gradient are opposite where they differ by no more than this of the larger.
const TOLERANCE: f64 = 1e-9;
/// More summands than this are compared as a whole only.
const SUMMANDS: usize = 40;

/// Some entries taken together.
struct Group {
    names: String,
    place: crate::diagnose::Place,
    force: Vec<Id>,
    /// The one coordinate that matters, for an entry of `generalized_forces`.
    coordinate: Option<usize>,
    /// True for more than one entry.
    several: bool,
}

/// Errors for forces that `potential_energy` or `dissipation` has too, warnings for those that repeat another entry.
pub(super) fn counted_twice(
    graph: &mut Graph,
    model: &Model,
    effects: &[Effect],
    states: &[State],
) -> (Vec<Problem>, Vec<Problem>) {
    let (mut errors, mut warnings) = (Vec::new(), Vec::new());
    let groups = groups(graph, model, effects);
    let n = model.coordinates.len();
    for (key, root) in [("potential_energy", model.raw_potential_energy), ("dissipation", model.dissipation)] {
        if root == Id::ZERO || groups.is_empty() {
            continue;
        }
        let summands = summands(graph, root);
        let forces: Vec<Vec<Id>> = summands
            .iter()
            .map(|term| match key {
                "dissipation" => {
                    let minus = graph.integer(-1);
                    speed_gradient(graph, n, &[(*term, minus)])
                }
                _ => downhill(graph, n, *term),
            })
            .collect();
        let before = errors.len();
        for group in &groups {
            // What holds for one entry need not be said of several together.
            if group.several && errors.len() > before {
                break;
            }
            if let Some(chosen) = subset(graph, group, &forces, states) {
                let words: Vec<String> =
                    chosen.iter().map(|&k| format!("`{}`", text_in(graph, model, summands[k]))).collect();
                errors.push(mechanics::counted_twice(group.place.clone(), &group.names, key, words.join(" and ")));
            }
        }
    }
    for force in effects.iter().filter(|e| e.kind == Kind::Force) {
        let others = effects.iter().filter(|e| matches!(e.kind, Kind::Gravity | Kind::Spring | Kind::Resistance));
        for other in others {
            let same = Group {
                names: String::new(),
                place: force.place.clone(),
                force: force.force.clone(),
                coordinate: None,
                several: false,
            };
            if subset(graph, &same, std::slice::from_ref(&other.force), states).is_some() {
                warnings.push(mechanics::repeats(force.place.clone(), &force.words, &other.words));
            }
        }
    }
    (errors, warnings)
}

/// Warnings for energies that are written out although bodies, gravity or springs give them.
pub(super) fn energies_twice(graph: &mut Graph, model: &Model, effects: &[Effect], states: &[State]) -> Vec<Problem> {
    let mut warnings = Vec::new();
    let bodies: Vec<(String, Vec<Id>)> =
        model.bodies.iter().map(|body| (format!("the mass of `{}`", body.name), vec![kinetic(graph, body)])).collect();
    let given = effects.iter().filter(|e| matches!(e.kind, Kind::Gravity | Kind::Spring));
    let potentials: Vec<(String, Vec<Id>)> = given.map(|e| (e.words.clone(), e.force.clone())).collect();
    let n = model.coordinates.len();
    for (key, root, given) in [
        ("kinetic_energy", model.raw_kinetic_energy, bodies),
        ("potential_energy", model.raw_potential_energy, potentials),
    ] {
        if root == Id::ZERO || given.is_empty() {
            continue;
        }
        let columns: Vec<Vec<Id>> = given.iter().map(|(_, column)| column.clone()).collect();
        // The whole, and each of its terms.
        let mut terms = vec![root];
        terms.extend(summands(graph, root).into_iter().filter(|term| *term != root));
        let place = crate::diagnose::Place::default().key(key);
        let repeated = terms.iter().find_map(|term| {
            let force = if key == "kinetic_energy" { vec![*term] } else { downhill(graph, n, *term) };
            let of = Group { names: String::new(), place: place.clone(), force, coordinate: None, several: false };
            Some((*term, subset(graph, &of, &columns, states)?))
        });
        if let Some((term, chosen)) = repeated {
            let others: Vec<String> = chosen.iter().map(|k| given[*k].0.clone()).collect();
            let words = format!("`{}` in `{key}`", text_in(graph, model, term));
            warnings.push(mechanics::repeats(place, words, others.join(" and ")));
        }
    }
    warnings
}

/// The kinetic energy of a body.
fn kinetic(graph: &mut Graph, body: &Body) -> Id {
    let velocity = rates(graph, &body.position);
    let square = vectors::dot(graph, &velocity, &velocity);
    let mut doubled = graph.mul(body.mass, square);
    if let Some(rotation) = &body.rotation {
        let omega = rotation.own_angular_velocity(|angle| rates(graph, &[angle])[0]);
        let turning = rotation.doubled_energy(graph, &omega);
        doubled = graph.add(doubled, turning);
    }
    let two = graph.integer(2);
    graph.div(doubled, two)
}

/// Each force alone and each summand of a generalized force, each family, and all together.
fn groups(graph: &mut Graph, model: &Model, effects: &[Effect]) -> Vec<Group> {
    let forces: Vec<&Effect> = effects.iter().filter(|e| e.kind == Kind::Force).collect();
    let mut groups: Vec<Group> = forces
        .iter()
        .map(|e| Group {
            names: e.words.clone(),
            place: e.place.clone(),
            force: e.force.clone(),
            coordinate: e.coordinate,
            several: false,
        })
        .collect();
    for entry in &forces {
        let Some(i) = entry.coordinate else { continue };
        let parts = summands(graph, entry.force[i]);
        for part in parts.iter().filter(|_| parts.len() > 1) {
            let mut force = vec![Id::ZERO; entry.force.len()];
            force[i] = *part;
            let names = format!("`{}` of {}", text_in(graph, model, *part), entry.words);
            let (place, coordinate) = (entry.place.clone(), entry.coordinate);
            groups.push(Group { names, place, force, coordinate, several: false });
        }
    }
    let mut several = |members: &[&Effect]| {
        if members.len() > 1 {
            let shown: Vec<String> = members.iter().take(4).map(|e| e.words.clone()).collect();
            let more = if members.len() > 4 { ", …" } else { "" };
            let names = format!("{}{more} together", shown.join(", "));
            let force = sum(graph, members);
            groups.push(Group { names, place: members[0].place.clone(), force, coordinate: None, several: true });
        }
    };
    let families = forces.chunk_by(|a, b| a.place == b.place);
    families.for_each(&mut several);
    if forces.windows(2).any(|pair| pair[0].place != pair[1].place) {
        several(&forces);
    }
    groups
}

/// The places of the summands whose forces add up to the group's, none if there are no such.
fn subset(graph: &Graph, group: &Group, forces: &[Vec<Id>], states: &[State]) -> Option<Vec<usize>> {
    let rows: Vec<usize> = match group.coordinate {
        Some(i) => vec![i],
        None => (0..group.force.len()).collect(),
    };
    let columns = std::iter::once(&group.force).chain(forces);
    let roots: Vec<Id> = columns.flat_map(|column| rows.iter().map(|&i| column[i])).collect();
    let tape = Tape::new(graph, &roots);
    let mut samples: Vec<Vec<f64>> = vec![Vec::new(); forces.len() + 1];
    for state in states {
        let values: Vec<f64> = tape.evaluate(|s| state.value(s)).iter().map(|x| x.to_f64()).collect();
        let scale = values[..rows.len()].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        if scale == 0.0 || values.iter().any(|x| !x.is_finite()) {
            continue;
        }
        for (sample, column) in samples.iter_mut().zip(values.chunks(rows.len())) {
            sample.extend(column.iter().map(|x| x / scale));
        }
    }
    let (own, others) = samples.split_first()?;
    if own.is_empty() {
        return None;
    }
    let opposite = |chosen: &[usize]| {
        own.iter().enumerate().all(|(row, q)| {
            let (mut gap, mut size) = (*q, q.abs());
            for &k in chosen {
                gap -= others[k][row];
                size = size.max(others[k][row].abs());
            }
            gap.abs() <= TOLERANCE * size.max(1.0)
        })
    };
    let alone = (0..others.len()).map(|k| vec![k]).find(|chosen| opposite(chosen));
    let fitted = || {
        let weights = (others.len() <= SUMMANDS).then(|| least_squares(own, others))?;
        let chosen: Vec<usize> = (0..weights.len()).filter(|&k| weights[k] > 0.5).collect();
        (!chosen.is_empty() && opposite(&chosen)).then_some(chosen)
    };
    let all = || Some((0..others.len()).collect::<Vec<_>>()).filter(|chosen| opposite(chosen));
    alone.or_else(fitted).or_else(all)
}

/// Weights of some columns whose sum is nearest to a column; 0 for those that depend on others (Gram–Schmidt).
fn least_squares(target: &[f64], columns: &[Vec<f64>]) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    // Orthonormal directions, and each as a combination of the columns.
    let mut basis: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    for (k, column) in columns.iter().enumerate() {
        let (mut rest, mut mix) = (column.clone(), vec![0.0; columns.len()]);
        mix[k] = 1.0;
        // Twice is enough (Kahan; Parlett, The Symmetric Eigenvalue Problem, 1980, section 6-9).
        for (direction, of) in basis.iter().chain(&basis) {
            let share = dot(direction, &rest);
            rest.iter_mut().zip(direction).for_each(|(x, d)| *x -= share * d);
            mix.iter_mut().zip(of).for_each(|(x, d)| *x -= share * d);
        }
        let size = dot(&rest, &rest).sqrt();
        if size > 1e-9 * dot(column, column).sqrt() {
            rest.iter_mut().chain(&mut mix).for_each(|x| *x /= size);
            basis.push((rest, mix));
        }
    }
    let mut weights = vec![0.0; columns.len()];
    for (direction, mix) in &basis {
        let share = dot(direction, target);
        weights.iter_mut().zip(mix).for_each(|(w, m)| *w += share * m);
    }
    weights
}

/// The summands of an expression with their signs; a factor of a sum is multiplied in.
fn summands(graph: &mut Graph, root: Id) -> Vec<Id> {
    let mut found = Vec::new();
    let mut open = vec![(root, Vec::new())];
    while let Some((id, factors)) = open.pop() {
        let is_sum = |graph: &Graph, id: Id| {
            let inner = match graph.node(id) {
                Node::Unary(Unary::Neg, x) => x,
                _ => id,
            };
            matches!(graph.node(inner), Node::Binary(Binary::Add | Binary::Sub, ..))
        };
        let with = |factor: Id| [factors.as_slice(), &[factor]].concat();
        match graph.node(id) {
            Node::Unary(Unary::Neg, x) => {
                let minus = graph.integer(-1);
                open.push((x, with(minus)));
            }
            Node::Binary(Binary::Add, x, y) => open.extend([(y, factors.clone()), (x, factors)]),
            Node::Binary(Binary::Sub, x, y) => {
                let minus = graph.integer(-1);
                open.extend([(y, with(minus)), (x, factors)]);
            }
            Node::Binary(Binary::Mul, x, y) if is_sum(graph, x) => open.push((x, with(y))),
            Node::Binary(Binary::Mul, x, y) if is_sum(graph, y) => open.push((y, with(x))),
            Node::Binary(Binary::Div, x, y) if is_sum(graph, x) => {
                let share = graph.div(Id::ONE, y);
                open.push((x, with(share)));
            }
            _ => found.push(factors.iter().fold(id, |term, factor| graph.mul(*factor, term))),
        }
        if found.len() + open.len() > SUMMANDS {
            // Too many to tell apart.
            return vec![root];
        }
    }
    found
}
