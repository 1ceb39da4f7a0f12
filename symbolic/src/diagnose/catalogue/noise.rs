//! E281–: held noise.

super::entries! {
    E281 bad_noise(name, why, help) "noise that is not determined"
        "`{name}` is no noise: {why}" "" "{help}"
        "Held noise has a period, `every`, how large it is, `sigma` or `density`, and a seed, a whole number or a parameter: these decide all its numbers.";
}
