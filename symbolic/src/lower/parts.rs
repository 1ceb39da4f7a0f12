//! Decoupled subsystems of a mechanism.

use rustc_hash::FxHashMap as HashMap;

use super::constraints::Constraints;
use super::count::{operations, varying};
use super::magnitude::Magnitudes;
use super::{Accelerations, Argument, Program, Watched};
use crate::derive::Switch;
use crate::expr::{Angles, Binary, Graph, Id, Node, Symbol, Unary, expand};
use crate::model::{Event, EventAction};

/// A part that is computed by itself: nothing here contains coordinates or speeds of the others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Its coordinates, in order.
    pub coordinates: Vec<usize>,
    /// T, V, Jacobi function, its power, Σ |terms|: its terms of those of the whole.
    pub energy: [Id; 5],
    /// Its equations are linear with constant coefficients (forced, perhaps).
    pub linear: bool,
    /// Its part of M does not change, and its forces contain no speeds.
    pub separable: bool,
    /// Its equations contain time or inputs.
    pub time_dependent: bool,
    /// Places, among the arguments that a run follows, of those inside its equations, and of those of time alone.
    pub arguments: Vec<usize>,
    /// Places of the events that read it alone, or time alone.
    pub events: Vec<usize>,
    /// Operations of its accelerations.
    pub operations: usize,
}

impl Part {
    /// Nothing does work on it but what has a potential, and its energies do not contain time.
    pub fn is_conservative(&self) -> bool {
        self.energy[3] == Id::ZERO
    }
}

/// Code for more parts than these would be longer than what their own steps are worth.
const MOST_PARTS: usize = 16;

/// The coordinates that the equation of motion of each contains: by what F, the rows of the constraints that act on it and the
/// arguments of discontinuities contain.  `None` where events change the phase or set values, so that each may depend on all.
pub(super) fn reads(
    graph: &Graph,
    residual: &[Id],
    constraints: &Constraints,
    switches: &[Switch],
    events: &[Event],
) -> Option<Vec<Vec<usize>>> {
    let changes = |action: &EventAction| {
        matches!(
            action,
            EventAction::Phase(_) | EventAction::Impact { .. } | EventAction::Set(_) | EventAction::Contact(_)
        )
    };
    if events.iter().any(|event| event.actions.iter().any(changes)) {
        return None;
    }
    let rows = rows(graph, constraints);
    let mut reads = active_in_each(graph, residual, (&rows, switches));
    for (row, coordinate, _) in &constraints.matrix {
        reads[*coordinate].extend(&rows[*row]);
    }
    Some(reads)
}

/// Sets of coordinates whose equations of motion contain nothing of the others', in the order of their first ones.
pub(super) fn parts(n: usize, reads: Option<&[Vec<usize>]>) -> Vec<Vec<usize>> {
    let Some(reads) = reads else { return if n == 0 { Vec::new() } else { vec![(0..n).collect()] } };
    let mut part: Vec<usize> = (0..n).collect();
    let mut joins = vec![false; n];
    for (row, read) in reads.iter().enumerate() {
        let joined: Vec<usize> = read.iter().chain([&row]).map(|member| part[*member]).collect();
        let least = joined.iter().min().copied().unwrap_or(row);
        joined.iter().for_each(|own| joins[*own] = *own != least);
        part.iter_mut().filter(|own| joins[**own]).for_each(|own| *own = least);
        joined.iter().for_each(|own| joins[*own] = false);
    }
    let mut parts: Vec<Vec<usize>> = vec![Vec::new(); n];
    (0..n).for_each(|k| parts[part[k]].push(k));
    parts.retain(|part| !part.is_empty());
    parts
}

/// These coordinates, and all on which their motion depends, by way of others too.
pub(super) fn closure(reads: &[Vec<usize>], from: impl IntoIterator<Item = usize>) -> Vec<bool> {
    let mut reached = vec![false; reads.len()];
    let mut left: Vec<usize> = from.into_iter().collect();
    while let Some(k) = left.pop() {
        if !std::mem::replace(&mut reached[k], true) {
            left.extend(&reads[k]);
        }
    }
    reached
}

/// The coordinates that each row contains.
pub(super) fn rows(graph: &Graph, constraints: &Constraints) -> Vec<Vec<usize>> {
    let mut rows: Vec<Vec<usize>> = constraints.bias.iter().map(|bias| active(graph, &[*bias], (&[], &[]))).collect();
    for (row, coordinate, slope) in &constraints.matrix {
        rows[*row].push(*coordinate);
        rows[*row].extend(active(graph, &[*slope], (&[], &[])));
    }
    rows
}

