//! What seems not to act, and does.

use dalembert::needs::{Need, NeedsError, NeedsRequest, Verdict};

use super::{asked, change, chosen, found, holds, oscillator, reduction};

#[test]
fn what_acts_late_or_at_resonance_stays() {
    let late = oscillator(
        "forces: {late: {on: b, force: \"[0.2*F*exp(-((t - 36*T)/(0.2*T))^2), 0]\"}}
scene: {start: {x: 1}, until: 40, tolerance: 1e-8}",
    );
    assert_eq!(reduction(&found(&late, "x"), "forces.late").verdict, Verdict::Acts);
    let narrow = late.replace("0.2*T", "0.002*T");
    let change = change(&found(&narrow, "x"), "forces.late");
    assert!((2e-4..5e-4).contains(&change), "{change}");
    let resonant = oscillator(
        "forces: {hum: {on: b, force: \"[2e-3*F*cos(t/T), 0]\"}, push: {on: b, force: \"[0.5*F*cos(0.2*t/T), 0]\"}}
scene: {start: {x: 0}, until: 60, tolerance: 1e-8}",
    );
    let needs = found(&resonant, "x");
    assert_eq!(reduction(&needs, "forces.hum").verdict, Verdict::Acts, "{}", needs.table());
}

#[test]
fn a_bumper_that_is_nearly_touched_stays_and_one_far_away_goes() {
    let bumper = |gap: f64| {
        oscillator(&format!(
            "forces: {{bumper: {{on: b, force: \"[-50*k*max(0, x - {gap}*A), 0]\"}}}}
scene: {{start: {{x: 1}}, until: 20, tolerance: 1e-8}}"
        ))
    };
    let near = found(&bumper(1.02), "x");
    assert!(matches!(reduction(&near, "forces.bumper").verdict, Verdict::Near { .. }), "{}", near.table());
    let far = found(&bumper(3.0), "x");
    assert_eq!(reduction(&far, "forces.bumper").verdict, Verdict::Serves, "{}", far.table());
    assert_eq!(reduction(&found(&bumper(0.5), "x"), "forces.bumper").verdict, Verdict::Acts);
}

