//! Discontinuities of the equations of motion as modes.
//!
//! `sign`, `abs`, `step`, `min` and `max` of what changes along a motion become constants for the time
//! between two crossings: sign(x) = s, |x| = s x, step(x) = e, min(a, b) = b + e (a − b) with e = step(b − a).
//! The equations that are integrated are then smooth, and the runtime locates the crossings.

use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary, rewrite};

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
pub(super) fn introduce(graph: &mut Graph, roots: &[Id]) -> (Vec<Id>, Vec<Switch>) {
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

/// Puts the true functions back, for what only observes.
pub(super) fn remove(graph: &mut Graph, roots: &[Id], switches: &[Switch]) -> Vec<Id> {
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
