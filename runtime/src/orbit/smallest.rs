//! The smallest map that closes a motion.

use super::closing::{By, Closing};
use crate::mechanism::System;
use crate::run::Run;

/// Parts of a period that are tried.
const PARTS: usize = 12;
/// Coordinates follow each other at so many times of a period.
const TIMES: usize = 24;
/// Coordinates that follow each other to this part of how far they go are one another's images: motions that are compared are known to a tenth
/// of it.
pub(super) const FOLLOWS: f64 = 1e-6;

/// The mechanism with some parameters, and its period with these, s.
pub(super) type WithPeriod = (Box<dyn System>, f64);

/// The map of the smallest part of the period after which coordinates follow each other, exchanged or mirrored, where the mechanism moves
/// alike from a state and from its image: with its present parameters, and with all others for which it is asked, each with its period.
/// `None` where there is none but that of the whole period.
pub(super) fn smallest(
    systems: &[WithPeriod],
    run: &Run,
    (from, period): (f64, f64),
    scales: &[f64],
) -> Option<Closing> {
    let states: Vec<(f64, Vec<f64>, usize)> = (0..TIMES)
        .filter_map(|k| run.at(from + k as f64 / TIMES as f64 * period))
        .map(|state| (state.t, [state.q, state.v].concat(), 0))
        .collect();
    (2..=PARTS).rev().find_map(|part| {
        let closing = followed(&*systems.first()?.0, run, (from, period, part), scales)?;
        let differs =
            |(system, period): &WithPeriod| closing.differs(&**system, &states, period / part as f64).is_some();
        (!systems.iter().any(differs)).then_some(closing)
    })
}

/// Which coordinate follows which a part of the period later.
fn followed(
    system: &dyn System,
    run: &Run,
    (from, period, part): (f64, f64, usize),
    scales: &[f64],
) -> Option<Closing> {
    let n = system.len();
    let at = |k: usize, parts: usize| {
        let within = (k as f64 / TIMES as f64 + parts as f64 / part as f64).fract();
        run.at(from + within * period)
    };
    let pairs: Vec<_> = (0..TIMES).map(|k| Some((at(k, 0)?, at(k, 1)?))).collect::<Option<_>>()?;
    let follows = |i: usize, k: usize, opposite: bool| {
        let sign = if opposite { -1.0 } else { 1.0 };
        pairs.iter().all(|(here, later)| {
            (here.q[i] - sign * later.q[k]).abs() <= FOLLOWS * scales[i]
                && (here.v[i] - sign * later.v[k]).abs() <= FOLLOWS * scales[n + i]
        })
    };
    let units = &system.description().coordinates;
    let mut taken = vec![false; n];
    let mut images = Vec::with_capacity(n);
    for i in 0..n {
        let others = (0..n).filter(|k| *k != i && units[*k].unit == units[i].unit);
        let image = std::iter::once(i)
            .chain(others)
            .flat_map(|k| [(k, false), (k, true)])
            .find(|(k, opposite)| !taken[*k] && follows(i, *k, *opposite))?;
        taken[image.0] = true;
        images.push(image);
    }
    Some(Closing { by: By::Part(part), images, ..Closing::period(system.description()) })
}
