//! Accelerations and multipliers of a constrained mechanism, by elimination.
//!
//! M a + h = (Jᵀ + B) λ, J a + γ = 0, with the rows J of the constraints that are active, and B from forces that are
//! made of multipliers, as friction is.  M = L D Lᵀ gives the Schur complement S = J M⁻¹ Jᵀ.  Which rows count is chosen
//! anew at every factorization: pivoted Cholesky of S, its rows scaled by the largest norms they have had, leaves out
//! those whose pivots are negligible (`rows.rs`).  So redundant rows and singular positions are treated by one rule.  Rows that
//! never count share the force of those on which they depend (`shares.rs`); those that cease to count near a singular position keep what they had before.

mod comparison;
mod crossed;
mod determined;
mod null_space;
mod rows;
mod shares;
mod slopes;

use super::phased::RowHistory;
use super::{At, Singular, SingularMass, System};
use super::{factor_packed, rows_in_force, substitute_back, substitute_forward};
pub(crate) use null_space::Solutions;

/// A pivot of M is rounding below this part of its diagonal.
const NOTHING: f64 = 1e-11;
/// Rows that inertias bring this much nearer to each other lose three digits by it, as by masses that differ by a factor of a thousand; rows
/// that do depend on each other are brought nearer by far less.
pub(super) const LOPSIDED: f64 = 30.0;
/// So many roundings may have been made on the way to it: a few for each of the products that are subtracted.
const ROUNDINGS: f64 = 64.0;

/// M and J of one state, factored, and room to do so.
#[derive(Clone, Debug, Default)]
pub(crate) struct KktSolver {
    n: usize,
    /// Rows in force, among all rows of the mechanism.
    active: Vec<usize>,
    /// Which of them are rates of sliding of what sticks.
    along: Vec<bool>,
    /// M's packed lower triangle; factored, L and the reciprocals of D.
    mass: Vec<f64>,
    /// J, active rows one after the other.
    rows: Vec<f64>,
    /// L⁻¹ Jᵀ, a line for each active row.
    half: Vec<f64>,
    /// L⁻¹ (Jᵀ + B) likewise.
    pushed: Vec<f64>,
    /// The Cholesky factor of the scaled S, rows and columns in the order of the pivots.
    schur: Vec<f64>,
    /// J M⁻¹ (Jᵀ + B) of the rows that are kept, eliminated.
    rubbed: Vec<f64>,
    /// The rows' norms √S_kk, or the largest there were.
    norms: Vec<f64>,
    /// J at another place, later L⁻¹ Jᵀ of it, likewise.
    ahead: Vec<f64>,
    /// J M⁻¹ Jᵀ with J at the other place on the left and at this one on the right, of the rows that are kept, scaled and factored.
    crossed: Vec<f64>,
    pivots: Vec<usize>,
    gamma: Vec<f64>,
    /// What JᵀJ was added to M with, row by row, where M alone is singular.
    strength: Vec<f64>,
    h: Vec<f64>,
    right: Vec<f64>,
    found: Vec<f64>,
    values: Vec<f64>,
    /// Which accelerations the rows determine by themselves.
    known: Vec<bool>,
    /// J of as many rows as there are coordinates, and which of them were exchanged.
    square: Vec<f64>,
    exchanged: Vec<usize>,
    determined: Vec<f64>,
    /// Active rows in the order of their pivots; those beyond `rank` are left out.
    order: Vec<usize>,
    rank: usize,
    weakest: f64,
}

/// A number that is wrong by so many half units in its last place, up at even places and down at odd ones.
fn wrong(value: f64, place: usize, times: f64) -> f64 {
    let times = if place.is_multiple_of(2) { times } else { -times };
    value * (1.0 + times * 0.5 * f64::EPSILON)
}

impl KktSolver {
    /// How many rows are kept.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Rows in force, among all rows of the mechanism.
    pub fn active(&self) -> &[usize] {
        &self.active
    }

    /// The root of the smallest pivot that was kept, or of the largest that was not, beside the largest norm of its row:
    /// how far the rows are from depending on each other.
    pub fn weakest(&self) -> f64 {
        self.weakest
    }

    /// √(J_k M⁻¹ J_kᵀ) of the active rows, or the largest there were before.
    pub fn norms(&self) -> &[f64] {
        &self.norms
    }

