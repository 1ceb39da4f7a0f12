//! Arguments of functions that change at a zero of theirs, or say something only where theirs is of order one.

use std::collections::{BTreeMap, BTreeSet};

use super::motion::Motion;
use super::state::State;
use crate::derive::branches;
use crate::expr::{Binary, Graph, Id, Node, Symbol, Table, Tape, Unary};
use crate::model::{Model, Rotation, Work, text_in};
use crate::number::DoubleDouble;

/// An argument, and what is looked for.
pub(super) struct Argument {
    /// In words.
    pub words: String,
    pub tape: Tape,
    /// True where the function changes at zero; false where it is local through its argument.
    pub switches: bool,
    /// Whether a function of it vanishes, or ceases to change, away from where it is of order one: `exp`, `tanh`.
    pub fades: bool,
    /// What it depends on; where it contains accelerations or reactions, what these depend on.
    pub symbols: Vec<Symbol>,
    /// Whether it contains accelerations or reactions.
    pub of_motion: bool,
}

impl Argument {
    /// Its value at a state.
    pub fn at(&self, motion: &Motion, state: &State) -> f64 {
        self.exactly(motion, state).to_f64()
    }

    /// The same in double-double.
    pub fn exactly(&self, motion: &Motion, state: &State) -> DoubleDouble {
        if !self.of_motion {
            return self.tape.evaluate(|s| state.value(s))[0];
        }
        let mut state = state.clone();
        match motion.complete(&mut state) {
            Ok(()) => self.tape.evaluate(|s| state.value(s))[0],
            Err(_) => DoubleDouble::from(f64::NAN),
        }
    }

    /// Operations of one evaluation.
    pub fn operations(&self, motion: &Motion) -> usize {
        self.tape.operations() + if self.of_motion { motion.work() } else { 0 }
    }
}

/// A table, and the argument of it.
pub(super) struct Points {
    pub table: Table,
    pub argument: Argument,
}

/// A power of so much says nothing where its base is small, and is all there is where it is large.
const HIGH_POWER: usize = 5;
/// Products of more factors are not looked at.
const FACTORS: usize = 200;
/// So many arguments are followed.
pub(super) const ARGUMENTS: usize = 48;

/// Arguments that move, of everything that the equations, the claims and the checks read, each once; and how many are
/// beyond those that are followed.
pub(super) fn arguments(model: &Model) -> (Vec<Argument>, usize) {
    let mut graph = model.graph.clone();
    let roots = roots(model);
    let needed = graph.reachable(roots);
    let moving = graph.contains(|s| !matches!(s, Symbol::Parameter(_) | Symbol::Dummy(_)));
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    for i in (0..needed.len()).filter(|&i| needed[i]) {
        let node = graph.node(graph.id_at(i));
        let (value, switches) = match node {
            Node::Unary(Unary::Abs | Unary::Sign | Unary::Step, x) => (x, true),
            Node::Binary(Binary::Min | Binary::Max, x, y) => (graph.sub(x, y), true),
            node => match (branches::argument(&mut graph, node), node) {
                (Some(x), _) => (x, true),
                (_, Node::Unary(f, x)) if is_local(f) => (x, false),
                (_, Node::Binary(Binary::Pow, x, _) | Node::Binary(Binary::Div, _, x)) => (x, false),
                (_, Node::Binary(Binary::Mul, ..)) => match high_power(&mut graph, node) {
                    Some(x) => (x, false),
                    None => continue,
                },
                _ => continue,
            },
        };
        let is_moving = |s: &Symbol| !matches!(s, Symbol::Parameter(_) | Symbol::Dummy(_));
        let moves = moving.get(value.index()).copied();
        let moves = moves.unwrap_or_else(|| graph.symbols([value]).iter().any(is_moving));
        let plain = matches!(graph.node(value), Node::Symbol(_)) && !switches;
        if moves && !plain && seen.insert((value, switches)) {
            found.push((value, switches));
        }
    }
    // Switches first: there are things that act only beyond them.
    found.sort_by_key(|(_, switches)| !switches);
    let more = found.len().saturating_sub(ARGUMENTS);
    let fading = |i: usize| match graph.node(graph.id_at(i)) {
        Node::Unary(Unary::Exp | Unary::Tanh, x) => Some(x),
        _ => None,
    };
    let fading: BTreeSet<Id> = (0..needed.len()).filter(|&i| needed[i]).filter_map(fading).collect();
    let argument = |(value, switches): (Id, bool)| {
        let fades = !switches && fading.contains(&value);
        Argument { fades, ..argument(&graph, model, value, switches) }
    };
    (found.into_iter().take(ARGUMENTS).map(argument).collect(), more)
}

