//! Masses and springs: chains, rings and frames.

use std::f64::consts::{PI, SQRT_2};

use dalembert_tests::case::Case;
use dalembert_tests::reference::{Reference, number};

use super::near;

/// Started in a mode shape, all masses move as cos ωt.
#[test]
fn three_masses_swing_in_their_modes() {
    let reference = Reference::load("B18");
    let (omega, shapes) = (reference.list("undamped_omega"), reference.matrix("undamped_modes"));
    for (mode, (scene, amplitude)) in
        [("scene", 0.2), ("second_mode", 0.3), ("third_mode", 0.2)].into_iter().enumerate()
    {
        let last = Case::new("three_masses").scene(scene).tolerance(1e-13).run().last();
        for (name, shape) in ["x[1]", "x[2]", "x[3]"].into_iter().zip(&shapes[mode]) {
            near(last[name], amplitude * shape * (omega[mode] * last.t).cos(), 1e-11);
        }
    }
}

/// Displaced by 1 at the first mass: a quarter of the first mode, half of the second, a quarter of the third.
#[test]
fn three_masses_beat_when_one_is_displaced() {
    let omega = Reference::load("B18").list("undamped_omega");
    let last = Case::new("three_masses").scene("first_displaced").tolerance(1e-13).run().last();
    let parts = [0.25, 0.5, 0.25].into_iter().zip(omega).map(|(weight, omega)| weight * (omega * last.t).cos());
    near(last["x[1]"], 0.5 * parts.sum::<f64>(), 1e-11);
}

/// Small swings have ω² = (2 ∓ √2) g/l; at 0.05 rad the frequency is lower by parts in a thousand.
#[test]
fn double_pendulum_of_points_swings_synchronously() {
    for (scene, omega) in [("scene", (20.0 - 10.0 * SQRT_2).sqrt()), ("fast_mode", (20.0 + 10.0 * SQRT_2).sqrt())] {
        let start = Case::new("double_pendulum_points").scene(scene).run().first();
        let half = Case::new("double_pendulum_points").scene(scene).state_at(PI / omega);
        for name in ["theta1", "theta2"] {
            near(half[name], -start[name], 1e-3 * start[name].abs());
        }
    }
}

/// When the slow mode of two points on rods, let go at this amplitude, first passes through rest.
///
/// Its coordinate is uᵀ M θ with u = (1, √2) and M ~ (2 1; 1 1): the other mode has no part in it.
fn quarter_period(amplitude: f64) -> f64 {
    let case = Case::new("double_pendulum_points").until(1.0).tolerance(1e-13);
    let run = case.start("theta1", amplitude).start("theta2", SQRT_2 * amplitude).run();
    let mode = |t: f64| {
        let state = run.at(t).expect("dense output");
        (2.0 + SQRT_2) * state["theta1"] + (1.0 + SQRT_2) * state["theta2"]
    };
    let (mut low, mut high) = (0.0, 1.0);
    assert!(mode(low) > 0.0 && mode(high) < 0.0);
    for _ in 0..50 {
        let middle = (low + high) / 2.0;
        if mode(middle) > 0.0 { low = middle } else { high = middle }
    }
    low
}

/// Problem 24: the period's departure from that of the linear mode grows as the square of the amplitude.
#[test]
fn the_departure_from_the_linear_mode_grows_as_the_amplitude_squared() {
    let linear = PI / 2.0 / (20.0 - 10.0 * SQRT_2).sqrt();
    let departure = |amplitude: f64| quarter_period(amplitude) / linear - 1.0;
    let (small, middle, large) = (departure(0.05), departure(0.1), departure(0.2));
    assert!(small > 0.0, "slower, as a pendulum is");
    near(middle / small, 4.0, 0.05);
    near(large / middle, 4.0, 0.2);
}

/// Drift (1, 1, 1) and the modes (1, 0, −1), (1, −2, 1) of a chain that is thrown and displaced at one end.
#[test]
fn a_free_chain_drifts_and_vibrates() {
    let last = Case::new("free_chain").tolerance(1e-13).run().last();
    let wave = |omega: f64| 0.5 * (omega * last.t).cos() + 0.3 / omega * (omega * last.t).sin();
    let (drift, second, third) = ((0.5 + 0.3 * last.t) / 3.0, wave(1.0) / 2.0, wave(3.0_f64.sqrt()) / 6.0);
    near(last["x[1]"], drift + second + third, 1e-11);
    near(last["x[2]"], drift - 2.0 * third, 1e-11);
    near(last["x[3]"], drift - second + third, 1e-11);
}

/// Without rotation the stretch is s₀ cos ωt with ω² = k (m₁ + m₂)/(m₁ m₂).
#[test]
fn two_masses_in_space_stretch_with_the_reduced_mass() {
    let mut case = Case::new("two_masses_3d").tolerance(1e-13);
    for rate in ["y[1]'", "y[2]'", "z[1]'"] {
        case = case.start(rate, 0.0);
    }
    near(case.state_at(7.0)["length"], 1.0 + 0.2 * (1.5_f64.sqrt() * 7.0).cos(), 1e-11);
}

