//! y(t + h) = e^{Ah} y(t) + Σ Wₖ cₖ for y = [q; q'/s].

use nalgebra::{DMatrix, DVector};

use crate::integrate::ends::{Ends, between_ends};
use crate::integrate::{Control, Counters, Endpoint, OneStep, SAFETY, Segment, StepFailure, Tolerance, Trial, larger};
use crate::mechanism::{AccelerationSlopes, At, System};

use super::dense::{DERIVATIVES, LOBATTO, resolved};
use super::force::{Force, TERMS};
use super::propagator::Propagator;

/// The propagator of a linear system q'' = K q + D q' + f(t).
///
/// With speeds in units of a rate s of the system the blocks of A = [0 s; K/s D] are alike in size, without which
/// squaring e^{Ah/2ᵏ} k times would lose digits to the unit of time.
///
/// A force that changes is a polynomial over each step, through as many times as tell how well it follows: so steps are as long as
/// the tolerance lets them be.  Their lengths are equal parts of the way, no longer than the polynomial between the ends allows, halved so
/// and so often, since each length has its matrices.
pub(crate) struct Exact {
    pub(super) ends: Ends,
    slopes: AccelerationSlopes,
    pub(super) force: Force,
    /// s, 1/s.
    pub(super) rate: f64,
    pub(super) field: DMatrix<f64>,
    /// B = [0; 1/s].
    input: DMatrix<f64>,
    /// Those of the last lengths, the last one last.
    propagators: Vec<Propagator>,
    state: DVector<f64>,
    /// Room for a product and a state.
    product: DVector<f64>,
    room: Vec<f64>,
    /// Of the step that was tried.
    errors: Vec<f64>,
    /// hᵏ y⁽ᵏ⁾/k! at both ends, one state after the other.
    pub(super) taylor: [Vec<f64>; 2],
    pub(super) pieces: Vec<f64>,
    counters: Counters,
}

/// Of a force that changes.  A trial that is too long costs little, for it is refused before there are matrices.
const CONTROL: Control = Control {
    exponent: 1.0 / TERMS as f64,
    safety: SAFETY,
    shrink: 1e-3,
    grow: 1e3,
    at_first: 1.0,
    stiff: f64::INFINITY,
};
/// Matrices of so many lengths are kept.
pub(crate) const LENGTHS: usize = 8;
/// Lengths that differ by so many roundings of the time, and by no more than this part of themselves, are one.
const ROUNDINGS: f64 = 8.0;
const ALIKE: f64 = 1e-8;

impl Exact {
    /// Makes room for n coordinates.
    pub fn new(n: usize, work: bool) -> Self {
        let size = 2 * n;
        Exact {
            ends: Ends::new(n, work),
            slopes: AccelerationSlopes::new(n),
            force: Force::new(n),
            rate: 1.0,
            field: DMatrix::zeros(size, size),
            input: DMatrix::zeros(size, n),
            propagators: Vec::with_capacity(LENGTHS),
            state: DVector::zeros(size),
            product: DVector::zeros(size),
            room: vec![0.0; size],
            errors: vec![0.0; size],
            taylor: [vec![0.0; size * DERIVATIVES], vec![0.0; size * DERIVATIVES]],
            pieces: vec![0.0; size * 2 * DERIVATIVES],
            counters: Counters::default(),
        }
    }

    /// A and B, from the slopes of the accelerations; matrices of steps hold as long as A does.
    fn linearise(&mut self, system: &dyn System, t: f64) -> Result<(), StepFailure> {
        let n = self.ends.n;
        self.slopes.evaluate(system, At::packed(t, &self.ends.y, n))?;
        self.counters.jacobians += 1;
        self.rate = rate(&self.slopes, n).max(f64::MIN_POSITIVE.sqrt());
        let (place, speed) = (self.slopes.by_place(), self.slopes.by_speed());
        let mut field = DMatrix::zeros(2 * n, 2 * n);
        for i in 0..n {
            field[(i, n + i)] = self.rate;
            self.input[(n + i, i)] = 1.0 / self.rate;
            for j in 0..n {
                field[(n + i, j)] = place[i * n + j] / self.rate;
                field[(n + i, n + j)] = speed[i * n + j];
            }
        }
        let terms = self.force.terms();
        self.force.begin(system, t)?;
        if field != self.field || terms != self.force.terms() {
            self.propagators.clear();
            self.field = field;
        }
        Ok(())
    }

