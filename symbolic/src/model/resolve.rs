//! From the tree of a file to a model: the passes in order.

use std::collections::HashMap;
use std::path::Path;

use super::expression::builder::is_of_units;
use super::files::Files;
use super::identifier::type_name;
use super::resolved::Model;
use super::resolver::Resolver;
use super::section::declare::dimension;
use super::section::resolve_values::resolve_values;
use crate::diagnose::catalogue::{names, sections};
use crate::diagnose::{Place, Problem, Step, did_you_mean, nearest};
use crate::file::{Node, Spot};

/// Every key that a model file may have.
const KEYS: [&str; 38] = [
    "name",
    "about",
    "sizes",
    "tables",
    "parameters",
    "coordinates",
    "memory",
    "noise",
    "states",
    "inputs",
    "define",
    "frames",
    "points",
    "bodies",
    "gravity",
    "springs",
    "dampers",
    "forces",
    "torques",
    "kinetic_energy",
    "potential_energy",
    "dissipation",
    "generalized_forces",
    "constraints",
    "joints",
    "friction",
    "contacts",
    "impacts",
    "phases",
    "events",
    "balances",
    "conserved",
    "checks",
    "sample",
    "outputs",
    "draw",
    "motions",
    "scene",
];

/// Resolves a file: names to symbols, families to members, sections to mechanics.
///
/// `sizes` replace the file's own.
///
/// # Errors
/// Everything that is wrong with the file.
pub fn resolve(root: &Node, sizes: &[(String, i64)]) -> Result<Model, Vec<Problem>> {
    whole(resolve_through(root, sizes, &Files::default(), Wanted::Model))
}

/// The model, if nothing is wrong.
fn whole((model, problems): (Option<Model>, Vec<Problem>)) -> Result<Model, Vec<Problem>> {
    match model {
        Some(model) if problems.is_empty() => Ok(model),
        _ => Err(problems),
    }
}

/// What a file is resolved to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Wanted {
    /// The model.
    Model,
    /// With what every body does to a balance as a part of its own however many they are.
    InParts,
    /// With the forces that act at points as its last outputs.
    Forces,
}

/// As [`resolve`], and with all that is wrong the model too where its equations of motion are as meant: problems of
/// units leave every expression its meaning, and what a run only observes does not enter the equations.
fn resolve_through(
    root: &Node,
    sizes: &[(String, i64)],
    files: &Files,
    wanted: Wanted,
) -> (Option<Model>, Vec<Problem>) {
    let (respelt, slips) = respelt(root);
    let mut resolver = Resolver::new(Spot::root(respelt.as_ref().unwrap_or(root)), files);
    resolver.in_parts = wanted == Wanted::InParts;
    resolver.slips = slips;
    resolver.head();
    // 1. Names; look in `declare.rs` and `parameters.rs`.
    resolver.scope.dimension = dimension(root);
    resolver.sizes(sizes);
    let derived = resolver.parameters();
    resolver.tables();
    resolver.coordinates();
    let memory = resolver.memory();
    let mut noise = resolver.noise();
    let states = resolver.states();
    resolver.inputs();
    resolver.definitions();
    resolver.frames();
    let bodies = resolver.bodies();
    resolver.reactions();
    let constraints = resolver.declare_constraints();
    resolver.phases();
    if resolver.too_many_names() {
        // Names beyond the limit were not declared: what else could be said would be misleading.
        return resolver.finish();
    }
    resolver.refused_names();
    resolver.check_index_names();
    resolver.builder.settings = resolver.settings();
    // 2. Values of what has names, in whatever order they need each other; look in `resolve_values.rs`.
    let items = std::mem::take(&mut resolver.items);
    resolve_values(&mut resolver.builder, &mut resolver.scope, &items);
    resolver.finish_derived(derived);
    resolver.finish_inputs();
    resolver.finish_memory(&memory);
    resolver.sizes_of_noise(&mut noise);
    resolver.finish_states(&states);
    resolver.finish_constraints(constraints);
    // 3. Where runs start; look in `scenes.rs`.
    resolver.look_for_knots(&bodies);
    let held = resolver.scenes();
    resolver.samples();
    // 4. What has mass, and what acts on it; look in `bodies.rs`, `loads.rs` and `attachment.rs`.
    resolver.finish_bodies(&bodies);
    resolver.gravity();
    resolver.loads(&bodies);
    resolver.raw_energies();
    resolver.energies();
    resolver.balances();
    // 5. What is computed along a run; look in `watched.rs` and `draw.rs`.
    resolver.watched();
    resolver.finish_noise(&noise);
    resolver.memory_outputs();
    resolver.start_conditions(held);
    resolver.needed();
    resolver.events();
    resolver.contact_events();
    resolver.motions();
    resolver.idle_constraints();
    resolver.draw();
    resolver.cycles();
    // 6. What pictures show beside the mechanism; look in `point_forces.rs`.
    if wanted == Wanted::Forces {
        resolver.point_forces(&items);
    }
    resolver.finish()
}

