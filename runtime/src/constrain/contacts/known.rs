//! What is known of each contact where modes are chosen, and which combinations that leaves.

use super::modes::Change;
use super::share::with_shares;
use super::trials::compliance;
use super::{Kinematics, Moment, Situation, combinations};
use crate::mechanism::{At, Contact, ContactEvent, ContactMode, System};

/// What begins to slide has its direction until it is so many times faster than what it slides with at first, which is rounding.
const BELOW: f64 = 1e3;
/// The part of a step to which instants are known at which sliding begins or stops: located to some 1e-12 of one, with room for two digits.
const UNRESOLVED: f64 = 1e-10;

/// What is known of a contact at an instant.
pub(super) struct Known {
    /// What it may do from here on; what it does now first.
    pub options: Vec<ContactMode>,
    /// Whether its gap is closed and stays so unless it is pulled open.
    pub touches: bool,
    /// Whether its sides do not slide on each other now.
    pub rolls: bool,
    /// The rate below which it has no direction of sliding where it begins to.
    pub least: f64,
}

pub(super) fn known(
    system: &mut dyn System,
    situation: &Situation,
    (k, change): (usize, Change<'_>),
    at: (f64, &[f64]),
) -> Known {
    let contact = system.contacts().all[k].clone();
    let present = situation.modes[k];
    let happened = match change {
        Change::Event { contact, what } if contact == k => Some(what),
        _ => None,
    };
    let struck = match change {
        Change::Struck(strike) => strike.after(k),
        _ => None,
    };
    let Kinematics { gap, gap_rate, sliding } = situation.kinematics[k];
    let [gap_is_still, sliding_is_still] = situation.still[k];
    let jumped_from = change.jumped_from().map(|before| before[k]);
    // What approaches where it is closed lands by its event.
    let rests = situation.closed[k] && gap_is_still;
    let touches = contact.normal.is_none()
        || match (change, struck) {
            (_, Some(after)) => after.rests,
            (Change::Start(_), _) => present.touches() || rests,
            _ if jumped_from.is_some_and(|before| (before.gap, before.gap_rate) != (gap, gap_rate)) => rests,
            (Change::Struck(_), None) => present.touches() || rests,
            _ if happened == Some(ContactEvent::Lands) => situation.closed[k] && (gap_is_still || gap_rate < 0.0),
            _ => present.touches() || rests,
        };
    let rolls = match (happened, change, struck) {
        (Some(ContactEvent::Stops | ContactEvent::Slips), ..) => true,
        (.., Some(after)) => after.rolls,
        (_, Change::Struck(_), None) => sliding_is_still,
        _ if jumped_from.is_some_and(|before| before.sliding != sliding) => sliding_is_still,
        _ => situation.held[k] || sliding_is_still,
    };
    let mut options = Vec::new();
    if touches && happened != Some(ContactEvent::Lifts) {
        match happened {
            _ if contact.tangent.is_none() => options.push(ContactMode::Closed),
            Some(ContactEvent::Slips) if contact.direction.is_some() => options.push(ContactMode::Slides),
            Some(ContactEvent::Slips) => {
                let gives_way = direction_of_force(system, k, at);
                // The other direction only shows what the friction does to the sliding.
                options.extend([gives_way, opposite(gives_way)]);
            }
            _ if contact.direction.is_some() && rolls => options.extend([ContactMode::Sticks, ContactMode::Slides]),
            _ if contact.direction.is_some() => options.push(ContactMode::Slides),
            _ if rolls => {
                options.extend([ContactMode::Sticks, ContactMode::SlipsForwards, ContactMode::SlipsBackwards]);
            }
            _ if sliding[0] < 0.0 => options.push(ContactMode::SlipsBackwards),
            _ => options.push(ContactMode::SlipsForwards),
        }
    }
    if contact.normal.is_some() {
        options.push(ContactMode::Open);
    }
    // What it does now is tried first; what was open, or nothing is known of, is closed if it may be.
    let stops = matches!(change, Change::Event { what: ContactEvent::Stops, .. });
    let kept = |mode: &ContactMode| {
        let rests = stops && rolls && *mode == ContactMode::Slides;
        *mode == present && present.touches() && !matches!(change, Change::Start(_)) && !rests
    };
    if let Some(place) = options.iter().position(kept) {
        options[..=place].rotate_right(1);
    }
    let least = situation.least[k].max(BELOW * sliding[0].hypot(sliding[1]));
    Known { options, touches, rolls, least }
}

/// With what friction does to a sliding rate in the shortest part of a step, before which what begins to slide in space has the direction in which it
/// begins: at its limit it hardly moves at first, and turns as fast as it is slow.
pub(super) fn with_unresolved_rates(
    system: &dyn System,
    moment: &Moment<'_>,
    compliance: &[f64],
    mut known: Vec<Known>,
) -> Vec<Known> {
    let contacts = &system.contacts().all;
    if !contacts.iter().any(|contact| contact.direction.is_some()) {
        return known;
    }
    let rates = unresolved_of(system, moment, compliance);
    for (k, rate) in rates.into_iter().enumerate().filter(|(k, _)| contacts[*k].direction.is_some()) {
        known[k].least = known[k].least.max(rate);
    }
    known
}

/// What friction does to the sliding rate of each contact in the part of a step to which its instants are known: slower it has not begun to slide.
pub(crate) fn unresolved_rates<S: System + ?Sized>(system: &S, moment: &Moment<'_>) -> Vec<f64> {
    unresolved_of(system, moment, &compliance(system, At::packed(moment.t, moment.y, system.len())))
}

fn unresolved_of<S: System + ?Sized>(
    system: &S,
    &Moment { t, y, step, .. }: &Moment<'_>,
    compliance: &[f64],
) -> Vec<f64> {
    let (contacts, n) = (&system.contacts().all, system.len());
    let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; system.description().rows.len()]);
    let at = At::packed(t, y, n);
    if step == 0.0 || system.accelerations_and_multipliers(at, &mut a, &mut lambda).is_err() {
        return vec![0.0; contacts.len()];
    }
    let mut pairs = vec![0.0; 2 * system.description().events.len()];
    system.events(at.accelerated(&a).constrained(&lambda), &mut pairs);
    contacts.iter().map(|contact| UNRESOLVED * step * slowed(contact, (&pairs, &lambda), compliance)).collect()
}

