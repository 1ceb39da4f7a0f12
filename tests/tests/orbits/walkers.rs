//! What walks and rolls, by references of twenty digits.

use dalembert_tests::told::{near, number, reference, written};
use serde_json::Value;

use super::{holds, multiplied, told};

fn compass(masses: &str) -> String {
    written(&format!(
        "name: Compass\nparameters: {{m1: 5 kg, m2: {masses}, mh: 10 kg, a: 0.5 m, b: 0.5 m, g: 9.81 m/s^2, slope: 3 deg}}\n\
         coordinates: {{x: m, y: m, p: rad, s: rad}}\ndefine: {{l: a + b}}\n\
         points:\n  hip: \"[x, y]\"\n  foot1: \"hip + l*[sin(p), -cos(p)]\"\n  foot2: \"hip + l*[sin(s), -cos(s)]\"\n\
         \x20 g1: \"hip + b*[sin(p), -cos(p)]\"\n  g2: \"hip + b*[sin(s), -cos(s)]\"\n\
         bodies:\n  pelvis: {{mass: mh, position: hip}}\n  leg1: {{mass: m1, inertia: 0, angle: p, position: g1}}\n\
         \x20 leg2: {{mass: m2, inertia: 0, angle: s, position: g2}}\ngravity: g*[sin(slope), -cos(slope)]\n\
         constraints: {{hold1: velocity(foot1), hold2: velocity(foot2)}}\nphases: {{on1: [hold1], on2: [hold2]}}\n\
         events:\n  strike2: {{phase: on1, when: foot2.y - foot1.y, direction: falling, if: foot2.x - foot1.x - 0.1*l, then: on2}}\n\
         \x20 strike1: {{phase: on2, when: foot1.y - foot2.y, direction: falling, if: foot1.x - foot2.x - 0.1*l, then: on1}}\n\
         scene: {{start: {{x: -0.2677, y: 0.9635, p: 0.27, s: -0.27, \"p'\": -1.1, \"s'\": -0.4}}, until: 3, tolerance: 1e-12}}\n"
    ))
}

const STEP: [&str; 6] = ["--at", "strike2", "--exchange", "p=s,on1=on2", "--shift", "x"];

/// A walker with masses, from a plain model file.
#[test]
fn a_compass_walks_down_a_slope() {
    let file = compass("5 kg");
    let found = told(&[&[file.as_str()][..], &STEP].concat()).unwrap();
    let known = &reference("compass_walker")["points"][0];
    holds(&found["start"]["p"], number(&known["alpha"]), 1e-10);
    holds(&found["start"]["p'"], number(&known["stance_rate"]), 1e-10);
    holds(&found["start"]["s'"], number(&known["swing_rate"]), 1e-10);
    holds(&found["period"], 2.0 * number(&known["step_time"]), 1e-10);
    multiplied(&found["multipliers"], &known["multipliers"], 1e-9);
    assert_eq!(found["multipliers"].as_array().unwrap().len(), 3);
    // Legs of other masses are no mirror images of each other.
    let refused = told(&[&[compass("6 kg").as_str()][..], &STEP].concat()).unwrap_err();
    assert!(refused.contains("acceleration of"), "{refused}");
    // Without the exchange a step ends on the other foot.
    let refused = told(&[&file, "--at", "strike2", "--shift", "x"]).unwrap_err();
    assert!(refused.contains("on2"), "{refused}");
    let refused = told(&[&file, "--at", "strike2", "--exchange", "p=s,on1=on2", "--shift", "p"]).unwrap_err();
    assert!(refused.contains("`p` cannot differ"), "{refused}");
}

/// The simplest walker (Garcia and others, 1998), of which only the hip has a mass: here with feet of 10⁻¹².
fn simplest_walker() -> String {
    written(
        "name: Walker\nparameters: {m: 1, beta: 1e-12, l: 1, g: 1, slope: 0.009}\n\
         coordinates: {x: 1, y: 1, p: rad, s: rad}\n\
         points: {hip: \"[x, y]\", foot1: \"hip + l*[sin(p), -cos(p)]\", foot2: \"hip + l*[sin(s), -cos(s)]\"}\n\
         bodies: {pelvis: {mass: m, position: hip}, toe1: {mass: beta, position: foot1}, toe2: {mass: beta, position: foot2}}\n\
         gravity: g*[sin(slope), -cos(slope)]\nconstraints: {hold1: velocity(foot1), hold2: velocity(foot2)}\n\
         phases: {on1: [hold1], on2: [hold2]}\nevents:\n\
         \x20 strike2: {phase: on1, when: foot2.y - foot1.y, direction: falling, if: foot2.x - foot1.x - 0.1*l, then: on2}\n\
         \x20 strike1: {phase: on2, when: foot1.y - foot2.y, direction: falling, if: foot1.x - foot2.x - 0.1*l, then: on1}\n\
         scene: {start: {x: -0.199, y: 0.98, p: 0.2003, s: -0.2003, \"p'\": -0.19983, \"s'\": -0.184}, until: 10, tolerance: 1e-12}\n",
    )
}

