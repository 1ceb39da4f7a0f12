//! Functions that jump, or turn, where nothing is written that switches: `atan2` on its cut, `atan` where its argument has
//! a pole, `asin` of a sine and `acos` of a cosine.
//!
//! Their derivatives say nothing of it, so each becomes a branch that goes on smoothly across the place, with a mode for
//! the side.

use crate::expr::{Binary, DoubleDouble, Graph, Id, Node, Number, Rational, Symbol, Unary};

/// atan2(y, x) has its cut at y = 0, x < 0.  The sign of a function of the direction changes twice in a turn: here it does
/// at the cut and where y/x is that of the half angle with this cotangent, which is no place of rest that anybody draws.
const COTANGENT: (i128, i128) = (9, 4);

/// What vanishes where a node changes its branch, below zero on one side and above on the other.
pub(crate) fn argument(graph: &mut Graph, node: Node) -> Option<Id> {
    match node {
        Node::Binary(Binary::Atan2, y, x) => {
            if graph.number(y).is_some() || never_negative(graph, x) {
                return None;
            }
            let (xx, yy) = (graph.mul(x, x), graph.mul(y, y));
            let square = graph.add(xx, yy);
            let r = graph.unary(Unary::Sqrt, square);
            let sum = graph.add(x, r);
            let factor = Rational::new(COTANGENT.0, COTANGENT.1)?;
            let factor = graph.rational(factor);
            let product = graph.mul(factor, y);
            Some(graph.sub(product, sum))
        }
        Node::Unary(Unary::Atan, w) => Some(quotient(graph, w)?.1),
        Node::Unary(Unary::Asin, w) => match graph.node(w) {
            Node::Unary(Unary::Sin, u) => Some(graph.unary(Unary::Cos, u)),
            _ => None,
        },
        Node::Unary(Unary::Acos, w) => match graph.node(w) {
            Node::Unary(Unary::Cos, u) => Some(graph.unary(Unary::Sin, u)),
            _ => None,
        },
        _ => None,
    }
}

/// The node on the side where its [`argument`] has this sign, −1 or 1, and on beyond it.
pub(crate) fn continued(graph: &mut Graph, node: Node, side: Id) -> Option<Id> {
    let half_turn = graph.constant(Number::Float(DoubleDouble::PI));
    let two = graph.integer(2);
    let quarter = graph.div(half_turn, two);
    match node {
        Node::Binary(Binary::Atan2, y, x) => {
            let (y, x) = (graph.mul(side, y), graph.mul(side, x));
            let x = graph.neg(x);
            let (start, angle) = (graph.mul(side, quarter), graph.binary(Binary::Atan2, x, y));
            Some(graph.add(start, angle))
        }
        Node::Unary(Unary::Atan, w) => {
            let (n, d) = quotient(graph, w)?;
            let (n, d) = (graph.mul(side, n), graph.mul(side, d));
            Some(graph.binary(Binary::Atan2, n, d))
        }
        Node::Unary(Unary::Asin, w) => {
            let cosine = argument(graph, node)?;
            let cosine = graph.mul(side, cosine);
            Some(graph.binary(Binary::Atan2, w, cosine))
        }
        Node::Unary(Unary::Acos, w) => {
            let sine = argument(graph, node)?;
            let sine = graph.mul(side, sine);
            let angle = graph.binary(Binary::Atan2, w, sine);
            Some(graph.sub(quarter, angle))
        }
        _ => None,
    }
}

/// Numerator and denominator of a quotient, `tan` among its factors or not, whose denominator may change its sign.
fn quotient(graph: &mut Graph, w: Id) -> Option<(Id, Id)> {
    let (mut above, mut below) = (Id::ONE, Id::ONE);
    let mut stack = vec![(w, true)];
    while let Some((factor, up)) = stack.pop() {
        let (over, under) = match graph.node(factor) {
            Node::Binary(Binary::Mul, a, b) => {
                stack.extend([(a, up), (b, up)]);
                continue;
            }
            Node::Binary(Binary::Div, a, b) => {
                stack.extend([(a, up), (b, !up)]);
                continue;
            }
            Node::Unary(Unary::Neg, a) => {
                stack.push((a, up));
                (graph.integer(-1), Id::ONE)
            }
            Node::Unary(Unary::Tan, u) => (graph.unary(Unary::Sin, u), graph.unary(Unary::Cos, u)),
            // With its mode |v| only touches zero, and is a discontinuity already.
            Node::Symbol(Symbol::Mode(_)) if !up => return None,
            _ => (factor, Id::ONE),
        };
        let (over, under) = if up { (over, under) } else { (under, over) };
        (above, below) = (graph.mul(above, over), graph.mul(below, under));
    }
    let poles = graph.number(below).is_none() && !never_negative(graph, below);
    poles.then_some((above, below))
}

