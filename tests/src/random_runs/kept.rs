//! Runs as files: what was found once is judged from then on, whatever is drawn later.

use super::file::Drawn;
use super::local::{Local, Of};
use super::shapes::Spot;

/// Where the comments begin that say how a file is judged.
const JUDGED: &str = "# Judged by steps that stay short against the distance of (variable, place, spacing, width):";
const CUT: &str = "# Cut in two at that part of its events: ";
const PLAIN: &str = "# Judged by the run of this file:";

/// A drawn run as a model file with comments that say how it is judged.
pub fn written(drawn: &Drawn) -> String {
    let mut lines = vec![drawn.text.trim_end().to_owned(), JUDGED.to_owned()];
    lines.extend(drawn.locals.iter().map(|Local { of, spot: Spot { place, every, width } }| {
        let of = match of {
            Of::Time => "t".to_owned(),
            Of::Coordinate(i) => format!("q {i}"),
            Of::Rate(i) => format!("v {i}"),
        };
        let every = every.map_or("-".to_owned(), |every| format!("{every:e}"));
        format!("# {of}, {place:e}, {every}, {width:e}")
    }));
    lines.extend(drawn.cut.map(|part| format!("{CUT}{part}")));
    if drawn.plain != drawn.text {
        lines.push(PLAIN.to_owned());
        lines.extend(drawn.plain.lines().map(|line| format!("# {line}")));
    }
    lines.join("\n") + "\n"
}

/// The run of such a file.
///
/// # Panics
/// If its comments are not as [`written`] writes them.
pub fn read(text: &str) -> Drawn {
    let (model, comments) = text.split_once(JUDGED).expect("how it is judged");
    let (comments, plain) = comments.split_once(PLAIN).unwrap_or((comments, ""));
    let uncommented = |line: &str| line.strip_prefix("# ").unwrap_or(line).to_owned();
    let plain: Vec<String> = plain.trim_start().lines().map(uncommented).collect();
    let cut = comments.lines().find_map(|line| line.strip_prefix(CUT)).map(number);
    let spots = comments.trim().lines().filter(|line| !line.starts_with(CUT));
    let model = model.trim_end().to_owned() + "\n";
    Drawn {
        plain: if plain.is_empty() { model.clone() } else { plain.join("\n") + "\n" },
        text: model,
        mechanism: "kept",
        features: Vec::new(),
        event: None,
        locals: spots.map(local).collect(),
        cut,
    }
}

fn local(line: &str) -> Local {
    let parts: Vec<&str> = line.trim_start_matches("# ").split(", ").collect();
    let [of, place, every, width] = parts.as_slice() else { panic!("`{line}`") };
    let of = match of.split_once(' ') {
        None => Of::Time,
        Some(("q", index)) => Of::Coordinate(index.parse().expect("an index")),
        Some((_, index)) => Of::Rate(index.parse().expect("an index")),
    };
    let every = (*every != "-").then(|| number(every));
    Local { of, spot: Spot { place: number(place), every, width: number(width) } }
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| panic!("`{text}` is no number"))
}
