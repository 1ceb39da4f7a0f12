//! What a run has to follow besides values: arguments through which functions are local.
//!
//! exp(A) lives where A is near its largest, tanh(A) where |A| is small, sin(A) turns with every π of A; A itself is
//! tame.  So nothing that an expression does between two points goes unseen if its arguments are followed.

use std::collections::BTreeSet;

use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};

use super::read_signals;
use super::zero_factors::gates;
use crate::derive::rates;
use crate::expr::{Binary, DoubleDouble, Graph, Id, Node, Number, Symbol, Unary};

/// An argument of a function inside something that is watched.
#[derive(Clone, Debug, PartialEq)]
pub struct Argument {
    /// Inside what.
    pub of: Watched,
    /// How it makes that local.
    pub role: Role,
    /// The argument.
    pub value: Id,
    /// Its total time derivative.
    pub rate: Id,
    /// True when it depends on time and parameters alone.
    pub time_only: bool,
    /// The spring, damper or force whose direction it tells, the table whose points it counts; else empty.
    pub load: String,
    /// Free parameters, by their places, that multiply all that it does to the equations of motion.
    pub gates: Vec<u32>,
}

/// What is watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Watched {
    /// An event's function, by its place.
    Event(usize),
    /// A switch's argument, by its place.
    Switch(usize),
    /// The equations of motion, inputs included.
    Motion,
    /// Another argument, by its place in the list.
    Argument(usize),
}

/// How an argument A makes a function local.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// sin A, cos A, tan A.
    Phase,
    /// Something happens where A or its rate vanishes: `abs`, `step`, `exp`, … inside of what is watched.
    Landmark,
    /// exp A.
    Exponential,
    /// tanh A, sinh A, cosh A.
    Bounded,
    /// atan A.
    Arctangent,
    /// The points of a table that A has passed.
    Points,
    /// A squared distance: a force acts along the line, which has no direction where A vanishes.
    Distance,
    /// Aᵖ, p negative or no integer; ln A counts as p = 1.
    Power(f64),
}

/// Arguments inside the events, the switches' arguments and the equations of motion, in an order in which an argument's
/// own arguments come after it; without those in which held values are that are `directions` of sliding.  What reads an input
/// has the arguments inside its signal, and what reads a reaction or an acceleration turns with the phases inside the equations that
/// `determine` these.
pub(super) fn arguments(
    graph: &mut Graph,
    signals: &[[Id; 3]],
    (events, determine): (&[Id], &[Id]),
    switches: &[Id],
    motion: &[Id],
    loads: &[(String, Vec<Id>)],
    directions: Vec<u32>,
) -> Vec<Argument> {
    let mut list = List { directions, ..List::default() };
    let roots: Vec<Id> = determine.iter().flat_map(|f| with_signals(graph, signals, *f)).collect();
    let phases_of_solved = phases(graph, &roots);
    for (k, event) in events.iter().enumerate() {
        let roots = with_signals(graph, signals, *event);
        add(graph, &mut list, Watched::Event(k), &roots);
        if graph.symbols([*event]).iter().any(is_solved) {
            for &phase in &phases_of_solved {
                push(graph, &mut list, (Watched::Event(k), Role::Phase, phase), "");
            }
        }
    }
    for (k, switch) in switches.iter().enumerate() {
        let roots = with_signals(graph, signals, *switch);
        add(graph, &mut list, Watched::Switch(k), &roots);
    }
    add(graph, &mut list, Watched::Motion, motion);
    for (name, roots) in loads {
        for square in squares(graph, roots) {
            push(graph, &mut list, (Watched::Motion, Role::Distance, square), name);
        }
    }
    // Phases inside arguments that are followed themselves.
    for index in 0..list.all.len() {
        let (role, value) = (list.all[index].role, list.all[index].value);
        if role != Role::Phase {
            let roots = with_signals(graph, signals, value);
            for inner in phases(graph, &roots) {
                push(graph, &mut list, (Watched::Argument(index), Role::Phase, inner), "");
            }
        }
    }
    let gates = gates(graph, motion);
    for argument in list.all.iter_mut().filter(|argument| argument.of == Watched::Motion) {
        argument.gates = gates.get(&argument.value).into_iter().flatten().copied().collect();
    }
    list.all
}

/// The phases inside expressions.
fn phases(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    inside(graph, roots).into_iter().filter(|(role, _)| *role == Role::Phase).map(|(_, phase)| phase).collect()
}

