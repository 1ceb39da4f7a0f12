//! Any text read as a model file; what is wrong with it can be shown.
#![no_main]

use dalembert_symbolic::file::render;
use dalembert_symbolic::file::read;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Err(problems) = read(text) {
        assert!(!problems.is_empty());
        render("fuzz.yaml", text, &problems);
    }
});