#[test]
fn what_acts_only_through_an_event_stays() {
    // A ball clears a wall's top by a hair, thanks to a drag that changes its path by less than that is asked to.
    let wall = "name: Thrown
parameters: {m: 1 kg, c: 1e-5 N*s/m, g: 10 m/s^2, top: 5 m}
coordinates: {x: m, y: m}
bodies: {ball: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
forces: {drag: {on: ball, force: \"-c*velocity(ball)\"}}
events: {above: {when: y - top, then: record}}
scene: {start: {x': 1, y': 10.00001667}, until: 1.9, tolerance: 1e-10}
";
    let needs = found(wall, "x");
    let verdict = &reduction(&needs, "forces.drag").verdict;
    assert!(matches!(verdict, Verdict::HappensOtherwise { .. } | Verdict::Near { .. }), "{}", needs.table());
    let higher = found(&wall.replace("top: 5 m", "top: 4 m"), "x");
    assert_eq!(reduction(&higher, "forces.drag").verdict, Verdict::Serves, "{}", higher.table());
}

#[test]
fn supports_that_stand_in_for_each_other_do_not_go_together() {
    // The base moves, so that the block cannot be held instead; and no formula says where it follows.
    let supported = "name: Held
parameters: {m: 1 kg, k: 1e5 N/m, g: 10 m/s^2, L: 1 m, A: 0.3 m, w: 2 1/s}
coordinates: {theta: rad, x: m}
inputs: {u: A*(1 - cos(w*t))}
bodies:
  block: {mass: m, position: \"[x, 0]\"}
  bob: {mass: 0.1*m, position: \"[x + L*sin(theta), -L*cos(theta)]\"}
gravity: [0, -g]
springs:
  one: {stretch: x - u + (x - u)^3/L^2, stiffness: k, along: \"[1, 0]\", on: block}
  other: {stretch: x - u + (x - u)^3/L^2, stiffness: k, along: \"[1, 0]\", on: block}
outputs: {swing: theta}
scene: {start: {theta: 0.2}, until: 5, tolerance: 1e-8}
";
    let needs = found(supported, "swing");
    for ingredient in ["springs.one", "springs.other"] {
        let alone = change(&needs, ingredient);
        assert!(alone < 3e-4, "{ingredient}: {alone}");
    }
    let choice = chosen(&needs);
    let both = ["springs.one", "springs.other"].map(|name| choice.members.contains(&name.to_owned()));
    assert!(both[0] != both[1], "{}", needs.table());
    assert!(choice.verified <= 1e-3, "{}", needs.table());
    holds(supported, &needs);
}

#[test]
fn a_scene_that_forgets_its_start_is_not_reduced() {
    let text = include_str!("../../../models/double_pendulum.yaml");
    let wild = NeedsRequest { need: Some(Need::default()), ..NeedsRequest::new(text) };
    match asked(&wild) {
        Ok(needs) => {
            assert!(needs.reductions.is_empty() && needs.promised_until.is_some(), "{}", needs.table());
            assert!(needs.choice.is_none_or(|choice| choice.members.is_empty()));
        }
        Err(error) => assert!(matches!(error, NeedsError::NotKnown { .. }), "{error}"),
    }
}

#[test]
fn what_acts_only_in_a_late_phase_stays() {
    let stages = |force: &str| {
        oscillator(&format!(
            "phases: {{before: [], after: []}}
events: {{shift: {{when: t - 36*T, direction: rising, phase: before, then: after}}}}
forces: {{assist: {{on: b, force: \"[{force}*F, 0]\", phase: after}}}}
scene: {{start: {{x: 1}}, until: 40, tolerance: 1e-8}}"
        ))
    };
    let strong = found(&stages("0.01"), "x");
    assert_eq!(reduction(&strong, "forces.assist").verdict, Verdict::Acts, "{}", strong.table());
    let weak = found(&stages("1e-4"), "x");
    assert_eq!(reduction(&weak, "forces.assist").verdict, Verdict::Serves, "{}", weak.table());
}

#[test]
fn what_decides_a_phase_stays() {
    // A hum carries the mass past a latch that it misses without, in a scene that is else the same to a thousandth.
    let latched = |latch: f64| {
        oscillator(&format!(
            "phases: {{free: [], latched: []}}
events: {{latch: {{when: x - {latch}*A, direction: rising, phase: free, then: latched}}}}
forces:
  hum: {{on: b, force: \"[2e-4*F*sin(t/T), 0]\"}}
  hook: {{on: b, force: \"[-0.5*F, 0]\", phase: latched}}
scene: {{start: {{x: -1}}, until: 8, tolerance: 1e-8}}"
        ))
    };
    let needs = found(&latched(0.9692), "x");
    assert!(matches!(reduction(&needs, "forces.hum").verdict, Verdict::HappensOtherwise { .. }), "{}", needs.table());
    let early = found(&latched(0.3), "x");
    assert_eq!(reduction(&early, "forces.hum").verdict, Verdict::Serves, "{}", early.table());
}

/// An inverted pendulum on a pivot that is shaken, and a hanging one.
fn shaken(start: &str, amplitude: &str) -> String {
    format!(
        "name: Shaken
parameters: {{m: 1 kg, L: 1 m, g: 9.81 m/s^2, A: {amplitude} m, w: 150 1/s}}
coordinates: {{theta: rad}}
inputs: {{pivot: A*cos(w*t)}}
bodies: {{bob: {{mass: m, position: \"[L*sin(theta), pivot + L*cos(theta)]\"}}}}
gravity: [0, -g]
scene: {{start: {{theta: {start}}}, until: 3, tolerance: 1e-8}}
"
    )
}

#[test]
fn an_input_that_acts_by_its_square_stays() {
    // Shaken fast enough the pendulum stands, though its pivot is where it is on the average and the sign of A does not matter.
    let standing = found(&shaken("0.1", "0.05"), "theta");
    let pivot = reduction(&standing, "inputs.pivot");
    assert_eq!(pivot.verdict, Verdict::Acts, "{}", standing.table());
    assert!(pivot.predicted.is_none_or(|predicted| !predicted.holds()), "{}", standing.table());
    let hanging = found(&shaken("3", "1e-5"), "theta");
    assert_eq!(reduction(&hanging, "inputs.pivot").verdict, Verdict::Serves, "{}", hanging.table());
}

#[test]
fn an_input_that_moves_late_stays() {
    let lifted = |height: &str| {
        oscillator(&format!(
            "inputs: {{floor: \"{height}*A*step(t - 36*T)*(t - 36*T)^2/T^2\"}}
forces: {{lift: {{on: b, force: \"[k*floor, 0]\"}}}}
scene: {{start: {{x: 1}}, until: 40, tolerance: 1e-8}}"
        ))
    };
    let high = found(&lifted("0.01"), "x");
    assert_eq!(reduction(&high, "inputs.floor").verdict, Verdict::Acts, "{}", high.table());
    let low = found(&lifted("1e-6"), "x");
    assert_eq!(reduction(&low, "inputs.floor").verdict, Verdict::Serves, "{}", low.table());
}

#[test]
fn a_mass_and_an_inertia_that_stand_in_for_each_other_do_not_go_together() {
    // The pointer follows its stiff spring by either of the two; without both nothing resists its acceleration.
    let pointer = "name: Pointer
parameters: {m: 1e-3 kg, J: 1e-3 kg*m^2, R: 1 m, k: 1e4 N*m, A: 0.3, w: 2 1/s}
coordinates: {phi: rad}
inputs: {u: A*(1 - cos(w*t))}
bodies: {pointer: {mass: m, inertia: J, angle: phi, position: \"R*[cos(phi), sin(phi)]\"}}
springs: {hand: {stretch: phi - u + (phi - u)^3, stiffness: k, on: pointer}}
scene: {until: 5, tolerance: 1e-10}
";
    let needs = found(pointer, "phi");
    for ingredient in ["bodies.pointer.mass", "bodies.pointer.inertia"] {
        assert_eq!(reduction(&needs, ingredient).verdict, Verdict::Serves, "{}", needs.table());
    }
    let choice = chosen(&needs);
    let gone = choice.members.iter().filter(|name| name.starts_with("bodies.pointer.")).count();
    assert!(gone < 2 && choice.verified <= 1e-3, "{}", needs.table());
    holds(pointer, &needs);
}

/// A stiff coordinate that only another scene wants is held, and that scene is run for nothing any more; both are told.
#[test]
fn what_another_scene_is_run_for_does_not_stay_in_the_way() {
    let text = "name: Sc\nparameters: {m: 1 kg, M: 10 kg, k: 1e4 N/m, K: 40 N/m}\ncoordinates: {x: m, y: m}\n\
        bodies: {a: {mass: M, position: \"[x, 0]\"}, b: {mass: m, position: \"[x + y, 0]\"}}\n\
        springs: {s1: {stretch: x, stiffness: K, along: \"[1,0]\", on: a}, s2: {stretch: y, stiffness: k, along: \"[1,0]\", on: b, from: a}}\n\
        scene: {start: {x: 0.1}, until: 5, needs: {outputs: [x], within: 1e-2}}\n\
        scenes:\n  other: {start: {x: 0.1, y: 0.01}, until: 9, needs: {outputs: [x, y], within: 1e-2}}\n";
    let needs = asked(&NeedsRequest::new(text)).unwrap();
    assert!(chosen(&needs).members.contains(&"coordinates.y".to_owned()), "{}", needs.table());
    assert!(needs.table().contains("scenes.other.needs goes with it: unknown name `y`"), "{}", needs.table());
    let written = needs.smaller_file().expect("a file");
    assert!(written.contains("other: {start: {x: 0.1}, until: 9"), "{written}");
    // The scene that wants it keeps it.
    let other = asked(&NeedsRequest { scene: Some("other".to_owned()), ..NeedsRequest::new(text) }).unwrap();
    assert!(matches!(reduction(&other, "coordinates.y").verdict, Verdict::Refused { .. }), "{}", other.table());
}

/// What cannot be written into the file is told as that, not as a name that is none.
#[test]
fn what_cannot_be_written_is_told() {
    let text = "name: Mass\nparameters: {m: 1 kg}\ncoordinates: {x: m}\nbodies: {b: {mass: m, position: \"[x, 0]\"}}\n";
    let refused = |asked: Result<NeedsRequest, NeedsError>| asked.expect_err("a refusal").to_string();
    let none = "the file has no `scene` in lines or brackets, into which another value could be written";
    assert_eq!(refused(NeedsRequest::new(text).ending("3 s")), none);
    assert_eq!(refused(NeedsRequest::new(text).starting("x", "0.3 m")), none);
    let named = NeedsRequest { scene: Some("far".to_owned()), ..NeedsRequest::new(text) };
    assert_eq!(refused(named.ending("3 s")), "no scene is called `far`; there is none");
    assert_eq!(refused(NeedsRequest::new(text).starting("y", "0.3 m")), "no coordinate is called `y`; there are x");
    let family = text.replace("{x: m}", "{\"x[1..2]\": m}").replace("x, 0", "x[1], x[2]");
    let member = refused(NeedsRequest::new(family).starting("x[2]", "0.3 m"));
    assert!(member.contains("no `x[2]` in lines or brackets"), "{member}");
}
