//! Which modes the contacts have from an instant on.
//!
//! A combination is the motion's if the accelerations and forces under it agree with it: N ≥ 0 where a contact is closed and g'' ≥ 0 where
//! it opens, |T| ≤ L₀ where it sticks, and s' in the direction in which it begins to slip.  The linear complementarity problem that this is
//! (Glocker, Set-Valued Force Laws, 2001, ch. 5–6) is solved by trying combinations, those first that change least.

use super::directions::{along, consistent, is_near};
use super::limits::{part_of_sticking, possible_limits_of};
use super::strike::Strike;
use super::{Kinematics, Moment, STILL, Situation, combinations, held_direction, hold_direction, words};
use crate::cause::Cause;
use crate::matrix::solve_least;
use crate::mechanism::dense::{constraint_matrix, mass_matrix};
use crate::mechanism::{At, ContactEvent, ContactMode, System, rows_in_force};

/// A force, or an acceleration, below this part of the largest under any combination is zero.
const NOTHING: f64 = 1e-10;
/// A force at its limit is so to the rounding of its instant; one that is further below it, as a part of it, is held by less.
const RELEASED: f64 = 1e-6;
/// Accelerations that differ by less than this part of the largest are the same motion.
const ALIKE: f64 = 1e-8;
/// What begins to slide has its direction until it is so many times faster than what it slides with at first, which is rounding.
const BELOW: f64 = 1e3;
/// The part of a step in which friction does what is lost in the rounding of a rate.
const GRAIN: f64 = 1e-10;
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
    fn jumped_from(self) -> Option<&'a [Kinematics]> {
        match self {
            Change::Jump(before) | Change::ByHand(before, _) => Some(before),
            _ => None,
        }
    }

    /// Where a motion begins, what puts its discontinuities on their sides.
    fn begins(self) -> Option<PutOnSides> {
        match self {
            Change::Start(put_on_sides) | Change::ByHand(_, put_on_sides) => Some(put_on_sides),
            _ => None,
        }
    }
}

/// What all combinations share.
#[derive(Clone, Copy)]
struct Shared<'a> {
    known: &'a [Known],
    /// J M⁻¹ Jᵀ of each row by itself.
    compliance: &'a [f64],
    /// Where a motion begins, what puts the discontinuities on their sides under a combination.
    begins: Option<PutOnSides>,
}

/// What is tried under one combination.
#[derive(Clone)]
struct Trial {
    modes: Vec<ContactMode>,
    /// Of each contact what must not be negative, with the size beside which it is judged.
    signs: Vec<Vec<Sign>>,
    accelerations: Vec<f64>,
    /// What is held, with the directions in which it slides in space.
    memory: Vec<f64>,
}

