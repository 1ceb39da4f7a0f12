//! "Did you mean …?"

use strsim::damerau_levenshtein;

use super::quoted;

/// The candidate nearest to `name`: at most one edit in three letters away (two edits in four or five), swaps of
/// neighbours counted once, or equal but for case.  Ties go to the first.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = name.chars().count();
    if length > LONGEST {
        return None;
    }
    let allowed = match length {
        0..=3 => 1,
        4..=7 => 2,
        _ => 3,
    };
    let lower = name.to_lowercase();
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates.into_iter().take(MOST) {
        if candidate.len().abs_diff(name.len()) > 4 * allowed {
            continue;
        }
        let size = candidate.chars().count();
        if candidate == name || size.abs_diff(length) > allowed {
            continue;
        }
        let distance = if candidate.to_lowercase() == lower { 0 } else { damerau_levenshtein(name, candidate) };
        // Of two letters that differ in the first nothing is left.
        if distance > 0 && length <= 2 && !lower.starts_with(|c| candidate.to_lowercase().starts_with(c)) {
            continue;
        }
        let closer = best.is_none_or(|(least, _)| distance < least);
        if distance <= allowed && distance < length.max(size) && closer {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// "did you mean `x`?", or nothing.
pub fn did_you_mean<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    nearest(name, candidates).map(|near| format!("did you mean `{near}`?")).unwrap_or_default()
}

/// "did you mean `x`?", or else what is allowed: "one of `a`, `b`, `c`", or "there is none".
pub fn did_you_mean_or(name: &str, candidates: &[&str]) -> String {
    match nearest(name, candidates.iter().copied()) {
        _ if candidates.is_empty() => "there is none".to_owned(),
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("it is one of {}", quoted(candidates)),
    }
}

/// "did you mean `x'`?" of a name that is another way to write a rate of one of these: `vx`, `v_x`, `xdot`, `x_dot`, `dx`, `dxdt`,
/// `x_ddot`.
pub fn rate_meant<'a>(name: &str, moving: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let lower = name.to_lowercase();
    let stripped =
        |front: &str, back: &str| lower.strip_prefix(front).and_then(|rest| rest.strip_suffix(back)).map(str::to_owned);
    let known: Vec<&str> = moving.into_iter().take(MOST).collect();
    RATES.iter().find_map(|(front, back, primes)| {
        let meant = stripped(front, back)?;
        let of = known.iter().find(|known| known.to_lowercase() == meant)?;
        Some(format!("did you mean `{of}{primes}`?"))
    })
}

/// Ways to write a rate: what stands before and behind the name, and the primes that say it here.
const RATES: [(&str, &str, &str); 12] = [
    ("", "_ddot", "''"),
    ("", "ddot", "''"),
    ("", "_dot", "'"),
    ("", "dot", "'"),
    ("d", "_dt", "'"),
    ("d", "dt", "'"),
    ("v_", "", "'"),
    ("v", "", "'"),
    ("d_", "", "'"),
    ("d", "", "'"),
    ("a_", "", "''"),
    ("omega_", "", "'"),
];

/// So many candidates are looked at.
const MOST: usize = 2000;

/// Names longer than this are not compared: the distance costs the product of the lengths.
const LONGEST: usize = 64;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_what_was_meant() {
        assert_eq!(nearest("thta", ["phi", "theta"]), Some("theta"));
        assert_eq!(nearest("corodinates", ["coordinates", "constraints"]), Some("coordinates"));
        assert_eq!(nearest("Theta", ["theta"]), Some("theta"));
        assert_eq!(nearest("thetaa", ["theta1", "theta2"]), Some("theta1"));
    }

    #[test]
    fn rates_have_primes() {
        for name in ["vx", "v_x", "xdot", "x_dot", "xDot", "dx", "dxdt", "dx_dt"] {
            assert_eq!(rate_meant(name, ["y", "x"]).as_deref(), Some("did you mean `x'`?"), "{name}");
        }
        assert_eq!(rate_meant("theta_ddot", ["theta"]).as_deref(), Some("did you mean `theta''`?"));
        assert_eq!(rate_meant("dot", ["x"]), None);
        assert_eq!(rate_meant("vz", ["x"]), None);
    }

    #[test]
    fn proposes_nothing_far_away() {
        assert_eq!(nearest("x", ["y"]), None);
        assert_eq!(nearest("", ["y"]), None);
        assert_eq!(nearest("mass", ["theta"]), None);
        assert_eq!(
            (nearest("zu", ["mu"]), nearest("l", ["ln"]), nearest("m1", ["m2"])),
            (None, Some("ln"), Some("m2"))
        );
        assert_eq!(did_you_mean("mass", ["theta"]), "");
        assert_eq!(did_you_mean_or("mass", &["a", "b"]), "it is one of `a`, `b`");
        assert_eq!(did_you_mean_or("mass", &[]), "there is none");
    }
}
