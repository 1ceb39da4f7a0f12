//! The file without an ingredient.

use dalembert_symbolic::diagnose::{Problem, Step};
use dalembert_symbolic::file::edit::{keys, replaced, rewritten, source, value, with, with_at, without};
use dalembert_symbolic::lower::Program;
use dalembert_symbolic::print::LinearEnergies;

use super::constrained::constrained;
use super::linear::by_energies;
use super::modal::{Modes, by_modes};
use super::rigid::Rigid;

/// A change of a model file.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Edit {
    /// What stands at this path goes.
    Remove(Vec<Step>),
    /// What stands at this path is a value instead.
    Replace { path: Vec<Step>, value: String },
    /// A coordinate becomes a definition that keeps a value.
    Hold { coordinate: String, value: String },
    /// A coordinate becomes a definition; `moves` says whether anything in its place moves.
    Slave { coordinate: String, place: String, moves: bool },
    /// A family of coordinates becomes a definition by modes.
    ByModes(Modes),
    /// A parameter more, if it is not there yet.
    Parameter { name: String, value: String },
    /// What is stiff becomes a constraint.
    Rigid(Rigid),
    /// All equations of motion become those of these energies.
    Linear(LinearEnergies),
}

impl Edit {
    /// Whether a name stands in the formulas that it writes.
    pub fn reads(&self, name: &str) -> bool {
        let reads = |formula: &String| word(formula, name).is_some();
        match self {
            Edit::Replace { value, .. } | Edit::Hold { value, .. } => reads(value),
            Edit::Slave { place, .. } => reads(place),
            Edit::Linear(LinearEnergies { kinetic, potential, dissipation, forces }) => {
                let energies = [Some(kinetic), potential.as_ref(), dissipation.as_ref()];
                energies.into_iter().flatten().chain(forces.iter().map(|(_, force)| force)).any(reads)
            }
            Edit::Remove(_) | Edit::ByModes(_) | Edit::Rigid(_) | Edit::Parameter { .. } => false,
        }
    }
}

/// What goes with an ingredient, and why.
pub(super) type Gone = (String, String);

/// Sections of what a file claims, shows and compares: what cannot stay in them goes with an ingredient.
const CLAIMS: [&str; 7] = ["balances", "conserved", "checks", "draw", "outputs", "equilibrium", "motions"];
/// So much goes with an ingredient at most.
const MOST_GONE: usize = 12;

/// The path of an entry of a section.
pub(super) fn entry(section: &str, name: &str) -> Vec<Step> {
    [section, name].map(|key| Step::Key(key.to_owned())).to_vec()
}

/// `springs.tyre`.
pub(super) fn shown(path: &[Step]) -> String {
    let step = |step: &Step| match step {
        Step::Key(name) => name.clone(),
        Step::Index(index) => (index + 1).to_string(),
    };
    path.iter().map(step).collect::<Vec<_>>().join(".")
}

/// The file with all edits; `None` where one cannot be made.
pub(super) fn edited(text: &str, edits: &[Edit]) -> Option<String> {
    edits.iter().try_fold(text.to_owned(), |text, edit| match edit {
        Edit::Remove(path) => without(&text, path),
        Edit::Replace { path, value } => replaced(&text, path, value),
        Edit::Hold { coordinate, value } => hold(&text, coordinate, value),
        Edit::Slave { coordinate, place, moves } => slave(&text, coordinate, place, *moves),
        Edit::ByModes(modes) => by_modes(&text, modes),
        Edit::Rigid(rigid) => constrained(&text, rigid),
        Edit::Parameter { name, .. } if source(&text, &entry("parameters", name)).is_some() => Some(text),
        Edit::Parameter { name, value } => with(&text, "parameters", "name", name, value),
        Edit::Linear(energies) => by_energies(&text, energies),
    })
}

/// The file with other sizes.
pub(super) fn with_sizes(text: &str, sizes: &[(String, i64)]) -> String {
    let sized = |text: String, (name, size): &(String, i64)| {
        replaced(&text, &entry("sizes", name), &size.to_string()).unwrap_or(text)
    };
    sizes.iter().fold(text.to_owned(), sized)
}

/// The file with another value of a free parameter, as it is written, in a scene too; `None` where it has none of this name.
pub(super) fn with_parameter(text: &str, scene: Option<&str>, name: &str, value: &str) -> Option<String> {
    let own = [scene_path(scene).as_slice(), &[key("set"), key(name)]].concat();
    let text = without(text, &own).unwrap_or_else(|| text.to_owned());
    replaced(&text, &entry("parameters", name), value)
}

fn scene_path(scene: Option<&str>) -> Vec<Step> {
    scene.map_or(vec!["scene"], |name| vec!["scenes", name]).into_iter().map(key).collect()
}

