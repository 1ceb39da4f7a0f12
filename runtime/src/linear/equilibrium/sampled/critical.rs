//! Periods at which a sampled loop begins to be unstable.

use super::crossing::{Walk, grows};
use super::cycle::Cycle;
use super::rest::Search;
use super::{Flow, at_rest};
use crate::linear::equilibrium::Guess;
use crate::mechanism::{System, is_of_noise};

/// Periods are looked at from this part of the present ones on, at which a loop is as good as continuous.
pub(super) const SHORTEST_PERIOD: f64 = 1e-3;
/// Up to so many times the present ones: nobody samples a loop so much less often than it was made for.
pub(super) const LONGEST_PERIOD: f64 = 1e4;
/// So many steps between periods are halved each way for a map of one variable, and fewer for more of them: together they cost a second.
const HALVINGS: usize = 20_000;
/// The square of how many variables make a map cost twice as much.
const DOUBLE_COST: usize = 20;
/// Periods are looked for where no more ticks than this are in a cycle: each costs an exponential.
const MOST_SEARCHED: usize = 100;
/// Parameters are doubled to see which periods they double or halve: both are exact.
const DOUBLED: f64 = 2.0;

/// Factors of all periods at which stability changes, and what is multiplied with them.
pub(super) struct Critical {
    /// From which on longer periods are unstable.
    pub longer: Option<f64>,
    /// From which down shorter periods are unstable.
    pub shorter: Option<f64>,
    /// Between which factors these were looked for.
    pub looked: [f64; 2],
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

    /// The factors nearest to 1 at which stability changes, of a loop with this flow.
    pub fn critical(&self, flow: &Flow) -> Critical {
        let known = &self.system.description().parameters;
        let varied = self.followers.iter().map(|follower| known[follower.place].name.to_string()).collect();
        let n = flow.field.nrows();
        let here = flow.without_alone();
        let spectrum = |factor: f64| match self.followers.is_empty() || factor == 1.0 {
            true => here.as_ref()?.0.spectrum(self.cycle, factor),
            false => self.flow(factor)?.without_alone()?.0.spectrum(self.cycle, factor),
        };
        let halvings = HALVINGS / (1 + n * n / DOUBLE_COST);
        let walk = |last: f64| Walk::of(&spectrum, halvings).to(last);
        let now = if self.cycle.instants.len() > MOST_SEARCHED { None } else { spectrum(1.0) };
        let Some(now) = now else { return Critical { longer: None, shorter: None, looked: [1.0, 1.0], varied } };
        let [above, below] = [walk(LONGEST_PERIOD), walk(SHORTEST_PERIOD)];
        let looked = [below.reached, above.reached];
        match grows(&now) {
            false => Critical { longer: above.changed, shorter: below.changed, looked, varied },
            true => Critical { longer: below.changed, shorter: above.changed, looked, varied },
        }
    }

    /// The flow where what periods are made of is multiplied, about the rest that it has then.
    fn flow(&self, factor: f64) -> Option<Flow> {
        let mut system = self.system.boxed_clone();
        multiply(&mut *system, &self.followers, factor);
        at_rest(&*system, &self.guess, &self.memory).ok()?.law(self.cycle).ok().map(|law| law.flow)
    }
}

/// Multiplies parameters that are periods, and divides those that are frequencies.
fn multiply(system: &mut dyn System, followers: &[Follower], factor: f64) {
    let values = system.parameters();
    for Follower { place, is_period } in followers {
        system.set_parameter(*place, values[*place] * if *is_period { factor } else { factor.recip() });
    }
}

/// The clocks that do not tick for noise alone, by their places, with their periods.
pub fn ticking(system: &dyn System) -> Vec<(usize, f64)> {
    let clocks = system.clocks().into_iter().enumerate().filter(|(clock, _)| !is_of_noise(system, *clock));
    clocks.map(|(clock, [_, every])| (clock, every)).collect()
}

/// The periods of all clocks that do not tick for noise alone.
pub fn periods(system: &dyn System) -> Vec<f64> {
    ticking(system).into_iter().map(|(_, every)| every).collect()
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
