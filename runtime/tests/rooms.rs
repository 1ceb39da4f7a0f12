//! The folders of `runtime/src` import one way: what stands lower in ARCHITECTURE.md's list of rooms imports nothing
//! from what stands above it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The rooms in ARCHITECTURE.md, from the ground up.
fn order() -> Vec<String> {
    let text = read(&root().join("../ARCHITECTURE.md"));
    let line = text.lines().find(|line| line.starts_with("Rooms of `runtime/src`, from the ground up: "));
    let line = line.expect("ARCHITECTURE.md lists the rooms of `runtime/src` on one line");
    line.split('`').skip(3).step_by(2).map(str::to_owned).collect()
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// All Rust files of a folder, without those that hold only tests.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            found.extend(files(&path));
        } else if name.ends_with(".rs") && !name.ends_with("tests.rs") && name != "testing.rs" {
            found.push(path);
        }
    }
    found
}

/// The room of a file: the first part of its path below `src`.
fn room(path: &Path) -> String {
    let below = path.strip_prefix(root().join("src")).expect("a file below src");
    let first = below.components().next().expect("a name").as_os_str().to_string_lossy().into_owned();
    first.trim_end_matches(".rs").to_owned()
}

/// Code without comments, strings and what only tests compile.
fn code(text: &str) -> String {
    let mut code = String::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        let line = line.split("//").next().unwrap_or("");
        if line.trim_start().starts_with("#[cfg(test)]") || line.trim_start().starts_with("#[cfg(all(test") {
            // The item that follows: to the end of its braces, or to its semicolon.
            let mut depth = 0_i32;
            for line in lines.by_ref() {
                depth += line.matches('{').count() as i32 - line.matches('}').count() as i32;
                if depth <= 0 && (line.contains('}') || line.trim_end().ends_with(';')) {
                    break;
                }
            }
            continue;
        }
        code.push_str(line);
        code.push('\n');
    }
    code
}

/// Rooms, or names at the root of the crate, that follow `crate::` in a file.
fn imports(code: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (place, _) in code.match_indices("crate::") {
        if code[..place].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == '$') {
            continue;
        }
        let rest = &code[place + "crate::".len()..];
        match rest.strip_prefix('{') {
            Some(list) => {
                let end = closing(list);
                for part in parts(&list[..end]) {
                    found.insert(first_name(part));
                }
            }
            None => {
                found.insert(first_name(rest));
            }
        }
    }
    found
}

fn first_name(path: &str) -> String {
    path.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// Where the brace that is open closes.
fn closing(list: &str) -> usize {
    let mut depth = 1;
    for (place, c) in list.char_indices() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if depth == 0 {
            return place;
        }
    }
    list.len()
}

/// The parts between the outermost commas.
fn parts(list: &str) -> Vec<&str> {
    let (mut parts, mut depth, mut start) = (Vec::new(), 0, 0);
    for (place, c) in list.char_indices() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if c == ',' && depth == 0 {
            parts.push(&list[start..place]);
            start = place + 1;
        }
    }
    parts.push(&list[start..]);
    parts.into_iter().filter(|part| !part.trim().is_empty()).collect()
}

/// The room from which `lib.rs` re-exports a name.
fn reexported(name: &str, lib: &str) -> Option<String> {
    lib.split("pub use ").skip(1).find_map(|statement| {
        let statement = statement.split(';').next()?;
        let (room, names) = statement.split_once("::")?;
        let listed = names.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|known| known == name);
        listed.then(|| room.to_owned())
    })
}

/// Files that import from a room above their own, or from none.
fn against(order: &[String]) -> Vec<String> {
    let lib = code(&read(&root().join("src/lib.rs")));
    let height = |room: &str| order.iter().position(|known| known == room);
    let mut wrong = Vec::new();
    for file in files(&root().join("src")) {
        let own = room(&file);
        if own == "lib" {
            continue;
        }
        let Some(here) = height(&own) else {
            wrong.push(format!("`{own}` is not among the rooms"));
            continue;
        };
        for name in imports(&code(&read(&file))) {
            let target = if height(&name).is_some() { Some(name.clone()) } else { reexported(&name, &lib) };
            match target.as_deref().and_then(height) {
                Some(there) if there <= here => (),
                Some(_) => wrong.push(format!("{} imports `{name}` from above", file.display())),
                None => wrong.push(format!("{} imports `{name}`, which is in no room", file.display())),
            }
        }
    }
    wrong
}

#[test]
fn rooms_import_only_from_below() {
    let order = order();
    assert!(order.len() > 10, "{order:?}");
    let wrong = against(&order);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    for room in &order {
        let place = root().join("src").join(room);
        assert!(place.is_dir() || place.with_extension("rs").is_file(), "there is no room `{room}`");
    }
}

#[test]
fn an_import_from_above_is_seen() {
    // Turned round, the order is wrong for nearly every file.
    let mut turned = order();
    turned.reverse();
    assert!(against(&turned).len() > 50);
    let text = "use crate::{Error, run::{Run, State}, show};\n// crate::cli\n#[cfg(test)]\nmod tests {\n    use crate::testing::Toy;\n}\nfn f() -> crate::cause::Cause {}\n";
    let found: Vec<String> = imports(&code(text)).into_iter().collect();
    assert_eq!(found, ["Error", "cause", "run", "show"]);
}
