//! One straight-line function body.
//!
//! Nodes used once are nested into their consumer (to a depth of 8), all others become a `let`, in the
//! order of their creation; each result is stored right where it is computed, because stores collected at
//! the end of a function send LLVM's SLP vectoriser off for minutes.

use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};
use std::fmt::Write;

use super::dialect::{Dialect, Level, Piece};
use super::scope::{Names, Scope, joined};
use crate::expr::{Binary, Graph, Id, Node, Number, Rational, Symbol, Table, Table2d, Unary};

/// What happens with a computed value.
pub(super) enum Use {
    /// `target = value;`
    Store(String, Id),
    /// The pivot of this coordinate must not be negligible against this entry of M's diagonal.
    Pivot(usize, Id, Id),
}

impl Use {
    fn values(&self) -> Vec<Id> {
        match self {
            Use::Store(_, id) => vec![*id],
            Use::Pivot(_, pivot, diagonal) => vec![*pivot, *diagonal],
        }
    }
}

/// Statements, and what they read.
#[derive(Default)]
pub(super) struct Body {
    pub lines: String,
    pub reads: Reads,
}

/// Which arguments a body reads.
#[derive(Clone, Copy, Default)]
pub(super) struct Reads {
    pub constants: bool,
    pub time: bool,
    pub inputs: bool,
    /// q, v, a, l.
    pub state: [bool; 4],
    /// A direction along which slopes are wanted.
    pub along: bool,
}

/// Deepest nesting of one expression.
const NESTING: u8 = 8;

/// Prints bodies of functions of one program.
pub(super) struct Bodies<'a> {
    pub graph: &'a Graph,
    pub names: &'a Names,
    /// Places of hoisted expressions in the block of constants.
    pub hoisted: &'a HashMap<Id, usize>,
    /// Place of the first mode in the block of constants.
    pub first_mode: usize,
    /// Place of the first phase in the block of constants.
    pub first_phase: usize,
    /// Place of the first held value in the block of constants.
    pub first_memory: usize,
    /// What tables are numbered by.
    pub tables: &'a [Table],
    /// And those of two arguments.
    pub tables_2d: &'a [Table2d],
    /// The language.
    pub dialect: &'a dyn Dialect,
}

/// The printing of one function.
struct Writer<'a> {
    of: &'a Bodies<'a>,
    scope: Scope<'a>,
    indent: &'a str,
    lines: String,
    pieces: HashMap<Id, Piece>,
    /// Constants that have their variable: each gets it right before its first use, since all at once would take registers
    /// that the first statements need (2 % of a chain's accelerations).
    bound: HashSet<usize>,
    /// The sine and the cosine that are wanted of each argument.
    turns: HashMap<Id, [Option<Id>; 2]>,
}

