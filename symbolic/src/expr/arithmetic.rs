//! The constructors of sums, products and functions, which simplify as they go.
//!
//! They fold 0, 1 and constants, pull signs outwards, put constants in front, collect like terms of two, cancel
//! x − x and x/x, and put the operands of sums and products in the order of the arena.

use super::{Binary, Graph, Id, Measured, Node, Scalar, Symbol, Unary};
use crate::number::{DoubleDouble, Number, Rational};

/// A constant within so many roundings of zero, twenty digits of thirty-two, is none: it stays the function that it is.
const NEARLY_ROUNDING: f64 = 1e12;

impl Graph {
    /// −x.
    pub fn neg(&mut self, x: Id) -> Id {
        match self.node(x) {
            Node::Number(place) => {
                let negated = self.number_at(place).negated();
                self.constant(negated)
            }
            Node::Unary(Unary::Neg, y) => y,
            Node::Binary(Binary::Sub, a, b) => self.sub(b, a),
            _ => self.intern(Node::Unary(Unary::Neg, x)),
        }
    }

    /// a + b.
    pub fn add(&mut self, a: Id, b: Id) -> Id {
        if a == Id::ZERO {
            return b;
        }
        if b == Id::ZERO {
            return a;
        }
        if let (Some(x), Some(y)) = (self.number(a), self.number(b)) {
            return self.constant(x.plus(y));
        }
        if let Some(y) = self.negated(b) {
            return self.sub(a, y);
        }
        if let Some(x) = self.negated(a) {
            return self.sub(b, x);
        }
        if let Some(sum) = self.combine_like(a, b, false) {
            return sum;
        }
        // (x − y) + y = x
        if let Node::Binary(Binary::Sub, x, y) = self.node(a)
            && y == b
        {
            return x;
        }
        if let Node::Binary(Binary::Sub, x, y) = self.node(b)
            && y == a
        {
            return x;
        }
        let (a, b) = if a <= b { (a, b) } else { (b, a) };
        self.intern(Node::Binary(Binary::Add, a, b))
    }

    /// a − b.
    pub fn sub(&mut self, a: Id, b: Id) -> Id {
        if b == Id::ZERO {
            return a;
        }
        if a == b {
            return Id::ZERO;
        }
        if a == Id::ZERO {
            return self.neg(b);
        }
        if let (Some(x), Some(y)) = (self.number(a), self.number(b)) {
            return self.constant(x.plus(y.negated()));
        }
        if let Some(y) = self.negated(b) {
            return self.add(a, y);
        }
        if let Node::Unary(Unary::Neg, x) = self.node(a) {
            let sum = self.add(x, b);
            return self.neg(sum);
        }
        if let Some(difference) = self.combine_like(a, b, true) {
            return difference;
        }
        match (self.node(a), self.node(b)) {
            // (x + y) − x = y
            (Node::Binary(Binary::Add, x, y), _) if x == b => return y,
            (Node::Binary(Binary::Add, x, y), _) if y == b => return x,
            (_, Node::Binary(Binary::Add, x, y)) if x == a => return self.neg(y),
            (_, Node::Binary(Binary::Add, x, y)) if y == a => return self.neg(x),
            (_, Node::Binary(Binary::Sub, x, y)) if x == a => return y,
            _ => {}
        }
        self.intern(Node::Binary(Binary::Sub, a, b))
    }

