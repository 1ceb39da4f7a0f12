//! Choosing the modes of the switches.

use super::combinations::{
    Combination, Looks, ModesBefore, against, agreed, all_directions, combinations, scale, undecided,
};
use super::sample::Sampler;
use crate::cause::Cause;
use crate::integrate::Segment;
use crate::mechanism::sliding::{SLIDES, comes_to_rest, fractions, return_to_surfaces};
use crate::mechanism::{At, SwitchKind, System};

/// A step that is taken only to see where it leads, under the modes in force.
pub(crate) type Trial<'a, S> = &'a mut dyn FnMut(&S) -> Option<OwnedSegment>;

/// Dense output of a trial step.
pub(crate) struct OwnedSegment {
    pub t: f64,
    pub h: f64,
    pub width: usize,
    pub pieces: Vec<f64>,
}

impl OwnedSegment {
    /// As those of steps that were taken.
    pub fn segment(&self) -> Segment<'_> {
        Segment { t: self.t, h: self.h, width: self.width, pieces: &self.pieces }
    }
}

/// What is known of the switches where modes are chosen.
pub(crate) struct Known<'a> {
    /// Which are on their surface, because their zero was located here.
    pub surface: &'a [bool],
    /// On which side some are from here on, whose argument jumps over zero, or is one of time alone.
    pub beyond: &'a [Option<f64>],
    /// One that is known to leave its surface, and to which side.
    pub leaves: Option<(usize, f64)>,
    /// Which the constraints in force keep at their surface: these rest there, and none is looked for.
    pub held: &'a [bool],
    /// The length of the last step, s: what happens in a billionth of it happens now.
    pub step: f64,
    /// Until when no argument of time alone changes its sign, s.
    pub next_stop: f64,
}

/// What was chosen.
pub(crate) struct Chosen {
    /// Which switches are on their surface.
    pub on: Vec<bool>,
    /// One of them that may as well leave it to the other side.
    pub undecided: Option<usize>,
}

/// A rate that is this part of the largest is zero to rounding.
pub(super) const STANDS: f64 = 1e-12;
/// Accelerations that differ by up to so many times what the rounding of the state makes of them are the same.
const EXPLAINED: f64 = 8.0;
/// How often each switch may change between its surface and its sides until all agree.
const TURNS: usize = 4;
/// So much later, in steps, what slides is seen to go on or to leave.
const MOMENT: f64 = 1e-4;
/// Chooses the modes at a state.
///
/// In order, since an argument contains modes of earlier switches only: off its surface (argument = 0) a switch's mode
/// is the sign of the argument under the modes already chosen.  On it both sides are tried, in all combinations, the
/// present one first; a combination is the motion's if it moves every argument that is on its surface to the side that
/// the combination says.  Where rates vanish, or no combination agrees with them, one trial step tells where the arguments go.
///
/// Where no combination leads away, what is pushed back from both sides slides in its surface ([`System::sliding`]), as few as possible at
/// once.  Of a system that cannot, one `sign` that rested, as at the start, stays 0 if nothing moves with it.
///
/// Returns which switches are on their surface, and one of them that several combinations move away, to both sides.
///
/// # Errors
/// [`Cause::Chattering`] names a switch to which both sides push back, and which does not slide: its sides do not change its rate.
/// [`Cause::NonFinite`] names one whose argument is no number under the modes that were chosen.
pub(crate) fn choose<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    at: (f64, &[f64]),
    known: &Known<'_>,
    trial: Trial<'_, S>,
) -> Result<Chosen, Box<Cause>> {
    let chosen = combination(system, sampler, at, known, trial)?;
    sampler.at_state(system, at.0, at.1);
    let undefined = |k: &usize| !known.held[*k] && sampler.value(sampler.function_of(*k)).is_nan();
    match (0..chosen.on.len()).find(undefined) {
        Some(switch) => Err(no_number(system, switch, at.0).into()),
        None => Ok(chosen),
    }
}

