//! Numbers, angles and directions as a person writes them.

use super::inertia::CLOSE;

/// A number as the file that is written has it: the fewest digits that give it again.
pub fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-4..1e7).contains(&size) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// An angle: a multiple of π/12 where it is one to ten decimals.
pub fn angle(value: f64) -> String {
    let Some((turns, parts)) = part_of_pi(value, CLOSE) else { return number(value) };
    let sign = if turns < 0.0 { "-" } else { "" };
    let times = if turns.abs() == 1.0 { String::new() } else { format!("{}*", turns.abs()) };
    let over = if parts == 1.0 { String::new() } else { format!("/{parts}") };
    format!("{sign}{times}pi{over}")
}

/// Whether an angle was meant to be a part of π but has too few digits for it: by less than a milliradian.
pub fn nearly_part_of_pi(value: f64) -> Option<String> {
    /// Three digits of a radian, as many as an angle in degrees has.
    const FEW: f64 = 1e-3;
    let (turns, parts) = part_of_pi(value, FEW).filter(|_| part_of_pi(value, CLOSE).is_none())?;
    Some(angle(turns * std::f64::consts::PI / parts))
}

/// k and d of k π/d, where that is not 0.
fn part_of_pi(value: f64, within: f64) -> Option<(f64, f64)> {
    /// π/24 is 7.5 degrees: finer parts are written by nobody.
    const LARGEST: f64 = 24.0;
    [1.0, 2.0, 3.0, 4.0, 6.0, 12.0].into_iter().find_map(|parts| {
        let turns = (value * parts / std::f64::consts::PI).round();
        let close = (value - turns * std::f64::consts::PI / parts).abs() <= within;
        (turns != 0.0 && turns.abs() <= LARGEST && close).then_some((turns, parts))
    })
}

/// An axis of a frame with its sign, where a direction is one: 0, 1, 2 for x, y, z.
pub fn single(axis: [f64; 3]) -> Option<(usize, bool)> {
    let mut parts = (0..3).filter(|k| axis[*k] != 0.0);
    let first = parts.next()?;
    parts.next().is_none().then_some((first, axis[first] < 0.0))
}

pub const NAMES: [&str; 3] = ["x", "y", "z"];

/// A direction of length 1 fixed in a frame: `F.z`, `-F.z`, `(0.6*F.x + 0.8*F.z)/sqrt(0.6^2 + 0.8^2)`.
pub fn direction(frame: &str, axis: [f64; 3]) -> String {
    if let Some((k, negative)) = single(axis) {
        return format!("{}{frame}.{}", if negative { "-" } else { "" }, NAMES[k]);
    }
    let parts = (0..3).filter(|k| axis[*k] != 0.0);
    let squares: Vec<String> = parts.clone().map(|k| format!("{}^2", number(axis[k].abs()))).collect();
    let terms = parts.map(|k| (number(axis[k].abs()), k, axis[k] < 0.0));
    let mut sum = String::new();
    for (size, k, negative) in terms {
        let sign = match (sum.is_empty(), negative) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        let size = if size == "1" { String::new() } else { format!("{size}*") };
        sum += &format!("{sign}{size}{frame}.{}", NAMES[k]);
    }
    format!("({sum})/sqrt({})", squares.join(" + "))
}

/// A summand of a position: ` + q*F.z`.
pub fn along(amount: &str, frame: &str, axis: [f64; 3]) -> String {
    let direction = direction(frame, axis);
    match direction.strip_prefix('-') {
        Some(positive) => format!(" - {amount}*{positive}"),
        None => format!(" + {amount}*{direction}"),
    }
}

/// The turns of `rpy` about axes as turned already: z, y, x.
pub fn turns(rpy: [f64; 3]) -> Vec<String> {
    [2, 1, 0].into_iter().filter(|k| rpy[*k] != 0.0).map(|k| format!("[{}, {}]", NAMES[k], angle(rpy[k]))).collect()
}

/// A turn about the axis of a joint.
pub fn turn(axis: [f64; 3], by: &str) -> String {
    match single(axis) {
        Some((k, negative)) => format!("[{}, {}{by}]", NAMES[k], if negative { "-" } else { "" }),
        None => format!("[\"[{}]\", {by}]", axis.map(number).join(", ")),
    }
}

/// A frame's entry: from another one, or the ground.
pub fn frame(from: &str, turns: &[String]) -> String {
    let from = if from == "ground" { String::new() } else { format!("from: {from}, ") };
    match turns {
        [one] => format!("{{{from}rotate: {one}}}"),
        several => format!("{{{from}rotate: [{}]}}", several.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_parts_of_pi_only_to_ten_decimals() {
        let read = |text: &str| text.parse::<f64>().expect("a number");
        let cases = [
            ("1.5707963267948966", "pi/2"),
            ("-3.1415926536", "-pi"),
            ("0.7853981634", "pi/4"),
            ("-2.356194490192345", "-3*pi/4"),
            ("1.5708", "1.5708"),
            ("0", "0"),
        ];
        for (written, text) in cases {
            assert_eq!(angle(read(written)), text);
        }
        assert_eq!(nearly_part_of_pi(read("1.5708")).as_deref(), Some("pi/2"));
        assert_eq!(nearly_part_of_pi(1.6), None);
    }

    #[test]
    fn directions() {
        assert_eq!(direction("F", [0.0, 0.0, -2.0]), "-F.z");
        assert_eq!(direction("F", [0.6, 0.0, -0.8]), "(0.6*F.x - 0.8*F.z)/sqrt(0.6^2 + 0.8^2)");
        assert_eq!(along("q", "F", [0.0, -1.0, 0.0]), " - q*F.y");
        assert_eq!(turn([0.0, 0.0, -1.0], "q"), "[z, -q]");
        assert_eq!(turn([0.0, 1.0, 1.0], "q"), "[\"[0, 1, 1]\", q]");
        assert_eq!(number(2.3e-5), "2.3e-5");
    }
}