    /// a b.
    pub fn mul(&mut self, a: Id, b: Id) -> Id {
        if a == Id::ZERO || b == Id::ZERO {
            return Id::ZERO;
        }
        if a == Id::ONE {
            return b;
        }
        if b == Id::ONE {
            return a;
        }
        if let (Some(x), Some(y)) = (self.number(a), self.number(b)) {
            return self.constant(x.times(y));
        }
        if let Some(x) = self.negated(a) {
            let product = self.mul(x, b);
            return self.neg(product);
        }
        if let Some(y) = self.negated(b) {
            let product = self.mul(a, y);
            return self.neg(product);
        }
        // Constants to the front: c (d x) = (c d) x, x (c y) = c (x y).
        let (c, x) = self.split_factor(a);
        let (d, y) = self.split_factor(b);
        if c.is_some() || d.is_some() {
            let factor = self.constant(c.unwrap_or(Number::ONE).times(d.unwrap_or(Number::ONE)));
            let rest = match (x, y) {
                (Some(x), Some(y)) => self.mul(x, y),
                (Some(x), None) | (None, Some(x)) => x,
                (None, None) => return factor,
            };
            if factor == Id::ONE || factor == Id::ZERO {
                return if factor == Id::ONE { rest } else { Id::ZERO };
            }
            if let Some(x) = self.negated(rest) {
                let product = self.mul(factor, x);
                return self.neg(product);
            }
            if self.number(rest).is_some() {
                return self.mul(factor, rest);
            }
            return self.intern(Node::Binary(Binary::Mul, factor, rest));
        }
        match (self.node(a), self.node(b)) {
            (Node::Unary(Unary::Sqrt, x), Node::Unary(Unary::Sqrt, y)) if x == y => return x,
            (Node::Binary(Binary::Div, n, d), _) if d == b => return n,
            (_, Node::Binary(Binary::Div, n, d)) if d == a => return n,
            _ => {}
        }
        let (a, b) = if a <= b { (a, b) } else { (b, a) };
        self.intern(Node::Binary(Binary::Mul, a, b))
    }

    /// a b as it stands, so that a factor of parameters keeps its number: (m/2) x, not (m x)/2.
    pub(crate) fn mul_as_is(&mut self, a: Id, b: Id) -> Id {
        if self.number(a).is_some() || self.number(b).is_some() {
            return self.mul(a, b);
        }
        self.intern(Node::Binary(Binary::Mul, a, b))
    }

    /// a / b.  Division by the constant 0 gives a node that evaluates to no finite number.
    pub fn div(&mut self, a: Id, b: Id) -> Id {
        if b == Id::ONE {
            return a;
        }
        if let Some(d) = self.number(b)
            && d.to_f64() != 0.0
        {
            let reciprocal = self.constant(d.recip());
            return self.mul(reciprocal, a);
        }
        if a == Id::ZERO && b != Id::ZERO {
            return Id::ZERO;
        }
        if a == b && b != Id::ZERO {
            return Id::ONE;
        }
        if let Some(x) = self.negated(a) {
            let quotient = self.div(x, b);
            return self.neg(quotient);
        }
        if let Some(y) = self.negated(b) {
            let quotient = self.div(a, y);
            return self.neg(quotient);
        }
        match (self.node(a), self.node(b)) {
            (Node::Binary(Binary::Mul, x, y), _) if x == b => return y,
            (Node::Binary(Binary::Mul, x, y), _) if y == b => return x,
            (_, Node::Unary(Unary::Sqrt, x)) if x == a => return b,
            (_, Node::Binary(Binary::Div, n, d)) => {
                let product = self.mul(a, d);
                return self.div(product, n);
            }
            (Node::Binary(Binary::Div, n, d), _) => {
                let product = self.mul(d, b);
                return self.div(n, product);
            }
            // (c x) / y = c (x / y): constants stay in front.
            (Node::Binary(Binary::Mul, c, x), _) if self.number(c).is_some() => {
                let quotient = self.div(x, b);
                return self.mul(c, quotient);
            }
            (_, Node::Binary(Binary::Mul, c, y)) if self.number(c).is_some() => {
                let scaled = self.div(a, c);
                return self.div(scaled, y);
            }
            _ => {}
        }
        self.intern(Node::Binary(Binary::Div, a, b))
    }

    /// xⁿ by repeated multiplication.
    pub fn powi(&mut self, x: Id, n: i32) -> Id {
        if n < 0 {
            let power = self.powi(x, n.saturating_neg());
            return self.div(Id::ONE, power);
        }
        let mut result = Id::ONE;
        let mut square = x;
        let mut rest = n;
        while rest > 0 {
            if rest & 1 == 1 {
                result = self.mul(result, square);
            }
            rest >>= 1;
            if rest > 0 {
                square = self.mul(square, square);
            }
        }
        result
    }

