//! What a sharp turn of an input does to the speeds.
//!
//! With q continuous, ∫F dt over the instant gives M Δq' = −F_u'' Δu' where u' jumps (a body that is placed by u: momenta
//! p = ∂T/∂q' stay), and M Δq' = −F_u' Δu where u jumps (a damper that is driven by u).  Both are exact: F is affine in
//! u'', and F_u' must not change with what jumps.  A jump of u under u'' would need an infinite force.

use crate::cause::Cause;
use crate::mechanism::{At, InputJump, System};

/// A jump of the speeds: M Δq' = −F_u'' Δu' − F_u' Δu where inputs turn sharply or jump, M Δq' = Jᵀ P where constraints
/// are entered or struck.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Impulse {
    /// When, s.
    pub t: f64,
    /// The inputs that turned or jumped.
    pub inputs: Vec<String>,
    /// Rows of the constraints that were entered or struck, with their impulses: force times time in the unit that
    /// `reaction` has.
    pub constraints: Vec<(String, f64)>,
    /// By how much each rate q' jumped, SI.
    pub jump: Vec<f64>,
    /// Of each rate the sum of the sizes of what the impulses do to it one by one, beside which its jump is rounded.
    pub(crate) terms: Vec<f64>,
    /// By how much the kinetic energy jumped, J: what impacts take is negative.
    pub energy: f64,
}

/// A change this small against the values is rounding, or of the place of the stop.
const ROUNDING: f64 = 1e-11;

/// So many roundings beside the time of a sharp turn it has happened, or has not.
const BESIDE: f64 = 64.0;
/// A change so many times as large as those beside it is a jump.
const SHARP: f64 = 16.0;

/// The jump of the speeds at a state where inputs went from `before` to `after`, (u, u', u'') of each; `None` where
/// there is none.  The kinetic energy before it is known.
///
/// # Errors
/// [`Cause::InfiniteForce`] names an input whose jump has no finite consequence; [`Cause::SingularMass`].
pub(crate) fn impulse<S: System + ?Sized>(
    system: &S,
    (t, y): (f64, &[f64]),
    before: &[f64],
    after: &[f64],
    kinetic: f64,
) -> Result<Option<Impulse>, Box<Cause>> {
    let description = system.description();
    let n = system.len();
    let mut jumps = vec![[0.0; 3]; before.len() / 3];
    let mut inputs = Vec::new();
    for (input, jump) in jumps.iter_mut().enumerate() {
        let (old, new) = (&before[3 * input..][..3], &after[3 * input..][..3]);
        let change = |order: usize| new[order] - old[order];
        let size = |order: usize| old[order].abs().max(new[order].abs());
        let lag = 64.0 * f64::EPSILON * t.abs();
        if change(0).abs() > ROUNDING * size(0) + lag * size(1) {
            match description.input_jumps.get(input) {
                Some(InputJump::Refused) => {
                    let name = description.inputs.get(input).map_or_else(String::new, ToString::to_string);
                    return Err(Cause::InfiniteForce { input: name, t }.into());
                }
                Some(InputJump::Speed) => jump[1] = change(0),
                _ => {}
            }
        }
        if change(1).abs() > ROUNDING * size(1) + lag * size(2) {
            jump[2] = change(1);
        }
        if *jump != [0.0; 3] {
            inputs.push(description.inputs.get(input).map_or_else(String::new, ToString::to_string));
        }
    }
    if inputs.is_empty() {
        return Ok(None);
    }
    let zero = vec![0.0; n];
    let at = At::packed(t, y, n).accelerated(&zero);
    let mut slopes = vec![0.0; description.input_pattern.len()];
    system.input_jacobian(at, &mut slopes);
    let mut push = vec![0.0; n];
    for ((row, column), slope) in description.input_pattern.iter().zip(&slopes) {
        push[*row as usize] -= slope * jumps[*column as usize / 3][*column as usize % 3];
    }
    if push.iter().all(|push| *push == 0.0) {
        return Ok(None);
    }
    let jump = moved(system, at, &push)?;
    let energy = kinetic_after(system, (t, y), &jump) - kinetic;
    Ok(Some(Impulse { t, inputs, constraints: Vec::new(), terms: sizes(&jump), jump, energy }))
}

/// The sizes of jumps that are not known as sums.
fn sizes(jump: &[f64]) -> Vec<f64> {
    jump.iter().map(|jump| jump.abs()).collect()
}

/// By how much a jump of the speeds changes the kinetic energy of a state, J.
pub(crate) fn gained<S: System + ?Sized>(system: &S, (t, y): (f64, &[f64]), jump: &[f64]) -> f64 {
    let (q, v) = y.split_at(jump.len());
    let after: Vec<f64> = v.iter().zip(jump).map(|(v, jump)| v + jump).collect();
    system.energy(At::new(t, q, &after)).kinetic - system.energy(At::new(t, q, v)).kinetic
}

