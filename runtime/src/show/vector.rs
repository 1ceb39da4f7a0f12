//! The backend that writes SVG: that of plotters, but for how large text is.
//!
//! Where plotters is compiled for a browser it asks the page that is shown, and a worker has none.

use super::figure::PLOTTERS_SHRINKS;
use plotters::prelude::SVGBackend;
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind};
use std::io;

/// Writes SVG to a text.
pub(super) struct Vector<'a>(SVGBackend<'a>);

impl<'a> Vector<'a> {
    /// Writes a picture of this size to this text.
    pub fn on(text: &'a mut String, size: (u32, u32)) -> Vector<'a> {
        Vector(SVGBackend::with_string(text, size))
    }
}

type Drawn = Result<(), DrawingErrorKind<io::Error>>;

impl DrawingBackend for Vector<'_> {
    type ErrorType = io::Error;

    fn get_size(&self) -> (u32, u32) {
        self.0.get_size()
    }

    fn ensure_prepared(&mut self) -> Drawn {
        self.0.ensure_prepared()
    }

    fn present(&mut self) -> Drawn {
        self.0.present()
    }

    fn draw_pixel(&mut self, place: BackendCoord, colour: BackendColor) -> Drawn {
        self.0.draw_pixel(place, colour)
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.0.draw_line(from, to, style)
    }

    fn draw_rect<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S, fill: bool) -> Drawn {
        self.0.draw_rect(from, to, style, fill)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Drawn {
        self.0.draw_path(path, style)
    }

    fn draw_circle<S: BackendStyle>(&mut self, centre: BackendCoord, radius: u32, style: &S, fill: bool) -> Drawn {
        self.0.draw_circle(centre, radius, style, fill)
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, corners: I, style: &S) -> Drawn {
        self.0.fill_polygon(corners, style)
    }

    fn draw_text<T: BackendTextStyle>(&mut self, text: &str, style: &T, place: BackendCoord) -> Drawn {
        self.0.draw_text(text, style, place)
    }

    /// What plotters takes where it knows no font.
    fn estimate_text_size<T: BackendTextStyle>(
        &self,
        text: &str,
        style: &T,
    ) -> Result<(u32, u32), DrawingErrorKind<io::Error>> {
        let em = style.size() / PLOTTERS_SHRINKS / PLOTTERS_SHRINKS;
        let width = (em * 0.7 * text.len() as f64).round();
        Ok((width as u32, (em.round() + (em * 0.24).round()) as u32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::show::figure::text;

    #[test]
    fn text_is_as_large_as_plotters_takes_it_without_fonts() {
        let (mut ours, mut theirs) = (String::new(), String::new());
        let (ours, theirs) = (Vector::on(&mut ours, (9, 9)), SVGBackend::with_string(&mut theirs, (9, 9)));
        for label in ["", "0.5", "theta1'", "−20 °C"] {
            for size in [10, 12, 14, 16] {
                let style = text(size);
                let size = |found: Result<(u32, u32), _>| {
                    found.unwrap_or_else(|_: DrawingErrorKind<io::Error>| panic!("{label}"))
                };
                assert_eq!(
                    size(ours.estimate_text_size(label, &style)),
                    size(theirs.estimate_text_size(label, &style))
                );
            }
        }
    }
}