    /// xʸ: integer powers up to 64 and their halves by multiplication and roots.
    pub fn pow(&mut self, x: Id, y: Id) -> Id {
        if let Some(Number::Exact(exponent)) = self.number(y) {
            let numerator = i32::try_from(exponent.numerator()).ok().filter(|n| n.abs() <= 64);
            match (numerator, exponent.denominator()) {
                (Some(n), 1) => return self.powi(x, n),
                // What is one-sided keeps its power, which is told beyond its side by the sign of its base.
                (Some(n), 2) if !self.is_one_sided(x) => {
                    let root = self.unary(Unary::Sqrt, x);
                    let whole = self.powi(x, n.abs() / 2);
                    let power = self.mul(whole, root);
                    return if n < 0 { self.div(Id::ONE, power) } else { power };
                }
                _ => {}
            }
        }
        if x == Id::ONE {
            return Id::ONE;
        }
        if let (Some(a), Some(b)) = (self.number(x), self.number(y)) {
            let value = a.to_double_double().pow(b.to_double_double());
            if value.is_finite() {
                return self.double_double(value);
            }
        }
        self.intern(Node::Binary(Binary::Pow, x, y))
    }

    /// True for `max(0, …)` and its like, times anything.
    fn is_one_sided(&self, x: Id) -> bool {
        match self.node(x) {
            Node::Binary(Binary::Min | Binary::Max, ..) | Node::Unary(Unary::Abs | Unary::Step, _) => true,
            Node::Unary(Unary::Neg, x) => self.is_one_sided(x),
            Node::Binary(Binary::Mul, x, y) => self.is_one_sided(x) || self.is_one_sided(y),
            _ => false,
        }
    }

    /// 1 in these of all phases, of which there are `count`, and 0 in the others.
    pub fn in_phases(&mut self, phases: &[usize], count: usize) -> Id {
        if phases.len() == count {
            return Id::ONE;
        }
        phases.iter().fold(Id::ZERO, |sum, phase| {
            let active = self.symbol(Symbol::Phase(*phase as u32));
            self.add(sum, active)
        })
    }

    /// A function of one argument.
    pub fn unary(&mut self, function: Unary, x: Id) -> Id {
        if function == Unary::Neg {
            return self.neg(x);
        }
        if let Some(value) = self.number(x)
            && let Some(id) = self.fold_unary(function, value)
        {
            return id;
        }
        if let Some(y) = self.negated(x) {
            match function {
                Unary::Cos | Unary::Cosh | Unary::Abs => return self.unary(function, y),
                Unary::Sin | Unary::Tan | Unary::Asin | Unary::Atan | Unary::Sinh | Unary::Tanh | Unary::Sign => {
                    let value = self.unary(function, y);
                    return self.neg(value);
                }
                _ => {}
            }
        }
        match function {
            Unary::Abs if matches!(self.node(x), Node::Unary(Unary::Abs, _)) => return x,
            Unary::Sqrt | Unary::Exp => {
                if let Some(power) = self.kink(function, x) {
                    return power;
                }
            }
            _ => {}
        }
        self.intern(Node::Unary(function, x))
    }

    /// √(u²) = |u| and exp(c ln u²) = |u|²ᶜ of what time alone moves: a run stops where it turns sharply, which nothing shows in the square.
    fn kink(&mut self, function: Unary, x: Id) -> Option<Id> {
        let (square, power) = match (function, self.node(x)) {
            (Unary::Sqrt, _) => (x, Rational::HALF),
            // Constants stand in front.
            (_, Node::Binary(Binary::Mul, c, logarithm)) => match (self.number(c), self.node(logarithm)) {
                (Some(Number::Exact(power)), Node::Unary(Unary::Ln, square)) => (square, power),
                _ => return None,
            },
            _ => return None,
        };
        let Node::Binary(Binary::Mul, u, v) = self.node(square) else { return None };
        let symbols = self.symbols([u]);
        let moves = |s: &Symbol| matches!(s, Symbol::Time | Symbol::Input(..));
        let stays = |s: &Symbol| matches!(s, Symbol::Parameter(_));
        if u != v || !symbols.iter().any(moves) || !symbols.iter().all(|s| moves(s) || stays(s)) {
            return None;
        }
        let size = self.unary(Unary::Abs, u);
        let twice = self.constant(Number::Exact(power.checked_mul(Rational::integer(2))?));
        Some(self.pow(size, twice))
    }

