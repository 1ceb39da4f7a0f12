//! Friction that may stick and contacts that may open: what a mechanism says of them, and which phase belongs to what they do.

#[cfg(feature = "alloc")]
use alloc::vec::Vec;
use core::fmt;

use super::{List, Text};

/// All combinations of what contacts do are phases up to so many.
pub const MOST_COMBINATIONS: usize = 256;

/// All contacts of a mechanism.  Its phases are the combinations of their modes, the last contact's changing fastest; where there are more than
/// [`MOST_COMBINATIONS`] of these, the first mode of each, and then each other mode of each contact by itself ([`Contacts::are_single`]).
///
/// ```
/// use dalembert::prelude::*;
/// dalembert::model!(yaml = r#"
/// name: Dropped
/// parameters: {m: 1 kg, g: 9.81 m/s^2, e: 0.5}
/// coordinates: {y: m}
/// bodies: {ball: {mass: m, position: "[0, y]"}}
/// gravity: [0, -g]
/// contacts: {floor: {gap: y, on: ball, normal: "[0, 1]", restitution: e}}
/// scene: {start: {y: 1}, until: 3}
/// "#);
/// let run = Dropped::default().simulate().run()?;
/// // It hops for (1 + e)/(1 − e) √(2 h/g) = 1.35 s and rests.
/// assert!(run.last()["y"].abs() < 1e-12);
/// # Ok::<(), dalembert::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contacts {
    /// In the order of the file.
    pub all: List<Contact>,
    /// What several that strike at once do, where the file says so.
    pub law: Option<ImpactLaw>,
}

/// Friction, or a contact, with what tells its mode.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contact {
    /// Its name.
    pub name: Text,
    /// The row of its gap; absent for friction alone.
    pub normal: Option<u32>,
    /// The row of its sliding rate; absent where nothing rubs. In space the first of two.
    pub tangent: Option<u32>,
    /// In space, where something rubs: the first of three held values, which are the direction of sliding, as components along both rows, and the
    /// rate below which a sliding rate has no direction of its own.
    pub direction: Option<u32>,
    /// The first of its events, in the order of [`ContactEvent`], those that it has.
    pub first_event: u32,
    /// The place of its coefficient of restitution in `System::restitutions`.
    pub restitution: Option<u32>,
}

/// What a contact does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactMode {
    /// Its sides are apart.
    Open,
    /// Its sides touch, and nothing rubs.
    Closed,
    /// Its sides do not slide on each other.
    Sticks,
    /// The sliding rate is not negative.
    SlipsForwards,
    /// The sliding rate is not positive.
    SlipsBackwards,
    /// It slides in the direction that is held, in space.
    Slides,
}

/// What happens to a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactEvent {
    /// Its gap closes.
    Lands,
    /// The force across it falls to 0.
    Lifts,
    /// It stops sliding; or, in space, has turned through a right angle from the direction that is held.
    Stops,
    /// The force with which it sticks reaches its limit: L₀² − T² falls through 0.
    Slips,
}

/// What several contacts that strike at once do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImpactLaw {
    /// One after the other, the fastest approach first, until none approaches.
    Sequential,
    /// All at once, by Newton's law: no rate of a gap is less than −e times what it was.
    Together,
    /// All at once, compressed without restitution, then e times those impulses are given back (Poisson).
    Poisson,
}

/// Those of a mechanism that has none.
pub static NO_CONTACTS: Contacts = Contacts { all: List::Borrowed(&[]), law: None };

impl ContactMode {
    /// Whether the sides touch.
    pub fn touches(self) -> bool {
        self != ContactMode::Open
    }

    /// The sign of the sliding rate, in space of that along the direction that is held; 0 unless it slides.
    pub fn sliding(self) -> f64 {
        match self {
            ContactMode::SlipsForwards | ContactMode::Slides => 1.0,
            ContactMode::SlipsBackwards => -1.0,
            ContactMode::Open | ContactMode::Closed | ContactMode::Sticks => 0.0,
        }
    }
}

