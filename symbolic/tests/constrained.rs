//! Constrained models before the gate: what it accepts, what it refuses, and at which states.

use dalembert_symbolic::derive::derive;
use dalembert_symbolic::diagnose::Problem;
use dalembert_symbolic::expr::Tape;
use dalembert_symbolic::gate::judge;
use dalembert_symbolic::lower::{Program, compile};
use dalembert_symbolic::model::load;

const PENDULUM: &str = "
name: Pendulum
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {x: m, y: m}
bodies: {bob: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {rod: x^2 + y^2 - l^2}
conserved: {energy: energy}
balances:
  equations:
    - force: {of: [bob], along: \"[-y, x]\"}
";

const SLEIGH: &str = "
name: Sleigh
parameters: {m: 1 kg, I: 0.25 kg*m^2, d: 0.5 m}
coordinates: {x: m, y: m, theta: rad}
points: {skate: \"[x, y]\"}
bodies: {sled: {mass: m, inertia: I, angle: theta, position: skate + d*sled.x}}
constraints: {edge: \"dot(velocity(skate), sled.y)\"}
balances:
  equations:
    - force: {of: [sled], along: sled.x}
    - moment: {about: skate, of: [sled]}
conserved: {energy: energy}
";

/// Friction as a phase, with its reaction in both derivations.
const BLOCK: &str = "
name: Block
parameters: {m: 1 kg, g: 10 m/s^2, mu: 0.3 1, F: 5 N}
coordinates: {x: m, y: m}
bodies: {block: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {floor: y, grip: x'}
phases: {slip: [floor], stick: [floor, grip]}
forces:
  rub: {on: block, force: \"[-mu*reaction(floor), 0]\", phase: slip}
  pull: {on: block, force: \"[F, 0]\"}
balances:
  sliding:
    equations:
      - force: {of: [block]}
      - equation: normal = reaction(floor)
    reactions: {normal: {on: block, along: \"[0, 1]\"}}
  sticking:
    phase: stick
    equations:
      - force: {of: [block]}
    reactions: {hold: {on: block, along: \"[1, 0]\"}, normal: {on: block, along: \"[0, 1]\"}}
";

fn accepted(text: &str) -> Program {
    compile(text, &[]).unwrap_or_else(|problems| panic!("{text}\n{:?}", codes(&problems)))
}

fn refused(text: &str) -> Vec<Problem> {
    compile(text, &[]).err().unwrap_or_else(|| panic!("accepted:\n{text}"))
}

fn codes(problems: &[Problem]) -> Vec<String> {
    problems.iter().map(|problem| format!("{}: {}", problem.code, problem.message)).collect()
}

#[test]
fn constrained_models_agree_by_two_derivations() {
    for text in [PENDULUM, SLEIGH, BLOCK] {
        let program = accepted(text);
        assert!(program.report.agreements.len() >= 2, "{:?}", program.report.agreements);
        assert!(program.report.agreements.iter().all(|a| a.worst < 1e-20), "{:?}", program.report.agreements);
    }
}

#[test]
fn drawn_states_lie_on_the_constraints_to_28_digits() {
    for text in [PENDULUM, SLEIGH, BLOCK] {
        let program = accepted(text);
        for state in &program.report.states {
            let rows = program.model.rows_of(&program.model.phases[state.phase]);
            let all: Vec<_> = program.model.constraints.iter().flat_map(|c| c.value.clone()).collect();
            let values = Tape::new(&program.model.graph, &all).evaluate(|s| state.value(s));
            let size = state.q.iter().chain(&state.v).fold(0.0_f64, |most, x| most.max(x.to_f64().abs()));
            for row in rows {
                assert!(values[row].to_f64().abs() <= 1e-28 * (1.0 + size * size), "{:?}", values[row]);
            }
        }
    }
}

#[test]
fn a_wrong_balance_does_not_compile() {
    let wrong = [
        (PENDULUM, "along: \"[-y, x]\"", "along: \"[y, x]\""),
        (SLEIGH, "along: sled.x", "along: sled.y"),
        (SLEIGH, "about: skate", "about: \"skate + [0.1*d, 0]\""),
        (BLOCK, "normal = reaction(floor)", "normal = 2*reaction(floor)"),
        (BLOCK, "normal = reaction(floor)", "normal = -reaction(floor)"),
    ];
    for (text, right, wrong) in wrong {
        let problems = refused(&text.replace(right, wrong));
        assert!(problems.iter().any(|p| ["E506", "E512", "E517"].contains(&p.code)), "{wrong}: {:?}", codes(&problems));
        // The equation of the reaction is wrong, not the balance in which it stands.
        let of_reaction = wrong.contains("reaction(");
        assert_eq!(problems.iter().any(|p| p.code == "E517"), of_reaction, "{wrong}: {:?}", codes(&problems));
    }
}

/// Each with its neighbour that is left alone.
#[test]
fn dependent_contradicting_and_impossible_constraints_are_told_apart() {
    let with = |constraints: &str| {
        let text = PENDULUM.replace("rod: x^2 + y^2 - l^2", constraints);
        text[..text.find("balances").unwrap_or(text.len())].replace("conserved: {energy: energy}", "")
    };
    let twice = accepted(&with("rod: x^2 + y^2 - l^2, again: 2*x^2 + 2*y^2 - 2*l^2"));
    let warned: Vec<&str> = twice.model.warnings.iter().map(|w| w.code).collect();
    assert_eq!(warned, ["W515"]);
    assert_eq!(twice.report.ranks, [1]);
    let two = accepted(&with("rod: x^2 + y^2 - l^2, line: x - y"));
    assert!(two.model.warnings.is_empty() && two.report.ranks == [2]);
    let impossible = refused(&with("rod: x^2 + y^2 - l^2, far: x - 3*l"));
    assert!(impossible.iter().any(|p| p.code == "E514"), "{:?}", codes(&impossible));
    let contradicts = refused(&with("first: x' - g*t, second: x' - 2*g*t"));
    assert!(contradicts.iter().any(|p| p.code == "E514"), "{:?}", codes(&contradicts));
}

/// Faults in what only Lagrange's side has of a constraint are seen by the balances: a row, γ, the sign of Jᵀλ.
#[test]
fn seeded_faults_in_one_derivation_are_found() {
    let mut planted = 0;
    for text in [PENDULUM, SLEIGH, BLOCK] {
        let derivation = || derive(load(text, &[]).expect("a good file")).expect("derives");
        let rows = derivation().rows;
        for k in 0..rows.matrix.len() {
            let mut wrong = derivation();
            let graph = &mut wrong.model.graph;
            // One element of a row and not the others: the constraint's force acts in another direction.
            let entry = wrong.rows.matrix[k].2;
            let two = graph.integer(2);
            let doubled = graph.mul(entry, two);
            if rows.matrix.iter().filter(|e| e.0 == rows.matrix[k].0).count() < 2 {
                continue;
            }
            wrong.rows.matrix[k].2 = doubled;
            planted += 1;
            assert!(judge(wrong).is_err(), "element {k} of J doubled in {text}");
        }
        for k in 0..rows.bias.len() {
            let mut wrong = derivation();
            if wrong.model.graph.number(rows.bias[k]).is_some() {
                continue;
            }
            wrong.rows.bias[k] = wrong.model.graph.neg(rows.bias[k]);
            planted += 1;
            assert!(judge(wrong).is_err(), "γ {k} with the other sign in {text}");
        }
    }
    assert!(planted >= 5, "{planted}");
}

/// A mass on two springs in series, the joint of which has no mass.
const SERIES: &str = r#"
name: Series
parameters: {m: 2 kg, k: 30 N/m, c: 4 N/m}
coordinates: {x: m, z: m}
bodies: {b: {mass: m, position: "[x, 0]"}, j: {mass: 0, position: "[z, 0]"}}
springs: {s: {between: ["[0, 0]", j], stiffness: k}, s2: {between: [j, b], stiffness: c}}
balances: {equations: [BALANCES]}
"#;

#[test]
fn balances_of_a_coordinate_without_mass_count_where_they_are_written() {
    for balances in [
        "{equation: m*x'' = -c*(x - z)}",
        "{force: {of: b, along: ground.x}}",
        "{force: {of: b, along: ground.x}}, {force: {of: j, along: ground.x}}",
        "{equation: m*x'' = -c*(x - z)}, {equation: (c + k)*z'' = c*x''}",
    ] {
        let program = accepted(&SERIES.replace("BALANCES", balances));
        let system = &program.momentum[0];
        assert_eq!([system.right.len(), system.equations.len()], [2, 2], "{balances}: {:?}", system.equations);
    }
    for (balances, code) in [
        ("{equation: m*x'' = -c*(x + z)}", "E506"),
        ("{equation: m*x'' = -c*(x - z)}, {equation: (c + k)*z'' = 2*c*x''}", "E512"),
        ("{equation: m*x'' = -c*(x - z)}, {equation: 2*m*x'' = -2*c*(x - z)}, {equation: (c + k)*z'' = c*x''}", "E414"),
    ] {
        let problems = refused(&SERIES.replace("BALANCES", balances));
        let told: Vec<&str> = problems.iter().map(|p| p.code).collect();
        assert_eq!(told, [code], "{balances}: {:?}", codes(&problems));
    }
}

#[test]
fn constraints_that_follow_from_others_do_not_count_in_a_system_of_balances() {
    let with = |constraints: &str, balances: &str| {
        format!(
            "name: Bob\nparameters: {{m: 1 kg, l: 1 m, g: 9.81 m/s^2}}\ncoordinates: {{x: m, y: m}}\n\
             bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}\ngravity: [0, -g]\nconstraints: {{{constraints}}}\n\
             balances: {{equations: [{balances}]}}\n"
        )
    };
    let (twice, moment) = ("a: x^2 + y^2 - l^2, b: sqrt(x^2 + y^2) - l", "{moment: {about: [0, 0], of: b}}");
    let program = accepted(&with(twice, moment));
    let names: Vec<&str> = program.momentum[0].equations.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["balance 1 (moment)", "the constraint a"]);
    let problems = refused(&with(twice, &format!("{moment}, {{equation: \"x*y'' - y*x'' = g*x\"}}")));
    assert!(problems.iter().any(|p| p.code == "E512"), "{:?}", codes(&problems));
    let problems = refused(&with("a: x^2 + y^2 - l^2", &format!("{moment}, {{energy: {{}}}}")));
    assert!(matches!(problems.as_slice(), [one] if one.code == "E414"), "{:?}", codes(&problems));
}
