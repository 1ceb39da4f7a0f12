//! Where the marks of an axis stand, and what is written beside them.

use super::lettering;

/// Names are shortened to this before one is left out, and stand so far apart, in parts of their size.
const LONGEST: f64 = 6.0;
const APART: f64 = 0.8;
/// What is written at marks of a linear axis is no wider than this, in parts of its size: so much room there is to the left of a chart.
const WIDEST: f64 = 6.0;
/// The first and the last stand about marks near the edges of a page: so much room there is about these, and for each of the whole.
const EDGE: (f64, f64) = (2.6, 0.09);

/// Positions of the labelled marks and of the lines between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Ticks {
    pub major: Vec<f64>,
    pub minor: Vec<f64>,
    /// What is taken away from what is written at the marks, ` − 12.5`; empty where nothing is.
    pub origin: String,
    labels: Vec<String>,
}

impl Ticks {
    /// Multiples of 1, 2 or 5 times a power of ten in `low..=high`, or of `step` times a power of two, about `count` of
    /// them.
    pub fn linear(low: f64, high: f64, count: usize, step: Option<f64>) -> Ticks {
        let least = (high - low) / count.max(1) as f64;
        let doubled = |step: f64| step * (least / step).log2().ceil().max(0.0).exp2();
        let slack = 1e-6;
        let ends = |step: f64| ((low / step - slack).ceil(), (high / step + slack).floor());
        // One mark alone tells no scale.
        let finer = |step: f64| if ends(step).1 > ends(step).0 { step } else { round_step(0.4 * step) };
        let step = step.filter(|step| *step > 0.0).map_or_else(|| finer(finer(round_step(least))), doubled);
        let (first, last) = ends(step);
        let count = (last - first).clamp(0.0, 100.0) as usize;
        let major: Vec<f64> = (0..=count).map(|i| (first + i as f64) * step).collect();
        let labels = linear_labels(&major, step);
        let nearest = major.iter().fold(f64::INFINITY, |a: f64, x| a.min(x.abs()));
        if nearest <= high - low || labels.iter().all(|label| lettering::width(label) <= WIDEST) {
            return Ticks { major, labels, ..Ticks::default() };
        }
        // From the roundest of them the others are counted, in whole steps.
        let text = |i: usize| origin((first + i as f64) * step, step);
        let roundest = (0..=count).min_by_key(|i| text(*i).len()).unwrap_or(0);
        let counted: Vec<f64> = (0..=count).map(|i| (i as f64 - roundest as f64) * step).collect();
        Ticks { labels: linear_labels(&counted, step), origin: text(roundest), major, minor: Vec::new() }
    }

    /// These names at 1, 2, 3 …, thinned and shortened so that they fit into this room, in parts of their size.
    pub fn named(names: &[String], room: f64) -> Ticks {
        let own = room / names.len().max(1) as f64;
        let longest = names.iter().map(|name| lettering::width(name)).fold(0.0, f64::max);
        let stride = ((longest.min(LONGEST) + APART) / own).ceil().max(1.0) as usize;
        let most = (own * stride as f64 - APART).min(EDGE.0 + EDGE.1 * room);
        let places = (0..names.len()).step_by(stride);
        Ticks {
            major: places.clone().map(|place| place as f64 + 1.0).collect(),
            labels: places.map(|place| lettering::fitted(&names[place], most)).collect(),
            ..Ticks::default()
        }
    }

