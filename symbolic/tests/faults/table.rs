// Faults planted in every model, what became of each, and the rates by kind.

mod engine;
mod expression;
mod judge;
mod page;
mod shared;
mod text;
mod tree;

use std::collections::BTreeMap;
use std::path::PathBuf;

use dalembert_symbolic::derive::Derivation;
use dalembert_symbolic::diagnose::Step;
use dalembert_symbolic::file::{Node, read};
use dalembert_symbolic::gate::{State, judged};
use dalembert_symbolic::model::{Check, Model, resolve};

pub use page::page;

/// How many faults of one kind are planted in one model.
const OF_A_KIND: usize = 24;

/// Sizes to take in place of large ones.
const SIZES: [(&str, i64); 3] = [("chain", 3), ("string_masses", 4), ("periodic_chain", 4)];

/// A fault to plant.
pub struct Fault {
    kind: String,
    what: String,
    watch: Watch,
    plant: Plant,
}

/// How it is planted.
enum Plant {
    /// As another file.
    Text(Box<Node>),
    /// After the file was read.
    Engine(Box<dyn Fn(&mut Model) + Send + Sync>),
}

/// What has to notice it: everything else is taken out of the model.
#[derive(Clone, Debug)]
enum Watch {
    /// One system of balances, as its own derivation is spoilt.
    System(String),
    /// All systems of balances.
    Systems,
    /// One check, by its key.
    Check(Step),
}

/// What became of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// Refused: the two sides differ.
    Caught,
    /// Refused by name: counts that do not fit, a singular system, a placement that makes no sense.
    Named(&'static str),
    /// Accepted, and the motion is the same: no fault.
    Unchanged,
    /// Accepted, and wrong.
    Missed,
    /// Refused by comparison, though the motion is the same.
    Alarm,
}

/// A fault and its fate.
pub struct Outcome {
    model: String,
    kind: String,
    what: String,
    fate: Fate,
}

/// A sound model.
struct Sound {
    name: String,
    root: Node,
    sizes: Vec<(String, i64)>,
    model: Model,
    derivation: Derivation,
    states: Vec<State>,
}

/// Plants every fault in every model with balances or checks, on all cores.
pub fn plant_all() -> Vec<Outcome> {
    let names = models();
    let workers = std::thread::available_parallelism().map_or(1, usize::from).min(names.len());
    let next = std::sync::atomic::AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        while let Some(name) = names.get(next.fetch_add(1, std::sync::atomic::Ordering::Relaxed)) {
            done.extend(sound(name).map(|sound| plant(&sound)));
        }
        done
    };
    let mut done: Vec<Vec<Outcome>> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|t| t.join().expect("planting does not panic")).collect()
    });
    done.sort_by(|a, b| a.first().map(|o| &o.model).cmp(&b.first().map(|o| &o.model)));
    done.into_iter().flatten().collect()
}

/// The library, and models whose balances are written out by hand.
fn folders() -> [PathBuf; 2] {
    let here = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    [here.join("../models"), here.join("tests/faults/written")]
}

