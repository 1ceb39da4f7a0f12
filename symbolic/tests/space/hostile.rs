//! Frames that no mechanism has: each is refused at its place, at once, or judged.

use std::time::{Duration, Instant};

use super::problems;

/// No refusal takes longer, in a debug build.
const AT_ONCE: Duration = Duration::from_secs(2);

/// The file's only error, and that it was found at once.
#[track_caller]
fn refused(file: &str, code: &str) {
    let before = Instant::now();
    let found = problems(file);
    let took = before.elapsed();
    let codes: Vec<&str> = found.iter().map(|problem| problem.code).collect();
    assert_eq!(codes.first(), Some(&code), "{codes:?}: {:?}", found.first());
    assert!(!found[0].place.path.is_empty(), "{:?}", found[0].place);
    assert!(took < AT_ONCE, "{code}: {took:?}");
}

fn with_body(coordinates: &str, frames: &str, frame: &str) -> String {
    format!(
        "name: H\ncoordinates: {{{coordinates}}}\nframes:\n{frames}bodies: {{body: {{mass: 1 kg, inertia: [1, 1, 1], frame: {frame}, position: [0, 0, 0]}}}}\n"
    )
}

/// Nested frames, each turned from the one before.
fn nested(count: usize, turn: impl Fn(usize) -> String) -> String {
    let from = |i: usize| if i == 0 { String::new() } else { format!("from: F{}, ", i - 1) };
    (0..count).map(|i| format!("  F{i}: {{{}rotate: {}}}\n", from(i), turn(i))).collect()
}

fn listed(count: usize, one: impl Fn(usize) -> String) -> String {
    (0..count).map(one).collect::<Vec<_>>().join(", ")
}

#[test]
fn nested_frames_end_at_their_limit() {
    let axis = |i: usize| ["x", "y", "z"][i % 3];
    let coordinates = listed(200, |i| format!("a{i}: rad"));
    let chain = nested(200, |i| format!("[{}, a{i}]", axis(i)));
    refused(&with_body(&coordinates, &chain, "F199"), "E443");
    let directions = nested(200, |i| format!("[[1, 2, 3], a{i}]"));
    refused(&with_body(&coordinates, &directions, "F199"), "E443");
    refused(&with_body("a: rad", &nested(200, |i| format!("[{}, a + {i}/10]", axis(i))), "F199"), "E443");
    let one = format!("  A: {{rotate: [{}]}}\n", listed(400, |i| format!("[{}, a]", axis(i))));
    refused(&with_body("a: rad", &one, "A"), "E443");
    // Turns that do not move cost nothing.
    let fixed = nested(200, |i| format!("[{}, {i}/10]", axis(i))) + "  G: {from: F199, rotate: [z, a]}\n";
    assert_eq!(problems(&with_body("a: rad", &fixed, "G")).len(), 0);
}

#[test]
fn rotations_end_at_their_limit() {
    let family = "name: H\ncoordinates: {\"r[i in 1..400]\": rotation}\nframes: {\"A[i in 1..400]\": {rotate: \"r[i]\"}}\nbodies: {\"b[i in 1..400]\": {mass: 1 kg, inertia: [1, 2, 2.5], frame: \"A[i]\", position: [0, 0, 0]}}\n";
    refused(family, "E443");
    let coordinates = listed(400, |i| format!("r{i}: rotation"));
    refused(&with_body(&coordinates, &nested(400, |i| format!("r{i}")), "F399"), "E443");
}

#[test]
fn frames_that_need_themselves_are_refused() {
    refused(&with_body("a: rad", "  A: {from: A, rotate: [z, a]}\n", "A"), "E217");
    let ring = "  A: {from: C, rotate: [z, a]}\n  B: {from: A, rotate: [z, a]}\n  C: {from: B, rotate: [z, a]}\n";
    refused(&with_body("a: rad", ring, "A"), "E217");
    refused(&with_body("a: rad", "  A: {from: body, rotate: [z, a]}\n", "A"), "E217");
    refused(&with_body("a: rad", "  A: {rotate: [\"A.z\", a]}\n", "A"), "E217");
}

