//! Pictures of modes: shapes over the mechanism's drawing, animations.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::{Kind, Mode};
use crate::linear::equilibrium::LinearisationPoint;
use crate::linear::{Linearised, short};
use crate::mechanism::{At, Shape, System};
use crate::show::{Animation, Axis, Chart, Figure, Series, Style};

/// Drawn points move by at most this part of the drawing's size.
const SWING: f64 = 0.15;
/// Half the width of a spring's coils, of the drawing's size; how many there are, and the part at each end that is straight.
const COIL: f64 = 0.02;
const COILS: u32 = 6;
const STRAIGHT: f64 = 0.15;
/// What is lower, of its width, lies along x.
const LOW: f64 = 0.1;
/// Corners of what stands for a circle.
const CORNERS: u32 = 60;
/// Frames of one period.
const FRAMES: u32 = 60;

/// One period of a mode as an animation that repeats: q = q₀ + a Re(φ e^(iωt)), without its growth or decay; inputs are held
/// where the equilibrium has them.
///
/// The amplitude is chosen for the eye.  Rigid and overdamped modes go to and fro in 2 s.
pub fn animate_mode<S: System + ?Sized>(system: &S, linear: &Linearised, mode: &Mode) -> Animation {
    let held = LinearisationPoint::new(system, &linear.equilibrium.guess());
    let still = held.system.borrow();
    let amplitude = amplitude(&**still, linear, mode);
    let omega = if mode.eigenvalue.im > 0.0 { mode.eigenvalue.im } else { 0.5 * TAU };
    let frames = (0..=FRAMES).map(|i| {
        let phase = TAU * f64::from(i) / f64::from(FRAMES);
        // The last frame is the first, to the last digit.
        let phase = if i == FRAMES { 0.0 } else { phase };
        (TAU * f64::from(i) / f64::from(FRAMES) / omega, drawing(&**still, linear, mode, amplitude, phase))
    });
    let animation = Animation::of(system.description()).with_frames(frames);
    Animation { about: mode.to_string(), repeat: true, ..animation }
}

/// Each mode's shape over the mechanism at rest (dashed); where the mechanism is not drawn, or in space, its elements
/// by coordinate.  Several stand side by side.
pub fn draw_modes<S: System + ?Sized>(system: &S, linear: &Linearised, modes: &[Mode]) -> Figure {
    let description = system.description();
    let held = LinearisationPoint::new(system, &linear.equilibrium.guess());
    let still = held.system.borrow();
    let system = &**still;
    let flat = description.structure.dimension == 2 && description.drawing_len() > 0;
    let chart = |(index, mode): (usize, &Mode)| {
        let title = title(index, mode);
        if !flat {
            return by_coordinate(title, &linear.equilibrium.coordinates, mode);
        }
        let a = amplitude(system, linear, mode);
        let width = COIL * size(&drawing(system, linear, mode, 0.0, 0.0));
        let lines = |phase, a, width| outline(&description.draw, &drawing(system, linear, mode, a, phase), width);
        // Dashes leave nothing of coils.
        let lines = [lines(0.0, 0.0, 0.0), lines(0.0, a, width), lines(0.5 * TAU, a, width)];
        let apart = apart(&lines);
        let [rest, one, other] = lines;
        let moved = |line: Vec<Option<(f64, f64)>>, up: f64| line.into_iter().map(move |p| p.map(|(x, y)| (x, y + up)));
        Chart::new(title, Axis::new("x", "m"), if apart > 0.0 { Axis::default() } else { Axis::new("y", "m") })
            .with(Series { style: Style::Dashed, ..Series::line("at rest", rest) })
            .with(Series::line("one way", moved(one, apart)))
            .with(Series::line("the other way", moved(other, -apart)))
            .equal()
    };
    let charts: Vec<Chart> = modes.iter().enumerate().map(chart).collect();
    let columns = if charts.len() < 3 { 1 } else { 2 };
    Figure { charts, columns }
}

/// A mode's elements as marks above or below nought, those of a family joined.
fn by_coordinate(title: String, coordinates: &[String], mode: &Mode) -> Chart {
    let place = |i: usize| Some((i as f64 + 1.0, mode.shape[i].re));
    let family = |i: usize| coordinates[i].split_once('[').map(|(family, _)| family);
    let stems = (0..mode.shape.len()).flat_map(|i| [Some((i as f64 + 1.0, 0.0)), place(i), None]);
    let marks = (0..mode.shape.len()).flat_map(|i| {
        let apart = i > 0 && (family(i).is_none() || family(i) != family(i - 1));
        apart.then_some(None).into_iter().chain([place(i)])
    });
    Chart::new(title, Axis::new("coordinate", "").named(coordinates), Axis::new("shape", ""))
        .with(Series::line("", stems))
        .with(Series::marked_line("", marks).coloured(0))
}

/// `mode 2: 1.41421 rad/s, 0.225079 Hz`: as much as stands above a small picture.
fn title(index: usize, mode: &Mode) -> String {
    let what = match (&mode.name, mode.kind) {
        (Some(name), _) => name.clone(),
        (None, Kind::Overdamped | Kind::Decaying | Kind::Critical | Kind::Rigid) => mode.kind.word().to_owned(),
        (None, kind) => {
            let word = if kind == Kind::Unstable { "unstable, " } else { "" };
            format!("{word}{} rad/s, {} Hz", short(mode.omega), short(mode.omega / TAU))
        }
    };
    format!("mode {}: {what}", index + 1)
}

