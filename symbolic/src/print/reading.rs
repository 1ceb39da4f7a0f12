//! The equations of motion for a person to read: as text, in LaTeX.

use std::fmt::Write;
use std::rc::Rc;

use super::formula::{Formula, Formulas, Latex, Notation, Text};
use crate::derive::without_modes;
use crate::expr::{Angles, Graph, Id, Node, Symbol, Unary, expand, expand_around_sums};
use crate::lower::Program;
use crate::model::{Model, rate_name};

/// The equations of motion, M q'' + h = (Jᵀ + B) λ with J q'' + γ = 0, as formulas.
#[derive(Clone, Debug)]
pub struct Reading {
    formulas: Formulas,
    /// What each of the formulas is.
    entries: Vec<Entry>,
    /// M q'' + h − (Jᵀ + B) λ, a row a coordinate; none where one is too long for a line.
    rows: Vec<(bool, Rc<Formula>)>,
}

/// Expressions of a model's graph in the model language, nothing left out, and after them the long parts that stand in several places, each
/// with its name.
pub fn in_full(model: &Model, roots: &[Id]) -> (Vec<String>, Vec<(String, String)>) {
    let (formulas, writer) = (Formulas::new(&model.graph, roots), Text { model });
    let wholes = formulas.roots.iter().map(|(sign, root)| writer.signed(*sign, root)).collect();
    let parts = formulas.parts.iter().enumerate();
    (wholes, parts.map(|(place, part)| (Text::part(place), writer.signed(false, part))).collect())
}

/// An equation with more leaves than these is no line that a person reads: its parts are.
const LONGEST_ROW: usize = 60;

/// What a formula gives; indices are places of coordinates and of rows of constraints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Entry {
    Mass(usize, usize),
    Bias(usize),
    /// The rate of a state of first order, by its hidden coordinate.
    Rate(usize),
    /// The constraint itself (or its rate, where it contains speeds).
    Constraint(usize),
    Row(usize, usize),
    RowBias(usize),
    Friction(usize, usize),
}

impl Reading {
    /// M and h with angles joined, with sums of places as factors, or as they are computed: whichever is shortest; constraints
    /// likewise.
    pub fn of(program: &Program) -> Reading {
        let mut graph = program.model.graph.clone();
        let rows = &program.constraints;
        let mut entries: Vec<(Entry, Id)> = Vec::new();
        let mechanical = program.model.mechanical();
        let of_mechanism = program.mass.iter().filter(|entry| entry.0 < mechanical);
        entries.extend(of_mechanism.map(|(i, j, m)| (Entry::Mass(*i, *j), *m)));
        let bias = program.bias.iter().enumerate();
        entries.extend(bias.map(|(i, h)| (if i < mechanical { Entry::Bias(i) } else { Entry::Rate(i) }, *h)));
        entries.extend(rows.values.chunks(3).enumerate().map(|(k, c)| (Entry::Constraint(k), c[0])));
        entries.extend(rows.matrix.iter().map(|(k, j, c)| (Entry::Row(*k, *j), *c)));
        entries.extend(rows.bias.iter().enumerate().map(|(k, c)| (Entry::RowBias(k), *c)));
        entries.extend(rows.friction.iter().map(|(i, k, c)| (Entry::Friction(*i, *k), *c)));
        let (entries, roots): (Vec<Entry>, Vec<Id>) = entries.into_iter().unzip();
        let rows = rows_of(program, &mut graph);
        let roots = without_modes(&mut graph, &roots, &program.switches);
        let joined: Vec<Id> = roots.iter().map(|root| joined(&mut graph, *root)).collect();
        let factors: Vec<Id> = roots.iter().map(|root| with_sums(&mut graph, *root)).collect();
        let forms = [joined, roots, factors].map(|roots| Formulas::new(&graph, &roots));
        let length = |formulas: &Formulas| {
            let text = Text { model: &program.model };
            let parts = formulas.parts.iter().map(|part| text.signed(false, part).len()).sum::<usize>();
            parts + formulas.roots.iter().map(|(sign, root)| text.signed(*sign, root).len()).sum::<usize>()
        };
        let [first, others @ ..] = forms;
        let shortest =
            others.into_iter().fold(first, |best, form| if length(&form) < length(&best) { form } else { best });
        Reading { formulas: shortest, entries, rows }
    }

    /// The equations of motion, one a coordinate, where each fits a line; else nothing.
    pub fn equations(&self, model: &Model) -> String {
        let writer = Text { model };
        let lines = self.rows.iter().map(|(sign, row)| format!("  {} = 0\n", writer.signed(*sign, row)));
        lines.collect()
    }

