//! Expressions as text in the model language.

use super::Model;
use super::resolved::HIDDEN;
use crate::expr::{Binary, DoubleDouble, Graph, Id, Node, Number, Symbol, Unary};

/// An expression as a person would write it; parts beyond some 200 nodes become `…`.
pub fn text(model: &Model, root: Id) -> String {
    text_in(&model.graph, model, root)
}

/// The same for an expression of another graph with the model's symbols.
pub(crate) fn text_in(graph: &Graph, model: &Model, root: Id) -> String {
    let mut budget = 200;
    written(model, graph, root, &mut budget).0
}

/// How tightly an expression holds together.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Level {
    Sum,
    Product,
    Power,
    Atom,
}

fn written(model: &Model, graph: &Graph, id: Id, budget: &mut usize) -> (String, Level) {
    if *budget == 0 {
        return ("…".to_owned(), Level::Atom);
    }
    *budget -= 1;
    let one_sided = one_sided(graph, id);
    let mut at = |x: Id, level: Level| {
        let (text, own) = written(model, graph, x, budget);
        if own < level { format!("({text})") } else { text }
    };
    if let Some((function, x)) = one_sided {
        return (format!("{function}{})", at(x, Level::Sum)), Level::Atom);
    }
    match graph.node(id) {
        Node::Number(place) => number(graph.number_at(place)),
        Node::Symbol(s) => (symbol_text(model, s), Level::Atom),
        Node::Unary(Unary::Neg, x) => (format!("-{}", at(x, Level::Product)), Level::Sum),
        Node::Unary(f, x) => (format!("{}({})", f.name(), at(x, Level::Sum)), Level::Atom),
        Node::Binary(Binary::Add, x, y) => (format!("{} + {}", at(x, Level::Sum), at(y, Level::Sum)), Level::Sum),
        Node::Binary(Binary::Sub, x, y) => (format!("{} - {}", at(x, Level::Sum), at(y, Level::Product)), Level::Sum),
        Node::Binary(Binary::Mul, x, y) if x == y => (format!("{}^2", at(x, Level::Atom)), Level::Power),
        Node::Binary(Binary::Mul, x, y) => {
            (format!("{}*{}", at(x, Level::Product), at(y, Level::Product)), Level::Product)
        }
        Node::Binary(Binary::Div, x, y) => {
            (format!("{}/{}", at(x, Level::Product), at(y, Level::Power)), Level::Product)
        }
        Node::Binary(Binary::Pow, x, y) => (format!("{}^{}", at(x, Level::Atom), at(y, Level::Atom)), Level::Power),
        Node::Binary(f, x, y) => {
            let name = match f {
                Binary::Atan2 => "atan2",
                Binary::Min => "min",
                Binary::Table(table) => table.name(),
                Binary::Normal(_) => "normal",
                _ => "max",
            };
            (format!("{name}({}, {})", at(x, Level::Sum), at(y, Level::Sum)), Level::Atom)
        }
    }
}

/// `x*sign(x)` as `abs(x)`, `x*step(x)` as `max(0, x)`: the beginning of the call and its argument.
fn one_sided(graph: &Graph, id: Id) -> Option<(&'static str, Id)> {
    let Node::Binary(Binary::Mul, x, y) = graph.node(id) else { return None };
    [(x, y), (y, x)].into_iter().find_map(|(x, side)| match graph.node(side) {
        Node::Unary(Unary::Sign, of) if of == x => Some(("abs(", x)),
        Node::Unary(Unary::Step, of) if of == x => Some(("max(0, ", x)),
        _ => None,
    })
}

fn number(number: Number) -> (String, Level) {
    let level = match number {
        _ if number.to_f64() < 0.0 => Level::Sum,
        Number::Exact(r) if r.denominator() != 1 => Level::Product,
        _ => Level::Atom,
    };
    (number_text(number), level)
}

/// A number as the model language reads it: `1/2`, `pi`, `6.02e23`.
pub fn number_text(number: Number) -> String {
    match number {
        Number::Exact(r) if r.denominator() == 1 => r.numerator().to_string(),
        Number::Exact(r) => format!("{}/{}", r.numerator(), r.denominator()),
        Number::Float(x) if x == DoubleDouble::PI => "pi".to_owned(),
        Number::Float(x) => {
            let (x, size) = (x.to_f64(), x.to_f64().abs());
            if x == 0.0 || (1e-4..1e7).contains(&size) { x.to_string() } else { format!("{x:e}") }
        }
    }
}

/// A symbol by its name in the file: `theta'`.
pub fn symbol_text(model: &Model, symbol: Symbol) -> String {
    let name = |name: Option<&str>| name.unwrap_or("?").to_owned();
    let coordinate = |i: u32| name(model.coordinates.get(i as usize).map(|c| c.name.as_str()));
    match symbol {
        Symbol::Time => "t".to_owned(),
        Symbol::Coordinate(i) => coordinate(i),
        Symbol::Speed(i) => rate_name(&coordinate(i), 1),
        Symbol::Acceleration(i) => rate_name(&coordinate(i), 2),
        Symbol::State(j) => name(model.states.get(j as usize).map(|z| z.name.as_str())),
        Symbol::StateRate(j) => format!("{}'", name(model.states.get(j as usize).map(|z| z.name.as_str()))),
        Symbol::Memory(j) => name(model.memory.get(j as usize).map(|held| held.name.as_str())),
        Symbol::Input(k, order) => {
            let primes = "'".repeat(usize::from(order));
            format!("{}{primes}", name(model.inputs.get(k as usize).map(|u| u.name.as_str())))
        }
        Symbol::Parameter(i) => name(model.parameters.get(i as usize).map(|p| p.name.as_str())),
        Symbol::Mode(k) => format!("mode{k}"),
        Symbol::Reaction(k) => format!("reaction{k}"),
        Symbol::Multiplier(k) => multiplier(model, k as usize),
        Symbol::Phase(k) => format!("(in {})", name(model.phases.get(k as usize).map(|phase| phase.name.as_str()))),
        Symbol::Dummy(_) => "length".to_owned(),
    }
}

/// A rate of a coordinate by its name in the file: `theta'`, `theta''`; that of the hidden coordinate of a state `i` is `i`, `i'`.
pub fn rate_name(coordinate: &str, order: usize) -> String {
    match coordinate.strip_prefix(HIDDEN) {
        Some(state) => format!("{state}{}", "'".repeat(order.saturating_sub(1))),
        None => format!("{coordinate}{}", "'".repeat(order)),
    }
}

/// `reaction(pin).x`.
pub(super) fn multiplier(model: &Model, row: usize) -> String {
    let name = model.row_name(row);
    match name.split_once('.') {
        Some((constraint, axis)) => format!("reaction({constraint}).{axis}"),
        None => format!("reaction({name})"),
    }
}
