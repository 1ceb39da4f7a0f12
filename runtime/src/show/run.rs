//! What a run looks like.

use super::{Animation, Axis, Chart, Figure, Instant, Series, csv};
use crate::error::Error;
use crate::mechanism::{Coordinate, Description, Shape};
use crate::run::Run;
use std::path::Path;
use std::sync::Arc;

/// A section has no more points.
const MOST_SECTIONS: usize = 100_000;

impl Run {
    /// Draws the run to a file, see [`Run::to_svg`]: as PNG where its name ends in `.png`.
    ///
    /// # Errors
    /// As [`Figure::write`].
    pub fn plot(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        self.figure().write(path)
    }

    /// Writes [`Run::animation`] to a file: a page, or a picture that moves where its name ends in `.png` or `.gif`, its
    /// first frame where it ends in `.svg`.
    ///
    /// # Errors
    /// As [`Animation::write`].
    pub fn animate(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        self.animation().write(path)
    }

    /// Writes [`Run::to_csv`] to a file.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn csv(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        write(path.as_ref(), &self.to_csv())
    }

    /// A figure as SVG: the paths of the traces that the model draws, or of its vector output if it has just
    /// one, and below the histories of all coordinates, one chart for each unit.
    pub fn to_svg(&self) -> String {
        self.figure().to_svg()
    }

    /// A page that plays the motion: see [`Animation`], which takes charts beside it.
    pub fn to_html(&self) -> String {
        self.animation().to_html()
    }

    /// Time, coordinates, rates and outputs of all reported states: see [`csv`].
    pub fn to_csv(&self) -> String {
        let names: Vec<String> = std::iter::once("t".to_owned()).chain(self.shown_names()).collect();
        let columns: Vec<Vec<Option<f64>>> =
            names.iter().map(|name| self.column(name).unwrap_or_default().into_iter().map(Some).collect()).collect();
        csv(&names, &columns)
    }

    /// Named coordinates, rates (`theta'`) and outputs (`tip.x`) against time, in one chart.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub fn history(&self, names: &[&str]) -> Result<Chart, Error> {
        let unit = self.common_unit(names);
        let named = |name: &&str| match self.unit(name) {
            own if own == unit || own.is_empty() => (*name).to_owned(),
            own => format!("{name} ({own})"),
        };
        let curves = names.iter().zip(self.curves(names)?);
        let series = curves.map(|(name, curve)| Series::line(named(name), curve.into_iter().map(Some))).collect();
        let time = Axis::new("time", if has_units(&self.description) { "s" } else { "" });
        let happened = self.events.iter().map(|event| Instant { x: event.state.t, name: event.name.to_string() });
        let mut chart = Chart { series, instants: happened.collect(), ..Chart::new("", time, Axis::default()) };
        // Names that stand beside the chart are not repeated along its axis.
        chart.y = match family(names) {
            Some(name) => Axis::new(name, unit),
            None if unit.is_empty() => Axis::default(),
            None => Axis::new(format!("in {unit}"), ""),
        };
        Ok(chart)
    }

    /// One column over another: the phase portrait of `theta` and `theta'`, the path of `tip.x` and `tip.y`
    /// (then with [`Chart::equal`]).
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub fn portrait(&self, x: &str, y: &str) -> Result<Chart, Error> {
        let (across, up) = (self.samples(x)?, self.samples(y)?);
        // Both have the same times, unless one has dense output and the other has not.
        let points: Vec<Option<(f64, f64)>> = match across.len() == up.len() {
            true => across.iter().zip(&up).map(|(a, b)| Some((a.1, b.1))).collect(),
            false => self.column(x).into_iter().flatten().zip(self.column(y).into_iter().flatten()).map(Some).collect(),
        };
        let times = match across.len() == up.len() {
            true => across.iter().map(|point| point.0).collect(),
            false => self.times.clone(),
        };
        let axis = |name: &str| Axis::new(name, self.common_unit(&[name]));
        Ok(Chart::new("", axis(x), axis(y)).with(Series::line("", points).at_times(times)))
    }

    /// A stroboscopic section: states at multiples of a period, s, as points of a portrait of coordinates and rates.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub fn section(&self, x: &str, y: &str, period: f64) -> Result<Chart, Error> {
        let (first, last) = (self.times[0], self.times[self.times.len() - 1]);
        let (mut times, mut points) = (Vec::new(), Vec::new());
        for k in 0..MOST_SECTIONS {
            // The last one may miss the end by rounding.
            let t = first + k as f64 * period;
            if t > last + 1e-9 * period {
                break;
            }
            let Some(state) = self.at(t.min(last)) else { break };
            let value = |name: &str| {
                state.get(name).ok_or_else(|| Error::unknown("coordinate or rate", name, self.shown_names()))
            };
            points.push(Some((value(x)?, value(y)?)));
            times.push(t);
        }
        let axis = |name: &str| Axis::new(name, self.common_unit(&[name]));
        Ok(Chart::new("", axis(x), axis(y)).with(Series::marks("", points).at_times(times)))
    }

    /// The charts of [`Run::to_svg`].
    pub fn figure(&self) -> Figure {
        let mut charts = self.paths();
        let mut units: Vec<&str> = Vec::new();
        for coordinate in self.description.coordinates.iter() {
            if !units.contains(&coordinate.unit.as_ref()) {
                units.push(&coordinate.unit);
            }
        }
        for unit in units {
            let alike = self.description.coordinates.iter().filter(|coordinate| coordinate.unit == unit);
            let names: Vec<&str> = alike.map(|c| c.state().unwrap_or(&c.name)).collect();
            charts.extend(self.history(&names));
        }
        if let Some(first) = charts.first_mut() {
            first.title = self.description.name.to_string();
        }
        Figure::from(charts)
    }

    /// The shapes that the model draws, at up to some thousands of times, none if the run kept no dense output.
    pub fn animation(&self) -> Animation {
        Animation::of(&self.description).with_frames(self.frames())
    }

    /// Paths of all traces, or of the only output if that is a vector; of motions in space two views.
    fn paths(&self) -> Vec<Chart> {
        let traces = self.traces();
        let unit = if has_units(&self.description) && !traces.is_empty() { "m" } else { "" };
        let paths = if traces.is_empty() { self.output_path().into_iter().collect() } else { traces };
        let view = |across: usize, up: usize| {
            let chart = Chart::new("", Axis::new(["x", "y", "z"][across], unit), Axis::new(["x", "y", "z"][up], unit));
            let line = |(name, path): &(String, Vec<[f64; 3]>)| {
                Series::line(name.clone(), path.iter().map(|point| Some((point[across], point[up]))))
            };
            Chart { series: paths.iter().map(line).collect(), ..chart.equal() }
        };
        match (paths.is_empty(), self.description.structure.dimension) {
            (true, _) => Vec::new(),
            (false, 3) => vec![view(0, 1), view(0, 2)],
            (false, _) => vec![view(0, 1)],
        }
    }

    fn traces(&self) -> Vec<(String, Vec<[f64; 3]>)> {
        let dimension = self.description.structure.dimension as usize;
        let mut first = 0;
        let mut traces = Vec::new();
        if !self.description.draw.iter().any(|shape| matches!(shape, Shape::Trace(_))) {
            return traces;
        }
        let frames = self.frames();
        for shape in self.description.draw.iter() {
            if let Shape::Trace(name) = shape {
                let points = frames.iter().map(|(_, frame)| point(&frame[first..first + dimension]));
                traces.push((name.to_string(), points.collect()));
            }
            first += shape.numbers(dimension);
        }
        traces
    }

    fn output_path(&self) -> Option<(String, Vec<[f64; 3]>)> {
        let [output] = self.description.outputs.as_ref() else { return None };
        let size = output.components as usize;
        (size > 1).then(|| (output.name.to_string(), self.outputs.chunks_exact(size).map(point).collect()))
    }

    /// The unit that all of these have in common; else none is written.
    fn common_unit(&self, names: &[&str]) -> String {
        let mut units = names.iter().map(|name| self.unit(name));
        let first = units.next().unwrap_or_default();
        if units.all(|unit| unit == first) { first } else { String::new() }
    }

    /// The SI unit of a coordinate, rate or output; empty where it is pure or not known.
    pub fn unit(&self, name: &str) -> String {
        unit(&self.description, name)
    }
}

