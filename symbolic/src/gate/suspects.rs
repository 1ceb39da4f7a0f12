//! Which balances of a system that disagrees are wrong.
//!
//! With Lagrange's accelerations, the multipliers and the reactions that force and moment on the bodies give, every equation in
//! which no other unknown stands is judged by itself.  Equations that share an unknown that nothing tells are judged together, by
//! elimination; suspect are then those without which the others hold.

use super::Gate;
use super::motion::blocks;
use super::results::Values;
use super::state::State;
use super::system::Assembled;
use crate::expr::Measured;
use crate::model::BalanceSystem;

/// Values that bodies give have fewer digits than equations: null spaces of plain matrices stand behind them.
const SAME: f64 = 1e-13;

/// Balances that are off: one, or several of which one is wrong, or all.
pub(super) struct Suspect {
    /// By their places.
    pub balances: Vec<usize>,
    /// Whether the others hold without any one of these.
    pub one_of: bool,
    /// The equations that hang together.
    pub block: Vec<usize>,
    /// The first state at which they are off.
    pub state: usize,
    /// By how much of their terms.
    pub relative: f64,
}

/// A system at all states, with unknowns that are known put in.
pub(super) struct Known<'s> {
    /// What is put in, by the places of the unknowns after the accelerations.
    pub values: Vec<Values>,
    pub states: &'s [State],
    /// The states at which all of this is known.
    pub at: Vec<usize>,
    pub gate: Gate,
    tolerance: f64,
}

impl<'s> Known<'s> {
    /// With multipliers and reactions; what is known at no state counts as unknown.
    pub fn new((reactions, multipliers): (&[Values], &[Values]), states: &'s [State], gate: Gate) -> Known<'s> {
        let values: Vec<Values> = reactions.iter().chain(multipliers).cloned().collect();
        let known: Vec<&Values> = values.iter().filter(|values| values.iter().any(Option::is_some)).collect();
        let at: Vec<usize> = (0..states.len()).filter(|k| known.iter().all(|values| values[*k].is_some())).collect();
        let told = reactions.iter().flatten().any(Option::is_some);
        Known { values, states, at, gate, tolerance: if told { SAME } else { 0.0 } }
    }

    /// The same states with nothing put in.
    pub fn with_nothing(&self) -> Known<'s> {
        Known::new((&[], &[]), self.states, self.gate)
    }

    /// A system with the known values at a state.
    pub fn put(&self, system: &Assembled, state: usize) -> Assembled {
        let values: Vec<Option<Measured>> = self.values.iter().map(|values| values[state]).collect();
        system.put(self.states[state].a.len(), &values)
    }

    /// By how much of their terms these equations of a system with known values are off; `None` where they hold.
    pub fn off(&self, system: &Assembled, equations: &[usize], state: usize) -> Option<f64> {
        let left = system.only(equations).left_over(&self.states[state].a);
        let largest = left.iter().fold(0.0_f64, |most, (_, r)| most.max(r.magnitude));
        let off = left.into_iter().filter(|(_, r)| {
            let size = r.value.abs().to_f64();
            let held = self.gate.agrees(size, r.magnitude, largest) || size <= self.tolerance * r.magnitude;
            size.is_finite() && !held
        });
        off.map(|(_, r)| r.relative()).max_by(f64::total_cmp)
    }

    /// Equations that an unknown connects, whatever the state.
    fn blocks(&self, systems: &[Assembled], n: usize, size: usize) -> Vec<Vec<usize>> {
        let judged = systems.first().map_or(0, |system| system.judged);
        let stands = |e: &usize, column: &usize| {
            systems.iter().any(|system| !system.matrix[e * system.size + column].vanishes(super::ROUNDINGS))
        };
        let pairs = (0..judged).flat_map(|e| (n..size).map(move |column| (e, column)));
        let pairs = pairs.filter(|(e, column)| stands(e, column)).map(|(e, column)| (e, judged + column));
        let blocks = blocks(judged + size, &pairs.collect::<Vec<_>>()).into_iter();
        blocks.map(|block| block.into_iter().filter(|e| *e < judged).collect()).collect()
    }

    /// The balances that are off.
    pub fn suspects(&self, system: &BalanceSystem, assembled: &[Assembled]) -> Vec<Suspect> {
        let of = |b: usize| std::iter::repeat_n(b, system.balances[b].components);
        let owners: Vec<usize> = (0..system.balances.len()).flat_map(of).collect();
        let systems: Vec<Assembled> = self.at.iter().map(|k| self.put(&assembled[*k], *k)).collect();
        let Some((first, state)) = systems.first().zip(self.states.first()) else { return Vec::new() };
        let off = |equations: &[usize]| {
            systems.iter().zip(&self.at).find_map(|(system, k)| Some((*k, self.off(system, equations, *k)?)))
        };
        let mut suspects: Vec<Suspect> = Vec::new();
        for block in self.blocks(&systems, state.a.len(), first.size) {
            let Some((state, relative)) = off(&block) else { continue };
            let mut balances: Vec<usize> = block.iter().filter_map(|e| owners.get(*e)).copied().collect();
            balances.dedup();
            let rest = |b: usize| block.iter().copied().filter(|e| owners.get(*e) != Some(&b)).collect::<Vec<usize>>();
            let without: Vec<usize> = balances.iter().copied().filter(|b| off(&rest(*b)).is_none()).collect();
            let one_of = !without.is_empty();
            let balances = if one_of { without } else { balances };
            // A balance of several components is told once.
            match suspects.iter_mut().find(|other| other.balances == balances) {
                Some(other) => {
                    other.block.extend(block);
                    other.block.sort_unstable();
                }
                None => suspects.push(Suspect { balances, one_of, block, state, relative }),
            }
        }
        suspects
    }
}

/// The suspects with all that is known; where the file may say wrongly where reactions act, and one balance alone explains everything
/// whatever they are, that one.
pub(super) fn suspects<'s>(
    system: &BalanceSystem,
    assembled: &[Assembled],
    (reactions, multipliers): (&[Values], &[Values]),
    (states, gate): (&'s [State], Gate),
) -> (Known<'s>, Vec<Suspect>) {
    let after = assembled.first().zip(states.first()).map_or(0, |(system, state)| system.size - state.a.len());
    let nothing: Vec<Values> = vec![vec![None; states.len()]; after - multipliers.len()];
    let reactions = if reactions.is_empty() { &nothing } else { reactions };
    let known = Known::new((reactions, multipliers), states, gate);
    let found = known.suspects(system, assembled);
    if matches!(found.as_slice(), [one] if one.balances.len() == 1) {
        return (known, found);
    }
    let unknown = Known::new((&nothing, multipliers), states, gate);
    let others = unknown.suspects(system, assembled);
    let alone = matches!(others.as_slice(), [one] if one.balances.len() == 1);
    if found.is_empty() || alone { (unknown, others) } else { (known, found) }
}
