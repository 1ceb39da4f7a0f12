//! Names of a model file as Rust identifiers.

use deunicode::deunicode_char;

/// Rust's keywords, all editions.
pub const KEYWORDS: &[&str] = &[
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn", "else",
    "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "macro", "match", "mod",
    "move", "mut", "override", "priv", "pub", "ref", "return", "self", "Self", "static", "struct", "super", "trait",
    "true", "try", "type", "typeof", "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];

/// Keywords that cannot be written `r#…`, and the wildcard.
const NEVER_RAW: &[&str] = &["self", "Self", "super", "crate", "_"];

/// Methods that every generated type has, by its traits or by those in every scope: a derived parameter of such a
/// name would take the method's place, so its own method gets an underscore.
///
/// Sorted; `tests/tests/names.rs` holds it against the runtime's traits.
pub const METHODS: &[&str] = &[
    "accelerations",
    "accelerations_at",
    "arguments",
    "as_mut",
    "as_ref",
    "assignments",
    "balances",
    "balances_at",
    "bias",
    "bias_at",
    "borrow",
    "borrow_mut",
    "clock_numbers",
    "clone",
    "clone_from",
    "clone_into",
    "constants",
    "constraint_bias",
    "constraint_jacobians",
    "constraint_matrix",
    "constraint_rate_jacobian",
    "constraints",
    "contacts",
    "default",
    "deref",
    "deref_mut",
    "description",
    "drawing",
    "drop",
    "eliminated",
    "energy",
    "eq",
    "equilibrium_guess",
    "equilibrium_here",
    "equilibrium_near",
    "event_rates",
    "events",
    "expansion",
    "fmt",
    "frequencies",
    "friction",
    "from",
    "gimbals",
    "held_noise",
    "held_rates",
    "input_jacobian",
    "inputs",
    "into",
    "invariants",
    "jacobians",
    "jacobians_at",
    "linearise",
    "magnitudes",
    "mass_matrix",
    "mass_matrix_at",
    "motion_numbers",
    "motions",
    "ne",
    "outputs",
    "parameter_mut",
    "parameters",
    "part_accelerations",
    "part_energy",
    "residual",
    "residual_at",
    "restitutions",
    "sampling",
    "scene",
    "scene_memory",
    "scene_numbers",
    "scene_parameters",
    "series",
    "series_constants",
    "simulate",
    "start_condition_speeds",
    "start_condition_values",
    "start_conditions",
    "switches",
    "system",
    "tables_2d",
    "time_dependence",
    "time_jacobian",
    "to_owned",
    "try_from",
    "try_into",
    "type_id",
];

/// Greek letters and the names that physicists give them.
const GREEK: &[(char, &str)] = &[
    ('α', "alpha"),
    ('β', "beta"),
    ('γ', "gamma"),
    ('δ', "delta"),
    ('ε', "epsilon"),
    ('ϵ', "epsilon"),
    ('ζ', "zeta"),
    ('η', "eta"),
    ('θ', "theta"),
    ('ϑ', "theta"),
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
    ('ϱ', "rho"),
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
    ('Υ', "Upsilon"),
    ('Φ', "Phi"),
    ('Ψ', "Psi"),
    ('Ω', "Omega"),
];

/// A field's or module's name: as in the file, in ASCII; keywords get `r#`, what cannot be raw an underscore.
pub fn field_name(name: &str) -> String {
    let plain = ascii(name);
    match plain.as_str() {
        "_" => "value_".to_owned(),
        word if NEVER_RAW.contains(&word) => format!("{plain}_"),
        word if KEYWORDS.contains(&word) => format!("r#{plain}"),
        _ => plain,
    }
}

/// The name of a derived parameter's method: as [`field_name`], but never that of another method of the type.
pub fn method_name(name: &str) -> String {
    let field = field_name(name);
    if METHODS.contains(&field.as_str()) { format!("{field}_") } else { field }
}

/// A type's name in `CamelCase`, from a name or a file's name: `double_pendulum` is `DoublePendulum`.
pub fn type_name(name: &str) -> String {
    let spelt: String =
        name.chars().map(|c| if c == '_' || c.is_alphanumeric() { spell(c) } else { " ".into() }).collect();
    let parts = spelt.split(|c: char| !c.is_ascii_alphanumeric()).filter(|part| !part.is_empty());
    let camel: String = parts
        .map(|part| {
            let (first, rest) = part.split_at(1);
            first.to_ascii_uppercase() + rest
        })
        .collect();
    let named = camel.starts_with(|c: char| c.is_ascii_uppercase()) && !KEYWORDS.contains(&camel.as_str());
    if named { camel } else { format!("Model{camel}") }
}

/// A variable's name in `snake_case`; it may be a keyword.
pub fn local_name(name: &str) -> String {
    let lower = ascii(name).to_lowercase();
    let parts: Vec<&str> = lower.split('_').filter(|part| !part.is_empty()).collect();
    let plain = parts.join("_");
    if plain.starts_with(|c: char| c.is_ascii_alphabetic()) { plain } else { format!("value_{plain}") }
}

/// Whether rustc takes a name for snake case.
pub fn is_snake_case(name: &str) -> bool {
    let name = name.trim_start_matches("r#").trim_matches('_');
    !name.contains("__") && !name.contains(|c: char| c.is_uppercase())
}

/// ASCII letters, digits and underscores; `theta[3]` is `theta_3`, and other scripts are transliterated.
fn ascii(name: &str) -> String {
    let spelt: String = name.chars().map(spell).collect();
    let mut plain = spelt.trim_end_matches(' ').replace(' ', "_");
    if plain.is_empty() || plain.starts_with(|c: char| c.is_ascii_digit()) {
        plain.insert(0, '_');
    }
    plain
}

/// The name that physicists give a Greek letter.
pub(crate) fn greek(c: char) -> Option<&'static str> {
    GREEK.iter().find(|(letter, _)| *letter == c).map(|(_, name)| *name)
}

