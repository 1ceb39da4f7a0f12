// Faults planted in every model, what became of each, and the rates by kind.

mod bound;
mod engine;
mod expression;
mod held;
mod judge;
mod moments;
mod page;
mod parts;
mod shared;
mod smallest;
mod solve;
mod text;
mod tree;
mod windows;

use std::collections::BTreeMap;
use std::path::PathBuf;

use dalembert_symbolic::derive::{Derivation, derive};
use dalembert_symbolic::diagnose::{Problem, Step};
use dalembert_symbolic::file::{Node, read};
use dalembert_symbolic::gate::{Gate, judged};
use dalembert_symbolic::model::{Model, resolve};

use engine::Change;
use judge::{Judge, Window};

pub use held::held;
pub use page::page;
pub use smallest::smallest;

/// What moves an acceleration by no more than this of its row is no fault.
const NOTHING: f64 = 1e-24;
/// What moves one by more than this must be refused.
const TOLERANCE: f64 = 1e-9;

/// Verdicts by comparison; every other error is a refusal by name.
const VERDICTS: [&str; 10] = ["E501", "E502", "E503", "E506", "E509", "E511", "E512", "E513", "E517", "E518"];

/// How many faults of one kind are planted in one model at the most.
#[derive(Clone, Copy)]
pub enum Extent {
    /// For a test that runs often.
    Test,
    /// For the page.
    #[cfg_attr(test, expect(dead_code, reason = "the example prints the page"))]
    Page,
}

impl Extent {
    fn of_a_kind(self) -> usize {
        match self {
            Extent::Test => 1,
            Extent::Page => 8,
        }
    }
}

/// So many states at least there must be in every phase in which something is judged.
const LEAST: usize = 20;

/// Sizes to take in place of large ones.
const SIZES: [(&str, i64); 3] = [("chain", 3), ("string_masses", 4), ("periodic_chain", 4)];

/// A fault to plant.
pub struct Fault {
    kind: String,
    what: String,
    watch: Watch,
    plant: Plant,
    /// Where alone it acts; empty: everywhere.
    window: Window,
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
    /// One claim that something is conserved, by its key.
    Conserved(Step),
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
    /// Accepted, and only a reaction is another, of which `check` says that one equation alone tells it.
    Told,
    /// Accepted, and the motion is another by less than what must be refused.
    Slight,
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
    /// By how much of its row it moves an acceleration, or of its terms a claim.
    difference: f64,
    /// Which parts of the gate it would slip through without, in the order of `PARTS`; empty where nobody asked.
    slips: Vec<bool>,
}

impl Outcome {
    /// Whether it is a fault of this model that was refused by comparison.
    #[cfg_attr(not(test), expect(dead_code, reason = "the test asks"))]
    pub fn is_caught(&self, model: &str) -> bool {
        self.model == model && self.fate == Fate::Caught
    }
}

/// A sound model.
struct Sound {
    name: String,
    root: Node,
    sizes: Vec<(String, i64)>,
    model: Model,
    judge: Judge,
}

/// Plants every fault in every model with balances or claims, on all cores; `blinded` asks too what each part of the gate
/// does for it.
pub fn plant_all(extent: Extent, blinded: bool) -> Vec<Outcome> {
    let done = in_parallel(&models(), |name| sound(name).map_or_else(Vec::new, |sound| plant(&sound, extent, blinded)));
    done.into_iter().flatten().collect()
}

/// Work on every name, on all cores; the results are in the names' order.
fn in_parallel<T: Send>(names: &[String], work: impl Fn(&str) -> T + Sync) -> Vec<T> {
    let workers = std::thread::available_parallelism().map_or(1, usize::from).min(names.len());
    let next = std::sync::atomic::AtomicUsize::new(0);
    let one = || {
        let mut done = Vec::new();
        loop {
            let k = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            let Some(name) = names.get(k) else { return done };
            done.push((k, work(name)));
        }
    };
    let mut done: Vec<(usize, T)> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers).map(|_| scope.spawn(one)).collect();
        threads.into_iter().flat_map(|t| t.join().expect("planting does not panic")).collect()
    });
    done.sort_by_key(|d| d.0);
    done.into_iter().map(|d| d.1).collect()
}

