//! Velocities as linear forms over the speeds and over shared velocities, which are kept as variables.

use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};

use super::super::LeastConstraint;
use super::super::angular::Turning;
use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary, canonical_products, copied};

/// Σ cⱼ xⱼ: variables with their coefficients, in order.  Variables below n are coordinates; kept ones follow, and the multipliers of rows.
pub(crate) type Form = Vec<(usize, Id)>;

/// A form Σ wₖₗ yₖ yₗ / 2 + Σ gₖ yₖ + Σ hᵢ xᵢ with the y as linear forms.
#[derive(Clone, Debug)]
pub(crate) struct Forms {
    /// How many coordinates there are.
    pub n: usize,
    /// What each kept variable is.
    pub kept: Vec<Form>,
    /// (w, y, y) as in [`LeastConstraint::products`].
    pub products: Vec<(Id, Form, Form)>,
    /// Which body each product is of; each product of a written energy counts as one.
    pub bodies: Vec<usize>,
    /// (y, g).
    pub linear: Vec<(Form, Id)>,
    /// h.
    pub forces: Vec<Id>,
    /// (c', γ) of the constraints' rows.
    pub rows: Vec<(Form, Id)>,
    /// As in [`LeastConstraint::turning`].
    pub turning: Vec<Turning>,
}

impl Forms {
    /// `None` where a velocity is not linear in the speeds, or an energy no sum of products of such.
    pub fn of(graph: &mut Graph, n: usize, least: &LeastConstraint) -> Option<Forms> {
        let mut products: Vec<(Id, Id, Id)> = least.products.iter().map(|p| (p.0, p.1, p.2)).collect();
        let degrees = Degrees::of(graph, products.iter().flat_map(|p| [p.1, p.2]).chain([least.kinetic]));
        quadratic(graph, &degrees, least.kinetic, &mut products)?;
        let first = least.products.last().map_or(0, |p| p.3 + 1);
        let bodies = least.products.iter().map(|p| p.3).chain(first..).take(products.len());
        let (products, bodies): (Vec<(Id, Id, Id)>, Vec<usize>) = products
            .into_iter()
            .zip(bodies)
            .filter(|((w, u, v), _)| [*w, *u, *v].iter().all(|x| *x != Id::ZERO))
            .unzip();
        let mut roots: Vec<Id> = products
            .iter()
            .flat_map(|p| [p.1, p.2])
            .chain(least.linear.iter().chain(&least.rows).map(|l| l.0))
            .collect();
        roots.sort_unstable();
        roots.dedup();
        let degrees = Degrees::of(graph, roots.iter().copied());
        let shared = shared(graph, &degrees, &roots);
        let mut forms: HashMap<Id, Form> = HashMap::default();
        let mut kept = Vec::new();
        for id in graph.needed(roots) {
            match degrees.of_node(id) {
                0 => continue,
                1 => {}
                _ => return None,
            }
            let mut form = linear_form(graph, &degrees, &forms, id);
            if form.len() > 1 && shared.contains(&id) {
                kept.push(form);
                form = vec![(n + kept.len() - 1, Id::ONE)];
            }
            forms.insert(id, form);
        }
        let of = |id: &Id| forms.get(id).cloned().unwrap_or_default();
        Some(Forms {
            n,
            products: products.iter().map(|(w, u, v)| doubled(graph, (*w, *u, *v), (of(u), of(v)))).collect(),
            linear: least.linear.iter().map(|(y, g)| (of(y), *g)).collect(),
            rows: least.rows.iter().map(|(y, bias)| (of(y), *bias)).collect(),
            forces: least.forces.clone(),
            turning: least.turning.clone(),
            kept,
            bodies,
        })
    }

    /// The same in a graph of its own; `in_order` with the factors of products without speeds before those with, so that what coefficients
    /// and biases share is computed once.
    pub fn moved(mut self, from: &Graph, in_order: bool) -> (Graph, Forms) {
        let mut graph = Graph::new();
        let mut places: Vec<&mut Id> = Vec::new();
        let Forms { kept, products, linear, forces, rows, turning, .. } = &mut self;
        places.extend(kept.iter_mut().flatten().map(|term| &mut term.1));
        for (w, u, v) in products {
            places.push(w);
            places.extend(u.iter_mut().chain(v).map(|term| &mut term.1));
        }
        let with_constants = linear.iter_mut().chain(rows);
        places.extend(with_constants.flat_map(|(form, g)| form.iter_mut().map(|term| &mut term.1).chain([g])));
        places.extend(forces);
        places.extend(turning.iter_mut().flat_map(Turning::expressions));
        let old: Vec<Id> = places.iter().map(|id| **id).collect();
        let mut new = copied(from, &old, &mut graph);
        if in_order {
            new = canonical_products(&mut graph, &new, |symbol| !matches!(symbol, Symbol::Speed(_)));
        }
        places.into_iter().zip(new).for_each(|(place, id)| *place = id);
        (graph, self)
    }

    /// How many variables there are.
    pub fn variables(&self) -> usize {
        self.first_multiplier() + self.rows.len()
    }