/// A switch whose argument is no number has neither side.
pub(crate) fn no_number<S: System + ?Sized>(system: &S, switch: usize, t: f64) -> Cause {
    Cause::NonFinite {
        what: format!("`{}` at t = {t} s, the sign of which the equations ask for,", text(system, switch)),
    }
}

fn combination<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    known: &Known<'_>,
    trial: Trial<'_, S>,
) -> Result<Chosen, Box<Cause>> {
    let (slid, leaving) = (system.sliding().to_vec(), leaving(system, (t, y), known));
    let mut before = system.modes().to_vec();
    slid.iter().for_each(|switch| before[*switch] = at_rest(system, *switch));
    system.set_modes(&before);
    let rested: Vec<bool> = (0..before.len()).map(|switch| side(system, switch) == 0.0).collect();
    let combinations =
        combinations(system, sampler, (t, y), known, &ModesBefore { modes: &before, slid: &slid, leaving: &leaving })?;
    let by_rates = all_directions(system, sampler, (t, y), (&combinations, Looks::WhereRatesVanish), trial);
    let mut undecided = undecided(system, &combinations, &by_rates);
    let mut found = agreed(system, &combinations, &by_rates);
    // The combination in which fewest arguments are moved against their sides; those are pushed back to their surface.
    let list = combinations.iter().zip(&by_rates);
    let opposed: Vec<Vec<usize>> = list.map(|(one, to)| against(system, one, to, &by_rates)).collect();
    let (best, pushed) = opposed.into_iter().enumerate().min_by_key(|(_, list)| list.len()).unwrap_or_default();
    let rates = Rates { of: &by_rates, leaving: &leaving };
    if found.is_none() {
        // Rates that are next to nothing beside what a step does, as those of a drag that hardly moves, do not count.
        let by_trial = all_directions(system, sampler, (t, y), (&combinations, Looks::Always), trial);
        found = agreed(system, &combinations, &by_trial);
        undecided = self::undecided(system, &combinations, &by_trial);
    }
    if let Some((one, to)) = found {
        if goes_on_holding(system, sampler, (t, y), (&one, &to), &rates, known.step) {
            return Ok(Chosen { on: one.on, undecided: None });
        }
        take_sides(system, &one, &to, &leaving);
        return Ok(Chosen { on: one.on, undecided });
    }
    let best = &combinations[best];
    if let Some(from) = slide_from(system, sampler, (t, y), &combinations, (best, &pushed), &rates) {
        return Ok(Chosen { on: from.on.clone(), undecided: None });
    }
    let may_rest = pushed.iter().all(|k| rested[*k] && is_sign(system, *k));
    if may_rest && rest(system, sampler, (t, y), (best, &pushed), &rates) {
        return Ok(Chosen { on: best.on.clone(), undecided: None });
    }
    system.set_modes(&before);
    let switch = pushed.first().copied().unwrap_or(0);
    Err(chattering(system, (t, y), switch).into())
}

/// Whether switches whose rates vanish under a combination that agrees go on sliding where others leave: what another one has held so far is
/// held by those that are left as long as they can.
fn goes_on_holding<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    (one, to): (&Combination, &[f64]),
    rates: &Rates<'_>,
    step: f64,
) -> bool {
    let stands = |k: usize| one.on[k] && to[k].abs() <= STANDS * scale(rates.of, k);
    let held: Vec<usize> = (0..one.on.len()).filter(|k| stands(*k) && !rates.leaves(*k)).collect();
    !rates.leaving.is_empty()
        && !held.is_empty()
        && slide(system, sampler, (t, y), (one, &held), rates)
        && goes_on(system, (t, y), step)
}

