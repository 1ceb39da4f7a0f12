//! Equilibria and small motions of mechanisms with states of first order.
//!
//! With coordinates q, rates v and states z the equations are F(q, v, z, v') = 0 and z' = f(q, v, z): one system whose unknowns at rest are
//! (q, z), with the columns ∂F/∂q for q and ∂F/∂z for z.  Small departures x = (δq, δv, δz) obey x' = A x + B u,
//!
//! A = [0 1 0; −M⁻¹K −M⁻¹C −M⁻¹∂F/∂z; ∂f/∂q ∂f/∂v ∂f/∂z],
//!
//! with constraints and rotations in the coordinates that these leave independent: `candidate.rs`.
//!
//! A state is kept as the speed of a hidden coordinate, whose row and column are left out: no zero of A comes from it.

use std::ops::AddAssign;

use nalgebra::{DMatrix, DVector};

use super::Guess;
use super::candidate::{Candidate, Departures};
use super::least_steps::{BALANCED, Rest};
use crate::linear::constrained::Inputs;
use crate::linear::forced::{Pushed, named_answers, rated, together};
use crate::linear::matrices::balanced;
use crate::linear::modes::{doubted_modes, graded_modes};
use crate::linear::{Drive, FirstOrder, InputOutput, LinearError, NamedDrive, Residual, Source};
use crate::mechanism::{Coordinate, Description, HIDDEN, System, rate_name};
use crate::show::unit;

/// A rest, or a steady motion, of a mechanism with states of first order, and its small departures x' = A x + B u.
#[derive(Clone, Debug, PartialEq)]
pub struct StateSpace {
    /// Coordinates and states with their values there, SI.
    pub place: Vec<(String, f64)>,
    /// Coordinates that move steadily, and their speeds.
    pub speeds: Vec<(String, f64)>,
    /// What is left of each equation, of its terms: the largest.
    pub residual: f64,
    /// Iterations of Newton's method.
    pub iterations: usize,
    /// The names of x: coordinates (with constraints or rotations those that are independent), their rates, states.
    pub variables: Vec<String>,
    /// The names of all coordinates.
    pub coordinates: Vec<String>,
    /// Z: how all coordinates follow those of `variables`, a column each.
    pub motions: DMatrix<f64>,
    /// The reactions of constraints in force, by name.
    pub reactions: Vec<(String, f64)>,
    /// A, 1/s where rows and columns are in the units of `variables`.
    pub matrix: DMatrix<f64>,
    /// The names of u: inputs, and after each those of its rates that act.
    pub inputs: Vec<String>,
    /// B, a column for each of these.
    pub input: DMatrix<f64>,
    /// Eigenvalues and shapes of A; these are in units of their own, see [`StateSpace::shapes`].
    pub analysis: FirstOrder,
    /// The size, 1/s, below which eigenvalues are not told from 0, for rounding of what constraints eliminate hides them; `None` where all are.
    pub blurred: Option<f64>,
    /// The unit of each variable in the analysis, a power of 2.
    scales: Vec<f64>,
    /// The places of the inputs that can move.
    moving: Vec<usize>,
    /// Inputs that cannot move by themselves, and why: constraints would contradict each other, or follow an input and not its rate.
    pub immovable: Vec<(String, LinearError)>,
    /// The rest itself.
    guess: Guess,
    /// As [`Candidate::unknowns`].
    unknowns: Vec<f64>,
}

/// Finds the rest (or, with speeds in the guess, the steady motion) nearest to a guess of coordinates and states, or takes the guess itself
/// where `here` is set, and linearises there.  States are the last of `guess.v`.
///
/// # Errors
/// [`LinearError::NoEquilibrium`], [`LinearError::NotAnEquilibrium`], [`LinearError::NotSmooth`], [`LinearError::Discontinuous`],
/// [`LinearError::DependsOnTime`], and numbers that are not finite; with constraints those of
/// [`linearise_constrained`](crate::linear::linearise_constrained), and [`LinearError::SteadyWithStates`] of a guess that moves.
pub fn linearise_states<S: System + ?Sized>(system: &S, guess: &Guess, here: bool) -> Result<StateSpace, LinearError> {
    let mut search = Search::new(system, guess)?;
    if let Err(error) = search.at.check() {
        if error.is_of_time() && !here && search.newton().is_ok() && search.is_met(BALANCED) {
            search.at.check()?;
        }
        return Err(error.without_rest());
    }
    let iterations = if here { Ok(0) } else { search.newton() };
    let iterations = iterations.map_err(|iterations| search.nowhere(iterations))?;
    if !search.is_met(BALANCED) {
        return Err(match here {
            true => LinearError::NotAnEquilibrium { residual: search.forces_left() },
            false => search.nowhere(iterations),
        });
    }
    search.at.check()?;
    search.at.check_rest()?;
    search.linearised(iterations)
}

