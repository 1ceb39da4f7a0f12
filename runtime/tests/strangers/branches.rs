//! Branches of equilibria, thresholds, root loci.