/// Sets the modes of a combination that agrees; what it does not move away leaves to the side that is known, or rests.
fn take_sides<S: System + ?Sized>(system: &mut S, one: &Combination, to: &[f64], leaving: &[(usize, f64)]) {
    let mut modes = one.modes.clone();
    for switch in (0..modes.len()).filter(|k| one.on[*k] && to[*k] == 0.0) {
        modes[switch] = match leaving.iter().find(|(other, _)| *other == switch) {
            Some((_, to)) => mode(system, switch, *to),
            None => at_rest(system, switch),
        };
    }
    system.set_modes(&modes);
}

/// Lets switches slide that no combination leads away; the combination from which they do.
///
/// Signs of one rate cannot all slide: one of them holds it. That is seen where they begin to slide one after another.  Where these lead round
/// and round, all slide.
fn slide_from<'a, S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    combinations: &'a [Combination],
    (best, pushed): (&'a Combination, &[usize]),
    rates: &Rates<'_>,
) -> Option<&'a Combination> {
    let widest = combinations.iter().max_by_key(|one| one.on.iter().filter(|on| **on).count()).unwrap_or(best);
    let all: Vec<usize> = (0..widest.on.len()).filter(|k| widest.on[*k]).collect();
    let mut starts = [(best, pushed), (best, &[]), (widest, &all)].into_iter();
    starts.find(|(from, sliding)| slide(system, sampler, (t, y), (from, sliding), rates)).map(|(from, _)| from)
}

/// Lets signs that are pushed back from both sides rest at zero; false where anything moves with them.
fn rest<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    (best, pushed): (&Combination, &[usize]),
    rates: &Rates<'_>,
) -> bool {
    let mut modes = best.modes.clone();
    pushed.iter().for_each(|switch| modes[*switch] = 0.0);
    system.set_modes(&modes);
    sampler.at_state(system, t, y);
    pushed.iter().all(|k| sampler.rate(*k).abs() <= STANDS * scale(rates.of, *k))
}

/// What is said of a switch to which both sides push back: friction may hold a rate, a constraint a place, and neither states of first order.
pub(crate) fn chattering<S: System + ?Sized>(system: &S, (t, y): (f64, &[f64]), switch: usize) -> Cause {
    let (n, coordinates) = (system.len(), &system.description().coordinates);
    let still = vec![0.0; n];
    let value = |y: &[f64]| {
        let mut pairs = vec![0.0; 2 * system.description().switches.len()];
        system.switches(At::packed(t, y, n).accelerated(&still), &mut pairs);
        pairs[2 * switch]
    };
    let (here, mut moved) = (value(y), y.to_vec());
    let mut is_of = |range: std::ops::Range<usize>| {
        let mut others = range.filter(|i| coordinates[i % n].state().is_none());
        others.any(|i| {
            moved[i] += 1.0;
            let there = value(&moved);
            moved[i] = y[i];
            there.to_bits() != here.to_bits()
        })
    };
    let (is_place, is_rate) = (is_of(0..n), is_of(n..2 * n));
    let switch = text(system, switch);
    if is_place || is_rate { Cause::Chattering { switch, is_rate } } else { Cause::ChatteringStates { switch } }
}

/// The switches that leave their surface, as was found out, or since they have slid to the end of what their sides can do, and to which side.
fn leaving<S: System + ?Sized>(system: &S, (t, y): (f64, &[f64]), known: &Known<'_>) -> Vec<(usize, f64)> {
    let mut leaving: Vec<(usize, f64)> = known.leaves.into_iter().collect();
    if let Some(w) = (!system.sliding().is_empty()).then(|| fractions(system, t, y)).flatten() {
        let ends = system.sliding().iter().zip(w).filter(|(switch, _)| known.surface[**switch]);
        leaving.extend(ends.map(|(switch, w)| (*switch, if w > 0.5 { 1.0 } else { -1.0 })));
    }
    leaving
}

