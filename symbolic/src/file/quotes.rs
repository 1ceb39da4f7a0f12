//! Primes that YAML folds: in single quotes `x''` is read as `x'`.

use super::spans::{Outline, Shape, Style, spans};
use crate::diagnose::{Place, Problem, catalogue::yaml};

/// Keys of the outermost mapping whose values are prose, in which an apostrophe is an apostrophe.
const PROSE: [&str; 2] = ["about", "name"];

/// Scalars in single quotes with `''` after a name or a bracket, whatever was meant by it.
pub(super) fn folded_primes(text: &str) -> Vec<Problem> {
    let mut problems = Vec::new();
    let Some(Outline { shape: Shape::Map(entries), .. }) = spans(text).0 else { return problems };
    for (key, value) in &entries {
        look(text, key, &mut problems);
        let prose = matches!(&key.shape, Shape::Scalar(name, _) if PROSE.contains(&name.as_str()));
        if !prose {
            look(text, value, &mut problems);
        }
    }
    problems
}

fn look(text: &str, node: &Outline, problems: &mut Vec<Problem>) {
    match &node.shape {
        Shape::Scalar(value, Style::Single) => {
            let written = text[node.range.clone()].trim_start_matches('\'');
            let written = written.strip_suffix('\'').unwrap_or(written);
            if let Some(at) = after_a_name(written) {
                let start = node.range.end.saturating_sub(written.len() + 1) + at;
                problems.push(yaml::folded_prime(Place::in_file(start, start + 2), written.trim(), value.trim()));
            }
        }
        Shape::Scalar(..) => {}
        Shape::List(items) => items.iter().for_each(|item| look(text, item, problems)),
        Shape::Map(entries) => entries.iter().for_each(|(key, value)| {
            look(text, key, problems);
            look(text, value, problems);
        }),
    }
}

/// Where `''` stands right after what may have a prime.
fn after_a_name(written: &str) -> Option<usize> {
    written
        .match_indices("''")
        .map(|(at, _)| at)
        .find(|&at| written[..at].ends_with(|c: char| c == '_' || c == ']' || unicode_ident::is_xid_continue(c)))
}
