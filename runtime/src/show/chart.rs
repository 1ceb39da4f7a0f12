//! What a chart shows, as plain data.

use super::{Axis, Figure, Scale};

/// One pair of axes and what is drawn between them.
///
/// ```
/// use dalembert::show::{Axis, Chart, Series};
/// let swing = (0..100).map(|i| f64::from(i) / 10.0).map(|t| Some((t, t.cos())));
/// let svg = Chart::new("Pendulum", Axis::new("time", "s"), Axis::new("angle", "rad"))
///     .with(Series::line("theta", swing))
///     .to_svg();
/// assert!(svg.starts_with("<svg") && svg.contains("time (s)"));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// Stands above; may be empty.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What is drawn, the first one lowest.
    pub series: Vec<Series>,
    /// Triangles that show slopes of a log–log chart.
    pub slopes: Vec<Slope>,
    /// What happened at places of the horizontal axis: thin vertical lines with their names, ticks alone where there are many.
    pub instants: Vec<Instant>,
    /// One unit is equally long on both axes, which must be linear: paths keep their shape.
    pub equal: bool,
}

impl Chart {
    /// A chart without series.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Chart {
        Chart { title: title.into(), x, y, ..Chart::default() }
    }

    /// The same chart with one more series.
    pub fn with(mut self, series: Series) -> Chart {
        self.series.push(series);
        self
    }

    /// The same chart with units of equal length on both axes.
    pub fn equal(self) -> Chart {
        Chart { equal: true, ..self }
    }

    /// True where units of equal length are wanted and possible.
    pub(super) fn is_equal(&self) -> bool {
        self.equal && self.x.scale == Scale::Linear && self.y.scale == Scale::Linear
    }

    /// How many colours its series take.
    pub(super) fn colours(&self) -> usize {
        let places = self.series.iter().filter_map(|series| series.colour).map(|place| place + 1);
        places.max().unwrap_or(0).max(self.series.len())
    }

    /// The chart as the text of an SVG file.
    pub fn to_svg(&self) -> String {
        Figure::from(self.clone()).to_svg()
    }
}

/// A named set of points in one colour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Its name in the legend; without a name it is not listed.
    pub name: String,
    /// (x, y) in the axes' units; `None`, or a number that has no place on its axis, leaves a gap.
    pub points: Vec<Option<(f64, f64)>>,
    /// Lines, marks or both.
    pub style: Style,
    /// What failed: crosses above the chart.
    pub failures: Vec<Failure>,
    /// The place in the order of colours, where it is not that among the series: charts of one figure can agree.
    pub colour: Option<usize>,
    /// When each point was, s: a marker beside an [`Animation`](super::Animation) goes by them.  Empty where the horizontal axis
    /// is the time, or nothing moves.
    pub times: Vec<f64>,
}

impl Series {
    /// Points joined by straight lines.
    pub fn line(name: impl Into<String>, points: impl IntoIterator<Item = Option<(f64, f64)>>) -> Series {
        Series { name: name.into(), points: points.into_iter().collect(), ..Series::default() }
    }

    /// Points drawn as marks.
    pub fn marks(name: impl Into<String>, points: impl IntoIterator<Item = Option<(f64, f64)>>) -> Series {
        Series { style: Style::Marks, ..Series::line(name, points) }
    }

    /// Marks joined by lines.
    pub fn marked_line(name: impl Into<String>, points: impl IntoIterator<Item = Option<(f64, f64)>>) -> Series {
        Series { style: Style::MarkedLine, ..Series::line(name, points) }
    }

    /// Areas, each with the corners from gap to gap, in a pale colour.
    pub fn areas(name: impl Into<String>, corners: impl IntoIterator<Item = Option<(f64, f64)>>) -> Series {
        Series { style: Style::Filled, ..Series::line(name, corners) }
    }

    /// The same series in the colour of this place.
    pub fn coloured(self, place: usize) -> Series {
        Series { colour: Some(place), ..self }
    }

    /// The same series with the time of each point, s.
    pub fn at_times(self, times: impl IntoIterator<Item = f64>) -> Series {
        Series { times: times.into_iter().collect(), ..self }
    }

    /// The same series with one more failure.
    pub fn failed(mut self, x: f64, label: impl Into<String>) -> Series {
        self.failures.push(Failure { x, label: label.into() });
        self
    }
}

/// How the points of a series are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// Joined by lines.
    #[default]
    Line,
    /// A dashed line: a reference to compare with.
    Dashed,
    /// Marks alone.
    Marks,
    /// Marks joined by lines.
    MarkedLine,
    /// Areas whose corners are the points from gap to gap.
    Filled,
}

/// A point of a series that has no y, because what should give it failed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Failure {
    /// Where it stands on the horizontal axis; what has no place on that, as NaN, stands at its left.
    pub x: f64,
    /// Why, in a word; written beside the cross.
    pub label: String,
}

/// A place on the horizontal axis at which something happened.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Instant {
    /// Where.
    pub x: f64,
    /// What; written above its line where there is room.
    pub name: String,
}

/// A triangle between (x, y), one decade further right, and along y ∝ x^order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slope {
    /// Left end.
    pub x: f64,
    /// Value at the left end.
    pub y: f64,
    /// Exponent, written beside the triangle.
    pub order: f64,
}
