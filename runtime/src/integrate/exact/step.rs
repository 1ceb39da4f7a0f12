//! y(t + h) = e^{Ah} y(t) for y = [q; q'/s; 1].

use nalgebra::{DMatrix, DVector};

use crate::integrate::ends::Ends;
use crate::integrate::{Control, Counters, NO_CONTROL, OneStep, Reached, Segment, Setback, Trial};
use crate::mechanism::{AccelerationSlopes, At, System};

use super::dense::{DERIVATIVES, LOBATTO, resolved};

/// The propagator of a linear system q'' = K q + D q' + c.
///
/// With speeds in units of a rate s of the system the blocks of A = [0 s 0; K/s D c/s; 0 0 0] are alike in size, without which
/// squaring e^{Ah/2ᵏ} k times would lose digits to the unit of time.
///
/// Source: Moler and Van Loan, *Nineteen dubious ways to compute the exponential of a matrix, twenty-five years later*, SIAM
/// Rev. 45 (2003) 3, method 3; the constant term as in section 10 there.
pub(crate) struct Exact {
    pub(super) ends: Ends,
    slopes: AccelerationSlopes,
    /// s, 1/s.
    pub(super) rate: f64,
    pub(super) field: DMatrix<f64>,
    over: DMatrix<f64>,
    /// The step that `over` is for, s; 0: none.
    over_step: f64,
    state: DVector<f64>,
    /// Room for a product and a state.
    product: DVector<f64>,
    room: Vec<f64>,
    /// hᵏ y⁽ᵏ⁾/k! at both ends, one state after the other.
    pub(super) taylor: [Vec<f64>; 2],
    pub(super) pieces: Vec<f64>,
    counters: Counters,
}

impl Exact {
    /// Makes room for n coordinates.
    pub fn new(n: usize, work: bool) -> Self {
        let size = 2 * n + 1;
        Exact {
            ends: Ends::new(n, work),
            slopes: AccelerationSlopes::new(n),
            rate: 1.0,
            field: DMatrix::zeros(size, size),
            over: DMatrix::identity(size, size),
            over_step: 0.0,
            state: DVector::zeros(size),
            product: DVector::zeros(size),
            room: vec![0.0; 2 * n],
            taylor: [vec![0.0; 2 * n * DERIVATIVES], vec![0.0; 2 * n * DERIVATIVES]],
            pieces: vec![0.0; 2 * n * 2 * DERIVATIVES],
            counters: Counters::default(),
        }
    }

    /// A, from the slopes of the accelerations and what is left of them.
    fn linearise(&mut self, system: &dyn System, t: f64) -> Result<(), Setback> {
        let n = self.ends.n;
        let at = At::packed(t, &self.ends.y, n);
        self.slopes.evaluate(system, at)?;
        self.counters.jacobians += 1;
        self.rate = rate(&self.slopes, n).max(f64::MIN_POSITIVE.sqrt());
        let (place, speed) = (self.slopes.by_place(), self.slopes.by_speed());
        self.field.fill(0.0);
        for i in 0..n {
            self.field[(i, n + i)] = self.rate;
            let mut rest = self.ends.rate[n + i];
            for j in 0..n {
                self.field[(n + i, j)] = place[i * n + j] / self.rate;
                self.field[(n + i, n + j)] = speed[i * n + j];
                rest -= place[i * n + j] * at.q[j] + speed[i * n + j] * at.v[j];
            }
            self.field[(n + i, 2 * n)] = rest / self.rate;
        }
        self.over_step = 0.0;
        Ok(())
    }

    /// [q'; q''] at the end of the step.
    fn rate_at_end(&mut self) {
        let n = self.ends.n;
        pack(&self.ends.end, self.rate, &mut self.state);
        self.product.gemv(1.0, &self.field, &self.state, 0.0);
        for i in 0..n {
            self.ends.end_rate[i] = self.ends.end[n + i];
            self.ends.end_rate[n + i] = self.rate * self.product[n + i];
        }
    }

