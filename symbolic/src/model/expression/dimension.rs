//! Dimensions of quantities, and what is known of the unit of an expression (LANGUAGE, section 10).

use std::fmt;

use crate::expr::{Number, Rational};
use crate::language::{BASES, Unit};

/// Exponents of kg, m, s, A and K, in parts of [`PARTS`]: roots have fractional ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension([i32; BASES]);

/// Exponents are multiples of 1/840, the least that has all of 1/2 to 1/8.
const PARTS: i32 = 840;

impl Dimension {
    /// A pure number.
    pub const ONE: Dimension = Dimension([0; BASES]);
    /// kg
    pub const MASS: Dimension = Dimension::si(1, 0, 0);
    /// m
    pub const LENGTH: Dimension = Dimension::si(0, 1, 0);
    /// s
    pub const TIME: Dimension = Dimension::si(0, 0, 1);
    /// rad/s
    pub const RATE: Dimension = Dimension::si(0, 0, -1);
    /// m/s.
    pub const VELOCITY: Dimension = Dimension::si(0, 1, -1);
    /// m/s²
    pub const ACCELERATION: Dimension = Dimension::si(0, 1, -2);
    /// kg m²
    pub const INERTIA: Dimension = Dimension::si(1, 2, 0);
    /// N/m
    pub const STIFFNESS: Dimension = Dimension::si(1, 0, -2);
    /// N s/m
    pub const DAMPING: Dimension = Dimension::si(1, 0, -1);
    /// N
    pub const FORCE: Dimension = Dimension::si(1, 1, -2);
    /// J, which is also N m: a radian is 1.
    pub const ENERGY: Dimension = Dimension::si(1, 2, -2);
    /// W
    pub const POWER: Dimension = Dimension::si(1, 2, -3);

    /// kg^a m^b s^c.
    pub const fn si(kg: i32, m: i32, s: i32) -> Dimension {
        Dimension::of_all([kg, m, s, 0, 0])
    }

    /// kg^a m^b s^c A^d K^e.
    const fn of_all([kg, m, s, ampere, kelvin]: [i32; BASES]) -> Dimension {
        Dimension([kg * PARTS, m * PARTS, s * PARTS, ampere * PARTS, kelvin * PARTS])
    }

    /// Of a unit of the language.
    pub fn of(unit: &Unit) -> Dimension {
        Dimension(unit.dimension.map(|halves| i32::from(halves) * (PARTS / 2)))
    }

    /// The product; `None` beyond what exponents can hold.
    pub fn times(self, other: Dimension) -> Option<Dimension> {
        let mut product = self.0;
        for (exponent, more) in product.iter_mut().zip(other.0) {
            *exponent = exponent.checked_add(more)?;
        }
        Some(Dimension(product))
    }

    /// 1 over it.
    pub fn inverse(self) -> Dimension {
        Dimension(self.0.map(i32::wrapping_neg))
    }

    /// The quotient; `None` beyond what exponents can hold.
    pub fn over(self, other: Dimension) -> Option<Dimension> {
        self.times(other.inverse())
    }

    /// A rational power; `None` where its exponents are no multiples of 1/840.
    pub fn power(self, exponent: Rational) -> Option<Dimension> {
        let (p, q) = (i32::try_from(exponent.numerator()).ok()?, i32::try_from(exponent.denominator()).ok()?);
        let mut power = self.0;
        for exponent in &mut power {
            let scaled = exponent.checked_mul(p)?;
            *exponent = (scaled % q == 0).then_some(scaled / q)?;
        }
        Some(Dimension(power))
    }
}

/// The unit of SI that a unit is converted to, `rad` for angles.
pub fn si(unit: &Unit) -> String {
    match Dimension::of(unit) {
        Dimension::ONE if !unit.is_si() => "rad".to_owned(),
        Dimension::RATE if unit.pi != 0 => "rad/s".to_owned(),
        dimension => dimension.to_string(),
    }
}

