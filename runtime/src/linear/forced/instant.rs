//! Small departures from a motion, at one of its instants.

use nalgebra::{DMatrix, DVector};

use super::input_output::rated;
use super::observed::{Answer, chosen, named_answers};
use super::{InputOutput, NamedDrive, Source};
use crate::linear::LinearError;
use crate::mechanism::{Along, At, Singular, System, rate_name};
use crate::run::Names;
use crate::show::unit;
use crate::vary::Response;

/// x' = A x + B u and y = C x + D u at an instant of a motion: what departures x from it do there, u being departures of inputs from what they
/// are along the motion, and y those of answers: coordinates, rates, states, outputs by name.
///
/// A = ∂f/∂x and B = ∂f/∂u of the rates f = (q', q''), exact derivatives with the accelerations and multipliers of the motion, in the phase and
/// on the sides of discontinuities that the system has.  All three matrices change along the motion, so that eigenvalues of A tell how
/// departures grow at the instant, and not whether the motion is stable (W. Rugh, *Linear System Theory*, 1996, ch. 8).  With constraints x are
/// departures of all coordinates; those that the constraints allow are fewer.
///
/// # Errors
/// [`LinearError::NoAccelerations`]; [`LinearError::UnknownAnswer`]; [`LinearError::NoSlope`]; [`LinearError::MovedByInput`] for an input in a
/// constraint; [`LinearError::NotAnInput`] for a drive that is none.
///
/// # Example
/// ```
/// use dalembert::linear::{NamedDrive, Source, linearise_instant};
/// use dalembert::mechanism::{At, Dynamic};
/// # mod example {
/// dalembert::model!(yaml = r#"
/// name: Swing
/// parameters: {m: 2 kg, l: 0.5 m, g: 9.81 m/s^2}
/// coordinates: {theta: rad}
/// inputs: {torque: 0 N*m}
/// bodies: {bob: {mass: m, position: "l*[sin(theta), -cos(theta)]"}}
/// gravity: [0, -g]
/// generalized_forces: {theta: torque}
/// outputs: {tension: "m*g*cos(theta) + m*l*theta'^2"}
/// "#);
/// # }
/// let system = Dynamic::new(example::Swing::default());
/// let torque = NamedDrive { drive: Source::Input(0).into(), name: "torque".into(), unit: "N m".into() };
/// let found = linearise_instant(&system, At::new(0.0, &[1.0], &[3.0]), &[torque], &["tension"])?;
/// assert!((found.a[(1, 0)] + 9.81 / 0.5 * 1.0_f64.cos()).abs() < 1e-14);
/// assert!((found.b[(1, 0)] - 1.0 / (2.0 * 0.25)).abs() < 1e-14);
/// assert!((found.c[(0, 0)] + 2.0 * 9.81 * 1.0_f64.sin()).abs() < 1e-13 && found.c[(0, 1)] == 2.0 * 2.0 * 0.5 * 3.0);
/// # Ok::<(), dalembert::linear::LinearError>(())
/// ```
pub fn linearise_instant(
    system: &dyn System,
    at: At<'_>,
    inputs: &[NamedDrive],
    answers: &[&str],
) -> Result<InputOutput, LinearError> {
    if let Some(lock) = crate::trust::lock_here(system, at) {
        return Err(LinearError::GimbalLock(lock));
    }
    let instant = Instant::new(system, at)?;
    let (known, of_states) = (Names::of(system.description()), named_answers(system.description(), answers));
    let answers = of_states.iter().map(|name| chosen(&known, name)).collect::<Result<Vec<_>, _>>()?.concat();
    instant.input_output(inputs, &known, &answers)
}

/// A state with all that changes there.
struct Instant<'a> {
    system: &'a dyn System,
    at: At<'a>,
    response: Response,
    /// ∂y/∂(q, q', q'', λ, u, u', u'', t) of all components of the outputs.
    outputs: DMatrix<f64>,
    /// ∂F/∂(u, u', u'').
    by_inputs: DMatrix<f64>,
}

/// What inputs do, a column for each.
struct Inputs {
    names: Vec<[String; 2]>,
    /// To the accelerations.
    rates: DMatrix<f64>,
    /// To the answers.
    direct: DMatrix<f64>,
}

impl<'a> Instant<'a> {
    fn new(system: &'a dyn System, at: At<'a>) -> Result<Self, LinearError> {
        let description = system.description();
        let (n, rows, m) = (system.len(), description.rows.len(), 3 * description.inputs.len());
        let mut response = Response::default();
        response.stand(system, at).map_err(|fault| no_accelerations(system, fault))?;
        response.take_jacobians(system, at);
        let full = at.accelerated(&response.a).constrained(&response.lambda);
        let mut outputs = DMatrix::zeros(description.output_len(), 3 * n + rows + m + 1);
        if !system.output_slopes(full, outputs.as_mut_slice()) {
            outputs.fill(f64::NAN);
        }
        let mut values = vec![0.0; description.input_pattern.len()];
        system.input_jacobian(full, &mut values);
        let mut by_inputs = DMatrix::zeros(n, m);
        for ((row, column), value) in description.input_pattern.iter().zip(values) {
            by_inputs[(*row as usize, *column as usize)] = value;
        }
        Ok(Instant { system, at, response, outputs, by_inputs })
    }

