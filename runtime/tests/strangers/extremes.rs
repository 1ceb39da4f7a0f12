//! Extremes and samples of a run: `sweep`, `needs`, tables.
