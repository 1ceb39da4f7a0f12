//! Starts that meet the constraints.

use nalgebra::{DMatrix, DVector};

use crate::cause::Cause;
use crate::mechanism::{At, System};

/// What is known of a start: values, and which of them are held.
#[derive(Clone, Debug)]
pub(crate) struct Start<'a> {
    /// Its time, s.
    pub t: f64,
    /// [q; q']: held values, and the guess for all others.
    pub y: &'a [f64],
    /// Which of [q; q'] keep their values.
    pub held: &'a [bool],
    /// Which of the mechanism's other equations of the start are to be met.
    pub also: std::ops::Range<usize>,
}

/// A constraint may be missed by so much, in SI, by values that are all held.
const MISSED: f64 = 1e-9;
/// A closed constraint, beside the sum of its terms.
const CLOSED: f64 = 1e-14;
/// At a stationary point of |c|² its gradient is below this part of what it might be.
const STATIONARY: f64 = 1e-6;
/// Levenberg and Marquardt's iterations at most.
const ITERATIONS: usize = 500;
/// Rows whose least singular value, scaled, is below this depend on each other.
const SINGULAR: f64 = 1e-6;

/// The state nearest to a start, in SI units of the coordinates, that keeps what is held and meets the constraints in
/// force; its speeds are those of least kinetic energy.
///
/// # Errors
/// Held values that miss a constraint, constraints that cannot be met, rows that depend on each other there although they
/// do not elsewhere.
pub(crate) fn consistent<S: System + ?Sized>(system: &S, start: &Start<'_>) -> Result<Vec<f64>, Cause> {
    let n = system.len();
    let closing = Closing::new(system, start);
    let mut y = start.y.to_vec();
    if !closing.rows.is_empty() {
        closing.close(&mut y)?;
        closing.nearest(&mut y);
        closing.judge(&y)?;
        closing.speeds(&mut y)?;
    }
    if !start.also.is_empty() {
        closing.also(&mut y, start.also.clone())?;
    }
    debug_assert_eq!(y.len(), 2 * n, "a state");
    Ok(y)
}

struct Closing<'a, S: System + ?Sized> {
    system: &'a S,
    t: f64,
    n: usize,
    guess: &'a [f64],
    held: &'a [bool],
    /// Active rows.
    rows: Vec<usize>,
    /// Those of them without speeds.
    holonomic: Vec<usize>,
    /// Coordinates that are not held.
    free: Vec<usize>,
}

impl<'a, S: System + ?Sized> Closing<'a, S> {
    fn new(system: &'a S, start: &Start<'a>) -> Self {
        let n = system.len();
        let rows: Vec<usize> = system.active_rows().iter().map(|row| *row as usize).collect();
        let holonomic = rows.iter().copied().filter(|row| system.description().rows[*row].holonomic).collect();
        let free = (0..n).filter(|i| !start.held[*i]).collect();
        Closing { system, t: start.t, n, guess: start.y, held: start.held, rows, holonomic, free }
    }

    fn triples(&self, y: &[f64]) -> Vec<f64> {
        let mut triples = vec![0.0; 3 * self.system.description().rows.len()];
        self.system.constraints(At::packed(self.t, y, self.n), &mut triples);
        triples
    }

    /// c of the holonomic rows and what counts as closed for each.
    fn residual(&self, y: &[f64]) -> (DVector<f64>, Vec<f64>) {
        let triples = self.triples(y);
        let c = self.holonomic.iter().map(|row| triples[3 * row]);
        let closed = self.holonomic.iter().map(|row| CLOSED * triples[3 * row + 2].max(f64::MIN_POSITIVE)).collect();
        (DVector::from_iterator(self.holonomic.len(), c), closed)
    }

    /// Rows of J, all columns.
    fn jacobian(&self, y: &[f64], rows: &[usize]) -> DMatrix<f64> {
        let pattern = &self.system.description().constraint_pattern;
        let mut values = vec![0.0; pattern.len()];
        self.system.constraint_matrix(At::place(self.t, &y[..self.n]), &mut values);
        let mut j = DMatrix::zeros(rows.len(), self.n);
        for ((row, column), value) in pattern.iter().zip(values) {
            if let Some(k) = rows.iter().position(|r| *r == *row as usize) {
                j[(k, *column as usize)] = value;
            }
        }
        j
    }

