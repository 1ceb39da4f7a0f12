//! Starts that meet the constraints.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::spin::KeptSpin;
use super::start_conditions::{By, Conditions};
use crate::cause::Cause;
use crate::matrix::{rank, solve_least, solve_least_refined, svd};
use crate::mechanism::dense::{
    ROUNDING, SECOND_ROUNDING, constraint_matrix, constraint_rate_jacobian, constraint_triples, mass_matrix,
    rounding_of_parameters, sizes_alike, widest,
};
use crate::mechanism::{At, System, rows_in_force};

/// What is known of a start: values, and which of them are held.
#[derive(Clone, Debug)]
pub(crate) struct Start<'a> {
    /// Its time, s.
    pub t: f64,
    /// [q; q']: held values, and the guess for all others.
    pub y: &'a [f64],
    /// Which of [q; q'] keep their values.
    pub held: &'a [bool],
    /// The latest time at which a run may have reached this state, s: what moves with time was there as it is now, but for the rounding of that time.
    pub reached: f64,
    /// Angular velocities among what is held, whose rates follow from the attitude.
    pub spins: &'a [KeptSpin],
    /// Which of the mechanism's other equations of the start are to be met.
    pub start_conditions: Range<usize>,
}

/// A constraint may be missed by this part of its terms, or of what the coordinates' sizes make of it, by values that are
/// all held.
pub(super) const MISSED: f64 = 1e-9;
/// Speeds beside the others that are their rounding.
pub(super) const ROUNDED: f64 = 1e-14;
/// A closed constraint, beside the sum of its terms.
pub(super) const CLOSED: f64 = 1e-14;
/// At a stationary point of |c|² its gradient is below this part of what it might be.
const STATIONARY: f64 = 1e-6;
/// Levenberg and Marquardt's iterations at most.
const ITERATIONS: usize = 500;
/// Newton's method goes on from what is known to this part of itself, by so many steps at the most, and for no more coordinates than these: each
/// has its own evaluation of ∂c'/∂q, and the matrix is solved as a whole.
const APPROACHED: f64 = 1e-3;
const NEWTON: u32 = 8;
const MOST_NEWTON: usize = 100;
/// Rows whose least singular value, scaled, is below this depend on each other.
const SINGULAR: f64 = 1e-6;

/// The state nearest to a start, in SI units of the coordinates, that keeps what is held and meets the constraints in
/// force; its speeds are those of least kinetic energy.  Both meet what else the start is to meet, places first.
///
/// # Errors
/// Held values that miss a constraint, constraints that cannot be met, rows that depend on each other there although they
/// do not elsewhere.
pub(crate) fn consistent<S: System + ?Sized>(system: &S, start: &Start<'_>) -> Result<Vec<f64>, Box<Cause>> {
    let n = system.len();
    let closing = Closing::new(system, start);
    let mut y = start.y.to_vec();
    let conditions = !closing.conditions.is_empty();
    if !closing.rows.is_empty() || conditions {
        let met = closing.close(&mut y);
        met.or_else(|why| {
            y.copy_from_slice(start.y);
            if conditions { closing.least_steps(&mut y).map_err(|_| why) } else { Err(why) }
        })?;
        closing.nearest(&mut y);
        closing.nearest_to_rounding(&mut y);
        closing.leave_rounding(&mut y);
        closing.judge(&y)?;
        closing.spin(&mut y);
        closing.speeds(&mut y)?;
    }
    if conditions {
        let place = y.clone();
        closing.meet_by_speeds(&mut y).or_else(|_| {
            y.copy_from_slice(&place);
            closing.least_steps(&mut y)
        })?;
    }
    closing.keep_lengths(&mut y);
    debug_assert_eq!(y.len(), 2 * n, "a state");
    Ok(y)
}

/// What makes a step short.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Steps {
    /// Its length in SI units.
    InSi,
    /// What its coordinates do to the constraints.
    ByEffect,
}

pub(super) struct Closing<'a, S: System + ?Sized> {
    pub system: &'a S,
    pub t: f64,
    reached: f64,
    pub n: usize,
    guess: &'a [f64],
    pub held: &'a [bool],
    pub spins: &'a [KeptSpin],
    /// What else is to be met.
    pub conditions: Conditions,
    /// Active rows.
    pub rows: Vec<usize>,
    /// Those of them without speeds.
    pub holonomic: Vec<usize>,
    /// Coordinates that are not held.
    pub free: Vec<usize>,
}

