//! One moment of an animation as a picture, as its page draws it.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::figure::{Canvas, FINE, GRID, INK, Outcome, ZERO, text};
use super::marks::COLOURS;
use super::ticks::{Ticks, round_step};
use super::{Animation, Playback};
use crate::mechanism::Shape;

/// Width of the picture, of the band with title and time, and of what stays free around the mechanism, px.
const WIDTH: i32 = 640;
const BAND: i32 = 34;
const FREE: (i32, i32) = (80, 60);
/// The least and the largest height of what is below the band, px.
const HEIGHTS: (f64, f64) = (160.0, 480.0);
const QUIET: RGBColor = RGBColor(119, 119, 119);
const SHADOW: RGBColor = RGBColor(212, 212, 212);
/// Where a motion in space is looked at from.
const AZIMUTH: f64 = -1.1;
const ELEVATION: f64 = 0.35;

type Point = [f64; 3];
/// A place on the picture in drawing units, where there is one.
type Place = Option<(i32, i32)>;

/// An animation with its place on a picture.
pub(super) struct Stage<'a> {
    animation: &'a Animation,
    playback: Playback,
    /// Ends of everything that is ever drawn.
    low: Point,
    high: Point,
    /// The farthest from the middle.
    reach: f64,
    /// Pixels of a metre.
    scale: f64,
    /// The greatest length of each spring, by its place among all shapes, m.
    longest: Vec<f64>,
    /// Height of the picture, px.
    height: i32,
}

/// The numbers of one shape.
struct Drawn<'a> {
    shape: &'a Shape,
    /// Its place among all shapes, and that of its first number.
    place: usize,
    first: usize,
}

impl<'a> Stage<'a> {
    /// A stage that holds the whole motion.
    pub fn of(animation: &'a Animation) -> Stage<'a> {
        let playback = animation.playback();
        let mut stage = Stage {
            animation,
            playback,
            low: [0.0; 3],
            high: [0.0; 3],
            reach: 1.0,
            scale: 1.0,
            longest: Vec::new(),
            height: WIDTH,
        };
        stage.measure();
        stage.measure_springs();
        stage
    }

    /// Width and height in drawing units.
    pub fn fine(&self) -> (u32, u32) {
        ((WIDTH * FINE) as u32, (self.height * FINE) as u32)
    }

    /// What all moments have in common: the grid and the title.
    pub fn draw_background<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Outcome<B> {
        match self.in_space() {
            true => self.draw_ground(canvas)?,
            false => self.draw_plane(canvas)?,
        }
        let band = [(0, 0), (WIDTH * FINE, BAND * FINE)];
        canvas.draw(&Rectangle::new(band, WHITE.filled()))?;
        let title: String = self.animation.title.chars().take(MOST_LETTERS).collect();
        write(canvas, &title, (12, BAND / 2), HPos::Left, (15, INK))
    }

    /// The mechanism and the time.
    pub fn draw<B: DrawingBackend>(&self, canvas: &Canvas<B>, t: f64) -> Outcome<B> {
        let (index, numbers) = self.animation.moment(t);
        let shapes = self.shapes();
        if self.in_space() {
            for drawn in &shapes {
                self.draw_shadow(canvas, drawn, &numbers)?;
            }
        }
        for drawn in &shapes {
            self.draw_shape(canvas, drawn, (index, &numbers))?;
        }
        write(canvas, &self.time(t), (WIDTH - 12, BAND / 2), HPos::Right, (14, INK))
    }

    /// `t = 1.24 s`, with the speed where it is not that of the motion.
    fn time(&self, t: f64) -> String {
        // A frame differs from the next one in the last digit.
        let step = self.playback.speed / f64::from(Playback::RATE);
        let digits = (-step.log10()).ceil().clamp(0.0, 12.0);
        let unit = if self.animation.in_units { " s" } else { "" };
        let speed = if self.playback.speed == 1.0 { String::new() } else { format!("   {}×", self.playback.speed) };
        format!("t = {t:.*}{unit}{speed}", digits as usize).replace('-', "−")
    }

    fn in_space(&self) -> bool {
        self.animation.dimension == 3
    }

    /// Shapes from the lowest to the uppermost.
    fn shapes(&self) -> Vec<Drawn<'a>> {
        let mut first = 0;
        let drawn = |(place, shape): (usize, &'a Shape)| {
            let drawn = Drawn { shape, place, first };
            first += shape.numbers(self.animation.dimension as usize);
            drawn
        };
        let mut shapes: Vec<Drawn<'a>> = self.animation.shapes.iter().enumerate().map(drawn).collect();
        shapes.sort_by_key(|drawn| match drawn.shape {
            Shape::Curve(_) => 0,
            Shape::Trace(_) => 1,
            Shape::Spring => 2,
            Shape::Line(_) => 3,
            Shape::Circle => 4,
        });
        shapes
    }

