//! The coefficients of an explicit Runge–Kutta method.

use std::marker::PhantomData;

use crate::integrate::Control;

/// One product of a sum over stages: a coefficient times the rate of a stage.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Term {
    /// Which stage, from 0.
    pub stage: usize,
    /// The coefficient.
    pub value: f64,
    /// The coefficient as numerator and denominator, where it is given so.
    #[cfg_attr(not(test), expect(dead_code, reason = "order conditions are tested in rationals"))]
    pub ratio: Option<(i64, i64)>,
}

/// The rational coefficient n/d of a stage.
pub(crate) const fn r(stage: usize, n: i64, d: i64) -> Term {
    Term { stage, value: n as f64 / d as f64, ratio: Some((n, d)) }
}

/// The decimal coefficient of a stage.
pub(crate) const fn x(stage: usize, value: f64) -> Term {
    Term { stage, value, ratio: None }
}

/// How the local error is estimated from the stages.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Estimate {
    /// Not at all: for fixed steps only.
    None,
    /// By the difference to an embedded method.
    Single(&'static [Term]),
    /// By two differences e₅ and e₃, as h‖e₅‖²/√(‖e₅‖² + ‖e₃‖²/100).
    Pair {
        /// e₅.
        higher: &'static [Term],
        /// e₃.
        lower: &'static [Term],
    },
}

impl Estimate {
    /// The estimate's terms, and those of the second one.
    pub const fn terms(&self) -> (&'static [Term], &'static [Term]) {
        match self {
            Estimate::None => (&[], &[]),
            Estimate::Single(terms) => (terms, &[]),
            Estimate::Pair { higher, lower } => (higher, lower),
        }
    }
}

/// A method as a type, so that its coefficients are constants to the compiler.
pub(crate) trait Scheme: Send + 'static {
    /// Its coefficients.
    const TABLEAU: &'static Tableau;
}

/// Node and row of a stage, as constants.
pub(crate) struct Stage<T, const I: usize>(PhantomData<T>);

impl<T: Scheme, const I: usize> Stage<T, I> {
    pub const NODE: f64 = T::TABLEAU.stage(I).0;
    pub const ROW: &'static [Term] = T::TABLEAU.stage(I).1;
    pub const WEIGHS: bool = T::TABLEAU.weighs(I);
}

/// Calls a method for these stages, as far as the method has them.
macro_rules! stages {
    ($self:ident.$stage:ident $arguments:tt for $($i:literal)* below $end:expr, from $first:expr) => {
        $(if const { $i > $first - 1 && $i < $end } { $self.$stage::<$i> $arguments?; })*
    };
}

pub(crate) use stages;

/// An explicit Runge–Kutta method: kᵢ = f(t + cᵢh, y + h Σ aᵢⱼkⱼ), y₁ = y + h Σ bᵢkᵢ.
#[derive(Debug)]
pub(crate) struct Tableau {
    /// Order of the solution.
    pub order: u32,
    /// (cᵢ, the non-zero aᵢⱼ) of each stage; the first is (0, nothing).
    pub rows: &'static [(f64, &'static [Term])],
    /// The non-zero bᵢ.
    pub weights: &'static [Term],
    /// True when the last stage is the rate at the end of the step.
    pub first_same_as_last: bool,
    /// The error estimate.
    pub estimate: Estimate,
    /// Stages that only dense output needs.  They follow the rate at the end of the step.
    pub dense_rows: &'static [(f64, &'static [Term])],
    /// Coefficients of the dense output beyond the cubic Hermite ones.
    pub dense: &'static [&'static [Term]],
    /// Step-size control.
    pub control: Control,
}

impl Tableau {
    /// Stages of a step without those for dense output only.
    pub fn stages(&self) -> usize {
        self.rows.len()
    }

    /// Index of the stage that is the rate at the end of the step.
    pub const fn end_stage(&self) -> usize {
        if self.first_same_as_last { self.rows.len() - 1 } else { self.rows.len() }
    }

    /// Node and row of a stage, those for dense output after the rate at the end; nothing where there is none.
    pub const fn stage(&self, index: usize) -> (f64, &'static [Term]) {
        let first_dense = self.end_stage() + 1;
        if index < self.rows.len() {
            self.rows[index]
        } else if index >= first_dense && index - first_dense < self.dense_rows.len() {
            self.dense_rows[index - first_dense]
        } else {
            (0.0, &[])
        }
    }

    /// True when the increment of y takes this stage's rate.
    pub const fn weighs(&self, stage: usize) -> bool {
        let mut k = 0;
        while k < self.weights.len() {
            if self.weights[k].stage == stage {
                return true;
            }
            k += 1;
        }
        false
    }

    /// Coefficients c₀, c₁, … of the stability function R(z) = Σ cₖzᵏ: y₁ = R(hλ)y for y' = λy.
    pub fn stability(&self) -> Vec<f64> {
        let stages = self.stages();
        let mut powers = vec![1.0; stages];
        let mut coefficients = vec![1.0];
        for _ in 0..stages {
            coefficients.push(self.weights.iter().map(|b| b.value * powers[b.stage]).sum());
            powers = self.rows.iter().map(|(_, row)| row.iter().map(|a| a.value * powers[a.stage]).sum()).collect();
        }
        coefficients
    }
}
