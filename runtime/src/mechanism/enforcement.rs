//! How constraints are enforced.

/// What makes a motion keep its constraints.
///
/// Which of them costs what, and what each does to a motion, is to be compared from one model file (TAM 4735, lectures 8
/// to 11); all but the first are for that.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Enforcement {
    /// Multipliers with the accelerations, M a + h = Jᵀ λ and J a + γ = 0, by elimination.
    #[default]
    Multipliers,
    /// The null space Z of J, in coordinates chosen by pivots: Zᵀ M Z ẍ = −Zᵀ (h + M a₀) with J a₀ = −γ and a = a₀ + Z ẍ.
    NullSpace,
    /// None: stiff springs and dampers in their place, λ = −(k c + d c'); a damper where c contains speeds, λ = −d c.
    Springs {
        /// k, SI: force per length where c is a length.
        stiffness: f64,
        /// d, SI.
        damping: f64,
    },
}

/// What is done about errors by which a motion leaves its constraints.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Stabilisation {
    /// Positions and speeds are projected after every step, in the metric of M.
    #[default]
    Project,
    /// Nothing: |c| grows like t² and |c'| like t.
    None,
    /// c'' + 2 α c' + α² c = 0 in the place of c'' = 0 (c' + α c = 0 where c contains speeds); Baumgarte,
    /// CMAME 1 (1972) 1.
    Baumgarte {
        /// α, 1/s; `None`: 0.06/h with a fixed step h, and 0.03 over the mean of the first twenty steps else.
        alpha: Option<f64>,
    },
}

impl Enforcement {
    /// The names: `multipliers`, `nullspace`, `springs`.
    pub fn name(self) -> &'static str {
        match self {
            Enforcement::Multipliers => "multipliers",
            Enforcement::NullSpace => "nullspace",
            Enforcement::Springs { .. } => "springs",
        }
    }
}

impl Stabilisation {
    /// The names: `project`, `none`, `baumgarte`.
    pub fn name(self) -> &'static str {
        match self {
            Stabilisation::Project => "project",
            Stabilisation::None => "none",
            Stabilisation::Baumgarte { .. } => "baumgarte",
        }
    }
}
