//! Whether contacts and friction do at a rest what they are taken to do there.

use crate::linear::{Guess, short};
use crate::mechanism::dense::sizes_alike;
use crate::mechanism::{At, Contact, ContactEvent, System};

/// What is missed by no more than this part of what it is made of is rounding.
const ROUNDED: f64 = 1e-9;

/// A contact whose sides pass through each other or pull, and friction beyond its limit: in the phase that was looked at all of it is possible.
pub fn notes(system: &dyn System, rest: &Guess) -> Vec<String> {
    let mut system = system.boxed_clone();
    rest.inputs.iter().enumerate().for_each(|(input, value)| system.hold_input(input, *value));
    let (contacts, description) = (system.contacts(), system.description());
    let (n, rows) = (system.len(), description.rows.len());
    let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; rows]);
    let at = At::new(0.0, &rest.q, &rest.v);
    if contacts.all.is_empty() || system.accelerations_and_multipliers(at, &mut a, &mut lambda).is_err() {
        return Vec::new();
    }
    let mut pairs = vec![0.0; 2 * description.events.len()];
    let at = at.accelerated(&a).constrained(&lambda);
    system.events(at, &mut pairs);
    let place = sizes_alike(description, &rest.q).into_iter().fold(0.0, f64::max);
    let mut forces = vec![0.0; n];
    system.magnitudes(at, &mut forces);
    let force = forces.into_iter().chain(lambda.iter().map(|x| x.abs())).fold(0.0, f64::max);
    let modes = contacts.modes(system.phase());
    // Nor do forces have a unit where lengths have none.
    let with_unit = |value: f64, contact: &Contact, unit: &str| match contact.normal {
        Some(row) if description.rows[row as usize].unit.is_empty() => short(value),
        _ => format!("{} {unit}", short(value)),
    };
    let broken = |(contact, mode): (&Contact, _)| {
        contact.events().filter(|(_, what)| what.is_of(mode)).find_map(|(event, what)| {
            let value = pairs[2 * event as usize];
            let (scale, says) = match what {
                ContactEvent::Lands => {
                    (place, format!("its sides pass through each other by {}", with_unit(-value, contact, "m")))
                }
                ContactEvent::Lifts => {
                    (force, format!("its sides pull at each other with {}", with_unit(-value, contact, "N")))
                }
                ContactEvent::Slips => (force * force, "it takes more friction than there is".to_owned()),
                ContactEvent::Stops => return None,
            };
            (value < -ROUNDED * scale).then(|| format!("`{}` ({mode}): {says}", contact.name))
        })
    };
    let told = contacts.all.iter().zip(modes).filter_map(broken);
    told.map(|told| format!("{told}; this is no rest, look for one with another --phase or --at")).collect()
}
