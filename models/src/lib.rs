//! The library of mechanisms.