/// A number that is not negative where a combination is the motion's.
#[derive(Clone, Copy)]
struct Sign {
    kind: Kind,
    value: f64,
    /// The sum of the terms beside which it is rounding.
    terms: f64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// N J M⁻¹ Jᵀ, what the force does to g''; or g''.
    Pressed,
    Opens,
    /// (L₀² − T²)/(L₀² + T²).
    Holds,
    /// ±s'.
    Slides,
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
    let overlaps = |k: &usize| situation.kinematics[*k].gap < 0.0 && !situation.closed[*k];
    if (matches!(change, Change::Start(_)) || change.jumped_from().is_some())
        && let Some(k) = (0..situation.kinematics.len()).find(overlaps)
    {
        let contact = system.contacts().all[k].name.to_string();
        return Err(Cause::Penetrates { contact, gap: situation.kinematics[k].gap }.into());
    }
    let known: Vec<Known> =
        (0..situation.modes.len()).map(|k| known(system, &situation, (k, change), (t, y))).collect();
    let mut trials = Vec::new();
    let compliance = compliance(system, At::packed(t, y, system.len()));
    let known = with_grain(system, moment, &compliance, known);
    let shared = Shared { known: &known, compliance: &compliance, begins: change.begins() };
    let memory_before = system.memory().to_vec();
    aim(system, &situation, &known);
    let modes_before = system.modes().to_vec();
    let before_it = (!matches!(change, Change::Start(_))).then_some(situation.modes.as_slice());
    let stops = matches!(change, Change::Event { what: ContactEvent::Stops, .. });
    for modes in in_order(before_it, &known, stops) {
        trials.extend(tried(system, (t, y), shared, modes));
    }
    system.set_phase(before);
    system.set_memory(&memory_before);
    let forced = match change {
        Change::Event { contact, what: ContactEvent::Lifts } => Some((contact, Kind::Opens)),
        Change::Event { contact, what: ContactEvent::Slips } => Some((contact, Kind::Slides)),
        _ => None,
    };
    let agree: Vec<&Trial> = trials.iter().filter(|trial| agrees(trial, &trials, forced)).collect();
    let alike = alike(&trials);
    // What may stick does not begin to slide, though it might, being held by more than what slides is.
    let agree: Vec<&Trial> = agree
        .iter()
        .copied()
        .filter(|one| !agree.iter().any(|other| !alike(one, other) && one.slides_where_sticks(other, &known)))
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
    let (mut a, mut lambda) = (vec![0.0; system.len()], vec![0.0; system.description().rows.len()]);
    let solved = system.accelerations_and_multipliers(at, &mut a, &mut lambda).is_ok();
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
    let held = solved && contacts.iter().all(is_held);
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
    let known = with_grain(system, moment, &compliance, known);
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

/// Whether two of some trials make the same accelerations.
fn alike(trials: &[Trial]) -> impl Fn(&Trial, &Trial) -> bool {
    let scale = trials.iter().flat_map(|trial| &trial.accelerations).fold(0.0_f64, |most, a| most.max(a.abs()));
    move |one, other| one.accelerations.iter().zip(&other.accelerations).all(|(a, b)| (a - b).abs() <= ALIKE * scale)
}

impl Trial {
    /// Whether all that it does otherwise than another is to slide where the other one sticks.
    fn slides_where_sticks(&self, other: &Trial, known: &[Known]) -> bool {
        let instead = |((own, other), known): ((&ContactMode, &ContactMode), &Known)| {
            own == other || known.rolls && own.sliding() != 0.0 && *other == ContactMode::Sticks
        };
        self.modes.iter().zip(&other.modes).zip(known).all(instead)
    }
}

/// Of several combinations in which all moves alike the one that agrees with the forces a moment later, too: how contacts share what holds them
/// together is not determined, but some shares end at once.  Of several that do and then move otherwise one that sticks where others slide; the first
/// where no moment tells.
fn lasting<'a>(
    system: &mut dyn System,
    &Moment { t, y, step, .. }: &Moment<'_>,
    shared: Shared<'_>,
    alike: &[&'a Trial],
) -> &'a Trial {
    let n = system.len();
    if alike.len() == 1 || step == 0.0 {
        return alike[0];
    }
    for ahead in AHEAD.map(|part| part * step) {
        let a = &alike[0].accelerations;
        let place = |i: usize| y[i] + ahead * (y[n + i] + 0.5 * ahead * a[i]);
        let later: Vec<f64> = (0..n).map(place).chain((0..n).map(|i| y[n + i] + ahead * a[i])).collect();
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
        if let Some(first) = last.iter().position(|lasts| *lasts)
            && last.contains(&false)
        {
            return alike[first];
        }
        // From here on they are different motions.
        let same = self::alike(&all);
        let part = |one: &Trial| all.iter().any(|other| !same(one, other));
        if all.len() == alike.len() && all.iter().any(part) {
            let gives_way =
                |one: &Trial| all.iter().any(|other| !same(one, other) && one.slides_where_sticks(other, shared.known));
            return all.iter().position(|one| !gives_way(one)).map_or(alike[0], |first| alike[first]);
        }
    }
    alike[0]
}

