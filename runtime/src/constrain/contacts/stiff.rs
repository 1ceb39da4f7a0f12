//! Where sliding in space begins so slowly that its direction makes the equations stiff.

use super::known::slowed;
use super::trials::{Motion, compliance};
use super::{Moment, Situation};
use crate::mechanism::{At, ContactMode, System};

/// What is left over is next to nothing below this part of what friction does: an explicit method would take hundreds of steps more than a stiff one.
const LEFT_OVER: f64 = 0.01;

/// Whether something begins to slide in space while next to no force is left over for that: its direction follows the forces within |s|/(μ g), which is
/// far less than the time in which |s| grows.
pub(crate) fn begins_stiffly(system: &dyn System, moment: &Moment<'_>) -> bool {
    let (contacts, modes) = (&system.contacts().all, system.contacts().modes(system.phase()));
    if !modes.contains(&ContactMode::Slides) {
        return false;
    }
    let at = At::packed(moment.t, moment.y, system.len());
    let Some(motion) = Motion::of(system, (moment.t, moment.y)) else { return false };
    let mut pairs = vec![0.0; 2 * system.description().events.len()];
    system.events(at.accelerated(&motion.a).constrained(&motion.lambda), &mut pairs);
    let (compliance, situation) = (compliance(system, at), Situation::new(system, moment));
    let begins = |k: usize| {
        let left = contacts[k].tangents().map(|row| motion.second[row as usize].powi(2)).sum::<f64>().sqrt();
        let slows = slowed(&contacts[k], (&pairs, &motion.lambda), &compliance);
        modes[k] == ContactMode::Slides && situation.still[k][1] && left < LEFT_OVER * slows
    };
    (0..contacts.len()).any(begins)
}
