// The smallest fault that is caught, by kind.

use std::collections::BTreeMap;

use dalembert_symbolic::derive::derive;
use dalembert_symbolic::gate::judge;

use super::engine::{Change, of_balances, of_lagrange};
use super::{Extent, Fault, Sound, in_parallel, sound, spoilt};

/// Models that are searched.
const MODELS: [&str; 6] =
    ["cart_pendulum", "double_pendulum", "slot_turntable_offset", "scales_orbit", "scales_sensor", "scales_stiff"];

/// Digits that are tried: a relative size of 10^−k.
const DIGITS: (u32, u32) = (1, 30);

/// Of one kind: the sizes, as digits, of the smallest fault that is caught of each term.
pub type Smallest = BTreeMap<String, Vec<u32>>;

/// The smallest faults by kind, each found by bisection.
pub fn smallest(extent: Extent) -> Smallest {
    let names = MODELS.map(str::to_owned);
    let found = in_parallel(&names, |name| sound(name).map_or_else(Vec::new, |sound| of_model(&sound, extent)));
    let mut by_kind = Smallest::new();
    for (kind, digits) in found.into_iter().flatten() {
        by_kind.entry(kind).or_default().push(digits);
    }
    by_kind
}

fn of_model(sound: &Sound, extent: Extent) -> Vec<(String, u32)> {
    let faults = |digits: u32| -> Vec<Fault> {
        let change = [Change::slight(digits)];
        of_balances(&sound.model, &change).into_iter().chain(of_lagrange(&sound.model, &change)).collect()
    };
    let mut places: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (k, fault) in faults(1).iter().enumerate() {
        let kind = fault.kind.split(", off by").next().unwrap_or_default();
        places.entry(kind.to_owned()).or_default().push(k);
    }
    let mut found = Vec::new();
    for (kind, places) in places {
        let step = places.len().div_ceil(extent.of_a_kind());
        for k in places.into_iter().step_by(step) {
            let caught = |digits: u32| refused(sound, &faults(digits)[k]);
            // A part that may have any factor (a mass that cancels) is no fault of any size.
            if caught(DIGITS.0) {
                found.push((kind.clone(), bisect(caught)));
            }
        }
    }
    found
}

/// The most digits at which a fault is still caught.
fn bisect(caught: impl Fn(u32) -> bool) -> u32 {
    let (mut low, mut high) = (DIGITS.0, DIGITS.1 + 1);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if caught(middle) { low = middle } else { high = middle }
    }
    low
}

fn refused(sound: &Sound, fault: &Fault) -> bool {
    spoilt(sound, fault).is_ok_and(|model| derive(model).and_then(judge).is_err())
}