/// The models by name, in order.
fn models() -> Vec<String> {
    let files = folders().into_iter().flat_map(|folder| std::fs::read_dir(folder).expect("the models are there"));
    let names = files.filter_map(|file| file.ok()?.file_name().to_str()?.strip_suffix(".yaml").map(str::to_owned));
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// A model that has balances or checks; another is no place for these faults.
fn sound(name: &str) -> Option<Sound> {
    let files = folders().map(|folder| folder.join(format!("{name}.yaml")));
    let text = files.iter().find_map(|file| std::fs::read_to_string(file).ok())?;
    let root = read(&text).ok()?;
    tree::get(&root, "balances").or(tree::get(&root, "checks"))?;
    let size = SIZES.iter().find(|s| s.0 == name).map(|s| ("n".to_owned(), s.1));
    let sizes: Vec<(String, i64)> = size.into_iter().collect();
    let model = resolve(&root, &sizes).unwrap_or_else(|e| panic!("{name}: {e:?}"));
    let derivation = judged(model.clone()).unwrap_or_else(|e| panic!("{name}: {e:?}")).derivation;
    let states = judge::states(&derivation, &[]);
    Some(Sound { name: name.to_owned(), root, sizes, model, derivation, states })
}

fn plant(sound: &Sound) -> Vec<Outcome> {
    let mut by_kind: BTreeMap<String, Vec<Fault>> = BTreeMap::new();
    // Without balances only checks can notice anything.
    let lagrange = if sound.model.balances.is_empty() { Vec::new() } else { engine::of_lagrange(&sound.model) };
    let lists = [text::faults(&sound.root, &sound.model), engine::of_balances(&sound.model), lagrange];
    for fault in lists.into_iter().flatten() {
        by_kind.entry(fault.kind.clone()).or_default().push(fault);
    }
    let mut outcomes = Vec::new();
    for faults in by_kind.into_values() {
        let step = faults.len().div_ceil(OF_A_KIND);
        for fault in faults.into_iter().step_by(step) {
            let fate = fate(sound, &fault);
            let what = match fault.watch {
                Watch::System(system) if sound.model.balances.len() > 1 => format!("{} ({system})", fault.what),
                _ => fault.what,
            };
            outcomes.push(Outcome { model: sound.name.clone(), kind: fault.kind, what, fate });
        }
    }
    outcomes
}

fn fate(sound: &Sound, fault: &Fault) -> Fate {
    let mut model = match &fault.plant {
        Plant::Text(root) => match resolve(root, &sound.sizes) {
            Ok(model) => model,
            Err(problems) => return Fate::Named(problems[0].code),
        },
        Plant::Engine(alter) => {
            let mut model = sound.model.clone();
            alter(&mut model);
            model
        }
    };
    model.conserved.clear();
    model.outputs.clear();
    model.events.clear();
    match &fault.watch {
        Watch::System(name) => {
            model.checks.clear();
            model.balances.retain(|system| system.name == *name);
        }
        Watch::Systems => model.checks.clear(),
        // A check may speak of reactions, which the balances give.
        Watch::Check(place) => model.checks.retain(|check| check.place.path.get(1) == Some(place)),
    }
    let verdict = judged(model.clone());
    if let Err(problems) = &verdict
        && problems.iter().all(|p| !matches!(p.code, "E502" | "E506"))
    {
        return Fate::Named(problems[0].code);
    }
    let refused = verdict.is_err();
    // Reactions in checks have their values only after deriving.
    if let Ok(judged) = verdict {
        model = judged.derivation.model;
    }
    match (!refused, unchanged(sound, model, &fault.watch)) {
        (true, true) => Fate::Unchanged,
        (true, false) => Fate::Missed,
        (false, true) => Fate::Alarm,
        (false, false) => Fate::Caught,
    }
}

/// Whether an altered model says the same, decided without the program's own comparison.
fn unchanged(sound: &Sound, mut model: Model, watch: &Watch) -> bool {
    if let Watch::Check(_) = watch {
        let holds = |check: &Check| {
            let states = judge::states(&sound.derivation, &check.when);
            judge::check_holds(&model.graph, check, &states)
        };
        return !model.checks.is_empty() && model.checks.iter().all(holds);
    }
    let systems = std::mem::take(&mut model.balances);
    let balances = systems.iter().all(|system| judge::system_unchanged(&mut model, system, &sound.states));
    balances && judged(model).is_ok_and(|alone| judge::lagrange_unchanged(&alone.derivation, &sound.states))
}

/// The faults that were missed, and the sound models that were refused, in words.
pub fn wrong(outcomes: &[Outcome]) -> Vec<String> {
    let these = outcomes.iter().filter(|o| matches!(o.fate, Fate::Missed | Fate::Alarm));
    these.map(|o| format!("{:?}: {}: {}: {}", o.fate, o.model, o.kind, o.what)).collect()
}