    /// The entries of J of the active rows, row by row.
    pub fn entries(&self) -> impl Iterator<Item = &[f64]> {
        self.rows.chunks_exact(self.n.max(1))
    }

    /// Takes M and J at a place and factors them.
    ///
    /// # Errors
    /// A combination of coordinates to which neither M nor a constraint gives any inertia.
    pub fn factor<S: System + ?Sized>(&mut self, system: &S, at: At<'_>) -> Result<(), Singular> {
        self.take(system, at);
        self.again(system, at)
    }

    /// As [`KktSolver::factor`], with these rows in the place of the active ones.
    ///
    /// # Errors
    /// As [`KktSolver::factor`].
    pub fn factor_rows<S: System + ?Sized>(&mut self, system: &S, at: At<'_>, rows: &[usize]) -> Result<(), Singular> {
        self.active.clear();
        self.active.extend_from_slice(rows);
        self.load(system, at);
        self.again(system, at)
    }

    /// Takes note of the rows in force, and takes their J and M at a place.
    fn take<S: System + ?Sized>(&mut self, system: &S, at: At<'_>) {
        self.active.clear();
        self.active.extend(rows_in_force(system));
        self.load(system, at);
    }

    /// Makes room for the rows in force, and takes their J and M at a place.
    fn load<S: System + ?Sized>(&mut self, system: &S, at: At<'_>) {
        self.n = system.len();
        let (n, m) = (self.n, self.active.len());
        for (list, size) in [
            (&mut self.mass, n * (n + 1) / 2),
            (&mut self.rows, m * n),
            (&mut self.half, m * n),
            (&mut self.schur, m * m),
            (&mut self.norms, m),
            (&mut self.gamma, m),
            (&mut self.strength, m),
            (&mut self.right, m),
            (&mut self.found, m),
            (&mut self.h, n),
        ] {
            list.resize(size, 0.0);
        }
        let contacts = &system.contacts().all;
        let is_along = |row: &usize| contacts.iter().any(|contact| contact.tangents().any(|own| own as usize == *row));
        self.along.clear();
        self.along.extend(self.active.iter().map(is_along));
        self.load_rows(system, at);
        self.load_mass(system, at);
    }

    /// Factors what was taken.
    fn again<S: System + ?Sized>(&mut self, system: &S, at: At<'_>) -> Result<(), Singular> {
        let n = self.n;
        self.strength.fill(0.0);
        let factored = factor_packed(&mut self.mass, n);
        let regular = factored.is_ok();
        let singular = factored.err().or_else(|| self.nearly_singular());
        if let Some(fault) = singular {
            self.load_mass(system, at);
            let strengthened = self.strengthen(fault);
            if strengthened.is_err() && regular {
                // No constraint holds it: what M leaves is all there is.
                self.strength.fill(0.0);
                self.load_mass(system, at);
                factor_packed(&mut self.mass, n)?;
            } else {
                strengthened?;
            }
        }
        self.find_rows(system, None);
        if singular.is_none() {
            self.part_rows(system, at);
        }
        Ok(())
    }

    /// Takes J M⁻¹ Jᵀ and chooses the rows; `lengths` are what rows keep of their largest norms, where M was strengthened meanwhile.
    fn find_rows<S: System + ?Sized>(&mut self, system: &S, lengths: Option<&[f64]>) {
        self.half.copy_from_slice(&self.rows);
        for line in self.half.chunks_exact_mut(self.n.max(1)) {
            substitute_forward(&self.mass, line);
        }
        self.multiply_rows(system.disturbance());
        let known = self.known_rank(system).unwrap_or(0);
        self.choose_rows(system.row_history().unwrap_or(&RowHistory::default()), lengths, known);
    }

    /// How many of the rows in force are independent elsewhere, where these are all that act.
    fn known_rank<S: System + ?Sized>(&self, system: &S) -> Option<usize> {
        let active = rows_in_force(system);
        let phase = system.description().phases.get(system.phase())?;
        active.eq(self.active.iter().copied()).then_some(phase.rank as usize)
    }

