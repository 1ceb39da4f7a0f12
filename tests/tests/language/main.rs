//! What docs/LANGUAGE.md promises of runs, sentence by sentence.

mod changing_mass;
mod constraints;
mod contacts;
mod events;
mod held_out;
mod joints;
mod loops;
mod phases;
mod refusals;
mod twins;
mod whole_files;

/// Asserts that two numbers agree.
#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs();
    assert!(error <= tolerance, "{found} is not {expected}: off by {error:e}, more than {tolerance:e}");
}