impl<'a, S: System + ?Sized> Closing<'a, S> {
    pub fn new(system: &'a S, start: &Start<'a>) -> Self {
        let n = system.len();
        let rows: Vec<usize> = rows_in_force(system).collect();
        let holonomic = rows.iter().copied().filter(|row| system.description().rows[*row].holonomic).collect();
        let free = (0..n).filter(|i| !start.held[*i]).collect();
        let conditions = Conditions::new(system, start.start_conditions.clone(), start.held);
        Closing {
            conditions,
            system,
            t: start.t,
            reached: start.reached,
            n,
            guess: start.y,
            held: start.held,
            spins: start.spins,
            rows,
            holonomic,
            free,
        }
    }

    pub fn triples(&self, y: &[f64]) -> Vec<[f64; 3]> {
        constraint_triples(self.system, At::packed(self.t, y, self.n))
    }

    /// Natural sizes of [q; q']: the largest of those with the same unit, at least what would change some constraint by its
    /// terms, and 1 for pure numbers and where nothing says more.
    pub fn sizes(&self, y: &[f64]) -> DVector<f64> {
        let (n, description) = (self.n, self.system.description());
        let unit = |i: usize| &*description.coordinates[i % n].unit;
        let (j, triples) = (self.jacobian(y, &self.holonomic), self.triples(y));
        let by_terms = |i: usize, k: usize| triples[self.holonomic[k]][2] / j[(k, i)].abs();
        let shortest = |i: usize| {
            let alike = (0..n).filter(|other| i < n && unit(*other) == unit(i));
            let lengths = alike.flat_map(|other| (0..self.holonomic.len()).map(move |k| by_terms(other, k)));
            lengths.filter(|x| x.is_finite() && *x > 0.0).reduce(f64::min).unwrap_or(0.0)
        };
        let largest = [sizes_alike(description, &y[..n]), sizes_alike(description, &y[n..])].concat();
        let size = |(i, largest): (usize, f64)| match unit(i) {
            "" | "1" | "rad" if i < n => largest.max(1.0),
            _ => Some(largest.max(shortest(i))).filter(|size| *size > 0.0).unwrap_or(1.0),
        };
        DVector::from_iterator(2 * n, largest.into_iter().enumerate().map(size))
    }

    /// What may be left of the rows' c, beside their terms and the sizes of coordinates; where all of these vanish, what moves by less than rounding of
    /// rounding.
    fn negligible(&self, y: &[f64], rows: &[usize]) -> Vec<f64> {
        let sizes = DVector::from_vec(sizes_alike(self.system.description(), &y[..self.n]));
        let (jacobian, triples) = (self.jacobian(y, rows).abs(), self.triples(y));
        let by_place = &jacobian * sizes;
        let nothing = jacobian * self.sizes(y).rows(0, self.n) * SECOND_ROUNDING;
        // What moves with time by itself is known as well as time is.
        let still = [&y[..self.n], &vec![0.0; self.n]].concat();
        let (own, late) = (self.triples(&still), ROUNDING * self.reached);
        let of = |k: usize| {
            let known = (MISSED * triples[rows[k]][2].max(by_place[k])).max(nothing[k]);
            known.max(rounding_of_parameters(self.system, rows[k])).max(late * own[rows[k]][1].abs())
        };
        (0..rows.len()).map(of).collect()
    }

    /// How many equations of places there are: holonomic rows, then those that are to be met beside them.
    fn place_count(&self) -> usize {
        self.holonomic.len() + self.conditions.of_places.len()
    }

    /// What is left of the equations of places and what counts as closed for each.
    fn residual(&self, y: &[f64]) -> (DVector<f64>, Vec<f64>) {
        let triples = self.triples(y);
        let of_places = &self.conditions.of_places;
        let (left, own) = (self.left(y, of_places), self.terms_of(y, of_places));
        let c = self.holonomic.iter().map(|row| triples[*row][0]).chain(left.iter().copied());
        let c = DVector::from_iterator(self.place_count(), c);
        let terms = self.holonomic.iter().map(|row| triples[*row][2]).chain(own.iter().copied());
        (c, terms.map(|terms| CLOSED * terms.max(f64::MIN_POSITIVE)).collect())
    }

