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
    below: Side,
    above: Vec<Side>,
}

struct Side {
    a: Vec<f64>,
    lambda: Vec<f64>,
    /// What it makes of the arguments of the switches that slide: their rates, or the rates of these where they are of places alone.
    rates: Vec<f64>,
}

/// The switches that slide, and which of them have arguments of places alone.
struct Surfaces<'a, S: ?Sized> {
    system: &'a S,
    /// Without sliding.
    free: &'a dyn System,
    of_places: Vec<bool>,
}

impl<S: System + ?Sized> Surfaces<'_, S> {
    /// What accelerations make of the arguments.
    fn rates(&self, at: At<'_>, a: &[f64], lambda: &[f64]) -> Vec<f64> {
        let at = at.accelerated(a).constrained(lambda);
        let mut pairs = vec![0.0; 2 * self.system.description().switches.len()];
        self.free.switches(at, &mut pairs);
        let mut seconds = vec![f64::NAN; pairs.len()];
        if self.of_places.contains(&true) {
            let along = Along { t: 1.0, q: at.v, v: a, ..Along::default() };
            self.free.slopes(Function::Switches, at, &along, &mut seconds);
        }
        let of = |(switch, of_places): (&usize, &bool)| if *of_places { &seconds } else { &pairs }[2 * switch + 1];
        self.system.sliding().iter().zip(&self.of_places).map(of).collect()
    }
}

/// The mode of a switch whose argument is below its surface by 1 − w and above it by w.
fn mode(kind: SwitchKind, w: f64) -> f64 {
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
            let description = system.description();
            let (mut a, mut lambda) = (vec![0.0; system.len()], vec![0.0; description.rows.len()]);
            free.accelerations_and_multipliers(at, &mut a, &mut lambda)?;
            let mut pairs = vec![0.0; 2 * description.switches.len()];
            free.switches(at.accelerated(&a).constrained(&lambda), &mut pairs);
            let rates = system.sliding().iter().map(|switch| pairs[2 * switch + 1]).collect();
            Ok(Side { a, lambda, rates })
        };
        let below = side(None)?;
        let above = (0..count).map(|k| side(Some(k))).collect::<Result<_, _>>()?;
        Ok(Sides { free, below, above })
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
        let rates = |a: &[f64]| -> Vec<f64> {
            let mut pairs = vec![0.0; 2 * system.description().switches.len()];
            self.free.switches(at.accelerated(a), &mut pairs);
            system.sliding().iter().map(|switch| pairs[2 * switch + 1]).collect()
        };
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

    /// Moves speeds along what the modes do to them until the arguments have changed by so much; false where they cannot.
    fn shift(&self, v: &mut [f64], change: impl Fn(usize) -> f64) -> bool {
        let Some(x) = self.solve(change) else { return false };
        for (x, above) in x.iter().zip(&self.above) {
            let lists = above.a.iter().zip(&self.below.a);
            v.iter_mut().zip(lists).for_each(|(v, (above, below))| *v += x * (above - below));
        }
        true
    }

    /// By how much the arguments may change by the rounding of the speeds.
    fn rounding<S: System + ?Sized>(&self, system: &S, at: At<'_>) -> Vec<f64> {
        let here = self.arguments(system, at);
        let (mut v, mut sums) = (at.v.to_vec(), vec![0.0; here.len()]);
        for i in 0..v.len() {
            v[i] = at.v[i] * (1.0 + CERTAIN * f64::EPSILON);
            let there = self.arguments(system, At { v: &v, ..at });
            v[i] = at.v[i];
            sums.iter_mut().zip(there.iter().zip(&here)).for_each(|(sum, (there, here))| *sum += (there - here).abs());
        }
        sums
    }
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

/// Brings the speeds of [q; q'] back to the surfaces, along what the modes do to them; true where they moved.
pub(crate) fn return_to_surfaces<S: System + ?Sized>(system: &S, t: f64, y: &mut [f64]) -> bool {
    let n = system.len();
    let Ok(sides) = Sides::new(system, At::packed(t, y, n)) else { return false };
    let arguments = sides.arguments(system, At::packed(t, y, n));
    arguments.iter().any(|argument| *argument != 0.0) && sides.shift(&mut y[n..], |i| -arguments[i])
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
        let mut v = at.v.to_vec();
        sides.shift(&mut v, |i| if above == Some(i) { beyond(i) - here[i] } else { -beyond(i) - here[i] });
        let mut values = vec![0.0; values.len()];
        free.outputs(At { v: &v, a: &a, lambda: &lambda, ..at }, &mut values);
        values
    };
    let below = beside(None);
    let above: Vec<Vec<f64>> = (0..w.len()).map(|k| beside(Some(k))).collect();
    for (i, value) in values.iter_mut().enumerate() {
        *value = below[i] + w.iter().zip(&above).map(|(w, above)| w * (above[i] - below[i])).sum::<f64>();
    }
}
