//! Charts laid out on one page and drawn by plotters.
//!
//! plotters places everything on whole pixels; it draws here on a grid of tenths of a pixel, which the
//! `viewBox` of the finished SVG scales back, so that curves are smooth.

use super::axis::Extent;
use super::compact::shortened;
use super::legend;
use super::lettering;
use super::marks::{Pen, crosses, height_of_names, instants, slope};
use super::vector::Vector;
use super::{Chart, Failure, Style};
use crate::error::Error;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::path::Path;
use std::sync::Arc;

/// Drawing units per pixel.
pub(super) const FINE: i32 = 10;
pub(super) type Canvas<B> = DrawingArea<B, Shift>;
pub(super) type Outcome<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// plotters writes text smaller than it is asked to by this factor.
pub(super) const PLOTTERS_SHRINKS: f64 = 1.24;
const FONT: &str = "Helvetica, Arial, sans-serif";
pub(super) const INK: RGBColor = RGBColor(51, 51, 51);
pub(super) const GRID: RGBColor = RGBColor(221, 221, 221);
const FINE_GRID: RGBColor = RGBColor(240, 240, 240);
pub(super) const ZERO: RGBColor = RGBColor(160, 160, 160);

/// Pixels of a PNG for one of the SVG's.
#[cfg(feature = "png")]
const SHARPER: f32 = 2.0;

const WIDTH: i32 = 860;
const MARGIN: i32 = 16;
const TITLE: i32 = 34;
const LEFT: i32 = 90;
const BELOW: i32 = 56;
/// The size of what stands at marks.
const TICK: i32 = 12;
/// Charts with more series are as tall as those with slopes.
const CROWD: usize = 7;
/// Height of a row of crosses, px.  They stand in rows above the frame, where there is no axis on which they would have a value.
const CROSSES: i32 = 14;

/// How far to the left of the frame crosses stand that have no place on the axis, px.
const SIDE: i32 = 14;

/// Charts on one page, one below the other or in columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// Row by row, from top to bottom.
    pub charts: Vec<Chart>,
    /// How many stand side by side; 0 is 1.  Of a row that has several the names of one chart stand for all.
    pub columns: usize,
}

impl From<Chart> for Figure {
    fn from(chart: Chart) -> Figure {
        Figure::from(vec![chart])
    }
}

impl From<Vec<Chart>> for Figure {
    fn from(charts: Vec<Chart>) -> Figure {
        Figure { charts, columns: 1 }
    }
}

/// A part of the page, px.
#[derive(Clone, Copy)]
struct Cell {
    left: i32,
    top: i32,
    width: i32,
    height: i32,
}

impl Figure {
    /// The figure as the text of an SVG file; it refers to no other file and to no special font.
    pub fn to_svg(&self) -> String {
        let layout = self.layout();
        let mut svg = String::new();
        let canvas = Vector::on(&mut svg, layout.fine()).into_drawing_area();
        draw(&canvas, &layout).expect("text in memory takes all that is drawn");
        drop(canvas);
        scaled_down(&svg, layout.size)
    }

    /// The figure as a PNG file, two pixels for one of the SVG's; its letters are those of DejaVu Sans, which is built in.
    ///
    /// ```
    /// use dalembert::show::{Axis, Chart, Figure, Series};
    /// let line = Series::line("x", [Some((0.0, 1.0)), Some((2.0, 3.0))]);
    /// let chart = Chart::new("a line", Axis::new("time", "s"), Axis::new("x", "m")).with(line);
    /// assert!(Figure::from(chart).to_png().starts_with(b"\x89PNG"));
    /// ```
    #[cfg(feature = "png")]
    pub fn to_png(&self) -> Vec<u8> {
        let layout = self.layout();
        let mut picture = super::raster::Picture::new(layout.fine(), SHARPER);
        let canvas = super::raster::Raster::on(&mut picture).into_drawing_area();
        draw(&canvas, &layout).expect("a picture in memory takes all that is drawn");
        drop(canvas);
        picture.to_png()
    }

    /// The figure as a PDF file of one page, as large as the SVG; its letters are outlines of those of DejaVu Sans.
    ///
    /// ```
    /// use dalembert::show::{Axis, Chart, Figure, Series};
    /// let line = Series::line("x", [Some((0.0, 1.0)), Some((2.0, 3.0))]);
    /// let chart = Chart::new("a line", Axis::new("time", "s"), Axis::new("x", "m")).with(line);
    /// assert!(Figure::from(chart).to_pdf().starts_with(b"%PDF"));
    /// ```
    #[cfg(feature = "png")]
    pub fn to_pdf(&self) -> Vec<u8> {
        let layout = self.layout();
        let mut page = super::pdf::Page::new(layout.fine());
        let canvas = super::raster::Raster::on(&mut page).into_drawing_area();
        draw(&canvas, &layout).expect("a page in memory takes all that is drawn");
        drop(canvas);
        page.into_pdf()
    }

