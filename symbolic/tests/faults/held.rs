// Faults in what the program derives of constraints: one entry at a time, in one of its two derivations.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use dalembert_symbolic::derive::{Derivation, Rows, derive};
use dalembert_symbolic::expr::{Graph, Id, Rational, Symbol, Tape};
use dalembert_symbolic::gate::judge;
use dalembert_symbolic::model::load;

use super::{Extent, in_parallel, models, text_of};

/// Kinds of faults: how many were planted, and how many refused.
pub type Held = BTreeMap<&'static str, (usize, usize)>;

/// An entry is multiplied by these: (1e12 + 1)/1e12, the opposite, nothing.
const FACTORS: [(i128, i128); 3] = [(1_000_000_000_001, 1_000_000_000_000), (-1, 1), (0, 1)];

/// An entry that is less at a state with numbers near 1 is 0 but for rounding.
const VANISHED: f64 = 1e-12;

/// Parts of the rows in which faults are planted.
const PARTS: [(&str, Part); 5] = [
    ("an entry of J", |rows| rows.matrix.iter_mut().map(|entry| &mut entry.2).collect()),
    ("γ", |rows| rows.bias.iter_mut().collect()),
    ("c'", |rows| rows.rate.iter_mut().collect()),
    ("the rate of what moves a constraint", |rows| rows.drive.iter_mut().collect()),
    ("the force Jᵀλ on a coordinate", |rows| rows.forces.iter_mut().collect()),
];

type Part = fn(&mut Rows) -> Vec<&mut Id>;

/// Plants faults in the constraints of every model of the library, on all cores.
pub fn held(extent: Extent) -> Held {
    let mut all = Held::new();
    for found in in_parallel(&models(), |name| of_model(&text_of(name).unwrap_or_default(), extent)) {
        for (kind, (planted, refused)) in found {
            let counts = all.entry(kind).or_default();
            *counts = (counts.0 + planted, counts.1 + refused);
        }
    }
    all
}

fn of_model(text: &str, extent: Extent) -> Held {
    let mut found = Held::new();
    if !text.contains("constraints:") {
        return found;
    }
    let Ok(sound) = load(text, &[]).and_then(derive) else { return found };
    let states = judge(sound.clone()).map(|judged| judged.report.states).unwrap_or_default();
    for (kind, part) in PARTS {
        let mut rows = sound.rows.clone();
        let entries: Vec<Id> = part(&mut rows).into_iter().map(|id| *id).collect();
        let tape = Tape::new(&sound.model.graph, &entries);
        let numbers = tape.evaluate(|s| any(&s));
        let held: Vec<Vec<f64>> = states.iter().map(|state| tape.evaluate(|s| state.value(s).to_f64())).collect();
        // What vanishes at any state, or wherever the constraints hold, though its expression does not, is no place for a fault.
        let somewhere = |k: usize| held.is_empty() || held.iter().any(|at| at[k].is_nan() || at[k].abs() > VANISHED);
        let wrong = |k: &usize| {
            entries[*k] != Id::ZERO && (numbers[*k].is_nan() || numbers[*k].abs() > VANISHED) && somewhere(*k)
        };
        for k in (0..entries.len()).filter(wrong).take(extent.of_a_kind()) {
            for factor in FACTORS {
                let spoilt = spoilt(&sound, part, k, factor);
                let counts = found.entry(kind).or_default();
                *counts = (counts.0 + 1, counts.1 + usize::from(judge(spoilt).is_err()));
            }
        }
    }
    found
}

/// Any number, always the same, for a symbol.
fn any(symbol: &Symbol) -> f64 {
    let mut hasher = DefaultHasher::new();
    symbol.hash(&mut hasher);
    0.3 + (hasher.finish() % 1000) as f64 / 1000.0
}

fn spoilt(sound: &Derivation, part: Part, k: usize, factor: (i128, i128)) -> Derivation {
    let mut spoilt = sound.clone();
    let times = |graph: &mut Graph, id: Id| {
        let factor = Rational::new(factor.0, factor.1).map_or(Id::ONE, |ratio| graph.rational(ratio));
        graph.mul(factor, id)
    };
    let entry = part(&mut spoilt.rows).swap_remove(k);
    *entry = times(&mut spoilt.model.graph, *entry);
    spoilt
}
