//! Which modes the contacts have from an instant on.
//!
//! A combination is the motion's if the accelerations and forces under it agree with it: N ≥ 0 where a contact is closed and g'' ≥ 0 where
//! it opens, |T| ≤ L₀ where it sticks, and s' in the direction in which it begins to slip.  The linear complementarity problem that this is
//! (Glocker, Set-Valued Force Laws, 2001, ch. 5–6) is solved by trying combinations, those first that change least.

use super::directions::{along, is_near};
use super::known::{Known, direction_of_force, in_order, known, with_unresolved_rates};
use super::limits::{part_of_sticking, possible_limits_of};
use super::share::with_shares;
use super::strike::Strike;
use super::trials::{
    Kind, RELEASED, Shared, Sign, Trial, agrees, alike, compliance, enter, margins, slides_where_sticks, trial_of,
    tried,
};
use super::{Kinematics, Moment, STILL, Situation, held_direction, hold_direction, words};
use crate::cause::Cause;
use crate::mechanism::{At, ContactEvent, ContactMode, System, rows_in_force};

/// What slides more slowly than this part of the terms of its rate, and could be held by this part of its friction of sliding, stops.
const SLOW: f64 = 1e-7;
const ENOUGH: f64 = 0.95;
/// So far ahead, in steps, combinations are told apart in which all moves alike: no further than shows a difference.
const AHEAD: [f64; 3] = [1e-4, 1e-2, 1.0];

/// Puts the discontinuities of the phase in force on the sides to which a motion that begins at a time and a state moves them.
pub(crate) type PutOnSides = fn(&mut dyn System, f64, &[f64]);

