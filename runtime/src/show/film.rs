//! Animations as pictures that move: PNG (its extension APNG) and GIF.  Of each frame only what changed is kept.

use std::collections::HashMap;

use plotters::prelude::IntoDrawingArea;

use super::raster::{Picture, Raster, Rectangle};
use super::stage::Stage;
use super::{Animation, Playback};

/// A frame is shown for so many hundredths of a second, the last one of a motion that does not repeat longer.
const SHOWN: u16 = 100 / Playback::RATE as u16;
const AT_THE_END: u16 = 100;
/// Colours of a GIF, the place after them, which shows the frame before, and of how many frames they are taken.
const COLOURS: usize = 255;
const UNCHANGED: u8 = 255;
const TRIED: usize = 16;
const INTO_MEMORY: &str = "a file in memory takes all that is written";

impl Animation {
    /// The animation as a PNG file that moves, frame by frame as [`Animation::playback`] says; charts are left out.
    ///
    /// ```
    /// use dalembert::mechanism::Shape;
    /// use dalembert::show::Animation;
    /// let swing = (0..=100).map(|i| f64::from(i) / 50.0).map(|t| {
    ///     let angle = 0.5 * t.cos();
    ///     (t, vec![0.0, 0.0, angle.sin(), -angle.cos()])
    /// });
    /// let animation = Animation::new("Pendulum", 2, vec![Shape::Line(2)]).with_frames(swing);
    /// assert!(animation.to_png().starts_with(b"\x89PNG") && animation.to_gif().starts_with(b"GIF89a"));
    /// ```
    pub fn to_png(&self) -> Vec<u8> {
        let film = Film::of(self);
        let mut file = Vec::new();
        let (width, height) = film.background.dimensions();
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_color(png::ColorType::Rgba);
        // Even areas and thin lines are smallest as they are.
        encoder.set_filter(png::Filter::NoFilter);
        encoder.set_animated(film.playback.frames as u32, 0).expect(INTO_MEMORY);
        let mut writer = encoder.write_header().expect(INTO_MEMORY);
        film.play(|Frame { area, pixels, shown }| {
            writer.set_blend_op(png::BlendOp::Over)?;
            writer.set_frame_delay(shown, 100)?;
            writer.reset_frame_position()?;
            writer.set_frame_dimension(area.width, area.height)?;
            writer.set_frame_position(area.left, area.top)?;
            let opaque = |pixel: &Option<[u8; 3]>| pixel.map_or([0; 4], |[r, g, b]| [r, g, b, u8::MAX]);
            writer.write_image_data(&pixels.iter().flat_map(opaque).collect::<Vec<u8>>())
        })
        .expect(INTO_MEMORY);
        writer.finish().expect(INTO_MEMORY);
        file
    }

    /// The animation as a GIF file, frame by frame as [`Animation::playback`] says, in up to 255 colours; charts are left out.
    pub fn to_gif(&self) -> Vec<u8> {
        let film = Film::of(self);
        let mut palette = Palette::of(&film);
        let mut file = Vec::new();
        let (width, height) = film.background.dimensions();
        let mut encoder =
            gif::Encoder::new(&mut file, width as u16, height as u16, &palette.colours.concat()).expect(INTO_MEMORY);
        encoder.set_repeat(gif::Repeat::Infinite).expect(INTO_MEMORY);
        film.play(|Frame { area, pixels, shown }| {
            let [left, top, width, height] = [area.left, area.top, area.width, area.height].map(|x| x as u16);
            let (delay, buffer, transparent) = (shown, palette.places(&pixels).into(), Some(UNCHANGED));
            let frame = gif::Frame { delay, transparent, left, top, width, height, buffer, ..gif::Frame::default() };
            encoder.write_frame(&frame)
        })
        .expect(INTO_MEMORY);
        drop(encoder);
        file
    }
}

/// What is drawn, and when.
struct Film<'a> {
    animation: &'a Animation,
    stage: Stage<'a>,
    playback: Playback,
    /// What all frames have in common.
    background: Picture,
}