/// In words after a contact's name, as in the names of phases.
impl fmt::Display for ContactMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ContactMode::Open => "open",
            ContactMode::Closed => "closed",
            ContactMode::Sticks => "sticks",
            ContactMode::SlipsForwards => "slips forwards",
            ContactMode::SlipsBackwards => "slips backwards",
            ContactMode::Slides => "slides",
        })
    }
}

impl ContactEvent {
    /// Whether it may happen to a contact in this mode.
    pub fn is_of(self, mode: ContactMode) -> bool {
        match self {
            ContactEvent::Lands => !mode.touches(),
            ContactEvent::Lifts => mode.touches(),
            ContactEvent::Stops => mode.sliding() != 0.0,
            ContactEvent::Slips => mode == ContactMode::Sticks,
        }
    }

    /// What leads from one mode to another; `None` where no event does.
    pub fn between(from: ContactMode, to: ContactMode) -> Option<ContactEvent> {
        match (from.touches(), to.touches()) {
            (false, true) => Some(ContactEvent::Lands),
            (true, false) => Some(ContactEvent::Lifts),
            _ if from == to => None,
            _ if to == ContactMode::Sticks => Some(ContactEvent::Stops),
            _ if from == ContactMode::Sticks => Some(ContactEvent::Slips),
            _ => None,
        }
    }
}

impl Contact {
    /// Its events, in order.
    pub fn events(&self) -> impl Iterator<Item = (u32, ContactEvent)> {
        let of_gap = self.normal.map(|_| [ContactEvent::Lands, ContactEvent::Lifts]);
        let of_sliding = self.tangent.map(|_| [ContactEvent::Stops, ContactEvent::Slips]);
        (self.first_event..).zip(of_gap.into_iter().flatten().chain(of_sliding.into_iter().flatten()))
    }

    /// What an event says of it.
    pub fn happened(&self, event: usize) -> Option<ContactEvent> {
        self.events().find(|(own, _)| *own as usize == event).map(|(_, what)| what)
    }

    /// The event at which something happens to it.
    pub fn event(&self, happens: ContactEvent) -> Option<usize> {
        self.events().find(|(_, what)| *what == happens).map(|(event, _)| event as usize)
    }

    /// The rows of its sliding rates: none, one, or in space two.
    pub fn tangents(&self) -> impl Iterator<Item = u32> + Clone + use<> {
        let count = if self.direction.is_some() { 2 } else { 1 };
        self.tangent.into_iter().flat_map(move |first| first..first + count)
    }

    /// The held values that are its direction of sliding in space, by their places.
    pub fn held(&self) -> impl Iterator<Item = u32> + use<> {
        self.direction.into_iter().flat_map(|first| first..first + 3)
    }

    /// Its modes, in the order in which phases count them.
    pub fn modes(&self) -> &'static [ContactMode] {
        use ContactMode::{Closed, Open, Slides, SlipsBackwards, SlipsForwards, Sticks};
        match (self.normal, self.tangent) {
            (Some(_), Some(_)) if self.direction.is_some() => &[Open, Slides, Sticks],
            (Some(_), Some(_)) => &[Open, SlipsForwards, SlipsBackwards, Sticks],
            (Some(_), None) => &[Open, Closed],
            (None, _) => &[SlipsForwards, SlipsBackwards, Sticks],
        }
    }
}

impl Contacts {
    /// The rows of their gaps and sliding rates.
    pub fn rows(&self) -> impl Iterator<Item = u32> {
        self.all.iter().flat_map(|contact| contact.normal.into_iter().chain(contact.tangents()))
    }

    /// How many combinations of what they do there are; `None`: more than a `usize` counts.
    pub fn combinations(&self) -> Option<usize> {
        self.all.iter().try_fold(1_usize, |count, contact| count.checked_mul(contact.modes().len()))
    }

