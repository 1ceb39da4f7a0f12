//! An animated mechanism: what moves, and its HTML page.

use super::arrows::Arrows;
use super::curves::{self, multiple, unit};
use super::extent::Extent;
use super::figure::ends_in;
use super::{Chart, Instant};
#[cfg(feature = "png")]
use super::{figure::scaled_down, stage::Stage, vector::Vector};
use crate::error::Error;
use crate::mechanism::{Description, Shape};
#[cfg(feature = "png")]
use plotters::prelude::IntoDrawingArea;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

/// What a page animates: shapes, and where their points are at some times.
///
/// The page draws the shapes in a canvas, with play and pause (space bar), a slider, a choice of speeds and
/// equal axes that hold the whole motion; in space the view is orthographic, turns with the mouse and zooms with its wheel.  It is
/// one file that loads nothing.
///
/// ```
/// use dalembert::mechanism::Shape;
/// use dalembert::show::Animation;
/// let swing = (0..=100).map(|i| f64::from(i) / 10.0).map(|t| {
///     let angle = 0.5 * t.cos();
///     (t, vec![0.0, 0.0, angle.sin(), -angle.cos()])
/// });
/// let page = Animation::new("Pendulum", 2, vec![Shape::Line(2)]).with_frames(swing).to_html();
/// assert!(page.contains("Pendulum"));
/// ```
///
/// Charts stand beside the mechanism, or below it where the window is narrow.  In each a marker runs along the curves,
/// and clicking or dragging sets the time:
///
/// ```
/// use dalembert::mechanism::Shape;
/// use dalembert::show::{Animation, Axis, Chart, Series};
/// let times = || (0..=100).map(|i| f64::from(i) / 10.0);
/// let angle = |t: f64| 0.5 * t.cos();
/// let bar = times().map(|t| (t, vec![0.0, 0.0, angle(t).sin(), -angle(t).cos()]));
/// let curve = Series::line("theta", times().map(|t| Some((t, angle(t)))));
/// let chart = Chart::new("", Axis::new("time", "s"), Axis::new("theta", "rad")).with(curve);
/// let page = Animation::new("Pendulum", 2, vec![Shape::Line(2)]).with_frames(bar).with_chart(chart).to_html();
/// assert!(page.contains("theta (rad)"));
/// ```
///
/// Of a run: `run.animation().with_chart(run.history(&["theta"])?)`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation {
    /// The heading.
    pub title: String,
    /// A line beside the heading; may be empty.
    pub about: String,
    /// Components of each point, 2 or 3.
    pub dimension: u32,
    /// What is drawn.
    pub shapes: Vec<Shape>,
    /// Times in rising order, each with the numbers of all shapes in order, as `System::drawing` writes them, and of [`Animation::arrows`].
    /// Numbers that are not finite leave a gap.
    pub frames: Vec<(f64, Vec<f64>)>,
    /// Whether lengths are in metres and times in seconds; a model without units leaves that open.
    pub in_units: bool,
    /// What is up in space: the axis of the ground that is nearest to this direction; z where it is zero.
    pub up: [f64; 3],
    /// Starts again at the end, as a mode shape does: then the last frame should equal the first.
    pub repeat: bool,
    /// What stands beside the mechanism: over the time of the frames, or over anything else where the series tell their
    /// [`times`](super::Series::times).  Failures and slopes are left out.
    pub charts: Vec<Chart>,
    /// Arrows over the mechanism, as [`Animation::with_arrows`] adds them.
    pub arrows: Option<Arrows>,
    /// What happened, and when: it is written over the mechanism for half a second.
    pub events: Vec<Instant>,
}

impl Animation {
    /// An animation without frames.
    pub fn new(title: impl Into<String>, dimension: u32, shapes: Vec<Shape>) -> Animation {
        Animation { title: title.into(), dimension, shapes, ..Animation::default() }
    }

    /// An animation of what a mechanism draws, without frames.
    pub fn of(mechanism: &Description) -> Animation {
        let about = mechanism.about.to_string();
        let dimension = mechanism.structure.dimension;
        let of_coordinates = mechanism.coordinates.iter().map(|coordinate| &coordinate.unit);
        let units = of_coordinates.chain(mechanism.parameters.iter().map(|parameter| &parameter.unit));
        let in_units = units.into_iter().any(|unit| !matches!(unit.as_ref(), "" | "1" | "rad"));
        let shapes = mechanism.draw.to_vec();
        let up = mechanism.gravity.map(|component| -component);
        Animation { about, in_units, up, ..Animation::new(mechanism.name.clone(), dimension, shapes) }
    }

