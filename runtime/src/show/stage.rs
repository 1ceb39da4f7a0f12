//! One moment of an animation as a picture, as its page draws it.

use std::borrow::Cow;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::brush::{Place, coils, disc, fill, fine, stroke, write};
use super::extent::{Drawn, Extent};
use super::figure::{Canvas, FINE, GRID, INK, Outcome, ZERO};
use super::marks::COLOURS;
use super::outlines::outlines;
use super::painter::{Part, ordered};
use super::solids::{Point, plus};
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

/// Colours of the axes x, y and z of a body, red, green and blue, and how far beyond their tips their letters are, px.
const AXES: [usize; 3] = [1, 2, 0];
const LETTER: f64 = 9.0;
/// How much of its colour a face has, the rest being white or, of a disc, what is behind it; and how much a plane has.
const TINT: f64 = 0.25;
const PANE: f64 = 0.12;

/// An animation with its place on a picture.
pub(super) struct Stage<'a> {
    /// What is drawn: z is up.
    animation: Cow<'a, Animation>,
    playback: Playback,
    extent: Extent,
    /// Pixels of a metre.
    scale: f64,
    /// The greatest length of each spring, by its place among all shapes, m.
    longest: Vec<f64>,
    /// Height of the picture, px.
    height: i32,
}

