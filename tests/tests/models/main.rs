//! The library of mechanisms, against reference numbers and closed forms.

mod chains;
mod constrained;
mod digits;
mod interpreted;
mod invariants;
mod momentum;
mod oscillators;
mod particles;
mod pendulums;
mod remembering;
mod rolling;
mod space;
mod turntables;

/// Asserts that two numbers agree.
#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs();
    assert!(error <= tolerance, "{found} is not {expected}: off by {error:e}, more than {tolerance:e}");
}