/// What is known of a contact at an instant.
struct Known {
    /// What it may do from here on; what it does now first.
    options: Vec<ContactMode>,
    /// Whether its gap is closed and stays so unless it is pulled open.
    touches: bool,
    /// Whether its sides do not slide on each other now.
    rolls: bool,
    /// The rate below which it has no direction of sliding where it begins to.
    least: f64,
}

fn known(system: &mut dyn System, situation: &Situation, (k, change): (usize, Change<'_>), at: (f64, &[f64])) -> Known {
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
            _ => present.touches(),
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
fn with_grain(
    system: &dyn System,
    &Moment { t, y, step, .. }: &Moment<'_>,
    compliance: &[f64],
    mut known: Vec<Known>,
) -> Vec<Known> {
    let (contacts, n) = (&system.contacts().all, system.len());
    if step == 0.0 || !contacts.iter().any(|contact| contact.direction.is_some()) {
        return known;
    }
    let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; system.description().rows.len()]);
    let at = At::packed(t, y, n);
    if system.accelerations_and_multipliers(at, &mut a, &mut lambda).is_err() {
        return known;
    }
    let mut pairs = vec![0.0; 2 * system.description().events.len()];
    system.events(at.accelerated(&a).constrained(&lambda), &mut pairs);
    for (known, contact) in known.iter_mut().zip(contacts.iter()).filter(|(_, contact)| contact.direction.is_some()) {
        let Some(event) = contact.event(ContactEvent::Slips) else { continue };
        let held: f64 = contact.tangents().map(|row| lambda[row as usize].powi(2)).sum();
        let limit = (pairs[2 * event] + held).max(0.0).sqrt();
        let most = contact.tangents().map(|row| compliance[row as usize]).fold(0.0, f64::max);
        known.least = known.least.max(GRAIN * step * limit * most);
    }
    known
}

/// The direction in which a contact that sticks with all its force gives way: against the force.
fn direction_of_force(system: &mut dyn System, contact: usize, (t, y): (f64, &[f64])) -> ContactMode {
    let n = system.len();
    let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; system.description().rows.len()]);
    let row = system.contacts().all[contact].tangent.unwrap_or(0) as usize;
    let solved = system.accelerations_and_multipliers(At::packed(t, y, n), &mut a, &mut lambda);
    if solved.is_ok() && lambda[row] > 0.0 { ContactMode::SlipsBackwards } else { ContactMode::SlipsForwards }
}

fn opposite(mode: ContactMode) -> ContactMode {
    match mode {
        ContactMode::SlipsForwards => ContactMode::SlipsBackwards,
        _ => ContactMode::SlipsForwards,
    }
}

