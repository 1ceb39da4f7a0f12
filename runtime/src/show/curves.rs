//! Charts as data of a page that animates.

use serde_json::{Value, json};

use super::{Axis, Chart, Scale, Series, Style};

/// What a page knows of a chart.
pub(super) fn data(chart: &Chart) -> Value {
    json!({
        "title": chart.title,
        "x": axis(&chart.x),
        "y": axis(&chart.y),
        "equal": chart.is_equal(),
        "series": chart.series.iter().enumerate().map(|(place, series)| curve(place, series)).collect::<Vec<_>>(),
    })
}

fn axis(axis: &Axis) -> Value {
    json!({
        "text": axis.text(),
        "unit": axis.unit,
        "log": axis.scale == Scale::Log,
        "range": axis.range.map(|(low, high)| [low, high]),
        "reversed": axis.reversed,
    })
}

fn curve(place: usize, series: &Series) -> Value {
    let part = |of: fn((f64, f64)) -> f64| series.points.iter().map(move |point| point.map_or(f64::NAN, of)).collect();
    json!({
        "name": series.name,
        "colour": series.colour.unwrap_or(place),
        "line": series.style != Style::Marks,
        "marks": matches!(series.style, Style::Marks | Style::MarkedLine),
        "dashed": series.style == Style::Dashed,
        "t": (series.times.len() == series.points.len()).then(|| column(series.times.clone())),
        "x": column(part(|point| point.0)),
        "y": column(part(|point| point.1)),
    })
}

/// Numbers as whole multiples of a millionth of their range or less.
fn column(numbers: Vec<f64>) -> Value {
    let unit = unit(numbers.iter());
    json!({"unit": unit, "values": numbers.iter().map(|x| multiple(*x, unit)).collect::<Vec<_>>()})
}

/// The power of ten that is between 10⁻⁷ and 10⁻⁶ of the range of these numbers.
pub(super) fn unit<'a>(numbers: impl Iterator<Item = &'a f64>) -> f64 {
    let finite = numbers.filter(|x| x.is_finite());
    let (low, high) = finite.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    let range = (high / 2.0 - low / 2.0) * 2.0;
    let range = if range > 1e-290 { range.min(1e300) } else { 1.0 };
    format!("1e{}", range.log10().floor() as i32 - 6).parse().expect("a power of ten between 1e-297 and 1e294")
}

pub(super) fn multiple(x: f64, unit: f64) -> Value {
    if x.is_finite() { json!((x / unit).round() as i64) } else { Value::Null }
}
