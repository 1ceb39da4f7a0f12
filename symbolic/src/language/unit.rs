//! Units: `kg*m^2/s^2` to an exact factor and a dimension.

use super::token::{Kind, Token, shorten, tokens};
use crate::diagnose::{Problem, catalogue::syntax, nearest};
use crate::number::{DoubleDouble, Number, Rational};

/// How many base units there are: kg, m, s, A, K.
pub const BASES: usize = 5;

/// A unit as a factor to SI and a dimension.
///
/// A value of x units is x · `scale` · π^`pi` in SI; only `deg` (π/180) brings in π.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit {
    /// Exact rational factor.
    pub scale: Rational,
    /// Power of π.
    pub pi: i8,
    /// Exponents of kg, m, s, A, K, in halves: N/m^1.5 is a unit too.
    pub dimension: [i8; BASES],
}

impl Unit {
    /// The pure number 1.
    pub const ONE: Unit = Unit { scale: Rational::ONE, pi: 0, dimension: [0; BASES] };

    /// The factor to SI.
    pub fn factor(&self) -> Number {
        let pi = Number::Float(DoubleDouble::PI);
        let pi = if self.pi < 0 { pi.recip() } else { pi };
        (0..self.pi.unsigned_abs()).fold(Number::Exact(self.scale), |factor, _| factor.times(pi))
    }

    /// True where a value in it is the value in SI.
    pub fn is_si(&self) -> bool {
        self.pi == 0 && self.scale == Rational::ONE
    }

    fn multiply(self, other: Unit) -> Option<Unit> {
        let mut dimension = [0; BASES];
        for (sum, (a, b)) in dimension.iter_mut().zip(self.dimension.into_iter().zip(other.dimension)) {
            *sum = a.checked_add(b)?;
        }
        Some(Unit { scale: self.scale.checked_mul(other.scale)?, pi: self.pi.checked_add(other.pi)?, dimension })
    }

    fn inverse(self) -> Option<Unit> {
        let scale = Rational::new(self.scale.denominator(), self.scale.numerator())?;
        Some(Unit { scale, pi: self.pi.checked_neg()?, dimension: self.dimension.map(i8::wrapping_neg) })
    }

    /// A power whose exponent is told in halves.
    fn power(self, halves: i8) -> Option<Unit> {
        let base = if halves < 0 { self.inverse()? } else { self };
        let times = |count: u8| (0..count).try_fold(Unit::ONE, |product, _| product.multiply(base));
        let halves = halves.unsigned_abs();
        if halves.is_multiple_of(2) { times(halves / 2) } else { times(halves)?.root() }
    }

    /// The square root, where it is exact.
    fn root(self) -> Option<Unit> {
        let exact = |n: i128| n.checked_isqrt().filter(|root| root * root == n);
        let scale = Rational::new(exact(self.scale.numerator())?, exact(self.scale.denominator())?)?;
        let even = self.pi % 2 == 0 && self.dimension.iter().all(|exponent| exponent % 2 == 0);
        even.then_some(Unit { scale, pi: self.pi / 2, dimension: self.dimension.map(|exponent| exponent / 2) })
    }
}

/// Reads a unit: names with SI prefixes and `1`, joined by `*`, `/`, `^` and parentheses, from left to right.
///
/// # Errors
/// What is wrong, with spans into `text` and an empty path.
pub fn parse_unit(text: &str) -> Result<Unit, Vec<Problem>> {
    let mut reader = Reader { tokens: tokens(text)?, at: 0, nesting: 0 };
    let unit = reader.product()?;
    match reader.peek().kind {
        Kind::End => Ok(unit),
        _ => Err(reader.wrong("`*`, `/` or the end")),
    }
}

struct Reader<'a> {
    tokens: Vec<Token<'a>>,
    at: usize,
    nesting: usize,
}

/// Parentheses inside each other.
const DEEPEST: usize = 20;

