//! Discontinuities of time: the times at which every step must end.

use super::old::{dip, root};
use super::sample::Sampler;
use crate::mechanism::System;

/// How many points of time are looked at where an argument is no straight line.
const POINTS: usize = 20_000;

/// A time at which the arguments of some switches vanish.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stop {
    /// s.
    pub t: f64,
    /// Which.
    pub switches: Vec<usize>,
}

/// The zeros of all switches that depend on time alone, after `from` and before `until`, in order.
///
/// Exact where the argument is a straight line in t; else by looking at twenty thousand points, and at what
/// hides between them where the argument turns.
pub(crate) fn stop_times<S: System + ?Sized>(
    system: &S,
    sampler: &mut Sampler,
    (from, until): (f64, f64),
    y: &[f64],
) -> Vec<Stop> {
    let mut zeros: Vec<(f64, usize)> = Vec::new();
    for (switch, what) in system.description().switches.iter().enumerate() {
        if what.time_only {
            let mut argument = |t: f64| {
                sampler.at_state(system, t, y);
                let function = sampler.function_of(switch);
                (sampler.value(function), sampler.second(function))
            };
            zeros_of(&mut argument, from, until, |t| zeros.push((t, switch)));
        }
    }
    zeros.retain(|(t, _)| *t > from && *t < until);
    zeros.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut stops: Vec<Stop> = Vec::new();
    for (t, switch) in zeros {
        match stops.last_mut() {
            Some(stop) if t - stop.t <= 4.0 * f64::EPSILON * t.abs() => stop.switches.push(switch),
            _ => stops.push(Stop { t, switches: vec![switch] }),
        }
    }
    stops
}

fn zeros_of(argument: &mut impl FnMut(f64) -> (f64, f64), from: f64, until: f64, mut found: impl FnMut(f64)) {
    let (value, rate) = argument(from);
    let span = until - from;
    let straight = [0.1, 0.37, 0.5, 0.83, 1.0].into_iter().all(|part| {
        let (there, slope) = argument(from + part * span);
        let expected = value + rate * part * span;
        slope == rate && (there - expected).abs() <= 1e-12 * (value.abs() + (rate * span).abs())
    });
    if straight {
        if rate != 0.0 {
            found(from - value / rate);
        }
        return;
    }
    let time = |k: usize| from + span * (k as f64 / POINTS as f64);
    let mut only = |t: f64| argument(t).0;
    let mut last = (from, value);
    let mut before = last;
    for k in 1..=POINTS {
        let here = (time(k), only(time(k)));
        let turns = before.1.abs() >= last.1.abs() && here.1.abs() >= last.1.abs();
        if last.1 != 0.0 && before.1 * last.1 > 0.0 && last.1 * here.1 > 0.0 && turns {
            let sign = last.1.signum();
            let lift = |point: (f64, f64)| (point.0, sign * point.1);
            if let Some((t, hidden)) = dip(|t| sign * only(t), lift(before), lift(last), lift(here)) {
                let hidden = (t, sign * hidden);
                found(root(&mut only, before, hidden));
                found(root(&mut only, hidden, here));
            }
        } else if last.1 * here.1 < 0.0 {
            found(root(&mut only, last, here));
        } else if here.1 == 0.0 {
            found(here.0);
        }
        (before, last) = (last, here);
    }
}
