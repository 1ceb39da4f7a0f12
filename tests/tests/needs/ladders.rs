//! Ladders of fidelity with the figures of the study and the catalogue: what is predicted beside what is verified, and where each law
//! breaks down.  Others stand in `stiff.rs`, `masses.rs`, `linear.rs` and `main.rs`.

use dalembert::needs::{Law, ModelReduction, Need, Needs, NeedsError, NeedsRequest, Proposal, Verdict};

use super::{SPRING_PENDULUM, asked, chosen, found, holds, oscillator, reduction};

/// What is predicted, whether that holds, and what is verified.
fn judged(reduction: &ModelReduction) -> (f64, bool, f64) {
    let predicted = reduction.predicted.unwrap_or_else(|| panic!("nothing predicted of {}", reduction.ingredient));
    (predicted.change, predicted.holds(), reduction.deviation.as_ref().expect("compared").largest)
}

fn is_near(reduction: &ModelReduction) -> f64 {
    let (predicted, holds, change) = judged(reduction);
    assert!(
        holds && (0.5..2.0).contains(&(predicted / change)),
        "{}: {predicted} {holds} {change}",
        reduction.ingredient
    );
    change
}

/// A bob on a stiff spring in Cartesian coordinates, from rest at its load's stretch.
fn on_a_cord(stiffness: &str) -> String {
    format!(
        "name: Cord
parameters: {{m: 1 kg, L: 1 m, k: {stiffness} N/m, g: 9.81 m/s^2, s: L + m*g*cos(0.3)/k m}}
coordinates: {{x: m, y: m}}
points: {{O: [0, 0]}}
bodies: {{bob: {{mass: m, position: \"[x, y]\"}}}}
gravity: [0, -g]
springs: {{cord: {{between: [O, bob], stiffness: k, rest: L}}}}
outputs: {{angle: \"atan2(x, -y)\", pull: \"k*(sqrt(x^2 + y^2) - L)\"}}
scene: {{start: {{x: s*sin(0.3), y: -s*cos(0.3)}}, until: 10, tolerance: 1e-8}}
"
    )
}

fn rigid<'a>(needs: &'a Needs, ingredient: &str) -> Vec<&'a ModelReduction> {
    let is = |reduction: &&ModelReduction| {
        reduction.ingredient == ingredient && matches!(reduction.proposal, Proposal::Rigid { .. })
    };
    needs.reductions.iter().filter(is).collect()
}

#[test]
fn a_stiff_cord_is_a_rod_of_its_rest_length_or_better_of_its_length_under_load() {
    // Stability catalogue, F1a: 49.4/k rad of a rod of length L, 5.4/k of one of L + mg/k; the swing's range is 0.6 rad.
    for (stiffness, k) in [("1e3", 1e3), ("1e4", 1e4), ("1e5", 1e5)] {
        let needs = found(&on_a_cord(stiffness), "angle");
        let mut changes: Vec<f64> = rigid(&needs, "springs.cord").into_iter().map(is_near).collect();
        changes.sort_by(f64::total_cmp);
        let [loaded, slack] = changes[..] else { panic!("{}", needs.table()) };
        assert!((slack / (49.4 / k / 0.6) - 1.0).abs() < 0.1, "{k}: {slack}");
        assert!((loaded / (5.4 / k / 0.6) - 1.0).abs() < 0.25, "{k}: {loaded}");
    }
    // Hardly faster than it swings: no law, and the table says so.
    let soft = found(&on_a_cord("60"), "angle");
    for reduction in rigid(&soft, "springs.cord") {
        assert!(!judged(reduction).1 && reduction.verdict == Verdict::Acts, "{}", soft.table());
    }
}

#[test]
fn cords_that_are_stiff_only_together_become_rods_together() {
    let chain = "name: Chain
parameters: {m: 0.5 kg, L: 0.4 m, k: 3e5 N/m, g: 9.81 m/s^2, d1: L + 2*m*g/k m, d2: L + m*g/k m}
coordinates: {x1: m, y1: m, x2: m, y2: m}
points: {O: [0, 0]}
bodies: {a: {mass: m, position: \"[x1, y1]\"}, b: {mass: m, position: \"[x2, y2]\"}}
gravity: [0, -g]
springs: {s1: {between: [O, a], stiffness: k, rest: L}, s2: {between: [a, b], stiffness: k, rest: L}}
forces: {push: {on: b, force: \"[0.3*m*g*(1 - cos(sqrt(g/L)*t/3)), 0]\"}}
outputs: {tip: x2}
scene: {start: {y1: -d1, y2: -d1 - d2}, until: 3, tolerance: 1e-7}
";
    let needs = found(chain, "tip");
    let [together] = rigid(&needs, "springs")[..] else { panic!("{}", needs.table()) };
    assert!(
        rigid(&needs, "springs.s1").iter().all(|reduction| reduction.saving < 0.5 * together.saving),
        "{}",
        needs.table()
    );
    let choice = chosen(&needs);
    assert!(choice.members == ["springs"] && choice.verified <= 1e-3, "{}", needs.table());
    assert!(choice.moved.is_some_and(|moved| moved < 1.5e-3), "{}", needs.table());
}

#[test]
fn the_tension_of_a_cord_that_is_a_rod_is_its_reaction() {
    let file = on_a_cord("1e5");
    let need = Need::of(&["angle", "pull"], 1e-3);
    let needs = asked(&NeedsRequest { need: Some(need), ..NeedsRequest::new(file.clone()) }).unwrap();
    let choice = chosen(&needs);
    assert!(choice.members == ["springs.cord"] && choice.verified <= 1e-3 && choice.saving > 2.0, "{}", needs.table());
    let text = needs.smaller_file().expect("a file");
    for written in ["pull: \"-reaction(cord_rigid)\"", "cord_rigid: norm(O - bob) = cord_length", "guess: {"] {
        assert!(text.contains(written), "{written} in\n{text}");
    }
}

#[test]
fn outputs_read_what_holds_a_coordinate_where_it_gives_way() {
    // The study's crane: 60 % of its range as written, 1.5e-3 as the reaction.
    let need = Need::of(&["angle", "tension"], 2e-3);
    let stiff = NeedsRequest::new(SPRING_PENDULUM).setting("k", "1e5 N/m").unwrap();
    let needs = asked(&NeedsRequest { need: Some(need), ..stiff }).unwrap();
    let held = needs.reductions.iter().find(|reduction| {
        reduction.ingredient == "coordinates.r" && matches!(reduction.proposal, Proposal::Held { .. })
    });
    let as_written = held.and_then(|reduction| reduction.deviation.as_ref()).expect("compared").largest;
    let [by_reaction] = rigid(&needs, "coordinates.r")[..] else { panic!("{}", needs.table()) };
    let as_reaction = by_reaction.deviation.as_ref().expect("compared").largest;
    assert!(as_written > 0.3 && as_reaction < 2e-3, "{as_written} {as_reaction}");
    assert_eq!(by_reaction.verdict, Verdict::Serves, "{}", needs.table());
    let crane = NeedsRequest { need: Some(Need::of(&["swing", "pull"], 1e-2)), ..NeedsRequest::new(super::CRANE) };
    let needs = asked(&crane).unwrap();
    assert!(chosen(&needs).members.contains(&"coordinates.l".to_owned()), "{}", needs.table());
    let text = needs.smaller_file().expect("a file");
    for written in ["pull: k*((l - reaction(l_rigid)/l_stiffness) - l0)", "l_stiffness: 3", "l_rigid: l = l_held"] {
        assert!(text.contains(written), "{written} in\n{text}");
    }
}

/// A mass on a spring, damped, with its start and end.
fn swinging(zeta: f64, scene: &str) -> String {
    format!(
        "name: Swings
parameters: {{m: 1 kg, k: 1 N/m, c: {} N*s/m, A: 1 m}}
coordinates: {{x: m}}
bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}
springs: {{s: {{stretch: x, stiffness: k, along: \"[1, 0]\", on: b}}}}
dampers: {{d: {{rate: \"x'\", damping: c, along: \"[1, 0]\", on: b}}}}
scene: {{start: {scene}, tolerance: 1e-9}}
",
        2.0 * zeta
    )
}

/// From its largest stretch on, for so many swings.
fn swings(zeta: f64, n: f64) -> Needs {
    found(&swinging(zeta, &format!("{{x: 1}}, until: {}", std::f64::consts::TAU * n)), "x")
}

#[test]
fn a_damper_is_missed_like_the_amplitude_that_it_takes() {
    // Stability catalogue, F12: after N swings the amplitude is less by 1 − e^(−2πNζ), of a range of twice the amplitude; 1 % of the
    // amplitude at ζ = 1.6e-3/N.
    for (n, zeta) in [(5.0, 1.6e-3 / 5.0), (10.0, 1.6e-3 / 10.0), (10.0, 1e-3)] {
        let needs = swings(zeta, n);
        let change = is_near(reduction(&needs, "dampers.d"));
        let law = 0.5 * (1.0 - (-std::f64::consts::TAU * n * zeta).exp());
        assert!((change / law - 1.0).abs() < 0.05, "{n} {zeta}: {change} {law}");
    }
    assert_eq!(reduction(&swings(3e-5, 5.0), "dampers.d").verdict, Verdict::Serves);
    // What it takes is no small part any more: the law does not hold.
    let strong = swings(0.05, 10.0);
    assert!(!judged(reduction(&strong, "dampers.d")).1, "{}", strong.table());
}

#[test]
fn without_a_damper_resonance_has_no_law() {
    // Stability catalogue, F12: the amplitude at resonance is 1/(2 ζ) with the damper, and grows without end without it.
    let driven = |frequency: &str| {
        oscillator(&format!(
            "forces: {{hum: {{on: b, force: \"[0.01*F*cos({frequency}*t/T), 0]\"}}}}
scene: {{start: {{x: 0.001}}, until: 600, tolerance: 1e-8}}"
        ))
    };
    let resonant = found(&driven("1"), "x");
    let damper = reduction(&resonant, "dampers.d");
    assert!(damper.verdict == Verdict::Acts && !judged(damper).1, "{}", resonant.table());
}

#[test]
fn a_drag_is_missed_in_proportion_until_it_stops_what_it_drags() {
    // A fall from rest with drag d v²: x = (m/d) ln cosh(t √(d g/m)), so that ½ g t² is too long by d g² t⁴/(12 m) at first.
    let falling = |drag: f64| {
        format!(
            "name: Falling
parameters: {{m: 1 kg, g: 10 m/s^2, d: {drag} N*s^2/m^2}}
coordinates: {{x: m}}
bodies: {{ball: {{mass: m, position: \"[0, -x]\"}}}}
gravity: [0, -g]
generalized_forces: {{x: -d*x'^2}}
scene: {{until: 2, tolerance: 1e-10}}
"
        )
    };
    for drag in [1e-5, 1e-4, 1e-3] {
        let change = is_near(reduction(&found(&falling(drag), "x"), "generalized_forces.x"));
        let law = drag * 100.0 * 16.0 / 12.0 / 20.0;
        assert!((change / law - 1.0).abs() < 0.05, "{drag}: {change} {law}");
    }
    let slow = found(&falling(1.0), "x");
    assert!(!judged(reduction(&slow, "generalized_forces.x")).1, "{}", slow.table());
}

#[test]
fn a_late_pulse_is_predicted_and_a_bumper_says_how_far_it_is() {
    // The study's pulse, at nine tenths of the scene: 4.1e-2 predicted and found.
    let late = oscillator(
        "forces: {late: {on: b, force: \"[0.2*F*exp(-((t - 36*T)/(0.2*T))^2), 0]\"}, soft: {on: b, force: \"[-1e-3*k*x^3/A^2, 0]\"}}
scene: {start: {x: 1}, until: 40, tolerance: 1e-8}",
    );
    let change = is_near(reduction(&found(&late, "x"), "forces.late"));
    assert!((2e-2..6e-2).contains(&change), "{change}");
    let far = oscillator(
        "forces: {bumper: {on: b, force: \"[-50*k*max(0, x - 1.3*A), 0]\"}}
scene: {start: {x: 1}, until: 20, tolerance: 1e-8}",
    );
    let needs = found(&far, "x");
    let bumper = reduction(&needs, "forces.bumper");
    let (guard, margin) = bumper.margin.clone().expect("a margin");
    // It stays 0.3 m away while it goes through 1.94 m or so.
    assert!(bumper.verdict == Verdict::Serves && (0.14..0.17).contains(&margin), "{guard} {margin}");
    assert!(needs.table().contains("is missed by 0.15 of its range"), "{}", needs.table());
}

#[test]
fn clock_and_shape_are_told_apart() {
    // The study's pendulum: δω²/ω² = 1e-4 is a phase error of 5e-5, beside a waveform error of 5e-6, 2.3e-3 of the range after 30 s.
    let pendulum = "name: Swing
parameters: {m: 1 kg, L: 1 m, g: 9.81 m/s^2, K: 1e-4*m*g*L N*m}
coordinates: {theta: rad}
bodies: {bob: {mass: m, angle: theta, position: \"L*[sin(theta), -cos(theta)]\"}}
gravity: [0, -g]
generalized_forces: {theta: -K*sin(theta)}
scene: {start: {theta: 0.3}, until: 30, tolerance: 1e-9}
";
    let needs = found(pendulum, "theta");
    let (phase_error, waveform_error) =
        reduction(&needs, "generalized_forces.theta").deviation.as_ref().and_then(|d| d.parts()).unwrap();
    let change = reduction(&needs, "generalized_forces.theta").deviation.as_ref().unwrap().largest;
    assert!((2.0e-3..2.6e-3).contains(&change), "{change}");
    assert!(
        (phase_error / -5e-5 - 1.0).abs() < 0.05 && waveform_error < 0.05 * change,
        "{phase_error} {waveform_error}"
    );
    assert!(needs.table().contains(" phase error ") && needs.table().contains(" waveform error "), "{}", needs.table());
    let choice = chosen(&needs);
    let (_, left) = choice.parts.expect("small");
    assert!(left <= choice.verified * 1.5, "{left}");
}

#[test]
fn the_tolerance_is_an_ingredient_too() {
    let file = oscillator("generalized_forces: {x: -k*x^3/A^2}\nscene: {start: {x: 1}, until: 20, tolerance: 1e-10}");
    let needs = found(&file, "x");
    let tolerance = reduction(&needs, "tolerance");
    assert_eq!(tolerance.proposal, Proposal::Looser { tolerance: 1e-5, own: 1e-10 });
    assert!(tolerance.verdict == Verdict::Serves && tolerance.saving > 2.0, "{}", needs.table());
    assert!(needs.table().contains("1e-5 instead of 1e-10"), "{}", needs.table());
}

#[test]
fn balances_that_a_held_coordinate_leaves_true_stay() {
    // Of three balances of a crane the pull along its rope goes with the rope; the others still determine the motion.
    let needs = asked(&NeedsRequest::new(super::CRANE)).unwrap();
    let text = needs.smaller_file().expect("a file");
    assert!(text.contains("force: {of: all, along: \"[1, 0]\"}") && text.contains("about: trolley"), "{text}");
    assert!(!text.contains("{of: [load], along: down}}"), "{text}");
    holds(super::CRANE, &needs);
}

#[test]
fn laws_say_what_they_are() {
    let needs = found(&on_a_cord("60"), "angle");
    let [reduction, ..] = rigid(&needs, "springs.cord")[..] else { panic!("{}", needs.table()) };
    assert!(matches!(reduction.predicted.expect("a prediction").law, Law::Stiff { .. }));
    assert!(needs.table().contains("; no law: "), "{}", needs.table());
}

#[test]
fn what_hardly_moves_is_wanted_to_an_amount() {
    // A block on a stiff foot rests all along, in the full model; a push that is left out would have moved it by 1e-6 m.
    let block = "name: Block
parameters: {m: 1 kg, k: 1e4 N/m, F: 0.01 N, w: 3 1/s, A: 1 m}
coordinates: {x: m, y: m}
bodies: {a: {mass: m, position: \"[x, 0]\"}, b: {mass: m, position: \"[0, y]\"}}
springs: {foot: {stretch: x, stiffness: k, along: \"[1, 0]\", on: a}, other: {stretch: y, stiffness: k/1000, along: \"[0, 1]\", on: b}}
forces: {push: {on: a, force: \"[F*cos(w*t), 0]\"}, opposite: {on: a, force: \"[-F*cos(w*t), 0]\"}}
outputs: {gap: x}
scene: {start: {y: 1}, until: 5, tolerance: 1e-8, needs: {outputs: [y], within: 1e-3, absolute: {gap: AMOUNT}}}
";
    let relative =
        NeedsRequest { need: Some(Need::of(&["gap"], 1e-3)), ..NeedsRequest::new(block.replace("AMOUNT", "1 mm")) };
    assert!(matches!(asked(&relative).expect_err("a refusal"), NeedsError::Still { .. }));
    let within = |amount: &str| asked(&NeedsRequest::new(block.replace("AMOUNT", amount))).unwrap();
    let coarse = within("0.01 mm");
    assert_eq!(coarse.need.absolute, [("gap".to_owned(), 1e-5)]);
    assert_eq!(reduction(&coarse, "forces.push").verdict, Verdict::Serves, "{}", coarse.table());
    assert!(coarse.table().contains("y within 1.0e-3 of the range of each, gap within 1.0e-5"), "{}", coarse.table());
    assert_eq!(reduction(&within("0.1 um"), "forces.push").verdict, Verdict::Acts);
    let test = coarse.comparison("full.yaml", "small.yaml").expect("a test");
    assert!(test.contains("full.difference(&small, \"gap\")") && test.contains("off <= 1e-5"), "{test}");
    let NeedsError::Model { problems } =
        asked(&NeedsRequest::new(block.replace("AMOUNT", "1 s"))).expect_err("a refusal")
    else {
        panic!("not a problem of the file")
    };
    assert!(problems[0].message.contains("`gap`"), "{problems:?}");
    let missing =
        asked(&NeedsRequest::new(block.replace("AMOUNT", "1 mm").replace("absolute: {gap:", "absolute: {hole:")));
    assert!(matches!(missing.expect_err("a refusal"), NeedsError::Model { .. }));
    let none = Need { absolute: vec![("gap".to_owned(), 0.0)], ..Need::of(&["y"], 1e-3) };
    let none = NeedsRequest { need: Some(none), ..NeedsRequest::new(block.replace("AMOUNT", "1 mm")) };
    assert!(matches!(asked(&none).expect_err("a refusal"), NeedsError::BadNeed { .. }));
}

#[test]
fn a_damper_makes_a_clock_slow_by_half_the_square_of_its_ratio() {
    // Stability catalogue, F12: ω_d is less than ω by ζ²/2 of it.  From its middle on the mass passes there every π/ω_d.
    let last = |zeta: f64, n: f64| {
        let until = std::f64::consts::PI * n + 1.0;
        let file =
            swinging(zeta, &format!("{{x: 0, x': 1}}, until: {until}")) + "events: {middle: {when: x, then: record}}\n";
        let need = Need { outputs: vec!["x".to_owned()], within: 1e-3, absolute: vec![("x".to_owned(), 1e6)] };
        let request = NeedsRequest { need: Some(need), ..NeedsRequest::new(file) };
        let needs = asked(&request).unwrap_or_else(|error| panic!("{error}"));
        let deviation = reduction(&needs, "dampers.d").deviation.clone().expect("compared");
        assert!(deviation.of.contains("middle"), "{deviation:?}");
        (deviation.largest, 0.5 * zeta * zeta * std::f64::consts::PI * n / until)
    };
    for (zeta, n) in [(0.005, 2.0), (0.01, 5.0), (0.03, 5.0), (0.01, 12.0)] {
        let (change, law) = last(zeta, n);
        assert!((change / law - 1.0).abs() < 0.01, "{zeta} {n}: {change} {law}");
    }
    // What is missed of the place itself is its size, of first order in ζ; no more than what is of second order is taken for phase error.
    for (zeta, n) in [(0.002, 4.0), (0.005, 4.0), (0.01, 2.0)] {
        let deviation = reduction(&swings(zeta, n), "dampers.d").deviation.clone().expect("compared");
        assert!(deviation.phase_error.abs() < 4.0 * zeta * zeta && deviation.largest > zeta, "{zeta}: {deviation:?}");
    }
}
