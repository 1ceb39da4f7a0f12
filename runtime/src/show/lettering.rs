//! How wide text is, and what of it is written where there is no room for all.

/// About the width of text in a sans-serif font, in parts of its size: that of DejaVu Sans, which is a wide one.
pub(super) fn width(text: &str) -> f64 {
    let of = |letter: char| match letter {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | ' ' => 0.32,
        'f' | 'r' | 't' | '(' | ')' | '[' | ']' | '/' | '-' | '"' => 0.4,
        'm' | 'w' | 'M' | 'W' | '%' | '@' | '—' | '…' => 0.98,
        '_' => 0.5,
        letter if letter.is_uppercase() => 0.72,
        _ => 0.64,
    };
    text.chars().map(of).sum()
}

/// The text, or as much of its beginning and its end as there is room for in parts of its size: both tell names apart.
pub(super) fn fitted(text: &str, room: f64) -> String {
    if width(text) <= room {
        return text.to_owned();
    }
    let letters: Vec<char> = text.chars().collect();
    let shortened = |kept: usize| -> String {
        let ending = &letters[letters.len() - kept / 2..];
        letters[..kept - kept / 2].iter().chain(&['…']).chain(ending).collect()
    };
    (1..letters.len()).rev().map(shortened).find(|text| width(text) <= room).unwrap_or_else(|| "…".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_long_keeps_its_beginning_and_its_end() {
        assert_eq!(fitted("theta", 20.0), "theta");
        let name = "a_very_long_coordinate_name_that_needs_room";
        let short = fitted(name, 12.0);
        assert!(width(&short) <= 12.0 && width(&short) > 10.0, "{short}");
        assert!(short.starts_with("a_very_lo") && short.ends_with("eds_room") && short.contains('…'), "{short}");
        assert_eq!(fitted("ÄÖÜ", 0.1), "…");
    }
}
