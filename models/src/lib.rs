//! The library of mechanisms: every model file of this folder, compiled, each in a module of its own.

include!(concat!(env!("OUT_DIR"), "/models.rs"));