    /// The same animation with these frames.
    pub fn with_frames(self, frames: impl IntoIterator<Item = (f64, Vec<f64>)>) -> Animation {
        Animation { frames: frames.into_iter().collect(), ..self }
    }

    /// The same animation with one more chart beside the mechanism.
    pub fn with_chart(mut self, chart: Chart) -> Animation {
        self.charts.push(chart);
        self
    }

    /// The text of the page.
    pub fn to_html(&self) -> String {
        // In a script element `<` could end the element; JSON may write it as an escape.
        let data = self.upright().data().to_string().replace('<', "\\u003c");
        let over = if self.arrows.is_some() || !self.events.is_empty() { include_str!("arrows.js") } else { "" };
        let script = [include_str!("curves.js"), include_str!("solids.js"), include_str!("page.js"), over].concat();
        include_str!("page.html").replace("@SCRIPT@", &script).replace("@DATA@", &data)
    }

    /// The first frame as the text of an SVG file, as pictures that move begin; charts are left out.
    ///
    /// ```
    /// use dalembert::mechanism::Shape;
    /// use dalembert::show::Animation;
    /// let rod = Animation::new("Rod", 2, vec![Shape::Line(2)]).with_frames([(0.0, vec![0.0, 0.0, 1.0, 0.0])]);
    /// assert!(rod.to_svg().starts_with("<svg"));
    /// ```
    #[cfg(feature = "png")]
    pub fn to_svg(&self) -> String {
        let stage = Stage::of(self);
        let mut svg = String::new();
        let canvas = Vector::on(&mut svg, stage.fine()).into_drawing_area();
        let start = self.frames.first().map_or(0.0, |(time, _)| *time);
        let drawn = stage.draw_background(&canvas).and_then(|()| stage.draw(&canvas, start));
        drawn.expect("text in memory takes all that is drawn");
        drop(canvas);
        scaled_down(&svg, stage.size())
    }

    /// Writes the animation to a file: as a picture that moves where its name ends in `.png` or `.gif`, its first frame where it ends in
    /// `.svg`, else as a page.
    ///
    /// # Errors
    /// [`Error::File`]; [`Error::NeedsPng`] for a picture where the crate was built without the feature `png`.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        let file = |problem| Error::File { path: path.to_owned(), problem: Arc::new(problem) };
        if !is_picture(path) {
            return std::fs::write(path, self.to_html()).map_err(file);
        }
        #[cfg(feature = "png")]
        return std::fs::write(path, self.picture(path)).map_err(file);
        #[cfg(not(feature = "png"))]
        Err(Error::NeedsPng { path: path.to_owned() })
    }

    /// The bytes of a picture in the format that its file's name ends in.
    #[cfg(feature = "png")]
    fn picture(&self, path: &Path) -> Vec<u8> {
        if ends_in(path, "svg") {
            self.to_svg().into_bytes()
        } else if ends_in(path, "gif") {
            self.to_gif()
        } else {
            self.to_png()
        }
    }

    /// Everything that the page knows; lengths and times are whole multiples of a millionth of their range or
    /// less, and of each frame only the numbers that ever change are there.  What is up is z.
    fn data(&self) -> Value {
        let Extent { low, high, reach } = Extent::of(self);
        let unit = unit(self.frames.iter().flat_map(|(_, numbers)| numbers));
        let tick = curves::unit(self.frames.iter().map(|(time, _)| time));
        let first = self.frames.first().map_or(&[][..], |(_, numbers)| numbers);
        let moves = |k: &usize| self.frames.iter().any(|(_, numbers)| numbers.get(*k) != first.get(*k));
        let moving: Vec<usize> = (0..first.len()).filter(moves).collect();
        let changes = |numbers: &[f64]| -> Vec<Value> {
            moving.iter().map(|k| multiple(numbers.get(*k).copied().unwrap_or(f64::NAN), unit)).collect()
        };
        let mut data = json!({
            "title": self.title,
            "about": self.about,
            "dimension": self.dimension,
            "repeat": self.repeat,
            "low": low,
            "high": high,
            "reach": reach,
            "axes": self.ground_axes(),
            "units": if self.in_units { [" m", " s"] } else { ["", ""] },
            "unit": unit,
            "tick": tick,
            "shapes": self.shapes.iter().map(kind_and_points).collect::<Vec<_>>(),
            "time": self.frames.iter().map(|(time, _)| multiple(*time, tick)).collect::<Vec<_>>(),
            "first": first.iter().map(|x| multiple(*x, unit)).collect::<Vec<_>>(),
            "moving": moving,
            "frames": self.frames.iter().map(|(_, numbers)| changes(numbers)).collect::<Vec<_>>(),
            "charts": self.charts.iter().map(curves::data).collect::<Vec<_>>(),
        });
        if let Some(Arrows { names, length, longest, .. }) = &self.arrows {
            let text = self.arrows.as_ref().map(Arrows::text);
            data["arrows"] = json!({ "names": names, "text": text, "length": length, "longest": longest });
        }
        if !self.events.is_empty() {
            data["events"] = self.events.iter().map(|event| json!([event.x, event.name])).collect();
        }
        data
    }
}