    /// The place of the first row's multiplier.
    pub fn first_multiplier(&self) -> usize {
        self.n + self.kept.len()
    }

    /// Whether all unknowns are the coordinates' own speeds.
    pub fn are_of_coordinates(&self) -> bool {
        self.kept.is_empty() && self.turning.is_empty()
    }

    /// Whether a variable is the length of a rotation, which nothing accelerates.
    pub fn is_length(&self, variable: usize) -> bool {
        self.turning.iter().any(|turning| turning.first == variable)
    }

    /// Whether nothing that M is made of changes along a run.
    pub fn are_constant(&self, graph: &Graph) -> bool {
        let varies = graph.contains(|s| !matches!(s, Symbol::Parameter(_)));
        let constant = |form: &Form| form.iter().all(|(_, c)| !varies[c.index()]);
        self.kept.iter().all(constant)
            && self.products.iter().all(|(w, u, v)| !varies[w.index()] && constant(u) && constant(v))
    }

    /// The fewest operations that factoring M can take: a coordinate that is coupled with d others when it is eliminated takes
    /// 1 + d + d (d + 1), and the d of all n add up to as many as M has entries below its diagonal, E, at the least: n + 2 E + E²/n.
    pub fn least_factoring(&self) -> usize {
        let coupled: u32 = self.couplings().iter().flatten().map(|word| word.count_ones()).sum();
        let entries = coupled as usize / 2;
        self.n + 2 * entries + entries * entries / self.n.max(1)
    }

    /// The set of coordinates that each coordinate, kept variable and row is made of, as bits.
    pub fn made_of(&self) -> Vec<Vec<u64>> {
        let words = self.n.div_ceil(64);
        let mut made_of = vec![vec![0_u64; words]; self.n];
        made_of.iter_mut().enumerate().for_each(|(i, set)| set[i / 64] |= 1 << (i % 64));
        for form in self.kept.iter().chain(self.rows.iter().map(|row| &row.0)) {
            made_of.push(union(form, &made_of, words));
        }
        made_of
    }

    /// For each coordinate the set of others that M couples it with, as bits.
    pub fn couplings(&self) -> Vec<Vec<u64>> {
        let words = self.n.div_ceil(64);
        let has = |set: &[u64], i: usize| set[i / 64] >> (i % 64) & 1 == 1;
        let made_of = self.made_of();
        let mut coupled = vec![vec![0_u64; words]; self.n];
        for (_, u, v) in &self.products {
            let [u, v] = [u, v].map(|form| union(form, &made_of, words));
            for (i, row) in coupled.iter_mut().enumerate() {
                if has(&u, i) {
                    add(row, &v);
                }
                if has(&v, i) {
                    add(row, &u);
                }
            }
        }
        coupled.iter_mut().enumerate().for_each(|(i, row)| row[i / 64] &= !(1 << (i % 64)));
        coupled
    }

    /// Sizes of the sets of coordinates that M couples, in the order of their first ones.
    pub fn blocks(&self) -> Vec<usize> {
        let mut found = vec![false; self.n];
        let coupled = self.couplings();
        let mut sizes = Vec::new();
        for first in 0..self.n {
            let mut open = vec![first];
            let mut size = 0;
            while let Some(i) = open.pop() {
                if !std::mem::replace(&mut found[i], true) {
                    size += 1;
                    open.extend((0..self.n).filter(|j| coupled[i][j / 64] >> (j % 64) & 1 == 1));
                }
            }
            sizes.extend((size > 0).then_some(size));
        }
        sizes
    }
}

/// Adds a set to another.
fn add(set: &mut [u64], more: &[u64]) {
    set.iter_mut().zip(more).for_each(|(set, more)| *set |= more);
}

/// The coordinates that a form is made of, as bits in so many words.
fn union(form: &Form, made_of: &[Vec<u64>], words: usize) -> Vec<u64> {
    let mut set = vec![0_u64; words];
    form.iter().for_each(|(variable, _)| add(&mut set, &made_of[*variable]));
    set
}

/// In the speeds: 0 for what contains none, 1 for what is affine, 2 for what is quadratic, 3 for all else.
struct Degrees(HashMap<Id, u8>);

/// The degree of what is no polynomial of degree 2 or less.
const BEYOND: u8 = 3;

impl Degrees {
    fn of(graph: &Graph, roots: impl IntoIterator<Item = Id>) -> Degrees {
        let mut degrees = Degrees(HashMap::default());
        for id in graph.needed(roots) {
            let of = |x: Id| degrees.of_node(x);
            let degree = match graph.node(id) {
                Node::Symbol(Symbol::Speed(_)) => 1,
                Node::Number(_) | Node::Symbol(_) => 0,
                Node::Unary(Unary::Neg, x) => of(x),
                Node::Unary(_, x) => {
                    if of(x) == 0 {
                        0
                    } else {
                        BEYOND
                    }
                }
                Node::Binary(Binary::Add | Binary::Sub, x, y) => of(x).max(of(y)),
                Node::Binary(Binary::Mul, x, y) => (of(x) + of(y)).min(BEYOND),
                Node::Binary(Binary::Div, x, y) if of(y) == 0 => of(x),
                Node::Binary(_, x, y) => {
                    if of(x) == 0 && of(y) == 0 {
                        0
                    } else {
                        BEYOND
                    }
                }
            };
            degrees.0.insert(id, degree);
        }
        degrees
    }

