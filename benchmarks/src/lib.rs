//! Equations of motion as a person writes them, and what all benchmarks share.

#[cfg(feature = "peers")]
pub mod peers;

use std::time::Instant;

use ode_solvers::{SVector, System as Equations};

/// Equations of motion that a person wrote.
pub struct Hand<const D: usize>(pub fn(&SVector<f64, D>, &mut SVector<f64, D>));

impl<const D: usize> Equations<f64, SVector<f64, D>> for Hand<D> {
    fn system(&self, _: f64, y: &SVector<f64, D>, rate: &mut SVector<f64, D>) {
        (self.0)(y, rate);
    }
}

pub fn figure_eight(y: &SVector<f64, 12>, rate: &mut SVector<f64, 12>) {
    let mut a = [0.0; 6];
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let (dx, dy) = (y[j] - y[i], y[3 + j] - y[3 + i]);
        let square = dx * dx + dy * dy;
        let factor = 1.0 / (square * square.sqrt());
        a[i] += factor * dx;
        a[j] -= factor * dx;
        a[3 + i] += factor * dy;
        a[3 + j] -= factor * dy;
    }
    for i in 0..6 {
        (rate[i], rate[6 + i]) = (y[6 + i], a[i]);
    }
}

pub fn kepler(y: &SVector<f64, 4>, rate: &mut SVector<f64, 4>) {
    let square = y[0] * y[0] + y[1] * y[1];
    let factor = -1.0 / (square * square.sqrt());
    (rate[0], rate[1], rate[2], rate[3]) = (y[2], y[3], factor * y[0], factor * y[1]);
}

/// A bob on a spring of k = 10⁶ N/m with a damper of d N s/m beside it.
pub fn stiff_pendulum<const DAMPING: u32>(y: &SVector<f64, 4>, rate: &mut SVector<f64, 4>) {
    let square = y[0] * y[0] + y[1] * y[1];
    let one_over_r = 1.0 / square.sqrt();
    let turning = f64::from(DAMPING) * (y[0] * y[2] + y[1] * y[3]) * one_over_r * one_over_r;
    let factor = 1e6 * (one_over_r - 1.0) - turning;
    (rate[0], rate[1], rate[2], rate[3]) = (y[2], y[3], factor * y[0], factor * y[1] - 10.0);
}

/// Its Jacobian.
pub fn stiff_jacobian<const DAMPING: u32>(y: &SVector<f64, 4>) -> [[f64; 4]; 4] {
    let (x, y, u, v) = (y[0], y[1], y[2], y[3]);
    let d = f64::from(DAMPING);
    let square = x * x + y * y;
    let one_over_r = 1.0 / square.sqrt();
    let rate = (x * u + y * v) / square;
    let factor = 1e6 * (one_over_r - 1.0) - d * rate;
    let along = |q: f64, w: f64| -(1e6 * q * one_over_r + d * (w - 2.0 * rate * q)) / square;
    let (by_x, by_y) = (along(x, u), along(y, v));
    let (by_u, by_v) = (-d * x / square, -d * y / square);
    [
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
        [factor + x * by_x, x * by_y, x * by_u, x * by_v],
        [y * by_x, factor + y * by_y, y * by_u, y * by_v],
    ]
}

pub fn stiff_spring(y: &SVector<f64, 4>, rate: &mut SVector<f64, 4>) {
    let factor = 1e5 * (1.0 / (y[0] * y[0] + y[1] * y[1]).sqrt() - 1.0);
    (rate[0], rate[1], rate[2], rate[3]) = (y[2], y[3], factor * y[0], factor * y[1] - 10.0);
}

pub fn double_pendulum(y: &SVector<f64, 4>, rate: &mut SVector<f64, 4>) {
    let (sine, cosine) = (y[0] - y[1]).sin_cos();
    let (m11, m12, m22) = (4.0 / 3.0, 0.5 * cosine, 1.0 / 3.0);
    let f1 = -0.5 * sine * y[3] * y[3] - 15.0 * y[0].sin();
    let f2 = 0.5 * sine * y[2] * y[2] - 5.0 * y[1].sin();
    let factor = 1.0 / (m11 * m22 - m12 * m12);
    (rate[0], rate[1]) = (y[2], y[3]);
    (rate[2], rate[3]) = (factor * (m22 * f1 - m12 * f2), factor * (m11 * f2 - m12 * f1));
}

/// A chain of uniform rods in absolute angles: M in product form, LDLᵀ.
pub fn rods<const N: usize, const D: usize>(y: &SVector<f64, D>, rate: &mut SVector<f64, D>) {
    let (mut s, mut c, mut a) = ([0.0; N], [0.0; N], [0.0; N]);
    for i in 0..N {
        (s[i], c[i]) = y[i].sin_cos();
    }
    let mut mass = [[0.0; N]; N];
    for i in 0..N {
        let beyond = (N - 1 - i) as f64;
        mass[i][i] = 1.0 / 3.0 + beyond;
        a[i] = -10.0 * (0.5 + beyond) * s[i];
    }
    for i in 0..N {
        let k = 0.5 + (N - 1 - i) as f64;
        for j in 0..i {
            mass[i][j] = k * (c[i] * c[j] + s[i] * s[j]);
            let turning = k * (s[i] * c[j] - c[i] * s[j]);
            a[i] -= turning * y[N + j] * y[N + j];
            a[j] += turning * y[N + i] * y[N + i];
        }
    }
    for i in 0..N {
        for j in 0..i {
            for k in 0..j {
                mass[i][j] -= mass[i][k] * mass[j][k];
            }
        }
        for j in 0..i {
            let factor = mass[i][j] * mass[j][j];
            mass[i][i] -= factor * mass[i][j];
            mass[i][j] = factor;
            a[i] -= factor * a[j];
        }
        mass[i][i] = 1.0 / mass[i][i];
    }
    for i in (0..N).rev() {
        a[i] *= mass[i][i];
        for j in i + 1..N {
            a[i] -= mass[j][i] * a[j];
        }
    }
    for i in 0..N {
        (rate[i], rate[N + i]) = (y[N + i], a[i]);
    }
}

/// How many seconds this takes, and what it gives.
pub fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let clock = Instant::now();
    let result = work();
    (clock.elapsed().as_secs_f64(), result)
}

/// The one in the middle.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}
