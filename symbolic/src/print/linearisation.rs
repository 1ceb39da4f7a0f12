//! M, C, K and B about an equilibrium, as expressions of the parameters.

use std::fmt::{self, Display, Write};
use std::rc::Rc;

use rustc_hash::FxHashMap as HashMap;

use super::formula::{Formula, Formulas, Latex, Notation, Text};
use crate::derive::without_modes;
use crate::expr::{Angles, Graph, Id, Measured, Symbol, Tape, expand, expand_around_sums, substitute};
use crate::lower::Program;
use crate::model::{Model, symbol_text};
use crate::number::DoubleDouble;
use crate::random::Random;

/// Drawn sets of parameters with which a residual must vanish: one may be met by accident, four are not.
const DRAWN: usize = 4;
/// Parameters are drawn up to this factor below and above their defaults, so that what holds for these alone is seen.
const SPREAD: f64 = 1.5;
/// Roundings of double-double below which a residual is 0: those of some thousand operations.
const ROUNDINGS: f64 = 1e4;

/// An expression with more leaves than these says nothing to a person.
const LONGEST: usize = 200;

/// A formula with its sign.
type Signed = (bool, Rc<Formula>);
/// Rows of expressions.
type Matrix = Vec<Vec<Id>>;

/// M x'' + C x' + K x = B u for small departures x from an equilibrium, with matrices of formulas.
#[derive(Clone, Debug)]
pub struct Linearisation {
    /// The equilibrium, an entry a coordinate.
    place: Vec<Signed>,
    /// Names of the matrices that are not 0, and their rows.
    matrices: Vec<(&'static str, Vec<Vec<Signed>>)>,
    /// ω² = K/M of one coordinate without damping.
    frequency: Option<Signed>,
    /// The columns of B: inputs and their rates, by their symbols.
    inputs: Vec<Symbol>,
}

/// Why there are no such matrices.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotLinear {
    /// The mechanism has constraints or phases.
    Constrained,
    /// The mechanism has states of first order.
    States,
    /// The equations depend on time otherwise than through inputs.
    Time,
    /// A force or its slope has no value there: a quotient by 0, a root of a negative number.
    Undefined,
    /// Something jumps or has a kink at that place.
    Kink,
    /// An expression of the place contains more than parameters; the coordinate.
    NotConstant(String),
    /// An entry would be too long to read.
    TooLong,
    /// A force remains at rest: pairs of a coordinate and its force.
    NoEquilibrium(Vec<(String, String)>),
}

impl Display for NotLinear {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NotLinear::States => f.write_str(
                "matrices of formulas are not available for mechanisms with states of first order; `modes` computes the numbers of A and B",
            ),
            NotLinear::Constrained => f.write_str(
                "matrices of formulas are not available for mechanisms with constraints or phases; `modes` computes their numbers",
            ),
            NotLinear::Time => f.write_str(
                "the equations depend on t, so that there is no equilibrium; a function of time that drives can be one of `inputs`",
            ),
            NotLinear::Kink => f.write_str("a force has a kink or a jump at this place, where no matrices exist"),
            NotLinear::Undefined => f.write_str(
                "a force or its slope is not defined at this place; `--at NAME=EXPRESSION` names another place",
            ),
            NotLinear::NotConstant(name) => write!(f, "the place of `{name}` must be an expression of parameters"),
            NotLinear::TooLong => f.write_str("an entry is too long to read; `modes` computes the matrices' numbers"),
            NotLinear::NoEquilibrium(forces) => {
                f.write_str("this place is no equilibrium: at rest there remains")?;
                for (name, force) in forces {
                    write!(f, "\n  the force on {name}: {force}")?;
                }
                f.write_str("\n`--at NAME=EXPRESSION` names another place")
            }
        }
    }
}

