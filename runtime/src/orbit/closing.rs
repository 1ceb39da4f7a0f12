//! How a motion closes: the state at its end, taken to the start.

use std::f64::consts::TAU;

use crate::mechanism::{Action, At, Closes, ClosesBy, Description, Direction, Event, System};
use crate::numbers::short;

/// A map from the state at the end of a part of a motion to the state at its start, and when that part ends.
///
/// The image of (q, q') has qᵢ = ±qₖ with k and the sign as `images` tells, less a turn, and rates alike.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Closing {
    pub by: By,
    /// For each coordinate the one whose value at the end it has at the start, and whether with the opposite sign.
    pub images: Vec<(usize, bool)>,
    /// For each phase the one that it becomes.
    pub phases: Vec<usize>,
    /// Coordinates that may be any amount more at the end.
    pub shifts: Vec<usize>,
    /// How much more each coordinate is at the end.
    pub turns: Vec<f64>,
    /// Where the start is its own image with time reversed: for each coordinate the one that it equals there, and whether with the opposite sign; empty
    /// where the start is not said to be one.
    pub reversed: Vec<(usize, bool)>,
}

/// When a part of a motion ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum By {
    /// After this part of the period.
    Part(usize),
    /// When this event has happened so many times.
    After { event: usize, count: usize },
}

impl Default for By {
    fn default() -> By {
        By::Part(1)
    }
}

/// A state is compared with its image at so many places.
const PLACES: usize = 6;
/// Accelerations that differ by this part of the largest of the same unit are not those of one mechanism.
const DIFFERS: f64 = 1e-8;

impl Closing {
    /// Everything is as it was after a period.
    pub fn period(description: &Description) -> Closing {
        let n = description.coordinates.len();
        Closing {
            by: By::Part(1),
            images: (0..n).map(|i| (i, false)).collect(),
            phases: (0..description.phases.len().max(1)).collect(),
            shifts: Vec::new(),
            turns: vec![0.0; n],
            reversed: Vec::new(),
        }
    }

    /// As a model file says it: at the end each coordinate has the value, or the opposite, that its image had at the start.  Between two states
    /// that reverse time the motion goes to and fro: after twice the way the images of both have been applied.
    pub fn of(closes: &Closes, description: &Description) -> Closing {
        let mut closing = Closing::period(description);
        let (ends, by) = match (&closes.between, closes.by) {
            (Some([from, to]), ClosesBy::Part(part)) => {
                let both = to.iter().map(|(k, opposite)| {
                    let (before, again) = from[*k as usize];
                    (before, *opposite != again)
                });
                (both.collect::<Vec<_>>(), By::Part((part as usize / 2).max(1)))
            }
            (_, ClosesBy::Part(part)) => (closes.images.to_vec(), By::Part(part as usize)),
            (_, ClosesBy::Event { event, count }) => {
                (closes.images.to_vec(), By::After { event: event as usize, count: (count as usize).max(1) })
            }
        };
        closing.by = by;
        if let (Some([from, _]), By::Part(_)) = (&closes.between, by) {
            closing.reversed = from.iter().map(|(k, opposite)| (*k as usize, *opposite)).collect();
        }
        for (i, (k, opposite)) in ends.iter().enumerate() {
            closing.images[*k as usize] = (i, *opposite);
        }
        for (begins, ends) in closes.phases.iter().enumerate() {
            closing.phases[*ends as usize] = begins;
        }
        closing.shifts = closes.shifts.iter().map(|i| closing.source(*i as usize)).collect();
        closes.turns.iter().for_each(|(i, turns)| closing.turn(*i as usize, f64::from(*turns)));
        closing
    }

    /// The coordinate at the start that a coordinate at the end becomes.
    pub fn source(&self, end: usize) -> usize {
        self.images.iter().position(|(k, _)| *k == end).unwrap_or(end)
    }

    /// Lets a coordinate be so many turns more at the end.
    pub fn turn(&mut self, end: usize, turns: f64) {
        let start = self.source(end);
        let sign = if self.images[start].1 { -1.0 } else { 1.0 };
        self.turns[start] = sign * turns * TAU;
    }

    /// Whether nothing is exchanged or mirrored.
    pub fn is_plain(&self) -> bool {
        self.images.iter().enumerate().all(|(i, image)| *image == (i, false))
            && self.phases.iter().enumerate().all(|(i, phase)| i == *phase)
    }

    /// The linear part, of a change of [q; q'].
    pub fn turned(&self, y: &[f64]) -> Vec<f64> {
        let n = self.images.len();
        let half = |list: &[f64]| -> Vec<f64> {
            self.images.iter().map(|(k, opposite)| if *opposite { -list[*k] } else { list[*k] }).collect()
        };
        [half(&y[..n]), half(&y[n..])].concat()
    }

    /// The image of a state [q; q'].
    pub fn image(&self, y: &[f64]) -> Vec<f64> {
        let mut image = self.turned(y);
        image.iter_mut().zip(&self.turns).for_each(|(x, turn)| *x -= turn);
        image
    }

