//! References in double-double.

use dalembert_symbolic::expr::DoubleDouble;

use super::extrapolation::{Extrapolation, Scheme};
use super::{Arithmetic, Candidate, DoubleOnly, Reference};
use crate::mechanism::{Action, ExtendedAt, Interpreted, System};
use crate::run::Names;
use crate::simulate::{Interruption, Settings};

/// The run whose values are taken, and the one that they are compared with.
pub(crate) const SCHEMES: [Scheme; 2] =
    [Scheme { rows: 13, rise: 2, tolerance: 1e-27 }, Scheme { rows: 11, rise: 4, tolerance: 1e-26 }];
/// Methods in `f64` round what the file says alike, so that they may agree better than with the motion; what is off by more than this
/// times what they do not know is another motion.
const ROUNDED_ALIKE: f64 = 10.0;
/// A run interprets no more instructions than this, about.
const MOST_OPERATIONS: u64 = 400_000_000;
/// No run takes more evaluations.
const MOST_EVALUATIONS: u64 = 4_000_000;

impl Reference {
    /// The same reference with values in double-double, by the candidate's model interpreted, where it has neither constraints nor
    /// discontinuities, tables or events; [`Reference::arithmetic`] says whether, and why not.  There may be a reason for no model.
    ///
    /// Start and parameters are the candidate's; what is written out in the file is taken to all its digits.
    pub(crate) fn extended(mut self, candidate: &Candidate, model: Result<&Interpreted, DoubleOnly>) -> Reference {
        self.arithmetic = match model.and_then(|model| self.computed(candidate, model)) {
            Ok((columns, arithmetic)) => {
                for (index, column) in columns.iter().enumerate() {
                    self.values[index] = column.iter().map(|value| value.to_f64()).collect();
                    self.rests[index] = column.iter().map(|value| value.rest()).collect();
                }
                arithmetic
            }
            Err(why) => Arithmetic::Double { why },
        };
        self
    }

    fn computed(
        &self,
        candidate: &Candidate,
        model: &Interpreted,
    ) -> Result<(Vec<Vec<DoubleDouble>>, Arithmetic), DoubleOnly> {
        let model = smooth_model((&*candidate.system, &candidate.settings), model)?;
        let interruption = &candidate.settings.interruption;
        let values = self.columns_of(&model, SCHEMES[0], interruption)?;
        let others = self.columns_of(&model, SCHEMES[1], interruption)?;
        let agreement = self.difference(&values, |column, row| others[column][row]);
        let from_double = self.difference(&values, |column, row| self.values[column][row].into());
        if from_double > ROUNDED_ALIKE * self.floor() || agreement > self.floor() {
            return Err(DoubleOnly::Differs { from: self.methods[0], by: from_double.max(agreement) });
        }
        Ok((values, Arithmetic::DoubleDouble { agreement, from_double }))
    }

    /// What is compared, by one of these schemes.
    fn columns_of(
        &self,
        model: &Interpreted,
        scheme: Scheme,
        interruption: &Interruption,
    ) -> Result<Vec<Vec<DoubleDouble>>, DoubleOnly> {
        let description = model.description();
        let n = description.coordinates.len();
        let start = self.start.iter().map(|value| (*value).into()).collect();
        let times: Vec<DoubleDouble> = self.times.iter().map(|t| (*t).into()).collect();
        let states = extended_motion(model, start, (&times, &self.sizes), scheme, interruption)?;
        // As runs name them: coordinates, rates, outputs; then time.
        let mut names = Names::of(description).columns();
        names.push("t".to_owned());
        let place = |name: &String| names.iter().position(|known| known == name).ok_or(DoubleOnly::OtherModel);
        let places = self.columns.iter().map(place).collect::<Result<Vec<usize>, DoubleOnly>>()?;
        let mut columns = vec![Vec::new(); places.len()];
        let (mut a, mut outputs) = (vec![DoubleDouble::ZERO; n], vec![DoubleDouble::ZERO; description.output_len()]);
        for (t, y) in times.into_iter().zip(states) {
            if description.outputs_use_accelerations {
                accelerations(model, t, &y, &mut a)?;
            }
            model.extended_outputs(ExtendedAt { t, q: &y[..n], v: &y[n..], a: &a }, &mut outputs);
            let row = [&y[..], &outputs, &[t]].concat();
            columns.iter_mut().zip(&places).for_each(|(column, place)| column.push(row[*place]));
        }
        Ok(columns)
    }

