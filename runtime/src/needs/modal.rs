//! A family of coordinates by a few of its modes: θ = θ₀ + P z, all else as it is.
//!
//! They are the family's parts of the modes of all coordinates, (K − ω² M) φ = 0, where the family rests.  What is
//! nonlinear stays so, since the places of the bodies are still written in θ; the fast modes are what is left out.

use dalembert_symbolic::diagnose::Step;
use dalembert_symbolic::file::edit::{keys, rewritten, source, value, with, with_at, without};
use nalgebra::{DMatrix, DVector};

use super::edit::entry;
use super::full::Full;
use crate::linear::{Guess, LinearMechanism, Reduction, equilibrium_here, linearise, normal_modes};
use crate::mechanism::At;
use crate::mechanism::dense::{force_slopes, mass_matrix};
use crate::run::plain;

/// So many modes are tried, fewest first.
const LADDER: [usize; 9] = [1, 2, 3, 4, 6, 8, 12, 16, 24];
/// Smaller families are not worth it.
const LEAST: usize = 4;
/// A place at rest, or a start in a mode, this small beside one radian or metre is 0.
const SMALL: f64 = 1e-12;

/// A family in a few of its modes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Modes {
    /// The key of the family among the coordinates, `th[i in 1..n]`.
    pub key: String,
    /// Its name, `th`.
    name: String,
    /// The index, `i`, and its range, `1..n`.
    index: (String, String),
    /// θ₀.
    rest: Vec<f64>,
    /// P, a row for each member.
    shapes: Vec<Vec<f64>>,
    /// Which of all coordinates are its members, and by which parts of their changes each mode changes.
    members: Vec<usize>,
    weights: Vec<Vec<f64>>,
    /// (q, q') of the modes at the start of the default scene and of each other one, by its name; `None` where it is at rest.
    starts: Vec<(Option<String>, [Vec<f64>; 2])>,
}

impl Modes {
    /// How many modes, of how many.
    pub fn count(&self) -> (usize, usize) {
        (self.shapes.first().map_or(0, Vec::len), self.shapes.len())
    }

    /// By how much the mode changes that a coordinate of the smaller model is, where all those of the full one change by this much;
    /// `None` where it is not of this family.
    pub fn change(&self, coordinate: &str, changes: &[f64]) -> Option<f64> {
        let number = coordinate.strip_prefix(&format!("{}_{MODE}", self.name))?.trim_start_matches('_');
        let mode: usize = number.strip_prefix('[')?.strip_suffix(']')?.parse().ok()?;
        let weights = self.weights.get(mode.checked_sub(1)?)?;
        Some(self.members.iter().zip(weights).map(|(member, weight)| weight * changes[*member]).sum())
    }
}

/// What stands behind a family's name in that of its modes.
const MODE: &str = "mode";

/// Every family of coordinates, by ever more of its modes; none where there are constraints, or nothing to rest at.
pub(super) fn ladders(full: &Full) -> Vec<Modes> {
    let description = full.system.description();
    let families: Vec<Family> =
        keys(&full.source, &[Step::Key("coordinates".to_owned())]).iter().filter_map(|key| family(full, key)).collect();
    if families.is_empty() || !description.rows.is_empty() || description.phases.len() > 1 {
        return Vec::new();
    }
    let mut found = Vec::new();
    for family in families {
        let Some((rest, mass, stiffness)) = family.at_rest(full) else { continue };
        let Some(all) = modes(&mass, &stiffness) else { continue };
        let own = mass.select_rows(&family.members).select_columns(&family.members);
        let shapes = family.shapes(&all, &own);
        for count in LADDER.into_iter().filter(|count| *count < family.members.len().min(shapes.len() + 1)) {
            found.push(family.by(&shapes[..count], &own, &rest, full));
        }
    }
    found
}

