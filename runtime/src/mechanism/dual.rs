//! Numbers with a slope, and with what rounding did to them: exact derivatives of whatever is computed with them, and bounds of its
//! errors.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::normal;
use super::{Real, Table, Table2d};

/// x + x' ε with ε² = 0: a value and its derivative in one direction (Griewank and Walther, Evaluating Derivatives,
/// 2008, 3.1), with a running bound of its rounding error (Higham, Accuracy and Stability of Numerical Algorithms, 2002, 3.3).
///
/// Where a function has no derivative, at a kink or a jump that the direction leads across, the slope is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Dual {
    pub value: f64,
    pub slope: f64,
    /// Whether it depends on what changes, if only by terms of higher order: the root of x² has no slope at 0.
    pub moves: bool,
    /// What rounding has made of the value, in units u = 2⁻⁵³: m(x ± y) = m(x) + m(y) + |x ± y|, m(x y) = m(x) |y| + |x| m(y) + |x y|,
    /// m(f(x)) = |f'(x)| m(x) + |f(x)|.
    pub rounding: f64,
}

/// u.
const UNIT: f64 = 0.5 * f64::EPSILON;

impl Dual {
    /// A number that does not change.
    pub fn constant(value: f64) -> Dual {
        Dual { value, slope: 0.0, moves: false, rounding: 0.0 }
    }

    /// A number that was rounded when it was made, and does not change; whole ones are exact.
    pub fn rounded(value: f64) -> Dual {
        let rounding = if value.fract() == 0.0 { 0.0 } else { value.abs() };
        Dual { rounding, ..Dual::constant(value) }
    }

    /// A number that changes with this slope.
    pub fn moving(value: f64, slope: f64) -> Dual {
        Dual { slope, moves: slope != 0.0, ..Dual::constant(value) }
    }

    /// What rounding has made of the value at the most.
    pub fn error(self) -> f64 {
        UNIT * self.rounding
    }

    /// f(x) with the derivative f'(x); what does not change needs none.
    pub fn mapped(self, value: f64, derivative: f64) -> Dual {
        self.bent(value, derivative, f64::INFINITY)
    }

    /// f(x), which its argument's error changes by no more than `most` where f'(x) is not finite.
    fn bent(self, value: f64, derivative: f64, most: f64) -> Dual {
        let spread = times(self.rounding, derivative.abs()).min(most);
        Dual { value, slope: self.along(derivative), moves: self.moves, rounding: spread + value.abs() }
    }

    /// slope · derivative, 0 where nothing changes, however steep the function is; a product 0 · ∞ of what changes is not known.
    fn along(self, derivative: f64) -> f64 {
        if self.moves { self.slope * derivative } else { 0.0 }
    }

    /// A value of two arguments, by its derivatives by each.
    pub(super) fn joined(value: f64, parts: [(Dual, f64); 2]) -> Dual {
        let [slope, spread] = parts.iter().fold([0.0; 2], |[slope, spread], (x, derivative)| {
            [slope + x.along(*derivative), spread + times(x.rounding, derivative.abs())]
        });
        Dual { value, slope, moves: parts.iter().any(|(x, _)| x.moves), rounding: spread + value.abs() }
    }
}

/// size · derivative, 0 of nothing, however steep the function is.
fn times(size: f64, derivative: f64) -> f64 {
    if size == 0.0 { 0.0 } else { size * derivative }
}

impl Add for Dual {
    type Output = Dual;

    fn add(self, other: Dual) -> Dual {
        Dual::joined(self.value + other.value, [(self, 1.0), (other, 1.0)])
    }
}

impl Sub for Dual {
    type Output = Dual;

    fn sub(self, other: Dual) -> Dual {
        Dual::joined(self.value - other.value, [(self, 1.0), (other, -1.0)])
    }
}

impl Mul for Dual {
    type Output = Dual;

    fn mul(self, other: Dual) -> Dual {
        Dual::joined(self.value * other.value, [(self, other.value), (other, self.value)])
    }
}

impl Div for Dual {
    type Output = Dual;

    fn div(self, other: Dual) -> Dual {
        let value = self.value / other.value;
        Dual::joined(value, [(self, 1.0 / other.value), (other, -value / other.value)])
    }
}

impl Neg for Dual {
    type Output = Dual;

    fn neg(self) -> Dual {
        Dual { value: -self.value, slope: -self.slope, ..self }
    }
}

impl Real for Dual {
    /// A value, and its slope.
    const LANES: usize = 2;

    fn gather(lane: impl Fn(usize) -> f64) -> Dual {
        Dual::moving(lane(0), lane(1))
    }

    fn lane(self, lane: usize) -> f64 {
        if lane == 0 { self.value } else { self.slope }
    }

