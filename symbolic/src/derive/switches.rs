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
    /// True when the argument depends on time, inputs and parameters alone.
    pub time_only: bool,
    /// True when it belongs to inputs: it stands in the function of one, or its argument contains one.
    pub of_input: bool,
}

/// Which values a mode takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchKind {
    /// −1, 0, 1.
    Sign,
    /// 0, 1.
    Step,
}

/// Puts modes in the place of discontinuities; the last `signals` of the roots are inputs' functions of time.
pub(crate) fn introduce(graph: &mut Graph, roots: &[Id], signals: usize) -> (Vec<Id>, Vec<Switch>) {
    let mut switches: Vec<Switch> = Vec::new();
    let images = rewrite(graph, roots, |graph, node| {
        if let Node::Unary(Unary::Sqrt, base) | Node::Binary(Binary::Pow, base, _) = node {
            return one_sided(graph, node, base, &switches);
        }
        let (function, argument) = match node {
            Node::Unary(f @ (Unary::Abs | Unary::Sign | Unary::Step), x) => (Some(f), x),
            // With 0 as one of the two, the mode multiplies the other.
            Node::Binary(Binary::Min, a, b) if a == Id::ZERO => (None, graph.sub(a, b)),
            Node::Binary(Binary::Max, a, b) if a == Id::ZERO => (None, graph.sub(b, a)),
            Node::Binary(Binary::Min, a, b) => (None, graph.sub(b, a)),
            Node::Binary(Binary::Max, a, b) => (None, graph.sub(a, b)),
            _ => return None,
        };
        if !graph.symbols([argument]).into_iter().any(moving) {
            return None;
        }
        Some(match (function, node) {
            (Some(Unary::Step), _) => mode(graph, &mut switches, SwitchKind::Step, argument),
            (Some(Unary::Sign), _) => mode(graph, &mut switches, SwitchKind::Sign, argument),
            (Some(_), _) => {
                let sign = mode(graph, &mut switches, SwitchKind::Sign, argument);
                graph.mul(sign, argument)
            }
            (None, Node::Binary(_, a, b)) => {
                let step = mode(graph, &mut switches, SwitchKind::Step, argument);
                let (chosen, other) = if a == Id::ZERO { (b, a) } else { (a, b) };
                let difference = graph.sub(chosen, other);
                let chosen = graph.mul(step, difference);
                graph.add(other, chosen)
            }
            _ => return None,
        })
    });
    let equations = images[..images.len() - signals].iter().copied();
    let arguments: Vec<Id> = switches.iter().map(|s| s.argument).collect();
    let mut read = graph.symbols(equations);
    for k in (0..switches.len()).rev() {
        if read.contains(&Symbol::Mode(k as u32)) {
            read.extend(graph.symbols([arguments[k]]));
        } else {
            switches[k].of_input = true;
        }
    }
    (images, switches)
}

/// What changes along a motion.
fn moving(symbol: Symbol) -> bool {
    !matches!(symbol, Symbol::Parameter(_) | Symbol::Dummy(_))
}

/// The mode of the switch of this kind with this argument, which is added where it is new.
fn mode(graph: &mut Graph, switches: &mut Vec<Switch>, kind: SwitchKind, argument: Id) -> Id {
    let known = switches.iter().position(|s| s.kind == kind && s.argument == argument);
    let k = known.unwrap_or_else(|| {
        let symbols = graph.symbols([argument]);
        let of_time = |s: &Symbol| match s {
            Symbol::Mode(k) => switches.get(*k as usize).is_some_and(|s| s.time_only),
            s => !moving(*s) || matches!(s, Symbol::Time | Symbol::Input(..)),
        };
        let of_input = |s: &Symbol| match s {
            Symbol::Mode(k) => switches.get(*k as usize).is_some_and(|s| s.of_input),
            s => matches!(s, Symbol::Input(..)),
        };
        let (time_only, of_input) = (symbols.iter().all(of_time), symbols.iter().any(of_input));
        switches.push(Switch { kind, argument, time_only, of_input });
        switches.len() - 1
    });
    graph.symbol(Symbol::Mode(k as u32))
}

