//! Motion on a surface of discontinuity, to which both sides push back: friction that sticks, a relay that holds.
//!
//! With accelerations a₋ and a₊ on the two sides, and the rates ė₋ and ė₊ that they give to the argument e, the motion goes on with
//! a = (1 − w) a₋ + w a₊, where (1 − w) ė₋ + w ė₊ = 0 (Filippov, Differential Equations with Discontinuous Righthand Sides, 1988, §4).
//! On several surfaces at once a = a₋ + Σ w_k (a_k − a₋), where a_k is that above surface k alone; the rates make a linear system for w.
//! Where a mode stands linearly in the forces, this is the force that keeps e = 0, between its two limits.
//!
//! An argument of places alone has a rate that no side changes at once: ë takes the place of ė, and the motion stays where e = 0 and ė = 0 (sliding of
//! second order; Levant, International Journal of Control 58 (1993) 1247), as a spring that is preloaded towards its middle holds there.

use nalgebra::{DMatrix, DVector};

use super::dense::constraint_matrix;
use super::{Along, At, Enforcement, Function, Singular, SwitchKind, System};
use crate::matrix::{rank, solve_least};

/// The mode of a switch that slides: what does not know of sliding makes no number of it.
pub(crate) const SLIDES: f64 = f64::NAN;
/// A pivot below this part of the largest rate is zero: no side moves its argument at once.
const NOTHING: f64 = 1e-12;
/// How many roundings of its terms an argument is moved by to be on one side for certain.
const CERTAIN: f64 = 4.0;

/// What moves below all surfaces, and above each alone.
struct Sides {
    /// Without sliding.
    free: Box<dyn System>,
    /// Of each switch that slides whether its argument is one of places alone.
    of_places: Vec<bool>,
    below: Side,
    above: Vec<Side>,
}

struct Side {
    a: Vec<f64>,
    lambda: Vec<f64>,
    /// What it makes of the arguments of the switches that slide: ė, or ë of those of places alone.
    rates: Vec<f64>,
}

/// The mode of a switch whose argument is below its surface by 1 − w and above it by w.
pub(crate) fn mode(kind: SwitchKind, w: f64) -> f64 {
    match kind {
        SwitchKind::Sign => 2.0 * w - 1.0,
        SwitchKind::Step => w,
    }
}

/// The switches that slide with these modes.
pub(super) fn places(modes: &[f64]) -> Vec<usize> {
    (0..modes.len()).filter(|switch| modes[*switch].is_nan()).collect()
}

/// The modes in force, those of the switches that slide at w.
fn modes<S: System + ?Sized>(system: &S, w: &[f64]) -> Vec<f64> {
    let mut modes = system.modes().to_vec();
    for (switch, w) in system.sliding().iter().zip(w) {
        modes[*switch] = mode(system.description().switches[*switch].kind, *w);
    }
    modes
}

impl Sides {
    fn new<S: System + ?Sized>(system: &S, at: At<'_>) -> Result<Sides, Singular> {
        let mut free = system.boxed_clone();
        let count = system.sliding().len();
        let mut side = |above: Option<usize>| -> Result<Side, Singular> {
            let w: Vec<f64> = (0..count).map(|k| f64::from(u8::from(above == Some(k)))).collect();
            free.set_modes(&modes(system, &w));
            let (mut a, mut lambda) = (vec![0.0; system.len()], vec![0.0; system.description().rows.len()]);
            free.accelerations_and_multipliers(at, &mut a, &mut lambda)?;
            let rates = rates(&*free, system.sliding(), at.accelerated(&a).constrained(&lambda));
            Ok(Side { a, lambda, rates })
        };
        let below = side(None)?;
        let above = (0..count).map(|k| side(Some(k))).collect::<Result<Vec<Side>, _>>()?;
        let alike = |k: usize| above.iter().all(|side| side.rates[k].to_bits() == below.rates[k].to_bits());
        let of_places: Vec<bool> =
            (0..count).map(|k| alike(k) && is_of_places(&*free, system.sliding()[k], at)).collect();
        let mut sides = Sides { free, of_places, below, above };
        if sides.of_places.contains(&true) {
            sides.below.rates = sides.rates(system, at.constrained(&sides.below.lambda), &sides.below.a);
            for k in 0..count {
                let above = &sides.above[k];
                sides.above[k].rates = sides.rates(system, at.constrained(&above.lambda), &above.a);
            }
        }
        Ok(sides)
    }