/// Whether an expression is a sum or product of what is not negative: squares, roots, exponentials.
fn never_negative(graph: &Graph, root: Id) -> bool {
    let mut stack = vec![root];
    while let Some(id) = stack.pop() {
        match graph.node(id) {
            Node::Number(_) if graph.number(id).is_some_and(|number| number.to_f64() >= 0.0) => {}
            Node::Binary(Binary::Mul, a, b) if a == b => {}
            Node::Binary(Binary::Add | Binary::Mul | Binary::Div, a, b) => stack.extend([a, b]),
            Node::Unary(Unary::Sqrt | Unary::Exp | Unary::Cosh | Unary::Abs | Unary::Acos | Unary::Step, _) => {}
            _ => return false,
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::derive::derive;
    use crate::expr::Tape;
    use crate::model::load;

    /// The value of a generalized force at x, its modes at those of `from`.
    fn force(text: &str, from: f64, x: f64) -> (usize, f64) {
        let text = format!(
            "name: Block
parameters: {{m: 1}}
coordinates: {{x: 1, y: 1}}
kinetic_energy: m*(x'^2 + y'^2)/2
generalized_forces: {{x: \"{text}\"}}
"
        );
        let derivation = derive(load(&text, &[]).expect("a good file")).expect("derives");
        let (graph, switches) = (&derivation.model.graph, &derivation.switches);
        let at = |x: f64| {
            move |symbol: Symbol| match symbol {
                Symbol::Coordinate(0) => x,
                Symbol::Coordinate(1) => 0.3,
                Symbol::Parameter(_) => 1.0,
                _ => 0.0,
            }
        };
        let modes: Vec<f64> = switches
            .iter()
            .map(|switch| if Tape::new(graph, &[switch.argument]).evaluate(at(from))[0] >= 0.0 { 1.0 } else { 0.0 })
            .collect();
        let value = |symbol: Symbol| match symbol {
            Symbol::Mode(k) => modes[k as usize],
            symbol => at(x)(symbol),
        };
        let bias = derivation.equations[0].bias[0];
        (modes.len(), -Tape::new(graph, &[bias]).evaluate(value)[0])
    }

    #[test]
    fn a_branch_is_the_function_on_its_side_and_goes_on_beyond_it() {
        type Function = fn(f64) -> f64;
        // Each with a place on one side of a jump, and where it lies beyond it.
        let cases: [(&str, Function, f64, f64, f64); 6] = [
            ("atan(tan(x))", |x| x.tan().atan(), 1.5, 1.7, 1.7),
            (
                "atan(2*tan(x))",
                |x| (2.0 * x.tan()).atan(),
                1.5,
                1.7,
                std::f64::consts::PI + (2.0 * 1.7_f64.tan()).atan(),
            ),
            ("asin(sin(x))", |x| x.sin().asin(), 1.5, 1.7, 1.7),
            ("acos(cos(x))", |x| x.cos().acos(), 3.1, 3.2, 3.2),
            ("atan2(sin(x), cos(x))", |x| x.sin().atan2(x.cos()), 3.1, 3.2, 3.2),
            ("atan(1/x)", |x| (1.0 / x).atan(), 0.1, -0.1, std::f64::consts::FRAC_PI_2 + 0.1_f64.atan()),
        ];
        for (text, function, place, beyond, there) in cases {
            for x in [place, beyond, -place, 0.4, -2.9, 4.2] {
                let (modes, value) = force(text, x, x);
                assert!(modes == 1 && (value - function(x)).abs() < 1e-14, "{text} at {x}: {modes} modes, {value}");
            }
            let (_, value) = force(text, place, beyond);
            assert!((value - there).abs() < 1e-14, "{text} from {place} to {beyond}: {value}, not {there}");
        }
    }

    #[test]
    fn what_neither_jumps_nor_turns_has_no_modes() {
        for text in ["atan(x)", "atan(x/(1 + x^2))", "atan2(x, 1)", "atan2(y, exp(x))", "asin(x/9)", "atan(tan(m)*x)"] {
            assert_eq!(force(text, 0.4, 0.4).0, 0, "{text}");
        }
    }
}
