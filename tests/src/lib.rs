//! What the workspace promises as a whole: one test file per subject, in `tests/`.
