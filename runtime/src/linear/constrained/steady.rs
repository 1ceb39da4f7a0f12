//! Steady motions along constraints: which coordinates can go on at constant rates, and at which together.
//!
//! Shifts s that change nothing leave the equations of motion F and the accelerations of the rows as they are:
//! (∂F/∂q) s = 0 and (∂(J a + γ)/∂q) s = 0 at all states, with any accelerations and multipliers.  These are cyclic
//! coordinates, and directions in which several coordinates are shifted together.  A motion is steady whose speeds v are
//! such a shift and meet the constraints, J v + ∂c/∂t = 0, with F(q, v, 0, λ) = 0.  J v is then the same at all places near
//! by, ∂(J v)/∂q = 0, so that departures ξ in the independent coordinates have speeds Z ξ': M_z, C_z and K_z are those of
//! `rest.rs` at these speeds.

#[cfg(any(feature = "modal", feature = "cli"))]
use nalgebra::DVectorView;
use nalgebra::{DMatrix, DVector};

use super::state::{ConstrainedState, State};
#[cfg(feature = "modal")]
use super::turns::Symmetries;
use crate::linear::equilibrium::LinearisationPoint;
use crate::linear::matrices::natural_sizes;
use crate::linear::{Guess, LinearError};
use crate::matrix::{equilibrated, solve_least, svd};
use crate::mechanism::dense::{constraint_matrix, constraint_slopes, constraint_triples, force_slopes};
use crate::mechanism::{At, System, rows_in_force};

/// States at which equations are asked what they depend on, and so many of them must be defined.
pub(super) const STATES: usize = 6;
pub(super) const DEFINED: usize = 3;
/// How far they are apart, as a part of the coordinates' sizes.
const APART: f64 = 0.3;
/// Slopes below this part of the largest of their row are rounding.
const ROUNDING: f64 = 1e-12;
/// Singular values below this part of the largest are 0.
pub(super) const NULL: f64 = 1e-9;
/// Elements of a shift below this part of its largest are rounding.
pub(super) const PART: f64 = 1e-9;
/// Speeds below this part of those with their unit are rounding.
const REST: f64 = 1e-14;
/// Speeds may be missed by this part of them, constraints by this part of their terms.
const MISSED: f64 = 1e-9;
/// How far a motion has gone when it is looked at again, in sizes of its coordinates.
const LATER: [f64; 3] = [0.37, 1.9, 13.0];
/// What changes by less than this part of itself is the same.
const SAME: f64 = 1e-9;

/// The coordinates that can go on at a constant rate, alone or together with others: nothing depends on their values.
///
/// They are asked for near the place of the guess, discontinuities on their sides there.
///
/// # Errors
/// Those of a singular value decomposition; numbers that are not finite.
pub fn steady_coordinates<S: System + ?Sized>(system: &S, guess: &Guess) -> Result<Vec<usize>, LinearError> {
    let probe = LinearisationPoint::new(system, guess);
    probe.sides_at(&guess.q);
    let rows: Vec<usize> = rows_in_force(system).collect();
    let system = probe.system.borrow();
    let shifts = ConstrainedState::new(&**system, &rows, &guess.q).shifts(&guess.q)?;
    Ok(shifts.coordinates())
}

/// Those of them that can go on each by itself: cyclic coordinates, and such on whose values nothing depends though forces act along them.
#[cfg(feature = "cli")]
pub(crate) fn lone_steady_coordinates<S: System + ?Sized>(
    system: &S,
    guess: &Guess,
) -> Result<Vec<usize>, LinearError> {
    let probe = LinearisationPoint::new(system, guess);
    probe.sides_at(&guess.q);
    let rows: Vec<usize> = rows_in_force(system).collect();
    let system = probe.system.borrow();
    Ok(ConstrainedState::new(&**system, &rows, &guess.q).shifts(&guess.q)?.alone())
}

