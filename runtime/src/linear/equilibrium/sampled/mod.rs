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

mod alone;
mod critical;
mod crossing;
mod cycle;
mod laws;
mod rest;

use nalgebra::{Complex, DMatrix, DVector};

use critical::{Critical, LONGEST_PERIOD, SHORTEST_PERIOD, Varying};
#[cfg(feature = "cli")]
pub(crate) use critical::{periods, ticking};
use cycle::{Cycle, INSTANT};
use rest::{Assignment, Search};

use super::Guess;
use super::candidate::Departures;
use super::least_steps::{BALANCED, Rest};
use crate::linear::matrices::{Eigen, Scaled, balanced};
use crate::linear::{LinearError, expm, short};
use crate::matrix::svd;
use crate::mechanism::{Action, Along, System, Target, Trigger, rate_name};

/// An eigenvalue with this part of a half turn a period, or more, may be one of a faster motion.
const ALIASED: f64 = 0.9;
/// Singular values below this part of the largest element, times the order, are rounding.
const KERNEL: f64 = 4.0 * f64::EPSILON;

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
    /// How far the logarithm of the size of each may be off, by rounding.
    pub errors: Vec<f64>,
    /// How many of its eigenvalues are 0: held values that are forgotten at the next tick.
    pub forgotten: usize,
    /// ln z/T, 1/s.
    pub exponents: Vec<Complex<f64>>,
    /// The exponents of motions that nothing damps and that ticks do not move, or do not see, 0 or ±iω: their |z| is 1 whatever the period.
    pub alone: Vec<Complex<f64>>,
    /// The factor of all periods nearest to 1 from which on some |z| is 1 or more; `None` where there is none within 10⁻³ to 10⁴, or the
    /// cycle is too long to be looked at so often.
    pub critical_factor: Option<f64>,
    /// The factor nearest to 1 from which downwards some |z| is 1 or more: shorter periods are worse, as where a law divides by its period.
    pub least_factor: Option<f64>,
    /// Between which factors of all periods none of these two is missed: 10⁻³ and 10⁴, or they themselves, or as far as it went at some cost; beyond,
    /// windows of instability of less than a hundredth of the period may be.
    pub looked: [f64; 2],
    /// Parameters of which the periods are made, and which these factors multiply or divide with them; none where the periods alone are
    /// varied, and the law stays as it is.
    pub varied: Vec<String>,
    /// The state in which it rests, hidden coordinates and all, and all held values there.
    rest: (Guess, Vec<f64>),
}

impl SampledLoop {
    /// The state in which it rests, and all held values there.
    #[cfg(feature = "cli")]
    pub(crate) fn rest(&self) -> (&Guess, &[f64]) {
        (&self.rest.0, &self.rest.1)
    }

    /// Eigenvalues whose sine turns so far in a period that it may be a faster one, seen too seldom.
    pub fn aliased(&self) -> Vec<usize> {
        let half_turn = std::f64::consts::PI / self.period;
        (0..self.exponents.len()).filter(|k| self.exponents[*k].im.abs() > ALIASED * half_turn).collect()
    }

    /// `looked`, where a threshold may have been missed beyond.
    pub fn looked_in_part(&self) -> Option<[f64; 2]> {
        let ends = [SHORTEST_PERIOD, LONGEST_PERIOD];
        let found = [self.critical_factor, self.least_factor];
        let whole = |k: usize| self.looked[k] == ends[k] || found.contains(&Some(self.looked[k]));
        (self.looked != [1.0, 1.0] && !(whole(0) && whole(1))).then_some(self.looked)
    }

    /// Whether all departures die away, by more than rounding.
    pub fn is_stable(&self) -> bool {
        self.multipliers.iter().zip(&self.errors).all(|(z, error)| z.norm().ln() < -error)
    }

