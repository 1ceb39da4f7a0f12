//! Whether an equivalent form rounds as well as the one that was derived.

use rustc_hash::FxHashMap as HashMap;

use crate::expr::{Binary, Graph, Id, Node, Symbol, Tape};
use crate::number::DoubleDouble;
use crate::random::Random;

/// Sums that are looked at, and places along which each is brought to zero.
const SUMS: usize = 24;
const PLACES: usize = 2;
/// Forms with more symbols are not looked at: an expanded form of theirs is hardly ever the cheaper one.
const SYMBOLS: usize = 200;
/// How far from a zero both forms are compared, in parts of the place or of 1: no round numbers, of which squares are exact.
const BESIDE: [f64; 2] = [1.234_567_891e-2, 1.234_567_891e-5];
/// A form may err so many times more than the other one and the rounding of the state explain.
const MORE: f64 = 64.0;
/// Values with fewer digits say nothing.
const KNOWN: f64 = 1e-6;
/// A relative error that is a loss: of 16 digits a difference has 11 left at [`BESIDE`], its square multiplied out 6.
const LOSS: f64 = 1e-9;

type State = HashMap<Symbol, f64>;

/// Whether `other` keeps the digits that `plain` has beside zeros of the sums in it: that is where terms cancel, and where
/// (x − c)² multiplied out has none left.
///
/// An error counts by what the rounding of the state makes of the value, found in double-double.
pub(super) fn rounds_alike(graph: &Graph, plain: &[Id], other: &[Id]) -> bool {
    let symbols = graph.symbols(plain.iter().copied());
    if symbols.len() > SYMBOLS {
        return true;
    }
    let moves = graph.contains(is_place);
    let is_sum = |id: &Id| matches!(graph.node(*id), Node::Binary(Binary::Add | Binary::Sub, ..));
    let sums = graph.needed(plain.iter().copied()).into_iter().filter(|id| is_sum(id) && moves[id.index()]);
    let forms = [Tape::new(graph, plain), Tape::new(graph, other)];
    let mut random = Random::new();
    for sum in sums.take(SUMS) {
        let tape = Tape::new(graph, &[sum]);
        for place in graph.symbols([sum]).into_iter().filter(|s| is_place(*s)).take(PLACES) {
            let mut state: State = symbols.iter().map(|s| (*s, drawn(*s, &mut random))).collect();
            let Some(zero) = zero(&tape, &mut state, place) else { continue };
            for beside in BESIDE {
                state.insert(place, zero + beside * zero.abs().max(1.0));
                if loses(&forms, &state) {
                    return false;
                }
            }
        }
    }
    true
}

/// Whether differences of such symbols have no scale of their own: of places and times.
fn is_place(symbol: Symbol) -> bool {
    matches!(symbol, Symbol::Coordinate(_) | Symbol::Time | Symbol::Input(_, 0))
}

fn drawn(symbol: Symbol, random: &mut Random) -> f64 {
    match symbol {
        Symbol::Parameter(_) | Symbol::Memory(_) => random.between(0.5, 2.0),
        Symbol::Mode(_) | Symbol::Phase(_) => 1.0,
        _ => random.between(-2.0, 2.0),
    }
}

/// Where the sum of a tape vanishes along a place, by secants.
fn zero(tape: &Tape, state: &mut State, place: Symbol) -> Option<f64> {
    const ROUNDS: u32 = 40;
    // Double zeros are approached slowly, and never reached.
    const SMALL: f64 = 1e-6;
    const FOUND: f64 = 1e-14;
    let mut at = |x: f64| {
        state.insert(place, x);
        tape.evaluate(|s| state[&s])[0]
    };
    let mut a = drawn(place, &mut Random::new());
    let mut b = a + 0.1;
    let (mut low, mut high) = (at(a), at(b));
    let size = low.abs().max(high.abs());
    for _ in 0..ROUNDS {
        let next = b - high * (b - a) / (high - low);
        if high.abs() <= FOUND * size || !next.is_finite() {
            break;
        }
        (a, low) = (b, high);
        (b, high) = (next, at(next));
    }
    (high.abs() <= SMALL * size).then_some(b)
}

