//! Loads at points that several bodies carry (a hinge): does it matter which of them takes the load?
//!
//! Lagrange's equations cannot tell, since the materials of all carriers move alike there.  A system of balances can: a
//! force that passes from one bar to the next through a hinge changes the hinge's reaction.  The load enters linearly,
//! so each change of one end is judged alone, with the solution of the system before and after it.

use super::state::State;
use super::system::{Assembled, Row, evaluate, zero};
use crate::derive::momentum::{Momentum, unknowns};
use crate::diagnose::Problem;
use crate::diagnose::catalogue::mechanics;
use crate::expr::{Measured, Symbol, Tape};
use crate::model::{Model, SharedEnd, rate_name};

/// An error for every end whose body must be named.
pub(super) fn ambiguous(model: &mut Model, momentum: &[Momentum], states: &[State]) -> Vec<Problem> {
    let ends = model.shared_ends.clone();
    let mut problems = Vec::new();
    for end in &ends {
        if let Some(difference) = difference(model, momentum, end, states) {
            let name = |body: &usize| format!("`{}`", model.bodies[*body].name);
            let bodies: Vec<String> = end.bodies.iter().map(name).collect();
            let (last, others) = bodies.split_last().map_or(("", Vec::new()), |(l, o)| (l.as_str(), o.to_vec()));
            let listed = format!("{} and {last}", others.join(", "));
            let first = &model.bodies[end.bodies[0]].name;
            let load = &model.loads[end.load].name;
            problems.push(mechanics::shared_point(end.place.clone(), load, &end.point, listed, first, difference));
        }
    }
    problems
}

/// What another choice of the body would change, in words.
fn difference(model: &mut Model, momentum: &[Momentum], end: &SharedEnd, states: &[State]) -> Option<String> {
    for (s, system) in model.balances.clone().iter().enumerate() {
        let changes: Vec<_> = end.changes.iter().filter(|c| c.system == s).collect();
        let tape = Tape::new(&model.graph, &changes.iter().map(|c| c.value).collect::<Vec<_>>());
        let values: Vec<Vec<Measured>> = states.iter().map(|state| tape.evaluate(|s| state.measured(s))).collect();
        if values.iter().flatten().all(|x| x.vanishes(super::ROUNDINGS)) {
            continue;
        }
        if momentum.get(s).is_some_and(|linear| linear.unformed.is_some()) {
            // The accelerations that satisfy an equation do not satisfy it with a part more.
            let bodies: Vec<&str> = end.bodies.iter().map(|b| model.bodies[*b].name.as_str()).collect();
            return Some(format!(
                "a balance of `{}` is another one with it on another of {}",
                system.name,
                bodies.join(", ")
            ));
        }
        let columns = unknowns(model, system);
        let rows = evaluate(&mut model.graph, system, &columns, states);
        let equations = system.balances.iter().map(|b| b.components).sum();
        let solve = |rows: &[Row]| Assembled::of(rows, equations, columns.len(), None).solution();
        for &body in end.bodies.iter().skip(1) {
            for (rows, values) in rows.iter().zip(&values) {
                let Some(before) = solve(rows) else { continue };
                let moved = changes.iter().zip(values).filter(|(c, _)| c.body == body);
                let extra = moved.map(|(c, x)| Row::known(c.equation, vec![zero(); columns.len()], *x));
                let all: Vec<Row> = rows.iter().cloned().chain(extra).collect();
                let Some(after) = solve(&all) else { continue };
                if let Some(k) = differing(&before, &after, model.coordinates.len()) {
                    let bodies = [end.bodies[0], body].map(|b| model.bodies[b].name.as_str());
                    let what = unknown(model, columns[k]);
                    return Some(format!(
                        "{what} of `{}` is {:.6e} with it on `{}` and {:.6e} with it on `{}`",
                        system.name,
                        before[k].value.to_f64(),
                        bodies[0],
                        after[k].value.to_f64(),
                        bodies[1]
                    ));
                }
            }
        }
    }
    None
}

/// The unknown that differs most beside its own magnitude; reactions are looked at first.
fn differing(before: &[Measured], after: &[Measured], coordinates: usize) -> Option<usize> {
    let gap = |k: usize| (before[k].value - after[k].value).abs().to_f64();
    let size = |k: usize| before[k].magnitude + after[k].magnitude;
    let share = |k: usize| if size(k) > 0.0 { gap(k) / size(k) } else { 0.0 };
    let among = |range: std::ops::Range<usize>| {
        range.max_by(|i, j| share(*i).total_cmp(&share(*j))).filter(|&k| share(k) > 1e-20)
    };
    among(coordinates..before.len()).or_else(|| among(0..coordinates))
}

/// A reaction, or an acceleration, in words.
fn unknown(model: &Model, symbol: Symbol) -> String {
    match symbol {
        Symbol::Reaction(k) => {
            let owner = model.reactions.iter().find(|r| r.symbols().any(|s| s == symbol));
            let component = |first: u32| [".x", ".y", ".z"].get((k - first) as usize).copied().unwrap_or("");
            owner.map_or(String::new(), |r| format!("`{}{}`", r.name, if r.scalar { "" } else { component(r.first) }))
        }
        Symbol::Acceleration(i) => format!("`{}`", rate_name(&model.coordinates[i as usize].name, 2)),
        _ => String::new(),
    }
}