    /// Rows may seem to depend on each other because masses are very different: those of a light body between heavy ones, or of the
    /// foot of a heavy one.  M + Jᵀ R J, which moves alike, tells them apart; where that is no better by far, they do depend on each other.
    fn part_rows<S: System + ?Sized>(&mut self, system: &S, at: At<'_>) {
        let usual = self.known_rank(system).unwrap_or(self.active.len());
        let distance = self.distance(usual);
        if distance * LOPSIDED > 1.0 {
            return;
        }
        let plain = self.clone();
        let lengths = self.lengths();
        self.load_mass(system, at);
        let strengthened = self.strengthen(SingularMass { coordinate: 0 });
        self.find_rows(system, Some(&lengths));
        if strengthened.is_err() || self.distance(usual) < LOPSIDED * distance {
            *self = plain;
        }
    }

    /// Solves M δ − Jᵀ μ = f, J δ = g with the rows that were kept: `f` becomes δ, `g` becomes μ, which is 0 for rows
    /// that were left out.
    pub fn solve(&mut self, f: &mut [f64], g: &mut [f64]) {
        let n = self.n;
        // What M was strengthened by does its part of the work: Jᵀ R g.
        for (k, strength) in self.strength.iter().enumerate() {
            self.found[k] = strength * g[k];
        }
        substitute_forward(&self.mass, f);
        for (k, g) in g.iter_mut().enumerate() {
            *g -= weighted(&self.mass, &self.half[k * n..][..n], f);
        }
        self.cholesky_solve(g);
        for (k, mu) in g.iter_mut().enumerate() {
            add(f, *mu, &self.half[k * n..][..n]);
            *mu -= self.found[k];
        }
        substitute_back(&self.mass, f);
    }

    /// As [`KktSolver::solve`], δ being what J δ = g alone makes of it where rows determine it by themselves.
    pub fn solve_exactly(&mut self, f: &mut [f64], g: &mut [f64]) {
        self.gamma.iter_mut().zip(&*g).for_each(|(gamma, g)| *gamma = -g);
        self.solve(f, g);
        self.determine(f);
    }

    /// The accelerations, and the multipliers of all rows of the mechanism, at a state; constraints that are missed return
    /// to 0 like e^(−α t).
    ///
    /// # Errors
    /// As [`KktSolver::factor`]; friction that leaves no reaction, or more than one (Painlevé 1895).
    pub fn accelerations_and_multipliers<S: System + ?Sized>(
        &mut self,
        system: &S,
        at: At<'_>,
        alpha: f64,
        a: &mut [f64],
        lambda: &mut [f64],
    ) -> Result<(), Singular> {
        self.stand(system, at)?;
        self.motion_here(system, at, alpha, a, lambda)
    }

    /// Takes M, J and h at a state and factors them.
    ///
    /// # Errors
    /// As [`KktSolver::factor`].
    pub fn stand<S: System + ?Sized>(&mut self, system: &S, at: At<'_>) -> Result<(), Singular> {
        self.factor(system, at)?;
        system.bias(at, &mut self.h);
        Ok(())
    }

    /// As [`KktSolver::accelerations_and_multipliers`], with M, J and h as they were taken last: at the same place, and at any speeds of which h does not
    /// depend.
    ///
    /// # Errors
    /// As [`KktSolver::accelerations_and_multipliers`].
    pub fn motion_here<S: System + ?Sized>(
        &mut self,
        system: &S,
        at: At<'_>,
        alpha: f64,
        a: &mut [f64],
        lambda: &mut [f64],
    ) -> Result<(), Singular> {
        a.iter_mut().zip(&self.h).for_each(|(a, h)| *a = -h);
        self.load_gamma(system, at, alpha, lambda);
        self.solve_motion(system, at, a, lambda)
    }

    /// The rates of accelerations and multipliers, at a state with its own; false where rows are left out, whose share in
    /// the reactions changes otherwise.
    ///
    /// # Errors
    /// As [`KktSolver::accelerations_and_multipliers`].
    pub fn rates<S: System + ?Sized>(
        &mut self,
        system: &S,
        at: At<'_>,
        a: &mut [f64],
        lambda: &mut [f64],
    ) -> Result<bool, Singular> {
        self.factor(system, at)?;
        if self.rank < self.active.len() {
            return Ok(false);
        }
        let n = self.n;
        let mut held = vec![0.0; n + system.description().rows.len()];
        system.held_rates(at, &mut held);
        a.iter_mut().zip(&held).for_each(|(a, rate)| *a = -rate);
        for (gamma, row) in self.gamma.iter_mut().zip(&self.active) {
            *gamma = held[n + row];
        }
        self.solve_motion(system, at, a, lambda).map(|()| true)
    }