    /// Writes the figure to a file: as PNG or PDF where its name ends in `.png` or `.pdf`, else as SVG.
    ///
    /// # Errors
    /// [`Error::File`]; [`Error::NeedsPng`] for a PNG or PDF where the crate was built without the feature `png`.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        let file = |problem| Error::File { path: path.to_owned(), problem: Arc::new(problem) };
        if !wants_letters(path) {
            return std::fs::write(path, self.to_svg()).map_err(file);
        }
        #[cfg(feature = "png")]
        return std::fs::write(path, if ends_in(path, "pdf") { self.to_pdf() } else { self.to_png() }).map_err(file);
        #[cfg(not(feature = "png"))]
        Err(Error::NeedsPng { path: path.to_owned() })
    }

    /// What stands where on the page.
    fn layout(&self) -> Layout<'_> {
        let columns = self.columns.max(1);
        let names = self.charts.iter().filter_map(legend::width).max().unwrap_or(0);
        let width = (WIDTH - names) / columns as i32;
        let rows: Vec<&[Chart]> = self.charts.chunks(columns).collect();
        let tallest = |row: &&[Chart]| row.iter().map(|chart| height(chart, width, rows.len())).max().unwrap_or(0);
        let heights: Vec<i32> = rows.iter().map(tallest).collect();
        let size = (WIDTH, heights.iter().sum::<i32>().max(1));
        Layout { rows, heights, width, size }
    }
}

/// Whether a figure's file, by its name, is of a format for which letters must be built in: PNG, PDF.
pub(crate) fn wants_letters(path: &Path) -> bool {
    ends_in(path, "png") || ends_in(path, "pdf")
}

pub(super) fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

/// Rows of charts, their heights, the width of a chart and the size of the page, px.
struct Layout<'a> {
    rows: Vec<&'a [Chart]>,
    heights: Vec<i32>,
    width: i32,
    size: (i32, i32),
}

impl Layout<'_> {
    /// The size of the page in drawing units.
    fn fine(&self) -> (u32, u32) {
        ((self.size.0 * FINE) as u32, (self.size.1 * FINE) as u32)
    }
}

fn draw<B: DrawingBackend>(canvas: &Canvas<B>, layout: &Layout<'_>) -> Outcome<B> {
    let Layout { rows, heights, width, .. } = layout;
    canvas.fill(&WHITE)?;
    let mut top = 0;
    for (row, height) in rows.iter().zip(heights) {
        let mut named = false;
        for (column, chart) in row.iter().enumerate() {
            let cell = Cell { left: column as i32 * width, top, width: *width, height: *height };
            let names = !named && legend::width(chart).is_some();
            draw_chart(chart, canvas, cell, names.then_some(row.len() as i32 * width))?;
            named |= names;
        }
        top += height;
    }
    canvas.present()
}

/// Height of a chart of this width on a page of so many rows, px; where axes are equal it follows the data.
fn height(chart: &Chart, width: i32, rows: usize) -> i32 {
    let tallest = 530;
    let around = TITLE + above(chart) + BELOW;
    let crowded = chart.series.len() > CROWD;
    match (chart.is_equal(), chart.slopes.is_empty() && !crowded, rows) {
        (true, ..) => {
            let (x, y) = fitted(chart);
            let inside = f64::from(width - LEFT - MARGIN).max(1.0);
            around + (inside * y.span() / x.span()).clamp(0.22 * f64::from(width), f64::from(tallest)) as i32
        }
        (false, false, _) => around + tallest,
        (false, true, 1) => around + 370,
        (false, true, 2) => around + 240,
        (false, true, _) => around + 170,
    }
}

/// Height of what stands between the title and the frame, px: names of instants, and below them a row of crosses for each series with
/// failures.
fn above(chart: &Chart) -> i32 {
    let rows = chart.series.iter().filter(|series| !series.failures.is_empty()).count() as i32;
    height_of_names(&chart.instants) + rows * CROSSES
}

/// Replaces the size in tenths of a pixel by one in pixels, and shortens the text.
pub(super) fn scaled_down(svg: &str, (width, height): (i32, i32)) -> String {
    let fine = format!("width=\"{}\" height=\"{}\"", width * FINE, height * FINE);
    shortened(&svg.replacen(&fine, &format!("width=\"{width}\" height=\"{height}\""), 1))
}