/// As [`steady_coordinates`], with those that turn as a whole beside them: the heading of what rolls on a plane, and its place.
///
/// # Errors
/// As [`steady_coordinates`].
#[cfg(feature = "modal")]
pub fn turning_coordinates<S: System + ?Sized>(system: &S, guess: &Guess) -> Result<Vec<usize>, LinearError> {
    let probe = LinearisationPoint::new(system, guess);
    probe.sides_at(&guess.q);
    let rows: Vec<usize> = rows_in_force(system).collect();
    let system = probe.system.borrow();
    let held = ConstrainedState::new(&**system, &rows, &guess.q);
    let shifts = held.shifts(&guess.q)?;
    let turns = held.turns(&guess.q, &shifts)?;
    Ok(Symmetries { shifts, turns }.coordinates())
}

/// A basis of shifts that change nothing, in columns.
#[derive(Clone)]
pub(super) struct Shifts(pub DMatrix<f64>);

/// A state at which all terms matter: a place near another one, speeds, accelerations and multipliers.
pub(super) struct Draw {
    pub place: Vec<f64>,
    pub v: Vec<f64>,
    pub a: Vec<f64>,
    pub lambda: Vec<f64>,
}

impl Shifts {
    /// Nothing goes on.
    #[cfg(feature = "modal")]
    pub fn none(n: usize) -> Shifts {
        Shifts(DMatrix::zeros(n, 0))
    }

    /// The coordinates that can be shifted alone.
    #[cfg(any(feature = "modal", feature = "cli"))]
    pub fn alone(&self) -> Vec<usize> {
        let single = |shift: DVectorView<'_, f64>| {
            let mut moved = (0..shift.len()).filter(|i| shift[*i] != 0.0);
            moved.next().filter(|_| moved.next().is_none())
        };
        self.0.column_iter().filter_map(|shift| single(shift.as_view())).collect()
    }

    /// Whether they move every coordinate that has a speed (not 0).
    #[cfg(feature = "modal")]
    pub fn reach(&self, v: &[f64]) -> bool {
        let free = self.coordinates();
        (0..v.len()).all(|i| v[i] == 0.0 || free.contains(&i))
    }

    /// The coordinates that some of them move.
    pub fn coordinates(&self) -> Vec<usize> {
        (0..self.0.nrows()).filter(|i| self.0.row(*i).iter().any(|x| *x != 0.0)).collect()
    }
}

