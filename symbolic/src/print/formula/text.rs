//! Formulas in the model language.

use super::{Formula, Power};
use crate::expr::Number;
use crate::model::{Model, number_text, symbol_text};

/// Writes formulas as expressions of the model language.
pub struct Text<'a> {
    /// For names.
    pub model: &'a Model,
}

/// How tightly text holds together.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Level {
    Sum,
    Product,
    Power,
    Atom,
}

impl Text<'_> {
    /// A formula with its sign.
    pub fn signed(&self, negative: bool, formula: &Formula) -> String {
        if negative { format!("-{}", self.at(formula, Level::Product)) } else { self.written(formula).0 }
    }

    /// The name of a part.
    pub fn part(place: usize) -> String {
        format!("s{}", place + 1)
    }

    fn at(&self, formula: &Formula, level: Level) -> String {
        let (text, own) = self.written(formula);
        if own < level { format!("({text})") } else { text }
    }

    fn written(&self, formula: &Formula) -> (String, Level) {
        match formula {
            Formula::Number(number) => self::number(*number),
            Formula::Symbol(symbol) => (symbol_text(self.model, *symbol), Level::Atom),
            Formula::Part(place) => (Self::part(*place), Level::Atom),
            Formula::Sum(terms) => {
                let mut out = String::new();
                for (i, (negative, term)) in terms.iter().enumerate() {
                    out += match (i, negative) {
                        (0, false) => "",
                        (0, true) => "-",
                        (_, false) => " + ",
                        (_, true) => " - ",
                    };
                    out += &self.at(term, Level::Product);
                }
                (out, Level::Sum)
            }
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
            Formula::Call("^", arguments) => {
                (arguments.iter().map(|x| self.at(x, Level::Atom)).collect::<Vec<_>>().join("^"), Level::Power)
            }
            Formula::Call(name, arguments) => {
                let arguments: Vec<String> = arguments.iter().map(|x| self.written(x).0).collect();
                (format!("{name}({})", arguments.join(", ")), Level::Atom)
            }
        }
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

fn number(number: Number) -> (String, Level) {
    let whole = !matches!(number, Number::Exact(r) if r.denominator() != 1);
    (number_text(number), if whole { Level::Atom } else { Level::Product })
}
