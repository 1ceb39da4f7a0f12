//! Time stepping over contacts: impulses over whole steps in the place of events.
//!
//! With qₘ = q + h/2 v, tₘ = t + h/2, and M, the forces f and the rows J there,
//!
//! M (v⁺ − v) = h f(tₘ, qₘ, vₘ) + Σ Jᵀ P,  q⁺ = qₘ + h/2 v⁺,
//!
//! where vₘ is first v, and then once more the mean of v and the v⁺ that this gives.
//!
//! Of each contact whose gap is not positive at qₘ, with u = J v + what no speed makes: 0 ≤ P_N ⟂ u_N⁺ − w ≥ 0, w = −e u_N where it approaches and 0
//! where not; |P_T| ≤ L, against the sliding where that is equality, L = μ P_N of contacts, h times the limit of frictions (Moreau, Unilateral contact
//! and dry friction in finite freedom dynamics, 1988; Jean, The non-smooth contact dynamics method, Comput. Methods Appl. Mech. Engrg. 177 (1999)
//! 235; Acary & Brogliato, Numerical Methods for Nonsmooth Dynamical Systems, 2008, ch. 10). Constraints that always act take part with their own
//! impulses.  No event of a contact is looked for; the error is of the first order in h.
//!
//! 1. A step: look in `step.rs`; what it begins with, rows by rows: `rows.rs`; limits of friction: `limits.rs`.
//! 2. The impulses, by projections in turn: look in `law.rs`; all at once, where rounds go on for long: `together.rs`.
//! 3. What contacts did over a run: look in `tally.rs`.

mod law;
mod limits;
mod rows;
mod step;
mod tally;
mod together;

pub(crate) use law::Unsolved;
pub(crate) use limits::made_of_reactions;
pub(crate) use rows::Wrong;
pub(crate) use step::TimeStepping;
pub(crate) use tally::{ContactTally, Tally};