    /// M a − (Jᵀ + B) λ = f, which is in `a`, and J a = −γ.
    fn solve_motion<S: System + ?Sized>(
        &mut self,
        system: &S,
        at: At<'_>,
        a: &mut [f64],
        lambda: &mut [f64],
    ) -> Result<(), Singular> {
        let usual = system.description().phases.get(system.phase()).map_or(0, |phase| phase.rank as usize);
        let held = system.row_history().map_or(&[][..], |history| &history.multipliers);
        let held = if self.rank < usual { held } else { &[] };
        let solved = self.solve_held(system, at, held, a);
        lambda.fill(0.0);
        for (k, row) in self.active.iter().enumerate() {
            lambda[*row] = self.found[k] + self.strength[k] * self.gamma[k];
        }
        for row in self.order[self.rank..].iter().map(|k| self.active[*k]) {
            lambda[row] += held.get(row).copied().unwrap_or(0.0);
        }
        solved
    }

    /// As [`KktSolver::solve_motion`], rows that are left out having these multipliers; those of the others are in `found`.
    fn solve_held<S: System + ?Sized>(
        &mut self,
        system: &S,
        at: At<'_>,
        held: &[f64],
        a: &mut [f64],
    ) -> Result<(), Singular> {
        let (n, m) = (self.n, self.active.len());
        let rubs = m > 0 && !system.description().friction_pattern.is_empty();
        if rubs {
            self.load_friction(system, at, a);
        }
        substitute_forward(&self.mass, a);
        self.hold(held, rubs, a);
        let mut found = std::mem::take(&mut self.found);
        for (k, right) in found.iter_mut().enumerate() {
            *right = -self.gamma[k] - weighted(&self.mass, &self.half[k * n..][..n], a);
        }
        let solved = if rubs {
            let shares = self.shares(system);
            self.rub(shares.as_ref(), &mut found)
        } else {
            self.cholesky_solve(&mut found);
            Ok(())
        };
        let lines = if rubs { &self.pushed } else { &self.half };
        for (k, lambda) in found.iter().enumerate() {
            add(a, *lambda, &lines[k * n..][..n]);
        }
        substitute_back(&self.mass, a);
        self.found = found;
        self.determine(a);
        solved
    }

    /// γ of the rows in force, with what brings back constraints that are missed; `room` is for all rows.
    fn load_gamma<S: System + ?Sized>(&mut self, system: &S, at: At<'_>, alpha: f64, room: &mut [f64]) {
        system.constraint_bias(at, room);
        for (gamma, row) in self.gamma.iter_mut().zip(&self.active) {
            *gamma = room[*row];
        }
        self.gamma.iter_mut().enumerate().for_each(|(k, gamma)| *gamma = wrong(*gamma, k, system.disturbance()));
        if alpha > 0.0 {
            let rows = &system.description().rows;
            let mut triples = vec![0.0; 3 * rows.len()];
            system.constraints(at, &mut triples);
            for (gamma, &row) in self.gamma.iter_mut().zip(&self.active) {
                let (c, rate) = (triples[3 * row], triples[3 * row + 1]);
                *gamma += if rows[row].holonomic { alpha * (2.0 * rate + alpha * c) } else { alpha * rate };
            }
        }
    }

    /// Adds to a force what rows that are left out did when they still counted.
    fn hold(&self, held: &[f64], rubs: bool, force: &mut [f64]) {
        let lines = if rubs { &self.pushed } else { &self.half };
        for &k in &self.order[self.rank..] {
            if let Some(lambda) = held.get(self.active[k]) {
                add(force, *lambda, &lines[k * self.n..][..self.n]);
            }
        }
    }

    fn load_rows<S: System + ?Sized>(&mut self, system: &S, at: At<'_>) {
        let pattern = &system.description().constraint_pattern;
        self.values.resize(pattern.len(), 0.0);
        system.constraint_matrix(at, &mut self.values);
        self.rows.fill(0.0);
        let mut place = self.active.iter().enumerate().peekable();
        // Both are in the order of the rows.
        for ((row, column), value) in pattern.iter().zip(&self.values) {
            while place.next_if(|(_, active)| **active < *row as usize).is_some() {}
            if let Some((k, _)) = place.peek().filter(|(_, active)| **active == *row as usize) {
                self.rows[k * self.n + *column as usize] = *value;
            }
        }
    }

