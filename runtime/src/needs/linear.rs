//! Laws, and whole models, made linear about the place at which they rest.
//!
//! A law of a spring, damper or force stays where it is, linear in what it was written in.  A whole model becomes what a textbook
//! writes of small motions, ½ q'ᵀMq', ½ qᵀKq and ½ q'ᵀDq' with M, K and D of its rest, and is then propagated exactly.
//!
//! What has a kink or a jump is in no such model: of a bumper nothing is linear.

use dalembert_symbolic::diagnose::Step;
use dalembert_symbolic::expr::{Symbol, Tape};
use dalembert_symbolic::file::edit::{keys, replaced, source, value, with, with_scalar, without};
use dalembert_symbolic::print::{About, Degree, LinearEnergies, linear_energies, linear_law};

use super::candidate::{Candidate, rounded};
use super::edit::{Edit, entry, scalar, shown, unit_of, unused, word};
use super::full::{Full, MOST_COORDINATES};
use super::reduction::Proposal;
use crate::linear::{Guess, equilibrium_near};
use crate::mechanism::{At, SwitchKind};
use crate::run::plain;

/// What stands for all equations of motion among the ingredients.
pub(super) const EQUATIONS: &str = "equations";
/// Laws by their sections and keys.
const LAWS: [(&str, &str, Degree); 6] = [
    ("springs", "stretch", Degree::Linear),
    ("springs", "tension", Degree::Linear),
    ("springs", "energy", Degree::Quadratic),
    ("dampers", "rate", Degree::Linear),
    ("forces", "force", Degree::Linear),
    ("torques", "torque", Degree::Linear),
];
/// Energies that are sections of their own.
const ENERGIES: [&str; 3] = ["kinetic_energy", "potential_energy", "dissipation"];
/// Sections in whose place linear energies stand.
const REPLACED: [&str; 6] = ["gravity", "springs", "dampers", "forces", "torques", "generalized_forces"];

/// Each law that is not linear, and all equations of motion, about the place near which the motion goes on; none where it rests nowhere.
pub(super) fn linear(full: &Full) -> Vec<Candidate> {
    let coordinates = &full.system.description().coordinates;
    let Some(rest) = full.rest.as_ref().filter(|_| coordinates.len() <= MOST_COORDINATES) else { return Vec::new() };
    let text = &full.source;
    let (named, mut places) = named(text, uses_units(full));
    let [signs, modes] = kept(full, rest);
    let mut about = About { signs, modes, ..About::default() };
    for (coordinate, place) in coordinates.iter().zip(rest) {
        let name = (*place != 0.0).then(|| unused(text, &format!("{}_rest", coordinate.name)));
        // A member of a family has a name that no parameter can have.
        if name.as_ref().is_some_and(|name| name.contains('[')) {
            return Vec::new();
        }
        if let Some(name) = &name {
            places.push(parameter(name, *place, &unit_of(text, &coordinate.name)));
        }
        about.coordinates.push(name);
    }
    let mut found: Vec<Candidate> = laws(full, &about, rest).collect();
    if !full.program.structure.linear {
        let whole = if places.is_empty() { None } else { full.compiled(&named).ok() };
        found.extend(linear_energies(whole.as_ref().unwrap_or(&full.program), &about).map(|energies| Candidate {
            ingredient: EQUATIONS.to_owned(),
            proposal: Proposal::Linear,
            edits: vec![Edit::Linear(energies)],
        }));
    }
    for candidate in &mut found {
        let read = |place: &&Edit| matches!(place, Edit::Parameter { name, .. } if candidate.edits[0].reads(name));
        let read: Vec<Edit> = places.iter().filter(read).cloned().collect();
        candidate.edits.extend(read);
    }
    found
}

/// Values with units that stand where one value is wanted, by their sections and keys, and the unit that one has without it; of springs that depends on what
/// they act on.
const VALUES: [(&str, &str, &str); 5] = [
    ("springs", "stiffness", ""),
    ("springs", "rest", ""),
    ("dampers", "damping", ""),
    ("bodies", "mass", "kg"),
    ("bodies", "inertia", "kg*m^2"),
];

/// Whether a model has quantities: in one of pure numbers alone a bare number has no unit anywhere.
fn uses_units(full: &Full) -> bool {
    full.system.description().parameters.iter().any(|parameter| !matches!(&*parameter.unit, "" | "1" | "rad"))
}

