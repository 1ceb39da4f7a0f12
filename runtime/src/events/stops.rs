//! Discontinuities of time: the times at which every step must end.

use super::arguments::{Arguments, Course};
use super::certify::{Certifier, Sample, ZeroKind};
use super::modes;
use super::sample::Sampler;
use super::sides::SAME;
use super::signals::{Break, breaks};
use crate::cause::{Cause, TooFast};
use crate::mechanism::{Description, System, Watched};

/// A time at which the arguments of some switches vanish or change their signs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stop {
    /// s.
    pub t: f64,
    /// When the motion goes on, s: somewhat later where an input turns that is on either side what it is at that time, as tables
    /// are.
    pub after: f64,
    /// Which, and on which side each is from then on.
    pub switches: Vec<(usize, f64)>,
    /// Inputs that are closures and jump or turn just after it.
    pub breaks: Vec<(usize, Break)>,
}

/// The stop times of a run, found a stretch of time at a time.
#[derive(Clone, Debug)]
pub(crate) struct Stops {
    /// Those that are still to come within the stretch, the next one last.
    pub list: Vec<Stop>,
    /// Until when they are known, s.
    pub horizon: f64,
    until: f64,
    /// The length of stretches, s.
    stretch: f64,
    /// Whether every second one comes a rounding early: two runs that differ so tell what the rounding of their times changes.
    early: bool,
}

/// More stop times than this are not found at once.
const MOST_STOPS: usize = 200_000;
/// Stretches are not shortened further.
const SHORTEST: f64 = 1e-6;
/// So far beyond their end, in parts of them, zeros are looked for: one at the end is none that may be missed.
const BEYOND: f64 = 1e-9;
/// On either side of the points of a table, in parts of their time, its argument is on that side too.
const ASIDE: f64 = 8.0 * f64::EPSILON;
/// A zero is corrected no more often.
const CORRECTIONS: u32 = 4;
/// Inputs of which u or u' differ by this part of themselves beside a time turn there.
const TURNS: f64 = 1e-11;

impl Stops {
    /// The stop times after `from`, `until` among them: what happens where a run ends belongs to it, and not to the one
    /// that begins there. Of a run that is compared every second one comes a rounding `early`.
    ///
    /// # Errors
    /// [`Cause::OscillatesTooFast`] names a switch with more zeros than can be listed.
    pub fn new<S: System + ?Sized>(
        system: &mut S,
        samplers: (&mut Sampler, &mut Arguments),
        (from, until): (f64, f64),
        y: &[f64],
        early: bool,
    ) -> Result<Self, Box<Cause>> {
        let early = early && !inputs_move(system.description());
        let mut stops = Stops { list: Vec::new(), horizon: from, until, stretch: until - from, early };
        stops.extend(system, samplers, y)?;
        Ok(stops)
    }

    /// Takes the next stop off the list if it has come.
    pub fn pop(&mut self, t: f64) -> Option<Stop> {
        if self.is_due(t) { self.list.pop() } else { None }
    }

    /// Passes by what has come at t, where it needs nothing but to be over: when it is.
    pub fn pass(&mut self, t: f64) -> f64 {
        let mut resume = t;
        while let Some(stop) = self.pop(t) {
            resume = resume.max(stop.after);
        }
        resume
    }

    /// Whether the next stop has come.
    pub fn is_due(&self, t: f64) -> bool {
        self.list.last().is_some_and(|stop| stop.t <= t + SAME * t.abs())
    }

    /// The next time at which a step must end.
    pub fn next(&self) -> f64 {
        self.list.last().map_or(self.horizon, |stop| stop.t)
    }

    /// Finds those of the next stretch once all are past; leaves the modes as they are.
    pub fn extend<S: System + ?Sized>(
        &mut self,
        system: &mut S,
        (sampler, arguments): (&mut Sampler, &mut Arguments),
        y: &[f64],
    ) -> Result<(), Box<Cause>> {
        let whole = self.until - self.horizon;
        let before = system.modes().to_vec();
        let outcome = loop {
            let end = if self.stretch >= whole { self.until } else { self.horizon + self.stretch };
            match stop_times(system, (&mut *sampler, &mut *arguments), (self.horizon, end), y) {
                Ok(list) => break Ok((list, end)),
                Err(_) if self.stretch > SHORTEST * whole => self.stretch = 0.25 * self.stretch.min(whole),
                Err(switch) => {
                    break Err(Cause::OscillatesTooFast {
                        function: modes::text(system, switch),
                        limit: TooFast::InTime,
                    });
                }
            }
        };
        system.set_modes(&before);
        let (mut list, end) = outcome?;
        if self.early {
            // All of them would only be shifted.
            list.iter_mut().step_by(2).for_each(|stop| come_early(stop, (self.horizon, self.until)));
        }
        for input in 0..system.description().inputs.len() {
            let Some(signal) = system.signal(input) else { continue };
            let found = breaks(signal, (self.horizon, end)).map_err(|wrong| {
                let input = system.description().inputs[input].to_string();
                Box::new(Cause::WrongRate { input, t: wrong.t, rate: wrong.rate, slope: wrong.slope })
            })?;
            for one in found.into_iter().filter(|one| one.after < self.until) {
                list.push(Stop { t: one.before, after: one.after, switches: Vec::new(), breaks: vec![(input, one)] });
            }
        }
        list.sort_by(|a, b| a.t.total_cmp(&b.t));
        self.list = list;
        self.list.reverse();
        self.horizon = end;
        Ok(())
    }
}

