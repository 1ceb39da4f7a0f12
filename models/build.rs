//! Lists the model files of this folder, so that a new one needs no other change; with the feature `compiled` each is compiled.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use dalembert_symbolic::print;

/// Models whose rows follow from each other, which is what they show: the warning that says so is meant.
const OVER_CONSTRAINED: [&str; 1] = ["bennett.yaml"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=.");
    let folder = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR")?);
    let mut files: Vec<String> = std::fs::read_dir(&folder)?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.ends_with(".yaml"))
        .collect();
    files.sort();
    let compiled = std::env::var_os("CARGO_FEATURE_COMPILED").is_some();
    let (mut modules, mut entries) = (String::new(), String::new());
    let mut taken = BTreeSet::new();
    for file in &files {
        let stem = file.trim_end_matches(".yaml");
        let path = format!("concat!(env!(\"CARGO_MANIFEST_DIR\"), {:?})", format!("/{file}"));
        let mut system = "None".to_owned();
        if compiled {
            let module = module(stem, &mut taken);
            let name = print::type_name(&print::name_in(&std::fs::read_to_string(folder.join(file))?));
            let words = format!("The model file `{file}`.");
            let meant = if OVER_CONSTRAINED.contains(&file.as_str()) { "#[allow(deprecated)]\n" } else { "" };
            writeln!(
                modules,
                "{meant}#[doc = {words:?}]\npub mod {module} {{\n    ::dalembert::model!({file:?}, name = {name}, methods = \"taylor as data\");\n}}"
            )?;
            system = format!(
                "Some(|| ::std::boxed::Box::new(::dalembert::mechanism::Dynamic::new(<self::{module}::{name} as ::std::default::Default>::default())))"
            );
        }
        writeln!(
            entries,
            "    ::dalembert::cli::Entry {{ name: {stem:?}, source: include_str!({path}), path: {path}, compiled: {system} }},"
        )?;
    }
    let text = format!(
        "{modules}\n/// Every model, by file name.\npub static MODELS: &[::dalembert::cli::Entry] = &[\n{entries}];\n"
    );
    std::fs::write(Path::new(&std::env::var("OUT_DIR")?).join("models.rs"), text)?;
    Ok(())
}

/// A module's name that no other file has: `a-b.yaml` and `a_b.yaml` are two.
fn module(stem: &str, taken: &mut BTreeSet<String>) -> String {
    let mut module = print::field_name(&stem.replace(|c: char| !c.is_alphanumeric(), "_"));
    while !taken.insert(module.clone()) {
        module = format!("{}_", module.trim_start_matches("r#"));
    }
    module
}
