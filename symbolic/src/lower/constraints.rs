//! Constraints as programs, and what their multipliers do to the equations of motion.

use super::candidates::Chosen;
use super::magnitude::Magnitudes;
use super::{Entry, entries, gather, gather_entries};
use crate::derive::elimination::Solution;
use crate::derive::{Rows, held_rates};
use crate::expr::{Graph, Id, Symbol, jacobian, substitute};

/// What the elimination of M q'' + h = (Jᵀ + B) λ, J q'' + γ = 0 needs, and what is told of constraints.
#[derive(Clone, Debug, Default)]
pub struct Constraints {
    /// Triples (c, c', Σ |terms| of c); c of a row with speeds is its integral where one is known.
    pub values: Vec<Id>,
    /// The rows that have speeds and an integral.
    pub integral: Vec<bool>,
    /// The rows, with factors, that make the rate of an integral together with its own row.
    pub with: Vec<Vec<(usize, f64)>>,
    /// J: (row, coordinate, value).
    pub matrix: Vec<Entry>,
    /// γ.
    pub bias: Vec<Id>,
    /// B, what forces in the file make of multipliers, as friction does: (coordinate, row, value).
    pub friction: Vec<Entry>,
    /// ∂(J q'' + γ)/∂q: (row, coordinate, value).
    pub stiffness: Vec<Entry>,
    /// ∂(J q'' + γ)/∂q'.
    pub damping: Vec<Entry>,
    /// ∂c'/∂q.
    pub rate_jacobian: Vec<Entry>,
    /// Total time derivatives of F, then of J q'' + γ, with q'' and λ held.
    pub held_rates: Vec<Id>,
    /// −λ·(∂c/∂t or b): the power of moving constraints.
    pub power: Id,
    /// Accelerations and multipliers where all rows act and are clearly independent, without M and J.
    pub eliminated: Option<ConstrainedMotion>,
}

/// Accelerations and multipliers by elimination over shared velocities, and what tells whether they are good.
#[derive(Clone, Debug)]
pub struct ConstrainedMotion {
    /// q''.
    pub accelerations: Vec<Id>,
    /// λ.
    pub multipliers: Vec<Id>,
    /// A pivot for each coordinate.
    pub pivots: Vec<Id>,
    /// What these must not be negligible against.
    pub sizes: Vec<Id>,
    /// For each row J M⁻¹ Jᵀ of what the rows before it leave: how much its multiplier moves it.
    pub mobilities: Vec<Id>,
    /// J M⁻¹ Jᵀ without what these take.
    pub alone: Vec<Id>,
}

impl ConstrainedMotion {
    /// All lists, in this order.
    pub fn lists(&self) -> [&[Id]; 6] {
        let ConstrainedMotion { accelerations, multipliers, pivots, sizes, mobilities, alone } = self;
        [accelerations, multipliers, pivots, sizes, mobilities, alone]
    }
}

impl From<Solution> for ConstrainedMotion {
    fn from(solution: Solution) -> ConstrainedMotion {
        let Solution { values: accelerations, mut pivots, multipliers, mobilities } = solution;
        pivots.sort_unstable_by_key(|pivot| pivot.0);
        let (pivots, sizes) = pivots.into_iter().map(|(_, pivot, size)| (pivot, size)).unzip();
        let (mobilities, alone) = mobilities.into_iter().unzip();
        ConstrainedMotion { accelerations, multipliers, pivots, sizes, mobilities, alone }
    }
}

impl Constraints {
    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.bias.len()
    }

    /// True without constraints.
    pub fn is_empty(&self) -> bool {
        self.bias.is_empty()
    }
}

/// Splits what multipliers do from h, adds their forces to F, and differentiates the rows.
pub(super) fn lowered(graph: &mut Graph, rows: Rows, chosen: &mut Chosen) -> Constraints {
    if rows.is_empty() {
        return Constraints::default();
    }
    let count = rows.len();
    let row = |s: Symbol| if let Symbol::Multiplier(k) = s { Some(k as usize) } else { None };
    let mut friction = entries(jacobian(graph, &chosen.bias, row));
    friction.iter_mut().for_each(|entry| entry.2 = graph.neg(entry.2));
    let none = (0..count as u32).map(|k| (Symbol::Multiplier(k), Id::ZERO)).collect();
    chosen.bias = substitute(graph, &chosen.bias, &none);
    for (f, force) in chosen.residual.iter_mut().zip(&rows.forces) {
        *f = graph.sub(*f, *force);
    }
    let acceleration = rows.accelerations(graph, &(0..count).collect::<Vec<_>>());
    let place = |s: Symbol| if let Symbol::Coordinate(i) = s { Some(i as usize) } else { None };
    let speed = |s: Symbol| if let Symbol::Speed(i) = s { Some(i as usize) } else { None };
    let (mut stiffness, mut damping) =
        (entries(jacobian(graph, &acceleration, place)), entries(jacobian(graph, &acceleration, speed)));
    let rate_jacobian = entries(jacobian(graph, &rows.rate, place));
    let mut magnitudes = Magnitudes::default();
    let places = rows.value.iter().zip(&rows.integral).map(|(c, integral)| integral.unwrap_or(*c));
    let values = places.zip(&rows.rate).flat_map(|(c, rate)| [c, *rate, magnitudes.of(graph, c)]).collect();
    let mut matrix = rows.matrix.clone();
    for list in [&mut matrix, &mut friction, &mut stiffness, &mut damping] {
        gather_entries(graph, list);
    }
    let held = held_rates(graph, &[chosen.residual.as_slice(), &acceleration].concat());
    Constraints {
        values,
        integral: rows.integral.iter().map(Option::is_some).collect(),
        with: rows.with.iter().map(|with| with.iter().map(|(row, factor)| (*row, factor.to_f64())).collect()).collect(),
        matrix,
        bias: gather::gather(graph, &rows.bias),
        friction,
        stiffness,
        damping,
        rate_jacobian,
        held_rates: held,
        power: rows.power(graph),
        eliminated: None,
    }
}
