//! Expressions as a person reads them: sums and products as wholes, powers, one fraction line, and names for long parts
//! that stand in several places.

mod latex;
mod python;
mod text;

use std::collections::BTreeSet;
use std::rc::Rc;

use rustc_hash::FxHashMap as HashMap;

use crate::expr::{Binary, Graph, Id, Node, Number, Symbol, Table, Table2d, Unary, factors, terms};

pub(super) use latex::Latex;
pub(super) use python::Python;
pub(super) use text::Text;

/// What a person reads.
#[derive(Clone, Debug)]
pub(super) enum Formula {
    /// A constant that is not negative.
    Number(Number),
    /// A leaf.
    Symbol(Symbol),
    /// A part that has a name, by its place in [`Formulas::parts`].
    Part(usize),
    /// Terms with their signs (true: subtracted).
    Sum(Vec<(bool, Rc<Formula>)>),
    /// A number that is not negative, and powers above and below the line, with twice their exponents.
    Product(Number, Vec<Power>, Vec<Power>),
    /// A function.
    Call(&'static str, Vec<Rc<Formula>>),
    /// A table of the model, or a derivative of it.
    Table(Table, Rc<Formula>),
    /// A table of two arguments, or a derivative of it.
    Table2d(Table2d, [Rc<Formula>; 2]),
}

/// A base with twice its exponent, which is positive.
#[derive(Clone, Debug)]
pub(super) struct Power {
    /// The base.
    pub base: Rc<Formula>,
    /// Twice the exponent.
    pub halves: i32,
}

/// Some expressions, and the parts that they share.
#[derive(Clone, Debug, Default)]
pub(super) struct Formulas {
    /// Named parts, each of parts before it.
    pub parts: Vec<Rc<Formula>>,
    /// The expressions themselves.
    pub roots: Vec<(bool, Rc<Formula>)>,
}

/// A sum with as many leaves that stands in several places gets a name, and anything else with twice as many.
const LONG: usize = 4;
/// Twice the exponent up to which powers of numbers are written as numbers.
const COMPUTED: i32 = 16;
/// What is nested deeper gets one too.
const DEEP: usize = 24;
/// And what stands in something else with more leaves: about as many as fit into two lines of a page.
const WIDE: usize = 40;

impl Formulas {
    /// Of expressions without modes.
    pub fn new(graph: &Graph, roots: &[Id]) -> Formulas {
        let (order, uses) = needed(graph, roots);
        let mut written = Writing { known: HashMap::default(), parts: Vec::new() };
        for id in order {
            let formula = written.formula(graph, id);
            if uses[&id] == 1 && roots.contains(&id) {
                written.known.insert(id, formula);
            } else {
                written.keep(id, formula, uses[&id]);
            }
        }
        let roots = roots.iter().map(|root| written.known[root].signed()).collect();
        Formulas { parts: written.parts, roots }
    }

    /// Of one expression, with no names for parts; `None` where it has more leaves than these.
    pub fn whole(graph: &Graph, root: Id, longest: usize) -> Option<(bool, Rc<Formula>)> {
        let mut written = Writing { known: HashMap::default(), parts: Vec::new() };
        for id in needed(graph, &[root]).0 {
            let formula = written.formula(graph, id);
            if formula.leaves > longest {
                return None;
            }
            written.known.insert(id, formula);
        }
        Some(written.known[&root].signed())
    }
}

/// What has to be written by itself, parts before wholes, and how often each stands in something else.
fn needed(graph: &Graph, roots: &[Id]) -> (Vec<Id>, HashMap<Id, usize>) {
    let mut open: BTreeSet<Id> = roots.iter().copied().collect();
    let mut uses: HashMap<Id, usize> = open.iter().map(|id| (*id, 1)).collect();
    let mut order = Vec::new();
    // Parents have larger places than children, so taking the largest first meets each once.
    while let Some(id) = open.pop_last() {
        order.push(id);
        for part in parts(graph, id) {
            *uses.entry(part).or_default() += 1;
            open.insert(part);
        }
    }
    order.reverse();
    (order, uses)
}

fn parts(graph: &Graph, id: Id) -> Vec<Id> {
    if is_sum(graph, id) {
        return terms(graph, id).into_iter().map(|(term, _)| term).collect();
    }
    match graph.node(id) {
        Node::Binary(Binary::Mul | Binary::Div, ..) | Node::Unary(Unary::Neg | Unary::Sqrt, _) => {
            factors_of(graph, id).into_iter().map(|(base, _)| base).collect()
        }
        _ => graph.children(id).collect(),
    }
}

/// The factors of a product with twice their exponents; of a root that no product takes apart, since it may be of almost nothing (the
/// length in `unit`), what it is of.
fn factors_of(graph: &Graph, id: Id) -> Vec<(Id, i32)> {
    let factors = factors(graph, id);
    match graph.node(id) {
        Node::Unary(Unary::Sqrt, x) if factors == [(id, 2)] => vec![(x, 1)],
        _ => factors,
    }
}

fn is_sum(graph: &Graph, id: Id) -> bool {
    matches!(graph.node(id), Node::Binary(Binary::Add | Binary::Sub, ..))
}

/// A formula with its sign and its size.
#[derive(Clone)]
struct Written {
    negative: bool,
    formula: Rc<Formula>,
    leaves: usize,
    depth: usize,
    motion: Motion,
}

/// What a term contains of the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Motion {
    /// Second rates.
    Second,
    /// Rates.
    First,
    /// Coordinates, inputs, what acts or not.
    Place,
    /// Time alone.
    Time,
    /// Parameters and numbers.
    Constant,
}

