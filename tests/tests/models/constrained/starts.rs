//! Starts that are or are not consistent; constraints that depend on each other.

use dalembert::{Cause, Error, Warning};
use dalembert_symbolic::lower::compile;
use dalembert_tests::case::Case;

use crate::near;

/// Why a run did not begin, or ended.
#[track_caller]
fn cause(mut case: Case) -> Cause {
    match case.try_run() {
        Err(Error::Run(failure)) => failure.cause,
        Err(error) => panic!("{error}"),
        Ok(run) => panic!("it runs: {:?}", run.last()),
    }
}

const PENDULUM: &str = "
name: Bob
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {x: m, y: m}
bodies: {bob: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {rod: x^2 + y^2 - l^2}
outputs: {tension: -2*l*reaction(rod)}
scene: {start: {x: l, y: 0, x': 0}, until: 10, tolerance: 1e-12}
";

/// C9: a constraint that says the same again is named; the motion is that of one.
#[test]
fn c9_a_redundant_constraint_is_named_and_changes_no_motion() {
    let twice = PENDULUM.replace("rod: x^2 + y^2 - l^2", "rod: x^2 + y^2 - l^2, again: 3*(x^2 + y^2 - l^2)");
    let twice = twice.replace("outputs: {", "outputs: {rest: -6*l*reaction(again), ");
    let program = compile(&twice, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
    let told: Vec<&str> = program.model.warnings.iter().map(|warning| warning.message.as_str()).collect();
    assert!(told.iter().any(|message| message.contains("again") || message.contains("rod")), "{told:?}");
    let (one, two) = (Case::written(PENDULUM).run().last(), Case::written(&twice).run().last());
    // Of all forces that the two can share the rod's in, the least: half of it each, however the row is scaled.
    near(two["tension"], one["tension"] / 2.0, 1e-9);
    near(two["rest"], one["tension"] / 2.0, 1e-9);
    for name in ["x", "y", "x'", "y'"] {
        near(two[name], one[name], 1e-10);
    }
}

#[test]
fn constraints_that_contradict_each_other_are_an_error_that_names_them() {
    let wrong = PENDULUM.replace("rod: x^2 + y^2 - l^2", "rod: x^2 + y^2 - l^2, other: x^2 + y^2 - 4*l^2");
    let problems = compile(&wrong, &[]).expect_err("an error");
    let told: Vec<&str> = problems.iter().map(|problem| problem.message.as_str()).collect();
    assert!(told.iter().any(|message| message.contains("other")), "{told:?}");
}

/// C13: 4 > 1 + 1 + 1: at least 1/√3 is missing at each pin, 1 at one.
#[test]
fn c13_a_loop_that_cannot_close_says_what_is_missing() {
    let case = Case::new("four_bar").set("coupler", 1.0).set("rocker", 1.0);
    let Cause::Unreachable { constraint, residual, .. } = cause(case) else { panic!("reachable") };
    assert!(constraint.contains("pin"), "{constraint}");
    assert!(residual.abs() > 0.57, "{residual}");
}

/// C14: values that the start holds and that miss a constraint are an error that names it, not a motion beside it.
#[test]
fn c14_a_start_that_misses_a_constraint_is_an_error() {
    let places = Case::new("pendulum_cartesian").start("y", 0.5);
    let Cause::StartMissesConstraint { constraint, residual } = cause(places) else { panic!("a start") };
    assert_eq!(constraint, "rod");
    near(residual.abs(), 0.25, 1e-12);
    let speeds = Case::new("pendulum_cartesian").start("x'", 1.0);
    let Cause::StartMissesConstraint { constraint, .. } = cause(speeds) else { panic!("a start") };
    assert_eq!(constraint, "rod");
}

/// C11: a body without mass is no obstacle where constraints tie it; where nothing does, the error names its coordinate.
#[test]
fn c11_a_massless_body_moves_where_it_is_tied() {
    let tied = "
name: Tied
parameters: {m: 1 kg, k: 1 N/m}
coordinates: {x: m, y: m}
bodies: {heavy: {mass: m, position: \"[x, 0]\"}}
springs: {spring: {stretch: y, stiffness: k}}
constraints: {lever: y - 2*x}
scene: {start: {x: 1}, until: 3, tolerance: 1e-12}
";
    let last = Case::written(tied).run().last();
    near(last["x"], 6.0_f64.cos(), 1e-10);
    near(last["y"], 2.0 * 6.0_f64.cos(), 1e-10);
    let free = tied.replace("constraints: {lever: y - 2*x}\n", "");
    let problems = compile(&free, &[]).expect_err("an error");
    assert!(problems.iter().any(|problem| problem.message.contains("`y`")), "{problems:?}");
}

/// C8: with a rod as long as the crank, the start at 90° lies where two branches meet.
#[test]
fn c8_a_start_where_branches_meet_is_reported_as_that() {
    let found = cause(Case::new("slider_crank").set("rod", 1.0));
    assert!(matches!(found, Cause::SingularConfiguration { .. }), "{found}");
}

/// What is kept and what is missed is judged by the scene's own sizes, from molecules to orbits.
#[test]
fn a_start_is_judged_by_its_own_sizes() {
    for size in [1e-12, 1e-6, 1e6, 1e12] {
        let bob = |start: &str| {
            let sized = format!("l: {size:e} m, v: {size:e} m/s, g: {:e} m/s^2", 10.0 * size);
            let scene = format!("start: {{{start}}}, guess: {{y: -l}}, until: 1");
            let text = PENDULUM.replace("l: 1 m, g: 10 m/s^2", &sized);
            Case::written(&text.replace("start: {x: l, y: 0, x': 0}, until: 10, tolerance: 1e-12", &scene))
        };
        let off = cause(bob("x: l, y: l/100"));
        assert!(matches!(off, Cause::StartMissesConstraint { .. }), "{size:e}: {off}");
        let slips = cause(bob("x: l, y: 0, x': v/1000, y': v"));
        assert!(matches!(slips, Cause::StartMissesConstraint { .. }), "{size:e}: {slips}");
        let mut found = bob("x: 0.6*l, y': 0.1*v");
        let first = found.run().first();
        near(first["y"] / size, -0.8, 1e-12);
        near((first["x"] * first["x'"] + first["y"] * first["y'"]) / (size * size), 0.0, 1e-15);
        let spinning =
            "conserved: {spin: \"m*(x*y' - y*x')\"}\nscene: {start: {x: l, y: 0}, also: {spin: m*l*v}, until: 0.1}";
        let text = PENDULUM
            .replace("l: 1 m, g: 10 m/s^2", &format!("l: {size:e} m, v: {size:e} m/s"))
            .replace("gravity: [0, -g]\n", "");
        let (head, _) = text.split_once("scene:").expect("a scene");
        near(Case::written(&format!("{head}{spinning}\n")).run().first()["y'"] / size, 1.0, 1e-9);
    }
}

/// A start that closes in two ways: where nobody chose, the run says so and names a coordinate that tells them apart.
#[test]
fn a_second_branch_is_told_unless_a_guess_chose() {
    let slider = "
name: Slider
parameters: {m: 1 kg, a: 1 m, b: 2 m}
coordinates: {theta: rad, s: m}
points: {crank: \"a*[cos(theta), sin(theta)]\"}
bodies: {block: {mass: m, position: \"[s, 0]\"}, pin: {mass: m, position: crank}}
constraints: {rod: (s - a*cos(theta))^2 + (a*sin(theta))^2 - b^2}
scene: {start: {theta: 1, theta': 1}, until: 0.1}
";
    let told = |text: &str| -> Vec<Warning> {
        let run = Case::written(text).run();
        run.warnings.into_iter().filter(|warning| matches!(warning, Warning::OtherBranch { .. })).collect()
    };
    let half = (4.0 - 1.0_f64.sin().powi(2)).sqrt();
    let [Warning::OtherBranch { coordinate, here, there }] = &told(slider)[..] else { panic!("not told") };
    assert_eq!(coordinate, "s");
    near(*here, 1.0_f64.cos() - half, 1e-12);
    near(*there, 1.0_f64.cos() + half, 1e-12);
    assert!(told(&slider.replace("until: 0.1", "guess: {s: 2}, until: 0.1")).is_empty());
    // Nothing to choose: both are held, or what is left can move.
    assert!(told(&PENDULUM.replace("until: 10", "until: 0.1")).is_empty());
    let free = PENDULUM.replace("start: {x: l, y: 0, x': 0}, until: 10", "start: {x': 0, y': 0}, until: 0.1");
    assert!(told(&free.replace("x^2 + y^2 - l^2", "(x - l)^2 + (y - l)^2 - l^2")).is_empty());
}

/// What a start asks beside constraints cannot be met where it holds everything: an error, whatever the rows are.
#[test]
fn a_start_that_holds_everything_cannot_be_asked_for_more() {
    let asked = PENDULUM.replace("outputs: {", "outputs: {spin: \"m*(x*y' - y*x')\", ");
    let asked = asked.replace("x': 0}, until", "x': 0, y': 1}, also: {spin: 5}, until");
    let found = cause(Case::written(&asked));
    assert!(matches!(found, Cause::StartMissesConstraint { .. }), "{found}");
}

/// A cart on two wheels that begins turning on the spot: the speed that is left sideways is rounding of the wheels', and no
/// constraint is missed by it.
#[test]
fn a_start_at_rest_but_for_a_turn_is_consistent() {
    let cart = "
name: Cart
parameters: {m: 2 kg, R: 0.1 m, b: 0.2 m, I: 0.05 kg*m^2, J: 0.0025 kg*m^2, G: 1.7 m/s^2, w: 1.5 1/s}
coordinates: {x: m, y: m, th: rad, p: rad, q: rad}
points: {axle: \"[x, y]\"}
bodies: {body: {mass: m, inertia: I, angle: th, position: axle}}
gravity: \"[G, 0]\"
kinetic_energy: J/2*(p'^2 + q'^2)
constraints:
  side: dot(velocity(axle), body.y)
  left: dot(velocity(axle), body.x) - b*th' - R*p'
  right: dot(velocity(axle), body.x) + b*th' - R*q'
conserved: {turn: (q - p)*R - 2*b*th}
define: {slope: m/(m + 2*J/R^2)*G/(2*w^2)}
outputs: {off: \"[x - slope*sin(w*t)^2, y - slope*(w*t - sin(2*w*t)/2)]\"}
scene: {start: {x: 0, y: 0, th: 0, th': w, x': 0, p: 0, q: 0}, until: 10, tolerance: 1e-11}
";
    let last = Case::written(cart).run().last();
    near(last["off.x"], 0.0, 1e-9);
    near(last["off.y"], 0.0, 1e-9);
    // The neighbour: a speed sideways that is held is missed, however small beside the turn.
    let sideways = cart.replace("x': 0,", "x': 0, y': 1e-9,");
    assert!(
        matches!(cause(Case::written(&sideways)), Cause::StartMissesConstraint { constraint, .. } if constraint == "side")
    );
}
