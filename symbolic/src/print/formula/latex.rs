//! Formulas in LaTeX.

use super::{Formula, Power, sum};
use crate::expr::{DoubleDouble, Number, Symbol};
use crate::model::{Model, greek, spell, symbol_text};

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

    /// The same over as many lines of an `align*` as it takes, each after the first indented: broken before signs of sums, also of one that
    /// is the last factor of a long product.
    pub fn lines(&self, negative: bool, formula: &Formula) -> String {
        let whole = self.signed(negative, formula);
        if width(&whole) <= LINE {
            return whole;
        }
        let mut lines: Vec<String> = Vec::new();
        for piece in self.pieces(negative, formula) {
            match lines.last_mut() {
                Some(line) if width(line) + width(&piece) <= LINE => line.push_str(&piece),
                Some(_) => lines.push(format!("{{}}{piece}")),
                None => lines.push(piece),
            }
        }
        lines.join(" \\\\\n  & \\quad ")
    }

    /// What a formula may be broken into; pieces after the first begin with a sign.
    fn pieces(&self, negative: bool, formula: &Formula) -> Vec<String> {
        match formula {
            Formula::Sum(terms) => {
                let mut pieces = Vec::new();
                for (place, (own, term)) in terms.iter().enumerate() {
                    let mut of_term = match &**term {
                        Formula::Sum(_) => vec![self.grouped(term)],
                        _ => self.pieces(false, term),
                    };
                    let sign = match (place, negative != *own) {
                        (0, false) => "",
                        (0, true) => "-",
                        (_, false) => " + ",
                        (_, true) => " - ",
                    };
                    of_term[0].insert_str(0, sign);
                    pieces.append(&mut of_term);
                }
                pieces
            }
            Formula::Product(number, above, below)
                if below.is_empty() && width(&self.written(formula)) > LINE && above.last().is_some_and(is_sum) =>
            {
                let (last, factors) = (&above[above.len() - 1].base, &above[..above.len() - 1]);
                let mut pieces = self.pieces(false, last);
                let first = self.product(*number, factors, &[]);
                let first = if first == "1" { String::new() } else { first + " \\, " };
                let sign = if negative { "-" } else { "" };
                pieces[0].insert_str(0, &format!("{sign}{first}\\Bigl("));
                if let Some(piece) = pieces.last_mut() {
                    piece.push_str("\\Bigr)");
                }
                pieces
            }
            _ => vec![self.signed(negative, formula)],
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
        let (top, bottom) = fraction(number);
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

/// About as many letters and signs as a line of a page takes.
const LINE: usize = 80;

/// About how many letters and signs are seen of a formula: commands are one, those that only place something are none.
fn width(latex: &str) -> usize {
    const PLACES: [&str; 13] =
        ["left", "right", "Bigl", "Bigr", "mathrm", "operatorname", "frac", "sqrt", "dot", "ddot", "quad", "", "_"];
    let mut count = 0;
    let mut rest = latex;
    while let Some(letter) = rest.chars().next() {
        rest = &rest[letter.len_utf8()..];
        if letter == '\\' {
            let end = rest.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len());
            count += usize::from(!PLACES.contains(&&rest[..end]));
            rest = &rest[end..];
        } else {
            count += usize::from(!"{}^_, ".contains(letter));
        }
    }
    count
}

/// Whether a factor is a sum.
fn is_sum(power: &Power) -> bool {
    power.halves == 2 && matches!(*power.base, Formula::Sum(_))
}

fn number(number: Number) -> String {
    match fraction(number) {
        (top, bottom) if bottom == "1" => top,
        (top, bottom) => format!("\\frac{{{top}}}{{{bottom}}}"),
    }
}

/// What stands above and below the line of a number.
fn fraction(number: Number) -> (String, String) {
    match number {
        Number::Exact(r) => (r.numerator().to_string(), r.denominator().to_string()),
        Number::Float(x) => match parts_of_pi(x) {
            Some((1, parts)) => ("\\pi".to_owned(), parts.to_string()),
            Some((count, parts)) => (format!("{count} \\, \\pi"), parts.to_string()),
            None => (decimal(x.to_f64()), "1".to_owned()),
        },
    }
}

/// A number with a decimal point.
fn decimal(x: f64) -> String {
    match format!("{x:e}").split_once('e') {
        Some((digits, exponent)) if !exponent.parse::<i32>().is_ok_and(|e| (-4..6).contains(&e)) => {
            format!("{digits} \\cdot 10^{{{exponent}}}")
        }
        _ => x.to_string(),
    }
}

/// π is divided into at most so many parts: angles are written in degrees.
const MOST_PARTS: u32 = 180;
/// Numbers of some 32 digits are a part of π if they agree with it to so much of them.
const ALIKE: f64 = 1e-29;

/// How many parts of π a number is, and how many parts π has.
fn parts_of_pi(x: DoubleDouble) -> Option<(u64, u32)> {
    (1..=MOST_PARTS).find_map(|parts| {
        let count = (x.to_f64() * f64::from(parts) / std::f64::consts::PI).round();
        let off = (DoubleDouble::PI * count - x * f64::from(parts)).abs().to_f64();
        (count >= 1.0 && off <= ALIKE * count).then_some((count as u64, parts))
    })
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
    let letter = letter_or_word(stem);
    let below = if below.chars().all(|c| c.is_ascii_digit()) { below.to_owned() } else { letter_or_word(below) };
    let indices: Vec<String> = [below, index].into_iter().filter(|i| !i.is_empty()).collect();
    let index = if indices.is_empty() { String::new() } else { format!("_{{{}}}", indices.join(",")) };
    (letter, index)
}

/// A letter as it is, a Greek one and its name by its command, a word upright.
fn letter_or_word(text: &str) -> String {
    let mut letters = text.chars();
    match (letters.next(), letters.next()) {
        _ if GREEK.contains(&text) => format!("\\{text}"),
        (Some(letter), None) if letter.is_ascii_alphanumeric() => text.to_owned(),
        (Some(letter), None) if greek(letter).is_some_and(|name| GREEK.contains(&name)) => command(letter),
        _ => upright(text),
    }
}

/// The command of a Greek letter; another letter, and one that looks like a Latin one, as code has it.
fn command(letter: char) -> String {
    match greek(letter).filter(|name| GREEK.contains(name)) {
        Some(name) => format!("\\{name}"),
        None => spell(letter).trim().to_owned(),
    }
}

/// Words that every LaTeX sets: letters of other scripts as code has them.
fn upright(words: &str) -> String {
    let written = |c: char| match c {
        '_' => "\\_".to_owned(),
        ' ' => "\\ ".to_owned(),
        c if c.is_ascii() => c.to_string(),
        c if greek(c).is_some() => format!("{{{}}}", command(c)),
        c => spell(c).trim().to_owned(),
    };
    format!("\\mathrm{{{}}}", words.chars().map(written).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::{fraction, name, width};
    use crate::expr::{DoubleDouble, Number};

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
            ("θ1", "\\theta_{1}"),
            ("λ", "\\lambda"),
            ("m_λ", "m_{\\lambda}"),
            ("Δx", "\\mathrm{{\\Delta}x}"),
            ("длина", "\\mathrm{dlina}"),
            ("Ü", "\\mathrm{U}"),
        ] {
            assert_eq!(name(plain), latex);
        }
    }

    #[test]
    fn parts_of_pi_are_fractions() {
        let written = |x: DoubleDouble| fraction(Number::Float(x));
        let text = |top: &str, bottom: &str| (top.to_owned(), bottom.to_owned());
        assert_eq!(written(DoubleDouble::PI), text("\\pi", "1"));
        assert_eq!(written(DoubleDouble::FRAC_PI_2), text("\\pi", "2"));
        assert_eq!(written(DoubleDouble::PI * 3.0 * 0.25), text("3 \\, \\pi", "4"));
        // As near to π/2 as 16 digits are.
        assert_eq!(written(DoubleDouble::from(std::f64::consts::FRAC_PI_2)), text("1.5707963267948966", "1"));
    }

    #[test]
    fn what_is_seen_is_counted() {
        assert_eq!(width("\\frac{1}{2} \\, m \\, {l}^{2} \\, \\cos\\left(\\theta_{1}\\right)"), 10);
    }
}
