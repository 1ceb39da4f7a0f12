//! Forward and reverse differentiation on the graph.

use rustc_hash::FxHashMap as HashMap;

use super::places::Places;
use super::{Binary, Graph, Id, Node, Symbol, Unary};

/// A directional derivative: every symbol moves at its own rate.
///
/// Derivatives of shared nodes are computed once and kept, so one `Forward` can serve many expressions.
pub struct Forward<F: Fn(&mut Graph, Symbol) -> Id> {
    rate: F,
    known: HashMap<Id, Id>,
}

impl<F: Fn(&mut Graph, Symbol) -> Id> Forward<F> {
    /// `rate(symbol)` is the derivative of a symbol along the direction; 0 for one that stands still.
    pub fn new(rate: F) -> Self {
        Forward { rate, known: HashMap::default() }
    }

    /// The derivative of an expression.
    pub fn of(&mut self, graph: &mut Graph, root: Id) -> Id {
        let mut stack = vec![root];
        while let Some(&top) = stack.last() {
            if self.known.contains_key(&top) {
                stack.pop();
                continue;
            }
            let before = stack.len();
            stack.extend(graph.children(top).filter(|c| !self.known.contains_key(c)));
            if stack.len() > before {
                continue;
            }
            let derivative = self.local(graph, top);
            self.known.insert(top, derivative);
            stack.pop();
        }
        self.known[&root]
    }

    /// How many nodes it knows the derivatives of.
    pub fn known(&self) -> usize {
        self.known.len()
    }

    fn local(&mut self, graph: &mut Graph, id: Id) -> Id {
        match graph.node(id) {
            Node::Number(_) => Id::ZERO,
            Node::Symbol(s) => (self.rate)(graph, s),
            Node::Unary(_, x) => {
                let dx = self.known[&x];
                if dx == Id::ZERO {
                    return Id::ZERO;
                }
                let partial = partial_unary(graph, id);
                graph.mul(partial, dx)
            }
            Node::Binary(operation, x, y) => {
                let (dx, dy) = (self.known[&x], self.known[&y]);
                match operation {
                    Binary::Add => graph.add(dx, dy),
                    Binary::Sub => graph.sub(dx, dy),
                    _ => {
                        let mut sum = Id::ZERO;
                        for (d, first) in [(dx, true), (dy, false)] {
                            if d != Id::ZERO {
                                let partial = partial_binary(graph, id, first);
                                let term = graph.mul(partial, d);
                                sum = graph.add(sum, term);
                            }
                        }
                        sum
                    }
                }
            }
        }
    }
}

/// The partial derivative of an expression by one symbol.
pub fn partial(graph: &mut Graph, root: Id, by: Symbol) -> Id {
    Forward::new(move |_: &mut Graph, s| if s == by { Id::ONE } else { Id::ZERO }).of(graph, root)
}

/// The sparse Jacobian of some expressions by the symbols to which `column` gives a place.
///
/// One forward pass carries the tangents of all columns at once, non-zero ones only; each row comes
/// sorted by column.
pub fn jacobian(graph: &mut Graph, roots: &[Id], column: impl Fn(Symbol) -> Option<usize>) -> Vec<Vec<(usize, Id)>> {
    let needed = Places::new(graph.needed(roots.iter().copied()));
    let mut tangents: Vec<Vec<(usize, Id)>> = Vec::with_capacity(needed.list().len());
    for &id in needed.list() {
        let row = match graph.node(id) {
            Node::Number(_) => Vec::new(),
            Node::Symbol(s) => column(s).map(|c| vec![(c, Id::ONE)]).unwrap_or_default(),
            Node::Unary(_, x) => scaled(graph, &tangents[needed.of(x)], |g| partial_unary(g, id)),
            Node::Binary(operation, x, y) => {
                let (first, second) = (tangents[needed.of(x)].clone(), tangents[needed.of(y)].clone());
                match operation {
                    Binary::Add => merged(graph, first, second, Graph::add),
                    Binary::Sub => merged(graph, first, second, Graph::sub),
                    _ => {
                        let a = scaled(graph, &first, |g| partial_binary(g, id, true));
                        let b = scaled(graph, &second, |g| partial_binary(g, id, false));
                        merged(graph, a, b, Graph::add)
                    }
                }
            }
        };
        tangents.push(row);
    }
    roots.iter().map(|r| tangents[needed.of(*r)].clone()).collect()
}

fn scaled(graph: &mut Graph, row: &[(usize, Id)], slope: impl FnOnce(&mut Graph) -> Id) -> Vec<(usize, Id)> {
    if row.is_empty() {
        return Vec::new();
    }
    let slope = slope(graph);
    row.iter().map(|&(c, d)| (c, graph.mul(slope, d))).filter(|&(_, d)| d != Id::ZERO).collect()
}

