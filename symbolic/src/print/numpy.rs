//! A program as a module for Python: M, h and the state's rate with NumPy, or with what takes the place of its `np`: nothing is assigned to arrays.

use std::collections::HashSet;
use std::fmt::Write;

use super::formula::{Formulas, Notation, Python};
use crate::derive::without_modes;
use crate::expr::{Graph, Id, Symbol, Table};
use crate::lower::{Entry, Program};
use crate::model::command::evaluate_all;
use crate::model::local_name;

/// Python's keywords, the names that the module has of itself, and those of Python that it calls.
const TAKEN: &[&str] = &[
    "False",
    "None",
    "True",
    "and",
    "as",
    "assert",
    "async",
    "await",
    "break",
    "class",
    "continue",
    "def",
    "del",
    "elif",
    "else",
    "except",
    "finally",
    "for",
    "from",
    "global",
    "if",
    "import",
    "in",
    "is",
    "lambda",
    "nonlocal",
    "not",
    "or",
    "pass",
    "raise",
    "return",
    "try",
    "while",
    "with",
    "yield",
    "np",
    "t",
    "q",
    "v",
    "p",
    "u",
    "phase",
    "memory",
    "out",
    "n",
    "independent_",
    "pieces_",
    "piece_",
    "powers_",
    "bicubic_",
    "float",
    "int",
    "len",
    "list",
    "max",
    "range",
    "zip",
];

/// Evaluates a table.
const PIECES: &str = "