/// No column has this name.
pub(super) fn unknown_column(run: &Run, name: &str) -> Error {
    Error::unknown("coordinate, rate or output", name, run.shown_names())
}

/// The SI unit of a coordinate, rate, state or output of a mechanism; empty where it is pure or not known.
pub(crate) fn unit(mechanism: &Description, name: &str) -> String {
    let output = [".x", ".y", ".z"].iter().find_map(|axis| name.strip_suffix(axis)).unwrap_or(name);
    if let Some(output) = mechanism.outputs.iter().find(|known| known.name == output) {
        return output.unit.to_string();
    }
    if let Some(state) = mechanism.coordinates.iter().find(|known| known.state() == Some(name)) {
        return si(state).to_owned();
    }
    let coordinate = name.strip_suffix('\'').unwrap_or(name);
    let Some(found) = mechanism.coordinates.iter().find(|known| known.name == coordinate) else { return String::new() };
    // The rate of a state's hidden coordinate is the state.
    let rate = name.ends_with('\'') && has_units(mechanism) && found.state().is_none();
    match (si(found), rate) {
        ("", true) => "1/s".to_owned(),
        (unit, true) => format!("{unit}/s"),
        (unit, false) => unit.to_owned(),
    }
}

/// True for a model written with units; without, lengths and times are pure numbers.
pub(crate) fn has_units(mechanism: &Description) -> bool {
    let coordinates = mechanism.coordinates.iter().map(|coordinate| &coordinate.unit);
    let parameters = mechanism.parameters.iter().map(|parameter| &parameter.unit);
    coordinates.chain(parameters).any(|unit| !matches!(unit.as_ref(), "" | "1" | "rad"))
}

