//! Random runs against runs with bounded steps: the quick form of `docs/random-runs.md`.

use std::fs;
use std::path::{Path, PathBuf};

use dalembert_tests::random_runs::{Verdict, judge, read, survey, written};

#[test]
fn no_random_run_is_wrong_without_a_word() {
    let judged: Vec<_> = [0..40, 10_000..10_040].into_iter().flat_map(|runs| survey(runs, 2, |_| {})).collect();
    let wrong = |verdict: &Verdict| matches!(verdict, Verdict::Wrong { .. } | Verdict::Stopped { .. });
    if let Some(one) = judged.iter().find(|one| wrong(&one.verdict)) {
        panic!("run {}: {:?}\n{}", one.run, one.verdict, one.drawn.text);
    }
    // Most of them are judged at all.
    let right = judged.iter().filter(|one| matches!(one.verdict, Verdict::Right { .. })).count();
    assert!(right >= 60, "{right} of {}", judged.len());
}

/// Runs that were wrong once, each as a file.
#[test]
fn no_run_that_is_kept_is_wrong_again() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("random");
    let files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
    assert!(files.len() > 5, "{files:?}");
    for file in files {
        let drawn = read(&fs::read_to_string(&file).unwrap());
        // What is written is what was read.
        assert_eq!(written(&read(&written(&drawn))), written(&drawn), "{}", file.display());
        let verdict = judge(&drawn);
        assert!(matches!(verdict, Verdict::Right { .. }), "{}: {verdict:?}", file.display());
    }
}
