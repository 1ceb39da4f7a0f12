//! Charts and animations as pixels, or as paths of a PDF: what plotters draws, with the outlines of DejaVu Sans as letters; pixels are
//! filled and stroked by zeno.

use std::convert::Infallible;

use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind, FontTransform,
};
use ttf_parser::{Face, OutlineBuilder};
use zeno::{Command, Join, Mask, PathBuilder, Stroke, Style, Vector};

use super::figure::{FINE, PLOTTERS_SHRINKS};

/// Opaque pixels, red, green and blue, row by row.
#[derive(Clone)]
pub(super) struct Picture {
    size: (u32, u32),
    /// Pixels for one drawing unit.
    scale: f32,
    width: u32,
    height: u32,
    pixels: Vec<u8>,
}

impl Picture {
    /// A white picture of this size in drawing units, `sharper` pixels for one of the figure's.
    pub fn new(size: (u32, u32), sharper: f32) -> Picture {
        let scale = sharper / FINE as f32;
        let [width, height] = [size.0, size.1].map(|length| (length as f32 * scale).ceil() as u32);
        Picture { size, scale, width, height, pixels: vec![255; 3 * width as usize * height as usize] }
    }

    /// Width and height, px.
    pub fn dimensions(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// All of it.
    pub fn whole(&self) -> Rectangle {
        Rectangle { left: 0, top: 0, width: self.width, height: self.height }
    }

    /// The least rectangle in which it differs from another picture of this size; one pixel where they are the same.
    pub fn changed(&self, other: &Picture) -> Rectangle {
        let row = 3 * self.width as usize;
        let rows = self.pixels.chunks_exact(row).zip(other.pixels.chunks_exact(row)).enumerate();
        let (mut x, mut y) = ((u32::MAX, 0), (u32::MAX, 0));
        for (line, (one, two)) in rows.filter(|(_, (one, two))| one != two) {
            let differs = |i: &usize| one[*i] != two[*i];
            let (first, last) = ((0..row).find(differs), (0..row).rev().find(differs));
            let [first, last] = [first, last].map(|place| place.unwrap_or_default() as u32 / 3);
            x = (x.0.min(first), x.1.max(last));
            y = (y.0.min(line as u32), y.1.max(line as u32));
        }
        if x.0 > x.1 {
            return Rectangle { left: 0, top: 0, width: 1, height: 1 };
        }
        Rectangle { left: x.0, top: y.0, width: x.1 - x.0 + 1, height: y.1 - y.0 + 1 }
    }

    /// The pixels of a part, those that are the same in a picture before left out.
    pub fn changes(&self, part: Rectangle, before: Option<&Picture>) -> Vec<Option<[u8; 3]>> {
        let Rectangle { left, top, width, height } = part;
        let pixel = |picture: &Picture, x: u32, y: u32| -> [u8; 3] {
            let first = 3 * (y as usize * picture.width as usize + x as usize);
            std::array::from_fn(|k| picture.pixels[first + k])
        };
        let change = |x, y| Some(pixel(self, x, y)).filter(|own| before.is_none_or(|other| pixel(other, x, y) != *own));
        (top..top + height).flat_map(|y| (left..left + width).map(move |x| (x, y))).map(|(x, y)| change(x, y)).collect()
    }

    /// The colours of all pixels.
    pub fn colours(&self) -> impl Iterator<Item = [u8; 3]> {
        self.pixels.as_chunks::<3>().0.iter().copied()
    }

    /// The picture as a PNG file.
    pub fn to_png(&self) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        let into_memory = "a file in memory takes all that is written";
        let mut writer = encoder.write_header().expect(into_memory);
        writer.write_image_data(&self.pixels).expect(into_memory);
        drop(writer);
        file
    }