    /// The largest difference of values from others, in parts of ranges; what is in neither of them is no difference.
    fn difference(&self, values: &[Vec<DoubleDouble>], others: impl Fn(usize, usize) -> DoubleDouble) -> f64 {
        let mut largest = 0.0_f64;
        for (column, (values, range)) in values.iter().zip(&self.ranges).enumerate() {
            for (row, value) in values.iter().enumerate() {
                let other = others(column, row);
                let difference = match (value.is_nan(), other.is_nan()) {
                    (true, true) => 0.0,
                    (false, false) => (*value - other).abs().to_f64() / range,
                    _ => f64::INFINITY,
                };
                largest = largest.max(if difference.is_nan() { f64::INFINITY } else { difference });
            }
        }
        largest
    }
}

/// The model with the parameters of a run that was described, if its motion is smooth.
pub(crate) fn smooth_model(
    (system, settings): (&dyn System, &Settings),
    model: &Interpreted,
) -> Result<Interpreted, DoubleOnly> {
    let (description, own) = (system.description(), model.description());
    let parameters = system.parameters();
    let same = description.source_hash == own.source_hash
        && description.coordinates == own.coordinates
        && parameters.len() == own.parameters.len();
    if !same {
        return Err(DoubleOnly::OtherModel);
    }
    let acts = |action: &Action| !matches!(action, Action::Record);
    let inputs = description.inputs.len();
    let why = [
        (!description.rows.is_empty(), DoubleOnly::Constraints),
        (!description.switches.is_empty() || !description.tables.is_empty(), DoubleOnly::Switches),
        (description.events.iter().any(|event| event.actions.iter().any(acts)), DoubleOnly::Events),
        ((0..inputs).any(|index| system.signal(index).is_some()), DoubleOnly::Inputs),
    ];
    if let Some((_, why)) = why.into_iter().find(|(holds, _)| *holds) {
        return Err(why);
    }
    let mut model = model.clone();
    parameters.into_iter().enumerate().for_each(|(index, value)| model.set_parameter(index, value));
    model.set_phase(settings.phase);
    let memory = settings.memory.clone().unwrap_or_else(|| model.scene_memory(0));
    model.set_memory(&memory);
    Ok(model)
}

/// [q; q'] at these times from its value at the first one on; `sizes` is what errors of it are measured by.
pub(crate) fn extended_motion(
    model: &Interpreted,
    start: Vec<DoubleDouble>,
    (times, sizes): (&[DoubleDouble], &[f64]),
    scheme: Scheme,
    interruption: &Interruption,
) -> Result<Vec<Vec<DoubleDouble>>, DoubleOnly> {
    let n = model.len();
    let rates = |t: DoubleDouble, y: &[DoubleDouble], rates: &mut [DoubleDouble]| {
        let (q, v) = rates.split_at_mut(n);
        q.copy_from_slice(&y[n..]);
        accelerations(model, t, y, v)
    };
    let counts = &model.description().counts;
    let operations = match model.is_unformed() {
        true => u64::from(counts.accelerations),
        false => u64::from(counts.mass_and_bias) + (n as u64).pow(3) / 3,
    };
    let most = (MOST_OPERATIONS / operations.max(1)).min(MOST_EVALUATIONS);
    Extrapolation { rates: &rates, scales: sizes, scheme, most, interruption }.through(start, times)
}

fn accelerations(
    model: &Interpreted,
    t: DoubleDouble,
    y: &[DoubleDouble],
    a: &mut [DoubleDouble],
) -> Result<(), DoubleOnly> {
    let (q, v) = y.split_at(a.len());
    let solved = model.extended_accelerations(ExtendedAt { t, q, v, a: &[] }, a).is_ok();
    if solved && a.iter().all(|a| a.is_finite()) { Ok(()) } else { Err(DoubleOnly::Singular) }
}
