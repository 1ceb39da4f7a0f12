//! Accelerations by elimination over shared velocities, without M.
//!
//! 1. What accelerations make least: look in `derive/least_constraint.rs`.
//! 2. Velocities as linear forms; a velocity that several others are made of is kept as a variable: look in `forms`.
//! 3. The order in which variables are eliminated: look in `order`.
//! 4. Kept variables are put in, coordinates minimise: look in `solve`; sums stay lists of terms until they are read: `sums`.
//!
//! It finds the articulated-body recursion (Featherstone, The International Journal of Robotics Research 2 (1983) 13) without being told of joints:
//! the position of a link's end is shared by all links beyond, so its velocity is kept, and couples no more than its neighbours.  Every pivot is
//! one of LDLᵀ of M in the order of the coordinates that are eliminated, hence positive where M is positive definite.

mod depth;
mod forms;
mod order;
mod solve;
mod sums;

use super::{Dynamics, LeastConstraint};
use crate::expr::Graph;
pub(crate) use depth::Depths;
pub(crate) use forms::Forms;
pub(crate) use order::{Interaction, Order, RULES, Rule};
pub(crate) use solve::{Solution, WRITINGS, Writing, roots, solve};

/// With no more coordinates than this M and h are always formed.
pub(crate) const FEW: usize = 16;

/// Accelerations of a mechanism whose M and h are not formed.
#[derive(Clone, Debug)]
pub(crate) struct Eliminated {
    /// What accelerations make least, in a graph of its own.
    pub least: (Graph, Forms),
    /// One elimination, in a graph of its own.
    pub solved: (Graph, Solution),
}

impl Eliminated {
    /// Nothing where M has few coordinates or does not change, since it is factored once per run, where no velocity is shared or some is not
    /// linear in the speeds, and where factoring M, which takes [`Forms::least_factoring`] operations or more, may take no more than all of
    /// elimination.
    pub fn of(graph: &Graph, dynamics: &Dynamics) -> Option<Eliminated> {
        if dynamics.n <= FEW {
            return None;
        }
        let mut trial = graph.clone();
        let least = LeastConstraint::of(&mut trial, dynamics);
        let forms = Forms::of(&mut trial, dynamics.n, &least)?;
        if forms.are_of_coordinates() || forms.are_constant(&trial) {
            return None;
        }
        let least = forms.moved(&trial, false);
        let (mut graph, forms) = least.clone();
        let interaction = Interaction::of(&forms);
        let order = RULES.into_iter().find_map(|rule| interaction.order(rule))?;
        let solution = solve(&mut graph, &forms, &order.variables, WRITINGS[0])?;
        let operations = graph.needed(solution.roots()).len();
        (operations < forms.least_factoring()).then_some(Eliminated { least, solved: (graph, solution) })
    }
}

#[cfg(test)]
mod tests;
