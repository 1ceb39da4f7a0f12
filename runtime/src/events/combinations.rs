//! Combinations of sides of the switches that are on their surfaces, and where their arguments go under each.

use super::certify::Sample;
use super::modes::{Known, STANDS, Trial, at_rest, mode, no_number, side_of};
use super::sample::Sampler;
use super::sides::in_time;
use super::stops::between;
use crate::cause::Cause;
use crate::mechanism::System;

/// An argument that would vanish within this part of a step vanishes.
const NOW: f64 = 1e-11;
/// What slides is brought back to its surface to so many roundings of the state.
const ROUNDINGS: f64 = 16.0;
/// A rate that is this part of the mean one over a step is next to nothing.
const NEXT_TO_NOTHING: f64 = 1e-6;
/// Combinations of sides that are tried.
const MOST_COMBINATIONS: usize = 64;

/// Sides of the switches that are on their surface.
#[derive(Clone)]
pub(super) struct Combination {
    /// The modes of all switches.
    pub modes: Vec<f64>,
    /// Which are on their surface.
    pub on: Vec<bool>,
}

/// The switches before their modes are chosen.
pub(super) struct ModesBefore<'a> {
    /// Their modes; of those that slid the modes at rest.
    pub modes: &'a [f64],
    /// Those that slid.
    pub slid: &'a [usize],
    /// Those that leave their surface, and to which side.
    pub leaving: &'a [(usize, f64)],
}

/// The combinations of sides that a state allows, the present one first: a switch off its surface has the sign of its argument under the
/// modes of earlier ones.
///
/// # Errors
/// [`Cause::NonFinite`] names one whose argument, of time alone, is no number.
pub(super) fn combinations<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    known: &Known<'_>,
    before: &ModesBefore<'_>,
) -> Result<Vec<Combination>, Box<Cause>> {
    let count = before.modes.len();
    // Those of time first: an input may contain some, and switches of the state the input.
    let of_time = |switch: &usize| system.description().switches[*switch].time_only;
    let (timed, others): (Vec<usize>, Vec<usize>) = (0..count).partition(of_time);
    let order = [timed, others].concat();
    let mut combinations = Vec::new();
    // With the place of the switch to look at next.
    let mut stack = vec![(Combination { modes: before.modes.to_vec(), on: vec![false; count] }, 0)];
    while let Some((mut one, next)) = stack.pop() {
        for (place, &switch) in order.iter().enumerate().skip(next) {
            system.set_modes(&one.modes);
            if let Some(side) = known.beyond[switch] {
                one.modes[switch] = mode(system, switch, side);
                continue;
            }
            if known.held[switch] {
                one.modes[switch] = at_rest(system, switch);
                continue;
            }
            sampler.at_state(system, t, y);
            if system.description().switches[switch].time_only {
                // Nothing but the instant decides, however short the time to its next zero is beside a step.
                let mut side = in_time(sampler, switch, t);
                if side == 0.0 && known.next_stop > t {
                    // It leaves with a power of time: it has one sign until the next stop.
                    side = between(system, sampler, switch, (t, known.next_stop), y);
                }
                if side.is_nan() {
                    return Err(no_number(system, switch, t).into());
                }
                if side != 0.0 {
                    one.modes[switch] = mode(system, switch, side);
                }
                continue;
            }
            let (value, rate) = (sampler.value(sampler.function_of(switch)), sampler.rate(switch));
            let on = known.surface[switch]
                || value == 0.0
                || value.abs() <= NOW * known.step * rate.abs()
                || before.slid.contains(&switch) && !has_jumped(system, sampler, (t, y), (switch, value), known.step);
            if !on {
                // Under other modes it may be a number.
                if !value.is_nan() {
                    one.modes[switch] = mode(system, switch, value);
                }
                continue;
            }
            one.on[switch] = true;
            let [first, second] = sides(system, switch, before);
            if combinations.len() + stack.len() < MOST_COMBINATIONS {
                let mut other = one.clone();
                other.modes[switch] = second;
                stack.push((other, place + 1));
            }
            one.modes[switch] = first;
        }
        combinations.push(one);
    }
    Ok(combinations)
}

/// Whether what slid in its surface was taken off it at once, as by an impact or by a value that was set: its argument is more than rounding, and
/// than either side changes it by at once.
fn has_jumped<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    (switch, value): (usize, f64),
    step: f64,
) -> bool {
    let present = system.modes().to_vec();
    let fastest = [1.0, -1.0].map(|side| {
        let mut modes = present.clone();
        modes[switch] = mode(system, switch, side);
        system.set_modes(&modes);
        sampler.at_state(system, t, y);
        sampler.rate(switch).abs()
    });
    system.set_modes(&present);
    let now = NOW * step * fastest[0].max(fastest[1]);
    value.abs() > now && value.abs() > ROUNDINGS * sampler.rounding_at(system, sampler.function_of(switch), (t, y))
}