/// Reads and resolves the text of a file.
///
/// # Errors
/// Everything that is wrong with it; YAML's own syntax is reported alone.
pub fn load(text: &str, sizes: &[(String, i64)]) -> Result<Model, Vec<Problem>> {
    load_in(None, text, sizes)
}

/// As [`load`], for a file in a folder, where the files of its tables are.
///
/// # Errors
/// Everything that is wrong with it and with them.
pub fn load_in(folder: Option<&Path>, text: &str, sizes: &[(String, i64)]) -> Result<Model, Vec<Problem>> {
    load_from(&Files::of_folder(folder), text, sizes)
}

/// As [`load`], with the files that it names.
///
/// # Errors
/// Everything that is wrong with it and with them.
pub fn load_from(files: &Files, text: &str, sizes: &[(String, i64)]) -> Result<Model, Vec<Problem>> {
    whole(resolve_through(&crate::file::read(text)?, sizes, files, Wanted::Model))
}

/// As [`load_from`], with the forces that act at points, [`Model::point_forces`], and the components of each, where it acts and then the
/// force, as the model's last outputs.
///
/// # Errors
/// As [`load_from`].
pub fn load_with_forces(files: &Files, text: &str, sizes: &[(String, i64)]) -> Result<Model, Vec<Problem>> {
    whole(resolve_through(&crate::file::read(text)?, sizes, files, Wanted::Forces))
}

/// As [`load_from`], with what every body does to a balance as a part of its own however many they are.
pub(crate) fn load_in_parts(files: &Files, text: &str, sizes: &[(String, i64)]) -> Result<Model, Vec<Problem>> {
    whole(resolve_through(&crate::file::read(text)?, sizes, files, Wanted::InParts))
}

/// Reads and resolves the text of a file as far as it goes: all problems, and the model wherever it can be derived and
/// judged all the same.
///
/// A model that comes with problems must not be run: its equations are those that are written, but a unit in them, or
/// something that is computed along a run, is wrong.  Sections with problems of their own may be missing from it.
///
/// ```
/// use dalembert_symbolic::model::read_through;
///
/// let text = "name: Spring\nparameters: {m: 1 kg, k: 4 N/m}\ncoordinates: {x: m}\n\
///     kinetic_energy: m*x'^2/2\npotential_energy: k*x/2";
/// let (model, problems) = read_through(text, &[]);
/// assert_eq!(problems[0].code, "E242"); // k*x/2 is no energy
/// assert!(model.is_some());             // and can be judged as it stands
/// ```
pub fn read_through(text: &str, sizes: &[(String, i64)]) -> (Option<Model>, Vec<Problem>) {
    read_through_in(None, text, sizes)
}

/// As [`read_through`], for a file in a folder, where the files of its tables are.
pub fn read_through_in(folder: Option<&Path>, text: &str, sizes: &[(String, i64)]) -> (Option<Model>, Vec<Problem>) {
    read_through_from(&Files::of_folder(folder), text, sizes)
}

/// As [`read_through`], with the files that it names.
pub fn read_through_from(files: &Files, text: &str, sizes: &[(String, i64)]) -> (Option<Model>, Vec<Problem>) {
    match crate::file::read(text) {
        Ok(root) => resolve_through(&root, sizes, files, Wanted::Model),
        Err(problems) => (None, problems),
    }
}

fn known_keys() -> impl Iterator<Item = &'static str> {
    KEYS.into_iter().chain(["scenes", "equilibrium"])
}