fn merged(
    graph: &mut Graph,
    a: Vec<(usize, Id)>,
    b: Vec<(usize, Id)>,
    combine: impl Fn(&mut Graph, Id, Id) -> Id,
) -> Vec<(usize, Id)> {
    let (mut a, mut b) = (a.into_iter().peekable(), b.into_iter().peekable());
    let mut row = Vec::new();
    loop {
        let (x, y) = (a.peek().map(|e| e.0), b.peek().map(|e| e.0));
        let Some(c) = [x, y].into_iter().flatten().min() else { return row };
        let left = a.next_if(|e| e.0 == c).map_or(Id::ZERO, |e| e.1);
        let right = b.next_if(|e| e.0 == c).map_or(Id::ZERO, |e| e.1);
        let value = combine(graph, left, right);
        if value != Id::ZERO {
            row.push((c, value));
        }
    }
}

/// Reverse mode: the gradient of Σ seedₖ·rootₖ (seeds held fixed) by every symbol of which `wanted` is true.
///
/// Partial derivatives are formed for the nodes between the roots and the wanted symbols only.
pub fn reverse(graph: &mut Graph, seeds: &[(Id, Id)], wanted: impl Fn(Symbol) -> bool) -> HashMap<Symbol, Id> {
    sweep(graph, seeds, &wanted)
}

/// The gradient of each root by itself, as [`reverse`] gives it.
pub fn gradients(graph: &mut Graph, roots: &[Id], wanted: impl Fn(Symbol) -> bool) -> Vec<HashMap<Symbol, Id>> {
    roots.iter().map(|root| sweep(graph, &[(*root, Id::ONE)], &wanted)).collect()
}

/// One reverse pass over what the roots need.
fn sweep(graph: &mut Graph, seeds: &[(Id, Id)], wanted: &impl Fn(Symbol) -> bool) -> HashMap<Symbol, Id> {
    let needed = Places::new(graph.needed(seeds.iter().map(|seed| seed.0)));
    let mut active = Vec::with_capacity(needed.list().len());
    for &id in needed.list() {
        active.push(match graph.node(id) {
            Node::Number(_) => false,
            Node::Symbol(s) => wanted(s),
            Node::Unary(_, x) => active[needed.of(x)],
            Node::Binary(_, x, y) => active[needed.of(x)] || active[needed.of(y)],
        });
    }
    let mut cotangent = vec![Id::ZERO; active.len()];
    for &(root, seed) in seeds {
        let place = needed.of(root);
        if active[place] {
            cotangent[place] = graph.add(cotangent[place], seed);
        }
    }
    let mut gradient = HashMap::default();
    for i in (0..active.len()).rev() {
        let bar = cotangent[i];
        if bar == Id::ZERO {
            continue;
        }
        let id = needed.list()[i];
        let mut give = |graph: &mut Graph, child: Id, amount: Id| {
            let slot = &mut cotangent[needed.of(child)];
            *slot = graph.add(*slot, amount);
        };
        match graph.node(id) {
            Node::Number(_) => {}
            Node::Symbol(s) => {
                gradient.insert(s, bar);
            }
            Node::Unary(_, x) => {
                if active[needed.of(x)] {
                    let slope = partial_unary(graph, id);
                    let amount = graph.mul(slope, bar);
                    give(graph, x, amount);
                }
            }
            Node::Binary(operation, x, y) => {
                for (child, first) in [(x, true), (y, false)] {
                    if !active[needed.of(child)] {
                        continue;
                    }
                    let amount = match (operation, first) {
                        (Binary::Add, _) | (Binary::Sub, true) => bar,
                        (Binary::Sub, false) => graph.neg(bar),
                        _ => {
                            let slope = partial_binary(graph, id, first);
                            graph.mul(slope, bar)
                        }
                    };
                    give(graph, child, amount);
                }
            }
        }
    }
    gradient
}

/// f'(x) for a node f(x).
fn partial_unary(g: &mut Graph, id: Id) -> Id {
    let Node::Unary(function, x) = g.node(id) else { return Id::ZERO };
    match function {
        Unary::Neg => g.integer(-1),
        Unary::Sqrt => {
            let half = g.rational(super::Rational::new(1, 2).unwrap_or(super::Rational::ONE));
            g.div(half, id)
        }
        Unary::Sin => g.unary(Unary::Cos, x),
        Unary::Cos => {
            let sine = g.unary(Unary::Sin, x);
            g.neg(sine)
        }
        Unary::Tan => {
            let square = g.mul(id, id);
            g.add(Id::ONE, square)
        }
        Unary::Asin | Unary::Acos => {
            let square = g.mul(x, x);
            let rest = g.sub(Id::ONE, square);
            let root = g.unary(Unary::Sqrt, rest);
            let slope = g.div(Id::ONE, root);
            if function == Unary::Asin { slope } else { g.neg(slope) }
        }
        Unary::Atan => {
            let square = g.mul(x, x);
            let rest = g.add(Id::ONE, square);
            g.div(Id::ONE, rest)
        }
        Unary::Sinh => g.unary(Unary::Cosh, x),
        Unary::Cosh => g.unary(Unary::Sinh, x),
        Unary::Tanh => {
            let square = g.mul(id, id);
            g.sub(Id::ONE, square)
        }
        Unary::Exp => id,
        Unary::Ln => g.div(Id::ONE, x),
        Unary::Abs => g.unary(Unary::Sign, x),
        Unary::Sign | Unary::Step => Id::ZERO,
        Unary::Table(table) => match table.derivative() {
            Some(slope) => g.unary(Unary::Table(slope), x),
            None => Id::ZERO,
        },
    }
}

