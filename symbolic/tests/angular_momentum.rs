//! Problems 4 and 15: which definition of the angular momentum about a moving point C makes M = dH/dt true.  The models
//! claim each definition under the condition under which it is good; here the claims are widened, and refused.

use std::fs;
use std::path::PathBuf;

use dalembert_symbolic::gate::judged;
use dalembert_symbolic::model::load;

/// A model of the library.
fn library(name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("../models/{name}.yaml"));
    fs::read_to_string(path).unwrap()
}

/// The codes and messages of a file with one piece replaced.
fn told(text: &str, piece: &str, by: &str) -> Vec<String> {
    assert_eq!(text.matches(piece).count(), 1, "{piece}");
    let problems = load(&text.replace(piece, by), &[]).and_then(judged).err().unwrap_or_default();
    problems.iter().map(|problem| format!("{} {}", problem.code, problem.message)).collect()
}

#[test]
fn wrong_definitions_are_refused_where_they_are_wrong() {
    for name in ["angular_momentum", "angular_momentum_system"] {
        let text = library(name);
        let (b, c) = (", when: {u: 0, w: 0}}", ", when: {w: 0}}");
        assert!(load(&text, &[]).and_then(judged).is_ok());
        for (piece, widened, check) in [
            // Absolute velocities: wrong as soon as C moves, also when it does not accelerate, or starts from rest.
            (b, "}", "b"),
            (b, c, "b"),
            (b, ", when: {u: 0}}", "b"),
            // Velocities relative to C: wrong where C accelerates, also when it starts from rest.
            (c, "}", "c"),
            (c, ", when: {u: 0}}", "c"),
        ] {
            let found = told(&text, piece, widened);
            let start = format!("E502 the check `{check}` does not hold");
            assert!(found.len() == 1 && found[0].starts_with(&start), "{name}, {check} with {widened}: {found:?}");
        }
    }
}

#[test]
fn a_derivation_by_a_wrong_definition_does_not_compile() {
    let text = library("angular_momentum");
    let right = "- moment: {about: C, of: [P]}";
    let by = |definition: &str| format!("- equation: \"{definition} = moment\"");
    let fixed = "rate(cross(position(P), m*velocity(P))) - cross(position(C), m*acceleration(P))";
    assert_eq!(told(&text, right, &by(fixed)), [""; 0]);
    for wrong in ["rate(cross(from_C, m*velocity(P)))", "rate(cross(from_C, m*rate(from_C)))"] {
        let found = told(&text, right, &by(wrong));
        assert!(found.len() == 1 && found[0].starts_with("E506"), "{wrong}: {found:?}");
    }
}