/// One frame of a film.
struct Frame {
    /// Where it differs from the one before, and the colours there that do.
    area: Rectangle,
    pixels: Vec<Option<[u8; 3]>>,
    /// For how long, s/100.
    shown: u16,
}

impl<'a> Film<'a> {
    fn of(animation: &'a Animation) -> Film<'a> {
        let stage = Stage::of(animation);
        let mut background = Picture::new(stage.fine(), 1.0);
        let canvas = Raster::on(&mut background).into_drawing_area();
        stage.draw_background(&canvas).expect("a picture in memory takes all that is drawn");
        drop(canvas);
        Film { animation, stage, playback: animation.playback(), background }
    }

    fn picture(&self, index: usize) -> Picture {
        let mut picture = self.background.clone();
        let canvas = Raster::on(&mut picture).into_drawing_area();
        self.stage.draw(&canvas, self.animation.time_of(index)).expect("a picture in memory takes all that is drawn");
        drop(canvas);
        picture
    }

    /// Hands frame after frame to what writes them.
    fn play<E>(&self, mut write: impl FnMut(Frame) -> Result<(), E>) -> Result<(), E> {
        let mut before: Option<Picture> = None;
        for index in 0..self.playback.frames {
            let picture = self.picture(index);
            let area = before.as_ref().map_or_else(|| picture.whole(), |before| picture.changed(before));
            let pixels = picture.changes(area, before.as_ref());
            let ends = index + 1 == self.playback.frames && !self.animation.repeat;
            write(Frame { area, pixels, shown: if ends { AT_THE_END } else { SHOWN } })?;
            before = Some(picture);
        }
        Ok(())
    }
}

/// The colours of a GIF: those that are seen most.
struct Palette {
    colours: Vec<[u8; 3]>,
    /// Which of them stands for a colour, as far as asked for.
    nearest: HashMap<[u8; 3], u8>,
}

impl Palette {
    fn of(film: &Film<'_>) -> Palette {
        let mut counts: HashMap<[u8; 3], usize> = HashMap::new();
        let frames = film.playback.frames;
        for index in (0..TRIED).map(|k| k * (frames - 1) / (TRIED - 1)) {
            film.picture(index).colours().for_each(|colour| *counts.entry(colour).or_default() += 1);
        }
        let mut colours: Vec<[u8; 3]> = counts.keys().copied().collect();
        colours.sort_by_key(|colour| (std::cmp::Reverse(counts[colour]), *colour));
        colours.truncate(COLOURS);
        Palette { colours, nearest: HashMap::new() }
    }

