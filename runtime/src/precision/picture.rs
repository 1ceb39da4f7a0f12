//! The charts and the table of what was measured.

use super::verdict::TARGETS;
use super::{AccuracyControl, Curve, Measured, WorkPrecision};
use crate::show::{Axis, Chart, Failure, Figure, Series};

/// Errors over time are shown of runs whose work is within this factor of what the best takes for 1e-6.
const ALIKE: f64 = 2.0;

/// What is written of a point.
pub(super) const COLUMNS: [&str; 18] = [
    "scene",
    "candidate",
    "method",
    "tolerance",
    "step_s",
    "error",
    "work",
    "cpu_s",
    "evaluations",
    "jacobians",
    "factorizations",
    "steps",
    "rejected",
    "energy_drift",
    "residual",
    "failure",
    "reference",
    "reference_digits",
];
/// Where those of the reference begin.
const OF_REFERENCE: usize = COLUMNS.len() - 2;

impl WorkPrecision {
    /// Work over error, time over error, and error over time of runs of about the same work.
    pub fn figure(&self) -> Figure {
        let span = self.reference.times().last().zip(self.reference.times().first()).map_or(1.0, |(b, a)| b - a);
        let work = self.chart("work (evaluations)", |point| point.cost);
        let time = self.chart("time (ns per simulated second)", |point| point.seconds * 1e9 / span);
        let mut charts = vec![work, time];
        charts.extend(self.growth());
        let reference = &self.reference;
        charts[0].title = format!("{}, measured from {} ({} digits)", self.title, reference.by(), reference.digits());
        Figure::from(charts)
    }

    fn chart(&self, label: &str, cost: impl Fn(&Measured) -> f64) -> Chart {
        let error = Axis::new("error (part of the range)", "").log().reversed();
        let series = self.curves.iter().map(|curve| {
            let points = curve.measured().filter(|point| point.error > 0.0);
            Series {
                failures: failures(curve),
                ..Series::marked_line(curve.name.clone(), points.map(|point| Some((point.error, cost(point)))))
            }
        });
        Chart { series: series.collect(), ..Chart::new("", error, Axis::new(label, "").log()) }
    }

    /// The largest error until each time, at about the work that the best takes for 1e-6 or, failing that, for 1e-3.
    fn growth(&self) -> Option<Chart> {
        let reached = |target: &f64| self.best(*target, |point| point.cost).map(|(_, cost)| (*target, cost));
        let (target, work) = [TARGETS[1], TARGETS[0]].iter().find_map(reached)?;
        let mut chart = Chart::new(
            format!("about {work:.0} evaluations: what the best takes for {target:.0e}"),
            Axis::new("time", "s"),
            Axis::new("largest error until then", "").log(),
        );
        for (place, curve) in self.curves.iter().enumerate() {
            let distance = |point: &&Measured| (point.cost / work).ln().abs();
            let nearest = curve.measured().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let Some(point) = nearest.filter(|point| distance(point) <= ALIKE.ln()) else { continue };
            let times = self.reference.times().iter().zip(&point.growth);
            let line = Series::line(curve.name.clone(), times.map(|(t, error)| Some((*t, *error))));
            chart.series.push(line.coloured(place));
        }
        (!chart.series.is_empty()).then_some(chart)
    }

