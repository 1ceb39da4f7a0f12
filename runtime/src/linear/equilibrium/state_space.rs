//! Equilibria and small motions of mechanisms with states of first order.
//!
//! With coordinates q, rates v and states z the equations are F(q, v, z, v') = 0 and z' = f(q, v, z): one system whose unknowns at rest are
//! (q, z), with the columns ∂F/∂q for q and ∂F/∂z for z.  Small departures x = (δq, δv, δz) obey x' = A x + B u,
//!
//! A = [0 1 0; −M⁻¹K −M⁻¹C −M⁻¹∂F/∂z; ∂f/∂q ∂f/∂v ∂f/∂z].
//!
//! A state is kept as the speed of a hidden coordinate, whose row and column are left out: no zero of A comes from it.

use std::ops::AddAssign;

use nalgebra::{DMatrix, DVector};

use super::Guess;
use super::least_steps::{BALANCED, Rest};
use super::point::LinearisationPoint;
use crate::linear::forced::{named_answers, rated, slopes_of};
use crate::linear::matrices::balanced;
use crate::linear::{FirstOrder, InputOutput, LinearError, Residual, first_order_modes};
use crate::mechanism::{Coordinate, HIDDEN, System, rate_name};
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
    /// The names of x: coordinates, their rates, states.
    pub variables: Vec<String>,
    /// A, 1/s where rows and columns are in the units of `variables`.
    pub matrix: DMatrix<f64>,
    /// The names of u: inputs, and after each those of its rates that act.
    pub inputs: Vec<String>,
    /// B, a column for each of these.
    pub input: DMatrix<f64>,
    /// Eigenvalues and shapes of A; these are in units of their own, see [`StateSpace::shapes`].
    pub analysis: FirstOrder,
    /// The unit of each variable in the analysis, a power of 2.
    scales: Vec<f64>,
    /// The places of `inputs` among (u, u', u'') of all inputs.
    acting: Vec<usize>,
    /// The rest itself.
    guess: Guess,
}

/// Finds the rest (or, with speeds in the guess, the steady motion) nearest to a guess of coordinates and states, or takes the guess itself
/// where `here` is set, and linearises there.  States are the last of `guess.v`.
///
/// # Errors
/// [`LinearError::NoEquilibrium`], [`LinearError::NotAnEquilibrium`], [`LinearError::HasConstraints`], [`LinearError::NotSmooth`],
/// [`LinearError::Discontinuous`], [`LinearError::DependsOnTime`], and numbers that are not finite.
pub fn linearise_states<S: System + ?Sized>(system: &S, guess: &Guess, here: bool) -> Result<StateSpace, LinearError> {
    let mut search = Search::new(system, guess);
    search.base.check(&search.q)?;
    let iterations = if here { Ok(0) } else { search.newton() };
    let iterations = iterations.map_err(|iterations| search.nowhere(iterations))?;
    if !search.is_met(BALANCED) {
        return Err(match here {
            true => LinearError::NotAnEquilibrium { residual: search.forces_left() },
            false => search.nowhere(iterations),
        });
    }
    search.base.check(&search.q)?;
    search.linearised(iterations)
}