    /// The smallest number of times after which it takes every state to itself, but for shifts and turns.
    pub fn order(&self) -> usize {
        let n = self.images.len();
        let marks: Vec<f64> = (1..=2 * n).map(|k| k as f64).collect();
        let (mut y, mut phases, mut order) = (self.turned(&marks), self.phases.clone(), 1);
        while y != marks || phases.iter().enumerate().any(|(i, phase)| i != *phase) {
            y = self.turned(&y);
            phases = phases.iter().map(|phase| self.phases[*phase]).collect();
            order += 1;
        }
        order
    }

    /// What coordinates do where this is followed by another such map.
    pub fn followed_by(&self, next: &Closing) -> Closing {
        let both = |(k, opposite): &(usize, bool)| (self.images[*k].0, self.images[*k].1 != *opposite);
        Closing { images: next.images.iter().map(both).collect(), ..self.clone() }
    }

    /// What it does, in the words of the model file.
    pub fn words(&self, description: &Description) -> String {
        let name = |i: usize| description.coordinates[i].name.to_string();
        let phase = |k: usize| description.phases[k].name.to_string();
        let mut parts = Vec::new();
        let coordinates = self.images.iter().enumerate().filter(|(i, (k, _))| i != k);
        let coordinates = coordinates.map(|(i, (k, _))| format!("{} for {}", name(*k), name(i)));
        let phases = self.phases.iter().enumerate().filter(|(k, to)| k != *to);
        let phases = phases.map(|(k, to)| format!("{} for {}", phase(k), phase(*to)));
        let moved: Vec<String> = coordinates.chain(phases).collect();
        if !moved.is_empty() {
            parts.push(format!("exchanged: {}", moved.join(", ")));
        }
        let mirrored: Vec<String> =
            self.images.iter().enumerate().filter(|(_, (_, opposite))| *opposite).map(|(i, _)| name(i)).collect();
        if !mirrored.is_empty() {
            parts.push(format!("mirrored: {}", mirrored.join(", ")));
        }
        let shifted: Vec<String> = self.shifts.iter().map(|i| name(*i)).collect();
        if !shifted.is_empty() {
            parts.push(format!("shifted: {}", shifted.join(", ")));
        }
        let turns = self.turns.iter().enumerate().filter(|(_, turn)| **turn != 0.0);
        let turned: Vec<String> = turns.map(|(i, turn)| format!("{} by {}", name(i), short(turn / TAU))).collect();
        if !turned.is_empty() {
            parts.push(format!("turned: {}", turned.join(", ")));
        }
        parts.join("; ")
    }

    /// Whether the mechanism moves alike from a state and from its image, `later` seconds after: a(t + later, S y) = S a(t, y), looked at
    /// near states of a motion.  What differs where it does not.
    pub fn differs(&self, system: &dyn System, states: &[(f64, Vec<f64>, usize)], later: f64) -> Option<Difference> {
        let n = system.len();
        let mut here = system.boxed_clone();
        let coordinates = &system.description().coordinates;
        // As far as any coordinate with its unit goes: what rests but for rounding would not show what it does to others.
        let spread = |i: usize| {
            let half = if i < n { 0 } else { n };
            let alike = (0..n).filter(|k| coordinates[*k].unit == coordinates[i - half].unit);
            let range = |k: usize| {
                let values = states.iter().map(|(_, y, _)| y[half + k]);
                values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
            };
            let [range, largest] = alike.map(range).fold([0.0_f64, 0.0], |[range, largest], [low, high]| {
                [range.max(high - low), largest.max(high.abs()).max(low.abs())]
            });
            if range > 0.0 { range } else { largest.max(1e-3) }
        };
        let spreads: Vec<f64> = (0..2 * n).map(spread).collect();
        let every = states.len().div_ceil(PLACES).max(1);
        let mut pairs = Vec::new();
        for (place, (t, y, phase)) in states.iter().step_by(every).enumerate() {
            // A little beside the motion, which may have symmetries that the mechanism has not.
            let beside: Vec<f64> =
                (0..2 * n).map(|i| y[i] + 0.05 * spreads[i] * (1.0 + (7 * i + 3 * place) as f64).sin()).collect();
            let image: Vec<f64> = self.inverse(&beside);
            let accelerations = |system: &mut dyn System, t: f64, y: &[f64], phase: usize| -> Option<Vec<f64>> {
                let mut a = vec![0.0; n];
                system.set_phase(phase);
                crate::events::begin_at(system, t, y);
                system.accelerations(At::packed(t, y, n), &mut a).ok().map(|()| a)
            };
            let behind = self.phases.iter().position(|to| to == phase).unwrap_or(*phase);
            let (Some(a), Some(b)) =
                (accelerations(&mut *here, *t, &beside, *phase), accelerations(&mut *here, t + later, &image, behind))
            else {
                continue;
            };
            // The accelerations at the state at the end, taken to the start.
            let back = self.turned(&[b.as_slice(), &vec![0.0; n]].concat());
            pairs.extend(a.into_iter().zip(back).enumerate());
        }
        // Beside the largest of all states: in one of them nothing may accelerate but for rounding.
        let size = pairs.iter().fold(0.0_f64, |most, (_, (a, b))| most.max(a.abs()).max(b.abs()));
        let differs = |(_, (here, there)): &(usize, (f64, f64))| (here - there).abs() > DIFFERS * size;
        let (i, (here, there)) = pairs.into_iter().find(differs)?;
        Some(Difference { coordinate: system.description().coordinates[i].name.to_string(), here, there })
    }