/// Draws a chart into its cell, and its names from a place to the right on, px, where they are wanted.
fn draw_chart<B: DrawingBackend>(chart: &Chart, canvas: &Canvas<B>, cell: Cell, names: Option<i32>) -> Outcome<B> {
    let title = if chart.title.is_empty() { MARGIN } else { TITLE };
    let Cell { left, top, height, .. } = cell;
    let frame = title + above(chart);
    let (width, inner_height) = (cell.width - LEFT - MARGIN, height - frame - BELOW);
    let (x, y) = extents(chart, width, inner_height);
    let fine = |pixels: i32| (pixels * FINE) as u32;
    let mut builder = ChartBuilder::on(canvas);
    builder
        .margin_top(fine(top + frame))
        .margin_bottom((canvas.dim_in_pixel().1 as i32 - (top + height) * FINE) as u32)
        .margin_left(fine(left))
        .margin_right(fine(WIDTH - left - cell.width + MARGIN))
        .x_label_area_size(fine(BELOW))
        .y_label_area_size(fine(LEFT));
    let mut context = builder.build_cartesian_2d(x.clone(), y.clone())?;
    context
        .configure_mesh()
        .bold_line_style(GRID.stroke_width(FINE as u32))
        .light_line_style(FINE_GRID.stroke_width(FINE as u32))
        .axis_style(ZERO.stroke_width(FINE as u32))
        .set_all_tick_mark_size(5 * FINE)
        .x_label_formatter(&|value| x.label(*value))
        .y_label_formatter(&|value| y.label(*value))
        .label_style(text(TICK).color(&INK))
        .draw()?;

    let place = |x: f64, y: f64| context.backend_coord(&(x, y));
    if x.crosses_zero() {
        canvas.draw(&PathElement::new([place(0.0, y.at(0.0)), place(0.0, y.at(1.0))], ZERO.stroke_width(12)))?;
    }
    if y.crosses_zero() {
        canvas.draw(&PathElement::new([place(x.at(0.0), 0.0), place(x.at(1.0), 0.0)], ZERO.stroke_width(12)))?;
    }
    let happened = chart.instants.iter().filter(|instant| chart.x.has(instant.x) && x.contains(instant.x));
    let happened: Vec<_> = happened.map(|instant| (place(instant.x, y.at(0.0)).0, instant.name.as_str())).collect();
    let names_end = top + title + height_of_names(&chart.instants);
    instants(canvas, &happened, (names_end * FINE, (top + frame) * FINE, (top + frame + inner_height) * FINE))?;
    let mut rows = (0..).map(|row| (names_end + row * CROSSES + CROSSES / 2) * FINE);
    for (index, series) in chart.series.iter().enumerate() {
        let pen = Pen::of(chart, index);
        let inside = |&(a, b): &(f64, f64)| chart.x.has(a) && chart.y.has(b) && x.contains(a) && y.contains(b);
        let points = series.points.iter().map(|point| point.filter(inside).map(|(a, b)| place(a, b)));
        let there = |&(a, b): &(f64, f64)| chart.x.has(a) && chart.y.has(b);
        let line: Vec<_> = series.points.iter().map(|point| point.filter(there)).collect();
        let at = |(a, b): (f64, f64)| place(x.at(a), y.at(b));
        let fractions = line.iter().map(|point| point.map(|(a, b)| (x.fraction(a), y.fraction(b))));
        pen.line(canvas, within(fractions).into_iter().map(|point| point.map(at)))?;
        pen.marks(canvas, points)?;
        // What has no place on the axis stands at its side.
        let side = |failure: &Failure| match chart.x.has(failure.x) && x.contains(failure.x) {
            true => place(failure.x, y.at(1.0)).0,
            false => (left + LEFT - SIDE) * FINE,
        };
        let failures: Vec<_> = series.failures.iter().map(|failure| (side(failure), failure.label.as_str())).collect();
        if !failures.is_empty()
            && let Some(row) = rows.next()
        {
            crosses(canvas, &pen, row, &failures)?;
        }
    }
    for triangle in &chart.slopes {
        slope(canvas, triangle, &place)?;
    }
    if let Some(right) = names {
        legend::draw(canvas, chart, (right + 14 - MARGIN, top + frame + 4, inner_height))?;
    }
    let (middle, bottom) = (left + LEFT + width / 2, top + height);
    let about = |middle: i32, far: i32| f64::from(2 * middle.min(far - middle));
    // To the right of the last one in a row there are names at most.
    let last = left + 2 * cell.width > WIDTH;
    let room = about(middle - left, if last { WIDTH - left } else { cell.width });
    write(canvas, (&chart.title, room), (middle, top + TITLE / 2), &[16, 14, 12], FontTransform::None)?;
    write(canvas, (&x.text(&chart.x), room), (middle, bottom - 18), &[14, 12], FontTransform::None)?;
    let (middle, room) = (top + frame + inner_height / 2, about(frame + inner_height / 2, height));
    write(canvas, (&y.text(&chart.y), room), (left + 11, middle), &[14, 12, 10], FontTransform::Rotate270)
}

