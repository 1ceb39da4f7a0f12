//! From the tree of a file to a model: the passes in order.

use super::identifier::type_name;
use super::resolved::Model;
use super::resolver::Resolver;
use super::section::declare::dimension;
use super::section::settle::settle;
use crate::diagnose::catalogue::{later, names, sections};
use crate::diagnose::{Place, Problem};
use crate::file::{Node, Spot};

/// Every key that a model file may have.
const KEYS: [&str; 29] = [
    "name",
    "about",
    "sizes",
    "parameters",
    "coordinates",
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
    "phases",
    "events",
    "balances",
    "conserved",
    "checks",
    "sample",
    "outputs",
    "draw",
    "scene",
];

/// Resolves a file: names to symbols, families to members, sections to mechanics.
///
/// `sizes` replace the file's own.
///
/// # Errors
/// Everything that is wrong with the file.
pub fn resolve(root: &Node, sizes: &[(String, i64)]) -> Result<Model, Vec<Problem>> {
    let mut resolver = Resolver::new(Spot::root(root));
    resolver.head();
    // 1. Names; look in `declare.rs` and `parameters.rs`.
    resolver.scope.dimension = dimension(root);
    resolver.sizes(sizes);
    let derived = resolver.parameters();
    resolver.coordinates();
    resolver.inputs();
    resolver.definitions();
    resolver.frames();
    let bodies = resolver.bodies();
    resolver.reactions();
    if resolver.too_many_names() {
        // Names beyond the limit were not declared: what else could be said would be misleading.
        return resolver.finish();
    }
    resolver.refused_names();
    resolver.check_index_names();
    // 2. Values of what has names, in whatever order they need each other; look in `settle.rs`.
    let items = std::mem::take(&mut resolver.items);
    settle(&mut resolver.bench, &mut resolver.scope, &items);
    resolver.finish_derived(derived);
    resolver.finish_inputs();
    // 3. Where runs start; look in `scenes.rs`.
    resolver.scenes();
    resolver.samples();
    // 4. What has mass, and what acts on it; look in `bodies.rs`, `loads.rs` and `carriers.rs`.
    resolver.finish_bodies(bodies);
    resolver.gravity();
    resolver.loads();
    resolver.raw_energies();
    resolver.energies();
    resolver.balances();
    // 5. What is computed along a run; look in `watched.rs` and `draw.rs`.
    resolver.watched();
    resolver.events();
    resolver.draw();
    resolver.finish()
}

/// Reads and resolves the text of a file.
///
/// # Errors
/// Everything that is wrong with it; YAML's own syntax is reported alone.
pub fn load(text: &str, sizes: &[(String, i64)]) -> Result<Model, Vec<Problem>> {
    resolve(&crate::file::read(text)?, sizes)
}

impl Resolver<'_> {
    /// `name`, `about`, and keys that are unknown or not supported.
    fn head(&mut self) {
        let root = self.root.clone();
        let known: Vec<&str> = KEYS.into_iter().chain(["scenes", "equilibrium"]).collect();
        let problems = &mut self.bench.problems;
        if !root.only(&known, "the model", problems) {
            return;
        }
        for key in ["constraints", "phases"] {
            if let Some(spot) = root.get(key) {
                problems.push(later::key_not_supported(spot.place.of_key(), key, "the model"));
            }
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
        if root.get("coordinates").is_none() && !root.misspelt(problems) {
            problems.push(crate::diagnose::catalogue::mechanics::no_coordinates(Place::default()));
        }
    }

    /// The model, or what is wrong: one problem for each place and kind.
    fn finish(mut self) -> Result<Model, Vec<Problem>> {
        if self.bench.graph.overflowed() && !self.bench.exhausted() {
            self.bench.problems.push(names::too_many_nodes(Place::default(), 1_000_000));
        }
        let mut problems: Vec<Problem> = Vec::new();
        let mut seen = std::collections::HashSet::new();
        for problem in self.bench.problems {
            if seen.insert((
                problem.code,
                problem.place.path.clone(),
                problem.place.key,
                problem.place.span.map(|s| s.start),
            )) {
                problems.push(problem);
            }
        }
        if !problems.is_empty() {
            return Err(problems);
        }
        self.model.dimension = self.scope.dimension;
        self.model.graph = self.bench.graph;
        self.model.scope = self.scope;
        Ok(self.model)
    }
}