    fn ratio(n: f64, d: f64) -> Dual {
        Dual::constant(n / d)
    }

    fn sqrt(self) -> Dual {
        let root = self.value.sqrt();
        self.bent(root, 0.5 / root, (self.rounding / UNIT).sqrt())
    }

    fn sin_cos(self) -> (Dual, Dual) {
        let (sin, cos) = self.value.sin_cos();
        (self.mapped(sin, cos), self.mapped(cos, -sin))
    }

    fn tan(self) -> Dual {
        let tan = self.value.tan();
        self.mapped(tan, 1.0 + tan * tan)
    }

    fn asin(self) -> Dual {
        self.bent(self.value.asin(), 1.0 / (1.0 - self.value * self.value).sqrt(), (2.0 * self.rounding / UNIT).sqrt())
    }

    fn acos(self) -> Dual {
        self.bent(self.value.acos(), -1.0 / (1.0 - self.value * self.value).sqrt(), (2.0 * self.rounding / UNIT).sqrt())
    }

    fn atan(self) -> Dual {
        self.mapped(self.value.atan(), 1.0 / (1.0 + self.value * self.value))
    }

    fn atan2(self, x: Dual) -> Dual {
        let square = self.value * self.value + x.value * x.value;
        Dual::joined(self.value.atan2(x.value), [(self, x.value / square), (x, -self.value / square)])
    }

    fn sinh(self) -> Dual {
        self.mapped(self.value.sinh(), self.value.cosh())
    }

    fn cosh(self) -> Dual {
        self.mapped(self.value.cosh(), self.value.sinh())
    }

    fn tanh(self) -> Dual {
        let tanh = self.value.tanh();
        self.mapped(tanh, 1.0 - tanh * tanh)
    }

    fn exp(self) -> Dual {
        let exp = self.value.exp();
        self.mapped(exp, exp)
    }

    fn ln(self) -> Dual {
        self.mapped(self.value.ln(), 1.0 / self.value)
    }

    fn powf(self, y: Dual) -> Dual {
        let value = self.value.powf(y.value);
        Dual::joined(value, [(self, y.value * self.value.powf(y.value - 1.0)), (y, value * self.value.ln())])
    }

    fn select_nonnegative(self, yes: Dual, no: Dual) -> Dual {
        let chosen = if self.value >= 0.0 { yes } else { no };
        let at_the_edge = self.value == 0.0 && self.slope != 0.0;
        let differ = (yes.value, yes.slope) != (no.value, no.slope);
        if at_the_edge && differ { Dual { slope: f64::NAN, ..chosen } } else { chosen }
    }

    fn exceeds(self, floor: Dual) -> bool {
        self.value > floor.value
    }

    fn table(self, table: &Table, order: usize) -> Dual {
        let at = |order| table.evaluate(self.value, order);
        self.mapped(at(order), at(order + 1))
    }

    /// No slope: the numbers of a stream are as they are.
    fn normal(self, place: Dual, key: u64) -> Dual {
        Dual::constant(normal(key, self.value, place.value))
    }

    fn table_2d(self, other: Dual, table: &Table2d, [x, y]: [usize; 2]) -> Dual {
        let at = |order| table.evaluate(self.value, other.value, order);
        Dual::joined(at([x, y]), [(self, at([x + 1, y])), (other, at([x, y + 1]))])
    }
}

/// Numbers that were rounded when they were made.
pub(super) fn rounded(from: &[f64], to: &mut [Dual]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = Dual::rounded(*from));
}

/// Numbers that change with these slopes; where there are none, zeros that do not change.
pub(super) fn moving(from: &[f64], slopes: &[f64], to: &mut [Dual]) {
    for (k, to) in to.iter_mut().enumerate() {
        let of = |list: &[f64]| list.get(k).copied().unwrap_or(0.0);
        *to = Dual::moving(of(from), of(slopes));
    }
}

/// The slopes of (u, u', u'') of an input that has another function in the place of the file's, when time changes with this slope; what
/// the third derivative would say is not known.
pub(super) fn replaced_input([u, rate, second]: [f64; 3], clock: f64) -> [Dual; 3] {
    let third = if clock == 0.0 || (rate, second) == (0.0, 0.0) { 0.0 } else { f64::NAN };
    [Dual::moving(u, clock * rate), Dual::moving(rate, clock * second), Dual::moving(second, third)]
}

/// Numbers that do not change; where there are none, zeros.
pub(super) fn still(from: &[f64], to: &mut [Dual]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = Dual::constant(*from));
}

