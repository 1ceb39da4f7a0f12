//! Loops by hand, what a run costs, digits.

use dalembert::mechanism::{Interpreted, System};
use dalembert::{Error, Method, Simulation};
use dalembert_symbolic::lower::compile;

use super::case;

fn interpreted(text: &str) -> Interpreted {
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
    Interpreted::new(program, text)
}

/// A pendulum with a motor at its hinge, drawn, hanging or driven.
const ROBOT: &str = r#"
name: Robot
parameters: {m: 1 kg, l: 0.5 m, g: 9.81 m/s^2}
coordinates: {theta: rad}
inputs: {torque: 0 N*m}
points: {tip: "l*[sin(theta), -cos(theta)]"}
bodies: {bob: {mass: m, position: tip}}
gravity: [0, -g]
generalized_forces: {theta: torque}
draw: [{line: [[0, 0], tip]}]
scene: {start: {theta: 0.3}, until: 1}
"#;

/// A loop of ticks of 5 ms with a controller that brings the bob to rest; the evaluations of each thousand ticks.
fn controlled(simulation: Simulation<Interpreted>, ticks: u32) -> (dalembert::Run, Vec<u64>) {
    let mut run = simulation.by_hand().unwrap();
    let mut evaluations = Vec::new();
    for tick in 0..ticks {
        let state = run.state();
        run.set_input("torque", -3.0 * state["theta"] - state["theta'"]).unwrap();
        run.advance(0.005).unwrap_or_else(|error| panic!("tick {tick}: {error}"));
        if tick % 1000 == 999 {
            evaluations.push(run.work().evaluations);
        }
    }
    (run.finish(), evaluations)
}

#[test]
fn ticks_by_hand_cost_the_same_and_keep_nothing() {
    let (run, evaluations) = controlled(Simulation::new(interpreted(ROBOT)), 8000);
    assert!(run.len() <= 3 && run.events.is_empty(), "{run:?}");
    let costs: Vec<u64> = evaluations.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let (least, most) = (costs.iter().min().unwrap(), costs.iter().max().unwrap());
    assert!(*most < 2 * *least, "{costs:?}");
}

#[test]
fn a_recorded_loop_keeps_every_state_and_its_pictures() {
    let mut run = Simulation::new(interpreted(ROBOT)).by_hand().unwrap().recorded();
    for _ in 0..300 {
        run.set_input("torque", 0.1).unwrap();
        run.advance(0.005).unwrap();
    }
    let run = run.finish();
    assert_eq!(run.len(), 301);
    assert!(run.at(0.7512).is_some());
}

#[test]
fn a_mechanism_that_stands_still_never_ends_for_want_of_steps() {
    // What has decayed, or was set to next to nothing, to where squares underflow; with few steps allowed for a tick.
    for start in [0.3, 1e-149, 1e-200, 1e-310, 0.0] {
        let simulation = Simulation::new(interpreted(ROBOT)).starting("theta", start).max_steps(40);
        let (run, _) = controlled(simulation, 2000);
        assert!(run.last()["theta"].abs() <= 1e-8 * start, "{start:e}: {}", run.last()["theta"]);
    }
}

#[test]
fn a_held_input_is_what_a_constant_of_the_file_is() {
    let given = ROBOT.replace("torque: 0 N*m", "torque: 0.7 N*m");
    let apart = |text: &str, set: bool, method: Method| {
        let mut run = Simulation::new(interpreted(text)).method(method).tolerance(1e-11).by_hand().unwrap();
        if set {
            run.set_input("torque", 0.7).unwrap();
        }
        (0..200).for_each(|_| assert_eq!(run.advance(0.005).unwrap(), None));
        run.state()["theta"]
    };
    for method in [Method::Dop853, Method::Rkn8, Method::Radau5] {
        assert!((apart(ROBOT, true, method) - apart(&given, false, method)).abs() < 1e-9);
    }
}

#[test]
fn an_input_that_there_is_not_is_named() {
    let mut run = Simulation::new(interpreted(ROBOT)).by_hand().unwrap();
    assert!(matches!(run.set_input("torqe", 1.0), Err(Error::UnknownName { kind: "input", .. })));
    assert!(matches!(run.set_input("torque", f64::NAN), Err(Error::BadSetting { .. })));
    assert!(run.system().signal(0).is_none());
}

