//! `cargo xtask man`: a man page of the program, and one of each of its commands.

use std::fs;

/// Writes them to a folder.
///
/// # Errors
/// Files that cannot be written.
pub fn write(folder: &str) -> Result<String, String> {
    let unwritten = |problem: std::io::Error| format!("cannot write to {folder}: {problem}");
    fs::create_dir_all(folder).map_err(unwritten)?;
    clap_mangen::generate_to(dalembert::cli::command_line(), folder).map_err(unwritten)?;
    Ok(format!(
        "wrote dalembert.1 and a page of each command to {folder}; `man -l {folder}/dalembert.1` shows the first"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page_with_its_options() {
        let folder = std::env::temp_dir().join(format!("dalembert-man-{}", std::process::id()));
        let told = write(folder.to_str().expect("a path")).expect("pages");
        assert!(told.contains("dalembert.1"), "{told}");
        let page = |name: &str| fs::read_to_string(folder.join(name)).expect("a page");
        let all = page("dalembert.1");
        for command in dalembert::cli::command_line().get_subcommands().filter(|command| !command.is_hide_set()) {
            let name = format!("dalembert-{}", command.get_name());
            let escaped = name.replace('-', "\\-");
            assert!(all.contains(&escaped) && page(&format!("{name}.1")).contains(&escaped), "{name}");
        }
        assert!(page("dalembert-export.1").contains("\\-\\-fmi"));
        fs::remove_dir_all(folder).expect("a folder");
    }
}
