//! What is stiff as a constraint: a spring that keeps its length, and a coordinate whose reaction outputs read.
//!
//! A spring between two points becomes `constraints: {cord_rigid: "norm(O - bob) = cord_length"}`, at its rest length and at that
//! at which all rests.  Outputs that are its tension become the constraint's reaction.  What it gives way is predicted from the smaller
//! model's motion: that is run again with the length that its own reaction would pull the spring to, and the stiff model never.
//!
//! A coordinate that wanted outputs read stays one, held by a constraint; outputs read it where the reaction moves it, over its
//! stiffness: `l` becomes `(l - reaction(l_rigid)/l_stiffness)`.

use std::sync::Arc;

use dalembert_symbolic::diagnose::Step;
use dalembert_symbolic::expr::{Id, Symbol, Tape};
use dalembert_symbolic::file::edit::{keys, replaced, source, value, with};
use dalembert_symbolic::model::Model;

use super::below::rate_of;
use super::candidate::{Candidate, resting, rounded};
use super::channel::Channel;
use super::deviation::{Motion, TIMES, largest};
use super::edit::{Edit, entry, key, scalar, shown, unit_of, unused, word};
use super::full::{Full, MOST_COORDINATES, set};
use super::prediction::{Law, Prediction};
use super::reduction::{Answer, Proposal};
use crate::mechanism::At;
use crate::mechanism::dense::{force_slopes, mass_matrix};
use crate::run::plain;

/// A constraint in the place of what is stiff.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Rigid {
    /// Its label.
    pub label: String,
    /// What it keeps, as the file would say.
    pub equation: String,
    /// A parameter more, and its value.
    pub parameters: Vec<(String, String)>,
    /// The entry that goes.
    pub gone: Option<Vec<Step>>,
    /// Which coordinates the start only guesses, and all of them.
    pub guessed: Vec<String>,
    pub coordinates: Vec<String>,
    /// Outputs by their paths, and what they read now.
    pub outputs: Vec<(Vec<Step>, String)>,
    /// Of a spring: its ends' distance, its stiffness, its rest length, and the length that is kept.
    pub spring: Option<Spring>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Spring {
    distance: String,
    stiffness: f64,
    rest: f64,
    kept: f64,
}

/// A spring is tried where its length changes by less than this part of it.
const STEADY: f64 = 0.1;
/// What is proportional is so to this part.
const ALIKE: f64 = 1e-9;

/// Every spring between two points as a constraint, and all together, since one that is left keeps the model stiff.
pub(super) fn springs(full: &Full) -> Vec<Candidate> {
    let Some(coordinates) = single(full) else { return Vec::new() };
    let own = keys(&full.source, &[key("springs")]);
    let own = own.iter().filter(|name| !name.contains('['));
    let each: Vec<Vec<Candidate>> = own.filter_map(|name| spring(full, &coordinates, name)).collect();
    let settled: Vec<&Candidate> = each.iter().filter_map(|lengths| lengths.last()).collect();
    let lengths: Vec<&str> = settled.iter().filter_map(|one| one.proposal.place()).collect();
    let all = (settled.len() > 1).then(|| Candidate {
        ingredient: "springs".to_owned(),
        proposal: Proposal::Rigid { at: lengths.join(", ") },
        edits: settled.iter().flat_map(|one| one.edits.clone()).collect(),
    });
    each.into_iter().flatten().chain(all).collect()
}

/// The coordinates, where a constraint more leaves the start what it is: without phases and families.
fn single(full: &Full) -> Option<Vec<String>> {
    let description = full.system.description();
    let names: Vec<String> = description.coordinates.iter().map(|c| c.name.to_string()).collect();
    let plain = names.iter().all(|name| !name.contains('['));
    (plain && description.phases.len() < 2 && names.len() <= MOST_COORDINATES).then_some(names)
}

