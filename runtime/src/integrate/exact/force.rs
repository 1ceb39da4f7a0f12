//! What drives a linear system: a function of time, as Legendre polynomials over a step.

use crate::integrate::StepFailure;
use crate::mechanism::{At, System};

/// So many polynomials stand for a force that changes.
pub(super) const TERMS: usize = 9;
/// A coefficient is a sum of values, each at a time of its own; their rounding adds up to so many roundings of one.
const ROUNDINGS: f64 = 4.0;

/// f(t) = a(t, q = 0, q' = 0) over a step, Σ cₖ Pₖ(τ) with τ from −1 to 1, through Lobatto's points: the convolution with e^{As} then
/// has errors of order 16, what lies between the ends of a step has those of the interpolation.
pub(super) struct Force {
    /// Whether it changes with time.
    pub changes: bool,
    /// f where the step begins and where it ends.
    pub start: Vec<f64>,
    pub end: Vec<f64>,
    /// cₖ, n numbers each; none where there is no force, one where it is constant.
    pub coefficients: Vec<f64>,
    /// Lobatto's points on [−1, 1], and for each of them the part of its value in each cₖ.
    points: [f64; TERMS],
    shares: [[f64; TERMS]; TERMS],
    /// f at the points.
    values: Vec<f64>,
    /// The state of rest in which it is evaluated.
    rest: Vec<f64>,
    pub evaluations: u64,
}

impl Force {
    /// Makes room for n coordinates.
    pub fn new(n: usize) -> Self {
        let points = lobatto();
        Force {
            changes: false,
            start: vec![0.0; n],
            end: vec![0.0; n],
            coefficients: Vec::with_capacity(n * TERMS),
            points,
            shares: points.map(share),
            values: vec![0.0; n * TERMS],
            rest: vec![0.0; n],
            evaluations: 0,
        }
    }

    /// Begins at a time: a constant force is known from here on.
    pub fn begin(&mut self, system: &dyn System, t: f64) -> Result<(), StepFailure> {
        self.changes = system.description().structure.time_dependent;
        self.evaluations += 1;
        system.accelerations(At::new(t, &self.rest, &self.rest), &mut self.start)?;
        self.end.copy_from_slice(&self.start);
        self.coefficients.clear();
        if self.changes {
            self.coefficients.resize(self.rest.len() * TERMS, 0.0);
        } else if self.start.iter().any(|f| *f != 0.0) {
            self.coefficients.extend_from_slice(&self.start);
        }
        Ok(())
    }

    /// How many polynomials it is made of.
    pub fn terms(&self) -> usize {
        self.coefficients.len().checked_div(self.rest.len()).unwrap_or(0)
    }

    /// Follows a force that changes over a step of h from t.
    pub fn follow(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), StepFailure> {
        let n = self.rest.len();
        for (value, point) in self.values.chunks_exact_mut(n.max(1)).zip(self.points) {
            if point == -1.0 {
                value.copy_from_slice(&self.start);
            } else {
                let at = At::new(t + 0.5 * (1.0 + point) * h, &self.rest, &self.rest);
                system.accelerations(at, value)?;
                self.evaluations += 1;
            }
        }
        self.coefficients.fill(0.0);
        for (value, shares) in self.values.chunks_exact(n.max(1)).zip(&self.shares) {
            for (coefficients, share) in self.coefficients.chunks_exact_mut(n.max(1)).zip(shares) {
                coefficients.iter_mut().zip(value).for_each(|(c, f)| *c += share * f);
            }
        }
        self.end.copy_from_slice(&self.values[n * (TERMS - 1)..]);
        Ok(())
    }