/// Shapes of all modes, slowest first; `None` where one grows.
fn modes(mass: &DMatrix<f64>, stiffness: &DMatrix<f64>) -> Option<Vec<DVector<f64>>> {
    let none = DMatrix::zeros(mass.nrows(), mass.nrows());
    let alone = LinearMechanism::new(mass.clone(), none, stiffness.clone()).ok()?;
    let rest = equilibrium_here(&alone, &Guess::at(&vec![0.0; mass.nrows()])).ok()?;
    let modes = normal_modes(&linearise(&alone, &rest).ok()?, Reduction::Cholesky).ok()?;
    modes.iter().map(|mode| (mode.eigenvalue.re <= 0.0).then(|| DVector::from_vec(mode.real_shape()))).collect()
}

/// A family of coordinates with one index.
struct Family {
    key: String,
    name: String,
    index: (String, String),
    /// Places of its members among the coordinates.
    members: Vec<usize>,
}

/// The family that a key declares, if it is one, and large enough.
fn family(full: &Full, key: &str) -> Option<Family> {
    let (name, rest) = key.split_once('[')?;
    let (index, range) = rest.strip_suffix(']')?.split_once(" in ")?;
    if range.contains(',') {
        return None;
    }
    let is_member = |of: &str| of.strip_prefix(name).is_some_and(|rest| rest.starts_with('['));
    let coordinates = full.system.description().coordinates.iter().enumerate();
    let members: Vec<usize> = coordinates.filter(|(_, c)| is_member(&c.name)).map(|(place, _)| place).collect();
    let (name, index) = (name.to_owned(), (index.trim().to_owned(), range.trim().to_owned()));
    (members.len() >= LEAST).then(|| Family { key: key.to_owned(), name, index, members })
}

impl Family {
    /// Its members' parts of modes, each made orthogonal in their M to those before, the largest part 1; what is nearly none, or
    /// nearly one of those, is left aside.
    fn shapes(&self, modes: &[DVector<f64>], mass: &DMatrix<f64>) -> Vec<DVector<f64>> {
        const NEARLY: f64 = 1e-3;
        let mut found: Vec<DVector<f64>> = Vec::new();
        for mode in modes {
            let part = mode.select_rows(&self.members);
            let mut own = part.clone();
            for before in &found {
                let along = (mass * before).dot(&own) / (mass * before).dot(before);
                own -= along * before;
            }
            let size = |shape: &DVector<f64>| (mass * shape).dot(shape);
            if size(&own) > NEARLY * NEARLY * size(&part) && part.amax() > NEARLY * NEARLY * mode.amax() {
                let largest =
                    own.iter().copied().fold(0.0_f64, |most, part| if part.abs() > most.abs() { part } else { most });
                found.push(own / largest);
            }
        }
        found
    }

    /// Where its members rest among the places they go through, while all other coordinates stay where the scene starts, by
    /// Newton's method, and M and K of all coordinates there.
    fn at_rest(&self, full: &Full) -> Option<(Vec<f64>, DMatrix<f64>, DMatrix<f64>)> {
        const ROUNDS: u32 = 30;
        const BEYOND: f64 = 2.0;
        let (system, n) = (&*full.system, full.system.len());
        let (mut q, still) = (full.settings.q.clone(), vec![0.0; n]);
        let (means, ranges) = (&full.motion.means, &full.motion.ranges);
        self.members.iter().for_each(|index| q[*index] = means[*index]);
        let widest = self.members.iter().fold(SMALL, |most, index| ranges[*index].max(most));
        for _ in 0..ROUNDS {
            let at = At::new(full.settings.from, &q, &still).accelerated(&still);
            let mut residual = vec![0.0; n];
            system.residual(at, &mut residual);
            let (mass, [slopes, _]) = (mass_matrix(system, at), force_slopes(system, at));
            let stiffness = slopes.select_rows(&self.members).select_columns(&self.members);
            let force = DVector::from_iterator(self.members.len(), self.members.iter().map(|index| residual[*index]));
            let step = stiffness.lu().solve(&force).filter(|step| step.iter().all(|part| part.is_finite()))?;
            if step.amax() <= SMALL * (1.0 + q.iter().fold(0.0_f64, |most, q| most.max(q.abs()))) {
                let symmetric = 0.5 * (&slopes + slopes.transpose());
                return Some((self.members.iter().map(|index| q[*index]).collect(), mass, symmetric));
            }
            self.members.iter().zip(step.iter()).for_each(|(index, step)| q[*index] -= step);
            if self.members.iter().any(|index| (q[*index] - means[*index]).abs() > BEYOND * widest) {
                return None;
            }
        }
        None
    }

