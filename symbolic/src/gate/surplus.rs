//! Systems of balances with more equations than unknowns.
//!
//! Constraints may depend on each other, and then count as many as are independent; the force on a coordinate without mass, 0,
//! is a constraint (`z_balance`), which a balance may say once more.  Of such a system so many equations are kept as there are
//! unknowns, balances first.

use super::null::{Columns, null_space, rank};
use super::system::Assembled;
use crate::derive::massless;
use crate::derive::momentum::Momentum;
use crate::diagnose::catalogue::mechanics;
use crate::diagnose::{Problem, counted};
use crate::model::{BalanceSystem, Model};
use crate::number::DoubleDouble;

/// A system of more equations is not looked at: each of them takes their cube.
const EQUATIONS: usize = 100;

/// Leaves out the equations that follow from others; an error where balances and independent constraints are not as many as unknowns.
pub(super) fn square(
    model: &Model,
    (system, linear): (&BalanceSystem, &Momentum),
    assembled: &[Assembled],
) -> Result<Option<Momentum>, Box<Problem>> {
    let (count, size) = (linear.right.len(), linear.unknowns.len());
    if count == size || count > EQUATIONS {
        return Ok(None);
    }
    let balances = count - linear.constraints;
    let independent = |a: &Assembled| rank(&rows(a, balances..count), size);
    let unequal = || {
        let of_constraints = assembled.iter().find_map(independent).unwrap_or(linear.constraints);
        let given = format!(
            "{} and {} of constraints",
            counted(balances, "equation"),
            counted(of_constraints, "independent row")
        );
        let wanted = format!(
            "{} and {}",
            counted(model.coordinates.len(), "acceleration"),
            counted(size - model.coordinates.len(), "reaction component or multiplier")
        );
        Box::new(mechanics::unequal_counts(system.place.clone(), &system.name, given, wanted, ""))
    };
    let Some((kept, a)) = assembled.iter().find_map(|a| Some((kept(a, size)?, a))) else { return Err(unequal()) };
    let speaks = |e: &usize| assembled.iter().any(|a| rows(a, *e..e + 1)[0].iter().any(|x| *x != DoubleDouble::ZERO));
    let given = (0..balances).filter(speaks).count() + independent(a).unwrap_or(linear.constraints);
    if !(size..=size + massless::count(model)).contains(&given) {
        return Err(unequal());
    }
    Ok(Some(linear.only(&kept)))
}

/// The coefficients of equations, with 0 for what is rounding.
fn rows(a: &Assembled, equations: std::ops::Range<usize>) -> Columns {
    let lines = equations.map(|e| &a.matrix[e * a.size..][..a.size]);
    let plain = |x: &crate::expr::Measured| if x.vanishes(super::ROUNDINGS) { DoubleDouble::ZERO } else { x.value };
    lines.map(|line| line.iter().map(plain).collect()).collect()
}

/// The first equations that determine all unknowns at a state; `None` where not all of them do, or rounding decides.
fn kept(a: &Assembled, size: usize) -> Option<Vec<usize>> {
    let all = rows(a, 0..a.equations);
    if rank(&all, size)? < size {
        return None;
    }
    let (mut kept, mut lines) = (Vec::new(), Columns::new());
    for (e, line) in all.into_iter().enumerate() {
        lines.push(line);
        if null_space(&lines, size)?.is_empty() {
            kept.push(e);
        } else {
            lines.pop();
        }
    }
    Some(kept)
}
