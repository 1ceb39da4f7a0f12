//! Discontinuities at a point of rest: which side of each holds, and dry friction, which holds a whole set of points.

use super::point::{LinearisationPoint, OneSide};
use crate::constrain::STILL;
use crate::mechanism::dense::{constraint_matrix, constraint_triples};
use crate::mechanism::{At, ContactMode, SwitchKind, System};

/// A switch whose surface a state lies on.
#[derive(Clone, Debug, PartialEq)]
pub struct Jump {
    /// Its argument, `x'` of `sign(x')`; or what else makes the force jump.
    pub switch: String,
    /// Half of the jump of each generalized force, SI: dry friction at rest may be anything between ± this.
    pub force: Vec<f64>,
}

/// Speeds that tell one side of rest from the other, relative to what speeds can be.
const SMALL_SPEED: f64 = 1e-7;

impl LinearisationPoint {
    /// The forces that jump where a state lies: those of switches on their surface, and those that are large at the
    /// least speed to either side (`unit` and `norm` of a velocity).
    pub(super) fn jumps(&self, q: &[f64]) -> Vec<Jump> {
        if self.is_smooth() {
            return Vec::new();
        }
        let measure = self.measure(q);
        let jump = |switch: usize| {
            let [low, high] = self.sides(q, switch);
            let force: Vec<f64> = high.force.iter().zip(&low.force).map(|(a, b)| 0.5 * (a - b)).collect();
            let jumps = force.iter().zip(&measure).any(|(f, measure)| f.abs() > 1e-12 * measure);
            jumps.then(|| Jump { switch: self.switch(switch).0, force })
        };
        let list: Vec<Jump> = self.on_surface(q).into_iter().filter_map(jump).collect();
        if list.is_empty() { self.jumps_of_speed(q, &measure) } else { list }
    }

    /// A switch at whose surface a state lies where forces or constraints differ from side to side: not one of an input's function of time,
    /// which stands still.
    pub fn jump(&self, q: &[f64]) -> Option<String> {
        let differs = |switch: &usize| {
            let [low, high] = self.sides(q, *switch);
            [[low.force, high.force], [low.constraints, high.constraints]].iter().any(differ)
        };
        self.on_surface(q).into_iter().find(differs).map(|switch| self.switch(switch).0)
    }

    /// A contact that slips in the phase in force though its sides do not move on each other, and whose friction, which would hold them, jumps with the
    /// direction: what rests there is any state near by that friction can hold.
    pub(super) fn slips_at_rest(&self, q: &[f64]) -> Option<String> {
        let system = self.system.borrow();
        let (contacts, at) = (system.contacts(), At::new(0.0, q, &self.v));
        let modes = contacts.modes(system.phase());
        let acts = |modes: &[ContactMode]| {
            let mut own = system.boxed_clone();
            own.set_phase(contacts.phase(modes));
            let (mut a, mut lambda) = (vec![0.0; self.n], vec![0.0; system.description().rows.len()]);
            own.accelerations_and_multipliers(at, &mut a, &mut lambda).ok().map(|()| [a, lambda].concat())
        };
        let slips = |k: &usize| {
            let other = match modes[*k] {
                ContactMode::SlipsForwards => ContactMode::SlipsBackwards,
                ContactMode::SlipsBackwards => ContactMode::SlipsForwards,
                _ => return false,
            };
            let mut turned = modes.clone();
            turned[*k] = other;
            stands(&**system, at, *k) && acts(&modes).zip(acts(&turned)).is_none_or(|(a, b)| differ(&[a, b]))
        };
        (0..modes.len()).find(slips).map(|k| contacts.all[k].name.to_string())
    }

    pub(super) fn sides(&self, q: &[f64], switch: usize) -> [OneSide; 2] {
        let below = match self.switch(switch).1 {
            SwitchKind::Sign => -1.0,
            SwitchKind::Step => 0.0,
        };
        [below, 1.0].map(|side| self.with_mode(q, switch, side))
    }

    /// What jumps though no switch does: F at a small speed to either side of rest.
    fn jumps_of_speed(&self, q: &[f64], measure: &[f64]) -> Vec<Jump> {
        let jump = |coordinate: usize| {
            if self.v[coordinate] != 0.0 {
                return None;
            }
            let [high, low] = [SMALL_SPEED, -SMALL_SPEED].map(|speed| self.force_moving(q, coordinate, speed));
            let force: Vec<f64> = high.iter().zip(&low).map(|(a, b)| 0.5 * (a - b)).collect();
            // A viscous force is as small as the speed: a tenth of it at a tenth of the speed.
            let [high, low] = [0.1, -0.1].map(|part| self.force_moving(q, coordinate, part * SMALL_SPEED));
            let slower: Vec<f64> = high.iter().zip(&low).map(|(a, b)| 0.5 * (a - b)).collect();
            let stays =
                |((f, slow), measure): ((&f64, &f64), &f64)| f.abs() > 1e-12 * measure && slow.abs() > 0.5 * f.abs();
            let name = format!("{}'", self.names()[coordinate]);
            force.iter().zip(&slower).zip(measure).any(stays).then_some(Jump { switch: name, force })
        };
        (0..self.n).filter_map(jump).collect()
    }
}

/// Whether the sliding rate of a contact is zero, as far as rounding tells.
fn stands(system: &dyn System, at: At<'_>, contact: usize) -> bool {
    let triples = constraint_triples(system, at);
    let is_zero = |row: usize| {
        let matrix = constraint_matrix(system, at, &[row]);
        let moving = at.v.iter().enumerate().map(|(i, v)| matrix[(0, i)] * v);
        let (sum, terms) = moving.fold((0.0, 0.0), |(sum, terms), term| (sum + term, terms + term.abs()));
        triples[row][1].abs() <= STILL * (terms + (triples[row][1] - sum).abs())
    };
    system.contacts().all[contact].tangents().all(|row| is_zero(row as usize))
}

/// Whether numbers differ by more than rounding of the largest.
pub(super) fn differ([low, high]: &[Vec<f64>; 2]) -> bool {
    let largest = high.iter().chain(low).fold(0.0_f64, |most, x| most.max(x.abs()));
    high.iter().zip(low).any(|(a, b)| (a - b).abs() > 1e-12 * largest)
}

/// True where friction can balance a force: F + Σ sₖ Jₖ = 0 to rounding for some −1 ≤ sₖ ≤ 1.
pub(super) fn held(force: &[f64], jumps: &[Jump], balanced: &dyn Fn(&[f64]) -> bool) -> bool {
    if jumps.is_empty() {
        return false;
    }
    let mut left = force.to_vec();
    let mut parts = vec![0.0_f64; jumps.len()];
    // One part after the other, each as far as it may go: a convex problem in a box.
    for _ in 0..500 {
        for (part, jump) in parts.iter_mut().zip(jumps) {
            let square: f64 = jump.force.iter().map(|f| f * f).sum();
            let along: f64 = left.iter().zip(&jump.force).map(|(l, f)| l * f).sum();
            let next = (*part - along / square).clamp(-1.0, 1.0);
            for (l, f) in left.iter_mut().zip(&jump.force) {
                *l += (next - *part) * f;
            }
            *part = next;
        }
        if balanced(&left) {
            return true;
        }
    }
    false
}
