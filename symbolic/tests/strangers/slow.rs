//! Files that took long to derive.