/// By how much friction at its limit changes the sliding rate of a contact; `pairs` are of all events.
pub(super) fn slowed(contact: &Contact, (pairs, lambda): (&[f64], &[f64]), compliance: &[f64]) -> f64 {
    let Some(event) = contact.event(ContactEvent::Slips) else { return 0.0 };
    let held: f64 = contact.tangents().map(|row| lambda[row as usize].powi(2)).sum();
    let limit = (pairs[2 * event] + held).max(0.0).sqrt();
    limit * contact.tangents().map(|row| compliance[row as usize]).fold(0.0, f64::max)
}

/// The direction in which a contact that sticks with all its force gives way: against the force.
pub(super) fn direction_of_force(system: &mut dyn System, contact: usize, (t, y): (f64, &[f64])) -> ContactMode {
    let row = system.contacts().all[contact].tangent.unwrap_or(0) as usize;
    let solved = with_shares(system, At::packed(t, y, system.len()));
    let backwards = solved.is_ok_and(|(_, lambda)| lambda[row] > 0.0);
    if backwards { ContactMode::SlipsBackwards } else { ContactMode::SlipsForwards }
}

pub(super) fn opposite(mode: ContactMode) -> ContactMode {
    match mode {
        ContactMode::SlipsForwards => ContactMode::SlipsBackwards,
        _ => ContactMode::SlipsForwards,
    }
}

/// All combinations of what each may do, those first that differ from the present one in fewest contacts that touch.
///
/// Where something `stops` in space, sticking is no change of what slides there without a rate: it would be held by others only.
pub(super) fn in_order(present: Option<&[ContactMode]>, known: &[Known], stops: bool) -> Vec<Vec<ContactMode>> {
    let mut all = combinations(known.iter().map(|known| known.options.as_slice()));
    if let Some(present) = present {
        let rests = |mode: &ContactMode, before: &ContactMode| {
            stops && *before == ContactMode::Slides && *mode == ContactMode::Sticks
        };
        let changes =
            |(mode, before): &(&ContactMode, &ContactMode)| before.touches() && mode != before && !rests(mode, before);
        all.sort_by_key(|modes| modes.iter().zip(present).filter(changes).count());
    }
    all
}
