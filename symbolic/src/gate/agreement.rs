//! The routes from energies and from bodies against each other, entry by entry.
//!
//! M of two routes is compared entry by entry, h and F(t, q, q', q'') row by row, F at accelerations of its own, and F
//! with M q'' + h within each route; where M and h are not formed F alone, and F with accelerations by elimination, which leave
//! nothing of it; rows of constraints, and the forces of their multipliers, by forward and by reverse
//! passes; every difference by the magnitude of the terms of its own entry.

use super::Gate;
use super::report::Agreement;
use super::state::{State, describe};
use crate::derive::{Equations, Rows, RowsAgain};
use crate::diagnose::catalogue::verdicts;
use crate::diagnose::{Place, Problem};
use crate::expr::{Graph, Id, Measured, Symbol, Tape};
use crate::model::{Model, rate_name};
use crate::number::DoubleDouble;

/// Compares every further route with the first.
pub(super) fn agreement(
    model: &mut Model,
    equations: &[Equations],
    states: &[State],
    gate: Gate,
) -> Result<Vec<Agreement>, Box<Problem>> {
    let mut agreements = Vec::new();
    for (k, route) in equations.iter().enumerate() {
        // A route with its own M q'' + h, and with the first route's results.
        let n = model.coordinates.len();
        let mut pairs = Vec::new();
        let formed = !route.bias.is_empty();
        if formed {
            let composed = composed(&mut model.graph, n, route);
            pairs.extend(route.residual.iter().copied().zip(composed).enumerate().map(|(i, (x, y))| (i, x, y)));
        }
        if k > 0 {
            let first = &equations[0];
            pairs.extend((0..n).map(|i| (i, first.residual[i], route.residual[i])));
            if formed {
                pairs.extend((0..n).map(|i| (i, first.bias[i], route.bias[i])));
                pairs.extend(entries(first, route));
            }
        }
        let name = |i: usize| row_name(model, i);
        if k == 0 && !formed {
            satisfied(model, (&route.residual, &name), states, gate)?;
        }
        let worst = compare(model, (&pairs, &name, &|_, _| true), states, gate)?;
        if k > 0 {
            let between = (equations[0].name.to_owned(), route.name.to_owned());
            agreements.push(Agreement { between, states: states.len(), worst });
        }
    }
    Ok(agreements)
}

/// What a row of F is called, and where it stands.
fn row_name(model: &Model, i: usize) -> (Place, String) {
    let coordinate = &model.coordinates[i];
    let what = match coordinate.is_hidden() {
        true => format!("the rate `{}`", rate_name(&coordinate.name, 2)),
        false => format!("the acceleration of `{}`", coordinate.name),
    };
    (Place::default().key("bodies"), what)
}