    /// Lays a colour over what a path covers, in pixels.
    fn cover<'a>(&mut self, path: &[Command], style: impl Into<Style<'a>>, colour: BackendColor) {
        let (mask, place) = Mask::new(path).style(style).render();
        let paint = [colour.rgb.0, colour.rgb.1, colour.rgb.2].map(f64::from);
        for (index, covered) in mask.iter().enumerate().filter(|(_, covered)| **covered > 0) {
            let (x, y) =
                (place.left + (index as u32 % place.width) as i32, place.top + (index as u32 / place.width) as i32);
            if !(0..self.width as i32).contains(&x) || !(0..self.height as i32).contains(&y) {
                continue;
            }
            let part = colour.alpha * f64::from(*covered) / 255.0;
            let first = 3 * (y as usize * self.width as usize + x as usize);
            for (pixel, paint) in self.pixels[first..first + 3].iter_mut().zip(paint) {
                *pixel = (f64::from(*pixel) + part * (paint - f64::from(*pixel))).round() as u8;
            }
        }
    }
}

/// A part of a picture, px.
#[derive(Clone, Copy)]
pub(super) struct Rectangle {
    pub left: u32,
    pub top: u32,
    pub width: u32,
    pub height: u32,
}

/// What paths are filled and stroked on.
pub(super) trait Surface {
    /// Width and height in drawing units.
    fn size(&self) -> (u32, u32);
    /// Its own units for one drawing unit.
    fn scale(&self) -> f32;
    /// Lays a colour over the inside of a path.
    fn fill(&mut self, path: &[Command], colour: BackendColor);
    /// Lays a colour over a line of this width, with round corners: curves of many pieces have no spikes.
    fn stroke(&mut self, path: &[Command], width: f32, colour: BackendColor);
}

impl Surface for Picture {
    fn size(&self) -> (u32, u32) {
        self.size
    }

    fn scale(&self) -> f32 {
        self.scale
    }

    fn fill(&mut self, path: &[Command], colour: BackendColor) {
        self.cover(path, zeno::Fill::NonZero, colour);
    }

    fn stroke(&mut self, path: &[Command], width: f32, colour: BackendColor) {
        let mut stroke = Stroke::new(width);
        stroke.join(Join::Round);
        self.cover(path, stroke, colour);
    }
}

/// A surface on which plotters draws.
pub(super) struct Raster<'a, T: Surface> {
    surface: &'a mut T,
    letters: Face<'static>,
}