/// The file with another start of a coordinate or speed in a scene; `None` where the scene is not in lines or brackets.
pub(super) fn with_start(text: &str, scene: Option<&str>, name: &str, value: &str) -> Option<String> {
    let scene = scene_path(scene);
    let start = [scene.as_slice(), &[key("start")]].concat();
    let own = [start.as_slice(), &[key(name)]].concat();
    if source(text, &own).is_some() {
        return replaced(text, &own, value);
    }
    match source(text, &start) {
        Some(_) => with_at(text, &start, name, value),
        None => with_at(text, &scene, "start", &format!("{{{name}: {value}}}")),
    }
}

/// The file with another end of a scene; `None` where the scene is not in lines or brackets.
pub(super) fn with_until(text: &str, scene: Option<&str>, value: &str) -> Option<String> {
    let scene = scene_path(scene);
    let own = [scene.as_slice(), &[key("until")]].concat();
    if source(text, &own).is_some() { replaced(text, &own, value) } else { with_at(text, &scene, "until", value) }
}

pub(super) fn key(name: &str) -> Step {
    Step::Key(name.to_owned())
}

/// A name that the file does not have yet.
pub(super) fn unused(text: &str, name: &str) -> String {
    let mut name = name.to_owned();
    while text.contains(&name) {
        name.push('_');
    }
    name
}

/// The smaller file without free parameters that the full one reads and that stand nowhere in it any more.
pub(super) fn without_idle_parameters(mut text: String, full: &str) -> String {
    let read = |text: &str, name: &str| {
        let others = without(text, &entry("parameters", name));
        others.is_some_and(|others| word(&without_comments(&others), name).is_some())
    };
    // One that only others are computed from goes after these.
    loop {
        let names = keys(&text, &[key("parameters")]);
        let idle = names.iter().find(|name| read(full, name) && !read(&text, name));
        let Some(less) = idle.and_then(|name| without(&text, &entry("parameters", name))) else { return text };
        text = less;
    }
}

/// Lines without what a `#` behind a blank begins.
fn without_comments(text: &str) -> String {
    let code = |line: &str| match line.find(" #") {
        _ if line.starts_with('#') => String::new(),
        Some(at) => line[..at].to_owned(),
        None => line.to_owned(),
    };
    text.lines().map(code).collect::<Vec<String>>().join("\n")
}

/// A formula as a scalar of YAML, wherever it stands.
pub(super) fn scalar(formula: &str) -> String {
    let plain = !formula.contains(['[', ']', '{', '}', ',', '#', ':', '"']) && !formula.starts_with(['-', '*', '&']);
    if plain { formula.to_owned() } else { format!("\"{formula}\"") }
}

/// z leaves `coordinates`, every start and guess, and what acts on it alone; `define: {z: z_held}` takes its place, with `z_held` a
/// parameter, and 0 that of z' and z''.
fn hold(text: &str, coordinate: &str, value: &str) -> Option<String> {
    let text = without(text, &entry("generalized_forces", coordinate)).unwrap_or_else(|| text.to_owned());
    let name = unused(&text, &format!("{coordinate}_held"));
    let text = defined(&text, coordinate, &name, |_| "0".to_owned())?;
    with(&text, "parameters", "name", &name, value)
}

/// As [`hold`], with a formula in the place of the value; z' becomes `rate(z)` where that moves.  `None` where a generalized force
/// on z would go with it.
fn slave(text: &str, coordinate: &str, place: &str, moves: bool) -> Option<String> {
    if source(text, &entry("generalized_forces", coordinate)).is_some() {
        return None;
    }
    let rate = |order: usize| format!("{}{coordinate}{}", "rate(".repeat(order), ")".repeat(order));
    defined(text, coordinate, place, |order| if moves { rate(order) } else { "0".to_owned() })
}

/// A coordinate becomes a definition, and leaves all that starts or guesses it; `rate` writes its first and second rate.
fn defined(text: &str, coordinate: &str, place: &str, rate: impl Fn(usize) -> String) -> Option<String> {
    let mut text = without(text, &entry("coordinates", coordinate))?;
    let scenes = keys(&text, &[key("scenes")]);
    let places = std::iter::once(vec![key("scene")]).chain(scenes.iter().map(|name| vec![key("scenes"), key(name)]));
    for place in places.collect::<Vec<_>>() {
        for (section, prime) in [("start", ""), ("start", "'"), ("guess", "")] {
            let name = format!("{coordinate}{prime}");
            let path = [place.as_slice(), &[key(section), key(&name)]].concat();
            text = without(&text, &path).unwrap_or(text);
        }
    }
    text = without(&text, &entry("equilibrium", coordinate)).unwrap_or(text);
    let written = |scalar: &str| {
        let mut scalar = scalar.to_owned();
        for (order, primed) in [(2, format!("{coordinate}''")), (1, format!("{coordinate}'"))] {
            while let Some(at) = word(&scalar, &primed) {
                scalar.replace_range(at..at + primed.len(), &rate(order));
            }
        }
        scalar
    };
    text = rewritten(&text, written)?;
    with(&text, "define", "coordinates", coordinate, place)
}

