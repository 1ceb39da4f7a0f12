//! Formulas in LaTeX.

use super::{Formula, Power, sum};
use crate::expr::{DoubleDouble, Number, Symbol};
use crate::model::{Model, symbol_text};

/// Writes formulas in LaTeX.
pub struct Latex<'a> {
    /// For names.
    pub model: &'a Model,
}

impl Latex<'_> {
    /// A formula with its sign.
    pub fn signed(&self, negative: bool, formula: &Formula) -> String {
        match (negative, formula) {
            (false, _) => self.written(formula),
            (true, Formula::Sum(_)) => format!("-{}", self.grouped(formula)),
            (true, _) => format!("-{}", self.written(formula)),
        }
    }

    /// The name of a part.
    pub fn part(place: usize) -> String {
        format!("s_{{{}}}", place + 1)
    }

    /// A name of the file with its primes.
    pub fn symbol(&self, symbol: Symbol) -> String {
        let text = symbol_text(self.model, symbol);
        if let Symbol::Multiplier(row) = symbol {
            return format!("\\lambda_{{{}}}", upright(&self.model.row_name(row as usize)));
        }
        if let Symbol::Phase(_) = symbol {
            return format!("[{}]", upright(text.trim_matches(['(', ')'])));
        }
        let primes = text.len() - text.trim_end_matches('\'').len();
        // The dot stands over the letter, not over its index.
        let (letter, index) = letter_and_index(text.trim_end_matches('\''));
        match primes {
            0 => format!("{letter}{index}"),
            1 => format!("\\dot{{{letter}}}{index}"),
            2 => format!("\\ddot{{{letter}}}{index}"),
            _ => format!("{letter}{index}^{{({primes})}}"),
        }
    }

    fn written(&self, formula: &Formula) -> String {
        match formula {
            Formula::Number(number) => self::number(*number),
            Formula::Symbol(symbol) => self.symbol(*symbol),
            Formula::Part(place) => Self::part(*place),
            Formula::Sum(terms) => sum(terms, |term| match term {
                Formula::Sum(_) => self.grouped(term),
                _ => self.written(term),
            }),
            Formula::Product(number, above, below) => self.product(*number, above, below),
            Formula::Table(table, x) => {
                let primes = "'".repeat(table.order().into());
                format!("{}{primes}\\left({}\\right)", name(table.whole().name()), self.written(x))
            }
            Formula::Table2d(table, arguments) => {
                let [of_x, of_y] = table.order().map(usize::from);
                let by = match of_x + of_y {
                    0 => String::new(),
                    _ => format!("_{{{}{}}}", "x".repeat(of_x), "y".repeat(of_y)),
                };
                let function = format!("{{{}}}{by}", name(table.whole().name()));
                format!("{function}\\left({}\\right)", self.list(arguments))
            }
            Formula::Call("^", arguments) => {
                let [base, exponent] = arguments.as_slice() else { return String::new() };
                format!("{}^{{{}}}", self.base(base), self.written(exponent))
            }
            Formula::Call("abs", arguments) => format!("\\left|{}\\right|", self.list(arguments)),
            Formula::Call(function, arguments) => {
                let function = match *function {
                    "sin" | "cos" | "tan" | "sinh" | "cosh" | "tanh" | "exp" | "ln" | "min" | "max" => {
                        format!("\\{function}")
                    }
                    "asin" | "acos" | "atan" => format!("\\arc{}", &function[1..]),
                    "sign" => "\\operatorname{sgn}".to_owned(),
                    other => format!("\\operatorname{{{other}}}"),
                };
                match arguments.as_slice() {
                    [one] if matches!(**one, Formula::Symbol(_)) => format!("{function} {}", self.written(one)),
                    _ => format!("{function}\\left({}\\right)", self.list(arguments)),
                }
            }
        }
    }

    fn product(&self, number: Number, above: &[Power], below: &[Power]) -> String {
        let (top, bottom) = match number {
            Number::Exact(r) if r.denominator() != 1 => (r.numerator().to_string(), r.denominator().to_string()),
            _ => (self::number(number), "1".to_owned()),
        };
        let side = |number: String, powers: &[Power]| {
            let mut factors: Vec<String> = powers.iter().map(|power| self.power(power)).collect();
            if number != "1" || factors.is_empty() {
                factors.insert(0, number);
            }
            factors.join(" \\, ")
        };
        // m g/2, but a number alone before what is long.
        if below.is_empty() && bottom != "1" {
            return format!("\\frac{{{top}}}{{{bottom}}} \\, {}", side("1".to_owned(), above));
        }
        if below.is_empty() {
            return side(top, above);
        }
        format!("\\frac{{{}}}{{{}}}", side(top, above), side(bottom, below))
    }

    fn power(&self, Power { base, halves }: &Power) -> String {
        match halves {
            1 => format!("\\sqrt{{{}}}", self.written(base)),
            2 if matches!(**base, Formula::Sum(_)) => self.grouped(base),
            2 => self.written(base),
            n => {
                let exponent = if n % 2 == 0 { (n / 2).to_string() } else { format!("{n}/2") };
                match &**base {
                    Formula::Call(function @ ("sin" | "cos" | "tan"), arguments) => {
                        format!("\\{function}^{{{exponent}}} \\left({}\\right)", self.list(arguments))
                    }
                    _ => format!("{}^{{{exponent}}}", self.base(base)),
                }
            }
        }
    }

    fn base(&self, base: &Formula) -> String {
        match base {
            Formula::Symbol(_) | Formula::Part(_) => format!("{{{}}}", self.written(base)),
            _ => self.grouped(base),
        }
    }

    fn grouped(&self, formula: &Formula) -> String {
        format!("\\left({}\\right)", self.written(formula))
    }

    fn list(&self, formulas: &[std::rc::Rc<Formula>]) -> String {
        formulas.iter().map(|x| self.written(x)).collect::<Vec<_>>().join(", ")
    }
}