fn spring(full: &Full, coordinates: &[String], name: &str) -> Option<Vec<Candidate>> {
    let (text, path) = (&full.source, entry("springs", name));
    let of = |more: &[Step]| value(text, &[path.as_slice(), more].concat());
    let end = |index: usize| {
        let end = [key("between"), Step::Index(index)];
        of(&end).or_else(|| of(&[end.as_slice(), &[key("at")]].concat()))
    };
    let (stiffness, rest) = (of(&[key("stiffness")])?, of(&[key("rest")])?);
    if source(text, &[path.as_slice(), &[key("phase")]].concat()).is_some() {
        return None;
    }
    let distance = format!("norm({} - {})", wrapped(&end(0)?), wrapped(&end(1)?));
    let mut model = full.program.model.clone();
    let tension = format!("({stiffness})*({distance} - ({rest}))");
    let [length, stiff, slack] = [&distance, &stiffness, &rest].map(|formula| model.expression(formula).ok());
    let (length, stiff, slack) = (length?, stiff?, slack?);
    let states = [&full.settings.q, &full.motion.visited[0], &full.motion.visited[1]];
    let at = |q: &[f64]| evaluated(full, &model, &length, q);
    let lengths = states.iter().map(|q| at(q)).collect::<Option<Vec<f64>>>()?;
    let still = vec![0.0; coordinates.len()];
    let (stiff, slack) = (evaluated(full, &model, &stiff, &still)?, evaluated(full, &model, &slack, &still)?);
    let (low, high) = lengths.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), l| (l.min(low), l.max(high)));
    if !(slack > 0.0 && stiff > 0.0 && low > 0.0 && high - low <= STEADY * high) {
        return None;
    }
    let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
    let rest_at = full.rest.as_ref().and_then(|q| at(q)).unwrap_or(mean);
    let settled = if (rest_at - mean).abs() <= STEADY * mean { rest_at } else { mean };
    let guessed = read(&model, &length, coordinates);
    let outputs = tensions(full, &mut model, &tension, name);
    let candidate = |kept: f64| {
        let kept = rounded(kept, kept);
        let length = unused(text, &format!("{name}_length"));
        let label = unused(text, &format!("{name}_rigid"));
        let at = format!("{} m", plain(kept));
        let rigid = Rigid {
            equation: format!("{distance} = {length}"),
            label,
            parameters: vec![(length, at.clone())],
            gone: Some(path.clone()),
            guessed: guessed.clone(),
            coordinates: coordinates.to_vec(),
            outputs: outputs.clone(),
            spring: Some(Spring { distance: distance.clone(), stiffness: stiff, rest: slack, kept }),
        };
        Candidate { ingredient: shown(&path), proposal: Proposal::Rigid { at }, edits: vec![Edit::Rigid(rigid)] }
    };
    let mut kept = vec![slack];
    kept.extend(((settled - slack).abs() > ALIKE * slack).then_some(settled));
    Some(kept.into_iter().map(candidate).collect())
}

/// A name as it is, anything else in parentheses.
fn wrapped(formula: &str) -> String {
    let is_name = formula.chars().all(|c| c.is_alphanumeric() || c == '_');
    if is_name || formula.starts_with('[') { formula.to_owned() } else { format!("({formula})") }
}

/// Each coordinate that wanted outputs read, held by a constraint whose reaction they read too.
pub(super) fn coordinates(full: &Full) -> Vec<Candidate> {
    let Some(names) = single(full).filter(|names| names.len() > 1) else { return Vec::new() };
    if !full.system.description().rows.is_empty() {
        return Vec::new();
    }
    (0..names.len()).filter_map(|index| coordinate(full, &names, index)).collect()
}

fn coordinate(full: &Full, names: &[String], index: usize) -> Option<Candidate> {
    let (text, name) = (&full.source, &names[index]);
    // What is wanted itself gives way.
    if full.need.outputs.iter().any(|wanted| wanted.trim_end_matches('\'') == name) {
        return None;
    }
    let outputs: Vec<(Vec<Step>, String)> = keys(text, &[key("outputs")])
        .iter()
        .filter(|output| full.need.outputs.iter().any(|wanted| is_of(wanted, output)))
        .filter_map(|output| {
            let path = entry("outputs", output);
            let written = value(text, &path)?;
            word(&written, name).is_some().then_some((path, written))
        })
        .collect();
    if outputs.is_empty() {
        return None;
    }
    let (n, place) = (names.len(), rounded(resting(full, index)?, full.motion.ranges[index]));
    let (mut q, still) = (full.settings.q.clone(), vec![0.0; n]);
    q[index] = place;
    let at = At::new(full.settings.from, &q, &still).accelerated(&still);
    let stiffness = force_slopes(&*full.system, at)[0][(index, index)];
    if !(stiffness > 0.0 && stiffness.is_finite()) {
        return None;
    }
    let [label, held, stiff] = ["rigid", "held", "stiffness"].map(|word| unused(text, &format!("{name}_{word}")));
    let read = format!("({name} - reaction({label})/{stiff})");
    let outputs = outputs.into_iter().map(|(path, written)| (path, with_word(&written, name, &read))).collect();
    let unit = unit_of(text, name);
    let per = match unit.as_str() {
        "m" => "N/m",
        "rad" => "N*m",
        _ => "",
    };
    let at = format!("{} {unit}", plain(place)).trim_end().to_owned();
    let stiffness = format!("{} {per}", plain(rounded(stiffness, stiffness))).trim_end().to_owned();
    let rigid = Rigid {
        equation: format!("{name} = {held}"),
        label,
        parameters: vec![(held, at.clone()), (stiff, stiffness)],
        gone: None,
        guessed: vec![name.clone()],
        coordinates: names.to_vec(),
        outputs,
        spring: None,
    };
    let ingredient = format!("coordinates.{name}");
    Some(Candidate { ingredient, proposal: Proposal::Rigid { at }, edits: vec![Edit::Rigid(rigid)] })
}