/// The file with these values as parameters, since a formula has no place for a unit, and these parameters.
fn named(text: &str, uses_units: bool) -> (String, Vec<Edit>) {
    let key = |name: &str| Step::Key(name.to_owned());
    let of_entries = VALUES.into_iter().flat_map(|(section, value, unit)| {
        let entries = keys(text, &[key(section)]).into_iter();
        entries.flat_map(move |name| {
            let owner = name.split('[').next().unwrap_or(&name).to_owned();
            let path = [entry(section, &name).as_slice(), &[key(value)]].concat();
            // Of a list, moments of inertia in space, each.
            let items = ["x", "y", "z"].into_iter().enumerate().map({
                let (path, owner) = (path.clone(), owner.clone());
                move |(k, axis)| ([path.as_slice(), &[Step::Index(k)]].concat(), format!("{owner}_{value}_{axis}"))
            });
            let all: Vec<_> = std::iter::once((path.clone(), format!("{owner}_{value}"))).chain(items).collect();
            all.into_iter().map(move |(path, name)| (path, name, unit))
        })
    });
    let gravity = ["x", "y", "z"].into_iter().enumerate();
    let gravity =
        gravity.map(|(index, axis)| (vec![key("gravity"), Step::Index(index)], format!("gravity_{axis}"), "m/s^2"));
    let (mut named, mut parameters) = (text.to_owned(), Vec::new());
    for (path, name, unit) in of_entries.chain(gravity) {
        let Some(written) = value(text, &path) else { continue };
        let bare = written.parse::<f64>().is_ok_and(|number| number != 0.0);
        let written = if bare && uses_units && !unit.is_empty() { format!("{written} {unit}") } else { written };
        let is_quantity =
            written.split_once(' ').is_some_and(|(number, unit)| number.parse::<f64>().is_ok() && !unit.is_empty());
        let name = unused(&named, &name);
        let Some(changed) = replaced(&named, &path, &name).filter(|_| is_quantity) else { continue };
        let Some(changed) = with(&changed, "parameters", "name", &name, &written) else { continue };
        named = changed;
        parameters.push(Edit::Parameter { name, value: written });
    }
    (named, parameters)
}

/// The signs of coordinates, and the modes of `sign` and `abs`, of what stays farther from 0 than it moves, as a distance does; `None` of
/// others: of a bumper that is out of reach nothing is said by leaving it out of everything.
fn kept(full: &Full, rest: &[f64]) -> [Vec<Option<i64>>; 2] {
    let switches = &full.system.description().switches;
    let n = rest.len();
    let values = |q: &[f64]| {
        let mut pairs = vec![f64::NAN; 2 * switches.len()];
        full.system.switches(At::new(full.settings.from, q, &vec![0.0; n]), &mut pairs);
        let arguments = pairs.chunks_exact(2).map(|pair| pair[0]);
        q.iter().copied().chain(arguments).collect::<Vec<f64>>()
    };
    let here = values(rest);
    let [one, other] = &full.motion.visited;
    let visited: Vec<Vec<f64>> = [&full.motion.first, one, other].into_iter().map(|y| values(&y[..n])).collect();
    let sign = |k: usize| {
        let moved = visited.iter().map(|values| (values[k] - here[k]).abs()).fold(0.0, f64::max);
        (here[k].abs() > moved).then_some(if here[k] > 0.0 { 1 } else { -1 })
    };
    let mode = |k: usize| sign(n + k).filter(|_| switches[k].kind == SwitchKind::Sign);
    [(0..n).map(sign).collect(), (0..switches.len()).map(mode).collect()]
}

/// Every law of its own.
fn laws<'a>(full: &'a Full, about: &'a About, rest: &'a [f64]) -> impl Iterator<Item = Candidate> + 'a {
    let text = &full.source;
    let section = |name: &str| vec![Step::Key(name.to_owned())];
    let entries = LAWS.into_iter().flat_map(move |(section, key, degree)| {
        let of = keys(text, &[Step::Key(section.to_owned())]).into_iter().map(move |name| entry(section, &name));
        of.map(move |entry| ([entry.as_slice(), &[Step::Key(key.to_owned())]].concat(), entry, degree))
    });
    let forces = keys(text, &section("generalized_forces")).into_iter().map(|name| {
        let path = entry("generalized_forces", &name);
        (path.clone(), path, Degree::Linear)
    });
    let energies = ENERGIES.map(section).map(|path| (path.clone(), path, Degree::Quadratic));
    entries.chain(forces).chain(energies).filter_map(move |(path, entry, degree)| {
        let written = value(text, &path)?;
        let mut about = about.clone();
        let mut edits = Vec::new();
        if word(&written, "length").is_some() {
            let name = unused(text, &format!("{}_length", entry.last().map(step)?));
            edits.push(parameter(&name, distance(full, &entry, rest)?, "m"));
            about.length = Some(name);
        }
        let law = linear_law(&full.program, &written, degree, &about)?;
        let value = if law.len() == 1 { law[0].clone() } else { format!("[{}]", law.join(", ")) };
        edits.insert(0, Edit::Replace { path, value: scalar(&value) });
        Some(Candidate { ingredient: shown(&entry), proposal: Proposal::Linear, edits })
    })
}