impl Motion {
    fn of(symbol: Symbol) -> Motion {
        match symbol {
            Symbol::Acceleration(_) | Symbol::Input(_, 2..) => Motion::Second,
            Symbol::Speed(_) | Symbol::Input(_, 1) => Motion::First,
            Symbol::Parameter(_) => Motion::Constant,
            Symbol::Time => Motion::Time,
            _ => Motion::Place,
        }
    }

    /// In sums second rates come first, then rates, and time alone last; constants and places stand as they are met, L + R φ.
    fn place_in_sums(self) -> Motion {
        if self == Motion::Constant { Motion::Place } else { self }
    }
}

impl Written {
    fn signed(&self) -> (bool, Rc<Formula>) {
        (self.negative, self.formula.clone())
    }
}

struct Writing {
    known: HashMap<Id, Written>,
    parts: Vec<Rc<Formula>>,
}

impl Writing {
    /// Remembers a formula that stands in others, by a name where it is long and stands in several places, or very long.
    fn keep(&mut self, id: Id, mut written: Written, uses: usize) {
        let composed = !matches!(*written.formula, Formula::Number(_) | Formula::Symbol(_));
        let long = if matches!(*written.formula, Formula::Sum(_)) { LONG } else { 2 * LONG };
        let nested = written.depth > DEEP || written.leaves > WIDE;
        if composed && (nested || uses > 1 && written.leaves >= long) {
            self.parts.push(written.formula);
            written.formula = Rc::new(Formula::Part(self.parts.len() - 1));
            (written.leaves, written.depth) = (1, 0);
        }
        self.known.insert(id, written);
    }

    fn formula(&self, graph: &Graph, id: Id) -> Written {
        if is_sum(graph, id) {
            return self.sum(graph, id);
        }
        let inner: Vec<&Written> = parts(graph, id).iter().map(|part| &self.known[part]).collect();
        let leaves = inner.iter().map(|part| part.leaves).sum::<usize>().max(1);
        let depth = inner.iter().map(|part| part.depth + 1).max().unwrap_or(0);
        let motion = match graph.node(id) {
            Node::Symbol(symbol) => Motion::of(symbol),
            _ => inner.iter().map(|part| part.motion).min().unwrap_or(Motion::Constant),
        };
        let (negative, formula) = match graph.node(id) {
            Node::Number(place) => {
                let number = graph.number_at(place);
                (number.to_f64() < 0.0, Formula::Number(number.abs()))
            }
            Node::Symbol(symbol) => (false, Formula::Symbol(symbol)),
            Node::Binary(Binary::Mul | Binary::Div, ..) | Node::Unary(Unary::Neg | Unary::Sqrt, _) => {
                self.product(graph, id)
            }
            Node::Binary(Binary::Pow, x, y) => (false, Formula::Call("^", vec![self.whole(x), self.whole(y)])),
            Node::Unary(Unary::Table(table), x) => (false, Formula::Table(table, self.whole(x))),
            Node::Unary(function, x) => (false, Formula::Call(function.name(), vec![self.whole(x)])),
            Node::Binary(Binary::Table(table), x, y) => {
                (false, Formula::Table2d(table, [x, y].map(|argument| self.whole(argument))))
            }
            Node::Binary(function, x, y) => {
                let name = match function {
                    Binary::Atan2 => "atan2",
                    Binary::Min => "min",
                    Binary::Normal(_) => "normal",
                    _ => "max",
                };
                (false, Formula::Call(name, vec![self.whole(x), self.whole(y)]))
            }
        };
        Written { negative, formula: Rc::new(formula), leaves, depth, motion }
    }

    /// With its sign inside.
    fn whole(&self, id: Id) -> Rc<Formula> {
        let (negative, formula) = self.known[&id].signed();
        if negative { Rc::new(Formula::Sum(vec![(true, formula)])) } else { formula }
    }