/// Whether inputs may move something, by constraints or by their rates: what turns sharply then kicks at its own instant, and not beside it.
fn inputs_move(description: &Description) -> bool {
    let by_rates = description.input_pattern.iter().any(|(_, column)| column % 3 != 0);
    by_rates || !description.inputs.is_empty() && !description.rows.is_empty()
}

/// Lets a stop between the ends of a run come a rounding early: never late, for what is reported at its instant comes after it.
fn come_early(stop: &mut Stop, (from, until): (f64, f64)) {
    let early = stop.t - f64::EPSILON * stop.t.abs();
    if early > from && stop.t < until && stop.after == stop.t {
        (stop.t, stop.after) = (early, early);
    }
}

/// The stop times in a stretch of time, in order; `Err` names a switch that has too many.
///
/// An argument contains modes of earlier switches only, so switches are taken in their order; between two flips of the
/// earlier ones the argument is smooth, and certified along time.
fn stop_times<S: System + ?Sized>(
    system: &mut S,
    (sampler, arguments): (&mut Sampler, &mut Arguments),
    (from, end): (f64, f64),
    y: &[f64],
) -> Result<Vec<Stop>, usize> {
    let until = end + BEYOND * (end - from);
    let count = system.description().switches.len();
    let mut stops: Vec<Stop> = Vec::new();
    // The modes between two stops; one more than there are stops.
    let mut modes: Vec<Vec<f64>> = vec![system.modes().to_vec()];
    let timed: Vec<usize> = (0..count).filter(|k| system.description().switches[*k].time_only).collect();
    for switch in timed {
        let mut flips: Vec<f64> = Vec::new();
        let mut side = 0.0;
        for interval in 0..modes.len() {
            let low = if interval == 0 { from } else { stops[interval - 1].t };
            let high = stops.get(interval).map_or(until, |stop| stop.t);
            system.set_modes(&modes[interval]);
            let found = zeros(system, (&mut *sampler, &mut *arguments), switch, (low, high), y);
            let found =
                found.or_else(|| zeros(system, (&mut *sampler, &mut *arguments), switch, (low, high.min(end)), y));
            let found = found.ok_or(switch)?;
            if interval > 0 && side != found.first {
                flips.push(low);
            }
            flips.extend(found.times);
            side = found.last;
            if (flips.len() + modes.len()).saturating_mul(count) > MOST_STOPS * 50 || flips.len() > MOST_STOPS {
                return Err(switch);
            }
        }
        for t in flips.into_iter().filter(|t| *t > from + SAME * from.abs() && *t < until) {
            let near = SAME * t.abs();
            let place = stops.partition_point(|stop| stop.t < t - near);
            match stops.get_mut(place) {
                Some(stop) if stop.t <= t + near => stop.switches.push((switch, 0.0)),
                _ => {
                    stops.insert(place, Stop { t, after: t, switches: vec![(switch, 0.0)], breaks: Vec::new() });
                    modes.insert(place, modes[place].clone());
                }
            }
        }
        // This switch's mode between the stops, for those that contain it.
        for interval in 0..modes.len() {
            let low = if interval == 0 { from } else { stops[interval - 1].t };
            let high = stops.get(interval).map_or(until, |stop| stop.t);
            system.set_modes(&modes[interval]);
            let value = between(system, sampler, switch, (low, high), y);
            modes[interval][switch] = modes::mode(system, switch, value);
        }
    }
    for (stop, after) in stops.iter_mut().zip(&modes[1..]) {
        for (switch, side) in &mut stop.switches {
            *side = modes::side_of(system, *switch, after[*switch]);
        }
    }
    let within = stops.partition_point(|stop| stop.t <= end + SAME * end.abs());
    stops.truncate(within);
    for (stop, before) in stops.iter_mut().zip(&modes) {
        stop.t = stop.t.min(end);
        system.set_modes(before);
        let aside = (ASIDE * stop.t.abs()).max(f64::MIN_POSITIVE);
        let (early, late) = (stop.t - aside, stop.t + aside);
        if early > from && turns(system, (early, late)) {
            (stop.t, stop.after) = (early, late.min(end));
        } else {
            stop.after = stop.t;
        }
    }
    Ok(stops)
}