    /// An operation on two arguments.
    pub fn binary(&mut self, operation: Binary, a: Id, b: Id) -> Id {
        match operation {
            Binary::Add => self.add(a, b),
            Binary::Sub => self.sub(a, b),
            Binary::Mul => self.mul(a, b),
            Binary::Div => self.div(a, b),
            Binary::Pow => self.pow(a, b),
            Binary::Min | Binary::Max if a == b => a,
            Binary::Normal(_) => self.intern(Node::Binary(operation, a, b)),
            Binary::Table(table) => {
                if let (Some(x), Some(y)) = (self.number(a), self.number(b)) {
                    return self.double_double(table.at(x.to_double_double(), y.to_double_double()));
                }
                self.intern(Node::Binary(operation, a, b))
            }
            Binary::Atan2 | Binary::Min | Binary::Max => {
                if let (Some(x), Some(y)) = (self.number(a), self.number(b)) {
                    let (x, y) = (x.to_double_double(), y.to_double_double());
                    let value = DoubleDouble::binary(operation, x, y);
                    return match operation {
                        Binary::Atan2 => self.double_double(value),
                        _ if value == x => a,
                        _ => b,
                    };
                }
                if operation == Binary::Atan2
                    && let Some(half_turns) = self.half_turns(a, b)
                {
                    return half_turns;
                }
                let ordered = operation != Binary::Atan2 && b < a;
                let (a, b) = if ordered { (b, a) } else { (a, b) };
                self.intern(Node::Binary(operation, a, b))
            }
        }
    }

    /// atan2(y, x) on an axis: π (1 − step(x)) for y = 0, π/2 sign(y) for x = 0.
    fn half_turns(&mut self, y: Id, x: Id) -> Option<Id> {
        let pi = self.constant(Number::Float(DoubleDouble::PI));
        if y == Id::ZERO {
            let step = self.unary(Unary::Step, x);
            let rest = self.sub(Id::ONE, step);
            return Some(self.mul(pi, rest));
        }
        let two = self.integer(2);
        let quarter = self.div(pi, two);
        let sign = self.unary(Unary::Sign, y);
        (x == Id::ZERO).then(|| self.mul(quarter, sign))
    }

    /// The same operation on what has become of its operands.
    pub(super) fn rebuilt(&mut self, id: Id, image: impl Fn(Id) -> Id) -> Id {
        match self.node(id) {
            Node::Unary(f, x) => self.unary(f, image(x)),
            Node::Binary(f, x, y) => self.binary(f, image(x), image(y)),
            Node::Number(_) | Node::Symbol(_) => id,
        }
    }

    fn fold_unary(&mut self, function: Unary, value: Number) -> Option<Id> {
        let exact = match function {
            Unary::Sqrt => Some(value.sqrt()),
            Unary::Abs => Some(value.abs()),
            Unary::Sin | Unary::Cos => of_twelfths(function, value),
            _ => None,
        };
        let folded = exact.unwrap_or_else(|| DoubleDouble::unary(function, value.to_double_double()).into());
        // Values that are not finite stay nodes, and those that are nearly rounding, as sin(1000 π): a constant counts as exact.
        let known = exact.is_some() || {
            let measured = Measured::unary(function, Measured::exact(value.to_double_double()));
            measured.value == DoubleDouble::ZERO || !measured.vanishes(NEARLY_ROUNDING)
        };
        (folded.is_finite() && known).then(|| self.constant(folded))
    }