impl<'a> Stage<'a> {
    /// A stage that holds the whole motion.
    pub fn of(animation: &'a Animation) -> Stage<'a> {
        let playback = animation.playback();
        let animation = animation.upright();
        let extent = Extent::of(&animation);
        let longest = Vec::new();
        let mut stage = Stage { animation, playback, extent, scale: 1.0, longest, height: WIDTH };
        stage.measure();
        stage.measure_springs();
        stage
    }

    /// Width and height, px.
    pub fn size(&self) -> (i32, i32) {
        (WIDTH, self.height)
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
        match self.in_space() {
            true => self.draw_space(canvas, (index, &numbers))?,
            false => {
                for drawn in &self.shapes() {
                    self.draw_shape(canvas, drawn, (index, &numbers))?;
                }
            }
        }
        self.draw_arrows(canvas, &numbers)?;
        self.draw_events(canvas, t)?;
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
    fn shapes(&self) -> Vec<Drawn<'_>> {
        let mut shapes = Drawn::all(&self.animation);
        shapes.sort_by_key(|drawn| match drawn.shape {
            Shape::Curve(_) => 0,
            Shape::Trace(_) => 1,
            Shape::Spring => 2,
            Shape::Line(_) => 3,
            _ => 4,
        });
        shapes
    }

    /// Finds the scale at which the picture holds the motion.
    fn measure(&mut self) {
        let Extent { low, high, reach } = self.extent;
        let size = match self.in_space() {
            true => [2.0 * reach; 2],
            false => [high[0] - low[0], high[1] - low[1]],
        };
        let [width, height] = size.map(|length| length.max(1e-9 * reach));
        let free = HEIGHTS.1 - f64::from(FREE.1);
        self.scale = (f64::from(WIDTH - FREE.0) / width).min(free / height);
        let wanted = height * self.scale + f64::from(FREE.1);
        self.height = BAND + wanted.clamp(HEIGHTS.0, HEIGHTS.1).round() as i32;
    }

    fn measure_springs(&mut self) {
        let mut longest = vec![0.0; self.animation.shapes.len()];
        for drawn in self.shapes().iter().filter(|drawn| *drawn.shape == Shape::Spring) {
            let length = |numbers: &[f64]| {
                let (points, _) = drawn.points(numbers);
                (0..3).map(|k| (points[0][k] - points[1][k]).powi(2)).sum::<f64>().sqrt()
            };
            longest[drawn.place] = self.animation.frames.iter().map(|(_, numbers)| length(numbers)).fold(0.0, f64::max);
        }
        self.longest = longest;
    }

    /// Where a point is, px.
    fn pixel(&self, point: Point) -> (f64, f64) {
        let centre = self.extent.centre();
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
        self.place([x, y, self.extent.floor()])
    }

    fn draw_plane<B: DrawingBackend>(&self, canvas: &Canvas<B>) -> Outcome<B> {
        let (centre, bottom, unit) = (self.extent.centre(), self.height * FINE, self.unit());
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
        let step = round_step(self.extent.reach / 5.0);
        let ends = |k: usize| ((self.extent.low[k] / step).floor() as i64, (self.extent.high[k] / step).ceil() as i64);
        let ((x0, x1), (y0, y1)) = (ends(0), ends(1));
        let at = |x: i64, y: i64| [x as f64 * step, y as f64 * step, self.extent.floor()];
        let grid = GRID.stroke_width(FINE as u32);
        for (from, to) in (x0..=x1).map(|x| (at(x, y0), at(x, y1))).chain((y0..=y1).map(|y| (at(x0, y), at(x1, y)))) {
            stroke(canvas, [self.place(from), self.place(to)], grid)?;
        }
        let label = format!("grid {}{}", crate::numbers::short(step), self.unit());
        write(canvas, &label, (16, self.height - 14), HPos::Left, (12, QUIET))?;
        let (centre, corner) = (self.extent.centre(), (60.0, f64::from(self.height) - 70.0));
        let middle = self.pixel(centre);
        for (axis, name) in self.animation.ground_axes().into_iter().zip(["x", "y", "z"]) {
            let tip = self.pixel(plus(centre, 1.0 / self.scale, axis));
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

    /// All shapes of a motion in space, over their shadows.
    fn draw_space<B: DrawingBackend>(&self, canvas: &Canvas<B>, now: (usize, &[f64])) -> Outcome<B> {
        let shapes = self.shapes();
        for drawn in &shapes {
            self.draw_shadow(canvas, drawn, now.1)?;
        }
        for (drawn, part) in ordered(&shapes, now.1, towards(), self.extent.reach) {
            self.draw_part(canvas, &drawn, part, now)?;
        }
        Ok(())
    }

    fn draw_shadow<B: DrawingBackend>(&self, canvas: &Canvas<B>, drawn: &Drawn<'_>, numbers: &[f64]) -> Outcome<B> {
        let (points, radius) = drawn.points(numbers);
        let mut places = points.iter().map(|point| self.shadow(*point));
        let faint = SHADOW.mix(0.5).filled();
        match drawn.shape {
            Shape::Trace(_) | Shape::Plane | Shape::Axes | Shape::UnitAxes => Ok(()),
            Shape::Circle => disc(canvas, places.next().flatten(), self.radius(radius), faint),
            Shape::Line(_) | Shape::Spring | Shape::Curve(_) => {
                stroke(canvas, places, SHADOW.stroke_width(3 * FINE as u32))
            }
            _ => {
                for outline in outlines(drawn.shape, drawn.own(numbers), [0.0, 0.0, 1.0]) {
                    let places = outline.points.iter().map(|point| self.shadow(*point));
                    match outline.face {
                        true => fill(canvas, places, faint)?,
                        false => stroke(canvas, places, SHADOW.stroke_width(2 * FINE as u32))?,
                    }
                }
                Ok(())
            }
        }
    }

    fn draw_part<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        drawn: &Drawn<'_>,
        part: Part,
        now: (usize, &[f64]),
    ) -> Outcome<B> {
        let axes = *drawn.shape == Shape::Axes;
        let paint = |which: usize| if axes { COLOURS[AXES[which % 3]] } else { COLOURS[drawn.place % 6] };
        match part {
            Part::Whole => self.draw_shape(canvas, drawn, now),
            Part::Line(which, points) => {
                let width = if matches!(drawn.shape, Shape::Line(_)) { 5 } else { 2 };
                let places = points.iter().map(|point| self.place(*point));
                stroke(canvas, places, paint(which).stroke_width((width * FINE) as u32))
            }
            Part::Joint(point) => self.draw_joint(canvas, self.place(point), paint(0)),
            Part::Tip(which, tip) => {
                let begin = self.pixel(drawn.origin(now.1));
                let (x, y) = self.pixel(tip);
                let (dx, dy) = (x - begin.0, y - begin.1);
                let beyond = LETTER / dx.hypot(dy).max(1.0);
                let at = ((x + beyond * dx).round() as i32, (y + beyond * dy).round() as i32);
                write(canvas, ["x", "y", "z"][which % 3], at, HPos::Center, (12, paint(which)))
            }
        }
    }

    fn draw_joint<B: DrawingBackend>(&self, canvas: &Canvas<B>, place: Place, paint: RGBColor) -> Outcome<B> {
        disc(canvas, place, 4 * FINE, WHITE.filled())?;
        disc(canvas, place, 4 * FINE, paint.stroke_width(2 * FINE as u32))
    }

    /// A shape in space of faces and lines: a disc and a plane are seen through, solids are not.
    fn draw_solid<B: DrawingBackend>(&self, canvas: &Canvas<B>, drawn: &Drawn<'_>, numbers: &[f64]) -> Outcome<B> {
        let (paint, tint, width) = match drawn.shape {
            Shape::Plane => (QUIET, PANE, FINE as u32),
            _ => (COLOURS[drawn.place % 6], TINT, 2 * FINE as u32),
        };
        for outline in outlines(drawn.shape, drawn.own(numbers), towards()) {
            let places: Vec<Place> = outline.points.iter().map(|point| self.place(*point)).collect();
            if outline.face && !matches!(drawn.shape, Shape::Disc | Shape::Plane) {
                fill(canvas, places.iter().copied(), WHITE.filled())?;
            }
            if outline.face {
                fill(canvas, places.iter().copied(), paint.mix(tint).filled())?;
            }
            stroke(canvas, places, paint.stroke_width(width))?;
        }
        Ok(())
    }

    fn draw_shape<B: DrawingBackend>(
        &self,
        canvas: &Canvas<B>,
        drawn: &Drawn<'_>,
        (index, numbers): (usize, &[f64]),
    ) -> Outcome<B> {
        let paint = COLOURS[drawn.place % 6];
        let (points, radius) = drawn.points(numbers);
        let places: Vec<Place> = points.iter().map(|point| self.place(*point)).collect();
        let two = 2 * FINE as u32;
        match drawn.shape {
            Shape::Line(_) => {
                stroke(canvas, places.iter().copied(), paint.stroke_width(5 * FINE as u32))?;
                places.into_iter().try_for_each(|place| self.draw_joint(canvas, place, paint))
            }
            Shape::Circle => {
                disc(canvas, places[0], self.radius(radius), paint.mix(0.25).filled())?;
                disc(canvas, places[0], self.radius(radius), paint.stroke_width(two))
            }
            Shape::Spring => {
                let ends = [self.pixel(points[0]), self.pixel(points[1])];
                // A spring keeps its width, which follows from its greatest length.
                let half = (0.06 * self.scale * self.longest[drawn.place]).clamp(1.5, 8.0);
                stroke(canvas, coils(ends, half), paint.stroke_width(two))
            }
            Shape::Curve(_) => stroke(canvas, places, QUIET.stroke_width(two)),
            Shape::Trace(_) => {
                let path = self.path(drawn, index).chain(if self.animation.repeat { None } else { Some(places[0]) });
                stroke(canvas, path, paint.mix(0.7).stroke_width(3 * FINE as u32 / 2))?;
                disc(canvas, places[0], 3 * FINE, paint.filled())
            }
            _ => self.draw_solid(canvas, drawn, numbers),
        }
    }

    /// The path of a trace up to a frame; a motion that repeats shows all of it.
    fn path(&self, drawn: &Drawn<'_>, index: usize) -> impl Iterator<Item = Place> {
        let count = if self.animation.repeat { usize::MAX } else { index + 1 };
        let past = self.animation.frames.iter().take(count);
        past.map(move |(_, numbers)| self.place(drawn.points(numbers).0[0]))
    }

    /// A radius in drawing units.
    fn radius(&self, radius: f64) -> i32 {
        ((self.scale * radius).max(3.0) * f64::from(FINE)) as i32
    }
}

/// The direction from which a motion in space is looked at.
fn towards() -> Point {
    let ((s, c), (rise, level)) = (AZIMUTH.sin_cos(), ELEVATION.sin_cos());
    [c * level, s * level, rise]
}

/// Letters of a title that have a place beside the time.
const MOST_LETTERS: usize = 48;

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

mod over;
#[cfg(test)]
mod tests;