    /// Whether these are so many that only what each contact does by itself is a phase: such a mechanism is for time stepping.
    pub fn are_single(&self) -> bool {
        self.combinations().is_none_or(|count| count > MOST_COMBINATIONS)
    }

    /// The mode of each contact in a phase.
    #[cfg(feature = "alloc")]
    pub fn modes(&self, phase: usize) -> Vec<ContactMode> {
        if self.are_single() {
            let mut rest = phase;
            let of = |contact: &Contact| {
                let modes = contact.modes();
                let place = if (1..modes.len()).contains(&rest) { rest } else { 0 };
                // Beyond its own phases, or before them, it is as at first.
                rest = if rest < modes.len() { 0 } else { rest - (modes.len() - 1) };
                modes[place]
            };
            return self.all.iter().map(of).collect();
        }
        let mut rest = phase;
        let mut modes: Vec<ContactMode> = self
            .all
            .iter()
            .rev()
            .map(|contact| {
                let modes = contact.modes();
                let mode = modes[rest % modes.len()];
                rest /= modes.len();
                mode
            })
            .collect();
        modes.reverse();
        modes
    }

    /// The phase in which the contacts are in these modes; of contacts of which only single ones have phases, that of the first one that is not
    /// as at first.
    pub fn phase(&self, modes: &[ContactMode]) -> usize {
        let place =
            |(contact, mode): (&Contact, &ContactMode)| contact.modes().iter().position(|of| of == mode).unwrap_or(0);
        if self.are_single() {
            let mut before = 0;
            for pair in self.all.iter().zip(modes) {
                match place(pair) {
                    0 => before += pair.0.modes().len() - 1,
                    place => return before + place,
                }
            }
            return 0;
        }
        self.all.iter().zip(modes).fold(0, |phase, pair| phase * pair.0.modes().len() + place(pair))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use alloc::vec::Vec;

    #[test]
    fn phases_count_combinations_of_modes() {
        let rubs = Contact { tangent: Some(0), ..Contact::default() };
        let strikes = Contact { normal: Some(1), ..Contact::default() };
        let both = Contact { normal: Some(2), tangent: Some(3), ..Contact::default() };
        let contacts = Contacts { all: vec![rubs, strikes, both].into(), law: None };
        let all: Vec<Vec<ContactMode>> = (0..24).map(|phase| contacts.modes(phase)).collect();
        assert!(all.iter().enumerate().all(|(phase, modes)| contacts.phase(modes) == phase));
        assert_eq!(all[0], [ContactMode::SlipsForwards, ContactMode::Open, ContactMode::Open]);
        assert_eq!(all[5], [ContactMode::SlipsForwards, ContactMode::Closed, ContactMode::SlipsForwards]);
        assert_eq!(all[23], [ContactMode::Sticks, ContactMode::Closed, ContactMode::Sticks]);
    }

    #[test]
    fn of_too_many_contacts_each_has_phases_by_itself() {
        let both = Contact { normal: Some(0), tangent: Some(1), ..Contact::default() };
        let rubs = Contact { tangent: Some(2), ..Contact::default() };
        let all = vec![both.clone(), rubs, both.clone(), both.clone(), both];
        let contacts = Contacts { all: all.into(), law: None };
        assert!(contacts.combinations() == Some(768) && contacts.are_single());
        let phases: Vec<Vec<ContactMode>> = (0..15).map(|phase| contacts.modes(phase)).collect();
        assert!(phases.iter().enumerate().all(|(phase, modes)| contacts.phase(modes) == phase));
        let first =
            [ContactMode::Open, ContactMode::SlipsForwards, ContactMode::Open, ContactMode::Open, ContactMode::Open];
        assert_eq!(phases[0], first);
        let others = |modes: &Vec<ContactMode>| modes.iter().zip(&first).filter(|(mode, first)| mode != first).count();
        assert!(phases[1..].iter().all(|modes| others(modes) == 1));
        assert_eq!(phases[14][4], ContactMode::Sticks);
    }
}