/// Why modes are chosen.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Change<'a> {
    /// A motion begins: nothing is known yet of the sides of its discontinuities, which each combination has for itself.
    Start(PutOnSides),
    /// An event of this contact happened.
    Event {
        /// The contact.
        contact: usize,
        /// What happened to it.
        what: ContactEvent,
    },
    /// Contacts struck, and this came of it.
    Struck(&'a Strike),
    /// Forces jumped, and maybe speeds and places, which were these.
    Jump(&'a [Kinematics]),
    /// The same by a change by hand, after which a motion begins.
    ByHand(&'a [Kinematics], PutOnSides),
}

impl<'a> Change<'a> {
    /// How the sides of contacts were placed and moved before a jump.
    pub(super) fn jumped_from(self) -> Option<&'a [Kinematics]> {
        match self {
            Change::Jump(before) | Change::ByHand(before, _) => Some(before),
            _ => None,
        }
    }

    /// What an event makes a contact do.
    fn forced(self) -> Option<(usize, Kind)> {
        match self {
            Change::Event { contact, what: ContactEvent::Lifts } => Some((contact, Kind::Opens)),
            Change::Event { contact, what: ContactEvent::Slips } => Some((contact, Kind::Slides)),
            _ => None,
        }
    }

    /// Whether an event happened that is not of this contact.
    fn is_event_of_another(self, k: usize) -> bool {
        matches!(self, Change::Event { contact, .. } if contact != k)
    }

    /// Where a motion begins, what puts its discontinuities on their sides.
    fn begins(self) -> Option<PutOnSides> {
        match self {
            Change::Start(put_on_sides) | Change::ByHand(_, put_on_sides) => Some(put_on_sides),
            _ => None,
        }
    }
}

/// The phase in which the contacts agree with the forces at a state; it is in force afterwards.
///
/// # Errors
/// No combination agrees, or several with different motions do, of which none is the present one; a gap that is negative where a motion begins or jumps;
/// what has no accelerations under any.
pub(crate) fn settle(system: &mut dyn System, moment: &Moment<'_>, change: Change<'_>) -> Result<usize, Box<Cause>> {
    let before = system.phase();
    let situation = Situation::new(system, moment);
    let (t, y) = (moment.t, moment.y);
    if matches!(change, Change::Start(_)) || change.jumped_from().is_some() {
        none_overlaps(system, &situation)?;
    }
    let known: Vec<Known> =
        (0..situation.modes.len()).map(|k| known(system, &situation, (k, change), (t, y))).collect();
    let compliance = compliance(system, At::packed(t, y, system.len()));
    let known = with_unresolved_rates(system, moment, &compliance, known);
    let shared = Shared { known: &known, compliance: &compliance, begins: change.begins() };
    let memory_before = system.memory().to_vec();
    aim(system, &situation, &known);
    let modes_before = system.modes().to_vec();
    let forced = change.forced();
    // What presses one contact from here on has just let go of another, as in a guide without clearance: which way it goes is rounding now.
    let meets = |k: usize| change.is_event_of_another(k) && known[k].touches && !situation.modes[k].touches();
    let moved = if (0..known.len()).any(meets) { a_moment_later(system, moment) } else { None };
    let at = moved.as_ref().map_or((t, y), |(t, y)| (*t, y.as_slice()));
    let trials = all_tried(system, at, shared, (&situation.modes, change));
    system.set_phase(before);
    system.set_memory(&memory_before);
    let agree: Vec<&Trial> = trials.iter().filter(|trial| agrees(trial, &trials, forced)).collect();
    let alike = alike(&trials);
    // What may stick does not begin to slide, though it might, being held by more than what slides is.
    let agree: Vec<&Trial> = agree
        .iter()
        .copied()
        .filter(|one| {
            !agree.iter().any(|other| !alike(one, other) && slides_where_sticks(&one.modes, &other.modes, &known))
        })
        .collect();
    let chosen = match agree.as_slice() {
        [] => None,
        [first, rest @ ..] => {
            let present = first.modes == situation.modes && forced.is_none();
            let one_motion = present || rest.iter().all(|other| alike(first, other));
            let mut same = vec![*first];
            same.extend(rest.iter().copied().filter(|other| alike(first, other)));
            one_motion.then(|| lasting(system, moment, shared, &same))
        }
    };
    if change.begins().is_some() {
        system.set_modes(&modes_before);
    }
    let Some(chosen) = chosen else {
        let touches: Vec<bool> = known.iter().map(|known| known.touches).collect();
        possible_limits_of(system, (t, y), &touches)?;
        if trials.is_empty() {
            // What keeps every combination from having accelerations is no matter of contacts.
            let computed = system.accelerations(At::packed(t, y, system.len()), &mut vec![0.0; system.len()]);
            computed.map_err(|fault| fault.cause(system.description()))?;
        }
        let found = agree.iter().map(|trial| words(system, &trial.modes)).collect();
        return Err(Cause::UndecidedContacts { found }.into());
    };
    let phase = system.contacts().phase(&chosen.modes);
    system.set_phase(phase);
    system.set_memory(&chosen.memory);
    Ok(phase)
}

/// A time and a state so far ahead that forces which have just vanished have their signs, by the motion that is in force.
fn a_moment_later(system: &dyn System, &Moment { t, y, step, .. }: &Moment<'_>) -> Option<(f64, Vec<f64>)> {
    let (a, _) = with_shares(system, At::packed(t, y, system.len())).ok()?;
    let ahead = AHEAD[0] * step;
    Some((t + ahead, moved(y, &a, ahead)))
}

/// A state some seconds later, by constant accelerations.
fn moved(y: &[f64], a: &[f64], ahead: f64) -> Vec<f64> {
    let (q, v) = y.split_at(a.len());
    let places = q.iter().zip(v).zip(a).map(|((q, v), a)| q + ahead * (v + 0.5 * ahead * a));
    places.chain(v.iter().zip(a).map(|(v, a)| v + ahead * a)).collect()
}

/// Refuses a gap that is negative.
fn none_overlaps(system: &dyn System, situation: &Situation) -> Result<(), Box<Cause>> {
    let overlaps = |k: &usize| situation.kinematics[*k].gap < 0.0 && !situation.closed[*k];
    let Some(k) = (0..situation.kinematics.len()).find(overlaps) else { return Ok(()) };
    let contact = system.contacts().all[k].name.to_string();
    Err(Cause::Penetrates { contact, gap: situation.kinematics[k].gap }.into())
}

/// All combinations tried, but for those in which something slides that sticks with something left over in one that agrees.
fn all_tried(
    system: &mut dyn System,
    at: (f64, &[f64]),
    shared: Shared<'_>,
    (present, change): (&[ContactMode], Change<'_>),
) -> Vec<Trial> {
    let before = (!matches!(change, Change::Start(_))).then_some(present);
    let stops = matches!(change, Change::Event { what: ContactEvent::Stops, .. });
    let (mut trials, mut held): (Vec<Trial>, Vec<Trial>) = Default::default();
    for modes in in_order(before, shared.known, stops) {
        if held.iter().any(|trial| slides_where_sticks(&modes, &trial.modes, shared.known)) {
            continue;
        }
        let first = trials.len();
        trials.extend(tried(system, at, shared, modes));
        let holds = |trial: &&Trial| trial.holds() && agrees(trial, &trials, change.forced());
        held.extend(trials[first..].iter().filter(holds).cloned());
    }
    trials
}

/// What a contact in space does whose sliding rate along the direction that is held is zero.
pub(crate) enum Turned {
    /// It slides on, in the direction that is held now.
    On,
    /// It stops: all of its sliding rate is rounding.
    Stops,
    /// It slides so slowly that friction takes the rest at once, which leaves these rows at zero.
    Dies(Vec<usize>),
}

/// Whether a contact in space stops that has turned through a right angle, or nearly stops, with all others that do, and could be held by the friction of
/// sliding: that takes what little is left away, in whatever direction it is.
pub(crate) fn turned(system: &mut dyn System, moment: &Moment<'_>, contact: usize) -> Turned {
    let situation = Situation::new(system, moment);
    let speed = |k: usize| situation.kinematics[k].sliding[0].hypot(situation.kinematics[k].sliding[1]);
    let is_slow =
        |k: &usize| situation.modes[*k] == ContactMode::Slides && speed(*k) <= SLOW / STILL * situation.least[*k];
    let slow: Vec<usize> = (0..situation.modes.len()).filter(is_slow).collect();
    let alone = [contact];
    for stopping in [slow.as_slice(), &alone].into_iter().filter(|stopping| stopping.contains(&contact)) {
        if stopping.iter().all(is_slow)
            && let Some(rows) = are_held_by_sliding(system, moment, &situation.modes, stopping)
        {
            return Turned::Dies(rows);
        }
    }
    if situation.still[contact][1] {
        return Turned::Stops;
    }
    hold_direction(system, contact, along(situation.kinematics[contact].sliding), situation.least[contact]);
    Turned::On
}

/// The rows in force where these contacts stick instead, if the friction of sliding is enough, and more, for that.
fn are_held_by_sliding(
    system: &mut dyn System,
    &Moment { t, y, .. }: &Moment<'_>,
    modes: &[ContactMode],
    contacts: &[usize],
) -> Option<Vec<usize>> {
    let phase = system.phase();
    let mut stuck = modes.to_vec();
    contacts.iter().for_each(|k| stuck[*k] = ContactMode::Sticks);
    let held = system.contacts().phase(&stuck);
    system.set_phase(held);
    let at = At::packed(t, y, system.len());
    let solved = with_shares(system, at);
    system.set_phase(phase);
    let (a, lambda) = solved.ok()?;
    system.set_phase(held);
    let rows = rows_in_force(system).collect();
    let margins = margins(system, at.accelerated(&a).constrained(&lambda));
    let touches: Vec<bool> = modes.iter().map(|mode| mode.touches()).collect();
    let all = system.contacts().all.clone();
    let is_held = |k: &usize| {
        let pressed = all[*k].normal.is_none_or(|row| lambda[row as usize] > 0.0);
        // T/L₀ of (L₀² − T²)/(L₀² + T²).
        let used = ((1.0 - margins[*k]) / (1.0 + margins[*k])).sqrt();
        let part = part_of_sticking(system, (t, y), &touches, *k);
        pressed && part.is_some_and(|part| used <= ENOUGH * part)
    };
    let held = contacts.iter().all(is_held);
    system.set_phase(phase);
    held.then_some(rows)
}

/// Holds the directions of what slides in space and is not at rest there, where it is not near the one that is held.
fn aim(system: &mut dyn System, situation: &Situation, known: &[Known]) {
    for (k, known) in known.iter().enumerate() {
        let (s, [d1, d2, least]) = (situation.kinematics[k].sliding, held_direction(system, k));
        let slides = known.options.contains(&ContactMode::Slides) && !known.rolls;
        if slides && !(least > 0.0 && is_near(s, [d1, d2])) {
            hold_direction(system, k, along(s), situation.least[k]);
        }
    }
}

/// Whether a contact that reached its limit is held by less since others, which reached theirs at the same instant, began to slide.
///
/// # Errors
/// [`Cause::UndecidedContacts`] where it might as well be this one that slides, and the others that stick.
pub(crate) fn is_released(system: &mut dyn System, moment: &Moment<'_>, contact: usize) -> Result<bool, Box<Cause>> {
    let (phase, situation) = (system.phase(), Situation::new(system, moment));
    let begins = |k: &usize| situation.modes[*k].sliding() != 0.0 && situation.still[*k][1];
    let begin: Vec<usize> = (0..situation.modes.len()).filter(begins).collect();
    if begin.is_empty() {
        return Ok(false);
    }
    let at = (moment.t, moment.y);
    let change = Change::Event { contact, what: ContactEvent::Slips };
    let known: Vec<Known> = (0..situation.modes.len()).map(|k| known(system, &situation, (k, change), at)).collect();
    let compliance = compliance(system, At::packed(moment.t, moment.y, system.len()));
    let known = with_unresolved_rates(system, moment, &compliance, known);
    let shared = Shared { known: &known, compliance: &compliance, begins: None };
    let mut instead = situation.modes.clone();
    begin.into_iter().for_each(|k| instead[k] = ContactMode::Sticks);
    let all_stick = system.contacts().phase(&instead);
    system.set_phase(all_stick);
    instead[contact] = match known[contact].options.contains(&ContactMode::Slides) {
        true => ContactMode::Slides,
        false => direction_of_force(system, contact, at),
    };
    let memory = system.memory().to_vec();
    let [present, other] = [situation.modes, instead].map(|modes| {
        let trials = tried(system, at, shared, modes);
        system.set_memory(&memory);
        trials
    });
    system.set_phase(phase);
    let Some(present) = present.into_iter().next() else { return Ok(false) };
    let is_held = |sign: &Sign| sign.kind == Kind::Holds && sign.value > RELEASED;
    if !present.signs[contact].iter().any(is_held) {
        return Ok(false);
    }
    let both: Vec<Trial> = std::iter::once(present).chain(other).collect();
    if let [present, others @ ..] = both.as_slice()
        && others.iter().any(|other| agrees(other, &both, None) && !alike(&both)(present, other))
    {
        let found = both.iter().map(|trial| words(system, &trial.modes)).collect();
        return Err(Cause::UndecidedContacts { found }.into());
    }
    Ok(true)
}

/// Of several combinations in which all moves alike the one that agrees with the forces a moment later, too: how contacts share what holds them
/// together is not determined, but some shares end at once.  Of several that last one that sticks where others slide.
fn lasting<'a>(
    system: &mut dyn System,
    &Moment { t, y, step, .. }: &Moment<'_>,
    shared: Shared<'_>,
    alike: &[&'a Trial],
) -> &'a Trial {
    if alike.len() == 1 || step == 0.0 {
        return sticking_most(alike, shared.known);
    }
    for ahead in AHEAD.map(|part| part * step) {
        let later = moved(y, &alike[0].accelerations, ahead);
        let memory = system.memory().to_vec();
        let again = |trial: &&Trial| {
            system.set_memory(&trial.memory);
            enter(system, (t + ahead, &later), shared, &trial.modes);
            let found = trial_of(system, (t + ahead, &later), shared, &trial.modes);
            system.set_memory(&memory);
            found
        };
        let trials: Vec<Option<Trial>> = alike.iter().map(again).collect();
        let all: Vec<Trial> = trials.iter().flatten().cloned().collect();
        let lasts = |trial: &Option<Trial>| trial.as_ref().is_some_and(|trial| agrees(trial, &all, None));
        let last: Vec<bool> = trials.iter().map(lasts).collect();
        if last.contains(&true) && last.contains(&false) {
            let lasting = alike.iter().zip(&last).filter(|(_, lasts)| **lasts);
            return sticking_most(&lasting.map(|(trial, _)| *trial).collect::<Vec<_>>(), shared.known);
        }
        // From here on they are different motions.
        let same = self::alike(&all);
        let part = |one: &Trial| all.iter().any(|other| !same(one, other));
        if all.len() == alike.len() && all.iter().any(part) {
            let gives_way = |one: &Trial| {
                all.iter().any(|other| !same(one, other) && slides_where_sticks(&one.modes, &other.modes, shared.known))
            };
            return all.iter().position(|one| !gives_way(one)).map_or(alike[0], |first| alike[first]);
        }
    }
    sticking_most(alike, shared.known)
}

/// The first of some trials that slides nowhere where another one sticks.
fn sticking_most<'a>(trials: &[&'a Trial], known: &[Known]) -> &'a Trial {
    let gives_way = |one: &Trial| {
        trials.iter().any(|other| other.modes != one.modes && slides_where_sticks(&one.modes, &other.modes, known))
    };
    trials.iter().copied().find(|one| !gives_way(one)).unwrap_or(trials[0])
}
