//! Axes: what they show, and where on the page.

use super::ticks::Ticks;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use std::ops::Range;

/// How values are laid along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// In proportion.
    #[default]
    Linear,
    /// In proportion to the logarithm; values ≤ 0 have no place and are left out.
    Log,
}

/// One axis of a chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// What the axis shows, `time`.
    pub label: String,
    /// Its unit, `s`; empty when there is none.
    pub unit: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Ends; `None` (the default) fits the data.
    pub range: Option<(f64, f64)>,
    /// Distance of the marks of a linear axis, where they are not too many; `None` (the default) chooses a round one.
    pub step: Option<f64>,
    /// Values fall to the right, or upwards: errors that become digits.
    pub reversed: bool,
    /// What is written at 1, 2, 3 … instead of numbers; as many as there is room for.
    pub names: Vec<String>,
}

impl Axis {
    /// A linear axis that fits its data.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Axis {
        Axis { label: label.into(), unit: unit.into(), ..Axis::default() }
    }

    /// The same axis with a logarithmic scale.
    pub fn log(self) -> Axis {
        Axis { scale: Scale::Log, ..self }
    }

    /// The same axis with values that fall to the right, or upwards.
    pub fn reversed(self) -> Axis {
        Axis { reversed: true, ..self }
    }

    /// The same axis with a mark at multiples of this, twice this, four times this …, as many as fit.
    pub fn every(self, step: f64) -> Axis {
        Axis { step: Some(step), ..self }
    }

    /// The same axis with these names at 1, 2, 3 … instead of numbers.
    pub fn named(self, names: impl IntoIterator<Item = impl Into<String>>) -> Axis {
        Axis { names: names.into_iter().map(Into::into).collect(), ..self }
    }

    /// `time (s)`.
    pub(super) fn text(&self) -> String {
        self.text_from("")
    }

    /// `y + 0.981 (m)` where what is written at the marks is counted from −0.981.
    fn text_from(&self, origin: &str) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) };
        format!("{}{origin}{unit}", self.label)
    }

    /// True when a value has a place on an axis of this scale.
    pub(super) fn has(&self, value: f64) -> bool {
        value.is_finite() && (self.scale == Scale::Linear || value > 0.0)
    }
}

/// An axis with known ends, as plotters wants it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Extent {
    scale: Scale,
    low: f64,
    high: f64,
    /// All values are the same: the ends are a mere guess.
    flat: bool,
    step: Option<f64>,
    reversed: bool,
    names: Vec<String>,
    ticks: Ticks,
}

impl Extent {
    /// Fits an axis to its data, with a margin of `pad` of the range on both sides.
    pub fn fit(axis: &Axis, values: impl Iterator<Item = f64>, pad: f64) -> Extent {
        let found = ends(axis.scale, values.filter(|x| axis.has(*x)).collect());
        let given = axis.range.filter(|(low, high)| axis.has(*low) && axis.has(*high) && low < high);
        let (low, high) = given.unwrap_or_else(|| padded(axis.scale, found, pad));
        let flat = given.is_none() && found.is_none_or(|(low, high)| low == high);
        let Axis { scale, step, reversed, .. } = *axis;
        Extent { scale, low, high, flat, step, reversed, names: axis.names.clone(), ticks: Ticks::default() }
    }

    /// Gives an axis whose values are all the same a fifth of the other's range.
    pub fn narrow(x: &mut Extent, y: &mut Extent) {
        let (flat, other) = match (x.flat, y.flat) {
            (true, false) => (x, y.high - y.low),
            (false, true) => (y, x.high - x.low),
            _ => return,
        };
        let centre = (flat.low + flat.high) / 2.0;
        (flat.low, flat.high) = (centre - 0.1 * other, centre + 0.1 * other);
    }

    /// The same axis with about this many marks, or with names in this room, in parts of their size.
    pub fn with_ticks(mut self, count: usize, room: f64) -> Extent {
        self.ticks = match self.scale {
            _ if !self.names.is_empty() => Ticks::named(&self.names, room),
            Scale::Linear => Ticks::linear(self.low, self.high, count, self.step),
            Scale::Log => Ticks::log(self.low, self.high, count),
        };
        self
    }

    /// What is written at a mark.
    pub fn label(&self, value: f64) -> String {
        self.ticks.label(value).to_owned()
    }

    /// Stretches two linear axes about their centres so that one unit takes as many pixels on both.
    pub fn make_equal(x: &mut Extent, y: &mut Extent, width: f64, height: f64) {
        let unit = ((x.high - x.low) / width).max((y.high - y.low) / height);
        for (axis, pixels) in [(x, width), (y, height)] {
            let (centre, half) = ((axis.low + axis.high) / 2.0, unit * pixels / 2.0);
            (axis.low, axis.high) = (centre - half, centre + half);
        }
    }