/// A switch on its surface that two combinations move away to different sides, each to the one that it says.
pub(super) fn undecided<S: System + ?Sized>(
    system: &S,
    combinations: &[Combination],
    directions: &[Vec<f64>],
) -> Option<usize> {
    let agree: Vec<&Vec<f64>> = combinations
        .iter()
        .zip(directions)
        .filter(|(one, to)| against(system, one, to, directions).is_empty())
        .map(|(_, to)| to)
        .collect();
    let count = agree.first().map_or(0, |to| to.len());
    (0..count).find(|k| agree.iter().any(|to| to[*k] > 0.0) && agree.iter().any(|to| to[*k] < 0.0))
}

/// The first combination that moves every argument on its surface to the side that it says, and where it moves them; one that
/// moves something before others.
pub(super) fn agreed<S: System + ?Sized>(
    system: &S,
    combinations: &[Combination],
    directions: &[Vec<f64>],
) -> Option<(Combination, Vec<f64>)> {
    let agree =
        || combinations.iter().zip(directions).filter(|(one, to)| against(system, one, to, directions).is_empty());
    let moves = |(one, to): &(&Combination, &Vec<f64>)| one.on.iter().zip(*to).any(|(on, to)| *on && *to != 0.0);
    agree().find(moves).or_else(|| agree().next()).map(|(one, to)| (one.clone(), to.clone()))
}

/// The switches on their surface that a combination moves against the sides that it says.
pub(super) fn against<S: System + ?Sized>(
    system: &S,
    one: &Combination,
    to: &[f64],
    directions: &[Vec<f64>],
) -> Vec<usize> {
    let back = |k: &usize| one.on[*k] && side_of(system, *k, one.modes[*k]) * to[*k] < -STANDS * scale(directions, *k);
    (0..one.on.len()).filter(back).collect()
}

/// The largest size of what an argument does under any combination.
pub(super) fn scale(directions: &[Vec<f64>], switch: usize) -> f64 {
    directions.iter().map(|to| to[switch].abs()).fold(0.0, f64::max)
}

/// When a trial step tells where an argument goes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Looks {
    /// Where its rate vanishes.
    WhereRatesVanish,
    /// Where its rate is next to nothing, too.
    Always,
}

/// Where the arguments on their surface go under each combination.
pub(super) fn all_directions<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    (combinations, looks): (&[Combination], Looks),
    trial: Trial<'_, S>,
) -> Vec<Vec<f64>> {
    combinations.iter().map(|one| directions(system, sampler, (t, y), (one, looks), trial)).collect()
}

/// Where the arguments on their surface go under a combination: their rates or, where a trial step tells, their values in it.
fn directions<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    (one, looks): (&Combination, Looks),
    trial: Trial<'_, S>,
) -> Vec<f64> {
    system.set_modes(&one.modes);
    sampler.at_state(system, t, y);
    let mut to: Vec<f64> = (0..one.on.len()).map(|k| if one.on[k] { sampler.rate(k) } else { 0.0 }).collect();
    let unsure: Vec<usize> =
        (0..to.len()).filter(|k| one.on[*k] && (to[*k] == 0.0 || looks == Looks::Always)).collect();
    if unsure.is_empty() {
        return to;
    }
    let Some(step) = trial(system) else { return to };
    let mut samples: Vec<Sample> = Vec::new();
    for switch in unsure {
        // The first values that stand out: a long step may lead through many zeros.
        let function = sampler.function_of(switch);
        let mut at = |theta: f64| {
            sampler.samples(system, &step.segment(), theta, &mut samples);
            samples[function]
        };
        let start = at(0.0).value;
        let (mut theta, mut change) = (1.0, 0.0);
        for _ in 0..40 {
            let here = at(theta);
            change = here.value - start;
            // Bent away from zero like a power of θ: the slope agrees with the value.
            let power = theta * here.slope / change;
            if change != 0.0 && (0.9..8.5).contains(&power) || change == 0.0 && here.slope == 0.0 {
                break;
            }
            theta *= 0.5;
        }
        let mean = change / (theta * step.h);
        if to[switch].abs() <= NEXT_TO_NOTHING * mean.abs() {
            to[switch] = mean;
        }
    }
    to
}

/// The sides to try for a switch on its surface, the present one first.
fn sides<S: System + ?Sized>(system: &S, switch: usize, before: &ModesBefore<'_>) -> [f64; 2] {
    let (above, below) = (mode(system, switch, 1.0), mode(system, switch, -1.0));
    let first = match before.leaving.iter().find(|(other, _)| *other == switch) {
        Some((_, side)) => mode(system, switch, *side),
        None if before.modes[switch] == below => below,
        None => above,
    };
    if first == above { [above, below] } else { [below, above] }
}