/// The file with its misspelt sections under the names that are meant, if it has any, and these names as written and as meant: what
/// stands in such a section is known.
fn respelt(root: &Node) -> (Option<Node>, Vec<(String, &'static str)>) {
    let Node::Map(entries) = root else { return (None, Vec::new()) };
    let is_known = |key: &str| known_keys().any(|known| known == key);
    let mut slips: Vec<(String, &'static str)> = Vec::new();
    for (key, _) in entries.iter().filter(|(key, _)| !is_known(key)) {
        let free = known_keys().filter(|known| entries.iter().all(|(key, _)| key != known));
        if let Some(meant) = nearest(key, free.filter(|known| slips.iter().all(|(_, taken)| taken != known))) {
            slips.push((key.clone(), meant));
        }
    }
    if slips.is_empty() {
        return (None, slips);
    }
    let meant =
        |key: &String| slips.iter().find(|(written, _)| written == key).map_or(key.clone(), |slip| slip.1.into());
    let respelt = entries.iter().map(|(key, node)| (meant(key), node.clone())).collect();
    (Some(Node::Map(respelt)), slips)
}

/// A name that is declared nowhere is told where it stands first, with how often it stands elsewhere.
fn told_once(problems: &mut Vec<Problem>) {
    let is_name = |problem: &Problem| problem.code == "E201";
    let mut counts: HashMap<String, usize> = HashMap::default();
    for problem in problems.iter().filter(|problem| is_name(problem)) {
        *counts.entry(problem.message.clone()).or_default() += 1;
    }
    problems.retain_mut(|problem| match counts.get_mut(&problem.message) {
        Some(0) if is_name(problem) => false,
        Some(count) if is_name(problem) => {
            match std::mem::take(count) - 1 {
                0 => {}
                1 => problem.label = format!("{}; it stands in another place too", problem.label).into(),
                more => problem.label = format!("{}; it stands in {more} other places too", problem.label).into(),
            }
            true
        }
        _ => true,
    });
}

/// Sections that no equation of motion depends on.
const OBSERVED: [&str; 8] = ["events", "conserved", "checks", "outputs", "draw", "equilibrium", "about", "motions"];

/// Whether the equations of motion are as written in spite of a problem.
pub(super) fn leaves_equations(problem: &Problem) -> bool {
    is_of_units(problem) || is_observed(problem)
}

/// Whether it is about what a run only observes, so that the equations of motion are as meant, too.
pub(crate) fn is_observed(problem: &Problem) -> bool {
    let observed = |step: &Step| matches!(step, Step::Key(key) if OBSERVED.contains(&key.as_str()));
    problem.place.path.first().is_some_and(observed)
}

impl Resolver<'_> {
    /// `name`, `about`, and keys that are unknown or not supported.
    fn head(&mut self) {
        let root = self.root.clone();
        let known: Vec<&str> = known_keys().collect();
        let problems = &mut self.builder.problems;
        for (written, meant) in &self.slips {
            let place = root.place.key(written).of_key();
            problems.push(sections::unknown_key(place, written, "the model", did_you_mean(written, [*meant])));
        }
        if !root.only(&known, "the model", problems) {
            return;
        }
        if let Some(name) = root.need("name", "the model", problems)
            && let Some(words) = name.words(problems)
        {
            let valid = words.starts_with(|c: char| c.is_ascii_uppercase())
                && words.chars().all(|c| c.is_ascii_alphanumeric())
                && words != "Self";
            if !valid {
                problems.push(sections::bad_type_name(name.place.clone(), words, type_name(words)));
            }
            words.clone_into(&mut self.model.name);
        }
        if let Some(about) = root.get("about")
            && let Some(words) = about.words(problems)
        {
            words.clone_into(&mut self.model.about);
        }
        if root.get("coordinates").is_none() && root.get("states").is_none() && !root.misspelt(problems) {
            problems.push(crate::diagnose::catalogue::mechanics::no_coordinates(Place::default()));
        }
    }

    /// What is wrong, one problem for each place and kind; and the model unless that concerns its equations.
    fn finish(mut self) -> (Option<Model>, Vec<Problem>) {
        if self.builder.graph.overflowed() && !self.builder.exhausted() {
            self.builder.problems.push(names::too_many_nodes(Place::default(), 1_000_000));
        }
        let mut problems: Vec<Problem> = Vec::new();
        let mut seen = std::collections::HashSet::new();
        for problem in self.builder.problems {
            if seen.insert((
                problem.code,
                problem.place.path.clone(),
                problem.place.key,
                problem.place.span.map(|s| s.start),
            )) {
                problems.push(problem);
            }
        }
        for problem in &mut problems {
            if let Some(Step::Key(key)) = problem.place.path.first_mut()
                && let Some((written, _)) = self.slips.iter().find(|(_, meant)| meant == key)
            {
                key.clone_from(written);
            }
        }
        told_once(&mut problems);
        if !problems.iter().all(leaves_equations) {
            return (None, problems);
        }
        self.model.dimension = self.scope.dimension;
        self.model.integrals = self.builder.integrals;
        self.model.graph = self.builder.graph;
        self.model.scope = self.scope;
        super::section::states::put_in(&mut self.model);
        (Some(self.model), problems)
    }
}
