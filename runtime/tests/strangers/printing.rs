//! Equations for people, symbolic linearisation.
