//! What is tried: every ingredient of the file, and what becomes of it.

use dalembert_symbolic::diagnose::Step;
use dalembert_symbolic::file::edit::{keys, value};

use super::deviation::spread;
use super::edit::{Edit, entry, shown, unit_of, word};
use super::full::{Full, MOST_COORDINATES};
use super::linear::linear;
use super::modal::{Modes, ladders};
use super::reduction::Proposal;
use super::rigid;
use crate::mechanism::At;
use crate::run::plain;

/// Sections whose entries may go one by one, and those that may as a whole.
const ENTRIES: [&str; 6] = ["springs", "dampers", "forces", "torques", "generalized_forces", "bodies"];
const WHOLE: [&str; 2] = ["gravity", "dissipation"];
/// A place this small beside the range of its coordinate is 0.
const ROUNDING: f64 = 1e-9;

/// One ingredient and what becomes of it.
pub(super) struct Candidate {
    pub ingredient: String,
    pub proposal: Proposal,
    pub edits: Vec<Edit>,
}

/// All that is tried, in the file's order.
pub(super) fn candidates(full: &Full) -> Vec<Candidate> {
    let [springs, read] = [rigid::springs(full), rigid::coordinates(full)];
    [entries(full), masses(full), inputs(full), coordinates(full), read, springs, families(full), linear(full)]
        .into_iter()
        .flatten()
        .collect()
}

/// Entries of sections, and what is one entry.
fn entries(full: &Full) -> Vec<Candidate> {
    let text = &full.source;
    let own = ENTRIES.iter().flat_map(|section| {
        keys(text, &[Step::Key((*section).to_owned())]).into_iter().map(|name| entry(section, &name))
    });
    let whole = WHOLE.iter().filter(|section| keys(text, &[]).iter().any(|key| key == *section));
    own.chain(whole.map(|section| vec![Step::Key((*section).to_owned())]))
        .map(|path| {
            let ingredient = shown(&path);
            Candidate { ingredient, proposal: Proposal::LeftOut, edits: vec![Edit::Remove(path)] }
        })
        .collect()
}

/// The mass and the inertia of each body, 0; a mechanism that needs it to have accelerations at all does not compile without.
fn masses(full: &Full) -> Vec<Candidate> {
    let text = &full.source;
    let bodies = keys(text, &[Step::Key("bodies".to_owned())]);
    let of = |body: &String| {
        ["mass", "inertia"].map(|key| [entry("bodies", body), vec![Step::Key(key.to_owned())]].concat())
    };
    let is_there = |path: &Vec<Step>| value(text, path).is_some_and(|value| value.parse() != Ok(0.0));
    let without = |path: Vec<Step>| Candidate {
        ingredient: shown(&path),
        proposal: Proposal::LeftOut,
        edits: vec![Edit::Replace { path, value: "0".to_owned() }],
    };
    bodies.iter().flat_map(of).filter(is_there).map(without).collect()
}

/// Each input that moves, at rest where it starts, and where it is on the average.
fn inputs(full: &Full) -> Vec<Candidate> {
    let own = keys(&full.source, &[Step::Key("inputs".to_owned())]);
    let names = &full.system.description().inputs;
    let mut values = vec![0.0; 3 * names.len()];
    let mut at = |t: &f64| -> Vec<f64> {
        full.system.inputs(*t, &mut values);
        values.chunks_exact(3).map(|signal| signal[0]).collect()
    };
    let signals: Vec<Vec<f64>> = full.motion.times.iter().map(&mut at).collect();
    let mut found = Vec::new();
    for (place, name) in names.iter().enumerate().filter(|(_, name)| own.iter().any(|key| *key == ***name)) {
        let signal: Vec<f64> = signals.iter().map(|values| values[place]).collect();
        let (range, _) = spread(&signal);
        let mean = signal.iter().sum::<f64>() / signal.len() as f64;
        for value in [signal.first().copied().unwrap_or(0.0), mean].into_iter().filter(|_| range > 0.0) {
            let unit = full.program.model.clone().unit_of(name).unwrap_or_default();
            let at = format!("{} {unit}", plain(rounded(value, range))).trim_end().to_owned();
            let edits = vec![Edit::Replace { path: entry("inputs", name), value: at.clone() }];
            found.push(Candidate { ingredient: format!("inputs.{name}"), proposal: Proposal::Held { at }, edits });
        }
    }
    found
}

