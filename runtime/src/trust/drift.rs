//! Drift of what should be conserved.

use crate::mechanism::dense::{SECOND_ROUNDING, sizes_alike};
use crate::mechanism::{At, Description, System};

/// How far a conserved quantity went from its first value.
///
/// max |I(t) − I(0)| / max(|I(0)|, the largest sum of the absolute values of I's terms along the run), over
/// all accepted steps; 0 where all of them vanish.  A vector's is its worst component's.
#[derive(Clone, Debug, PartialEq)]
pub struct Drift {
    /// The quantity's name.
    pub name: String,
    /// Its drift; `None` where the quantity is not finite.
    pub value: Option<f64>,
}

/// One number that should stay.
#[derive(Clone, Copy, Debug)]
struct Watched {
    first: f64,
    last: f64,
    change: f64,
    scale: f64,
    /// Whether it is claimed to be conserved at present: not in phases in which it is not a number from their start.
    claimed: bool,
    /// Its value before the last restart.
    before: f64,
}

impl Watched {
    /// `rounding`: what that of the state makes of it.
    fn new((value, scale): (f64, f64), rounding: f64) -> Self {
        let claimed = value.is_finite();
        let scale = if claimed { scale.max(value.abs()).max(MEASURED * rounding) } else { 0.0 };
        Watched { first: value, last: value, change: 0.0, scale, claimed, before: value }
    }

    /// Goes on with another value, which an impulse or other equations made of the last one.
    fn restart(&mut self, value: f64) {
        let known = std::mem::replace(&mut self.claimed, value.is_finite());
        self.first = match (known, self.claimed) {
            (true, true) => self.first + (value - self.before),
            (false, true) => value,
            _ => self.first,
        };
    }

    fn observe(&mut self, value: f64, scale: f64) {
        let change = (value - self.first).abs();
        // Once it is not a number it stays so.
        if change > self.change || change.is_nan() {
            self.change = change;
        }
        self.scale = self.scale.max(scale);
        self.last = value;
    }

    fn drift(&self) -> Option<f64> {
        let drift = if self.change == 0.0 { 0.0 } else { self.change / self.scale };
        Some(drift).filter(|drift| drift.is_finite() && self.first.is_finite())
    }
}

/// Watches the invariants and the energy balance along a run.
#[derive(Clone, Debug)]
pub(crate) struct Monitor {
    n: usize,
    /// What restarts did to J: an explicit potential that is switched, an impulse.
    switched: f64,
    before: f64,
    balance: Watched,
    invariants: Vec<Watched>,
    pairs: Vec<f64>,
}

impl Monitor {
    /// Notes the values at the start.
    pub fn new<S: System + ?Sized>(system: &S, t: f64, y: &[f64], done: f64) -> Self {
        let n = system.len();
        let mut pairs = vec![0.0; 2 * system.description().invariant_len()];
        system.invariants(At::packed(t, y, n), &mut pairs);
        let (of_balance, of_invariants) = roundings(system, t, y, &pairs);
        let values = pairs.chunks_exact(2).map(|pair| (pair[0], pair[1]));
        let invariants = values.zip(of_invariants).map(|(value, rounding)| Watched::new(value, rounding)).collect();
        let (balance, scale) = balance(system, At::packed(t, y, n), done);
        let scale = scale.max(least_energy(system, At::packed(t, y, n)));
        let balance = Watched::new((balance, scale), of_balance);
        Monitor { n, switched: 0.0, before: 0.0, balance, invariants, pairs }
    }

