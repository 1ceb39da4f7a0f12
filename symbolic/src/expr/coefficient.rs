//! Sums of products of what does not change, in one form, so that equal coefficients are known to be equal.
//!
//! Σ c Π factorᵉ with like terms collected: `L1*m*L2 − m*L2*L1` is nothing.  Products of sums are multiplied out
//! unless their terms differ in sign: of a small l − d nothing is left of the digits when it is multiplied out.

use std::collections::BTreeMap;

use super::{Binary, Graph, Id, Node, Unary};
use crate::number::Number;

/// Factors with their exponents, sorted.
type Factors = Vec<(Id, i32)>;

/// A sum of terms, none of which is 0.
#[derive(Clone, Debug)]
pub(super) struct Coefficient(BTreeMap<Factors, Number>);

/// Products with more terms stay factored.
const TERMS: usize = 24;
/// Exponents beyond this are not counted: powers of powers have any.
const HIGHEST: u32 = 1 << 20;

impl Coefficient {
    pub fn zero() -> Coefficient {
        Coefficient(BTreeMap::new())
    }

    pub fn one() -> Coefficient {
        Coefficient::number(Number::ONE)
    }

    fn number(number: Number) -> Coefficient {
        Coefficient::zero().with(Factors::new(), number)
    }

    /// A number, or anything else as a factor of its own.
    pub fn atom(graph: &Graph, id: Id) -> Coefficient {
        match graph.node(id) {
            Node::Number(place) => Coefficient::number(graph.number_at(place)),
            Node::Unary(Unary::Neg, x) => Coefficient::atom(graph, x).negated(),
            _ => Coefficient::zero().with(vec![(id, 1)], Number::ONE),
        }
    }

    fn with(mut self, factors: Factors, number: Number) -> Coefficient {
        let sum = self.0.get(&factors).map_or(number, |known| known.plus(number));
        if sum.to_f64() == 0.0 {
            self.0.remove(&factors);
        } else {
            self.0.insert(factors, sum);
        }
        self
    }

    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    pub fn negated(&self) -> Coefficient {
        Coefficient(self.0.iter().map(|(factors, number)| (factors.clone(), number.negated())).collect())
    }

    pub fn plus(&self, other: &Coefficient) -> Coefficient {
        other.0.iter().fold(self.clone(), |sum, (factors, number)| sum.with(factors.clone(), *number))
    }

    pub fn minus(&self, other: &Coefficient) -> Coefficient {
        self.plus(&other.negated())
    }

    pub fn times(&self, other: &Coefficient, graph: &mut Graph) -> Coefficient {
        if self.highest() + other.highest() > HIGHEST {
            let (x, y) = (self.lowered(graph), other.lowered(graph));
            let product = graph.mul(x, y);
            return Coefficient::atom(graph, product);
        }
        let out = self.0.len() * other.0.len() <= TERMS;
        let (a, b) = (self.factor(graph, out, other), other.factor(graph, out, self));
        let mut product = Coefficient::zero();
        for (x, c) in &a.0 {
            for (y, d) in &b.0 {
                product = product.with(joined(x, y), c.times(*d));
            }
        }
        product
    }

    /// The largest exponent.
    fn highest(&self) -> u32 {
        self.0.keys().flatten().map(|(_, n)| n.unsigned_abs()).max().unwrap_or(0)
    }

    /// As it enters a product with another: what has several terms as one factor unless it may be multiplied out.
    fn factor(&self, graph: &mut Graph, out: bool, other: &Coefficient) -> Coefficient {
        let sign = |number: &Number| number.to_f64() < 0.0;
        let same = self.0.values().all(sign) || !self.0.values().any(sign);
        let unit = other.0.len() == 1 && other.0.iter().all(|(f, n)| f.is_empty() && n.abs().to_f64() == 1.0);
        if self.0.len() <= 1 || unit || (out && same) {
            return self.clone();
        }
        let (content, rest) = self.content();
        let rest = rest.lowered(graph);
        content.with_factor(rest, 1)
    }

    /// 1/x; a sum stays whole.
    pub fn recip(&self, graph: &mut Graph) -> Coefficient {
        let (content, rest) = self.content();
        let (factors, number) = content.0.into_iter().next().unwrap_or((Factors::new(), Number::ONE));
        // A division by 0 stays one.
        if number.to_f64() == 0.0 || self.is_zero() {
            let whole = self.lowered(graph);
            let reciprocal = graph.div(Id::ONE, whole);
            return Coefficient::atom(graph, reciprocal);
        }
        let inverse = factors.into_iter().map(|(id, n)| (id, -n)).collect();
        let inverse = Coefficient::zero().with(inverse, number.recip());
        if rest.0.len() <= 1 {
            return inverse;
        }
        let rest = rest.lowered(graph);
        inverse.with_factor(rest, -1)
    }

    /// One term times a power.
    fn with_factor(self, id: Id, exponent: i32) -> Coefficient {
        Coefficient(
            self.0.into_iter().map(|(factors, number)| (joined(&factors, &vec![(id, exponent)]), number)).collect(),
        )
    }

    /// The term that all terms have in common, and what is left: with its first term positive, and of a single term 1.
    fn content(&self) -> (Coefficient, Coefficient) {
        let content = Coefficient::shared(std::iter::once(self));
        let Some((common, number)) = content.0.iter().next() else { return (Coefficient::one(), self.clone()) };
        let inverse: Factors = common.iter().map(|(id, n)| (*id, -n)).collect();
        let rest = self.0.iter().map(|(factors, c)| (joined(factors, &inverse), c.times(number.recip()))).collect();
        (content, Coefficient(rest))
    }

