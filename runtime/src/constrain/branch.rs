//! Other ways in which a mechanism can be put together from the same start.

use super::start::{Closing, Start};
use crate::mechanism::System;
use crate::mechanism::dense::sizes_alike;

/// With more coordinates to be found than this nobody looks.
const MOST: usize = 12;
/// So many places are tried.
const TRIED: usize = 24;
/// Places that differ by less than this part of their size are one.
const SAME: f64 = 1e-6;

/// A coordinate that another solution of a start has elsewhere: which, where it is, and where it is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Elsewhere {
    pub coordinate: usize,
    pub here: f64,
    pub there: f64,
}

/// Another solution than the one that was found, where what is held leaves only single ones.
pub(crate) fn other_branch<S: System + ?Sized>(system: &S, start: &Start<'_>, found: &[f64]) -> Option<Elsewhere> {
    let closing = Closing::new(system, start);
    let free = &closing.free;
    if free.is_empty()
        || closing.holonomic.is_empty()
        || free.len() > MOST
        || !start.start_conditions.is_empty()
        || !closing.is_isolated(found)
    {
        return None;
    }
    let description = system.description();
    let sizes = sizes_alike(description, &found[..closing.n]);
    let turns = |i: usize| matches!(&*description.coordinates[i].unit, "rad" | "" | "1");
    let reach = |i: usize| if turns(i) { std::f64::consts::PI } else { 2.0 * sizes[i] };
    (1..=TRIED).find_map(|k| {
        let mut y = found.to_vec();
        for (place, &i) in free.iter().enumerate() {
            y[i] += reach(i) * (2.0 * radical_inverse(k, PRIMES[place]) - 1.0);
        }
        closing.close(&mut y).ok()?;
        free.iter().copied().find_map(|i| {
            let apart = y[i] - found[i];
            let turn = std::f64::consts::TAU;
            let apart = if turns(i) { apart - turn * (apart / turn).round() } else { apart };
            let far = apart.abs() > SAME * if turns(i) { 1.0 } else { sizes[i] };
            far.then_some(Elsewhere { coordinate: i, here: found[i], there: found[i] + apart })
        })
    })
}

/// Bases of the radical inverse, one for each coordinate.
const PRIMES: [usize; MOST] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];

/// The digits of k behind the point (Halton 1960): places that fill a cube evenly.
fn radical_inverse(mut k: usize, base: usize) -> f64 {
    let (mut value, mut weight) = (0.0, 1.0);
    while k > 0 {
        weight /= base as f64;
        value += weight * (k % base) as f64;
        k /= base;
    }
    value
}
