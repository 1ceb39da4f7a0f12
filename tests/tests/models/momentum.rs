//! Mechanisms integrated from momentum balance alone.

use dalembert::mechanism::System;
use dalembert::{Cause, Error, Simulate};
use dalembert_models::MODELS;
use dalembert_tests::case::Case;
use dalembert_tests::reference::Reference;

use super::near;

/// The systems of balances of a model.
fn systems(system: &dyn System) -> Vec<String> {
    system.description().balances.iter().map(|s| s.name.to_string()).collect()
}

/// A short run of every model by each of the systems of its first phase ends where Lagrange's equations end, to 1e-9 of the
/// largest coordinate or speed.
#[test]
fn every_model_moves_by_momentum_alone() {
    let mut runs = 0;
    for entry in MODELS {
        let system = (entry.compiled.expect("its code"))();
        let first = system.description().balances.iter().filter(|balances| balances.phases.contains(&0));
        let names: Vec<String> = first.map(|balances| balances.name.to_string()).collect();
        for name in names {
            let constrained = !system.description().rows.is_empty();
            let prepared = || {
                let mut case = Case::new(entry.name).tolerance(1e-12);
                case.settings.until = case.settings.until.min(1.0);
                // Nothing is at rest, where power says nothing; what a scene holds at its constraints stays.
                let speeds = case.settings.v.iter_mut().filter(|_| !constrained);
                speeds.enumerate().for_each(|(i, v)| *v += 0.01 * (1.0 + i as f64));
                // As long as it stays in its first phase.
                if case.system.description().phases.len() > 1 {
                    case.settings.until = case.settings.until.min(0.1);
                }
                case
            };
            let expected = prepared().run().last();
            let found = prepared().by(&name).run();
            assert_eq!(found.balances.as_ref().map(|b| b.system.as_str()), Some(name.as_str()));
            let found = found.last();
            assert_eq!(found.t, expected.t, "{}, {name}", entry.name);
            let pairs = || expected.q.iter().chain(&expected.v).zip(found.q.iter().chain(&found.v));
            let scale = pairs().fold(0.0, |m: f64, (x, _)| m.max(x.abs()));
            for (x, y) in pairs() {
                assert!((x - y).abs() <= 1e-9 * scale, "{}, {name}: {y} is not {x}", entry.name);
            }
            runs += 1;
        }
    }
    assert!(runs > 40, "{runs}");
}

/// Problem 11 (a)–(g); power and energy from t = 1 s on, since they say nothing at rest.
#[test]
fn simple_pendulum_follows_the_reference_by_seven_routes() {
    let reference = Reference::load("B01");
    let states = reference.states();
    let case = Case::new("simple_pendulum");
    let names = systems(&*case.system);
    assert_eq!(names.len(), 7);
    for name in names {
        let mut case = Case::new("simple_pendulum").tolerance(1e-13).by(&name);
        let moving = ["e_energy", "f_power"].contains(&name.as_str());
        if moving {
            let Some(Error::Run(failure)) = case.try_run().err() else { panic!("{name} moves what is at rest") };
            let Cause::VoidBalance { system, at_rest: true, .. } = &failure.cause else { panic!("{}", failure.cause) };
            assert_eq!((system, failure.state.t, failure.run.len()), (&name, 0.0, 1));
            let (t, values) = &states[0];
            case.settings.from = *t;
            for (start, name) in [(&mut case.settings.q, "theta"), (&mut case.settings.v, "theta_dot")] {
                start[0] = values.iter().find(|(key, _)| key == name).expect("an angle and its rate").1;
            }
        }
        let later = states[usize::from(moving)..].to_vec();
        let skip = ["vx", "vy", "x", "y"];
        case.compare_states(&later, &skip, |_| 1e-10);
    }
}

#[test]
fn others_follow_the_reference() {
    for (id, model, skip, names) in [
        ("B02", "double_pendulum", &["tip_vx", "tip_vy"][..], &["two_moments", "six_equations"][..]),
        ("B03", "triple_pendulum", &["tip_vx", "tip_vy"], &["three_moments", "nine_equations"]),
        ("B05", "figure_eight", &[], &["balances"]),
        ("B09", "bead_parabola", &[], &["along_the_wire", "with_the_normal_force"]),
    ] {
        for name in names {
            // Errors grow in chaotic motions.
            let tolerance = |t: f64| if t <= 2.1 || id == "B09" { 1e-10 } else { 1e-6 };
            Case::new(model).tolerance(1e-13).by(name).compare(&Reference::load(id), skip, tolerance);
        }
    }
}

/// Hinge force, tension and normal force from the balances' own solution.
#[test]
fn reactions_are_those_of_the_reference() {
    let reference = Reference::load("B02");
    let case = Case::new("double_pendulum");
    let start = (0.0, case.settings.q.as_slice(), case.settings.v.as_slice());
    for (axis, force) in ["x", "y"].iter().zip(reference.list("initial_ground_joint_force_on_bar1")) {
        near(case.unknown("six_equations", &format!("hinge_force.{axis}"), start), force, 1e-10);
    }
    // As an output of a run by these balances, too.
    let run = Case::new("double_pendulum").by("six_equations").until(0.1).run();
    near(run.first()["hinge_force.y"], reference.list("initial_ground_joint_force_on_bar1")[1], 1e-10);

    let reference = Reference::load("B01");
    let case = Case::new("simple_pendulum");
    let speed = [reference.scalar("max_abs_theta_dot")];
    // Along the position vector, away from the hinge; the rod pulls.
    let tension = -case.unknown("a_components", "rod", (0.0, &[0.0], &speed));
    near(tension, reference.scalar("rod_tension_at_bottom"), 1e-10);

    let reference = Reference::load("B09");
    let case = Case::new("bead_parabola");
    // m v²/2 = m g c at the bottom.
    let normal = case.unknown("with_the_normal_force", "wire", (0.0, &[0.0], &[20.0_f64.sqrt()]));
    near(normal, reference.scalar("normal_force_at_bottom"), 1e-10);
}