    /// y where x = −y for a node or a negative constant.
    fn negated(&mut self, x: Id) -> Option<Id> {
        match self.node(x) {
            Node::Unary(Unary::Neg, y) => Some(y),
            Node::Number(place) if self.number_at(place).to_f64() < 0.0 => Some(self.neg(x)),
            _ => None,
        }
    }

    /// c and x where the expression is c x with a constant c.
    fn split_factor(&self, x: Id) -> (Option<Number>, Option<Id>) {
        match self.node(x) {
            Node::Number(place) => (Some(self.number_at(place)), None),
            Node::Binary(Binary::Mul, c, rest) => match self.number(c) {
                Some(number) => (Some(number), Some(rest)),
                None => (None, Some(x)),
            },
            _ => (None, Some(x)),
        }
    }

    /// c x ± d x = (c ± d) x.
    fn combine_like(&mut self, a: Id, b: Id, subtract: bool) -> Option<Id> {
        let (c, x) = self.split_factor(a);
        let (d, y) = self.split_factor(b);
        if x.is_none() || x != y {
            return None;
        }
        let d = d.unwrap_or(Number::ONE);
        let d = if subtract { d.negated() } else { d };
        let factor = self.constant(c.unwrap_or(Number::ONE).plus(d));
        Some(self.mul(factor, x?))
    }
}

/// The sine or cosine of a multiple of π/6 or π/4, to all digits that an angle has: rational, or one root for all
/// angles that have it, so that differences vanish.
fn of_twelfths(function: Unary, angle: Number) -> Option<Number> {
    /// Angles beyond have fewer digits.
    const TURNS: f64 = 1e3;
    const SAME: f64 = 1e-28;
    let twelfths = angle.to_double_double() * DoubleDouble::from(12.0) / DoubleDouble::PI;
    let whole = twelfths.to_f64().round();
    if whole.abs() > 24.0 * TURNS || (twelfths - DoubleDouble::from(whole)).abs().to_f64() > SAME {
        return None;
    }
    let quarter = if function == Unary::Cos { 6 } else { 0 };
    let place = (whole as i64 + quarter).rem_euclid(24);
    // The sine is half the root of this.
    let square = match place % 12 {
        0 => 0,
        2 | 10 => 1,
        3 | 9 => 2,
        4 | 8 => 3,
        6 => 4,
        _ => return None,
    };
    let half = Number::Exact(super::Rational::new(1, 2)?);
    let sine = Number::Exact(super::Rational::integer(square)).sqrt().times(half);
    Some(if place > 12 { sine.negated() } else { sine })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Rational;

    #[test]
    fn sines_of_known_angles_are_known() {
        let mut g = Graph::new();
        let mut at = |function: Unary, numerator: i128, denominator: i128| {
            let part = Number::Exact(Rational::new(numerator, denominator).unwrap());
            let angle = g.constant(Number::Float(DoubleDouble::PI).times(part));
            let value = g.unary(function, angle);
            g.number(value).unwrap()
        };
        for (n, d) in [(0, 1), (1, 6), (5, 6), (7, 6), (1, 2), (3, 2), (-1, 2), (1, 4), (2, 3), (4, 3), (1, 5), (1, 12)]
        {
            for (function, expected) in [(Unary::Sin, f64::sin as fn(f64) -> f64), (Unary::Cos, f64::cos)] {
                let expected = expected(std::f64::consts::PI * n as f64 / d as f64);
                assert!((at(function, n, d).to_f64() - expected).abs() < 1e-15, "{function:?} {n}/{d}");
            }
        }
        assert!(matches!(at(Unary::Cos, 1, 3), Number::Exact(_)) && matches!(at(Unary::Sin, 7, 1), Number::Exact(_)));
        assert_eq!(at(Unary::Sin, 1, 3).bits(), at(Unary::Sin, 8, 3).bits());
        assert_eq!(at(Unary::Sin, 1, 4).bits(), at(Unary::Cos, -1, 4).bits());
        // An angle of 16 digits is none of them.
        let near = g.float(std::f64::consts::PI);
        let sine = g.unary(Unary::Sin, near);
        assert!(g.number(sine).unwrap().to_f64() > 1e-16);
    }
}