/// Lets switches slide in their surfaces, between their sides, while all others on their surfaces are moved to theirs; false where none does.
///
/// From a combination in which some slide: the one that would have to be furthest beyond its sides leaves to one of them,
/// and the one that is moved most against its side slides, in turn (principal pivoting; Cottle, Pang and Stone, The Linear
/// Complementarity Problem, 1992, §4.2).
fn slide<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    (from, sliding): (&Combination, &[usize]),
    rates: &Rates<'_>,
) -> bool {
    if !system.can_slide() {
        return false;
    }
    let places: Vec<usize> = (0..from.on.len()).filter(|k| from.on[*k]).collect();
    let mut modes = from.modes.clone();
    sliding.iter().for_each(|switch| modes[*switch] = SLIDES);
    rates.leaving.iter().for_each(|(switch, side)| modes[*switch] = mode(system, *switch, *side));
    for _ in 0..TURNS * places.len() {
        system.set_modes(&modes);
        let Some(w) = fractions(system, t, y) else { return false };
        let beyond =
            system.sliding().iter().copied().zip(w).map(|(switch, w)| (switch, (w - 0.5).abs() - 0.5, w > 0.5));
        if let Some((switch, _, above)) = beyond.filter(|(_, by, _)| *by > STANDS).max_by(|a, b| a.1.total_cmp(&b.1)) {
            modes[switch] = mode(system, switch, if above { 1.0 } else { -1.0 });
            continue;
        }
        sampler.at_state(system, t, y);
        let back = |k: usize| -side_of(system, k, modes[k]) * sampler.rate(k) / scale(rates.of, k);
        let against = places.iter().filter(|k| !modes[**k].is_nan()).map(|k| (*k, back(*k)));
        match against.filter(|(_, back)| *back > STANDS).max_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((switch, _)) => modes[switch] = SLIDES,
            None => return !system.sliding().is_empty(),
        }
    }
    false
}

/// Lets what is `on` its surface slide there, between its sides, if it can and comes to rest on it within so many `seconds`.
pub(crate) fn stay_where_on<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    (on, seconds): (&[bool], f64),
) {
    let before = system.modes().to_vec();
    sampler.at_state(system, t, y);
    let here: Vec<f64> = (0..on.len()).map(|switch| sampler.rate(switch)).collect();
    let from = Combination { modes: before.clone(), on: on.to_vec() };
    let all: Vec<usize> = (0..on.len()).filter(|switch| on[*switch]).collect();
    let rates = Rates { of: &[here], leaving: &[] };
    // Of arguments whose rates are alike one holds all, and the others rest.
    let alone = |switch: usize| {
        let mut one = from.clone();
        all.iter().filter(|other| **other != switch).for_each(|other| one.modes[*other] = at_rest(system, *other));
        (one, vec![switch])
    };
    let starts: Vec<(Combination, Vec<usize>)> =
        std::iter::once((from.clone(), all.clone())).chain(all.iter().map(|switch| alone(*switch))).collect();
    let slides = starts.iter().any(|(from, sliding)| {
        slide(system, sampler, (t, y), (from, sliding), &rates)
            && comes_to_rest(system, t, y, seconds)
            && holds_all(system, sampler, (t, y), (&all, &rates))
    });
    if !slides {
        system.set_modes(&before);
    }
}

/// Whether nothing that is on its surface moves once what slides is back on its own.
fn holds_all<S: System + ?Sized>(
    system: &S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    (on, before): (&[usize], &Rates<'_>),
) -> bool {
    let mut back = y.to_vec();
    return_to_surfaces(system, t, &mut back);
    sampler.at_state(system, t, &back);
    let slides = |switch: usize| system.modes()[switch].is_nan();
    on.iter().all(|k| slides(*k) || sampler.rate(*k).abs() <= STANDS * scale(before.of, *k))
}

/// Whether what slides still slides between its sides a moment later.
fn goes_on<S: System + ?Sized>(system: &S, (t, y): (f64, &[f64]), step: f64) -> bool {
    let (n, moment) = (system.len(), MOMENT * step);
    let mut rates = [&y[n..], &vec![0.0; n]].concat();
    if system.accelerations(At::packed(t, y, n), &mut rates[n..]).is_err() {
        return false;
    }
    let later: Vec<f64> = y.iter().zip(&rates).map(|(y, rate)| y + moment * rate).collect();
    fractions(system, t + moment, &later).is_some_and(|w| w.iter().all(|w| (-STANDS..=1.0 + STANDS).contains(w)))
}

/// Where switches on their surface go.
struct Rates<'a> {
    /// By combination and switch.
    of: &'a [Vec<f64>],
    /// Those that leave, and to which side.
    leaving: &'a [(usize, f64)],
}