impl StateSpace {
    /// The state in which it rests, hidden coordinates and all.
    #[cfg(feature = "cli")]
    pub(crate) fn rest(&self) -> &Guess {
        &self.guess
    }

    /// x' = A x + B u and y = C x + D u of these drives, whose inputs are those of the model by their places, and of answers by name:
    /// coordinates, rates, states, outputs.
    ///
    /// # Errors
    /// As [`observe`](crate::linear::observe); [`LinearError::ReactionToForce`], [`LinearError::OutOfPhase`], and why an input cannot move.
    pub fn input_output<S: System + ?Sized>(
        &self,
        system: &S,
        drives: &[NamedDrive],
        answers: &[&str],
    ) -> Result<InputOutput, LinearError> {
        let description = system.description();
        let drives = self.among_moving(description, drives)?;
        let mut here = Candidate::new(system, &self.guess)?;
        here.set(&self.unknowns);
        let all = self.motions.ncols();
        let n = self.variables.len() - all;
        let names = named_answers(description, answers);
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let seen = here.observe(description, &names)?;
        let whole = self.motions.nrows();
        let Pushed { inputs, forces, direct } =
            Pushed::by(&drives, [&here.inputs()?.forces, &DMatrix::identity(whole, whole)], &seen)?;
        let b = here.departures(&forces)?.drive;
        // Rows of A from n on are those of all accelerations, hidden ones among them.
        let mut c = &seen.acceleration * self.matrix.rows(n, all);
        c.columns_mut(0, n).add_assign(&seen.place.columns(0, n));
        c.columns_mut(n, all).add_assign(&seen.rate);
        let d = together(seen.names.len(), &direct) + &seen.acceleration * b.rows(n, all);
        Ok(InputOutput {
            states: self.variables.iter().map(|name| [name.clone(), unit(description, name)]).collect(),
            inputs,
            outputs: seen.named().into_iter().map(|[name, unit]| [shown(&name), unit]).collect(),
            a: self.matrix.clone(),
            b,
            c,
            d,
        })
    }

    /// These drives, whose inputs are counted among all of the model, with inputs counted among those that can move.
    ///
    /// # Errors
    /// Why one cannot; [`LinearError::WrongSize`] of an input or a coordinate that does not exist.
    fn among_moving(&self, description: &Description, drives: &[NamedDrive]) -> Result<Vec<NamedDrive>, LinearError> {
        let source = |source: Source| match source {
            Source::Input(place) => {
                let expected = description.inputs.len();
                let wrong = LinearError::WrongSize { what: "the input's index", given: place, expected };
                let name = description.inputs.get(place).ok_or(wrong.clone())?;
                if let Some((_, why)) = self.immovable.iter().find(|(input, _)| *input == **name) {
                    return Err(why.clone());
                }
                self.moving.iter().position(|known| *known == place).map(Source::Input).ok_or(wrong)
            }
            Source::Force(i) if i >= self.coordinates.len() => {
                let expected = self.coordinates.len();
                Err(LinearError::WrongSize { what: "the coordinate's index", given: i, expected })
            }
            Source::Force(_) => Ok(source),
        };
        let moved = |named: &NamedDrive| {
            let parts = named.drive.parts.iter().map(|(what, amplitude)| Ok((source(*what)?, *amplitude)));
            let parts = parts.collect::<Result<_, LinearError>>()?;
            Ok(NamedDrive { drive: Drive { parts }, ..named.clone() })
        };
        drives.iter().map(moved).collect()
    }

    /// The shapes of the eigenvalues that are not 0, in the order of `variables`, the largest component of each 1.
    pub fn shapes(&self) -> Vec<Vec<nalgebra::Complex<f64>>> {
        let whole = |shape: &nalgebra::DVector<nalgebra::Complex<f64>>| {
            let mut all: Vec<_> = shape.iter().zip(&self.scales).map(|(x, scale)| x * *scale).collect();
            let largest = all.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm()));
            if let Some(largest) = largest.filter(|x| x.norm() > 0.0) {
                all.iter_mut().for_each(|x| *x /= largest);
            }
            all
        };
        self.analysis.shapes.iter().map(whole).collect()
    }
}