/// Where a name, or its rate, stands as a word of its own.
pub(super) fn word(text: &str, name: &str) -> Option<usize> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let whole = |(at, _): &(usize, &str)| {
        let (before, after) = (text[..*at].chars().next_back(), text[at + name.len()..].chars().next());
        !before.is_some_and(is_part) && !after.is_some_and(|c| is_part(c) || c == '\'' && name.ends_with('\''))
    };
    text.match_indices(name).find(whole).map(|(at, _)| at)
}

/// The unit that a file writes behind a coordinate.
pub(super) fn unit_of(text: &str, coordinate: &str) -> String {
    value(text, &entry("coordinates", coordinate)).unwrap_or_default()
}

/// What of the file's claims a problem is about, and why it cannot stay: a system of balances, one claim, one output, what
/// is drawn as a whole, and scenes other than the one that is asked about.
pub(super) fn claim(text: &str, problem: &Problem, asked: &[Step]) -> Option<(Vec<Step>, String)> {
    let path = &problem.place.path;
    let Some(Step::Key(section)) = path.first() else { return None };
    if problem.is_warning() {
        return None;
    }
    if matches!(section.as_str(), "scene" | "scenes") && !path.starts_with(asked) {
        return of_other_scene(path).map(|path| (path, problem.message.clone()));
    }
    if !CLAIMS.contains(&section.as_str()) {
        return None;
    }
    let single = section == "balances" && keys(text, &path[..1]).iter().any(|key| key == "equations");
    let long = if section == "draw" || single { 1 } else { 2.min(path.len()) };
    let path = path[..long].to_vec();
    source(text, &path)?;
    Some((path, problem.message.clone()))
}

/// What cannot stay of a scene that is not asked about: what it is run for, or else the scene, if it has a name.
fn of_other_scene(path: &[Step]) -> Option<Vec<Step>> {
    let is_named = path.first() == Some(&key("scenes"));
    let scene = path.get(..if is_named { 2 } else { 1 })?;
    match path.get(scene.len()) {
        Some(within) if *within == key("needs") => Some([scene, &[key("needs")]].concat()),
        _ => is_named.then(|| scene.to_vec()),
    }
}

/// The code of balances that are not as many as unknowns.
const UNEQUAL: &str = "E414";
/// Systems of more equations go as a whole.
const MOST_EQUATIONS: usize = 8;

/// The file less one equation of a system of balances, the first without which it compiles.
fn with_one_less(
    text: &str,
    system: &[Step],
    compile: &mut impl FnMut(&str) -> Result<Program, Vec<Problem>>,
) -> Option<(Vec<Step>, Program, String)> {
    let equation = |index: usize| [system, &[key("equations"), Step::Index(index)]].concat();
    let paths = (0..MOST_EQUATIONS).map(equation).take_while(|path| source(text, path).is_some());
    if source(text, &equation(MOST_EQUATIONS)).is_some() {
        return None;
    }
    let tried = |path: Vec<Step>| {
        let less = without(text, &path)?;
        compile(&less).ok().map(|program| (path, program, less))
    };
    paths.collect::<Vec<_>>().into_iter().find_map(tried)
}

/// The file less what it claims in vain, given what compiles, and as a program; with what went, and why.  What is asked about is one scene.
///
/// # Errors
/// The first problem that is about something else, or about an output that is wanted.
pub(super) fn without_vain_claims(
    (text, scene): (String, Option<&str>),
    is_wanted: impl Fn(&str) -> bool,
    mut compile: impl FnMut(&str) -> Result<Program, Vec<Problem>>,
) -> Result<(String, Program, Vec<Gone>), String> {
    let (mut text, mut gone, asked) = (text, Vec::new(), scene_path(scene));
    loop {
        let problems = match compile(&text) {
            Ok(program) => return Ok((text, program, gone)),
            Err(problems) => problems,
        };
        let words = |problem: &Problem| match problem.code {
            "E201" => "the rest of the file lacks a name".to_owned(),
            _ => problem.message.clone(),
        };
        let said = || problems.first().map_or_else(String::new, words);
        let claims: Vec<_> =
            problems.iter().filter(|problem| !problem.is_warning()).map(|p| (claim(&text, p, &asked), p)).collect();
        if gone.len() >= MOST_GONE || claims.is_empty() {
            return Err(said());
        }
        if let Some((_, problem)) = claims.iter().find(|(claim, _)| claim.is_none()) {
            return Err(words(problem));
        }
        let Some((path, why)) = claims.into_iter().find_map(|(claim, _)| claim) else { return Err(said()) };
        if let [Step::Key(section), Step::Key(output)] = path.as_slice()
            && section == "outputs"
            && is_wanted(output)
        {
            return Err(format!("`{output}` is wanted and reads it: {why}"));
        }
        // Of balances that are too many one goes, if the others still determine the motion.
        let uneven = problems.iter().any(|problem| problem.code == UNEQUAL && problem.place.path.starts_with(&path));
        if let Some((path, program, less)) = uneven.then(|| with_one_less(&text, &path, &mut compile)).flatten() {
            gone.push((shown(&path), why));
            return Ok((less, program, gone));
        }
        text = without(&text, &path).ok_or_else(said)?;
        gone.push((shown(&path), why));
    }
}
