//! Commands of the pages, run: what they print is what the pages show.

use std::path::{Path, PathBuf};

use dalembert_symbolic::lower::compile;

use super::page::{Block, blocks, root};

/// With this variable set animations are drawn too, and all pictures of the book are written anew.
pub const WRITE_PICTURES: &str = "DALEMBERT_BOOK_PICTURES";

/// Endings of files that a command reads from its page's folder, or writes there.
const FILES: [&str; 10] = [".yaml", ".csv", ".svg", ".gif", ".html", ".json", ".rs", ".fmu", ".npz", ".mat"];

/// How every command begins.
const PROGRAM: &str = "cargo run --release -- ";

/// What the commands of a page were.
pub struct Outcome {
    pub commands: usize,
    /// Pictures that they write, by their names.
    pub pictures: Vec<String>,
    pub folder: PathBuf,
}

impl Drop for Outcome {
    fn drop(&mut self) {
        // The folder of a page that failed stays, to be looked at.
        if !std::thread::panicking() {
            let _ = std::fs::remove_dir_all(&self.folder);
        }
    }
}

/// Words of a command line, with double quotes.
fn words(command: &str) -> Vec<String> {
    let parts = command.split('"').enumerate();
    let mut words: Vec<String> = Vec::new();
    for (k, part) in parts {
        match k % 2 {
            0 => words.extend(part.split_whitespace().map(str::to_owned)),
            _ => words.push(part.to_owned()),
        }
    }
    words
}

/// The arguments of a command: files are those of the page's folder, tables too; animations are left out, unless pictures are written
/// anew.
fn arguments(command: &str, folder: &Path) -> Vec<String> {
    let mut words = words(command);
    if std::env::var_os(WRITE_PICTURES).is_none()
        && let Some(k) = words.iter().position(|word| word == "--animate")
    {
        words.drain(k..k + 2);
    }
    // The tables and charts that these write beside the caller, unless they are told where.
    let table = if words[0] == "sweep" { "sweep" } else { "chart" };
    if matches!(words[0].as_str(), "sweep" | "chart") && !words.iter().any(|word| word == "-o") {
        let name = words[1].trim_end_matches(".yaml");
        words.extend(["-o".to_owned(), format!("{name}-{table}.csv")]);
    }
    if words[0] == "chart" && !words.iter().any(|word| word == "--plot") {
        words.extend(["--plot", "chart.svg"].map(str::to_owned));
    }
    let is_file = |word: &str| FILES.iter().any(|ending| word.ends_with(ending));
    let placed = words.into_iter().map(|word| match is_file(&word) {
        true => folder.join(word).to_string_lossy().into_owned(),
        false => word,
    });
    std::iter::once("dalembert".to_owned()).chain(placed).collect()
}

/// What a command prints, errors included, with files by their names alone.
fn printed(command: &str, folder: &Path) -> String {
    let mut out = Vec::new();
    let ended = dalembert::cli::run(dalembert_models::MODELS, arguments(command, folder), &mut out);
    let text = String::from_utf8(out).expect("text");
    let text = ended.map_or_else(|problem| format!("{text}{problem}\n"), |()| text.clone());
    text.replace(&format!("{}/", folder.display()), "")
}

/// A model with the lines of a `diff` block exchanged.
fn changed(model: &str, diff: &str) -> String {
    let mut model = model.to_owned();
    let mut lines = diff.lines().peekable();
    while lines.peek().is_some() {
        let mut side = |sign: char| -> String {
            let mut text = String::new();
            while let Some(line) = lines.next_if(|line| line.starts_with(sign)) {
                text += &line[1..];
                text.push('\n');
            }
            text
        };
        let (old, new) = (side('-'), side('+'));
        assert!(!old.is_empty(), "lines of a change begin with - or +, first what goes:\n{diff}");
        assert!(model.contains(&old), "`{old}` is not in\n{model}");
        model = model.replacen(&old, &new, 1);
    }
    model
}

/// Writes the model of a block: `yaml` is a whole file, which compiles without a warning; `diff` is a change of the last one.
fn model_of(block: &Block<'_>, last: &str) -> Option<String> {
    match block.kind {
        "yaml" => {
            let program = compile(block.text, &[]).unwrap_or_else(|problems| panic!("{}\n{problems:?}", block.text));
            assert!(program.model.warnings.is_empty(), "{}\n{:?}", block.text, program.model.warnings);
            Some(block.text.to_owned())
        }
        "diff" => Some(changed(last, block.text)),
        _ => None,
    }
}

/// Runs every command of a page, and looks for what it shows, lines in order; ` ...` stands for what is left out of a line, `...` alone for lines.  A model is the file that the next command with one names.
pub fn run_page(path: &Path, text: &str) -> Outcome {
    let name = path.strip_prefix(root()).unwrap_or(path).display().to_string().replace('/', "-");
    let folder = std::env::temp_dir().join(format!("dalembert-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let mut outcome = Outcome { commands: 0, pictures: Vec::new(), folder };
    let blocks = blocks(text);
    let (mut model, mut written) = (String::new(), true);
    for (k, block) in blocks.iter().enumerate() {
        if let Some(text) = model_of(block, &model) {
            (model, written) = (text, false);
        }
        for command in block.text.lines().filter_map(|line| line.strip_prefix(PROGRAM)) {
            outcome.commands += 1;
            outcome.pictures.extend(words(command).into_iter().filter(|w| w.ends_with(".svg") || w.ends_with(".gif")));
            if let Some(file) = command.split_whitespace().find(|word| word.ends_with(".yaml"))
                && !std::mem::replace(&mut written, true)
            {
                std::fs::write(outcome.folder.join(file), &model).expect("a file");
            }
            let printed = printed(command, &outcome.folder);
            let shown = blocks.get(k + 1).filter(|next| next.before.trim().is_empty()).map_or("", |next| next.text);
            let mut lines = printed.lines();
            for shown in shown.lines().filter(|line| *line != "...") {
                let found = match shown.split_once(" ...") {
                    Some((head, tail)) => lines.any(|line| line.starts_with(head) && line.ends_with(tail)),
                    None => lines.any(|line| line == shown),
                };
                assert!(found, "{}: {command}\n`{shown}` is not printed:\n{printed}", path.display());
            }
        }
    }
    outcome
}

/// The same for one page of the workspace: how many commands there are.
fn commands_print_what_they_show(page: &str) -> usize {
    let path = root().join(page);
    let text = std::fs::read_to_string(&path).expect("the page");
    run_page(&path, &text).commands
}

#[test]
fn every_command_of_the_page_on_space_prints_what_it_shows() {
    assert_eq!(commands_print_what_they_show("docs/space.md"), 10);
}

#[test]
fn every_command_of_the_page_on_orbits_prints_what_it_shows() {
    assert_eq!(commands_print_what_they_show("docs/orbits.md"), 10);
}

#[test]
fn every_command_of_the_page_on_bridges_prints_what_it_shows() {
    assert_eq!(commands_print_what_they_show("docs/bridges.md"), 4);
}
