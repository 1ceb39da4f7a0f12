//! Accelerations and multipliers of a constrained mechanism, by elimination.
//!
//! M a + h = (Jᵀ + B) λ, J a + γ = 0, with the rows J of the constraints that are active, and B from forces that are
//! made of multipliers, as friction is.  M = L D Lᵀ gives the Schur complement S = J M⁻¹ Jᵀ.  Which rows count is chosen
//! anew at every factorization: pivoted Cholesky of S, its rows scaled by the largest norms they have had, leaves out
//! those whose pivots are negligible.  So redundant rows and singular positions are treated by one rule: λ = 0 in rows that
//! never count; in those that cease to count near a singular position, what it was before.

use super::solve::{factor_packed, substitute_back, substitute_forward};
use super::{At, Singular, SingularMass, Solutions, System};
use nalgebra::{DMatrix, DVector};

/// A row whose pivot, its distance from the rows before it, is below this part of its largest norm is left out.
const WEAK: f64 = 1e-3;
/// With more rows than this ordinary pivots are smaller: a straight chain of m rods has 1.1/m.
const MANY: f64 = 8.0;
/// Friction that leaves this part of a pivot, or less, lets the reaction grow without bound.
const PAINLEVE: f64 = 1e-9;

/// M and J of one state, factored, and room to do so.
#[derive(Clone, Debug, Default)]
pub(crate) struct Form {
    n: usize,
    /// Rows in force, among all rows of the mechanism.
    active: Vec<usize>,
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
    gamma: Vec<f64>,
    /// What JᵀJ was added to M with, row by row, where M alone is singular.
    strength: Vec<f64>,
    h: Vec<f64>,
    right: Vec<f64>,
    found: Vec<f64>,
    values: Vec<f64>,
    /// Active rows in the order of their pivots; those beyond `rank` are left out.
    order: Vec<usize>,
    rank: usize,
    weakest: f64,
}

impl Form {
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

    /// Rows that were chosen after so many others, in the order of the mechanism's.
    pub fn chosen_after(&self, count: usize) -> Vec<usize> {
        let mut rows: Vec<usize> = self.order.iter().skip(count).map(|k| self.active[*k]).collect();
        rows.sort_unstable();
        rows
    }

    /// √(J_k M⁻¹ J_kᵀ) of the active rows, or the largest there were before.
    pub fn norms(&self) -> &[f64] {
        &self.norms
    }

    /// Takes M and J at a place and factors them.
    ///
    /// # Errors
    /// A combination of coordinates to which neither M nor a constraint gives any inertia.
    pub fn factor<S: System + ?Sized>(&mut self, system: &S, at: At<'_>) -> Result<(), Singular> {
        self.active.clear();
        self.active.extend(system.active_rows().iter().map(|row| *row as usize));
        self.again(system, at)
    }

    /// As [`Form::factor`], with these rows in the place of the active ones.
    ///
    /// # Errors
    /// As [`Form::factor`].
    pub fn factor_rows<S: System + ?Sized>(&mut self, system: &S, at: At<'_>, rows: &[usize]) -> Result<(), Singular> {
        self.active.clear();
        self.active.extend_from_slice(rows);
        self.again(system, at)
    }

    fn again<S: System + ?Sized>(&mut self, system: &S, at: At<'_>) -> Result<(), Singular> {
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
        self.load_rows(system, at);
        self.load_mass(system, at);
        self.strength.fill(0.0);
        if let Err(fault) = factor_packed(&mut self.mass, n) {
            self.load_mass(system, at);
            self.strengthen(fault)?;
        }
        self.half.copy_from_slice(&self.rows);
        for line in self.half.chunks_exact_mut(n.max(1)) {
            substitute_forward(&self.mass, line);
        }
        let (norms, last) =
            system.row_history().map_or((&[][..], &[][..]), |history| (&history.norms[..], &history.last[..]));
        self.choose_rows(norms, last);
        Ok(())
    }

    /// Solves M δ − Jᵀ μ = f, J δ = g with the rows that were kept: `f` becomes δ, `g` becomes μ, which is 0 for rows
    /// that were left out.
    pub fn solve(&mut self, f: &mut [f64], g: &mut [f64]) {
        let n = self.n;
        substitute_forward(&self.mass, f);
        for (k, g) in g.iter_mut().enumerate() {
            *g -= weighted(&self.mass, &self.half[k * n..][..n], f);
        }
        self.cholesky_solve(g);
        for (k, mu) in g.iter().enumerate() {
            add(f, *mu, &self.half[k * n..][..n]);
        }
        substitute_back(&self.mass, f);
    }