def pieces_(x, order, knots, pieces, period):
    \"\"\"Cubics between knots, straight beyond them; order: how often they are differentiated.\"\"\"
    if period is not None:
        x = x - np.floor((x - knots[0])/period)*period
    k = np.searchsorted(np.array(knots), x, side=\"right\")
    d, piece = x - np.array(knots)[np.maximum(k - 1, 0)], np.array(pieces)[k]
    out = 0.0
    for power in range(3, order - 1, -1):
        out = out*d + piece[power]*np.prod(np.arange(power - order + 1, power + 1.0))
    return out
";

/// Evaluates a table of two arguments.
const BICUBIC: &str = "

def piece_(x, knots, period):
    \"\"\"The piece between knots in which x lies, and how far from the knot before.\"\"\"
    if period is not None:
        x = x - np.floor((x - knots[0])/period)*period
    k = np.searchsorted(np.array(knots), x, side=\"right\")
    return k, x - np.array(knots)[np.maximum(k - 1, 0)]


def powers_(d, order):
    \"\"\"1, d, d**2 and d**3, as often differentiated.\"\"\"
    return np.array([d**max(k - order, 0)*np.prod(np.arange(k - order + 1, k + 1.0)) for k in range(4)])


def bicubic_(x, y, orders, knots, pieces, periods):
    \"\"\"Bicubics on a grid, straight beyond it; orders: how often they are differentiated by x and by y.\"\"\"
    (row, d), (column, e) = (piece_(z, k, period) for z, k, period in zip((x, y), knots, periods))
    return powers_(d, orders[0]) @ np.array(pieces)[row*(len(knots[1]) + 1) + column] @ powers_(e, orders[1])
";

/// Accelerations and the state's rate of mechanisms without constraints.
const FREE: &str = r#"

def accelerations(t, q, v, p=PARAMETERS, phase={start}{=more}):
    """q'' = -M^-1 h."""
    return np.linalg.solve(mass_matrix(t, q, v, p, phase{more}), -bias(t, q, v, p, phase{more}))


def rate(t, x, p=PARAMETERS, phase={start}{=more}):
    """The rate of the state (q, q')."""
    q, v = np.split(np.asarray(x, dtype=float), 2)
    return np.concatenate([v, accelerations(t, q, v, p, phase{more})])
"#;

/// The same with constraints.
const CONSTRAINED: &str = r#"

def accelerations(t, q, v, p=PARAMETERS, phase={start}{=more}):
    """q'' and the multipliers of the phase's rows, the least ones where rows depend on each other."""
    rows = np.array(list(PHASES.values())[phase], dtype=int)
    M = mass_matrix(t, q, v, p, phase{more})
    J = constraint_matrix(t, q, v, p, phase{more})[rows, :]
    B = friction(t, q, v, p, phase{more})[:, rows]
    gamma = constraint_bias(t, q, v, p, phase{more})[rows]
    n, m = len(COORDINATES), {rank}
    push = J.T + B
{choose}    K = np.block([[M, -push], [J, np.zeros((m, m))]])
    right = np.concatenate([-bias(t, q, v, p, phase{more}), -gamma])
    x = np.linalg.lstsq(K, right, rcond=None)[0] if m else np.linalg.solve(K, right)
    return x[:n], {multipliers}


def rate(t, x, p=PARAMETERS, phase={start}{=more}):
    """The rate of the state (q, q'); nothing here corrects the drift from constraints, locates events or changes phases."""
    q, v = np.split(np.asarray(x, dtype=float), 2)
    return np.concatenate([v, accelerations(t, q, v, p, phase{more})[0]])
"#;

/// What chooses rows where some depend on others, by the rule of runs.
const INDEPENDENT: &str = r#"

def independent_(M, J, rank):
    """As many rows of J as are independent in general, by the pivots of J W^-1 J^T, and what makes the least multipliers of all rows of theirs.
    W = M + J^T R J moves as M does, and is regular where M alone need not be."""
    tiny = np.finfo(float).tiny
    W = M + (J.T*(np.max(np.diag(M))/np.maximum(np.sum(J*J, axis=1), tiny))) @ J
    S = J @ np.linalg.solve(W, J.T)
    lengths = np.sqrt(np.maximum(np.diag(S), tiny))
    S = S/lengths/lengths[:, None]
    left, kept = S, []
    for _ in range(rank):
        k = np.argmax(np.diag(left))
        kept = kept + [k]
        left = left - left[:, k][:, None]*left[k]/np.maximum(left[k, k], np.finfo(float).eps)
    kept = np.array(kept, dtype=int)
    return kept, S[kept].T/lengths[:, None]
"#;
/// In the place of the rows of a phase those that are chosen.
const CHOOSE: &str = "    kept, least = independent_(M, J, m)
    J, push, gamma = J[kept], push @ least, gamma[kept]
";

/// The module's text; `name` is what a person imports it as.
pub fn python(program: &Program, name: &str) -> String {
    let mut module =
        Module { program, graph: program.model.graph.clone(), names: Names::new(program), out: String::new() };
    module.head(name);
    module.tables();
    module.tables_2d();
    module.inputs();
    let n = program.model.coordinates.len();
    module.matrix(
        "mass_matrix",
        "M(t, q), n by n, symmetric, in SI units; of v only states of first order in masses are read.",
        &program.mass,
        (n, n),
        true,
    );
    module.vector("bias", "h(t, q, q'), with M q'' + h = 0 where no constraint acts.", &program.bias);
    let rows = program.constraints.len();
    if rows > 0 {
        let list = &program.constraints;
        module.matrix(
            "constraint_matrix",
            "J(t, q) of all rows: J q'' + gamma = 0 in the rows of the phase.",
            &list.matrix,
            (rows, n),
            false,
        );
        module.vector("constraint_bias", "gamma(t, q, q') of all rows.", &list.bias);
        module.matrix(
            "friction",
            "B(t, q, q'): forces that multipliers cause beside J^T lambda.",
            &list.friction,
            (n, rows),
            false,
        );
    }
    module.tail(rows > 0);
    module.out
}

struct Module<'a> {
    program: &'a Program,
    graph: Graph,
    names: Names,
    out: String,
}

/// Identifiers of the module's functions.
struct Names {
    parameters: Vec<String>,
    coordinates: Vec<[String; 2]>,
    inputs: Vec<[String; 3]>,
    memory: Vec<String>,
}

impl Names {
    fn new(program: &Program) -> Names {
        let model = &program.model;
        let tables = program.tables().into_iter().map(Python::table);
        let tables = tables.chain(program.tables_2d().into_iter().map(Python::table_2d));
        let mut taken: HashSet<String> = TAKEN.iter().map(|name| (*name).to_owned()).chain(tables).collect();
        let mut fresh = |wanted: String| {
            let mut name = wanted;
            while !taken.insert(name.clone()) {
                name.push('_');
            }
            name
        };
        let plain = |name: &str| local_name(name).trim_start_matches("r#").to_owned();
        Names {
            coordinates: model
                .coordinates
                .iter()
                .map(|c| ["", "_dot"].map(|suffix| fresh(plain(&c.name) + suffix)))
                .collect(),
            parameters: model.parameters.iter().map(|p| fresh(plain(&p.name))).collect(),
            inputs: model
                .inputs
                .iter()
                .map(|u| ["", "_dot", "_ddot"].map(|suffix| fresh(plain(&u.name) + suffix)))
                .collect(),
            memory: model.memory.iter().map(|held| fresh(plain(&held.name))).collect(),
        }
    }

    fn of(&self, symbol: Symbol) -> String {
        match symbol {
            Symbol::Coordinate(i) => self.coordinates[i as usize][0].clone(),
            Symbol::Speed(i) => self.coordinates[i as usize][1].clone(),
            Symbol::Parameter(i) => self.parameters[i as usize].clone(),
            Symbol::Input(k, order @ 0..=2) => self.inputs[k as usize][usize::from(order)].clone(),
            Symbol::Memory(k) => self.memory[k as usize].clone(),
            Symbol::Phase(k) => format!("(phase == {k})"),
            Symbol::Time => "t".to_owned(),
            // Nothing else is left in what is printed.
            _ => "np.nan".to_owned(),
        }
    }
}

impl Module<'_> {
    fn line(&mut self, line: &str) {
        self.out += line;
        self.out.push('\n');
    }

    /// The place of the phase in which the scene starts.
    fn start(&self) -> usize {
        self.program.model.scenes.first().map_or(0, |scene| scene.phase)
    }

    fn head(&mut self, name: &str) {
        let (model, start) = (&self.program.model, self.start());
        let about = model.about.trim().replace('\\', "\\\\").replace("\"\"\"", "'''");
        let about = if about.is_empty() { String::new() } else { format!("\n{about}\n") };
        let strings = |names: &mut dyn Iterator<Item = &String>| {
            names.map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")
        };
        let coordinates = strings(&mut model.coordinates.iter().map(|c| &c.name));
        let driven = if self.program.signals.is_empty() { "" } else { "; other inputs: `u={...}`" };
        let mut text = format!(
            "\"\"\"{}: equations of motion, M q'' + h = 0, generated by dalembert.\n{about}\n\
             All numbers are in SI units. To integrate with SciPy:\n\n    \
             solve_ivp({name}.rate, (0, 10), x0)\n\n\
             where x0 has the coordinates, then their rates. Other parameters: `p = {name}.PARAMETERS | {{...}}`{driven}.\n\"\"\"\n\n\
             import numpy as np\n\nCOORDINATES = [{coordinates}]\n\nPARAMETERS = {{\n",
            model.name
        );
        for parameter in &model.parameters {
            let unit = parameter.unit.as_deref().map(super::si_unit).filter(|unit| !unit.is_empty());
            let unit = unit.map_or_else(String::new, |unit| format!("  # {unit}"));
            let _ = writeln!(text, "    {:?}: {:?},{unit}", parameter.name, parameter.default);
        }
        text += "}\n";
        if !self.program.constraints.is_empty() {
            let _ = writeln!(
                text,
                "\n# Phases, and the rows of the constraints that act in each; with these parameters the scene starts in that of place {start}.\nPHASES = {{"
            );
            for phase in &model.phases {
                let _ = writeln!(text, "    {:?}: {:?},", phase.name, model.rows_of(phase));
            }
            let rows =
                strings(&mut (0..self.program.constraints.len()).map(|k| model.row_name(k)).collect::<Vec<_>>().iter());
            let _ = writeln!(text, "}}\n\nROWS = [{rows}]");
            if self.is_overdetermined() {
                let ranks: Vec<String> = (0..model.phases.len()).map(|k| self.program.rank_of(k).to_string()).collect();
                let _ =
                    writeln!(text, "\n# How many rows of each phase are independent.\nRANKS = [{}]", ranks.join(", "));
            }
        } else if model.phases.len() > 1 {
            let names = strings(&mut model.phases.iter().map(|phase| &phase.name));
            let _ = writeln!(
                text,
                "\n# Phases; with these parameters the scene starts in that of place {start}.\nPHASES = [{names}]"
            );
        }
        if !model.memory.is_empty() {
            text += "\n# What is held between events, as at the start; nothing here sets it.\nMEMORY = {\n";
            let parameters: Vec<f64> = model.parameters.iter().map(|p| p.default).collect();
            let values = evaluate_all(&model.graph, &self.program.memory_of_scene(0), &parameters);
            for (held, value) in model.memory.iter().zip(values) {
                let _ = writeln!(text, "    {:?}: {value:?},", held.name);
            }
            text += "}\n";
        }
        self.out += &text;
    }

    /// What functions of the state take more, with its defaults and without: what is held, and inputs that are given.
    fn more(&self) -> [String; 2] {
        let held = !self.program.model.memory.is_empty();
        let driven = !self.program.signals.is_empty();
        let of =
            |texts: [&str; 2]| texts.into_iter().zip([held, driven]).filter(|one| one.1).map(|one| one.0).collect();
        [of([", memory=MEMORY", ", u=None"]), of([", memory", ", u"])]
    }

    /// A function of the state, with its documentation.
    fn function(&mut self, name: &str, about: &str) {
        let ([more, _], start) = (self.more(), self.start());
        self.line(&format!("\n\ndef {name}(t, q, v, p=PARAMETERS, phase={start}{more}):\n    \"\"\"{about}\"\"\""));
    }

    /// The functions that the file gives by points.
    fn tables(&mut self) {
        let tables: Vec<Table> = self.program.tables().into_iter().filter(|table| !table.is_counter()).collect();
        if tables.is_empty() {
            return;
        }
        self.out += PIECES;
        for table in tables {
            let numbers = |numbers: &[f64]| numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ");
            let period = table.period().map_or_else(|| "None".to_owned(), |period| format!("{period:?}"));
            let pieces: Vec<String> = table.pieces().iter().map(|piece| format!("[{}]", numbers(piece))).collect();
            let _ = writeln!(
                self.out,
                "\n\ndef {}(x, order=0):\n    \"\"\"A table of the model, or one of its derivatives.\"\"\"\n    \
                 knots = [{}]\n    pieces = [{}]\n    return pieces_(x, order, knots, pieces, {period})",
                Python::table(table),
                numbers(table.knots()),
                pieces.join(", "),
            );
        }
    }

    /// Those of two arguments.
    fn tables_2d(&mut self) {
        let tables = self.program.tables_2d();
        if !tables.is_empty() {
            self.out += BICUBIC;
        }
        for table in tables {
            let numbers = |numbers: &[f64]| numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ");
            let [x, y] = table.knots().each_ref().map(|knots| numbers(knots));
            let rows = |piece: &[[f64; 4]; 4]| piece.map(|row| format!("[{}]", numbers(&row))).join(", ");
            let pieces: Vec<String> = table.pieces().iter().map(|piece| format!("[{}]", rows(piece))).collect();
            let periods = table.periods().map(|period| period.map_or_else(|| "None".to_owned(), |p| format!("{p:?}")));
            let _ = writeln!(
                self.out,
                "\n\ndef {}(x, y, orders=(0, 0)):\n    \"\"\"A table of the model, or one of its derivatives.\"\"\"\n    \
                 knots = [[{x}], [{y}]]\n    pieces = [{}]\n    return bicubic_(x, y, orders, knots, pieces, [{}])",
                Python::table_2d(table),
                pieces.join(", "),
                periods.join(", "),
            );
        }
    }

    fn inputs(&mut self) {
        if self.program.signals.is_empty() {
            return;
        }
        let roots: Vec<Id> = self.program.signals.iter().flatten().copied().collect();
        let names: Vec<String> = self.program.model.inputs.iter().map(|input| format!("{:?}", input.name)).collect();
        self.line(&format!(
            "\n\nINPUTS = [{}]\n\n\ndef inputs(t, p=PARAMETERS, u=None):\n    \"\"\"Each input with its two rates; those in the mapping `u` have these \
             values, which stay.\"\"\"",
            names.join(", ")
        ));
        let values = self.body(&roots);
        let rows: Vec<String> = values.chunks(3).map(|row| format!("        [{}],\n", row.join(", "))).collect();
        self.line(&format!("    rows = [\n{}    ]\n    given = {{}} if u is None else u", rows.concat()));
        self.line(
            "    return np.array([[given[k], 0.0, 0.0] if k in given else row for k, row in zip(INPUTS, rows)], dtype=float)",
        );
    }

    fn matrix(&mut self, name: &str, about: &str, entries: &[Entry], (rows, columns): (usize, usize), symmetric: bool) {
        self.function(name, about);
        let roots: Vec<Id> = entries.iter().map(|e| e.2).collect();
        let values = self.body(&roots);
        self.line(&format!("    out = [[0.0]*{columns} for _ in range({rows})]"));
        for ((i, j, _), value) in entries.iter().zip(values) {
            let mirrored = if symmetric && i != j { format!("out[{j}][{i}] = ") } else { String::new() };
            self.line(&format!("    out[{i}][{j}] = {mirrored}{value}"));
        }
        self.line("    return np.array(out, dtype=float)");
    }

    fn vector(&mut self, name: &str, about: &str, roots: &[Id]) {
        self.function(name, about);
        let values = self.body(roots);
        self.line(&format!("    return np.array([{}], dtype=float)", values.join(", ")));
    }

    /// Names what is read, then the parts; gives the values.
    fn body(&mut self, roots: &[Id]) -> Vec<String> {
        let roots = without_modes(&mut self.graph, roots, &self.program.switches);
        let symbols = self.graph.symbols(roots.iter().copied());
        let formulas = Formulas::new(&self.graph, &roots);
        let model = &self.program.model;
        let mut lines = String::new();
        for (i, parameter) in model.parameters.iter().enumerate() {
            if symbols.contains(&Symbol::Parameter(i as u32)) {
                let _ = writeln!(lines, "    {} = p[{:?}]", self.names.parameters[i], parameter.name);
            }
        }
        for (order, array) in ["q", "v"].into_iter().enumerate() {
            let symbol = |i: usize| if order == 0 { Symbol::Coordinate(i as u32) } else { Symbol::Speed(i as u32) };
            for i in (0..model.coordinates.len()).filter(|i| symbols.contains(&symbol(*i))) {
                let _ = writeln!(lines, "    {} = {array}[{i}]", self.names.coordinates[i][order]);
            }
        }
        for (j, held) in model.memory.iter().enumerate() {
            if symbols.contains(&Symbol::Memory(j as u32)) {
                let _ = writeln!(lines, "    {} = memory[{:?}]", self.names.memory[j], held.name);
            }
        }
        let is_input = |s: &Symbol| matches!(s, Symbol::Input(..));
        if symbols.iter().any(is_input) {
            let names: Vec<String> = self.names.inputs.iter().map(|u| format!("({})", u.join(", "))).collect();
            let _ = writeln!(lines, "    {}, = inputs(t, p, u)", names.join(", "));
        }
        let symbol = |s: Symbol| self.names.of(s);
        let writer = Python { symbol: &symbol };
        for (place, part) in formulas.parts.iter().enumerate() {
            let _ = writeln!(lines, "    {} = {}", Python::part(place), writer.signed(false, part));
        }
        let values = formulas.roots.iter().map(|(negative, root)| writer.signed(*negative, root)).collect();
        self.out += &lines;
        values
    }

    /// Whether rows of a phase depend on each other.
    fn is_overdetermined(&self) -> bool {
        let model = &self.program.model;
        let depends = |(k, phase)| self.program.rank_of(k) < model.rows_of(phase).len();
        model.phases.iter().enumerate().any(depends)
    }

    /// Accelerations with constraints; rows are chosen where some depend on others.
    fn constrained(&self) -> String {
        let [independent, choose, rank, multipliers] = match self.is_overdetermined() {
            true => [INDEPENDENT, CHOOSE, "RANKS[phase]", "least @ x[n:]"],
            false => ["", "", "len(rows)", "x[n:]"],
        };
        let text = CONSTRAINED.replace("{choose}", choose).replace("{rank}", rank);
        independent.to_owned() + &text.replace("{multipliers}", multipliers)
    }

    fn tail(&mut self, constrained: bool) {
        let [default, more] = self.more();
        let text = if constrained { self.constrained() } else { FREE.to_owned() };
        let text = text.replace("{start}", &self.start().to_string());
        self.out += &text.replace("{=more}", &default).replace("{more}", &more);
    }
}
