//! Which clocks tick when, until they come together again.

use crate::linear::LinearError;
use crate::mechanism::{System, is_of_noise};

/// More ticks than this until all clocks come together again are refused.
pub(super) const MOST_TICKS: usize = 10_000;
/// Times within this part of the whole are one instant.
pub(super) const INSTANT: f64 = 1e-12;
/// Ratios of periods, of a few roundings each, are quotients of whole numbers to so many roundings: far fewer than quotients with denominators up to
/// [`MOST_TICKS`] are apart, 10⁻⁸.
const RATIO: f64 = 16.0 * f64::EPSILON;

/// Which clocks tick when, until they come together again.
pub(super) struct Cycle {
    /// Whether each clock ticks at an instant, and how long, s, until the next one.
    pub instants: Vec<(Vec<bool>, f64)>,
    /// s.
    pub period: f64,
}

impl Cycle {
    pub fn of<S: System + ?Sized>(system: &S) -> Result<Cycle, LinearError> {
        let all = system.clocks();
        let clocks: Vec<(usize, [f64; 2])> =
            all.iter().copied().enumerate().filter(|(k, _)| !is_of_noise(system, *k)).collect();
        let Some((_, [start, first])) = clocks.first().copied() else { return Err(LinearError::NotSampled) };
        // So many periods of the first clock, by what its period is to each of the others.
        let mut count = 1_u64;
        for (_, [_, every]) in &clocks {
            let (a, _) = quotient(every / first).ok_or(LinearError::TooManyTicks { most: MOST_TICKS })?;
            count = count / gcd(count, a) * a;
            if count > MOST_TICKS as u64 {
                return Err(LinearError::TooManyTicks { most: MOST_TICKS });
            }
        }
        let period = count as f64 * first;
        let mut ticks: Vec<(f64, usize)> = Vec::new();
        for (k, [from, every]) in &clocks {
            let number = (period / every).round() as usize;
            if ticks.len() + number > MOST_TICKS {
                return Err(LinearError::TooManyTicks { most: MOST_TICKS });
            }
            let phase = (from - start).rem_euclid(*every);
            let phase = if every - phase <= INSTANT * period { 0.0 } else { phase };
            ticks.extend((0..number).map(|tick| ((tick as f64).mul_add(*every, phase), *k)));
        }
        ticks.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut times: Vec<(f64, Vec<bool>)> = Vec::new();
        for (t, clock) in ticks {
            if times.last().is_none_or(|(last, _)| t - last > INSTANT * period) {
                times.push((t, vec![false; all.len()]));
            }
            times.last_mut().into_iter().for_each(|(_, ticking)| ticking[clock] = true);
        }
        let next = |k: usize| times.get(k + 1).map_or(times[0].0 + period, |(t, _)| *t);
        let gaps: Vec<f64> = (0..times.len()).map(|k| next(k) - times[k].0).collect();
        Ok(Cycle { instants: times.into_iter().map(|(_, ticking)| ticking).zip(gaps).collect(), period })
    }
}

/// The quotient of whole numbers, the second no larger than [`MOST_TICKS`], that a number is to rounding, by its continued fraction.
fn quotient(x: f64) -> Option<(u64, u64)> {
    let (mut before, mut now, mut rest) = ((0_u64, 1_u64), (1_u64, 0_u64), x);
    loop {
        let whole = rest.floor();
        if !(0.0..=MOST_TICKS as f64).contains(&whole) {
            return None;
        }
        let next = (whole as u64 * now.0 + before.0, whole as u64 * now.1 + before.1);
        (before, now) = (now, next);
        if now.1 > MOST_TICKS as u64 {
            return None;
        }
        if (now.0 as f64 / now.1 as f64 - x).abs() <= RATIO * x {
            return Some(now);
        }
        rest = 1.0 / (rest - whole);
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}
