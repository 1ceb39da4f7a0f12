//! The equations of motion and what belongs to them, as functions of a state.

use super::contacts::NO_CONTACTS;
use super::sampling::NO_SAMPLING;
use super::series::SERIES_TERMS;
use super::{Contacts, Description, Gimbal, Noise, Real, Sampling, Series, SingularMass, Table2d};

/// A block of scalars of a size that only generated code knows: an array `[S; K]`.
#[doc(hidden)]
pub trait Values<S>: Clone + Send + Sync + AsRef<[S]> + AsMut<[S]> {
    /// A block of equal numbers.
    fn filled(value: S) -> Self;
}

impl<S: Copy + Send + Sync, const K: usize> Values<S> for [S; K] {
    fn filled(value: S) -> Self {
        [value; K]
    }
}

/// The equations of motion of a mechanism with N generalized coordinates and C constraints, as generated from a model file, with all that is
/// a function of its state.
///
/// Nothing here allocates.  Every numerical function is generic over [`Real`].  `c` is the block of [`Equations::constants`]:
/// parameters, derived parameters, products that depend on nothing else, and at its end the modes of
/// the switches, indicators of phases and held values.  `u` are the inputs with their first and second derivatives, three numbers each.
/// Functions that nobody calls cost nothing.  Shapes, units and signs are those of `System` in the crate `dalembert`.
#[expect(clippy::too_many_arguments, reason = "a state with its multipliers, part by part")]
pub trait Equations<const N: usize, const C: usize>: Clone + Send + Sync {
    /// The block of constants.
    type Constants<S: Real>: Values<S>;
    /// The block of inputs, three numbers each.
    type Inputs<S: Real>: Values<S>;
    /// Room for A and b of the largest system of balances, and for solving it.
    type Balances: Values<f64>;
    /// How many modes stand at the end of the block of constants.
    const MODES: usize;
    /// How many indicators of phases follow them.
    const PHASES: usize;
    /// How many held values follow these.
    const MEMORY: usize = 0;
    /// Whether there is [`Equations::eliminated`].
    const ELIMINATES: bool = false;

