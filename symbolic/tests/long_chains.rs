//! Files of many coordinates, whose M is not formed: what is wrong in one place of them is refused all the same.

use dalembert_symbolic::diagnose::Problem;
use dalembert_symbolic::lower::{Program, compile_for_runs_in};

const CHAIN: &str = include_str!("../../models/chain.yaml");

/// One balance for all joints but one, which has its own.
fn with_joint(k: &str, last: &str) -> String {
    let all = r#"      "joint[i in 1..n]": {moment: {about: "tip[i-1]", of: ["bar[j in i..n]"]}}"#;
    assert!(CHAIN.contains(all));
    let others = format!(
        "      \"joint[i in 1..{k}-1]\": {{moment: {{about: \"tip[i-1]\", of: [\"bar[j in i..n]\"]}}}}\n      \
         \"joint[i in {k}+1..n]\": {{moment: {{about: \"tip[i-1]\", of: [\"bar[j in i..n]\"]}}}}\n      own: {last}"
    );
    CHAIN.replace(all, &others)
}

fn outcome(text: &str, n: i64) -> Result<Program, Vec<Problem>> {
    compile_for_runs_in(None, text, &[("n".to_owned(), n)])
}

/// The last bar about its joint, written out, with this sign of its weight.
fn written(sign: &str) -> String {
    with_joint(
        "n",
        &format!(
            "{{equation: \"I*theta[n]'' + m*l/2*(cos(theta[n])*acceleration(bar[n]).x \
             + sin(theta[n])*(acceleration(bar[n]).y {sign} g)) = 0\"}}"
        ),
    )
}

#[test]
fn long_files_are_sound() {
    for n in [40, 200] {
        for text in [CHAIN.to_owned(), written("+")] {
            let program = outcome(&text, n).unwrap_or_else(|problems| panic!("{n}: {problems:?}"));
            assert!(program.unformed && program.mass.is_empty());
            assert!(program.report.agreements.iter().all(|agreement| agreement.worst < 1e-25), "{:?}", program.report);
            assert_eq!(program.report.agreements.len(), 2);
            assert!(program.report.conserved[0].1 < 1e-25);
        }
    }
}

#[test]
fn faults_in_one_place_of_long_files_are_refused() {
    let claim =
        |more: &str| CHAIN.replace("conserved: {energy: energy}", &format!("conserved: {{energy: \"energy {more}\"}}"));
    let faults = [
        ("a sign in a written-out balance", written("-"), ["E506", "E512"]),
        (
            "a balance about another point",
            with_joint("7", r#"{moment: {about: "tip[7]", of: ["bar[j in 7..n]"]}}"#),
            ["E506", "E512"],
        ),
        (
            "a balance without its last body",
            with_joint("7", r#"{moment: {about: "tip[6]", of: ["bar[j in 7..n-1]"]}}"#),
            ["E506", "E512"],
        ),
        (
            "a balance twice",
            with_joint("7", r#"{moment: {about: "tip[7]", of: ["bar[j in 8..n]"]}}"#),
            ["E507", "E507"],
        ),
        ("a term of the energy", claim("+ 1e-3*m*l^2*theta[1]'^2"), ["E501", "E501"]),
        ("a term of the energy at the far end", claim("+ 1e-3*m*l^2*theta[n]'^2"), ["E501", "E501"]),
        ("a weight in the energy", claim("- 1e-3*m*g*l*cos(theta[1])"), ["E501", "E501"]),
    ];
    for (what, text, codes) in faults {
        for (n, code) in [40, 200].into_iter().zip(codes) {
            match outcome(&text, n) {
                Ok(_) => panic!("{what} passes with {n} links"),
                Err(problems) => assert_eq!(problems[0].code, code, "{what}, {n} links: {problems:?}"),
            }
        }
    }
}

/// Two chains that nothing joins are two parts.
#[test]
fn chains_side_by_side_are_parts() {
    let text = "name: Two
sizes: {n: 20}
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {\"a[i in 1..n]\": rad, \"b[i in 1..n]\": rad}
points:
  \"p[0]\": [0, 0]
  \"p[i in 1..n]\": \"p[i-1] + l*[sin(a[i]), -cos(a[i])]\"
  \"q[0]\": [1 m, 0]
  \"q[i in 1..n]\": \"q[i-1] + l*[sin(b[i]), -cos(b[i])]\"
bodies: {\"left[i in 1..n]\": {mass: m, position: \"p[i]\"}, \"right[i in 1..n]\": {mass: m, position: \"q[i]\"}}
gravity: [0, -g]
";
    let program = outcome(text, 20).unwrap_or_else(|problems| panic!("{problems:?}"));
    assert!(program.unformed);
    assert_eq!(program.structure.mass_blocks, [20, 20]);
    assert_eq!(program.parts.len(), 2);
    assert!(program.parts.iter().all(|part| !part.linear && !part.separable));
}
