//! Numbers at which ways to an integral are tried.

use super::builder::ExprBuilder;
use super::integral::{Over, RuleNode};
use super::quadrature::gauss_legendre;
use super::substitute::substitute;
use crate::expr::{Graph, Id, Measured, Symbol, Tape};
use crate::number::DoubleDouble;
use crate::random::Random;

/// A stretch of the interval.  The integrand is written twice, by the distance from either end, so that a vanishing
/// b − x is exactly that distance.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Its length, with a sign.
    pub width: Id,
    /// The integrand at the left end plus [`Piece::OFFSET`].
    pub from_left: Id,
    /// The integrand at the right end minus it.
    pub from_right: Id,
}

impl Piece {
    /// The distance from an end.
    pub const OFFSET: Symbol = Symbol::Dummy(u32::MAX);

    /// The stretch between two ends.
    pub fn new(builder: &mut ExprBuilder, e: Id, over: Over, from: Id, to: Id) -> Piece {
        let offset = builder.graph.symbol(Piece::OFFSET);
        let at = [builder.graph.add(from, offset), builder.graph.sub(to, offset)];
        let [from_left, from_right] =
            at.map(|x| substitute(&mut builder.graph, &mut builder.facts, e, over.symbol, x).0);
        Piece { width: builder.graph.sub(to, from), from_left, from_right }
    }
}

/// The values of parameters, coordinates and whatever else the integrand contains, at each trial.
pub struct Trial {
    /// With limits in order where they are in one order at every trial.
    pub over: Over,
    /// Whether the limits were exchanged.
    pub reversed: bool,
    /// Whether the limits are in order at every trial now.
    pub ordered: bool,
    values: Vec<Values>,
    /// ∫ φ dx and ∫ |φ| dx at each trial, to some digits.
    survey: Vec<[f64; 2]>,
}

/// Values of the symbols at one trial.
type Values = Vec<(Symbol, f64)>;

/// Within ± this are numbers that have no default.
const WITHIN: f64 = 3.0;
/// How many trials there are, of which the last two go beyond the factors 0.8..1.25 of section 8.
const TRIALS: usize = 6;
/// What the survey, which finds peaks and poles that a rule may miss, is right to.
const SURVEY: f64 = 1e-4;
/// ∫ |φ| over ever smaller stretches beside an end must fade: this much may remain in the last ones.
const REMAINDER: f64 = 0.02;
/// How much larger than the integral the terms of a closed form may be.
const CANCELLATION: f64 = 1e3;

/// Where in the interval a place is put at which the integrand turns: the first share of it that what is free allows.
const SHARES: [f64; 3] = [0.618, 0.053, 0.947];

impl Trial {
    /// Draws the numbers.  Each of the `turns`, places at which something in the integrand vanishes, is inside of the interval at some of them
    /// if what it is made of allows it: a rule that never saw a kink, or a peak, does not show how wrong it is.
    pub fn new(builder: &ExprBuilder, e: Id, over: Over, turns: &[Id]) -> Trial {
        let symbols = builder.graph.symbols([&[e], &over.limits[..]].concat());
        let mut random = Random::new();
        let free: Vec<Symbol> = symbols.into_iter().filter(|s| *s != over.symbol).collect();
        let trials = if free.is_empty() { 1 } else { TRIALS };
        let mut values: Vec<Values> = (0..trials)
            .map(|k| free.iter().map(|s| (*s, drawn(&builder.defaults, *s, k, &mut random))).collect())
            .chain(builder.settings.iter().filter_map(|setting| set(builder, &free, setting)))
            .collect();
        for turn in turns {
            let tape = Tape::new(&builder.graph, &[over.limits[0], over.limits[1], *turn]);
            if !values.iter().any(|values| is_inside(share(&tape, values))) {
                values.extend(turned_inside(builder, &free, &tape, &values));
            }
        }
        let mut trial = Trial { over, reversed: false, ordered: false, values, survey: Vec::new() };
        let widths: Vec<f64> = {
            let tape = Tape::new(&builder.graph, &over.limits);
            let width = |values: &Values| {
                let ends = tape.evaluate(|s| value(values, s));
                ends[1] - ends[0]
            };
            trial.values.iter().map(width).collect()
        };
        trial.reversed = widths.iter().all(|w| *w <= 0.0);
        trial.ordered = trial.reversed || widths.iter().all(|w| *w >= 0.0);
        if trial.reversed {
            trial.over.limits.reverse();
        }
        trial
    }

