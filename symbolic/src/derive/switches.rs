//! Discontinuities of the equations of motion as modes.
//!
//! `sign`, `abs`, `step`, `min` and `max` of what changes along a motion become constants for the time
//! between two crossings: sign(x) = s, |x| = s x, step(x) = e, min(a, b) = b + e (a − b) with e = step(b − a).
//! The equations that are integrated are then smooth, and the runtime locates the crossings.  Other functions that jump
//! are found in `branches`.

use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};

use super::branches;
use crate::expr::{
    Binary, DoubleDouble, Graph, Id, Node, Number, Rational, Symbol, Table, Unary, canonical_sums, rewrite,
};

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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SwitchKind {
    /// −1, 0, 1.
    Sign,
    /// 0, 1.
    Step,
}

/// More discontinuities than this cannot be located in reasonable time.
pub(crate) const SWITCH_LIMIT: usize = 1000;

/// Puts modes in the place of discontinuities; the last `signals` of the roots are inputs' functions of time.
///
/// One switch beyond [`SWITCH_LIMIT`] it stops looking.
pub(crate) fn introduce(graph: &mut Graph, roots: &[Id], signals: usize) -> (Vec<Id>, Vec<Switch>) {
    let of_memory = |root: &Id| graph.symbols([*root]).iter().any(|s| matches!(s, Symbol::Memory(_)));
    let held_inputs = roots[roots.len() - signals..].iter().map(of_memory).collect();
    let mut found = Found { held_inputs, ..Found::default() };
    let mut put_in = |graph: &mut Graph, node: Node| {
        if let Node::Unary(Unary::Sqrt, base) | Node::Binary(Binary::Pow, base, _) = node {
            return one_sided(graph, node, base, &found.switches);
        }
        if found.tables(graph, node) {
            return None;
        }
        if let Some(argument) = branches::argument(graph, node) {
            if found.switches.len() > SWITCH_LIMIT || !found.contents(graph, argument).moves {
                return None;
            }
            let mode = found.mode(graph, SwitchKind::Step, argument);
            let side = value_of_mode(graph, mode, (SwitchKind::Step, SwitchKind::Sign), true);
            return branches::continued(graph, node, side);
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
        if found.switches.len() > SWITCH_LIMIT || !found.contents(graph, argument).moves {
            return None;
        }
        Some(match (function, node) {
            (Some(Unary::Step), _) => found.mode(graph, SwitchKind::Step, argument),
            (Some(Unary::Sign), _) => found.mode(graph, SwitchKind::Sign, argument),
            (Some(_), _) => {
                let sign = found.mode(graph, SwitchKind::Sign, argument);
                graph.mul(sign, argument)
            }
            (None, Node::Binary(_, a, b)) => {
                let step = found.mode(graph, SwitchKind::Step, argument);
                let (chosen, other) = if a == Id::ZERO { (b, a) } else { (a, b) };
                let difference = graph.sub(chosen, other);
                let chosen = graph.mul(step, difference);
                graph.add(other, chosen)
            }
            _ => return None,
        })
    };
    // Arguments contain inputs, which contain the modes of their own functions: no argument contains modes of later switches.
    let (others, signals) = roots.split_at(roots.len() - signals);
    let signals = rewrite(graph, signals, &mut put_in);
    let mut images = rewrite(graph, others, &mut put_in);
    let mut switches = found.switches;
    let read = read_modes(graph, &images, &switches);
    for (switch, read) in switches.iter_mut().zip(read) {
        switch.of_input |= !read;
    }
    images.extend(signals);
    (images, switches)
}

/// The switches whose modes some roots read, by themselves or inside the arguments of such.
fn read_modes(graph: &Graph, roots: &[Id], switches: &[Switch]) -> Vec<bool> {
    let mut read = vec![false; switches.len()];
    let mut seen: HashSet<Id> = HashSet::default();
    let mut stack = roots.to_vec();
    while let Some(id) = stack.pop() {
        if !seen.insert(id) {
            continue;
        }
        if let Node::Symbol(Symbol::Mode(k)) = graph.node(id) {
            read[k as usize] = true;
            stack.push(switches[k as usize].argument);
        }
        stack.extend(graph.children(id));
    }
    read
}

/// The first of some groups of roots with which the discontinuities of what moves are more than the limit.
pub(crate) fn beyond_limit(graph: &Graph, groups: impl IntoIterator<Item = Vec<Id>>) -> Option<usize> {
    let mut seen: HashSet<Id> = HashSet::default();
    let (mut found, mut count) = (Found::default(), 0);
    groups.into_iter().position(|mut stack| {
        while let Some(id) = stack.pop() {
            if !seen.insert(id) {
                continue;
            }
            let switches = matches!(
                graph.node(id),
                Node::Unary(Unary::Abs | Unary::Sign | Unary::Step, _) | Node::Binary(Binary::Min | Binary::Max, ..)
            );
            count += usize::from(switches && found.contents(graph, id).moves);
            stack.extend(graph.children(id));
        }
        count > SWITCH_LIMIT
    })
}

/// What is in an expression.
#[derive(Clone, Copy)]
struct Contents {
    /// Something that changes along a motion.
    moves: bool,
    /// Nothing that changes but time and inputs.
    time_only: bool,
    /// An input.
    of_input: bool,
}

impl Contents {
    fn with(self, other: Contents) -> Contents {
        Contents {
            moves: self.moves || other.moves,
            time_only: self.time_only && other.time_only,
            of_input: self.of_input || other.of_input,
        }
    }
}

/// Switches found so far, and what is in the nodes that were asked about.
#[derive(Default)]
struct Found {
    switches: Vec<Switch>,
    places: HashMap<(SwitchKind, Id), usize>,
    contents: HashMap<Id, Contents>,
    /// Which inputs contain held values.
    held_inputs: Vec<bool>,
}

impl Found {
    /// The mode of the switch of this kind with this argument, which is added where it is new.
    fn mode(&mut self, graph: &mut Graph, kind: SwitchKind, argument: Id) -> Id {
        let k = self.places.get(&(kind, argument)).copied().unwrap_or_else(|| {
            let Contents { time_only, of_input, .. } = self.contents(graph, argument);
            self.switches.push(Switch { kind, argument, time_only, of_input });
            self.places.insert((kind, argument), self.switches.len() - 1);
            self.switches.len() - 1
        });
        graph.symbol(Symbol::Mode(k as u32))
    }

    /// Whether a node is a table; the switches at its points are added, along each argument.
    fn tables(&mut self, graph: &mut Graph, node: Node) -> bool {
        match node {
            Node::Unary(Unary::Table(table), x) => self.points(graph, table, x),
            Node::Binary(Binary::Table(table), x, y) => {
                self.points(graph, table.along(0), x);
                self.points(graph, table.along(1), y);
            }
            _ => return false,
        }
        true
    }

    /// The switch at the points of a table, where a derivative jumps; no equation reads its mode.
    fn points(&mut self, graph: &mut Graph, table: Table, x: Id) {
        if self.switches.len() <= SWITCH_LIMIT && self.contents(graph, x).moves {
            let counter = graph.unary(Unary::Table(table.counter()), x);
            let pi = graph.constant(Number::Float(DoubleDouble::PI));
            let phase = graph.mul(pi, counter);
            let sine = graph.unary(Unary::Sin, phase);
            self.mode(graph, SwitchKind::Sign, sine);
        }
    }

    /// What is in an expression; of every node once.
    fn contents(&mut self, graph: &Graph, root: Id) -> Contents {
        let mut stack = vec![root];
        while let Some(&top) = stack.last() {
            let before = stack.len();
            if !self.contents.contains_key(&top) {
                stack.extend(graph.children(top).filter(|c| !self.contents.contains_key(c)));
            }
            if stack.len() > before {
                continue;
            }
            stack.pop();
            let contents = match graph.node(top) {
                Node::Symbol(s) => self.of_symbol(s),
                _ => {
                    let nothing = Contents { moves: false, time_only: true, of_input: false };
                    graph.children(top).fold(nothing, |all, child| all.with(self.contents[&child]))
                }
            };
            self.contents.insert(top, contents);
        }
        self.contents[&root]
    }

    fn of_symbol(&self, symbol: Symbol) -> Contents {
        match symbol {
            Symbol::Parameter(_) | Symbol::Dummy(_) => Contents { moves: false, time_only: true, of_input: false },
            // Events alone change it: between them it stands still, and what stops a step is not known beforehand.
            Symbol::Memory(_) => Contents { moves: false, time_only: false, of_input: false },
            Symbol::Input(k, _) if self.held_inputs.get(k as usize) == Some(&true) => {
                Contents { moves: true, time_only: false, of_input: true }
            }
            Symbol::Time => Contents { moves: true, time_only: true, of_input: false },
            Symbol::Input(..) => Contents { moves: true, time_only: true, of_input: true },
            Symbol::Mode(k) => {
                let of = |f: fn(&Switch) -> bool| self.switches.get(k as usize).is_some_and(f);
                Contents { moves: true, time_only: of(|s| s.time_only), of_input: of(|s| s.of_input) }
            }
            _ => Contents { moves: true, time_only: false, of_input: false },
        }
    }
}

/// Powers and roots of a base that its own mode cuts off: (e a c)ᵖ, where e is the mode that is 1 for a ≥ 0, becomes
/// e (|a| c)ᵖ, which is the same on the side in force and finite beyond the surface, where stages of a step may look.
/// So does (s a c)ᵖ with the sign s of a.
fn one_sided(graph: &mut Graph, node: Node, base: Id, switches: &[Switch]) -> Option<Id> {
    if !has_mode(graph, base) {
        return None;
    }
    let Parts { modes, factors, negative } = Parts::of(graph, base);
    // The mode all of whose argument, but for its sign, is among the factors.
    let own = modes.iter().find_map(|k| {
        let argument = Parts::of(graph, switches.get(*k)?.argument);
        let mut left = factors.clone();
        for factor in &argument.factors {
            left.remove(left.iter().position(|f| f == factor)?);
        }
        (argument.modes.is_empty() && !argument.factors.is_empty()).then_some((*k, argument, left))
    });
    let (k, argument, mut factors) = own?;
    let inner = argument.factors.into_iter().reduce(|product, factor| graph.mul(product, factor))?;
    let mut rest = graph.unary(Unary::Abs, inner);
    factors.push(graph.integer(if negative == argument.negative { 1 } else { -1 }));
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

/// The factors of a product: modes, and all others, without signs.
struct Parts {
    modes: Vec<usize>,
    factors: Vec<Id>,
    negative: bool,
}

impl Parts {
    fn of(graph: &mut Graph, root: Id) -> Parts {
        let mut parts = Parts { modes: Vec::new(), factors: Vec::new(), negative: false };
        let mut stack = vec![root];
        while let Some(factor) = stack.pop() {
            match graph.node(factor) {
                Node::Binary(Binary::Mul, a, b) => stack.extend([a, b]),
                Node::Binary(Binary::Div, a, b) if a != Id::ONE => {
                    parts.factors.push(graph.div(Id::ONE, b));
                    stack.push(a);
                }
                Node::Unary(Unary::Neg, a) => {
                    parts.negative = !parts.negative;
                    stack.push(a);
                }
                Node::Symbol(Symbol::Mode(k)) => parts.modes.push(k as usize),
                _ => parts.factors.push(factor),
            }
        }
        parts
    }
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
    let mut forms = Forms::of(graph, known);
    rewrite(graph, roots, |graph, node| {
        if let Some(argument) = branches::argument(graph, node) {
            let (k, forward) = forms.find(graph, argument)?;
            let mode = graph.symbol(Symbol::Mode(k as u32));
            let side = value_of_mode(graph, mode, (known[k].kind, SwitchKind::Sign), forward);
            return branches::continued(graph, node, side);
        }
        let (wanted, argument) = match node {
            Node::Unary(Unary::Abs | Unary::Sign, x) => (SwitchKind::Sign, x),
            Node::Unary(Unary::Step, x) => (SwitchKind::Step, x),
            Node::Unary(Unary::Sqrt, base) | Node::Binary(Binary::Pow, base, _) => {
                return one_sided(graph, node, base, known);
            }
            Node::Binary(Binary::Min, a, b) => (SwitchKind::Step, graph.sub(b, a)),
            Node::Binary(Binary::Max, a, b) => (SwitchKind::Step, graph.sub(a, b)),
            _ => return None,
        };
        let (k, forward) = forms.find(graph, argument)?;
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

/// The arguments of switches in canonical form.
struct Forms {
    /// The switch of a form, and whether its argument is that (true) or its opposite (false).
    known: HashMap<Id, (usize, bool)>,
    /// What was found for an argument.
    found: HashMap<Id, Option<(usize, bool)>>,
}

impl Forms {
    fn of(graph: &mut Graph, switches: &[Switch]) -> Forms {
        let mut known = HashMap::default();
        for (k, switch) in switches.iter().enumerate() {
            let [form, opposite] = forms(graph, switch.argument);
            known.entry(form).or_insert((k, true));
            known.entry(opposite).or_insert((k, false));
        }
        Forms { known, found: HashMap::default() }
    }

    /// The switch whose argument is this one (true) or its opposite (false).
    fn find(&mut self, graph: &mut Graph, argument: Id) -> Option<(usize, bool)> {
        let known = &self.known;
        *self.found.entry(argument).or_insert_with(|| known.get(&forms(graph, argument)[0]).copied())
    }
}

/// An expression and its opposite in canonical form; both together, so that the form of either does not depend on which
/// of them was given.
fn forms(graph: &mut Graph, argument: Id) -> [Id; 2] {
    let opposite = graph.neg(argument);
    let forms = canonical_sums(graph, &[argument, opposite]);
    [forms[0], forms[1]]
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
    let mut values: HashMap<Symbol, Id> = HashMap::default();
    for (k, switch) in switches.iter().enumerate() {
        let argument = crate::expr::substitute(graph, &[switch.argument], &values)[0];
        let function = if switch.kind == SwitchKind::Sign { Unary::Sign } else { Unary::Step };
        let value = graph.unary(function, argument);
        values.insert(Symbol::Mode(k as u32), value);
    }
    crate::expr::substitute(graph, roots, &values)
}