/// All combinations of what each may do, those first that differ from the present one in fewest contacts that touch.
///
/// Where something `stops` in space, sticking is no change of what slides there without a rate: it would be held by others only.
fn in_order(present: Option<&[ContactMode]>, known: &[Known], stops: bool) -> Vec<Vec<ContactMode>> {
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

/// Puts a combination in force, with the sides of discontinuities that it has where a motion begins.
fn enter(system: &mut dyn System, (t, y): (f64, &[f64]), shared: Shared<'_>, modes: &[ContactMode]) {
    let phase = system.contacts().phase(modes);
    system.set_phase(phase);
    if let Some(put_on_sides) = shared.begins {
        put_on_sides(system, t, y);
    }
}

/// Forces and accelerations under a combination, with all directions in which contacts of space may begin to slide; none where there are none.
fn tried(system: &mut dyn System, at: (f64, &[f64]), shared: Shared<'_>, modes: Vec<ContactMode>) -> Vec<Trial> {
    let begins = |k: &usize| modes[*k] == ContactMode::Slides && shared.known[*k].rolls;
    let beginning: Vec<usize> = (0..modes.len()).filter(begins).collect();
    let memory = system.memory().to_vec();
    let guesses = match beginning.as_slice() {
        [] => Vec::new(),
        _ => against_forces(system, at, &modes, &beginning),
    };
    enter(system, at, shared, &modes);
    let aimed = |system: &mut dyn System, directions: &[[f64; 2]]| {
        for (k, direction) in beginning.iter().zip(directions) {
            hold_direction(system, *k, *direction, shared.known[*k].least);
        }
    };
    let tangents: Vec<Option<usize>> =
        system.contacts().all.iter().map(|contact| contact.tangent.map(|row| row as usize)).collect();
    let found = consistent(&guesses, &mut |directions| {
        aimed(system, directions);
        let Motion { second, .. } = Motion::of(system, at)?;
        beginning.iter().map(|k| tangents[*k].map(|row| [second[row], second[row + 1]])).collect()
    });
    let mut trials = Vec::new();
    for directions in found {
        aimed(system, &directions);
        trials.extend(trial_of(system, at, shared, &modes));
    }
    system.set_memory(&memory);
    trials
}

/// The directions against the forces with which contacts would stick.
fn against_forces(
    system: &mut dyn System,
    (t, y): (f64, &[f64]),
    modes: &[ContactMode],
    contacts: &[usize],
) -> Vec<[f64; 2]> {
    let mut stuck = modes.to_vec();
    contacts.iter().for_each(|k| stuck[*k] = ContactMode::Sticks);
    let phase = system.contacts().phase(&stuck);
    system.set_phase(phase);
    let (mut a, mut lambda) = (vec![0.0; system.len()], vec![0.0; system.description().rows.len()]);
    let solved = system.accelerations_and_multipliers(At::packed(t, y, system.len()), &mut a, &mut lambda).is_ok();
    let all = &system.contacts().all;
    let against = |k: &usize| {
        let force = all[*k].tangent.map_or([0.0; 2], |row| [-lambda[row as usize], -lambda[row as usize + 1]]);
        if solved && force != [0.0; 2] { along(force) } else { [1.0, 0.0] }
    };
    contacts.iter().map(against).collect()
}

/// Accelerations, multipliers, and c'' of all rows with the sums of its absolute terms.
struct Motion {
    a: Vec<f64>,
    lambda: Vec<f64>,
    second: Vec<f64>,
    terms: Vec<f64>,
}

impl Motion {
    /// In the phase in force; `None` where there is none.
    fn of(system: &dyn System, (t, y): (f64, &[f64])) -> Option<Motion> {
        let (n, rows) = (system.len(), system.description().rows.len());
        let at = At::packed(t, y, n);
        let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; rows]);
        system.accelerations_and_multipliers(at, &mut a, &mut lambda).ok()?;
        let mut second = vec![0.0; rows];
        system.constraint_bias(at, &mut second);
        let mut values = vec![0.0; system.description().constraint_pattern.len()];
        system.constraint_matrix(at, &mut values);
        let mut terms: Vec<f64> = second.iter().map(|bias| bias.abs()).collect();
        for ((row, column), value) in system.description().constraint_pattern.iter().zip(values) {
            let term = value * a[*column as usize];
            second[*row as usize] += term;
            terms[*row as usize] += term.abs();
        }
        Some(Motion { a, lambda, second, terms })
    }
}