    /// Powers of ten in `low..=high`, thinned to about `count`; over less than two decades also 2 and 5 times them.
    pub fn log(low: f64, high: f64, count: usize) -> Ticks {
        let slack = 1e-9;
        let (first, last) = ((low.log10() - slack).ceil() as i32, (high.log10() + slack).floor() as i32);
        let inside = |x: &f64| (low * (1.0 - slack)..=high * (1.0 + slack)).contains(x);
        let multiples = |digits: &[f64]| -> Vec<f64> {
            let all = (first - 1..=last).flat_map(|k| digits.iter().map(move |d| power(*d, k)));
            all.filter(inside).collect()
        };
        let decades = high.log10() - low.log10();
        if decades < 0.5 {
            return Ticks::linear(low, high, count, None);
        }
        let stride = (decades / count.max(1) as f64).ceil().max(1.0) as i32;
        let major = if decades < 2.0 {
            multiples(&[1.0, 2.0, 5.0])
        } else {
            (first..=last).filter(|k| k.rem_euclid(stride) == 0).map(|k| power(1.0, k)).collect()
        };
        let minor = if stride > 1 {
            (first..=last).map(|k| power(1.0, k)).collect()
        } else if decades < 6.0 {
            multiples(&[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0])
        } else {
            Vec::new()
        };
        let plain = major.iter().all(|x| (0.009..1001.0).contains(x));
        let labels = major.iter().map(|x| if plain { format!("{x}") } else { log_label(*x) }).collect();
        Ticks { major, minor, labels, origin: String::new() }
    }

    /// What is written at a major tick.
    pub fn label(&self, value: f64) -> &str {
        let place = self.major.iter().position(|x| *x == value);
        place.map_or("", |place| &self.labels[place])
    }
}

/// d·10^k, with one rounding where 10^k is exact.
fn power(d: f64, k: i32) -> f64 {
    if k < 0 && k > -300 { d / 10f64.powi(-k) } else { d * 10f64.powi(k) }
}

/// 1, 2 or 5 times a power of ten, the next one that is no smaller.
pub(super) fn round_step(raw: f64) -> f64 {
    let decade = raw.log10().floor() as i32;
    [1.0, 2.0, 5.0, 10.0].map(|d| power(d, decade)).into_iter().find(|step| *step >= raw * 0.999).unwrap_or(raw)
}

/// What is written at marks of a linear axis.
fn linear_labels(marks: &[f64], step: f64) -> Vec<String> {
    let largest = marks.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
    marks.iter().map(|x| linear_label(*x, step, largest)).collect()
}

/// ` − 12.5` for what is counted from 12.5, a multiple of a step.
fn origin(value: f64, step: f64) -> String {
    let decimals = (-(step.log10() + 1e-9).floor()).max(0.0) as usize;
    let exact = format!("{:.decimals$}", value.abs());
    let short = if decimals > 0 { exact.trim_end_matches('0').trim_end_matches('.') } else { &exact };
    format!(" {} {short}", if value < 0.0 { '+' } else { '−' })
}

fn linear_label(value: f64, step: f64, largest: f64) -> String {
    let step_exponent = (step.log10() + 1e-9).floor() as i32;
    let exponent = (largest.log10() + 1e-9).floor() as i32;
    if value == 0.0 {
        "0".to_owned()
    } else if (-4..=4).contains(&exponent) && step_exponent >= -5 {
        format!("{value:.*}", (-step_exponent).max(0) as usize).replace('-', "−")
    } else {
        let digits = (exponent - step_exponent).max(0) as usize;
        format!("{:.*}·10{}", digits, value / 10f64.powi(exponent), superscript(exponent)).replace('-', "−")
    }
}

fn log_label(value: f64) -> String {
    let exponent = (value.log10() + 1e-9).floor() as i32;
    let digit = (value / 10f64.powi(exponent)).round();
    match (digit as i32, exponent) {
        (digit, 0) => format!("{digit}"),
        (digit, 1) => format!("{digit}0"),
        (1, _) => format!("10{}", superscript(exponent)),
        (digit, _) => format!("{digit}·10{}", superscript(exponent)),
    }
}

fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| c.to_digit(10).map_or('⁻', |d| DIGITS[d as usize]);
    exponent.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ticks: &Ticks) -> Vec<&str> {
        ticks.major.iter().map(|x| ticks.label(*x)).collect()
    }

    #[test]
    fn linear_ticks_are_round() {
        assert_eq!(labels(&Ticks::linear(0.0, 10.0, 5, None)), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels(&Ticks::linear(-190.0, 10.0, 5, Some(45.0))), ["−180", "−135", "−90", "−45", "0"]);
        assert_eq!(labels(&Ticks::linear(-500.0, 0.0, 5, Some(45.0))), ["−360", "−180", "0"]);
        assert_eq!(labels(&Ticks::linear(-0.13, 0.11, 5, None)), ["−0.10", "−0.05", "0", "0.05", "0.10"]);
        assert_eq!(labels(&Ticks::linear(1e6, 3e6, 2, None)), ["1·10⁶", "2·10⁶", "3·10⁶"]);
        assert_eq!(
            labels(&Ticks::linear(0.0, 2.5e-9, 5, None)),
            ["0", "0.5·10⁻⁹", "1.0·10⁻⁹", "1.5·10⁻⁹", "2.0·10⁻⁹", "2.5·10⁻⁹"]
        );
    }

    #[test]
    fn log_ticks_are_powers_of_ten() {
        let ticks = Ticks::log(3e-5, 2.0, 8);
        assert_eq!(ticks.major, [1e-4, 1e-3, 1e-2, 1e-1, 1.0]);
        assert_eq!(labels(&ticks), ["10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "1"]);
        assert!(ticks.minor.contains(&4e-5) && ticks.minor.contains(&2.0));
    }

    #[test]
    fn no_mark_stands_alone() {
        assert_eq!(labels(&Ticks::linear(-0.36, 0.49, 3, None)), ["−0.2", "0", "0.2", "0.4"]);
        assert_eq!(labels(&Ticks::linear(-0.9, 0.9, 1, None)), ["−0.5", "0", "0.5"]);
    }

    #[test]
    fn names_stand_at_their_numbers() {
        let names = |count: usize| (1..=count).map(|i| format!("x[{i}]")).collect::<Vec<_>>();
        let ticks = Ticks::named(&names(3), 60.0);
        assert_eq!(
            (ticks.major.as_slice(), labels(&ticks)),
            ([1.0, 2.0, 3.0].as_slice(), vec!["x[1]", "x[2]", "x[3]"])
        );
        assert_eq!(labels(&Ticks::named(&names(10), 12.0)), ["x[1]", "x[4]", "x[7]", "x[10]"]);
        let long = Ticks::named(&["the_angle_of_the_front_wheel".to_owned(), "x".to_owned()], 15.0);
        assert!(labels(&long)[0].ends_with("el") && labels(&long)[1] == "x", "{long:?}");
        assert!(Ticks::named(&names(0), 8.0).major.is_empty());
    }

    #[test]
    fn many_decades_are_thinned() {
        let ticks = Ticks::log(1e-16, 1.0, 6);
        assert_eq!(labels(&ticks), ["10⁻¹⁵", "10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "1"]);
        assert_eq!(ticks.minor.len(), 17);
    }

    #[test]
    fn one_decade_has_ticks_between() {
        assert_eq!(labels(&Ticks::log(8.0, 120.0, 6)), ["10", "20", "50", "100"]);
        assert_eq!(labels(&Ticks::log(0.04, 0.4, 6)), ["0.05", "0.1", "0.2"]);
        assert_eq!(labels(&Ticks::log(4e4, 4e5, 6)), ["5·10⁴", "10⁵", "2·10⁵"]);
    }

    #[test]
    fn ticks_stay_inside() {
        for (low, high) in [(0.0, 1.0), (-3.7, 12.9), (1e-300, 1e300), (1.0 - 1e-7, 1.0 + 1e-7), (-1e12, 3.0)] {
            let ticks = Ticks::linear(low, high, 6, None);
            let slack = (high - low) * 1e-5;
            assert!((2..=14).contains(&ticks.major.len()), "{ticks:?}");
            assert!(ticks.major.iter().all(|x| (low - slack..=high + slack).contains(x)), "{ticks:?}");
        }
    }
}