/// Whether a wanted quantity is an output or its component.
fn is_of(wanted: &str, output: &str) -> bool {
    wanted == output || wanted.strip_prefix(output).is_some_and(|rest| rest.starts_with('.'))
}

/// A formula with another one for a name, but not for its rates.
fn with_word(formula: &str, name: &str, other: &str) -> String {
    let (mut done, mut rest) = (String::new(), formula);
    while let Some(at) = word(rest, name) {
        let end = at + name.len();
        done += &rest[..at];
        done += if rest[end..].starts_with('\'') { name } else { other };
        rest = &rest[end..];
    }
    done + rest
}

/// The coordinates that an expression reads.
fn read(model: &Model, expression: &[Id], names: &[String]) -> Vec<String> {
    let symbols = model.graph.symbols(expression.iter().copied());
    let is_read = |i: &usize| symbols.contains(&Symbol::Coordinate(*i as u32));
    (0..names.len()).filter(is_read).map(|i| names[i].clone()).collect()
}

/// An expression at a place, at rest where the scene starts.
fn evaluated(full: &Full, model: &Model, expression: &[Id], q: &[f64]) -> Option<f64> {
    let parameters = full.system.parameters();
    let known = |symbol: Symbol| match symbol {
        Symbol::Parameter(k) => parameters[k as usize],
        Symbol::Coordinate(i) => q[i as usize],
        _ => 0.0,
    };
    let [found] = Tape::new(&model.graph, expression).evaluate(known).try_into().ok()?;
    Some(found).filter(|found: &f64| found.is_finite())
}

/// Outputs that are a spring's tension, or its opposite, as the reaction of the constraint in its place.
fn tensions(full: &Full, model: &mut Model, tension: &str, name: &str) -> Vec<(Vec<Step>, String)> {
    let Ok(tension) = model.expression(tension) else { return Vec::new() };
    let label = unused(&full.source, &format!("{name}_rigid"));
    let [one, other] = [1.0, 1.7].map(|part| -> Vec<f64> {
        let from = full.settings.q.iter().zip(&full.motion.ranges).enumerate();
        from.map(|(i, (q, range))| q + part * (range + 1e-3) * (0.3 + 0.1 * i as f64)).collect()
    });
    let outputs = model.outputs.iter().filter(|output| output.value.len() == 1);
    outputs
        .filter_map(|output| {
            let path = entry("outputs", &output.name);
            source(&full.source, &path)?;
            let ratio =
                |q: &[f64]| Some(evaluated(full, model, &output.value, q)? / evaluated(full, model, &tension, q)?);
            let (one, other) = (ratio(&one)?, ratio(&other)?);
            let is = |sign: f64| (one - sign).abs() <= ALIKE && (other - sign).abs() <= ALIKE;
            match (is(1.0), is(-1.0)) {
                (true, _) => Some((path, format!("-reaction({label})"))),
                (_, true) => Some((path, format!("reaction({label})"))),
                _ => None,
            }
        })
        .collect()
}

