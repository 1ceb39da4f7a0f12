//! The hash-consed expression graph.

use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};

use super::places::Places;
use super::{Symbol, Table, Table2d};
use crate::number::{DoubleDouble, Number, Rational};

/// An expression: an index into the [`Graph`] that made it.  Children have smaller indices than parents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Id(u32);

impl Id {
    /// The constant 0, at this place in every graph.
    pub const ZERO: Id = Id(0);
    /// The constant 1, at this place in every graph.
    pub const ONE: Id = Id(1);
    /// The constant −1, likewise.
    pub const MINUS_ONE: Id = Id(2);

    /// Its place in the graph.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Functions of one argument; [`Table`]s are the model's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[expect(missing_docs, reason = "the usual functions")]
pub enum Unary {
    Neg,
    Sqrt,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Abs,
    Sign,
    Step,
    Table(Table),
}

impl Unary {
    /// Its name in the model language, and of the method in generated code.
    pub fn name(self) -> &'static str {
        match self {
            Unary::Neg => "neg",
            Unary::Sqrt => "sqrt",
            Unary::Sin => "sin",
            Unary::Cos => "cos",
            Unary::Tan => "tan",
            Unary::Asin => "asin",
            Unary::Acos => "acos",
            Unary::Atan => "atan",
            Unary::Sinh => "sinh",
            Unary::Cosh => "cosh",
            Unary::Tanh => "tanh",
            Unary::Exp => "exp",
            Unary::Ln => "ln",
            Unary::Abs => "abs",
            Unary::Sign => "sign",
            Unary::Step => "step",
            Unary::Table(table) => table.name(),
        }
    }
}

/// Operations on two arguments; [`Table2d`]s are the model's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[expect(missing_docs, reason = "the usual operations")]
pub enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    /// A power whose exponent is no integer up to 64 and no half of one.
    Pow,
    /// atan2(y, x).
    Atan2,
    Min,
    Max,
    Table(Table2d),
    /// The number of standard normal distribution of a seed and a place in the stream of this key.
    Normal(u64),
}

/// One node of the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// A constant, by its place in the table of numbers.
    Number(u32),
    /// A leaf.
    Symbol(Symbol),
    /// A function of one argument.
    Unary(Unary, Id),
    /// An operation on two.
    Binary(Binary, Id, Id),
}

impl Node {
    /// Whether a function has a kink or a jump, or is a table.
    pub fn is_piecewise(self) -> bool {
        match self {
            Node::Unary(f, _) => matches!(f, Unary::Abs | Unary::Sign | Unary::Step | Unary::Table(_)),
            Node::Binary(f, ..) => matches!(f, Binary::Min | Binary::Max | Binary::Table(_)),
            Node::Number(_) | Node::Symbol(_) => false,
        }
    }
}

/// The arena.
///
/// Constructors fold 0, 1 and constants, put the operands of sums and products in order and pull signs
/// outwards, so that equal expressions mostly get equal [`Id`]s.  The graph is never walked or printed
/// as a tree.
#[derive(Clone, Debug)]
pub struct Graph {
    nodes: Vec<Node>,
    index: HashMap<Node, Id>,
    numbers: Vec<Number>,
    number_index: HashMap<(u8, i128, i128), u32>,
    overflowed: bool,
}

/// A hostile file cannot make the graph larger than this.
pub const NODE_LIMIT: usize = 1_000_000;

impl Default for Graph {
    fn default() -> Self {
        Self::new()
    }
}

impl Graph {
    /// An empty graph (with 0, 1 and −1 in it).
    pub fn new() -> Self {
        let mut graph = Graph {
            nodes: Vec::new(),
            index: HashMap::default(),
            numbers: Vec::new(),
            number_index: HashMap::default(),
            overflowed: false,
        };
        graph.rational(Rational::ZERO);
        graph.rational(Rational::ONE);
        graph.integer(-1);
        graph
    }

    /// How many nodes there are.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Never true: 0, 1 and −1 are always there.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// True once a node was refused because the graph has a million already; what was built then is meaningless.
    pub fn overflowed(&self) -> bool {
        self.overflowed
    }

    /// The node of an expression.
    pub fn node(&self, id: Id) -> Node {
        self.nodes[id.index()]
    }

    /// The expression with this node, if there is one.
    pub fn find(&self, node: Node) -> Option<Id> {
        self.index.get(&node).copied()
    }

    /// The number with this place in the table.
    pub fn number_at(&self, place: u32) -> Number {
        self.numbers[place as usize]
    }

    /// The expression's value, if it is a constant.
    pub fn number(&self, id: Id) -> Option<Number> {
        match self.node(id) {
            Node::Number(place) => Some(self.number_at(place)),
            _ => None,
        }
    }

    /// The children of a node.
    pub fn children(&self, id: Id) -> impl Iterator<Item = Id> + use<> {
        let pair = match self.node(id) {
            Node::Number(_) | Node::Symbol(_) => [None, None],
            Node::Unary(_, x) => [Some(x), None],
            Node::Binary(_, x, y) => [Some(x), Some(y)],
        };
        pair.into_iter().flatten()
    }

    /// For each node, whether some root needs it; children before parents in index order.
    pub fn reachable(&self, roots: impl IntoIterator<Item = Id>) -> Vec<bool> {
        let mut needed = vec![false; self.nodes.len()];
        for root in roots {
            needed[root.index()] = true;
        }
        for i in (0..needed.len()).rev() {
            if needed[i] {
                for child in self.children(Id(i as u32)) {
                    needed[child.index()] = true;
                }
            }
        }
        needed
    }