impl<S: System + ?Sized> ConstrainedState<'_, S> {
    /// The shifts that change nothing near a place.
    ///
    /// # Errors
    /// As [`steady_coordinates`].
    pub fn shifts(&self, q: &[f64]) -> Result<Shifts, LinearError> {
        let (n, m) = (self.n, self.rows.len());
        let sizes = natural_sizes(&self.units(), q);
        let mut all = DMatrix::zeros(0, n);
        let mut defined = 0;
        for k in 0..2 * STATES {
            let Some(slopes) = self.dependence(q, &sizes, k) else { continue };
            let filled = all.nrows();
            all = all.resize_vertically(filled + n + m, 0.0);
            all.view_mut((filled, 0), (n + m, n)).copy_from(&slopes);
            defined += 1;
            if defined == STATES {
                break;
            }
        }
        if defined < DEFINED {
            return Err(LinearError::NonFinite { what: "an equation near the steady motion".to_owned() });
        }
        let failed = LinearError::NoConvergence { what: "the search for coordinates that go on steadily" };
        // What no row contains is free by itself; the others as parts of their sizes.
        let moved: Vec<usize> = (0..n).filter(|j| all.column(*j).iter().any(|x| *x != 0.0)).collect();
        if moved.is_empty() {
            return Ok(Shifts(DMatrix::identity(n, n)));
        }
        let (scaled, _, columns) = equilibrated(&all.select_columns(&moved));
        // R of Q R has the singular values of all rows together.
        let svd = svd(scaled.qr().r(), false, true).ok_or_else(|| failed.clone())?;
        let largest = svd.singular_values.max();
        let null: Vec<usize> = (0..moved.len()).filter(|k| svd.singular_values[*k] <= NULL * largest).collect();
        let v_t = svd.v_t.ok_or(failed)?.select_rows(&null);
        let mut basis: Vec<DVector<f64>> = Vec::new();
        for j in (0..n).filter(|j| !moved.contains(j)) {
            basis.push(DVector::from_fn(n, |i, _| f64::from(u8::from(i == j))));
        }
        for row in reduced(v_t).row_iter() {
            let mut shift = DVector::zeros(n);
            for (place, i) in moved.iter().enumerate() {
                shift[*i] = row[place] * columns[place];
            }
            basis.push(shift);
        }
        Ok(Shifts(if basis.is_empty() { DMatrix::zeros(n, 0) } else { DMatrix::from_columns(&basis) }))
    }

    /// A state near a place at which all terms matter; `None` where they are not defined.
    pub fn draw(&self, q: &[f64], sizes: &[f64], k: usize) -> Option<Draw> {
        let n = self.n;
        // Nearer by where equations are not defined.
        let apart = APART * 0.5_f64.powi((k / STATES) as i32 * 4);
        // Any numbers in −1 … 1, the same in every run.
        let drawn = |i: usize, of: usize| (1.7 * i as f64 + 2.3 * k as f64 + 0.9 * of as f64 + 0.4).sin();
        let vector = |size: f64, of: usize| (0..n).map(|i| size * sizes[i] * drawn(i, of)).collect::<Vec<f64>>();
        let place: Vec<f64> = q.iter().zip(vector(apart, 0)).map(|(q, far)| q + far).collect();
        let zero = vec![0.0; n];
        let mut force = zero.clone();
        self.system.residual(At::new(0.0, &place, &zero).accelerated(&zero), &mut force);
        let jacobian = constraint_matrix(self.system, At::new(0.0, &place, &zero), &self.rows);
        if force.iter().chain(jacobian.iter()).any(|x| !x.is_finite()) {
            return None;
        }
        let rest = self.state(&place, &zero);
        // Speeds at which inertia is as large as other forces, multipliers at which constraints are.
        let energy = |matrix: &DMatrix<f64>| {
            let entries = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            entries.fold(0.0_f64, |most, (i, j)| most.max(matrix[(i, j)].abs() * sizes[i] * sizes[j]))
        };
        let still = self.slopes(&rest);
        let (inertia, stiffness) = (energy(&self.mass(&rest)), energy(&still.view((0, 0), (n, n)).into_owned()));
        let or_one = |x: f64| if x > 0.0 && x.is_finite() { x } else { 1.0 };
        let rate = or_one((stiffness / inertia).sqrt());
        let work = or_one(if stiffness > 0.0 { stiffness } else { inertia });
        let (v, a) = (vector(rate, 1), vector(rate * rate, 2));
        let mut lambda = vec![0.0; self.system.description().rows.len()];
        for (row, k) in self.rows.iter().enumerate() {
            let reach = jacobian.row(row).iter().zip(sizes).fold(0.0_f64, |most, (x, size)| most.max((x * size).abs()));
            lambda[*k] = work / or_one(reach) * drawn(row, 3);
        }
        Some(Draw { place, v, a, lambda })
    }

    /// ∂F/∂q and ∂(J a + γ)/∂q at a state near a place at which all terms matter, each coordinate in its size; `None` where they are not defined.
    fn dependence(&self, q: &[f64], sizes: &[f64], k: usize) -> Option<DMatrix<f64>> {
        let (n, m) = (self.n, self.rows.len());
        let Draw { place, v, a, lambda } = self.draw(q, sizes, k)?;
        let at = At::new(0.0, &place, &v).accelerated(&a).constrained(&lambda);
        let mut slopes = DMatrix::zeros(n + m, n);
        slopes.view_mut((0, 0), (n, n)).copy_from(&force_slopes(self.system, at)[0]);
        slopes.view_mut((n, 0), (m, n)).copy_from(&constraint_slopes(self.system, at, &self.rows)[0]);
        if slopes.iter().any(|x| !x.is_finite()) {
            return None;
        }
        for mut row in slopes.row_iter_mut() {
            let largest = row.iter().zip(sizes).fold(0.0_f64, |most, (x, size)| most.max((x * size).abs()));
            row.iter_mut()
                .zip(sizes)
                .filter(|(x, size)| (**x * **size).abs() <= ROUNDING * largest)
                .for_each(|(x, _)| *x = 0.0);
        }
        Some(slopes)
    }

    /// The speeds of a steady motion at a place: those that are given (not 0) are kept, all others follow, the least.
    ///
    /// # Errors
    /// [`LinearError::NotSteady`] for one whose value matters, [`LinearError::SpeedsContradict`] where others do not let it go
    /// on.
    pub fn speeds(&self, shifts: &Shifts, q: &[f64], given: &[f64]) -> Result<Vec<f64>, LinearError> {
        Ok(self.speeds_along((&shifts.0, &shifts.coordinates()), q, given)?.0)
    }

    /// The same with directions in columns, of which the coordinates are named that some move; and how fast they go along
    /// each.
    ///
    /// # Errors
    /// As [`ConstrainedState::speeds`].
    pub fn speeds_along(
        &self,
        (ways, free): (&DMatrix<f64>, &[usize]),
        q: &[f64],
        given: &[f64],
    ) -> Result<(Vec<f64>, Vec<f64>), LinearError> {
        let (n, m) = (self.n, self.rows.len());
        let kept: Vec<usize> = (0..n).filter(|i| given[*i] != 0.0).collect();
        if kept.is_empty() {
            return Ok((vec![0.0; n], vec![0.0; ways.ncols()]));
        }
        let name = |i: usize| self.system.description().coordinates[i].name.to_string();
        if let Some(i) = kept.iter().find(|i| !free.contains(i)) {
            return Err(LinearError::NotSteady { coordinate: name(*i) });
        }
        let still = vec![0.0; n];
        let at = At::new(0.0, q, &still);
        let (jacobian, triples) = (constraint_matrix(self.system, at, &self.rows), constraint_triples(self.system, at));
        let drift = DVector::from_iterator(m, self.rows.iter().map(|row| triples[*row][1]));
        let count = kept.len();
        let mut matrix = DMatrix::zeros(count + m, ways.ncols());
        matrix.rows_mut(0, count).copy_from(&ways.select_rows(&kept));
        matrix.rows_mut(count, m).copy_from(&(&jacobian * ways));
        let right = kept.iter().map(|i| given[*i]).chain(drift.iter().map(|x| -x));
        let right = DMatrix::from_iterator(count + m, 1, right);
        let failed = LinearError::NoConvergence { what: "the speeds that constraints allow" };
        let mut weights = solve_least(&matrix, &right).ok_or(failed)?;
        let found = ways * &weights;
        let missed = kept.iter().find(|i| (found[**i] - given[**i]).abs() > MISSED * given[**i].abs());
        let v = DVector::from_fn(n, |i, _| if given[i] == 0.0 { found[i] } else { given[i] });
        let sizes = natural_sizes(&self.units(), v.as_slice());
        let v = DVector::from_fn(n, |i, _| if v[i].abs() <= REST * sizes[i] { 0.0 } else { v[i] });
        for (weight, way) in weights.iter_mut().zip(ways.column_iter()) {
            if way.iter().zip(&sizes).all(|(x, size)| (x * *weight).abs() <= REST * size) {
                *weight = 0.0;
            }
        }
        let (left, terms) = (&jacobian * &v + &drift, jacobian.abs() * v.abs() + drift.abs());
        let rounding = jacobian.abs() * DVector::from_vec(sizes) * REST;
        let row = (0..m).find(|k| left[*k].abs() > (MISSED * terms[*k]).max(rounding[*k]));
        match (missed, row) {
            (None, None) => Ok((v.as_slice().to_vec(), weights.as_slice().to_vec())),
            (missed, row) => Err(LinearError::SpeedsContradict {
                coordinate: name(*missed.unwrap_or(&kept[0])),
                constraint: row.map(|k| self.system.description().rows[self.rows[k]].name.to_string()),
            }),
        }
    }

    /// Refuses speeds at which departures do not go along with the constraints as at rest, or equations change as the motion
    /// goes on.
    ///
    /// # Errors
    /// [`LinearError::VelocityConstraint`], [`LinearError::NotSteady`].
    pub fn goes_on(&self, state: &State) -> Result<(), LinearError> {
        if state.v.iter().all(|v| *v == 0.0) {
            return Ok(());
        }
        let (units, description) = (self.units(), self.system.description());
        let (places, speeds) = (natural_sizes(&units, &state.q), natural_sizes(&units, &state.v));
        let (rate_jacobian, jacobian) = (self.rate_jacobian(state), self.jacobian(state));
        for (k, row) in self.rows.iter().enumerate() {
            let size = jacobian.row(k).iter().zip(&speeds).fold(0.0_f64, |most, (x, v)| most.max((x * v).abs()));
            if rate_jacobian.row(k).iter().zip(&places).any(|(x, q)| (x * q).abs() > SAME * size) {
                return Err(LinearError::VelocityConstraint { constraint: description.rows[*row].name.to_string() });
            }
        }
        let now = (self.slopes(state), self.jacobian(state));
        let changes = |later: &State| {
            let then = (self.slopes(later), self.jacobian(later));
            let changed = |now: &DMatrix<f64>, then: &DMatrix<f64>, i: usize| {
                let size = now.row(i).amax().max(then.row(i).amax());
                (now.row(i) - then.row(i)).amax() > SAME * size
            };
            let differ = |now: &DMatrix<f64>, then: &DMatrix<f64>| (0..now.nrows()).any(|i| changed(now, then, i));
            !self.stays(later) || differ(&now.0, &then.0) || differ(&now.1, &then.1)
        };
        let pace = state.v.iter().zip(&places).fold(0.0_f64, |most, (v, size)| most.max(v.abs() / size));
        for time in LATER.map(|way| way / pace) {
            if changes(&state.later(time, None)) {
                let moving = || (0..self.n).filter(|k| state.v[*k] != 0.0);
                let culprit = moving().find(|k| changes(&state.later(time, Some(*k)))).or_else(|| moving().next());
                let coordinate = culprit.map_or_else(String::new, |k| description.coordinates[k].name.to_string());
                return Err(LinearError::NotSteady { coordinate });
            }
        }
        Ok(())
    }
}

