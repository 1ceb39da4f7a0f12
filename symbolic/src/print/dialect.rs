//! What differs between the languages in which straight-line functions are printed, and how Rust writes it.

use super::literal::float;
use crate::expr::{Binary, Number, Table2d, Unary};

/// A language's statements and calls; sums, products and stores are alike in all.
pub(super) trait Dialect {
    /// Variables of these names with these values.
    fn declare(&self, names: &[&str], values: &[String]) -> String;

    /// Variables for those entries of an array that have a name.
    fn unpack(&self, names: &[Option<&str>], array: &str) -> String;

    /// A constant, which nothing around it takes apart.
    fn number(&self, number: Number) -> String;

    /// A function of one argument, other than a sign, a sine, a cosine and a table.
    fn unary(&self, function: Unary, x: &Piece) -> String;

    /// A power, `atan2`, `min` or `max`.
    fn binary(&self, function: Binary, x: &Piece, y: &Piece) -> String;

    /// A derivative of a table, which is known by its place.
    fn table(&self, place: usize, order: u8, x: &Piece) -> String;

    /// A derivative of a table of two arguments, which is known by its place.
    fn table_2d(&self, place: usize, table: Table2d, x: &Piece, y: &Piece) -> String;

    /// The number of standard normal distribution of a seed and a place in the stream of a key.
    fn normal(&self, key: u64, seed: &Piece, place: &Piece) -> String;

    /// Variables for the sine and the cosine of an angle, those that are wanted.
    fn turn(&self, names: &[Option<String>; 2], angle: &Piece) -> String;

    /// Leaves the function where a coordinate's pivot is negligible against an entry of M's diagonal.
    fn pivot(&self, coordinate: usize, pivot_and_diagonal: [&Piece; 2], indent: &str) -> String;
}

/// A printed expression.
#[derive(Clone)]
pub(super) struct Piece {
    pub text: String,
    pub level: Level,
    /// How deep it is nested.
    pub depth: u8,
    /// What it reads of the block of constants.
    pub constants: Vec<usize>,
}

/// How tightly the text of an expression holds together.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
pub(super) enum Level {
    Sum,
    Product,
    Sign,
    Atom,
}

impl Piece {
    /// A name or a number.
    pub fn atom(text: String) -> Piece {
        Piece { text, level: Level::Atom, depth: 0, constants: Vec::new() }
    }

    /// What a text around this one is.
    pub fn inside(&self, text: String, level: Level) -> Piece {
        Piece { text, level, depth: self.depth + 1, constants: self.constants.clone() }
    }

    /// In parentheses where it holds together less.
    pub fn at_least(&self, level: Level) -> String {
        if self.level < level { format!("({})", self.text) } else { self.text.clone() }
    }
}

/// Rust, generic over the scalar type `S`; `owner` is the type that describes the tables.
pub(super) struct Rust<'a> {
    pub owner: &'a str,
}

impl Dialect for Rust<'_> {
    fn declare(&self, names: &[&str], values: &[String]) -> String {
        match (names, values) {
            ([name], [value]) => format!("let {name} = {value};"),
            _ => format!("let ({}) = ({});", names.join(", "), values.join(", ")),
        }
    }

    fn unpack(&self, names: &[Option<&str>], array: &str) -> String {
        let names: Vec<&str> = names.iter().map(|name| name.unwrap_or("_")).collect();
        format!("let &[{}] = {array};", names.join(", "))
    }

    /// Exact where a ratio of two floats is.
    fn number(&self, number: Number) -> String {
        let exact = |n: i128| n.unsigned_abs() < 1 << 53;
        match number {
            Number::Exact(r) if exact(r.numerator()) && exact(r.denominator()) => {
                format!("S::ratio({:?}, {:?})", r.numerator() as f64, r.denominator() as f64)
            }
            _ => format!("S::from_f64({})", float(number.to_f64())),
        }
    }

    fn unary(&self, function: Unary, x: &Piece) -> String {
        format!("{}.{}()", x.at_least(Level::Atom), function.name())
    }

    fn binary(&self, function: Binary, x: &Piece, y: &Piece) -> String {
        let name = match function {
            Binary::Pow => "powf",
            Binary::Atan2 => "atan2",
            Binary::Min => "min",
            _ => "max",
        };
        format!("{}.{name}({})", x.at_least(Level::Atom), y.text)
    }

    fn table(&self, place: usize, order: u8, x: &Piece) -> String {
        format!("{}.table(&{}::description().tables[{place}], {order})", x.at_least(Level::Atom), self.owner)
    }

    fn table_2d(&self, place: usize, table: Table2d, x: &Piece, y: &Piece) -> String {
        let (x, [of_x, of_y]) = (x.at_least(Level::Atom), table.order());
        format!("{x}.table_2d({}, &{}::tables_2d()[{place}], [{of_x}, {of_y}])", y.text, self.owner)
    }

    fn normal(&self, key: u64, seed: &Piece, place: &Piece) -> String {
        format!("{}.normal({}, {key:#018x})", seed.at_least(Level::Atom), place.text)
    }

    fn turn(&self, names: &[Option<String>; 2], angle: &Piece) -> String {
        let both = format!("{}.sin_cos()", angle.at_least(Level::Atom));
        match names {
            [Some(sine), Some(cosine)] => format!("let ({sine}, {cosine}) = {both};"),
            [Some(sine), None] => format!("let {sine} = {both}.0;"),
            [None, cosine] => format!("let {} = {both}.1;", cosine.as_deref().unwrap_or("_")),
        }
    }

    fn pivot(&self, coordinate: usize, pivot_and_diagonal: [&Piece; 2], indent: &str) -> String {
        let [pivot, diagonal] = pivot_and_diagonal.map(|piece| piece.at_least(Level::Atom));
        format!(
            "{indent}if !{pivot}.abs().exceeds({diagonal}.abs() * S::pivot_floor()) {{\n{indent}    return ::core::result::Result::Err(::dalembert::mechanism::SingularMass {{ coordinate: {coordinate} }});\n{indent}}}"
        )
    }
}
