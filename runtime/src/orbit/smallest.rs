//! The smallest map that closes a motion.

use super::closing::{By, Closing};
use super::laps::{Laps, Solution};
use crate::mechanism::System;

/// Parts of a period that are tried.
const PARTS: usize = 12;
/// A guess may go round so many times.
const LAPS: usize = 100;
/// Coordinates follow each other at so many times of a period.
const TIMES: usize = 24;
/// Coordinates that follow each other to this part of how far they go are one another's images,
const FOLLOWS: f64 = 1e-6;
/// or, where the tolerance is loose, to so many times what more accurate runs make of the motion.
const UNKNOWN: f64 = 10.0;

/// To which part of how far they go coordinates of a motion follow each other that is known to a part.
pub(super) fn follows_to(known: f64) -> f64 {
    FOLLOWS.max(UNKNOWN * known)
}

/// The mechanism with some parameters, and its period with these, s.
pub(super) type WithPeriod = (Box<dyn System>, f64);

/// The map of the smallest part of the period after which coordinates follow each other, exchanged or mirrored, where the mechanism moves
/// alike from a state and from its image: with its present parameters, and with all others for which it is asked, each with its period.
/// `None` where there is none but that of the whole period.
pub(super) fn smallest(systems: &[WithPeriod], laps: &Laps, solution: &Solution, to: f64) -> Option<Closing> {
    let (from, phase) = (laps.settings.from, laps.settings.phase);
    let period = laps.duration(&solution.trial);
    let parts = (0..TIMES).map(|k| k as f64 / TIMES as f64);
    let states: Vec<_> = parts.filter_map(|part| Some((from + part * period, solution.at(part)?, phase))).collect();
    (2..=PARTS).rev().find_map(|part| {
        let closing = followed(&*systems.first()?.0, solution, part, (&laps.scales, to))?;
        let differs = |(system, period): &WithPeriod| {
            let later = period / part as f64;
            closing.differs(&**system, &states, later).is_some()
                || closing.event_differs(&**system, &states, later).is_some()
        };
        (!systems.iter().any(differs)).then_some(closing)
    })
}

/// How often a motion is as it was within its period, to a part of the scales: the most, if more than once.
pub(super) fn laps(solution: &Solution, (scales, to): (&[f64], f64)) -> Option<usize> {
    let start = solution.at(0.0)?;
    let again = |laps: &usize| {
        let later = solution.at(1.0 / *laps as f64);
        later.is_some_and(|later| {
            start.iter().zip(&later).zip(scales).all(|((here, later), scale)| (here - later).abs() <= to * scale)
        })
    };
    (2..=LAPS).rev().find(again)
}

/// Which coordinate follows which a part of the period later, to a part of the scales.
fn followed(system: &dyn System, solution: &Solution, part: usize, (scales, to): (&[f64], f64)) -> Option<Closing> {
    let n = system.len();
    let at = |k: usize, parts: usize| solution.at((k as f64 / TIMES as f64 + parts as f64 / part as f64).fract());
    let pairs: Vec<_> = (0..TIMES).map(|k| Some((at(k, 0)?, at(k, 1)?))).collect::<Option<_>>()?;
    let follows = |i: usize, k: usize, opposite: bool| {
        let sign = if opposite { -1.0 } else { 1.0 };
        let near = |i: usize, k: usize, (here, later): &(Vec<f64>, Vec<f64>)| {
            (here[i] - sign * later[k]).abs() <= to * scales[i]
        };
        pairs.iter().all(|pair| near(i, k, pair) && near(n + i, n + k, pair))
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
