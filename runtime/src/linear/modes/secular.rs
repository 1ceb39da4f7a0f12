//! Secular modes: eigenvalues that coincide and have one shape between them.

use nalgebra::Complex;

use super::damped::likeness;
use super::{Kind, Mode};

/// Rounding splits a double eigenvalue with one shape by √ε, relatively, and some times that.
const SPLIT: f64 = 1e-6;
/// The shapes of what it splits differ by the square of about as much.
const PARALLEL: f64 = 1e-9;

/// Finds groups of oscillations with one eigenvalue and one shape, and gives each its mean, which rounding does not
/// move; modes must be sorted.  `undamped`: nothing dissipates.
pub fn merge(modes: &mut [Mode], undamped: bool) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for k in 0..modes.len() {
        if modes[k].eigenvalue.im == 0.0 {
            continue;
        }
        match groups.iter_mut().find(|group| same(&modes[group[0]], &modes[k])) {
            Some(group) => group.push(k),
            None => groups.push(vec![k]),
        }
    }
    groups.retain(|group| group.len() > 1);
    for group in &groups {
        let sum: Complex<f64> = group.iter().map(|k| modes[*k].eigenvalue).sum();
        let mut mean = sum / group.len() as f64;
        if undamped && mean.re.abs() <= SPLIT * SPLIT.sqrt() * mean.norm() {
            mean.re = 0.0;
        }
        for &k in group {
            let mode = &mut modes[k];
            (mode.eigenvalue, mode.omega, mode.secular) = (mean, mean.norm(), true);
            mode.zeta = Some(-mean.re / mean.norm());
            mode.kind = match () {
                () if mean.re > 0.0 => Kind::Unstable,
                () if mean.re < 0.0 => Kind::Damped,
                () => Kind::Oscillating,
            };
        }
    }
    groups
}

fn same(a: &Mode, b: &Mode) -> bool {
    let near = (a.eigenvalue - b.eigenvalue).norm() <= SPLIT * a.eigenvalue.norm();
    near && likeness(&a.shape, &b.shape) > 1.0 - PARALLEL
}