impl Linearisation {
    /// The matrices of a model about the equilibrium at which each coordinate has this value, an expression in `model`'s graph; inputs
    /// are 0 there.
    ///
    /// `model` is that of `program` or has grown from it.
    ///
    /// # Errors
    /// Where there are none, why.
    pub fn about(program: &Program, model: &mut Model, place: &[Id]) -> Result<Linearisation, NotLinear> {
        if !model.constraints.is_empty() || model.phases.len() > 1 {
            return Err(NotLinear::Constrained);
        }
        if !model.states.is_empty() {
            return Err(NotLinear::States);
        }
        for (coordinate, value) in model.coordinates.iter().zip(place) {
            if !model.graph.symbols([*value]).into_iter().all(is_parameter) {
                return Err(NotLinear::NotConstant(coordinate.name.clone()));
            }
        }
        let rest = resting(model, place);
        let graph = &mut model.graph;
        let arguments: Vec<Id> = program.switches.iter().map(|switch| switch.argument).collect();
        let arguments = without_modes(graph, &arguments, &program.switches);
        let moving = |graph: &Graph, id: Id| graph.symbols([id]).into_iter().any(|s| rest.contains_key(&s));
        let arguments: Vec<Id> = arguments.into_iter().filter(|id| moving(graph, *id)).collect();
        let arguments = substitute(graph, &arguments, &rest);
        let forces = at_rest(program, graph, &program.residual, &rest);
        let n = model.coordinates.len();
        let columns = 3 * model.inputs.len();
        let [mass, damping, stiffness, input] =
            [(&program.mass, n), (&program.damping, n), (&program.stiffness, n), (&program.input, columns)].map(
                |(entries, columns)| {
                    let values: Vec<Id> = entries.iter().map(|entry| entry.2).collect();
                    let values = at_rest(program, &mut model.graph, &values, &rest);
                    let mut rows = vec![vec![Id::ZERO; columns]; n];
                    for ((i, j, _), value) in entries.iter().zip(values) {
                        rows[*i][*j] = value;
                    }
                    rows
                },
            );
        let mut matrices = [("M", mass), ("C", damping), ("K", stiffness), ("B", input)];
        for (i, j) in (0..n).flat_map(|i| (0..i).map(move |j| (i, j))) {
            matrices[0].1[j][i] = matrices[0].1[i][j];
        }
        let all = matrices.iter().flat_map(|(_, rows)| rows.iter().flatten()).copied();
        let symbols = model.graph.symbols(all.chain(forces.iter().copied()));
        if symbols.contains(&Symbol::Time) {
            return Err(NotLinear::Time);
        }
        if !symbols.into_iter().all(is_parameter) || vanishing(model, &arguments).contains(&true) {
            return Err(NotLinear::Kink);
        }
        let values: Vec<Id> =
            matrices.iter().flat_map(|(_, rows)| rows.iter().flatten()).chain(&forces).copied().collect();
        let finite = |values: Vec<Measured>| values.iter().all(|x| x.value.to_f64().is_finite());
        if !drawn(model, &values).into_iter().all(finite) {
            return Err(NotLinear::Undefined);
        }
        let balanced = vanishing(model, &forces);
        if balanced.contains(&false) {
            let left = (0..n).filter(|i| !balanced[*i]).map(|i| {
                let force = model.graph.neg(forces[i]);
                let force = shortest(model, force).map_or("too long to print".to_owned(), |force| text(model, &force));
                (model.coordinates[i].name.clone(), force)
            });
            return Err(NotLinear::NoEquilibrium(left.collect()));
        }
        Linearisation::written(model, place, matrices).ok_or(NotLinear::TooLong)
    }