/// The partial derivative of a node f(x, y) by its first or second argument.
fn partial_binary(g: &mut Graph, id: Id, first: bool) -> Id {
    let Node::Binary(operation, x, y) = g.node(id) else { return Id::ZERO };
    match (operation, first) {
        (Binary::Add, _) | (Binary::Sub, true) => Id::ONE,
        (Binary::Sub, false) => g.integer(-1),
        (Binary::Mul, true) => y,
        (Binary::Mul, false) => x,
        (Binary::Div, true) => g.div(Id::ONE, y),
        (Binary::Div, false) => {
            let quotient = g.div(id, y);
            g.neg(quotient)
        }
        (Binary::Pow, true) => {
            let less = g.sub(y, Id::ONE);
            let power = g.pow(x, less);
            g.mul(y, power)
        }
        (Binary::Pow, false) => {
            let logarithm = g.unary(Unary::Ln, x);
            g.mul(id, logarithm)
        }
        (Binary::Atan2, _) => {
            // d atan2(y, x) = (x dy − y dx)/(x² + y²); here the first argument is y.
            let (ordinate, abscissa) = (x, y);
            let a = g.mul(ordinate, ordinate);
            let b = g.mul(abscissa, abscissa);
            let square = g.add(a, b);
            if first {
                g.div(abscissa, square)
            } else {
                let slope = g.div(ordinate, square);
                g.neg(slope)
            }
        }
        (Binary::Min | Binary::Max, _) => {
            // 1 where this argument is the one chosen (the first on a tie), 0 elsewhere.
            let minimum = operation == Binary::Min;
            let difference = if minimum { g.sub(y, x) } else { g.sub(x, y) };
            let chosen = g.unary(Unary::Step, difference);
            if first { chosen } else { g.sub(Id::ONE, chosen) }
        }
        (Binary::Normal(_), _) => Id::ZERO,
        (Binary::Table(table), _) => match table.derivative(usize::from(!first)) {
            Some(slope) => g.binary(Binary::Table(slope), x, y),
            None => Id::ZERO,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Binary, Graph, Symbol, Tape, Unary};
    use super::{partial, reverse};

    /// Every function against a central difference, forward and reverse.
    #[test]
    fn derivatives_agree_with_differences() {
        let functions = [
            Unary::Neg,
            Unary::Sqrt,
            Unary::Sin,
            Unary::Cos,
            Unary::Tan,
            Unary::Asin,
            Unary::Acos,
            Unary::Atan,
            Unary::Sinh,
            Unary::Cosh,
            Unary::Tanh,
            Unary::Exp,
            Unary::Ln,
            Unary::Abs,
        ];
        let operations =
            [Binary::Add, Binary::Sub, Binary::Mul, Binary::Div, Binary::Pow, Binary::Atan2, Binary::Min, Binary::Max];
        let mut g = Graph::new();
        let (p, q) = (Symbol::Coordinate(0), Symbol::Coordinate(1));
        let (x, y) = (g.symbol(p), g.symbol(q));
        let product = g.mul(x, y);
        let mut roots: Vec<_> = functions.iter().map(|f| g.unary(*f, product)).collect();
        let sum = g.add(x, y);
        roots.extend(operations.iter().map(|f| g.binary(*f, product, sum)));
        let at = |x: f64, y: f64| move |s: Symbol| if s == Symbol::Coordinate(0) { x } else { y };
        for root in roots {
            let forward = partial(&mut g, root, p);
            let one = g.integer(1);
            let backward = reverse(&mut g, &[(root, one)], |s| s == p)[&p];
            let tape = Tape::new(&g, &[root, forward, backward]);
            let (x, y, d) = (0.6, 1.1, 1e-6);
            let here = tape.evaluate(at(x, y));
            let slope = (tape.evaluate(at(x + d, y))[0] - tape.evaluate(at(x - d, y))[0]) / (2.0 * d);
            assert!((here[1] - slope).abs() < 1e-8, "{:?}: {} {}", g.node(root), here[1], slope);
            assert!((here[2] - slope).abs() < 1e-8, "{:?}: {} {}", g.node(root), here[2], slope);
        }
    }
}
