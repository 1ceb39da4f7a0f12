//! Numbers for people.

/// Six significant digits, without zeros at the end: `2.42030`, `0.5`, `1.2e-7`.
///
/// ```
/// assert_eq!(dalembert::linear::short(2.0_f64.sqrt()), "1.41421");
/// assert_eq!(dalembert::linear::short(0.499_999_999_99), "0.5");
/// ```
pub fn short(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return if x == 0.0 { "0".to_owned() } else { x.to_string() };
    }
    let scientific = format!("{x:.5e}");
    let Some((digits, exponent)) = scientific.split_once('e') else { return scientific };
    let trim = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    match exponent.parse::<i32>() {
        Ok(exponent @ -4..=6) => trim(&format!("{x:.*}", (5 - exponent).max(0) as usize)),
        _ => format!("{}e{exponent}", trim(digits)),
    }
}

/// As [`short`] with the digits that an uncertainty, a part of the number, leaves: `?` where it leaves none.
///
/// ```
/// assert_eq!(dalembert::linear::short_within(5_479_416.2, 4e-3), "5.5e6");
/// assert_eq!(dalembert::linear::short_within(2.0_f64.sqrt(), 1e-16), "1.41421");
/// ```
pub fn short_within(x: f64, uncertainty: f64) -> String {
    /// [`short`] prints so many.
    const DIGITS: f64 = 6.0;
    let digits = (-uncertainty.log10()).floor();
    match digits {
        digits if digits >= DIGITS || x == 0.0 || !x.is_finite() => short(x),
        digits if digits >= 1.0 => {
            let text = format!("{x:.*e}", digits as usize - 1);
            // Zeros in front of the point would look like digits.
            if x.abs() >= 10.0_f64.powf(digits) { text } else { text.parse().map_or(text, short) }
        }
        _ => "?".to_owned(),
    }
}

/// As [`short`], with 0 for what is rounding beside a scale.
///
/// ```
/// assert_eq!(dalembert::linear::short_beside(-3e-17, 1.0), "0");
/// ```
pub fn short_beside(x: f64, scale: f64) -> String {
    if x.abs() <= 1e-12 * scale.abs() { "0".to_owned() } else { short(x) }
}

/// How many there are of something, by its name in the singular: `1 step`, `2 steps`.
pub(crate) fn counted(count: usize, one: &str) -> String {
    if count == 1 { format!("1 {one}") } else { format!("{count} {one}s") }
}

/// ` m`: a unit behind a number; nothing for a pure number and where there is no unit.
pub(crate) fn spaced(unit: &str) -> String {
    if matches!(unit, "" | "1") { String::new() } else { format!(" {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_no_plural() {
        assert_eq!([0, 1, 2].map(|count| counted(count, "step")), ["0 steps", "1 step", "2 steps"]);
    }

    #[test]
    fn numbers_are_short_and_lose_nothing_that_matters() {
        let cases = [
            (1.0, "1"),
            (0.999_999_999_999_999_9, "1"),
            (-0.0, "0"),
            (123_456.7, "123457"),
            (1e9, "1e9"),
            (0.000_1, "0.0001"),
            (-2.5e-7, "-2.5e-7"),
            (1_000_000.0, "1000000"),
            (f64::INFINITY, "inf"),
        ];
        for (x, text) in cases {
            assert_eq!(short(x), text);
        }
        assert_eq!(short_beside(1e-13, 0.5), "0");
        assert_eq!(short_beside(1e-13, 1e-10), "1e-13");
    }
}