/// Combinations of independent rows, each of which alone has its largest element, 1, in its own column.
fn reduced(rows: DMatrix<f64>) -> DMatrix<f64> {
    let columns = rows.ncols();
    reduced_by(rows, columns).0
}

/// The same with columns of their own among the first ones only, and the rows that have one.
pub(super) fn reduced_by(mut rows: DMatrix<f64>, columns: usize) -> (DMatrix<f64>, Vec<usize>) {
    let mut open: Vec<usize> = (0..rows.nrows()).collect();
    while !open.is_empty() {
        let places = open.iter().flat_map(|i| (0..columns).map(move |j| (*i, j)));
        let Some((i, j)) = places.max_by(|a, b| rows[*a].abs().total_cmp(&rows[*b].abs())) else { break };
        if rows[(i, j)].abs() <= PART {
            break;
        }
        let top = rows.row(i) / rows[(i, j)];
        for k in 0..rows.nrows() {
            let part = if k == i { 0.0 } else { rows[(k, j)] };
            let mut row = rows.row_mut(k);
            row -= part * &top;
        }
        rows.set_row(i, &top);
        open.retain(|k| *k != i);
    }
    let own = (0..rows.nrows()).filter(|i| !open.contains(i)).collect();
    (rows.map(|x| if x.abs() <= PART { 0.0 } else { x }), own)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_reduced_to_columns_of_their_own() {
        let (c, s) = (0.6, 0.8);
        let mixed = DMatrix::from_row_slice(2, 3, &[c, c, s, -s, -s, c]);
        let rows = reduced(mixed);
        for (row, expected) in [(0, [0.0, 0.0, 1.0]), (1, [1.0, 1.0, 0.0])] {
            let found = (0..2).any(|k| (0..3).all(|j| (rows[(k, j)] - expected[j]).abs() < 1e-15));
            assert!(found, "{row}: {rows}");
        }
    }
}