    fn of_node(&self, id: Id) -> u8 {
        self.0.get(&id).copied().unwrap_or(0)
    }
}

/// An energy walked from its root to the products of two linear velocities, each with its coefficient.
fn quadratic(graph: &mut Graph, degrees: &Degrees, energy: Id, products: &mut Vec<(Id, Id, Id)>) -> Option<()> {
    let two = graph.integer(2);
    // Parents have larger places than children, so taking the largest first visits each node once.
    let mut open = std::collections::BTreeMap::from([(energy, Id::ONE)]);
    while let Some((id, factor)) = open.pop_last() {
        // What is linear or contains no speeds has no second derivative.
        if degrees.of_node(id) < 2 {
            continue;
        }
        let degree = |x: Id| degrees.of_node(x);
        let parts = match graph.node(id) {
            Node::Unary(Unary::Neg, x) => vec![(x, graph.neg(factor))],
            Node::Binary(Binary::Add, x, y) => vec![(x, factor), (y, factor)],
            Node::Binary(Binary::Sub, x, y) => vec![(x, factor), (y, graph.neg(factor))],
            Node::Binary(Binary::Mul, x, y) if degree(x) == 0 => vec![(y, graph.mul(factor, x))],
            Node::Binary(Binary::Mul, x, y) if degree(y) == 0 => vec![(x, graph.mul(factor, y))],
            Node::Binary(Binary::Div, x, y) if degree(y) == 0 => vec![(x, graph.div(factor, y))],
            Node::Binary(Binary::Mul, x, y) if degree(x) == 1 && degree(y) == 1 => {
                products.push((if x == y { graph.mul(two, factor) } else { factor }, x, y));
                continue;
            }
            _ => return None,
        };
        for (part, factor) in parts {
            let known = open.get(&part).copied().unwrap_or(Id::ZERO);
            open.insert(part, graph.add(known, factor));
        }
    }
    Some(())
}

/// A product of two nodes with one form is a square, of twice the weight.
fn doubled(graph: &mut Graph, (w, u, v): (Id, Id, Id), (first, second): (Form, Form)) -> (Id, Form, Form) {
    let twice = u != v && first == second;
    (if twice { graph.add(w, w) } else { w }, first, second)
}

/// The nodes that two others use, or another one beside being a velocity itself.
fn shared(graph: &Graph, degrees: &Degrees, roots: &[Id]) -> HashSet<Id> {
    let mut used: HashSet<Id> = roots.iter().copied().collect();
    let mut shared = HashSet::default();
    for id in graph.needed(roots.iter().copied()) {
        for child in graph.children(id).filter(|child| degrees.of_node(*child) == 1) {
            if !used.insert(child) {
                shared.insert(child);
            }
        }
    }
    shared
}

/// The form of an affine node from those of its children; what is left without speeds does not change with accelerations.
fn linear_form(graph: &mut Graph, degrees: &Degrees, forms: &HashMap<Id, Form>, id: Id) -> Form {
    let of = |x: Id| forms.get(&x).map(Vec::as_slice).unwrap_or_default();
    match graph.node(id) {
        Node::Symbol(Symbol::Speed(i)) => vec![(i as usize, Id::ONE)],
        Node::Unary(Unary::Neg, x) => of(x).iter().map(|(v, c)| (*v, graph.neg(*c))).collect(),
        Node::Binary(Binary::Add, x, y) => merged(graph, of(x), of(y), Graph::add),
        Node::Binary(Binary::Sub, x, y) => merged(graph, of(x), of(y), Graph::sub),
        Node::Binary(Binary::Mul, x, y) if degrees.of_node(x) == 0 => scaled(graph, of(y), |g, c| g.mul(x, c)),
        Node::Binary(Binary::Mul, x, y) => scaled(graph, of(x), |g, c| g.mul(y, c)),
        Node::Binary(Binary::Div, x, y) => scaled(graph, of(x), |g, c| g.div(c, y)),
        _ => Form::new(),
    }
}

fn scaled(graph: &mut Graph, form: &[(usize, Id)], by: impl Fn(&mut Graph, Id) -> Id) -> Form {
    form.iter().map(|(v, c)| (*v, by(graph, *c))).filter(|(_, c)| *c != Id::ZERO).collect()
}

fn merged(graph: &mut Graph, a: &[(usize, Id)], b: &[(usize, Id)], by: impl Fn(&mut Graph, Id, Id) -> Id) -> Form {
    let mut sum: std::collections::BTreeMap<usize, (Id, Id)> = a.iter().map(|(v, c)| (*v, (*c, Id::ZERO))).collect();
    for (v, c) in b {
        sum.entry(*v).or_insert((Id::ZERO, Id::ZERO)).1 = *c;
    }
    let sums = sum.into_iter().map(|(v, (c, d))| (v, by(graph, c, d)));
    sums.filter(|(_, c)| *c != Id::ZERO).collect()
}
