//! Small motions of loops that are sampled: held values between ticks.
//!
//! At rest F(q, 0, z, m) = 0 and every tick gives each held value the value that it has, m = g(q, 0, z, m).  Small departures x = (δq, δv, δz)
//! obey x' = A x + B δm between ticks, where m is held, so that over a time τ
//!
//! \[x; m\] ↦ exp(\[A B; 0 0\] τ) \[x; m\],
//!
//! and a tick maps \[x; m\] ↦ J \[x; m\] with the slopes of what it sets.  The product over the time after which all clocks come together
//! again is the loop's map; its eigenvalues z tell how departures grow, ln z/T as those of a continuous loop do.
//!
//! Source: Franklin, Powell and Workman, Digital Control of Dynamic Systems, 1998, 4.3 (zero-order hold).

mod critical;
mod cycle;
mod rest;

use nalgebra::{Complex, DMatrix};

#[cfg(feature = "cli")]
pub(crate) use critical::periods;
use critical::{Critical, Varying};
use cycle::{Cycle, INSTANT};
use rest::{Assignment, Search};

use super::Guess;
use super::least_steps::{BALANCED, Rest};
use super::state_space::linearised;
use crate::linear::matrices::Eigen;
use crate::linear::{LinearError, expm, short};
use crate::mechanism::{Action, Along, System, Target, Trigger, rate_name};

/// An eigenvalue with this part of a half turn a period, or more, may be one of a faster motion.
const ALIASED: f64 = 0.9;
/// A loop that is closed at ticks, about its rest.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledLoop {
    /// Coordinates and states with their values at rest, SI.
    pub place: Vec<(String, f64)>,
    /// Held values that the loop reads, at rest.
    pub memory: Vec<(String, f64)>,
    /// Held values that nothing reads but what sets them, as counts of ticks.
    pub unread: Vec<String>,
    /// Events that set something, but at no tick: they are left out.
    pub frozen: Vec<String>,
    /// What is left of each equation, of its terms: the largest.
    pub residual: f64,
    /// The time after which all clocks come together again, s.
    pub period: f64,
    /// Instants at which anything ticks in that time.
    pub instants: usize,
    /// What the map is of: coordinates, their rates, states, held values.
    pub variables: Vec<String>,
    /// The map of these over the period, from just before a tick on.
    pub matrix: DMatrix<f64>,
    /// Its eigenvalues z that are not 0, the largest first.
    pub multipliers: Vec<Complex<f64>>,
    /// How many of its eigenvalues are 0: held values that are forgotten at the next tick.
    pub forgotten: usize,
    /// ln z/T, 1/s.
    pub exponents: Vec<Complex<f64>>,
    /// The factor of all periods nearest to 1 from which on some |z| is 1 or more; `None` where there is none within 10⁻³ to 10⁴, or the
    /// cycle is too long to be looked at so often.
    pub critical_factor: Option<f64>,
    /// The factor nearest to 1 from which downwards some |z| is 1 or more: shorter periods are worse, as where a law divides by its period.
    pub least_factor: Option<f64>,
    /// Parameters of which the periods are made, and which these factors multiply or divide with them; none where the periods alone are
    /// varied, and the law stays as it is.
    pub varied: Vec<String>,
}

impl SampledLoop {
    /// Eigenvalues whose sine turns so far in a period that it may be a faster one, seen too seldom.
    pub fn aliased(&self) -> Vec<usize> {
        let half_turn = std::f64::consts::PI / self.period;
        (0..self.exponents.len()).filter(|k| self.exponents[*k].im.abs() > ALIASED * half_turn).collect()
    }

    /// Whether all departures die away.
    pub fn is_stable(&self) -> bool {
        self.multipliers.iter().all(|z| z.norm() < 1.0)
    }
}