/// Common quantities: kg, m, s, A, K, what they measure, and their unit.
const NAMED: &[([i32; BASES], &str, &str)] = &[
    ([1, 0, 0, 0, 0], "a mass", "kg"),
    ([0, 1, 0, 0, 0], "a length", "m"),
    ([0, 2, 0, 0, 0], "an area", "m^2"),
    ([0, 0, 1, 0, 0], "a time", "s"),
    ([0, 0, -1, 0, 0], "a rate", "1/s"),
    ([0, 0, -2, 0, 0], "an angular acceleration", "1/s^2"),
    ([0, 1, -1, 0, 0], "a velocity", "m/s"),
    ([0, 1, -2, 0, 0], "an acceleration", "m/s^2"),
    ([1, 2, 0, 0, 0], "a moment of inertia", "kg*m^2"),
    ([1, 1, -1, 0, 0], "a momentum", "kg*m/s"),
    ([1, 2, -1, 0, 0], "an angular momentum", "kg*m^2/s"),
    ([1, 1, -2, 0, 0], "a force", "N"),
    ([1, 2, -2, 0, 0], "an energy or torque", "J"),
    ([1, 2, -3, 0, 0], "a power", "W"),
    ([1, 0, -2, 0, 0], "a stiffness", "N/m"),
    ([1, 0, -1, 0, 0], "a damping coefficient", "N*s/m"),
    ([1, -1, 0, 0, 0], "a mass per length", "kg/m"),
    ([0, 0, 0, 1, 0], "a current", "A"),
    ([0, 0, 0, 0, 1], "a temperature", "K"),
    ([0, 0, 1, 1, 0], "a charge", "C"),
    ([1, 2, -3, -1, 0], "a voltage", "V"),
    ([1, 2, -3, -2, 0], "a resistance", "ohm"),
    ([1, 2, -2, -2, 0], "an inductance", "H"),
    ([-1, -2, 4, 2, 0], "a capacitance", "F"),
    ([1, 2, -2, -1, 0], "a magnetic flux or motor constant", "V*s"),
    ([1, 0, -2, -1, 0], "a flux density", "T"),
    ([0, 0, -1, 1, 0], "a rate of a current", "A/s"),
    ([0, 0, -1, 0, 1], "a rate of a temperature", "K/s"),
    ([1, 2, -2, 0, -1], "a heat capacity", "J/K"),
    ([1, 2, -3, 0, -1], "a thermal conductance", "W/K"),
];

impl Dimension {
    /// For messages: `a pure number`, `a force (N)`, `in kg*m^3`.
    pub fn described(self) -> String {
        if self == Dimension::ONE {
            return "a pure number".to_owned();
        }
        let named = NAMED.iter().find(|(exponents, ..)| Dimension::of_all(*exponents) == self);
        match named {
            Some((_, quantity, unit)) => format!("{quantity} ({unit})"),
            None => format!("in {self}"),
        }
    }
}

impl Dimension {
    /// For messages: `a pure number`, `in N`, `in J (N*m)`.
    pub fn wanted(self) -> String {
        match self {
            Dimension::ONE => "a pure number".to_owned(),
            Dimension::ENERGY => "in J (N*m)".to_owned(),
            _ => format!("in {self}"),
        }
    }
}

/// As the language writes units: `N`, `kg*m^3/s`, `m^(1/2)`.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((.., unit)) = NAMED.iter().find(|(exponents, ..)| Dimension::of_all(*exponents) == *self) {
            return f.write_str(unit);
        }
        let factors = |sign: i32| {
            let bases = ["kg", "m", "s", "A", "K"].into_iter().zip(self.0);
            let written = bases.filter(|(_, exponent)| exponent.signum() == sign).map(|(base, exponent)| {
                match Rational::new(i128::from(exponent.abs()), i128::from(PARTS)) {
                    Some(Rational::ONE) | None => base.to_owned(),
                    Some(power) if power.denominator() == 1 => format!("{base}^{}", power.numerator()),
                    Some(power) => format!("{base}^({}/{})", power.numerator(), power.denominator()),
                }
            });
            written.collect::<Vec<_>>().join(if sign > 0 { "*" } else { "/" })
        };
        match (factors(1), factors(-1)) {
            (above, below) if below.is_empty() => f.write_str(if above.is_empty() { "1" } else { &above }),
            (above, below) => write!(f, "{}/{below}", if above.is_empty() { "1" } else { &above }),
        }
    }
}

