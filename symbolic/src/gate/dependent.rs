//! Rows of the constraints that follow from others, or contradict them.

use super::rows::{Constraints, DEPENDENT};
use super::state::State;
use super::system::{plus, times};
use crate::expr::Measured;

/// What a dependent row leaves in roundings: constraints hold to 29 digits, and speeds multiply what is left.
const CONTRADICTS: f64 = 1e12;
/// A row that is scaled to length 1 takes part in a combination that vanishes by more than this.
const TAKES_PART: f64 = 1e-8;

/// A row that follows from those before it.
#[derive(Debug, PartialEq)]
pub(super) struct Redundant {
    /// The phase in which it does.
    pub phase: usize,
    /// Its place among all rows.
    pub row: usize,
    /// The rows of which a combination vanishes, itself the last: λ is determined for all others (section 6.2 of Udwadia
    /// and Kalaba, Analytical Dynamics, 1996: the null vectors of Jᵀ).
    pub sharing: Vec<usize>,
}

/// Rows that the accelerations which meet the others do not meet somewhere: (phase, row).
pub(super) fn contradictions(
    constraints: &Constraints,
    states: &[State],
    ranks: &[Option<usize>],
) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for state in states {
        let (rank, order) = constraints.rank(state);
        let rest = order[rank..].to_vec();
        let held = constraints.held(state, rest.clone());
        let weights = constraints.weights(|s| state.value(s).to_f64());
        let size = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
        let acceleration = size(&mut state.a.iter().zip(&weights).map(|(a, w)| a.value.to_f64() / w));
        for (row, (line, bias)) in rest.iter().zip(held.matrix.chunks(constraints.n.max(1)).zip(&held.bias)) {
            let terms = line.iter().zip(&state.a);
            let sum = terms.fold(*bias, |sum, (x, a)| plus(sum, times(*x, *a)));
            // Of axes that stay parallel all terms vanish: what is left of closing is beside the acceleration of the whole.
            let along = size(&mut line.iter().zip(&weights).map(|(x, w)| x.value.to_f64() * w));
            let sum = Measured { magnitude: sum.magnitude.max(along * acceleration), ..sum };
            if !sum.vanishes(CONTRADICTS) && !found.contains(&(state.phase, *row)) {
                found.push((state.phase, *row));
            }
        }
    }
    // Which of several rows is called the last may change with the state: one for each that is too many.
    found.sort_by_key(|(_, row)| std::cmp::Reverse(*row));
    let mut kept: Vec<(usize, usize)> = Vec::new();
    for (phase, row) in found {
        let already = kept.iter().filter(|other| other.0 == phase).count();
        let many = constraints.active(phase).len();
        if already < many - ranks[phase].unwrap_or(many) {
            kept.push((phase, row));
        }
    }
    kept
}

/// Rows of every phase that follow from those before them at all states where the rank is what it is in general.
pub(super) fn redundant(constraints: &Constraints, states: &[State], ranks: &[Option<usize>]) -> Vec<Redundant> {
    let mut found: Vec<Redundant> = Vec::new();
    for state in states.iter().filter(|state| ranks[state.phase] < Some(constraints.active(state.phase).len())) {
        if ranks[state.phase] != Some(constraints.rank(state).0) {
            continue;
        }
        for Redundant { phase, row, sharing } in following(constraints, state) {
            match found.iter_mut().find(|known| (known.phase, known.row) == (phase, row)) {
                Some(known) => known.sharing.extend(sharing),
                None => found.push(Redundant { phase, row, sharing }),
            }
        }
    }
    for known in &mut found {
        known.sharing.sort_unstable();
        known.sharing.dedup();
    }
    found.sort_by_key(|known| (known.phase, known.row));
    found
}

/// Rows that follow from those before them at a state, by orthogonalization in the order of the file.
fn following(constraints: &Constraints, state: &State) -> Vec<Redundant> {
    let n = constraints.n;
    let active = constraints.active(state.phase);
    let lines = constraints.lines(state, active);
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    // Directions, and each row as a combination of them.
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut kept: Vec<(usize, Vec<f64>)> = Vec::new();
    let mut found = Vec::new();
    for (place, &row) in active.iter().enumerate() {
        let line = &lines[place * n..][..n];
        let size = dot(line, line).sqrt();
        let mut rest: Vec<f64> = line.iter().map(|x| if size > 0.0 { x / size } else { 0.0 }).collect();
        let mut parts = vec![0.0; basis.len()];
        for _ in 0..2 {
            for (part, direction) in parts.iter_mut().zip(&basis) {
                let along = dot(&rest, direction);
                *part += along;
                rest.iter_mut().zip(direction).for_each(|(x, y)| *x -= along * y);
            }
        }
        let left = dot(&rest, &rest).sqrt();
        if left > DEPENDENT {
            basis.push(rest.iter().map(|x| x / left).collect());
            parts.push(left);
            kept.push((row, parts));
            continue;
        }
        // Its share of each row before it, the last first.
        let mut sharing = vec![row];
        for (k, (other, of)) in kept.iter().enumerate().rev() {
            let share = parts[k] / of[k];
            parts.iter_mut().zip(of).for_each(|(x, y)| *x -= share * y);
            if share.abs() > TAKES_PART {
                sharing.push(*other);
            }
        }
        found.push(Redundant { phase: state.phase, row, sharing });
    }
    found
}