/// Finds the rest of a sampled loop nearest to a guess of coordinates, states (the last of `guess.v`) and held values, and its small motions.
///
/// ```
/// use dalembert::linear::{Guess, linearise_sampled};
/// use dalembert::mechanism::{Dynamic, System};
/// dalembert::model!(yaml = r#"
/// name: Cart
/// parameters: {m: 1 kg, k: 4 N/m}
/// coordinates: {x: m}
/// memory: {u: 0 N}
/// bodies: {b: {mass: m, position: "[x, 0]"}}
/// forces: {f: {on: b, force: "[u, 0]"}}
/// events: {tick: {every: 0.5 s, then: {set: {u: -k*x}}}}
/// "#);
/// let cart = Dynamic::new(Cart::default());
/// let sampled = linearise_sampled(&cart, &Guess::at(&[0.1]), &[0.0])?;
/// // x'' = -k x(tick): the map has determinant 1 + k T²/2 = 1.5 and trace 2 - k T²/2 = 1.5.
/// let product = sampled.multipliers[0] * sampled.multipliers[1];
/// assert!((product.re - 1.5).abs() < 1e-14 && !sampled.is_stable());
/// # Ok::<(), dalembert::linear::LinearError>(())
/// ```
///
/// # Errors
/// [`LinearError::NoEquilibrium`], [`LinearError::HasConstraints`], [`LinearError::NotSampled`], [`LinearError::TooManyTicks`], those of
/// [`super::linearise_states`], and numbers that are not finite.
pub fn linearise_sampled<S: System + ?Sized>(
    system: &S,
    guess: &Guess,
    memory: &[f64],
) -> Result<SampledLoop, LinearError> {
    let cycle = Cycle::of(system)?;
    let search = at_rest(system, guess, memory)?;
    let law = search.law(&cycle)?;
    let critical = Varying::of(system, (&search, guess), &cycle).critical(&law);
    search.closed(&cycle, &law, critical)
}

/// The rest of the loop nearest to a guess.
fn at_rest<S: System + ?Sized>(system: &S, guess: &Guess, memory: &[f64]) -> Result<Search, LinearError> {
    let mut search = Search::new(system, guess, memory);
    search.base.check(&search.q)?;
    search.find_read();
    let iterations = search.newton().map_err(|iterations| search.nowhere(iterations))?;
    if search.is_met(BALANCED) { Ok(search) } else { Err(search.nowhere(iterations)) }
}

/// What departures do: [A B; 0 0] between ticks, and the jumps at the instants of a cycle.
struct Law {
    field: DMatrix<f64>,
    jumps: Vec<DMatrix<f64>>,
}

impl Law {
    /// The map over a cycle, whose times are multiplied by a factor.
    fn map(&self, cycle: &Cycle, factor: f64) -> DMatrix<f64> {
        let mut gaps: Vec<(f64, DMatrix<f64>)> = Vec::new();
        let mut product = DMatrix::identity(self.field.nrows(), self.field.nrows());
        for (jump, (_, gap)) in self.jumps.iter().zip(&cycle.instants) {
            let gap = factor * gap;
            let known = gaps.iter().position(|(known, _)| (known - gap).abs() <= INSTANT * gap);
            let place = known.unwrap_or_else(|| {
                gaps.push((gap, expm(&(&self.field * gap))));
                gaps.len() - 1
            });
            product = &gaps[place].1 * (jump * product);
        }
        product
    }
}

impl Search {
    /// How departures from the rest that was found move.
    fn law(&self, cycle: &Cycle) -> Result<Law, LinearError> {
        if let Some(jump) = self.base.jumps(&self.q).first() {
            return Err(LinearError::NotSmooth { switch: jump.switch.clone() });
        }
        if let Some(switch) = self.base.kink(&self.q) {
            return Err(LinearError::NotSmooth { switch });
        }
        let (n, all, held) = (self.n, self.base.n, self.read.len());
        let between = linearised(&self.base, &self.q)?;
        let size = n + all;
        // [A B; 0 0].
        let mut field = DMatrix::zeros(size + held, size + held);
        field.view_mut((0, 0), (size, size)).copy_from(&between);
        let by_memory = -self.forces_by_memory();
        let mass = self.base.matrices(&self.q)[0].to_dense().lu();
        for (k, j) in self.read.iter().enumerate() {
            let column = mass.solve(&by_memory.column(*j)).filter(|x| x.iter().all(|x| x.is_finite()));
            let column = column.ok_or(LinearError::NoConvergence { what: "the accelerations' derivatives" })?;
            field.view_mut((n, size + k), (all, 1)).copy_from(&column);
        }
        let slopes = self.slopes_of_assignments(&field);
        let jumps = cycle.instants.iter().map(|(ticking, _)| self.jump(ticking, &slopes)).collect();
        Ok(Law { field, jumps })
    }

