//! Sides of the switches of time alone at an instant, which nothing but the instant decides.

use super::modes::{self, Known};
use super::sample::Sampler;
use crate::constrain::held_switches;
use crate::mechanism::{SwitchKind, System};

/// Two times are one instant that differ by this part of themselves.
pub(super) const SAME: f64 = 4.0 * f64::EPSILON;

/// Forgets on which sides the switches were, and puts those of time alone where they are at t: at their zero, where they
/// are just after it, since `step(0)` is 1.
///
/// What a motion begins with, places that inputs ask for and masses, is then that of its first instant.
pub(crate) fn begin_at<S: System + ?Sized>(system: &mut S, t: f64, y: &[f64]) {
    if !system.description().switches.is_empty() {
        let mut sampler = Sampler::new(system);
        of_time(system, &mut sampler, t, y);
    }
}

/// Forgets on which sides the switches were, and puts all of them where they are at a state in which a motion begins: those on their surface
/// where the accelerations in the phase in force move them. No step is tried yet. Where no sides are found, switches of the state stay at their
/// zero: who begins the motion says why.
pub(crate) fn begin_at_state(system: &mut dyn System, t: f64, y: &[f64]) {
    if system.description().switches.is_empty() {
        return;
    }
    let mut sampler = Sampler::new(system);
    let sides = of_time(system, &mut sampler, t, y);
    let beyond: Vec<Option<f64>> = sides.into_iter().map(|side| side.filter(|side| *side != 0.0)).collect();
    let held = held_switches(system, (t, y));
    let known = Known {
        surface: &vec![false; beyond.len()],
        beyond: &beyond,
        leaves: None,
        held: &held,
        step: 0.0,
        next_stop: t,
    };
    if modes::choose(system, &mut sampler, (t, y), &known, &mut |_| None).is_err() {
        begin_at(system, t, y);
    }
}

/// As [`begin_at`]; the sides, 0 where neither value nor rate tells, `None` for the switches of the state.
pub(super) fn of_time<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    t: f64,
    y: &[f64],
) -> Vec<Option<f64>> {
    let known = system.description().switches.iter();
    let (timed, mut modes): (Vec<bool>, Vec<f64>) =
        known.map(|known| (known.time_only, if known.kind == SwitchKind::Sign { 0.0 } else { 1.0 })).unzip();
    system.set_modes(&modes);
    let mut sides = vec![None; timed.len()];
    // An argument contains modes of earlier switches only.
    for switch in (0..timed.len()).filter(|switch| timed[*switch]) {
        sampler.at_time(system, t, y);
        let side = in_time(sampler, switch, t);
        sides[switch] = Some(side);
        if side != 0.0 {
            modes[switch] = modes::mode(system, switch, side);
            system.set_modes(&modes);
        }
    }
    sides
}

/// On which side a switch of time alone is from t on, under the modes in force; 0 where neither its argument nor the rate of that tells.
pub(super) fn in_time(sampler: &Sampler, switch: usize, t: f64) -> f64 {
    let (value, rate) = (sampler.value(sampler.function_of(switch)), sampler.rate(switch));
    let seen = if value.abs() <= SAME * t.abs() * rate.abs() { rate } else { value };
    if seen == 0.0 || seen.is_nan() { 0.0 } else { seen.signum() }
}
