//! A motion that repeats, in double-double: what its pieces miss each other by is told in 32 digits, and taken away by the slopes of the search.

use dalembert_symbolic::expr::DoubleDouble;
use nalgebra::DVector;

use super::closing::Closing;
use super::found::{ExtendedOrbit, ExtendedValue};
use super::laps::{Laps, Solution, Time};
use super::structure;
use crate::error::{Error, NoOrbit};
use crate::mechanism::{ExtendedAt, Interpreted};
use crate::precision::{DoubleOnly, SCHEMES, Scheme, extended_motion, smooth_model};
use crate::run::Names;
use crate::vary::TOLD;

/// Corrections by slopes of some ten digits: two lead from the digits of a search to all that there are, and one says so.
const CORRECTIONS: usize = 8;
/// A last correction of this size, in parts of what it changes, leaves some digits more than numbers in `f64` have.
const LEAST: f64 = 1e-20;

/// A motion that is wanted in double-double.
pub(super) struct Wanted {
    /// The mechanism to interpret, or why there is none.
    pub model: Result<Interpreted, DoubleOnly>,
    /// The energy that is asked for, J, counted from the equilibrium where there is one.
    pub energy: Option<f64>,
    /// The coordinates of the equilibrium from which energies are counted.
    pub rests: Option<Vec<f64>>,
}

/// The unknowns of a search.
struct Point {
    starts: Vec<Vec<DoubleDouble>>,
    lap: DoubleDouble,
}

/// A search that is gone on with.
struct Refinement<'a> {
    laps: &'a Laps,
    solution: &'a Solution,
    model: Interpreted,
    /// The Jacobi integral that is asked for, J.
    energy: Option<DoubleDouble>,
}

impl Wanted {
    /// The motion that a search in `f64` found.
    ///
    /// # Errors
    /// [`NoOrbit::DoubleOnly`] says what is in the way.
    pub fn of(&self, laps: &mut Laps, solution: &Solution) -> Result<ExtendedOrbit, Error> {
        let found = self.found(laps, solution);
        found.map_err(|why| match why {
            DoubleOnly::Interrupted => NoOrbit::Interrupted { start: laps.start_of(&solution.point) }.into(),
            why => NoOrbit::DoubleOnly { why: why.to_string() }.into(),
        })
    }

    fn found(&self, laps: &mut Laps, solution: &Solution) -> Result<ExtendedOrbit, DoubleOnly> {
        let model = self.model.as_ref().map_err(|why| *why)?;
        match laps.time {
            Time::Free => (),
            Time::Driven => return Err(DoubleOnly::Time),
            Time::Event => return Err(DoubleOnly::Events),
        }
        let model = smooth_model((&*laps.system, &laps.settings), model)?;
        let rest = self.rests.as_ref().map(|q| {
            let q: Vec<DoubleDouble> = q.iter().map(|q| (*q).into()).collect();
            jacobi(&model, &q, &vec![DoubleDouble::ZERO; q.len()])
        });
        let rest = rest.unwrap_or(DoubleDouble::ZERO);
        let energy = self.energy.map(|energy| rest + energy);
        let keeps_energy = laps.keeps_energy();
        let refinement = Refinement { laps, solution, model, energy };
        let (point, off) = refinement.corrected()?;
        Ok(refinement.told(&point, &off, keeps_energy.then_some(rest)))
    }
}