/// What a rigid spring changes: what its own reaction would give way to, prescribed to the smaller model; `None` of a coordinate, and
/// where that has discontinuities or events.
pub(super) fn predicted(full: &Full, rigid: &Rigid, answer: &Answer) -> Option<Prediction> {
    let Spring { distance, stiffness, rest, kept } = rigid.spring.as_ref()?;
    let description = full.system.description();
    if !description.events.is_empty() || !description.switches.is_empty() {
        return None;
    }
    let text = &answer.text;
    let [gives, pull] = ["gives", "pull"].map(|word| unused(text, &format!("{}_{word}", rigid.label)));
    let path = entry("constraints", &rigid.label);
    let equation = format!("{distance} = {} + {gives}", rigid.parameters.first()?.0);
    let text = replaced(text, &path, &scalar(&equation))?;
    let text = with(&text, "outputs", "constraints", &pull, &scalar(&format!("reaction({})", rigid.label)))?;
    let text = with(&text, "inputs", "coordinates", &gives, "0 m")?;
    let program = full.compiled(&text).ok()?;
    let (mut system, settings) = set(program, &text, full.scene.as_deref(), &full.settings.interruption).ok()?;
    let input = system.description().inputs.iter().position(|name| **name == gives)?;
    let columns: Vec<String> = full.need.outputs.iter().cloned().chain([pull]).collect();
    let still = Motion::of((&*system, &settings), (full.tolerance, TIMES), (&columns, &full.instants)).ok()?;
    let grid = (settings.from, (settings.until - settings.from) / (still.times.len() - 1) as f64);
    let ways: Vec<f64> = still.values.last()?.iter().map(|pull| rest - pull / stiffness - kept).collect();
    let channel = Channel::of_values(grid, &ways).filter(Channel::is_resolved)?;
    let slow = rate_of(&channel);
    // The start has the speeds that a constant length allows.
    let mut nodes = channel.nodes().to_vec();
    nodes[0] = [nodes[0][0], 0.0, 0.0];
    let channel = Channel::of_nodes(grid, nodes);
    let fast = frequency(full, rigid, *stiffness)?;
    // What the start has beyond where it would give way to vibrates.
    let mut model = full.program.model.clone();
    let length = model.expression(distance).ok()?;
    let away = evaluated(full, &model, &length, &full.settings.q)? - kept - channel.at(settings.from)[0];
    system.set_input(input, Arc::new(move |t| channel.at(t)));
    let moved = Motion::of((&*system, &settings), (full.tolerance, TIMES), (&columns, &full.instants)).ok()?;
    let change = |k: usize| {
        let apart = still.values[k].iter().zip(&moved.values[k]).map(|(a, b)| (b - a) / full.scales[k]);
        largest(&apart.collect::<Vec<f64>>())
    };
    let change = (0..full.need.outputs.len()).map(change).fold(0.0, f64::max);
    let lasts = settings.until - settings.from;
    // Its tension shows that at once, all else by its square.
    let reads = |wanted: &String| rigid.outputs.iter().any(|(path, _)| path.last() == Some(&key(wanted)));
    let read = full.need.outputs.iter().zip(&full.scales).filter(|(wanted, _)| reads(wanted));
    let read = read.map(|(_, scale)| stiffness * away.abs() / scale).fold(0.0, f64::max);
    let vibration = read.max(0.5 * (away / kept).powi(2) * slow * lasts);
    change.is_finite().then_some(Prediction { change, law: Law::Stiff { gap: fast / slow, vibration } })
}

/// √(k ∇l M⁻¹ ∇l) where the scene starts.
fn frequency(full: &Full, rigid: &Rigid, stiffness: f64) -> Option<f64> {
    const STEP: f64 = 1e-6;
    let mut model = full.program.model.clone();
    let length = model.expression(&rigid.spring.as_ref()?.distance).ok()?;
    let (q, n) = (&full.settings.q, full.settings.q.len());
    let still = vec![0.0; n];
    let slope = |i: usize| {
        let step = STEP * full.motion.ranges[i].max(STEP);
        let [low, high] = [-step, step].map(|step| {
            let mut q = q.clone();
            q[i] += step;
            evaluated(full, &model, &length, &q)
        });
        Some((high? - low?) / (2.0 * step))
    };
    let slopes = (0..n).map(slope).collect::<Option<Vec<f64>>>()?;
    let slopes = nalgebra::DVector::from_vec(slopes);
    let mass = mass_matrix(&*full.system, At::new(full.settings.from, q, &still)).cholesky()?;
    Some((stiffness * mass.solve(&slopes).dot(&slopes)).sqrt()).filter(|fast| *fast > 0.0 && fast.is_finite())
}

#[cfg(test)]
mod tests {
    use super::with_word;

    #[test]
    fn names_are_replaced_but_not_their_rates() {
        for (from, to) in [("k*(l - l0)", "k*((x) - l0)"), ("d*l' + l", "d*l' + (x)"), ("ll + l'", "ll + l'")] {
            assert_eq!(with_word(from, "l", "(x)"), to);
        }
    }
}
