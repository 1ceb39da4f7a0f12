//! Masses, inertias and inputs one by one: predicted beside verified.

use dalembert::needs::{ModelReduction, Needs, NeedsRequest, Verdict};

use super::{CRANE, QUARTER_CAR, asked, found, oscillator, reduction};

/// Predicted over verified, where the law is said to hold.
fn ratio(reduction: &ModelReduction) -> Option<f64> {
    let predicted = reduction.predicted.filter(|predicted| predicted.holds())?;
    Some(predicted.change / reduction.deviation.as_ref()?.largest)
}

fn judged(needs: &Needs, ingredient: &str) -> f64 {
    let ratio = ratio(reduction(needs, ingredient)).unwrap_or_else(|| panic!("{ingredient}\n{}", needs.table()));
    assert!((0.5..2.0).contains(&ratio), "{ingredient}: {ratio}\n{}", needs.table());
    reduction(needs, ingredient).deviation.as_ref().expect("compared").phase_error
}

/// A bob of some size on a rod of some mass.
fn pendulum(r: f64, e: f64) -> String {
    format!(
        "name: Swinging
parameters: {{m: 1 kg, L: 1 m, r: {r} m, e: {e}, g: 9.81 m/s^2}}
coordinates: {{theta: rad}}
define: {{down: \"[sin(theta), -cos(theta)]\"}}
bodies:
  bob: {{mass: m, inertia: 2*m*r^2/5, angle: theta, position: L*down}}
  rod: {{mass: e*m, inertia: e*m*L^2/12, angle: theta, position: L*down/2}}
gravity: [0, -g]
scene: {{start: {{theta: 0.5}}, until: 10, tolerance: 1e-8}}
"
    )
}

#[test]
fn a_bob_without_its_size_is_faster_by_r2_over_5_l2() {
    // Stability catalogue, F7.
    for r in [0.01, 0.03, 0.1] {
        let needs = found(&pendulum(r, 0.0), "theta");
        let (phase_error, law) = (judged(&needs, "bodies.bob.inertia"), r * r / 5.0);
        assert!((phase_error / law - 1.0).abs() < 0.05, "{phase_error} {law}");
    }
    let large = found(&pendulum(0.7, 0.0), "theta");
    assert_eq!(ratio(reduction(&large, "bodies.bob.inertia")), None, "{}", large.table());
}

#[test]
fn a_pendulum_without_its_rods_mass_is_slower_by_a_twelfth_of_it() {
    // Stability catalogue, F7: T changes by √((1 + e/3)/(1 + e/2)) − 1 ≈ −e/12.
    for e in [1e-4, 1e-3, 1e-2] {
        let needs = found(&pendulum(0.01, e), "theta");
        let phase_error = judged(&needs, "bodies.rod");
        assert!((phase_error / (-e / 12.0) - 1.0).abs() < 0.05, "{phase_error} {e}");
        // Its parts: inertia e/12 of m L² makes it slow by e/24; the mass at L/2 makes it fast by e/8.
        let parts = [judged(&needs, "bodies.rod.inertia"), judged(&needs, "bodies.rod.mass")];
        assert!((parts[0] / (e / 24.0) - 1.0).abs() < 0.05 && (parts[1] / (-e / 8.0) - 1.0).abs() < 0.05, "{parts:?}");
    }
}

#[test]
fn the_inertia_of_a_load_is_felt_and_a_small_mass_between_springs_gives_way_to_a_balance() {
    let crane = asked(&NeedsRequest::new(CRANE)).unwrap();
    judged(&crane, "bodies.load.inertia");
    // The study's: 2.0e-3 of the swing.
    let load = reduction(&crane, "bodies.load.inertia").deviation.as_ref().expect("compared").largest;
    assert!((1.5e-3..2.5e-3).contains(&load), "{load}");
    let car = asked(&NeedsRequest::new(QUARTER_CAR)).unwrap();
    // Without its mass the emblem is where its spring and damper balance: (me/mb) of the body's motion, and nothing rings.
    let emblem = reduction(&car, "bodies.E.mass");
    let change = emblem.deviation.as_ref().expect("compared").largest;
    assert!(emblem.verdict == Verdict::Serves && (1e-4..1e-3).contains(&change), "{}", car.table());
    // The wheel's balance would hold the rate of the road.
    match &reduction(&car, "bodies.W.mass").verdict {
        Verdict::Refused { why } => assert!(why.contains("no mass"), "{why}"),
        other => panic!("{other}"),
    }
}

#[test]
fn an_input_at_rest_changes_what_it_drives_in_proportion() {
    let driven = |amplitude: &str| {
        oscillator(&format!(
            "inputs: {{floor: \"{amplitude}*A*sin(0.3*t/T)\"}}
forces: {{lift: {{on: b, force: \"[k*floor - 0.1*k*x^3/A^2, 0]\"}}}}
scene: {{start: {{x: 1}}, until: 20, tolerance: 1e-8}}"
        ))
    };
    let changes = ["1e-4", "1e-3", "1e-2"].map(|amplitude| {
        let needs = found(&driven(amplitude), "x");
        judged(&needs, "inputs.floor");
        reduction(&needs, "inputs.floor").deviation.as_ref().expect("compared").largest
    });
    assert!((9.0..11.0).contains(&(changes[1] / changes[0])) && (9.0..11.0).contains(&(changes[2] / changes[1])));
    let weak = found(&driven("1e-4"), "x");
    assert_eq!(reduction(&weak, "inputs.floor").verdict, Verdict::Serves, "{}", weak.table());
    let text = weak.smaller_file().expect("a file");
    assert!(text.contains("inputs: {floor: ") && !text.contains("sin(0.3*t/T)"), "{text}");
    // Where nothing moves there is nothing to hold.
    assert!(found(&driven("0"), "x").reductions.iter().all(|reduction| reduction.ingredient != "inputs.floor"));
}