    fn load_mass<S: System + ?Sized>(&mut self, system: &S, at: At<'_>) {
        let (pattern, disturbance) = (&system.description().mass_pattern, system.disturbance());
        self.values.resize(pattern.len(), 0.0);
        system.mass_matrix(at, &mut self.values);
        self.mass.fill(0.0);
        for ((row, column), value) in pattern.iter().zip(&self.values) {
            let (row, column) = (*row as usize, *column as usize);
            self.mass[packed(row, column)] = wrong(*value, row + column, disturbance);
        }
    }

    /// L⁻¹ (Jᵀ + B), and what B makes of the part of λ that the strengthened M does not see.
    fn load_friction<S: System + ?Sized>(&mut self, system: &S, at: At<'_>, force: &mut [f64]) {
        let n = self.n;
        let pattern = &system.description().friction_pattern;
        self.values.resize(pattern.len(), 0.0);
        system.friction(at, &mut self.values);
        self.pushed.clear();
        self.pushed.extend_from_slice(&self.rows);
        for ((coordinate, row), value) in pattern.iter().zip(&self.values) {
            let Some(k) = self.active.iter().position(|active| *active == *row as usize) else { continue };
            self.pushed[k * n + *coordinate as usize] += value;
            force[*coordinate as usize] += value * self.strength[k] * self.gamma[k];
        }
        for line in self.pushed.chunks_exact_mut(n.max(1)) {
            substitute_forward(&self.mass, line);
        }
    }

    /// A coordinate to which M leaves no more inertia than rounding does, beside the constraints that may hold it.
    ///
    /// A pivot that is the part r of its diagonal is known to ε/r of itself, and so is what is subtracted from the later ones by it.
    fn nearly_singular(&self) -> Option<SingularMass> {
        let pivot = |i: usize| 1.0 / self.mass[packed(i, i)];
        let whole = |i: usize| pivot(i) + (0..i).map(|j| self.mass[packed(i, j)].powi(2) * pivot(j)).sum::<f64>();
        let coordinates = if self.active.is_empty() { 0 } else { self.n };
        let mut least = 1.0_f64;
        for coordinate in 0..coordinates {
            let part = pivot(coordinate) / whole(coordinate);
            if part <= NOTHING.max(ROUNDINGS * f64::EPSILON / least) {
                return Some(SingularMass { coordinate });
            }
            least = least.min(part);
        }
        None
    }

    /// Factors M + Jᵀ R J, which is regular where M is so on the motions that the constraints leave.
    ///
    /// With λ = λ' + R γ that changes no acceleration.
    fn strengthen(&mut self, fault: SingularMass) -> Result<(), SingularMass> {
        let n = self.n;
        let largest = (0..n).fold(0.0_f64, |most, i| most.max(self.mass[packed(i, i)].abs()));
        for k in 0..self.active.len() {
            let row = &self.rows[k * n..][..n];
            // Coordinates that have inertia say what is much.
            let own = |i: usize| self.mass[packed(i, i)];
            let by_mass = (0..n).filter(|i| own(*i) > 0.0).map(|i| row[i] * row[i] / own(i)).sum::<f64>();
            let size = row.iter().map(|x| x * x).sum::<f64>();
            let weakest = if by_mass > 0.0 { 1.0 / by_mass } else { 0.0 };
            // What has next to no inertia may be held by a row all the same.
            self.strength[k] = if size > 0.0 { weakest.max(largest / size) } else { 0.0 };
        }
        for k in 0..self.active.len() {
            let row = &self.rows[k * n..][..n];
            for i in (0..n).filter(|i| row[*i] != 0.0) {
                for j in 0..=i {
                    self.mass[packed(i, j)] += self.strength[k] * row[i] * row[j];
                }
            }
        }
        factor_packed(&mut self.mass, n).map_err(|_| fault)
    }
}

/// The place of (row, column) in a packed lower triangle, in either order.
fn packed(i: usize, j: usize) -> usize {
    let (row, column) = (i.max(j), i.min(j));
    row * (row + 1) / 2 + column
}

/// xᵀ D⁻¹ y.
fn weighted(mass: &[f64], x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).enumerate().map(|(i, (x, y))| mass[packed(i, i)] * x * y).sum()
}

/// y += factor x.
fn add(y: &mut [f64], factor: f64, x: &[f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += factor * x);
}
