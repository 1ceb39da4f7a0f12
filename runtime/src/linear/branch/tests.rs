//! Thresholds of known cases.
