//! Any text read as an expression, an equation, a key, a value with unit, and a unit.
#![no_main]

use dalembert_symbolic::diagnose::Problem;
use dalembert_symbolic::language::{parse, parse_equation, parse_key, parse_unit, parse_value_with_unit};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    told(text, parse(text));
    told(text, parse_equation(text));
    told(text, parse_key(text));
    told(text, parse_unit(text));
    if let Some(valued) = told(text, parse_value_with_unit(text)) {
        assert!(text.get(valued.value.span.range()).is_some());
        if let Some((unit, span)) = valued.unit {
            assert_eq!(text.get(span.range()), Some(unit.as_str()));
        }
    }
});

/// A failure has a reason, and the reason a place in the text.
fn told<T>(text: &str, result: Result<T, Vec<Problem>>) -> Option<T> {
    let problems = match result {
        Ok(value) => return Some(value),
        Err(problems) => problems,
    };
    assert!(!problems.is_empty());
    for problem in problems {
        let span = problem.place.span.expect("a span");
        assert!(text.get(span.range()).is_some());
    }
    None
}
