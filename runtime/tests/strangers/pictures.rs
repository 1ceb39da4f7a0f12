//! Charts, axes, pictures, the command line.