impl Refinement<'_> {
    /// Corrections until they shrink no more, and how far the point may be off, in units of the scales.
    fn corrected(&self) -> Result<(Point, DVector<f64>), DoubleOnly> {
        let extended = |y: &Vec<f64>| y.iter().map(|y| (*y).into()).collect();
        let Solution { point, linear, .. } = self.solution;
        let mut point = Point { starts: point.starts.iter().map(extended).collect(), lap: point.lap.into() };
        let mut before = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            let step = linear.step(&self.missed(&point, SCHEMES[0])?);
            let size = step.norm();
            if size > 0.5 * before || size.is_nan() {
                break;
            }
            self.correct(&mut point, &step);
            before = size;
        }
        if before > LEAST {
            return Err(DoubleOnly::Unsettled { by: before });
        }
        // Another method's steps round otherwise.
        let other = linear.step(&self.missed(&point, SCHEMES[1])?);
        Ok((point, other.map(|x| TOLD * x.abs() + before)))
    }

    /// What does not close, as [`Laps::try_at`] has it: how a family is told apart stays what it is.
    fn missed(&self, point: &Point, scheme: Scheme) -> Result<DVector<f64>, DoubleOnly> {
        let Laps { closing, settings, scales, legs, .. } = self.laps;
        let (count, width) = (point.starts.len(), scales.len());
        let mut r = DVector::zeros(self.solution.trial.r.len());
        let times = [DoubleDouble::ZERO, point.lap / (*legs as f64).into()];
        for (k, start) in point.starts.iter().enumerate() {
            let ends = extended_motion(&self.model, start.clone(), (&times, scales), scheme, &settings.interruption)?;
            let end = &ends[1];
            let (next, closes) = ((k + 1) % count, self.laps.closes(k));
            let image = if closes { image(closing, end) } else { end.clone() };
            // What may differ at the end of all laps does not count there.
            let counted = |i: &usize| !(closes && next == 0 && closing.shifts.contains(i));
            for i in (0..width).filter(counted) {
                r[k * width + i] = (image[i] - point.starts[next][i]).to_f64() / scales[i];
            }
        }
        let first = &point.starts[0];
        for k in 0..closing.reversals().len() {
            // A row of unit length, of numbers that it adds up to 0.
            let row = count * width + k;
            let terms = first.iter().zip(scales).enumerate();
            let sum = terms.map(|(i, (x, scale))| *x * (self.solution.trial.j[(row, i)] / scale));
            r[row] = sum.fold(DoubleDouble::ZERO, |sum, term| sum + term).to_f64();
        }
        if let Some(wanted) = self.energy {
            let side = &self.solution.trial.pieces[0].start;
            let (_, slopes) = structure::energy(&*self.laps.system, side);
            let size = slopes.iter().zip(scales).map(|(slope, scale)| (slope * scale).powi(2)).sum::<f64>().sqrt();
            let (q, v) = first.split_at(width / 2);
            r[self.laps.energy_row(count)] = (jacobi(&self.model, q, v) - wanted).to_f64() / size;
        }
        Ok(r)
    }

    fn correct(&self, point: &mut Point, step: &DVector<f64>) {
        let scales = self.laps.scales.iter().cycle();
        let numbers = point.starts.iter_mut().flatten();
        numbers.zip(scales).zip(step.iter()).for_each(|((x, scale), part)| *x += DoubleDouble::from(scale * part));
        point.lap += DoubleDouble::from(self.solution.point.lap * step[step.len() - 1]);
    }

    /// With energies counted from `rest`, where they are conserved.
    fn told(&self, point: &Point, off: &DVector<f64>, rest: Option<DoubleDouble>) -> ExtendedOrbit {
        let Refinement { laps, solution, model, .. } = self;
        let value = |name: String, value: DoubleDouble, error: f64| ExtendedValue {
            name,
            value: value.to_f64(),
            rest: value.rest(),
            error: error.max(DoubleDouble::UNIT * value.to_f64().abs()),
        };
        let names = Names::of(laps.system.description()).columns();
        let start = &point.starts[0];
        let errors: Vec<f64> = laps.scales.iter().zip(off.iter()).map(|(scale, off)| scale * off).collect();
        let told = start.iter().enumerate().map(|(i, x)| value(names[i].clone(), *x, errors[i]));
        let times = (laps.duration(&solution.trial) / solution.point.lap).round();
        let period_error = off[off.len() - 1] * solution.point.lap * times;
        let energy = rest.map(|rest| {
            let (q, v) = start.split_at(start.len() / 2);
            let (_, slopes) = structure::energy(&*laps.system, &solution.trial.pieces[0].start);
            let error = slopes.iter().zip(&errors).map(|(slope, error)| (slope * error).abs()).sum();
            value("energy".to_owned(), jacobi(model, q, v) - rest, error)
        });
        ExtendedOrbit {
            period: value("period".to_owned(), point.lap * times, period_error),
            start: told.collect(),
            energy,
        }
    }
}

/// The Jacobi integral, J.
fn jacobi(model: &Interpreted, q: &[DoubleDouble], v: &[DoubleDouble]) -> DoubleDouble {
    model.extended_jacobi(ExtendedAt { t: DoubleDouble::ZERO, q, v, a: &[] })
}

/// As [`Closing::image`].
fn image(closing: &Closing, y: &[DoubleDouble]) -> Vec<DoubleDouble> {
    let n = closing.images.len();
    let turned = |half: &[DoubleDouble]| -> Vec<DoubleDouble> {
        closing.images.iter().map(|(k, opposite)| if *opposite { -half[*k] } else { half[*k] }).collect()
    };
    let mut image = [turned(&y[..n]), turned(&y[n..])].concat();
    // All digits of 2π are taken, of which a turn has sixteen.
    let turns = closing.turns.iter().map(|turn| DoubleDouble::PI * (2.0 * (turn / std::f64::consts::TAU)));
    image.iter_mut().zip(turns).for_each(|(x, turn)| *x = *x - turn);
    image
}