/// x of a product c xᵏ … with a high power, by which c is of order one: c^(1/k) x, c being a number.
fn high_power(graph: &mut Graph, product: Node) -> Option<Id> {
    let Node::Binary(Binary::Mul, a, b) = product else { return None };
    let factor = match graph.node(a) {
        Node::Number(place) => graph.number_at(place).to_f64().abs(),
        _ => 1.0,
    };
    let mut open = if factor == 1.0 { vec![a, b] } else { vec![b] };
    let mut powers: BTreeMap<Id, usize> = BTreeMap::new();
    let mut seen = 0;
    while let Some(id) = open.pop() {
        seen += 1;
        match graph.node(id) {
            _ if seen > FACTORS => return None,
            Node::Binary(Binary::Mul, x, y) => open.extend([x, y]),
            _ => *powers.entry(id).or_default() += 1,
        }
    }
    let (base, power) = powers.into_iter().max_by_key(|(_, power)| *power).filter(|(_, power)| *power >= HIGH_POWER)?;
    let scale = graph.float(factor.powf(1.0 / power as f64));
    Some(graph.mul(scale, base))
}

/// The tables that move, in everything that is judged, each of each argument once.
pub(super) fn tables(model: &Model) -> Vec<Points> {
    let graph = &model.graph;
    let needed = graph.reachable(roots(model));
    let moving = graph.contains(|s| !matches!(s, Symbol::Parameter(_) | Symbol::Dummy(_)));
    let mut found: BTreeSet<(Id, Table)> = BTreeSet::new();
    for i in (0..needed.len()).filter(|i| needed[*i]) {
        match graph.node(graph.id_at(i)) {
            Node::Unary(Unary::Table(table), x) => found.extend([(x, table.whole())]),
            Node::Binary(Binary::Table(table), x, y) => found.extend([(x, table.along(0)), (y, table.along(1))]),
            _ => {}
        }
    }
    found.retain(|(x, _)| moving[x.index()]);
    let points = |(x, table)| Points { table, argument: argument(graph, model, x, false) };
    found.into_iter().take(ARGUMENTS).map(points).collect()
}

/// One argument.
pub(super) fn argument(graph: &Graph, model: &Model, value: Id, switches: bool) -> Argument {
    let symbols = graph.symbols([value]);
    let of_motion = symbols.iter().any(|s| matches!(s, Symbol::Acceleration(_) | Symbol::Multiplier(_)));
    let own = |s: &Symbol| matches!(s, Symbol::Time | Symbol::Input(..) | Symbol::Coordinate(_) | Symbol::Speed(_));
    let mut symbols: Vec<Symbol> = symbols.into_iter().filter(own).collect();
    if of_motion {
        let all = (0..model.coordinates.len() as u32).flat_map(|i| [Symbol::Coordinate(i), Symbol::Speed(i)]);
        let more: Vec<Symbol> = all.filter(|s| !symbols.contains(s)).collect();
        symbols.extend(more);
    }
    let (words, tape) = (text_in(graph, model, value), Tape::new(graph, &[value]));
    Argument { words, tape, switches, fades: false, symbols, of_motion }
}

/// Functions that say something where their argument is of order one.
fn is_local(function: Unary) -> bool {
    use Unary::{Atan, Cosh, Exp, Ln, Sinh, Sqrt, Tanh};
    matches!(function, Exp | Tanh | Atan | Sinh | Cosh | Sqrt | Ln)
}

/// All expressions that are judged.
pub(super) fn roots(model: &Model) -> Vec<Id> {
    let mut roots = vec![model.raw_potential_energy, model.raw_kinetic_energy, model.dissipation];
    roots.extend(model.inputs.iter().flat_map(|input| input.signal));
    roots.extend(
        model
            .bodies
            .iter()
            .flat_map(|b| b.position.iter().copied().chain(b.rotation.iter().flat_map(Rotation::attitude))),
    );
    roots.extend(model.generalized_forces.iter().map(|f| f.force));
    for load in &model.loads {
        match load.work {
            Work::Potential(v) => roots.push(v),
            Work::Resistance { rate, tension } => roots.extend([rate, tension]),
            Work::Pushes => {}
        }
        roots.extend(load.pushes.iter().flat_map(|p| p.at.iter().chain(&p.force).chain(&p.couple)).copied());
    }
    roots.extend(model.gravity.iter().flatten());
    roots.extend(model.constraints.iter().flat_map(|c| c.value.iter().copied()));
    let parts = model.balances.iter().flat_map(|system| &system.balances).flat_map(|balance| &balance.parts);
    roots.extend(parts.flat_map(|part| part.value.iter().copied()));
    roots.extend(model.conserved.iter().flat_map(|c| c.value.iter().copied()));
    roots.extend(model.checks.iter().flat_map(|c| c.left.iter().chain(&c.right)).copied());
    roots
}