fn point(components: &[f64]) -> [f64; 3] {
    std::array::from_fn(|k| components.get(k).copied().unwrap_or(0.0))
}

/// The SI unit of a coordinate, whose numbers are in SI whatever the file's prefix.
fn si(coordinate: &Coordinate) -> &str {
    match coordinate.unit.as_ref() {
        "1" => "",
        "km" | "cm" | "mm" | "um" => "m",
        "mrad" => "rad",
        unit => unit,
    }
}

/// `theta` for `theta[1]`, `theta[2]` …, where all are of one family.
fn family(names: &[&str]) -> Option<String> {
    let of =
        |name: &str| name.split('[').next().unwrap_or(name).to_owned() + if name.ends_with("]'") { "'" } else { "" };
    let first = of(names.first()?);
    names.iter().all(|name| of(name) == first).then_some(first)
}

fn write(path: &Path, text: &str) -> Result<(), Error> {
    std::fs::write(path, text).map_err(|problem| Error::File { path: path.to_owned(), problem: Arc::new(problem) })
}

#[cfg(test)]
mod tests {
    use super::super::curve::POINTS;
    use super::*;
    use crate::testing::Toy;
    use crate::{Settings, simulate};

    /// A mass on a circle, its bar and its trace.
    fn circling(dimension: u32) -> Run {
        let mut toy = Toy::new(&["phi", "r[1]"], (&[0.0, 1.0], &[1.0, 0.0]), 6.0, |_, _, _, _, a| a.fill(0.0));
        toy.description.name = "Circling".into();
        toy.description.structure.dimension = dimension;
        toy.description.coordinates.to_mut()[0].unit = "rad".into();
        toy.description.coordinates.to_mut()[1].unit = "mm".into();
        toy.description.draw = vec![Shape::Line(2), Shape::Trace("tip".into())].into();
        toy.drawing = Arc::new(move |_, q, _, _, points| {
            points.fill(0.0);
            let tip = [q[0].cos(), q[0].sin()];
            let d = dimension as usize;
            points[d..d + 2].copy_from_slice(&tip);
            points[2 * d..2 * d + 2].copy_from_slice(&tip);
        });
        let settings = Settings::new(&toy.scene);
        simulate(&mut toy, &settings).unwrap()
    }