/// The name of a state for that of its hidden coordinate's rate.
fn shown(name: &str) -> String {
    name.strip_suffix('\'').filter(|name| name.starts_with(HIDDEN)).map_or_else(|| name.to_owned(), rate_name)
}

struct Search {
    at: Candidate,
    /// What inputs are held at.
    held: Vec<f64>,
    coordinates: Vec<Coordinate>,
}

impl Search {
    fn new<S: System + ?Sized>(system: &S, guess: &Guess) -> Result<Search, LinearError> {
        let coordinates = system.description().coordinates.to_vec();
        Ok(Search { at: Candidate::new(system, guess)?, held: guess.inputs.clone(), coordinates })
    }

    /// The state, and what is left there, by name.
    fn nowhere(&self, iterations: usize) -> LinearError {
        LinearError::NoEquilibrium { iterations, point: self.place(), residual: self.forces_left() }
    }

    fn place(&self) -> Vec<(String, f64)> {
        let name = |c: &Coordinate| c.state().unwrap_or(&c.name).to_owned();
        self.coordinates.iter().map(name).zip(self.unknowns()).collect()
    }

    fn forces_left(&self) -> Vec<Residual> {
        self.at.base.forces(&self.at.base.force(&self.at.q))
    }

    fn linearised(&self, iterations: usize) -> Result<StateSpace, LinearError> {
        let Candidate { base, q, n, .. } = &self.at;
        if let Some(jump) = base.jumps(q).first() {
            let residual = base.forces(&jump.force).into_iter().filter(|jump| jump.force != 0.0);
            let jumps = residual.map(|jump| Residual { force: jump.force.abs(), ..jump }).collect();
            return Err(LinearError::Discontinuous { point: self.place(), switch: jump.switch.clone(), jump: jumps });
        }
        base.without_corner(q)?;
        let Inputs { moving, forces, immovable } = self.at.inputs()?;
        // Rates of inputs are inputs of their own where they act.
        let acts = |k: &usize| k.is_multiple_of(3) || forces.column(*k).iter().any(|x| *x != 0.0);
        let acting: Vec<usize> = (0..forces.ncols()).filter(acts).collect();
        let forces: Vec<DVector<f64>> = acting.iter().map(|k| forces.column(*k).into_owned()).collect();
        let Departures { matrix, drive, independent, motions, doubt } = self.at.departures(&forces)?;
        let (balanced, scales) = balanced(&matrix);
        let (analysis, blurred) = match doubt {
            None => (graded_modes(&balanced)?, None),
            Some(doubt) => {
                let scaled = |i: usize, j: usize| doubt[(i, j)] * (scales[j] / scales[i]);
                doubted_modes(&balanced, &DMatrix::from_fn(doubt.nrows(), doubt.ncols(), scaled))?
            }
        };
        let known: Vec<String> = base.system.borrow().description().inputs.iter().map(ToString::to_string).collect();
        let places = independent.iter().filter(|i| **i < *n).map(|i| self.coordinates[*i].name.to_string());
        let rates = independent.iter().map(|i| rate_name(&self.coordinates[*i].name));
        let speeds = self.coordinates[..*n].iter().zip(&base.v).filter(|(_, v)| **v != 0.0);
        Ok(StateSpace {
            place: self.place(),
            speeds: speeds.map(|(c, v)| (rate_name(&c.name), *v)).collect(),
            residual: self.residual(),
            iterations,
            variables: places.chain(rates).collect(),
            coordinates: self.coordinates[..*n].iter().map(|c| c.name.to_string()).collect(),
            motions,
            reactions: self.at.reactions(),
            analysis,
            blurred,
            matrix,
            inputs: acting.iter().map(|k| rated(&known[moving[k / 3]], "", k % 3)[0].clone()).collect(),
            moving,
            immovable,
            guess: self.at.guess(&self.held),
            unknowns: self.at.unknowns(),
            input: drive,
            scales,
        })
    }
}

impl Rest for Search {
    fn unknowns(&self) -> Vec<f64> {
        self.at.unknowns()
    }

    fn units(&self) -> Vec<String> {
        self.at.units()
    }

    fn set(&mut self, unknowns: &[f64]) {
        self.at.set(unknowns);
    }

    fn left(&self) -> Vec<f64> {
        self.at.left()
    }

    fn measures(&self) -> Vec<f64> {
        self.at.measures()
    }

    fn slopes(&self) -> DMatrix<f64> {
        self.at.slopes()
    }
}
