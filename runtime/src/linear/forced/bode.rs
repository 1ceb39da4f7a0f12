//! Bode plots.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::response::{ROUNDING, is_opposite};
use super::{Drive, Observed, Response};
use crate::linear::{LinearError, Linearised};
use crate::show::{Axis, Chart, Figure, Series};

/// Size and phase of every coordinate's answer to a drive of unit amplitude, at these frequencies, rad/s; `name` says what
/// drives.
///
/// Phases are in degrees, negative where the answer comes late, and continuous along the curve.  Frequencies that meet
/// an undamped mode leave a gap; [`Linearised::response`] chooses frequencies of its own, whose curves are whole, and takes
/// outputs too.
///
/// # Errors
/// As [`Linearised::frequency_response`].
pub fn bode(linear: &Linearised, drive: &Drive, name: &str, omegas: &[f64]) -> Result<Figure, LinearError> {
    let seen = Observed::coordinates(linear);
    let answers = linear.answers(drive, &seen, omegas)?;
    let response = Response {
        drive: name.to_owned(),
        per: String::new(),
        names: seen.names,
        units: seen.units,
        omegas: omegas.to_vec(),
        answers,
        poles: Vec::new(),
    };
    Ok(response.figure())
}

/// Sizes and phases over the frequency: in rad/s, or in Hz where 2π rad/s are `one`.
pub(super) fn figure(response: &Response, one: f64) -> Figure {
    let ends = response.omegas.first().zip(response.omegas.last()).map(|(low, high)| (low / one, high / one));
    let frequency = || Axis { range: ends, ..Axis::new("frequency", if one == TAU { "Hz" } else { "rad/s" }).log() };
    let units: Vec<String> = (0..response.names.len()).map(|answer| response.unit(answer)).collect();
    let same = units.windows(2).all(|pair| pair[0] == pair[1]);
    let unit = if same { units.first().map_or("", String::as_str) } else { "" };
    let frame = response.frame();
    // What is rounding beside the largest answer that is shown has no phase.
    let sizes = response.answers.iter().flatten().flatten().map(|x| x.norm());
    let floor = ROUNDING * frame.map_or_else(|| sizes.fold(0.0, f64::max), |(_, top)| top);
    let sizes = Axis { range: frame, ..Axis::new("amplitude", unit).log() };
    let mut size = Chart::new(format!("response to {}", response.drive), frequency(), sizes);
    let mut phase = Chart::new("", frequency(), Axis::new("phase", "degrees").every(45.0));
    for (index, (name, unit)) in response.names.iter().zip(&units).enumerate() {
        let label = if same || unit.is_empty() { name.clone() } else { format!("{name} ({unit})") };
        let at = |omega: f64, y: Option<f64>| y.map(|y| (omega / one, y));
        let answers = moving(response, index, floor);
        let points = answers.iter().map(|(omega, x)| at(*omega, x.map(|x| x.norm())));
        size.series.push(Series::line(label.clone(), points));
        let turned = answers.iter().zip(phases(&answers, &response.poles));
        phase
            .series
            .push(Series::line(label, turned.map(|((omega, _), turned)| at(*omega, turned)).collect::<Vec<_>>()));
    }
    Figure::from(vec![size, phase])
}

/// An answer at each frequency, where it is larger than rounding.
fn moving(response: &Response, index: usize, floor: f64) -> Vec<(f64, Option<Complex<f64>>)> {
    let answers = response.answers.iter().map(|answer| answer.as_ref().map(|x| x[index]));
    let moves = |x: &Complex<f64>| x.norm() > floor;
    response.omegas.iter().copied().zip(answers.map(|x| x.filter(moves))).collect()
}

/// Degrees, continuous; half a turn later behind each pole and earlier behind each zero.
fn phases(answers: &[(f64, Option<Complex<f64>>)], poles: &[f64]) -> Vec<Option<f64>> {
    let mut before: Option<(f64, Complex<f64>, f64)> = None;
    let turned = answers.iter().map(|(omega, x)| {
        let Some(x) = *x else {
            before = None;
            return None;
        };
        let angle = match before {
            // Half a turn counts as late.
            None => Some(x.arg().to_degrees()).map(|a| if a > 179.999 { a - 360.0 } else { a })?,
            Some((last, y, angle)) if is_opposite(y, x) => {
                let passed = poles.iter().any(|pole| (last..=*omega).contains(pole));
                if passed { angle - 180.0 } else { angle + 180.0 }
            }
            Some((_, y, angle)) => angle + (x * y.conj()).arg().to_degrees(),
        };
        before = Some((*omega, x, angle));
        Some(angle)
    });
    turned.collect()
}