    fn sum(&self, graph: &Graph, id: Id) -> Written {
        let (mut leaves, mut depth) = (0, 0);
        let mut list: Vec<(bool, Rc<Formula>)> = Vec::new();
        // As a person writes them, c x' + k x.
        let mut terms = terms(graph, id);
        terms.sort_by_key(|(term, _)| self.known[term].motion.place_in_sums());
        let motion = terms.iter().map(|(term, _)| self.known[term].motion).min().unwrap_or(Motion::Constant);
        for (term, coefficient) in terms {
            let part = &self.known[&term];
            leaves += part.leaves;
            depth = depth.max(part.depth + 1);
            let negative = part.negative != (coefficient.to_f64() < 0.0);
            list.push((negative, times(&part.formula, coefficient.abs())));
        }
        // A sum begins with what is added, where there is such a term.
        if let Some(first) = list.iter().position(|(negative, _)| !negative) {
            list[..=first].rotate_right(1);
        }
        let all_negative = !list.is_empty() && list.iter().all(|(negative, _)| *negative);
        if all_negative {
            list.iter_mut().for_each(|(negative, _)| *negative = false);
        }
        let formula = match list.len() {
            // Terms that cancel.
            0 => Rc::new(Formula::Number(Number::ZERO)),
            1 => list.remove(0).1,
            _ => Rc::new(Formula::Sum(list)),
        };
        Written { negative: all_negative, formula, leaves, depth, motion }
    }

    fn product(&self, graph: &Graph, id: Id) -> (bool, Formula) {
        let (mut negative, mut number) = (false, Number::ONE);
        let (mut above, mut below) = (Vec::new(), Vec::new());
        for (base, halves) in factors_of(graph, id) {
            let part = &self.known[&base];
            negative ^= part.negative && halves % 4 != 0;
            // Of an odd power the sign stays inside.
            let formula = if part.negative && halves % 2 != 0 { self.whole(base) } else { part.formula.clone() };
            match &*formula {
                Formula::Number(value) if halves > 0 && halves % 2 == 0 && halves <= COMPUTED => {
                    number = (0..halves / 2).fold(number, |product, _| product.times(*value));
                }
                Formula::Number(value) if halves == -2 && value.to_f64() != 0.0 => number = number.times(value.recip()),
                _ => {
                    let side = if halves > 0 { &mut above } else { &mut below };
                    side.push(Power { base: formula, halves: halves.abs() });
                }
            }
        }
        if let [Power { base, halves: 2 }] = &above[..]
            && below.is_empty()
        {
            return (negative, (*times(base, number)).clone());
        }
        for side in [&mut above, &mut below] {
            side.sort_by_key(|power| rank(&power.base));
        }
        (negative, Formula::Product(number, above, below))
    }
}

/// A formula times a number that is not negative.
fn times(formula: &Rc<Formula>, number: Number) -> Rc<Formula> {
    match &**formula {
        _ if number.bits() == Number::ONE.bits() => formula.clone(),
        Formula::Number(value) => Rc::new(Formula::Number(value.times(number))),
        Formula::Product(value, above, below) => {
            Rc::new(Formula::Product(value.times(number), above.clone(), below.clone()))
        }
        _ => {
            let power = Power { base: formula.clone(), halves: 2 };
            Rc::new(Formula::Product(number, vec![power], Vec::new()))
        }
    }
}

/// How tightly text holds together.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
pub(super) enum Level {
    Sum,
    Product,
    Power,
    Atom,
}

/// A notation on one line.
pub(super) trait Notation {
    /// A formula, and how tightly it holds together.
    fn written(&self, formula: &Formula) -> (String, Level);

    /// In parentheses where it holds together less.
    fn at(&self, formula: &Formula, level: Level) -> String {
        let (text, own) = self.written(formula);
        if own < level { format!("({text})") } else { text }
    }

    /// A formula with its sign.
    fn signed(&self, negative: bool, formula: &Formula) -> String {
        if negative { format!("-{}", self.at(formula, Level::Product)) } else { self.written(formula).0 }
    }

    /// Formulas with commas.
    fn list(&self, formulas: &[Rc<Formula>]) -> String {
        formulas.iter().map(|formula| self.written(formula).0).collect::<Vec<_>>().join(", ")
    }
}

/// Terms with their signs between them, each as `term` writes it.
fn sum(terms: &[(bool, Rc<Formula>)], term: impl Fn(&Formula) -> String) -> String {
    let signs = terms.iter().enumerate().map(|(i, (negative, _))| match (i, negative) {
        (0, false) => "",
        (0, true) => "-",
        (_, false) => " + ",
        (_, true) => " - ",
    });
    signs.zip(terms).map(|(sign, (_, formula))| format!("{sign}{}", term(formula))).collect()
}

/// Factors are written in this order: parameters as the file declares them, coordinates, speeds, functions, sums.
fn rank(formula: &Formula) -> (u8, u32) {
    match formula {
        Formula::Symbol(Symbol::Parameter(k)) => (0, *k),
        Formula::Symbol(Symbol::Coordinate(k)) => (2, *k),
        Formula::Symbol(Symbol::Speed(k)) => (3, *k),
        Formula::Symbol(Symbol::Acceleration(k)) => (4, *k),
        Formula::Number(_) | Formula::Symbol(_) => (1, 0),
        Formula::Part(k) => (5, *k as u32),
        Formula::Call(..) | Formula::Table(..) | Formula::Table2d(..) | Formula::Product(..) => (6, 0),
        Formula::Sum(_) => (7, 0),
    }
}
