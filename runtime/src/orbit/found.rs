//! What a search for a motion that repeats found.

use crate::find::Value;
use crate::run::Run;
#[cfg(feature = "interpret")]
use crate::run::written;

/// A motion that repeats itself.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Orbit {
    /// After how long it is as it was, s; where it is shifted or turned each time, but for that.
    pub period: Value,
    /// [q; q'] at its start, SI.
    pub start: Vec<Value>,
    /// The smallest map that closes it is that of this part of the period.
    pub part: usize,
    /// What that map exchanges, mirrors and shifts; empty where it does nothing.
    pub map: String,
    /// The multipliers of that map, the largest first, without those that are known beforehand.
    pub multipliers: Vec<Multiplier>,
    /// Directions whose multipliers are known: 1 (−1 where the map mirrors them) of what is conserved and of what may be shifted, turned or
    /// begun later, 0 of time where an event closes the motion.
    pub known: Vec<String>,
    /// How many multipliers are exactly 0: so many dimensions are lost where constraints come into force.
    pub superstable: usize,
    /// Directions in which there are other such motions; the nearest to the guess was taken.
    pub free: Vec<String>,
    /// The energy (Jacobi integral), J, where it is conserved.
    pub energy: Option<f64>,
    /// Events on the way that change something, in order.
    pub events: Vec<String>,
    /// How far a plain run of one period misses, in parts of how far each number goes.
    pub returns: f64,
    /// The same to more digits, where they were asked for.
    pub extended: Option<ExtendedOrbit>,
    /// A plain run of one period.
    pub run: Run,
    /// Newton steps that were taken.
    pub steps: usize,
    /// Pieces with slopes that were run.
    pub runs: usize,
    /// Pieces of the map.
    pub legs: usize,
    /// So many times the motion was repeated within the period of the guess.
    pub repeats: usize,
}

/// A motion that repeats itself in double-double: to some 25 digits.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ExtendedOrbit {
    /// After how long it is as it was, s.
    pub period: ExtendedValue,
    /// [q; q'] at its start, SI.
    pub start: Vec<ExtendedValue>,
    /// The energy (Jacobi integral), J, where it is conserved.
    pub energy: Option<ExtendedValue>,
}

/// A number in double-double, SI: the sum of two.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ExtendedValue {
    /// What it is of.
    pub name: String,
    /// The number in `f64`.
    pub value: f64,
    /// What it is more.
    pub rest: f64,
    /// How far both together may be off: what another method's steps, and the last correction, say of it.
    pub error: f64,
}

/// Digits of a number in double-double, at most: 2⁻¹⁰⁴ is 5·10⁻³².
#[cfg(feature = "interpret")]
const MOST_DIGITS: i32 = 31;

#[cfg(feature = "interpret")]
impl ExtendedValue {
    /// The number with the digits that hold: the last one stands for no less than the error.
    pub fn written(&self) -> String {
        let ExtendedValue { value, rest, error, .. } = *self;
        let leading = value.abs().log10().floor();
        let decimals = -(error.log10().ceil().max(leading - f64::from(MOST_DIGITS - 1)));
        // In units of the last decimal, of which a number has no more than its digits and one.
        if !(leading.abs() < f64::from(MOST_DIGITS) && (0.0..=2.0 * f64::from(MOST_DIGITS)).contains(&decimals)) {
            return written(value, error);
        }
        let decimals = decimals as usize;
        let counted = |part: f64| format!("{part:.*}", decimals + 1).replace('.', "").parse::<i128>();
        let (Ok(most), Ok(least)) = (counted(value), counted(rest)) else { return written(value, error) };
        let tenths = most + least;
        let rounded = (tenths + 5 * tenths.signum()) / 10;
        let digits = format!("{:0>width$}", rounded.abs(), width = decimals + 1);
        let (whole, fraction) = digits.split_at(digits.len() - decimals);
        let sign = if rounded < 0 { "-" } else { "" };
        if fraction.is_empty() { format!("{sign}{whole}") } else { format!("{sign}{whole}.{fraction}") }
    }
}

/// By what a change of the motion is multiplied each time the map is applied: μ, as a complex number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Multiplier {
    /// Re μ.
    pub re: f64,
    /// Im μ.
    pub im: f64,
    /// ln |μ|, which tells of multipliers that are too small for a number.
    pub log_abs: f64,
    /// arg μ, rad.
    pub angle: f64,
    /// How far it may be off, as a part of |μ|: twice the difference to more accurate flows, and no less than what the largest stretch of a piece
    /// leaves of it, or than how far it is from another one of which it may be the double.
    pub error: f64,
}

/// Multipliers this near to the unit circle are on it, beside their errors.
const ON_CIRCLE: f64 = 1e-8;

impl Multiplier {
    /// That of so many times the map.
    pub fn power(self, times: usize) -> Multiplier {
        let times = times as f64;
        let angle = (times * self.angle).rem_euclid(std::f64::consts::TAU);
        let angle = if angle > std::f64::consts::PI { angle - std::f64::consts::TAU } else { angle };
        Multiplier::of(times * self.log_abs, angle, times * self.error)
    }

    pub(super) fn of(log_abs: f64, angle: f64, error: f64) -> Multiplier {
        let size = log_abs.exp();
        let im = if angle.abs() == std::f64::consts::PI { 0.0 } else { size * angle.sin() };
        Multiplier { re: size * angle.cos(), im, log_abs, angle, error }
    }

    /// The same as far as it is known to this part, or less well.
    #[must_use]
    pub fn to_digits(self, error: f64) -> Multiplier {
        Multiplier { error: if self.error > error { self.error } else { error }, ..self }
    }

    /// Whether changes in its direction grow.
    pub fn grows(self) -> bool {
        self.log_abs > ON_CIRCLE.max(self.error)
    }
}

/// What a map is of, and what it does.
pub(super) fn map_in_words(part: usize, does: &str) -> String {
    let of = if part == 1 { "the whole period".to_owned() } else { format!("1/{part} of the period") };
    if does.is_empty() { of } else { format!("{of}; {does}") }
}

impl Orbit {
    /// The smallest map that closes the motion, in words.
    pub fn map_in_words(&self) -> String {
        map_in_words(self.part, &self.map)
    }

    /// Whether no small change grows.
    pub fn is_stable(&self) -> bool {
        !self.multipliers.iter().any(|multiplier| multiplier.grows())
    }

    /// The multipliers of the whole period: powers of those of the map.
    pub fn whole(&self) -> Vec<Multiplier> {
        self.multipliers.iter().map(|multiplier| multiplier.power(self.part)).collect()
    }

    /// A number of the start, or the period.
    pub fn get(&self, name: &str) -> Option<f64> {
        std::iter::once(&self.period).chain(&self.start).find(|value| value.name == name).map(|value| value.value)
    }
}