/// Forces and accelerations in the combination in force, with the directions that are held; `None` where there are none.
fn trial_of(
    system: &dyn System,
    (t, y): (f64, &[f64]),
    Shared { known, compliance, .. }: Shared<'_>,
    modes: &[ContactMode],
) -> Option<Trial> {
    let Motion { a, lambda, second, terms } = Motion::of(system, (t, y))?;
    let contacts = &system.contacts().all;
    let at = At::packed(t, y, system.len());
    let sign = |kind: Kind, row: usize, value: f64| Sign { kind, value, terms: terms[row] };
    let margins = margins(system, at.accelerated(&a).constrained(&lambda));
    let mut signs = Vec::new();
    for (k, (contact, mode)) in contacts.iter().zip(modes).enumerate() {
        let mut own = Vec::new();
        if let Some(row) = contact.normal {
            match mode {
                ContactMode::Open if known[k].touches => {
                    own.push(sign(Kind::Opens, row as usize, second[row as usize]));
                }
                ContactMode::Open => {}
                _ => own.push(sign(Kind::Pressed, row as usize, compliance[row as usize] * lambda[row as usize])),
            }
        }
        if let Some(row) = contact.tangent {
            match mode {
                ContactMode::Sticks => own.push(sign(Kind::Holds, row as usize, margins[k])),
                ContactMode::SlipsForwards | ContactMode::SlipsBackwards => {
                    if known[k].rolls {
                        own.push(sign(Kind::Slides, row as usize, mode.sliding() * second[row as usize]));
                    }
                }
                ContactMode::Slides if known[k].rolls => {
                    let (row, [d1, d2, _]) = (row as usize, held_direction(system, k));
                    let value = d1 * second[row] + d2 * second[row + 1];
                    own.push(Sign { kind: Kind::Slides, value, terms: terms[row].max(terms[row + 1]) });
                }
                ContactMode::Open | ContactMode::Closed | ContactMode::Slides => {}
            }
        }
        signs.push(own);
    }
    Some(Trial { modes: modes.to_vec(), signs, accelerations: a, memory: system.memory().to_vec() })
}

/// J M⁻¹ Jᵀ of each row by itself.
fn compliance(system: &dyn System, at: At<'_>) -> Vec<f64> {
    let rows: Vec<usize> = (0..system.description().rows.len()).collect();
    let matrix = constraint_matrix(system, at, &rows);
    let response = solve_least(&mass_matrix(system, at), &matrix.transpose());
    rows.iter()
        .map(|row| response.as_ref().map_or(1.0, |x| matrix.row(*row).dot(&x.column(*row).transpose())))
        .collect()
}

/// Of each contact that rubs (L₀² − T²)/(L₀² + T²): 1 with no force, 0 at the limit; 0 where both are 0.
fn margins(system: &dyn System, at: At<'_>) -> Vec<f64> {
    let mut pairs = vec![0.0; 2 * system.description().events.len()];
    system.events(at, &mut pairs);
    let contacts = system.contacts().all.iter();
    contacts
        .map(|contact| match contact.event(ContactEvent::Slips) {
            Some(event) => {
                let difference = pairs[2 * event];
                let squares = contact.tangents().map(|row| at.lambda[row as usize].powi(2));
                let sum = difference + 2.0 * squares.sum::<f64>();
                if sum > 0.0 { difference / sum } else { 0.0 }
            }
            None => 0.0,
        })
        .collect()
}

/// Whether forces and accelerations under a combination agree with it.  A contact that reached a limit leaves it, by however little.
fn agrees(trial: &Trial, all: &[Trial], forced: Option<(usize, Kind)>) -> bool {
    trial.signs.iter().enumerate().all(|(k, signs)| {
        signs.iter().all(|sign| {
            let of_kind = |other: &Trial| {
                let own = other.signs[k].iter().filter(|other| other.kind == sign.kind);
                own.fold(0.0_f64, |most, other| most.max(other.value.abs()).max(other.terms))
            };
            let scale = all.iter().map(of_kind).fold(0.0, f64::max);
            let rounding = NOTHING * scale;
            let leaves = forced == Some((k, sign.kind));
            match sign.kind {
                Kind::Holds => sign.value >= -NOTHING,
                // Its force falls through 0: it opens, by however little.
                Kind::Opens if leaves => true,
                // What begins to slide may be moved by nothing yet: at its limit, or where others hold it.
                Kind::Pressed | Kind::Opens | Kind::Slides => sign.value >= -rounding,
            }
        })
    })
}