/// Each coordinate held, and following the others.
fn coordinates(full: &Full) -> Vec<Candidate> {
    let text = &full.source;
    let coordinates = &full.system.description().coordinates;
    let mut found = Vec::new();
    if coordinates.len() < 2 || coordinates.len() > MOST_COORDINATES {
        return found;
    }
    let own = keys(text, &[Step::Key("coordinates".to_owned())]);
    for (index, coordinate) in coordinates.iter().enumerate().filter(|(_, c)| own.iter().any(|name| c.name == *name)) {
        let name = coordinate.name.to_string();
        let ingredient = format!("coordinates.{name}");
        let slaved = full.places[index].as_ref().filter(|place| is_plain(place)).map(|place| {
            let moves = coordinates.iter().any(|other| word(place, &other.name).is_some()) || timed(full, place);
            let proposal = match moves {
                true => Proposal::Slaved { to: place.clone() },
                false => Proposal::Held { at: place.clone() },
            };
            let edits = vec![Edit::Slave { coordinate: name.clone(), place: place.clone(), moves }];
            Candidate { ingredient: ingredient.clone(), proposal, edits }
        });
        let places = [resting(full, index).unwrap_or(full.settings.q[index]), full.motion.means[index]];
        for value in places.map(|value| rounded(value, full.motion.ranges[index])) {
            // All units of coordinates are those of SI.
            let at = format!("{} {}", plain(value), unit_of(text, &name)).trim_end().to_owned();
            let edits = vec![Edit::Hold { coordinate: name.clone(), value: at.clone() }];
            found.push(Candidate { ingredient: ingredient.clone(), proposal: Proposal::Held { at }, edits });
        }
        found.extend(slaved);
    }
    found
}

/// Each family by ever more of its modes.
fn families(full: &Full) -> Vec<Candidate> {
    let by = |modes: Modes| {
        let (kept, of) = modes.count();
        let ingredient = format!("coordinates.{}", modes.key);
        Candidate { ingredient, proposal: Proposal::Modes { kept, of }, edits: vec![Edit::ByModes(modes)] }
    };
    ladders(full).into_iter().map(by).collect()
}

/// Whether a formula has no number in it that only a machine writes.
fn is_plain(formula: &str) -> bool {
    const DIGITS: usize = 5;
    formula.split(|c: char| !c.is_ascii_digit()).all(|digits| digits.len() <= DIGITS)
}

/// Whether a place moves with time or an input.
fn timed(full: &Full, place: &str) -> bool {
    let mut inputs = full.system.description().inputs.iter();
    word(place, "t").is_some() || inputs.any(|input| word(place, input).is_some())
}

/// A place to nine digits; 0 where it is that beside the range of its coordinate.
pub(super) fn rounded(value: f64, range: f64) -> f64 {
    if value.abs() <= ROUNDING * range { 0.0 } else { format!("{value:.8e}").parse().unwrap_or(value) }
}

/// Where the force on a coordinate vanishes, the others standing where the scene starts, by secants.
pub(super) fn resting(full: &Full, index: usize) -> Option<f64> {
    const ROUNDS: u32 = 60;
    const SMALL: f64 = 1e-9;
    let (system, n) = (&*full.system, full.system.len());
    let (start, zero) = (full.settings.q[index], vec![0.0; n]);
    let force = |z: f64| {
        let (mut q, mut f) = (full.settings.q.clone(), vec![0.0; n]);
        q[index] = z;
        system.residual(At::new(full.settings.from, &q, &zero).accelerated(&zero), &mut f);
        f[index]
    };
    let reach = full.motion.ranges[index].max(1e-6 * start.abs()).max(1e-9);
    let (mut a, mut b) = (start, start + 0.1 * reach);
    let (mut low, mut high) = (force(a), force(b));
    let size = low.abs().max(high.abs());
    for _ in 0..ROUNDS {
        let next = b - high * (b - a) / (high - low);
        if high.abs() <= SMALL * size || !next.is_finite() {
            break;
        }
        (a, low) = (b, high);
        (b, high) = (next, force(next));
    }
    // A place far from where it goes is none of this motion.
    let found = high.abs() <= 1e-3 * SMALL.sqrt() * size && (b - start).abs() <= 10.0 * reach;
    found.then_some(b)
}
