//! Pictures of modes and responses: shapes over the mechanism's drawing, animations, Bode plots, root loci.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::{LinearError, Linearised, Mode};
use crate::mechanism::{Shape, System};
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

/// Size and phase of every coordinate's answer to an input, against the frequency.
///
/// # Errors
/// As [`Linearised::response_to_input`]; frequencies that meet an undamped mode leave a gap instead.
pub fn bode(linear: &Linearised, input: usize, omegas: &[f64]) -> Result<Figure, LinearError> {
    let mut answers: Vec<Option<Vec<Complex<f64>>>> = Vec::new();
    for omega in omegas {
        answers.push(match linear.response_to_input(input, *omega) {
            Err(LinearError::Resonance { .. }) => None,
            answer => Some(answer?),
        });
    }
    let frequency = || Axis::new("frequency", "rad/s").log();
    let name = linear.inputs.get(input).map_or("the input", String::as_str);
    let mut size = Chart::new(format!("response to {name}"), frequency(), Axis::new("size", "").log());
    let mut phase = Chart::new("", frequency(), Axis::new("phase", "rad"));
    for (index, coordinate) in linear.coordinates.iter().enumerate() {
        let series = |value: fn(&Complex<f64>) -> f64| {
            let point =
                |(omega, answer): (&f64, &Option<Vec<Complex<f64>>>)| Some((*omega, value(&answer.as_ref()?[index])));
            Series::line(coordinate.clone(), omegas.iter().zip(&answers).map(point))
        };
        size.series.push(series(|x| x.norm()));
        phase.series.push(series(|x| x.arg()));
    }
    Ok(Figure { charts: vec![size, phase] })
}

/// Eigenvalues in the complex plane as a parameter changes; a series of marks for each of its values.
pub fn root_locus(title: &str, eigenvalues: &[(f64, Vec<Complex<f64>>)]) -> Chart {
    let chart = Chart::new(title, Axis::new("Re", "1/s"), Axis::new("Im", "rad/s"));
    eigenvalues.iter().fold(chart, |chart, (value, list)| {
        chart.with(Series::marks(format!("{value}"), list.iter().map(|x| Some((x.re, x.im)))))
    })
}

/// The numbers of all shapes at q₀ + a Re(φ e^(i phase)).
fn drawing<S: System + ?Sized>(system: &S, linear: &Linearised, mode: &Mode, a: f64, phase: f64) -> Vec<f64> {
    let turn = Complex::new(phase.cos(), phase.sin());
    let at = &linear.equilibrium;
    let q: Vec<f64> = at.q.iter().zip(&mode.shape).map(|(q, x)| q + a * (x * turn).re).collect();
    let mut numbers = vec![0.0; system.description().drawing_len()];
    system.drawing(0.0, &q, &at.v, &mut numbers);
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