    /// The points of a shape, and its radius if it is a circle.
    fn points(&self, drawn: &Drawn<'_>, numbers: &[f64]) -> (Vec<Point>, f64) {
        let dimension = self.animation.dimension as usize;
        let count = match drawn.shape {
            Shape::Line(count) | Shape::Curve(count) => *count as usize,
            Shape::Spring => 2,
            Shape::Circle | Shape::Trace(_) => 1,
        };
        let number = |k: usize| numbers.get(drawn.first + k).copied().unwrap_or(f64::NAN);
        let point = |i: usize| std::array::from_fn(|k| if k < dimension { number(i * dimension + k) } else { 0.0 });
        let radius = if *drawn.shape == Shape::Circle { number(dimension).abs() } else { 0.0 };
        ((0..count).map(point).collect(), radius)
    }

    /// Finds the ends of the motion and the scale at which the picture holds it.
    fn measure(&mut self) {
        let mut ends = Vec::new();
        for drawn in &self.shapes() {
            for (_, numbers) in &self.animation.frames {
                let (points, radius) = self.points(drawn, numbers);
                let radius = if radius.is_finite() { radius } else { 0.0 };
                let there = points.into_iter().filter(|point| point.iter().all(|x| x.is_finite()));
                ends.extend(there.map(|point| (point, radius)));
            }
        }
        if ends.is_empty() {
            ends.push(([0.0; 3], 1.0));
        }
        self.low = std::array::from_fn(|k| ends.iter().map(|(p, r)| p[k] - r).fold(f64::INFINITY, f64::min));
        self.high = std::array::from_fn(|k| ends.iter().map(|(p, r)| p[k] + r).fold(f64::NEG_INFINITY, f64::max));
        let centre = self.centre();
        let away = |point: &Point| (0..3).map(|k| (point[k] - centre[k]).powi(2)).sum::<f64>().sqrt();
        self.reach = ends.iter().map(|(point, radius)| away(point) + radius).fold(0.0, f64::max);
        if self.reach <= 0.0 {
            self.reach = 1.0;
        }
        let size = match self.in_space() {
            true => [2.0 * self.reach; 2],
            false => [self.high[0] - self.low[0], self.high[1] - self.low[1]],
        };
        let [width, height] = size.map(|length| length.max(1e-9 * self.reach));
        let free = HEIGHTS.1 - f64::from(FREE.1);
        self.scale = (f64::from(WIDTH - FREE.0) / width).min(free / height);
        let wanted = height * self.scale + f64::from(FREE.1);
        self.height = BAND + wanted.clamp(HEIGHTS.0, HEIGHTS.1).round() as i32;
    }

    fn measure_springs(&mut self) {
        let mut longest = vec![0.0; self.animation.shapes.len()];
        for drawn in self.shapes().iter().filter(|drawn| *drawn.shape == Shape::Spring) {
            let length = |numbers: &[f64]| {
                let (points, _) = self.points(drawn, numbers);
                (0..3).map(|k| (points[0][k] - points[1][k]).powi(2)).sum::<f64>().sqrt()
            };
            longest[drawn.place] = self.animation.frames.iter().map(|(_, numbers)| length(numbers)).fold(0.0, f64::max);
        }
        self.longest = longest;
    }

    fn centre(&self) -> Point {
        std::array::from_fn(|k| (self.low[k] + self.high[k]) / 2.0)
    }

    /// The height of the ground under a motion in space.
    fn floor(&self) -> f64 {
        if self.low[2] >= 0.0 && self.low[2] < 0.3 * self.reach { 0.0 } else { self.low[2] }
    }

    /// Where a point is, px.
    fn pixel(&self, point: Point) -> (f64, f64) {
        let centre = self.centre();
        let [mut x, mut y, z]: Point = std::array::from_fn(|k| point[k] - centre[k]);
        if self.in_space() {
            let ((s, c), (rise, level)) = (AZIMUTH.sin_cos(), ELEVATION.sin_cos());
            (x, y) = (c * y - s * x, z * level - (c * x + s * y) * rise);
        }
        let middle = f64::from(BAND + self.height) / 2.0;
        (f64::from(WIDTH) / 2.0 + self.scale * x, middle - self.scale * y)
    }

    fn place(&self, point: Point) -> Place {
        fine(self.pixel(point))
    }

    fn shadow(&self, [x, y, _]: Point) -> Place {
        self.place([x, y, self.floor()])
    }

