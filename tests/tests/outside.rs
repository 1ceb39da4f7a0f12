//! Strangers' crates build against dalembert and run: one with the macro, one with generated code that is checked in, one with such code and
//! without the standard library, and one that the program writes.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use dalembert::prelude::*;
use dalembert_models::{MODELS, double_pendulum::DoublePendulum};

#[test]
fn a_crate_outside_the_workspace_builds_and_runs() {
    let output = cargo(&["run", "--quiet"], &folder("outside"));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{told}");
    // The model file's one warning, once of three: where it is not silenced.
    assert_eq!(told.matches("warning[W420]: `plate` has mass and turns, and has no `inertia`").count(), 1, "{told}");
    assert!(told.contains("models/doubtful.yaml:5:27"), "{told}");
    let number = |key: &str| -> f64 {
        let line = text.lines().find_map(|line| line.strip_prefix(key)).unwrap_or_else(|| panic!("no {key}: {text}"));
        line.split_whitespace().next().and_then(|x| x.parse().ok()).unwrap_or(f64::NAN)
    };
    // T/2 = π √(l/g) / agm(1, cos(θ₀/2)), θ₀ = 20°.
    let (mut a, mut b) = (1.0_f64, 10_f64.to_radians().cos());
    for _ in 0..6 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    let expected = std::f64::consts::PI * (2.5_f64 / 9.81).sqrt() / a;
    assert!((number("half period ") - expected).abs() < 1e-8, "{text}");
    assert!(number("balance ") < 1e-10, "{text}");
}

