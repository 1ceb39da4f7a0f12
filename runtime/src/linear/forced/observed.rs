//! What outputs do in small motions: their exact slopes at an equilibrium.

use nalgebra::{Complex, DMatrix, RowDVector};

use super::response::ROUNDING;
use super::{Drive, Source};
use crate::linear::equilibrium::LinearisationPoint;
use crate::linear::{LinearError, Linearised};
use crate::mechanism::{Description, System, rate_name};
use crate::run::Names;
use crate::show::unit;

/// Answers y of small motions: y − y₀ = `place` x + `rate` x' + `acceleration` x'' + `input` (u, u', u'') + `force` f.
///
/// With p answers, n coordinates and m inputs; exact derivatives of the model's outputs, never differences.
#[derive(Clone, Debug, PartialEq)]
pub struct Observed {
    /// Names of the answers, components of vectors by themselves: `x`, `x'`, `tip.y`.
    pub names: Vec<String>,
    /// Their units, SI; empty where they are pure numbers or not known.
    pub units: Vec<String>,
    /// ∂y/∂q, p × n.
    pub place: DMatrix<f64>,
    /// ∂y/∂q', p × n.
    pub rate: DMatrix<f64>,
    /// ∂y/∂q'', p × n.
    pub acceleration: DMatrix<f64>,
    /// ∂y/∂(u, u', u''), p × 3m.
    pub input: DMatrix<f64>,
    /// ∂y/∂f of generalized forces f on the model's coordinates, p × N: 0 but for reactions of constraints, which carry
    /// them.
    pub force: DMatrix<f64>,
    /// Which answers contain named reactions, whose balances know the file's own loads only.
    pub of_reactions: Vec<bool>,
}

/// The slopes of coordinates (`x`), rates (`x'`) and outputs at a linear model's equilibrium; the name of a vector
/// stands for its components.
///
/// # Errors
/// [`LinearError::UnknownAnswer`]; [`LinearError::NoSlope`] for an output that has no derivative there, or whose
/// system knows none; [`LinearError::AnswerVaries`] for one that changes with time, or along a steady motion.
///
/// # Example
/// The force that an oscillator hands to the ground, k x + c x', per unit of a force on its mass, is
/// (k + iΩc)/(k + iΩc − Ω²m):
/// ```
/// use dalembert::linear::{Guess, Source, equilibrium_near, linearise, observe};
/// use dalembert::mechanism::Dynamic;
/// # mod example {
/// dalembert::model!(yaml = r#"
/// name: Mounted
/// parameters: {m: 2 kg, c: 3 N*s/m, k: 50 N/m}
/// coordinates: {x: m}
/// kinetic_energy: m*x'^2/2
/// potential_energy: k*x^2/2
/// dissipation: c*x'^2/2
/// outputs: {to_ground: "k*x + c*x'"}
/// "#);
/// # }
/// # use example::Mounted;
/// let system = Dynamic::new(Mounted::default());
/// let linear = linearise(&system, &equilibrium_near(&system, &Guess::at(&[0.0]))?)?;
/// let to_ground = observe(&system, &linear, &["to_ground"])?;
/// let answers = linear.answers(&Source::Force(0).into(), &to_ground, &[5.0])?;
/// let size = answers[0].as_ref().unwrap()[0].norm();
/// assert!((size - 50.0_f64.hypot(15.0) / 15.0).abs() < 1e-13);
/// # Ok::<(), dalembert::linear::LinearError>(())
/// ```
pub fn observe<S: System + ?Sized>(system: &S, linear: &Linearised, names: &[&str]) -> Result<Observed, LinearError> {
    let probe = LinearisationPoint::new(system, &linear.equilibrium.guess());
    let rows = vec![0.0; system.description().rows.len()];
    slopes_of(system.description(), &probe, &linear.equilibrium.q, &rows, names).map(|(seen, _)| seen)
}

/// The slopes of answers by the model's own coordinates and inputs, and by the multipliers of all rows of constraints, at a
/// state of a linearisation point with its multipliers.
pub(in crate::linear) fn slopes_of(
    description: &Description,
    probe: &LinearisationPoint,
    q: &[f64],
    lambda: &[f64],
    names: &[&str],
) -> Result<(Observed, DMatrix<f64>), LinearError> {
    let known = Names::of(description);
    let chosen = names.iter().map(|name| chosen(&known, name)).collect::<Result<Vec<_>, _>>()?.concat();
    let mut seen = Observed::empty(chosen.len(), probe.n, description.inputs.len());
    let mut by_multipliers = DMatrix::zeros(chosen.len(), lambda.len());
    let slopes = match chosen.iter().any(|answer| matches!(answer, Answer::Output(_))) {
        true => Some(Slopes::new(probe, q, lambda)?),
        false => None,
    };
    let owners: Vec<usize> =
        description.outputs.iter().enumerate().flat_map(|(k, o)| vec![k; o.components as usize]).collect();
    for (row, answer) in chosen.into_iter().enumerate() {
        let name = match answer {
            Answer::Coordinate(i) => {
                seen.place[(row, i)] = 1.0;
                known.coordinates[i].clone()
            }
            Answer::Rate(i) => {
                seen.rate[(row, i)] = 1.0;
                format!("{}'", known.coordinates[i])
            }
            Answer::Output(k) => {
                if let Some(slopes) = &slopes {
                    let carried = slopes.put(k, row, &known.outputs[k], &mut seen)?;
                    by_multipliers.row_mut(row).copy_from(&carried);
                }
                seen.of_reactions[row] = description.outputs_of_reactions.contains(&(owners[k] as u32));
                known.outputs[k].clone()
            }
        };
        seen.units.push(unit(description, &name));
        seen.names.push(name);
    }
    Ok((seen, by_multipliers))
}

