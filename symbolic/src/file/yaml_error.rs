//! What YAML's libraries complain of, in our words, with a way out.

use super::read::byte_at;
use super::unquoted::pair;
use crate::diagnose::{Place, Problem, catalogue::yaml};
use crate::language::shorten;

const QUOTE_IT: &str = "put the expression in double quotes";

/// The complaint `what` at a byte of the file.
pub(super) fn yaml_error(text: &str, at: usize, what: &str) -> Problem {
    let at = floor(text, at);
    let place = one_character(text, at);
    let start = context(text, what).unwrap_or(at);
    let next = text[at..].chars().next();
    let same_line = !text[start.min(at)..at].contains('\n') && next.is_some_and(|c| c != '\n');
    if what.contains("quoted scalar") && !what.contains("escape") {
        return open_quote(text, start);
    }
    if what.contains("expected ',' or")
        && let Some(quote) = odd_quote(text, start, at)
    {
        return open_quote(text, quote);
    }
    if what.contains("did not find expected ','") || what.contains("expected ',' or") {
        return match (same_line, next) {
            (true, Some(found @ (']' | '}'))) => {
                let closing = if found == ']' { '}' } else { ']' };
                yaml::not_yaml(place, format!("expected `,` or `{closing}`, found `{found}`"), "")
            }
            (true, _) => yaml::unquoted(place, quote(text, at)),
            _ if text[start..].starts_with('{') => yaml::open_collection(one_character(text, start), "{", "}"),
            _ if text[start..].starts_with('[') => yaml::open_collection(one_character(text, start), "[", "]"),
            _ => yaml::not_yaml(place, "a list or mapping is not closed", ""),
        };
    }
    let value = value_before(text, at);
    if what.contains("could not find expected ':'") {
        return no_colon(text, start);
    }
    if what.contains("mapping values are not allowed") {
        if let Some(problem) = no_blank(text, at).or_else(|| wrong_above(text, at)) {
            return problem;
        }
        return yaml::not_yaml(
            place,
            "a colon cannot stand here",
            "check the indentation, or put a text with `: ` in it in quotes",
        );
    }
    if what.contains("cannot start any token") && next == Some('\t') {
        return yaml::not_yaml(place, "a tab cannot indent", "indent with blanks");
    }
    if what.contains("control characters") {
        return yaml::not_yaml(place, "a control character cannot stand in a file", "remove it");
    }
    if what.contains("escape") {
        return yaml::not_yaml(place, "an unknown escape", "write `\\\\` for a backslash");
    }
    if what.contains("expected '-' indicator") {
        return yaml::not_yaml(
            place,
            "this stands below the items of a list and is none",
            "an item begins with `- `; what belongs to an item, or to none, is indented otherwise",
        );
    }
    if what.contains("block sequence entries") || value.starts_with(['[', '"', '\'', '*', '&']) && same_line {
        return yaml::unquoted(place, quote(text, at));
    }
    let what = what.split(" at line ").next().unwrap_or(what);
    yaml::not_yaml(place, what.replace('`', "'"), "")
}

/// A list or mapping where a key should be: mostly an expression inside `{…}`.
pub(super) fn complex_key(text: &str, at: usize) -> Problem {
    let at = floor(text, at);
    let line = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    if text[line..at].trim_start_matches('?').trim().is_empty() {
        yaml::key_not_text(one_character(text, at))
    } else {
        yaml::unquoted(one_character(text, at), quote(text, at))
    }
}

/// Where the line begins in which a byte is, and its text.
fn line_of(text: &str, at: usize) -> (usize, &str) {
    let start = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    (start, text[start..].lines().next().unwrap_or_default())
}

fn indent(line: &str) -> usize {
    line.len() - line.trim_start_matches(' ').len()
}

/// The last double quote of the first line, from one byte to another, in which they are odd.
fn odd_quote(text: &str, from: usize, to: usize) -> Option<usize> {
    let (mut start, _) = line_of(text, from);
    for line in text[start..].split_inclusive('\n') {
        if start > to {
            return None;
        }
        let quotes: Vec<usize> = line.match_indices('"').map(|(byte, _)| byte).collect();
        if quotes.len() % 2 == 1 {
            return quotes.last().map(|byte| start + byte);
        }
        start += line.len();
    }
    None
}

