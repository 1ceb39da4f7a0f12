//! Any text taken as a model as far as it goes: read, resolved, derived and tested.
#![no_main]

use dalembert_symbolic::gate::judged;
use dalembert_symbolic::file::render;
use dalembert_symbolic::model::load;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Err(problems) = load(text, &[]).and_then(judged) {
        assert!(!problems.is_empty());
        render("fuzz.yaml", text, &problems);
    }
});