/// A line in fractions of both axes without what is outside of the frame, cut where it crosses that.
fn within(points: impl Iterator<Item = Option<(f64, f64)>>) -> Vec<Option<(f64, f64)>> {
    let mut kept: Vec<Option<(f64, f64)>> = Vec::new();
    let mut last: Option<(f64, f64)> = None;
    let inside = |(x, y): (f64, f64)| [x, y].iter().all(|part| (-EDGE..=1.0 + EDGE).contains(part));
    for point in points {
        match (last, point) {
            (Some(a), Some(b)) if !(inside(a) && inside(b)) => match cut(a, b) {
                Some((begin, end)) => {
                    let begins = (!inside(a)).then_some([None, Some(begin)]);
                    kept.extend(begins.into_iter().flatten());
                    kept.push(Some(end));
                }
                None => kept.push(None),
            },
            (_, point) => kept.push(point.filter(|point| inside(*point))),
        }
        last = point;
    }
    kept
}

/// What is this near to the frame, in parts of it, is inside.
const EDGE: f64 = 1e-9;

/// The part of a straight piece that lies in the unit square (Liang and Barsky 1984).
fn cut(a: (f64, f64), b: (f64, f64)) -> Option<((f64, f64), (f64, f64))> {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for (start, end) in [(a.0, b.0), (a.1, b.1)] {
        let along = end - start;
        let (low, high) = (-start / along, (1.0 - start) / along);
        if along == 0.0 {
            if !(0.0..=1.0).contains(&start) {
                return None;
            }
            continue;
        }
        from = from.max(low.min(high));
        to = to.min(low.max(high));
    }
    let at = |part: f64| (a.0 + part * (b.0 - a.0), a.1 + part * (b.1 - a.1));
    (from < to).then(|| (at(from), at(to)))
}

/// Writes text about a middle, in the first of these sizes for which there is room, px; in the last, what there is room for.
fn write<B: DrawingBackend>(
    canvas: &Canvas<B>,
    (line, room): (&str, f64),
    (x, y): (i32, i32),
    sizes: &[i32],
    turned: FontTransform,
) -> Outcome<B> {
    let fits = |size: &&i32| lettering::width(line) * f64::from(**size) <= room;
    let size = *sizes.iter().find(fits).or(sizes.last()).unwrap_or(&1);
    let style = text(size).color(&INK).pos(Pos::new(HPos::Center, VPos::Center)).transform(turned);
    canvas.draw(&Text::new(lettering::fitted(line, room / f64::from(size)), (x * FINE, y * FINE), style))
}

/// A size of the figure's font, px.
pub(super) fn text(size: i32) -> TextStyle<'static> {
    (FONT, f64::from(size * FINE) * PLOTTERS_SHRINKS).into()
}

/// Axes for a chart of this inner size, px.
fn extents(chart: &Chart, width: i32, height: i32) -> (Extent, Extent) {
    let (mut x, mut y) = fitted(chart);
    if chart.is_equal() {
        Extent::make_equal(&mut x, &mut y, f64::from(width), f64::from(height));
    }
    let names = |room: i32| f64::from(room) / f64::from(TICK);
    (x.with_ticks(width as usize / 80, names(width)), y.with_ticks(height as usize / 45, names(height)))
}

/// Ends of both axes, fitted to the points that have a place on both.
fn fitted(chart: &Chart) -> (Extent, Extent) {
    let has_marks = chart.series.iter().any(|s| matches!(s.style, Style::Marks | Style::MarkedLine));
    let points = || chart.series.iter().flat_map(|s| s.points.iter().flatten());
    let shown = || points().filter(|(x, y)| chart.x.has(*x) && chart.y.has(*y));
    let failures = chart.series.iter().flat_map(|s| s.failures.iter().map(|failure| failure.x));
    let x_pad = if chart.equal || has_marks { 0.05 } else { 0.0 };
    let mut x = Extent::fit(&chart.x, shown().map(|p| p.0).chain(failures), x_pad);
    let mut y = Extent::fit(&chart.y, shown().map(|p| p.1), 0.06);
    if chart.is_equal() {
        Extent::narrow(&mut x, &mut y);
    }
    (x, y)
}
