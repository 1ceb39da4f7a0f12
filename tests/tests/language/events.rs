//! Section 6: when events fire, and what they do.

use dalembert::{Cause, Error, Run, Warning};
use dalembert_tests::case::Case;

use crate::near;

/// A particle of mass 2 in the plane, without units.
fn bead(more: &str) -> Case {
    Case::written(&format!(
        "name: Bead
parameters: {{m: 2, e: 0.5, g: 10}}
coordinates: {{x: 1, y: 1}}
bodies: {{bead: {{mass: m, position: \"[x, y]\"}}}}
{more}"
    ))
}

/// x = cos t.
fn oscillator(more: &str) -> Case {
    bead(&format!(
        "springs: {{s: {{stretch: x, stiffness: m, on: bead, along: \"[1, 0]\"}}}}
scene: {{start: {{x: 1}}, until: 7, tolerance: 1e-12}}
{more}"
    ))
}

/// x = t.
fn runner(more: &str) -> Case {
    bead(&format!("scene: {{start: {{x: 0, x': 1}}, until: 4, tolerance: 1e-12}}\n{more}"))
}

/// Names and times of the events that happened.
fn happened(run: &Run) -> Vec<(&str, f64)> {
    run.events.iter().map(|event| (event.name.as_str(), event.state.t)).collect()
}

#[track_caller]
fn same(run: &Run, expected: &[(&str, f64)]) {
    let found = happened(run);
    let names = |list: &[(&str, f64)]| list.iter().map(|(name, _)| (*name).to_owned()).collect::<Vec<_>>();
    assert_eq!(names(&found), names(expected), "{found:?}");
    for ((_, found), (_, expected)) in found.iter().zip(expected) {
        near(*found, *expected, 1e-10);
    }
}

const PI: f64 = std::f64::consts::PI;

#[test]
fn an_event_fires_at_a_crossing_in_its_direction_and_in_both_without_one() {
    let event = |direction: &str| oscillator(&format!("events: {{mid: {{when: x{direction}, then: record}}}}")).run();
    same(&event(", direction: falling"), &[("mid", PI / 2.0)]);
    same(&event(", direction: rising"), &[("mid", 1.5 * PI)]);
    for both in ["", ", direction: both"] {
        same(&event(both), &[("mid", PI / 2.0), ("mid", 1.5 * PI)]);
    }
}

#[test]
fn an_event_fires_while_one_of_its_phases_is_active_and_in_every_one_without() {
    let phases = "phases: {a: [], b: [], c: []}\n";
    let moves = "  to_b: {when: x - 1, phase: a, then: b}\n  to_c: {when: x - 2, phase: b, then: c}\n";
    let event = |phase: &str| {
        // A zero at every half.
        let watched = format!("  half: {{when: cos(pi*x){phase}, then: record}}\n");
        let run = runner(&format!("{phases}events:\n{moves}{watched}")).run();
        run.events.iter().filter(|event| event.name == "half").map(|event| event.state.t.round()).collect::<Vec<f64>>()
    };
    // 0.5, 1.5, 2.5, 3.5 rounded away from 0 or not, by a rounding.
    assert_eq!(event("").len(), 4);
    assert_eq!(event(", phase: a").len(), 1);
    assert_eq!(event(", phase: [b, c]").len(), 3);
    assert_eq!(event(", phase: c").len(), 2);
}

#[test]
fn what_is_zero_where_a_run_starts_fires_only_after_it_has_left_zero() {
    let swing = "springs: {s: {stretch: x, stiffness: m, on: bead, along: \"[1, 0]\"}}\n";
    let scene = "scene: {start: {x: 0, x': 1}, until: 7, tolerance: 1e-12}\n";
    for direction in ["", ", direction: both"] {
        let run = bead(&format!("{swing}{scene}events: {{mid: {{when: x{direction}, then: record}}}}")).run();
        same(&run, &[("mid", PI), ("mid", 2.0 * PI)]);
    }
    let run = bead(&format!("{swing}{scene}events: {{mid: {{when: x, direction: rising, then: stop}}}}")).run();
    same(&run, &[("mid", 2.0 * PI)]);
}

#[test]
fn what_is_zero_where_a_phase_starts_fires_only_after_it_has_left_zero() {
    let run = oscillator(
        "phases: {a: [], b: []}
events: {go: {when: x, phase: a, then: b}, again: {when: x, phase: b, then: record}}",
    )
    .run();
    same(&run, &[("go", PI / 2.0), ("again", 1.5 * PI)]);
}

#[test]
fn what_is_zero_after_an_impact_fires_only_after_it_has_left_zero() {
    let run = bead(
        "gravity: [0, -g]
constraints: {floor: y}
phases: {flight: [], rest: [floor]}
events:
  hit: {when: y, direction: falling, phase: flight, then: {impact: e, along: floor}}
  passes: {when: y, phase: flight, then: record}
scene: {start: {y: 5}, until: 2.4, tolerance: 1e-12}",
    )
    .run();
    same(&run, &[("hit", 1.0), ("passes", 1.0), ("hit", 2.0), ("passes", 2.0)]);
}

/// On entering its phase an event that is past its zero in its stated direction, and changes phases or speeds, fires at once.
#[test]
fn what_is_past_zero_where_its_phase_starts_fires_at_once() {
    let late = |event: &str| {
        let phases = "phases: {a: [], b: [], c: []}\n";
        runner(&format!("{phases}events:\n  go: {{when: x - 1, phase: a, then: b}}\n  late: {{phase: b, {event}}}"))
            .run()
    };
    same(&late("when: x - 1/2, direction: rising, then: c"), &[("go", 1.0), ("late", 1.0)]);
    same(&late("when: 1/2 - x, direction: falling, then: c"), &[("go", 1.0), ("late", 1.0)]);
    // Not in the other direction, without a direction, or where nothing but a record or a stop follows.
    for event in [
        "when: x - 1/2, direction: falling, then: c",
        "when: x - 1/2, then: c",
        "when: x - 1/2, direction: both, then: c",
        "when: x - 1/2, direction: rising, then: record",
        "when: x - 1/2, direction: rising, then: stop",
        "when: x - 1/2, direction: rising, if: 1/2 - x, then: c",
    ] {
        same(&late(event), &[("go", 1.0)]);
    }
}

#[test]
fn what_is_past_zero_where_a_run_starts_does_not_fire() {
    let run = runner("phases: {a: [], b: []}\nevents: {late: {when: x + 1, direction: rising, then: b}}").run();
    same(&run, &[]);
}

#[test]
fn an_event_counts_only_where_its_condition_is_positive() {
    let run =
        |condition: &str| oscillator(&format!("events: {{mid: {{when: x, if: {condition}, then: record}}}}")).run();
    same(&run("x'"), &[("mid", 1.5 * PI)]);
    same(&run("-x'"), &[("mid", PI / 2.0)]);
    same(&run("0*x"), &[]);
    same(&run("1 + x^2"), &[("mid", PI / 2.0), ("mid", 1.5 * PI)]);
    // A stop that does not count goes on.
    let stop = oscillator("events: {mid: {when: x, if: x', then: stop}}").run();
    same(&stop, &[("mid", 1.5 * PI)]);
    near(stop.last().t, 1.5 * PI, 1e-10);
}

/// A landing that slips forwards or backwards: two events.
#[test]
fn two_events_with_opposite_conditions_share_a_crossing() {
    for (speed, expected) in [(1.0, "forwards"), (-1.0, "backwards")] {
        let run = bead(
            "gravity: [0, -g]
constraints: {floor: y}
phases: {flight: [], ahead: [floor], back: [floor]}
events:
  forwards: {when: y, direction: falling, phase: flight, if: x', then: ahead}
  backwards: {when: y, direction: falling, phase: flight, if: -x', then: back}
scene: {start: {x: 0, y: 5, x': 1}, until: 2, tolerance: 1e-12}",
        )
        .start("x'", speed)
        .run();
        same(&run, &[(expected, 1.0)]);
        near(run.last()["y"], 0.0, 1e-14);
    }
}

#[test]
fn record_goes_on_and_stop_ends_the_run() {
    let run = runner("events: {passes: {when: x - 1, then: record}, ends: {when: x - 2, then: stop}, never: {when: x - 3, then: record}}").run();
    same(&run, &[("passes", 1.0), ("ends", 2.0)]);
    assert_eq!(run.ended_by().map(|event| event.name.as_str()), Some("ends"));
    near(run.last()["x"], 2.0, 1e-12);
}

#[test]
fn a_list_is_done_in_its_order() {
    // Struck first, and then held: nothing is left of the speed. Held first, and then let go: nothing either, in phase b.
    let model = |then: &str| {
        let phases = "constraints: {wall: x - 1, rail: y}\nphases: {a: [], b: [rail], held: [wall]}\n";
        runner(&format!("{phases}events: {{hit: {{when: x - 1, phase: a, then: {then}}}}}")).run()
    };
    let bounced = model("[record, {impact: e, along: wall}, b]");
    same(&bounced, &[("hit", 1.0)]);
    near(bounced.last()["x'"], -0.5, 1e-12);
    assert_eq!(bounced.phases.len(), 2);
    let held = model("[{impact: e, along: wall}, held]");
    near(held.last()["x'"], 0.0, 1e-15);
    assert_eq!(held.impulses.len(), 2);
}

/// A corner: both walls are met at once.
#[test]
fn simultaneous_events_fire_in_the_order_of_the_file() {
    for names in [["left", "floor"], ["floor", "left"]] {
        let event = |name: &str| {
            let c = if name == "left" { "x" } else { "y" };
            format!("  {name}: {{when: {c}, direction: falling, then: {{impact: e, along: {name}_}}}}\n")
        };
        let run = bead(&format!(
            "constraints: {{left_: x, floor_: y}}
phases: {{free: [], corner: [left_, floor_], l: [left_], f: [floor_]}}
events:
{}{}scene: {{start: {{x: 1, y: 1, x': -1, y': -1}}, until: 2, tolerance: 1e-12}}",
            event(names[0]),
            event(names[1])
        ))
        .run();
        same(&run, &[(names[0], 1.0), (names[1], 1.0)]);
        near(run.last()["x'"], 0.5, 1e-12);
        near(run.last()["y'"], 0.5, 1e-12);
    }
}

/// The rate of c becomes −e times what it was, and an active rail is kept.
#[test]
fn an_impact_turns_the_rate_of_its_constraint_and_keeps_those_that_act() {
    for e in [0.0, 0.25, 1.0] {
        let run = bead(
            "constraints: {rail: 3*y - 4*x, wall: x + 2*y - 11}
phases: {slides: [rail], rests: [rail, wall]}
events: {hit: {when: x + 2*y - 11, phase: slides, direction: rising, then: {impact: e, along: wall}}}
outputs: {off: 3*y' - 4*x', closing: x' + 2*y', impulse: 0*x}
scene: {start: {x: 0, y: 0, x': 3, y': 4}, until: 1.5, tolerance: 1e-12}",
        )
        .set("e", e)
        .run();
        same(&run, &[("hit", 1.0)]);
        near(run.last()["off"], 0.0, 1e-12);
        near(run.last()["closing"], -11.0 * e, 1e-12);
        let told: Vec<&str> = run.impulses[0].constraints.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(told, ["rail", "wall"]);
        // Along the rail a speed of 5 is turned: (1 + e) 2·5 is what both impulses give together.
        let [(_, rail), (_, wall)] = run.impulses[0].constraints[..] else { panic!() };
        near(-4.0 * rail + wall, -2.0 * (1.0 + e) * 3.0, 1e-11);
        near(3.0 * rail + 2.0 * wall, -2.0 * (1.0 + e) * 4.0, 1e-11);
    }
}

#[test]
fn a_coefficient_of_restitution_outside_of_0_to_1_is_an_error_of_the_run() {
    let ball = |e: f64| {
        bead(
            "constraints: {wall: x - 1}
phases: {free: []}
events: {hit: {when: x - 1, phase: free, then: {impact: e, along: wall}}}
scene: {start: {x: 0, x': 1}, until: 2}",
        )
        .set("e", e)
        .try_run()
    };
    near(ball(1.0).expect("a motion").last()["x'"], -1.0, 1e-12);
    let Err(Error::Run(failure)) = ball(1.25) else { panic!("a motion") };
    assert_eq!((failure.state.t, failure.cause), (0.0, Cause::BadRestitution { value: 1.25 }));
}

const BALL: &str = "gravity: [0, -g]
constraints: {floor: y, rail: x, slant: x - y}
events: {hit: {when: y, direction: falling, phase: [flight, guided], then: {impact: e, along: floor}}}
scene: {start: {x: 0, y: 5, x': 1}, until: 4, tolerance: 1e-12}
";

/// The first phase of the file that has the present constraints and the one that is hit, and no other.
#[test]
fn where_impacts_accumulate_the_run_goes_on_in_the_first_phase_with_one_constraint_more() {
    let phases = "phases: {flight: [], guided: [rail], both: [rail, floor], more: [floor, slant], rest: [floor], rest_too: [floor]}\n";
    let run = bead(&format!("{phases}{BALL}")).run();
    let phases: Vec<usize> = run.phases.iter().map(|(_, phase)| *phase).collect();
    assert_eq!(phases, [0, 4]);
    near(run.phases[1].0, 3.0, 1e-6);
    assert!(run.warnings.iter().any(|w| matches!(w, Warning::ImpactsAccumulate { event, .. } if event == "hit")));
    near(run.last()["x"], 4.0, 1e-9);
    near(run.last()["y"], 0.0, 1e-14);
}

#[test]
fn where_impacts_accumulate_and_no_phase_is_for_rest_is_an_error() {
    let phases = "phases: {flight: [], guided: [rail], both: [rail, floor], more: [floor, slant]}\n";
    let Err(Error::Run(failure)) = bead(&format!("{phases}{BALL}")).try_run() else { panic!("a motion") };
    let Cause::ImpactsAccumulate { event, t } = failure.cause else { panic!("{}", failure.cause) };
    assert_eq!(event, "hit");
    near(t, 3.0, 1e-6);
}

/// Jumps, poles and ends of definition are told, and count nothing; so is a touch.
#[test]
fn jumps_poles_undefined_functions_and_touches_are_no_crossings_and_are_told() {
    type Told = fn(&Warning) -> Option<(&str, f64)>;
    let no_crossing: Told = |warning| match warning {
        Warning::NoCrossing { event, t } => Some((event, *t)),
        _ => None,
    };
    // A sample may hit a pole, where there is no value.
    let pole: Told = |warning| match warning {
        Warning::NoCrossing { event, t } | Warning::Undefined { event, t } => Some((event, *t)),
        _ => None,
    };
    let undefined: Told = |warning| match warning {
        Warning::Undefined { event, t } => Some((event, *t)),
        _ => None,
    };
    let touch: Told = |warning| match warning {
        Warning::Touch { event, t } => Some((event, *t)),
        _ => None,
    };
    let cases = [
        ("step(x - 1) - 1/2", no_crossing, 1.0),
        ("sign(x - 1.2)", no_crossing, 1.2),
        ("1/(x - 1.3) + 1/10", pole, 1.3),
        ("tan(x)", pole, PI / 2.0),
        ("sqrt(x - 0.7)", undefined, 0.7),
        ("ln(2.5 - x) + 100", undefined, 2.5),
        ("(x - 1.1)^2", touch, 1.1),
    ];
    for (when, told, t) in cases {
        let run = runner(&format!("events: {{odd: {{when: {when}, then: record}}}}")).until(2.9).run();
        same(&run, &[]);
        let told: Vec<(&str, f64)> = run.warnings.iter().filter_map(told).collect();
        assert_eq!(told.len(), 1, "{when}: {:?}", run.warnings);
        assert_eq!(told[0].0, "odd");
        near(told[0].1, t, 1e-6);
    }
}

/// The neighbour of the above: what passes through zero continuously counts, however.
#[test]
fn a_kink_or_a_steep_slope_at_zero_is_a_crossing() {
    for when in ["(x - 1)*abs(x - 1)", "max(x - 1, 2*x - 2)", "tanh(1e6*(x - 1))", "(x - 1)^3 + (x - 1)/1000"] {
        same(&runner(&format!("events: {{odd: {{when: \"{when}\", then: record}}}}")).run(), &[("odd", 1.0)]);
    }
}
