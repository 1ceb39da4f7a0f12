//! Problems as text: path, line, column, the line itself, a caret, help.

use std::fmt::Write;
use std::ops::Range;

use super::locate;
use crate::diagnose::{Problem, counted};

/// Most problems shown.
const MOST: usize = 50;

/// Most problems whose places are looked for, which takes time in large files.
const LOCATED: usize = 1000;

/// Widest part of a line shown, in characters.
const WIDEST: usize = 120;

/// All problems of the file `path` with content `text`, sorted by position, and a last line that counts them; nothing
/// where there are none.
///
/// Columns count characters from 1.
pub fn render(path: &str, text: &str, problems: &[Problem]) -> String {
    if problems.is_empty() {
        return String::new();
    }
    let located = &problems[..problems.len().min(LOCATED)];
    let places: Vec<_> = located.iter().map(|problem| &problem.place).collect();
    let mut sorted: Vec<(Range<usize>, &Problem)> = locate(text, &places).into_iter().zip(located).collect();
    sorted.sort_by_key(|(range, problem)| (range.start, range.end, problem.code));
    sorted.dedup();
    let mut out = String::new();
    for (range, problem) in sorted.iter().take(MOST) {
        one(&mut out, path, text, range, problem);
        out.push('\n');
    }
    let hidden = sorted.len().saturating_sub(MOST) + problems.len() - located.len();
    if hidden > 0 {
        let _ = writeln!(out, "… and {hidden} more\n");
    }
    let all = sorted.len() + problems.len() - located.len();
    let warnings = sorted.iter().filter(|(_, problem)| problem.is_warning()).count();
    let counts = [(all - warnings, "error"), (warnings, "warning")];
    let counts: Vec<String> = counts.iter().filter(|(n, _)| *n > 0).map(|&(n, word)| counted(n, word)).collect();
    let _ = writeln!(out, "{} in {path}", counts.join(" and "));
    out
}

/// Where a problem stands: line and column of its beginning and of what follows its end, in characters from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "named after what they are")]
pub struct Extent {
    pub line: usize,
    pub column: usize,
    pub end_line: usize,
    pub end_column: usize,
}

/// Problems with where they stand in the text, sorted by that.
pub fn extents<'a>(text: &str, problems: &'a [Problem]) -> Vec<(Extent, &'a Problem)> {
    let located = &problems[..problems.len().min(LOCATED)];
    let places: Vec<_> = located.iter().map(|problem| &problem.place).collect();
    let at = |offset: usize| {
        let before = &text[..offset];
        let start = before.rfind('\n').map_or(0, |newline| newline + 1);
        (before.matches('\n').count() + 1, before[start..].chars().count() + 1)
    };
    let mut found: Vec<(Extent, &Problem)> = locate(text, &places)
        .into_iter()
        .map(|range| {
            let ((line, column), (end_line, end_column)) = (at(range.start), at(range.end));
            Extent { line, column, end_line, end_column }
        })
        .zip(located)
        .collect();
    found.sort_by_key(|(spot, problem)| (spot.line, spot.column, problem.code));
    found
}

/// Sorts problems by where they stand in the text.
pub fn sort(text: &str, problems: &mut Vec<Problem>) {
    let places: Vec<_> = problems.iter().take(LOCATED).map(|problem| &problem.place).collect();
    let starts = locate(text, &places).into_iter().map(|range| range.start).chain(std::iter::repeat(usize::MAX));
    let mut sorted: Vec<(usize, Problem)> = starts.zip(std::mem::take(problems)).collect();
    sorted.sort_by_key(|(start, _)| *start);
    problems.extend(sorted.into_iter().map(|(_, problem)| problem));
}