/// Whether the second form has lost digits that the first one has at a state.
fn loses([plain, other]: &[Tape; 2], state: &State) -> bool {
    let (p, o) = (plain.evaluate(|s| state[&s]), other.evaluate(|s| state[&s]));
    let apart = |k: &usize| (p[*k] - o[*k]).abs() > MORE * f64::EPSILON * p[*k].abs();
    let suspects: Vec<usize> = (0..p.len()).filter(|k| p[*k].is_finite() && (apart(k) || o[*k].is_nan())).collect();
    if suspects.is_empty() {
        return false;
    }
    let exact: Vec<DoubleDouble> = plain.evaluate(|s| state[&s].into());
    let off = |k: usize, value: f64| (exact[k] - DoubleDouble::from(value)).abs().to_f64();
    let mut allowed: Vec<f64> = p.iter().enumerate().map(|(k, value)| off(k, *value)).collect();
    for moved in state.keys() {
        let value = |s: Symbol| if s == *moved { state[&s] * (1.0 + f64::EPSILON) } else { state[&s] };
        let near: Vec<DoubleDouble> = plain.evaluate(|s| value(s).into());
        for (allowed, (near, exact)) in allowed.iter_mut().zip(near.iter().zip(&exact)) {
            *allowed += (*near - *exact).abs().to_f64();
        }
    }
    suspects.into_iter().any(|k| {
        let size = exact[k].abs().to_f64();
        // Where nothing is known of the value there is nothing to lose.
        let known = allowed[k] <= KNOWN * size;
        known && (o[k].is_nan() || off(k, o[k]) > (MORE * allowed[k]).max(LOSS * size))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Unary;

    /// The square of a sum, and the same multiplied out.
    fn squares(graph: &mut Graph, a: Id, b: Id) -> (Id, Id) {
        let sum = graph.add(a, b);
        let two = graph.integer(2);
        let (aa, ab, bb) = (graph.mul(a, a), graph.mul(a, b), graph.mul(b, b));
        let twice = graph.mul(two, ab);
        let rest = graph.add(twice, bb);
        (graph.mul(sum, sum), graph.add(aa, rest))
    }

    #[test]
    fn a_square_that_vanishes_is_not_multiplied_out() {
        let mut g = Graph::new();
        let (t, x) = (g.symbol(Symbol::Time), g.symbol(Symbol::Coordinate(0)));
        let far = g.integer(-1_000_000);
        let cosine = g.unary(Unary::Cos, x);
        let negative = g.neg(cosine);
        let (square, out) = squares(&mut g, t, far);
        let bells = [square, out].map(|inner| g.unary(Unary::Exp, inner));
        assert!(!rounds_alike(&g, &bells[..1], &bells[1..]));
        for (a, b) in [(t, far), (t, x), (Id::ONE, negative)] {
            let (square, out) = squares(&mut g, a, b);
            assert!(!rounds_alike(&g, &[square], &[out]));
            assert!(rounds_alike(&g, &[out], &[square]));
        }
    }

    #[test]
    fn what_rounding_of_the_state_explains_is_allowed() {
        let mut g = Graph::new();
        let (x, y) = (g.symbol(Symbol::Coordinate(0)), g.symbol(Symbol::Coordinate(1)));
        let far = g.integer(1_000_000);
        let (sine, difference) = (g.unary(Unary::Sin, y), g.sub(x, far));
        // (x − c) sin y and x sin y − c sin y
        let plain = g.mul(difference, sine);
        let (one, other) = (g.mul(x, sine), g.mul(far, sine));
        let out = g.sub(one, other);
        assert!(rounds_alike(&g, &[plain], &[out]));
        // (cos x + 2 cos y)² + (sin x + 2 sin y)² vanishes nowhere.
        let two = g.integer(2);
        let [sines, cosines] = [Unary::Sin, Unary::Cos].map(|f| {
            let [a, b] = [x, y].map(|angle| g.unary(f, angle));
            let twice = g.mul(two, b);
            squares(&mut g, a, twice)
        });
        let (plain, out) = (g.add(sines.0, cosines.0), g.add(sines.1, cosines.1));
        assert!(rounds_alike(&g, &[plain], &[out]));
    }
}