impl<'a> Reader<'a> {
    fn peek(&self) -> Token<'a> {
        self.tokens[self.at]
    }

    fn next(&mut self) -> Token<'a> {
        let token = self.peek();
        self.at = (self.at + 1).min(self.tokens.len() - 1);
        token
    }

    fn wrong(&self, expected: &str) -> Vec<Problem> {
        let token = self.peek();
        let place = token.span.place();
        vec![match token.kind {
            Kind::End => syntax::unexpected_end(place, expected),
            _ => syntax::bad_unit(place, shorten(token.text), expected),
        }]
    }

    fn product(&mut self) -> Result<Unit, Vec<Problem>> {
        let mut product = self.power()?;
        loop {
            let sign = self.peek();
            if !matches!(sign.kind, Kind::Star | Kind::Slash) {
                return Ok(product);
            }
            self.next();
            let mut factor = Some(self.power()?);
            if sign.kind == Kind::Slash {
                factor = factor.and_then(Unit::inverse);
            }
            product = factor.and_then(|factor| product.multiply(factor)).ok_or_else(|| too_large(sign))?;
        }
    }

    fn power(&mut self) -> Result<Unit, Vec<Problem>> {
        let base = self.atom()?;
        let sign = self.peek();
        if sign.kind != Kind::Caret {
            return Ok(base);
        }
        self.next();
        let exponent = self.exponent()?;
        base.power(exponent).ok_or_else(|| too_large(sign))
    }

    /// `2`, `-1`, `1.5`, `(-1)`, `(3/2)`, in halves.
    fn exponent(&mut self) -> Result<i8, Vec<Problem>> {
        let open = self.peek().kind == Kind::Open;
        if open {
            self.next();
        }
        let negative = self.peek().kind == Kind::Minus;
        if negative {
            self.next();
        }
        let number = self.peek();
        let halves = number.text.parse::<f64>().ok().map(|value| 2.0 * value);
        let halves = halves.filter(|halves| *halves <= 18.0 && halves.fract() == 0.0 && number.kind == Kind::Number);
        let Some(mut value) = halves.map(|halves| halves as i8) else {
            return Err(vec![syntax::unit_power(number.span.place(), shorten(number.text))]);
        };
        self.next();
        if open && self.peek().kind == Kind::Slash {
            self.next();
            let divisor = self.peek();
            if divisor.text != "2" || value % 2 != 0 {
                return Err(vec![syntax::unit_power(divisor.span.place(), shorten(divisor.text))]);
            }
            self.next();
            value /= 2;
        }
        if open {
            self.close()?;
        }
        Ok(if negative { -value } else { value })
    }

    fn close(&mut self) -> Result<(), Vec<Problem>> {
        if self.peek().kind != Kind::Close {
            return Err(self.wrong("`)`"));
        }
        self.next();
        Ok(())
    }

    fn atom(&mut self) -> Result<Unit, Vec<Problem>> {
        let token = self.peek();
        match token.kind {
            Kind::Number if token.text == "1" => {
                self.next();
                Ok(Unit::ONE)
            }
            Kind::Number => Err(self.wrong("a unit; the only number in a unit is `1`")),
            Kind::Name => {
                self.next();
                named(token.text).ok_or_else(|| {
                    vec![syntax::unknown_unit(token.span.place(), shorten(token.text), help(token.text))]
                })
            }
            Kind::Open if self.nesting < DEEPEST => {
                self.next();
                self.nesting += 1;
                let inner = self.product()?;
                self.nesting -= 1;
                self.close()?;
                Ok(inner)
            }
            _ => Err(self.wrong("a unit")),
        }
    }
}

fn too_large(at: Token<'_>) -> Vec<Problem> {
    vec![syntax::bad_unit(at.span.place(), at.text, "a unit within reach of exact numbers")]
}

