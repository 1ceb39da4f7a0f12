//! `simulate --animate` and `modes --animate`: curves beside a page, pictures that move.
#![cfg(all(feature = "cli", feature = "png"))]

use serde_json::Value;
use std::path::PathBuf;

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let folder = std::env::temp_dir().join(format!("dalembert-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        Folder(folder)
    }

    fn file(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    fn charts(&self, name: &str) -> Vec<Value> {
        let page = std::fs::read_to_string(self.0.join(name)).unwrap();
        let data = page.split("application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
        let data: Value = serde_json::from_str(data).unwrap();
        data["charts"].as_array().unwrap().clone()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).unwrap();
    }
}

/// What the program prints for a model of the library, or its complaint.
fn told(command: &str, model: &str, options: &[&str]) -> Result<String, String> {
    let path = format!("{}/../models/{model}.yaml", env!("CARGO_MANIFEST_DIR"));
    let arguments = [&["dalembert", command, &path], options].concat();
    let mut out = Vec::new();
    match dalembert::cli::run(&[], arguments, &mut out) {
        Ok(()) => Ok(String::from_utf8(out).unwrap()),
        Err(problem) => Err(problem.to_string()),
    }
}

fn simulate(options: &[&str]) -> Result<String, String> {
    told("simulate", "simple_pendulum", &[&["--no-digits", "--until", "2"], options].concat())
}

#[test]
fn a_page_has_the_named_curves_beside_the_mechanism() {
    let folder = Folder::new("beside_page");
    let (page, figure) = (folder.file("page.html"), folder.file("figure.svg"));
    simulate(&["--animate", &page]).unwrap();
    assert!(folder.charts("page.html").is_empty());
    simulate(&["--animate", &page, "--plot", &figure, "--show", "theta", "--show", "theta:theta'"]).unwrap();
    let charts = folder.charts("page.html");
    let axes: Vec<[&str; 2]> =
        charts.iter().map(|chart| ["x", "y"].map(|k| chart[k]["text"].as_str().unwrap())).collect();
    assert_eq!(axes, [["time (s)", "theta (rad)"], ["theta (rad)", "theta' (rad/s)"]]);
    let names: Vec<&Value> = charts.iter().flat_map(|c| c["series"].as_array().unwrap()).map(|s| &s["name"]).collect();
    assert_eq!(names, ["theta", ""]);
    // A marker goes along the portrait by the times of its points.
    let times = &charts[1]["series"][0]["t"];
    let last = times["values"].as_array().unwrap().last().unwrap().as_f64().unwrap() * times["unit"].as_f64().unwrap();
    assert!((last - 2.0).abs() < 1e-6, "{last}");
}

#[test]
fn names_are_looked_up_before_the_run() {
    let folder = Folder::new("beside_names");
    let page = folder.file("page.html");
    let refused = simulate(&["--animate", &page, "--show", "thta"]).unwrap_err();
    assert!(refused.contains("no coordinate, rate or output is called `thta`; did you mean `theta`?"), "{refused}");
    let refused = simulate(&["--show", "theta"]).unwrap_err();
    assert!(refused.contains("--plot") && refused.contains("--animate"), "{refused}");
    let refused = simulate(&["--animate", &folder.file("film.gif"), "--show", "theta"]).unwrap_err();
    assert_eq!(refused, "error: --show draws beside a page: `--animate FILE.html`");
    assert!(!std::fs::exists(page).unwrap());
}

#[test]
fn an_ending_makes_a_picture_that_moves() {
    let folder = Folder::new("moving_picture");
    let path = folder.file("film.gif");
    let text = simulate(&["--animate", &path]).unwrap();
    assert!(text.starts_with(&format!("{path}: 51 frames, 25 a second, as fast as the motion\n")), "{text}");
    assert!(std::fs::read(&path).unwrap().starts_with(b"GIF89a"));
    let path = folder.file("film.png");
    serde_json::from_str::<Value>(&simulate(&["--animate", &path, "--json"]).unwrap()).unwrap();
    let file = std::fs::read(&path).unwrap();
    assert!(file.starts_with(b"\x89PNG") && file.windows(4).any(|name| name == b"acTL"));
}

/// Of a mode too: 4.4429 s in one period, at five times its speed; a page plays as its reader likes.
#[test]
fn a_mode_that_moves_says_how_fast() {
    let folder = Folder::new("moving_mode");
    for name in ["film.gif", "film.png"] {
        let path = folder.file(name);
        let text = told("modes", "three_masses", &["--animate", &path, "--mode", "2"]).unwrap();
        let how = format!("{path}: mode 2, 22 frames, 25 a second, 5 times as fast as the motion\n");
        assert!(text.contains(&how), "{text}");
        let json = told("modes", "three_masses", &["--animate", &path, "--json"]).unwrap();
        serde_json::from_str::<Value>(&json).unwrap();
    }
    let text = told("modes", "three_masses", &["--animate", &folder.file("page.html")]).unwrap();
    assert!(!text.contains("frames"), "{text}");
}

/// Why a file cannot be written is told as the operating system tells it.
#[test]
fn an_error_of_a_file_has_its_source() {
    use std::error::Error as _;
    let text = "{name: Falls, parameters: {m: 1 kg}, coordinates: {x: m}, bodies: {b: {mass: m, position: '[x, 0]'}}, scene: {until: 1}}";
    let program = dalembert_symbolic::lower::compile_in(None, text, &[]).unwrap();
    let mut system = dalembert::mechanism::Interpreted::new(program, text);
    let settings = dalembert::Settings::of_scene(&system, 0);
    let run = dalembert::simulate(&mut system, &settings).unwrap();
    let folder = Folder::new("source");
    let error = run.animation().write(folder.file("none/page.html")).unwrap_err();
    let source = error.source().and_then(|source| source.downcast_ref::<std::io::Error>()).unwrap();
    assert_eq!(source.kind(), std::io::ErrorKind::NotFound);
    let unknown = run.history(&["nope"]).unwrap_err();
    assert!(unknown.source().is_none(), "{unknown}");
}
