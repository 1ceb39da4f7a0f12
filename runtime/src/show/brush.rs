//! Lines, discs, polygons, springs and text of an animation's picture.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::compact::{Spot, thinned};
use super::figure::{Canvas, FINE, Outcome, text};

/// A place on the picture in drawing units, where there is one.
pub(super) type Place = Option<Spot>;

/// Drawing units from pixels.
pub(super) fn fine((x, y): (f64, f64)) -> Place {
    let fine = (x * f64::from(FINE), y * f64::from(FINE));
    (fine.0.is_finite() && fine.1.is_finite()).then_some((fine.0.round() as i32, fine.1.round() as i32))
}

/// Lines between neighbours that are both there.
pub(super) fn stroke<B: DrawingBackend>(
    canvas: &Canvas<B>,
    places: impl IntoIterator<Item = Place>,
    style: ShapeStyle,
) -> Outcome<B> {
    let places: Vec<Place> = places.into_iter().collect();
    for piece in places.split(Option::is_none) {
        let mut piece: Vec<(i32, i32)> = piece.iter().flatten().copied().collect();
        piece.dedup();
        if piece.len() > 1 {
            canvas.draw(&PathElement::new(thinned(&piece), style))?;
        }
    }
    Ok(())
}

/// The inside of a polygon, if all its corners are there.
pub(super) fn fill<B: DrawingBackend>(
    canvas: &Canvas<B>,
    places: impl IntoIterator<Item = Place>,
    style: ShapeStyle,
) -> Outcome<B> {
    match places.into_iter().collect::<Option<Vec<(i32, i32)>>>() {
        Some(corners) => canvas.draw(&Polygon::new(corners, style)),
        None => Ok(()),
    }
}

/// A disc, or its edge.
pub(super) fn disc<B: DrawingBackend>(
    canvas: &Canvas<B>,
    place: Place,
    radius: i32,
    style: impl Into<ShapeStyle>,
) -> Outcome<B> {
    place.map_or(Ok(()), |place| canvas.draw(&Circle::new(place, radius, style)))
}

/// A spring between two places with coils of half this width, px.
pub(super) fn coils([from, to]: [(f64, f64); 2], half: f64) -> Vec<Place> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = if dx.hypot(dy) > 0.0 { dx.hypot(dy) } else { 1.0 };
    let (nx, ny) = (-half * dy / length, half * dx / length);
    let coil = |i: i32| {
        let along = 0.12 + 0.76 * f64::from(i) / 16.0;
        let side = if i == 0 || i == 16 { 0.0 } else { f64::from(2 * (i % 2) - 1) };
        fine((from.0 + along * dx + side * nx, from.1 + along * dy + side * ny))
    };
    std::iter::once(fine(from)).chain((0..=16).map(coil)).chain([fine(to)]).collect()
}

/// Writes text about a height, px.
pub(super) fn write<B: DrawingBackend>(
    canvas: &Canvas<B>,
    line: &str,
    (x, y): (i32, i32),
    anchor: HPos,
    (size, colour): (i32, RGBColor),
) -> Outcome<B> {
    let style = text(size).color(&colour).pos(Pos::new(anchor, VPos::Center));
    canvas.draw(&Text::new(line.to_owned(), (x * FINE, y * FINE), style))
}
