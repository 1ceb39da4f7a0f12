//! Warnings, question marks and causes that did not fit: the numbers behind them were right.

use std::fs;

use super::{folder, program};

/// What `simulate` prints of a model file's text.
fn simulated(name: &str, text: &str) -> String {
    let path = folder(name).join("model.yaml");
    fs::write(&path, text).expect("a file");
    program(&["simulate", path.to_str().expect("a path")]).unwrap_or_else(|error| panic!("{error}"))
}

/// A tank that is shut off when it is empty, where its level stays.
const EMPTIED: &str = r#"
name: Emptied
parameters: {q: 2 kg/s}
states: {a: {unit: kg, rate: -q*on}}
memory: {on: 1}
events: {empty: {when: a, direction: falling, then: {set: {on: 0, a: 0}}}}
scene: {start: {a: 70 kg}, until: 60, tolerance: 1e-11}
"#;

#[test]
fn the_time_of_an_event_that_leaves_its_function_at_zero_was_unknown() {
    // 70 kg at 2 kg/s.
    assert!(simulated("emptied", EMPTIED).contains("event empty at t = 35.0"));
    // What is flat about its zero is known no better, as before: (t − 1)³.
    let flat = "name: Flat\nstates: {a: {unit: 1, rate: 1 + 0*a}}\nevents: {zero: {when: a^3 - 3*a^2 + 3*a - 1, then: record}}\n\
                scene: {start: {a: 0}, until: 2, tolerance: 1e-11}\n";
    let printed = simulated("flat", flat);
    let digits = printed.lines().find_map(|line| line.trim().strip_prefix("event zero at t = ")).expect("an event");
    assert!(digits.len() < 9, "{digits}");
}