/// A line that should be a key with its value, and has no colon.
fn no_colon(text: &str, at: usize) -> Problem {
    let (start, line) = line_of(text, at);
    let (start, line) = (start + indent(line), line.trim());
    if let Some((length, meant)) = pair(line) {
        return yaml::no_pair(Place::in_file(start, start + length), shorten(line), shorten(&meant));
    }
    let place = Place::in_file(start, start + line.len());
    yaml::not_yaml(place, format!("a colon is missing after `{}`", shorten(line)), "")
}

/// `crank:{mass: 1}`: the colon that counts stands before the one that is complained of.
fn no_blank(text: &str, at: usize) -> Option<Problem> {
    let (start, line) = line_of(text, at);
    let (start, line) = (start + indent(line), line.trim());
    let (length, meant) = pair(line).filter(|(length, _)| start + length <= at)?;
    Some(yaml::no_pair(Place::in_file(start, start + length), shorten(line), shorten(&meant)))
}

/// The line before, where it has no colon or alone is indented less than its neighbours.
fn wrong_above(text: &str, at: usize) -> Option<Problem> {
    let (mut start, line) = line_of(text, at);
    let mut above = || loop {
        let (before, line) = line_of(text, start.checked_sub(1)?);
        start = before;
        if !line.trim().is_empty() && !line.trim_start().starts_with('#') {
            return Some((before, line));
        }
    };
    let (start, less) = above()?;
    if !less.contains([':', '-', '#']) {
        return Some(no_colon(text, start));
    }
    let (_, first) = above()?;
    (indent(less) < indent(line) && indent(first) == indent(line)).then(|| {
        let place = Place::in_file(start + indent(less), start + less.trim_end().len());
        yaml::not_yaml(place, "this line is indented less than those around it", "indent it as these")
    })
}

fn open_quote(text: &str, start: usize) -> Problem {
    let quote = if text[start..].starts_with('\'') { "'" } else { "\"" };
    let help = if quote == "'" { "primes end single quotes; put the expression in double quotes" } else { "close it" };
    yaml::open_quote(one_character(text, start), quote, help)
}

/// "while parsing … at line 3 column 4": the byte meant.
fn context(text: &str, what: &str) -> Option<usize> {
    let (_, context) = what.split_once(", while ")?;
    let Some((_, numbers)) = context.split_once(" at line ") else {
        // serde_yaml leaves the very first position out.
        return Some(0);
    };
    let mut numbers = numbers.split(" column ").map(|number| number.parse().ok());
    Some(floor(text, byte_at(text, numbers.next()??, numbers.next()??)))
}

/// "put the expression in double quotes: `"…"`", with the expression around a byte if it can be told.
fn quote(text: &str, at: usize) -> String {
    let expression = expression_around(text, at);
    let usable = !expression.contains(['"', '\'', '{', '\n']) && (2..80).contains(&expression.len());
    if usable { format!("{QUOTE_IT}: `\"{expression}\"`") } else { QUOTE_IT.to_owned() }
}

/// From the comma, colon or opening bracket before to the comma or closing bracket after, brackets respected.
fn expression_around(text: &str, at: usize) -> &str {
    let line = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let mut depth = 0;
    let mut start = line;
    for (byte, c) in text[line..at].char_indices().rev() {
        let colon = c == ':' && text[line + byte + 1..].starts_with(' ');
        match c {
            ')' | ']' | '}' => depth += 1,
            '(' | '[' | '{' if depth > 0 => depth -= 1,
            // A comma between the arguments of a call is part of the expression.
            ',' if depth == 0
                && text[line..line + byte].matches('(').count() > text[line..line + byte].matches(')').count() => {}
            '[' | '{' | ',' if depth == 0 => start = line + byte + 1,
            _ if colon && depth == 0 => start = line + byte + 1,
            _ => continue,
        }
        if start > line {
            break;
        }
    }
    let mut depth = 0;
    let rest = &text[start..];
    let end = rest.char_indices().find(|&(byte, c)| {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        let colon = c == ':' && rest[byte + 1..].starts_with(' ');
        c == '\n' || depth < 0 || (depth == 0 && (c == ',' || colon))
    });
    rest[..end.map_or(rest.len(), |(byte, _)| byte)].trim()
}

/// What stands on the line after the key, up to a byte.
fn value_before(text: &str, at: usize) -> &str {
    let line = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
    let before = &text[line..at];
    before.split_once(": ").map_or(before, |(_, value)| value).trim_start().trim_start_matches("- ")
}

fn one_character(text: &str, at: usize) -> Place {
    let length = text[at..].chars().next().filter(|c| *c != '\n').map_or(0, char::len_utf8);
    Place::in_file(at, at + length)
}

fn floor(text: &str, at: usize) -> usize {
    (0..=at.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0)
}