/// One character in ASCII; a space separates words of a script without them.
pub(crate) fn spell(c: char) -> String {
    if c.is_ascii_alphanumeric() || c == '_' {
        return c.into();
    }
    match c {
        '[' | ',' => return "_".to_owned(),
        '-' => return "minus".to_owned(),
        ']' | ' ' => return String::new(),
        _ => {}
    }
    if let Some(name) = greek(c) {
        return name.to_owned();
    }
    let Some(sound) = deunicode_char(c) else { return format!("u{:x}", u32::from(c)) };
    let letters = sound.chars().filter(|c| c.is_ascii_alphanumeric() || *c == ' ');
    if c.is_uppercase() { letters.collect() } else { letters.map(|c| c.to_ascii_lowercase()).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_the_files_names_in_ascii() {
        for (name, field) in [
            ("l_0", "l_0"),
            ("M", "M"),
            ("θ1", "theta1"),
            ("type", "r#type"),
            ("self", "self_"),
            ("Self", "Self_"),
            ("_", "value_"),
            ("größe", "grosse"),
            ("e\u{301}tat", "etat"),
            ("état", "etat"),
            ("длина", "dlina"),
            ("弹簧", "dan_huang"),
            ("x[1,-2]", "x_1_minus2"),
        ] {
            assert_eq!(field_name(name), field, "{name}");
        }
        assert_eq!(method_name("clone"), "clone_");
        assert_eq!(method_name("I"), "I");
    }

    #[test]
    fn types_are_in_camel_case() {
        for (name, camel) in [
            ("double_pendulum", "DoublePendulum"),
            ("ünï", "Uni"),
            ("crane.c", "CraneC"),
            ("11 integral", "Model11Integral"),
            ("self", "ModelSelf"),
            ("弹簧", "DanHuang"),
            ("", "Model"),
            ("θ", "Theta"),
        ] {
            assert_eq!(type_name(name), camel, "{name}");
        }
    }

    #[test]
    fn variables_are_in_snake_case() {
        for (name, local) in
            [("In", "in"), ("theta[3]", "theta_3"), ("__a__B_", "a_b"), ("_", "value_"), ("_1", "value_1")]
        {
            assert_eq!(local_name(name), local, "{name}");
            assert!(is_snake_case(&local_name(name)));
        }
    }
}
