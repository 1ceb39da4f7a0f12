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

use nalgebra::{Complex, DMatrix};

use super::Guess;
use super::point::LinearisationPoint;
use super::state_space::linearised;
use crate::linear::matrices::Eigen;
use crate::linear::{LinearError, Residual, expm, short};
use crate::matrix::solve_least;
use crate::mechanism::{Action, Along, At, Function, System, Target, Trigger, rate_name};

/// Newton's method gives up after so many steps, and a step is halved down to this part of itself.
const ITERATIONS: usize = 100;
const SHORTEST: f64 = 1e-9;
/// An equation holds where no more than this part of its terms is left.
const BALANCED: f64 = 1e-9;
/// Below so many roundings of its terms an equation is not improved.
const EXACT: f64 = 4.0 * f64::EPSILON;
/// What has become smaller than this part of all that it was is 0, if that is a rest too.
const GONE: f64 = 1e-12;
/// More ticks than this until all clocks come together again are refused.
pub const MOST_TICKS: usize = 10_000;
/// Times within this part of the whole are one instant; ratios of periods are quotients of whole numbers to so many roundings.
const INSTANT: f64 = 1e-12;
const RATIO: f64 = 16.0 * f64::EPSILON;
/// An eigenvalue with this part of a half turn a period, or more, may be one of a faster motion.
const ALIASED: f64 = 0.9;
/// Periods are looked at from this part of the present ones on, each this many times the one before, up to this many times them.
const SHORTEST_PERIOD: f64 = 1e-3;
const LONGEST_PERIOD: f64 = 1e4;
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
/// let sampled = linearise_sampled(&cart, &Guess::at(&[0.1]), &[0.0]).unwrap();
/// // x'' = -k x(tick): the map has determinant 1 + k T²/2 = 1.5 and trace 2 - k T²/2 = 1.5.
/// let product = sampled.multipliers[0] * sampled.multipliers[1];
/// assert!((product.re - 1.5).abs() < 1e-14 && !sampled.is_stable());
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
    let iterations = search.newton()?;
    let residual = search.residual();
    if residual.is_nan() || residual > BALANCED {
        return Err(search.nowhere(iterations));
    }
    search.closed(&cycle, residual)
}

/// Which clocks tick when, until they come together again.
struct Cycle {
    /// Whether each clock ticks at an instant, and how long, s, until the next one.
    instants: Vec<(Vec<bool>, f64)>,
    period: f64,
}

impl Cycle {
    fn of<S: System + ?Sized>(system: &S) -> Result<Cycle, LinearError> {
        let clocks = system.clocks();
        let Some([_, first]) = clocks.first().copied() else { return Err(LinearError::NotSampled) };
        // So many periods of the first clock, by what its period is to each of the others.
        let mut count = 1_u64;
        for [_, every] in &clocks {
            let (a, _) = quotient(every / first).ok_or(LinearError::TooManyTicks { most: MOST_TICKS })?;
            count = count / gcd(count, a) * a;
            if count > MOST_TICKS as u64 {
                return Err(LinearError::TooManyTicks { most: MOST_TICKS });
            }
        }
        let period = count as f64 * first;
        let mut ticks: Vec<(f64, usize)> = Vec::new();
        for (k, [from, every]) in clocks.iter().enumerate() {
            let number = (period / every).round() as usize;
            if ticks.len() + number > MOST_TICKS {
                return Err(LinearError::TooManyTicks { most: MOST_TICKS });
            }
            let phase = (from - clocks[0][0]).rem_euclid(*every);
            let phase = if every - phase <= INSTANT * period { 0.0 } else { phase };
            ticks.extend((0..number).map(|tick| ((tick as f64).mul_add(*every, phase), k)));
        }
        ticks.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut times: Vec<(f64, Vec<bool>)> = Vec::new();
        for (t, clock) in ticks {
            if times.last().is_none_or(|(last, _)| t - last > INSTANT * period) {
                times.push((t, vec![false; clocks.len()]));
            }
            times.last_mut().into_iter().for_each(|(_, ticking)| ticking[clock] = true);
        }
        let next = |k: usize| times.get(k + 1).map_or(times[0].0 + period, |(t, _)| *t);
        let gaps: Vec<f64> = (0..times.len()).map(|k| next(k) - times[k].0).collect();
        Ok(Cycle { instants: times.into_iter().map(|(_, ticking)| ticking).zip(gaps).collect(), period })
    }
}