    /// What accelerations make of the arguments: ė, or ë of those of places alone.
    fn rates<S: System + ?Sized>(&self, system: &S, at: At<'_>, a: &[f64]) -> Vec<f64> {
        let mut rates = rates(&*self.free, system.sliding(), at.accelerated(a));
        if self.of_places.contains(&true) {
            let mut slopes = vec![f64::NAN; 2 * system.description().switches.len()];
            let along = Along { t: 1.0, q: at.v, v: a, ..Along::default() };
            self.free.slopes(Function::Switches, at.accelerated(a), &along, &mut slopes);
            let second = system.sliding().iter().map(|switch| slopes[2 * switch + 1]);
            let list = rates.iter_mut().zip(second).zip(&self.of_places);
            list.filter(|(_, of_places)| **of_places).for_each(|((rate, second), _)| *rate = second);
        }
        rates
    }

    /// x of Σ x_k (ė_k − ė₋) = right; `None` where no side moves its argument at once.
    fn solve(&self, right: impl Fn(usize) -> f64) -> Option<Vec<f64>> {
        let count = self.above.len();
        if count == 0 {
            return Some(Vec::new());
        }
        let factors = DMatrix::from_fn(count, count, |i, k| self.above[k].rates[i] - self.below.rates[i]).full_piv_lu();
        let rates = self.above.iter().chain([&self.below]).flat_map(|side| &side.rates);
        let largest = rates.fold(0.0_f64, |most, rate| most.max(rate.abs()));
        if factors.u().diagonal().iter().any(|pivot| pivot.abs() <= NOTHING * largest || pivot.is_nan()) {
            return None;
        }
        let x = factors.solve(&DVector::from_fn(count, |i, _| right(i)))?;
        x.iter().all(|x| x.is_finite()).then(|| x.iter().copied().collect())
    }

    /// w; half way between sides that are alike, and move no argument.
    fn fractions(&self) -> Option<Vec<f64>> {
        let alike = |side: &Side| side.a == self.below.a && side.rates.iter().all(|rate| *rate == 0.0);
        if self.above.iter().chain([&self.below]).all(alike) {
            return Some(vec![0.5; self.above.len()]);
        }
        self.solve(|i| -self.below.rates[i])
    }

    /// a₋ + Σ w_k (a_k − a₋), or the same of other lists; NaN without w.
    fn mix(&self, w: Option<&[f64]>, of: impl Fn(&Side) -> &[f64], out: &mut [f64]) {
        let Some(w) = w else { return out.fill(f64::NAN) };
        out.copy_from_slice(of(&self.below));
        for (w, above) in w.iter().zip(&self.above) {
            let lists = of(above).iter().zip(of(&self.below));
            out.iter_mut().zip(lists).for_each(|(out, (above, below))| *out += w * (above - below));
        }
    }

    /// Takes from accelerations what rounding makes of the arguments' rates; what surfaces and constraints determine altogether comes from these
    /// alone, free of the rounding of forces.
    fn keep<S: System + ?Sized>(&self, system: &S, at: At<'_>, a: &mut [f64]) {
        let n = a.len();
        let rates = |a: &[f64]| self.rates(system, at, a);
        let exact = system.enforcement() == Enforcement::Multipliers && system.baumgarte_gain() == 0.0;
        let rows: Vec<usize> = system.active_rows().iter().filter(|_| exact).map(|row| *row as usize).collect();
        if rows.len() + self.above.len() >= n {
            let mut unit = vec![0.0; n];
            let still = rates(&unit);
            let mut bias = vec![0.0; system.description().rows.len()];
            self.free.constraint_bias(at, &mut bias);
            let right = rows.iter().map(|row| -bias[*row]).chain(still.iter().map(|rate| -rate));
            let right = DMatrix::from_iterator(rows.len() + still.len(), 1, right);
            let mut matrix = constraint_matrix(system, at, &rows).resize(right.len(), n, 0.0);
            for j in 0..n {
                unit[j] = 1.0;
                let moved = rates(&unit);
                unit[j] = 0.0;
                (0..still.len()).for_each(|i| matrix[(rows.len() + i, j)] = moved[i] - still[i]);
            }
            let nothing = NOTHING * matrix.amax();
            if rank(matrix.clone(), nothing) == Some(n)
                && let Some(solved) = solve_least(&matrix, &right)
            {
                return a.copy_from_slice(solved.as_slice());
            }
        }
        let left = rates(a);
        self.shift(a, |i| -left[i]);
    }

