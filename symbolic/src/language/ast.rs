//! The syntax tree of one expression, with byte ranges into its text.

use super::Span;

/// An expression as written.
#[derive(Clone, Debug, PartialEq)]
pub struct Ast {
    /// What it is.
    pub kind: AstKind,
    /// Where it stands, in bytes of the expression's text.
    pub span: Span,
}

impl Ast {
    /// True when `test` holds for some name in it; the tree is at most 1000 levels deep.
    pub fn any_name(&self, test: &mut dyn FnMut(&str) -> bool) -> bool {
        match &self.kind {
            AstKind::Number(_) => false,
            AstKind::Name { name, indices, .. } => test(name) || indices.iter().any(|index| index.any_name(test)),
            AstKind::Negate(inner) | AstKind::Component(inner, _) => inner.any_name(test),
            AstKind::Binary(_, left, right) => left.any_name(test) || right.any_name(test),
            AstKind::Vector(parts) => parts.iter().any(|part| part.any_name(test)),
            AstKind::Call { arguments, .. } => arguments.iter().any(|part| part.any_name(test)),
            AstKind::Sum(body, ranges) => {
                let bound = |name: &str| ranges.iter().any(|range| range.name == name);
                body.any_name(&mut |name| !bound(name) && test(name))
                    || ranges.iter().any(|range| {
                        range.from.any_name(&mut |name| !bound(name) && test(name))
                            || range.to.any_name(&mut |name| !bound(name) && test(name))
                    })
            }
            AstKind::Integral(body, range) => {
                body.any_name(&mut |name| name != range.name && test(name))
                    || range.from.any_name(test)
                    || range.to.any_name(test)
            }
        }
    }
}

/// What stands after the point in `c.friction`, the sliding of the contact c.
pub const FRICTION: u8 = 3;
/// The component `.w` of a quaternion.
pub const SCALAR: u8 = 4;

/// The forms of LANGUAGE section 1.
#[derive(Clone, Debug, PartialEq)]
pub enum AstKind {
    /// A number, as decimal text.
    Number(String),
    /// `theta`, `theta'`, `x[i]''`, `tip[i-1]`: a name, its indices, how many primes.
    Name {
        /// The name without indices and primes.
        name: String,
        /// Its indices, if any.
        indices: Vec<Ast>,
        /// Number of primes: 0, 1 or 2.
        primes: u8,
    },
    /// `-e`.
    Negate(Box<Ast>),
    /// `a + b` and the like.
    Binary(Operator, Box<Ast>, Box<Ast>),
    /// `[a, b]` or `[a, b, c]`.
    Vector(Vec<Ast>),
    /// `e.x`, `e.y`, `e.z`: 0, 1 or 2; `c.friction`: [`FRICTION`]; `quaternion(B).w`: [`SCALAR`].
    Component(Box<Ast>, u8),
    /// `f(a, b)` for every function but the ones below.
    Call {
        /// The function's name.
        function: String,
        /// Where the name stands.
        name_span: Span,
        /// Its arguments.
        arguments: Vec<Ast>,
    },
    /// `sum(e, i in 1..n, j in i+1..n)`.
    Sum(Box<Ast>, Vec<Range>),
    /// `integral(e, x in a..b)`.
    Integral(Box<Ast>, Box<Range>),
}

/// `i in 1..n`.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// The index or dummy.
    pub name: String,
    /// Where it stands.
    pub name_span: Span,
    /// First value.
    pub from: Ast,
    /// Last value, included.
    pub to: Ast,
}

/// Binary operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
    /// `^`
    Power,
    /// `=`, allowed once, outermost, where an equation is wanted.
    Equal,
}

impl Operator {
    /// The opposite where `inverse`: `+` and `-`, `*` and `/`.
    pub(super) fn turned(self, inverse: bool) -> Operator {
        match self {
            Operator::Add if inverse => Operator::Subtract,
            Operator::Subtract if inverse => Operator::Add,
            Operator::Multiply if inverse => Operator::Divide,
            Operator::Divide if inverse => Operator::Multiply,
            other => other,
        }
    }
}

/// A key of a mapping: `theta`, `theta[i in 1..n]`, `x[2]'`, `s[i in 1..n, j in i+1..n]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// The name.
    pub name: String,
    /// Where the name stands.
    pub span: Span,
    /// Its indices: each a range or a fixed index.
    pub indices: Vec<KeyIndex>,
    /// Number of primes (in `start`).
    pub primes: u8,
}

/// One index of a [`Key`].
#[derive(Clone, Debug, PartialEq)]
pub enum KeyIndex {
    /// `i in 1..n`
    Range(Range),
    /// `0`, `n+1`
    Fixed(Ast),
}

/// A number or expression followed by a unit, `2.5 kg*m^2`.
#[derive(Clone, Debug, PartialEq)]
pub struct Valued {
    /// The value.
    pub value: Ast,
    /// Its unit as written, with where it stands; `None` when there is none.
    pub unit: Option<(String, Span)>,
}