/// `A` and `b` of the lecture: m l² θ'' = −m g l sin θ, and the typed way in.
#[test]
fn typed_pendulum_goes_by_a_system_of_its_choice() {
    let pendulum = dalembert_models::simple_pendulum::SimplePendulum::default();
    let (a, b) = pendulum.balances_at("d_angular_momentum", 0.0, &[0.3], &[2.0]).expect("a system of that name");
    near(a[(0, 0)], 1.0, 1e-15);
    near(b[0], -10.0 * 0.3_f64.sin(), 1e-14);
    let run = pendulum.simulate().derivation("b_along_the_path").until(1.0).run().expect("a run");
    let report = run.trust().to_string();
    assert!(report.contains("balances `b_along_the_path`, condition number at most 1.0e0"), "{report}");
    let lagrange = pendulum.simulate().derivation("b_along_the_path").derivation("lagrange").until(1.0).run();
    assert!(!lagrange.expect("a run").trust().to_string().contains("derivation"));
    // Lagrange's equations are none of the systems there are.
    let error =
        pendulum.balances_at("lagrange", 0.0, &[0.3], &[2.0]).expect_err("not a system of balances").to_string();
    assert!(error.contains("no system of balances is called `lagrange`; there are `a_components`"), "{error}");
    let error = pendulum.simulate().derivation("h_hamilton").run().expect_err("there is no such system");
    assert!(
        error.to_string().contains("no system of balances is called `h_hamilton`; there are `a_components`"),
        "{error}"
    );
}

dalembert::model!(
    yaml = r#"
name: Corner
parameters: {m: 1}
coordinates: {x: 1, y: 1}
bodies: {bead: {mass: m, position: "[x, y]"}}
balances:
  equations:
    - force: {of: [bead], along: ground.x}
    - force: {of: [bead], along: "[1, x]"}
scene: {start: {x: 1, x': -1}, until: 2, tolerance: 1e-9}
"#
);

/// Two directions that become one at x = 0: the run by them ends there with what it has, and never with a NaN.
#[test]
fn balances_that_become_dependent_end_the_run() {
    let start = |x: f64| Corner::default().simulate().derivation("balances").start(&[x, 0.0], &[0.0, 0.0]).run();
    assert_eq!(start(1.0).expect("independent").balances.expect("by balances").system, "balances");
    let error = start(0.0).expect_err("dependent");
    let Some(Cause::SingularBalances { system, unknown }) = error.cause() else { panic!("{error}") };
    assert_eq!((system.as_str(), unknown.as_str()), ("balances", "y''"));
    assert_eq!(error.partial().map(|run| run.len()), Some(1));
}

/// What the program prints, or what it says is wrong.
fn told(arguments: &[&str]) -> Result<String, String> {
    let mut out = Vec::new();
    let arguments = std::iter::once(&"dalembert").chain(arguments);
    match dalembert::cli::run(MODELS, arguments, &mut out) {
        Ok(()) => Ok(String::from_utf8(out).expect("text")),
        Err(problem) => Err(problem.to_string()),
    }
}

#[test]
fn the_program_goes_by_balances_and_compares() {
    let told_by = |by: &str| told(&["simulate", "simple_pendulum", "--until", "0.5", "--by", by]);
    assert!(told_by("a_components").expect("a run").contains("derivation     balances `a_components`"));
    assert!(
        told_by("e_energy").expect_err("at rest").starts_with("error: void balance: in `e_energy`, balance 1 (energy)")
    );
    assert!(told_by("a_component").expect_err("no such system").contains("a_components"));
    let error = told(&["simulate", "string_rayleigh", "--by", "moments"]).expect_err("no balances");
    assert!(error.contains("string_rayleigh has no `balances`"), "{error}");

    let table = told_by("all").expect("a comparison");
    let lines: Vec<&str> = table.lines().collect();
    let ended = lines.iter().filter(|line| line.contains("ended early: void balance")).count();
    assert_eq!((lines.len(), ended), (1 + 1 + 8 + 2, 2), "{table}");
    let json = told(&["simulate", "double_pendulum", "--until", "1", "--by", "all", "--json"]).expect("JSON");
    let value: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let derivations = value["derivations"].as_array().expect("a list");
    assert_eq!(derivations.len(), 3);
    for derivation in &derivations[1..] {
        assert!(derivation["difference"].as_f64().expect("a number") < 1e-8, "{json}");
        assert!(derivation["condition"].as_f64().expect("a number") > 1.0, "{json}");
    }

    let check = told(&["check", "double_pendulum"]).expect("a report");
    let shared = "shared by all derivations, so not tested by comparing them: masses, inertias, positions, gravity\n";
    assert!(check.contains(shared), "{check}");
    let conditional = told(&["check", "cannon_ball"]).expect("a report");
    assert!(conditional.contains("energy is conserved where b = 0, worst "), "{conditional}");
    assert!(
        check.contains("six_equations: 6 equations, 4 reaction components, 30 operations, condition number"),
        "{check}"
    );
}
