//! Lists the model files of this folder, so that a new one is compiled without any other change.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use dalembert_symbolic::print;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=.");
    let folder = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR")?);
    let mut files: Vec<String> = std::fs::read_dir(&folder)?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.ends_with(".yaml"))
        .collect();
    files.sort();
    let (mut modules, mut entries) = (String::new(), String::new());
    for file in &files {
        let stem = file.trim_end_matches(".yaml");
        let module = print::field_name(stem);
        let name = print::type_name(&print::name_in(&std::fs::read_to_string(folder.join(file))?));
        writeln!(
            modules,
            "#[doc = \"The model file `{file}`.\"]\npub mod {module} {{\n    dalembert::model!({file:?}, name = {name});\n}}"
        )?;
        writeln!(
            entries,
            "    Entry {{ name: {stem:?}, source: include_str!(concat!(env!(\"CARGO_MANIFEST_DIR\"), \"/{file}\")), path: concat!(env!(\"CARGO_MANIFEST_DIR\"), \"/{file}\"), system: || Box::new(Erased::new({module}::{name}::default())) }},"
        )?;
    }
    let text = format!("{modules}\n/// Every model, by file name.\npub static MODELS: &[Entry] = &[\n{entries}];\n");
    std::fs::write(Path::new(&std::env::var("OUT_DIR")?).join("models.rs"), text)?;
    Ok(())
}
