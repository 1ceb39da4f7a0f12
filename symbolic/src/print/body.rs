//! One straight-line function body.
//!
//! Nodes used once are nested into their consumer (to a depth of 8), all others become a `let`, in the
//! order of their creation; each result is stored right where it is computed, because stores collected at
//! the end of a function send LLVM's SLP vectoriser off for minutes.

use rustc_hash::FxHashMap as HashMap;
use std::fmt::Write;

use super::names::Locals;
use crate::expr::{Binary, Graph, Id, Node, Number, Symbol, Unary};

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

/// Deepest nesting of one expression.
const NESTING: u8 = 8;

/// Prints bodies of functions of one program.
pub(super) struct Bodies<'a> {
    pub graph: &'a Graph,
    pub locals: &'a Locals,
    /// Places of hoisted expressions in the block of constants.
    pub hoisted: &'a HashMap<Id, usize>,
    /// Place of the first mode in the block of constants.
    pub first_mode: usize,
}

#[derive(Clone)]
struct Piece {
    text: String,
    level: Level,
    depth: u8,
}

#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Level {
    Sum,
    Product,
    Sign,
    Atom,
}

impl Bodies<'_> {
    /// The statements that compute and use these values, symbols bound first.
    pub fn body(&self, uses: &[Use], indent: &str) -> String {
        let graph = self.graph;
        let roots: Vec<Id> = uses.iter().flat_map(Use::values).collect();
        let needed = self.needed(&roots);
        let counts = self.counts(&needed, &roots);
        let mut due: HashMap<usize, Vec<&Use>> = HashMap::default();
        for item in uses {
            let at = item.values().iter().map(|id| id.index()).max().unwrap_or(0);
            due.entry(at).or_default().push(item);
        }
        let mut lines = self.bindings(&needed, indent);
        let mut pieces: HashMap<Id, Piece> = HashMap::default();
        let mut next = 0;
        for i in (0..needed.len()).filter(|&i| needed[i]) {
            let id = graph.id_at(i);
            let stored = due.get(&i).is_some_and(|list| list.iter().any(|u| matches!(u, Use::Pivot(..))));
            if !pieces.contains_key(&id) {
                let piece = self.piece(id, &mut pieces, &mut lines, &mut next, &needed, indent);
                let single = counts[i] == 1 && piece.depth < NESTING && !stored;
                let piece = if single || self.is_leaf(id) || piece.level == Level::Atom && piece.depth == 0 {
                    piece
                } else {
                    next += 1;
                    let name = format!("{}{next}", self.locals.prefix);
                    let _ = writeln!(lines, "{indent}let {name} = {};", piece.text);
                    atom(name)
                };
                pieces.insert(id, piece);
            }
            for item in due.get(&i).into_iter().flatten() {
                match item {
                    Use::Store(target, _) => {
                        let _ = writeln!(lines, "{indent}{target} = {};", pieces[&id].text);
                    }
                    Use::Pivot(coordinate, pivot, diagonal) => {
                        let (pivot, diagonal) = (&pieces[pivot], &pieces[diagonal]);
                        let _ = writeln!(
                            lines,
                            "{indent}if !{}.abs().exceeds({}.abs() * S::pivot_floor()) {{\n{indent}    return Err(::dalembert::mechanism::SingularMass {{ coordinate: {coordinate} }});\n{indent}}}",
                            at_least(pivot, Level::Atom),
                            at_least(diagonal, Level::Atom),
                        );
                    }
                }
            }
        }
        lines
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

    /// `let &[theta1, theta2] = q;` and the like, for what is used.
    fn bindings(&self, needed: &[bool], indent: &str) -> String {
        let n = self.locals.coordinates.len();
        let mut lists = vec![vec![None; n]; 3];
        for i in (0..needed.len()).filter(|&i| needed[i]) {
            let (order, k, suffix) = match self.graph.node(self.graph.id_at(i)) {
                Node::Symbol(Symbol::Coordinate(k)) => (0, k, ""),
                Node::Symbol(Symbol::Speed(k)) => (1, k, "_dot"),
                Node::Symbol(Symbol::Acceleration(k)) => (2, k, "_ddot"),
                _ => continue,
            };
            lists[order][k as usize] = Some(format!("{}{suffix}", self.locals.coordinates[k as usize]));
        }
        let mut lines = String::new();
        for (list, array) in lists.into_iter().zip(["q", "v", "a"]) {
            if list.iter().any(Option::is_some) {
                let names: Vec<String> = list.into_iter().map(|n| n.unwrap_or_else(|| "_".to_owned())).collect();
                let _ = writeln!(lines, "{indent}let &[{}] = {array};", names.join(", "));
            }
        }
        lines
    }

    fn is_leaf(&self, id: Id) -> bool {
        self.hoisted.contains_key(&id) || matches!(self.graph.node(id), Node::Number(_) | Node::Symbol(_))
    }

    fn piece(
        &self,
        id: Id,
        pieces: &mut HashMap<Id, Piece>,
        lines: &mut String,
        next: &mut usize,
        needed: &[bool],
        indent: &str,
    ) -> Piece {
        if let Some(place) = self.hoisted.get(&id) {
            return atom(format!("c[{place}]"));
        }
        match self.graph.node(id) {
            Node::Number(place) => literal(self.graph.number_at(place)),
            Node::Symbol(s) => atom(self.symbol(s)),
            Node::Unary(Unary::Sin | Unary::Cos, x) => self.sine_and_cosine(id, x, pieces, lines, next, needed, indent),
            Node::Unary(Unary::Neg, x) => {
                let inner = &pieces[&x];
                Piece { text: format!("-{}", at_least(inner, Level::Atom)), level: Level::Sign, depth: inner.depth + 1 }
            }
            Node::Unary(f, x) => {
                let inner = &pieces[&x];
                let text = format!("{}.{}()", at_least(inner, Level::Atom), f.name());
                Piece { text, level: Level::Atom, depth: inner.depth + 1 }
            }
            Node::Binary(operation, x, y) => {
                let (a, b) = (&pieces[&x], &pieces[&y]);
                let depth = a.depth.max(b.depth) + 1;
                let (sign, level, right) = match operation {
                    Binary::Add => (" + ", Level::Sum, Level::Product),
                    Binary::Sub => (" - ", Level::Sum, Level::Product),
                    Binary::Mul => (" * ", Level::Product, Level::Sign),
                    Binary::Div => (" / ", Level::Product, Level::Sign),
                    Binary::Pow | Binary::Atan2 | Binary::Min | Binary::Max => {
                        let name = match operation {
                            Binary::Pow => "powf",
                            Binary::Atan2 => "atan2",
                            Binary::Min => "min",
                            _ => "max",
                        };
                        let text = format!("{}.{name}({})", at_least(a, Level::Atom), b.text);
                        return Piece { text, level: Level::Atom, depth };
                    }
                };
                Piece { text: format!("{}{sign}{}", at_least(a, level), at_least(b, right)), level, depth }
            }
        }
    }

    /// Sine and cosine of one argument come from one call.
    #[expect(clippy::too_many_arguments, reason = "the state of one function's printing")]
    fn sine_and_cosine(
        &self,
        id: Id,
        argument: Id,
        pieces: &mut HashMap<Id, Piece>,
        lines: &mut String,
        next: &mut usize,
        needed: &[bool],
        indent: &str,
    ) -> Piece {
        let is = |i: usize, f: Unary| needed[i] && self.graph.node(self.graph.id_at(i)) == Node::Unary(f, argument);
        let find = |f: Unary| (argument.index()..needed.len()).find(|&i| is(i, f)).map(|i| self.graph.id_at(i));
        let (sine, cosine) = (find(Unary::Sin), find(Unary::Cos));
        let angle = pieces[&argument].clone();
        let plain = angle.text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let name = if plain {
            angle.text.clone()
        } else {
            *next += 1;
            format!("{}{next}", self.locals.prefix)
        };
        let receiver = at_least(&angle, Level::Atom);
        match (sine, cosine) {
            (Some(s), Some(c)) => {
                let _ = writeln!(lines, "{indent}let (sin_{name}, cos_{name}) = {receiver}.sin_cos();");
                pieces.insert(s, atom(format!("sin_{name}")));
                pieces.insert(c, atom(format!("cos_{name}")));
            }
            (Some(s), None) => {
                let _ = writeln!(lines, "{indent}let sin_{name} = {receiver}.sin_cos().0;");
                pieces.insert(s, atom(format!("sin_{name}")));
            }
            (_, c) => {
                let _ = writeln!(lines, "{indent}let cos_{name} = {receiver}.sin_cos().1;");
                pieces.insert(c.unwrap_or(id), atom(format!("cos_{name}")));
            }
        }
        pieces[&id].clone()
    }

    fn symbol(&self, symbol: Symbol) -> String {
        let coordinate = |i: u32| &self.locals.coordinates[i as usize];
        match symbol {
            Symbol::Time => "t".to_owned(),
            Symbol::Coordinate(i) => coordinate(i).clone(),
            Symbol::Speed(i) => format!("{}_dot", coordinate(i)),
            Symbol::Acceleration(i) => format!("{}_ddot", coordinate(i)),
            Symbol::Input(k, order) => format!("u[{}]", 3 * k + u32::from(order)),
            Symbol::Parameter(i) => format!("c[{i}]"),
            Symbol::Mode(k) => format!("c[{}]", self.first_mode + k as usize),
            Symbol::Reaction(_) | Symbol::Dummy(_) => "S::ratio(0.0, 1.0)".to_owned(),
        }
    }
}

