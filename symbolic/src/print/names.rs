//! The file's names as Rust names.

use std::collections::HashSet;

use crate::model::Model;

/// Rust's keywords, all editions.
const KEYWORDS: &[&str] = &[
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn", "else",
    "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "macro", "match", "mod",
    "move", "mut", "override", "priv", "pub", "ref", "return", "self", "Self", "static", "struct", "super", "trait",
    "true", "try", "type", "typeof", "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];

/// Greek letters and their ASCII names.
const GREEK: &[(char, &str)] = &[
    ('α', "alpha"),
    ('β', "beta"),
    ('γ', "gamma"),
    ('δ', "delta"),
    ('ε', "epsilon"),
    ('ζ', "zeta"),
    ('η', "eta"),
    ('θ', "theta"),
    ('ι', "iota"),
    ('κ', "kappa"),
    ('λ', "lambda"),
    ('μ', "mu"),
    ('µ', "mu"),
    ('ν', "nu"),
    ('ξ', "xi"),
    ('ο', "omicron"),
    ('π', "pi"),
    ('ρ', "rho"),
    ('σ', "sigma"),
    ('ς', "sigma"),
    ('τ', "tau"),
    ('υ', "upsilon"),
    ('φ', "phi"),
    ('ϕ', "phi"),
    ('χ', "chi"),
    ('ψ', "psi"),
    ('ω', "omega"),
    ('Γ', "Gamma"),
    ('Δ', "Delta"),
    ('Θ', "Theta"),
    ('Λ', "Lambda"),
    ('Ξ', "Xi"),
    ('Π', "Pi"),
    ('Σ', "Sigma"),
    ('Φ', "Phi"),
    ('Ψ', "Psi"),
    ('Ω', "Omega"),
];

/// A field's name: Greek letters become their ASCII names, keywords get `r#`, indices underscores.
pub fn field_name(name: &str) -> String {
    let plain = ascii(name);
    if matches!(plain.as_str(), "self" | "Self" | "super" | "crate" | "_") {
        return format!("{plain}_");
    }
    if KEYWORDS.contains(&plain.as_str()) { format!("r#{plain}") } else { plain }
}

/// A type's name in `CamelCase`, from a name or a file's name: `double_pendulum` is `DoublePendulum`.
pub fn type_name(name: &str) -> String {
    let plain = ascii(name);
    let camel: String = plain
        .split('_')
        .filter(|part| !part.is_empty())
        .map(|part| {
            let mut letters = part.chars();
            letters.next().map_or(String::new(), |c| c.to_uppercase().chain(letters).collect())
        })
        .collect();
    if camel.is_empty() || camel.starts_with(|c: char| c.is_ascii_digit()) || KEYWORDS.contains(&camel.as_str()) {
        return format!("Model{camel}");
    }
    camel
}

/// The function that writes a system of balances.
pub(super) fn balances_function(system: &str) -> String {
    format!("balances_{}", ascii(system).to_lowercase())
}

/// ASCII letters, digits and underscores; another letter becomes its code point.
fn ascii(name: &str) -> String {
    let mut plain = String::new();
    for c in name.chars() {
        match c {
            _ if c.is_ascii_alphanumeric() || c == '_' => plain.push(c),
            '[' | ',' => plain.push('_'),
            '-' => plain.push_str("minus"),
            ']' | ' ' => {}
            _ => match GREEK.iter().find(|(greek, _)| *greek == c) {
                Some((_, word)) => plain.push_str(word),
                None => plain.push_str(&format!("u{:x}", u32::from(c))),
            },
        }
    }
    if plain.is_empty() || plain.starts_with(|c: char| c.is_ascii_digit()) {
        plain.insert(0, '_');
    }
    plain
}

/// Names of a model's coordinates in generated functions, distinct from each other and from all else there.
pub(super) struct Locals {
    /// One per coordinate; rates get `_dot`, accelerations `_ddot`.
    pub coordinates: Vec<String>,
    /// Intermediate results are this and a number.
    pub prefix: &'static str,
}

impl Locals {
    pub fn of(model: &Model) -> Locals {
        // Names that generated functions use themselves.
        let own = ["c", "t", "u", "q", "v", "a", "out", "dq", "dv", "S", "x", "matrix", "right"];
        let mut taken: HashSet<String> = own.iter().map(|s| (*s).to_owned()).collect();
        let mut coordinates = Vec::new();
        for coordinate in &model.coordinates {
            let mut name = ascii(&coordinate.name);
            if KEYWORDS.contains(&name.as_str()) {
                name.push('_');
            }
            name = name.to_lowercase();
            while [name.clone(), format!("{name}_dot"), format!("{name}_ddot")].iter().any(|n| taken.contains(n)) {
                name.push('_');
            }
            taken.extend([name.clone(), format!("{name}_dot"), format!("{name}_ddot")]);
            coordinates.push(name);
        }
        let numbered = |prefix: &str| {
            taken
                .iter()
                .any(|n| n.strip_prefix(prefix).is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit())))
        };
        let prefix = ["w", "e", "node", "value_"].into_iter().find(|p| !numbered(p)).unwrap_or("local_");
        Locals { coordinates, prefix }
    }
}