impl Bodies<'_> {
    /// The statements that compute and use these values, symbols bound first.
    pub fn body(&self, uses: &[Use], indent: &str) -> Body {
        let roots: Vec<Id> = uses.iter().flat_map(Use::values).collect();
        let needed = self.needed(&roots);
        let counts = self.counts(&needed, &roots);
        let mut due: HashMap<usize, Vec<&Use>> = HashMap::default();
        for item in uses {
            let at = item.values().iter().map(|id| id.index()).max().unwrap_or(0);
            due.entry(at).or_default().push(item);
        }
        let (lines, reads) = self.bindings(&needed, indent);
        let (scope, pieces, turns) = (self.names.scope.inside(), HashMap::default(), self.turns(&needed));
        let mut writer = Writer { of: self, scope, indent, lines, pieces, bound: HashSet::default(), turns };
        for i in (0..needed.len()).filter(|&i| needed[i]) {
            let id = self.graph.id_at(i);
            let uses = due.get(&i).map_or(&[][..], Vec::as_slice);
            let stored = uses.iter().any(|u| matches!(u, Use::Pivot(..)));
            if !writer.pieces.contains_key(&id) {
                writer.compute(id, counts[i] == 1 && !stored);
            }
            for item in uses {
                writer.use_up(item);
            }
        }
        Body { lines: writer.lines, reads }
    }

    /// Nodes to print: reachable without looking inside hoisted ones.
    fn needed(&self, roots: &[Id]) -> Vec<bool> {
        let mut needed = vec![false; self.graph.len()];
        for root in roots {
            needed[root.index()] = true;
        }
        for i in (0..needed.len()).rev().filter(|&i| i < self.graph.len()) {
            let id = self.graph.id_at(i);
            if needed[i] && !self.hoisted.contains_key(&id) {
                for child in self.graph.children(id) {
                    needed[child.index()] = true;
                }
            }
        }
        needed
    }

    fn counts(&self, needed: &[bool], roots: &[Id]) -> Vec<u32> {
        let mut counts = vec![0; needed.len()];
        for root in roots {
            counts[root.index()] += 1;
        }
        for i in (0..needed.len()).filter(|&i| needed[i]) {
            let id = self.graph.id_at(i);
            if !self.hoisted.contains_key(&id) {
                for child in self.graph.children(id) {
                    counts[child.index()] += 1;
                }
            }
        }
        counts
    }

    /// Wanted sines and cosines by their argument, which come from one call.
    fn turns(&self, needed: &[bool]) -> HashMap<Id, [Option<Id>; 2]> {
        let mut turns: HashMap<Id, [Option<Id>; 2]> = HashMap::default();
        for id in (0..needed.len()).filter(|&i| needed[i]).map(|i| self.graph.id_at(i)) {
            match self.graph.node(id) {
                _ if self.hoisted.contains_key(&id) => {}
                Node::Unary(Unary::Sin, x) => turns.entry(x).or_default()[0] = Some(id),
                Node::Unary(Unary::Cos, x) => turns.entry(x).or_default()[1] = Some(id),
                _ => {}
            }
        }
        turns
    }

    /// Where a symbol stands in the block of constants.
    fn place(&self, symbol: Symbol) -> Option<usize> {
        match symbol {
            Symbol::Parameter(i) => Some(i as usize),
            Symbol::Mode(k) => Some(self.first_mode + k as usize),
            Symbol::Phase(k) => Some(self.first_phase + k as usize),
            Symbol::Memory(j) => Some(self.first_memory + j as usize),
            _ => None,
        }
    }

    /// Variables for entries of the state that are used; and all that is read.
    fn bindings(&self, needed: &[bool], indent: &str) -> (String, Reads) {
        let n = self.names.coordinates.len();
        let mut lists = vec![vec![None; n], vec![None; n], vec![None; n], vec![None; self.names.multipliers.len()]];
        let mut reads = Reads::default();
        for id in (0..needed.len()).filter(|&i| needed[i]).map(|i| self.graph.id_at(i)) {
            if self.hoisted.contains_key(&id) {
                reads.constants = true;
                continue;
            }
            let Node::Symbol(symbol) = self.graph.node(id) else { continue };
            let (order, k) = match symbol {
                Symbol::Coordinate(k) => (0, k),
                Symbol::Speed(k) => (1, k),
                Symbol::Acceleration(k) => (2, k),
                Symbol::Time => {
                    reads.time = true;
                    continue;
                }
                Symbol::Input(..) => {
                    reads.inputs = true;
                    continue;
                }
                Symbol::Multiplier(k) => (3, k),
                Symbol::Parameter(_) | Symbol::Mode(_) | Symbol::Phase(_) | Symbol::Memory(_) => {
                    reads.constants = true;
                    continue;
                }
                Symbol::Dummy(_) => {
                    reads.along = true;
                    continue;
                }
                Symbol::Reaction(_) | Symbol::State(_) | Symbol::StateRate(_) => continue,
            };
            let names = &self.names;
            let name = if order == 3 { &names.multipliers[k as usize] } else { &names.coordinates[k as usize][order] };
            lists[order][k as usize] = Some(name.as_str());
        }
        let mut lines = String::new();
        for (order, (list, array)) in lists.into_iter().zip(["q", "v", "a", "l"]).enumerate() {
            if list.iter().any(Option::is_some) {
                reads.state[order] = true;
                let _ = writeln!(lines, "{indent}{}", self.dialect.unpack(&list, array));
            }
        }
        (lines, reads)
    }

    fn symbol(&self, symbol: Symbol) -> String {
        let coordinate = |i: u32, order: usize| self.names.coordinates[i as usize][order].clone();
        match symbol {
            Symbol::Time => "t".to_owned(),
            Symbol::Coordinate(i) => coordinate(i, 0),
            Symbol::Speed(i) => coordinate(i, 1),
            Symbol::Acceleration(i) => coordinate(i, 2),
            Symbol::Input(k, order) => format!("u[{}]", 3 * k + u32::from(order)),
            Symbol::Multiplier(k) => self.names.multipliers[k as usize].clone(),
            // No other bound variable is left in what is printed.
            Symbol::Dummy(k) => format!("along[{k}]"),
            // Derivations leave neither reactions nor symbols of states in what is printed.
            _ => self.dialect.number(Number::Exact(Rational::ZERO)),
        }
    }
}

