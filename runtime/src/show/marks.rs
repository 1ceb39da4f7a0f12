//! Lines, marks, crosses and slope triangles, placed in drawing units.

use super::compact::thinned;
use super::figure::{Canvas, FINE, Outcome, text};
use super::{Chart, Instant, Slope, Style, lettering};
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Colours that the colour-blind tell apart, ordered by contrast on white (Okabe and Ito, 2008, without yellow).
pub(super) const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

/// Lengths of dashes and gaps, px: of the first series with each colour, of the second and the third.
const DASHES: [Option<(i32, i32)>; 3] = [None, Some((10, 4)), Some((3, 4))];

/// How broad lines are, in drawing units.
const BROAD: i32 = 2 * FINE;

/// How much of a colour an area has, the rest is white: lines and names over it can be read.
const PALE: f64 = 0.35;

type Place = (i32, i32);

/// Colour, dashes and mark of one series.
pub(super) struct Pen {
    colour: RGBColor,
    /// Lengths of the dashes and of the gaps between them, px.
    dashes: Option<(i32, i32)>,
    shape: usize,
    style: Style,
}

impl Pen {
    /// The pen of a series of a chart.
    pub fn of(chart: &Chart, index: usize) -> Pen {
        let series = &chart.series[index];
        Pen::new(series.colour.unwrap_or(index), chart.colours(), series.style)
    }

    /// The pen of one of so many series.  After the last colour the lines have long dashes, then short ones; where that does not
    /// do either, the series are taken for a family and their colours run from dark to light.
    fn new(index: usize, count: usize, style: Style) -> Pen {
        let family = count > DASHES.len() * COLOURS.len();
        let dashes = match style {
            Style::Dashed => Some((6, 4)),
            _ if family => None,
            _ => DASHES[index / COLOURS.len()],
        };
        let colour = if family {
            ViridisRGB.get_color(0.9 * index as f64 / count as f64)
        } else {
            COLOURS[index % COLOURS.len()]
        };
        Pen { colour, dashes, shape: index % 5, style }
    }

    /// Lines between neighbours that are both there; a lone point is a dot, and so is what is shorter than a line is broad.
    pub fn line<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        points: impl Iterator<Item = Option<Place>>,
    ) -> Outcome<B> {
        if self.style == Style::Marks {
            return Ok(());
        }
        let points: Vec<Option<Place>> = points.collect();
        if self.style == Style::Filled {
            return self.areas(canvas, &points);
        }
        let stroke = self.colour.stroke_width(BROAD as u32);
        for piece in points.split(Option::is_none) {
            let mut piece: Vec<Place> = piece.iter().flatten().copied().collect();
            piece.dedup();
            let piece = thinned(&piece);
            match (piece.as_slice(), self.dashes) {
                ([], _) => {}
                ([dot, rest @ ..], _) if rest.iter().all(|place| is_near(*dot, *place)) => {
                    canvas.draw(&Circle::new(*dot, 2 * FINE, self.colour.filled()))?
                }
                (_, None) => canvas.draw(&PathElement::new(piece, stroke))?,
                (_, Some((dash, gap))) => {
                    canvas.draw(&DashedPathElement::new(piece, dash * FINE, gap * FINE, stroke))?
                }
            }
        }
        Ok(())
    }

    /// Areas with these corners, from gap to gap; what has no area, as in a legend, is a broad line.
    fn areas<B: DrawingBackend>(&self, canvas: &Canvas<B>, points: &[Option<Place>]) -> Outcome<B> {
        let pale = |part: u8| 255 - ((255.0 - f64::from(part)) * PALE) as u8;
        let colour = RGBColor(pale(self.colour.0), pale(self.colour.1), pale(self.colour.2));
        for corners in points.split(Option::is_none) {
            let corners: Vec<Place> = corners.iter().flatten().copied().collect();
            match corners.len() {
                0 => {}
                1 | 2 => canvas.draw(&PathElement::new(corners, colour.stroke_width(8 * FINE as u32)))?,
                _ => canvas.draw(&Polygon::new(corners, colour.filled()))?,
            }
        }
        Ok(())
    }

    /// A mark at each point that is there.
    pub fn marks<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        points: impl Iterator<Item = Option<Place>>,
    ) -> Outcome<B> {
        if !matches!(self.style, Style::Marks | Style::MarkedLine) {
            return Ok(());
        }
        for point in points.flatten() {
            self.mark(canvas, point)?;
        }
        Ok(())
    }

    fn mark<B: DrawingBackend>(&self, canvas: &Canvas<B>, (x, y): Place) -> Outcome<B> {
        let corners: &[Place] = match self.shape {
            0 => return canvas.draw(&Circle::new((x, y), 4 * FINE, self.colour.filled())),
            1 => &[(-35, -35), (35, -35), (35, 35), (-35, 35)],
            2 => &[(0, -48), (44, 32), (-44, 32)],
            3 => &[(0, -50), (50, 0), (0, 50), (-50, 0)],
            _ => &[(0, 48), (44, -32), (-44, -32)],
        };
        let corners: Vec<Place> = corners.iter().map(|(dx, dy)| (x + dx, y + dy)).collect();
        canvas.draw(&Polygon::new(corners, self.colour.filled()))
    }
}

