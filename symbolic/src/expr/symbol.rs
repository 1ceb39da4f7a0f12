//! The leaves of the expression graph.

/// A variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Symbol {
    /// Time t, s.
    Time,
    /// Generalized coordinate q_i.
    Coordinate(u32),
    /// Its rate q'_i.
    Speed(u32),
    /// Its second rate q''_i.
    Acceleration(u32),
    /// A state of first order z_j, by its place among the states; none is left once equations are derived.
    State(u32),
    /// Its rate z'_j, which is what the model says.
    StateRate(u32),
    /// A held value m_j: constant between the events that set it.
    Memory(u32),
    /// An input u_k, or its derivative of the given order.
    Input(u32, u8),
    /// A free parameter, by its place among all expanded free parameters.
    Parameter(u32),
    /// The mode of a switch: stands for a `sign` or a `step` while it does not change.
    Mode(u32),
    /// An unknown reaction component of the momentum balances.
    Reaction(u32),
    /// The multiplier λ of a row of the constraints: the generalized force is (∂c/∂q)ᵀλ; 0 while the row is not active.
    Multiplier(u32),
    /// 1 in this phase, 0 in all others.
    Phase(u32),
    /// A bound variable: the dummy of an `integral`, the `length` of a spring law, the argument of a `diff`, a drawn curve's parameter, a
    /// component of a direction.
    Dummy(u32),
}

impl Symbol {
    /// The symbol's total time derivative, where that is again a symbol: q → q' → q'', z → z', u → u' → ….
    pub fn rate(self) -> Option<Symbol> {
        match self {
            Symbol::Coordinate(i) => Some(Symbol::Speed(i)),
            Symbol::Speed(i) => Some(Symbol::Acceleration(i)),
            Symbol::State(j) => Some(Symbol::StateRate(j)),
            Symbol::Input(k, order) => Some(Symbol::Input(k, order.saturating_add(1))),
            _ => None,
        }
    }

    /// Whether what contains this symbol may change along a motion: it is no parameter.
    pub fn may_change(self) -> bool {
        !matches!(self, Symbol::Parameter(_))
    }
}
