//! `fn expansion(…)`: the power series of a motion order by order, as statements without a loop.
//!
//! What [`Series`] gives as data for a loop to walk through is written out here: every coefficient is a variable, and those that vanish whatever the
//! motion are not there.  The terms of a sum stand in the order in which their factors are known, so that the sum waits for the last of them only.

use std::collections::BTreeSet;
use std::fmt::Write;

use crate::expr::Unary;
use crate::lower::{Place, Recurrence, Series};

/// The highest order of q and q', as the runtime has it: its array has one number more.
const ORDER: usize = 20;
/// Convolutions up to which statements are written out.  Each takes some 200 multiplications; the code of more does not stay in the first cache, and the
/// compiler needs seconds for it.
const CONVOLUTIONS: usize = 24;
/// Pivots of M beneath this part of their diagonal are left to the pivoted system, which refines its solutions.
const PIVOT: f64 = 1e-6;

/// The function, where a model is small and nothing constrains it.
pub(super) fn expansion(series: &Series, n: usize) -> Option<String> {
    let moves = |place: &Place| matches!(place, Place::Row(_));
    let convolutions: usize = series.rows.iter().map(|row| convolutions(*row)).sum::<usize>()
        + series
            .mass
            .iter()
            .map(|(i, j, value)| {
                if !moves(value) {
                    0
                } else if i == j {
                    1
                } else {
                    2
                }
            })
            .sum::<usize>();
    if !series.written || n == 0 || !series.constraint_bias.is_empty() || convolutions > CONVOLUTIONS {
        return None;
    }
    let mut writer = Writer::new(series, n);
    writer.begin();
    for k in 0..ORDER {
        writer.rows(k);
        if k == 0 {
            writer.factors();
        }
        writer.accelerations(k);
    }
    writer.state();
    Some(format!(
        "\n    fn expansion(c: &Self::Constants<f64>, u: &[f64], t: f64, unit: f64, state: &mut [[f64; {}]]) -> bool {{\n        \
         let mut k = [0.0; {}];\n        Self::series_constants(c, 0.0, u, &mut k);\n{}        true\n    }}\n",
        ORDER + 1,
        series.constants.len(),
        writer.out
    ))
}

/// How many sums over all orders a row takes.
fn convolutions(row: Recurrence) -> usize {
    match row {
        Recurrence::Product(..) | Recurrence::Quotient(..) | Recurrence::Grown { .. } | Recurrence::Divided { .. } => 1,
        Recurrence::Square(_) | Recurrence::Root(_) => 1,
        Recurrence::Power(..) => 2,
        Recurrence::Angle { .. } => 3,
        _ => 0,
    }
}

/// A coefficient's name; `None` where it vanishes.
type Coefficient = Option<String>;

struct Writer<'a> {
    series: &'a Series,
    n: usize,
    out: String,
    /// Coefficients of each row, order by order.
    rows: Vec<Vec<Coefficient>>,
    /// k times as much, of those rows that are asked for it.
    rates: Vec<Vec<Coefficient>>,
    asked: BTreeSet<usize>,
    accelerations: Vec<Vec<Coefficient>>,
}