    /// The place of the propagator of a step of h from t.
    fn prepare(&mut self, t: f64, h: f64) -> usize {
        let close = (ROUNDINGS * f64::EPSILON * (t.abs() + h)).min(ALIKE * h);
        match self.propagators.iter().position(|known| (known.h - h).abs() <= close) {
            Some(place) => self.propagators[place..].rotate_left(1),
            None => {
                if self.propagators.len() == LENGTHS {
                    self.propagators.remove(0);
                }
                self.propagators.push(Propagator::new(&self.field, &self.input, h, self.force.terms()));
                self.counters.factorizations += 1;
            }
        }
        self.propagators.len() - 1
    }

    /// The error of what a force that changes does over a step of h, in units of the tolerance: what the polynomial through its values
    /// misses swings about zero, so that less of it is left after each integration.
    fn error(&mut self, (t, h): (f64, f64), tolerance: &Tolerance) -> f64 {
        // Of P₉ less is left, 1/17; but what is not resolved yet looks like polynomials of low degree, too.
        const LEFT: f64 = 0.25;
        let n = self.ends.n;
        let mut squares = 0.0;
        for i in 0..n {
            let (missed, size) = self.force.missed(i, (t, h));
            // In longer times than that what a force did turns round.
            let acts = h.min(1.0 / self.rate);
            let speed = acts * larger(self.ends.rate[n + i].abs(), size);
            let place = larger((h * self.ends.y[n + i]).abs(), acts * speed);
            let units = tolerance.units_by_change(i, h, [place, speed]);
            self.errors[n + i] = LEFT * h * missed;
            self.errors[i] = LEFT * h * self.errors[n + i];
            squares += (self.errors[i] / units[0]).powi(2) + (self.errors[n + i] / units[1]).powi(2);
        }
        (squares / (2 * n).max(1) as f64).sqrt()
    }

    /// [q'; q''] at the end of the step.
    fn rate_at_end(&mut self) {
        let n = self.ends.n;
        pack(&self.ends.end, self.rate, &mut self.state);
        self.product.gemv(1.0, &self.field, &self.state, 0.0);
        for i in 0..n {
            self.ends.end_rate[i] = self.ends.end[n + i];
            self.ends.end_rate[n + i] = self.rate * self.product[n + i] + self.force.end[i];
        }
    }

    /// hᵏ y⁽ᵏ⁾/k! of [q; q'] at both ends.
    pub(super) fn write_derivatives(&mut self, h: f64) {
        let n = self.ends.n;
        let ends = [(&self.ends.y, false), (&self.ends.end, true)];
        for ((y, at_end), taylor) in ends.into_iter().zip(&mut self.taylor) {
            pack(y, self.rate, &mut self.state);
            for (k, found) in taylor.chunks_exact_mut((2 * n).max(1)).enumerate() {
                if k > 0 {
                    self.product.gemv(h / k as f64, &self.field, &self.state, 0.0);
                    for i in 0..n {
                        let force = self.force.derivative(i, k - 1, at_end);
                        self.product[n + i] += h / k as f64 * force / self.rate;
                    }
                    std::mem::swap(&mut self.product, &mut self.state);
                }
                for i in 0..n {
                    (found[i], found[n + i]) = (self.state[i], self.rate * self.state[n + i]);
                }
            }
        }
    }

    /// W of the step.
    fn weigh(&mut self, system: &dyn System, t: f64, h: f64) {
        self.write_dense(h);
        let segment = Segment { t, h, width: 2 * self.ends.n, pieces: &self.pieces };
        let mut sum = 0.0;
        for (node, weight) in LOBATTO {
            segment.evaluate(node, &mut self.room);
            sum += weight * system.energy(At::packed(t + node * h, &self.room, self.ends.n)).power;
        }
        self.ends.add_work(h * sum);
    }
}

impl OneStep for Exact {
    fn control(&self) -> Control {
        CONTROL
    }

    fn counters(&self) -> Counters {
        let evaluations = self.ends.evaluations + self.force.evaluations + self.counters.evaluations;
        Counters { evaluations, ..self.counters }
    }

    between_ends!();

    fn begin(&mut self, system: &dyn System, t: f64) -> Result<(), StepFailure> {
        self.ends.begin(system, t)?;
        self.linearise(system, t)
    }

    fn evaluate(&mut self, system: &dyn System, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), StepFailure> {
        self.counters.evaluations += 1;
        Ok(system.rate(t, y, rate)?)
    }

