//! Random runs, judged by runs with bounded steps: is any of them wrong without a word?
//!
//! 1. A mechanism with drawn parameters: look in `mechanisms.rs`; functions that happen in a small part of their
//!    variable: in `shapes.rs`; both as the text of a model file: in `file.rs`; other starts, horizons and features: in `wider.rs`.
//! 2. The run, and the one that judges it: look in `judge.rs`; how its steps are bounded: in `local.rs`.
//! 3. Many of them at once: look in `survey.rs`; those that are kept as files: in `kept.rs`.

mod draws;
mod file;
mod judge;
mod kept;
mod local;
mod mechanisms;
mod shapes;
mod survey;
mod wider;

pub use draws::Draws;
pub use file::{Drawn, Place, draw};
pub use judge::{Verdict, judge};
pub use kept::{read, written};
pub use local::{Local, Of};
pub use shapes::{Shape, Sharpness, Spot};
pub use survey::{Judged, drawn, survey};
pub use wider::draw_wider;
