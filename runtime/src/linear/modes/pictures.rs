//! Pictures of modes: shapes over the mechanism's drawing, animations, root loci.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::Mode;
use crate::linear::{Linearised, short};
use crate::mechanism::{At, Shape, System};
use crate::show::{Animation, Axis, Chart, Figure, Series, Style};

/// Drawn points move by at most this part of the drawing's size.
const SWING: f64 = 0.15;
/// Frames of one period.
const FRAMES: u32 = 60;

/// One period of a mode as an animation that repeats: q = q₀ + a Re(φ e^(iωt)), without its growth or decay.
///
/// The amplitude is chosen for the eye.  Rigid and overdamped modes go to and fro in 2 s.
pub fn animate_mode<S: System + ?Sized>(system: &S, linear: &Linearised, mode: &Mode) -> Animation {
    let amplitude = amplitude(system, linear, mode);
    let omega = if mode.eigenvalue.im > 0.0 { mode.eigenvalue.im } else { 0.5 * TAU };
    let frames = (0..=FRAMES).map(|i| {
        let phase = TAU * f64::from(i) / f64::from(FRAMES);
        // The last frame is the first, to the last digit.
        let phase = if i == FRAMES { 0.0 } else { phase };
        (TAU * f64::from(i) / f64::from(FRAMES) / omega, drawing(system, linear, mode, amplitude, phase))
    });
    let animation = Animation::of(system.description()).with_frames(frames);
    Animation { about: mode.to_string(), repeat: true, ..animation }
}

/// Each mode's shape over the mechanism at rest (dashed); where the mechanism is not drawn, or in space, its elements
/// by coordinate.
pub fn draw_modes<S: System + ?Sized>(system: &S, linear: &Linearised, modes: &[Mode]) -> Figure {
    let description = system.description();
    let flat = description.structure.dimension == 2 && description.drawing_len() > 0;
    let chart = |(index, mode): (usize, &Mode)| {
        let title = format!("mode {}: {}", index + 1, mode);
        if !flat {
            let points = mode.shape.iter().enumerate().map(|(i, x)| Some((i as f64 + 1.0, x.re)));
            return Chart::new(title, Axis::new("coordinate", ""), Axis::new("shape", ""))
                .with(Series::marked_line("", points));
        }
        let a = amplitude(system, linear, mode);
        let lines = |phase, a| outline(&description.draw, &drawing(system, linear, mode, a, phase));
        Chart::new(title, Axis::new("x", "m"), Axis::new("y", "m"))
            .with(Series { style: Style::Dashed, ..Series::line("at rest", lines(0.0, 0.0)) })
            .with(Series::line("one way", lines(0.0, a)))
            .with(Series::line("the other way", lines(0.5 * TAU, a)))
            .equal()
    };
    Figure { charts: modes.iter().enumerate().map(chart).collect() }
}

/// Eigenvalues in the complex plane as a parameter goes through some values; marks where it begins and ends.
///
/// `eigenvalues` are pairs of a value and all eigenvalues there; neighbours are joined where they are nearest.
pub fn root_locus(parameter: &str, unit: &str, eigenvalues: &[(f64, Vec<Complex<f64>>)]) -> Chart {
    let mut branches: Vec<Vec<Option<(f64, f64)>>> = Vec::new();
    let mut ends: Vec<Complex<f64>> = Vec::new();
    for (_, list) in eigenvalues {
        if ends.len() != list.len() {
            ends.clone_from(list);
            branches.extend(ends.iter().map(|x| vec![None, Some((x.re, x.im))]));
            continue;
        }
        let last = branches.len() - ends.len();
        ends = matched(&ends, list);
        for (end, branch) in ends.iter().zip(&mut branches[last..]) {
            branch.push(Some((end.re, end.im)));
        }
    }
    let value =
        |value: f64| format!("{parameter} = {}", if unit == "1" { short(value) } else { with_unit(value, unit) });
    let title = format!("eigenvalues as {parameter} changes");
    let chart = Chart::new(title, Axis::new("real part", "1/s"), Axis::new("imaginary part", "rad/s"));
    let marks =
        |(at, list): &(f64, Vec<Complex<f64>>)| Series::marks(value(*at), list.iter().map(|x| Some((x.re, x.im))));
    let chart = chart.with(Series::line("", branches.into_iter().flatten()));
    eigenvalues.first().into_iter().chain(eigenvalues.last()).fold(chart, |chart, end| chart.with(marks(end)))
}

/// `next` in such an order that each stands where one of `before` is near.
pub(crate) fn matched(before: &[Complex<f64>], next: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let mut left = next.to_vec();
    let take = |end: &Complex<f64>| {
        let apart = |x: &Complex<f64>| (x - *end).norm();
        let nearest = (0..left.len()).min_by(|a, b| apart(&left[*a]).total_cmp(&apart(&left[*b])));
        nearest.map_or(*end, |nearest| left.swap_remove(nearest))
    };
    before.iter().map(take).collect()
}

fn with_unit(value: f64, unit: &str) -> String {
    format!("{} {unit}", short(value)).trim_end().to_owned()
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
    let finite = || rest.iter().filter(|x| x.is_finite());
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    let most = rest.iter().zip(&moved).map(|(a, b)| (a - b).abs()).filter(|d| d.is_finite()).fold(0.0, f64::max);
    let amplitude = SWING * (high - low) * small / most;
    if amplitude.is_finite() && amplitude > 0.0 { amplitude } else { 1.0 }
}

/// Lines, springs, curves and circles in the plane as one path with gaps.
fn outline(shapes: &[Shape], numbers: &[f64]) -> Vec<Option<(f64, f64)>> {
    let mut path = Vec::new();
    let mut left = numbers;
    for shape in shapes {
        let (own, others) = left.split_at(shape.numbers(2).min(left.len()));
        left = others;
        match (shape, own) {
            (Shape::Trace(_), _) => continue,
            (Shape::Circle, [x, y, radius]) => {
                let rim = (0..=24).map(|i| TAU * f64::from(i) / 24.0);
                path.extend(rim.map(|angle| Some((x + radius * angle.cos(), y + radius * angle.sin()))));
            }
            _ => path.extend(own.chunks_exact(2).map(|point| Some((point[0], point[1])))),
        }
        path.push(None);
    }
    path
}