/// Whether nothing is left of F with the states' own accelerations.
fn satisfied(
    model: &Model,
    (residual, name): (&[Id], Naming<'_>),
    states: &[State],
    gate: Gate,
) -> Result<(), Box<Problem>> {
    let tape = Tape::new(&model.graph, residual);
    for state in states {
        let rows = tape.evaluate(|s| state.measured(s));
        let largest = rows.iter().fold(0.0_f64, |most, row| most.max(row.magnitude));
        for (i, row) in rows.iter().enumerate() {
            let left = row.value.to_f64().abs();
            if !gate.agrees(left, row.magnitude, largest) {
                let (place, what) = name(i);
                let by = format!("{left:.3e}");
                return Err(Box::new(verdicts::derivations_disagree(place, what, by, describe(model, state))));
            }
        }
    }
    Ok(())
}

/// Compares the rows of the constraints, differentiated in one way and in the other.
pub(super) fn rows(model: &mut Model, rows: &Rows, states: &[State], gate: Gate) -> Result<f64, Box<Problem>> {
    let (n, count) = (model.coordinates.len(), rows.len());
    let graph = &mut model.graph;
    let again = RowsAgain::of(graph, rows, n);
    let mut matrix = vec![vec![Id::ZERO; n]; count];
    rows.matrix.iter().for_each(|(row, i, x)| matrix[*row][*i] = *x);
    let both =
        |first: &[Id], second: &[Id]| -> Vec<(Id, Id)> { first.iter().copied().zip(second.iter().copied()).collect() };
    let mut pairs = Vec::new();
    for (k, line) in matrix.iter().enumerate() {
        let values =
            both(&[rows.rate[k], rows.bias[k], rows.drive[k]], &[again.rate[k], again.bias[k], again.drive[k]]);
        let all = values.into_iter().chain(both(line, &again.matrix[k]));
        pairs.extend(all.map(|(x, y)| (k, x, y)));
    }
    let forces = both(&rows.forces, &again.forces);
    pairs.extend(forces.into_iter().enumerate().map(|(i, (x, y))| (count + i, x, y)));
    let name = |k: usize| match k.checked_sub(count) {
        None => (Place::default().key("constraints"), format!("the constraint `{}`", model.row_name(k))),
        Some(i) => {
            let name = &model.coordinates[i].name;
            (Place::default().key("constraints"), format!("what constraints do to `{name}`"))
        }
    };
    // Off the constraints' speeds, where c' does not vanish.
    let states: Vec<State> = states.iter().enumerate().map(|(k, state)| astray(state, k)).collect();
    // A constraint that does not act may be undefined, as the distance of points that meet.
    let acts = |k: usize, state: &State| {
        let active = model.phases.get(state.phase).map_or_else(Vec::new, |phase| model.rows_of(phase));
        if k < count { active.contains(&k) } else { active.len() == count }
    };
    compare(model, (&pairs, &name, &acts), &states, gate)
}

/// A state with other speeds.
fn astray(state: &State, k: usize) -> State {
    let mut other = state.clone();
    for (i, v) in other.v.iter_mut().enumerate() {
        let along = v.to_f64();
        *v = DoubleDouble::from(turned(along, i, k));
    }
    other
}

/// Another number of the same size, or of size 1 in the place of none.
fn turned(along: f64, i: usize, k: usize) -> f64 {
    let size = if along == 0.0 { 1.0 } else { along };
    size * (0.6 + (i as f64 * 1.7 + k as f64).sin())
}

/// M q'' + h.
fn composed(graph: &mut Graph, n: usize, route: &Equations) -> Vec<Id> {
    let accelerations: Vec<Id> = (0..n).map(|i| graph.symbol(Symbol::Acceleration(i as u32))).collect();
    let mut rows = route.bias.clone();
    for &(i, j, m) in &route.mass {
        let term = graph.mul(m, accelerations[j]);
        rows[i] = graph.add(rows[i], term);
        if i != j {
            let term = graph.mul(m, accelerations[i]);
            rows[j] = graph.add(rows[j], term);
        }
    }
    rows
}

/// Entries of M by both routes, 0 where one has none.
fn entries(first: &Equations, second: &Equations) -> Vec<(usize, Id, Id)> {
    let in_order = |route: &Equations| {
        let mut mass = route.mass.clone();
        mass.sort_by_key(|e| (e.0, e.1));
        mass
    };
    let (first, second) = (in_order(first), in_order(second));
    let value = |mass: &[(usize, usize, Id)], at: (usize, usize)| {
        mass.binary_search_by_key(&at, |e| (e.0, e.1)).map_or(Id::ZERO, |k| mass[k].2)
    };
    let mut places: Vec<(usize, usize)> = first.iter().chain(&second).map(|e| (e.0, e.1)).collect();
    places.sort_unstable();
    places.dedup();
    places.into_iter().map(|at| (at.0, value(&first, at), value(&second, at))).collect()
}

/// What a row is called, and where it stands.
type Naming<'a> = &'a dyn Fn(usize) -> (Place, String);
/// Whether a row must be defined at a state.
type Judged<'a> = &'a dyn Fn(usize, &State) -> bool;

/// What a difference belongs to, and the two expressions that should be one.
type Pair = (usize, Id, Id);

/// The largest relative difference of pairs that stand for the same row, or the first that differs.
fn compare(
    model: &Model,
    (pairs, name, acts): (&[Pair], Naming<'_>, Judged<'_>),
    states: &[State],
    gate: Gate,
) -> Result<f64, Box<Problem>> {
    let differing: Vec<&Pair> = pairs.iter().filter(|(_, x, y)| x != y).collect();
    let roots: Vec<Id> = differing.iter().flat_map(|(_, x, y)| [*x, *y]).collect();
    let tape = Tape::new(&model.graph, &roots);
    let (mut scratch, mut values) = (Vec::new(), vec![Measured::exact(DoubleDouble::ZERO); roots.len()]);
    let mut worst = 0.0_f64;
    for (k, state) in states.iter().enumerate() {
        // Accelerations other than the motion's: the residual must agree off the motion as well.
        let off = |s: Symbol| match s {
            Symbol::Acceleration(i) => {
                let along = state.a.get(i as usize).map_or(1.0, |a| a.value.to_f64());
                Measured::exact(DoubleDouble::from(turned(along, i as usize, k)))
            }
            _ => state.measured(s),
        };
        tape.run(off, &mut scratch, &mut values);
        let rows: Vec<(Measured, Measured)> = values.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
        let largest = rows.iter().fold(0.0_f64, |most, (x, y)| most.max(x.magnitude).max(y.magnitude));
        for ((i, ..), (x, y)) in differing.iter().zip(&rows) {
            let own = x.magnitude + y.magnitude;
            let difference = (x.value - y.value).abs().to_f64();
            if difference.is_nan() && !acts(*i, state) {
                continue;
            }
            if !gate.agrees(difference, own, largest) {
                let (place, what) = name(*i);
                let by = format!("{difference:.3e}");
                return Err(Box::new(verdicts::derivations_disagree(place, what, by, describe(model, state))));
            }
            // What underflows has no magnitude.
            if difference > f64::MIN_POSITIVE {
                worst = worst.max(difference / own);
            }
        }
    }
    Ok(worst)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::derive::derive;
    use crate::expr::Rational;
    use crate::gate::{motion::Motion, states::states};
    use crate::model::load;

    /// Every entry of M, h and F of either derivation times 1 + 1e-12, flipped or dropped, alone: all are refused.
    #[test]
    fn a_fault_in_one_entry_of_one_derivation_is_refused() {
        for text in [
            include_str!("../../../models/double_pendulum.yaml"),
            include_str!("../../../models/cart_pendulum.yaml"),
            include_str!("../../tests/faults/scales/scales_sensor.yaml"),
        ] {
            let mut derivation = derive(load(text, &[]).unwrap()).unwrap();
            let model = &mut derivation.model;
            let motion = Motion::new(model, (&derivation.equations[0], None), &derivation.rows, &derivation.switches);
            let gate = Gate::default();
            let all = states(model, &motion, &[], &[], gate).map_err(|problem| problem.message).unwrap().all;
            assert!(agreement(model, &derivation.equations, &all, gate).is_ok());
            let parts = 1_000_000_000_000;
            let mut planted = 0;
            for k in 0..derivation.equations.len() {
                let route = &derivation.equations[k];
                let sizes = [route.mass.len(), route.bias.len(), route.residual.len()];
                for (part, size) in sizes.into_iter().enumerate() {
                    let factors = [(parts + 1, parts), (-1, 1), (0, 1)];
                    for (entry, (n, d)) in (0..size).flat_map(|i| factors.map(|f| (i, f))) {
                        let mut altered = derivation.equations.clone();
                        let id = match part {
                            0 => &mut altered[k].mass[entry].2,
                            1 => &mut altered[k].bias[entry],
                            _ => &mut altered[k].residual[entry],
                        };
                        if *id == Id::ZERO {
                            continue;
                        }
                        let factor = model.graph.rational(Rational::new(n, d).unwrap());
                        *id = model.graph.mul(factor, *id);
                        planted += 1;
                        assert!(agreement(model, &altered, &all, gate).is_err(), "{k} {part} {entry} times {n}/{d}");
                    }
                }
            }
            assert!(planted > 20, "{planted}");
        }
    }

    /// The same of F where M is not formed, and of accelerations that do not belong to it.
    #[test]
    fn a_fault_in_one_row_of_what_is_not_formed_is_refused() {
        let model = load(include_str!("../../../models/chain.yaml"), &[("n".to_owned(), 17)]).unwrap();
        let mut derivation = derive(model).unwrap();
        let model = &mut derivation.model;
        let eliminated = derivation.eliminated.as_ref();
        assert!(eliminated.is_some() && derivation.equations[0].bias.is_empty());
        let motion = Motion::new(model, (&derivation.equations[0], eliminated), &derivation.rows, &derivation.switches);
        let gate = Gate::default();
        let all = states(model, &motion, &[], &[], gate).map_err(|problem| problem.message).unwrap().all;
        assert!(agreement(model, &derivation.equations, &all, gate).is_ok());
        for (k, i) in (0..2).flat_map(|k| (0..17).map(move |i| (k, i))) {
            for (n, d) in [(1_000_000_000_001, 1_000_000_000_000), (-1, 1), (0, 1)] {
                let mut altered = derivation.equations.clone();
                let factor = model.graph.rational(Rational::new(n, d).unwrap());
                altered[k].residual[i] = model.graph.mul(factor, altered[k].residual[i]);
                assert!(agreement(model, &altered, &all, gate).is_err(), "{k} {i} times {n}/{d}");
            }
        }
        for i in 0..17 {
            let mut wrong = all.clone();
            let a = &mut wrong[3].a[i];
            a.value = a.value * DoubleDouble::from(1.0 + 1e-12);
            assert!(agreement(model, &derivation.equations, &wrong, gate).is_err(), "{i}");
        }
    }
}