    /// In these modes.
    fn by(&self, modes: &[DVector<f64>], mass: &DMatrix<f64>, rest: &[f64], full: &Full) -> Modes {
        // Modes are orthogonal in M.
        let weigh = |mode: &DVector<f64>| (mass * mode / (mass * mode).dot(mode)).iter().copied().collect();
        let weights: Vec<Vec<f64>> = modes.iter().map(weigh).collect();
        let coordinate = |state: &[f64], from: &[f64]| -> Vec<f64> {
            let away: Vec<f64> = self.members.iter().zip(from).map(|(i, from)| state[*i] - from).collect();
            let mode = |weights: &Vec<f64>| cleaned(weights.iter().zip(&away).map(|(w, away)| w * away).sum());
            weights.iter().map(mode).collect()
        };
        let none = vec![0.0; rest.len()];
        let names = full.system.description().scenes.iter().map(|name| Some(name.to_string()));
        let own = keys(&full.source, &[Step::Key("scenes".to_owned())]);
        let scenes = names.map(|name| name.filter(|name| own.contains(name)));
        let starts = scenes.enumerate().map(|(place, name)| {
            let scene = full.system.scene(place);
            (name, [coordinate(&scene.q, rest), coordinate(&scene.v, &none)])
        });
        Modes {
            key: self.key.clone(),
            name: self.name.clone(),
            index: self.index.clone(),
            rest: rest.iter().copied().map(cleaned).collect(),
            shapes: (0..rest.len()).map(|row| modes.iter().map(|mode| cleaned(mode[row])).collect()).collect(),
            starts: starts.collect(),
            members: self.members.clone(),
            weights,
        }
    }
}

/// A number as the file will have it.
fn cleaned(value: f64) -> f64 {
    if value.abs() < SMALL { 0.0 } else { format!("{value:.9e}").parse().unwrap_or(value) }
}

/// The file in which a family is given by its modes; `None` where it cannot be.
pub(super) fn by_modes(text: &str, modes: &Modes) -> Option<String> {
    let Modes { key, name, index: (index, range), rest, shapes, starts, .. } = modes;
    let unit = value(text, &entry("coordinates", key)).unwrap_or_default();
    let forced = keys(text, &[Step::Key("generalized_forces".to_owned())]);
    if forced.iter().any(|key| belongs(key, name)) {
        return None;
    }
    let own = |suffix: &str| {
        let mut own = format!("{name}_{suffix}");
        while text.contains(&own) {
            own.push('_');
        }
        own
    };
    let [mode, shape, still] = [MODE, "shape", "rest"].map(own);
    let count = modes.count().0;
    let j = if index == "j" { "k" } else { "j" };
    let path = |steps: &[&str]| steps.iter().map(|step| Step::Key((*step).to_owned())).collect::<Vec<Step>>();
    let rate = |scalar: &str| rates(scalar, name);
    let mut text = rewritten(&without_starts(text, name, &path), rate)?;
    for (scene, [q, v]) in starts {
        let scene = scene.as_deref().map_or(path(&["scene"]), |scene| path(&["scenes", scene]));
        for (prime, values) in [("", q), ("'", v)].into_iter().filter(|(_, values)| values.iter().any(|z| *z != 0.0)) {
            let entry = format!("\"{mode}[{j} in 1..{count}]{prime}\"");
            let start = [scene.as_slice(), &path(&["start"])].concat();
            text = match source(&text, &start) {
                Some(_) => with_at(&text, &start, &entry, &list(values))?,
                None => with_at(&text, &scene, "start", &format!("{{{entry}: {}}}", list(values)))?,
            };
        }
    }
    let family = format!("\"{mode}[{j} in 1..{count}]\"");
    text = with(&text, "coordinates", "parameters", &family, &unit)?;
    text = without(&text, &entry("coordinates", key))?;
    let sum = format!("sum({shape}[{index},{j}]*{mode}[{j}], {j} in 1..{count})");
    let rests = rest.iter().any(|place| *place != 0.0);
    let place = if rests { format!("\"{still}[{index}] + {sum}\"") } else { format!("\"{sum}\"") };
    text = with(&text, "define", "coordinates", &format!("\"{key}\""), &place)?;
    if rests {
        text = with(&text, "parameters", "name", &format!("\"{still}[{index} in {range}]\""), &list(rest))?;
    }
    let rows: Vec<String> = shapes.iter().map(|row| list(row)).collect();
    let matrix = format!("[{}]", rows.join(",\n    "));
    with(&text, "parameters", "name", &format!("\"{shape}[{index} in {range}, {j} in 1..{count}]\""), &matrix)
}

