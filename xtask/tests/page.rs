//! The page of `cargo xtask page` in a real browser, Debian's chromium without a window.
//!
//! The library is built for WebAssembly, which takes some minutes: `.ci/run` does it in a step of its own (`--ignored`).

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use dalembert::cli::{LoadError, Session};
use serde_json::Value;

/// The page, built once.
fn page() -> &'static str {
    static PAGE: OnceLock<String> = OnceLock::new();
    PAGE.get_or_init(|| {
        let folder = folder("page");
        let built = Command::new(env!("CARGO_BIN_EXE_xtask")).arg("page").arg("-o").arg(&folder).status().unwrap();
        assert!(built.success(), "{built}");
        let page = std::fs::read_to_string(folder.join("dalembert.html")).unwrap();
        std::fs::remove_dir_all(folder).unwrap();
        page
    })
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("dalembert-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// What a script finds on the page: its own `seen`, a list. It acts by `await after(() => …)`, which waits until the library has answered.
///
/// A document inside that is never finished keeps the browser waiting; it measures real time, for a worker computes in real time.
fn seen(name: &str, script: &str) -> Vec<Value> {
    let folder = folder(name);
    let script = format!(
        "<iframe id=waiting hidden></iframe><script>{{
        const waiting = document.getElementById('waiting').contentDocument, seen = [];
        waiting.open();
        const settled = async () => {{
          while (busy) await new Promise(later => setTimeout(later, 20));
          return {{state: told.state, end: JSON.parse(told.end ?? 'null'), problems: at('problems').textContent, failed: at('failed').textContent}};
        }};
        const after = act => {{ told.end = 'null'; act(); return settled(); }};
        const input = (field, value) => {{ field.value = value; field.dispatchEvent(new Event('input')); }};
        const change = (id, value) => {{ at(id).value = value; at(id).dispatchEvent(new Event('change')); }};
        const run = async () => {{ seen.push(await settled()); {script} }};
        const limit = new Promise((_, late) => setTimeout(() => late('it took too long: ' + told.state), 120000));
        Promise.race([run(), limit]).catch(problem => seen.push(String(problem))).finally(() => {{
          told.seen = JSON.stringify(seen);
          waiting.close();
        }});
        }}</script></html>"
    );
    std::fs::write(folder.join("page.html"), page().replace("</html>", &script)).unwrap();
    let seen = look(&folder);
    std::fs::remove_dir_all(folder).unwrap();
    seen
}

fn look(folder: &Path) -> Vec<Value> {
    let output = Command::new("chromium")
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
        .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
        .arg("--window-size=1400,1000")
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg("--dump-dom")
        .arg(format!("file://{}", folder.join("page.html").display()))
        .stderr(Stdio::null())
        .output()
        .expect("chromium is installed");
    let page = String::from_utf8(output.stdout).unwrap();
    let found = page.split_once("data-seen=\"").and_then(|(_, rest)| rest.split_once('"'));
    let text = found.unwrap_or_else(|| panic!("nothing was seen: {}", &page[..page.len().min(2000)])).0;
    let text = [("&quot;", "\""), ("&lt;", "<"), ("&gt;", ">"), ("&nbsp;", "\u{a0}"), ("&amp;", "&")]
        .iter()
        .fold(text.to_owned(), |text, (escaped, letter)| text.replace(escaped, letter));
    serde_json::from_str(&text).unwrap()
}

fn source(name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    std::fs::read_to_string(root.join(format!("models/{name}.yaml"))).unwrap()
}

/// The end of a motion that the library finds here.
fn end(name: &str, options: &[&str]) -> Vec<(String, f64)> {
    let session = Session::of_text(&[], (name, &source(name)), Vec::new()).unwrap();
    let options: Vec<String> = options.iter().map(|option| (*option).to_owned()).collect();
    let simulated = session.simulate(&options, &mut || std::ops::ControlFlow::Continue(())).unwrap();
    simulated.run.last().entries().map(|(name, value)| (name.to_string(), value)).collect()
}

/// The largest difference of a motion's end on the page from that here.
fn difference(seen: &Value, here: &[(String, f64)]) -> f64 {
    assert_eq!(seen["state"], "done", "{seen}");
    here.iter().map(|(name, value)| (seen["end"][name].as_f64().unwrap() - value).abs()).fold(0.0, f64::max)
}