    /// An event that changes the motion and whose image, `later` seconds after, is none of the events that do: time acts in it otherwise then.
    pub fn event_differs(&self, system: &dyn System, states: &[(f64, Vec<f64>, usize)], later: f64) -> Option<usize> {
        let events = &system.description().events;
        let changing: Vec<usize> = (0..events.len()).filter(|k| changes_motion(&events[*k])).collect();
        let mut there = system.boxed_clone();
        let mut places = Vec::new();
        for (t, y, phase) in states.iter().step_by(states.len().div_ceil(PLACES).max(1)) {
            let behind = self.phases.iter().position(|to| to == phase).unwrap_or(*phase);
            let now = watched(&mut *there, *t, y, *phase);
            places.extend(
                now.zip(watched(&mut *there, t + later, &self.inverse(y), behind)).map(|both| (both, [*phase, behind])),
            );
        }
        let largest = |k: usize| places.iter().map(|((now, _), _)| now[k][0].abs()).fold(0.0, f64::max);
        let is_image = |k: usize, other: usize| {
            places.iter().all(|((now, then), phases)| {
                let [active, also] = [(k, phases[0]), (other, phases[1])].map(|(k, phase)| counts(&events[k], phase));
                let near = |a: f64, b: f64, size: f64| (a - b).abs() <= DIFFERS * size.max(b.abs());
                let [a, b] = [now[k], then[other]];
                let same = events[k].direction == events[other].direction && near(a[0], b[0], largest(k));
                let opposite = is_opposite(&events[k], &events[other]) && near(a[0], -b[0], largest(k));
                !active || also && (same || opposite) && near(a[1], b[1], a[1].abs())
            })
        };
        changing.iter().copied().find(|k| !changing.iter().any(|other| is_image(*k, *other)))
    }

    /// Slopes, by [q; q'], of what is 0 where the start is its own image with time reversed: each coordinate less its image, and each rate plus it.
    pub fn reversals(&self) -> Vec<Vec<f64>> {
        let n = self.images.len();
        let slopes = |place: usize, image: usize, sign: f64| {
            let mut slopes = vec![0.0; 2 * n];
            slopes[place] = 1.0;
            slopes[image] -= sign;
            slopes
        };
        let pairs = self.reversed.iter().enumerate().flat_map(|(i, (k, opposite))| {
            let sign = if *opposite { -1.0 } else { 1.0 };
            [slopes(i, *k, sign), slopes(n + i, n + k, -sign)]
        });
        pairs.filter(|slopes| slopes.iter().any(|x| *x != 0.0)).collect()
    }

    /// The state whose image this is.
    pub fn inverse(&self, y: &[f64]) -> Vec<f64> {
        let n = self.images.len();
        let mut before = vec![0.0; 2 * n];
        for (i, (k, opposite)) in self.images.iter().enumerate() {
            let sign = if *opposite { -1.0 } else { 1.0 };
            before[*k] = sign * (y[i] + self.turns[i]);
            before[n + k] = sign * y[n + i];
        }
        before
    }
}

/// Whether an event does more than to be noted and to end the run.
fn changes_motion(event: &Event) -> bool {
    event.actions.iter().any(|action| !matches!(action, Action::Record | Action::Stop))
}

/// Whether an event counts in a phase.
fn counts(event: &Event, phase: usize) -> bool {
    event.phases.as_ref().is_none_or(|list| list.iter().any(|k| *k as usize == phase))
}

/// Whether one event happens where the function of another, of the opposite sign, would let it happen.
fn is_opposite(a: &Event, b: &Event) -> bool {
    let flipped = match b.direction {
        Direction::Rising => Direction::Falling,
        Direction::Falling => Direction::Rising,
        Direction::Both => Direction::Both,
    };
    a.direction == flipped
}

/// The function and the condition of each event in a state; `None` where it has no accelerations.
fn watched(system: &mut dyn System, t: f64, y: &[f64], phase: usize) -> Option<Vec<[f64; 2]>> {
    let n = system.len();
    system.set_phase(phase);
    crate::events::begin_at(system, t, y);
    let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; system.description().rows.len()]);
    let at = At::packed(t, y, n);
    system.accelerations_and_multipliers(at, &mut a, &mut lambda).ok()?;
    let mut pairs = vec![0.0; 2 * system.description().events.len()];
    system.events(at.accelerated(&a).constrained(&lambda), &mut pairs);
    Some(pairs.as_chunks().0.to_vec())
}

/// Where a mechanism does not move alike from a state and from its image.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Difference {
    pub coordinate: String,
    /// Its acceleration, SI.
    pub here: f64,
    /// That of the image, taken back.
    pub there: f64,
}
