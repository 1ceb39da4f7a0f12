//! What contacts and friction do at a rest, which small motions leave as it is, and whether it is possible there.

use std::io::{self, Write};

use serde_json::{Value, json};

use super::super::json::{number, object};
use crate::linear::{Guess, short, short_within};
use crate::mechanism::dense::sizes_alike;
use crate::mechanism::{At, Contact, ContactEvent, ContactMode, System};

/// What is missed by no more than this part of what it is made of is rounding.
const ROUNDED: f64 = 1e-9;
/// What is nearer than this part of it to where it would change, a force or friction, is on the edge: no digits of a file's parameters tell its sides.
const EDGE: f64 = 1e-6;

/// What all contacts do at a rest.
#[derive(Default)]
pub struct ContactsAtRest {
    contacts: Vec<ContactAtRest>,
    /// What is not possible there, or just so.
    pub warnings: Vec<String>,
}

struct ContactAtRest {
    name: String,
    mode: ContactMode,
    /// The part of the limit that its friction takes where it sticks.
    takes: Option<f64>,
}

/// A state with the functions of all events there.
struct Rest<'a> {
    system: &'a dyn System,
    lambda: Vec<f64>,
    /// Pairs (value, condition) of the events.
    pairs: Vec<f64>,
    /// The largest place, and the largest force.
    place: f64,
    force: f64,
}

impl ContactsAtRest {
    /// At a rest in the phase in force.
    pub fn of(system: &dyn System, rest: &Guess) -> ContactsAtRest {
        let mut system = system.boxed_clone();
        rest.inputs.iter().enumerate().for_each(|(input, value)| system.hold_input(input, *value));
        let Some(there) = Rest::new(&*system, rest) else { return ContactsAtRest::default() };
        let modes = system.contacts().modes(system.phase());
        let all = || system.contacts().all.iter().zip(modes.iter().copied());
        let contact = |(contact, mode): (&Contact, ContactMode)| ContactAtRest {
            name: contact.name.to_string(),
            mode,
            takes: there.takes(contact).filter(|_| mode == ContactMode::Sticks),
        };
        let warnings =
            all().filter_map(|(contact, mode)| there.broken(contact, mode).or_else(|| there.edge(contact, mode)));
        ContactsAtRest { contacts: all().map(contact).collect(), warnings: warnings.collect() }
    }

    /// For people.
    pub fn table(&self, out: &mut dyn Write) -> io::Result<()> {
        let told = |contact: &ContactAtRest| {
            let takes = contact.takes.map(|part| format!(" (takes {} of its limit)", short_within(part, EDGE)));
            format!("{} {}{}", contact.name, contact.mode, takes.unwrap_or_default())
        };
        let list: Vec<String> = self.contacts.iter().map(told).collect();
        if list.is_empty() { Ok(()) } else { writeln!(out, "frozen there: {}", list.join(", ")) }
    }

    /// For programs.
    pub fn as_json(&self) -> Option<(&'static str, Value)> {
        let one = |contact: &ContactAtRest| {
            let takes = contact.takes.map(|part| ("part_of_limit", number(part)));
            object([("mode", json!(contact.mode.to_string()))].into_iter().chain(takes))
        };
        let list = self.contacts.iter().map(|contact| (contact.name.clone(), one(contact)));
        (!self.contacts.is_empty()).then(|| ("contacts", object(list)))
    }
}

impl<'a> Rest<'a> {
    /// `None` without contacts, or where there are no forces.
    fn new(system: &'a dyn System, rest: &Guess) -> Option<Rest<'a>> {
        let description = system.description();
        let (n, rows) = (system.len(), description.rows.len());
        let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; rows]);
        let at = At::new(0.0, &rest.q, &rest.v);
        if system.contacts().all.is_empty() {
            return None;
        }
        system.accelerations_and_multipliers(at, &mut a, &mut lambda).ok()?;
        let (mut pairs, mut forces) = (vec![0.0; 2 * description.events.len()], vec![0.0; n]);
        let at = at.accelerated(&a).constrained(&lambda);
        system.events(at, &mut pairs);
        system.magnitudes(at, &mut forces);
        let place = sizes_alike(description, &rest.q).into_iter().fold(0.0, f64::max);
        let force = forces.into_iter().chain(lambda.iter().map(|x| x.abs())).fold(0.0, f64::max);
        Some(Rest { system, lambda, pairs, place, force })
    }

    /// The value of the function of what would end a mode.
    fn value(&self, contact: &Contact, event: ContactEvent) -> Option<f64> {
        contact.event(event).map(|event| self.pairs[2 * event])
    }

    /// The part of its limit that the friction of a contact takes: its event is limit² − force².
    fn takes(&self, contact: &Contact) -> Option<f64> {
        let square: f64 = contact.tangents().map(|row| self.lambda[row as usize].powi(2)).sum();
        let limit = self.value(contact, ContactEvent::Slips)? + square;
        (limit > 0.0).then(|| (square / limit).sqrt())
    }

    /// That the sides of a contact pass through each other or pull, or that friction is beyond its limit: in the phase that was looked at all of it is
    /// possible.
    fn broken(&self, contact: &Contact, mode: ContactMode) -> Option<String> {
        // Nor do forces have a unit where lengths have none.
        let with_unit = |value: f64, unit: &str| match contact.normal {
            Some(row) if self.system.description().rows[row as usize].unit.is_empty() => short(value),
            _ => format!("{} {unit}", short(value)),
        };
        let told = contact.events().filter(|(_, what)| what.is_of(mode)).find_map(|(_, what)| {
            let value = self.value(contact, what)?;
            let (scale, says) = match what {
                ContactEvent::Lands => {
                    (self.place, format!("its sides pass through each other by {}", with_unit(-value, "m")))
                }
                ContactEvent::Lifts => {
                    (self.force, format!("its sides pull at each other with {}", with_unit(-value, "N")))
                }
                ContactEvent::Slips => (self.force * self.force, "it takes more friction than there is".to_owned()),
                ContactEvent::Stops => return None,
            };
            (value < -ROUNDED * scale).then(|| format!("`{}` ({mode}): {says}", contact.name))
        });
        told.map(|told| format!("{told}; this is no rest, look for one with another --phase or --at"))
    }

    /// That a contact only just sticks, or is only just closed.
    fn edge(&self, contact: &Contact, mode: ContactMode) -> Option<String> {
        let carries = self.value(contact, ContactEvent::Lifts).filter(|_| mode.touches());
        let why = if mode == ContactMode::Sticks && self.takes(contact).is_some_and(|part| part > 1.0 - EDGE) {
            "takes all of its friction but a millionth, and slips"
        } else if carries.is_some_and(|force| force <= EDGE * self.force) {
            "carries next to nothing, and opens"
        } else {
            return None;
        };
        Some(format!("`{}` ({mode}) is on the edge: it {why} at the least departure that asks for more", contact.name))
    }
}
