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

mod cycle;
mod rest;

use nalgebra::{Complex, DMatrix};

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
/// Periods are looked at from this part of the present ones on, at which a loop is as good as continuous.
const SHORTEST_PERIOD: f64 = 1e-3;
/// Up to so many times the present ones: nobody samples a loop so much less often than it was made for.
const LONGEST_PERIOD: f64 = 1e4;
/// Each is so many times the one before: an eigenvalue seldom passes |z| = 1 and comes back between two of them.
const NEXT_PERIOD: f64 = 1.01;
/// Eigenvalues this near to 1 are those of what stays where it is, whatever the period.
const NEUTRAL: f64 = 1e-9;
/// The longest period is looked for where no more ticks than this are in a cycle: each costs an exponential.
const MOST_SEARCHED: usize = 100;

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
    /// The factor of all periods with which some |z| is 1 first; `None` where there is none within 10⁻³ to 10⁴, or the cycle is too long to
    /// be looked at so often.
    pub critical_factor: Option<f64>,
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
    let mut search = Search::new(system, guess, memory);
    let cycle = Cycle::of(system)?;
    search.base.check(&search.q)?;
    search.find_read();
    let iterations = search.newton().map_err(|iterations| search.nowhere(iterations))?;
    if !search.is_met(BALANCED) {
        return Err(search.nowhere(iterations));
    }
    search.closed(&cycle)
}

impl Search {
    /// The loop about the rest that was found.
    fn closed(&self, cycle: &Cycle) -> Result<SampledLoop, LinearError> {
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
        let jumps: Vec<DMatrix<f64>> = cycle.instants.iter().map(|(ticking, _)| self.jump(ticking, &slopes)).collect();
        let map = |factor: f64| {
            let mut gaps: Vec<(f64, DMatrix<f64>)> = Vec::new();
            let mut product = DMatrix::identity(size + held, size + held);
            for (jump, (_, gap)) in jumps.iter().zip(&cycle.instants) {
                let gap = factor * gap;
                let known = gaps.iter().position(|(known, _)| (known - gap).abs() <= INSTANT * gap);
                let place = known.unwrap_or_else(|| {
                    gaps.push((gap, expm(&(&field * gap))));
                    gaps.len() - 1
                });
                product = &gaps[place].1 * (jump * product);
            }
            product
        };
        let matrix = map(1.0);
        let none = || LinearError::NoConvergence { what: "the eigenvalues of the loop" };
        let (multipliers, forgotten) = eigenvalues(&matrix).ok_or_else(none)?;
        let exponents = multipliers.iter().map(|z| z.ln() / cycle.period).collect();
        let growth = |factor: f64| {
            let (found, _) = eigenvalues(&map(factor))?;
            let moving = found.iter().filter(|z| (*z - 1.0).norm() > NEUTRAL);
            Some(moving.map(|z| z.norm()).fold(0.0, f64::max) - 1.0)
        };
        let critical_factor = (cycle.instants.len() <= MOST_SEARCHED).then(|| first_zero(growth)).flatten();
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
            critical_factor,
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

/// The first factor at which a growth that is negative for short periods becomes 0, to rounding.
fn first_zero(growth: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    let mut low = SHORTEST_PERIOD;
    if growth(low)? >= 0.0 {
        return None;
    }
    while low < LONGEST_PERIOD {
        let mut high = NEXT_PERIOD * low;
        if growth(high)? < 0.0 {
            low = high;
            continue;
        }
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return Some(high);
            }
            if growth(middle)? < 0.0 { low = middle } else { high = middle }
        }
    }
    None
}

impl std::fmt::Display for SampledLoop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let values = self.place.iter().chain(&self.memory).map(|(name, value)| format!("{name} = {}", short(*value)));
        write!(f, "{}", values.collect::<Vec<_>>().join(", "))
    }
}