#[test]
fn the_debug_text_of_an_error_fits_on_a_screen() {
    let mut case = case(&ROBOT.replace("until: 1", "until: 1000"));
    (case.settings.max_steps, case.settings.every) = (2000, Some(1e-3));
    let error = case.try_run().unwrap_err();
    assert!(format!("{error:?}").len() < 1000);
    assert!(format!("{:#?}", error.partial().unwrap()).len() < 1000);
}

/// What the program prints of a model that rests, or whose outputs cancel.
fn told(name: &str, text: &str) -> String {
    let path = super::folder("control").join(format!("{name}.yaml"));
    std::fs::write(&path, text).unwrap();
    super::program(&["simulate", path.to_str().unwrap()]).unwrap_or_else(|error| panic!("{name}: {error}"))
}

const LEVER: &str = "
name: RestNonlinear
parameters: {J: 0.02 kg*m^2, k: 4000 N/m, a: 0.1 m, s0: 0.03 m}
coordinates: {al: rad}
kinetic_energy: J*al'^2/2
potential_energy: k*(a*sin(al) - s0)^2/2
conserved: {energy: energy}
scene: {start: {al: asin(0.3)}, until: 10}
";

const PLANAR: &str = r#"
name: LeverPlanar
parameters: {J: 0.02 kg*m^2, I: 0.5 kg*m^2, a: 0.1 m, b: 0.2 m, d: 0.3 m, L: 0.3 m, k: 4000 N*m/rad, al0: 0.5 rad}
coordinates: {al: rad, be: rad}
points: {P: "a*[cos(al), sin(al)]", Q: "[d, 0] + b*[cos(be), sin(be)]"}
kinetic_energy: J*al'^2/2 + I*be'^2/2
potential_energy: k*(al - al0)^2/2
constraints: {link: "dot(P - Q, P - Q) - L^2"}
scene: {start: {al: 0.5}, guess: {be: 1.5}, until: 1}
"#;

#[test]
fn a_lever_at_rest_in_a_stable_equilibrium_is_told_nothing() {
    let thousands = LEVER.replace("until: 10", "until: 1e9");
    for (name, text, speeds) in [("lever", LEVER, 1), ("long", &thousands, 1), ("planar", PLANAR, 2)] {
        let told = told(name, text);
        assert!(!told.contains("warning") && !told.contains('?'), "{told}");
        assert_eq!(told.matches("' = 0 rad/s").count(), speeds, "{told}");
        assert!(told.contains("al = 0.30469265401") || told.contains("al = 0.50000000"), "{told}");
    }
}

#[test]
fn a_lever_beside_its_equilibrium_swings() {
    // w^2 = k (a^2 cos(2 al) + a s0 sin(al))/J = k a^2 cos(al)^2/J at rest.
    let w = (4000.0 * 0.01 * (1.0 - 0.09) / 0.02_f64).sqrt();
    for by in [1e-6, 1e-9, 1e-12] {
        let mut case =
            case(&LEVER.replace("asin(0.3)", &format!("asin(0.3) + {by:e}")).replace("until: 10", "until: 1"));
        let run = case.run();
        let moved = run.last()["al"] - 0.3_f64.asin();
        assert!((moved - by * w.cos()).abs() < 2e-2 * by + 1e-15, "{by:e}: {moved:e}");
    }
}

#[test]
fn a_stick_on_its_tip_still_starts_in_an_unstable_equilibrium() {
    let free = ROBOT.replace("inputs: {torque: 0 N*m}\n", "").replace("generalized_forces: {theta: torque}\n", "");
    let up = free.replace("theta: 0.3", "theta: pi").replace("until: 1", "until: 40");
    assert!(told("up", &up).contains("unstable equilibrium"));
    let down = free.replace("theta: 0.3", "theta: 2*pi").replace("until: 1", "until: 40");
    assert!(!told("down", &down).contains("warning"));
}

#[test]
fn outputs_that_cancel_are_zero() {
    let told = told(
        "cancel",
        "
name: ZeroOutput
parameters: {m1: 0.3 kg, m2: 0.7 kg, k: 10 N/m, l: 0.8 m}
coordinates: {x1: m, x2: m}
bodies: {a: {mass: m1, position: \"[x1, 0]\"}, b: {mass: m2, position: \"[x2, 0]\"}}
springs: {s: {between: [a, b], stiffness: k, rest: l}}
outputs: {p: \"m1*x1' + m2*x2'\", centre: \"(m1*x1 + m2*x2)/(m1 + m2)\"}
scene: {start: {x1: -0.7, x2: 0.3}, until: 10}
",
    );
    assert!(told.contains("p = 0 kg*m/s") && told.contains("centre = 0 m"), "{told}");
}
