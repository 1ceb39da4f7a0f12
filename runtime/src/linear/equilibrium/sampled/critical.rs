//! Periods at which a sampled loop begins to be unstable.

use super::cycle::Cycle;
use super::rest::Search;
use super::{Law, at_rest, eigenvalues};
use crate::linear::equilibrium::Guess;
use crate::mechanism::{System, is_of_noise};

/// Periods are looked at from this part of the present ones on, at which a loop is as good as continuous.
const SHORTEST_PERIOD: f64 = 1e-3;
/// Up to so many times the present ones: nobody samples a loop so much less often than it was made for.
const LONGEST_PERIOD: f64 = 1e4;
/// Each is so many times the one before: an eigenvalue seldom passes |z| = 1 and comes back between two of them.
const NEXT_PERIOD: f64 = 1.01;
/// Eigenvalues this near to 1 are those of what stays where it is, whatever the period.
const NEUTRAL: f64 = 1e-9;
/// Periods are looked for where no more ticks than this are in a cycle: each costs an exponential.
const MOST_SEARCHED: usize = 100;
/// Parameters are doubled to see which periods they double or halve: both are exact.
const DOUBLED: f64 = 2.0;

/// Factors of all periods at which stability changes, and what is multiplied with them.
#[derive(Default)]
pub(super) struct Critical {
    /// From which on longer periods are unstable.
    pub longer: Option<f64>,
    /// From which down shorter periods are unstable.
    pub shorter: Option<f64>,
    pub varied: Vec<String>,
}

/// A parameter of which periods are made, and whether they are multiples of it, or of its reciprocal.
struct Follower {
    place: usize,
    is_period: bool,
}

/// A loop whose periods are varied.
pub(super) struct Varying<'a> {
    system: Box<dyn System>,
    cycle: &'a Cycle,
    guess: Guess,
    memory: Vec<f64>,
    followers: Vec<Follower>,
}

impl<'a> Varying<'a> {
    /// Of a loop about its rest.
    pub fn of<S: System + ?Sized>(system: &S, (rest, guess): (&Search, &Guess), cycle: &'a Cycle) -> Varying<'a> {
        let system = system.boxed_clone();
        let followers = followers(&*system).unwrap_or_default();
        let guess = Guess { q: rest.place.q.clone(), ..guess.clone() };
        Varying { system, cycle, guess, memory: rest.memory.clone(), followers }
    }

    /// The factors nearest to 1 at which stability changes, of a loop with this law.
    pub fn critical(&self, law: &Law) -> Critical {
        let known = &self.system.description().parameters;
        let varied = self.followers.iter().map(|follower| known[follower.place].name.to_string()).collect();
        if self.cycle.instants.len() > MOST_SEARCHED {
            return Critical { varied, ..Critical::default() };
        }
        let growth = |factor: f64| match self.followers.is_empty() || factor == 1.0 {
            true => self.growth(law, factor),
            false => self.growth(&self.law(factor)?, factor),
        };
        let above = first_change(growth, NEXT_PERIOD, LONGEST_PERIOD);
        let below = first_change(growth, NEXT_PERIOD.recip(), SHORTEST_PERIOD);
        match growth(1.0).is_some_and(|growth| growth < 0.0) {
            true => Critical { longer: above, shorter: below, varied },
            false => Critical { longer: below, shorter: above, varied },
        }
    }

    /// The largest |z| of what moves, less 1.
    fn growth(&self, law: &Law, factor: f64) -> Option<f64> {
        let (found, _) = eigenvalues(&law.map(self.cycle, factor))?;
        let moving = found.iter().filter(|z| (*z - 1.0).norm() > NEUTRAL);
        Some(moving.map(|z| z.norm()).fold(0.0, f64::max) - 1.0)
    }

    /// The law where what periods are made of is multiplied, about the rest that it has then.
    fn law(&self, factor: f64) -> Option<Law> {
        let mut system = self.system.boxed_clone();
        multiply(&mut *system, &self.followers, factor);
        at_rest(&*system, &self.guess, &self.memory).ok()?.law(self.cycle).ok()
    }
}

/// Multiplies parameters that are periods, and divides those that are frequencies.
fn multiply(system: &mut dyn System, followers: &[Follower], factor: f64) {
    let values = system.parameters();
    for Follower { place, is_period } in followers {
        system.set_parameter(*place, values[*place] * if *is_period { factor } else { factor.recip() });
    }
}

/// The periods of all clocks that do not tick for noise alone.
pub fn periods(system: &dyn System) -> Vec<f64> {
    let clocks = system.clocks().into_iter().enumerate().filter(|(clock, _)| !is_of_noise(system, *clock));
    clocks.map(|(_, [_, every])| every).collect()
}

/// Parameters with which all periods are multiplied alike: for each clock one that multiplies its period, of those that do a time or a
/// frequency before a number.  `None` where a period is made of none.
fn followers(system: &dyn System) -> Option<Vec<Follower>> {
    let now = periods(system);
    let units: Vec<String> = system.description().parameters.iter().map(|known| known.unit.to_string()).collect();
    let mut order: Vec<usize> = (0..system.parameters().len()).collect();
    order.sort_by_key(|place| !["s", "Hz", "1/s"].contains(&units.get(*place).map_or("", String::as_str)));
    let doubled = |place: usize| {
        let mut moved = system.boxed_clone();
        multiply(&mut *moved, &[Follower { place, is_period: true }], DOUBLED);
        periods(&*moved)
    };
    let effects: Vec<(usize, Vec<f64>)> = order.into_iter().map(|place| (place, doubled(place))).collect();
    let mut chosen: Vec<Follower> = Vec::new();
    for clock in 0..now.len() {
        let is_period = |after: &[f64]| match after[clock] / now[clock] {
            ratio if ratio == DOUBLED => Some(true),
            ratio if ratio == DOUBLED.recip() => Some(false),
            _ => None,
        };
        let (place, is_period) = effects.iter().find_map(|(place, after)| Some((*place, is_period(after)?)))?;
        if chosen.iter().all(|known| known.place != place) {
            chosen.push(Follower { place, is_period });
        }
    }
    let mut moved = system.boxed_clone();
    multiply(&mut *moved, &chosen, DOUBLED);
    let all = periods(&*moved).iter().zip(&now).all(|(after, before)| *after == DOUBLED * before);
    all.then_some(chosen)
}

/// The first factor from 1 on, by steps of a factor as far as a last one, at which the sign of a growth changes, to rounding.
fn first_change(growth: impl Fn(f64) -> Option<f64>, step: f64, last: f64) -> Option<f64> {
    let is_stable = |factor: f64| growth(factor).map(|growth| growth < 0.0);
    let first = is_stable(1.0)?;
    let mut here = 1.0;
    while (here < last) == (step > 1.0) {
        let mut there = step * here;
        if is_stable(there)? == first {
            here = there;
            continue;
        }
        loop {
            let middle = 0.5 * (here + there);
            if middle == here || middle == there {
                return Some(there);
            }
            if is_stable(middle)? == first { here = middle } else { there = middle }
        }
    }
    None
}
