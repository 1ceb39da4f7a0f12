//! Reactions as results; what a claim is tested with.
