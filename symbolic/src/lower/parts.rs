//! Parts of a mechanism that do not feel each other.

use super::Entry;
use crate::derive::Switch;
use crate::expr::{Graph, Id, Symbol};
use crate::model::{Event, EventAction};

/// Sets of coordinates whose equations of motion contain nothing of the others', in the order of their first ones: by what F, the
/// rows of the constraints (their entries of J) and the arguments of discontinuities contain.  Where events change the phase all
/// is one part.
pub(super) fn parts(
    graph: &Graph,
    n: usize,
    (residual, rows): (&[Id], &[Entry]),
    switches: &[Switch],
    events: &[Event],
) -> Vec<Vec<usize>> {
    let changes = |action: &EventAction| matches!(action, EventAction::Phase(_) | EventAction::Impact { .. });
    if events.iter().any(|event| event.actions.iter().any(changes)) {
        return if n == 0 { Vec::new() } else { vec![(0..n).collect()] };
    }
    let mut part: Vec<usize> = (0..n).collect();
    let mut join = |members: &[usize]| {
        let least = members.iter().map(|member| part[*member]).min();
        let joined: Vec<usize> = members.iter().map(|member| part[*member]).collect();
        part.iter_mut().filter(|own| joined.contains(own)).for_each(|own| *own = least.unwrap_or(*own));
    };
    for (row, force) in residual.iter().enumerate() {
        let mut members = felt(graph, *force, (rows, switches));
        members.push(row);
        join(&members);
    }
    for &(row, ..) in rows {
        join(&of_row(row, rows));
    }
    let of = |first: usize| (0..n).filter(|k| part[*k] == first).collect();
    (0..n).filter(|k| part[*k] == *k).map(of).collect()
}

/// The coordinates of which an expression contains anything, by way of multipliers and discontinuities too.
pub(super) fn felt(graph: &Graph, expression: Id, (rows, switches): (&[Entry], &[Switch])) -> Vec<usize> {
    let mut found = Vec::new();
    for symbol in graph.symbols([expression]) {
        match symbol {
            Symbol::Coordinate(i) | Symbol::Speed(i) | Symbol::Acceleration(i) => found.push(i as usize),
            Symbol::Multiplier(row) => found.extend(of_row(row as usize, rows)),
            // A switch's argument contains modes of earlier switches only.
            Symbol::Mode(k) => {
                let earlier = switches.get(..k as usize).unwrap_or_default();
                found.extend(
                    switches.get(k as usize).map_or_else(Vec::new, |s| felt(graph, s.argument, (rows, earlier))),
                );
            }
            _ => {}
        }
    }
    found
}

fn of_row(row: usize, rows: &[Entry]) -> Vec<usize> {
    rows.iter().filter(|entry| entry.0 == row).map(|entry| entry.1).collect()
}
