//! Choosing the modes of the switches.

use super::sample::Sampler;
use crate::cause::Cause;
use crate::mechanism::{At, SwitchKind, System};

/// Chooses the modes at a state.
///
/// Off its surface (argument = 0) a switch's mode is the sign of the argument.  On it, the mode is the one
/// into whose side the motion leaves when that mode is in force.  Where both modes push back to the surface,
/// there is no such motion.  `surface` tells which switches are known to be on their surface; others are
/// where their argument vanishes, or would do so within `instant` seconds.  `leaves` names one that is known
/// to leave its surface, and to which side.
///
/// A `sign` whose mode is 0, as at the start, stays 0 if nothing moves with it; one that slid until then and
/// is pushed back from both sides does not come to rest by itself: what holds it there is for a phase to say.
///
/// # Errors
/// [`Cause::Chattering`] names the switch to which both sides push back.
pub(crate) fn choose<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    surface: &[bool],
    leaves: Option<(usize, f64)>,
    instant: f64,
) -> Result<Vec<bool>, Cause> {
    let count = system.description().switches.len();
    let mut modes = system.modes().to_vec();
    let mut on: Vec<bool> = surface.to_vec();
    let rests: Vec<bool> = (0..count).map(|switch| side(system, switch) == 0.0).collect();
    sampler.at_state(system, t, y);
    for switch in 0..count {
        let function = sampler.function_of(switch);
        let (value, rate) = (sampler.value(function), sampler.second(function));
        on[switch] |= value == 0.0 || value.abs() <= instant * rate.abs();
        if !on[switch] {
            modes[switch] = mode(system, switch, value);
        } else if rests[switch] {
            modes[switch] = 1.0;
        }
    }
    system.set_modes(&modes);
    // Each choice may change what the others see: go round until all agree.
    for _ in 0..=2 * count {
        let mut changed = false;
        for switch in (0..count).filter(|switch| on[*switch]) {
            let chosen = leaving(system, sampler, (t, y), (switch, rests[switch]), instant)?;
            let chosen = match leaves {
                Some((other, side)) if other == switch && chosen == 0.0 => mode(system, switch, side),
                _ => chosen,
            };
            changed |= chosen != modes[switch];
            modes[switch] = chosen;
            system.set_modes(&modes);
        }
        if !changed {
            return Ok(on);
        }
    }
    let switch = on.iter().position(|on| *on).unwrap_or(0);
    Err(Cause::Chattering { switch: text(system, switch) })
}

/// A switch's mode on the side of this sign.
pub(crate) fn mode<S: System + ?Sized>(system: &S, switch: usize, side: f64) -> f64 {
    match system.description().switches[switch].kind {
        SwitchKind::Sign => side.signum(),
        SwitchKind::Step => f64::from(side >= 0.0),
    }
}

/// The side on which a mode puts the argument: −1, 0 or 1.
pub(crate) fn side<S: System + ?Sized>(system: &S, switch: usize) -> f64 {
    let mode = system.modes()[switch];
    match system.description().switches[switch].kind {
        SwitchKind::Sign => mode,
        SwitchKind::Step => 2.0 * mode - 1.0,
    }
}

/// A switch's argument as the model file has it.
pub(crate) fn text<S: System + ?Sized>(system: &S, switch: usize) -> String {
    system.description().switches.get(switch).map_or_else(String::new, |switch| switch.text.to_string())
}

/// The mode with which the motion leaves the surface of a switch.
fn leaving<S: System + ?Sized>(
    system: &mut S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    (switch, rested): (usize, bool),
    instant: f64,
) -> Result<f64, Cause> {
    let present = system.modes().to_vec();
    let mut direction = |system: &mut S, mode: f64| {
        let mut trial = present.clone();
        trial[switch] = mode;
        system.set_modes(&trial);
        direction(system, sampler, (t, y), switch, instant)
    };
    let (above, below) = (mode(system, switch, 1.0), mode(system, switch, -1.0));
    let up = direction(system, above);
    let down = direction(system, below);
    let chosen = match (up > 0.0, down < 0.0) {
        (true, false) => above,
        (false, true) => below,
        // Both sides lead away: as before, or the side of `step(0)`.
        (true, true) => {
            if present[switch] == below {
                below
            } else {
                above
            }
        }
        (false, false) if up == 0.0 && down == 0.0 => at_rest(system, switch),
        (false, false) => {
            let rests = rested && direction(system, 0.0).abs() <= 1e-12 * (up.abs() + down.abs());
            if !rests {
                system.set_modes(&present);
                return Err(Cause::Chattering { switch: text(system, switch) });
            }
            0.0
        }
    };
    system.set_modes(&present);
    Ok(chosen)
}

/// The mode on the surface where nothing moves.
fn at_rest<S: System + ?Sized>(system: &S, switch: usize) -> f64 {
    match system.description().switches[switch].kind {
        SwitchKind::Sign => 0.0,
        SwitchKind::Step => 1.0,
    }
}

/// Where the argument of a switch goes under the present modes: its rate, or where that vanishes its change
/// over an instant.
fn direction<S: System + ?Sized>(
    system: &S,
    sampler: &mut Sampler,
    (t, y): (f64, &[f64]),
    switch: usize,
    instant: f64,
) -> f64 {
    let function = sampler.function_of(switch);
    sampler.at_state(system, t, y);
    let (value, rate) = (sampler.value(function), sampler.second(function));
    if rate != 0.0 {
        return rate;
    }
    // A longer instant than that of the location: second-order changes have to show above rounding.
    let h = 1e6 * instant;
    let n = system.len();
    let mut a = vec![0.0; n];
    if system.accelerations(At::packed(t, y, n), &mut a).is_err() {
        return f64::NAN;
    }
    let mut moved = y[..2 * n].to_vec();
    for i in 0..n {
        moved[i] += h * (y[n + i] + 0.5 * h * a[i]);
        moved[n + i] += h * a[i];
    }
    sampler.at_state(system, t + h, &moved);
    sampler.value(function) - value
}
