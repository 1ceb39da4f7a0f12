//! Everything before Rust exists: reads a model file, checks it, derives its equations and prints them.