    /// What is written beside the axis that this is the extent of.
    pub fn text(&self, axis: &Axis) -> String {
        axis.text_from(&self.ticks.origin)
    }

    /// Distance between the ends.
    pub fn span(&self) -> f64 {
        self.high - self.low
    }

    /// The value at a fraction of the axis.
    pub fn at(&self, fraction: f64) -> f64 {
        match self.scale {
            Scale::Linear => self.low + fraction * (self.high - self.low),
            Scale::Log => (self.low.ln() + fraction * (self.high.ln() - self.low.ln())).exp(),
        }
    }

    /// True for a linear axis with 0 inside.
    pub fn crosses_zero(&self) -> bool {
        self.scale == Scale::Linear && self.low < 0.0 && self.high > 0.0
    }

    /// True when the value is between the ends.
    pub fn contains(&self, value: f64) -> bool {
        let slack = 1e-9 * (self.high - self.low);
        (self.low - slack..=self.high + slack).contains(&value)
    }

    /// Where a value lies: 0 at the lower end, 1 at the upper one.
    pub fn fraction(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log => (value.ln() - self.low.ln()) / (self.high.ln() - self.low.ln()),
        }
    }
}

/// A linear axis on which the middle of the data takes less than this part of the whole shows nothing of it: less than a thousandth of
/// a pixel.
const UNSEEN: f64 = 1e-6;
/// The part of the data at either end that may be left out then.
const TAIL: f64 = 0.01;

/// The ends of the data; on a linear axis without a few points at a pole, beside which all others would be a straight line.
fn ends(scale: Scale, mut values: Vec<f64>) -> Option<(f64, f64)> {
    values.sort_by(f64::total_cmp);
    let (low, high) = (*values.first()?, *values.last()?);
    let tail = (values.len() as f64 * TAIL) as usize;
    let (from, to) = (values[tail], values[values.len() - 1 - tail]);
    let width = to - from;
    if scale == Scale::Log || width <= 0.0 || width >= UNSEEN * (high - low) {
        return Some((low, high));
    }
    // As far again on either side as the middle is wide.
    let near = values.into_iter().filter(|x| (from - width..=to + width).contains(x));
    near.fold(None, |ends: Option<(f64, f64)>, x| Some(ends.map_or((x, x), |(low, high)| (low.min(x), high.max(x)))))
}

/// Ends with a margin; a range of no width gets one.
fn padded(scale: Scale, ends: Option<(f64, f64)>, pad: f64) -> (f64, f64) {
    match (scale, ends) {
        (Scale::Linear, None) => (0.0, 1.0),
        (Scale::Log, None) => (0.1, 10.0),
        (Scale::Linear, Some((low, high))) => {
            let (low, high) = (low.max(-1e300), high.min(1e300));
            let least = 1e-9 * low.abs().max(high.abs());
            let centre = (low + high) / 2.0;
            let half = match high - low {
                width if width > least => width * (0.5 + pad),
                _ if centre == 0.0 => 1.0,
                _ => 0.1 * centre.abs(),
            };
            (centre - half, centre + half)
        }
        (Scale::Log, Some((low, high))) => {
            let width = high.ln() - low.ln();
            let factor = if width < 0.01 { 3.0 } else { (width * pad).exp().clamp(1.05, 10.0) };
            ((low / factor).max(1e-300), (high * factor).min(1e300))
        }
    }
}

impl Ranged for Extent {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (start, end): (i32, i32)) -> i32 {
        let fraction = self.fraction(*value).clamp(-1.0, 2.0);
        let fraction = if self.reversed { 1.0 - fraction } else { fraction };
        start + (fraction * f64::from(end - start)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { self.ticks.minor.clone() } else { self.ticks.major.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Extent {
    fn format_ext(&self, value: &f64) -> String {
        self.label(*value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pole_at_the_end_leaves_the_curve_to_be_seen() {
        let curve = (0..=500).map(|i| (f64::from(i) / 50.0).sin());
        let fitted = |last: f64| Extent::fit(&Axis::new("", ""), curve.clone().chain([last]), 0.0);
        let pole = fitted(-2e14);
        assert!(pole.low > -1.1 && pole.high < 1.1, "{pole:?}");
        // An impulse is seen beside the curve, and shown whole.
        assert_eq!(fitted(3e4).high, 3e4);
        // What is 0 but for one point has no middle to show.
        let spike = Extent::fit(&Axis::new("", ""), (0..500).map(|i| f64::from(u8::from(i == 7))), 0.0);
        assert_eq!((spike.low, spike.high), (0.0, 1.0));
    }
}
