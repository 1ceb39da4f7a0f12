//! The power series of a motion at one of its states.

use super::ORDER;
use crate::integrate::StepFailure;
use crate::mechanism::{At, Jets, KktSolver, MotionJets, Place, SERIES_TERMS, Series, System, dot};

/// Coefficients of q and q' in a unit of time τ: q(t + θτ) = Σ qₖ θᵏ.
///
/// M q'' − Jᵀλ = −h and J q'' = −γ at every order: with all coefficients known up to order k − 1, those of M, h, J and γ follow up to order k, and
///
/// M₀ aₖ − J₀ᵀ λₖ = −hₖ − Σ (Mⱼ aₖ₋ⱼ − Jⱼᵀ λₖ₋ⱼ),  J₀ aₖ = −γₖ − Σ Jⱼ aₖ₋ⱼ,  0 < j ≤ k,
///
/// with one factorization for all orders.  Neither q'' nor the inverse of M is ever written down as a series of its own.
pub(super) struct Expansion {
    n: usize,
    /// τ, s.
    pub unit: f64,
    /// Of q, then of q'.
    pub state: Vec<[f64; SERIES_TERMS]>,
    jets: Jets,
    constants: Vec<f64>,
    kkt: KktSolver,
    /// Coefficients of q'' and of the multipliers of the rows in force, backwards: order k at the place ORDER − k.
    accelerations: Vec<f64>,
    multipliers: Vec<f64>,
    forces: Vec<f64>,
    bends: Vec<f64>,
    pub factorizations: u64,
}

impl Expansion {
    /// Makes room for n coordinates.
    pub fn new(n: usize) -> Expansion {
        Expansion {
            n,
            unit: 1.0,
            state: vec![[0.0; SERIES_TERMS]; 2 * n],
            jets: Jets::default(),
            constants: Vec::new(),
            kkt: KktSolver::default(),
            accelerations: vec![0.0; n * SERIES_TERMS],
            multipliers: Vec::new(),
            forces: vec![0.0; n],
            bends: Vec::new(),
            factorizations: 0,
        }
    }

    /// Expands the motion at a state, time in units of τ.
    pub fn expand(&mut self, system: &dyn System, t: f64, y: &[f64], unit: f64) -> Result<(), StepFailure> {
        let series = system.series().map_err(StepFailure::NoSeries)?;
        let n = self.n;
        if self.jets.rows() != series.rows.len() {
            self.jets = Jets::new(series.rows.len(), ORDER);
        }
        self.unit = unit;
        for (state, y) in self.state.iter_mut().zip(y) {
            state[0] = *y;
        }
        if system.expansion(t, unit, &mut self.state) {
            self.factorizations += 1;
            return Ok(());
        }
        self.constants.resize(series.constants, 0.0);
        system.series_constants(&mut self.constants);
        self.kkt.factor(system, At::packed(t, y, n))?;
        self.factorizations += 1;
        let rows = self.kkt.active().len();
        self.multipliers.resize(rows * SERIES_TERMS, 0.0);
        self.bends.resize(rows, 0.0);
        for k in 0..ORDER {
            let motion = MotionJets { t, unit, state: self.state.as_flattened(), width: SERIES_TERMS, n };
            self.jets.extend(series, &self.constants, motion, k);
            self.next(series, k);
        }
        Ok(())
    }

    /// Accelerations and multipliers of order k, and what follows for the state.
    fn next(&mut self, series: &Series, k: usize) {
        let n = self.n;
        let place = |place: Place, k: usize| match place {
            Place::Row(row) => self.jets.get(row, k),
            Place::Constant(constant) if k == 0 => self.constants[constant],
            Place::Constant(_) => 0.0,
        };
        let (forces, bends) = (&mut self.forces, &mut self.bends);
        for (force, h) in forces.iter_mut().zip(&*series.bias) {
            *force = -place(*h, k);
        }
        // What stands at lower orders of the unknowns: Σ xⱼ aₖ₋ⱼ over 0 < j ≤ k.
        let later = |x: Place, list: &[f64], i: usize| match x {
            Place::Row(row) => {
                let from = i * SERIES_TERMS + ORDER - k;
                dot(&self.jets.row(row)[1..=k], &list[from + 1..=from + k])
            }
            Place::Constant(_) => 0.0,
        };
        for (i, j, value) in &*series.mass {
            forces[*i] -= later(*value, &self.accelerations, *j);
            if i != j {
                forces[*j] -= later(*value, &self.accelerations, *i);
            }
        }
        let active = self.kkt.active();
        for (bend, row) in bends.iter_mut().zip(active) {
            *bend = -place(series.constraint_bias[*row], k);
        }
        for (row, i, value) in &*series.matrix {
            if let Some(r) = active.iter().position(|active| active == row) {
                bends[r] -= later(*value, &self.accelerations, *i);
                forces[*i] += later(*value, &self.multipliers, r);
            }
        }
        self.kkt.solve_exactly(forces, bends);
        let order = (k + 1) as f64;
        for (i, acceleration) in forces.iter().enumerate() {
            self.accelerations[i * SERIES_TERMS + ORDER - k] = *acceleration;
            self.state[n + i][k + 1] = self.unit * acceleration / order;
            self.state[i][k + 1] = self.unit * self.state[n + i][k] / order;
        }
        for (r, multiplier) in bends.iter().enumerate() {
            self.multipliers[r * SERIES_TERMS + ORDER - k] = *multiplier;
        }
    }

    /// Whether all coefficients are finite.
    pub fn is_finite(&self) -> bool {
        self.state.as_flattened().iter().all(|x| x.is_finite())
    }

    /// A quantity's coefficients.
    pub fn of(&self, i: usize) -> &[f64; SERIES_TERMS] {
        &self.state[i]
    }
}
