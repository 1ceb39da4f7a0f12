//! Reactions as expressions of the state and the accelerations.

use rustc_hash::FxHashMap as HashMap;

use super::momentum::{in_phase, unknowns};
use crate::expr::{Angles, Binary, Graph, Id, Node, Symbol, Tape, Unary, expand, jacobian};
use crate::model::{BalanceSystem, Model};

/// What lengths count as where they vanish, beside their defaults: the square is still far above the smallest `f64`.
const TINY: f64 = 1e-15;

/// Puts reactions, by name, into what observes: outputs, events and checks.  Tells which components of outputs,
/// by place, were a component of a reaction as it stands.
pub(crate) fn put_in(model: &mut Model) -> Vec<(usize, Symbol)> {
    let components = model.outputs.iter().flat_map(|output| &output.value).enumerate();
    let named = components.filter_map(|(place, id)| match model.graph.node(*id) {
        Node::Symbol(reaction @ Symbol::Reaction(_)) => Some((place, reaction)),
        _ => None,
    });
    let named = named.collect();
    let known = reactions(model);
    if known.is_empty() {
        return named;
    }
    let (graph, count) = (&mut model.graph, model.phases.len());
    for output in &mut model.outputs {
        let symbols = graph.symbols(output.value.iter().copied());
        output.of_reactions = symbols.iter().any(|s| matches!(s, Symbol::Reaction(_)));
    }
    let mut values = |absent: bool| -> HashMap<Symbol, Id> {
        known.iter().map(|(symbol, named)| (*symbol, named.value(graph, count, absent))).collect()
    };
    let (reported, known) = (values(true), values(false));
    let mut put = |list: &mut [Id], known: &HashMap<Symbol, Id>| {
        let new = crate::expr::substitute(graph, list, known);
        list.copy_from_slice(&new);
    };
    // What is infinite is reported as absent.
    model.outputs.iter_mut().for_each(|output| put(&mut output.value, &reported));
    let mut put = |list: &mut [Id]| put(list, &known);
    for event in &mut model.events {
        put(std::slice::from_mut(&mut event.when));
        if let Some(condition) = &mut event.condition {
            put(std::slice::from_mut(condition));
        }
    }
    for check in &mut model.checks {
        put(&mut check.left);
        put(&mut check.right);
    }
    named
}

/// Each reaction component as an expression of the state and the accelerations: in every phase the least-squares solution
/// of the first system of that phase that names it, which is exact since the system agrees with the motion.
fn reactions(model: &mut Model) -> HashMap<Symbol, Named> {
    let mut known: HashMap<Symbol, Named> = HashMap::default();
    let wanted = wanted(model);
    for system in model.balances.clone() {
        let unknowns: Vec<Symbol> = unknowns(model, &system)[model.coordinates.len()..].to_vec();
        let new = |named: Option<&Named>, phase: &usize| named.is_none_or(|named| !named.phases.contains(phase));
        let asked = |s: &Symbol| wanted.contains(s) && system.phases.iter().any(|phase| new(known.get(s), phase));
        if !unknowns.iter().any(asked) {
            continue;
        }
        let mut values = least_squares(model, &system, &unknowns);
        if let [phase] = system.phases.as_slice() {
            values = in_phase(&mut model.graph, model.phases.len(), *phase, &values);
        }
        // A multiplier has a value of its own, in every phase.
        let reactions = unknowns.iter().zip(values).filter(|(symbol, _)| matches!(symbol, Symbol::Reaction(_)));
        for (symbol, value) in reactions {
            let named = known.entry(*symbol).or_default();
            let phases: Vec<usize> =
                system.phases.iter().copied().filter(|phase| !named.phases.contains(phase)).collect();
            if !phases.is_empty() {
                named.phases.extend(&phases);
                named.values.push((phases, value));
            }
        }
    }
    known
}

/// What systems of balances say of a reaction component.
#[derive(Default)]
struct Named {
    /// The phases of all of them.
    phases: Vec<usize>,
    /// In which phases it has which value.
    values: Vec<(Vec<usize>, Id)>,
}

impl Named {
    /// The value in every phase; where no system tells, infinite if it is to be `absent` there.
    fn value(&self, graph: &mut Graph, count: usize, absent: bool) -> Id {
        let value = match self.values.as_slice() {
            [(_, value)] => *value,
            several => several.iter().fold(Id::ZERO, |sum, (phases, value)| {
                let active = graph.in_phases(phases, count);
                let term = graph.mul(active, *value);
                graph.add(sum, term)
            }),
        };
        let active = graph.in_phases(&self.phases, count);
        if !absent || active == Id::ONE {
            return value;
        }
        // ln 1 is 0, and ln 0 infinite.
        let infinite = graph.unary(Unary::Ln, active);
        graph.add(value, infinite)
    }
}