    /// The nodes that some root needs, children before parents: what [`Graph::reachable`] marks, in time that the arena's
    /// size does not enter where they are few.
    pub fn needed(&self, roots: impl IntoIterator<Item = Id>) -> Vec<Id> {
        let mut stack: Vec<Id> = roots.into_iter().collect();
        let mut found: HashSet<Id> = HashSet::default();
        let few = self.nodes.len() / 32;
        while let Some(id) = stack.pop() {
            if !found.insert(id) {
                continue;
            }
            if found.len() > few {
                let needed = self.reachable(found.into_iter().chain(stack));
                return (0..needed.len()).filter(|&i| needed[i]).map(|i| self.id_at(i)).collect();
            }
            stack.extend(self.children(id));
        }
        let mut list: Vec<Id> = found.into_iter().collect();
        list.sort_unstable();
        list
    }

    /// The expression at a place in the arena.
    pub fn id_at(&self, place: usize) -> Id {
        debug_assert!(place < self.nodes.len());
        Id(place as u32)
    }

    /// All symbols that the roots contain, in order of first appearance.
    pub fn symbols(&self, roots: impl IntoIterator<Item = Id>) -> Vec<Symbol> {
        let leaf = |id: Id| match self.node(id) {
            Node::Symbol(s) => Some(s),
            _ => None,
        };
        self.needed(roots).into_iter().filter_map(leaf).collect()
    }

    /// For each expression the places of the symbols that it contains, in order; each node is looked at once.
    pub fn contained_in_each(&self, roots: &[Id], place: impl Fn(Symbol) -> Option<usize>) -> Vec<Vec<usize>> {
        let needed = Places::new(self.needed(roots.iter().copied()));
        let of_symbol = |id: &Id| if let Node::Symbol(s) = self.node(*id) { place(s) } else { None };
        let words = needed.list().iter().filter_map(of_symbol).max().map_or(0, |most| most / 64 + 1);
        let mut sets: Vec<u64> = vec![0; words * needed.list().len()];
        for (own, id) in needed.list().iter().enumerate() {
            if let Some(place) = of_symbol(id) {
                sets[own * words + place / 64] |= 1 << (place % 64);
            }
            for child in self.children(*id) {
                let from = needed.of(child) * words;
                (0..words).for_each(|word| sets[own * words + word] |= sets[from + word]);
            }
        }
        let places = |root: &Id| {
            let set = &sets[needed.of(*root) * words..][..words];
            (0..64 * words).filter(|place| set[place / 64] >> (place % 64) & 1 == 1).collect()
        };
        roots.iter().map(places).collect()
    }

    /// For each node, whether it contains a symbol of which `wanted` is true.
    pub fn contains(&self, wanted: impl Fn(Symbol) -> bool) -> Vec<bool> {
        self.contains_node(|node| matches!(node, Node::Symbol(s) if wanted(s)))
    }

    /// For each node, whether it has kinks or jumps, or is made of pieces: what it is in one place says nothing of others.
    pub fn has_pieces(&self) -> Vec<bool> {
        self.contains_node(Node::is_piecewise)
    }

    fn contains_node(&self, wanted: impl Fn(Node) -> bool) -> Vec<bool> {
        let mut found = vec![false; self.nodes.len()];
        for i in 0..self.nodes.len() {
            found[i] = wanted(self.nodes[i])
                || match self.nodes[i] {
                    Node::Symbol(_) | Node::Number(_) => false,
                    Node::Unary(_, x) => found[x.index()],
                    Node::Binary(_, x, y) => found[x.index()] || found[y.index()],
                };
        }
        found
    }

    /// A symbol.
    pub fn symbol(&mut self, symbol: Symbol) -> Id {
        self.intern(Node::Symbol(symbol))
    }

    /// An exact constant.
    pub fn rational(&mut self, value: Rational) -> Id {
        self.constant(Number::Exact(value))
    }

    /// An integer constant.
    pub fn integer(&mut self, value: i64) -> Id {
        self.rational(Rational::integer(value))
    }

    /// A float constant, exactly as it is.
    pub fn float(&mut self, value: f64) -> Id {
        self.constant(value.into())
    }

    /// A constant of about 32 digits.
    pub fn double_double(&mut self, value: DoubleDouble) -> Id {
        self.constant(value.into())
    }

    /// A constant.
    pub fn constant(&mut self, number: Number) -> Id {
        let key = number.bits();
        let place = match self.number_index.get(&key) {
            Some(&place) => place,
            None => {
                let place = self.numbers.len() as u32;
                self.numbers.push(number);
                self.number_index.insert(key, place);
                place
            }
        };
        self.intern(Node::Number(place))
    }

    pub(super) fn intern(&mut self, node: Node) -> Id {
        if let Some(&id) = self.index.get(&node) {
            return id;
        }
        if self.nodes.len() >= NODE_LIMIT {
            self.overflowed = true;
            return Id::ZERO;
        }
        let id = Id(self.nodes.len() as u32);
        self.nodes.push(node);
        self.index.insert(node, id);
        id
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_expression_tells_its_own_symbols() {
        let mut g = Graph::new();
        let q: Vec<Id> = (0..70).map(|i| g.symbol(Symbol::Coordinate(i))).collect();
        let time = g.symbol(Symbol::Time);
        let (a, b) = (g.mul(q[3], q[69]), g.mul(time, q[1]));
        let sum = g.add(a, b);
        let place = |s| if let Symbol::Coordinate(i) = s { Some(i as usize) } else { None };
        let found = g.contained_in_each(&[a, sum, time, Id::ONE], place);
        assert_eq!(found, [vec![3, 69], vec![1, 3, 69], vec![], vec![]]);
    }
}