    /// With the survey; trials at which the integrand is not finite are left out.  `None` where too few remain, or
    /// where ∫ |φ| dx does not exist.
    pub fn surveyed(mut self, builder: &ExprBuilder, pieces: &[Piece]) -> Option<Trial> {
        let drawn = self.values.len();
        let tapes: Vec<Tape> = pieces.iter().map(|piece| piece.tape(&builder.graph)).collect();
        let mut kept = Vec::new();
        for values in std::mem::take(&mut self.values) {
            let found = tapes.iter().map(|tape| survey(tape, &values)).try_fold([0.0; 3], |sum, part| {
                let sum = [sum[0] + part[0], sum[1] + part[1], sum[2] + part[2]];
                sum.iter().all(|x| x.is_finite()).then_some(sum)
            });
            let Some([integral, size, remainder]) = found else { continue };
            if remainder > REMAINDER * size {
                return None;
            }
            kept.push((values, [integral, size]));
        }
        if kept.len() < drawn.div_ceil(2) {
            return None;
        }
        (self.values, self.survey) = kept.into_iter().unzip();
        Some(self)
    }

    /// Between which values of parameters, coordinates and so on the integral was tried.
    pub fn ranges(&self, builder: &ExprBuilder) -> Vec<(Symbol, [f64; 2])> {
        let symbols = self.values.first().map_or(&[][..], Vec::as_slice).iter().map(|(symbol, _)| *symbol);
        let own = symbols.filter(|symbol| !matches!(symbol, Symbol::Dummy(_)));
        let range = |symbol: Symbol| {
            let tried = self.values.iter().map(|values| value(values, symbol));
            tried.fold(usual(&builder.defaults, symbol), |[low, high], x| [low.min(x), high.max(x)])
        };
        own.map(|symbol| (symbol, range(symbol))).collect()
    }

    /// What a rule gives at each trial.
    pub fn by_rule(&self, graph: &Graph, pieces: &[Piece], nodes: &[RuleNode]) -> Vec<DoubleDouble> {
        let tapes: Vec<Tape> = pieces.iter().map(|piece| piece.tape(graph)).collect();
        let (mut scratch, mut results) = (Vec::new(), [DoubleDouble::ZERO; 3]);
        let mut integral = |values: &Values| {
            let mut total = DoubleDouble::ZERO;
            for tape in &tapes {
                let mut sum = DoubleDouble::ZERO;
                let mut at = |offset: DoubleDouble| {
                    let value = |s| if s == Piece::OFFSET { offset } else { value(values, s).into() };
                    tape.run(value, &mut scratch, &mut results);
                    results
                };
                let width = at(DoubleDouble::ONE)[0];
                for (distance, right, weight) in nodes {
                    sum += *weight * at(*distance * width)[1 + usize::from(*right)];
                }
                // A stretch of no length counts for nothing, even where the integrand is infinite at it.
                if width != DoubleDouble::ZERO {
                    total += sum * width;
                }
            }
            total
        };
        self.values.iter().map(&mut integral).collect()
    }

    /// Whether two refinements agree, and agree with the survey.
    pub fn agree(&self, coarse: &[DoubleDouble], fine: &[DoubleDouble], tolerance: f64) -> bool {
        let pairs = coarse.iter().zip(fine).zip(&self.survey);
        pairs.into_iter().all(|((a, b), [integral, size])| {
            (*a - *b).abs().to_f64() <= tolerance * size && (b.to_f64() - integral).abs() <= SURVEY * size
        })
    }

    /// Whether a closed form is finite, cancels few digits, and agrees with the survey where it could be another branch.
    pub fn accepts(&self, builder: &ExprBuilder, closed: Id, entire: bool) -> bool {
        let tape = Tape::new(&builder.graph, &[closed]);
        self.values.iter().zip(&self.survey).all(|(values, [integral, size])| {
            let found: Measured = tape.measured(|s| value(values, s).into())[0];
            let right = entire || (found.value.to_f64() - integral).abs() <= SURVEY * size;
            right && found.value.is_finite() && found.magnitude <= CANCELLATION * size
        })
    }
}

impl Piece {
    fn tape(&self, graph: &Graph) -> Tape {
        Tape::new(graph, &[self.width, self.from_left, self.from_right])
    }
}

/// Where in an interval a place is: 0 at its beginning, 1 at its end.
fn share(tape: &Tape, values: &Values) -> f64 {
    let found = tape.evaluate(|s| value(values, s));
    (found[2] - found[0]) / (found[1] - found[0])
}

fn is_inside(share: f64) -> bool {
    share > 0.0 && share < 1.0
}