    /// Slopes of the equations of places by the coordinates that are not held.
    fn place_slopes(&self, y: &[f64]) -> DMatrix<f64> {
        let (rows, others) = (self.holonomic.len(), &self.conditions.of_places);
        let mut slopes = self.jacobian(y, &self.holonomic).resize_vertically(self.place_count(), 0.0);
        slopes.rows_mut(rows, others.len()).copy_from(&self.slopes_of(y, others, By::Places));
        slopes.select_columns(&self.free)
    }

    /// Rows of J, all columns.
    fn jacobian(&self, y: &[f64], rows: &[usize]) -> DMatrix<f64> {
        constraint_matrix(self.system, At::place(self.t, &y[..self.n]), rows)
    }

    /// Goes to c = 0 by steps that are short in SI units; where these lead nowhere, as from lengths of 10¹² m beside angles, by steps that are short
    /// in units in which each coordinate matters alike.
    pub fn close(&self, y: &mut [f64]) -> Result<(), Box<Cause>> {
        let guess = y.to_vec();
        self.close_by_steps(y, Steps::InSi).or_else(|why| {
            let mut other = guess;
            match self.close_by_steps(&mut other, Steps::ByEffect) {
                Ok(()) => {
                    y.copy_from_slice(&other);
                    Ok(())
                }
                Err(_) => Err(why),
            }
        })
    }

