//! Formulas in Python, with NumPy's functions.

use super::{Formula, Level, Notation, Power, sum};
use crate::expr::{DoubleDouble, Number, Symbol, Table, Table2d};
use crate::model::local_name;

/// Writes formulas as Python.
pub struct Python<'a> {
    /// The identifier of a symbol.
    pub symbol: &'a dyn Fn(Symbol) -> String,
}

impl Python<'_> {
    /// The name of a part.
    pub fn part(place: usize) -> String {
        format!("s{}_", place + 1)
    }

    /// The function of a table.
    pub fn table(table: Table) -> String {
        format!("{}_table_", local_name(table.whole().name()).trim_start_matches("r#"))
    }

    /// The function of a table of two arguments.
    pub fn table_2d(table: Table2d) -> String {
        format!("{}_table_", local_name(table.whole().name()).trim_start_matches("r#"))
    }

    fn power(&self, Power { base, halves }: &Power) -> String {
        match halves {
            1 => format!("np.sqrt({})", self.written(base).0),
            2 => self.at(base, Level::Atom),
            n if n % 2 == 0 => format!("{}**{}", self.at(base, Level::Atom), n / 2),
            n => format!("{}**{:.1}", self.at(base, Level::Atom), f64::from(*n) / 2.0),
        }
    }
}

impl Notation for Python<'_> {
    fn written(&self, formula: &Formula) -> (String, Level) {
        match formula {
            Formula::Number(number) => self::number(*number),
            Formula::Symbol(symbol) => ((self.symbol)(*symbol), Level::Atom),
            Formula::Part(place) => (Self::part(*place), Level::Atom),
            Formula::Sum(terms) => (sum(terms, |term| self.at(term, Level::Product)), Level::Sum),
            Formula::Product(number, above, below) => {
                let (front, _) = self::number(*number);
                let mut factors: Vec<String> = above.iter().map(|power| self.power(power)).collect();
                if front != "1" || factors.is_empty() {
                    factors.insert(0, front);
                }
                let mut out = factors.join("*");
                if !below.is_empty() {
                    let below: Vec<String> = below.iter().map(|power| self.power(power)).collect();
                    out += &format!("/({})", below.join("*"));
                }
                (out, Level::Product)
            }
            Formula::Table(table, x) => {
                let (name, order) = (Self::table(*table), table.order());
                (format!("{name}({}, {order})", self.written(x).0), Level::Atom)
            }
            Formula::Table2d(table, arguments) => {
                let (name, [of_x, of_y]) = (Self::table_2d(*table), table.order());
                (format!("{name}({}, ({of_x}, {of_y}))", self.list(arguments)), Level::Atom)
            }
            Formula::Call("^", arguments) => {
                let parts: Vec<String> = arguments.iter().map(|x| self.at(x, Level::Atom)).collect();
                (format!("({})", parts.join("**")), Level::Atom)
            }
            Formula::Call("step", arguments) => (format!("np.heaviside({}, 1.0)", self.list(arguments)), Level::Atom),
            Formula::Call(name, arguments) => {
                let name = match *name {
                    "asin" => "arcsin",
                    "acos" => "arccos",
                    "atan" => "arctan",
                    "atan2" => "arctan2",
                    "ln" => "log",
                    "min" => "minimum",
                    "max" => "maximum",
                    other => other,
                };
                (format!("np.{name}({})", self.list(arguments)), Level::Atom)
            }
        }
    }
}

fn number(number: Number) -> (String, Level) {
    let exact = |n: i128| n.unsigned_abs() < 1 << 53;
    match number {
        Number::Exact(r) if r.denominator() == 1 && exact(r.numerator()) => (r.numerator().to_string(), Level::Atom),
        Number::Exact(r) if exact(r.numerator()) && exact(r.denominator()) => {
            (format!("({}/{})", r.numerator(), r.denominator()), Level::Atom)
        }
        Number::Float(x) if x == DoubleDouble::PI => ("np.pi".to_owned(), Level::Atom),
        other => (format!("{:?}", other.to_f64()), Level::Atom),
    }
}
