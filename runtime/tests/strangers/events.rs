//! Events early in long steps, starts on guards, accumulating impacts.