    /// What the polynomials miss of fᵢ over a step of h from t, and how large fᵢ is.
    ///
    /// Coefficients of a smooth function fall like a geometric series, those of even and of odd degree for themselves: what is
    /// left out is as much smaller than the last two as these are smaller than the two before.  What rounding of f and of the time, u|t||f'|,
    /// makes of them no shorter step would mend: it does not count.
    pub fn missed(&self, i: usize, (t, h): (f64, f64)) -> (f64, f64) {
        let n = self.rest.len();
        let size = |k: usize| self.coefficients[k * n + i].abs();
        let whole: f64 = (0..TERMS).map(size).sum();
        // |Pₖ'| ≤ k(k + 1)/2.
        let slope: f64 = (0..TERMS).map(|k| (k * (k + 1)) as f64 * size(k) / h.abs()).sum();
        let rounding = ROUNDINGS * f64::EPSILON * (whole + (t.abs() + h.abs()) * slope);
        let last = (size(TERMS - 1).max(size(TERMS - 2)) - rounding).max(0.0);
        let before = size(TERMS - 3).max(size(TERMS - 4));
        let falls = if last < before { last / before } else { 1.0 };
        (last * falls, whole)
    }

    /// The derivative of this order over its factorial, by the part θ of the step, of fᵢ at its start or its end.
    ///
    /// Pₖ⁽ʲ⁾(±1) = (±1)^{k+j} (k + j)!/(2ʲ j! (k − j)!).
    pub fn derivative(&self, i: usize, order: usize, at_end: bool) -> f64 {
        let n = self.rest.len();
        // Of P_order by θ, over the factorial: (2j)!/(j!)².
        let mut slope: f64 = (1..=order).map(|m| (order + m) as f64 / m as f64).product();
        let mut sum = 0.0;
        for k in order..self.terms() {
            let odd = (k + order) % 2 == 1 && !at_end;
            sum += self.coefficients[k * n + i] * if odd { -slope } else { slope };
            slope *= (k + 1 + order) as f64 / (k + 1 - order) as f64;
        }
        sum
    }

    /// The next step begins where this one ended.
    pub fn accept(&mut self) {
        std::mem::swap(&mut self.start, &mut self.end);
    }
}

/// (P₀, P₁, …)(τ).
pub(super) fn legendre(tau: f64) -> [f64; TERMS] {
    let mut p = [1.0; TERMS];
    p[1] = tau;
    for k in 1..TERMS - 1 {
        p[k + 1] = ((2 * k + 1) as f64 * tau * p[k] - k as f64 * p[k - 1]) / (k + 1) as f64;
    }
    p
}

/// The ends, and between them the zeros of the derivative of the last polynomial.
fn lobatto() -> [f64; TERMS] {
    let last = TERMS - 1;
    std::array::from_fn(|i| {
        // Those of Chebyshev are near enough for Newton's method.
        let mut tau = -(std::f64::consts::PI * i as f64 / last as f64).cos();
        for _ in 0..20 {
            let p = legendre(tau);
            // (1 − τ²) P' and its derivative −N(N + 1) P.
            let slope = last as f64 * (p[last - 1] - tau * p[last]);
            tau += slope / ((last * TERMS) as f64 * p[last]);
        }
        tau
    })
}

/// What a value at a point of Lobatto adds to each coefficient: w Pₖ(τ)/Σ w Pₖ², where w = 2/(N(N + 1) P_N(τ)²).
fn share(tau: f64) -> [f64; TERMS] {
    let (p, last) = (legendre(tau), TERMS - 1);
    let weight = 2.0 / ((last * TERMS) as f64 * p[last].powi(2));
    std::array::from_fn(|k| {
        let norm = if k == last { 2.0 / last as f64 } else { 2.0 / (2 * k + 1) as f64 };
        weight * p[k] / norm
    })
}

/// Pₖ = Σ cⱼ τʲ, each with its c₀, c₁, …
pub(super) fn legendre_coefficients() -> [[f64; TERMS]; TERMS] {
    let mut p = [[0.0; TERMS]; TERMS];
    (p[0][0], p[1][1]) = (1.0, 1.0);
    for k in 1..TERMS - 1 {
        for j in 0..TERMS {
            let raised = if j > 0 { p[k][j - 1] } else { 0.0 };
            p[k + 1][j] = ((2 * k + 1) as f64 * raised - k as f64 * p[k - 1][j]) / (k + 1) as f64;
        }
    }
    p
}
