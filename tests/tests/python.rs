//! `show --python`: the module of every model of the library, and of files with hostile names, gives what the program
//! computes.  Runs where there is a Python with NumPy (`.ci/run` installs one).

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use dalembert::mechanism::{At, Interpreted, SwitchKind, System};
use dalembert::{Settings, simulate};
use dalembert_symbolic::{lower::compile_in, print};
use serde_json::{Value, json};

/// States at which a module is compared.
const STATES: usize = 4;

/// Evaluates what it is asked on its input, a line a module.
const DRIVER: &str = r#"
import importlib, json, sys
sys.path.insert(0, sys.argv[1])
import numpy as np
for line in sys.stdin:
    asked = json.loads(line)
    module = importlib.import_module(asked["module"])
    answers = []
    for state in asked["states"]:
        t, q, v, phase = state["t"], state["q"], state["v"], state["phase"]
        more = {"memory": dict(zip(module.MEMORY, state["memory"]))} if state["memory"] else {}
        rate = module.rate(t, q + v, phase=phase, **more)
        answers.append({
            "mass": module.mass_matrix(t, q, v, phase=phase, **more).tolist(),
            "bias": module.bias(t, q, v, phase=phase, **more).tolist(),
            "rate": rate.tolist(),
        })
    print(json.dumps(answers).replace("-Infinity", "null").replace("Infinity", "null").replace("NaN", "null"))
"#;

/// A Python that knows NumPy.
fn python() -> Option<&'static str> {
    ["python3", "/usr/bin/python3"].into_iter().find(|python| {
        let tried = Command::new(python).args(["-c", "import numpy"]).stderr(Stdio::null()).status();
        tried.is_ok_and(|status| status.success())
    })
}

fn files() -> BTreeMap<String, PathBuf> {
    let folders = [
        concat!(env!("CARGO_MANIFEST_DIR"), "/../models"),
        concat!(env!("CARGO_MANIFEST_DIR"), "/tests/names"),
        concat!(env!("CARGO_MANIFEST_DIR"), "/roads"),
    ];
    let files = folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()));
    files
        .filter(|path| path.extension().is_some_and(|e| e == "yaml"))
        // States of first order are refused.
        .filter(|path| !fs::read_to_string(path).unwrap().contains("\nstates:"))
        .map(|path| (format!("module_{}", path.file_stem().unwrap().to_str().unwrap().replace(['-', '.'], "_")), path))
        .collect()
}

/// What stands for discontinuities, where the state is.
fn settle(system: &mut Interpreted, t: f64, q: &[f64], v: &[f64]) {
    let kinds: Vec<SwitchKind> = system.description().switches.iter().map(|switch| switch.kind).collect();
    for k in 0..kinds.len() {
        let mut pairs = vec![0.0; 2 * kinds.len()];
        system.switches(At::new(t, q, v), &mut pairs);
        let mut modes = system.modes().to_vec();
        modes[k] = match kinds[k] {
            SwitchKind::Sign => pairs[2 * k].signum(),
            SwitchKind::Step => f64::from(pairs[2 * k] >= 0.0),
        };
        system.set_modes(&modes);
    }
}

/// Numbers that are always the same.
struct Draws(u64);

