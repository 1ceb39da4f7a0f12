//! Mechanisms described in YAML: derived, compiled, integrated, linearised and judged.

pub mod mechanism;

pub use dalembert_macros::model;
