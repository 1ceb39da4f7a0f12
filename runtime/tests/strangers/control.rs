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

/// What `modes --sampled` finds of a text.
fn sampled(name: &str, text: &str) -> serde_json::Value {
    let file = super::folder("control").join(format!("{name}.yaml"));
    std::fs::write(&file, text).expect("a file");
    let told = super::program(&["modes", file.to_str().expect("a path"), "--sampled", "--json"]);
    serde_json::from_str(&told.unwrap_or_else(|error| panic!("{name}: {error}"))).expect("JSON")
}

/// x' = u by a law of proportional and integral parts, whose period is a parameter: 1 + trace + det = 4 − 2 kp T − ki T² is 0 there.
#[test]
fn a_law_that_has_its_period_as_a_parameter_kept_it() {
    let law = |every: &str| {
        format!(
            "name: Law\nparameters: {{kp: 2 1/s, ki: 3 1/s^2, Ts: 0.05 s}}\nstates: {{x: {{unit: m, rate: u}}}}\n\
             memory: {{u: 0 m/s, I: 0 m/s}}\n\
             events: {{tick: {{every: {every}, then: [{{set: {{I: I - ki*Ts*x}}}}, {{set: {{u: I - kp*x}}}}]}}}}\n\
             scene: {{start: {{x: 1}}, until: 1}}\n"
        )
    };
    let (kp, ki) = (2.0_f64, 3.0_f64);
    let with = ((kp * kp + 4.0 * ki).sqrt() - kp) / ki;
    let without = 4.0 / (2.0 * kp + ki * 0.05);
    for (name, every, expected, varied) in [
        ("follows", "Ts", with, vec!["Ts"]),
        ("half", "Ts/2", f64::NAN, vec!["Ts"]),
        ("stays", "50 ms", without, vec![]),
    ] {
        let found = sampled(name, &law(every));
        let critical = found["critical_periods"][0].as_f64().expect("a period");
        assert!(expected.is_nan() || (critical / expected - 1.0).abs() < 1e-12, "{name}: {critical} {expected}");
        assert_eq!(found["varied"], serde_json::json!(varied), "{name}");
    }
    let words = |every: &str| {
        let file = super::folder("control").join("words.yaml");
        std::fs::write(&file, law(every)).expect("a file");
        super::program(&["modes", file.to_str().expect("a path"), "--sampled"]).expect("words")
    };
    assert!(words("Ts").contains("`Ts` varied with it") && words("50 ms").contains("`every: Ts` lets it follow"));
}

/// An integral state that adds a fixed part each tick is too fast for short periods: s³ + c s² + (k + kp) s + ki Ts/T is stable for
/// T > ki Ts/(c (k + kp)).
#[test]
fn periods_that_are_too_short_were_not_looked_for() {
    let law = |every: &str| {
        format!(
            "name: Law\nparameters: {{m: 1 kg, k: 4 N/m, c: 1 N*s/m, kp: 2 N/m, ki: 0.05 N/m}}\ncoordinates: {{x: m}}\n\
             bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\nmemory: {{u: 0 N, I: 0 N}}\n\
             springs: {{s: {{stretch: x, stiffness: k}}}}\ndampers: {{d: {{rate: x', damping: c}}}}\n\
             forces: {{f: {{on: b, force: \"[u, 0]\"}}}}\n\
             events: {{tick: {{every: {every} s, then: [{{set: {{I: I - ki*x}}}}, {{set: {{u: I - kp*x}}}}]}}}}\n\
             scene: {{start: {{x: 1}}, until: 1}}\n"
        )
    };
    let found = sampled("both", &law("0.05"));
    let period = |key: &str| found[key][0].as_f64().unwrap_or_else(|| panic!("{found}"));
    let (short, long) = (period("least_periods"), period("critical_periods"));
    assert!((short / (0.05 / 6.0) - 1.0).abs() < 0.02, "{short}");
    for (every, stable) in [(0.999 * short, false), (1.001 * short, true), (0.999 * long, true), (1.001 * long, false)]
    {
        let again = sampled("beside", &law(&every.to_string()));
        assert_eq!(again["stable"], stable, "{every}");
        // From where it is unstable the nearest border is the same.
        let nearest =
            if (every / short - 1.0).abs() < 0.01 { ("least_periods", short) } else { ("critical_periods", long) };
        assert!((again[nearest.0][0].as_f64().expect("a period") / nearest.1 - 1.0).abs() < 1e-12, "{again}");
    }
}