    #[test]
    fn coordinates_are_charted_by_unit_below_the_paths() {
        for (dimension, labels) in [
            (2, vec!["x (m)", "y (m)", "time (s)", "phi (rad)", "time (s)", "r (m)"]),
            (3, vec!["x (m)", "y (m)", "x (m)", "z (m)", "time (s)", "phi (rad)", "time (s)", "r (m)"]),
        ] {
            let figure = circling(dimension).figure();
            let found: Vec<String> = figure.charts.iter().flat_map(|chart| [chart.x.text(), chart.y.text()]).collect();
            assert_eq!(found, labels);
            assert_eq!(figure.charts[0].title, "Circling");
            assert_eq!(figure.charts[0].series[0].name, "tip");
            assert!(figure.charts[0].equal && !figure.charts[dimension as usize - 1].equal);
        }
    }

    #[test]
    fn traces_and_frames_are_the_points_of_the_model() {
        let run = circling(2);
        let path = &run.figure().charts[0].series[0].points;
        let frames = run.animation().frames;
        assert_eq!((path.len(), frames.len()), (2001, 2001));
        assert_eq!((frames[0].0, frames[2000].0), (0.0, 6.0));
        for ((t, numbers), tip) in frames.iter().zip(path) {
            assert!((tip.unwrap().0 - t.cos()).abs() < 1e-9 && numbers[2] == tip.unwrap().0);
        }
    }

    #[test]
    fn curves_are_smoother_than_the_reported_states() {
        let run = circling(2);
        let chart = run.history(&["phi"]).unwrap();
        assert_eq!((run.len(), chart.series[0].points.len()), (501, POINTS + 1));
        assert_eq!(chart.series[0].points[POINTS].map(|p| p.0), Some(6.0));
    }

    #[test]
    fn a_portrait_has_one_column_over_the_other() {
        let chart = circling(2).portrait("phi", "phi'").unwrap();
        assert_eq!((chart.x.text(), chart.y.text()), ("phi (rad)".to_owned(), "phi' (rad/s)".to_owned()));
        let (phi, rate) = chart.series[0].points[POINTS].unwrap();
        assert!((phi - 6.0).abs() < 1e-9 && (rate - 1.0).abs() < 1e-9);
        assert_eq!((chart.series[0].times.len(), chart.series[0].times[POINTS]), (POINTS + 1, 6.0));
    }

    #[test]
    fn tables_hold_what_was_computed() {
        let run = circling(2);
        let text = run.to_csv();
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("t,phi,r[1],phi',r[1]'"));
        assert_eq!(text.lines().count(), run.len() + 1);
        let last: Vec<f64> = lines.next_back().unwrap().split(',').map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(last[..2], [run.last().t, run.last()["phi"]]);
    }

    #[test]
    fn rates_have_their_units_and_unknown_names_are_errors() {
        let run = circling(2);
        assert_eq!(run.history(&["phi'"]).unwrap().y.text(), "phi' (rad/s)");
        let chart = run.history(&["phi", "phi'"]).unwrap();
        assert_eq!(chart.y.text(), "");
        let names: Vec<&str> = chart.series.iter().map(|series| series.name.as_str()).collect();
        assert_eq!(names, ["phi (rad)", "phi' (rad/s)"]);
        let error = run.history(&["psi"]).unwrap_err();
        assert!(matches!(&error, Error::UnknownName { name, .. } if name == "psi"), "{error}");
    }

    #[test]
    fn a_file_that_cannot_be_written_is_an_error() {
        let error = circling(2).plot("/nowhere/at/all.svg").unwrap_err();
        assert!(error.to_string().starts_with("cannot write `/nowhere/at/all.svg`"), "{error}");
    }
}