/// Values drawn last, with another of one symbol, with which a place is inside of the interval; `None` where none is found.
fn turned_inside(builder: &ExprBuilder, free: &[Symbol], tape: &Tape, known: &[Values]) -> Option<Values> {
    let last = known.last()?;
    let with = |symbol: Symbol, x: f64| -> Values {
        last.iter().map(|(known, old)| (*known, if *known == symbol { x } else { *old })).collect()
    };
    let pairs = SHARES.iter().flat_map(|share| free.iter().map(move |symbol| (*share, *symbol)));
    pairs.into_iter().find_map(|(wanted, symbol)| {
        // A step of the secant method: the place and the limits are linear in most of what they are made of.
        let missing = |x: f64| {
            let found = tape.evaluate(|s| value(&with(symbol, x), s));
            found[2] - found[0] - wanted * (found[1] - found[0])
        };
        let here = value(last, symbol);
        let other = if here == 0.0 { 1.0 } else { 1.1 * here };
        let x = here - missing(here) * (other - here) / (missing(other) - missing(here));
        let [low, high] = usual(&builder.defaults, symbol);
        let allowed = !matches!(symbol, Symbol::Parameter(_)) || (low..=high).contains(&x);
        let values = with(symbol, x);
        (allowed && x.is_finite() && is_inside(share(tape, &values))).then_some(values)
    })
}

fn value(values: &Values, symbol: Symbol) -> f64 {
    values.iter().find(|(known, _)| *known == symbol).map_or(0.0, |(_, value)| *value)
}

/// What a scene gives to these symbols, defaults and 0 to others; `None` where that is among what is tried anyway.
fn set(builder: &ExprBuilder, free: &[Symbol], setting: &[(Symbol, f64)]) -> Option<Values> {
    let given = |symbol: Symbol| setting.iter().find(|(known, _)| *known == symbol).map(|(_, x)| *x);
    let beyond = |symbol: &Symbol| {
        let [low, high] = usual(&builder.defaults, *symbol);
        given(*symbol).is_some_and(|x| x < low || x > high)
    };
    let or_default = |symbol: Symbol| given(symbol).unwrap_or_else(|| default(&builder.defaults, symbol));
    free.iter().any(beyond).then(|| free.iter().map(|symbol| (*symbol, or_default(*symbol))).collect())
}

/// 0 for what is no parameter.
fn default(defaults: &[f64], symbol: Symbol) -> f64 {
    match symbol {
        Symbol::Parameter(k) => defaults.get(k as usize).copied().unwrap_or(0.0),
        _ => 0.0,
    }
}

/// Between which values something is drawn.
fn usual(defaults: &[f64], symbol: Symbol) -> [f64; 2] {
    match default(defaults, symbol) {
        0.0 => [-WITHIN, WITHIN],
        default if default < 0.0 => [2.0 * default, 0.5 * default],
        default => [0.5 * default, 2.0 * default],
    }
}

/// A parameter's default times a factor; a default of 0 becomes 0 and numbers of either sign; anything else a number
/// within ±3, 0 and small ones among them.
fn drawn(defaults: &[f64], symbol: Symbol, trial: usize, random: &mut Random) -> f64 {
    let default = default(defaults, symbol);
    let beyond = trial + 2 >= TRIALS;
    if default != 0.0 {
        let factor = if beyond { random.between(0.5, 2.0) } else { random.between(0.8, 1.25) };
        return if trial == 0 { default } else { default * factor };
    }
    match trial {
        0 => 0.0,
        1 => random.between(-0.01, 0.01),
        _ => random.between(-WITHIN, WITHIN),
    }
}

/// ∫ φ, ∫ |φ| and the part of the latter that is nearest to the ends: six points on each of many panels, ever smaller
/// ones beside the ends.
fn survey(tape: &Tape, values: &Values) -> [f64; 3] {
    /// Panels of equal size on each half, and how often those beside the ends are halved.
    const PANELS: i32 = 64;
    const HALVINGS: i32 = 50;
    const LAST: i32 = 8;
    let rule: Vec<(f64, f64)> = gauss_legendre(6).iter().map(|(x, w)| (x.to_f64(), w.to_f64())).collect();
    let (mut scratch, mut results) = (Vec::new(), [0.0; 3]);
    let mut at = |offset: f64| {
        tape.run(|s| if s == Piece::OFFSET { offset } else { value(values, s) }, &mut scratch, &mut results);
        results
    };
    let width = at(1.0)[0];
    let mut total = [0.0; 3];
    if width == 0.0 {
        return total;
    }
    let panel = 0.5 / f64::from(PANELS);
    let equal = (1..PANELS).map(|k| (panel * f64::from(k), panel, false));
    let small = (0..HALVINGS).map(|k| {
        let size = panel * 2_f64.powi(-k - 1);
        (size, size, k >= HALVINGS - LAST)
    });
    for (start, size, last) in equal.chain(small) {
        for (x, w) in &rule {
            let [_, left, right] = at(width * (start + size * 0.5 * (1.0 + x)));
            let weight = w * 0.5 * size;
            total[0] += weight * (left + right) * width;
            let part = weight * (left.abs() + right.abs()) * width.abs();
            total[1] += part;
            total[2] += if last { part } else { 0.0 };
        }
    }
    total
}