    fn attempt(&mut self, system: &dyn System, Trial { t, h, tolerance }: Trial<'_>) -> Result<f64, StepFailure> {
        let n = self.ends.n;
        let mut error = 0.0;
        if self.force.changes {
            self.force.follow(system, t, h)?;
            if let Some(tolerance) = tolerance {
                error = self.error((t, h), tolerance);
                if error.is_nan() || error > 1.0 {
                    self.ends.end.copy_from_slice(&self.ends.y);
                    return Ok(error);
                }
            }
        }
        let place = self.prepare(t, h);
        let propagator = &self.propagators[place];
        pack(&self.ends.y, self.rate, &mut self.state);
        propagator.apply(&self.state, &self.force.coefficients, &mut self.product);
        for i in 0..2 * n {
            let unit = if i < n { 1.0 } else { self.rate };
            self.ends.increment[i] = unit * self.product[i] - self.ends.y[i] + self.ends.carry[i];
        }
        self.ends.add_up();
        self.rate_at_end();
        let left = h - self.propagators[place].h;
        if left != 0.0 {
            self.ends.increment.iter_mut().zip(&self.ends.end_rate).for_each(|(step, rate)| *step += left * rate);
            self.ends.add_up();
        }
        if self.ends.works() {
            self.weigh(system, t, h);
        }
        Ok(error)
    }

    fn conclude(&mut self, _: &dyn System, _: f64, moved: bool) -> Result<bool, StepFailure> {
        if moved {
            self.rate_at_end();
        }
        Ok(self.ends.end_rate.iter().all(|rate| rate.is_finite()))
    }

    fn errors(&self) -> &[f64] {
        &self.errors
    }

    fn longest(&self, relative: f64) -> f64 {
        if self.force.changes { resolved(relative) / self.rate } else { f64::INFINITY }
    }

    fn accept(&mut self, compensated: bool) {
        self.ends.accept(compensated);
        if self.force.changes {
            self.force.accept();
        }
    }

    fn stiffness(&self, _: f64, _: f64) -> f64 {
        0.0
    }

    fn dense_is_free(&self) -> bool {
        true
    }

    fn dense(&mut self, _: &dyn System, _: f64, h: f64) -> Result<(), StepFailure> {
        self.write_dense(h);
        Ok(())
    }

    fn segment(&self, t: f64, h: f64) -> Segment<'_> {
        Segment { t, h, width: 2 * self.ends.n, pieces: &self.pieces }
    }
}

/// Operations of the matrices of a step, about, and of a step, products with vectors: of forces that change, `driven`, more.
pub(crate) fn operations(n: usize, driven: bool) -> (f64, f64) {
    // Those of e^{Ah}, and the terms and doublings of the integrals, which are half as wide.
    let products = if driven { 12.0 + 9.0 + TERMS as f64 } else { 12.0 };
    let n = n as f64;
    let step = 2.0 * (2.0 * n).powi(2) * if driven { 1.0 + 0.5 * TERMS as f64 } else { 1.0 };
    (products * 2.0 * (2.0 * n).powi(3), step)
}

/// [q; q'/s].
fn pack(y: &[f64], rate: f64, state: &mut DVector<f64>) {
    let n = y.len() / 2;
    for i in 0..n {
        (state[i], state[n + i]) = (y[i], y[n + i] / rate);
    }
}

/// A bound of the rates of the system, |λ| ≤ ‖D‖/2 + √(‖D‖²/4 + ‖K‖), 1/s.
fn rate(slopes: &AccelerationSlopes, n: usize) -> f64 {
    let norm = |matrix: &[f64]| {
        matrix.chunks_exact(n.max(1)).map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max)
    };
    let half = 0.5 * norm(slopes.by_speed());
    half + (half * half + norm(slopes.by_place())).sqrt()
}

/// A bound of the rates of a system at a state, 1/s.
///
/// # Errors
/// Those of the accelerations there.
pub(crate) fn fastest_rate(system: &dyn System, t: f64, y: &[f64]) -> Result<f64, StepFailure> {
    let n = y.len() / 2;
    let mut slopes = AccelerationSlopes::new(n);
    slopes.evaluate(system, At::packed(t, y, n))?;
    Ok(rate(&slopes, n))
}

/// The longest step whose polynomial between the ends is as exact as a tolerance says, s; infinite for a system without rates.
///
/// # Errors
/// Those of the accelerations at the state.
pub(crate) fn longest_step(system: &dyn System, t: f64, y: &[f64], tolerance: f64) -> Result<f64, StepFailure> {
    Ok(resolved(tolerance) / fastest_rate(system, t, y)?)
}