impl<'a> Writer<'a> {
    fn new(series: &'a Series, n: usize) -> Writer<'a> {
        let mut asked = BTreeSet::new();
        for (row, recurrence) in series.rows.iter().enumerate() {
            match recurrence {
                Recurrence::Power(a, _) | Recurrence::Grown { of: a, .. } => _ = asked.insert(*a),
                Recurrence::Divided { .. } => _ = asked.insert(row),
                Recurrence::Angle { y, x, .. } => asked.extend([row, *y, *x]),
                _ => {}
            }
        }
        Writer {
            series,
            n,
            out: String::new(),
            rows: vec![Vec::new(); series.rows.len()],
            rates: vec![Vec::new(); series.rows.len()],
            asked,
            accelerations: vec![Vec::new(); n],
        }
    }

    /// `let name = value;`
    fn bind(&mut self, name: String, value: &str) -> Coefficient {
        let _ = writeln!(self.out, "        let {name} = {value};");
        Some(name)
    }

    /// The coefficients of the state at order 0, and the unit of time divided by each order.
    fn begin(&mut self) {
        for i in 0..self.n {
            let _ = writeln!(self.out, "        let (q{i}_0, v{i}_0) = (state[{i}][0], state[{}][0]);", self.n + i);
        }
        for k in 1..=ORDER {
            let _ = writeln!(self.out, "        let unit_{k} = unit * (1.0 / {k}.0);");
        }
    }

    /// All rows' coefficients of an order.
    fn rows(&mut self, k: usize) {
        for (row, recurrence) in self.series.rows.iter().enumerate() {
            let value = self.value(row, *recurrence, k);
            let name = match value {
                // A name stands for itself.
                Some(value) if value.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_') => Some(value),
                Some(value) => self.bind(format!("r{row}_{k}"), &value),
                None => None,
            };
            if self.asked.contains(&row) {
                let rate = match &name {
                    Some(name) if k > 1 => self.bind(format!("s{row}_{k}"), &format!("{k}.0 * {name}")),
                    Some(name) if k == 1 => Some(name.clone()),
                    _ => None,
                };
                self.rates[row].push(rate);
            }
            self.rows[row].push(name);
        }
    }

    /// A row's coefficient of an order as an expression.
    fn value(&mut self, row: usize, recurrence: Recurrence, k: usize) -> Coefficient {
        let of = |row: usize| self.rows[row].get(k).cloned().flatten();
        let known = |a: Coefficient| a.unwrap_or_else(|| "0.0".to_owned());
        let inverse = format!("i{row}");
        match recurrence {
            Recurrence::Time => [Some("t".to_owned()), Some("unit".to_owned())].get(k).cloned().flatten(),
            Recurrence::Coordinate(i) => Some(format!("q{i}_{k}")),
            Recurrence::Speed(i) => Some(format!("v{i}_{k}")),
            Recurrence::Constant(c) => (k == 0).then(|| format!("k[{c}]")),
            Recurrence::Sum(a, b) => match (of(a), of(b)) {
                (Some(a), Some(b)) => Some(format!("{a} + {b}")),
                (a, b) => a.or(b),
            },
            Recurrence::Difference(a, b) => minus(of(a), of(b)),
            Recurrence::Negative(a) => of(a).map(|a| format!("-{a}")),
            Recurrence::Shifted(a, c) if k == 0 => Some(format!("{} + k[{c}]", known(of(a)))),
            Recurrence::Reduced(a, c) if k == 0 => Some(format!("{} - k[{c}]", known(of(a)))),
            Recurrence::Shifted(a, _) | Recurrence::Reduced(a, _) => of(a),
            Recurrence::Scaled(a, c) => of(a).map(|a| format!("k[{c}] * {a}")),
            Recurrence::Parted(a, c) => of(a).map(|a| format!("{a} / k[{c}]")),
            Recurrence::Product(a, b) => sum(&pairs(&self.rows[a], &self.rows[b], k, 0..=k)),
            Recurrence::Square(a) => half(&self.rows[a], k, 0),
            Recurrence::Quotient(a, b) if k == 0 => {
                let (a, b) = (known(of(a)), known(of(b)));
                self.bind(inverse, &format!("1.0 / {b}"));
                Some(format!("{a} / {b}"))
            }
            Recurrence::Quotient(a, b) => {
                let among = sum(&pairs(&self.rows[row], &self.rows[b], k, 0..=k - 1));
                times(minus(of(a), among), &inverse)
            }
            Recurrence::Root(a) if k == 0 => {
                let root = format!("f64::sqrt({})", known(of(a)));
                let name = format!("r{row}_0");
                self.bind(name.clone(), &root);
                self.bind(inverse, &format!("0.5 / {name}"));
                Some(name)
            }
            Recurrence::Root(a) => times(minus(of(a), half(&self.rows[row], k, 1)), &inverse),
            Recurrence::Power(a, c) if k == 0 => {
                let a = known(of(a));
                self.bind(inverse, &format!("1.0 / {a}"));
                self.bind(format!("p{row}"), &format!("k[{c}] + 1.0"));
                Some(format!("f64::powf({a}, k[{c}])"))
            }
            Recurrence::Power(a, _) => {
                let moved = sum(&pairs(&self.rates[a], &self.rows[row], k, 1..=k))?;
                let plain = sum(&pairs(&self.rows[a], &self.rows[row], k, 1..=k))?;
                Some(format!("((1.0 / {k}.0) * p{row} * ({moved}) - ({plain})) * {inverse}"))
            }
            Recurrence::Grown { function, of: a, .. } if k == 0 => Some(call(function, &known(of(a)))),
            Recurrence::Divided { function, of: a, by, .. } if k == 0 => {
                let (value, by) = (call(function, &known(of(a))), known(of(by)));
                self.bind(inverse, &format!("1.0 / {by}"));
                Some(value)
            }
            Recurrence::Grown { of: a, by, falls, .. } => {
                let moved = sum(&pairs(&self.rates[a], &self.rows[by], k, 1..=k))?;
                Some(format!("({}1.0 / {k}.0) * ({moved})", if falls { "-" } else { "" }))
            }
            Recurrence::Divided { of: a, by, falls, .. } => {
                let among = sum(&pairs(&self.rates[row], &self.rows[by], k, 1..=k - 1));
                let moved = if falls { of(a).map(|a| format!("-{a}")) } else { of(a) };
                times(minus(moved, times(among, &format!("(1.0 / {k}.0)"))), &inverse)
            }
            Recurrence::Angle { y, x, square } if k == 0 => {
                let (value, square) = (format!("f64::atan2({}, {})", known(of(y)), known(of(x))), known(of(square)));
                self.bind(inverse, &format!("1.0 / {square}"));
                Some(value)
            }
            Recurrence::Angle { y, x, square } => {
                let turned = minus(
                    sum(&pairs(&self.rates[y], &self.rows[x], k, 1..=k)),
                    sum(&pairs(&self.rates[x], &self.rows[y], k, 1..=k)),
                );
                let among = sum(&pairs(&self.rates[row], &self.rows[square], k, 1..=k - 1));
                times(times(minus(turned, among), &format!("(1.0 / {k}.0)")), &inverse)
            }
        }
    }

    /// An entry's coefficient of order 0.
    fn first(&self, place: Place) -> String {
        match place {
            Place::Constant(c) => format!("k[{c}]"),
            Place::Row(row) => self.rows[row][0].clone().unwrap_or_else(|| "0.0".to_owned()),
        }
    }

    /// M = L D Lᵀ at order 0.
    fn factors(&mut self) {
        for j in 0..self.n {
            for i in j..self.n {
                let entry = self.series.mass.iter().find(|entry| (entry.0, entry.1) == (i, j));
                let mut value = entry.map_or_else(|| "0.0".to_owned(), |entry| self.first(entry.2));
                let diagonal = value.clone();
                for l in 0..j {
                    let _ = write!(value, " - l{i}_{l} * (l{j}_{l} * d{l})");
                }
                if i > j {
                    self.bind(format!("l{i}_{j}"), &format!("({value}) * e{j}"));
                    continue;
                }
                self.bind(format!("d{j}"), &value);
                let _ = writeln!(
                    self.out,
                    "        if !(d{j} > {PIVOT:?} * {diagonal}) {{\n            return false;\n        }}"
                );
                self.bind(format!("e{j}"), &format!("1.0 / d{j}"));
            }
        }
    }

    /// M₀ aₖ = −hₖ − Σ Mⱼ aₖ₋ⱼ over 0 < j ≤ k, and what follows for the state.
    fn accelerations(&mut self, k: usize) {
        let mut forces: Vec<Vec<String>> = vec![Vec::new(); self.n];
        for (i, j, place) in &self.series.mass {
            let Place::Row(row) = *place else { continue };
            let later = 1..=k;
            forces[*i].extend(pairs(&self.rows[row], &self.accelerations[*j], k, later.clone()));
            if i != j {
                forces[*j].extend(pairs(&self.rows[row], &self.accelerations[*i], k, later));
            }
        }
        for (i, forces) in forces.into_iter().enumerate() {
            let h = match self.series.bias[i] {
                Place::Constant(c) => (k == 0).then(|| format!("k[{c}]")),
                Place::Row(row) => self.rows[row][k].clone(),
            };
            let mut force = minus(h.map(|h| format!("-{h}")), sum(&forces)).unwrap_or_else(|| "0.0".to_owned());
            for l in 0..i {
                let _ = write!(force, " - l{i}_{l} * y{l}_{k}");
            }
            self.bind(format!("y{i}_{k}"), &force);
        }
        for i in (0..self.n).rev() {
            let mut value = format!("y{i}_{k} * e{i}");
            for l in i + 1..self.n {
                let _ = write!(value, " - l{l}_{i} * a{l}_{k}");
            }
            let name = self.bind(format!("a{i}_{k}"), &value);
            self.accelerations[i].push(name);
        }
        let next = k + 1;
        for i in 0..self.n {
            self.bind(format!("q{i}_{next}"), &format!("unit_{next} * v{i}_{k}"));
            self.bind(format!("v{i}_{next}"), &format!("unit_{next} * a{i}_{k}"));
        }
    }

    /// Writes the coefficients of q and q'.
    fn state(&mut self) {
        for (kind, from) in [("q", 0), ("v", self.n)] {
            for i in 0..self.n {
                let names: Vec<String> = (0..=ORDER).map(|k| format!("{kind}{i}_{k}")).collect();
                let _ = writeln!(self.out, "        state[{}] = [{}];", from + i, names.join(", "));
            }
        }
    }
}

fn call(function: Unary, argument: &str) -> String {
    format!("f64::{}({argument})", function.name())
}

fn minus(a: Coefficient, b: Coefficient) -> Coefficient {
    match (a, b) {
        (Some(a), Some(b)) => Some(format!("{a} - ({b})")),
        (None, Some(b)) => Some(format!("-({b})")),
        (a, None) => a,
    }
}

fn times(a: Coefficient, factor: &str) -> Coefficient {
    a.map(|a| format!("({a}) * {factor}"))
}

/// Products aⱼ bₖ₋ⱼ that do not vanish, those known last at the end.
fn pairs(a: &[Coefficient], b: &[Coefficient], k: usize, of: std::ops::RangeInclusive<usize>) -> Vec<String> {
    let mut places: Vec<usize> = of.collect();
    places.sort_by_key(|j| (*j).max(k - j));
    let product = |j: usize| Some(format!("{} * {}", a.get(j)?.as_ref()?, b.get(k - j)?.as_ref()?));
    places.into_iter().filter_map(product).collect()
}

/// Σ aⱼ aₖ₋ⱼ from j = `from` to k − `from`, each pair once.
fn half(a: &[Coefficient], k: usize, from: usize) -> Coefficient {
    let twice = sum(&pairs(a, a, k, k / 2 + 1..=k - from)).map(|sum| format!("2.0 * ({sum})"));
    let middle = if k.is_multiple_of(2) && k / 2 >= from { a.get(k / 2).cloned().flatten() } else { None };
    match (twice, middle.map(|middle| format!("{middle} * {middle}"))) {
        (Some(twice), Some(middle)) => Some(format!("{twice} + {middle}")),
        (twice, middle) => twice.or(middle),
    }
}

/// A sum in two halves that do not wait for each other, and the two terms known last.
fn sum(terms: &[String]) -> Coefficient {
    let (early, last) = terms.split_at(terms.len().saturating_sub(2));
    let join = |terms: Vec<&str>| terms.join(" + ");
    let half = |from: usize| join(early.iter().skip(from).step_by(2).map(String::as_str).collect());
    let last = join(last.iter().map(String::as_str).collect());
    match early.len() {
        0 if terms.is_empty() => None,
        0 => Some(last),
        1 => Some(format!("{} + ({last})", half(0))),
        _ => Some(format!("(({}) + ({})) + ({last})", half(0), half(1))),
    }
}