/// The library, models whose balances are written out by hand, and models of several scales.
fn folders() -> [PathBuf; 3] {
    let here = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    [here.join("../models"), here.join("tests/faults/written"), here.join("tests/faults/scales")]
}

/// The models by name, in order.
fn models() -> Vec<String> {
    let files = folders().into_iter().flat_map(|folder| std::fs::read_dir(folder).expect("the models are there"));
    let names = files.filter_map(|file| file.ok()?.file_name().to_str()?.strip_suffix(".yaml").map(str::to_owned));
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// The text of a model's file.
fn text_of(name: &str) -> Option<String> {
    let files = folders().map(|folder| folder.join(format!("{name}.yaml")));
    files.iter().find_map(|file| std::fs::read_to_string(file).ok())
}

/// A model that has balances or claims; another is no place for these faults.
fn sound(name: &str) -> Option<Sound> {
    let text = text_of(name)?;
    let root = read(&text).ok()?;
    ["balances", "checks", "conserved"].iter().find_map(|key| tree::get(&root, key))?;
    let size = SIZES.iter().find(|s| s.0 == name).map(|s| ("n".to_owned(), s.1));
    let sizes: Vec<(String, i64)> = size.into_iter().collect();
    let model = resolve(&root, &sizes).unwrap_or_else(|e| panic!("{name}: {e:?}"));
    let derivation = judged(model.clone()).unwrap_or_else(|e| panic!("{name}: {e:?}")).derivation;
    let judge = Judge::new(&derivation);
    // Few states have all contacts closed: `runtime/tests/contacts.rs` has faults of theirs.
    if !model.contacts.is_empty() {
        return None;
    }
    // It eliminates every row: where rows depend on each other, as those of Bennett's loop, it has no state to judge by.
    let rows: usize = model.constraints.iter().map(|constraint| constraint.value.len()).sum();
    if judge.states(0) < LEAST && (model.balances.is_empty() || rows > model.coordinates.len()) {
        return None;
    }
    for phase in model.balances.iter().flat_map(|system| &system.phases) {
        assert!(judge.states(*phase) >= LEAST, "{name}: {} states in phase {phase}", judge.states(*phase));
    }
    Some(Sound { name: name.to_owned(), root, sizes, model, judge })
}

fn plant(sound: &Sound, extent: Extent, blinded: bool) -> Vec<Outcome> {
    let mut changes = Change::coarse();
    changes.extend([Change::slight(6), Change::slight(12)]);
    changes.extend(windows::windows(&sound.judge));
    let mut by_kind: BTreeMap<String, Vec<Fault>> = BTreeMap::new();
    // Without balances only claims can notice anything.
    let none = sound.model.balances.is_empty();
    let lagrange = if none { Vec::new() } else { engine::of_lagrange(&sound.model, &changes) };
    let lists = [text::faults(&sound.root, &sound.model), engine::of_balances(&sound.model, &changes), lagrange];
    for fault in lists.into_iter().flatten() {
        by_kind.entry(fault.kind.clone()).or_default().push(fault);
    }
    let mut outcomes = Vec::new();
    for faults in by_kind.into_values() {
        let step = faults.len().div_ceil(extent.of_a_kind());
        outcomes.extend(faults.into_iter().step_by(step).filter_map(|fault| outcome(sound, fault, blinded)));
    }
    outcomes
}

fn outcome(sound: &Sound, fault: Fault, blinded: bool) -> Option<Outcome> {
    let (fate, difference, slips) = fate(sound, &fault, blinded)?;
    let what = match fault.watch {
        Watch::System(system) if sound.model.balances.len() > 1 => format!("{} ({system})", fault.what),
        _ => fault.what,
    };
    Some(Outcome { model: sound.name.clone(), kind: fault.kind, what, fate, difference, slips })
}

/// The model with a fault in it, and nothing that could notice it but what is to.
fn spoilt(sound: &Sound, fault: &Fault) -> Result<Model, &'static str> {
    let mut model = match &fault.plant {
        Plant::Text(root) => resolve(root, &sound.sizes).map_err(|problems| problems[0].code)?,
        Plant::Engine(alter) => {
            let mut model = sound.model.clone();
            alter(&mut model);
            model
        }
    };
    model.outputs.clear();
    model.events.clear();
    if !matches!(fault.watch, Watch::Check(_)) {
        model.checks.clear();
    }
    if !matches!(fault.watch, Watch::Conserved(_)) {
        model.conserved.clear();
    }
    match &fault.watch {
        Watch::System(name) => model.balances.retain(|system| system.name == *name),
        Watch::Systems => {}
        // A claim may speak of reactions, which the balances give.
        Watch::Check(place) => model.checks.retain(|check| check.place.path.get(1) == Some(place)),
        Watch::Conserved(place) => model.conserved.retain(|claim| claim.place.path.get(1) == Some(place)),
    }
    Ok(model)
}