impl<'a, T: Surface> Raster<'a, T> {
    /// Draws on this surface.
    pub fn on(surface: &'a mut T) -> Raster<'a, T> {
        let letters = Face::parse(dejavu::sans::regular(), 0).expect("the font that is built in is sound");
        Raster { surface, letters }
    }

    fn stroke<S: BackendStyle>(&mut self, path: &[Command], style: &S) {
        let width = style.stroke_width() as f32 * self.surface.scale();
        self.surface.stroke(path, width, style.color());
    }

    /// The width of a line of text, in units of the font.
    fn width(&self, text: &str) -> f32 {
        let advance = |letter| self.letters.glyph_index(letter).and_then(|glyph| self.letters.glyph_hor_advance(glyph));
        text.chars().filter_map(advance).map(f32::from).sum()
    }

    /// A place in pixels.
    fn pixel(&self, (x, y): BackendCoord) -> Vector {
        Vector::new(x as f32 * self.surface.scale(), y as f32 * self.surface.scale())
    }

    /// A path through these places.
    fn outline(&self, places: impl IntoIterator<Item = BackendCoord>) -> Vec<Command> {
        let mut path: Vec<Command> = Vec::new();
        for (index, place) in places.into_iter().enumerate() {
            if index == 0 {
                path.move_to(self.pixel(place))
            } else {
                path.line_to(self.pixel(place))
            };
        }
        path
    }
}

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl<U: Surface> DrawingBackend for Raster<'_, U> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.surface.size()
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, colour: BackendColor) -> Drawn {
        self.draw_rect((x, y), (x + 1, y + 1), &colour, true)
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (left, top): BackendCoord,
        (right, bottom): BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        match fill {
            true => self.fill_polygon(corners, style),
            false => self.draw_path(corners.into_iter().chain([(left, top)]), style),
        }
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Drawn {
        let path = self.outline(path);
        self.stroke(&path, style);
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(&mut self, centre: BackendCoord, radius: u32, style: &S, fill: bool) -> Drawn {
        let mut path: Vec<Command> = Vec::new();
        path.add_circle(self.pixel(centre), radius as f32 * self.surface.scale());
        match fill {
            true => self.surface.fill(&path, style.color()),
            false => self.stroke(&path, style),
        }
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, corners: I, style: &S) -> Drawn {
        let mut path = self.outline(corners);
        path.close();
        self.surface.fill(&path, style.color());
        Ok(())
    }

    fn draw_text<T: BackendTextStyle>(&mut self, text: &str, style: &T, place: BackendCoord) -> Drawn {
        let size = (style.size() / PLOTTERS_SHRINKS) as f32 * self.surface.scale();
        let scale = size / f32::from(self.letters.units_per_em());
        let small = self.letters.glyph_index('x').and_then(|glyph| self.letters.glyph_bounding_box(glyph));
        let height = small.map_or(0.0, |small| f32::from(small.y_max)) * scale;
        let across = match style.anchor().h_pos {
            HPos::Left => 0.0,
            HPos::Center => -0.5,
            HPos::Right => -1.0,
        };
        // As the SVG has it.
        let down = match style.anchor().v_pos {
            VPos::Top => 0.76 * size,
            VPos::Center => 0.5 * height,
            VPos::Bottom => -0.5 * height,
        };
        let turn = match style.transform() {
            FontTransform::None => (1.0, 0.0),
            FontTransform::Rotate90 => (0.0, 1.0),
            FontTransform::Rotate180 => (-1.0, 0.0),
            FontTransform::Rotate270 => (0.0, -1.0),
        };
        let start = across * self.width(text) * scale;
        let mut line = Line { path: Vec::new(), origin: self.pixel(place), turn, scale, start, down };
        for letter in text.chars() {
            let Some(glyph) = self.letters.glyph_index(letter) else { continue };
            self.letters.outline_glyph(glyph, &mut line);
            line.start += f32::from(self.letters.glyph_hor_advance(glyph).unwrap_or_default()) * scale;
        }
        self.surface.fill(&line.path, style.color());
        Ok(())
    }
}

/// Outlines of the letters of a line, put where the line is.
struct Line {
    path: Vec<Command>,
    /// What the line is anchored at, px.
    origin: Vector,
    /// The cosine and the sine of its turn, clockwise.
    turn: (f32, f32),
    /// Pixels for one unit of the font.
    scale: f32,
    /// Where the next letter begins, along the line, and how far below the origin its base is, px.
    start: f32,
    down: f32,
}

impl Line {
    fn at(&self, x: f32, y: f32) -> Vector {
        let (along, down) = (self.start + x * self.scale, self.down - y * self.scale);
        let (cos, sin) = self.turn;
        Vector::new(self.origin.x + cos * along - sin * down, self.origin.y + sin * along + cos * down)
    }
}

impl OutlineBuilder for Line {
    fn move_to(&mut self, x: f32, y: f32) {
        let to = self.at(x, y);
        self.path.move_to(to);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let to = self.at(x, y);
        self.path.line_to(to);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let (by, to) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(by, to);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let (from, by, to) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.curve_to(from, by, to);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use crate::show::{Axis, Chart, Figure, Series};

    struct Read {
        width: u32,
        height: u32,
        pixels: Vec<u8>,
    }

    impl Read {
        fn of(figure: &Figure) -> Read {
            let file = figure.to_png();
            let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut pixels).unwrap();
            Read { width: info.width, height: info.height, pixels }
        }

        fn at(&self, x: u32, y: u32) -> [u8; 3] {
            let first = 3 * (y * self.width + x) as usize;
            [self.pixels[first], self.pixels[first + 1], self.pixels[first + 2]]
        }

        /// How much ink a part of the picture has, in black pixels.
        fn ink(&self, x: std::ops::Range<u32>, y: std::ops::Range<u32>) -> f64 {
            let dark = |x, y| 1.0 - self.at(x, y).iter().map(|c| f64::from(*c)).sum::<f64>() / 765.0;
            y.flat_map(|y| x.clone().map(move |x| dark(x, y))).sum()
        }
    }

    fn chart(title: &str) -> Figure {
        let line = Series::line("", (0..=10).map(|i| Some((f64::from(i), f64::from(i)))));
        Chart::new(title, Axis::new("time", "s"), Axis::new("ω", "rad/s")).with(line).into()
    }

    /// The picture has the SVG's size, the line its colour and width, and everything stands where it does there.
    #[test]
    fn pixels_stand_where_the_svg_has_them() {
        let figure = chart("");
        let svg = figure.to_svg();
        let read = Read::of(&figure);
        assert!(svg.starts_with(&format!("<svg width=\"{}\" height=\"{}\"", read.width / 2, read.height / 2)));
        let polyline = svg.split("<polyline").find(|part| part.contains("#0072B2")).unwrap();
        let points = polyline.split("points=\"").nth(1).unwrap().split('"').next().unwrap();
        let places: Vec<f64> = points.split([' ', ',']).filter_map(|text| text.parse().ok()).collect();
        let [x0, y0, .., x1, y1] = places[..] else { panic!("{points}") };
        let [x, y] = [x0 + x1, y0 + y1].map(|sum| sum / 10.0);
        assert_eq!(read.at(x as u32, y as u32), [0, 114, 178]);
        // Two pixels of the SVG wide.
        let column: Vec<[u8; 3]> = (0..20).map(|i| read.at(x as u32, y as u32 - 10 + i)).collect();
        let blue = column.iter().filter(|pixel| **pixel == [0, 114, 178]).count();
        assert!((3..=6).contains(&blue), "{column:?}");
        assert_eq!(read.at(1, 1), [255; 3]);
    }

    /// Letters are drawn without any font of the machine: titles, Greek, and turned text beside the axis.
    #[test]
    fn letters_are_built_in() {
        let (with, without) = (Read::of(&chart("Pendulum")), Read::of(&chart("P")));
        let title = |read: &Read| read.ink(0..read.width, 0..60);
        let (long, short) = (title(&with), title(&without));
        assert!(short > 30.0 && long > 4.0 * short && long < 12.0 * short, "{long} {short}");
        // ω (rad/s) runs upwards at the left.
        let beside: Vec<bool> = (0..with.height).map(|y| with.ink(24..48, y..y + 1) > 0.5).collect();
        let marked = beside.iter().filter(|row| **row).count();
        assert!((60..200).contains(&marked), "{marked}");
    }

    /// A name of the legend stands beside its line, not above it.
    #[test]
    fn letters_stand_about_their_middle() {
        let line = |name: &str, y: f64| Series::line(name, [Some((0.0, y)), Some((1.0, y))]);
        let chart = Chart::new("", Axis::new("", ""), Axis::new("", ""));
        let read = Read::of(&Figure::from(chart.with(line("xxxx", 0.0)).with(line("", 1.0))));
        let blue = (0..200).filter(|y| (read.width - 180..read.width).any(|x| read.at(x, *y) == [0, 114, 178]));
        let sample: Vec<u32> = blue.collect();
        let dark = |x, y| read.at(x, y).iter().all(|c| *c < 90);
        let letters: Vec<u32> = (0..200).filter(|y| (read.width - 180..read.width).any(|x| dark(x, *y))).collect();
        let middle = |rows: &[u32]| f64::from(rows[0] + rows[rows.len() - 1]) / 2.0;
        assert!((middle(&sample) - middle(&letters)).abs() < 2.0, "{sample:?} {letters:?}");
    }

    #[test]
    fn a_name_decides_between_the_formats() {
        let folder = std::env::temp_dir().join(format!("dalembert-png-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for (name, start) in
            [("a.png", &b"\x89PNG"[..]), ("b.PNG", b"\x89PNG"), ("c.svg", b"<svg"), ("d", b"<svg"), ("e.pdf", b"%PDF")]
        {
            chart("").write(folder.join(name)).unwrap();
            assert!(std::fs::read(folder.join(name)).unwrap().starts_with(start), "{name}");
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
}