fn atom(text: String) -> Piece {
    Piece { text, level: Level::Atom, depth: 0 }
}

fn at_least(piece: &Piece, level: Level) -> String {
    if piece.level < level { format!("({})", piece.text) } else { piece.text.clone() }
}

/// A constant of the scalar type, exact where a ratio of two floats is.
fn literal(number: Number) -> Piece {
    let exact = |n: i128| n.unsigned_abs() < 1 << 53;
    atom(match number {
        Number::Exact(r) if exact(r.numerator()) && exact(r.denominator()) => {
            format!("S::ratio({:?}, {:?})", r.numerator() as f64, r.denominator() as f64)
        }
        _ => format!("S::from_f64({})", float(number.to_f64())),
    })
}

/// A float as Rust text: a well-known constant by its name, any other by its shortest digits.
pub(super) fn float(x: f64) -> String {
    match CONSTANTS.iter().find(|(_, value)| *value == x.abs()) {
        Some((name, _)) => format!("{}::std::f64::consts::{name}", if x < 0.0 { "-" } else { "" }),
        None => format!("{x:?}"),
    }
}

/// Constants that are printed by name.
const CONSTANTS: &[(&str, f64)] = {
    use std::f64::consts as of;
    &[
        ("PI", of::PI),
        ("TAU", of::TAU),
        ("FRAC_PI_2", of::FRAC_PI_2),
        ("FRAC_PI_3", of::FRAC_PI_3),
        ("FRAC_PI_4", of::FRAC_PI_4),
        ("FRAC_PI_6", of::FRAC_PI_6),
        ("FRAC_PI_8", of::FRAC_PI_8),
        ("FRAC_1_PI", of::FRAC_1_PI),
        ("FRAC_2_PI", of::FRAC_2_PI),
        ("FRAC_2_SQRT_PI", of::FRAC_2_SQRT_PI),
        ("SQRT_2", of::SQRT_2),
        ("FRAC_1_SQRT_2", of::FRAC_1_SQRT_2),
        ("E", of::E),
        ("LN_2", of::LN_2),
        ("LN_10", of::LN_10),
        ("LOG2_E", of::LOG2_E),
        ("LOG2_10", of::LOG2_10),
        ("LOG10_E", of::LOG10_E),
        ("LOG10_2", of::LOG10_2),
    ]
};