impl Draws {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

struct Asked {
    system: Interpreted,
    states: Vec<(f64, Vec<f64>, Vec<f64>, usize)>,
}

/// Whether rows depend on each other, so that accelerations are determined only where all constraints hold.
fn overdetermined(system: &Interpreted) -> bool {
    system.description().phases.iter().any(|phase| (phase.rank as usize) < phase.rows.len())
}

/// States of the scene's motion.
fn on_the_motion(system: &Interpreted) -> Vec<(f64, Vec<f64>, Vec<f64>, usize)> {
    let mut running = system.clone();
    let settings = Settings::new(&running.scene(0));
    let run = simulate(&mut running, &settings).unwrap();
    (0..STATES).map(|k| run.state(k * (run.len() - 1) / STATES)).map(|state| (state.t, state.q, state.v, 0)).collect()
}

fn asked(path: &Path, module: &str, folder: &Path) -> Asked {
    let text = fs::read_to_string(path).unwrap();
    let program = compile_in(path.parent(), &text, &[]).unwrap_or_else(|problems| panic!("{module}: {problems:?}"));
    fs::write(folder.join(format!("{module}.py")), print::python(&program, module)).unwrap();
    let phases = program.model.phases.len().max(1);
    let n = program.model.coordinates.len();
    let mut system = Interpreted::new(program, &text);
    let mut draws = Draws(module.len() as u64);
    let held: Vec<f64> = system.memory().iter().map(|_| draws.between(-1.0, 1.0)).collect();
    system.set_memory(&held);
    let states = (0..STATES * phases).map(|i| {
        let mut list = || (0..n).map(|_| draws.between(0.2, 1.3)).collect::<Vec<f64>>();
        let (q, v) = (list(), list());
        (draws.between(0.0, 2.0), q, v, i % phases)
    });
    let states = if overdetermined(&system) { on_the_motion(&system) } else { states.collect() };
    Asked { system, states }
}

fn answers(python: &str, folder: &Path, lines: &str) -> Vec<Value> {
    use std::io::Write;
    let mut child = Command::new(python)
        .args(["-W", "ignore", "-c", DRIVER, folder.to_str().unwrap()])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    let lines = lines.to_owned();
    let writer = std::thread::spawn(move || input.write_all(lines.as_bytes()).unwrap());
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    assert!(output.status.success(), "Python failed");
    String::from_utf8(output.stdout).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(list) => list.iter().flat_map(numbers).collect(),
        number => vec![number.as_f64().unwrap_or(f64::NAN)],
    }
}

/// To 1e-12 of the largest among them.
#[track_caller]
fn close(what: &str, ours: &[f64], theirs: &[f64]) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    let scale = ours.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    for (x, y) in ours.iter().zip(theirs) {
        assert!((x - y).abs() <= 1e-12 * scale || !x.is_finite() && !y.is_finite(), "{what}: {ours:?} {theirs:?}");
    }
}