fn number(number: Number) -> String {
    match number {
        Number::Exact(r) if r.denominator() == 1 => r.numerator().to_string(),
        Number::Exact(r) => format!("\\frac{{{}}}{{{}}}", r.numerator(), r.denominator()),
        Number::Float(x) if x == DoubleDouble::PI => "\\pi".to_owned(),
        Number::Float(x) => match format!("{:e}", x.to_f64()).split_once('e') {
            Some((_, exponent)) if exponent.parse::<i32>().is_ok_and(|e| (-4..6).contains(&e)) => {
                x.to_f64().to_string()
            }
            Some((digits, exponent)) => format!("{digits} \\cdot 10^{{{exponent}}}"),
            None => x.to_f64().to_string(),
        },
    }
}

/// Letters that have a command of their own.
const GREEK: &[&str] = &[
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi",
    "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega", "Gamma", "Delta", "Theta", "Lambda", "Xi",
    "Pi", "Sigma", "Upsilon", "Phi", "Psi", "Omega",
];

/// `theta1`, `theta[1]` and `theta_1` with an index below; a Greek letter by its command, words upright.
pub(super) fn name(name: &str) -> String {
    let (letter, index) = letter_and_index(name);
    letter + &index
}

/// The letter of a name, and its index as it stands below; empty where it has none.
fn letter_and_index(name: &str) -> (String, String) {
    let (stem, index) = match name.split_once('[') {
        Some((stem, index)) => (stem, index.trim_end_matches(']').to_owned()),
        None => (name, String::new()),
    };
    let (stem, below) = match stem.split_once('_') {
        Some((stem, below)) if !stem.is_empty() && !below.is_empty() => (stem, below),
        _ => {
            let letters = stem.trim_end_matches(|c: char| c.is_ascii_digit());
            if letters.is_empty() { (stem, "") } else { (letters, &stem[letters.len()..]) }
        }
    };
    let letter = if GREEK.contains(&stem) {
        format!("\\{stem}")
    } else if stem.chars().count() == 1 && stem != "_" {
        stem.to_owned()
    } else {
        upright(stem)
    };
    let below = match below.chars().all(|c| c.is_ascii_digit()) || below.chars().count() == 1 {
        true => below.to_owned(),
        false if GREEK.contains(&below) => format!("\\{below}"),
        false => upright(below),
    };
    let indices: Vec<String> = [below, index].into_iter().filter(|i| !i.is_empty()).collect();
    let index = if indices.is_empty() { String::new() } else { format!("_{{{}}}", indices.join(",")) };
    (letter, index)
}

fn upright(words: &str) -> String {
    format!("\\mathrm{{{}}}", words.replace('_', "\\_").replace(' ', "\\ "))
}

#[cfg(test)]
mod tests {
    use super::name;

    #[test]
    fn names_get_their_letters_and_indices() {
        for (plain, latex) in [
            ("theta1", "\\theta_{1}"),
            ("x[3]", "x_{3}"),
            ("m_cart", "m_{\\mathrm{cart}}"),
            ("k12[2]", "k_{12,2}"),
            ("tension", "\\mathrm{tension}"),
            ("_x", "\\mathrm{\\_x}"),
            ("I", "I"),
        ] {
            assert_eq!(name(plain), latex);
        }
    }
}
