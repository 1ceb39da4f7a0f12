//! Limits of friction, and the forces without it, by what phases in which one contact slides make of them.

use super::law::Limit;
use super::rows::{Row, rows_of};
use crate::constrain::{direction, held_direction};
use crate::mechanism::{At, Contact, ContactEvent, ContactMode, System};

/// Forces made of reactions are none below this part of the largest: what is left where those of sliding forwards and backwards cancel.
const NOTHING: f64 = 1e-12;
/// Rates along a contact depend on each other whose Gram determinant is below this part of the product of their squares: half of the digits are left.
const DEPENDENT: f64 = 1e-8;

/// What does not depend on which contacts are closed.
pub(super) struct Forces {
    /// h without friction.
    pub bias: Vec<f64>,
    /// Of each friction alone, by the place of its contact, its limit.
    pub frictions: Vec<(usize, Force)>,
    /// B of the first phase.
    first: Vec<f64>,
    /// A row of whose multiplier a force is made that is no friction.
    pub reaction: Option<usize>,
}

/// A limit as a force: what no multiplier makes, and what those of rows of the mechanism make of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Force {
    pub own: f64,
    pub of_rows: Vec<(usize, f64)>,
}

impl Force {
    /// What the multiplier of a row makes of it.
    pub fn of(&self, row: usize) -> f64 {
        self.of_rows.iter().find(|(known, _)| *known == row).map_or(0.0, |(_, factor)| *factor)
    }

    /// As an impulse over h, where the impulse of a row of the mechanism is given by those of the rows of a step.
    pub fn over(&self, h: f64, of_row: &dyn Fn(usize) -> Limit) -> Limit {
        let mut limit = Limit { own: h * self.own, of_rows: Vec::new() };
        for (row, factor) in &self.of_rows {
            let Limit { own, of_rows } = of_row(*row);
            limit.own += factor * own;
            limit.of_rows.extend(of_rows.into_iter().map(|(row, part)| (row, factor * part)));
        }
        limit
    }
}

/// The phase in which one contact is in another mode than at first, the others as at first.
fn phase_of(system: &dyn System, contact: usize, mode: ContactMode) -> usize {
    let contacts = system.contacts();
    let mut modes: Vec<ContactMode> = contacts.all.iter().map(|contact| contact.modes()[0]).collect();
    modes[contact] = mode;
    contacts.phase(&modes)
}

/// The frictions alone, by their places.
pub(super) fn frictions(contacts: &[Contact]) -> impl Iterator<Item = usize> + '_ {
    (0..contacts.len()).filter(|k| contacts[*k].normal.is_none())
}

fn friction_of(system: &dyn System, at: At<'_>) -> Vec<f64> {
    let mut values = vec![0.0; system.description().friction_pattern.len()];
    system.friction(at, &mut values);
    values
}

/// A row of whose multiplier a force is made at a state that is no friction of `friction` or `contacts`.
pub(crate) fn made_of_reactions(system: &mut dyn System, t: f64, y: &[f64]) -> Option<usize> {
    let at = At::packed(t, y, system.len());
    let (contacts, rows) = (system.contacts().all.to_vec(), rows_of(system, at));
    Forces::new(system, at, &contacts, &|row| rows[row].clone()).reaction
}

impl Forces {
    /// At a state, in the first phase, in which frictions alone slide forwards and all contacts are open.
    pub fn new(system: &mut dyn System, at: At<'_>, contacts: &[Contact], row: &dyn Fn(usize) -> Row) -> Forces {
        let n = system.len();
        let mut bias = vec![0.0; n];
        system.bias(at, &mut bias);
        let first = friction_of(system, at);
        let (forwards, mut free) = (bias.clone(), first.clone());
        let mut found = Vec::new();
        for k in frictions(contacts) {
            let Some(tangent) = contacts[k].tangent else { continue };
            let phase = phase_of(system, k, ContactMode::SlipsBackwards);
            system.set_phase(phase);
            let mut backwards = vec![0.0; n];
            system.bias(at, &mut backwards);
            let rubbed = friction_of(system, at);
            system.set_phase(0);
            let along = row(tangent as usize);
            let half: Vec<f64> = backwards.iter().zip(&forwards).map(|(b, f)| 0.5 * (b - f)).collect();
            let changed: Vec<f64> = rubbed.iter().zip(&first).map(|(b, f)| 0.5 * (b - f)).collect();
            bias.iter_mut().zip(&half).for_each(|(bias, half)| *bias += half);
            free.iter_mut().zip(&changed).for_each(|(free, changed)| *free += changed);
            // Backwards it pushes with L along the rate, and h is what pushes the other way.
            let own = -along.dot(&half) / along.square();
            found.push((k, Force { own, of_rows: by_rows(system, &changed, &[along], [1.0, 0.0]) }));
        }
        let most = first.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let left = free.iter().position(|x| x.abs() > NOTHING * most);
        let reaction = left.map(|place| system.description().friction_pattern[place].1 as usize);
        Forces { bias, frictions: found, first, reaction }
    }

