//! The library as one page for a browser: built for WebAssembly, packed, and written into the page with the models that its menu offers.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Map, Value};

/// Models of the menu, the first one being shown.
const MODELS: [&str; 12] = [
    "double_pendulum",
    "simple_pendulum",
    "cart_pendulum",
    "slider_crank",
    "three_masses",
    "hanging_spring",
    "bouncing_ball",
    "stick_slip",
    "rolling_disc",
    "heavy_top",
    "two_body",
    "whipple_bicycle",
];
const TARGET: &str = "wasm32-unknown-unknown";
/// Deriving goes as deep as a main thread of a usual system lets it, bytes.
const STACK: u32 = 8 << 20;

/// Builds the page and writes it as `dalembert.html` to a folder.
///
/// # Errors
/// A build that fails, files that cannot be read or written.
pub fn build(folder: &str) -> Result<String, String> {
    let root = &crate::root();
    let library = fs::read(library(root)?).map_err(|error| format!("the library: {error}"))?;
    let packed = miniz_oxide::deflate::compress_to_vec_zlib(&library, 9);
    let mut files = Map::new();
    for name in MODELS {
        files.insert(name.to_owned(), Value::from(read(&root.join(format!("models/{name}.yaml")))?));
    }
    let web = |name: &str| read(&root.join("page/web").join(name));
    // In a script element `<` could end the element; JSON may write it as an escape.
    let page = web("page.html")?
        .replace("@WORKER@", &web("worker.js")?)
        .replace("@SCRIPT@", &web("page.js")?)
        .replace("@FILES@", &Value::Object(files).to_string().replace('<', "\\u003c"))
        .replace("@LIBRARY@", &base64(&packed));
    let path = Path::new(folder).join("dalembert.html");
    fs::create_dir_all(folder).map_err(|error| format!("{folder}: {error}"))?;
    fs::write(&path, &page).map_err(|error| format!("{}: {error}", path.display()))?;
    let megabytes = |bytes: usize| bytes as f64 / 1e6;
    let (whole, small, page) = (megabytes(library.len()), megabytes(packed.len()), megabytes(page.len()));
    Ok(format!("{}: {page:.1} MB; the library has {whole:.1} MB, packed {small:.1} MB", path.display()))
}

/// Builds the library for WebAssembly, and tells where it is.
fn library(root: &Path) -> Result<PathBuf, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .current_dir(root)
        .args(["rustc", "--package", "dalembert-page", "--lib", "--profile", "page", "--target", TARGET])
        .args(["--", "-C", &format!("link-arg=-zstack-size={STACK}")])
        .status()
        .map_err(|error| format!("cargo: {error}"))?;
    if !status.success() {
        return Err(format!("cargo: {status}; `rustup target add {TARGET}` brings what Rust needs for WebAssembly"));
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder));
    Ok(target.join(TARGET).join("page/dalembert_page.wasm"))
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

/// Bytes as text, six bits a letter.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let at = |place: usize| u32::from(three.get(place).copied().unwrap_or(0));
        let bits = at(0) << 16 | at(1) << 8 | at(2);
        for place in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * place) & 63) as usize];
            text.push(if place > three.len() { '=' } else { char::from(letter) });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_become_letters() {
        // RFC 4648, section 10.
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg==")] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[0xfb, 0xff, 0xfe]), "+//+");
    }
}