    /// The term that all terms of several have in common, with the sign of the first; 1 of none.
    pub fn shared<'a>(coefficients: impl Iterator<Item = &'a Coefficient> + Clone) -> Coefficient {
        let terms = coefficients.flat_map(|coefficient| &coefficient.0);
        let Some((first, leading)) = terms.clone().next() else { return Coefficient::one() };
        let exponent = |factors: &Factors, id: Id| factors.iter().find(|f| f.0 == id).map_or(0, |f| f.1);
        let mut common: BTreeMap<Id, i32> = first.iter().copied().collect();
        for (factors, _) in terms.clone() {
            for (id, n) in &mut common {
                *n = (*n).min(exponent(factors, *id));
            }
            for (id, n) in factors.iter().filter(|f| f.1 < 0) {
                let least = common.entry(*id).or_insert(0);
                *least = (*least).min(*n);
            }
        }
        let size = leading.abs().to_f64();
        let equal = terms.clone().all(|(_, number)| number.abs().to_f64() == size);
        let number = match (equal, leading.to_f64() < 0.0) {
            (true, _) => *leading,
            (false, true) => Number::ONE.negated(),
            (false, false) => Number::ONE,
        };
        Coefficient::zero().with(common.into_iter().filter(|f| f.1 != 0).collect(), number)
    }

    /// As an expression.
    pub fn lowered(&self, graph: &mut Graph) -> Id {
        if self.is_zero() {
            return Id::ZERO;
        }
        let (content, rest) = self.content();
        let sum = rest.0.iter().fold(Id::ZERO, |sum, (factors, number)| {
            let term = term(graph, factors, *number, Id::ONE);
            graph.add(sum, term)
        });
        content.0.iter().next().map_or(sum, |(factors, number)| term(graph, factors, *number, sum))
    }

    /// Whether both are the same, or one the opposite of the other.
    pub fn is(&self, other: &Coefficient, negated: bool) -> bool {
        let bits = |number: &Number| if negated { number.negated().bits() } else { number.bits() };
        self.0.len() == other.0.len()
            && self.0.iter().zip(&other.0).all(|((x, c), (y, d))| x == y && c.bits() == bits(d))
    }
}

/// number · Π factors · x, with one division.
fn term(graph: &mut Graph, factors: &Factors, number: Number, x: Id) -> Id {
    let (mut above, mut below) = (Id::ONE, Id::ONE);
    for (id, n) in factors {
        let power = graph.powi(*id, n.abs());
        let side = if *n > 0 { &mut above } else { &mut below };
        *side = graph.mul(*side, power);
    }
    above = graph.mul(above, x);
    let quotient = graph.div(above, below);
    let number = graph.constant(number);
    graph.mul(number, quotient)
}

fn joined(a: &Factors, b: &Factors) -> Factors {
    let mut exponents: BTreeMap<Id, i32> = a.iter().copied().collect();
    for (id, n) in b {
        *exponents.entry(*id).or_default() += n;
    }
    exponents.into_iter().filter(|f| f.1 != 0).collect()
}

/// An operation on coefficients, where it is one of theirs.
pub(super) fn combined(graph: &mut Graph, operation: Binary, x: &Coefficient, y: &Coefficient) -> Option<Coefficient> {
    Some(match operation {
        Binary::Add => x.plus(y),
        Binary::Sub => x.minus(y),
        Binary::Mul => x.times(y, graph),
        Binary::Div => {
            let inverse = y.recip(graph);
            x.times(&inverse, graph)
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Symbol;

    fn parameters(graph: &mut Graph) -> [Coefficient; 3] {
        [0, 1, 2].map(|k| {
            let id = graph.symbol(Symbol::Parameter(k));
            Coefficient::atom(graph, id)
        })
    }

    #[test]
    fn like_terms_are_collected_whatever_their_order() {
        let mut g = Graph::new();
        let [a, b, c] = parameters(&mut g);
        let (ab, ba) = (a.times(&b, &mut g), b.times(&a, &mut g));
        let (abc, bac) = (ab.times(&c, &mut g), ba.times(&c, &mut g));
        assert!(abc.minus(&bac).is_zero());
        let sum = a.plus(&b).times(&c, &mut g);
        let out = a.times(&c, &mut g).plus(&b.times(&c, &mut g));
        assert!(sum.is(&out, false) && sum.is(&out.negated(), true) && !sum.is(&out, true));
        // (a c + b c)/c = a + b
        let inverse = c.recip(&mut g);
        assert!(sum.times(&inverse, &mut g).is(&a.plus(&b), false));
    }

    #[test]
    fn small_differences_are_not_multiplied_out() {
        let mut g = Graph::new();
        let [a, b, c] = parameters(&mut g);
        let product = a.minus(&b).times(&c, &mut g);
        assert_eq!(product.0.len(), 1);
        let square = a.minus(&b).times(&a.minus(&b), &mut g);
        let whole = a.times(&a, &mut g);
        let text = [square.lowered(&mut g), product.plus(&whole).lowered(&mut g)];
        let value = |id: Id| {
            let at = |s: Symbol| if s == Symbol::Parameter(1) { 1.0 - 1e-9 } else { 1.0 };
            crate::expr::Tape::new(&g, &[id]).evaluate(at)[0]
        };
        assert!((value(text[0]) / 1e-18 - 1.0).abs() < 1e-6);
        assert!((value(text[1]) - 1.0 - 1e-9).abs() < 1e-15);
    }

    #[test]
    fn nothing_divided_by_stays_a_division() {
        let mut g = Graph::new();
        let [a, ..] = parameters(&mut g);
        let zero = a.minus(&a);
        let reciprocal = zero.recip(&mut g).lowered(&mut g);
        let value: f64 = crate::expr::Tape::new(&g, &[reciprocal]).evaluate(|_| 1.0)[0];
        assert!(!value.is_finite());
    }
}