#[test]
fn the_simplest_walker_walks_on_feet_of_next_to_no_mass() {
    let (file, known) = (simplest_walker(), reference("simplest_walker"));
    let short = ["--start", "p=0.194", "--start", "s=-0.194", "--start", "p'=-0.2039", "--start", "s'=-0.188"];
    for (place, slope, more) in [(0, "0.009", &[][..]), (1, "0.012", &[]), (2, "0.009", &short)] {
        let (found, known) = (
            told(&[&[file.as_str(), "--set", &format!("slope={slope}")][..], &STEP, more].concat()).unwrap(),
            &known["points"][place],
        );
        // The reference has no feet: its numbers are the model's but for some 10⁻¹³.
        for (name, expected) in [("p", "theta"), ("p'", "thetadot")] {
            near(number(&found["start"][name]["value"]), number(&known[expected]), 1e-11);
        }
        near(number(&found["period"]["value"]), 2.0 * number(&known["step_time"]), 1e-11);
        multiplied(&found["multipliers"], &known["multipliers"], 1e-9);
        // At a strike the swinging leg's angle and rate are those of the other: a multiplier is 0.
        assert_eq!(found["multipliers"].as_array().unwrap().len(), 3, "{found}");
        assert_eq!(number(&found["multipliers"][2]["re"]), 0.0);
    }
    // Three steps of a gait are three steps, and not one of another.
    let again = told(&[&[file.as_str(), "--count", "2"][..], &STEP].concat()).unwrap();
    assert_eq!(again["repeats"], 3);
    near(number(&again["period"]["value"]), 2.0 * number(&known["points"][0]["step_time"]), 1e-11);
}

#[test]
fn steps_of_the_simplest_walker_double() {
    let (file, known) = (simplest_walker(), reference("simplest_walker"));
    let found = told(&[&[file.as_str()][..], &STEP, &["--vary", "slope=0.0145,0.0152"]].concat()).unwrap();
    let threshold = &found["thresholds"][0];
    assert_eq!(threshold["kind"], "doubling");
    near(number(&threshold["value"]), number(&known["period_doubling"]["slope"]), 1e-10);
}

/// Where steps double a gait of two unequal steps leaves, which doubles again.
#[test]
fn two_unequal_steps_of_the_simplest_walker_double_again() {
    let (file, known) = (simplest_walker(), reference("simplest_walker"));
    let values = ["--vary", "slope=0.015,0.0155,0.016,0.0178", "--branch", "1"];
    let doubled = told(&[&[file.as_str()][..], &STEP, &values].concat()).unwrap();
    for expected in known["doubled"].as_array().unwrap() {
        let member = doubled["members"].as_array().unwrap().iter();
        let slope = number(&expected["slope"]);
        let mut member = member.filter(|member| (number(&member["value"]) - slope).abs() < 1e-14);
        let member = member.next().unwrap_or_else(|| panic!("{doubled}"));
        // It may begin with either step.
        let steps = expected["states"].as_array().unwrap();
        let apart = |step: &&Value| (number(&member["start"]["p"]) - number(&step["theta"])).abs();
        let step = steps.iter().min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
        near(number(&member["start"]["p"]), number(&step["theta"]), 1e-11);
        near(number(&member["start"]["p'"]), number(&step["thetadot"]), 1e-11);
        let whole: f64 = steps.iter().map(|step| number(&step["step_time"])).sum();
        near(number(&member["period"]), whole, 1e-10);
        multiplied(&member["multipliers"], &expected["multipliers"], 1e-9);
    }
    let threshold = &doubled["thresholds"][0];
    assert_eq!(threshold["kind"], "doubling", "{}", doubled["thresholds"]);
    near(number(&threshold["value"]), number(&known["second_doubling"]["slope"]), 1e-12);
}

/// A wheel of eight spokes: the multiplier of a step is cos²(2π/8).
#[test]
fn a_rimless_wheel_rolls_down() {
    let file = written(
        "name: RimlessWheel\nsizes: {n: 8}\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, slope: 0.08 rad}\n\
         coordinates: {x: m, y: m, phi: rad}\n\
         points: {hub: \"[x, y]\", even: \"hub + l*[sin(phi), -cos(phi)]\", odd: \"hub + l*[sin(phi + 2*pi/n), -cos(phi + 2*pi/n)]\"}\n\
         bodies: {wheel: {mass: m, inertia: 0, angle: phi, position: hub}}\ngravity: g*[sin(slope), -cos(slope)]\n\
         constraints: {on_even: velocity(even), on_odd: velocity(odd)}\nphases: {even: [on_even], odd: [on_odd]}\n\
         events:\n  strike: {phase: even, when: odd.y - even.y, direction: falling, then: odd}\n\
         scene: {start: {x: -0.3826834323650898, y: 0.9238795325112867, phi: pi/8, \"phi'\": -1.2}, until: 3, tolerance: 1e-12}\n",
    );
    let found =
        told(&[&file, "--at", "strike", "--exchange", "even=odd", "--turn", "phi=-0.125", "--shift", "x"]).unwrap();
    let known = &reference("rimless_wheel")["cases"][0];
    holds(&found["start"]["phi'"], -number(&known["omega_after"]), 1e-11);
    holds(&found["period"], 2.0 * number(&known["step_time"]), 1e-11);
    assert_eq!(found["multipliers"].as_array().unwrap().len(), 1);
    near(number(&found["multipliers"][0]["re"]), number(&known["multiplier"]), 1e-11);
    assert_eq!(found["map"]["does"], "exchanged: even for odd, odd for even; shifted: x; turned: phi by -0.125");
}