/// The parts that can be computed by themselves; none where there are fewer than two or too many of them, where constraints,
/// discontinuities or states of first order act, where accelerations are not written out, or where a term of the energies or an event belongs to several.
pub(super) fn computed_apart(program: &mut Program) -> Vec<Part> {
    let parts = std::mem::take(&mut program.structure.parts);
    let found = apart(program, &parts);
    program.structure.parts = parts;
    found.unwrap_or_default()
}

fn apart(program: &mut Program, parts: &[Vec<usize>]) -> Option<Vec<Part>> {
    let Program { model, switches, constraints, residual, arguments, .. } = program;
    let tied = !(switches.is_empty() && constraints.is_empty() && model.states.is_empty() && model.memory.is_empty());
    let Accelerations::Unrolled { values, pivots } = &program.accelerations else { return None };
    if tied || !(2..=MOST_PARTS).contains(&parts.len()) {
        return None;
    }
    let graph = &mut model.graph;
    let readers = readers(graph, &model.events, parts)?;
    let [kinetic, potential, jacobi, power, _] = program.energy;
    let mut shares = |energy: Id| shares(graph, energy, parts);
    let energies = [shares(kinetic)?, shares(potential)?, shares(jacobi)?, shares(power)?];
    let mut magnitudes = Magnitudes::default();
    let varies = varying(graph);
    let slopes = [&program.mass, &program.stiffness, &program.damping];
    let mut found = Vec::with_capacity(parts.len());
    for (k, coordinates) in parts.iter().enumerate() {
        let own = |i: &usize| coordinates.contains(i);
        let [kinetic, potential, jacobi, power] = [0, 1, 2, 3].map(|which: usize| energies[which][k]);
        let sizes = [kinetic, potential].map(|energy| magnitudes.of(graph, energy));
        let tested = pivots.iter().filter(|pivot| own(&pivot.0)).flat_map(|pivot| [pivot.1, pivot.2]);
        let roots: Vec<Id> = coordinates.iter().map(|i| values[*i]).chain(tested).collect();
        if !active(graph, &roots, (&[], &[])).iter().all(own) {
            return None;
        }
        let forces = coordinates.iter().map(|i| residual[*i]);
        let events: Vec<usize> = (0..readers.len()).filter(|event| readers[*event] == k).collect();
        // An M that is not formed changes.
        let steady = !program.unformed && !program.mass.iter().any(|entry| own(&entry.0) && varies[entry.2.index()]);
        let bias = graph.symbols(coordinates.iter().filter_map(|i| program.bias.get(*i).copied()));
        found.push(Part {
            separable: steady && !bias.iter().any(|s| matches!(s, Symbol::Speed(_))),
            coordinates: coordinates.clone(),
            energy: [kinetic, potential, jacobi, power, graph.add(sizes[0], sizes[1])],
            linear: steady
                && slopes.iter().all(|list| !list.iter().any(|entry| own(&entry.0) && varies[entry.2.index()])),
            time_dependent: graph.symbols(forces).iter().any(|s| matches!(s, Symbol::Time | Symbol::Input(..))),
            arguments: arguments_of(graph, arguments, (&events, own)),
            events,
            operations: operations(graph, &roots),
        });
    }
    Some(found)
}

/// What each part has of an energy that is a sum over them; what depends on time alone belongs to none.  `None` for one that is no such
/// sum, multiplied out or not.
fn shares(graph: &mut Graph, energy: Id, parts: &[Vec<usize>]) -> Option<Vec<Id>> {
    let parameter = |s: Symbol| matches!(s, Symbol::Parameter(_));
    let of_all = |graph: &mut Graph, energy: Id| -> Option<Vec<Id>> {
        parts.iter().map(|part| share(graph, energy, part)).collect()
    };
    of_all(graph, energy).or_else(|| {
        let expanded = expand(graph, &[energy], parameter, Angles::Shorter)?;
        of_all(graph, expanded[0])
    })
}

