//! Names and colours of the series, to the right of a chart.

use super::figure::{Canvas, FINE, Outcome, text};
use super::lettering;
use super::marks::Pen;
use super::{Chart, Series};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

const LINE: i32 = 19;
const SAMPLE: i32 = 26;
const SIZE: i32 = 13;
/// The width of a longest name, in parts of its size.
const LONGEST: f64 = 20.0;

/// The width that a chart's names take, px; none where its series have no names, or one that its axis says already.
pub(super) fn width(chart: &Chart) -> Option<i32> {
    let named = || chart.series.iter().filter(|series| !series.name.is_empty());
    let said = chart.series.len() == 1 && named().all(|series| series.name == chart.y.label);
    let longest = named().map(|series| lettering::width(&series.name)).reduce(f64::max)?;
    (!said).then_some(SAMPLE + 24 + (longest.min(LONGEST) * f64::from(SIZE)).ceil() as i32)
}

/// Writes the names from (x, y) down, px; of more than there is room for, only every second, third …
pub(super) fn draw<B: DrawingBackend>(
    canvas: &Canvas<B>,
    chart: &Chart,
    (x, y, height): (i32, i32, i32),
) -> Outcome<B> {
    let named: Vec<(usize, &Series)> = chart.series.iter().enumerate().filter(|(_, s)| !s.name.is_empty()).collect();
    let stride = named.len().div_ceil((height / LINE).max(1) as usize);
    for (line, (index, series)) in named.into_iter().step_by(stride.max(1)).enumerate() {
        let middle = (y + LINE * line as i32 + LINE / 2) * FINE;
        let pen = Pen::of(chart, index);
        sample(canvas, &pen, x * FINE, middle)?;
        let style = text(SIZE).color(&RGBColor(51, 51, 51)).pos(Pos::new(HPos::Left, VPos::Center));
        canvas.draw(&Text::new(lettering::fitted(&series.name, LONGEST), ((x + SAMPLE + 8) * FINE, middle), style))?;
    }
    Ok(())
}

fn sample<B: DrawingBackend>(canvas: &Canvas<B>, pen: &Pen, x: i32, y: i32) -> Outcome<B> {
    let ends = [x, x + SAMPLE * FINE].map(|x| Some((x, y)));
    pen.line(canvas, ends.into_iter())?;
    pen.marks(canvas, std::iter::once(Some((x + SAMPLE * FINE / 2, y))))
}