/// A regular figure that breathes stays regular, so its springs stretch in proportion: u = u₀ cos ωt at any amplitude.
#[test]
fn regular_figures_breathe_harmonically() {
    for (name, member, omega) in [
        ("triangle_springs", "x[3]", 3.0_f64.sqrt()),
        ("square_springs", "x[4]", SQRT_2),
        ("hexagon_springs", "x[6]", 1.0),
    ] {
        let mut case = Case::new(name).tolerance(1e-13);
        for t in [1.0, 8.0] {
            near(case.state_at(t)[member], 0.1 * (omega * t).cos(), 1e-10);
        }
    }
}

/// The wave x = 0.2 cos(4π i/n − ωt) with ω = 2 sin(2π/n) travels without changing its shape.
#[test]
fn a_wave_travels_along_the_periodic_chain() {
    let omega = Reference::load("B20").scalars()["periodic_chain_omega_j_0_to_n_minus_1"]["12"][2].clone();
    let last = Case::new("periodic_chain").tolerance(1e-13).run().last();
    for i in 1..=12 {
        let phase = 4.0 * PI * f64::from(i) / 12.0 - number(&omega) * last.t;
        near(last[format!("x[{i}]").as_str()], 0.2 * phase.cos(), 1e-10);
    }
}

#[test]
fn a_chain_with_one_damper_follows_the_reference() {
    let mut case = Case::new("damped_chain").scene("one_damper").tolerance(1e-13);
    case.compare(&Reference::load("B18"), &[], |_| 1e-12);
}

/// Dampers beside all springs leave the modes as they are: from rest each is e^(at) (cos bt − a/b sin bt).
#[test]
fn a_chain_with_parallel_dampers_decays_by_modes() {
    let eigenvalues = Reference::load("B18").matrix("damped_parallel_c_0_2_eigenvalues_re_im");
    let last = Case::new("damped_chain").scene("parallel").tolerance(1e-13).run().last();
    let parts = [0.25, 0.5, 0.25].into_iter().zip(&eigenvalues).map(|(weight, pair)| {
        let (a, b, t) = (pair[0], pair[1], last.t);
        weight * (a * t).exp() * ((b * t).cos() - a / b * (b * t).sin())
    });
    near(last["x[1]"], parts.sum(), 1e-11);
}

#[test]
fn a_forced_chain_follows_the_reference() {
    let reference = Reference::load("B18");
    for (scene, states) in [("resonance", "forced_on_mass_1_from_rest"), ("middle", "forced_on_middle_mass_from_rest")]
    {
        let mut case = Case::new("forced_chain").scene(scene).tolerance(1e-13);
        case.compare_states(&reference.states_of(states), &[], |_| 1e-11);
    }
}

/// Plucked in a mode shape by a millionth, where the lengths change by parts in 10¹², ten beads swing with the
/// frequencies of the reference.
#[test]
fn a_string_of_beads_has_the_frequencies_of_the_reference() {
    for count in 1..=2_u32 {
        let omega = number(
            &Reference::load("B20").scalars()["string_n_equal_masses_omega_first3_in_c_over_L"]["10"]
                [count as usize - 1],
        );
        let mut case = Case::new("string_masses").tolerance(1e-13);
        let shape = |i: u32| 1e-6 * (PI * f64::from(count * i) / 11.0).sin();
        for i in 1..=10 {
            case = case.start(&format!("y[{i}]"), shape(i));
        }
        let last = case.state_at(2.3);
        for i in 1..=10 {
            near(last[format!("y[{i}]").as_str()], shape(i) * (omega * 2.3).cos(), 1e-13);
        }
    }
}

/// Started on its steady motion x = T Y cos(wt + phase), the machine stays on it.
#[test]
fn vibration_isolation_has_the_transmissibility_of_the_reference() {
    let table = Reference::load("B21").scalars()["table"].clone();
    for row in table.as_array().expect("a table") {
        let [zeta, r, gain, phase] = ["zeta", "r", "T", "phase_rad"].map(|name| number(&row[name]));
        let mut case = Case::new("vibration_isolation").set("c", 2.0 * zeta).set("w", r).set("Y", 1.0).tolerance(1e-13);
        case = case.start("x", gain * phase.cos()).start("x'", -gain * r * phase.sin());
        near(case.state_at(6.0)["x"], gain * (6.0 * r + phase).cos(), 1e-11);
    }
}

/// Mean frequency of an oscillator over the second half of its peaks, and the last peak's height.
fn frequency(run: &dalembert::Run, event: &str, coordinate: &str) -> (f64, f64) {
    let peaks: Vec<_> = run.events.iter().filter(|e| e.name == event && e.state.t > run.last().t / 2.0).collect();
    let (first, last) = (peaks[0], peaks[peaks.len() - 1]);
    (2.0 * PI * (peaks.len() - 1) as f64 / (last.state.t - first.state.t), last.state[coordinate])
}

/// Alone, a van der Pol oscillator ends on a cycle of amplitude 2; coupled strongly, two of them share a frequency.
#[test]
fn coupled_oscillators_lock_or_drift() {
    let run = Case::new("coupled_oscillators").scene("alone").run();
    near(frequency(&run, "x_peak", "x").1, 2.0, 1e-3);
    let run = Case::new("coupled_oscillators").until(400.0).run();
    near(frequency(&run, "x_peak", "x").0, frequency(&run, "y_peak", "y").0, 1e-4);
    let run = Case::new("coupled_oscillators").scene("drift").run();
    let apart = frequency(&run, "y_peak", "y").0 - frequency(&run, "x_peak", "x").0;
    assert!(apart > 0.02, "{apart}");
}