/// Name, numerator and denominator of the factor to SI, power of π, exponents of kg, m, s, A, K, whether it takes prefixes.
type Row = (&'static str, i128, i128, i8, [i8; BASES], bool);

const UNITS: &[Row] = &[
    ("g", 1, 1000, 0, [1, 0, 0, 0, 0], true),
    ("m", 1, 1, 0, [0, 1, 0, 0, 0], true),
    ("s", 1, 1, 0, [0, 0, 1, 0, 0], true),
    ("rad", 1, 1, 0, [0, 0, 0, 0, 0], true),
    ("deg", 1, 180, 1, [0, 0, 0, 0, 0], false),
    ("N", 1, 1, 0, [1, 1, -2, 0, 0], true),
    ("J", 1, 1, 0, [1, 2, -2, 0, 0], true),
    ("W", 1, 1, 0, [1, 2, -3, 0, 0], true),
    ("Pa", 1, 1, 0, [1, -1, -2, 0, 0], true),
    ("Hz", 1, 1, 0, [0, 0, -1, 0, 0], true),
    ("min", 60, 1, 0, [0, 0, 1, 0, 0], false),
    ("h", 3600, 1, 0, [0, 0, 1, 0, 0], false),
    ("rpm", 1, 30, 1, [0, 0, -1, 0, 0], false),
    ("in", 254, 10_000, 0, [0, 1, 0, 0, 0], false),
    ("ft", 3048, 10_000, 0, [0, 1, 0, 0, 0], false),
    ("lb", 45_359_237, 100_000_000, 0, [1, 0, 0, 0, 0], false),
    ("lbf", 44_482_216_152_605, 10_000_000_000_000, 0, [1, 1, -2, 0, 0], false),
    ("A", 1, 1, 0, [0, 0, 0, 1, 0], true),
    ("K", 1, 1, 0, [0, 0, 0, 0, 1], true),
    ("V", 1, 1, 0, [1, 2, -3, -1, 0], true),
    ("ohm", 1, 1, 0, [1, 2, -3, -2, 0], true),
    // The Greek letter, and the sign that some keyboards have.
    ("Ω", 1, 1, 0, [1, 2, -3, -2, 0], true),
    ("\u{2126}", 1, 1, 0, [1, 2, -3, -2, 0], true),
    ("H", 1, 1, 0, [1, 2, -2, -2, 0], true),
    ("F", 1, 1, 0, [-1, -2, 4, 2, 0], true),
    ("C", 1, 1, 0, [0, 0, 1, 1, 0], true),
    ("Wb", 1, 1, 0, [1, 2, -2, -1, 0], true),
    ("T", 1, 1, 0, [1, 0, -2, -1, 0], true),
];

/// SI prefixes and their powers of ten.
const PREFIXES: &[(&str, i32)] = &[
    ("da", 1),
    ("h", 2),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
    ("P", 15),
    ("E", 18),
    ("Z", 21),
    ("Y", 24),
    ("R", 27),
    ("Q", 30),
    ("d", -1),
    ("c", -2),
    ("m", -3),
    ("u", -6),
    ("µ", -6),
    ("μ", -6),
    ("n", -9),
    ("p", -12),
    ("f", -15),
    ("a", -18),
    ("z", -21),
    ("y", -24),
    ("r", -27),
    ("q", -30),
];

fn named(name: &str) -> Option<Unit> {
    let row = |symbol: &str| UNITS.iter().find(|row| row.0 == symbol);
    if let Some(&(_, n, d, pi, dimension, _)) = row(name) {
        return Some(Unit { scale: Rational::new(n, d)?, pi, dimension: dimension.map(|exponent| 2 * exponent) });
    }
    PREFIXES.iter().find_map(|(prefix, power)| {
        let &(_, n, d, pi, dimension, prefixed) = row(name.strip_prefix(prefix)?)?;
        let ten = 10_i128.checked_pow(power.unsigned_abs())?;
        let scale = if *power > 0 { Rational::new(n * ten, d)? } else { Rational::new(n, d * ten)? };
        prefixed.then_some(Unit { scale, pi, dimension: dimension.map(|exponent| 2 * exponent) })
    })
}

fn help(name: &str) -> String {
    // With another zero it is no multiple of a unit.
    if ["degC", "celsius"].iter().any(|other| other.eq_ignore_ascii_case(name)) {
        return "temperatures are in kelvin: 20 degrees Celsius are `293.15 K`, a difference of 20 degrees is `20 K`"
            .to_owned();
    }
    if let Some((other, is)) = OTHERS.iter().find(|(other, _)| other.eq_ignore_ascii_case(name)) {
        return format!("1 {other} is {is}");
    }
    let meant = MEANT.iter().find(|(other, _)| other.eq_ignore_ascii_case(name)).map(|(_, unit)| *unit);
    let product = || product(name).map(|(first, second)| format!("{first}*{second}"));
    let near = || nearest(name, COMMON.iter().copied()).map(str::to_owned);
    match meant.map(str::to_owned).or_else(product).or_else(near) {
        Some(unit) => format!("did you mean `{unit}`?"),
        None => {
            "units are `kg m s rad N J W Pa Hz g A K V ohm H F C Wb T` with SI prefixes, `deg min h rpm in ft lb lbf`, and `1`"
                .to_owned()
        }
    }
}

/// Two units that are written without `*` between them: `Nm`, `Nmm`.
fn product(name: &str) -> Option<(&str, &str)> {
    let first = FACTORS.iter().filter_map(|first| Some((*first, name.strip_prefix(first)?)));
    let is_apart = |first: &str, second: &str| match (named(first), named(second)) {
        (Some(first), Some(second)) => first.dimension != second.dimension,
        _ => true,
    };
    first.into_iter().find(|(first, second)| COMMON.contains(second) && is_apart(first, second))
}

/// What products of units begin with.
const FACTORS: &[&str] = &["N", "kN", "J", "W", "kg", "A", "V", "lbf"];

/// Units that are none here, and what one of each is.
const OTHERS: &[(&str, &str)] = &[
    ("kgf", "9.80665 N"),
    ("kp", "9.80665 N"),
    ("dyn", "1e-5 N"),
    ("kip", "1000 lbf"),
    ("bar", "100 kPa"),
    ("mbar", "100 Pa"),
    ("atm", "101325 Pa"),
    ("erg", "1e-7 J"),
    ("cal", "4.184 J"),
    ("kWh", "3.6 MJ"),
    ("hp", "745.69987 W"),
    ("PS", "735.49875 W"),
    ("yd", "3 ft"),
    ("mi", "5280 ft"),
    ("mph", "0.44704 m/s"),
    ("knot", "1852 m/h"),
    ("slug", "14.593903 kg"),
    ("oz", "28.349523125 g"),
    ("rps", "60 rpm"),
];

/// Often written, and what is meant.
const MEANT: &[(&str, &str)] = &[
    ("sec", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("metre", "m"),
    ("meter", "m"),
    ("meters", "m"),
    ("newton", "N"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("Nm", "N*m"),
    ("Nms", "N*m*s"),
    // As a unit it would be taken for the time.
    ("t", "Mg"),
    ("ton", "Mg"),
    ("tonne", "Mg"),
    ("hour", "h"),
    ("hours", "h"),
    ("hr", "h"),
    ("minute", "min"),
    ("minutes", "min"),
    ("inch", "in"),
    ("foot", "ft"),
    ("feet", "ft"),
    ("lbs", "lb"),
    ("kgs", "kg"),
    ("gs", "g"),
    ("rads", "rad"),
    ("degs", "deg"),
    ("mins", "min"),
    ("kmh", "km/h"),
    ("kph", "km/h"),
    ("mps", "m/s"),
    ("psi", "lbf/in^2"),
    ("dps", "deg/s"),
    ("amp", "A"),
    ("ampere", "A"),
    ("volt", "V"),
    ("ohm", "ohm"),
    ("ohms", "ohm"),
    ("henry", "H"),
    ("farad", "F"),
    ("coulomb", "C"),
    ("tesla", "T"),
    ("kelvin", "K"),
];

const COMMON: &[&str] = &[
    "kg", "g", "m", "mm", "s", "ms", "min", "rad", "deg", "rpm", "N", "kN", "lbf", "J", "W", "Pa", "MPa", "Hz", "A",
    "K", "V", "ohm",
];

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(text: &str, n: i128, d: i128, dimension: [i8; 3]) {
        let found = parse_unit(text).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
        let [kg, m, s] = dimension.map(|exponent| 2 * exponent);
        let expected = Unit { scale: Rational::new(n, d).unwrap(), pi: 0, dimension: [kg, m, s, 0, 0] };
        assert_eq!(found, expected, "{text}");
    }

    #[test]
    fn electric_and_thermal_units_follow_from_ampere_and_kelvin() {
        // The SI brochure (2019), table 4.
        for (a, b) in [
            ("V", "W/A"),
            ("ohm", "V/A"),
            ("H", "V*s/A"),
            ("F", "C/V"),
            ("C", "A*s"),
            ("Wb", "V*s"),
            ("T", "Wb/m^2"),
            ("J", "V*A*s"),
            ("ohm*F", "s"),
            ("H/ohm", "s"),
            ("N*m/A", "V*s/rad"),
            ("kΩ", "kohm"),
            ("\u{2126}", "ohm"),
            ("mK", "K/1*m/m*mm/m"),
            ("uF", "µF"),
        ] {
            assert_eq!(parse_unit(a), parse_unit(b), "{a} {b}");
        }
        assert_eq!(parse_unit("K").unwrap().dimension, [0, 0, 0, 0, 2]);
        assert_eq!(parse_unit("mT").unwrap().scale, Rational::new(1, 1000).unwrap());
        for (text, meant) in [("Ohm", "ohm"), ("volt", "V"), ("Nms", "N*m*s"), ("Nmm", "N*mm")] {
            assert_eq!(parse_unit(text).unwrap_err()[0].help, format!("did you mean `{meant}`?"), "{text}");
        }
        for (text, is) in [("kgf", "1 kgf is 9.80665 N"), ("bar", "1 bar is 100 kPa"), ("KIP", "1 kip is 1000 lbf")] {
            assert_eq!(parse_unit(text).unwrap_err()[0].help, is);
        }
        for (other, is) in OTHERS {
            assert!(parse_unit(is.split_once(' ').expect("a number").1).is_ok(), "{other}");
        }
        for text in ["degC", "Celsius"] {
            assert!(parse_unit(text).unwrap_err()[0].help.contains("293.15 K"), "{text}");
        }
    }

    #[test]
    fn from_left_to_right() {
        unit("N/m*s", 1, 1, [1, 0, -1]);
        unit("N/(m*s)", 1, 1, [1, 0, -3]);
        unit("kg*m^2", 1, 1, [1, 2, 0]);
        unit("1/m", 1, 1, [0, -1, 0]);
        unit("m^-1", 1, 1, [0, -1, 0]);
        unit("m^(-1)", 1, 1, [0, -1, 0]);
        unit("1", 1, 1, [0, 0, 0]);
        unit("rad/s", 1, 1, [0, 0, -1]);
    }

    #[test]
    fn prefixes_are_exact() {
        unit("g", 1, 1000, [1, 0, 0]);
        unit("ms", 1, 1000, [0, 0, 1]);
        unit("mm^2", 1, 1_000_000, [0, 2, 0]);
        unit("MPa", 1_000_000, 1, [1, -1, -2]);
        unit("kN/mm", 1_000_000, 1, [1, 0, -2]);
        unit("cm", 1, 100, [0, 1, 0]);
        unit("µm", 1, 1_000_000, [0, 1, 0]);
        unit("dam", 10, 1, [0, 1, 0]);
        unit("Zg", 1_000_000_000_000_000_000, 1, [1, 0, 0]);
        unit("Qm", 1_000_000_000_000_000_000_000_000_000_000, 1, [0, 1, 0]);
        unit("ym", 1, 1_000_000_000_000_000_000_000_000, [0, 1, 0]);
    }

    #[test]
    fn units_beside_si_are_exact() {
        unit("km/h", 5, 18, [0, 1, -1]);
        unit("ft", 3048, 10_000, [0, 1, 0]);
        unit("lbf/in", 44_482_216_152_605 / 5, 10_000_000_000_000 / 5 * 254 / 10_000, [1, 0, -2]);
        unit("lb/min", 45_359_237, 6_000_000_000, [1, 0, -1]);
        let rpm = parse_unit("rpm").unwrap();
        assert!((rpm.factor().to_f64() - std::f64::consts::TAU / 60.0).abs() < 1e-16);
        assert_eq!(rpm.dimension, parse_unit("rad/s").unwrap().dimension);
        for (text, meant) in [("t", "Mg"), ("hours", "h"), ("kmh", "km/h"), ("kmin", "min")] {
            assert_eq!(parse_unit(text).unwrap_err()[0].help, format!("did you mean `{meant}`?"), "{text}");
        }
        for text in ["degC", "Celsius"] {
            assert!(parse_unit(text).unwrap_err()[0].help.contains("293.15 K"), "{text}");
        }
    }

    #[test]
    fn exponents_may_be_halves() {
        for text in ["N/m^1.5", "N/m^(3/2)", "N*m^-1.5", "N*m^(-3/2)"] {
            let found = parse_unit(text).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
            assert_eq!((found.scale, found.dimension), (Rational::ONE, [2, -1, -4, 0, 0]), "{text}");
        }
        assert_eq!(parse_unit("kN/m^(4/2)"), parse_unit("kN/m^2"));
        assert_eq!(parse_unit("(km*m)^0.5").unwrap_err()[0].code, "E120");
        assert_eq!(parse_unit("(km/mm)^0.5").unwrap().scale, Rational::new(1000, 1).unwrap());
    }

    #[test]
    fn degrees_carry_pi() {
        let degrees = parse_unit("deg").unwrap();
        assert_eq!((degrees.pi, degrees.scale), (1, Rational::new(1, 180).unwrap()));
        assert_eq!(parse_unit("deg/s").unwrap().dimension, [0, 0, -2, 0, 0]);
        assert!((parse_unit("1/deg").unwrap().factor().to_f64() - 57.295_779_513_082_32).abs() < 1e-13);
    }

    #[test]
    fn refuses_the_rest() {
        for (text, code) in [
            ("", "E103"),
            ("furlong", "E119"),
            ("kkg", "E119"),
            ("N m", "E120"),
            ("m^0.3", "E121"),
            ("m^(3/4)", "E121"),
            ("mm^1.5", "E120"),
            ("m^n", "E121"),
            ("m^99", "E121"),
            ("2", "E120"),
            ("(m", "E103"),
            ("m/", "E103"),
            ("kdeg", "E119"),
        ] {
            assert_eq!(parse_unit(text).unwrap_err()[0].code, code, "{text}");
        }
        assert_eq!(parse_unit("sec").unwrap_err()[0].help, "did you mean `s`?");
        assert_eq!(parse_unit("Kg").unwrap_err()[0].help, "did you mean `kg`?");
        let long = vec!["Em^9"; 40].join("*");
        assert!(parse_unit(&long).is_err());
    }
}
