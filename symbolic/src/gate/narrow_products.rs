//! States at which all narrow factors of a product say something at once: a product is silent wherever one of them is.

use std::collections::BTreeSet;

use super::arguments::{Argument, argument, roots};
use super::between_knots::loudest;
use super::dense::solve;
use super::lines::{Line, Reach};
use super::listed;
use super::motion::Motion;
use super::near_switch::{ORDER_ONE, Sides};
use super::state::{Origin, State};
use crate::expr::{Binary, Graph, Id, Node, Symbol, Table, Unary};
use crate::model::Model;
use crate::number::DoubleDouble;

/// So many products of factors are looked at, and so many terms of the expanded form of one expression.
const PRODUCTS: usize = 64;
const TERMS: usize = 16;
/// So many states, those at which most factors speak, are starts of Newton's method.
const STARTS: usize = 12;
/// So many places of each factor are aimed at.
const PLACES: usize = 3;
/// So many products of nothing but steps are looked at, from so many starts: most of them are of sides that exclude each other.
const STEPS: usize = 8;
const STARTS_OF_STEPS: usize = 2;
/// By this part of what is missing a step is aimed at beyond its zero.
const BEYOND: f64 = 1e-3;
/// Iterations of Newton's method: the zero of a square comes nearer by a half in each.
const ITERATIONS: usize = 60;
/// Steps of its difference quotients (in double-double), and its longest step, in scales of each number.
const DIFFERENCE: f64 = 1e-10;
const LONGEST: f64 = 2.0;
/// What is added to the diagonal of its normalised matrix, so that dependent rows have a solution.
const REGULAR: f64 = 1e-12;

/// Where a factor says something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// `exp`, `tanh`: where the argument is of order one.
    Local,
    /// Between points of a table, or of one of a table's two arguments.
    Table(Table),
    /// `step`: where the argument is positive.
    Above,
}

/// The factors of one product.
type Factors = BTreeSet<(Id, Kind)>;

/// One factor, ready to evaluate, and the arguments at which it speaks, each with how near will do.
struct Factor {
    argument: Argument,
    kind: Kind,
    targets: Vec<(f64, f64)>,
}

impl Factor {
    fn new(model: &Model, (value, kind): (Id, Kind)) -> Factor {
        let targets = match kind {
            Kind::Local => vec![(0.0, ORDER_ONE)],
            Kind::Above => Vec::new(),
            Kind::Table(table) => loudest(table),
        };
        Factor { argument: argument(&model.graph, model, value, false), kind, targets }
    }

    /// The argument that is aimed at from one, the k-th of those at which the factor speaks.
    fn target(&self, k: usize, here: f64) -> Option<f64> {
        match self.kind {
            Kind::Above => Some(here.max(-BEYOND * here)),
            Kind::Local | Kind::Table(_) => Some(self.targets.get(k).or(self.targets.last())?.0),
        }
    }

    fn speaks(&self, motion: &Motion, state: &State) -> bool {
        let at = self.argument.at(motion, state);
        if self.kind == Kind::Above { at > 0.0 } else { self.targets.iter().any(|(x, near)| (at - x).abs() <= *near) }
    }
}

/// Adds a state for every product of narrow factors at which all of them speak, and names those for which none was found.
pub(super) fn products(model: &Model, motion: &Motion, bases: &[State], reach: &Reach<'_>, found: &mut Sides) {
    let (products, more) = factored(model);
    if more {
        found.unreached.push("some products of narrow functions were not looked at".to_owned());
    }
    for product in products {
        let of_steps = is_of_steps(&product);
        let factors: Vec<Factor> = product.into_iter().map(|factor| Factor::new(model, factor)).collect();
        let speaking = |state: &&State| factors.iter().filter(|factor| factor.speaks(motion, state)).count();
        let mut starts: Vec<&State> = found.states.iter().chain(bases).collect();
        starts.sort_by_cached_key(|state| std::cmp::Reverse(speaking(state)));
        if starts.first().is_some_and(|state| speaking(state) == factors.len()) {
            continue;
        }
        let search = Search { motion, reach, factors: &factors };
        let count = if of_steps { STARTS_OF_STEPS } else { STARTS };
        match starts.into_iter().take(count).find_map(|start| search.meet(start)) {
            Some(state) => found.states.push(state),
            None if of_steps => {}
            None => {
                let words: Vec<String> = factors.iter().map(|factor| format!("`{}`", factor.argument.words)).collect();
                let words = listed(&words);
                found.unreached.push(format!("no state was found at which functions of {words} act at once"));
            }
        }
    }
}