    /// Whether some departures grow, by more than rounding.
    pub fn grows(&self) -> bool {
        self.multipliers.iter().zip(&self.errors).any(|(z, error)| z.norm().ln() > *error)
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
/// [`LinearError::NoEquilibrium`], [`LinearError::NotSampled`], [`LinearError::TooManyTicks`], those of
/// [`super::linearise_states`], and numbers that are not finite.
pub fn linearise_sampled<S: System + ?Sized>(
    system: &S,
    guess: &Guess,
    memory: &[f64],
) -> Result<SampledLoop, LinearError> {
    let cycle = Cycle::of(system)?;
    let mut search = at_rest(system, guess, memory)?;
    search.laws_are_linear()?;
    let law = search.law(&cycle)?;
    let critical = Varying::of(system, (&search, guess), &cycle).critical(&law.flow);
    search.closed((&cycle, &law), critical, &guess.inputs)
}

/// The rest of the loop nearest to a guess.
fn at_rest<S: System + ?Sized>(system: &S, guess: &Guess, memory: &[f64]) -> Result<Search, LinearError> {
    let mut search = Search::new(system, guess, memory)?;
    let checked = search.place.check();
    if checked.as_ref().is_err_and(|error| !error.is_of_time()) {
        checked.clone()?;
    }
    search.find_read();
    let nowhere = |search: &Search, iterations: usize| match &checked {
        Err(error) => error.clone().without_rest(),
        Ok(()) => search.nowhere(iterations),
    };
    let iterations = search.newton().map_err(|iterations| nowhere(&search, iterations))?;
    if !search.is_met(BALANCED) {
        return Err(nowhere(&search, iterations));
    }
    checked.and_then(|()| search.place.check())?;
    search.place.check_rest()?;
    Ok(search)
}

/// What departures do: [A B; 0 0] between ticks, and the jumps at the instants of a cycle.
struct Law {
    /// The coordinates that are independent, the hidden ones last.
    independent: Vec<usize>,
    flow: Flow,
}

/// [A B; 0 0], and a jump for each instant of a cycle.
#[derive(Clone)]
struct Flow {
    field: DMatrix<f64>,
    jumps: Vec<DMatrix<f64>>,
    /// The fastest turn of a motion between ticks, rad/s: its exponential is rounded with each turn.
    turning: f64,
}

impl Flow {
    /// The eigenvalues that are not 0 of the map over a cycle, whose times are multiplied by a factor.
    fn spectrum(&self, cycle: &Cycle, factor: f64) -> Option<Vec<Eigenvalue>> {
        eigenvalues(&self.map(cycle, factor), self.turning * cycle.period * factor)
    }

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

impl Flow {
    /// All eigenvalues that are not 0 of the map over a cycle, which is known, the largest first; and the exponents of those motions that ticks leave
    /// alone.
    fn eigenvalues(&self, cycle: &Cycle, map: &DMatrix<f64>) -> Option<(Vec<Eigenvalue>, Vec<Complex<f64>>)> {
        let (rest, alone) = self.without_alone()?;
        let mut found = match alone.is_empty() {
            true => eigenvalues(map, self.turning * cycle.period)?,
            false => rest.spectrum(cycle, 1.0)?,
        };
        let z = |exponent: &Complex<f64>| (exponent * cycle.period).exp();
        found.extend(alone.iter().map(|exponent| Eigenvalue { z: z(exponent), error: f64::EPSILON }));
        found.sort_by(|a, b| b.z.norm().total_cmp(&a.z.norm()).then(a.z.im.total_cmp(&b.z.im)));
        Some((found, alone))
    }
}

impl Search {
    /// How departures from the rest that was found move.
    fn law(&mut self, cycle: &Cycle) -> Result<Law, LinearError> {
        let (base, q) = (&self.place.base, &self.place.q);
        if let Some(jump) = base.jumps(q).first() {
            return Err(LinearError::NotSmooth { switch: jump.switch.clone() });
        }
        base.without_corner(q)?;
        let by_memory = -self.forces_by_memory();
        let forces: Vec<DVector<f64>> = self.read.iter().map(|j| by_memory.column(*j).into_owned()).collect();
        let departures = self.place.departures(&forces)?;
        let (size, held) = (departures.matrix.nrows(), self.read.len());
        // [A B; 0 0].
        let mut field = DMatrix::zeros(size + held, size + held);
        field.view_mut((0, 0), (size, size)).copy_from(&departures.matrix);
        field.view_mut((0, size), (size, held)).copy_from(&departures.drive);
        let slopes = self.where_slopes_are(|beside| beside.slopes_of_assignments(&field, &departures, &forces))?;
        let independent = departures.independent;
        let jumps = cycle.instants.iter().map(|(ticking, _)| self.jump(ticking, &slopes, &independent)).collect();
        let failed = LinearError::NoConvergence { what: "the eigenvalues between ticks" };
        let turning =
            Eigen::of(&field).ok_or(failed)?.values.iter().fold(0.0, |most: f64, value| most.max(value.im.abs()));
        Ok(Law { independent, flow: Flow { field, jumps, turning } })
    }

    /// The loop about the rest that was found, with inputs held at these.
    fn closed(
        &self,
        (cycle, law): (&Cycle, &Law),
        critical: Critical,
        inputs: &[f64],
    ) -> Result<SampledLoop, LinearError> {
        let matrix = law.flow.map(cycle, 1.0);
        let none = || LinearError::NoConvergence { what: "the eigenvalues of the loop" };
        let (found, alone) = law.flow.eigenvalues(cycle, &matrix).ok_or_else(none)?;
        let multipliers: Vec<Complex<f64>> = found.iter().map(|value| value.z).collect();
        let forgotten = matrix.ncols() - multipliers.len();
        let exponents = multipliers.iter().map(|z| z.ln() / cycle.period).collect();
        let system = self.place.base.system.borrow();
        let (description, sampling) = (system.description(), system.sampling());
        let places = law.independent.iter().filter(|i| **i < self.place.n);
        let names = places.map(|i| description.coordinates[*i].name.to_string());
        let rates = law.independent.iter().map(|i| rate_name(&description.coordinates[*i].name));
        let of_loop = self.read.iter().map(|j| sampling.memory[*j].name.to_string());
        let of_noise = |j: &usize| system.held_noise().iter().any(|noise| noise.held.contains(&(*j as u32)));
        let unread = (0..self.memory.len()).filter(|j| !self.read.contains(j) && !of_noise(j));
        let sets = |event: &usize| {
            let actions = &description.events[*event].actions;
            *sampling.trigger(*event) == Trigger::Zero && actions.iter().any(|action| matches!(action, Action::Set(_)))
        };
        Ok(SampledLoop {
            place: self.named_place(),
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
            errors: found.iter().map(|value| value.error).collect(),
            forgotten,
            alone,
            exponents,
            critical_factor: critical.longer,
            least_factor: critical.shorter,
            looked: critical.looked,
            varied: critical.varied,
            rest: (self.place.guess(inputs), self.memory.clone()),
        })
    }

    /// The slopes of all assignments by [x; m], a column for each; accelerations and reactions change as x and m say.
    ///
    /// # Errors
    /// Those of the reactions.
    fn slopes_of_assignments(
        &self,
        field: &DMatrix<f64>,
        departures: &Departures,
        forces: &[DVector<f64>],
    ) -> Result<DMatrix<f64>, LinearError> {
        let Departures { motions, independent, .. } = departures;
        let (n, all, size) = (departures.places(), independent.len(), departures.matrix.nrows());
        let answering = self.answering()?;
        let [mass, damping, stiffness] = self.place.base.matrices(&self.place.q).map(|matrix| matrix.to_dense());
        let mut slopes = DMatrix::zeros(self.place.base.system.borrow().sampling().assignments(), field.ncols());
        for (column, mut values) in slopes.column_iter_mut().enumerate() {
            let none = || DVector::zeros(motions.nrows());
            let (mut q, mut v, mut force) = (none(), none(), none());
            match column {
                column if column < n => q.copy_from(&motions.column(column)),
                column if column < size => v.copy_from(&motions.column(column - n)),
                _ => force -= &forces[column - size],
            }
            let a = motions * field.view((n, column), (all, 1));
            let a = a.column(0).into_owned();
            let lambda = &answering * (&mass * &a + &damping * &v + &stiffness * &q + force);
            let memory = column.checked_sub(size).map(|k| self.read[k]);
            let [q, v, a, lambda] = [&q, &v, &a, &lambda].map(|x| x.as_slice());
            values.copy_from_slice(&self.assignments_along(&Along { q, v, a, lambda, memory, ..Along::default() }));
        }
        Ok(slopes)
    }

    /// How the multipliers of all rows answer forces.
    ///
    /// # Errors
    /// [`LinearError::ReactionNotUnique`].
    fn answering(&self) -> Result<DMatrix<f64>, LinearError> {
        let (rows, assigned) = (self.place.rows(), self.all_assignments());
        let mut by_multipliers = DMatrix::zeros(assigned.len(), rows.len());
        for (k, row) in rows.iter().enumerate() {
            let mut lambda = vec![0.0; self.place.base.lambda.len()];
            lambda[*row] = 1.0;
            let found = self.assignments_along(&Along { lambda: &lambda, ..Along::default() });
            assigned.iter().enumerate().for_each(|(i, assignment)| by_multipliers[(i, k)] = found[assignment.place]);
        }
        self.place.answering(&by_multipliers).map_err(|row| match row {
            Some(row) => LinearError::ReactionNotUnique { answer: self.name(assigned[row].target) },
            None => LinearError::NoConvergence { what: "the reactions of small motions" },
        })
    }

    /// What the ticks of some clocks make of [x; m], x of these independent coordinates.
    fn jump(&self, ticking: &[bool], slopes: &DMatrix<f64>, independent: &[usize]) -> DMatrix<f64> {
        let size = slopes.ncols();
        let mut jump = DMatrix::identity(size, size);
        let first_held = size - self.read.len();
        let first_rate = first_held - independent.len();
        for set in self.acting(ticking).into_iter().flat_map(|event| self.sets_of(event)) {
            let before = jump.clone();
            for Assignment { target, place } in set {
                let row = match target {
                    Target::State(i) => {
                        independent.iter().position(|known| *known == i as usize).map(|k| first_rate + k)
                    }
                    Target::Memory(j) => self.read.iter().position(|read| *read == j as usize).map(|k| first_held + k),
                };
                if let Some(row) = row {
                    jump.row_mut(row).copy_from(&(slopes.row(place) * &before));
                }
            }
        }
        jump
    }
}

/// An eigenvalue of a map.
struct Eigenvalue {
    z: Complex<f64>,
    /// How far ln |z| may be off where |z| is about 1.
    error: f64,
}

impl Eigenvalue {
    /// ln |z|.
    fn growth(&self) -> f64 {
        self.z.norm().ln()
    }

    /// Whether |z| is 1, to its error.
    fn stays(&self) -> bool {
        self.growth().abs() <= self.error
    }
}

/// Eigenvalues that are not 0 of a map of motions that turn by so many radians: those of variables that nothing depends on, and of sums of them,
/// are left out before any is computed.
fn eigenvalues(matrix: &DMatrix<f64>, turned: f64) -> Option<Vec<Eigenvalue>> {
    let mut reduced = matrix.clone();
    while let Some(k) = (0..reduced.ncols())
        .find(|k| reduced.column(*k).iter().all(|x| *x == 0.0) || reduced.row(*k).iter().all(|x| *x == 0.0))
    {
        reduced = reduced.remove_row(k).remove_column(k);
    }
    let nothing = KERNEL * matrix.ncols() as f64 * reduced.amax();
    while let Some(rest) = without_kernel(&reduced, nothing)? {
        reduced = rest;
    }
    if reduced.is_empty() {
        return Some(Vec::new());
    }
    let (reduced, _) = balanced(&reduced);
    let Eigen { values, vectors } = Eigen::of(&reduced)?;
    // Each by its own condition, 1/|w·v|; a defective pair is known to the root of rounding.
    let rounding = Scaled::threshold(values.len(), reduced.norm()).max(f64::EPSILON * turned);
    let worst = f64::EPSILON.sqrt().recip();
    let left = vectors.try_inverse();
    let condition = |k: usize| left.as_ref().map_or(worst, |left| left.row(k).norm().min(worst));
    Some(values.iter().enumerate().map(|(k, z)| Eigenvalue { z: *z, error: rounding * condition(k) }).collect())
}

/// What a matrix does across the sums of variables that it takes to `nothing`, or less; `Some(None)` where there are none. In a basis of these and of what is across them
/// it is [0 B; 0 C], whose other eigenvalues are those of C (Van Dooren, The computation of Kronecker's canonical form, 1979, section 3).
fn without_kernel(matrix: &DMatrix<f64>, nothing: f64) -> Option<Option<DMatrix<f64>>> {
    if matrix.is_empty() {
        return Some(None);
    }
    let svd = svd(matrix.clone(), false, true)?;
    let kept: Vec<usize> = (0..matrix.ncols()).filter(|k| svd.singular_values[*k] > nothing).collect();
    if kept.len() == matrix.ncols() {
        return Some(None);
    }
    let across = svd.v_t.as_ref()?.select_rows(&kept);
    Some(Some(&across * matrix * across.transpose()))
}

impl std::fmt::Display for SampledLoop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let values = self.place.iter().chain(&self.memory).map(|(name, value)| format!("{name} = {}", short(*value)));
        write!(f, "{}", values.collect::<Vec<_>>().join(", "))
    }
}
