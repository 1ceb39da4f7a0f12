//! States brought back to the constraints.

use nalgebra::{DMatrix, DVector};

use crate::matrix::svd;
use crate::mechanism::dense::{self, constraint_matrix, sizes_alike};
use crate::mechanism::{At, KktSolver, Singular, System, rows_in_force};

/// Brings states back to the constraints that are active, by the least change in the metric of M.
///
/// Positions first, K [δ; μ] = [0; −c], then speeds, K [δ; μ] = [0; −c'], which is linear and exact at once
/// (Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.4).
#[derive(Clone, Debug)]
pub(crate) struct Projection {
    form: KktSolver,
    /// Whether states are changed, or only looked at.
    corrects: bool,
    /// (c, c', Σ |terms| of c) of all rows.
    triples: Vec<f64>,
    /// The values at which integrals of velocity constraints are held, row by row.
    levels: Vec<Option<f64>>,
    delta: Vec<f64>,
    right: Vec<f64>,
    norms: Vec<f64>,
    /// The largest sizes of the entries of J, row by row.
    entries: Vec<f64>,
    /// The largest Σ |terms| that each row has had: where it vanishes its terms may too.
    scales: Vec<f64>,
    /// The largest speeds so far.
    fastest: Vec<f64>,
    last: Residuals,
    worst: Residuals,
    /// What rounding of constraints makes of [q; q'].
    constraint_round_off: Vec<f64>,
    /// The last state, if it was near a singular position.
    before: Option<Near>,
}

/// A state near a singular position.
#[derive(Clone, Debug)]
struct Near {
    /// Rows that are independent.
    rows: Vec<usize>,
    t: f64,
    q: Vec<f64>,
}

/// How far a motion is from its constraints, in their own units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residuals {
    /// The largest |c| of a holonomic constraint, or change of an integral that is held.
    pub position: f64,
    /// The largest |c'|, or |c| of a constraint that contains speeds.
    pub velocity: f64,
}

/// Rounding of a constraint beside the sum of its terms.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// A constraint that is missed by this part of its terms is not kept.
const LOST: f64 = 1e-6;
/// So many roundings are more than those of a method that met all rows.
const LEFT_OUT: f64 = 1e5;
/// Corrections of positions at most; a chord iteration gains some four digits each.
const ITERATIONS: usize = 8;
/// Rows further than this from depending on each other determine a state to its own rounding.
const NEARLY_SINGULAR: f64 = 0.1;
/// Steps from closer than this to a singular position may lead across it.
const NEAR: f64 = 0.3;
/// Halvings with which a singular position is looked for between two states: rows are linear in places so near to each other.
const HALVES: u32 = 20;
/// At a singular position rows are nearer to depending on each other by this factor at least: the way to it and from it is some steps long.
const DEPENDENT: f64 = 0.25;
/// A correction that leaves more than this of the residual calls for new matrices, or does not help at all.
const SLOW: f64 = 0.3;

/// The least singular value of so many rows in these units that are as independent as they can be; 0 of none.
fn least(mut rows: DMatrix<f64>, units: &[f64], count: usize) -> f64 {
    rows.row_iter_mut().zip(units).filter(|(_, unit)| **unit > 0.0).for_each(|(mut row, unit)| row.unscale_mut(*unit));
    // Falling.
    svd(rows, false, false).and_then(|svd| svd.singular_values.get(count.checked_sub(1)?).copied()).unwrap_or(0.0)
}

impl Projection {
    /// Room for a mechanism; `None` for one without constraints.
    pub fn new<S: System + ?Sized>(system: &S) -> Option<Self> {
        let rows = system.description().rows.len();
        (rows > 0).then(|| Projection {
            form: KktSolver::default(),
            corrects: true,
            triples: vec![0.0; 3 * rows],
            levels: vec![None; rows],
            delta: vec![0.0; system.len()],
            right: Vec::with_capacity(rows),
            norms: vec![0.0; rows],
            entries: vec![0.0; rows * system.len()],
            scales: vec![0.0; rows],
            fastest: vec![0.0; system.len()],
            last: Residuals::default(),
            worst: Residuals::default(),
            constraint_round_off: vec![0.0; 2 * system.len()],
            before: None,
        })
    }