    /// The sign with which the multiplier of a row enters the limit of a friction; 1 where it does not.
    pub fn sign_of(&self, friction: usize, row: usize) -> f64 {
        let force = self.frictions.iter().find(|(k, _)| *k == friction);
        force.map_or(1.0, |(_, force)| if force.of(row) < 0.0 { -1.0 } else { 1.0 })
    }

    /// The limit of sliding of a contact that rubs.
    pub fn of_contact(
        &self,
        system: &mut dyn System,
        at: At<'_>,
        (k, contact): (usize, &Contact),
        (rows, sliding): (&[Row], [f64; 2]),
    ) -> Force {
        let mode = if contact.direction.is_some() { ContactMode::Slides } else { ContactMode::SlipsForwards };
        let phase = phase_of(system, k, mode);
        system.set_phase(phase);
        let rubbed = friction_of(system, at);
        system.set_phase(0);
        let towards = match contact.direction {
            Some(_) => direction(sliding, held_direction(system, k)),
            None => [1.0, 0.0],
        };
        let changed: Vec<f64> = rubbed.iter().zip(&self.first).map(|(rubbed, first)| first - rubbed).collect();
        Force { own: 0.0, of_rows: by_rows(system, &changed, rows, towards) }
    }
}

/// How large a force along some rows is per multiplier of each row, positive where it is in this direction.  In which direction it is where the rate is
/// rounding only generated code knows: it is measured by all its components.
fn by_rows(system: &dyn System, values: &[f64], rows: &[Row], towards: [f64; 2]) -> Vec<(usize, f64)> {
    let pattern = &system.description().friction_pattern;
    let mut found: Vec<(usize, [f64; 2])> = Vec::new();
    for ((coordinate, row), value) in pattern.iter().zip(values) {
        let [first, second] = [0, 1].map(|k| rows.get(k).map_or(0.0, |along| value * along.at(*coordinate as usize)));
        if first == 0.0 && second == 0.0 {
            continue;
        }
        match found.iter_mut().find(|(known, _)| *known == *row as usize) {
            Some((_, sums)) => *sums = [sums[0] + first, sums[1] + second],
            None => found.push((*row as usize, [first, second])),
        }
    }
    let size = |[first, second]: [f64; 2]| match rows {
        [one, other] => {
            let (a, b, d) = (one.square(), one.times(other), other.square());
            let determinant = a * d - b * b;
            let [x, y] = match determinant > DEPENDENT * a * d {
                true => [(d * first - b * second) / determinant, (a * second - b * first) / determinant],
                // It slides along one line only, as where the other rate is none.
                false => [first / (a + d), second / (a + d)],
            };
            x.hypot(y).copysign(x * towards[0] + y * towards[1])
        }
        _ => first / rows[0].square(),
    };
    found.into_iter().map(|(row, sums)| (row, size(sums))).collect()
}

/// The limits of sticking of all contacts and frictions with these multipliers, with which nothing is held along: their events tell L₀² − T².
pub(super) fn sticking(system: &dyn System, at: At<'_>, contacts: &[Contact], lambda: &[f64]) -> Vec<f64> {
    let (zero, mut pairs) = (vec![0.0; system.len()], vec![0.0; 2 * system.description().events.len()]);
    system.events(at.accelerated(&zero).constrained(lambda), &mut pairs);
    let limit =
        |contact: &Contact| contact.event(ContactEvent::Slips).map_or(0.0, |event| pairs[2 * event].max(0.0).sqrt());
    contacts.iter().map(limit).collect()
}