/// Powers and roots of a base that its own mode cuts off: (e a c)ᵖ, where e is the mode that is 1 for a ≥ 0, becomes
/// e (|a| c)ᵖ, which is the same on the side in force and finite beyond the surface, where stages of a step may look.
/// So does (s a c)ᵖ with the sign s of a.
fn one_sided(graph: &mut Graph, node: Node, base: Id, switches: &[Switch]) -> Option<Id> {
    if !has_mode(graph, base) {
        return None;
    }
    let (mut modes, mut factors, mut stack) = (Vec::new(), Vec::new(), vec![base]);
    while let Some(factor) = stack.pop() {
        match graph.node(factor) {
            Node::Binary(Binary::Mul, a, b) => stack.extend([a, b]),
            Node::Binary(Binary::Div, a, b) if a != Id::ONE => {
                factors.push(graph.div(Id::ONE, b));
                stack.push(a);
            }
            Node::Unary(Unary::Neg, a) => {
                factors.push(graph.integer(-1));
                stack.push(a);
            }
            Node::Symbol(Symbol::Mode(k)) => modes.push(k as usize),
            _ => factors.push(factor),
        }
    }
    // The mode whose argument, or its opposite, is among the factors.
    let own = modes.iter().find_map(|k| {
        let argument = switches.get(*k)?.argument;
        let (inner, sign) = match graph.node(argument) {
            Node::Unary(Unary::Neg, inner) => (inner, -1),
            _ => (argument, 1),
        };
        Some((*k, factors.iter().position(|f| *f == inner)?, sign))
    });
    let (k, place, sign) = own?;
    let inner = factors.remove(place);
    let mut rest = graph.unary(Unary::Abs, inner);
    factors.push(graph.integer(sign));
    let mut force = graph.symbol(Symbol::Mode(k as u32));
    if switches[k].kind == SwitchKind::Sign {
        force = graph.mul(force, force);
    }
    for other in modes.into_iter().filter(|other| *other != k) {
        factors.push(graph.symbol(Symbol::Mode(other as u32)));
    }
    for factor in factors {
        rest = graph.mul(rest, factor);
    }
    let power = match node {
        Node::Binary(Binary::Pow, _, exponent) => graph.pow(rest, exponent),
        _ => graph.unary(Unary::Sqrt, rest),
    };
    Some(graph.mul(force, power))
}

/// True where a mode is a factor of an expression.
fn has_mode(graph: &Graph, root: Id) -> bool {
    let mut stack = vec![root];
    while let Some(factor) = stack.pop() {
        match graph.node(factor) {
            Node::Binary(Binary::Mul, a, b) => stack.extend([a, b]),
            Node::Binary(Binary::Div, a, _) | Node::Unary(Unary::Neg, a) => stack.push(a),
            Node::Symbol(Symbol::Mode(_)) => return true,
            _ => {}
        }
    }
    false
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
            Node::Unary(Unary::Sqrt, base) | Node::Binary(Binary::Pow, base, _) => return one_sided(graph, node, base, known),
            Node::Binary(Binary::Min, a, b) => (SwitchKind::Step, graph.sub(b, a)),
            Node::Binary(Binary::Max, a, b) => (SwitchKind::Step, graph.sub(a, b)),
            _ => return None,
        };
        let (k, forward) = find(graph, argument, known)?;
        let mode = graph.symbol(Symbol::Mode(k as u32));
        let value = value_of_mode(graph, mode, (known[k].kind, wanted), forward);
        Some(match node {
            Node::Unary(Unary::Abs, x) => graph.mul(value, x),
            Node::Binary(_, Id::ZERO, b) => {
                let other = graph.sub(Id::ONE, value);
                graph.mul(other, b)
            }
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
pub fn remove(graph: &mut Graph, roots: &[Id], switches: &[Switch]) -> Vec<Id> {
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
