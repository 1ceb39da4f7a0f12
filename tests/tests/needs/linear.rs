//! Laws and whole models made linear: predicted beside verified, and what is left alone.

use dalembert::needs::{Law, ModelReduction, Needs, NeedsRequest, Proposal, Verdict};

use super::{QUARTER_CAR, asked, chosen, found, oscillator};

fn pendulum(amplitude: f64, mass: &str, length: &str) -> String {
    format!(
        "name: Pendulum
parameters: {{m: {mass} kg, L: {length} m, g: {length} m/s^2}}
coordinates: {{theta: rad}}
points: {{P: \"L*[sin(theta), -cos(theta)]\"}}
bodies: {{bob: {{mass: m, position: P}}}}
gravity: [0, -g]
balances:
  equations: [{{moment: {{about: \"[0, 0]\", of: [bob]}}}}]
conserved: {{energy: energy}}
outputs: {{side: P.x, speed: velocity(bob)}}
draw: [{{line: [\"[0, 0]\", bob]}}]
scene: {{start: {{theta: {amplitude}}}, until: 30, tolerance: 1e-8}}
"
    )
}

fn linear<'a>(needs: &'a Needs, ingredient: &str) -> Option<&'a ModelReduction> {
    needs
        .reductions
        .iter()
        .find(|reduction| reduction.ingredient == ingredient && reduction.proposal == Proposal::Linear)
}

/// Predicted, whether that holds, with which power of the amplitude, and verified.
fn judged(reduction: &ModelReduction) -> (f64, bool, f64, f64) {
    let predicted = reduction.predicted.expect("a prediction");
    let Law::Linear { power, .. } = predicted.law else { panic!("{predicted:?}") };
    (predicted.change, predicted.holds(), power, reduction.deviation.as_ref().expect("compared").largest)
}

#[test]
fn a_pendulum_made_linear_is_faster_by_theta2_over_16() {
    // Stability catalogue, F2.
    for (amplitude, mass, length) in
        [(0.01, "1", "1"), (0.03, "1e-12", "1e12"), (0.03, "1e12", "1e-12"), (0.1, "1", "1")]
    {
        let needs = found(&pendulum(amplitude, mass, length), "theta");
        let reduction = linear(&needs, "equations").unwrap_or_else(|| panic!("{}", needs.table()));
        let (predicted, holds, power, change) = judged(reduction);
        assert!(holds && (0.5..2.0).contains(&(predicted / change)), "{amplitude}: {predicted} {change}");
        assert!((power - 2.0).abs() < 0.01, "{power}");
        let phase_error = reduction.deviation.as_ref().expect("compared").phase_error;
        assert!((phase_error / (amplitude * amplitude / 16.0) - 1.0).abs() < 0.01, "{amplitude}: {phase_error}");
        assert_eq!(reduction.verdict == Verdict::Serves, amplitude < 0.05, "{}", needs.table());
    }
    let small = found(&pendulum(0.01, "1", "1"), "theta");
    let choice = chosen(&small);
    assert!(choice.members == ["equations"] && choice.saving > 4.0, "{}", small.table());
    assert!(choice.gone.iter().any(|(claim, _)| claim == "balances") && choice.moved.is_some_and(|off| off < 1e-3));
    let text = small.smaller_file().expect("a file");
    let written = "kinetic_energy: 1/2*m*L^2*theta'^2\npotential_energy: 1/2*m*L*g*theta^2\npoints: {bob: P, P:";
    assert!(text.contains(written) && text.contains("conserved: {energy: energy}"), "{text}");
    let again = found(&text, "theta");
    assert!(linear(&again, "equations").is_none(), "{}", again.table());
    // At 1 rad it is late by whole swings: nothing is predicted, and the table says why.
    let large = found(&pendulum(1.0, "1", "1"), "theta");
    let reduction = linear(&large, "equations").unwrap();
    assert!(!judged(reduction).1 && reduction.verdict == Verdict::Acts, "{}", large.table());
    assert!(large.table().contains("; no law: it grows with the amplitude to the power 1.9"), "{}", large.table());
    // About the upper equilibrium, as long as it is near that.
    let upper = found(&pendulum(3.13, "1", "1").replace("until: 30", "until: 0.5"), "theta");
    let (predicted, holds, _, change) = judged(linear(&upper, "equations").unwrap());
    assert!(holds && (0.5..2.0).contains(&(predicted / change)) && change < 1e-3, "{}", upper.table());
    assert!(upper.smaller_file().is_some_and(|text| text.contains("theta_rest: 3.14159265 rad")), "{}", upper.table());
}

#[test]
fn a_progressive_strut_is_a_spring_where_it_moves_little() {
    let air = "  air: {on: B, force: \"[0, -ca*body'*abs(body')]\"}";
    let strut = "  strut: {stretch: body - wheel, stiffness: ks, along: \"[0, 1]\", on: B, from: W}\n";
    let by_force = |kp: &str| {
        QUARTER_CAR
            .replace(air, "  progress: {on: B, from: W, force: \"[0, -kp*(body - wheel)^3]\"}")
            .replace("ca: 1e-3 N*s^2/m^2    # air", &format!("kp: {kp} N/m^3"))
    };
    let by_length = QUARTER_CAR
        .replace(&format!("forces:\n{air}\n"), "")
        .replace(strut, "  strut: {between: [B, W], tension: ks*(length - l_0)*(1 + b*(length - l_0)^2)}\n")
        .replace("[0, body", "[0, l_0 + body")
        .replace("ca: 1e-3 N*s^2/m^2    # air", "l_0: 1 m\n  b: 0.1 1/m^2");
    for (file, ingredient) in [(by_force("2e3"), "forces.progress"), (by_length, "springs.strut")] {
        let needs = asked(&NeedsRequest::new(file)).unwrap_or_else(|error| panic!("{error}"));
        let reduction = linear(&needs, ingredient).unwrap_or_else(|| panic!("{}", needs.table()));
        let (predicted, holds, power, change) = judged(reduction);
        assert!(holds && (0.8..1.25).contains(&(predicted / change)), "{predicted} {change}");
        // It hangs in its weight, about which a cube is a square first.
        assert!((0.7..1.2).contains(&power) && reduction.verdict == Verdict::Serves, "{}", needs.table());
        // What is between two points has a kink where they meet, and so have the equations with it.
        assert_eq!(linear(&needs, "equations").is_some(), ingredient == "forces.progress", "{}", needs.table());
    }
    // A hundred times as much is no small part.
    let hard = asked(&NeedsRequest::new(by_force("2e5"))).unwrap_or_else(|error| panic!("{error}"));
    let reduction = linear(&hard, "forces.progress").unwrap();
    assert_eq!(reduction.verdict, Verdict::Acts, "{}", hard.table());
}

#[test]
fn even_effects_and_bumpers_are_not_made_linear() {
    // A square has nothing that is linear, and shifts the motion to one side by its own size.
    let square = |part: &str| {
        oscillator(&format!(
            "generalized_forces: {{x: \"-{part}*k*x^2/A\"}}\nscene: {{start: {{x: 0.1}}, until: 20, tolerance: 1e-8}}"
        ))
    };
    for part in ["0.03", "0.3"] {
        let needs = found(&square(part), "x");
        assert!(linear(&needs, "generalized_forces.x").is_none(), "{}", needs.table());
        let reduction = linear(&needs, "equations").unwrap_or_else(|| panic!("{}", needs.table()));
        assert_eq!(reduction.verdict, Verdict::Acts, "{}", needs.table());
        let (predicted, holds, power, change) = judged(reduction);
        assert!((power - 1.0).abs() < 0.01 && (!holds || (0.5..2.0).contains(&(predicted / change))), "{power}");
    }
    // Of a bumper nothing is linear, whether it is touched or not.
    for gap in ["0.5", "2"] {
        let bumper = format!("forces: {{bumper: {{on: b, force: \"[-k*max(0, x - {gap}*A), 0]\"}}}}\n");
        let curved = "generalized_forces: {x: -0.01*k*x^3/A^2}\n";
        let file = oscillator(&format!("{bumper}{curved}scene: {{start: {{x: 1}}, until: 20, tolerance: 1e-8}}"));
        let needs = found(&file, "x");
        assert!(needs.reductions.iter().all(|reduction| reduction.proposal != Proposal::Linear), "{}", needs.table());
        assert_eq!(needs.reductions.iter().filter(|reduction| reduction.ingredient == "forces.bumper").count(), 1);
    }
}

#[test]
fn a_model_in_polar_coordinates_is_made_linear_about_its_length() {
    let polar = |start: &str| {
        format!(
            "name: Polar
parameters: {{m: 2 kg, g: 9.81 m/s^2, L: 1 m, k: 100 N/m}}
coordinates: {{r: m, theta: rad}}
points: {{O: [0, 0]}}
bodies: {{bob: {{mass: m, position: \"r*[sin(theta), -cos(theta)]\"}}}}
gravity: [0, -g]
springs: {{cord: {{between: [O, bob], stiffness: k, rest: L}}}}
scene: {{start: {{{start}}}, until: 20, tolerance: 1e-8}}
"
        )
    };
    let file = polar("theta: 1e-3, r: 1.1965");
    let needs = found(&file, "theta");
    let choice = chosen(&needs);
    assert!(choice.members == ["equations"] && choice.saving > 10.0 && choice.verified < 1e-3, "{}", needs.table());
    let text = needs.smaller_file().expect("a file");
    assert!(text.contains("potential_energy: 1/2*k*(r - r_rest)^2 + 1/2*m*g*r_rest*theta^2"), "{text}");
}

#[test]
fn a_value_with_a_unit_becomes_a_parameter_of_what_is_linear() {
    let file = "name: Inline
parameters: {g: 9.81 m/s^2, L: 1 m}
coordinates: {theta: rad, x: m}
bodies:
  cart: {mass: 2 kg, position: \"[x, 0]\"}
  bob: {mass: 0.2 kg, position: \"[x + L*sin(theta), -L*cos(theta)]\"}
gravity: [0, -g]
springs: {wall: {stretch: x, stiffness: 50 N/m, along: \"[1, 0]\", on: cart}}
scene: {start: {theta: 1e-3, x: 2e-3}, until: 20, tolerance: 1e-8}
";
    let needs = found(file, "x");
    assert_eq!(chosen(&needs).members, ["equations"], "{}", needs.table());
    let text = needs.smaller_file().expect("a file");
    assert!(text.contains("wall_stiffness: 50 N/m") && text.contains("1/2*wall_stiffness*x^2"), "{text}");
}
