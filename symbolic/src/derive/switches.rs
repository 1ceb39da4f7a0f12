//! Discontinuities of the equations of motion as modes.
//!
//! `sign`, `abs`, `step`, `min` and `max` of what changes along a motion become constants for the time
//! between two crossings: sign(x) = s, |x| = s x, step(x) = e, min(a, b) = b + e (a − b) with e = step(b − a).
//! The equations that are integrated are then smooth, and the runtime locates the crossings.

use crate::expr::{Binary, Graph, Id, Node, Rational, Symbol, Unary, canonical, rewrite};

/// One discontinuity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Switch {
    /// Which values its mode takes.
    pub kind: SwitchKind,
    /// It switches where this vanishes (contains modes of earlier switches, if nested).
    pub argument: Id,
    /// True when the argument depends on time and parameters alone.
    pub time_only: bool,
}

/// Which values a mode takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchKind {
    /// −1, 0, 1.
    Sign,
    /// 0, 1.
    Step,
}

/// Puts modes in the place of discontinuities.
pub(crate) fn introduce(graph: &mut Graph, roots: &[Id]) -> (Vec<Id>, Vec<Switch>) {
    let moving = |s: Symbol| !matches!(s, Symbol::Parameter(_) | Symbol::Dummy(_));
    let stateful = |s: Symbol| moving(s) && s != Symbol::Time;
    let mut switches: Vec<Switch> = Vec::new();
    let mut mode = |graph: &mut Graph, kind: SwitchKind, argument: Id| {
        let k = switches.iter().position(|s| s.kind == kind && s.argument == argument).unwrap_or_else(|| {
            let time_only = graph.symbols([argument]).into_iter().all(|s| !stateful(s));
            switches.push(Switch { kind, argument, time_only });
            switches.len() - 1
        });
        graph.symbol(Symbol::Mode(k as u32))
    };
    let roots = rewrite(graph, roots, |graph, node| {
        let (function, argument) = match node {
            Node::Unary(f @ (Unary::Abs | Unary::Sign | Unary::Step), x) => (Some(f), x),
            Node::Binary(Binary::Min, a, b) => (None, graph.sub(b, a)),
            Node::Binary(Binary::Max, a, b) => (None, graph.sub(a, b)),
            _ => return None,
        };
        if !graph.symbols([argument]).into_iter().any(moving) {
            return None;
        }
        Some(match (function, node) {
            (Some(Unary::Step), _) => mode(graph, SwitchKind::Step, argument),
            (Some(Unary::Sign), _) => mode(graph, SwitchKind::Sign, argument),
            (Some(_), _) => {
                let sign = mode(graph, SwitchKind::Sign, argument);
                graph.mul(sign, argument)
            }
            (None, Node::Binary(_, a, b)) => {
                let step = mode(graph, SwitchKind::Step, argument);
                let difference = graph.sub(a, b);
                let chosen = graph.mul(step, difference);
                graph.add(b, chosen)
            }
            _ => return None,
        })
    });
    (roots, switches)
}

/// Puts the modes of known switches in the place of discontinuities; what is no known switch stays as it is.
///
/// Arguments are compared in canonical form and up to sign, since a derivation may write sums in another order, or
/// the derivative of |x| where another has |x|.
pub(crate) fn recall(graph: &mut Graph, roots: &[Id], known: &[Switch]) -> Vec<Id> {
    if known.is_empty() {
        return roots.to_vec();
    }
    rewrite(graph, roots, |graph, node| {
        let (wanted, argument) = match node {
            Node::Unary(Unary::Abs | Unary::Sign, x) => (SwitchKind::Sign, x),
            Node::Unary(Unary::Step, x) => (SwitchKind::Step, x),
            Node::Binary(Binary::Min, a, b) => (SwitchKind::Step, graph.sub(b, a)),
            Node::Binary(Binary::Max, a, b) => (SwitchKind::Step, graph.sub(a, b)),
            _ => return None,
        };
        let (k, forward) = find(graph, argument, known)?;
        let mode = graph.symbol(Symbol::Mode(k as u32));
        let value = value_of_mode(graph, mode, (known[k].kind, wanted), forward);
        Some(match node {
            Node::Unary(Unary::Abs, x) => graph.mul(value, x),
            Node::Binary(_, a, b) => {
                let difference = graph.sub(a, b);
                let chosen = graph.mul(value, difference);
                graph.add(b, chosen)
            }
            _ => value,
        })
    })
}

/// The switch whose argument is this one (true) or its opposite (false).
fn find(graph: &mut Graph, argument: Id, known: &[Switch]) -> Option<(usize, bool)> {
    let opposite = graph.neg(argument);
    known.iter().enumerate().find_map(|(k, switch)| {
        let forms = canonical(graph, &[argument, opposite, switch.argument]);
        (forms[0] == forms[2]).then_some((k, true)).or((forms[1] == forms[2]).then_some((k, false)))
    })
}

/// The sign or the step of a switch's argument, or of its opposite, from the switch's mode.
fn value_of_mode(graph: &mut Graph, mode: Id, (has, wanted): (SwitchKind, SwitchKind), forward: bool) -> Id {
    let half = Rational::new(1, 2).map_or(Id::ONE, |half| graph.rational(half));
    // As a sign in −1 … 1 of the argument that is asked for.
    let sign = match has {
        SwitchKind::Sign => mode,
        SwitchKind::Step => {
            let difference = graph.sub(mode, half);
            graph.div(difference, half)
        }
    };
    let sign = if forward { sign } else { graph.neg(sign) };
    match (has, wanted, forward) {
        (SwitchKind::Step, SwitchKind::Step, true) => mode,
        (SwitchKind::Step, SwitchKind::Step, false) => graph.sub(Id::ONE, mode),
        (_, SwitchKind::Sign, _) => sign,
        (SwitchKind::Sign, SwitchKind::Step, _) => {
            let sum = graph.add(Id::ONE, sign);
            graph.mul(half, sum)
        }
    }
}

/// Puts the true functions back, for what only observes.
pub(crate) fn remove(graph: &mut Graph, roots: &[Id], switches: &[Switch]) -> Vec<Id> {
    // A mode's argument contains earlier modes only, so one sweep over the list replaces all.
    let mut values: rustc_hash::FxHashMap<Symbol, Id> = rustc_hash::FxHashMap::default();
    for (k, switch) in switches.iter().enumerate() {
        let argument = crate::expr::substitute(graph, &[switch.argument], &values)[0];
        let function = if switch.kind == SwitchKind::Sign { Unary::Sign } else { Unary::Step };
        let value = graph.unary(function, argument);
        values.insert(Symbol::Mode(k as u32), value);
    }
    crate::expr::substitute(graph, roots, &values)
}
