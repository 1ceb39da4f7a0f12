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
}

/// A change this small against the values is rounding, or of the place of the stop.
const ROUNDING: f64 = 1e-11;

/// The jump of the speeds at a state where inputs went from `before` to `after`, (u, u', u'') of each; `None` where
/// there is none.
///
/// # Errors
/// [`Cause::InfiniteForce`] names an input whose jump has no finite consequence; [`Cause::SingularMass`].
pub(crate) fn impulse<S: System + ?Sized>(
    system: &S,
    (t, y): (f64, &[f64]),
    before: &[f64],
    after: &[f64],
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
    Ok(Some(Impulse { t, inputs, constraints: Vec::new(), jump }))
}
