//! Jumps of the speeds: constraints that are entered, and impacts with restitution.

use crate::cause::Cause;
use crate::mechanism::dense::constraint_triples;
use crate::mechanism::{Action, At, KktSolver, Singular, System};

/// What an instant does to the speeds: M Δq' = Jᵀ P.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct VelocityJump {
    /// Δq'.
    pub jump: Vec<f64>,
    /// P of every row that took part: its place, and its impulse.
    pub rows: Vec<(usize, f64)>,
}

/// Refuses a coefficient of restitution that is not between 0 and 1, of any event that is not ignored.
pub(crate) fn possible_restitutions(system: &dyn System, ignored_events: &[usize]) -> Result<(), Box<Cause>> {
    let restitutions = system.restitutions();
    let events = system.description().events.iter().enumerate().filter(|(event, _)| !ignored_events.contains(event));
    for action in events.flat_map(|(_, event)| event.actions.iter()) {
        if let Action::Impact { restitution, .. } = action {
            possible_restitution(restitutions.get(*restitution as usize).copied().unwrap_or(0.0))?;
        }
    }
    Ok(())
}

/// Refuses a coefficient of restitution that is not between 0 and 1.
pub(crate) fn possible_restitution(value: f64) -> Result<(), Box<Cause>> {
    if (0.0..=1.0).contains(&value) { Ok(()) } else { Err(Cause::BadRestitution { value }.into()) }
}

/// The least change of the speeds, in the metric of M, after which c' = 0 in all of these rows, or −e times what it was in
/// those for which `restitution` gives an e: K [Δq'; −P] = [0; −(1 + e) c'].
///
/// With e = 0 the loss of kinetic energy is that of the lost speed, ½ Δq'ᵀ M Δq' (Carnot).
///
/// # Errors
/// Coordinates to which neither M nor a constraint gives any inertia.
pub(crate) fn velocity_jump<S: System + ?Sized>(
    system: &S,
    (t, y): (f64, &[f64]),
    rows: &[usize],
    restitution: impl Fn(usize) -> f64,
) -> Result<VelocityJump, Singular> {
    let n = system.len();
    let mut form = KktSolver::default();
    form.factor_rows(system, At::packed(t, y, n), rows)?;
    let triples = constraint_triples(system, At::packed(t, y, n));
    let mut impulses: Vec<f64> = rows.iter().map(|row| -(1.0 + restitution(*row)) * triples[*row][1]).collect();
    let mut jump = vec![0.0; n];
    form.solve(&mut jump, &mut impulses);
    Ok(VelocityJump { jump, rows: rows.iter().copied().zip(impulses).collect() })
}
