//! Any text taken as a model as far as it goes: read, resolved, derived, tested, lowered and printed.
#![no_main]

use dalembert_symbolic::file::render;
use dalembert_symbolic::lower::compile;
use dalembert_symbolic::print;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match compile(text, &[]) {
        Ok(program) => {
            print::rust(&program, text, "Fuzzed");
            print::python(&program, "fuzzed");
            let reading = print::Reading::of(&program);
            reading.text(&program.model);
            reading.latex(&program.model);
        }
        Err(problems) => {
            assert!(!problems.is_empty());
            render("fuzz.yaml", text, &problems);
        }
    }
});