#[test]
#[ignore = "builds the library for WebAssembly, some minutes"]
fn a_slider_moves_a_parameter_and_the_motion_is_that_of_the_library() {
    let slider = "const slider = name => [...document.querySelectorAll('#sliders label')]
          .find(label => label.firstChild.textContent === name).querySelector('input');
        const close = () => change('until', '3');
        seen.push(await after(close), await after(() => input(slider('m'), 1.7)), await after(() => input(slider('l'), 0.5)));";
    let seen = seen("sliders", slider);
    assert_eq!((seen[0]["state"].as_str(), seen[0]["problems"].as_str()), (Some("done"), Some("")), "{seen:?}");
    let [start, mass, length] = [&seen[1], &seen[2], &seen[3]];
    assert!(difference(start, &end("double_pendulum", &["--until=3"])) < 1e-9, "{start}");
    // The mass drops out of the equations; a length does not.
    assert!(difference(mass, &end("double_pendulum", &["--until=3"])) < 1e-9, "{mass}");
    assert!(difference(length, &end("double_pendulum", &["--until=3", "--set=l=0.5"])) < 1e-9, "{length}");
    assert!(difference(length, &end("double_pendulum", &["--until=3"])) > 0.1, "{length}");
}

#[test]
#[ignore = "builds the library for WebAssembly, some minutes"]
fn problems_of_a_file_are_those_that_the_program_prints() {
    let script = "const whole = at('text').value;
        seen.push(await after(() => { at('text').value = whole.replace('m*l^2/12', 'm*q^2/12'); refresh(); }));
        seen.push(await after(() => { at('text').value = ''; refresh(); }));
        seen.push(await after(() => { at('text').value = whole; refresh(); }));";
    let seen = seen("problems", script);
    let broken = source("double_pendulum").replace("m*l^2/12", "m*q^2/12");
    for (seen, text) in [(&seen[1], broken.as_str()), (&seen[2], "")] {
        let wrong = match Session::of_text(&[], ("double_pendulum", text), Vec::new()) {
            Err(LoadError::Wrong { text, .. }) => text,
            _ => panic!("it is wrong"),
        };
        assert_eq!((seen["state"].as_str(), seen["problems"].as_str()), (Some("wrong"), Some(wrong.as_str())));
        assert!(wrong.contains("double_pendulum.yaml:"), "{wrong}");
    }
    assert!(seen[1]["problems"].as_str().unwrap().contains('^'), "{seen:?}");
    assert_eq!((seen[3]["state"].as_str(), seen[3]["problems"].as_str()), (Some("done"), Some("")), "{seen:?}");
}

#[test]
#[ignore = "builds the library for WebAssembly, some minutes"]
fn a_motion_without_end_ends_and_can_be_stopped() {
    let script = "seen.push(await after(() => change('until', '1e5')));
        seen.push(await after(() => { change('until', '2e5'); setTimeout(() => at('stop').click(), 200); }));
        seen.push(await after(() => change('until', '1')));";
    let seen = seen("endless", script);
    assert_eq!(seen[1]["state"], "failed", "{seen:?}");
    assert!(seen[1]["failed"].as_str().unwrap().contains("steps"), "{seen:?}");
    assert!(!seen[1]["end"].is_null(), "what was computed is shown: {seen:?}");
    assert_eq!((seen[2]["state"].as_str(), seen[2]["end"].is_null()), (Some("wrong"), true), "{seen:?}");
    assert!(difference(&seen[3], &end("double_pendulum", &["--until=1"])) < 1e-9, "{seen:?}");
}

#[test]
#[ignore = "builds the library for WebAssembly, some minutes"]
fn every_model_of_the_menu_runs() {
    let script =
        "for (const name of Object.keys(files)) seen.push({name, ...await after(() => change('models', name))});";
    let seen = seen("menu", script);
    assert!(seen.len() > 12, "{seen:?}");
    for model in &seen {
        assert_eq!((model["state"].as_str(), model["failed"].as_str()), (Some("done"), Some("")), "{model}");
    }
}