    /// The loop about the rest that was found.
    fn closed(&self, cycle: &Cycle, law: &Law, critical: Critical) -> Result<SampledLoop, LinearError> {
        let n = self.n;
        let matrix = law.map(cycle, 1.0);
        let none = || LinearError::NoConvergence { what: "the eigenvalues of the loop" };
        let (multipliers, forgotten) = eigenvalues(&matrix).ok_or_else(none)?;
        let exponents = multipliers.iter().map(|z| z.ln() / cycle.period).collect();
        let system = self.base.system.borrow();
        let (description, sampling) = (system.description(), system.sampling());
        let names = description.coordinates[..n].iter().map(|c| c.name.to_string());
        let rates = description.coordinates.iter().map(|c| rate_name(&c.name));
        let of_loop = self.read.iter().map(|j| sampling.memory[*j].name.to_string());
        let of_noise = |j: &usize| system.held_noise().iter().any(|noise| noise.held.contains(&(*j as u32)));
        let unread = (0..self.memory.len()).filter(|j| !self.read.contains(j) && !of_noise(j));
        let sets = |event: &usize| {
            let actions = &description.events[*event].actions;
            *sampling.trigger(*event) == Trigger::Zero && actions.iter().any(|action| matches!(action, Action::Set(_)))
        };
        Ok(SampledLoop {
            place: self.place(),
            memory: self.held_values(),
            unread: unread.map(|j| sampling.memory[j].name.to_string()).collect(),
            frozen: (0..description.events.len())
                .filter(sets)
                .map(|event| description.events[event].name.to_string())
                .collect(),
            residual: self.residual(),
            period: cycle.period,
            instants: cycle.instants.len(),
            variables: names.chain(rates).chain(of_loop).collect(),
            matrix,
            multipliers,
            forgotten,
            exponents,
            critical_factor: critical.longer,
            least_factor: critical.shorter,
            varied: critical.varied,
        })
    }

    /// The slopes of all assignments by [x; m], a column for each; accelerations change as x and m say.
    fn slopes_of_assignments(&self, field: &DMatrix<f64>) -> DMatrix<f64> {
        let (n, all) = (self.n, self.base.n);
        let mut slopes = DMatrix::zeros(self.base.system.borrow().sampling().assignments(), field.ncols());
        for (column, mut values) in slopes.column_iter_mut().enumerate() {
            let (mut q, mut v) = (vec![0.0; all], vec![0.0; all]);
            match column {
                column if column < n => q[column] = 1.0,
                column if column < n + all => v[column - n] = 1.0,
                _ => (),
            }
            let a: Vec<f64> = field.view((n, column), (all, 1)).iter().copied().collect();
            let memory = column.checked_sub(n + all).map(|k| self.read[k]);
            values.copy_from_slice(&self.assignments_along(&Along { q: &q, v: &v, a: &a, memory, ..Along::default() }));
        }
        slopes
    }

    /// What the ticks of some clocks make of [x; m].
    fn jump(&self, ticking: &[bool], slopes: &DMatrix<f64>) -> DMatrix<f64> {
        let (n, all, size) = (self.n, self.base.n, slopes.ncols());
        let mut jump = DMatrix::identity(size, size);
        for set in self.acting(ticking).into_iter().flat_map(|event| self.sets_of(event)) {
            let before = jump.clone();
            for Assignment { target, place } in set {
                let row = match target {
                    Target::State(i) => Some(n + i as usize),
                    Target::Memory(j) => self.read.iter().position(|read| *read == j as usize).map(|k| n + all + k),
                };
                if let Some(row) = row {
                    jump.row_mut(row).copy_from(&(slopes.row(place) * &before));
                }
            }
        }
        jump
    }
}

/// Eigenvalues that are not 0, the largest first, and how many others there are: those of variables that nothing depends on are left out
/// before any is computed.
fn eigenvalues(matrix: &DMatrix<f64>) -> Option<(Vec<Complex<f64>>, usize)> {
    let mut reduced = matrix.clone();
    while let Some(k) = (0..reduced.ncols())
        .find(|k| reduced.column(*k).iter().all(|x| *x == 0.0) || reduced.row(*k).iter().all(|x| *x == 0.0))
    {
        reduced = reduced.remove_row(k).remove_column(k);
    }
    let forgotten = matrix.ncols() - reduced.ncols();
    if reduced.is_empty() {
        return Some((Vec::new(), forgotten));
    }
    let mut values = Eigen::of(&reduced)?.values;
    values.sort_by(|a, b| b.norm().total_cmp(&a.norm()).then(a.im.total_cmp(&b.im)));
    Some((values, forgotten))
}

impl std::fmt::Display for SampledLoop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let values = self.place.iter().chain(&self.memory).map(|(name, value)| format!("{name} = {}", short(*value)));
        write!(f, "{}", values.collect::<Vec<_>>().join(", "))
    }
}
