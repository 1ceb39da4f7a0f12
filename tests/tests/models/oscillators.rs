//! Vibrations of one degree of freedom, and what excites them.

use std::f64::consts::PI;

use dalembert_tests::case::Case;

use super::near;

/// Solution of x'' + x' + x = A cos ωt + B sin ωt from rest at 0, at time t.
///
/// Particular: x = P cos ωt + Q sin ωt with (1 − ω²) P + ω Q = A and (1 − ω²) Q − ω P = B; the rest decays as
/// e^(−t/2) and swings with ω_d = √3/2.
fn from_rest(a: f64, b: f64, omega: f64, t: f64) -> f64 {
    let stiff = 1.0 - omega * omega;
    let norm = stiff * stiff + omega * omega;
    let (p, q) = ((stiff * a - omega * b) / norm, (stiff * b + omega * a) / norm);
    let damped = 0.75_f64.sqrt();
    let (c, s) = (-p, (-q * omega - p / 2.0) / damped);
    p * (omega * t).cos() + q * (omega * t).sin() + (-t / 2.0).exp() * (c * (damped * t).cos() + s * (damped * t).sin())
}

#[test]
fn the_four_excitations_have_the_forcing_of_the_textbook() {
    // With m = c = k = 1, amplitudes 1 and ω = 2: A = c δ ω of the dashpot's end, B = F₀ or k δ.
    for (scene, a, b) in
        [("scene", 0.0, 1.0), ("dashpot_end", 2.0, 0.0), ("spring_end", 0.0, 1.0), ("both_ends", 2.0, 1.0)]
    {
        let mut case = Case::new("base_excitation").scene(scene).tolerance(1e-13);
        for t in [1.0, 7.0, 20.0] {
            near(case.state_at(t)["x"], from_rest(a, b, 2.0, t), 1e-11);
        }
    }
}

/// Problem 21 b: periods from events; ω_n = √(k/m), ω_d = ω_n √(1 − ζ²), and the logarithmic decrement gives ζ.
#[test]
fn frequencies_and_damping_are_measured_by_events() {
    let peaks = |scene: &str| {
        let run = Case::new("base_excitation").scene(scene).tolerance(1e-13).run();
        run.events.iter().map(|event| (event.state.t, event.state["x"])).collect::<Vec<_>>()
    };
    let free = peaks("free");
    near(free[1].0 - free[0].0, 2.0 * PI, 1e-10);
    let damped = peaks("ring_down");
    near(2.0 * PI / (damped[1].0 - damped[0].0), 0.75_f64.sqrt(), 1e-10);
    let decrement = (damped[0].1 / damped[1].1).ln();
    near(decrement / (4.0 * PI * PI + decrement * decrement).sqrt(), 0.5, 1e-10);
}

/// The guess x (L − x) oscillates with √10 c/L, 0.66 % above the string's π c/L.
#[test]
fn the_guessed_shape_of_a_string_oscillates_with_the_square_root_of_ten() {
    let mut case = Case::new("string_rayleigh").tolerance(1e-13);
    for t in [0.3, 1.0, 3.0] {
        near(case.state_at(t)["b"], 0.8 * (10.0_f64.sqrt() * t).cos(), 1e-11);
    }
}
