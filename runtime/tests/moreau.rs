//! Time stepping over contacts (`--method moreau`): against closed forms, against runs that locate events, and by what piles must do.
#![cfg(feature = "interpret")]

use dalembert::mechanism::{ContactMode, Interpreted, System};
use dalembert::{Cause, Error, Method, Run, Settings, Stepping, Unsteppable, simulate};
use dalembert_symbolic::lower::compile;

#[test]
fn deriver_and_mechanisms_know_of_as_many_combinations() {
    assert_eq!(dalembert::mechanism::MOST_COMBINATIONS, dalembert_symbolic::model::MOST_COMBINATIONS);
}

const BALL: &str = "
name: Dropped
parameters: {m: 1 kg, g: 9.81 m/s^2, e: 0.6, up: 1 m}
coordinates: {y: m}
bodies: {ball: {mass: m, position: '[0, y]'}}
gravity: [0, -g]
contacts: {floor: {gap: y, on: ball, normal: '[0, 1]', restitution: e}}
scene: {start: {y: up}, until: 1.2, tolerance: 1e-11}
";

/// A block on a slope, seen from the slope.
const SLOPE: &str = "
name: Slope
parameters: {m: 2 kg, g: 9.81 m/s^2, tilt: 0.3 rad, mu: 0.4, v0: 1 m/s}
coordinates: {x: m, y: m}
bodies: {block: {mass: m, position: '[x, y]'}}
gravity: [g*sin(tilt), -g*cos(tilt)]
contacts: {floor: {gap: y, on: block, normal: '[0, 1]', friction: mu}}
outputs: {pressed: reaction(floor), held: reaction(floor.friction)}
scene: {start: {x': v0}, until: 3, tolerance: 1e-11}
";

/// Five blocks side by side: 1024 combinations.
const FIVE: &str = "
name: Five
sizes: {n: 5}
parameters: {m: 1 kg, g: 9.81 m/s^2, 'mu[i in 1..n]': [0.1, 0.2, 0.3, 0.4, 0.5], 'v[i in 1..n]': [1, 2, 3, 2, 1]}
coordinates: {'x[i in 1..n]': m, 'y[i in 1..n]': m}
bodies: {'b[i in 1..n]': {mass: m, position: '[x[i], y[i]]'}}
gravity: [0, -g]
contacts: {'floor[i in 1..n]': {gap: 'y[i]', on: 'b[i]', normal: '[0, 1]', friction: 'mu[i]'}}
scene: {start: {\"x[i in 1..n]'\": 'v[i]'}, until: 2}
";

const PUCK: &str = "
name: Puck
parameters: {m: 0.2 kg, g: 9.81 m/s^2, mu: 0.25}
coordinates: {x: m, y: m, z: m}
bodies: {puck: {mass: m, position: '[x, y, z]'}}
gravity: [0, 0, -g]
contacts: {ice: {gap: z, on: puck, normal: '[0, 0, 1]', friction: mu}}
scene: {start: {x': 1.2, y': 0.9}, until: 1, tolerance: 1e-11}
";

const THROWN: &str = "
name: Thrown
parameters: {m: 2 kg, R: 0.1 m, g: 10 m/s^2, mu: 0.3, e: 0.5}
coordinates: {x: m, y: m, z: m, att: rotation}
frames: {B: {rotate: att}}
bodies: {ball: {mass: m, inertia: ['2*m*R^2/5', '2*m*R^2/5', '2*m*R^2/5'], frame: B, position: '[x, y, z]'}}
gravity: [0, 0, -g]
contacts: {floor: {gap: z - R, on: ball, at: '[x, y, z - R]', normal: '[0, 0, 1]', friction: mu, restitution: e}}
scene: {start: {x: 0, y: 0, z: R, x': 3, y': 1.2, z': 1, att': {ground: [20, -30, 15]}}, until: 0.5, tolerance: 1e-11}
";

/// A bob on a rod, which is a constraint, beside a wall.
const ROD: &str = "
name: Rod
parameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2, e: 0.4, wall: 0.2 m}
coordinates: {x: m, y: m}
bodies: {bob: {mass: m, position: '[x, y]'}}
gravity: [0, -g]
constraints: {rod: x^2 + y^2 - l^2}
contacts: {wall: {gap: x + wall, on: bob, normal: '[1, 0]', restitution: e}}
outputs: {pull: reaction(rod)}
scene: {start: {x: 0.6}, guess: {y: -1}, until: 1.5, tolerance: 1e-11}
";

/// Friction whose limit is made of a reaction of a constraint.
const RAIL: &str = "
name: Rail
parameters: {m: 1 kg, g: 9.81 m/s^2, mu: 0.2, v0: 2 m/s}
coordinates: {x: m, y: m}
bodies: {shoe: {mass: m, position: '[x, y]'}}
gravity: [0, -g]
constraints: {rail: y}
friction: {rub: {rate: x', on: shoe, along: '[1, 0]', limit: mu*reaction(rail)}}
scene: {start: {x': v0}, until: 2}
";

/// A box that falls a little, and is pushed by a sampled controller, and later by a force that jumps; sticking holds more than sliding.
const SAMPLED: &str = "
name: Sampled
parameters: {m: 1 kg, g: 9.81 m/s^2, mu: 0.3, k: 20 N/m, F: 2 N, t1: 0.713 s, goal: 0.5 m, mark: 0.4 m}
coordinates: {x: m, y: m}
inputs: {push: F*step(t - t1)}
memory: {u: 0 N, n: 0}
bodies: {box: {mass: m, position: '[x, y]'}}
gravity: [0, -g]
forces: {drive: {on: box, force: '[u + push, 0]'}}
contacts: {floor: {gap: y, on: box, normal: '[0, 1]', friction: mu, static: 1.3*mu, restitution: 0.3}}
events:
  tick: {every: 50 ms, then: [{set: {u: k*(goal - x), n: n + 1}}]}
  passes: {when: x - mark, direction: rising, then: record}
scene: {start: {y: 0.05}, until: 2, tolerance: 1e-10}
";

fn mechanism(text: &str) -> Interpreted {
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
    Interpreted::new(program, text)
}

fn of_file(path: &str) -> String {
    let path = format!("{}/../{path}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn tried(system: &mut Interpreted, change: impl FnOnce(&mut Settings)) -> Result<Run, Error> {
    let mut settings = Settings::new(&system.scene(0));
    change(&mut settings);
    simulate(system, &settings)
}

/// By time stepping.
fn stepped(system: &mut Interpreted, h: f64, change: impl FnOnce(&mut Settings)) -> Run {
    let run = tried(system, |settings| {
        (settings.method, settings.step) = (Method::Moreau, Some(h));
        change(settings);
    });
    run.unwrap_or_else(|error| panic!("{error}"))
}

/// With a parameter.
fn with(text: &str, values: &[(&str, f64)]) -> Interpreted {
    let mut system = mechanism(text);
    for (name, value) in values {
        let place = system.description().parameters.iter().position(|parameter| parameter.name == *name);
        system.set_parameter(place.expect("a parameter"), *value);
    }
    system
}

/// The largest differences of places to a run that locates events, of runs with steps h and h/4, each a mean over starts that steps do not keep step with.
fn errors(text: &str, starts: &[(&str, f64)], h: f64) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for start in starts {
        let mut system = with(text, &[*start]);
        let exact = tried(&mut system, |_| ()).unwrap_or_else(|error| panic!("{error}"));
        for (sum, h) in sums.iter_mut().zip([h, 0.25 * h]) {
            let run = stepped(&mut system, h, |_| ());
            let apart = |(a, b): (dalembert::State, dalembert::State)| {
                a.q.iter().zip(&b.q).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()))
            };
            let worst = exact.states().zip(run.states()).map(apart).fold(0.0, f64::max);
            *sum += worst / starts.len() as f64;
        }
    }
    sums
}

/// A quarter of the step has a quarter of the error, or less: smooth parts of a motion are of the second order.
#[track_caller]
fn is_of_first_order([coarse, fine]: [f64; 2]) {
    let ratio = coarse / fine;
    assert!(ratio >= 2.2, "{coarse:e} and {fine:e}: ratio {ratio}");
}

#[test]
fn a_ball_hops_as_events_have_it_to_the_first_order() {
    let starts: Vec<(&str, f64)> = (0..8).map(|k| ("up", 1.0 + 0.013 * f64::from(k))).collect();
    let found = errors(BALL, &starts, 2e-3);
    is_of_first_order(found);
    assert!(found[1] < 1e-2, "{found:?}");
}

#[test]
fn a_block_on_a_slope_stops_and_stays_where_friction_holds_it() {
    let (tilt, g, v0, mu) = (0.3_f64, 9.81, 1.0, 0.4);
    let mut system = mechanism(SLOPE);
    let run = stepped(&mut system, 1e-3, |_| ());
    let slows = g * (mu * tilt.cos() - tilt.sin());
    let last = run.last();
    assert!((last["x"] - 0.5 * v0 * v0 / slows).abs() < 3e-3, "{}", last["x"]);
    assert!(last["x'"].abs() < 1e-9 && last["y"].abs() < 1e-12);
    // Once it rests it does not creep: the exact values of the end.
    let x = run.column("x").unwrap();
    let stopped = x[x.len() - 20];
    assert!((last["x"] - stopped).abs() < 1e-9);
    assert!((last["pressed"] - 2.0 * g * tilt.cos()).abs() < 1e-8, "{}", last["pressed"]);
    assert!((last["held"] + 2.0 * g * tilt.sin()).abs() < 1e-8, "{}", last["held"]);
    let history = &run.contacts()[0];
    assert_eq!(
        history.modes.iter().map(|(mode, _)| *mode).collect::<Vec<_>>(),
        [ContactMode::SlipsForwards, ContactMode::Sticks]
    );
    let slides = v0 / slows;
    assert!((history.modes[0].1 - slides).abs() < 3e-3, "{history:?}");
}

#[test]
fn beyond_the_angle_of_friction_a_block_slides_on() {
    let (g, mu) = (9.81, 0.4);
    for (tilt, slides) in [(0.38_f64, false), (0.381_f64, true)] {
        let mut system = with(SLOPE, &[("tilt", tilt), ("v0", 0.0)]);
        let run = stepped(&mut system, 1e-3, |_| ());
        let a = if slides { g * (tilt.sin() - mu * tilt.cos()) } else { 0.0 };
        assert!((run.last()["x'"] - 3.0 * a).abs() < 1e-9, "{tilt}: {}", run.last()["x'"]);
    }
}

#[test]
fn a_stack_stays_where_it_is() {
    let text = "
name: Stack
sizes: {n: 8}
parameters: {m: 1 kg, g: 9.81 m/s^2, d: 0.1 m}
coordinates: {'y[i in 1..n]': m}
bodies: {'b[i in 1..n]': {mass: m*i, position: '[0, y[i]]'}}
gravity: [0, -g]
contacts:
  floor: {gap: 'y[1]', on: 'b[1]', normal: '[0, 1]'}
  'on[i in 2..n]': {gap: 'y[i] - y[i-1] - d', on: 'b[i]', from: 'b[i-1]', normal: '[0, 1]'}
scene: {start: {'y[i in 1..n]': 'd*(i-1)'}, until: 5}
";
    let run = stepped(&mut mechanism(text), 1e-2, |_| ());
    let (first, last) = (run.first(), run.last());
    assert!(first.q.iter().zip(&last.q).all(|(a, b)| (a - b).abs() < 1e-9), "{last}");
    assert!(last.v.iter().all(|v| v.abs() < 1e-8), "{last}");
    let over = run.stepped_over().unwrap();
    assert!((over.contacts[0].force[0] - 36.0 * 9.81).abs() < 1e-6, "{over:?}");
    assert!(over.deepest.unwrap().depth < 1e-9);
}

#[test]
fn in_space_a_puck_slides_straight_and_a_ball_comes_to_roll() {
    let run = stepped(&mut mechanism(PUCK), 1e-3, |_| ());
    let (way, last) = (0.5 * 1.5 * 1.5 / (0.25 * 9.81), run.last());
    assert!((last["x"] - 0.8 * way).abs() < 2e-3 && (last["y"] - 0.6 * way).abs() < 2e-3, "{last}");
    assert!(last["x'"].hypot(last["y'"]) < 1e-9);
    let starts: Vec<(&str, f64)> = (0..3).map(|k| ("e", 0.5 + 0.01 * f64::from(k))).collect();
    let found = errors(THROWN, &starts, 1e-3);
    is_of_first_order(found);
    assert!(found[1] < 2e-2, "{found:?}");
}

#[test]
fn models_of_the_library_agree_with_their_events_to_the_first_order() {
    let around = |name: &'static str, middle: f64| -> Vec<(&'static str, f64)> {
        (0..6).map(|k| (name, middle * (1.0 + 0.0073 * (f64::from(k) - 2.5)))).collect()
    };
    let two_blocks = errors(&of_file("models/two_blocks.yaml"), &around("w", 5.0), 2e-3);
    is_of_first_order(two_blocks);
    assert!(two_blocks[1] < 1e-3, "{two_blocks:?}");
    let ladder = errors(&of_file("models/ladder.yaml"), &around("tilt", 0.5), 1e-3);
    is_of_first_order(ladder);
    let rocking = errors(&of_file("models/rocking_block.yaml"), &around("tilt", -0.15), 1e-3);
    is_of_first_order(rocking);
    let belt = errors(&of_file("tests/states/belt.yaml"), &around("k", 100.0), 1e-3);
    is_of_first_order(belt);
}

#[test]
fn constraints_take_part_with_impulses_of_their_own() {
    let starts: Vec<(&str, f64)> = (0..10).map(|k| ("wall", 0.2 + 0.0071 * f64::from(k))).collect();
    let found = errors(ROD, &starts, 1e-3);
    is_of_first_order(found);
    assert!(found[1] < 1e-2, "{found:?}");
    let mut system = mechanism(ROD);
    let run = stepped(&mut system, 1e-3, |_| ());
    assert!(run.residuals.unwrap().position < 1e-12);
    let exact = tried(&mut system, |_| ()).unwrap();
    assert!((run.last()["pull"] - exact.last()["pull"]).abs() < 0.1, "{} {}", run.last(), exact.last());
    let run = stepped(&mut mechanism(RAIL), 1e-3, |_| ());
    assert!((run.last()["x"] - 4.0 / (2.0 * 0.2 * 9.81)).abs() < 2e-3, "{}", run.last());
}

#[test]
fn more_combinations_than_phases_are_for_time_stepping_alone() {
    let mut system = mechanism(FIVE);
    assert_eq!(system.description().phases.len(), 16);
    for method in [Method::Dop853, Method::Auto] {
        let error = tried(&mut system, |settings| settings.method = method).unwrap_err();
        assert!(matches!(error, Error::TooManyCombinations { contacts: 5, combinations: Some(1024), .. }), "{error}");
        let said = error.to_string();
        assert!(said.contains("1024 combinations") && said.contains("--method moreau"), "{said}");
    }
    let run = stepped(&mut system, 1e-3, |_| ());
    let last = run.last();
    for (i, (mu, v)) in [(0.1, 1.0), (0.2, 2.0), (0.3, 3.0), (0.4, 2.0), (0.5, 1.0)].into_iter().enumerate() {
        let x = last[format!("x[{}]", i + 1).as_str()];
        assert!((x - v * v / (2.0 * mu * 9.81)).abs() < 2e-3, "{i}: {x}");
    }
    let over = run.stepped_over().unwrap();
    assert_eq!(over.closed, 5);
    assert!(over.contacts.iter().all(|contact| (contact.force[0] - 9.81).abs() < 1e-8), "{over:?}");
    // What friction took is all that there was.
    assert!((over.work + 0.5 * (1.0 + 4.0 + 9.0 + 4.0 + 1.0)).abs() < 1e-9, "{over:?}");
}

/// Discs in a box.
fn pile(n: usize, columns: usize) -> String {
    let (mut xs, mut ys) = (Vec::new(), Vec::new());
    for i in 0..n {
        let (row, column) = (i / columns, i % columns);
        // No two rows are above each other.
        xs.push(0.022 + 0.22 * (0.5 + column as f64) + if row % 2 == 0 { -0.012 } else { 0.015 } + 0.0007 * i as f64);
        ys.push(0.12 + 0.23 * row as f64);
    }
    format!(
        "
name: Pile
sizes: {{n: {n}}}
parameters: {{m: 1 kg, r: 0.1 m, g: 9.81 m/s^2, mu: 0.3, w: {width} m}}
coordinates: {{'x[i in 1..n]': m, 'y[i in 1..n]': m, 'a[i in 1..n]': rad}}
bodies: {{'d[i in 1..n]': {{mass: m, position: '[x[i], y[i]]', inertia: m*r^2/2, angle: 'a[i]'}}}}
gravity: [0, -g]
contacts:
  'floor[i in 1..n]': {{gap: 'y[i] - r', on: 'd[i]', at: '[x[i], y[i] - r]', normal: '[0, 1]', friction: mu}}
  'left[i in 1..n]': {{gap: 'x[i] - r', on: 'd[i]', at: '[x[i] - r, y[i]]', normal: '[1, 0]', friction: mu}}
  'right[i in 1..n]': {{gap: 'w - x[i] - r', on: 'd[i]', at: '[x[i] + r, y[i]]', normal: '[-1, 0]', friction: mu}}
  'pair[i in 1..n, j in i+1..n]':
    gap: 'sqrt((x[j] - x[i])^2 + (y[j] - y[i])^2) - 2*r'
    on: 'd[j]'
    from: 'd[i]'
    at: '[(x[i] + x[j])/2, (y[i] + y[j])/2]'
    normal: '[x[j] - x[i], y[j] - y[i]]'
    friction: mu
outputs: {{energy: energy}}
scene: {{start: {{'x[i in 1..n]': {xs:?}, 'y[i in 1..n]': {ys:?}}}, until: 4, every: 0.05}}
",
        width = 0.22 * columns as f64 + 0.06,
    )
}

#[test]
fn a_pile_of_discs_comes_to_rest_and_presses_with_its_weight() {
    let mut system = mechanism(&pile(12, 4));
    assert_eq!(system.contacts().all.len(), 12 * 3 + 66);
    let run = stepped(&mut system, 2e-3, |settings| settings.digits = false);
    // A step in which what falls is caught in part gives a disc up to m (g h)²/8.
    let gained = 25.0 * 12.0 * (9.81_f64 * 2e-3).powi(2) / 8.0;
    for pair in run.column("energy").unwrap().windows(2) {
        assert!(pair[1] <= pair[0] + gained, "{pair:?}");
    }
    let last = run.last();
    assert!(last.v.iter().all(|v| v.abs() < 1e-6), "{last}");
    let over = run.stepped_over().unwrap();
    let of =
        |name: &str| over.contacts.iter().filter(|c| c.name.starts_with(name)).map(|c| c.force).collect::<Vec<_>>();
    let floor: f64 = of("floor").iter().map(|force| force[0]).sum();
    // Of walls friction holds a part, downwards along [0, −1] at the left one and [0, 1] at the right one.
    let walls =
        of("left").iter().map(|force| -force[1]).sum::<f64>() + of("right").iter().map(|force| force[1]).sum::<f64>();
    assert!((floor + walls - 12.0 * 9.81).abs() < 1e-5, "{floor} and {walls}");
    let deepest = over.deepest.as_ref().unwrap();
    assert!(deepest.depth < 1e-2, "{deepest:?}");
    assert!(over.residual <= 1e-9, "{}", over.residual);
    // Again, to the bit.
    let again = stepped(&mut system, 2e-3, |settings| settings.digits = false);
    assert_eq!(run.state_rows(), again.state_rows());
}

#[test]
fn ticks_inputs_that_jump_and_events_go_with_steps_over_contacts() {
    let mut system = mechanism(SAMPLED);
    let exact = tried(&mut system, |_| ()).unwrap();
    let run = stepped(&mut system, 2.5e-4, |_| ());
    assert_eq!(run.memory("n"), Some(41.0));
    assert!((run.last()["x"] - exact.last()["x"]).abs() < 2e-3, "{} {}", run.last(), exact.last());
    let passes = |run: &Run| run.events.iter().filter(|e| e.name == "passes").map(|e| e.state.t).collect::<Vec<f64>>();
    let [by_steps, by_events] = [&run, &exact].map(passes);
    assert!(by_steps.len() == 1 && by_events.len() == 1, "{by_steps:?} {by_events:?}");
    assert!((by_steps[0] - by_events[0]).abs() < 5e-4, "{by_steps:?} {by_events:?}");
    assert_eq!(run.events.len(), 1, "events of contacts are not looked for");
    // At its end it is held by less than the limit of sticking, and does not creep.
    assert!(run.last()["x'"].abs() < 1e-9);
}

#[test]
fn promised_digits_hold() {
    for h in [4e-3, 1e-3] {
        let mut system = mechanism(SLOPE);
        let exact = tried(&mut system, |_| ()).unwrap().last()["x"];
        let run = stepped(&mut system, h, |settings| settings.digits = true);
        let digits = run.digits("x").expect("digits");
        let off = (run.last()["x"] - exact).abs() / exact.abs();
        assert!(off <= 10.0_f64.powi(-(digits as i32)), "{digits} digits, {off:e} off");
    }
}

#[test]
fn steps_by_hand_are_those_of_a_run() {
    let mut system = mechanism(BALL);
    let run = stepped(&mut system, 1e-3, |settings| (settings.until, settings.digits) = (1.0, false));
    let mut settings = Settings::new(&system.scene(0));
    (settings.method, settings.step, settings.until) = (Method::Moreau, Some(1e-3), 1.0);
    let mut stepping = Stepping::new(system, settings).unwrap();
    for _ in 0..1000 {
        stepping.step().unwrap();
    }
    assert!((stepping.state()["y"] - run.last()["y"]).abs() < 1e-9);
    // Thrown up by hand, it lands again.
    *stepping.state_mut().v.first_mut().unwrap() = 3.0;
    for _ in 0..2000 {
        stepping.step().unwrap();
    }
    assert!(stepping.state()["y"] > -1e-3 && stepping.state()["y"] < 0.05, "{}", stepping.state());
}

#[test]
fn what_does_not_fit_is_refused_in_words() {
    let moreau = |settings: &mut Settings| (settings.method, settings.step) = (Method::Moreau, Some(1e-3));
    let error = tried(&mut mechanism(BALL), |settings| settings.method = Method::Moreau).unwrap_err();
    assert!(matches!(error, Error::NoStep { method: Method::Moreau }), "{error}");
    let free = BALL.replace("contacts:", "# contacts:");
    let error = tried(&mut mechanism(&free), moreau).unwrap_err();
    assert!(matches!(error, Error::NoTimeStepping { reason: Unsteppable::NoContacts }), "{error}");
    let watched = SLOPE.replace("outputs:", "events: {light: {when: reaction(floor) - 3*m*g, then: stop}}\noutputs:");
    let refused = |text: &str| match tried(&mut mechanism(text), moreau) {
        Err(Error::NoTimeStepping { reason }) => reason,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(&watched), Unsteppable::Event { event: "light".to_owned() });
    let rubbed = ROD.replace("contacts:", "forces: {drag: {on: bob, force: '[-0.1*l*reaction(rod), 0]'}}\ncontacts:");
    assert_eq!(refused(&rubbed), Unsteppable::Reaction { constraint: "rod".to_owned() });
    let buried = with(BALL, &[("up", -0.1)]);
    let error = tried(&mut { buried }, moreau).unwrap_err();
    assert!(matches!(error.cause(), Some(Cause::Penetrates { gap, .. }) if (gap + 0.1).abs() < 1e-12), "{error}");
    let drives = with(SLOPE, &[("mu", -0.4)]);
    let error = tried(&mut { drives }, moreau).unwrap_err();
    assert!(matches!(error.cause(), Some(Cause::NegativeLimit { is_coefficient: true, .. })), "{error}");
}