#[test]
fn rotations_stand_in_rotate_only() {
    let with = |line: &str| with_body("r: rotation", "  A: {rotate: r}\n", "A") + line + "\n";
    for (line, code) in [
        ("outputs: {x: r + 1}", "E224"),
        ("outputs: {x: \"r'\"}", "E224"),
        ("outputs: {x: r.w}", "E114"),
        ("potential_energy: r^2", "E224"),
    ] {
        refused(&with(line), code);
    }
    for turn in ["[z, r]", "r*2", "r + r", "\"r'\""] {
        refused(&with_body("r: rotation", &format!("  A: {{rotate: {turn}}}\n"), "A"), "E224");
    }
    refused(&with_body("r: rotation, a: rad", "  A: {from: r, rotate: [z, a]}\n", "A"), "E224");
}

#[test]
fn turns_of_other_shapes_are_refused() {
    for (turn, code) in [
        ("[]", "E436"),
        ("[[[[[z, a]]]]]", "E436"),
        ("[[[z, a], [x, a]], [y, a]]", "E304"),
        ("{z: a}", "E301"),
        ("", "E436"),
        ("[z, \"[a, a]\"]", "E209"),
        ("[z, \"a'\"]", "E213"),
        ("[w, a]", "E201"),
        ("[[1, 0], a]", "E209"),
        ("[[0, 0, 0], a]", "E441"),
        ("[\"[cos(a), sin(a), 0]\", a]", "E215"),
        ("[\"[1/(k-1), 0, 1]\", a]", "E441"),
        ("[[k - 1, 0, 0], a]", "E441"),
    ] {
        let text = with_body("a: rad", &format!("  A: {{rotate: {turn}}}\n"), "A");
        refused(&text.replace("coordinates", "parameters: {k: 1 1}\ncoordinates"), code);
    }
    let deep = format!("  A: {{rotate: {}z{}}}\n", "[".repeat(100), "]".repeat(100));
    refused(&with_body("a: rad", &deep, "A"), "E436");
    // An axis that a scene shrinks to nothing.
    let axis = with_body("a: rad", "  A: {rotate: [[k, 0, 0], a]}\n", "A") + "scene: {set: {k: 0}}\n";
    refused(&axis.replace("coordinates", "parameters: {k: 1 1}\ncoordinates"), "E441");
}

#[test]
fn names_of_frames_are_their_own() {
    let point = with_body("a: rad", "  A: {rotate: [z, a]}\n", "A") + "points: {A: [0, 0, 0]}\n";
    refused(&point, "E202");
    refused(&with_body("a: rad", "  body: {rotate: [z, a]}\n", "body"), "E202");
    refused(&with_body("a: rad", "  ground: {rotate: [z, a]}\n", "ground"), "E203");
    let from_point = with_body("a: rad", "  A: {from: P, rotate: [z, a]}\n", "A") + "points: {P: [0, 0, 0]}\n";
    refused(&from_point, "E224");
    refused(&with_body("a: rad", "  A: {from: ground.x, rotate: [z, a]}\n", "A"), "E224");
}

#[test]
fn starts_of_rotations_of_other_shapes_are_refused() {
    let start =
        |r: &str| with_body("r: rotation", "  A: {rotate: r}\n", "A") + &format!("scene: {{start: {{r: {r}}}}}\n");
    refused(&start("{quaternion: [0, 0, 0, 0]}"), "E441");
    refused(&start("{quaternion: [1, 0, 0]}"), "E308");
    refused(&start("{quaternion: [1, 0, 0, 0], vector: [0, 0, 1]}"), "E305");
    refused(&start("{quaternion: [1, 0, 0, 0], turn: 1}"), "E301");
    refused(&start("[[z, 1], {quaternion: [1, 0, 0, 0]}]"), "E436");
    assert_eq!(problems(&start("{vector: [0, 0, 0]}")).len(), 0);
}