#[test]
fn modules_for_python_agree_with_the_program() {
    let Some(python) = python() else {
        eprintln!("no Python with NumPy here: modules are not compared");
        return;
    };
    let folder = std::env::temp_dir().join(format!("dalembert-python-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let mut all: Vec<(String, Asked)> =
        files().into_iter().map(|(module, path)| (module.clone(), asked(&path, &module, &folder))).collect();
    let lines: String = all
        .iter()
        .map(|(module, asked)| {
            let state =
                |(t, q, v, phase): &(f64, Vec<f64>, Vec<f64>, usize)| json!({"t": t, "q": q, "v": v, "phase": phase, "memory": asked.system.memory()});
            let states: Vec<Value> = asked.states.iter().map(state).collect();
            json!({"module": module, "states": states}).to_string() + "\n"
        })
        .collect();
    let answers = answers(python, &folder, &lines);
    assert_eq!(answers.len(), all.len());
    let mut compared = 0;
    for ((module, Asked { system, states }), answer) in all.iter_mut().zip(&answers) {
        let n = system.len();
        for ((t, q, v, phase), answer) in states.iter().zip(answer.as_array().unwrap()) {
            system.set_phase(*phase);
            settle(system, *t, q, v);
            let at = At::new(*t, q, v);
            let pattern = system.description().mass_pattern.to_vec();
            let mut values = vec![0.0; pattern.len()];
            system.mass_matrix(at, &mut values);
            let mut mass = vec![0.0; n * n];
            for ((i, j), value) in pattern.into_iter().zip(values) {
                mass[i as usize * n + j as usize] = value;
                mass[j as usize * n + i as usize] = value;
            }
            close(&format!("{module}: M"), &mass, &numbers(&answer["mass"]));
            let mut bias = vec![0.0; n];
            system.bias(at, &mut bias);
            close(&format!("{module}: h"), &bias, &numbers(&answer["bias"]));
            let mut lambda = vec![0.0; system.description().rows.len()];
            let mut a = vec![0.0; n];
            if system.accelerations_and_multipliers(at, &mut a, &mut lambda).is_ok() {
                let rate = numbers(&answer["rate"]);
                close(&format!("{module}: q'"), v, &rate[..n]);
                close_solution(&format!("{module}: q''"), &a, &rate[n..]);
                compared += 1;
            }
        }
    }
    assert!(compared > 200, "{compared}");
    fs::remove_dir_all(folder).unwrap();
}

/// Solutions of a linear system, whose condition both feel.
#[track_caller]
fn close_solution(what: &str, ours: &[f64], theirs: &[f64]) {
    let scale = ours.iter().fold(1.0_f64, |largest, x| largest.max(x.abs()));
    for (x, y) in ours.iter().zip(theirs) {
        assert!((x - y).abs() <= 1e-12 * scale || !x.is_finite() && !y.is_finite(), "{what}: {ours:?} {theirs:?}");
    }
}

/// Of the five rows of Bennett's linkage two are independent: a position that is off by 1e-6 has the accelerations of one on its constraints, to that.
#[test]
fn rows_that_depend_on_each_other_are_chosen_by_their_number() {
    let Some(python) = python() else { return };
    let folder = std::env::temp_dir().join(format!("dalembert-python-rows-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/bennett.yaml");
    let Asked { system, states } = asked(&path, "off", &folder);
    let off = |e: f64| {
        let states = states.iter().map(|(t, q, v, phase)| {
            let q: Vec<f64> = q.iter().enumerate().map(|(i, q)| q + if i == 1 { e } else { 0.0 }).collect();
            json!({"t": t, "q": q, "v": v, "phase": phase, "memory": []})
        });
        json!({"module": "off", "states": states.collect::<Vec<Value>>()}).to_string() + "\n"
    };
    let answers = answers(python, &folder, &[off(1e-6), off(1e-7)].concat());
    for (answer, bound) in answers.iter().zip([1e-4, 1e-5]) {
        for ((t, q, v, _), answer) in states.iter().zip(answer.as_array().unwrap()) {
            let (n, mut lambda) = (q.len(), vec![0.0; system.description().rows.len()]);
            let mut a = vec![0.0; n];
            system.accelerations_and_multipliers(At::new(*t, q, v), &mut a, &mut lambda).unwrap();
            let theirs = &numbers(&answer["rate"])[n..];
            let scale = a.iter().fold(1.0_f64, |largest, x| largest.max(x.abs()));
            assert!(a.iter().zip(theirs).all(|(x, y)| (x - y).abs() < bound * scale), "{a:?} {theirs:?}");
        }
    }
    fs::remove_dir_all(folder).unwrap();
}

/// An input that is given stays as it is: m x'' + c x' + k x = F with m = c = k = 1 and both other ends at rest.
#[test]
fn inputs_of_a_module_may_be_given() {
    let Some(python) = python() else { return };
    let folder = std::env::temp_dir().join(format!("dalembert-python-inputs-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/base_excitation.yaml");
    let program = compile_in(path.parent(), &fs::read_to_string(&path).unwrap(), &[]).unwrap();
    fs::write(folder.join("driven.py"), print::python(&program, "driven")).unwrap();
    let code = "import sys; sys.path.insert(0, sys.argv[1]); import driven; \
                print(driven.INPUTS[0], *driven.rate(0.3, [0.1, 0.2], u={driven.INPUTS[0]: 2.5}))";
    let output = Command::new(python).args(["-c", code, folder.to_str().unwrap()]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8(output.stdout).unwrap();
    let words: Vec<&str> = printed.split_whitespace().collect();
    let acceleration: f64 = words[2].parse().unwrap();
    assert!(words[0] == "force" && (acceleration - 2.2).abs() < 1e-14, "{printed}");
    fs::remove_dir_all(folder).unwrap();
}