impl Rates<'_> {
    fn leaves(&self, switch: usize) -> bool {
        self.leaving.iter().any(|(leaving, _)| *leaving == switch)
    }
}

fn is_sign<S: System + ?Sized>(system: &S, switch: usize) -> bool {
    system.description().switches[switch].kind == SwitchKind::Sign
}

/// A switch's mode on the side of this sign.
pub(crate) fn mode<S: System + ?Sized>(system: &S, switch: usize, side: f64) -> f64 {
    match system.description().switches[switch].kind {
        SwitchKind::Sign if side == 0.0 => 0.0,
        SwitchKind::Sign => side.signum(),
        SwitchKind::Step => f64::from(side >= 0.0),
    }
}

/// The side on which a mode puts the argument: −1, 0 or 1.
pub(crate) fn side<S: System + ?Sized>(system: &S, switch: usize) -> f64 {
    side_of(system, switch, system.modes()[switch])
}

pub(crate) fn side_of<S: System + ?Sized>(system: &S, switch: usize, mode: f64) -> f64 {
    match system.description().switches[switch].kind {
        SwitchKind::Sign => mode,
        SwitchKind::Step => 2.0 * mode - 1.0,
    }
}

/// A switch's argument as the model file has it.
pub(crate) fn text<S: System + ?Sized>(system: &S, switch: usize) -> String {
    system.description().switches.get(switch).map_or_else(String::new, |switch| switch.text.to_string())
}

/// Lets a switch on its surface rest where its two sides differ by no more than rounding, as those of a drag v |v| do where
/// nothing moves: what crosses there again and again is rounding too.
pub(crate) fn rest_if_sides_agree<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    switch: usize,
) {
    let sides = [mode(system, switch, 1.0), mode(system, switch, -1.0)];
    if agree(system, sampler, (t, y), switch, sides) {
        let mut modes = system.modes().to_vec();
        modes[switch] = at_rest(system, switch);
        system.set_modes(&modes);
    }
}

/// Whether a switch that rests may go on resting on this side of its surface: its mode there makes no difference but rounding.
pub(crate) fn may_rest<S: System + ?Sized>(
    system: &S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    (switch, side): (usize, f64),
) -> bool {
    let modes = [at_rest(system, switch), mode(system, switch, side)];
    agree(&mut *system.boxed_clone(), sampler, (t, y), switch, modes)
}

/// Whether everything moves alike in two modes of a switch, up to rounding.
fn agree<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    switch: usize,
    either: [f64; 2],
) -> bool {
    let present = system.modes().to_vec();
    let [one, other] = either.map(|mode| {
        let mut modes = present.clone();
        modes[switch] = mode;
        system.set_modes(&modes);
        sampler.at_state(system, t, y);
        sampler.accelerations().to_vec()
    });
    system.set_modes(&present);
    let noise = sampler.rounding_of_accelerations(system, (t, y));
    one.iter().zip(&other).zip(noise).all(|((one, other), noise)| (one - other).abs() <= EXPLAINED * noise)
}

/// The mode on the surface where nothing moves.
pub(super) fn at_rest<S: System + ?Sized>(system: &S, switch: usize) -> f64 {
    match system.description().switches[switch].kind {
        SwitchKind::Sign => 0.0,
        SwitchKind::Step => 1.0,
    }
}