    /// For each pixel the place of the colour that is nearest.
    fn places(&mut self, pixels: &[Option<[u8; 3]>]) -> Vec<u8> {
        let Palette { colours, nearest } = self;
        let mut place = |pixel: &[u8; 3]| {
            let away = |colour: &[u8; 3]| -> u32 {
                colour.iter().zip(pixel).map(|(a, b)| u32::from(a.abs_diff(*b)).pow(2)).sum()
            };
            let best = |colours: &[[u8; 3]]| (0..colours.len()).min_by_key(|k| away(&colours[*k])).unwrap_or_default();
            *nearest.entry(*pixel).or_insert_with(|| best(colours) as u8)
        };
        pixels.iter().map(|pixel| pixel.as_ref().map_or(UNCHANGED, &mut place)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::Shape;

    /// A bob of radius 0.1 m that goes three quarters of a circle of 1 m in 6 s.
    fn circling() -> Animation {
        let frames = (0..=600).map(|i| f64::from(i) / 100.0).map(|t| {
            let angle = t * std::f64::consts::TAU / 8.0;
            (t, vec![angle.cos(), angle.sin(), 0.1])
        });
        let animation = Animation::new("Bob", 2, vec![Shape::Circle]).with_frames(frames);
        Animation { in_units: true, ..animation }
    }

    /// Pictures as a reader puts them together, red, green and blue, and how long each is shown, s/100.
    struct Seen {
        width: usize,
        height: usize,
        pictures: Vec<Vec<u8>>,
        shown: Vec<u16>,
    }

    impl Seen {
        fn new(width: u32, height: u32) -> Seen {
            Seen { width: width as usize, height: height as usize, pictures: Vec::new(), shown: Vec::new() }
        }

        /// Lays a frame over the picture before; `None` leaves that as it is.
        fn add(&mut self, [left, top, width, _]: [usize; 4], pixels: &[Option<[u8; 3]>], shown: u16) {
            let blank = || vec![0; 3 * self.width * self.height];
            let mut picture = self.pictures.last().cloned().unwrap_or_else(blank);
            for (index, pixel) in pixels.iter().enumerate().filter_map(|(index, pixel)| Some((index, (*pixel)?))) {
                let first = 3 * ((top + index / width) * self.width + left + index % width);
                picture[first..first + 3].copy_from_slice(&pixel);
            }
            self.pictures.push(picture);
            self.shown.push(shown);
        }

        fn of_png(file: &[u8]) -> Seen {
            let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
            let mut seen = Seen::new(reader.info().width, reader.info().height);
            let count = reader.info().animation_control.unwrap().num_frames;
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            for _ in 0..count {
                let info = reader.next_frame(&mut pixels).unwrap();
                let control = *reader.info().frame_control().unwrap();
                let area = [control.x_offset, control.y_offset, info.width, info.height].map(|x| x as usize);
                assert_eq!(control.delay_den, 100);
                let read = pixels[..info.buffer_size()].chunks(4);
                let read: Vec<_> = read.map(|p| (p[3] == 255).then_some([p[0], p[1], p[2]])).collect();
                seen.add(area, &read, control.delay_num);
            }
            assert!(reader.next_frame(&mut pixels).is_err());
            seen
        }

        fn of_gif(file: &[u8]) -> Seen {
            let mut options = gif::DecodeOptions::new();
            options.set_color_output(gif::ColorOutput::Indexed);
            let mut reader = options.read_info(file).unwrap();
            let mut seen = Seen::new(u32::from(reader.width()), u32::from(reader.height()));
            let palette = reader.global_palette().unwrap().to_vec();
            while let Some(frame) = reader.read_next_frame().unwrap() {
                let area = [frame.left, frame.top, frame.width, frame.height].map(usize::from);
                let colour = |place: usize| std::array::from_fn(|k| palette[3 * place + k]);
                let shown = |place: &u8| (Some(*place) != frame.transparent).then(|| colour(usize::from(*place)));
                let pixels: Vec<Option<[u8; 3]>> = frame.buffer.iter().map(shown).collect();
                seen.add(area, &pixels, frame.delay);
            }
            seen
        }

        /// Whether the light blue of the bob is at a place of the plane, m.
        fn has_bob(&self, picture: usize, (x, y): (f64, f64)) -> bool {
            // 2.2 m take 420 px below the band of 34 px; a little off the axes, where there are no lines.
            let scale = 420.0 / 2.2;
            let pixel = (320.0 + scale * x + 4.0, 34.0 + 240.0 - scale * y + 4.0);
            let first = 3 * (pixel.1 as usize * self.width + pixel.0 as usize);
            let [r, g, b] = [0, 1, 2].map(|k| self.pictures[picture][first + k]);
            r.abs_diff(191) < 4 && g.abs_diff(220) < 4 && b.abs_diff(236) < 4
        }
    }

    fn is_the_motion(seen: &Seen) {
        assert_eq!((seen.width, seen.height, seen.pictures.len()), (640, 514, 151));
        assert_eq!((seen.shown[0], seen.shown[149], seen.shown[150]), (4, 4, 100));
        for (picture, place) in [(0, (1.0, 0.0)), (50, (0.0, 1.0)), (100, (-1.0, 0.0)), (150, (0.0, -1.0))] {
            assert!(seen.has_bob(picture, place), "{picture}");
            assert!(!seen.has_bob(picture, (-place.0, -place.1)), "{picture}");
        }
        let diagonal = 0.5f64.sqrt();
        assert!(seen.has_bob(25, (diagonal, diagonal)) && !seen.has_bob(26, (1.0, 0.0)));
        assert_ne!(seen.pictures[0], seen.pictures[150]);
        // The time, in the upper right corner.
        let clock = |picture: usize| -> Vec<&[u8]> {
            seen.pictures[picture].chunks(3 * seen.width).take(30).map(|row| &row[3 * 500..]).collect()
        };
        assert_ne!(clock(0), clock(1));
    }

    #[test]
    fn a_png_shows_the_motion() {
        is_the_motion(&Seen::of_png(&circling().to_png()));
    }

    #[test]
    fn a_gif_shows_the_motion() {
        is_the_motion(&Seen::of_gif(&circling().to_gif()));
    }

    #[test]
    fn frames_hold_what_changed() {
        let still = Animation::new("Bar", 2, vec![Shape::Line(2)])
            .with_frames([(0.0, vec![0.0, 0.0, 1.0, 0.0]), (100.0, vec![0.0, 0.0, 1.0, 0.0])]);
        let moving = circling();
        // Of what stands still only the clock is in a frame.
        assert!(still.to_png().len() < moving.to_png().len() / 2);
    }

    /// Some 4 and 9 kB a frame; with every frame whole it would be 1.3 MB a frame before compression.
    #[test]
    fn a_pendulum_of_three_seconds_takes_a_fraction_of_a_megabyte() {
        let frames = (0..=300).map(|i| f64::from(i) / 100.0).map(|t| {
            let angle = (4.47 * t).cos();
            let bob = [angle.sin(), -angle.cos()];
            (t, [&[0.0, 0.0], &bob[..], &bob, &[0.05]].concat())
        });
        let pendulum = Animation::new("Pendulum", 2, vec![Shape::Line(2), Shape::Circle]).with_frames(frames);
        assert_eq!(pendulum.playback().frames, 76);
        let (gif, png) = (pendulum.to_gif().len(), pendulum.to_png().len());
        assert!(gif < 400_000 && png < 800_000, "{gif} and {png} bytes");
    }

    #[test]
    fn a_period_has_no_frame_twice() {
        let seen = Seen::of_gif(&Animation { repeat: true, ..circling() }.to_gif());
        assert_eq!((seen.pictures.len(), seen.shown.last()), (30, Some(&4)));
        assert!(seen.has_bob(0, (1.0, 0.0)) && !seen.has_bob(29, (0.0, -1.0)));
    }

    #[test]
    fn anything_makes_a_picture() {
        let flat = || vec![Shape::Line(2), Shape::Circle, Shape::Spring, Shape::Curve(2), Shape::Trace("a".into())];
        let round = [Shape::Ring, Shape::Disc, Shape::Cylinder, Shape::Sphere, Shape::Ellipsoid];
        let others = [Shape::Box, Shape::Plane, Shape::Axes, Shape::UnitAxes];
        let shapes = |dimension| if dimension == 2 { flat() } else { [&flat()[..], &round, &others].concat() };
        for dimension in [2, 3] {
            let count = shapes(dimension).iter().map(|shape| shape.numbers(dimension as usize)).sum();
            for numbers in [vec![0.0; count], vec![f64::NAN; count], vec![1e12; count], vec![1e-12; count], Vec::new()]
            {
                for end in [0.0, 1e-9, 1.0, 1e9] {
                    let frames = [(0.0, numbers.clone()), (end, vec![1.0; numbers.len()])];
                    let animation = Animation::new("Any", dimension, shapes(dimension)).with_frames(frames);
                    let film = Film::of(&animation);
                    for index in [0, film.playback.frames - 1] {
                        film.picture(index);
                    }
                }
            }
        }
        assert_eq!(Seen::of_gif(&Animation::default().to_gif()).pictures.len(), 1);
        assert_eq!(Seen::of_png(&Animation::default().to_png()).pictures.len(), 1);
    }
}