/// Parts of a stretch in which an argument of time alone keeps its sign: it may touch zero at one of them, where it is rounding.
const PLACES: [f64; 3] = [0.5, 0.381_966, 0.145_898];

/// The largest value of the argument of a switch at some places between two times.
pub(super) fn between<S: System + ?Sized>(
    system: &S,
    sampler: &mut Sampler,
    switch: usize,
    (low, high): (f64, f64),
    y: &[f64],
) -> f64 {
    let values = PLACES.map(|part| {
        sampler.at_time(system, low + part * (high - low), y);
        sampler.value(sampler.function_of(switch))
    });
    // Where it is no number in the middle it has no sign.
    values.into_iter().reduce(|most, value| if value.abs() > most.abs() { value } else { most }).unwrap_or(f64::NAN)
}

/// Whether an input jumps or turns between two neighbouring times although no mode changes.
fn turns<S: System + ?Sized>(system: &S, times: (f64, f64)) -> bool {
    let count = 3 * system.description().inputs.len();
    let [before, after] = [times.0, times.1].map(|t| {
        let mut values = vec![0.0; count];
        system.inputs(t, &mut values);
        values
    });
    let differs = |k: usize| {
        let grown = 2.0 * (times.1 - times.0) * before[k + 1].abs().max(after[k + 1].abs());
        (after[k] - before[k]).abs() > TURNS * before[k].abs().max(after[k].abs()) + grown
    };
    (0..count).any(|k| k % 3 < 2 && differs(k))
}

/// Where the argument of a switch changes its sign between two times.
struct Zeros {
    times: Vec<f64>,
    /// The sign just after the first time, and just before the last.
    first: f64,
    last: f64,
}

fn zeros<S: System + ?Sized>(
    system: &S,
    (sampler, arguments): (&mut Sampler, &mut Arguments),
    switch: usize,
    (low, high): (f64, f64),
    y: &[f64],
) -> Option<Zeros> {
    let span = high - low;
    let course = Course::Time { t: low, h: span };
    let places = arguments.places(system, &course, Watched::Switch(switch as u32))?;
    let mut sample = |x: f64| {
        sampler.at_time(system, if x == 1.0 { high } else { low + x * span }, y);
        (sampler.value(sampler.function_of(switch)), span * sampler.rate(switch))
    };
    let grid: Vec<Sample> = places
        .into_iter()
        .map(|x| {
            let (value, slope) = sample(x);
            Sample { x, value, slope }
        })
        .collect();
    // A straight line needs no search.
    if let [a, b] = grid[..]
        && a.slope == b.slope
        && (b.value - a.value - a.slope).abs() <= 1e-12 * a.slope.abs()
        && (sample(0.5).0 - a.value - 0.5 * a.slope).abs() <= 1e-12 * a.slope.abs()
    {
        let x = -a.value / a.slope;
        let times = if x > 0.0 && x < 1.0 { vec![low + x * span] } else { Vec::new() };
        let sign = |value: f64, slope: f64| {
            let tells = if value == 0.0 { slope } else { value };
            if tells == 0.0 { 0.0 } else { tells.signum() }
        };
        return Some(Zeros { times, first: sign(a.value, a.slope), last: sign(b.value, -b.slope) });
    }
    let mut certifier = Certifier::default();
    certifier.patient = true;
    certifier.certify(&mut sample, &grid).ok()?;
    let ends = |mut points: Box<dyn Iterator<Item = &Sample> + '_>| {
        points.find(|p| p.value != 0.0 && p.value.is_finite()).map_or(0.0, |p| p.value.signum())
    };
    let (first, last) = (ends(Box::new(certifier.points().iter())), ends(Box::new(certifier.points().iter().rev())));
    let changes = certifier.marks.iter().filter(|mark| !matches!(mark.kind, ZeroKind::Touches));
    let mut at = |t: f64| {
        sampler.at_time(system, t, y);
        (sampler.value(sampler.function_of(switch)), sampler.rate(switch))
    };
    let times = changes.map(|mark| match mark.kind {
        ZeroKind::Crosses { .. } => exactly(&mut at, low + mark.x * span, span),
        _ => low + mark.x * span,
    });
    Some(Zeros { times: times.collect(), first, last })
}

/// The time of a zero that is known to the rounding of so long a stretch, to its own rounding by Newton's method.
fn exactly(at: &mut impl FnMut(f64) -> (f64, f64), t: f64, span: f64) -> f64 {
    let mut best = (t, at(t));
    for _ in 0..CORRECTIONS {
        let (t, (value, rate)) = best;
        let next = t - value / rate;
        let moved = (next - t).abs();
        // What is a zero of higher order, or another one, is left.
        if moved == 0.0 || moved > ASIDE * span || moved.is_nan() {
            break;
        }
        let there = at(next);
        if there.0.abs() >= value.abs() {
            break;
        }
        best = (next, there);
    }
    best.0
}