/// How long before and after an instant what turns sharply in it has not turned yet, and has, s.
fn apart(t: f64) -> f64 {
    BESIDE * f64::EPSILON * t.abs().max(f64::MIN_POSITIVE / f64::EPSILON)
}

/// The kinetic energy just before what turns or jumps at t.
pub(crate) fn kinetic_before<S: System + ?Sized>(system: &S, (t, y): (f64, &[f64])) -> f64 {
    system.energy(At::packed(t - apart(t), y, system.len())).kinetic
}

/// The same just after it, the speeds having jumped.
fn kinetic_after<S: System + ?Sized>(system: &S, (t, y): (f64, &[f64]), jump: &[f64]) -> f64 {
    let (q, v) = y.split_at(jump.len());
    let v: Vec<f64> = v.iter().zip(jump).map(|(v, jump)| v + jump).collect();
    system.energy(At::new(t + apart(t), q, &v)).kinetic
}

/// M⁻¹ p.
fn moved<S: System + ?Sized>(system: &S, at: At<'_>, push: &[f64]) -> Result<Vec<f64>, Box<Cause>> {
    let description = system.description();
    let n = push.len();
    let mut values = vec![0.0; description.mass_pattern.len()];
    system.mass_matrix(at, &mut values);
    let mut packed = vec![0.0; n * (n + 1) / 2];
    for ((row, column), value) in description.mass_pattern.iter().zip(&values) {
        let (row, column) = (*row as usize, *column as usize);
        packed[row * (row + 1) / 2 + column] = *value;
    }
    // Solves M x = −h, as where accelerations are.
    let mut jump: Vec<f64> = push.iter().map(|push| -push).collect();
    crate::mechanism::solve_packed_slice(&mut packed, &mut jump)
        .map_err(|fault| crate::mechanism::Singular::Mass(fault).cause(description))?;
    Ok(jump)
}

/// The momenta p = ∂T/∂q' at a state, with the size of what each is the difference of: T is quadratic in q', so that differences are exact.
///
/// A place that time moves has its own speed in them.
fn momenta<S: System + ?Sized>(system: &S, (t, y): (f64, &[f64])) -> Vec<(f64, f64)> {
    let n = system.len();
    let (q, mut v) = (&y[..n], y[n..].to_vec());
    let mut values = vec![0.0; system.description().mass_pattern.len()];
    system.mass_matrix(At::new(t, q, &v), &mut values);
    let own = |i: usize| {
        let diagonal = |(row, column): &(u32, u32)| *row as usize == i && row == column;
        system.description().mass_pattern.iter().position(diagonal).map_or(0.0, |place| values[place])
    };
    let whole = system.energy(At::new(t, q, &v)).kinetic;
    let momentum = |i: usize| {
        let size = (2.0 * whole / own(i)).sqrt();
        let step = if size > 0.0 && size.is_finite() { size } else { 1.0 };
        let usual = v[i];
        let mut beside = |by: f64| {
            v[i] = usual + by;
            system.energy(At::new(t, q, &v)).kinetic
        };
        let [more, less] = [beside(step), beside(-step)];
        v[i] = usual;
        ((more - less) / (2.0 * step), (more.abs() + less.abs()) / step)
    };
    (0..n).map(momentum).collect()
}

/// The jump of the speeds where places that time moves turn sharply between t and `resume`, so that momenta p would be others with the
/// speeds as they are: M Δq' = −Δp.  `None` where they are the same to rounding, or unknown.
///
/// # Errors
/// [`Cause::SingularMass`].
pub(crate) fn turn<S: System + ?Sized>(
    system: &S,
    (t, resume): (f64, f64),
    y: &[f64],
    kinetic: f64,
) -> Result<Option<Impulse>, Box<Cause>> {
    let apart = apart(t);
    let times = [t - 2.0 * apart, t - apart, resume + apart, resume + 2.0 * apart];
    let [earlier, before, after, later] = times.map(|t| momenta(system, (t, y)));
    let change = |i: usize| {
        let change = after[i].0 - before[i].0;
        // What changes as much beside it is no jump.
        let usual = (before[i].0 - earlier[i].0).abs() + (later[i].0 - after[i].0).abs();
        if change.abs() > ROUNDING * (before[i].1 + after[i].1) + SHARP * usual { -change } else { 0.0 }
    };
    let push: Vec<f64> = (0..before.len()).map(change).collect();
    if push.iter().all(|push| *push == 0.0) || push.iter().any(|push| !push.is_finite()) {
        return Ok(None);
    }
    let jump = moved(system, At::packed(t, y, system.len()), &push)?;
    let energy = kinetic_after(system, (resume, y), &jump) - kinetic;
    Ok(Some(Impulse { t, inputs: Vec::new(), constraints: Vec::new(), terms: sizes(&jump), jump, energy }))
}
