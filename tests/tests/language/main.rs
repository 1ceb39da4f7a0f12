//! What docs/LANGUAGE.md promises of runs, sentence by sentence.

mod whole_files;