    /// hᵏ y⁽ᵏ⁾/k! of [q; q'] at both ends.
    pub(super) fn write_derivatives(&mut self, h: f64) {
        let n = self.ends.n;
        for (y, taylor) in [&self.ends.y, &self.ends.end].into_iter().zip(&mut self.taylor) {
            pack(y, self.rate, &mut self.state);
            for (k, found) in taylor.chunks_exact_mut(2 * n).enumerate() {
                if k > 0 {
                    self.product.gemv(h / k as f64, &self.field, &self.state, 0.0);
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
        NO_CONTROL
    }

    fn counters(&self) -> Counters {
        Counters { evaluations: self.ends.evaluations + self.counters.evaluations, ..self.counters }
    }

    fn start(&self) -> Reached<'_> {
        self.ends.first()
    }

    fn state_mut(&mut self) -> &mut [f64] {
        &mut self.ends.y
    }

    fn end(&self) -> Reached<'_> {
        self.ends.last()
    }

    fn end_mut(&mut self) -> &mut [f64] {
        &mut self.ends.end
    }

    fn begin(&mut self, system: &dyn System, t: f64) -> Result<(), Setback> {
        self.ends.begin(system, t)?;
        self.linearise(system, t)
    }

    fn evaluate(&mut self, system: &dyn System, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), Setback> {
        self.counters.evaluations += 1;
        Ok(system.rate(t, y, rate)?)
    }

    fn attempt(&mut self, system: &dyn System, Trial { t, h, .. }: Trial<'_>) -> Result<f64, Setback> {
        let n = self.ends.n;
        if self.over_step != h {
            self.over = (&self.field * h).exp();
            self.counters.factorizations += 1;
            self.over_step = h;
        }
        pack(&self.ends.y, self.rate, &mut self.state);
        self.product.gemv(1.0, &self.over, &self.state, 0.0);
        for i in 0..2 * n {
            let unit = if i < n { 1.0 } else { self.rate };
            self.ends.increment[i] = unit * self.product[i] - self.ends.y[i] + self.ends.carry[i];
        }
        self.ends.add_up();
        self.rate_at_end();
        if self.ends.works() {
            self.weigh(system, t, h);
        }
        Ok(0.0)
    }

    fn conclude(&mut self, _: &dyn System, _: f64, moved: bool) -> Result<bool, Setback> {
        if moved {
            self.rate_at_end();
        }
        Ok(self.ends.end_rate.iter().all(|rate| rate.is_finite()))
    }

    fn errors(&self) -> &[f64] {
        &[]
    }

    fn accept(&mut self, compensated: bool) {
        self.ends.accept(compensated);
    }

    fn stiffness(&self, _: f64, _: f64) -> f64 {
        0.0
    }

    fn dense_is_free(&self) -> bool {
        true
    }

    fn dense(&mut self, _: &dyn System, _: f64, h: f64) -> Result<(), Setback> {
        self.write_dense(h);
        Ok(())
    }

    fn segment(&self, t: f64, h: f64) -> Segment<'_> {
        Segment { t, h, width: 2 * self.ends.n, pieces: &self.pieces }
    }
}

/// Operations of the exponential, with the squares and products of a matrix of size 2n + 1, about, and of a step, a product with a
/// vector.
pub(crate) fn operations(n: usize) -> (f64, f64) {
    const PRODUCTS: f64 = 12.0;
    let n = n as f64;
    (PRODUCTS * 2.0 * (2.0 * n + 1.0).powi(3), 2.0 * (2.0 * n).powi(2))
}

/// [q; q'/s; 1].
fn pack(y: &[f64], rate: f64, state: &mut DVector<f64>) {
    let n = y.len() / 2;
    for i in 0..n {
        (state[i], state[n + i]) = (y[i], y[n + i] / rate);
    }
    state[2 * n] = 1.0;
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
pub(crate) fn fastest_rate(system: &dyn System, t: f64, y: &[f64]) -> Result<f64, Setback> {
    let n = y.len() / 2;
    let mut slopes = AccelerationSlopes::new(n);
    slopes.evaluate(system, At::packed(t, y, n))?;
    Ok(rate(&slopes, n))
}

/// The longest step whose polynomial between the ends is as exact as a tolerance says, s; infinite for a system without rates.
///
/// # Errors
/// Those of the accelerations at the state.
pub(crate) fn longest_step(system: &dyn System, t: f64, y: &[f64], tolerance: f64) -> Result<f64, Setback> {
    Ok(resolved(tolerance) / fastest_rate(system, t, y)?)
}