fn one(out: &mut String, path: &str, text: &str, range: &Range<usize>, problem: &Problem) {
    let before = &text[..range.start];
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = text[start..].lines().next().unwrap_or("");
    let number = before.matches('\n').count() + 1;
    let column = text[start..range.start].chars().count();
    let covered = text[range.clone()].lines().next().unwrap_or("").chars().count().max(1);
    let gutter = " ".repeat(number.to_string().len());
    let (shown, lead, carets) = window(line, column, covered);
    let label = if problem.label.is_empty() { String::new() } else { format!(" {}", problem.label) };
    // Writing to a String cannot fail.
    let severity = if problem.is_warning() { "warning" } else { "error" };
    let _ = writeln!(out, "{severity}[{}]: {}", problem.code, printable(&problem.message));
    let _ = writeln!(out, "{gutter}--> {path}:{number}:{}", column + 1);
    let _ = writeln!(out, "{gutter} |");
    let _ = writeln!(out, "{number} | {shown}");
    let _ = writeln!(out, "{gutter} | {lead}{}{}", "^".repeat(carets), printable(&label));
    if !problem.help.is_empty() {
        let _ = writeln!(out, "{gutter} |");
        let _ = writeln!(out, "{gutter} = help: {}", printable(&problem.help));
    }
}

/// The part of a line to show, what stands under it before the carets, and their number.
fn window(line: &str, column: usize, covered: usize) -> (String, String, usize) {
    let characters: Vec<char> = line.chars().map(|c| if c.is_control() && c != '\t' { ' ' } else { c }).collect();
    let from = if characters.len() > WIDEST { column.saturating_sub(WIDEST / 2) } else { 0 };
    let to = characters.len().min(from + WIDEST);
    let shown: String = characters[from.min(to)..to].iter().collect();
    let blank = |c: &char| if *c == '\t' { '\t' } else { ' ' };
    let mut lead: String = characters[from.min(to)..column.clamp(from.min(to), to)].iter().map(blank).collect();
    let mut shown = shown.trim_end().to_owned();
    if from > 0 {
        (shown, lead) = (format!("…{shown}"), format!(" {lead}"));
    }
    if to < characters.len() {
        shown.push('…');
    }
    let room = to.saturating_sub(column).max(1);
    (shown, lead, covered.min(room))
}

/// Without control characters, which a hostile file could send to a terminal.
fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::{Place, catalogue::names};
    use crate::language::Span;

    #[test]
    fn line_column_caret_and_help() {
        let text = "name: A\ndefine:\n  α: \"[sin(thta), 1]\"\n";
        let place = Place::default().key("define").key("α").at(Span::new(5, 9));
        let problem = names::unknown_name(place, "thta", "did you mean `theta`?");
        let wanted = "\
error[E201]: unknown name `thta`
 --> models/a.yaml:3:12
  |
3 |   α: \"[sin(thta), 1]\"
  |            ^^^^ not declared
  |
  = help: did you mean `theta`?

1 error in models/a.yaml
";
        assert_eq!(render("models/a.yaml", text, &[problem]), wanted);
    }

    #[test]
    fn sorted_by_position_and_counted() {
        let text = "b: 1\na: 2\n";
        let problem = |key: &str| names::unknown_name(Place::default().key(key).of_key(), key, "");
        let shown = render("f", text, &[problem("a"), problem("b"), problem("a")]);
        assert!(shown.find("`b`").unwrap() < shown.find("`a`").unwrap(), "{shown}");
        assert!(shown.ends_with("\n2 errors in f\n"), "{shown}");
    }

    #[test]
    fn long_lines_are_cut() {
        let text = format!("a: {}x{}\n", "1+".repeat(500), "+1".repeat(500));
        let place = Place::default().key("a").at(Span::new(1000, 1001));
        let shown = render("f", &text, &[names::unknown_name(place, "x", "")]);
        let lines: Vec<&str> = shown.lines().collect();
        let caret = lines[4].chars().position(|c| c == '^').unwrap();
        assert_eq!(lines[3].chars().nth(caret), Some('x'), "{shown}");
        assert!(lines.iter().all(|line| line.chars().count() < 140), "{shown}");
    }
}
