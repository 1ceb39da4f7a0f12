//! Drawn mechanisms with up to four contacts and frictions, judged by time stepping and by what contacts must never do.
//!
//! 1. What is drawn, and its model file: look in `scene.rs`.
//! 2. The same mechanism by Moreau's and Jean's time stepping, which shares nothing with the library: in `moreau.rs`.
//! 3. The run and its verdict: in `judge.rs`.

mod judge;
mod moreau;
mod scene;

pub use judge::{Verdict, judge};
pub use scene::{KINDS, Law, Scene, draw};