    fn draw_plane<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Outcome<B> {
        let (centre, bottom, unit) = (self.centre(), self.height * FINE, self.unit());
        let half = [WIDTH, self.height - BAND].map(|pixels| f64::from(pixels) / 2.0 / self.scale);
        let ticks = |k: usize, pixels: i32| {
            Ticks::linear(centre[k] - half[k], centre[k] + half[k], (pixels / 70) as usize, None)
        };
        let line = |value: f64| if value == 0.0 { ZERO } else { GRID }.stroke_width(FINE as u32);
        let across = ticks(0, WIDTH);
        for x in &across.major {
            let at = self.pixel([*x, centre[1], 0.0]).0;
            let fine = (at * f64::from(FINE)) as i32;
            canvas.draw(&PathElement::new([(fine, BAND * FINE), (fine, bottom)], line(*x)))?;
            let label = format!("{}{unit}", across.label(*x));
            write(canvas, &label, (at as i32 + 3, self.height - 8), HPos::Left, (11, QUIET))?;
        }
        let up = ticks(1, self.height - BAND);
        for y in &up.major {
            let at = self.pixel([centre[0], *y, 0.0]).1;
            let fine = (at * f64::from(FINE)) as i32;
            canvas.draw(&PathElement::new([(0, fine), (WIDTH * FINE, fine)], line(*y)))?;
            if at < f64::from(self.height - 20) {
                write(canvas, &format!("{}{unit}", up.label(*y)), (4, at as i32 - 8), HPos::Left, (11, QUIET))?;
            }
        }
        Ok(())
    }

    fn draw_ground<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Outcome<B> {
        let step = round_step(self.reach / 5.0);
        let ends = |k: usize| ((self.low[k] / step).floor() as i64, (self.high[k] / step).ceil() as i64);
        let ((x0, x1), (y0, y1)) = (ends(0), ends(1));
        let at = |x: i64, y: i64| [x as f64 * step, y as f64 * step, self.floor()];
        let grid = GRID.stroke_width(FINE as u32);
        for (from, to) in (x0..=x1).map(|x| (at(x, y0), at(x, y1))).chain((y0..=y1).map(|y| (at(x0, y), at(x1, y)))) {
            stroke(canvas, [self.place(from), self.place(to)], grid)?;
        }
        let label = format!("grid {}{}", crate::numbers::short(step), self.unit());
        write(canvas, &label, (16, self.height - 14), HPos::Left, (12, QUIET))?;
        let (centre, corner) = (self.centre(), (60.0, f64::from(self.height) - 70.0));
        let middle = self.pixel(centre);
        for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
            let tip = self.pixel(std::array::from_fn(|i| centre[i] + if i == k { 1.0 / self.scale } else { 0.0 }));
            let away = |length: f64| (corner.0 + length * (tip.0 - middle.0), corner.1 + length * (tip.1 - middle.1));
            stroke(canvas, [fine(away(0.0)), fine(away(32.0))], QUIET.stroke_width(2 * FINE as u32))?;
            let (x, y) = away(44.0);
            write(canvas, name, (x as i32, y as i32), HPos::Center, (12, QUIET))?;
        }
        Ok(())
    }

    /// What stands behind lengths.
    fn unit(&self) -> &'static str {
        if self.animation.in_units { " m" } else { "" }
    }

    fn draw_shadow<B: DrawingBackend>(&self, canvas: &Canvas<B>, drawn: &Drawn<'_>, numbers: &[f64]) -> Outcome<B> {
        let (points, radius) = self.points(drawn, numbers);
        let mut places = points.iter().map(|point| self.shadow(*point));
        match drawn.shape {
            Shape::Trace(_) => Ok(()),
            Shape::Circle => self.disc(canvas, places.next().flatten(), self.radius(radius), SHADOW.mix(0.5).filled()),
            _ => stroke(canvas, places, SHADOW.stroke_width(3 * FINE as u32)),
        }
    }

    fn draw_shape<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        drawn: &Drawn<'_>,
        (index, numbers): (usize, &[f64]),
    ) -> Outcome<B> {
        let paint = COLOURS[drawn.place % 6];
        let (points, radius) = self.points(drawn, numbers);
        let places: Vec<Place> = points.iter().map(|point| self.place(*point)).collect();
        let two = 2 * FINE as u32;
        match drawn.shape {
            Shape::Line(_) => {
                stroke(canvas, places.iter().copied(), paint.stroke_width(5 * FINE as u32))?;
                for place in places {
                    self.disc(canvas, place, 4 * FINE, WHITE.filled())?;
                    self.disc(canvas, place, 4 * FINE, paint.stroke_width(two))?;
                }
                Ok(())
            }
            Shape::Circle => {
                self.disc(canvas, places[0], self.radius(radius), paint.mix(0.25).filled())?;
                self.disc(canvas, places[0], self.radius(radius), paint.stroke_width(two))
            }
            Shape::Spring => {
                let ends = [self.pixel(points[0]), self.pixel(points[1])];
                stroke(canvas, self.zigzag(ends, self.longest[drawn.place]), paint.stroke_width(two))
            }
            Shape::Curve(_) => stroke(canvas, places, QUIET.stroke_width(two)),
            Shape::Trace(_) => {
                let path = self.path(drawn, index).chain(if self.animation.repeat { None } else { Some(places[0]) });
                stroke(canvas, path, paint.mix(0.7).stroke_width(3 * FINE as u32 / 2))?;
                self.disc(canvas, places[0], 3 * FINE, paint.filled())
            }
        }
    }

    /// The path of a trace up to a frame; a motion that repeats shows all of it.
    fn path(&self, drawn: &Drawn<'_>, index: usize) -> impl Iterator<Item = Place> {
        let count = if self.animation.repeat { usize::MAX } else { index + 1 };
        let past = self.animation.frames.iter().take(count);
        past.map(move |(_, numbers)| self.place(self.points(drawn, numbers).0[0]))
    }

    /// A radius in drawing units.
    fn radius(&self, radius: f64) -> i32 {
        ((self.scale * radius).max(3.0) * f64::from(FINE)) as i32
    }

    fn disc<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        place: Place,
        radius: i32,
        style: impl Into<ShapeStyle>,
    ) -> Outcome<B> {
        place.map_or(Ok(()), |place| canvas.draw(&Circle::new(place, radius, style)))
    }

    /// A spring keeps its width, which follows from its greatest length.
    fn zigzag(&self, [from, to]: [(f64, f64); 2], longest: f64) -> Vec<Place> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = if dx.hypot(dy) > 0.0 { dx.hypot(dy) } else { 1.0 };
        let half = (0.06 * self.scale * longest).clamp(1.5, 8.0);
        let (nx, ny) = (-half * dy / length, half * dx / length);
        let coil = |i: i32| {
            let along = 0.12 + 0.76 * f64::from(i) / 16.0;
            let side = if i == 0 || i == 16 { 0.0 } else { f64::from(2 * (i % 2) - 1) };
            fine((from.0 + along * dx + side * nx, from.1 + along * dy + side * ny))
        };
        std::iter::once(fine(from)).chain((0..=16).map(coil)).chain([fine(to)]).collect()
    }
}

