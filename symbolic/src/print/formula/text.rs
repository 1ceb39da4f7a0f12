//! Formulas in the model language.

use super::{Formula, Level, Notation, Power, sum};
use crate::expr::Number;
use crate::model::{Model, number_text, symbol_text};

/// Writes formulas as expressions of the model language.
pub struct Text<'a> {
    /// For names.
    pub model: &'a Model,
}

impl Text<'_> {
    /// The name of a part.
    pub fn part(place: usize) -> String {
        format!("s{}", place + 1)
    }

    fn power(&self, Power { base, halves }: &Power) -> String {
        match halves {
            1 => format!("sqrt({})", self.written(base).0),
            2 => self.at(base, Level::Power),
            n if n % 2 == 0 => format!("{}^{}", self.at(base, Level::Atom), n / 2),
            n => format!("{}^({n}/2)", self.at(base, Level::Atom)),
        }
    }
}

impl Notation for Text<'_> {
    fn written(&self, formula: &Formula) -> (String, Level) {
        match formula {
            Formula::Number(number) => self::number(*number),
            Formula::Symbol(symbol) => (symbol_text(self.model, *symbol), Level::Atom),
            Formula::Part(place) => (Self::part(*place), Level::Atom),
            Formula::Sum(terms) => (sum(terms, |term| self.at(term, Level::Product)), Level::Sum),
            Formula::Product(number, above, below) => {
                let mut factors: Vec<String> = Vec::new();
                if number.bits() != Number::ONE.bits() || above.is_empty() {
                    factors.push(match self::number(*number) {
                        (text, level) if level < Level::Product => format!("({text})"),
                        (text, _) => text,
                    });
                }
                factors.extend(above.iter().map(|power| self.power(power)));
                let mut out = factors.join("*");
                match below.as_slice() {
                    [] => {}
                    [one] => out += &format!("/{}", self.power(one)),
                    several => {
                        let below: Vec<String> = several.iter().map(|power| self.power(power)).collect();
                        out += &format!("/({})", below.join("*"));
                    }
                }
                let alone = below.is_empty() && factors.len() == 1;
                (out, if alone { Level::Power } else { Level::Product })
            }
            Formula::Table(table, x) => (format!("{}({})", table.name(), self.written(x).0), Level::Atom),
            Formula::Table2d(table, arguments) => (format!("{}({})", table.name(), self.list(arguments)), Level::Atom),
            Formula::Call("^", arguments) => {
                (arguments.iter().map(|x| self.at(x, Level::Atom)).collect::<Vec<_>>().join("^"), Level::Power)
            }
            Formula::Call(name, arguments) => (format!("{name}({})", self.list(arguments)), Level::Atom),
        }
    }
}

fn number(number: Number) -> (String, Level) {
    let whole = !matches!(number, Number::Exact(r) if r.denominator() != 1);
    (number_text(number), if whole { Level::Atom } else { Level::Product })
}