    /// Changes no state, only measures how far each is from the constraints.
    pub fn only_looking(mut self, looks: bool) -> Self {
        self.corrects = !looks;
        self
    }

    /// Brings y = [q; q'] to the constraints; false where none is active.
    ///
    /// # Errors
    /// Coordinates to which neither M nor a constraint gives any inertia.
    pub fn project<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &mut [f64]) -> Result<bool, Singular> {
        if system.active_rows().is_empty() {
            return Ok(false);
        }
        if !self.corrects {
            self.evaluate(system, t, y);
            self.note(system);
            return Ok(false);
        }
        let n = system.len();
        let mut before = f64::INFINITY;
        let mut fresh = false;
        for _ in 0..ITERATIONS {
            self.evaluate(system, t, y);
            let distance = self.distance(system);
            if distance <= 1.0 || !distance.is_finite() || (fresh && distance > SLOW * before) {
                break;
            }
            fresh = before.is_infinite() || distance > SLOW * before;
            if fresh {
                self.form.factor(system, At::packed(t, y, n))?;
            }
            before = distance;
            self.solve(|projection, row| -projection.off(system, row).unwrap_or(0.0));
            y.iter_mut().zip(&self.delta).for_each(|(q, delta)| *q += delta);
        }
        self.project_speeds(system, t, y)?;
        Ok(true)
    }

    /// Brings the speeds of y = [q; q'] to the constraints where its coordinates are.
    ///
    /// # Errors
    /// As [`Projection::project`].
    pub fn project_speeds<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &mut [f64]) -> Result<(), Singular> {
        let n = system.len();
        self.factor(system, At::packed(t, y, n))?;
        system.constraints(At::packed(t, y, n), &mut self.triples);
        self.solve(|projection, row| -projection.triples[3 * row + 1]);
        y[n..].iter_mut().zip(&self.delta).for_each(|(v, delta)| *v += delta);
        system.constraints(At::packed(t, y, n), &mut self.triples);
        self.note(system);
        Ok(())
    }

    /// Measures how far a state is from the constraints that are active, and how independent they are there, of a method that
    /// ends on them by itself; brings it back only where rows that it left out near a singular position were missed.
    ///
    /// # Errors
    /// As [`Projection::project`].
    pub fn look<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &mut [f64]) -> Result<bool, Singular> {
        if system.active_rows().is_empty() {
            return Ok(false);
        }
        self.evaluate(system, t, y);
        if self.corrects {
            if self.distance(system) > LEFT_OUT {
                return self.project(system, t, y);
            }
            self.factor(system, At::packed(t, y, system.len()))?;
        }
        self.note(system);
        Ok(false)
    }

    /// Factors M and J at a place, and notes how large the rows are.
    fn factor<S: System + ?Sized>(&mut self, system: &S, place: At<'_>) -> Result<(), Singular> {
        self.form.factor(system, place)?;
        let n = system.len();
        for ((row, norm), entries) in self.form.active().iter().zip(self.form.norms()).zip(self.form.entries()) {
            self.norms[*row] = self.norms[*row].max(*norm);
            let largest = self.entries[row * n..][..n].iter_mut();
            largest.zip(entries).for_each(|(largest, entry)| *largest = largest.max(entry.abs()));
        }
        Ok(())
    }

    /// Holds no integrals any more: the state is not what it was.
    pub fn release(&mut self) {
        self.levels.fill(None);
    }

    /// From here on integrals of velocity constraints that act have the values that they have at this state.
    pub fn hold<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        let rows = &system.description().rows;
        if !rows.iter().any(|row| row.integral) {
            return;
        }
        self.observe(system, t, y);
        self.levels.fill(None);
        for row in rows_in_force(system).filter(|row| rows[*row].integral) {
            self.levels[row] = Some(self.triples[3 * row]);
        }
    }

    /// How far the positions that were evaluated last are from a row; none of one that holds none.
    fn off<S: System + ?Sized>(&self, system: &S, row: usize) -> Option<f64> {
        let c = self.triples[3 * row];
        match system.description().rows[row].holonomic {
            true => Some(c),
            false => self.levels[row].map(|level| c - level),
        }
    }

    /// Evaluates all rows at a state.
    fn evaluate<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        system.constraints(At::packed(t, y, system.len()), &mut self.triples);
    }

    /// Evaluates all rows at a state of the motion, and notes how large their terms are.
    pub fn observe<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        self.evaluate(system, t, y);
        self.keep();
        self.fastest.iter_mut().zip(&y[system.len()..]).for_each(|(most, v)| *most = most.max(v.abs()));
    }

    /// Notes how large the terms of all rows are at the state that was evaluated last: it is one of the motion.  The end of a step that was
    /// tried may be far from it.
    pub fn keep(&mut self) {
        for (scale, triple) in self.scales.iter_mut().zip(self.triples.chunks_exact(3)) {
            *scale = scale.max(triple[2]);
        }
    }

    /// The largest Σ |terms| that each row has had.
    pub fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// The same of one row, with the state that was evaluated last.
    fn scale(&self, row: usize) -> f64 {
        self.scales[row].max(self.triples[3 * row + 2])
    }

    /// Whether a holonomic row does not hold at the state that was evaluated last, and by how much it is missed.
    pub fn misses(&self, row: usize) -> Option<f64> {
        let c = self.triples[3 * row];
        (c.is_nan() || c.abs() > LOST * self.scale(row)).then_some(c)
    }

    /// The rows that are nearest to depending on others at the state that was projected last, where `usual` of them are
    /// independent elsewhere.
    pub fn nearly_dependent_rows(&self, usual: usize) -> Vec<usize> {
        if self.is_nearly_singular() { self.form.chosen_after(usual.saturating_sub(1)) } else { Vec::new() }
    }

    /// Whether so many rows are clearly independent at the state that was projected last.
    pub fn has_independent(&self, count: usize) -> bool {
        !self.corrects || self.form.are_independent(count)
    }

    /// Whether rounding of the constraints shows at the state that was projected last.
    pub fn is_nearly_singular(&self) -> bool {
        self.corrects && self.form.weakest() <= NEARLY_SINGULAR
    }

    /// Whether a singular position lies between the state that was projected last and the one before: there a minor of J changes its sign, and where
    /// it does on the way the rows depend on each other far more than at either end.  `usual` rows are independent elsewhere.
    pub fn passed<S: System + ?Sized>(&mut self, system: &S, place: At<'_>, usual: usize) -> bool {
        let near = self.corrects && self.form.rank() >= usual && self.form.weakest() <= NEAR;
        let here = near.then(|| Near { rows: self.form.chosen_first(usual), t: place.t, q: place.q.to_vec() });
        let Some(before) = std::mem::replace(&mut self.before, here) else { return false };
        let rows_on_the_way = |part: f64, rows: &[usize]| {
            let q: Vec<f64> = before.q.iter().zip(place.q).map(|(from, to)| from + part * (to - from)).collect();
            constraint_matrix(system, At::place(before.t + part * (place.t - before.t), &q), rows)
        };
        let on_the_way = |part: f64| rows_on_the_way(part, &before.rows);
        let [from, to] = [0.0, 1.0].map(on_the_way);
        let mut columns = DMatrix::from_fn(1, system.len(), |_, j| j);
        from.clone().col_piv_qr().p().permute_columns(&mut columns);
        let minor = |j: &DMatrix<f64>| j.select_columns(columns.iter().take(before.rows.len())).determinant();
        if minor(&from) * minor(&to) >= 0.0 {
            return false;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVES {
            let middle = 0.5 * (low + high);
            if minor(&from) * minor(&on_the_way(middle)) > 0.0 { low = middle } else { high = middle }
        }
        // A row may vanish by itself. Where some depend on each other on the way, others may be as independent as ever.
        let all: Vec<usize> = rows_in_force(system).collect();
        let [from, there, to] = [0.0, high, 1.0].map(|part| rows_on_the_way(part, &all));
        let units: Vec<f64> = from.row_iter().zip(to.row_iter()).map(|(from, to)| from.norm().max(to.norm())).collect();
        let [from, there, to] = [from, there, to].map(|rows| least(rows, &units, usual));
        there < DEPENDENT * from.min(to)
    }

    /// What rounding of c makes of q, and that in turn of q', at the state that was projected last.
    ///
    /// Near a singular position, σ from it, q is open to some ε/σ and q' to ε/σ².
    pub fn constraint_round_off<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) -> &[f64] {
        let n = system.len();
        self.constraint_round_off.fill(0.0);
        let (mut moved, mut before) = (y.to_vec(), self.triples.clone());
        system.constraints(At::packed(t, y, n), &mut before);
        for k in 0..self.form.active().len() {
            let row = self.form.active()[k];
            self.solve(|projection, other| if other == row { f64::EPSILON * projection.scale(row) } else { 0.0 });
            for i in 0..n {
                moved[i] = y[i] + self.delta[i];
                self.constraint_round_off[i] = self.constraint_round_off[i].max(self.delta[i].abs());
            }
            system.constraints(At::packed(t, &moved, n), &mut self.triples);
            self.solve(|projection, other| projection.triples[3 * other + 1] - before[3 * other + 1]);
            for i in 0..n {
                self.constraint_round_off[n + i] = self.constraint_round_off[n + i].max(self.delta[i].abs());
            }
        }
        self.triples = before;
        &self.constraint_round_off
    }

    /// The largest norms that the rows have had.
    pub fn norms(&self) -> &[f64] {
        &self.norms
    }

    /// The largest sizes that the entries of J have had, row by row.
    pub fn entries(&self) -> &[f64] {
        &self.entries
    }

    /// The largest residuals there were after projecting.
    pub fn worst(&self) -> Residuals {
        self.worst
    }

    /// How many of the active rows are independent at the last state, and how far they are from depending on each other.
    pub fn rank(&self) -> (usize, f64) {
        if self.corrects { (self.form.rank(), self.form.weakest()) } else { (usize::MAX, 1.0) }
    }

    /// The active row that the last state misses by far more than rounding and what its rate makes of `late` seconds, and by how
    /// much; none where nothing brings states back.
    pub fn lost<S: System + ?Sized>(&self, system: &S, place: At<'_>, late: f64) -> Option<(usize, f64)> {
        if !self.corrects {
            return None;
        }
        // Where all terms of a row are zero but for rounding, that of the coordinates and of the time tells how far off it may be, at the largest speeds
        // there were: what has come to rest has none.
        let is_rounding = |row: usize, c: f64| {
            let sizes = DVector::from_vec(sizes_alike(system.description(), place.q));
            let fastest = self.fastest.iter().zip(place.v).map(|(most, v)| most.max(v.abs()));
            let ways = DVector::from_iterator(place.v.len(), fastest.map(|v| (v * place.t).abs()));
            let moved = constraint_matrix(system, place, &[row]).abs() * (dense::ROUNDING * sizes + ROUNDING * ways);
            c.abs() <= moved[0]
        };
        let mut active = rows_in_force(system);
        active.find_map(|row| {
            let moved = 2.0 * late * self.triples[3 * row + 1].abs();
            let missed = self
                .misses(row)
                .filter(|c| system.description().rows[row].holonomic && (c.is_nan() || c.abs() > moved))
                .filter(|c| !is_rounding(row, *c));
            missed.map(|c| (row, c))
        })
    }

    /// The largest residual of a position in units of its rounding.
    fn distance<S: System + ?Sized>(&self, system: &S) -> f64 {
        let active = rows_in_force(system);
        let share = |row: usize| {
            let (c, scale) = (self.off(system, row).unwrap_or(0.0).abs(), self.scale(row));
            if c == 0.0 { 0.0 } else { c / (ROUNDING * scale) }
        };
        active.map(share).fold(0.0, |most: f64, share| if share.is_nan() { f64::NAN } else { most.max(share) })
    }

    /// δ of K [δ; μ] = [0; g].
    fn solve(&mut self, g: impl Fn(&Self, usize) -> f64) {
        let mut right = std::mem::take(&mut self.right);
        right.clear();
        right.extend(self.form.active().iter().map(|row| g(self, *row)));
        self.delta.fill(0.0);
        self.form.solve(&mut self.delta, &mut right);
        self.right = right;
    }

    fn note<S: System + ?Sized>(&mut self, system: &S) {
        self.last = Residuals::default();
        for row in rows_in_force(system) {
            if let Some(off) = self.off(system, row) {
                self.last.position = self.last.position.max(off.abs());
            }
            self.last.velocity = self.last.velocity.max(self.triples[3 * row + 1].abs());
        }
        self.worst.position = self.worst.position.max(self.last.position);
        self.worst.velocity = self.worst.velocity.max(self.last.velocity);
    }
}