/// The quotient of whole numbers, the second no larger than [`MOST_TICKS`], that a number is to rounding, by its continued fraction.
fn quotient(x: f64) -> Option<(u64, u64)> {
    let (mut before, mut now, mut rest) = ((0_u64, 1_u64), (1_u64, 0_u64), x);
    loop {
        let whole = rest.floor();
        if !(0.0..=MOST_TICKS as f64).contains(&whole) {
            return None;
        }
        let next = (whole as u64 * now.0 + before.0, whole as u64 * now.1 + before.1);
        (before, now) = (now, next);
        if now.1 > MOST_TICKS as u64 {
            return None;
        }
        if (now.0 as f64 / now.1 as f64 - x).abs() <= RATIO * x {
            return Some(now);
        }
        rest = 1.0 / (rest - whole);
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// A value that a tick sets: of which event, what, and its place among all assignments.
struct Assignment {
    target: Target,
    place: usize,
}

struct Search {
    base: LinearisationPoint,
    /// How many coordinates are not hidden.
    n: usize,
    q: Vec<f64>,
    memory: Vec<f64>,
    /// Held values that the loop reads, by their places.
    read: Vec<usize>,
}

impl Search {
    fn new<S: System + ?Sized>(system: &S, guess: &Guess, memory: &[f64]) -> Search {
        let (n, mut q) = (system.description().mechanical(), guess.q.clone());
        q.iter_mut().skip(n).for_each(|hidden| *hidden = 0.0);
        let base = LinearisationPoint::new(system, guess);
        base.system.borrow_mut().set_memory(memory);
        Search { base, n, q, memory: memory.to_vec(), read: Vec::new() }
    }

    fn at(&self) -> At<'_> {
        At::new(0.0, &self.q, &self.base.v).accelerated(self.base.at_rest())
    }

    /// ∂F/∂m, a column for each held value.
    fn forces_by_memory(&self) -> DMatrix<f64> {
        let mut slopes = DMatrix::zeros(self.base.n, self.memory.len());
        let system = self.base.system.borrow();
        for (j, mut column) in slopes.column_iter_mut().enumerate() {
            let along = Along { memory: Some(j), ..Along::default() };
            system.slopes(Function::Residual, self.at(), &along, column.as_mut_slice());
        }
        slopes
    }

    /// The slopes of all assignments along a direction.
    fn assignments_along(&self, along: &Along<'_>) -> Vec<f64> {
        let system = self.base.system.borrow();
        let mut slopes = vec![0.0; system.sampling().assignments()];
        system.slopes(Function::Assignments, self.at(), along, &mut slopes);
        slopes
    }

    fn assignments(&self) -> Vec<f64> {
        let system = self.base.system.borrow();
        let mut values = vec![0.0; system.sampling().assignments()];
        system.assignments(self.at(), &mut values);
        values
    }

    /// Events that act at a tick of these clocks, in the order in which they do: those of the file, then those that follow what was set.
    fn acting(&self, ticking: &[bool]) -> Vec<usize> {
        let system = self.base.system.borrow();
        let (description, sampling) = (system.description(), system.sampling());
        let phase = system.phase() as u32;
        let mut pairs = vec![0.0; 2 * description.events.len()];
        system.events(self.at(), &mut pairs);
        let acts = |event: &usize| {
            let described = &description.events[*event];
            let counts = described.phases.as_ref().is_none_or(|phases| phases.contains(&phase));
            counts && (!described.conditional || pairs[2 * event + 1] > 0.0)
        };
        let ticks =
            |event: &usize| matches!(sampling.trigger(*event), Trigger::Tick(clock) if ticking[*clock as usize]);
        let first: Vec<usize> = (0..description.events.len()).filter(ticks).filter(acts).collect();
        let set: Vec<u32> = first
            .iter()
            .flat_map(|event| self.of_event(*event))
            .filter_map(|assignment| if let Target::Memory(place) = assignment.target { Some(place) } else { None })
            .collect();
        let follows = |event: &usize| matches!(sampling.trigger(*event), Trigger::Set(held) if held.iter().any(|j| set.contains(j)));
        let then: Vec<usize> = (0..description.events.len()).filter(follows).filter(acts).collect();
        first.into_iter().chain(then).collect()
    }

    /// What an event sets, set by set.
    fn sets_of(&self, event: usize) -> Vec<Vec<Assignment>> {
        let system = self.base.system.borrow();
        let sampling = system.sampling();
        let sets = system.description().events[event].actions.iter().filter_map(|action| match action {
            Action::Set(set) => Some(*set as usize),
            _ => None,
        });
        let of_set = |set: usize| {
            let targets = sampling.sets[set].iter().zip(sampling.first_of_set(set)..);
            targets.map(|(target, place)| Assignment { target: *target, place }).collect()
        };
        sets.map(of_set).collect()
    }

    fn of_event(&self, event: usize) -> Vec<Assignment> {
        self.sets_of(event).into_iter().flatten().collect()
    }

    /// Everything that any tick sets.
    fn all_assignments(&self) -> Vec<Assignment> {
        let clocks = self.base.system.borrow().sampling().clocks.len();
        self.acting(&vec![true; clocks]).into_iter().flat_map(|event| self.of_event(event)).collect()
    }

    /// Finds the held values that forces read, or what is set to these: at the guess, and beside it, since a slope may vanish by accident.
    fn find_read(&mut self) {
        let (q, memory) = (self.q.clone(), self.memory.clone());
        let mut read = vec![false; memory.len()];
        for beside in [0.0, 0.37] {
            self.q
                .iter_mut()
                .zip(&q)
                .take(self.n)
                .enumerate()
                .for_each(|(i, (x, q))| *x = q + beside / (1.0 + i as f64));
            self.memory.iter_mut().zip(&memory).for_each(|(x, m)| *x = m + beside * (1.0 + m.abs()));
            self.put_memory();
            let forces = self.forces_by_memory();
            (0..read.len()).for_each(|j| read[j] |= forces.column(j).iter().any(|slope| *slope != 0.0));
            let assignments = self.all_assignments();
            let slopes: Vec<Vec<f64>> = (0..read.len())
                .map(|j| self.assignments_along(&Along { memory: Some(j), ..Along::default() }))
                .collect();
            // Each round finds what is read by what was found before.
            for _ in 0..read.len() {
                for Assignment { target, place } in &assignments {
                    let counts = match target {
                        Target::Memory(j) => read[*j as usize],
                        Target::State(_) => true,
                    };
                    (0..read.len()).filter(|_| counts).for_each(|j| read[j] |= slopes[j][*place] != 0.0);
                }
            }
        }
        (self.q, self.memory) = (q, memory);
        self.put_memory();
        self.read = (0..read.len()).filter(|j| read[*j]).collect();
    }

    fn put_memory(&self) {
        self.base.system.borrow_mut().set_memory(&self.memory);
    }

    /// Assignments to what the loop reads, and to states.
    fn equations(&self) -> Vec<Assignment> {
        let counts = |assignment: &Assignment| match assignment.target {
            Target::Memory(j) => self.read.contains(&(j as usize)),
            Target::State(_) => true,
        };
        self.all_assignments().into_iter().filter(counts).collect()
    }

    /// What is sought: coordinates, states and held values.
    fn unknowns(&self) -> Vec<f64> {
        let held = self.read.iter().map(|j| self.memory[*j]);
        self.q[..self.n].iter().chain(&self.base.v[self.n..]).copied().chain(held).collect()
    }

    fn set(&mut self, unknowns: &[f64]) {
        let all = self.base.n;
        self.q[..self.n].copy_from_slice(&unknowns[..self.n]);
        self.base.v[self.n..].copy_from_slice(&unknowns[self.n..all]);
        self.read.iter().zip(&unknowns[all..]).for_each(|(j, value)| self.memory[*j] = *value);
        self.put_memory();
    }

    /// F, then what is held less what it is set to.
    fn left(&self) -> Vec<f64> {
        let force = self.base.force(&self.q);
        let values = self.assignments();
        let differences =
            self.equations().into_iter().map(|Assignment { target, place }| self.held(target) - values[place]);
        force.into_iter().chain(differences).collect()
    }

    /// The present value of what is set.
    fn held(&self, target: Target) -> f64 {
        match target {
            Target::Memory(j) => self.memory[j as usize],
            Target::State(i) => self.base.v[i as usize],
        }
    }

    /// The slopes of [`Search::left`] by the unknowns.
    fn slopes(&self) -> DMatrix<f64> {
        let (n, all, equations) = (self.n, self.base.n, self.equations());
        let [_, damping, stiffness] = self.base.matrices(&self.q);
        let (damping, stiffness, by_memory) = (damping.to_dense(), stiffness.to_dense(), self.forces_by_memory());
        let mut slopes = DMatrix::zeros(all + equations.len(), all + self.read.len());
        for column in 0..all {
            let of = if column < n { &stiffness } else { &damping };
            slopes.view_mut((0, column), (all, 1)).copy_from(&of.column(column));
        }
        for (k, j) in self.read.iter().enumerate() {
            slopes.view_mut((0, all + k), (all, 1)).copy_from(&by_memory.column(*j));
        }
        let mut unit = vec![0.0; all];
        for column in 0..slopes.ncols() {
            let along = match column {
                column if column < all => {
                    unit[column] = 1.0;
                    if column < n {
                        Along { q: &unit, ..Along::default() }
                    } else {
                        Along { v: &unit, ..Along::default() }
                    }
                }
                _ => Along { memory: Some(self.read[column - all]), ..Along::default() },
            };
            let found = self.assignments_along(&along);
            for (row, Assignment { target, place }) in equations.iter().enumerate() {
                let own = match target {
                    Target::Memory(j) => column >= all && self.read[column - all] == *j as usize,
                    Target::State(i) => column < all && column == *i as usize,
                };
                slopes[(all + row, column)] = f64::from(u8::from(own)) - found[*place];
            }
            unit.fill(0.0);
        }
        slopes
    }

    /// By which sizes the equations are judged.
    fn measures(&self) -> Vec<f64> {
        let (slopes, unknowns) = (self.slopes(), self.unknowns());
        let force = self.base.measure(&self.q);
        let by_memory: Vec<f64> = (0..slopes.nrows())
            .map(|row| (0..slopes.ncols()).map(|column| (slopes[(row, column)] * unknowns[column]).abs()).sum())
            .collect();
        let equations = self.equations();
        let values = self.assignments();
        let own = equations.iter().map(|assignment| values[assignment.place].abs());
        force.into_iter().chain(own).zip(by_memory).map(|(own, sum)| own + sum).collect()
    }

    /// The largest part of its terms that is left of an equation.
    fn residual(&self) -> f64 {
        let parts = self.left().into_iter().zip(self.measures());
        parts.map(|(left, measure)| if left == 0.0 { 0.0 } else { left.abs() / measure }).fold(
            0.0,
            |most: f64, part| {
                if part.is_nan() { part } else { most.max(part) }
            },
        )
    }

    /// Newton's method by least steps, halved until the equations are better met; how many steps there were.
    fn newton(&mut self) -> Result<usize, LinearError> {
        let mut reach: Vec<f64> = self.unknowns().iter().map(|x| x.abs()).collect();
        let mut iterations = 0;
        while iterations < ITERATIONS && self.residual() > EXACT {
            let slopes = self.slopes();
            if slopes.iter().any(|x| !x.is_finite()) {
                return Err(self.nowhere(iterations));
            }
            let weights: Vec<f64> = slopes.row_iter().map(|row| 1.0 / row.amax().max(f64::MIN_POSITIVE)).collect();
            let size = |left: &[f64]| left.iter().zip(&weights).map(|(f, w)| (f * w).powi(2)).sum::<f64>();
            let left = self.left();
            let right = DMatrix::from_column_slice(left.len(), 1, &left);
            let Some(step) = solve_least(&slopes, &right) else { return Err(self.nowhere(iterations)) };
            let (from, before) = (self.unknowns(), size(&left));
            let mut part = 1.0;
            loop {
                let tried: Vec<f64> = from.iter().zip(step.iter()).map(|(x, step)| x - part * step).collect();
                self.set(&tried);
                if size(&self.left()) < before {
                    break;
                }
                part *= 0.5;
                if part < SHORTEST {
                    self.set(&from);
                    return Ok(iterations);
                }
            }
            iterations += 1;
            reach.iter_mut().zip(self.unknowns()).for_each(|(reach, x)| *reach = reach.max(x.abs()));
            self.without_rounding(&reach);
        }
        Ok(iterations)
    }

    /// Sets to 0 what has all but vanished, if that is a rest too.
    fn without_rounding(&mut self, reach: &[f64]) {
        let from = self.unknowns();
        let gone = |(x, reach): (&f64, &f64)| if x.abs() <= GONE * reach { 0.0 } else { *x };
        let clean: Vec<f64> = from.iter().zip(reach).map(gone).collect();
        if clean != from {
            self.set(&clean);
            if self.residual() > EXACT {
                self.set(&from);
            }
        }
    }

    fn place(&self) -> Vec<(String, f64)> {
        let system = self.base.system.borrow();
        let names = system.description().coordinates.iter().map(|c| c.state().unwrap_or(&c.name).to_owned());
        names.zip(self.unknowns()).collect()
    }

    fn held_values(&self) -> Vec<(String, f64)> {
        let system = self.base.system.borrow();
        let memory = &system.sampling().memory;
        self.read.iter().map(|j| (memory[*j].name.to_string(), self.memory[*j])).collect()
    }

    /// The state, and what is left there, by name.
    fn nowhere(&self, iterations: usize) -> LinearError {
        let left = self.left();
        let (force, set) = left.split_at(self.base.n);
        let mut residual = self.base.forces(force);
        let system = self.base.system.borrow();
        let named = self.equations().into_iter().zip(set).map(|(Assignment { target, .. }, left)| Residual {
            coordinate: match target {
                Target::Memory(j) => system.sampling().memory[j as usize].name.to_string(),
                Target::State(i) => system.description().coordinate_name(i as usize),
            },
            force: *left,
            unit: String::new(),
        });
        residual.extend(named);
        let point = self.place().into_iter().chain(self.held_values()).collect();
        LinearError::NoEquilibrium { iterations, point, residual }
    }

    /// The loop about the rest that was found.
    fn closed(&self, cycle: &Cycle, residual: f64) -> Result<SampledLoop, LinearError> {
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
        let unread = (0..self.memory.len()).filter(|j| !self.read.contains(j));
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
            residual,
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