impl StateSpace {
    /// x' = A x + B u and y = C x + D u of these inputs, by their places and with their units, and of answers by name: coordinates, rates,
    /// states, outputs.
    ///
    /// # Errors
    /// As [`observe`](crate::linear::observe).
    pub fn input_output<S: System + ?Sized>(
        &self,
        system: &S,
        inputs: &[(usize, String)],
        answers: &[&str],
    ) -> Result<InputOutput, LinearError> {
        let description = system.description();
        let (n, all) = (description.mechanical(), description.coordinates.len());
        let probe = LinearisationPoint::new(system, &self.guess);
        let names = named_answers(description, answers);
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let rows = vec![0.0; description.rows.len()];
        let (seen, _) = slopes_of(description, &probe, &self.guess.q, &rows, &names)?;
        let chosen = inputs.iter().flat_map(|(place, unit)| {
            let own = self.acting.iter().enumerate().filter(move |(_, k)| *k / 3 == *place);
            own.map(move |(column, k)| (column, *k, unit))
        });
        let chosen: Vec<(usize, usize, &String)> = chosen.collect();
        let b = self.input.select_columns(&chosen.iter().map(|(column, ..)| *column).collect::<Vec<_>>());
        let direct = seen.input.select_columns(&chosen.iter().map(|(_, k, _)| *k).collect::<Vec<_>>());
        // Rows of A from n on are those of all accelerations, hidden ones among them.
        let mut c = &seen.acceleration * self.matrix.rows(n, all);
        c.columns_mut(0, n).add_assign(&seen.place.columns(0, n));
        c.columns_mut(n, all).add_assign(&seen.rate);
        let d = direct + &seen.acceleration * b.rows(n, all);
        let input = |(column, k, unit): &(usize, usize, &String)| {
            [self.inputs[*column].clone(), rated("", unit, k % 3)[1].clone()]
        };
        Ok(InputOutput {
            states: self.variables.iter().map(|name| [name.clone(), unit(description, name)]).collect(),
            inputs: chosen.iter().map(input).collect(),
            outputs: seen.named().into_iter().map(|[name, unit]| [shown(&name), unit]).collect(),
            a: self.matrix.clone(),
            b,
            c,
            d,
        })
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
    base: LinearisationPoint,
    /// What inputs are held at.
    held: Vec<f64>,
    coordinates: Vec<Coordinate>,
    /// How many coordinates are not hidden.
    n: usize,
    q: Vec<f64>,
}

impl Search {
    fn new<S: System + ?Sized>(system: &S, guess: &Guess) -> Search {
        let description = system.description();
        let (n, mut q) = (description.mechanical(), guess.q.clone());
        q.iter_mut().skip(n).for_each(|hidden| *hidden = 0.0);
        Search {
            base: LinearisationPoint::new(system, guess),
            held: guess.inputs.clone(),
            coordinates: description.coordinates.to_vec(),
            n,
            q,
        }
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
        let forces = self.base.forces(&self.base.force(&self.q)).into_iter().zip(&self.coordinates);
        let named = |(force, coordinate): (Residual, &Coordinate)| match coordinate.state() {
            None => force,
            // F of a hidden coordinate at rest is −z'.
            Some(state) => Residual {
                coordinate: format!("{state}'"),
                force: -force.force,
                unit: if coordinate.unit.is_empty() { String::new() } else { format!("{}/s", coordinate.unit) },
            },
        };
        forces.map(named).collect()
    }

    fn linearised(&self, iterations: usize) -> Result<StateSpace, LinearError> {
        let n = self.n;
        if let Some(jump) = self.base.jumps(&self.q).first() {
            let residual = self.base.forces(&jump.force).into_iter().filter(|jump| jump.force != 0.0);
            let jumps = residual.map(|jump| Residual { force: jump.force.abs(), ..jump }).collect();
            return Err(LinearError::Discontinuous { point: self.place(), switch: jump.switch.clone(), jump: jumps });
        }
        if let Some(switch) = self.base.kink(&self.q) {
            return Err(LinearError::NotSmooth { switch });
        }
        let input = self.base.input(&self.q).to_dense();
        // Rates of inputs are inputs of their own where they act.
        let acts = |k: &usize| k.is_multiple_of(3) || input.column(*k).iter().any(|x| *x != 0.0);
        let acting: Vec<usize> = (0..input.ncols()).filter(acts).collect();
        let forces: Vec<DVector<f64>> = acting.iter().map(|k| input.column(*k).into_owned()).collect();
        let (matrix, drive) = first_order(&self.base, &self.q, &forces)?;
        let (balanced, scales) = balanced(&matrix);
        let known: Vec<String> =
            self.base.system.borrow().description().inputs.iter().map(ToString::to_string).collect();
        let names = self.coordinates[..n].iter().map(|c| c.name.to_string());
        let moving = self.coordinates[..n].iter().zip(&self.base.v).filter(|(_, v)| **v != 0.0);
        Ok(StateSpace {
            place: self.place(),
            speeds: moving.map(|(c, v)| (rate_name(&c.name), *v)).collect(),
            residual: self.residual(),
            iterations,
            variables: names.chain(self.coordinates.iter().map(|c| rate_name(&c.name))).collect(),
            analysis: first_order_modes(&balanced)?,
            matrix,
            inputs: acting.iter().map(|k| rated(&known[k / 3], "", k % 3)[0].clone()).collect(),
            acting,
            guess: Guess { q: self.q.clone(), v: self.base.v.clone(), inputs: self.held.clone() },
            input: drive,
            scales,
        })
    }
}

impl Rest for Search {
    /// Coordinates and states.
    fn unknowns(&self) -> Vec<f64> {
        [&self.q[..self.n], &self.base.v[self.n..]].concat()
    }

