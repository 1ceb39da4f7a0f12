//! Limits of friction that are none.

use nalgebra::DVector;

use super::directions::direction;
use super::{IN_SPAN, held_direction, kinematics};
use crate::cause::Cause;
use crate::matrix::svd;
use crate::mechanism::dense::{constraint_matrix, multiplier_effects};
use crate::mechanism::{At, ContactEvent, ContactMode, System};

/// A limit below this part of what the forces make of it is zero.
const NOTHING: f64 = 1e-10;
/// A moment before or after an instant is this part of its time, and of the time in which all has gone as far as it is: more than its rounding.
const MOMENT: f64 = 1e-9;

/// The limits of what rubs and touches, or of contacts the coefficients of friction.
struct Limit {
    contact: usize,
    /// While it slides, and the size of that while it sticks.
    slides: f64,
    sticks: f64,
    /// What is rounding.
    zero: f64,
}

impl Limit {
    fn is_negative(&self) -> bool {
        self.slides < -self.zero
    }

    fn is_wrong(&self) -> bool {
        self.is_negative() || self.sticks < self.slides - self.zero
    }
}

/// Refuses limits that are negative, with which friction would drive, and those of sticking that are smaller than those of sliding, in the phase
/// in force.
///
/// # Errors
/// [`Cause::NegativeLimit`], [`Cause::StaticBelowLimit`].
pub(crate) fn possible_limits(system: &mut dyn System, t: f64, y: &[f64]) -> Result<(), Box<Cause>> {
    let modes = system.contacts().modes(system.phase());
    let touches: Vec<bool> = modes.into_iter().map(ContactMode::touches).collect();
    possible_limits_of(system, (t, y), &touches)
}

/// The same of those that touch, whatever the phase.
pub(super) fn possible_limits_of(
    system: &mut dyn System,
    (t, y): (f64, &[f64]),
    touches: &[bool],
) -> Result<(), Box<Cause>> {
    let wrong: Vec<Limit> = limits(system, (t, y), touches).into_iter().filter(Limit::is_wrong).collect();
    let Some(first) = wrong.first() else { return Ok(()) };
    // Where a limit jumps or vanishes at this instant, rounding decides what it is; shortly before or after it is what it should be.
    let n = system.len();
    let size = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (places, speeds) = (size(&y[..n]), size(&y[n..]));
    let moment = MOMENT * if speeds > 0.0 { t.abs().max(places / speeds) } else { t.abs() };
    for moment in [-moment, moment] {
        let beside: Vec<f64> = (0..2 * n).map(|i| if i < n { y[i] + moment * y[n + i] } else { y[i] }).collect();
        let known = limits(system, (t + moment, &beside), touches);
        if !known.iter().any(|limit| limit.contact == first.contact && limit.is_wrong()) {
            return Ok(());
        }
    }
    let known = &system.contacts().all[first.contact];
    let (friction, is_coefficient) = (known.name.to_string(), known.normal.is_some());
    Err(match first {
        Limit { slides, .. } if first.is_negative() => {
            Cause::NegativeLimit { friction, limit: *slides, is_coefficient }.into()
        }
        Limit { slides, sticks, .. } => {
            Cause::StaticBelowLimit { friction, sticking: *sticks, sliding: *slides, is_coefficient }.into()
        }
    })
}

/// The limit of sliding of a contact as a part of that of sticking, in the phase in force; `None` where it is not known.
pub(super) fn part_of_sticking(
    system: &mut dyn System,
    at: (f64, &[f64]),
    touches: &[bool],
    contact: usize,
) -> Option<f64> {
    let known = limits(system, at, touches).into_iter().find(|limit| limit.contact == contact)?;
    (known.sticks > 0.0).then_some(known.slides / known.sticks)
}