impl Observed {
    fn empty(p: usize, n: usize, m: usize) -> Observed {
        let matrix = || DMatrix::zeros(p, n);
        Observed {
            names: Vec::new(),
            units: Vec::new(),
            place: matrix(),
            rate: matrix(),
            acceleration: matrix(),
            input: DMatrix::zeros(p, 3 * m),
            force: matrix(),
            of_reactions: vec![false; p],
        }
    }

    /// The coordinates themselves.
    pub fn coordinates(linear: &Linearised) -> Observed {
        let n = linear.len();
        Observed {
            names: linear.coordinates.clone(),
            units: linear.units.clone(),
            place: DMatrix::identity(n, n),
            ..Observed::empty(n, n, linear.inputs.len())
        }
    }

    /// Names and units.
    pub(in crate::linear) fn named(&self) -> Vec<[String; 2]> {
        self.names.iter().cloned().zip(self.units.iter().cloned()).map(<[String; 2]>::from).collect()
    }

    /// Refuses reactions to generalized forces: they depend on where a force acts, which a generalized one does not say.
    pub(in crate::linear) fn admits(&self, drive: &Drive) -> Result<(), LinearError> {
        let forced = drive.parts.iter().any(|(source, _)| matches!(source, Source::Force(_)));
        match self.of_reactions.iter().position(|of_reactions| *of_reactions).filter(|_| forced) {
            Some(row) => Err(LinearError::ReactionToForce { answer: self.names[row].clone() }),
            None => Ok(()),
        }
    }

    /// The largest that an amplitude of 1 of any coordinate can make of an answer.
    pub(super) fn reach(&self, row: usize, omega: f64) -> f64 {
        (0..self.place.ncols()).map(|i| self.slope_size(row, i, omega)).fold(0.0, f64::max)
    }

    /// |∂y/∂q| + Ω |∂y/∂q'| + Ω² |∂y/∂q''| of an answer by a coordinate.
    fn slope_size(&self, row: usize, i: usize, omega: f64) -> f64 {
        let slopes = [&self.place, &self.rate, &self.acceleration].map(|slopes| slopes[(row, i)].abs());
        slopes[0] + omega * slopes[1] + omega * omega * slopes[2]
    }

    /// [`Observed::of`] with 0 in the place of what is no more than rounding of its terms; of x + G t, what stays bounded: then rates are
    /// iΩ x + G, and accelerations −Ω² x + 2iΩ G.
    pub(super) fn without_rounding(
        &self,
        (x, growth): (&[Complex<f64>], Option<&[Complex<f64>]>),
        drive: &Drive,
        omega: f64,
    ) -> Vec<Complex<f64>> {
        let mut found = self.of(x, drive, omega);
        for (row, y) in found.iter_mut().enumerate() {
            let grown = growth.into_iter().flatten().enumerate().map(|(i, growth)| {
                let turned = Complex::new(0.0, 2.0 * omega) * self.acceleration[(row, i)];
                growth * (turned + self.rate[(row, i)])
            });
            let grown: Vec<Complex<f64>> = grown.collect();
            *y += grown.iter().sum::<Complex<f64>>();
            let put_in = |(source, amplitude): &(Source, Complex<f64>)| match source {
                Source::Input(k) => {
                    let input = |order: usize| self.input[(row, 3 * k + order)].abs();
                    (input(0) + omega * input(1) + omega * omega * input(2)) * amplitude.norm()
                }
                Source::Force(k) => self.force[(row, *k)].abs() * amplitude.norm(),
            };
            let moved = x.iter().enumerate().map(|(i, x)| self.slope_size(row, i, omega) * x.norm());
            let terms = moved.chain(drive.parts.iter().map(put_in)).chain(grown.iter().map(|x| x.norm())).sum::<f64>();
            if y.norm() <= ROUNDING * terms {
                *y = Complex::ZERO;
            }
        }
        found
    }