    /// Levenberg's and Marquardt's iteration to c = 0 (Moré 1978), rows divided by the norms of what is free in them.
    fn close_by_steps(&self, y: &mut [f64], steps: Steps) -> Result<(), Box<Cause>> {
        let mut damping = 1e-3;
        let mut scales = vec![0.0_f64; self.place_count()];
        let mut longest = vec![0.0_f64; self.free.len()];
        let widest = widest(self.system.description());
        for _ in 0..ITERATIONS {
            let (c, closed) = self.residual(y);
            if let Some(k) = c.iter().position(|c| !c.is_finite()) {
                let Some(row) = self.holonomic.get(k) else { break };
                let constraint = self.name(*row);
                return Err(Cause::NonFinite { what: format!("the constraint `{constraint}` at the start") }.into());
            }
            if c.iter().zip(&closed).all(|(c, closed)| c.abs() <= *closed) {
                return Ok(());
            }
            let mut a = self.place_slopes(y);
            let mut b = c.clone();
            for k in 0..self.place_count() {
                // What is held moves nothing, in whatever unit it is.
                scales[k] = scales[k].max(a.row(k).norm());
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
            let mean = normal.trace() / normal.nrows().max(1) as f64;
            for (longest, own) in longest.iter_mut().zip(normal.diagonal().iter()) {
                *longest = if steps == Steps::InSi { mean } else { longest.max(*own) };
            }
            let mut moved = false;
            // Beyond half a turn an angle is at a place that is nearer the other way.
            let mut turns = 0.5;
            for _ in 0..60 {
                let mut damped = normal.clone();
                for (i, longest) in longest.iter().enumerate() {
                    damped[(i, i)] += damping * if *longest > 0.0 || steps == Steps::InSi { *longest } else { 1.0 };
                }
                let Some(mut step) = damped.cholesky().map(|cholesky| cholesky.solve(&gradient)) else { break };
                let turned =
                    self.free.iter().zip(step.iter()).fold(0.0_f64, |most, (i, s)| most.max(s.abs() / widest[*i]));
                if turned > turns {
                    step *= turns / turned;
                }
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
                if turned > turns {
                    turns *= 0.5;
                } else {
                    damping *= 4.0;
                }
            }
            if !moved {
                break;
            }
        }
        self.closed(y)
    }

    /// Whether what is left is rounding; else what it is.
    fn closed(&self, y: &[f64]) -> Result<(), Box<Cause>> {
        let (c, _) = self.residual(y);
        let mut negligible = self.negligible(y, &self.holonomic);
        negligible.extend(self.terms_of(y, &self.conditions.of_places).iter().map(|terms| MISSED * terms));
        let missed = (0..c.len()).filter(|k| c[*k].is_nan() || c[*k].abs() > negligible[*k]);
        let Some(worst) = missed.max_by(|a, b| c[*a].abs().total_cmp(&c[*b].abs())) else { return Ok(()) };
        if let Some(other) = worst.checked_sub(self.holonomic.len()) {
            return Err(self.missed_condition(self.conditions.of_places[other], c[worst]));
        }
        let (constraint, residual) = (self.name(self.holonomic[worst]), c[worst]);
        let full = self.jacobian(y, &self.holonomic);
        let a = self.place_slopes(y);
        let row = self.holonomic[worst] as u32;
        let pattern = &self.system.description().constraint_pattern;
        if !pattern.iter().any(|(of, i)| *of == row && self.free.contains(&(*i as usize))) {
            return Err(Cause::StartMissesConstraint { constraint, residual }.into());
        }
        // Where what is free has no effect of first order, another guess may have one.
        let touched = self.free.iter().any(|i| full[(worst, *i)] != 0.0);
        let stationary = touched && (a.transpose() * &c).norm() <= STATIONARY * a.norm() * c.norm();
        Err(Cause::Unreachable { constraint, residual, stationary }.into())
    }

    /// Moves along the constraints to the point nearest to the guess.
    fn nearest(&self, y: &mut [f64]) {
        if self.free.is_empty() || self.place_count() == 0 {
            return;
        }
        for _ in 0..100 {
            let (c, _) = self.residual(y);
            let a = self.place_slopes(y);
            let inverse = svd(a.clone(), true, true).map(|svd| svd.pseudo_inverse(1e-10 * a.norm()));
            let Some(Ok(inverse)) = inverse else { return };
            let pull = DVector::from_iterator(self.free.len(), self.free.iter().map(|i| self.guess[*i] - y[*i]));
            let step = &pull - &inverse * (&a * &pull) - &inverse * &c;
            let size = step.norm();
            let place = self.free.iter().map(|i| y[*i] * y[*i]).sum::<f64>().sqrt();
            if size <= 1e-9 * (place + pull.norm()) {
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

    /// Goes on to the nearest point by Newton's method: distances tell it to the root of rounding only.
    fn nearest_to_rounding(&self, y: &mut [f64]) {
        if self.free.is_empty() || self.place_count() == 0 || self.free.len() > MOST_NEWTON {
            return;
        }
        let mut last = f64::INFINITY;
        for _ in 0..NEWTON {
            let Some(step) = self.newton_step(y) else { return };
            let place = self.free.iter().map(|i| y[*i] * y[*i]).sum::<f64>().sqrt();
            let size = step.norm();
            if size.is_nan() || size > APPROACHED * place || size > 0.5 * last {
                return;
            }
            let mut tried = y.to_vec();
            self.free.iter().zip(step.iter()).for_each(|(i, s)| tried[*i] += s);
            if self.close(&mut tried).is_err() {
                return;
            }
            y.copy_from_slice(&tried);
            last = size;
        }
    }

    /// Takes places that a search left within a rounding of 0, beside others of their unit, for 0, where that closes the constraints as well.
    fn leave_rounding(&self, y: &mut [f64]) {
        let sizes = sizes_alike(self.system.description(), &y[..self.n]);
        let mut cleared = y.to_vec();
        let is_rounding = |i: &&usize| y[**i] != self.guess[**i] && y[**i].abs() <= f64::EPSILON * sizes[**i];
        self.free.iter().filter(is_rounding).for_each(|i| cleared[*i] = 0.0);
        let (left, closed) = self.residual(&cleared);
        if left.iter().zip(closed).all(|(c, closed)| c.abs() <= closed) {
            y.copy_from_slice(&cleared);
        }
    }

    /// The step δ with (1 + Σ λ_k ∂²c_k/∂q²) δ + Jᵀ μ = guess − q and J δ = −c, where Jᵀ λ is what of guess − q leads off the constraints; `None`
    /// at the guess itself.
    fn newton_step(&self, y: &[f64]) -> Option<DVector<f64>> {
        let (f, r, rows) = (self.free.len(), self.place_count(), self.holonomic.len());
        let pull = DVector::from_iterator(f, self.free.iter().map(|i| self.guess[*i] - y[*i]));
        if pull.iter().all(|pull| *pull == 0.0) {
            return None;
        }
        let a = self.place_slopes(y);
        let lambda = solve_least(&a.transpose(), &DMatrix::from_column_slice(f, 1, pull.as_slice()))?;
        let mut k = DMatrix::zeros(f + r, f + r);
        k.view_mut((0, f), (f, r)).copy_from(&a.transpose());
        k.view_mut((f, 0), (r, f)).copy_from(&a);
        // ∂²c/∂q∂q_i is how ∂c'/∂q changes with the speed of i.
        let mut speeds = vec![0.0; self.n];
        let rates = |speeds: &[f64]| {
            let state = [&y[..self.n], speeds].concat();
            constraint_rate_jacobian(self.system, At::packed(self.t, &state, self.n), &self.holonomic)
                .select_columns(&self.free)
        };
        let still = rates(&speeds);
        let sizes = self.sizes(y);
        for (row, i) in self.free.iter().enumerate() {
            speeds[*i] = 1.0;
            let mut bent = (rates(&speeds) - &still).transpose() * lambda.rows(0, rows);
            speeds[*i] = 0.0;
            if r > rows {
                let others = self.bent_by(y, *i, sizes[*i], &lambda.as_slice()[rows..]);
                bent += others.select_rows(&self.free);
            }
            (0..f).for_each(|column| k[(row, column)] = bent[column]);
            k[(row, row)] += 1.0;
        }
        let (c, _) = self.residual(y);
        let right = DMatrix::from_iterator(f + r, 1, pull.iter().copied().chain(c.iter().map(|c| -c)));
        let solution = solve_least(&k, &right)?;
        Some(solution.rows(0, f).column(0).into_owned())
    }

    /// Where an attitude has left the guess, gives it the rates of the angular velocity that is kept.
    pub fn spin(&self, y: &mut [f64]) {
        let (q, v) = y.split_at_mut(self.n);
        let moved = self.spins.iter().filter(|spin| q[spin.places()] != self.guess[spin.places()]);
        moved.for_each(|spin| spin.put(q, v));
    }

    /// Speeds that are not held: of least kinetic energy among those that meet the constraints and with which equations of these slopes lose what is left
    /// of them.  Returns the rates of the constraints by what is held.
    pub fn least_speeds(&self, y: &mut [f64], (slopes, left): (&DMatrix<f64>, &DVector<f64>)) -> DVector<f64> {
        let n = self.n;
        let free: Vec<usize> = (0..n).filter(|i| !self.held[n + i]).collect();
        let others = slopes.select_columns(&free);
        let wanted = &others * DVector::from_iterator(free.len(), free.iter().map(|i| y[n + i])) - left;
        free.iter().for_each(|i| y[n + i] = 0.0);
        let triples = self.triples(y);
        let rate = DVector::from_iterator(self.rows.len(), self.rows.iter().map(|row| triples[*row][1]));
        let mass = mass_matrix(self.system, At::packed(self.t, y, n));
        let m = mass.select_rows(&free).select_columns(&free);
        let coupled = mass.select_rows(&free) * DVector::from_row_slice(&y[n..]);
        let j = self.jacobian(y, &self.rows).select_columns(&free);
        // K [v; μ] = [−M v_held; −J v_held − b; wanted], rows that depend on each other included.
        let (f, r, all) = (free.len(), self.rows.len(), self.rows.len() + wanted.len());
        let mut a = j.resize_vertically(all, 0.0);
        a.rows_mut(r, wanted.len()).copy_from(&others);
        let mut k = DMatrix::zeros(f + all, f + all);
        k.view_mut((0, 0), (f, f)).copy_from(&m);
        k.view_mut((0, f), (f, all)).copy_from(&a.transpose());
        k.view_mut((f, 0), (all, f)).copy_from(&a);
        let right = coupled.iter().chain(rate.iter()).map(|x| -x).chain(wanted.iter().copied());
        if let Some(solution) = solve_least_refined(&k, &DMatrix::from_iterator(f + all, 1, right)) {
            free.iter().zip(solution.iter()).for_each(|(i, v)| y[n + i] = *v);
        }
        rate
    }

    /// Takes speeds within a rounding of 0, beside others of their unit, for 0, where constraints are met as well as before, or but for their terms' rounding.
    fn leave_rounding_of_speeds(&self, y: &mut [f64], j: &DMatrix<f64>) {
        let n = self.n;
        let sizes = sizes_alike(self.system.description(), &y[n..]);
        let mut cleared = y.to_vec();
        let is_rounding = |i: &usize| !self.held[n + i] && y[n + i].abs() <= f64::EPSILON * sizes[*i];
        (0..n).filter(is_rounding).for_each(|i| cleared[n + i] = 0.0);
        let terms = j.abs() * DVector::from_row_slice(&y[n..]).abs();
        let (before, after) = (self.triples(y), self.triples(&cleared));
        let as_well = |(row, terms): (&usize, &f64)| after[*row][1].abs() <= before[*row][1].abs().max(CLOSED * terms);
        if self.rows.iter().zip(terms.iter()).all(as_well) {
            y.copy_from_slice(&cleared);
        }
    }

    /// Speeds that are not held: those of least kinetic energy among all that the constraints allow.
    fn speeds(&self, y: &mut [f64]) -> Result<(), Box<Cause>> {
        let n = self.n;
        let rate = self.least_speeds(y, (&DMatrix::zeros(0, n), &DVector::zeros(0)));
        let (j, mass) = (self.jacobian(y, &self.rows), mass_matrix(self.system, At::packed(self.t, y, n)));
        self.leave_rounding_of_speeds(y, &j);
        let triples = self.triples(y);
        let sizes = DVector::from_vec(sizes_alike(self.system.description(), &y[n..]));
        let terms = j.abs() * sizes + rate.abs();
        // Speeds that are rounding of others miss a row by as little: |J v| is no more than |J| |v| in the metric of M.
        let inertia = mass.diagonal();
        let quick = (0..n).map(|i| inertia[i].max(0.0) * y[n + i] * y[n + i]).sum::<f64>().sqrt();
        let eased = |k: usize| {
            let shares = (0..n).filter(|i| inertia[*i] > 0.0).map(|i| j[(k, i)] * j[(k, i)] / inertia[i]);
            shares.sum::<f64>().sqrt()
        };
        // And what is at rest but for rounding moves in a second by less than rounding of the rounding of its place.
        let sizes = self.sizes(y).rows(0, n).into_owned();
        let nothing = j.abs() * &sizes * SECOND_ROUNDING;
        // Nor are rates of what moves a constraint known better than from where, as where they turn back.
        let placed =
            constraint_rate_jacobian(self.system, At::packed(self.t, y, n), &self.rows).abs() * sizes * ROUNDING;
        // Nor is a rate that time makes known better beside those that it has elsewhere, as where it turns back: places c that go as w² c go as fast as
        // √(c·w² c) at the most.
        let mut bias = vec![0.0; triples.len()];
        self.system.constraint_bias(At::packed(self.t, y, n), &mut bias);
        let timed = |row: usize| match self.holonomic.contains(&row) {
            true => (triples[row][2] * bias[row].abs()).sqrt() * ROUNDING,
            false => 0.0,
        };
        for (k, row) in self.rows.iter().enumerate() {
            let [_, residual, own] = triples[*row];
            // A row of speeds knows what cancels in it.
            let cancels = if self.system.description().rows[*row].holonomic { 0.0 } else { ROUNDED * own };
            let negligible = (MISSED * terms[k]).max(ROUNDED * quick * eased(k)).max(nothing[k]).max(placed[k]);
            let negligible = negligible.max(cancels).max(timed(*row));
            if residual.abs() > negligible || residual.is_nan() {
                return Err(Cause::StartMissesConstraint { constraint: self.name(*row), residual }.into());
            }
        }
        Ok(())
    }

    /// Whether what is held leaves no motion of the others at a place.
    pub fn is_isolated(&self, y: &[f64]) -> bool {
        let sizes = self.sizes(y);
        let mut j = self.jacobian(y, &self.holonomic).select_columns(&self.free);
        j.column_iter_mut().zip(&self.free).for_each(|(mut column, i)| column.scale_mut(sizes[*i]));
        for mut row in j.row_iter_mut() {
            let norm = row.norm();
            if norm > 0.0 {
                row.scale_mut(1.0 / norm);
            }
        }
        rank(j, SINGULAR) == Some(self.free.len())
    }

    /// Refuses a place where the constraints are less independent than elsewhere: what follows there is not determined.
    fn judge(&self, y: &[f64]) -> Result<(), Box<Cause>> {
        if self.rows.is_empty() {
            return Ok(());
        }
        let rank = self.system.description().phases.get(self.system.phase()).map_or(0, |phase| phase.rank as usize);
        let place = At::packed(self.t, y, self.n);
        let (j, triples) = (self.jacobian(y, &self.rows), self.triples(y));
        let (sizes, inertia) = (self.sizes(y), mass_matrix(self.system, place).diagonal());
        let moved = j.abs() * sizes.rows(0, self.n);
        let whole = (0..self.n).map(|i| inertia[i].max(0.0) * sizes[i] * sizes[i]).sum::<f64>().sqrt();
        // In units of √M; what has no inertia, by its size.
        let by_inertia = |i: usize| match inertia[i].max(0.0).sqrt() {
            own if own > 0.0 => 1.0 / own,
            _ => sizes[i] / whole.max(f64::MIN_POSITIVE),
        };
        let scaled = |unit: &dyn Fn(usize) -> f64| {
            let mut scaled = j.clone();
            scaled.column_iter_mut().enumerate().for_each(|(i, mut column)| column.scale_mut(unit(i)));
            for (k, mut line) in scaled.row_iter_mut().enumerate() {
                // A row that vanishes beside the terms of its constraint is not blown up.
                let terms = if self.holonomic.contains(&self.rows[k]) { triples[self.rows[k]][2] } else { 0.0 };
                let share = if moved[k] < terms { moved[k] / terms } else { 1.0 };
                let norm = line.norm();
                line.scale_mut(if norm > 0.0 { share / norm } else { 0.0 });
            }
            scaled
        };
        let mut least = 0.0_f64;
        // Rows that a light body alone brings near each other are independent by sizes.
        for unit in [&by_inertia as &dyn Fn(usize) -> f64, &|i| sizes[i]] {
            let Some(svd) = svd(scaled(unit), false, false) else {
                return Err(Cause::NonFinite { what: "the slopes of constraints at the start".to_owned() }.into());
            };
            // Falling.
            let Some(sigma) = rank.checked_sub(1).and_then(|k| svd.singular_values.get(k)) else { return Ok(()) };
            least = least.max(*sigma);
            if least >= SINGULAR {
                return Ok(());
            }
        }
        Err(Cause::SingularConfiguration { sigma: least }.into())
    }

    /// Gives rotations the lengths of the guess, and lets them keep these: what was searched for depends on neither, and a length that has a rate
    /// grows for ever.
    fn keep_lengths(&self, y: &mut [f64]) {
        let free = |places: &Range<usize>| !self.held[places.clone()].contains(&true);
        for first in self.system.description().rotations.iter().map(|first| *first as usize) {
            let places = first..first + 4;
            let speeds = self.n + first..self.n + first + 4;
            let of = |y: &[f64], places: &Range<usize>| DVector::from_column_slice(&y[places.clone()]);
            let (q, guess) = (of(y, &places), of(self.guess, &places));
            let ratio = guess.norm() / q.norm();
            let kept = self.spins.iter().any(|spin| spin.places() == places);
            if !(free(&speeds) || kept) || !ratio.is_normal() {
                continue;
            }
            let ratio = if free(&places) { ratio } else { 1.0 };
            if free(&speeds) {
                let v = of(y, &speeds);
                let v = &v - &q * (q.dot(&v) / q.norm_squared());
                y[speeds].copy_from_slice((v * ratio).as_slice());
            }
            y[places].copy_from_slice((q * ratio).as_slice());
        }
        self.spin(y);
    }

    fn name(&self, row: usize) -> String {
        self.system.description().rows[row].name.to_string()
    }
}