/// What the equations of motion determine together.
fn is_solved(s: &Symbol) -> bool {
    matches!(s, Symbol::Acceleration(_) | Symbol::Multiplier(_) | Symbol::Reaction(_))
}

/// An expression, and the functions of time that stand for the inputs it reads.
fn with_signals(graph: &Graph, signals: &[[Id; 3]], value: Id) -> Vec<Id> {
    let mut roots = read_signals(graph, signals, std::iter::once(value));
    roots.push(value);
    roots
}

/// Arguments, each once.
#[derive(Default)]
struct List {
    /// Held values that are directions of sliding, by their places: where rates vanish beside these, contacts decide what follows.
    directions: Vec<u32>,
    all: Vec<Argument>,
    /// Those of a value, by their places.
    of: HashMap<Id, Vec<usize>>,
}

fn add(graph: &mut Graph, list: &mut List, of: Watched, roots: &[Id]) {
    for (role, value) in inside(graph, roots) {
        match (of, role) {
            // Error control sees the sines of the forces, and the discontinuities are switches.
            (Watched::Motion, Role::Phase | Role::Landmark) => {}
            (Watched::Motion, role) => {
                let table = match graph.node(value) {
                    Node::Unary(Unary::Table(table), _) if role == Role::Points => table.name(),
                    _ => "",
                };
                push(graph, list, (of, role, value), table);
            }
            (_, Role::Phase) => push(graph, list, (of, role, value), ""),
            (_, Role::Points) => points(graph, list, of, value),
            _ => push(graph, list, (of, Role::Landmark, value), ""),
        }
    }
}

/// The points of a table divide a step as half turns of a phase do; between the places where its own argument turns back they
/// are passed one after the other.
fn points(graph: &mut Graph, list: &mut List, of: Watched, counter: Id) {
    let pi = graph.constant(Number::Float(DoubleDouble::PI));
    let phase = graph.mul(pi, counter);
    push(graph, list, (of, Role::Phase, phase), "");
    if let Node::Unary(Unary::Table(_), x) = graph.node(counter) {
        push(graph, list, (of, Role::Landmark, x), "");
    }
}

/// Squares of distances: arguments of roots that contain coordinates and no speeds.
fn squares(graph: &Graph, roots: &[Id]) -> Vec<Id> {
    let needed = graph.needed(roots.iter().copied());
    let root = |id: Id| match graph.node(id) {
        Node::Unary(Unary::Sqrt, x) => Some(x),
        _ => None,
    };
    let of_place = |x: &Id| {
        let symbols = graph.symbols([*x]);
        symbols.iter().any(|s| matches!(s, Symbol::Coordinate(_)))
            && !symbols.iter().any(|s| matches!(s, Symbol::Speed(_) | Symbol::Acceleration(_) | Symbol::Dummy(_)))
    };
    needed.into_iter().filter_map(root).filter(of_place).collect()
}

fn push(graph: &mut Graph, list: &mut List, (of, role, value): (Watched, Role, Id), load: &str) {
    let rate = rates(graph, &[value])[0];
    let symbols = graph.symbols([value, rate]);
    // Rates of accelerations, and inputs beyond their second derivative, are not known.
    let unknown = |s: &Symbol| matches!(s, Symbol::Input(_, 3..) | Symbol::Reaction(_) | Symbol::Multiplier(_));
    let has_acceleration = graph.symbols([value]).iter().any(|s| matches!(s, Symbol::Acceleration(_)));
    let of_direction = |s: &Symbol| matches!(s, Symbol::Memory(place) if list.directions.contains(place));
    if has_acceleration || symbols.iter().any(unknown) || symbols.iter().any(of_direction) {
        return;
    }
    let of_time = |s: &Symbol| matches!(s, Symbol::Time | Symbol::Parameter(_));
    let time_only = symbols.iter().all(of_time);
    let argument = Argument { of, role, value, rate, time_only, load: load.to_owned(), gates: Vec::new() };
    let known = list.of.entry(value).or_default();
    if !known.iter().any(|place| list.all[*place] == argument) {
        known.push(list.all.len());
        list.all.push(argument);
    }
}