#[test]
fn a_crate_that_the_program_writes_builds_and_runs() {
    let written = Path::new(env!("CARGO_TARGET_TMPDIR")).join("outside-new");
    let _ = fs::remove_dir_all(&written);
    let said = |arguments: &[&str]| {
        let mut out = Vec::new();
        dalembert::cli::run(MODELS, [&["dalembert"], arguments].concat(), &mut out).expect("a command that succeeds");
        String::from_utf8(out).expect("text")
    };
    let path = |file: &str| written.join(file).to_str().expect("a path").to_owned();
    let out = said(&["new", written.to_str().expect("a path"), "--crate"]);
    for file in ["Cargo.toml", "src/main.rs", "models/outside-new.yaml", "models/dalembert.schema.json"] {
        assert!(written.join(file).exists() && out.contains(file), "{file}: {out}");
    }
    // The packages of the other crate: nothing is asked of a registry, and nothing is built twice.
    let lock = fs::read_to_string(folder("outside").join("Cargo.lock")).expect("a lock file");
    fs::write(path("Cargo.lock"), lock.replace("\"outside\"", "\"outside-new\"")).expect("a file");
    let (printed, told) = told(&cargo(&["run", "--quiet"], &written));
    assert_eq!(told, "", "the code compiles without a warning");
    let theta = printed.lines().find_map(|line| line.strip_prefix("theta = ")?.strip_suffix(" rad at t = 10 s"));
    let theta: f64 = theta.and_then(|text| text.parse().ok()).unwrap_or_else(|| panic!("no end: {printed}"));
    let end: serde_json::Value =
        serde_json::from_str(&said(&["simulate", &path("models/outside-new.yaml"), "--json"])).expect("JSON");
    assert!((end["q"]["theta"].as_f64().expect("a number") - theta).abs() < 1e-9, "{printed}");
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// What cargo says of the crate in this folder.
fn cargo(arguments: &[&str], folder: &Path) -> Output {
    let mut command = Command::new(env!("CARGO"));
    command.args(arguments).arg("--locked").arg("--manifest-path").arg(folder.join("Cargo.toml"));
    command.env("CARGO_TARGET_DIR", target()).output().expect("cargo can be started")
}

fn told(output: &Output) -> (String, String) {
    (String::from_utf8_lossy(&output.stdout).into_owned(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn code_that_is_checked_in_runs_to_the_same_bits_without_the_deriver() {
    let checked = folder("outside-checked");
    let (bits, said) = told(&cargo(&["run", "--quiet"], &checked));
    assert_eq!(said, "", "the code compiles without a warning");
    let run = DoublePendulum::default().simulate().tolerance(1e-10).run().expect("a run");
    let end = run.last();
    let expected: Vec<String> = end.q.iter().chain(&end.v).map(|x| format!("{:016x}", x.to_bits())).collect();
    assert_eq!(bits.trim(), expected.join(" "));

    let (tree, said) = told(&cargo(&["tree", "--prefix", "none", "--edges", "normal,build"], &checked));
    assert!(tree.contains("dalembert v") && tree.contains("nalgebra v"), "{tree}{said}");
    for without in
        ["syn", "quote", "proc-macro2", "dalembert-macros", "dalembert-symbolic", "serde_yaml", "saphyr-parser"]
    {
        let taken = tree.lines().find(|line| line.split(' ').next() == Some(without));
        assert_eq!(taken, None, "{tree}");
    }

    let (model, code) = (folder("../models/double_pendulum.yaml"), checked.join("src/double_pendulum.rs"));
    let paths = [&model, &code].map(|path| path.to_str().expect("a path"));
    let check = ["dalembert", "generate", paths[0], "-o", paths[1], "--check"];
    dalembert::cli::run(MODELS, check, &mut Vec::new()).expect("the code of the model");
}

#[test]
fn code_of_another_format_is_refused_by_the_compiler_in_words() {
    let (checked, other) = (folder("outside-checked"), Path::new(env!("CARGO_TARGET_TMPDIR")).join("other-format"));
    fs::create_dir_all(other.join("src")).expect("a folder");
    for file in ["Cargo.lock", "src/main.rs"] {
        fs::copy(checked.join(file), other.join(file)).expect("a file");
    }
    let runtime = fs::canonicalize(folder("../runtime")).expect("the runtime");
    let changed = |file: &str, from: &str, to: &str| {
        let text = fs::read_to_string(checked.join(file)).expect("a file");
        assert!(text.contains(from), "{file}");
        fs::write(other.join(file), text.replace(from, to)).expect("a file");
    };
    changed("Cargo.toml", "../../runtime", runtime.to_str().expect("a path"));
    changed("src/double_pendulum.rs", "generated_for!(7)", "generated_for!(0)");
    let (_, said) = told(&cargo(&["build", "--quiet"], &other));
    assert!(said.contains("this code was generated for format 0 of dalembert"), "{said}");
    assert!(said.contains("write it again by this version's `dalembert generate`"), "{said}");
}

dalembert::model!("outside-nostd/cart.yaml");

#[test]
fn without_the_standard_library_a_loop_runs_as_in_the_library() {
    let controller = folder("outside-nostd");
    let (printed, said) = told(&cargo(&["run", "--quiet", "--example", "closed_loop"], &controller));
    assert_eq!(said, "", "the code compiles without a warning");
    let numbers = |line: &str| line.split(' ').map(|x| x.parse().expect("a number")).collect::<Vec<f64>>();
    let ticks: Vec<Vec<f64>> = printed.lines().map(numbers).collect();
    assert_eq!(ticks.len(), 1001);
    // In single precision as in double.
    let apart = |tick: &Vec<f64>| (1..4).map(|k| (tick[k] - tick[k + 4]).abs()).fold(0.0, f64::max);
    assert!(ticks.iter().map(apart).fold(0.0, f64::max) < 1e-6);
    assert!(ticks[1000][1..4].iter().all(|x| x.abs() < 1e-4), "upright: {:?}", ticks[1000]);
    // With the same forces, for half a second, in which the rods that nobody holds would fall.
    let mut run = Cart::default().simulate().by_hand().expect("a start");
    for tick in &ticks[..100] {
        let state = run.state();
        for (place, name) in ["x", "theta1", "theta2"].into_iter().enumerate() {
            assert!((state[name] - tick[5 + place]).abs() < 1e-8, "{name}, {tick:?}");
        }
        run.set_input("push", tick[8]).expect("an input");
        run.advance(0.005).expect("a step");
    }
    let (model, code) = (controller.join("cart.yaml"), controller.join("src/cart.rs"));
    let paths = [&model, &code].map(|path| path.to_str().expect("a path"));
    let check = ["dalembert", "generate", paths[0], "--no-std", "-o", paths[1], "--check"];
    dalembert::cli::run(MODELS, check, &mut Vec::new()).expect("the code of the model");
}

/// Where the microcontroller's own library is not installed this says so and passes; in CI, where the variable `CI` is set, it fails.
#[test]
fn a_microcontroller_gets_a_controller_of_some_kilobytes() {
    let target = "thumbv7em-none-eabihf";
    let build = ["build", "--quiet", "--release", "--features", "firmware", "--bin", "firmware", "--target", target];
    let (_, said) = told(&cargo(&build, &folder("outside-nostd")));
    if said.contains("can't find crate for `core`") && std::env::var_os("CI").is_none() {
        println!("not run: rustup target add {target}");
        return;
    }
    assert_eq!(said, "");
    let program = fs::read(self::target().join(target).join("release/firmware")).expect("a program");
    let size = loaded(&program);
    println!("{size} bytes of code and constants");
    assert!((4_000..16_000).contains(&size), "{size} bytes");
}

/// How many bytes of a program of 32 bits are loaded: its segments of type 1 (System V ABI, chapter 5: program header).
fn loaded(program: &[u8]) -> usize {
    let number =
        |at: usize, bytes: usize| program[at..at + bytes].iter().rev().fold(0, |n, byte| n << 8 | *byte as usize);
    assert_eq!(&program[..5], b"\x7fELF\x01");
    let (first, size, count) = (number(28, 4), number(42, 2), number(44, 2));
    let segments = (0..count).map(|k| first + k * size).filter(|at| number(*at, 4) == 1);
    segments.map(|at| number(at + 20, 4)).sum()
}

/// A folder beside this test's own target folder, so that a second run finds what the first built.
fn target() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("outside")
}