    /// The arguments of the switches that slide.
    fn arguments<S: System + ?Sized>(&self, system: &S, at: At<'_>) -> Vec<f64> {
        let mut pairs = vec![0.0; 2 * system.description().switches.len()];
        self.free.switches(at, &mut pairs);
        system.sliding().iter().map(|switch| pairs[2 * switch]).collect()
    }

    /// Moves speeds along what the modes do to them until the arguments, or the rates of those of places alone, have changed by so much, or places until
    /// these arguments have; false where they cannot.
    fn shift(&self, v: &mut [f64], change: impl Fn(usize) -> f64) -> bool {
        let Some(x) = self.solve(change) else { return false };
        for (x, above) in x.iter().zip(&self.above) {
            let lists = above.a.iter().zip(&self.below.a);
            v.iter_mut().zip(lists).for_each(|(v, (above, below))| *v += x * (above - below));
        }
        true
    }

    /// By how much the arguments may change by the rounding of the speeds, or those of places alone by that of places.
    fn rounding<S: System + ?Sized>(&self, system: &S, at: At<'_>) -> Vec<f64> {
        let here = self.arguments(system, at);
        let (mut q, mut v, mut sums) = (at.q.to_vec(), at.v.to_vec(), vec![0.0; here.len()]);
        for i in 0..v.len() {
            (q[i], v[i]) = (at.q[i] * (1.0 + CERTAIN * f64::EPSILON), at.v[i] * (1.0 + CERTAIN * f64::EPSILON));
            let of_speeds = self.arguments(system, At { v: &v, ..at });
            let of_places = self.arguments(system, At { q: &q, ..at });
            (q[i], v[i]) = (at.q[i], at.v[i]);
            for (k, sum) in sums.iter_mut().enumerate() {
                let there = if self.of_places[k] { of_places[k] } else { of_speeds[k] };
                *sum += (there - here[k]).abs();
            }
        }
        sums
    }
}

/// The rates of the arguments of some switches.
fn rates(system: &dyn System, switches: &[usize], at: At<'_>) -> Vec<f64> {
    let mut pairs = vec![0.0; 2 * system.description().switches.len()];
    system.switches(at, &mut pairs);
    switches.iter().map(|switch| pairs[2 * switch + 1]).collect()
}

/// Whether no acceleration, and no rate of a state of first order, changes the rate of an argument.
fn is_of_places(system: &dyn System, switch: usize, at: At<'_>) -> bool {
    let mut a = vec![0.0; system.len()];
    let still = rates(system, &[switch], at.accelerated(&a))[0];
    (0..a.len()).all(|i| {
        a.fill(0.0);
        a[i] = 1.0;
        rates(system, &[switch], at.accelerated(&a))[0].to_bits() == still.to_bits()
    })
}

/// The accelerations and multipliers of a system that slides; NaN where no side moves an argument at once.
pub(super) fn accelerations_and_multipliers<S: System + ?Sized>(
    system: &S,
    at: At<'_>,
    a: &mut [f64],
    lambda: &mut [f64],
) -> Result<(), Singular> {
    let sides = Sides::new(system, at)?;
    let w = sides.fractions();
    sides.mix(w.as_deref(), |side| &side.a, a);
    sides.mix(w.as_deref(), |side| &side.lambda, lambda);
    if w.is_some() {
        sides.keep(system, at, a);
    }
    Ok(())
}

/// Of each switch that slides how far its mode is above its lower side, 0 to 1 where both sides push back; `None` where it is not determined.
pub(crate) fn fractions<S: System + ?Sized>(system: &S, t: f64, y: &[f64]) -> Option<Vec<f64>> {
    Sides::new(system, At::packed(t, y, system.len())).ok()?.fractions()
}

