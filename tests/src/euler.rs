//! Problem 1 of the course: the error of Euler's method against the number of steps, in any precision.
//!
//! v' = v from v(0) = 1 to t = 1, by the generated accelerations of `exponential_growth`.  With n steps the
//! result is (1 + 1/n)ⁿ, short of e by e/(2n); rounding adds a random walk of about 1.3 ε √n, and in `f32`, from
//! some 2¹² steps on, errors that go one way and grow as n².  The best n is where the two meet.

use std::f64::consts::E;

use dalembert::mechanism::{Equations, Real};
use dalembert_models::exponential_growth::ExponentialGrowth;

/// How increments are added to the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sum {
    /// As written; what is below the last digit of the state is lost.
    Plain,
    /// What is lost is kept and added to the next increment (Kahan 1965).
    Compensated,
}

/// v(1) after n steps of Euler's method.
pub fn euler<S: Real + Into<f64>>(n: u64, sum: Sum) -> f64 {
    let constants = ExponentialGrowth::constants::<S>(|_| ExponentialGrowth::default());
    let h = S::ratio(1.0, n as f64);
    let (zero, one) = (S::ratio(0.0, 1.0), S::ratio(1.0, 1.0));
    let (mut t, mut x, mut v, mut a) = (zero, [one], [one], [zero]);
    let (mut lost_x, mut lost_v) = (zero, zero);
    for _ in 0..n {
        ExponentialGrowth::accelerations(&constants, t, &[], &x, &v, &mut a).expect("a constant mass");
        let (dx, dv) = (h * v[0], h * a[0]);
        match sum {
            Sum::Plain => {
                x[0] = x[0] + dx;
                v[0] = v[0] + dv;
            }
            Sum::Compensated => {
                (x[0], lost_x) = add(x[0], dx + lost_x);
                (v[0], lost_v) = add(v[0], dv + lost_v);
            }
        }
        t = t + h;
    }
    v[0].into()
}

/// The rounded sum, and what rounding took from the increment.
fn add<S: Real>(value: S, increment: S) -> (S, S) {
    let sum = value + increment;
    (sum, increment - (sum - value))
}

/// What n steps would give without rounding: (1 + h)ⁿ with h = 1/n as rounded.
fn exact_euler<S: Real + Into<f64>>(n: u64) -> f64 {
    let h: f64 = S::ratio(1.0, n as f64).into();
    (n as f64 * h.ln_1p()).exp()
}

/// |v(1) − e| and the round-off alone: root mean squares over `count` numbers of steps from n on, 1.3 % apart
/// (at a power of two, h and its multiples are exact, and the error is not typical).
pub fn errors<S: Real + Into<f64>>(n: u64, count: u64, sum: Sum) -> (f64, f64) {
    let (mut total, mut rounding) = (0.0, 0.0);
    for j in 0..count {
        let steps = n + (0.013 * (n * j) as f64) as u64 + j;
        let v = euler::<S>(steps, sum);
        total += (v - E).powi(2);
        rounding += (v - exact_euler::<S>(steps)).powi(2);
    }
    ((total / count as f64).sqrt(), (rounding / count as f64).sqrt())
}