    /// Names, shapes and structure.
    fn description() -> &'static Description;
    /// Sequences of three angles that can lock.
    fn gimbals() -> &'static [Gimbal] {
        &[]
    }
    /// Functions of two arguments that the file gives by values on a grid.
    fn tables_2d() -> &'static [Table2d] {
        &[]
    }
    /// What is held, set and sampled.
    fn sampling() -> &'static Sampling {
        &NO_SAMPLING
    }
    /// Held noise.
    fn held_noise() -> &'static [Noise] {
        &[]
    }
    /// Friction that may stick and contacts that may open.
    fn contacts() -> &'static Contacts {
        &NO_CONTACTS
    }
    /// Values of all that events set, set by set.
    fn assignments<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        values: &mut [S],
    ) {
        let _ = (c, t, u, q, v, a, l, values);
    }
    /// How power series of M, h, J and γ follow from that of the motion; `None` where the macro was not asked for them (`methods = "taylor"`).
    #[doc(hidden)]
    fn series() -> Option<&'static Series> {
        None
    }
    /// The numbers that the recurrences are made with.
    #[doc(hidden)]
    fn series_constants<S: Real>(c: &Self::Constants<S>, t: S, u: &[S], values: &mut [S]) {
        let _ = (c, t, u, values);
    }
    /// The power series of the motion at a state, time in a unit: of each coordinate, then of each speed, all orders, where those of order 0 are given.
    /// Whether there is such code and M is well conditioned: else the recurrences tell the same.
    #[doc(hidden)]
    fn expansion(c: &Self::Constants<f64>, u: &[f64], t: f64, unit: f64, state: &mut [[f64; SERIES_TERMS]]) -> bool {
        let _ = (c, u, t, unit, state);
        false
    }
    /// The block of constants for one set of parameters per lane; modes as at the switch's step or sign of 1.
    fn constants<S: Real>(lane: impl Fn(usize) -> Self) -> Self::Constants<S>;
    /// The inputs as the file gives them.
    fn inputs<S: Real>(c: &Self::Constants<S>, t: S) -> Self::Inputs<S>;

    /// M's lower triangle as values of the pattern; of `v` only states of first order are read, which masses may contain.
    fn mass_matrix<S: Real>(c: &Self::Constants<S>, t: S, u: &[S], q: &[S; N], v: &[S; N], values: &mut [S]);
    /// h.
    fn bias<S: Real>(c: &Self::Constants<S>, t: S, u: &[S], q: &[S; N], v: &[S; N], h: &mut [S; N]);
    /// The accelerations −M⁻¹h.
    ///
    /// # Errors
    /// [`SingularMass`] names the coordinate whose pivot vanishes or is not finite.
    fn accelerations<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &mut [S; N],
    ) -> Result<(), SingularMass>;
    /// Accelerations and multipliers where all rows of the constraints act and are independent, by elimination over shared velocities; for each
    /// coordinate a pivot and what that must not be negligible against, and for each row J M⁻¹ Jᵀ of what the rows before it leave, and without what these
    /// take.
    fn eliminated<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &mut [S; N],
        l: &mut [S; C],
        pivots: &mut [S; N],
        sizes: &mut [S; N],
        mobilities: &mut [S; C],
        alone: &mut [S; C],
    ) {
        let _ = (c, t, u, q, v, a, l, pivots, sizes, mobilities, alone);
    }
    /// The accelerations of the coordinates of one of `description().parts`, of whose state alone they are computed.
    ///
    /// # Errors
    /// As [`Equations::accelerations`].
    fn part_accelerations<S: Real>(
        c: &Self::Constants<S>,
        index: usize,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &mut [S; N],
    ) -> Result<(), SingularMass> {
        let _ = index;
        Self::accelerations(c, t, u, q, v, a)
    }
    /// What the same part has of T, V, the Jacobi function, the power and the scale.
    fn part_energy<S: Real>(c: &Self::Constants<S>, index: usize, t: S, u: &[S], q: &[S; N], v: &[S; N]) -> [S; 5] {
        let _ = index;
        let zero = S::ratio(0.0, 1.0);
        Self::energy(c, t, u, q, v, &[zero; N], &[zero; C])
    }
    /// A, row by row, and b of a system of balances; nothing where there is no such system.
    fn balances<S: Real>(
        c: &Self::Constants<S>,
        system: usize,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        matrix: &mut [S],
        right: &mut [S],
    );
    /// F = M a + h.
    fn residual<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        f: &mut [S; N],
    );
    /// ∂F/∂q and ∂F/∂q' as values of their patterns.
    fn jacobians<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        dq: &mut [S],
        dv: &mut [S],
    );
    /// ∂F/∂(u, u', u'') as values of its pattern.
    fn input_jacobian<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        du: &mut [S],
    );
    /// ∂F/∂t of the rows of its pattern.
    fn time_jacobian<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        dt: &mut [S],
    );
    /// ∂F/∂t with generic numbers for functions of time that can be as small as none.
    fn time_dependence<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        dt: &mut [S],
    );
    /// Sums of the absolute values of the terms of each component of F.
    fn magnitudes<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        sums: &mut [S],
    );
    /// T, V, the Jacobi function, the power and the scale, in the order of [`Energy`]'s fields.
    fn energy<S: Real>(c: &Self::Constants<S>, t: S, u: &[S], q: &[S; N], v: &[S; N], a: &[S; N], l: &[S; C])
    -> [S; 5];
    /// Pairs (value, sum of the absolute terms) of the invariants.
    fn invariants<S: Real>(c: &Self::Constants<S>, t: S, u: &[S], q: &[S; N], v: &[S; N], pairs: &mut [S]);
    /// Outputs.
    fn outputs<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        values: &mut [S],
    );
    /// Pairs (value, condition) of the events.
    fn events<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        pairs: &mut [S],
    );
    /// Total time derivatives of the events' functions, where they are known.
    fn event_rates<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        rates: &mut [S],
    );
    /// Pairs (argument, its rate) of local functions.
    fn arguments<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        pairs: &mut [S],
    );
    /// Pairs (argument, its rate) of the switches.
    fn switches<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        pairs: &mut [S],
    );
    /// Points and radii to draw.
    fn drawing<S: Real>(c: &Self::Constants<S>, t: S, u: &[S], q: &[S; N], v: &[S; N], values: &mut [S]);
    /// Triples (c, c', Σ |terms| of c) of the constraints' rows.
    fn constraints<S: Real>(c: &Self::Constants<S>, t: S, u: &[S], q: &[S; N], v: &[S; N], triples: &mut [S]);
    /// J as values of its pattern.
    fn constraint_matrix<S: Real>(c: &Self::Constants<S>, t: S, u: &[S], q: &[S; N], values: &mut [S]);
    /// γ.
    fn constraint_bias<S: Real>(c: &Self::Constants<S>, t: S, u: &[S], q: &[S; N], v: &[S; N], gamma: &mut [S]);
    /// B as values of its pattern.
    fn friction<S: Real>(c: &Self::Constants<S>, t: S, u: &[S], q: &[S; N], v: &[S; N], values: &mut [S]);
    /// ∂(J a + γ)/∂q and ∂(J a + γ)/∂q' as values of their patterns.
    fn constraint_jacobians<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        dq: &mut [S],
        dv: &mut [S],
    );
    /// ∂c'/∂q as values of its pattern.
    fn constraint_rate_jacobian<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        values: &mut [S],
    );
    /// Quantities that scenes' starts meet beside constraints.
    fn start_conditions<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        values: &mut [S],
    );
    /// Total time derivatives of F, then of J a + γ, with a and λ held.
    fn held_rates<S: Real>(
        c: &Self::Constants<S>,
        t: S,
        u: &[S],
        q: &[S; N],
        v: &[S; N],
        a: &[S; N],
        l: &[S; C],
        values: &mut [S],
    );
}

/// Energies of a state.
///
/// The balance is J − ∫P dt with J = q'·∂T/∂q' − T + V and P = q'·Q − ∂T/∂t + ∂V/∂t: for kinetic energies
/// quadratic in the speeds J is the energy itself and P the power of everything that has no potential
/// (Whittaker, Analytical Dynamics, §41).  Along an exact motion the balance is constant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// T, J.
    pub kinetic: f64,
    /// V, J.
    pub potential: f64,
    /// q'·∂T/∂q' − T + V, J.
    pub jacobi: f64,
    /// q'·Q − ∂T/∂t + ∂V/∂t, W.
    pub power: f64,
    /// Sum of the absolute values of the terms of T and V, J.
    pub scale: f64,
}

impl Energy {
    /// Names the five numbers of [`Equations::energy`].
    pub fn from_array([kinetic, potential, jacobi, power, scale]: [f64; 5]) -> Self {
        Energy { kinetic, potential, jacobi, power, scale }
    }
}
