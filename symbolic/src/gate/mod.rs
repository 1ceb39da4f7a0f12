//! The gate: what must hold before a model compiles.
//!
//! Derivations are compared at many states, and what the file says is conserved or holds is tested: look in `test`.
//! Forces are tested for potentials and for being counted twice (`potential`, `twice`), and for what they do to what
//! should be conserved (`blame`); what each entry does is in `effects`.

mod agreement;
mod balances;
mod blame;
mod effects;
mod named;
mod potential;
mod sample;
mod shared;
mod test;
mod twice;
mod unseen;

use crate::derive::{Derivation, derive};
use crate::diagnose::Problem;
use crate::expr::Id;
use crate::model::Model;

pub use potential::{Conservative, Nature};
pub use sample::{Draws, State};
pub(crate) use test::solve;
pub use test::{Agreement, Report};
pub use unseen::shared_data;

/// A derivation that has passed.
#[derive(Clone, Debug)]
pub struct Judged {
    /// What was judged.
    pub derivation: Derivation,
    /// Cyclic coordinates and their momenta.
    pub cyclic: Vec<(usize, Id)>,
    /// What was tested, and how well it held.
    pub report: Report,
}

/// Compares derivations and tests claims.
///
/// # Errors
/// A coordinate that carries no mass; derivations that disagree; something said to be conserved, or an
/// identity, that is not.
pub fn judge(mut derivation: Derivation) -> Result<Judged, Vec<Problem>> {
    let Derivation { model, equations, momentum, momenta, switches, .. } = &mut derivation;
    let report = test::all(model, equations, momentum, switches)?;
    let cyclic = test::cyclic(model, &report.states, momenta);
    Ok(Judged { derivation, cyclic, report })
}

/// Derives and judges.
///
/// # Errors
/// Everything that either finds.
pub fn judged(model: Model) -> Result<Judged, Vec<Problem>> {
    judge(derive(model)?)
}