/// Letters of a title that have a place beside the time.
const MOST_LETTERS: usize = 48;

/// Drawing units from pixels.
fn fine((x, y): (f64, f64)) -> Place {
    let fine = (x * f64::from(FINE), y * f64::from(FINE));
    (fine.0.is_finite() && fine.1.is_finite()).then_some((fine.0.round() as i32, fine.1.round() as i32))
}

/// Lines between neighbours that are both there.
fn stroke<B: DrawingBackend>(
    canvas: &Canvas<B>,
    places: impl IntoIterator<Item = Place>,
    style: ShapeStyle,
) -> Outcome<B> {
    let places: Vec<Place> = places.into_iter().collect();
    for piece in places.split(Option::is_none) {
        let mut piece: Vec<(i32, i32)> = piece.iter().flatten().copied().collect();
        piece.dedup();
        if piece.len() > 1 {
            canvas.draw(&PathElement::new(piece, style))?;
        }
    }
    Ok(())
}

/// Writes text about a height, px.
fn write<B: DrawingBackend>(
    canvas: &Canvas<B>,
    line: &str,
    (x, y): (i32, i32),
    anchor: HPos,
    (size, colour): (i32, RGBColor),
) -> Outcome<B> {
    let style = text(size).color(&colour).pos(Pos::new(anchor, VPos::Center));
    canvas.draw(&Text::new(line.to_owned(), (x * FINE, y * FINE), style))
}

impl Animation {
    /// When a frame of the picture is.
    pub(super) fn time_of(&self, index: usize) -> f64 {
        let (start, end) = self.span();
        let frames = self.playback().frames;
        let steps = if self.repeat { frames } else { (frames - 1).max(1) };
        start + (end - start) * index as f64 / steps as f64
    }

    /// The numbers of all shapes at a time, linear between frames, and the last frame that is not after it; of two frames
    /// at one time the later counts.
    fn moment(&self, t: f64) -> (usize, Vec<f64>) {
        let index = self.frames.partition_point(|(time, _)| *time <= t).saturating_sub(1);
        let Some((before, first)) = self.frames.get(index) else { return (0, Vec::new()) };
        let Some((after, second)) = self.frames.get(index + 1) else { return (index, first.clone()) };
        let part = ((t - before) / (after - before)).max(0.0);
        (index, first.iter().zip(second).map(|(a, b)| a + part * (b - a)).collect())
    }
}