/// None where the fault acts in phases only that have no second derivation.
fn fate(sound: &Sound, fault: &Fault, blinded: bool) -> Option<(Fate, f64, Vec<bool>)> {
    let model = match spoilt(sound, fault) {
        Ok(model) => model,
        Err(code) => return Some((Fate::Named(code), f64::INFINITY, Vec::new())),
    };
    let derivation = match derive(model) {
        Ok(derivation) => derivation,
        Err(problems) => return Some((Fate::Named(problems[0].code), f64::INFINITY, Vec::new())),
    };
    let verdict = Gate::default().judge(derivation.clone());
    if let Err(problems) = &verdict
        && problems.iter().all(|p| !VERDICTS.contains(&p.code))
    {
        return Some((Fate::Named(problems[0].code), f64::INFINITY, Vec::new()));
    }
    let (difference, elsewhere) = difference(sound, &derivation, fault);
    if difference <= NOTHING && elsewhere > NOTHING {
        return None;
    }
    let (mut difference, mut told) = (difference, false);
    if difference <= NOTHING && matches!(fault.watch, Watch::System(_)) {
        let alone = verdict.as_ref().map_or(&[][..], |judged| &judged.report.alone);
        for (name, gap) in sound.judge.reactions(&derivation, &fault.window) {
            let rests = |words: &String| words.starts_with(&format!("`{name}"));
            match alone.iter().any(rests) {
                true => told |= gap > NOTHING,
                false => difference = difference.max(gap),
            }
        }
    }
    let contradicts = |problems: &[Problem]| problems.iter().all(|problem| problem.code == "E518");
    let fate = match verdict {
        Err(_) if difference > NOTHING => Fate::Caught,
        // Loads and places contradict the reactions that are written out, though the motion is the same.
        Err(ref problems)
            if contradicts(problems) && sound.judge.work_left_over(&derivation, &fault.window) > TOLERANCE =>
        {
            Fate::Caught
        }
        Err(_) => Fate::Alarm,
        Ok(_) if difference > TOLERANCE => Fate::Missed,
        Ok(_) if difference > NOTHING => Fate::Slight,
        Ok(_) if told => Fate::Told,
        Ok(_) => Fate::Unchanged,
    };
    let slips = if blinded && fate == Fate::Caught { parts::slips(&derivation) } else { Vec::new() };
    Some((fate, difference, slips))
}

/// By how much an altered derivation moves otherwise, or its claim is wrong, decided without the gate; and by how much
/// where nothing is there to notice it.
fn difference(sound: &Sound, altered: &Derivation, fault: &Fault) -> (f64, f64) {
    let (judge, model) = (&sound.judge, &altered.model);
    match fault.watch {
        Watch::System(_) | Watch::Systems => judge.difference(altered, &fault.window),
        Watch::Check(_) => (model.checks.iter().map(|check| judge.failure(altered, check)).fold(0.0, f64::max), 0.0),
        Watch::Conserved(_) => {
            (model.conserved.iter().map(|claim| judge.drift(altered, claim)).fold(0.0, f64::max), 0.0)
        }
    }
}

/// The faults that were missed, and the sound models that were refused, in words.
pub fn wrong(outcomes: &[Outcome]) -> Vec<String> {
    let these = outcomes.iter().filter(|o| matches!(o.fate, Fate::Missed | Fate::Alarm));
    these.map(|o| format!("{:?}: {}: {}: {} ({:.1e})", o.fate, o.model, o.kind, o.what, o.difference)).collect()
}