/// The search for a state at which all factors speak.
struct Search<'a> {
    motion: &'a Motion,
    reach: &'a Reach<'a>,
    factors: &'a [Factor],
}

impl Search<'_> {
    /// From one start: first by numbers on which no factor depends that speaks there, then by all.
    fn meet(&self, start: &State) -> Option<State> {
        let (speaking, silent): (Vec<&Factor>, Vec<&Factor>) =
            self.factors.iter().partition(|factor| factor.speaks(self.motion, start));
        let all: Vec<&Factor> = self.factors.iter().collect();
        let kept: BTreeSet<Symbol> = speaking.iter().flat_map(|f| f.argument.symbols.iter().copied()).collect();
        let of = |factors: &[&Factor], kept: &BTreeSet<Symbol>| {
            let symbols: BTreeSet<Symbol> = factors.iter().flat_map(|f| f.argument.symbols.iter().copied()).collect();
            self.reach.lines(&symbols.difference(kept).copied().collect::<Vec<_>>())
        };
        let ways = [(of(&silent, &kept), &silent), (of(&all, &BTreeSet::new()), &all)];
        let tries = ways.iter().flat_map(|way| (0..PLACES).map(move |k| (way, k)));
        tries.into_iter().find_map(|((lines, factors), k)| self.newton(start, lines, factors, k))
    }

    /// Newton's method for the arguments of some factors, by the shortest steps in scales of the numbers that change.
    fn newton(&self, start: &State, lines: &[Line<'_>], factors: &[&Factor], k: usize) -> Option<State> {
        let mut state = start.clone();
        for _ in 0..ITERATIONS {
            if self.factors.iter().all(|factor| factor.speaks(self.motion, &state)) {
                return Some(state);
            }
            let step = self.step(&state, lines, factors, k)?;
            let pairs: Vec<(&Line<'_>, f64)> = lines.iter().zip(step).collect();
            state = self.shifted(&state, &pairs);
        }
        None
    }

    /// One step, along each line.
    fn step(&self, state: &State, lines: &[Line<'_>], factors: &[&Factor], k: usize) -> Option<Vec<f64>> {
        let (mut rows, mut wanted) = (Vec::new(), Vec::new());
        let values = |state: &State| -> Vec<DoubleDouble> {
            factors.iter().map(|factor| factor.argument.exactly(self.motion, state)).collect()
        };
        let here = values(state);
        let beside: Vec<Vec<DoubleDouble>> =
            lines.iter().map(|line| values(&self.shifted(state, &[(line, DIFFERENCE * line.scale())]))).collect();
        for (i, factor) in factors.iter().enumerate() {
            let target = factor.target(k, here[i].to_f64())?;
            let row: Vec<f64> = beside.iter().map(|there| (there[i] - here[i]).to_f64() / DIFFERENCE).collect();
            let norm = row.iter().map(|x| x * x).sum::<f64>().sqrt();
            if norm == 0.0 || !norm.is_finite() {
                return None;
            }
            wanted.push((target - here[i].to_f64()) / norm);
            rows.push(row.into_iter().map(|x| x / norm).collect::<Vec<f64>>());
        }
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let n = rows.len();
        let entry = |k: usize| dot(&rows[k / n], &rows[k % n]) + if k / n == k % n { REGULAR } else { 0.0 };
        let weights = solve((0..n * n).map(entry).collect(), wanted)?;
        let along = |j: usize| rows.iter().zip(&weights).map(|(row, weight)| row[j] * weight).sum::<f64>();
        let step = lines.iter().enumerate().map(|(j, line)| along(j).clamp(-LONGEST, LONGEST) * line.scale());
        Some(step.collect())
    }

    /// The state moved so far along each line, on the constraints.
    fn shifted(&self, state: &State, moves: &[(&Line<'_>, f64)]) -> State {
        let mut state = state.clone();
        for (line, by) in moves {
            let by = DoubleDouble::from(*by);
            match line {
                Line::Time(_) => state.t += by,
                Line::Coordinate(i, _) => state.q[*i] += by,
                Line::Speed(i, _) => state.v[*i] += by,
                Line::Between(_) | Line::Step(_) | Line::Path(_) => {}
            }
        }
        self.motion.signals(&mut state);
        self.motion.close(&mut state);
        state.origin = Origin::Side;
        state
    }
}

/// Whether no factor of a product is narrow by itself.
fn is_of_steps(product: &Factors) -> bool {
    product.iter().all(|(_, kind)| *kind == Kind::Above)
}

/// The products of several factors that move, of which none is part of another, first those with a narrow one; and whether there are more of these.
fn factored(model: &Model) -> (Vec<Factors>, bool) {
    let graph = &model.graph;
    let roots = roots(model);
    let needed = graph.reachable(roots.iter().copied());
    let moving = graph.contains(|s| !matches!(s, Symbol::Parameter(_) | Symbol::Dummy(_)));
    let mut terms: Vec<Vec<Factors>> = Vec::with_capacity(needed.len());
    let mut more = false;
    for (i, is_needed) in needed.iter().enumerate() {
        let mut of_node = if *is_needed { terms_of(graph, graph.id_at(i), &moving, &terms) } else { Vec::new() };
        more |= of_node.len() > TERMS;
        of_node.truncate(TERMS);
        terms.push(of_node);
    }
    let several = |product: &&Factors| product.len() > 1;
    let all: BTreeSet<&Factors> = roots.iter().flat_map(|root| &terms[root.index()]).filter(several).collect();
    let part = |product: &Factors| all.iter().any(|other| *other != product && other.is_superset(product));
    let whole = all.iter().filter(|product| !part(product)).map(|product| (*product).clone());
    let (mut of_steps, mut narrow): (Vec<Factors>, Vec<Factors>) = whole.partition(is_of_steps);
    more |= narrow.len() > PRODUCTS;
    narrow.truncate(PRODUCTS);
    of_steps.truncate(STEPS);
    narrow.extend(of_steps);
    (narrow, more)
}

/// The terms of a node multiplied out, each with its narrow factors; those of its children are known.
fn terms_of(graph: &Graph, id: Id, moving: &[bool], known: &[Vec<Factors>]) -> Vec<Factors> {
    let one = |x: Id, kind: Kind| if moving[x.index()] { vec![Factors::from([(x, kind)])] } else { Vec::new() };
    match graph.node(id) {
        Node::Unary(Unary::Exp | Unary::Tanh, x) => one(x, Kind::Local),
        Node::Unary(Unary::Step, x) => one(x, Kind::Above),
        Node::Unary(Unary::Table(table), x) => one(x, Kind::Table(table.whole())),
        Node::Unary(_, x) => known[x.index()].clone(),
        Node::Binary(Binary::Max, x, Id::ZERO) | Node::Binary(Binary::Max, Id::ZERO, x) => {
            let inside = known[x.index()].clone();
            if inside.is_empty() {
                return one(x, Kind::Above);
            }
            inside.into_iter().map(|term| &term | &one(x, Kind::Above).into_iter().flatten().collect()).collect()
        }
        Node::Binary(Binary::Table(table), x, y) => {
            let both = [(x, Kind::Table(table.along(0))), (y, Kind::Table(table.along(1)))];
            let factors: Factors = both.into_iter().filter(|(argument, _)| moving[argument.index()]).collect();
            if factors.is_empty() { Vec::new() } else { vec![factors] }
        }
        Node::Binary(Binary::Mul | Binary::Div | Binary::Pow, x, y) => match (&known[x.index()], &known[y.index()]) {
            (terms, none) | (none, terms) if none.is_empty() => terms.clone(),
            (left, right) => {
                let pairs = left.iter().flat_map(|a| right.iter().map(move |b| a.union(b).copied().collect()));
                pairs.collect::<BTreeSet<Factors>>().into_iter().collect()
            }
        },
        Node::Binary(_, x, y) => {
            let both: BTreeSet<&Factors> = known[x.index()].iter().chain(&known[y.index()]).collect();
            both.into_iter().cloned().collect()
        }
        Node::Number(_) | Node::Symbol(_) => Vec::new(),
    }
}
