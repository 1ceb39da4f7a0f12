//! Events early in long steps, starts on guards, accumulating impacts.

use dalembert::mechanism::Method;
use dalembert::{Run, Warning};

use super::{case, folder, program, simulation};

/// A relay's gap of 10 nm that closes under 1 m/s², asked for much longer than that takes.
const GAP: &str = r#"
name: Gap
parameters: {m: 1 kg, a: 1 m/s^2, gap: 10 nm}
coordinates: {x: m}
bodies: {b: {mass: m, position: "[x, 0]"}}
forces: {f: {on: b, force: "[-m*a, 0]"}}
events: {contact: {when: x, direction: falling, then: stop}}
scene: {start: {x: gap}, until: 1 h, tolerance: 1e-10}
"#;

#[test]
fn an_event_early_in_a_run_of_one_step_was_missed() {
    // t = sqrt(2 gap/a), whatever is asked for.
    for until in [1.0, 3600.0, 1e9, 1e12] {
        let mut gap = case(GAP);
        gap.settings.until = until;
        let run = gap.run();
        let [contact] = run.events.as_slice() else { panic!("until {until}: {:?}", run.events) };
        assert!((contact.state.t / 2e-8_f64.sqrt() - 1.0).abs() < 1e-10, "until {until}: {}", contact.state.t);
    }
}

#[test]
fn a_start_that_leaves_a_surface_meets_it_no_sooner_than_it_returns() {
    // Thrown up from the surface at 1e-4 m/s it is back after 2 v/a.
    for until in [1.0, 1e9] {
        let mut thrown = case(&GAP.replace("start: {x: gap}", "start: {x: 0, x': 1e-4}"));
        thrown.settings.until = until;
        let run = thrown.run();
        let [contact] = run.events.as_slice() else { panic!("until {until}: {:?}", run.events) };
        assert!((contact.state.t / 2e-4 - 1.0).abs() < 1e-10, "until {until}: {}", contact.state.t);
    }
}