    fn input_output(
        mut self,
        drives: &[NamedDrive],
        known: &Names,
        answers: &[Answer],
    ) -> Result<InputOutput, LinearError> {
        let description = self.system.description();
        let (n, first) = (self.system.len(), description.mechanical());
        // Nothing depends on the hidden coordinate of a state.
        let states: Vec<usize> = (0..first).chain(n..2 * n).collect();
        let (mut a, mut c) = (DMatrix::zeros(states.len(), states.len()), DMatrix::zeros(answers.len(), states.len()));
        let mut along = vec![0.0; 2 * n];
        for (column, state) in states.iter().enumerate() {
            along[*state] = 1.0;
            let (q, v) = along.split_at(n);
            let direction = Along { q, v, ..Along::default() };
            self.response
                .column(self.system, self.at, &direction)
                .map_err(|fault| no_accelerations(self.system, fault))?;
            along[*state] = 0.0;
            if (n..n + first).contains(state) {
                a[(state - n, column)] = 1.0;
            }
            a.view_mut((first, column), (n, 1)).copy_from_slice(&self.response.da);
            c.set_column(column, &self.answers(answers, *state));
        }
        let Inputs { names, rates, direct } = self.inputs(drives, answers)?;
        let mut b = DMatrix::zeros(states.len(), names.len());
        b.rows_mut(first, n).copy_from(&rates);
        let named = |name: String| {
            let unit = unit(description, &name);
            [name, unit]
        };
        let state_name = |state: &usize| match *state < n {
            true => description.coordinates[*state].name.to_string(),
            false => rate_name(&description.coordinates[state - n].name),
        };
        let outputs = answers.iter().map(|answer| named(answer.name(known))).collect();
        let unknown = |row: &usize| c.row(*row).iter().chain(direct.row(*row).iter()).any(|x| !x.is_finite());
        if let Some(row) = (0..answers.len()).find(unknown) {
            return Err(LinearError::NoSlope { answer: answers[row].name(known) });
        }
        Ok(InputOutput {
            states: states.iter().map(|state| named(state_name(state))).collect(),
            inputs: names,
            outputs,
            a,
            b,
            c,
            d: direct,
        })
    }

    /// What inputs, and where they act their rates, do to accelerations and answers.
    fn inputs(&mut self, drives: &[NamedDrive], answers: &[Answer]) -> Result<Inputs, LinearError> {
        let n = self.system.len();
        let (mut names, mut rates, mut direct) = (Vec::new(), Vec::new(), Vec::new());
        for NamedDrive { drive, name, unit } in drives {
            let [(Source::Input(input), _)] = drive.parts.as_slice() else {
                return Err(LinearError::NotAnInput { drive: name.clone() });
            };
            self.moves_no_constraint(*input, name)?;
            for order in 0..3 {
                let place = 3 * input + order;
                let force: Vec<f64> = self.by_inputs.column(place).iter().map(|slope| -slope).collect();
                let solved = self.response.of_force(self.system, self.at, &force);
                solved.map_err(|fault| no_accelerations(self.system, fault))?;
                let answer = self.answers(answers, 3 * n + self.response.lambda.len() + place);
                if order == 0 || force.iter().chain(answer.iter()).any(|x| *x != 0.0) {
                    rates.extend_from_slice(&self.response.da);
                    direct.extend_from_slice(answer.as_slice());
                    names.push(rated(name, unit, order));
                }
            }
        }
        Ok(Inputs {
            rates: DMatrix::from_vec(n, names.len(), rates),
            direct: DMatrix::from_vec(answers.len(), names.len(), direct),
            names,
        })
    }

    /// What the last direction, along this argument of the outputs by itself, does to all answers.
    fn answers(&self, answers: &[Answer], argument: usize) -> DVector<f64> {
        let n = self.system.len();
        let answer = |answer: &Answer| match answer {
            Answer::Coordinate(i) => f64::from(*i == argument),
            Answer::Rate(i) => f64::from(n + i == argument),
            Answer::Output(k) => {
                let slopes = self.outputs.row(*k);
                let carried = self.response.da.iter().chain(&self.response.dlambda).enumerate();
                slopes[argument] + carried.map(|(i, x)| slopes[2 * n + i] * x).sum::<f64>()
            }
        };
        DVector::from_iterator(answers.len(), answers.iter().map(answer))
    }

    /// Refuses an input in a constraint: what rows demand of accelerations by inputs is not generated.
    fn moves_no_constraint(&self, input: usize, name: &str) -> Result<(), LinearError> {
        let description = self.system.description();
        let rows = description.rows.len();
        let mut columns = vec![0.0; 2 * rows * description.inputs.len()];
        if rows > 0 && self.system.constraint_rates_by_inputs(self.at, &mut columns) {
            let own = &columns[2 * rows * input..2 * rows * (input + 1)];
            if let Some(place) = own.iter().position(|x| *x != 0.0) {
                let constraint = description.rows[place % rows].name.to_string();
                return Err(LinearError::MovedByInput { constraint, input: name.to_owned() });
            }
        }
        Ok(())
    }
}

fn no_accelerations(system: &dyn System, fault: Singular) -> LinearError {
    LinearError::NoAccelerations(Box::new(fault.cause(system.description())))
}
