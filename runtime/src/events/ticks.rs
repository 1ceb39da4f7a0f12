//! Ticks of clocks: events that happen again and again at known times.
//!
//! Tick k of a clock is at `from` + k `every`.  Where the file gives plain numbers that is a fraction, rounded once, and two ticks are one
//! instant where their fractions are equal; so 200 Hz and 60 Hz meet 20 times a second and never nearly.  No tick is listed: of each clock
//! only the number of the next one is known.

use super::sides::SAME;
use crate::mechanism::{Clock, System, Trigger};

/// The clocks of a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ticks {
    clocks: Vec<Ticking>,
    /// The clock of each event; `None` for events that do not tick.
    of_events: Vec<Option<usize>>,
}

/// A clock under way.
#[derive(Clone, Copy, Debug)]
struct Ticking {
    when: When,
    /// The number of the next tick.
    next: u64,
}

/// When ticks are.
#[derive(Clone, Copy, Debug, PartialEq)]
enum When {
    /// Tick k at (from + k every)/per seconds; `per` is the same for all clocks.
    Exact { from: i128, every: i128, per: i128 },
    /// At from + k every, with one rounding.
    Rounded { from: f64, every: f64 },
}

/// Numerators of ticks up to this size leave room for every number of a tick.
const MOST: i128 = 1 << 60;

impl When {
    /// The time of a tick, s.
    fn at(&self, k: u64) -> f64 {
        match self {
            When::Exact { from, every, per } => quotient(from + i128::from(k) * every, *per),
            When::Rounded { from, every } => every.mul_add(k as f64, *from),
        }
    }
}

impl Ticks {
    /// The clocks of a mechanism, which begin at t: with these numbers of their next ticks, or with the first tick that is not before t.
    pub fn new<S: System + ?Sized>(system: &S, t: f64, next: Option<&[u64]>) -> Self {
        let sampling = system.sampling();
        let per = common(&sampling.clocks);
        let when = |(clock, [from, every]): (&Clock, [f64; 2])| {
            let exact = clock.exact.zip(per).and_then(|(exact, per)| {
                let [from, every] = exact.map(|(numerator, of)| numerator.checked_mul(per / of));
                let fits = |x: &i128| x.abs() <= MOST;
                Some(When::Exact { from: from.filter(fits)?, every: every.filter(fits)?, per })
            });
            exact.unwrap_or(When::Rounded { from, every })
        };
        let whens = sampling.clocks.iter().zip(system.clocks()).map(when);
        let clocks = whens.enumerate().map(|(k, when)| {
            let known = next.and_then(|next| next.get(k)).copied();
            Ticking { when, next: known.unwrap_or_else(|| first(&when, t)) }
        });
        let clock = |trigger: &Trigger| if let Trigger::Tick(clock) = trigger { Some(*clock as usize) } else { None };
        Ticks { clocks: clocks.collect(), of_events: sampling.triggers.iter().map(clock).collect() }
    }

    /// Goes on at t with the present periods: of a clock that is another one ticks that are not before t are to come, but none twice at t.
    pub fn follow<S: System + ?Sized>(&mut self, system: &S, t: f64) {
        let anew = Ticks::new(system, t, None);
        let clocks = self.clocks.iter_mut().zip(anew.clocks);
        for (clock, anew) in clocks.filter(|(clock, anew)| clock.when != anew.when) {
            let has_ticked = clock.next > 0 && same(clock.when.at(clock.next - 1), t);
            let again = has_ticked && anew.is_due(t);
            *clock = Ticking { next: anew.next + u64::from(again), ..anew };
        }
    }

    /// The numbers of the first ticks after those that have come at t.
    pub fn next_after(mut self, t: f64) -> Vec<u64> {
        while self.is_due(t) {
            self.take(t);
        }
        self.next()
    }

    /// The numbers of the next ticks.
    pub fn next(&self) -> Vec<u64> {
        self.clocks.iter().map(|clock| clock.next).collect()
    }

    /// Where a step must end, at a tick or at `stop`: at the latter where both are one instant.
    pub fn stop(&self, stop: f64) -> f64 {
        let next = self.clocks.iter().map(|clock| clock.when.at(clock.next)).fold(f64::INFINITY, f64::min);
        if same(next, stop) { stop } else { next.min(stop) }
    }

    /// The first tick after t; infinite without clocks.
    pub fn after(&self, t: f64) -> f64 {
        let next = |clock: &Ticking| clock.when.at(clock.next.saturating_add(u64::from(clock.is_due(t))));
        self.clocks.iter().map(next).fold(f64::INFINITY, f64::min)
    }

    /// Whether a tick has come.
    pub fn is_due(&self, t: f64) -> bool {
        self.clocks.iter().any(|clock| clock.is_due(t))
    }

    /// The events, in file order, of the earliest ticks that have come, which are one instant; their clocks go on.
    pub fn take(&mut self, t: f64) -> Vec<usize> {
        let due = self.clocks.iter().filter(|clock| clock.is_due(t)).copied();
        let Some(earliest) = due.reduce(|a, b| if b.time() < a.time() { b } else { a }) else { return Vec::new() };
        let now: Vec<bool> = self.clocks.iter().map(|clock| clock.is_with(&earliest)).collect();
        self.clocks
            .iter_mut()
            .zip(&now)
            .filter(|(_, now)| **now)
            .for_each(|(clock, _)| clock.next = clock.next.saturating_add(1));
        let happens = |event: &usize| self.of_events[*event].is_some_and(|clock| now[clock]);
        (0..self.of_events.len()).filter(happens).collect()
    }
}

