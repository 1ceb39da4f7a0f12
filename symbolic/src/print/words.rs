//! Words of the file in generated text: one writer for documentation and comments, one for string literals.
//!
//! Whatever the words are, they end neither the comment nor the literal that holds them, and cannot be mistaken for
//! anything else by an editor: control characters and marks of direction are written as escapes.

/// Lines of documentation, each after `///`.
pub(super) fn documentation(lines: &str, indent: &str) -> String {
    let mut out = String::new();
    for line in lines.split('\n') {
        out += format!("{indent}/// {}", visible(line)).trim_end();
        out.push('\n');
    }
    out
}

/// One line of comment after `//`.
pub(super) fn comment(words: &str, indent: &str) -> String {
    format!("{indent}// {}\n", visible(words).trim_end())
}

/// A string literal.
pub(super) fn string(words: &str) -> String {
    format!("{words:?}")
}

/// A paragraph of the file's as one line of Markdown that neither opens a block of code, which would be compiled as
/// an example, nor is taken for HTML or for a link to Rust items.
pub(super) fn paragraph(words: &str) -> String {
    let line = words.split_whitespace().collect::<Vec<_>>().join(" ");
    let fence = line.starts_with("```") || line.starts_with("~~~");
    let mut out = if fence { "\\".to_owned() } else { String::new() };
    let paired = line.matches('`').count() % 2 == 0;
    let mut code = false;
    for (at, c) in line.char_indices() {
        let rest = &line[at + c.len_utf8()..];
        let literal = match c {
            '`' => {
                code = paired && !code;
                !paired
            }
            '[' => !code && !is_link(rest),
            '<' => !code && !rest.starts_with("http"),
            _ => false,
        };
        if literal && !(fence && at == 0) {
            out.push('\\');
        }
        out.push(c);
    }
    out
}

/// Whether `[` before this opens a link that says where it leads.
fn is_link(rest: &str) -> bool {
    rest.find(']').is_some_and(|end| rest[end + 1..].starts_with('('))
}

/// One line in which every character can be seen.
pub(super) fn visible(words: &str) -> String {
    let mut line = String::with_capacity(words.len());
    for c in words.chars() {
        match c {
            ' '..='~' => line.push(c),
            '\t' | '\n' | '\r' => line.push(' '),
            // As in a string that begins otherwise, since a combining mark is escaped only at the beginning.
            _ => line.extend(format!(" {c}").escape_debug().skip(1)),
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_ends_a_comment() {
        for words in
            ["a\nb", "a\r\nb", "a\rb", "a\u{2028}b", "a\u{85}b", "a\u{b}b", "a\u{202e}b", "a\u{0}b", "a\u{fffe}b"]
        {
            let text = comment(words, "");
            assert_eq!(text.matches('\n').count(), 1, "{text:?}");
            let strange = |c: char| c != '\n' && !(' '..='~').contains(&c);
            assert!(!text.contains(strange), "{text:?}");
        }
        assert_eq!(comment("x */ \"# \\", ""), "// x */ \"# \\\n");
        assert_eq!(comment("θ é e\u{301} 弹", ""), "// θ é e\u{301} 弹\n");
    }

    #[test]
    fn documentation_keeps_its_lines() {
        assert_eq!(documentation("a\n\nb  ", "  "), "  /// a\n  ///\n  /// b\n");
    }

    #[test]
    fn a_paragraph_is_no_example() {
        assert_eq!(paragraph("two\n  lines, `x[1]` and x[1]"), "two lines, `x[1]` and x\\[1]");
        assert_eq!(paragraph("```\npanic!()\n```"), "\\``` panic!() ```");
        assert_eq!(paragraph("    let x = 1;"), "let x = 1;");
        assert_eq!(paragraph("[a](b) <!-- <https://c.d> `"), "[a](b) \\<!-- <https://c.d> \\`");
    }
}