    /// Notes the values after a step, `done` being the work of what has no potential.
    /// Returns by how much the energy balance changed since the last look, relative to its scale, and this scale.
    pub fn observe<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64], done: f64) -> (f64, f64) {
        let before = self.balance.last;
        let (value, scale) = balance(system, At::packed(t, y, self.n), done + self.switched);
        self.balance.observe(value, scale);
        let change = (value - before).abs();
        if !self.invariants.is_empty() {
            system.invariants(At::packed(t, y, self.n), &mut self.pairs);
            for (watched, pair) in self.invariants.iter_mut().zip(self.pairs.chunks_exact(2)) {
                if watched.claimed {
                    watched.observe(pair[0], pair[1]);
                }
            }
        }
        // Numbers near the least that there is have no digits to judge by.
        let scale = self.balance.scale;
        (if change <= f64::MIN_POSITIVE / f64::EPSILON { 0.0 } else { change / scale }, scale)
    }

    /// Notes J and the invariants before the equations, or the state, change at a restart.
    pub fn leave<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        let energy = system.energy(At::packed(t, y, self.n));
        self.before = energy.jacobi;
        // Not every step is looked at, but what an impulse makes of the motion counts among its energies.
        self.balance.scale = self.balance.scale.max(energy.scale);
        system.invariants(At::packed(t, y, self.n), &mut self.pairs);
        for (watched, pair) in self.invariants.iter_mut().zip(self.pairs.chunks_exact(2)) {
            watched.before = pair[0];
        }
    }

    /// Counts what a restart did to J since [`Monitor::leave`] as work, and takes what it did to invariants as meant.
    pub fn restart<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        let energy = system.energy(At::packed(t, y, self.n));
        self.balance.scale = self.balance.scale.max(energy.scale);
        let change = energy.jacobi - self.before;
        if change.is_finite() {
            self.switched += change;
        }
        system.invariants(At::packed(t, y, self.n), &mut self.pairs);
        for (watched, pair) in self.invariants.iter_mut().zip(self.pairs.chunks_exact(2)) {
            watched.restart(pair[0]);
        }
    }

    /// Drift of the energy balance.
    pub fn energy_balance(&self) -> Option<f64> {
        self.balance.drift()
    }

    /// Drift of each invariant.
    pub fn drifts(&self, description: &Description) -> Vec<Drift> {
        let mut components = self.invariants.iter();
        let mut drifts = Vec::with_capacity(description.invariants.len());
        for quantity in description.invariants.iter() {
            let worst = components
                .by_ref()
                .take(quantity.components as usize)
                .map(Watched::drift)
                .reduce(|a, b| a.zip(b).map(|(a, b)| a.max(b)));
            drifts.push(Drift { name: quantity.name.to_string(), value: worst.flatten() });
        }
        drifts
    }
}

/// The energy of what moves in a second by rounding of rounding of its place: what is at rest but for that has none.
fn least_energy<S: System + ?Sized>(system: &S, at: At<'_>) -> f64 {
    let sizes = sizes_alike(system.description(), at.q);
    let mut inertia = vec![0.0; system.len()];
    system.inertias(at, &mut Vec::new(), &mut inertia);
    let whole: f64 = inertia.iter().zip(&sizes).map(|(inertia, size)| inertia.abs() * size * size).sum();
    if whole.is_finite() { SECOND_ROUNDING * whole } else { 0.0 }
}

/// A number is told to change by parts of itself where it is so many times what rounding makes of it: nine digits are left then.
const MEASURED: f64 = 1e9;
/// Places are off by so many roundings of the largest that has their unit.
const ROUNDINGS: f64 = 8.0;

/// What rounding of places makes of the energy and of invariants, whose pairs are these, to first order: what is 0 but for it is no scale.
fn roundings<S: System + ?Sized>(system: &S, t: f64, y: &[f64], pairs: &[f64]) -> (f64, Vec<f64>) {
    let n = system.len();
    let sizes = sizes_alike(system.description(), &y[..n]);
    let energy = |y: &[f64]| system.energy(At::packed(t, y, n)).jacobi;
    let (mut moved, mut others) = (y.to_vec(), vec![0.0; pairs.len()]);
    let (mut of_energy, mut of_invariants) = (0.0, vec![0.0; pairs.len() / 2]);
    let here = energy(y);
    for (i, size) in sizes.iter().enumerate() {
        moved[i] = y[i] + ROUNDINGS * f64::EPSILON * size;
        of_energy += (energy(&moved) - here).abs();
        if !pairs.is_empty() {
            system.invariants(At::packed(t, &moved, n), &mut others);
        }
        let changes = others.iter().zip(pairs).step_by(2).map(|(there, here)| (there - here).abs());
        of_invariants.iter_mut().zip(changes).for_each(|(sum, change)| *sum += change);
        moved[i] = y[i];
    }
    let known = |rounding: f64| if rounding.is_finite() { rounding } else { 0.0 };
    (known(of_energy), of_invariants.into_iter().map(known).collect())
}

/// J − W and the sum of the absolute values of its terms.
fn balance<S: System + ?Sized>(system: &S, at: At<'_>, done: f64) -> (f64, f64) {
    let energy = system.energy(at);
    (energy.jacobi - done, energy.scale + done.abs())
}