/// The numbers of all shapes at q₀ + a Re(φ e^(i phase)).
fn drawing<S: System + ?Sized>(system: &S, linear: &Linearised, mode: &Mode, a: f64, phase: f64) -> Vec<f64> {
    let turn = Complex::new(phase.cos(), phase.sin());
    let at = &linear.equilibrium;
    let q: Vec<f64> = at.q.iter().zip(&mode.shape).map(|(q, x)| q + a * (x * turn).re).collect();
    let mut numbers = vec![0.0; system.description().drawing_len()];
    system.drawing(At::new(0.0, &q, &at.v), &mut numbers);
    numbers
}

/// An amplitude that moves the drawing by a good part of its size.
fn amplitude<S: System + ?Sized>(system: &S, linear: &Linearised, mode: &Mode) -> f64 {
    let rest = drawing(system, linear, mode, 0.0, 0.0);
    let small = 1e-6;
    let moved = drawing(system, linear, mode, small, 0.0);
    // As they are drawn, with the length that the picture gives to axes.
    let picture = Animation::of(system.description()).with_frames([(0.0, rest), (1.0, moved)]);
    let picture = picture.upright();
    let [(_, rest), (_, moved)] = &picture.frames[..] else { return 1.0 };
    let most = rest.iter().zip(moved).map(|(a, b)| (a - b).abs()).filter(|d| d.is_finite()).fold(0.0, f64::max);
    let amplitude = SWING * size(rest) * small / most;
    if amplitude.is_finite() && amplitude > 0.0 { amplitude } else { 1.0 }
}

/// How far pictures of what lies along x are drawn above each other, m; 0 where they are seen as they lie.
fn apart(lines: &[Vec<Option<(f64, f64)>>]) -> f64 {
    let span = |of: fn(&(f64, f64)) -> f64| {
        let values = lines.iter().flatten().flatten().map(of);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    let (width, height) = (span(|point| point.0), span(|point| point.1));
    if height < LOW * width { 1.5 * LOW * width } else { 0.0 }
}

/// From the least to the largest number of a drawing.
fn size(numbers: &[f64]) -> f64 {
    let finite = numbers.iter().filter(|x| x.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    high - low
}

/// A spring from one point to another: straight at its ends, coils of this half width between.
fn spring((from, to): ([f64; 2], [f64; 2]), width: f64) -> impl Iterator<Item = (f64, f64)> {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    let across = if length > 0.0 { [-along[1] / length, along[0] / length] } else { [0.0, 0.0] };
    let turns = 2 * COILS;
    let point = move |part: f64, aside: f64| {
        (from[0] + part * along[0] + aside * across[0], from[1] + part * along[1] + aside * across[1])
    };
    let coils = (0..turns).map(move |k| {
        let part = STRAIGHT + (1.0 - 2.0 * STRAIGHT) * (f64::from(k) + 0.5) / f64::from(turns);
        point(part, if k % 2 == 0 { width } else { -width })
    });
    let ends = [point(0.0, 0.0), point(STRAIGHT, 0.0)];
    ends.into_iter().chain(coils).chain([point(1.0 - STRAIGHT, 0.0), point(1.0, 0.0)])
}

/// Lines, springs, curves and circles in the plane as one path with gaps; springs have coils of this half width.
fn outline(shapes: &[Shape], numbers: &[f64], width: f64) -> Vec<Option<(f64, f64)>> {
    let mut path = Vec::new();
    let mut left = numbers;
    for shape in shapes {
        let (own, others) = left.split_at(shape.numbers(2).min(left.len()));
        left = others;
        match (shape, own) {
            (Shape::Trace(_), _) => continue,
            (Shape::Circle, [x, y, radius]) => {
                let rim = (0..=CORNERS).map(|i| TAU * f64::from(i) / f64::from(CORNERS));
                path.extend(rim.map(|angle| Some((x + radius * angle.cos(), y + radius * angle.sin()))));
            }
            (Shape::Spring, [a, b, c, d]) => path.extend(spring(([*a, *b], [*c, *d]), width).map(Some)),
            _ => path.extend(own.chunks_exact(2).map(|point| Some((point[0], point[1])))),
        }
        path.push(None);
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::{Guess, LinearMechanism, equilibrium_near, linearise};
    use nalgebra::DMatrix;

    #[test]
    fn what_is_not_drawn_is_shown_by_coordinate_from_nought_on() {
        let springs = DMatrix::from_row_slice(2, 2, &[2.0, -1.0, -1.0, 1.0]);
        let system = LinearMechanism::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), springs).unwrap();
        let linear = linearise(&system, &equilibrium_near(&system, &Guess::at(&[0.0, 0.0])).unwrap()).unwrap();
        let modes = linear.modes().unwrap();
        let figure = draw_modes(&system, &linear, &modes);
        for (chart, mode) in figure.charts.iter().zip(&modes) {
            assert_eq!(chart.x.names, linear.coordinates);
            let [stems, marks] = &chart.series[..] else { panic!("{chart:?}") };
            assert_eq!(stems.points[..3], [Some((1.0, 0.0)), Some((1.0, mode.shape[0].re)), None]);
            assert_eq!(marks.points.iter().flatten().count(), 2);
        }
        assert_eq!(figure.charts.len(), 2);
    }
}
