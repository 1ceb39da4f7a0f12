//! The unit that a number in SI has.

use crate::language::{BASES, parse_unit};

/// Units without a prefix that are SI, for each run of letters in a unit.
const COHERENT: [&str; 19] =
    ["kg", "m", "s", "rad", "N", "J", "W", "Pa", "Hz", "A", "K", "V", "ohm", "Ω", "H", "F", "C", "Wb", "T"];

/// Units beside SI, with those in which their numbers are told.
const BESIDE: [(&str, &str); 7] =
    [("min", "s"), ("h", "s"), ("in", "m"), ("ft", "m"), ("lb", "kg"), ("lbf", "N"), ("rpm", "rad/s")];

/// A unit as the file writes it, for a number that is in SI: `N/mm` becomes `N/m`, `deg` `rad`, `g` `kg`.
pub fn si_unit(written: &str) -> String {
    let coherent = |text: &str| parse_unit(text).is_ok_and(|unit| unit.factor().to_f64() == 1.0);
    if coherent(written) {
        return written.to_owned();
    }
    let mut text = String::new();
    let mut name = String::new();
    for c in written.chars().chain([' ']) {
        if c.is_alphabetic() {
            name.push(c);
            continue;
        }
        text.push_str(&without_prefix(&name));
        name.clear();
        text.push(c);
    }
    let text = text.trim_end().to_owned();
    let same =
        |a: &str, b: &str| matches!((parse_unit(a), parse_unit(b)), (Ok(a), Ok(b)) if a.dimension == b.dimension);
    if coherent(&text) && same(&text, written) {
        return text;
    }
    // A number in the unit (`60 s`): its dimension says it all.
    parse_unit(written).map_or_else(|_| written.to_owned(), |unit| by_dimension(unit.dimension))
}

fn without_prefix(name: &str) -> String {
    let Ok(unit) = parse_unit(name) else { return name.to_owned() };
    if unit.factor().to_f64() == 1.0 {
        return name.to_owned();
    }
    if let Some((_, base)) = BESIDE.iter().find(|(other, _)| *other == name) {
        return (*base).to_owned();
    }
    let fits = |base: &&&str| {
        parse_unit(base).is_ok_and(|known| known.dimension == unit.dimension)
            && (name.ends_with(**base) || name.ends_with('g') || unit.dimension == [0; BASES])
    };
    COHERENT.iter().find(fits).map_or_else(|| name.to_owned(), |base| (*base).to_owned())
}

fn by_dimension(dimension: [i8; BASES]) -> String {
    let side = |sign: i8| {
        let powers =
            ["kg", "m", "s", "A", "K"].into_iter().zip(dimension).filter(move |(_, exponent)| exponent * sign > 0);
        powers.map(|(name, halves)| match halves.abs() {
            2 => name.to_owned(),
            n => format!("{name}^{}", 0.5 * f64::from(n)),
        })
    };
    let above: Vec<String> = side(1).collect();
    let above = if above.is_empty() { "1".to_owned() } else { above.join("*") };
    side(-1).fold(above, |text, below| format!("{text}/{below}"))
}

#[cfg(test)]
mod tests {
    use super::si_unit;

    #[test]
    fn prefixes_go_and_coherent_units_stay() {
        let cases = [
            ("N/mm", "N/m"),
            ("mm", "m"),
            ("g", "kg"),
            ("deg", "rad"),
            ("kN*ms/mm", "N*s/m"),
            ("kg*m^2", "kg*m^2"),
            ("m/s^2", "m/s^2"),
            ("mm^2", "m^2"),
            ("1", "1"),
            ("kHz", "Hz"),
            ("MPa", "Pa"),
            ("deg/s", "rad/s"),
            ("1/ms", "1/s"),
            ("mJ", "J"),
            ("km/h", "m/s"),
            ("lbf/in", "N/m"),
            ("rpm", "rad/s"),
            ("1/rpm", "s"),
            ("N/ft^2", "N/m^2"),
            ("kN/m^1.5", "N/m^1.5"),
            ("mA", "A"),
            ("kohm", "ohm"),
            ("kΩ", "Ω"),
            ("mH", "H"),
            ("uF", "F"),
        ];
        for (written, si) in cases {
            assert_eq!(si_unit(written), si, "{written}");
        }
    }
}