/// Whether two places are no farther from each other than a line is broad.
fn is_near(a: Place, b: Place) -> bool {
    (a.0 - b.0).abs() <= BROAD && (a.1 - b.1).abs() <= BROAD
}

/// A row of crosses for what failed at these places from left to right; words stand after the last of a kind.
pub(super) fn crosses<B: DrawingBackend>(
    canvas: &Canvas<B>,
    pen: &Pen,
    row: i32,
    failures: &[(i32, &str)],
) -> Outcome<B> {
    for (index, (x, label)) in failures.iter().enumerate() {
        canvas.draw(&Cross::new((*x, row), 4 * FINE, pen.colour.stroke_width(2 * FINE as u32)))?;
        if failures.get(index + 1).is_none_or(|(_, next)| next != label) {
            let style = text(11).color(&pen.colour).pos(Pos::new(HPos::Left, VPos::Center));
            canvas.draw(&Text::new((*label).to_owned(), (x + 8 * FINE, row), style))?;
        }
    }
    Ok(())
}

/// More instants than these are ticks at the axis: lines would hide the curves.
const MOST_LINES: usize = 20;
/// The size of a name beside the line of an instant, and the length of a tick, px.
const NAME: i32 = 10;
const TICK: i32 = 8;

/// Longer names than these are shortened, in parts of their size: they stand above the frame.
const LONGEST_NAME: f64 = 9.0;

/// How high the names of instants stand above a frame, px; none where there are ticks alone.
pub(super) fn height_of_names(instants: &[Instant]) -> i32 {
    if instants.is_empty() || instants.len() > MOST_LINES {
        return 0;
    }
    let longest = instants.iter().map(|instant| lettering::width(&instant.name)).fold(0.0, f64::max);
    (longest.min(LONGEST_NAME) * f64::from(NAME)).ceil() as i32 + 4
}

/// Lines, or ticks where they are many, at these places from left to right, between the top of the frame and the axis; names stand
/// above the frame, between its top and where they end, but for those for which a neighbour leaves no room.
pub(super) fn instants<B: DrawingBackend>(
    canvas: &Canvas<B>,
    places: &[(i32, &str)],
    (names_end, top, bottom): (i32, i32, i32),
) -> Outcome<B> {
    let colour = RGBColor(110, 110, 110);
    let many = places.len() > MOST_LINES;
    let upper = if many { bottom - TICK * FINE } else { top };
    let mut taken = i32::MIN;
    for (x, name) in places {
        canvas.draw(&PathElement::new([(*x, bottom), (*x, upper)], colour.mix(0.6).stroke_width(FINE as u32)))?;
        if !many && *x > taken {
            let style = text(NAME).color(&colour).pos(Pos::new(HPos::Left, VPos::Center));
            let at = (*x, names_end - 2 * FINE);
            canvas.draw(&Text::new(
                lettering::fitted(name, LONGEST_NAME),
                at,
                style.transform(FontTransform::Rotate270),
            ))?;
            taken = x + (NAME + 2) * FINE;
        }
    }
    Ok(())
}

/// A right triangle over one decade, with its exponent.
pub(super) fn slope<B: DrawingBackend>(
    canvas: &Canvas<B>,
    slope: &Slope,
    place: &impl Fn(f64, f64) -> Place,
) -> Outcome<B> {
    let colour = RGBColor(110, 110, 110);
    let far = slope.y * 10f64.powf(slope.order);
    let corners = [(slope.x, slope.y), (10.0 * slope.x, slope.y), (10.0 * slope.x, far)].map(|(x, y)| place(x, y));
    let [start, corner, end] = corners;
    canvas.draw(&PathElement::new([start, corner, end, start], colour.stroke_width(FINE as u32)))?;
    let style = text(12).color(&colour).pos(Pos::new(HPos::Left, VPos::Center));
    let label = format!("{}", slope.order).replace('-', "−");
    canvas.draw(&Text::new(label, (corner.0 + 6 * FINE, (corner.1 + end.1) / 2), style))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pens_of_one_chart_differ() {
        for count in [2, 7, 8, 14, 15, 17, 21, 22, 40] {
            let pens = (0..count).map(|index| Pen::new(index, count, Style::MarkedLine));
            let mut looks: Vec<_> = pens.map(|pen| (pen.colour.0, pen.colour.1, pen.colour.2, pen.dashes)).collect();
            looks.sort_unstable();
            looks.dedup();
            assert_eq!(looks.len(), count);
        }
        // Few series are told apart by colour alone, as before.
        assert!((0..7).all(|index| Pen::new(index, 7, Style::Line).dashes.is_none()));
    }
}
