//! Motions that repeat, drawn.

use super::family::{Family, Member};
use super::found::{Multiplier, Orbit};
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
            let kept = |member: &&Member| member.multipliers.iter().any(|multiplier| multiplier.grows()) == grows;
            // A line goes on to the first motion of the other kind, so that there is no gap between both.
            let points = self.members.windows(2).flat_map(|pair| {
                let [here, next] = [&pair[0], &pair[1]].map(|member| Some((member.value, of(member))));
                if kept(&&pair[0]) { vec![here, next] } else { vec![None] }
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