    /// The accelerations, and the multipliers of all rows of the mechanism, at a state; constraints that are missed return
    /// to 0 like e^(−α t).
    ///
    /// # Errors
    /// As [`Form::factor`]; friction that leaves no reaction, or more than one (Painlevé 1895).
    pub fn motion<S: System + ?Sized>(
        &mut self,
        system: &S,
        at: At<'_>,
        alpha: f64,
        a: &mut [f64],
        lambda: &mut [f64],
    ) -> Result<(), Singular> {
        self.factor(system, at)?;
        system.bias(at, &mut self.h);
        a.iter_mut().zip(&self.h).for_each(|(a, h)| *a = -h);
        self.load_gamma(system, at, alpha, lambda);
        self.solve_motion(system, at, a, lambda)
    }

    /// The rates of accelerations and multipliers, at a state with its own; false where rows are left out, whose share in
    /// the reactions changes otherwise.
    ///
    /// # Errors
    /// As [`Form::motion`].
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
        let (n, m) = (self.n, self.active.len());
        let rubs = m > 0 && !system.description().friction_pattern.is_empty();
        if rubs {
            self.load_friction(system, at, a);
        }
        let usual = system.description().phases.get(system.phase()).map_or(0, |phase| phase.rank as usize);
        let held = system.row_history().map_or(&[][..], |history| &history.multipliers);
        let held = if self.rank < usual { held } else { &[] };
        substitute_forward(&self.mass, a);
        self.hold(held, rubs, a);
        let mut found = std::mem::take(&mut self.found);
        for (k, right) in found.iter_mut().enumerate() {
            *right = -self.gamma[k] - weighted(&self.mass, &self.half[k * n..][..n], a);
        }
        let solved = if rubs {
            self.rub(&mut found)
        } else {
            self.cholesky_solve(&mut found);
            Ok(())
        };
        let lines = if rubs { &self.pushed } else { &self.half };
        for (k, lambda) in found.iter().enumerate() {
            add(a, *lambda, &lines[k * n..][..n]);
        }
        substitute_back(&self.mass, a);
        lambda.fill(0.0);
        for (k, row) in self.active.iter().enumerate() {
            lambda[*row] = found[k] + self.strength[k] * self.gamma[k];
        }
        for row in self.order[self.rank..].iter().map(|k| self.active[*k]) {
            lambda[row] += held.get(row).copied().unwrap_or(0.0);
        }
        self.found = found;
        solved
    }

    /// The accelerations by the null space of J, and the multipliers that go with them; dense, for comparison only.
    ///
    /// # Errors
    /// M singular on the motions that the constraints leave.
    pub fn by_null_space<S: System + ?Sized>(
        &mut self,
        system: &S,
        at: At<'_>,
        alpha: f64,
        a: &mut [f64],
        lambda: &mut [f64],
    ) -> Result<(), Singular> {
        let n = system.len();
        self.begin(system, n);
        self.load_rows(system, at);
        self.load_mass(system, at);
        system.bias(at, &mut self.h);
        self.load_gamma(system, at, alpha, lambda);
        let rows = DMatrix::from_row_slice(self.active.len(), n, &self.rows);
        let right: Vec<f64> = self.gamma.iter().map(|gamma| -gamma).collect();
        let Solutions { particular, basis, independent, pivots } = Solutions::of(&rows, &right);
        let mass = DMatrix::from_fn(n, n, |i, j| self.mass[packed(i, j)]);
        let h = DVector::from_column_slice(&self.h);
        let reduced = basis.tr_mul(&mass) * &basis;
        let force = -basis.tr_mul(&(&mass * &particular + &h));
        let nothing = || SingularMass { coordinate: independent.first().copied().unwrap_or(0) };
        let free = reduced.cholesky().ok_or_else(nothing)?.solve(&force);
        let found = particular + basis * free;
        a.copy_from_slice(found.as_slice());
        // λ from the pivots' coordinates, where their rows are independent.
        let left = mass * found + h;
        let count = pivots.len();
        let transposed = DMatrix::from_fn(count, count, |i, k| rows[(pivots[k].0, pivots[i].1)]);
        let carried = DVector::from_fn(count, |i, _| left[pivots[i].1]);
        lambda.fill(0.0);
        if let Some(solved) = transposed.lu().solve(&carried) {
            pivots.iter().zip(solved.iter()).for_each(|((row, _), x)| lambda[self.active[*row]] = *x);
        }
        Ok(())
    }

    /// The accelerations with springs and dampers in the place of constraints, λ = −(k c + d c').
    ///
    /// # Errors
    /// M singular: what has no inertia of its own is held by constraints only.
    pub fn by_springs<S: System + ?Sized>(
        &mut self,
        system: &S,
        at: At<'_>,
        (stiffness, damping): (f64, f64),
        a: &mut [f64],
        lambda: &mut [f64],
    ) -> Result<(), Singular> {
        let n = system.len();
        self.begin(system, n);
        self.load_rows(system, at);
        self.load_mass(system, at);
        factor_packed(&mut self.mass, n)?;
        system.bias(at, &mut self.h);
        a.iter_mut().zip(&self.h).for_each(|(a, h)| *a = -h);
        let mut triples = vec![0.0; 3 * system.description().rows.len()];
        system.constraints(at, &mut triples);
        lambda.fill(0.0);
        for (k, &row) in self.active.iter().enumerate() {
            let c = if system.description().rows[row].holonomic { triples[3 * row] } else { 0.0 };
            lambda[row] = -(stiffness * c + damping * triples[3 * row + 1]);
            add(a, lambda[row], &self.rows[k * n..][..n]);
        }
        let pattern = &system.description().friction_pattern;
        self.values.resize(pattern.len(), 0.0);
        system.friction(at, &mut self.values);
        for ((coordinate, row), value) in pattern.iter().zip(&self.values) {
            a[*coordinate as usize] += value * lambda[*row as usize];
        }
        substitute_forward(&self.mass, a);
        substitute_back(&self.mass, a);
        Ok(())
    }

    /// Takes note of the rows in force, and makes room.
    fn begin<S: System + ?Sized>(&mut self, system: &S, n: usize) {
        self.n = n;
        self.active.clear();
        self.active.extend(system.active_rows().iter().map(|row| *row as usize));
        let m = self.active.len();
        for (list, size) in
            [(&mut self.mass, n * (n + 1) / 2), (&mut self.rows, m * n), (&mut self.gamma, m), (&mut self.h, n)]
        {
            list.resize(size, 0.0);
        }
    }

    /// γ of the rows in force, with what brings back constraints that are missed; `room` is for all rows.
    fn load_gamma<S: System + ?Sized>(&mut self, system: &S, at: At<'_>, alpha: f64, room: &mut [f64]) {
        system.constraint_bias(at, room);
        for (gamma, row) in self.gamma.iter_mut().zip(&self.active) {
            *gamma = room[*row];
        }
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

    /// Makes the multipliers of the active rows the least of all that have the same effect, Σ S_kk λ_k², where rows
    /// depend on each other everywhere (Udwadia and Kalaba, Analytical Dynamics, 1992; the weights are invariant under a
    /// scaling of rows).
    pub fn spread<S: System + ?Sized>(&self, system: &S, lambda: &mut [f64]) {
        let (m, rank) = (self.active.len(), self.rank);
        let usual = system.description().phases.get(system.phase()).map_or(0, |phase| phase.rank as usize);
        if rank == m || rank < usual || !system.description().friction_pattern.is_empty() {
            return;
        }
        // Row i of L that is left out is a combination of those that were kept: u = [−L₁⁻ᵀ L_iᵀ; e_i] has no effect.
        let factor = DMatrix::from_fn(rank, rank, |i, j| if i >= j { self.schur[i * m + j] } else { 0.0 });
        let beyond = DMatrix::from_fn(rank, m - rank, |j, i| self.schur[(rank + i) * m + j]);
        let Some(combined) = factor.tr_solve_lower_triangular(&beyond) else { return };
        let idle = DMatrix::from_fn(m, m - rank, |i, k| match i.checked_sub(rank) {
            None => -combined[(i, k)],
            Some(place) => f64::from(place == k),
        });
        let scaled = DVector::from_fn(m, |i, _| lambda[self.active[self.order[i]]] * self.norms[self.order[i]]);
        let Some(inverse) = idle.tr_mul(&idle).cholesky() else { return };
        let least = &scaled - &idle * inverse.solve(&idle.tr_mul(&scaled));
        for (x, &k) in least.iter().zip(&self.order) {
            lambda[self.active[k]] = if self.norms[k] > 0.0 { x / self.norms[k] } else { 0.0 };
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
        let pattern = &system.description().mass_pattern;
        self.values.resize(pattern.len(), 0.0);
        system.mass_matrix(at, &mut self.values);
        self.mass.fill(0.0);
        for ((row, column), value) in pattern.iter().zip(&self.values) {
            self.mass[packed(*row as usize, *column as usize)] = *value;
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
            self.strength[k] = if by_mass > 0.0 {
                1.0 / by_mass
            } else if size > 0.0 {
                largest / size
            } else {
                0.0
            };
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

    /// Pivoted Cholesky of S, scaled; the pivots of some rows are chosen last.
    fn choose_rows(&mut self, before: &[f64], last: &[usize]) {
        let (n, m) = (self.n, self.active.len());
        for k in 0..m {
            for l in 0..=k {
                let s = weighted(&self.mass, &self.half[k * n..][..n], &self.half[l * n..][..n]);
                self.schur[k * m + l] = s;
                self.schur[l * m + k] = s;
            }
            let largest = before.get(self.active[k]).copied().unwrap_or(0.0);
            self.norms[k] = largest.max(self.schur[k * m + k].max(0.0).sqrt());
        }
        let scale = |k: usize| if self.norms[k] > 0.0 { 1.0 / self.norms[k] } else { 0.0 };
        for k in 0..m {
            for l in 0..m {
                self.schur[k * m + l] *= scale(k) * scale(l);
            }
        }
        self.order.clear();
        self.order.extend(0..m);
        let weak = WEAK * (MANY / m.max(1) as f64).min(1.0);
        (self.rank, self.weakest) = (m, 1.0);
        for k in 0..m {
            let size = |place: usize| self.schur[place * m + place].max(0.0).sqrt();
            let waits = |place: usize| size(place) <= weak || last.contains(&self.active[self.order[place]]);
            let rated = |place: usize| (!waits(place), size(place));
            let better = |a: &usize, b: &usize| {
                let (a, b) = (rated(*a), rated(*b));
                a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
            };
            let best = (k..m).max_by(better).unwrap_or(k);
            let size = size(best);
            self.weakest = self.weakest.min(size);
            if size.is_nan() || size <= weak {
                self.rank = k;
                break;
            }
            exchange(&mut self.schur, m, k, best);
            self.order.swap(k, best);
            let reciprocal = 1.0 / size;
            self.schur[k * m + k] = size;
            for i in k + 1..m {
                self.schur[i * m + k] *= reciprocal;
            }
            for i in k + 1..m {
                let factor = self.schur[i * m + k];
                for j in k + 1..=i {
                    let change = factor * self.schur[j * m + k];
                    self.schur[i * m + j] -= change;
                    if i != j {
                        self.schur[j * m + i] = self.schur[i * m + j];
                    }
                }
            }
        }
    }

    /// S x = b with the rows that were kept, in place.
    fn cholesky_solve(&mut self, b: &mut [f64]) {
        let m = b.len();
        let (rank, y) = (self.rank, &mut self.right);
        for (i, &row) in self.order[..rank].iter().enumerate() {
            let known: f64 = (0..i).map(|j| self.schur[i * m + j] * y[j]).sum();
            y[i] = (b[row] / self.norms[row] - known) / self.schur[i * m + i];
        }
        for i in (0..rank).rev() {
            let known: f64 = (i + 1..rank).map(|j| self.schur[j * m + i] * y[j]).sum();
            y[i] = (y[i] - known) / self.schur[i * m + i];
        }
        b.fill(0.0);
        for (y, &row) in y.iter().zip(&self.order[..rank]) {
            b[row] = y / self.norms[row];
        }
    }

    /// J M⁻¹ (Jᵀ + B) x = b with the rows that were kept, in their order: every pivot must stay beside that without
    /// friction.
    fn rub(&mut self, b: &mut [f64]) -> Result<(), Singular> {
        let (n, m, rank) = (self.n, self.active.len(), self.rank);
        self.rubbed.clear();
        for &k in &self.order[..rank] {
            for &l in &self.order[..rank] {
                let s = weighted(&self.mass, &self.half[k * n..][..n], &self.pushed[l * n..][..n]);
                self.rubbed.push(s / (self.norms[k] * self.norms[l]));
            }
        }
        let x = &mut self.right;
        for (i, &row) in self.order[..rank].iter().enumerate() {
            x[i] = b[row] / self.norms[row];
        }
        for i in 0..rank {
            let (pivot, without) = (self.rubbed[i * rank + i], self.schur[i * m + i].powi(2));
            if pivot.is_nan() || pivot <= PAINLEVE * without {
                b.fill(0.0);
                return Err(Singular::Friction { row: self.active[self.order[i]] });
            }
            for k in i + 1..rank {
                let factor = self.rubbed[k * rank + i] / pivot;
                for l in i + 1..rank {
                    self.rubbed[k * rank + l] -= factor * self.rubbed[i * rank + l];
                }
                x[k] -= factor * x[i];
            }
        }
        for i in (0..rank).rev() {
            let known: f64 = (i + 1..rank).map(|k| self.rubbed[i * rank + k] * x[k]).sum();
            x[i] = (x[i] - known) / self.rubbed[i * rank + i];
        }
        b.fill(0.0);
        for (i, &row) in self.order[..rank].iter().enumerate() {
            b[row] = x[i] / self.norms[row];
        }
        Ok(())
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

/// Exchanges two rows and columns of a symmetric matrix, and what is factored already of their rows.
fn exchange(matrix: &mut [f64], m: usize, k: usize, l: usize) {
    if k != l {
        (0..m).for_each(|c| matrix.swap(k * m + c, l * m + c));
        (0..m).for_each(|r| matrix.swap(r * m + k, r * m + l));
    }
}