/// Gives the number at a place of several lists, counted through all of them, a slope.
pub(super) fn seed(lists: &mut [&mut [Dual]], mut place: usize, slope: f64) {
    for list in lists {
        match list.get_mut(place) {
            Some(number) => return (number.slope, number.moves) = (slope, slope != 0.0),
            None => place -= list.len(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every derivative beside that of the inverse or of an identity, to rounding.
    #[test]
    fn slopes_are_derivatives() {
        let x = |value: f64| Dual::moving(value, 1.0);
        let close = |found: Dual, value: f64, slope: f64| {
            let off = (found.value - value).abs().max((found.slope - slope).abs());
            assert!(off < 1e-14, "{found:?} is not {value} + {slope} ε");
        };
        for value in [0.3, 0.7] {
            let it = x(value);
            close(it.sin_cos().0.asin(), value, 1.0);
            close(it.sin_cos().1.acos(), value, 1.0);
            close(it.tan().atan(), value, 1.0);
            close(it.tan().atan2(Dual::constant(1.0)), value, 1.0);
            close(it.exp().ln(), value, 1.0);
            close(it.sinh() / it.cosh() - it.tanh(), 0.0, 0.0);
            close(it.cosh() * it.cosh() - it.sinh() * it.sinh(), 1.0, 0.0);
            close(it.sqrt() * it.sqrt(), value, 1.0);
            close(it.powf(Dual::constant(2.5)), value.powf(2.5), 2.5 * value.powf(1.5));
            close(Dual::constant(2.0).powf(it), 2.0_f64.powf(value), 2.0_f64.powf(value) * 2.0_f64.ln());
        }
    }

    #[test]
    fn kinks_have_no_slope() {
        let zero = Dual::moving(0.0, 1.0);
        assert!(zero.abs().slope.is_nan() && zero.step().slope.is_nan() && zero.max(-zero).slope.is_nan());
        // So has the root of a square, whose own slope is 0 there.
        assert!((zero * zero).sqrt().slope.is_nan() && (zero * zero).powf(Dual::constant(0.5)).slope.is_nan());
        // Where nothing moves nothing has to be differentiable.
        let still = Dual::constant(0.0);
        assert_eq!((still.abs().slope, still.sqrt().slope, still.max(still).slope), (0.0, 0.0, 0.0));
        assert_eq!((zero - Dual::constant(1.0)).abs().slope, -1.0);
    }

    #[test]
    fn what_is_no_number_stays_none() {
        let (nan, one) = (Dual::constant(f64::NAN), Dual::constant(1.0));
        let all = [nan.step(), nan.sign(), nan.abs(), nan.min(one), one.min(nan), nan.max(one), one.max(nan)];
        assert!(all.iter().all(|x| x.value.is_nan()), "{all:?}");
    }

    /// Each formula beside one that loses nothing.
    #[test]
    fn what_cancels_knows_what_is_left() {
        let one = Dual::constant(1.0);
        for angle in [1e-2_f64, 1e-4, 1e-6, 1e-8] {
            let half = (0.5 * angle).sin();
            let found = one - Dual::constant(angle).sin_cos().1;
            let off = (found.value - 2.0 * half * half).abs();
            assert!(off <= found.error() && found.error() < 4.0 * f64::EPSILON, "{angle}: {off:e} {:e}", found.error());
        }
        let root = (Dual::constant(3.0) - Dual::constant(1.1) - Dual::constant(1.9)).sqrt();
        assert!(root.value <= root.error() && root.error() < 1e-7, "{root:?}");
        let exact = Dual::constant(0.5) * Dual::constant(0.25) + one;
        assert!((1.0..3.0).contains(&(exact.error() / UNIT)), "{exact:?}");
    }

    #[test]
    fn tables_have_their_own_slopes() {
        let pieces = vec![[1.0, -1.0, 0.0, 0.0], [1.0, -1.0, 0.5, 2.0], [17.0, 25.0, 0.0, 0.0]];
        let table = Table { knots: vec![0.0, 2.0].into(), pieces: pieces.into(), ..Table::default() };
        let found = Dual::moving(1.0, 2.0).table(&table, 0);
        assert_eq!((found.value, found.slope), (2.5, 12.0));
    }

    #[test]
    fn tables_of_two_arguments_have_their_own_slopes() {
        // 1 + 2 x + 3 x² y between 0 and 2, 0 and 3.
        let mut pieces = vec![[[0.0; 4]; 4]; 9];
        (pieces[4][0][0], pieces[4][1][0], pieces[4][2][1]) = (1.0, 2.0, 3.0);
        let knots = [vec![0.0, 2.0].into(), vec![0.0, 3.0].into()];
        let table = Table2d { knots, pieces: pieces.into(), ..Table2d::default() };
        let found = Dual::moving(1.0, 0.5).table_2d(Dual::moving(2.0, 10.0), &table, [0, 0]);
        assert_eq!((found.value, found.slope), (9.0, 0.5 * 14.0 + 10.0 * 3.0));
    }
}
