//! Mechanisms with constraints, reactions, phases and impacts.

mod contact;
mod integrals;
mod linkages;
mod rods;
mod skates;
mod small;
mod starts;

use dalembert::mechanism::Interpreted;
use dalembert_symbolic::lower::compile;
use dalembert_tests::case::Case;

/// A model file that is written out, interpreted.
#[track_caller]
fn written(text: &str) -> Case {
    let program = compile(text, &[]).unwrap_or_else(|problems| {
        let told: Vec<&str> = problems.iter().map(|problem| problem.message.as_str()).collect();
        panic!("{text}\n{}", told.join("\n"))
    });
    Case::from_system(Box::new(Interpreted::new(program, text)))
}
