//! Files that took long to derive.

use super::{accepted, refused};

/// A model file of `tests/strangers`.
fn text_of(name: &str) -> String {
    let path = format!("{}/../tests/strangers/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Springs with roots between particles that constraints keep on a sphere.
#[test]
fn charges_on_a_sphere_are_judged() {
    let text = text_of("charges_on_a_sphere");
    accepted(&text);
    // What is false is found all the same.
    refused(&format!("{text}conserved: {{energy: energy}}\n"), "is not conserved");
}

#[test]
fn a_chain_in_space_is_judged() {
    accepted(&text_of("chain_in_space"));
}

/// ∫ dx/(c + k u²) in all its spellings, and where it is no peak.
#[test]
fn peaks_of_any_spelling_are_integrated() {
    let peak = |integrand: &str, claim: &str| {
        format!(
            "name: Peak\nparameters: {{m: 1 kg, L: 1 m, s: 1e-3 m, A: 1 N, x0: 0.3173 m}}\ncoordinates: {{a: m}}\n\
            kinetic_energy: m*a'^2/2\npotential_energy: integral({integrand}, x in 0..L)*a/L\n\
            checks: {{c: \"potential_energy = A*s*a/L*({claim})\"}}\n"
        )
    };
    let arctangents = "atan((L - x0)/s) + atan(x0/s)";
    for integrand in ["A/(1 + ((x - x0)/s)^2)", "A*s^2/((x - x0)^2 + s^2)", "A/(1 + (x - x0)^2/s^2)"] {
        accepted(&peak(integrand, arctangents));
        refused(&peak(integrand, "pi"), "E5");
    }
    accepted(&peak("A/(2 + 3*(x - x0)^2/s^2)", "(atan(sqrt(1.5)*(L - x0)/s) + atan(sqrt(1.5)*x0/s))/sqrt(6)"));
    // A pole in the range is none.
    refused(&peak("A/(((x - x0)/s)^2 - 1)", "0"), "E233");
}