    /// Y = (`place` + iΩ `rate` − Ω² `acceleration`) X + `input` (U, iΩ U, −Ω² U) + `force` F.
    pub(super) fn of(&self, x: &[Complex<f64>], drive: &Drive, omega: f64) -> Vec<Complex<f64>> {
        let turn = |order: u32| Complex::new(0.0, omega).powu(order);
        let answer = |row: usize| {
            let moved: Complex<f64> = x
                .iter()
                .enumerate()
                .map(|(i, x)| {
                    let slopes = [self.place[(row, i)], self.rate[(row, i)], self.acceleration[(row, i)]];
                    x * (turn(1) * slopes[1] + turn(2) * slopes[2] + slopes[0])
                })
                .sum();
            let put_in = |(source, amplitude): &(Source, Complex<f64>)| match source {
                Source::Input(k) => {
                    let input = |order: usize| self.input[(row, 3 * k + order)];
                    turn(1) * input(1) + turn(2) * input(2) + input(0)
                }
                Source::Force(k) => Complex::from(self.force[(row, *k)]),
            } * *amplitude;
            moved + drive.parts.iter().map(put_in).sum::<Complex<f64>>()
        };
        (0..self.names.len()).map(answer).collect()
    }
}

/// What is asked for.
#[derive(Clone, Copy)]
pub(super) enum Answer {
    Coordinate(usize),
    Rate(usize),
    /// A component, among those of all outputs.
    Output(usize),
}

impl Answer {
    /// Its name, a state's in the place of its hidden coordinate's rate.
    pub(super) fn name(self, known: &Names) -> String {
        match self {
            Answer::Coordinate(i) => known.coordinates[i].clone(),
            Answer::Rate(i) => rate_name(&known.coordinates[i]),
            Answer::Output(k) => known.outputs[k].clone(),
        }
    }
}

/// Names of answers as [`chosen`] knows them: a state is the rate of its hidden coordinate.
pub(in crate::linear) fn named_answers(description: &Description, answers: &[&str]) -> Vec<String> {
    let name = |answer: &&str| match description.coordinates.iter().find(|c| c.state() == Some(*answer)) {
        Some(hidden) => format!("{}'", hidden.name),
        None => (*answer).to_owned(),
    };
    answers.iter().map(name).collect()
}

/// A coordinate, a rate, a component of an output or all components of one.
pub(super) fn chosen(known: &Names, name: &str) -> Result<Vec<Answer>, LinearError> {
    let coordinate = |name: &str| known.coordinates.iter().position(|known| known == name);
    if let Some(i) = coordinate(name) {
        return Ok(vec![Answer::Coordinate(i)]);
    }
    if let Some(i) = name.strip_suffix('\'').and_then(coordinate) {
        return Ok(vec![Answer::Rate(i)]);
    }
    let belongs =
        |output: &String| output == name || output.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'));
    let outputs = known.outputs.iter().enumerate().filter(|(_, output)| belongs(output));
    let outputs: Vec<Answer> = outputs.map(|(k, _)| Answer::Output(k)).collect();
    match outputs.is_empty() {
        true => Err(LinearError::UnknownAnswer { name: name.to_owned(), known: known.columns() }),
        false => Ok(outputs),
    }
}

/// Slopes of all outputs, and what they are later, along a steady motion.
struct Slopes {
    here: DMatrix<f64>,
    later: Vec<DMatrix<f64>>,
}

/// Times, s, at which outputs are looked at again, and how far what moves steadily has come by then, SI.
const LATER: [f64; 2] = [0.31, 2.3];
/// Slopes that change by less than this part of the largest are the same.
const SAME: f64 = 1e-9;

impl Slopes {
    fn new(probe: &LinearisationPoint, q: &[f64], lambda: &[f64]) -> Result<Slopes, LinearError> {
        let at = |t: f64, q: &[f64]| {
            probe.output_slopes(t, q, lambda).ok_or_else(|| LinearError::NoSlope { answer: "outputs".to_owned() })
        };
        let moved = |far: f64| q.iter().zip(&probe.v).map(move |(q, v)| if *v == 0.0 { *q } else { q + far });
        let later = LATER.iter().map(|t| at(*t, &moved(*t).collect::<Vec<f64>>())).collect::<Result<_, _>>()?;
        Ok(Slopes { here: at(0.0, q)?, later })
    }

    /// Puts the slopes of one component into a row, but for those by multipliers, which are returned.
    fn put(
        &self,
        component: usize,
        row: usize,
        name: &str,
        seen: &mut Observed,
    ) -> Result<RowDVector<f64>, LinearError> {
        let slopes = self.here.row(component);
        let changed = |later: &DMatrix<f64>| {
            let difference = (later.row(component) - slopes).amax();
            difference > SAME * slopes.amax().max(later.row(component).amax())
        };
        let clock = slopes.len() - 1;
        if slopes.iter().any(|slope| !slope.is_finite()) {
            return Err(LinearError::NoSlope { answer: name.to_owned() });
        }
        if slopes[clock] != 0.0 || self.later.iter().any(changed) {
            return Err(LinearError::AnswerVaries { answer: name.to_owned() });
        }
        let (n, inputs) = (seen.place.ncols(), seen.input.ncols());
        for i in 0..n {
            seen.place[(row, i)] = slopes[i];
            seen.rate[(row, i)] = slopes[n + i];
            seen.acceleration[(row, i)] = slopes[2 * n + i];
        }
        (0..inputs).for_each(|k| seen.input[(row, k)] = slopes[clock - inputs + k]);
        Ok(slopes.columns(3 * n, clock - inputs - 3 * n).into_owned())
    }
}
