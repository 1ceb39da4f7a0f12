//! Sections of the file, each with its meaning: declarations, bodies, loads, balances, scenes, what is watched.

pub mod attachment;
pub mod balances;
pub mod bodies;
pub mod constraints;
pub mod counts;
mod cycles;
pub mod declare;
pub mod draw;
pub mod ends;
pub mod events;
pub mod forces;
pub mod hinge_ambiguity;
pub mod inertia;
mod joint_rows;
pub mod joints;
pub mod loads;
pub mod parameters;
pub mod phases;
pub mod reactions;
pub mod resolve_values;
pub mod rotations;
pub mod scenes;
pub mod settings;
mod solids;
pub mod springs;
pub mod tables;
pub mod watched;