impl Ticking {
    fn time(&self) -> f64 {
        self.when.at(self.next)
    }

    fn is_due(&self, t: f64) -> bool {
        self.time() <= t + SAME * t.abs()
    }

    /// Whether the next tick is at the same instant as that of another clock.
    fn is_with(&self, other: &Ticking) -> bool {
        match (self.when, other.when) {
            (When::Exact { from, every, .. }, When::Exact { from: of, every: by, .. }) => {
                from + i128::from(self.next) * every == of + i128::from(other.next) * by
            }
            _ => same(self.time(), other.time()),
        }
    }
}

/// Whether times are one instant; one that is infinite is no other one.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().min(b.abs())
}

/// The number of the first tick that is not before t.
fn first(when: &When, t: f64) -> u64 {
    let (from, every) = (when.at(0), when.at(1) - when.at(0));
    let before = |k: u64| when.at(k) < t && !same(when.at(k), t);
    // The quotient may be rounded across a whole number.
    let mut k = ((t - from) / every - 1.0).floor().max(0.0) as u64;
    while before(k) {
        k += 1;
    }
    k
}

/// The least common denominator of all clocks that are fractions; `None` where it is too large.
fn common(clocks: &[Clock]) -> Option<i128> {
    let denominators = clocks.iter().filter_map(|clock| clock.exact).flat_map(|exact| exact.map(|(_, of)| of));
    denominators.into_iter().try_fold(1_i128, |least, of| {
        let (mut a, mut b) = (least, of);
        while b != 0 {
            (a, b) = (b, a % b);
        }
        (least / a).checked_mul(of).filter(|least| *least <= MOST)
    })
}

/// The float nearest to a quotient, even where both numbers are larger than floats hold exactly.
fn quotient(numerator: i128, denominator: i128) -> f64 {
    const EXACT: u128 = 1 << f64::MANTISSA_DIGITS;
    let (mut n, mut d) = (numerator.unsigned_abs(), denominator.unsigned_abs());
    let sign = if (numerator < 0) == (denominator < 0) { 1.0 } else { -1.0 };
    if n < EXACT && d < EXACT {
        return sign * (n as f64 / d as f64);
    }
    // So that the whole part of n 2^shift/d has some bits more than a float: all below it only tells whether it is a tie.
    let bits = |x: u128| i32::try_from(u128::BITS - x.leading_zeros()).unwrap_or(0);
    let shift = f64::MANTISSA_DIGITS as i32 + 3 - (bits(n) - bits(d));
    match shift {
        0.. => {
            let room = n.leading_zeros().min(shift.unsigned_abs());
            n <<= room;
            // What has no room divides the denominator, whose last bits are beyond all that counts.
            d >>= shift.unsigned_abs() - room;
        }
        _ => n >>= shift.unsigned_abs(),
    }
    let (whole, rest) = (n / d.max(1), n % d.max(1));
    let whole = whole | u128::from(rest != 0);
    sign * whole as f64 * f64::from(-shift).exp2()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(from: i128, every: i128, per: i128) -> When {
        When::Exact { from, every, per }
    }

    #[test]
    fn times_are_rounded_once() {
        // 0.1 + 0.1 + 0.1 is not 0.3.
        let tenth = exact(0, 1, 10);
        assert_eq!([tenth.at(3), tenth.at(7), tenth.at(1_000_000)], [0.3, 0.7, 100_000.0]);
        assert_eq!(exact(0, 5, 1000).at(1_000_000), 5000.0);
        assert_eq!(exact(-1, 3, 7).at(2), 5.0 / 7.0);
        // 2^53 + 1 is halfway between two floats, a tie; one 10^18th more is not.
        let large = (1_i128 << 53) + 1;
        assert_eq!(quotient(large, 1), 9_007_199_254_740_992.0);
        assert_eq!(quotient(large * 1000 + 1, 1000), 9_007_199_254_740_994.0);
        assert_eq!(quotient(-large * 1000 - 1, 1000), -9_007_199_254_740_994.0);
    }

    #[test]
    fn the_first_tick_is_not_before_the_start() {
        let tenth = exact(0, 1, 10);
        assert_eq!([0.0, 0.05, 0.1, 0.3, 0.1 + 0.2, 0.35].map(|t| first(&tenth, t)), [0, 1, 1, 3, 3, 4]);
        assert_eq!(first(&exact(20, 1, 10), 0.0), 0);
        assert_eq!(first(&When::Rounded { from: -1.0, every: 0.3 }, 0.0), 4);
    }

    #[test]
    fn clocks_meet_where_their_fractions_do() {
        let clock = |every: i128| Ticking { when: exact(0, every, 600), next: 0 };
        let mut ticks = Ticks { clocks: vec![clock(3), clock(10)], of_events: vec![Some(0), None, Some(1)] };
        let (mut together, mut t, mut count, mut shortest) = (0, 0.0, 0, f64::INFINITY);
        while t <= 1.0 {
            let fired = ticks.take(t);
            together += usize::from(fired == [0, 2]);
            count += fired.len();
            assert!(!fired.is_empty() && !fired.contains(&1));
            let next = ticks.stop(f64::INFINITY);
            shortest = f64::min(shortest, next - t);
            t = next;
        }
        assert_eq!((together, count), (21, 201 + 61));
        assert!(shortest > 1.6e-3, "{shortest}");
    }
}
