//! Motions that repeat, drawn.

use super::family::{Family, Member};
use super::found::{Multiplier, Orbit};
use super::stability_map::{Boundary, StabilityMap};
use crate::linear::short;
use crate::show::{Axis, Chart, Figure, Series, Style};

/// Points of the unit circle.
const CIRCLE: usize = 181;
/// Coordinates that are drawn.
const MOST: usize = 6;

impl Orbit {
    /// The motion in the planes of its coordinates and their rates, and the multipliers of its map beside the unit circle.
    pub fn figure(&self) -> Figure {
        let description = &self.run.description;
        let names = description.coordinates.iter().take(MOST);
        let mut charts: Vec<Chart> = names
            .map(|coordinate| {
                let (q, v) = (coordinate.name.to_string(), format!("{}'", coordinate.name));
                let [x, y] = [&q, &v].map(|name| self.run.column(name).unwrap_or_default());
                let axes = [&q, &v].map(|name| Axis::new(name.as_str(), self.run.unit(name)));
                let [across, up] = axes;
                Chart::new("", across, up).with(Series::line("", x.into_iter().zip(y).map(Some)))
            })
            .collect();
        charts.push(circle(&self.multipliers));
        Figure { charts, columns: 2 }
    }
}

/// Multipliers in the complex plane, with the unit circle.
fn circle(multipliers: &[Multiplier]) -> Chart {
    let around = (0..CIRCLE).map(|k| std::f64::consts::TAU * k as f64 / (CIRCLE - 1) as f64);
    let marks = multipliers.iter().map(|multiplier| Some((multiplier.re, multiplier.im)));
    Chart::new("multipliers", Axis::new("real part", ""), Axis::new("imaginary part", ""))
        .equal()
        .with(Series { style: Style::Dashed, ..Series::line("", around.map(|angle| Some((angle.cos(), angle.sin())))) })
        .with(Series::marks("", marks))
}

impl Family {
    /// Amplitudes, and periods, over what varies: stable motions as full lines, unstable ones dashed, thresholds with their names.
    pub fn figure(&self) -> Figure {
        let count = (self.names.len() / 2).min(MOST);
        let amplitude = |k: usize| move |member: &Member| member.amplitudes.get(k).copied().unwrap_or(f64::NAN);
        let mut charts: Vec<Chart> =
            (0..count).map(|k| self.chart(&format!("amplitude of {}", self.names[k]), "", &amplitude(k))).collect();
        charts.push(self.chart("period", "s", &|member: &Member| member.period));
        Figure { charts, columns: if count > 1 { 2 } else { 1 } }
    }

    fn chart(&self, label: &str, unit: &str, of: &dyn Fn(&Member) -> f64) -> Chart {
        let mut chart = Chart::new("", Axis::new(self.name.as_str(), ""), Axis::new(label, unit));
        for (grows, style) in [(false, Style::Line), (true, Style::Dashed)] {
            let unstable = |member: &Member| member.multipliers.iter().any(|multiplier| multiplier.grows());
            // Thresholds are members: a line changes there.
            let points = self.members.windows(2).flat_map(|pair| {
                let [here, next] = [&pair[0], &pair[1]].map(|member| Some((member.value, of(member))));
                if pair.iter().any(unstable) == grows { vec![here, next] } else { vec![None] }
            });
            let points: Vec<_> = points.collect();
            let name = if grows { "unstable" } else { "stable" };
            if points.iter().any(Option::is_some) {
                chart = chart.with(Series { style, ..Series::line(name, points) }.coloured(usize::from(grows)));
            }
        }
        for (k, threshold) in self.thresholds.iter().enumerate() {
            let name = format!("{} at {}", threshold.kind.word(), short(threshold.value));
            let mark = Series::marks(name, [Some((threshold.value, of(&threshold.member)))]);
            chart = chart.with(mark.coloured(2 + k));
        }
        chart
    }
}

impl StabilityMap {
    /// Where small changes grow as filled areas, and the boundaries, a colour for each kind.
    pub fn figure(&self) -> Figure {
        let [x, y] = &self.names;
        let mut chart = Chart::new("", Axis::new(x.as_str(), ""), Axis::new(y.as_str(), ""));
        chart = chart.with(Series::areas("unstable", self.unstable()).coloured(1));
        let mut named = Vec::new();
        for boundary in &self.boundaries {
            let kind = boundary.kind;
            let new = !named.contains(&kind);
            if new {
                named.push(kind);
            }
            let name = if new { kind.word() } else { "" };
            let place = named.iter().position(|other| *other == kind).unwrap_or(0);
            chart = chart.with(boundary.series(name).coloured(2 + place));
        }
        Figure::from(chart)
    }

    /// Corners of strips in which small changes grow: each row halfway to its neighbours, from boundary to boundary.
    fn unstable(&self) -> Vec<Option<(f64, f64)>> {
        let [xs, ys] = &self.values;
        let halfway = |values: &[f64], k: usize, next: bool| match (next, k.checked_sub(1), values.get(k + 1)) {
            (true, _, Some(other)) => 0.5 * (values[k] + other),
            (false, Some(before), _) => 0.5 * (values[k] + values[before]),
            _ => values[k],
        };
        let mut corners = Vec::new();
        for (row, y) in ys.iter().enumerate() {
            let [low, high] = [false, true].map(|next| halfway(ys, row, next));
            for column in (0..xs.len()).filter(|column| self.is_unstable(*column, row) == Some(true)) {
                let edge = |next: bool| {
                    let plain = halfway(xs, column, next);
                    let other = if next { xs.get(column + 1) } else { column.checked_sub(1).map(|k| &xs[k]) };
                    let Some(other) = other else { return plain };
                    let within = self
                        .boundaries
                        .iter()
                        .flat_map(|boundary| &boundary.points)
                        .filter(|point| point.y == *y && (point.x - xs[column]) * (point.x - other) <= 0.0);
                    within
                        .map(|point| point.x)
                        .min_by(|a, b| (a - xs[column]).abs().total_cmp(&(b - xs[column]).abs()))
                        .unwrap_or(plain)
                };
                let [left, right] = [edge(false), edge(true)];
                corners.extend([(left, low), (right, low), (right, high), (left, high)].map(Some));
                corners.push(None);
            }
        }
        corners
    }
}

impl Boundary {
    fn series(&self, name: &str) -> Series {
        Series::line(name, self.points.iter().map(|point| Some((point.x, point.y))))
    }
}