const BALL: &str = r#"
name: Ball
parameters: {m: 1 kg, e: 0.5 1, g: 9.81 m/s^2}
coordinates: {x: m, y: m}
bodies: {ball: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
constraints: {floor: y}
phases: {flight: [], resting: [floor]}
events: {bounce: {phase: flight, when: y, direction: falling, then: {impact: e, along: floor}}}
scene: {start: {x: 0, x': 1, y: 1}, until: 3, tolerance: 1e-12}
"#;

#[test]
fn a_ball_fell_through_the_floor_of_a_long_run() {
    // Infinitely many flights end at sqrt(2 H/g) (1 + e)/(1 - e).
    for (e, until) in [("0.5", 3.0), ("0.5", 1e7), ("0.8", 1e9)] {
        let mut ball = case(&BALL.replace("e: 0.5", &format!("e: {e}")));
        ball.settings.until = until;
        let run = ball.run();
        let e: f64 = e.parse().expect("a number");
        let ends = (2.0_f64 / 9.81).sqrt() * (1.0 + e) / (1.0 - e);
        let [_, (t, phase)] = run.phases.as_slice() else { panic!("{:?}", run.phases) };
        assert!(*phase == 1 && (t - ends).abs() < 1e-10 * ends, "e = {e} until {until}: {t}, not {ends}");
    }
}

#[test]
fn the_last_impulse_of_a_sequence_pulled() {
    let run = case(BALL).run();
    let impulses: Vec<f64> = run.impulses.iter().map(|impulse| impulse.constraints[0].1).collect();
    assert!(impulses.len() > 5 && impulses.iter().all(|impulse| *impulse > 0.0), "{impulses:?}");
    // All together carry the weight from the start until the ball lies: m g t.
    let (sum, t) = (impulses.iter().sum::<f64>(), run.phases[1].0);
    assert!((sum / (9.81 * t) - 1.0).abs() < 1e-9, "{sum} for {t} s");
}

/// Two elastic balls and a wall; the heavier one is turned back after 9934 impacts.
const ELASTIC: &str = r#"
name: Elastic
parameters: {m: 1 kg, M: 1e7 kg, e: 1 1}
coordinates: {x: m, y: m}
bodies: {a: {mass: m, position: "[x, 0]"}, b: {mass: M, position: "[y, 0]"}}
constraints: {w: x, c: y - x}
phases: {free: [], q: [c]}
events:
  wall: {when: x, direction: falling, then: {impact: e, along: w}}
  hit: {phase: free, when: y - x, direction: falling, then: {impact: e, along: c}}
scene: {start: {x: 1, y: 2, y': -1}, until: 10, tolerance: 1e-12}
"#;

#[test]
fn elastic_impacts_never_accumulate() {
    let run = case(ELASTIC).run();
    assert_eq!(run.events.len(), 9934);
    assert_eq!(run.phases.len(), 1, "{:?}", run.phases);
}

/// A ball that starts on the floor, or below it.
fn ball_from(start: &str) -> super::Case {
    case(&BALL.replace("start: {x: 0, x': 1, y: 1}", &format!("start: {{{start}}}")))
}

#[test]
fn what_lay_on_the_floor_fell_through_it() {
    for until in [1e-3, 1.0, 1e9] {
        let mut ball = ball_from("x': 1");
        ball.settings.until = until;
        let run = ball.run();
        assert!(run.last()["y"] == 0.0 && run.phases.last().is_some_and(|(t, phase)| (*t, *phase) == (0.0, 1)));
        assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    }
}

#[test]
fn what_moves_into_the_floor_at_the_start_is_struck() {
    let run = ball_from("x': 1, y': -2").run();
    assert_eq!(run.events[0].state.t, 0.0);
    assert!((run.events[1].state.t - 2.0 / 9.81).abs() < 1e-12, "{:?}", run.events);
}

#[test]
fn what_leaves_the_floor_at_the_start_is_not_struck() {
    let run = ball_from("x': 1, y': 2").run();
    assert!((run.events[0].state.t - 4.0 / 9.81).abs() < 1e-12, "{:?}", run.events);
    assert!(run.warnings.iter().all(|warning| !matches!(warning, Warning::PastAtStart { .. })), "{:?}", run.warnings);
}

/// A hop that is shorter than times can tell is none.
#[test]
fn what_hardly_leaves_the_floor_at_the_start_rests_on_it() {
    for speed in ["1e-100", "1e-14", "1e-13"] {
        let run = ball_from(&format!("x': 1, y': {speed}")).run();
        assert_eq!(run.last()["y"], 0.0, "{speed}");
    }
}

/// A stop at whose zero a run starts, and past which it goes, does nothing: it is named, whether parts of the mechanism run apart or not, unless it happens
/// later.
#[test]
fn a_stop_that_a_start_goes_past_is_named() {
    let told = |text: &str| {
        let run = case(text).run();
        run.warnings.contains(&Warning::NeverPassed { event: "land".to_owned() })
    };
    for (coordinates, position) in [("y: m", "[0, y]"), ("x: m, y: m", "[x, y]")] {
        let fall = |start: &str| {
            format!(
                "name: Fall\nparameters: {{m: 1 kg, g: 10 m/s^2}}\ncoordinates: {{{coordinates}}}\n\
                 bodies: {{b: {{mass: m, position: '{position}'}}}}\ngravity: [0, -g]\n\
                 events: {{land: {{when: y, direction: falling, then: stop}}}}\nscene: {{start: {{{start}}}, until: 1}}\n"
            )
        };
        for start in ["y': 0", "y': -1", "y: -1"] {
            assert!(told(&fall(start)), "{coordinates}: {start}");
        }
        for start in ["y': 1", "y: 1"] {
            assert!(!told(&fall(start)), "{coordinates}: {start}");
        }
    }
    let swing = "name: Swing\nparameters: {w: 1 1/s}\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\npotential_energy: w^2*x^2/2\n\
        events: {land: {when: x', direction: falling, then: stop}}\nscene: {start: {x: 1}, until: 10}\n";
    let run = case(swing).run();
    assert!((run.last().t - 2.0 * std::f64::consts::PI).abs() < 1e-7 && !told(swing), "{}", run.last().t);
}

/// What a run has passed before a value is set by hand, or before it was saved, is past.
#[test]
fn what_was_passed_before_is_not_told() {
    let text = "name: Count\ncoordinates: {x: 1}\ninputs: {u: 0}\nmemory: {n: 0}\nkinetic_energy: x'^2/2\n\
        generalized_forces: {x: u}\nevents: {above: {when: x - 1, direction: rising, then: {set: {n: n + 1}}}}\n\
        scene: {start: {x': 1}, until: 3}\n";
    let told = |run: &Run| run.warnings.iter().any(|warning| matches!(warning, Warning::NeverPassed { .. }));
    let mut by_hand = simulation(text).by_hand().expect("a start");
    for _ in 0..6 {
        by_hand.set_input("u", 1e-3).expect("an input");
        by_hand.advance(0.5).expect("a step");
    }
    assert!(!told(&by_hand.finish()));
    let folder = folder("passed");
    let (path, saved) = (folder.join("count.yaml"), folder.join("saved.yaml"));
    let [path, saved] = [&path, &saved].map(|path| path.to_str().expect("a path"));
    std::fs::write(path, text).expect("a file");
    program(&["simulate", path, "--until", "2", "--save", saved]).expect("a run");
    let later = program(&["simulate", path, "--state", saved, "--until", "3"]).expect("a run");
    assert!(!later.contains("does not happen"), "{later}");
    // A run that begins there does not know of it.
    let beyond = program(&["simulate", path, "--start", "x=2"]).expect("a run");
    assert!(beyond.contains("`above` does not happen"), "{beyond}");
}

#[test]
fn a_start_below_the_floor_is_told() {
    let run = ball_from("y: -1").run();
    let told = |warning: &Warning| *warning == Warning::PastAtStart { event: "bounce".to_owned() };
    assert!(run.events.is_empty() && run.warnings.iter().any(told), "{:?}", run.warnings);
}

/// A slope that is steeper than friction holds, or not.
const SLOPE: &str = r#"
name: Slope
parameters: {m: 1 kg, g: 10 m/s^2, mu: 0.1 1, slope: asin(0.6)}
coordinates: {x: m, y: m}
bodies: {b: {mass: m, position: "[x, y]"}}
gravity: g*[sin(slope), -cos(slope)]
constraints: {floor: y, grip: x'}
phases: {stick: [floor, grip], slide: [floor]}
forces: {rub: {on: b, force: "[-mu*reaction(floor), 0]", phase: slide}}
events:
  slip: {phase: stick, when: "-reaction(grip) - mu*reaction(floor)", direction: rising, then: slide}
outputs: {F: reaction(grip), N: reaction(floor)}
scene: {start: {x: 0}, until: 2, tolerance: 1e-10}
"#;

#[test]
fn a_block_stuck_where_nothing_held_it() {
    // x = (g sin(slope) - mu g cos(slope)) t²/2.
    let run = case(SLOPE).run();
    assert!((run.last()["x"] - 10.4).abs() < 1e-9, "{}", run.last()["x"]);
    let run = case(&SLOPE.replace("mu: 0.1", "mu: 0.8")).run();
    assert!(run.last()["x"] == 0.0 && run.events.is_empty());
}

/// A mass on a belt, held by a spring: it sticks and slips.
const BELT: &str = r#"
name: Belt
parameters: {m: 1 kg, k: 4 N/m, v: 0.5 m/s, hold: 3 N, slide: 1 N}
coordinates: {x: m}
bodies: {b: {mass: m, position: "[x, 0]"}}
constraints: {grip: x' - v}
phases: {stick: [grip], slip: []}
forces: {spring: {on: b, force: "[-k*x, 0]"}, rub: {on: b, force: "[slide, 0]", phase: slip}}
events:
  breaks: {phase: stick, when: reaction(grip) - hold, direction: rising, then: slip}
  catches: {phase: slip, when: v - x', direction: falling, then: stick}
scene: {start: {x: 0, x': 0.5}, until: 12, tolerance: 1e-12}
"#;

#[test]
fn a_run_cut_in_two_at_any_instant_is_the_run_in_one_piece() {
    for text in [BALL, BELT] {
        let whole = case(text).run();
        let events: Vec<f64> = whole.events.iter().map(|event| event.state.t).take(12).collect();
        assert!(events.len() > 4, "{:?}", whole.events);
        let beside = |t: &f64| [t * (1.0 - 2e-16), *t, t * (1.0 + 2e-16), t * (1.0 + 1e-13), 1.1 * t];
        for cut in events.iter().flat_map(beside).filter(|cut| *cut < whole.last().t) {
            let mut first = case(text);
            first.settings.until = cut;
            let first = first.run();
            let mut second = case(text);
            let saved = first.last();
            (second.settings.from, second.settings.phase) =
                (saved.t, first.phases.last().map_or(0, |(_, phase)| *phase));
            (second.settings.q, second.settings.v) = (saved.q.clone(), saved.v.clone());
            let second = second.run();
            let (one, two) = (whole.last(), second.last());
            let off = one.q.iter().chain(&one.v).zip(two.q.iter().chain(&two.v)).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-9, "cut at {cut:e}: {one:?}, not {two:?}");
            assert_eq!(
                whole.phases.last().map(|(_, phase)| phase),
                second.phases.last().map(|(_, phase)| phase),
                "{cut:e}"
            );
            let later = whole.events.iter().filter(|event| event.state.t > cut * (1.0 + 1e-12)).count();
            let seen = second.events.iter().filter(|event| event.state.t > cut * (1.0 + 1e-12)).count();
            // Of impacts that accumulate another number may be followed one by one.
            assert!(later == seen || text == BALL, "cut at {cut:e}: {later} events, not {seen}");
        }
    }
}

/// An event that is only recorded happens in one of the parts of a run that is cut at it: where the first part ends.
#[test]
fn an_event_at_which_a_run_is_cut_is_recorded_once() {
    const COASTING: &str = r#"
name: Coasting
coordinates: {x: 1}
bodies: {b: {mass: 0.4, position: "[x, 0]"}}
generalized_forces: {x: 0.1*sin(3*t)}
events: {gate: {when: x - 0.407387, then: record}}
scene: {start: {x: 0, x': 0.321384}, until: 1.7, tolerance: 1e-8}
"#;
    let whole = case(COASTING).run();
    let t = whole.events[0].state.t;
    assert_eq!(whole.events.len(), 1);
    for ulps in -6..=6 {
        let cut = t * (1.0 + f64::from(ulps) * f64::EPSILON);
        let mut first = case(COASTING);
        first.settings.until = cut;
        let first = first.run();
        let (mut second, saved) = (case(COASTING), first.last());
        (second.settings.from, second.settings.q, second.settings.v) = (saved.t, saved.q, saved.v);
        assert_eq!(first.events.len() + second.run().events.len(), 1, "{ulps}");
    }
    // One that lies farther away is left to the rest of the run.
    let mut first = case(COASTING);
    first.settings.until = t - 1e-9;
    assert_eq!(first.run().events.len(), 0);
}

/// Zeros of the third to ninth order were found where rounding had its last sign: at 1.99814 with 17 digits.
#[test]
fn zeros_of_high_order_were_off_by_a_thousandth() {
    let flat = |functions: &str| {
        let mut flat = case(&format!(
            "name: Flat
coordinates: {{x: 1}}
bodies: {{b: {{mass: 1, position: \"[x, 0]\"}}}}
events: {{{functions}}}
scene: {{start: {{x: 0, x': 1}}, until: 7.9, tolerance: 1e-10}}"
        ));
        flat.settings.digits = true;
        flat.run()
    };
    for power in [1, 3, 5, 7, 9] {
        for factor in ["1", "1e-20", "1e12"] {
            let run = flat(&format!("e: {{when: {factor}*(x - 2)^{power}, then: record}}"));
            let found: Vec<f64> = run.events.iter().map(|event| event.state.t).collect();
            assert!(found.len() == 1 && (found[0] - 2.0).abs() < 1e-12, "{power} {factor}: {found:?}");
        }
    }
    // Multiplied out it is rounding within some 1e-5 of its zero: no more digits are promised.
    let run = flat("e: {when: x^3 - 6*x^2 + 12*x - 8, then: stop}");
    let (t, bound) = (run.last().t, run.errors("x").unwrap()[run.len() - 1]);
    assert!((t - 2.0).abs() <= bound && bound < 1e-3, "{t} {bound:e}");
    // A simple zero keeps its digits.
    let run = flat("e: {when: x - 2, then: stop}");
    assert!(run.digits("x") >= Some(9), "{:?}", run.digits("x"));
}

/// A block that rocks from corner to corner and comes to rest.
const ROCKING: &str = r#"
name: RockingBlock
parameters: {m: 1 kg, g: 9.81 m/s^2, b: 0.2 m, h: 0.5 m}
coordinates: {x: m, y: m, th: rad}
define:
  C: "[x, y]"
  u: "[cos(th), sin(th)]"
  n: "[-sin(th), cos(th)]"
  A: C - b*u - h*n
  B: C + b*u - h*n
bodies: {block: {mass: m, inertia: m*(b^2 + h^2)/3, position: C, angle: th}}
gravity: [0, -g]
constraints: {left: A, right: "B - [2*b, 0]"}
phases: {on_left: [left], on_right: [right], rest: [left, right]}
events:
  to_right: {phase: on_left, when: B.y, direction: falling, then: on_right}
  to_left: {phase: on_right, when: A.y, direction: falling, then: on_left}
scene: {start: {th: 0.05}, guess: {x: 0.2, y: 0.5}, until: 10, tolerance: 1e-10}
"#;

#[test]
fn a_rocking_block_chattered_though_it_has_a_phase_of_rest() {
    let run = case(ROCKING).run();
    let [.., (t, phase)] = run.phases.as_slice() else { panic!("no phases") };
    assert!(*phase == 2 && (run.last()["th"]).abs() < 1e-12 && run.last().t == 10.0, "{:?}", run.last());
    // Each change of the corner leaves 1 - 3/2 b²/(b² + h²) of the speed (Housner 1963), and of the time to the next.
    let times: Vec<f64> = run.events.iter().rev().take(3).map(|event| event.state.t).collect();
    let ratio = (times[0] - times[1]) / (times[1] - times[2]);
    let kept = 1.0 - 1.5 * 0.04 / 0.29;
    assert!((ratio - kept).abs() < 1e-3 && times[0] < *t, "{ratio}, not {kept}");
}

#[test]
fn rest_on_a_roof_of_which_both_sides_lead_away_had_ten_digits() {
    let roof = |force: &str, start: &str| {
        let mut case = case(&format!(
            "name: Roof\ncoordinates: {{x: 1}}\nkinetic_energy: x'^2/2\n{force}\nscene: {{start: {{{start}}}, until: 3, tolerance: 1e-10}}\n"
        ));
        case.settings.digits = true;
        case.run()
    };
    let leaves =
        |run: &dalembert::Run| run.warnings.iter().any(|warning| matches!(warning, Warning::BothSidesLeave { .. }));
    for force in
        ["potential_energy: -abs(x)", "generalized_forces: {x: sign(x)}", "generalized_forces: {x: 2*step(x) - 1}"]
    {
        let run = roof(force, "x: 0");
        assert!(leaves(&run) && run.digits("x") == Some(0), "{force}: {:?}", run.warnings);
        // Beside the edge, or with a speed, the side is known.
        for start in ["x: 1e-9", "x: 0, x': -1e-3"] {
            assert!(!leaves(&roof(force, start)), "{force}, {start}");
        }
    }
    // A valley, and a hill with one side that is level.
    assert!(
        !leaves(&roof("potential_energy: abs(x)", "x: 1")) && !leaves(&roof("potential_energy: -max(x, 0)", "x': 0.1"))
    );
}

#[test]
fn the_impulse_of_a_kink_of_time_in_a_place_was_lost() {
    let shaken = |base: &str, kind: &str| {
        case(&format!(
            "name: Shaken
parameters: {{m: 1 kg, k: 4 N/m, v: 1 m/s, t1: 1 s, T: 1 s}}
coordinates: {{x: m}}
{kind}: {{base: \"{base}\"}}
bodies: {{b: {{mass: m, position: \"[base + x, 0]\"}}}}
springs: {{s: {{stretch: x, stiffness: k, along: \"[1, 0]\", on: b}}}}
scene: {{start: {{x: 0}}, until: 3, tolerance: 1e-12}}
"
        ))
        .run()
    };
    for kind in ["define", "inputs"] {
        // x = -v/2 sin(2 (t - 1)) after the base has set off.
        let run = shaken("v*max(t - t1, 0)", kind);
        assert!((run.last()["x"] + 0.5 * 4.0_f64.sin()).abs() < 1e-10, "{kind}: {}", run.last()["x"]);
        assert!(run.impulses.len() == 1 && (run.impulses[0].jump[0] + 1.0).abs() < 1e-10, "{kind}: {:?}", run.impulses);
        // x = -v/(2 T) (1 - cos(2 (t - 1))) where it sets off without a jerk.
        let run = shaken("v*max(t - t1, 0)^2/T", kind);
        assert!((run.last()["x"] + 0.5 * (1.0 - 4.0_f64.cos())).abs() < 1e-10, "{kind}: {}", run.last()["x"]);
        assert!(run.impulses.is_empty(), "{kind}: {:?}", run.impulses);
    }
}

/// Its block is lifted where g = Y ω² sin ωt, by a reaction that is 0 in the phase in which the run ends.
#[test]
fn the_time_at_which_a_reaction_vanishes_has_its_digits() {
    let text = super::printed("simulate", "shaken_table", &[]);
    let lift = (9.81_f64 / (0.01 * 1600.0)).asin() / 40.0;
    let times: Vec<&str> = text.lines().filter_map(|line| line.trim().strip_prefix("event lift at t = ")).collect();
    let [first, second, ..] = times.as_slice() else { panic!("{text}") };
    let printed = first.parse::<f64>().unwrap_or_else(|_| panic!("{text}"));
    assert!(first.len() > 8 && (printed - lift).abs() < 1e-8, "{first} for {lift}");
    // In the third period of the table, where it rests after its second landing.
    let later = lift + std::f64::consts::TAU / 40.0;
    assert!((second.parse::<f64>().unwrap_or_else(|_| panic!("{text}")) - later).abs() < 1e-6, "{second} for {later}");
}

/// Of two particles that nothing couples, which are run one by one, a clock belongs to neither.
#[test]
fn a_clock_stops_what_is_run_part_by_part() {
    let head = "name: Cut\nparameters: {k: 4 N/m, a: 0.1 m}\ncoordinates: {x: m, y: m}\n";
    let bodies = "bodies: {a1: {mass: 1 kg, position: \"[x, 0]\"}, b: {mass: 1 kg, position: \"[0, y]\"}}\n";
    let spring = "springs: {s: {stretch: x, stiffness: k, on: a1, along: \"[1, 0]\"}}\n";
    let events = "events: {pass: {when: x - a, then: record}, cut: {every: 1 s, from: 300 ms, then: stop}}\n";
    let text = format!("{head}{bodies}{spring}{events}scene: {{start: {{x': 1}}, until: 1}}\n");
    let run = case(&text).run();
    assert_eq!(run.last().t, 0.3);
    assert!((run.last()["x"] - 0.6_f64.sin() / 2.0).abs() < 1e-9, "{}", run.last()["x"]);
    let recorded = case(&text.replace("then: stop", "then: record").replace("every: 1 s", "every: 0.2 s")).run();
    let ticks = recorded.events.iter().filter(|event| event.name == "cut");
    assert_eq!(ticks.count(), 4);
}

/// A pendulum whose pivot turns sharply keeps its momentum: the report says so, with what the kinetic energy gains, the pivot's part included.
#[test]
fn impulses_of_inputs_are_reported_with_their_energy() {
    const PIVOT: &str = r#"
name: Pivot
parameters: {m: 2 kg, l: 0.6 m, g: 9.81 m/s^2, v1: 0.5 m/s, v2: 1.1 m/s, t1: 1 s}
coordinates: {th: rad}
inputs: {u: "v1*t - v2*max(0, t - t1)"}
bodies: {bob: {mass: m, position: "[u + l*sin(th), -l*cos(th)]"}}
gravity: [0, -g]
scene: {start: {th: 0.2}, until: 1, tolerance: 1e-12}
"#;
    // Without a name, by time itself, as well.
    for (text, told) in [
        (PIVOT.to_owned(), "impulse at t = 1: u turns or jumps; kinetic energy"),
        (PIVOT.replace("inputs: {u: \"", "define: {u: \""), "impulse at t = 1: what time moves turns; kinetic energy"),
    ] {
        let run = case(&text).run();
        let (th, after) = (run.last()["th"], run.last()["th'"]);
        let [impulse] = &run.impulses[..] else { panic!("{:?}", run.impulses) };
        assert!((impulse.jump[0] - th.cos() * 1.1 / 0.6).abs() < 1e-9, "{:?}", run.impulses);
        let kinetic = |u: f64, rate: f64| (u + 0.6 * th.cos() * rate).powi(2) + (0.6 * th.sin() * rate).powi(2);
        let gain = kinetic(-0.6, after) - kinetic(0.5, after - impulse.jump[0]);
        assert!((impulse.energy - gain).abs() < 1e-9, "{} for {gain}", impulse.energy);
        let folder = super::folder("pivot");
        let path = folder.join("pivot.yaml");
        std::fs::write(&path, &text).expect("written");
        let printed = super::program(&["simulate", path.to_str().expect("a path")]).expect("a run");
        assert!(printed.contains(told), "{printed}");
        std::fs::remove_dir_all(folder).expect("removed");
    }
}

/// However |t − 1 s| is written, its corner takes speed: X = x + 2 |t − 1| swings freely between, with X' jumping by nothing.
#[test]
fn corners_that_are_written_as_roots_give_their_impulse() {
    let w = 10.0_f64.sqrt();
    let expected = 3.0 * (2.0 * w).cos() - 2.0 / w * (2.0 * w).sin() - 2.0;
    for corner in [
        "abs(t - t1)",
        "sqrt((t - t1)^2)",
        "norm([t - t1, 0])",
        "((t - t1)^2)^0.5",
        "((t - t1)^2)^1.5/(t - t1)^2",
        "exp(ln((t - t1)^2)/2)",
        "sqrt(abs(t - t1)^2)",
    ] {
        let text = |define: &str, by: &str| {
            format!(
                "name: T\nparameters: {{k: 10, t1: 1}}\ncoordinates: {{x: 1}}\n{define}: {{{by}}}\n\
                 kinetic_energy: \"rate(x + 2*u)^2/2\"\npotential_energy: \"k*(x + 2*u)^2/2\"\n\
                 scene: {{start: {{x: 1}}, until: 2, tolerance: 1e-10}}\n"
            )
        };
        for define in ["inputs", "define"] {
            let x = case(&text(define, &format!("u: \"{corner}\""))).run().last()["x"];
            assert!((x - expected).abs() < 1e-8, "{define}: {corner}: {x}");
        }
    }
}

/// Every half swing is one step from the surface to the surface: whether the motion has left it in between, its middle tells.
#[test]
fn swings_that_are_one_step_each_are_no_chattering() {
    let text = "name: Swing\ncoordinates: {x: }\nkinetic_energy: x'^2/2\ngeneralized_forces: {x: -3*sign(x)}\nscene: {start: {x: 1}, until: 300}\n";
    // Four parts of a period, √(2/3) s each; parabolas.
    let period = 4.0 * (2.0_f64 / 3.0).sqrt();
    let t = 300.0 % period;
    let side = if t < 0.25 * period || t > 0.75 * period { 1.0 } else { -1.0 };
    let from_turn = [t, t - 0.5 * period, t - period].into_iter().fold(f64::MAX, |least, t| t.abs().min(least));
    for method in [Method::Auto, Method::Dop853, Method::Radau5] {
        let mut swing = case(text);
        swing.settings.method = method;
        let x = swing.run().last()["x"];
        assert!((x - side * (1.0 - 1.5 * from_turn * from_turn)).abs() < 1e-6, "{method:?}: {x}");
    }
}

/// A step as long as the run is cut where a function turns too often in it to be followed, and those after it are longer and longer.
#[test]
fn events_of_a_million_radians_are_followed_in_long_steps() {
    let text = |force: &str, start: &str, until: &str| {
        format!(
            "name: LongWay\ncoordinates: {{x: }}\nkinetic_energy: x'^2/2\ngeneralized_forces: {{x: \"{force}\"}}\n\
             events: {{e: {{when: sin(x), direction: rising, then: record}}}}\nscene: {{start: {start}, until: {until}}}\n"
        )
    };
    let free = case(&text("0", "{x: 1, x': 100}", "1e4")).run();
    assert_eq!(free.events.len() as f64, ((1e6 + 1.0) / std::f64::consts::TAU).floor());
    // As another method has it, whose steps are those of the forces.
    let pushed = case(&text("sign(sin(x))", "{x: 1, x': 2}", "1000")).run();
    let mut again = case(&text("sign(sin(x))", "{x: 1, x': 2}", "1000"));
    again.settings.method = Method::Dop853;
    let x = again.run().last()["x"];
    assert!((pushed.last()["x"] - x).abs() < 1e-6 * x.abs(), "{} {x}", pushed.last()["x"]);
}

/// What is set at the instant of a stop is set, in whatever order, by other clocks, and by what follows from it, too.
#[test]
fn values_are_set_at_the_instant_at_which_a_run_stops() {
    let text = |then: &str| {
        format!(
            "name: Clocks\ncoordinates: {{x: m}}\nmemory: {{u: 0, v: 1, w: 0}}\nkinetic_energy: x'^2/2\nevents:\n  \
             a: {{every: 0.3, from: 0.3, then: {then}}}\n  b: {{every: 0.3, then: {{set: {{v: v + 7}}}}}}\n  \
             c: {{on_set: u, then: {{set: {{w: 2*u}}}}}}\nscene: {{start: {{x': 1}}, until: 1}}\n"
        )
    };
    for then in ["[stop, {set: {u: u + 1}}]", "[{set: {u: u + 1}}, stop]"] {
        let run = case(&text(then)).run();
        let last = run.last();
        assert_eq!((last.t, last["u"], last["v"], last["w"]), (0.3, 1.0, 15.0, 2.0), "{then}");
    }
}

/// A pulse is met whatever its width, though both of its ends are zeros of one function, or the step before it was long; what is promised counts that
/// its instants are rounded.
#[test]
fn pulses_of_any_width_are_met() {
    let pulse = |force: &str, t0: f64, w: f64, until: f64| {
        let mut case = case(&format!(
            "name: Pulse\nparameters: {{t0: {t0}, w: {w}}}\ncoordinates: {{x: }}\nkinetic_energy: x'^2/2\n\
             generalized_forces: {{x: \"{force}\"}}\nscene: {{start: {{x: 0}}, until: {until}}}\n"
        ));
        case.settings.digits = true;
        let run = case.run();
        (run.last()["x'"], run.errors("x'").map_or(f64::NAN, |errors| errors[errors.len() - 1]))
    };
    for (force, impulse) in [
        ("max(0, 1 - ((t - t0)/w)^2)*0.75/w", 1.0),
        ("step(w^2 - (t - t0)^2)/w", 2.0),
        ("(step(t - t0 + w) - step(t - t0 - w))/w", 2.0),
        ("max(0, 1 - abs(t - t0)/w)/w", 1.0),
    ] {
        for (t0, w, until) in
            [(0.9, 1e-8, 1.0), (9.0, 1e-10, 1e6), (9e5, 1e-2, 1e6), (9e5, 1e-5, 1e6), (9.0, 0.5, 20.0)]
        {
            let (found, error) = pulse(force, t0, w, until);
            assert!((found - impulse).abs() <= 1.5 * error, "{force}, {w} at {t0}: {found}, off by {error}");
            // 1 - (1 - w/t0) of doubles.
            assert!(error < 1e-7 + 20.0 * f64::EPSILON * t0 / w, "{force}, {w} at {t0}: {error}");
        }
    }
    // In space: out of a hill of 0.75/w (1 - ((x - c)/w)^2), that is by an impulse of energy of 1.
    let mut zone = case(
        "name: Zone\nparameters: {c: 0.9, w: 1e-9}\ncoordinates: {x: }\nkinetic_energy: x'^2/2\n\
         generalized_forces: {x: \"max(0, 1-((x-c)/w)^2)*0.75/w\"}\nscene: {start: {x: 0, x': 10}, until: 0.2}\n",
    );
    assert!((zone.run().last()["x'"] - 102.0_f64.sqrt()).abs() < 1e-6);
}

/// What is set where x rises through 0 is of what was before, and not of what rounding makes of x there; what does not jump is that of the instant.
#[test]
fn values_that_jump_at_an_event_are_set_as_they_were_before() {
    let text = "name: Before\ncoordinates: {x: }\nmemory: {u: 5, v: 5, w: 5, s: 5}\nkinetic_energy: x'^2/2\n\
                generalized_forces: {x: \"-0.1*sign(x)\"}\nevents:\n  r: {when: x, direction: rising, \
                then: {set: {u: sign(x), v: step(x), w: abs(x) + t, s: x'}}}\n\
                scene: {start: {x: -0.1, x': 0.3}, until: 1}\n";
    for (method, step) in [(Method::Auto, None), (Method::Dop853, None), (Method::Rk4, Some(0.01))] {
        let mut case = case(text);
        (case.settings.method, case.settings.step) = (method, step);
        let run = case.run();
        let (last, at) = (run.last(), run.events[0].state.t);
        assert_eq!((last["u"], last["v"]), (-1.0, 0.0), "{method:?}");
        assert!((last["w"] - at).abs() < 1e-12 && (last["s"] - run.events[0].state["x'"]).abs() == 0.0, "{method:?}");
    }
}

/// What decays at once goes nowhere else on the way: the first step of a stiff method is as short as the transient where anything looks into it.
#[test]
fn a_transient_at_the_start_of_a_stiff_run_crosses_nothing() {
    for (tau, method) in
        [("1e-10", Method::Auto), ("1e-9", Method::Auto), ("1e-8", Method::Radau5), ("1e-10", Method::Rodas5P)]
    {
        let mut case = case(&format!(
            "name: Filter\nparameters: {{tau: {tau} s}}\nstates:\n  x: {{unit: 1, rate: 0/tau}}\n  s: {{unit: 1, rate: (x - s)/tau}}\n\
             events: {{over: {{when: s - 1.2, then: stop}}}}\nscene: {{start: {{x: 1}}, until: 1e4, tolerance: 1e-10}}\n"
        ));
        case.settings.method = method;
        let run = case.run();
        assert!(run.events.is_empty() && run.last().t == 1e4, "{tau} {method:?}: {:?}", run.events);
    }
}
