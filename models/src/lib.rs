//! The library of mechanisms: every model file of this folder; with the feature `compiled` each in a module of its own, compiled.

include!(concat!(env!("OUT_DIR"), "/models.rs"));