/// Arguments of functions that are local, or turn, inside expressions.
fn inside(graph: &mut Graph, roots: &[Id]) -> Vec<(Role, Id)> {
    let needed = graph.needed(roots.iter().copied());
    let mut moving: HashSet<Id> = HashSet::default();
    for &id in &needed {
        let moves = match graph.node(id) {
            Node::Symbol(s) => !matches!(
                s,
                Symbol::Parameter(_) | Symbol::Memory(_) | Symbol::Dummy(_) | Symbol::Mode(_) | Symbol::Phase(_)
            ),
            _ => graph.children(id).any(|child| moving.contains(&child)),
        };
        if moves {
            moving.insert(id);
        }
    }
    let mut found: Vec<(Role, Id)> = Vec::new();
    let mut bases = BTreeSet::new();
    for id in needed {
        let mut note = |role, argument: Id| {
            if moving.contains(&argument) {
                found.push((role, argument));
            }
        };
        match graph.node(id) {
            Node::Unary(Unary::Sin | Unary::Cos | Unary::Tan, x) => note(Role::Phase, x),
            Node::Unary(Unary::Exp, x) => note(Role::Exponential, x),
            Node::Unary(Unary::Tanh | Unary::Sinh | Unary::Cosh, x) => note(Role::Bounded, x),
            Node::Unary(Unary::Atan, x) => note(Role::Arctangent, x),
            Node::Unary(Unary::Abs | Unary::Sign | Unary::Step, x) => note(Role::Landmark, x),
            Node::Unary(Unary::Table(table), x) if moving.contains(&x) && !table.is_counter() => {
                found.push((Role::Points, graph.unary(Unary::Table(table.counter()), x)));
            }
            Node::Binary(Binary::Table(table), x, y) => {
                for (k, x) in [x, y].into_iter().enumerate().filter(|(_, x)| moving.contains(x)) {
                    found.push((Role::Points, graph.unary(Unary::Table(table.along(k).counter()), x)));
                }
            }
            Node::Unary(Unary::Sqrt, x) => factors(graph, x, 0.5, &mut bases),
            Node::Unary(Unary::Ln, x) => factors(graph, x, 1.0, &mut bases),
            Node::Binary(Binary::Div, _, x) => factors(graph, x, -1.0, &mut bases),
            Node::Binary(Binary::Pow, x, y) => {
                let power = graph.number(y).map_or(-1.0, |y| y.to_f64());
                factors(graph, x, power, &mut bases);
            }
            Node::Binary(Binary::Atan2, y, x) => {
                note(Role::Arctangent, y);
                note(Role::Arctangent, x);
            }
            Node::Binary(Binary::Min | Binary::Max, x, y) => {
                let difference = graph.sub(x, y);
                if moving.contains(&x) || moving.contains(&y) {
                    found.push((Role::Landmark, difference));
                }
            }
            _ => {}
        }
    }
    // One entry for all powers of a base: 1/r³ is a power of r², and so is r.
    let mut strongest: Vec<(Id, f64)> = Vec::new();
    for (base, power) in bases {
        let power = f64::from(power) / 2.0;
        if !moving.contains(&base) {
            continue;
        }
        match strongest.last_mut().filter(|(known, _)| *known == base) {
            Some((_, known)) => *known = if known.abs() < power.abs() || power < 0.0 { power } else { *known },
            None => strongest.push((base, power)),
        }
    }
    found.extend(strongest.into_iter().map(|(base, power)| (Role::Power(power), base)));
    found
}

/// The bases of which an expression is a product of powers, with twice their powers (halves are what matters).
fn factors(graph: &Graph, root: Id, power: f64, bases: &mut BTreeSet<(Id, i32)>) {
    let mut stack = vec![(root, power)];
    while let Some((id, power)) = stack.pop() {
        match graph.node(id) {
            Node::Number(_) => {}
            // A power of |x| is that of a one-sided base: the discontinuity is a switch.
            Node::Unary(Unary::Abs, _) if power > 0.0 => {}
            Node::Unary(Unary::Neg | Unary::Abs, x) => stack.push((x, power)),
            Node::Unary(Unary::Sqrt, x) => stack.push((x, 0.5 * power)),
            Node::Binary(Binary::Mul, x, y) => stack.extend([(x, power), (y, power)]),
            Node::Binary(Binary::Div, x, y) => stack.extend([(x, power), (y, -power)]),
            // Exponentials and sines have arguments of their own.
            Node::Unary(Unary::Exp | Unary::Cosh, _) | Node::Symbol(Symbol::Mode(_)) => {}
            _ => {
                let halves = (2.0 * power).clamp(-1e3, 1e3);
                let halves = if halves.abs() < 1.0 { halves.signum() } else { halves.round() };
                bases.insert((id, halves as i32));
            }
        }
    }
}