/// The system without sliding, its modes those that keep the arguments at a state; half way between the sides where that is not determined.
pub(super) fn resolved<S: System + ?Sized>(system: &S, at: At<'_>) -> Box<dyn System> {
    let mut free = system.boxed_clone();
    let w = Sides::new(system, at).ok().and_then(|sides| sides.fractions());
    free.set_modes(&modes(system, &w.unwrap_or_else(|| vec![0.5; system.sliding().len()])));
    free
}

/// Whether what would slide along arguments of places alone does so within so many seconds: their rates are what their sides take away in that time.
pub(crate) fn comes_to_rest<S: System + ?Sized>(system: &S, t: f64, y: &[f64], seconds: f64) -> bool {
    let at = At::packed(t, y, system.len());
    let Ok(sides) = Sides::new(system, at) else { return false };
    let speeds = rates(&*sides.free, system.sliding(), at.accelerated(&sides.below.a));
    let stands = |k: usize| {
        let sides_apart = (sides.above[k].rates[k] - sides.below.rates[k]).abs();
        !sides.of_places[k] || speeds[k].abs() <= seconds * sides_apart
    };
    (0..speeds.len()).all(stands)
}

/// Brings the speeds of [q; q'] back to the surfaces, and places to those of places alone, along what the modes do to them; true where they moved.
pub(crate) fn return_to_surfaces<S: System + ?Sized>(system: &S, t: f64, y: &mut [f64]) -> bool {
    let n = system.len();
    let Ok(sides) = Sides::new(system, At::packed(t, y, n)) else { return false };
    let arguments = sides.arguments(system, At::packed(t, y, n));
    let speeds = rates(&*sides.free, system.sliding(), At::packed(t, y, n).accelerated(&sides.below.a));
    let beside = |i: usize| if sides.of_places[i] { speeds[i] } else { arguments[i] };
    let places = |i: usize| if sides.of_places[i] { arguments[i] } else { 0.0 };
    let count = arguments.len();
    let moves = |by: &dyn Fn(usize) -> f64| (0..count).any(|i| by(i) != 0.0);
    let moved = moves(&places) && sides.shift(&mut y[..n], |i| -places(i));
    moves(&beside) && sides.shift(&mut y[n..], |i| -beside(i)) || moved
}

/// The outputs of a system that slides: as its accelerations a mixture of those on the sides, a few roundings beside the surfaces.
pub(super) fn outputs<S: System + ?Sized>(system: &S, at: At<'_>, values: &mut [f64]) {
    let Ok(sides) = Sides::new(system, at) else { return values.fill(f64::NAN) };
    let Some(w) = sides.fractions() else { return values.fill(f64::NAN) };
    let mut free = sides.free.boxed_clone();
    free.set_modes(&modes(system, &w));
    let (mut a, mut lambda) = (vec![0.0; system.len()], vec![0.0; system.description().rows.len()]);
    sides.mix(Some(&w), |side| &side.a, &mut a);
    sides.mix(Some(&w), |side| &side.lambda, &mut lambda);
    sides.keep(system, at, &mut a);
    let (here, rounding) = (sides.arguments(system, at), sides.rounding(system, at));
    let beyond = |i: usize| 2.0 * here[i].abs() + rounding[i] + f64::MIN_POSITIVE / f64::EPSILON;
    let beside = |above: Option<usize>| -> Vec<f64> {
        let (mut q, mut v) = (at.q.to_vec(), at.v.to_vec());
        let change = |i: usize| if above == Some(i) { beyond(i) - here[i] } else { -beyond(i) - here[i] };
        sides.shift(&mut v, |i| if sides.of_places[i] { 0.0 } else { change(i) });
        if sides.of_places.contains(&true) {
            sides.shift(&mut q, |i| if sides.of_places[i] { change(i) } else { 0.0 });
        }
        let mut values = vec![0.0; values.len()];
        free.outputs(At { q: &q, v: &v, a: &a, lambda: &lambda, ..at }, &mut values);
        values
    };
    let below = beside(None);
    let above: Vec<Vec<f64>> = (0..w.len()).map(|k| beside(Some(k))).collect();
    for (i, value) in values.iter_mut().enumerate() {
        *value = below[i] + w.iter().zip(&above).map(|(w, above)| w * (above[i] - below[i])).sum::<f64>();
    }
}