    fn set(&mut self, unknowns: &[f64]) {
        self.q[..self.n].copy_from_slice(&unknowns[..self.n]);
        self.base.v[self.n..].copy_from_slice(&unknowns[self.n..]);
    }

    fn left(&self) -> Vec<f64> {
        self.base.force(&self.q)
    }

    fn measures(&self) -> Vec<f64> {
        self.base.measure(&self.q)
    }

    /// ∂F/∂(q, z).
    fn slopes(&self) -> DMatrix<f64> {
        let [_, damping, stiffness] = self.base.matrices(&self.q);
        let mut slopes = stiffness.to_dense();
        slopes
            .columns_mut(self.n, self.base.n - self.n)
            .copy_from(&damping.to_dense().columns(self.n, self.base.n - self.n));
        slopes
    }
}

/// A of x' = A x about a rest.
pub(super) fn linearised(base: &LinearisationPoint, q: &[f64]) -> Result<DMatrix<f64>, LinearError> {
    Ok(first_order(base, q, &[])?.0)
}

/// A, and a column of B for each of some forces.
fn first_order(
    base: &LinearisationPoint,
    q: &[f64],
    forces: &[DVector<f64>],
) -> Result<(DMatrix<f64>, DMatrix<f64>), LinearError> {
    let (n, all) = (base.mechanical(), base.n);
    let [mass, damping, stiffness] = base.cleaned(q);
    let mut right = DMatrix::zeros(all, 2 * all + forces.len());
    right.columns_mut(0, all).copy_from(&-stiffness.to_dense());
    right.columns_mut(all, all).copy_from(&-damping.to_dense());
    forces.iter().enumerate().for_each(|(k, column)| right.column_mut(2 * all + k).copy_from(column));
    if right.iter().any(|x| !x.is_finite()) {
        return Err(LinearError::NonFinite { what: "the linear model".to_owned() });
    }
    let solved = mass.to_dense().lu().solve(&right).filter(|x| x.iter().all(|x| x.is_finite()));
    let solved = solved.ok_or(LinearError::NoConvergence { what: "the accelerations' derivatives" })?;
    // Of [q; v] all but what is hidden of q.
    let kept: Vec<usize> = (0..n).chain(all..2 * all).collect();
    let mut matrix = DMatrix::zeros(kept.len(), kept.len());
    matrix.view_mut((0, n), (n, n)).fill_with_identity();
    for (column, k) in kept.iter().enumerate() {
        matrix.view_mut((n, column), (all, 1)).copy_from(&solved.column(*k));
    }
    let mut drive = DMatrix::zeros(kept.len(), forces.len());
    drive.view_mut((n, 0), (all, forces.len())).copy_from(&solved.columns(2 * all, forces.len()));
    Ok((matrix, drive))
}