fn list(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|value| plain(*value)).collect::<Vec<_>>().join(", "))
}

/// Whether a key is of a member of the family, or of some.
fn belongs(key: &str, name: &str) -> bool {
    key.strip_prefix(name).is_some_and(|rest| rest.starts_with('['))
}

/// The file without starts and guesses of a family.
fn without_starts(text: &str, name: &str, path: &impl Fn(&[&str]) -> Vec<Step>) -> String {
    let mut text = text.to_owned();
    let mut places = vec![path(&["equilibrium"]), path(&["scene", "start"]), path(&["scene", "guess"])];
    for scene in keys(&text, &path(&["scenes"])) {
        places.extend([path(&["scenes", &scene, "start"]), path(&["scenes", &scene, "guess"])]);
    }
    for place in places {
        for key in keys(&text, &place).into_iter().filter(|key| belongs(key, name)) {
            let whole = [place.as_slice(), &[Step::Key(key)]].concat();
            text = without(&text, &whole).unwrap_or(text);
        }
    }
    text
}

/// An expression with `rate(th[i])` in the place of `th[i]'`.
fn rates(expression: &str, name: &str) -> String {
    let (mut out, mut rest) = (String::new(), expression);
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    while let Some(at) = rest.find(&format!("{name}[")) {
        let begins = !rest[..at].chars().next_back().or(out.chars().next_back()).is_some_and(is_part);
        let Some(end) = closing(&rest[at..]).map(|end| at + end) else { break };
        let primes = rest[end..].chars().take_while(|c| *c == '\'').count();
        out += &rest[..at];
        let member = &rest[at..end];
        if begins && primes > 0 {
            out += &format!("{}{member}{}", "rate(".repeat(primes), ")".repeat(primes));
            rest = &rest[end + primes..];
        } else {
            out += member;
            rest = &rest[end..];
        }
    }
    out + rest
}

/// Behind the bracket that closes the first one.
fn closing(text: &str) -> Option<usize> {
    let mut depth = 0;
    for (at, c) in text.char_indices() {
        match c {
            '[' => depth += 1,
            ']' => depth -= 1,
            _ => continue,
        }
        if depth == 0 {
            return Some(at + 1);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::rates;

    #[test]
    fn rates_of_members_are_rates_of_expressions() {
        for (from, to) in [
            ("th[i]' + th[i-1]''*x'", "rate(th[i]) + rate(rate(th[i-1]))*x'"),
            ("path[i]' + th[j]", "path[i]' + th[j]"),
            ("th[n[1]]'", "rate(th[n[1]])"),
        ] {
            assert_eq!(rates(from, "th"), to);
        }
    }
}