/// ∂s/∂q' of a contact; in space of s along the direction of sliding, as generated code has it.
pub(super) fn along_sliding(system: &dyn System, at: At<'_>, contact: usize) -> Vec<f64> {
    let known = &system.contacts().all[contact];
    let rows: Vec<usize> = known.tangents().map(|row| row as usize).collect();
    let matrix = constraint_matrix(system, at, &rows);
    let parts = match known.direction {
        Some(_) => direction(kinematics(system, at)[contact].sliding, held_direction(system, contact)),
        None => [1.0, 0.0],
    };
    (0..at.q.len()).map(|i| (0..rows.len()).map(|row| parts[row] * matrix[(row, i)]).sum()).collect()
}

fn limits(system: &mut dyn System, (t, y): (f64, &[f64]), touches: &[bool]) -> Vec<Limit> {
    let (n, phase, contacts) = (system.len(), system.phase(), system.contacts().all.clone());
    let (modes, rows) = (system.contacts().modes(phase), system.description().rows.len());
    let at = At::packed(t, y, n);
    let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; rows]);
    let mut found = Vec::new();
    let rubs = (0..contacts.len()).filter(|k| contacts[*k].tangent.is_some() && touches[*k]);
    if system.accelerations_and_multipliers(at, &mut a, &mut lambda).is_err() {
        return found;
    }
    let all: Vec<usize> = (0..rows).collect();
    for k in rubs {
        let Some(event) = contacts[k].event(ContactEvent::Slips) else { continue };
        let tangents: Vec<usize> = contacts[k].tangents().map(|row| row as usize).collect();
        // Of a contact the coefficient is looked at: what it is with a force across of 1.
        let mut known = match contacts[k].normal {
            Some(normal) => (0..rows).map(|row| f64::from(u8::from(row == normal as usize))).collect(),
            None => lambda.clone(),
        };
        tangents.iter().for_each(|tangent| known[*tangent] = 0.0);
        let mut forces = |mode: ContactMode| -> Vec<f64> {
            let mut modes = modes.clone();
            modes[k] = mode;
            let phase = system.contacts().phase(&modes);
            system.set_phase(phase);
            let by_multipliers = multiplier_effects(system, at, &all);
            let mut h = vec![0.0; n];
            if contacts[k].normal.is_none() {
                system.bias(at, &mut h);
            }
            (0..n).map(|i| (0..rows).map(|row| by_multipliers[(i, row)] * known[row]).sum::<f64>() - h[i]).collect()
        };
        // Sliding forwards it pushes with −L along the rate, backwards with L; where it sticks with nothing.
        let (both, times) = match contacts[k].direction {
            Some(_) => ([ContactMode::Slides, ContactMode::Sticks], 1.0),
            None => ([ContactMode::SlipsForwards, ContactMode::SlipsBackwards], 0.5),
        };
        let [forwards, backwards] = both.map(&mut forces);
        // In which direction it rubs where its rate is rounding, only generated code knows: by both components.
        let along = constraint_matrix(system, at, &tangents);
        let pushed = DVector::from_fn(n, |i, _| times * (backwards[i] - forwards[i]));
        let Some(spanned) = svd(along.transpose(), true, true) else { continue };
        let nothing = IN_SPAN * spanned.singular_values.max();
        let Ok(parts) = spanned.solve(&pushed, nothing) else { continue };
        let slides = match held_direction(system, k) {
            [d1, d2, _] if contacts[k].direction.is_some() => parts.norm().copysign(d1 * parts[0] + d2 * parts[1]),
            _ => parts[0],
        };
        let terms = (0..tangents.len()).map(|row| {
            let size = along.row(row).norm_squared();
            (0..n)
                .map(|i| (along[(row, i)] * forwards[i]).abs().max((along[(row, i)] * backwards[i]).abs()))
                .sum::<f64>()
                / size
        });
        let terms = terms.fold(0.0, f64::max);
        let mut pairs = vec![0.0; 2 * system.description().events.len()];
        system.events(at.accelerated(&a).constrained(&known), &mut pairs);
        let sticks = pairs[2 * event].max(0.0).sqrt();
        if slides.is_finite() && sticks.is_finite() {
            found.push(Limit { contact: k, slides, sticks, zero: NOTHING * terms.max(sticks) });
        }
    }
    system.set_phase(phase);
    found
}
