//! Equilibria, what is zero but for rounding, modes.
