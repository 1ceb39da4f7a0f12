//! What runs that step over contacts are made of, and what they refuse.

use std::borrow::Cow;

use super::{Settings, set_up};
use crate::cause::Cause;
use crate::constrain::closed_within;
use crate::error::{Error, Unsteppable};
use crate::integrate::made_of_reactions;
use crate::mechanism::dense::constraint_triples;
use crate::mechanism::{Action, At, Enforcement, Method, System};

/// What depends on accelerations and multipliers shows where these are multiples of such numbers, which stand in no ratio to each other: the golden
/// ratio,
const FIRST: f64 = 0.618_033_988_749_894_8;
/// and the plastic number, x³ = x + 1.
const SECOND: f64 = 1.324_717_957_244_746;
/// States beside the start at which forces are asked whether they are made of reactions: coordinates and rates are moved by parts of these, SI.
const ASIDE: [f64; 3] = [0.0, 0.37, 1.19];

/// Settings of a run over contacts: it is in the first phase, and the events of contacts do nothing; as they are for other methods.
pub(super) fn over_contacts<'a>(system: &dyn System, settings: &'a Settings) -> Cow<'a, Settings> {
    if settings.method != Method::Moreau {
        return Cow::Borrowed(settings);
    }
    let mut ignored_events = settings.ignored_events.clone();
    ignored_events.extend(of_contacts(system));
    ignored_events.sort_unstable();
    ignored_events.dedup();
    Cow::Owned(Settings { phase: 0, ignored_events, ..settings.clone() })
}

fn of_contacts(system: &dyn System) -> Vec<usize> {
    system.contacts().all.iter().flat_map(|contact| contact.events().map(|(event, _)| event as usize)).collect()
}

/// Refuses what steps over contacts do not take, and of methods that locate events what only these take.
pub(super) fn check(system: &dyn System, settings: &Settings) -> Result<(), Error> {
    let contacts = system.contacts();
    if settings.method != Method::Moreau {
        if !contacts.are_single() {
            return Ok(());
        }
        let (method, combinations) = (settings.method, contacts.combinations());
        return Err(Error::TooManyCombinations { method, contacts: contacts.all.len(), combinations });
    }
    match in_the_way(system, settings) {
        Some(reason) => Err(Error::NoTimeStepping { reason }),
        None => Ok(()),
    }
}

fn in_the_way(system: &dyn System, settings: &Settings) -> Option<Unsteppable> {
    if system.contacts().all.is_empty() {
        return Some(Unsteppable::NoContacts);
    }
    let multipliers = settings.enforcement == Enforcement::Multipliers && settings.alpha() == 0.0;
    if system.derivation().is_some() || !multipliers {
        return Some(Unsteppable::Enforcement);
    }
    let mut own = system.boxed_clone();
    let mut y = set_up(&mut *own, &Settings { phase: 0, ..settings.clone() });
    let n = own.len();
    y.resize(2 * n, 0.0);
    strikes(&*own)
        .or_else(|| event(&*own, (settings.from, &y), settings))
        .or_else(|| reaction(&mut *own, settings.from, &y))
}

/// An event of the file, not one of contacts, that strikes or goes to another phase.
fn strikes(system: &dyn System) -> Option<Unsteppable> {
    let strikes = |action: &Action| matches!(action, Action::Phase(_) | Action::Impact { .. });
    let event = system.description().events.iter().find(|event| event.actions.iter().any(strikes))?;
    Some(Unsteppable::Strikes { event: event.name.to_string() })
}

/// The first number that changes with accelerations or multipliers, of a function of a state that writes so many.
fn depends(system: &dyn System, t: f64, y: &[f64], count: usize, of: &dyn Fn(At<'_>, &mut [f64])) -> Option<usize> {
    let (n, rows) = (system.len(), system.description().rows.len().max(1));
    let numbers = |from: f64, count: usize| (1..=count).map(|k| from * k as f64).collect::<Vec<f64>>();
    let [one, other] = [FIRST, -SECOND].map(|from| {
        let mut values = vec![0.0; count];
        let (a, lambda) = (numbers(from, n), numbers(from * from + 1.0, rows));
        of(At::packed(t, y, n).accelerated(&a).constrained(&lambda), &mut values);
        values
    });
    (0..count).find(|k| one[*k].to_bits() != other[*k].to_bits() && !(one[*k].is_nan() && other[*k].is_nan()))
}

fn event(system: &dyn System, (t, y): (f64, &[f64]), settings: &Settings) -> Option<Unsteppable> {
    let (events, own) = (&system.description().events, of_contacts(system));
    let sets = system.sampling().sets.iter().map(|targets| targets.len()).sum();
    if let Some(place) = depends(system, t, y, sets, &|at, values| system.assignments(at, values)) {
        let mut ends = 0;
        let set = system.sampling().sets.iter().position(|targets| {
            ends += targets.len();
            place < ends
        });
        let by = |event: &&crate::mechanism::Event| {
            event.actions.iter().any(|action| matches!(action, Action::Set(set_of) if Some(*set_of as usize) == set))
        };
        let event = events.iter().find(by).map_or_else(String::new, |event| event.name.to_string());
        return Some(Unsteppable::Event { event });
    }
    let others = (0..events.len()).filter(|k| !own.contains(k) && !settings.ignored_events.contains(k));
    for k in others {
        let pair = |at: At<'_>, values: &mut [f64]| {
            let mut all = vec![0.0; 2 * events.len()];
            system.events(at, &mut all);
            values.copy_from_slice(&all[2 * k..2 * k + 2]);
        };
        if depends(system, t, y, 2, &pair).is_some() {
            return Some(Unsteppable::Event { event: events[k].name.to_string() });
        }
    }
    None
}

/// A reaction of which a force is made that is no friction of `friction` or `contacts`.
fn reaction(system: &mut dyn System, t: f64, y: &[f64]) -> Option<Unsteppable> {
    let found = ASIDE.iter().find_map(|aside| {
        let beside: Vec<f64> =
            y.iter().enumerate().map(|(i, y)| y + aside * (FIRST * (i + 1) as f64).fract()).collect();
        made_of_reactions(system, t, &beside)
    })?;
    Some(Unsteppable::Reaction { constraint: system.description().rows[found].name.to_string() })
}

/// Refuses a start in which sides of contacts are in each other; one that goes on from another run, later than at t = 0 or beside it, may be so, as far
/// as steps let them.
pub(super) fn apart(system: &dyn System, settings: &Settings, y: &[f64]) -> Result<(), Box<Cause>> {
    if settings.from != 0.0 || settings.beside.is_some() {
        return Ok(());
    }
    let at = At::packed(settings.from, y, system.len());
    let (triples, within) = (constraint_triples(system, at), closed_within(system, at, &[]));
    for contact in system.contacts().all.iter() {
        if let Some(row) = contact.normal.map(|row| row as usize)
            && triples[row][0] < -within[row]
        {
            return Err(Cause::Penetrates { contact: contact.name.to_string(), gap: triples[row][0] }.into());
        }
    }
    Ok(())
}