fn step(step: &Step) -> String {
    shown(std::slice::from_ref(step))
}

fn parameter(name: &str, value: f64, unit: &str) -> Edit {
    let value = format!("{} {unit}", plain(value)).trim_end().to_owned();
    Edit::Parameter { name: name.to_owned(), value }
}

/// How far the ends of a spring are from each other at rest.
fn distance(full: &Full, spring: &[Step], rest: &[f64]) -> Option<f64> {
    let end =
        |index: usize| value(&full.source, &[spring, &[Step::Key("between".to_owned()), Step::Index(index)]].concat());
    let model = &mut full.program.model.clone();
    let length = model.expression(&format!("norm({} - {})", end(0)?, end(1)?)).ok()?;
    let parameters = full.system.parameters();
    let known = |symbol: Symbol| match symbol {
        Symbol::Parameter(k) => parameters[k as usize],
        Symbol::Coordinate(i) => rest[i as usize],
        _ => 0.0,
    };
    let length: f64 = Tape::new(&model.graph, &length).evaluate(known).into_iter().next()?;
    (length > 0.0 && length.is_finite()).then(|| rounded(length, length))
}

/// The place at which a mechanism rests near the middle of its motion, to nine digits, while its inputs are 0; `None` where there is
/// none, where dry friction holds it, and where forces depend on t.
pub(super) fn resting(full: &Full) -> Option<Vec<f64>> {
    let n = full.system.len();
    let found = equilibrium_near(&*full.system, &Guess::at(&full.motion.means[..n])).ok()?;
    let settled = found.friction.is_empty() && found.v.iter().all(|v| *v == 0.0);
    settled.then(|| found.q.iter().zip(&full.motion.ranges).map(|(q, range)| rounded(*q, *range)).collect())
}

/// The file with linear energies in the place of all that makes its equations of motion; bodies of which something else of the file speaks
/// stay as points, or without mass where they have an angle.  `None` where it is not written so that they can be put in.
pub(super) fn by_energies(text: &str, energies: &LinearEnergies) -> Option<String> {
    let LinearEnergies { kinetic, potential, dissipation, forces } = energies;
    let mut text = text.to_owned();
    for section in REPLACED.into_iter().chain(ENERGIES).chain(["balances"]) {
        text = without(&text, &[Step::Key(section.to_owned())]).unwrap_or(text);
    }
    for body in keys(&text, &[Step::Key("bodies".to_owned())]) {
        text = without_mass(&text, &body)?;
    }
    for (coordinate, force) in forces.iter().rev() {
        text = with(&text, "generalized_forces", "coordinates", &scalar(coordinate), &scalar(force))?;
    }
    let written = [Some(kinetic), potential.as_ref(), dissipation.as_ref()];
    for (section, formula) in ENERGIES.into_iter().zip(written).rev() {
        if let Some(formula) = formula {
            text = with_scalar(&text, "coordinates", section, &scalar(formula))?;
        }
    }
    Some(text)
}

/// The file without a body, or with one that moves no mass where something speaks of it.
fn without_mass(text: &str, body: &str) -> Option<String> {
    let path = entry("bodies", body);
    let rest = without(text, &path)?;
    if word(&rest, body.split('[').next()?).is_none() {
        return Some(rest);
    }
    let key = |name: &str| [path.as_slice(), &[Step::Key(name.to_owned())]].concat();
    if source(text, &key("angle")).is_none() {
        let position = source(text, &key("position"))?;
        return with(&rest, "points", "coordinates", &scalar(body), position);
    }
    let text = replaced(text, &key("mass"), "0")?;
    if source(&text, &key("inertia")).is_some() { replaced(&text, &key("inertia"), "0") } else { Some(text) }
}