/// Whether an animation is to be a picture, by its file's name: one that moves, or its first frame.
pub(crate) fn is_picture(path: &Path) -> bool {
    is_film(path) || ends_in(path, "svg")
}

/// Whether it is to be a picture that moves.
pub(crate) fn is_film(path: &Path) -> bool {
    ends_in(path, "png") || ends_in(path, "gif")
}

fn kind_and_points(shape: &Shape) -> Value {
    match shape {
        Shape::Line(points) => json!(["line", points]),
        Shape::Circle => json!(["circle", 1]),
        Shape::Spring => json!(["spring", 2]),
        Shape::Curve(points) => json!(["curve", points]),
        Shape::Trace(name) => json!(["trace", 1, name]),
        Shape::Ring => json!(["ring", 2]),
        Shape::Disc => json!(["disc", 2]),
        Shape::Cylinder => json!(["cylinder", 2]),
        Shape::Sphere => json!(["sphere", 1]),
        Shape::Box => json!(["box", 4]),
        Shape::Ellipsoid => json!(["ellipsoid", 4]),
        Shape::Plane => json!(["plane", 2]),
        Shape::Axes | Shape::UnitAxes => json!(["axes", 4]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::show::{Axis, Series};

    fn data(page: &str) -> Value {
        let begin = page.find("application/json\">").unwrap() + "application/json\">".len();
        let end = begin + page[begin..].find("</script>").unwrap();
        serde_json::from_str(&page[begin..end]).unwrap()
    }

    #[test]
    fn numbers_come_back_to_six_digits() {
        let frames: Vec<(f64, Vec<f64>)> =
            (0..50).map(f64::from).map(|i| (i / 50.0, vec![1e3 + i.sin(), i.cos()])).collect();
        let data = data(&Animation::new("Bob", 2, vec![Shape::Line(1)]).with_frames(frames.clone()).to_html());
        let [unit, tick] = ["unit", "tick"].map(|name| data[name].as_f64().unwrap());
        for (index, (time, numbers)) in frames.iter().enumerate() {
            assert!((data["time"][index].as_f64().unwrap() * tick - time).abs() < 1e-6);
            for (k, x) in numbers.iter().enumerate() {
                assert!((data["frames"][index][k].as_f64().unwrap() * unit - x).abs() < 1e-6 * 1001.0);
            }
        }
    }

    #[test]
    fn numbers_that_are_not_finite_are_absent() {
        let frames = [(0.0, vec![0.0, f64::NAN]), (1.0, vec![f64::INFINITY, 1.0])];
        let data = data(&Animation::new("Bob", 2, vec![Shape::Line(1)]).with_frames(frames).to_html());
        assert!(data["first"][1].is_null() && data["frames"][0][1].is_null() && data["frames"][1][0].is_null());
        assert!(data["first"][0].is_i64() && data["frames"][1][1].is_i64());
    }

    #[test]
    fn what_stands_still_is_written_once() {
        let frames = (0..9).map(|i| (f64::from(i), vec![1.0, 2.0, f64::from(i), 4.0]));
        let data = data(&Animation::new("Bar", 2, vec![Shape::Line(2)]).with_frames(frames).to_html());
        assert_eq!((data["first"].as_array().unwrap().len(), &data["moving"]), (4, &json!([2])));
        assert_eq!(data["frames"][8].as_array().unwrap().len(), 1);
    }

    #[test]
    fn extreme_numbers_have_a_unit() {
        for frame in [vec![], vec![0.0, 0.0], vec![5e-324, 0.0], vec![f64::MAX, f64::MIN]] {
            let data = data(&Animation::new("Bob", 2, vec![Shape::Line(1)]).with_frames([(0.0, frame)]).to_html());
            assert!(data["unit"].as_f64().unwrap() > 0.0);
        }
    }

    #[test]
    fn a_page_has_the_curves_that_it_is_given_and_no_others() {
        let bare = data(&Animation::new("Bob", 2, Vec::new()).to_html());
        assert_eq!(bare["charts"], json!([]));
        let points = (0..=10).map(|i| (i != 5).then_some((f64::from(i), 0.5 * f64::from(i))));
        let chart = Chart::new("", Axis::new("time", "s"), Axis::new("x", "mm"));
        let history = chart.clone().with(Series::line("x", points.clone()));
        let portrait = chart.with(Series::marks("p", points).coloured(4).at_times((0..=10).map(f64::from)));
        let page = Animation::new("Bob", 2, Vec::new()).with_chart(history).with_chart(portrait).to_html();
        let charts = &data(&page)["charts"];
        assert_eq!((&charts[0]["x"]["text"], &charts[0]["y"]["text"]), (&json!("time (s)"), &json!("x (mm)")));
        let series = &charts[0]["series"][0];
        assert_eq!((&series["name"], &series["t"]), (&json!("x"), &Value::Null));
        let unit = series["y"]["unit"].as_f64().unwrap();
        assert_eq!(series["y"]["values"][9].as_f64().unwrap() * unit, 4.5);
        assert!(series["y"]["values"][5].is_null());
        let series = &charts[1]["series"][0];
        assert_eq!((&series["colour"], &series["line"], &series["marks"]), (&json!(4), &json!(false), &json!(true)));
        assert_eq!(series["t"]["values"].as_array().unwrap().len(), 11);
    }

    #[test]
    fn a_page_is_small_beside_its_data() {
        assert!(Animation::new("Bob", 3, vec![Shape::Disc]).to_html().len() < 40_000);
    }

    #[test]
    fn what_is_up_is_z_in_a_page() {
        let frames = [(0.0, vec![0.0, 0.0, -2.0, 1.0])];
        let animation = Animation { up: [0.0, 0.0, -9.81], ..Animation::new("Ball", 3, vec![Shape::Sphere]) };
        let data = data(&animation.with_frames(frames).to_html());
        assert_eq!((&data["shapes"], &data["axes"][2]), (&json!([["sphere", 1]]), &json!([0.0, 0.0, -1.0])));
        assert_eq!((&data["low"], &data["high"]), (&json!([-1.0, -1.0, 1.0]), &json!([1.0, 1.0, 3.0])));
        assert_eq!(data["reach"], json!(1.0));
    }

    #[test]
    fn the_page_loads_nothing() {
        let page =
            Animation::new("Bob", 3, vec![Shape::Spring, Shape::Circle]).with_frames([(0.0, vec![0.0; 10])]).to_html();
        for outside in ["http:", "https:", "src=", "href=", "url(", "import", "fetch("] {
            assert!(!page.contains(outside), "{outside}");
        }
    }

    #[test]
    fn text_cannot_leave_its_place() {
        let title = "</script><script>alert(1)</script>@SCRIPT@@DATA@<!--";
        let page = Animation::new(title, 2, Vec::new()).to_html();
        assert_eq!(page.matches("</script>").count(), 2);
        assert_eq!(data(&page)["title"], title);
    }

    #[cfg(not(feature = "png"))]
    #[test]
    fn a_picture_needs_a_feature() {
        for name in ["film.png", "film.GIF"] {
            let error = Animation::new("Bob", 2, Vec::new()).write(name).unwrap_err().to_string();
            assert!(error.contains(name) && error.contains("feature `png`"), "{error}");
            assert!(!std::fs::exists(name).unwrap());
        }
    }
}
