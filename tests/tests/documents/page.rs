//! A page of the documents, taken apart.

use std::path::{Path, PathBuf};

/// The workspace's folder.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace's folder")
}

/// The pages of a folder of the workspace, in order of their names, with their text.
pub fn pages(folder: &str) -> Vec<(PathBuf, String)> {
    let entries = std::fs::read_dir(root().join(folder)).expect("a folder of documents");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    paths.sort();
    let read = |path: PathBuf| (std::fs::read_to_string(&path).expect("a page"), path);
    paths.into_iter().map(read).map(|(text, path)| (path, text)).collect()
}

/// A page's fenced blocks: what stands before each, what follows the fence, and the text.
pub fn blocks(page: &str) -> Vec<Block<'_>> {
    let parts: Vec<&str> = page.split("```").collect();
    let fenced = parts.chunks(2).filter_map(|pair| Some((pair[0], *pair.get(1)?)));
    fenced
        .filter_map(|(before, block)| block.split_once('\n').map(|(kind, text)| Block { before, kind, text }))
        .collect()
}

/// One fenced block.
pub struct Block<'a> {
    pub before: &'a str,
    pub kind: &'a str,
    pub text: &'a str,
}

/// A page without its fenced blocks and without code in lines.
pub fn prose(page: &str) -> String {
    let outside: String = page.split("```").step_by(2).collect();
    outside.split('`').step_by(2).collect()
}

/// The anchors of a page's headings, as GitHub and mdBook name them.
pub fn anchors(page: &str) -> Vec<String> {
    let outside: String = page.split("```").step_by(2).collect();
    let mut anchors: Vec<String> = Vec::new();
    for heading in outside.lines().filter(|line| line.starts_with('#')) {
        let title = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = title.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        let anchor: String = kept.map(|c| if c == ' ' { '-' } else { c }).collect();
        let before = anchors.iter().filter(|other| **other == anchor).count();
        anchors.push(if before == 0 { anchor } else { format!("{anchor}-{before}") });
    }
    anchors
}

/// Where the links and pictures of a page lead.
pub fn targets(page: &str) -> Vec<String> {
    let prose = prose(page);
    prose.split("](").skip(1).filter_map(|rest| rest.split(')').next()).map(str::to_owned).collect()
}
