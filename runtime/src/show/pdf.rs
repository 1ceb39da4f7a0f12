//! Charts as a PDF: the paths that `raster.rs` would fill and stroke, letters too, on one page.

use pdf_writer::types::LineJoinStyle;
use pdf_writer::{Content, Filter, Finish, Pdf, Rect, Ref};
use plotters_backend::BackendColor;
use zeno::Command;

use super::figure::FINE;
use super::raster::Surface;

/// Points of 1/72 inch for a pixel of the SVG, of which an inch has 96.
const POINTS: f32 = 0.75;
/// How hard the page is compressed, of 10.
const EFFORT: u8 = 6;

/// A page.
pub(super) struct Page {
    /// In drawing units.
    size: (u32, u32),
    content: Content,
}

impl Page {
    /// An empty page of this size in drawing units.
    pub fn new(size: (u32, u32)) -> Page {
        let mut content = Content::new();
        // Drawings run down from the upper left corner, pages up from the lower left one.
        content.transform([1.0, 0.0, 0.0, -1.0, 0.0, size.1 as f32 * POINTS / FINE as f32]);
        content.set_line_join(LineJoinStyle::RoundJoin);
        Page { size, content }
    }

    /// The page as a file.
    pub fn into_pdf(self) -> Vec<u8> {
        let [catalog, pages, page, contents] = [1, 2, 3, 4].map(Ref::new);
        let [width, height] = [self.size.0, self.size.1].map(|length| length as f32 * POINTS / FINE as f32);
        let mut pdf = Pdf::new();
        pdf.catalog(catalog).pages(pages);
        pdf.pages(pages).kids([page]).count(1);
        let mut only = pdf.page(page);
        only.parent(pages).media_box(Rect::new(0.0, 0.0, width, height)).contents(contents);
        only.resources();
        only.finish();
        let drawn = self.content.finish();
        let packed = miniz_oxide::deflate::compress_to_vec_zlib(drawn.as_slice(), EFFORT);
        pdf.stream(contents, &packed).filter(Filter::FlateDecode);
        pdf.finish()
    }

    fn path(&mut self, path: &[Command]) {
        let mut last = (0.0, 0.0);
        for command in path {
            match command {
                Command::MoveTo(to) => {
                    self.content.move_to(to.x, to.y);
                    last = (to.x, to.y);
                }
                Command::LineTo(to) => {
                    self.content.line_to(to.x, to.y);
                    last = (to.x, to.y);
                }
                // The cubic curve that is the same.
                Command::QuadTo(by, to) => {
                    let towards = |from: f32, by: f32| from + (by - from) * 2.0 / 3.0;
                    let first = (towards(last.0, by.x), towards(last.1, by.y));
                    let second = (towards(to.x, by.x), towards(to.y, by.y));
                    self.content.cubic_to(first.0, first.1, second.0, second.1, to.x, to.y);
                    last = (to.x, to.y);
                }
                Command::CurveTo(first, second, to) => {
                    self.content.cubic_to(first.x, first.y, second.x, second.y, to.x, to.y);
                    last = (to.x, to.y);
                }
                Command::Close => {
                    self.content.close_path();
                }
            }
        }
    }
}

/// What a colour is on white paper.
fn on_white(colour: BackendColor) -> [f32; 3] {
    let (r, g, b) = colour.rgb;
    [r, g, b].map(|part| (1.0 + colour.alpha * (f64::from(part) / 255.0 - 1.0)) as f32)
}

impl Surface for Page {
    fn size(&self) -> (u32, u32) {
        self.size
    }

    fn scale(&self) -> f32 {
        POINTS / FINE as f32
    }

    fn fill(&mut self, path: &[Command], colour: BackendColor) {
        let [r, g, b] = on_white(colour);
        self.content.set_fill_rgb(r, g, b);
        self.path(path);
        self.content.fill_nonzero();
    }

    fn stroke(&mut self, path: &[Command], width: f32, colour: BackendColor) {
        let [r, g, b] = on_white(colour);
        self.content.set_stroke_rgb(r, g, b).set_line_width(width);
        self.path(path);
        self.content.stroke();
    }
}

#[cfg(test)]
mod tests {
    use crate::show::{Axis, Chart, Figure, Series};

    /// The numbers before an operator of the page.
    fn drawn(file: &[u8]) -> String {
        let text = String::from_utf8_lossy(file);
        let from = text.find("stream\n").expect("a stream");
        // Offsets in bytes: what stands before is ASCII but for the four bytes of the header's comment.
        let from = file.windows(7).position(|window| window == b"stream\n").unwrap_or(from) + 7;
        let packed = &file[from..];
        String::from_utf8(miniz_oxide::inflate::decompress_to_vec_zlib(packed).expect("packed")).expect("text")
    }

    /// The page has the size of the SVG in points, and the line its colour, its width and its places.
    #[test]
    fn a_page_has_what_the_svg_has() {
        let line = Series::line("", (0..=10).map(|i| Some((f64::from(i), f64::from(i)))));
        let chart = Chart::new("Pendulum", Axis::new("time", "s"), Axis::new("ω", "rad/s")).with(line);
        let figure = Figure::from(chart);
        let (svg, pdf) = (figure.to_svg(), figure.to_pdf());
        let number = |name: &str| -> f64 {
            svg.split(&format!("{name}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
        };
        let size = format!("/MediaBox [0 0 {} {}]", number("width") * 0.75, number("height") * 0.75);
        assert!(String::from_utf8_lossy(&pdf).contains(&size), "{size}");
        let page = drawn(&pdf);
        let (_, curve) = page.split_once("0 0.44705883 0.69803923 RG\n1.5 w\n").expect("a blue line, 1.5 points wide");
        let places: Vec<f64> =
            curve.split(['m', 'l']).next().unwrap().split_whitespace().map(|x| x.parse().unwrap()).collect();
        let polyline = svg.split("<polyline").find(|part| part.contains("#0072B2")).unwrap();
        let points = polyline.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
        let (x, y) = points.split_whitespace().next().unwrap().split_once(',').unwrap();
        for (own, theirs) in places.iter().zip([x, y]) {
            assert!((own - theirs.parse::<f64>().unwrap() * 0.075).abs() < 1e-3, "{places:?} {x} {y}");
        }
        // Letters are outlines, and no font is asked for.
        assert!(page.matches(" c\n").count() > 100 && !page.contains("Tf"));
    }
}
