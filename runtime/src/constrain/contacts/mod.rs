//! Friction that sticks and contacts that open by themselves: what all of them do from an instant on.
//!
//! 1. What is known of each at the instant, and which combination of modes the forces agree with: look in `modes.rs`.
//! 2. Impacts of several at once, by a stated law: look in `strike.rs`.

mod modes;
mod strike;

pub(crate) use modes::{Change, settle};
pub(crate) use strike::{Strike, strike};

use crate::mechanism::dense::{constraint_matrix, constraint_triples, sizes_alike};
use crate::mechanism::{At, ContactMode, System};

/// A gap below this part of the sum of its terms, or of what the sizes of coordinates make of it, is closed: instants at which contacts close are located to some 1e-13 of them.
const CLOSED: f64 = 1e-11;
/// A rate below this part of the sum of its terms is zero.
const STILL: f64 = 1e-12;

/// All contacts at a state.
struct Situation {
    /// What each did until now.
    modes: Vec<ContactMode>,
    /// Gap and its rate, 0 where there is none.
    gaps: Vec<[f64; 2]>,
    /// The sliding rates.
    sliding: Vec<f64>,
    /// Whether the gap is closed, as far as rounding tells.
    closed: Vec<bool>,
    /// Whether the rates of gaps, and those of sliding, are zero as far as rounding tells.
    still: Vec<[bool; 2]>,
}

impl Situation {
    /// At a state; `scales` are the largest Σ |terms| that the rows have had, none where the motion begins.
    fn new(system: &dyn System, (t, y): (f64, &[f64]), scales: &[f64]) -> Situation {
        let n = system.len();
        let at = At::packed(t, y, n);
        let contacts = &system.contacts().all;
        let triples = constraint_triples(system, at);
        let rows: Vec<usize> = (0..triples.len()).collect();
        let matrix = constraint_matrix(system, at, &rows);
        // Σ |J_i v_i|, beside which a rate is rounding.
        let terms = |row: usize| {
            let moving = (0..n).map(|i| (matrix[(row, i)] * at.v[i]).abs()).sum::<f64>();
            let driven = triples[row][1] - (0..n).map(|i| matrix[(row, i)] * at.v[i]).sum::<f64>();
            moving + driven.abs()
        };
        let still =
            |row: Option<u32>| row.is_none_or(|row| triples[row as usize][1].abs() <= STILL * terms(row as usize));
        let rate = |row: Option<u32>| row.map_or(0.0, |row| triples[row as usize][1]);
        let gap = |row: Option<u32>| row.map_or(0.0, |row| triples[row as usize][0]);
        // What the sizes of coordinates make of a gap whose terms are small here.
        let sizes = sizes_alike(system.description(), at.q);
        let size = |row: usize| (0..n).map(|i| (matrix[(row, i)] * sizes[i]).abs()).sum::<f64>();
        let closed = |row: Option<u32>| {
            row.is_none_or(|row| {
                let row = row as usize;
                let [gap, _, terms] = triples[row];
                let seen = scales.get(row).copied().unwrap_or(0.0);
                gap.abs() <= CLOSED * terms.max(seen).max(size(row))
            })
        };
        Situation {
            modes: system.contacts().modes(system.phase()),
            gaps: contacts.iter().map(|contact| [gap(contact.normal), rate(contact.normal)]).collect(),
            sliding: contacts.iter().map(|contact| rate(contact.tangent)).collect(),
            closed: contacts.iter().map(|contact| closed(contact.normal)).collect(),
            still: contacts.iter().map(|contact| [still(contact.normal), still(contact.tangent)]).collect(),
        }
    }
}
