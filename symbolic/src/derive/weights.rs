//! Weights of balances: forces and moments of one system are of one size.

use rustc_hash::FxHashMap as HashMap;

use crate::expr::{Binary, Graph, Id, Node, Symbol, Tape, Unary};
use crate::model::Model;

/// What lengths count as where they vanish, beside their defaults: so small that no length which means something is changed by it, and
/// its square is far above the smallest `f64`.
const TINY: f64 = 1e-15;

/// A row of a balance: the entries of its unknowns, by their places.
type Row = Vec<(usize, Id)>;

/// The weight of each balance: 1 over the mean square of its entries, with arms and directions at their sizes.
///
/// The entries of moments (`couples`) stand aside where there are others, since they have no length in them.
pub(super) fn weights(
    graph: &mut Graph,
    balances: &[&[Row]],
    couples: &[bool],
    defaults: &dyn Fn(Symbol) -> f64,
) -> Vec<Id> {
    let entries = balances.iter().map(|rows| {
        let of = |couple: bool| rows.iter().flatten().filter(move |(j, _)| couples[*j] == couple).map(|(_, a)| *a);
        let forces: Vec<Id> = of(false).collect();
        if forces.is_empty() { of(true).collect() } else { forces }
    });
    let entries: Vec<Vec<Id>> = entries.collect();
    let sizes = squared_sizes(graph, &entries.concat(), defaults);
    let mut sum = |entries: &Vec<Id>| entries.iter().fold(Id::ZERO, |sum, entry| graph.add(sum, sizes[entry]));
    let sums: Vec<Id> = entries.iter().map(&mut sum).collect();
    let at_defaults = Tape::new(graph, &sums).evaluate(defaults);
    let counts = entries.iter().map(Vec::len);
    sums.into_iter().zip(at_defaults).zip(counts).map(|(sum, count)| weight(graph, sum, count)).collect()
}

/// The number of squares over their sum, whose value with the defaults is known.  What makes all of them 0 makes no weight infinite: lengths
/// below `TINY` of their defaults count as that.
fn weight(graph: &mut Graph, (sum, at_defaults): (Id, f64), count: usize) -> Id {
    if !(at_defaults > 0.0 && at_defaults.is_finite()) {
        return Id::ONE;
    }
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
fn squared_sizes(graph: &mut Graph, roots: &[Id], starts: &dyn Fn(Symbol) -> f64) -> HashMap<Id, Id> {
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
            Node::Unary(..) | Node::Binary(Binary::Atan2 | Binary::Table(_) | Binary::Normal(_), ..) => Id::ONE,
            Node::Binary(Binary::Mul, x, y) => graph.mul(sizes[&x], sizes[&y]),
            Node::Binary(Binary::Div, x, y) => graph.div(sizes[&x], sizes[&y]),
            Node::Binary(Binary::Pow, x, y) => graph.binary(Binary::Pow, sizes[&x], y),
            Node::Binary(Binary::Add | Binary::Sub | Binary::Min | Binary::Max, x, y) => {
                graph.add(sizes[&x], sizes[&y])
            }
        };
        sizes.insert(id, size);
    }
    sizes
}

/// Defaults of parameters, and coordinates and speeds at the first scene's start; one that starts at 0 has the size of the largest
/// parameter of its unit, or 1.
pub(super) fn typical(model: &Model) -> impl Fn(Symbol) -> f64 + use<> {
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
