//! Floats as Rust writes them.

/// A float as Rust text: a well-known constant by its name, any other by its shortest digits.
pub(super) fn float(x: f64) -> String {
    match CONSTANTS.iter().find(|(_, value)| *value == x.abs()) {
        Some((name, _)) => format!("{}::core::f64::consts::{name}", if x < 0.0 { "-" } else { "" }),
        None => format!("{x:?}"),
    }
}

/// Constants that are printed by name.
const CONSTANTS: &[(&str, f64)] = {
    use std::f64::consts as of;
    &[
        ("PI", of::PI),
        ("TAU", of::TAU),
        ("FRAC_PI_2", of::FRAC_PI_2),
        ("FRAC_PI_3", of::FRAC_PI_3),
        ("FRAC_PI_4", of::FRAC_PI_4),
        ("FRAC_PI_6", of::FRAC_PI_6),
        ("FRAC_PI_8", of::FRAC_PI_8),
        ("FRAC_1_PI", of::FRAC_1_PI),
        ("FRAC_2_PI", of::FRAC_2_PI),
        ("FRAC_2_SQRT_PI", of::FRAC_2_SQRT_PI),
        ("SQRT_2", of::SQRT_2),
        ("FRAC_1_SQRT_2", of::FRAC_1_SQRT_2),
        ("E", of::E),
        ("LN_2", of::LN_2),
        ("LN_10", of::LN_10),
        ("LOG2_E", of::LOG2_E),
        ("LOG2_10", of::LOG2_10),
        ("LOG10_E", of::LOG10_E),
        ("LOG10_2", of::LOG10_2),
    ]
};