impl Writer<'_> {
    /// Makes the piece for a node: nested into its only consumer, or a variable.
    fn compute(&mut self, id: Id, single: bool) {
        let piece = self.piece(id);
        let leaf = self.of.hoisted.contains_key(&id)
            || matches!(self.of.graph.node(id), Node::Number(_) | Node::Symbol(_))
            || piece.level == Level::Atom && piece.depth == 0;
        let piece = if leaf || single && piece.depth < NESTING {
            piece
        } else {
            let name = self.scope.temporary();
            self.bind(&piece.constants);
            let _ = writeln!(self.lines, "{}{}", self.indent, self.of.dialect.declare(&[&name], &[piece.text]));
            Piece::atom(name)
        };
        self.pieces.insert(id, piece);
    }

    /// Variables for those constants that have none yet.
    fn bind(&mut self, constants: &[usize]) {
        let new: Vec<usize> = constants.iter().copied().filter(|place| self.bound.insert(*place)).collect();
        let names: Vec<&str> = new.iter().map(|place| self.of.names.constants[*place].as_str()).collect();
        let values: Vec<String> = new.iter().map(|place| format!("c[{place}]")).collect();
        if !names.is_empty() {
            let _ = writeln!(self.lines, "{}{}", self.indent, self.of.dialect.declare(&names, &values));
        }
    }

    fn use_up(&mut self, item: &Use) {
        let indent = self.indent;
        let constants: Vec<usize> = item.values().iter().flat_map(|id| self.pieces[id].constants.clone()).collect();
        self.bind(&constants);
        let _ = match item {
            Use::Store(target, id) => writeln!(self.lines, "{indent}{target} = {};", self.pieces[id].text),
            Use::Pivot(coordinate, pivot, diagonal) => {
                let [pivot, diagonal] = [pivot, diagonal].map(|id| &self.pieces[id]);
                writeln!(self.lines, "{}", self.of.dialect.pivot(*coordinate, [pivot, diagonal], indent))
            }
        };
    }

    fn constant(&self, place: usize) -> Piece {
        Piece { constants: vec![place], ..Piece::atom(self.of.names.constants[place].clone()) }
    }

    fn piece(&mut self, id: Id) -> Piece {
        if let Some(place) = self.of.hoisted.get(&id) {
            return self.constant(*place);
        }
        match self.of.graph.node(id) {
            Node::Number(place) => Piece::atom(self.of.dialect.number(self.of.graph.number_at(place))),
            Node::Symbol(s) => match self.of.place(s) {
                Some(place) => self.constant(place),
                None => Piece::atom(self.of.symbol(s)),
            },
            Node::Unary(Unary::Sin | Unary::Cos, x) => self.sine_and_cosine(id, x),
            Node::Unary(Unary::Neg, x) => {
                let inner = &self.pieces[&x];
                inner.inside(format!("-{}", inner.at_least(Level::Atom)), Level::Sign)
            }
            Node::Unary(Unary::Table(table), x) => {
                let inner = &self.pieces[&x];
                let place = self.of.tables.iter().position(|known| *known == table.whole()).unwrap_or(0);
                inner.inside(self.of.dialect.table(place, table.order(), inner), Level::Atom)
            }
            Node::Unary(f, x) => {
                let inner = &self.pieces[&x];
                inner.inside(self.of.dialect.unary(f, inner), Level::Atom)
            }
            Node::Binary(operation, x, y) => self.binary(operation, &self.pieces[&x], &self.pieces[&y]),
        }
    }

    /// Sine and cosine of one argument come from one call.
    fn sine_and_cosine(&mut self, id: Id, argument: Id) -> Piece {
        let angle = self.pieces[&argument].clone();
        self.bind(&angle.constants);
        let plain = angle.text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let name = if plain { angle.text.clone() } else { self.scope.temporary() };
        let (sine, cosine) = (joined("sin", &name), joined("cos", &name));
        let mut give = |wanted: &str, id: Option<Id>| {
            id.map(|id| {
                let name = self.scope.fresh(wanted);
                self.pieces.insert(id, Piece::atom(name.clone()));
                name
            })
        };
        let [s, c] = self.turns[&argument];
        let names = [give(&sine, s), give(&cosine, c)];
        let _ = writeln!(self.lines, "{}{}", self.indent, self.of.dialect.turn(&names, &angle));
        self.pieces[&id].clone()
    }

    fn binary(&self, operation: Binary, a: &Piece, b: &Piece) -> Piece {
        let made = |text: String, level: Level| {
            let constants = a.constants.iter().chain(&b.constants).copied().collect();
            Piece { text, level, depth: a.depth.max(b.depth) + 1, constants }
        };
        let (sign, level, right) = match operation {
            Binary::Add => (" + ", Level::Sum, Level::Product),
            Binary::Sub => (" - ", Level::Sum, Level::Product),
            Binary::Mul => (" * ", Level::Product, Level::Sign),
            Binary::Div => (" / ", Level::Product, Level::Sign),
            Binary::Pow | Binary::Atan2 | Binary::Min | Binary::Max => {
                return made(self.of.dialect.binary(operation, a, b), Level::Atom);
            }
            Binary::Normal(key) => return made(self.of.dialect.normal(key, a, b), Level::Atom),
            Binary::Table(table) => {
                let place = self.of.tables_2d.iter().position(|known| *known == table.whole()).unwrap_or(0);
                return made(self.of.dialect.table_2d(place, table, a, b), Level::Atom);
            }
        };
        made(format!("{}{sign}{}", a.at_least(level), b.at_least(right)), level)
    }
}
