//! Bode plots.

use nalgebra::Complex;

use super::Drive;
use crate::linear::{LinearError, Linearised};
use crate::show::{Axis, Chart, Figure, Series};

/// Size and phase of every coordinate's answer to a drive of unit amplitude, against the frequency; `name` says what
/// drives.
///
/// Phases are in degrees, negative where the answer comes late, and continuous along the curve.  Frequencies that meet
/// an undamped mode leave a gap.
///
/// # Errors
/// As [`Linearised::frequency_response`].
pub fn bode(linear: &Linearised, drive: &Drive, name: &str, omegas: &[f64]) -> Result<Figure, LinearError> {
    let answers = linear.frequency_response(drive, omegas)?;
    let frequency = || Axis::new("frequency", "rad/s").log();
    let same = linear.units.windows(2).all(|pair| pair[0] == pair[1]);
    let unit = if same { linear.units.first().map_or("", String::as_str) } else { "" };
    let mut size = Chart::new(format!("response to {name}"), frequency(), Axis::new("amplitude", unit).log());
    let mut phase = Chart::new("", frequency(), Axis::new("phase", "degrees").every(45.0));
    for (index, coordinate) in linear.coordinates.iter().enumerate() {
        let label = match linear.units.get(index) {
            Some(unit) if !same && !unit.is_empty() => format!("{coordinate} ({unit})"),
            _ => coordinate.clone(),
        };
        let elements = || omegas.iter().zip(answers.iter().map(|answer| answer.as_ref().map(|x| x[index])));
        // What is rounding beside the largest answer has no phase.
        let most = answers.iter().flatten().flatten().fold(0.0_f64, |most, x| most.max(x.norm()));
        let moves = |x: &Complex<f64>| x.norm() > 1e-13 * most;
        let sizes = elements().map(|(omega, x)| x.filter(moves).map(|x| (*omega, x.norm())));
        size.series.push(Series::line(label.clone(), sizes));
        let mut before: Option<f64> = None;
        let phases = elements().map(|(omega, x)| {
            let Some(x) = x.filter(moves) else {
                before = None;
                return None;
            };
            // Half a turn counts as late.
            let angle = Some(x.arg().to_degrees()).map(|a| if a > 179.999 { a - 360.0 } else { a })?;
            let turns = before.map_or(0.0, |last| (last - angle) / 360.0);
            // Without damping answers are in step or opposed, and half a turn to and fro is no winding.
            let opposed = x.im.abs() <= 1e-12 * x.norm();
            let turned =
                if opposed && (turns.abs() - 0.5).abs() < 1e-6 { angle } else { angle + 360.0 * turns.round() };
            before = Some(turned);
            Some((*omega, turned))
        });
        phase.series.push(Series::line(label, phases.collect::<Vec<_>>()));
    }
    Ok(Figure::from(vec![size, phase]))
}
