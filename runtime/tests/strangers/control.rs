//! Loops by hand, what a run costs, digits.