    /// One equation a line, in the model language; nothing is left out.
    pub fn text(&self, model: &Model) -> String {
        let writer = Text { model };
        let name = |i: usize| &model.coordinates[i].name;
        let mut out = String::new();
        let mut last = None;
        for (entry, (negative, formula)) in self.entries.iter().zip(&self.formulas.roots) {
            let title = match entry {
                Entry::Mass(..) => "M q'' + h = 0, with",
                Entry::Bias(_) => "",
                Entry::Rate(_) => "rates of states of first order",
                Entry::Constraint(_) => {
                    "constraints, which add forces (J^T + B) lambda on the right and J q'' + gamma = 0, with"
                }
                Entry::Row(..) | Entry::RowBias(_) => "",
                Entry::Friction(..) => "",
            };
            if last != Some(title) && !title.is_empty() {
                let _ = writeln!(out, "{title}");
            }
            last = if title.is_empty() { last } else { Some(title) };
            let left = match entry {
                Entry::Mass(i, j) => format!("M[{}, {}]", name(*i), name(*j)),
                Entry::Bias(i) => format!("h[{}]", name(*i)),
                Entry::Rate(i) => rate_name(name(*i), 2),
                Entry::Constraint(k) => format!("c[{}]", model.row_name(*k)),
                Entry::Row(k, j) => format!("J[{}, {}]", model.row_name(*k), name(*j)),
                Entry::RowBias(k) => format!("gamma[{}]", model.row_name(*k)),
                Entry::Friction(i, k) => format!("B[{}, {}]", name(*i), model.row_name(*k)),
            };
            // h of a state is its rate with the opposite sign.
            let negative = *negative != matches!(entry, Entry::Rate(_));
            let _ = writeln!(out, "  {left} = {}", writer.signed(negative, formula));
        }
        if !self.formulas.parts.is_empty() {
            let _ = writeln!(out, "where");
        }
        for (place, part) in self.formulas.parts.iter().enumerate() {
            let _ = writeln!(out, "  {} = {}", Text::part(place), writer.signed(false, part));
        }
        out
    }

    /// An `align*` environment, which AMS-LaTeX sets.
    pub fn latex(&self, model: &Model) -> String {
        let writer = Latex { model };
        let coordinate = |i: usize| writer.symbol(Symbol::Coordinate(i as u32));
        let row = |k: usize| writer.symbol(Symbol::Multiplier(k as u32)).replace("\\lambda_", "");
        let mut out = String::from("\\begin{align*}\n");
        for (sign, row) in &self.rows {
            let _ = writeln!(out, "  & {} = 0 \\\\", writer.lines(*sign, row));
        }
        out += "  & M \\, \\ddot{q} + h = ";
        let constrained = self.entries.iter().any(|entry| matches!(entry, Entry::Constraint(_)));
        let friction = self.entries.iter().any(|entry| matches!(entry, Entry::Friction(..)));
        out += match (constrained, friction) {
            (false, _) => "0",
            (true, false) => "J^\\mathsf{T} \\lambda, \\quad J \\, \\ddot{q} + \\gamma = 0",
            (true, true) => "(J^\\mathsf{T} + B) \\, \\lambda, \\quad J \\, \\ddot{q} + \\gamma = 0",
        };
        for (entry, (negative, formula)) in self.entries.iter().zip(&self.formulas.roots) {
            let left = match entry {
                Entry::Mass(i, j) => format!("M_{{{},{}}}", coordinate(*i), coordinate(*j)),
                Entry::Bias(i) => format!("h_{{{}}}", coordinate(*i)),
                Entry::Rate(i) => writer.symbol(Symbol::Acceleration(*i as u32)),
                Entry::Constraint(k) => format!("c_{}", row(*k)),
                Entry::Row(k, j) => format!("J_{{{},{}}}", row(*k), coordinate(*j)),
                Entry::RowBias(k) => format!("\\gamma_{}", row(*k)),
                Entry::Friction(i, k) => format!("B_{{{},{}}}", coordinate(*i), row(*k)),
            };
            let negative = *negative != matches!(entry, Entry::Rate(_));
            let _ = write!(out, " \\\\\n  {left} &= {}", writer.lines(negative, formula));
        }
        for (place, part) in self.formulas.parts.iter().enumerate() {
            let _ = write!(out, " \\\\\n  {} &= {}", Latex::part(place), writer.lines(false, part));
        }
        out + "\n\\end{align*}\n"
    }

    /// Pairs of what it is and its formula, in the model language: `M[x, y]`, `h[x]`, …; then the parts.
    pub fn lines(&self, model: &Model) -> Vec<(String, String)> {
        let text = self.text(model);
        let pairs = text.lines().filter_map(|line| line.strip_prefix("  ")?.split_once(" = "));
        pairs.map(|(left, right)| (left.to_owned(), right.to_owned())).collect()
    }
}

/// The equations of motion in their shortest forms; none where one is too long.
fn rows_of(program: &Program, graph: &mut Graph) -> Vec<(bool, Rc<Formula>)> {
    let writer = Text { model: &program.model };
    let roots = without_modes(graph, &program.residual, &program.switches);
    let mut shortest = |root: Id| {
        let forms = [root, joined(graph, root), with_sums(graph, root)];
        let formulas = forms.into_iter().filter_map(|form| Formulas::whole(graph, form, LONGEST_ROW));
        formulas.min_by_key(|(sign, formula)| writer.signed(*sign, formula).len())
    };
    roots.into_iter().map(&mut shortest).collect::<Option<_>>().unwrap_or_default()
}

/// An expression with its angles joined, if there are any and it does not grow.
fn joined(graph: &mut Graph, root: Id) -> Id {
    let turns = |id: &Id| matches!(graph.node(*id), Node::Unary(Unary::Sin | Unary::Cos, _));
    if !graph.needed([root]).iter().any(turns) {
        return root;
    }
    expand(graph, &[root], is_parameter, Angles::All).map_or(root, |form| form[0])
}

/// An expression with sums of places as its factors, unless it grows too large.
fn with_sums(graph: &mut Graph, root: Id) -> Id {
    expand_around_sums(graph, &[root], is_parameter).map_or(root, |form| form[0])
}

fn is_parameter(symbol: Symbol) -> bool {
    matches!(symbol, Symbol::Parameter(_))
}