/// The reactions that outputs, events and checks contain.
fn wanted(model: &Model) -> Vec<Symbol> {
    let outputs = model.outputs.iter().flat_map(|output| output.value.iter().copied());
    let events = model.events.iter().flat_map(|event| [Some(event.when), event.condition]).flatten();
    let checks = model.checks.iter().flat_map(|check| check.left.iter().chain(&check.right).copied());
    let symbols = model.graph.symbols(outputs.chain(events).chain(checks));
    symbols.into_iter().filter(|s| matches!(s, Symbol::Reaction(_))).collect()
}

/// (RᵀWR)⁻¹RᵀW(−s) for residuals R r + s, with s at r = 0.
///
/// W weighs the balances: a row of a moment holds lengths where one of a force holds numbers without a unit, and rows
/// without weights make a normal matrix with the square of the lengths in its condition.  The solution is the same for all W, since the
/// system agrees with the motion.
fn least_squares(model: &mut Model, system: &BalanceSystem, unknowns: &[Symbol]) -> Vec<Id> {
    let (m, defaults) = (unknowns.len(), typical(model));
    let couple = |unknown: &Symbol| match unknown {
        Symbol::Reaction(k) => {
            model.reactions.iter().any(|r| r.couple && (r.first..r.first + r.components as u32).contains(k))
        }
        _ => false,
    };
    let couples: Vec<bool> = unknowns.iter().map(couple).collect();
    let graph = &mut model.graph;
    let mut normal = vec![vec![Id::ZERO; m + 1]; m];
    for balance in &system.balances {
        let sum = |graph: &mut Graph, k: usize| {
            balance.parts.iter().fold(Id::ZERO, |sum, part| graph.add(sum, part.value[k]))
        };
        let residuals: Vec<Id> = (0..balance.components).map(|k| sum(graph, k)).collect();
        let rows = jacobian(graph, &residuals, |s| unknowns.iter().position(|u| *u == s));
        let zero = unknowns.iter().map(|u| (*u, Id::ZERO)).collect();
        let rest = crate::expr::substitute(graph, &residuals, &zero);
        let weight = weight(graph, &rows, &couples, &defaults);
        for (row, s) in rows.iter().zip(&rest) {
            for &(i, a) in row {
                let weighted = graph.mul(weight, a);
                for &(j, b) in row {
                    let product = graph.mul(weighted, b);
                    normal[i][j] = graph.add(normal[i][j], product);
                }
                let product = graph.mul(weighted, *s);
                normal[i][m] = graph.sub(normal[i][m], product);
            }
        }
    }
    // cos² + sin² of a direction becomes 1, so that most pivots are constants.
    // All rows at once, for what they share; row by row where that grows too large.
    let constant = |s: Symbol| matches!(s, Symbol::Parameter(_));
    let all: Vec<Id> = normal.iter().flat_map(|row| &row[..m]).copied().collect();
    let together = expand(graph, &all, constant, Angles::Shorter);
    for (k, row) in normal.iter_mut().enumerate() {
        let simple = match &together {
            Some(all) => Some(all[k * m..][..m].to_vec()),
            None => expand(graph, &row[..m], constant, Angles::Shorter),
        };
        if let Some(simple) = simple {
            row[..m].copy_from_slice(&simple);
        }
    }
    for k in 0..m {
        let pivot_row = normal[k].clone();
        let pivot = graph.div(Id::ONE, pivot_row[k]);
        for row in normal.iter_mut().skip(k + 1).filter(|row| row[k] != Id::ZERO) {
            let factor = graph.mul(row[k], pivot);
            for (entry, above) in row.iter_mut().zip(&pivot_row).skip(k + 1).filter(|(_, above)| **above != Id::ZERO) {
                let update = graph.mul(factor, *above);
                *entry = graph.sub(*entry, update);
            }
        }
    }
    let mut solution = vec![Id::ZERO; m];
    for k in (0..m).rev() {
        let mut value = normal[k][m];
        for j in k + 1..m {
            let term = graph.mul(normal[k][j], solution[j]);
            value = graph.sub(value, term);
        }
        solution[k] = graph.div(value, normal[k][k]);
    }
    solution
}