    /// Levenberg's and Marquardt's iteration to c = 0 (Moré 1978), rows divided by their norms.
    fn close(&self, y: &mut [f64]) -> Result<(), Cause> {
        let mut damping = 1e-3;
        let mut scales = vec![0.0_f64; self.holonomic.len()];
        for _ in 0..ITERATIONS {
            let (c, closed) = self.residual(y);
            if let Some(k) = c.iter().position(|c| !c.is_finite()) {
                let constraint = self.name(self.holonomic[k]);
                return Err(Cause::NonFinite { what: format!("the constraint `{constraint}` at the start") });
            }
            if c.iter().zip(&closed).all(|(c, closed)| c.abs() <= *closed) {
                return Ok(());
            }
            let full = self.jacobian(y, &self.holonomic);
            let mut a = full.select_columns(&self.free);
            let mut b = c.clone();
            for k in 0..self.holonomic.len() {
                scales[k] = scales[k].max(full.row(k).norm());
                let scale = if scales[k] > 0.0 { 1.0 / scales[k] } else { 0.0 };
                a.row_mut(k).scale_mut(scale);
                b[k] *= scale;
            }
            let gradient = a.transpose() * &b;
            let size = b.norm();
            if gradient.norm() <= 1e-8 * a.norm() * size || self.free.is_empty() {
                break;
            }
            let normal = a.transpose() * &a;
            let mut moved = false;
            for _ in 0..60 {
                let mut damped = normal.clone();
                for i in 0..damped.nrows() {
                    damped[(i, i)] += damping * normal.trace() / normal.nrows().max(1) as f64;
                }
                let Some(step) = damped.cholesky().map(|cholesky| cholesky.solve(&gradient)) else { break };
                let mut tried = y.to_vec();
                self.free.iter().zip(step.iter()).for_each(|(i, s)| tried[*i] -= s);
                let (after, _) = self.residual(&tried);
                let norm = after.iter().zip(&scales).map(|(c, s)| if *s > 0.0 { c / s } else { 0.0 });
                if norm.map(|c| c * c).sum::<f64>().sqrt() < size {
                    y.copy_from_slice(&tried);
                    damping = (damping / 5.0).max(1e-18);
                    moved = true;
                    break;
                }
                damping *= 4.0;
            }
            if !moved {
                break;
            }
        }
        self.closed(y)
    }

    /// Whether what is left is rounding; else what it is.
    fn closed(&self, y: &[f64]) -> Result<(), Cause> {
        let (c, _) = self.residual(y);
        let worst = (0..c.len()).max_by(|a, b| c[*a].abs().total_cmp(&c[*b].abs()));
        let Some(worst) = worst.filter(|k| c[*k].abs() > MISSED) else { return Ok(()) };
        let (constraint, residual) = (self.name(self.holonomic[worst]), c[worst]);
        let full = self.jacobian(y, &self.holonomic);
        let a = full.select_columns(&self.free);
        let touched = self.free.iter().any(|i| full[(worst, *i)] != 0.0);
        if !touched {
            return Err(Cause::StartMissesConstraint { constraint, residual });
        }
        let stationary = (a.transpose() * &c).norm() <= STATIONARY * a.norm() * c.norm();
        Err(Cause::Unreachable { constraint, residual, stationary })
    }

    /// Moves along the constraints to the point nearest to the guess.
    fn nearest(&self, y: &mut [f64]) {
        if self.free.is_empty() || self.holonomic.is_empty() {
            return;
        }
        for _ in 0..100 {
            let (c, _) = self.residual(y);
            let a = self.jacobian(y, &self.holonomic).select_columns(&self.free);
            let Ok(inverse) = a.clone().pseudo_inverse(1e-10 * a.norm()) else { return };
            let pull = DVector::from_iterator(self.free.len(), self.free.iter().map(|i| self.guess[*i] - y[*i]));
            let step = &pull - &inverse * (&a * &pull) - &inverse * &c;
            let size = step.norm();
            if size <= 1e-9 * (1.0 + pull.norm()) {
                break;
            }
            // A long way along a curved constraint is gone in pieces that can be closed again.
            let mut part = 1.0;
            let mut best = None;
            while part > 1e-3 {
                let mut tried = y.to_vec();
                self.free.iter().zip(step.iter()).for_each(|(i, s)| tried[*i] += part * s);
                let gone = |y: &[f64]| self.free.iter().map(|i| (self.guess[*i] - y[*i]).powi(2)).sum::<f64>();
                if self.close(&mut tried).is_ok() && gone(&tried) < gone(y) {
                    best = Some(tried);
                    break;
                }
                part *= 0.5;
            }
            match best {
                Some(tried) => y.copy_from_slice(&tried),
                None => break,
            }
        }
    }

    /// Speeds that are not held: those of least kinetic energy among all that the constraints allow.
    fn speeds(&self, y: &mut [f64]) -> Result<(), Cause> {
        let n = self.n;
        let held = &self.held[n..];
        let free: Vec<usize> = (0..n).filter(|i| !held[*i]).collect();
        let j = self.jacobian(y, &self.rows);
        free.iter().for_each(|i| y[n + i] = 0.0);
        let triples = self.triples(y);
        let rate = DVector::from_iterator(self.rows.len(), self.rows.iter().map(|row| triples[3 * row + 1]));
        let mass = self.mass(y);
        let m = mass.select_rows(&free).select_columns(&free);
        let coupled = mass.select_rows(&free) * DVector::from_row_slice(&y[n..]);
        let a = j.select_columns(&free);
        // K [v; μ] = [−M v_held; −J v_held − b], rows that depend on each other included.
        let (f, r) = (free.len(), self.rows.len());
        let mut k = DMatrix::zeros(f + r, f + r);
        k.view_mut((0, 0), (f, f)).copy_from(&m);
        k.view_mut((0, f), (f, r)).copy_from(&a.transpose());
        k.view_mut((f, 0), (r, f)).copy_from(&a);
        let right = DVector::from_iterator(f + r, (-coupled).iter().chain((-&rate).iter()).copied());
        if let Ok(solution) = k.svd(true, true).solve(&right, 1e-12) {
            free.iter().zip(solution.iter()).for_each(|(i, v)| y[n + i] = *v);
        }
        let triples = self.triples(y);
        let size: f64 = y[n..].iter().map(|v| v * v).sum::<f64>().sqrt().max(rate.norm());
        for (k, row) in self.rows.iter().enumerate() {
            let residual = triples[3 * row + 1];
            if residual.abs() > MISSED * (1.0 + j.row(k).norm() * size) || residual.is_nan() {
                return Err(Cause::StartMissesConstraint { constraint: self.name(*row), residual });
            }
        }
        Ok(())
    }

