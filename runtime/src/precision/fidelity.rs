//! What a scene can do without: error against work, a point for every model of it.

use super::picture::{COLUMNS, record};
use crate::show::{Axis, Chart, Series, Style};

/// A model of a scene, run at a tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct Verified {
    /// What it leaves out.
    pub name: String,
    /// At which tolerance it was run.
    pub tolerance: f64,
    /// The largest deviation from the full model run more exactly, in parts of the range that each wanted quantity goes through, or of what
    /// is asked for.
    pub error: f64,
    /// What it takes, in evaluations of the full model's accelerations, by counting operations.
    pub work: f64,
}

/// Error against work of the models of one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Fidelity {
    /// What the chart is called.
    pub title: String,
    /// In parts of what errors are told: `the range`.
    pub measure: &'static str,
    /// The largest error that serves.
    pub within: f64,
    /// The full model, at several tolerances.
    pub full: Vec<Verified>,
    /// Models without one ingredient each, those that save most first.
    pub reductions: Vec<Verified>,
    /// The model without all that may go.
    pub chosen: Option<Verified>,
}

/// ` at 1e-9`, ` at 1e-3 to 1e-9`: at which tolerances models were run, short enough for a legend.
fn at(points: &[Verified]) -> String {
    match points {
        [] => String::new(),
        [first, .., last] if first.tolerance != last.tolerance => {
            format!(" at {:e} to {:e}", first.tolerance, last.tolerance)
        }
        [first, ..] => format!(" at {:e}", first.tolerance),
    }
}

/// Points that are listed by name.
const LISTED: usize = 14;
/// Errors are not known better than this.
const LEAST: f64 = 1e-12;

impl Fidelity {
    /// A point for every model: what serves is to the right of the dashed line, and what saves most below.  The rest of more than
    /// fourteen have no names.
    pub fn chart(&self) -> Chart {
        let known = self.full.iter().map(|point| point.error).fold(f64::INFINITY, f64::min);
        // What is off by less than is known is drawn where knowledge ends.
        let floor = if known.is_finite() { known.max(LEAST) } else { LEAST };
        let place = |point: &Verified| {
            let drawn = point.error.is_finite() && point.work > 0.0;
            drawn.then(|| (point.error.max(floor), point.work))
        };
        let drawn: Vec<(&str, (f64, f64))> =
            self.reductions.iter().filter_map(|point| Some((point.name.as_str(), place(point)?))).collect();
        let all = self.full.iter().chain(&self.chosen).filter_map(place).chain(drawn.iter().map(|(_, place)| *place));
        let (least, most) = all.fold((f64::INFINITY, 0.0_f64), |(low, high), (_, y)| (low.min(y), high.max(y)));
        let need = [least, most].map(|work| work.is_finite().then_some((self.within, work)));
        let error = Axis::new(format!("error (part of {})", self.measure), "").log().reversed();
        let work = Axis::new("work (evaluations of the full model)", "").log();
        let mut chart = Chart::new(self.heading(), error, work)
            .with(Series { style: Style::Dashed, ..Series::line("what is asked for", need) })
            .with(Series::marked_line(format!("the full model{}", at(&self.full)), self.full.iter().map(place)));
        if let Some(chosen) = &self.chosen {
            let name = chosen.name.clone() + &at(std::slice::from_ref(chosen));
            chart = chart.with(Series::marks(name, [place(chosen)]));
        }
        for (name, place) in drawn.iter().take(LISTED) {
            chart = chart.with(Series::marks(*name, [Some(*place)]));
        }
        if drawn.len() > LISTED {
            chart = chart.with(Series::marks("others", drawn[LISTED..].iter().map(|(_, place)| Some(*place))));
        }
        chart
    }

    /// The title, and at which tolerance ingredients are left out one by one, which is not that of all points of the full model.
    fn heading(&self) -> String {
        if self.reductions.is_empty() {
            return self.title.clone();
        }
        format!("{}, each alone{}; the numbers are tolerances", self.title, at(&self.reductions))
    }

    /// All points, in the columns of [`WorkPrecision::to_csv`](super::WorkPrecision::to_csv); what was not measured of them is empty.
    pub fn to_csv(&self) -> String {
        let full = self.full.iter().map(|point| ("the full model", point));
        let others = self.chosen.iter().chain(&self.reductions).map(|point| (point.name.as_str(), point));
        record(full.chain(others).map(|(name, point)| {
            let number = |value: f64| format!("{value:e}");
            let mut cells = vec![self.title.clone(), name.to_owned(), String::new(), number(point.tolerance)];
            cells.extend([String::new(), number(point.error), number(point.work)]);
            cells.resize(COLUMNS.len(), String::new());
            cells
        }))
    }
}