/// The weight of a balance: 1 over the mean square of its entries, with arms and directions at their sizes.
///
/// The entries of moments stand aside where there are others, since they have no length in them.  What makes all entries 0 makes
/// no weight infinite: lengths below `TINY` of their defaults count as that.
fn weight(graph: &mut Graph, rows: &[Vec<(usize, Id)>], couples: &[bool], defaults: &dyn Fn(Symbol) -> f64) -> Id {
    let entries = |couple: bool| rows.iter().flatten().filter(move |(j, _)| couples[*j] == couple).map(|(_, a)| *a);
    let forces: Vec<Id> = entries(false).collect();
    let entries = if forces.is_empty() { entries(true).collect() } else { forces };
    let squares = squared_sizes(graph, &entries, defaults);
    let sum = squares.iter().fold(Id::ZERO, |sum, square| graph.add(sum, *square));
    let at_defaults = Tape::new(graph, &[sum]).evaluate(defaults)[0];
    if !(at_defaults > 0.0 && at_defaults.is_finite()) {
        return Id::ONE;
    }
    let count = entries.len();
    if graph.number(sum).is_some() {
        // A power of four rounds nothing, and is 1 for directions.
        let steps = (0.5 * (count as f64 / at_defaults).log2()).round();
        return graph.float((2.0 * steps).exp2());
    }
    let floor = graph.float(TINY * TINY * at_defaults);
    let (count, sum) = (graph.integer(count as i64), graph.add(sum, floor));
    graph.div(count, sum)
}

/// Squares of sizes, expressions of parameters: of a sum the sum of the squares, of a sine or cosine 1, of a coordinate or a speed the
/// square of its value at the start.
fn squared_sizes(graph: &mut Graph, roots: &[Id], starts: &dyn Fn(Symbol) -> f64) -> Vec<Id> {
    let mut sizes: HashMap<Id, Id> = HashMap::default();
    for id in graph.needed(roots.iter().copied()) {
        let size = match graph.node(id) {
            Node::Number(_) | Node::Symbol(Symbol::Parameter(_)) => graph.mul(id, id),
            Node::Symbol(symbol) => {
                let start = starts(symbol);
                graph.float(start * start)
            }
            Node::Unary(Unary::Neg | Unary::Abs, x) => sizes[&x],
            Node::Unary(Unary::Sqrt, x) => graph.unary(Unary::Sqrt, sizes[&x]),
            Node::Unary(..) | Node::Binary(Binary::Atan2, ..) => Id::ONE,
            Node::Binary(Binary::Mul, x, y) => graph.mul(sizes[&x], sizes[&y]),
            Node::Binary(Binary::Div, x, y) => graph.div(sizes[&x], sizes[&y]),
            Node::Binary(Binary::Pow, x, y) => graph.binary(Binary::Pow, sizes[&x], y),
            Node::Binary(Binary::Add | Binary::Sub | Binary::Min | Binary::Max, x, y) => {
                graph.add(sizes[&x], sizes[&y])
            }
        };
        sizes.insert(id, size);
    }
    roots.iter().map(|root| sizes[root]).collect()
}

/// Defaults of parameters, and coordinates and speeds at the first scene's start; one that starts at 0 has the size of the largest
/// parameter of its unit, or 1.
fn typical(model: &Model) -> impl Fn(Symbol) -> f64 + use<> {
    let parameters: Vec<f64> = model.parameters.iter().map(|p| p.default).collect();
    let value = |s: Symbol| match s {
        Symbol::Parameter(i) => parameters[i as usize],
        _ => 0.0,
    };
    let nonzero = |x: f64| x != 0.0 && x.is_finite();
    let start = |list: &[Id]| -> Vec<f64> {
        let size = |(i, x): (usize, f64)| {
            let unit = &model.coordinates[i].unit;
            let alike =
                model.parameters.iter().filter(|p| p.unit.is_some() && p.unit == *unit).map(|p| p.default.abs());
            Some(x).into_iter().chain([alike.fold(0.0, f64::max)]).find(|x| nonzero(*x)).unwrap_or(1.0)
        };
        Tape::new(&model.graph, list).evaluate(value).into_iter().enumerate().map(size).collect()
    };
    let (q, v) = model.scenes.first().map_or_else(Default::default, |scene| (start(&scene.q), start(&scene.v)));
    move |symbol| {
        let (list, i) = match symbol {
            Symbol::Parameter(i) => (&parameters, i),
            Symbol::Coordinate(i) => (&q, i),
            Symbol::Speed(i) => (&v, i),
            _ => return 1.0,
        };
        list.get(i as usize).copied().unwrap_or(1.0)
    }
}
