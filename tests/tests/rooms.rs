//! The folders of a crate use only folders that stand before them: no path from a lower one to a higher one, and so no
//! circle.  The order is the one that ARCHITECTURE.md states.

use std::path::{Path, PathBuf};

use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;

/// The rooms of a crate in the order of ARCHITECTURE.md, from the bottom up.
fn order(sources: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let start = format!("- `{sources}`: ");
    let line =
        text.lines().find_map(|line| line.strip_prefix(&start)).unwrap_or_else(|| panic!("no order for {sources}"));
    line.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All Rust files under a folder.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// The modules above a file, `["gate", "balances"]` for `gate/balances.rs`.
fn module(folder: &Path, file: &Path) -> Vec<String> {
    let inside = file.strip_prefix(folder).unwrap().with_extension("");
    let mut names: Vec<String> = inside.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
    if names.last().is_some_and(|last| last == "mod" || last == "lib") {
        names.pop();
    }
    names
}

/// Whether an item is compiled for tests only.
fn for_tests(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|a| a.path().is_ident("cfg") && a.to_token_stream().to_string().contains("test"))
}

fn attributes(item: &syn::Item) -> &[syn::Attribute] {
    match item {
        syn::Item::Mod(item) => &item.attrs,
        syn::Item::Use(item) => &item.attrs,
        syn::Item::Fn(item) => &item.attrs,
        syn::Item::Impl(item) => &item.attrs,
        _ => &[],
    }
}

/// The first rooms of all paths that begin with `crate` or climb to it by `super`, groups and macros included.
fn used(tokens: TokenStream, here: &[String], found: &mut Vec<String>) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let word = |k: usize| match tokens.get(k) {
        Some(TokenTree::Ident(ident)) => ident.to_string(),
        _ => String::new(),
    };
    let colons = |k: usize| {
        let colon = |k: usize| matches!(tokens.get(k), Some(TokenTree::Punct(p)) if p.as_char() == ':');
        colon(k) && colon(k + 1)
    };
    let mut k = 0;
    while k < tokens.len() {
        if let TokenTree::Group(group) = &tokens[k] {
            // An inline module is one step deeper; its own `super` reaches this one.
            let inline = k >= 2 && word(k - 2) == "mod";
            let deeper = [here, &[word(k.wrapping_sub(1))]].concat();
            used(group.stream(), if inline { &deeper } else { here }, found);
        }
        let mut above = match word(k).as_str() {
            "crate" => Some(Vec::new()),
            "super" if k < 3 || word(k.wrapping_sub(3)) != "super" => {
                Some(here[..here.len().saturating_sub(1)].to_vec())
            }
            _ => None,
        };
        let mut at = k + 1;
        while let Some(path) = &mut above
            && colons(at)
            && word(at + 2) == "super"
        {
            path.pop();
            at += 3;
        }
        if let Some(path) = above
            && colons(at)
        {
            match (path.first(), tokens.get(at + 2)) {
                (Some(room), _) => found.push(room.clone()),
                (None, Some(TokenTree::Ident(ident))) => found.push(ident.to_string()),
                (None, Some(TokenTree::Group(group))) => found.extend(heads(group.stream())),
                _ => {}
            }
        }
        k += 1;
    }
}

/// `a` and `b` of `{a::x, b}`.
fn heads(group: TokenStream) -> Vec<String> {
    let mut found = Vec::new();
    let mut first = true;
    for token in group {
        match token {
            TokenTree::Ident(ident) if first => found.push(ident.to_string()),
            TokenTree::Punct(p) if p.as_char() == ',' => {
                first = true;
                continue;
            }
            _ => {}
        }
        first = false;
    }
    found
}

/// The modules that a file declares for tests only.
fn modules_of_tests(here: &[String], file: &syn::File) -> Vec<Vec<String>> {
    let declared = file.items.iter().filter_map(|item| match item {
        syn::Item::Mod(module) if for_tests(&module.attrs) => Some(module.ident.to_string()),
        _ => None,
    });
    declared.map(|name| [here, &[name]].concat()).collect()
}

/// Paths that climb, as `room/file uses room`.
fn climbing(sources: &str) -> Vec<String> {
    let folder = root().join(sources);
    let order = order(sources);
    let place = |room: &str| order.iter().position(|r| r == room);
    let mut found = Vec::new();
    files(&folder, &mut found);
    found.sort();
    let parsed: Vec<(Vec<String>, syn::File)> = found
        .iter()
        .map(|file| (module(&folder, file), syn::parse_file(&std::fs::read_to_string(file).unwrap()).unwrap()))
        .collect();
    let tests: Vec<Vec<String>> = parsed.iter().flat_map(|(here, file)| modules_of_tests(here, file)).collect();
    let mut wrong = Vec::new();
    for (here, parsed) in parsed {
        let Some(room) = here.first() else { continue };
        if tests.iter().any(|module| here.starts_with(module)) {
            continue;
        }
        let own = place(room).unwrap_or_else(|| panic!("{room} has no place in ARCHITECTURE.md"));
        let mut rooms = Vec::new();
        for item in parsed.items.iter().filter(|item| !for_tests(attributes(item))) {
            used(item.to_token_stream(), &here, &mut rooms);
        }
        rooms.sort();
        rooms.dedup();
        wrong.extend(
            rooms
                .iter()
                .filter(|used| place(used).is_some_and(|p| p > own))
                .map(|used| format!("{} uses {used}", here.join("/"))),
        );
    }
    wrong
}

#[test]
fn no_folder_of_symbolic_uses_a_higher_one() {
    assert_eq!(climbing("symbolic/src"), Vec::<String>::new());
}

#[test]
fn no_folder_of_runtime_uses_a_higher_one() {
    assert_eq!(climbing("runtime/src"), Vec::<String>::new());
}

#[test]
fn the_reader_of_paths_sees_them_all() {
    let seen = |text: &str| {
        let mut found = Vec::new();
        used(text.parse().unwrap(), &["gate".to_owned(), "claims".to_owned()], &mut found);
        found
    };
    assert_eq!(seen("use crate::print::text;"), ["print"]);
    assert_eq!(seen("use crate::{expr::Id, print};"), ["expr", "print"]);
    assert_eq!(seen("fn f() { let x = crate::lower::compile(); }"), ["lower"]);
    assert_eq!(seen("fn f() { println!(\"{}\", crate::lower::x()); }"), ["lower"]);
    assert_eq!(seen("use super::state::State;"), ["gate"]);
    assert_eq!(seen("use super::super::print::text;"), ["print"]);
    assert_eq!(seen("mod inner { use super::super::super::lower::x; }"), ["lower"]);
    assert_eq!(seen("use serde::Serialize;"), Vec::<String>::new());
}