    /// Moves on to what the start is to meet beside constraints, by least steps (Gauss and Newton; differences only
    /// steer).
    fn also(&self, y: &mut [f64], range: std::ops::Range<usize>) -> Result<(), Cause> {
        let free: Vec<usize> = (0..2 * self.n).filter(|i| !self.held[*i]).collect();
        let all = |y: &[f64]| {
            let pairs = self.system.also(At::packed(self.t, y, self.n));
            let triples = self.triples(y);
            let place = self.holonomic.iter().map(|row| triples[3 * row]);
            let rate = self.rows.iter().map(|row| triples[3 * row + 1]);
            let rest = pairs[range.clone()].iter().map(|(value, wanted)| value - wanted);
            DVector::from_vec(place.chain(rate).chain(rest).collect())
        };
        let mut left = all(y);
        // An energy does not change with speeds where these vanish: something has to move.
        if y[self.n..].iter().all(|v| *v == 0.0) && left.rows(left.len() - range.len(), range.len()).norm() > MISSED {
            free.iter().filter(|i| **i >= self.n).for_each(|i| y[*i] = 1.0);
            left = all(y);
        }
        for _ in 0..ITERATIONS {
            let size = left.norm();
            if !size.is_finite() {
                break;
            }
            let mut slopes = DMatrix::zeros(left.len(), free.len());
            for (k, i) in free.iter().enumerate() {
                let step = 1e-6 * (1.0 + y[*i].abs());
                let mut moved = y.to_vec();
                moved[*i] += step;
                slopes.set_column(k, &((all(&moved) - &left) / step));
            }
            let Ok(step) = slopes.clone().svd(true, true).solve(&left, 1e-10 * slopes.norm()) else { break };
            let mut part = 1.0;
            let mut better = None;
            while part > 1e-6 && better.is_none() {
                let mut tried = y.to_vec();
                free.iter().zip(step.iter()).for_each(|(i, s)| tried[*i] -= part * s);
                let after = all(&tried);
                better = (after.norm() < size).then_some((tried, after));
                part *= 0.5;
            }
            let Some((tried, after)) = better else { break };
            y.copy_from_slice(&tried);
            left = after;
        }
        let first = left.len() - range.len();
        match (first..left.len()).find(|k| left[*k].is_nan() || left[*k].abs() > MISSED) {
            Some(k) => Err(Cause::StartMissesConstraint {
                constraint: format!("also, its equation {}", k - first + 1),
                residual: left[k],
            }),
            None => Ok(()),
        }
    }

    fn mass(&self, y: &[f64]) -> DMatrix<f64> {
        let pattern = &self.system.description().mass_pattern;
        let mut values = vec![0.0; pattern.len()];
        self.system.mass_matrix(At::place(self.t, &y[..self.n]), &mut values);
        let mut mass = DMatrix::zeros(self.n, self.n);
        for ((i, j), value) in pattern.iter().zip(values) {
            mass[(*i as usize, *j as usize)] = value;
            mass[(*j as usize, *i as usize)] = value;
        }
        mass
    }

    /// Refuses a place where the constraints are less independent than elsewhere: what follows there is not determined.
    fn judge(&self, y: &[f64]) -> Result<(), Cause> {
        let rank = self.system.description().phases.get(self.system.phase()).map_or(0, |phase| phase.rank as usize);
        let mut j = self.jacobian(y, &self.rows);
        let largest = j.row_iter().map(|row| row.norm()).fold(0.0, f64::max);
        for mut row in j.row_iter_mut() {
            let norm = row.norm();
            // A row that vanishes is not blown up.
            if norm > 1e-3 * largest {
                row.scale_mut(1.0 / norm);
            } else if largest > 0.0 {
                row.scale_mut(1.0 / largest);
            }
        }
        let mut values: Vec<f64> = j.singular_values().iter().copied().collect();
        values.sort_by(|a, b| b.total_cmp(a));
        match rank.checked_sub(1).and_then(|k| values.get(k)) {
            Some(sigma) if *sigma < SINGULAR => Err(Cause::SingularConfiguration { sigma: *sigma }),
            _ => Ok(()),
        }
    }

    fn name(&self, row: usize) -> String {
        self.system.description().rows[row].name.to_string()
    }
}