    /// As formulas; `None` where one is too long.
    fn written(model: &mut Model, place: &[Id], matrices: [(&'static str, Matrix); 4]) -> Option<Linearisation> {
        let zero = matrices.each_ref().map(|(_, rows)| {
            let values: Vec<Id> = rows.iter().flatten().copied().collect();
            vanishing(model, &values)
        });
        let [mass, damping, stiffness, _] = matrices.each_ref().map(|(_, rows)| rows.iter().flatten().next().copied());
        let is_zero = |k: usize| zero[k].iter().all(|zero| *zero);
        let ratio = match (mass, stiffness) {
            (Some(mass), Some(stiffness)) if place.len() == 1 && damping.is_some() && is_zero(1) && !is_zero(2) => {
                Some(model.graph.div(stiffness, mass))
            }
            _ => None,
        };
        let frequency = match ratio {
            Some(ratio) => Some(shortest(model, ratio)?),
            None => None,
        };
        let columns = 3 * model.inputs.len();
        let used = |column: &usize| (0..place.len()).any(|i| !zero[3][i * columns + column]);
        let columns: Vec<usize> = (0..columns).filter(used).collect();
        let inputs = columns.iter().map(|column| Symbol::Input((column / 3) as u32, (column % 3) as u8)).collect();
        let mut formulas = Vec::new();
        for (k, (name, rows)) in matrices.into_iter().enumerate() {
            if is_zero(k) && name != "K" {
                continue;
            }
            let width = rows.first().map_or(0, Vec::len);
            let wanted: Vec<usize> = if name == "B" { columns.clone() } else { (0..width).collect() };
            let mut entry = |i: usize, j: usize| {
                // B = -dF/du.
                let value = if name == "B" { model.graph.neg(rows[i][j]) } else { rows[i][j] };
                shortest(model, if zero[k][i * width + j] { Id::ZERO } else { value })
            };
            let mut row = |i: usize| wanted.iter().map(|j| entry(i, *j)).collect::<Option<Vec<Signed>>>();
            formulas.push((name, (0..place.len()).map(&mut row).collect::<Option<Vec<_>>>()?));
        }
        let place = place.iter().map(|value| shortest(model, *value)).collect::<Option<_>>()?;
        Some(Linearisation { place, matrices: formulas, frequency, inputs })
    }

    /// A matrix a paragraph, in the model language.
    pub fn text(&self, model: &Model) -> String {
        let names = |i: usize| &model.coordinates[i].name;
        let place: Vec<String> =
            self.place.iter().enumerate().map(|(i, value)| format!("{} = {}", names(i), text(model, value))).collect();
        let own = |name: &str| own_name(model, name);
        let equation =
            self.equation(|matrix, vector, dots| format!("{} {}{}", own(matrix), own(vector), "'".repeat(dots)));
        let mut out = format!("{equation}, for small departures {} from {}\n", own("x"), place.join(", "));
        for (name, rows) in &self.matrices {
            let name = own(name);
            let rows: Vec<Vec<String>> =
                rows.iter().map(|row| row.iter().map(|value| text(model, value)).collect()).collect();
            let count = rows.first().map_or(0, Vec::len);
            let width = |j: usize| rows.iter().map(|row| row[j].chars().count()).max().unwrap_or(0);
            let widths: Vec<usize> = (0..count).map(width).collect();
            let last = rows.len() - 1;
            for (i, row) in rows.iter().enumerate() {
                let cells = row.iter().enumerate().map(|(j, cell)| {
                    let end = if j + 1 < count { "," } else { "]" };
                    let width = if j + 1 < count || last > 0 { widths[j] + 1 } else { 0 };
                    format!("{:<width$}", format!("{cell}{end}"))
                });
                let (open, close) = (
                    if i == 0 { format!("{name} = [[") } else { " ".repeat(name.chars().count() + 4) + "[" },
                    if i == last { "]" } else { "," },
                );
                let line = format!("{open}{}", cells.collect::<Vec<_>>().join(" "));
                let _ = writeln!(out, "{}{close}", line.trim_end());
            }
        }
        if !self.inputs.is_empty() {
            let columns: Vec<String> = self.inputs.iter().map(|symbol| symbol_text(model, *symbol)).collect();
            let _ = writeln!(out, "{} = [{}]", own("u"), columns.join(", "));
        }
        if let Some(frequency) = &self.frequency {
            let _ = writeln!(out, "omega^2 = {}/{} = {}", own("K"), own("M"), text(model, frequency));
        }
        out
    }

    /// An `align*` environment with matrices in parentheses, which AMS-LaTeX sets.
    pub fn latex(&self, model: &Model) -> String {
        let writer = Latex { model };
        let signed = |(negative, formula): &Signed| writer.signed(*negative, formula);
        let symbol = |i: usize| writer.symbol(Symbol::Coordinate(i as u32));
        let column = |entries: Vec<String>| format!("\\begin{{pmatrix}} {} \\end{{pmatrix}}", entries.join(" \\\\ "));
        let coordinates = column((0..self.place.len()).map(symbol).collect());
        let place = column(self.place.iter().map(signed).collect());
        // Upright and bold, as no name of the file is.
        let bold = |name: &str| format!("\\mathbf{{{name}}}");
        let equation = self.equation(|matrix, vector, dots| {
            let vector = bold(vector);
            let moved = ["", "\\dot", "\\ddot"][dots];
            format!("{} \\, {}", bold(matrix), if dots == 0 { vector } else { format!("{moved}{{{vector}}}") })
        });
        let mut out = format!("\\begin{{align*}}\n  & {equation}, \\quad {} = {coordinates}", bold("x"));
        if self.place.iter().any(|(_, value)| !matches!(&**value, Formula::Number(number) if number.to_f64() == 0.0)) {
            let _ = write!(out, " - {place}");
        }
        for (name, rows) in &self.matrices {
            let rows: Vec<String> =
                rows.iter().map(|row| row.iter().map(signed).collect::<Vec<_>>().join(" & ")).collect();
            let _ = write!(out, " \\\\\n  {} &= {}", bold(name), column(rows));
        }
        if !self.inputs.is_empty() {
            let inputs = self.inputs.iter().map(|symbol| writer.symbol(*symbol)).collect();
            let _ = write!(out, " \\\\\n  {} &= {}", bold("u"), column(inputs));
        }
        if let Some(frequency) = &self.frequency {
            let _ = write!(out, " \\\\\n  \\omega^{{2}} &= {}", signed(frequency));
        }
        out + "\n\\end{align*}\n"
    }

    /// M x'' + C x' + K x = B u, of the matrices that are there; each product by its matrix, its vector and the dots over that.
    fn equation(&self, product: impl Fn(&str, &str, usize) -> String) -> String {
        let has = |name: &str| self.matrices.iter().any(|(known, _)| *known == name);
        let terms = [("M", 2), ("C", 1), ("K", 0)].into_iter().filter(|(name, _)| has(name));
        let left: Vec<String> = terms.map(|(name, dots)| product(name, "x", dots)).collect();
        format!("{} = {}", left.join(" + "), if has("B") { product("B", "u", 0) } else { "0".to_owned() })
    }
}

/// A name for a matrix or a vector that no parameter, coordinate nor input has: with underscores behind it until it is none of them.
fn own_name(model: &Model, name: &str) -> String {
    let parameters = model.parameters.iter().map(|parameter| &parameter.name);
    let parameters = parameters.chain(model.derived.iter().map(|derived| &derived.name));
    let others = model.coordinates.iter().map(|coordinate| &coordinate.name);
    let known: Vec<&String> = parameters.chain(others).chain(model.inputs.iter().map(|input| &input.name)).collect();
    let mut own = name.to_owned();
    while known.iter().any(|known| **known == own) {
        own.push('_');
    }
    own
}

/// What takes the place of the state and the inputs at rest.
fn resting(model: &mut Model, place: &[Id]) -> HashMap<Symbol, Id> {
    let mut values = HashMap::default();
    for (i, value) in place.iter().enumerate() {
        let i = i as u32;
        values.insert(Symbol::Coordinate(i), *value);
        values.extend([Symbol::Speed(i), Symbol::Acceleration(i)].map(|symbol| (symbol, Id::ZERO)));
    }
    let inputs = 0..model.inputs.len() as u32;
    values.extend(inputs.flat_map(|k| (0..3).map(move |order| (Symbol::Input(k, order), Id::ZERO))));
    values
}

/// Expressions at rest, with discontinuities as functions instead of modes.
fn at_rest(program: &Program, graph: &mut Graph, roots: &[Id], rest: &HashMap<Symbol, Id>) -> Vec<Id> {
    let roots = without_modes(graph, roots, &program.switches);
    substitute(graph, &roots, rest)
}

/// An expression of parameters in the form that is shortest to read; `None` where that is too long.
fn shortest(model: &mut Model, root: Id) -> Option<Signed> {
    let graph = &mut model.graph;
    let mut forms = vec![root];
    // Multiplied out, with like terms gathered; with sums as factors.
    forms.extend(expand(graph, &[root], is_parameter, Angles::Shorter).map(|form| form[0]));
    forms.extend(expand(graph, &[root], |_| false, Angles::Shorter).map(|form| form[0]));
    forms.extend(expand_around_sums(graph, &[root], is_parameter).map(|form| form[0]));
    let formulas = forms.into_iter().filter_map(|form| Formulas::whole(&model.graph, form, LONGEST));
    formulas.map(turned).min_by_key(|formula| text(model, formula).len())
}

/// Which of these expressions of parameters are 0 whatever the parameters.
fn vanishing(model: &Model, roots: &[Id]) -> Vec<bool> {
    let mut zero = vec![true; roots.len()];
    for values in drawn(model, roots) {
        for (zero, measured) in zero.iter_mut().zip(values) {
            *zero &= measured.vanishes(ROUNDINGS);
        }
    }
    zero
}

/// These expressions of parameters with drawn ones.
fn drawn(model: &Model, roots: &[Id]) -> Vec<Vec<Measured>> {
    let tape = Tape::new(&model.graph, roots);
    let mut random = Random::new();
    let mut once = || {
        let factors: Vec<f64> = model.parameters.iter().map(|_| random.between(1.0 / SPREAD, SPREAD)).collect();
        tape.measured(|symbol| match symbol {
            Symbol::Parameter(k) => {
                // What is 0 by default is one of the mechanism's numbers all the same.
                let size = Some(model.parameters[k as usize].default).filter(|value| *value != 0.0).unwrap_or(1.0);
                DoubleDouble::from(size * factors[k as usize])
            }
            _ => DoubleDouble::ZERO,
        })
    };
    (0..DRAWN).map(|_| once()).collect()
}

/// -a/(x - y) as a/(y - x).
fn turned((negative, formula): Signed) -> Signed {
    let Formula::Product(number, above, below) = &*formula else { return (negative, formula) };
    let mut sides = [above.clone(), below.clone()];
    let mut odd = sides.iter_mut().flatten().filter(|power| power.halves % 4 == 2);
    let difference = odd.find_map(|power| match &*power.base {
        Formula::Sum(terms) if terms.len() == 2 && terms[0].0 != terms[1].0 => {
            let swapped = terms.iter().rev().map(|(sign, term)| (!sign, term.clone())).collect();
            Some((power, Rc::new(Formula::Sum(swapped))))
        }
        _ => None,
    });
    match difference {
        Some((power, swapped)) if negative => power.base = swapped,
        _ => return (negative, formula),
    }
    let [above, below] = sides;
    (false, Rc::new(Formula::Product(*number, above, below)))
}

fn text(model: &Model, (negative, formula): &Signed) -> String {
    Text { model }.signed(*negative, formula)
}

fn is_parameter(symbol: Symbol) -> bool {
    matches!(symbol, Symbol::Parameter(_))
}