/// What is known of the unit of an expression.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measure {
    /// It depends on something without a unit, and is not checked.
    #[default]
    Unknown,
    /// 0, which fits all.
    Zero,
    /// Of this dimension, in SI.
    Of(Dimension),
}

impl Measure {
    /// A pure number.
    pub const ONE: Measure = Measure::Of(Dimension::ONE);

    /// The product.
    pub fn times(self, other: Measure) -> Measure {
        match (self, other) {
            (Measure::Zero, _) | (_, Measure::Zero) => Measure::Zero,
            (Measure::Of(a), Measure::Of(b)) => Measure::from(a.times(b)),
            _ => Measure::Unknown,
        }
    }

    /// The quotient.
    pub fn over(self, other: Measure) -> Measure {
        match (self, other) {
            (Measure::Zero, _) => Measure::Zero,
            (Measure::Of(a), Measure::Of(b)) => Measure::from(a.over(b)),
            _ => Measure::Unknown,
        }
    }

    /// A power; the exponent of a root or power is a number.
    pub fn power(self, exponent: Number) -> Measure {
        match (self, exponent) {
            (Measure::Of(Dimension::ONE), _) => Measure::ONE,
            (Measure::Of(base), Number::Exact(exponent)) => Measure::from(base.power(exponent)),
            (Measure::Zero, _) => Measure::Zero,
            _ => Measure::Unknown,
        }
    }

    /// The unit of both, where they agree; `None` where they do not.
    pub fn alike(self, other: Measure) -> Option<Measure> {
        match (self, other) {
            (Measure::Unknown, _) | (_, Measure::Unknown) => Some(Measure::Unknown),
            (Measure::Zero, known) | (known, Measure::Zero) => Some(known),
            (a, b) => (a == b).then_some(a),
        }
    }

    /// The dimension, where it is known.
    pub fn dimension(self) -> Option<Dimension> {
        match self {
            Measure::Of(dimension) => Some(dimension),
            Measure::Unknown | Measure::Zero => None,
        }
    }
}

impl From<Option<Dimension>> for Measure {
    fn from(known: Option<Dimension>) -> Measure {
        known.map_or(Measure::Unknown, Measure::Of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_read_like_units() {
        assert_eq!(Dimension::FORCE.described(), "a force (N)");
        assert_eq!(Dimension::ONE.described(), "a pure number");
        assert_eq!(Dimension::si(1, 3, -1).described(), "in kg*m^3/s");
        assert_eq!(Dimension::si(0, -1, -2).to_string(), "1/m/s^2");
        let volt = Dimension::POWER.over(Dimension::of_all([0, 0, 0, 1, 0])).unwrap();
        assert_eq!(volt.described(), "a voltage (V)");
        assert_eq!(Dimension::of_all([1, 1, -3, 0, -1]).to_string(), "kg*m/s^3/K");
        let half = Rational::new(1, 2).unwrap();
        assert_eq!(Dimension::LENGTH.power(half).unwrap().to_string(), "m^(1/2)");
        assert_eq!(Dimension::si(0, 2, -2).power(half), Some(Dimension::si(0, 1, -1)));
        assert_eq!(Dimension::LENGTH.power(Rational::new(1, 11).unwrap()), None);
    }

    #[test]
    fn zero_fits_all_and_what_is_unknown_is_not_checked() {
        let (m, s) = (Measure::Of(Dimension::LENGTH), Measure::Of(Dimension::TIME));
        assert_eq!(m.alike(Measure::Zero), Some(m));
        assert_eq!(m.alike(Measure::Unknown), Some(Measure::Unknown));
        assert_eq!(m.alike(s), None);
        assert_eq!(Measure::Zero.times(m), Measure::Zero);
        assert_eq!(m.over(s).times(s), m);
    }
}
