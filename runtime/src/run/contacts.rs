//! What contacts did in a run, and how near those that stuck came to slipping.

use super::extremes::extremes;
use super::{Continuous, Run};
use crate::constrain::with_shares;
use crate::integrate::ContactTally;
use crate::mechanism::{At, Contact, ContactEvent, ContactMode};

/// What a contact, or friction, did in a run.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ContactHistory {
    /// Its name.
    pub name: String,
    /// The modes that it had, each with how long altogether, s, in the order of [`Contact::modes`].
    pub modes: Vec<(ContactMode, f64)>,
    /// The largest part |T|/L of its limit L that held it where it stuck, 0 to 1; `None` where it never stuck, and of a run without dense
    /// output.  Of several contacts that share a force it is one share of many.
    pub held: Option<f64>,
}

impl Run {
    /// What each contact did, in the order of the file.
    ///
    /// # Example
    /// ```
    /// use dalembert::mechanism::ContactMode;
    /// use dalembert::prelude::*;
    /// # dalembert::model!(yaml = r#"
    /// # name: Block
    /// # parameters: {m: 1 kg, F: 3 N, L: 4 N}
    /// # coordinates: {x: m}
    /// # bodies: {b: {mass: m, position: "[x, 0]"}}
    /// # forces: {pull: {on: b, force: "[F, 0]"}}
    /// # friction: {rub: {rate: x', on: b, along: "[1, 0]", limit: L}}
    /// # scene: {start: {x: 0}, until: 3}
    /// # "#);
    /// let run = Block::default().simulate().run()?;
    /// let rub = &run.contacts()[0];
    /// assert_eq!(rub.modes, [(ContactMode::Sticks, 3.0)]);
    /// assert!((rub.held.unwrap() - 0.75).abs() < 1e-12);
    /// # Ok::<(), dalembert::Error>(())
    /// ```
    pub fn contacts(&self) -> Vec<ContactHistory> {
        let Some(system) = self.scenery.system() else { return Vec::new() };
        let contacts = system.contacts();
        if contacts.all.is_empty() {
            return Vec::new();
        }
        if let Some(tally) = &self.tally {
            let of = |(contact, tally): (&Contact, &ContactTally)| ContactHistory {
                name: contact.name.to_string(),
                modes: contact
                    .modes()
                    .iter()
                    .copied()
                    .zip(tally.modes.iter().copied())
                    .filter(|(_, span)| *span > 0.0)
                    .collect(),
                held: None,
            };
            return contacts.all.iter().zip(&tally.contacts).map(of).collect();
        }
        let end = self.times.last().copied().unwrap_or(0.0);
        let until = self.phases.iter().skip(1).map(|(t, _)| *t).chain([end]);
        let spans: Vec<(Vec<ContactMode>, f64)> =
            self.phases.iter().zip(until).map(|((from, phase), to)| (contacts.modes(*phase), to - from)).collect();
        let stuck = spans.iter().any(|(modes, _)| modes.contains(&ContactMode::Sticks));
        let held = if stuck { self.held_by(&contacts.all) } else { vec![None; contacts.all.len()] };
        let history = |(k, (contact, held)): (usize, (&Contact, Option<f64>))| {
            let total = |mode: &ContactMode| {
                let own = spans.iter().filter(|(modes, _)| modes[k] == *mode);
                own.fold(None, |sum: Option<f64>, (_, span)| Some(sum.unwrap_or(0.0) + span))
            };
            let modes = contact.modes().iter().filter_map(|mode| Some((*mode, total(mode)?)));
            ContactHistory { name: contact.name.to_string(), modes: modes.collect(), held }
        };
        contacts.all.iter().zip(held).enumerate().map(history).collect()
    }

    /// Of each contact the largest |T|/L where it sticks: L² − T² is the function of the event at which it slips.
    fn held_by(&self, contacts: &[Contact]) -> Vec<Option<f64>> {
        let Some(mut own) = Continuous::new(self, &[]) else { return vec![None; contacts.len()] };
        let steps = own.steps().to_vec();
        let n = self.description.coordinates.len();
        let mut functions = vec![0.0; 2 * self.description.events.len()];
        let ranges = extremes(&steps, contacts.len(), &mut |step, t, values| {
            values.fill(f64::NAN);
            let (system, y) = own.state(step, t);
            let modes = system.contacts().modes(system.phase());
            let at = At::packed(t, y, n);
            if !modes.contains(&ContactMode::Sticks) {
                return;
            }
            let Ok((a, lambda)) = with_shares(system, at) else { return };
            system.events(at.accelerated(&a).constrained(&lambda), &mut functions);
            for ((contact, mode), value) in contacts.iter().zip(&modes).zip(values) {
                if let (ContactMode::Sticks, Some(event)) = (mode, contact.event(ContactEvent::Slips)) {
                    let force = contact.tangents().fold(0.0_f64, |force, row| force.hypot(lambda[row as usize]));
                    let part = force / (functions[2 * event] + force * force).max(0.0).sqrt();
                    *value = if force == 0.0 { 0.0 } else { part.min(1.0) };
                }
            }
        });
        ranges.into_iter().map(|(low, high)| (low <= high).then_some(high)).collect()
    }
}