    /// One line for each candidate: its cost to reach 1e-3, 1e-6 and 1e-9 in evaluations and in time, the order at which
    /// errors fall, errors beside tolerances, and failures.
    pub fn table(&self) -> String {
        let width = self.curves.iter().map(|curve| curve.name.chars().count()).max().unwrap_or(0).max(9);
        let mut text = format!("{:width$}", "candidate");
        for target in TARGETS {
            text += &format!("  {:>9}", format!("{target:.0e}"));
        }
        for target in TARGETS {
            text += &format!("  {:>9}", format!("{target:.0e}"));
        }
        text += &format!("  {:>5}  {:>9}\n", "order", "error/tol");
        for curve in &self.curves {
            text += &format!("{:width$}", curve.name);
            let cells = |cost: &dyn Fn(&Measured) -> f64, write: &dyn Fn(f64) -> String| {
                let cell = |target: f64| curve.at(target, cost).map_or("-".to_owned(), write);
                TARGETS.map(|target| format!("  {:>9}", cell(target))).concat()
            };
            text += &cells(&|point| point.cost, &|cost| format!("{cost:.0}"));
            text += &cells(&|point| point.seconds, &duration);
            let order = curve.order().map_or("-".to_owned(), |order| format!("{order:.1}"));
            let honesty = curve.honesty().map_or("-".to_owned(), |ratio| format!("{ratio:.1e}"));
            text += &format!("  {order:>5}  {honesty:>9}");
            let failed = curve.points.iter().filter_map(|point| point.outcome.as_ref().err());
            let (count, mut codes) = (failed.clone().count(), failed.copied().collect::<Vec<_>>());
            codes.sort_unstable();
            codes.dedup();
            if count > 0 {
                text += &format!("  {count} of {} points: {}", curve.points.len(), codes.join(", "));
            }
            text = text.trim_end().to_owned() + "\n";
        }
        text
    }

    /// All points: a line each, with the names of what is in the columns above.
    pub fn to_csv(&self) -> String {
        let points = self.curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve, point)));
        record(points.map(|(curve, point)| {
            let number = |value: f64| format!("{value:e}");
            let (tolerance, step) = match point.control {
                AccuracyControl::Tolerance(tolerance) => (number(tolerance), String::new()),
                AccuracyControl::Step(step) => (String::new(), number(step)),
            };
            let method = point.outcome.as_ref().map_or(curve.method, |found| found.method);
            let mut cells = vec![self.title.clone(), curve.name.clone(), method.to_string(), tolerance, step];
            match &point.outcome {
                Ok(found) => {
                    let work = &found.work;
                    let counts = [work.evaluations, work.jacobians, work.factorizations, work.steps, work.rejected];
                    cells.extend([found.error, found.cost, found.seconds].map(number));
                    cells.extend(counts.map(|count| count.to_string()));
                    cells.extend([found.drift, found.residual].map(|value| value.map(number).unwrap_or_default()));
                    cells.push(String::new());
                }
                Err(code) => {
                    cells.resize(OF_REFERENCE - 1, String::new());
                    cells.push((*code).to_owned());
                }
            }
            cells.extend([self.reference.by().to_owned(), self.reference.digits().to_string()]);
            cells
        }))
    }
}

/// A table of points of curves.
pub(super) fn record(rows: impl Iterator<Item = Vec<String>>) -> String {
    into_table(&COLUMNS, rows)
}

/// A table with these columns.
pub(super) fn into_table(columns: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut table = csv::Writer::from_writer(Vec::new());
    let into_memory = "a vector in memory takes all that is written";
    table.write_record(columns).expect(into_memory);
    rows.for_each(|cells| table.write_record(cells).expect(into_memory));
    String::from_utf8(table.into_inner().expect(into_memory)).expect("names and numbers are text")
}

/// Crosses above a chart: at the tolerance, or at the left where there is none.
fn failures(curve: &Curve) -> Vec<Failure> {
    let failed = curve.points.iter().filter_map(|point| Some((point, point.outcome.as_ref().err()?)));
    let place = |control: AccuracyControl| match control {
        AccuracyControl::Tolerance(tolerance) => tolerance,
        AccuracyControl::Step(_) => f64::NAN,
    };
    let mut found: Vec<Failure> = Vec::new();
    for (point, code) in failed {
        let x = place(point.control);
        match found.iter_mut().find(|failure| failure.x.total_cmp(&x).is_eq()) {
            Some(failure) if failure.label.contains(code) => {}
            Some(failure) => failure.label += &format!(", {code}"),
            None => found.push(Failure { x, label: (*code).to_owned() }),
        }
    }
    found
}

fn duration(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 1e-3 => (s * 1e6, "µs"),
        s if s < 1.0 => (s * 1e3, "ms"),
        s => (s, "s"),
    };
    format!("{value:.3} {unit}")
}