/// What one part has of an energy.
fn share(graph: &mut Graph, energy: Id, part: &[usize]) -> Option<Id> {
    let contains = |own: bool| {
        graph.contains(|symbol| match symbol {
            Symbol::Coordinate(i) | Symbol::Speed(i) => part.contains(&(i as usize)) == own,
            _ => false,
        })
    };
    let (own, others) = (contains(true), contains(false));
    let fixed = |x: Id| !own[x.index()] && !others[x.index()];
    let mut known: HashMap<Id, Option<Id>> = HashMap::default();
    for id in graph.needed([energy]) {
        let of = |x: Id| known.get(&x).copied().flatten();
        let share = match graph.node(id) {
            _ if !own[id.index()] => Some(Id::ZERO),
            _ if !others[id.index()] => Some(id),
            Node::Unary(Unary::Neg, x) => of(x).map(|x| graph.neg(x)),
            Node::Binary(Binary::Add, x, y) => of(x).zip(of(y)).map(|(x, y)| graph.add(x, y)),
            Node::Binary(Binary::Sub, x, y) => of(x).zip(of(y)).map(|(x, y)| graph.sub(x, y)),
            Node::Binary(Binary::Mul, x, y) if fixed(x) => of(y).map(|y| graph.mul(x, y)),
            Node::Binary(Binary::Mul, x, y) if fixed(y) => of(x).map(|x| graph.mul(x, y)),
            Node::Binary(Binary::Div, x, y) if fixed(y) => of(x).map(|x| graph.div(x, y)),
            _ => None,
        };
        known.insert(id, share);
    }
    known.get(&energy).copied().flatten()
}

/// The part that each event reads, the first where it reads time alone; `None` where one reads several.
fn readers(graph: &Graph, events: &[Event], parts: &[Vec<usize>]) -> Option<Vec<usize>> {
    let reader = |event: &Event| {
        let read: Vec<Id> = std::iter::once(event.when).chain(event.condition).collect();
        let active = active(graph, &read, (&[], &[]));
        parts.iter().position(|part| active.iter().all(|i| part.contains(i)))
    };
    events.iter().map(reader).collect()
}

/// The places of arguments that contain coordinates of one part, or none, and stand in its equations, its events, or others of these.
fn arguments_of(
    graph: &Graph,
    arguments: &[Argument],
    (events, own): (&[usize], impl Fn(&usize) -> bool),
) -> Vec<usize> {
    let mut found: Vec<usize> = Vec::new();
    for (place, argument) in arguments.iter().enumerate() {
        // What an argument stands in comes before it.
        let within = match argument.of {
            Watched::Argument(outer) => found.contains(&outer),
            Watched::Event(event) => events.contains(&event),
            Watched::Motion | Watched::Switch(_) => true,
        };
        if within && active(graph, &[argument.value], (&[], &[])).iter().all(&own) {
            found.push(place);
        }
    }
    found
}

/// The same of each expression by itself, each node looked at once.
fn active_in_each(graph: &Graph, expressions: &[Id], (rows, switches): (&[Vec<usize>], &[Switch])) -> Vec<Vec<usize>> {
    let n = expressions.len();
    let place = |symbol| match symbol {
        Symbol::Coordinate(i) | Symbol::Speed(i) | Symbol::Acceleration(i) => Some(i as usize),
        Symbol::Multiplier(row) => Some(n + row as usize),
        Symbol::Mode(k) => Some(n + rows.len() + k as usize),
        _ => None,
    };
    let of_switch: Vec<Vec<usize>> =
        (0..switches.len()).map(|k| active(graph, &[switches[k].argument], (rows, &switches[..k]))).collect();
    let coordinates = |place: usize| match place.checked_sub(n) {
        None => vec![place],
        Some(row) if row < rows.len() => rows[row].clone(),
        Some(other) => of_switch.get(other - rows.len()).cloned().unwrap_or_default(),
    };
    let contained = graph.contained_in_each(expressions, place);
    contained.into_iter().map(|places| places.into_iter().flat_map(coordinates).collect()).collect()
}

/// The coordinates of which expressions contain anything, by way of multipliers and discontinuities too.
pub(super) fn active(graph: &Graph, expressions: &[Id], (rows, switches): (&[Vec<usize>], &[Switch])) -> Vec<usize> {
    let mut found = Vec::new();
    for symbol in graph.symbols(expressions.iter().copied()) {
        match symbol {
            Symbol::Coordinate(i) | Symbol::Speed(i) | Symbol::Acceleration(i) => found.push(i as usize),
            Symbol::Multiplier(row) => found.extend(rows.get(row as usize).into_iter().flatten()),
            // A switch's argument contains modes of earlier switches only.
            Symbol::Mode(k) => {
                let earlier = switches.get(..k as usize).unwrap_or_default();
                found.extend(
                    switches.get(k as usize).map_or_else(Vec::new, |s| active(graph, &[s.argument], (rows, earlier))),
                );
            }
            _ => {}
        }
    }
    found
}
