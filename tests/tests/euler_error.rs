//! Truncation and round-off of Euler's method (cases R1 to R4 of the catalogue of failures).

use std::f64::consts::E;

use dalembert_tests::euler::{Sum, errors, euler};

/// While truncation rules, the error is e/(2n).
#[test]
fn truncation_falls_as_one_over_the_number_of_steps() {
    for exponent in [8, 12, 16, 20] {
        let n = 1 << exponent;
        let scaled = (E - euler::<f64>(n, Sum::Plain)) * 2.0 * n as f64 / E;
        assert!((scaled - 1.0).abs() < 1.5 / n as f64 + 1e-5, "2^{exponent} steps: {scaled}");
    }
}

/// R1: in `f64` round-off is a random walk, 1.3e-13 at 2²⁰ steps (within a factor 2), so the optimum is out of reach.
#[test]
fn rounding_in_f64_is_a_random_walk() {
    let (_, rounding) = errors::<f64>(1 << 20, 9, Sum::Plain);
    assert!(rounding > 0.65e-13 && rounding < 2.6e-13, "{rounding:e}");
}

/// R2: in `f32` the least error is 2.8e-5, at 2¹⁶ steps; ten times as many steps are a hundred times worse.
#[test]
fn the_best_number_of_steps_in_f32_is_two_to_the_sixteen() {
    let total = |exponent: u32| errors::<f32>(1 << exponent, 15, Sum::Plain).0;
    let errors: Vec<(u32, f64)> = (12..=20).map(|exponent| (exponent, total(exponent))).collect();
    let best = errors.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1)).expect("errors");
    assert!((15..=17).contains(&best.0), "{errors:?}");
    assert!(best.1 > 1.4e-5 && best.1 < 5.6e-5, "{errors:?}");
    let (_, worst) = errors[8];
    assert!(worst > 2.7e-3 && worst < 1.1e-2, "{errors:?}");
}

/// R3: from 2²⁴ steps on an `f32` does not move at all.
#[test]
fn too_many_steps_in_f32_stand_still() {
    assert_eq!(euler::<f32>(1 << 24, Sum::Plain), 1.0);
}

/// R4: compensated summation leaves only the truncation and a rounding of the result.
#[test]
fn compensated_summation_removes_the_floor() {
    let n = 1 << 24;
    let truncation = E / (2.0 * n as f64);
    let error = (euler::<f32>(n, Sum::Compensated) - E).abs();
    assert!(error < truncation + 2e-7, "{error:e}");
}
